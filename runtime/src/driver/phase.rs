//! Phases and impacts: what events do to the state and to the constraints in force.

use super::Integration;
use super::constraints::held_coordinates;
use crate::cause::Cause;
use crate::constrain::{VelocityJump, closed_within, lasting_rows, possible_restitution, velocity_jump};
use crate::events::{Impulse, gained};
use crate::mechanism::dense::{impulse_terms, sizes_alike};
use crate::mechanism::{Action, At, Direction, Enforcement, Event, Rated, System, rows_in_force};
use crate::run::{Recorder, SpeedJump};

/// Changes of speeds below this part of them are none.
const ROUNDING: f64 = 1e-12;
/// An event's instant is known to this part of the time: a few roundings.
const INSTANT_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Flights shorter than this part of the first are not followed one by one.
const SHORT: f64 = 1e-6;
/// Hops below this part of the sum of a constraint's terms are rounding.
const LOW: f64 = 64.0 * f64::EPSILON;
/// Two estimates of the time at which impacts accumulate agree to this part of it.
const AGREE: f64 = 1e-6;

/// Impacts of one event that follow each other faster and faster (Zeno).
#[derive(Clone, Debug, Default)]
struct ZenoDetector {
    /// When the last impact was, s.
    last: Option<f64>,
    /// The first flight, and the last one, s.
    first: Option<f64>,
    flight: Option<f64>,
    estimate: Option<f64>,
}

/// An impact that was.
struct Struck {
    /// The coefficient of restitution.
    restitution: f64,
    /// Rows with their impulses.
    impulses: Vec<(usize, f64)>,
}

/// What an action did.
#[derive(Default)]
pub(super) struct Done {
    /// Whether the state or the phase may have changed.
    pub acts: bool,
    /// Whether speeds jumped, or would have if there were any.
    pub strikes: bool,
}

/// The highest hop that is lost in rounding.
pub(super) struct LowHop {
    /// What brings it back: c''.
    pub back: f64,
    /// The rate with which it begins.
    pub rate: f64,
}

/// The impacts of all events.
#[derive(Clone, Debug, Default)]
pub(super) struct Impacts {
    of: Vec<ZenoDetector>,
}

impl Impacts {
    /// Notes an impact of an event at t; the time at which they accumulate where that is known well enough.
    pub fn note(&mut self, event: usize, t: f64) -> Option<f64> {
        if self.of.len() <= event {
            self.of.resize(event + 1, ZenoDetector::default());
        }
        self.of[event].note(t)
    }

    /// Whether one of an event was noted since they began anew.
    fn has(&self, event: usize) -> bool {
        self.of.get(event).is_some_and(|zeno| zeno.last.is_some())
    }

    /// Begins anew with those of an event.
    pub fn forget(&mut self, event: usize) {
        self.of.get_mut(event).into_iter().for_each(|zeno| *zeno = ZenoDetector::default());
    }
}

impl ZenoDetector {
    fn note(&mut self, t: f64) -> Option<f64> {
        let flight = t - self.last.replace(t)?;
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

impl Integration {
    /// Brings the speeds to constraints that a sharp turn of time or of an input moves, `late` seconds after the state was reached; not to
    /// contacts, whose forces are bounded or push only.
    ///
    /// # Errors
    /// A constraint that jumps, which no finite force could follow.
    pub(super) fn apply_velocity_jump(
        &mut self,
        system: &mut dyn System,
        late: f64,
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        let Some(projection) = self.projection.as_mut().filter(|_| !is_sprung(system)) else { return Ok(()) };
        let now = self.clock.now();
        let y = self.stepper.start().y;
        projection.observe(system, now, y);
        if let Some((row, residual)) = projection.lost(system, At::packed(now, y, system.len()), late) {
            let constraint = system.description().rows[row].name.to_string();
            return Err(Cause::ConstraintLost { constraint, residual }.into());
        }
        let taken = velocity_jump(system, (now, self.stepper.start().y), &lasting_rows(system), |_| 0.0);
        self.take(system, taken.map_err(|fault| fault.cause(system.description()))?, recorder);
        Ok(())
    }

    /// Does what an action says of phases, contacts and speeds.
    pub(super) fn does(
        &mut self,
        system: &mut dyn System,
        (event, action): (usize, Action),
        recorder: &mut Recorder,
    ) -> Result<Done, Box<Cause>> {
        match action {
            Action::Stop | Action::Record | Action::Set(_) => Ok(Done { acts: false, strikes: false }),
            Action::Phase(phase) => self.alternate(system, (event, phase as usize), recorder),
            Action::Contact(contact) => self.change_contact(system, (event, contact as usize), recorder),
            Action::Impact { along, .. } if self.recedes(system, event) => {
                // Where a motion starts, what falls back before times can tell has not left.
                if self.begins {
                    let along = rows_of(system, along);
                    self.settle(system, (event, &along), (self.clock.now(), &[]), recorder)?;
                }
                Ok(Done { acts: self.begins, strikes: self.begins })
            }
            Action::Impact { along, restitution } => {
                let Struck { restitution: e, impulses } =
                    self.strike(system, (event, along), restitution as usize, recorder)?;
                let now = self.clock.now();
                let end = match e == 0.0 || self.is_too_low(system, along) {
                    true => Some(now),
                    // What loses no speed goes on for ever.
                    false if e == 1.0 => None,
                    false => self.impacts.note(event, now),
                };
                if let Some(end) = end {
                    // What is left of a geometric series of impulses.
                    let along = rows_of(system, along);
                    let left = impulses.into_iter().filter(|(row, _)| along.contains(row) && end > now);
                    let left: Vec<(usize, f64)> = left.map(|(row, impulse)| (row, impulse * e / (1.0 - e))).collect();
                    self.settle(system, (event, &along), (end, &left), recorder)?;
                }
                Ok(Done { acts: true, strikes: true })
            }
        }
    }

    /// Whether the function of an event goes back already: where it only touches its zero, the instant that was located may be behind that.
    fn recedes(&self, system: &dyn System, event: usize) -> bool {
        let &Event { direction, rated, .. } = &system.description().events[event];
        let n = system.len();
        let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
        let at = At::packed(self.clock.now(), self.stepper.start().y, n);
        if rated != Rated::Whole || system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
            return false;
        }
        let mut rates = vec![0.0; system.description().events.len()];
        system.event_rates(at.accelerated(&a).constrained(&lambda), &mut rates);
        match direction {
            Direction::Rising => rates[event] < 0.0,
            Direction::Falling => rates[event] > 0.0,
            Direction::Both => false,
        }
    }

    /// Whether the hop after an impact, c'²/(2 |c''|) high, is below the rounding of what it is a hop from.
    fn is_too_low(&self, system: &dyn System, along: u32) -> bool {
        let n = system.len();
        let mut triples = vec![0.0; 3 * system.description().rows.len()];
        system.constraints(At::packed(self.clock.now(), self.stepper.start().y, n), &mut triples);
        let hops = self.low_hops(system, &[]);
        let low = |row: &usize| {
            let rate = triples[3 * row + 1];
            rate * hops[*row].back <= 0.0 && rate.abs() <= hops[*row].rate
        };
        !hops.is_empty() && rows_of(system, along).iter().all(low)
    }

    /// Of each row the hop, c'²/(2 |c''|) high, that is lost in the rounding of what it is a hop from: of the sum of the terms of c, here or as
    /// large as `scales` know it; none where accelerations are not known.
    pub(super) fn low_hops(&self, system: &dyn System, scales: &[f64]) -> Vec<LowHop> {
        let (n, count) = (system.len(), system.description().rows.len());
        let at = At::packed(self.clock.now(), self.stepper.start().y, n);
        let (mut triples, mut a, mut bias) = (vec![0.0; 3 * count], vec![0.0; n], vec![0.0; count]);
        if system.accelerations_and_multipliers(at, &mut a, &mut bias).is_err() {
            return Vec::new();
        }
        system.constraints(at, &mut triples);
        system.constraint_bias(at, &mut bias);
        let pattern = &system.description().constraint_pattern;
        let mut values = vec![0.0; pattern.len()];
        system.constraint_matrix(at, &mut values);
        for ((row, column), value) in pattern.iter().zip(values) {
            bias[*row as usize] += value * a[*column as usize];
        }
        let hop = |(row, back): (usize, f64)| {
            let terms = triples[3 * row + 2].max(scales.get(row).copied().unwrap_or(0.0));
            LowHop { back, rate: (2.0 * back.abs() * LOW * terms).sqrt() }
        };
        bias.into_iter().enumerate().map(hop).collect()
    }

    /// Goes on in a phase; where its entries, each of which takes speed away, accumulate, as those of a block that rocks to
    /// rest, in the one that has the constraints of both.
    fn alternate(
        &mut self,
        system: &mut dyn System,
        (event, phase): (usize, usize),
        recorder: &mut Recorder,
    ) -> Result<Done, Box<Cause>> {
        let before: Vec<usize> = rows_in_force(system).collect();
        let strikes = self.enter(system, phase, &[], recorder)?;
        let now = self.clock.now();
        if !strikes {
            self.impacts.forget(event);
        } else if let Some(end) = self.impacts.note(event, now) {
            self.rest(system, (event, &before), (end, &[]), recorder)?;
        }
        Ok(Done { acts: true, strikes })
    }

    /// Goes on in a phase: its constraints must hold, and take away what speed they do not leave, by impulses of which `known` are
    /// others than the speeds at this instant show; true where there were any.
    pub(super) fn enter(
        &mut self,
        system: &mut dyn System,
        phase: usize,
        known: &[(usize, f64)],
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let mut strikes = false;
        let before: Vec<u32> = system.active_rows().to_vec();
        system.set_phase(phase);
        let active: Vec<usize> = rows_in_force(system).collect();
        let now = self.clock.now();
        let entering: Vec<usize> = active.iter().copied().filter(|row| !before.contains(&(*row as u32))).collect();
        if let Some((constraint, residual)) = self.missed(system, &entering) {
            let phase = system.description().phases[phase].name.to_string();
            return Err(Cause::PhaseMisses { phase, constraint, residual }.into());
        }
        // Springs take up what speed there is.
        if !is_sprung(system) {
            recorder.jump(|| SpeedJump { rows: active.clone(), hit: None });
            let taken = velocity_jump(system, (now, self.stepper.start().y), &active, |_| 0.0);
            let mut taken = taken.map_err(|fault| fault.cause(system.description()))?;
            for (row, impulse) in known {
                taken.rows.iter_mut().filter(|(of, _)| of == row).for_each(|(_, taken)| *taken = *impulse);
            }
            strikes = self.take(system, taken, recorder);
        }
        recorder.phase(phase, now);
        Ok(strikes)
    }

    /// The first of some rows whose holonomic constraint does not hold here, and by how much it is missed.
    fn missed(&mut self, system: &dyn System, rows: &[usize]) -> Option<(String, f64)> {
        let now = self.clock.now();
        let projection = self.projection.as_mut()?;
        projection.observe(system, now, self.stepper.start().y);
        let within = |row: usize| {
            let struck = self.struck.as_ref().filter(|(t, _)| *t == now);
            let y = struck.map_or(self.stepper.start().y, |(_, y)| y);
            closed_within(system, At::packed(now, y, system.len()), projection.scales())[row]
        };
        let holonomic = rows.iter().copied().filter(|row| system.description().rows[*row].holonomic);
        let missed = |row: usize| Some((row, projection.misses(row)?));
        let (row, residual) = holonomic.filter_map(missed).find(|(row, c)| c.is_nan() || c.abs() > within(*row))?;
        Some((system.description().rows[row].name.to_string(), residual))
    }

    /// An impact of an event along a constraint, with those that are active kept; the coefficient of restitution, and the impulses.
    fn strike(
        &mut self,
        system: &mut dyn System,
        (event, along): (usize, u32),
        restitution: usize,
        recorder: &mut Recorder,
    ) -> Result<Struck, Box<Cause>> {
        let e = system.restitutions().get(restitution).copied().unwrap_or(0.0);
        possible_restitution(e)?;
        let rows_along = rows_of(system, along);
        if let Some((constraint, residual)) = self.missed(system, &rows_along) {
            let event = system.description().events[event].name.to_string();
            return Err(Cause::ImpactMisses { event, constraint, residual }.into());
        }
        let rows = with(system, &rows_along);
        recorder.jump(|| SpeedJump { rows: rows.clone(), hit: Some((rows_along.clone(), restitution)) });
        let restitution = |row: usize| if rows_along.contains(&row) { e } else { 0.0 };
        let hit = velocity_jump(system, (self.clock.now(), self.stepper.start().y), &rows, restitution);
        let hit = hit.map_err(|fault| fault.cause(system.description()))?;
        let impulses = hit.rows.clone();
        self.take(system, hit, recorder);
        Ok(Struck { restitution: e, impulses })
    }

    /// Lets a motion rest where impacts accumulate.
    ///
    /// # Errors
    /// No phase has these rows too.
    fn settle(
        &mut self,
        system: &mut dyn System,
        (event, along): (usize, &[usize]),
        (end, known): (f64, &[(usize, f64)]),
        recorder: &mut Recorder,
    ) -> Result<(), Box<Cause>> {
        if self.rest(system, (event, along), (end, known), recorder)? {
            return Ok(());
        }
        let event = system.description().events[event].name.to_string();
        Err(Cause::ImpactsAccumulate { event, t: end }.into())
    }

    /// Impacts accumulate: the motion goes on at their end, in the phase that has these rows too, with what impulses are
    /// `known` to be left; false where there is no such phase.
    fn rest(
        &mut self,
        system: &mut dyn System,
        (event, along): (usize, &[usize]),
        (end, known): (f64, &[(usize, f64)]),
        recorder: &mut Recorder,
    ) -> Result<bool, Box<Cause>> {
        let rows = with(system, along);
        let phases = &system.description().phases;
        let same = |known: &[u32]| known.iter().map(|row| *row as usize).eq(rows.iter().copied());
        let Some(phase) = phases.iter().position(|phase| same(&phase.rows)) else { return Ok(false) };
        let (left, n) = (end - self.clock.now(), system.len());
        // The last hops lead along the constraint, on which the contact rests.
        let taken = velocity_jump(system, (self.clock.now(), self.stepper.start().y), &rows, |_| 0.0);
        let VelocityJump { jump, .. } = taken.map_err(|fault| fault.cause(system.description()))?;
        let (q, v) = self.stepper.state_mut().split_at_mut(n);
        q.iter_mut().zip(v.iter().zip(&jump)).for_each(|(q, (v, jump))| *q += left * (v + jump));
        self.clock.set(end);
        if left > 0.0 {
            recorder.accumulated(system, event, end);
        } else if self.impacts.has(event) {
            recorder.sinks();
        }
        self.impacts.forget(event);
        self.enter(system, phase, known, recorder)?;
        self.carry(system, left);
        Ok(true)
    }

    /// What accelerations make of the speeds, and of the places by these, in the time of hops that were left out.
    pub(super) fn carry(&mut self, system: &dyn System, left: f64) {
        let n = system.len();
        let mut a = vec![0.0; n];
        let at = At::packed(self.clock.now(), self.stepper.start().y, n);
        if left > 0.0 && system.accelerations(at, &mut a).is_ok() {
            let (q, v) = self.stepper.state_mut().split_at_mut(n);
            q.iter_mut().zip(&a).for_each(|(q, a)| *q += 0.5 * left * left * a);
            v.iter_mut().zip(&a).for_each(|(v, a)| *v += left * a);
        }
    }

    /// Lets speeds jump; true where that is more than rounding.
    pub(super) fn take(
        &mut self,
        system: &dyn System,
        VelocityJump { jump, rows }: VelocityJump,
        recorder: &mut Recorder,
    ) -> bool {
        let n = system.len();
        let energy = gained(system, (self.clock.now(), self.stepper.state_mut()), &jump);
        if self.struck.as_ref().is_none_or(|(t, _)| *t != self.clock.now()) {
            self.struck = Some((self.clock.now(), self.stepper.start().y.to_vec()));
        }
        // What the acceleration makes of a speed within the rounding of the instant.
        let instant = INSTANT_ROUNDING * self.clock.now().abs();
        let drifts: Vec<f64> = self.stepper.start().rate[n..].iter().map(|a| instant * a.abs()).collect();
        let mut fastest = self.fastest_before(n);
        let speeds = &mut self.stepper.state_mut()[n..];
        for ((most, v), jump) in fastest.iter_mut().zip(speeds).zip(&jump) {
            *most = most.max(v.abs()).max(jump.abs());
            *v += jump;
        }
        let sizes = sizes_alike(system.description(), &fastest);
        self.rest_where_held(system, &sizes);
        // What is left of constraints that were met already is rounding, and no impulse.
        let is_rounding = |((jump, drift), size): ((&f64, &f64), &f64)| jump.abs() <= (ROUNDING * size).max(*drift);
        if jump.iter().zip(&drifts).zip(&sizes).all(is_rounding) {
            return false;
        }
        let constraints: Vec<(String, f64)> =
            rows.iter().map(|(row, impulse)| (system.description().rows[*row].name.to_string(), *impulse)).collect();
        let terms = impulse_terms(system, At::packed(self.clock.now(), self.stepper.start().y, n), &rows);
        let terms = terms.unwrap_or_else(|| jump.iter().map(|jump| jump.abs()).collect());
        recorder.impulse(Impulse { t: self.clock.now(), inputs: Vec::new(), constraints, jump, terms, energy });
        true
    }
}

impl Integration {
    /// The largest speeds before what happens now, at this instant and, at steps that are chosen, so far: what comes to rest is beside what it was.
    fn fastest_before(&self, n: usize) -> Vec<f64> {
        let seen = self.resumed().into_iter().flat_map(|(_, seen)| seen);
        let struck = self.struck.iter().filter(|(t, _)| *t == self.clock.now()).map(|(_, y)| y.clone());
        let mut fastest = vec![0.0_f64; n];
        for values in seen.chain(struck) {
            let speeds = fastest.iter_mut().zip(&values[n..]).filter(|(_, v)| v.is_finite());
            speeds.for_each(|(most, v)| *most = most.max(v.abs()));
        }
        fastest
    }

    /// Lets coordinates rest that the constraints leave nowhere to go, and whose speeds are rounding beside these sizes: what rounding has left of an
    /// impact would be all that there is.
    fn rest_where_held(&mut self, system: &dyn System, sizes: &[f64]) {
        let n = system.len();
        let Some(held) = held_coordinates(system, At::packed(self.clock.now(), self.stepper.start().y, n)) else {
            return;
        };
        let speeds = self.stepper.state_mut()[n..].iter_mut().zip(held).zip(sizes);
        let rests = speeds.filter(|((v, held), size)| *held && v.abs() <= ROUNDING * **size);
        rests.for_each(|((v, _), _)| *v = 0.0);
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

/// Active rows and others, in order.
fn with(system: &dyn System, others: &[usize]) -> Vec<usize> {
    let mut rows: Vec<usize> = rows_in_force(system).collect();
    rows.extend(others);
    rows.sort_unstable();
    rows.dedup();
    rows
}
