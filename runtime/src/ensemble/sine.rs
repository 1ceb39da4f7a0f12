//! sin and cos of all lanes at once, without a branch.
//!
//! x is brought to |r| ≤ π/4 by x − n π/2, with π/2 in parts of 33 bits so that the products are exact; there sin and cos
//! are polynomials.  Coefficients and reduction are those of fdlibm (Sun Microsystems, 1993: `k_sin.c`, `k_cos.c`,
//! `e_rem_pio2.c`), whose errors are below one unit in the last place.

use super::Lanes;

/// Up to here n has no more than 20 bits, and its products with parts of π/2 are exact.
pub(super) const LARGEST: f64 = 1_647_099.0;

/// Adding it rounds to an integer, the even one of two.
const ROUNDS: f64 = 6_755_399_441_055_744.0;

/// π/2 in parts: 33 bits, the next 33, the rest.
const QUARTER: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

const SINE: [f64; 6] = [
    -1.666_666_666_666_663_2e-1,
    8.333_333_333_322_49e-3,
    -1.984_126_982_985_795e-4,
    2.755_731_370_707_006_8e-6,
    -2.505_076_025_340_686_3e-8,
    1.589_690_995_211_55e-10,
];

const COSINE: [f64; 6] = [
    4.166_666_666_666_66e-2,
    -1.388_888_888_887_411e-3,
    2.480_158_728_947_673e-5,
    -2.755_731_435_139_066_3e-7,
    2.087_572_321_298_175e-9,
    -1.135_964_755_778_819_5e-11,
];

/// (sin x, cos x) for |x| ≤ [`LARGEST`].
#[inline(always)]
pub(super) fn sin_cos<S: Lanes>(x: S) -> (S, S) {
    let number = S::from_f64;
    let rounded = |x: S| (x + number(ROUNDS)) - number(ROUNDS);
    let n = rounded(x * number(std::f64::consts::FRAC_2_PI));
    let nearly = x - n * number(QUARTER[0]);
    let second = n * number(QUARTER[1]);
    let closer = nearly - second;
    let rest = n * number(QUARTER[2]) - ((nearly - closer) - second);
    let r = closer - rest;
    let tail = (closer - r) - rest;

    let z = r * r;
    let cube = z * r;
    let [first, others @ ..] = SINE;
    let series = polynomial(z, others);
    let sine = r - ((z * (number(0.5) * tail - cube * series) - tail) - cube * number(first));

    let series = z * polynomial(z, COSINE);
    let half = number(0.5) * z;
    let most = number(1.0) - half;
    let cosine = most + (((number(1.0) - most) - half) + (z * series - r * tail));

    // n mod 4 says which is which, and their signs.
    let halved = |n: S| rounded(n * number(0.5) - number(0.25));
    let half = halved(n);
    let odd = n - half - half;
    let negative = half - number(2.0) * halved(half);
    let swapped = odd - number(0.5);
    let (sine, cosine) = (swapped.select_nonnegative(cosine, sine), swapped.select_nonnegative(sine, cosine));
    let sign = |negative: S| number(1.0) - number(2.0) * negative;
    (sine * sign(negative), cosine * sign(negative) * sign(odd))
}

/// Σ cₖzᵏ by Horner's rule.
#[inline(always)]
fn polynomial<S: Lanes, const K: usize>(z: S, coefficients: [f64; K]) -> S {
    let mut sum = S::from_f64(0.0);
    for coefficient in coefficients.into_iter().rev() {
        sum = S::from_f64(coefficient) + z * sum;
    }
    sum
}
