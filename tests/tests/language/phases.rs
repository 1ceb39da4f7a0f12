//! Section 6: phases, and what enters them.

use dalembert::{Cause, Error, Run};
use dalembert_tests::case::Case;

use crate::near;

/// A particle on a line that goes from 0 with unit speed where nothing acts; without units.
fn runner(more: &str) -> Case {
    Case::written(&format!(
        "name: Runner
parameters: {{m: 2, k: 1, e: 0.5}}
coordinates: {{x: 1, y: 1}}
bodies: {{bead: {{mass: m, position: \"[x, y]\"}}}}
{more}"
    ))
}

/// Its scene.
const GOES: &str = "scene: {start: {x: 0, x': 1}, until: 4, tolerance: 1e-12}";

/// The names of events that happened.
fn names(run: &Run) -> Vec<&str> {
    run.events.iter().map(|event| event.name.as_str()).collect()
}

/// Why a run failed.
#[track_caller]
fn cause(case: &mut Case) -> Cause {
    match case.try_run() {
        Err(Error::Run(failure)) => failure.cause,
        Err(error) => panic!("{error}"),
        Ok(run) => panic!("it runs: {}", run.last()),
    }
}

#[test]
fn the_first_phase_is_the_initial_one_unless_a_scene_names_another() {
    let phases = "constraints: {hold: x}\nphases: {free: [], held: [hold]}\n";
    let scenes = "scene: {start: {x': 1}, until: 1}\nscenes: {still: {phase: held, start: {}}}";
    near(runner(&format!("{phases}{scenes}")).run().last()["x"], 1.0, 1e-14);
    assert_eq!(runner(&format!("{phases}{scenes}")).scene("still").run().last()["x"], 0.0);
}

/// Springs, dampers, forces and torques, each alone, act from t = 1 to t = 2.
#[test]
fn what_carries_a_phase_acts_in_that_phase_only() {
    let entries = [
        ("forces: {f: {on: bead, force: \"[m, 0]\", phase: on}}", 1.0),
        ("forces: {f: {on: bead, force: \"[m, 0]\", phase: [on, never]}}", 1.0),
        ("springs: {s: {stretch: x - 1, stiffness: k, on: bead, along: \"[1, 0]\", phase: on}}", f64::NAN),
        ("dampers: {d: {rate: x', damping: 2*k, on: bead, along: \"[1, 0]\", phase: on}}", f64::NAN),
    ];
    for (entry, pushed) in entries {
        let events = "{begin: {when: t - 1, phase: before, then: on}, end: {when: t - 2, phase: on, then: after}}";
        let phases = format!("phases: {{before: [], on: [], after: [], never: []}}\nevents: {events}\n");
        let scene = "scene: {start: {x: 0, x': 1}, until: 3, tolerance: 1e-12, every: 0.5}";
        let run = runner(&format!("{phases}{entry}\n{scene}")).run();
        let at = |t: f64| run.states().find(|state| state.t == t).expect("a report")["x'"];
        assert_eq!((at(0.5), at(2.5)), (1.0, at(3.0)), "{entry}");
        near(at(1.0), 1.0, 1e-14);
        // Forces by m, springs of x'' = −k/m (x − 1), dampers of x'' = −2 k/m x'.
        let spring = 0.5_f64.sqrt().cos();
        let damper = (-1.0_f64).exp();
        let expected = if entry.contains("force") {
            1.0 + pushed
        } else if entry.contains("spring") {
            spring
        } else {
            damper
        };
        near(at(2.5), expected, 1e-10);
    }
}

#[test]
fn a_torque_with_a_phase_acts_there_only() {
    let run = Case::written(
        "name: Wheel
parameters: {I: 2 kg*m^2, T: 3 N*m, s: 1 s}
coordinates: {phi: rad}
bodies: {wheel: {mass: 0, inertia: I, angle: phi, position: [0, 0]}}
phases: {idle: [], driven: []}
torques: {motor: {on: wheel, torque: T, phase: driven}}
events: {start_up: {when: t - s, then: driven}}
scene: {until: 3}",
    )
    .run();
    near(run.last()["phi'"], 3.0, 1e-12);
    near(run.last()["phi"], 3.0, 1e-12);
}

#[test]
fn a_claim_with_a_phase_is_watched_in_that_phase_only() {
    let model = |phase: &str| {
        runner(&format!(
            "phases: {{free: [], pushed: []}}
forces: {{f: {{on: bead, force: \"[-m, 0]\", phase: pushed}}}}
events: {{push: {{when: t - 2, then: pushed}}}}
conserved: {{momentum: {{value: m*x', phase: {phase}}}}}
{GOES}"
        ))
    };
    let run = model("free").run();
    near(run.last()["x'"], -1.0, 1e-14);
    let [drift] = run.drift.as_slice() else { panic!("{:?}", run.drift) };
    assert!(drift.value.is_some_and(|drift| drift < 1e-14), "{drift:?}");
}

/// E8 in words: what is lost is the energy of the lost speeds in the metric of M, and the impulse is told.
#[test]
fn entering_a_phase_with_more_constraints_projects_the_velocities_in_the_metric_of_m() {
    let run = Case::written(
        "name: Tow
parameters: {m: 2 kg, M: 6 kg, l: 1 m}
coordinates: {a: m, b: m}
bodies: {front: {mass: m, position: \"[a, 0]\"}, cart: {mass: M, position: \"[b, 1]\"}}
constraints: {rope: a - b - l}
phases: {slack: [], taut: [rope]}
events: {jerk: {when: a - b - l, phase: slack, direction: rising, then: taut}}
scene: {start: {a': 4}, until: 1, tolerance: 1e-12}",
    )
    .run();
    near(run.last()["a'"], 1.0, 1e-12);
    near(run.last()["b'"], 1.0, 1e-12);
    let [impulse] = run.impulses.as_slice() else { panic!("{:?}", run.impulses) };
    near(impulse.t, 0.25, 1e-12);
    assert_eq!(impulse.constraints[0].0, "rope");
    near(impulse.constraints[0].1, -6.0, 1e-12);
}

#[test]
fn positions_of_entering_holonomic_constraints_must_hold() {
    let events = "events: {hold_: {when: t - 1, phase: free, then: held}}";
    let model =
        |c: &str| runner(&format!("constraints: {{hold: {c}}}\nphases: {{free: [], held: [hold]}}\n{events}\n{GOES}"));
    near(model("x - 1").run().last()["x"], 1.0, 1e-14);
    let Cause::PhaseMisses { phase, constraint, residual } = cause(&mut model("x - 1.25")) else { panic!("a motion") };
    assert_eq!((phase.as_str(), constraint.as_str()), ("held", "hold"));
    near(residual, -0.25, 1e-12);
}

/// The cylinder grips after a slip: x − R φ stays what it was.
#[test]
fn the_integral_of_an_entering_velocity_constraint_takes_the_value_it_has_there() {
    let run = Case::written(
        "name: Disc
parameters: {m: 2 kg, R: 0.5 m, s: 1 s}
coordinates: {x: m, phi: rad}
bodies: {disc: {mass: m, inertia: m*R^2/2, angle: -phi, position: \"[x, R]\"}}
constraints: {no_slip: x' - R*phi'}
phases: {slips: [], rolls: [no_slip]}
events: {grip: {when: t - s, phase: slips, then: rolls}}
outputs: {turned: x - R*phi}
scene: {start: {x': 3}, until: 5, every: 0.5}",
    )
    .run();
    for state in run.states().filter(|state| state.t >= 1.0) {
        near(state["turned"], 3.0, 1e-13);
    }
    // m x' + I φ'/R is kept: two thirds of the speed.
    near(run.last()["x'"], 2.0, 1e-12);
}

/// What an event may be named is not what a phase may.
#[test]
fn phases_and_constraints_are_labels() {
    let run = runner(&format!(
        "constraints: {{x: x - 1, bead: y}}
phases: {{x: [bead], m: [x, bead]}}
events: {{x: {{when: x - 1, phase: x, then: m}}}}
{GOES}"
    ))
    .run();
    assert_eq!(names(&run), ["x"]);
    near(run.last()["x"], 1.0, 1e-14);
    assert_eq!(run.phases.iter().map(|(_, phase)| *phase).collect::<Vec<_>>(), [0, 1]);
}

/// From a to b and back at one instant, without end.
#[test]
fn a_cycle_of_firings_at_one_instant_is_chattering() {
    let phases = "phases: {a: [], b: []}\nevents:\n  go: {when: x - 1, phase: a, direction: rising, then: b}\n";
    let back = "  back: {when: x - 1/2, phase: b, direction: rising, then: a}\n";
    let Cause::Chattering { switch, is_rate: false } = cause(&mut runner(&format!("{phases}{back}{GOES}"))) else {
        panic!("a motion")
    };
    assert!(["go", "back"].contains(&switch.as_str()), "{switch}");
    // Beyond reach, b is left where x is 3/2.
    let run = runner(&format!("{phases}{}{GOES}", back.replace("1/2", "3/2").replace("then: a", "then: stop"))).run();
    assert_eq!(names(&run), ["go", "back"]);
}

/// A block that slides to rest, with a system of balances for each of its phases.
const BLOCK: &str = "
name: Block
parameters: {m: 1 kg, g: 10 m/s^2, mu: 0.3 1, F: 1 N, v: 2 m/s}
coordinates: {x: m, y: m}
bodies: {block: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {floor: y, grip: x'}
phases: {slip: [floor], stick: [floor, grip]}
forces:
  rub: {on: block, force: \"[-mu*reaction(floor), 0]\", phase: slip}
  pull: {on: block, force: \"[F, 0]\"}
events: {stops: {phase: slip, when: x', direction: falling, then: stick}}
balances:
  sliding:
    equations:
      - force: {of: [block]}
      - equation: normal = reaction(floor)
    reactions: {normal: {on: block, along: \"[0, 1]\"}}
  both:
    phase: [stick]
    equations: [force: {of: [block]}]
    reactions: {hold: {on: block, along: \"[1, 0]\"}, normal: {on: block, along: \"[0, 1]\"}}
outputs: {normal: normal, hold: hold, grip: reaction(grip)}
scene: {start: {x: 0, x': v}, until: 2, every: 0.25}
";

#[test]
fn balances_belong_to_the_initial_phase_or_to_those_they_name() {
    let run = Case::written(BLOCK).run();
    let at = |t: f64| run.states().find(|state| state.t == t).expect("a report");
    // A named reaction is that of the system of the active phase, absent where there is none.
    assert!(!at(0.5)["hold"].is_finite());
    near(at(0.5)["normal"], 10.0, 1e-12);
    near(at(1.5)["hold"], -1.0, 1e-12);
    near(at(1.5)["grip"], -1.0, 1e-12);
    assert_eq!(at(0.5)["grip"], 0.0);
    for (system, phase, t) in [("sliding", "stick", 1.0), ("both", "slip", 0.0)] {
        let Err(Error::Run(failure)) = Case::written(BLOCK).by(system).try_run() else { panic!("a motion") };
        let Cause::NoBalances { phase: found, .. } = failure.cause else { panic!("{}", failure.cause) };
        assert_eq!(found, phase);
        near(failure.run.last().t, t, 1e-12);
    }
}

/// Two phases with systems that name one reaction, and one without a system.
const TIED: &str = "
name: Tied
parameters: {m: 1 kg, g: 10 m/s^2, v: 2 m/s, F: 3 N, s: 1 s}
coordinates: {x: m, y: m}
bodies: {block: {mass: m, position: \"[x, y]\"}}
gravity: [0, -g]
constraints: {floor: y, tie: x' - 2*y' - v}
phases: {alone: [floor], tied: [floor, tie], flies: []}
forces: {pull: {on: block, force: \"[F, 0]\"}}
events:
  ties: {when: t - s, phase: alone, then: tied}
  off: {when: t - 2*s, phase: tied, then: flies}
balances:
  alone:
    equations: [force: {of: [block]}]
    reactions: {normal: {on: block, along: \"[0, 1]\"}}
  tied:
    phase: tied
    equations: [force: {of: [block]}]
    reactions: {normal: {on: block, along: \"[0, 1]\"}, rope: {on: block, along: \"[1, -2]\"}}
outputs: {normal: normal, rope: rope, floor: reaction(floor), tie: reaction(tie)}
scene: {start: {x: 0, x': v}, until: 3, every: 0.3}
";

#[test]
fn a_named_reaction_has_in_each_phase_the_value_that_the_system_of_that_phase_gives() {
    let run = Case::written(TIED).run();
    for state in run.states() {
        let phase = run.phases.iter().rev().find(|(begins, _)| *begins <= state.t).expect("a phase").1;
        if phase == 2 {
            assert!(!state["normal"].is_finite() && !state["rope"].is_finite());
            continue;
        }
        near(state["normal"], state["floor"], 1e-12);
        // The constraint's row is (1, −2) in x' and y'.
        match phase {
            0 => assert!(!state["rope"].is_finite()),
            _ => near(state["rope"], 5.0_f64.sqrt() * state["tie"], 1e-12),
        }
    }
    assert_eq!(run.phases.len(), 3);
}
