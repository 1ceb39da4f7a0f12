//! The motion at a state: inputs, modes, and the accelerations with the scale of their errors.

use std::collections::HashMap;

use super::dense::{Deficient, factor, solve};
use super::elimination::Elimination;
use super::rows::{Constraints, Held, RoughlyHeld};
use super::state::State;
use crate::derive::elimination::Eliminated;
use crate::derive::{Equations, Rows, Switch, rates, without_modes};
use crate::expr::{Id, Measured, Symbol, Tape};
use crate::model::{Coordinate, Model};
use crate::number::DoubleDouble;

/// Lagrange's equations of a model, ready to evaluate anywhere.
pub(super) struct Motion {
    /// How many coordinates there are.
    pub n: usize,
    /// The first of the four numbers of each rotation.
    rotations: Vec<usize>,
    /// The first coordinate with the unit of each.
    pub alike: Vec<usize>,
    inputs: Vec<Tape>,
    /// Held values at the start.
    memory: Tape,
    /// Values of all modes, from the true functions, so that what their arguments share is evaluated once.
    modes: Tape,
    /// In the place of all that M is needed for, where it is not formed.
    elimination: Option<Elimination>,
    /// M's entries, then h.
    equations: Tape,
    places: Vec<(usize, usize)>,
    /// Coordinates that M couples.
    blocks: Vec<Vec<usize>>,
    /// Coordinates, and rows of constraints as numbers from n on, that M and constraints couple.
    pub coupled: Vec<Vec<usize>>,
    /// The constraints.
    pub constraints: Constraints,
}

/// Why a state has no motion.
pub(super) enum Incomplete {
    /// Something is infinite or undefined there.
    NotFinite,
    /// M is singular: so many combinations of the coordinates move nothing, and these take part in them.
    Singular {
        /// The rank of M.
        rank: usize,
        /// The coordinates.
        coordinates: Vec<usize>,
    },
}

/// A determinant of three coordinates, each in its own measure, that is 0: some thousand roundings of M's elements.
const SINGULAR: f64 = 1e-12;
/// A rate that changes by less than this part of its terms is kept.
const KEPT: f64 = 1e-9;

impl Motion {
    /// For equations by any derivation, by elimination where M is not formed.
    pub fn new(
        model: &mut Model,
        (equations, eliminated): (&Equations, Option<&Eliminated>),
        rows: &Rows,
        switches: &[Switch],
    ) -> Motion {
        let constraints = Constraints::new(model, rows, equations);
        let graph = &mut model.graph;
        let inputs = model
            .inputs
            .iter()
            .map(|input| {
                let third = rates(graph, &[input.signal[2]])[0];
                Tape::new(graph, &[input.signal.as_slice(), &[third]].concat())
            })
            .collect();
        let starts: Vec<Id> = model.memory.iter().map(|held| held.start).collect();
        let modes: Vec<Id> = (0..switches.len()).map(|k| graph.symbol(Symbol::Mode(k as u32))).collect();
        let modes = without_modes(graph, &modes, switches);
        let n = model.coordinates.len();
        let mass = equations.mass.iter();
        let roots: Vec<Id> = mass.clone().map(|e| e.2).chain(equations.bias.iter().copied()).collect();
        let places: Vec<(usize, usize)> = mass.map(|e| (e.0, e.1)).collect();
        Motion {
            n,
            rotations: model.rotations.iter().map(|rotation| rotation.first).collect(),
            alike: alike(&model.coordinates),
            inputs,
            memory: Tape::new(graph, &starts),
            modes: Tape::new(graph, &modes),
            elimination: eliminated.map(|eliminated| Elimination::new(graph, eliminated, equations)),
            equations: Tape::new(graph, &roots),
            blocks: blocks(n, &places),
            coupled: if eliminated.is_some() {
                Vec::new()
            } else {
                blocks(n + constraints.len(), &[places.as_slice(), &constraints.couplings()].concat())
            },
            places,
            constraints,
        }
    }

    /// Whether some rates of three coordinates, each of which moves a mass by itself, move none: the determinant of their part of M, each in
    /// its own measure, is 0 but for the rounding of M's elements in `f64`.  Nothing is said where constraints act.
    pub fn is_singular_among(&self, state: &State, coordinates: [usize; 3]) -> bool {
        if !self.constraints.active(state.phase).is_empty() {
            return false;
        }
        let masses = match &self.elimination {
            Some(elimination) => elimination.masses_among(state, coordinates),
            None => self.masses_among(state, coordinates),
        };
        let size: [f64; 3] = std::array::from_fn(|k| masses[k][k].sqrt());
        let scaled = |a: usize, b: usize| masses[a][b] / (size[a] * size[b]);
        let (x, y, z) = (scaled(0, 1), scaled(0, 2), scaled(1, 2));
        let determinant = 1.0 + 2.0 * x * y * z - x * x - y * y - z * z;
        determinant.abs() < SINGULAR
    }

    /// M among some coordinates, row by row.
    fn masses_among<const N: usize>(&self, state: &State, coordinates: [usize; N]) -> [[f64; N]; N] {
        let values = self.equations.evaluate(|s| state.value(s));
        let element = |i: usize, j: usize| {
            let place = self.places.iter().position(|place| *place == (i.max(j), i.min(j)));
            place.map_or(0.0, |k| values[k].to_f64())
        };
        coordinates.map(|i| coordinates.map(|j| element(i, j)))
    }

    /// Operations of one evaluation, to bound work by.
    pub fn work(&self) -> usize {
        if let Some(elimination) = &self.elimination {
            return elimination.work();
        }
        let cubes: usize = self.coupled.iter().map(|block| block.len().pow(3) / 3).sum();
        self.equations.operations() + cubes + self.n
    }

    /// Inputs and modes at a state's time, coordinates and speeds.
    pub fn prepare(&self, state: &mut State) {
        self.signals(state);
        state.modes = self.modes.evaluate(|s| state.value(s)).iter().map(|mode| mode.to_f64()).collect();
    }

    /// Inputs at a state's time, for what contains true functions and no modes; held values as at the start where nobody drew them.
    pub fn signals(&self, state: &mut State) {
        if state.memory.is_empty() {
            state.memory = self.memory.evaluate(|s| state.value(s).to_f64());
        }
        state.inputs.clear();
        for tape in &self.inputs {
            let u = tape.evaluate(|s| state.value(s));
            state.inputs.push([u[0], u[1], u[2], u[3]]);
        }
    }

    /// Gives the quaternions of a state the lengths that they have in another.
    pub fn keep_lengths(&self, state: &mut State, other: &State) {
        for numbers in self.rotations.iter().map(|first| *first..first + 4) {
            let square =
                |state: &State| state.q[numbers.clone()].iter().fold(DoubleDouble::ZERO, |sum, x| sum + *x * *x);
            let (own, other) = (square(state), square(other));
            if own != other && own > DoubleDouble::ZERO {
                let factor = (other / own).sqrt();
                state.q[numbers].iter_mut().for_each(|x| *x = *x * factor);
            }
        }
    }

    /// Brings a state, whose inputs are there, to the constraints of its phase: false where it cannot be.
    pub fn close(&self, state: &mut State) -> bool {
        self.constraints.active(state.phase).is_empty() || self.constraints.close(state)
    }

    /// The same where a state that was brought there has since had one coordinate or its speed changed.
    pub fn close_after(&self, state: &mut State, changed: usize) -> bool {
        self.constraints.active(state.phase).is_empty() || self.constraints.close_after(state, changed)
    }

    /// Brings a state to the constraints of its phase, and fills in inputs and modes: false where it cannot be.
    pub fn place(&self, state: &mut State) -> bool {
        self.signals(state);
        state.lambda.clear();
        if !self.close(state) {
            return false;
        }
        self.prepare(state);
        true
    }

    /// Brings a state to where its phase may be, and fills in inputs, modes, accelerations and multipliers.
    pub fn complete(&self, state: &mut State) -> Result<(), Incomplete> {
        if !self.place(state) || !self.constraints.meet_contacts(state) {
            return Err(Incomplete::NotFinite);
        }
        self.accelerate(state)
    }

    /// Fills in accelerations and multipliers at a state that is where its phase may be.
    pub fn accelerate(&self, state: &mut State) -> Result<(), Incomplete> {
        if !self.constraints.is_empty() {
            self.prepare(state);
            return self.constrained(state);
        }
        if let Some(elimination) = &self.elimination {
            return elimination.complete(state);
        }
        let values = self.equations.measured(|s| state.value(s));
        if values.iter().any(|x| !x.value.is_finite() || !x.magnitude.is_finite()) {
            return Err(Incomplete::NotFinite);
        }
        let (mass, bias) = values.split_at(self.places.len());
        state.a = vec![Measured::exact(DoubleDouble::ZERO); self.n];
        let mut rank = self.n;
        let mut coordinates = Vec::new();
        for block in &self.blocks {
            if let Err(Deficient { rank: of, columns }) = self.block(block, mass, bias, &mut state.a) {
                rank -= block.len() - of;
                coordinates.extend(columns.iter().map(|k| block[*k]));
            }
        }
        match coordinates.is_empty() {
            true => Ok(()),
            false => Err(Incomplete::Singular { rank, coordinates }),
        }
    }

    /// Accelerations and multipliers: M a − (Jᵀ + B) λ = −h, J a = −γ with rows that are independent here.
    fn constrained(&self, state: &mut State) -> Result<(), Incomplete> {
        let values = self.equations.evaluate(|s| state.measured(s));
        let (rank, mut order) = self.constraints.rank(state);
        order.truncate(rank);
        let held = self.constraints.held(state, order);
        let zero = Measured::exact(DoubleDouble::ZERO);
        (state.a, state.lambda) = (vec![zero; self.n], vec![zero; self.constraints.len()]);
        self.solve_held(&values, &held, (&mut state.a, &mut state.lambda))
    }

    /// Δq' of impulses along some rows of the constraints, M Δq' = Jᵀ P, after which the rate of each has changed by so much;
    /// `None` where that is undetermined.
    pub fn velocity_jump(&self, state: &State, rows: &[(usize, f64)]) -> Option<Vec<Measured>> {
        let (zero, changed): (_, Vec<usize>) =
            (Measured::exact(DoubleDouble::ZERO), rows.iter().map(|r| r.0).collect());
        let mut values = self.equations.measured(|s| state.value(s));
        values[self.places.len()..].fill(zero);
        let mut held = self.constraints.held(state, changed);
        held.friction.clear();
        held.bias = rows.iter().map(|(_, change)| Measured::exact(DoubleDouble::from(-change))).collect();
        let (mut change, mut impulses) = (vec![zero; self.n], vec![zero; self.constraints.len()]);
        self.solve_held(&values, &held, (&mut change, &mut impulses)).is_ok().then_some(change)
    }

    /// M a − (Jᵀ + B) λ = −h, J a = −γ, block by block.
    fn solve_held(
        &self,
        values: &[Measured],
        held: &Held,
        (a, lambda): (&mut [Measured], &mut [Measured]),
    ) -> Result<(), Incomplete> {
        if values.iter().chain(&held.matrix).chain(&held.bias).any(|x| !x.value.is_finite() || !x.magnitude.is_finite())
        {
            return Err(Incomplete::NotFinite);
        }
        let (mut rank, mut singular) = (0, Vec::new());
        for block in &self.coupled {
            let coordinates: Vec<usize> = block.iter().copied().take_while(|i| *i < self.n).collect();
            let rows: Vec<usize> =
                block.iter().filter_map(|i| held.rows.iter().position(|row| row + self.n == *i)).collect();
            match self.held_block(&coordinates, &rows, values, held) {
                Ok(found) => {
                    rank += coordinates.len();
                    let (moving, holding) = found.split_at(coordinates.len());
                    coordinates.iter().zip(moving).for_each(|(i, x)| a[*i] = *x);
                    rows.iter().zip(holding).for_each(|(k, x)| lambda[held.rows[*k]] = *x);
                }
                Err(Deficient { rank: of, columns }) => {
                    rank += of.saturating_sub(rows.len());
                    let last = coordinates.len().saturating_sub(1);
                    singular.extend(columns.into_iter().map(|k| coordinates[k.min(last)]));
                }
            }
        }
        match singular.is_empty() {
            true => Ok(()),
            false => Err(Incomplete::Singular { rank, coordinates: singular }),
        }
    }

    /// Accelerations of some coordinates, then multipliers of the rows that hold them (by their places in `held`).
    fn held_block(
        &self,
        coordinates: &[usize],
        rows: &[usize],
        values: &[Measured],
        held: &Held,
    ) -> Result<Vec<Measured>, Deficient> {
        let (mass, bias) = values.split_at(self.places.len());
        let (n, size) = (coordinates.len(), coordinates.len() + rows.len());
        let zero = Measured::exact(DoubleDouble::ZERO);
        let mut matrix = vec![zero; size * size];
        let within = |i: &usize| coordinates.binary_search(i).ok();
        for ((i, j), x) in self.places.iter().zip(mass) {
            if let (Some(i), Some(j)) = (within(i), within(j)) {
                matrix[i * size + j] = *x;
                matrix[j * size + i] = *x;
            }
        }
        for (k, row) in rows.iter().enumerate() {
            for (i, coordinate) in coordinates.iter().enumerate() {
                let x = held.matrix[row * self.n + coordinate];
                matrix[(n + k) * size + i] = x;
                matrix[i * size + n + k] = Measured { value: -x.value, magnitude: x.magnitude };
            }
        }
        for (i, row, x) in &held.friction {
            // h has −B λ in it.
            if let (Some(i), Some(k)) = (within(i), rows.iter().position(|r| r == row)) {
                let entry = &mut matrix[i * size + n + k];
                *entry = Measured { value: entry.value + x.value, magnitude: entry.magnitude + x.magnitude };
            }
        }
        let right: Vec<Measured> =
            coordinates.iter().map(|i| bias[*i]).chain(rows.iter().map(|k| held.bias[*k])).collect();
        // Each unknown in its own measure: masses are 1 then, and rows of J.
        let own = measures(&matrix, n, size);
        let by = |x: &Measured, measure: f64| Measured { value: x.value * measure, magnitude: x.magnitude * measure };
        let right: Vec<Measured> = right.iter().zip(&own).map(|(x, d)| by(x, *d)).collect();
        let scaled = matrix.iter().enumerate().map(|(k, x)| by(x, own[k / size] * own[k % size]));
        let (numbers, sizes): (Vec<DoubleDouble>, Vec<f64>) = scaled.map(|x| (x.value, x.magnitude)).unzip();
        let factored = factor(&numbers, &sizes, size)?;
        let right_side: Vec<DoubleDouble> = right.iter().map(|x| -x.value).collect();
        let (found, known) = factored.refined(&numbers, &right_side);
        let errors: Vec<f64> = (0..size)
            .map(|i| {
                let moving: f64 = (0..size).map(|j| sizes[i * size + j] * known[j]).sum();
                moving + right[i].magnitude
            })
            .collect();
        let spread = factored.spread(&errors);
        let measured = |k: usize| Measured { value: found[k], magnitude: spread[k].max(known[k]) };
        // What constraints hold still is still because its forces cancel: these are its terms.
        let terms = |i: usize| {
            let held: f64 = (n..size).map(|k| sizes[i * size + k] * known[k]).sum();
            let inertia = sizes[i * size + i];
            if inertia > 0.0 { (right[i].magnitude + held) / inertia } else { 0.0 }
        };
        let moving = |i: usize| Measured { magnitude: measured(i).magnitude.max(terms(i)), ..measured(i) };
        let found = (0..n).map(moving).chain((n..size).map(measured));
        Ok(found.zip(&own).map(|(x, d)| by(&x, *d)).collect())
    }

    /// The accelerations of one block: −M⁻¹h, and |a| + |M⁻¹|(m(M)|a| + m(h)).
    fn block(
        &self,
        block: &[usize],
        mass: &[Measured],
        bias: &[Measured],
        a: &mut [Measured],
    ) -> Result<(), Deficient> {
        let n = block.len();
        let within = |i: usize| block.binary_search(&i).ok();
        let mut matrix = vec![DoubleDouble::ZERO; n * n];
        let mut sizes = vec![0.0; n * n];
        for ((i, j), m) in self.places.iter().zip(mass) {
            let (Some(i), Some(j)) = (within(*i), within(*j)) else { continue };
            for k in [i * n + j, j * n + i] {
                matrix[k] = m.value;
                sizes[k] = m.magnitude;
            }
        }
        let factored = factor(&matrix, &sizes, n)?;
        let right: Vec<DoubleDouble> = block.iter().map(|&i| -bias[i].value).collect();
        let (found, known) = factored.refined(&matrix, &right);
        let errors: Vec<f64> = (0..n)
            .map(|i| {
                let moving: f64 = (0..n).map(|j| sizes[i * n + j] * known[j]).sum();
                moving + bias[block[i]].magnitude
            })
            .collect();
        for (k, spread) in factored.spread(&errors).into_iter().enumerate() {
            a[block[k]] = Measured { value: found[k], magnitude: spread.max(known[k]) };
        }
        Ok(())
    }

    /// Accelerations in `f64`, for a coarse run: false where there are none.
    pub fn roughly(&self, rough: &mut Rough) -> bool {
        let Rough { at, a, lambda, scratch, values } = rough;
        if at.memory.is_empty() {
            at.memory = self.memory.evaluate(|s| at.value(s));
        }
        at.inputs.clear();
        for tape in &self.inputs {
            let mut u = [0.0; 4];
            tape.run(|s| at.value(s), scratch, &mut u);
            at.inputs.push(u);
        }
        let mut modes = std::mem::take(&mut at.modes);
        modes.resize(self.modes.len(), 0.0);
        self.modes.run(|s| at.value(s), scratch, &mut modes);
        at.modes = modes;
        if let Some(elimination) = &self.elimination {
            let found = elimination.roughly(|s| at.value(s), (scratch, values));
            a.copy_from_slice(&values[..self.n]);
            return found;
        }
        values.resize(self.equations.len(), 0.0);
        self.equations.run(|s| at.value(s), scratch, values);
        let (mass, bias) = values.split_at(self.places.len());
        let active = self.constraints.active(at.phase);
        if active.is_empty() {
            lambda.fill(0.0);
            let found = self.blocks.iter().all(|block| self.rough_block(block, mass, bias, a));
            return found && a.iter().all(|x| x.is_finite());
        }
        let held = self.constraints.roughly(active, |s| at.value(s));
        let right = bias.iter().chain(&held.bias).map(|x| -x).collect();
        let Some(found) = self.rough_saddle(mass, &held, right) else { return false };
        a.copy_from_slice(&found[..self.n]);
        lambda.clear();
        lambda.resize(self.constraints.len(), 0.0);
        held.rows.iter().zip(&found[self.n..]).for_each(|(row, x)| lambda[*row] = *x);
        found.iter().all(|x| x.is_finite())
    }

    /// The change of the speeds by impulses along constraints (those of the phase, and further rows) after which each of
    /// their rates is `keeps(row)` times what it was; at a state whose accelerations were computed.
    pub fn kick(&self, rough: &Rough, further: &[usize], keeps: impl Fn(usize) -> f64) -> Option<Kick> {
        let active = self.constraints.active(rough.at.phase).iter().chain(further).copied().collect::<Vec<usize>>();
        let mut held = self.constraints.roughly(&active, |s| rough.value(s));
        held.friction.clear();
        let jumps = held.rows.iter().zip(&held.rate).map(|(row, rate)| (keeps(*row) - 1.0) * rate);
        let right: Vec<f64> = std::iter::repeat_n(0.0, self.n).chain(jumps).collect();
        let lines = held.matrix.chunks(self.n.max(1)).zip(&right[self.n..]);
        let counts = |(line, jump): (&[f64], &f64)| {
            let size: f64 = line.iter().zip(&rough.at.v).map(|(x, v)| (x * v).abs()).sum();
            jump.abs() > KEPT * size
        };
        let counted = lines.map(counts).zip(&held.rows).zip(&right[self.n..]);
        let rows = counted.map(|((counts, row), jump)| (*row, if counts { *jump } else { 0.0 })).collect();
        let mut speeds = self.rough_saddle(&rough.values[..self.places.len()], &held, right)?;
        speeds.truncate(self.n);
        speeds.iter().all(|x| x.is_finite()).then_some(Kick { speeds, rows })
    }

    /// M x − (Jᵀ + B) y = the first n of `right`, J x = the others.
    fn rough_saddle(&self, mass: &[f64], held: &RoughlyHeld, right: Vec<f64>) -> Option<Vec<f64>> {
        let (n, size) = (self.n, right.len());
        let mut matrix = vec![0.0; size * size];
        for ((i, j), m) in self.places.iter().zip(mass) {
            matrix[i * size + j] = *m;
            matrix[j * size + i] = *m;
        }
        for (k, line) in held.matrix.chunks(n.max(1)).enumerate() {
            for (i, x) in line.iter().enumerate() {
                matrix[(n + k) * size + i] = *x;
                matrix[i * size + n + k] = -x;
            }
        }
        held.friction.iter().for_each(|(i, k, x)| matrix[i * size + n + k] += x);
        solve(matrix, right)
    }

    fn rough_block(&self, block: &[usize], mass: &[f64], bias: &[f64], a: &mut [f64]) -> bool {
        let n = block.len();
        let mut matrix = vec![0.0; n * n];
        for ((i, j), m) in self.places.iter().zip(mass) {
            if let (Ok(i), Ok(j)) = (block.binary_search(i), block.binary_search(j)) {
                matrix[i * n + j] = *m;
                matrix[j * n + i] = *m;
            }
        }
        let force = block.iter().map(|&i| -bias[i]).collect();
        let found = solve(matrix, force);
        found.iter().for_each(|found| block.iter().zip(found).for_each(|(&i, x)| a[i] = *x));
        found.is_some()
    }
}

/// The first coordinate with the unit of each, as it is written.
fn alike(coordinates: &[Coordinate]) -> Vec<usize> {
    let mut firsts = HashMap::new();
    coordinates.iter().enumerate().map(|(i, coordinate)| *firsts.entry(&coordinate.unit).or_insert(i)).collect()
}

/// What an instant does to the speeds.
pub(super) struct Kick {
    /// Their changes.
    pub speeds: Vec<f64>,
    /// Rows of the constraints that push, and how much the rate of each changes.
    pub rows: Vec<(usize, f64)>,
}

/// A state in `f64` with room to compute in.
pub(super) struct Rough {
    pub at: Point,
    /// Accelerations.
    pub a: Vec<f64>,
    /// Multipliers of all rows; 0 for those that do not act.
    lambda: Vec<f64>,
    scratch: Vec<f64>,
    values: Vec<f64>,
}

/// What accelerations depend on.
pub(super) struct Point {
    pub parameters: Vec<f64>,
    pub t: f64,
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub phase: usize,
    memory: Vec<f64>,
    inputs: Vec<[f64; 4]>,
    modes: Vec<f64>,
}

impl Rough {
    /// At rest at the origin.
    pub fn new(parameters: Vec<f64>, n: usize, phase: usize) -> Rough {
        let zeros = || vec![0.0; n];
        let (inputs, modes, memory) = (Vec::new(), Vec::new(), Vec::new());
        let at = Point { parameters, t: 0.0, q: zeros(), v: zeros(), phase, memory, inputs, modes };
        Rough { at, a: zeros(), lambda: Vec::new(), scratch: Vec::new(), values: Vec::new() }
    }

    /// A symbol's value, where accelerations were computed.
    pub fn value(&self, s: Symbol) -> f64 {
        match s {
            Symbol::Acceleration(i) => self.a.get(i as usize).copied().unwrap_or(0.0),
            Symbol::Multiplier(k) => self.lambda.get(k as usize).copied().unwrap_or(0.0),
            _ => self.at.value(s),
        }
    }
}

impl Point {
    /// The same in double-double, without its motion.
    pub fn state(&self) -> State {
        let doubles = |list: &[f64]| list.iter().map(|x| (*x).into()).collect();
        let mut state = State::at_rest(self.parameters.clone(), self.q.len());
        (state.t, state.q, state.v, state.phase) = (self.t.into(), doubles(&self.q), doubles(&self.v), self.phase);
        state
    }

    fn value(&self, s: Symbol) -> f64 {
        let at = |list: &[f64], i: u32| list.get(i as usize).copied().unwrap_or(0.0);
        match s {
            Symbol::Time => self.t,
            Symbol::Coordinate(i) => at(&self.q, i),
            Symbol::Speed(i) => at(&self.v, i),
            Symbol::Input(k, order) => {
                self.inputs.get(k as usize).and_then(|u| u.get(usize::from(order))).copied().unwrap_or(0.0)
            }
            Symbol::Parameter(i) => at(&self.parameters, i),
            Symbol::Memory(j) => at(&self.memory, j),
            Symbol::Mode(k) => at(&self.modes, k),
            Symbol::Phase(k) => f64::from(u8::from(k as usize == self.phase)),
            // Derivations leave none of these in what is followed.
            Symbol::State(_) | Symbol::StateRate(_) => 0.0,
            Symbol::Acceleration(_) | Symbol::Reaction(_) | Symbol::Multiplier(_) | Symbol::Dummy(_) => 0.0,
        }
    }
}

/// Powers of two by which rows and columns of [M −Jᵀ; J 0] are to be multiplied: M's diagonal comes near 1 (n of them), then
/// the largest entries of J's rows.
fn measures(matrix: &[Measured], n: usize, size: usize) -> Vec<f64> {
    let entry = |i: usize, j: usize| matrix[i * size + j].value.to_f64().abs();
    let near_one = |x: f64| if x > 0.0 && x.is_finite() { (-x.log2().round()).exp2() } else { 1.0 };
    let mut own: Vec<f64> = (0..n).map(|i| near_one(entry(i, i).sqrt())).collect();
    let heavy: Vec<bool> = (0..n).map(|i| entry(i, i) > 0.0).collect();
    for k in n..size {
        let largest = |heavy_only: bool| {
            let columns = (0..n).filter(|i| heavy[*i] || !heavy_only);
            columns.map(|i| entry(k, i) * own[i]).fold(0.0, f64::max)
        };
        let most = if largest(true) > 0.0 { largest(true) } else { largest(false) };
        own.push(near_one(most));
    }
    for i in (0..n).filter(|i| !heavy[*i]) {
        own[i] = near_one((n..size).map(|k| entry(k, i) * own[k]).fold(0.0, f64::max));
    }
    own
}

/// Sets of coordinates that M's non-zeros connect, each in order.
pub(super) fn blocks(n: usize, places: &[(usize, usize)]) -> Vec<Vec<usize>> {
    let mut leader: Vec<usize> = (0..n).collect();
    fn find(leader: &mut [usize], mut i: usize) -> usize {
        while leader[i] != i {
            leader[i] = leader[leader[i]];
            i = leader[i];
        }
        i
    }
    for &(i, j) in places {
        let (i, j) = (find(&mut leader, i), find(&mut leader, j));
        leader[i.max(j)] = i.min(j);
    }
    let mut blocks: Vec<Vec<usize>> = vec![Vec::new(); n];
    for i in 0..n {
        let first = find(&mut leader, i);
        blocks[first].push(i);
    }
    blocks.retain(|block| !block.is_empty());
    blocks
}
