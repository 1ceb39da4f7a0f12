//! A model with every name resolved and every family expanded: expressions of one graph.

use std::ops::Range;

use super::contact::{Contact, ImpactLaw, are_single};
use super::event::{Clock, Event, HeldValue, Noise, Set};
use super::expression::dimension::Measure;
use super::expression::scope::Scope;
use super::gimbals::Gimbal;
use super::motion::Motion;
use super::rotation::Rotation;
use super::ways::Ways;
use crate::diagnose::{Place, Problem};
use crate::expr::{Graph, Id, Symbol};

/// A vector in ground axes: two or three components, as many as the model has dimensions.
pub type Vector = Vec<Id>;

/// An integral by a rule of quadrature, and for which values that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Tried {
    /// As written.
    pub words: String,
    /// Parameters, coordinates, speeds and time in it, each between these values, SI.
    pub ranges: Vec<(Symbol, [f64; 2])>,
}

/// What a model file says, ready to derive from.
///
/// Expressions contain the symbols of [`crate::expr::Symbol`]; derived parameters, definitions, points and
/// frames have been put in.  Indices in symbols are places in the lists below.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// All expressions live here.
    pub graph: Graph,
    /// The type's name.
    pub name: String,
    /// One paragraph.
    pub about: String,
    /// Integrals by rules of quadrature, and where these were tried.
    pub integrals: Vec<Tried>,
    /// Files beside the model's that its tables come from.
    pub files: Vec<std::path::PathBuf>,
    /// The sizes in force.
    pub sizes: Vec<(String, i64)>,
    /// 2 or 3.
    pub dimension: usize,
    /// Gravity's acceleration at the defaults of the parameters; zero where there is none or it is not known before a run.
    pub usual_gravity: [f64; 3],
    /// Free parameters, families expanded.
    pub parameters: Vec<Parameter>,
    /// Derived parameters, families expanded.
    pub derived: Vec<Derived>,
    /// Generalized coordinates, families expanded; then a hidden one for each state, whose speed the state is.
    pub coordinates: Vec<Coordinate>,
    /// States of first order, families expanded.
    pub states: Vec<StateOfFirstOrder>,
    /// Held values, families expanded.
    pub memory: Vec<HeldValue>,
    /// Held noise, families expanded.
    pub noise: Vec<Noise>,
    /// Inputs.
    pub inputs: Vec<Input>,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Gravity's acceleration; absent: none.
    pub gravity: Option<Vector>,
    /// Springs, dampers, forces and torques.
    pub loads: Vec<Load>,
    /// `kinetic_energy` as written, beside what bodies give; 0 if absent.
    pub raw_kinetic_energy: Id,
    /// That of the lengths of rotations, which is part of no energy that is observed.
    pub radial_energy: Id,
    /// Coordinates of kind `rotation`.
    pub rotations: Vec<RotationCoordinate>,
    /// `potential_energy` as written, beside what gravity and springs give; 0 if absent.
    pub raw_potential_energy: Id,
    /// Rayleigh's dissipation function as written: Q = −∂D/∂q'; 0 if absent.
    pub dissipation: Id,
    /// `generalized_forces`.
    pub generalized_forces: Vec<GeneralizedForce>,
    /// Constraints.
    pub constraints: Vec<Constraint>,
    /// Phases, the initial one first; one without a name, with all constraints, where the file has none.
    pub phases: Vec<Phase>,
    /// All terms of T: bodies', then raw ones.
    pub kinetic_terms: Vec<Id>,
    /// All terms of V: gravity's, springs', then raw ones.
    pub potential_terms: Vec<Id>,
    /// Unknown reactions of the balances.
    pub reactions: Vec<Reaction>,
    /// Systems of momentum balances: second derivations.
    pub balances: Vec<BalanceSystem>,
    /// Ends of loads at points that several bodies carry; the first of them takes the load.
    pub shared_ends: Vec<SharedEnd>,
    /// Quantities that the file says are conserved.
    pub conserved: Vec<Conserved>,
    /// Identities that the file says hold.
    pub checks: Vec<Check>,
    /// Ranges to draw test states from.
    pub sample: Vec<Sample>,
    /// Outputs.
    pub outputs: Vec<Output>,
    /// Events.
    pub events: Vec<Event>,
    /// What events set, each at once.
    pub sets: Vec<Set>,
    /// Friction that may stick, and contacts that may open.
    pub contacts: Vec<Contact>,
    /// What several contacts that strike at once do, where the file says so.
    pub impacts: Option<ImpactLaw>,
    /// The clocks of events that happen again and again.
    pub clocks: Vec<Clock>,
    /// What to draw.
    pub draw: Vec<Shape>,
    /// Forces that act at points, where the model was loaded with them.
    pub point_forces: PointForces,
    /// Scenes; the first is the default and always there.
    pub scenes: Vec<Scene>,
    /// Motions that are asked for.
    pub motions: Vec<Motion>,
    /// The guess for an equilibrium where the file gives one, an expression of parameters per coordinate.
    pub equilibrium: Option<Vec<Id>>,
    /// What is doubtful and no error.
    pub warnings: Vec<Problem>,
    /// The model's names, for expressions that come later.
    pub(crate) scope: Scope,
}

/// What the name of a state's hidden coordinate begins with, which no name of a file does: `∫i` is the integral of `i`.
pub const HIDDEN: char = '∫';

/// A state of first order: what `states` declares.
#[derive(Clone, Debug)]
pub struct StateOfFirstOrder {
    /// Its expanded name.
    pub name: String,
    /// Its unit as written.
    pub unit: Option<String>,
    /// Its rate, of time, inputs, coordinates, speeds and states.
    pub rate: Id,
    /// Where it is declared.
    pub place: Place,
}

impl Model {
    /// Where a file says nothing of a place: 0, and rotations as the first scene begins, since a quaternion of zeros is none.
    pub fn unsaid_place(&self) -> Vec<Id> {
        let mut place = vec![Id::ZERO; self.coordinates.len()];
        for rotation in &self.rotations {
            let numbers = rotation.first..rotation.first + 4;
            place[numbers.clone()].copy_from_slice(&self.scenes[0].q[numbers]);
        }
        place
    }

    /// The unit of each coordinate as written; of a hidden one that of its state.
    pub fn units_of_coordinates(&self) -> impl Iterator<Item = &Option<String>> {
        let own = self.coordinates[..self.mechanical()].iter().map(|c| &c.unit);
        own.chain(self.states.iter().map(|state| &state.unit))
    }

    /// How many coordinates the file declares: those of states follow.
    pub fn mechanical(&self) -> usize {
        self.coordinates.len() - self.states.len()
    }

    /// Where three angles that turn a body cannot turn it in every direction.
    pub fn gimbals(&self) -> Vec<Gimbal> {
        let mut found: Vec<Gimbal> = Vec::new();
        for rotation in self.bodies.iter().filter_map(|body| body.rotation.as_ref()) {
            let Rotation::Space { frame, .. } = rotation else { continue };
            for gimbal in frame.turns.gimbals() {
                if !found.contains(&gimbal) {
                    found.push(gimbal);
                }
            }
        }
        found
    }

    /// The rows of the constraints that act in a phase, in order.
    pub fn rows_of(&self, phase: &Phase) -> Vec<usize> {
        let constraints = phase.constraints.iter().map(|k| &self.constraints[*k]);
        let mut rows: Vec<usize> = constraints.flat_map(Constraint::rows).collect();
        rows.sort_unstable();
        rows
    }

    /// Whether contacts have so many combinations of what they do that only what each does by itself is a phase.
    pub fn contacts_are_single(&self) -> bool {
        are_single(&self.contacts.iter().map(Contact::modes).collect::<Vec<_>>())
    }

    /// The rows of these constraints, which contacts have.
    pub(crate) fn rows_of_contacts(&self, constraints: impl Iterator<Item = usize>) -> Vec<usize> {
        constraints.filter_map(|place| self.constraints.get(place)).flat_map(Constraint::rows).collect()
    }

    /// The rows of all contacts' constraints.
    pub fn contact_rows(&self) -> Vec<usize> {
        let constraints = |contact: &Contact| [contact.normal, contact.tangent].into_iter().flatten();
        self.rows_of_contacts(self.contacts.iter().flat_map(constraints))
    }

    /// The rows that a system of balances has as equations of its own: with contacts, which belong to all phases, those of all contacts, whether
    /// they act or not, then those of its phase.
    pub fn rows_of_system(&self, system: &BalanceSystem) -> Vec<usize> {
        let active = system.phases.first().and_then(|phase| self.phases.get(*phase));
        let mut rows = active.map_or_else(Vec::new, |phase| self.rows_of(phase));
        if system.phases.len() > 1 {
            let contacts = self.contact_rows();
            rows.retain(|row| !contacts.contains(row));
            rows.splice(..0, contacts);
        }
        rows
    }

    /// The constraint that a row is of.
    pub fn constraint_of_row(&self, row: usize) -> Option<&Constraint> {
        self.constraints.iter().find(|constraint| constraint.rows().contains(&row))
    }

    /// The name of a row: `rod`, or `pin.x` for a component of a vector.
    pub fn row_name(&self, row: usize) -> String {
        self.constraint_of_row(row).map_or_else(String::new, |c| c.row_names().swap_remove(row - c.first))
    }

    /// The condition under which something is claimed: ` where c = 0 and k = 2`; nothing where it always holds.
    pub fn condition(&self, when: &[Condition]) -> String {
        let part = |c: &Condition| match self.graph.number(c.value) {
            Some(number) => format!("{} = {}", self.parameters[c.parameter].name, number.to_f64()),
            None => format!("{} = {}", self.parameters[c.parameter].name, c.written),
        };
        let parts: Vec<String> = when.iter().map(part).collect();
        if parts.is_empty() { String::new() } else { format!(" where {}", parts.join(" and ")) }
    }
}

/// A free parameter.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its expanded name, `m[2]`.
    pub name: String,
    /// Its family's name and the range of its index, where it belongs to one: an array field.
    pub family: Option<Family>,
    /// Its unit as written.
    pub unit: Option<String>,
    /// Its default in SI.
    pub default: f64,
    /// Where it is declared.
    pub place: Place,
}

/// A member's place in a one- or two-index family that becomes an array field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Family {
    /// The family's name.
    pub name: String,
    /// Lowest and highest value of each index.
    pub ranges: Vec<(i64, i64)>,
    /// This member's indices.
    pub indices: Vec<i64>,
}

/// A derived parameter: recomputed whenever the free ones change.
#[derive(Clone, Debug)]
pub struct Derived {
    /// Its expanded name.
    pub name: String,
    /// Its unit as written.
    pub unit: Option<String>,
    /// Its value, of free parameters only.
    pub value: Id,
}

/// A generalized coordinate.
#[derive(Clone, Debug)]
pub struct Coordinate {
    /// Its expanded name, `theta[3]`; that of a state begins with [`HIDDEN`].
    pub name: String,
    /// Its unit as written.
    pub unit: Option<String>,
    /// Where it is declared.
    pub place: Place,
}

impl Coordinate {
    /// What the members of its family share of their names: `theta` of `theta[3]`.
    pub fn family(&self) -> &str {
        self.name.split('[').next().unwrap_or("")
    }

    /// Whether it is that of a state of first order.
    pub fn is_hidden(&self) -> bool {
        self.name.starts_with(HIDDEN)
    }
}

/// A coordinate of kind `rotation`: four numbers, of which the quotients matter.
#[derive(Clone, Debug)]
pub struct RotationCoordinate {
    /// Its expanded name.
    pub name: String,
    /// The place of its scalar part among the coordinates; the vector part follows.
    pub first: usize,
    /// Where it is declared.
    pub place: Place,
}

/// A named function of time.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its expanded name.
    pub name: String,
    /// u, u', u'' as expressions of t and parameters.
    pub signal: [Id; 3],
}

/// A body.
#[derive(Clone, Debug)]
pub struct Body {
    /// Its expanded name.
    pub name: String,
    /// Its mass.
    pub mass: Id,
    /// Its centre of mass.
    pub position: Vector,
    /// The same in space, along the axes of the frames along which it is written.
    pub ways: Ways,
    /// Absent for a particle.
    pub rotation: Option<Rotation>,
    /// Where it is declared.
    pub place: Place,
}

/// A spring, damper, force or torque.
#[derive(Clone, Debug)]
pub struct Load {
    /// Its expanded label.
    pub name: String,
    /// How it does work.
    pub work: Work,
    /// What it does to the material of bodies, both ends; for springs and dampers what momentum balances see.
    pub pushes: Vec<Push>,
    /// Where it is declared.
    pub place: Place,
}

impl Load {
    /// Whether it stands for the change of a load that another body would take, and is of no file: no label of a file starts so.
    pub fn is_moved(&self) -> bool {
        self.name.starts_with('\0')
    }

    /// What its work and its pushes are made of.
    pub fn expressions(&self) -> Vec<Id> {
        let work = match self.work {
            Work::Potential(v) => vec![v],
            Work::Resistance { rate, tension } => vec![rate, tension],
            Work::Pushes => Vec::new(),
        };
        let pushes = self.pushes.iter().flat_map(|push| push.force.iter().chain(&push.couple).copied());
        work.into_iter().chain(pushes).collect()
    }
}

/// How a load does work on virtual displacements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// Q = −∂V/∂q with this V.
    Potential(Id),
    /// Q = −tension ∂rate/∂q'.
    Resistance {
        /// The rate that is resisted.
        rate: Id,
        /// The resistance, positive against the rate.
        tension: Id,
    },
    /// Q = Σ force·∂(material velocity)/∂q' over the pushes.
    Pushes,
}

/// A force and a couple on the material of one body.
#[derive(Clone, Debug)]
pub struct Push {
    /// The body; `None`: ground.
    pub body: Option<usize>,
    /// Where the force acts.
    pub at: Vector,
    /// The force.
    pub force: Vector,
    /// The couple: one number in the plane, three in space; empty for none.
    pub couple: Vec<Id>,
}

/// A generalized force as written.
#[derive(Clone, Debug)]
pub struct GeneralizedForce {
    /// The place of the coordinate on which it acts.
    pub coordinate: usize,
    /// The force.
    pub force: Id,
    /// Where it stands.
    pub place: Place,
}

/// A constraint: its components vanish while it is active.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its expanded name.
    pub name: String,
    /// Its components, c(t, q) or c(t, q, q'), affine in the speeds.
    pub value: Vec<Id>,
    /// True for a number, false for a vector.
    pub scalar: bool,
    /// True where it contains no speeds.
    pub holonomic: bool,
    /// The place of its first component among the rows of all constraints, in file order: `Symbol::Multiplier`.
    pub first: usize,
    /// Its unit in SI, where it is known and not 1.
    pub unit: Option<String>,
    /// Where it is declared.
    pub place: Place,
}

impl Constraint {
    /// Its rows among those of all constraints.
    pub fn rows(&self) -> Range<usize> {
        self.first..self.first + self.value.len()
    }

    /// The names of its components: `rod`; `pin.x`, `pin.y`; in space `floor.friction.1`, `floor.friction.2`.
    pub fn row_names(&self) -> Vec<String> {
        (0..self.value.len()).map(|place| self.component(place)).collect()
    }

    /// The name of one component.
    pub fn component(&self, place: usize) -> String {
        let axes = match self.name.ends_with(".friction") {
            // Along two directions across a normal.
            true => [".1", ".2", ""],
            false => [".x", ".y", ".z"],
        };
        let axis = if self.scalar { "" } else { axes[place.min(2)] };
        format!("{}{axis}", self.name)
    }
}

/// A phase: which constraints act.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Its name; empty where the file has no phases.
    pub name: String,
    /// Its constraints, by their places.
    pub constraints: Vec<usize>,
    /// Where it is declared.
    pub place: Place,
}

/// An end of a load at a point that several bodies carry (a hinge).
#[derive(Clone, Debug)]
pub struct SharedEnd {
    /// The load's place in the list.
    pub load: usize,
    /// Which of its pushes.
    pub push: usize,
    /// The bodies, the one that takes it first.
    pub bodies: Vec<usize>,
    /// The point as written.
    pub point: String,
    /// Where that stands.
    pub place: Place,
    /// What it would change in the balances if another body took it.
    pub changes: Vec<Change>,
}

/// What moving a load from one body to another adds to a balance.
#[derive(Clone, Debug)]
pub struct Change {
    /// The body that would take it.
    pub body: usize,
    /// The system's place.
    pub system: usize,
    /// The equation in its system.
    pub equation: usize,
    /// The addition to its residual.
    pub value: Id,
}

/// A value that a parameter must have for a claim to hold.
#[derive(Clone, Debug)]
pub struct Condition {
    /// The parameter's place.
    pub parameter: usize,
    /// Its value, of parameters that no condition of the claim sets.
    pub value: Id,
    /// The value as the file has it.
    pub written: String,
}

/// A quantity that the file says is conserved.
#[derive(Clone, Debug)]
pub struct Conserved {
    /// Its label.
    pub name: String,
    /// Its components.
    pub value: Vec<Id>,
    /// The terms whose absolute values scale its drift, by component (top-level sums and `sum()` taken apart;
    /// `energy` into the terms of T and V).
    pub terms: Vec<Vec<Id>>,
    /// True where `energy` or `potential_energy` stands in it.
    pub counts_energy: bool,
    /// Parameters that must have certain values.
    pub when: Vec<Condition>,
    /// The phases in which it is claimed; absent: every.
    pub phases: Option<Vec<usize>>,
    /// Where it stands.
    pub place: Place,
}

/// An identity.
#[derive(Clone, Debug)]
pub struct Check {
    /// Its label.
    pub name: String,
    /// Components of the left side.
    pub left: Vec<Id>,
    /// Components of the right side.
    pub right: Vec<Id>,
    /// Parameters that must have certain values.
    pub when: Vec<Condition>,
    /// The phases in which it is claimed; absent: every.
    pub phases: Option<Vec<usize>>,
    /// Where it stands.
    pub place: Place,
}

/// A range to draw a coordinate or speed from.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The coordinate's place.
    pub coordinate: usize,
    /// True for its speed.
    pub speed: bool,
    /// Lower end, of parameters.
    pub low: Id,
    /// Upper end, of parameters.
    pub high: Id,
}

/// Forces that act at points: of constraints, joints, contacts, friction, reactions of balances and loads.
#[derive(Clone, Debug, Default)]
pub struct PointForces {
    /// The names of what each is of; one that acts at several points has as many forces.
    pub names: Vec<String>,
    /// The names of couples, and of forces of which the file does not say where they act.
    pub elsewhere: Vec<String>,
}

/// A named scalar or vector along a run.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its expanded name.
    pub name: String,
    /// Its components.
    pub value: Vec<Id>,
    /// Its unit in SI, where it is known and not 1.
    pub unit: Option<String>,
    /// What is known of its unit.
    pub(crate) measure: Measure,
    /// Whether it contains named reactions; those become expressions of the state and the accelerations.
    pub of_reactions: bool,
}

/// Something to draw.
#[derive(Clone, Debug)]
pub enum Shape {
    /// A polyline.
    Line(Vec<Vector>),
    /// A circle.
    Circle {
        /// Its centre.
        at: Vector,
        /// Its radius.
        radius: Id,
    },
    /// A zigzag.
    Spring(Vector, Vector),
    /// A curve, sampled.
    Curve(Vec<Vector>),
    /// The path of a point, with its name.
    Trace(String, Vector),
    /// A shape in space, with its numbers.
    Solid(Solid, Vec<Id>),
}

/// A shape in space; all its numbers are lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Solid {
    /// A circle: its centre, and a vector along its axis that is as long as its radius.
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
    /// Three axes: where they begin, and each as long as it is drawn.
    Axes,
    /// Three axes: where they begin, and the unit vector along each; the picture gives them their length.
    UnitAxes,
}

/// A scene; every expression is of parameters only and evaluated after `set`.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Its name; `scene` for the default.
    pub name: String,
    /// Coordinates at the start; where constraints are to be met, what is not named is the guess.
    pub q: Vec<Id>,
    /// Speeds at the start.
    pub v: Vec<Id>,
    /// True for every coordinate that `start` names: it is held.
    pub held_q: Vec<bool>,
    /// True for every speed that `start` names.
    pub held_v: Vec<bool>,
    /// Angular velocities that `start` names, whose rates in `v` are those at the attitude in `q`.
    pub spins: Vec<Spin>,
    /// True where the scene gives a `guess`.
    pub guessed: bool,
    /// Equations that the start meets together with the constraints: (quantity of t, q, q'; its value).
    pub start_conditions: Vec<(Id, Id)>,
    /// The phase in which it starts.
    pub phase: usize,
    /// The end.
    pub until: Id,
    /// Relative tolerance.
    pub tolerance: Id,
    /// Spacing of reported states; absent: 500 points.
    pub every: Option<Id>,
    /// Free parameters and their values (of the others, before `set`).
    pub set: Vec<(usize, Id)>,
    /// What is wanted of it; absent: everything.
    pub need: Option<Need>,
    /// Held values at the start.
    pub memory: Vec<Id>,
}

/// The angular velocity of a rotation, as a start names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spin {
    /// The first of the rotation's coordinates.
    pub first: usize,
    /// Along its own axes, or else along those from which it is turned.
    pub own: bool,
}

/// What a scene is run for.
#[derive(Clone, Debug)]
pub struct Need {
    /// Coordinates, rates (with a prime) and outputs, with where each is named; none: all coordinates and outputs.
    pub outputs: Vec<(String, Place)>,
    /// How exactly, in parts of the range that each goes through.
    pub within: Id,
    /// What is wanted to an amount of its own instead.
    pub absolute: Vec<Amount>,
}

/// By how much something that is wanted may be off.
#[derive(Clone, Debug)]
pub struct Amount {
    /// A coordinate, rate or output.
    pub name: String,
    /// Where it is named.
    pub place: Place,
    /// The amount, SI.
    pub value: Id,
    /// Its unit in SI; absent: a pure number.
    pub unit: Option<String>,
}

/// An unknown force or couple.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reaction {
    /// Its expanded name.
    pub name: String,
    /// The first of its symbols.
    pub first: u32,
    /// How many symbols it has.
    pub components: usize,
    /// True for a number, false for a vector.
    pub scalar: bool,
    /// True for a moment, false for a force.
    pub couple: bool,
}

impl Reaction {
    /// The symbols of its components.
    pub fn symbols(&self) -> impl Iterator<Item = Symbol> + use<> {
        (self.first..self.first + self.components as u32).map(Symbol::Reaction)
    }
}

/// One complete system of momentum balances.
#[derive(Clone, Debug)]
pub struct BalanceSystem {
    /// Its name.
    pub name: String,
    /// Its balances.
    pub balances: Vec<Balance>,
    /// Its reactions, by their places.
    pub reactions: Vec<usize>,
    /// Force on every body as equations, and the moment about its centre of mass where it turns, to compare reactions of
    /// written-out equations with; empty without such.
    pub bodies: Vec<Id>,
    /// The phases to which it belongs.
    pub phases: Vec<usize>,
    /// Where it stands.
    pub place: Place,
}

/// A balance: the sum of its parts vanishes.
#[derive(Clone, Debug)]
pub struct Balance {
    /// Its label and kind, for messages.
    pub label: String,
    /// Inertia, less forces.
    pub parts: Vec<Part>,
    /// The same in finer parts, to name a wrong one: the terms of a written-out equation; empty where there are none.
    pub terms: Vec<Part>,
    /// The products that are written in one piece and are several of these terms.
    pub products: Vec<(String, std::ops::Range<usize>)>,
    /// How many equations it is.
    pub components: usize,
    /// True for power and energy, which say nothing at rest.
    pub void_at_rest: bool,
    /// True for balances of force and moment, which hold integrated over an instant too.
    pub instantaneous: bool,
    /// Where it stands.
    pub place: Place,
}

impl Balance {
    /// Whether it was written out as an equation.
    pub fn is_written(&self) -> bool {
        !self.instantaneous && !self.void_at_rest
    }
}

/// What one body or load contributes to a balance.
#[derive(Clone, Debug)]
pub struct Part {
    /// For messages: `the weight of upper`.
    pub name: String,
    /// One expression per equation.
    pub value: Vec<Id>,
}
