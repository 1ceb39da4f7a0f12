//! Pictures without what nobody sees: places on straight pieces of lines, and what plotters writes again and again.

use super::figure::FINE;

/// A place in drawing units.
pub(super) type Spot = (i32, i32);

/// A line leaves out places that are no farther from it than this, in drawing units: a tenth of a pixel.
const UNSEEN: f64 = 0.1 * FINE as f64;
/// Fewer lines of one style, one after the other, are left as they are.
const SEVERAL: usize = 8;

/// The line without places that it passes all the same (Ramer 1972; Douglas and Peucker 1973).
pub(super) fn thinned(places: &[Spot]) -> Vec<Spot> {
    let mut kept = vec![false; places.len()];
    let (Some(last), true) = (places.len().checked_sub(1), places.len() > 2) else { return places.to_vec() };
    (kept[0], kept[last]) = (true, true);
    let mut pieces = vec![(0, last)];
    while let Some((from, to)) = pieces.pop() {
        let farthest = (from + 1..to).map(|k| (distance(places[k], places[from], places[to]), k));
        let farthest = farthest.max_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((far, k)) = farthest
            && far > UNSEEN
        {
            kept[k] = true;
            pieces.extend([(from, k), (k, to)]);
        }
    }
    places.iter().zip(kept).filter(|(_, kept)| *kept).map(|(place, _)| *place).collect()
}

/// How far a place is from the straight piece between two others.
fn distance(place: Spot, from: Spot, to: Spot) -> f64 {
    let [p, a, b] = [place, from, to].map(|(x, y)| (f64::from(x), f64::from(y)));
    let (along, across) = ((b.0 - a.0, b.1 - a.1), (p.0 - a.0, p.1 - a.1));
    let square = along.0 * along.0 + along.1 * along.1;
    let part = if square > 0.0 { ((across.0 * along.0 + across.1 * along.1) / square).clamp(0.0, 1.0) } else { 0.0 };
    (across.0 - part * along.0).hypot(across.1 - part * along.1)
}

/// An SVG in which what is opaque does not say so, and lines of one style that follow each other, as the dashes of a curve, say it once.
pub(super) fn shortened(svg: &str) -> String {
    let opaque = svg.replace(" opacity=\"1\"", "");
    let lines: Vec<&str> = opaque.lines().collect();
    let mut short = String::with_capacity(opaque.len());
    let mut at = 0;
    while at < lines.len() {
        let alike = style(lines[at]).map_or(1, |(first, _)| {
            lines[at..].iter().take_while(|line| style(line).is_some_and(|(style, _)| style == first)).count()
        });
        if alike < SEVERAL {
            lines[at..at + alike].iter().for_each(|line| short.extend([line, "\n"]));
        } else if let Some((own, _)) = style(lines[at]) {
            short.extend(["<g ", own, ">\n"]);
            let all = lines[at..at + alike].iter().filter_map(|line| style(line));
            all.for_each(|(_, points)| short.extend(["<polyline points=\"", points, "\n"]));
            short.push_str("</g>\n");
        }
        at += alike;
    }
    short
}

/// The style of a line of places, and the rest of its text.
fn style(line: &str) -> Option<(&str, &str)> {
    line.strip_prefix("<polyline ")?.split_once(" points=\"")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_go_that_nobody_misses() {
        let straight: Vec<Spot> = (0..=100).map(|i| (i, 2 * i)).collect();
        assert_eq!(thinned(&straight), [(0, 0), (100, 200)]);
        // A corner stays, there and back again too.
        assert_eq!(thinned(&[(0, 0), (50, 0), (100, 0), (100, 50), (100, 100)]), [(0, 0), (100, 0), (100, 100)]);
        assert_eq!(thinned(&[(0, 0), (100, 0), (40, 0)]), [(0, 0), (100, 0), (40, 0)]);
        let circle: Vec<Spot> = (0..=400)
            .map(|i| f64::from(i) * std::f64::consts::TAU / 400.0)
            .map(|t| ((500.0 * t.cos()).round() as i32, (500.0 * t.sin()).round() as i32))
            .collect();
        let few = thinned(&circle);
        assert!(few.len() < 120, "{}", few.len());
        let off = |place: &Spot| few.windows(2).map(|pair| distance(*place, pair[0], pair[1])).fold(f64::MAX, f64::min);
        assert!(circle.iter().map(off).fold(0.0, f64::max) <= UNSEEN);
    }

    #[test]
    fn dashes_say_their_style_once() {
        let dash = "<polyline fill=\"none\" opacity=\"1\" stroke=\"#000000\" points=\"1,2 3,4 \"/>\n";
        let found = shortened(&dash.repeat(9));
        assert_eq!((found.matches("stroke").count(), found.matches("<polyline points=\"1,2 3,4 \"/>").count()), (1, 9));
        assert!(found.starts_with("<g fill=\"none\" stroke=\"#000000\">\n") && found.ends_with("</g>\n"));
        assert_eq!(shortened(dash), dash.replace(" opacity=\"1\"", ""));
    }
}
