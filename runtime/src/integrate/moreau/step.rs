//! One step of the time stepping.

use super::law::Side;
use super::limits::frictions;
use super::rows::{Assembly, Begin, Found};
use super::tally::{ContactTally, Done, Pending, Tally};
use crate::constrain::{STILL, lasting_rows};
use crate::integrate::ends::{Ends, between_ends};
use crate::integrate::{Control, Counters, Endpoint, NO_CONTROL, OneStep, Segment, StepFailure, Trial};
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{At, Contact, ContactMode, KktSolver, System};

/// Numbers that dense output has for each of [q; q']: quadratic places, linear speeds.
const PIECES: usize = 3;
/// More mean multipliers than these (160 MB) are not kept.
const MOST_FORCES: usize = 20_000_000;

/// The time stepping of Moreau and Jean.
pub(crate) struct TimeStepping {
    ends: Ends,
    /// The mechanism since the last beginning, with phases of its own.
    own: Option<Box<dyn System>>,
    contacts: Vec<Contact>,
    restitutions: Vec<f64>,
    lasting: Vec<usize>,
    solver: KktSolver,
    /// Impulses of the last step, all rows of the mechanism: where the next one begins to look.
    impulses: Vec<f64>,
    /// Speeds where the last step ended.
    speeds: Vec<f64>,
    /// Means of the multipliers over the step that was taken last, and over the one that was tried.
    lambda: [Vec<f64>; 2],
    tally: Tally,
    pending: Pending,
    pieces: Vec<f64>,
    steps: u64,
}

impl TimeStepping {
    /// Makes room for n coordinates.
    pub fn new(n: usize, work: bool) -> Self {
        TimeStepping {
            ends: Ends::new(n, work),
            own: None,
            contacts: Vec::new(),
            restitutions: Vec::new(),
            lasting: Vec::new(),
            solver: KktSolver::default(),
            impulses: Vec::new(),
            speeds: Vec::new(),
            lambda: [Vec::new(), Vec::new()],
            tally: Tally::default(),
            pending: Pending::default(),
            pieces: vec![0.0; 2 * n * PIECES],
            steps: 0,
        }
    }

    fn go(&mut self, own: &mut dyn System, Trial { t, h, .. }: Trial<'_>) -> Result<(), StepFailure> {
        let n = self.ends.n;
        let (q, v) = self.ends.y.split_at(n);
        let middle: Vec<f64> = q.iter().zip(v).map(|(q, v)| q + 0.5 * h * v).collect();
        let at = At::new(t + 0.5 * h, &middle, v);
        let stuck = self.stuck(own, At::new(t, q, v));
        let begin = Begin {
            contacts: &self.contacts,
            restitutions: &self.restitutions,
            lasting: &self.lasting,
            stuck: &stuck,
            h,
        };
        let mut assembly = Assembly::new(own, &mut self.solver, at, &begin)?;
        self.steps += 1;
        let guess = assembly.rows.iter().map(|row| self.impulses[*row]).collect();
        let mut found = assembly.found(v, guess)?;
        // Forces of the speeds in the middle, which are known now: flights are of the second order then.
        if assembly.with_speeds(own, &mut self.solver, At { v: &found.mean, ..at }, &begin) {
            found = assembly.found(v, found.impulses)?;
        }
        assembly.possible_limits(h, &found.impulses)?;
        let lambda = &mut self.lambda[1];
        lambda.fill(0.0);
        let held = assembly.held(&found.impulses);
        assembly.lasting.iter().zip(held).for_each(|(row, impulse)| lambda[*row] = impulse / h);
        let mean = At { v: &found.mean, ..at }.constrained(lambda);
        let power = if self.ends.works() { power(own, mean, &self.contacts) } else { 0.0 };
        for i in 0..n {
            self.ends.increment[i] = self.ends.carry[i] + h * found.mean[i];
            self.ends.increment[n + i] = self.ends.carry[n + i] + found.change[i];
        }
        self.ends.add_up();
        self.note(&assembly, &found, t + 0.5 * h, h);
        self.ends.add_work(h * power + self.pending.work);
        Ok(())
    }

    /// Which contacts stuck in the last step, or do not slide where this one begins if it is the first, or speeds jumped since.
    fn stuck(&self, system: &dyn System, at: At<'_>) -> Vec<bool> {
        let sticks =
            |(k, done): (usize, &ContactTally)| self.contacts[k].modes().get(done.mode) == Some(&ContactMode::Sticks);
        if self.speeds == at.v {
            return self.tally.contacts.iter().enumerate().map(sticks).collect();
        }
        let triples = constraint_triples(system, at);
        let rests = |row: u32| {
            let [_, rate, terms] = triples[row as usize];
            rate.abs() <= STILL * terms
        };
        self.contacts.iter().map(|contact| contact.tangents().all(rests)).collect()
    }

    /// Notes what contacts do in a step, and their multipliers.
    fn note(&mut self, assembly: &Assembly, found: &Found, t: f64, h: f64) {
        let (lambda, mut impulses) = (&mut self.lambda[1], vec![0.0; self.impulses.len()]);
        for (row, impulse) in assembly.rows.iter().zip(&found.impulses) {
            (lambda[*row], impulses[*row]) = (impulse / h, *impulse);
        }
        let mut contacts = vec![Done::default(); self.contacts.len()];
        for side in &assembly.problem.sides {
            let contact = &self.contacts[side.contact];
            let mode = mode_of(contact, side, found, assembly.problem.slides(side, &found.rates, found.scale));
            let mut impulse = [0.0; 3];
            impulse[0] = side.normal.map_or(0.0, |row| found.impulses[row]);
            impulse[1..].iter_mut().zip(side.tangents()).for_each(|(own, row)| *own = found.impulses[row]);
            contacts[side.contact] = Done { mode, impulse };
            // The reaction along is what holds: nothing where it slips.
            if contact.modes()[mode].sliding() != 0.0 {
                side.tangents().for_each(|row| lambda[assembly.rows[row]] = 0.0);
            }
        }
        self.pending = Pending {
            h,
            t,
            deepest: assembly.deepest.map(|(contact, depth)| (contact, depth, t)),
            work: assembly.work(&found.impulses, &found.mean),
            residual: found.residual,
            settled: found.settled,
            rounds: found.rounds,
            closed: assembly.closed,
            impulses,
            contacts,
        };
    }
}

/// The power of what has no potential and is no friction of `friction` or `contacts`: in the mean of sliding forwards and backwards that is nothing.
fn power(system: &mut dyn System, at: At<'_>, contacts: &[Contact]) -> f64 {
    let forwards = system.energy(at).power;
    let mut power = forwards;
    for k in frictions(contacts) {
        let mut modes: Vec<ContactMode> = contacts.iter().map(|contact| contact.modes()[0]).collect();
        modes[k] = ContactMode::SlipsBackwards;
        let phase = system.contacts().phase(&modes);
        system.set_phase(phase);
        power += 0.5 * (system.energy(at).power - forwards);
        system.set_phase(0);
    }
    power
}

/// The place of the mode in which a side was in a step, in which it slides at the end or not.
fn mode_of(contact: &Contact, side: &Side, found: &Found, slides: bool) -> usize {
    let mode = match side.normal {
        Some(row) if found.impulses[row] <= 0.0 => ContactMode::Open,
        Some(_) if side.count == 0 => ContactMode::Closed,
        _ if !slides => ContactMode::Sticks,
        _ if contact.direction.is_some() => ContactMode::Slides,
        _ if found.rates[side.tangent] > 0.0 => ContactMode::SlipsForwards,
        _ => ContactMode::SlipsBackwards,
    };
    contact.modes().iter().position(|own| *own == mode).unwrap_or(0)
}

impl OneStep for TimeStepping {
    between_ends!();

    fn control(&self) -> Control {
        NO_CONTROL
    }

    fn counters(&self) -> Counters {
        let evaluations = self.ends.evaluations + self.steps;
        Counters { evaluations, factorizations: self.steps, ..Counters::default() }
    }

    fn begin(&mut self, system: &dyn System, t: f64) -> Result<(), StepFailure> {
        self.contacts = system.contacts().all.to_vec();
        self.restitutions = system.restitutions();
        self.lasting = lasting_rows(system);
        self.own = Some(system.boxed_clone());
        let rows = system.description().rows.len();
        self.impulses.resize(rows, 0.0);
        self.lambda.iter_mut().for_each(|lambda| lambda.resize(rows, f64::NAN));
        let none = |contact: &Contact| {
            let (name, modes) = (contact.name.to_string(), vec![0.0; contact.modes().len()]);
            ContactTally { name, modes, ..ContactTally::default() }
        };
        self.tally.contacts.extend(self.contacts.iter().skip(self.tally.contacts.len()).map(none));
        self.tally.keeps_forces = system.description().outputs_use_accelerations;
        self.ends.begin(system, t)
    }

    fn evaluate(&mut self, system: &dyn System, t: f64, y: &[f64], rate: &mut [f64]) -> Result<(), StepFailure> {
        Ok(system.rate(t, y, rate)?)
    }

    fn attempt(&mut self, _: &dyn System, trial: Trial<'_>) -> Result<f64, StepFailure> {
        let Some(mut own) = self.own.take() else { return Ok(0.0) };
        let outcome = self.go(&mut *own, trial);
        self.own = Some(own);
        outcome.map(|()| 0.0)
    }

    fn conclude(&mut self, _: &dyn System, _: f64, moved: bool) -> Result<bool, StepFailure> {
        let (n, h) = (self.ends.n, self.pending.h);
        if moved {
            self.ends.move_end();
        }
        let Ends { y, end, end_rate, .. } = &mut self.ends;
        end_rate[..n].copy_from_slice(&end[n..]);
        (0..n).for_each(|i| end_rate[n + i] = (end[n + i] - y[n + i]) / h);
        Ok(end_rate.iter().all(|rate| rate.is_finite()))
    }

    fn errors(&self) -> &[f64] {
        &[]
    }

    fn accept(&mut self, compensated: bool) {
        self.ends.accept(compensated);
        self.speeds.clear();
        self.speeds.extend_from_slice(&self.ends.y[self.ends.n..]);
        self.tally.add(&self.pending);
        let [taken, tried] = &mut self.lambda;
        taken.copy_from_slice(tried);
        if self.tally.keeps_forces && self.tally.forces.len() * tried.len() < MOST_FORCES {
            self.tally.forces.push(tried.clone());
        }
        self.impulses.copy_from_slice(&self.pending.impulses);
    }

    fn stiffness(&self, _: f64, _: f64) -> f64 {
        0.0
    }

    fn dense_is_free(&self) -> bool {
        true
    }

    fn dense(&mut self, _: &dyn System, _: f64, h: f64) -> Result<(), StepFailure> {
        let (n, y, end) = (self.ends.n, &self.ends.y, &self.ends.end);
        // q + θ Δq − θ (1 − θ) h Δv/2, v + θ Δv.
        for i in 0..2 * n {
            self.pieces[i] = y[i];
            self.pieces[2 * n + i] = end[i] - y[i];
            self.pieces[4 * n + i] = if i < n { -0.5 * h * (end[n + i] - y[n + i]) } else { 0.0 };
        }
        Ok(())
    }

    fn segment(&self, t: f64, h: f64) -> Segment<'_> {
        Segment { t, h, width: 2 * self.ends.n, pieces: &self.pieces }
    }

    fn tally(&self) -> Option<&Tally> {
        Some(&self.tally)
    }

    fn means(&self) -> Option<[&[f64]; 2]> {
        Some([&self.ends.end_rate[self.ends.n..], &self.lambda[1]])
    }
}
