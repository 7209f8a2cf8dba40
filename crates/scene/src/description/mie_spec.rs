//! The short form of Lorenz-Mie phase functions in one line: `mie:water:10um:gamma(0.1)`.
//!
//! It is `mie(material=water, distribution=gamma(r_eff=10um, v_eff=0.1))`; without a distribution, `mie:water:10um`, all
//! particles are alike. Numbers of a distribution may go without their names: `gamma(10um, 0.1)`.

use super::call::{Argument, Call, Term};

/// Names of the values of each distribution, in order.
const VALUES: [(&str, &[&str]); 5] = [
    ("single", &["r"]),
    ("gamma", &["r_eff", "v_eff"]),
    ("log_normal", &["r_g", "sigma_g"]),
    ("modified_gamma", &["r_mode", "alpha", "gamma"]),
    ("power_law", &["exponent", "r_min", "r_max"]),
];

/// The call with all values named, if it is of `mie`; what it cannot name stays as it is.
pub(super) fn named(mut call: Call) -> Call {
    if call.name != "mie" {
        return call;
    }
    if call.arguments.iter().all(|argument| argument.key.is_none())
        && let Some(long) = long_form(&call.arguments)
    {
        call.arguments = long;
    }
    for argument in &mut call.arguments {
        if let (Some("distribution"), Term::Call(law)) = (argument.key.as_deref(), &mut argument.term) {
            name_values(law);
        }
    }
    call
}

fn long_form(arguments: &[Argument]) -> Option<Vec<Argument>> {
    let [material, radius, law @ ..] = arguments else { return None };
    let mut law = match law {
        [] => Call { name: "single".into(), arguments: Vec::new() },
        [Argument { term: Term::Call(law), .. }] => law.clone(),
        _ => return None,
    };
    law.arguments.insert(0, radius.clone());
    Some(vec![with_key("material", material.term.clone()), with_key("distribution", Term::Call(law))])
}

fn name_values(law: &mut Call) {
    if law.name == "lognormal" {
        law.name = "log_normal".into();
    }
    let Some((_, names)) = VALUES.iter().find(|(name, _)| *name == law.name) else { return };
    for (argument, name) in law.arguments.iter_mut().zip(*names) {
        argument.key.get_or_insert_with(|| (*name).to_owned());
    }
}

fn with_key(key: &str, term: Term) -> Argument {
    Argument { key: Some(key.to_owned()), term }
}
