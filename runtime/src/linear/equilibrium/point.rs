//! A mechanism whose inputs and clock stand still: F(q) = F(q, q', q'' = 0) and its derivatives.

use std::cell::RefCell;
use std::collections::BTreeMap;

use nalgebra::DMatrix;

use super::Guess;
use crate::linear::matrices::NO_ANGLE;
use crate::linear::{LinearError, Residual, SparseMatrix, has_dependent_coordinates, short};
use crate::mechanism::dense::{constraint_matrix, constraint_triples, jacobians};
use crate::mechanism::{At, SwitchKind, System, rate_name};
use crate::trust::ends_that_meet;

/// Arguments of switches nearer to zero than this, relative to the largest coordinate, are on the surface.
const ON_SURFACE: f64 = 1e-10;

/// Steady forces of a mechanism; discontinuities are on the side where a point lies, and at 0 on their surface.
pub(in crate::linear) struct LinearisationPoint {
    pub system: RefCell<Box<dyn System>>,
    pub n: usize,
    pub v: Vec<f64>,
    /// Multipliers of all rows; empty where these do not matter.
    pub lambda: Vec<f64>,
    pub(super) zero: Vec<f64>,
    /// The sides on which switches on their surface stay, where these are all alike; empty where that is not known.
    beside: RefCell<Vec<f64>>,
}

impl LinearisationPoint {
    /// Holds inputs at the guess's values, 0 where it has none; their rates are 0.
    pub fn new<S: System + ?Sized>(system: &S, guess: &Guess) -> Self {
        let n = system.len();
        let mut held = system.boxed_clone();
        for index in 0..system.description().inputs.len() {
            let value = guess.inputs.get(index).copied().unwrap_or(0.0);
            held.set_input(index, std::sync::Arc::new(move |_| [value, 0.0, 0.0]));
        }
        LinearisationPoint {
            system: RefCell::new(held),
            n,
            v: guess.v.clone(),
            lambda: Vec::new(),
            zero: vec![0.0; n],
            beside: RefCell::default(),
        }
    }

    /// Whether coordinates are not independent.
    fn has_constraints(&self) -> bool {
        has_dependent_coordinates(&**self.system.borrow())
    }

    /// Another value of a parameter.
    pub fn set_parameter(&self, index: usize, value: f64) {
        self.system.borrow_mut().set_parameter(index, value);
    }

    pub fn names(&self) -> Vec<String> {
        self.system.borrow().description().coordinates.iter().map(|c| c.name.to_string()).collect()
    }

    /// Units of the coordinates.
    pub fn units(&self) -> Vec<String> {
        self.system.borrow().description().coordinates.iter().map(|c| c.unit.to_string()).collect()
    }

    /// (coordinate, force) of every coordinate.
    pub fn named(&self, values: &[f64]) -> Vec<(String, f64)> {
        self.names().into_iter().zip(values.iter().copied()).collect()
    }

    /// (coordinate, force, its unit) of every coordinate; of a state its rate.
    pub fn forces(&self, values: &[f64]) -> Vec<Residual> {
        let system = self.system.borrow();
        let list = system.description().coordinates.iter().zip(values);
        list.map(|(coordinate, value)| match coordinate.state() {
            None => {
                Residual { coordinate: coordinate.name.to_string(), force: *value, unit: force_unit(&coordinate.unit) }
            }
            // F of a hidden coordinate at rest is −z'.
            Some(state) => Residual {
                coordinate: rate_name(state),
                force: -value,
                unit: if coordinate.unit.is_empty() { String::new() } else { format!("{}/s", coordinate.unit) },
            },
        })
        .collect()
    }

    /// A state that does not accelerate.
    pub(super) fn at<'a>(&'a self, t: f64, q: &'a [f64], v: &'a [f64]) -> At<'a> {
        At::new(t, q, v).accelerated(&self.zero).constrained(&self.lambda)
    }

    pub(super) fn name(&self, index: usize) -> String {
        self.system.borrow().description().coordinate_name(index)
    }

    /// F(q, q', 0).
    pub fn force(&self, q: &[f64]) -> Vec<f64> {
        self.settle(0.0, q, &self.v);
        self.present_force(0.0, q, &self.v)
    }

    /// F with another speed of one coordinate.
    pub fn force_moving(&self, q: &[f64], coordinate: usize, speed: f64) -> Vec<f64> {
        let mut v = self.v.clone();
        v[coordinate] = speed;
        self.settle(0.0, q, &v);
        self.present_force(0.0, q, &v)
    }

    fn present_force(&self, t: f64, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut force = vec![0.0; self.n];
        self.system.borrow().residual(self.at(t, q, v), &mut force);
        force
    }

    /// Puts every switch on the side where its argument is at the present speeds, and tells which sides these are.
    pub fn sides_at(&self, q: &[f64]) -> Vec<f64> {
        self.settle(0.0, q, &self.v);
        self.system.borrow().modes().to_vec()
    }

    /// Leaves switches that are on their surface on these sides from now on.
    pub(super) fn stay_on(&self, sides: Vec<f64>) {
        self.beside.replace(sides);
    }

    /// As [`LinearisationPoint::sides_at`], at other speeds.
    pub(super) fn sides_moving(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        self.settle(0.0, q, v);
        self.system.borrow().modes().to_vec()
    }

    /// Puts every switch on the side where its argument is; on its surface `sign` is 0 and `step` is 1, where nothing else is known.
    pub(super) fn settle(&self, t: f64, q: &[f64], v: &[f64]) {
        let arguments = self.arguments(t, q, v);
        if arguments.is_empty() {
            return;
        }
        let near = ON_SURFACE * q.iter().fold(1.0_f64, |most, q| most.max(q.abs()));
        // An argument may contain another switch.
        for _ in 0..4 {
            let arguments = self.arguments(t, q, v);
            let mut system = self.system.borrow_mut();
            let beside = self.beside.borrow();
            let side = |(index, x): (usize, &f64)| match system.description().switches[index].kind {
                _ if x.abs() <= near && !beside.is_empty() => beside[index],
                SwitchKind::Sign if x.abs() <= near => 0.0,
                SwitchKind::Sign => x.signum(),
                SwitchKind::Step => f64::from(*x >= -near),
            };
            let modes: Vec<f64> = arguments.iter().enumerate().map(side).collect();
            if modes == system.modes() {
                break;
            }
            system.set_modes(&modes);
        }
    }

    pub(super) fn arguments(&self, t: f64, q: &[f64], v: &[f64]) -> Vec<f64> {
        let system = self.system.borrow();
        let mut pairs = vec![0.0; 2 * system.description().switches.len()];
        if !pairs.is_empty() {
            system.switches(self.at(t, q, v), &mut pairs);
        }
        pairs.chunks_exact(2).map(|pair| pair[0]).collect()
    }

    /// Switches of the state (not of time alone) on whose surface a point lies.
    pub fn on_surface(&self, q: &[f64]) -> Vec<usize> {
        self.settle(0.0, q, &self.v);
        let near = ON_SURFACE * q.iter().fold(1.0_f64, |most, q| most.max(q.abs()));
        let arguments = self.arguments(0.0, q, &self.v);
        let system = self.system.borrow();
        let of_state = |index: &usize| {
            let switch = &system.description().switches[*index];
            !switch.time_only || switch.of_input
        };
        (0..arguments.len()).filter(of_state).filter(|index| arguments[*index].abs() <= near).collect()
    }

    /// A switch's argument as text, and its kind.
    pub fn switch(&self, index: usize) -> (String, SwitchKind) {
        let system = self.system.borrow();
        let switch = &system.description().switches[index];
        (switch.text.to_string(), switch.kind)
    }

    /// F and its derivatives by q and q' on one side of a switch, all others as they are.
    pub fn with_mode(&self, q: &[f64], switch: usize, side: f64) -> OneSide {
        self.settle(0.0, q, &self.v);
        let mut modes = self.system.borrow().modes().to_vec();
        modes[switch] = side;
        self.system.borrow_mut().set_modes(&modes);
        let [_, damping, stiffness] = self.present_matrices(q);
        let derivatives = damping.entries.iter().chain(&stiffness.entries).map(|entry| entry.2).collect();
        let system = self.system.borrow();
        let at = At::new(0.0, q, &self.v);
        let rows: Vec<usize> = (0..system.description().rows.len()).collect();
        let mut constraints: Vec<f64> = constraint_triples(&**system, at).iter().map(|triple| triple[0]).collect();
        constraints.extend(constraint_matrix(&**system, at, &rows).iter());
        OneSide { force: self.present_force(0.0, q, &self.v), derivatives, constraints }
    }

    /// True for equations that are linear with constant coefficients.
    pub fn is_linear(&self) -> bool {
        self.system.borrow().description().structure.linear
    }

    /// True where no force can jump: a linear mechanism, or nothing but potentials.
    pub fn is_smooth(&self) -> bool {
        let system = self.system.borrow();
        let description = system.description();
        description.switches.is_empty() && (description.structure.linear || description.structure.conservative)
    }

    /// What each row of forces is judged by: Σ |terms|, and what the state's own size makes of the derivatives.
    ///
    /// Rounding leaves some ε of it; forces that are far below it are balanced.
    pub fn measure(&self, q: &[f64]) -> Vec<f64> {
        self.settle(0.0, q, &self.v);
        let mut sums = self.magnitudes(q);
        let [_, damping, stiffness] = self.present_matrices(q);
        // An angle that is 0 but for rounding counts as one of 1 rad.
        let number = |(unit, q): (String, &f64)| match matches!(unit.as_str(), "1" | "rad") {
            true if q.abs() <= NO_ANGLE => 1.0,
            _ => q.abs(),
        };
        let numbers: Vec<f64> = self.units().into_iter().zip(q).map(number).collect();
        for (matrix, state) in [(stiffness, &numbers), (damping, &self.v)] {
            // What rests has no part in it, whether or not there is a slope.
            for (row, column, value) in matrix.entries.iter().filter(|entry| state[entry.1 as usize] != 0.0) {
                sums[*row as usize] += (value * state[*column as usize]).abs();
            }
        }
        sums
    }

    /// Σ |terms| of each force.
    pub fn magnitudes(&self, q: &[f64]) -> Vec<f64> {
        self.magnitudes_moving(q, &self.v)
    }

    fn magnitudes_moving(&self, q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.n];
        self.system.borrow().magnitudes(self.at(0.0, q, v), &mut sums);
        sums
    }

    /// M, ∂F/∂q' and ∂F/∂q without what is rounding: elements far below the terms that they are the difference of.
    pub fn cleaned(&self, q: &[f64]) -> [SparseMatrix; 3] {
        let [mass, mut damping, mut stiffness] = self.matrices(q);
        let near: Vec<f64> = q.iter().map(|q| q * (1.0 + 1e-7)).collect();
        let [_, damping_near, stiffness_near] = self.present_matrices(&near);
        let here = self.magnitudes(q);
        for (matrix, near, of_speed) in [(&mut damping, damping_near, true), (&mut stiffness, stiffness_near, false)] {
            let largest = matrix.entries.iter().fold(0.0_f64, |most, e| most.max(e.2.abs()));
            let doubtful = |value: f64| value != 0.0 && value.abs() <= 1e-9 * largest;
            let mut slopes: BTreeMap<u32, Vec<f64>> = BTreeMap::new();
            for (entry, near) in matrix.entries.iter_mut().zip(&near.entries).filter(|(e, _)| doubtful(e.2)) {
                let slopes = slopes.entry(entry.1).or_insert_with(|| self.slopes(q, entry.1 as usize, of_speed, &here));
                let terms = slopes[entry.0 as usize] + (near.2 - entry.2).abs() / 1e-7;
                if entry.2.abs() <= 64.0 * f64::EPSILON * terms {
                    entry.2 = 0.0;
                }
            }
        }
        [mass, damping, stiffness]
    }

    /// How fast the magnitudes of all rows grow with one coordinate or its speed.
    pub(super) fn slopes(&self, q: &[f64], index: usize, of_speed: bool, here: &[f64]) -> Vec<f64> {
        let (mut q, mut v) = (q.to_vec(), self.v.clone());
        let moved = if of_speed { &mut v[index] } else { &mut q[index] };
        let step = (1e-7 * moved.abs()).max(1e-12);
        *moved += step;
        self.magnitudes_moving(&q, &v).iter().zip(here).map(|(there, here)| (there - here).abs() / step).collect()
    }

    /// M, ∂F/∂q' and ∂F/∂q.
    pub fn matrices(&self, q: &[f64]) -> [SparseMatrix; 3] {
        self.settle(0.0, q, &self.v);
        self.present_matrices(q)
    }

    fn present_matrices(&self, q: &[f64]) -> [SparseMatrix; 3] {
        self.present_matrices_moving(q, &self.v)
    }

    /// The same at other speeds.
    pub(super) fn present_matrices_moving(&self, q: &[f64], v: &[f64]) -> [SparseMatrix; 3] {
        let system = self.system.borrow();
        let description = system.description();
        let mut mass = vec![0.0; description.mass_pattern.len()];
        let mut stiffness = vec![0.0; description.stiffness_pattern.len()];
        let mut damping = vec![0.0; description.damping_pattern.len()];
        system.mass_matrix(At::new(0.0, q, v), &mut mass);
        jacobians(&**system, self.at(0.0, q, v), &mut stiffness, &mut damping);
        [
            SparseMatrix::symmetric(self.n, &description.mass_pattern, &mass),
            SparseMatrix::new(self.n, self.n, &description.damping_pattern, &damping),
            SparseMatrix::new(self.n, self.n, &description.stiffness_pattern, &stiffness),
        ]
    }

    /// ∂F/∂q without what is rounding, dense.
    pub fn stiffness(&self, q: &[f64]) -> DMatrix<f64> {
        self.cleaned(q)[2].to_dense()
    }

    /// −∂F/∂(u, u', u''), n × 3m.
    pub fn input(&self, q: &[f64]) -> SparseMatrix {
        self.settle(0.0, q, &self.v);
        let system = self.system.borrow();
        let description = system.description();
        let mut values = vec![0.0; description.input_pattern.len()];
        system.input_jacobian(self.at(0.0, q, &self.v), &mut values);
        for value in &mut values {
            *value = -*value;
        }
        SparseMatrix::new(self.n, 3 * description.inputs.len(), &description.input_pattern, &values)
    }

    /// The columns of [`System::output_slopes`] at rest, or in steady motion, with these multipliers; `None` where they are
    /// not known.
    pub fn output_slopes(&self, t: f64, q: &[f64], lambda: &[f64]) -> Option<DMatrix<f64>> {
        self.settle(t, q, &self.v);
        let system = self.system.borrow();
        let description = system.description();
        let columns = 3 * self.n + description.rows.len() + 3 * description.inputs.len() + 1;
        let mut slopes = DMatrix::zeros(description.output_len(), columns);
        let at = self.at(t, q, &self.v).constrained(lambda);
        system.output_slopes(at, slopes.as_mut_slice()).then_some(slopes)
    }

    /// Refuses equations that change with time though all inputs are held, and speeds that cannot last.
    pub fn check(&self, q: &[f64]) -> Result<(), LinearError> {
        if self.has_constraints() {
            return Err(LinearError::HasConstraints);
        }
        let size = |what, given| LinearError::WrongSize { what, given, expected: self.n };
        if q.len() != self.n {
            return Err(size("the point", q.len()));
        }
        if self.v.len() != self.n {
            return Err(size("the list of speeds", self.v.len()));
        }
        if let Some(i) = (0..self.n).find(|i| !(q[*i].is_finite() && self.v[*i].is_finite())) {
            return Err(LinearError::NonFinite { what: format!("`{}`", self.name(i)) });
        }
        let now = self.force(q);
        if let Some(i) = now.iter().position(|f| !f.is_finite()) {
            let system = self.system.borrow();
            let coordinates = system.description().coordinates.iter().zip(q.iter().zip(&self.v));
            let point = coordinates.map(|(coordinate, (place, speed))| match coordinate.state() {
                None => format!("{} = {}", coordinate.name, short(*place)),
                Some(state) => format!("{state} = {}", short(*speed)),
            });
            let point: Vec<String> = point.collect();
            let at = self.at(0.0, q, &self.v);
            let met = ends_that_meet(&**system, at);
            let why = met.map_or_else(String::new, |load| {
                format!(" (a distance, norm or root in `{load}` is zero, where ends that meet have no direction)")
            });
            let what = format!("the force on `{}` at {}{why}", self.name(i), point.join(", "));
            return Err(LinearError::NonFinite { what });
        }
        self.check_time(q)?;
        self.check_steadiness(q)
    }

    /// Speeds last, and M, C and K stay as they are, only along coordinates on which nothing depends.
    fn check_steadiness(&self, q: &[f64]) -> Result<(), LinearError> {
        let moving: Vec<usize> = (0..self.n).filter(|i| self.v[*i] != 0.0).collect();
        if moving.is_empty() {
            return Ok(());
        }
        let here = self.matrices(q);
        let largest = |matrix: &SparseMatrix| matrix.entries.iter().fold(0.0_f64, |s, e| s.max(e.2.abs()));
        let scales: Vec<f64> = here.iter().map(largest).collect();
        let pulls = |e: &&(u32, u32, f64)| moving.contains(&(e.1 as usize)) && e.2 != 0.0;
        if let Some((_, column, _)) = self.cleaned(q)[2].entries.iter().find(pulls) {
            return Err(LinearError::NotSteady { coordinate: self.name(*column as usize) });
        }
        for &index in &moving {
            for distance in [0.31, 2.3] {
                let mut there = q.to_vec();
                there[index] += distance;
                let changed = here.iter().zip(self.matrices(&there)).zip(&scales).any(|((a, b), scale)| {
                    a.entries.iter().zip(&b.entries).any(|(a, b)| (a.2 - b.2).abs() > 1e-9 * scale)
                });
                if changed {
                    return Err(LinearError::NotSteady { coordinate: self.name(index) });
                }
            }
        }
        Ok(())
    }
}

/// F and its derivatives, and c and J of all constraints, on one side of a discontinuity.
pub(in crate::linear) struct OneSide {
    pub force: Vec<f64>,
    pub derivatives: Vec<f64>,
    pub constraints: Vec<f64>,
}

/// The unit of the generalized force that belongs to a coordinate: work per its unit.
pub(crate) fn force_unit(coordinate: &str) -> String {
    match coordinate {
        "" | "1" => String::new(),
        "m" => "N".to_owned(),
        "rad" => "N m".to_owned(),
        unit => format!("J/({unit})"),
    }
}
