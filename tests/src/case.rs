//! A model of the library, made ready to run.

use dalembert::mechanism::{At, Balances, Dynamic, Interpreted, Mechanism, System};
use dalembert::{Error, Run, Settings, State, simulate};
use dalembert_symbolic::lower::compile;

use crate::reference::{Reference, States};

/// A model with a scene, whose parameters, start and settings can be changed.
pub struct Case {
    /// The mechanism.
    pub system: Box<dyn System>,
    /// How to run it.
    pub settings: Settings,
    scene: usize,
}

impl Case {
    /// A model of the library by name, with its default scene.
    pub fn new(name: &str) -> Self {
        let entry = dalembert_models::MODELS.iter().find(|entry| entry.name == name);
        let system = (entry.unwrap_or_else(|| panic!("no model `{name}`")).compiled.expect("its code"))();
        Self::from_system(system)
    }

    /// A model file that is written out, interpreted.
    ///
    /// # Panics
    /// If it does not compile.
    #[track_caller]
    pub fn written(text: &str) -> Self {
        let program = compile(text, &[]).unwrap_or_else(|problems| {
            let told: Vec<&str> = problems.iter().map(|problem| problem.message.as_str()).collect();
            panic!("{text}\n{}", told.join("\n"))
        });
        Self::from_system(Box::new(Interpreted::new(program, text)))
    }

    /// Any system with its default scene.
    pub fn from_system(system: Box<dyn System>) -> Self {
        let settings = Settings::new(&system.scene(0));
        Case { system, settings, scene: 0 }
    }

    /// With another scene; what it sets is set.
    pub fn scene(mut self, name: &str) -> Self {
        let scenes = &self.system.description().scenes;
        self.scene = scenes.iter().position(|s| s == name).unwrap_or_else(|| panic!("no scene `{name}`"));
        for (index, value) in self.system.scene_parameters(self.scene) {
            self.system.set_parameter(index, value);
        }
        self.settings = Settings::new(&self.system.scene(self.scene));
        self
    }

    /// With another value of a parameter; the start and all settings are the scene's again.
    pub fn set(mut self, name: &str, value: f64) -> Self {
        let parameters = &self.system.description().parameters;
        let index = parameters.iter().position(|p| p.name == name).unwrap_or_else(|| panic!("no parameter `{name}`"));
        self.system.set_parameter(index, value);
        self.settings = Settings::new(&self.system.scene(self.scene));
        self
    }

    /// From another value of a coordinate, or of a rate (`theta'`).
    pub fn start(mut self, name: &str, value: f64) -> Self {
        let (list, coordinate) = match name.strip_suffix('\'') {
            Some(coordinate) => (&mut self.settings.v, coordinate),
            None => (&mut self.settings.q, name),
        };
        let coordinates = &self.system.description().coordinates;
        let index = coordinates.iter().position(|c| c.name == coordinate);
        list[index.unwrap_or_else(|| panic!("no coordinate `{coordinate}`"))] = value;
        self
    }

    /// With accelerations from a system of balances.
    pub fn by(mut self, name: &str) -> Self {
        let systems = &self.system.description().balances;
        let index = systems.iter().position(|s| s.name == name).unwrap_or_else(|| panic!("no balances `{name}`"));
        self.system.set_derivation(Some(index));
        self
    }

    /// The unknowns of a system of balances at a state, by name.
    pub fn unknown(&self, balances: &str, unknown: &str, (t, q, v): (f64, &[f64], &[f64])) -> f64 {
        let systems = &self.system.description().balances;
        let index = systems.iter().position(|s| s.name == balances).unwrap_or_else(|| panic!("no `{balances}`"));
        let place = systems[index].unknowns.iter().position(|u| u == unknown);
        let mut system = Balances::new(&*self.system, index).expect("a system of balances");
        let mut values = vec![0.0; system.size()];
        system.evaluate(&*self.system, At::new(t, q, v));
        system.solve(&mut values).expect("independent balances");
        values[place.unwrap_or_else(|| panic!("`{balances}` has no `{unknown}`"))]
    }

    /// Until another time, s.
    pub fn until(mut self, t: f64) -> Self {
        self.settings.until = t;
        self
    }

    /// At another tolerance.
    pub fn tolerance(mut self, tolerance: f64) -> Self {
        self.settings.tolerance = tolerance;
        self
    }

    /// The run, or why it failed.
    pub fn try_run(&mut self) -> Result<Run, Error> {
        simulate(&mut *self.system, &self.settings)
    }

    /// The run.
    ///
    /// # Panics
    /// If it fails.
    pub fn run(&mut self) -> Run {
        let name = self.system.description().name.clone();
        self.try_run().unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The state at a time, with its outputs.
    pub fn state_at(&mut self, t: f64) -> State {
        let until = std::mem::replace(&mut self.settings.until, t);
        let run = self.run();
        self.settings.until = until;
        run.last()
    }

    /// The accelerations at the start.
    pub fn accelerations(&self) -> Vec<f64> {
        let mut a = vec![0.0; self.system.len()];
        let Settings { from, q, v, .. } = &self.settings;
        self.system.accelerations(At::new(*from, q, v), &mut a).expect("a mass matrix that can be inverted");
        a
    }

    /// Compares the motion with the states of a reference.  Names that the model does not have are looked for
    /// by the rules of `our_name`; those in `skip` are not compared.
    ///
    /// # Panics
    /// If a number is off by more than `tolerance` says for its time, or if a name is not found.
    pub fn compare(&mut self, reference: &Reference, skip: &[&str], tolerance: impl Fn(f64) -> f64) {
        self.compare_states(&reference.states(), skip, tolerance);
    }

    /// Compares the motion with these states, as [`Case::compare`] does.
    ///
    /// # Panics
    /// As [`Case::compare`].
    pub fn compare_states(&mut self, states: &States, skip: &[&str], tolerance: impl Fn(f64) -> f64) {
        let model = self.system.description().name.clone();
        for (t, values) in states {
            let (t, state) = (*t, self.state_at(*t));
            for (name, expected) in values.iter().filter(|(name, _)| !skip.contains(&name.as_str())) {
                let found = our_name(&state, name).unwrap_or_else(|| panic!("{model} has no `{name}`: {state:?}"));
                let error = (state[found.as_str()] - expected).abs();
                assert!(
                    error < tolerance(t),
                    "{model} at t = {t}: {found} = {} is off by {error:e}",
                    state[found.as_str()]
                );
            }
        }
    }
}

/// What a quantity of the reference files is called here: `theta_dot` is `theta'`, `vx` is `x'`, `x1` is `x[1]`
/// where equal bodies are a family, `tip_x` is the component `tip.x` of an output.
fn our_name(state: &State, name: &str) -> Option<String> {
    let plain = match name.strip_suffix("_dot") {
        Some(coordinate) => format!("{coordinate}'"),
        None => name.to_owned(),
    };
    let member = |name: &str| {
        let digits = name.find(|c: char| c.is_ascii_digit())?;
        let (family, index) = name.split_at(digits);
        Some(format!("{family}[{index}]"))
    };
    let rate = name.strip_prefix('v').map(|coordinate| match coordinate.parse::<u32>() {
        Ok(index) => format!("x[{index}]'"),
        Err(_) => format!("{coordinate}'"),
    });
    let member_rate = name.strip_prefix('v').and_then(member).map(|member| format!("{member}'"));
    let component = name.rsplit_once('_').map(|(vector, axis)| format!("{vector}.{axis}"));
    [Some(plain), rate, member(name), member_rate, component]
        .into_iter()
        .flatten()
        .find(|name| state.get(name).is_some())
}

/// A mechanism of static size with its default parameters, as a system.
pub fn erase<M, const N: usize, const C: usize>() -> Box<dyn System>
where
    M: Mechanism<N, C> + Default + 'static,
{
    Box::new(Dynamic::new(M::default()))
}
