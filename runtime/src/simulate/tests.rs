use super::*;
use crate::testing::Toy;

/// Runs the toy's scene with changed settings.
fn run(mut toy: Toy, change: impl FnOnce(&mut Settings)) -> Result<Run, Error> {
    let mut settings = Settings::new(&toy.scene);
    change(&mut settings);
    simulate(&mut toy, &settings)
}

#[test]
fn an_oscillator_returns_after_ten_periods() {
    let until = 20.0 * std::f64::consts::PI;
    for (method, bound) in [(Method::Dopri5, 2e-6), (Method::Dop853, 2e-7)] {
        let run = run(Toy::oscillator(1.0, until), |s| s.method = method).unwrap();
        let last = run.last();
        assert_eq!(last.t, until);
        assert!((last["x"] - 1.0).abs() < bound && last["x'"].abs() < bound, "{method}: {last:?}");
        assert_eq!(run.len(), 501);
        for t in [0.0, 1.0, 2.5, 33.3, until] {
            let error = (run.at(t).unwrap()["x"] - t.cos()).abs();
            assert!(error < bound, "{method}: {error:e} at {t}");
        }
        assert!(run.at(-0.1).is_none() && run.at(until + 0.1).is_none());
        println!("{}", run.trust());
    }
}

#[test]
fn reported_states_lie_on_the_motion() {
    let run = run(Toy::oscillator(1.0, 10.0), |s| {
        s.every = Some(0.3);
        s.tolerance = 1e-11;
    })
    .unwrap();
    assert_eq!(run.len(), 35);
    for (t, x) in run.times().iter().zip(run.column("x").unwrap()) {
        assert!((x - t.cos()).abs() < 1e-9);
    }
    assert_eq!(run.last().t, 10.0);
}
