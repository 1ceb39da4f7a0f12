//! How contacts that stick together share a force that the equations leave undetermined, as that of two feet of one body.
//!
//! They stay as long as they can share it so that none is beyond its limit (the static theorem of limit analysis; Drucker, Prager, Greenberg,
//! Q. Appl. Math. 9, 1952, 381).  Of all shares that the equations admit the one is taken at which the largest part of a limit that any needs is the
//! least: min over w of max |T + Z w|/L(w).  What friction presses harder or less, as the wall that a ladder leans on, has limits that grow with it; how
//! contacts share what presses them without friction stays what it is.

use nalgebra::{DMatrix, DVector};

use super::IN_SPAN;
use super::bounds::Bound;
use super::least_largest::{Part, least_largest};
use crate::matrix::{solve_least, svd};
use crate::mechanism::dense::{constraint_matrix, mass_matrix, multiplier_effects};
use crate::mechanism::{At, ContactEvent, ContactMode, Singular, System, rows_in_force};

/// What can hold nothing has this part of the largest limit, so that it is given no force that another one can take.
const LEAST: f64 = 1e-12;

/// Accelerations and multipliers at a state, those of what sticks being shared so that the least part of any limit is needed.
///
/// # Errors
/// As [`System::accelerations`].
pub(crate) fn with_shares<S: System + ?Sized>(system: &S, at: At<'_>) -> Result<(Vec<f64>, Vec<f64>), Singular> {
    shared(system, at, &groups(system, at))
}

/// The same where anything is shared.
pub(crate) fn where_shared<S: System + ?Sized>(system: &S, at: At<'_>) -> Option<(Vec<f64>, Vec<f64>)> {
    let groups = groups(system, at);
    if groups.is_empty() { None } else { shared(system, at, &groups).ok() }
}

fn shared<S: System + ?Sized>(system: &S, at: At<'_>, groups: &[Group]) -> Result<(Vec<f64>, Vec<f64>), Singular> {
    let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
    system.accelerations_and_multipliers(at, &mut a, &mut lambda)?;
    groups.iter().for_each(|group| group.share(system, at.accelerated(&a), &mut lambda));
    Ok((a, lambda))
}

/// Rows that depend on each other: of contacts that stick, along which they hold, and of constraints.
struct Group {
    rows: Vec<usize>,
    /// Combinations of multipliers of these rows that do nothing together, a column each.
    idle: DMatrix<f64>,
    /// The contacts that stick among them.
    contacts: Vec<usize>,
    /// The rows across others that touch.
    pressed: Vec<usize>,
}

/// The groups that share something in the phase in force.
fn groups<S: System + ?Sized>(system: &S, at: At<'_>) -> Vec<Group> {
    let contacts = system.contacts();
    if contacts.all.is_empty() {
        return Vec::new();
    }
    let modes = contacts.modes(system.phase());
    let sticking: Vec<usize> = (0..modes.len()).filter(|k| modes[*k] == ContactMode::Sticks).collect();
    let rows: Vec<usize> = rows_in_force(system).collect();
    if sticking.is_empty() || rows.len() < 2 {
        return Vec::new();
    }
    let normals: Vec<usize> = contacts.all.iter().filter_map(|contact| Some(contact.normal? as usize)).collect();
    let mut matrix = multiplier_effects(system, at, &rows).transpose();
    let (mut inertias, mut room) = (vec![0.0; system.len()], Vec::new());
    system.inertias(at, &mut room, &mut inertias);
    for (mut column, inertia) in matrix.column_iter_mut().zip(inertias) {
        column *= if inertia > 0.0 { 1.0 / inertia.sqrt() } else { 1.0 };
    }
    let mut found = Vec::new();
    let of_one = |row: usize, other: usize| {
        let has = |k: &usize, place: usize| {
            let own = contacts.all[*k].tangents().chain(contacts.all[*k].normal);
            own.into_iter().any(|row| row as usize == rows[place])
        };
        sticking.iter().any(|k| has(k, row) && has(k, other))
    };
    for places in connected(&matrix, &of_one) {
        let rows: Vec<usize> = places.iter().map(|place| rows[*place]).collect();
        let own = |k: &usize| contacts.all[*k].tangents().any(|row| rows.contains(&(row as usize)));
        let sticking: Vec<usize> = sticking.iter().copied().filter(own).collect();
        if rows.len() < 2 || sticking.is_empty() {
            continue;
        }
        let across: Vec<usize> = (0..rows.len()).filter(|place| normals.contains(&rows[*place])).collect();
        let own = |row: &usize| sticking.iter().any(|k| contacts.all[*k].normal == Some(*row as u32));
        let pressed = rows.iter().copied().filter(|row| normals.contains(row) && !own(row)).collect();
        if let Some(idle) = idle_of(system, at, &rows, (&matrix.select_rows(&places), &across)) {
            found.push(Group { rows, idle, contacts: sticking, pressed });
        }
    }
    found
}

/// The rows of a matrix in groups that have no column in common, and of which no two are `of_one` contact.
fn connected(matrix: &DMatrix<f64>, of_one: &dyn Fn(usize, usize) -> bool) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for row in 0..matrix.nrows() {
        let meets = |group: &Vec<usize>| {
            let meet = |other: usize| (0..matrix.ncols()).any(|i| matrix[(row, i)] != 0.0 && matrix[(other, i)] != 0.0);
            group.iter().any(|other| of_one(row, *other) || meet(*other))
        };
        let (mut joined, others): (Vec<_>, Vec<_>) = groups.into_iter().partition(meets);
        joined.push(vec![row]);
        groups = others;
        groups.push(joined.concat());
    }
    groups
}

/// w with wᵀ J = 0, a column each; `None` where the rows do not depend on each other.
fn idle(rows: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let (count, n) = rows.shape();
    let norms: Vec<f64> = rows.row_iter().map(|row| row.norm()).collect();
    // With as many columns as rows there are as many vectors on the left.
    let mut square = rows.clone().resize_horizontally(n.max(count), 0.0);
    square.row_iter_mut().zip(&norms).filter(|(_, norm)| **norm > 0.0).for_each(|(mut row, norm)| row /= *norm);
    let svd = svd(square, true, false)?;
    let largest = svd.singular_values.max();
    let vectors = svd.u?;
    let columns: Vec<DVector<f64>> = (0..count)
        .filter(|k| svd.singular_values[*k] <= IN_SPAN * largest)
        .map(|k| DVector::from_fn(count, |i, _| if norms[i] > 0.0 { vectors[(i, k)] / norms[i] } else { 0.0 }))
        .collect();
    (!columns.is_empty()).then(|| DMatrix::from_columns(&columns))
}

/// Those of some directions in which these forms, a row each, vanish.
fn within(directions: &DMatrix<f64>, forms: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let values = forms * directions;
    let count = directions.ncols();
    let square = values.resize_vertically(forms.nrows().max(count), 0.0);
    let svd = svd(square, false, true)?;
    let vectors = svd.v_t?;
    let nothing = IN_SPAN * forms.norm() * directions.norm();
    let kept: Vec<usize> = (0..count).filter(|k| svd.singular_values[*k] <= nothing).collect();
    (!kept.is_empty()).then(|| directions * vectors.select_rows(&kept).transpose())
}

/// Idle combinations but for those of forces across alone, which are shared as they are; and without forces across where something is not pressed but by
/// friction: what nothing presses at first, as a rod that falls between two walls, does not jam.
fn idle_of<S: System + ?Sized>(
    system: &S,
    at: At<'_>,
    rows: &[usize],
    (effects, across): (&DMatrix<f64>, &[usize]),
) -> Option<DMatrix<f64>> {
    let all = idle(effects)?;
    if across.is_empty() {
        return Some(all);
    }
    let of_normals: Vec<usize> = across.iter().map(|place| rows[*place]).collect();
    let unit = |list: &[usize]| DMatrix::from_fn(list.len(), rows.len(), |i, j| f64::from(u8::from(list[i] == j)));
    let mut mixed = match idle(&constraint_matrix(system, at, &of_normals)) {
        Some(alone) => within(&all, &(alone.transpose() * unit(across)))?,
        None => all.clone(),
    };
    let largest = mixed.amax();
    let (moved, still): (Vec<usize>, Vec<usize>) =
        across.iter().copied().partition(|row| mixed.row(*row).amax() > IN_SPAN * largest);
    still.into_iter().for_each(|row| mixed.row_mut(row).fill(0.0));
    if moved.is_empty() {
        return Some(mixed);
    }
    let pressed = pressed_without_friction(system, at)?;
    match moved.iter().all(|place| pressed[rows[*place]] > 0.0) {
        true => Some(mixed),
        false => within(&all, &unit(across)).map(|mut idle| {
            across.iter().for_each(|row| idle.row_mut(*row).fill(0.0));
            idle
        }),
    }
}

/// The multipliers where what sticks is held by nothing along; 0 where they are rounding.
fn pressed_without_friction<S: System + ?Sized>(system: &S, at: At<'_>) -> Option<Vec<f64>> {
    let (n, count) = (at.q.len(), system.description().rows.len());
    let contacts = system.contacts();
    let modes = contacts.modes(system.phase());
    let sticks = |row: &usize| {
        let own =
            |k: usize| modes[k] == ContactMode::Sticks && contacts.all[k].tangents().any(|own| own as usize == *row);
        (0..modes.len()).any(own)
    };
    let rows: Vec<usize> = rows_in_force(system).filter(|row| !sticks(row)).collect();
    let (mut h, mut gamma) = (vec![0.0; n], vec![0.0; count]);
    system.bias(at, &mut h);
    system.constraint_bias(at, &mut gamma);
    let effects = multiplier_effects(system, at, &rows);
    let mut right = effects.insert_column(rows.len(), 0.0);
    right.column_mut(rows.len()).copy_from_slice(&h);
    let moved = solve_least(&mass_matrix(system, at), &right)?;
    let matrix = constraint_matrix(system, at, &rows);
    let flexibility = &matrix * moved.columns(0, rows.len());
    let free = &matrix * moved.column(rows.len());
    let wanted = DVector::from_fn(rows.len(), |i, _| free[i] - gamma[rows[i]]);
    let svd = svd(flexibility.clone(), true, true)?;
    let nothing = IN_SPAN * svd.singular_values.max();
    let found = svd.solve(&wanted, nothing).ok()?;
    let mut lambda = vec![0.0; count];
    for (i, row) in rows.iter().enumerate() {
        // Beside what of it the forces and the rates make one by one.
        let terms: f64 =
            (0..n).map(|k| (matrix[(i, k)] * moved[(k, rows.len())]).abs()).sum::<f64>() + gamma[*row].abs();
        let least = IN_SPAN * terms / flexibility[(i, i)].abs().max(f64::MIN_POSITIVE);
        lambda[*row] = if found[i].abs() > least { found[i] } else { 0.0 };
    }
    Some(lambda)
}

impl Group {
    fn share<S: System + ?Sized>(&self, system: &S, at: At<'_>, lambda: &mut [f64]) {
        let contacts = &system.contacts().all;
        let events = |lambda: &[f64]| {
            let mut pairs = vec![0.0; 2 * system.description().events.len()];
            system.events(at.constrained(lambda), &mut pairs);
            pairs
        };
        let (here, coefficients) = (events(lambda), events(&self.pressed_by_one(system, lambda)));
        let place = |row: u32| self.rows.iter().position(|own| *own == row as usize);
        let unmoved = || DVector::zeros(self.idle.ncols());
        // L² − T² is the function of the event at which it slips; of a contact L is what it is for a force across of 1, times that force.
        let limit = |k: usize| {
            let slips = contacts[k].event(ContactEvent::Slips)?;
            if let Some(row) = contacts[k].normal {
                let coefficient = coefficients[2 * slips].max(0.0).sqrt();
                let slope = self.idle.row(place(row)?).transpose() * coefficient;
                return Some(Bound { slope, value: coefficient * lambda[row as usize] });
            }
            let force: f64 = contacts[k].tangents().map(|row| lambda[row as usize].powi(2)).sum();
            Some(Bound { slope: unmoved(), value: (here[2 * slips] + force).max(0.0).sqrt() })
        };
        let limits: Vec<Option<Bound>> = self.contacts.iter().map(|k| limit(*k)).collect();
        let least = LEAST * limits.iter().flatten().fold(0.0_f64, |most, limit| most.max(limit.value.abs()));
        let sticking = self.contacts.iter().zip(limits).filter_map(|(k, limit)| {
            let rows: Vec<u32> = contacts[*k].tangents().collect();
            let places: Vec<usize> = rows.iter().map(|row| place(*row)).collect::<Option<_>>()?;
            let Bound { slope, value } = limit?;
            // What holds nothing, whatever presses it, has a limit all the same.
            let value = if slope.amax() == 0.0 { value.max(least) } else { value };
            let force = DVector::from_iterator(rows.len(), rows.iter().map(|row| lambda[*row as usize]));
            Some(Part { force, idle: self.idle.select_rows(&places), limit: Bound { slope, value } })
        });
        let pressed = self.pressed.iter().filter_map(|row| {
            let (force, idle) = (DVector::zeros(1), DMatrix::zeros(1, self.idle.ncols()));
            let slope = self.idle.row(place(*row as u32)?).transpose();
            (slope.amax() > 0.0).then(|| Part { force, idle, limit: Bound { slope, value: lambda[*row] } })
        });
        let parts: Vec<Part> = sticking.chain(pressed).collect();
        if let Some(w) = least_largest(&parts) {
            let added = &self.idle * w;
            self.rows.iter().zip(added.iter()).for_each(|(row, more)| lambda[*row] += more);
        }
    }

    /// Multipliers with a force across of 1 in each of these contacts, and none along.
    fn pressed_by_one<S: System + ?Sized>(&self, system: &S, lambda: &[f64]) -> Vec<f64> {
        let mut pressed = lambda.to_vec();
        for contact in self.contacts.iter().map(|k| &system.contacts().all[*k]).filter(|one| one.normal.is_some()) {
            contact.tangents().for_each(|row| pressed[row as usize] = 0.0);
            contact.normal.into_iter().for_each(|row| pressed[row as usize] = 1.0);
        }
        pressed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feet of a plate that is pushed and turned, each share to twelve digits: none can be better.
    #[test]
    fn the_best_share_is_exact() {
        let places = [[0.5, 0.1], [-0.3, 0.4], [0.0, -0.6], [0.2, 0.7], [-0.8, -0.2]];
        for count in 2..=5 {
            let rates = DMatrix::from_fn(2 * count, 3, |i, j| match j {
                2 => [-places[i / 2][1], places[i / 2][0]][i % 2],
                j => f64::from(u8::from(i % 2 == j)),
            });
            let idle = idle(&rates).expect("idle forces");
            for push in [[1.0, 0.0, 0.0], [0.3, -0.8, 0.2], [0.0, 0.0, 1.0]] {
                let held = &rates
                    * crate::matrix::solve_least(&rates.tr_mul(&rates), &DMatrix::from_column_slice(3, 1, &push))
                        .expect("forces");
                let part = |k: usize| Part {
                    force: DVector::from_fn(2, |i, _| held[2 * k + i]),
                    idle: idle.rows(2 * k, 2).into_owned(),
                    limit: Bound { slope: DVector::zeros(idle.ncols()), value: 1.0 + 0.7 * k as f64 },
                };
                let parts: Vec<Part> = (0..count).map(part).collect();
                let w = least_largest(&parts).expect("a share");
                let most = |w: &DVector<f64>| parts.iter().map(|part| part.ratio(w)).fold(0.0, f64::max);
                let best = most(&w);
                for i in 0..w.len() {
                    for step in [1e-3, -1e-3, 1e-6, -1e-6] {
                        let mut moved = w.clone();
                        moved[i] += step;
                        assert!(most(&moved) >= best * (1.0 - 1e-12), "{count} {push:?}: {best}, {}", most(&moved));
                    }
                }
            }
        }
    }

    #[test]
    fn what_shares_nothing_is_left() {
        let matrix = DMatrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(connected(&matrix, &|_, _| false).len(), 3);
        assert_eq!(connected(&matrix, &|i, j| i + j == 1), [vec![0, 1], vec![2]]);
        assert!(idle(&matrix.rows(0, 2).into_owned()).is_none());
        let idle = idle(&DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 2.0, 0.0, 0.0, 1.0])).expect("one");
        assert!(idle.ncols() == 1 && (idle[(0, 0)] + 2.0 * idle[(1, 0)]).abs() < 1e-15 && idle[(2, 0)].abs() < 1e-15);
    }
}
