//! A coarse run of a scene: where the motion goes, to judge there.
//!
//! Dormand and Prince's pair of orders 5 and 4 (J. Comput. Appl. Math. 6, 1980); where that would need too many steps, the
//! linearly implicit ROS2 (Verwer, Spee, Blom, Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), whose order does not depend on
//! its Jacobian.  Evaluations are counted, so that no verdict depends on a clock.

use super::coarse_events::{Turns, VelocityJump, Watched};
use super::dense::solve;
use super::motion::{Motion, Rough};

/// Most evaluations of the accelerations a scene.
const EVALUATIONS: usize = 2000;
/// Operations that the evaluations of a scene may cost.
const WORK: usize = 8_000_000;
/// So often the terms of the accelerations are looked at.
const LOOKS: usize = 20;
/// The error of an explicit step, relative to the range of each component.
const TOLERANCE: f64 = 1e-4;
/// What has moved by less than this part of what else has its unit has that part of their range: the last link of a chain begins with so
/// high a power of time that its error is a part of its own range however short the step.
const BESIDE: f64 = 1e-6;
/// The error of an implicit step, likewise.
const STIFF_TOLERANCE: f64 = 1e-3;
/// An event is found to this power of ½ of a step: a step of a motion without forces may be a hundred thousand times the way to the wall that it
/// meets, and the place must be known to a part of that way.
const BISECTIONS: usize = 32;
/// In a step that is shorter than this part of the whole, what was at rest before is not asked for its error.
const SHORTEST: f64 = 1e-10;
/// Dormand and Prince's stages: when, and the weights of those before.
const STAGES: [(f64, &[f64]); 6] = [
    (1.0 / 5.0, &[1.0 / 5.0]),
    (3.0 / 10.0, &[3.0 / 40.0, 9.0 / 40.0]),
    (4.0 / 5.0, &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0]),
    (8.0 / 9.0, &[19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0]),
    (1.0, &[9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0]),
    (1.0, &[35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0]),
];
/// The weights of order 5 less those of order 4.
const DIFFERENCE: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339_200.0, 22.0 / 525.0, -1.0 / 40.0];

/// A run.
pub(super) struct Trajectory {
    /// The parameters.
    pub parameters: Vec<f64>,
    /// What they leave out, as that of a state.
    pub rests: Vec<f64>,
    /// Ends of steps, the start first; two at an event, before and after it.
    pub states: Vec<Passed>,
    /// Jumps of the speeds on the way.
    pub blows: Vec<VelocityJump>,
    /// Events with impacts, by their places in the file, and where they happened.
    pub hits: Vec<(usize, Passed)>,
    /// How long it should have gone.
    pub until: f64,
}

/// A state that a run passed.
#[derive(Clone, Debug)]
pub(super) struct Passed {
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub phase: usize,
}

impl Trajectory {
    /// The motion from a start, which meets the constraints of its phase, as far as it can be followed.
    pub fn new(motion: &Motion, turns: &Turns, parameters: Vec<f64>, start: Passed, until: f64) -> Trajectory {
        let budget = (WORK / motion.work().max(1)).clamp(60, EVALUATIONS);
        let n = start.q.len();
        let mut runner = Runner::new(motion, turns, parameters.clone(), start.clone(), until, budget);
        runner.explicit(budget / 2);
        // Each of its Jacobians takes two evaluations a coordinate.
        let affordable = budget / 2 > 2 * n + 40;
        if runner.t < 0.5 * until && !runner.stuck && affordable {
            // Stiff, or fast: whoever gets further is believed.
            let mut implicit = Runner::new(motion, turns, parameters, start, until, budget / 2);
            implicit.implicit();
            if implicit.t > runner.t {
                runner = implicit;
            }
        } else {
            runner.explicit(budget);
        }
        let Watched { blows, hits, .. } = runner.watched;
        let parameters = runner.rough.at.parameters;
        Trajectory { parameters, rests: Vec::new(), states: runner.states, blows, hits, until }
    }

    /// When it ends.
    pub fn reached(&self) -> f64 {
        self.states.last().map_or(0.0, |s| s.t)
    }

    /// States of a phase spread evenly over the time from its first to its last, the start left out.
    pub fn spread(&self, phase: usize, count: usize) -> impl Iterator<Item = &Passed> {
        let of_phase: Vec<&Passed> = self.states.iter().filter(|s| s.phase == phase).collect();
        let (begin, end) = (of_phase.first().map_or(0.0, |s| s.t), of_phase.last().map_or(0.0, |s| s.t));
        (1..=count).filter_map(move |k| {
            let t = begin + (end - begin) * k as f64 / count as f64;
            of_phase.iter().skip(1).min_by(|a, b| (a.t - t).abs().total_cmp(&(b.t - t).abs())).copied()
        })
    }
}

struct Runner<'a> {
    motion: &'a Motion,
    turns: &'a Turns,
    watched: Watched,
    rough: Rough,
    /// q, then v.
    y: Vec<f64>,
    t: f64,
    until: f64,
    h: f64,
    used: usize,
    budget: usize,
    /// Least and largest value of every component.
    range: Vec<(f64, f64)>,
    states: Vec<Passed>,
    /// Magnitudes of the terms of the accelerations, where steps were refused again and again; 0 before.
    terms: Vec<f64>,
    /// How often steps were refused since the last one that was taken, and how often terms were looked at.
    refused: usize,
    looks: usize,
    /// True once the accelerations cannot be computed further on.
    stuck: bool,
}

impl<'a> Runner<'a> {
    fn new(
        motion: &'a Motion,
        turns: &'a Turns,
        parameters: Vec<f64>,
        start: Passed,
        until: f64,
        budget: usize,
    ) -> Self {
        let y: Vec<f64> = start.q.iter().chain(&start.v).copied().collect();
        Runner {
            motion,
            turns,
            watched: Watched::default(),
            rough: Rough::new(parameters, start.q.len(), start.phase),
            range: y.iter().map(|x| (*x, *x)).collect(),
            y,
            t: 0.0,
            until,
            h: until / 100.0,
            used: 0,
            budget,
            terms: vec![0.0; start.q.len()],
            states: vec![start],
            refused: 0,
            looks: 0,
            stuck: false,
        }
    }

    /// y' = (v, a).
    fn rate(&mut self, t: f64, y: &[f64]) -> Option<Vec<f64>> {
        let n = self.motion.n;
        self.used += 1;
        self.rough.at.t = t;
        self.rough.at.q.copy_from_slice(&y[..n]);
        self.rough.at.v.copy_from_slice(&y[n..]);
        let finite = y.iter().all(|x| x.is_finite()) && self.motion.roughly(&mut self.rough);
        finite.then(|| y[n..].iter().chain(&self.rough.a).copied().collect())
    }

    /// Takes a trial step or makes the next one smaller.
    fn judge(&mut self, trial: Option<(Vec<f64>, Vec<f64>)>, order: f64, tolerance: f64) -> bool {
        let mut error = f64::INFINITY;
        if let Some((y, difference)) = &trial {
            error = 0.0;
            let sizes = self.sizes(y);
            for (i, d) in difference.iter().enumerate() {
                let (low, high) = self.range[i];
                // What was at rest and is set going by a discontinuity is off by about its own change, however short
                // the step.
                if self.t > 0.0 && low == high && self.h < SHORTEST * self.until {
                    continue;
                }
                let beyond = d.abs() - self.rounding(i);
                let share = if sizes[i] > 0.0 && beyond > 0.0 { beyond / (tolerance * sizes[i]) } else { 0.0 * beyond };
                error = if share.is_nan() { f64::INFINITY } else { error.max(share) };
            }
        }
        let step = self.h;
        let factor = if error.is_finite() { (0.9 * error.powf(-1.0 / order)).clamp(0.2, 4.0) } else { 0.2 };
        self.h = (self.h * factor).min(self.until / 20.0);
        let Some((y, _)) = trial.filter(|_| error <= 1.0) else {
            self.stuck = self.h < 1e-14 * self.until;
            self.refused += 1;
            if self.refused == 3 {
                self.look();
            }
            return false;
        };
        self.refused = 0;
        self.t += step;
        for (range, x) in self.range.iter_mut().zip(&y) {
            *range = (range.0.min(*x), range.1.max(*x));
        }
        self.y = y;
        self.pass();
        true
    }

    /// The range of each component with this place in it, no less than a part of the range of those that are alike.
    fn sizes(&self, y: &[f64]) -> Vec<f64> {
        let n = self.motion.n;
        let own: Vec<f64> = self.range.iter().zip(y).map(|((low, high), y)| high.max(*y) - low.min(*y)).collect();
        let kind = |i: usize| self.motion.alike[i % n] + if i < n { 0 } else { n };
        let mut widest = vec![0.0_f64; y.len()];
        own.iter().enumerate().for_each(|(i, size)| widest[kind(i)] = widest[kind(i)].max(*size));
        own.iter().enumerate().map(|(i, size)| size.max(BESIDE * widest[kind(i)])).collect()
    }

    /// Notes where the run is.
    fn pass(&mut self) {
        let (q, v) = self.y.split_at(self.motion.n);
        self.states.push(Passed { t: self.t, q: q.to_vec(), v: v.to_vec(), phase: self.rough.at.phase });
    }

    /// Whether the ends of steps are more than ends of steps: constraints to meet, events that turn the motion.
    fn is_held(&self) -> bool {
        !self.motion.constraints.is_empty() || !self.turns.is_empty()
    }

    /// Brings the end of a step to the constraints, and back to an event that comes first and through it; the rate there.
    fn arrive(&mut self) -> Option<Vec<f64>> {
        self.states.pop();
        let rate = self.meet()?;
        if self.turns.crossed(&self.rough, &self.watched).is_none() {
            self.turns.watch(&self.rough, &mut self.watched);
            self.pass();
            return Some(rate);
        }
        // Where on the way some event has happened: nearer and nearer to the first.
        let from = self.states.last()?.clone();
        let to =
            Passed { t: self.t, q: self.y[..self.motion.n].to_vec(), v: self.rough.at.v.clone(), phase: from.phase };
        let (mut before, mut after) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (before + after);
            self.between(&from, &to, middle)?;
            let happened = self.turns.crossed(&self.rough, &self.watched).is_some();
            if happened { after = middle } else { before = middle }
        }
        self.between(&from, &to, after)?;
        let event = self.turns.crossed(&self.rough, &self.watched)?;
        self.pass();
        if !self.turns.act(self.motion, &mut self.rough, event, &mut self.watched) {
            return None;
        }
        self.y = self.rough.at.q.iter().chain(&self.rough.at.v).copied().collect();
        let rate = self.meet()?;
        self.turns.watch(&self.rough, &mut self.watched);
        self.pass();
        Some(rate)
    }

    /// The rate where the run is, once it is brought to the constraints.
    fn meet(&mut self) -> Option<Vec<f64>> {
        let n = self.motion.n;
        self.rough.at.t = self.t;
        self.rough.at.q.copy_from_slice(&self.y[..n]);
        self.rough.at.v.copy_from_slice(&self.y[n..]);
        let mut state = self.rough.at.state();
        self.motion.signals(&mut state);
        if !self.motion.close(&mut state) {
            return None;
        }
        self.y = state.q.iter().chain(&state.v).map(|x| x.to_f64()).collect();
        self.rate(self.t, &self.y.clone())
    }

    /// Goes to a place on the cubic between two states.
    fn between(&mut self, from: &Passed, to: &Passed, z: f64) -> Option<Vec<f64>> {
        let (h, rest) = (to.t - from.t, 1.0 - z);
        self.t = from.t + z * h;
        let mut q = Vec::new();
        let mut v = Vec::new();
        for i in 0..self.motion.n {
            let way = to.q[i] - from.q[i];
            let bow = rest * (h * from.v[i] - way) - z * (h * to.v[i] - way);
            q.push(rest * from.q[i] + z * to.q[i] + z * rest * bow);
            v.push(rest * from.v[i] + z * to.v[i]);
        }
        self.y = [q, v].concat();
        self.meet()
    }

    /// What rounding may make of a component in a step: what stays where it is but for that has no range to judge by.
    fn rounding(&self, i: usize) -> f64 {
        let n = self.motion.n;
        let moved =
            if i < n { self.h * (self.y[n + i].abs() + self.h * self.terms[i]) } else { self.h * self.terms[i - n] };
        16.0 * f64::EPSILON * (self.y[i].abs() + moved)
    }

    /// How large the terms are here of which the accelerations are made.
    fn look(&mut self) {
        self.looks += 1;
        // In double-double each costs as much as many evaluations.
        if self.looks > LOOKS.min(self.budget / 60) {
            return;
        }
        let n = self.motion.n;
        (self.rough.at.t, self.rough.at.q, self.rough.at.v) = (self.t, self.y[..n].to_vec(), self.y[n..].to_vec());
        let mut state = self.rough.at.state();
        if self.motion.complete(&mut state).is_ok() {
            self.terms = state.a.iter().map(|a| a.magnitude).collect();
        }
    }

    fn going(&self, budget: usize) -> bool {
        !self.stuck && self.used < budget && self.t < self.until * (1.0 - 1e-12)
    }

    fn explicit(&mut self, budget: usize) {
        let start = self.y.clone();
        let Some(mut first) = self.rate(self.t, &start) else {
            self.stuck = true;
            return;
        };
        if self.states.len() == 1 {
            self.turns.watch(&self.rough, &mut self.watched);
        }
        while self.going(budget) {
            self.h = self.h.min(self.until - self.t);
            let trial = self.dormand_prince(&first);
            let last = trial.as_ref().map(|t| t.2.clone());
            if !self.judge(trial.map(|(y, d, _)| (y, d)), 5.0, TOLERANCE) {
                continue;
            }
            match if self.is_held() { self.arrive() } else { last } {
                Some(rate) => first = rate,
                None => self.stuck = true,
            }
        }
    }

    /// The next place, its error, and the rate there, which is the next step's first.
    fn dormand_prince(&mut self, first: &[f64]) -> Option<(Vec<f64>, Vec<f64>, Vec<f64>)> {
        let (t, h, y) = (self.t, self.h, self.y.clone());
        let mut rates = vec![first.to_vec()];
        let mut next = y.clone();
        for (when, weights) in STAGES {
            for (i, x) in next.iter_mut().enumerate() {
                *x = y[i] + h * weights.iter().zip(&rates).map(|(w, k)| w * k[i]).sum::<f64>();
            }
            rates.push(self.rate(t + when * h, &next)?);
        }
        let difference = |i: usize| h * DIFFERENCE.iter().zip(&rates).map(|(w, k)| w * k[i]).sum::<f64>();
        let differences = (0..y.len()).map(difference).collect();
        Some((next, differences, rates.pop()?))
    }

    fn implicit(&mut self) {
        let mut jacobian: Option<Vec<f64>> = None;
        let mut age = 0;
        if self.is_held() && self.meet().is_some() {
            self.turns.watch(&self.rough, &mut self.watched);
        }
        while self.going(self.budget) {
            self.h = self.h.min(self.until - self.t);
            if jacobian.is_none() || age >= 20 {
                jacobian = self.differences();
                age = 0;
            }
            let Some(slopes) = &jacobian else {
                self.stuck = true;
                return;
            };
            let slopes = slopes.clone();
            let trial = self.ros2(&slopes);
            age += 1;
            if !self.judge(trial, 2.0, STIFF_TOLERANCE) {
                age += 10;
            } else if self.is_held() {
                let phase = self.rough.at.phase;
                self.stuck = self.arrive().is_none();
                if self.rough.at.phase != phase {
                    jacobian = None;
                }
            }
        }
    }

    /// ∂f/∂y by differences, row by row.
    fn differences(&mut self) -> Option<Vec<f64>> {
        let size = self.y.len();
        let (t, y) = (self.t, self.y.clone());
        let base = self.rate(t, &y)?;
        let mut jacobian = vec![0.0; size * size];
        for j in 0..size {
            let (low, high) = self.range[j];
            let mut moved = y.clone();
            let step = 1e-7 * (high - low).max(y[j].abs()).max(self.h * base[j].abs()).max(f64::MIN_POSITIVE);
            moved[j] += step;
            let step = moved[j] - y[j];
            if step == 0.0 {
                continue;
            }
            let slope = self.rate(t, &moved)?;
            for i in 0..size {
                jacobian[i * size + j] = (slope[i] - base[i]) / step;
            }
        }
        Some(jacobian)
    }

    fn ros2(&mut self, jacobian: &[f64]) -> Option<(Vec<f64>, Vec<f64>)> {
        let gamma = 1.0 + std::f64::consts::FRAC_1_SQRT_2;
        let (t, h, y) = (self.t, self.h, self.y.clone());
        let size = y.len();
        let mut matrix: Vec<f64> = jacobian.iter().map(|j| -gamma * h * j).collect();
        (0..size).for_each(|i| matrix[i * size + i] += 1.0);
        let f = self.rate(t, &y)?;
        let k1 = solve(matrix.clone(), f)?;
        let middle: Vec<f64> = y.iter().zip(&k1).map(|(y, k)| y + h * k).collect();
        let g = self.rate(t + h, &middle)?;
        let right = g.iter().zip(&k1).map(|(g, k)| g - 2.0 * k).collect();
        let k2 = solve(matrix, right)?;
        let next: Vec<f64> = (0..size).map(|i| y[i] + h * (1.5 * k1[i] + 0.5 * k2[i])).collect();
        let difference = (0..size).map(|i| next[i] - middle[i]).collect();
        Some((next, difference))
    }
}
