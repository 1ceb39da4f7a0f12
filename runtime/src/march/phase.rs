//! Phases and impacts: what events do to the state and to the constraints in force.

use super::{Halt, March};
use crate::cause::Cause;
use crate::constrain::{Blow, blow};
use crate::events::{Fired, Impulse, Watch};
use crate::mechanism::{Action, Enforcement, System};
use crate::run::Recorder;

/// More firings than this at one instant are a cycle.
const AT_AN_INSTANT: u32 = 50;
/// Changes of speeds below this part of them are none.
const ROUNDING: f64 = 1e-12;
/// Flights shorter than this part of the first are not followed one by one.
const SHORT: f64 = 1e-6;
/// Two estimates of the time at which impacts accumulate agree to this part of it.
const AGREE: f64 = 1e-6;

/// Impacts of one event that follow each other faster and faster (Zeno).
#[derive(Clone, Debug, Default)]
pub(super) struct Flights {
    event: usize,
    /// When the last impact was, s.
    last: f64,
    /// The first flight, and the last one, s.
    first: Option<f64>,
    flight: Option<f64>,
    estimate: Option<f64>,
}

impl Flights {
    /// Notes an impact at t; the time at which they accumulate where that is known well enough.
    fn impact(&mut self, event: usize, t: f64) -> Option<f64> {
        if self.event != event || self.first.is_none() && self.last == 0.0 {
            *self = Flights { event, last: t, ..Flights::default() };
            self.last = t;
            return None;
        }
        let flight = t - std::mem::replace(&mut self.last, t);
        let first = *self.first.get_or_insert(flight);
        let before = self.flight.replace(flight)?;
        let ratio = flight / before;
        if ratio.is_nan() || ratio >= 1.0 {
            (self.first, self.estimate) = (Some(flight), None);
            return None;
        }
        let end = t + flight * ratio / (1.0 - ratio);
        let known = self.estimate.replace(end)?;
        (flight < SHORT * first && (end - known).abs() <= AGREE * end.abs()).then_some(end)
    }
}

impl March {
    /// Does what events say, and what events that are past their zero after it say in turn.
    pub(super) fn act(
        &mut self,
        system: &mut dyn System,
        fired: Vec<Fired>,
        watch: &mut Watch,
        recorder: &mut Recorder,
    ) -> Result<Halt, Cause> {
        let mut fired = fired;
        for _ in 0..AT_AN_INSTANT {
            let (before, mut changed) = (system.phase(), false);
            let mut stops = false;
            'all: for Fired { event, actions, .. } in &fired {
                for action in actions {
                    if *action == Action::Stop {
                        stops = true;
                        break 'all;
                    }
                    changed |= self.does(system, (*event, *action), recorder)?;
                }
            }
            if !changed && !stops {
                break;
            }
            if stops {
                self.project_start(system)?;
                self.restart(system, recorder)?;
                return Ok(Halt::Event);
            }
            let (now, y) = (self.clock.now(), self.stepper.start().y.to_vec());
            self.project_start(system)?;
            let impact = |action: &Action| matches!(action, Action::Impact { .. });
            let struck = fired.iter().any(|fired| fired.actions.iter().any(impact));
            watch.enter(system, (now, &y), struck, &mut |system| self.trial(system))?;
            let enters = |action: &Action| matches!(action, Action::Phase(_));
            let entered = system.phase() != before || fired.iter().any(|fired| fired.actions.iter().any(enters));
            fired = watch.overdue(system, (now, self.stepper.start().y), entered);
            if fired.is_empty() {
                self.restart(system, recorder)?;
                return Ok(Halt::Arrived);
            }
            for Fired { event, actions, .. } in &fired {
                let stops = actions.contains(&Action::Stop);
                watch.log(system, *event, (now, self.stepper.start().y), stops, recorder);
            }
        }
        let event = fired.first().map_or(0, |fired| fired.event);
        Err(Cause::Chattering { switch: system.description().events[event].name.to_string() })
    }

    /// Brings the speeds to constraints that a sharp turn of time or of an input moves.
    ///
    /// # Errors
    /// A constraint that jumps, which no finite force could follow.
    pub(super) fn jolt(&mut self, system: &mut dyn System, recorder: &mut Recorder) -> Result<(), Cause> {
        let Some(projection) = self.projection.as_mut().filter(|_| !is_sprung(system)) else { return Ok(()) };
        let now = self.clock.now();
        projection.observe(system, now, self.stepper.start().y);
        if let Some((row, residual)) = projection.lost(system) {
            let constraint = system.description().rows[row].name.to_string();
            return Err(Cause::ConstraintLost { constraint, residual });
        }
        let active: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
        let taken = blow(system, (now, self.stepper.start().y), &active, |_| 0.0);
        self.take(system, taken.map_err(|fault| fault.cause(system.description()))?, recorder);
        Ok(())
    }

    /// Does one thing; true where the state or the phase may have changed.
    fn does(
        &mut self,
        system: &mut dyn System,
        (event, action): (usize, Action),
        recorder: &mut Recorder,
    ) -> Result<bool, Cause> {
        match action {
            Action::Stop | Action::Record => Ok(false),
            Action::Phase(phase) => self.enter(system, phase as usize, recorder).map(|()| true),
            Action::Impact { along, restitution } => {
                let e = self.strike(system, along, restitution as usize, recorder)?;
                let now = self.clock.now();
                let end = if e == 0.0 { Some(now) } else { self.flights.impact(event, now) };
                if let Some(end) = end {
                    self.rest(system, (event, along), end, recorder)?;
                }
                Ok(true)
            }
        }
    }

    /// Goes on in a phase: its constraints must hold, and take away what speed they do not leave.
    fn enter(&mut self, system: &mut dyn System, phase: usize, recorder: &mut Recorder) -> Result<(), Cause> {
        let before: Vec<u32> = system.active_rows().to_vec();
        system.set_phase(phase);
        let active: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
        let now = self.clock.now();
        if let Some(projection) = &mut self.projection {
            projection.observe(system, now, self.stepper.start().y);
            let entering = active.iter().filter(|row| !before.contains(&(**row as u32)));
            for &row in entering {
                let known = &system.description().rows[row];
                if let Some(residual) = projection.misses(row).filter(|_| known.holonomic) {
                    let phase = system.description().phases[phase].name.to_string();
                    return Err(Cause::PhaseMisses { phase, constraint: known.name.to_string(), residual });
                }
            }
        }
        // Springs take up what speed there is.
        if !is_sprung(system) {
            let taken = blow(system, (now, self.stepper.start().y), &active, |_| 0.0);
            self.take(system, taken.map_err(|fault| fault.cause(system.description()))?, recorder);
        }
        recorder.phase(phase, now);
        Ok(())
    }

    /// An impact along a constraint, with those that are active kept; the coefficient of restitution.
    fn strike(
        &mut self,
        system: &mut dyn System,
        along: u32,
        restitution: usize,
        recorder: &mut Recorder,
    ) -> Result<f64, Cause> {
        let e = system.restitutions().get(restitution).copied().unwrap_or(0.0);
        if !(0.0..=1.0).contains(&e) {
            return Err(Cause::BadRestitution { value: e });
        }
        let rows = with(system, along);
        let rows_along = rows_of(system, along);
        let restitution = |row: usize| if rows_along.contains(&row) { e } else { 0.0 };
        let struck = blow(system, (self.clock.now(), self.stepper.start().y), &rows, restitution);
        self.take(system, struck.map_err(|fault| fault.cause(system.description()))?, recorder);
        Ok(e)
    }

    /// Impacts accumulate: the motion goes on at their end, in the phase that has their constraint too.
    fn rest(
        &mut self,
        system: &mut dyn System,
        (event, along): (usize, u32),
        end: f64,
        recorder: &mut Recorder,
    ) -> Result<(), Cause> {
        let rows: Vec<u32> = with(system, along).into_iter().map(|row| row as u32).collect();
        let phases = &system.description().phases;
        let Some(phase) = phases.iter().position(|phase| *phase.rows == *rows) else {
            let event = system.description().events[event].name.to_string();
            return Err(Cause::ImpactsAccumulate { event, t: end });
        };
        let (left, n) = (end - self.clock.now(), system.len());
        let (q, v) = self.stepper.state_mut().split_at_mut(n);
        q.iter_mut().zip(v.iter()).for_each(|(q, v)| *q += left * v);
        self.clock.set(end);
        self.flights = Flights::default();
        if left > 0.0 {
            recorder.accumulated(system, event, end);
        }
        self.enter(system, phase, recorder)
    }

    fn take(&mut self, system: &dyn System, Blow { jump, rows }: Blow, recorder: &mut Recorder) {
        let n = system.len();
        let speeds = &mut self.stepper.state_mut()[n..];
        let size = speeds.iter().zip(&jump).fold(0.0_f64, |most, (v, jump)| most.max(v.abs()).max(jump.abs()));
        speeds.iter_mut().zip(&jump).for_each(|(v, jump)| *v += jump);
        // What is left of constraints that were met already is rounding, and no impulse.
        if !jump.iter().any(|jump| jump.abs() > ROUNDING * size) {
            return;
        }
        let constraints: Vec<(String, f64)> =
            rows.iter().map(|(row, impulse)| (system.description().rows[*row].name.to_string(), *impulse)).collect();
        recorder.impulse(Impulse { t: self.clock.now(), inputs: Vec::new(), constraints, jump });
    }
}

/// Whether springs stand for the constraints.
fn is_sprung(system: &dyn System) -> bool {
    matches!(system.enforcement(), Enforcement::Springs { .. })
}

/// The rows of a constraint.
fn rows_of(system: &dyn System, constraint: u32) -> Vec<usize> {
    let rows = system.description().rows.iter().enumerate();
    rows.filter(|(_, row)| row.constraint == constraint).map(|(k, _)| k).collect()
}

/// Active rows and those of one more constraint, in order.
fn with(system: &dyn System, constraint: u32) -> Vec<usize> {
    let mut rows: Vec<usize> = system.active_rows().iter().map(|row| *row as usize).collect();
    rows.extend(rows_of(system, constraint));
    rows.sort_unstable();
    rows.dedup();
    rows
}
