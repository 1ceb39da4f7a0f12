/// What an error costs: errors and times of one method, from the loosest tolerance to the tightest.
#[derive(Default)]
pub struct Curve(Vec<(f64, f64)>);

/// Runs whose errors are within this factor of the one asked for enter its fit.
const WINDOW: f64 = 100.0;
/// Fewer runs than these are not fitted.
const FITTED: usize = 3;

impl Curve {
    /// Of the runs up to the most accurate: tighter tolerances only repeat its rounding.
    pub fn new(mut runs: Vec<(f64, f64)>) -> Self {
        let best = (0..runs.len()).min_by(|&i, &j| runs[i].0.total_cmp(&runs[j].0));
        runs.truncate(best.map_or(0, |best| best + 1));
        Curve(runs)
    }

    /// The time at which an error is reached: a line through what lies around it, both as logarithms; where too little does,
    /// the cheapest run that is as accurate.  Nothing where no run is.
    pub fn time(&self, error: f64) -> Option<f64> {
        let reaching = self.0.iter().filter(|run| run.0 <= error).map(|run| run.1);
        let cheapest = reaching.min_by(f64::total_cmp)?;
        let near = |run: &&(f64, f64)| (error / WINDOW..=error * WINDOW).contains(&run.0);
        let near: Vec<_> = self.0.iter().filter(near).map(|run| ((run.0 / error).ln(), run.1.ln())).collect();
        let around = near.len() >= FITTED && near.iter().any(|point| point.0 > 0.0);
        Some(if around { intercept(&near).exp() } else { cheapest })
    }
}

/// The value at 0 of the line of least squares.
fn intercept(points: &[(f64, f64)]) -> f64 {
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / points.len() as f64;
    let (x, y, xx, xy) = (mean(|p| p.0), mean(|p| p.1), mean(|p| p.0 * p.0), mean(|p| p.0 * p.1));
    let slope = (xy - x * y) / (xx - x * x);
    y - slope * x
}
