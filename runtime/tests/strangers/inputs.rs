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

/// A flight that is one step goes over several turns of the table.
#[test]
fn a_ball_lands_in_the_right_turn_of_a_table_of_an_input() {
    let mut ball = case(
        "name: Ball\nparameters: {m: 1 kg, g: 9.81 m/s^2, A: 0.02 m, w: 35 1/s, e: 0.3}\ncoordinates: {y: m}\n\
         inputs: {u: A*sin(w*t)}\nbodies: {b: {mass: m, position: \"[0, y]\"}}\ngravity: [0, -g]\n\
         contacts: {c: {gap: y - u, on: b, normal: \"[0, 1]\", restitution: e}}\n\
         scene: {start: {y: 0, y': A*w}, until: 1.5}\n",
    );
    for tolerance in [1e-7, 1e-10] {
        ball.settings.tolerance = tolerance;
        let run = ball.run();
        let lands = run.events.iter().filter(|event| event.name == "c lands").map(|event| event.state.t);
        let lands: Vec<f64> = lands.filter(|t| *t > 0.0).collect();
        // From asin(g/(A w²))/w on by parabolas, with 30 digits.
        let expected = [
            0.165581866874598,
            0.367290318389236,
            0.588116460398720,
            0.691209404483892,
            0.726025264817761,
            0.890103378715412,
            1.10258240121797,
            1.27876224818045,
            1.46258263590771,
        ];
        assert_eq!(lands.len(), expected.len(), "{lands:?}");
        assert!(lands.iter().zip(expected).all(|(t, expected)| (t - expected).abs() < 1e-9), "{lands:?}");
    }
}

/// What rests is asked for in steps as long as the run, whatever turns in an input.
#[test]
fn what_turns_in_an_input_is_seen_in_one_step() {
    let crossed = case(
        "name: Crossed\nparameters: {m: 1 kg, A: 1 m, w: 100 1/s}\ncoordinates: {x: m}\ninputs: {u: A*sin(w*t)}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\nevents: {over: {when: u - x, direction: rising, then: record}}\n\
         scene: {start: {x: 0.5}, until: 100}\n",
    )
    .run();
    // At (pi/6 + 2 pi n)/w.
    let turn = std::f64::consts::TAU;
    assert_eq!(crossed.events.len() as f64, ((1e4 - turn / 12.0) / turn).floor() + 1.0);
}

/// What sticks rests in steps as long as the run, whatever turns in the force that friction meets.
#[test]
fn what_turns_in_a_force_on_a_stuck_block_is_seen() {
    let turn = std::f64::consts::TAU;
    let pushed = case(
        "name: Pushed\nparameters: {m: 1 kg, F: 3 N, L: 2 N, w: 100 1/s}\ncoordinates: {x: m}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\nforces: {f: {on: b, force: \"[F*sin(w*t)^31, 0]\"}}\n\
         friction: {rub: {rate: x', limit: L}}\nscene: {start: {x: 0}, until: 1, tolerance: 1e-8}\n",
    )
    .run();
    // F sin^31 = L in every half turn.
    let slips = pushed.events.iter().filter(|event| event.name == "rub slips").map(|event| event.state.t);
    let slips: Vec<f64> = slips.collect();
    assert_eq!(slips.len() as f64, (100.0 / (0.5 * turn)).floor() + 1.0, "{slips:?}");
    for (k, t) in slips.into_iter().enumerate() {
        let expected = ((2.0_f64 / 3.0).powf(1.0 / 31.0).asin() + 0.5 * turn * k as f64) / 100.0;
        assert!((t - expected).abs() < 1e-9, "{t} {expected}");
    }
}
