//! The angle at which a ball with drag flies farthest.

use dalembert::prelude::*;

dalembert::model!(
    yaml = r#"
name: Throw
about: A ball with drag, thrown at an angle.
parameters: {m: 2 kg, b: 0.5 N*s/m, g: 10 m/s^2, v0: 10 m/s, angle: 45 deg}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {drag: {on: ball, force: -b*velocity(ball)}}
events: {land: {when: y, direction: falling, then: stop}}
scene: {start: {x: 0, y: 0, x': v0*cos(angle), y': v0*sin(angle)}, until: 10, tolerance: 1e-12}
"#
);

fn main() -> Result<(), dalembert::Error> {
    let found = Throw::default().simulate().find().unknown("angle", 0.7).maximise("x").solve()?;
    println!("{:?}", found.values);
    assert!((found.values[0].value - 0.732_544_061_201_42).abs() < 1e-10);
    // Where it lands, with exact slopes by the parameters.
    let slopes = Throw::default().simulate().slopes(&["angle", "b"])?;
    println!("{:?} {:?}", slopes.get("x", "angle"), slopes.get("x", "b"));
    Ok(())
}
