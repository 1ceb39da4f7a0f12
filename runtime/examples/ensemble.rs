//! A thousand throws with drag that differ a little: how far do they scatter?

use dalembert::ensemble::{Ensemble, f64x4};
use dalembert::prelude::*;

dalembert::model!(
    yaml = r#"
name: Scatter
about: A ball with drag, followed for a second.
parameters: {m: 2 kg, b: 0.5 N*s/m, g: 10 m/s^2, v0: 10 m/s, angle: 45 deg}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: "[x, y]"}}
gravity: [0, -g]
forces: {drag: {on: ball, force: -b*velocity(ball)}}
scene: {start: {x: 0, y: 0, x': v0*cos(angle), y': v0*sin(angle)}, until: 1, tolerance: 1e-9}
"#
);

fn main() {
    let count = 1000;
    // Speeds evenly from 9 m/s to 11 m/s.
    let throw = |k: u32| Scatter { v0: 9.0 + 2.0 * f64::from(k) / f64::from(count - 1), ..Scatter::default() };
    let ends = (0..count).map(|k| throw(k).simulate()).collect::<Ensemble<_>>().ends::<f64x4>();
    // A run that fails is an error of its own; the others are there.
    let places: Vec<f64> = ends.iter().flatten().map(|end| end.state["x"]).collect();
    let (near, far) = (places[0], places[places.len() - 1]);
    println!("{} of {count} runs end between x = {near:.6} m and {far:.6} m", places.len());
    // The range is proportional to the speed, as the drag is.
    assert!((far / near - 11.0 / 9.0).abs() < 1e-9);
}
