//! Columns along a motion that was run.

use super::junction::{Column, Guard, cross, put, shifts};
use super::variational::Variational;
use super::{NoSlopes, Unknown};
use crate::cause::Cause;
use crate::driver::{Followed, Integration, StepPolicy};
use crate::integrate::Tolerance;
use crate::mechanism::{At, Method, System};
use crate::run::{Junction, Plan, Recorder, Run, Side};
use crate::simulate::Interruption;
use crate::trust::Warning;

/// Columns at a time.
#[derive(Clone, Debug)]
pub(super) struct Moment {
    /// s.
    pub t: f64,
    /// [q; q'] and its columns, one after the other.
    pub columns: Vec<Vec<f64>>,
}

/// How columns are followed.
pub(super) struct Way<'a> {
    pub tolerance: f64,
    pub max_steps: u64,
    pub interruption: &'a Interruption,
    /// Times, in order, at which columns are wanted; the last is the run's end.
    pub times: &'a [f64],
}

/// Columns along a motion.
pub(super) struct Flow {
    pub moments: Vec<Moment>,
    /// By how much each moves the last instant at which the equations change, s.
    pub shifts: Vec<f64>,
    /// The steps that they took.
    pub steps: u64,
}

/// Follows columns from the start of a run to its end, with its steps or shorter ones.
///
/// # Errors
/// Instants at which there are no slopes; what ends a motion early.
pub(super) fn follow(
    system: &mut dyn System,
    run: &Run,
    (start, mut columns): (Side, Vec<Column>),
    way: &Way<'_>,
) -> Result<Flow, NoSlopes> {
    let moments = Vec::with_capacity(way.times.len());
    let mut flow = Flow { moments, shifts: vec![0.0; columns.len()], steps: 0 };
    let mut from = start;
    let mut wanted = way.times;
    let first = from.t;
    let speeds = largest_speeds(run);
    if let Some(junction) = run.junctions.iter().find(|junction| junction.accumulates) {
        return Err(NoSlopes::ImpactsAccumulate { t: junction.before.t });
    }
    if let Some(junction) = run.junctions.iter().find(|junction| junction.rebounds) {
        return Err(NoSlopes::Rebounds { t: junction.before.t });
    }
    no_share_decides(run)?;
    let junctions: Vec<Option<&Junction>> = run.junctions.iter().map(Some).chain([None]).collect();
    for junction in junctions {
        let last = way.times.last().copied().unwrap_or(first);
        let until = junction.map_or(last, |junction| junction.before.t);
        put(system, &from);
        let count = wanted.partition_point(|t| *t < until || (junction.is_none() && *t <= until));
        let (here, later) = wanted.split_at(count);
        piece(system, run, (&from, &mut columns), (here, until), way, &mut flow)?;
        wanted = later;
        if let Some(junction) = junction {
            flow.shifts = cross(system, (junction, &speeds), &mut columns, junction.before.t <= first)?;
            from = junction.after.clone();
        }
    }
    Ok(flow)
}

/// Refuses a motion that depends on how forces are shared that the equations leave open: the share moves with the place.
pub(crate) fn no_share_decides(run: &Run) -> Result<(), NoSlopes> {
    let shared = run.warnings.iter().find_map(|warning| match warning {
        Warning::MotionNotUnique { constraints, .. } => Some(constraints.clone()),
        _ => None,
    });
    shared.map_or(Ok(()), |constraints| Err(NoSlopes::Shares { constraints }))
}

/// Follows columns along a smooth piece, as far as `until`, and writes them down at times on the way.
fn piece(
    system: &dyn System,
    run: &Run,
    (from, columns): (&Side, &mut [Column]),
    (times, until): (&[f64], f64),
    way: &Way<'_>,
    flow: &mut Flow,
) -> Result<(), NoSlopes> {
    let moments = &mut flow.moments;
    let n = system.len();
    let parameters: Vec<Option<usize>> = columns.iter().map(|column| column.parameter).collect();
    let mut varied = Variational::new(system, &parameters);
    put(varied.base_mut(), from);
    let mut y = packed(&from.y, columns, n);
    let mut t = from.t;
    let ends: Vec<f64> = times.iter().copied().filter(|time| *time > t).chain([until]).collect();
    for time in times.iter().filter(|time| **time <= t) {
        moments.push(Moment { t: *time, columns: unpacked(&y, columns.len(), n) });
    }
    if until > t {
        let floors = floors(run, columns, way.tolerance);
        let mut steps = Steps::begin(&mut varied, run, (t, &y, &floors), until, way)?;
        for (k, end) in ends.iter().enumerate() {
            flow.steps += steps.advance(&mut varied, *end, way.interruption)?;
            t = *end;
            y = steps.state().to_vec();
            if k + 1 < ends.len() {
                moments.push(Moment { t, columns: unpacked(&y, columns.len(), n) });
            }
        }
    }
    if times.last() == Some(&until) && moments.last().is_none_or(|moment| moment.t < until) {
        moments.push(Moment { t: until, columns: unpacked(&y, columns.len(), n) });
    }
    for (column, found) in columns.iter_mut().zip(unpacked(&y, parameters.len(), n).split_off(1)) {
        column.y = found;
    }
    Ok(())
}

/// Errors of [q, δq …, q', δq' …] that count as none: y, and a column p ∂y/∂p, is known to [`BESIDE`] of the tolerance beside the range of
/// what has y's unit, so that what is 0 but for rounding is no reason for short steps.
fn floors(run: &Run, columns: &[Column], tolerance: f64) -> Vec<f64> {
    let coordinates = &run.description.coordinates;
    let (n, width) = (coordinates.len(), 2 * coordinates.len());
    let ranges: Vec<f64> = (0..width).map(|i| range(run, width, i)).collect();
    let alike = |i: usize| {
        let same = (0..n).filter(|k| coordinates[*k].unit == coordinates[i % n].unit);
        same.map(|k| ranges[k + if i < n { 0 } else { n }]).fold(0.0, f64::max)
    };
    let part = (BESIDE * tolerance).max(ROUNDING);
    let floor =
        |half: usize, size: f64| (half * n..(half + 1) * n).map(move |i| part * alike(i) / size).collect::<Vec<f64>>();
    let sizes: Vec<f64> = std::iter::once(1.0).chain(columns.iter().map(|column| column.size)).collect();
    (0..2).flat_map(|half| sizes.iter().flat_map(|size| floor(half, *size)).collect::<Vec<f64>>()).collect()
}

/// The largest |q'| of a run.
fn largest_speeds(run: &Run) -> Vec<f64> {
    let n = run.description.coordinates.len();
    let most = |i: usize| run.rows.chunks_exact(2 * n).map(|row| row[n + i].abs()).fold(0.0, f64::max);
    (0..n).map(most).collect()
}

/// How far a number of [q; q'] goes in a run, or how large it is where it stays.
pub(super) fn range(run: &Run, width: usize, i: usize) -> f64 {
    let values = run.rows.chunks_exact(width.max(1)).map(|row| row[i]);
    let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
    Some(high - low).filter(|range| *range > 0.0).unwrap_or(high.abs())
}

/// Errors of columns, beside those of the motion: small, since weak influences are wanted too.
const BESIDE: f64 = 1e-3;
/// So much of what a number is made of may be rounding.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// [q, δq …, q', δq' …].
fn packed(y: &[f64], columns: &[Column], n: usize) -> Vec<f64> {
    let half = |part: usize| {
        let of = move |list: &[f64]| list[part * n..(part + 1) * n].to_vec();
        std::iter::once(of(y)).chain(columns.iter().map(move |column| of(&column.y))).flatten()
    };
    half(0).chain(half(1)).collect()
}

/// [q; q'], then its columns.
fn unpacked(y: &[f64], count: usize, n: usize) -> Vec<Vec<f64>> {
    let (places, rates) = y.split_at(n * (count + 1));
    places.chunks_exact(n).zip(rates.chunks_exact(n)).map(|(q, v)| [q, v].concat()).collect()
}

/// A piece under way.
struct Steps {
    integration: Integration,
    recorder: Recorder,
    until: f64,
}

impl Steps {
    fn begin(
        varied: &mut Variational,
        run: &Run,
        (t, y, floors): (f64, &[f64], &[f64]),
        until: f64,
        way: &Way<'_>,
    ) -> Result<Steps, NoSlopes> {
        let tolerance = Box::new(Tolerance::new(way.tolerance, varied.description(), y).at_least(floors));
        let method = method(run, varied);
        let policy = match method {
            // Columns of parabolas are parabolas.
            Method::Verlet => StepPolicy::Fixed(until - t),
            _ => StepPolicy::Adaptive { tolerance, longest: f64::INFINITY },
        };
        let plan = Plan::quiet(until, until - t, method);
        let integration = Integration::new(method, policy, t, y, false).limit(way.max_steps);
        let followed = Followed::new(&run.step_ends, 1.0);
        let mut integration = integration.following(if method == Method::Verlet { None } else { followed });
        integration.begin(varied, until).map_err(|cause| NoSlopes::Fault { t, cause: *cause })?;
        let recorder = Recorder::new(&plan, varied, t, integration.state());
        Ok(Steps { integration, recorder, until })
    }

    /// As far as `end`; how many steps that takes.
    fn advance(&mut self, varied: &mut Variational, end: f64, interruption: &Interruption) -> Result<u64, NoSlopes> {
        let mut steps = 0;
        let fault = |t: f64, cause: Cause| NoSlopes::Fault { t, cause };
        while self.integration.time() < end {
            let taken = self.integration.one(varied, end, &mut self.recorder);
            steps += 1;
            let t = self.integration.time();
            taken.map_err(|cause| match *cause {
                Cause::NonFinite { what } => fault(t, Cause::NonFinite { what: format!("a slope of {what}") }),
                cause => fault(t, cause),
            })?;
            if interruption.is_asked() {
                return Err(fault(t, Cause::Interrupted));
            }
            if varied.is_constrained() {
                let projected = varied.project(t, self.integration.state_mut());
                projected.map_err(|singular| fault(t, singular.cause(varied.description())))?;
                self.integration.go_on(varied, self.until).map_err(|cause| fault(t, *cause))?;
            }
        }
        Ok(steps)
    }

    fn state(&self) -> &[f64] {
        self.integration.state().y
    }
}

/// How columns are integrated: as the run was, where the method asks of the equations what columns have if the motion has it, constant
/// accelerations (`verlet`) or ones without speeds (`rkn8`); else by `dop853`.
fn method(run: &Run, varied: &Variational) -> Method {
    let structure = &run.description.structure;
    match run.method {
        Method::Verlet if structure.uniformly_accelerated && !varied.is_constrained() => Method::Verlet,
        Method::Rkn8 => Method::Rkn8,
        _ => Method::Dop853,
    }
}

/// What an event that ends a run does to columns there: by how much each moves the end, s, and the columns of the state in which the event
/// happens.
///
/// # Errors
/// An event that is touched.
pub(super) fn at_event(
    system: &dyn System,
    (side, run): (&Side, &Run),
    event: usize,
    columns: &mut [Column],
) -> Result<Vec<f64>, NoSlopes> {
    let n = system.len();
    let shifts = shifts(system, (side, &largest_speeds(run)), &[Guard::Event(event)], columns)?;
    let mut a = vec![0.0; n];
    let at = At::packed(side.t, &side.y, n);
    let computed = system.accelerations(at, &mut a);
    computed.map_err(|fault| NoSlopes::Fault { t: side.t, cause: fault.cause(system.description()) })?;
    let rate = [&side.y[n..], &a].concat();
    for (column, shift) in columns.iter_mut().zip(&shifts) {
        column.y.iter_mut().zip(&rate).for_each(|(y, rate)| *y += shift * rate);
    }
    Ok(shifts)
}

impl Unknown {
    /// The parameter that changes.
    pub(super) fn parameter(self) -> Option<usize> {
        match self {
            Unknown::Parameter(k) => Some(k),
            Unknown::Start(_) => None,
        }
    }
}
