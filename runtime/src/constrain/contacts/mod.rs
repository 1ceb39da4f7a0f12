//! Friction that sticks and contacts that open by themselves: what all of them do from an instant on.
//!
//! 1. Which combination of modes the forces agree with: look in `modes.rs`; what is known of each contact at the instant: `known.rs`; forces and
//!    accelerations under one combination: `trials.rs`; whether what counts as open would be pressed: `springs.rs`.
//!    In which direction what slides in space begins to: look in `directions.rs`; that of several together: `compatible.rs`; where that is stiff:
//!    `stiff.rs`.
//! 2. Limits of friction that are none: look in `limits.rs`.
//! 3. How several that stick share a force: look in `share.rs`, and in `least_largest.rs` for the best of all shares.
//! 4. Impacts of several at once, by a stated law: look in `strike.rs`.

mod bounds;
mod compatible;
mod directions;
mod known;
mod least_largest;
mod limits;
mod modes;
mod share;
mod springs;
mod stiff;
mod strike;
mod trials;

pub(crate) use directions::direction;
pub(crate) use known::unresolved_rates;
pub(crate) use limits::possible_limits;
pub(crate) use modes::{Change, Turned, is_released, settle, turned};
pub(crate) use share::{where_shared, with_shares};
pub(crate) use stiff::begins_stiffly;
pub(crate) use strike::{Strike, strike};

use nalgebra::DMatrix;

use directions::{along, is_near};

use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, constraint_triples, rounding_of_parameters, sizes_alike};
use crate::mechanism::{At, Contact, ContactEvent, ContactMode, System, rows_in_force};

/// A gap below this part of the sum of its terms, or of what the sizes of coordinates make of it, is closed: instants at which contacts
/// close are located to some 1e-13 of them.
const CLOSED: f64 = 1e-11;
/// So many roundings of its time an instant is known to at the least.
const INSTANT: f64 = 64.0 * f64::EPSILON;
/// A rate below this part of the sum of its terms is zero: some thousand roundings, as projections to constraints leave them.
pub(crate) const STILL: f64 = 1e-12;
/// A rate that would vanish within this part of a step vanishes now: instants at which sliding stops are located to some 1e-12 of one.
const NOW: f64 = 1e-10;
/// A row that differs by this part of itself from a sum of others depends on them.
const IN_SPAN: f64 = 1e-10;

/// An instant at which contacts change.
#[derive(Clone, Copy)]
pub(crate) struct Moment<'a> {
    /// Its time, s.
    pub t: f64,
    /// The state [q; q'].
    pub y: &'a [f64],
    /// The largest Σ |terms| that the rows of the constraints have had; none where the motion begins.
    pub scales: &'a [f64],
    /// The largest speeds so far, where something may slide in space and they are known.
    pub fastest: &'a [f64],
    /// The length of the step that led here, or of one from here on if that is shorter, s; 0 where the motion begins.
    pub step: f64,
}

/// How the sides of a contact are placed and move; 0 what it does not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kinematics {
    /// The gap.
    pub gap: f64,
    /// Its rate.
    pub gap_rate: f64,
    /// The sliding rates, of which there is one in the plane.
    pub sliding: [f64; 2],
}

/// Of each contact how its sides are placed and move.
pub(crate) fn kinematics<S: System + ?Sized>(system: &S, at: At<'_>) -> Vec<Kinematics> {
    let contacts = &system.contacts().all;
    if contacts.is_empty() {
        return Vec::new();
    }
    let triples = constraint_triples(system, at);
    let one = |contact: &Contact| {
        let [gap, gap_rate, _] = contact.normal.map_or([0.0; 3], |row| triples[row as usize]);
        let mut sliding = [0.0; 2];
        sliding.iter_mut().zip(contact.tangents()).for_each(|(rate, row)| *rate = triples[row as usize][1]);
        Kinematics { gap, gap_rate, sliding }
    };
    contacts.iter().map(one).collect()
}

/// The direction of sliding that is held for a contact in space, and the rate below which there is none; in the plane any.
pub(crate) fn held_direction<S: System + ?Sized>(system: &S, contact: usize) -> [f64; 3] {
    let first = system.contacts().all[contact].direction.map_or(0, |first| first as usize);
    let known = system.memory().get(first..first + 3);
    known.and_then(|known| known.try_into().ok()).unwrap_or([1.0, 0.0, 0.0])
}

/// Holds another direction of sliding for a contact in space.
fn hold_direction(system: &mut dyn System, contact: usize, direction: [f64; 2], least: f64) {
    let Some(first) = system.contacts().all[contact].direction.map(|first| first as usize) else { return };
    let mut memory = system.memory().to_vec();
    memory[first..first + 3].copy_from_slice(&[direction[0], direction[1], least]);
    system.set_memory(&memory);
}

/// Holds for each contact that slides in space the direction in which it does, where that is no longer near the one that is held; true where any is not.
pub(crate) fn follow_directions(system: &mut dyn System, moment: &Moment<'_>) -> bool {
    let modes = system.contacts().modes(system.phase());
    let known = kinematics(system, At::packed(moment.t, moment.y, system.len()));
    let turned = |k: &usize| {
        let [d1, d2, least] = held_direction(system, *k);
        let s = known[*k].sliding;
        modes[*k] == ContactMode::Slides && !is_near(s, [d1, d2]) && s[0].hypot(s[1]) > least
    };
    let turned: Vec<usize> = (0..modes.len()).filter(turned).collect();
    if turned.is_empty() {
        return false;
    }
    let situation = Situation::new(system, moment);
    let turned: Vec<usize> = turned.into_iter().filter(|k| !situation.still[*k][1]).collect();
    turned.iter().for_each(|k| hold_direction(system, *k, along(known[*k].sliding), situation.least[*k]));
    !turned.is_empty()
}

/// The rows of gaps that are closed and stay so, of contacts that count as open in the phase in force.
pub(crate) fn resting_open<S: System + ?Sized>(system: &S, moment: &Moment<'_>) -> Vec<usize> {
    let contacts = &system.contacts().all;
    if !contacts.iter().any(|contact| contact.normal.is_some()) {
        return Vec::new();
    }
    let situation = Situation::new(system, moment);
    let rests = |k: &usize| !situation.modes[*k].touches() && situation.closed[*k] && situation.still[*k][0];
    let rests = (0..contacts.len()).filter(rests);
    rests.filter_map(|k| contacts[k].normal).map(|row| row as usize).collect()
}

/// Whether the sides of a contact approach, as far as rounding tells.
pub(crate) fn approaches<S: System + ?Sized>(system: &S, moment: &Moment<'_>, contact: usize) -> bool {
    let situation = Situation::new(system, moment);
    situation.kinematics[contact].gap_rate < 0.0 && !situation.still[contact][0]
}

/// Of each row how far from 0 a gap is closed: [`CLOSED`] of the sum of its terms, here or as large as `scales` know it, or of what the sizes of
/// coordinates make of one whose terms are small here; or what the terms of its rate make of the time to which its [`INSTANT`] is known.
pub(crate) fn closed_within<S: System + ?Sized>(system: &S, at: At<'_>, scales: &[f64]) -> Vec<f64> {
    let triples = constraint_triples(system, at);
    let rows: Vec<usize> = (0..triples.len()).collect();
    let matrix = constraint_matrix(system, at, &rows);
    let sizes = sizes_alike(system.description(), at.q);
    let size = |row: usize| sizes.iter().enumerate().map(|(i, size)| (matrix[(row, i)] * size).abs()).sum::<f64>();
    let seen = |row: usize| scales.get(row).copied().unwrap_or(0.0);
    let rate = |row: usize| {
        let moving = at.v.iter().enumerate().map(|(i, v)| matrix[(row, i)] * v);
        let (sum, terms) = moving.fold((0.0, 0.0), |(sum, terms), term| (sum + term, terms + term.abs()));
        terms + (triples[row][1] - sum).abs()
    };
    let known = |row: usize| INSTANT * at.t.abs() * rate(row);
    rows.into_iter().map(|row| (CLOSED * triples[row][2].max(seen(row)).max(size(row))).max(known(row))).collect()
}

/// The events by which contacts stop sliding that cannot happen: the constraints in force keep those contacts from moving, so that their rates are
/// rounding.
pub(crate) fn never_stopping<S: System + ?Sized>(system: &S, moment: &Moment<'_>) -> Vec<usize> {
    let contacts = &system.contacts().all;
    let modes = system.contacts().modes(system.phase());
    let slides = |k: &usize| modes[*k].sliding() != 0.0;
    if system.active_rows().is_empty() || !(0..contacts.len()).any(|k| slides(&k)) {
        return Vec::new();
    }
    let held = Situation::new(system, moment).held;
    let stopped = (0..contacts.len()).filter(slides).filter(|k| held[*k]);
    stopped.filter_map(|k| contacts[k].event(ContactEvent::Stops)).collect()
}

/// The active rows of constraints that no contact brings.
pub(crate) fn lasting_rows(system: &dyn System) -> Vec<usize> {
    let of_contacts: Vec<u32> = system.contacts().rows().collect();
    system.active_rows().iter().filter(|row| !of_contacts.contains(row)).map(|row| *row as usize).collect()
}

/// A contact that slides in space in the phase in force.
pub(crate) fn slides_in_space<S: System + ?Sized>(system: &S) -> Option<String> {
    let contacts = system.contacts();
    let modes = contacts.modes(system.phase());
    let slides = contacts.all.iter().zip(modes).find(|(_, mode)| *mode == ContactMode::Slides);
    slides.map(|(contact, _)| contact.name.to_string())
}

/// All that several may do together, the last one's options changing fastest.
fn combinations<'a, T: Copy + 'a>(options: impl Iterator<Item = &'a [T]>) -> Vec<Vec<T>> {
    let longer = |all: Vec<Vec<T>>, own: &[T]| {
        all.iter().flat_map(|one| own.iter().map(move |mode| [one.as_slice(), &[*mode]].concat())).collect()
    };
    options.fold(vec![Vec::new()], longer)
}

/// `rub sticks, floor open`.
fn words(system: &dyn System, modes: &[ContactMode]) -> String {
    let phase = system.contacts().phase(modes);
    system.description().phases[phase].name.to_string()
}

/// All contacts at a state.
struct Situation {
    /// What each did until now.
    modes: Vec<ContactMode>,
    kinematics: Vec<Kinematics>,
    /// Whether the gap is closed, as far as rounding tells.
    closed: Vec<bool>,
    /// Whether the rates of gaps, and those of sliding, are zero as far as rounding tells.
    still: Vec<[bool; 2]>,
    /// Whether the constraints in force keep the rate of sliding at zero: those of other contacts, or its own.
    held: Vec<bool>,
    /// What of the rates of sliding is rounding.
    least: Vec<f64>,
}

impl Situation {
    fn new<S: System + ?Sized>(system: &S, &Moment { t, y, scales, fastest, step }: &Moment<'_>) -> Situation {
        let n = system.len();
        let at = At::packed(t, y, n);
        let contacts = &system.contacts().all;
        let triples = constraint_triples(system, at);
        let rows: Vec<usize> = (0..triples.len()).collect();
        let matrix = constraint_matrix(system, at, &rows);
        // What of a rate no speed makes.
        let driven = |row: usize| triples[row][1] - (0..n).map(|i| matrix[(row, i)] * at.v[i]).sum::<f64>();
        // Σ |J_i v_i|, beside which a rate is rounding.
        let terms = |row: usize| {
            let moving = (0..n).map(|i| (matrix[(row, i)] * at.v[i]).abs()).sum::<f64>();
            moving + driven(row).abs()
        };
        let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; triples.len()]);
        let solved = system.accelerations_and_multipliers(at, &mut a, &mut lambda);
        // How much a rate changes in a step, its terms taken by themselves.
        let change = |row: usize| match solved {
            Ok(()) => step * (0..n).map(|i| (matrix[(row, i)] * a[i]).abs()).sum::<f64>(),
            Err(_) => 0.0,
        };
        // What the sizes of speeds make of a rate whose terms are small here, as of what falls along a wall.
        let speeds = sizes_alike(system.description(), at.v);
        let speed = |row: usize| (0..n).map(|i| (matrix[(row, i)] * speeds[i]).abs()).sum::<f64>();
        let seen = |row: usize| fastest.iter().enumerate().map(|(i, v)| (matrix[(row, i)] * v).abs()).sum::<f64>();
        let in_space: Vec<u32> =
            contacts.iter().filter(|c| c.direction.is_some()).flat_map(Contact::tangents).collect();
        // In space all that moves may stop at once, whatever the direction is in which it does.
        let fast = |row: usize| if in_space.contains(&(row as u32)) { seen(row) } else { 0.0 };
        let rounding = |row: usize| STILL * terms(row).max(speed(row)).max(fast(row));
        let still = |rows: &mut dyn Iterator<Item = u32>| {
            let (mut rate, mut within) = (0.0_f64, 0.0_f64);
            for row in rows.map(|row| row as usize) {
                rate = rate.hypot(triples[row][1]);
                within = within.max(rounding(row)).max(NOW * change(row));
            }
            rate <= within
        };
        let active: Vec<usize> = rows_in_force(system).collect();
        let basis = matrix.select_rows(&active).transpose();
        let mut bias = vec![0.0; triples.len()];
        system.constraint_bias(at, &mut bias);
        let rates = Rates { driven: &driven, terms: &terms, bias: &bias };
        let held = |row: u32| is_held(&matrix, (&basis, &active), row as usize, &rates).unwrap_or(false);
        let mut within = closed_within(system, at, scales);
        if step == 0.0 {
            within
                .iter_mut()
                .enumerate()
                .for_each(|(row, within)| *within = within.max(rounding_of_parameters(system, row)));
        }
        let closed = |row: Option<u32>| row.is_none_or(|row| triples[row as usize][0].abs() <= within[row as usize]);
        Situation {
            modes: system.contacts().modes(system.phase()),
            kinematics: kinematics(system, at),
            closed: contacts.iter().map(|contact| closed(contact.normal)).collect(),
            still: contacts
                .iter()
                .map(|contact| [still(&mut contact.normal.into_iter()), still(&mut contact.tangents())])
                .collect(),
            held: contacts.iter().map(|contact| contact.tangent.is_some() && contact.tangents().all(held)).collect(),
            least: contacts
                .iter()
                .map(|contact| contact.tangents().map(|row| rounding(row as usize)).fold(0.0, f64::max))
                .collect(),
        }
    }
}

/// What is known of the rates of rows.
pub(super) struct Rates<'a> {
    /// What of a rate no speed makes.
    pub driven: &'a dyn Fn(usize) -> f64,
    /// The sum of the sizes of all that makes it.
    pub terms: &'a dyn Fn(usize) -> f64,
    /// γ of c'' = J a + γ.
    pub bias: &'a [f64],
}

/// Whether the rows in force keep the rate of another one at zero: J_t = Σ c_k J_k, and what of the rate no speed makes is zero in this sum, too; and not
/// for this instant alone, as that of a piston at its dead centre, γ_t = Σ c_k γ_k.
pub(super) fn is_held(
    matrix: &DMatrix<f64>,
    (basis, active): (&DMatrix<f64>, &[usize]),
    row: usize,
    Rates { driven, terms, bias }: &Rates<'_>,
) -> Option<bool> {
    let own = matrix.row(row).transpose();
    let parts = solve_least(basis, &DMatrix::from_column_slice(own.len(), 1, own.as_slice()))?;
    let missed = (&own - basis * &parts).amax();
    let rest = active.iter().zip(&parts).fold(driven(row), |rest, (k, part)| rest - part * driven(*k));
    let size = active.iter().zip(&parts).fold(terms(row), |size, (k, part)| size + part.abs() * terms(*k));
    let bent = active.iter().zip(&parts).map(|(k, part)| part * bias[*k]);
    let (bent, most) = bent.fold((bias[row], bias[row].abs()), |(rest, size), term| (rest - term, size + term.abs()));
    let lasts = bent.abs() <= IN_SPAN * most;
    Some(missed <= IN_SPAN * own.amax() && rest.abs() <= STILL * size && lasts)
}
