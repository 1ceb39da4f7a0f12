use super::*;

fn grid() -> Grid {
    Grid {
        knots: [vec![0.0, 0.5, 2.0, 3.0], vec![-1.0, 0.0, 1.5, 2.0, 4.0]],
        values: vec![
            vec![3.0, -1.0, 2.0, 0.0, 5.0],
            vec![1.0, 4.0, -2.0, 3.0, 0.0],
            vec![0.0, 2.0, 6.0, -1.0, 1.0],
            vec![-3.0, 1.0, 0.0, 2.0, 4.0],
        ],
    }
}

fn value(table: Table2d, x: f64, y: f64) -> f64 {
    table.at(x.into(), y.into()).to_f64()
}

fn nth(table: Table2d, [x, y]: [usize; 2]) -> Table2d {
    let by_x = (0..x).fold(table, |table, _| table.derivative(0).expect("a derivative"));
    (0..y).fold(by_x, |table, _| table.derivative(1).expect("a derivative"))
}

/// f, f_x, f_y, f_xy, f_xx, f_yy, f_xxyy inside, and beyond one end, two and three: splines by their second derivatives, in fractions of
/// Python's integers, along y first and then along x.
const SPLINE: [(f64, f64, [f64; 7]); 5] = [
    (
        0.3,
        0.7,
        [
            -0.21139842804381848,
            -2.0979750994261868,
            -3.800791132930919,
            -21.352072742231165,
            10.420641051643193,
            3.19460472702884,
            -25.58910583501006,
        ],
    ),
    (
        1.1,
        1.6,
        [
            0.25061884394366196,
            5.747769449765258,
            4.209883252582159,
            -21.20732035233624,
            5.983430309859155,
            14.046066929577465,
            -57.753484104627766,
        ],
    ),
    (
        2.5,
        -2.0,
        [-2.46378604963112, -9.467952157388778, 1.2666029510395707, 6.266074223116477, -15.375425888665326, 0.0, 0.0],
    ),
    (4.0, 6.0, [-26.147328414934048, -29.019709367315002, -16.385870780236978, -15.822061256427453, 0.0, 0.0, 0.0]),
    (
        -1.0,
        0.5,
        [-1.7963242417467769, 1.802276622699158, 30.565232506148, -27.113089649005143, 0.0, 12.891196065280573, 0.0],
    ),
];

#[test]
fn a_bicubic_spline_is_a_spline_of_splines() {
    let orders = [[0, 0], [1, 0], [0, 1], [1, 1], [2, 0], [0, 2], [2, 2]];
    let table = Table2d::new("s", &grid(), Smooth::Twice, [false; 2]);
    for (x, y, wanted) in SPLINE {
        for (order, wanted) in orders.into_iter().zip(wanted) {
            let found = value(nth(table, order), x, y);
            assert!(
                (found - wanted).abs() < 1e-14 * (40.0 + wanted.abs()),
                "{order:?} at ({x}, {y}): {found} {wanted}"
            );
        }
    }
    assert_eq!((nth(table, [1, 2]).name(), nth(table, [1, 2]).whole(), table.order()), ("s_xyy", table, [0, 0]));
    let again = Table2d::new("s", &grid(), Smooth::Twice, [false; 2]);
    assert_eq!((nth(table, [3, 0]).derivative(0), table), (None, again));
}

#[test]
fn a_table_has_its_values_and_is_as_smooth_as_it_says() {
    for smooth in [Smooth::Zero, Smooth::Once, Smooth::Twice] {
        let table = Table2d::new("t", &grid(), smooth, [false; 2]);
        let [xs, ys] = table.knots();
        for (i, x) in xs.iter().enumerate() {
            for (j, y) in ys.iter().enumerate() {
                assert!((value(table, *x, *y) - grid().values[i][j]).abs() < 1e-14, "{smooth:?} at ({x}, {y})");
            }
        }
        let order = usize::from(smooth.order());
        for by in (0..=order).flat_map(|a| (0..=order).map(move |b| [a, b])) {
            let of = nth(table, by);
            for aside in [-0.7, 0.3, 1.2, 1.9, 3.5, 5.0] {
                let along = |knot: f64, d: f64| [value(of, knot + d, aside), value(of, aside, knot + d)];
                for (knot, axis) in xs.iter().map(|x| (x, 0)).chain(ys.iter().map(|y| (y, 1))) {
                    let (before, after) = (along(*knot, -1e-13)[axis], along(*knot, 1e-13)[axis]);
                    assert!((before - after).abs() < 1e-10, "{smooth:?} {by:?} at {knot}, {aside}: {before} {after}");
                }
            }
        }
    }
}

#[test]
fn straight_between_points_is_the_bilinear_function() {
    let table = Table2d::new("b", &grid(), Smooth::Zero, [false; 2]);
    // In the cell from (0.5, 0) to (2, 1.5): a third and two thirds of its sides.
    let wanted = (4.0 * 2.0 + 2.0) / 3.0 / 3.0 + (-2.0 * 2.0 + 6.0) / 3.0 * 2.0 / 3.0;
    assert!((value(table, 1.0, 1.0) - wanted).abs() < 1e-15);
    assert_eq!((nth(table, [1, 1]).derivative(0), nth(table, [1, 1]).name()), (None, "b_xy"));
    // Straight on beyond a corner: from -3 with slopes -3 and 4, and the cell's twist.
    let twist = (1.0 - 2.0 + 0.0 - -3.0) / 1.0;
    let wanted = -3.0 - 3.0 * 0.5 - 4.0 - 0.5 * twist;
    assert!((value(table, 3.5, -2.0) - wanted).abs() < 1e-14);
}

#[test]
fn derivatives_are_exact() {
    for smooth in [Smooth::Once, Smooth::Twice] {
        let table = Table2d::new("d", &grid(), smooth, [false; 2]);
        for (x, y) in [(0.2, -0.4), (1.3, 0.9), (2.6, 3.1), (-1.0, 5.0)] {
            for by in (0..3).flat_map(|a| (0..3).map(move |b| [a, b])) {
                let (of, d) = (nth(table, by), 1e-5);
                let slope = (value(of, x + d, y) - value(of, x - d, y)) / (2.0 * d);
                let found = value(of.derivative(0).expect("a derivative"), x, y);
                assert!((found - slope).abs() < 2e-7 * (1.0 + slope.abs()), "{by:?} at ({x}, {y}): {found} {slope}");
                let slope = (value(of, x, y + d) - value(of, x, y - d)) / (2.0 * d);
                let found = value(of.derivative(1).expect("a derivative"), x, y);
                assert!((found - slope).abs() < 2e-7 * (1.0 + slope.abs()), "{by:?} at ({x}, {y}): {found} {slope}");
            }
        }
    }
}

/// Once smooth a table stays within the four values around, whatever these are, and a product of straight lines is what it is.
#[test]
fn once_smooth_it_leaves_no_cell_of_values() {
    let mut state = 1_u64;
    let mut drawn = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / f64::from(1 << 24)
    };
    for k in 0..40 {
        let rising = |step: &mut dyn FnMut() -> f64| {
            (0..5).scan(0.0, |x, _| Some(std::mem::replace(x, *x + 0.05 + step()))).collect::<Vec<f64>>()
        };
        let knots = [rising(&mut drawn), rising(&mut drawn)];
        let values: Vec<Vec<f64>> = (0..5).map(|_| (0..5).map(|_| (4.0 * drawn()).powi(3).floor()).collect()).collect();
        let table = Table2d::new(
            &format!("m{k}"),
            &Grid { knots: knots.clone(), values: values.clone() },
            Smooth::Once,
            [false; 2],
        );
        for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
            let around = [values[i][j], values[i + 1][j], values[i][j + 1], values[i + 1][j + 1]];
            let (least, largest) = around.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
            for (a, b) in (0..=8).flat_map(|a| (0..=8).map(move |b| (f64::from(a) / 8.0, f64::from(b) / 8.0))) {
                let x = knots[0][i] + a * (knots[0][i + 1] - knots[0][i]);
                let y = knots[1][j] + b * (knots[1][j + 1] - knots[1][j]);
                let found = value(table, x, y);
                assert!(least - 1e-12 <= found && found <= largest + 1e-12, "{k} ({x}, {y}): {found} {around:?}");
            }
        }
    }
    let knots = [vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 2.0, 4.0]];
    let values = knots[0].iter().map(|x| knots[1].iter().map(|y| (x + 1.0) * (2.0 - y)).collect()).collect();
    let table = Table2d::new("product", &Grid { knots, values }, Smooth::Once, [false; 2]);
    assert!((value(table, 1.3, 2.9) - 2.3 * -0.9).abs() < 1e-14 && (value(table, 5.0, -1.0) - 18.0).abs() < 1e-13);
}

#[test]
fn a_period_is_one_of_each_argument() {
    let turn = std::f64::consts::TAU;
    let angles: Vec<f64> = (0..=48).map(|k| turn * f64::from(k) / 48.0).collect();
    let f = |x: f64, y: f64| (2.0 + x.cos()) * (0.5 * y).exp();
    let ys: Vec<f64> = (0..=20).map(|k| 0.1 * f64::from(k)).collect();
    let mut values: Vec<Vec<f64>> = angles.iter().map(|x| ys.iter().map(|y| f(*x, *y)).collect()).collect();
    values[48] = values[0].clone();
    let table = Table2d::new("p", &Grid { knots: [angles, ys], values }, Smooth::Twice, [true, false]);
    for x in [0.01, 1.0, 3.0, 6.25] {
        let (once, later) = (value(table, x, 0.77), value(table, x - 3.0 * turn, 0.77));
        assert!((once - later).abs() < 1e-13 && (once - f(x, 0.77)).abs() < 1e-4, "{once} {later}");
        assert!((value(nth(table, [1, 0]), x, 0.77) + x.sin() * 0.385_f64.exp()).abs() < 1e-4);
    }
    assert_eq!(table.periods(), [Some(turn), None]);
    assert_eq!((table.along(0).period(), table.along(1).period()), (Some(turn), None));
}

#[test]
fn hostile_grids_are_no_trouble() {
    let of = |x: [f64; 2], v: f64| Grid { knots: [x.to_vec(), vec![0.0, 1.0]], values: vec![vec![v, -v], vec![-v, v]] };
    for (smooth, periodic) in [(Smooth::Zero, false), (Smooth::Once, false), (Smooth::Twice, false)] {
        let table = Table2d::new("h", &of([-1e300, 1e300], 1e300), smooth, [periodic; 2]);
        assert!(value(table, f64::NAN, 0.0).is_nan() && value(table, 0.0, f64::INFINITY).is_nan());
        Table2d::new("h", &of([0.0, 1e-300], 1e300), smooth, [periodic; 2]);
    }
    let flat = Grid { knots: [vec![0.0, 1.0], vec![0.0, 1.0]], values: vec![vec![2.0; 2]; 2] };
    for smooth in [Smooth::Zero, Smooth::Once, Smooth::Twice] {
        let table = Table2d::new("flat", &flat, smooth, [true; 2]);
        assert_eq!((value(table, 7.3, -2.2), value(nth(table, [1, 1]), 0.5, 0.5)), (2.0, 0.0));
    }
}
