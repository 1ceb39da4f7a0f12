//! Nonlinear phenomena, by the numbers of theory: section N of the catalogue of stability.

use std::f64::consts::PI;

use dalembert::{Method, Run};
use dalembert_tests::case::Case;

/// A run of a file by a method.
fn run(text: &str, method: Method, tolerance: f64) -> Run {
    let mut case = Case::written(text).tolerance(tolerance);
    case.settings.method = method;
    case.run()
}

/// N1: neighbours part like e^{λt}, so that a start off by δ shows after ln(Δ/δ)/λ: 21 s for 1e-12 and 0.1 at (2, 2) rad, where
/// λ = 1.30/s; never where the motion is regular.
#[test]
fn n1_a_double_pendulum_is_foreseen_for_as_long_as_its_exponent_says() {
    let file = |angle: f64| {
        format!(
            "name: Chaos\nparameters: {{g: 9.81}}\ncoordinates: {{a: , b: }}\n\
             kinetic_energy: a'^2 + b'^2/2 + a'*b'*cos(a - b)\npotential_energy: -g*(2*cos(a) + cos(b))\n\
             scene: {{start: {{a: {angle}, b: 2}}, until: 40, tolerance: 1e-13, every: 0.1}}\n"
        )
    };
    let parted = |angle: f64| {
        let [one, other] = [angle, angle + 1e-12].map(|angle| run(&file(angle), Method::Dop853, 1e-13));
        let mut pairs = one.states().zip(other.states());
        pairs.find(|(one, other)| (one["a"] - other["a"]).abs() > 0.1).map(|(one, _)| one.t)
    };
    let after = parted(2.0).expect("chaos");
    assert!((17.0..27.0).contains(&after), "{after}");
    let quiet = file(0.3).replace("b: 2", "b: 0.3");
    let moved = quiet.replace("a: 0.3", "a: 0.300000000001");
    let [one, other] = [quiet, moved].map(|text| run(&text, Method::Dop853, 1e-13).last()["a"]);
    assert!((one - other).abs() < 1e-9, "{one} {other}");
}

/// The matrix that takes (x, x') through a period of a linear equation, from two short motions of this size.
fn monodromy(text: impl Fn([f64; 2]) -> String, (at, size): (f64, f64), method: Method) -> [[f64; 2]; 2] {
    let column = |start: [f64; 2]| {
        let last = run(&text(start), method, 1e-13).last();
        [(last.q[0] - at) / size, last.v[0] / size]
    };
    let [first, second] = [column([at + size, 0.0]), column([at, size])];
    [[first[0], second[0]], [first[1], second[1]]]
}

fn trace(m: [[f64; 2]; 2]) -> f64 {
    m[0][0] + m[1][1]
}

/// N2: an inverted pendulum stands where its pivot shakes faster than Ω²L/g = 200.871, 50.859, 13.316 for A/L = 0.1, 0.2, 0.4:
/// more than the 2(L/A)² of the average.
#[test]
fn n2_an_inverted_pendulum_stands_where_its_pivot_shakes_fast_enough() {
    for method in [Method::Auto, Method::Dop853, Method::Radau5] {
        for (amplitude, critical) in [(0.1, 200.871), (0.2, 50.859), (0.4, 13.316_f64)] {
            let stands = |square: f64| {
                let shaken = |[theta, rate]: [f64; 2]| {
                    format!(
                        "name: Shaken\nparameters: {{A: {amplitude}, W: {}}}\ncoordinates: {{theta: }}\n\
                         bodies: {{bob: {{mass: 1, position: \"[sin(theta), A*cos(W*t) - cos(theta)]\"}}}}\ngravity: [0, -1]\n\
                         scene: {{start: {{theta: {theta}, theta': {rate}}}, until: {}, tolerance: 1e-13}}\n",
                        square.sqrt(),
                        2.0 * PI / square.sqrt()
                    )
                };
                trace(monodromy(shaken, (PI, 1e-5), method)).abs() < 2.0
            };
            let slack = 2e-5 * critical;
            assert!(!stands(critical - slack) && stands(critical + slack), "{method}: {amplitude}");
        }
    }
}

/// x'' + 2c x' + (a − 2q cos 2t) x with q = 0.1, over its period π.
fn mathieu(a: f64, c: f64, method: Method) -> [[f64; 2]; 2] {
    let text = |[x, v]: [f64; 2]| {
        format!(
            "name: Mathieu\nparameters: {{a: {a}, c: {c}, q: 0.1}}\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n\
             generalized_forces: {{x: \"-2*c*x' - (a - 2*q*cos(2*t))*x\"}}\n\
             scene: {{start: {{x: {x}, x': {v}}}, until: {PI}, tolerance: 1e-13}}\n"
        )
    };
    monodromy(text, (0.0, 1.0), method)
}

/// N3: at q = 0.1 the first tongue lies between b₁ = 0.898766 and a₁ = 1.098734; in its middle damping above q/2 stabilises: a
/// period multiplies by 1.0318 at 0.04, by 0.9690 at 0.06.
#[test]
fn n3_parametric_resonance_has_mathieus_tongues() {
    for method in [Method::Auto, Method::Dop853, Method::Radau5] {
        let grows = |a: f64| trace(mathieu(a, 0.0, method)) < -2.0;
        for (edge, inwards) in [(0.898766, 1.0), (1.098734, -1.0)] {
            assert!(grows(edge + 1e-6 * inwards) && !grows(edge - 1e-6 * inwards), "{method}: {edge}");
        }
        for (c, growth) in [(0.04, 0.0318), (0.06, -0.0310)] {
            let m = mathieu(1.0, c, method);
            let (half, det) = (0.5 * trace(m), m[0][0] * m[1][1] - m[0][1] * m[1][0]);
            let found = half.abs() + (half * half - det).max(0.0).sqrt() - 1.0;
            assert!((found - growth).abs() < 1e-4, "{method}: {c} {found}");
        }
    }
}

/// N4: a sleigh that goes backwards turns round: v = V tanh(cV(t − t₀)), c = m a/(I + m a²).
#[test]
fn n4_a_sleigh_that_goes_backwards_turns_round() {
    let text = "name: Sleigh\nparameters: {m: 1, I: 0.2, d: 0.3}\ncoordinates: {x: , y: , theta: }\npoints: {skate: \"[x, y]\"}\n\
        bodies: {sled: {mass: m, inertia: I, angle: theta, position: skate + d*sled.x}}\n\
        constraints: {edge: \"dot(velocity(skate), sled.y)\"}\noutputs: {speed: \"dot(velocity(skate), sled.x)\"}\n\
        events: {turns: {when: \"dot(velocity(skate), sled.x)\", then: record}}\n\
        scene: {start: {x: 0, y: 0, theta: 0, x': -1, y': 0, theta': 1e-3}, until: 60, tolerance: 1e-12}\n";
    let (fastest, c) = ((1.0 + 0.29e-6_f64).sqrt(), 0.3 / 0.29);
    let turns = (1.0 / fastest).atanh() / (c * fastest);
    for method in [Method::Auto, Method::Radau5] {
        let run = run(text, method, 1e-12);
        for state in run.states() {
            let speed = fastest * (c * fastest * (state.t - turns)).tanh();
            assert!((state["speed"] - speed).abs() < 1e-6, "{method} at {}: {} {speed}", state.t, state["speed"]);
        }
        assert!((run.last()["speed"] - 1.000000145).abs() < 1e-9, "{method}: {}", run.last()["speed"]);
        assert!((run.events[0].state.t - 7.945844).abs() < 1e-5, "{method}: {}", run.events[0].state.t);
    }
}

/// N5: a spin about the axis of intermediate inertia grows unstable at ω √((I₂ − I₁)(I₃ − I₂)/(I₁I₃)): 0.57735 for 1, 2, 3.
#[test]
fn n5_a_spin_about_the_intermediate_axis_is_unstable() {
    // Turned about z, y and x in this order; it spins about its x axis.
    let text = |[ix, iy, iz]: [f64; 3]| {
        format!(
            "name: Spin\nparameters: {{A: {ix}, B: {iy}, C: {iz}}}\ncoordinates: {{psi: , theta: , phi: }}\n\
             define: {{p: phi' - psi'*sin(theta), q: theta'*cos(phi) + psi'*cos(theta)*sin(phi), \
             r: psi'*cos(theta)*cos(phi) - theta'*sin(phi)}}\n\
             kinetic_energy: (A*p^2 + B*q^2 + C*r^2)/2\noutputs: {{q: q, r: r}}\n\
             scene: {{start: {{phi': 1, theta': 1e-7}}, until: 20, tolerance: 1e-12, every: 1}}\n"
        )
    };
    let sizes = |inertias: [f64; 3]| {
        let run = run(&text(inertias), Method::Auto, 1e-12);
        run.states().map(|state| state["q"].hypot(3.0_f64.sqrt() * state["r"])).collect::<Vec<_>>()
    };
    let grown = sizes([2.0, 1.0, 3.0]);
    let rate = (grown[19] / grown[10]).ln() / 9.0;
    assert!((rate / 0.57735 - 1.0).abs() < 0.01, "{rate}");
    // About the others it is not.
    for inertias in [[1.0, 2.0, 3.0], [3.0, 1.0, 2.0]] {
        assert!(sizes(inertias).iter().all(|size| *size < 1e-6));
    }
}

/// N6: a mass ε between two springs vibrates at √(2/ε): 14.16, 141.4, 1414.
#[test]
fn n6_what_is_nearly_massless_vibrates_ever_faster() {
    use dalembert::linear::{Guess, Reduction, equilibrium_near, linearise, normal_modes};
    for (epsilon, fastest) in [(1e-2, 14.16), (1e-4, 141.4), (1e-6, 1414.2)] {
        let case = Case::written(&format!(
            "name: Light\nparameters: {{e: {epsilon}}}\ncoordinates: {{x: , y: }}\nkinetic_energy: e*x'^2/2 + y'^2/2\n\
             potential_energy: x^2/2 + (y - x)^2/2\nscene: {{start: {{y: 1}}, until: 10}}\n"
        ));
        let rest = equilibrium_near(&*case.system, &Guess::at(&[0.0, 0.0])).expect("an equilibrium");
        let modes =
            normal_modes(&linearise(&*case.system, &rest).expect("M, C, K"), Reduction::Cholesky).expect("modes");
        let found = modes.iter().map(|mode| mode.omega).fold(0.0, f64::max);
        assert!((found / fastest - 1.0).abs() < 2e-3, "{epsilon}: {found}");
    }
}

/// N7: the ellipse of a spherical pendulum with semiaxes a and b turns at 3/8 ω a b: 2.347e-3 rad/s for a = 0.1, b = 0.02.
#[test]
fn n7_the_ellipse_of_a_spherical_pendulum_turns() {
    for method in [Method::Auto, Method::Dop853] {
        for (a, b) in [(0.1, 0.02), (0.2, 0.05)] {
            let omega = 9.81_f64.sqrt();
            let text = format!(
                "name: Bob\nparameters: {{g: 9.81}}\ncoordinates: {{x: , y: }}\n\
                 bodies: {{bob: {{mass: 1, position: \"[x, y, -sqrt(1 - x^2 - y^2)]\"}}}}\ngravity: [0, 0, -g]\n\
                 events: {{far: {{when: x*x' + y*y', direction: falling, then: record}}}}\n\
                 scene: {{start: {{x: {a}, y': {}}}, until: 60, tolerance: 1e-11}}\n",
                b * omega
            );
            let run = run(&text, method, 1e-11);
            let last = &run.events.last().expect("apsides").state;
            // Apsides alternate between one side and the other.
            let turned = (last["y"] / last["x"]).atan();
            let rate = turned / last.t;
            assert!(
                (rate / (0.375 * omega * a * b) - 1.0).abs() < 0.02,
                "{method}: {rate} of {}",
                0.375 * omega * a * b
            );
        }
    }
}

/// An ellipsoid that rolls on a plane without slipping, its axes of inertia turned against those of its surface, started
/// with this spin and pitch.
fn rattleback(spin: f64, pitch: f64, until: f64) -> Run {
    let text = format!(
        "
name: Rattleback
parameters: {{m: 1, g: 9.81, a: 0.2, b: 0.03, c: 0.02, I1: 2e-4, I2: 1.6e-3, I3: 1.7e-3, delta: 0.0143}}
coordinates: {{x: , y: , yaw: , roll: , pitch: }}
define:                                          # in the body's axes: the upward vertical, the spins, the centre's speed
  n1: -sin(pitch)*cos(roll)
  n2: sin(roll)
  n3: cos(roll)*cos(pitch)
  height: sqrt(a^2*n1^2 + b^2*n2^2 + c^2*n3^2)
  w1: roll'*cos(pitch) + yaw'*n1
  w2: pitch' + yaw'*n2
  w3: roll'*sin(pitch) + yaw'*n3
  v1: (w2*c^2*n3 - w3*b^2*n2)/height
  v2: (w3*a^2*n1 - w1*c^2*n3)/height
  v3: (w1*b^2*n2 - w2*a^2*n1)/height
points: {{centre: \"[x, y, height]\"}}
kinetic_energy: >-
  m*dot(velocity(centre), velocity(centre))/2 + (I1*(w1*cos(delta) - w2*sin(delta))^2
  + I2*(w2*cos(delta) + w1*sin(delta))^2 + I3*w3^2)/2
potential_energy: m*g*height
constraints:
  ahead: x'*cos(yaw) + y'*sin(yaw) = v1*cos(pitch) + v3*sin(pitch)
  aside: y'*cos(yaw) - x'*sin(yaw) = v2*cos(roll) - sin(roll)*(v3*cos(pitch) - v1*sin(pitch))
conserved: {{energy: energy}}
scene: {{start: {{yaw': {spin}, roll': 0, pitch': 0, pitch: {pitch}}}, until: {until}, tolerance: 1e-10, every: 1e-3}}
"
    );
    run(&text, Method::Auto, 1e-10)
}

/// N8: a rattleback that spins against its sense pitches ever more and turns round; the other way it goes on.  With the tilts n₁, n₂
/// the equations linear about the spin Ω (Bondi, Proc. R. Soc. A 405 (1986) 265) have the roots 1.69856 ± 101.1348 i, 1/s, for
/// Ω = 5 rad/s, and their negatives for −5, where only the slow roll, 0.068 ± 20.8 i, grows.
#[test]
fn n8_a_rattleback_turns_round() {
    let small = rattleback(5.0, 1e-6, 2.5);
    // The logarithm of the amplitude, its mean over a period.
    let size = |from: f64| {
        let states = small.states().filter(|state| (from..from + 2.0 * PI / 101.1348).contains(&state.t));
        let sizes: Vec<f64> = states.map(|state| state["pitch"].hypot(state["pitch'"] / 101.1348).ln()).collect();
        sizes.iter().sum::<f64>() / sizes.len() as f64
    };
    let rate = size(2.2) - size(1.2);
    assert!((rate / 1.69856 - 1.0).abs() < 1e-3, "{rate}");
    let (against, along) = (rattleback(5.0, 0.01, 6.0), rattleback(-5.0, 0.01, 6.0));
    assert!(against.last()["yaw'"] < -4.9, "{}", against.last()["yaw'"]);
    assert!(along.states().all(|state| state["yaw'"] < -4.7), "{}", along.last()["yaw'"]);
    for run in [against, along] {
        let drift = run.drift[0].value.expect("an energy");
        assert!(drift < 1e-8, "{drift:e}");
    }
}

/// A ball of which the centre of mass lies beside the middle, spun about the line through both, on a plane that drags what slides on it.
fn tippe_top(spin: f64) -> Run {
    let text = format!(
        "
name: TippeTop
parameters: {{m: 0.02, R: 0.02, e: 0.006, g: 9.81, A: 131/350*m*R^2, C: 2/5*m*R^2, c: 0.05}}
coordinates: {{x: , y: , phi: , theta: , psi: }}
define:
  w3: psi' + phi'*cos(theta)
  axis: \"[sin(theta)*sin(phi), -sin(theta)*cos(phi), cos(theta)]\"
  across: \"[-cos(theta)*sin(phi), cos(theta)*cos(phi), sin(theta)]\"
  turn: \"theta'*[cos(phi), sin(phi), 0] + phi'*sin(theta)*across + w3*axis\"
  slip: velocity(centre) + cross(turn, e*axis - R*[0, 0, 1])
points: {{centre: \"[x, y, R - e*cos(theta)]\"}}
kinetic_energy: m*dot(velocity(centre), velocity(centre))/2 + (A*(theta'^2 + (phi'*sin(theta))^2) + C*w3^2)/2
potential_energy: m*g*(R - e*cos(theta))
dissipation: c*dot(slip, slip)/2
conserved: {{jellett: R*(A*phi'*sin(theta)^2 + C*w3*cos(theta)) - e*C*w3}}
events: {{head: {{when: theta - 3.1, then: stop}}}}
outputs: {{spin: phi' + psi'*cos(theta)}}
scene: {{start: {{theta: 0.1, psi': {spin}}}, until: 20, tolerance: 1e-10}}
"
    );
    run(&text, Method::Auto, 1e-10)
}

/// N8: a tippe-top that spins fast turns over, by friction, and stands on its head; a slow one comes to stand upright.  Whatever the
/// friction, Jellett's constant R L·k − e L·s is kept (Routh, Advanced Part of a Treatise on the Dynamics of a System of Rigid Bodies,
/// 1905, art. 243), so that the spin falls by (R − e)/(R + e).
#[test]
fn n8_a_tippe_top_stands_on_its_head() {
    let (fast, slow) = (tippe_top(155.0), tippe_top(20.0));
    for run in [&fast, &slow] {
        let drift = run.drift[0].value.expect("a constant");
        assert!(drift < 1e-9, "{drift:e}");
    }
    let (head, upright) = (fast.last(), slow.last());
    assert!(fast.events.len() == 1 && (head["theta"] - 3.1).abs() < 1e-9, "{head}");
    assert!((head["spin"] / (155.0 * 0.014 / 0.026) - 1.0).abs() < 0.01, "{head}");
    assert!(upright["theta"].abs() < 1e-3 && (upright["spin"] - 20.0).abs() < 0.2, "{upright}");
}
