//! Error against step size, down to rounding.

use std::ops::ControlFlow;

#[cfg(feature = "interpret")]
use super::DoubleOnly;
use super::picture::into_table;
use super::{Candidate, Measurements, Plan, Reference, measurements};
use crate::error::Error;
use crate::integrate::order as order_of;
#[cfg(feature = "interpret")]
use crate::mechanism::Interpreted;
use crate::mechanism::{Method, System};
use crate::show::{Axis, Chart, Series, Slope};
use crate::simulate::{Settings, simulate};
use crate::trust::Warning;

/// Errors of one scene over the step: a curve for each method that keeps its step.
///
/// Steps are halved from a tenth of the scene on.  Errors are the largest of |y − y_ref| beside the range that y goes through, over all
/// that is compared and ten instants at which steps of every length end, so that nothing is read between steps.
///
/// ```
/// # use dalembert::prelude::*;
/// # use dalembert::precision::{Candidate, Convergence, Plan};
/// # dalembert::model!(yaml = r#"
/// # name: Swing
/// # coordinates: {theta: rad}
/// # kinetic_energy: theta'^2/2
/// # potential_energy: -9.81*cos(theta)
/// # scene: {start: {theta: 2}, until: 3}
/// # "#);
/// let swing = Swing::default().system();
/// let candidates = Candidate::fixed_steps(&swing, &Settings::new(&swing.scene(0)));
/// let found = Convergence::measure(&candidates[..3], &Plan::default(), &mut |_| std::ops::ControlFlow::Continue(()))?;
/// let rk4 = found.curves.iter().find(|curve| curve.name == "rk4").unwrap();
/// assert!((rk4.observed_order().unwrap() - 4.0).abs() < 0.2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Convergence {
    /// What the chart is called.
    pub title: String,
    /// What errors are measured from.
    pub reference: Reference,
    /// Curves of those that suit the scene, in the order of the candidates.
    pub curves: Vec<StepCurve>,
    /// Who does not, and why.
    pub refused: Vec<(String, String)>,
}

/// A candidate's errors, from long steps to short ones.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StepCurve {
    /// The candidate's name.
    pub name: String,
    /// The order that its method has by theory; none for `exact`.
    pub order: Option<u32>,
    /// From long steps to short ones.
    pub points: Vec<StepPoint>,
}

/// One run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StepPoint {
    /// The step, s; the average where ticks and known times cut several that were asked for alike.
    pub step: f64,
    /// How many were taken; 0 where the run failed.
    pub steps: u64,
    /// The largest error in parts of ranges, or a word for why there is none.
    pub error: Result<f64, &'static str>,
}

/// Errors are taken at so many instants.
const INSTANTS: usize = 10;
/// A curve is rounding where so many halvings of the step have not halved its least error.
const STANDSTILL: usize = 4;
/// Errors above this part of a range, or less than so many times the least, tell nothing of the order: long steps are not yet in
/// proportion to a power, short ones are rounding, whose errors differ by some ten times from step to step.
const COARSE: f64 = 1e-2;
const CLEAR: f64 = 30.0;

impl Candidate {
    /// Every method whose error is that of a step it is given: all but those with error control, `exact`, and `moreau`, whose error is that of impacts.
    pub fn fixed_steps(system: &dyn System, settings: &Settings) -> Vec<Candidate> {
        let others = |method: &Method| matches!(method, Method::Exact | Method::Moreau);
        let fixed = Method::ALL.into_iter().filter(|method| !method.is_adaptive() && !others(method));
        fixed.map(|method| Candidate::new(method.name(), system, Settings { method, ..settings.clone() })).collect()
    }
}

impl Convergence {
    /// So many steps are enough where nobody says otherwise: some seconds of a small mechanism.
    pub const MOST_STEPS: u64 = 1_000_000;

    /// Runs every candidate with ever shorter steps, until they make no difference any more or a run would take more than its
    /// [`max_steps`](Settings::max_steps); `progress` is told the name of each one, and may break off.
    ///
    /// # Errors
    /// As [`WorkPrecision::measure`](super::WorkPrecision::measure).
    pub fn measure(
        candidates: &[Candidate],
        plan: &Plan,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Convergence, Error> {
        Convergence::against(candidates, |first| Reference::find(first, &plan.columns), progress)
    }

    /// The same with errors from a motion in double-double, as [`WorkPrecision::measure_extended`](super::WorkPrecision::measure_extended):
    /// only so do curves show the methods' own rounding.
    ///
    /// # Errors
    /// As [`WorkPrecision::measure`](super::WorkPrecision::measure).
    #[cfg(feature = "interpret")]
    pub fn measure_extended(
        candidates: &[Candidate],
        plan: &Plan,
        model: Result<&Interpreted, DoubleOnly>,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Convergence, Error> {
        let of = |first: &Candidate| Ok(Reference::find(first, &plan.columns)?.extended(first, model));
        Convergence::against(candidates, of, progress)
    }

    fn against(
        candidates: &[Candidate],
        reference: impl Fn(&Candidate) -> Result<Reference, Error>,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Convergence, Error> {
        let Measurements { title, reference, curves, refused } =
            measurements(candidates, (&reference, &StepCurve::measure), progress)?;
        Ok(Convergence { title, reference, curves, refused })
    }

    /// Error over step, with a triangle for each order.
    pub fn chart(&self) -> Chart {
        let digits = self.reference.digits();
        let mut chart = Chart::new(
            format!("{}, measured from {} ({digits} digits)", self.title, self.reference.by()),
            Axis::new("step", "s").log(),
            Axis::new("error (part of the range)", "").log(),
        );
        for curve in &self.curves {
            let points = curve.measured().filter(|(_, error)| *error > 0.0);
            let order = curve.observed_order().map_or_else(String::new, |order| format!(", order {order:.1}"));
            chart.series.push(Series::marked_line(curve.name.clone() + &order, points.map(Some)));
            let drawn = chart.slopes.iter().any(|slope| Some(slope.order) == curve.order.map(f64::from));
            chart.slopes.extend(curve.triangle().filter(|_| !drawn));
        }
        chart
    }

    /// One line for each candidate: its order by theory and as observed, its least error, and at which step that is.
    pub fn table(&self) -> String {
        let width = self.curves.iter().map(|curve| curve.name.chars().count()).max().unwrap_or(0).max(9);
        let mut text = format!(
            "{:width$}  {:>5}  {:>8}  {:>11}  {:>9}  {:>9}\n",
            "method", "order", "observed", "least error", "step (s)", "steps"
        );
        for curve in &self.curves {
            let order = curve.order.map_or("-".to_owned(), |order| order.to_string());
            let observed = curve.observed_order().map_or("-".to_owned(), |order| format!("{order:.2}"));
            text += &format!("{:width$}  {order:>5}  {observed:>8}", curve.name);
            if let Some((point, error)) = curve.least() {
                text += &format!("  {error:>11.1e}  {:>9.1e}  {:>9}", point.step, point.steps);
            }
            let failed: Vec<&str> =
                curve.points.iter().filter_map(|point| point.error.as_ref().err()).copied().collect();
            if let Some(why) = failed.first() {
                text += &format!(
                    "  {why} with {}",
                    if failed.len() == 1 {
                        "the longest step".to_owned()
                    } else {
                        format!("{} longest steps", failed.len())
                    }
                );
            }
            text = text.trim_end().to_owned() + "\n";
        }
        text
    }

    /// Where curves end: in rounding, in what the reference is known to, or at the largest number of steps.
    pub fn sentence(&self) -> String {
        let named = |ends: &dyn Fn(&StepCurve) -> bool| {
            let names: Vec<&str> =
                self.curves.iter().filter(|curve| ends(curve)).map(|curve| curve.name.as_str()).collect();
            (!names.is_empty()).then(|| names.join(", "))
        };
        let floor = self.reference.floor();
        let known = |curve: &StepCurve| curve.least().is_some_and(|(_, error)| error <= floor);
        let rounding = |curve: &StepCurve| known(curve) || curve.stands_still();
        let mut sentences = Vec::new();
        if let Some(names) = named(&rounding) {
            sentences.push(format!("Shorter steps make no difference any more for {names}."));
        }
        if let Some(names) = named(&|curve| !rounding(curve)) {
            sentences
                .push(format!("Errors still fall with the most steps that were taken for {names}: see --max-steps."));
        }
        if floor > f64::EPSILON {
            sentences.push(format!("Errors below {floor:.0e} are not known."));
        }
        sentences.join(" ")
    }

    /// All points, a line each.
    pub fn to_csv(&self) -> String {
        let points = self.curves.iter().flat_map(|curve| curve.points.iter().map(move |point| (curve, point)));
        into_table(
            &["scene", "method", "order", "step_s", "steps", "error", "failure"],
            points.map(|(curve, point)| {
                let (error, failure) = match point.error {
                    Ok(error) => (format!("{error:e}"), String::new()),
                    Err(code) => (String::new(), code.to_owned()),
                };
                let order = curve.order.map(|order| order.to_string()).unwrap_or_default();
                let (step, steps) = (format!("{:e}", point.step), point.steps.to_string());
                vec![self.title.clone(), curve.name.clone(), order, step, steps, error, failure]
            }),
        )
    }
}

impl StepCurve {
    fn measure(candidate: &Candidate, reference: &Reference) -> Result<StepCurve, Error> {
        let mut system = candidate.system.boxed_clone();
        let method = candidate.settings.method;
        let order = (method != Method::Exact).then(|| order_of(method));
        let mut curve = StepCurve { name: candidate.name.clone(), order, points: Vec::new() };
        let (apart, interval) = reference.instants(INSTANTS);
        let mut step = interval;
        while INSTANTS as f64 * interval / step <= candidate.settings.max_steps as f64 {
            let settings =
                Settings { step: Some(step), max_steps: u64::MAX, ..reference.compared(&candidate.settings) };
            let point = match simulate(&mut *system, &settings) {
                Ok(run) => {
                    let found = reference.differences(&run);
                    let error = found.iter().skip(apart).step_by(apart).take(INSTANTS).copied().fold(0.0, f64::max);
                    let unstable = |warning: &Warning| matches!(warning, Warning::StepExceedsStability { .. });
                    let error = match error <= 1.0 {
                        // What is smaller is not known.
                        true => Ok(error.max(reference.floor())),
                        false if run.warnings.iter().any(unstable) => Err("unstable"),
                        false => Err("lost"),
                    };
                    StepPoint { step, steps: run.work.steps, error }
                }
                Err(Error::Run(failure)) => StepPoint { step, steps: 0, error: Err(failure.cause.code()) },
                Err(error) => return Err(error),
            };
            // A shorter step that is cut into as many is no further run.
            match curve.points.last_mut().filter(|before| before.steps > 0 && before.steps == point.steps) {
                Some(before) => before.step = INSTANTS as f64 * interval / point.steps as f64,
                None => curve.points.push(point),
            }
            if curve.stands_still() {
                break;
            }
            step /= 2.0;
        }
        Ok(curve)
    }

    /// (step, error) of the runs that came to something.
    pub fn measured(&self) -> impl Iterator<Item = (f64, f64)> {
        self.points.iter().filter_map(|point| Some((point.step, *point.error.as_ref().ok()?)))
    }

    /// The run with the least error, and that error.
    pub fn least(&self) -> Option<(&StepPoint, f64)> {
        let found = self.points.iter().filter_map(|point| Some((point, *point.error.as_ref().ok()?)));
        found.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The order at which errors fall with the step: the median from each step to the next between long ones and rounding.
    pub fn observed_order(&self) -> Option<f64> {
        let order = |pair: &[(f64, f64)]| (pair[0].1 / pair[1].1).ln() / (pair[0].0 / pair[1].0).ln();
        let mut slopes: Vec<f64> = self.falling().windows(2).map(order).collect();
        slopes.sort_by(f64::total_cmp);
        slopes.get(slopes.len() / 2).copied()
    }

    /// The points between long steps and rounding.
    fn falling(&self) -> Vec<(f64, f64)> {
        let least = self.least().filter(|_| self.stands_still()).map_or(0.0, |(_, error)| error);
        self.measured().filter(|(_, error)| *error <= COARSE && *error >= CLEAR * least).collect()
    }

    /// A triangle of the order of theory, below the middle of the points that fall, where they fall over its decade.
    fn triangle(&self) -> Option<Slope> {
        let falling = self.falling();
        let (x, y) = *falling.get(falling.len() / 2)?;
        let fits = falling.first().is_some_and(|(longest, _)| 10.0 * x <= *longest);
        fits.then_some(Slope { x, y: y / CLEAR, order: f64::from(self.order?) })
    }

    /// True where shorter steps have not made a difference for a while.
    fn stands_still(&self) -> bool {
        let errors: Vec<f64> = self.measured().map(|(_, error)| error).collect();
        let Some(before) = errors.len().checked_sub(STANDSTILL).filter(|before| *before > 0) else { return false };
        let least = |errors: &[f64]| errors.iter().copied().fold(f64::INFINITY, f64::min);
        let reached = least(&errors[..before]);
        reached < COARSE && least(&errors[before..]) > 0.5 * reached
    }
}
