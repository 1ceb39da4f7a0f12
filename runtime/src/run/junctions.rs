//! Instants at which the equations of motion, or the speeds, change.

use crate::mechanism::System;

/// What happens at an instant of a run.
#[derive(Clone, Debug)]
pub(crate) struct Junction {
    /// The motion until then.
    pub before: Side,
    /// And from then on.
    pub after: Side,
    /// Events that change phase or speeds there; without any, switches change sides.
    pub events: Vec<usize>,
    /// Jumps of the speeds, in order.
    pub jumps: Vec<SpeedJump>,
    /// Whether impacts accumulate there, so that the motion goes on at their end.
    pub accumulates: bool,
    /// Whether contacts rebound or slip in an impact, so that the jumps of the speeds are no projections.
    pub rebounds: bool,
}

/// A state on one side of an instant, with what is in force there.
#[derive(Clone, Debug)]
pub(crate) struct Side {
    /// s.
    pub t: f64,
    /// [q; q'].
    pub y: Vec<f64>,
    /// The modes of all switches.
    pub modes: Vec<f64>,
    /// The phase.
    pub phase: usize,
}

/// A jump of the speeds to constraints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct SpeedJump {
    /// All rows that take part, among those of the mechanism.
    pub rows: Vec<usize>,
    /// Those of them that are hit with restitution, and the place of its coefficient.
    pub hit: Option<(Vec<usize>, usize)>,
}

/// Writes junctions down.
#[derive(Clone, Debug, Default)]
pub(super) struct Junctions {
    pub list: Vec<Junction>,
    left: Option<Junction>,
}

impl Side {
    fn new(system: &dyn System, t: f64, y: &[f64]) -> Side {
        Side { t, y: y.to_vec(), modes: system.modes().to_vec(), phase: system.phase() }
    }
}

impl Junctions {
    /// Takes note of a state before other equations come into force, at which these events just happened.
    pub fn leave(&mut self, system: &dyn System, (t, y): (f64, &[f64]), events: impl Iterator<Item = usize>) {
        let before = Side::new(system, t, y);
        let acts = |event: &usize| system.description().events[*event].changes_motion();
        let (after, events) = (before.clone(), events.filter(acts).collect());
        self.left = Some(Junction { before, after, events, jumps: Vec::new(), accumulates: false, rebounds: false });
    }

    /// Takes note of a jump of the speeds.
    pub fn jump(&mut self, jump: SpeedJump) {
        if let Some(left) = &mut self.left {
            left.jumps.push(jump);
        }
    }

    /// Takes note of impacts that accumulate.
    pub fn accumulates(&mut self) {
        if let Some(left) = &mut self.left {
            left.accumulates = true;
        }
    }

    /// Takes note of contacts that rebound or slip in an impact.
    pub fn rebounds(&mut self) {
        if let Some(left) = &mut self.left {
            left.rebounds = true;
        }
    }

    /// Takes note of the state from which the motion goes on.
    pub fn restart(&mut self, system: &dyn System, t: f64, y: &[f64]) {
        if let Some(left) = self.left.take() {
            self.list.push(Junction { after: Side::new(system, t, y), ..left });
        }
    }
}
