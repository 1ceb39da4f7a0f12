//! Random chains, trees and loops of rods or bars in Cartesian coordinates against twins in as few angles as they have
//! freedoms.

use std::fmt::Write;

use dalembert_tests::case::Case;
use dalembert_tests::random_runs::Draws;

/// Nodes with masses, each at the end of a rod from an earlier one (0: the pivot); perhaps two more rods that close a
/// loop from the last node, by way of a joint, to a fixed point.
struct Drawn {
    nodes: Vec<Node>,
    /// The joint's mass, the lengths of both rods to it, where the second one is fixed, and on which side the joint is.
    dyad: Option<(f64, [f64; 2], [f64; 2], f64)>,
    /// Between which places a spring is.
    spring: [usize; 2],
    /// How far the pivot is shaken.
    shaken: f64,
}

struct Node {
    parent: usize,
    mass: f64,
    length: f64,
    angle: f64,
    rate: f64,
}

fn draw(run: u64) -> Drawn {
    let mut draws = Draws::new(run);
    let tree = draws.chance(0.5);
    let count = *draws.pick(&[1, 2, 3, 4]);
    let nodes: Vec<Node> = (0..count)
        .map(|k| Node {
            parent: if tree { *draws.pick(&(0..=k).collect::<Vec<_>>()) } else { k },
            mass: draws.scale(0.3, 3.0),
            length: draws.between(0.4, 1.2),
            angle: draws.between(-1.0, 1.0),
            rate: draws.between(-1.0, 1.0),
        })
        .collect();
    let places = places(&nodes);
    let [x, y] = places[count].0;
    // A joint well off the line between the ends of its rods.
    let dyad = draws.chance(0.5).then(|| {
        let lengths = [draws.between(0.8, 1.2), draws.between(0.8, 1.2)];
        let apart = draws.between(0.5, 0.8) * (lengths[0] + lengths[1]);
        let towards = draws.between(-0.5, 0.5);
        (draws.scale(0.3, 3.0), lengths, [x + apart * towards.cos(), y + apart * towards.sin()], draws.sign())
    });
    let spring = [*draws.pick(&(0..count).collect::<Vec<_>>()), count];
    Drawn { nodes, dyad, spring, shaken: if draws.chance(0.5) { draws.between(0.02, 0.1) } else { 0.0 } }
}

/// Positions and velocities, that of a pivot at rest in the middle first.
fn places(nodes: &[Node]) -> Vec<([f64; 2], [f64; 2])> {
    let mut places = vec![([0.0, 0.0], [0.0, 0.0])];
    for node in nodes {
        let ([x, y], [vx, vy]) = places[node.parent];
        let (sin, cos) = node.angle.sin_cos();
        let (l, rate) = (node.length, node.length * node.rate);
        places.push(([x + l * sin, y - l * cos], [vx + rate * cos, vy + rate * sin]));
    }
    places
}

/// What both files say: bodies, forces, the pivot.
fn shared(drawn: &Drawn) -> String {
    let joint = if drawn.dyad.is_some() { ", joint: {mass: m_joint, position: J}" } else { "" };
    let bodies = (1..=drawn.nodes.len()).map(|k| format!("b{k}: {{mass: m{k}, position: p{k}}}"));
    let [from, to] = drawn.spring;
    let ends = if drawn.dyad.is_some() { "b1, joint".to_owned() } else { format!("p{from}, p{to}") };
    format!(
        "bodies: {{{}{joint}}}
gravity: [0, -g]
springs: {{s: {{between: [{ends}], stiffness: k, rest: 0.3 m}}}}
dampers: {{d: {{between: [ground, b{to}], damping: c}}}}
forces: {{push: {{on: b1, force: \"F*[sin(w*t), cos(w*t)]\"}}}}
",
        bodies.collect::<Vec<_>>().join(", "),
    )
}

fn parameters(drawn: &Drawn) -> String {
    let mut list =
        format!("g: 10 m/s^2, k: 20 N/m, c: 0.3 N*s/m, F: 2 N, w: 3 1/s, A: {:e} m, flat: 0.15 m", drawn.shaken);
    for (k, node) in drawn.nodes.iter().enumerate() {
        write!(list, ", m{}: {:e} kg, l{}: {:e} m", k + 1, node.mass, k + 1, node.length).expect("text");
    }
    if let Some((mass, [a, b], [x, y], _)) = drawn.dyad {
        write!(list, ", m_joint: {mass:e} kg, a: {a:e} m, b: {b:e} m, fx: {x:e} m, fy: {y:e} m").expect("text");
    }
    format!("parameters: {{{list}}}\n")
}

/// By angles; a joint is where two circles meet.
fn by_angles(drawn: &Drawn) -> String {
    let count = drawn.nodes.len();
    let angles: Vec<String> = (1..=count).map(|k| format!("a{k}: rad")).collect();
    let mut points = String::from("  p0: \"[A*(1 - cos(w*t)), 0]\"\n");
    let mut start = Vec::new();
    for (k, node) in drawn.nodes.iter().enumerate() {
        let k = k + 1;
        writeln!(points, "  p{k}: \"p{} + l{k}*[sin(a{k}), -cos(a{k})]\"", node.parent).expect("text");
        start.push(format!("a{k}: {:e}, a{k}': {:e}", node.angle, node.rate));
    }
    let (mut define, mut joint, mut stop) = (String::new(), "", "");
    if let Some((_, _, _, side)) = drawn.dyad {
        define = format!(
            "define:
  way: \"[fx, fy] - p{count}\"
  along: (a^2 - b^2 + dot(way, way))/(2*norm(way))
  off: {side:e}*sqrt(a^2 - along^2)
"
        );
        writeln!(points, "  J: \"p{count} + along*unit(way) + off*cross(1, unit(way))\"").expect("text");
        joint = ", joint: position(joint)";
        stop = "events: {flat: {when: \"abs(off) - flat\", then: stop}}\n";
    }
    let outputs: Vec<String> = (1..=count).map(|k| format!("b{k}: position(b{k})")).collect();
    format!(
        "name: Twin\n{}coordinates: {{{}}}\n{define}points:\n{points}{}{stop}outputs: {{{}{joint}}}\nscene: {{start: {{{}}}, until: 2, tolerance: 1e-10}}\n",
        parameters(drawn),
        angles.join(", "),
        shared(drawn),
        outputs.join(", "),
        start.join(", "),
    )
}

/// By Cartesian coordinates and rods.
fn by_rods(drawn: &Drawn) -> String {
    let count = drawn.nodes.len();
    let places = places(&drawn.nodes);
    let mut coordinates: Vec<String> = (1..=count).map(|k| format!("x{k}: m, y{k}: m")).collect();
    let mut points = String::from("  p0: \"[A*(1 - cos(w*t)), 0]\"\n");
    let (mut rods, mut start, mut guess) = (Vec::new(), Vec::new(), String::new());
    for (k, node) in drawn.nodes.iter().enumerate() {
        let (k, ([x, y], [vx, vy])) = (k + 1, places[k + 1]);
        writeln!(points, "  p{k}: \"[x{k}, y{k}]\"").expect("text");
        // In either form.
        rods.push(match k % 2 {
            0 => format!("rod{k}: norm(p{k} - p{}) - l{k}", node.parent),
            _ => format!("rod{k}: \"dot(p{k} - p{0}, p{k} - p{0}) = l{k}^2\"", node.parent),
        });
        start.push(format!("x{k}: {x:e}, y{k}: {y:e}, x{k}': {vx:e}, y{k}': {vy:e}"));
    }
    if let Some((_, [a, b], fixed, side)) = drawn.dyad {
        coordinates.push("x: m, y: m".to_owned());
        writeln!(points, "  J: \"[x, y]\"\n  fixed: \"[fx, fy]\"").expect("text");
        rods.push(format!("near_: norm(J - p{count}) - a, far: norm(J - fixed) - b"));
        let [x, y] = places[count].0;
        let (dx, dy) = (fixed[0] - x, fixed[1] - y);
        let apart = dx.hypot(dy);
        let along = (a * a - b * b + apart * apart) / (2.0 * apart);
        let off = side * (a * a - along * along).sqrt();
        let (ux, uy) = (dx / apart, dy / apart);
        // Somewhere near the joint; its speed follows.
        guess = format!(", guess: {{x: {:.2}, y: {:.2}}}", x + along * ux - off * uy, y + along * uy + off * ux);
    }
    format!(
        "name: Rods\n{}coordinates: {{{}}}\npoints:\n{points}{}constraints: {{{}}}\noutputs: {{force: reaction(rod1)}}\nscene: {{start: {{{}}}{guess}, until: 2, tolerance: 1e-10}}\n",
        parameters(drawn),
        coordinates.join(", "),
        shared(drawn),
        rods.join(", "),
        start.join(", "),
    )
}

#[test]
fn chains_trees_and_loops_of_rods_move_as_their_twins_by_angles() {
    let mut loops = 0;
    for run in 0..16 {
        let drawn = draw(run);
        let (angles, rods) = (by_angles(&drawn), by_rods(&drawn));
        let mut twin = Case::written(&angles);
        let ended = twin.run().last();
        loops += usize::from(drawn.dyad.is_some() && ended.t > 0.3);
        for part in [0.37, 1.0] {
            let t = part * ended.t;
            let (one, other) = (Case::written(&rods).state_at(t), twin.state_at(t));
            let joint = drawn.dyad.is_some().then(|| (String::new(), "joint".to_owned()));
            let names = (1..=drawn.nodes.len()).map(|k| (k.to_string(), format!("b{k}")));
            for (column, body) in names.chain(joint) {
                for axis in ["x", "y"] {
                    let (found, expected) =
                        (one[format!("{axis}{column}").as_str()], other[format!("{body}.{axis}").as_str()]);
                    let error = (found - expected).abs();
                    assert!(error < 1e-7, "run {run} at {t}, {body}.{axis}: off by {error:e}\n{angles}\n{rods}");
                }
            }
        }
    }
    assert!(loops >= 4, "only {loops} loops were followed");
}

/// Bars in the place of rods, without a joint: what both files say of their bodies is where their middles `C` are.
fn bars(drawn: &Drawn, name: &str, coordinates: &[String], points: &str, more: &str, start: &[String]) -> String {
    let bodies = (1..=drawn.nodes.len())
        .map(|k| format!("b{k}: {{mass: m{k}, inertia: m{k}*l{k}^2/12, angle: a{k}, position: C{k}}}"));
    let [from, to] = drawn.spring;
    let outputs: Vec<String> = (1..=drawn.nodes.len()).map(|k| format!("a{k}: a{k}, b{k}: position(b{k})")).collect();
    format!(
        "name: {name}
{}coordinates: {{{}}}
points:
  p0: \"[A*(1 - cos(w*t)), 0]\"
{points}bodies: {{{}}}
gravity: [0, -g]
springs: {{s: {{between: [p{from}, p{to}], stiffness: k, rest: 0.3 m}}}}
dampers: {{d: {{between: [ground, b{to}], damping: c}}}}
forces: {{push: {{on: b1, at: p1, force: \"F*[sin(w*t), cos(w*t)]\"}}}}
{more}outputs: {{{}}}
scene: {{start: {{{}}}, until: 2, tolerance: 1e-10}}
",
        parameters(drawn),
        coordinates.join(", "),
        bodies.collect::<Vec<_>>().join(", "),
        outputs.join(", "),
        start.join(", "),
    )
}

/// Three coordinates for every bar, and pins.
fn bars_by_pins(drawn: &Drawn) -> String {
    let places = places(&drawn.nodes);
    let (mut coordinates, mut points, mut pins, mut start) = (Vec::new(), String::new(), Vec::new(), Vec::new());
    for (k, node) in drawn.nodes.iter().enumerate() {
        let (k, parent) = (k + 1, node.parent);
        let [([x, y], [vx, vy]), ([px, py], [pvx, pvy])] = [places[k], places[parent]];
        coordinates.push(format!("x{k}: m, y{k}: m, a{k}: rad"));
        writeln!(points, "  C{k}: \"[x{k}, y{k}]\"\n  p{k}: \"C{k} - l{k}/2*b{k}.y\"").expect("text");
        pins.push(format!("pin{k}: C{k} + l{k}/2*b{k}.y = p{parent}"));
        start.push(format!(
            "x{k}: {:e}, y{k}: {:e}, a{k}: {:e}, x{k}': {:e}, y{k}': {:e}, a{k}': {:e}",
            (x + px) / 2.0,
            (y + py) / 2.0,
            node.angle,
            (vx + pvx) / 2.0,
            (vy + pvy) / 2.0,
            node.rate
        ));
    }
    let pins = format!("constraints: {{{}}}\n", pins.join(", "));
    bars(drawn, "Bars", &coordinates, &points, &pins, &start)
}

fn bars_by_angles(drawn: &Drawn) -> String {
    let (mut coordinates, mut points, mut start) = (Vec::new(), String::new(), Vec::new());
    for (k, node) in drawn.nodes.iter().enumerate() {
        let (k, parent) = (k + 1, node.parent);
        coordinates.push(format!("a{k}: rad"));
        writeln!(points, "  C{k}: \"p{parent} + l{k}/2*[sin(a{k}), -cos(a{k})]\"\n  p{k}: 2*C{k} - p{parent}")
            .expect("text");
        start.push(format!("a{k}: {:e}, a{k}': {:e}", node.angle, node.rate));
    }
    bars(drawn, "Twin", &coordinates, &points, "", &start)
}

#[test]
fn chains_and_trees_of_pinned_bars_move_as_their_twins_by_angles() {
    for run in 100..108 {
        let drawn = Drawn { dyad: None, ..draw(run) };
        let (angles, pins) = (bars_by_angles(&drawn), bars_by_pins(&drawn));
        let (one, other) = (Case::written(&pins).run().last(), Case::written(&angles).run().last());
        for k in 1..=drawn.nodes.len() {
            for name in [format!("a{k}"), format!("b{k}.x"), format!("b{k}.y")] {
                let error = (one[name.as_str()] - other[name.as_str()]).abs();
                assert!(error < 1e-7, "run {run}, {name}: off by {error:e}\n{angles}\n{pins}");
            }
        }
    }
}

/// Events of place and of tension, on projected steps and on plain ones.
#[test]
fn events_of_a_pendulum_by_its_rod_and_by_its_angle_happen_together() {
    let by_rod = "
name: Pc
parameters: {m: 1, l: 1, g: 10}
coordinates: {x: 1, y: 1}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {rod: x^2 + y^2 - l^2}
events: {mid: {when: x, then: record}, high: {when: y + 1/2, then: record}, tens: {when: -2*l*reaction(rod) - 15, then: record}}
scene: {start: {x: 0.9, y: -sqrt(0.19), x': 0}, until: 20, tolerance: 1e-12}
";
    let by_angle = "
name: Pa
parameters: {m: 1, l: 1, g: 10}
coordinates: {a: 1}
bodies: {bob: {mass: m, position: \"l*[sin(a), -cos(a)]\"}}
gravity: [0, -g]
events: {mid: {when: sin(a), then: record}, high: {when: 1/2 - cos(a), then: record}, tens: {when: m*l*a'^2 + m*g*cos(a) - 15, then: record}}
scene: {start: {a: asin(0.9), a': 0}, until: 20, tolerance: 1e-12}
";
    let (rod, angle) = (Case::written(by_rod).run(), Case::written(by_angle).run());
    assert_eq!(rod.events.len(), 93);
    assert_eq!(angle.events.len(), 93);
    for (one, other) in rod.events.iter().zip(&angle.events) {
        assert_eq!(one.name, other.name);
        let apart = (one.state.t - other.state.t).abs();
        assert!(apart < 1e-10, "{} at {}: {apart:e}", one.name, one.state.t);
    }
}
