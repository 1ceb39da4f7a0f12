//! Eigenvalues as a parameter changes, drawn: root loci and Campbell diagrams.

use nalgebra::Complex;

use crate::linear::short;
use crate::show::{Axis, Chart, Series, Style};

/// Real or imaginary parts that differ by less than this part of the largest eigenvalue may do so by rounding, as those of double
/// eigenvalues: no axis is scaled to them.
const ROUNDING: f64 = 1e-7;
/// Half of the width of an axis on which nothing differs, as a part of the largest eigenvalue.
const NARROW: f64 = 0.1;

/// Values of a parameter, each with all eigenvalues there; one without any makes a gap in all lines.
type Steps = [(f64, Vec<Complex<f64>>)];

/// Eigenvalues in the complex plane as a parameter goes through some values; marks where it begins and ends.
///
/// `eigenvalues` are pairs of a value and all eigenvalues there; neighbours are joined where paths go on most smoothly, and a pair
/// without eigenvalues makes a gap.  Axes are never scaled to rounding: where all real parts are the same to 1e-7 of the largest
/// eigenvalue, the axis shows that they are.
pub fn root_locus(parameter: &str, unit: &str, eigenvalues: &[(f64, Vec<Complex<f64>>)]) -> Chart {
    let all = || eigenvalues.iter().flat_map(|(_, list)| list);
    let largest = all().fold(0.0_f64, |most, x| most.max(x.norm()));
    let axis = |label, unit, of: fn(&Complex<f64>) -> f64| Axis {
        range: wide(all().map(of), largest),
        ..Axis::new(label, unit)
    };
    let title = format!("eigenvalues as {parameter} changes");
    let chart = Chart::new(title, axis("real part", "1/s", |x| x.re), axis("imaginary part", "rad/s", |x| x.im));
    let lines = paths(eigenvalues).into_iter().flat_map(|path| {
        std::iter::once(None).chain(path.into_iter().map(|(_, x)| Some((x.re, x.im)))).collect::<Vec<_>>()
    });
    let value = |value: f64| {
        format!("{parameter} = {} {}", short(value), if unit == "1" { "" } else { unit }).trim_end().to_owned()
    };
    let marks =
        |(at, list): &(f64, Vec<Complex<f64>>)| Series::marks(value(*at), list.iter().map(|x| Some((x.re, x.im))));
    let chart = chart.with(Series::line("", lines));
    eigenvalues.first().into_iter().chain(eigenvalues.last()).fold(chart, |chart, end| chart.with(marks(end)))
}

/// A Campbell diagram: frequencies, the imaginary parts of eigenvalues, over a parameter or speed, each in a colour of its own.
///
/// Lines of `orders` show excitation with this many times the speed of rotation, which the parameter must be, in rad/s: where one
/// meets a frequency, that mode is excited.  Eigenvalues are given as to [`root_locus`].
///
/// # Example
/// ```
/// use dalembert::linear::campbell;
/// use nalgebra::Complex;
/// let whirl = |w: f64| [Complex::new(0.0, (w * w + 1.0).sqrt() + w), Complex::new(0.0, (w * w + 1.0).sqrt() - w)];
/// let steps: Vec<_> = (0..50).map(|k| 0.1 * f64::from(k)).map(|w| (w, whirl(w).to_vec())).collect();
/// assert!(campbell("W", "rad/s", &steps, &[1.0]).to_svg().contains("frequency (rad/s)"));
/// ```
pub fn campbell(parameter: &str, unit: &str, eigenvalues: &[(f64, Vec<Complex<f64>>)], orders: &[f64]) -> Chart {
    let all = || eigenvalues.iter().flat_map(|(_, list)| list);
    let highest = all().fold(0.0_f64, |most, x| most.max(x.im));
    let top = if highest > 0.0 { 1.05 * highest } else { 1.0 };
    let unit = if unit == "1" { "" } else { unit };
    let y = Axis { range: Some((0.0, top)), ..Axis::new("frequency", "rad/s") };
    let mut chart = Chart::new(format!("frequencies as {parameter} changes"), Axis::new(parameter, unit), y);
    for (colour, points) in upper(eigenvalues).into_iter().enumerate() {
        chart = chart.with(Series::line("", points).coloured(colour));
    }
    let colours = chart.series.len();
    for (k, order) in orders.iter().enumerate() {
        let end = |(at, _): &(f64, Vec<Complex<f64>>)| *at;
        let ends = [eigenvalues.first(), eigenvalues.last()].map(|step| step.map_or(0.0, end));
        let line = order_line(*order, ends, top);
        let series = Series { style: Style::Dashed, ..Series::line(format!("{} {parameter}", short(*order)), line) };
        chart = chart.with(series.coloured(colours + k));
    }
    chart
}

/// ω = order · |speed| between two speeds, below the top.
fn order_line(order: f64, [from, to]: [f64; 2], top: f64) -> Vec<Option<(f64, f64)>> {
    let limit = top / order;
    let (low, high) = (from.min(to).max(-limit), from.max(to).min(limit));
    let kink = (low < 0.0 && high > 0.0).then_some(0.0);
    let speeds = [Some(low), kink, Some(high)].into_iter().flatten().filter(|_| low <= high);
    speeds.map(|speed| Some((speed, order * speed.abs()))).collect()
}

/// Frequencies over the parameter, a series for each mode; where one does not oscillate there is a gap.
fn upper(eigenvalues: &Steps) -> Vec<Vec<Option<(f64, f64)>>> {
    let point = |(value, x): (f64, Complex<f64>)| (x.im > 0.0).then_some((value, x.im));
    let all = paths(eigenvalues).into_iter().map(|path| path.into_iter().map(point).collect::<Vec<_>>());
    all.filter(|points| points.iter().any(Option::is_some)).collect()
}

/// Paths of single eigenvalues, which go on as smoothly as they can where several meet.
fn paths(eigenvalues: &Steps) -> Vec<Vec<(f64, Complex<f64>)>> {
    let mut paths: Vec<Vec<(f64, Complex<f64>)>> = Vec::new();
    let mut present = 0;
    for (value, list) in eigenvalues {
        if list.len() != present || list.is_empty() {
            present = list.len();
            paths.extend(list.iter().map(|x| vec![(*value, *x)]));
            continue;
        }
        let first = paths.len() - present;
        let expected: Vec<Complex<f64>> = paths[first..].iter().map(|path| expected(path, *value)).collect();
        for (path, next) in paths[first..].iter_mut().zip(matched(&expected, list)) {
            path.push((*value, next));
        }
    }
    paths
}

/// Where a path goes on straight to, by no more than its last step.
fn expected(path: &[(f64, Complex<f64>)], value: f64) -> Complex<f64> {
    let [.., (v0, x0), (v1, x1)] = path else { return path[path.len() - 1].1 };
    let part = (value - v1) / (v1 - v0);
    if part.is_finite() { x1 + (x1 - x0) * part.clamp(0.0, 1.0) } else { *x1 }
}

/// `next` in such an order that each stands where one of `before` is near: the nearest two belong together, then the nearest two
/// of the others.
pub(in crate::linear) fn matched(before: &[Complex<f64>], next: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let mut found = before.to_vec();
    let mut pairs: Vec<(f64, usize, usize)> = Vec::with_capacity(before.len() * next.len());
    for (i, x) in before.iter().enumerate() {
        pairs.extend(next.iter().enumerate().map(|(j, y)| ((x - y).norm(), i, j)));
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut placed, mut taken) = (vec![false; before.len()], vec![false; next.len()]);
    for (_, i, j) in pairs {
        if !placed[i] && !taken[j] {
            (placed[i], taken[j], found[i]) = (true, true, next[j]);
        }
    }
    found
}

/// A range for values that differ by no more than rounding beside the largest eigenvalue; `None` where an axis fits them.
fn wide(values: impl Iterator<Item = f64>, largest: f64) -> Option<(f64, f64)> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    let centre = 0.5 * (low + high);
    if !(largest > 0.0 && high - low <= ROUNDING * largest) {
        return None;
    }
    match centre.abs() <= ROUNDING * largest {
        true => Some((-NARROW * largest, NARROW * largest)),
        // From nought to twice the value, with room beside.
        false => Some((centre - 1.2 * centre.abs(), centre + 1.2 * centre.abs())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequencies 1 and s pass each other; coupled by e they veer.
    fn pair(e: f64) -> Vec<(f64, Vec<Complex<f64>>)> {
        let frequencies = |s: f64| {
            let half = (0.25 * (s - 1.0).powi(2) + e * e).sqrt();
            [0.5 * (1.0 + s) - half, 0.5 * (1.0 + s) + half]
        };
        let step = |k: i32| {
            let s = 0.503 + 0.01 * f64::from(k);
            (s, frequencies(s).into_iter().flat_map(|w| [Complex::new(0.0, w), Complex::new(0.0, -w)]).collect())
        };
        (0..100).map(step).collect()
    }

    #[test]
    fn frequencies_that_pass_each_other_cross_and_coupled_ones_veer() {
        for (e, crosses) in [(0.0, true), (0.05, false)] {
            let all = upper(&pair(e));
            assert_eq!(all.len(), 2);
            let ends = |path: &[Option<(f64, f64)>]| [path[0].unwrap().1, path[99].unwrap().1];
            let [low, high] = [ends(&all[0]), ends(&all[1])];
            assert_eq!(low[0] < high[0], (low[1] < high[1]) != crosses, "{e}: {low:?} {high:?}");
        }
    }

    #[test]
    fn no_axis_is_scaled_to_rounding() {
        let rounded = |re: f64, noise: f64| {
            let list = |k: i32| vec![Complex::new(re + noise * f64::from(k), 300.0), Complex::new(re, -300.0)];
            root_locus("W", "rad/s", &[(0.0, list(0)), (1.0, list(1))]).x.range
        };
        assert_eq!(rounded(0.0, 5e-14), Some((-30.0, 30.0)));
        let (low, high) = rounded(-0.05, 1e-15).unwrap();
        assert!(low > -0.2 && low < -0.05 && high > 0.0 && high < 0.1, "{low} {high}");
        assert_eq!(rounded(0.0, 1e-3), None);
    }

    #[test]
    fn lines_of_orders_end_at_the_top() {
        assert_eq!(order_line(2.0, [0.0, 100.0], 50.0), [Some((0.0, 0.0)), Some((25.0, 50.0))]);
        assert_eq!(order_line(1.0, [10.0, -10.0], 50.0), [Some((-10.0, 10.0)), Some((0.0, 0.0)), Some((10.0, 10.0))]);
        assert_eq!(order_line(10.0, [50.0, 100.0], 100.0), []);
    }
}
