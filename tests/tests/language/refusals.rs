//! What LANGUAGE.md, section 6, refuses: the code, and the line and column it stands at; beside it, what is accepted.
//!
//! `«` and `»` mark where the problem is to be shown.

use dalembert_symbolic::file::render;
use dalembert_symbolic::model::load;

const DISC: &str = "name: Disc
parameters: {m: 2 kg, R: 0.5 m, g: 10 m/s^2, F: 3 N, v: 1.5 m/s, w: 2 1/s, mu: 0.25 1, N: 4 N}
coordinates: {x: m, y: m, phi: rad}
inputs: {base: R*sin(w*t)}
bodies: {disc: {mass: m, inertia: m*R^2/2, angle: -phi, position: \"[x, y]\"}}
gravity: [0, -g]
";

/// What is wrong with a file, as it is shown: code, what the carets point at, line, column.
fn problems(text: &str) -> Vec<(String, String, usize, usize)> {
    let found = load(text, &[]).err().unwrap_or_default();
    let shown = render("disc.yaml", text, &found);
    let mut told = Vec::new();
    for problem in shown.split("error[").skip(1) {
        let code = &problem[..4];
        let place = problem.split("--> disc.yaml:").nth(1).expect("a place").lines().next().unwrap_or_default();
        let mut numbers = place.split(':').map(|number| number.parse::<usize>().expect("a number"));
        let (line, column) = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(0));
        let under = problem
            .lines()
            .filter_map(|line| line.split_once("| "))
            .find(|(_, rest)| rest.trim_start().starts_with('^'));
        let carets = under.map_or(0, |(_, rest)| rest.trim_start().chars().take_while(|c| *c == '^').count());
        let line_text = text.lines().nth(line - 1).unwrap_or_default();
        let pointed = line_text.chars().skip(column - 1).take(carets).collect();
        told.push((code.to_owned(), pointed, line, column));
    }
    assert_eq!(told.len(), found.len(), "{shown}");
    told
}

/// Refused with this code at the marked places, and for nothing else.
#[track_caller]
fn refused(code: &str, more: &str) {
    let marked = format!("{DISC}{more}\n");
    let text = marked.replace(['«', '»'], "");
    let mut expected = Vec::new();
    for (line, words) in marked.lines().enumerate() {
        for (at, _) in words.match_indices('«') {
            let rest = &words[at + '«'.len_utf8()..];
            let column = words[..at].replace(['«', '»'], "").chars().count() + 1;
            expected.push((code.to_owned(), rest.split('»').next().unwrap_or(rest).to_owned(), line + 1, column));
        }
    }
    assert!(!expected.is_empty(), "nothing is marked");
    assert_eq!(problems(&text), expected, "\n{text}");
}

/// Accepted without an error; the codes of its warnings.
#[track_caller]
fn warned(more: &str) -> Vec<&'static str> {
    let text = format!("{DISC}{more}\n");
    let model = load(&text, &[]).unwrap_or_else(|_| panic!("{text}\n{:?}", problems(&text)));
    model.warnings.iter().map(|warning| warning.code).collect()
}

#[track_caller]
fn accepted(more: &str) {
    assert_eq!(warned(more), [""; 0], "{more}");
}

#[test]
fn what_has_a_kink_or_a_jump_in_what_moves_is_refused_in_a_constraint() {
    for words in ["«abs(x)»", "R*«sign(x - y)»", "R*«step(x)»", "«min(x, y)»", "«max(x, 0)»"] {
        refused("E239", &format!("constraints: {{valley: \"y - {words}\"}}"));
    }
    refused("E239", "constraints: {slope: \"x' - «sign(y)»*v\"}");
    // Of parameters and of time they do not move.
    for words in ["abs(-R)", "max(R, 2*R)", "R*step(m - F/g)"] {
        accepted(&format!("constraints: {{valley: \"y - {words}\"}}"));
    }
}

#[test]
fn accelerations_and_reactions_are_refused_in_a_constraint() {
    refused("E214", "constraints: {jerk: «x''» - g}");
    refused("E214", "constraints: {jerk: «acceleration(disc)».x - g}");
    refused("E237", "constraints: {floor: y - R, rub: x*N - y*«reaction(floor)»}");
    accepted("constraints: {floor: y - R, lift: \"dot(velocity(disc), disc.x) - v\"}");
}

#[test]
fn a_constraint_with_velocities_must_be_affine_in_them() {
    for words in ["x'^2 + y'^2 = v^2", "x'*y' = v^2", "norm(velocity(disc)) - v", "sqrt(x'*v) = v"] {
        refused("E424", &format!("constraints: {{speed: «\"{words}\"»}}"));
    }
    accepted("constraints: {speed: \"x'*cos(phi) + y'*sin(phi + w*t) = v*exp(-x/R) + x*w\"}");
}

#[test]
fn an_input_may_stand_in_a_constraint_and_its_rate_only_with_velocities() {
    refused("E425", "constraints: {place: «x - base'/w»}");
    accepted("constraints: {place: x - base, speed: y' - base'}");
}

#[test]
fn a_component_that_depends_on_no_coordinate_or_no_velocity_is_refused_unless_it_is_0() {
    refused("E423", "constraints: {tight: «R - 2*R»}");
    refused("E423", "constraints: {clock: «R*sin(w*t)»}");
    refused("E423", "constraints: {outside: «base - R»}");
    refused("E423", "constraints: {floor: «\"[R, y - R]\"»}");
    refused("E423", "constraints: {speed: «\"[x' - v, w*y]\"»}");
    accepted("constraints: {corner: \"[x - R, y - R]\"}");
    accepted("constraints: {floor: \"[0, y - R]\"}");
}

#[test]
fn units_of_both_sides_agree() {
    refused("E241", "constraints: {floor: y - «w»}");
    refused("E241", "constraints: {roll: x' - «phi'»}");
    accepted("constraints: {floor: y = R, zero: x = 0}");
}

#[test]
fn names_of_constraints_and_phases_are_labels_and_those_of_functions_are_taken() {
    for name in ["sin", "reaction", "velocity"] {
        refused("E203", &format!("constraints: {{«{name}»: y - R}}"));
        refused("E203", &format!("phases: {{free: [], «{name}»: []}}"));
    }
    refused("E310", "constraints: {\"a[i in 1..2]\": x - i*R, «\"a[2]\"»: y}");
    refused("E310", "phases: {\"a[i in 1..2]\": [], «\"a[2]\"»: []}");
    // Other things may be called so.
    accepted("constraints: {x: y - R, disc: x - R, m: phi}\nphases: {x: [m, disc], disc: [x]}");
}

#[test]
fn no_phase_is_called_stop_or_record() {
    for name in ["stop", "record"] {
        refused("E203", &format!("phases: {{free: [], «{name}»: []}}"));
        accepted(&format!("constraints: {{{name}: y - R}}"));
    }
}

#[test]
fn a_reaction_stands_linearly_in_forces_and_torques() {
    let floor = "constraints: {floor: y - R, wall: x}\n";
    for words in [
        "«abs(reaction(floor))»",
        "«max(reaction(floor), 0)»",
        "«min(reaction(floor), N)»",
        "«reaction(floor)^2»/N",
        "«reaction(floor)*reaction(wall)»/N",
        "«N^2/reaction(floor)»",
        "«sqrt(reaction(floor)*N)»",
        "N*«sin(reaction(floor)/N)»",
        "N*«sign(reaction(wall))»",
        "N*«step(reaction(wall))»",
    ] {
        refused("E238", &format!("{floor}forces: {{rub: {{on: disc, force: \"[{words}, 0]\"}}}}"));
        refused("E238", &format!("{floor}torques: {{hold: {{on: disc, torque: \"{words}*R\"}}}}"));
    }
    for words in [
        "-mu*reaction(floor)*sign(x')",
        "reaction(floor)/2 + reaction(wall)*abs(x/R)*cos(w*t)",
        "0.1*(N + reaction(wall))*(x'/v)^2",
    ] {
        accepted(&format!("{floor}forces: {{rub: {{on: disc, force: \"[{words}, 0]\"}}}}"));
        accepted(&format!("{floor}torques: {{hold: {{on: disc, torque: \"R*({words})\"}}}}"));
    }
}

/// In `outputs` and `events` it stands as it likes.
#[test]
fn a_reaction_stands_in_any_function_of_outputs_events_and_checks() {
    accepted(
        "constraints: {floor: y - R, roll: x' - R*phi'}
outputs: {needed: \"abs(reaction(roll))/max(reaction(floor), N/1000)\"}
events: {slips: {when: abs(reaction(roll)) - mu*reaction(floor), if: sign(reaction(roll)), then: stop}}
checks: {weight: \"max(reaction(floor), 0) = m*g\"}",
    );
}

/// Everywhere else it is an error, also by way of a definition.
#[test]
fn a_reaction_stands_nowhere_else() {
    let places = [
        "springs: {s: {stretch: x, stiffness: #/R, on: disc, along: [1, 0]}}",
        "springs: {s: {between: [ground, disc], tension: #}}",
        "dampers: {d: {rate: x', damping: #/v, on: disc, along: [1, 0]}}",
        "kinetic_energy: R*#",
        "potential_energy: R*#",
        "dissipation: v*#",
        "generalized_forces: {x: #}",
        "conserved: {c: #}",
        "points: {p: \"[R*#/N, 0]\"}",
        "frames: {f: {angle: #/N}}",
        "scene: {start: {x: R*#/N}}",
        "scene: {set: {R: R*#/N}}",
        "sample: {x: [0, R*#/N]}",
        "equilibrium: {x: R*#/N}",
        "outputs: {o: rate(#)}",
    ];
    for place in places {
        for (define, words) in [("", "reaction(floor)"), ("define: {normal: reaction(floor)}\n", "normal")] {
            let text = format!("{DISC}constraints: {{floor: y - R}}\n{define}{}\n", place.replace('#', words));
            let found = problems(&text);
            assert!(found.iter().any(|(code, ..)| code == "E237"), "{text}{found:?}");
            assert_eq!(found.len(), 1, "{text}{found:?}");
        }
    }
    accepted("constraints: {floor: y - R}\ndefine: {normal: reaction(floor)}\noutputs: {n: normal}");
}

#[test]
fn a_reaction_is_that_of_a_constraint() {
    refused("E235", "constraints: {floor: y - R}\noutputs: {n: reaction(«flor»)}");
    refused("E235", "outputs: {n: reaction(«x»)}");
}

#[test]
fn without_phases_the_key_phase_is_an_error_at_every_key() {
    let floor = "constraints: {floor: y - R}\n";
    for entry in [
        "springs: {s: {between: [ground, disc], stiffness: 1 N/m, «phase»: on}}",
        "springs: {s: {stretch: phi, stiffness: 1 N*m, on: disc, «phase»: [on]}}",
        "dampers: {d: {between: [ground, disc], damping: 1 N*s/m, «phase»: on}}",
        "dampers: {d: {rate: phi', damping: 1 N*m*s, on: disc, «phase»: on}}",
        "forces: {f: {on: disc, force: \"[F, 0]\", «phase»: on}}",
        "torques: {f: {on: disc, torque: F*R, «phase»: on}}",
        "events: {e: {when: x, «phase»: on, then: stop}}",
        "balances: {«phase»: on, equations: [{force: {of: [disc], along: [1, 0]}}, {moment: {about: disc, of: [disc]}}]}",
        "balances: {one: {«phase»: on, equations: [{force: {of: [disc], along: [1, 0]}}, {moment: {about: disc, of: [disc]}}]}}",
        "conserved: {c: {value: m*x', «phase»: on}}",
        "checks: {c: {holds: y = R, «phase»: on}}",
        "scene: {«phase»: on}",
        "scenes: {late: {«phase»: on}}",
    ] {
        refused("E315", &format!("{floor}{entry}"));
        let phases = "phases: {on: [floor], off: []}\n";
        accepted(&format!("{floor}{phases}{}", entry.replace(['«', '»'], "")));
        let unknown = entry.replace(['«', '»'], "").replace("phase: on", "phase: «onn»").replace("[on]", "[«onn»]");
        refused("E236", &format!("{floor}{phases}{unknown}"));
    }
}

/// A scene starts in one phase; elsewhere a list may stand, of names that are not given twice.
#[test]
fn a_phase_is_one_or_a_list() {
    let phases = "constraints: {floor: y - R}\nphases: {\"on[i in 1..2]\": [floor], off: []}\n";
    accepted(&format!("{phases}forces: {{f: {{on: disc, force: \"[F, 0]\", phase: [\"on[i in 1..2]\", off]}}}}"));
    refused("E316", &format!("{phases}forces: {{f: {{on: disc, force: \"[F, 0]\", phase: [off, «off»]}}}}"));
    refused("E317", &format!("{phases}forces: {{f: {{on: disc, force: \"[F, 0]\", «phase»: []}}}}"));
    refused("E304", &format!("{phases}scene: {{phase: «[off]»}}"));
    accepted(&format!("{phases}scene: {{phase: off}}\nscenes: {{second: {{phase: \"on[2]\"}}}}"));
}

/// `phase` stands where LANGUAGE.md says, and is an unknown key elsewhere.
#[test]
fn a_phase_stands_nowhere_else() {
    let phases = "constraints: {floor: y - R}\nphases: {on: [floor], off: []}\n";
    for entry in [
        "bodies: {more: {mass: m, position: [x, 0], «phase»: on}}",
        "frames: {f: {angle: phi, «phase»: on}}",
        "draw: [{line: [ground, disc], «phase»: on}]",
    ] {
        let text = entry.replace("bodies: {", "points: {p: [x, 0]}\nbodies: {");
        let text = if entry.starts_with("bodies") {
            text.replace("bodies: {more", "frames: {more").replace("mass: m, position: [x, 0]", "angle: phi")
        } else {
            text
        };
        refused("E301", &format!("{phases}{text}"));
    }
}

#[test]
fn phases_name_constraints_each_once() {
    let floor = "constraints: {floor: y - R, wall: x}\n";
    refused("E235", &format!("{floor}phases: {{on: [floor, «wal»]}}"));
    refused("E316", &format!("{floor}phases: {{on: [floor, wall, «floor»]}}"));
    refused("E317", &format!("{floor}«phases»: {{}}"));
    assert_eq!(warned(&format!("{floor}phases: {{on: [floor], off: []}}")), ["W432"]);
    accepted(&format!("{floor}phases: {{on: [floor], off: [wall]}}"));
}

#[test]
fn an_event_has_a_function_and_something_that_it_does() {
    let phases =
        "constraints: {floor: y - R, roll: x' - R*phi'}\nphases: {flight: [], on: [floor], rolls: [floor, roll]}\n";
    let refuse = |code: &str, event: &str| refused(code, &format!("{phases}events: {event}"));
    refuse("E302", "{«e»: {then: stop}}");
    refuse("E302", "{«e»: {when: y - R}}");
    refuse("E301", "{e: {when: y - R, then: stop, «unless»: x}}");
    refuse("E307", "{e: {when: y - R, direction: «up», then: stop}}");
    refuse("E307", "{e: {when: y - R, then: «sto»}}");
    refuse("E317", "{e: {when: y - R, «then»: []}}");
    refuse("E318", "{e: {when: y - R, then: [on, «rolls»]}}");
    refuse("E301", "{e: {when: y - R, phase: flight, then: {impact: 0.5, along: floor, «on»: disc}}}");
    refuse("E302", "{e: {when: y - R, phase: flight, «then»: {impact: 0.5}}}");
    refuse("E302", "{e: {when: y - R, phase: flight, «then»: {along: floor}}}");
    refuse("E411", "{e: {when: y - R, phase: flight, then: {impact: «1.5», along: floor}}}");
    refuse("E411", "{e: {when: y - R, phase: flight, then: {impact: «-0.5», along: floor}}}");
    refuse("E215", "{e: {when: y - R, phase: flight, then: {impact: «x»/R, along: floor}}}");
    refuse("E429", "{e: {when: y - R, phase: flight, then: {impact: 0.5, along: «roll»}}}");
    refuse("E430", "{e: {when: y - R, phase: on, then: {impact: 0.5, along: «floor»}}}");
    refuse("E430", "{e: {when: y - R, phase: [on, rolls], then: {impact: 0.5, along: «floor»}}}");
    refuse("E235", "{e: {when: y - R, phase: flight, then: {impact: 0.5, along: «flor»}}}");
    for event in [
        "{e: {when: y - R, then: {impact: 0, along: floor}}}",
        "{e: {when: y - R, phase: [flight, on], then: {impact: 1, along: floor}}}",
        "{e: {when: kinetic_energy - energy/2, if: x'' - g, then: [record, stop]}}",
        "{e: {when: reaction(floor), phase: on, direction: falling, then: [flight, record]}}",
    ] {
        accepted(&format!("{phases}events: {event}"));
    }
}

#[test]
fn an_event_is_named_by_a_label() {
    refused("E310", "events: {\"a[i in 1..2]\": {when: x - i*R, then: stop}, «\"a[2]\"»: {when: y, then: stop}}");
    accepted("events: {x: {when: x, then: stop}, disc: {when: y, then: stop}}");
}
