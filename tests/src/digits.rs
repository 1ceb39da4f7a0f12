//! Digits that a run promises against those that hold.

use crate::case::Case;

/// Promise and truth of one scene's run at one tolerance.
#[derive(Clone, Debug)]
pub struct Promise {
    /// `model, scene`.
    pub name: String,
    /// The run's tolerance.
    pub tolerance: f64,
    /// (column, promised bound of the error, true error) at the end, where the value is more than rounding.
    pub columns: Vec<(String, f64, f64)>,
}

impl Promise {
    /// By how many digits the worst promise is broken; negative where all hold.
    pub fn broken(&self) -> f64 {
        self.modesty().fold(f64::NEG_INFINITY, |worst, digits| worst.max(-digits))
    }

    /// By how many digits each promise is too modest; negative where it is broken.
    pub fn modesty(&self) -> impl Iterator<Item = f64> + '_ {
        self.columns.iter().map(|(_, promised, error)| (promised / error).log10())
    }
}

/// Runs the scenes of all models at their tolerance and at others, against runs at the tightest tolerance.
pub fn promises(tolerances: &[Option<f64>]) -> Vec<Promise> {
    let mut found = Vec::new();
    for entry in dalembert_models::MODELS {
        let scenes = Case::new(entry.name).system.description().scenes.clone();
        for scene in scenes.iter() {
            let mut reference = Case::new(entry.name).scene(scene).tolerance(1e-14);
            let Ok(truth) = reference.try_run() else { continue };
            for tolerance in tolerances {
                let mut case = Case::new(entry.name).scene(scene);
                case.settings.tolerance = tolerance.unwrap_or(case.settings.tolerance);
                case.settings.digits = true;
                let tolerance = case.settings.tolerance;
                // The reference has to be better than what it judges.
                if tolerance < 5e-13 {
                    continue;
                }
                let Ok(run) = case.try_run() else { continue };
                let mut columns = Vec::new();
                for name in run.column_names() {
                    let last = |run: &dalembert::Run| run.column(&name).and_then(|column| column.last().copied());
                    let (Some(value), Some(right)) = (last(&run), last(&truth)) else { continue };
                    let bound = run.errors(&name).and_then(|errors| errors.last().copied());
                    let Some(bound) = bound.filter(|bound| bound.is_finite()) else { continue };
                    let error = (value - right).abs();
                    // The reference's own error is of the order of rounding, and grows as the run's does.
                    if error > 1e-13 * right.abs().max(1e-3) && bound > 0.0 {
                        columns.push((name, bound, error));
                    }
                }
                found.push(Promise { name: format!("{}, {scene}", entry.name), tolerance, columns });
            }
        }
    }
    found
}
