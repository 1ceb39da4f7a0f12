//! A coarse run of a scene: where the motion goes, to judge there.
//!
//! Dormand and Prince's pair of orders 5 and 4 (J. Comput. Appl. Math. 6, 1980); where that would need too many steps, the
//! linearly implicit ROS2 (Verwer, Spee, Blom, Hundsdorfer, SIAM J. Sci. Comput. 20, 1999), whose order does not depend on
//! its Jacobian.  Evaluations are counted, so that no verdict depends on a clock.

use super::dense::solve;
use super::motion::{Motion, Rough};
use super::state::State;

/// Most evaluations of the accelerations a scene.
const EVALUATIONS: usize = 2000;
/// Operations that the evaluations of a scene may cost.
const WORK: usize = 8_000_000;
/// So often the terms of the accelerations are looked at.
const LOOKS: usize = 20;
/// The error of an explicit step, relative to the range of each component.
const TOLERANCE: f64 = 1e-4;
/// The error of an implicit step, likewise.
const STIFF_TOLERANCE: f64 = 1e-3;
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
    /// (t, q, v) at the ends of steps, the start first.
    pub states: Vec<(f64, Vec<f64>, Vec<f64>)>,
    /// How long it should have gone.
    pub until: f64,
}

impl Trajectory {
    /// The motion from a start, as far as it can be followed.
    pub fn new(motion: &Motion, parameters: Vec<f64>, q: &[f64], v: &[f64], until: f64) -> Trajectory {
        let budget = (WORK / motion.work().max(1)).clamp(60, EVALUATIONS);
        let mut runner = Runner::new(motion, parameters, q, v, until, budget);
        runner.explicit(budget / 2);
        // Each of its Jacobians takes two evaluations a coordinate.
        let affordable = budget / 2 > 2 * q.len() + 40;
        if runner.t < 0.5 * until && !runner.stuck && affordable {
            // Stiff, or fast: whoever gets further is believed.
            let mut implicit = Runner::new(motion, runner.rough.parameters.clone(), q, v, until, budget / 2);
            implicit.implicit();
            if implicit.t > runner.t {
                runner = implicit;
            }
        } else {
            runner.explicit(budget);
        }
        Trajectory { parameters: runner.rough.parameters, states: runner.states, until }
    }

    /// When it ends.
    pub fn reached(&self) -> f64 {
        self.states.last().map_or(0.0, |s| s.0)
    }

    /// States spread evenly over its time, the start left out.
    pub fn spread(&self, count: usize) -> impl Iterator<Item = &(f64, Vec<f64>, Vec<f64>)> {
        let end = self.reached();
        (1..=count).filter_map(move |k| {
            let t = end * k as f64 / count as f64;
            self.states.iter().skip(1).min_by(|a, b| (a.0 - t).abs().total_cmp(&(b.0 - t).abs()))
        })
    }
}

struct Runner<'a> {
    motion: &'a Motion,
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
    states: Vec<(f64, Vec<f64>, Vec<f64>)>,
    /// Magnitudes of the terms of the accelerations, where steps were refused again and again; 0 before.
    terms: Vec<f64>,
    /// How often steps were refused since the last one that was taken, and how often terms were looked at.
    refused: usize,
    looks: usize,
    /// True once the accelerations cannot be computed further on.
    stuck: bool,
}

impl<'a> Runner<'a> {
    fn new(motion: &'a Motion, parameters: Vec<f64>, q: &[f64], v: &[f64], until: f64, budget: usize) -> Self {
        let y: Vec<f64> = q.iter().chain(v).copied().collect();
        Runner {
            motion,
            rough: Rough::new(parameters, q.len()),
            range: y.iter().map(|x| (*x, *x)).collect(),
            y,
            t: 0.0,
            until,
            h: until / 100.0,
            used: 0,
            budget,
            states: vec![(0.0, q.to_vec(), v.to_vec())],
            terms: vec![0.0; q.len()],
            refused: 0,
            looks: 0,
            stuck: false,
        }
    }

    /// y' = (v, a).
    fn rate(&mut self, t: f64, y: &[f64]) -> Option<Vec<f64>> {
        let n = self.motion.n;
        self.used += 1;
        self.rough.t = t;
        self.rough.q.copy_from_slice(&y[..n]);
        self.rough.v.copy_from_slice(&y[n..]);
        let finite = y.iter().all(|x| x.is_finite()) && self.motion.roughly(&mut self.rough);
        finite.then(|| y[n..].iter().chain(&self.rough.a).copied().collect())
    }

    /// Takes a trial step or makes the next one smaller.
    fn judge(&mut self, trial: Option<(Vec<f64>, Vec<f64>)>, order: f64, tolerance: f64) -> bool {
        let mut error = f64::INFINITY;
        if let Some((y, difference)) = &trial {
            error = 0.0;
            for (i, d) in difference.iter().enumerate() {
                let (low, high) = self.range[i];
                // What was at rest and is set going by a discontinuity is off by about its own change, however short
                // the step.
                if self.t > 0.0 && low == high && self.h < SHORTEST * self.until {
                    continue;
                }
                let size = high.max(y[i]) - low.min(y[i]);
                let beyond = d.abs() - self.rounding(i);
                let share = if size > 0.0 && beyond > 0.0 { beyond / (tolerance * size) } else { 0.0 * beyond };
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
        let (q, v) = self.y.split_at(self.motion.n);
        self.states.push((self.t, q.to_vec(), v.to_vec()));
        true
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
        if self.looks > LOOKS {
            return;
        }
        let n = self.motion.n;
        let doubles = |list: &[f64]| list.iter().map(|x| (*x).into()).collect();
        let mut state = State::at_rest(self.rough.parameters.clone(), n);
        (state.t, state.q, state.v) = (self.t.into(), doubles(&self.y[..n]), doubles(&self.y[n..]));
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
        while self.going(budget) {
            self.h = self.h.min(self.until - self.t);
            let trial = self.dormand_prince(&first);
            let last = trial.as_ref().map(|t| t.2.clone());
            if self.judge(trial.map(|(y, d, _)| (y, d)), 5.0, TOLERANCE)
                && let Some(last) = last
            {
                first = last;
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
