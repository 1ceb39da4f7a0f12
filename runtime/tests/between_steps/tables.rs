//! Points of tables inside events, and other jumps that nothing is written for.

use super::{BODY, coasting, particle};

/// A spike of this width in the middle of each period, and an event on its flanks, on the way from x = 0 at a speed of 1.
fn spikes(width: f64, argument: &str) -> usize {
    let mut case = coasting(&format!(
        "tables: {{p: {{points: [[0, 0], [0.5, 0], [{}, 1], [{}, 0], [1, 0]], smooth: 0, periodic: true}}}}
events: {{e: {{when: \"p({argument}) - 0.5\", then: record}}}}
scene: {{start: {{x': 1}}, until: 50}}",
        0.5 + width,
        0.5 + 2.0 * width,
    ));
    case.run().events.len()
}

#[test]
fn every_flank_of_a_narrow_table_is_an_event() {
    for width in [1e-4, 1e-7, 0.1] {
        assert_eq!((spikes(width, "x"), spikes(width, "t")), (100, 100), "{width}");
    }
    // Up to 20, past twenty spikes, and back past eight of them.
    assert_eq!(spikes(1e-4, "20*sin(x/20)"), 2 * (20 + 8));
}

#[test]
fn what_turns_back_within_a_spike_meets_it_as_often_as_it_does() {
    let mut case = particle(&format!(
        "{BODY}
tables: {{p: {{points: [[0, 0], [0.4999, 0], [0.5, 1], [0.5001, 0], [1, 0]], smooth: 0}}}}
springs: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}}}
events: {{e: {{when: \"p(x) - 0.5\", then: record}}}}
scene: {{start: {{x': 0.5}}, until: 30}}"
    ));
    // Up to 0.5 and back five times.
    assert_eq!(case.run().events.len(), 10);
}

/// A force towards x = 0 written with `atan2`, and one that is a saw tooth.
#[test]
fn jumps_of_arcs_are_located() {
    let mut towards = particle(&format!(
        "{BODY}\nforces: {{f: {{on: b, force: \"[-F*cos(atan2(0, x)), 0]\"}}}}\nscene: {{start: {{x: 1}}, until: 5}}"
    ));
    // Four parabolas of sqrt(2) each make a period.
    let late = 4.0 * 2.0_f64.sqrt() - 5.0;
    let run = towards.run();
    assert!((run.last().q[0] - (1.0 - 0.5 * late * late)).abs() < 1e-8, "{}", run.last().q[0]);
    let mut tooth = particle(&format!(
        "{BODY}\nforces: {{f: {{on: b, force: \"[-F*atan(tan(x)), 0]\"}}}}\nscene: {{start: {{x': 2}}, until: 20}}"
    ));
    // Within |x| < pi/2 x = 2 sin t; then the same from tooth to tooth, since the energy (pi/2)^2 < 4 carries it over each.
    let run = tooth.run();
    let over = (std::f64::consts::FRAC_PI_2 / 2.0).asin();
    let teeth = ((20.0 + over) / (2.0 * over)).floor();
    let exact = teeth * std::f64::consts::PI + 2.0 * (20.0 - teeth * 2.0 * over).sin();
    assert!((run.last().q[0] - exact).abs() < 1e-6, "{} and {exact}", run.last().q[0]);
}

/// An integral by quadrature whose integrand winds up with p.
#[test]
fn a_run_says_where_its_integrals_were_not_tried() {
    let with = |set: &str, p: f64| {
        let mut case = particle(&format!(
            "{BODY}
define: {{I: \"integral(cos(F*x*s)^2/(1 + s^2), s in 0..1)\"}}
potential_energy: k*I
scene: {{start: {{x: {p}}}, until: 0.1{set}}}"
        ));
        let run = case.run();
        run.warnings.iter().map(ToString::to_string).filter(|text| text.contains("integral(")).collect::<Vec<_>>()
    };
    assert!(with("", 1.0).is_empty());
    assert!(with("", 20.0).is_empty(), "a scene starts there, so that it was tried there");
    let mut case = particle(&format!(
        "{BODY}
define: {{I: \"integral(cos(F*x*s)^2/(1 + s^2), s in 0..1)\"}}
potential_energy: k*I
scene: {{start: {{x: 1}}, until: 0.1}}"
    ));
    case.settings.q[0] = 20.0;
    let run = case.run();
    let found: Vec<String> = run.warnings.iter().map(ToString::to_string).collect();
    assert!(found.iter().any(|text| text.contains("tried for `x` from -3 to 3; at 20")), "{found:?}");
}
