//! Damping treated mode by mode (problem 34 c): diagonal, and proportional, beside what it is.

use std::io::Write;

use serde_json::Value;

use super::super::Problem;
use super::super::json::{number, object};
use crate::linear::{DiagonalDamping, Kind, Linearised, Mode, proportional_damping, short};

/// Commutators below this are rounding: normal modes decouple.
const DECOUPLED: f64 = 1e-12;

/// What is lost where damping is treated mode by mode.
pub struct Damping {
    /// ω (1/s) and ζ of the complex modes.
    exact: Vec<(f64, f64)>,
    /// C with what is off the diagonal left out.
    pub diagonal: DiagonalDamping,
    /// α (1/s) and β (s) that give the slowest and the fastest mode their decay rates.
    pub fitted: Option<(f64, f64)>,
}

impl Damping {
    /// `None` without damping, and where some mode does not oscillate and die out.
    pub fn new(linear: &Linearised, modes: &[Mode]) -> Option<Damping> {
        let plain = linear.gyroscopic().is_zero() && linear.circulatory().is_zero();
        if modes.is_empty() || !plain || !modes.iter().all(|mode| mode.kind == Kind::Damped) {
            return None;
        }
        let diagonal = linear.diagonal_damping().ok()?;
        let exact: Vec<(f64, f64)> = modes.iter().filter_map(|mode| Some((mode.omega, mode.zeta?))).collect();
        let fitted = proportional_damping(*exact.first()?, *exact.last()?).ok();
        Some(Damping { exact, diagonal, fitted })
    }

    /// The key `damping`.
    pub fn as_json(&self) -> (&'static str, Value) {
        let list = |values: Vec<Value>| Value::Array(values);
        let zeta = |zeta: &Option<f64>| zeta.map_or(Value::Null, number);
        let entries = [
            ("commutator", number(self.diagonal.commutator)),
            ("diagonal_error", number(self.diagonal.error)),
            ("diagonal_zeta", list(self.diagonal.zeta.iter().map(zeta).collect())),
            ("alpha", self.fitted.map_or(Value::Null, |f| number(f.0))),
            ("beta", self.fitted.map_or(Value::Null, |f| number(f.1))),
        ];
        ("damping", object(entries))
    }

    /// For people.
    pub fn table(&self, out: &mut dyn Write) -> Result<(), Problem> {
        if self.diagonal.commutator < DECOUPLED {
            writeln!(out, "damping: the undamped modes stay modes (C M^-1 K = K M^-1 C)")?;
            return Ok(());
        }
        if self.exact.len() > super::MOST_PRINTED {
            return Ok(());
        }
        writeln!(out, "damping treated mode by mode, against the complex modes above:")?;
        let text = |row: [&str; 4]| row.map(str::to_owned).to_vec();
        let mut rows = vec![text(["mode", "zeta", "diagonal", "alpha M + beta K"])];
        for (index, (omega, zeta)) in self.exact.iter().enumerate() {
            let diagonal = self.diagonal.zeta.get(index).copied().flatten().map_or("-".to_owned(), short);
            let fitted =
                self.fitted.map_or("-".to_owned(), |(alpha, beta)| short(0.5 * (alpha / omega + beta * omega)));
            rows.push(vec![(index + 1).to_string(), short(*zeta), diagonal, fitted]);
        }
        super::report::columns(&rows, out)?;
        if let Some((alpha, beta)) = self.fitted {
            writeln!(
                out,
                "  (alpha = {} 1/s, beta = {} s, fitted to the first and the last)",
                short(alpha),
                short(beta)
            )?;
        }
        let advice = if self.diagonal.error > 0.01 { ": use the complex modes" } else { "" };
        let error = 100.0 * self.diagonal.error;
        writeln!(out, "  what the diagonal leaves out changes the shapes by about {} %{advice}", short3(error))?;
        Ok(())
    }
}

fn short3(x: f64) -> String {
    short(format!("{x:.1e}").parse().unwrap_or(x))
}
