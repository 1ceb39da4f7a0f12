//! Mechanisms written from LANGUAGE.md alone, against published numbers, closed forms and twins.

use dalembert_tests::case::Case;

use crate::near;

/// Andrews' squeezing mechanism (Schiehlen 1990; Hairer, Wanner, *Solving ODEs II*, VII.7): seven bodies, three loops.
const ANDREWS: &str = "
name: AndrewsSqueezer
about: Andrews' squeezing mechanism (Schiehlen 1990; Hairer, Wanner, Solving ODEs II, VII.7), seven bodies in three loops.
parameters: {m1: 0.04325 kg, m2: 0.00365 kg, m3: 0.02373 kg, m4: 0.00706 kg, m5: 0.07050 kg, m6: 0.00706 kg, m7: 0.05498 kg,
  I1: 2.194e-6 kg*m^2, I2: 4.410e-7 kg*m^2, I3: 5.255e-6 kg*m^2, I4: 5.667e-7 kg*m^2, I5: 1.169e-5 kg*m^2, I6: 5.667e-7 kg*m^2, I7: 1.912e-5 kg*m^2,
  xa: -0.06934 m, ya: -0.00227 m, xb: -0.03635 m, yb: 0.03273 m, xc: 0.014 m, yc: 0.072 m, d: 28e-3 m,
  da: 115e-4 m, e: 2e-2 m, ea: 1421e-5 m, rr: 7e-3 m, ra: 92e-5 m, l0: 7785e-5 m, ss: 35e-3 m,
  sa: 1874e-5 m, sb: 1043e-5 m, sc: 18e-3 m, sd: 2e-2 m, ta: 2308e-5 m, tb: 916e-5 m, u: 4e-2 m,
  ua: 1228e-5 m, ub: 449e-5 m, zf: 2e-2 m, zt: 4e-2 m, fa: 1421e-5 m, c0: 4530 N/m, mom: 0.033 N*m}
coordinates: {beta: rad, Theta: rad, gamma: rad, Phi: rad, delta: rad, Omega: rad, epsilon: rad}
points:
  A: \"[xa, ya]\"
  B: \"[xb, yb]\"
  C: \"[xc, yc]\"
  O: [0, 0]
  E: rr*K1.x - d*K2.x
  D: \"B + sd*[cos(gamma), sin(gamma)] + sc*[sin(gamma), -cos(gamma)]\"
bodies:
  K1: {mass: m1, inertia: I1, angle: beta, position: ra*K1.x}
  K2: {mass: m2, inertia: I2, angle: beta + Theta, position: rr*K1.x - da*K2.x}
  K3: {mass: m3, inertia: I3, angle: gamma, position: \"B + sa*[sin(gamma), -cos(gamma)] + sb*[cos(gamma), sin(gamma)]\"}
  K4: {mass: m4, inertia: I4, angle: Phi + delta, position: \"A + zt*K5.x + (e - ea)*[sin(Phi + delta), -cos(Phi + delta)]\"}
  K5: {mass: m5, inertia: I5, angle: delta, position: A + ta*K5.x + tb*K5.y}
  K6: {mass: m6, inertia: I6, angle: Omega + epsilon, position: \"A + u*[sin(epsilon), -cos(epsilon)] + (zf - fa)*[cos(Omega + epsilon), sin(Omega + epsilon)]\"}
  K7: {mass: m7, inertia: I7, angle: epsilon, position: \"A + ua*[sin(epsilon), -cos(epsilon)] - ub*[cos(epsilon), sin(epsilon)]\"}
springs: {squeezed: {between: [D, C], stiffness: c0, rest: l0}}
torques: {motor: {on: K1, torque: mom}}
constraints:
  loop_3: \"E = B + ss*[sin(gamma), -cos(gamma)]\"
  loop_5: \"E = A + zt*K5.x + e*[sin(Phi + delta), -cos(Phi + delta)]\"
  loop_7: \"E = A + u*[sin(epsilon), -cos(epsilon)] + zf*[cos(Omega + epsilon), sin(Omega + epsilon)]\"
scene:
  start: {Theta: 0, beta: -0.0617138900142764496358948458001, beta': 0}
  guess: {gamma: 0.455279819163070380255912382449, Phi: 0.222668390165885884674473185609, delta: 0.487364979543842550225598953530, Omega: -0.222668390165885884674473185609, epsilon: 1.23054744454982119249735015568}
  until: 0.03
  tolerance: 1e-12
";

/// The test set for solvers of initial value problems gives these angles at t = 0.03.
#[test]
fn andrews_squeezing_mechanism_follows_the_published_solution() {
    let published = [
        ("beta", 15.810_771_196_3),
        ("Theta", -15.756_371_059_84),
        ("gamma", 0.040_822_240_133_2),
        ("Phi", -0.534_730_116_323),
        ("delta", 0.524_409_965_881),
        ("Omega", 0.534_730_116_323),
        ("epsilon", 1.048_080_741_042),
    ];
    let state = Case::written(ANDREWS).tolerance(1e-13).run().last();
    for (name, expected) in published {
        near(state[name], expected, 2e-9);
    }
}

/// A cart on two wheels, whose three velocity constraints hide an integral.
const CART: &str = "
name: WheeledCart
parameters: {m: 5 kg, I: 0.4 kg*m^2, d: 0.1 m, R: 0.2 m, b: 0.3 m, J: 0.02 kg*m^2, T: 0.3 N*m}
coordinates: {x: m, y: m, theta: rad, left: rad, right: rad}
points: {axle: \"[x, y]\"}
bodies: {chassis: {mass: m, inertia: I, angle: theta, position: axle + d*chassis.x}}
kinetic_energy: J/2*(left'^2 + right'^2)
generalized_forces: {right: T, left: -T/2}
constraints:
  sideways: dot(velocity(axle), chassis.y)
  rolls_left: dot(velocity(axle), chassis.x) - b*theta' = R*left'
  rolls_right: dot(velocity(axle), chassis.x) + b*theta' = R*right'
outputs: {hidden: R*(right - left) - 2*b*theta, speed: \"dot(velocity(axle), chassis.x)\"}
checks: {turn: R*(right' - left') = 2*b*theta'}
scene: {start: {x: 0, y: 0, theta: 0, left: 0, right: 0, \"theta'\": 0, \"x'\": 0.1}, until: 10, tolerance: 1e-11}
";

/// The integral that no single constraint shows is kept, and a motor's work is what the energy gains.
#[test]
fn a_wheeled_cart_turns_by_the_difference_of_its_wheels() {
    let run = Case::written(CART).run();
    for state in run.states() {
        near(state["hidden"], 0.0, 1e-12);
    }
    assert!(run.energy_balance.is_some_and(|drift| drift < 1e-11), "{:?}", run.energy_balance);
    // Forces of the motors drive the chassis: m + 2 J/R² along, I + m d² + 2 J b²/R² about the axle, on paper.
    let (m, i, d, r, b, j, torque) = (5.0, 0.4, 0.1, 0.2, 0.3, 0.02, 0.3);
    let case = Case::written(CART);
    let a = case.accelerations();
    near(a[0], (torque / 2.0) / r / (m + 2.0 * j / (r * r)), 1e-12);
    near(a[2], (1.5 * torque) * b / r / (i + m * d * d + 2.0 * j * b * b / (r * r)), 1e-12);
}

/// An upright disc that rolls: a circle (Neimark, Fufaev, III).
const DISC: &str = "
name: UprightDisc
parameters: {m: 2 kg, R: 0.5 m, I: m*R^2/2, J: m*R^2/4, w: 3 1/s, s: 0.7 1/s}
coordinates: {x: m, y: m, psi: rad, phi: rad}
kinetic_energy: m/2*(x'^2 + y'^2) + I/2*phi'^2 + J/2*psi'^2
constraints: {rolls: \"[x' - R*phi'*cos(psi), y' - R*phi'*sin(psi)]\"}
conserved: {energy: energy, spin: J*psi'}
outputs: {off: \"[x - R*w/s*sin(s*t), y - R*w/s*(1 - cos(s*t))]\", side: \"dot(reaction(rolls), [-sin(psi), cos(psi)])\"}
scene: {start: {x: 0, y: 0, psi: 0, phi: 0, phi': w, psi': s}, until: 10, tolerance: 1e-11}
";

#[test]
fn an_upright_rolling_disc_runs_in_a_circle() {
    let run = Case::written(DISC).run();
    for state in run.states() {
        near(state["off.x"], 0.0, 1e-9);
        near(state["off.y"], 0.0, 1e-9);
        // m v ψ' towards the centre.
        near(state["side"], 2.0 * 0.5 * 3.0 * 0.7, 1e-9);
    }
}

/// A sleigh with a trailer on a skate.
const TRAILER: &str = "
name: Trailer
about: A sleigh that pulls a trailer on a skate, hitched behind the runner.
parameters: {m: 2 kg, I: 0.3 kg*m^2, d: 0.2 m, h: 0.5 m, M: 1 kg, J: 0.1 kg*m^2, l: 0.8 m, a: 0.6 m}
coordinates: {x: m, y: m, theta: rad, psi: rad}
points:
  skate: \"[x, y]\"
  hitch: skate - h*sled.x
  wheel: hitch - l*cart.x
bodies:
  sled: {mass: m, inertia: I, angle: theta, position: skate + d*sled.x}
  cart: {mass: M, inertia: J, angle: psi, position: hitch - a*cart.x}
constraints:
  edge: dot(velocity(skate), sled.y)
  track: dot(velocity(wheel), cart.y)
balances:
  equations:
    - force: {of: [sled]}
    - moment: {about: sled, of: [sled]}
    - force: {of: [cart]}
    - moment: {about: cart, of: [cart]}
  reactions:
    side: {on: sled, at: skate, along: sled.y}
    pin: {on: sled, at: hitch, from: cart}
    rut: {on: cart, at: wheel, along: cart.y}
conserved: {energy: energy}
outputs: {speed: \"dot(velocity(skate), sled.x)\", side: reaction(edge), rut: reaction(track)}
draw: [{line: [skate, hitch, wheel]}]
scene: {start: {x: 0, y: 0, theta: 0, psi: 0.4, x': 2, theta': 0.7}, until: 20, tolerance: 1e-11}
";

/// With its mass ahead of both skates it comes to run straight, with all of its energy; balances agree with multipliers.
#[test]
fn a_sleigh_with_a_trailer_comes_to_run_straight() {
    let last = Case::written(TRAILER).until(60.0).run().last();
    near(last["theta'"], 0.0, 1e-9);
    near((last["theta"] - last["psi"]).sin(), 0.0, 1e-9);
    let mut by_balances = Case::written(TRAILER).by("balances");
    let (one, other) = (Case::written(TRAILER).state_at(5.0), by_balances.state_at(5.0));
    for name in ["x", "y", "theta", "psi", "side", "rut"] {
        near(one[name], other[name], 1e-8);
    }
}

/// Peaucellier's eight bars.
const PEAUCELLIER: &str = "
name: Peaucellier
about: Eight bars that draw a straight line.
parameters: {m: 1 kg, L: 1 m, b: 0.5 m, r: 0.4 m, g: 10 m/s^2}
coordinates: {\"x[i in 1..4]\": m, \"y[i in 1..4]\": m}
points: {O: [0, 0], A: \"[r, 0]\"}
bodies: {\"p[i in 1..4]\": {mass: m, position: \"[x[i], y[i]]\"}}     # B, C, D, P
gravity: [g, 0]
constraints:
  crank: norm(p[1] - A) - r
  upper: norm(p[2]) - L
  lower: norm(p[3]) - L
  \"side[i in 2..3]\": norm(p[i] - p[1]) - b
  \"far[i in 2..3]\": norm(p[i] - p[4]) - b
conserved: {energy: energy}
outputs: {line: \"position(p[4]).x\", expected: (L^2 - b^2)/(2*r)}
draw: [{line: [O, \"p[2]\", \"p[4]\", \"p[3]\", O]}, {line: [\"p[2]\", \"p[1]\", \"p[3]\"]}, {trace: \"p[4]\"}]
scene: {guess: {\"x[1]\": 0.78, \"y[1]\": 0.1, \"x[2]\": 0.9, \"y[2]\": 0.45, \"x[3]\": 0.9, \"y[3]\": -0.4, \"x[4]\": 0.94, \"y[4]\": 0.1}, until: 5, tolerance: 1e-10}
";

#[test]
fn peaucelliers_linkage_draws_a_straight_line() {
    let run = Case::written(PEAUCELLIER).run();
    let swing = run.states().map(|state| state["y[4]"]).fold(0.0_f64, |most, y| most.max(y.abs()));
    assert!(swing > 0.05, "{swing}");
    for state in run.states() {
        near(state["line"], state["expected"], 1e-12);
    }
}

/// A crane that hoists while its trolley moves; the load by Cartesian coordinates.
const CRANE: &str = "
name: Crane
about: A trolley that is driven along its rail and hoists a load on a rope of given length.
parameters: {m: 3 kg, M: 8 kg, L: 2 m, g: 9.81 m/s^2, w: 1.3 1/s, A: 0.4 m, k: 0.05 m/s}
coordinates: {s: m, x: m, y: m}
inputs: {drive: A*(1 - cos(w*t)), rope: L - k*t}
points: {block: \"[s, 0]\"}
bodies: {trolley: {mass: M, position: \"[s, 0]\"}, load: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints:
  motor: s - drive
  hoist: norm(load - block) - rope
balances:
  equations:
    - force: {of: [load]}
    - equation: tension = -reaction(hoist)
    - force: {of: [trolley], along: [1, 0]}
  reactions:
    tension: {on: load, along: unit(block - load), from: trolley}
    thrust: {on: trolley, along: [1, 0]}
outputs: {tension: -reaction(hoist), thrust: reaction(motor)}
scene: {start: {x: 0.3}, guess: {y: -2}, until: 10, tolerance: 1e-11}
equilibrium: {y: -2}
";

/// The same load by the angle of its rope.
const LOAD: &str = "
name: CraneAngle
parameters: {m: 3 kg, L: 2 m, g: 9.81 m/s^2, w: 1.3 1/s, A: 0.4 m, k: 0.05 m/s}
coordinates: {a: rad}
inputs: {drive: A*(1 - cos(w*t)), rope: L - k*t}
bodies: {load: {mass: m, position: \"[drive, 0] + rope*[sin(a), -cos(a)]\"}}
gravity: [0, -g]
outputs: {p: position(load)}
scene: {start: {a: asin(0.3/2)}, until: 10, tolerance: 1e-11}
";

#[test]
fn a_load_on_a_rope_that_is_wound_up_swings_as_its_twin_by_the_angle() {
    for t in [3.0, 10.0] {
        let (rope, angle) = (Case::written(CRANE).state_at(t), Case::written(LOAD).state_at(t));
        near(rope["x"], angle["p.x"], 1e-8);
        near(rope["y"], angle["p.y"], 1e-8);
        let by = Case::written(CRANE).by("balances").state_at(t);
        near(rope["tension"], by["tension"], 1e-6);
        near(rope["thrust"], by["thrust"], 1e-6);
    }
}

/// A ball that bounces down a flight of stairs.
const STAIRS: &str = "
name: Stairs
about: A ball that bounces down a flight of stairs.
sizes: {n: 6}
parameters: {m: 1 kg, g: 10 m/s^2, e: 0.7 1, H: 0.3 m, W: 0.5 m}
coordinates: {x: m, y: m}
bodies: {ball: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints:
  \"tread[i in 1..n]\": y + (i - 1)*H
phases: {flight: [], \"rest[i in 1..n]\": [\"tread[i]\"]}
events:
  \"hit[i in 1..n]\": {when: y + (i - 1)*H, direction: falling, phase: flight, if: \"min(x - (i - 1)*W, i*W - x)\", then: {impact: e, along: \"tread[i]\"}}
  \"edge[i in 1..n]\": {when: \"x - i*W\", direction: rising, phase: \"rest[i]\", then: flight}
scene: {start: {x: 0.1, y: 1, x': 0.8}, until: 4, tolerance: 1e-11}
";

/// Every landing on paper: a parabola down to the first tread whose edge is not passed yet.
#[test]
fn a_ball_bounces_down_the_stairs() {
    let run = Case::written(STAIRS).run();
    let (g, e, height, width, speed, count) = (10.0_f64, 0.7, 0.3, 0.5, 0.8, 6);
    let (mut t, mut y, mut rising, mut expected) = (0.0, 1.0, 0.0, Vec::new());
    'flights: loop {
        for tread in 0..count {
            let fall = y + height * f64::from(tread);
            let arrives = (rising + f64::sqrt(rising * rising + 2.0 * g * fall)) / g;
            let x = 0.1 + speed * (t + arrives);
            if x < width * f64::from(tread + 1) {
                rising = e * (g * arrives - rising);
                (t, y) = (t + arrives, -height * f64::from(tread));
                expected.push((format!("hit[{}]", tread + 1), t));
                continue 'flights;
            }
        }
        break;
    }
    let found: Vec<(String, f64)> = run.events.iter().map(|event| (event.name.clone(), event.state.t)).collect();
    assert_eq!(found.len(), expected.len(), "{found:?} {expected:?}");
    assert!(found.len() >= 5);
    for ((name, t), (tread, expected)) in found.iter().zip(&expected) {
        assert_eq!(name, tread);
        near(*t, *expected, 1e-11);
    }
}
