//! Argument reduction of the circular functions.

use super::double_double::DoubleDouble;

/// π/2 in four parts that do not overlap.
const FRAC_PI_2: [f64; 4] =
    [std::f64::consts::FRAC_PI_2, 6.123233995736766e-17, -1.4973849048591698e-33, 5.562271104316826e-50];

/// The first 1344 bits of 2/π.
const FRAC_2_PI: [u64; 21] = [
    0xa2f9_836e_4e44_1529,
    0xfc27_57d1_f534_ddc0,
    0xdb62_9599_3c43_9041,
    0xfe51_63ab_debb_c561,
    0xb724_6e3a_424d_d2e0,
    0x0649_2eea_09d1_921c,
    0xfe1d_eb1c_b129_a73e,
    0xe882_35f5_2ebb_4484,
    0xe99c_7026_b45f_7e41,
    0x3991_d639_8353_39f4,
    0x9c84_5f8b_bdf9_283b,
    0x1ff8_97ff_de05_980f,
    0xef2f_118b_5a0a_6d1f,
    0x6d36_7ecf_27cb_09b7,
    0x4f46_3f66_9e5f_ea2d,
    0x7527_bac7_ebe5_f17b,
    0x3d07_39f7_8a52_92ea,
    0x6bfb_5fb1_1f8d_5d08,
    0x5603_3046_fc7b_6bab,
    0xf0cf_bc20_9af4_361d,
    0xa9e3_9161_5ee6_1b08,
];

/// A number modulo 4 as an integer of 320 bits, the highest word first: two bits before the point.
type Fixed = [u64; 5];

/// n mod 4 and r with x = n π/2 + r, |r| ≤ π/4 but for rounding; x must be finite.
pub(super) fn reduced(x: DoubleDouble) -> (u8, DoubleDouble) {
    let size = x.to_f64().abs();
    if size <= std::f64::consts::FRAC_PI_4 {
        return (0, x);
    }
    if size > 1e6 {
        return reduced_large(x);
    }
    let n = (x.to_f64() / FRAC_PI_2[0]).round();
    let mut r = x;
    for part in FRAC_PI_2 {
        let product = DoubleDouble::product(-n, part);
        r = r + product.to_f64() + product.rest();
    }
    (n.rem_euclid(4.0) as u8, r)
}

/// For arguments of any size (Payne and Hanek 1983): x·2/π modulo 4 needs only the bits of 2/π in a window.
fn reduced_large(x: DoubleDouble) -> (u8, DoubleDouble) {
    let turns = plus(quarter_turns(x.to_f64()), quarter_turns(x.rest()));
    // The two bits before the point, rounded.
    let n = (turns[0].wrapping_add(1 << 61) >> 62) as u8;
    let mut fraction = turns;
    for i in 0..5 {
        fraction[i] = turns[i] << 2 | turns.get(i + 1).map_or(0, |next| next >> 62);
    }
    let negative = fraction[0] >> 63 == 1;
    if negative {
        fraction = minus(fraction);
    }
    let halves = fraction.into_iter().flat_map(|word| [word >> 32, word & 0xffff_ffff]);
    let mut value = DoubleDouble::ZERO;
    for (k, half) in (1..).zip(halves) {
        value += DoubleDouble::from(half as f64).scaled(-32 * k);
    }
    let r = value * DoubleDouble::FRAC_PI_2;
    (n, if negative { -r } else { r })
}

/// x·2/π modulo 4, to 2⁻²⁶⁵.
fn quarter_turns(x: f64) -> Fixed {
    let bits = x.to_bits();
    let biased = (bits >> 52 & 0x7ff) as i64;
    let (mantissa, exponent) =
        if biased == 0 { (bits & ((1 << 52) - 1), -1074) } else { (bits & ((1 << 52) - 1) | 1 << 52, biased - 1075) };
    // x = mantissa 2^exponent; bits of 2/π before place `exponent - 1` give multiples of 4.
    let mut product: Fixed = [0; 5];
    let mut carry = 0;
    for i in (0..5).rev() {
        let word = u128::from(bits_from(exponent - 2 + 64 * i as i64)) * u128::from(mantissa) + carry;
        product[i] = word as u64;
        carry = word >> 64;
    }
    if x < 0.0 { minus(product) } else { product }
}

/// 64 bits of 2/π after the first `start`; those before the point are 0.
fn bits_from(start: i64) -> u64 {
    let word = |place: i64| usize::try_from(place).ok().and_then(|place| FRAC_2_PI.get(place)).copied().unwrap_or(0);
    let (place, shift) = (start.div_euclid(64), start.rem_euclid(64));
    if shift == 0 { word(place) } else { word(place) << shift | word(place + 1) >> (64 - shift) }
}

fn plus(a: Fixed, b: Fixed) -> Fixed {
    let mut sum = [0; 5];
    let mut carry = 0;
    for i in (0..5).rev() {
        let word = u128::from(a[i]) + u128::from(b[i]) + carry;
        sum[i] = word as u64;
        carry = word >> 64;
    }
    sum
}

fn minus(a: Fixed) -> Fixed {
    plus(a.map(|word| !word), [0, 0, 0, 0, 1])
}
