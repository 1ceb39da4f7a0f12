//! What constraints or contacts hold in all its freedoms, and an input carries: its rates but for the input's are rounding.

use dalembert::Method;

use super::case;

/// A ladder that leans on a truck, which drives to and fro.
fn ladder(frequency: f64) -> String {
    format!(
        "name: Ladder\nparameters: {{m: 3 kg, l: 2 m, g: 9.81 m/s^2, mu1: 0.5 1, mu2: 0.3 1, s0: 25 deg, A: 0.5 m, w: {frequency} rad/s}}\n\
         coordinates: {{x: m, y: m, th: rad}}\ninputs: {{s: A*(1 - cos(w*t))}}\n\
         points:\n  foot: '[x + l/2*sin(th), y - l/2*cos(th)]'\n  top: '[x - l/2*sin(th), y + l/2*cos(th)]'\n\
         bodies:\n  truck: {{mass: 0, inertia: 1, angle: 0, position: '[s, 0]'}}\n  \
         ladder: {{mass: m, inertia: m*l^2/12, angle: th, position: '[x, y]'}}\ngravity: [0, -g]\n\
         contacts:\n  floor: {{gap: foot.y, on: ladder, from: truck, at: foot, normal: '[0, 1]', friction: mu1}}\n  \
         wall: {{gap: top.x - s, on: ladder, from: truck, at: top, normal: '[1, 0]', friction: mu2}}\n\
         scene: {{start: {{x: l/2*sin(s0), y: l/2*cos(s0), th: s0}}, until: 3, tolerance: 1e-9}}\n"
    )
}

#[test]
fn a_ladder_on_a_truck_has_its_digits() {
    for frequency in [0.5, 1.5, 2.0, 2.5, 2.8] {
        let contacts = ladder(frequency);
        let constraints = contacts.replace("truck: {mass: 0, inertia: 1, angle: 0, position: '[s, 0]'}\n  ", "");
        let from = constraints.find("contacts:").expect("contacts");
        let to = constraints.find("scene:").expect("a scene");
        let held = "constraints: {floor: foot.y, wall: top.x - s, grip: foot.x - s - l*sin(s0)}\n";
        let constraints = format!("{}{held}{}", &constraints[..from], &constraints[to..]);
        let right = 0.5 * (1.0 - f64::cos(3.0 * frequency)) + 25.0_f64.to_radians().sin();
        for (text, method) in [(&contacts, None), (&constraints, None), (&constraints, Some(Method::Taylor))] {
            let mut case = case(text);
            case.settings.digits = true;
            case.settings.method = method.unwrap_or(case.settings.method);
            let run = case.run();
            assert!((run.last()["x"] - right).abs() < 2e-9, "{frequency} {method:?}: {} {right}", run.last());
            assert!(run.work.steps < 40, "{frequency} {method:?}: {:?}", run.work);
            let lost = run.warnings.iter().find(|warning| warning.to_string().contains("no digit"));
            assert!(lost.is_none(), "{frequency} {method:?}: {lost:?}");
        }
    }
}

/// A box on a table that an input tilts at a constant rate begins to slide with nothing left over: x'' = W² x + g sin W t − μ N/m, and N/m =
/// g cos W t − W² b − 2 W x'.
#[test]
fn a_box_begins_to_slide_on_a_table_that_tilts() {
    for mu in [0.1, 0.05, 0.003] {
        let text = format!(
            "name: Box\nparameters: {{m: 4 kg, a: 0.1 m, b: 0.3 m, g: 9.81 m/s^2, mu: {mu} 1, W: 0.2 rad/s}}\n\
             coordinates: {{x: m, y: m, th: rad}}\ninputs: {{al: W*t}}\n\
             points:\n  c: x*table.x + y*table.y\n  p: c - a*box.x - b*box.y\n  q: c + a*box.x - b*box.y\n\
             bodies:\n  table: {{mass: 0, inertia: 1, angle: -al, position: '[0, 0]'}}\n  \
             box: {{mass: m, inertia: m*(a^2 + b^2)/3, angle: th - al, position: c}}\ngravity: [0, -g]\n\
             contacts:\n  P: {{gap: 'dot(p, table.y)', on: box, from: table, at: p, normal: table.y, friction: mu}}\n  \
             Q: {{gap: 'dot(q, table.y)', on: box, from: table, at: q, normal: table.y, friction: mu}}\n\
             scene: {{start: {{x: 0, y: b}}, until: 1.6, tolerance: 1e-10}}\n"
        );
        let (g, w, b) = (9.81, 0.2, 0.3);
        let sticks = |t: f64| g * f64::sin(w * t) - mu * (g * f64::cos(w * t) - w * w * b);
        let (mut from, mut to) = (0.0, 1.6);
        for _ in 0..60 {
            let middle = 0.5 * (from + to);
            if sticks(middle) < 0.0 { from = middle } else { to = middle }
        }
        let steps = 4000;
        let h = (1.6 - from) / f64::from(steps);
        let rate = |t: f64, [x, v]: [f64; 2]| {
            let pressed = g * f64::cos(w * t) - w * w * b - 2.0 * w * v;
            [v, w * w * x + g * f64::sin(w * t) - mu * pressed]
        };
        let mut state = [0.0, 0.0];
        for k in 0..steps {
            let t = from + h * f64::from(k);
            let moved = |part: f64, by: [f64; 2]| [state[0] + part * h * by[0], state[1] + part * h * by[1]];
            let k1 = rate(t, state);
            let k2 = rate(t + 0.5 * h, moved(0.5, k1));
            let k3 = rate(t + 0.5 * h, moved(0.5, k2));
            let k4 = rate(t + h, moved(1.0, k3));
            state = [0, 1].map(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
        let run = case(&text).run();
        assert!((run.last()["x"] - state[0]).abs() < 1e-8, "{mu}: {} {state:?}", run.last());
    }
}

/// Hops that end leave with V e from a floor that rises, on a plate that slides away with U. The impulses of all hops are those of resting for as long,
/// m (1 + e)/(1 - e) V e in 2 V e/(g (1 - e)) but for m V e, so the box stops at U/(μ g) + V e/g.
#[test]
fn hops_that_end_on_a_floor_that_rises_lose_no_friction() {
    for (e, mu, rises) in [(0.4, 0.2, 1.5), (0.3, 0.15, 1.5), (0.6, 0.25, 0.3), (0.5, 0.2, 0.0)] {
        let text = format!(
            "name: Hops\nparameters: {{m: 2 kg, g: 10 m/s^2, V: {rises} m/s, w: 0.6 m/s, U: 0.8 m/s, e: {e} 1, mu: {mu} 1}}\n\
             coordinates: {{x: m, y: m}}\ninputs: {{h: V*t, s: U*t}}\n\
             bodies: {{b: {{mass: m, position: '[x, y]'}}, plate: {{mass: 0, position: '[s, h]'}}}}\ngravity: [0, -g]\n\
             contacts: {{c: {{gap: y - h, on: b, from: plate, normal: '[0, 1]', friction: mu, restitution: e}}}}\n\
             scene: {{start: {{x: 0, y: 0, y': V + w}}, until: 1.5, tolerance: 1e-10}}\n"
        );
        let run = case(&text).run();
        let stops = run.events.iter().filter(|event| event.name == "c stops").map(|event| event.state.t);
        let stops: Vec<f64> = stops.collect();
        let right = 0.8 / (mu * 10.0) + 0.06;
        assert!(stops.len() == 1 && (stops[0] - right).abs() < 1e-11, "{e} {mu} {rises}: {stops:?}, and not {right}");
        let (mut x, mut slides, mut hops) = (0.8 * 1.5, 0.8, 0.6);
        for _ in 0..200 {
            x -= slides * 2.0 * hops / 10.0;
            slides -= mu * (1.0 + e) * hops;
            hops *= e;
        }
        x -= slides * slides / (2.0 * mu * 10.0);
        assert!((run.last()["x"] - x).abs() < 1e-10, "{e} {mu} {rises}: {} {x}", run.last());
    }
}

/// A block sticks on a plate that swings with less than `static` holds: x = H (1 − cos ω t).
#[test]
fn what_sticks_to_a_plate_that_swings_sticks_with_moreau_too() {
    let block = "name: Block\nparameters: {m: 1 kg, g: 10 m/s^2, mu: 0.5 1, H: 0.055 m, w: 10 rad/s, mus: 0.6 1}\n\
        coordinates: {x: m, y: m}\ninputs: {h: H*(1-cos(w*t))}\n\
        bodies: {b: {mass: m, position: '[x, y]'}, plate: {mass: 0, position: '[h, 0]'}}\ngravity: [0, -g]\n\
        contacts: {c: {gap: y, on: b, from: plate, normal: '[0, 1]', friction: mu, static: mus}}\n\
        scene: {start: {x: 0, y: 0}, until: 1}\n";
    let mut case = case(block);
    // Wrong by 9e-4 at any step before.
    for step in [1e-3, 1e-4] {
        (case.settings.method, case.settings.step) = (Method::Moreau, Some(step));
        let run = case.run();
        assert!((run.last()["x"] - 0.055 * (1.0 - f64::cos(10.0))).abs() < 0.2 * step, "{step}: {}", run.last());
    }
}
