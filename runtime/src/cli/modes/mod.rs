//! `modes`: an equilibrium, M, C and K there, the modes, and answers to what shakes them.

mod bodies;
mod constrained;
mod contacts;
mod damping;
mod drive;
mod for_programs;
mod instant;
mod integrals;
mod locus;
mod matrices;
mod model;
mod motion;
mod report;
#[cfg(feature = "modal")]
mod sampled;
mod shaken;
mod state_space;
#[cfg(feature = "modal")]
mod states;
mod steady;
#[cfg(feature = "modal")]
mod tangent;
mod trim;
mod varying;

use std::io::Write;

use super::load::{Loaded, pairs};
use super::set_up::{Reader, choose, with_unit_of};
use super::{Context, Problem, outputs};
use crate::constrain::slides_in_space;
use crate::linear::{
    Guess, Kind, LinearError, Linearised, Mode, animate_mode, draw_modes, equilibrium_here, equilibrium_near,
    guess_of_rest, has_dependent_coordinates, linearise, linearise_constrained, short,
};
use crate::mechanism::{Noise, System, Target};
use crate::simulate::{Settings, closed, settled};
use clap::ArgMatches;
use contacts::ContactsAtRest;
use dalembert_symbolic::model::Sets;
use damping::Damping;
use drive::Driven;
use locus::Locus;
use model::Model;
use motion::Compared;
use nalgebra::DMatrix;
use serde_json::{Value, json};
use steady::Speeds;
use trim::Trim;

pub(super) use for_programs::linearised;

/// Options that draw.
const PICTURES: [&str; 5] = ["plot", "motion", "bode", "locus", "campbell"];
/// Matrices with more coordinates are not printed for people.
const MOST_PRINTED: usize = 12;

/// Searches from `--at` or the file's guess (or takes it as it is), linearises, and prints the modes.
pub fn run(context: Context<'_>, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    for option in PICTURES.into_iter().chain(["animate", "matrices"]) {
        options.get_one::<String>(option).map_or(Ok(()), |path| outputs::refuse_hyphen(option, path))?;
    }
    let mut drawn = PICTURES.iter().filter_map(|name| options.get_one::<String>(name));
    drawn.try_for_each(|path| outputs::drawable(path))?;
    options.get_one::<String>("animate").map_or(Ok(()), |path| outputs::playable(path))?;
    options.get_one::<String>("state-space").map_or(Ok(()), |path| outputs::ends_in(path, &state_space::ENDINGS))?;
    options.get_one::<String>("matrices").map_or(Ok(()), |path| outputs::ends_in(path, &["mtx", "csv"]))?;
    if options.get_one::<String>("at-time").is_some() {
        return instant::run(context, options, out);
    }
    let prepared = prepared(context, options)?;
    for warning in prepared.loaded.warnings.iter().chain(&prepared.held) {
        eprintln!("warning: {warning}");
    }
    let absent = inputs_at_0(&prepared.loaded, options)?;
    small_motions(prepared, options, out).map_err(|problem| match (problem, absent) {
        (Problem::Run(text), Some(absent)) => Problem::Run(format!("{text}; {absent}")),
        (problem, _) => problem,
    })
}

/// Searches, linearises and prints.
fn small_motions(prepared: Prepared, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let Prepared { loaded, scene, mut reader, speeds, place, held } = prepared;
    if options.get_flag("sampled") {
        return sampled(&loaded, options, place.guess, out);
    }
    if loaded.system.description().has_states() {
        return with_states(&loaded, options, &mut reader, &place, out);
    }
    let together = options.get_flag("steady") && steady::go_on_together(&loaded, &place.guess)?;
    if has_dependent_coordinates(&*loaded.system) || together {
        return constrained::run(&loaded, options, &mut reader, (scene, &speeds), &place, out);
    }
    let system = &*loaded.system;
    let Place { guess, here, trim } = &place;
    let found = if *here { equilibrium_here(system, guess) } else { equilibrium_near(system, guess) };
    let linear = linearise(system, &found.map_err(failed)?).map_err(failed)?;
    let mut modes = linear.modes().map_err(failed)?;
    bodies::name_free(&loaded, &linear, None, &mut modes)?;
    let model = Model::Free(&linear);
    let further = FurtherAnswers::of(&loaded, options, &mut reader, (scene, &speeds), model, &modes)?;
    let mut written = Vec::new();
    pictures(&loaded, options, &linear, &modes, &mut written)?;
    let space = || state_space::of_model(&loaded, options, &mut reader, model);
    state_space::write(&loaded.name, options, space, &mut written)?;
    if state_space::goes_to_output(options)? {
        return Ok(out.write_all(&written)?);
    }
    if options.get_flag("json") {
        let mut more = further.as_json();
        more.extend(trim.iter().map(Trim::as_json));
        let told: Vec<&String> = further.warnings.iter().chain(&held).collect();
        more.extend((!told.is_empty()).then(|| ("warnings", json!(told))));
        super::json::write(&report::as_json(&loaded.name, &linear, &modes, more), out)?;
        return Ok(());
    }
    let bodies = bodies::shares(&loaded, &linear, &modes)?;
    let masses = linear.m().diagonal();
    trim.iter().try_for_each(|trim| trim.table(&loaded.name, out))?;
    report::table(&loaded.name, (&linear, masses.as_slice()), &modes, &bodies, out)?;
    further.table(model, out)?;
    Ok(out.write_all(&written)?)
}

/// What is told of small motions beside their modes.
struct FurtherAnswers {
    damping: Option<Damping>,
    motion: Option<Compared>,
    driven: Option<Driven>,
    locus: Option<Locus>,
    contacts: ContactsAtRest,
    /// What the numbers alone do not tell.
    warnings: Vec<String>,
}

impl FurtherAnswers {
    /// Of a model and its modes in independent coordinates; prints the warnings.
    fn of(
        loaded: &Loaded,
        options: &ArgMatches,
        reader: &mut Reader,
        (scene, speeds): (usize, &Speeds),
        model: Model<'_>,
        modes: &[Mode],
    ) -> Result<FurtherAnswers, Problem> {
        let (system, linear) = (&*loaded.system, model.linear());
        let driven = Driven::new(loaded, options, reader, model)?;
        let locus = Locus::new(loaded, options, reader, &linear.equilibrium, speeds)?;
        let damping = Damping::new(linear, modes);
        let motion = Compared::new(loaded, options, scene, model, damping.as_ref())?;
        let more = driven.iter().flat_map(Driven::notes).chain(locus.iter().flat_map(Locus::notes));
        let untried = integrals::notes(system, &linear.equilibrium, locus.as_ref());
        let varying = varying::notes(system, &linear.equilibrium, system.scene(scene).until);
        let contacts = ContactsAtRest::of(system, &linear.equilibrium.as_guess());
        let told =
            contacts.warnings.iter().cloned().chain(untried).chain(varying).chain(notes(linear, modes)).chain(more);
        let warnings: Vec<String> = told.collect();
        for warning in &warnings {
            eprintln!("warning: {warning}");
        }
        Ok(FurtherAnswers { damping, motion, driven, locus, contacts, warnings })
    }

    /// All but the warnings, for programs.
    fn as_json(&self) -> Vec<(&'static str, Value)> {
        let mut entries: Vec<_> = self.contacts.as_json().into_iter().collect();
        entries.extend(self.damping.iter().map(Damping::as_json));
        entries.extend(self.motion.iter().map(Compared::as_json));
        entries.extend(self.driven.iter().flat_map(Driven::as_json));
        entries.extend(self.locus.iter().map(Locus::as_json));
        entries
    }

    /// For people.
    fn table(&self, model: Model<'_>, out: &mut dyn Write) -> Result<(), Problem> {
        self.contacts.table(out)?;
        self.damping.iter().try_for_each(|damping| damping.table(out))?;
        self.motion.iter().try_for_each(|motion| motion.table(out))?;
        self.driven.iter().try_for_each(|driven| driven.table(model, out))?;
        self.locus.iter().try_for_each(|locus| locus.table(out))
    }
}

/// What small motions are about, before an equilibrium is looked for.
struct Prepared {
    loaded: Loaded,
    scene: usize,
    reader: Reader,
    speeds: Speeds,
    place: Place,
    /// That held values and noise stay as they are.
    held: Vec<String>,
}

/// Where small motions are looked at.
struct Place {
    guess: Guess,
    /// The guess is the place itself.
    here: bool,
    /// How it came to be one.
    trim: Option<Trim>,
}

/// Applies what chooses a scene, a phase, and where the search begins; trims.
fn prepared(context: Context<'_>, options: &ArgMatches) -> Result<Prepared, Problem> {
    let mut loaded = Loaded::find(context, options)?;
    super::drawn::check(&loaded, options)?;
    let (scene, mut reader) = choose(&mut loaded, options)?;
    enter_phase(&mut loaded, scene, options)?;
    let inputs = held_inputs(&loaded, options)?;
    let mut memory = loaded.system.scene_memory(scene);
    let mut speeds = Speeds::new(&loaded, options, scene, &inputs)?;
    let mut q = match options.get_flag("steady") {
        // As a run begins: what the start leaves open follows from the constraints.
        true => {
            let settings = Settings::of_scene(&*loaded.system, scene);
            closed(&*loaded.system, &settings).unwrap_or(settings.q)
        }
        false => guess_of_rest(&*loaded.system, &loaded.system.scene(scene).q),
    };
    if loaded.system.description().has_states() {
        // The guess of a state stands in the place of its hidden coordinate.
        let first = loaded.system.description().mechanical();
        speeds.v[first..].copy_from_slice(&q[first..]);
        q[first..].fill(0.0);
    }
    reader.states(&loaded, options, "at", &mut q, &mut speeds.v)?;
    for (place, value) in reader.memory(&loaded, options, "at")? {
        memory[place] = value;
    }
    loaded.system.set_memory(&memory);
    let held = held_note(&*loaded.system).filter(|_| !options.get_flag("sampled"));
    let held = held.into_iter().chain(noise_note(&*loaded.system)).collect();
    let mut guess = Guess { q, v: speeds.v.clone(), inputs };
    let trim = Trim::new(&mut loaded, options, &mut reader, &mut guess, (scene, &speeds.followed()))?;
    speeds.v.clone_from(&guess.v);
    loaded.warnings.append(&mut reader.notes);
    let place = Place { guess, here: options.get_flag("here") || trim.is_some(), trim };
    Ok(Prepared { loaded, scene, reader, speeds, place, held })
}

/// That held values stay as they are, where ticks or other events would set some.
fn held_note(system: &dyn System) -> Option<String> {
    let sampling = system.sampling();
    let set = |place: u32| {
        sampling.sets.iter().flat_map(|targets| targets.iter()).any(|target| *target == Target::Memory(place))
    };
    let of_noise = |place: u32| system.held_noise().iter().any(|noise| noise.held.contains(&place));
    let held = sampling.memory.iter().zip(0..).filter(|(_, place)| set(*place) && !of_noise(*place));
    let names: Vec<String> = held.map(|(held, _)| format!("`{}`", held.name)).collect();
    let are = if names.len() == 1 { "is" } else { "are" };
    let closes = if sampling.clocks.len() == system.held_noise().len() { "" } else { "; `modes --sampled` closes it" };
    (!names.is_empty()).then(|| format!("{} {are} held: this is the open loop{closes}", names.join(", ")))
}

/// That noise does not change.
fn noise_note(system: &dyn System) -> Option<String> {
    let name = |noise: &Noise| format!("`{}`", noise.name);
    let names: Vec<String> = system.held_noise().iter().map(name).collect();
    let moved = |noise: &Noise| system.memory().get(noise.held[0] as usize).is_some_and(|value| *value != 0.0);
    let at = if system.held_noise().iter().any(moved) { "as given" } else { "at 0, its mean" };
    let are = if names.len() == 1 { "is" } else { "are" };
    (!names.is_empty()).then(|| format!("{} {are} noise: frozen {at}", names.join(", ")))
}

#[cfg(feature = "modal")]
fn sampled(loaded: &Loaded, options: &ArgMatches, guess: Guess, out: &mut dyn Write) -> Result<(), Problem> {
    sampled::run(loaded, options, guess, out)
}

#[cfg(not(feature = "modal"))]
fn sampled(_: &Loaded, _: &ArgMatches, _: Guess, _: &mut dyn Write) -> Result<(), Problem> {
    Err(failed(LinearError::NeedsFeature { feature: "modal" }))
}

#[cfg(feature = "modal")]
fn with_states(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    place: &Place,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    states::run(loaded, options, reader, place, out)
}

#[cfg(not(feature = "modal"))]
fn with_states(_: &Loaded, _: &ArgMatches, _: &mut Reader, _: &Place, _: &mut dyn Write) -> Result<(), Problem> {
    Err(failed(LinearError::NeedsFeature { feature: "modal" }))
}

/// A matrix, a line a row.
fn rows(name: &str, matrix: &DMatrix<f64>, out: &mut dyn Write) -> Result<(), Problem> {
    writeln!(out, "  {name} =")?;
    for row in matrix.row_iter() {
        writeln!(out, "    [{}]", row.iter().map(|x| short(*x)).collect::<Vec<_>>().join(", "))?;
    }
    Ok(())
}

/// The modes about the equilibrium that is found from the file's guess, or from a scene's start, and what is wrong with integrals there.
pub(super) fn at_rest(system: &dyn System, scene: usize) -> Result<(Vec<Mode>, Vec<String>), LinearError> {
    if system.description().has_states() {
        return Err(LinearError::HasStates);
    }
    let guess = Guess::at(&guess_of_rest(system, &system.scene(scene).q));
    let linear = match has_dependent_coordinates(system) {
        false => linearise(system, &equilibrium_near(system, &guess)?)?,
        true => linearise_constrained(system, &guess, false)?.linear,
    };
    let varying = varying::notes(system, &linear.equilibrium, system.scene(scene).until);
    Ok((linear.modes()?, [integrals::notes(system, &linear.equilibrium, None), varying].concat()))
}

/// Puts the phase of `--phase` in force, or that in which the scene starts.
fn enter_phase(loaded: &mut Loaded, scene: usize, options: &ArgMatches) -> Result<(), Problem> {
    let Some(name) = options.get_one::<String>("phase") else {
        let settings = Settings::new(&loaded.system.scene(scene));
        let phase = settled(&mut *loaded.system, &settings).phase;
        loaded.system.set_phase(phase);
        return refuse_sliding(loaded);
    };
    let phases = &loaded.system.description().phases;
    match phases.iter().position(|phase| phase.name == *name) {
        Some(phase) => loaded.system.set_phase(phase),
        None => {
            let known: Vec<&str> = phases.iter().map(|phase| &*phase.name).filter(|name| !name.is_empty()).collect();
            return Err(Problem::usage(match known.is_empty() {
                true => format!("--phase: `{}` has no phases", loaded.name),
                false => format!("no phase `{name}`; there are {}", known.join(", ")),
            }));
        }
    }
    refuse_sliding(loaded)
}

/// Refuses a phase in which something slides in space, of which there is no linear model.
fn refuse_sliding(loaded: &Loaded) -> Result<(), Problem> {
    match slides_in_space(&*loaded.system) {
        None => Ok(()),
        Some(contact) => Err(failed(LinearError::SlidesInSpace { contact })),
    }
}

fn failed(error: LinearError) -> Problem {
    let hint = match error {
        LinearError::NoEquilibrium { .. } | LinearError::NonFinite { .. } => {
            "; --at NAME=VALUE lets the search start elsewhere"
        }
        _ => "",
    };
    Problem::Run(format!("{error}{hint}"))
}

/// `A..B`, both expressions of the model language.
fn range(loaded: &Loaded, reader: &mut Reader, option: &str, sets: Sets, text: &str) -> Result<(f64, f64), Problem> {
    let Some((from, to)) = text.split_once("..") else {
        return Err(Problem::usage(format!("--{option} wants a range A..B, not `{text}`")));
    };
    let from = with_unit_of(from, to);
    let (from, to) = (reader.value(loaded, option, sets, &from)?, reader.value(loaded, option, sets, to)?);
    if from == to {
        return Err(Problem::usage(format!("--{option}: the range `{text}` has no width")));
    }
    Ok((from, to))
}

/// Inputs are 0, but for those that `--input` gives: they stay as they are at t = 0.
fn held_inputs(loaded: &Loaded, options: &ArgMatches) -> Result<Vec<f64>, Problem> {
    let names = &loaded.system.description().inputs;
    let mut values = vec![0.0; 3 * names.len()];
    loaded.system.inputs(0.0, &mut values);
    let given = pairs(options, "input")?;
    let value = |(name, block): (&_, &[f64])| if given.iter().any(|(known, _)| known == name) { block[0] } else { 0.0 };
    Ok(names.iter().zip(values.chunks_exact(3)).map(value).collect())
}

/// That inputs are 0 which nobody gives and which are not so in a run: a reason why nothing may be found.
fn inputs_at_0(loaded: &Loaded, options: &ArgMatches) -> Result<Option<String>, Problem> {
    let names = &loaded.system.description().inputs;
    let mut values = vec![0.0; 3 * names.len()];
    loaded.system.inputs(0.0, &mut values);
    let given = pairs(options, "input")?;
    let absent = |(name, block): (&_, &[f64])| {
        let told =
            format!("`{name}` is 0 here, as inputs are that nobody gives (--input {name}={} does)", short(block[0]));
        (block[0] != 0.0 && !given.iter().any(|(known, _)| known == name)).then_some(told)
    };
    Ok(names.iter().zip(values.chunks_exact(3)).find_map(absent))
}

/// Writes `--plot`, `--matrices` and `--animate`; of an animated picture it tells people how it plays.
fn pictures(
    loaded: &Loaded,
    options: &ArgMatches,
    linear: &Linearised,
    modes: &[Mode],
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let system = &*loaded.system;
    let file = |name: &str| options.get_one::<String>(name);
    if let Some(path) = file("plot") {
        outputs::draw(path, draw_modes(system, linear, modes))?;
    }
    if let Some(path) = file("matrices") {
        matrices::write(path, linear)?;
    }
    let number = match file("mode") {
        None => modes.iter().position(|mode| mode.kind != Kind::Rigid).unwrap_or(0),
        Some(text) => match text.trim().parse::<usize>() {
            Ok(number) if (1..=modes.len()).contains(&number) => number - 1,
            _ => {
                return Err(Problem::usage(format!("--mode is `{text}`; there are modes 1 to {}", modes.len())));
            }
        },
    };
    if let (Some(path), Some(mode)) = (file("animate"), modes.get(number)) {
        let playback = outputs::animate(path, &animate_mode(system, linear, mode))?;
        if let Some(playback) = playback.filter(|_| !options.get_flag("json")) {
            writeln!(out, "{path}: mode {}, {playback}", number + 1)?;
        }
    }
    Ok(())
}

/// What the numbers alone do not tell.
fn notes(linear: &Linearised, modes: &[Mode]) -> Vec<String> {
    let mut notes = Vec::new();
    if linear.equilibrium.is_degenerate() {
        let directions = linear.equilibrium.freedom.degenerate.len().max(1);
        notes.push(format!(
            "the equilibrium is degenerate: in {directions} direction(s) the stiffness vanishes though nothing moves \
             freely there; the linear model does not tell what happens"
        ));
    }
    if modes.iter().any(|mode| mode.repeated && mode.kind != Kind::Rigid) {
        notes.push("some frequencies are equal: only the space that their shapes span has a meaning".to_owned());
    }
    if !linear.circulatory().is_zero() {
        notes.push("K is not symmetric: some force has no potential, and damping may destabilise".to_owned());
    }
    #[cfg(feature = "modal")]
    if !(linear.damping.is_zero() && linear.circulatory().is_zero())
        && let Ok(analysis) = crate::linear::complex_modes(linear)
    {
        if analysis.only_gyroscopic {
            notes.push("K alone is unstable and only gyroscopic forces hold it: any damping destroys that".to_owned());
        }
        if !analysis.secular.is_empty() {
            let groups = &analysis.secular;
            let one = |group: &Vec<usize>| {
                let numbers: Vec<String> = group.iter().map(|index| (index + 1).to_string()).collect();
                format!("modes {} share one shape", numbers.join(" and "))
            };
            let (count, plural) = (groups.len(), if groups.len() == 1 { "" } else { "s" });
            let list: Vec<String> = groups.iter().map(one).collect();
            let most = groups.iter().map(Vec::len).max().unwrap_or(2);
            let (what, more, power) = match most {
                2 => ("pair", String::new(), "t".to_owned()),
                most => ("group", format!(" + … t^{}", most - 1), format!("t^{}", most - 1)),
            };
            let grows = modes.iter().any(|mode| mode.secular && mode.zeta == Some(0.0));
            let grows = if grows { format!(", and grow like {power}") } else { String::new() };
            let list = list.join("; ");
            notes.push(format!("{count} secular {what}{plural}: {list}; motions have a factor A + B t{more}{grows}"));
        }
        if analysis.defective {
            notes.push("A is defective: eigenvectors alone do not span all motions".to_owned());
        }
    }
    notes
}
