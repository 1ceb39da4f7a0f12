//! The names of a model and what they stand for.

use std::collections::BTreeMap;

use super::dimension::{Dimension, Measure};
use super::radians::{self, Radians};
use super::rules::Expected;
use super::value::Value;
use crate::expr::{Id, Table, Table2d};
use crate::language::FUNCTIONS;
use crate::model::resolved::{Body, Reaction};

/// The section that declares a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Section {
    /// `sizes`
    Size,
    /// `parameters`
    Parameter,
    /// `coordinates`
    Coordinate,
    /// `states`
    State,
    /// `memory`
    Memory,
    /// `noise`
    Noise,
    /// `inputs`
    Input,
    /// `define`
    Definition,
    /// `frames`
    Frame,
    /// `points`
    Point,
    /// `bodies`
    Body,
    /// `reactions` of `balances`
    Reaction,
    /// `constraints`
    Constraint,
    /// `phases`
    Phase,
    /// `joints`
    Joint,
    /// `tables`
    Table,
}

impl Section {
    /// Its key in the file.
    pub fn key(self) -> &'static str {
        match self {
            Section::Size => "sizes",
            Section::Parameter => "parameters",
            Section::Coordinate => "coordinates",
            Section::State => "states",
            Section::Memory => "memory",
            Section::Noise => "noise",
            Section::Input => "inputs",
            Section::Definition => "define",
            Section::Frame => "frames",
            Section::Point => "points",
            Section::Body => "bodies",
            Section::Reaction => "reactions",
            Section::Constraint => "constraints",
            Section::Phase => "phases",
            Section::Joint => "joints",
            Section::Table => "tables",
        }
    }

    /// What it declares, with its article.
    pub fn noun(self) -> &'static str {
        match self {
            Section::Size => "a size",
            Section::Parameter => "a parameter",
            Section::Coordinate => "a coordinate",
            Section::State => "a state",
            Section::Memory => "a held value",
            Section::Noise => "noise",
            Section::Input => "an input",
            Section::Definition => "a definition",
            Section::Frame => "a frame",
            Section::Point => "a point",
            Section::Body => "a body",
            Section::Reaction => "a reaction",
            Section::Constraint => "a constraint",
            Section::Phase => "a phase",
            Section::Joint => "a joint",
            Section::Table => "a table",
        }
    }
}

/// What one expanded name stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Member {
    /// A size.
    Size(i64),
    /// A free parameter, by its place.
    Parameter(u32),
    /// A coordinate, by its place.
    Coordinate(u32),
    /// A coordinate of kind `rotation`, by its place among these.
    Rotation(usize),
    /// A state of first order, by its place among the states.
    State(u32),
    /// A held value, by its place.
    Memory(u32),
    /// Held noise, by its place.
    Noise(usize),
    /// An input, by its place, and the item that holds its expression.
    Input(u32, usize),
    /// A derived parameter, definition or point: the item that holds its value.
    Item(usize),
    /// A frame: the item that holds its angle, or how it is turned in space.
    Frame(usize),
    /// A body, by its place.
    Body(usize),
    /// An unknown reaction, by its place.
    Reaction(usize),
    /// A constraint, by its place.
    Constraint(usize),
    /// A joint, by its place.
    Joint(usize),
    /// A phase, by its place.
    Phase(usize),
    /// A table, by its place.
    Table(usize),
    /// Belongs to a part of the file that was refused already.
    Refused,
}

/// One name: a single thing (with the empty index) or a family.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Where it is declared.
    pub section: Section,
    /// How many indices it takes.
    pub indices: usize,
    /// True when its declaration was refused: whatever uses it is silent.
    pub refused: bool,
    /// Its members by their indices.
    pub members: BTreeMap<Vec<i64>, Member>,
}

/// Where a body's motion is found.
#[derive(Clone, Debug)]
pub struct BodyNames {
    /// Its expanded name.
    pub name: String,
    /// The item that holds its centre of mass.
    pub position: usize,
    /// The item that holds its angle, or its frame in space; `None` for a particle.
    pub orientation: Option<usize>,
}

/// Where a constraint is found.
#[derive(Clone, Debug)]
pub struct ConstraintNames {
    /// Its expanded name.
    pub name: String,
    /// The item that holds its value.
    pub item: usize,
    /// The place of its first component among the rows of all constraints, once that is known.
    pub first: Option<usize>,
    /// Of a contact's gap that is no distance: by which its multiplier is divided where it is asked for as a force.
    pub scale: Option<Id>,
    /// Of the sliding of a contact in space: the item of the normal across which its two components are.
    pub across: Option<usize>,
}

/// A joint by name: constraints that belong together.
#[derive(Clone, Debug)]
pub struct JointNames {
    /// Its expanded name.
    pub name: String,
    /// Its rows: the place of each among the constraints, and what it is.
    pub rows: Vec<(usize, JointRow)>,
    /// True where both sides meet in one point by the coordinates, so that no row carries the force.
    pub one_point: bool,
}

/// What a row of a joint states of its points P (of the first side) and Q (of the second) and of directions: all are items.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JointRow {
    /// P − Q = 0, by components.
    Meet {
        /// P and Q.
        points: [usize; 2],
    },
    /// (P − Q)·u = 0, with u fixed in the first side.
    Keep {
        /// P and Q.
        points: [usize; 2],
        /// u.
        along: usize,
    },
    /// u·v = 0, with u fixed in the first side and v in the second.
    Turn {
        /// u and v.
        across: [usize; 2],
    },
    /// d/dt (Q − P)·a = h (ω₂ − ω₁)·a with a fixed in the first side: of rates, since an angle has no value beyond a turn.
    Advance {
        /// P and Q.
        points: [usize; 2],
        /// a.
        axis: usize,
        /// How each side is turned; `None` for the ground.
        turned: [Option<usize>; 2],
        /// h, the way for a turn of 1 rad.
        pitch: usize,
    },
    /// (v₁ − v₂) × n = 0 with the velocities of the material of both bodies at a point, or in space its components along two directions across n: no
    /// row of a joint, but of a contact that sticks.
    Slide {
        /// Both bodies; `None` for the ground.
        bodies: [Option<usize>; 2],
        /// The point.
        at: usize,
        /// The normal, of any length.
        normal: usize,
    },
    /// (v₁ − v₂)·n of the same: no row either, but how fast a contact opens.
    Approach {
        /// Both bodies; `None` for the ground.
        bodies: [Option<usize>; 2],
        /// The point.
        at: usize,
        /// The normal, of any length.
        normal: usize,
    },
}

/// A table of one argument or of two.
#[derive(Clone, Copy, Debug)]
pub enum TableKind {
    /// Of one.
    One(Table),
    /// Of two.
    Two(Table2d),
}

/// A function that is given by points.
#[derive(Clone, Debug)]
pub struct TableNames {
    /// The function, in SI.
    pub table: TableKind,
    /// The units of its arguments.
    pub of: Vec<Measure>,
    /// The unit of its value.
    pub gives: Measure,
}

/// T and V of the whole model.
#[derive(Clone, Copy, Debug)]
pub struct Energies {
    /// T.
    pub kinetic: Id,
    /// V.
    pub potential: Id,
}

/// What is known of the units of names.
#[derive(Clone, Debug)]
pub struct Units {
    /// True where no unit but `1` and `rad` is written: then time is a pure number too.
    pub pure: bool,
    /// Of free parameters, by their place.
    pub parameters: Vec<Measure>,
    /// Of coordinates, by their place.
    pub coordinates: Vec<Measure>,
    /// Of states of first order, by their place.
    pub states: Vec<Measure>,
    /// Of held values, by their place.
    pub memory: Vec<Measure>,
    /// Of items.
    pub items: Vec<Measure>,
    /// Of the model's energies.
    pub energy: Measure,
    /// Radians in them, which these do not show.
    pub radians: Radians,
}

impl Default for Units {
    fn default() -> Units {
        Units {
            pure: true,
            parameters: Vec::new(),
            coordinates: Vec::new(),
            states: Vec::new(),
            memory: Vec::new(),
            items: Vec::new(),
            energy: Measure::Unknown,
            radians: Radians::new(),
        }
    }
}

impl Units {
    /// Notes how many radians a name has by its unit as it is written.
    pub fn note_radians(&mut self, name: &str, words: Option<&str>) {
        let radians = words.map_or(0, radians::of_words);
        if radians != 0 {
            self.radians.insert(name.to_owned(), radians);
        }
    }

    /// The unit of a kind of quantity; unknown in a model without units.
    pub fn of(&self, dimension: Dimension) -> Measure {
        if self.pure { Measure::Unknown } else { Measure::Of(dimension) }
    }

    /// The unit that an expression is to have.
    pub fn expected(&self, expected: Expected) -> Measure {
        match expected {
            Expected::Any => Measure::Unknown,
            Expected::Si(dimension) => self.of(dimension),
            Expected::Like(measure) => measure,
        }
    }

    /// The unit of the rate of something.
    pub fn rate(&self, measure: Measure) -> Measure {
        measure.over(Measure::Of(if self.pure { Dimension::ONE } else { Dimension::TIME }))
    }
}

/// All names of a model.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// 2 or 3.
    pub dimension: usize,
    /// By name.
    pub names: BTreeMap<String, Entry>,
    /// Values of items; `None` while not known.
    pub values: Vec<Option<Value>>,
    /// Bodies in the file's order, families expanded.
    pub bodies: Vec<BodyNames>,
    /// Of each rotation the place of its first number among the coordinates.
    pub rotations: Vec<usize>,
    /// Unknown reactions of the balances.
    pub reactions: Vec<Reaction>,
    /// Constraints and joints by name, which is a label of its own.
    pub constraint_names: BTreeMap<String, Entry>,
    /// Phases by name, likewise.
    pub phase_names: BTreeMap<String, Entry>,
    /// Constraints in the file's order, families expanded.
    pub constraints: Vec<ConstraintNames>,
    /// Joints in the file's order, families expanded.
    pub joints: Vec<JointNames>,
    /// Tables in the file's order.
    pub tables: Vec<TableNames>,
    /// Values of noise, each with the place of the held value whose unit it has.
    pub noise: Vec<(Id, usize)>,
    /// Known once bodies and loads are.
    pub energies: Option<Energies>,
    /// Bodies with their masses and inertias, known with the energies.
    pub massive: Vec<Body>,
    /// What is known of units.
    pub units: Units,
}

/// `x`, `x[2]`, `x[1,2]`.
pub fn expanded(name: &str, indices: &[i64]) -> String {
    if indices.is_empty() {
        return name.to_owned();
    }
    let indices: Vec<String> = indices.iter().map(i64::to_string).collect();
    format!("{name}[{}]", indices.join(","))
}

impl Scope {
    /// The item's value, if it is known.
    pub fn value(&self, item: usize) -> Option<&Value> {
        self.values.get(item).and_then(Option::as_ref)
    }

    /// What has a rate.
    pub fn moving(&self) -> impl Iterator<Item = &str> {
        let moves = |section| matches!(section, Section::Coordinate | Section::State | Section::Input);
        self.names.iter().filter(move |(_, entry)| moves(entry.section)).map(|(name, _)| name.as_str())
    }

    /// Everything an expression could have meant.
    pub fn candidates(&self) -> impl Iterator<Item = &str> {
        let built_in = ["t", "pi", "ground"].into_iter().chain(FUNCTIONS.iter().map(|function| function.name));
        self.names.keys().map(String::as_str).chain(built_in)
    }
}

impl Entry {
    /// Without members.
    pub fn new(section: Section, indices: usize) -> Entry {
        Entry { section, indices, refused: false, members: BTreeMap::new() }
    }

    /// Adds a member; false when its indices are taken, or are more or fewer than those of others.
    pub fn add(&mut self, indices: &[i64], member: Member) -> bool {
        let fresh = self.indices == indices.len() && !self.members.contains_key(indices);
        if fresh {
            self.members.insert(indices.to_vec(), member);
        }
        fresh
    }

    /// For messages: `x[1] to x[5]` or `no members`.
    pub fn range(&self, name: &str) -> String {
        match (self.members.keys().next(), self.members.keys().next_back()) {
            (Some(first), Some(last)) if first != last => {
                format!("{} to {}", expanded(name, first), expanded(name, last))
            }
            (Some(only), _) => format!("only {}", expanded(name, only)),
            _ => "no members".to_owned(),
        }
    }
}
