//! What model files say of constraints, reactions, phases and starts (LANGUAGE, sections 6 and 9), one test a sentence.

use dalembert_symbolic::expr::{Id, Symbol, Tape};
use dalembert_symbolic::model::{EventAction, Model, Work, load, text};

/// A model without problems.
#[track_caller]
fn model(file: &str) -> Model {
    load(file, &[]).unwrap_or_else(|problems| {
        let told: Vec<String> = problems.iter().map(|p| format!("{} {} at {:?}", p.code, p.message, p.place)).collect();
        panic!("{file}\n{}", told.join("\n"))
    })
}

/// A whole file of LANGUAGE.md, section 12.
fn whole_file(name: &str) -> Model {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/LANGUAGE.md")).unwrap();
    let start = page.find(&format!("```yaml\nname: {name}\n")).unwrap() + "```yaml\n".len();
    let end = start + page[start..].find("```").unwrap();
    model(&page[start..end])
}

/// The words of expressions.
fn words(model: &Model, values: &[Id]) -> Vec<String> {
    values.iter().map(|value| text(model, *value)).collect()
}

/// The value of an expression of parameters.
fn number(model: &Model, value: Id) -> f64 {
    Tape::new(&model.graph, &[value]).evaluate(|symbol| match symbol {
        Symbol::Parameter(k) => model.parameters[k as usize].default,
        _ => f64::NAN,
    })[0]
}

/// A bead in the plane with some constraints.
const BEAD: &str = "name: Bead
parameters: {m: 1 kg, l: 2 m, mu: 0.5 1, v: 3 m/s, g: 10 m/s^2, e: 0.8 1}
coordinates: {x: m, y: m, phi: rad}
bodies: {bead: {mass: m, position: \"[x, y]\"}, wheel: {mass: m, inertia: m*l^2, angle: -phi, position: \"[x, y]\"}}
";

fn bead(more: &str) -> Model {
    model(&format!("{BEAD}{more}\n"))
}

#[test]
fn the_sleigh_has_one_velocity_constraint_that_always_acts() {
    let sleigh = whole_file("ChaplyginSleigh");
    let [edge] = sleigh.constraints.as_slice() else { panic!("{:?}", sleigh.constraints) };
    assert_eq!((edge.name.as_str(), edge.scalar, edge.holonomic, edge.first), ("edge", true, false, 0));
    assert_eq!(edge.unit.as_deref(), Some("m/s"));
    let [phase] = sleigh.phases.as_slice() else { panic!("{:?}", sleigh.phases) };
    assert_eq!((phase.name.as_str(), phase.constraints.as_slice()), ("", &[0][..]));
    let [system] = sleigh.balances.as_slice() else { panic!() };
    assert_eq!((system.balances.len(), system.phases.as_slice()), (2, &[0][..]));
}

#[test]
fn a_constraint_vanishes_and_an_equation_is_the_difference_of_its_sides() {
    let model = bead("constraints: {rod: x^2 + y^2 - l^2, floor: y = l, belt: x' - v}");
    let values: Vec<Id> = model.constraints.iter().map(|c| c.value[0]).collect();
    assert_eq!(words(&model, &values), ["x^2 + y^2 - l^2", "y - l", "x' - v"]);
    let kinds: Vec<bool> = model.constraints.iter().map(|c| c.holonomic).collect();
    assert_eq!(kinds, [true, true, false]);
    let units: Vec<Option<&str>> = model.constraints.iter().map(|c| c.unit.as_deref()).collect();
    assert_eq!(units, [Some("m^2"), Some("m"), Some("m/s")]);
}

#[test]
fn a_vector_gives_a_row_for_each_component_in_the_order_of_the_file() {
    let file = "constraints: {a: x - y, pin: position(bead) - l*wheel.x, b: \"[x, y] = 0\", \"c[i in 1..2]\": x - i*y}
outputs: {all: \"reaction(a) + reaction(c[2])*1\", of: reaction(pin), up: reaction(b).y}";
    let model = bead(file);
    let rows: Vec<(usize, usize, bool)> =
        model.constraints.iter().map(|c| (c.first, c.value.len(), c.scalar)).collect();
    assert_eq!(rows, [(0, 1, true), (1, 2, false), (3, 2, false), (5, 1, true), (6, 1, true)]);
    assert_eq!(model.constraints[4].name, "c[2]");
    assert_eq!(words(&model, &model.outputs[1].value), ["reaction(pin).x", "reaction(pin).y"]);
    assert_eq!(words(&model, &model.outputs[2].value), ["reaction(b).y"]);
    assert_eq!(words(&model, &model.outputs[0].value), ["reaction(a) + reaction(c[2])"]);
}

#[test]
fn a_reaction_is_work_per_unit_of_what_has_no_velocity_and_else_power() {
    let file = "constraints: {rod: x^2 + y^2 - l^2, floor: y, roll: x' - l*phi', turn: phi}
outputs: {rod: -2*l*reaction(rod), rho: reaction(rod), n: reaction(floor), f: reaction(roll), m: reaction(turn)}";
    let model = bead(file);
    let units: Vec<Option<&str>> = model.outputs.iter().map(|o| o.unit.as_deref()).collect();
    assert_eq!(units, [Some("N"), Some("N/m"), Some("N"), Some("N"), Some("N*m")]);
}

#[test]
fn reactions_stand_in_outputs_events_checks_equations_definitions_and_linearly_in_forces_and_torques() {
    let file = "constraints: {floor: y - l, roll: x' - l*phi'}
define: {normal: reaction(floor), twice: 2*normal}
forces: {rub: {on: wheel, at: \"[x, y - l]\", force: \"[-mu*normal*(1 + (x'/v)^2)*sin(phi), 0]\"}}
torques: {hold: {on: wheel, torque: -l*mu*reaction(floor)/3}}
events: {lift: {when: reaction(floor), if: abs(reaction(roll)) - mu*twice, then: stop}}
checks: {weight: reaction(floor) = 2*m*g}
outputs: {ratio: abs(reaction(roll))/reaction(floor)}";
    let model = bead(file);
    let push = model.loads[0].pushes[0].force[0];
    assert!(text(&model, push).contains("reaction(floor)"), "{}", text(&model, push));
    assert_eq!(words(&model, &[model.events[0].when]), ["reaction(floor)"]);
    assert_eq!(words(&model, &model.checks[0].left), ["reaction(floor)"]);
}

#[test]
fn without_phases_there_is_one_with_all_constraints_or_none() {
    let free = bead("");
    assert_eq!(free.phases.len(), 1);
    assert!(free.phases[0].name.is_empty() && free.phases[0].constraints.is_empty());
    let held = bead("constraints: {a: x, b: y'}");
    assert_eq!(held.phases[0].constraints, [0, 1]);
}

#[test]
fn phases_list_their_constraints_and_the_first_is_the_initial_one() {
    let model = bead(
        "sizes: {n: 3}
constraints: {\"c[i in 1..n]\": x - i*y, floor: y}
phases: {held: [floor, \"c[i in 2..n]\"], \"only[i in 1..2]\": [\"c[i]\"], free: []}
scene: {start: {x: 0}}
scenes: {late: {phase: free}, second: {phase: \"only[2]\"}}",
    );
    let phases: Vec<(&str, &[usize])> =
        model.phases.iter().map(|p| (p.name.as_str(), p.constraints.as_slice())).collect();
    assert_eq!(phases, [("held", &[3, 1, 2][..]), ("only[1]", &[0]), ("only[2]", &[1]), ("free", &[])]);
    let starts: Vec<usize> = model.scenes.iter().map(|scene| scene.phase).collect();
    assert_eq!(starts, [0, 3, 2]);
}

#[test]
fn a_start_holds_what_it_names_and_a_guess_is_where_the_rest_is_searched() {
    let model = bead(
        "constraints: {rod: x^2 + y^2 - l^2}
scene: {start: {x: 1, y': 2}, guess: {y: -l, x: 7}}
scenes: {other: {start: {y: 1}}, third: {guess: {phi: 30 deg}}}",
    );
    let scene = &model.scenes[0];
    assert_eq!(
        (scene.held_q.as_slice(), scene.held_v.as_slice()),
        (&[true, false, false][..], &[false, true, false][..])
    );
    assert!(scene.guessed);
    let q: Vec<f64> = scene.q.iter().map(|x| number(&model, *x)).collect();
    assert_eq!(q, [1.0, -2.0, 0.0]);
    assert_eq!(number(&model, scene.v[1]), 2.0);
    let q: Vec<f64> = model.scenes[1].q.iter().map(|x| number(&model, *x)).collect();
    assert_eq!(q, [7.0, 1.0, 0.0], "a guess is inherited, a start replaces the whole map");
    let q: Vec<f64> = model.scenes[2].q.iter().map(|x| number(&model, *x)).collect();
    assert_eq!(q[..2], [1.0, 0.0], "a guess replaces the whole map");
    assert!((q[2].to_degrees() - 30.0).abs() < 1e-12);
}

#[test]
fn without_constraints_what_a_start_leaves_out_is_0() {
    let model = bead(
        "constraints: {rod: x^2 + y^2 - l^2}
phases: {held: [rod], free: []}
scene: {start: {x: 1}, guess: {y: -l}}
scenes: {thrown: {phase: free}}",
    );
    assert_eq!(number(&model, model.scenes[0].q[1]), -2.0);
    assert_eq!(number(&model, model.scenes[1].q[1]), 0.0);
    assert!(!model.scenes[1].guessed);
}

#[test]
fn also_adds_equations_on_what_is_conserved_or_an_output() {
    let model = bead(
        "conserved: {spin: m*(x*y' - y*x')}
outputs: {tip: \"[x + y, x - y]\", \"a[i in 1..2]\": x + i*y, spin: m*(x*y' - y*x')}
scene: {also: {spin: 0, tip: [1, 2 m], \"a[i in 1..2]\": [3, 50 cm]}}
scenes: {none: {also: {}}, zero: {also: {tip: 0}}}",
    );
    let start_conditions = &model.scenes[0].start_conditions;
    let quantities: Vec<Id> = start_conditions.iter().map(|(quantity, _)| *quantity).collect();
    assert_eq!(quantities[0], model.conserved[0].value[0]);
    assert_eq!(words(&model, &quantities[1..]), ["x + y", "x - y", "x + y", "x + 2*y"]);
    let values: Vec<f64> = start_conditions.iter().map(|(_, value)| number(&model, *value)).collect();
    assert_eq!(values, [0.0, 1.0, 2.0, 3.0, 0.5]);
    assert!(model.scenes[1].start_conditions.is_empty());
    assert_eq!(model.scenes[2].start_conditions.len(), 2);
}

/// The words of what a load does: its work, and the first force or couple on a body.
fn acts(model: &Model, load: usize) -> [String; 2] {
    let load = &model.loads[load];
    let work = match load.work {
        Work::Potential(energy) => energy,
        Work::Resistance { tension, .. } => tension,
        Work::Pushes => Id::ZERO,
    };
    let push = &load.pushes[0];
    let pushed = push.couple.first().or(push.force.first()).copied().unwrap_or(Id::ZERO);
    [text(model, work), text(model, pushed)]
}

#[test]
fn springs_dampers_forces_and_torques_with_a_phase_act_there_only() {
    let held = "constraints: {floor: y}\nphases: {\"on[i in 1..2]\": [floor], off: [], away: []}";
    let model = bead(&format!(
        "{held}
springs: {{s: {{stretch: phi, stiffness: m*g*l, on: wheel, phase: off}}}}
dampers: {{d: {{rate: phi', damping: m*l*v, on: wheel, phase: \"on[i in 1..2]\"}}}}
forces:
  f: {{on: bead, force: [m*g, 0], phase: [\"on[1]\", away]}}
  always: {{on: bead, force: [m*g, 0], phase: [off, \"on[i in 1..2]\", away]}}
torques: {{\"t[i in 1..2]\": {{on: wheel, torque: i*m*g*l, phase: \"on[i]\"}}}}"
    ));
    let all: Vec<[String; 2]> = [0, 1, 2, 3, 5].map(|load| acts(&model, load)).to_vec();
    let wanted = [
        ["1/2*phi*phi*l*m*g*(in off)", "-phi*l*m*g*(in off)"],
        ["phi'*m*l*v*((in on[1]) + (in on[2]))", "-phi'*m*l*v*((in on[1]) + (in on[2]))"],
        ["0", "m*g*((in on[1]) + (in away))"],
        ["0", "m*g"],
        ["0", "2*l*m*g*(in on[2])"],
    ];
    assert_eq!(all, wanted);
    let potential = words(&model, &model.potential_terms);
    assert_eq!(potential, [acts(&model, 0)[0].clone()]);
}

#[test]
fn claims_may_hold_in_some_phases() {
    let model = bead(
        "constraints: {floor: y}
phases: {on: [floor], off: [], away: []}
conserved: {a: {value: energy, phase: off}, b: energy}
checks: {c: {holds: y = 0, phase: [off, on]}, d: y = y}",
    );
    let conserved: Vec<_> = model.conserved.iter().map(|c| c.phases.clone()).collect();
    assert_eq!(conserved, [Some(vec![1]), None]);
    let checks: Vec<_> = model.checks.iter().map(|c| c.phases.clone()).collect();
    assert_eq!(checks, [Some(vec![0, 1]), None]);
}

#[test]
fn an_event_stops_records_goes_to_a_phase_or_is_an_impact() {
    let model = bead(
        "constraints: {floor: y - l, \"wall[i in 1..2]\": x - i*l}
phases: {flight: [], \"on[i in 1..2]\": [floor]}
events:
  stop: {when: y, then: stop}
  some: {when: y, direction: rising, if: x', phase: [\"on[2]\", flight], then: [record, \"on[1]\"]}
  \"hit[i in 1..2]\": {when: \"x - i*l\", phase: flight, then: {impact: e/i, along: \"wall[i]\"}}
  land: {when: y - l, phase: flight, then: [{impact: 0.5, along: floor}, \"on[2]\", stop]}",
    );
    let phases: Vec<_> = model.events.iter().map(|event| event.phases.clone()).collect();
    assert_eq!(phases, [None, Some(vec![0, 2]), Some(vec![0]), Some(vec![0]), Some(vec![0])]);
    assert_eq!(model.events[0].actions, [EventAction::Stop]);
    assert_eq!(model.events[1].actions, [EventAction::Record, EventAction::Phase(1)]);
    assert!(model.events[1].condition.is_some() && model.events[1].direction == 1);
    let EventAction::Impact { restitution, along } = model.events[3].actions[0] else { panic!() };
    assert_eq!((number(&model, restitution), along), (0.4, 2));
    let [EventAction::Impact { along: 0, .. }, EventAction::Phase(2), EventAction::Stop] = model.events[4].actions[..]
    else {
        panic!("{:?}", model.events[4].actions)
    };
}

#[test]
fn a_coefficient_of_restitution_is_judged_in_every_scene() {
    let file = format!(
        "{BEAD}constraints: {{floor: y}}\nphases: {{flight: []}}\nscenes: {{fast: {{set: {{e: 1.2}}}}}}
events: {{hit: {{when: y, then: {{impact: e, along: floor}}}}}}\n"
    );
    let problems = load(&file, &[]).unwrap_err();
    assert_eq!((problems.len(), problems[0].code), (1, "E411"), "{problems:?}");
}

#[test]
fn the_eccentric_cylinder_has_five_phases_with_friction_solved_in_two() {
    let drum = whole_file("EccentricCylinder");
    let constraints: Vec<_> = drum.constraints.iter().map(|c| (c.name.as_str(), c.holonomic, c.first)).collect();
    assert_eq!(constraints, [("contact", true, 0), ("no_slip", false, 1)]);
    let phases: Vec<(&str, &[usize])> =
        drum.phases.iter().map(|p| (p.name.as_str(), p.constraints.as_slice())).collect();
    let both = &[0, 1][..];
    let slides = [("slide_down", &[0][..]), ("slide_up", &[0])];
    assert_eq!(phases, [("ideal", both), ("rolling", both), slides[0], slides[1], ("flight", &[])]);
    assert_eq!(acts(&drum, 0)[1], "-mu*reaction(contact)*(in slide_down)");
    assert_eq!(acts(&drum, 1)[1], "mu*reaction(contact)*(in slide_up)");
    let events: Vec<_> =
        drum.events.iter().map(|e| (e.name.as_str(), e.direction, e.phases.clone().unwrap())).collect();
    assert_eq!(events[0], ("unloaded", -1, vec![0]));
    assert_eq!(events[5], ("skip", -1, vec![2, 3]));
    let targets: Vec<EventAction> = drum.events.iter().map(|e| e.actions[0]).collect();
    let phase = EventAction::Phase;
    let wanted = [EventAction::Stop, phase(2), phase(3), phase(1), phase(1), phase(4), phase(2), phase(3)];
    assert_eq!(targets, wanted);
    assert_eq!(words(&drum, &[drum.events[1].when]), ["mu*reaction(contact) + reaction(no_slip)"]);
    let [system] = drum.balances.as_slice() else { panic!() };
    assert_eq!((system.name.as_str(), system.phases.as_slice()), ("about_contact", &[0, 1][..]));
    let scenes: Vec<_> = drum.scenes.iter().map(|scene| (scene.name.as_str(), scene.phase)).collect();
    assert_eq!(scenes, [("scene", 0), ("real", 1)]);
    assert_eq!(drum.scenes[1].held_q, [true, true, true]);
    assert_eq!(drum.scenes[1].held_v, [false, false, true]);
    assert_eq!(drum.outputs[0].unit.as_deref(), Some("N"));
    assert!(drum.warnings.is_empty());
}

#[test]
fn balances_belong_to_the_initial_phase_or_to_those_they_name() {
    let system = "equations: [{force: {of: [bead, wheel], along: [1, 0]}}, {moment: {about: bead, of: [wheel]}}]";
    let model = bead(&format!(
        "constraints: {{floor: y}}
phases: {{on: [floor], off: [], again: [floor]}}
balances: {{first: {{{system}}}, both: {{phase: [again, on], {system}}}}}"
    ));
    let phases: Vec<_> = model.balances.iter().map(|system| system.phases.clone()).collect();
    assert_eq!(phases, [vec![0], vec![0, 2]]);
}

#[test]
fn a_reaction_in_a_force_is_one_more_unknown_of_the_balances_it_stands_in() {
    let model = bead(
        "constraints: {floor: y - l, still: phi}
forces: {rub: {on: bead, force: \"[-mu*reaction(floor), 0]\"}}
balances:
  equations: [{force: {of: [bead, wheel]}}, {equation: n = reaction(floor)}]
  reactions: {n: {on: wheel, along: [0, 1]}}",
    );
    assert_eq!(model.balances.len(), 1);
}

#[test]
fn a_system_that_counts_equations_sees_a_reaction_only_in_the_phases_where_its_constraint_and_its_force_act() {
    let system = "equations: [{force: {of: [bead, wheel], along: [1, 0]}}, {moment: {about: bead, of: [wheel]}}]";
    let model = bead(&format!(
        "constraints: {{floor: y - l}}
phases: {{ideal: [floor], slide: [floor]}}
forces: {{rub: {{on: bead, force: \"[-mu*reaction(floor), 0]\", phase: slide}}}}
balances:
  ideal: {{{system}}}
  slide:
    phase: slide
    equations: [{{force: {{of: all}}}}, {{moment: {{about: bead, of: [wheel]}}}}, {{equation: n = reaction(floor)}}]
    reactions: {{n: {{on: wheel, along: [0, 1]}}}}"
    ));
    assert_eq!(model.balances.len(), 2);
}

#[test]
fn a_constraint_that_acts_nowhere_is_a_warning_unless_something_hits_it() {
    let phases = "constraints: {a: x, b: y, c: phi}\nphases: {one: [a]}\nevents: {hit: {when: y, then: ";
    let model = bead(&format!("{phases}{{impact: 1, along: b}}}}}}"));
    let warned: Vec<&str> = model.warnings.iter().map(|w| w.code).collect();
    assert_eq!(warned, ["W432"]);
    assert!(model.warnings[0].message.contains("`c`"));
}

#[test]
fn constraints_may_be_named_like_other_things() {
    let model = bead("constraints: {x: x - y, bead: y}\nphases: {x: [x, bead], y: []}\noutputs: {f: reaction(x)}");
    assert_eq!(words(&model, &model.outputs[0].value), ["reaction(x)"]);
}

#[test]
fn lists_of_phases_and_components_do_not_make_a_model_spatial() {
    let model = bead(
        "constraints: {a: x, b: y, at: phi, along: [x, y]}
phases: {force: [a, b, at], value: [a, b, along], at: []}
events: {e: {when: x, phase: [force, value, at], then: [stop, record, at]}}",
    );
    assert_eq!(model.dimension, 2);
}
