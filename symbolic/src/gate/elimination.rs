//! The motion at a state by elimination, where M is not formed.

use super::motion::Incomplete;
use super::state::State;
use crate::derive::Equations;
use crate::derive::elimination::Eliminated;
use crate::expr::{Graph, Measured, Symbol, Tape};
use crate::number::DoubleDouble;

/// A pivot that is no more than this of what it would be if nothing had been subtracted is none.
const NOTHING: f64 = 1e-22;
/// The unit of rounding of `f64`.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// Accelerations by elimination, ready to evaluate anywhere, and F.
pub(super) struct Elimination {
    n: usize,
    /// Accelerations, then pairs of a pivot and what it must not be negligible against.
    accelerations: Tape,
    /// Whose pivots these are.
    pivots: Vec<usize>,
    residual: Tape,
}

impl Elimination {
    pub fn new(graph: &Graph, eliminated: &Eliminated, equations: &Equations) -> Elimination {
        let (own, solution) = &eliminated.solved;
        Elimination {
            n: equations.residual.len(),
            accelerations: Tape::new(own, &solution.roots()),
            pivots: solution.pivots.iter().map(|pivot| pivot.0).collect(),
            residual: Tape::new(graph, &equations.residual),
        }
    }

    /// Operations of one evaluation.
    pub fn work(&self) -> usize {
        self.accelerations.operations()
    }

    /// Fills in the accelerations of a state that has all else.
    ///
    /// Rounding does in double-double what it does in `f64`, in its own unit: how far accelerations in `f64` are off tells the scale of
    /// their errors, but for chance, which is nothing beside twenty digits.
    pub fn complete(&self, state: &mut State) -> Result<(), Incomplete> {
        let values = self.accelerations.evaluate(|s| state.value(s));
        let (a, tests) = values.split_at(self.n);
        let vanishes = |pair: &[DoubleDouble]| pair[0].to_f64().abs() <= NOTHING * pair[1].to_f64().abs();
        let without = self.pivots.iter().zip(tests.chunks_exact(2)).filter(|(_, pair)| vanishes(pair));
        let coordinates: Vec<usize> = without.map(|(i, _)| *i).collect();
        if !coordinates.is_empty() {
            return Err(Incomplete::Singular { rank: self.n - coordinates.len(), coordinates });
        }
        if a.iter().any(|a| !a.is_finite()) {
            return Err(Incomplete::NotFinite);
        }
        let short = self.accelerations.evaluate(|s| state.value(s).to_f64());
        let measured = |(a, short): (&DoubleDouble, &f64)| {
            let (size, off) = (a.to_f64().abs(), (*a - DoubleDouble::from(*short)).abs().to_f64());
            let off = if off.is_finite() { off } else { size };
            Measured { value: *a, magnitude: size.max(off / UNIT) }
        };
        state.a = a.iter().zip(&short).map(measured).collect();
        Ok(())
    }

    /// The accelerations in `f64`: false where there are none.
    pub fn roughly(&self, value: impl Fn(Symbol) -> f64, (scratch, values): (&mut Vec<f64>, &mut Vec<f64>)) -> bool {
        values.resize(self.accelerations.len(), 0.0);
        self.accelerations.run(value, scratch, values);
        let has_pivot = |pair: &[f64]| pair[0].abs() > 4.0 * f64::EPSILON * pair[1].abs();
        values[self.n..].chunks_exact(2).all(has_pivot) && values[..self.n].iter().all(|a| a.is_finite())
    }

    /// What F has of M among some coordinates, row by row.
    pub fn masses_among<const N: usize>(&self, state: &State, coordinates: [usize; N]) -> [[f64; N]; N] {
        let under = |moving: Option<usize>| {
            self.residual.evaluate(|s| match s {
                Symbol::Acceleration(i) => DoubleDouble::from(f64::from(u8::from(Some(i as usize) == moving))),
                _ => state.value(s),
            })
        };
        let rest = under(None);
        let columns = coordinates.map(|j| under(Some(j)));
        coordinates.map(|i| std::array::from_fn(|k| (columns[k][i] - rest[i]).to_f64()))
    }
}

#[cfg(test)]
mod tests {
    use crate::derive::{derive, derive_with_masses};
    use crate::gate::motion::Motion;
    use crate::gate::state::State;
    use crate::model::load;
    use crate::random::Random;

    /// By elimination and by M; the errors by elimination are no larger, and cover what the two differ by.
    #[test]
    fn accelerations_and_their_errors_are_those_by_masses() {
        let load = || load(include_str!("../../../models/chain.yaml"), &[("n".to_owned(), 30)]).unwrap();
        let mut random = Random::new();
        let [eliminated, formed] =
            [derive(load()), derive_with_masses(load())].map(Result::unwrap).map(|mut derivation| {
                let own = (&derivation.equations[0], derivation.eliminated.as_ref());
                Motion::new(&mut derivation.model, own, &derivation.rows, &derivation.switches)
            });
        for _ in 0..5 {
            let mut states = [State::at_rest(vec![1.0, 1.5, 9.0], 30), State::at_rest(vec![1.0, 1.5, 9.0], 30)];
            for i in 0..30 {
                let [q, v] = [3.0, 1.0].map(|reach: f64| random.between(-reach, reach).into());
                states.iter_mut().for_each(|state| (state.q[i], state.v[i]) = (q, v));
            }
            assert!(eliminated.complete(&mut states[0]).is_ok() && formed.complete(&mut states[1]).is_ok());
            let [first, second] = &states;
            for (a, b) in first.a.iter().zip(&second.a) {
                assert!((a.value - b.value).abs().to_f64() < 1e-22 * a.magnitude, "{a:?} {b:?}");
                assert!(a.magnitude < 10.0 * b.magnitude, "{a:?} {b:?}");
            }
        }
    }
}
