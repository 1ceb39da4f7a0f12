//! Drives with phases: a rotating unbalance against closed forms and against runs from rest until all transients are gone.

use super::{C, answer, i, run};
use serde_json::Value;

/// An unbalanced rotor, m z'' + c z' − iG z' + k z = F e^(iΩt) with z = x + iy where both supports are alike.
fn rotor(along: f64, across: f64, gyroscopic: f64) -> String {
    format!(
        "name: Rotor\nparameters: {{m: 2 kg, c: 0.8 N*s/m, G: {gyroscopic} N*s/m, kx: {along} N/m, ky: {across} N/m, w: 3 rad/s, F: 5 N, a: 0 rad}}\n\
         coordinates: {{x: m, y: m}}\nkinetic_energy: m*(x'^2 + y'^2)/2\npotential_energy: kx*x^2/2 + ky*y^2/2\n\
         dissipation: c*(x'^2 + y'^2)/2\ninputs: {{ux: F*cos(w*t), uy: F*cos(w*t - pi/2 + a)}}\n\
         generalized_forces: {{x: ux - G*y', y: uy + G*x'}}\noutputs: {{twice: 2*x'}}\nscene: {{until: 250, tolerance: 1e-12}}\n"
    )
}

fn amplitude(found: &Value, name: &str) -> C {
    let pair = &found["steady"]["amplitude"][name];
    C::new(pair[0].as_f64().unwrap(), pair[1].as_f64().unwrap())
}

/// Rotating amplitudes: z = p e^(iΩt) + n e^(−iΩt), p = (X + iY)/2 and n = conj(X − iY)/2.
fn forward_and_backward(found: &Value) -> [f64; 2] {
    let (x, y) = (amplitude(found, "x"), amplitude(found, "y"));
    [(x + i(1.0) * y).norm() / 2.0, (x - i(1.0) * y).norm() / 2.0]
}

const UNBALANCE: &str = "ux=5, uy=5<-90";

/// Alike supports whirl forward only, with gyroscopic forces too; z = F/(k − mΩ² + GΩ + icΩ).
#[test]
fn alike_supports_whirl_forward_only() {
    for (gyroscopic, omega) in [(0.0, 3.0), (1.7, 3.0), (1.7, 0.4), (-1.7, 20.0), (400.0, 3.0)] {
        let found =
            run(&rotor(30.0, 30.0, gyroscopic), &["--drive", UNBALANCE, "--omega", &omega.to_string()]).unwrap();
        let exact = 5.0 / (C::from(30.0 - 2.0 * omega * omega + gyroscopic * omega) + i(0.8 * omega));
        let [forward, backward] = forward_and_backward(&found);
        assert!((amplitude(&found, "x") - exact).norm() < 1e-14 * exact.norm(), "{found}");
        assert!((forward - exact.norm()).abs() < 1e-14 * forward && backward < 1e-14 * forward, "{forward} {backward}");
        // The other way round it whirls backward, and meets G with the other sign.
        let found =
            run(&rotor(30.0, 30.0, gyroscopic), &["--drive", "ux=5,uy=5<90", "--omega", &omega.to_string()]).unwrap();
        let exact = 5.0 / (C::from(30.0 - 2.0 * omega * omega - gyroscopic * omega) + i(0.8 * omega));
        let [forward, backward] = forward_and_backward(&found);
        assert!((backward - exact.norm()).abs() < 1e-14 * backward && forward < 1e-14 * backward, "{found}");
    }
}

/// Unlike supports make an ellipse of it, which between the two critical speeds is run through backwards.
#[test]
fn unlike_supports_whirl_both_ways() {
    let alone = |k: f64, omega: f64| 5.0 / (C::from(k - 2.0 * omega * omega) + i(0.8 * omega));
    for (omega, backwards) in [(1.0, false), (4.5, true), (9.0, false)] {
        let found = run(&rotor(30.0, 50.0, 0.0), &["--drive", UNBALANCE, "--omega", &omega.to_string()]).unwrap();
        let (x, y) = (alone(30.0, omega), -i(1.0) * alone(50.0, omega));
        assert!((amplitude(&found, "x") - x).norm() < 1e-14 * x.norm(), "{found}");
        assert!((amplitude(&found, "y") - y).norm() < 1e-14 * y.norm(), "{found}");
        let [forward, backward] = forward_and_backward(&found);
        assert!(
            forward > 0.0 && backward > 1e-3 * forward && (backward > forward) == backwards,
            "{forward} {backward}"
        );
    }
}

/// The same amplitudes by a run of the full equations from rest, after more than 50 times constants, whatever the phase.
#[test]
fn a_run_ends_in_the_steady_state() {
    for (across, gyroscopic, phase) in [(30.0, 1.7, 0.0), (50.0, 1.7, 0.0), (50.0, 0.0, 0.9)] {
        let text = rotor(30.0, across, gyroscopic);
        let drive = format!("ux=F, uy=F<{} rad", phase - std::f64::consts::FRAC_PI_2);
        let found = run(&text, &["--drive", &drive, "--omega", "3"]).unwrap();
        let path =
            std::env::temp_dir().join(format!("dalembert-quadrature-{}-{phase}-{across}.yaml", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let mut out = Vec::new();
        let phase = format!("a={phase}");
        let asked = ["dalembert", "simulate", path.to_str().unwrap(), "--json", "--set", &phase];
        dalembert::cli::run(&[], asked, &mut out).unwrap();
        std::fs::remove_file(&path).unwrap();
        let end: Value = serde_json::from_slice(&out).unwrap();
        for name in ["x", "y"] {
            let steady = (amplitude(&found, name) * C::from_polar(1.0, 3.0 * 250.0)).re;
            let simulated = end["q"][name].as_f64().unwrap_or(f64::NAN);
            assert!((simulated - steady).abs() < 1e-10, "{name} {across} {phase}: {simulated} {steady}");
        }
    }
}

/// Rates, outputs and curves turn with the drive, and degrees, radians and expressions are one.
#[test]
fn phases_reach_all_answers() {
    let text = rotor(30.0, 50.0, 1.7);
    let asked = |drive: &str| {
        run(&text, &["--drive", drive, "--omega", "3", "--response", "x,twice,y'", "--range", "1..5"]).unwrap()
    };
    let found = asked("ux<30");
    assert_eq!(found["steady"]["drive"], "ux at 30 deg");
    let (plain, turn) = (asked("ux"), C::from_polar(1.0, 30.0_f64.to_radians()));
    for name in ["x", "twice", "y'"] {
        for ((omega, turned), (_, x)) in answer(&found, name).into_iter().zip(answer(&plain, name)) {
            assert!((turned - x * turn).norm() < 1e-12 * x.norm(), "{name} at {omega}");
        }
    }
    for same in ["ux<30 deg", "ux=1<pi/6", "ux<pi/6 rad", "ux<60/2"] {
        assert!((amplitude(&asked(same), "x") - amplitude(&found, "x")).norm() < 1e-14, "{same}");
    }
    // Half a turn is the opposite, and both together do nothing.
    assert_eq!(amplitude(&asked("ux=-1"), "x"), amplitude(&asked("ux<180"), "x"));
    for (wrong, told) in [("ux, ux<180", "does not act"), ("ux<", "--drive"), ("ux<3 m", "m"), ("ux<1<2", "--drive")] {
        let refused = run(&text, &["--drive", wrong, "--omega", "3"]).unwrap_err();
        assert!(refused.contains(told), "{wrong}: {refused}");
    }
}
