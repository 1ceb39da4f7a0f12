//! The laws of contact for the impulses of one step, by projections in turn (Gauss and Seidel).

/// Rounds end when no impulse changes by more than this part of the largest that a row by itself would take, both measured by the root of the
/// energy that they move: far below the error of a step, far above rounding.
const SOLVED: f64 = 1e-11;
/// So many rounds are made at the most: a pile of some fifty layers takes as many. Where contacts hold each other in ways without number rounds may
/// go on for ever.
const MOST_ROUNDS: u32 = 10_000;
/// After so many rounds, and so many more, all impulses are taken at once.
const TOGETHER: u32 = 100;
/// A step in which impulses still change by this part, which is nothing beside the error of the step itself, is taken, and told.
const ENOUGH: f64 = 1e-5;
/// What slid by less than this part of the largest rate, measured likewise, stuck: what rounds leave of a rate that is held.
const STUCK: f64 = 1e-8;
/// A row that constraints hold moves by rounding only, this part of what it would without them.
pub(super) const HELD: f64 = 1e-11;

/// A contact, or a friction, that takes part in a step.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Its place among all contacts.
    pub contact: usize,
    /// The place of its row across among those of the step; none for friction alone.
    pub normal: Option<usize>,
    /// The first of its rows along, and how many these are.
    pub tangent: usize,
    pub count: usize,
    /// The coefficient of restitution.
    pub restitution: f64,
    /// Whether it stuck in the step before, or its sides do not slide where the first one begins: in the middle of a step, where rates are taken, what
    /// moves ever faster has left them behind.
    pub stuck: bool,
    /// Its limits while it slides and while it sticks.
    pub sliding: Limit,
    pub sticking: Limit,
}

impl Side {
    pub fn tangents(&self) -> std::ops::Range<usize> {
        self.tangent..self.tangent + self.count
    }
}

/// A limit of friction over a step, N s: what no impulse makes, and what those of rows make of it, by their places.
#[derive(Clone, Debug, Default)]
pub(super) struct Limit {
    pub own: f64,
    pub of_rows: Vec<(usize, f64)>,
}

impl Limit {
    pub fn at(&self, impulses: &[f64]) -> f64 {
        self.of_rows.iter().fold(self.own, |sum, (row, factor)| sum + factor * impulses[*row])
    }

    /// Σ |terms|.
    pub fn terms(&self, impulses: &[f64]) -> f64 {
        self.of_rows.iter().fold(self.own.abs(), |sum, (row, factor)| sum + (factor * impulses[*row]).abs())
    }
}

/// All that the impulses of a step follow from.
#[derive(Clone, Debug, Default)]
pub(super) struct Problem {
    pub sides: Vec<Side>,
    /// Rates of all rows where the step begins, and without impulses of contacts where it ends.
    pub before: Vec<f64>,
    pub free: Vec<f64>,
    /// W: of each row what its impulse does to the rates of all rows that it moves.
    pub moves: Vec<Vec<(usize, f64)>>,
    /// W's diagonal; 0 where constraints hold a row.
    pub own: Vec<f64>,
    /// Sums of the absolute terms of rates, beside which these are rounding.
    pub terms: Vec<f64>,
}

/// What was found.
pub(super) struct Solved {
    pub rates: Vec<f64>,
    /// The largest root of an energy that a row by itself would take.
    pub scale: f64,
    pub residual: f64,
    pub rounds: u32,
}

/// Projections in turn did not come to an end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unsolved {
    /// The contact whose impulse changed most in the last round; then its first row.
    pub contact: usize,
    /// By how much, as a part of the largest.
    pub residual: f64,
    /// How many rounds there were.
    pub rounds: u32,
}

impl Solved {
    /// Whether the laws are met as far as is wanted.
    pub fn is_settled(&self) -> bool {
        self.residual <= SOLVED
    }
}

impl Problem {
    /// The impulses of all rows, from a guess on.
    pub fn solve(&self, impulses: &mut Vec<f64>) -> Result<Solved, Unsolved> {
        let mut rates = self.rates(impulses);
        let root = |row: usize| if self.own[row] > 0.0 { 1.0 / self.own[row].sqrt() } else { 0.0 };
        let largest = |row: usize| root(row) * self.before[row].abs().max(self.free[row].abs()).max(rates[row].abs());
        let scale = (0..self.own.len()).map(largest).fold(0.0, f64::max);
        let mut found = Unsolved { contact: 0, residual: 0.0, rounds: 0 };
        while found.rounds < MOST_ROUNDS {
            found.rounds += 1;
            (found.residual, found.contact) = self.round(found.rounds % 2 == 1, scale, impulses, &mut rates);
            if found.rounds.is_multiple_of(TOGETHER) && found.residual > SOLVED {
                self.try_together(&mut found, scale, impulses, &mut rates);
            }
            let enough = if found.rounds < MOST_ROUNDS { SOLVED } else { ENOUGH };
            if found.residual <= enough || scale == 0.0 {
                return match self.missed() {
                    Some(contact) => Err(Unsolved { contact, residual: f64::INFINITY, rounds: found.rounds }),
                    None => Ok(Solved { rates, scale, residual: found.residual, rounds: found.rounds }),
                };
            }
            if !found.residual.is_finite() {
                // They grow beyond all numbers.
                found.residual = f64::MAX;
                break;
            }
        }
        Err(found)
    }

    /// One round, in the order of the sides or against it, so that what lies on each other learns of both ends alike: the largest change, and of which
    /// contact.
    fn round(&self, forwards: bool, scale: f64, impulses: &mut [f64], rates: &mut [f64]) -> (f64, usize) {
        let (mut most, mut contact, count) = (0.0, 0, self.sides.len());
        for place in 0..count {
            let side = &self.sides[if forwards { place } else { count - 1 - place }];
            let changed = self.across(side, impulses, rates).max(self.along(side, scale, impulses, rates));
            if changed > most * scale || changed.is_nan() {
                (most, contact) = (changed / scale, side.contact);
            }
        }
        (most, contact)
    }

    /// Takes all impulses at once, where a round after that changes less than the last one did.
    fn try_together(&self, found: &mut Unsolved, scale: f64, impulses: &mut Vec<f64>, rates: &mut Vec<f64>) {
        let Some(mut tried) = self.together(impulses, rates, scale) else { return };
        let mut after = self.rates(&tried);
        let (residual, contact) = self.round(true, scale, &mut tried, &mut after);
        if residual < found.residual {
            (found.residual, found.contact) = (residual, contact);
            (*impulses, *rates) = (tried, after);
        }
    }

    /// What impulses do to the rates of all rows.
    pub(super) fn effects(&self, impulses: &[f64]) -> Vec<f64> {
        let mut effects = vec![0.0; self.free.len()];
        for (row, impulse) in impulses.iter().enumerate().filter(|(_, impulse)| **impulse != 0.0) {
            self.moves[row].iter().for_each(|(other, effect)| effects[*other] += effect * impulse);
        }
        effects
    }

    /// The rates of all rows with these impulses.
    pub(super) fn rates(&self, impulses: &[f64]) -> Vec<f64> {
        self.effects(impulses).iter().zip(&self.free).map(|(effect, free)| free + effect).collect()
    }

    /// The contact whose gap closes though constraints hold it: no impulse keeps it from that.
    fn missed(&self) -> Option<usize> {
        let closes = |row: usize| self.own[row] == 0.0 && self.free[row] < -STUCK * self.terms[row];
        self.sides.iter().find(|side| side.normal.is_some_and(closes)).map(|side| side.contact)
    }

    /// Whether a side slides at these rates.
    pub fn slides(&self, side: &Side, rates: &[f64], scale: f64) -> bool {
        if side.count == 0 {
            return false;
        }
        let size = rates[side.tangents()].iter().fold(0.0_f64, |size, rate| size.hypot(*rate));
        size > STUCK * scale * self.stiffest(side).sqrt()
    }

    /// Changes an impulse; how much energy that moves, its root.
    fn change(&self, row: usize, to: f64, impulses: &mut [f64], rates: &mut [f64]) -> f64 {
        let by = to - impulses[row];
        if by == 0.0 {
            return 0.0;
        }
        impulses[row] = to;
        self.moves[row].iter().for_each(|(other, effect)| rates[*other] += effect * by);
        by.abs() * self.own[row].sqrt()
    }

    /// The rate that a gap has at least afterwards; what moves apart already may go on as it likes.
    pub(super) fn least(&self, side: &Side, row: usize) -> f64 {
        (-side.restitution * self.before[row]).max(0.0)
    }

    fn across(&self, side: &Side, impulses: &mut [f64], rates: &mut [f64]) -> f64 {
        let Some(row) = side.normal.filter(|row| self.own[*row] > 0.0) else { return 0.0 };
        let wanted = impulses[row] - (rates[row] - self.least(side, row)) / self.own[row];
        self.change(row, wanted.max(0.0), impulses, rates)
    }

    fn along(&self, side: &Side, scale: f64, impulses: &mut [f64], rates: &mut [f64]) -> f64 {
        let (_, allowed) = self.along_wanted(side, scale, impulses, rates);
        side.tangents().zip(allowed).map(|(row, to)| self.change(row, to, impulses, rates)).fold(0.0, f64::max)
    }

    /// The impulses along a contact that would stop it, and those that friction gives.
    pub(super) fn along_wanted(
        &self,
        side: &Side,
        scale: f64,
        impulses: &[f64],
        rates: &[f64],
    ) -> ([f64; 2], [f64; 2]) {
        let (mut wanted, mut before) = ([0.0; 2], [0.0; 2]);
        if side.tangents().all(|row| self.own[row] == 0.0) {
            return (wanted, wanted);
        }
        let limits = [&side.sliding, &side.sticking].map(|limit| limit.at(impulses).max(0.0));
        let stiffest = self.stiffest(side);
        for (k, row) in side.tangents().enumerate() {
            wanted[k] = if self.own[row] > 0.0 { impulses[row] - rates[row] / stiffest } else { 0.0 };
            before[k] = self.before[row];
        }
        let slid = !side.stuck && self.slides(side, &self.before, scale);
        (wanted, allowed(wanted, limits, slid.then_some(before)))
    }

    /// The largest eigenvalue of W between the rows along a contact, of which there are one or two: with it projections contract.
    fn stiffest(&self, side: &Side) -> f64 {
        let first = side.tangent;
        if side.count < 2 {
            return self.own[first];
        }
        let (a, d) = (self.own[first], self.own[first + 1]);
        let b = self.moves[first].iter().find(|(row, _)| *row == first + 1).map_or(0.0, |(_, effect)| *effect);
        0.5 * (a + d) + (0.25 * (a - d) * (a - d) + b * b).sqrt()
    }
}

/// The impulse along a contact that would stop it, or as much of it as friction gives: up to the limit of sticking, unless that leaves it sliding on as it
/// slid before, and then, as where it begins to slide, that of sliding.
fn allowed(wanted: [f64; 2], [sliding, sticking]: [f64; 2], slid: Option<[f64; 2]>) -> [f64; 2] {
    let size = wanted[0].hypot(wanted[1]);
    let slides_on = slid.is_some_and(|before| size > sliding && wanted[0] * before[0] + wanted[1] * before[1] < 0.0);
    if size == 0.0 || size <= sticking && !slides_on {
        return wanted;
    }
    wanted.map(|part| part * (sliding / size))
}

#[cfg(test)]
mod tests {
    use super::allowed;

    #[test]
    fn friction_holds_what_does_not_slide_and_rubs_what_does() {
        assert_eq!(allowed([1.5, 0.0], [1.0, 2.0], None), [1.5, 0.0]);
        assert_eq!(allowed([2.5, 0.0], [1.0, 2.0], None), [1.0, 0.0]);
        // It slides forwards, and would need more than the friction of sliding to stop.
        assert_eq!(allowed([-1.5, 0.0], [1.0, 2.0], Some([0.3, 0.0])), [-1.0, 0.0]);
        // It would be turned back within the step: it stops, held by the limit of sticking.
        assert_eq!(allowed([1.5, 0.0], [1.0, 2.0], Some([0.3, 0.0])), [1.5, 0.0]);
        assert_eq!(allowed([-0.5, 0.0], [1.0, 2.0], Some([0.3, 0.0])), [-0.5, 0.0]);
        let [along, beside] = allowed([3.0, 4.0], [1.0, 1.0], None);
        assert!((along - 0.6).abs() < 1e-15 && (beside - 0.8).abs() < 1e-15);
        assert_eq!(allowed([0.0, 0.0], [0.0, 0.0], None), [0.0, 0.0]);
    }
}
