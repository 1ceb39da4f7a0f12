//! A controller that holds two rods upright on a cart, without the standard library and without a heap.
#![no_std]

#[rustfmt::skip]
mod cart;

pub use cart::Cart;

use dalembert::mechanism::{Equations, Real, SingularMass};

/// How long a force is held, s.
pub const TICK: f64 = 0.005;

/// Gains of x, theta1, theta2 and their rates, N/m, N/rad, N s/m, N s/rad: the linear-quadratic regulator of the upright place for ticks of 5 ms,
/// states weighted by 10, rates by 1, the force by 1/10.  A and B are those of `dalembert modes cart.yaml --state-space`.
const GAINS: [f64; 6] = [8.970_69, -107.430, 158.899, 11.041_4, 2.733_07, 18.298_6];

/// A state of the cart: x, theta1, theta2, and their rates.
#[derive(Clone, Copy, Debug)]
pub struct State<S> {
    /// m, rad, rad.
    pub q: [S; 3],
    /// m/s, rad/s, rad/s.
    pub v: [S; 3],
}

/// What reads a state at a tick, and says at once which force the motor has from the next tick on.
pub struct Controller<S: Real> {
    constants: <Cart as Equations<3, 0>>::Constants<S>,
    push: S,
}

impl<S: Real> Controller<S> {
    /// Of a cart with these parameters, at rest.
    pub fn new(cart: &Cart) -> Self {
        Controller { constants: Cart::constants(|_| cart.clone()), push: S::from_f64(0.0) }
    }

    /// The force from the next tick on, N, computed with where the cart will be then.
    ///
    /// # Errors
    /// Where the mass matrix has no inverse, which no state of the cart is.
    pub fn tick(&mut self, measured: State<S>) -> Result<S, SingularMass> {
        let ahead = step(&self.constants, self.push, measured, S::from_f64(TICK))?;
        let states = ahead.q.into_iter().chain(ahead.v);
        let zero = S::from_f64(0.0);
        self.push = -states.zip(GAINS).fold(zero, |sum, (x, gain)| sum + S::from_f64(gain) * x);
        Ok(self.push)
    }
}

/// The state after a time with a constant force: Runge and Kutta's step of order four.
///
/// # Errors
/// As [`Controller::tick`].
pub fn step<S: Real>(
    constants: &<Cart as Equations<3, 0>>::Constants<S>,
    push: S,
    from: State<S>,
    time: S,
) -> Result<State<S>, SingularMass> {
    let number = S::from_f64;
    let moved = |by: S, rates: &State<S>| State {
        q: core::array::from_fn(|i| from.q[i] + by * rates.q[i]),
        v: core::array::from_fn(|i| from.v[i] + by * rates.v[i]),
    };
    // The force, and its first and second derivatives.
    let inputs = [push, number(0.0), number(0.0)];
    let rates = |at: State<S>| {
        let mut a = [number(0.0); 3];
        Cart::accelerations(constants, number(0.0), &inputs, &at.q, &at.v, &mut a)?;
        Ok(State { q: at.v, v: a })
    };
    let half = number(0.5) * time;
    let first = rates(from)?;
    let second = rates(moved(half, &first))?;
    let third = rates(moved(half, &second))?;
    let fourth = rates(moved(time, &third))?;
    let mean = |of: fn(&State<S>) -> &[S; 3], i: usize| {
        let [a, b, c, d] = [&first, &second, &third, &fourth].map(|rates| of(rates)[i]);
        (a + number(2.0) * (b + c) + d) / number(6.0)
    };
    let mean = State { q: core::array::from_fn(|i| mean(|s| &s.q, i)), v: core::array::from_fn(|i| mean(|s| &s.v, i)) };
    Ok(moved(time, &mean))
}
