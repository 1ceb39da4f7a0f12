//! What `simulate --plot` draws, and `--animate` beside the mechanism: `--show`, `--section` and `--with`.

use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::model::Sets;

use super::Problem;
use super::load::Loaded;
use super::set_up::{Reader, unknown};
use crate::mechanism::{Description, HIDDEN};
use crate::run::Names;
use crate::show::{Chart, Figure, is_picture};
use crate::{Error, Run};

/// The charts that are asked for; none: those that a run has by itself.
pub struct Shown {
    charts: Vec<Asked>,
    /// States at multiples of this time only, s.
    section: Option<f64>,
}

enum Asked {
    /// Against time.
    History(Vec<String>),
    /// Of each pair the second over the first.
    Portraits(Vec<(String, String)>),
}

impl Shown {
    /// Reads the options; names are looked up before anything is computed.
    pub fn read(loaded: &Loaded, options: &ArgMatches) -> Result<Shown, Problem> {
        let charts = options.get_many::<String>("show").into_iter().flatten();
        let charts =
            charts.map(|text| asked(loaded.system.description(), text)).collect::<Result<Vec<Asked>, Problem>>()?;
        let animated = options.get_one::<String>("animate").filter(|_| !options.contains_id("plot"));
        if animated.is_some_and(|path| is_picture(Path::new(path))) && !charts.is_empty() {
            return Err(Problem::usage("--show draws beside a page: `--animate FILE.html`"));
        }
        let section = options.get_one::<String>("section");
        let section = section.map(|text| Reader::default().value(loaded, "section", Sets::Time, text)).transpose()?;
        if section.is_some_and(|period| period <= 0.0) {
            return Err(Problem::usage("--section wants a time greater than 0"));
        }
        if section.is_some() && !charts.iter().all(|chart| matches!(chart, Asked::Portraits(_))) {
            return Err(Problem::usage("--section draws points of a portrait: `--show X:Y`"));
        }
        let outputs = Names::of(loaded.system.description()).outputs;
        let of_output = |chart: &Asked| match chart {
            Asked::Portraits(pairs) => {
                pairs.iter().flat_map(|(x, y)| [x, y]).find(|name| outputs.contains(name)).cloned()
            }
            Asked::History(_) => None,
        };
        if let Some(name) = charts.iter().find_map(of_output).filter(|_| section.is_some()) {
            return Err(Problem::usage(format!(
                "`{name}` is an output, which is known at reported times only; --section wants coordinates and rates"
            )));
        }
        Ok(Shown { charts, section })
    }

    /// One figure of several runs, each with the name that its curves get where there are several.
    pub fn figure(&self, runs: &[(String, &Run)]) -> Result<Figure, Error> {
        let mut figure = Figure::default();
        for (name, run) in runs {
            let mut charts = if self.charts.is_empty() { run.figure().charts } else { self.of(run)? };
            if let Some(first) = charts.first_mut() {
                first.title = run.description.name.to_string();
            }
            for (place, mut chart) in charts.into_iter().enumerate() {
                if runs.len() > 1 {
                    // Whose they are could not be seen.
                    chart.instants.clear();
                    for series in &mut chart.series {
                        series.name =
                            if series.name.is_empty() { name.clone() } else { format!("{}, {name}", series.name) };
                    }
                }
                match figure.charts.get_mut(place) {
                    Some(known) => known.series.extend(chart.series),
                    None => figure.charts.push(chart),
                }
            }
        }
        Ok(figure)
    }

    /// What was asked for, of one run.
    pub fn of(&self, run: &Run) -> Result<Vec<Chart>, Error> {
        let mut charts = Vec::new();
        for asked in &self.charts {
            match (asked, self.section) {
                (Asked::History(names), _) => charts.extend(histories(run, names)?),
                (Asked::Portraits(pairs), period) => {
                    let mut found = Vec::new();
                    for (x, y) in pairs {
                        let chart = match period {
                            None => run.portrait(x, y)?,
                            Some(period) => run.section(x, y, period)?,
                        };
                        found.push(if period.is_none() && is_path(run, x, y) { chart.equal() } else { chart });
                    }
                    charts.extend(together(run, pairs, found));
                }
            }
        }
        Ok(charts)
    }
}

/// Portraits over axes with the same units as one chart with a curve each, `y[1] over x[1]`.
fn together(run: &Run, pairs: &[(String, String)], charts: Vec<Chart>) -> Vec<Chart> {
    let mut all: Vec<(String, String, Chart)> = Vec::new();
    let several = charts.len() > 1;
    for ((x, y), mut chart) in pairs.iter().zip(charts) {
        let (across, up) = (run.unit(x), run.unit(y));
        if several {
            chart.series.iter_mut().for_each(|series| series.name = format!("{y} over {x}"));
        }
        match all.iter_mut().find(|(a, b, _)| *a == across && *b == up) {
            Some((_, _, known)) => {
                known.series.extend(chart.series);
                (known.x.label, known.y.label) = (join(&known.x.label, x), join(&known.y.label, y));
            }
            None => all.push((across, up, chart)),
        }
    }
    all.into_iter().map(|(_, _, chart)| chart).collect()
}

/// The label of an axis that stands for one name more.
fn join(label: &str, name: &str) -> String {
    let there = label.split(", ").any(|known| known == name);
    if there { label.to_owned() } else { format!("{label}, {name}") }
}

/// A chart against time for each unit among these.
fn histories(run: &Run, names: &[String]) -> Result<Vec<Chart>, Error> {
    let mut units: Vec<(String, Vec<&str>)> = Vec::new();
    for name in names {
        let unit = run.unit(name);
        match units.iter_mut().find(|(known, _)| *known == unit) {
            Some((_, alike)) => alike.push(name),
            None => units.push((unit, vec![name])),
        }
    }
    units.iter().map(|(_, alike)| run.history(alike)).collect()
}

/// Whether these are components of one vector or two lengths, whose path keeps its shape.
fn is_path(run: &Run, x: &str, y: &str) -> bool {
    let owner = |name: &str| name.rsplit_once('.').map(|(owner, _)| owner.to_owned());
    let lengths = run.unit(x) == "m" && run.unit(y) == "m";
    lengths || owner(x).is_some() && owner(x) == owner(y)
}

/// `A,B` against time, or `X:Y`, `X:Y,Z:W`.
fn asked(description: &Description, text: &str) -> Result<Asked, Problem> {
    let portrait = |text: &str| {
        let Some((x, y)) = text.split_once(':') else {
            return Err(Problem::usage(format!(
                "--show `{text}` stands beside portraits X:Y; a chart against time is a --show of its own"
            )));
        };
        let one = |name: &str| match columns(description, name)?.as_slice() {
            [one] => Ok(one.clone()),
            several => Err(Problem::usage(format!(
                "`{}` is a vector; a portrait wants one of {}",
                name.trim(),
                several.join(", ")
            ))),
        };
        Ok((one(x)?, one(y)?))
    };
    match text.contains(':') {
        true => Ok(Asked::Portraits(parts(text).map(portrait).collect::<Result<_, Problem>>()?)),
        false => Ok(Asked::History(listed(description, text)?)),
    }
}

/// The columns of `A,B`.
pub fn listed(description: &Description, text: &str) -> Result<Vec<String>, Problem> {
    let names = parts(text).map(|name| columns(description, name)).collect::<Result<Vec<_>, Problem>>()?;
    Ok(names.concat())
}

/// What stands between commas outside of brackets, `x[1,2]` being one name.
pub fn parts(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0;
    let pieces = text.split(move |c: char| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        c == ',' && depth == 0
    });
    pieces.map(str::trim)
}

/// The same without what is empty.
pub fn filled_parts(text: &str) -> impl Iterator<Item = &str> {
    parts(text).filter(|part| !part.is_empty())
}

/// The columns of a name: itself, or the components of a vector output.
fn columns(description: &Description, name: &str) -> Result<Vec<String>, Problem> {
    let name = name.trim();
    let known: Vec<String> =
        Names::of(description).columns().into_iter().filter(|name| !name.starts_with(HIDDEN)).collect();
    if known.iter().any(|column| column == name) {
        return Ok(vec![name.to_owned()]);
    }
    let parts: Vec<String> = known
        .iter()
        .filter(|column| column.strip_prefix(name).is_some_and(|rest| rest.starts_with('.')))
        .cloned()
        .collect();
    if parts.is_empty() {
        return Err(unknown("coordinate, rate or output", name, known.iter().map(String::as_str)));
    }
    Ok(parts)
}
