//! What the impulses of a step follow from: rows, rates, and what impulses move.

use super::law::{HELD, Limit, Problem, Side, Solved, Unsolved};
use super::limits::{Force, Forces, sticking};
use crate::cause::Cause;
use crate::integrate::StepFailure;
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{At, Contact, Description, KktSolver, System};

/// A gap below this part of the sum of its terms is closed, as far as rounding tells.
const CLOSED: f64 = 16.0 * f64::EPSILON;
/// So is one below this part of the way that its sides would go in the step: rates of a contact that rests are known to 1e-11, and to 1e-5 where rounds end
/// early, and what it opens and closes by meanwhile is far less than the error of the step.
const GRAZES: f64 = 1e-6;
/// A limit is negative, or that of sticking is smaller than that of sliding, where it is so by more than this part of it.
const WRONG: f64 = 1e-9;

/// A row of J: places and values.
#[derive(Clone, Debug, Default)]
pub(super) struct Row(Vec<(usize, f64)>);

impl Row {
    pub fn dot(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|(i, value)| value * x[*i]).sum()
    }

    /// Σ |J_i| |x_i|.
    fn terms(&self, x: &[f64]) -> f64 {
        self.0.iter().map(|(i, value)| (value * x[*i]).abs()).sum()
    }

    pub fn square(&self) -> f64 {
        self.0.iter().map(|(_, value)| value * value).sum()
    }

    pub fn at(&self, place: usize) -> f64 {
        self.0.iter().find(|(i, _)| *i == place).map_or(0.0, |(_, value)| *value)
    }

    pub fn times(&self, other: &Row) -> f64 {
        self.0.iter().map(|(i, value)| value * other.at(*i)).sum()
    }
}

/// One step before its impulses are known.
pub(super) struct Assembly {
    pub problem: Problem,
    /// The rows of the mechanism that the problem's are.
    pub rows: Vec<usize>,
    /// J of these.
    jacobian: Vec<Row>,
    /// Of each what its impulse does to the speeds.
    responses: Vec<Vec<f64>>,
    /// Rows that always act, and what impulses these have without those of contacts, and by each of them.
    pub lasting: Vec<usize>,
    held: Vec<f64>,
    held_by: Vec<Vec<f64>>,
    /// h, and what it and lasting rows do to the speeds.
    bias: Vec<f64>,
    free: Vec<f64>,
    /// The deepest contact, with its depth.
    pub deepest: Option<(usize, f64)>,
    pub closed: usize,
}

/// The impulses of a step, and what they lead to.
pub(super) struct Found {
    pub impulses: Vec<f64>,
    /// What the step adds to the speeds, and the mean of these and of what they become.
    pub change: Vec<f64>,
    pub mean: Vec<f64>,
    /// Rates of all rows at the end, with what is large beside them and how well the laws were met.
    pub rates: Vec<f64>,
    pub scale: f64,
    pub residual: f64,
    pub rounds: u32,
    pub settled: bool,
}

/// What a step begins with.
pub(super) struct Begin<'a> {
    pub contacts: &'a [Contact],
    /// Coefficients of restitution.
    pub restitutions: &'a [f64],
    /// Rows that always act.
    pub lasting: &'a [usize],
    /// Contacts that stick where it begins.
    pub stuck: &'a [bool],
    pub h: f64,
}

/// What of a contact or friction is not as it should be in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Wrong {
    /// A limit, or a coefficient, is negative.
    Negative {
        /// The first row of the contact.
        row: usize,
        limit: f64,
        is_coefficient: bool,
    },
    /// The limit of sticking is smaller than that of sliding.
    Static {
        /// The first row of the contact.
        row: usize,
        sticking: f64,
        sliding: f64,
        is_coefficient: bool,
    },
    /// A force that is no friction is made of the multiplier of this row.
    Reaction { row: usize },
}

impl Wrong {
    /// Why a run ends by it.
    pub fn cause(self, mechanism: &Description) -> Cause {
        let name = |row: usize| mechanism.rows[row].name.to_string();
        match self {
            Wrong::Negative { row, limit, is_coefficient } => {
                Cause::NegativeLimit { friction: name(row), limit, is_coefficient }
            }
            Wrong::Static { row, sticking, sliding, is_coefficient } => {
                Cause::StaticBelowLimit { friction: name(row), sticking, sliding, is_coefficient }
            }
            Wrong::Reaction { row } => Cause::ForceOfReaction { constraint: name(row) },
        }
    }
}

impl Assembly {
    /// At the middle of a step from speeds v, `at` having the place in the middle.
    pub fn new(
        system: &mut dyn System,
        solver: &mut KktSolver,
        at: At<'_>,
        begin: &Begin<'_>,
    ) -> Result<Assembly, StepFailure> {
        let triples = constraint_triples(system, at);
        let sparse = rows_of(system, at);
        let row = |row: usize| sparse[row].clone();
        let forces = Forces::new(system, at, begin.contacts, &row);
        if let Some(row) = forces.reaction {
            return Err(StepFailure::Contacts(Wrong::Reaction { row }));
        }
        solver.factor_rows(system, at, begin.lasting)?;
        let mut free: Vec<f64> = forces.bias.iter().map(|h| -begin.h * h).collect();
        let mut held: Vec<f64> = begin.lasting.iter().map(|row| -triples[*row][1]).collect();
        solver.solve(&mut free, &mut held);
        let mut assembly = Assembly {
            problem: Problem::default(),
            rows: Vec::new(),
            jacobian: Vec::new(),
            responses: Vec::new(),
            lasting: begin.lasting.to_vec(),
            held,
            held_by: Vec::new(),
            bias: forces.bias.clone(),
            free,
            deepest: None,
            closed: 0,
        };
        assembly.gather(begin, &triples, &sparse);
        assembly.respond(system, solver, at, &triples);
        assembly.limit(system, at, begin, &forces, &triples)?;
        Ok(assembly)
    }

    /// Takes forces at other speeds, those of the middle; false where they are the same.
    pub fn with_speeds(
        &mut self,
        system: &mut dyn System,
        solver: &mut KktSolver,
        at: At<'_>,
        begin: &Begin<'_>,
    ) -> bool {
        let known = |row: usize| {
            self.rows.iter().position(|known| *known == row).map_or_else(Row::default, |k| self.jacobian[k].clone())
        };
        let bias = Forces::new(system, at, begin.contacts, &known).bias;
        if bias == self.bias {
            return false;
        }
        let mut change: Vec<f64> = bias.iter().zip(&self.bias).map(|(new, old)| -begin.h * (new - old)).collect();
        let mut held = vec![0.0; self.lasting.len()];
        solver.solve(&mut change, &mut held);
        self.problem.free.iter_mut().zip(&self.jacobian).for_each(|(free, row)| *free += row.dot(&change));
        self.free.iter_mut().zip(&change).for_each(|(free, change)| *free += change);
        self.held.iter_mut().zip(held).for_each(|(held, more)| *held += more);
        self.bias = bias;
        true
    }

    /// The sides that take part, with their rows.
    fn gather(&mut self, begin: &Begin<'_>, triples: &[[f64; 3]], sparse: &[Row]) {
        for (k, contact) in begin.contacts.iter().enumerate() {
            if let Some(row) = contact.normal.map(|row| row as usize) {
                let [gap, rate, terms] = triples[row];
                let way = begin.h * (rate + sparse[row].dot(&self.free));
                if gap > (CLOSED * terms).max(-GRAZES * way) {
                    continue;
                }
                self.closed += 1;
                let depth = (-gap).max(0.0);
                if self.deepest.is_none_or(|(_, known)| depth > known) {
                    self.deepest = Some((k, depth));
                }
            }
            let normal = contact.normal.map(|row| {
                self.rows.push(row as usize);
                self.rows.len() - 1
            });
            let tangent = self.rows.len();
            self.rows.extend(contact.tangents().map(|row| row as usize));
            let count = self.rows.len() - tangent;
            let place = contact.restitution.map(|place| place as usize);
            let restitution = place.and_then(|place| begin.restitutions.get(place)).copied().unwrap_or(0.0);
            let (sliding, sticking) = (Limit::default(), Limit::default());
            let stuck = begin.stuck[k];
            self.problem.sides.push(Side { contact: k, normal, tangent, count, restitution, stuck, sliding, sticking });
        }
        self.jacobian = self.rows.iter().map(|row| sparse[*row].clone()).collect();
    }

    /// What impulses do.
    fn respond(&mut self, system: &dyn System, solver: &mut KktSolver, at: At<'_>, triples: &[[f64; 3]]) {
        let (mut inertia, n) = (vec![0.0; system.len()], system.len());
        system.inertias(at, &mut Vec::new(), &mut inertia);
        for row in &self.jacobian {
            let mut response = vec![0.0; n];
            row.0.iter().for_each(|(i, value)| response[*i] = *value);
            let mut held = vec![0.0; self.lasting.len()];
            solver.solve(&mut response, &mut held);
            self.responses.push(response);
            self.held_by.push(held);
        }
        let problem = &mut self.problem;
        problem.before = self.rows.iter().map(|row| triples[*row][1]).collect();
        problem.free = self.jacobian.iter().zip(&problem.before).map(|(row, u)| u + row.dot(&self.free)).collect();
        problem.terms = self.jacobian.iter().map(|row| row.terms(at.v) + row.terms(&self.free)).collect();
        let moved = |response: &Vec<f64>| {
            let effects = self.jacobian.iter().map(|row| row.dot(response)).enumerate();
            effects.filter(|(_, effect)| *effect != 0.0).collect::<Vec<_>>()
        };
        problem.moves = self.responses.iter().map(moved).collect();
        let own = |(k, row): (usize, &Row)| {
            // What the row would move by itself, were there no other coordinate beside those that it moves.
            let alone: f64 = row.0.iter().filter(|(i, _)| inertia[*i] > 0.0).map(|(i, x)| x * x / inertia[*i]).sum();
            let own = problem.moves[k].iter().find(|(other, _)| *other == k).map_or(0.0, |(_, effect)| *effect);
            if own > HELD * alone { own } else { 0.0 }
        };
        problem.own = self.jacobian.iter().enumerate().map(own).collect();
    }

    /// The limits of friction.
    fn limit(
        &mut self,
        system: &mut dyn System,
        at: At<'_>,
        begin: &Begin<'_>,
        forces: &Forces,
        triples: &[[f64; 3]],
    ) -> Result<(), StepFailure> {
        let rubs = self.problem.sides.iter().any(|side| side.count > 0);
        if !rubs {
            return Ok(());
        }
        let sticks = Sticking::new(system, at, begin.contacts, forces, self);
        for place in 0..self.problem.sides.len() {
            let side = &self.problem.sides[place];
            let contact = &begin.contacts[side.contact];
            if side.count == 0 {
                continue;
            }
            let slides = match forces.frictions.iter().find(|(k, _)| *k == side.contact) {
                Some((_, force)) => force.clone(),
                None => {
                    let mut sliding = [0.0; 2];
                    sliding.iter_mut().zip(contact.tangents()).for_each(|(s, row)| *s = triples[row as usize][1]);
                    let rows = &self.jacobian[side.tangents()];
                    forces.of_contact(system, at, (side.contact, contact), (rows, sliding))
                }
            };
            let sticks = sticks.of(side.contact, contact, &slides);
            if let Some(normal) = contact.normal.map(|row| row as usize) {
                possible(normal, slides.of(normal), sticks.of(normal), true)?;
            }
            let of_row = |row: usize| self.impulse_of(row);
            let [sliding, sticking] = [&slides, &sticks].map(|force| force.over(begin.h, &of_row));
            let side = &mut self.problem.sides[place];
            (side.sliding, side.sticking) = (sliding, sticking);
        }
        Ok(())
    }

    /// The impulse of a row of the mechanism by those of the step; nothing for rows of open contacts.
    fn impulse_of(&self, row: usize) -> Limit {
        if let Some(place) = self.rows.iter().position(|known| *known == row) {
            return Limit { own: 0.0, of_rows: vec![(place, 1.0)] };
        }
        let Some(k) = self.lasting.iter().position(|known| *known == row) else { return Limit::default() };
        let parts = self.held_by.iter().enumerate().map(|(place, held)| (place, held[k]));
        Limit { own: self.held[k], of_rows: parts.filter(|(_, part)| *part != 0.0).collect() }
    }

    /// Refuses limits of frictions that are none with the impulses that were found.
    pub fn possible_limits(&self, h: f64, impulses: &[f64]) -> Result<(), StepFailure> {
        for side in self.problem.sides.iter().filter(|side| side.normal.is_none()) {
            let [sliding, sticking] = [&side.sliding, &side.sticking].map(|limit| limit.at(impulses) / h);
            // What rounding makes of a limit that vanishes is none.
            let rounding = WRONG * side.sliding.terms(impulses) / h;
            if sliding < -rounding || sticking < sliding - rounding {
                possible(self.rows[side.tangent], sliding, sticking, false)?;
            }
        }
        Ok(())
    }

    /// The impulses of a step from speeds v, from a guess on.
    pub fn found(&self, v: &[f64], guess: Vec<f64>) -> Result<Found, StepFailure> {
        let mut impulses = guess;
        let solved = self.problem.solve(&mut impulses).map_err(|unsolved| {
            let side = self.problem.sides.iter().find(|side| side.contact == unsolved.contact);
            let row = side.map_or(0, |side| self.rows[side.normal.unwrap_or(side.tangent)]);
            StepFailure::Unsolved(Unsolved { contact: row, ..unsolved })
        })?;
        let settled = solved.is_settled();
        let Solved { rates, scale, residual, rounds } = solved;
        let change = self.change(&impulses);
        let mean = v.iter().zip(&change).map(|(v, change)| v + 0.5 * change).collect();
        Ok(Found { impulses, change, mean, rates, scale, residual, rounds, settled })
    }

    /// What a step with these impulses adds to the speeds.
    fn change(&self, impulses: &[f64]) -> Vec<f64> {
        let mut change = self.free.clone();
        for (response, impulse) in self.responses.iter().zip(impulses).filter(|(_, impulse)| **impulse != 0.0) {
            change.iter_mut().zip(response).for_each(|(change, effect)| *change += effect * impulse);
        }
        change
    }

    /// The impulses of the rows that always act.
    pub fn held(&self, impulses: &[f64]) -> Vec<f64> {
        let mut held = self.held.clone();
        for (by, impulse) in self.held_by.iter().zip(impulses) {
            held.iter_mut().zip(by).for_each(|(held, effect)| *held += effect * impulse);
        }
        held
    }

    /// Σ P · J v for speeds v, J.
    pub fn work(&self, impulses: &[f64], v: &[f64]) -> f64 {
        self.jacobian.iter().zip(impulses).map(|(row, impulse)| impulse * row.dot(v)).sum()
    }
}

/// All rows of J.
pub(super) fn rows_of(system: &dyn System, at: At<'_>) -> Vec<Row> {
    let pattern = &system.description().constraint_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.constraint_matrix(at, &mut values);
    let mut rows = vec![Row::default(); system.description().rows.len()];
    for ((row, column), value) in pattern.iter().zip(values).filter(|(_, value)| *value != 0.0) {
        rows[*row as usize].0.push((*column as usize, value));
    }
    rows
}

/// Refuses a limit with which friction would drive, and one of sticking that is smaller than that of sliding.
fn possible(row: usize, sliding: f64, sticking: f64, is_coefficient: bool) -> Result<(), StepFailure> {
    if sliding < 0.0 {
        return Err(StepFailure::Contacts(Wrong::Negative { row, limit: sliding, is_coefficient }));
    }
    if sticking < sliding * (1.0 - WRONG) {
        return Err(StepFailure::Contacts(Wrong::Static { row, sticking, sliding, is_coefficient }));
    }
    Ok(())
}

/// Limits of sticking.
struct Sticking {
    /// Of each contact with a force of 1 across every contact; of frictions without any.
    contacts: Vec<f64>,
    frictions: Vec<f64>,
    /// What the multiplier of a row adds to those of frictions, where any depends on some.
    by_row: Vec<(usize, Vec<f64>)>,
}

impl Sticking {
    fn new(system: &dyn System, at: At<'_>, contacts: &[Contact], forces: &Forces, assembly: &Assembly) -> Sticking {
        let mut lambda = vec![0.0; system.description().rows.len()];
        let none = if forces.frictions.is_empty() { Vec::new() } else { sticking(system, at, contacts, &lambda) };
        contacts.iter().filter_map(|contact| contact.normal).for_each(|row| lambda[row as usize] = 1.0);
        let pressed = sticking(system, at, contacts, &lambda);
        let mut by_row = Vec::new();
        if !none.is_empty() {
            assembly.lasting.iter().for_each(|row| lambda[*row] = 1.0);
            let all = sticking(system, at, contacts, &lambda);
            let depends = forces.frictions.iter().any(|(k, _)| all[*k] != none[*k]);
            let normals =
                assembly.problem.sides.iter().filter_map(|side| side.normal).map(|place| assembly.rows[place]);
            let rows: Vec<usize> = if depends { normals.chain(assembly.lasting.clone()).collect() } else { Vec::new() };
            for row in rows {
                lambda.fill(0.0);
                let [pushed, pulled] = [1.0, -1.0].map(|sign| {
                    lambda[row] = sign;
                    sticking(system, at, contacts, &lambda)
                });
                let slope = |k: usize| match none[k] {
                    // Of |s λ| the sign is not known: it is that of the limit of sliding.
                    0.0 => pushed[k] * forces.sign_of(k, row),
                    own => 0.25 * (pushed[k].powi(2) - pulled[k].powi(2)) / own,
                };
                by_row.push((row, (0..contacts.len()).map(slope).collect()));
            }
        }
        Sticking { contacts: pressed, frictions: none, by_row }
    }

    fn of(&self, k: usize, contact: &Contact, slides: &Force) -> Force {
        let Some(normal) = contact.normal.map(|row| row as usize) else {
            let of_rows = self.by_row.iter().map(|(row, parts)| (*row, parts[k])).filter(|(_, part)| *part != 0.0);
            return Force { own: self.frictions[k], of_rows: of_rows.collect() };
        };
        let own = (normal, self.contacts[k]);
        // A coefficient knows no other force than the one across.
        let others = slides.of_rows.iter().filter(|(row, _)| *row != normal).copied();
        Force { own: 0.0, of_rows: std::iter::once(own).chain(others).collect() }
    }
}
