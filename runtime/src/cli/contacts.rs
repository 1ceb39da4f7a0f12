//! What contacts did in a run, in words and as JSON.

use std::io::Write;

use serde_json::{Value, json};

use super::Problem;
use super::json::{number, object};
use crate::mechanism::ContactMode;
use crate::numbers::{counted, short};
use crate::{ContactHistory, Run, SteppedContact};

/// What each contact did; of those that steps went over only what touched.
pub fn write(run: &Run, out: &mut dyn Write) -> Result<(), Problem> {
    let opens = |contact: &ContactHistory| contact.modes.iter().all(|(mode, _)| *mode == ContactMode::Open);
    let all = run.contacts();
    let silent = |contact: &&ContactHistory| run.tally.is_none() || !opens(contact);
    for contact in all.iter().filter(silent) {
        writeln!(out, "  {}", history(contact))?;
    }
    match all.iter().filter(|contact| !silent(contact)).count() {
        0 => {}
        never => writeln!(out, "  {} never pressed", counted(never, "contact"))?,
    }
    Ok(())
}

/// `rub slips forwards for 1 s, sticks for 2 s and holds up to 0.75 of its limit`.
fn history(contact: &ContactHistory) -> String {
    let one = |(mode, span): &(ContactMode, f64)| {
        let held = contact.held.filter(|_| *mode == ContactMode::Sticks);
        let held = held.map_or_else(String::new, |part| format!(" and holds up to {part:.2} of its limit"));
        format!("{mode} for {} s{held}", short(*span))
    };
    format!("{} {}", contact.name, contact.modes.iter().map(one).collect::<Vec<_>>().join(", "))
}

/// Modes with their durations, s, and `held`, the largest part of its limit that held each where it stuck.
pub fn of_run(run: &Run) -> Value {
    let one = |contact: ContactHistory| {
        let modes = contact.modes.iter().map(|(mode, span)| (mode.to_string(), number(*span)));
        let held = contact.held.map_or(Value::Null, number);
        (contact.name.clone(), object(modes.chain([("held".to_owned(), held)])))
    };
    object(run.contacts().into_iter().map(one))
}

/// What steps over contacts tell, where a run was made of such.
pub fn stepped_over(run: &Run) -> Option<(&'static str, Value)> {
    let over = run.stepped_over()?;
    let deepest = over.deepest.as_ref().map_or(Value::Null, |deepest| {
        object([("contact", json!(deepest.contact)), ("depth", number(deepest.depth)), ("t", number(deepest.t))])
    });
    let list = |values: [f64; 3]| Value::from(values.map(number).to_vec());
    let one = |contact: &SteppedContact| {
        (contact.name.clone(), object([("impulse", list(contact.impulse)), ("force", list(contact.force))]))
    };
    let told = object([
        ("deepest", deepest),
        ("work", number(over.work)),
        ("residual", number(over.residual)),
        ("rounds", json!(over.rounds)),
        ("closed", json!(over.closed)),
        ("contacts", object(over.contacts.iter().map(one))),
    ]);
    Some(("stepped_over", told))
}
