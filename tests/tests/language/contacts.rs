//! Mechanisms whose contacts come and go, written from LANGUAGE.md alone, against closed forms.

use dalembert_tests::case::Case;

use crate::near;

/// A smooth ladder against a wall.
const LADDER: &str = "
name: Ladder
about: A smooth ladder slides down a wall, leaves it at two thirds of its height, and goes on along the floor.
parameters: {m: 10 kg, l: 4 m, g: 10 m/s^2, a0: 1.2 rad}
coordinates: {x: m, y: m, a: rad}
points: {top: \"[x, y] - l/2*[cos(a), -sin(a)]\", foot: \"[x, y] + l/2*[cos(a), -sin(a)]\"}
bodies: {ladder: {mass: m, inertia: m*l^2/12, angle: -a, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {wall: top.x, floor: foot.y}
phases: {leans: [wall, floor], slides: [floor], lies: [floor]}
events:
  leaves: {phase: leans, when: reaction(wall), direction: falling, then: slides}
  flat: {phase: slides, when: sin(a), direction: falling, then: stop}
conserved: {energy: energy}
outputs: {wall: reaction(wall), floor: reaction(floor), height: top.y}
scene: {start: {a: a0}, until: 5, tolerance: 1e-11}
";

/// It leaves the wall at two thirds of its height, and the floor carries a quarter of its weight when it lies down.
#[test]
fn a_smooth_ladder_leaves_its_wall_at_two_thirds_of_its_height() {
    let run = Case::written(LADDER).run();
    let [leaves, flat] = run.events.as_slice() else { panic!("{:?}", run.events) };
    near(leaves.state["height"], 4.0 * 1.2_f64.sin() * 2.0 / 3.0, 1e-9);
    assert_eq!(flat.name, "flat");
    near(run.last()["floor"], 10.0 * 10.0 / 4.0, 1e-8);
    near(run.last()["wall"], 0.0, 0.0);
}

/// A bob on a string that goes slack.
const STRING: &str = "
name: SlackString
about: A bob on a string that goes slack and taut again, without bouncing.
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, v: 6 m/s}
coordinates: {x: m, y: m}
bodies: {bob: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {string: norm(bob) - l}
phases: {taut: [string], slack: []}
events:
  loose: {phase: taut, when: -reaction(string), direction: falling, then: slack}
  jerk: {phase: slack, when: norm(bob) - l, direction: rising, then: taut}
outputs: {tension: -reaction(string), angle: \"atan2(x, -y)\"}
scene: {start: {x: 0, y: -l, x': v}, until: 10, tolerance: 1e-11}
";

/// Slack at cos θ = (2 g l − v²)/(3 g l), and taut again 4 u cos φ/g later, u and φ being speed and height over the middle.
#[test]
fn a_string_goes_slack_and_taut_again() {
    let run = Case::written(STRING).run();
    let [loose, jerk] = run.events.as_slice() else { panic!("{:?}", run.events) };
    let sine: f64 = (36.0 - 20.0) / 30.0;
    near(loose.state["angle"].cos(), -sine, 1e-10);
    let speed = (10.0 * sine).sqrt();
    near(jerk.state.t - loose.state.t, 4.0 * speed * (1.0 - sine * sine).sqrt() / 10.0, 1e-9);
    // The speed along the string is lost, and with it the energy that would lift it to slackness once more.
    let [impulse] = run.impulses.as_slice() else { panic!("{:?}", run.impulses) };
    assert!(impulse.constraints[0].1 < 0.0);
    near(run.last()["x"].hypot(run.last()["y"]), 1.0, 1e-12);
}

/// A wheel of spokes without a rim (McGeer 1990).
const RIMLESS: &str = "
name: RimlessWheel
about: A wheel of n spokes without a rim falls from spoke to spoke down a slope; each landing is plastic.
sizes: {n: 8}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2, slope: 0.1 rad, I: 0.2 kg*m^2}
coordinates: {x: m, y: m, a: rad}
points:
  \"tip[i in 0..n]\": \"[x, y] + l*[sin(a - 2*pi*i/n), -cos(a - 2*pi*i/n)]\"
bodies: {wheel: {mass: m, inertia: I, angle: a, position: \"[x, y]\"}}
gravity: g*[sin(slope), -cos(slope)]
constraints:
  \"pin[i in 0..n-1]\": velocity(wheel, tip[i])
phases: {\"on[i in 0..n-1]\": [\"pin[i]\"]}
events:
  \"land[i in 0..n-1]\": {phase: \"on[i]\", when: \"tip[mod(i + n - 1, n)].y\", direction: falling, then: \"on[mod(i + n - 1, n)]\"}
  \"slip[i in 0..n-1]\": {phase: \"on[i]\", when: \"reaction(pin[i]).y\", direction: falling, then: stop}
outputs: {energy: energy, n: \"sum(reaction(pin[i]).y, i in 0..n-1)\"}
scene: {start: {x: 0, y: l, a: 0, \"a'\": -1.2}, until: 8, tolerance: 1e-11}
";

/// Every landing keeps (I + m l² cos(2π/n))/(I + m l²) of the rate, every fall adds the same energy.
#[test]
fn a_rimless_wheel_falls_from_spoke_to_spoke() {
    let run = Case::written(RIMLESS).run();
    assert_eq!(run.events.len(), 12);
    assert_eq!(run.phases.len(), 13);
    let (inertia, n) = (0.2 + 1.0, 8.0_f64);
    let kept = (0.2 + (std::f64::consts::TAU / n).cos()) / inertia;
    // From landing to landing the hub falls 2 l sin(π/n) sin(slope).
    let fall = 2.0 * (std::f64::consts::PI / n).sin() * 0.1_f64.sin();
    for pair in run.events.windows(2) {
        let (before, after) = (pair[0].state["a'"], pair[1].state["a'"]);
        near(after * after, (kept * before).powi(2) + 2.0 * 10.0 * fall / inertia, 1e-8);
    }
}

/// A plank on two rough rollers that turn towards each other.
const PLANK: &str = "
name: TwoContacts
about: A plank on two rough rollers that turn towards each other (friction makes it swing), with both normal forces as reactions.
parameters: {m: 4 kg, b: 1 m, h: 0.1 m, mu: 0.3 1, g: 10 m/s^2}
coordinates: {x: m, y: m, a: rad}
bodies: {plank: {mass: m, inertia: m*b^2, angle: a, position: \"[x, y]\"}}
gravity: [0, -g]
points:
  left: \"[x, y] + (-b - x)*plank.x - h*plank.y\"
  right: \"[x, y] + (b - x)*plank.x - h*plank.y\"
constraints: {on_left: left.y, on_right: right.y}
forces:
  rub_left: {on: plank, at: left, force: \"[mu*reaction(on_left), 0]\"}
  rub_right: {on: plank, at: right, force: \"[-mu*reaction(on_right), 0]\"}
outputs: {n1: reaction(on_left), n2: reaction(on_right), level: y - h}
scene: {start: {x: 0.3, y: h, a: 0, x': 0}, until: 5, tolerance: 1e-11}
";

/// Both normal forces are solved together with the friction that they cause: ω² = μ g/(b − μ h).
#[test]
fn a_plank_on_two_rollers_swings() {
    let omega = (0.3 * 10.0 / (1.0 - 0.3 * 0.1_f64)).sqrt();
    let last = Case::written(PLANK).run().last();
    near(last["x"], 0.3 * (5.0 * omega).cos(), 1e-9);
    near(last["n1"] + last["n2"], 40.0, 1e-10);
}

/// A ball that slides, and then rolls.
const SNOOKER: &str = "
name: Snooker
about: A ball that slides, and then rolls.
parameters: {m: 0.2 kg, R: 0.03 m, mu: 0.2 1, g: 9.81 m/s^2}
coordinates: {x: m, y: m, phi: rad}
points: {touch: \"[x, y - R]\"}
bodies: {ball: {mass: m, inertia: 2*m*R^2/5, angle: -phi, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {cloth: y - R, roll: x' - R*phi'}
phases: {slides: [cloth], rolls: [cloth, roll], slides_back: [cloth]}
forces:
  rub: {on: ball, at: touch, force: \"[-mu*reaction(cloth), 0]\", phase: slides}
  rub_back: {on: ball, at: touch, force: \"[mu*reaction(cloth), 0]\", phase: slides_back}
events:
  grips: {phase: slides, when: x' - R*phi', direction: falling, then: rolls}
  slips: {phase: rolls, when: mu*reaction(cloth) - abs(reaction(roll)), direction: falling, then: slides}
scene: {start: {x: 0, x': 2, phi: 0, phi': -20}, until: 2, tolerance: 1e-11}
";

#[test]
fn a_sliding_ball_comes_to_roll() {
    let run = Case::written(SNOOKER).run();
    let slip = 2.0 + 0.03 * 20.0;
    near(run.events[0].state.t, 2.0 / 7.0 * slip / (0.2 * 9.81), 1e-11);
    near(run.last()["x'"], (5.0 * 2.0 - 2.0 * 0.03 * 20.0) / 7.0, 1e-12);
    assert_eq!(run.events.len(), 1);
}
