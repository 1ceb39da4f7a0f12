//! Taylor's method by statements that are written out, beside the same by data.

use dalembert::mechanism::{Interpreted, Mechanism};
use dalembert::prelude::*;
use dalembert::{Run, Settings, simulate};
use dalembert_symbolic::lower::compile;

dalembert::model!("../models/double_pendulum.yaml", name = DoublePendulum, methods = "taylor");
dalembert::model!("../models/central_force.yaml", name = CentralForce, methods = "taylor");
dalembert::model!("../models/double_pendulum.yaml", name = Data, methods = "taylor as data");

/// A compiled model and its text.
macro_rules! model_of {
    ($name:ident, $text:ident, $yaml:tt) => {
        dalembert::model!(yaml = $yaml, name = $name, methods = "taylor");
        const $text: &str = $yaml;
    };
}

model_of!(
    Turned,
    TURNED,
    r#"
name: Turned
coordinates: {x: 1}
kinetic_energy: (1 + x^2/9)*x'^2/2
generalized_forces: {x: "-x - 0.1*(tan(x/4) + atan(x) + asin(x/9))"}
scene: {start: {x: 0.7}, until: 5}
"#
);
model_of!(
    Risen,
    RISEN,
    r#"
name: Risen
coordinates: {x: 1}
kinetic_energy: (1 + x^2/9)*x'^2/2
generalized_forces: {x: "-x - 0.1*(tanh(x) + ln(2 + x^2) + (1 + x^2)^1.7)"}
scene: {start: {x: 0.7}, until: 5}
"#
);
model_of!(
    Waved,
    WAVED,
    r#"
name: Waved
coordinates: {x: 1}
kinetic_energy: (1 + x^2/9)*x'^2/2
generalized_forces: {x: "-x - 0.1*(sinh(x/3) + exp(-x^2) + cos(t)/(3 + sin(t)))"}
scene: {start: {x: 0.7}, until: 5}
"#
);
model_of!(
    Rooted,
    ROOTED,
    r#"
name: Rooted
coordinates: {x: 1}
kinetic_energy: (1 + x^2/9)*x'^2/2
generalized_forces: {x: "-x - 0.1*(acos(x/9) + sqrt(1 + x^2)*cosh(x/2))"}
scene: {start: {x: 0.7}, until: 5}
"#
);
model_of!(
    Turning,
    TURNING,
    r#"
name: Turning
coordinates: {x: 1, y: 1}
kinetic_energy: (x'^2 + 2*y'^2 + x'*y'*cos(x - y))/2
generalized_forces: {x: "-x - 0.1*atan2(y, 3 + x^2)", y: "-y + 0.2*x/(2 + y^2)"}
scene: {start: {x: 0.7, y: -0.4}, until: 5}
"#
);

/// Whether the state's series is written out, and is finite.
fn is_written<M: Mechanism<N, C> + Default, const N: usize, const C: usize>() -> bool {
    let constants = M::constants::<f64>(|_| M::default());
    let mut state = vec![[0.0; 21]; 2 * N];
    state.iter_mut().enumerate().for_each(|(k, row)| row[0] = 0.3 + 0.1 * k as f64);
    M::expansion(&constants, &[], 0.0, 0.01, &mut state) && state.iter().flatten().all(|x| x.is_finite())
}

/// The end of a run of a compiled model, whose series is written out, beside that of the file that nobody compiled.
fn compare<M: Mechanism<N, C> + Default + 'static, const N: usize, const C: usize>(text: &str) {
    assert!(is_written::<M, N, C>(), "{text}");
    let run = |settings: &Settings, system: &mut dyn System| -> Run { simulate(system, settings).expect("a run") };
    let mut interpreted = Interpreted::new(compile(text, &[]).expect("a model"), text);
    let mut settings = Settings::new(&interpreted.scene(0));
    (settings.method, settings.tolerance, settings.until) = (Method::Taylor, 1e-13, settings.until.min(3.0));
    let mut compiled = dalembert::mechanism::Dynamic::new(M::default());
    let [one, other] = [run(&settings, &mut compiled), run(&settings, &mut interpreted)];
    for name in one.column_names() {
        let [one, other] = [&one, &other].map(|run| *run.column(&name).expect("a column").last().expect("a state"));
        assert!((one - other).abs() < 1e-10 * (1.0 + other.abs()), "{name} = {one}, {other}: {text}");
    }
    assert!(one.work.steps.abs_diff(other.work.steps) <= 1, "{text}");
}

#[test]
fn what_is_written_out_is_what_data_say() {
    let of = |name: &str| {
        std::fs::read_to_string(format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"))).expect("a model")
    };
    compare::<DoublePendulum, 2, 0>(&of("double_pendulum"));
    compare::<CentralForce, 2, 0>(&of("central_force"));
    assert!(!is_written::<Data, 2, 0>());
}

#[test]
fn every_function_is_written_out() {
    compare::<Turned, 1, 0>(TURNED);
    compare::<Risen, 1, 0>(RISEN);
    compare::<Waved, 1, 0>(WAVED);
    compare::<Rooted, 1, 0>(ROOTED);
    compare::<Turning, 2, 0>(TURNING);
}
