//! The certifier against functions whose zeros are known.

use std::f64::consts::{PI, TAU};

use super::certify::{Certifier, PHASE, Sample, Zero, ZeroKind};
use super::draws::Draws;

/// What a function does in [0, 1], begun in so many pieces.
fn marks(f: impl Fn(f64) -> (f64, f64), pieces: usize) -> (Vec<Zero>, u64) {
    let mut certifier = Certifier::default();
    let grid: Vec<Sample> = (0..=pieces)
        .map(|k| {
            let x = k as f64 / pieces as f64;
            let (value, slope) = f(x);
            Sample { x, value, slope }
        })
        .collect();
    certifier.certify(&mut |x| f(x), &grid).unwrap();
    (certifier.marks, certifier.samples)
}

fn crossings(marks: &[Zero]) -> usize {
    marks.iter().filter(|mark| matches!(mark.kind, ZeroKind::Crosses { .. })).count()
}

#[test]
fn no_turn_of_a_cosine_is_lost_with_phases() {
    // cos(ωx + φ) = c has a zero wherever ωx + φ = ±acos c + 2πk.
    let mut draws = Draws::new(1);
    for _ in 0..3000 {
        let omega = TAU * 400.0_f64.powf(draws.between(0.0, 1.0));
        let (phi, c) = (draws.between(0.0, TAU), draws.between(-0.999, 0.999));
        let f = |x: f64| ((omega * x + phi).cos() - c, -omega * (omega * x + phi).sin());
        let pieces = (omega / PHASE).ceil() as usize;
        let places = |base: f64| {
            let first = ((phi - base) / TAU).ceil() as i64;
            let last = ((omega + phi - base) / TAU).floor() as i64;
            (last - first + 1).max(0) as usize
        };
        let expected = places(c.acos()) + places(-c.acos());
        let (marks, _) = marks(f, pieces);
        assert_eq!(crossings(&marks), expected, "omega {omega} phi {phi} c {c}");
    }
}

#[test]
fn pairs_of_zeros_are_found_down_to_what_rounding_tells() {
    let mut draws = Draws::new(2);
    for power in 1..=8 {
        let s = 10.0_f64.powi(-power);
        for kind in 0..4 {
            for _ in 0..100 {
                let a = draws.between(0.1, 0.9 - s);
                let side = if draws.between(0.0, 1.0) < 0.5 { 1.0 } else { -1.0 };
                let middle = a + 0.5 * s;
                let f = |x: f64| {
                    let d = x - middle;
                    let (g, slope) = match kind {
                        0 => (d * d - 0.25 * s * s, 2.0 * d),
                        1 => ((0.5 * s).cos() - d.cos(), d.sin()),
                        2 => {
                            let (e, g) = (d.exp(), d * d - 0.25 * s * s);
                            (e * g, e * (g + 2.0 * d))
                        }
                        _ => {
                            let (g, w) = (d * d - 0.25 * s * s, 1.0 + d * d * d * d);
                            (g * w, 2.0 * d * w + g * 4.0 * d * d * d)
                        }
                    };
                    (side * g, side * slope)
                };
                let (marks, samples) = marks(f, 1);
                if power <= 6 {
                    assert_eq!(crossings(&marks), 2, "{s:e} kind {kind} at {a}: {marks:?}");
                } else {
                    let touch = marks.len() == 1 && marks[0].kind == ZeroKind::Touches;
                    assert!(touch || crossings(&marks) == 2, "{s:e} kind {kind} at {a}: {marks:?}");
                }
                assert!(samples < 140, "{samples}");
            }
        }
    }
}

#[test]
fn an_exact_tangency_is_a_touch() {
    let mut draws = Draws::new(3);
    let mut total = 0;
    for _ in 0..2000 {
        let (a, c) = (draws.between(0.0, 1.0), draws.between(-2.0, 2.0));
        let (marks, samples) = marks(|x| (c * (x - a) * (x - a), 2.0 * c * (x - a)), 1);
        assert_eq!(marks.len(), 1, "{a} {marks:?}");
        assert_eq!(marks[0].kind, ZeroKind::Touches);
        assert!((marks[0].x - a).abs() < 1e-7);
        total += samples;
    }
    assert!(total < 2000 * 8, "{total}");
}

#[test]
fn functions_that_stay_away_from_zero_cost_one_sample() {
    let mut draws = Draws::new(4);
    for _ in 0..500 {
        let (a, b) = (draws.between(-1.0, 1.0), draws.between(0.2, 2.0));
        let (marks, samples) = marks(|x| ((a * x).sin() + 3.0 + b * x, a * (a * x).cos() + b), 1);
        assert!(marks.is_empty() && samples == 1, "{samples}");
    }
}

#[test]
fn poles_jumps_and_edges_are_no_crossings() {
    let mut draws = Draws::new(5);
    for _ in 0..300 {
        let a = draws.between(0.05, 0.95);
        let (pole, _) = marks(|x| (1.0 / (x - a), -1.0 / (x - a).powi(2)), 1);
        assert!(
            !pole.is_empty()
                && pole.iter().all(|m| matches!(m.kind, ZeroKind::Pole | ZeroKind::Jumps | ZeroKind::Undefined)),
            "{pole:?}"
        );
        let (jump, samples) = marks(|x| (if x < a { -1.0 } else { 1.0 }, 0.0), 1);
        assert_eq!(jump.len(), 1);
        assert_eq!(jump[0].kind, ZeroKind::Jumps);
        assert!((jump[0].x - a).abs() < 1e-15 && samples < 90, "{samples}");
        // √(x − a) − ¼ √(1 − a): not defined before a, zero once after it.
        let level = 0.25 * (1.0 - a).sqrt();
        let (edge, _) = marks(|x| ((x - a).sqrt() - level, 0.5 / (x - a).sqrt()), 1);
        assert_eq!(crossings(&edge), 1, "{edge:?}");
        assert!(edge.iter().all(|mark| matches!(mark.kind, ZeroKind::Crosses { rising: true } | ZeroKind::Undefined)));
    }
}

#[test]
fn kinks_are_seen_through() {
    let mut draws = Draws::new(6);
    for _ in 0..300 {
        let (a, d) = (draws.between(0.2, 0.8), draws.between(1e-6, 0.1));
        let (marks, samples) = marks(|x| ((x - a).abs() - d, (x - a).signum()), 1);
        assert_eq!(crossings(&marks), 2, "{a} {d} {marks:?}");
        assert!(samples < 300, "{samples}");
    }
    let (marks, _) = marks(|x| ((x - 0.37).abs(), (x - 0.37).signum()), 1);
    assert!(marks.iter().all(|mark| mark.kind == ZeroKind::Touches), "{marks:?}");
}

#[test]
fn zero_and_noise_end() {
    assert!(marks(|_| (0.0, 0.0), 1).0.is_empty());
    let (_, samples) = marks(|x| ((x * 1e15).sin() * 1e-17, 0.0), 1);
    assert!(samples < 50_000, "{samples}");
    // The terms of (x − 1)³ cancel: noise around its zero, which is one.
    let cube = |x: f64| {
        let y = x + 0.6;
        (y * y * y - 3.0 * y * y + 3.0 * y - 1.0, 3.0 * (y - 1.0).powi(2))
    };
    let (marks, samples) = marks(cube, 1);
    assert!(marks.iter().any(|m| (m.x - 0.4).abs() < 1e-4) && samples < 20_000, "{samples} {marks:?}");
}

#[test]
fn too_fast_an_oscillation_is_said() {
    let mut certifier = Certifier::default();
    let mut f = |x: f64| ((1e6 * PI * x).sin(), 1e6 * PI * (1e6 * PI * x).cos());
    let grid: Vec<Sample> = [0.0, 1.0].map(|x| Sample { x, value: f(x).0 + 0.1, slope: f(x).1 }).to_vec();
    assert!(certifier.certify(&mut f, &grid).is_err());
}

/// Slopes that are a little off, as those of a step whose speeds are not the rates of its places: near an extremum no piece
/// agrees with them, however short.
#[test]
fn slopes_that_are_not_the_functions_do_not_keep_it_from_ending() {
    for off in [1e-2, 1e-4, 1e-7] {
        let f = |x: f64| (18.0 + 1e-3 * (x - 0.4).powi(2), 2e-3 * (x - 0.4) + 1e-3 * off);
        let ends = [0.0, 1.0].map(|x| Sample { x, value: f(x).0, slope: f(x).1 });
        let mut certifier = Certifier::default();
        certifier.extrema = true;
        certifier.certify(&mut |x| f(x), &ends).unwrap();
        assert!(certifier.samples < 200 && certifier.marks.is_empty(), "{off}: {}", certifier.samples);
        assert!(certifier.points().iter().any(|point| (point.x - 0.4).abs() < 0.05), "{off}");
    }
}

/// −(sin((x − p)² − e)/w)²: at rest at p, between two tops at p ± √e as narrow as w.
#[test]
fn of_tops_beside_a_turning_point_none_is_lost() {
    const W: f64 = 1e-5;
    let mut draws = Draws::new(7);
    let mut lost = Vec::new();
    for _ in 0..20_000 {
        let (p, e) = (draws.between(-0.1, 0.3), 10_f64.powf(draws.between(-3.0, -0.5)));
        let f = |x: f64| {
            let inner = (x - p).powi(2) - e;
            (-(inner.sin() / W).powi(2), -(2.0 * inner).sin() * 2.0 * (x - p) / W.powi(2))
        };
        let ends = [0.0, 1.0].map(|x| Sample { x, value: f(x).0, slope: f(x).1 });
        let mut certifier = Certifier::default();
        (certifier.extrema, certifier.fine) = (true, 10.0);
        certifier.certify(&mut |x| f(x), &ends).unwrap();
        for top in [p - e.sqrt(), p + e.sqrt()].into_iter().filter(|top| (1e-6..1.0 - 1e-6).contains(top)) {
            let met = |point: &Sample| (point.x - top).abs() < 1e-3 * W / e.sqrt() && point.value > -1.0;
            if !certifier.points().iter().any(met) {
                lost.push((p, e));
            }
        }
        let mut pairs = certifier.points().windows(2);
        assert!(pairs.all(|pair| pair[0].x < pair[1].x), "{p}, {e}");
        assert!(certifier.samples < 1000, "{}", certifier.samples);
    }
    assert!(lost.is_empty(), "{} lost, of them {:?}", lost.len(), &lost[..lost.len().min(5)]);
}
