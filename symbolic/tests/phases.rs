//! Models with constraints and phases before the gate: what is false only in one phase, on one side or for a while is
//! refused there too, beside a neighbour that passes.

use dalembert_symbolic::gate::Origin;
use dalembert_symbolic::lower::compile;

/// The codes, messages and help of a file.
fn told(text: &str) -> Vec<String> {
    let problems = compile(text, &[]).err().unwrap_or_default();
    problems.iter().map(|problem| format!("{} {} {}", problem.code, problem.message, problem.help)).collect()
}

#[track_caller]
fn accepted(text: &str) {
    let found = told(text);
    assert!(found.is_empty(), "{text}\n{found:?}");
}

#[track_caller]
fn refused(text: &str, message: &str) {
    let found = told(text);
    assert!(found.iter().any(|line| line.contains(message)), "{text}\n{found:?}");
}

/// A pendulum in Cartesian coordinates, of this length.
fn pendulum(length: &str, lines: &str) -> String {
    format!(
        "name: Pendulum\nparameters: {{m: 1 kg, l: {length}, g: 10 m/s^2, c: 1 kg/s, tau: 1 s}}\n\
         coordinates: {{x: m, y: m}}\nbodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\n\
         constraints: {{rod: x^2 + y^2 - l^2}}\n{lines}\nscene: {{start: {{x: 0.6*l, y: -0.8*l}}, until: 5*sqrt(l/g)}}\n"
    )
}

/// A block that falls, slips and stops: each of these is a phase, and nothing comes after the last, in which it flies.
fn block(forces: &str, lines: &str) -> String {
    format!(
        "name: Block\nparameters: {{m: 1 kg, g: 10 m/s^2, R: 1 m, mu: 0.3, c: 1 kg/s, h: 3 m, T: 1 s, F: 2 N}}\n\
         coordinates: {{x: m, y: m}}\nbodies: {{block: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\n\
         constraints: {{floor: y, grip: x'}}\nphases: {{flight: [], slip: [floor], stick: [floor, grip], later: []}}\n\
         forces:\n  rub: {{on: block, force: \"[-mu*reaction(floor), 0]\", phase: slip}}\n{forces}\n{lines}\n\
         events:\n  land: {{phase: flight, when: y, direction: falling, then: slip}}\n  \
         halt: {{phase: slip, when: x', direction: falling, then: stick}}\n  \
         lift: {{phase: stick, when: t - 2*T, direction: rising, then: later}}\n\
         scene: {{start: {{x: 0, y: h, x': 2}}, until: 3}}\n"
    )
}

#[test]
fn bands_are_found_on_the_constraint() {
    accepted(&pendulum("1 m", "conserved: {energy: energy}"));
    let band = "forces: {d: {on: bob, force: \"-c*max(0, 1e-3 - abs(x/l - 0.4))*velocity(bob)\"}}\nconserved: {energy: energy}";
    refused(&pendulum("1 m", band), "`d` does work");
    for claim in ["max(0, 1e-3 - abs(x/l - 0.4))", "max(0, 1e-3 - abs(x'/sqrt(g*l) - 0.4))", "exp(-1e6*(x/l - 0.4)^2)"]
    {
        refused(&pendulum("1 m", &format!("conserved: {{a: \"energy + m*l*g*{claim}\"}}")), "not conserved");
    }
    refused(&pendulum("1 m", "checks: {a: \"step(x/l - 0.4)*step(0.401 - x/l) = 0\"}"), "does not hold");
    accepted(&pendulum("1 m", "checks: {a: \"step(x/l - 0.4)*step(0.4 - x/l - 1) = 0\"}"));
}

#[test]
fn constrained_models_are_judged_by_their_own_size() {
    for length in ["1e-9 m", "1 m", "1e9 m"] {
        let balance =
            |off: &str| format!("balances:\n  equations:\n    - equation: \"m*(x*y'' - y*x'') = -m*g*x{off}\"");
        refused(&pendulum(length, "conserved: {a: \"energy*(1 + 1e-12*x/l)\"}"), "not conserved");
        accepted(&pendulum(length, "conserved: {a: energy}"));
        refused(&pendulum(length, &balance("*(1 + 1e-12)")), "E506");
        accepted(&pendulum(length, &balance("")));
    }
}

/// Masses of 1e-27 kg beside rows of 1, nanometres beside radians.
#[test]
fn scales_of_constrained_models_are_no_reason_to_refuse() {
    let molecule = |claim: &str| {
        format!(
            "name: Molecule\nparameters: {{m: 1.6e-27 kg, D: 7e-19 J, a: 2e10 1/m, r0: 1e-10 m}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{p: {{mass: m, position: \"[x, y]\"}}}}\npotential_energy: D*(1 - exp(-a*(x - r0)))^2\n\
             constraints: {{line: y - x/2}}\nconserved: {{claim: {claim}}}\nscene: {{start: {{x: 1.2e-10 m}}, until: 1e-13}}\n"
        )
    };
    accepted(&molecule("energy"));
    refused(&molecule("m*(x'^2 + y'^2)/2"), "not conserved");
    for radius in [1e-9, 1e-3, 1.0, 1e6] {
        let inertia = radius * radius;
        let gear = |two: &str| {
            format!(
                "name: Gear\nparameters: {{m: 1 kg, r: {radius} m, J: {inertia} kg*m^2, T: {inertia} N*m}}\n\
                 coordinates: {{x: m, p: rad, q: rad}}\nbodies:\n  a: {{mass: m, position: \"[x, 0]\"}}\n  \
                 b: {{mass: 0, inertia: J, angle: p, position: \"[0*r, 0*r]\"}}\n  \
                 c: {{mass: 0, inertia: J, angle: q, position: \"[0*r, 0*r]\"}}\ntorques: {{t: {{on: b, torque: T}}}}\n\
                 constraints: {{one: x - r*p, two: {two}}}\nscene: {{start: {{x: 0, p: 0, q: 0, p': 1}}, until: 1}}\n"
            )
        };
        let program = compile(&gear("x - r*p - r*q"), &[]).unwrap_or_else(|problems| panic!("{radius}: {problems:?}"));
        assert_eq!((program.report.ranks.as_slice(), program.model.warnings.len()), ([2].as_slice(), 0), "{radius}");
        let redundant = compile(&gear("x/2 - r*p/2"), &[]).unwrap();
        assert_eq!(redundant.report.ranks, [1], "{radius}");
    }
}

/// What depends on accelerations and reactions changes sides with them.
#[test]
fn bands_of_reactions_and_accelerations() {
    for (of, other) in [("reaction(rod)*l/(m*g)", "-0.7"), ("x''/g", "0.3")] {
        let strip = |width: &str| {
            pendulum("1 m", &format!("checks: {{a: \"step({of} - ({other}))*step({other} + {width} - {of}) = 0\"}}"))
        };
        refused(&strip("1e-3"), "does not hold");
        accepted(&strip("(-1e-3)"));
    }
    refused(
        &pendulum("1 m", "checks: {a: \"reaction(rod)*2*l^2 = m*(g*y - x'^2 - y'^2)*(1 + 1e-12)\"}"),
        "does not hold",
    );
    accepted(&pendulum("1 m", "checks: {a: \"reaction(rod)*2*l^2 = m*(g*y - x'^2 - y'^2)\"}"));
}

#[test]
fn a_constraint_that_moves_for_a_while_does_work() {
    let lifted = |by: &str| {
        format!(
            "name: Lift\nparameters: {{m: 1 kg, l: 1 m, g: 10 m/s^2, T: 2 s}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{bob: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\nconstraints: {{floor: \"y - {by}\"}}\n\
             conserved: {{energy: energy}}\nscene: {{start: {{x: 0, x': 2}}, until: 20}}\n"
        )
    };
    // It is no force of the file that does it.
    refused(&lifted("l*exp(-((t - 8.885*T)*1000/T)^2)"), "not conserved: its rate");
    refused(&lifted("1e-9*x*sin(3*t/T)"), "not conserved");
    accepted(&lifted("2*l"));
}

/// What is claimed of a phase is judged on both sides of everything, in that phase.
#[test]
fn claims_and_balances_of_every_phase_are_judged_there() {
    for (phase, claim) in [("flight", "energy"), ("slip", "m*x'^2/2 + mu*m*g*x"), ("later", "energy")] {
        let conserved =
            |more: &str| block("", &format!("conserved: {{a: {{value: \"{claim}{more}\", phase: {phase}}}}}"));
        refused(&conserved(" + m*g*R*max(0, 1e-3 - abs(x/R - 0.53))"), "not conserved");
        accepted(&conserved(""));
        let check = |sides: &str| block("", &format!("checks: {{a: {{holds: \"{sides}\", phase: {phase}}}}}"));
        refused(&check("min(x/R, 3.5) = x/R"), "does not hold");
        accepted(&check("min(x/R, 3.5) = 3.5 + min(x/R - 3.5, 0)"));
        let damper =
            |place: &str| format!("  d: {{on: block, force: \"-c*step({place})*velocity(block)\", phase: {phase}}}");
        let energy = format!("conserved: {{a: {{value: \"{claim}\", phase: {phase}}}}}");
        assert!(!told(&block(&damper("x/R - 4"), &energy)).is_empty(), "{phase}");
        accepted(&block(&damper("-1 - x^2/R^2"), &energy));
    }
    let balance = |phase: &str, more: &str| {
        let lines = format!(
            "    phase: {phase}\n    equations:\n      - equation: \"m*x''{more} = 0\"\n      - equation: m*y'' = -m*g"
        );
        block("", &format!("balances:\n  mine:\n{lines}"))
    };
    for phase in ["flight", "later"] {
        refused(&balance(phase, " + 1e-3*m*g*step(x/R - 1.1)*step(1.1001 - x/R)"), "E506");
        refused(&balance(phase, " + 1e-3*m*g*step(t/T - 1.1)*step(1.1001 - t/T)"), "E506");
        accepted(&balance(phase, ""));
    }
}

/// Three things must be right at once: the motion passes there, and a search for what all factors of a product want leads there too.
#[test]
fn the_motion_is_followed_along_constraints_and_through_phases() {
    let spot = "step(0.01 - abs(x/R - 1.874))*step(0.01 - abs(t/T - 0.9636))*step(0.05 - abs(x'/(R/T) - 1.433))";
    let claim = |phase: &str, spot: &str| {
        block("", &format!("conserved: {{a: {{value: \"m*x'^2/2 + mu*m*g*x + 1e-6*m*g*x*{spot}\", phase: {phase}}}}}"))
    };
    refused(&claim("slip", spot), "not conserved");
    accepted(&claim("slip", "0"));
    let program = compile(&block("", ""), &[]).unwrap();
    let (_, reached, until) = &program.report.followed[0];
    assert!(reached > &(0.999 * until), "{reached} of {until}");
    let from_motion = |phase: usize| {
        let states = program.report.states.iter();
        states.filter(|s| s.phase == phase && s.origin == Origin::Motion).count()
    };
    assert!((0..4).all(|phase| from_motion(phase) > 0), "{:?}", [0, 1, 2, 3].map(from_motion));
}

/// Friction stands for no potential, nor does a force that acts for one phase: energy cannot count them.
#[test]
fn forces_of_phases_and_of_reactions_have_no_potential() {
    let energy = "conserved: {a: {value: energy, phase: slip}}";
    let found = told(&block("", energy));
    assert!(found.iter().any(|line| line.contains("depends on reactions")), "{found:?}");
    let push = "  push: {on: block, force: \"[F, 0]\", phase: slip}";
    let found = told(&block(push, energy).replace("[-mu*reaction(floor), 0]", "[0*F, 0]"));
    assert!(found.iter().any(|line| line.contains("acts in some phases only")), "{found:?}");
    assert!(found.iter().all(|line| !line.contains("put it in")), "{found:?}");
    let forces = compile(&block(push, ""), &[]).unwrap().report.forces;
    assert!(forces.is_empty(), "{forces:?}");
    // One that acts in all of them has a potential.
    let forces = compile(&block(&push.replace(", phase: slip", ""), ""), &[]).unwrap().report.forces;
    assert_eq!(forces.len(), 1, "{forces:?}");
}

#[test]
fn hundreds_of_phases_are_all_judged() {
    let many = |n: usize, claimed: usize, claim: &str| {
        let phases: Vec<String> = (0..n).map(|k| format!("p{k}: [{}]", ["floor", ""][k % 2])).collect();
        format!(
            "name: Many\nparameters: {{m: 1 kg, g: 10 m/s^2}}\ncoordinates: {{x: m, y: m}}\n\
             bodies: {{block: {{mass: m, position: \"[x, y]\"}}}}\ngravity: [0, -g]\nconstraints: {{floor: y}}\n\
             phases: {{{}}}\nconserved: {{a: {{value: \"{claim}\", phase: p{claimed}}}}}\n",
            phases.join(", ")
        )
    };
    for claimed in [0, 1, 150, 299] {
        refused(&many(300, claimed, "energy + m*g*x"), "not conserved");
        accepted(&many(300, claimed, "energy"));
    }
}
