//! A run: views of its numbers, and its pictures.

use dalembert::cli::Simulated;
use dalembert::show::Animation;
use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::guarded;
use crate::problem::{made, raised};

/// A motion that was computed; arrays are views of its memory.
#[pyclass(frozen, module = "dalembert._dalembert")]
pub struct Run {
    simulated: Simulated,
}

impl From<Simulated> for Run {
    fn from(simulated: Simulated) -> Self {
        Run { simulated }
    }
}

impl Run {
    /// Why it ended early, and when, if it did.
    pub fn failure(&self) -> Option<(String, f64)> {
        self.simulated.failed.clone()
    }

    fn run(&self) -> &dalembert::Run {
        &self.simulated.run
    }
}

#[pymethods]
impl Run {
    /// The reported times.
    #[getter]
    fn t<'py>(slf: &Bound<'py, Self>) -> Bound<'py, PyArray1<f64>> {
        let view = ArrayView1::from(slf.get().run().times());
        // SAFETY: a run never changes, and the array keeps it alive; nothing can be written.
        let array = unsafe { PyArray1::borrow_from_array(&view, slf.clone().into_any()) };
        array.readwrite().make_nonwriteable();
        array
    }

    /// The reported states, [q; q'] each.
    #[getter]
    fn states<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(slf, slf.get().run().state_rows())
    }

    /// The outputs at the reported times.
    #[getter]
    fn outputs<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(slf, slf.get().run().output_rows())
    }

    /// What `simulate --json` prints.
    #[getter]
    fn json(&self) -> &str {
        &self.simulated.json
    }

    /// Names of the columns of the states, then of the outputs.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.run().column_names()
    }

    /// The names of the columns without hidden ones.
    #[getter]
    fn shown(&self) -> Vec<String> {
        self.run().shown_names()
    }

    /// The SI unit of a column.
    fn unit(&self, name: &str) -> String {
        self.run().unit(name)
    }

    /// How many digits of a column hold at the end.
    fn digits(&self, name: &str) -> Option<u32> {
        self.run().digits(name)
    }

    /// Bounds of the errors of a column at the reported times.
    fn errors<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<f64>>> {
        self.run().errors(name).map(|errors| PyArray1::from_vec(py, errors))
    }

    /// The states [q; q'] at any times of the run, by dense output.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: PyArrayLike1<'py, f64, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let mut states = Vec::with_capacity(times.as_array().len());
        for t in times.as_array() {
            let state = self.run().at(*t);
            let state = state.ok_or_else(|| PyValueError::new_err(format!("t = {t} is not a time of this motion")))?;
            states.push([state.q, state.v].concat());
        }
        Ok(PyArray2::from_vec2(py, &states)?)
    }

    /// Charts as SVG.
    fn figure(&self, py: Python<'_>, shown: Vec<String>, section: Option<String>) -> PyResult<String> {
        guarded(py, || self.simulated.figure(&shown, section.as_deref()).map_err(|problem| raised(py, &problem)))
    }

    /// The page that animates the mechanism, with charts of these columns beside it; forces as arrows and events over it, all where a list is empty.
    #[pyo3(signature = (columns, arrows=None, mark_events=None))]
    fn animation(
        &self,
        py: Python<'_>,
        columns: Vec<String>,
        arrows: Option<Vec<String>>,
        mark_events: Option<Vec<String>>,
    ) -> PyResult<String> {
        guarded(py, || {
            let animation = self.simulated.animation(arrows.as_deref(), mark_events.as_deref());
            let mut animation: Animation = animation.map_err(|problem| raised(py, &problem))?;
            for name in &columns {
                let chart = self.run().history(&[name]);
                animation = animation.with_chart(chart.map_err(|error| made(py, "UsageError", (error.to_string(),)))?);
            }
            Ok(animation.to_html())
        })
    }
}

/// A view of rows that follow each other.
fn rows<'py>(slf: &Bound<'py, Run>, values: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let count = slf.get().run().len();
    let view = ArrayView2::from_shape((count, values.len() / count), values);
    let view = view.map_err(|error| PyValueError::new_err(error.to_string()))?;
    // SAFETY: a run never changes, and the array keeps it alive; nothing can be written.
    let array = unsafe { PyArray2::borrow_from_array(&view, slf.clone().into_any()) };
    array.readwrite().make_nonwriteable();
    Ok(array)
}
