//! `--distance` and `--transmittance`: the estimators of the reference integrator.

use miette::miette;
use tyndall_scene::description::Integrator;
use tyndall_transport::{DistanceSampler, Estimators, TransmittanceEstimator};

use crate::terminal::tell;

/// Which estimators a picture is made with.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct EstimatorArgs {
    /// How distances are sampled, such as delta-tracking; takes the reference integrator
    #[arg(long, value_name = "NAME", value_parser = parse_distance)]
    distance: Option<DistanceSampler>,
    /// How the transmittance of shadow rays is estimated, such as ratio-tracking; takes the reference integrator
    #[arg(long, value_name = "NAME", value_parser = parse_transmittance)]
    transmittance: Option<TransmittanceEstimator>,
}

impl EstimatorArgs {
    /// The integrator that these options ask for.
    pub fn integrator(&self) -> Option<Integrator> {
        (self.chosen() != Estimators::default()).then_some(Integrator::Reference)
    }

    /// The choice, which may not fit the scene.
    pub fn chosen(&self) -> Estimators {
        Estimators { distance: self.distance, transmittance: self.transmittance }
    }

    /// Tells that the choice decides over the integrator, unless that was chosen as well.
    pub fn tell_integrator(&self, chosen: Option<Integrator>) {
        if chosen.is_none() && self.integrator().is_some() {
            tell("note: --distance and --transmittance belong to the reference integrator, which is taken");
        }
    }

    /// Refuses a choice for another integrator.
    pub fn check(&self, integrator: Integrator) -> miette::Result<()> {
        if self.integrator().is_some_and(|needed| needed != integrator) {
            return Err(miette!(
                "--distance and --transmittance belong to the reference integrator; leave out --integrator fast"
            ));
        }
        Ok(())
    }
}

fn parse_distance(text: &str) -> Result<DistanceSampler, String> {
    let names = DistanceSampler::ALL.map(DistanceSampler::name);
    DistanceSampler::from_name(text).ok_or_else(|| format!("there are {}", names.join(", ")))
}

fn parse_transmittance(text: &str) -> Result<TransmittanceEstimator, String> {
    let names = TransmittanceEstimator::ALL.map(TransmittanceEstimator::name);
    TransmittanceEstimator::from_name(text).ok_or_else(|| format!("there are {}", names.join(", ")))
}
