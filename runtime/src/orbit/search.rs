//! A search for a motion that repeats, and the way to it.

use nalgebra::DVector;

use super::begun::{Begun, WITHIN};
use super::closing::{By, Closing, Difference};
#[cfg(feature = "interpret")]
use super::double_double::Wanted;
use super::drive::Drive;
use super::found::Orbit;
use super::guess::{first_run, states_of};
use super::laps::{Laps, Time};
use super::{acting, guess, structure};
use crate::error::{Error, NearReturn, NoOrbit};
use crate::linear::has_dependent_coordinates;
#[cfg(feature = "interpret")]
use crate::mechanism::Interpreted;
use crate::mechanism::{Action, At, Closes, Description, Goal, System};
#[cfg(feature = "interpret")]
use crate::precision::DoubleOnly;
use crate::run::{Run, Side};
use crate::simulate::{Described, Settings, Simulation, simulate};

/// A search that is being described: how a motion is to close, and where to look for one.
///
/// What is not said is found: the motion closes after a period, which comes from what depends on time, or from where the run comes near to
/// its own states again.
#[must_use = "nothing happens before `find`"]
pub struct OrbitSearch {
    pub(super) described: Result<Described, Error>,
    period: Option<f64>,
    part: Option<usize>,
    after: Option<(String, usize)>,
    images: Vec<(String, String)>,
    mirrored: Vec<String>,
    shifted: Vec<String>,
    turned: Vec<(String, f64)>,
    mode: Option<(usize, f64)>,
    /// Whether the mode's period is no guess of the motion's.
    far_from_small: bool,
    rest: bool,
    energy: Option<f64>,
    legs: Option<usize>,
    /// Parameters, by their places, that vary among motions that are looked for.
    pub(super) varies: Vec<usize>,
    /// A motion of the file by its place, and how it closes, to which the rest is added.
    motion: Option<(usize, Closes)>,
    /// The mechanism to interpret in double-double, or why there is none; `None` where that is not asked for.
    #[cfg(feature = "interpret")]
    extended: Option<Result<Interpreted, DoubleOnly>>,
}

/// Where a search begins at a mode.
struct ModeStart {
    /// The coordinates of the equilibrium; `None` without a mode.
    rests: Option<Vec<f64>>,
    /// The coordinate that moves most.
    moves: Option<usize>,
    /// A guess of the period, s: the user's, or the mode's.
    period: Option<f64>,
}

impl<S: System + 'static> Simulation<S> {
    /// Begins a search for a motion near this run that repeats itself.
    ///
    /// ```
    #[doc = include_str!("../../examples/orbit.rs")]
    /// ```
    pub fn orbit(self) -> OrbitSearch {
        let described = self.described();
        OrbitSearch::of(
            described.map(|(system, settings, origin)| (Box::new(system) as Box<dyn System>, settings, origin)),
        )
    }

    /// Begins a search for a motion that the file describes under `motions`, which closes.
    pub fn orbit_of(self, name: &str) -> OrbitSearch {
        let begun = self.of_motion(name).and_then(|(simulation, motion)| {
            let (system, settings, origin) = simulation.described()?;
            let Goal::Closes(closes) = system.motions()[motion].goal.clone() else {
                return Err(NoOrbit::ClosesNot { motion: name.to_owned() }.into());
            };
            let described = Ok((Box::new(system) as Box<dyn System>, settings, origin));
            Ok(OrbitSearch::of(described).asking(motion, &closes))
        });
        begun.unwrap_or_else(|error| OrbitSearch::of(Err(error)))
    }
}

/// Unless the user gives another: multipliers and thresholds lose half of the digits of a motion, and more.
const TOLERANCE: f64 = 1e-12;
/// Pieces a period, unless events or the user say otherwise: single pieces are never better, and more cost linear algebra.
const LEGS: usize = 8;

impl OrbitSearch {
    /// Of a run that was described.
    pub(crate) fn of(described: Result<Described, Error>) -> OrbitSearch {
        OrbitSearch {
            described,
            period: None,
            part: None,
            after: None,
            images: Vec::new(),
            mirrored: Vec::new(),
            shifted: Vec::new(),
            turned: Vec::new(),
            mode: None,
            far_from_small: false,
            rest: false,
            energy: None,
            legs: None,
            varies: Vec::new(),
            motion: None,
            #[cfg(feature = "interpret")]
            extended: None,
        }
    }

    /// With what the motion of this place in the file says; its numbers follow the parameters.
    pub(crate) fn asking(mut self, place: usize, closes: &Closes) -> Self {
        self.motion = Some((place, closes.clone()));
        self
    }

    /// A guess of the period, s; of a mechanism that depends on time, the period.
    pub fn period(mut self, period: f64) -> Self {
        self.period = Some(period);
        self
    }

    /// The motion closes after this part of the period, 1/`part`, exchanged and mirrored as is said.
    pub fn part(mut self, part: usize) -> Self {
        self.part = Some(part.max(1));
        self
    }

    /// The motion closes when an event has happened so many times, in the state after it.
    pub fn after(mut self, event: &str, count: usize) -> Self {
        self.after = Some((event.to_owned(), count.max(1)));
        self
    }

    /// The second coordinate has at the end the value that the first had at the start, and the other way round unless it is exchanged too;
    /// phases likewise.
    pub fn exchanged(mut self, a: &str, b: &str) -> Self {
        self.images.push((a.to_owned(), b.to_owned()));
        self
    }

    /// A coordinate has the opposite sign at the end.
    pub fn mirrored(mut self, coordinate: &str) -> Self {
        self.mirrored.push(coordinate.to_owned());
        self
    }

    /// A coordinate may be any amount more at the end; nothing may depend on it.
    pub fn shifted(mut self, coordinate: &str) -> Self {
        self.shifted.push(coordinate.to_owned());
        self
    }

    /// An angle is so many turns more at the end.
    pub fn turned(mut self, coordinate: &str, turns: f64) -> Self {
        self.turned.push((coordinate.to_owned(), turns));
        self
    }

    /// Begins at rest, displaced along a mode of the equilibrium, the first being 1, so that the coordinate that moves most moves by
    /// `amplitude`.
    pub fn from_mode(mut self, mode: usize, amplitude: f64) -> Self {
        self.mode = Some((mode, amplitude));
        self
    }

    /// The coordinate that moves most in a mode of the equilibrium, by its place: that of which [`OrbitSearch::from_mode`] takes the amplitude.
    ///
    /// # Errors
    /// No equilibrium, no such mode.
    #[cfg(feature = "cli")]
    pub(crate) fn most_moved(&self, mode: usize) -> Result<usize, Error> {
        let (system, settings, _) = self.described.as_ref().map_err(Error::clone)?;
        guess::most_moved(&**system, &settings.q, mode)
    }

    /// Begins with all speeds 0 where the scene starts: rest under a drive.
    pub fn at_rest(mut self) -> Self {
        self.rest = true;
        self
    }

    /// The energy of the motion, J: the Jacobi integral, counted from the equilibrium where the search begins from a mode.
    pub fn energy(mut self, energy: f64) -> Self {
        self.energy = Some(energy);
        self
    }

    /// Pieces into which the map is cut.
    pub fn legs(mut self, legs: usize) -> Self {
        self.legs = Some(legs.max(1));
        self
    }

    /// Goes on in double-double from what is found, by this mechanism interpreted: [`Orbit::extended`](super::Orbit).
    ///
    /// Pieces are run by the method of Gragg, Bulirsch and Stoer; what they miss each other by is taken away by the slopes of the search, so that each
    /// correction leaves a part of the one before it which is as small as the error of those slopes.  Digits that are told agree with those of a second
    /// extrapolation.  Of motions without constraints, discontinuities, events that act, or forces that depend on time.
    #[cfg(feature = "interpret")]
    pub fn in_double_double(self, model: &Interpreted) -> Self {
        self.extended(Ok(model.clone()))
    }

    /// The same where there may be a reason for no mechanism.
    #[cfg(feature = "interpret")]
    pub(crate) fn extended(mut self, model: Result<Interpreted, DoubleOnly>) -> Self {
        self.extended = Some(model);
        self
    }

    /// Searches.  Where the motion of an energy is not found near those of small motions of a mode, their family leads to it; where a guess of the
    /// period leads to rest, the run's own near returns are tried.
    ///
    /// # Errors
    /// [`Error::NoOrbit`]; names that are unknown; what ends the first run early; [`Error::NoSlopes`].
    pub fn find(self) -> Result<Orbit, Error> {
        let (scene, small, unguessed) = (self.scene(), self.small_motions(), self.without_period());
        let search = |begins: OrbitSearch| {
            let mut begun = begins.begin()?;
            let solution = begun.first()?;
            begun.finish(solution)
        };
        let rests = |error: &Error| matches!(error, Error::NoOrbit(why) if matches!(**why, NoOrbit::Rest));
        let found = match search(self) {
            Err(error) if error.is_interruption() => Err(error),
            Err(error) => match (small, unguessed) {
                (Some((small, energy)), _) => small.along_energies(energy).map_err(|_| error),
                (None, Some(unguessed)) if rests(&error) => search(unguessed).map_err(|_| error),
                _ => Err(error),
            },
            found => found,
        };
        found.map_err(|error| with_returns(error, scene))
    }

    /// The run that was described.
    pub(super) fn scene(&self) -> Option<(Box<dyn System>, Settings)> {
        let (system, settings, _) = self.described.as_ref().ok()?;
        Some((system.boxed_clone(), settings.clone()))
    }

    /// The search for small motions of a mode, and the energy of the motion that is asked for, where it is one of theirs.
    fn small_motions(&self) -> Option<(OrbitSearch, f64)> {
        let (energy, _) = self.energy.zip(self.mode).filter(|_| self.motion.is_none())?;
        Some((OrbitSearch { energy: None, ..self.again()? }, energy))
    }

    /// The search without a guess of the period: neither the user's, nor that of small motions.
    fn without_period(&self) -> Option<OrbitSearch> {
        (self.period.is_some() || self.mode.is_some()).then_some(())?;
        Some(OrbitSearch { period: None, far_from_small: true, ..self.again()? })
    }

    /// The same search; `None` where what was described has an error.
    fn again(&self) -> Option<OrbitSearch> {
        let (system, settings, origin) = self.described.as_ref().ok()?;
        Some(OrbitSearch {
            described: Ok((system.boxed_clone(), settings.clone(), origin.clone())),
            after: self.after.clone(),
            images: self.images.clone(),
            mirrored: self.mirrored.clone(),
            shifted: self.shifted.clone(),
            turned: self.turned.clone(),
            varies: self.varies.clone(),
            motion: self.motion.clone(),
            #[cfg(feature = "interpret")]
            extended: self.extended.clone(),
            ..*self
        })
    }

    /// The laps and a guess.
    pub(super) fn begin(mut self) -> Result<Begun, Error> {
        let closing = match &self.described {
            Ok((system, ..)) => self.closing(system.description())?,
            Err(_) => Closing::default(),
        };
        let (mut system, mut settings) = self.start()?;
        let stated = self.period.is_some();
        let timed = acting::time_acts(&*system, &self.varies, &[settings.q.as_slice(), &settings.v].concat());
        let drive = if timed { Drive::of(&*system, self.period)? } else { Drive::None };
        let ModeStart { rests, moves, mut period } = self.begin_at_mode(&*system, &mut settings)?;
        let rest_energy = rests.as_ref().map_or(0.0, |q| {
            let still = vec![0.0; q.len()];
            system.energy(At::new(0.0, q, &still)).jacobi
        });
        let time = match (closing.by, timed) {
            (By::After { .. }, _) => Time::Event,
            (By::Part(_), true) => Time::Driven,
            (By::Part(_), false) => Time::Free,
        };
        if time == Time::Driven {
            period = Some(drive.period(&*system)?);
        }
        // With a period that is stated the motion that is looked for is the one nearest to the start.
        let may_settle = timed && !stated;
        let (run, scales, lap) = first_run(&mut *system, &mut settings, &closing, (period, may_settle))?;
        // What holds at the start, as friction that sticks there, is decided by a run.
        let start = run.first().t;
        let begun = run.phases.iter().take_while(|(t, _)| *t <= start).last().map(|(_, phase)| *phase);
        settings.phase = begun.unwrap_or(settings.phase);
        if self.mode.is_some() {
            let first = run.first();
            guess::begin_at(&mut settings, [first.q, first.v].concat());
        }
        if timed {
            let later = if time == Time::Event { lap } else { period.unwrap_or(lap) };
            super::drive::repeats(&*system, closing.by, &run, later)?;
        }
        let known = may_close(&mut *system, &settings, (&closing, &run), if timed { lap } else { 0.0 })?;
        let acts = run.junctions.iter().any(|junction| !junction.events.is_empty());
        let legs = self.pieces(closing.by, acts);
        let given = Closing { reversed: Vec::new(), ..closing.clone() } != Closing::period(system.description());
        let turns = time == Time::Free && closing.reversed.is_empty();
        let energy = self.energy.map(|energy| energy + rest_energy);
        let momenta =
            if acts { Vec::new() } else { momenta(&mut *system, &settings, &self.varies, (&closing, &run), known) };
        let mut laps = Laps {
            system,
            settings,
            closing,
            time,
            drive,
            laps: 1,
            legs,
            parameter: None,
            varies: self.varies,
            parameter_size: 0.0,
            energy,
            away: None,
            momenta,
            scales,
            runs: 0,
            steps: 0,
        };
        if self.energy.is_some() && !laps.keeps_energy() {
            return Err(NoOrbit::NoEnergy.into());
        }
        let point = if laps.time == Time::Event { laps.in_turn(&run)? } else { laps.along(&run, lap)? };
        Ok(Begun {
            laps,
            point,
            given,
            acts,
            rest_energy,
            repeats: 1,
            turns: moves.filter(|_| turns),
            chosen: self.legs.is_some(),
            elsewhere: Vec::new(),
            #[cfg(feature = "interpret")]
            extended: self.extended.map(|model| Wanted { model, energy: self.energy, rests }),
        })
    }

    /// The mechanism, and how its runs are computed; with the period and the energy that the file says of the motion.
    fn start(&mut self) -> Result<(Box<dyn System>, Settings), Error> {
        let (system, mut settings, origin) = std::mem::replace(&mut self.described, Err(NoOrbit::Rest.into()))?;
        if system.description().has_states() {
            return Err(NoOrbit::States.into());
        }
        if !system.sampling().is_empty() {
            return Err(NoOrbit::Memory.into());
        }
        if !origin.tolerance {
            settings.tolerance = settings.tolerance.min(TOLERANCE);
        }
        if let Some((place, closes)) = &self.motion {
            let numbers = system.motion_numbers(*place);
            self.period = self.period.or(closes.period.then_some(numbers.period));
            self.energy = self.energy.or(closes.energy.then_some(numbers.energy));
        }
        settings = Settings { every: None, digits: false, apart: false, ..settings };
        if self.rest {
            let start = [settings.q.clone(), vec![0.0; settings.q.len()]].concat();
            guess::begin_at(&mut settings, start);
        }
        Ok((system, settings))
    }

    /// Begins at a mode, where one is asked for.
    fn begin_at_mode(&self, system: &dyn System, settings: &mut Settings) -> Result<ModeStart, Error> {
        let Some(mode) = self.mode else { return Ok(ModeStart { rests: None, moves: None, period: self.period }) };
        let (y, time, rests, moves) = guess::mode(system, &settings.q, mode, self.energy)?;
        guess::begin_at(settings, y);
        if has_dependent_coordinates(system) {
            // Brought to the constraints.
            let n = system.len();
            (settings.held_q, settings.held_v, settings.guessed) = (vec![false; n], vec![false; n], true);
        }
        Ok(ModeStart {
            rests: Some(rests),
            moves: Some(moves),
            period: self.period.or(Some(time).filter(|_| !self.far_from_small)),
        })
    }

    /// Into how many pieces the map is cut.
    fn pieces(&self, by: By, acts: bool) -> usize {
        match by {
            By::After { count, .. } => count,
            By::Part(_) if acts => 1,
            By::Part(part) => self.legs.unwrap_or((LEGS / part).max(2)),
        }
    }

    /// How the motion is to close.
    fn closing(&self, description: &Description) -> Result<Closing, Error> {
        let mut closing = match &self.motion {
            Some((_, closes)) => Closing::of(closes, description),
            None => Closing::period(description),
        };
        if let Some(part) = self.part {
            closing.by = By::Part(part);
        }
        if let Some((event, count)) = &self.after {
            let event = event_index(description, event)?;
            let acts = |action: &Action| !matches!(action, Action::Record);
            if !description.events[event].actions.iter().any(acts) {
                return Err(NoOrbit::OnlyNoted { event: description.events[event].name.to_string() }.into());
            }
            closing.by = By::After { event, count: *count };
        }
        exchange(&mut closing, description, &self.images)?;
        for name in &self.mirrored {
            let place = closing.source(coordinate_index(description, name)?);
            closing.images[place].1 ^= true;
        }
        for name in &self.shifted {
            let place = closing.source(coordinate_index(description, name)?);
            closing.shifts.push(place);
        }
        for (name, turns) in &self.turned {
            closing.turn(coordinate_index(description, name)?, *turns);
        }
        Ok(closing)
    }
}

/// An error with what the run does that was described, where the search did not get nearer.
pub(super) fn with_returns(error: Error, scene: Option<(Box<dyn System>, Settings)>) -> Error {
    let Error::NoOrbit(why) = error else { return error };
    let NoOrbit::Stuck { residuals, start, .. } = *why else { return Error::NoOrbit(why) };
    let run = scene.and_then(|(mut system, settings)| {
        simulate(&mut *system, &Settings { every: None, digits: false, apart: false, ..settings }).ok()
    });
    let returns = run.map_or_else(Vec::new, |run| guess::returns(&run, &guess::sizes(&run), &[]));
    let near = |found: &guess::Return| NearReturn::new(found.t, found.period, found.distance);
    NoOrbit::Stuck { residuals, start, returns: returns.iter().map(near).collect() }.into()
}

/// The momenta that a run begins with along shifts that change nothing and that its closing allows, where they are conserved.
fn momenta(
    system: &mut dyn System,
    settings: &Settings,
    varies: &[usize],
    (closing, run): (&Closing, &Run),
    known: Vec<(String, DVector<f64>)>,
) -> Vec<(DVector<f64>, f64)> {
    let start = beginning(system, settings, run);
    crate::vary::put(system, &start);
    // What is mirrored or exchanged says itself what its momentum is.
    let shifted = |i: usize| closing.shifts.contains(&i) && closing.images[i] == (i, false);
    let allowed = |shift: &DVector<f64>| (0..shift.len()).all(|i| shift[i] == 0.0 || shifted(i));
    let known = known.into_iter().filter(|(_, shift)| allowed(shift)).collect();
    let conserving = structure::conserving(system, &start, varies, known).into_iter();
    let with_momentum = |(_, shift): (String, DVector<f64>)| {
        let (momentum, _) = structure::momentum(system, &start, &shift);
        (shift, momentum)
    };
    conserving.map(with_momentum).collect()
}

/// The state that a run begins with.
fn beginning(system: &dyn System, settings: &Settings, run: &Run) -> Side {
    let first = run.first();
    let y = [first.q, first.v].concat();
    Side { t: first.t, y, modes: system.modes().to_vec(), phase: settings.phase }
}

/// Refuses a closing that shifts what matters, or that the mechanism does not allow; shifts that change nothing, where there are any in
/// the closing.
fn may_close(
    system: &mut dyn System,
    settings: &Settings,
    (closing, run): (&Closing, &Run),
    later: f64,
) -> Result<Vec<(String, DVector<f64>)>, Error> {
    let n = system.len();
    let mut known = Vec::new();
    if !closing.shifts.is_empty() {
        let start = beginning(system, settings, run);
        let others = run.junctions.iter().map(|junction| junction.after.clone());
        known = structure::shifts(system, &std::iter::once(start).chain(others).collect::<Vec<_>>());
        let basis = structure::basis(&known.iter().map(|(_, shift)| shift.clone()).collect::<Vec<_>>(), n);
        for shift in &closing.shifts {
            let unit = DVector::from_fn(n, |i, _| f64::from(u8::from(i == *shift)));
            if (&unit - &basis * (basis.transpose() * &unit)).norm() > WITHIN {
                let end = closing.images[*shift].0;
                let coordinate = system.description().coordinates[end].name.to_string();
                return Err(NoOrbit::ShiftMatters { coordinate }.into());
            }
        }
    }
    if closing.is_plain() && closing.turns.iter().all(|turn| *turn == 0.0) {
        return Ok(known);
    }
    let states = states_of(run);
    if let Some(Difference { coordinate, here, there }) = closing.differs(system, &states, later) {
        return Err(NoOrbit::NoSymmetry { coordinate, here, there }.into());
    }
    match closing.event_differs(system, &states, later).filter(|_| later > 0.0) {
        Some(event) => {
            Err(NoOrbit::NoImageOfEvent { event: system.description().events[event].name.to_string() }.into())
        }
        None => Ok(known),
    }
}

fn event_index(description: &Description, name: &str) -> Result<usize, Error> {
    let found = description.events.iter().position(|event| event.name == name);
    found.ok_or_else(|| Error::unknown("event", name, description.events.iter().map(|event| &event.name)))
}

fn coordinate_index(description: &Description, name: &str) -> Result<usize, Error> {
    let coordinates = &description.coordinates;
    let found = coordinates.iter().position(|coordinate| coordinate.name == name);
    found.ok_or_else(|| Error::unknown("coordinate", name, coordinates.iter().map(|coordinate| &coordinate.name)))
}

/// Exchanges coordinates and phases: at the end the second is where the first was.
fn exchange(closing: &mut Closing, description: &Description, pairs: &[(String, String)]) -> Result<(), Error> {
    let phase = |name: &str| description.phases.iter().position(|phase| phase.name == name);
    let coordinate = |name: &str| description.coordinates.iter().position(|coordinate| coordinate.name == name);
    for (a, b) in pairs {
        let also = |name: &str| pairs.iter().any(|(other, _)| other == name);
        if let (Some(a), Some(k)) = (phase(a), phase(b)) {
            closing.phases[k] = a;
            if !also(b) {
                closing.phases[a] = k;
            }
            continue;
        }
        let (Some(i), Some(k)) = (coordinate(a), coordinate(b)) else {
            let name = if coordinate(a).is_some() { b } else { a };
            coordinate_index(description, name)?;
            continue;
        };
        closing.images[i].0 = k;
        if !also(b) {
            closing.images[k].0 = i;
        }
    }
    Ok(())
}
