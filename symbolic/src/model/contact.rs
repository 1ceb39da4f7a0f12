//! Friction that may stick and contacts that may open: each is in one of a few modes, and a phase is one mode for each.

use crate::diagnose::Place;
use crate::expr::Id;

/// What `friction` or `contacts` declares.
///
/// A contact has a gap g ≥ 0 and a force N ≥ 0 across it, of which one is 0; where something rubs there is a sliding rate s, and a force T
/// against it: T = −L sign(s) while it slides, |T| ≤ L₀ while it sticks, s = 0. In space s and T are vectors across the normal, T = −L s/|s|.
#[derive(Clone, Debug)]
pub struct Contact {
    /// Its expanded name.
    pub name: String,
    /// The constraint g = 0, by its place; absent for friction alone, which is always in touch.
    pub normal: Option<usize>,
    /// The constraint s = 0, by its place; absent where nothing rubs. In space it has two rows.
    pub tangent: Option<usize>,
    /// In space, where something rubs: the first of three held values, by its place, which are the direction of sliding, as components along both
    /// rows of `tangent`, and the rate below which a sliding rate has no direction of its own.
    pub direction: Option<usize>,
    /// The coefficient of restitution, of parameters; absent for friction alone.
    pub restitution: Option<Id>,
    /// The first of its events, by its place: with a gap it lands (g falls through 0) and lifts (N does); where something rubs it stops
    /// (s, or in space its component along the direction of sliding, is 0) and slips (L₀² − T² falls through 0).
    pub first_event: usize,
    /// Where it is declared.
    pub place: Place,
}

impl Contact {
    /// The held values that are its direction of sliding in space, by their places.
    pub fn held(&self) -> impl Iterator<Item = usize> + use<> {
        self.direction.into_iter().flat_map(|first| first..first + 3)
    }

    /// What it may do.
    pub fn modes(&self) -> &'static [ContactMode] {
        ContactMode::of(self.normal.is_some(), self.tangent.is_some(), self.direction.is_some())
    }
}

/// What a contact does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactMode {
    /// Its sides are apart.
    Open,
    /// Its sides touch, and nothing rubs.
    Closed,
    /// s = 0.
    Sticks,
    /// s ≥ 0.
    SlipsForwards,
    /// s ≤ 0.
    SlipsBackwards,
    /// s in any direction, in space.
    Slides,
}

impl ContactMode {
    /// The modes of a contact with these constraints; the first is in force where a model's first phase is.
    pub fn of(normal: bool, tangent: bool, in_space: bool) -> &'static [ContactMode] {
        use ContactMode::{Closed, Open, Slides, SlipsBackwards, SlipsForwards, Sticks};
        match (normal, tangent) {
            (true, true) if in_space => &[Open, Slides, Sticks],
            (true, true) => &[Open, SlipsForwards, SlipsBackwards, Sticks],
            (true, false) => &[Open, Closed],
            (false, _) => &[SlipsForwards, SlipsBackwards, Sticks],
        }
    }

    /// In words after a contact's name.
    pub fn words(self) -> &'static str {
        match self {
            ContactMode::Open => "open",
            ContactMode::Closed => "closed",
            ContactMode::Sticks => "sticks",
            ContactMode::SlipsForwards => "slips forwards",
            ContactMode::SlipsBackwards => "slips backwards",
            ContactMode::Slides => "slides",
        }
    }

    /// Whether the sides touch.
    pub fn touches(self) -> bool {
        self != ContactMode::Open
    }

    /// Whether they slide on each other: in a mode of a contact where something rubs.
    pub fn slips(self) -> bool {
        matches!(self, ContactMode::SlipsForwards | ContactMode::SlipsBackwards | ContactMode::Slides)
    }
}

/// What several contacts that strike at once do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImpactLaw {
    /// One after the other, the fastest approach first, until none approaches.
    Sequential,
    /// All at once, by Newton's law: no rate of a gap is less than −e times what it was.
    Together,
    /// All at once, compressed without restitution, then e times those impulses are given back (Poisson).
    Poisson,
}

/// All combinations of what contacts do are phases up to so many: four contacts with friction have them.
pub const MOST_COMBINATIONS: usize = 256;

/// Whether contacts with these modes have more than [`MOST_COMBINATIONS`]: then only what each does alone is a phase.
pub fn are_single(of: &[&'static [ContactMode]]) -> bool {
    let count = of.iter().try_fold(1_usize, |count, modes| count.checked_mul(modes.len()));
    count.is_none_or(|count| count > MOST_COMBINATIONS)
}

/// The modes of all contacts in every phase: all combinations, the last contact's changing fastest; or, where these are too many, the first
/// modes of all, and then each other mode of each contact by itself.
pub fn modes_of_phases(of: &[&'static [ContactMode]]) -> Vec<Vec<ContactMode>> {
    if !are_single(of) {
        return of.iter().fold(vec![Vec::new()], |before, modes| {
            let with = |one: &Vec<ContactMode>| {
                let one = one.clone();
                modes.iter().map(move |mode| [one.as_slice(), &[*mode]].concat()).collect::<Vec<_>>()
            };
            before.iter().flat_map(with).collect()
        });
    }
    let first: Vec<ContactMode> = of.iter().map(|modes| modes[0]).collect();
    let alone = |(k, mode): (usize, ContactMode)| {
        let mut modes = first.clone();
        modes[k] = mode;
        modes
    };
    let others = of.iter().enumerate().flat_map(|(k, modes)| modes[1..].iter().map(move |mode| (k, *mode)));
    std::iter::once(first.clone()).chain(others.map(alone)).collect()
}
