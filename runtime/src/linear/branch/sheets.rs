//! Which states of a branch come first at their value: between folds it is made of sheets, one above the other.

use super::TurningPoint;
use super::continuation::{End, Path};

/// The values that a branch has reached: it is in one piece, so that there are no gaps.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cover {
    pub low: f64,
    pub high: f64,
}

impl Cover {
    pub fn none() -> Cover {
        Cover { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }

    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    fn reach(&mut self, value: f64) {
        *self = Cover { low: self.low.min(value), high: self.high.max(value) };
    }
}

/// Paths from one start: tells each sheet of theirs what sheets with fewer folds before them, and earlier paths, have reached.
pub(super) fn order(paths: &mut [Path], cover: &mut Cover) {
    let most = paths.iter().map(|path| path.turning_points.len()).max().unwrap_or(0);
    for sheet in 0..=most {
        let before = *cover;
        for path in paths.iter_mut().filter(|path| sheet <= path.turning_points.len()) {
            path.before.push(before);
            path.points[path.states_of(sheet)].iter().for_each(|state| cover.reach(state.value));
            path.turning_points.get(sheet).into_iter().for_each(|turn| cover.reach(turn.at.value));
        }
    }
}

impl Path {
    /// A closed path as two that meet on its middle sheet.
    pub fn halved(self) -> [Path; 2] {
        let middle = self.states_of(self.turning_points.len() / 2);
        let cut = (middle.start + middle.end) / 2;
        let all = self.points.len();
        let (near, far): (Vec<TurningPoint>, Vec<TurningPoint>) =
            self.turning_points.into_iter().partition(|turn| turn.index <= cut);
        let back = far.into_iter().rev().map(|turn| TurningPoint { index: all - turn.index, ..turn }).collect();
        let rest = self.points[cut..].iter().rev().cloned().collect();
        let path = |points, turning_points| Path { points, turning_points, end: End::Closed, before: Vec::new() };
        [path(self.points[..=cut].to_vec(), near), path(rest, back)]
    }

    /// How many folds lie before the state of this index.
    pub fn sheet(&self, index: usize) -> usize {
        self.turning_points.iter().filter(|turn| turn.index <= index).count()
    }

    /// Whether the branch has been at a value of a sheet before.
    pub fn folded(&self, sheet: usize, value: f64) -> bool {
        self.before.get(sheet).is_some_and(|before| before.contains(value))
    }

    /// The places of this path's states of the sheet, those with this many folds before them.
    pub fn states_of(&self, sheet: usize) -> std::ops::Range<usize> {
        let from = if sheet == 0 { 0 } else { self.turning_points[sheet - 1].index };
        from..self.turning_points.get(sheet).map_or(self.points.len(), |turn| turn.index)
    }
}
