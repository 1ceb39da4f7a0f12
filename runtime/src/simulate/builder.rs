//! A run, said word by word.

use super::by_hand::Stepping;
use super::{Settings, simulate};
use crate::constrain::KeptSpin;
use crate::error::Error;
use crate::events::CLOSURE_WIDTH;
use crate::mechanism::{Description, Enforcement, Method, Scene, Signal, Stabilisation, System};
use crate::run::Run;
use crate::trust::Warning;

/// A run that is being described: what is not said comes from the model file's first scene.
///
/// What a scene `set`s holds for parameters that still have the file's value; a parameter that was given
/// another value keeps it, as `--set` does on the command line.
#[derive(Clone, Debug)]
#[must_use = "nothing happens before `run`"]
pub struct Simulation<S: System> {
    system: S,
    /// The parameters before any scene set one.
    given: Vec<f64>,
    settings: Settings,
    origin: Origin,
    /// The first thing that was wrong; reported by `run`.
    wrong: Option<Error>,
}

/// A system, what was said of its run, and where its start comes from.
pub(crate) type Described = (Box<dyn System>, Settings, Origin);

/// Where a start comes from, and how it changes with parameters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origin {
    /// The scene; `None`: it was given by numbers.
    pub scene: Option<usize>,
    /// Which of [q; q'] have other values than the scene's.
    pub given: Vec<bool>,
    /// Whether the tolerance is another than the scene's.
    pub tolerance: bool,
}

impl<S: System> Simulation<S> {
    /// A run of the first scene.
    pub fn new(mut system: S) -> Self {
        let given = system.parameters();
        set_scene(&mut system, &given, 0);
        let settings = Settings::of_scene(&system, 0);
        let origin = Origin { scene: Some(0), given: vec![false; 2 * system.len()], tolerance: false };
        Simulation { system, given, settings, origin, wrong: None }
    }

    /// Another scene of the model file.
    pub fn scene(self, name: &str) -> Self {
        let scenes = &self.system.description().scenes;
        match scenes.iter().position(|scene| scene == name) {
            Some(index) => self.at_scene(index),
            None => {
                let error = Error::unknown("scene", name, scenes.iter());
                self.fail(error)
            }
        }
    }

    /// A run of a motion of the model file, and its place.
    pub(crate) fn of_motion(self, name: &str) -> Result<(Self, usize), Error> {
        let motions = self.system.motions();
        let Some(motion) = motions.iter().position(|motion| motion.name == name) else {
            return Err(Error::unknown("motion", name, motions.iter().map(|motion| &motion.name)));
        };
        let index = self.system.description().scenes.len() + motion;
        Ok((self.at_scene(index), motion))
    }

    /// At the scene of this place, those of motions after the file's.
    fn at_scene(mut self, index: usize) -> Self {
        let scene = set_scene(&mut self.system, &self.given, index);
        self.settings.memory = Some(self.system.scene_memory(index));
        let given = vec![false; 2 * self.system.len()];
        let origin = Origin { scene: Some(index), given, tolerance: self.origin.tolerance };
        Simulation { origin, ..self.from(&scene) }
    }

    /// Start, end, tolerance and spacing of a scene.
    pub fn from(mut self, scene: &Scene) -> Self {
        let spins = KeptSpin::of_scene(scene);
        let Scene { q, v, held_q, held_v, start_conditions, guessed, phase, until, tolerance, every, .. } =
            scene.clone();
        self.settings = Settings {
            q,
            v,
            held_q,
            held_v,
            spins,
            start_conditions,
            guessed,
            phase,
            until,
            tolerance,
            every,
            ..self.settings
        };
        self.origin = Origin { tolerance: self.origin.tolerance, ..Origin::default() };
        self
    }

    /// Generalized coordinates and their rates at the start, SI; where there are constraints all of them are held.  States of first order are
    /// the last of the rates, in file order, and each has a number among the coordinates that means nothing.
    pub fn start(mut self, q: &[f64], v: &[f64]) -> Self {
        self.settings.q = q.to_vec();
        self.settings.v = v.to_vec();
        (self.settings.held_q, self.settings.held_v, self.settings.spins) = (Vec::new(), Vec::new(), Vec::new());
        self.origin = Origin { tolerance: self.origin.tolerance, ..Origin::default() };
        self
    }

    /// One coordinate, one rate (`theta'`), one state of first order or one held value at the start, SI.
    pub fn starting(mut self, name: &str, value: f64) -> Self {
        if let Some(place) = self.system.sampling().place_of(name) {
            let memory = self.settings.memory.get_or_insert_with(|| self.system.scene_memory(0));
            memory.get_mut(place).into_iter().for_each(|held| *held = value);
            return self;
        }
        let description = self.system.description();
        // Lists of another length are refused where the run begins.
        let whole = [&self.settings.q, &self.settings.v].map(Vec::len) == [self.system.len(); 2];
        match description.place_of(name).filter(|_| whole) {
            Some(place) => {
                self.settings.start_at(place, value);
                self.origin.given.get_mut(place).into_iter().for_each(|given| *given = true);
                self
            }
            None => {
                let error = Error::unknown("coordinate", name, description.start_names());
                self.fail(error)
            }
        }
    }

    /// Replaces an input by a function of time, which returns (u, u', u'').
    ///
    /// Its jumps and sharp turns are looked for by a scan of u and u', since no expression tells where they are; features
    /// narrower than 2·10⁻⁴ of the run may be missed, which the run's warnings say unless a longest step is given.
    pub fn input(mut self, name: &str, signal: Signal) -> Self {
        let inputs = &self.system.description().inputs;
        match inputs.iter().position(|input| input == name) {
            Some(index) => {
                self.system.set_input(index, signal);
                self
            }
            None => {
                let error = Error::unknown("input", name, inputs.iter());
                self.fail(error)
            }
        }
    }

    /// Takes the accelerations from a system of momentum balances of the model file instead of Lagrange's equations,
    /// and reactions that are outputs from its own solution; `"lagrange"` goes back.
    pub fn derivation(mut self, name: &str) -> Self {
        match derivation(self.system.description(), name) {
            Ok(index) => {
                self.system.set_derivation(index);
                self
            }
            Err(error) => self.fail(error),
        }
    }

    /// Where the run ends, s.
    pub fn until(mut self, t: f64) -> Self {
        self.settings.until = t;
        self
    }

    /// Relative tolerance; see [`Settings::tolerance`].
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.settings.tolerance = tolerance;
        self.origin.tolerance = true;
        self
    }

    /// Spacing of reported states, s.
    pub fn every(mut self, spacing: f64) -> Self {
        self.settings.every = Some(spacing);
        self
    }

    /// The method of integration.
    pub fn method(mut self, method: Method) -> Self {
        self.settings.method = method;
        self
    }

    /// How constraints are enforced, instead of by multipliers.
    pub fn enforcement(mut self, enforcement: Enforcement) -> Self {
        self.settings.enforcement = enforcement;
        self
    }

    /// What is done about errors by which the motion leaves its constraints, instead of projecting.
    pub fn stabilisation(mut self, stabilisation: Stabilisation) -> Self {
        self.settings.stabilisation = stabilisation;
        self
    }

    /// A fixed step, s.
    pub fn step(mut self, h: f64) -> Self {
        self.settings.step = Some(h);
        self
    }

    /// The longest step the method may choose, s.
    pub fn longest_step(mut self, h: f64) -> Self {
        self.settings.longest_step = Some(h);
        self
    }

    /// Runs a second time, less accurately, and tells how many digits hold: [`Run::digits`](crate::Run::digits).
    pub fn digits(mut self) -> Self {
        self.settings.digits = true;
        self
    }

    /// Integrates decoupled subsystems with one common step size: see [`Settings::apart`].
    pub fn together(mut self) -> Self {
        self.settings.apart = false;
        self
    }

    /// How many steps a run may take.
    pub fn max_steps(mut self, steps: u64) -> Self {
        self.settings.max_steps = steps;
        self
    }

    /// Lets an event do nothing: it is not located, and not recorded.
    pub fn ignore(mut self, event: &str) -> Self {
        match self.settings.ignore(self.system.description(), event) {
            Ok(()) => self,
            Err(error) => self.fail(error),
        }
    }

    /// Changes settings that have no word of their own.
    pub fn with(mut self, change: impl FnOnce(&mut Settings)) -> Self {
        change(&mut self.settings);
        self
    }

    /// Runs.
    ///
    /// # Errors
    /// The first thing in the description that has no meaning; or see [`simulate`].
    pub fn run(mut self) -> Result<Run, Error> {
        match self.wrong {
            Some(error) => Err(error),
            None => {
                let mut run = simulate(&mut self.system, &self.settings)?;
                let inputs = self.system.description().inputs.iter().enumerate();
                let closures = inputs.filter(|(index, _)| self.system.signal(*index).is_some());
                for (_, input) in closures.filter(|_| self.settings.longest_step.is_none()) {
                    let width = CLOSURE_WIDTH * (self.settings.until - self.settings.from);
                    run.warnings.push(Warning::InputScanned { input: input.to_string(), width });
                }
                Ok(run)
            }
        }
    }

    /// Begins a run that the caller moves on step by step.
    ///
    /// # Errors
    /// The first thing in the description that has no meaning.
    pub fn by_hand(self) -> Result<Stepping<S>, Error> {
        match self.wrong {
            Some(error) => Err(error),
            None => Stepping::new(self.system, self.settings),
        }
    }

    /// The system, what was said of its run, and where its start comes from.
    ///
    /// # Errors
    /// The first thing in the description that has no meaning.
    pub(crate) fn described(self) -> Result<(S, Settings, Origin), Error> {
        match self.wrong {
            Some(error) => Err(error),
            None => Ok((self.system, self.settings, self.origin)),
        }
    }

    /// The system and what was said of its run, unless something in it has no meaning.
    #[cfg(feature = "ensemble")]
    pub(crate) fn parts(&self) -> Option<(&S, &Settings)> {
        self.wrong.is_none().then_some((&self.system, &self.settings))
    }

    fn fail(mut self, error: Error) -> Self {
        self.wrong.get_or_insert(error);
        self
    }
}

/// The system of balances of this name; `None` for `lagrange`.
pub(crate) fn derivation(mechanism: &Description, name: &str) -> Result<Option<usize>, Error> {
    let found = mechanism.balances.iter().position(|system| system.name == name);
    if found.is_some() || name == LAGRANGE { Ok(found) } else { Err(no_balances(mechanism, name)) }
}

/// That no system of balances has this name.
pub(super) fn no_balances(mechanism: &Description, name: &str) -> Error {
    Error::unknown("system of balances", name, mechanism.balances.iter().map(|system| &system.name))
}

/// The name of the derivation that every mechanism has.
pub(crate) const LAGRANGE: &str = "lagrange";

/// Sets what a scene sets, where the file's value was given, in place of what another scene set; returns the scene.
fn set_scene<S: System>(system: &mut S, given: &[f64], index: usize) -> Scene {
    let now = system.parameters();
    for (parameter, value) in given.iter().enumerate() {
        if now.get(parameter) != Some(value) {
            system.set_parameter(parameter, *value);
        }
    }
    for (parameter, value) in system.scene_parameters(index) {
        let default = system.description().parameters.get(parameter).map(|parameter| parameter.default);
        if default == given.get(parameter).copied() {
            system.set_parameter(parameter, value);
        }
    }
    system.scene(index)
}
