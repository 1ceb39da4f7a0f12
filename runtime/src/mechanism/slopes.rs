//! How accelerations change with the state and with time.

use super::kkt::KktSolver;
use super::{At, Enforcement, Singular, System};

/// ∂a/∂q, ∂a/∂q' and ∂a/∂t of the accelerations at a state, from the generated Jacobians.
///
/// Where constraints act accelerations and multipliers come from one system, K [a; λ] = [−h; −γ] with
/// K = [M −(Jᵀ + B); J 0], and K [∂a; ∂λ] = −[∂F; ∂(J a + γ)] with a and λ held on the right, friction of reactions included.
/// Springs in the place of constraints have λ = −(k c + d c'), whose slopes are −(k J + d ∂c'/∂q) and −d J.
#[derive(Clone, Debug)]
pub(crate) struct AccelerationSlopes {
    n: usize,
    form: KktSolver,
    a: Vec<f64>,
    lambda: Vec<f64>,
    by_place: Vec<f64>,
    by_speed: Vec<f64>,
    by_time: Vec<f64>,
    /// Columns to solve for, and what they do to the rows of the constraints.
    column: Vec<f64>,
    right: Vec<f64>,
    /// ∂F/∂q and ∂F/∂q', then those of the rows, dense, column by column.
    forces: [Vec<f64>; 2],
    rows: [Vec<f64>; 2],
    values: Vec<f64>,
}

/// Nodes within a step, and the weights of the derivative at 0 of the polynomial through them.
const NODES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
const WEIGHTS: [f64; 5] = [-25.0 / 3.0, 16.0, -12.0, 16.0 / 3.0, -1.0];

impl AccelerationSlopes {
    /// Room for a mechanism with n coordinates.
    pub fn new(n: usize) -> Self {
        let square = || vec![0.0; n * n];
        AccelerationSlopes {
            n,
            form: KktSolver::default(),
            a: vec![0.0; n],
            lambda: Vec::new(),
            by_place: square(),
            by_speed: square(),
            by_time: vec![0.0; n],
            column: vec![0.0; n],
            right: Vec::new(),
            forces: [square(), square()],
            rows: [Vec::new(), Vec::new()],
            values: Vec::new(),
        }
    }

    /// ∂a/∂q, row by row.
    pub fn by_place(&self) -> &[f64] {
        &self.by_place
    }

    /// ∂a/∂q', row by row.
    pub fn by_speed(&self) -> &[f64] {
        &self.by_speed
    }

    /// ∂a/∂t, after [`AccelerationSlopes::evaluate_time`].
    pub fn by_time(&self) -> &[f64] {
        &self.by_time
    }

    /// out += factor ∂a/∂q x.
    pub fn add_by_place(&self, factor: f64, x: &[f64], out: &mut [f64]) {
        for (out, line) in out.iter_mut().zip(self.by_place.chunks_exact(self.n.max(1))) {
            *out += factor * line.iter().zip(x).map(|(slope, x)| slope * x).sum::<f64>();
        }
    }

    /// Evaluates ∂a/∂q and ∂a/∂q' at a state.
    ///
    /// # Errors
    /// Those of the accelerations there.
    pub fn evaluate(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        let n = self.n;
        let description = system.description();
        self.lambda.resize(description.rows.len(), 0.0);
        system.accelerations_and_multipliers(at, &mut self.a, &mut self.lambda)?;
        let at = at.accelerated(&self.a).constrained(&self.lambda);
        let patterns = [&description.stiffness_pattern, &description.damping_pattern];
        let count = patterns[0].len();
        self.values.resize(count + patterns[1].len(), 0.0);
        let (by_place, by_speed) = self.values.split_at_mut(count);
        system.jacobians(at, by_place, by_speed);
        for ((dense, pattern), values) in self.forces.iter_mut().zip(patterns).zip([by_place, by_speed]) {
            dense.fill(0.0);
            for ((row, column), value) in pattern.iter().zip(values) {
                dense[*column as usize * n + *row as usize] = *value;
            }
        }
        self.form.factor_for_slopes(system, at)?;
        let m = self.form.active().len();
        self.right.resize(m, 0.0);
        if m > 0 {
            self.form.row_slopes(system, at, &mut self.values, &mut self.rows);
        }
        for k in 0..2 {
            for j in 0..n {
                for (x, f) in self.column.iter_mut().zip(&self.forces[k][j * n..]) {
                    *x = -f;
                }
                self.right.iter_mut().zip(&self.rows[k][j * m..]).for_each(|(x, g)| *x = -g);
                self.form.respond(system, at, &mut self.column, &self.right);
                let slopes = if k == 0 { &mut self.by_place } else { &mut self.by_speed };
                self.column.iter().enumerate().for_each(|(i, x)| slopes[i * n + j] = *x);
            }
        }
        Ok(())
    }

    /// As [`AccelerationSlopes::evaluate`], with 0 for a slope that has no finite value, as that of a root at 0 has none: for iterations and steps whose results
    /// are tested, and go on without it.
    ///
    /// # Errors
    /// As [`AccelerationSlopes::evaluate`].
    pub fn evaluate_finite(&mut self, system: &dyn System, at: At<'_>) -> Result<(), Singular> {
        self.evaluate(system, at)?;
        self.leave_out_poles();
        Ok(())
    }

    /// Makes slopes 0 that have no finite value, those by time included.
    pub fn leave_out_poles(&mut self) {
        let slopes = self.by_place.iter_mut().chain(&mut self.by_speed).chain(&mut self.by_time);
        slopes.filter(|slope| !slope.is_finite()).for_each(|slope| *slope = 0.0);
    }

    /// Evaluates ∂a/∂t, the state held, after [`AccelerationSlopes::evaluate`] at the same one.
    ///
    /// What the file gives no derivative of, third derivatives of inputs and the rows' dependence on time, comes from the
    /// polynomial through five times within the step of h that begins there: of order 4, no coarser than the step itself.
    pub fn evaluate_time(&mut self, system: &dyn System, at: At<'_>, h: f64) {
        let description = system.description();
        self.by_time.fill(0.0);
        let m = self.form.active().len();
        if !description.structure.time_dependent && m == 0 {
            return;
        }
        let (a, lambda) = (std::mem::take(&mut self.a), std::mem::take(&mut self.lambda));
        let at = at.accelerated(&a).constrained(&lambda);
        let pattern = &description.time_pattern;
        self.values.resize(pattern.len(), 0.0);
        system.time_jacobian(at, &mut self.values);
        for (row, value) in pattern.iter().zip(&self.values) {
            self.by_time[*row as usize] -= value;
        }
        self.by_inputs(system, at, h);
        if m == 0 && pattern.is_empty() && description.input_pattern.is_empty() {
            self.by_differences(system, at, h);
            (self.a, self.lambda) = (a, lambda);
            return;
        }
        self.right.fill(0.0);
        for (node, weight) in NODES.into_iter().zip(WEIGHTS).filter(|_| m > 0) {
            let later = At { t: at.t + node * h, ..at };
            self.form.add_rows(system, later, weight / h, &mut self.values, &mut self.right);
        }
        self.right.iter_mut().for_each(|x| *x = -*x);
        self.form.respond(system, at, &mut self.by_time, &self.right);
        (self.a, self.lambda) = (a, lambda);
    }

    /// For systems that depend on time and give no derivatives.
    fn by_differences(&mut self, system: &dyn System, at: At<'_>, h: f64) {
        for (node, weight) in NODES.into_iter().zip(WEIGHTS) {
            // Where there is none the step will find out.
            if system.accelerations(At { t: at.t + node * h, ..at }, &mut self.column).is_ok() {
                self.by_time.iter_mut().zip(&self.column).for_each(|(rate, a)| *rate += weight / h * a);
            }
        }
    }

    /// ∂F/∂(u, u', u'') times the rates of these.
    fn by_inputs(&mut self, system: &dyn System, at: At<'_>, h: f64) {
        let description = system.description();
        let (pattern, count) = (&description.input_pattern, 3 * description.inputs.len());
        if pattern.is_empty() {
            return;
        }
        self.values.resize(2 * count + pattern.len(), 0.0);
        let (inputs, rest) = self.values.split_at_mut(count);
        let (rates, slopes) = rest.split_at_mut(count);
        rates.fill(0.0);
        for (node, weight) in NODES.into_iter().zip(WEIGHTS) {
            system.inputs(at.t + node * h, inputs);
            for (rate, u) in rates.chunks_exact_mut(3).zip(inputs.chunks_exact(3)) {
                rate[2] += weight / h * u[2];
                if node == 0.0 {
                    rate[..2].copy_from_slice(&u[1..]);
                }
            }
        }
        system.input_jacobian(at, slopes);
        for ((row, input), slope) in pattern.iter().zip(slopes) {
            self.by_time[*row as usize] -= *slope * rates[*input as usize];
        }
    }
}

/// Whether springs stand for the constraints, and how stiff and damped they are.
pub(super) fn springs(system: &dyn System) -> Option<(f64, f64)> {
    match system.enforcement() {
        Enforcement::Springs { stiffness, damping } => Some((stiffness, damping)),
        _ => None,
    }
}
