//! Every derivation against the first one, and each one's M q'' + h against its own residual.

use super::sample::State;
use super::test::{Agreement, TOLERANCE, describe};
use crate::derive::Equations;
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Place, Problem};
use crate::expr::{Id, Tape};
use crate::model::Model;

/// What one derivation says of a state.
struct Numbers {
    residual: Vec<f64>,
    bias: Vec<f64>,
    /// M q'' + h.
    composed: Vec<f64>,
}

/// One derivation, ready to evaluate.
struct Probe<'a> {
    equations: &'a Equations,
    tape: Tape,
}

impl<'a> Probe<'a> {
    fn new(model: &Model, equations: &'a Equations) -> Self {
        let mass: Vec<Id> = equations.mass.iter().map(|e| e.2).collect();
        let tape = Tape::new(&model.graph, &[&equations.residual[..], &equations.bias, &mass].concat());
        Probe { equations, tape }
    }

    fn at(&self, state: &State) -> Numbers {
        let values = self.tape.evaluate(|s| state.value(s));
        let (residual, rest) = values.split_at(self.equations.residual.len());
        let (bias, mass) = rest.split_at(self.equations.bias.len());
        let mut composed = bias.to_vec();
        for ((i, j, _), m) in self.equations.mass.iter().zip(mass) {
            composed[*i] += m * state.a[*j];
            if i != j {
                composed[*j] += m * state.a[*i];
            }
        }
        Numbers { residual: residual.to_vec(), bias: bias.to_vec(), composed }
    }
}

/// Compares residuals and h between derivations, and M q'' + h with the residual within each.
pub(super) fn agreement(
    model: &Model,
    equations: &[Equations],
    states: &[State],
) -> Result<Vec<Agreement>, Box<Problem>> {
    let first = Probe::new(model, &equations[0]);
    let mut agreements = Vec::new();
    for (k, other) in equations.iter().enumerate() {
        let probe = Probe::new(model, other);
        let mut worst = 0.0_f64;
        for state in states {
            // Random accelerations: the residual must agree off the motion as well.
            let mut state = state.clone();
            state.a = state.v.iter().map(|v| 1.3 * v.cos()).collect();
            let (x, y) = (first.at(&state), probe.at(&state));
            let pairs = [(&x.residual, &y.residual), (&x.bias, &y.bias), (&x.residual, &y.composed)];
            for (a, b) in pairs {
                let scale = a.iter().chain(b).fold(f64::MIN_POSITIVE, |m, v| m.max(v.abs()));
                for (i, (a, b)) in a.iter().zip(b).enumerate() {
                    let difference = (a - b).abs() / scale;
                    if difference > TOLERANCE || difference.is_nan() {
                        let name = &model.coordinates[i].name;
                        let place = Place::default().key("bodies");
                        let by = format!("{:.3e}", (a - b).abs());
                        return Err(Box::new(verdicts::derivations_disagree(place, name, by, describe(model, &state))));
                    }
                    worst = worst.max(difference);
                }
            }
        }
        if k > 0 {
            let between = (equations[0].name.to_owned(), other.name.to_owned());
            agreements.push(Agreement { between, states: states.len(), worst });
        }
    }
    Ok(agreements)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::derive;
    use crate::expr::Rational;
    use crate::gate::Draws;
    use crate::model::load;

    /// Every entry of M, h and F of either derivation scaled, alone: all are refused.
    #[test]
    fn a_fault_in_one_entry_of_one_derivation_is_refused() {
        for text in
            [include_str!("../../../models/double_pendulum.yaml"), include_str!("../../../models/cart_pendulum.yaml")]
        {
            let derivation = derive(load(text, &[]).unwrap()).unwrap();
            let mut model = derivation.model.clone();
            let states: Vec<State> = {
                let mut draws = Draws::new(&derivation.model, &derivation.switches);
                (0..16).map(|_| draws.next(&[])).collect()
            };
            assert!(agreement(&model, &derivation.equations, &states).is_ok());
            for k in 0..derivation.equations.len() {
                let sizes = [&derivation.equations[k]].map(|e| [e.mass.len(), e.bias.len(), e.residual.len()])[0];
                for (part, size) in sizes.into_iter().enumerate() {
                    for (entry, factor) in (0..size).flat_map(|i| [(-1, 1), (0, 1), (1, 2)].map(|f| (i, f))) {
                        let mut altered = derivation.equations.clone();
                        let id = match part {
                            0 => &mut altered[k].mass[entry].2,
                            1 => &mut altered[k].bias[entry],
                            _ => &mut altered[k].residual[entry],
                        };
                        if *id == Id::ZERO {
                            continue;
                        }
                        let factor = model.graph.rational(Rational::new(factor.0, factor.1).unwrap());
                        *id = model.graph.mul(factor, *id);
                        assert!(agreement(&model, &altered, &states).is_err(), "{k} {part} {entry}");
                    }
                }
            }
        }
    }
}
