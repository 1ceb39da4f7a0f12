//! What a mechanism says of itself: names, shapes and structure, without numbers.
//!
//! Generated code holds one `static` [`Description`]; the interpreter builds one at run time.

#[cfg(feature = "alloc")]
use alloc::{borrow::ToOwned, format, string::String, vec::Vec};

use super::{List, Table, Text};

/// The names, shapes and structure of a mechanism.
#[derive(Clone, Debug, Default)]
pub struct Description {
    /// The type's name, `DoublePendulum`.
    pub name: Text,
    /// The model file's own words.
    pub about: Text,
    /// FNV-1a (64 bit) of the model file's text; tells whether the file has changed since.
    pub source_hash: u64,
    /// Generalized coordinates, families expanded.
    pub coordinates: List<Coordinate>,
    /// Of each coordinate of kind `rotation` the place of its scalar part; the three of its vector part follow.  Nothing depends on its
    /// length.
    pub rotations: List<u32>,
    /// Free parameters, families expanded, in the order of `System::parameters`.
    pub parameters: List<Parameter>,
    /// Functions that the file gives by points, and those that count their points.
    pub tables: List<Table>,
    /// Integrals by rules of quadrature, and where these were tried.
    pub integrals: List<Integral>,
    /// Names of derived parameters (they cannot be set).
    pub derived: List<Text>,
    /// Inputs, functions of time.
    pub inputs: List<Text>,
    /// (row, column) of the structural non-zeros of M's lower triangle (row ≥ column), row by row.
    pub mass_pattern: List<(u32, u32)>,
    /// (row, column) of the structural non-zeros of ∂F/∂q.
    pub stiffness_pattern: List<(u32, u32)>,
    /// (row, column) of the structural non-zeros of ∂F/∂q'.
    pub damping_pattern: List<(u32, u32)>,
    /// (row, 3·input + order) of the structural non-zeros of ∂F/∂(u, u', u'').
    pub input_pattern: List<(u32, u32)>,
    /// Rows of F that depend on time by themselves (not by way of inputs), in the order of `System::time_jacobian`.
    pub time_pattern: List<u32>,
    /// Switches whose argument depends on time.
    pub timed_switches: List<u32>,
    /// Components of all constraints, in the order of `System::constraints`.
    pub rows: List<Row>,
    /// Phases, the initial one first; one without a name where the file has none.
    pub phases: List<Phase>,
    /// (row, coordinate) of the structural non-zeros of J, row by row.
    pub constraint_pattern: List<(u32, u32)>,
    /// (coordinate, row) of the structural non-zeros of B, what forces make of multipliers.
    pub friction_pattern: List<(u32, u32)>,
    /// (row, coordinate) of the structural non-zeros of ∂(J q'' + γ)/∂q.
    pub constraint_stiffness_pattern: List<(u32, u32)>,
    /// (row, coordinate) of the structural non-zeros of ∂(J q'' + γ)/∂q'.
    pub constraint_damping_pattern: List<(u32, u32)>,
    /// (row, coordinate) of the structural non-zeros of ∂c'/∂q.
    pub constraint_rate_pattern: List<(u32, u32)>,
    /// Outputs, in the order of `System::outputs`.
    pub outputs: List<Quantity>,
    /// True when some output needs accelerations.
    pub outputs_use_accelerations: bool,
    /// Outputs, by index, that contain named reactions: what balances say of them, which know the file's own loads only.
    pub outputs_of_reactions: List<u32>,
    /// True when some event needs accelerations or multipliers.
    pub events_use_accelerations: bool,
    /// Quantities that the file says are conserved, in the order of `System::invariants`.
    pub invariants: List<Quantity>,
    /// Events, in the order of `System::events`.
    pub events: List<Event>,
    /// Discontinuities of the equations of motion and of inputs, in the order of `System::switches`.
    pub switches: List<Switch>,
    /// Arguments of local functions inside events, switches and the equations of motion, in the order of
    /// `System::arguments`.
    pub arguments: List<Argument>,
    /// What a jump of each input does to the motion.
    pub input_jumps: List<InputJump>,
    /// Names of the scenes; the first is the default, called `scene` in the file.
    pub scenes: List<Text>,
    /// What to draw; points of all shapes come from `System::drawing`.
    pub draw: List<Shape>,
    /// Gravity's acceleration at the defaults of the parameters; zero where there is none or it is not known before a run.
    pub gravity: [f64; 3],
    /// Systems of momentum balances, each of which gives the accelerations too.
    pub balances: List<BalanceSystem>,
    /// What the deriver recognised.
    pub structure: Structure,
    /// Decoupled subsystems and are computed by themselves; none where runs cannot take them apart.
    pub parts: List<Part>,
    /// Operations of the generated functions.
    pub counts: Counts,
}

/// A generalized coordinate.
///
/// A state of first order z is kept as the speed of a hidden coordinate ∫z dt, on which nothing depends: it is called `∫z`, and has the
/// unit of the state.  Such coordinates come after all others, and are in no table, norm, digit or freedom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coordinate {
    /// `theta[3]`.
    pub name: Text,
    /// The unit of its numbers, SI: the file's without prefixes (`mm` is `m`); empty when none is given.
    pub unit: Text,
}

/// What the name of the hidden coordinate of a state begins with, which no name of a file does.
pub const HIDDEN: char = '∫';

/// The name of a coordinate's rate: `theta'`; of the hidden coordinate of a state that of the state.
#[cfg(feature = "alloc")]
pub fn rate_name(coordinate: &str) -> String {
    coordinate.strip_prefix(HIDDEN).map_or_else(|| format!("{coordinate}'"), str::to_owned)
}

impl Coordinate {
    /// The state of first order whose hidden coordinate this is; `None` for a coordinate of the file.
    pub fn state(&self) -> Option<&str> {
        self.name.strip_prefix(HIDDEN)
    }
}

/// Three angles that turn a frame one after the other.
///
/// The product of their axes e₁·(e₂ × e₃), at the parameters' defaults, is `amplitude` · sin(`factor` q₂ + `phase`).  Where it is 0 the
/// outer two turn about one axis, and some rates of the angles do not turn the frame: gimbal lock.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gimbal {
    /// The frame that the last of them turns.
    pub frame: Text,
    /// Indices of the coordinates, in order.
    pub coordinates: [u32; 3],
    /// The largest product, 1 for axes at right angles.
    pub amplitude: f64,
    /// What the middle coordinate is multiplied by.
    pub factor: f64,
    /// What is added, rad.
    pub phase: f64,
}

/// A component of a constraint.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// `rod`, or `pin.x` for a component of a vector.
    pub name: Text,
    /// Its unit in SI; empty where it is a pure number or not known.
    pub unit: Text,
    /// Whether it contains no speeds.
    pub holonomic: bool,
    /// Whether it contains speeds and is, by itself or together with `with`, the rate of a known function of time and
    /// coordinates, which is then its c.
    pub integral: bool,
    /// The rows, with factors, that make the integral's rate together with this one.  They have no integrals, and act where
    /// this one does.
    pub with: List<(u32, f64)>,
    /// The place of its constraint.
    pub constraint: u32,
}

/// A phase: which constraints act.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Phase {
    /// Its name; empty where the file has no phases.
    pub name: Text,
    /// Its rows, in order.
    pub rows: List<u32>,
    /// How many of them are independent in general.
    pub rank: u32,
}

/// A free parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parameter {
    /// `m[2]`.
    pub name: Text,
    /// The unit of its numbers, SI: the file's without prefixes (`N/mm` is `N/m`); empty when none is given.
    pub unit: Text,
    /// The file's value, in SI.
    pub default: f64,
}

/// An integral by a rule of quadrature that was found to be right for some values of what it contains.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integral {
    /// As written.
    pub text: Text,
    /// What it contains, and between which values that was tried, SI.
    pub ranges: List<(Tried, [f64; 2])>,
}

/// What an integral contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tried {
    /// A free parameter, by its index.
    Parameter(u32),
    /// A coordinate, by its index.
    Coordinate(u32),
    /// The rate of a coordinate.
    Speed(u32),
    /// Time.
    Time,
}

/// A named scalar or vector computed along a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quantity {
    /// `tip`.
    pub name: Text,
    /// 1 for a scalar, 2 or 3 for a vector, 4 for a quaternion.
    pub components: u32,
    /// Its unit in SI; empty where it is a pure number or not known.
    pub unit: Text,
}

impl Quantity {
    /// What its components are called after a point: `x`, `y`, `z` of a vector, `w` before these of a quaternion; nothing of a scalar.
    pub fn axes(&self) -> &'static [&'static str] {
        match self.components {
            0 | 1 => &[],
            2 => &["x", "y"],
            3 => &["x", "y", "z"],
            _ => &["w", "x", "y", "z"],
        }
    }
}

/// Something that happens when a function crosses zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Its label in the file.
    pub name: Text,
    /// Which crossings count.
    pub direction: Direction,
    /// True when an `if` guards it.
    pub conditional: bool,
    /// The phases in which it counts; `None`: every.
    pub phases: Option<List<u32>>,
    /// What happens, in order.
    pub actions: List<Action>,
    /// What `System::event_rates` knows of the rate of its function.
    pub rated: Rated,
}

impl Event {
    /// Whether it enters a phase, strikes, or decides anew what contacts do.
    pub fn changes_motion(&self) -> bool {
        let changes = |action: &Action| matches!(action, Action::Phase(_) | Action::Impact { .. } | Action::Contact(_));
        self.actions.iter().any(changes)
    }
}

/// What is known of the rate of an event's function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Rated {
    /// All of it.
    Whole,
    /// Its part with accelerations and multipliers held; `System::motion_rates` gives what is missing.
    Held,
    /// Nothing.
    #[default]
    Unknown,
}

/// Which crossings of zero count.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
    /// Either.
    #[default]
    Both,
}

/// What an event does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// Ends the run.
    Stop,
    /// Notes time and state.
    Record,
    /// Goes on in this phase.
    Phase(u32),
    /// An impulse along a constraint that is not active.
    Impact {
        /// The constraint's place.
        along: u32,
        /// The place of the coefficient of restitution in `System::restitutions`.
        restitution: u32,
    },
    /// Sets held values, or states of first order: the place among [`Sampling::sets`](super::Sampling::sets).
    Set(u32),
    /// Decides anew what all contacts do: the place of the one that changes among [`Contacts::all`](super::Contacts::all).
    Contact(u32),
}

/// A discontinuity of the equations of motion: `sign`, `abs`, `step`, `min` or `max` of something.
#[derive(Clone, Debug, PartialEq)]
pub struct Switch {
    /// Its argument, as text for messages.
    pub text: Text,
    /// Which values its mode takes.
    pub kind: SwitchKind,
    /// True when its argument depends on time and inputs alone: its zeros are stop times.
    pub time_only: bool,
    /// True when it belongs to inputs: it stands in the function of one, or its argument contains one.
    pub of_input: bool,
}

/// An argument A of a function inside something that a run watches.  The function is local, or turns, only through its
/// argument, which is tame, so that nothing goes unseen if A is followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Inside what.
    pub of: Watched,
    /// How it makes that local.
    pub role: Role,
    /// True when it depends on time alone.
    pub time_only: bool,
    /// The spring, damper or force whose direction it tells, the table whose points it counts; else empty.
    pub load: Text,
    /// Parameters, by their places, that multiply all that it does to the equations of motion: where one of them is 0, as the
    /// stiffness of a spring that is left out, it does nothing.
    pub gates: List<u32>,
}

impl Argument {
    /// Whether the equations of motion depend on it with these parameters.
    pub fn is_in_force(&self, parameters: &[f64]) -> bool {
        !self.gates.iter().any(|gate| parameters.get(*gate as usize) == Some(&0.0))
    }
}

/// What a run watches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Watched {
    /// An event's function, by its index.
    Event(u32),
    /// A switch's argument, by its index.
    Switch(u32),
    /// The equations of motion, inputs included.
    Motion,
    /// Another argument, by its index.
    Argument(u32),
}

/// How an argument A makes a function local.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// sin A, cos A, tan A.
    Phase,
    /// Something happens where A vanishes or turns: `abs A`, `exp A`, … inside of what is watched.
    Landmark,
    /// exp A.
    Exponential,
    /// tanh A, sinh A, cosh A.
    Bounded,
    /// atan A.
    Arctangent,
    /// The points of a table that A has passed.
    Points,
    /// A squared distance: a force acts along the line, which has no direction where A vanishes.
    Distance,
    /// A to this power, negative or no integer; ln A counts as the first.
    Power(f64),
}

/// What a jump of an input's value does to the motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputJump {
    /// Forces jump, the motion goes on.
    Force,
    /// The speeds jump: a damper is driven by it.
    Speed,
    /// It would need an infinite force, or what it does depends on how it jumps.
    Refused,
}

/// Which values the mode of a [`Switch`] takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchKind {
    /// −1 or 1 (0 exactly on a surface that the motion does not leave): `sign` and `abs`.
    Sign,
    /// 0 or 1 (1 on the surface): `step`, `min` and `max`.
    Step,
}

/// One thing to draw; those from [`Shape::Ring`] on are in space.  Numbers are consumed from `System::drawing` in order.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A polyline through this many points.
    Line(u32),
    /// A circle: a centre, then one number, the radius.
    Circle,
    /// A zigzag between two points.
    Spring,
    /// A curve sampled at this many points.
    Curve(u32),
    /// The path that one point leaves behind.
    Trace(Text),
    /// A circle in space: its centre, and a vector along its axis that is as long as its radius.
    Ring,
    /// The same, filled.
    Disc,
    /// A cylinder: the centres of its ends, its radius.
    Cylinder,
    /// A sphere: its centre, its radius.
    Sphere,
    /// A box: its centre, half of each of three edges.
    Box,
    /// An ellipsoid: its centre, its three half axes.
    Ellipsoid,
    /// A square in a plane: its centre, and a vector along its normal that is as long as its edges.
    Plane,
    /// Three axes, x, y and z: where they begin, and each as long as it is drawn.
    Axes,
    /// Three axes: where they begin, and the unit vector along each; a picture gives them a quarter of its reach.
    UnitAxes,
}

/// A system of momentum balances A·[q''; reactions] = b.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BalanceSystem {
    /// Its name in the file; `balances` where the file has only one and gives it none.
    pub name: Text,
    /// The phases to which it belongs.
    pub phases: List<u32>,
    /// Its unknowns: accelerations, `theta''`, then components of reactions, `hinge.x`.
    pub unknowns: List<Text>,
    /// Its equations, as many as unknowns.
    pub equations: List<Balance>,
    /// How many entries of A are not structurally zero.
    pub nonzeros: u32,
    /// Operations of A and b.
    pub operations: u32,
    /// Output components that are an unknown as it stands: (index among all components of outputs, unknown).
    pub outputs: List<(u32, u32)>,
}

/// One equation of a system of balances.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// The label and the kind of the balance it belongs to: `balance 1 (moment)`.
    pub name: Text,
    /// True for power and energy, which say nothing about the acceleration of what is at rest.
    pub void_at_rest: bool,
}

/// What the deriver recognised.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Structure {
    /// 2 or 3: components of points and vectors.
    pub dimension: u32,
    /// M does not depend on the state: factored once.
    pub constant_mass: bool,
    /// The diagonal of M does not depend on the state.
    pub constant_inertias: bool,
    /// M is diagonal: divided by.
    pub diagonal_mass: bool,
    /// Sizes of the diagonal blocks of M, when there is more than one.
    pub mass_blocks: List<u32>,
    /// M is constant, and h depends on no speed, not by way of a discontinuity either: kicks and drifts can be done in turn.
    pub separable: bool,
    /// The equations of motion are linear with constant coefficients; time may drive them, and switch what drives them.
    pub linear: bool,
    /// No force lacks a potential and no explicit time: the energy balance needs no work.
    pub conservative: bool,
    /// The equations of motion depend on time explicitly.
    pub time_dependent: bool,
    /// M is constant, and so are all accelerations between discontinuities, in every phase: constraints have constant coefficients, and
    /// none moves but uniformly.
    pub uniformly_accelerated: bool,
    /// Indices of cyclic (ignorable) coordinates, whose momenta are conserved.
    pub cyclic: List<u32>,
}

/// A part of a mechanism whose equations of motion contain nothing of the others.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Indices of its coordinates.
    pub coordinates: List<u32>,
    /// Its equations of motion are linear with constant coefficients.
    pub linear: bool,
    /// Its part of M is constant, and its forces depend on no speed.
    pub separable: bool,
    /// Its equations depend on time explicitly.
    pub time_dependent: bool,
    /// No force on it lacks a potential and no explicit time.
    pub conservative: bool,
    /// Indices of the arguments that a run of it follows.
    pub arguments: List<u32>,
    /// Indices of the events that read it alone.
    pub events: List<u32>,
    /// Operations of its accelerations.
    pub accelerations: u32,
}

/// Operations (additions, multiplications, divisions, roots and functions) of the generated functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Mass matrix M.
    pub mass: u32,
    /// Bias forces h.
    pub bias: u32,
    /// M and h together.
    pub mass_and_bias: u32,
    /// Accelerations, with the functions of time that stand for the inputs that they read.
    pub accelerations: u32,
    /// Residual F.
    pub residual: u32,
    /// F with ∂F/∂q and ∂F/∂q'.
    pub jacobians: u32,
}

impl Description {
    /// The name of a coordinate, for messages.
    #[cfg(feature = "alloc")]
    pub fn coordinate_name(&self, index: usize) -> String {
        let name = |c: &Coordinate| c.state().unwrap_or(&c.name).to_owned();
        self.coordinates.get(index).map_or_else(|| format!("coordinate {index}"), name)
    }

    /// How many coordinates the file declares; those of its states of first order follow.
    pub fn mechanical(&self) -> usize {
        self.coordinates.iter().take_while(|coordinate| coordinate.state().is_none()).count()
    }

    /// Whether there are states of first order.
    pub fn has_states(&self) -> bool {
        self.coordinates.iter().any(|coordinate| coordinate.state().is_some())
    }

    /// The place of a coordinate, a rate (`theta'`) or a state of first order in [q; q'].
    pub fn place_of(&self, name: &str) -> Option<usize> {
        let n = self.coordinates.len();
        let position = |name: &str| self.coordinates.iter().position(|coordinate| *coordinate.name == *name);
        let of_state = || self.coordinates.iter().position(|coordinate| coordinate.state() == Some(name));
        match name.strip_suffix('\'') {
            Some(coordinate) => {
                Some(n + position(coordinate).filter(|place| self.coordinates[*place].state().is_none())?)
            }
            None if name.starts_with(HIDDEN) => None,
            None => position(name).or_else(|| Some(n + of_state()?)),
        }
    }

    /// Names of coordinates and of states of first order.
    #[cfg(feature = "alloc")]
    pub fn start_names(&self) -> Vec<String> {
        self.coordinates.iter().map(|c| c.state().unwrap_or(&c.name).to_owned()).collect()
    }

    /// How many numbers `System::outputs` writes.
    pub fn output_len(&self) -> usize {
        self.outputs.iter().map(|o| o.components as usize).sum()
    }

    /// How many components the invariants have together.
    pub fn invariant_len(&self) -> usize {
        self.invariants.iter().map(|o| o.components as usize).sum()
    }

    /// How many numbers `System::drawing` writes.
    pub fn drawing_len(&self) -> usize {
        self.draw.iter().map(|shape| shape.numbers(self.structure.dimension as usize)).sum()
    }
}

impl Shape {
    /// How many numbers `System::drawing` writes for this shape in so many dimensions.
    pub fn numbers(&self, dimension: usize) -> usize {
        match self {
            Shape::Line(n) | Shape::Curve(n) => dimension * *n as usize,
            Shape::Circle => dimension + 1,
            Shape::Spring => 2 * dimension,
            Shape::Trace(_) => dimension,
            Shape::Ring | Shape::Disc | Shape::Plane => 6,
            Shape::Cylinder => 7,
            Shape::Sphere => 4,
            Shape::Box | Shape::Ellipsoid | Shape::Axes | Shape::UnitAxes => 12,
        }
    }
}
