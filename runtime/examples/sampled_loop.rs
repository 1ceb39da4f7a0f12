//! A pendulum that a digital controller holds upright, twice: the file holds the torque between ticks, and a loop in Rust does.

use dalembert::prelude::*;

dalembert::model!(
    yaml = r#"
name: HeldByFile
parameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2, Kp: 20 N*m, Kd: 3 N*m*s}
coordinates: {theta: rad}                        # from the upward vertical
memory: {torque: 0 N*m}
bodies: {bob: {mass: m, position: "l*[sin(theta), cos(theta)]"}}
gravity: [0, -g]
generalized_forces: {theta: torque}
events: {tick: {every: 5 ms, then: {set: {torque: -Kp*theta - Kd*theta'}}}}
scene: {start: {theta: 0.1}, until: 2}
"#
);
dalembert::model!(
    yaml = r#"
name: HeldByHand
parameters: {m: 1 kg, l: 0.5 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
inputs: {torque: 0 N*m}
bodies: {bob: {mass: m, position: "l*[sin(theta), cos(theta)]"}}
gravity: [0, -g]
generalized_forces: {theta: torque}
scene: {start: {theta: 0.1}, until: 2}
"#
);

/// Calls a law with the state at every tick, and holds what it gives until the next one.
fn closed(law: impl Fn(&dalembert::State) -> f64) -> Result<f64, dalembert::Error> {
    let mut run = HeldByHand::default().simulate().tolerance(1e-12).by_hand()?;
    for _ in 0..400 {
        let torque = law(&run.state());
        run.set_input("torque", torque)?;
        run.advance(0.005)?;
    }
    Ok(run.state()["theta"])
}

fn main() -> Result<(), dalembert::Error> {
    let by_hand = closed(|state| -20.0 * state["theta"] - 3.0 * state["theta'"])?;
    let by_file = HeldByFile::default().simulate().tolerance(1e-12).run()?;
    assert!((by_file.last()["theta"] - by_hand).abs() < 1e-12);
    println!("theta = {by_hand}, held by {:?}", by_file.memory("torque"));
    Ok(())
}
