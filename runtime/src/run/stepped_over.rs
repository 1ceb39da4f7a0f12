//! What steps over contacts tell of them.

use super::Run;

/// What contacts did in a run whose steps go over them ([`Method::Moreau`](crate::Method::Moreau)).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SteppedOver {
    /// The largest overlap of sides, in the middle of a step; `None` where no gap was closed.
    pub deepest: Option<Overlap>,
    /// What contacts and frictions did to the energy of the mechanism, ∑ P·(u⁺ + u⁻)/2, J: less than 0 where they took it.
    pub work: f64,
    /// The largest residual of the laws of contact in a step: by how much the last round of projections changed an impulse, as a part of the largest
    /// that a row by itself would take, both measured by the root of the energy that they move.
    pub residual: f64,
    /// The most rounds of projections that were made for a step.
    pub rounds: u32,
    /// The most contacts whose gaps were closed in a step.
    pub closed: usize,
    /// Each contact and friction, in the order of the file.
    pub contacts: Vec<SteppedContact>,
}

/// How deep the sides of a contact are in each other.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Overlap {
    /// The contact.
    pub contact: String,
    /// −g, in the unit of its gap.
    pub depth: f64,
    /// When, s.
    pub t: f64,
}

/// What a contact pushed with.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SteppedContact {
    /// Its name.
    pub name: String,
    /// Its impulses over the run, of its rows as they are written: across, and along (in space along two directions), N s.
    pub impulse: [f64; 3],
    /// The means of its forces over the last step, likewise, N.
    pub force: [f64; 3],
}

impl Run {
    /// What contacts did, where steps went over them; `None` for a run that located their events.
    ///
    /// # Example
    /// A ball that has come to rest presses with its weight:
    /// ```
    /// use dalembert::prelude::*;
    /// # dalembert::model!(yaml = r#"
    /// # name: Dropped
    /// # parameters: {m: 1 kg, g: 9.81 m/s^2}
    /// # coordinates: {y: m}
    /// # bodies: {ball: {mass: m, position: "[0, y]"}}
    /// # gravity: [0, -g]
    /// # contacts: {floor: {gap: y, on: ball, normal: "[0, 1]"}}
    /// # scene: {start: {y: 1}, until: 1}
    /// # "#);
    /// let run = Dropped::default().simulate().method(Method::Moreau).step(1e-3).run()?;
    /// let contacts = run.stepped_over().unwrap();
    /// assert!((contacts.contacts[0].force[0] - 9.81).abs() < 1e-9);
    /// assert!((contacts.work + 9.81).abs() < 0.1);
    /// assert!(contacts.deepest.unwrap().depth < 5e-3);
    /// # Ok::<(), dalembert::Error>(())
    /// ```
    pub fn stepped_over(&self) -> Option<SteppedOver> {
        let tally = self.tally.as_ref()?;
        let name = |contact: usize| tally.contacts[contact].name.clone();
        let deepest = tally.deepest.map(|(contact, depth, t)| Overlap { contact: name(contact), depth, t });
        let contacts = tally.contacts.iter().map(|known| SteppedContact {
            name: known.name.clone(),
            impulse: known.impulse,
            force: known.last.map(|impulse| if tally.step > 0.0 { impulse / tally.step } else { 0.0 }),
        });
        Some(SteppedOver {
            deepest,
            work: tally.work,
            residual: tally.residual,
            rounds: tally.rounds,
            closed: tally.closed,
            contacts: contacts.collect(),
        })
    }
}
