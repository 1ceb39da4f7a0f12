//! The equations of a mechanism as functions of time and state, for integrators and optimisers of Python.

use dalembert::mechanism::{At, Description, Singular, System, choose_sides, rate_jacobian};
use dalembert::{Error, Settings, enter_initial_phase, initial_state};
use numpy::ndarray::Array2;
use numpy::{AllowTypeChange, PyArray1, PyArray2, PyArrayLike1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::background::guarded;
use crate::problem::made;

/// A mechanism with fixed parameters, in one phase.
#[pyclass(frozen, module = "dalembert._dalembert")]
pub struct Equations {
    system: Box<dyn System>,
    scene: usize,
    /// The phase that was asked for; `None`: that in which the scene begins.
    asked: Option<usize>,
}

type State<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;
type Numbers<'py> = PyResult<Bound<'py, PyArray1<f64>>>;
type Matrix<'py> = PyResult<Bound<'py, PyArray2<f64>>>;

impl Equations {
    pub fn new(
        py: Python<'_>,
        mut system: Box<dyn System>,
        scene: usize,
        (asked, derivation): (Option<usize>, Option<usize>),
    ) -> PyResult<Equations> {
        guarded(py, || {
            system.set_derivation(derivation);
            let settings = Settings::of_scene(&*system, scene);
            match asked {
                Some(phase) => {
                    system.set_memory(&system.scene_memory(scene));
                    system.set_phase(phase);
                }
                None => {
                    enter_initial_phase(&mut *system, &settings).map_err(|error| undecided(py, &error))?;
                }
            }
            Ok(Equations { system, scene, asked })
        })
    }

    fn description(&self) -> &Description {
        self.system.description()
    }

    /// The exception of a state without accelerations.
    fn unsolved(&self, py: Python<'_>, (t, y): (f64, &[f64]), singular: Singular) -> PyErr {
        let words = match t.is_finite() && y.iter().all(|x| x.is_finite()) {
            true => singular.cause(self.description()).to_string(),
            false => "the time and the state are not all finite numbers".to_owned(),
        };
        made(py, "EvaluationError", (words,))
    }

    /// Does something with the system on the sides of discontinuities where a state is.
    fn on_its_sides<T>(
        &self,
        py: Python<'_>,
        (t, y): (f64, &State<'_>),
        work: impl FnOnce(&dyn System, &[f64]) -> PyResult<T>,
    ) -> PyResult<T> {
        let (y, n) = (y.as_array().to_vec(), self.system.len());
        if y.len() != 2 * n {
            return Err(PyValueError::new_err(format!("a state has {} numbers, not {}", 2 * n, y.len())));
        }
        guarded(py, || {
            if self.description().switches.is_empty() {
                return work(&*self.system, &y);
            }
            let mut system = self.system.boxed_clone();
            choose_sides(&mut *system, t, &y).map_err(|singular| self.unsolved(py, (t, &y), singular))?;
            work(&*system, &y)
        })
    }

    /// The same with accelerations and multipliers.
    fn with_accelerations<T>(
        &self,
        py: Python<'_>,
        (t, y): (f64, &State<'_>),
        work: impl FnOnce(&dyn System, At<'_>) -> PyResult<T>,
    ) -> PyResult<T> {
        self.on_its_sides(py, (t, y), |system, y| {
            let (mut a, mut lambda) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
            let at = At::packed(t, y, system.len());
            let solved = system.accelerations_and_multipliers(at, &mut a, &mut lambda);
            solved.map_err(|singular| self.unsolved(py, (t, y), singular))?;
            work(system, at.accelerated(&a).constrained(&lambda))
        })
    }
}

/// The exception of a start that decides no phase.
fn undecided(py: Python<'_>, error: &Error) -> PyErr {
    made(py, "EvaluationError", (format!("the scene begins in no phase, `phase` names one: {error}"),))
}

#[pymethods]
impl Equations {
    /// The place of the phase.
    #[getter]
    fn phase(&self) -> usize {
        self.system.phase()
    }

    /// The values of the parameters.
    #[getter]
    fn parameters(&self) -> Vec<f64> {
        self.system.parameters()
    }

    /// Held values.
    #[getter]
    fn memory(&self) -> Vec<f64> {
        self.system.memory().to_vec()
    }

    /// The scene's end.
    #[getter]
    fn until(&self) -> f64 {
        self.system.scene(self.scene).until
    }

    /// The scene's start [q; q'], on the constraints of the phase, before any event.
    fn start<'py>(&self, py: Python<'py>) -> Numbers<'py> {
        let start = guarded(py, || {
            let scene = self.system.scene(self.scene);
            let mut system = self.system.boxed_clone();
            let mut settings = Settings::of_scene(&*system, self.scene);
            if self.description().rows.is_empty() {
                return Ok([scene.q, scene.v].concat());
            }
            settings.phase = self.asked.unwrap_or(settings.phase);
            let first = initial_state(&mut *system, &settings);
            let first = first.map_err(|error| made(py, "EvaluationError", (error.to_string(),)))?;
            Ok([first.q, first.v].concat())
        })?;
        Ok(PyArray1::from_vec(py, start))
    }

    /// The rate [q'; q''] of a state [q; q'].
    fn rhs<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Numbers<'py> {
        let rate = self.on_its_sides(py, (t, &y), |system, y| {
            let mut rate = vec![0.0; y.len()];
            let solved = system.rate(t, y, &mut rate);
            solved.map_err(|singular| self.unsolved(py, (t, y), singular))?;
            Ok(rate)
        })?;
        Ok(PyArray1::from_vec(py, rate))
    }

    /// The slopes of the rate by the state.
    fn jacobian<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Matrix<'py> {
        let slopes = self.on_its_sides(py, (t, &y), |system, y| {
            let slopes = rate_jacobian(system, t, y);
            slopes.map_err(|singular| self.unsolved(py, (t, y), singular))
        })?;
        Ok(PyArray2::from_owned_array(py, Array2::from_shape_fn((slopes.nrows(), slopes.ncols()), |at| slopes[at])))
    }

    /// M(t, q).
    fn mass_matrix<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Matrix<'py> {
        let n = self.system.len();
        let matrix = self.on_its_sides(py, (t, &y), |system, y| {
            let pattern = &self.description().mass_pattern;
            let mut values = vec![0.0; pattern.len()];
            system.mass_matrix(At::packed(t, y, n), &mut values);
            let mut matrix = Array2::zeros((n, n));
            for ((row, column), value) in pattern.iter().zip(values) {
                matrix[(*row as usize, *column as usize)] = value;
                matrix[(*column as usize, *row as usize)] = value;
            }
            Ok(matrix)
        })?;
        Ok(PyArray2::from_owned_array(py, matrix))
    }

    /// h(t, q, q') of M q'' + h = 0.
    fn bias<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Numbers<'py> {
        let h = self.on_its_sides(py, (t, &y), |system, y| {
            let mut h = vec![0.0; system.len()];
            system.bias(At::packed(t, y, system.len()), &mut h);
            Ok(h)
        })?;
        Ok(PyArray1::from_vec(py, h))
    }

    /// J(t, q) of all rows of the constraints.
    fn constraint_matrix<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Matrix<'py> {
        let description = self.description();
        let matrix = self.on_its_sides(py, (t, &y), |system, y| {
            let pattern = &description.constraint_pattern;
            let mut values = vec![0.0; pattern.len()];
            system.constraint_matrix(At::packed(t, y, system.len()), &mut values);
            let mut matrix = Array2::zeros((description.rows.len(), system.len()));
            for ((row, column), value) in pattern.iter().zip(values) {
                matrix[(*row as usize, *column as usize)] = value;
            }
            Ok(matrix)
        })?;
        Ok(PyArray2::from_owned_array(py, matrix))
    }

    /// c and c' of all rows of the constraints.
    fn constraints<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Matrix<'py> {
        let rows = self.description().rows.len();
        let values = self.on_its_sides(py, (t, &y), |system, y| {
            let mut triples = vec![0.0; 3 * rows];
            system.constraints(At::packed(t, y, system.len()), &mut triples);
            Ok(Array2::from_shape_fn((rows, 2), |(row, k)| triples[3 * row + k]))
        })?;
        Ok(PyArray2::from_owned_array(py, values))
    }

    /// Multipliers of all rows of the constraints.
    fn multipliers<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Numbers<'py> {
        Ok(PyArray1::from_vec(py, self.with_accelerations(py, (t, &y), |_, at| Ok(at.lambda.to_vec()))?))
    }

    /// The function of each event, and its condition: it counts only where that is > 0.
    fn events<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Matrix<'py> {
        let count = self.description().events.len();
        let values = self.with_accelerations(py, (t, &y), |system, at| {
            let mut pairs = vec![0.0; 2 * count];
            system.events(at, &mut pairs);
            Ok(Array2::from_shape_fn((count, 2), |(event, k)| pairs[2 * event + k]))
        })?;
        Ok(PyArray2::from_owned_array(py, values))
    }

    /// All outputs, component by component.
    fn outputs<'py>(&self, py: Python<'py>, t: f64, y: State<'py>) -> Numbers<'py> {
        let values = self.with_accelerations(py, (t, &y), |system, at| {
            let mut values = vec![0.0; system.description().output_len()];
            system.outputs(at, &mut values);
            Ok(values)
        })?;
        Ok(PyArray1::from_vec(py, values))
    }

    /// Kinetic and potential energy.
    fn energy(&self, py: Python<'_>, t: f64, y: State<'_>) -> PyResult<(f64, f64)> {
        self.on_its_sides(py, (t, &y), |system, y| {
            let energy = system.energy(At::packed(t, y, system.len()));
            Ok((energy.kinetic, energy.potential))
        })
    }
}
