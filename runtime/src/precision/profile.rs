//! Many scenes in one chart.

use super::WorkPrecision;
use crate::show::{Axis, Chart, Series};

/// A performance profile (Dolan and Moré, Math. Program. 91, 2002): for each candidate, in which part of all scenes it costs at
/// most so many times as much as the best one there.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Profile {
    /// The error that is to be reached.
    pub error: f64,
    /// How many scenes there are.
    pub scenes: usize,
    /// Ratios to the best, where a candidate reached it.
    ratios: Vec<(String, Vec<f64>)>,
}

/// What a failure counts in the mean.
const FAILURE: f64 = 100.0;

impl Profile {
    /// A profile without scenes.
    pub fn new(error: f64) -> Profile {
        Profile { error, scenes: 0, ratios: Vec::new() }
    }

    /// One scene more; nothing where no candidate reaches the error.
    pub fn add(&mut self, scene: &WorkPrecision) {
        let Some((_, least)) = scene.best(self.error, |point| point.cost) else { return };
        self.scenes += 1;
        for curve in &scene.curves {
            let Some(cost) = curve.at(self.error, |point| point.cost) else { continue };
            match self.ratios.iter_mut().find(|(name, _)| *name == curve.name) {
                Some((_, ratios)) => ratios.push(cost / least),
                None => self.ratios.push((curve.name.clone(), vec![cost / least])),
            }
        }
    }

    /// The candidates with the geometric means of their ratios, a failure counting 100, the best first.
    pub fn means(&self) -> Vec<(&str, f64)> {
        let mean = |ratios: &[f64]| {
            let failed = (self.scenes - ratios.len()) as f64 * FAILURE.ln();
            ((ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() + failed) / self.scenes.max(1) as f64).exp()
        };
        let mut means: Vec<(&str, f64)> =
            self.ratios.iter().map(|(name, ratios)| (name.as_str(), mean(ratios))).collect();
        means.sort_by(|a, b| a.1.total_cmp(&b.1));
        means
    }

    /// The chart: parts of the scenes over ratios.
    pub fn chart(&self) -> Chart {
        let ratio = Axis::new("work beside the least", "").log();
        let mut chart = Chart::new(
            format!("Scenes done to {:.0e}", self.error),
            Axis { range: Some((1.0, FAILURE)), ..ratio },
            Axis { range: Some((0.0, 1.0)), ..Axis::new("part of the scenes", "") },
        );
        for (name, _) in self.means() {
            let Some((_, ratios)) = self.ratios.iter().find(|(known, _)| known == name) else { continue };
            let mut sorted = ratios.clone();
            sorted.sort_by(f64::total_cmp);
            let mut part = 0.0;
            let mut points = vec![Some((1.0, 0.0))];
            for ratio in sorted {
                points.push(Some((ratio.min(FAILURE), part)));
                part += 1.0 / self.scenes as f64;
                points.push(Some((ratio.min(FAILURE), part)));
            }
            points.push(Some((FAILURE, part)));
            chart.series.push(Series::line(name, points));
        }
        chart
    }
}
