//! From a scene and the options that change it to a system and settings.

use std::sync::Arc;

use clap::ArgMatches;
use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::model::{Model, Sets, looks_like_degrees};
use dalembert_symbolic::{diagnose, file, gate, lower};

use super::arguments::MOTION;
use super::load::{Loaded, pairs, refuse_model_again};
use super::plotted::filled_parts;
use super::{Context, Problem, outputs, value_files};
use crate::mechanism::{Interpreted, Method, System};
use crate::simulate::{Described, Origin};
use crate::{NoSlopes, Settings};

/// Applies `--scene`, `--params`, `--set`, `--state`, `--start`, `--input`, `--until`, `--tolerance`, `--every`, `--step`,
/// `--max-steps` and `--ignore`.
pub fn set_up(loaded: &mut Loaded, options: &ArgMatches) -> Result<Settings, Problem> {
    let scene = scene_of(loaded, options)?;
    set_up_at(loaded, options, scene)
}

/// The same for another scene than that of `--scene`.
pub fn set_up_scene(loaded: &mut Loaded, options: &ArgMatches, scene: Option<&str>) -> Result<Settings, Problem> {
    let scene = scene_index(loaded, scene)?;
    set_up_at(loaded, options, scene)
}

fn set_up_at(loaded: &mut Loaded, options: &ArgMatches, scene: usize) -> Result<Settings, Problem> {
    let (scene, mut reader) = choose_scene(loaded, options, scene)?;
    let changes = Changes::read(loaded, &mut reader, options)?;
    let mut settings = Settings::of_scene(&*loaded.system, scene);
    if let Some(path) = options.try_get_one::<String>("state").ok().flatten() {
        value_files::start(loaded, &mut reader, path, &mut settings)?;
    }
    loaded.warnings.append(&mut reader.notes);
    let mut settings = changes.of(settings);
    ignore(loaded, options, &mut settings)?;
    Ok(settings)
}

/// Applies `--ignore`.
fn ignore(loaded: &Loaded, options: &ArgMatches, settings: &mut Settings) -> Result<(), Problem> {
    let description = loaded.system.description();
    let texts = options.try_get_many::<String>("ignore").ok().flatten().into_iter().flatten();
    for name in texts.flat_map(|text| filled_parts(text)) {
        let known = || description.events.iter().map(|event| event.name.as_ref());
        settings.ignore(description, name).map_err(|_| unknown("event", name, known()))?;
    }
    Ok(())
}

/// What options change of a scene.
pub struct Changes {
    /// Places in [q; q'] with values at the start.
    start: Vec<(usize, f64)>,
    /// Held values at the start, by their places.
    memory: Vec<(usize, f64)>,
    until: Option<f64>,
    tolerance: Option<f64>,
    every: Option<f64>,
    step: Option<f64>,
    max_steps: Option<u64>,
}

impl Changes {
    /// Reads `--start`, `--until`, `--tolerance`, `--every`, `--step` and `--max-steps`; not every command has all of them.
    pub fn read(loaded: &Loaded, reader: &mut Reader, options: &ArgMatches) -> Result<Changes, Problem> {
        let mut start = [vec![f64::NAN; loaded.system.len()], vec![f64::NAN; loaded.system.len()]];
        let [q, v] = &mut start;
        reader.states(loaded, options, "start", q, v)?;
        let start = start.concat().into_iter().enumerate().filter(|(_, value)| !value.is_nan()).collect();
        let memory = reader.memory(loaded, options, "start")?;
        let mut option = |name: &str| -> Result<Option<f64>, Problem> {
            let sets = if name == "tolerance" { Sets::Number } else { Sets::Time };
            let given = options.try_get_one::<String>(name).ok().flatten();
            given.map(|text| reader.value(loaded, name, sets, text)).transpose()
        };
        let (until, tolerance) = (option("until")?, option("tolerance")?);
        let (every, step) = (option("every")?, option("step")?);
        let max_steps = options.try_get_one::<u64>("max-steps").ok().flatten().copied();
        Ok(Changes { start, memory, until, tolerance, every, step, max_steps })
    }

    /// These settings with the changes.
    pub fn of(&self, mut settings: Settings) -> Settings {
        for (place, value) in &self.start {
            settings.start_at(*place, *value);
        }
        for (place, value) in &self.memory {
            settings.memory.iter_mut().for_each(|memory| memory[*place] = *value);
        }
        settings.until = self.until.unwrap_or(settings.until);
        settings.tolerance = self.tolerance.unwrap_or(settings.tolerance);
        settings.every = self.every.or(settings.every);
        settings.step = self.step;
        settings.max_steps = self.max_steps.unwrap_or(settings.max_steps);
        settings
    }
}

/// Applies `--scene`, `--params`, `--set` and `--input`; the scene's index, and a reader for the other options.
pub fn choose(loaded: &mut Loaded, options: &ArgMatches) -> Result<(usize, Reader), Problem> {
    let scene = scene_of(loaded, options)?;
    choose_scene(loaded, options, scene)
}

fn choose_scene(loaded: &mut Loaded, options: &ArgMatches, scene: usize) -> Result<(usize, Reader), Problem> {
    for (index, value) in loaded.system.scene_parameters(scene) {
        loaded.system.set_parameter(index, value);
    }
    let mut reader = Reader::default();
    if let Some(path) = options.get_one::<String>("params") {
        refuse_model_again(loaded, "params", path)?;
        value_files::parameters(loaded, &mut reader, path)?;
    }
    for (name, text) in pairs(options, "set")? {
        let index = parameter_to_set(loaded, options, &name)?;
        let value = reader.value(loaded, "set", Sets::Parameter(index), &text)?;
        loaded.system.set_parameter(index, value);
    }
    for (name, text) in pairs(options, "input")? {
        set_input(loaded, &mut reader, &name, &text)?;
    }
    Ok((scene, reader))
}

/// Reads expressions of the model language; the model is resolved when the first one comes.
#[derive(Default)]
pub struct Reader {
    model: Option<Model>,
    /// What the user should know of values that were read.
    pub notes: Vec<String>,
}

impl Reader {
    /// The model with its names.
    pub fn model(&mut self, loaded: &Loaded) -> Result<&mut Model, Problem> {
        if self.model.is_none() {
            self.model = Some(loaded.model()?);
        }
        self.model.as_mut().ok_or_else(|| Problem::usage("the model cannot be read again"))
    }

    /// Applies an option that may be given several times, `NAME=VALUE` or `NAME'=VALUE`.
    pub fn states(
        &mut self,
        loaded: &Loaded,
        options: &ArgMatches,
        option: &str,
        q: &mut [f64],
        v: &mut [f64],
    ) -> Result<(), Problem> {
        for (name, text) in pairs(options, option)? {
            if loaded.system.sampling().place_of(&name).is_some() {
                continue;
            }
            match place_in_state(loaded, &name)? {
                Place::Coordinate(index) => {
                    q[index] = self.value(loaded, option, Sets::Coordinate(index), &text)?;
                }
                Place::Speed(index) => v[index] = self.value(loaded, option, Sets::Speed(index), &text)?,
            }
        }
        Ok(())
    }

    /// Held values of such an option, by their places.
    pub fn memory(
        &mut self,
        loaded: &Loaded,
        options: &ArgMatches,
        option: &str,
    ) -> Result<Vec<(usize, f64)>, Problem> {
        let mut found = Vec::new();
        for (name, text) in pairs(options, option)? {
            if let Some(place) = loaded.system.sampling().place_of(&name) {
                found.push((place, self.value(loaded, option, Sets::Memory(place), &text)?));
            }
        }
        Ok(found)
    }

    /// The number that an option's value stands for.
    pub fn value(&mut self, loaded: &Loaded, option: &str, sets: Sets, text: &str) -> Result<f64, Problem> {
        self.value_at(loaded, &format!("--{option}"), sets, text)
    }

    /// The number that a value stands for which stands at this place, a file's or an option's.
    pub fn value_at(&mut self, loaded: &Loaded, place: &str, sets: Sets, text: &str) -> Result<f64, Problem> {
        if let Ok(number) = text.trim().parse::<f64>()
            && number.is_finite()
        {
            self.degrees(loaded, place, sets, text.trim());
            if let Sets::Parameter(parameter) = sets {
                self.whole_seed(loaded, place, parameter, number)?;
                // The model is read for it where it may be refused.
                let possible = if number < 0.0 { self.model(loaded)?.possible_mass(parameter, number) } else { Ok(()) };
                possible.map_err(|problems| Problem::Usage(file::render(place, text.trim(), &problems)))?;
            }
            return Ok(number);
        }
        let parameters = loaded.system.parameters();
        let found = self.model(loaded)?.constant(text, sets, &parameters);
        found.map_err(|problems| Problem::Usage(file::render(place, text, &problems)))
    }

    /// Refuses a value of a parameter that is a seed and no whole number.
    pub fn whole_seed(&mut self, loaded: &Loaded, place: &str, parameter: usize, value: f64) -> Result<(), Problem> {
        let seeds = loaded.system.held_noise();
        if !seeds.iter().any(|noise| noise.seed == Some(parameter as u32)) {
            return Ok(());
        }
        let found = self.model(loaded)?.whole_seed(parameter, value);
        found.map_err(|problems| Problem::Usage(file::render(place, &value.to_string(), &problems)))
    }

    /// Notes where a bare number for an angle looks like degrees.
    fn degrees(&mut self, loaded: &Loaded, place: &str, sets: Sets, text: &str) {
        let description = loaded.system.description();
        let (name, unit) = match sets {
            Sets::Coordinate(index) => (&description.coordinates[index].name, &description.coordinates[index].unit),
            Sets::Parameter(index) => (&description.parameters[index].name, &description.parameters[index].unit),
            _ => return,
        };
        if unit == "rad" && looks_like_degrees(text) {
            let note = format!(
                "{place}: `{name}` is in radians, and `{text}` looks like degrees; write `{text} deg`, or `{text} rad` where that is meant"
            );
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}

/// What a value sets that an output of this name has; of a coordinate or a rate, that.
pub fn like_output(loaded: &Loaded, name: &str) -> Result<Sets, Problem> {
    let outputs = &loaded.system.description().outputs;
    let of = name.split('.').next().unwrap_or(name);
    if let Some(place) = outputs.iter().position(|output| output.name == name || output.name == of) {
        return Ok(Sets::Output(place));
    }
    Ok(match place_in_state(loaded, name)? {
        Place::Coordinate(index) => Sets::Coordinate(index),
        Place::Speed(index) => Sets::Speed(index),
    })
}

/// A bare number with the unit that stands once for several: in `20..40 deg` and `10, 20, 30 deg` at the last.
pub fn with_unit_of(text: &str, last: &str) -> String {
    let (text, last) = (text.trim(), last.trim());
    let ends = last.char_indices().map(|(end, _)| end).chain([last.len()]);
    let number = ends.rev().find(|end| last[..*end].parse::<f64>().is_ok());
    let unit = number.map_or("", |end| last[end..].trim_start());
    // No operator: what follows the number is its unit.
    let is_unit = unit.starts_with(|c: char| c.is_alphabetic() || c.is_ascii_digit());
    if is_unit && text.parse::<f64>().is_ok() { format!("{text} {unit}") } else { text.to_owned() }
}

fn in_option(option: &str, text: &str, problems: &[diagnose::Problem]) -> Problem {
    Problem::Usage(file::render(&format!("--{option}"), text, problems))
}

fn set_input(loaded: &mut Loaded, reader: &mut Reader, name: &str, text: &str) -> Result<(), Problem> {
    let known = &loaded.system.description().inputs;
    let Some(index) = known.iter().position(|input| input == name) else {
        return Err(unknown("input", name, known.iter().map(AsRef::as_ref)));
    };
    let parameters = loaded.system.parameters();
    let model = reader.model(loaded)?;
    let signal = model.signal(text, index).map_err(|problems| in_option("input", text, &problems))?;
    if model.is_local(&signal) {
        // Its discontinuities and narrow features are followed as those of the file's own inputs.
        model.inputs[index].signal = signal;
        let judged = gate::judged(model.clone()).and_then(lower::lower);
        let program = judged.map_err(|problems| in_option("input", text, &problems))?;
        let mut system = Interpreted::new(program, &loaded.source);
        for (place, value) in parameters.into_iter().enumerate() {
            system.set_parameter(place, value);
        }
        loaded.system = Box::new(system);
        return Ok(());
    }
    let tape = Tape::new(&model.graph, &signal);
    loaded.system.set_input(
        index,
        Arc::new(move |t| {
            let mut u = [0.0; 3];
            let value = |symbol: Symbol| match symbol {
                Symbol::Time => t,
                Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(f64::NAN),
                _ => f64::NAN,
            };
            tape.run(value, &mut Vec::new(), &mut u);
            u
        }),
    );
    Ok(())
}

/// Where the start comes from that the options say.
pub fn origin(loaded: &Loaded, options: &ArgMatches) -> Result<Origin, Problem> {
    let n = loaded.system.len();
    let stated = options.get_one::<String>("state").is_some();
    let scene = scene_of(loaded, options)?;
    let mut given = vec![stated; 2 * n];
    for (name, _) in pairs(options, "start")? {
        if loaded.system.sampling().place_of(&name).is_some() {
            continue;
        }
        given[match place_in_state(loaded, &name)? {
            Place::Coordinate(index) => index,
            Place::Speed(index) => n + index,
        }] = true;
    }
    let tolerance = options.try_get_one::<String>("tolerance").ok().flatten().is_some();
    Ok(Origin { scene: Some(scene).filter(|_| !stated), given, tolerance })
}

/// What a search begins with: the model, and the run that the options describe; none of the files of these options may be another's.
pub fn for_search(context: Context<'_>, options: &ArgMatches, files: &[&str]) -> Result<(Loaded, Described), Problem> {
    let mut loaded = Loaded::find(context, options)?;
    outputs::check(options, files, &loaded.path)?;
    let mut settings = set_up(&mut loaded, options)?;
    settings.interruption = context.interruption().into();
    set_method(&mut settings, options)?;
    if settings.method == Method::Moreau {
        return Err(Problem::usage(NoSlopes::StepsOver));
    }
    loaded.tell_warnings();
    let origin = origin(&loaded, options)?;
    let system = loaded.system.boxed_clone();
    Ok((loaded, (system, settings, origin)))
}

/// With `--method`.
pub fn set_method(settings: &mut Settings, options: &ArgMatches) -> Result<(), Problem> {
    if let Some(method) = options.get_one::<String>("method") {
        settings.method = method.parse().map_err(Problem::usage)?;
    }
    Ok(())
}

/// The scene of `--scene`, or that of the motion of `--motion`.
pub fn scene_of(loaded: &Loaded, options: &ArgMatches) -> Result<usize, Problem> {
    match motion_index(loaded, options)? {
        Some(motion) => Ok(loaded.system.description().scenes.len() + motion),
        None => scene_index(loaded, options.get_one::<String>("scene").map(String::as_str)),
    }
}

/// The motion of `--motion`.
pub fn motion_index(loaded: &Loaded, options: &ArgMatches) -> Result<Option<usize>, Problem> {
    let Some(name) = options.try_get_one::<String>(MOTION).ok().flatten() else { return Ok(None) };
    let motions = loaded.system.motions();
    if motions.is_empty() {
        return Err(Problem::usage(format!("`{}` has no `motions`", loaded.name)));
    }
    let found = motions.iter().position(|motion| motion.name == *name);
    found.map(Some).ok_or_else(|| unknown("motion", name, motions.iter().map(|motion| motion.name.as_ref())))
}

pub fn scene_index(loaded: &Loaded, name: Option<&str>) -> Result<usize, Problem> {
    let Some(name) = name else { return Ok(0) };
    let scenes = &loaded.system.description().scenes;
    let found = scenes.iter().position(|scene| scene == name);
    found.ok_or_else(|| unknown("scene", name, scenes.iter().map(AsRef::as_ref)))
}

/// The index of a free parameter that `--set` names; of a coordinate or a speed it says which option sets it.
fn parameter_to_set(loaded: &Loaded, options: &ArgMatches, name: &str) -> Result<usize, Problem> {
    let found = parameter_index(loaded, name);
    let (coordinate, kind) = match name.strip_suffix('\'') {
        Some(coordinate) => (coordinate, "a speed"),
        None => (name, "a coordinate"),
    };
    let description = loaded.system.description();
    let moves = description.coordinates.iter().any(|known| known.name == coordinate);
    let (moves, kind) = match description.coordinates.iter().any(|known| known.state() == Some(name)) {
        true => (true, "a state"),
        false => (moves, kind),
    };
    // What looks for a rest has `--at` and the flag `--here`. Of an option that is not given clap knows in debug builds only whether there is one.
    let option = if options.ids().any(|id| id == "here") { "at" } else { "start" };
    match found {
        Err(_) if moves => Err(Problem::usage(format!(
            "`{name}` is {kind}, and --set is for parameters; write --{option} \"{name}=…\""
        ))),
        found => found,
    }
}

/// The index of a free parameter, by its expanded name.
pub fn parameter_index(loaded: &Loaded, name: &str) -> Result<usize, Problem> {
    let description = loaded.system.description();
    if let Some(index) = description.parameters.iter().position(|p| p.name == name) {
        return Ok(index);
    }
    let free: Vec<&str> = description.parameters.iter().map(|p| p.name.as_ref()).collect();
    if description.derived.iter().any(|d| d == name) {
        return Err(Problem::usage(format!(
            "`{name}` is computed from other parameters and cannot be set; the free ones are {}",
            free.join(", ")
        )));
    }
    Err(unknown("parameter", name, free.into_iter()))
}

/// The index of a coordinate, by its expanded name.
pub fn coordinate_index(loaded: &Loaded, name: &str) -> Result<usize, Problem> {
    let coordinates = &loaded.system.description().coordinates;
    let found = coordinates.iter().position(|c| c.name == name);
    let known = coordinates.iter().filter(|c| c.state().is_none()).map(|c| c.name.as_ref());
    found.ok_or_else(|| unknown("coordinate", name, known))
}

/// Where a name stands in a state.
pub enum Place {
    /// Among the coordinates.
    Coordinate(usize),
    /// Among the speeds: a rate, or a state of first order as the speed of its hidden coordinate.
    Speed(usize),
}

/// The place of a coordinate, a rate or a state of first order.
pub fn place_in_state(loaded: &Loaded, name: &str) -> Result<Place, Problem> {
    let description = loaded.system.description();
    let n = description.coordinates.len();
    match description.place_of(name) {
        Some(place) if place < n => Ok(Place::Coordinate(place)),
        Some(place) => Ok(Place::Speed(place - n)),
        None => {
            let known = description.start_names();
            let name = name.strip_suffix('\'').unwrap_or(name);
            if description.coordinates.iter().any(|c| c.state() == Some(name)) {
                return Err(Problem::usage(format!(
                    "`{name}'` is the rate of a state of first order, which the model gives; write `{name}=…`"
                )));
            }
            let rate =
                diagnose::rate_meant(name, known.iter().map(String::as_str).filter(|name| !name.ends_with('\'')));
            if let Some(hint) = rate {
                return Err(Problem::usage(format!("no coordinate is called `{name}`; {hint}")));
            }
            Err(unknown("coordinate", name, known.iter().map(String::as_str)))
        }
    }
}

/// No such name, and which there are.
pub fn unknown<'a>(kind: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Problem {
    let known: Vec<&str> = known.collect();
    let hint = diagnose::did_you_mean_or(name, &known);
    Problem::usage(format!("no {kind} is called `{name}`; {hint}"))
}
