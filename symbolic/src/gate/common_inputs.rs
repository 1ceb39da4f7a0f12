//! What no comparison of derivations can show to be wrong.

use crate::expr::Id;
use crate::model::{Load, Model, Work};

/// What all derivations take from the file as it stands: masses, inertias, gravity and so on, as far as the model has
/// them.  `checks` can state what is known of them.
pub fn shared_data(model: &Model) -> Vec<&'static str> {
    let of_contact = |load: &Load| model.contacts.iter().any(|contact| contact.name == load.name);
    let works = |kind: fn(&Work) -> bool| model.loads.iter().any(|load| kind(&load.work) && !of_contact(load));
    let raw = [model.raw_kinetic_energy, model.raw_potential_energy, model.dissipation];
    let present = [
        (model.bodies.iter().any(|body| body.mass != Id::ZERO), "masses"),
        (
            model
                .bodies
                .iter()
                .any(|b| b.rotation.as_ref().is_some_and(|r| r.inertias().iter().any(|moment| *moment != Id::ZERO))),
            "inertias",
        ),
        (!model.bodies.is_empty(), "positions"),
        (model.gravity.is_some(), "gravity"),
        (works(|work| matches!(work, Work::Potential(_))), "springs"),
        (works(|work| matches!(work, Work::Resistance { .. })), "dampers"),
        (model.contacts.iter().any(|contact| contact.tangent.is_some()), "friction"),
        (model.contacts.iter().any(|contact| contact.normal.is_some()), "contacts"),
        (works(|work| matches!(work, Work::Pushes)), "forces"),
        (raw.iter().any(|energy| *energy != Id::ZERO), "energies written by hand"),
        (!model.generalized_forces.is_empty(), "generalized forces"),
        (!model.inputs.is_empty(), "inputs"),
    ];
    present.into_iter().filter(|(there, _)| *there).map(|(_, what)| what).collect()
}
