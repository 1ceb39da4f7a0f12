//! States at which the argument of a table lies between its points, and beside the first and the last.

use std::collections::BTreeSet;

use super::arguments::{Argument, Points};
use super::lines::{Line, Reach, moved};
use super::motion::Motion;
use super::near_switch::{Sides, sampled};
use super::state::State;
use crate::expr::Table;
use crate::number::DoubleDouble;

/// So many pieces of a table are visited.
const PIECES: usize = 32;
/// So many lines are followed for each table.
const LINES: usize = 12;
/// A state lies in the middle of a piece to this part of its length.
const MIDDLE: f64 = 0.3;

/// Adds a state for each piece of each table, as far as lines through the bases, between them and along motions lead there.
pub(super) fn points(
    motion: &Motion,
    tables: &[Points],
    (bases, paths): (&[State], &[&[State]]),
    reach: &Reach<'_>,
    found: &mut Sides,
) {
    for Points { table, argument } in tables {
        let (mut wanted, more) = pieces(*table);
        if more > 0 {
            let (name, words) = (table.name(), &argument.words);
            found.unreached.push(format!("{more} pieces of the table `{name}` of `{words}` were not visited"));
        }
        let all = wanted.len();
        for path in paths.iter().filter(|path| path.len() > 1) {
            follow(motion, argument, &path[0], &Line::Path(path), &mut wanted, found);
        }
        let mut followed = 0;
        for (k, base) in bases.iter().enumerate() {
            let mut lines = reach.lines(&argument.symbols);
            let next = bases.get(k + 1).filter(|next| next.parameters == base.parameters);
            lines.extend(next.map(Line::Between));
            for line in lines {
                if wanted.is_empty() || followed >= LINES {
                    break;
                }
                followed += 1;
                follow(motion, argument, base, &line, &mut wanted, found);
            }
        }
        if wanted.len() == all {
            let (name, words) = (table.name(), &argument.words);
            found.unreached.push(format!("no state was found at which `{words}` is between the points of `{name}`"));
        }
    }
}

/// Takes from what is wanted what a line leads to.
fn follow(
    motion: &Motion,
    argument: &Argument,
    base: &State,
    line: &Line<'_>,
    wanted: &mut Vec<(f64, f64)>,
    found: &mut Sides,
) {
    let at = |z: f64| argument.at(motion, &moved(motion, base, line, DoubleDouble::from(z)));
    let samples = sampled(base, line, &at);
    wanted.retain(|&(middle, near)| {
        let passes = |w: &&[(f64, f64)]| (w[0].1 - middle) * (w[1].1 - middle) <= 0.0;
        let Some(pair) = samples.windows(2).find(passes) else { return true };
        let Some(z) = close(&at, (pair[0], pair[1]), (middle, near)) else { return true };
        found.states.push(moved(motion, base, line, DoubleDouble::from(z)));
        false
    });
}

/// A place between two samples where a function is as near to a value as that.
fn close(
    f: &dyn Fn(f64) -> f64,
    ((mut a, at_a), (mut b, at_b)): ((f64, f64), (f64, f64)),
    (value, near): (f64, f64),
) -> Option<f64> {
    let ends = [(a, at_a), (b, at_b)];
    if let Some((z, _)) = ends.into_iter().find(|(_, at)| (at - value).abs() <= near) {
        return Some(z);
    }
    let below = at_a < value;
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        let at = f(middle);
        if (at - value).abs() <= near {
            return Some(middle);
        }
        if middle <= a || middle >= b || at.is_nan() {
            return None;
        }
        if (at < value) == below { a = middle } else { b = middle }
    }
    None
}

/// Where the pieces of a table have their middles, those that rise or fall most before others, with how near will do; and
/// how many more it has.
pub(super) fn pieces(table: Table) -> (Vec<(f64, f64)>, usize) {
    let knots = table.knots();
    let value = |x: f64| table.whole().at(DoubleDouble::from(x)).to_f64();
    let inner = knots.windows(2).map(|pair| {
        let length = pair[1] - pair[0];
        let rise = (value(pair[1]) - value(pair[0])).abs().max((value(pair[0] + 0.5 * length) - value(pair[0])).abs());
        (rise, (pair[0] + 0.5 * length, MIDDLE * length))
    });
    let mut inner: Vec<(f64, (f64, f64))> = inner.collect();
    let count = inner.len();
    let mut places: Vec<(f64, f64)> = Vec::new();
    if count > PIECES {
        // Half of them where most happens, the others evenly.
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|i, j| inner[*j].0.total_cmp(&inner[*i].0));
        let steepest = order.into_iter().take(PIECES / 2);
        let even = (0..PIECES / 2).map(|k| k * (count - 1) / (PIECES / 2 - 1));
        let kept: BTreeSet<usize> = steepest.chain(even).collect();
        inner = kept.into_iter().map(|k| inner[k]).collect();
    }
    let more = count - inner.len();
    places.extend(inner.into_iter().map(|(_, place)| place));
    if let ([first, .., last], None) = (knots, table.period()) {
        let aside = 0.1 * (last - first);
        places.extend([(first - aside, MIDDLE * aside), (last + aside, MIDDLE * aside)]);
    }
    (places, more)
}

/// So many of the steepest pieces of a table are places where it says something.
const STEEPEST: usize = 3;
/// A piece says nothing whose values are below this part of the largest.
const SILENT: f64 = 1e-3;

/// The middles of the pieces at which a table says most, with how near will do; a piece that is 0 says nothing.
pub(super) fn loudest(table: Table) -> Vec<(f64, f64)> {
    let value = |x: f64| table.whole().at(DoubleDouble::from(x)).to_f64().abs();
    let size = |(middle, near): &(f64, f64)| value(*middle).max(value(middle - near)).max(value(middle + near));
    let mut places = pieces(table).0;
    places.sort_by(|a, b| size(b).total_cmp(&size(a)));
    places.truncate(STEEPEST);
    let largest = places.first().map_or(0.0, size);
    places.retain(|place| size(place) >= SILENT * largest);
    places
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expr::Smooth;

    #[test]
    fn pieces_without_values_say_nothing() {
        let gate = [[0.0, 0.0], [3.0, 0.0], [4.0, 1.0], [6.0, 0.0], [10.0, 0.0]];
        let places: Vec<f64> =
            loudest(Table::new("gate", &gate, Smooth::Once, false)).iter().map(|place| place.0).collect();
        assert_eq!(places.len(), 2);
        assert!(places.contains(&3.5) && places.contains(&5.0), "{places:?}");
        // Values of both signs have a zero in the middle of their piece.
        let odd = [[-1.0, -1.0], [1.0, 1.0]];
        assert_eq!(loudest(Table::new("odd", &odd, Smooth::Zero, false)).len(), 3);
    }

    #[test]
    fn a_narrow_piece_of_a_long_table_is_visited() {
        let flat: Vec<[f64; 2]> = (0..=1000).map(|k| [f64::from(k), if k == 777 { 1.0 } else { 0.0 }]).collect();
        let (places, more) = pieces(Table::new("spike", &flat, Smooth::Zero, false));
        let visited = |x: f64| places.iter().any(|place| place.0 == x);
        assert!(visited(776.5) && visited(777.5) && visited(0.5) && visited(999.5) && places.len() <= PIECES + 2);
        assert!(more > 900 && more < 1000);
        let (places, more) = pieces(Table::new("short", &flat[..3], Smooth::Twice, true));
        assert_eq!((places.len(), more), (2, 0));
    }
}
