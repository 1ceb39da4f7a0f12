//! `check --routh`: the equations of motion without the coordinates that can be ignored.

use std::fmt::Write;

use dalembert_symbolic::expr::Id;
use dalembert_symbolic::lower::{Ignored, NotReduced, Program, Reduced, routh};
use dalembert_symbolic::print::in_full;

/// What is left of the equations, how many operations that takes, and how closely it is the same motion.
pub fn lines(program: &Program) -> String {
    match routh(program) {
        Ok(reduced) => report(program, &reduced),
        Err(NotReduced::NotSmooth) => {
            "  Routh: nothing is reduced where constraints, discontinuities, phases, states of first order or held values act\n".to_owned()
        }
        Err(NotReduced::NothingIgnorable) => {
            "  Routh: nothing is reduced, since every coordinate and every direction matters\n".to_owned()
        }
        Err(NotReduced::NothingLeft) => {
            "  Routh: nothing is left to integrate, since all momenta are conserved\n".to_owned()
        }
        Err(NotReduced::TooLarge) => "  Routh: the reduced equations are too large to be written out\n".to_owned(),
        Err(NotReduced::Differs { worst }) => format!(
            "  Routh: nothing is reduced, since accelerations would be off by {worst:.1e}: the inertia of what can be ignored \
             nearly vanishes\n"
        ),
    }
}

fn report(program: &Program, reduced: &Reduced) -> String {
    let Reduced { model, kept, ignored, mass, bias, operations, rate_operations, worst, states } = reduced;
    let name = |i: usize| &program.model.coordinates[i].name;
    let names = |list: &mut dyn Iterator<Item = usize>| list.map(|i| name(i).as_str()).collect::<Vec<_>>().join(", ");
    let mut out = format!(
        "  Routh: {} of {} coordinates {} left: {}\n",
        kept.len(),
        kept.len() + ignored.len(),
        if kept.len() == 1 { "is" } else { "are" },
        names(&mut kept.iter().copied())
    );
    let of_ignored = ignored.iter().flat_map(|c| [c.momentum, c.rate]);
    let roots: Vec<Id> =
        of_ignored.chain(mass.iter().map(|(_, _, value)| *value)).chain(bias.iter().copied()).collect();
    let (formulas, parts) = in_full(model, &roots);
    let (of_ignored, of_rest) = formulas.split_at(2 * ignored.len());
    let (of_mass, of_bias) = of_rest.split_at(mass.len());
    for (c, formulas) in ignored.iter().zip(of_ignored.chunks(2)) {
        let counted = if c.shift.len() > 1 { format!("; {}", counted(program, c)) } else { String::new() };
        let constant = &model.parameters[c.parameter].name;
        let _ =
            writeln!(out, "    {} goes with its momentum {constant} = {}{counted}", name(c.coordinate), formulas[0]);
    }
    out += "    M s'' + h = 0, with\n";
    for ((i, j, _), formula) in mass.iter().zip(of_mass) {
        let _ = writeln!(out, "      M[{}, {}] = {formula}", name(kept[*i]), name(kept[*j]));
    }
    for (i, formula) in kept.iter().zip(of_bias) {
        let _ = writeln!(out, "      h[{}] = {formula}", name(*i));
    }
    out += "    and by quadrature\n";
    for (c, formulas) in ignored.iter().zip(of_ignored.chunks(2)) {
        let left = if c.own() == 1 { String::new() } else { format!("/{}", c.own()) };
        let _ = writeln!(out, "      {}'{left} = {}", name(c.coordinate), formulas[1]);
    }
    if !parts.is_empty() {
        out += "    where\n";
    }
    for (part, formula) in parts {
        let _ = writeln!(out, "      {part} = {formula}");
    }
    let full = program.counts.accelerations;
    let _ = writeln!(
        out,
        "    accelerations are those of all equations to {worst:.1e} of their terms at {states} random states\n    \
         {operations} operations an evaluation instead of {full}, {rate_operations} for what is left to quadrature: {}",
        if *operations < full { "cheaper" } else { "not cheaper" }
    );
    out
}

/// `b counted from a`, with multiples where they are not alike.
fn counted(program: &Program, c: &Ignored) -> String {
    let name = |i: usize| &program.model.coordinates[i].name;
    let from = |times: i64| match (times, c.own()) {
        (times, own) if times == own => name(c.coordinate).clone(),
        (times, 1) => format!("{times}*{}", name(c.coordinate)),
        (times, own) => format!("{times}*{}/{own}", name(c.coordinate)),
    };
    let others = c.shift.iter().filter(|(i, _)| *i != c.coordinate);
    others.map(|(i, times)| format!("{} is counted from {}", name(*i), from(*times))).collect::<Vec<_>>().join(", ")
}
