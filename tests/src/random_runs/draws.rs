//! Random numbers that are the same in every build.

/// SplitMix64 (Steele, Lea, Flood 2014); every run has a sequence of its own.
pub struct Draws(u64);

impl Draws {
    /// The sequence of a run.
    pub fn new(run: u64) -> Self {
        Draws(run.wrapping_mul(0xd134_2543_de82_ef95) ^ 0x9e37_79b9_7f4a_7c15)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number between two others, of six digits as it will stand in a file.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        neat(low + (high - low) * unit)
    }

    /// A positive number whose logarithm is uniform.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        neat(self.between(low.ln(), high.ln()).exp())
    }

    /// 1 or −1.
    pub fn sign(&mut self) -> f64 {
        if self.chance(0.5) { 1.0 } else { -1.0 }
    }

    /// True with this probability.
    pub fn chance(&mut self, probability: f64) -> bool {
        self.between(0.0, 1.0) < probability
    }

    /// One of a list.
    pub fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        let index = self.next() % list.len() as u64;
        &list[index as usize]
    }
}

/// Rounded to six digits.
pub fn neat(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// As it stands in an expression.
pub fn text(value: f64) -> String {
    let value = neat(value);
    if value < 0.0 { format!("({value:e})") } else { format!("{value:e}") }
}
