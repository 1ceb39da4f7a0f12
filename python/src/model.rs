//! A model: what it says of itself, and the commands on it.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use dalembert::cli::{Kept, LoadError, Session};
use dalembert::mechanism::{Action, Description, Direction, Event};
use pyo3::prelude::*;

use crate::background::in_background;
use crate::equations::Equations;
use crate::library;
use crate::problem::{class, made, raised, text, unloaded};
use crate::run::Run;

/// A model that was loaded and derived.
#[pyclass(frozen, module = "dalembert._dalembert")]
pub struct Model {
    session: Arc<Session>,
    description: Description,
}

/// What a model is loaded from.
type Parts = (String, String, String, Vec<(String, i64)>, Option<PathBuf>, Vec<(PathBuf, String)>);

/// What a command wrote, and why it failed: the class of the exception and its words.
type Answered = (String, Option<(&'static str, String)>);

#[pymethods]
impl Model {
    /// A model by its name in the library or by the path of its file.
    #[staticmethod]
    fn named(py: Python<'_>, name: String, sizes: Vec<(String, i64)>) -> PyResult<Model> {
        opened(py, move || Session::named(library(), &name, sizes))
    }

    /// A model of this text, which goes by this name.
    #[staticmethod]
    fn of_text(py: Python<'_>, name: String, text: String, sizes: Vec<(String, i64)>) -> PyResult<Model> {
        opened(py, move || Session::of_text(library(), (&name, &text), sizes))
    }

    /// A model of what another told by `kept`.
    #[staticmethod]
    fn restored(py: Python<'_>, kept: Parts) -> PyResult<Model> {
        let (name, path, source, sizes, folder, files) = kept;
        opened(py, move || Session::restored(library(), Kept { name, path, source, sizes, folder, files }))
    }

    /// All that it was loaded from: its name, path, text and sizes, the folder of files that it names, and these with their texts.
    #[getter]
    fn kept(&self) -> Parts {
        let Kept { name, path, source, sizes, folder, files } = self.session.kept();
        (name, path, source, sizes, folder, files)
    }

    #[getter]
    fn name(&self) -> &str {
        self.session.name()
    }

    #[getter]
    fn source(&self) -> &str {
        self.session.source()
    }

    #[getter]
    fn about(&self) -> &str {
        &self.description.about
    }

    /// Warnings about the file, as JSON.
    #[getter]
    fn warnings(&self) -> &str {
        self.session.warnings()
    }

    /// (name, unit) of each coordinate; hidden coordinates of states of first order begin with `∫`.
    #[getter]
    fn coordinates(&self) -> Vec<(&str, &str)> {
        self.description.coordinates.iter().map(|c| (c.name.as_ref(), c.unit.as_ref())).collect()
    }

    /// (name, unit, the file's value) of each parameter.
    #[getter]
    fn parameters(&self) -> Vec<(&str, &str, f64)> {
        self.description.parameters.iter().map(|p| (p.name.as_ref(), p.unit.as_ref(), p.default)).collect()
    }

    /// (name, components, unit) of each output.
    #[getter]
    fn outputs(&self) -> Vec<(&str, u32, &str)> {
        self.description.outputs.iter().map(|o| (o.name.as_ref(), o.components, o.unit.as_ref())).collect()
    }

    #[getter]
    fn inputs(&self) -> Vec<&str> {
        self.description.inputs.iter().map(AsRef::as_ref).collect()
    }

    /// (name, direction as SciPy has it, whether it does more than record, the phases in which it counts if not all) of each event.
    #[getter]
    fn events(&self) -> Vec<(&str, i8, bool, Option<Vec<u32>>)> {
        let direction = |event: &Event| match event.direction {
            Direction::Rising => 1,
            Direction::Falling => -1,
            Direction::Both => 0,
        };
        let acts = |event: &Event| event.actions.iter().any(|action| *action != Action::Record);
        let phases = |event: &Event| event.phases.as_ref().map(|phases| phases.to_vec());
        let all = self.description.events.iter();
        all.map(|event| (event.name.as_ref(), direction(event), acts(event), phases(event))).collect()
    }

    #[getter]
    fn scenes(&self) -> Vec<&str> {
        self.description.scenes.iter().map(AsRef::as_ref).collect()
    }

    #[getter]
    fn phases(&self) -> Vec<&str> {
        self.description.phases.iter().map(|phase| phase.name.as_ref()).collect()
    }

    #[getter]
    fn constraints(&self) -> Vec<&str> {
        self.description.rows.iter().map(|row| row.name.as_ref()).collect()
    }

    /// Runs a command of the program on this model.
    fn command(&self, py: Python<'_>, name: String, options: Vec<String>) -> PyResult<Answered> {
        let session = self.session.clone();
        let done = in_background(py, move |interrupted| session.command(&name, &options, interrupted))?;
        let answer = done.whole()?;
        Ok((answer.text, answer.problem.map(|problem| (class(&problem), text(&problem)))))
    }

    /// Runs a scene; a run that fails, or is interrupted, comes with the exception.
    fn simulate(&self, py: Python<'_>, options: Vec<String>) -> PyResult<Run> {
        let session = self.session.clone();
        let done = in_background(py, move |interrupted| {
            session.simulate(&options, &mut || match interrupted.load(Ordering::Relaxed) {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        })?;
        let run = Run::from(done.value.map_err(|problem| raised(py, &problem))?);
        let failure = run.failure();
        match (done.interrupted, failure) {
            (None, None) => Ok(run),
            (Some(_), _) => Err(made(py, "interrupted", (run,))),
            (None, Some((text, time))) => Err(made(py, "failed", (text, run, time))),
        }
    }

    /// M, C, K and B, A and B of first order, as JSON.
    fn linearise(&self, py: Python<'_>, options: Vec<String>) -> PyResult<String> {
        let session = self.session.clone();
        let done = in_background(py, move |_| session.linearise(&options))?;
        done.whole()?.map_err(|problem| raised(py, &problem))
    }

    /// The equations of a scene by its options, in a phase or in that in which the scene begins, by a system of balances.
    fn equations(
        &self,
        py: Python<'_>,
        options: Vec<String>,
        phase: Option<usize>,
        derivation: Option<usize>,
    ) -> PyResult<Equations> {
        let session = self.session.clone();
        let chosen = in_background(py, move |_| session.system_of(&options))?.whole()?;
        let (system, scene) = chosen.map_err(|problem| raised(py, &problem))?;
        Equations::new(py, system, scene, (phase, derivation))
    }

    /// The names of systems of balances.
    #[getter]
    fn derivations(&self) -> Vec<&str> {
        self.description.balances.iter().map(|system| system.name.as_ref()).collect()
    }
}

fn opened(py: Python<'_>, open: impl FnOnce() -> Result<Session, LoadError> + Send + 'static) -> PyResult<Model> {
    let session = in_background(py, move |_| open())?.whole()?.map_err(|error| unloaded(py, &error))?;
    let description = session.system().description().clone();
    Ok(Model { session: Arc::new(session), description })
}
