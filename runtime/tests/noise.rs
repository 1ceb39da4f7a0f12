//! Held noise against numbers of Python, closed forms and itself: the same whatever the method, the piece and the thread.
#![cfg(all(feature = "cli", feature = "modal"))]

mod program;

use dalembert::mechanism::{Dynamic, Interpreted, System};
use dalembert_symbolic::lower::compile;
use program::{File, json, near, reference, run};

dalembert::model!("../models/mast_in_gusts.yaml");

const MAST: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/mast_in_gusts.yaml");

/// An oscillator that noise drives, with more sections.
fn oscillator(name: &str, noise: &str, more: &str) -> File {
    let text = format!(
        "name: Shaken\nparameters: {{m: 1 kg, k: 100 N/m, c: 2 N*s/m}}\ncoordinates: {{x: m}}\nnoise: {{{noise}}}\n\
         bodies: {{b: {{mass: m, position: \"[x, 0]\"}}}}\nsprings: {{s: {{stretch: x, stiffness: k, along: \"[1, 0]\", on: b}}}}\n\
         forces: {{wind: {{on: b, force: \"[gust - c*x', 0]\"}}}}\nscene: {{until: 2, tolerance: 1e-10}}\n{more}"
    );
    File::new(name, &text)
}

const GUST: &str = "gust: {every: 10 ms, sigma: 2 N, seed: 7}";
const STRAIGHT: &str = "gust: {every: 10 ms, sigma: 2 N, seed: 7, smooth: 1}";

#[test]
fn runs_are_those_of_python() {
    let expected = reference("noise");
    let gust = expected["gust"].as_f64().expect("a number");
    for (name, noise) in [("held", GUST), ("straight", STRAIGHT)] {
        let file = oscillator(&format!("python-{name}"), noise, "");
        for method in ["exact", "dop853", "dopri5", "radau5", "gauss4"] {
            let found = json(&["simulate", &file.0, "--method", method]);
            // One step for the whole run, found from the tolerance, is less exact than steps that follow the motion.
            let within = if method == "gauss4" { 1e-7 } else { 1e-9 };
            near(&found["q"]["x"], expected[name]["x"].as_f64().expect("a number"), within);
            near(&found["v"]["x"], expected[name]["speed"].as_f64().expect("a number"), 10.0 * within);
            near(&found["outputs"]["gust"], gust, 1e-12);
            assert_eq!(found["memory"]["gust"].as_f64().map(f64::to_bits), Some(gust.to_bits()));
            assert_eq!(found["ticks"]["gust"], 201, "{method}");
        }
    }
}

/// √(S/T) is the standard deviation of white noise of density S.
#[test]
fn a_density_is_that_of_white_noise() {
    let file = oscillator("density", "gust: {every: 10 ms, density: 0.04 N^2*s, seed: 7}", "");
    let (found, same) = (json(&["simulate", &file.0]), oscillator("same", GUST, ""));
    near(&found["q"]["x"], json(&["simulate", &same.0])["q"]["x"].as_f64().expect("a number"), 1e-15);
    // White noise moves the mast by √(l² S/(2 c K)): of 3600 s, some 560 times as long as it remembers.
    let found = run(&["simulate", MAST, "--until", "3600", "--every", "0.1", "--csv", "-", "--no-digits", "-q"]);
    let table = found.expect("a run");
    let angles: Vec<f64> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(1).unwrap_or_default().parse().expect("a number"))
        .collect();
    let square = angles.iter().map(|angle| angle * angle).sum::<f64>() / angles.len() as f64;
    let stiffness = 3e4 - 40.0 * 9.81 * 6.0 / 2.0;
    let white = 36.0 * 100.0 / (2.0 * 150.0 * stiffness);
    // The spectrum of what is straight between ticks is less by sinc⁴ at the natural frequency.
    let phase = 0.5 * 0.05 * f64::sqrt(stiffness / 480.0);
    let expected = white * (phase.sin() / phase).powi(4);
    // The mean of a square over T is uncertain by √(2/(2 δ T)) with the decay δ = c/2I: 4 %.
    assert!((square / expected - 1.0).abs() < 0.12, "{square:e} {expected:e}");
}

#[test]
fn a_run_cut_in_two_is_the_run_in_one_piece() {
    let saved = |name: &str| std::env::temp_dir().join(format!("dalembert-noise-{name}-{}.txt", std::process::id()));
    for (k, noise) in [GUST, STRAIGHT].into_iter().enumerate() {
        let file = oscillator(&format!("cut-{k}"), noise, "");
        let [whole, first, second] = ["whole", "first", "second"].map(|name| saved(&format!("{name}-{k}")));
        let path = |path: &std::path::Path| path.to_str().expect("a path").to_owned();
        let simulate = ["simulate", &file.0, "--method", "dopri5", "--no-digits"];
        run(&[&simulate[..], &["--until", "2", "--save", &path(&whole)]].concat()).expect("a run");
        run(&[&simulate[..], &["--until", "1.2", "--save", &path(&first)]].concat()).expect("a run");
        let on = ["--state", &path(&first), "--until", "2", "--save", &path(&second)];
        run(&[&simulate[..], &on].concat()).expect("a run");
        let numbers = [&whole, &second].map(|path| {
            let text = std::fs::read_to_string(path).expect("a state");
            text.lines().filter(|line| !line.starts_with("step:")).collect::<String>()
        });
        assert_eq!(numbers[0], numbers[1]);
        [whole, first, second].iter().for_each(|path| std::fs::remove_file(path).expect("a file"));
    }
}

/// Seeds and names tell streams apart; the period does not tell numbers apart, and where a run starts neither.
#[test]
fn seeds_and_names_are_streams() {
    let at = |noise: &str, until: &str| {
        let file = oscillator(&format!("streams-{}-{until}", noise.len()), noise, "");
        json(&["simulate", &file.0, "--until", until])["memory"]["gust"].as_f64().expect("a number")
    };
    let gust = at(GUST, "2");
    assert_ne!(gust, at("gust: {every: 10 ms, sigma: 2 N, seed: -7}", "2"));
    assert_ne!(gust, at("gust: {every: 10 ms, sigma: 2 N}", "2"));
    assert_eq!(gust, at("gust: {every: 20 ms, sigma: 2 N, seed: 7}", "4"));
    assert_eq!(gust, at("gust: {every: 10 ms, from: 1 s, sigma: 2 N, seed: 7}", "3"));
    let file = oscillator("seed", GUST, "");
    let other = json(&["simulate", &file.0, "--set", "gust_seed=8"]);
    assert_ne!(other["memory"]["gust"].as_f64(), Some(gust));
    let file = oscillator("two", &format!("{GUST}, \"more[i in 1..2]\": {{every: 10 ms, sigma: 2 N, seed: 7}}"), "");
    let found = json(&["simulate", &file.0]);
    let held = ["gust", "more[1]", "more[2]"].map(|name| found["memory"][name].as_f64().expect("a number"));
    assert!(held[0] == gust && held[1] != held[0] && held[2] != held[1], "{held:?}");
}

#[test]
fn compiled_and_interpreted_noise_are_the_same_bits() {
    let text = std::fs::read_to_string(MAST).expect("the model");
    let interpreted = Interpreted::new(compile(&text, &[]).expect("a good file"), &text);
    let compiled = Dynamic::new(MastInGusts::default());
    assert_eq!(compiled.held_noise(), interpreted.held_noise());
    let assigned = |system: &dyn System, k: u32| {
        let (mut values, at) = ([0.0; 3], [0.0]);
        system.assignments(dalembert::mechanism::At::new(0.05 * f64::from(k), &at, &at), &mut values);
        values.map(f64::to_bits)
    };
    for k in 0..2000 {
        assert_eq!(assigned(&compiled, k), assigned(&interpreted, k), "{k}");
    }
}

/// Every thread and every part of a sweep meets the numbers of its seed.
#[test]
fn sweeps_run_many_seeds() {
    let file = oscillator("sweep", GUST, "");
    let rows = |more: &[&str]| {
        let text = run(&[&["sweep", &file.0, "--seeds", "1..6", "--csv", "-", "-q"], more].concat()).expect("a sweep");
        let rows = text.lines().skip(1).map(str::to_owned).collect::<Vec<String>>();
        assert_eq!(rows.len(), 6, "{text}");
        rows
    };
    let all = rows(&["--threads", "1"]);
    assert_eq!(all, rows(&["--threads", "4"]));
    for (row, seed) in all.iter().zip(1..) {
        let cells: Vec<f64> = row.split(',').take(4).map(|cell| cell.parse().expect("a number")).collect();
        let single = json(&["simulate", &file.0, "--set", &format!("gust_seed={seed}")]);
        assert_eq!(cells[1], f64::from(seed));
        near(&single["q"]["x"], cells[3], 1e-12);
    }
    let grid =
        run(&["sweep", &file.0, "--seeds", "3,5", "--vary", "c=1,2,3 N*s/m", "--csv", "-", "-q"]).expect("a sweep");
    assert_eq!(grid.lines().count(), 7);
    for seeds in ["1..", "5..1", "1.5..3", "a"] {
        assert!(run(&["sweep", &file.0, "--seeds", seeds]).expect_err("no seeds").contains("whole numbers"), "{seeds}");
    }
    let quiet = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/double_pendulum.yaml");
    assert!(run(&["sweep", quiet, "--seeds", "1..3"]).expect_err("no noise").contains("no noise with a seed"));
}

#[test]
fn small_motions_freeze_noise_at_its_mean() {
    let text = run(&["modes", MAST]).expect("modes");
    assert!(text.contains("omega = 7.74903 rad/s"), "{text}");
    // A loop that ticks close is what it is without noise.
    let law = "memory: {u: 0 N}\nevents: {tick: {every: 20 ms, then: {set: {u: -20*x/L*N - 0.2*x'/V*N}}}}\n";
    let loops = [
        "gust: {every: 7 ms, sigma: 2 N}",
        "gust: {every: 20 ms, sigma: 2 N, smooth: 1}",
        "gust: {every: 1 s, sigma: 0 N}",
    ]
    .map(|noise| {
        let file = oscillator(&format!("loop-{}", noise.len()), noise, law);
        let text = std::fs::read_to_string(&file.0).expect("the file");
        let text =
            text.replace("c: 2 N*s/m}", "c: 2 N*s/m, L: 1 m, V: 1 m/s, N: 1 N}").replace("[gust - c", "[u + gust - c");
        std::fs::write(&file.0, text).expect("the file");
        json(&["modes", &file.0, "--sampled"])
    });
    assert_eq!(
        (loops[0]["period"].as_f64(), loops[0]["unread"].as_array().map(Vec::len)),
        (Some(0.02), Some(0)),
        "{}",
        loops[0]
    );
    assert!(
        loops.iter().all(|found| found["z"] == loops[0]["z"] && found["unread"] == loops[0]["unread"]),
        "{loops:?}"
    );
}

#[test]
fn wrong_noise_is_refused_with_its_reason() {
    let told = |noise: &str, more: &str| {
        let file = oscillator("refused", noise, more);
        run(&["check", &file.0]).err().unwrap_or_default()
    };
    assert_eq!(told(GUST, ""), "");
    for (noise, code) in [
        ("gust: {sigma: 2 N}", "E302"),
        ("gust: {every: 10 ms}", "E306"),
        ("gust: {every: 10 ms, sigma: 2 N, density: 1 N^2*s}", "E305"),
        ("gust: {every: 10 ms, sigma: 2 N, sede: 7}", "E301"),
        ("gust: {every: 10 ms, sigma: 2 N, seed: 1.5}", "E281"),
        ("gust: {every: 10 ms, sigma: 2 N, seed: 1e300}", "E281"),
        ("gust: {every: 10 ms, sigma: 2 N, seed: nan}", "E281"),
        ("gust: {every: 10 ms, sigma: 2 N, seed: m}", "E242"),
        ("gust: {every: 10 ms, sigma: 2 N, smooth: 2}", "E307"),
        ("gust: {every: 10 ms, sigma: -2 N}", "E411"),
        ("gust: {every: 0 s, sigma: 2 N}", "E411"),
        ("gust: {every: 2 m, sigma: 2 N}", "E242"),
        ("gust: {every: 10 ms, sigma: 2 m}", "E241"),
        ("gust: {every: 10 ms, density: 2 N}", "E241"),
        ("gust: {every: 10 ms, sigma: x}", "E215"),
        ("gust: 3 N", "E304"),
        ("m: {every: 10 ms, sigma: 2 N}", "E202"),
    ] {
        let found = told(noise, "");
        assert!(found.contains(&format!("error[{code}]")), "{noise}: {found}");
    }
    // It is a name of its own: nothing else sets it, and no output is called so; what it moves would jump.
    assert!(told(GUST, "events: {e: {every: 1 s, then: {set: {gust: 0}}}}\n").contains("error[E271]"));
    assert!(told(GUST, "outputs: {gust: x}\n").contains("error[E275]"));
    assert!(
        told("gust: {every: 10 ms, sigma: 2 N, smooth: 1}, s: {every: 1 s, sigma: 1 m}", "points: {p: \"[s, 0]\"}\n")
            .contains("error[E270]")
    );
}
