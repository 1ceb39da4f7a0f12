// Linear equations in double-double.

use dalembert_symbolic::expr::DoubleDouble;

/// What is less than this in a scaled matrix is no pivot.
const NO_PIVOT: f64 = 1e-16;

/// Gauss and Jordan's elimination of an augmented matrix, rows and columns scaled, with pivots from all of them.  Of the
/// unknowns after the first `determined` those that the equations leave open are 0.
pub fn solve(mut rows: Vec<Vec<DoubleDouble>>, determined: usize) -> Option<Vec<DoubleDouble>> {
    let n = rows.len();
    let size = |x: DoubleDouble| x.to_f64().abs();
    if rows.iter().any(|row| row.len() != n + 1) {
        return None;
    }
    let some = |scale: f64| DoubleDouble::from(if scale == 0.0 { 1.0 } else { scale });
    for row in &mut rows {
        let scale = row[..n].iter().fold(0.0_f64, |most, x| most.max(size(*x)));
        row.iter_mut().for_each(|x| *x = *x / some(scale));
    }
    let scales: Vec<f64> = (0..n).map(|j| rows.iter().fold(0.0_f64, |most, row| most.max(size(row[j])))).collect();
    for row in &mut rows {
        row.iter_mut().zip(&scales).for_each(|(x, scale)| *x = *x / some(*scale));
    }
    let right = rows.iter().fold(0.0_f64, |most, row| most.max(size(row[n])));
    let mut order: Vec<usize> = Vec::new();
    for k in 0..n {
        let free = |j: &usize| !order.contains(j);
        let places = (k..n).flat_map(|i| (0..n).filter(free).map(move |j| (i, j)));
        let (i, j) = places.max_by(|a, b| size(rows[a.0][a.1]).total_cmp(&size(rows[b.0][b.1])))?;
        if size(rows[i][j]).is_nan() {
            return None;
        }
        if size(rows[i][j]) < NO_PIVOT {
            break;
        }
        rows.swap(k, i);
        let pivot = rows[k].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            let factor = row[j] / pivot[j];
            if other != k && factor != DoubleDouble::ZERO {
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x = *x - factor * *p);
            }
        }
        order.push(j);
    }
    let open = |j: &usize| !order.contains(j);
    let leads = |k: usize| (0..n).filter(open).any(|j| size(rows[k][j]) > NO_PIVOT * size(rows[k][order[k]]));
    let undetermined = |j: usize| order.iter().position(|column| *column == j).is_none_or(leads);
    let contradicts = (order.len()..n).any(|k| size(rows[k][n]) > NO_PIVOT * right);
    if contradicts || (0..determined).any(undetermined) {
        return None;
    }
    let mut solution = vec![DoubleDouble::ZERO; n];
    for (k, j) in order.into_iter().enumerate() {
        solution[j] = rows[k][n] / rows[k][j] / some(scales[j]);
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
