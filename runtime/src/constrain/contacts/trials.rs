//! Forces and accelerations under one combination of modes, and whether they agree with it.

use nalgebra::DMatrix;

use super::directions::{along, consistent};
use super::known::Known;
use super::modes::PutOnSides;
use super::share::with_shares;
use super::springs::length_of_springs;
use super::{held_direction, hold_direction};
use crate::matrix::{equilibrated, rank, solve_least};
use crate::mechanism::dense::{constraint_matrix, mass_matrix, multiplier_effects};
use crate::mechanism::{At, ContactEvent, ContactMode, Enforcement, Singular, Solutions, System, rows_in_force};

/// A force, or an acceleration, below this part of the largest under any combination is zero.
const NOTHING: f64 = 1e-10;
/// A row in force of which more than this part of the largest acceleration is left is not met: it depends on others that ask for something else, as the
/// rate of a piston at its dead centre.
const MET: f64 = 1e-7;
/// A singular value below this part of about 1 leaves a motion undetermined: where friction takes all of what a force does, forces grow without bound.
const DETERMINED: f64 = 1e-9;
/// Accelerations that differ by less than this part of the largest are the same motion.
const ALIKE: f64 = 1e-8;
/// A force at its limit is so to the rounding of its instant; one that is further below it, as a part of it, is held by less.
pub(super) const RELEASED: f64 = 1e-6;

/// What all combinations share.
#[derive(Clone, Copy)]
pub(super) struct Shared<'a> {
    pub known: &'a [Known],
    /// J M⁻¹ Jᵀ of each row by itself.
    pub compliance: &'a [f64],
    /// Where a motion begins, what puts the discontinuities on their sides under a combination.
    pub begins: Option<PutOnSides>,
}

/// What is tried under one combination.
#[derive(Clone)]
pub(super) struct Trial {
    pub modes: Vec<ContactMode>,
    /// Of each contact what must not be negative, with the size beside which it is judged.
    pub signs: Vec<Vec<Sign>>,
    pub accelerations: Vec<f64>,
    /// What is held, with the directions in which it slides in space.
    pub memory: Vec<f64>,
}

/// A number that is not negative where a combination is the motion's.
#[derive(Clone, Copy)]
pub(super) struct Sign {
    pub kind: Kind,
    pub value: f64,
    /// The sum of the terms beside which it is rounding.
    pub terms: f64,
}

#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// N J M⁻¹ Jᵀ, what the force does to g''; or g''.
    Pressed,
    Opens,
    /// By how much springs would be long there, at the least, that are like those of all contacts, where nothing opens the gap.
    Free,
    /// (L₀² − T²)/(L₀² + T²).
    Holds,
    /// ±s'.
    Slides,
}

/// Whether two of some trials make the same accelerations.
pub(super) fn alike(trials: &[Trial]) -> impl Fn(&Trial, &Trial) -> bool {
    let scale = trials.iter().flat_map(|trial| &trial.accelerations).fold(0.0_f64, |most, a| most.max(a.abs()));
    move |one, other| one.accelerations.iter().zip(&other.accelerations).all(|(a, b)| (a - b).abs() <= ALIKE * scale)
}

impl Trial {
    /// Whether something sticks, and all that does could hold more.
    pub fn holds(&self) -> bool {
        let mut left_over = self.signs.iter().flatten().filter(|sign| sign.kind == Kind::Holds).peekable();
        left_over.peek().is_some() && left_over.all(|sign| sign.value > RELEASED)
    }
}

/// Whether all that a combination does otherwise than another is to slide where the other one sticks.
pub(super) fn slides_where_sticks(modes: &[ContactMode], other: &[ContactMode], known: &[Known]) -> bool {
    let instead = |((own, other), known): ((&ContactMode, &ContactMode), &Known)| {
        own == other || known.rolls && own.sliding() != 0.0 && *other == ContactMode::Sticks
    };
    modes.iter().zip(other).zip(known).all(instead)
}

/// Puts a combination in force, with the sides of discontinuities that it has where a motion begins.
pub(super) fn enter(system: &mut dyn System, (t, y): (f64, &[f64]), shared: Shared<'_>, modes: &[ContactMode]) {
    let phase = system.contacts().phase(modes);
    system.set_phase(phase);
    if let Some(put_on_sides) = shared.begins {
        put_on_sides(system, t, y);
    }
}

/// Forces and accelerations under a combination, with all directions in which contacts of space may begin to slide; none where there are none.
pub(super) fn tried(
    system: &mut dyn System,
    at: (f64, &[f64]),
    shared: Shared<'_>,
    modes: Vec<ContactMode>,
) -> Vec<Trial> {
    let begins = |k: &usize| modes[*k] == ContactMode::Slides && shared.known[*k].rolls;
    let beginning: Vec<usize> = (0..modes.len()).filter(begins).collect();
    let memory = system.memory().to_vec();
    let guesses = match beginning.as_slice() {
        [] => Vec::new(),
        _ => against_forces(system, at, &modes, &beginning),
    };
    enter(system, at, shared, &modes);
    let rates = (guesses.len() > 1).then(|| rates_left(system, at, &beginning));
    let aimed = |system: &mut dyn System, directions: &[[f64; 2]]| {
        for (k, direction) in beginning.iter().zip(directions) {
            hold_direction(system, *k, *direction, shared.known[*k].least);
        }
    };
    let tangents: Vec<Option<usize>> =
        system.contacts().all.iter().map(|contact| contact.tangent.map(|row| row as usize)).collect();
    let found = consistent(&guesses, rates, &mut |directions| {
        aimed(system, directions);
        let Motion { second, .. } = Motion::of(system, at)?;
        beginning.iter().map(|k| tangents[*k].map(|row| [second[row], second[row + 1]])).collect()
    });
    let mut trials = Vec::new();
    for directions in found {
        aimed(system, &directions);
        trials.extend(trial_of(system, at, shared, &modes));
    }
    system.set_memory(&memory);
    trials
}

/// The rates of sliding of these contacts that the constraints in force leave, as columns.
fn rates_left(system: &dyn System, (t, y): (f64, &[f64]), contacts: &[usize]) -> DMatrix<f64> {
    let at = At::packed(t, y, system.len());
    let held: Vec<usize> = rows_in_force(system).collect();
    let left = Solutions::of(&constraint_matrix(system, at, &held), &[]).basis;
    let all = &system.contacts().all;
    let sliding: Vec<usize> = contacts.iter().flat_map(|k| all[*k].tangents()).map(|row| row as usize).collect();
    constraint_matrix(system, at, &sliding) * left
}

/// The directions against the forces with which contacts would stick.
pub(super) fn against_forces(
    system: &mut dyn System,
    (t, y): (f64, &[f64]),
    modes: &[ContactMode],
    contacts: &[usize],
) -> Vec<[f64; 2]> {
    let mut stuck = modes.to_vec();
    contacts.iter().for_each(|k| stuck[*k] = ContactMode::Sticks);
    let phase = system.contacts().phase(&stuck);
    system.set_phase(phase);
    let solved = with_shares(system, At::packed(t, y, system.len()));
    let all = &system.contacts().all;
    let against = |k: &usize| match (&solved, all[*k].tangent) {
        (Ok((_, lambda)), Some(row)) => {
            let force = [-lambda[row as usize], -lambda[row as usize + 1]];
            if force == [0.0; 2] { [1.0, 0.0] } else { along(force) }
        }
        _ => [1.0, 0.0],
    };
    contacts.iter().map(against).collect()
}

/// Accelerations, multipliers, and c'' of all rows with the sums of its absolute terms.
pub(super) struct Motion {
    pub a: Vec<f64>,
    pub lambda: Vec<f64>,
    pub second: Vec<f64>,
    pub terms: Vec<f64>,
}

impl Motion {
    /// In the phase in force; `None` where there is none.
    pub fn of(system: &dyn System, (t, y): (f64, &[f64])) -> Option<Motion> {
        let at = At::packed(t, y, system.len());
        let (a, lambda) = match with_shares(system, at) {
            Ok(found) => found,
            Err(Singular::Friction { .. }) => where_pressing_opens(system, at)?,
            Err(_) => return None,
        };
        let mut second = vec![0.0; lambda.len()];
        system.constraint_bias(at, &mut second);
        let mut values = vec![0.0; system.description().constraint_pattern.len()];
        system.constraint_matrix(at, &mut values);
        let mut terms: Vec<f64> = second.iter().map(|bias| bias.abs()).collect();
        for ((row, column), value) in system.description().constraint_pattern.iter().zip(values) {
            let term = value * a[*column as usize];
            second[*row as usize] += term;
            terms[*row as usize] += term.abs();
        }
        Some(Motion { a, lambda, second, terms })
    }
}

/// Accelerations and multipliers that rows in force have also where friction makes what presses a contact open it, as it does to a rod that slides on
/// ahead of its foot: M a − (Jᵀ + B) λ = −h and J a = −γ; `None` where these do not determine them.
///
/// Such a motion is not run, but is one of the several that Painlevé (1895) found.
fn where_pressing_opens(system: &dyn System, at: At<'_>) -> Option<(Vec<f64>, Vec<f64>)> {
    let (n, count) = (system.len(), system.description().rows.len());
    let rows: Vec<usize> = rows_in_force(system).collect();
    let (mut bias, mut gamma) = (vec![0.0; n], vec![0.0; count]);
    system.bias(at, &mut bias);
    system.constraint_bias(at, &mut gamma);
    let order = n + rows.len();
    let mut matrix = DMatrix::zeros(order, order);
    matrix.view_mut((0, 0), (n, n)).copy_from(&mass_matrix(system, at));
    matrix.view_mut((0, n), (n, rows.len())).copy_from(&-multiplier_effects(system, at, &rows));
    matrix.view_mut((n, 0), (rows.len(), n)).copy_from(&constraint_matrix(system, at, &rows));
    let right: Vec<f64> = bias.iter().copied().chain(rows.iter().map(|row| gamma[*row])).map(|term| -term).collect();
    if rank(equilibrated(&matrix).0, DETERMINED)? < order {
        return None;
    }
    let found = solve_least(&matrix, &DMatrix::from_column_slice(order, 1, &right))?;
    let mut lambda = vec![0.0; count];
    rows.iter().zip(&found.as_slice()[n..]).for_each(|(row, value)| lambda[*row] = *value);
    Some((found.as_slice()[..n].to_vec(), lambda))
}

/// Forces and accelerations in the combination in force, with the directions that are held; `None` where there are none.
pub(super) fn trial_of(
    system: &dyn System,
    (t, y): (f64, &[f64]),
    Shared { known, compliance, .. }: Shared<'_>,
    modes: &[ContactMode],
) -> Option<Trial> {
    let Motion { a, lambda, second, terms } = Motion::of(system, (t, y))?;
    let contacts = &system.contacts().all;
    // Where all rests accelerations are rounding, beside what forces would make of them.
    let size = |row: usize| terms[row].max((compliance[row] * lambda[row]).abs());
    let scale = rows_in_force(system).map(size).fold(0.0, f64::max);
    let met = rows_in_force(system).all(|row| second[row].abs() <= MET * scale);
    if system.enforcement() == Enforcement::Multipliers && !met {
        return None;
    }
    let at = At::packed(t, y, system.len());
    let sign = |kind: Kind, row: usize, value: f64| Sign { kind, value, terms: terms[row] };
    let margins = margins(system, at.accelerated(&a).constrained(&lambda));
    let mut signs = Vec::new();
    for (k, (contact, mode)) in contacts.iter().zip(modes).enumerate() {
        let mut own = Vec::new();
        if let Some(row) = contact.normal {
            match mode {
                ContactMode::Open if known[k].touches => {
                    own.push(sign(Kind::Opens, row as usize, second[row as usize]));
                }
                ContactMode::Open => {}
                _ => own.push(sign(Kind::Pressed, row as usize, compliance[row as usize] * lambda[row as usize])),
            }
        }
        if let Some(row) = contact.tangent {
            match mode {
                ContactMode::Sticks => own.push(sign(Kind::Holds, row as usize, margins[k])),
                ContactMode::SlipsForwards | ContactMode::SlipsBackwards => {
                    if known[k].rolls {
                        own.push(sign(Kind::Slides, row as usize, mode.sliding() * second[row as usize]));
                    }
                }
                ContactMode::Slides if known[k].rolls => {
                    let (row, [d1, d2, _]) = (row as usize, held_direction(system, k));
                    let value = d1 * second[row] + d2 * second[row + 1];
                    own.push(Sign { kind: Kind::Slides, value, terms: terms[row].max(terms[row + 1]) });
                }
                ContactMode::Open | ContactMode::Closed | ContactMode::Slides => {}
            }
        }
        signs.push(own);
    }
    let touching = (0..contacts.len()).filter(|k| modes[*k] == ContactMode::Open && known[*k].touches);
    let touching = touching.filter_map(|k| Some((k, contacts[k].normal? as usize)));
    let held: Vec<(usize, usize)> =
        touching.filter(|(_, row)| second[*row].abs() <= NOTHING * scale.max(terms[*row])).collect();
    let rows: Vec<usize> = held.iter().map(|(_, row)| *row).collect();
    if let Some((value, terms)) = length_of_springs(system, at, (compliance, &lambda), &rows) {
        held.iter().for_each(|(k, _)| signs[*k].push(Sign { kind: Kind::Free, value, terms }));
    }
    Some(Trial { modes: modes.to_vec(), signs, accelerations: a, memory: system.memory().to_vec() })
}

/// J M⁻¹ Jᵀ of each row by itself.
pub(super) fn compliance<S: System + ?Sized>(system: &S, at: At<'_>) -> Vec<f64> {
    let rows: Vec<usize> = (0..system.description().rows.len()).collect();
    let matrix = constraint_matrix(system, at, &rows);
    let response = solve_least(&mass_matrix(system, at), &matrix.transpose());
    rows.iter()
        .map(|row| response.as_ref().map_or(1.0, |x| matrix.row(*row).dot(&x.column(*row).transpose())))
        .collect()
}

/// Of each contact that rubs (L₀² − T²)/(L₀² + T²): 1 with no force, 0 at the limit; 0 where both are 0.
pub(super) fn margins(system: &dyn System, at: At<'_>) -> Vec<f64> {
    let mut pairs = vec![0.0; 2 * system.description().events.len()];
    system.events(at, &mut pairs);
    let contacts = system.contacts().all.iter();
    contacts
        .map(|contact| match contact.event(ContactEvent::Slips) {
            Some(event) => {
                let difference = pairs[2 * event];
                let squares = contact.tangents().map(|row| at.lambda[row as usize].powi(2));
                let sum = difference + 2.0 * squares.sum::<f64>();
                if sum > 0.0 { difference / sum } else { 0.0 }
            }
            None => 0.0,
        })
        .collect()
}

/// Whether forces and accelerations under a combination agree with it.  A contact that reached a limit leaves it, by however little.
pub(super) fn agrees(trial: &Trial, all: &[Trial], forced: Option<(usize, Kind)>) -> bool {
    trial.signs.iter().enumerate().all(|(k, signs)| {
        signs.iter().all(|sign| {
            let of_kind = |other: &Trial| {
                let own = other.signs[k].iter().filter(|other| other.kind == sign.kind);
                own.fold(0.0_f64, |most, other| most.max(other.value.abs()).max(other.terms))
            };
            let scale = all.iter().map(of_kind).fold(0.0, f64::max);
            let rounding = NOTHING * scale;
            let leaves = forced == Some((k, sign.kind));
            match sign.kind {
                Kind::Holds => sign.value >= -NOTHING,
                // Its force falls through 0: it opens, by however little.
                Kind::Opens if leaves => true,
                Kind::Free if forced == Some((k, Kind::Opens)) => true,
                // What begins to slide may be moved by nothing yet: at its limit, or where others hold it.
                Kind::Pressed | Kind::Opens | Kind::Free | Kind::Slides => sign.value >= -rounding,
            }
        })
    })
}
