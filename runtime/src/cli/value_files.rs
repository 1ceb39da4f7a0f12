//! Files of names with values, a line each: `m: 2 kg`, `"theta'": 0.1`.

use std::fmt::Write;
use std::fs;

use dalembert_symbolic::model::Sets;

use super::Problem;
use super::load::{Loaded, standard_input};
use super::set_up::{Place, Reader, parameter_index, place_in_state, unknown};
use crate::mechanism::{HIDDEN, Trigger};
use crate::simulate::Resumed;
use crate::{Run, Settings, State};

/// Reads such a file; `#` begins a comment, as in a model file.
///
/// # Errors
/// It cannot be read, or a line is none of these.
pub fn read(path: &str) -> Result<Vec<(String, String)>, Problem> {
    Ok(lines(path)?.into_iter().map(|(_, name, value)| (name, value)).collect())
}

/// The same with the places of the values, `FILE, line 3`.
fn lines(path: &str) -> Result<Vec<(String, String, String)>, Problem> {
    let text = match path {
        "-" => standard_input()?,
        _ => fs::read_to_string(path).map_err(|problem| Problem::unread(path, &problem))?,
    };
    let mut entries: Vec<(String, String, String)> = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line = line.split(" #").next().unwrap_or("").trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let wrong = || Problem::usage(format!("{path}:{}: `{line}` is no `name: value`", index + 1));
        let (name, value) = match line.strip_prefix('"') {
            Some(quoted) => quoted.split_once('"').ok_or_else(wrong)?,
            None => line.split_once(':').map(|(name, _)| (name, &line[name.len()..])).ok_or_else(wrong)?,
        };
        let value = value.trim_start().strip_prefix(':').ok_or_else(wrong)?.trim();
        if name.trim().is_empty() || value.is_empty() {
            return Err(wrong());
        }
        let name = name.trim();
        if entries.iter().any(|(_, known, _)| known == name) {
            return Err(Problem::usage(format!("{path}:{}: `{name}` is given twice", index + 1)));
        }
        entries.push((format!("{path}, line {}", index + 1), name.to_owned(), value.to_owned()));
    }
    Ok(entries)
}

/// Sets the parameters of a file.
///
/// # Errors
/// Names or values that are none.
pub fn parameters(loaded: &mut Loaded, reader: &mut Reader, path: &str) -> Result<(), Problem> {
    for (place, name, text) in lines(path)? {
        let index = parameter_index(loaded, &name)?;
        let value = reader.value_at(loaded, &place, Sets::Parameter(index), &text)?;
        loaded.system.set_parameter(index, value);
    }
    Ok(())
}

/// Starts from the state of a file: coordinates and rates, and where they are given time and phase; what it does not
/// name stays as the scene has it.
///
/// # Errors
/// Names or values that are none.
pub fn start(loaded: &Loaded, reader: &mut Reader, path: &str, settings: &mut Settings) -> Result<(), Problem> {
    let length = settings.until - settings.from;
    let lines = lines(path)?;
    if lines.is_empty() {
        return Err(Problem::usage(format!("{path} states no value")));
    }
    for (place, name, text) in lines {
        match name.as_str() {
            "t" => {
                settings.from = reader.value_at(loaded, &place, Sets::Time, &text)?;
                settings.until = settings.from + length;
            }
            "phase" if place_in_state(loaded, &name).is_err() => {
                let phases = &loaded.system.description().phases;
                let found = phases.iter().position(|phase| phase.name == text);
                settings.phase =
                    found.ok_or_else(|| unknown("phase", &text, phases.iter().map(|phase| phase.name.as_ref())))?;
            }
            "step" if place_in_state(loaded, &name).is_err() => {
                resumed(settings).step = reader.value_at(loaded, &place, Sets::Time, &text)?;
            }
            name if within(name, "least").or(within(name, "most")).is_some() => {
                let (most, of) = match within(name, "most") {
                    Some(of) => (1, of),
                    None => (0, within(name, "least").unwrap_or_default()),
                };
                let (index, sets) = in_state(loaded, of, settings.q.len())?;
                let value = reader.value_at(loaded, &place, sets, &text)?;
                resumed(settings).seen[most][index] = value;
            }
            name if within(name, "error").is_some() => {
                let (index, sets) = in_state(loaded, within(name, "error").unwrap_or_default(), settings.q.len())?;
                let value: f64 = reader.value_at(loaded, &place, sets, &text)?;
                let unknown = vec![0.0; 2 * settings.q.len()];
                settings.start_errors.get_or_insert(unknown)[index] = value.abs();
            }
            name if within(name, "next").is_some() => {
                let event = within(name, "next").unwrap_or_default();
                let clock = clock_of(loaded, event)?;
                let number = text.parse().map_err(|_| {
                    Problem::usage(format!("{place}: the number of a tick is a whole number, not `{text}`"))
                })?;
                let clocks = loaded.system.sampling().clocks.len();
                let ticks = settings.ticks.get_or_insert_with(|| vec![0; clocks]);
                ticks[clock] = number;
            }
            name if loaded.system.sampling().place_of(name).is_some() => {
                let held = loaded.system.sampling().place_of(name).unwrap_or_default();
                let value = reader.value_at(loaded, &place, Sets::Memory(held), &text)?;
                let memory = settings.memory.get_or_insert_default();
                memory.get_mut(held).into_iter().for_each(|held| *held = value);
            }
            _ => match place_in_state(loaded, &name)? {
                Place::Coordinate(index) => {
                    settings.q[index] = reader.value_at(loaded, &place, Sets::Coordinate(index), &text)?;
                }
                Place::Speed(index) => {
                    settings.v[index] = reader.value_at(loaded, &place, Sets::Speed(index), &text)?;
                }
            },
        }
    }
    // A motion went through it: nothing is chosen any more.
    settings.held_q.fill(true);
    settings.held_v.fill(true);
    settings.spins.clear();
    (settings.start_conditions, settings.guessed) = (0..0, true);
    Ok(())
}

/// The place of a coordinate or rate in [q; q'] of n coordinates, and what a value there sets.
fn in_state(loaded: &Loaded, name: &str, n: usize) -> Result<(usize, Sets), Problem> {
    Ok(match place_in_state(loaded, name)? {
        Place::Coordinate(index) => (index, Sets::Coordinate(index)),
        Place::Speed(index) => (n + index, Sets::Speed(index)),
    })
}

/// NAME of `word(NAME)`: `next(EVENT)` is the number of an event's next tick, `least(theta)` and `most(theta)` what there was so far, `error(theta)` a
/// bound on the error of a value.
fn within<'a>(name: &'a str, word: &str) -> Option<&'a str> {
    name.strip_prefix(word)?.strip_prefix('(')?.strip_suffix(')')
}

/// What is known from another run; nothing of any component at first.
fn resumed(settings: &mut Settings) -> &mut Resumed {
    let unknown = vec![f64::NAN; 2 * settings.q.len()];
    settings.resumed.get_or_insert_with(|| Resumed { step: 0.0, seen: [unknown.clone(), unknown] })
}

/// The clock of an event.
fn clock_of(loaded: &Loaded, event: &str) -> Result<usize, Problem> {
    let (events, triggers) = (&loaded.system.description().events, &loaded.system.sampling().triggers);
    let ticking = events.iter().zip(triggers.iter());
    let ticking = ticking.filter_map(|(event, trigger)| match trigger {
        Trigger::Tick(clock) => Some((event.name.as_ref(), *clock as usize)),
        _ => None,
    });
    let found = ticking.clone().find(|(name, _)| *name == event).map(|(_, clock)| clock);
    found.ok_or_else(|| unknown("event that ticks", event, ticking.map(|(name, _)| name)))
}

/// The last state of a run as such a file, with all digits of each number; its parameters that are not the file's own are told.
pub fn state(run: &Run, changed: &[(String, f64)]) -> String {
    let mut text = written(run, (&run.last(), run.phases.last()), changed);
    for (name, error) in run.last_errors() {
        let _ = writeln!(text, "\"error({name})\": {error:.1e}");
    }
    if run.sampling.is_empty() {
        return text;
    }
    for (held, value) in run.sampling.memory.iter().zip(&run.memory) {
        let _ = writeln!(text, "\"{}\": {value}", held.name);
    }
    for (event, next) in run.ticks() {
        let _ = writeln!(text, "\"next({event})\": {next}");
    }
    let Some((step, seen)) = &run.resumed else { return text };
    let _ = writeln!(text, "step: {step}");
    for (word, values) in ["least", "most"].iter().zip(seen) {
        for (name, value) in run.column_names().iter().zip(values).filter(|(name, _)| !name.starts_with(HIDDEN)) {
            let _ = writeln!(text, "\"{word}({name})\": {value}");
        }
    }
    text
}

/// A start to which a search had come.
pub fn guessed_state(name: &str, start: &[(String, f64)]) -> String {
    let mut text = format!("# {name}, where a search ended, SI units\nt: 0\n");
    for (name, value) in start {
        let _ = writeln!(text, "\"{name}\": {value}");
    }
    text
}

/// The first one.
pub fn start_state(run: &Run, changed: &[(String, f64)]) -> String {
    written(run, (&run.first(), run.phases.first()), changed)
}

fn written(run: &Run, (state, phase): (&State, Option<&(f64, usize)>), changed: &[(String, f64)]) -> String {
    let phases = &run.description.phases;
    let phase = phase.and_then(|(_, phase)| phases.get(*phase)).map_or("", |phase| phase.name.as_ref());
    let with = changed.iter().map(|(name, value)| format!("{name} = {value}")).collect::<Vec<_>>().join(", ");
    let mut text = format!("# {} by {}, SI units\nt: {}\n", run.description.name, run.by(), state.t);
    if !changed.is_empty() {
        let _ = writeln!(text, "# with {with}");
    }
    if !phase.is_empty() {
        let _ = writeln!(text, "phase: {phase}");
    }
    for (name, value) in state.entries() {
        let _ = writeln!(text, "\"{name}\": {value}");
    }
    text
}
