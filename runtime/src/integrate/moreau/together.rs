//! All impulses of a step at once, under what rounds have found that contacts do.

use nalgebra::DMatrix;

use super::law::Problem;
use crate::matrix::solve_least;

/// A row along a contact that slides: its impulse is so many times the limit.
struct Sliding {
    row: usize,
    part: f64,
    side: usize,
}

impl Problem {
    /// The impulses nearest to these with which what presses, sticks and slides as it does with them goes on to do so; `None` where there are none.
    ///
    /// Rounds find soon what contacts do, and how hard they press only in as many rounds as there are layers squared, or never, where contacts that
    /// hold each other share their forces in many ways: of these shares the nearest is as good as any.
    pub(super) fn together(&self, impulses: &[f64], rates: &[f64], scale: f64) -> Option<Vec<f64>> {
        let (mut held, mut sliding): (Vec<(usize, f64)>, Vec<Sliding>) = (Vec::new(), Vec::new());
        for (place, side) in self.sides.iter().enumerate() {
            if let Some(row) = side.normal {
                if impulses[row] <= 0.0 || self.own[row] == 0.0 {
                    continue;
                }
                held.push((row, self.least(side, row)));
            }
            let (wanted, allowed) = self.along_wanted(side, scale, impulses, rates);
            let size = wanted[0].hypot(wanted[1]);
            for (k, row) in side.tangents().enumerate().filter(|(_, row)| self.own[*row] > 0.0) {
                match allowed == wanted {
                    true => held.push((row, 0.0)),
                    false => sliding.push(Sliding { row, part: wanted[k] / size, side: place }),
                }
            }
        }
        let mut base = impulses.to_vec();
        for Sliding { row, part, side } in &sliding {
            base[*row] = part * self.sides[*side].sliding.at(impulses).max(0.0);
        }
        let offset = self.rates(&base);
        let column = |row: usize| {
            let mut column = vec![0.0; impulses.len()];
            column[row] = 1.0;
            for Sliding { row: rubbed, part, side } in &sliding {
                let of_row = self.sides[*side].sliding.of_rows.iter().filter(|(other, _)| *other == row);
                column[*rubbed] += of_row.map(|(_, factor)| part * factor).sum::<f64>();
            }
            column
        };
        let columns: Vec<Vec<f64>> = held.iter().map(|(row, _)| column(*row)).collect();
        let effects: Vec<Vec<f64>> = columns.iter().map(|column| self.effects(column)).collect();
        let matrix = DMatrix::from_fn(held.len(), held.len(), |i, j| effects[j][held[i].0]);
        let right = DMatrix::from_fn(held.len(), 1, |i, _| held[i].1 - offset[held[i].0]);
        let changes = solve_least(&matrix, &right)?;
        for (column, change) in columns.iter().zip(&changes) {
            base.iter_mut().zip(column).for_each(|(base, part)| *base += change * part);
        }
        base.iter().all(|impulse| impulse.is_finite()).then_some(base)
    }
}
