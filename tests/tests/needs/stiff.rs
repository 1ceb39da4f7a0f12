//! Stiff coordinates held or following: predicted from the smaller model's motion beside verified.

use dalembert::needs::{Law, Needs, NeedsRequest, Prediction};

use super::{CRANE, GEARED_ROTOR, QUARTER_CAR, SPRING_PENDULUM, asked, reduction};

fn answered(request: NeedsRequest) -> Needs {
    asked(&request).unwrap_or_else(|error| panic!("{error}"))
}

/// The prediction of a held coordinate, and its change.
fn held(needs: &Needs, coordinate: &str) -> (Prediction, f64) {
    let reduction = reduction(needs, coordinate);
    let predicted =
        reduction.predicted.unwrap_or_else(|| panic!("nothing predicted of {coordinate}\n{}", needs.table()));
    (predicted, reduction.deviation.as_ref().expect("compared").largest)
}

/// A bob on a spring, otherwise as the file has it.
fn pendulum(changes: &[(&str, &str)], start: &[(&str, &str)]) -> (Prediction, f64) {
    let request = changes.iter().fold(NeedsRequest::new(SPRING_PENDULUM), |request, (name, value)| {
        request.setting(name, value).expect("a parameter")
    });
    let request =
        start.iter().fold(request, |request, (name, value)| request.starting(name, value).expect("a coordinate"));
    held(&answered(request), "coordinates.r")
}

fn is_near(predicted: f64, change: f64) {
    assert!((0.5..2.0).contains(&(predicted / change)), "{predicted} {change}");
}

#[test]
fn a_stiff_spring_gives_way_by_its_load_over_its_stiffness() {
    // The study's, of predictions that also run the pendulum again: 0.91, 0.97 and 1.00 of the change at 300, 1e3 and 1e4 N/m.
    let found = ["300 N/m", "1e3 N/m", "1e4 N/m", "1e5 N/m"].map(|k| {
        let (predicted, change) = pendulum(&[("k", k)], &[]);
        assert!(predicted.holds() && (0.9..1.05).contains(&(predicted.change / change)), "{k}: {predicted:?} {change}");
        predicted.change
    });
    // Like 1/k (stability catalogue, F1a).
    assert!((found[2] / found[3] / 10.0 - 1.0).abs() < 0.01, "{found:?}");
    // Where the spring is not three times faster than the pendulum the law breaks.
    assert!(!pendulum(&[("k", "100 N/m")], &[]).0.holds());
    // Small things in short times are the same.
    let small =
        NeedsRequest::new(SPRING_PENDULUM).setting("L", "1e-6 m").and_then(|request| request.setting("k", "1e10 N/m"));
    let (small, _) =
        held(&answered(small.and_then(|request| request.ending("0.01 s")).expect("a question")), "coordinates.r");
    assert!(small.holds() && (small.change / found[2] - 1.0).abs() < 0.01, "{small:?} {found:?}");
}

#[test]
fn a_spring_that_vibrates_says_so() {
    // A start without stretch at 1e3 N/m is no more than its load; the study's bounces and kicks are, and by their energy.
    let (slack, change) = pendulum(&[("k", "1e3 N/m")], &[("r", "1")]);
    assert!(slack.holds() && (0.9..1.1).contains(&(slack.change / change)), "{slack:?} {change}");
    let bounce = ("r", "L + m*g/k + 0.02*L");
    for k in ["353 N/m", "1e3 N/m", "1e4 N/m"] {
        let (predicted, change) = pendulum(&[("k", k), ("theta_0", "0.05")], &[bounce]);
        let Law::Stiff { vibration, .. } = predicted.law else { panic!("{predicted:?}") };
        assert!(!predicted.holds(), "{k}: {predicted:?}");
        is_near(vibration, change);
    }
    let (kick, change) = pendulum(&[("k", "1e5 N/m")], &[("r'", "9.5 m/s")]);
    let Law::Stiff { vibration, .. } = kick.law else { panic!("{kick:?}") };
    assert!(!kick.holds(), "{kick:?}");
    is_near(vibration, change);
    // Beside resonance, 2 ω_s = ω, neither is what happens.
    let (resonant, change) = pendulum(&[("k", "32.4 N/m"), ("theta_0", "0.05")], &[bounce]);
    assert!(!resonant.holds() && resonant.change < 0.2 * change, "{resonant:?} {change}");
}

#[test]
fn ropes_couplings_and_emblems_give_way_as_predicted() {
    // Without discontinuities, which have no prediction.
    let smooth = QUARTER_CAR.replace("abs(body')", "1").replace("ca: 1e-3 N*s^2/m^2", "ca: 1e-3 N*s/m");
    let rotor = GEARED_ROTOR.replace("abs(c')", "sqrt(c'^2 + 1e-6*k2/load)");
    let soft = NeedsRequest::new(CRANE).setting("k", "0.3e6 N/m").expect("a parameter");
    for (request, at_least) in
        [(NeedsRequest::new(CRANE), 2), (soft, 2), (NeedsRequest::new(rotor), 2), (NeedsRequest::new(smooth), 1)]
    {
        let needs = answered(request);
        let stiff = needs.reductions.iter().filter_map(|reduction| {
            let predicted = reduction.predicted.filter(|predicted| predicted.holds())?;
            matches!(predicted.law, Law::Stiff { .. })
                .then_some((predicted.change, reduction.deviation.as_ref()?.largest))
        });
        let stiff: Vec<(f64, f64)> = stiff.collect();
        stiff.iter().for_each(|(predicted, change)| is_near(*predicted, *change));
        assert!(stiff.len() >= at_least, "{}", needs.table());
    }
}

#[test]
fn the_table_says_where_the_law_breaks() {
    let needs = answered(NeedsRequest::new(SPRING_PENDULUM).setting("k", "100 N/m").expect("a parameter"));
    assert!(needs.table().contains("; no law: 1.66 times faster than the rest\n"), "{}", needs.table());
}

#[test]
fn a_bumper_that_is_not_met_and_an_event_that_is_recorded_leave_predictions_as_they_are() {
    let crane = |bumper: &str| {
        let buffer = format!("max(0, x - {bumper}*l0)");
        let buffer =
            format!("springs:\n  buffer: {{stretch: \"{buffer}\", stiffness: k, along: \"[1, 0]\", on: cart}}\n");
        let file = CRANE.replace("springs:\n", &buffer);
        let events = "events:\n  out: {when: th - 0.02, then: record}\n  far: {when: x - 5*l0, then: stop}\n";
        answered(NeedsRequest::new(format!("{file}{events}")))
    };
    let (plain, change) = held(&answered(NeedsRequest::new(CRANE)), "coordinates.l");
    let (beside, same) = held(&crane("3"), "coordinates.l");
    assert!(beside.holds() && (beside.change / plain.change - 1.0).abs() < 0.01 && (same / change - 1.0).abs() < 0.01);
    // Met, it has a say.
    let met = crane("0.3");
    let reductions = met.reductions.iter().filter(|reduction| reduction.ingredient == "coordinates.l");
    assert!(reductions.into_iter().all(|reduction| reduction.predicted.is_none()), "{}", met.table());
}
