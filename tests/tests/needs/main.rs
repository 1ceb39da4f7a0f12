//! No more than a scene needs: what goes, what stays, and by which figures.

mod adversaries;
mod ladders;
mod linear;
mod masses;
mod stiff;
mod traps;
mod written;

use std::ops::ControlFlow;

use dalembert::needs::{Choice, ModelReduction, Need, Needs, NeedsError, NeedsRequest, Proposal, Verdict};

const CRANE: &str = include_str!("../../needs/crane.yaml");
const SPRING_PENDULUM: &str = include_str!("../../needs/spring_pendulum.yaml");
const QUARTER_CAR: &str = include_str!("../../needs/quarter_car.yaml");
const GEARED_ROTOR: &str = include_str!("../../needs/geared_rotor.yaml");
const HANGING_CHAIN: &str = include_str!("../../needs/hanging_chain.yaml");

fn asked(request: &NeedsRequest) -> Result<Needs, NeedsError> {
    Needs::find(request, &mut |_| ControlFlow::Continue(()))
}

/// What a file needs to a thousandth in this output.
fn found(source: &str, output: &str) -> Needs {
    let need = Need::of(&[output], 1e-3);
    let request = NeedsRequest { need: Some(need), all: true, ..NeedsRequest::new(source) };
    asked(&request).unwrap_or_else(|error| panic!("{error}"))
}

fn reduction<'a>(needs: &'a Needs, ingredient: &str) -> &'a ModelReduction {
    let found = needs.reductions.iter().find(|reduction| reduction.ingredient == ingredient);
    found.unwrap_or_else(|| panic!("no {ingredient} in\n{}", needs.table()))
}

fn change(needs: &Needs, ingredient: &str) -> f64 {
    reduction(needs, ingredient).deviation.as_ref().unwrap_or_else(|| panic!("{}", needs.table())).largest
}

fn chosen(needs: &Needs) -> &Choice {
    needs.choice.as_ref().unwrap_or_else(|| panic!("nothing goes\n{}", needs.table()))
}

/// The smaller file compiles by itself, and gives what was promised.
fn holds(full: &str, needs: &Needs) {
    let text = needs.smaller_file().expect("a file");
    let again = NeedsRequest { need: Some(needs.need.clone()), ..NeedsRequest::new(text.clone()) };
    let again = asked(&again).unwrap_or_else(|error| panic!("{error} in\n{text}"));
    assert!(again.operations <= 1.05 * chosen(needs).operations, "{} in\n{text}", again.operations);
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        let own = full.lines().any(|known| known == line);
        let edited = [
            "rate(",
            "th_mode",
            "    [",
            "sizes",
            "l_held",
            "r_held",
            "emblem_held",
            "tolerance",
            "coordinates",
            "define",
            "parameters",
            "start",
        ];
        assert!(own || edited.iter().any(|word| line.contains(word)) || line.contains('0'), "not the author's: {line}");
    }
}

#[test]
fn a_crane_on_a_steel_rope_needs_no_stretch() {
    let needs = asked(&NeedsRequest::new(CRANE)).unwrap();
    assert_eq!(
        (needs.need.outputs.as_slice(), needs.need.within),
        (&["load_x".to_owned(), "swing".to_owned()][..], 1e-3)
    );
    // The study's: 4.2e-4 of the swing, twelve to seventeen times less work.
    let choice = chosen(&needs);
    assert!(choice.members.contains(&"coordinates.l".to_owned()) && choice.saving > 12.0, "{}", needs.table());
    let (predicted, change) = (choice.predicted.unwrap(), choice.change);
    assert!((3e-4..6e-4).contains(&change) && (predicted / change - 1.0).abs() < 0.1, "{predicted} {change}");
    assert!(choice.verified <= 1e-3);
    assert!(choice.moved.is_some_and(|moved| moved < 1e-3));
    assert!(choice.idle.contains(&"springs.rope".to_owned()), "{:?}", choice.idle);
    // What is left of the rope's pull is a constant.
    assert!(choice.not_promised.iter().any(|(name, size)| name == "pull" && *size > 0.1));
    assert!(choice.gone.iter().any(|(claim, _)| claim.starts_with("balances")));
    assert_eq!(reduction(&needs, "dampers.wheels").verdict, Verdict::Acts);
    holds(CRANE, &needs);
}

#[test]
fn a_stiff_spring_pendulum_is_a_pendulum() {
    let needs = found(SPRING_PENDULUM, "angle");
    let choice = chosen(&needs);
    assert!(choice.members.contains(&"coordinates.r".to_owned()) && choice.saving > 60.0, "{}", needs.table());
    holds(SPRING_PENDULUM, &needs);
    // The error of a rope that does not stretch goes like 1/k.
    let softer = |k: &str| change(&found(&SPRING_PENDULUM.replace("k: 1e4", k), "angle"), "coordinates.r");
    let (soft, stiff) = (softer("k: 3e3"), softer("k: 3e4"));
    assert!((soft / stiff / 10.0 - 1.0).abs() < 0.15, "{soft} {stiff}");
    // Not at a thirtieth of it.
    let soft = found(&SPRING_PENDULUM.replace("k: 1e4", "k: 300"), "angle");
    assert_eq!(reduction(&soft, "coordinates.r").verdict, Verdict::Acts, "{}", soft.table());
}

#[test]
fn a_light_coupling_follows_with_its_inertia() {
    let needs = asked(&NeedsRequest::new(GEARED_ROTOR)).unwrap();
    let choice = chosen(&needs);
    let place =
        choice.members.iter().position(|name| name == "coordinates.b").unwrap_or_else(|| panic!("{}", needs.table()));
    assert_eq!(choice.proposals[place], Proposal::Slaved { to: "(k1*a + k2*c)/(k1 + k2)".to_owned() });
    assert!(choice.saving > 45.0 && choice.verified < 2e-4, "{}", needs.table());
    assert!(choice.moved.is_some_and(|moved| moved < 1e-3), "{}", needs.table());
    holds(GEARED_ROTOR, &needs);
    // The study's: 2.9e-5; what follows without its own vibration is off like 1/k.
    let following = |k1: &str| {
        let request = NeedsRequest::new(GEARED_ROTOR).setting("k1", k1).unwrap();
        let needs = asked(&request).unwrap_or_else(|error| panic!("{error}"));
        let is = |reduction: &&ModelReduction| {
            reduction.ingredient == "coordinates.b" && matches!(reduction.proposal, Proposal::Slaved { .. })
        };
        needs.reductions.iter().find(is).unwrap().deviation.clone().unwrap().largest
    };
    let (soft, stiff) = (following("1e4 N*m"), following("4e4 N*m"));
    assert!(stiff < 1e-5 && (2.5..5.0).contains(&(soft / stiff)), "{soft} {stiff}");
    // A torque on the coupling itself would go with its coordinate.
    let pushed = GEARED_ROTOR.replace("bodies:", "generalized_forces: {b: 0.001*torque}\nbodies:");
    let needs = asked(&NeedsRequest::new(pushed)).unwrap();
    let slaved = needs.reductions.iter().filter(|reduction| matches!(reduction.proposal, Proposal::Slaved { .. }));
    for reduction in slaved.filter(|reduction| reduction.ingredient == "coordinates.b") {
        assert!(matches!(reduction.verdict, Verdict::Refused { .. }), "{}", needs.table());
    }
}

#[test]
fn a_hanging_chain_moves_in_its_slow_modes() {
    // Twenty links take a twentieth of the time of the forty that the documentation has.
    let request = NeedsRequest { sizes: vec![("n".to_owned(), 20)], ..NeedsRequest::new(HANGING_CHAIN) };
    let needs = asked(&request).unwrap();
    let modes = |needs: &Needs| -> Vec<(usize, f64)> {
        let of = |reduction: &ModelReduction| match reduction.proposal {
            Proposal::Modes { kept, of: 20 } => Some((kept, reduction.deviation.as_ref()?.largest)),
            _ => None,
        };
        let mut found: Vec<(usize, f64)> = needs.reductions.iter().filter_map(of).collect();
        found.sort_by_key(|(kept, _)| *kept);
        found
    };
    let ladder = modes(&needs);
    assert_eq!(ladder.iter().map(|(kept, _)| *kept).collect::<Vec<_>>(), [1, 2, 3, 4, 6, 8], "{}", needs.table());
    assert!(ladder.windows(2).all(|pair| pair[1].1 < pair[0].1), "{ladder:?}");
    // The study's for forty links, whatever the amplitude: 4.1e-3, 1.7e-3 and 5.6e-4 with 3, 4 and 6 modes.
    for ((_, found), study) in ladder[2..].iter().zip([4.1e-3, 1.7e-3, 5.6e-4]) {
        assert!((0.5..2.0).contains(&(found / study)), "{found} {study}");
    }
    // Each is predicted by the next one; the study's of chains: 0.67 to 1.43 of the change.
    let predicted = |reduction: &ModelReduction| {
        reduction.predicted.filter(|predicted| predicted.holds()).map(|predicted| predicted.change)
    };
    for reduction in
        needs.reductions.iter().filter(|reduction| matches!(reduction.proposal, Proposal::Modes { kept: ..=6, .. }))
    {
        let (predicted, change) =
            (predicted(reduction).expect("a prediction"), reduction.deviation.as_ref().unwrap().largest);
        assert!((0.5..2.0).contains(&(predicted / change)), "{predicted} {change}\n{}", needs.table());
    }
    let choice = chosen(&needs);
    // The accelerations of the whole chain take a number of operations in proportion to its links: few modes save little.
    assert!(choice.saving > 1.0 && choice.moved.is_some_and(|moved| moved < 1e-3), "{}", needs.table());
    holds(HANGING_CHAIN, &needs);
    // A chain that starts bent starts so in its modes, in every scene.
    let bent =
        HANGING_CHAIN.replace("  until: 10", "  start: {\"th[i in 1..n]\": 0.2, \"th[i in 1..n]'\": 0.1}\n  until: 10");
    let needs = asked(&NeedsRequest { sizes: request.sizes.clone(), ..NeedsRequest::new(bent) }).unwrap();
    let text = needs.smaller_file().expect("a file");
    assert!(text.contains("\"th_mode[j in 1..") && text.contains("]'\": ["), "{text}");
    assert!(chosen(&needs).members[0].contains("th["), "{}", needs.table());
}

/// A pendulum that air, a drag, a spring and a hum hardly move otherwise, each by a coefficient.
const SWING: &str = "name: Swing
parameters: {m: 1 kg, L: 1 m, g: 10 m/s^2, c: 1e-3 N*s/m, d: 1e-3 N*s^2/m^2, k: 1e-2 N/m, F: 1e-3 N, T: 1 s}
coordinates: {theta: rad}
points: {P: \"L*[sin(theta), -cos(theta)]\"}
bodies: {bob: {mass: m, position: P}}
gravity: [0, -g]
springs: {side: {stretch: \"P.x\", stiffness: k, along: \"[1, 0]\", on: bob}}
forces:
  air: {on: bob, force: \"-c*velocity(bob)\"}
  drag: {on: bob, force: \"-d*velocity(bob)*sqrt(1e-9*g*L + dot(velocity(bob), velocity(bob)))\"}
  hum: {on: bob, force: \"[F*cos(2*t/T), 0]\"}
outputs: {side: P.x}
scene: {start: {theta: 1}, until: 10, tolerance: 1e-9}
";

#[test]
fn predictions_hold_within_a_factor_of_two_where_they_say_so() {
    let mut held = 0;
    let mut judge = |needs: &Needs| {
        for reduction in &needs.reductions {
            let (Some(predicted), Some(deviation)) = (&reduction.predicted, &reduction.deviation) else { continue };
            if predicted.holds() {
                held += 1;
                let ratio = predicted.change / deviation.largest;
                assert!((0.5..2.0).contains(&ratio), "{}: {ratio}\n{}", reduction.ingredient, needs.table());
            }
        }
    };
    for strength in ["1e-3", "3e-3", "1e-2", "3e-2", "1e-1"] {
        let coefficients = [("c", "N*s/m", 1.0), ("d", "N*s^2/m^2", 1.0), ("k", "N/m", 10.0), ("F", "N", 1.0)];
        let request = coefficients.into_iter().fold(NeedsRequest::new(SWING), |request, (name, unit, factor)| {
            let value = factor * strength.parse::<f64>().unwrap();
            request.setting(name, &format!("{value} {unit}")).unwrap()
        });
        judge(&asked(&request).unwrap());
    }
    let crane = asked(&NeedsRequest::new(CRANE)).unwrap();
    judge(&crane);
    judge(&asked(&NeedsRequest::new(SPRING_PENDULUM)).unwrap());
    assert!(held > 20, "{held}");
    // A rope that is cut is no small change, though its tension hardly changes at first; the table says nothing then.
    assert!(
        reduction(&crane, "springs.rope").predicted.is_some_and(|predicted| !predicted.holds()),
        "{}",
        crane.table()
    );
    assert!(crane.table().contains("springs.rope          left out                          –"), "{}", crane.table());
}

#[test]
fn what_is_held_is_wanted_or_read() {
    // The pull of a rope that is held is no constant.
    let needs = found(CRANE, "pull");
    assert_eq!(reduction(&needs, "coordinates.l").verdict, Verdict::Acts, "{}", needs.table());
    let needs = found(CRANE, "l");
    assert!(matches!(reduction(&needs, "coordinates.l").verdict, Verdict::Refused { .. }), "{}", needs.table());
}

#[test]
fn an_emblem_on_its_pin_is_not_needed() {
    let needs = asked(&NeedsRequest::new(QUARTER_CAR)).unwrap();
    let choice = chosen(&needs);
    assert!(choice.members.contains(&"coordinates.emblem".to_owned()) && choice.saving > 10.0, "{}", needs.table());
    assert_eq!(reduction(&needs, "dampers.rubber").verdict, Verdict::Acts);
    holds(QUARTER_CAR, &needs);
}

const OSCILLATOR: &str = "name: Oscillator
parameters: {m: 1 kg, k: 1 N/m, c: 0.02 N*s/m, T: 1 s, A: 1 m, F: 1 N}
coordinates: {x: m}
bodies: {b: {mass: m, position: \"[x, 0]\"}}
springs: {s: {stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}
dampers: {d: {rate: \"x'\", damping: c, along: \"[1, 0]\", on: b}}
";

fn oscillator(rest: &str) -> String {
    format!("{OSCILLATOR}{rest}")
}

#[test]
fn a_tolerance_is_written_where_the_file_has_none() {
    let needs = found(&oscillator("generalized_forces: {x: -k*x^3/A^2}\nscene: {start: {x: 1}, until: 20}"), "x");
    let text = needs.smaller_file().expect("a looser tolerance");
    assert!(text.contains("scene: {tolerance: 1e-5, start: {x: 1}, until: 20}"), "{text}");
}

/// What the program prints, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    match dalembert::cli::run(dalembert_models::MODELS, ["dalembert"].iter().chain(arguments), &mut out) {
        Ok(()) => Ok(String::from_utf8(out).expect("text")),
        Err(problem) => Err(problem.to_string()),
    }
}

#[test]
fn the_command_writes_a_file_that_runs() {
    let folder = std::env::temp_dir().join(format!("dalembert-needs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let (full, small) = (path("crane.yaml"), path("small.yaml"));
    std::fs::write(&full, CRANE).expect("a file");
    let said = told(&["needs", &full, "--needs", "swing", "--within", "2e-3", "--write", &small]).expect("an answer");
    assert!(said.contains("swing within 2.0e-3") && said.contains("with coordinates.l held at"), "{said}");
    let test = std::fs::read_to_string(path("small_test.rs")).expect("a test");
    assert!(test.contains("[\"swing\"]") && test.contains("off <= 2e-3"), "{test}");
    assert!(told(&["check", &small]).is_ok());
    assert!(told(&["simulate", &small, "--set", "l_held=9"]).expect("a run").contains("swing"));
    let chart = path("chart.svg");
    let json = told(&["needs", &full, "--json", "--plot", &chart]).expect("an answer");
    let json: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["choice"]["members"][0]["ingredient"], "coordinates.l");
    assert!(
        json["rungs"].as_array().is_some_and(|reductions| reductions.len() > 8)
            && json["choice"]["saving"].as_f64() > Some(12.0)
    );
    assert!(std::fs::read_to_string(&chart).expect("a picture").contains("l held"));
    // At a tenth of the stiffness the rope stretches too much; the file that is written has the value.
    let softer = told(&["needs", &full, "--set", "k=0.3 MN/m", "--start", "th=0.01"]).expect("an answer");
    assert!(!softer.contains("with coordinates.l held"), "{softer}");
    assert!(told(&["needs", &full, "--set", "k=3 N"]).expect_err("a refusal").contains("N/m"));
    assert!(told(&["needs", &full, "--set", "stiffness=3"]).expect_err("a refusal").contains("`stiffness`"));
    let over = told(&["needs", &full, "--write", &full]).expect_err("a refusal");
    assert!(over.contains("overwrite"), "{over}");
    let unknown = told(&["needs", &full, "--needs", "swin"]).expect_err("a refusal");
    assert!(unknown.contains("`swin`") && unknown.contains("swing"), "{unknown}");
    let amounts = told(&["needs", &full, "--needs", "swing, x=1 m", "--within", "2e-3"]).expect("an answer");
    assert!(amounts.contains("swing within 2.0e-3 of the range of each, x within 1.0e0"), "{amounts}");
    assert!(told(&["needs", &full, "--needs", "x=1 s"]).is_err());
    // The load is 1.1 mm off whatever is asked for.
    for (amount, asked, parts) in [("5 mm", "5.0e-3 m", "2.3e-1"), ("50 mm", "5.0e-2 m", "2.3e-2")] {
        let said = told(&["needs", &full, "--needs", &format!("load_x={amount}")]).expect("an answer");
        assert!(said.contains(&format!("off by 1.1e-3 m of the {asked} asked of load_x")), "{said}");
        assert!(said.contains("changes in parts of what is asked for") && said.contains(parts), "{said}");
    }
    assert!(told(&["needs", &full, "--within", "much"]).expect_err("a refusal").contains("--within wants"));
    // A scene that is minimal already: only its tolerance is more than is asked for.
    let minimal = told(&["needs", "cart_pendulum", "--write", &path("none.yaml")]).expect("an answer");
    assert!(minimal.contains("the model stays as it is, at a tolerance of 1e-5"), "{minimal}");
}

#[test]
fn a_chart_has_a_point_for_every_rung() {
    let folder = std::env::temp_dir().join(format!("dalembert-rungs-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let path = |name: &str| folder.join(name).to_str().expect("a path").to_owned();
    let (file, svg, csv) = (path("pendulum.yaml"), path("chart.svg"), path("chart.csv"));
    std::fs::write(&file, SPRING_PENDULUM).expect("a file");
    let chart = |more: &[&str]| {
        let arguments = ["chart", &file, "--until", "3", "--methods", "dop853", "--plot", &svg, "--csv", &csv];
        told(&[arguments.as_slice(), more].concat())
    };
    let said = chart(&["--needs", "angle,side", "--within", "2e-3"]).expect("an answer");
    assert!(
        said.contains("what the scene can do without:\nit does without forces.drag and with coordinates.r held at"),
        "{said}"
    );
    let drawn = std::fs::read_to_string(&svg).expect("a picture");
    let table = std::fs::read_to_string(&csv).expect("a table");
    let places = |name: &str| -> Vec<[f64; 2]> {
        let rows =
            table.lines().filter_map(|line| line.strip_prefix(&format!("SpringPendulum: what is left out,{name},")));
        rows.map(|row| [3, 4].map(|cell| row.split(',').nth(cell).expect("a cell").parse().expect("a number")))
            .collect()
    };
    for name in ["r held", "forces.drag", "springs.cord", "what may go together"] {
        assert!(drawn.contains(name) && places(name).len() == 1, "{name} in\n{table}");
    }
    // What is left out was run at one tolerance, of which the full model has one point only.
    for told in ["each alone at 1e-9; the numbers are tolerances", "the full model at 2e-3 to 1e-9"] {
        assert!(drawn.contains(told), "{told}");
    }
    // The full model: ever more work for ever smaller errors; of one rung its own.
    let full = places("the full model");
    assert!(
        full.len() >= 4 && full.windows(2).all(|pair| pair[1][0] < pair[0][0] && pair[1][1] > pair[0][1]),
        "{full:?}"
    );
    let [error, work] = places("r held")[0];
    assert!((1e-4..2e-3).contains(&error) && work < 0.05 * full[full.len() - 1][1], "{error} {work}");
    // By itself it has what the scene needs; a file that says nothing is not asked.
    assert!(chart(&[]).expect("an answer").contains("off by"));
    std::fs::write(&file, SPRING_PENDULUM.replace("  needs: {outputs: [angle], within: 1e-3}", "")).expect("a file");
    assert!(!chart(&[]).expect("an answer").contains("what the scene can do without"));
    assert!(chart(&["--needs", "angel"]).expect_err("a refusal").contains("`angel`"));
}

#[test]
fn questions_without_meaning_are_refused() {
    let need = |output: &str, within: f64| Some(Need::of(&[output], within));
    let refused = |request: NeedsRequest| asked(&request).expect_err("a refusal");
    let unknown = refused(NeedsRequest { need: need("hook", 1e-3), ..NeedsRequest::new(CRANE) });
    assert!(matches!(&unknown, NeedsError::UnknownName { name, .. } if name == "hook"), "{unknown}");
    let scene = refused(NeedsRequest { scene: Some("none".into()), ..NeedsRequest::new(CRANE) });
    assert!(matches!(scene, NeedsError::UnknownName { kind: "scene", .. }));
    for within in [0.0, -1.0, 2.0, f64::NAN, 1e-12] {
        assert!(matches!(
            refused(NeedsRequest { need: need("swing", within), ..NeedsRequest::new(CRANE) }),
            NeedsError::BadNeed { .. }
        ));
    }
    let still = oscillator("outputs: {nothing: 0*x}\nscene: {start: {x: 1}, until: 1}");
    assert!(matches!(
        refused(NeedsRequest { need: need("nothing", 1e-3), ..NeedsRequest::new(still) }),
        NeedsError::Still { .. }
    ));
    assert!(matches!(refused(NeedsRequest::new("name: [")), NeedsError::Model { .. }));
    let mut left = 2;
    let stopped = Needs::find(&NeedsRequest::new(CRANE), &mut |_| {
        left -= 1;
        if left == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    let Err(NeedsError::Interrupted { so_far: Some(found) }) = stopped else { panic!("it went on") };
    assert!(
        found.reductions.len() == 1 && found.sentence() == "what goes together was not found\n",
        "{}",
        found.table()
    );
    let misspelt = CRANE.replace("outputs: [load_x, swing]", "outputs: [load_y, swing]");
    let NeedsError::Model { problems } = refused(NeedsRequest::new(misspelt)) else {
        panic!("not a problem of the file")
    };
    assert!(problems[0].message.contains("load_y"), "{problems:?}");
}

/// A pendulum, and a block on a stiff spring that it does not feel; with a cord between them it does.
const TWO_PARTS: &str = r#"
name: TwoParts
parameters: {m: 1 kg, L: 1 m, g: 9.81 m/s^2, M: 2 kg, c: 1e5 N/m, k: 0 N/m}
coordinates: {theta: rad, x: m}
points: {hand: "L*[sin(theta), -cos(theta)]"}
bodies:
  bob: {mass: m, position: hand}
  block: {mass: M, position: "[x, 1]"}
gravity: [0, -g]
springs:
  stiff: {stretch: x, stiffness: c}
scene: {start: {theta: 1, x: 0.01}, until: 10, tolerance: 1e-8}
"#;

#[test]
fn what_nothing_wanted_feels_is_not_run() {
    let needs = found(TWO_PARTS, "theta");
    assert!(
        reduction(&needs, "coordinates.x").not_depended_on && !reduction(&needs, "coordinates.theta").not_depended_on,
        "{}",
        needs.table()
    );
    let choice = chosen(&needs);
    // The block is run apart already, its oscillation exactly: what it costs is little beside the pendulum's steps.
    assert!(choice.saving > 4.0 && choice.verified < 1e-3, "{}", needs.table());
    let text = needs.smaller_file().unwrap();
    assert!(text.contains("nothing wanted depends on it") && !text.contains("block:"), "{text}");
    holds(TWO_PARTS, &needs);
    let tied = TWO_PARTS.replace("  stiff:", "  cord: {between: [hand, block], stiffness: k, rest: L}\n  stiff:");
    let needs = found(&tied, "theta");
    assert!(!reduction(&needs, "coordinates.x").not_depended_on, "{}", needs.table());
}

#[test]
fn what_is_driven_and_drives_nothing_wanted_is_not_run() {
    // The block feels the pendulum, and the pendulum does not feel the block.
    let driven = TWO_PARTS.replace("scene:", "generalized_forces: {x: m*g*sin(theta)}\nscene:");
    let needs = found(&driven, "theta");
    assert!(
        reduction(&needs, "coordinates.x").not_depended_on && !reduction(&needs, "coordinates.theta").not_depended_on,
        "{}",
        needs.table()
    );
    assert!(chosen(&needs).saving > 10.0 && chosen(&needs).verified < 1e-3, "{}", needs.table());
    holds(&driven, &needs);
    let needs = found(&driven, "x");
    assert!(needs.reductions.iter().all(|reduction| !reduction.not_depended_on), "{}", needs.table());
}
