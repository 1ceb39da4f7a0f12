//! What an input moves is moved as by the same function of t in the file.

use dalembert::Method;

use super::case;

/// A block on a spring that a table of an input carries, as a contact or constraints and phases say, with another input beside it.
fn carried((w, k, a): (f64, f64, f64), held: &str) -> String {
    format!(
        "name: Carried\nparameters: {{m: 1 kg, g: 9.81 m/s^2, A: {a} m, w: {w} 1/s, k: {k} N/m}}\ncoordinates: {{y: m, z: m}}\n\
         inputs: {{u: A*sin(w*t), f: g*cos(w*t)}}\n\
         bodies: {{b: {{mass: m, position: \"[0, y]\"}}, c: {{mass: m, position: \"[z, 0]\"}}}}\n\
         forces: {{push: {{on: c, force: \"[m*f, 0]\"}}}}\ngravity: [0, -g]\n\
         springs: {{s: {{stretch: y, stiffness: k, on: b, along: \"[0, 1]\"}}}}\n{held}\n\
         scene: {{start: {{y: 0, y': A*w}}, until: 0.02}}\n"
    )
}

/// The rate of its reaction contains u''', which no input has: taken as 0 it led the search for the zero astray.
#[test]
fn what_an_input_carries_leaves_where_its_reaction_vanishes() {
    let contact = "contacts: {lift: {gap: y - u, on: b, normal: \"[0, 1]\"}}";
    let phases = "constraints: {c: y - u}\nphases: {held: [c], flight: []}\n\
                  events: {lift: {phase: held, when: reaction(c), direction: falling, then: flight}}";
    for (w, k, a) in [(60.0_f64, 50.0, 0.01_f64), (68.3, 86.1, 0.00363), (162.0, 32.8, 0.0132)] {
        // m (u'' + g) + k u = 0.
        let expected = (9.81 / (a * (w * w - k))).asin() / w;
        for held in [contact, phases] {
            for (method, tolerance) in [(Method::Dop853, 1e-6), (Method::Dop853, 1e-10), (Method::Dopri5, 1e-8)] {
                let mut case = case(&carried((w, k, a), held));
                (case.settings.method, case.settings.tolerance) = (method, tolerance);
                let run = case.run();
                let lifts = run.events.iter().filter(|event| event.name.starts_with("lift"));
                let times: Vec<f64> = lifts.map(|event| event.state.t).filter(|t| *t > 0.0).collect();
                let right = matches!(times[..], [t] if (t - expected).abs() < 1e-9);
                assert!(right, "{held} {w} {method:?} {tolerance}: {times:?}, {expected}");
            }
        }
    }
}

/// Where it slips the spring and its inertia need all of the friction; short of that nothing agreed with the forces.
#[test]
fn a_block_slips_on_a_base_of_an_input_where_friction_is_at_its_limit() {
    let (amplitude, stiffness) = (0.2, 28.0);
    for (w, limit) in [(6.0_f64, 2.0_f64), (7.0, 3.0), (7.0, 4.0), (8.0, 5.0)] {
        let run = case(&format!(
            "name: Rubbed\nparameters: {{m: 1 kg, A: {amplitude} m, w: {w} 1/s, F: {limit} N, k: {stiffness} N/m}}\n\
             coordinates: {{x: m}}\ninputs: {{u: A*sin(w*t)}}\nbodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\n\
             springs: {{s: {{stretch: x, stiffness: k, on: b, along: \"[1, 0]\"}}}}\n\
             friction: {{rub: {{rate: x' - u', limit: F}}}}\nscene: {{start: {{x: -0.1}}, until: 6, tolerance: 1e-10}}\n"
        ))
        .run();
        let slips: Vec<_> = run.events.iter().filter(|event| event.name == "rub slips").collect();
        assert!(!slips.is_empty(), "{w} {limit}: {:?}", run.events);
        for slip in slips {
            let needs = stiffness * slip.state["x"] - amplitude * w * w * (w * slip.state.t).sin();
            assert!((needs.abs() - limit).abs() < 1e-7, "{w} {limit}: {needs} at {}", slip.state.t);
        }
    }
}
