//! What is wanted, and the motion that answers it in full.

use std::sync::Arc;

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::lower::{Program, compile_from};
use dalembert_symbolic::model::Files;
use dalembert_symbolic::print::resting_place;

use super::deviation::{Deviation, MOST_STEPS, Motion, TIMES, between, dense_enough, largest};
use super::edit::with_sizes;
use super::linear::resting;
use super::{Need, NeedsError, NeedsRequest};
use crate::constrain::Projection;
use crate::mechanism::{Interpreted, System};
use crate::precision::{Verified, WorkUnits};
use crate::simulate::{Interruption, Settings, simulate};

/// The full model's answer.
pub(super) struct Full {
    pub source: String,
    pub sizes: Vec<(String, i64)>,
    pub files: Files,
    pub scene: Option<String>,
    pub program: Program,
    pub system: Box<dyn System>,
    /// Where each coordinate would rest, as formulas; none where there are constraints.
    pub places: Vec<Option<String>>,
    /// Coordinates on which nothing wanted depends.
    not_depended_on: Vec<String>,
    pub settings: Settings,
    /// With vectors by components.
    pub need: Need,
    /// The range of each wanted quantity.
    pub scales: Vec<f64>,
    /// At the tolerance at which reductions are compared, and ten times more exactly.
    pub motion: Motion,
    pub exact: Motion,
    pub tolerance: f64,
    /// At how many times runs are compared.
    pub times: usize,
    /// At which other instants.
    pub instants: Arc<[f64]>,
    pub known: f64,
    pub growth: f64,
    pub promised_until: Option<f64>,
    /// Where it rests near its motion, if it does.
    pub rest: Option<Vec<f64>>,
    /// What the scene takes at its own tolerance.
    pub operations: f64,
}

/// Rungs are compared at a tolerance this far below the need, and no looser than the other.
const BELOW: f64 = 1e-3;
const TIGHT: f64 = 1e-9;
/// Errors must be known to this part of the need.
const KNOWN: f64 = 0.05;
/// Tolerances at which the full model is run beside, in parts of the need.
const LOOSER: [f64; 3] = [1.0, 1e-1, 1e-2];
/// The tolerance is this part of the need at the loosest.
const LOOSE: f64 = 1e-2;
/// Pushes of the start, in parts of ranges, by which growth is measured.
const PUSH: f64 = 1e-7;
/// Growth is measured from the first of so many parts of the scene on.
const INSTANTS: usize = 100;
/// Scenes in which a small change grows more than this are not reduced.
pub(super) const MOST_GROWTH: f64 = 1e4;
/// Coordinates beyond this many are not tried.
pub(super) const MOST_COORDINATES: usize = 24;

/// The runs of the full model with which reductions are compared.
struct References {
    /// What the scene takes at its own tolerance.
    operations: f64,
    motion: Motion,
    exact: Motion,
    times: usize,
    instants: Arc<[f64]>,
}

impl References {
    fn of(
        system: &dyn System,
        settings: &Settings,
        wanted: &[String],
        tolerance: f64,
    ) -> Result<References, NeedsError> {
        let run = |tolerance: f64, times: usize, instants: &Arc<[f64]>| {
            let motion = Motion::of((system, settings), (tolerance, times), (wanted, instants));
            motion.map_err(|why| NeedsError::Fails { why })
        };
        let none = Arc::from([]);
        let own = run(settings.tolerance, TIMES, &none)?;
        let dense = simulate(
            &mut *system.boxed_clone(),
            &Settings { tolerance, max_steps: MOST_STEPS, watch: false, ..settings.clone() },
        );
        let dense = dense.map_err(|error| NeedsError::Fails { why: error.to_string() })?;
        let times = dense_enough(dense.work.steps);
        let instants: Arc<[f64]> = dense.instants(times).into();
        let (motion, mut exact) = (run(tolerance, times, &instants)?, run(0.1 * tolerance, times, &instants)?);
        for (spread, extremes) in exact.spreads.iter_mut().zip(dense.extremes_of(wanted)) {
            *spread = extremes.map_or(*spread, |(low, high)| (high - low, low.abs().max(high.abs())));
        }
        Ok(References { operations: own.operations, motion, exact, times, instants })
    }

    /// The range of each wanted quantity; where everything is wanted, of each that moves, and the others are left out.
    ///
    /// # Errors
    /// A quantity that is wanted by name, and stands still.
    fn scales(&mut self, need: &mut Need, everything: bool) -> Result<Vec<f64>, NeedsError> {
        let mut scales = self.exact.scales(&self.motion);
        for (name, amount) in &need.absolute {
            let places = need.outputs.iter().zip(&mut scales).filter(|(wanted, _)| *wanted == name);
            places.for_each(|(_, scale)| *scale = Some(amount / need.within));
        }
        if everything {
            // Where everything is wanted nothing is to be lost of what stands still.
            let moves: Vec<bool> = scales.iter().map(Option::is_some).collect();
            let mut kept = moves.iter();
            need.outputs.retain(|_| *kept.next().unwrap_or(&true));
            let References { motion, exact, .. } = self;
            for values in [&mut motion.values, &mut exact.values, &mut motion.looks, &mut exact.looks] {
                let mut kept = moves.iter();
                values.retain(|_| *kept.next().unwrap_or(&true));
            }
            scales.retain(Option::is_some);
        }
        if let Some(still) = scales.iter().position(Option::is_none) {
            return Err(NeedsError::Still { name: need.outputs[still].clone() });
        }
        Ok(scales.into_iter().flatten().collect())
    }
}

/// Refuses accuracies that cannot be asked for.
fn possible(need: &Need) -> Result<(), NeedsError> {
    let amount = need.absolute.iter().find(|(_, amount)| !(*amount > 0.0 && amount.is_finite()));
    if let Some((_, within)) = amount {
        return Err(NeedsError::BadNeed { within: *within });
    }
    if !(1e-9..=0.5).contains(&need.within) {
        return Err(NeedsError::BadNeed { within: need.within });
    }
    Ok(())
}

impl Full {
    pub fn run(request: &NeedsRequest, need: Need, interruption: &Interruption) -> Result<Full, NeedsError> {
        let NeedsRequest { sizes, scene, files, .. } = request;
        possible(&need)?;
        // The smaller file is one of these sizes.
        let source = &with_sizes(&request.source, sizes);
        let compiled = compile_from(files, source, sizes);
        let program = compiled.map_err(|problems| NeedsError::Model { problems })?;
        if !program.model.states.is_empty() {
            return Err(NeedsError::States);
        }
        if !program.model.memory.is_empty() || !program.model.clocks.is_empty() {
            return Err(NeedsError::Memory);
        }
        let places = places(&program);
        let mut need = need;
        let everything = need.outputs.is_empty() && need.absolute.is_empty();
        let named = need.absolute.iter().map(|(name, _)| name.clone()).filter(|name| !need.outputs.contains(name));
        let named: Vec<String> = named.collect();
        need.outputs.extend(named);
        let not_depended_on = not_depended_on(&program, &need.outputs);
        let (system, settings) = set(program.clone(), source, scene.as_deref(), interruption)?;
        need.absolute = amounts(&*system, &need.absolute)?;
        need.outputs = columns(&*system, &need.outputs)?;
        let tolerance = (BELOW * need.within).min(TIGHT);
        let mut runs = References::of(&*system, &settings, &need.outputs, tolerance)?;
        let scales = runs.scales(&mut need, everything)?;
        let References { operations, motion, exact, times, instants } = runs;
        let mut full = Full {
            source: source.clone(),
            sizes: sizes.clone(),
            files: files.clone(),
            scene: scene.clone(),
            program,
            system,
            places,
            not_depended_on,
            settings,
            need,
            scales,
            motion,
            exact,
            tolerance,
            times,
            instants,
            known: 0.0,
            growth: 0.0,
            promised_until: None,
            rest: None,
            operations,
        };
        full.estimate_error()?;
        full.grow();
        full.rest = resting(&full);
        Ok(full)
    }

    /// Finds how well the motion is known: another run, more exact, agrees with it.
    fn estimate_error(&mut self) -> Result<(), NeedsError> {
        let known = between(&self.exact, &self.motion, self.measure());
        let (known, _) =
            known.map_err(|what| NeedsError::Fails { why: format!("in another run, more exact, {what}") })?;
        self.known = known.largest;
        if self.known > KNOWN * self.need.within {
            return Err(NeedsError::NotKnown { known: self.known, within: self.need.within });
        }
        Ok(())
    }

    /// Whether an ingredient is a coordinate on which nothing wanted depends.
    pub fn is_unfelt(&self, ingredient: &str) -> bool {
        ingredient
            .strip_prefix("coordinates.")
            .is_some_and(|name| self.not_depended_on.iter().any(|not_depended_on| not_depended_on == name))
    }

    /// Another text of the file, as a program.
    ///
    /// # Errors
    /// Its mistakes.
    pub fn compiled(&self, text: &str) -> Result<Program, Vec<Problem>> {
        compile_from(&self.files, text, &self.sizes)
    }

    pub fn name(&self) -> &str {
        &self.system.description().name
    }

    pub fn until(&self) -> f64 {
        self.settings.until
    }

    /// What is wanted, and by which ranges it is measured.
    pub fn measure(&self) -> (&[String], &[f64]) {
        (&self.need.outputs, &self.scales)
    }

    /// Operations of one evaluation of its accelerations.
    pub fn evaluation(&self) -> f64 {
        WorkUnits::of(&*self.system, self.settings.method).operations
    }

    /// Tolerances that may serve, looser than the scene's, the loosest first.
    pub fn tolerances(&self) -> impl Iterator<Item = f64> {
        let (within, own) = (self.need.within, self.settings.tolerance);
        [LOOSE, 0.1 * LOOSE].map(|part| part * within).into_iter().filter(move |tolerance| *tolerance > own)
    }

    /// It at loose tolerances, at its scene's, and at that at which reductions are compared; what fails at one is left aside.
    pub fn by_tolerance(&self) -> Vec<Verified> {
        let mut tolerances: Vec<f64> = LOOSER.map(|part| part * self.need.within).into();
        tolerances.extend([self.settings.tolerance, self.tolerance]);
        tolerances.sort_by(|a, b| b.total_cmp(a));
        tolerances.dedup();
        let verified = |tolerance: f64| {
            let motion = self.motion_of(&*self.system, &self.settings, tolerance).ok()?;
            let error = self.deviation(&motion).ok()?.largest;
            let work = motion.operations / self.evaluation();
            Some(Verified { name: self.name().to_owned(), tolerance, error, work })
        };
        tolerances.into_iter().filter_map(verified).collect()
    }

    /// What is wanted of a model, at the times at which runs are compared.
    pub fn motion_of(&self, system: &dyn System, settings: &Settings, tolerance: f64) -> Result<Motion, String> {
        Motion::of((system, settings), (tolerance, self.times), (&self.need.outputs, &self.instants))
    }

    /// How far a run is from the exact one.
    pub fn deviation(&self, motion: &Motion) -> Result<Deviation, String> {
        between(&self.exact, motion, self.measure()).map(|(deviation, _)| deviation)
    }

    /// Measures how a small push of the start grows, and until when the scene can be promised.
    fn grow(&mut self) {
        let mut grown = vec![0.0_f64; self.motion.times.len()];
        let start = started(&*self.system, &self.settings, &self.motion.first);
        let mut compared = false;
        for push in [PUSH, -PUSH] {
            let pushed = on_constraints(&*self.system, moved(&start, &self.motion.ranges, push));
            let Ok(motion) = self.motion_of(&*self.system, &pushed, self.tolerance) else { continue };
            compared = true;
            // An event more or less, as where a motion begins at a turning point, is no growth.
            let quiet = |motion: &Motion| Motion { events: Vec::new(), ..motion.clone() };
            let known = between(&self.motion, &motion, self.measure());
            match known.or_else(|_| between(&quiet(&self.motion), &quiet(&motion), self.measure())) {
                Ok((_, differences)) => {
                    for (row, grown) in grown.iter_mut().enumerate() {
                        let here: Vec<f64> = differences.iter().filter_map(|d| d.get(row).copied()).collect();
                        *grown = grown.max(largest(&here) / PUSH);
                    }
                }
                Err(_) => grown.fill(f64::INFINITY),
            }
        }
        if !compared {
            self.growth = f64::NAN;
            return;
        }
        // What an output reads a thousand times enlarged from the first instant on has not grown.
        let first = grown.len().div_ceil(INSTANTS);
        let enlarged = largest(&grown[..first]).max(1.0);
        if enlarged.is_finite() {
            grown.iter_mut().for_each(|grown| *grown /= enlarged);
        }
        self.growth = largest(&grown);
        let most = (KNOWN * self.need.within / self.tolerance).min(MOST_GROWTH);
        if self.growth > most {
            let row = grown.iter().position(|grown| *grown > most).unwrap_or(0);
            self.promised_until = Some(self.motion.times[row.saturating_sub(1)]);
        }
    }
}

/// A start as it meets its constraints.
pub(super) fn started(system: &dyn System, settings: &Settings, first: &[f64]) -> Settings {
    let mut settings = settings.clone();
    if !system.description().rows.is_empty() && first.len() == 2 * system.len() {
        settings.begin_in(first);
    }
    settings
}

/// A start brought back to the constraints that act there.
pub(super) fn on_constraints(system: &dyn System, mut settings: Settings) -> Settings {
    let mut system = system.boxed_clone();
    system.set_phase(settings.phase);
    if let Some(mut projection) = Projection::new(&*system) {
        let n = system.len();
        let mut y = [settings.q.as_slice(), &settings.v].concat();
        // Where that cannot be done the run says so.
        if projection.project(&*system, settings.from, &mut y).is_ok() {
            (settings.q, settings.v) = (y[..n].to_vec(), y[n..].to_vec());
        }
    }
    settings
}

/// A start moved by a part of the range that each coordinate and rate goes through, to one side and the other in turn; of what is
/// not held it is the guess.
fn moved(settings: &Settings, ranges: &[f64], part: f64) -> Settings {
    let mut settings = settings.clone();
    let n = settings.q.len();
    for (i, range) in ranges.iter().enumerate() {
        let step = if i % 2 == 0 { part } else { -0.6 * part } * range;
        match i.checked_sub(n) {
            None => settings.q[i] += step,
            Some(i) => settings.v[i] += step,
        }
    }
    settings
}

/// The coordinates on which nothing that is wanted depends; none where all is wanted.
fn not_depended_on(program: &Program, wanted: &[String]) -> Vec<String> {
    if wanted.is_empty() {
        return Vec::new();
    }
    let model = &program.model;
    let is_wanted = |name: &str| wanted.iter().any(|wanted| wanted == name || wanted.trim_end_matches('\'') == name);
    let of_output = |name: &str| {
        let component = |wanted: &String| wanted.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        is_wanted(name) || wanted.iter().any(component)
    };
    let outputs = model.outputs.iter().filter(|output| of_output(&output.name)).flat_map(|output| &output.value);
    let outputs: Vec<_> = outputs.copied().collect();
    let coordinates: Vec<usize> =
        (0..model.coordinates.len()).filter(|k| is_wanted(&model.coordinates[*k].name)).collect();
    let depended_on = program.depends_on(&outputs, &coordinates);
    let not_depended_on = (0..model.coordinates.len()).filter(|k| !depended_on[*k]);
    not_depended_on.map(|k| model.coordinates[k].name.clone()).collect()
}

/// Where each coordinate would rest.
fn places(program: &Program) -> Vec<Option<String>> {
    let count = program.model.coordinates.len();
    let known = program.model.constraints.is_empty() && count <= MOST_COORDINATES;
    (0..count).map(|coordinate| if known { resting_place(program, coordinate) } else { None }).collect()
}

/// A program's mechanism at a scene of its file.
pub(super) fn set(
    program: Program,
    source: &str,
    scene: Option<&str>,
    interruption: &Interruption,
) -> Result<(Box<dyn System>, Settings), NeedsError> {
    let mut system = Interpreted::new(program, source);
    let place = match scene {
        None => 0,
        Some(name) => {
            let known = &system.description().scenes;
            known.iter().position(|known| known == name).ok_or_else(|| NeedsError::UnknownName {
                kind: "scene",
                name: name.to_owned(),
                known: known.iter().map(ToString::to_string).collect(),
            })?
        }
    };
    for (index, value) in system.scene_parameters(place) {
        system.set_parameter(index, value);
    }
    let settings = Settings { interruption: interruption.clone(), ..Settings::of_scene(&system, place) };
    Ok((Box::new(system), settings))
}

/// Amounts of vectors as those of their components.
fn amounts(system: &dyn System, given: &[(String, f64)]) -> Result<Vec<(String, f64)>, NeedsError> {
    let mut found = Vec::new();
    for (name, amount) in given {
        found.extend(columns(system, std::slice::from_ref(name))?.into_iter().map(|column| (column, *amount)));
    }
    Ok(found)
}

/// What is wanted as columns of a run; all coordinates and outputs where nothing is named.
pub(super) fn columns(system: &dyn System, wanted: &[String]) -> Result<Vec<String>, NeedsError> {
    let description = system.description();
    let outputs = description.outputs.iter().map(|output| {
        let parts: Vec<String> = match output.axes() {
            [] => vec![output.name.to_string()],
            axes => axes.iter().map(|axis| format!("{}.{axis}", output.name)).collect(),
        };
        (output.name.to_string(), parts)
    });
    let coordinates: Vec<String> = description.coordinates.iter().map(|c| c.name.to_string()).collect();
    let mut known: Vec<(String, Vec<String>)> =
        coordinates.iter().map(|name| (name.clone(), vec![name.clone()])).collect();
    known.extend(outputs);
    if wanted.is_empty() {
        return Ok(known.into_iter().flat_map(|(_, parts)| parts).collect());
    }
    let rates: Vec<String> = coordinates.iter().map(|name| format!("{name}'")).collect();
    let mut found = Vec::new();
    for name in wanted {
        match known.iter().find(|(known, parts)| known == name || parts.contains(name)) {
            Some((whole, parts)) if whole == name => found.extend(parts.iter().cloned()),
            Some(_) => found.push(name.clone()),
            None if rates.contains(name) => found.push(name.clone()),
            None => {
                let known = known.iter().map(|(name, _)| name.clone()).chain(rates.iter().cloned()).collect();
                return Err(NeedsError::UnknownName { kind: "coordinate, rate or output", name: name.clone(), known });
            }
        }
    }
    Ok(found)
}
