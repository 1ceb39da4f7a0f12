//! What each node of the graph depends on, kept up to date as the graph grows.

use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// A set of kinds of symbols, and of what is done to them, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Depends(u16);

impl Depends {
    /// Explicit time.
    pub const TIME: Depends = Depends(1);
    /// A coordinate.
    pub const COORDINATE: Depends = Depends(2);
    /// A rate of a coordinate, or the first derivative of an input.
    pub const VELOCITY: Depends = Depends(4);
    /// A second rate, or the second derivative of an input.
    pub const ACCELERATION: Depends = Depends(8);
    /// A third derivative of an input.
    pub const JERK: Depends = Depends(16);
    /// An input or its derivatives.
    pub const INPUT: Depends = Depends(32);
    /// A bound variable.
    pub const DUMMY: Depends = Depends(64);
    /// A free parameter with a unit other than 1.
    pub const UNIT: Depends = Depends(128);
    /// A rate of a coordinate.
    pub const SPEED: Depends = Depends(256);
    /// The multiplier of a constraint.
    pub const MULTIPLIER: Depends = Depends(512);
    /// A multiplier in something that is not linear in multipliers.
    pub const BEYOND_LINEAR: Depends = Depends(1024);
    /// A discontinuity, or a kink, of something that changes along the motion.
    pub const SWITCH: Depends = Depends(2048);

    /// A state of first order, or its rate.
    pub const STATE: Depends = Depends(4096);
    /// The rate of a state of first order.
    pub const STATE_RATE: Depends = Depends(8192);
    /// A held value, which events set.
    pub const MEMORY: Depends = Depends(16384);

    /// What changes along a motion, but for accelerations.
    const MOVING: Depends =
        Depends::TIME.and(Depends::COORDINATE).and(Depends::VELOCITY).and(Depends::INPUT).and(Depends::STATE);

    /// Both sets.
    pub const fn and(self, other: Depends) -> Depends {
        Depends(self.0 | other.0)
    }

    /// True when they share a kind.
    pub const fn meets(self, other: Depends) -> bool {
        self.0 & other.0 != 0
    }

    fn of(symbol: Symbol, dimensional: &[bool]) -> Depends {
        match symbol {
            Symbol::Time => Depends::TIME,
            Symbol::Coordinate(_) => Depends::COORDINATE,
            Symbol::Speed(_) => Depends::VELOCITY.and(Depends::SPEED),
            Symbol::Acceleration(_) | Symbol::Reaction(_) => Depends::ACCELERATION,
            Symbol::State(_) => Depends::STATE,
            Symbol::StateRate(_) => Depends::STATE.and(Depends::STATE_RATE),
            Symbol::Memory(_) => Depends::MEMORY,
            Symbol::Multiplier(_) => Depends::MULTIPLIER,
            Symbol::Input(_, order) => Depends::INPUT.and(match order {
                0 => Depends(0),
                1 => Depends::VELOCITY,
                2 => Depends::ACCELERATION,
                _ => Depends::JERK,
            }),
            Symbol::Parameter(place) if dimensional.get(place as usize) == Some(&true) => Depends::UNIT,
            Symbol::Parameter(_) => Depends(0),
            Symbol::Mode(_) | Symbol::Phase(_) => Depends(0),
            Symbol::Dummy(_) => Depends::DUMMY,
        }
    }

    /// Of a function of something.
    fn of_unary(function: Unary, x: Depends) -> Depends {
        let switches = matches!(function, Unary::Abs | Unary::Sign | Unary::Step);
        x.and_if(function != Unary::Neg && x.meets(Depends::MULTIPLIER), Depends::BEYOND_LINEAR)
            .and_if(switches && x.meets(Depends::MOVING), Depends::SWITCH)
    }

    /// Of an operation on two things.
    fn of_binary(operation: Binary, x: Depends, y: Depends) -> Depends {
        let (first, second) = (x.meets(Depends::MULTIPLIER), y.meets(Depends::MULTIPLIER));
        let bent = match operation {
            Binary::Add | Binary::Sub => false,
            Binary::Mul => first && second,
            Binary::Div => second,
            Binary::Pow | Binary::Atan2 | Binary::Min | Binary::Max | Binary::Table(_) | Binary::Normal(_) => {
                first || second
            }
        };
        let both = x.and(y);
        let switches = matches!(operation, Binary::Min | Binary::Max);
        both.and_if(bent, Depends::BEYOND_LINEAR).and_if(switches && both.meets(Depends::MOVING), Depends::SWITCH)
    }

    fn and_if(self, condition: bool, other: Depends) -> Depends {
        if condition { self.and(other) } else { self }
    }
}

/// The table, one entry per node.
#[derive(Clone, Debug, Default)]
pub struct Facts {
    nodes: Vec<Depends>,
    /// For each free parameter, whether it has a unit other than 1.
    pub dimensional: Vec<bool>,
}

impl Facts {
    /// What an expression depends on.
    pub fn of(&mut self, graph: &Graph, id: Id) -> Depends {
        for place in self.nodes.len()..graph.len() {
            let depends = match graph.node(graph.id_at(place)) {
                Node::Number(_) => Depends(0),
                Node::Symbol(s) => Depends::of(s, &self.dimensional),
                Node::Unary(f, x) => Depends::of_unary(f, self.nodes[x.index()]),
                Node::Binary(f, x, y) => Depends::of_binary(f, self.nodes[x.index()], self.nodes[y.index()]),
            };
            self.nodes.push(depends);
        }
        self.nodes[id.index()]
    }

    /// What any of some expressions depends on.
    pub fn of_all(&mut self, graph: &Graph, ids: &[Id]) -> Depends {
        ids.iter().fold(Depends(0), |all, id| all.and(self.of(graph, *id)))
    }
}
