//! Arguments of local functions along a step.

use super::certify::{Certifier, PHASE, Sample, ZeroKind};
use crate::integrate::Segment;
use crate::mechanism::{At, Role, System, Watched};

/// Evaluates the arguments that a description lists, and tells where a function has to be looked at.
#[derive(Clone, Debug)]
pub(crate) struct Arguments {
    n: usize,
    y: Vec<f64>,
    dy: Vec<f64>,
    a: Vec<f64>,
    /// Pairs (A, A').
    pairs: Vec<f64>,
    certifier: Certifier,
    grid: Vec<Sample>,
    /// Points (θ, A) of the argument that was followed last, in order.
    pub path: Vec<(f64, f64)>,
    /// How often they were evaluated.
    pub samples: u64,
}

/// Where arguments are evaluated.
pub(crate) enum Course<'a> {
    /// Along the dense output of a step.
    Step(Segment<'a>),
    /// Along time alone: from t on for h seconds.
    Time {
        /// s.
        t: f64,
        /// s.
        h: f64,
    },
}

impl Course<'_> {
    /// How close places θ are that rounding of the time makes one.
    pub fn resolution(&self) -> f64 {
        let (t, h) = match self {
            Course::Step(Segment { t, h, .. }) | Course::Time { t, h } => (t, h),
        };
        TICK * (t.abs() + h.abs()) / h.abs()
    }

    /// The time at θ, s.
    fn time(&self, theta: f64) -> f64 {
        match self {
            Course::Step(segment) => segment.t + theta * segment.h,
            Course::Time { t, h } => t + theta * h,
        }
    }
}

/// By how much of itself a time t + θh may be off.
const TICK: f64 = 2.0 * f64::EPSILON;
/// Functions that happen where |A| is some units at most want A to this.
const FINE: f64 = 10.0;
/// More first pieces than this in one step are not tried.
const MOST_PIECES: f64 = 1e5;
/// Slopes at the ends of a piece by which a phase would turn this many times as much as it does tell of a part of it only: a table of
/// points at 1e-9 s and at 1000 s.
const STEEP_IN_PART: f64 = 4.0;
/// Pieces are not halved more often: beyond that the time cannot tell their ends apart.
const DEEPEST: u32 = 52;
/// By what part of themselves places and speeds are moved to see what the rounding of dense output makes of an argument.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;

impl Arguments {
    /// Makes room.
    pub fn new<S: System + ?Sized>(system: &S) -> Self {
        let n = system.len();
        Arguments {
            n,
            y: vec![0.0; 2 * n],
            dy: vec![0.0; 2 * n],
            a: vec![0.0; n],
            pairs: vec![0.0; 2 * system.description().arguments.len()],
            certifier: Certifier::default(),
            grid: Vec::new(),
            path: Vec::new(),
            samples: 0,
        }
    }

    /// An argument's value and its slope by θ.
    pub fn sample<S: System + ?Sized>(
        &mut self,
        system: &S,
        course: &Course<'_>,
        index: usize,
        theta: f64,
    ) -> (f64, f64) {
        let h = self.evaluate(system, course, theta);
        (self.pairs[2 * index], h * self.pairs[2 * index + 1])
    }

    /// An argument's value and its rate, 1/s, at a state.
    pub fn at_state<S: System + ?Sized>(&mut self, system: &S, (t, y): (f64, &[f64]), index: usize) -> (f64, f64) {
        self.a.fill(0.0);
        system.arguments(At::packed(t, y, self.n).accelerated(&self.a), &mut self.pairs);
        (self.pairs[2 * index], self.pairs[2 * index + 1])
    }

    fn evaluate<S: System + ?Sized>(&mut self, system: &S, course: &Course<'_>, theta: f64) -> f64 {
        self.samples += 1;
        let h = match course {
            Course::Step(segment) => {
                segment.evaluate_with_slope(theta, &mut self.y, &mut self.dy);
                for (a, slope) in self.a.iter_mut().zip(&self.dy[self.n..]) {
                    *a = slope / segment.h;
                }
                segment.h
            }
            Course::Time { h, .. } => *h,
        };
        let t = course.time(theta);
        system.arguments(At::packed(t, &self.y, self.n).accelerated(&self.a), &mut self.pairs);
        h
    }

    /// Whether the equations change at once where an argument is least: F differs on both sides of that place, by no less
    /// at a tenth of the distance in time.  A spring without stiffness or without rest length has no direction to lose.
    pub fn breaks<S: System + ?Sized>(
        &mut self,
        system: &S,
        course: &Course<'_>,
        index: usize,
        (place, least): (f64, f64),
    ) -> bool {
        let mut away = f64::EPSILON;
        while away < 1e-2 && self.sample(system, course, index, place + away).0 < 1e4 * least {
            away *= 2.0;
        }
        let zero = vec![0.0; self.n];
        let (mut before, mut after) = (zero.clone(), zero.clone());
        let mut across = |away: f64| -> Vec<f64> {
            for (theta, f) in [(place - away, &mut before), (place + away, &mut after)] {
                self.evaluate(system, course, theta);
                system.residual(At::packed(course.time(theta), &self.y, self.n).accelerated(&zero), f);
            }
            before.iter().zip(&after).map(|(before, after)| (after - before).abs()).collect()
        };
        let (near, far) = (across(away), across(10.0 * away));
        let mut sums = zero.clone();
        system.magnitudes(At::packed(course.time(place), &self.y, self.n).accelerated(&zero), &mut sums);
        let jumps = |i: usize| near[i].is_nan() || near[i] > 1e-12 * sums[i] && near[i] > 0.5 * far[i];
        (0..self.n).any(jumps)
    }

    /// The places in [0, 1] at which what is watched has to be looked at first: so close that no phase inside it turns
    /// by more than [`PHASE`] between two of them, and wherever an argument inside it vanishes or turns.  `None` where
    /// these are too many.
    pub fn places<S: System + ?Sized>(&mut self, system: &S, course: &Course<'_>, of: Watched) -> Option<Vec<f64>> {
        let description = system.description();
        let inside = |role: fn(Role) -> bool| -> Vec<usize> {
            let list = description.arguments.iter().enumerate();
            list.filter(|(_, a)| a.of == of && role(a.role)).map(|(index, _)| index).collect()
        };
        let phases = inside(|role| role == Role::Phase);
        let mut places = vec![0.0, 1.0];
        for landmark in inside(|role| role == Role::Landmark) {
            if !self.follow(system, course, landmark) {
                return None;
            }
            places.extend(self.path.iter().map(|(x, _)| *x));
        }
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| *a - *b <= 4.0 * f64::EPSILON);
        self.turns(system, course, (&phases, &places))
    }

    /// Follows an argument: [`Arguments::path`] holds its zeros and extrema, the ends of the course, and points on the
    /// way.  False where it cannot be certified.
    pub fn follow<S: System + ?Sized>(&mut self, system: &S, course: &Course<'_>, index: usize) -> bool {
        let own = |a: &crate::mechanism::Argument| a.of == Watched::Argument(index as u32) && a.role == Role::Phase;
        let mut grid = std::mem::take(&mut self.grid);
        grid.clear();
        if system.description().arguments.iter().any(own) {
            let list = system.description().arguments.iter().enumerate();
            let phases: Vec<usize> = list.filter(|(_, a)| own(a)).map(|(index, _)| index).collect();
            let Some(places) = self.turns(system, course, (&phases, &[0.0, 1.0])) else { return false };
            for x in places {
                let (value, slope) = self.sample(system, course, index, x);
                grid.push(Sample { x, value, slope });
            }
        } else {
            for x in [0.0, 1.0] {
                let (value, slope) = self.sample(system, course, index, x);
                grid.push(Sample { x, value, slope });
            }
        }
        let mut certifier = std::mem::take(&mut self.certifier);
        certifier.extrema = true;
        certifier.fine = match system.description().arguments[index].role {
            Role::Exponential | Role::Bounded | Role::Arctangent => FINE,
            _ => f64::INFINITY,
        };
        let mut sample = |x| self.sample(system, course, index, x);
        let mut certified = certifier.settles(&mut sample, &grid);
        if !certified {
            (certifier.rounding, certifier.resolution) = (self.rounding(system, course, index), course.resolution());
            certified = certifier.certify(&mut |x| self.sample(system, course, index, x), &grid).is_ok();
        }
        self.path.clear();
        self.path.extend(certifier.points().iter().map(|point| (point.x, point.value)));
        for mark in &certifier.marks {
            if matches!(mark.kind, ZeroKind::Crosses { .. } | ZeroKind::Jumps | ZeroKind::Pole) {
                self.path.push((mark.x, 0.0));
            }
        }
        self.path.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        self.certifier = certifier;
        self.grid = grid;
        certified
    }

    /// By how much an argument may change by the rounding of the states at both ends of a course, the larger of both.
    fn rounding<S: System + ?Sized>(&mut self, system: &S, course: &Course<'_>, index: usize) -> f64 {
        [0.0, 1.0].map(|theta| self.rounding_at(system, course, index, theta)).into_iter().fold(0.0, f64::max)
    }

    fn rounding_at<S: System + ?Sized>(&mut self, system: &S, course: &Course<'_>, index: usize, theta: f64) -> f64 {
        self.evaluate(system, course, theta);
        let (t, mut y, here) = (course.time(theta), self.y.clone(), self.pairs[2 * index]);
        let mut sum = 0.0;
        for i in 0..y.len() {
            let exact = y[i];
            for moved in [exact * (1.0 - ROUNDINGS), exact * (1.0 + ROUNDINGS)] {
                y[i] = moved;
                sum += (self.at_state(system, (t, &y), index).0 - here).abs();
            }
            y[i] = exact;
        }
        if f64::is_finite(sum) { sum } else { 0.0 }
    }

    /// These places from 0 to 1, and more where any of the phases turns by more than [`PHASE`] between two of them.
    fn turns<S: System + ?Sized>(
        &mut self,
        system: &S,
        course: &Course<'_>,
        (phases, given): (&[usize], &[f64]),
    ) -> Option<Vec<f64>> {
        if phases.is_empty() {
            return Some(given.to_vec());
        }
        let mut at = |theta: f64| -> Vec<(f64, f64)> {
            let h = self.evaluate(system, course, theta);
            phases.iter().map(|&k| (self.pairs[2 * k], h * self.pairs[2 * k + 1])).collect()
        };
        // By how much phases turn from end to end, and would by the slopes there, each the most of all.
        let turned = |a: &[(f64, f64)], b: &[(f64, f64)], length: f64| {
            let mut most = (0.0_f64, 0.0_f64);
            for (a, b) in a.iter().zip(b) {
                let (differs, by_slopes) = ((b.0 - a.0).abs(), 0.5 * length * (a.1.abs() + b.1.abs()));
                // What is not finite tells nothing.
                let larger = |most: f64, turn: f64| if turn.is_finite() { most.max(turn / PHASE) } else { most };
                most = (larger(most.0, differs), larger(most.1, by_slopes));
            }
            most
        };
        let mut places = vec![0.0];
        let ends: Vec<(f64, Vec<(f64, f64)>)> = given.iter().rev().map(|x| (*x, at(*x))).collect();
        let pairs = ends.windows(2).map(|pair| (pair[1].0, pair[1].1.clone(), pair[0].0, pair[0].1.clone(), 0));
        let mut stack: Vec<_> = pairs.collect();
        while let Some((a, at_a, b, at_b, depth)) = stack.pop() {
            let (differs, by_slopes) = turned(&at_a, &at_b, b - a);
            let need = differs.max(by_slopes);
            if need <= 1.05 || depth > DEEPEST {
                places.push(b);
                continue;
            }
            let halved = by_slopes > STEEP_IN_PART * differs.max(1.0);
            let need = if halved { 2.0 } else { need };
            if need + (places.len() + stack.len()) as f64 > MOST_PIECES {
                return None;
            }
            let count = need.ceil() as usize;
            let mut right = (b, at_b);
            for k in (1..count).rev() {
                let x = a + (b - a) * (k as f64 / count as f64);
                let here = at(x);
                stack.push((x, here.clone(), right.0, right.1, depth + 1));
                right = (x, here);
            }
            stack.push((a, at_a, right.0, right.1, depth + 1));
        }
        Some(places)
    }
}
