//! Loops that ticks close: motions that ticks leave alone, and the nearest periods at which stability changes.

use super::{close, run, try_run, words};

const FREE: &str = "name: Free\nparameters: {m: 1 kg, k: 9 N/m, K: 2 N/m, c: 0.5 N*s/m, Ts: 0.1 s}\ncoordinates: {x: m, y: m}\n\
    memory: {u: 0 N}\nkinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*y^2/2\ngeneralized_forces: {x: u - c*x'}\n\
    events: {tick: {every: Ts, then: {set: {u: -K*x}}}}\nscene: {start: {x: 0.1}, until: 1}\n";

/// The threshold: largest |z| = 1 of expm(F T) J with F = [0 1 0; 0 −c 1; 0 0 0], J = [1 0 0; 0 1 0; −K 0 0], by mpmath's `eig` and `findroot` in
/// 30 digits.
#[test]
fn undamped_motions_that_ticks_leave_alone_have_no_thresholds() {
    let critical = 0.522_746_068_336_844_9;
    let found = run(FREE, &["--sampled"]);
    close(found["critical_periods"][0].as_f64().unwrap(), critical, 1e-13);
    assert!(found["least_periods"].is_null() && found["stable"] == false, "{found}");
    let alone: Vec<Vec<f64>> = serde_json::from_value(found["alone"].clone()).unwrap();
    assert_eq!(alone.len(), 2);
    close(alone[0][1].abs(), 3.0, 1e-14);
    let text = words(FREE, &["--sampled"]).unwrap();
    assert!(text.contains("whatever the period") && text.contains("s = 0 ± 3i 1/s"), "{text}");
    assert!(text.contains("some other |z| is 1 from a period of 0.5227460683 s"), "{text}");
    // Moved by the ticks and not seen, and seen and not moved: x then has z = 1 beside its own.
    for law in ["generalized_forces: {x: u - c*x', y: u}", "generalized_forces: {x: u - c*x' + k*y}"] {
        let found = run(&FREE.replace("generalized_forces: {x: u - c*x'}", law), &["--sampled"]);
        assert_eq!(found["alone"].as_array().unwrap().len(), 2, "{law}");
        close(found["critical_periods"][0].as_f64().unwrap(), critical, 1e-13);
        assert!(found["least_periods"].is_null(), "{law}");
    }
    // Both: the law adds to what nothing damps, whatever it does.
    let both = FREE.replace("{x: u - c*x'}", "{x: u - c*x', y: u}").replace("-K*x}", "-K*x - K*y}");
    assert_eq!(run(&both, &["--sampled"])["alone"].as_array().unwrap().len(), 0);
    // A mass that nothing holds is alone, too, twice at z = 1.
    let drifts = run(&FREE.replace("potential_energy: k*y^2/2\n", ""), &["--sampled"]);
    assert_eq!(drifts["alone"], serde_json::json!([[0.0, 0.0], [0.0, 0.0]]));
    close(drifts["critical_periods"][0].as_f64().unwrap(), critical, 1e-13);
}

/// Where a sampled pair passes −1 it parts, and one number is outside for a while: windows of instability 2 parts in 1000 wide, of a vibration of 89 rad/s
/// that is seen every 0.1 s.  Roots of largest |z| = 1 of expm(F T) J by mpmath's `eig` and `findroot` in 30 digits; a scan by steps of 10 µs has
/// none between them and 0.1 s.
#[test]
fn the_nearest_window_of_instability_is_found() {
    let text = "name: Flex\nparameters: {m: 1 kg, k: 4000 N/m, K: 2 N/m, B: 2 N*s/m, c: 0.05 N*s/m, Ts: 0.1 s}\n\
        coordinates: {x: m, y: m}\nmemory: {u: 0 N}\nkinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: k*(x - y)^2/2\n\
        dissipation: c*(x' - y')^2/2\ngeneralized_forces: {x: u}\nevents: {tick: {every: Ts, then: {set: {u: \"-K*y - B*y'\"}}}}\n\
        scene: {start: {x: 0.1}, until: 1}\n";
    let found = run(text, &["--sampled"]);
    close(found["critical_periods"][0].as_f64().unwrap(), 0.105_386_857_618_296_7, 1e-12);
    close(found["least_periods"][0].as_f64().unwrap(), 0.095_173_794_259_413_22, 1e-12);
}

/// An actuator of 1 ns beside a motion of hours: |z| by the loop's map in closed form in 50 digits.
#[test]
fn slow_loops_keep_their_digits_beside_fast_actuators() {
    let text = "name: Slow\nparameters: {m: 1 kg, K: 2e-6 N/m, B: 2e-4 N*s/m, c: 1e-4 N*s/m, Ts: 0.1 s, tau: 1e-9 s}\ncoordinates: {x: m}\n\
        states: {p: {unit: N, rate: (u - p)/tau}}\nmemory: {u: 0 N}\nkinetic_energy: m*x'^2/2\n\
        generalized_forces: {x: p - c*x'}\nevents: {tick: {every: Ts, then: {set: {u: \"-K*x - B*x'\"}}}}\n\
        scene: {start: {x: 0.1}, until: 1}\n";
    let found = run(text, &["--sampled"]);
    let z: Vec<Vec<f64>> = serde_json::from_value(found["z"].clone()).unwrap();
    close(z[0][0].hypot(z[0][1]), 0.999_985_004_962_541, 1e-15);
    close(found["critical_periods"][0].as_f64().unwrap(), 301.515_166_972_28, 1e-12);
}

/// Laws that are smooth though their parts are not have the slopes that they have beside the rest.
#[test]
fn smooth_laws_of_parts_that_are_not_have_their_slopes() {
    let z = |law: &str| run(&FREE.replace("u: -K*x}", &format!("u: \"{law}\"}}")), &["--sampled"])["z"].clone();
    let numbers = |law: &str| serde_json::from_value::<Vec<[f64; 2]>>(z(law)).unwrap();
    let plain = numbers("-K*x");
    for law in ["-K*max(0, x) - K*min(0, x)", "-K*abs(x)*sign(x)"] {
        for (found, expected) in numbers(law).iter().zip(&plain) {
            assert!((found[0] - expected[0]).hypot(found[1] - expected[1]) < 1e-11, "{law}: {found:?} {expected:?}");
        }
    }
    let refused = try_run(&FREE.replace("u: -K*x}", "u: \"-K*abs(x)\"}"), &["--sampled"]).unwrap_err();
    assert!(refused.contains("jumps or turns sharply"), "{refused}");
}

#[test]
fn laws_that_contain_time_beside_the_rest_only_are_refused() {
    let law = FREE.replace("u: -K*x}", "u: \"-K*x*(1 + phase)\"}").replace("memory:", "define: {phase: t/Ts}\nmemory:");
    let refused = try_run(&law, &["--sampled"]).unwrap_err();
    assert!(refused.contains("there is a rest, but beside it the equation of `u` depends on time"), "{refused}");
}
