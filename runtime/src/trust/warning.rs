//! What the user should know about a run that succeeded.

use std::fmt;
use std::mem;

use crate::cause::GimbalLock;
use crate::mechanism::Method;
use crate::numbers::{counted, short, short_within};

/// A position is passed within this part of the time at which that is seen, as a step tells it.
const SEEN_LATE: f64 = 0.01;

/// A reason to trust a run less.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The tolerance was below what rounding allows; a larger one was used.
    ToleranceTooTight {
        /// What was asked for.
        asked: f64,
        /// What was used.
        used: f64,
    },
    /// The energy balance drifted by more than the method and the tolerance let expect.
    EnergyBudgetExceeded {
        /// Its drift.
        drift: f64,
        /// What would have been usual.
        limit: f64,
    },
    /// What the model says is conserved drifted by more than the tolerance lets expect.
    InvariantDrifts {
        /// Its name in the model file.
        invariant: String,
        /// Its drift.
        drift: f64,
        /// What would have been usual.
        limit: f64,
    },
    /// The mechanism can be put together in another way from the same start, and nobody chose.
    OtherBranch {
        /// A coordinate that tells them apart.
        coordinate: String,
        /// What it is.
        here: f64,
        /// What it would be.
        there: f64,
    },
    /// A rule of quadrature that stands for an integral was tried for other values of something in it.
    IntegralUntried {
        /// The integral, as the file writes it.
        integral: String,
        /// The parameter, coordinate or rate, or `t`.
        of: String,
        /// What it is, or comes to along the motion, SI.
        value: f64,
        /// Between which values it was tried.
        range: [f64; 2],
    },
    /// The argument of a table goes beyond its points, where the table goes on by a rule that nobody measured.
    LeavesTable {
        /// The table.
        table: String,
        /// When it does so first, s.
        t: f64,
    },
    /// The motion began symmetric, which its equations keep, and left the symmetry: what rounding does to it grows.
    LeavesSymmetry {
        /// From when on it is seen, s.
        t: f64,
        /// The exchange or reflection.
        symmetry: String,
        /// The largest departure, in parts of the largest values.
        by: f64,
    },
    /// Outputs are made of reactions of which the motion determines sums only, since constraints depend on each other at the end of the run.
    ReactionsNotUnique {
        /// The outputs, component by component.
        outputs: Vec<String>,
    },
    /// Constraints, or contacts, depend on each other, and friction is made of their reactions: how they share a force is not determined, and the motion
    /// depends on it.
    MotionNotUnique {
        /// The constraints.
        constraints: Vec<String>,
        /// Whether they share it as springs would that are alike at all; where steps go over contacts they do not.
        as_springs: bool,
    },
    /// The motion passed a place where its constraints depend on each other; it kept the branch that continues its speeds.
    SingularPassed {
        /// The end of the step in which that was seen, s.
        t: f64,
    },
    /// The motion passed a gimbal lock so near that its steps became short: small errors of the state there are large ones of the angles.
    NearGimbalLock {
        /// The lock.
        lock: GimbalLock,
        /// When it was nearest, s.
        t: f64,
        /// How far the middle angle was from the lock then, rad.
        angle: f64,
        /// Which part of all steps was taken near it.
        part: f64,
    },
    /// Steps over contacts were taken in which impulses still changed from round to round.
    UnsettledImpulses {
        /// When the first of them was, s.
        t: f64,
        /// How many.
        steps: u64,
        /// By how much at the most, as a part of the largest.
        residual: f64,
    },
    /// Impacts follow each other ever faster; the motion goes on with a resting contact where they end.
    ImpactsAccumulate {
        /// The event.
        event: String,
        /// When they end, s.
        t: f64,
    },
    /// The fixed step is too long for what happens within one: a pulse, a narrow well, a steep wall.
    PassedOver {
        /// When first, s.
        t: f64,
    },
    /// The motion starts at rest on a kink or jump from which both sides lead away.
    BothSidesLeave {
        /// What is zero there.
        switch: String,
    },
    /// An event that strikes or changes the phase is past its zero where the motion starts, or at it without a direction, or one that sets held
    /// values is at it and moves past, and does not happen.
    PastAtStart {
        /// The event.
        event: String,
    },
    /// An event that stops or sets held values is past its zero where the motion starts, or at it and moves past, and does not happen later either.
    NeverPassed {
        /// The event.
        event: String,
    },
    /// It stays where it starts, at rest in an unstable equilibrium.
    StaysUnstably {
        /// In which time what disturbs it grows e times, s.
        time: f64,
    },
    /// More events happened than are kept.
    EventsEnd {
        /// When the first was left out, s.
        t: f64,
        /// How many are kept.
        kept: usize,
    },
    /// The energy balance jumped between two looks at it.
    EnergyJump {
        /// When, s.
        t: f64,
        /// By how much, relative to the scale of the energies.
        jump: f64,
    },
    /// The fixed step is beyond the method's stability limit for a mode of the system linearised at some state of the run.
    StepExceedsStability {
        /// The method.
        method: Method,
        /// The step, s.
        step: f64,
        /// The largest stable step, s.
        limit: f64,
        /// Real part of the mode's eigenvalue, 1/s.
        real: f64,
        /// Imaginary part of the mode's eigenvalue, rad/s.
        imaginary: f64,
        /// By which factor the method amplifies the mode over the run.
        growth: f64,
    },
    /// The rounding of larger coordinates of the same unit limits the accuracy of this one.
    RoundingLimits {
        /// The coordinate.
        coordinate: String,
        /// What is left of it, in its SI unit.
        to: f64,
    },
    /// An event's function comes to zero and turns back, as far as rounding tells; no crossing was counted.
    Touch {
        /// The event.
        event: String,
        /// When it did first, s.
        t: f64,
    },
    /// An event's function changes its sign by a jump or through a pole, which is no zero; no crossing was counted.
    NoCrossing {
        /// The event.
        event: String,
        /// When it did first, s.
        t: f64,
    },
    /// An event's function is not defined on a part of the run.
    Undefined {
        /// The event.
        event: String,
        /// Where its definition ends or begins first, s.
        t: f64,
    },
    /// An input is a closure, which tells nothing of itself between the times at which it was scanned.
    InputScanned {
        /// The input.
        input: String,
        /// Features narrower than this, s, may have been missed.
        width: f64,
    },
    /// From some time on no digit of a coordinate or rate can be promised.
    DigitsLost {
        /// When, s.
        t: f64,
        /// The coordinate, or its rate with a prime.
        column: String,
        /// Why.
        why: Loss,
    },
    /// A second run, slightly different, has another number of events.
    EventsDiffer {
        /// How many this run has.
        here: usize,
        /// How many the other one has.
        there: usize,
    },
    /// A crossing lies nearer to the end of the run than the error of the last state.
    EventNearEnd {
        /// The event.
        event: String,
    },
    /// An event's function turns back so near to zero that an error as large as the run's may add two crossings or take two
    /// away.
    EventGrazes {
        /// The event.
        event: String,
        /// When, s.
        t: f64,
    },
    /// The run has too many steps to keep dense output of them all.
    DenseOutputEnds {
        /// Until when there is dense output, s.
        t: f64,
    },
    /// The step is limited by stability, not by accuracy: an implicit method would need far fewer.
    Stiff {
        /// When it was noticed, s.
        t: f64,
        /// The estimate of h|λ| that stays at the limit.
        step_times_rate: f64,
    },
}

/// Why no digits are left.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Loss {
    /// The motion is chaotic, or unstable: differences at the start grow by this factor until then.
    Instability {
        /// The factor.
        growth: f64,
    },
    /// It begins at rest in an unstable equilibrium, and only rounding moves it.
    UnstableStart,
    /// A run whose start differs by rounding fails: why, by [`Cause::code`](crate::Cause::code), and when.
    Fails {
        /// s.
        t: f64,
        /// A word for it.
        cause: &'static str,
    },
    /// The fixed step is too coarse.
    CoarseStep {
        /// The step, s.
        step: f64,
    },
    /// The tolerance is too loose for so long a run.
    LooseTolerance {
        /// The tolerance.
        tolerance: f64,
    },
}

impl fmt::Display for Loss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Loss::Instability { growth } => {
                write!(f, "the motion is chaotic or unstable: a difference at the start grows {growth:.0e} times")
            }
            Loss::UnstableStart => {
                write!(f, "it starts at rest in an unstable equilibrium, so that rounding decides where it goes")
            }
            Loss::Fails { t, cause } => {
                write!(f, "a run whose start differs by rounding ends at t = {t} s: {cause}", t = short(*t))
            }
            Loss::CoarseStep { step } => write!(f, "the fixed step of {step} s is too coarse"),
            Loss::LooseTolerance { tolerance } => {
                write!(f, "the tolerance {tolerance:e} is too loose for so long a run")
            }
        }
    }
}

impl Warning {
    /// True when the other warning says the same, with other numbers; of events, integrals, tables and frames, of the same one.
    pub fn same_kind(&self, other: &Warning) -> bool {
        mem::discriminant(self) == mem::discriminant(other) && self.event() == other.event()
    }

    /// The event, the integral, the table or the frame of which it speaks.
    fn event(&self) -> Option<&str> {
        match self {
            Warning::Touch { event, .. }
            | Warning::NoCrossing { event, .. }
            | Warning::Undefined { event, .. }
            | Warning::PastAtStart { event }
            | Warning::NeverPassed { event } => Some(event),
            Warning::IntegralUntried { integral, .. } => Some(integral),
            Warning::LeavesTable { table, .. } => Some(table),
            Warning::NearGimbalLock { lock, .. } => Some(&lock.frame),
            _ => None,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Warning::ToleranceTooTight { asked, used } => {
                write!(f, "tolerance too tight: {asked:e} is below rounding; {used:e} was used")
            }
            Warning::EnergyBudgetExceeded { drift, limit } => {
                write!(f, "energy budget exceeded: the balance drifts by {drift:.1e}, where {limit:.1e} would be usual")
            }
            Warning::InvariantDrifts { invariant, drift, limit } => write!(
                f,
                "`{invariant}` is not conserved: it drifts by {drift:.1e}, {:.0} times what the tolerance allows",
                drift / limit
            ),
            Warning::OtherBranch { coordinate, here, there } => write!(
                f,
                "from this start the mechanism can be put together in another way too, with {coordinate} = {} in place of \
                 {}: a `guess` chooses",
                short(*there),
                short(*here)
            ),
            Warning::IntegralUntried { integral, of, value, range: [low, high] } => write!(
                f,
                "`{integral}` is computed by a rule that was tried for `{of}` from {} to {}; at {} nothing is known of its error, and \
                 no digits are promised: a scene of the file that sets or starts from such a value has the rule tried there",
                short(*low),
                short(*high),
                short(*value)
            ),
            Warning::LeavesTable { table, t } => write!(
                f,
                "the motion leaves the table `{table}` at t = {} s: beyond its points it goes on straight, which no point says",
                short(*t)
            ),
            Warning::LeavesSymmetry { t, symmetry, by } => write!(
                f,
                "the motion leaves its symmetry {symmetry} from t = {} s on, by {by:.1e} at most, though its equations keep it: \
                 rounding grows, the symmetric motion is unstable",
                short(*t)
            ),
            Warning::ReactionsNotUnique { outputs } => write!(
                f,
                "the reactions in `{}` are not unique, since constraints depend on each other: one of all shares that give this motion is told; \
                 `check` names the constraints",
                outputs.join("`, `")
            ),
            Warning::MotionNotUnique { constraints, as_springs } => write!(
                f,
                "the motion is one of several: how `{}` share a force is not determined, since they depend on each other, and friction is made of \
                 their reactions; they share it {}; let fewer of them hold, or write such springs",
                constraints.join("`, `"),
                if *as_springs {
                    "as springs would that are alike at all"
                } else {
                    "in one of many ways, others than springs would"
                }
            ),
            Warning::SingularPassed { t } => write!(
                f,
                "the motion passed a singular position near t = {} s, where its constraints depend on each other; it kept \
                 the branch that continues its speeds",
                short_within(*t, SEEN_LATE)
            ),
            Warning::NearGimbalLock { lock, t, angle, part } => write!(
                f,
                "the motion passes within {angle:.1e} rad of a gimbal lock at t = {} s, where {:.0} % of all steps are taken: {lock}",
                short(*t),
                100.0 * part
            ),
            Warning::UnsettledImpulses { t, steps, residual } => write!(
                f,
                "in {}, from t = {} s on, impulses of contacts still changed by up to {residual:.0e} of the largest after all rounds: contacts that \
                 hold each other share their forces in many ways",
                counted(*steps as usize, "step"),
                short(*t)
            ),
            Warning::ImpactsAccumulate { event, t } => write!(
                f,
                "the impacts of `{event}` accumulate at t = {} s, where the motion goes on with a resting contact",
                short(*t)
            ),
            Warning::PassedOver { t } => write!(
                f,
                "the step passes over what happens within it (from t = {} s on: a pulse, a narrow well, a steep wall), and no digits are promised: \
                 take a shorter one, or a method that chooses its steps",
                short(*t)
            ),
            Warning::BothSidesLeave { switch } => write!(
                f,
                "it starts where `{switch}` = 0 and may leave to either side: one was chosen, rounding decides which a real one takes"
            ),
            Warning::PastAtStart { event } => write!(
                f,
                "`{event}` is already at or past its zero at the start and does nothing: start on its other side, or, if it changes the phase, \
                 give it a `direction` and the `phase` that it ends"
            ),
            Warning::NeverPassed { event } => write!(
                f,
                "`{event}` does not happen: at the start its function is past zero in its direction, or at zero and goes past; start on its other side"
            ),
            Warning::StaysUnstably { time } => write!(
                f,
                "it stays at rest in an unstable equilibrium: any disturbance grows e times in {time} s, and nothing disturbs it here",
                time = short(*time)
            ),
            Warning::EventsEnd { t, kept } => {
                write!(
                    f,
                    "events are left out from t = {t} s on: {kept} are kept, more would fill the memory",
                    t = short(*t)
                )
            }
            Warning::EnergyJump { t, jump } => {
                write!(f, "energy jumps by {jump:.1e} of its scale shortly before t = {t} s", t = short(*t))
            }
            Warning::StepExceedsStability { method, step, limit, real, imaginary, growth } => {
                write!(
                    f,
                    "step exceeds stability: `{method}` at a step of {step} s amplifies the mode with eigenvalue \
                     {real:.4} ± {imaginary:.4}i 1/s by {growth:.2e} over the run"
                )?;
                if *limit > 0.0 {
                    write!(f, "; its limit is {limit:.4e} s")
                } else {
                    write!(f, ", as it does at any step")
                }
            }
            Warning::RoundingLimits { coordinate, to } => {
                write!(f, "rounding of larger coordinates limits `{coordinate}` to {to:.1e}")
            }
            Warning::Touch { event, t } => write!(
                f,
                "`{event}` touches zero at t = {t} s: whether it crosses is below what rounding tells, and was not counted",
                t = short(*t)
            ),
            Warning::NoCrossing { event, t } => write!(
                f,
                "`{event}` changes its sign at t = {t} s by a jump or a pole, which is no zero and was not counted",
                t = short(*t)
            ),
            Warning::Undefined { event, t } => {
                write!(f, "`{event}` is undefined on one side of t = {t} s; nothing was counted there", t = short(*t))
            }
            Warning::InputScanned { input, width } => write!(
                f,
                "features of `{input}` narrower than {width:.1e} s may be missed, since it is a closure; give a longest step"
            ),
            Warning::DigitsLost { t, column, why } => {
                write!(f, "no digit of `{column}` can be promised from t = {t} s on: {why}", t = short(*t))
            }
            Warning::EventsDiffer { here, there } => write!(
                f,
                "{} happened in this run, and {there} in a second one that differs slightly: some were close calls",
                counted(*here, "event")
            ),
            Warning::EventNearEnd { event } => {
                write!(f, "`{event}` lies so near to the end of the run that it may be just before or just after it")
            }
            Warning::EventGrazes { event, t } => write!(
                f,
                "`{event}` turns back so near to zero at t = {t} s that two crossings may be too many or missing",
                t = short(*t)
            ),
            Warning::DenseOutputEnds { t } => {
                write!(f, "dense output ends at t = {t} s: it would fill the memory", t = short(*t))
            }
            Warning::Stiff { t, step_times_rate } => write!(
                f,
                "stiff: from about t = {t} s on the step is limited by stability (h|λ| ≈ {step_times_rate:.1}), not by accuracy",
                t = short(*t)
            ),
        }
    }
}
