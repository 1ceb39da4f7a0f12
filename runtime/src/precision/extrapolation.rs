//! Motions in double-double, by extrapolated midpoint steps.

use dalembert_symbolic::expr::DoubleDouble;

use super::DoubleOnly;
use crate::simulate::Interruption;

/// f of y' = f(t, y), written into the last argument.
pub(super) type Rates<'a> = &'a dyn Fn(DoubleDouble, &[DoubleDouble], &mut [DoubleDouble]) -> Result<(), DoubleOnly>;

/// y' = f(t, y) by the method of Gragg, Bulirsch and Stoer.
///
/// A step h is done in n = 2, 4, 6, … (or 2, 6, 10, …) steps of the midpoint rule, whose error is a series in (h/n)²; each row of
/// the extrapolation to n = ∞ takes one more term of it away.  The step is done when a row's last two values agree, and the next
/// one is as long as so many rows suffice for.  Increments are summed and extrapolated, so that they are rounded in proportion to
/// themselves.
///
/// Source: Hairer, Nørsett, Wanner (1993), Solving Ordinary Differential Equations I, section II.9.
pub(super) struct Extrapolation<'a> {
    /// f.
    pub rates: Rates<'a>,
    /// What errors of each component are measured by.
    pub scales: &'a [f64],
    /// Its steps.
    pub scheme: Scheme,
    /// The most evaluations of f.
    pub most: u64,
    /// What ends it early from outside.
    pub interruption: &'a Interruption,
}

/// What an extrapolation does in a step.
#[derive(Clone, Copy)]
pub(crate) struct Scheme {
    /// The most rows; the order is twice as many.
    pub rows: usize,
    /// By how much n rises from row to row, an even number.
    pub rise: usize,
    /// The largest error of a step.
    pub tolerance: f64,
}

/// Fewer rows may agree by chance.
const LEAST_ROWS: usize = 3;

impl Extrapolation<'_> {
    /// y at these times, the first of which is the start's.
    ///
    /// # Errors
    /// f cannot be evaluated, or there would be too many evaluations; [`DoubleOnly::Interrupted`].
    pub fn through(
        &self,
        start: Vec<DoubleDouble>,
        times: &[DoubleDouble],
    ) -> Result<Vec<Vec<DoubleDouble>>, DoubleOnly> {
        let mut found = vec![start];
        let (mut longest, mut evaluations) = (f64::INFINITY, 0);
        for span in times.windows(2) {
            let mut y = found[found.len() - 1].clone();
            let (mut t, end) = (span[0], span[1]);
            while t < end {
                if self.interruption.is_asked() {
                    return Err(DoubleOnly::Interrupted);
                }
                let count = ((end - t).to_f64() / longest).ceil().max(1.0);
                let h = (end - t) / count.into();
                let done = self.step(t, h, &y, &mut evaluations)?;
                let growth = match done.as_ref().map(|(_, rows)| self.scheme.rows - rows) {
                    None => 0.5,
                    Some(0) => 0.8,
                    Some(1) => 1.0,
                    Some(2) => 1.25,
                    Some(_) => 2.0,
                };
                longest = growth * h.to_f64();
                if let Some((increment, _)) = done {
                    y.iter_mut().zip(increment).for_each(|(y, z)| *y += z);
                    t = if count == 1.0 { end } else { t + h };
                }
            }
            found.push(y);
        }
        Ok(found)
    }

    /// y(t + h) − y(t), and how many rows it took; `None`: more than there are.
    fn step(
        &self,
        t: DoubleDouble,
        h: DoubleDouble,
        y: &[DoubleDouble],
        evaluations: &mut u64,
    ) -> Result<Option<(Vec<DoubleDouble>, usize)>, DoubleOnly> {
        let mut first = vec![DoubleDouble::ZERO; y.len()];
        (self.rates)(t, y, &mut first)?;
        let mut above: Vec<Vec<DoubleDouble>> = Vec::new();
        for j in 1..=self.scheme.rows {
            let n = |row: usize| 2 + self.scheme.rise * (row - 1);
            *evaluations += n(j) as u64;
            if *evaluations > self.most {
                return Err(DoubleOnly::TooLong { evaluations: self.most });
            }
            let mut row = vec![self.midpoint((t, h), n(j), y, &first)?];
            for (k, before) in above.iter().enumerate() {
                // 1/((n_j/n_i)² − 1) with i = j − k − 1.
                let (own, other) = (n(j) as f64, n(j - k - 1) as f64);
                let factor = DoubleDouble::from(other * other) / ((own - other) * (own + other)).into();
                row.push(row[k].iter().zip(before).map(|(own, before)| *own + (*own - *before) * factor).collect());
            }
            if j >= LEAST_ROWS && self.agree(&row[j - 1], &row[j - 2]) {
                return Ok(row.pop().map(|increment| (increment, j)));
            }
            above = row;
        }
        Ok(None)
    }

    /// The increment over a step in n of the midpoint rule.
    fn midpoint(
        &self,
        (t, h): (DoubleDouble, DoubleDouble),
        n: usize,
        y: &[DoubleDouble],
        first: &[DoubleDouble],
    ) -> Result<Vec<DoubleDouble>, DoubleOnly> {
        let part = h / (n as f64).into();
        let mut before = vec![DoubleDouble::ZERO; y.len()];
        let mut here: Vec<DoubleDouble> = first.iter().map(|rate| part * *rate).collect();
        let (mut place, mut rate) = (y.to_vec(), first.to_vec());
        for i in 1..n {
            place.iter_mut().zip(y).zip(&here).for_each(|((place, y), z)| *place = *y + *z);
            (self.rates)(t + part * i as f64, &place, &mut rate)?;
            before.iter_mut().zip(&rate).for_each(|(before, rate)| *before += part * *rate * 2.0);
            std::mem::swap(&mut before, &mut here);
        }
        Ok(here)
    }

    fn agree(&self, one: &[DoubleDouble], other: &[DoubleDouble]) -> bool {
        let differences = one.iter().zip(other).map(|(one, other)| (*one - *other).to_f64().abs());
        differences.zip(self.scales).all(|(difference, scale)| difference <= self.scheme.tolerance * scale)
    }
}
