//! What took too long, or printed too much.

use dalembert::Method;

use super::{case, printed, text_of};

/// The integral of the table by hand: straight between points at 0, 1e-9, 1e-6, 1e-3, 1, 1000 s, and straight on beyond them.
#[test]
fn a_table_may_have_points_nanoseconds_and_minutes_apart() {
    let pieces = [(1e-9, 0.0, 1.0), (1e-6 - 1e-9, 1.0, -1.0), (1e-3 - 1e-6, -1.0, 2.0), (0.999, 2.0, 3.0)];
    let pieces = pieces.into_iter().chain([(999.0, 3.0, 4.0), (1000.0, 4.0, 4.0 + 1000.0 / 999.0)]);
    let impulse: f64 = pieces.map(|(length, from, to)| 1e6 * length * (from + to) / 2.0).sum();
    let run = case(&text_of("table_from_nanoseconds_to_hours")).run();
    assert!((run.last()["x'"] - impulse).abs() < 1e-9 * impulse, "{} {impulse}", run.last()["x'"]);
    // What turns too fast to be followed is refused as before.
    let wild = "name: Wild\ncoordinates: {x: 1}\nkinetic_energy: x'^2/2\ngeneralized_forces: {x: sign(sin(1e9*t))}\n\
        scene: {until: 1000}\n";
    let error = case(wild).try_run().unwrap_err().to_string();
    assert!(error.contains("oscillates too fast: it depends on time alone"), "{error}");
    // Neither does what the state makes: many samples a step, and all of them named.
    let wild = wild.replace("1e9*t", "1e12*x*x").replace("until", "start: {x: 1, x': 1}, until");
    let error = case(&wild).try_run().unwrap_err().to_string();
    assert!(error.contains("oscillates too fast: functions within it turn too often in one step"), "{error}");
}

/// The seat follows the road; the mirror's 20 kHz are not excited, and not followed.
#[test]
fn a_vibration_that_is_not_there_takes_no_steps() {
    let run = case(&text_of("mirror_of_a_lorry")).run();
    // By `exact`, a step for each vibration: 1,852,280 of them.
    assert!((run.last().get("seat").unwrap() + 0.053817913598988).abs() < 1e-9, "{:?}", run.last().get("seat"));
    assert!(run.work.steps < 10_000, "{}", run.work.steps);
    let smaller = printed("needs", "mirror_of_a_lorry", &["--until", "2"]);
    let mirror = smaller.lines().find(|line| line.contains("following zc")).unwrap_or_else(|| panic!("{smaller}"));
    assert!(mirror.contains("not needed"), "{smaller}");
}

/// By `exact` in 35 million steps: x[7] = 0.9995400920857, x[1] = 0.0752822462622.
#[test]
fn masses_of_eighteen_decades_move_as_slowly_as_they_do() {
    let run = case(&text_of("masses_of_eighteen_decades")).run();
    for (name, value) in [("x[7]", 0.9995400920857), ("x[1]", 0.0752822462622), ("x[6]", 0.4529187553487)] {
        assert!((run.last()[name] - value).abs() < 1e-8, "{name} {}", run.last()[name]);
    }
    assert!(run.work.steps < 10_000, "{}", run.work.steps);
}

#[test]
fn a_peak_in_an_integral_is_a_formula() {
    let text = text_of("narrow_peak_in_an_integral");
    let code = printed("show", "narrow_peak_in_an_integral", &["--rust"]);
    assert!(code.lines().count() < 400, "{}", code.lines().count());
    // The closed form stands in the file's `checks`; one that is off is refused.
    assert!(dalembert_symbolic::lower::compile(&text.replace("atan(x0/s)", "1.001*atan(x0/s)"), &[]).is_err());
}

#[test]
fn shifts_without_number_are_counted_and_not_listed() {
    let text = printed("check", "one_shared_square", &[]);
    assert!(
        text.contains("more directions in which coordinates may be shifted together") && text.len() < 2000,
        "{text}"
    );
}

/// What a kick of the first mass makes of the k-th grows like t^(2k - 1): far below what rounding of the others makes of it, which no step is short
/// enough for.
#[test]
fn a_kick_runs_down_a_chain_in_usual_steps() {
    let chain = |first: &str, tolerance: &str, method: Method| {
        let text = format!(
            "name: Chain\nparameters: {{l: 0.7, g: 9.81}}\ncoordinates: {{\"a[i in 1..10]\": rad}}\n\
             points:\n  \"p[0]\": [0, 0]\n  \"p[i in 1..10]\": \"p[i-1] + l*[sin(a[i]), -cos(a[i])]\"\n\
             bodies: {{\"b[i in 1..10]\": {{mass: 1.1, position: \"p[i]\"}}}}\ngravity: [0, -g]\n\
             scene: {{start: {{{first}}}, until: 1, tolerance: {tolerance}}}\n"
        );
        let mut case = case(&text);
        case.settings.method = method;
        case.run()
    };
    for first in ["\"a[i in 1..10]\": 0, \"a[1]'\": 1", "\"a[i in 1..10]\": 0.3"] {
        let known = chain(first, "1e-11", Method::Radau5);
        for method in [Method::Dop853, Method::Taylor] {
            for (tolerance, within) in [("1e-6", 1e-4), ("1e-9", 1e-7), ("1e-12", 1e-8)] {
                let run = chain(first, tolerance, method);
                assert!(run.work.steps < 500, "{first} {method:?} {tolerance}: {}", run.work.steps);
                for name in ["a[1]", "a[10]"] {
                    assert!(
                        (run.last()[name] - known.last()[name]).abs() < within,
                        "{first} {method:?} {tolerance} {name}"
                    );
                }
            }
        }
    }
}
