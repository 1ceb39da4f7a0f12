//! `modes --sampled`: loops that ticks close.

use std::io::Write;

use clap::ArgMatches;
use clap::parser::ValueSource;
use dalembert_symbolic::diagnose::quoted;
use dalembert_symbolic::expr::Symbol;
use nalgebra::{Complex, DMatrix};
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::{Loaded, pairs};
use super::super::{Problem, json};
use super::contacts::ContactsAtRest;
use super::states::OF_MODES;
use super::{MOST_PRINTED, failed};
use crate::linear::{Guess, SampledLoop, linearise_sampled, periods, short, ticking};
use crate::mechanism::{System, Text, Trigger};

/// Finds the rest of the loop and its map, and prints the eigenvalues.
pub fn run(loaded: &Loaded, options: &ArgMatches, guess: Guess, out: &mut dyn Write) -> Result<(), Problem> {
    let given = |option: &&str| options.value_source(option) == Some(ValueSource::CommandLine);
    if let Some(option) = OF_MODES.into_iter().chain(["steady", "here", "state-space"]).find(given) {
        return Err(Problem::usage(format!(
            "--{option} is for small motions that are not sampled: leave it out, or leave out --sampled for the open loop"
        )));
    }
    let system = &*loaded.system;
    let guess = Guess { inputs: inputs(loaded, options, &guess.inputs)?, ..guess };
    let found = linearise_sampled(system, &guess, system.memory()).map_err(failed)?;
    let (rest, held) = found.rest();
    let mut at_rest = system.boxed_clone();
    at_rest.set_memory(held);
    let contacts = ContactsAtRest::of(&*at_rest, rest);
    for warning in &contacts.warnings {
        eprintln!("warning: {warning}");
    }
    match options.get_flag("json") {
        true => Ok(json::write(&as_json(&loaded.name, &found, system, &contacts), out)?),
        false => {
            table(&loaded.name, &found, system, out)?;
            Ok(contacts.table(out)?)
        }
    }
}

/// Inputs as they are given; those that are not, and contain no time, keep the file's value: set points of the loop.
fn inputs(loaded: &Loaded, options: &ArgMatches, held: &[f64]) -> Result<Vec<f64>, Problem> {
    let program = loaded.program()?;
    let graph = &program.model.graph;
    let moves = |k: usize| graph.symbols([program.signals[k][0]]).contains(&Symbol::Time);
    let names = &loaded.system.description().inputs;
    let mut values = vec![0.0; 3 * names.len()];
    loaded.system.inputs(0.0, &mut values);
    let given = pairs(options, "input")?;
    let is_given = |name: &str| given.iter().any(|(known, _)| known == name);
    let value = |(k, name): (usize, &Text)| if is_given(name) || moves(k) { held[k] } else { values[3 * k] };
    Ok(names.iter().enumerate().map(value).collect())
}

fn table(name: &str, found: &SampledLoop, system: &dyn System, out: &mut dyn Write) -> Result<(), Problem> {
    writeln!(out, "{name}: the loop closed by ticks rests at {found}")?;
    writeln!(out, "  {:.1e} of its terms left of an equation at most", found.residual)?;
    if !found.unread.is_empty() {
        writeln!(out, "  left out, for nothing reads it but what sets it: {}", quoted(&found.unread))?;
    }
    if !found.frozen.is_empty() {
        writeln!(out, "  left out, for they set something, but at no tick: the events {}", quoted(&found.frozen))?;
    }
    let (period, instants) = (short(found.period), found.instants);
    let s = if instants == 1 { "" } else { "s" };
    writeln!(
        out,
        "a period of {period} s with {instants} instant{s} of ticks: x ↦ P x, x = [{}]",
        found.variables.join(", ")
    )?;
    if found.variables.len() <= MOST_PRINTED {
        writeln!(out, "  P =")?;
        for row in found.matrix.row_iter() {
            writeln!(out, "    [{}]", row.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))?;
        }
    }
    for (z, s) in found.multipliers.iter().zip(&found.exponents).filter(|(z, _)| z.im >= 0.0) {
        writeln!(out, "  z = {}, |z| = {}, ln z/T = {} 1/s", complex(*z), short(z.norm()), complex(*s))?;
    }
    if found.forgotten > 0 {
        writeln!(
            out,
            "  and {} that {} 0: held values that the next tick forgets",
            found.forgotten,
            are(found.forgotten)
        )?;
    }
    for k in found.aliased() {
        if found.exponents[k].im >= 0.0 {
            writeln!(
                out,
                "  warning: z = {} turns almost half round in a period: what vibrates faster than {} Hz looks slower when it is seen so seldom",
                complex(found.multipliers[k]),
                short(0.5 / found.period)
            )?;
        }
    }
    stability(found, out)?;
    thresholds(found, system, out)
}

/// Whether departures die out, and what does so at no period.
fn stability(found: &SampledLoop, out: &mut dyn Write) -> Result<(), Problem> {
    writeln!(
        out,
        "stability: {}",
        match (found.is_stable(), found.grows()) {
            (true, _) => "departures die out",
            (false, true) => "some departures do not die out",
            (false, false) => "some departures do not die out: some |z| is 1, to rounding",
        }
    )?;
    if !found.alone.is_empty() {
        let alone: Vec<String> = found.alone.iter().filter(|s| s.im >= 0.0).map(|s| complex(*s)).collect();
        writeln!(
            out,
            "  |z| is 1 whatever the period of motions e^(st) that nothing damps and ticks do not move, or do not see: s = {} 1/s",
            alone.join(", ")
        )?;
    }
    Ok(())
}

/// Periods at which stability changes, and what is varied with them.
fn thresholds(found: &SampledLoop, system: &dyn System, out: &mut dyn Write) -> Result<(), Problem> {
    let (events, triggers, clocks) = (&system.description().events, &system.sampling().triggers, ticking(system));
    // Of several clocks each has its own period, under the name of its event.
    let name = |clock: usize| {
        let event = triggers.iter().position(|trigger| *trigger == Trigger::Tick(clock as u32));
        let event = event.filter(|_| clocks.len() > 1).and_then(|event| events.get(event));
        event.map_or_else(String::new, |event| format!(" of `{}`", event.name))
    };
    let at = |factor: f64| {
        let of = |(clock, every): &(usize, f64)| format!("{} s{}", rounded(factor * every), name(*clock));
        clocks.iter().map(of).collect::<Vec<_>>().join(", ")
    };
    let other = if found.alone.is_empty() { "" } else { " other" };
    match found.critical_factor {
        Some(factor) => writeln!(out, "  some{other} |z| is 1 from a period of {} on", at(factor))?,
        None => writeln!(out, "  no period was found from which on some{other} |z| is 1")?,
    }
    if let Some([least, most]) = found.looked_in_part() {
        writeln!(
            out,
            "  (looked for closely from {} to {}; beyond, narrow windows may be missed)",
            at(least),
            at(most)
        )?;
    }
    if let Some(factor) = found.least_factor {
        writeln!(out, "  some{other} |z| is 1 from a period of {} down", at(factor))?;
    }
    if found.critical_factor.or(found.least_factor).is_none() {
        return Ok(());
    }
    if !found.varied.is_empty() {
        writeln!(out, "  {} varied with it", quoted(&found.varied))?;
        return Ok(());
    }
    writeln!(out, "  nothing but the ticks varied: what the law takes for its period stays")?;
    let stays = staying(system);
    if !stays.is_empty() {
        writeln!(out, "  {} of the same value stays; `every: {}` lets it follow", quoted(&stays), stays[0])?;
    }
    Ok(())
}

/// A period with ten digits: rounding of eigenvalues takes the rest.
fn rounded(period: f64) -> f64 {
    format!("{period:.9e}").parse().unwrap_or(period)
}

/// Parameters that have the value of a period, of which no clock is made.
fn staying(system: &dyn System) -> Vec<String> {
    let (values, periods) = (system.parameters(), periods(system));
    let known = system.description().parameters.iter().zip(values);
    let same = known.filter(|(known, value)| known.unit == "s" && periods.contains(value));
    same.map(|(known, _)| known.name.to_string()).collect()
}

fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// `0.9 ± 0.1i`; a number alone where it is real.
fn complex(z: Complex<f64>) -> String {
    if z.im == 0.0 { short(z.re) } else { format!("{} ± {}i", short(z.re), short(z.im.abs())) }
}

fn as_json(name: &str, found: &SampledLoop, system: &dyn System, contacts: &ContactsAtRest) -> Value {
    let named = |list: &[(String, f64)]| object(list.iter().map(|(name, value)| (name.clone(), number(*value))));
    let pair = |x: &Complex<f64>| Value::Array(vec![number(x.re), number(x.im)]);
    let matrix = |m: &DMatrix<f64>| -> Value {
        m.row_iter().map(|row| row.iter().map(|x| number(*x)).collect::<Vec<_>>()).collect::<Vec<_>>().into()
    };
    let times = |factor: Option<f64>| match factor {
        Some(factor) => Value::Array(periods(system).iter().map(|every| number(factor * every)).collect()),
        None => Value::Null,
    };
    let warned = (!contacts.warnings.is_empty()).then(|| ("warnings", json!(contacts.warnings)));
    let entries = [
        ("model", json!(name)),
        ("equilibrium", named(&found.place)),
        ("memory", named(&found.memory)),
        ("unread", json!(found.unread)),
        ("frozen", json!(found.frozen)),
        ("residual", number(found.residual)),
        ("period", number(found.period)),
        ("instants", json!(found.instants)),
        ("variables", json!(found.variables)),
        ("map", matrix(&found.matrix)),
        ("z", found.multipliers.iter().map(pair).collect::<Vec<_>>().into()),
        ("forgotten", json!(found.forgotten)),
        ("alone", found.alone.iter().map(pair).collect::<Vec<_>>().into()),
        ("s", found.exponents.iter().map(pair).collect::<Vec<_>>().into()),
        ("aliased", json!(found.aliased())),
        ("stable", json!(found.is_stable())),
        ("critical_periods", times(found.critical_factor)),
        ("least_periods", times(found.least_factor)),
        ("looked_factors", found.looked.iter().map(|factor| number(*factor)).collect::<Vec<_>>().into()),
        ("varied", json!(found.varied)),
    ];
    object(entries.into_iter().chain(contacts.as_json()).chain(warned))
}
