//! Double-doubles against numbers of 400 bits (astro-float) at random arguments of all sizes.

use std::cell::RefCell;

use astro_float::{BigFloat, Consts, RoundingMode};

use super::DoubleDouble;
use crate::random::Random;

const BITS: usize = 400;
const ROUND: RoundingMode = RoundingMode::ToEven;

thread_local! {
    static CONSTANTS: RefCell<Consts> = RefCell::new(Consts::new().expect("a cache of constants"));
}

type Exact = fn(&BigFloat, usize, RoundingMode, &mut Consts) -> BigFloat;
type Ours = fn(DoubleDouble) -> DoubleDouble;
/// A function with its namesake of `f64`.
type Namesake = (&'static str, Ours, fn(f64) -> f64);

/// The functions, and the largest argument at which they are tried.
const FUNCTIONS: [(&str, Ours, Exact, f64); 13] = [
    ("sin", DoubleDouble::sin, BigFloat::sin, 1e300),
    ("cos", DoubleDouble::cos, BigFloat::cos, 1e300),
    ("tan", DoubleDouble::tan, BigFloat::tan, 1e300),
    ("asin", DoubleDouble::asin, BigFloat::asin, 1.0),
    ("acos", DoubleDouble::acos, BigFloat::acos, 1.0),
    ("atan", DoubleDouble::atan, BigFloat::atan, 1e300),
    ("sinh", DoubleDouble::sinh, BigFloat::sinh, 650.0),
    ("cosh", DoubleDouble::cosh, BigFloat::cosh, 650.0),
    ("tanh", DoubleDouble::tanh, BigFloat::tanh, 1e300),
    ("exp", DoubleDouble::exp, BigFloat::exp, 650.0),
    ("exp_m1", DoubleDouble::exp_m1, exp_m1, 650.0),
    ("ln", DoubleDouble::ln, BigFloat::ln, 1e300),
    ("sqrt", DoubleDouble::sqrt, |x, p, round, _| x.sqrt(p, round), 1e300),
];

fn exp_m1(x: &BigFloat, p: usize, round: RoundingMode, constants: &mut Consts) -> BigFloat {
    // The digits that the subtraction takes are added before.
    x.exp(p + 1200, round, constants).sub(&BigFloat::from_f64(1.0, p), p, round)
}

fn big(x: DoubleDouble) -> BigFloat {
    BigFloat::from_f64(x.to_f64(), BITS).add(&BigFloat::from_f64(x.rest(), BITS), BITS, ROUND)
}

/// The number to 60 bits.
fn small(x: &BigFloat) -> f64 {
    let (Some(digits), Some(exponent)) = (x.mantissa_digits(), x.exponent()) else { return f64::NAN };
    let top = digits.last().map_or(0.0, |word| *word as f64 / 2_f64.powi(64));
    // The exponent may be that of a number below the smallest `f64`.
    let size = top * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2);
    if x.is_negative() { -size } else { size }
}

fn error(found: DoubleDouble, exact: &BigFloat) -> f64 {
    assert!(found.is_finite(), "{found:?} for {}", small(exact));
    small(&big(found).sub(exact, BITS, ROUND)).abs()
}

/// A number of random size, with digits in both halves.
fn drawn(random: &mut Random, powers: [f64; 2]) -> DoubleDouble {
    let size = 10_f64.powf(random.between(powers[0], powers[1]));
    let hi = if random.between(0.0, 1.0) < 0.5 { size } else { -size };
    DoubleDouble::sum(hi, hi * random.between(-1e-16, 1e-16))
}

/// Where functions are hard: zeros and poles of the circular ones, 1, arguments next to them, whole numbers.
fn hard() -> Vec<DoubleDouble> {
    let mut list = Vec::new();
    let nudges = [0.0, 1e-32, -1e-25, 1e-17, -1e-9, 1e-3];
    for k in [1.0, 2.0, 3.0, 7.0, 355.0 / 113.0, 1e3, 1e5, 636_620.0, 1e7, 2_f64.powi(40)] {
        for nudge in nudges {
            for base in [DoubleDouble::FRAC_PI_2 * k, DoubleDouble::FRAC_PI_2 * (k / 2.0), k.into(), (1.0 / k).into()] {
                list.extend([base + nudge, -(base + nudge)]);
            }
        }
    }
    // The double nearest to a multiple of π/2 (Muller 2016, table 11.1).
    list.push(6_381_956_970_095_103_f64.into());
    list.push((6_381_956_970_095_103.0 * 2_f64.powi(797)).into());
    list
}

#[test]
fn functions_are_right_to_30_digits_beside_their_zeros_too() {
    let mut random = Random::new();
    let mut report = String::new();
    for (name, ours, exact, largest) in FUNCTIONS {
        let mut arguments = hard();
        for _ in 0..300 {
            arguments.push(drawn(&mut random, [-280.0, f64::log10(largest)]));
            arguments.push(drawn(&mut random, [-3.0, f64::log10(largest).min(3.0)]));
        }
        let mut worst = 0.0_f64;
        for x in arguments {
            let x = if matches!(name, "ln" | "sqrt") { x.abs() } else { x };
            // The domain, and what a double-double holds of e^x.
            if x.abs() > DoubleDouble::from(largest) {
                continue;
            }
            let value = CONSTANTS.with_borrow_mut(|constants| exact(&big(x), BITS, ROUND, constants));
            let size = small(&value).abs();
            if size < 1e-285 {
                continue;
            }
            let off = error(ours(x), &value);
            worst = worst.max(off / size);
            assert!(off <= 1e-30 * size, "{name}({x:?}) is off by {off:e}, value {size:e}");
        }
        report += &format!("{name} {worst:.1e}\n");
    }
    println!("{report}");
}

#[test]
fn sums_products_and_quotients_are_right_to_their_own_digits() {
    let mut random = Random::new();
    let mut worst = [0.0_f64; 4];
    for k in 0..3000 {
        let powers = if k % 2 == 0 { [-1.0, 1.0] } else { [-140.0, 140.0] };
        let (x, y) = (drawn(&mut random, powers), drawn(&mut random, powers));
        // Every third sum cancels but for some digits.
        let y = if k % 3 == 0 { -x + x * 10_f64.powf(random.between(-30.0, 0.0)) } else { y };
        if y == DoubleDouble::ZERO {
            continue;
        }
        let (a, b) = (big(x), big(y));
        let results = [
            (x + y, a.add(&b, BITS, ROUND)),
            (x - y, a.sub(&b, BITS, ROUND)),
            (x * y, a.mul(&b, BITS, ROUND)),
            (x / y, a.div(&b, BITS, ROUND)),
        ];
        for ((found, exact), worst) in results.into_iter().zip(&mut worst) {
            let size = small(&exact).abs();
            if size > 0.0 {
                *worst = worst.max(error(found, &exact) / size);
            }
        }
    }
    println!("+ - * /: {worst:?}");
    assert!(worst.iter().all(|w| *w < 2e-31), "{worst:?}");
}

#[test]
fn powers_and_angles_of_points_are_right_to_28_digits() {
    let mut random = Random::new();
    let mut worst = [0.0_f64; 2];
    for k in 0..600 {
        let wide = if k % 2 == 0 { 1.0 } else { 100.0 };
        let (x, y) = (drawn(&mut random, [-wide, wide]), drawn(&mut random, [-wide, wide]));
        let angle = y.atan2(x);
        // tan(angle/2) = y/(√(x² + y²) + x) is judged by its argument: the reference has no atan2.
        let (a, b) = (big(x), big(y));
        let norm = a.mul(&a, BITS, ROUND).add(&b.mul(&b, BITS, ROUND), BITS, ROUND).sqrt(BITS, ROUND);
        let half = if x.to_f64() > 0.0 {
            b.div(&norm.add(&a, BITS, ROUND), BITS, ROUND)
        } else {
            norm.sub(&a, BITS, ROUND).div(&b, BITS, ROUND)
        };
        let exact = CONSTANTS.with_borrow_mut(|constants| half.atan(BITS, ROUND, constants));
        let exact = exact.mul(&BigFloat::from_f64(2.0, BITS), BITS, ROUND);
        worst[0] = worst[0].max(error(angle, &exact) / small(&exact).abs());

        let exponent = drawn(&mut random, [-2.0, 0.3]);
        let power = x.abs().pow(exponent);
        let exact = CONSTANTS.with_borrow_mut(|constants| big(x.abs()).pow(&big(exponent), BITS, ROUND, constants));
        worst[1] = worst[1].max(error(power, &exact) / small(&exact).abs());
    }
    println!("atan2, pow: {worst:?}");
    assert!(worst[0] < 1e-30 && worst[1] < 1e-28, "{worst:?}");
}

#[test]
fn infinities_zeros_and_what_does_not_exist_are_those_of_f64() {
    let special = [0.0, -0.0, 1.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e308, -1e308, 5e-324, 2.0];
    let same = |found: DoubleDouble, wanted: f64, what: &str| {
        let found = found.to_f64();
        let near = (found - wanted).abs() <= 1e-15 * wanted.abs();
        let equal = found.to_bits() == wanted.to_bits() || found.is_nan() && wanted.is_nan();
        assert!(equal || near && wanted != 0.0, "{what}: {found:e}, not {wanted:e}");
    };
    let functions: [Namesake; 14] = [
        ("sin", DoubleDouble::sin, f64::sin),
        ("cos", DoubleDouble::cos, f64::cos),
        ("tan", DoubleDouble::tan, f64::tan),
        ("asin", DoubleDouble::asin, f64::asin),
        ("acos", DoubleDouble::acos, f64::acos),
        ("atan", DoubleDouble::atan, f64::atan),
        ("sinh", DoubleDouble::sinh, f64::sinh),
        ("cosh", DoubleDouble::cosh, f64::cosh),
        ("tanh", DoubleDouble::tanh, f64::tanh),
        ("exp", DoubleDouble::exp, f64::exp),
        ("exp_m1", DoubleDouble::exp_m1, f64::exp_m1),
        ("ln", DoubleDouble::ln, f64::ln),
        ("sqrt", DoubleDouble::sqrt, f64::sqrt),
        ("abs", DoubleDouble::abs, f64::abs),
    ];
    for x in special {
        for (name, ours, theirs) in functions {
            same(ours(x.into()), theirs(x), &format!("{name}({x:e})"));
        }
        for y in special {
            let (a, b) = (DoubleDouble::from(x), DoubleDouble::from(y));
            let of = |sign: &str| format!("{x:e} {sign} {y:e}");
            same(a + b, x + y, &of("+"));
            same(a - b, x - y, &of("-"));
            same(a * b, x * y, &of("*"));
            same(a / b, x / y, &of("/"));
            same(a.atan2(b), x.atan2(y), &of("atan2"));
            same(a.pow(b), x.powf(y), &of("pow"));
            // Of a NaN and a number `f64` gives the number.
            let nan = x.is_nan() || y.is_nan();
            let (least, most) = if nan { (f64::NAN, f64::NAN) } else { (x.min(y), x.max(y)) };
            let is = |found: DoubleDouble, value: f64| found.to_f64() == value || found.is_nan() && value.is_nan();
            assert!(is(a.min(b), least), "{}", of("min"));
            assert!(is(a.max(b), most), "{}", of("max"));
        }
    }
}
