//! In which measure deviations are told.
//!
//! They are compared in parts of ranges; one of what is wanted to an amount is compared in parts of that amount over `within`, so that
//! `within` is the limit of all.  That is neither a part of a range nor an amount.  So where an amount is asked for, all are told in parts
//! of what is asked for: 1 is as far off as may be.

use super::{Law, Need, Needs, Prediction};

impl Need {
    /// A deviation as it is told.
    pub(crate) fn told(&self, deviation: f64) -> f64 {
        deviation / self.unit()
    }

    /// A prediction as it is told.
    pub(crate) fn told_prediction(&self, predicted: Prediction) -> Prediction {
        let law = match predicted.law {
            Law::Stiff { gap, vibration } => Law::Stiff { gap, vibration: self.told(vibration) },
            law => law,
        };
        Prediction { change: self.told(predicted.change), law }
    }

    /// In parts of what deviations are told.
    pub(crate) fn measure(&self) -> &'static str {
        if self.absolute.is_empty() { "the range" } else { "what is asked for" }
    }

    /// What is told as 1.
    fn unit(&self) -> f64 {
        if self.absolute.is_empty() { 1.0 } else { self.within }
    }
}

impl Needs {
    /// All that is wanted, and how exactly, in words.
    pub(super) fn wanted(&self) -> String {
        let need = &self.need;
        let relative: Vec<&str> =
            need.outputs.iter().filter(|name| self.amount(name).is_none()).map(String::as_str).collect();
        let parts = (!relative.is_empty())
            .then(|| format!("{} within {:.1e} of the range of each", relative.join(", "), need.within));
        let amounts = need.absolute.iter().map(|(name, amount)| format!("{name} within {}", self.size(*amount, name)));
        parts.into_iter().chain(amounts).collect::<Vec<_>>().join(", ")
    }

    /// `4.3e-4 of swing`; `1.1e-3 m of the 5.0e-3 m asked of load_x`.
    pub(super) fn off(&self, deviation: f64, of: &str) -> String {
        let told = self.need.told(deviation);
        match self.amount(of) {
            Some(amount) => format!("{} of the {} asked of {of}", self.size(told * amount, of), self.size(amount, of)),
            None if self.need.absolute.is_empty() => format!("{} of {of}", part(told)),
            None => format!("{} of what is asked of {of}", part(told)),
        }
    }

    /// By which amount something may be off; `None` where that is a part of its range.
    fn amount(&self, of: &str) -> Option<f64> {
        self.need.absolute.iter().find(|(name, _)| name == of).map(|(_, amount)| *amount)
    }

    /// `5.0e-3 m`.
    fn size(&self, size: f64, of: &str) -> String {
        let unit = self.need.outputs.iter().zip(&self.units).find(|(name, _)| *name == of);
        format!("{} {}", part(size), unit.map_or("", |(_, unit)| unit)).trim_end().to_owned()
    }
}

/// A part of something.
pub(super) fn part(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}
