//! States as the phases of friction and contacts have them: what slips forwards does not slide backwards, and what is open is apart.

use super::ROUNDINGS;
use super::rows::Constraints;
use super::state::State;
use crate::derive::Rows;
use crate::expr::Tape;
use crate::model::{Contact, ContactMode, Model, modes_of_phases};
use crate::number::DoubleDouble;

/// So often states are moved before they are given up.
const TRIES: i32 = 8;

/// What the phases of a model's contacts say of states.
pub(super) struct ContactStates {
    /// The gaps of all contacts, and their rows.
    gaps: Tape,
    rows: Vec<usize>,
    /// Of each phase of contacts.
    phases: Vec<Said>,
}

/// What a phase says.
struct Said {
    /// Gaps that are open, by their places among all.
    open: Vec<usize>,
    /// Rows of rates at which something slides, each with the sign that it has.
    sliding: Vec<(usize, f64)>,
    /// The first rows of what slides in space, each with the first of the held values that are its direction.
    in_space: Vec<(usize, usize)>,
}

impl ContactStates {
    /// For a model and its rows.
    pub fn new(model: &Model, all: &Rows) -> ContactStates {
        let row = |constraint: usize| model.constraints[constraint].first;
        let rows: Vec<usize> = model.contacts.iter().filter_map(|contact| contact.normal.map(row)).collect();
        let gaps: Vec<_> = rows.iter().map(|row| all.value[*row]).collect();
        let modes: Vec<&[ContactMode]> = model.contacts.iter().map(Contact::modes).collect();
        // Time stepping lets sides overlap a little, and many gaps are seldom open in a state that is drawn.
        let single = model.contacts_are_single();
        let said = |modes: Vec<ContactMode>| {
            let mut said = Said { open: Vec::new(), sliding: Vec::new(), in_space: Vec::new() };
            for (contact, mode) in model.contacts.iter().zip(modes) {
                let sign = if mode == ContactMode::SlipsBackwards { -1.0 } else { 1.0 };
                let slides = contact.tangent.filter(|_| mode.slips()).map(row);
                match contact.direction {
                    Some(direction) => said.in_space.extend(slides.map(|row| (row, direction))),
                    None => said.sliding.extend(slides.map(|row| (row, sign))),
                }
                let gap = contact.normal.filter(|_| !mode.touches() && !single).map(row);
                said.open.extend(gap.and_then(|gap| rows.iter().position(|row| *row == gap)));
            }
            said
        };
        ContactStates {
            gaps: Tape::new(&model.graph, &gaps),
            phases: modes_of_phases(&modes).into_iter().map(said).collect(),
            rows,
        }
    }

    /// Moves a state that meets the constraints of its phase to one that is as the phase says, by the least changes that leave gaps and
    /// rates with the opposite signs: false where none is found.
    pub fn meet(&self, constraints: &Constraints, state: &mut State) -> bool {
        let Some(said) = self.phases.get(state.phase) else { return true };
        let meets = (said.open.is_empty() || self.open(constraints, said, state))
            && (said.sliding.is_empty() || self.turn(constraints, said, state));
        if meets && !said.in_space.is_empty() {
            aim(constraints, said, state);
        }
        meets
    }

    fn open(&self, constraints: &Constraints, said: &Said, state: &mut State) -> bool {
        for k in 0..TRIES {
            let gaps: Vec<f64> = self.gaps.evaluate(|s| state.value(s).to_f64());
            if said.open.iter().all(|place| gaps[*place] >= 0.0) {
                return true;
            }
            // Gaps that are no distances are opened less far, where as far as they were closed leads nowhere.
            let part = 0.1_f64.powi(k);
            let changes: Vec<_> =
                said.open.iter().map(|place| (self.rows[*place], -(1.0 + part) * gaps[*place].min(0.0))).collect();
            let Some(step) = constraints.change(state, &changes) else { return false };
            state.q.iter_mut().zip(step).for_each(|(q, s)| *q += DoubleDouble::from(s));
            if !constraints.close(state) {
                return false;
            }
        }
        false
    }

    fn turn(&self, constraints: &Constraints, said: &Said, state: &mut State) -> bool {
        for _ in 0..TRIES {
            let rates = constraints.rates(state);
            let backwards = |(row, sign): &(usize, f64)| (sign * rates[*row].value.to_f64()).min(0.0) * sign;
            if said.sliding.iter().all(|slides| backwards(slides) == 0.0 || rates[slides.0].vanishes(ROUNDINGS)) {
                return true;
            }
            let changes: Vec<_> = said.sliding.iter().map(|slides| (slides.0, -2.0 * backwards(slides))).collect();
            let Some(step) = constraints.change(state, &changes) else { return false };
            state.v.iter_mut().zip(step).for_each(|(v, s)| *v += DoubleDouble::from(s));
            if !constraints.close(state) {
                return false;
            }
        }
        false
    }

    /// Whether something that slips in a state's phase is at rest there, though constraints would let it slide.
    pub fn rests(&self, constraints: &Constraints, state: &State) -> bool {
        let slides = |said: &&Said| !(said.sliding.is_empty() && said.in_space.is_empty());
        let Some(said) = self.phases.get(state.phase).filter(slides) else { return false };
        let rates = constraints.rates(state);
        let active = constraints.active(state.phase);
        let free = |row: usize| {
            let with = [active, &[row]].concat();
            constraints.rank_of(state, &with).0 > constraints.rank_of(state, active).0
        };
        let still = |row: usize| rates[row].vanishes(ROUNDINGS);
        said.sliding.iter().any(|(row, _)| still(*row) && free(*row))
            || said.in_space.iter().any(|(row, _)| {
                let both = [*row, *row + 1];
                both.into_iter().all(still) && both.into_iter().any(free)
            })
    }
}

/// Holds the direction in which a state lets things slide.
fn aim(constraints: &Constraints, said: &Said, state: &mut State) {
    let rates = constraints.rates(state);
    for (row, direction) in &said.in_space {
        let along = [0, 1].map(|k| rates[row + k].value.to_f64());
        if let Some([first, second, least]) = state.memory.get_mut(*direction..direction + 3)
            && along != [0.0; 2]
        {
            ([*first, *second], *least) = (along, 0.0);
        }
    }
}
