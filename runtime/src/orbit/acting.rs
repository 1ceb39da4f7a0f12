//! What acts with the present parameters: a force whose amplitude is 0 does not, nor does a damper whose coefficient is 0.  A parameter that varies
//! along a family counts as other than 0, so that all its members have one structure.

use crate::mechanism::{Action, Along, At, Function, System};

/// States and times at which is looked whether something acts.  What a parameter that is 0 multiplies is exactly 0 at all of them; anything else that
/// is 0 there, as a pulse between its beginnings, would have to be so by chance.
const PLACES: usize = 64;

/// Whether time acts.  Where nothing is known of it the mechanism was written by hand, or time acts otherwise than by sines.
pub(super) fn time_acts(system: &dyn System, varies: &[usize], near: &[f64]) -> bool {
    match system.frequencies() {
        None => true,
        Some(list) => {
            let system = &*elsewhere(system, varies);
            !(list.is_empty() || has_zero(system) && everywhere(system, near, &is_timeless))
        }
    }
}

/// Whether the energy, the Jacobi integral, stays as it is, since everything that acts has a potential in which time does not act.
pub(super) fn keeps_energy(system: &dyn System, varies: &[usize], near: &[f64]) -> bool {
    let system = &*elsewhere(system, varies);
    let description = system.description();
    let said = description.structure.conservative && description.time_pattern.is_empty();
    let powerless = |system: &dyn System, at: At<'_>| system.energy(at).power == 0.0 && is_timeless(system, at);
    said || has_zero(system) && everywhere(system, near, &powerless)
}

/// Whether a motion may depend on a parameter: equations, constraints or what events wait for contain it, or events and contacts do anything.
pub(super) fn parameter_acts(system: &dyn System, parameter: usize, near: &[f64]) -> bool {
    let description = system.description();
    let acts = description.events.iter().any(|event| event.actions.iter().any(|action| *action != Action::Record));
    let along = Along { parameter: Some(parameter), ..Along::default() };
    acts || !system.contacts().all.is_empty() || !everywhere(system, near, &|system, at| stays(system, at, &along))
}

/// The mechanism with other values than 0 of parameters that vary.
fn elsewhere(system: &dyn System, varies: &[usize]) -> Box<dyn System> {
    let mut elsewhere = system.boxed_clone();
    for &place in varies {
        if system.parameters().get(place) == Some(&0.0) {
            elsewhere.set_parameter(place, 1.0);
        }
    }
    elsewhere
}

/// Whether a parameter is 0: without any everything acts that the equations contain.
fn has_zero(system: &dyn System) -> bool {
    system.parameters().contains(&0.0)
}

/// Whether something is so in states beside one, at all times.
fn everywhere(system: &dyn System, near: &[f64], is_so: &dyn Fn(&dyn System, At<'_>) -> bool) -> bool {
    let (n, rows) = (system.len(), system.description().rows.len());
    let beside = |place: usize, k: usize| (1.0 + (7 * k + 3 * place) as f64).sin();
    (0..PLACES).all(|place| {
        let y: Vec<f64> = near.iter().enumerate().map(|(k, x)| x + beside(place, k)).collect();
        let a: Vec<f64> = (0..n).map(|k| beside(place, 2 * n + k)).collect();
        let lambda: Vec<f64> = (0..rows).map(|k| beside(place, 3 * n + k)).collect();
        let t = place as f64 + beside(place, 3 * n + rows);
        is_so(system, At::packed(t, &y, n).accelerated(&a).constrained(&lambda))
    })
}

/// Whether no force, constraint, event or energy changes with time in a state.
fn is_timeless(system: &dyn System, at: At<'_>) -> bool {
    stays(system, at, &Along { t: 1.0, ..Along::default() })
}

/// Whether no force, constraint, event or energy changes along a direction.
fn stays(system: &dyn System, at: At<'_>, along: &Along<'_>) -> bool {
    let (rows, events) = (system.description().rows.len(), system.description().events.len());
    let functions = [
        (Function::Residual, system.len()),
        (Function::RowAccelerations, rows),
        (Function::Constraints, 3 * rows),
        (Function::Events, 2 * events),
        (Function::Switches, 2 * system.description().switches.len()),
        (Function::Energies, 5),
    ];
    functions.into_iter().all(|(function, size)| {
        let mut slopes = vec![0.0; size];
        let known = system.slopes(function, at, along, &mut slopes);
        known && slopes.iter().all(|slope| *slope == 0.0)
    })
}
