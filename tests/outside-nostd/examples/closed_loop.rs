//! The controller's loop around a cart that moves by the same equations, in `f32` and in `f64`, tick by tick.

use dalembert::mechanism::{Equations, Real, SingularMass};
use outside_nostd::{Cart, Controller, State, TICK, step};

fn main() -> Result<(), SingularMass> {
    let (single, double) = (closed_loop::<f32>()?, closed_loop::<f64>()?);
    for (tick, (single, double)) in single.into_iter().zip(double).enumerate() {
        let numbers = single.into_iter().chain(double).map(|x| format!(" {x:e}"));
        println!("{:.3}{}", tick as f64 * TICK, numbers.collect::<String>());
    }
    Ok(())
}

/// x, theta1, theta2 and the force at every tick of five seconds.
fn closed_loop<S: Real>() -> Result<Vec<[f64; 4]>, SingularMass> {
    let cart = Cart::default();
    let constants = Cart::constants(|_| cart.clone());
    let mut controller = Controller::<S>::new(&cart);
    let number = S::from_f64;
    let mut state = State { q: [0.0, 4.0_f64.to_radians(), 2.0_f64.to_radians()].map(number), v: [number(0.0); 3] };
    let mut push = number(0.0);
    let mut ticks = Vec::new();
    for _ in 0..=1000 {
        let [x, theta1, theta2] = state.q;
        ticks.push([x, theta1, theta2, push].map(|number| number.lane(0)));
        // It takes up to a tick to compute the force, which acts from the next one on.
        let next = controller.tick(state)?;
        for _ in 0..5 {
            state = step(&constants, push, state, number(TICK / 5.0))?;
        }
        push = next;
    }
    Ok(ticks)
}
