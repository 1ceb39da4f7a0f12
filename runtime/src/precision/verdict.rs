//! What a chart says.

use super::{Curve, Measured, WorkPrecision};
use crate::mechanism::Method;

/// Errors for which one candidate is the best.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Band {
    /// The largest of them.
    pub from: f64,
    /// The smallest.
    pub to: f64,
    /// The candidate's name.
    pub best: String,
}

/// A candidate that is that much dearer than the best is as good: bands do not change for less.
const AS_GOOD: f64 = 1.2;
/// Errors that bands begin and end with, and of which a decade has so many; what is finer is decided by rounding.
const COARSEST: f64 = 1e-1;
const FINEST: f64 = 1e-14;
const PER_DECADE: i32 = 2;
/// The errors of the table.
pub(super) const TARGETS: [f64; 3] = [1e-3, 1e-6, 1e-9];

impl WorkPrecision {
    /// The curve of this name.
    pub fn curve(&self, name: &str) -> Option<&Curve> {
        self.curves.iter().find(|curve| curve.name == name)
    }

    /// The least cost at an error, and whose it is; `auto` is somebody else's.
    pub fn best(&self, error: f64, cost: impl Fn(&Measured) -> f64 + Copy) -> Option<(&str, f64)> {
        let own = self.curves.iter().filter(|curve| curve.name != Method::Auto.name());
        let found = own.filter_map(|curve| Some((curve.name.as_str(), curve.at(error, cost)?)));
        found.min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Who is the best at which errors, from large ones to small ones.
    pub fn bands(&self, cost: impl Fn(&Measured) -> f64 + Copy) -> Vec<Band> {
        let mut bands: Vec<Band> = Vec::new();
        for k in 0.. {
            let error = COARSEST * 10f64.powf(-f64::from(k) / f64::from(PER_DECADE));
            let is_known = error >= self.reference.floor().max(FINEST);
            let Some((best, least)) = self.best(error, cost).filter(|_| is_known) else { break };
            if let Some(band) = bands.last_mut() {
                let still = self.curve(&band.best).and_then(|curve| curve.at(error, cost));
                if still.is_some_and(|cost| cost <= AS_GOOD * least) {
                    band.to = error;
                    continue;
                }
            }
            bands.push(Band { from: error, to: error, best: best.to_owned() });
        }
        bands
    }

    /// Which candidate to take for which errors, and what the others cost.
    pub fn sentence(&self) -> String {
        let work = self.bands(|point| point.cost);
        let time = self.bands(|point| point.seconds);
        if work.is_empty() {
            return "No candidate comes below an error of 0.1.".to_owned();
        }
        let names = |bands: &[Band]| bands.iter().map(|band| band.best.clone()).collect::<Vec<_>>();
        let mut text = if names(&work) == names(&time) {
            format!("By work and by time {}.", advice(&work))
        } else {
            format!("By work {}. By time {}.", advice(&work), advice(&time))
        };
        let reached = |target: &&f64| self.best(**target, |point| point.cost).is_some();
        let Some(target) = TARGETS[1..].iter().find(reached).or(TARGETS.first()) else { return text };
        let Some((best, least)) = self.best(*target, |point| point.cost) else { return text };
        let others = self.curves.iter().filter(|curve| curve.name != best);
        let (mut costs, mut short) = (Vec::new(), Vec::new());
        for curve in others {
            match curve.at(*target, |point| point.cost) {
                Some(cost) => costs.push((cost / least, curve.name.as_str())),
                None => short.push(curve.name.as_str()),
            }
        }
        costs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let ratios: Vec<String> = costs.iter().map(|(ratio, name)| format!("{name} {ratio:.1}")).collect();
        text += &format!(" An error of {target:.0e} costs {best} {least:.0} evaluations");
        if !ratios.is_empty() {
            text += &format!("; times as many {}", ratios.join(", "));
        }
        if !short.is_empty() {
            text += &format!("; not reached by {}", short.join(", "));
        }
        text + "."
    }
}

/// `above 1e-4 take dopri5, below that dop853`.
fn advice(bands: &[Band]) -> String {
    let [.., last] = bands else { return String::new() };
    if bands.len() == 1 {
        return format!("take {}", last.best);
    }
    let mut text = String::new();
    for (index, pair) in bands.windows(2).enumerate() {
        let take = if index == 0 { "take " } else { "" };
        text += &format!("above {:.0e} {take}{}, ", pair[1].from, pair[0].best);
    }
    format!("{text}below that {}", last.best)
}
