//! The matrices of a mechanism as dense ones, for what is done once: starts, impacts, small motions.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::DMatrix;

use super::{At, Description, System};

/// M.
pub(crate) fn mass_matrix<S: System + ?Sized>(system: &S, at: At<'_>) -> DMatrix<f64> {
    let pattern = &system.description().mass_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.mass_matrix(at, &mut values);
    let mut mass = scatter((system.len(), system.len()), pattern, &values);
    mass.fill_upper_triangle_with_lower_triangle();
    mass
}

/// Speeds that are none beside any other, SI; their squares are numbers still.
const SLOW: f64 = 1e-100;
/// A slope that such speeds leave below this vanishes with them: half of their decades are for what it is multiplied with.
const GONE_WITH_SPEED: f64 = 1e-50;
/// Slopes that are alike in several directions are so to this part of themselves.
const SAME_SLOPE: f64 = 1e-9;

/// Values of ∂F/∂q and ∂F/∂q' as the patterns have them.  One by a speed that has no value where all rests, as that of |v| v has not as it is written,
/// is the limit that it has as speeds vanish, if that is the same in all directions.
pub(crate) fn jacobians<S: System + ?Sized>(system: &S, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
    system.jacobians(at, dq, dv);
    if dv.iter().all(|x| x.is_finite()) || at.v.iter().any(|v| *v != 0.0) {
        return;
    }
    let towards = |turn: f64| {
        let v: Vec<f64> = (0..at.v.len()).map(|i| SLOW * (1.0 + i as f64 + turn).sin()).collect();
        let mut slopes = dv.to_vec();
        system.jacobians(At { v: &v, ..at }, &mut dq.to_vec(), &mut slopes);
        slopes
    };
    let [first, others @ ..] = [0.0, 1.3, 2.9].map(towards);
    for (k, slope) in dv.iter_mut().enumerate().filter(|(_, slope)| !slope.is_finite()) {
        let size = first[k].abs();
        if others.iter().all(|other| other[k].abs().max(size) < GONE_WITH_SPEED) {
            *slope = 0.0;
        } else if others.iter().all(|other| (other[k] - first[k]).abs() <= SAME_SLOPE * size) {
            *slope = first[k];
        }
    }
}

/// ∂F/∂q and ∂F/∂q'.
pub(crate) fn force_slopes<S: System + ?Sized>(system: &S, at: At<'_>) -> [DMatrix<f64>; 2] {
    let patterns = [&system.description().stiffness_pattern, &system.description().damping_pattern];
    let [mut dq, mut dv] = patterns.map(|pattern| vec![0.0; pattern.len()]);
    jacobians(system, at, &mut dq, &mut dv);
    let shape = (system.len(), system.len());
    [scatter(shape, patterns[0], &dq), scatter(shape, patterns[1], &dv)]
}

/// J = ∂c'/∂q' of these rows.
pub(crate) fn constraint_matrix<S: System + ?Sized>(system: &S, at: At<'_>, rows: &[usize]) -> DMatrix<f64> {
    let pattern = &system.description().constraint_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.constraint_matrix(at, &mut values);
    of_rows(system, pattern, &values).select_rows(rows)
}

/// ∂c'/∂q of these rows.
pub(crate) fn constraint_rate_jacobian<S: System + ?Sized>(system: &S, at: At<'_>, rows: &[usize]) -> DMatrix<f64> {
    let pattern = &system.description().constraint_rate_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.constraint_rate_jacobian(at, &mut values);
    of_rows(system, pattern, &values).select_rows(rows)
}

/// ∂(J a + γ)/∂q and ∂(J a + γ)/∂q' of these rows.
pub(crate) fn constraint_slopes<S: System + ?Sized>(system: &S, at: At<'_>, rows: &[usize]) -> [DMatrix<f64>; 2] {
    let description = system.description();
    let patterns = [&description.constraint_stiffness_pattern, &description.constraint_damping_pattern];
    let [mut dq, mut dv] = patterns.map(|pattern| vec![0.0; pattern.len()]);
    system.constraint_jacobians(at, &mut dq, &mut dv);
    [of_rows(system, patterns[0], &dq).select_rows(rows), of_rows(system, patterns[1], &dv).select_rows(rows)]
}

/// Jᵀ + B of these rows: the forces that their multipliers make.
pub(crate) fn multiplier_effects<S: System + ?Sized>(system: &S, at: At<'_>, rows: &[usize]) -> DMatrix<f64> {
    let pattern = &system.description().friction_pattern;
    let mut values = vec![0.0; pattern.len()];
    system.friction(at, &mut values);
    let friction = scatter((system.len(), system.description().rows.len()), pattern, &values);
    constraint_matrix(system, at, rows).transpose() + friction.select_columns(rows)
}

/// ∂F/∂(u, u', u'').
pub(crate) fn input_matrix<S: System + ?Sized>(system: &S, at: At<'_>) -> DMatrix<f64> {
    let description = system.description();
    let mut values = vec![0.0; description.input_pattern.len()];
    system.input_jacobian(at, &mut values);
    scatter((system.len(), 3 * description.inputs.len()), &description.input_pattern, &values)
}

/// ∂c'/∂u and ∂c'/∂u' of these rows; `None` where they are not known.
pub(crate) fn constraint_rates_by_inputs<S: System + ?Sized>(
    system: &S,
    at: At<'_>,
    rows: &[usize],
) -> Option<[DMatrix<f64>; 2]> {
    let (count, inputs) = (system.description().rows.len(), system.description().inputs.len());
    let mut columns = DMatrix::zeros(count, 2 * inputs);
    let known = system.constraint_rates_by_inputs(at, columns.as_mut_slice());
    let every_second = |first: usize| -> Vec<usize> { (0..inputs).map(|k| 2 * k + first).collect() };
    known.then(|| [0, 1].map(|first| columns.select_columns(&every_second(first)).select_rows(rows)))
}

/// (c, c', Σ |terms| of c) of all rows.
pub(crate) fn constraint_triples<S: System + ?Sized>(system: &S, at: At<'_>) -> Vec<[f64; 3]> {
    let mut triples = vec![0.0; 3 * system.description().rows.len()];
    system.constraints(at, &mut triples);
    triples.as_chunks().0.to_vec()
}

/// 200 u, u = 2⁻⁵³: what rounding makes of a coordinate, beside the largest with the same unit.
pub(crate) const ROUNDING: f64 = 100.0 * f64::EPSILON;
/// 200 u² of what has the same unit: what a mechanism that stays in a plane, or at a place, has across it is rounding of rounding.
pub(crate) const SECOND_ROUNDING: f64 = 100.0 * f64::EPSILON * f64::EPSILON;

/// The largest range of each coordinate that counts: 2π for angles.
pub(crate) fn widest(mechanism: &Description) -> Vec<f64> {
    let units = mechanism.coordinates.iter().map(|coordinate| is_angle(&coordinate.unit));
    units.map(|angle| if angle { TAU } else { f64::INFINITY }).collect()
}

/// True for the units of angles.
fn is_angle(unit: &str) -> bool {
    matches!(unit, "rad" | "mrad" | "deg" | "°")
}

/// The largest size of a coordinate, or of its speed, among those with the same unit: what its rounding is judged by.
pub(crate) fn sizes_alike(description: &Description, numbers: &[f64]) -> Vec<f64> {
    let unit = |i: usize| -> &str { &description.coordinates[i].unit };
    let mut largest: BTreeMap<&str, f64> = BTreeMap::new();
    for (i, x) in numbers.iter().enumerate() {
        let most = largest.entry(unit(i)).or_default();
        *most = most.max(x.abs());
    }
    (0..numbers.len()).map(|i| largest[unit(i)]).collect()
}

/// What of a row of the constraints may be rounding where a motion begins, since the start is a sum of parameters that cancel, as 0.3 − 0.1 − 0.2, or a
/// vibration after whole periods.
pub(crate) fn rounding_of_parameters<S: System + ?Sized>(system: &S, row: usize) -> f64 {
    let Description { rows, parameters, .. } = system.description();
    let unit = &rows[row].unit;
    let alike = parameters.iter().zip(system.parameters()).filter(|(known, _)| known.unit == *unit && !unit.is_empty());
    ROUNDING * alike.fold(0.0, |most, (_, value)| f64::max(most, value.abs()))
}

/// Σ |M⁻¹ Jₖᵀ Pₖ| for the impulses P of these rows: the sizes beside which the jump of each rate, the sum of these, is rounded; `None`
/// where M alone has no inverse.
pub(crate) fn impulse_terms(system: &dyn System, at: At<'_>, impulses: &[(usize, f64)]) -> Option<Vec<f64>> {
    let mass = mass_matrix(system, at).cholesky()?;
    let rows: Vec<usize> = impulses.iter().map(|(row, _)| *row).collect();
    let response = mass.solve(&constraint_matrix(system, at, &rows).transpose());
    let of = |i: usize| impulses.iter().enumerate().map(|(k, (_, impulse))| (response[(i, k)] * impulse).abs()).sum();
    Some((0..system.len()).map(of).collect())
}

/// A matrix with a row for each row of the constraints.
fn of_rows<S: System + ?Sized>(system: &S, pattern: &[(u32, u32)], values: &[f64]) -> DMatrix<f64> {
    scatter((system.description().rows.len(), system.len()), pattern, values)
}

fn scatter(shape: (usize, usize), pattern: &[(u32, u32)], values: &[f64]) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(shape.0, shape.1);
    for ((row, column), value) in pattern.iter().zip(values) {
        matrix[(*row as usize, *column as usize)] = *value;
    }
    matrix
}
