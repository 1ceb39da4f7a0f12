//! `--drive`, `--omega`, `--bode`, `--response`: steady states and frequency responses.

use std::f64::consts::TAU;
use std::io::Write;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;
use nalgebra::Complex;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::Loaded;
use super::super::plotted::{listed, parts};
use super::super::set_up::Reader;
use super::super::{Problem, outputs};
use super::failed;
use super::model::Model;
use super::shaken::{Shakeable, Shaken, named};
use crate::linear::{Linearised, Mode, Peak, Response, Steady, short, short_beside, short_within, turned};
use crate::numbers::spaced;

/// Below this part of its static stiffness a coordinate by itself is near resonance.
const NEAR_RESONANCE: f64 = 0.3;

/// What was asked of a drive, and its answers.
pub struct Driven {
    /// What drives, in words: `push1`, or `1*C + 1*D`.
    label: String,
    /// The file's coordinates, and their units.
    axes: Axes,
    steady: Option<Steady>,
    /// What else than coordinates was asked for, at the frequency of the steady state.
    answers: Vec<Answer>,
    response: Option<Response>,
    /// The largest of each of its answers.
    peaks: Vec<Option<Peak>>,
    /// The mode that grows fastest, by its number, and the time in which it grows by e, s.
    unstable: Option<(usize, f64)>,
}

/// A rate's or an output's amplitude; `None` where an undamped mode makes it infinite.
struct Answer {
    name: String,
    unit: String,
    amplitude: Option<Complex<f64>>,
}

impl Driven {
    /// Computes what `--omega`, `--bode`, `--response` and `--range` ask for, and draws; `None` if nothing is asked.
    pub fn new(
        loaded: &Loaded,
        options: &ArgMatches,
        reader: &mut Reader,
        model: Model<'_>,
    ) -> Result<Option<Driven>, Problem> {
        let option = |name: &str| options.get_one::<String>(name);
        let (omega, bode_file, range) = (option("omega"), option("bode"), option("range"));
        let answers = option("response");
        let responds = bode_file.is_some() || range.is_some() || answers.is_some();
        if omega.is_none() && !responds {
            return match options.contains_id("drive") {
                true => Err(Problem::usage("--drive wants --omega, --bode or --range beside it")),
                false => Ok(None),
            };
        }
        let Shaken { drive, label, per } = drive(loaded, options, reader, model)?;
        let coordinates = &loaded.system.description().coordinates;
        let axes = coordinates.iter().map(|axis| (axis.name.to_string(), axis.unit.to_string())).collect();
        let mut driven = Driven {
            label,
            axes,
            steady: None,
            answers: Vec::new(),
            response: None,
            peaks: Vec::new(),
            unstable: None,
        };
        driven.unstable = fastest_growth(&model.linear().modes().map_err(failed)?);
        let names = match answers {
            None => driven.axes.iter().map(|axis| axis.0.clone()).collect(),
            Some(text) => listed(loaded.system.description(), text)?,
        };
        if let Some(text) = omega {
            let omega = reader.value(loaded, "omega", Sets::Frequency, text)?;
            if omega < 0.0 {
                return Err(Problem::usage(format!("--omega is `{text}`; a frequency is 0 or more")));
            }
            driven.steady = Some(model.steady(&drive, omega).map_err(failed)?);
            let is_coordinate = |name: &str| driven.axes.iter().any(|axis| axis.0 == name);
            let others: Vec<&str> = names.iter().map(String::as_str).filter(|name| !is_coordinate(name)).collect();
            if !others.is_empty() {
                let seen = model.observe(loaded, &others).map_err(failed)?;
                let steady = model.linear().steady(&drive, omega).map_err(failed)?;
                let found = steady.answers(&drive, &seen).map_err(failed)?;
                let named = seen.names.iter().zip(&seen.units).zip(found);
                let answer = |((name, unit), amplitude): ((&String, &String), Option<Complex<f64>>)| Answer {
                    name: name.clone(),
                    unit: unit.clone(),
                    amplitude,
                };
                driven.answers = named.map(answer).collect();
            }
        }
        if responds {
            let range = range.map(|text| frequencies(loaded, reader, text)).transpose()?;
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let seen = model.observe(loaded, &names).map_err(failed)?;
            let response = model.linear().response(&drive, &seen, range).map_err(failed)?.to(&driven.label, per);
            if let Some(path) = bode_file {
                let figure = if options.get_flag("hertz") { response.figure_in_hertz() } else { response.figure() };
                outputs::draw(path, figure)?;
            }
            driven.peaks = model.linear().peaks(&drive, &seen, &response).map_err(failed)?;
            driven.response = Some(response);
        }
        Ok(Some(driven))
    }

    /// What the numbers alone do not tell.
    pub fn notes(&self) -> Vec<String> {
        let poles = self.response.iter().flat_map(|response| &response.poles);
        let list: Vec<String> = poles.map(|omega| short(*omega)).collect();
        let reached = (!list.is_empty()).then(|| {
            let at = list.join(", ");
            format!("undamped modes at {at} rad/s: where the drive reaches one of them the answer has no bound")
        });
        let left = self.unstable.map(|(mode, time)| {
            format!(
                "the state about which this is linear is unstable (mode {mode} grows by e in {} s): the steady answer to the drive is one \
                 solution, which no motion keeps to unless a control holds it",
                short(time)
            )
        });
        left.into_iter().chain(reached).collect()
    }

    /// The keys `steady` and `response`, where they were asked for.
    pub fn as_json(&self) -> Vec<(&'static str, Value)> {
        let pair = |x: &Complex<f64>| json!([number(x.re), number(x.im)]);
        let by_name = |x: &[Complex<f64>]| object(self.axes.iter().zip(x).map(|(axis, x)| (axis.0.clone(), pair(x))));
        let mut entries = Vec::new();
        if let Some(steady) = &self.steady {
            let mode = |(omega, part): (&f64, &Vec<Complex<f64>>)| {
                object([("omega", number(*omega)), ("amplitude", by_name(part))])
            };
            let answer = |x: &Answer| (x.name.clone(), x.amplitude.as_ref().map_or(Value::Null, pair));
            entries.push((
                "steady",
                object([
                    ("drive", json!(self.label)),
                    ("omega", number(steady.omega)),
                    ("amplitude", by_name(&steady.total)),
                    ("growth", steady.growth.as_ref().map_or(Value::Null, |g| by_name(g))),
                    ("answers", object(self.answers.iter().map(answer))),
                    ("modes", steady.omegas.iter().zip(&steady.modes).map(mode).collect::<Vec<_>>().into()),
                ]),
            ));
        }
        if let Some(response) = &self.response {
            let Response { omegas, answers, names, .. } = response;
            let column = |index: usize| -> Value {
                let cell =
                    |answer: &Option<Vec<Complex<f64>>>| answer.as_ref().map_or(Value::Null, |x| pair(&x[index]));
                answers.iter().map(cell).collect::<Vec<_>>().into()
            };
            let columns = names.iter().enumerate().map(|(i, name)| (name.clone(), column(i)));
            let units = names.iter().enumerate().map(|(i, name)| (name.clone(), json!(response.unit(i))));
            let peak = |peak: &Option<Peak>| {
                let pair = |peak: &Peak| json!({"omega": number(peak.omega), "size": number(peak.size)});
                peak.as_ref().map_or(Value::Null, pair)
            };
            let largest = names.iter().zip(&self.peaks).map(|(name, found)| (name.clone(), peak(found)));
            entries.push((
                "response",
                object([
                    ("drive", json!(self.label)),
                    ("largest", object(largest)),
                    ("omega", omegas.iter().map(|omega| number(*omega)).collect::<Vec<_>>().into()),
                    ("amplitude", object(columns)),
                    ("units", object(units)),
                ]),
            ));
        }
        entries
    }

    /// For people.
    pub fn table(&self, model: Model<'_>, out: &mut dyn Write) -> Result<(), Problem> {
        if let Some(steady) = &self.steady {
            let hertz = short(steady.omega / TAU);
            writeln!(out, "steady state, if {} goes as cos({} t), {hertz} Hz:", self.label, short(steady.omega))?;
            contributions(&self.axes, steady, out)?;
            for Answer { name, unit, amplitude } in &self.answers {
                match amplitude {
                    Some(x) if *x == Complex::ZERO => writeln!(out, "  {name}: 0")?,
                    Some(x) => writeln!(out, "  {name}: {}{}, {:.1} deg", short(x.norm()), spaced(unit), degrees(x))?,
                    None => writeln!(out, "  {name}: without bound")?,
                }
            }
            growth(&self.axes, steady, out)?;
            // With constraints no coordinate has a stiffness by itself.
            if let Model::Free(linear) = model {
                if steady.growth.is_none() {
                    forces(linear, steady, &self.label, out)?;
                }
                for sentence in resting(linear, steady) {
                    writeln!(out, "  {sentence}")?;
                }
            }
        }
        if let Some(response) = &self.response {
            let (low, high) = (response.omegas[0], response.omegas[response.omegas.len() - 1]);
            writeln!(out, "largest answers to {} between {} and {} rad/s:", self.label, short(low), short(high))?;
            for (index, name) in response.names.iter().enumerate() {
                if let Some(peak) = self.peaks[index] {
                    writeln!(out, "  {name}: {}", largest_answer(response, index, &peak))?;
                }
            }
        }
        Ok(())
    }
}

/// How large an answer becomes, and where, with the digits that hold.
fn largest_answer(response: &Response, index: usize, peak: &Peak) -> String {
    let Peak { omega, size, width } = *peak;
    if size == 0.0 {
        return "0 at all frequencies".to_owned();
    }
    if let Some(mode) = response.poles.iter().find(|mode| (omega - **mode).abs() < 1e-3 * omega) {
        return format!("without bound at {} rad/s", short(*mode));
    }
    let size = format!("{}{}", short(size), spaced(&response.unit(index)));
    if width >= response.omegas[response.omegas.len() - 1] - response.omegas[0] {
        return format!("{size} at all frequencies");
    }
    let [omega, hertz] = [omega, omega / TAU].map(|frequency| short_within(frequency, width / omega));
    format!("{size} at {omega} rad/s, {hertz} Hz")
}

/// The mode that grows fastest, counted from 1, and the time in which it grows by e, s.
fn fastest_growth(modes: &[Mode]) -> Option<(usize, f64)> {
    let growing = modes.iter().enumerate().filter_map(|(k, mode)| Some((k + 1, mode.growth_time()?)));
    growing.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Coordinates by name, each with its unit.
type Axes = Vec<(String, String)>;

/// Each coordinate's amplitude, and what each mode contributes to it.
fn contributions(axes: &Axes, steady: &Steady, out: &mut dyn Write) -> Result<(), Problem> {
    let scale = largest(&steady.total).max(steady.growth.as_deref().map_or(0.0, largest));
    let polar = |x: &Complex<f64>| {
        if x.norm() <= 1e-12 * scale { "0".to_owned() } else { format!("{}<{:.0}", short4(x.norm()), degrees(x)) }
    };
    let mut rows = vec![["".to_owned(), "amplitude".to_owned(), "phase".to_owned()].to_vec()];
    rows[0].extend((1..=steady.modes.len()).map(|k| format!("mode {k}")));
    rows[0].truncate(3 + super::MOST_PRINTED);
    rows[0].extend(steady.carried.iter().map(|_| "carried along".to_owned()));
    for (index, (name, unit)) in axes.iter().enumerate() {
        let x = steady.total[index];
        let phase = if x.norm() <= 1e-12 * scale { "-".to_owned() } else { format!("{:.1} deg", degrees(&x)) };
        let amplitude = format!("{}{}", short_beside(x.norm(), scale), spaced(unit));
        let mut row = vec![name.clone(), amplitude, phase];
        row.extend(steady.modes.iter().take(super::MOST_PRINTED).map(|mode| polar(&mode[index])));
        row.extend(steady.carried.iter().map(|carried| polar(&carried[index])));
        rows.push(row);
    }
    super::report::columns(&rows, out)?;
    writeln!(
        out,
        "  (each mode's part as size<phase in degrees, A<p for A cos(w t + p); the parts add up as complex numbers)"
    )?;
    Ok(())
}

/// What grows where the force meets undamped modes.
fn growth(axes: &Axes, steady: &Steady, out: &mut dyn Write) -> Result<(), Problem> {
    let Some(growth) = &steady.growth else { return Ok(()) };
    let scale = largest(growth);
    let each = axes.iter().zip(growth).filter(|(_, g)| g.norm() > 1e-12 * scale);
    let list: Vec<String> =
        each.map(|((name, unit), g)| format!("{name} by {}{}", short(g.norm()), spaced(unit))).collect();
    writeln!(out, "  resonance: there is no steady state; every second the amplitude grows: {}", list.join(", "))?;
    writeln!(out, "  (the table holds what stays bounded)")?;
    Ok(())
}

/// What pulls at each coordinate, and how stiff it is by itself.
fn forces(linear: &Linearised, steady: &Steady, label: &str, out: &mut dyn Write) -> Result<(), Problem> {
    if linear.len() < 2 || linear.len() > super::MOST_PRINTED {
        return Ok(());
    }
    let dynamic = linear.dynamic_stiffness(steady.omega);
    let still = linear.dynamic_stiffness(0.0);
    writeln!(
        out,
        "what drives each coordinate (amplitudes), against its own dynamic stiffness |Kii + i w Cii - w^2 Mii|:"
    )?;
    for (i, name) in linear.coordinates.iter().enumerate() {
        let mut pulls: Vec<(String, f64)> = vec![(label.to_owned(), steady.force[i].norm())];
        pulls.extend(neighbours(linear, steady, i).into_iter().map(|(j, size)| (linear.coordinates[j].clone(), size)));
        pulls.retain(|pull| pull.1 > 0.0);
        let list: Vec<String> = pulls.iter().map(|(from, size)| format!("{from} {}", short4(*size))).collect();
        let (own, rest) = (dynamic[(i, i)].norm(), still[(i, i)].norm());
        let alone = if own < NEAR_RESONANCE * rest { ": alone it would be near resonance here" } else { "" };
        let list = if list.is_empty() { "nothing".to_owned() } else { list.join(", ") };
        writeln!(out, "  {name}: driven by {list}; stiffness {} (at rest {}){alone}", short4(own), short4(rest))?;
    }
    Ok(())
}

/// The coordinates that pull at one, and how much; without rounding.
fn neighbours(linear: &Linearised, steady: &Steady, i: usize) -> Vec<(usize, f64)> {
    let dynamic = linear.dynamic_stiffness(steady.omega);
    let scale = dynamic.iter().fold(0.0_f64, |most, z| most.max(z.norm())) * largest(&steady.total);
    let others = (0..linear.len()).filter(|j| *j != i);
    let pulls = others.map(|j| (j, (dynamic[(i, j)] * steady.total[j]).norm()));
    pulls.filter(|(_, size)| *size > 1e-12 * scale).collect()
}

/// Coordinates that the largest mode leaves at rest and that move in others all the same.
fn resting(linear: &Linearised, steady: &Steady) -> Vec<String> {
    // A mode that grows is larger than any other, sooner or later.
    let by_growth = steady.growth.as_ref().map(|growth| {
        let near = |k: &usize| (steady.omegas[*k] - steady.omega).abs() <= 1e-9 * steady.omega;
        ((0..steady.modes.len()).find(near), growth.clone())
    });
    let (leading, part) = match by_growth {
        Some((Some(k), growth)) => (k, growth),
        _ => {
            let size = |k: &usize| largest(&steady.modes[*k]);
            let Some(k) = (0..steady.modes.len()).max_by(|a, b| size(a).total_cmp(&size(b))) else { return Vec::new() };
            (k, steady.modes[k].clone())
        }
    };
    let (scale, total) = (largest(&part), largest(&steady.total));
    let rests = |i: &usize| part[*i].norm() < 1e-3 * scale && steady.total[*i].norm() > 1e-2 * total;
    let sentence = |i: usize| {
        let others: Vec<String> = (0..steady.modes.len())
            .filter(|k| *k != leading && steady.modes[*k][i].norm() > 1e-3 * steady.total[i].norm())
            .map(|k| (k + 1).to_string())
            .collect();
        let only = |j: &usize| {
            let others = neighbours(linear, steady, *j);
            steady.force[*j].norm() == 0.0 && !others.is_empty() && others.iter().all(|other| other.0 == i)
        };
        let driven: Vec<&str> =
            (0..linear.len()).filter(|j| *j != i).filter(only).map(|j| linear.coordinates[j].as_str()).collect();
        let effect = if driven.is_empty() { String::new() } else { format!(": it alone drives {}", driven.join(", ")) };
        format!(
            "{} rests in mode {}, the largest, and yet moves by {}{}, in mode(s) {}{effect}",
            linear.coordinates[i],
            leading + 1,
            short(steady.total[i].norm()),
            spaced(&linear.units[i]),
            others.join(", ")
        )
    };
    if linear.len() > super::MOST_PRINTED {
        return Vec::new();
    }
    (0..linear.len()).filter(rests).map(sentence).collect()
}

fn largest(x: &[Complex<f64>]) -> f64 {
    x.iter().fold(0.0, |most, x| most.max(x.norm()))
}

fn degrees(x: &Complex<f64>) -> f64 {
    let angle = x.arg().to_degrees();
    // Half a turn is late; and no -0.
    if angle > 179.95 { angle - 360.0 } else { angle + 0.0 }
}

/// Four significant digits.
fn short4(x: f64) -> String {
    let rounded: f64 = format!("{x:.3e}").parse().unwrap_or(x);
    short(rounded)
}

/// What `--drive` names: the first input if it is absent.
fn drive(loaded: &Loaded, options: &ArgMatches, reader: &mut Reader, model: Model<'_>) -> Result<Shaken, Problem> {
    let linear = model.linear();
    let given = options.get_many::<String>("drive").into_iter().flatten();
    let mut given: Vec<String> = given.flat_map(|text| parts(text)).map(str::to_owned).collect();
    if given.is_empty() {
        let Some(input) = loaded.system.description().inputs.first() else {
            let example = linear.equilibrium.coordinates.first().map_or("", String::as_str);
            return Err(Problem::usage(format!(
                "`{}` has no inputs; name a coordinate that a force acts on: --drive {example}",
                loaded.name
            )));
        };
        given.push(input.to_string());
    }
    let mut all = Shaken::default();
    let alone = given.len() == 1;
    for text in given {
        let (text, phase) = text.split_once('<').map_or((text.as_str(), None), |(text, phase)| (text, Some(phase)));
        let (name, amplitude) = text.split_once('=').map_or((text.trim(), "1"), |(name, value)| (name.trim(), value));
        model.can_move(name).map_err(failed)?;
        let (Shaken { drive, label, per }, sets) = named(loaded, reader, &Shakeable::of(linear), name)?;
        let size = reader.value(loaded, "drive", sets, amplitude)?;
        let phase = phase.map_or(Ok(0.0), |text| angle(loaded, reader, text))?;
        let times = if size == 1.0 { String::new() } else { format!("{} times ", short(size)) };
        let before = if all.label.is_empty() { String::new() } else { format!("{} and ", all.label) };
        let at = if phase == 0.0 { String::new() } else { format!(" at {} deg", short(phase.to_degrees())) };
        all.label = format!("{before}{times}{label}{at}");
        all.per = if alone && size == 1.0 { per } else { String::new() };
        let amplitude = turned(size, phase);
        all.drive.parts.extend(drive.parts.into_iter().map(|(source, part)| (source, part * amplitude)));
    }
    match model.depends_on(loaded, &all.drive).map_err(failed)? {
        true => Ok(all),
        false => Err(Problem::Run(format!("{} does not act on small motions here", all.label))),
    }
}

/// The phase after `<`, rad: numbers alone are degrees, `0.5 rad` and `pi/2` are what they say.
fn angle(loaded: &Loaded, reader: &mut Reader, text: &str) -> Result<f64, Problem> {
    let text = text.trim();
    let of_numbers = text.parse::<f64>().is_ok() || !text.contains(char::is_alphabetic);
    let value = reader.value(loaded, "drive", Sets::Number, text)?;
    Ok(if of_numbers { value.to_radians() } else { value })
}

/// `A..B` with 0 < A < B.
fn frequencies(loaded: &Loaded, reader: &mut Reader, text: &str) -> Result<(f64, f64), Problem> {
    let (low, high) = super::range(loaded, reader, "range", Sets::Frequency, text)?;
    if low > 0.0 && high > low {
        return Ok((low, high));
    }
    Err(Problem::usage(format!("--range is `{text}`; frequencies go from more than 0 upwards")))
}
