//! What varies from run to run.

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use dalembert_symbolic::print::fnv1a;

use crate::Settings;
use crate::cli::Problem;
use crate::cli::load::{Loaded, pairs, refuse_model_again, standard_input};
use crate::cli::set_up::{Place, Reader, parameter_index, place_in_state, unknown, with_unit_of};
use crate::mechanism::System;

/// More runs than this are refused: their table would not fit into memory.
const MOST: usize = 10_000_000;

/// Something that takes a value in each run.
pub struct Varied {
    pub name: String,
    target: Target,
}

#[derive(Clone, Copy)]
enum Target {
    Parameter(usize),
    /// A component of [q; q'] at the start.
    Start(usize),
    /// The seeds of all noise.
    Seeds,
}

/// The values of all runs.
pub struct Points {
    pub varied: Vec<Varied>,
    values: Values,
}

enum Values {
    /// One list for each; every combination is run, the last varying fastest.
    Grid(Vec<Vec<f64>>),
    /// One row for each run.
    List(Vec<Vec<f64>>),
}

impl Points {
    /// Reads `--vary`, `--seeds` and `--points`.
    pub fn read(loaded: &Loaded, reader: &mut Reader, options: &ArgMatches) -> Result<Points, Problem> {
        let grid = pairs(options, "vary")?;
        let list = options.get_one::<String>("points");
        let seeds = options.get_one::<String>("seeds");
        let points = match (grid.is_empty() && seeds.is_none(), list) {
            (false, None) => Points::grid(loaded, reader, &grid, seeds)?,
            (true, Some(path)) => {
                refuse_model_again(loaded, "points", path)?;
                Points::list(loaded, path)?
            }
            _ => {
                let wanted = "a sweep wants --vary NAME=A..B:COUNT, --seeds A..B, or --points FILE.csv";
                return Err(Problem::usage(wanted));
            }
        };
        let mut names: Vec<&str> = points.varied.iter().map(|varied| varied.name.as_str()).collect();
        names.sort_unstable();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(Problem::usage(format!("`{}` is varied twice", pair[0]))),
            None => Ok(points),
        }
    }

    fn grid(
        loaded: &Loaded,
        reader: &mut Reader,
        given: &[(String, String)],
        seeds: Option<&String>,
    ) -> Result<Points, Problem> {
        let mut varied = Vec::new();
        let mut lists = Vec::new();
        let mut count = 1_usize;
        for (name, text) in given {
            let (one, sets) = Varied::named(loaded, name)?;
            let list = values(loaded, reader, ("vary", sets), text)?;
            count = count.saturating_mul(list.len());
            varied.push(one);
            lists.push(list);
        }
        if let Some(text) = seeds {
            if loaded.system.held_noise().iter().all(|noise| noise.seed.is_none()) {
                return Err(Problem::usage(format!("--seeds: {} has no noise with a seed of its own", loaded.name)));
            }
            let own = |index: usize| loaded.system.held_noise().iter().any(|noise| noise.seed == Some(index as u32));
            let seed = |one: &&Varied| matches!(one.target, Target::Parameter(index) if own(index));
            if let Some(seed) = varied.iter().find(seed) {
                let name = &seed.name;
                return Err(Problem::usage(format!(
                    "`{name}` is varied by --vary and by --seeds, which sets the seeds of all noise; leave one of them out"
                )));
            }
            let list = whole_numbers(text)?;
            count = count.saturating_mul(list.len());
            varied.push(Varied { name: "seed".to_owned(), target: Target::Seeds });
            lists.push(list);
        }
        if count > MOST {
            return Err(Problem::usage(format!("--vary asks for more than {MOST} runs")));
        }
        Ok(Points { varied, values: Values::Grid(lists) })
    }

    fn list(loaded: &Loaded, path: &str) -> Result<Points, Problem> {
        let unread =
            |problem: &dyn std::fmt::Display| Problem::File(format!("--points: cannot read {path}: {problem}"));
        let text = match path {
            "-" => standard_input()?,
            _ => std::fs::read_to_string(path).map_err(|e| Problem::unread(path, &e))?,
        };
        let mut table = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let names = table.headers().map_err(|e| unread(&e))?.clone();
        let varied =
            names.iter().map(|name| Ok(Varied::named(loaded, name)?.0)).collect::<Result<Vec<_>, Problem>>()?;
        let mut rows = Vec::new();
        for (place, record) in table.records().enumerate() {
            let record = record.map_err(|e| unread(&e))?;
            let read = |text: &str| match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(number),
                _ => Err(Problem::usage(format!("{path}, line {}: `{text}` is no number", place + 2))),
            };
            rows.push(record.iter().map(read).collect::<Result<Vec<_>, _>>()?);
        }
        if rows.is_empty() || rows.len() > MOST {
            return Err(Problem::usage(format!("{path} has {} runs; there may be 1 to {MOST}", rows.len())));
        }
        Ok(Points { varied, values: Values::List(rows) })
    }

    /// How many runs there are.
    pub fn len(&self) -> usize {
        match &self.values {
            Values::Grid(lists) => lists.iter().map(Vec::len).product(),
            Values::List(rows) => rows.len(),
        }
    }

    /// What varies, and the values of each: how many, the first and the last, and a hash of all.
    pub fn summary(&self) -> Vec<(String, String)> {
        let names: Vec<String> = self.varied.iter().map(Varied::column).collect();
        let summary = |values: &mut dyn Iterator<Item = f64>| {
            let all: Vec<String> = values.map(|value| format!("{value:?}")).collect();
            let (first, last) = (all.first().map_or("", String::as_str), all.last().map_or("", String::as_str));
            format!("{} from {first} to {last} ({:016x})", all.len(), fnv1a(&all.join(",")))
        };
        let of = |place: usize| match &self.values {
            Values::Grid(lists) => summary(&mut lists[place].iter().copied()),
            Values::List(rows) => summary(&mut rows.iter().map(|row| row[place])),
        };
        let values = names.iter().enumerate().map(|(place, name)| (format!("values of {name}"), of(place)));
        values.chain([("varies".to_owned(), names.join(", "))]).collect()
    }

    /// The values of one run.
    pub fn at(&self, index: usize) -> Vec<f64> {
        match &self.values {
            Values::List(rows) => rows[index].clone(),
            Values::Grid(lists) => {
                let mut left = index;
                let mut values: Vec<f64> = lists
                    .iter()
                    .rev()
                    .map(|list| {
                        let value = list[left % list.len()];
                        left /= list.len();
                        value
                    })
                    .collect();
                values.reverse();
                values
            }
        }
    }
}

impl Varied {
    /// A parameter, or a coordinate or a speed at the start.
    fn named(loaded: &Loaded, name: &str) -> Result<(Varied, Sets), Problem> {
        let description = loaded.system.description();
        let n = loaded.system.len();
        let of = |target| Varied { name: name.to_owned(), target };
        let start = |place| match place {
            Place::Coordinate(index) => (of(Target::Start(index)), Sets::Coordinate(index)),
            Place::Speed(index) => (of(Target::Start(n + index)), Sets::Speed(index)),
        };
        if name.ends_with('\'') {
            return place_in_state(loaded, name).map(start);
        }
        if let Ok(index) = parameter_index(loaded, name) {
            return Ok((of(Target::Parameter(index)), Sets::Parameter(index)));
        }
        if let Ok(place) = place_in_state(loaded, name) {
            return Ok(start(place));
        }
        if description.derived.iter().any(|derived| derived == name) {
            parameter_index(loaded, name)?;
        }
        let known = description.parameters.iter().map(|p| p.name.as_ref());
        Err(unknown(
            "parameter or coordinate",
            name,
            known.chain(description.coordinates.iter().map(|c| c.state().unwrap_or(&c.name))),
        ))
    }

    /// What its column is called: a coordinate at the start is another thing than at the end.
    pub fn column(&self) -> String {
        match self.target {
            Target::Parameter(_) | Target::Seeds => self.name.clone(),
            Target::Start(_) => format!("{} at the start", self.name),
        }
    }

    /// Sets a parameter; before the scene is asked, which may depend on it.
    pub fn set(&self, system: &mut dyn System, value: f64) {
        match self.target {
            Target::Parameter(index) => system.set_parameter(index, value),
            Target::Seeds => {
                let seeds: Vec<u32> = system.held_noise().iter().filter_map(|noise| noise.seed).collect();
                seeds.into_iter().for_each(|index| system.set_parameter(index as usize, value));
            }
            Target::Start(_) => {}
        }
    }

    /// Sets a start.
    pub fn start(&self, settings: &mut Settings, value: f64) {
        if let Target::Start(place) = self.target {
            settings.start_at(place, value);
        }
    }
}

/// `A..B`, or `A,B,C`.
fn whole_numbers(text: &str) -> Result<Vec<f64>, Problem> {
    let wrong = || Problem::usage(format!("--seeds wants whole numbers, A..B or A,B,C, not `{text}`"));
    let number = |text: &str| text.trim().parse::<i32>().map_err(|_| wrong());
    match text.split_once("..") {
        Some((from, to)) => {
            let (from, to) = (number(from)?, number(to)?);
            if from > to || i64::from(to) - i64::from(from) >= MOST as i64 {
                return Err(wrong());
            }
            Ok((from..=to).map(f64::from).collect())
        }
        None => text.split(',').map(|one| Ok(f64::from(number(one)?))).collect(),
    }
}

/// `A..B:COUNT`, evenly spaced; `A..B:COUNT:log`, evenly in the logarithm; or `A,B,C`.
pub fn values(
    loaded: &Loaded,
    reader: &mut Reader,
    (option, sets): (&str, Sets),
    text: &str,
) -> Result<Vec<f64>, Problem> {
    let wrong =
        || Problem::usage(format!("--{option} wants NAME=A..B:COUNT, NAME=A..B:COUNT:log or NAME=A,B,C, not `{text}`"));
    let mut value = |text: &str| reader.value(loaded, option, sets, text);
    let Some((from, rest)) = text.split_once("..") else {
        let last = text.rsplit(',').next().unwrap_or_default();
        return text.split(',').map(|one| value(&with_unit_of(one, last))).collect();
    };
    let mut rest = rest.split(':');
    let to = rest.next().ok_or_else(wrong)?;
    let count: usize = rest.next().and_then(|count| count.trim().parse().ok()).ok_or_else(wrong)?;
    let log = match rest.next().map(str::trim) {
        None => false,
        Some("log") => true,
        Some(_) => return Err(wrong()),
    };
    let (from, to) = (value(&with_unit_of(from, to))?, value(to.trim())?);
    if count == 0 || count > MOST || rest.next().is_some() {
        return Err(wrong());
    }
    if log && !(from > 0.0 && to > 0.0) {
        return Err(Problem::usage(format!("--{option}: `{text}` has no logarithm at its ends")));
    }
    // Both ends as they were given.
    let at = |k: usize| match k {
        0 => from,
        k if k == count - 1 => to,
        k if log => in_logarithm((from, to), (k, count - 1)),
        k => evenly((from, to), (k, count - 1)),
    };
    let all: Vec<f64> = (0..count).map(at).collect();
    if let Sets::Parameter(parameter) = sets {
        for value in &all {
            reader.whole_seed(loaded, &format!("--{option}"), parameter, *value)?;
        }
    }
    Ok(all)
}

/// The value after k of so many equal steps; what is rounding beside the ends is 0.
fn evenly((from, to): (f64, f64), (k, steps): (usize, usize)) -> f64 {
    let value = from + k as f64 * (to - from) / steps as f64;
    if value.abs() <= f64::EPSILON * (from.abs() + to.abs()) { 0.0 } else { value }
}

/// Logarithms of numbers that are no further from a whole one than this are whole but for rounding: they are no larger than 700.
const WHOLE: f64 = 1e-12;

/// The same in the logarithm; a power of ten away from the beginning it has the digits of that.
fn in_logarithm((from, to): (f64, f64), (k, steps): (usize, usize)) -> f64 {
    let decades = k as f64 * (to.log10() - from.log10()) / steps as f64;
    let (digits, exponent) = (format!("{from:e}"), decades.round());
    match digits.split_once('e').and_then(|(digits, own)| Some((digits, own.parse::<i32>().ok()?))) {
        Some((digits, own)) if (decades - exponent).abs() <= WHOLE => {
            format!("{digits}e{}", own + exponent as i32).parse().unwrap_or(f64::NAN)
        }
        _ => from * 10f64.powf(decades),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn evenly_spaced_values_have_an_exact_zero() {
        assert_eq!(evenly((0.0, 3.0), (1, 30)), 0.1);
        for (from, to, count, zero) in [(-1.0, 2.0, 7, 2), (-0.3, 0.6, 4, 1), (0.7, -0.7, 15, 7), (-1e9, 1e9, 101, 50)]
        {
            let values: Vec<f64> = (0..count).map(|k| evenly((from, to), (k, count - 1))).collect();
            assert_eq!(values[zero], 0.0, "{values:?}");
            assert_eq!(values.iter().filter(|value| **value == 0.0).count(), 1, "{values:?}");
        }
    }

    #[test]
    fn values_evenly_in_the_logarithm_have_exact_powers_of_ten() {
        let all = |from: f64, to: f64, count: usize| -> Vec<f64> {
            (0..count).map(|k| in_logarithm((from, to), (k, count - 1))).collect()
        };
        assert_eq!(all(1e-3, 1e3, 7), [1e-3, 1e-2, 1e-1, 1.0, 10.0, 100.0, 1000.0]);
        assert_eq!(all(2e5, 2e-5, 11), [2e5, 2e4, 2e3, 2e2, 2e1, 2.0, 2e-1, 2e-2, 2e-3, 2e-4, 2e-5]);
        let octaves = all(1.0, 8.0, 4);
        assert!(octaves.iter().zip([1.0, 2.0, 4.0, 8.0]).all(|(a, b)| (a - b).abs() < 1e-15 * b), "{octaves:?}");
    }
}
