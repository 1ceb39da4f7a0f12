//! The resolver: what model files mean, as numbers.

mod errors;
mod examples;
mod expressions;
mod integrals;
mod limits;
mod mechanics;
mod motions;
mod reading;
mod solids;
mod units;

use std::collections::HashMap;

use dalembert_symbolic::expr::{Id, Symbol, Tape};
use dalembert_symbolic::model::{Model, load};

/// A model without problems.
fn model(text: &str) -> Model {
    match load(text, &[]) {
        Ok(model) => model,
        Err(problems) => {
            let told: Vec<String> =
                problems.iter().map(|p| format!("{} {} ({}) at {:?}", p.code, p.message, p.help, p.place)).collect();
            panic!("{text}\n{}", told.join("\n"))
        }
    }
}

/// Values of coordinates, velocities and accelerations by name, of `t`, of inputs by name; parameters have their defaults.
#[derive(Clone, Default)]
struct At(HashMap<String, f64>);

impl At {
    fn new(values: &[(&str, f64)]) -> At {
        At(values.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
    }

    fn get(&self, name: &str, primes: usize) -> f64 {
        self.0.get(&format!("{name}{}", "'".repeat(primes))).copied().unwrap_or(0.0)
    }

    /// The values of expressions of a model.
    fn values(&self, model: &Model, ids: &[Id]) -> Vec<f64> {
        Tape::new(&model.graph, ids).evaluate(|symbol| match symbol {
            Symbol::Time => self.get("t", 0),
            Symbol::Coordinate(i) => self.get(&model.coordinates[i as usize].name, 0),
            Symbol::Speed(i) => self.get(&model.coordinates[i as usize].name, 1),
            Symbol::Acceleration(i) => self.get(&model.coordinates[i as usize].name, 2),
            Symbol::Input(i, order) => self.get(&model.inputs[i as usize].name, usize::from(order)),
            Symbol::Parameter(i) => model.parameters[i as usize].default,
            Symbol::State(j) => self.get(&model.states[j as usize].name, 0),
            Symbol::StateRate(j) => self.get(&model.states[j as usize].name, 1),
            Symbol::Memory(j) => self.get(&model.memory[j as usize].name, 0),
            Symbol::Mode(_) | Symbol::Reaction(_) | Symbol::Multiplier(_) | Symbol::Phase(_) | Symbol::Dummy(_) => {
                f64::NAN
            }
        })
    }

    /// The components of an expression in the words of the language.
    fn of(&self, model: &mut Model, text: &str) -> Vec<f64> {
        let ids = model.expression(text).unwrap_or_else(|problems| panic!("{text}: {problems:?}"));
        self.values(model, &ids)
    }
}

/// Close to 14 digits.
#[track_caller]
fn close(found: &[f64], wanted: &[f64]) {
    assert_eq!(found.len(), wanted.len(), "{found:?} {wanted:?}");
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= 1e-13 * b.abs().max(1.0), "{found:?} is not {wanted:?}");
    }
}
