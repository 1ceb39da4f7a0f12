//! What can go wrong with small motions.

use std::fmt;

use crate::cause::{Cause, GimbalLock};
use crate::numbers::short;

/// A generalized force that is left where there should be none.
#[derive(Clone, Debug, PartialEq)]
pub struct Residual {
    /// The coordinate.
    pub coordinate: String,
    /// F(q, q', 0), SI.
    pub force: f64,
    /// Its unit: `N` for a length, `N m` for an angle.
    pub unit: String,
}

/// Why there is no equilibrium, no linearisation or no mode.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LinearError {
    /// The point is no equilibrium: forces are left.
    NotAnEquilibrium {
        /// What is left for every coordinate.
        residual: Vec<Residual>,
    },
    /// Newton's method found no equilibrium.
    NoEquilibrium {
        /// Iterations made.
        iterations: usize,
        /// (coordinate, value) where it stood at the end.
        point: Vec<(String, f64)>,
        /// What is left there for every coordinate.
        residual: Vec<Residual>,
    },
    /// The mechanism has constraints, or coordinates of kind `rotation`: it is linearised in independent coordinates, by `linearise_constrained`.
    HasConstraints,
    /// A guess that moves, of a mechanism with states of first order or held values and with constraints or rotations: only its rests are known.
    SteadyWithStates,
    /// The mechanism has states of first order: M, C and K do not hold them, `linearise_states` does.
    HasStates,
    /// Nothing happens at ticks, so that no loop is sampled.
    NotSampled,
    /// It takes more ticks than can be followed until all clocks come together again, if they do.
    TooManyTicks {
        /// So many would be.
        most: usize,
    },
    /// A constraint contains speeds, so that no coordinates are independent.
    VelocityConstraint {
        /// The constraint.
        constraint: String,
    },
    /// A constraint gives speeds that follow an input, not its rate: places follow the input's integral.
    MovedBySpeed {
        /// The constraint.
        constraint: String,
        /// The input.
        input: String,
    },
    /// An input would move constraints that depend on each other in ways that contradict each other.
    MovesContradict {
        /// A constraint that is not met.
        constraint: String,
        /// The input.
        input: String,
    },
    /// Constraints depend on each other here, but not beside this place, or not when inputs move: their slopes do not tell
    /// what motions they allow.
    DependentHere {
        /// One of them.
        constraint: String,
    },
    /// A reaction that is not unique: several constraints say the same, and share the load in any way.
    ReactionNotUnique {
        /// The output that contains it.
        answer: String,
    },
    /// Forces are made of reactions, as friction is: what the constraints carry is no part of M, C and K.
    FrictionOfReactions,
    /// Forces jump here, as dry friction does at rest: the equilibria are a whole set, and there is no linear model.
    Discontinuous {
        /// (coordinate, value) of the point.
        point: Vec<(String, f64)>,
        /// What jumps, `x'` of `sign(x')`.
        switch: String,
        /// How far the force on each coordinate that is concerned may go to either side.
        jump: Vec<Residual>,
    },
    /// Forces are continuous here, but their derivatives are not: a contact that just touches.
    NotSmooth {
        /// The argument of the switch that lies at zero.
        switch: String,
    },
    /// An equilibrium at a point of a table where its slope is another on each side: there are two linear models.
    AtTablePoint {
        /// What departs from side to side: a coordinate, a rate or a state.
        along: String,
    },
    /// What a tick sets jumps or turns sharply at the rest of a sampled loop.
    LawNotSmooth {
        /// What is set.
        held: String,
    },
    /// An event of a tick happens only where a held value says so that ticks set: the loop is not the same at every cycle of its clocks.
    Counted {
        /// The event.
        event: String,
        /// The held value.
        held: String,
    },
    /// A speed was asked for in a coordinate whose value matters: the state cannot persist.
    NotSteady {
        /// The coordinate.
        coordinate: String,
    },
    /// Speeds that are kept in a steady motion do not go with each other, or with a constraint.
    SpeedsContradict {
        /// A coordinate whose speed is kept.
        coordinate: String,
        /// A constraint that these speeds do not meet; `None` where coordinates go on together only.
        constraint: Option<String>,
    },
    /// A constraint moves with time by itself, so that the coordinates that it leaves do not know where they are.
    MovingConstraint {
        /// The constraint.
        constraint: String,
    },
    /// The equations change with time, beyond the inputs.
    DependsOnTime {
        /// A coordinate whose equation changes, or a constraint that does.
        coordinate: String,
    },
    /// A rest that stays where it is, but beside it the equations change with time.
    VariesWithTime {
        /// A coordinate whose equation changes, a constraint, or what a tick sets.
        coordinate: String,
    },
    /// A contact slides in space: what the direction of friction does to small departures depends on how fast it slides, and at rest it has none.
    SlidesInSpace {
        /// Its name.
        contact: String,
    },
    /// Friction slips at a rest, where it has no direction: any state near by that it can hold is an equilibrium too.
    SlipsAtRest {
        /// The name of the contact or friction.
        contact: String,
    },
    /// M is not positive definite.
    SingularMass {
        /// The coordinate whose pivot is not positive.
        coordinate: String,
    },
    /// There are no accelerations at an instant of a motion.
    NoAccelerations(Box<Cause>),
    /// An input moves a constraint, so that it changes places and not forces alone.
    MovedByInput {
        /// The constraint.
        constraint: String,
        /// The input.
        input: String,
    },
    /// What acts is no input of the model.
    NotAnInput {
        /// Its name.
        drive: String,
    },
    /// M is singular, because three angles cannot turn a frame in every direction here.
    GimbalLock(GimbalLock),
    /// A list or matrix has the wrong size.
    WrongSize {
        /// Which one.
        what: &'static str,
        /// Its size.
        given: usize,
        /// What it must be.
        expected: usize,
    },
    /// A number is infinite or not a number.
    NonFinite {
        /// Of what.
        what: String,
    },
    /// A matrix that must be symmetric is not.
    NotSymmetric {
        /// Which one: `M`.
        what: &'static str,
    },
    /// An iteration of linear algebra did not end.
    NoConvergence {
        /// Which one.
        what: &'static str,
    },
    /// The frequency response is infinite here.
    Resonance {
        /// The forcing frequency Ω, rad/s.
        omega: f64,
    },
    /// No coordinate, rate or output has this name.
    UnknownAnswer {
        /// The name.
        name: String,
        /// All that there are.
        known: Vec<String>,
    },
    /// An output has no derivative here: a kink, a jump, a zero under a root.
    NoSlope {
        /// The output.
        answer: String,
    },
    /// An output, or how it depends on the state, changes with time or along the steady motion.
    AnswerVaries {
        /// The output.
        answer: String,
    },
    /// A reaction depends on where a force acts, which a generalized force on a coordinate does not say.
    ReactionToForce {
        /// The output that contains it.
        answer: String,
    },
    /// No values of what is sought were found with which the mechanism rests with these held.
    CannotHold {
        /// What is held in the way: forces are left that it would ease by moving.
        holds: Vec<String>,
        /// What is sought.
        unknowns: Vec<String>,
        /// (coordinate or unknown, value) where the search stood at the end.
        point: Vec<(String, f64)>,
        /// What is left there of forces and constraints.
        residual: Vec<Residual>,
    },
    /// Values that are sought are not determined: they can change, alone or together, and it still rests.
    Undetermined {
        /// Which.
        unknowns: Vec<String>,
        /// Coordinates and states that are not held, and would move along.
        along: Vec<String>,
    },
    /// A drive whose parts have phases is no input: x' = A x + B u knows no frequency that would make times of them.
    OutOfPhase {
        /// The drive.
        drive: String,
    },
    /// The crate was built without what this needs.
    NeedsFeature {
        /// The feature of the crate.
        feature: &'static str,
    },
}

impl LinearError {
    /// What is known where no rest was found: that the equations change with time.
    pub(crate) fn without_rest(self) -> LinearError {
        match self {
            LinearError::VariesWithTime { coordinate } => LinearError::DependsOnTime { coordinate },
            other => other,
        }
    }

    /// Whether time is the reason.
    pub(crate) fn is_of_time(&self) -> bool {
        matches!(self, LinearError::DependsOnTime { .. } | LinearError::VariesWithTime { .. })
    }
}

impl fmt::Display for LinearError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LinearError::NotAnEquilibrium { residual } => {
                write!(f, "no equilibrium: the residual force is {}", Forces(residual))
            }
            LinearError::NoEquilibrium { iterations, point, residual } => write!(
                f,
                "no equilibrium found in {iterations} iteration{}: at {} the residual force is {}",
                if *iterations == 1 { "" } else { "s" },
                Pairs(point),
                Forces(residual)
            ),
            LinearError::NotSampled => f.write_str("no event happens `every` so often, so that no loop is sampled"),
            LinearError::TooManyTicks { most } => write!(
                f,
                "it takes more than {most} ticks until all clocks come together again, if they ever do; give periods whose quotients are those of small whole numbers"
            ),
            LinearError::HasStates => f.write_str(
                "the mechanism has states of first order, which M, C and K do not hold: `modes` prints A, and `linearise_states` gives it",
            ),
            LinearError::HasConstraints => f.write_str(
                "the mechanism has constraints or rotations: linearise it in independent coordinates (`linearise_constrained`)",
            ),
            LinearError::SteadyWithStates => f.write_str(
                "steady motions of what has both states of first order or held values and constraints or rotations are not known, only its rests: \
                 leave the speeds out (`--steady`), or write the mechanism in independent coordinates",
            ),
            LinearError::VelocityConstraint { constraint } => write!(
                f,
                "the constraint `{constraint}` contains speeds, without a known integral: there are no independent coordinates to \
                 write M, C and K in; where it can be integrated, write it without speeds"
            ),
            LinearError::MovedBySpeed { constraint, input } => write!(
                f,
                "the constraint `{constraint}` gives speeds by `{input}`, so that places follow its integral, and there is no \
                 rest to move about; let the input be the place of what moves, and write its rate `{input}'` in the constraint"
            ),
            LinearError::MovesContradict { constraint, input } => write!(
                f,
                "`{input}` cannot move: the constraint `{constraint}` and others, which depend on each other, want different \
                 motions of it"
            ),
            LinearError::DependentHere { constraint } => write!(
                f,
                "`{constraint}` and other constraints depend on each other here, but not near by: their slopes do not tell what \
                 small motions they allow; leave out those that are not needed, or move inputs of all of them together"
            ),
            LinearError::ReactionNotUnique { answer } => write!(
                f,
                "`{answer}` contains a reaction that is not unique: several constraints say the same and share the load in any \
                 way; leave out those that are not needed, or ask for the sum that they carry"
            ),
            LinearError::FrictionOfReactions => write!(
                f,
                "forces are made of reactions, which M, C and K in independent coordinates leave out; look at departures \
                 from the steady state instead (`linearise_tangent`)"
            ),
            LinearError::Discontinuous { point, switch, jump } => write!(
                f,
                "at {} the system is held by dry friction, which jumps with the sign of `{switch}`: the force may be \
                 up to {} to either side, so every state near by that it can hold is an equilibrium too, and there is \
                 no linear model",
                Pairs(point),
                Forces(jump)
            ),
            LinearError::NotSmooth { switch } => write!(
                f,
                "the equilibrium lies where `{switch}` changes sign and with it the stiffness or the damping: there is \
                 no linear model"
            ),
            LinearError::AtTablePoint { along } => write!(
                f,
                "the equilibrium is at a point of a table, and the stiffness or the damping along `{along}` is another on each side: there is \
                 no linear model; `smooth: 1` or `2` has one slope at each point, or move the point"
            ),
            LinearError::LawNotSmooth { held } => write!(
                f,
                "what sets `{held}` jumps or turns sharply at the rest, as a relay does: the loop has no linear model there, \
                 and only a run tells where it goes"
            ),
            LinearError::Counted { event, held } => write!(
                f,
                "`{event}` acts only where `{held}` says so, which ticks set: the loop is not the same at every cycle of its \
                 clocks; give `{event}` a clock of its own, with the time after which it acts again"
            ),
            LinearError::NotSteady { coordinate } => write!(
                f,
                "not a steady motion: `{coordinate}` has a speed, but the equations depend on its value; only cyclic \
                 coordinates can turn or travel steadily"
            ),
            LinearError::SpeedsContradict { coordinate, constraint: Some(constraint) } => write!(
                f,
                "not a steady motion: the constraint `{constraint}` does not allow the speeds that are kept, `{coordinate}'` among \
                 them; give speeds that meet it, or 0 to those that are to follow"
            ),
            LinearError::SpeedsContradict { coordinate, constraint: None } => write!(
                f,
                "not a steady motion: `{coordinate}` goes on only together with other coordinates, and the speeds that are kept \
                 do not fit each other; give them so that they do, or 0 to those that are to follow"
            ),
            LinearError::MovingConstraint { constraint } => write!(
                f,
                "the constraint `{constraint}` moves with time by itself, so that M, C and K in independent coordinates do not \
                 follow it; leave it out, and keep the speed that it gives"
            ),
            LinearError::DependsOnTime { coordinate } => write!(
                f,
                "the equation of `{coordinate}` depends on time, so it has no equilibrium; a force that varies may be an input, \
                 but where a mass or stiffness varies (Mathieu) only a run tells whether motions grow"
            ),
            LinearError::VariesWithTime { coordinate } => write!(
                f,
                "there is a rest, but beside it the equation of `{coordinate}` depends on time, as with a stiffness that changes: eigenvalues \
                 at one time do not tell whether motions grow (Mathieu), only a run does; make what changes an input to hold it, or see A as \
                 it is at one time by `--at-time`, of a scene that starts at the rest"
            ),
            LinearError::SlidesInSpace { contact } => write!(
                f,
                "`{contact}` slides in space, where friction follows the direction of sliding: there is no linear model yet; another phase, \
                 `{contact} sticks` or `{contact} open`, may have one"
            ),
            LinearError::SlipsAtRest { contact } => write!(
                f,
                "`{contact}` slips in this phase, but nothing moves there: friction would hold it, so every state near by that it can hold is \
                 an equilibrium too, and there is no linear model; another phase, `{contact} sticks`, has one, and so has a steady motion in \
                 which it slips"
            ),
            LinearError::SingularMass { coordinate } => {
                write!(f, "the mass matrix is not positive definite: nothing gives `{coordinate}` an inertia here")
            }
            LinearError::NoAccelerations(cause) => cause.fmt(f),
            LinearError::MovedByInput { constraint, input } => write!(
                f,
                "`{input}` moves the constraint `{constraint}`: along a motion only inputs of forces are linearised; leave it out of --in"
            ),
            LinearError::NotAnInput { drive } => {
                write!(f, "`{drive}` is no input of the model; along a motion B is by `inputs` alone")
            }
            LinearError::GimbalLock(lock) => write!(f, "gimbal lock: {lock}"),
            LinearError::WrongSize { what, given, expected } => {
                write!(f, "{what} has size {given}; expected {expected}")
            }
            LinearError::NonFinite { what } => write!(f, "{what} is not finite"),
            LinearError::NotSymmetric { what } => write!(f, "{what} is not symmetric"),
            LinearError::NoConvergence { what } => write!(f, "{what} does not converge"),
            LinearError::Resonance { omega } => {
                let omega = short(*omega);
                write!(f, "no steady state: the force at {omega} rad/s meets an undamped mode, which grows with time")
            }
            LinearError::UnknownAnswer { name, known } => {
                write!(f, "no coordinate, rate or output is called `{name}`; there are {}", known.join(", "))
            }
            LinearError::NoSlope { answer } => {
                write!(f, "`{answer}` has no derivative at the equilibrium, so that no small motion of it is known")
            }
            LinearError::AnswerVaries { answer } => {
                write!(
                    f,
                    "`{answer}` changes with time, or along the steady motion, whatever drives: it has no amplitude"
                )
            }
            LinearError::ReactionToForce { answer } => write!(
                f,
                "`{answer}` is a reaction, which depends on where a force acts; a generalized force does not say where: \
                 put an input into a force of the file, and drive by that"
            ),
            LinearError::CannotHold { holds, unknowns, point, residual } => write!(
                f,
                "no {} found with which it rests with {} held: at {} there is left {}; let {} free, solve for something else, or \
                 let the search begin elsewhere",
                value_of(unknowns),
                Names(holds, "and"),
                Pairs(point),
                Forces(residual),
                Names(holds, "or"),
            ),
            LinearError::Undetermined { unknowns, along } if along.is_empty() && unknowns.len() == 1 => write!(
                f,
                "{} changes nothing where it rests, so that no value of it is found; solve for something else",
                Names(unknowns, "and")
            ),
            LinearError::Undetermined { unknowns, along } if along.is_empty() => write!(
                f,
                "{} cannot be told apart: they can change together and it rests all the same; solve for one fewer",
                Names(unknowns, "and")
            ),
            LinearError::Undetermined { unknowns, along } => write!(
                f,
                "{} not determined: it rests all the same where {} along with {}; hold {} too, or solve for one fewer",
                if unknowns.len() == 1 { format!("{} is", Names(unknowns, "and")) } else { format!("{} are", Names(unknowns, "and")) },
                if along.len() == 1 { format!("{} moves", Names(along, "and")) } else { format!("{} move", Names(along, "and")) },
                if unknowns.len() == 1 { "it" } else { "them" },
                Names(along, "or"),
            ),
            LinearError::OutOfPhase { drive } => write!(
                f,
                "`{drive}` acts with phases, which belong to one frequency: x' = A x + B u takes what acts in phase; give each part as an \
                 input of its own"
            ),
            LinearError::NeedsFeature { feature } => {
                write!(f, "damped and gyroscopic modes need the feature `{feature}` of the crate `dalembert`")
            }
        }
    }
}

impl std::error::Error for LinearError {}

/// `value of `k``, `values of `T1` and `T2``.
fn value_of(unknowns: &[String]) -> String {
    format!(
        "value{} of {} {}",
        if unknowns.len() == 1 { "" } else { "s" },
        Names(unknowns, "and"),
        if unknowns.len() == 1 { "was" } else { "were" }
    )
}

/// `` `a`, `b` and `c` ``.
struct Names<'a>(&'a [String], &'a str);

impl fmt::Display for Names<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, name) in self.0.iter().enumerate() {
            match index {
                0 => write!(f, "`{name}`")?,
                index if index + 1 == self.0.len() => write!(f, " {} `{name}`", self.1)?,
                _ => write!(f, ", `{name}`")?,
            }
        }
        Ok(())
    }
}

struct Pairs<'a>(&'a [(String, f64)]);

impl fmt::Display for Pairs<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, value)) in self.0.iter().enumerate() {
            write!(f, "{}{name} = {}", if index == 0 { "" } else { ", " }, short(*value))?;
        }
        Ok(())
    }
}

struct Forces<'a>(&'a [Residual]);

impl fmt::Display for Forces<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, Residual { coordinate, force, unit }) in self.0.iter().enumerate() {
            let (comma, space) = (if index == 0 { "" } else { ", " }, if unit.is_empty() { "" } else { " " });
            // Twelve digits; what comes after them is rounding.
            let force: f64 = format!("{force:.11e}").parse().unwrap_or(*force);
            let usual = force == 0.0 || (1e-4..1e7).contains(&force.abs());
            let force = if usual { force.to_string() } else { format!("{force:e}") };
            write!(f, "{comma}{coordinate}: {force}{space}{unit}")?;
        }
        Ok(())
    }
}
