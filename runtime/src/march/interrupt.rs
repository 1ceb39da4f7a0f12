//! Steps that events and discontinuities may end early.

use super::{Halt, March, Step, finite};
use crate::cause::Cause;
use crate::events::{Interruption, Switched, Watch};
use crate::mechanism::{At, System};
use crate::run::Recorder;

impl<S: System + ?Sized> March<S> {
    /// Writes down and takes a step whose dense output is made, as far as the first event that stops or the first
    /// discontinuity.
    pub(super) fn watched(
        &mut self,
        system: &mut S,
        step: Step,
        watch: &mut Watch,
        recorder: &mut Recorder,
    ) -> Result<Halt, Cause> {
        let Some(interruption) = watch.scan(system, &self.segment(step))? else {
            recorder.accept(system, Some(&self.segment(step)), step.next, &self.end)?;
            watch.pass(system, &self.segment(step), recorder);
            self.commit(step);
            if step.lands {
                self.switch(system, watch, recorder)?;
            }
            return Ok(Halt::Arrived);
        };
        let crossing = match interruption {
            Interruption::At(crossing) => crossing,
            Interruption::Leaves { switch, side } => {
                let y = self.y.clone();
                let now = self.clock.now();
                watch.leave(system, (switch, side), (now, &y), &mut |system| self.trial(system))?;
                self.restart(system, false)?;
                return Ok(Halt::Arrived);
            }
        };
        let together = watch.simultaneous(crossing, &self.segment(step));
        let stops = match self.shorten(system, step, crossing.theta, crossing.function, watch)? {
            Some(shorter) => {
                let segment = self.segment(shorter);
                recorder.accept(system, Some(&segment), shorter.next, &self.end)?;
                watch.record_before(system, &segment, recorder, &together)?;
                let stops = watch.fire(system, &together, (shorter.next, &self.end), recorder);
                self.commit(shorter);
                stops
            }
            None => watch.fire(system, &together, (self.clock.now(), &self.y), recorder),
        };
        if stops {
            return Ok(Halt::Event);
        }
        // A stop time may coincide with the crossing.
        if !self.switch(system, watch, recorder)? {
            self.restart(system, false)?;
        }
        Ok(Halt::Arrived)
    }

    /// Switches what is on its surface at the present state, and lets inputs that turn or jump there kick; returns
    /// whether anything was.
    fn switch(&mut self, system: &mut S, watch: &mut Watch, recorder: &mut Recorder) -> Result<bool, Cause> {
        let (now, n) = (self.clock.now(), self.rates.n);
        let y = self.y.clone();
        let before = self.rates.work.then(|| system.energy(At::packed(now, &y, n)).jacobi);
        let switched = watch.switch(system, (now, &y), &mut |system| self.trial(system))?;
        let Switched { any, timed, resume, impulse } = switched;
        if !any {
            return Ok(false);
        }
        if resume > now {
            self.clock.set(resume);
        }
        if let Some(impulse) = impulse {
            for (v, jump) in self.y[n..2 * n].iter_mut().zip(&impulse.jump) {
                *v += jump;
            }
            recorder.impulse(impulse);
        }
        if let Some(before) = before.filter(|_| timed) {
            // What the switch of a potential, or the kick, does to the energy is the work of what does it.
            let work = system.energy(At::packed(now, &self.y, n)).jacobi - before;
            if work.is_finite() {
                self.y[2 * n] += work;
            }
        }
        self.restart(system, timed)?;
        Ok(true)
    }

    /// Steps again, as far as the zero of a watched function at about θ of the step that was tried; `None` if
    /// that is where the step began.
    ///
    /// The dense output finds the zero; the method's own step to it, corrected by Newton's method, is more
    /// accurate (catalogue E7).
    fn shorten(
        &mut self,
        system: &S,
        step: Step,
        theta: f64,
        function: usize,
        watch: &mut Watch,
    ) -> Result<Option<Step>, Cause> {
        let now = self.clock.now();
        let resolution = f64::EPSILON * now.abs().max(step.h);
        let mut h = theta * step.h;
        let mut shorter = None;
        for _ in 0..5 {
            if h <= resolution {
                return Ok(shorter);
            }
            let trial = Step { h, next: now + h, lands: false };
            self.try_step(system, trial, true).map_err(|fault| fault.cause(system.description()))?;
            finite(system, &self.end, 0)?;
            self.dense(system, trial)?;
            shorter = Some(trial);
            let segment = self.segment(trial);
            let (value, rate) = watch.value_and_rate(system, function, &segment, &self.end);
            let correction = -value / rate;
            if !(correction.abs() > resolution && correction.abs() < 0.1 * h) {
                break;
            }
            h += correction;
        }
        Ok(shorter)
    }
}
