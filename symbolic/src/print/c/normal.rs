//! Normally distributed numbers in C: files without noise have no such function.

use super::Printing;
use crate::expr::{Binary, Node};
use crate::number::NORMAL_RATIOS;
use crate::print::c::c_float;

/// As `symbolic/src/number/normal.rs`; PREFIX stands for what the names of all functions begin with, RATIOS for its coefficients.
const EVALUATION: &str = "
#include <stdint.h>

/* The output function of SplitMix64. */
static uint64_t PREFIX_normal_scattered(uint64_t x) {
    x = (x ^ (x >> 30)) * UINT64_C(0xBF58476D1CE4E5B9);
    x = (x ^ (x >> 27)) * UINT64_C(0x94D049BB133111EB);
    return x ^ (x >> 31);
}

/* The nearest whole number, in two's complement; 0 for what is none. */
static uint64_t PREFIX_normal_whole(double x) {
    return fabs(x) < 9.2e18 ? (uint64_t)(int64_t)round(x) : 0;
}

/* ln x, x > 0. */
static double PREFIX_normal_ln(double x) {
    int e;
    double m = 2.0 * frexp(x, &e), series = 0.0;
    e -= 1;
    if (m > 1.4142135623730951) m *= 0.5, e += 1;
    const double s = (m - 1.0) / (m + 1.0);
    for (int k = 10; k >= 0; k--) series = series * (s * s) + 1.0 / (2 * k + 1);
    return e * 0.6931471805599453 + 2.0 * s * series;
}

/* A quotient of polynomials of degree 7: in the middle, on the flanks, in the tails. */
static double PREFIX_normal_ratio(int range, double x) {
    static const double c[3][2][8] = {RATIOS};
    double above = 0.0, below = 0.0;
    for (int k = 7; k >= 0; k--) {
        above = above * x + c[range][0][k];
        below = below * x + c[range][1][k];
    }
    return above / below;
}

/* The number of standard normal distribution of a seed and a place in the stream of a key: Wichura's AS 241 of 53 scattered bits. */
static double PREFIX_normal(double seed, double place, uint64_t key) {
    const uint64_t start = PREFIX_normal_scattered(key ^ PREFIX_normal_scattered(PREFIX_normal_whole(seed)));
    const uint64_t bits = PREFIX_normal_scattered(start + (PREFIX_normal_whole(place) + 1) * UINT64_C(0x9E3779B97F4A7C15));
    const double p = ((double)(bits >> 11) + 0.5) * 0x1p-53, q = p - 0.5;
    if (fabs(q) <= 0.425) return q * PREFIX_normal_ratio(0, 0.180625 - q * q);
    const double r = sqrt(-PREFIX_normal_ln(q < 0.0 ? p : 1.0 - p));
    const double size = r <= 5.0 ? PREFIX_normal_ratio(1, r - 1.6) : PREFIX_normal_ratio(2, r - 5.0);
    return q < 0.0 ? -size : size;
}
";

/// Names of these functions.
pub(super) fn names(prefix: &str) -> impl Iterator<Item = String> {
    let prefix = prefix.to_owned();
    ["", "_scattered", "_whole", "_ln", "_ratio"].into_iter().map(move |end| format!("{prefix}_normal{end}"))
}

impl Printing<'_> {
    /// The functions, where anything calls them.
    pub fn normal(&self) -> String {
        let graph = &self.program.model.graph;
        let is_normal = |place| matches!(graph.node(graph.id_at(place)), Node::Binary(Binary::Normal(_), ..));
        if !(0..graph.len()).any(is_normal) {
            return String::new();
        }
        let list = |numbers: &[f64; 8]| numbers.map(c_float).join(", ");
        let ratio = |ratio: &[[f64; 8]; 2]| format!("{{{{{}}}, {{{}}}}}", list(&ratio[0]), list(&ratio[1]));
        let ratios: Vec<String> = NORMAL_RATIOS.iter().map(|each| ratio(each)).collect();
        EVALUATION.replace("PREFIX", self.prefix).replace("RATIOS", &ratios.join(", "))
    }
}
