//! What is written down of a step that was scanned.

use super::super::certify::ZeroKind;
use super::super::scan::{Crossing, watched_name};
use super::super::{EventNote, Log, Remarkable};
use super::{EventLocator, counts};
use crate::integrate::Segment;
use crate::mechanism::{Action, Direction, System};

impl EventLocator {
    /// Hands the events that only record, but for those in `but`, to the recorder: what does more ends its step, and rounding
    /// about its zero there is no other event.
    pub(super) fn record<S: System + ?Sized>(
        &mut self,
        system: &S,
        segment: &Segment<'_>,
        recorder: &mut impl Log,
        but: &[Crossing],
    ) {
        let crossings = &self.scanner.crossings;
        for (index, crossing) in crossings.iter().enumerate() {
            let Some(event) = system.description().events.get(crossing.function) else { continue };
            // The last one of its function, and in the same direction: zeros before it are others.
            let last = || crossings[index + 1..].iter().all(|later| later.function != crossing.function);
            let same = |other: &Crossing| other.function == crossing.function && other.rising == crossing.rising;
            let taken = crossing.theta > 0.5 && but.iter().any(same) && last();
            let acts = event.actions.iter().any(|action| *action != Action::Record);
            if acts || taken || !counts(event.direction, crossing.rising) {
                continue;
            }
            self.sampler.along(system, segment, crossing.theta);
            if self.sampler.condition(crossing.function) > 0.0 {
                let t = segment.t + crossing.theta * segment.h;
                segment.evaluate(crossing.theta, &mut self.y);
                self.logged[crossing.function] = t;
                recorder.event(system, crossing.function, t, &self.y, false);
            }
        }
    }

    /// Says what events' functions do that is no crossing; of those in `but`, which cross at the end of the step, not what rounding makes of just
    /// that.
    pub(super) fn note<S: System + ?Sized>(&mut self, system: &S, recorder: &mut impl Log, but: &[Crossing]) {
        let anomalies = std::mem::take(&mut self.scanner.anomalies);
        for anomaly in &anomalies {
            let (function, kind) = (anomaly.function, anomaly.kind);
            // Its one change of sign in the step is that of the crossing, and to the same side.
            let same = |crossing: &Crossing| {
                let side = if crossing.rising { 1.0 } else { -1.0 };
                crossing.function == function && self.scanner.sides[function] != side
            };
            let changes = anomalies.iter().filter(|other| other.function == function).count()
                + self.scanner.crossings.iter().filter(|other| other.function == function).count();
            let taken = matches!(kind, ZeroKind::Jumps | ZeroKind::Pole) && changes == 1 && but.iter().any(same);
            if taken || self.sampler.switch(function).is_some() {
                continue;
            }
            let (event, t) = (watched_name(system, &self.sampler, anomaly.function), anomaly.t);
            let direction = system.description().events[anomaly.function].direction;
            let what = match anomaly.kind {
                ZeroKind::Touches if direction == Direction::Both => Remarkable::Touch,
                ZeroKind::Jumps | ZeroKind::Pole => Remarkable::Jump,
                ZeroKind::Undefined => Remarkable::Edge,
                ZeroKind::Touches | ZeroKind::Crosses { .. } => continue,
            };
            recorder.note(EventNote { event, t, what });
        }
    }
}
