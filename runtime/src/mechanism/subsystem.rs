//! A part of a mechanism as a system of its own.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::{
    Argument, At, Counts, Description, Energy, Gimbal, List, Part, Scene, Signal, Singular, Structure, System, Watched,
};

/// One of `description().parts` of a mechanism.
///
/// Accelerations and energies are computed for the part alone; all else is computed for the whole, in which the other coordinates are
/// held at a place with no speed, and what belongs to the part is taken.
pub(crate) struct OfPart {
    whole: Box<dyn System>,
    index: usize,
    coordinates: Vec<usize>,
    /// Its events among those of the whole.
    events: Vec<usize>,
    /// How many coordinates the whole has.
    size: usize,
    description: Description,
    gimbals: Vec<Gimbal>,
    places: Places,
    room: Mutex<Room>,
}

/// Where the part's entries are among those of the whole.
#[derive(Clone)]
struct Places {
    mass: Vec<usize>,
    stiffness: Vec<usize>,
    damping: Vec<usize>,
    input: Vec<usize>,
    time: Vec<usize>,
    /// Both numbers of each argument, and of each event.
    arguments: Vec<usize>,
    events: Vec<usize>,
}

/// A state of the whole, and what is computed of it.
#[derive(Clone)]
struct Room {
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    values: [Vec<f64>; 2],
}

impl OfPart {
    /// The part of this index, the others being held at a place of the whole; `None` if there is no such part.
    pub fn new(system: &dyn System, index: usize, place: &[f64]) -> Option<OfPart> {
        let part = system.description().parts.get(index)?;
        let own = |i: u32| part.coordinates.iter().position(|known| *known == i).map(|place| place as u32);
        let (description, places) = described(system.description(), part);
        let gimbals = system.gimbals().iter().filter_map(|gimbal| {
            let [first, middle, last] = gimbal.coordinates.map(own);
            Some(Gimbal { coordinates: [first?, middle?, last?], ..gimbal.clone() })
        });
        let gimbals = gimbals.collect();
        let n = system.len();
        Some(OfPart {
            gimbals,
            places,
            events: part.events.iter().map(|k| *k as usize).collect(),
            whole: system.boxed_clone(),
            index,
            coordinates: part.coordinates.iter().map(|i| *i as usize).collect(),
            size: n,
            description,
            room: Mutex::new(Room {
                q: place.to_vec(),
                v: vec![0.0; n],
                a: vec![0.0; n],
                values: [Vec::new(), Vec::new()],
            }),
        })
    }

    /// Its coordinates among those of the whole.
    pub fn coordinates(&self) -> &[usize] {
        &self.coordinates
    }

    /// Its events among those of the whole.
    pub fn events(&self) -> &[usize] {
        &self.events
    }

    fn room(&self) -> MutexGuard<'_, Room> {
        self.room.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The room, with this state in it.
    fn at(&self, at: At<'_>) -> MutexGuard<'_, Room> {
        let mut room = self.room();
        let Room { q, v, a, .. } = &mut *room;
        for (numbers, whole) in [(at.q, q), (at.v, v), (at.a, a)] {
            for (k, i) in self.coordinates.iter().enumerate() {
                whole[*i] = numbers.get(k).copied().unwrap_or(0.0);
            }
        }
        room
    }

    /// What belongs to the part of a list of the whole.
    fn pick(
        &self,
        at: At<'_>,
        (size, places): (usize, &[usize]),
        out: &mut [f64],
        compute: impl FnOnce(&dyn System, At<'_>, &mut [f64]),
    ) {
        let mut room = self.at(at);
        let Room { q, v, a, values: [values, _] } = &mut *room;
        values.resize(size, 0.0);
        compute(&*self.whole, At::new(at.t, q, v).accelerated(a), values);
        out.iter_mut().zip(places).for_each(|(out, place)| *out = values[*place]);
    }
}

/// The description of a part with its own numbers, and where its entries are among those of the whole; outputs, invariants and integrals
/// are asked of the whole.
fn described(whole: &Description, part: &Part) -> (Description, Places) {
    let own = |i: u32| part.coordinates.iter().position(|known| *known == i).map(|place| place as u32);
    let square = |list: &List<(u32, u32)>| entries(list, |(row, column)| Some((own(row)?, own(column)?)));
    let (mass_pattern, mass) = square(&whole.mass_pattern);
    let (stiffness_pattern, stiffness) = square(&whole.stiffness_pattern);
    let (damping_pattern, damping) = square(&whole.damping_pattern);
    let (input_pattern, input) = entries(&whole.input_pattern, |(row, column)| Some((own(row)?, column)));
    let (time_pattern, time) = entries(&whole.time_pattern, own);
    let pairs = |list: &[u32]| list.iter().flat_map(|k| [2 * *k as usize, 2 * *k as usize + 1]).collect();
    let (arguments, events) = (pairs(&part.arguments), pairs(&part.events));
    let description = Description {
        rotations: whole.rotations.iter().filter_map(|first| own(*first)).collect(),
        coordinates: part.coordinates.iter().filter_map(|i| whole.coordinates.get(*i as usize).cloned()).collect(),
        mass_pattern,
        stiffness_pattern,
        damping_pattern,
        input_pattern,
        time_pattern,
        integrals: List::default(),
        outputs: List::default(),
        outputs_use_accelerations: false,
        outputs_of_reactions: List::default(),
        invariants: List::default(),
        arguments: part.arguments.iter().filter_map(|place| argument(whole, part, *place)).collect(),
        events: part.events.iter().filter_map(|k| whole.events.get(*k as usize).cloned()).collect(),
        draw: List::default(),
        balances: List::default(),
        structure: Structure {
            mass_blocks: List::default(),
            constant_mass: whole.structure.constant_mass || part.separable,
            separable: part.separable,
            linear: part.linear,
            conservative: part.conservative,
            time_dependent: part.time_dependent,
            cyclic: List::default(),
            ..whole.structure.clone()
        },
        parts: List::default(),
        counts: Counts { accelerations: part.accelerations, ..whole.counts },
        ..whole.clone()
    };
    (description, Places { mass, stiffness, damping, input, time, arguments, events })
}

/// An argument of the whole with the part's numbers of what it is inside of.
fn argument(whole: &Description, part: &Part, place: u32) -> Option<Argument> {
    let listed = |list: &[u32], k: u32| list.iter().position(|known| *known == k).map(|place| place as u32);
    let mut argument = whole.arguments.get(place as usize)?.clone();
    match &mut argument.of {
        Watched::Argument(outer) => *outer = listed(&part.arguments, *outer)?,
        Watched::Event(event) => *event = listed(&part.events, *event)?,
        Watched::Motion | Watched::Switch(_) => {}
    }
    Some(argument)
}

/// The entries that a part has, as it numbers them, and their places among all.
fn entries<T: Copy>(list: &List<T>, own: impl Fn(T) -> Option<T>) -> (List<T>, Vec<usize>)
where
    [T]: ToOwned<Owned = Vec<T>>,
{
    let found = list.iter().enumerate().filter_map(|(place, entry)| Some((own(*entry)?, place)));
    let (entries, places): (Vec<T>, Vec<usize>) = found.unzip();
    (entries.into(), places)
}

impl System for OfPart {
    fn description(&self) -> &Description {
        &self.description
    }

    fn gimbals(&self) -> &[Gimbal] {
        &self.gimbals
    }

    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        let mut room = self.at(at);
        let Room { q, v, a: all, .. } = &mut *room;
        self.whole.part_accelerations(self.index, At::new(at.t, q, v), all)?;
        self.coordinates.iter().zip(a).for_each(|(i, own)| *own = all[*i]);
        Ok(())
    }

    fn frequencies(&self) -> Option<Vec<f64>> {
        self.whole.frequencies()
    }

    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]) {
        let size = self.whole.description().mass_pattern.len();
        self.pick(at, (size, &self.places.mass), values, |whole, at, all| whole.mass_matrix(at, all));
    }

    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        self.pick(at, (self.size, &self.coordinates), h, |whole, at, all| whole.bias(at, all));
    }

    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.pick(at, (self.size, &self.coordinates), f, |whole, at, all| whole.residual(at, all));
    }

    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        let description = self.whole.description();
        let mut room = self.at(at);
        let Room { q, v, a, values: [by_place, by_speed] } = &mut *room;
        by_place.resize(description.stiffness_pattern.len(), 0.0);
        by_speed.resize(description.damping_pattern.len(), 0.0);
        self.whole.jacobians(At::new(at.t, q, v).accelerated(a), by_place, by_speed);
        dq.iter_mut().zip(&self.places.stiffness).for_each(|(out, place)| *out = by_place[*place]);
        dv.iter_mut().zip(&self.places.damping).for_each(|(out, place)| *out = by_speed[*place]);
    }

    fn input_jacobian(&self, at: At<'_>, du: &mut [f64]) {
        let size = self.whole.description().input_pattern.len();
        self.pick(at, (size, &self.places.input), du, |whole, at, all| whole.input_jacobian(at, all));
    }

    fn time_jacobian(&self, at: At<'_>, dt: &mut [f64]) {
        let size = self.whole.description().time_pattern.len();
        self.pick(at, (size, &self.places.time), dt, |whole, at, all| whole.time_jacobian(at, all));
    }

    fn time_dependence(&self, at: At<'_>, dt: &mut [f64]) {
        let size = self.whole.description().time_pattern.len();
        self.pick(at, (size, &self.places.time), dt, |whole, at, all| whole.time_dependence(at, all));
    }

    fn magnitudes(&self, at: At<'_>, sums: &mut [f64]) {
        self.pick(at, (self.size, &self.coordinates), sums, |whole, at, all| whole.magnitudes(at, all));
    }

    fn energy(&self, at: At<'_>) -> Energy {
        let room = self.at(at);
        self.whole.part_energy(self.index, At::new(at.t, &room.q, &room.v))
    }

    fn arguments(&self, at: At<'_>, pairs: &mut [f64]) {
        let size = 2 * self.whole.description().arguments.len();
        self.pick(at, (size, &self.places.arguments), pairs, |whole, at, all| whole.arguments(at, all));
    }

    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        let size = 2 * self.whole.description().events.len();
        self.pick(at, (size, &self.places.events), pairs, |whole, at, all| whole.events(at, all));
    }

    fn event_rates(&self, at: At<'_>, rates: &mut [f64]) {
        let size = self.whole.description().events.len();
        self.pick(at, (size, &self.events), rates, |whole, at, all| whole.event_rates(at, all));
    }

    fn signal(&self, index: usize) -> Option<&Signal> {
        self.whole.signal(index)
    }

    fn inputs(&self, t: f64, values: &mut [f64]) {
        self.whole.inputs(t, values);
    }

    fn scene(&self, scene: usize) -> Scene {
        let scene = self.whole.scene(scene);
        let own = |all: &[f64]| self.coordinates.iter().filter_map(|i| all.get(*i).copied()).collect();
        Scene { q: own(&scene.q), v: own(&scene.v), held_q: Vec::new(), held_v: Vec::new(), spins: Vec::new(), ..scene }
    }

    fn force_errors(&self, at: At<'_>, errors: &mut [f64]) {
        self.pick(at, (self.size, &self.coordinates), errors, |whole, at, all| whole.force_errors(at, all));
    }

    fn disturb_forces(&mut self, times: f64) {
        self.whole.disturb_forces(times);
    }

    fn disturbance(&self) -> f64 {
        self.whole.disturbance()
    }

    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(OfPart {
            whole: self.whole.boxed_clone(),
            index: self.index,
            coordinates: self.coordinates.clone(),
            events: self.events.clone(),
            size: self.size,
            description: self.description.clone(),
            gimbals: self.gimbals.clone(),
            places: self.places.clone(),
            room: Mutex::new(self.room().clone()),
        })
    }
}
