//! Directions in which a motion moves as it must: those of multipliers that are known beforehand.

use nalgebra::{DMatrix, DVector};

use super::acting;
use crate::matrix::svd;
use crate::mechanism::dense::{constraint_matrix, mass_matrix};
use crate::mechanism::{Along, At, Function, System, rows_in_force};
use crate::run::Side;

/// A direction counts as known where the computed map takes it to where it must go to this part of it, or to what the tolerance leaves unknown:
/// flows at the tightest are known to some ten digits.
const HOLDS: f64 = 1e-6;
/// Directions that others contain up to this part of them are none of their own.
pub(super) const CONTAINED: f64 = 1e-6;

/// What the energy is called, here and in model files.
pub(super) const ENERGY: &str = "energy";

/// Something that is known of a motion near a state.
#[derive(Clone, Debug)]
pub(super) struct Known {
    pub name: String,
    pub direction: DVector<f64>,
}

/// Slopes of what is conserved by [q; q']: energy, where nothing else than potentials does work, what the file says, and momenta along
/// shifts that change nothing.
pub(super) fn gradients(
    system: &dyn System,
    side: &Side,
    varies: &[usize],
    shifts: &[(String, DVector<f64>)],
) -> Vec<Known> {
    let n = system.len();
    let description = system.description();
    let mut names: Vec<String> = Vec::new();
    let conservative = acting::keeps_energy(system, varies, &side.y);
    let conservative = conservative && !description.invariants.iter().any(|quantity| quantity.name == ENERGY);
    if conservative {
        names.push(ENERGY.to_owned());
    }
    for quantity in description.invariants.iter() {
        match quantity.axes() {
            [] => names.push(quantity.name.to_string()),
            axes => names.extend(axes.iter().map(|axis| format!("{}.{axis}", quantity.name))),
        }
    }
    let at = At::packed(side.t, &side.y, n);
    let pairs = by_state(system, at, Function::Invariants, 2 * description.invariant_len());
    let energies = if conservative { energy(system, side).1 } else { vec![0.0; 2 * n] };
    let own = usize::from(conservative);
    let of = |place: usize| {
        let slope = |k: usize| if place < own { energies[k] } else { pairs[k][2 * (place - own)] };
        DVector::from_iterator(2 * n, (0..2 * n).map(slope))
    };
    let said = names.into_iter().enumerate().map(|(place, name)| Known { name, direction: of(place) });
    let momenta = conserving(system, side, varies, shifts.to_vec()).into_iter().map(|(name, shift)| Known {
        name: name.replacen("shift", "momentum", 1),
        direction: momentum(system, side, &shift).1,
    });
    said.chain(momenta).chain(lengths(system, side, true)).collect()
}

/// Of each rotation the rate q·q' of its quaternion's length, by [q; q'], or the growth (q, q') of that length, which is free: of such
/// quaternions only the direction matters.
fn lengths(system: &dyn System, side: &Side, rates: bool) -> Vec<Known> {
    let n = system.len();
    let description = system.description();
    let of = |first: usize| {
        let mut direction = DVector::zeros(2 * n);
        for i in first..first + 4 {
            let (q, v) = (side.y[i], side.y[n + i]);
            (direction[i], direction[n + i]) = if rates { (v, q) } else { (q, v) };
        }
        let name = description.coordinate_name(first);
        let rotation = name.rsplit_once('.').map_or(name.as_str(), |(rotation, _)| rotation);
        Known { name: format!("length of {rotation}"), direction }
    };
    description.rotations.iter().map(|first| of(*first as usize)).collect()
}

/// Of shifts that change nothing those whose momentum is conserved, as no force or constraint acts along them.
pub(super) fn conserving(
    system: &dyn System,
    side: &Side,
    varies: &[usize],
    shifts: Vec<(String, DVector<f64>)>,
) -> Vec<(String, DVector<f64>)> {
    let structure = &system.description().structure;
    let keeps_energy = acting::keeps_energy(system, varies, &side.y);
    let n = system.len();
    let active: Vec<usize> = rows_in_force(system).collect();
    let j = constraint_matrix(system, At::place(side.t, &side.y[..n]), &active);
    let cyclic = |k: usize| structure.cyclic.iter().any(|cyclic| *cyclic as usize == k);
    let conserves = |shift: &DVector<f64>| {
        let free = keeps_energy || shift.iter().enumerate().all(|(k, x)| *x == 0.0 || cyclic(k));
        free && (&j * shift).iter().zip(j.row_iter()).all(|(along, row)| along.abs() <= CONTAINED * row.norm())
    };
    shifts.into_iter().filter(|(_, shift)| conserves(shift)).collect()
}

/// The momentum along a shift e that changes nothing, p = e·∂T/∂q', and its slopes by [q; q']: ∂p/∂q' = M e and, as T and what has a
/// potential stay what they are, ∂p/∂q = −½ (D − Dᵀ) e with D = ∂F/∂q'.
pub(super) fn momentum(system: &dyn System, side: &Side, shift: &DVector<f64>) -> (f64, DVector<f64>) {
    let n = system.len();
    let at = At::packed(side.t, &side.y, n);
    let kinetic = by_state(system, at, Function::Energies, 5).into_iter().skip(n).map(|energies| energies[0]);
    let value = kinetic.zip(shift.iter()).map(|(slope, part)| slope * part).sum();
    let damping = slopes_by_speed(system, side);
    let places = -0.5 * (&damping - damping.transpose()) * shift;
    let speeds = mass_matrix(system, at) * shift;
    (value, DVector::from_iterator(2 * n, places.iter().chain(speeds.iter()).copied()))
}

/// Directions [δq; δq'] that a motion keeps: its own rate, shifts that change nothing, and, without constraints, the motion that each
/// conserved quantity C generates: M δq = ∂C/∂q', M δq' = −½ (D − Dᵀ) δq − ∂C/∂q with D = ∂F/∂q'.
pub(super) fn generators(
    system: &dyn System,
    side: &Side,
    (rate, gradients): (&[f64], &[Known]),
    shifts: &[(String, DVector<f64>)],
) -> Vec<Known> {
    let n = system.len();
    let mut list = vec![Known { name: "time".to_owned(), direction: DVector::from_row_slice(rate) }];
    for (name, shift) in shifts {
        let direction = DVector::from_iterator(2 * n, shift.iter().copied().chain(std::iter::repeat_n(0.0, n)));
        list.push(Known { name: name.clone(), direction });
    }
    list.extend(lengths(system, side, false));
    if !system.active_rows().is_empty() {
        return list;
    }
    let Some(mass) = mass_matrix(system, At::packed(side.t, &side.y, n)).cholesky() else { return list };
    let damping = slopes_by_speed(system, side);
    for gradient in gradients.iter().filter(|gradient| gradient.name != ENERGY) {
        let dq = mass.solve(&gradient.direction.rows(n, n).into_owned());
        let right = -0.5 * (&damping - damping.transpose()) * &dq - gradient.direction.rows(0, n);
        let dv = mass.solve(&right);
        let direction = DVector::from_iterator(2 * n, dq.iter().chain(dv.iter()).copied());
        list.push(Known { name: gradient.name.clone(), direction });
    }
    list
}

/// What to call the motion that a conserved quantity generates; of time and shifts their own name.
pub(super) fn motion_name(name: &str) -> String {
    if name == "time" || ["shift", "length"].iter().any(|word| name.starts_with(word)) {
        name.to_owned()
    } else {
        format!("the motion of `{name}`")
    }
}

/// ∂F/∂q', with the accelerations of the motion.
fn slopes_by_speed(system: &dyn System, side: &Side) -> DMatrix<f64> {
    let n = system.len();
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = At::packed(side.t, &side.y, n);
    let mut d = DMatrix::zeros(n, n);
    if system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
        return d;
    }
    let at = at.accelerated(&a).constrained(&lambda);
    for k in 0..n {
        let mut unit = vec![0.0; n];
        unit[k] = 1.0;
        let mut column = vec![0.0; n];
        system.slopes(Function::Residual, at, &Along { v: &unit, ..Along::default() }, &mut column);
        d.set_column(k, &DVector::from_vec(column));
    }
    d
}

/// Constant changes of coordinates, of unit length, that change no force, constraint or event at these states, each with a name.
pub(super) fn shifts(system: &dyn System, sides: &[Side]) -> Vec<(String, DVector<f64>)> {
    let n = system.len();
    let mut lines: Vec<DVector<f64>> = Vec::new();
    let mut here = system.boxed_clone();
    for side in sides {
        crate::vary::put(&mut *here, side);
        let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; here.description().rows.len()]);
        let at = At::packed(side.t, &side.y, n);
        if here.accelerations_and_multipliers(at, &mut a, &mut lambda).is_err() {
            continue;
        }
        let at = at.accelerated(&a).constrained(&lambda);
        let events = here.description().events.len();
        let rows = lambda.len();
        let sizes = [(Function::Residual, n), (Function::RowAccelerations, rows), (Function::Events, 2 * events)];
        for (function, size) in sizes {
            let mut block = DMatrix::zeros(size, n);
            for k in 0..n {
                let mut unit = vec![0.0; n];
                unit[k] = 1.0;
                let mut column = vec![0.0; size];
                here.slopes(function, at, &Along { q: &unit, ..Along::default() }, &mut column);
                block.set_column(k, &DVector::from_vec(column));
            }
            if function == Function::RowAccelerations {
                let active: Vec<usize> = rows_in_force(&*here).collect();
                let holonomic: Vec<usize> =
                    active.iter().copied().filter(|row| here.description().rows[*row].holonomic).collect();
                let j = constraint_matrix(&*here, At::place(side.t, &side.y[..n]), &holonomic);
                lines.extend(j.row_iter().map(|row| row.transpose().into_owned()));
                block = block.select_rows(&active);
            }
            lines.extend(
                block
                    .row_iter()
                    .map(|row| row.transpose().into_owned())
                    .filter(|row| row.iter().all(|x| x.is_finite())),
            );
        }
    }
    null_directions(n, &lines, system)
}

/// Directions that all lines leave out, with a name: single coordinates first.
fn null_directions(n: usize, lines: &[DVector<f64>], system: &dyn System) -> Vec<(String, DVector<f64>)> {
    let largest = lines.iter().map(|line| line.norm()).fold(0.0, f64::max);
    let counted: Vec<DVector<f64>> =
        lines.iter().filter(|line| line.norm() > f64::EPSILON * largest).map(|line| line.normalize()).collect();
    let mut j = DMatrix::zeros(counted.len().max(n), n);
    counted.iter().enumerate().for_each(|(i, line)| j.set_row(i, &line.transpose()));
    let Some(svd) = svd(j, false, true) else { return Vec::new() };
    let Some(vt) = svd.v_t else { return Vec::new() };
    let most = svd.singular_values.iter().fold(0.0_f64, |most, x| most.max(*x));
    let free: Vec<DVector<f64>> = (0..n)
        .filter(|k| svd.singular_values[*k] <= CONTAINED * most || most == 0.0)
        .map(|k| vt.row(k).transpose().into_owned())
        .collect();
    if free.is_empty() {
        return Vec::new();
    }
    // A basis of these that has as many zeros as it can: reduced row echelon form.
    let basis = echelon(&free);
    let name = |direction: &DVector<f64>| {
        let coordinates = &system.description().coordinates;
        let moved: Vec<String> = direction
            .iter()
            .zip(coordinates.iter())
            .filter(|(x, _)| x.abs() > CONTAINED)
            .map(|(_, coordinate)| coordinate.name.to_string())
            .collect();
        format!("shift of {}", moved.join(", "))
    };
    basis.into_iter().map(|direction| (name(&direction), direction)).collect()
}

/// The same subspace by vectors each of which has a 1 where the others have a 0.
fn echelon(list: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let mut rows: Vec<DVector<f64>> = list.to_vec();
    let n = rows[0].len();
    let mut done = 0;
    for column in 0..n {
        let best = (done..rows.len()).max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()));
        let Some(best) = best.filter(|best| rows[*best][column].abs() > CONTAINED) else { continue };
        rows.swap(done, best);
        let lead = rows[done].clone() / rows[done][column];
        for (k, row) in rows.iter_mut().enumerate() {
            *row = if k == done { lead.clone() } else { &*row - &lead * row[column] };
            row.iter_mut().filter(|x| x.abs() <= CONTAINED).for_each(|x| *x = 0.0);
        }
        done += 1;
    }
    rows.truncate(done);
    rows
}

/// Whether a map, of which so much is unknown, takes a direction before it to the same one behind it, or, for gradients, the other way round.
pub(super) fn holds(map: &DMatrix<f64>, (before, behind): (&Known, &Known), is_gradient: bool, unknown: f64) -> bool {
    let (from, taken, wanted) = match is_gradient {
        true => (&behind.direction, map.transpose() * &behind.direction, &before.direction),
        false => (&before.direction, map * &before.direction, &behind.direction),
    };
    let most = (HOLDS * taken.norm().max(wanted.norm())).max(unknown * from.norm());
    (&taken - wanted).norm() <= most || (&taken + wanted).norm() <= most
}

/// An orthonormal basis of a span; directions that others contain are left out.
pub(super) fn basis(list: &[DVector<f64>], d: usize) -> DMatrix<f64> {
    let unit: Vec<DVector<f64>> =
        list.iter().filter(|direction| direction.norm() > 0.0).map(|direction| direction.normalize()).collect();
    basis_within(&unit, d, CONTAINED)
}

/// The same of directions that count as none below a length.
pub(super) fn basis_within(list: &[DVector<f64>], d: usize, least: f64) -> DMatrix<f64> {
    let mut columns: Vec<DVector<f64>> = Vec::new();
    for direction in list {
        let mut rest = direction.clone();
        for _ in 0..2 {
            for column in &columns {
                rest -= column * column.dot(&rest);
            }
        }
        if rest.norm() > least {
            columns.push(rest.normalize());
        }
    }
    if columns.is_empty() { DMatrix::zeros(d, 0) } else { DMatrix::from_columns(&columns) }
}

/// An orthonormal basis of what is orthogonal to all columns within a space of which a basis is given.
pub(super) fn complement(within: &DMatrix<f64>, of: &DMatrix<f64>) -> DMatrix<f64> {
    let (k, m) = (within.ncols(), of.ncols());
    if m == 0 || k == 0 {
        return within.clone();
    }
    let inside = within.transpose() * of;
    let mut square = DMatrix::zeros(k.max(m), k);
    square.view_mut((0, 0), (m, k)).copy_from(&inside.transpose());
    let Some(svd) = svd(square, false, true) else { return within.clone() };
    let Some(vt) = svd.v_t else { return within.clone() };
    let free: Vec<DVector<f64>> =
        (0..k).filter(|i| svd.singular_values[*i] <= CONTAINED).map(|i| within * vt.row(i).transpose()).collect();
    if free.is_empty() { DMatrix::zeros(within.nrows(), 0) } else { DMatrix::from_columns(&free) }
}

/// The Jacobi integral of a state, J, and its slopes by [q; q'].
pub(super) fn energy(system: &dyn System, side: &Side) -> (f64, Vec<f64>) {
    let at = At::packed(side.t, &side.y, system.len());
    let slopes = by_state(system, at, Function::Energies, 5).into_iter().map(|energies| energies[2]);
    (system.energy(at).jacobi, slopes.collect())
}

/// The slope of the Jacobi integral by a parameter.
pub(super) fn energy_by_parameter(system: &dyn System, side: &Side, parameter: usize) -> f64 {
    let mut slopes = [0.0; 5];
    let along = Along { parameter: Some(parameter), ..Along::default() };
    system.slopes(Function::Energies, At::packed(side.t, &side.y, system.len()), &along, &mut slopes);
    slopes[2]
}

/// The slopes of a function's numbers by each of [q; q'].
fn by_state(system: &dyn System, at: At<'_>, function: Function, size: usize) -> Vec<Vec<f64>> {
    let n = system.len();
    let (rest, lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let at = at.accelerated(&rest).constrained(&lambda);
    let of = |k: usize| {
        let mut unit = vec![0.0; 2 * n];
        unit[k] = 1.0;
        let mut slopes = vec![0.0; size];
        system.slopes(function, at, &Along { q: &unit[..n], v: &unit[n..], ..Along::default() }, &mut slopes);
        slopes
    };
    (0..2 * n).map(of).collect()
}
