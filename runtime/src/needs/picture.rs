//! Error against work: a point for every rung.

use super::{Needs, Proposal, Rung};
use crate::show::{Axis, Chart, Series, Style};

/// Points that are listed by name.
const LISTED: usize = 14;
/// What changes less is drawn here.
const LEAST: f64 = 1e-12;

impl Needs {
    /// What leaving out each ingredient changes against the work that is left: what serves is below the dashed line, and what saves
    /// most to the left.  The rest of more than fourteen has no names.
    pub fn chart(&self) -> Chart {
        let place = |rung: &Rung| {
            let change = rung.deviation.as_ref()?.largest.max(LEAST);
            (rung.saving > 0.0 && change.is_finite()).then(|| (self.exact_operations / rung.saving, change))
        };
        let drawn: Vec<(&Rung, (f64, f64))> =
            self.rungs.iter().filter_map(|rung| place(rung).map(|place| (rung, place))).collect();
        let ends = drawn.iter().map(|(_, place)| place.0).chain([self.exact_operations]);
        let (least, most) = ends.fold((f64::INFINITY, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)));
        let need = [least, most].map(|x| Some((x, self.need.within)));
        let axes = (Axis::new("operations", "").log(), Axis::new("change, in parts of ranges", "").log());
        let mut chart = Chart::new(format!("{}: what is left out", self.name), axes.0, axes.1)
            .with(Series { style: Style::Dashed, ..Series::line("what is asked for", need) });
        for (rung, place) in drawn.iter().take(LISTED) {
            chart = chart.with(Series::marks(short(rung), [Some(*place)]));
        }
        if drawn.len() > LISTED {
            chart = chart.with(Series::marks("others", drawn[LISTED..].iter().map(|(_, place)| Some(*place))));
        }
        chart
    }
}

/// `l held`, `forces.air`.
fn short(rung: &Rung) -> String {
    let name = rung.ingredient.strip_prefix("coordinates.").unwrap_or(&rung.ingredient);
    match &rung.proposal {
        Proposal::LeftOut => name.to_owned(),
        Proposal::Held { .. } => format!("{name} held"),
        Proposal::Slaved { .. } => format!("{name} following"),
        Proposal::Modes { kept, .. } => format!("{} in {kept} modes", name.split('[').next().unwrap_or(name)),
    }
}
