//! A step of all lanes at once, by each of the methods that lanes know.

use super::Lanes;
use crate::integrate::{Control, DOP853, Dop853, NystromStage, RKN8, Stage, Term, stages};
use crate::mechanism::SingularMass;

/// [q, q'] of all lanes.
pub(super) type Block<S, const N: usize> = [[S; N]; 2];

/// The rate of a state at a time, or why there is none.
pub(super) trait Rate<S, const N: usize>:
    Fn(S, &Block<S, N>, &mut Block<S, N>) -> Result<(), SingularMass>
{
}

impl<S, F, const N: usize> Rate<S, N> for F where F: Fn(S, &Block<S, N>, &mut Block<S, N>) -> Result<(), SingularMass> {}

/// Where all lanes are, and the step that they try.
pub(super) struct Attempt<S, const N: usize> {
    pub y: Block<S, N>,
    /// What rounding took from y in the last step.
    pub carry: Block<S, N>,
    /// Rates over a step: the first at its start, that of [`Scheme::END`] at its end.
    pub stages: [Block<S, N>; STAGES],
    pub end: Block<S, N>,
    /// What the step adds, with what was left over from the one before.
    pub increment: Block<S, N>,
}

/// No method has more stages, the rate at the end included.
const STAGES: usize = DOP853.end_stage() + 1;

/// A method for lanes: the same coefficients, norm and control as one run by itself has.
pub(super) trait Scheme {
    const CONTROL: Control;
    /// The stage that is the rate at the end of a step; so many evaluations a step takes.
    const END: usize;

    /// The stages of a step of h seconds from t to `next`, its end and the rate there.
    fn attempt<S: Lanes, const N: usize>(
        step: &mut Attempt<S, N>,
        times: (S, S, S),
        rate: impl Rate<S, N>,
    ) -> Result<(), SingularMass>;

    /// The error of a step of h seconds; `unit` gives the error of a component that counts as 1.
    fn error<S: Lanes, const N: usize>(step: &Attempt<S, N>, h: S, unit: impl Fn(usize, usize) -> S) -> S;
}

impl<S: Lanes, const N: usize> Attempt<S, N> {
    pub fn new() -> Self {
        let zeros = [[S::from_f64(0.0); N]; 2];
        Attempt { y: zeros, carry: zeros, stages: [zeros; STAGES], end: zeros, increment: zeros }
    }

    /// Goes to the end of the step in those lanes where `takes` is not negative.
    pub fn take<X: Scheme>(&mut self, takes: S) {
        for half in 0..2 {
            for i in 0..N {
                let (y, end, carry) = (self.y[half][i], self.end[half][i], self.carry[half][i]);
                let left = self.increment[half][i] - (end - y);
                self.y[half][i] = takes.select_nonnegative(end, y);
                self.carry[half][i] = takes.select_nonnegative(left, carry);
                let rate = (self.stages[X::END][half][i], self.stages[0][half][i]);
                self.stages[0][half][i] = takes.select_nonnegative(rate.0, rate.1);
            }
        }
    }

    /// Σ aⱼkⱼ of one component.
    #[inline(always)]
    fn sum(&self, terms: &[Term], half: usize, i: usize) -> S {
        let product = |term: &Term| S::from_f64(term.value) * self.stages[term.stage][half][i];
        terms.iter().fold(S::from_f64(0.0), |sum, term| sum + product(term))
    }

    /// The end by what the step adds to one component, and by what was left over.
    #[inline(always)]
    fn end_by(&mut self, increment: S, half: usize, i: usize) {
        let increment = increment + self.carry[half][i];
        self.increment[half][i] = increment;
        self.end[half][i] = self.y[half][i] + increment;
    }

    /// kᵢ = f(t + cᵢh, y + h Σ aᵢⱼkⱼ).
    #[inline(always)]
    fn stage<const I: usize>(&mut self, (t, h): (S, S), rate: &impl Rate<S, N>) -> Result<(), SingularMass> {
        let mut argument = self.y;
        for (half, argument) in argument.iter_mut().enumerate() {
            for (i, argument) in argument.iter_mut().enumerate() {
                *argument = *argument + h * self.sum(Stage::<Dop853, I>::ROW, half, i);
            }
        }
        rate(t + S::from_f64(Stage::<Dop853, I>::NODE) * h, &argument, &mut self.stages[I])
    }

    /// gᵢ = a(t + cᵢh, q + cᵢh q' + h² Σ aᵢⱼgⱼ).
    #[inline(always)]
    fn nystrom_stage<const I: usize>(&mut self, (t, h): (S, S), rate: &impl Rate<S, N>) -> Result<(), SingularMass> {
        let mut argument = self.y;
        let node = S::from_f64(NystromStage::<I>::NODE) * h;
        for (i, place) in argument[0].iter_mut().enumerate() {
            *place = *place + (node * self.y[1][i] + h * h * self.sum(NystromStage::<I>::ROW, 1, i));
        }
        rate(t + node, &argument, &mut self.stages[I])
    }
}

impl Scheme for Dop853 {
    const CONTROL: Control = DOP853.control;
    const END: usize = DOP853.end_stage();

    fn attempt<S: Lanes, const N: usize>(
        step: &mut Attempt<S, N>,
        (t, h, next): (S, S, S),
        rate: impl Rate<S, N>,
    ) -> Result<(), SingularMass> {
        stages!(step.stage((t, h), &rate) for 1 2 3 4 5 6 7 8 9 10 11 below Self::END, from 1);
        for half in 0..2 {
            for i in 0..N {
                step.end_by(h * step.sum(DOP853.weights, half, i), half, i);
            }
        }
        rate(next, &step.end, &mut step.stages[Self::END])
    }

    fn error<S: Lanes, const N: usize>(step: &Attempt<S, N>, h: S, unit: impl Fn(usize, usize) -> S) -> S {
        let number = S::from_f64;
        let (higher, lower) = const { DOP853.estimate.terms() };
        let (mut five, mut three) = (number(0.0), number(0.0));
        for half in 0..2 {
            for i in 0..N {
                let steps = h / unit(half, i);
                let (higher, lower) = (steps * step.sum(higher, half, i), steps * step.sum(lower, half, i));
                five = five + higher * higher;
                three = three + lower * lower;
            }
        }
        let mean = number(1.0 / (2 * N).max(1) as f64);
        let both = (five + number(0.01) * three).max(number(f64::MIN_POSITIVE));
        five * (mean / both).sqrt()
    }
}

/// Dormand, El-Mikkawy and Prince's Nyström method, for separable mechanisms.
pub(super) struct Rkn8;

impl Scheme for Rkn8 {
    const CONTROL: Control = RKN8.control;
    const END: usize = RKN8.rows.len();

    fn attempt<S: Lanes, const N: usize>(
        step: &mut Attempt<S, N>,
        (t, h, next): (S, S, S),
        rate: impl Rate<S, N>,
    ) -> Result<(), SingularMass> {
        stages!(step.nystrom_stage((t, h), &rate) for 1 2 3 4 5 6 7 below Self::END, from 1);
        for i in 0..N {
            step.end_by(h * step.y[1][i] + h * h * step.sum(RKN8.places, 1, i), 0, i);
            step.end_by(h * step.sum(RKN8.speeds, 1, i), 1, i);
        }
        rate(next, &step.end, &mut step.stages[Self::END])
    }

    fn error<S: Lanes, const N: usize>(step: &Attempt<S, N>, h: S, unit: impl Fn(usize, usize) -> S) -> S {
        let number = S::from_f64;
        let [places, speeds] = RKN8.errors;
        let counts = number(RKN8.counts) * h;
        let mut squares = number(0.0);
        for i in 0..N {
            let place = counts * h * step.sum(places, 1, i) / unit(0, i);
            let speed = counts * step.sum(speeds, 1, i) / unit(1, i);
            squares = squares + place * place + speed * speed;
        }
        (squares * number(1.0 / (2 * N).max(1) as f64)).sqrt()
    }
}
