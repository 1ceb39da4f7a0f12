//! Finding all zeros of the watched functions within a step.

use super::root::{dip, root};
use super::sample::Sampler;
use crate::integrate::Segment;
use crate::mechanism::System;

/// Where the dense output is sampled: at the ends with their slopes, and in between.
const GRID: [f64; 7] = [0.0, 1e-3, 0.25, 0.5, 0.75, 1.0 - 1e-3, 1.0];
/// A value this small against the variation over the step counts as zero.
const ZERO: f64 = 1e-9;

/// A function passes through zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crossing {
    /// Which function.
    pub function: usize,
    /// Where in the step, 0 to 1.
    pub theta: f64,
    /// True when it goes from below to above.
    pub rising: bool,
}

/// On which side of zero each function is: −1 or 1, or 0 while it has not left zero.
#[derive(Clone, Debug)]
pub(crate) struct Scanner {
    instant: f64,
    /// The sides at the start of the step.
    pub sides: Vec<f64>,
    /// The sides at its end, if nothing happens in between.
    pub end_sides: Vec<f64>,
    /// Functions that were near zero when the integration (re)started, whose side is not yet sure.
    pub fresh: Vec<bool>,
    values: Vec<[f64; GRID.len()]>,
    points: Vec<(f64, f64)>,
    /// Zeros of the last scan, in order of time, then of function.
    pub crossings: Vec<Crossing>,
}

impl Scanner {
    /// For so many functions; what happens within an `instant`, s, cannot be told apart.
    pub fn new(functions: usize, instant: f64) -> Self {
        Scanner {
            instant,
            sides: vec![0.0; functions],
            end_sides: vec![0.0; functions],
            fresh: vec![true; functions],
            values: vec![[0.0; GRID.len()]; functions],
            points: Vec::with_capacity(2 * GRID.len()),
            crossings: Vec::with_capacity(2 * functions),
        }
    }

    /// Finds the zeros within a step.
    pub fn scan<S: System + ?Sized>(&mut self, sampler: &mut Sampler, system: &S, segment: &Segment<'_>) {
        for (k, theta) in GRID.into_iter().enumerate() {
            sampler.at(system, segment, theta);
            for (function, values) in self.values.iter_mut().enumerate() {
                values[k] = sampler.value(function);
            }
        }
        self.crossings.clear();
        for function in 0..self.values.len() {
            self.collect(function, sampler, system, segment);
            self.walk(function, sampler, system, segment);
        }
        self.crossings.sort_by(|a, b| a.theta.total_cmp(&b.theta).then(a.function.cmp(&b.function)));
    }

    /// The sides at the end of a step of h become those at the start of the next.
    pub fn advance(&mut self, h: f64) {
        self.sides.copy_from_slice(&self.end_sides);
        if h > self.instant {
            self.fresh.fill(false);
        }
    }

    /// The value of a function that is largest in size among the samples; `None` if there is none.
    pub fn largest(&self, function: usize) -> Option<f64> {
        self.values[function].iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()))
    }

    /// The sampled points of a function, with points beyond zero where a pair of zeros hides.
    fn collect<S: System + ?Sized>(
        &mut self,
        function: usize,
        sampler: &mut Sampler,
        system: &S,
        segment: &Segment<'_>,
    ) {
        let values = &self.values[function];
        let point = |k: usize, sign: f64| (GRID[k], sign * values[k]);
        self.points.clear();
        for (k, value) in values.iter().enumerate() {
            self.points.push(point(k, 1.0));
            if k == 0 || k + 1 == GRID.len() {
                continue;
            }
            let sign = value.signum();
            let (before, here, after) = (point(k - 1, sign), point(k, sign), point(k + 1, sign));
            if here.1 > 0.0 && here.1 <= before.1 && here.1 <= after.1 && before.1.max(after.1) > here.1 {
                let hidden = |theta: f64| {
                    sampler.at(system, segment, theta);
                    sign * sampler.value(function)
                };
                if let Some((theta, value)) = dip(hidden, before, here, after) {
                    self.points.push((theta, sign * value));
                }
            }
        }
        self.points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }

    /// Goes from point to point and notes where the side changes.
    fn walk<S: System + ?Sized>(&mut self, function: usize, sampler: &mut Sampler, system: &S, segment: &Segment<'_>) {
        let first = self.points[0].1;
        let variation = self.points.iter().map(|point| (point.1 - first).abs()).fold(0.0, f64::max);
        let mut side = self.sides[function];
        let near_zero = self.fresh[function] || side == 0.0;
        if near_zero && first.abs() <= ZERO * variation && !self.is_switch(function, sampler) {
            side = 0.0;
        }
        let mut last = (0.0, 0.0);
        for index in 0..self.points.len() {
            let (theta, value) = self.points[index];
            let unsure = near_zero && (value.abs() <= ZERO * variation || theta * segment.h <= self.instant);
            if unsure || value == 0.0 || value.is_nan() {
                continue;
            }
            let sign = value.signum();
            if side == 0.0 {
                side = sign;
            } else if sign != side {
                let theta = if last.1 == 0.0 {
                    0.0
                } else {
                    let on = |theta: f64| {
                        sampler.at(system, segment, theta);
                        sampler.value(function)
                    };
                    root(on, last, (theta, value))
                };
                self.crossings.push(Crossing { function, theta, rising: sign > 0.0 });
                side = sign;
            }
            last = (theta, value);
        }
        self.end_sides[function] = side;
    }

    fn is_switch(&self, function: usize, sampler: &Sampler) -> bool {
        sampler.switch(function).is_some()
    }
}
