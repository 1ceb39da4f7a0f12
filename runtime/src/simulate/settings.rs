//! What a run can be told.

use std::sync::Arc;

use super::Interruption;
use crate::cause::Cause;
use crate::constrain::KeptSpin;
use crate::driver::Followed;
use crate::error::{Error, Inseparable, Nonlinear};
use crate::integrate::stability;
use crate::mechanism::{Description, Enforcement, Method, Scene, Stabilisation, System};
use nalgebra::Complex;

/// More numbers than this are not reported: they would fill the memory.
const MOST_NUMBERS: f64 = 1e8;

/// A run fails beyond so many steps unless it is told otherwise: minutes of the smallest mechanism.
pub(super) const MOST_STEPS: u64 = 10_000_000;

/// Baumgarte's α for a fixed step h is this over h: larger ones cost accuracy, smaller ones leave drift.
const FIXED_GAIN: f64 = 0.06;

/// How to run.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Settings {
    /// Generalized coordinates at the start, SI.
    pub q: Vec<f64>,
    /// Their rates at the start, SI.
    pub v: Vec<f64>,
    /// Which coordinates keep their values where the start is to meet constraints; the values of the others are the guess.
    /// Empty: all keep theirs.
    pub held_q: Vec<bool>,
    /// Which rates keep their values; those of the others are such that the kinetic energy is least.  Empty: all keep theirs.
    pub held_v: Vec<bool>,
    /// Which of the equations of [`System::start_conditions`](crate::mechanism::System::start_conditions) the start meets beside constraints.
    pub start_conditions: std::ops::Range<usize>,
    /// Angular velocities that stay what they are wherever the start finds the attitude.
    pub(crate) spins: Vec<KeptSpin>,
    /// The latest time at which a run has reached the start, s, before it was brought here by whole periods; 0 of one that was given.
    pub(crate) reached: f64,
    /// Whether the values that are not held were chosen; else the run says so where they decide how a mechanism is put together.
    pub guessed: bool,
    /// The phase in which the run begins, by its place.
    pub phase: usize,
    /// What is held where the run begins, in the order of [`Sampling::memory`](crate::mechanism::Sampling::memory); `None`: as in the
    /// default scene.
    pub memory: Option<Vec<f64>>,
    /// The numbers of the next ticks of all clocks, for a run that goes on where another one ended; `None`: the first that are not before
    /// the start.
    pub ticks: Option<Vec<u64>>,
    /// Where the run begins, s; 0 unless said otherwise.
    pub from: f64,
    /// Where it ends, s.
    pub until: f64,
    /// Tolerance, relative to the range that each coordinate and each rate goes through.
    /// Lower: more steps, smaller errors, down to about 10⁻¹⁴.
    pub tolerance: f64,
    /// Spacing of reported states, s; `None`: 500 points.
    pub every: Option<f64>,
    /// The method of integration.
    pub method: Method,
    /// A fixed step, s; `None`: chosen by the method, for symplectic ones once, by trial steps over the start.
    pub step: Option<f64>,
    /// The longest step the method may choose, s; `None`: the whole run.
    pub longest_step: Option<f64>,
    /// The run fails beyond this many steps; 10⁷ unless said otherwise.
    pub max_steps: u64,
    /// Whether what rounding takes from a step is added to the next (on unless said otherwise); off only to
    /// see what rounding does.
    pub compensated: bool,
    /// Whether to keep dense output for [`Run::at`](crate::Run::at) (on unless said otherwise); it costs memory and, with
    /// `dop853`, three evaluations per step.
    pub dense: bool,
    /// Whether to watch invariants and the energy balance (on unless said otherwise).
    pub watch: bool,
    /// Whether to run a second time, less accurately, to tell how many digits hold (off unless said otherwise); see
    /// [`Digits`](crate::run::Digits).  It costs about three quarters of the run again, twice where discontinuities or
    /// narrow features cut its steps, or where few digits hold.
    pub digits: bool,
    /// Whether decoupled subsystems of the mechanism are run apart, each with the method and the steps that suit it, where
    /// the method is `auto` and no step is given (on unless said otherwise); see [`Run::parts`](crate::Run::parts).
    pub apart: bool,
    /// Events that do nothing and are not recorded, by their places; none unless said otherwise.
    pub ignored_events: Vec<usize>,
    /// How constraints are enforced.
    pub enforcement: Enforcement,
    /// What is done about errors by which the motion leaves its constraints; nothing where springs stand for them.
    pub stabilisation: Stabilisation,
    /// Whether steps that the tolerance does not limit are chosen otherwise than usual: a run to compare with has none in
    /// common, even where stops and growth limit them all.
    pub(crate) decorrelate_steps: bool,
    /// What `auto` does where stability limits its steps.
    pub(crate) where_stiff: WhereStiff,
    /// Steps of another run that limit those of this one.
    pub(crate) followed: Option<Followed>,
    /// The start that this one was moved from by rounding, which decides what is at its zero there.
    pub(crate) beside: Option<Vec<f64>>,
    /// Other times, in order, at which states are reported too.
    pub(crate) instants: Arc<[f64]>,
    /// Whether the run keeps the instants at which the equations change.
    pub(crate) junctions: bool,
    /// The event after which the run ends, in the state that it leaves.
    pub(crate) ends_after: Option<usize>,
    /// What is known from the run that this one goes on.
    pub(crate) resumed: Option<Resumed>,
    /// Bounds on the errors of the start, [q; q'], where another run led to it.
    pub(crate) start_errors: Option<Vec<f64>>,
    /// What ends the run early from outside.
    pub(crate) interruption: Interruption,
}

/// What decides how steps are chosen, where a run ended.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Resumed {
    /// The length of the next step, s.
    pub step: f64,
    /// The least and the largest value of each component of [q; q'] so far; what is not finite is not known.
    pub seen: [Vec<f64>; 2],
}

/// What `auto` does where stability limits its steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum WhereStiff {
    /// It begins again with a stiff method.
    #[default]
    Turns,
    /// It has begun again.
    Turned,
    /// It goes on: the stiff method did not come through.
    Stays,
}

impl Settings {
    /// The settings of a scene, everything else as usual.
    pub fn new(scene: &Scene) -> Self {
        Settings {
            q: scene.q.clone(),
            v: scene.v.clone(),
            held_q: scene.held_q.clone(),
            held_v: scene.held_v.clone(),
            spins: KeptSpin::of_scene(scene),
            start_conditions: scene.start_conditions.clone(),
            reached: 0.0,
            guessed: scene.guessed,
            phase: scene.phase,
            memory: None,
            ticks: None,
            from: 0.0,
            until: scene.until,
            tolerance: scene.tolerance,
            every: scene.every,
            method: Method::Auto,
            step: None,
            longest_step: None,
            max_steps: MOST_STEPS,
            compensated: true,
            dense: true,
            watch: true,
            digits: false,
            apart: true,
            ignored_events: Vec::new(),
            enforcement: Enforcement::default(),
            stabilisation: Stabilisation::default(),
            decorrelate_steps: false,
            where_stiff: WhereStiff::Turns,
            followed: None,
            beside: None,
            instants: Arc::from([]),
            junctions: false,
            ends_after: None,
            resumed: None,
            start_errors: None,
            interruption: Interruption::default(),
        }
    }

    /// The settings of a scene of a mechanism, with what is held where it starts.
    pub fn of_scene<S: System + ?Sized>(system: &S, scene: usize) -> Self {
        Settings { memory: Some(system.scene_memory(scene)), ..Settings::new(&system.scene(scene)) }
    }

    /// Tolerances below this one, about 100 unit round-offs, are raised to it, with a warning.
    pub const TIGHTEST: f64 = 1e-14;

    /// Lets the event of this name do nothing.
    ///
    /// # Errors
    /// [`Error::UnknownName`].
    pub fn ignore(&mut self, mechanism: &Description, event: &str) -> Result<(), Error> {
        let place = mechanism.events.iter().position(|known| known.name == event);
        let unknown = || Error::unknown("event", event, mechanism.events.iter().map(|event| &event.name));
        self.ignored_events.push(place.ok_or_else(unknown)?);
        Ok(())
    }

    /// Spacing of reported states, s.
    pub(super) fn spacing(&self) -> f64 {
        let span = self.until - self.from;
        self.every.unwrap_or(if span > 0.0 { span / 500.0 } else { 1.0 })
    }

    /// Starts at this value of a component of [q; q'], which constraints then leave alone.  An angular velocity that was named stays what it is at another
    /// attitude, until a rate of its rotation is given.
    pub(crate) fn start_at(&mut self, place: usize, value: f64) {
        let n = self.q.len();
        let (list, held, i) = match place.checked_sub(n) {
            None => (&mut self.q, &mut self.held_q, place),
            Some(i) => (&mut self.v, &mut self.held_v, i),
        };
        list[i] = value;
        held.get_mut(i).into_iter().for_each(|held| *held = true);
        if place < n {
            let turned = self.spins.iter().filter(|spin| spin.places().contains(&i));
            turned.for_each(|spin| spin.put(&self.q, &mut self.v));
        } else {
            self.spins.retain(|spin| !spin.places().contains(&i));
        }
    }

    /// Begins in a state [q; q'], all of which is held, that a run of these settings has reached.
    pub(crate) fn begin_in(&mut self, y: &[f64]) {
        self.reached = self.reached.max(self.until.abs());
        let (q, v) = y.split_at(y.len() / 2);
        (self.q, self.v) = (q.to_vec(), v.to_vec());
        (self.held_q, self.held_v, self.spins, self.start_conditions) = (Vec::new(), Vec::new(), Vec::new(), 0..0);
    }

    /// Which of [q; q'] keep their values where the start is to meet constraints.
    pub(crate) fn held(&self) -> Vec<bool> {
        let n = self.q.len();
        let all = |list: &[bool]| if list.is_empty() { vec![true; n] } else { list.to_vec() };
        [all(&self.held_q), all(&self.held_v)].concat()
    }

    /// Refuses a tolerance that no arithmetic in `f64` can meet.
    pub(crate) fn attainable(&self) -> Result<(), Box<Cause>> {
        const ROUND_OFF: f64 = 0.5 * f64::EPSILON;
        if self.step.is_none() && self.tolerance < ROUND_OFF {
            return Err(Cause::ToleranceTooTight { asked: self.tolerance, attainable: Self::TIGHTEST }.into());
        }
        Ok(())
    }

    /// Refuses settings without meaning for a mechanism.
    pub(crate) fn check(&self, mechanism: &Description) -> Result<(), Error> {
        let n = mechanism.coordinates.len();
        for (setting, list) in [("start", &self.q), ("start of the rates", &self.v)] {
            if list.len() != n {
                return Err(Error::WrongLength { setting, given: list.len(), expected: n });
            }
            if let Some(value) = list.iter().find(|value| !value.is_finite()) {
                return Err(Error::BadSetting { setting, value: *value, expected: "finite numbers" });
            }
        }
        for (setting, list) in [("held_q", &self.held_q), ("held_v", &self.held_v)] {
            if !list.is_empty() && list.len() != n {
                return Err(Error::WrongLength { setting, given: list.len(), expected: n });
            }
        }
        let phases = mechanism.phases.len().max(1);
        if self.phase >= phases {
            let expected = "the place of one of the phases";
            return Err(Error::BadSetting { setting: "phase", value: self.phase as f64, expected });
        }
        if let Some(event) = self.ignored_events.iter().find(|event| **event >= mechanism.events.len()) {
            let expected = "the places of events";
            return Err(Error::BadSetting { setting: "ignored_events", value: *event as f64, expected });
        }
        let positive = |setting, value: Option<f64>| match value {
            Some(value) if !(value > 0.0 && value.is_finite()) => {
                Err(Error::BadSetting { setting, value, expected: "a positive number" })
            }
            _ => Ok(()),
        };
        if !self.from.is_finite() {
            return Err(Error::BadSetting { setting: "from", value: self.from, expected: "a finite time" });
        }
        if !(self.until >= self.from && self.until.is_finite()) {
            return Err(Error::BadSetting { setting: "until", value: self.until, expected: "a time after the start" });
        }
        positive("tolerance", Some(self.tolerance))?;
        positive("every", self.every)?;
        let numbers = (2 * n + mechanism.output_len()) as f64 * (self.until - self.from) / self.spacing();
        if numbers > MOST_NUMBERS {
            let expected = "a spacing that leaves at most 10⁸ numbers to report";
            return Err(Error::BadSetting { setting: "every", value: self.spacing(), expected });
        }
        positive("step", self.step)?;
        positive("longest_step", self.longest_step)?;
        if self.step.is_none() && !self.method.is_adaptive() && !self.method.finds_step() {
            return Err(Error::NoStep { method: self.method });
        }
        if let Some(reason) = self.inseparable(mechanism).filter(|_| self.method.wants_separable()) {
            return Err(Error::NotSeparable { method: self.method, reason });
        }
        if let Some(reason) = nonlinear(mechanism).filter(|_| self.method == Method::Exact) {
            return Err(Error::NotLinear { reason });
        }
        self.check_enforcement(mechanism)
    }

    /// What keeps the places and speeds of a mechanism from being moved in turn.
    pub(super) fn inseparable(&self, mechanism: &Description) -> Option<Inseparable> {
        if mechanism.has_states() {
            Some(Inseparable::States)
        } else if !mechanism.structure.constant_mass {
            Some(Inseparable::MassMatrix)
        } else if !mechanism.structure.separable {
            Some(Inseparable::Speeds)
        } else if mechanism.rows.is_empty() {
            None
        } else {
            self.unlike_rattle(mechanism)
        }
    }

    /// What keeps constraints from being met by RATTLE, or forgotten for springs.
    fn unlike_rattle(&self, mechanism: &Description) -> Option<Inseparable> {
        if !mechanism.friction_pattern.is_empty() {
            return Some(Inseparable::Friction);
        }
        match self.enforcement {
            Enforcement::Springs { damping, .. } => return (damping > 0.0).then_some(Inseparable::Speeds),
            Enforcement::NullSpace => return Some(Inseparable::Enforcement),
            Enforcement::Multipliers => {}
        }
        if let Some(row) = mechanism.rows.iter().find(|row| !row.holonomic) {
            return Some(Inseparable::Rates { constraint: row.name.to_string() });
        }
        if matches!(self.stabilisation, Stabilisation::Baumgarte { .. }) {
            return Some(Inseparable::Enforcement);
        }
        (!self.method.is_of_verlet_steps()).then_some(Inseparable::Constraints)
    }

    fn check_enforcement(&self, mechanism: &Description) -> Result<(), Error> {
        let bad = |setting, value, expected| Err(Error::BadSetting { setting, value, expected });
        match self.enforcement {
            Enforcement::Springs { stiffness, .. } if !(stiffness > 0.0 && stiffness.is_finite()) => {
                return bad("stiffness", stiffness, "a positive number");
            }
            Enforcement::Springs { damping, .. } if !(damping >= 0.0 && damping.is_finite()) => {
                return bad("damping", damping, "a number that is not negative");
            }
            Enforcement::Springs { damping: 0.0, .. } => {
                if let Some(row) = mechanism.rows.iter().find(|row| !row.holonomic) {
                    return Err(Error::NeedsDamping { constraint: row.name.to_string() });
                }
            }
            Enforcement::NullSpace if !mechanism.friction_pattern.is_empty() => {
                return Err(Error::NeedsMultipliers);
            }
            _ => {}
        }
        let Stabilisation::Baumgarte { alpha: Some(alpha) } = self.stabilisation else { return Ok(()) };
        if !(alpha > 0.0 && alpha.is_finite()) {
            return bad("alpha", alpha, "a positive number");
        }
        let method = if self.method == Method::Auto { Method::Rk4 } else { self.method };
        match self.step {
            Some(step) if stability(method).amplification(Complex::from(-alpha * step)) > 1.0 => {
                bad("alpha", alpha, "less, or a shorter step: the method is unstable where it decays so fast in a step")
            }
            _ => Ok(()),
        }
    }

    /// Whether states are brought back to the constraints.
    pub(super) fn projects(&self) -> bool {
        self.stabilisation == Stabilisation::Project && !matches!(self.enforcement, Enforcement::Springs { .. })
    }

    /// Baumgarte's α, 1/s, where it is known before the run; 0: none.
    pub(super) fn alpha(&self) -> f64 {
        match (self.stabilisation, self.enforcement) {
            (_, Enforcement::Springs { .. }) => 0.0,
            (Stabilisation::Baumgarte { alpha }, _) => alpha.or(self.step.map(|step| FIXED_GAIN / step)).unwrap_or(0.0),
            _ => 0.0,
        }
    }
}

/// What keeps the exponential of a matrix from being the motion.
fn nonlinear(mechanism: &Description) -> Option<Nonlinear> {
    if !mechanism.rows.is_empty() {
        Some(Nonlinear::Constraints)
    } else {
        (!mechanism.structure.linear).then_some(Nonlinear::Coefficients)
    }
}
