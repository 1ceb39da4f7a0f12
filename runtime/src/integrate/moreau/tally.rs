//! What contacts did over the steps of a run.

/// What all contacts did so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// How deep the sides of a contact were in each other at the most, in the unit of its gap, with its place and when, s.
    pub deepest: Option<(usize, f64, f64)>,
    /// What contacts and friction did to the energy of the mechanism, J: less than 0 where they took it.
    pub work: f64,
    /// The largest residual of the laws of contact in a step, and the most rounds that were made for one.
    pub residual: f64,
    pub rounds: u32,
    /// How many steps were taken in which impulses still changed, and when the first of them was, s.
    pub unsettled: u64,
    pub first: f64,
    /// The most contacts that were closed in a step.
    pub closed: usize,
    /// How long the last step was, s.
    pub step: f64,
    /// The mean multipliers of all rows in each step, where outputs contain any.
    pub keeps_forces: bool,
    pub forces: Vec<Vec<f64>>,
    /// Of each contact.
    pub contacts: Vec<ContactTally>,
}

/// What one contact did.
#[derive(Clone, Debug, Default)]
pub(crate) struct ContactTally {
    pub name: String,
    /// How long it was in each of its modes, s, in their order.
    pub modes: Vec<f64>,
    /// The place of its mode in the last step.
    pub mode: usize,
    /// The impulses across and along so far, N s, and those of the last step.
    pub impulse: [f64; 3],
    pub last: [f64; 3],
}

/// What one contact does in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Done {
    /// The place of its mode.
    pub mode: usize,
    /// Its impulses across and along.
    pub impulse: [f64; 3],
}

/// What a step that was tried would add.
#[derive(Clone, Debug, Default)]
pub(super) struct Pending {
    pub h: f64,
    /// Its middle, s.
    pub t: f64,
    pub deepest: Option<(usize, f64, f64)>,
    pub work: f64,
    pub residual: f64,
    pub rounds: u32,
    pub settled: bool,
    pub closed: usize,
    /// Of all rows of the mechanism: where the next step begins to look.
    pub impulses: Vec<f64>,
    pub contacts: Vec<Done>,
}

impl Tally {
    /// Adds a step.
    pub(super) fn add(&mut self, pending: &Pending) {
        let deeper = |(_, depth, _): &(usize, f64, f64)| self.deepest.is_none_or(|(_, known, _)| *depth > known);
        self.deepest = pending.deepest.filter(deeper).or(self.deepest);
        if !pending.settled {
            self.first = if self.unsettled == 0 { pending.t } else { self.first };
            self.unsettled += 1;
        }
        self.work += pending.work;
        self.residual = self.residual.max(pending.residual);
        self.rounds = self.rounds.max(pending.rounds);
        self.closed = self.closed.max(pending.closed);
        self.step = pending.h;
        for (contact, done) in self.contacts.iter_mut().zip(&pending.contacts) {
            contact.modes[done.mode] += pending.h;
            contact.mode = done.mode;
            contact.last = done.impulse;
            contact.impulse.iter_mut().zip(done.impulse).for_each(|(sum, impulse)| *sum += impulse);
        }
    }
}
