//! Friction that may stick and contacts that may open, as Rust.

use super::description::{list, string};
use crate::lower::Program;
use crate::model::ImpactLaw;

/// `contacts`; that of the trait serves where there are none.
pub(super) fn contacts(program: &Program) -> String {
    let model = &program.model;
    if model.contacts.is_empty() {
        return String::new();
    }
    let number = |number: Option<usize>| match number {
        None => "::core::option::Option::None".to_owned(),
        Some(number) => format!("::core::option::Option::Some({number})"),
    };
    let row = |constraint: Option<usize>| number(constraint.map(|place| model.constraints[place].first));
    let restitutions = program.restitutions_of_contacts();
    let all = list(model.contacts.iter().zip(restitutions).map(|(contact, restitution)| {
        format!(
            "mechanism::Contact {{ name: {}, normal: {}, tangent: {}, direction: {}, first_event: {}, restitution: {} }}",
            string(&contact.name),
            row(contact.normal),
            row(contact.tangent),
            number(contact.direction),
            contact.first_event,
            number(restitution)
        )
    }));
    let law = match model.impacts {
        None => "::core::option::Option::None".to_owned(),
        Some(law) => format!("::core::option::Option::Some(mechanism::ImpactLaw::{})", law_name(law)),
    };
    format!(
        "
    fn contacts() -> &'static ::dalembert::mechanism::Contacts {{
        use ::dalembert::mechanism;
        static CONTACTS: mechanism::Contacts = mechanism::Contacts {{ all: {all}, law: {law} }};
        &CONTACTS
    }}
"
    )
}

fn law_name(law: ImpactLaw) -> &'static str {
    match law {
        ImpactLaw::Sequential => "Sequential",
        ImpactLaw::Together => "Together",
        ImpactLaw::Poisson => "Poisson",
    }
}
