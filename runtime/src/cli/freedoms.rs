//! What `check` says of constraints: degrees of freedom, phase by phase, and which velocity constraints are integrable.

use dalembert_symbolic::diagnose::listed;
use dalembert_symbolic::gate::{Freedoms, Integrability};
use dalembert_symbolic::lower::Program;

/// One line a phase; none for a model without constraints, and of contacts that have phases by themselves only that of the first.
pub fn lines(program: &Program) -> Vec<String> {
    let most = if program.model.contacts_are_single() { 1 } else { usize::MAX };
    program
        .report
        .freedoms
        .iter()
        .enumerate()
        .take(most)
        .map(|(phase, freedoms)| line(program, phase, freedoms))
        .collect()
}

fn line(program: &Program, phase: usize, freedoms: &Freedoms) -> String {
    let model = &program.model;
    let name = match model.phases.get(phase) {
        Some(phase) if !phase.name.is_empty() => format!("phase {}: ", phase.name),
        _ => String::new(),
    };
    let least = if freedoms.decided() { "" } else { "at least " };
    let s = if freedoms.configuration == 1 { "" } else { "s" };
    let particular = if freedoms.particular { ", for these values of the parameters" } else { "" };
    let mut words = vec![format!(
        "{name}{least}{} degree{s} of freedom in configuration, {} in velocity{particular}",
        freedoms.configuration, freedoms.velocity
    )];
    let (rows, rank) = (model.phases.get(phase).map_or(0, |phase| model.rows_of(phase).len()), program.rank_of(phase));
    if rank < rows {
        words.push(format!("over-constrained: {rank} of {rows} rows are independent"));
    }
    if freedoms.velocity == 0 {
        words.push("no velocity is left: the constraints determine the motion".to_owned());
    }
    let of = |kind| {
        let rows = freedoms.rows.iter().filter(move |row| row.1 == kind);
        rows.map(|row| model.row_name(row.0)).collect::<Vec<String>>()
    };
    let mut say = |kind, one: &str, many: &str| match of(kind).as_slice() {
        [] => {}
        [name] => words.push(one.replace("{}", name)),
        names => words.push(many.replace("{}", &listed(names))),
    };
    say(
        Integrability::Integral,
        "{} is integrable: its integral is held",
        "{} are integrable: their integrals are held",
    );
    say(
        Integrability::Integrable,
        "{} is integrable, by no integral that was found: its velocity is held",
        "{} are integrable, by no integrals that were found: their velocities are held",
    );
    say(Integrability::Nonholonomic, "{} is nonholonomic", "{} are nonholonomic");
    let together = match freedoms.held {
        1 => "a combination of {} is integrable: its integral is held".to_owned(),
        n => format!("{n} combinations of {{}} are integrable: their integrals are held"),
    };
    say(Integrability::Together, &together, &together);
    let combination = match freedoms.combinations {
        1 => "a combination of {} is integrable, none of them by itself, by no integral that was found: their \
              velocities are held"
            .to_owned(),
        n => format!(
            "{n} combinations of {{}} are integrable, by no integrals that were found, none of them by itself: their velocities are held"
        ),
    };
    say(Integrability::Combined, &combination, &combination);
    say(
        Integrability::Undecided,
        "it would take too long to decide whether {} is integrable",
        "it would take too long to decide whether {} are integrable",
    );
    words.join("; ")
}
