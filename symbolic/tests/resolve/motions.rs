//! `motions`: what a file asks of motions, and what is wrong with it.

use dalembert_symbolic::lower::{Program, compile, compile_in};
use dalembert_symbolic::model::{Goal, read_through};
use dalembert_symbolic::{file, gate, model};

/// A double pendulum without inertia of bodies, with motions.
fn pendulum(motions: &str) -> String {
    format!(
        "name: Pendulum\nparameters: {{m: 1 kg, l: 1 m, g: 9.81 m/s^2, w: 2 rad/s}}\ncoordinates: {{theta1: rad, theta2: rad, x: m}}\n\
         kinetic_energy: \"m*l^2*(2*theta1'^2 + theta2'^2 + 2*cos(theta1 - theta2)*theta1'*theta2')/2 + m*x'^2/2\"\n\
         potential_energy: -m*g*l*(2*cos(theta1) + cos(theta2))\n\
         events: {{low: {{when: theta1, then: record}}}}\n\
         outputs: {{tip: \"l*[sin(theta1) + sin(theta2), -cos(theta1) - cos(theta2)]\", height: -l*cos(theta1)}}\n\
         scene: {{start: {{theta1: 0.3}}, until: 4, tolerance: 1e-11}}\nscenes: {{high: {{start: {{theta1: 2}}, set: {{l: 2}}}}}}\n\
         motions:\n{motions}\n"
    )
}

fn program(text: &str) -> Program {
    compile(text, &[]).unwrap_or_else(|problems| panic!("{}", file::render("m.yaml", text, &problems)))
}

fn numbers(program: &Program, motion: usize) -> Vec<f64> {
    let parameters: Vec<f64> = program.model.parameters.iter().map(|p| p.default).collect();
    let ids = program.motion_numbers(motion);
    dalembert_symbolic::expr::Tape::new(&program.model.graph, &ids).evaluate(|symbol| match symbol {
        dalembert_symbolic::expr::Symbol::Parameter(k) => parameters[k as usize],
        _ => f64::NAN,
    })
}

/// Codes and messages of everything that is wrong.
fn told(text: &str) -> Vec<(&'static str, String)> {
    let problems = match read_through(text, &[]) {
        (Some(model), problems) if problems.is_empty() => gate::judged(model).err().unwrap_or_default(),
        (_, problems) => problems,
    };
    problems.into_iter().map(|problem| (problem.code, problem.message)).collect()
}

#[test]
fn motions_inherit_from_scenes_and_say_what_closes() {
    let program = program(&pendulum(
        "  swing: {closes: {part: 1/2, mirror: [theta1, theta2]}}\n  \
         brake: {scene: high, closes: {part: 1/4, from: {}, to: {mirror: [theta1, theta2]}}, energy: 4 J}\n  \
         low: {start: {theta1: pi/2}, closes: {at: low, count: 2, shift: [x], turn: {theta2: -1}}, tolerance: 1e-9}\n  \
         free: {closes: {period: 2*pi*sqrt(l/g)}}\n  \
         reach: {unknown: {theta1': 3 rad/s, until: 500 ms, g: 9}, such_that: {tip.y: 2*l, theta2': 0}, until: 2}\n  \
         high: {unknown: {theta1': 180 deg/s}, maximise: height}",
    ));
    let closes = |k: usize| match &program.model.motions[k].goal {
        Goal::Closes(closes) => closes.clone(),
        other => panic!("{other:?}"),
    };
    assert_eq!((closes(0).part, closes(0).event), (2, None));
    assert_eq!(closes(0).image.coordinates, [(0, true), (1, true), (2, false)]);
    let brake = closes(1);
    assert_eq!(
        (brake.part, brake.between.map(|ends| ends.map(|end| end.coordinates[0]))),
        (4, Some([(0, false), (0, true)]))
    );
    assert_eq!(numbers(&program, 1), [0.0, 4.0]);
    let low = closes(2);
    assert_eq!((low.event, low.shifts.as_slice(), low.turns.as_slice()), (Some((0, 2)), &[2][..], &[(1, -1)][..]));
    let period = 2.0 * std::f64::consts::PI / 9.81_f64.sqrt();
    assert!((numbers(&program, 3)[0] - period).abs() < 1e-14);
    assert_eq!(numbers(&program, 4), [0.0, 0.0, 3.0, 0.5, 9.0, 2.0, 0.0]);
    assert!((numbers(&program, 5)[2] - std::f64::consts::PI).abs() < 1e-14);
    let names = |k: usize| program.model.motions[k].unknowns.iter().map(|u| u.0.clone()).collect::<Vec<_>>();
    assert_eq!(names(4), ["theta1'", "until", "g"]);
    match &program.model.motions[4].goal {
        Goal::Meets { conditions, extreme: None } => {
            assert_eq!(conditions.iter().map(|c| c.0.as_str()).collect::<Vec<_>>(), ["tip.y", "theta2'"]);
        }
        other => panic!("{other:?}"),
    }
    // `high` sets l; the start and tolerance are those of the scene where nothing else is said.
    let scene = |k: usize| &program.model.motions[k].scene;
    assert_eq!(scene(1).set.len(), 1);
    let value = |id| program.model.graph.number(id).map(|n| n.to_f64());
    assert_eq!(value(scene(0).q[0]), Some(0.3));
    assert_eq!((value(scene(2).tolerance), value(scene(0).tolerance)), (Some(1e-9), Some(1e-11)));
    assert_eq!((value(scene(4).until), value(scene(0).until)), (Some(2.0), Some(4.0)));
}

/// Three masses on a ring: cycles go where they say, `{a: b}` alone exchanges.
#[test]
fn exchanges_send_coordinates_where_they_say() {
    let ring = |motion: &str| {
        format!(
            "name: Ring\nparameters: {{m: 1 kg, k: 4 N/m}}\ncoordinates: {{\"x[i in 1..3]\": m}}\n\
             kinetic_energy: \"m*(x[1]'^2 + x[2]'^2 + x[3]'^2)/2\"\n\
             potential_energy: \"k*((x[1] - x[2])^2 + (x[2] - x[3])^2 + (x[3] - x[1])^2)/2\"\nmotions: {{a: {motion}}}\n"
        )
    };
    let images = |motion: &str| match &program(&ring(motion)).model.motions[0].goal {
        Goal::Closes(closes) => (closes.part, closes.image.coordinates.clone()),
        other => panic!("{other:?}"),
    };
    let cycle = "{closes: {part: 1/3, exchange: {\"x[1]\": \"x[2]\", \"x[2]\": \"x[3]\", \"x[3]\": \"x[1]\"}}}";
    assert_eq!(images(cycle), (3, vec![(2, false), (0, false), (1, false)]));
    let pair = "{closes: {exchange: {\"x[1]\": \"x[3]\"}, mirror: x}}";
    assert_eq!(images(pair), (2, vec![(2, true), (1, true), (0, true)]));
    let codes = |motion: &str| told(&ring(motion)).into_iter().map(|(code, _)| code).collect::<Vec<_>>();
    assert_eq!(codes("{closes: {exchange: {\"x[1]\": \"x[2]\", \"x[3]\": \"x[2]\"}}}"), ["E324"]);
    assert_eq!(
        codes("{closes: {from: {exchange: {\"x[1]\": \"x[2]\", \"x[2]\": \"x[3]\", \"x[3]\": \"x[1]\"}}, to: {}}}"),
        ["E324"]
    );
    // Momentum is conserved, and so all can be shifted together, but not one.
    assert_eq!(codes("{closes: {period: 2, shift: \"x[1]\"}}"), ["E521"]);
}

#[test]
fn mistakes_are_told_together_with_their_places() {
    let found = told(&pendulum(
        "  a: {closes: {at: lo, shift: [y]}}\n  b: {unknown: {thet1: 1, l: 2 kg}, such_that: {tip: 1, heigt: 2}}\n  \
         c: {scene: hig, closes: {}}\n  d: {maximise: height}\n  e: {}\n  f: {unknown: {l: 1}, maximise: height, fit: {}}\n  \
         g: {closes: {count: 2, from: {}}, unknown: {l: 1}}\n  h: {unknown: {l: 1}, such_that: {x: 2*l}}\n  \
         i: {closes: {turn: {x: 1}, part: 1/2}, energy: 3 N}\n  j: {closes: {exchange: {theta1: x}, period: 3 m}}\n  \
         k: {until: 3, energy: 1, unknown: {theta1': 1}, such_that: {x: 3 s}}\n  l: {closing: {}}",
    ));
    let expected = [
        ("E307", "`lo` is not an event"),
        ("E201", "unknown name `y`"),
        ("E201", "unknown name `thet1`"),
        ("E242", "2 kg"),
        ("E201", "unknown name `tip`"),
        ("E201", "unknown name `heigt`"),
        ("E307", "`hig` is not a scene"),
        ("E302", "`unknown`"),
        ("E306", "`closes`, `such_that`, `maximise`, `minimise`, `fit`"),
        ("E305", "`maximise` and `fit`"),
        ("E311", "`count`"),
        ("E311", "`from`"),
        ("E446", "`x` contains `l`"),
        ("E242", "3 N"),
        ("E224", "`x`"),
        ("E325", "`1/2`"),
        ("E249", "`theta1` is"),
        ("E242", "3 m"),
        ("E242", "3 s"),
        ("E311", "`energy`"),
        ("E301", "`closing`"),
    ];
    let listed = found.iter().map(|(code, message)| format!("{code} {message}")).collect::<Vec<_>>().join("\n");
    for (code, words) in expected {
        assert!(
            found.iter().any(|(known, message)| *known == code && message.contains(words)),
            "{code} {words}\n{listed}"
        );
    }
    assert_eq!(found.len(), expected.len(), "{listed}");
}

/// A walker: legs p and s, the foot of either on the ground.
fn walker(mass: &str, events: &str) -> String {
    format!(
        "name: Walker\nparameters: {{m: 1 kg, mp: 1 kg, ms: {mass}, l: 1 m, b: 0.5 m, g: 9.81 m/s^2, slope: 0.05 1}}\n\
         coordinates: {{x: m, y: m, p: rad, s: rad}}\npoints:\n  hip: \"[x, y]\"\n  foot_p: \"hip - l*[sin(p), cos(p)]\"\n  \
         foot_s: \"hip - l*[sin(s), cos(s)]\"\nbodies:\n  hip_mass: {{mass: m, position: hip}}\n  \
         leg_p: {{mass: mp, position: \"hip - b*[sin(p), cos(p)]\"}}\n  leg_s: {{mass: ms, position: \"hip - b*[sin(s), cos(s)]\"}}\n\
         gravity: \"g*[sin(slope), -cos(slope)]\"\nconstraints: {{on_p: velocity(foot_p), on_s: velocity(foot_s)}}\n\
         phases: {{on1: [on_p], on2: [on_s]}}\nevents:\n  strike2: {{when: foot_s.y - foot_p.y, direction: falling, phase: on1, then: on2}}\n  {events}\n\
         scene: {{start: {{p: 0.2, s: -0.2, p': -1}}, guess: {{y: 1}}, until: 1}}\n\
         motions: {{step: {{closes: {{at: strike2, exchange: {{p: s, on1: on2}}, shift: [x]}}}}}}\n"
    )
}

/// Exchanges hold in all phases, for rows and events too, or what differs is named.
#[test]
fn an_exchange_of_legs_and_phases_is_tested() {
    let mirrored = "strike1: {when: foot_p.y - foot_s.y, direction: falling, phase: on2, then: on1}";
    assert_eq!(told(&walker("1 kg", mirrored)), []);
    let unequal = told(&walker("2 kg", mirrored));
    assert_eq!(unequal.len(), 1, "{unequal:?}");
    assert!(unequal[0].0 == "E522" && unequal[0].1.contains("the equation of"), "{unequal:?}");
    let rising =
        told(&walker("1 kg", "strike1: {when: foot_p.y - foot_s.y, direction: rising, phase: on2, then: on1}"));
    assert!(rising.len() == 1 && rising[0].1.contains("the event `strike2`"), "{rising:?}");
}

/// What depends on time closes after a period of that, which shifts of time by its parts must respect.
#[test]
fn periods_are_tested_where_time_acts() {
    let duffing = |closes: &str| {
        told(&format!(
            "name: Duffing\nparameters: {{m: 1 kg, k: 4 N/m, b: 1 N/m^3, f: 0.3 N, w: 1.5 rad/s}}\ncoordinates: {{x: m}}\n\
             kinetic_energy: m*x'^2/2\npotential_energy: k*x^2/2 + b*x^4/4\ninputs: {{u: f*cos(w*t)}}\n\
             generalized_forces: {{x: u}}\nmotions: {{a: {{closes: {closes}}}}}\n"
        ))
    };
    assert_eq!(duffing("{period: 2*pi/w}"), []);
    assert_eq!(duffing("{period: 4*pi/w}"), []);
    // After half a period the force is the opposite.
    assert_eq!(duffing("{period: 2*pi/w, part: 1/2, mirror: x}"), []);
    assert_eq!(duffing("{period: 4*pi/w, part: 1/2, mirror: x}")[0].0, "E522");
    assert_eq!(duffing("{period: 4.18879}")[0].0, "E523");
    assert_eq!(duffing("{mirror: x}")[0].0, "E445");
    // It turns round where it rests at t = 0, an extreme of the force, and passes the middle a quarter later.
    assert_eq!(duffing("{period: 2*pi/w, from: {}, to: {mirror: x}}"), []);
}

/// Damping is no motion backwards; a mirror of what has a preferred side is none.
#[test]
fn reversals_and_mirrors_are_tested() {
    let block = |force: &str, closes: &str| {
        told(&format!(
            "name: Block\nparameters: {{m: 1 kg, k: 4 N/m, c: 1 N*s/m}}\ncoordinates: {{x: m}}\nkinetic_energy: m*x'^2/2\n\
             potential_energy: k*x^2/2\ngeneralized_forces: {{x: \"{force}\"}}\nmotions: {{a: {{closes: {closes}}}}}\n"
        ))
    };
    assert_eq!(block("0", "{from: {}, to: {mirror: x}}"), []);
    assert_eq!(block("-c*x'", "{from: {}, to: {mirror: x}}").iter().filter(|p| p.0 == "E522").count(), 2);
    assert_eq!(block("-c*x'", "{mirror: x}"), []);
    // Resisted to one side only.
    assert_eq!(block("-c*x'*step(x)", "{mirror: x}")[0].0, "E522");
}

/// A record is read with the file, its columns by name.
#[test]
fn records_are_read_with_the_file() {
    let folder = std::env::temp_dir().join(format!("dalembert-records-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("good.csv"), "time,place\n0,0.1\n1,-0.05\n2,0.02\n").unwrap();
    std::fs::write(folder.join("falls.csv"), "time,place\n0,0.1\n2,-0.05\n1,0.02\n").unwrap();
    let text = |fit: &str| {
        format!(
            "name: Block\nparameters: {{m: 1 kg, k: 4 N/m}}\ncoordinates: {{x: m}}\nkinetic_energy: m*x'^2/2\n\
             potential_energy: k*x^2/2\nmotions: {{a: {{unknown: {{k: 4 N/m}}, fit: {fit}}}}}\n"
        )
    };
    let read = |fit: &str| compile_in(Some(&folder), &text(fit), &[]);
    let program = read("{file: good.csv, columns: {t: time, x: place}}").expect("a record");
    match &program.model.motions[0].goal {
        Goal::Fits(columns) => {
            assert_eq!(columns[0], ("t".to_owned(), vec![0.0, 1.0, 2.0]));
            assert_eq!(columns[1], ("x".to_owned(), vec![0.1, -0.05, 0.02]));
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(program.model.files, [folder.join("good.csv")]);
    for (fit, code, words) in [
        ("{file: good.csv, columns: {t: time, x: pace}}", "E326", "no column is called `pace`"),
        ("{file: falls.csv, columns: {t: time, x: place}}", "E326", "the time 1 does not come after 2"),
        ("{file: none.csv, columns: {t: time, x: place}}", "E326", "none.csv"),
        ("{file: good.csv, columns: {x: place}}", "E302", "`t`"),
        ("{file: good.csv, columns: {t: time, z: place}}", "E201", "`z`"),
        ("{file: good.csv}", "E302", "`columns`"),
    ] {
        let problems = read(fit).expect_err(fit);
        let first = &problems[0];
        assert!(first.code == code && first.message.contains(words), "{fit}: {} {}", first.code, first.message);
    }
    assert!(model::load(&text("{file: good.csv, columns: {t: time, x: place}}"), &[]).is_err());
    std::fs::remove_dir_all(&folder).unwrap();
}
