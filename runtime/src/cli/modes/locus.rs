//! `--vary`, `--locus` and `--campbell`: eigenvalues as a parameter or a speed changes.

use std::io::Write;

use clap::ArgMatches;
use nalgebra::Complex;
use serde_json::{Value, json};

use super::super::json::{number, object};
use super::super::load::{Loaded, pairs};
use super::super::set_up::Reader;
use super::super::{Problem, outputs};
use super::failed;
use super::steady::Speeds;
use crate::linear::{
    Branch, BranchPoint, CriticalSpeed, Equilibrium, Guess, LinearError, Threshold, ThresholdKind,
    campbell as drawn_frequencies, follow, root_locus, short, short_beside,
};
use crate::show::Series;

/// Eigenvalues as a parameter or speed goes from one value to another.
pub struct Locus {
    parameter: String,
    unit: String,
    range: (f64, f64),
    coordinates: Vec<String>,
    branch: Branch,
    /// Where orders of the speed meet frequencies; `None` where nobody asks, and of what is no speed.
    critical: Option<Vec<CriticalSpeed>>,
}

/// Digits of thresholds at most: they are bisected to some more, and rounding of eigenvalues takes these.
const DIGITS: f64 = 10.0;

impl Locus {
    /// Follows the equilibrium, or the steady motion with these speeds, while the parameter changes, and draws; `None` if that
    /// is not asked for.
    pub fn new(
        loaded: &Loaded,
        options: &ArgMatches,
        reader: &mut Reader,
        start: &Equilibrium,
        speeds: &Speeds,
    ) -> Result<Option<Locus>, Problem> {
        let mut given = pairs(options, "vary")?.into_iter();
        let Some((parameter, text)) = given.next() else {
            return match options.contains_id("locus") {
                true => Err(Problem::usage("--locus wants --vary NAME=A..B beside it")),
                false => Ok(None),
            };
        };
        if given.next().is_some() {
            return Err(Problem::usage("--vary takes one parameter or speed"));
        }
        let (varied, unit, sets) = speeds.varied(loaded, reader, &parameter)?;
        let range = super::range(loaded, reader, "vary", sets, &text)?;
        // Speeds that follow from others go on following.
        let guess = Guess { v: speeds.v.clone(), ..start.guess() };
        let branch = follow(&*loaded.system, &varied, range, &guess).map_err(failed)?;
        let orders = orders(options, &parameter, &unit)?;
        let [locus, campbell] = ["locus", "campbell"].map(|name| options.get_one::<String>(name));
        let mut critical = None;
        if locus.or(campbell).is_some() {
            let points = branch.smooth(&*loaded.system, &varied, &guess).map_err(failed)?;
            let steps = steps(&branch, &points);
            locus.map_or(Ok(()), |path| outputs::draw(path, root_locus(&parameter, &unit, &steps)))?;
            if let Some(path) = campbell {
                let found = branch.critical_speeds(&*loaded.system, &varied, &guess, (&points, &orders));
                let found = found.map_err(failed)?;
                let chart = drawn_frequencies(&parameter, &unit, &steps, &orders);
                let marks = Series::marks("critical", found.iter().map(|met| Some((met.value, met.omega))));
                outputs::draw(path, if found.is_empty() { chart } else { chart.with(marks) })?;
                // Orders are of a speed of rotation.
                critical = (!orders.is_empty()).then_some(found);
            }
        }
        let coordinates = start.coordinates.clone();
        Ok(Some(Locus { parameter, unit, range, coordinates, branch, critical }))
    }

    /// The states of the branch itself, without those behind folds.
    fn steps(&self) -> impl Iterator<Item = &BranchPoint> {
        self.branch.points.iter().filter(|point| !point.folded)
    }

    /// The values that a coordinate, or what is varied, takes along the branch and at the ends of the range.
    pub fn values_of(&self, name: &str) -> Vec<f64> {
        if name == self.parameter {
            return vec![self.range.0, self.range.1];
        }
        let index = self.coordinates.iter().position(|known| known == name);
        let of = |point: &BranchPoint| index.and_then(|index| point.q.get(index).copied());
        self.branch.points.iter().filter_map(of).collect()
    }

    /// What the numbers alone do not tell.
    pub fn notes(&self) -> Vec<String> {
        let state = |q: &[f64]| {
            let scale = q.iter().fold(1e-300_f64, |most, q| most.max(q.abs()));
            let list = self.coordinates.iter().zip(q).map(|(name, q)| format!("{name} = {}", short_beside(*q, scale)));
            list.collect::<Vec<_>>().join(", ")
        };
        let changes = self.branch.changes.iter().map(|change| {
            format!(
                "the branch ends at {} ({}); beyond it another one is followed, from {}",
                self.exactly(change.value, 0.0),
                state(&change.from),
                state(&change.to)
            )
        });
        let missing = self.branch.missing.iter().map(|((low, high), error)| match low == high {
            true => format!("nothing at {}: {error}", self.value(*low)),
            false => format!("nothing from {} to {}: {error}", self.value(*low), self.value(*high)),
        });
        changes.chain(missing).collect()
    }

    /// The key `locus`.
    pub fn as_json(&self) -> (&'static str, Value) {
        let step = |point: &BranchPoint| {
            let list: Vec<Value> = point.eigenvalues.iter().map(|x| json!([number(x.re), number(x.im)])).collect();
            let state = self.coordinates.iter().cloned().zip(point.q.iter().map(|q| number(*q)));
            object([
                ("value", number(point.value)),
                ("equilibrium", object(state)),
                ("folds", json!(point.folds)),
                ("growing", json!(point.growing)),
                ("eigenvalues", list.into()),
            ])
        };
        let limit = |threshold: &Threshold| {
            object([
                ("value", number(threshold.value)),
                ("hidden", number(threshold.hidden)),
                ("kind", json!(threshold.kind.word())),
                ("omega", number(threshold.omega)),
                ("growing", json!(threshold.growing)),
                ("stable_above", json!(threshold.growing[1] == 0)),
                ("behind_a_fold", json!(threshold.folded)),
                ("constraint", json!(threshold.constraint)),
            ])
        };
        let change = |change: &crate::linear::Change| {
            let state = |q: &[f64]| object(self.coordinates.iter().cloned().zip(q.iter().map(|q| number(*q))));
            object([("value", number(change.value)), ("from", state(&change.from)), ("to", state(&change.to))])
        };
        let missing = |((low, high), error): &((f64, f64), LinearError)| {
            object([("from", number(*low)), ("to", number(*high)), ("why", json!(error.to_string()))])
        };
        let met = |critical: &CriticalSpeed| {
            let CriticalSpeed { value, order, omega, decay } = *critical;
            let numbers = [("value", value), ("order", order), ("omega", omega), ("decay", decay)];
            object(numbers.map(|(name, x)| (name, number(x))))
        };
        let locus = object([
            ("parameter", json!(self.parameter)),
            ("limits", self.branch.thresholds.iter().map(limit).collect::<Vec<_>>().into()),
            ("changes", self.branch.changes.iter().map(change).collect::<Vec<_>>().into()),
            ("missing", self.branch.missing.iter().map(missing).collect::<Vec<_>>().into()),
            ("closed", json!(self.branch.closed)),
            ("critical_speeds", self.critical.as_ref().map_or(Value::Null, |list| list.iter().map(met).collect())),
            ("steps", self.steps().map(step).collect::<Vec<_>>().into()),
        ]);
        ("locus", locus)
    }

    /// For people.
    pub fn table(&self, out: &mut dyn Write) -> Result<(), Problem> {
        let ends = self.steps().next().into_iter().chain(self.steps().last());
        writeln!(out, "eigenvalues as {} changes:", self.parameter)?;
        for point in ends {
            let scale = point.eigenvalues.iter().fold(0.0_f64, |most, x| most.max(x.norm()));
            let mut upper: Vec<&Complex<f64>> = point.eigenvalues.iter().filter(|x| x.im >= -1e-12 * scale).collect();
            upper.sort_by(|a, b| a.im.total_cmp(&b.im).then(a.re.total_cmp(&b.re)));
            let list = counted(upper.into_iter().map(|x| complex(x, scale)));
            let grows = if point.growing > 0 { "unstable" } else { "nothing grows" };
            writeln!(out, "  {}: {grows}; {}", self.value(point.value), list.join(", "))?;
        }
        let rising = self.range.0 <= self.range.1;
        let mut thresholds: Vec<&Threshold> = self.branch.thresholds.iter().collect();
        if !rising {
            thresholds.reverse();
        }
        for threshold in thresholds {
            let behind = if threshold.folded { ", behind a fold" } else { "" };
            writeln!(out, "  {}: {}{behind}", self.exactly(threshold.value, threshold.hidden), self.told(threshold))?;
        }
        if self.branch.closed {
            writeln!(out, "  the branch is closed: it returns to where it began")?;
        }
        let met = |critical: &CriticalSpeed| {
            format!("{}: order {}", self.exactly(critical.value, 0.0), short(critical.order))
        };
        if let Some(critical) = &self.critical {
            writeln!(out, "critical speeds, where a frequency is a multiple (order) of {}:", self.parameter)?;
            for line in counted(critical.iter().map(met)) {
                writeln!(out, "  {line}")?;
            }
            if critical.is_empty() {
                writeln!(out, "  none in this range")?;
            }
        }
        Ok(())
    }

    fn unit(&self) -> &str {
        if self.unit == "1" { "" } else { &self.unit }
    }

    fn value(&self, value: f64) -> String {
        let shown = if self.is_zero(value) { 0.0 } else { value };
        format!("{} = {} {}", self.parameter, short(shown), self.unit()).trim_end().to_owned()
    }

    /// What is no more than rounding of the range.
    fn is_zero(&self, value: f64) -> bool {
        value.abs() <= 1e-12 * (self.range.1 - self.range.0).abs()
    }

    /// With as many digits as an uncertainty leaves.
    fn exactly(&self, value: f64, uncertainty: f64) -> String {
        let digits = (-(uncertainty / value.abs()).log10()).floor().clamp(1.0, DIGITS) as usize;
        let text = match self.is_zero(value) || value.abs() <= uncertainty {
            true => "0".to_owned(),
            false => {
                let rounded = format!("{value:.*e}", digits - 1).parse::<f64>();
                rounded.map_or_else(|_| short(value), |rounded| rounded.to_string())
            }
        };
        format!("{} = {text} {}", self.parameter, self.unit()).trim_end().to_owned()
    }

    /// What happens at a threshold, on the way through the range.
    fn told(&self, threshold: &Threshold) -> String {
        let rising = self.range.0 <= self.range.1;
        let Threshold { kind, growing: [below, above], omega, .. } = *threshold;
        let row = threshold.constraint.as_deref().unwrap_or_default();
        let (before, after) = if rising { (below, above) } else { (above, below) };
        let what = match kind {
            ThresholdKind::Dependence => {
                return format!(
                    "the constraint `{row}` depends on others here: the mechanism may go on in another shape"
                );
            }
            ThresholdKind::Fold if threshold.constraint.is_some() => {
                return format!("the branch folds back: beyond, `{row}` and other constraints cannot be met");
            }
            ThresholdKind::Fold => return "the branch folds back".to_owned(),
            ThresholdKind::Pole => {
                let name = threshold.coordinate.and_then(|index| self.coordinates.get(index));
                return format!("{} grows beyond all bounds (pole)", name.map_or("a coordinate", String::as_str));
            }
            ThresholdKind::Bifurcation => return "the branch meets another and turns back (bifurcation)".to_owned(),
            ThresholdKind::Divergence => "divergence".to_owned(),
            ThresholdKind::Flutter => format!("flutter, {} rad/s", short(omega)),
        };
        let begins = match (before, after) {
            _ if !threshold.crosses && after > before => "growth goes on and oscillates no more",
            _ if !threshold.crosses => "growth goes on and oscillates from here on",
            (0, _) => "a motion begins to grow",
            (_, 0) => "growth ends",
            (before, after) if after > before => "one more motion begins to grow",
            _ => "one motion ceases to grow",
        };
        format!("{begins} ({what})")
    }
}

/// Values and eigenvalues of states, with a gap where one does not go on as the next.
fn steps(branch: &Branch, points: &[BranchPoint]) -> Vec<(f64, Vec<Complex<f64>>)> {
    let mut steps: Vec<(f64, Vec<Complex<f64>>)> = Vec::new();
    for (index, point) in points.iter().enumerate() {
        if index > 0 && !branch.joins(&points[index - 1], point) {
            steps.push((point.value, Vec::new()));
        }
        steps.push((point.value, point.eigenvalues.clone()));
    }
    steps
}

/// The orders of `--orders`: 1 and 2 of a speed of rotation unless others are given, none of anything else.
fn orders(options: &ArgMatches, parameter: &str, unit: &str) -> Result<Vec<f64>, Problem> {
    let turns = matches!(unit, "rad/s" | "1/s");
    let Some(text) = options.get_one::<String>("orders") else {
        return Ok(if turns { vec![1.0, 2.0] } else { Vec::new() });
    };
    if !turns && !matches!(unit, "" | "1") {
        return Err(Problem::usage(format!(
            "--orders: `{parameter}` has the unit {unit}; orders are multiples of a speed of rotation in rad/s"
        )));
    }
    let order = |text: &str| match text.trim().parse::<f64>() {
        Ok(order) if order > 0.0 && order.is_finite() => Ok(order),
        _ => Err(Problem::usage(format!("--orders: `{}` is no positive number", text.trim()))),
    };
    text.split(',').map(order).collect()
}

/// What follows itself once, with how often it does; no more than are printed, and how many there are besides.
fn counted(texts: impl Iterator<Item = String>) -> Vec<String> {
    let mut list: Vec<(String, usize)> = Vec::new();
    for text in texts {
        match list.last_mut() {
            Some((last, times)) if *last == text => *times += 1,
            _ => list.push((text, 1)),
        }
    }
    let more: usize = list.iter().skip(super::MOST_PRINTED).map(|(_, times)| times).sum();
    let shown = list.into_iter().take(super::MOST_PRINTED);
    let told = shown.map(|(text, times)| if times == 1 { text } else { format!("{text} ({times} times)") });
    told.chain((more > 0).then(|| format!("and {more} more"))).collect()
}

/// `-0.1`, `-0.1 +- 2i`.
fn complex(x: &Complex<f64>, scale: f64) -> String {
    let re = short_beside(x.re, scale);
    if x.im.abs() <= 1e-12 * scale { re } else { format!("{re} +- {}i", short(x.im)) }
}
