//! Event functions and arguments of switches along a step.

use crate::integrate::Segment;
use crate::mechanism::{At, System};

/// Evaluates the watched functions: the events' first, then the switches' arguments.
#[derive(Clone, Debug)]
pub(crate) struct Sampler {
    n: usize,
    events: usize,
    switches: usize,
    needs_accelerations: bool,
    y: Vec<f64>,
    a: Vec<f64>,
    /// Pairs (value, condition) of the events, then (value, rate) of the switches.
    pairs: Vec<f64>,
}

impl Sampler {
    /// Makes room, and finds out whether any function depends on the accelerations.
    pub fn new<S: System + ?Sized>(system: &S, t: f64, y: &[f64]) -> Self {
        let n = system.len();
        let (events, switches) = (system.description().events.len(), system.description().switches.len());
        let mut sampler = Sampler {
            n,
            events,
            switches,
            needs_accelerations: switches > 0,
            y: vec![0.0; 2 * n],
            a: vec![0.0; n],
            pairs: vec![0.0; 2 * (events + switches)],
        };
        if !sampler.needs_accelerations {
            sampler.needs_accelerations = sampler.depends_on_accelerations(system, t, y);
        }
        sampler
    }

    /// How many functions are watched.
    pub fn len(&self) -> usize {
        self.events + self.switches
    }

    /// The index of a switch if the function is one.
    pub fn switch(&self, function: usize) -> Option<usize> {
        function.checked_sub(self.events)
    }

    /// The function of a switch.
    pub fn function_of(&self, switch: usize) -> usize {
        self.events + switch
    }

    /// The value of a function after the last evaluation.
    pub fn value(&self, function: usize) -> f64 {
        self.pairs[2 * function]
    }

    /// A function's second number after the last evaluation: an event's condition, a switch's rate.
    pub fn second(&self, function: usize) -> f64 {
        self.pairs[2 * function + 1]
    }

    /// Evaluates all functions at a state.
    pub fn at_state<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let at = At::packed(t, y, self.n);
        if self.needs_accelerations && system.accelerations(at, &mut self.a).is_err() {
            self.a.fill(f64::NAN);
        }
        self.evaluate(system, t, y);
    }

    /// Evaluates all functions on the dense output of a step.
    pub fn at<S: System + ?Sized>(&mut self, system: &S, segment: &Segment<'_>, theta: f64) {
        let mut y = std::mem::take(&mut self.y);
        segment.evaluate(theta, &mut y);
        self.at_state(system, segment.t + theta * segment.h, &y);
        self.y = y;
    }

    fn evaluate<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) {
        let at = At::packed(t, y, self.n);
        let (events, switches) = self.pairs.split_at_mut(2 * self.events);
        if self.events > 0 {
            system.events(at.accelerated(&self.a), events);
        }
        if self.switches > 0 {
            system.switches(at.accelerated(&self.a), switches);
        }
    }

    /// Accelerations that are not numbers make what depends on them not a number; three further ones show
    /// what hides that in a comparison.
    fn depends_on_accelerations<S: System + ?Sized>(&mut self, system: &S, t: f64, y: &[f64]) -> bool {
        let mut values = Vec::new();
        for probe in [f64::NAN, 0.0, 1e3, -1e3] {
            self.a.fill(probe);
            self.evaluate(system, t, y);
            values.push(self.pairs.iter().map(|value| value.to_bits()).collect::<Vec<_>>());
        }
        self.a.fill(0.0);
        values.iter().any(|other| *other != values[0])
    }
}
