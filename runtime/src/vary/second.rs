//! The second run, which tells how far off the numbers of the first one may be.

use super::Varied;
use crate::error::Error;
use crate::simulate::Settings;

/// The tolerance of a rougher run, in units of the first: its errors are as many times as large, as far as they follow the tolerance.
const LOOSER: f64 = 16.0;
/// A rougher run with more than this part of the steps of the first has the same ones, but for some, and nearly the same errors.
const SHARED: f64 = 0.75;
/// The tolerance of a finer run, which has half the steps too, is this part of the first.
const TIGHTER: f64 = 1.0 / LOOSER;
/// Errors are told as so many times the difference to a finer run, which has errors of its own: a half of those of a method of order 1.
pub(crate) const TOLD: f64 = 2.0;

/// A second run.
pub(crate) struct Second<T> {
    pub run: T,
    /// Errors are so many times what differs in it.
    pub told: f64,
}

/// Runs again, rougher; where that fails or has the steps of the first run, which stops, the times at which slopes are wanted, or a longest
/// step give, finer.  `None` where neither
/// succeeds: then nothing is known of errors.
pub(crate) fn second<T>(
    first: &Varied,
    settings: &Settings,
    mut again: impl FnMut(&Settings) -> Result<T, Error>,
    of: impl Fn(&T) -> &Varied,
) -> Option<Second<T>> {
    if settings.step.is_none() {
        let looser = Settings { tolerance: LOOSER * settings.tolerance, digits: false, ..settings.clone() };
        let longer = |rough: &T| of(rough).steps as f64 <= SHARED * first.steps as f64;
        if let Some(run) = again(&looser).ok().filter(longer) {
            return Some(Second { run, told: 1.0 });
        }
    }
    let mean = (first.run.last().t - first.run.first().t) / first.steps.max(1) as f64;
    again(&finer(settings, mean)).ok().map(|run| Second { run, told: TOLD })
}

/// Settings of a run that is more accurate than one whose steps were so long on average, s.
pub(crate) fn finer(settings: &Settings, mean: f64) -> Settings {
    let mut settings = Settings { digits: false, ..settings.clone() };
    settings.tolerance = (TIGHTER * settings.tolerance).max(Settings::TIGHTEST);
    if let Some(step) = &mut settings.step {
        *step *= 0.5;
    } else if mean > 0.0 && mean.is_finite() {
        settings.longest_step = Some(settings.longest_step.map_or(0.5 * mean, |longest| longest.min(0.5 * mean)));
    }
    settings
}
