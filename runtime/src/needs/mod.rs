//! No more than a scene needs: on which parts of a model its outputs depend, by how much, and what leaving out the rest saves.
//!
//! 1. What is wanted, and the motion that answers it in full: look in `full.rs`.
//! 2. Every ingredient of the file: look in `candidate.rs`; the file without it: in `reduction.rs`; edits of the text: in `edit.rs`;
//!    families of coordinates by their modes: in `modal.rs`; laws and models made linear: in `linear.rs`; what is stiff as a
//!    constraint: in `rigid.rs`, its text in `constrained.rs`.
//! 3. How far two runs are apart: look in `deviation.rs`; how far they would be by a first approximation, along the full motion: in
//!    `prediction.rs`; along the smaller model's, where a stiff coordinate is held: in `below.rs`.
//! 4. What goes together, tried as a whole: look in `choice.rs`.
//! 5. The table, and the smaller file: look in `report.rs`; the picture: in `picture.rs`; the test that comes with the file:
//!    in `comparison.rs`; in which measure deviations are told: in `told.rs`.
//!
//! Every candidate is a file of its own that compiles by itself, with all that it claims proved again, and is run; nothing is
//! left out by a prediction alone.

mod below;
mod candidate;
mod channel;
mod choice;
mod comparison;
mod constrained;
mod deviation;
mod edit;
mod error;
mod explicit;
mod full;
mod linear;
mod modal;
mod picture;
mod prediction;
mod reduction;
mod report;
mod rigid;
mod told;

pub use choice::Choice;
pub use deviation::Deviation;
pub use error::NeedsError;
pub use prediction::{Law, Prediction};
pub use reduction::{ModelReduction, Proposal, Verdict};

use std::ops::ControlFlow;

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::keys;
use dalembert_symbolic::model::{self, Files};

use full::Full;

use crate::precision::Verified;
use crate::simulate::Interruption;

/// What is wanted of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Need {
    /// Coordinates, rates (`theta'`) and outputs (a vector's name stands for all its components).
    pub outputs: Vec<String>,
    /// The largest deviation over the scene, in parts of the range that each goes through.
    pub within: f64,
    /// What is wanted to an amount of its own instead, SI, as where it hardly moves.  Its deviations are counted in parts of that amount
    /// over `within`, so that `within` is the limit of all.
    pub absolute: Vec<(String, f64)>,
}

impl Default for Need {
    /// All coordinates and outputs to a thousandth of the range of each.
    fn default() -> Need {
        Need { outputs: Vec::new(), within: WITHIN, absolute: Vec::new() }
    }
}

impl Need {
    /// These, in parts of the range of each.
    pub fn of(outputs: &[&str], within: f64) -> Need {
        Need { outputs: outputs.iter().map(|name| (*name).to_owned()).collect(), within, ..Need::default() }
    }
}

/// What a file is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct NeedsRequest {
    /// The model file's text.
    pub source: String,
    /// Sizes other than the file's.
    pub sizes: Vec<(String, i64)>,
    /// The files that it names.
    pub files: Files,
    /// Which scene; `None`: the default one.
    pub scene: Option<String>,
    /// What is wanted; `None`: what the scene says, or all coordinates and outputs to a thousandth.
    pub need: Option<Need>,
    /// Whether what saves less than a twentieth of the work may go too.
    pub all: bool,
}

/// What a scene needs of its model.
///
/// ```
/// use dalembert::needs::{Need, Needs, NeedsRequest};
///
/// let source = "
/// name: Hung
/// parameters: {m: 1 kg, L: 1 m, k: 2e4 N/m, g: 9.81 m/s^2}
/// coordinates: {r: m, theta: rad}
/// points: {O: [0, 0]}
/// bodies: {bob: {mass: m, position: \"r*[sin(theta), -cos(theta)]\"}}
/// gravity: [0, -g]
/// springs: {cord: {between: [O, bob], stiffness: k, rest: L}}
/// scene: {start: {r: L + m*g/k, theta: 0.3}, until: 5, tolerance: 1e-6}
/// ";
/// let need = Need::of(&["theta"], 2e-3);
/// let request = NeedsRequest { need: Some(need), ..NeedsRequest::new(source) };
/// let found = Needs::find(&request, &mut |_| std::ops::ControlFlow::Continue(()))?;
/// let choice = found.choice.as_ref().unwrap();
/// assert!(choice.verified < 2e-3 && choice.saving > 10.0);
/// assert!(found.smaller_file().unwrap().contains("define: {r: r_held}"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Needs {
    /// The model.
    pub name: String,
    /// The scene; `None`: the default one.
    pub scene: Option<String>,
    /// What is wanted; vectors by components.
    pub need: Need,
    /// When the scene ends, s.
    pub until: f64,
    /// How far two runs of the full model are apart, that is how well errors are known.
    pub known: f64,
    /// By how much a small change of the start grows in what is wanted, both in parts of ranges.
    /// Not a number where no other start could be run.
    pub growth: f64,
    /// Until when the scene can be promised, s, where that is not until its end.
    pub promised_until: Option<f64>,
    /// Operations that the scene takes as the file has it: evaluations of the accelerations, and Jacobians in their terms, times
    /// operations.
    pub operations: f64,
    /// The same at the tolerance at which reductions are compared, to which their savings refer.
    pub exact_operations: f64,
    /// That tolerance.
    pub exact_tolerance: f64,
    /// Operations of one evaluation of the full model's accelerations.
    pub evaluation: f64,
    /// The full model at ever tighter tolerances.
    pub full: Vec<Verified>,
    /// Every ingredient and what becomes of it, those that save most first.
    pub reductions: Vec<ModelReduction>,
    /// What may go together; `None` where the full model is the cheapest that serves.
    pub choice: Option<Choice>,
    /// Units of what is wanted.
    units: Vec<String>,
    /// Sizes other than the file's.
    sizes: Vec<(String, i64)>,
    /// At how many times runs were compared.
    times: usize,
    /// Whether what goes together was not found.
    broken_off: bool,
}

/// Where a file says nothing else.
const WITHIN: f64 = 1e-3;

impl NeedsRequest {
    /// Of a file's default scene, as it says.
    pub fn new(source: impl Into<String>) -> NeedsRequest {
        NeedsRequest {
            source: source.into(),
            sizes: Vec::new(),
            files: Files::default(),
            scene: None,
            need: None,
            all: false,
        }
    }

    /// The same question of the file with another value of a free parameter that has one, as the file would have it (`2 kg`).
    ///
    /// # Errors
    /// The names of parameters, where this is none of them; one that is not in lines or brackets.
    pub fn setting(mut self, name: &str, value: &str) -> Result<NeedsRequest, NeedsError> {
        self.is_known("parameters", "parameter", name)?;
        let edited = edit::with_parameter(&self.source, self.scene.as_deref(), name, value);
        self.source = edited.ok_or_else(|| NeedsError::NotEditable { what: name.to_owned() })?;
        Ok(self)
    }

    /// The same question of the file with another start of a coordinate or a speed, as the file would have it (`0.3 rad`).
    ///
    /// # Errors
    /// The names of coordinates, where this is neither one of them nor its speed; a scene that is not in lines or brackets.
    pub fn starting(mut self, name: &str, value: &str) -> Result<NeedsRequest, NeedsError> {
        self.is_known("coordinates", "coordinate", name.trim_end_matches('\''))?;
        let edited = edit::with_start(&self.source, self.scene.as_deref(), name, value);
        self.source = edited.ok_or_else(|| self.no_scene())?;
        Ok(self)
    }

    /// The same question of a scene that ends at another time, as the file would have it (`3 s`).
    ///
    /// # Errors
    /// The names of scenes, where the file has none of this name; a scene that is not in lines or brackets.
    pub fn ending(mut self, until: &str) -> Result<NeedsRequest, NeedsError> {
        if let Some(scene) = &self.scene {
            self.is_known("scenes", "scene", scene)?;
        }
        let edited = edit::with_until(&self.source, self.scene.as_deref(), until);
        self.source = edited.ok_or_else(|| self.no_scene())?;
        Ok(self)
    }

    /// Refuses a name that a section of the file does not have; a member of a family has no line of its own.
    fn is_known(&self, section: &str, kind: &'static str, name: &str) -> Result<(), NeedsError> {
        let known = keys(&self.source, &[Step::Key(section.to_owned())]);
        let family = |key: &str| name.contains('[') && key.split('[').next() == name.split('[').next();
        match () {
            () if known.iter().any(|key| key == name) => Ok(()),
            () if known.iter().any(|key| family(key)) => Err(NeedsError::NotEditable { what: name.to_owned() }),
            () => Err(NeedsError::UnknownName { kind, name: name.to_owned(), known }),
        }
    }

    fn no_scene(&self) -> NeedsError {
        NeedsError::NotEditable { what: self.scene.clone().unwrap_or_else(|| "scene".to_owned()) }
    }

    /// What is wanted, by its own words or the file's.
    ///
    /// # Errors
    /// A file with mistakes.
    pub fn need(&self) -> Result<Need, NeedsError> {
        if let Some(need) = &self.need {
            return Ok(need.clone());
        }
        Ok(self.said()?.unwrap_or_default())
    }

    /// What the file says that the scene is run for; `None` where it says nothing.
    ///
    /// # Errors
    /// A file with mistakes.
    pub fn said(&self) -> Result<Option<Need>, NeedsError> {
        let model = model::load_from(&self.files, &self.source, &self.sizes)
            .map_err(|problems| NeedsError::Model { problems })?;
        let said = model.need(self.scene.as_deref().unwrap_or("scene"));
        Ok(said.map(|said| Need { outputs: said.outputs, within: said.within, absolute: said.absolute }))
    }
}

impl Needs {
    /// Tries every ingredient; `progress` is told the name of each one, and may break off.
    ///
    /// # Errors
    /// A file with mistakes, an unknown output or scene, an accuracy that is no number between 1e-9 and 0.5, a scene that fails
    /// or is not known well enough, and a broken-off search ([`NeedsError::Interrupted`]).
    pub fn find(
        request: &NeedsRequest,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Needs, NeedsError> {
        Needs::find_until(request, &Interruption::default(), progress)
    }

    /// The same, which something else may break off too, within a run.
    pub(crate) fn find_until(
        request: &NeedsRequest,
        interruption: &Interruption,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<Needs, NeedsError> {
        let full = Full::run(request, request.need()?, interruption);
        if interruption.is_asked() {
            return Err(NeedsError::Interrupted { so_far: None });
        }
        let full = full?;
        let mut found = Needs::of(&full);
        let tried = found.try_all(&full, request.all, progress);
        found.reductions.sort_by(|a, b| b.saving.total_cmp(&a.saving));
        match tried {
            Err(NeedsError::Interrupted { .. }) => {
                (found.choice, found.broken_off) = (None, true);
                Err(NeedsError::Interrupted { so_far: Some(Box::new(found)) })
            }
            tried => tried.map(|()| found),
        }
    }

    /// Of a scene of which nothing was tried yet.
    fn of(full: &Full) -> Needs {
        Needs {
            name: full.name().to_owned(),
            scene: full.scene.clone(),
            need: full.need.clone(),
            until: full.until(),
            known: full.known,
            growth: full.growth,
            promised_until: full.promised_until,
            operations: full.operations,
            exact_operations: full.motion.operations,
            exact_tolerance: full.tolerance,
            evaluation: full.evaluation(),
            full: full.by_tolerance(),
            reductions: Vec::new(),
            choice: None,
            units: full.motion.units.clone(),
            sizes: full.sizes.clone(),
            times: full.times,
            broken_off: false,
        }
    }

    /// Tries every ingredient, then what goes together.
    fn try_all(
        &mut self,
        full: &Full,
        all: bool,
        progress: &mut dyn FnMut(&str) -> ControlFlow<()>,
    ) -> Result<(), NeedsError> {
        let unless_asked = || match full.settings.interruption.is_asked() {
            true => Err(NeedsError::Interrupted { so_far: None }),
            false => Ok(()),
        };
        if full.promised_until.is_none() {
            for proposal in candidate::candidates(full) {
                if reduction::is_climbed(&self.reductions, &proposal) {
                    continue;
                }
                if progress(&proposal.ingredient).is_break() {
                    return Err(NeedsError::Interrupted { so_far: None });
                }
                let tried = reduction::tried(full, proposal);
                // A run that was broken off says nothing of its ingredient.
                unless_asked()?;
                match self.reductions.last_mut() {
                    // The same coordinate held elsewhere.
                    Some(last) if reduction::are_alternatives(last, &tried) => {
                        *last = reduction::better(last.clone(), tried)
                    }
                    _ => self.reductions.push(tried),
                }
            }
        }
        reduction::predict_by_ladders(&mut self.reductions);
        self.choice = choice::choose(full, &self.reductions, all, progress)?;
        unless_asked()?;
        if full.promised_until.is_none() {
            self.reductions.extend(choice::looser(full));
        }
        Ok(())
    }
}
