//! Impacts of contacts, with friction, one after the other or all at once.
//!
//! With W = J M⁻¹ Jᵀ the rates of gaps and sliding become u⁺ = u⁻ + W P.  Newton's law for several contacts: u_N⁺ ≥ −e u_N⁻, P_N ≥ 0, one of
//! them an equation; Coulomb's law for impulses: |P_T| ≤ μ P_N, with equality against the sliding that is left (Pfeiffer & Glocker,
//! Multibody Dynamics with Unilateral Contacts, 1996, ch. 8; Moreau 1988).  μ is that of sliding for what slides when it is struck, until it stops;
//! what does not slide then is held by the μ of sticking if that can be. In space P_T is a vector, against the sliding that is left as a vector.

use nalgebra::{DMatrix, DVector};

use super::directions::{along, consistent};
use super::limits::{along_sliding, possible_limits_of};
use super::{Moment, Situation, combinations, lasting_rows, words};
use crate::cause::Cause;
use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, constraint_triples, mass_matrix, multiplier_effects};
use crate::mechanism::{At, ContactEvent, ContactMode, ImpactLaw, System};

/// A rate or an impulse below this part of the largest is zero.
const NOTHING: f64 = 1e-10;
/// Outcomes that differ by less than this part of the largest speed are one: they agree with the laws within [`NOTHING`] each.
const ALIKE: f64 = 1e-7;
/// So many impacts one after the other at an instant do not come to an end.
const MOST_IMPACTS: usize = 200;

/// What an instant at which contacts strike does.
#[derive(Clone, Debug)]
pub(crate) struct Strike {
    /// Δq'.
    pub jump: Vec<f64>,
    /// Rows with their impulses.
    pub rows: Vec<(usize, f64)>,
    after: Vec<Option<After>>,
    plastic: bool,
}

/// What is known of a contact that took part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct After {
    /// Whether its gap stays closed.
    pub rests: bool,
    /// Whether its sides do not slide on each other.
    pub rolls: bool,
}

impl Strike {
    /// Whether it changes no speed.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether all that pushes keeps its speed 0 afterwards: the jump is the projection of the speeds onto that.
    pub fn is_plastic(&self) -> bool {
        self.plastic
    }

    /// What is known of a contact that took part.
    pub(super) fn after(&self, contact: usize) -> Option<After> {
        self.after[contact]
    }
}

/// A contact that may take an impulse.
#[derive(Clone, Copy)]
struct Side {
    contact: usize,
    /// Places among the rows of the collision.
    normal: usize,
    /// The first of its sliding rates, and how many they are: none, one, or two in space.
    tangent: usize,
    rates: usize,
    /// The coefficient of restitution, of what leaves faster than `slow`.
    restitution: f64,
    slow: f64,
    /// Of sliding, and of sticking.
    friction: [f64; 2],
}

impl Side {
    fn tangents(&self) -> std::ops::Range<usize> {
        self.tangent..self.tangent + self.rates
    }

    /// Its sliding; one component in the plane.
    fn sliding(&self, rates: &DVector<f64>) -> [f64; 2] {
        let mut sliding = [0.0; 2];
        sliding.iter_mut().zip(self.tangents()).for_each(|(own, place)| *own = rates[place]);
        sliding
    }

    /// The direction in which it slides at these rates.
    fn direction(&self, rates: &DVector<f64>) -> [f64; 2] {
        match self.sliding(rates) {
            [rate, _] if self.rates < 2 => [rate.signum(), 0.0],
            [0.0, 0.0] => [1.0, 0.0],
            rates => along(rates),
        }
    }
}

/// Everything that an instant needs.
struct Collision {
    /// Rows of the mechanism.
    rows: Vec<usize>,
    /// How many of them, at the beginning, are constraints that always hold.
    held: usize,
    sides: Vec<Side>,
    /// W.
    flexibility: DMatrix<f64>,
    /// u⁻.
    before: DVector<f64>,
    /// M⁻¹ Jᵀ.
    response: DMatrix<f64>,
}

/// What a side does in a part of an impact.
#[derive(Clone, Copy, PartialEq)]
struct Takes {
    mode: ContactMode,
    /// Whether it takes more across than it is given.
    adds: bool,
}

/// A part of an impact: impulses that some sides take at once.
#[derive(Clone, Copy)]
struct Stage<'a> {
    /// Places of the sides that may take impulses.
    taking: &'a [usize],
    /// The rates before it.
    rates: &'a DVector<f64>,
    /// Whether speeds of approach are turned round by the coefficients of restitution.
    restitutes: bool,
    /// Impulses across contacts that are given back whatever happens.
    given: &'a DVector<f64>,
}

/// What contacts that close, or are closed, do at an instant to the speeds; `None` where none of them approaches.
///
/// A contact that would leave no faster than its number in `slow` stays: it loses its speed of approach altogether.
///
/// # Errors
/// No outcome, several, or an outcome that the order of impacts decides where the file states no law; energy that grows.
pub(crate) fn strike(system: &mut dyn System, moment: &Moment<'_>, slow: &[f64]) -> Result<Option<Strike>, Box<Cause>> {
    let situation = Situation::new(system, moment);
    let (t, y) = (moment.t, moment.y);
    let collision = Collision::new(system, (t, y), &situation, slow)?;
    if !collision.approaches(&collision.before) && !collision.hops_are_lost() {
        return Ok(None);
    }
    let touches: Vec<bool> =
        (0..situation.modes.len()).map(|k| situation.modes[k].touches() || situation.closed[k]).collect();
    possible_limits_of(system, (t, y), &touches)?;
    let impulses = struck(system, moment, &collision)?;
    collision.outcome(system, &impulses).map(Some)
}

/// The impulses by the law that the file states, or by the order of impacts where that does not matter.
fn struck(system: &mut dyn System, moment: &Moment<'_>, collision: &Collision) -> Result<DVector<f64>, Box<Cause>> {
    let y = moment.y;
    match system.contacts().law {
        Some(law) => collision.by(system, law),
        None => {
            let together = collision.by(system, ImpactLaw::Together)?;
            if collision.sides.len() > 1 {
                let sequential = collision.by(system, ImpactLaw::Sequential)?;
                let (one, other) = (&collision.response * &sequential, &collision.response * &together);
                let n = system.len();
                let fastest = y[n..2 * n].iter().fold(0.0_f64, |most, v| most.max(v.abs()));
                if (&one - &other).amax() > ALIKE * one.amax().max(other.amax()).max(fastest) {
                    let after = |jump: &DVector<f64>| (0..n).map(|i| y[n + i] + jump[i]).collect();
                    let contacts =
                        collision.sides.iter().map(|side| system.contacts().all[side.contact].name.to_string());
                    return Err(Cause::SimultaneousImpacts {
                        contacts: contacts.collect(),
                        sequential: after(&one),
                        together: after(&other),
                    }
                    .into());
                }
            }
            Ok(together)
        }
    }
}

impl Collision {
    fn new(
        system: &mut dyn System,
        (t, y): (f64, &[f64]),
        situation: &Situation,
        slow: &[f64],
    ) -> Result<Collision, Box<Cause>> {
        let n = system.len();
        let at = At::packed(t, y, n);
        let contacts = system.contacts().all.clone();
        let mut rows = lasting_rows(system);
        let held = rows.len();
        let frictions = frictions(system, at);
        let restitutions = system.restitutions();
        let mut sides = Vec::new();
        for (k, contact) in contacts.iter().enumerate() {
            let Some(row) = contact.normal else { continue };
            if !(situation.modes[k].touches() || situation.closed[k]) {
                continue;
            }
            let normal = rows.len();
            rows.push(row as usize);
            rows.extend(contact.tangents().map(|row| row as usize));
            let (tangent, rates) = (normal + 1, rows.len() - normal - 1);
            let e = contact.restitution.and_then(|place| restitutions.get(place as usize)).copied().unwrap_or(0.0);
            crate::constrain::possible_restitution(e)?;
            let (slow, friction) = (slow[k], frictions[k]);
            sides.push(Side { contact: k, normal, tangent, rates, restitution: e, slow, friction });
        }
        let triples = constraint_triples(system, at);
        let matrix = constraint_matrix(system, at, &rows);
        let inverse = solve_least(&mass_matrix(system, at), &matrix.transpose());
        let response =
            inverse.ok_or_else(|| Cause::SingularMass { coordinate: system.description().coordinate_name(0) })?;
        let before = DVector::from_iterator(rows.len(), rows.iter().map(|row| triples[*row][1]));
        Ok(Collision { flexibility: &matrix * &response, rows, held, sides, before, response })
    }

    /// Beside which rates are zero.
    fn scale(&self, rates: &DVector<f64>) -> f64 {
        self.before.amax().max(rates.amax())
    }

    fn approaches(&self, rates: &DVector<f64>) -> bool {
        self.sides.iter().any(|side| rates[side.normal] < -NOTHING * self.scale(rates))
    }

    /// Whether some side leaves so slowly that its hop is lost in rounding.
    fn hops_are_lost(&self) -> bool {
        self.sides.iter().any(|side| self.before[side.normal] != 0.0 && self.before[side.normal].abs() <= side.slow)
    }

    fn by(&self, system: &dyn System, law: ImpactLaw) -> Result<DVector<f64>, Box<Cause>> {
        let all: Vec<usize> = (0..self.sides.len()).collect();
        let none = DVector::zeros(self.rows.len());
        let whole = Stage { taking: &all, rates: &self.before, restitutes: true, given: &none };
        match law {
            ImpactLaw::Together => self.solve(system, whole),
            ImpactLaw::Poisson => {
                let compressed = self.solve(system, Stage { restitutes: false, ..whole })?;
                let mut given = DVector::zeros(self.rows.len());
                for side in &self.sides {
                    given[side.normal] = side.restitution * compressed[side.normal];
                }
                let rates = &self.before + &self.flexibility * &compressed;
                let rest = self.solve(system, Stage { rates: &rates, restitutes: false, given: &given, ..whole })?;
                Ok(compressed + rest)
            }
            ImpactLaw::Sequential => {
                let (mut total, mut rates) = (none.clone(), self.before.clone());
                for _ in 0..MOST_IMPACTS {
                    if !self.approaches(&rates) {
                        // What a series of impacts leaves of the approaches ends at once.
                        let rest = Stage { rates: &rates, restitutes: false, ..whole };
                        return Ok(total + self.solve(system, rest)?);
                    }
                    let fastest = |a: &&usize, b: &&usize| {
                        let rate = |side: usize| rates[self.sides[side].normal];
                        rate(**a).total_cmp(&rate(**b))
                    };
                    let Some(one) = all.iter().min_by(fastest) else { break };
                    let impulses = self.solve(system, Stage { taking: &[*one], rates: &rates, ..whole })?;
                    rates += &self.flexibility * &impulses;
                    total += impulses;
                }
                let contacts = self.sides.iter().map(|side| system.contacts().all[side.contact].name.to_string());
                Err(Cause::EndlessImpacts { contacts: contacts.collect() }.into())
            }
        }
    }

    /// The impulses of a stage: all that the sides may do is tried; of several outcomes the one in which nothing more is added than is given.
    fn solve(&self, system: &dyn System, stage: Stage<'_>) -> Result<DVector<f64>, Box<Cause>> {
        let options: Vec<Vec<Takes>> = (0..self.sides.len()).map(|place| self.options(&stage, place)).collect();
        let tried = combinations(options.iter().map(Vec::as_slice)).into_iter();
        let all = |takes: Vec<Takes>| {
            self.impulses(&stage, &takes).into_iter().map(move |impulses| (takes.clone(), impulses))
        };
        let found: Vec<(Vec<Takes>, DVector<f64>)> = tried.flat_map(all).collect();
        let after = |impulses: &DVector<f64>| stage.rates + &self.flexibility * impulses;
        let alike = |one: &DVector<f64>, other: &DVector<f64>| {
            (after(other) - after(one)).amax() <= ALIKE * self.scale(stage.rates)
        };
        // What does not slide yet, and may stick, does not begin to slide.
        let sticks_instead = |(one, slid): &(Vec<Takes>, DVector<f64>), (other, stuck): &(Vec<Takes>, DVector<f64>)| {
            let instead = |(side, (one, other)): (&Side, (&Takes, &Takes))| {
                let sticks = Takes { mode: ContactMode::Sticks, ..*one };
                one == other || one.mode.sliding() != 0.0 && *other == sticks && !self.slides(side, stage.rates)
            };
            !alike(slid, stuck) && self.sides.iter().zip(one.iter().zip(other)).all(instead)
        };
        let stays = |one: &&(Vec<Takes>, DVector<f64>)| !found.iter().any(|other| sticks_instead(one, other));
        let found: Vec<&(Vec<Takes>, DVector<f64>)> = found.iter().filter(stays).collect();
        match found.as_slice() {
            [(_, first), rest @ ..] if rest.iter().all(|(_, other)| alike(first, other)) => Ok(first.clone()),
            several => {
                let idle = |(takes, _): &&&(Vec<Takes>, DVector<f64>)| !takes.iter().any(|takes| takes.adds);
                if let Some((_, given)) = several.iter().find(idle) {
                    return Ok(given.clone());
                }
                let mut all = system.contacts().modes(system.phase());
                let mut named = |(takes, _): &&(Vec<Takes>, DVector<f64>)| {
                    self.sides.iter().zip(takes).for_each(|(side, takes)| all[side.contact] = takes.mode);
                    words(system, &all)
                };
                Err(Cause::UndecidedContacts { found: found.iter().map(&mut named).collect() }.into())
            }
        }
    }

    /// What a side may do in a stage.
    fn options(&self, stage: &Stage<'_>, place: usize) -> Vec<Takes> {
        use ContactMode::{Closed, Open, Slides, SlipsBackwards, SlipsForwards, Sticks};
        let side = &self.sides[place];
        let touching: &[ContactMode] = match side.rates {
            _ if !stage.taking.contains(&place) => &[],
            0 => &[Closed],
            1 => &[Sticks, SlipsForwards, SlipsBackwards],
            _ => &[Sticks, Slides],
        };
        let takes = |adds: bool| touching.iter().map(move |mode| Takes { mode: *mode, adds });
        // What is given back rubs, too, where nothing is added to it.
        match stage.given[side.normal] > 0.0 && !touching.is_empty() {
            true => takes(true).chain(takes(false)).collect(),
            false => takes(true).chain([Takes { mode: Open, adds: false }]).collect(),
        }
    }

    /// The impulses where sides do this, if it agrees with those of the sides that take any: one at the most but in space.
    fn impulses(&self, stage: &Stage<'_>, takes: &[Takes]) -> Vec<DVector<f64>> {
        let sliding: Vec<usize> = (0..takes.len()).filter(|k| takes[*k].mode == ContactMode::Slides).collect();
        let guesses: Vec<[f64; 2]> = sliding.iter().map(|k| self.sides[*k].direction(stage.rates)).collect();
        let mut directions: Vec<[f64; 2]> = takes.iter().map(|takes| [takes.mode.sliding(), 0.0]).collect();
        let mut aim = |to: &[[f64; 2]]| {
            sliding.iter().zip(to).for_each(|(k, direction)| directions[*k] = *direction);
            directions.clone()
        };
        let found = consistent(&guesses, None, &mut |to| {
            let after = stage.rates + &self.flexibility * self.impulses_along(stage, takes, &aim(to))?;
            Some(sliding.iter().map(|k| self.sides[*k].sliding(&after)).collect())
        });
        let of = |to: Vec<[f64; 2]>| {
            let directions = aim(&to);
            let impulses = self.impulses_along(stage, takes, &directions)?;
            self.agrees(stage, (takes, &directions), &impulses).then_some(impulses)
        };
        found.into_iter().filter_map(of).collect()
    }

    /// The impulses where sides do this, with friction against these directions where something slides.
    fn impulses_along(&self, stage: &Stage<'_>, takes: &[Takes], directions: &[[f64; 2]]) -> Option<DVector<f64>> {
        let Stage { rates, given, .. } = *stage;
        let m = self.rows.len();
        // P = base + spread x.
        let mut base = given.clone();
        let mut columns: Vec<DVector<f64>> = Vec::new();
        let mut wanted: Vec<(usize, f64)> = Vec::new();
        let unit = |row: usize| DVector::from_fn(m, |i, _| f64::from(u8::from(i == row)));
        for row in 0..self.held {
            columns.push(unit(row));
            wanted.push((row, rates[row]));
        }
        for ((side, takes), sliding) in self.sides.iter().zip(takes).zip(directions) {
            if !takes.mode.touches() {
                continue;
            }
            let mut normal = unit(side.normal);
            for (tangent, sliding) in side.tangents().zip(sliding) {
                normal[tangent] = -sliding * side.friction[0];
                base[tangent] += normal[tangent] * given[side.normal];
                if takes.mode.sliding() == 0.0 {
                    columns.push(unit(tangent));
                    wanted.push((tangent, 0.0));
                }
            }
            if takes.adds {
                columns.push(normal);
                wanted.push((side.normal, self.least(side, stage)));
            }
        }
        let spread = DMatrix::from_fn(m, columns.len(), |i, j| columns[j][i]);
        let effect = &self.flexibility * &spread;
        let offset = rates + &self.flexibility * &base;
        let matrix = DMatrix::from_fn(wanted.len(), columns.len(), |i, j| effect[(wanted[i].0, j)]);
        let right = DMatrix::from_fn(wanted.len(), 1, |i, _| wanted[i].1 - offset[wanted[i].0]);
        let x = solve_least(&matrix, &right)?;
        let impulses = &base + &spread * x.column(0);
        let after = rates + &self.flexibility * &impulses;
        let small = NOTHING * self.scale(rates);
        let meets = wanted.iter().all(|(row, rate)| (after[*row] - rate).abs() <= small);
        meets.then_some(impulses)
    }

    /// Whether impulses, and the rates after them, agree with what the sides do that take any.
    fn agrees(&self, stage: &Stage<'_>, (takes, directions): (&[Takes], &[[f64; 2]]), impulses: &DVector<f64>) -> bool {
        let Stage { taking, rates, given, .. } = *stage;
        let after = rates + &self.flexibility * impulses;
        let small = NOTHING * self.scale(rates);
        let none = NOTHING * impulses.amax();
        let agrees = |place: &usize| {
            let (side, Takes { mode, adds }) = (&self.sides[*place], takes[*place]);
            let pressed = impulses[side.normal];
            let apart = adds || after[side.normal] >= self.least(side, stage) - small;
            let [first, second] = side.sliding(&after);
            let slides = match mode.sliding() {
                0.0 => {
                    let [sliding, sticking] = side.friction;
                    let most = if self.slides(side, rates) { sliding } else { sticking };
                    let [along, beside] = side.sliding(impulses);
                    along.hypot(beside) <= most * pressed + none
                }
                _ => directions[*place][0] * first + directions[*place][1] * second >= -small,
            };
            apart && pressed >= given[side.normal] - none && slides
        };
        taking.iter().all(agrees)
    }

    /// Whether a side slides at these rates.
    fn slides(&self, side: &Side, rates: &DVector<f64>) -> bool {
        let [first, second] = side.sliding(rates);
        first.hypot(second) > NOTHING * self.scale(rates)
    }

    /// The rate that a gap has at least afterwards; what moves apart already may go on as it likes.
    fn least(&self, side: &Side, stage: &Stage<'_>) -> f64 {
        let before = stage.rates[side.normal];
        let back = -side.restitution * before;
        if stage.restitutes && back > side.slow { back } else { 0.0 }
    }

    fn outcome(&self, system: &dyn System, impulses: &DVector<f64>) -> Result<Strike, Box<Cause>> {
        let after = &self.before + &self.flexibility * impulses;
        let gained: f64 =
            impulses.iter().zip(self.before.iter().zip(&after)).map(|(p, (u, w))| 0.5 * p * (u + w)).sum();
        let turned: f64 = impulses.iter().zip(&self.before).map(|(p, u)| (p * u).abs()).sum();
        if gained > ALIKE * turned {
            return Err(Cause::ImpactGainsEnergy {
                energy: gained,
                by_poisson: system.contacts().law == Some(ImpactLaw::Poisson),
            }
            .into());
        }
        let small = NOTHING * self.scale(&after);
        let mut known = vec![None; system.contacts().all.len()];
        let keeps = |row: usize| impulses[row] == 0.0 || after[row].abs() <= small;
        let plastic = (0..self.rows.len()).all(keeps);
        for side in &self.sides {
            let rests = after[side.normal].abs() <= small.max(side.slow);
            let [first, second] = side.sliding(&after);
            let rolls = side.rates > 0 && first.hypot(second) <= small;
            known[side.contact] = Some(After { rests, rolls });
        }
        let jump = (&self.response * impulses).iter().copied().collect();
        let rows = self.rows.iter().copied().zip(impulses.iter().copied()).filter(|(_, impulse)| *impulse != 0.0);
        Ok(Strike { jump, rows: rows.collect(), after: known, plastic })
    }
}

/// Of each contact the coefficients of friction, of sliding and of sticking, by what the forces of its multipliers are.
fn frictions(system: &mut dyn System, at: At<'_>) -> Vec<[f64; 2]> {
    let contacts = system.contacts().all.clone();
    let before = system.phase();
    let modes_with = |slips: bool| -> Vec<ContactMode> {
        let mode = |contact: &crate::mechanism::Contact| match (contact.tangent.is_some(), slips) {
            (true, true) if contact.direction.is_some() => ContactMode::Slides,
            (true, true) => ContactMode::SlipsForwards,
            (true, false) => ContactMode::Sticks,
            (false, _) => ContactMode::Closed,
        };
        contacts.iter().map(mode).collect()
    };
    let rows: Vec<usize> = (0..system.description().rows.len()).collect();
    let [sliding, sticking] = [true, false].map(|slips| {
        let phase = system.contacts().phase(&modes_with(slips));
        system.set_phase(phase);
        multiplier_effects(system, at, &rows)
    });
    system.set_phase(before);
    let (a, mut lambda) = (vec![0.0; system.len()], vec![0.0; rows.len()]);
    let mut found = Vec::new();
    for (k, contact) in contacts.iter().enumerate() {
        let (Some(normal), Some(event)) = (contact.normal, contact.event(ContactEvent::Slips)) else {
            found.push([0.0; 2]);
            continue;
        };
        let (normal, along) = (normal as usize, DVector::from_vec(along_sliding(system, at, k)));
        // Sliding forwards a pressed contact pushes with −μ N along the sliding.
        let pushed = sliding.column(normal) - sticking.column(normal);
        let slides = -pushed.dot(&along) / along.dot(&along);
        lambda.fill(0.0);
        lambda[normal] = 1.0;
        let mut pairs = vec![0.0; 2 * system.description().events.len()];
        system.events(at.accelerated(&a).constrained(&lambda), &mut pairs);
        let sticks = pairs[2 * event].max(0.0).sqrt();
        found.push([if slides.is_finite() { slides } else { 0.0 }, sticks]);
    }
    found
}
