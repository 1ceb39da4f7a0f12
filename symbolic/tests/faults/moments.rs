// Where faults are judged: times, places and speeds of the study's own, none of them the gate's.
//
// Each scene is run in its phase by Runge and Kutta's fourth-order method with fixed steps, as far as a run with twice the
// step says the same; events are not looked for.  States are taken from that motion; about its start and at large, in the measure of what it passes through,
// a thousandth and ten times as far too; and on both sides of every discontinuity that lies between two of them.

use dalembert_symbolic::expr::{DoubleDouble, Scalar, Symbol, Tape};
use dalembert_symbolic::model::{Condition, Model, Scene};

use super::judge::Route;

/// Parameters, a time, and a state.
#[derive(Clone, Debug)]
pub struct Moment {
    pub parameters: Vec<f64>,
    pub t: f64,
    pub phase: usize,
    pub q: Vec<DoubleDouble>,
    pub v: Vec<DoubleDouble>,
}

/// The motion of one scene.
pub struct Run {
    /// From the start on, at even distances in time.
    pub moments: Vec<Moment>,
    /// The scene's end; the run may end before.
    pub until: f64,
}

/// Steps of a run.
const STEPS: usize = 480;
/// So many states are taken from each run.
const FROM_RUN: usize = 20;
/// So many states are drawn about each start, and as many at large.
const DRAWN: usize = 12;
/// So many scenes are run.
const SCENES: usize = 3;

/// The motion of a model's scenes.
pub fn runs(model: &Model, route: &Route) -> Vec<Run> {
    model.scenes.iter().take(SCENES).filter_map(|scene| run(model, route, scene)).collect()
}

/// All states, the start of each scene first.
pub fn moments(model: &Model, route: &Route, runs: &[Run], when: &[Condition]) -> Vec<Moment> {
    let mut numbers = Numbers(0x2545_f491_4f6c_dd1d);
    let mut found = Vec::new();
    for run in runs {
        let ranges = Ranges::of(run);
        let apart = (run.moments.len() / FROM_RUN).max(1);
        found.extend(run.moments.iter().step_by(apart).cloned());
        for phase in 0..route.bound.phases() {
            for k in 0..2 * DRAWN {
                found.push(Moment { phase, ..drawn(model, run, &ranges, &mut numbers, k) });
            }
        }
    }
    for moment in &mut found {
        let drawn = moment.parameters.clone();
        let value = |symbol: Symbol| if let Symbol::Parameter(i) = symbol { drawn[i as usize] } else { f64::NAN };
        for condition in when {
            moment.parameters[condition.parameter] = Tape::new(&model.graph, &[condition.value]).evaluate(value)[0];
        }
    }
    let mut found: Vec<Moment> = found.iter().filter_map(|moment| route.closed(moment, (&[], &[]))).collect();
    let sides = sides(route, &found);
    found.extend(sides);
    found
}

/// A state about the start of a run, or at large.
fn drawn(model: &Model, run: &Run, ranges: &Ranges, numbers: &mut Numbers, k: usize) -> Moment {
    let start = &run.moments[0];
    let large = k % 2 == 1;
    let factor = [1.0, 1.0, 1e-3, 10.0, 0.1, 3.0][k / 2 % 6];
    let mut moment = start.clone();
    for p in &mut moment.parameters {
        *p = if *p == 0.0 { numbers.between(-1.0, 1.0) } else { *p * numbers.between(0.7, 1.4) };
    }
    moment.t = run.until * numbers.between(0.0, 1.0);
    let mut place = |start: DoubleDouble, range: f64| {
        let away = factor * range * numbers.between(-1.0, 1.0);
        DoubleDouble::from(if large { away } else { start.to_f64() + 0.3 * away })
    };
    for i in 0..moment.q.len() {
        moment.q[i] = place(start.q[i], ranges.q[i]);
        moment.v[i] = place(start.v[i], ranges.v[i]);
    }
    for sample in &model.sample {
        let ends: Vec<f64> = Tape::new(&model.graph, &[sample.low, sample.high]).evaluate(|s| match s {
            Symbol::Parameter(i) => moment.parameters[i as usize],
            _ => 0.0,
        });
        let list = if sample.speed { &mut moment.v } else { &mut moment.q };
        list[sample.coordinate] = DoubleDouble::from(numbers.between(ends[0], ends[1]));
    }
    moment
}

/// So many passages of each discontinuity are looked for.
const PASSAGES: usize = 8;

/// States next to where the argument of a discontinuity changes its sign between two states, on both sides.
pub fn sides(route: &Route, moments: &[Moment]) -> Vec<Moment> {
    let mut found = Vec::new();
    let mut passages = vec![0; route.discontinuities()];
    for pair in moments.windows(2).filter(|pair| pair[0].phase == pair[1].phase) {
        let between = |z: f64| {
            let middle = |a: &DoubleDouble, b: &DoubleDouble| *a + (*b - *a) * z;
            let lists = |a: &[DoubleDouble], b: &[DoubleDouble]| a.iter().zip(b).map(|(a, b)| middle(a, b)).collect();
            let (q, v) = (lists(&pair[0].q, &pair[1].q), lists(&pair[0].v, &pair[1].v));
            let t = pair[0].t + z * (pair[1].t - pair[0].t);
            route.closed(&Moment { t, q, v, ..pair[0].clone() }, (&[], &[]))
        };
        for (k, passed) in passages.iter_mut().enumerate() {
            let positive = |z: f64| between(z).map(|m| route.argument(k, &m) > 0.0);
            let (mut a, mut b) = (0.0, 1.0);
            let first = positive(a);
            if *passed >= PASSAGES || first == positive(b) {
                continue;
            }
            *passed += 1;
            for _ in 0..40 {
                let middle = 0.5 * (a + b);
                if positive(middle) == first { a = middle } else { b = middle }
            }
            found.extend([between(a - 1e-6), between(b + 1e-6)].into_iter().flatten());
        }
    }
    found
}

/// How far each coordinate and each speed goes in a run.
pub struct Ranges {
    pub q: Vec<f64>,
    v: Vec<f64>,
}

impl Ranges {
    pub fn of(run: &Run) -> Ranges {
        let range = |value: &dyn Fn(&Moment) -> f64| {
            let (low, high) = run.moments.iter().map(value).fold((f64::MAX, f64::MIN), |r, x| (r.0.min(x), r.1.max(x)));
            (high - low).max(high.abs()).max(low.abs())
        };
        let or = |x: f64, other: f64| if x > 0.0 { x } else { other };
        let n = run.moments[0].q.len();
        let q: Vec<f64> = (0..n).map(|i| or(range(&|m| m.q[i].to_f64()), 1.0)).collect();
        let v = (0..n).map(|i| or(range(&|m| m.v[i].to_f64()), q[i] / run.until)).collect();
        Ranges { q, v }
    }
}

/// None where the start cannot be brought to the constraints.
fn run(model: &Model, route: &Route, scene: &Scene) -> Option<Run> {
    let mut parameters: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
    let value = |parameters: &[f64], s: Symbol| match s {
        Symbol::Parameter(i) => parameters[i as usize],
        _ => 0.0,
    };
    let set: Vec<_> = scene.set.iter().map(|s| s.1).collect();
    let set: Vec<f64> = Tape::new(&model.graph, &set).evaluate(|s| value(&parameters, s));
    scene.set.iter().zip(set).for_each(|((i, _), x)| parameters[*i] = x);
    let n = model.coordinates.len();
    let roots: Vec<_> = scene.q.iter().chain(&scene.v).copied().chain([scene.until]).collect();
    let start: Vec<f64> = Tape::new(&model.graph, &roots).evaluate(|s| value(&parameters, s));
    let until = if start[2 * n] > 0.0 { start[2 * n] } else { 10.0 };
    let doubles = |list: &[f64]| list.iter().map(|x| DoubleDouble::from(*x)).collect();
    let (q, v) = (doubles(&start[..n]), doubles(&start[n..2 * n]));
    let first = Moment { parameters, t: 0.0, phase: scene.phase, q, v };
    let held = route.closed(&first, (&scene.held_q, &scene.held_v));
    let first = held.or_else(|| route.closed(&first, (&[], &[])))?;
    let horizons = (0..10).map(|k| until * 0.1_f64.powi(k));
    let found = horizons.into_iter().find_map(|horizon| {
        let (fine, coarse) = (march(route, &first, horizon, STEPS)?, march(route, &first, horizon, STEPS / 2)?);
        same(&fine, &coarse).then_some(fine)
    });
    Some(Run { moments: found.unwrap_or_else(|| vec![first]), until })
}

/// Whether two runs end at the same place, by a twentieth of the way.
fn same(fine: &[Moment], coarse: &[Moment]) -> bool {
    let (Some(a), Some(b)) = (fine.last(), coarse.last()) else { return false };
    (0..a.q.len()).all(|i| {
        let far = fine.iter().fold(0.0_f64, |most, m| most.max((m.q[i] - fine[0].q[i]).abs().to_f64()));
        (a.q[i] - b.q[i]).abs().to_f64() <= 0.05 * far
    })
}

/// Steps of equal length, each brought back to the constraints; `None` where the motion cannot be continued.
fn march(route: &Route, start: &Moment, until: f64, steps: usize) -> Option<Vec<Moment>> {
    let h = until / steps as f64;
    let n = start.q.len();
    let moved = |from: &Moment, by: f64, v: &[DoubleDouble], a: &[DoubleDouble]| {
        let mut to = from.clone();
        to.t += by;
        (0..n).for_each(|i| {
            to.q[i] += v[i] * by;
            to.v[i] += a[i] * by;
        });
        to
    };
    let accelerations = |m: &Moment| -> Option<Vec<DoubleDouble>> {
        route.solution(m).map(|found| found.a).filter(|a| a.iter().all(|a| a.is_finite()))
    };
    let mut moments = vec![start.clone()];
    for _ in 0..steps {
        let m = moments.last()?;
        let a1 = accelerations(m)?;
        let m2 = moved(m, 0.5 * h, &m.v, &a1);
        let a2 = accelerations(&m2)?;
        let m3 = moved(m, 0.5 * h, &m2.v, &a2);
        let a3 = accelerations(&m3)?;
        let m4 = moved(m, h, &m3.v, &a3);
        let a4 = accelerations(&m4)?;
        let mean = |k: [&Vec<DoubleDouble>; 4]| -> Vec<DoubleDouble> {
            (0..n).map(|i| (k[0][i] + (k[1][i] + k[2][i]) * 2.0 + k[3][i]) * (1.0 / 6.0)).collect()
        };
        let next = moved(m, h, &mean([&m.v, &m2.v, &m3.v, &m4.v]), &mean([&a1, &a2, &a3, &a4]));
        moments.push(route.closed(&next, (&[], &[]))?);
    }
    Some(moments)
}

/// Marsaglia's xorshift (Journal of Statistical Software 8, 2003).
struct Numbers(u64);

impl Numbers {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        low + (high - low) * (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

impl Moment {
    /// A symbol that stands in the state itself.
    pub fn value<S: Scalar>(&self, symbol: Symbol) -> Option<S> {
        let x = match symbol {
            Symbol::Time => DoubleDouble::from(self.t),
            Symbol::Coordinate(i) => self.q[i as usize],
            Symbol::Speed(i) => self.v[i as usize],
            Symbol::Parameter(i) => DoubleDouble::from(self.parameters[i as usize]),
            Symbol::Phase(k) => DoubleDouble::from(f64::from(u8::from(self.phase == k as usize))),
            _ => return None,
        };
        Some(S::constant(x))
    }

    /// The same as a number.
    pub fn number(&self, symbol: Symbol) -> f64 {
        self.value(symbol).unwrap_or(0.0)
    }

    /// The same state with one of its numbers replaced.
    pub fn with(&self, symbol: Symbol, x: f64) -> Moment {
        let mut moment = self.clone();
        match symbol {
            Symbol::Time => moment.t = x,
            Symbol::Coordinate(i) => moment.q[i as usize] = DoubleDouble::from(x),
            Symbol::Speed(i) => moment.v[i as usize] = DoubleDouble::from(x),
            _ => {}
        }
        moment
    }
}
