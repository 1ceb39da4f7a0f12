//! What a run draws, at closer times than those it reports, made when somebody asks.

use std::fmt;
use std::sync::Arc;

use super::Trajectory;
use crate::mechanism::{At, System};

/// Frames of a whole run, fewer where one frame has many numbers.
const MOST_FRAMES: f64 = 2000.0;
const MOST_NUMBERS: f64 = 250_000.0;

/// A time and the numbers of `description().draw`.
pub(crate) type Frame = (f64, Vec<f64>);

/// What is needed to draw a run after it ended.
#[derive(Clone, Default)]
pub(crate) struct Scenery {
    /// The mechanism as it was at the end; `None` if there is no dense output.
    system: Option<Arc<dyn System>>,
    /// Where the run ended, or where it was to end when frames were drawn before, s.
    until: f64,
    /// Modes of the switches, from which time on.
    pub modes: Vec<(f64, Vec<f64>)>,
    /// Held values, from which time on.
    pub memory: Vec<(f64, Vec<f64>)>,
    /// Whether states between the ends of steps are brought back to the constraints.
    pub projects: bool,
    /// Frames that were drawn before the mechanism was changed by hand.
    drawn: Vec<Frame>,
    /// Whether the mechanism was changed by hand, so that it is not the one of the whole run.
    changed: bool,
}

impl Scenery {
    /// Of a run that brings states back to the constraints, or does not.
    pub fn new(projects: bool) -> Self {
        Scenery { projects, ..Scenery::default() }
    }

    /// Notes the modes in force from t on.
    pub fn modes(&mut self, t: f64, modes: &[f64]) {
        if !modes.is_empty() && self.modes.last().is_none_or(|(_, last)| last != modes) {
            self.modes.push((t, modes.to_vec()));
        }
    }

    /// Notes what is held from t on.
    pub fn memory(&mut self, t: f64, memory: &[f64]) {
        if !memory.is_empty() && self.memory.last().is_none_or(|(_, last)| last != memory) {
            self.memory.push((t, memory.to_vec()));
        }
    }

    /// Keeps the mechanism, as it is at the end, of a run with dense output, which ended there unless it was drawn before.
    pub fn keep(&mut self, system: &dyn System, end: Option<f64>) {
        self.until = end.filter(|_| !self.changed).unwrap_or(self.until);
        self.system = end.map(|_| Arc::from(system.boxed_clone()));
    }

    /// The mechanism of the whole run.
    pub fn system(&self) -> Option<&dyn System> {
        self.system.as_deref().filter(|_| !self.changed)
    }

    /// Draws until the end of the trajectory with the mechanism as it is.
    pub fn draw(&mut self, system: &dyn System, trajectory: &Trajectory, until: f64) {
        (self.until, self.changed) = (until, true);
        if system.description().drawing_len() > 0 {
            let more = self.more(system.boxed_clone(), trajectory, false);
            self.drawn.extend(more);
        }
    }

    /// All frames; none where the run kept no dense output.
    pub fn frames(&self, trajectory: &Trajectory) -> Vec<Frame> {
        let draws = |system: &&Arc<dyn System>| system.description().drawing_len() > 0;
        let more = self.system.as_ref().filter(draws).map(|system| self.more(system.boxed_clone(), trajectory, true));
        self.drawn.iter().cloned().chain(more.unwrap_or_default()).collect()
    }

    /// Frames after those that were drawn, at start + k·spacing, and at the very end if `ends`.
    fn more(&self, mut system: Box<dyn System>, trajectory: &Trajectory, ends: bool) -> Vec<Frame> {
        let (Some(start), Some(end)) = (trajectory.start(), trajectory.end()) else { return Vec::new() };
        let (n, size) = (system.len(), system.description().drawing_len());
        let count = (MOST_NUMBERS / size.max(1) as f64).clamp(100.0, MOST_FRAMES);
        let spacing = (self.until - start) / count;
        let last = self.drawn.last().map_or(f64::NEG_INFINITY, |frame| frame.0);
        let most = if spacing > 0.0 { usize::MAX } else { 0 };
        // Those before were drawn.
        let first = ((last - start) / spacing).floor().max(0.0) as u32;
        let regular = (first..).map(|k| start + spacing * f64::from(k)).take(most);
        let inside = regular.take_while(|t| *t < end - 1e-6 * spacing).filter(|t| *t > last);
        let mut y = vec![0.0; 2 * n];
        let (mut modes, mut memory) = (self.modes.iter().peekable(), self.memory.iter().peekable());
        let mut frames = Vec::new();
        for t in inside.chain((ends && end > last).then_some(end)) {
            while let Some((_, now)) = modes.next_if(|(from, _)| *from <= t) {
                system.set_modes(now);
            }
            while let Some((_, now)) = memory.next_if(|(from, _)| *from <= t) {
                system.set_memory(now);
            }
            if trajectory.evaluate(t, &mut y) {
                let mut numbers = vec![f64::NAN; size];
                system.drawing(At::packed(t, &y, n), &mut numbers);
                frames.push((t, numbers));
            }
        }
        frames
    }
}

impl fmt::Debug for Scenery {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Scenery").field("until", &self.until).field("modes", &self.modes).finish_non_exhaustive()
    }
}
