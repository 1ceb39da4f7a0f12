//! What was found, drawn.

use super::found::Found;
use crate::show::{Axis, Chart, Figure, Series, has_units};

impl Found {
    /// What was wanted over time, as the motion that was found has it; of a fit the record's points beside it, and below what is left of them.
    pub fn figure(&self) -> Figure {
        let mut charts = Vec::new();
        match &self.fit {
            Some(fit) => {
                for ((name, values), left) in fit.record.columns.iter().zip(&fit.residuals) {
                    let marks = |label: &str, values: &[f64]| {
                        let points = fit.record.times.iter().copied().zip(values.iter().copied());
                        Series::marks(label, points.map(Some)).coloured(1)
                    };
                    charts.push(self.over_time(name).with(marks("record", values)));
                    let up = Axis::new(format!("residual of {name}"), self.run.unit(name));
                    charts.push(Chart::new("", self.time(), up).with(marks("", left)));
                }
            }
            None => charts.extend(self.reached.iter().map(|value| self.over_time(&value.name))),
        }
        Figure { charts, columns: 1 }
    }

    /// A model without units knows no seconds.
    fn time(&self) -> Axis {
        Axis::new("t", if has_units(&self.run.description) { "s" } else { "" })
    }

    fn over_time(&self, name: &str) -> Chart {
        let values = self.run.column(name).unwrap_or_default();
        let line = Series::line("motion", self.run.times.iter().copied().zip(values).map(Some));
        Chart::new("", self.time(), Axis::new(name, self.run.unit(name))).with(line)
    }
}
