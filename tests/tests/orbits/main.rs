//! Motions that repeat, against references of twenty digits and more and closed forms.

mod double_double;
mod driven;
mod relaxation;
mod returns;
mod touching;
mod walkers;

use dalembert::prelude::*;
use dalembert_models::MODELS;
use dalembert_tests::told::{near, number, reference, written};
use serde_json::Value;

/// What `orbit` prints as JSON, or what it says is wrong.
fn told(arguments: &[&str]) -> Result<Value, String> {
    dalembert_tests::told::told(&[&["orbit"], arguments].concat())
}

/// A value is as near to the reference as its error says, and as this.
fn holds(found: &Value, expected: f64, error: f64) {
    near(number(&found["value"]), expected, error);
    near(number(&found["value"]), expected, number(&found["error"]) + 1e-15 * expected.abs());
}

/// Every expected multiplier (re, im) is among those found.
fn multiplied(found: &Value, expected: &Value, error: f64) {
    let found: Vec<[f64; 2]> =
        found.as_array().expect("multipliers").iter().map(|m| [number(&m["re"]), number(&m["im"])]).collect();
    for pair in expected.as_array().expect("multipliers") {
        let [re, im] = [number(&pair[0]), number(&pair[1])];
        let nearest = found.iter().map(|m| (m[0] - re).hypot(m[1] - im)).fold(f64::INFINITY, f64::min);
        assert!(nearest <= error, "{re} {im}: {found:?}");
    }
}

/// T = 4 K(m)/√(1 + k A²) with m = k A²/(2 (1 + k A²)) of x'' = −x − k x³ with the energy A²/2 + k A⁴/4, K by the arithmetic-geometric mean.
#[test]
fn a_loose_tolerance_finds_the_shortest_period() {
    let file = written(
        "name: Free\nparameters: {k3: 1}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: x^2/2 + k3*x^4/4\n\
         scene: {start: {x: 1}, until: 100, tolerance: 1e-12}\n",
    );
    for (k, tolerance, least) in [(1.0, "1e-8", 1e-7), (5.0, "1e-6", 1e-5), (1.0, "1e-4", 1e-3)] {
        let (set, energy) = (format!("k3={k}"), 5.0_f64);
        let arguments = ["--from", "mode 1", "--energy", "5", "--set", &set, "--tolerance", tolerance];
        let found = told(&[&[file.as_str()], &arguments[..]].concat()).unwrap();
        let square = ((1.0 + 4.0 * k * energy).sqrt() - 1.0) / k;
        let stiffness = 1.0 + k * square;
        let (mut a, mut b) = (1.0, (1.0 - 0.5 * k * square / stiffness).sqrt());
        for _ in 0..8 {
            (a, b) = (0.5 * (a + b), (a * b).sqrt());
        }
        near(number(&found["period"]["value"]), std::f64::consts::TAU / (a * stiffness.sqrt()), least);
    }
}

/// The figure eight from its eight digits: T |E|^1.5 does not depend on which member of its family is found.
#[test]
fn the_figure_eight_is_found_with_its_eight_multipliers_of_one() {
    let known = reference("figure_eight");
    let found = told(&["figure_eight", "--tolerance", "1e-13", "--period", "6.3"]).unwrap();
    let energy = number(&found["energy"]);
    let invariant = number(&found["period"]["value"]) * energy.abs().powf(1.5);
    near(invariant, number(&known["invariant_T_absE_3_2"]), 1e-13);
    assert!(found["steps"].as_u64().unwrap() <= 6, "{}", found["steps"]);
    let mut rates: Vec<f64> =
        found["whole"].as_array().unwrap().iter().map(|m| number(&m["angle"]).abs() / std::f64::consts::TAU).collect();
    rates.sort_by(f64::total_cmp);
    assert_eq!(rates.len(), 4);
    near(rates[0], number(&known["nu"][0]), 1e-10);
    near(rates[2], number(&known["nu"][1]), 1e-10);
    assert_eq!(found["known"].as_array().unwrap().len(), 8, "{}", found["known"]);
    let free: Vec<&str> = found["free"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let shifts = ["shift of x[1], x[2], x[3]", "shift of y[1], y[2], y[3]"];
    assert_eq!(free, ["time", shifts[0], shifts[1], "the motion of `spin`", "scale"]);
}

/// Two families of the double pendulum at six energies each; the one out of phase has a full map that touches −1 at 1.8863 J, where nothing
/// happens, and loses its stability at 8.17 J.
#[test]
fn the_double_pendulum_swings_in_two_families() {
    let known = reference("double_pendulum");
    for mode in [1, 2] {
        let found =
            told(&["double_pendulum", "--from", &format!("mode {mode}"), "--vary", "energy=0.1,2,6,8.3"]).unwrap();
        for point in known["points"].as_array().unwrap().iter().filter(|point| point["mode"] == mode) {
            let energy = number(&point["energy_above_rest"]);
            let members = found["members"].as_array().unwrap();
            let member = members.iter().find(|m| m["asked"] == true && (number(&m["value"]) - energy).abs() < 1e-9);
            let member = member.unwrap_or_else(|| panic!("no member at {energy} J"));
            near(number(&member["period"]), number(&point["period"]), 1e-10);
            // Each begins where it turns round: all speeds are 0 there.
            for name in ["theta1", "theta2"] {
                near(number(&member["start"][name]).abs(), number(&point[name]).abs(), 1e-10);
            }
            // The half map's multipliers squared are those of the whole period.
            let whole = (2.0 * number(&member["multipliers"][0]["angle"])).cos();
            near(whole, number(&point["half_trace"]), 1e-8);
        }
        let thresholds = found["thresholds"].as_array().unwrap();
        if mode == 2 {
            assert_eq!(thresholds.len(), 1, "{thresholds:?}");
            let expected = number(&known["loss_of_stability"]["point"]["energy_above_rest"]);
            holds(&thresholds[0], expected, 1e-8);
        } else {
            assert!(thresholds.is_empty(), "{thresholds:?}");
        }
    }
}

/// A range is the family from its first value to its last, wherever the search begins; a single motion is found where its family leads.
#[test]
fn energies_of_a_range_are_kept_and_reached() {
    let known = reference("double_pendulum");
    for range in ["energy=3..0.1", "energy=0.1..3"] {
        let found = told(&["double_pendulum", "--from", "mode 1", "--vary", range]).unwrap();
        let members = found["members"].as_array().unwrap();
        let values: Vec<f64> = members.iter().map(|member| number(&member["value"])).collect();
        let way = if range.ends_with('3') { 1.0 } else { -1.0 };
        assert!(values.len() > 10 && values.windows(2).all(|pair| way * (pair[1] - pair[0]) > 0.0), "{values:?}");
        let (low, high) = if way > 0.0 { (0, values.len() - 1) } else { (values.len() - 1, 0) };
        near(values[low], 0.1, 1e-12);
        near(values[high], 3.0, 1e-12);
        let first = known["points"].as_array().unwrap().iter().find(|point| point["energy_above_rest"] == "0.1");
        near(number(&members[low]["period"]), number(&first.unwrap()["period"]), 1e-10);
    }
    let point = &known["loss_of_stability"]["point"];
    let energy = point["energy_above_rest"].as_str().unwrap();
    let found = told(&["double_pendulum", "--from", "mode 2", "--energy", energy]).unwrap();
    near(number(&found["period"]["value"]), number(&point["period"]), 1e-8);
}

/// A mass between a floor and a wall, off which it bounces without loss: two motions of one freedom, each with its own energy, whose four multipliers
/// are 1.  Two of them come apart by the root of rounding.
#[test]
fn a_double_multiplier_of_one_grows_by_rounding_alone() {
    let file = written(
        "name: Parts\nparameters: {m: 1 kg, g: 10 m/s^2, e: 1, d: 1 m, k: 4 N/m}\ncoordinates: {x: m, y: m}\n\
         points: {P: \"[x, y]\"}\nbodies: {b: {mass: m, position: P}}\n\
         springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}\ngravity: [0, -g]\n\
         constraints: {floor: y, wall: x - d}\nphases: {free: [], f: [floor], w: [wall]}\nevents:\n\
         \x20 bounce: {phase: free, when: y, direction: falling, then: {impact: e, along: floor}}\n\
         \x20 hit: {phase: free, when: x - d, direction: rising, then: {impact: e, along: wall}}\n\
         scene: {start: {x: 0, y: 0.8, x': 2.5, y': 0}, until: 20, tolerance: 1e-12}\n",
    );
    for more in [&["--period", "1.6"][..], &[]] {
        let found = told(&[&[file.as_str()], more].concat()).unwrap();
        assert_eq!(found["stable"], true, "{found}");
        for multiplier in found["multipliers"].as_array().unwrap() {
            let off = (number(&multiplier["re"]) - 1.0).hypot(number(&multiplier["im"]));
            assert!(off <= number(&multiplier["error"]) && off < 1e-5, "{multiplier}");
        }
    }
}

/// Problems of the course, each by a command: 5, a rosette by the half of it, where it reverses itself; 7 c, the eight after a push; 39 b, a
/// motion of the triple pendulum that repeats, far from small ones.
#[test]
fn problems_that_ask_for_periodic_motions_are_commands() {
    let solve = ["solve", "central_force", "--unknown", "y'=0.36,until=11.6", "--such-that", "y=0,x'=0"];
    let found = dalembert_tests::told::told(&solve).unwrap();
    let known = &reference("central_force")["point"];
    let value = |name: &str| number(&found["values"][name]["value"]);
    near(value("y'"), number(&known["speed"]), 1e-13);
    near(2.0 * value("until"), number(&known["period"]), 1e-11);
    let pushed = ["figure_eight", "--start", "x[1]=-0.96", "--start", "y[3]=0.01", "--period", "6.3"];
    let found = told(&pushed).unwrap();
    // An eight of another size: T |E|^1.5 is the same for all of them.
    let (period, energy) = (number(&found["period"]["value"]), number(&found["energy"]));
    near(period * energy.abs().powf(1.5), 9.237_681_250_724_55, 1e-10);
    let found = told(&["triple_pendulum", "--from", "mode 1", "--energy", "1"]).unwrap();
    near(number(&found["energy"]), 1.0, 1e-10);
    assert!(number(&found["returns"]) < 1e-9, "{found}");
}

/// One value is one motion; a value that the family does not reach is said to be so by where it ends.
#[test]
fn a_family_of_one_value_is_one_motion() {
    let file = relaxation::van_der_pol();
    let found = told(&[&file, "--vary", "mu=2"]).unwrap();
    assert_eq!(found["members"].as_array().unwrap().len(), 1, "{found}");
    let found = told(&["double_pendulum", "--from", "mode 1", "--amplitude", "0.1", "--vary", "energy=0.5"]).unwrap();
    let last = found["members"].as_array().unwrap().last().unwrap();
    near(number(&last["value"]), 0.5, 1e-10);
    assert_eq!(last["asked"], true);
    for option in [["--energy", "2"], ["--vary", "energy=..2"]] {
        let refused = told(&[&[file.as_str()][..], &option].concat()).unwrap_err();
        assert!(refused.contains("does not keep its energy"), "{refused}");
    }
}

/// All motions that files of the library name are found, and run as they say.
#[test]
fn every_motion_of_the_library_is_found() {
    let mut count = 0;
    for entry in MODELS {
        for motion in (entry.compiled.expect("its code"))().motions() {
            let closes = matches!(motion.goal, dalembert::mechanism::Goal::Closes(_));
            let verb = if closes { "orbit" } else { "solve" };
            let found = dalembert_tests::told::told(&[verb, entry.name, "--motion", &motion.name]);
            let found = found.unwrap_or_else(|why| panic!("{} {}: {why}", entry.name, motion.name));
            if closes {
                assert!(number(&found["returns"]) < 1e-8, "{} {}: {found}", entry.name, motion.name);
            }
            count += 1;
        }
    }
    assert!(count >= 5, "{count}");
}

/// In the library a motion of a file is searched for by its name, too.
#[test]
fn a_motion_of_a_file_is_found_by_its_name() {
    let pendulum = dalembert_models::double_pendulum::DoublePendulum::default();
    let orbit = pendulum.simulate().orbit_of("swing").find().expect("an orbit");
    let asked = told(&["double_pendulum", "--motion", "swing"]).expect("an orbit");
    near(orbit.period.value, number(&asked["period"]["value"]), 1e-10);
    let unknown = pendulum.simulate().orbit_of("nothing").find().expect_err("no such motion").to_string();
    assert!(unknown.contains("there are `swing`"), "{unknown}");
    let ball = dalembert_models::cannon_ball::CannonBall::default();
    let name = ball.system().motions()[0].name.to_string();
    let error = ball.simulate().orbit_of(&name).find().expect_err("a flight").to_string();
    assert!(error.contains("does not say how it closes"), "{error}");
}

#[test]
fn what_does_not_close_is_said_to_be_so() {
    // A damped oscillator comes to rest only.
    let file = written(
        "name: Damped\nparameters: {k: 1, c: 0.3}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: k*x^2/2\n\
         dissipation: c*x'^2/2\nscene: {start: {x: 1}, until: 30}\n",
    );
    let refused = told(&[&file, "--period", "6.3"]).unwrap_err();
    assert!(refused.contains("equilibrium"), "{refused}");
    // Two frequencies without a common period.
    let file = written(
        "name: Twice\nparameters: {k: 1, c: 0.3}\ncoordinates: {x: 1}\ninputs: {a: cos(t), b: cos(sqrt(2)*t)}\nkinetic_energy: x'^2/2\n\
         potential_energy: k*x^2/2 - (a + b)*x\ndissipation: c*x'^2/2\nscene: {start: {x: 1}, until: 30}\n",
    );
    let refused = told(&[&file]).unwrap_err();
    assert!(refused.contains("no common period"), "{refused}");
    // An event that does not happen, and one that changes nothing.
    let refused = told(&["bouncing_ball", "--at", "nothing"]).unwrap_err();
    assert!(refused.contains("nothing"), "{refused}");
    // Exchanging what is not alike.
    let refused = told(&["double_pendulum", "--period", "2.3", "--exchange", "theta1=theta2"]).unwrap_err();
    assert!(refused.contains("does not move alike"), "{refused}");
    let refused = told(&["double_pendulum", "--from", "mode 3"]).unwrap_err();
    assert!(refused.contains("no mode 3"), "{refused}");
    // A search that does not end at a motion says where it ended, and what the run does instead.
    let state = written("");
    let refused = told(&["figure_eight", "--period", "3.16", "--save", &state]).unwrap_err();
    assert!(
        refused.contains("comes nearest to its own states again: to that of t = 0.000000 s after 6.32"),
        "{refused}"
    );
    assert!(std::fs::read_to_string(state).expect("a state").contains("\"x[1]'\": "));
}

/// Between two states that reverse time a motion begins at one: at rest, where that is said.  All motions of a linear oscillator have 2π.
#[test]
fn a_motion_that_turns_round_at_rest_begins_there() {
    let file = written(
        "name: Turns\nparameters: {k: 1}\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\npotential_energy: k*x^2/2\n\
         motions:\n  quarter: {closes: {part: 1/4, from: {}, to: {mirror: [x]}}, start: {x: 0.7}}\n\
         \x20 half: {closes: {part: 1/2, from: {}, to: {}}, start: {x: 0.7}}\n\
         scene: {start: {x: 1}, until: 10, tolerance: 1e-12}\n",
    );
    let found = told(&[&file, "--motion", "quarter"]).unwrap();
    holds(&found["period"], std::f64::consts::TAU, 1e-12);
    near(number(&found["start"]["x"]["value"]), 0.7, 1e-12);
    near(number(&found["start"]["x'"]["value"]), 0.0, 1e-15);
    // Between rest and rest, of which the smallest map is that of half a period.
    let found = told(&[&file, "--motion", "half"]).unwrap();
    near(number(&found["start"]["x"]["value"]), 0.7, 1e-12);
    assert_eq!(found["map"]["part"], 2);
    let found = told(&["double_pendulum", "--motion", "brake"]).unwrap();
    for rate in ["theta1'", "theta2'"] {
        near(number(&found["start"][rate]["value"]), 0.0, 1e-12);
    }
}

/// A guess of so many periods of √10 rad/s is told by one of them, however many they are.
#[test]
fn a_guess_of_many_periods_is_told_by_one() {
    let file = written(
        "name: Laps\nparameters: {m: 1 kg, k: 10 N/m}\ncoordinates: {x: m}\nkinetic_energy: m*x'^2/2\n\
         potential_energy: k*x^2/2\nscene: {start: {x: 1}, until: 100}\n",
    );
    let period = std::f64::consts::TAU / 10.0_f64.sqrt();
    for laps in [1, 2, 7, 13, 14, 15, 22] {
        let guess = (f64::from(laps) * period).to_string();
        let found = told(&[&file, "--period", &guess]).unwrap();
        holds(&found["period"], period, 1e-9);
    }
}

/// A family by what the start alone contains has one motion at each of its places.
#[test]
fn what_the_equations_do_not_contain_is_no_family() {
    let file = written(
        "name: Hardening\nparameters: {m: 1 kg, k: 1 N/m, b: 1 N/m^3, A: 1 m}\ncoordinates: {x: m}\n\
         bodies: {p: {mass: m, position: '[x, 0]'}}\nforces: {f: {on: p, force: '[-k*x - b*x^3, 0]'}}\n\
         scene: {start: {x: A}, until: 20}\n",
    );
    let refused = told(&[&file, "--vary", "A=0.5..2"]).unwrap_err();
    assert!(refused.contains("the equations do not contain `A`"), "{refused}");
    assert!(told(&[&file, "--vary", "k=1,1.2"]).is_ok());
}

/// The motions of a family close: two modes of one frequency (Hénon and Heiles 1964) look free where it begins, and are not farther on.
#[test]
fn directions_that_are_free_where_a_family_begins_need_not_stay_so() {
    let file = written(
        "name: Heiles\nparameters: {lam: 1}\ncoordinates: {x: 1, y: 1}\nkinetic_energy: (x'^2 + y'^2)/2\n\
         potential_energy: (x^2 + y^2)/2 + lam*(x^2*y - y^3/3)\nscene: {start: {x: 0.1, y: 0, y': 0.1}, until: 50}\n",
    );
    let found = told(&[&file, "--from", "mode 2", "--amplitude", "0.2", "--vary", "energy=0.02..0.15"]).unwrap();
    // scipy, by the return of y = 0 at a tolerance of 1e-12.
    let thresholds = found["thresholds"].as_array().unwrap();
    let doubling = thresholds.iter().find(|found| (number(&found["value"]) - 0.135_285_919_3).abs() < 1e-8);
    assert!(doubling.is_some(), "{thresholds:?}");
    // Each member of the one that looks free closes by a run of its own.
    let found = told(&[&file, "--from", "mode 1", "--vary", "energy=..0.001"]).unwrap();
    let member = found["members"].as_array().unwrap().last().unwrap().clone();
    let (period, start) = (number(&member["period"]), &member["start"]);
    let until = period.to_string();
    let starts = ["x", "y", "x'", "y'"].map(|name| format!("{name}={}", number(&start[name])));
    let mut arguments = vec!["simulate", &file, "--until", &until, "--tolerance", "1e-12"];
    starts.iter().for_each(|start| arguments.extend(["--start", start]));
    let run = dalembert_tests::told::told(&arguments).unwrap();
    for name in ["x", "y"] {
        near(number(&run["q"][name]), number(&start[name]), 1e-8);
    }
}

/// A run for as long as a motion takes ends where it began, which is a return: Arenstorf's orbit.
#[test]
fn the_end_of_a_run_is_a_return() {
    let file = written(
        "name: Arenstorf\nparameters: {mu: 0.012277471}\ncoordinates: {x: 1, y: 1}\n\
         define: {r1: 'sqrt((x + mu)^2 + y^2)', r2: 'sqrt((x - 1 + mu)^2 + y^2)'}\n\
         kinetic_energy: ((x' - y)^2 + (y' + x)^2)/2\npotential_energy: -(1 - mu)/r1 - mu/r2\n\
         scene: {start: {x: 0.994, y': -2.00158510637908252}, until: 17.0652165601579626, tolerance: 1e-13}\n",
    );
    holds(&told(&[&file]).unwrap()["period"], 17.065_216_560_158, 1e-6);
}

/// A bead in a frame that turns: ω⁴ − 15 ω² + 24 = 0, and its coordinates turn round at different times.  A pendulum far from small motions swings
/// with 4 K/ω0.
#[test]
fn a_mode_leads_to_its_own_motion() {
    let bead = written(
        "name: Bead\nparameters: {W: 1 rad/s, m: 1 kg, k1: 4 N/m, k2: 9 N/m, n: 3 N/m^3}\ncoordinates: {x: m, y: m}\nframes: {R: {angle: W*t}}\n\
         bodies: {b: {mass: m, position: \"x*R.x + y*R.y\"}}\npotential_energy: k1*x^2/2 + k2*y^2/2 + n*(x^4 + x^2*y^2)/4\n\
         scene: {start: {x: 0.5}, until: 8, tolerance: 1e-10}\n",
    );
    for (mode, omega) in [("mode 1", (7.5 - 32.25_f64.sqrt()).sqrt()), ("mode 2", (7.5 + 32.25_f64.sqrt()).sqrt())] {
        let found = told(&[&bead, "--from", mode]).unwrap();
        near(number(&found["period"]["value"]), std::f64::consts::TAU / omega, 1e-4);
    }
    let wide = told(&[&bead, "--from", "mode 1", "--amplitude", "0.3"]).unwrap();
    near(number(&wide["period"]["value"]), 4.5167, 0.1);
    let pendulum = told(&["simple_pendulum", "--from", "mode 1", "--amplitude", "3"]).unwrap();
    let start = number(&pendulum["start"]["theta"]["value"]).abs();
    let (mut a, mut b) = (1.0, (0.5 * start).cos());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    // The library's has l = 1 m and g = 10 m/s².
    near(number(&pendulum["period"]["value"]), std::f64::consts::TAU / (10.0_f64.sqrt() * a), 1e-9);
}
