//! Systems of balances as linear equations (LANGUAGE, section 7).

use dalembert_symbolic::expr::{Binary, Id, Node, Unary};
use dalembert_symbolic::lower::{MomentumSystem, Program, compile};

/// A program from text without problems.
fn program(text: &str) -> Program {
    compile(text, &[]).unwrap_or_else(|problems| {
        let told: Vec<String> = problems.iter().map(|p| format!("{} {} {}", p.code, p.message, p.label)).collect();
        panic!("{text}\n{}", told.join("\n"))
    })
}

/// The codes of a text's problems.
fn codes(text: &str) -> Vec<&'static str> {
    compile(text, &[]).err().unwrap_or_default().iter().map(|problem| problem.code).collect()
}

fn system<'a>(program: &'a Program, name: &str) -> &'a MomentumSystem {
    program.momentum.iter().find(|s| s.name == name).unwrap_or_else(|| panic!("no balances `{name}`"))
}

fn roots(system: &MomentumSystem) -> Vec<Id> {
    system.matrix.iter().map(|e| e.2).chain(system.right.iter().copied()).collect()
}

const CART: &str = r#"
name: Cart
parameters: {m: 1, mu: 0.3, g: 10, k: 5, l: 1, b: 0.1}
coordinates: {x: 1, th: rad}
points: {c: "[x, 0]", e: "c + l*[sin(th), -cos(th)]", wall: [-2, 0], post: [2, 0]}
bodies:
  block: {mass: m, position: c}
  bob: {mass: m, inertia: m*l^2/12, angle: th, position: "(c + e)/2"}
gravity: [0, -g]
springs:
  stop: {between: [wall, block], tension: "k*max(0, length - 2)"}
  after: {between: [post, e], energy: "k*abs(length - 1)/9"}
forces:
  rub: {on: block, force: "[-mu*m*g*sign(x'), 0]"}
  late: {on: bob, at: e, force: "[step(t - 1), 0]"}
torques:
  drag: {on: bob, torque: "-b*abs(th')*th'"}
balances:
  two:
    equations: [{force: {of: all, along: ground.x}}, {moment: {about: c, of: bob}}]
  five:
    equations: [{force: {of: block}}, {force: {of: bob}}, {moment: {about: bob, of: bob}}]
    reactions: {floor: {on: block, along: ground.y}, pin: {on: bob, at: c, from: block}}
  power:
    equations: [{power: {of: all}}, {moment: {about: c, of: bob}}]
outputs: {floor: floor, twice: 2*floor, pin: pin}
"#;

/// Between two crossings A and b are smooth: every discontinuity is the mode that Lagrange's equations switch.
#[test]
fn discontinuities_are_modes() {
    let program = program(CART);
    assert_eq!(program.switches.len(), 5);
    for system in &program.momentum {
        let graph = &program.model.graph;
        let needed = graph.reachable(roots(system));
        for i in (0..needed.len()).filter(|&i| needed[i]) {
            let node = graph.node(graph.id_at(i));
            let jumps = matches!(node, Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, _))
                || matches!(node, Node::Binary(Binary::Min | Binary::Max, ..));
            assert!(!jumps, "{}: {node:?}", system.name);
        }
    }
}

#[test]
fn unknowns_and_equations_have_names() {
    let program = program(CART);
    let five = system(&program, "five");
    assert_eq!(five.unknowns, ["x''", "th''", "floor", "pin.x", "pin.y"]);
    let names: Vec<&str> = five.equations.iter().map(|e| e.0.as_str()).collect();
    assert_eq!(names[..2], ["x of balance 1 (force)", "y of balance 1 (force)"]);
    assert_eq!(names[4], "balance 3 (moment)");
    // `floor` and both components of `pin`, but not twice the first.
    assert_eq!(five.outputs, [(0, 2), (2, 3), (3, 4)]);
    assert_eq!(system(&program, "two").outputs, []);
    let void: Vec<bool> = system(&program, "power").equations.iter().map(|e| e.1).collect();
    assert_eq!(void, [true, false]);
}

const RAW: &str = "
name: Raw
parameters: {m: 1 kg, k: 3 N/m^3, c: 0.2 N*s/m, d: 0.3 N*s^2/m^2}
coordinates: {x: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
potential_energy: k*x^4/4
dissipation: c*x'^2/2
generalized_forces: {x: -d*x'*abs(x')}
balances: {equations: [{energy: {}}]}
";

/// `energy` is the rate of all energies and the power of everything else, raw ones included; the others see bodies only.
#[test]
fn energy_sees_what_is_raw_and_others_refuse_it() {
    assert_eq!(program(RAW).momentum.len(), 1);
    for balance in ["force: {of: b, along: ground.x}", "moment: {about: \"[0, 1]\", of: b}", "power: {of: b}"] {
        let text = RAW.replace("energy: {}", balance);
        assert_eq!(codes(&text), ["E415"], "{balance}");
        let damped = text.replace("potential_energy: k*x^4/4\n", "").replace("generalized_forces", "#");
        assert_eq!(codes(&damped), ["E415"], "{balance}");
    }
}

#[test]
fn a_product_of_unknowns_is_refused() {
    let text = RAW.replace("energy: {}", "equation: \"m*x''^2 = -k*x^3*x''\"");
    assert_eq!(codes(&text), ["E510"]);
}

/// A of a long chain comes from one reverse pass an equation, of a short one from one forward pass: the same A.
#[test]
fn both_ways_of_differentiating_give_one_matrix() {
    let chain = include_str!("../../../models/chain.yaml");
    let compiled = |n: i64| compile(chain, &[("n".to_owned(), n)]).unwrap_or_else(|p| panic!("{p:?}"));
    // Beyond the last bar of the short chain the long one only adds mass, so that its last rows are compared.
    let value = |program: &Program, row: usize, column: usize| {
        let system = &program.momentum[0];
        let entry = system.matrix.iter().find(|e| (e.0, e.1) == (row, column)).expect("a full matrix");
        let n = program.model.coordinates.len();
        let angle = |i: u32| 0.1 * (n as f64 - f64::from(i));
        dalembert_symbolic::expr::Tape::new(&program.model.graph, &[entry.2]).evaluate(|s| match s {
            dalembert_symbolic::expr::Symbol::Coordinate(i) => angle(i),
            dalembert_symbolic::expr::Symbol::Parameter(i) => program.model.parameters[i as usize].default,
            _ => 0.0,
        })[0]
    };
    let (short, long) = (compiled(10), compiled(20));
    for i in 1..=5 {
        for j in 1..=5 {
            let (a, b) = (value(&short, 10 - i, 10 - j), value(&long, 20 - i, 20 - j));
            assert!((a - b).abs() < 1e-12, "{i}, {j}: {a} is not {b}");
        }
    }
}
