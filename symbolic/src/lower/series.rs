//! How the Taylor coefficients of M, h, J and γ along a motion follow each other.

use std::collections::HashMap;

use super::Program;
use crate::expr::{Binary, Graph, Id, Node, Symbol, Unary};

/// Rows of Taylor coefficients, each made of earlier ones order by order, and where M, h, J and γ stand among them.
///
/// Source: R. E. Moore, Interval Analysis (1966), chapter 11; A. Jorba, M. Zou, Experimental Mathematics 14 (2005) 99, proposition 2.1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Expressions of parameters, modes, phases, held values and inputs that do not change, with which rows are made.
    pub constants: Vec<Id>,
    /// One for each row.  Coefficients of order k need those of rows before at orders up to k, and of rows behind at lower ones.
    pub rows: Vec<Recurrence>,
    /// The lower triangle of M: (row, column, value).
    pub mass: Vec<(usize, usize, Place)>,
    /// h.
    pub bias: Vec<Place>,
    /// J: (row, coordinate, value).
    pub matrix: Vec<(usize, usize, Place)>,
    /// γ.
    pub constraint_bias: Vec<Place>,
    /// Whether code has statements for them beside the data, where the model is small.
    pub written: bool,
}

/// Where an expression's coefficients are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// One of [`Series::constants`], which has a coefficient of order 0 only.
    Constant(usize),
    /// One of [`Series::rows`].
    Row(usize),
}

/// How a row's coefficients follow from those of others.  Numbers are those of rows, `c` are those of constants.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Recurrence {
    /// t.
    Time,
    /// A coordinate.
    Coordinate(usize),
    /// Its rate.
    Speed(usize),
    /// A constant.
    Constant(usize),
    /// a + b.
    Sum(usize, usize),
    /// a − b.
    Difference(usize, usize),
    /// −a.
    Negative(usize),
    /// a + c.
    Shifted(usize, usize),
    /// a − c.
    Reduced(usize, usize),
    /// c a.
    Scaled(usize, usize),
    /// a/c.
    Parted(usize, usize),
    /// a b.
    Product(usize, usize),
    /// a².
    Square(usize),
    /// a/b.
    Quotient(usize, usize),
    /// √a.
    Root(usize),
    /// a to the constant power c.
    Power(usize, usize),
    /// f(a) with f' = ±g: rate f(a)' = ±g a', whose coefficients are those of rows `of` and `by`.
    Grown {
        /// f.
        function: Unary,
        /// a.
        of: usize,
        /// g.
        by: usize,
        /// Whether the sign is −.
        falls: bool,
    },
    /// f(a) with f' = ±1/g.
    Divided {
        /// f.
        function: Unary,
        /// a.
        of: usize,
        /// g.
        by: usize,
        /// Whether the sign is −.
        falls: bool,
    },
    /// atan2(y, x) with x² + y² in the row `square`.
    Angle {
        /// y.
        y: usize,
        /// x.
        x: usize,
        /// x² + y².
        square: usize,
    },
}

impl Series {
    /// The recurrences of a program; `None` where a function has none, as a table, or a sign of what moves.
    pub fn of(program: &Program) -> Option<Series> {
        let mut builder = Builder {
            graph: &program.model.graph,
            program,
            series: Series::default(),
            places: HashMap::new(),
            known: HashMap::new(),
        };
        builder.follow(program.signals.iter().flatten().copied())?;
        let constraints = &program.constraints;
        let entries = |list: &[(usize, usize, Id)]| list.iter().map(|entry| entry.2).collect::<Vec<Id>>();
        let roots =
            [entries(&program.mass), program.bias.clone(), entries(&constraints.matrix), constraints.bias.clone()];
        builder.follow(roots.concat().into_iter())?;
        let mut placed = |list: &[(usize, usize, Id)]| -> Vec<(usize, usize, Place)> {
            list.iter().map(|(i, j, id)| (*i, *j, builder.place(*id))).collect()
        };
        let (mass, matrix) = (placed(&program.mass), placed(&constraints.matrix));
        let bias = program.bias.iter().map(|id| builder.place(*id)).collect();
        let constraint_bias = constraints.bias.iter().map(|id| builder.place(*id)).collect();
        Some(Series { mass, bias, matrix, constraint_bias, ..builder.series })
    }
}

struct Builder<'a> {
    graph: &'a Graph,
    program: &'a Program,
    series: Series,
    /// Where each expression is that moves, and each constant that some row needs.
    places: HashMap<Id, Place>,
    /// The row that a recurrence has.
    known: HashMap<Recurrence, usize>,
}

/// A part of an expression.
#[derive(Clone, Copy)]
enum Operand {
    Constant(Id),
    Row(usize),
}

impl Builder<'_> {
    /// Makes the rows of everything that moves in some expressions.
    fn follow(&mut self, roots: impl Iterator<Item = Id>) -> Option<()> {
        for id in self.graph.needed(roots) {
            if self.places.contains_key(&id) {
                continue;
            }
            let row = match self.graph.node(id) {
                Node::Number(_) => None,
                Node::Symbol(symbol) => self.symbol(symbol)?,
                Node::Unary(function, x) => match self.operand(x) {
                    Operand::Constant(_) => None,
                    Operand::Row(a) => Some(self.unary(function, a)?),
                },
                Node::Binary(operation, x, y) => match (self.operand(x), self.operand(y)) {
                    (Operand::Constant(_), Operand::Constant(_)) => None,
                    (x, y) => Some(self.binary(operation, x, y)?),
                },
            };
            if let Some(row) = row {
                self.places.insert(id, Place::Row(row));
            }
        }
        Some(())
    }

    /// The row of a recurrence, which is made where there is none yet.
    fn push(&mut self, recurrence: Recurrence) -> usize {
        let rows = &mut self.series.rows;
        *self.known.entry(recurrence).or_insert_with(|| {
            rows.push(recurrence);
            rows.len() - 1
        })
    }

    /// Where an expression is; constants get a place where somebody asks.
    fn place(&mut self, id: Id) -> Place {
        let constants = &mut self.series.constants;
        *self.places.entry(id).or_insert_with(|| {
            constants.push(id);
            Place::Constant(constants.len() - 1)
        })
    }

    fn operand(&self, id: Id) -> Operand {
        match self.places.get(&id) {
            Some(Place::Row(row)) => Operand::Row(*row),
            Some(Place::Constant(_)) | None => Operand::Constant(id),
        }
    }

    fn constant(&mut self, id: Id) -> usize {
        match self.place(id) {
            Place::Constant(constant) => constant,
            Place::Row(_) => unreachable!("what moves is no constant"),
        }
    }

    /// The row of an operand: a constant gets one of its own.
    fn row(&mut self, operand: Operand) -> usize {
        match operand {
            Operand::Row(row) => row,
            Operand::Constant(id) => {
                let constant = self.constant(id);
                self.push(Recurrence::Constant(constant))
            }
        }
    }

    /// `Some(None)`: it does not move.
    fn symbol(&mut self, symbol: Symbol) -> Option<Option<usize>> {
        let recurrence = match symbol {
            Symbol::Time => Recurrence::Time,
            Symbol::Coordinate(i) => Recurrence::Coordinate(i as usize),
            Symbol::Speed(i) => Recurrence::Speed(i as usize),
            Symbol::Parameter(_) | Symbol::Mode(_) | Symbol::Phase(_) | Symbol::Memory(_) => return Some(None),
            Symbol::Input(k, order) => {
                let signal = *self.program.signals.get(k as usize)?.get(usize::from(order))?;
                return Some(match self.places.get(&signal) {
                    Some(Place::Row(row)) => Some(*row),
                    _ => None,
                });
            }
            _ => return None,
        };
        Some(Some(self.push(recurrence)))
    }

    fn unary(&mut self, function: Unary, a: usize) -> Option<usize> {
        let next = self.series.rows.len();
        let grown = |function, by, falls| Recurrence::Grown { function, of: a, by, falls };
        let divided = |function, by, falls| Recurrence::Divided { function, of: a, by, falls };
        Some(match function {
            Unary::Neg => self.push(Recurrence::Negative(a)),
            Unary::Sqrt => self.push(Recurrence::Root(a)),
            Unary::Exp => self.once(function, a, |builder| builder.push(grown(function, next, false))),
            Unary::Sin | Unary::Cos | Unary::Sinh | Unary::Cosh => {
                let circular = matches!(function, Unary::Sin | Unary::Cos);
                let (sine, cosine) = if circular { (Unary::Sin, Unary::Cos) } else { (Unary::Sinh, Unary::Cosh) };
                // Each of the two needs the other at lower orders.
                let first = self.once(sine, a, |builder| {
                    builder.push(grown(sine, next + 1, false));
                    builder.push(grown(cosine, next, circular));
                    next
                });
                if function == sine { first } else { first + 1 }
            }
            Unary::Tan | Unary::Tanh => self.once(function, a, |builder| {
                // f' = 1 ± f².
                let (squared, signed) = (next + 1, if function == Unary::Tan { next + 1 } else { next + 2 });
                builder.push(grown(function, signed + 1, false));
                builder.push(Recurrence::Square(next));
                if signed > squared {
                    builder.push(Recurrence::Negative(squared));
                }
                let one = builder.constant(Id::ONE);
                builder.push(Recurrence::Shifted(signed, one));
                next
            }),
            Unary::Atan => {
                let by = self.one_plus_square(a, false);
                self.push(divided(function, by, false))
            }
            Unary::Asin | Unary::Acos => {
                let square = self.one_plus_square(a, true);
                let by = self.push(Recurrence::Root(square));
                self.push(divided(function, by, function == Unary::Acos))
            }
            Unary::Ln => self.push(divided(function, a, false)),
            Unary::Abs | Unary::Sign | Unary::Step | Unary::Table(_) => return None,
        })
    }

    /// The first of the rows that a function of a row needs, which are made where there are none yet.
    fn once(&mut self, function: Unary, a: usize, make: impl FnOnce(&mut Self) -> usize) -> usize {
        let found = self.series.rows.iter().position(
            |row| matches!(row, Recurrence::Grown { function: known, of, .. } if (*known, *of) == (function, a)),
        );
        found.unwrap_or_else(|| make(self))
    }

    /// 1 ± a².
    fn one_plus_square(&mut self, a: usize, falls: bool) -> usize {
        let one = self.constant(Id::ONE);
        let square = self.push(Recurrence::Square(a));
        let square = if falls { self.push(Recurrence::Negative(square)) } else { square };
        self.push(Recurrence::Shifted(square, one))
    }

    fn binary(&mut self, operation: Binary, x: Operand, y: Operand) -> Option<usize> {
        use Operand::{Constant, Row};
        let recurrence = match (operation, x, y) {
            (Binary::Add, Row(a), Row(b)) => Recurrence::Sum(a, b),
            (Binary::Add, Row(a), Constant(c)) | (Binary::Add, Constant(c), Row(a)) => {
                Recurrence::Shifted(a, self.constant(c))
            }
            (Binary::Sub, Row(a), Row(b)) => Recurrence::Difference(a, b),
            (Binary::Sub, Row(a), Constant(c)) => Recurrence::Reduced(a, self.constant(c)),
            (Binary::Sub, Constant(c), Row(a)) => {
                let negative = self.push(Recurrence::Negative(a));
                Recurrence::Shifted(negative, self.constant(c))
            }
            (Binary::Mul, Row(a), Row(b)) if a == b => Recurrence::Square(a),
            (Binary::Mul, Row(a), Row(b)) => Recurrence::Product(a, b),
            (Binary::Mul, Row(a), Constant(c)) | (Binary::Mul, Constant(c), Row(a)) => {
                Recurrence::Scaled(a, self.constant(c))
            }
            (Binary::Div, Row(a), Constant(c)) => Recurrence::Parted(a, self.constant(c)),
            (Binary::Div, x, Row(b)) => Recurrence::Quotient(self.row(x), b),
            (Binary::Pow, Row(a), Constant(c)) => Recurrence::Power(a, self.constant(c)),
            (Binary::Pow, x, Row(b)) => {
                // e^(b ln x).
                let x = self.row(x);
                let logarithm = self.unary(Unary::Ln, x)?;
                let exponent = self.push(Recurrence::Product(logarithm, b));
                return self.unary(Unary::Exp, exponent);
            }
            (Binary::Atan2, y, x) => {
                let (y, x) = (self.row(y), self.row(x));
                let (first, second) = (self.push(Recurrence::Square(y)), self.push(Recurrence::Square(x)));
                Recurrence::Angle { y, x, square: self.push(Recurrence::Sum(first, second)) }
            }
            (Binary::Min | Binary::Max | Binary::Table(_) | Binary::Normal(_), ..) | (_, Constant(_), Constant(_)) => {
                return None;
            }
        };
        Some(self.push(recurrence))
    }
}
