//! The motion of van der Pol's oscillator that repeats.

use dalembert::prelude::*;

dalembert::model!(
    yaml = r#"
name: Oscillator
about: Van der Pol's oscillator.
parameters: {mu: 1}
coordinates: {x: 1}
kinetic_energy: x'^2/2
potential_energy: x^2/2
generalized_forces: {x: mu*(1 - x^2)*x'}
scene: {start: {x: 2, x': 0}, until: 20, tolerance: 1e-12}
"#
);

fn main() -> Result<(), dalembert::Error> {
    let orbit = Oscillator::default().simulate().orbit().find()?;
    println!("period {} s, multipliers {:?}", orbit.period.value, orbit.whole());
    assert!((orbit.period.value - 6.663_286_859_323_13).abs() < 1e-11);
    assert!((orbit.whole()[0].log_abs - 8.596_950_636_038_052e-4_f64.ln()).abs() < 1e-9);
    assert!(orbit.is_stable());
    Ok(())
}
