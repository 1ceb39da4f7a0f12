//! Columns at the start of a motion.

use nalgebra::{DMatrix, DVector};

use super::momenta::{momentum_slopes, rate_slopes};
use super::{NoSlopes, Unknown};
use crate::constrain::KeptSpin;
use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, mass_matrix, sizes_alike};
use crate::mechanism::{Along, At, Function, System, rows_in_force};

/// So much of a slope, beside the largest with its unit, is rounding of the equations that all slopes solve together.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A constraint is met by slopes that leave this part of what they had to make up for.
const MISSED: f64 = 1e-6;

/// A start: what was asked for, and what was found.
pub(super) struct Start<'a> {
    /// s.
    pub t: f64,
    /// [q; q'] as asked for.
    pub guess: &'a [f64],
    /// Which of them keep their values.
    pub held: &'a [bool],
    /// Angular velocities among what is held.
    pub spins: &'a [KeptSpin],
    /// [q; q'] as found.
    pub y: &'a [f64],
    /// The scene whose start it is, by parameters; `None`: it depends on none.
    pub scene: Option<usize>,
    /// Which of [q; q'] have another value than the scene's.
    pub given: &'a [bool],
}

/// What changes at the start: what is asked of [q; q'], and what of it is held so.
struct Change<'a> {
    asked: &'a [f64],
    held: &'a [bool],
    parameter: Option<usize>,
}

/// The slopes of the start [q; q'] by something unknown.
///
/// # Errors
/// A start that cannot change so: what is held leaves no way to meet the constraints.
pub(super) fn column(system: &dyn System, start: &Start<'_>, unknown: Unknown) -> Result<Vec<f64>, NoSlopes> {
    let n = system.len();
    let mut asked = vec![0.0; 2 * n];
    let mut of_scene = None;
    let parameter = match unknown {
        Unknown::Start(k) => {
            asked[k] = 1.0;
            None
        }
        Unknown::Parameter(k) => {
            if let Some(scene) = start.scene {
                let mut numbers = vec![0.0; 3 + 2 * n];
                let along = Along { parameter: Some(k), ..Along::default() };
                system.slopes(Function::Scene(scene), At::default(), &along, &mut numbers);
                let slopes = numbers.split_off(3);
                let given = slopes.iter().zip(start.given);
                asked.iter_mut().zip(given).for_each(|(x, (slope, given))| *x = if *given { 0.0 } else { *slope });
                of_scene = Some((system.scene(scene), slopes));
            }
            Some(k)
        }
    };
    let rows: Vec<usize> = rows_in_force(system).collect();
    // The rates of angular velocities go with the attitude, but for those that vary by themselves.
    let varies = |spin: &KeptSpin| matches!(unknown, Unknown::Start(k) if k >= n && spin.places().contains(&(k - n)));
    let spin = |places: &[f64], rates: &mut [f64]| {
        let spins = start.spins.iter().filter(|spin| !varies(spin));
        let of_scene = of_scene.as_ref().map(|(scene, slopes)| (scene, slopes.as_slice()));
        spins.for_each(|spin| spin.slopes((start.y, places), of_scene, rates));
    };
    if rows.is_empty() {
        let (places, rates) = asked.split_at_mut(n);
        spin(places, rates);
        return Ok(asked);
    }
    // What varies is held, as a value that is given is.
    let mut held = start.held.to_vec();
    if let Unknown::Start(k) = unknown {
        held[k] = true;
    }
    let change = Change { asked: &asked, held: &held, parameter };
    let lengths = Lengths::new(system, start, &held);
    let mut column = places(system, &Start { y: &lengths.nearest, ..*start }, &rows, &change)?;
    lengths.keep(start, &asked, &mut column);
    spin(&column[..n], &mut asked[n..]);
    speeds(system, start, &rows, &Change { asked: &asked, held: &held, parameter }, &mut column)?;
    Ok(column)
}

/// Rotations that nothing holds: the start gives them the lengths of the guess once the nearest place is found.
struct Lengths {
    /// The first coordinate of each.
    rotations: Vec<usize>,
    /// [q; q'] with the lengths of the nearest place: no constraint depends on them, so that it is as far from the guess as from the origin.
    nearest: Vec<f64>,
}

impl Lengths {
    fn new(system: &dyn System, start: &Start<'_>, held: &[bool]) -> Self {
        let mut nearest = start.y.to_vec();
        let all = system.description().rotations.iter().map(|first| *first as usize);
        let rotations: Vec<usize> = all.filter(|first| !held[*first..first + 4].contains(&true)).collect();
        for &first in &rotations {
            let [q, guess] = [start.y, start.guess].map(|y| DVector::from_column_slice(&y[first..first + 4]));
            let scaled = &q * (q.dot(&guess) / q.norm_squared());
            nearest[first..first + 4].copy_from_slice(scaled.as_slice());
        }
        Lengths { rotations, nearest }
    }

    /// Makes slopes of the nearest place those of the start: what leads along a rotation is that of the guess's length.
    fn keep(&self, start: &Start<'_>, asked: &[f64], column: &mut [f64]) {
        for &first in &self.rotations {
            let of = |y: &[f64]| DVector::from_column_slice(&y[first..first + 4]);
            let (q, nearest, guess) = (of(start.y), of(&self.nearest), of(start.guess));
            let turned = of(column) * (q.norm() / nearest.norm());
            let along = guess.dot(&of(asked)) / guess.norm() / q.norm() - q.dot(&turned) / q.norm_squared();
            column[first..first + 4].copy_from_slice((turned + &q * along).as_slice());
        }
    }
}

/// δq of the place nearest to the guess: of q − q₀ + Jᵀ μ = 0 in what is free and c = 0, the slopes
/// (1 + Σ μ ∂²c) δq + Jᵀ δμ = δq₀ − ∂(Jᵀ μ) and J δq = −∂c, by what is held and by the parameter on the right.
fn places(system: &dyn System, start: &Start<'_>, rows: &[usize], change: &Change<'_>) -> Result<Vec<f64>, NoSlopes> {
    let n = system.len();
    let Change { asked, held, parameter } = *change;
    let holonomic: Vec<usize> = rows.iter().copied().filter(|row| system.description().rows[*row].holonomic).collect();
    let free: Vec<usize> = (0..n).filter(|i| !held[*i]).collect();
    let q = &start.y[..n];
    let mut column = asked.to_vec();
    free.iter().for_each(|i| column[*i] = 0.0);
    let along = Along { q: &column[..n], parameter, ..Along::default() };
    let missed = missed_places(system, start, &holonomic, &along);
    let place = At::place(start.t, q);
    let a = constraint_matrix(system, place, &holonomic).select_columns(&free);
    let (f, r) = (free.len(), holonomic.len());
    let pull = DMatrix::from_iterator(f, 1, free.iter().map(|i| start.guess[*i] - q[*i]));
    let pulls: Vec<f64> =
        solve_least(&a.transpose(), &pull).map_or_else(|| vec![0.0; r], |x| x.iter().copied().collect());
    let at_rest = vec![0.0; n];
    // −∂(Jᵀ μ) along a direction.
    let turned = |along: &Along<'_>| {
        momentum_slopes(system, At::packed(start.t, start.y, n), &at_rest, (&holonomic, &pulls), along)
    };
    let mut k = DMatrix::identity(f + r, f + r);
    k.view_mut((f, f), (r, r)).fill(0.0);
    k.view_mut((0, f), (f, r)).copy_from(&a.transpose());
    k.view_mut((f, 0), (r, f)).copy_from(&a);
    for (line, i) in free.iter().enumerate() {
        let mut unit = at_rest.clone();
        unit[*i] = 1.0;
        let slopes = turned(&Along { q: &unit, ..Along::default() });
        free.iter().enumerate().for_each(|(row, j)| k[(row, line)] -= slopes[*j]);
    }
    let by_others = turned(&along);
    let wanted = DVector::from_iterator(f, free.iter().map(|i| asked[*i] + by_others[*i]));
    let right = wanted.iter().copied().chain(missed.iter().map(|x| -x));
    if let Some(solution) = solve_least(&k, &DMatrix::from_iterator(f + r, 1, right)) {
        free.iter().zip(solution.iter()).for_each(|(i, step)| column[*i] = *step);
        leave_out_rounding(system, &free, &mut column[..n]);
    }
    let left = missed_places(system, start, &holonomic, &Along { q: &column[..n], parameter, ..Along::default() });
    closed(system, place, &holonomic, (&left, &missed, size(&column[..n]).max(wanted.norm())))?;
    Ok(column)
}

/// Makes slopes of free places, or rates, 0 that are rounding beside others.
fn leave_out_rounding(system: &dyn System, free: &[usize], slopes: &mut [f64]) {
    let sizes = sizes_alike(system.description(), slopes);
    for i in free {
        if slopes[*i].abs() <= ROUNDING * sizes[*i] {
            slopes[*i] = 0.0;
        }
    }
}

/// The slopes of c of these rows along a direction.
fn missed_places(system: &dyn System, start: &Start<'_>, rows: &[usize], along: &Along<'_>) -> Vec<f64> {
    let n = system.len();
    let mut triples = vec![0.0; 3 * system.description().rows.len()];
    system.slopes(Function::Constraints, At::packed(start.t, start.y, n), along, &mut triples);
    rows.iter().map(|row| triples[3 * row]).collect()
}

/// Refuses what misses constraints: everything that would meet them is held.  What is left is seen beside what was to be made up for, and beside
/// what the longest way makes of the constraint: that of the solution, or the one that it would be without the constraints, which may hold all of it
/// so that rounding is all that is left of both.
fn closed(
    system: &dyn System,
    place: At<'_>,
    rows: &[usize],
    (left, before, way): (&[f64], &[f64], f64),
) -> Result<(), NoSlopes> {
    let j = constraint_matrix(system, place, rows);
    let misses = |k: &usize| left[*k].abs() > MISSED * (j.row(*k).norm() * way).max(before[*k].abs());
    match (0..rows.len()).find(misses) {
        Some(k) => Err(NoSlopes::HeldStart {
            unknown: String::new(),
            constraint: system.description().rows[rows[k]].name.to_string(),
        }),
        None => Ok(()),
    }
}

/// δq' of the speeds of least kinetic energy among those that the constraints and what is held allow: the slopes of
/// [M q' − Jᵀ μ] = 0 in what is free, and of c' = 0.
fn speeds(
    system: &dyn System,
    start: &Start<'_>,
    rows: &[usize],
    change: &Change<'_>,
    column: &mut [f64],
) -> Result<(), NoSlopes> {
    let n = system.len();
    let (asked, held, parameter) = (&change.asked[n..], &change.held[n..], change.parameter);
    let (q, v) = start.y.split_at(n);
    let free: Vec<usize> = (0..n).filter(|i| !held[*i]).collect();
    let place = At::new(start.t, q, v);
    let (mass, j) = (mass_matrix(system, place), constraint_matrix(system, place, rows));
    let (m, a) = (mass.select_rows(&free).select_columns(&free), j.select_columns(&free));
    let (f, r) = (free.len(), rows.len());
    let mut k = DMatrix::zeros(f + r, f + r);
    k.view_mut((0, 0), (f, f)).copy_from(&m);
    k.view_mut((0, f), (f, r)).copy_from(&(-a.transpose()));
    k.view_mut((f, 0), (r, f)).copy_from(&a);
    // The multipliers of the start's own speeds.
    let momenta = mass.select_rows(&free) * DVector::from_row_slice(v);
    let known = DMatrix::from_iterator(f, 1, momenta.iter().copied());
    let impulses = solve_least(&a.transpose(), &known).map_or_else(|| vec![0.0; r], |x| x.iter().copied().collect());
    column[n..].copy_from_slice(asked);
    free.iter().for_each(|i| column[n + i] = 0.0);
    let (places, rates) = column.split_at(n);
    let along = Along { q: places, v: rates, parameter, ..Along::default() };
    let turned = momentum_slopes(system, At::new(start.t, q, v), v, (rows, &impulses), &along);
    let coupled = mass.select_rows(&free) * DVector::from_row_slice(rates);
    let missed = rate_slopes(system, At::new(start.t, q, v), &along);
    let momenta = free.iter().zip(coupled.iter()).map(|(i, coupled)| -turned[*i] - coupled);
    let momenta = DMatrix::from_iterator(f, 1, momenta);
    let unheld = solve_least(&m, &momenta).map_or(0.0, |speeds| speeds.norm());
    let right = momenta.iter().copied().chain(rows.iter().map(|row| -missed[*row]));
    let right = DMatrix::from_iterator(f + r, 1, right);
    if let Some(solution) = solve_least(&k, &right) {
        free.iter().zip(solution.iter()).for_each(|(i, v)| column[n + i] = *v);
        leave_out_rounding(system, &free, &mut column[n..]);
    }
    let (places, rates) = column.split_at(n);
    let left =
        rate_slopes(system, At::new(start.t, q, v), &Along { q: places, v: rates, parameter, ..Along::default() });
    let of_rows = |list: &[f64]| rows.iter().map(|row| list[*row]).collect::<Vec<f64>>();
    closed(system, place, rows, (&of_rows(&left), &of_rows(&missed), size(rates).max(unheld)))
}

fn size(list: &[f64]) -> f64 {
    DVector::from_row_slice(list).norm()
}
