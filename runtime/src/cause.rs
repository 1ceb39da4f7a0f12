//! Why a run could not go on.

use std::fmt;

use crate::numbers::short;

/// Why a run could not go on.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Cause {
    /// The step that the tolerance asks for vanishes beside the time: the motion ends here (a pole, a
    /// discontinuity that the model does not declare).
    StepTooSmall {
        /// The step, s.
        h: f64,
    },
    /// Rounding errors alone exceed the tolerance, however small the step.
    ToleranceTooTight {
        /// What was asked for.
        asked: f64,
        /// What might be attained here.
        attainable: f64,
    },
    /// t + h = t at the fixed step h.
    StepBelowResolution {
        /// The step, s.
        h: f64,
    },
    /// The equations of an implicit method's step could not be solved: the step is too long for them.
    IterationStalled {
        /// The step, s.
        h: f64,
    },
    /// A number is infinite or not a number.
    NonFinite {
        /// Of what: the acceleration of a coordinate, say.
        what: String,
    },
    /// M has no inverse.
    SingularMass {
        /// The coordinate whose pivot vanishes.
        coordinate: String,
    },
    /// The run goes by a system of balances, and one of its equations says nothing in this state: power and energy at
    /// rest.
    VoidBalance {
        /// The system of balances.
        system: String,
        /// The equation's balance.
        balance: String,
        /// True where the balance is one of power or energy.
        at_rest: bool,
    },
    /// The run goes by a system of balances, and came to a phase to which it does not belong.
    NoBalances {
        /// The system of balances.
        system: String,
        /// The phase.
        phase: String,
    },
    /// The run goes by a system of balances, and they are not independent in this state.
    SingularBalances {
        /// The system of balances.
        system: String,
        /// An unknown that it does not determine: an acceleration `theta''`, or a reaction.
        unknown: String,
    },
    /// Values that the start holds miss a constraint.
    StartMissesConstraint {
        /// The constraint.
        constraint: String,
        /// By how much, in its unit (for speeds in that per second).
        residual: f64,
    },
    /// The constraints cannot be met from the start.
    Unreachable {
        /// The constraint that is missed most.
        constraint: String,
        /// By how much, in its unit.
        residual: f64,
        /// True where no small change of the coordinates comes nearer.
        stationary: bool,
    },
    /// The constraints depend on each other here although they do not elsewhere, so that the motion may branch.
    SingularConfiguration {
        /// How far they are from it: the least singular value of their scaled Jacobian.
        sigma: f64,
    },
    /// A phase is entered where a constraint that it brings does not hold.
    PhaseMisses {
        /// The phase.
        phase: String,
        /// The constraint.
        constraint: String,
        /// By how much it is missed, in its unit.
        residual: f64,
    },
    /// An event strikes along a constraint that does not hold there: nothing touches.
    ImpactMisses {
        /// The event.
        event: String,
        /// The constraint.
        constraint: String,
        /// By how much it is missed, in its unit.
        residual: f64,
    },
    /// A coefficient of restitution is not between 0 and 1.
    BadRestitution {
        /// Its value.
        value: f64,
    },
    /// Impacts follow each other ever faster, and no phase has the constraint along which they are.
    ImpactsAccumulate {
        /// The event.
        event: String,
        /// When they come to an end, s.
        t: f64,
    },
    /// The motion does not keep a constraint.
    ConstraintLost {
        /// The constraint.
        constraint: String,
        /// By how much it is missed, in its unit.
        residual: f64,
    },
    /// Friction made of a reaction leaves no motion, or more than one (Painlevé).
    PainleveInconsistent {
        /// The constraint whose reaction it is.
        constraint: String,
    },
    /// What contacts do from here on is not decided by the forces: no combination of sticking, slipping and opening agrees with them, or
    /// several do (Painlevé).
    UndecidedContacts {
        /// The combinations that agree.
        found: Vec<String>,
    },
    /// The limit of a friction is negative, so that it would drive.
    NegativeLimit {
        /// The friction or contact.
        friction: String,
        /// Its limit, SI, or its coefficient of friction.
        limit: f64,
        /// Which of both it is.
        is_coefficient: bool,
    },
    /// The impulses of a step over contacts were not found: projections in turn do not come to an end, or constraints close a gap.
    UnsolvedContacts {
        /// The contact whose impulse changed most in the last round, or whose gap closes.
        contact: String,
        /// By how much, as a part of the largest; ∞ where constraints close its gap.
        residual: f64,
        /// How many rounds were made.
        rounds: u32,
    },
    /// A force that is no friction is made of a reaction, which steps over contacts do not know beforehand.
    ForceOfReaction {
        /// The constraint or contact.
        constraint: String,
    },
    /// The limit of a friction while it sticks is smaller than while it slides.
    StaticBelowLimit {
        /// The friction or contact.
        friction: String,
        /// The limit, SI, or the coefficient of friction, while it sticks.
        sticking: f64,
        /// The same while it slides.
        sliding: f64,
        /// Which of both it is.
        is_coefficient: bool,
    },
    /// The sides of a contact pass through each other.
    Penetrates {
        /// The contact.
        contact: String,
        /// Its gap, in its unit.
        gap: f64,
    },
    /// Contacts strike at once, and what comes of it depends on the order.
    SimultaneousImpacts {
        /// The contacts.
        contacts: Vec<String>,
        /// The rates of all coordinates after impacts one after the other, SI.
        sequential: Vec<f64>,
        /// The same after impacts all at once.
        together: Vec<f64>,
    },
    /// Impacts one after the other at an instant do not come to an end.
    EndlessImpacts {
        /// The contacts.
        contacts: Vec<String>,
    },
    /// An impact would add to the energy, as Newton's law with friction may (Kane).
    ImpactGainsEnergy {
        /// How much, J.
        energy: f64,
        /// Whether the file states Poisson's law.
        by_poisson: bool,
    },
    /// The coordinates fail where the mechanism does not: an element of M grows beyond bounds.
    CoordinateSingularity {
        /// The coordinate.
        coordinate: String,
        /// When it is reached, s.
        t: f64,
    },
    /// What is set at one instant lets events that follow it set again, without an end.
    EndlessSets {
        /// The first of the events that follow.
        event: String,
    },
    /// Both sides of a discontinuity push back to it, and the motion cannot stay there: the sides differ in no rate of its argument.
    Chattering {
        /// The discontinuity's argument, as the model file has it; an event, where phases follow each other without an end.
        switch: String,
        /// Whether that is a rate, which friction may hold.
        is_rate: bool,
    },
    /// The same of a discontinuity whose argument is of states of first order alone.
    ChatteringStates {
        /// The discontinuity's argument, as the model file has it.
        switch: String,
    },
    /// The motion stays on a discontinuity, between its two sides, which the method of integration does not know.
    Sliding {
        /// The discontinuity's argument, as the model file has it.
        switch: String,
    },
    /// The acceleration jumps where the model declares no discontinuity: a force along a direction (`unit`, or
    /// a division by `norm`) has lost it.
    DirectionLost {
        /// The coordinate whose acceleration jumps most.
        coordinate: String,
    },
    /// A mass, or a moment of inertia, is negative: M has a negative pivot, and the coordinate would move against the force.
    NegativeInertia {
        /// The coordinate whose pivot is negative.
        coordinate: String,
    },
    /// Whoever was told the progress asked to stop.
    Interrupted,
    /// Three angles came to a place where they cannot turn a frame in every direction.
    GimbalLock {
        /// Which.
        lock: GimbalLock,
        /// When, s.
        t: f64,
    },
    /// An input jumps at a time where what it moves would need an infinite force.
    InfiniteForce {
        /// The input.
        input: String,
        /// When, s.
        t: f64,
    },
    /// An input that is a Rust function (u, u', u'') changes otherwise than its u' says.
    WrongRate {
        /// The input.
        input: String,
        /// When, s.
        t: f64,
        /// What it says there, SI.
        rate: f64,
        /// How fast its values change there, SI.
        slope: f64,
    },
    /// An event's function, or the argument of a discontinuity, has more zeros within a step than can be told apart.
    OscillatesTooFast {
        /// The event's name, or the argument as the model file has it.
        function: String,
        /// What it is too fast for.
        limit: TooFast,
    },
    /// The ends of a spring or damper meet, so that the line along which it acts has no direction; or a norm or a root in a force
    /// becomes zero.
    EndsMeet {
        /// Its name in the model file.
        load: String,
        /// When, s.
        t: f64,
    },
    /// Taylor's method expands the motion in a power series, and there is none any more.
    NoSeries {
        /// What stands in the way.
        reason: NoSeries,
    },
    /// Steps of the length that the tolerance wants are more to the end than `max_steps` at its usual value, as is known before the first.
    NeedsMoreSteps {
        /// Their length, s.
        step: f64,
        /// So many they are.
        needed: f64,
        /// The limit.
        limit: u64,
    },
    /// More steps than `max_steps`.
    TooManySteps {
        /// The limit.
        limit: u64,
    },
}

/// What a function oscillates too fast for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum TooFast {
    /// So many samples in one step do not tell its zeros apart.
    Samples(u64),
    /// Functions that it is made of turn too often in one step.
    Inside,
    /// It depends on time alone, and has more zeros in a short part of the run than can be listed.
    InTime,
}

/// Why a motion has no power series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoSeries {
    /// The equations contain a function without one, or code was generated without the recurrences.
    Functions,
    /// An input is given, or held, by the program that runs.
    Inputs,
    /// Forces are made of reactions.
    Friction,
    /// Accelerations do not come from Lagrange's equations with multipliers.
    Accelerations,
}

impl fmt::Display for NoSeries {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            NoSeries::Functions => "its equations contain a table, or a `max`, `min` or `abs` under a power, as max(0, x)^1.5, at whose zero no step ends; or its code has no recurrences: `model!(…, methods = \"taylor\")`",
            NoSeries::Inputs => "an input is given by the program, so that only its values are known",
            NoSeries::Friction => "its forces are made of reactions, as friction is",
            NoSeries::Accelerations => {
                "accelerations come from balances, the null space, springs or Baumgarte's stabilisation; take Lagrange's equations and `multipliers`"
            }
        })
    }
}

/// Three angles that turn a frame one after the other, at a value of the middle one where the outer two turn about one axis: some of their
/// rates do not turn the frame, and M is singular.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GimbalLock {
    /// The frame.
    pub frame: String,
    /// The angles' coordinates, in the order of their turns.
    pub angles: [String; 3],
}

impl fmt::Display for GimbalLock {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let GimbalLock { frame, angles: [first, middle, last] } = self;
        write!(
            f,
            "`{first}` and `{last}` turn `{frame}` about one axis at this `{middle}`, where the three angles have no rates of their own; \
             turn it by a coordinate that never locks (`coordinates: {{attitude: rotation}}`, `frames: {{{frame}: {{rotate: attitude}}}}`), \
             or about other axes, which lock elsewhere"
        )
    }
}

impl Cause {
    /// A word for it, for charts and tables.
    pub fn code(&self) -> &'static str {
        match self {
            Cause::StepTooSmall { .. } => "step too small",
            Cause::ToleranceTooTight { .. } => "too tight",
            Cause::StepBelowResolution { .. } => "step below resolution",
            Cause::IterationStalled { .. } => "stalled",
            Cause::NonFinite { .. } => "not finite",
            Cause::SingularMass { .. } => "singular mass",
            Cause::VoidBalance { .. } => "void balance",
            Cause::NoBalances { .. } => "no balances",
            Cause::SingularBalances { .. } => "singular balances",
            Cause::StartMissesConstraint { .. } | Cause::Unreachable { .. } => "inconsistent start",
            Cause::SingularConfiguration { .. } => "singular configuration",
            Cause::PhaseMisses { .. } => "phase misses",
            Cause::ImpactMisses { .. } => "impact misses",
            Cause::BadRestitution { .. } => "bad restitution",
            Cause::ImpactsAccumulate { .. } => "impacts accumulate",
            Cause::ConstraintLost { .. } => "constraint lost",
            Cause::PainleveInconsistent { .. } => "inconsistent friction",
            Cause::UndecidedContacts { .. } => "undecided contacts",
            Cause::NegativeLimit { .. } => "negative limit",
            Cause::StaticBelowLimit { .. } => "static below limit",
            Cause::UnsolvedContacts { .. } => "unsolved contacts",
            Cause::ForceOfReaction { .. } => "force of a reaction",
            Cause::Penetrates { .. } => "penetrates",
            Cause::SimultaneousImpacts { .. } => "simultaneous impacts",
            Cause::EndlessImpacts { .. } => "endless impacts",
            Cause::ImpactGainsEnergy { .. } => "impact gains energy",
            Cause::CoordinateSingularity { .. } => "coordinate singularity",
            Cause::EndlessSets { .. } => "endless sets",
            Cause::Chattering { .. } | Cause::ChatteringStates { .. } => "chattering",
            Cause::Sliding { .. } => "sliding",
            Cause::DirectionLost { .. } | Cause::EndsMeet { .. } => "direction lost",
            Cause::NegativeInertia { .. } => "negative inertia",
            Cause::Interrupted => "interrupted",
            Cause::GimbalLock { .. } => "gimbal lock",
            Cause::InfiniteForce { .. } => "infinite force",
            Cause::WrongRate { .. } => "wrong rate",
            Cause::OscillatesTooFast { .. } => "oscillates too fast",
            Cause::NoSeries { .. } => "no power series",
            Cause::TooManySteps { .. } | Cause::NeedsMoreSteps { .. } => "too many steps",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Cause::StepTooSmall { h } => {
                write!(f, "step too small: the tolerance asks for a step of {h:e} s, which vanishes beside the time")
            }
            Cause::ToleranceTooTight { asked, attainable } => {
                write!(
                    f,
                    "tolerance too tight: {asked:e} is far below rounding; the tightest that is meant is {attainable:e}"
                )
            }
            Cause::StepBelowResolution { h } => write!(f, "step below resolution: t + {h:e} s is t"),
            Cause::IterationStalled { h } => write!(
                f,
                "the equations of a step of {h:e} s could not be solved: it is too long for the method's iteration"
            ),
            Cause::NonFinite { what } => write!(f, "{what} is not finite"),
            Cause::SingularMass { coordinate } => {
                write!(f, "singular mass matrix: nothing gives `{coordinate}` an inertia here")
            }
            Cause::VoidBalance { system, balance, at_rest } => {
                write!(f, "void balance: in `{system}`, {balance} ")?;
                match at_rest {
                    true => write!(
                        f,
                        "says nothing about what is at rest, since power vanishes with the speeds; start with a speed, \
                         or go by another system"
                    ),
                    false => write!(f, "contains no acceleration and no reaction in this state; go by another system"),
                }
            }
            Cause::NoBalances { system, phase } => write!(
                f,
                "no balances: `{system}` does not belong to the phase `{phase}`; go by Lagrange's equations, or write a \
                 system for this phase"
            ),
            Cause::SingularBalances { system, unknown } => write!(
                f,
                "singular balances: `{system}` does not determine {unknown} in this state, where its equations depend \
                 on each other; go by another system"
            ),
            Cause::StartMissesConstraint { constraint, residual } => write!(
                f,
                "inconsistent start: what the start holds misses the constraint `{constraint}` by {size:.3e}; hold \
                 fewer values, or others",
                size = residual.abs()
            ),
            Cause::Unreachable { constraint, residual, stationary } => {
                write!(
                    f,
                    "unreachable: the constraints cannot be met; `{constraint}` is still missed by {size:.3e}, ",
                    size = residual.abs()
                )?;
                match stationary {
                    true => write!(f, "and no change of what is not held comes nearer: lengths do not close"),
                    false => write!(f, "where the search from this guess ended; try another `guess`"),
                }
            }
            Cause::SingularConfiguration { sigma } => write!(
                f,
                "singular configuration: the constraints depend on each other here and not elsewhere (least singular \
                 value {sigma:.1e}), so that the motion may go on in several ways; start beside it; constraints by \
                 multipliers lead a motion through that does not stay"
            ),
            Cause::PhaseMisses { phase, constraint, residual } => write!(
                f,
                "the phase `{phase}` is entered where `{constraint}` does not hold: it is missed by {size:.3e}; let the \
                 event's function be zero where the constraint is",
                size = residual.abs()
            ),
            Cause::ImpactMisses { event, constraint, residual } => write!(
                f,
                "`{event}` strikes along `{constraint}`, which is not touched: it is missed by {size:.3e}; let the event \
                 happen where the constraint is zero, or name in `along` the one that is zero there",
                size = residual.abs()
            ),
            Cause::BadRestitution { value } => {
                write!(f, "a coefficient of restitution is {value}; it must be between 0 and 1")
            }
            Cause::ImpactsAccumulate { event, t } => write!(
                f,
                "impacts accumulate: those of `{event}` end at t = {t} s, and no phase has the present constraints and the \
                 one along which they are; add one for the resting contact",
                t = short(*t)
            ),
            Cause::ConstraintLost { constraint, residual } => write!(
                f,
                "constraint lost: the motion misses `{constraint}` by {size:.3e}, and no projection brings it back",
                size = residual.abs()
            ),
            Cause::PainleveInconsistent { constraint } => write!(
                f,
                "inconsistent friction: what `reaction({constraint})` makes of friction leaves no reaction that keeps the \
                 constraint, as where a rod jams against the ground (Painlevé); let the contact be lost, or less rough"
            ),
            Cause::UndecidedContacts { found } if found.is_empty() => write!(
                f,
                "undecided contacts: no combination of sticking, slipping and opening agrees with the forces here (at an impact with the impulses), as where \
                 a rod jams against the ground (Painlevé); let the contact be less rough"
            ),
            Cause::UndecidedContacts { found } => write!(
                f,
                "undecided contacts: {count} combinations of what contacts do agree with the forces here, or at an impact with the impulses ({list}), and none \
                 of them is the present one, as where a rod jams (Painlevé), or where several share what presses them in more than one way; let the contact be less \
                 rough, or fewer of them press",
                count = found.len(),
                list = found.join("; ")
            ),
            Cause::NegativeLimit { friction, limit, is_coefficient: false } => write!(
                f,
                "negative limit: that of `{friction}` is {limit}, and friction with a negative limit drives; a limit is a size: take `abs` or \
                 `max(0, …)` of what makes it, or, where it is made of a reaction that pushes to both sides, a contact for each side",
                limit = short(*limit)
            ),
            Cause::NegativeLimit { friction, limit, is_coefficient: true } => write!(
                f,
                "negative limit: the coefficient of friction of `{friction}` is {limit}, and friction with a negative one drives",
                limit = short(*limit)
            ),
            Cause::StaticBelowLimit { friction, sticking, sliding, is_coefficient } => write!(
                f,
                "static below limit: `{friction}` holds up to {sticking} where it sticks (`static`), and rubs with {sliding} where it slides \
                 (`{key}`), so that it would neither stick nor slide between them; let `static` be no smaller",
                sticking = short(*sticking),
                sliding = short(*sliding),
                key = if *is_coefficient { "friction" } else { "limit" }
            ),
            Cause::Penetrates { contact, gap } => write!(
                f,
                "the sides of `{contact}` pass through each other: its gap is {gap:.3e}; let it start open or closed, or run at a smaller \
                 tolerance"
            ),
            Cause::SimultaneousImpacts { contacts, sequential, together } => write!(
                f,
                "simultaneous impacts: {list} strike at once; one after the other the rates would be [{sequential}], all at once \
                 [{together}]; say which with `impacts: sequential`, `together` or `poisson`",
                list = quoted(contacts),
                sequential = numbers(sequential),
                together = numbers(together)
            ),
            Cause::EndlessImpacts { contacts } => write!(
                f,
                "endless impacts: those of {list} at this instant do not come to an end one after the other; take `impacts: together` or \
                 `poisson`",
                list = quoted(contacts)
            ),
            Cause::ImpactGainsEnergy { energy, by_poisson } => {
                let why = match by_poisson {
                    true => {
                        "which Poisson's law may do where coefficients of restitution differ; take one for all that strike together"
                    }
                    false => {
                        "which Newton's law may do with friction (Kane), or where coefficients differ; take `impacts: poisson`"
                    }
                };
                write!(f, "impact gains energy: {} J, {why}", short(*energy))
            }
            Cause::CoordinateSingularity { coordinate, t } => write!(
                f,
                "coordinate singularity: `{coordinate}` cannot describe the motion beyond t = {t} s, where its inertia \
                 grows without bound; choose another coordinate, such as an angle",
                t = short(*t)
            ),
            Cause::EndlessSets { event } => write!(
                f,
                "endless sets: `{event}` follows what is set at one instant (`on_set`) again and again; let it set nothing that brings it \
                 about again, or have an `if` that comes to an end"
            ),
            Cause::Chattering { switch, is_rate } => {
                write!(f, "chattering: both sides of `{switch}` = 0 push back to it; ")?;
                if *is_rate {
                    write!(
                        f,
                        "dry friction that sticks is `friction: {{rub: {{rate: {switch}, limit: F, …}}}}`; else "
                    )?;
                }
                f.write_str(
                    "describe what happens there as a phase with a constraint that keeps it 0 and events that lead in and out; where the file does \
                     so, or has a contact there, it is the method that cannot follow it: take one with error control, such as dop853",
                )
            }
            Cause::ChatteringStates { switch } => write!(
                f,
                "chattering: both sides of `{switch}` = 0 push back to it; let an event that comes near hold the states of first order there: it sets \
                 a held value to 0 (`memory`) by which their rates are multiplied"
            ),
            Cause::Sliding { switch } => write!(
                f,
                "sliding: both sides of `{switch}` = 0 push back to it, and the motion stays there, which dop853, dopri5, rk4, midpoint and \
                 euler know; where that is dry friction, `friction: {{rub: {{rate: …, limit: F, …}}}}` goes with all methods"
            ),
            Cause::DirectionLost { coordinate } => write!(
                f,
                "direction lost: the acceleration of `{coordinate}` jumps, as where a `unit` or `norm` vanishes; stop \
                 before it by an event, such as `norm(v) - crawl`"
            ),
            Cause::NegativeInertia { coordinate } => write!(
                f,
                "negative inertia: `{coordinate}` would move against the force; a mass or a moment of inertia is negative"
            ),
            Cause::Interrupted => write!(f, "interrupted"),
            Cause::GimbalLock { lock, t } => write!(f, "gimbal lock at t = {t} s: {lock}", t = short(*t)),
            Cause::InfiniteForce { input, t } => write!(
                f,
                "infinite force: `{input}` jumps at t = {t} s, and what it carries would have to follow at once; let it \
                 change within a time, or act through a spring",
                t = short(*t)
            ),
            Cause::WrongRate { input, t, rate, slope } => write!(
                f,
                "wrong rate: the function of the input `{input}` says u' = {rate} at t = {t} s, where its values change by {slope} a second; let it \
                 return [u, u', u'']",
                rate = short(*rate),
                t = short(*t),
                slope = short(*slope)
            ),
            Cause::EndsMeet { load, t } => write!(
                f,
                "direction lost: a distance, norm or root in `{load}` becomes zero at t = {t} s, where ends that meet have no direction, and \
                 roots no slope, even where there is no force; start where it is not zero, stop before it is by an event on it, or, where a power of \
                 `e` is to end there, write `max(0, e)^1.5`",
                t = short(*t)
            ),
            Cause::OscillatesTooFast { function, limit } => {
                write!(f, "`{function}` oscillates too fast: ")?;
                match limit {
                    TooFast::Samples(most) => {
                        write!(f, "more than {most} samples in one step do not tell its zeros apart")
                    }
                    TooFast::Inside => write!(f, "functions within it turn too often in one step to be followed"),
                    TooFast::InTime => {
                        write!(
                            f,
                            "it depends on time alone, and has more zeros in a millionth of the run than can be listed"
                        )
                    }
                }
            }
            Cause::UnsolvedContacts { contact, residual, rounds } if residual.is_finite() => write!(
                f,
                "unsolved contacts: after {rounds} rounds the impulses of a step still change, most that of `{contact}`, by {} of the largest; \
                 a shorter step has smaller impulses",
                short(*residual)
            ),
            Cause::UnsolvedContacts { contact, .. } => {
                write!(f, "unsolved contacts: constraints close the gap of `{contact}`, which no impulse can keep open")
            }
            Cause::ForceOfReaction { constraint } => write!(
                f,
                "force of a reaction: a force that is no friction is made of `reaction({constraint})`, which steps over contacts do not know \
                 beforehand; write it as `friction`, or take a method that locates events"
            ),
            Cause::NoSeries { reason } => write!(f, "there is no power series any more, since {reason}"),
            Cause::NeedsMoreSteps { step, needed, limit } => write!(
                f,
                "the tolerance wants steps of {} s, which are {} to the end, more than {limit}: give a looser tolerance or a method that \
                 chooses each step, or raise `max_steps` (`--max-steps`)",
                short(*step),
                short(*needed)
            ),
            Cause::TooManySteps { limit } => {
                write!(f, "more than {limit} steps; raise `max_steps` (`--max-steps`) to go on")
            }
        }
    }
}

fn quoted(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

/// The first numbers of a list.
fn numbers(list: &[f64]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = list.iter().take(SHOWN).map(|x| short(*x)).collect();
    let more = if list.len() > SHOWN { ", …" } else { "" };
    format!("{}{more}", shown.join(", "))
}
