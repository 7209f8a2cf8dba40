//! `--distance` and `--transmittance`: the estimators of the reference integrator.

use std::path::Path;

use miette::miette;
use tyndall_scene::Scene;
use tyndall_scene::description::Integrator;
use tyndall_transport::{DistanceSampler, Estimators, TransmittanceEstimator};

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

    /// The choice, if it can make a picture of `scene`, which is that of `input`.
    pub fn choose(
        &self,
        integrator: Integrator,
        input: Option<&Path>,
        scene: &Scene,
    ) -> miette::Result<Estimators> {
        if self.integrator().is_some_and(|needed| needed != integrator) {
            return Err(miette!(
                "--distance and --transmittance belong to the reference integrator; leave out --integrator fast"
            ));
        }
        let input = input.map_or("the built-in scene".into(), |path| path.display().to_string());
        self.chosen().validate(scene).map_err(|reason| miette!("{input}: {reason}"))?;
        Ok(self.chosen())
    }
}

/// The choice as it is kept with the picture: samples of different estimators are not merged, as their errors differ.
pub fn as_options(estimators: Estimators) -> String {
    let distance = estimators.distance.map(|sampler| format!(" distance={}", sampler.name()));
    let transmittance =
        estimators.transmittance.map(|estimator| format!(" transmittance={}", estimator.name()));
    [distance, transmittance].into_iter().flatten().collect()
}

fn parse_distance(text: &str) -> Result<DistanceSampler, String> {
    let names = DistanceSampler::ALL.map(DistanceSampler::name);
    DistanceSampler::from_name(text).ok_or_else(|| format!("there are {}", names.join(", ")))
}

fn parse_transmittance(text: &str) -> Result<TransmittanceEstimator, String> {
    let names = TransmittanceEstimator::ALL.map(TransmittanceEstimator::name);
    TransmittanceEstimator::from_name(text).ok_or_else(|| format!("there are {}", names.join(", ")))
}
