//! A pendulum that a digital controller holds upright: it looks every 5 ms, and holds its torque until it looks again.

use dalembert::prelude::*;

dalembert::model!(
    yaml = r#"
name: HeldUpright
parameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {theta: rad}                        # from the upward vertical
inputs: {torque: 0 N*m}
bodies: {bob: {mass: m, position: "l*[sin(theta), cos(theta)]"}}
gravity: [0, -g]
generalized_forces: {theta: torque}
scene: {start: {theta: 0.1}, until: 2}
"#
);

fn main() -> Result<(), dalembert::Error> {
    let mut run = HeldUpright::default().simulate().by_hand()?;
    for _ in 0..400 {
        let state = run.state();
        run.set_input("torque", -20.0 * state["theta"] - 3.0 * state["theta'"])?;
        run.advance(0.005)?;
    }
    assert!(run.state()["theta"].abs() < 1e-4);
    println!("{}", run.finish().trust());
    Ok(())
}
