//! Stability of a motion that repeats over two parameters.

use super::begun::Begun;
use super::family::{OrbitChange, sampled};
use super::found::Multiplier;
use super::laps::{Point, lcm};
use super::multipliers::Polar;
use super::search::OrbitSearch;
use super::thresholds::SAME;
use crate::error::Error;
use crate::events::{Around, locate};
use crate::vary::TOLD;

/// Between columns motions are looked at until a row has so many steps at least, as a family has.
const STEPS: f64 = 20.0;
/// And until straight pieces of what tells of boundaries are off by less than this part of its largest value on the row,
const STRAIGHT: f64 = 0.05;
/// with so many halvings at most.
const HALVINGS: u32 = 6;
/// Those whose functions do not jump.
const SEPARATE: [OrbitChange; 2] = [OrbitChange::Branch, OrbitChange::Doubling];
/// Between three values of which the middle one is least in size, a parabola through them that does not come down to this part of the middle
/// one reaches no zero.
const REACHES: f64 = 0.5;
/// The least value is looked for in so many thirds of what is left: a bracket of one part in 10⁵, within which windows are not told apart.
const THIRDS: usize = 28;

/// How a motion that repeats, and its stability, depend on two parameters.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StabilityMap {
    /// The parameters: across, and up.
    pub names: [String; 2],
    /// Their values.
    pub values: [Vec<f64>; 2],
    /// ln |μ| of the largest multiplier of the whole period, row by row, NaN where no motion was found; at most 0 where it is stable.
    pub growth: Vec<f64>,
    /// Where a multiplier crosses the unit circle.
    pub boundaries: Vec<Boundary>,
    /// Whether it was broken off from outside, after these rows.
    pub interrupted: bool,
}

/// A curve on which a multiplier crosses the unit circle.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Boundary {
    /// What happens there.
    pub kind: OrbitChange,
    /// A point for each row that the curve meets, from the first on.
    pub points: Vec<BoundaryPoint>,
}

/// A point of a boundary.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct BoundaryPoint {
    /// The parameter across, as it was found.
    pub x: f64,
    /// The parameter up, which is that of a row.
    pub y: f64,
    /// Of x: what more accurate flows make of it.
    pub error: f64,
}

/// A motion of a row, at a value of the parameter across.
#[derive(Clone)]
struct Here {
    x: f64,
    point: Point,
    multipliers: Vec<Polar>,
}

/// A row that is being filled.
struct Row<'a> {
    begun: &'a mut Begun,
    across: usize,
    /// How far apart two members of a family across would be.
    step: f64,
}

impl OrbitSearch {
    /// The stability of the motion that is found over a grid of two parameters, with the boundaries between: on each row, where the second one
    /// is constant, every crossing of the unit circle is refined in the first one, windows of instability narrower than a column included: between
    /// columns motions are looked at until three neighbours point to each.
    ///
    /// The motion is followed from column to column and from row to row; where it is lost the map has NaN.
    ///
    /// # Errors
    /// As [`OrbitSearch::find`]; names that are no parameters.
    pub fn map(mut self, (x, xs): (&str, &[f64]), (y, ys): (&str, &[f64])) -> Result<StabilityMap, Error> {
        let names = [x.to_owned(), y.to_owned()];
        let mut places = [0; 2];
        if let Ok((system, ..)) = &mut self.described {
            for (place, (name, values)) in places.iter_mut().zip([(x, xs), (y, ys)]) {
                *place = parameter_index(&**system, name)?;
                if let Some(first) = values.first() {
                    system.set_parameter(*place, *first);
                }
            }
        }
        self.varies = places.to_vec();
        let mut begun = self.begin()?;
        let corner = |x: f64| ends(ys).map(move |y| vec![(places[0], x), (places[1], y)]);
        begun.elsewhere = ends(xs).flat_map(corner).collect();
        begun.closes_elsewhere()?;
        let solution = begun.first()?;
        let mut first = begun.smallest(solution)?.0.point;
        let laps = lcm(begun.laps.closing.order(), begun.laps.laps) / begun.laps.laps;
        let (values, boundaries) = ([xs.to_vec(), ys.to_vec()], Vec::new());
        let mut map = StabilityMap { names, values, growth: Vec::new(), boundaries, interrupted: false };
        let mut open: Vec<usize> = Vec::new();
        for (rows, y) in ys.iter().enumerate() {
            begun.laps.system.set_parameter(places[1], *y);
            let mut row = Row { begun: &mut begun, across: places[0], step: extent(xs) / STEPS };
            let found = row.fill(&first, xs);
            if let Some(Some(here)) = found.first() {
                first.clone_from(&here.point);
            }
            let growth = |here: &Option<Here>| {
                let logs = here.iter().flat_map(|here| &here.multipliers).map(|polar| laps as f64 * polar.log);
                logs.fold(if here.is_some() { f64::NEG_INFINITY } else { f64::NAN }, f64::max)
            };
            map.growth.extend(found.iter().map(growth));
            let closer = row.closer(found);
            let crossings = row.crossings(&closer);
            if row.begun.laps.settings.interruption.is_asked() {
                // What is left of the row is no map.
                map.growth.truncate(rows * xs.len());
                map.values[1].truncate(rows);
                map.interrupted = true;
                break;
            }
            open = map.join(
                &open,
                crossings.into_iter().map(|(kind, x, error)| (kind, BoundaryPoint { x, y: *y, error })).collect(),
            );
        }
        Ok(map)
    }
}

/// The first and the last of some values, and one between.
fn ends(values: &[f64]) -> impl Iterator<Item = f64> {
    let ends: Vec<f64> = values.first().into_iter().chain(values.last()).copied().collect();
    sampled(&ends).collect::<Vec<_>>().into_iter()
}

/// How far some values reach.
fn extent(values: &[f64]) -> f64 {
    let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    (ends.1 - ends.0).max(0.0)
}

fn parameter_index(system: &dyn crate::mechanism::System, name: &str) -> Result<usize, Error> {
    let parameters = &system.description().parameters;
    let found = parameters.iter().position(|parameter| parameter.name == name);
    found.ok_or_else(|| Error::unknown("parameter", name, parameters.iter().map(|parameter| &parameter.name)))
}

impl Row<'_> {
    /// The motions at all columns, each looked for where its neighbour was.
    fn fill(&mut self, first: &Point, xs: &[f64]) -> Vec<Option<Here>> {
        let mut guess = first.clone();
        let mut found = Vec::with_capacity(xs.len());
        for x in xs {
            let here = self.at(*x, &guess).ok();
            if let Some(here) = &here {
                guess.clone_from(&here.point);
            }
            found.push(here);
        }
        found
    }

    /// The same with motions between columns, as close as boundaries ask for.
    fn closer(&mut self, columns: Vec<Option<Here>>) -> Vec<Option<Here>> {
        let mut list: Vec<Option<Here>> = Vec::with_capacity(columns.len());
        for here in columns {
            if let (Some(Some(last)), Some(here)) = (list.last().cloned(), here.as_ref()) {
                let parts = ((here.x - last.x) / self.step).abs().ceil() as usize;
                let between = (1..parts).map(|k| last.x + (here.x - last.x) * k as f64 / parts as f64);
                list.extend(between.filter_map(|x| self.at(x, &last.point).ok()).map(Some));
            }
            list.push(here);
        }
        let largest = |kind: OrbitChange| {
            let values = list.iter().flatten().map(|here| kind.of_multipliers(&here.multipliers).abs());
            values.fold(0.0, f64::max)
        };
        let scales = SEPARATE.map(|kind| (kind, STRAIGHT * largest(kind)));
        let mut closer: Vec<Option<Here>> = Vec::with_capacity(2 * list.len());
        for here in list {
            if let (Some(Some(last)), Some(here)) = (closer.last().cloned(), here.as_ref()) {
                self.halve([&last, here], &scales, 0, &mut closer);
            }
            closer.push(here);
        }
        closer
    }

    /// Motions between two where straight pieces will not do.
    fn halve(&mut self, [a, b]: [&Here; 2], scales: &[(OrbitChange, f64)], depth: u32, list: &mut Vec<Option<Here>>) {
        if depth == HALVINGS {
            return;
        }
        let Ok(middle) = self.at(0.5 * (a.x + b.x), &a.point) else { return };
        let bends = |(kind, most): &(OrbitChange, f64)| {
            let [a, middle, b] = [a, &middle, b].map(|here| kind.of_multipliers(&here.multipliers));
            (middle - 0.5 * (a + b)).abs() > *most
        };
        if scales.iter().any(bends) {
            self.halve([a, &middle], scales, depth + 1, list);
            list.push(Some(middle.clone()));
            self.halve([&middle, b], scales, depth + 1, list);
        }
    }

    fn at(&mut self, x: f64, guess: &Point) -> Result<Here, Error> {
        let laps = &mut self.begun.laps;
        laps.system.set_parameter(self.across, x);
        let solution = laps.solve(guess.clone(), None)?;
        self.begun.at_rest(&solution)?;
        let (solution, found) = self.begun.cut(solution)?;
        Ok(Here { x, point: solution.point, multipliers: found.multipliers })
    }

    /// The multipliers of a motion as more accurate flows have them.
    fn finer(&mut self, here: &Here) -> Result<Vec<Polar>, Error> {
        let laps = &mut self.begun.laps;
        let trial = laps.try_at(&here.point, laps.settings.tolerance)?;
        let before = laps.refine(&trial);
        let found = self.at(here.x, &here.point);
        self.begun.laps.settings = before;
        found.map(|found| found.multipliers)
    }

    /// What happens between columns: kind, place and error, from left to right.
    fn crossings(&mut self, row: &[Option<Here>]) -> Vec<(OrbitChange, f64, f64)> {
        let mut list = Vec::new();
        // A motion of a map is followed by its parameters, so that it never turns back.
        for kind in [OrbitChange::Branch, self.begun.laps.at_minus_one(), OrbitChange::Pair] {
            let value = |here: &Here| kind.of_multipliers(&here.multipliers);
            for pair in row.windows(2) {
                if let [Some(a), Some(b)] = pair
                    && kind.is_between(value(a), value(b))
                {
                    list.push(self.crossing(kind, a, b));
                }
            }
            for three in row.windows(3) {
                if let [Some(a), Some(b), Some(c)] = three
                    && kind != OrbitChange::Pair
                    && let Some(inside) = self.window(kind, [a, b, c])
                {
                    let (left, right) = if inside.x < b.x { (a, b) } else { (b, c) };
                    list.extend([self.crossing(kind, left, &inside), self.crossing(kind, &inside, right)]);
                }
            }
        }
        list.sort_by(|a, b| a.1.total_cmp(&b.1));
        list
    }

    /// A motion between neighbours on whose sides a function has the other sign, where they point to one.
    fn window(&mut self, kind: OrbitChange, [a, b, c]: [&Here; 3]) -> Option<Here> {
        let [u, v, w] = [a, b, c].map(|here| kind.of_multipliers(&here.multipliers));
        // Of two that are equal the second one, so that a window between both is found once.
        let least = v.abs() <= u.abs() && v.abs() < w.abs() && u * v > 0.0 && v * w > 0.0;
        // The parabola through the three: its least value beside that in the middle.
        let (left, right) = ((u - v) / (a.x - b.x), (w - v) / (c.x - b.x));
        let curvature = (right - left) / (c.x - a.x);
        let slope = left - curvature * (a.x - b.x);
        if !(least && (v - slope * slope / (4.0 * curvature)) * v.signum() <= REACHES * v.abs()) {
            return None;
        }
        let (mut low, mut high) = (a.x, c.x);
        for _ in 0..THIRDS {
            let third = (high - low) / 3.0;
            let tried = [low + third, high - third].map(|x| self.at(x, &b.point).ok());
            let [Some(p), Some(q)] = tried else { return None };
            let [f, g] = [&p, &q].map(|here| kind.of_multipliers(&here.multipliers) * v.signum());
            match () {
                () if f < 0.0 => return Some(p),
                () if g < 0.0 => return Some(q),
                () if f < g => high = q.x,
                () => low = p.x,
            }
        }
        None
    }

    /// The place between two motions at which a multiplier crosses the unit circle, and its error.
    fn crossing(&mut self, kind: OrbitChange, a: &Here, b: &Here) -> (OrbitChange, f64, f64) {
        let value = |here: &Here| kind.of_multipliers(&here.multipliers);
        let bracket = Around { resolution: SAME * (b.x - a.x).abs(), ..Around::bracket(a.x, b.x) };
        let x = locate(
            |x| self.at(x, &a.point).map_or(f64::NAN, |here| value(&here)),
            (a.x, value(a)),
            (b.x, value(b)),
            bracket,
        )
        .0;
        let error = self.at(x, &a.point).map_or(f64::NAN, |found| {
            let here = value(&found);
            let finer = self.finer(&found).map_or(f64::NAN, |multipliers| kind.of_multipliers(&multipliers));
            // In a narrow window the function is a parabola: its chord on the inner side is half as steep as its end.
            let slope = |other: &Here| ((value(other) - here) / (other.x - x)).abs();
            let located = (SAME * self.step).max(4.0 * f64::EPSILON * x.abs());
            (TOLD * ((finer - here).abs() + here.abs()) / slope(a).min(slope(b))).max(located)
        });
        (kind, x, error)
    }
}

impl StabilityMap {
    /// Joins the crossings of a row to the curves that the row before met, the nearest first, where the crossing is the nearest to the curve or
    /// the curve to the crossing; others begin curves.  Those that the row meets are told.
    fn join(&mut self, open: &[usize], crossings: Vec<(OrbitChange, BoundaryPoint)>) -> Vec<usize> {
        let distance = |curve: usize, (kind, point): &(OrbitChange, BoundaryPoint)| {
            let boundary = &self.boundaries[curve];
            if boundary.kind == *kind { (boundary.ahead(point.y) - point.x).abs() } else { f64::INFINITY }
        };
        let mut pairs = Vec::new();
        for &curve in open {
            for (place, crossing) in crossings.iter().enumerate() {
                let own = distance(curve, crossing);
                let nearest = open.iter().all(|other| own <= distance(*other, crossing))
                    || crossings.iter().all(|other| own <= distance(curve, other));
                if own.is_finite() && nearest {
                    pairs.push((own, curve, place));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut joined = vec![None; crossings.len()];
        for (_, curve, place) in pairs {
            if joined[place].is_none() && !joined.contains(&Some(curve)) {
                joined[place] = Some(curve);
            }
        }
        let places = crossings.into_iter().zip(joined).map(|((kind, point), curve)| {
            let curve = curve.unwrap_or_else(|| {
                self.boundaries.push(Boundary { kind, points: Vec::new() });
                self.boundaries.len() - 1
            });
            self.boundaries[curve].points.push(point);
            curve
        });
        places.collect()
    }

    /// The multiplier's growth at a column and a row; NaN where no motion was found.
    pub fn at(&self, column: usize, row: usize) -> f64 {
        self.growth[row * self.values[0].len() + column]
    }

    /// Whether small changes grow at a column and a row; none where no motion was found.
    pub fn is_unstable(&self, column: usize, row: usize) -> Option<bool> {
        let growth = self.at(column, row);
        (!growth.is_nan()).then(|| Multiplier::of(growth, 0.0, 0.0).grows())
    }
}

impl Boundary {
    /// Where the line through its last two points goes on.
    fn ahead(&self, y: f64) -> f64 {
        match self.points.as_slice() {
            [.., a, b] if a.y != b.y => b.x + (b.x - a.x) / (b.y - a.y) * (y - b.y),
            [.., b] => b.x,
            [] => f64::NAN,
        }
    }
}
