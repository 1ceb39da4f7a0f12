//! Forces across that the equations leave open: as springs share them that are alike at all contacts, in whatever order these stand.

use dalembert::{Error, Method, NoSlopes, Run, Warning};

use super::{case, folder, program, simulation};

/// A rod that slides on three supports, the mass at a distance from the middle one, its contacts in some order.
fn rod(mass_at: f64, order: [usize; 3]) -> String {
    let contacts = [("l", "A", "mu"), ("m", "B", "5*mu"), ("r", "C", "mu")];
    let contacts: Vec<String> = order
        .iter()
        .map(|k| contacts[*k])
        .map(|(name, at, mu)| format!("  {name}: {{gap: {at}.y, on: b, at: {at}, normal: '[0, 1]', friction: {mu}}}\n"))
        .collect();
    format!(
        "name: Rod\nparameters: {{m: 2 kg, a: 0.5 m, e: {mass_at} m, I: 0.2 kg*m^2, mu: 0.1 1, g: 9.81 m/s^2}}\n\
         coordinates: {{x: m, y: m, p: rad}}\ngravity: [0, -g]\nimpacts: together\n\
         bodies: {{b: {{mass: m, inertia: I, angle: p, position: '[x + e*cos(p), y + e*sin(p)]'}}}}\n\
         points: {{A: '[x, y] - a*b.x', B: '[x, y]', C: '[x, y] + a*b.x'}}\ncontacts:\n{}\
         outputs: {{L: reaction(l), M: reaction(m), R: reaction(r)}}\nscene: {{start: {{x': 3}}, until: 0.3}}\n",
        contacts.concat()
    )
}

fn told(run: &Run) -> Option<(Vec<String>, bool)> {
    run.warnings.iter().find_map(|warning| match warning {
        Warning::MotionNotUnique { constraints, as_springs } => Some((constraints.clone(), *as_springs)),
        _ => None,
    })
}

#[test]
fn three_supports_press_as_alike_springs_do() {
    let weight = 2.0 * 9.81;
    // Thirds, with a moment about the middle one; where that would draw at an end, the other two alone.
    for (mass_at, presses) in
        [(0.0, [1.0 / 3.0; 3]), (0.1, [7.0 / 30.0, 1.0 / 3.0, 13.0 / 30.0]), (0.4, [0.0, 0.2, 0.8])]
    {
        let [left, middle, right] = presses.map(|part| part * weight);
        let moved = 3.0 * 0.3 - 0.5 * 0.3 * 0.3 * (0.1 * (left + right) + 0.5 * middle) / 2.0;
        for order in [[0, 1, 2], [2, 1, 0], [1, 2, 0]] {
            let run = case(&rod(mass_at, order)).run();
            let last = run.last();
            let wrong = [("x", moved), ("L", left), ("M", middle), ("R", right)]
                .map(|(name, right)| (last[name] - right).abs());
            assert!(wrong.iter().all(|wrong| *wrong < 1e-12 * weight), "{mass_at} {order:?} {wrong:?} {last}");
            assert!(told(&run).is_some_and(|(contacts, as_springs)| contacts.len() == 3 && as_springs));
        }
    }
}

/// Two contacts of one gap stick until both are at their limits, each with half of the weight.
#[test]
fn two_contacts_of_one_gap_hold_half_each() {
    let block = |first: f64, second: f64| {
        format!(
            "name: Twice\nparameters: {{m: 2 kg, one: {first} 1, two: {second} 1, g: 9.81 m/s^2, r: 1 N/s}}\n\
             coordinates: {{x: m, y: m}}\ninputs: {{f: r*t}}\nbodies: {{b: {{mass: m, position: '[x, y]'}}}}\n\
             forces: {{pull: {{on: b, force: '[f, 0]'}}}}\ngravity: [0, -g]\nimpacts: together\n\
             contacts:\n  c1: {{gap: y, on: b, normal: '[0, 1]', friction: one}}\n  \
             c2: {{gap: y, on: b, normal: '[0, 1]', friction: two}}\nscene: {{until: 12}}\n"
        )
    };
    let slips: f64 = 0.3 * 2.0 * 9.81;
    for (one, two, is_open) in [(0.1, 0.5, true), (0.5, 0.1, true), (0.3, 0.3, false)] {
        let run = case(&block(one, two)).run();
        let times: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        assert!(times.len() == 2 && times.iter().all(|t| (t - slips).abs() < 1e-11), "{times:?}");
        assert!((run.last()["x"] - (12.0 - slips).powi(3) / 12.0).abs() < 1e-8, "{}", run.last());
        assert_eq!(told(&run).is_some(), is_open);
    }
    let mut case = case(&block(0.1, 0.5));
    case.settings.method = Method::Moreau;
    case.settings.step = Some(1e-2);
    assert_eq!(told(&case.run()), Some((vec!["c1".to_owned(), "c2".to_owned()], false)));
}

/// A bar on two feet that a couple twists stays until both are at their limits, μ m g a together.
#[test]
fn feet_that_are_twisted_share_the_weight() {
    let bar = |feet: [&str; 2]| {
        format!(
            "name: Twisted\nparameters: {{m: 8 kg, a: 0.5 m, mu: 0.3 1, r: 1 N*m/s, g: 9.81 m/s^2, I: 1 kg*m^2}}\n\
             coordinates: {{x: m, y: m, z: m, psi: rad}}\nframes: {{B: {{rotate: [z, psi]}}}}\ninputs: {{M: r*t}}\n\
             bodies: {{bar: {{mass: m, inertia: [I, I, 1.5*I], frame: B, position: '[x, y, z]'}}}}\ngravity: [0, 0, -g]\n\
             points: {{P: '[x, y, z] + a*B.x', Q: '[x, y, z] - a*B.x'}}\ntorques: {{tw: {{on: bar, torque: '[0, 0, M]'}}}}\n\
             contacts:\n  c1: {{gap: {0}.z, on: bar, at: {0}, normal: ground.z, friction: mu}}\n  \
             c2: {{gap: {1}.z, on: bar, at: {1}, normal: ground.z, friction: mu}}\nimpacts: together\nscene: {{until: 12}}\n",
            feet[0], feet[1]
        )
    };
    for feet in [["P", "Q"], ["Q", "P"]] {
        let run = case(&bar(feet)).run();
        let times: Vec<f64> = run.events.iter().map(|event| event.state.t).collect();
        let right = 0.3 * 8.0 * 9.81 * 0.5;
        assert!(times.len() == 2 && times.iter().all(|t| (t - right).abs() < 1e-9), "{times:?}");
        let turned = (12.0 - right).powi(3) / 9.0;
        assert!((run.last()["psi"] - turned).abs() < 1e-9, "{} {turned}", run.last());
    }
}

#[test]
fn a_motion_of_many_has_no_slopes() {
    let found = simulation(&rod(0.1, [0, 1, 2])).slopes(&["e"]);
    assert!(matches!(&found, Err(Error::NoSlopes(why)) if matches!(**why, NoSlopes::Shares { .. })), "{found:?}");
    let file = folder("shared").join("rod.yaml");
    std::fs::write(&file, rod(0.1, [0, 1, 2])).expect("a file");
    let told = program(&["modes", file.to_str().expect("a path"), "--at-time", "0.1 s"]).expect_err("a motion of many");
    assert!(told.contains("it depends on how `l`, `m`, `r` share a force"), "{told}");
}

/// A table on three or four legs that is pulled ever harder at its middle: all legs reach their limits together, and with nothing left over it begins
/// to slide along the pull (`chattering`, or steps without end, before).
#[test]
fn a_table_is_pulled_until_it_slides() {
    for (legs, sideways) in [(3, 0.0), (3, 0.3), (4, 0.3)] {
        let table = format!(
            "name: Table\nsizes: {{n: {legs}}}\nparameters: {{m: 8 kg, a: 0.5 m, h: 0.7 m, mu: 0.3 1, g: 9.81 m/s^2, I: 1 kg*m^2, r: 10 N/s}}\n\
             coordinates: {{x: m, y: m, z: m, q: rotation}}\ninputs: {{f: r*t}}\nframes: {{B: {{rotate: q}}}}\ngravity: [0, 0, -g]\n\
             bodies: {{tab: {{mass: m, inertia: [I, I, 1.5*I], frame: B, position: '[x, y, z]'}}}}\n\
             points: {{'L[i in 0..n-1]': '[x, y, z] + a*cos(pi/4+i*2*pi/n)*B.x + a*sin(pi/4+i*2*pi/n)*B.y - h*B.z'}}\n\
             forces: {{pull: {{on: tab, force: '[f, {sideways}*f, 0]'}}}}\nimpacts: together\n\
             contacts: {{'c[i in 0..n-1]': {{gap: 'L[i].z', on: tab, at: 'L[i]', normal: ground.z, friction: mu}}}}\n\
             scene: {{start: {{z: h}}, until: 3}}\n"
        );
        let run = case(&table).run();
        let (last, size) = (run.last(), f64::hypot(1.0, sideways));
        let slips = 0.3 * 8.0 * 9.81 / (10.0 * size);
        let moved = 10.0 / 8.0 * (3.0 - slips).powi(3) / 6.0;
        assert!((run.events[0].state.t - slips).abs() < 1e-11, "{legs}: {:?} {slips}", run.events);
        let wrong = [("x", moved), ("y", moved * sideways)].map(|(name, right)| (last[name] - right).abs());
        assert!(wrong.iter().all(|wrong| *wrong < 1e-9), "{legs} {sideways}: {wrong:?} {last}");
        assert!(run.work.steps < 100 && run.events.len() <= legs, "{:?} {:?}", run.work, run.events);
    }
}

/// A table that slides on four feet: only three of its heights and tilts are free, and which share the gate finds depends on the length of the
/// quaternion (E520 before).
#[test]
fn a_table_slides_on_four_feet() {
    let table = "name: Table\nsizes: {n: 4}\nparameters: {m: 8 kg, a: 0.5 m, h: 0.7 m, mu: 0.3 1, g: 9.81 m/s^2, I: 1 kg*m^2}\n\
        coordinates: {x: m, y: m, z: m, q: rotation}\nframes: {B: {rotate: q}}\ngravity: [0, 0, -g]\n\
        bodies: {tab: {mass: m, inertia: [I, I, 1.5*I], frame: B, position: '[x, y, z]'}}\n\
        points: {'L[i in 0..n-1]': '[x, y, z] + a*cos(pi/4+i*pi/2)*B.x + a*sin(pi/4+i*pi/2)*B.y - h*B.z'}\nimpacts: together\n\
        contacts: {'c[i in 0..n-1]': {gap: 'L[i].z', on: tab, at: 'L[i]', normal: ground.z, friction: mu}}\n\
        outputs: {front: 'reaction(c[0])', back: 'reaction(c[1])'}\nscene: {start: {z: h, x': 1}, until: 0.2}\n";
    let run = case(table).run();
    let last = run.last();
    let weight = 8.0 * 9.81;
    // Feet at ±a/√2 along x, and friction a height h below the middle.
    let tilts = 0.3 * weight * 0.7 / (4.0 * 0.5 * 0.5_f64.sqrt());
    assert!((last["x"] - (0.2 - 0.5 * 0.3 * 9.81 * 0.04)).abs() < 1e-9 && last["y"].abs() < 1e-9, "{last}");
    let presses = [last["front"], last["back"]];
    assert!((presses[0] - (0.25 * weight + tilts)).abs() < 1e-6, "{presses:?}");
    assert!((presses[1] - (0.25 * weight - tilts)).abs() < 1e-6, "{presses:?}");
}
