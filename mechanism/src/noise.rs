//! Held noise: values that ticks set to normally distributed numbers, which are the same bits whatever asks for them, and when.

use super::real::round;
use super::{List, Real, Text};

/// Noise that is held between ticks, or straight between them.
///
/// At tick k the value σ N(k) is set, with independent numbers N(k) of standard normal distribution: the quantile of a probability into which
/// SplitMix64 scatters the name, the seed and k.
///
/// ```
/// use dalembert::prelude::*;
/// dalembert::model!(yaml = r#"
/// name: Shaken
/// parameters: {m: 1 kg, k: 100 N/m, c: 2 N*s/m}
/// coordinates: {x: m}
/// noise: {gust: {every: 10 ms, sigma: 2 N, seed: 7}}
/// bodies: {b: {mass: m, position: "[x, 0]"}}
/// springs: {s: {stretch: x, stiffness: k, along: "[1, 0]", on: b}}
/// forces: {wind: {on: b, force: "[gust - c*x', 0]"}}
/// scene: {until: 2}
/// "#);
/// let run = Shaken::default().simulate().run()?;
/// let again = Shaken::default().simulate().run()?;
/// assert_eq!(run.last()["x"], again.last()["x"]);
/// let other = Shaken { gust_seed: 8.0, ..Shaken::default() }.simulate().run()?;
/// assert_ne!(run.last()["x"], other.last()["x"]);
/// # Ok::<(), dalembert::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noise {
    /// Its name.
    pub name: Text,
    /// The parameter that is its seed, where it is one.
    pub seed: Option<u32>,
    /// The event that sets it.
    pub event: u32,
    /// What it holds, by places among held values; its number at the last tick first.
    pub held: List<u32>,
}

/// The number of standard normal distribution at a place of the sequence of a seed, both rounded to whole numbers, in the stream of a key.
///
/// A bijection of 64 bits scatters place, seed and key (SplitMix64: Steele, Lea and Flood, *Fast splittable pseudorandom number generators*,
/// OOPSLA 2014), the upper 53 bits are a probability p in (0, 1), and the number is the quantile Φ⁻¹(p).  No number depends on another one, so that
/// a run that is split, repeated or spread over threads meets the same ones.
pub fn normal(key: u64, seed: f64, place: f64) -> f64 {
    let start = scattered(key ^ scattered(whole(seed)));
    let bits = scattered(start.wrapping_add(whole(place).wrapping_add(1).wrapping_mul(GOLDEN)));
    quantile(((bits >> 11) as f64 + 0.5) * HALF_ULP)
}

/// 2⁻⁵³.
const HALF_ULP: f64 = 0.5 * f64::EPSILON;

/// 2⁶⁴ by the golden ratio, odd: multiples of it are spread most evenly.
const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;

/// The nearest whole number, in two's complement; 0 for what is none.
fn whole(x: f64) -> u64 {
    round(x) as i64 as u64
}

/// The output function of SplitMix64.
fn scattered(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Φ⁻¹(p), 0 < p < 1, to some 10⁻¹⁶ of it: Wichura, *Algorithm AS 241*, Applied Statistics 37 (1988) 477, PPND16.
///
/// Sums, products, quotients, roots and `ln` alone, so that all machines give the same bits.
fn quantile(p: f64) -> f64 {
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        return q * ratio(&MIDDLE, 0.180_625 - q * q);
    }
    let r = Real::sqrt(-ln(if q < 0.0 { p } else { 1.0 - p }));
    let size = if r <= 5.0 { ratio(&FLANK, r - 1.6) } else { ratio(&TAIL, r - 5.0) };
    if q < 0.0 { -size } else { size }
}

/// Coefficients of the numerator and the denominator, from the power 0 up.
type Ratio = [[f64; 8]; 2];

fn ratio([above, below]: &Ratio, x: f64) -> f64 {
    let sum = |coefficients: &[f64; 8]| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
    sum(above) / sum(below)
}

/// ln x for a normal x > 0: x = 2ᵉ m with m about 1, and ln m = 2 artanh s with s = (m − 1)/(m + 1), |s| < 0.172, by its series up to s²¹.
fn ln(x: f64) -> f64 {
    const MANTISSA: u64 = (1 << 52) - 1;
    const ONE: u64 = 1.0_f64.to_bits();
    let bits = x.to_bits();
    let (mut m, mut e) = (f64::from_bits(bits & MANTISSA | ONE), (bits >> 52) as f64 - 1023.0);
    if m > core::f64::consts::SQRT_2 {
        (m, e) = (0.5 * m, e + 1.0);
    }
    let s = (m - 1.0) / (m + 1.0);
    let series = (0..=10).rev().fold(0.0, |sum, k| sum * (s * s) + 1.0 / f64::from(2 * k + 1));
    e * core::f64::consts::LN_2 + 2.0 * s * series
}

/// |p − ½| ≤ 0.425, in 0.425² − (p − ½)².
const MIDDLE: Ratio = [
    [
        3.387_132_872_796_366_5,
        133.141_667_891_784_38,
        1_971.590_950_306_551_3,
        13_731.693_765_509_46,
        45_921.953_931_549_87,
        67_265.770_927_008_7,
        33_430.575_583_588_13,
        2_509.080_928_730_122_7,
    ],
    [
        1.0,
        42.313_330_701_600_91,
        687.187_007_492_057_9,
        5_394.196_021_424_751,
        21_213.794_301_586_597,
        39_307.895_800_092_71,
        28_729.085_735_721_943,
        5_226.495_278_852_854,
    ],
];

/// Beyond, up to √(−ln p) = 5, in √(−ln p) − 1.6.
const FLANK: Ratio = [
    [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        0.241_780_725_177_450_6,
        0.022_723_844_989_269_184,
        0.000_774_545_014_278_341_4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        0.689_767_334_985_1,
        0.148_103_976_427_480_08,
        0.015_198_666_563_616_457,
        0.000_547_593_808_499_534_5,
        1.050_750_071_644_416_9e-9,
    ],
];

/// And farther out, in √(−ln p) − 5.
const TAIL: Ratio = [
    [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        0.296_560_571_828_504_87,
        0.026_532_189_526_576_124,
        0.001_242_660_947_388_078_4,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        0.599_832_206_555_888,
        0.136_929_880_922_735_8,
        0.014_875_361_290_850_615,
        0.000_786_869_131_145_613_3,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_7e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::normal;

    /// Bits by Python's floats, of the stream `gust` (FNV-1a) with the seed 7.
    #[test]
    fn numbers_are_the_same_bits_everywhere() {
        let key = 0xf3d5_8472_3ff2_578e;
        let bits = [0.0, 1.0, 2.0, 123_456_789.0].map(|k| normal(key, 7.0, k).to_bits());
        assert_eq!(bits, [0xbfb2_a1dc_2f9a_c6d0, 0xbfe5_ae22_4958_ef85, 0xbfce_ec93_028f_30b3, 0xbfcd_ca9f_82a2_04af]);
        // Of a negative seed too, and of places that a division has rounded.
        assert_eq!(normal(key, -3.0, 5.0).to_bits(), 0xbfe8_bc9f_fdec_79a4);
        assert_eq!(normal(key, 7.0, 0.29 / 0.01), normal(key, 7.0, 29.0));
        assert!([f64::NAN, f64::INFINITY, -1e300].iter().all(|x| normal(key, *x, *x).is_finite()));
    }
}
