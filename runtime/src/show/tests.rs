//! What is in the pictures, read back from their XML.

use super::*;
use roxmltree::{Document, Node};

fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',']).filter(|part| !part.is_empty()).map(|part| part.parse().unwrap()).collect()
}

/// The thick lines of one colour, in pixels.
fn curves(svg: &Document<'_>, colour: &str) -> Vec<Vec<(f64, f64)>> {
    let drawn = |node: &Node<'_, '_>| {
        node.has_tag_name("polyline")
            && node.attribute("stroke") == Some(colour)
            && node.attribute("stroke-width") == Some("20")
    };
    let places = |node: Node<'_, '_>| {
        let points = numbers(node.attribute("points").unwrap());
        points.chunks(2).map(|pair| (pair[0] / 10.0, pair[1] / 10.0)).collect()
    };
    svg.descendants().filter(drawn).map(places).collect()
}

fn texts<'a>(svg: &'a Document<'_>) -> Vec<&'a str> {
    svg.descendants().filter(|n| n.has_tag_name("text")).filter_map(|n| n.text()).map(str::trim).collect()
}

fn span(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
}

const BLUE: &str = "#0072B2";

fn time_axis() -> Axis {
    Axis::new("time", "s")
}

#[test]
fn names_units_and_ticks_are_written() {
    let line = |name: &str| Series::line(name, (0..=10).map(|i| Some((f64::from(i), f64::from(i * i)))));
    let chart = Chart::new("A < B & \"C\"", time_axis(), Axis::new("height", "m")).with(line("x[1]")).with(line("<y>"));
    let svg = chart.to_svg();
    let document = Document::parse(&svg).unwrap();
    let texts = texts(&document);
    for wanted in ["A < B & \"C\"", "time (s)", "height (m)", "x[1]", "<y>", "0", "2", "10", "100"] {
        assert!(texts.contains(&wanted), "{wanted} is not among {texts:?}");
    }
}

#[test]
fn names_that_are_too_long_are_shortened_and_stay_on_the_page() {
    let long = |what: &str| {
        format!("{what}_of_the_front_left_wheel_of_the_second_carriage_from_behind_and_what_belongs_to_it_or_not")
    };
    let line = |name: String| Series::line(name, (0..=10).map(|i| Some((f64::from(i), f64::from(i)))));
    let chart = Chart::new(long("title"), Axis::new(long("time"), "s"), Axis::new(long("height"), "m"));
    let svg = chart.with(line(long("one"))).with(line("other".to_owned())).to_svg();
    let document = Document::parse(&svg).unwrap();
    let view = numbers(document.root_element().attribute("viewBox").unwrap());
    let mut shortened = 0;
    for node in document.descendants().filter(|node| node.has_tag_name("text")) {
        let (words, number) = (node.text().unwrap().trim(), |name: &str| numbers(node.attribute(name).unwrap())[0]);
        let width = number("font-size") / figure::PLOTTERS_SHRINKS * lettering::width(words);
        let before = if node.attribute("text-anchor") == Some("middle") { 0.5 * width } else { 0.0 };
        let turned = node.attribute("transform").is_some();
        let (place, end) = if turned { (number("y"), view[3]) } else { (number("x"), view[2]) };
        let inside = (-1.0..=end + 1.0).contains(&(place - before)) && place - before + width <= end + 1.0;
        assert!(inside || node.attribute("text-anchor") == Some("end"), "{words}: {place} {width}");
        shortened += usize::from(words.contains('…'));
    }
    assert!(shortened >= 3, "{svg}");
}

#[test]
fn names_stand_in_the_place_of_numbers() {
    let marks = Series::marks("", (1..=3).map(|i| Some((f64::from(i), 0.5))));
    let svg =
        Chart::new("", Axis::new("coordinate", "").named(["x", "phi[2]", "z"]), Axis::new("shape", "")).with(marks);
    let (svg, names) = (svg.to_svg(), ["x", "phi[2]", "z"]);
    let document = Document::parse(&svg).unwrap();
    let found = texts(&document);
    assert!(names.iter().all(|name| found.contains(name)) && !found.contains(&"2"), "{found:?}");
}

#[test]
fn an_absent_value_leaves_a_gap() {
    let points = (0..=20).map(|i| (f64::from(i), f64::from(i % 2))).map(|p| (p.0 != 10.0).then_some(p));
    let svg = Chart::new("", time_axis(), Axis::new("x", "")).with(Series::line("x", points)).to_svg();
    let lengths: Vec<usize> = curves(&Document::parse(&svg).unwrap(), BLUE).iter().map(Vec::len).collect();
    assert_eq!(lengths, [10, 10]);
}

#[test]
fn what_has_no_place_on_a_log_axis_is_left_out() {
    let points = [(1.0, 1e-3), (2.0, 0.0), (3.0, f64::NAN), (4.0, f64::INFINITY), (5.0, 1e-4), (6.0, 1e-5)];
    let chart =
        Chart::new("", Axis::new("n", ""), Axis::new("error", "").log()).with(Series::line("", points.map(Some)));
    let svg = chart.to_svg();
    let document = Document::parse(&svg).unwrap();
    assert_eq!(curves(&document, BLUE)[0].len(), 2);
    assert!(texts(&document).contains(&"10⁻⁴") && !svg.contains("NaN"));
}

#[test]
fn equal_axes_are_equal() {
    for (a, b) in [(1.0, 1.0), (5.0, 0.2), (0.01, 3.0)] {
        let ellipse =
            (0..=400).map(|i| f64::from(i) / 400.0 * std::f64::consts::TAU).map(|s| Some((a * s.cos(), b * s.sin())));
        let chart = Chart::new("", Axis::new("x", "m"), Axis::new("y", "m")).equal().with(Series::line("", ellipse));
        let svg = chart.to_svg();
        let curve = curves(&Document::parse(&svg).unwrap(), BLUE).concat();
        let (width, height) = (span(curve.iter().map(|p| p.0)), span(curve.iter().map(|p| p.1)));
        assert!((width * b - height * a).abs() < 0.2 * a.max(b), "{width} × {height} for {a} × {b}");
        assert!(width.max(height) > 300.0, "{width} × {height} is small");
    }
}

#[test]
fn log_axes_make_powers_straight() {
    let power = (0..=10).map(|i| 2f64.powi(i)).map(|n| Some((n, 3.0 * n.powi(-4))));
    let chart =
        Chart::new("", Axis::new("steps", "").log(), Axis::new("error", "").log()).with(Series::line("", power));
    let svg = chart.to_svg();
    let curve = curves(&Document::parse(&svg).unwrap(), BLUE).concat();
    let ((x0, y0), (x1, y1)) = (curve[0], curve[curve.len() - 1]);
    for (x, y) in curve {
        assert!((y - y0 - (y1 - y0) * (x - x0) / (x1 - x0)).abs() < 0.2, "({x}, {y}) is off the line");
    }
}

#[test]
fn failures_stand_above_everything() {
    let euler = Series::marked_line("", [(100.0, 1e-1), (1000.0, 1e-2)].map(Some)).failed(10.0, "non-finite");
    let chart = Chart::new("", Axis::new("steps", "").log(), Axis::new("error", "").log()).with(euler);
    let svg = chart.to_svg();
    let document = Document::parse(&svg).unwrap();
    let cross = document.descendants().find(|n| n.text().is_some_and(|text| text.trim() == "non-finite")).unwrap();
    let highest = curves(&document, BLUE).concat().iter().map(|p| p.1).fold(f64::MAX, f64::min);
    assert!(numbers(cross.attribute("y").unwrap())[0] / 10.0 < highest);
}

/// What is written in a picture, with the places.
fn written(svg: &str) -> Vec<(String, f64, f64)> {
    let document = Document::parse(svg).unwrap();
    let place = |node: &roxmltree::Node<'_, '_>, name: &str| numbers(node.attribute(name).unwrap())[0] / 10.0;
    let texts = document.descendants().filter(|node| node.has_tag_name("text"));
    texts.map(|node| (node.text().unwrap_or("").trim().to_owned(), place(&node, "x"), place(&node, "y"))).collect()
}

/// The lowest place of what is written so.
fn lowest(written: &[(String, f64, f64)], text: &str) -> f64 {
    written.iter().filter(|(own, ..)| own == text).map(|(.., y)| *y).fold(f64::NAN, f64::max)
}

#[test]
fn failures_leave_the_axis_as_it_is_and_stand_above_the_frame() {
    let chart = |failed: bool| {
        let lines = (0..12).map(|k| {
            let line = Series::marked_line("", [(1e-3, 10.0), (1e-6, 1000.0)].map(Some));
            let x = if k == 1 { f64::NAN } else { 1e-3 };
            // Those without failures take no row.
            if failed && k % 2 == 1 { line.failed(x, "lost") } else { line }
        });
        lines.fold(Chart::new("", Axis::new("error", "").log(), Axis::new("work", "").log()), Chart::with)
    };
    let [without, with] = [false, true].map(|failed| written(&chart(failed).to_svg()));
    let labels = |written: &[(String, f64, f64)]| {
        let own = written.iter().filter(|(text, ..)| text != "lost").map(|(text, ..)| text.clone());
        own.collect::<Vec<_>>()
    };
    assert_eq!(labels(&without), labels(&with));
    // Above the highest mark of the vertical axis, which is at the frame or below it.
    let highest = with.iter().find(|(text, ..)| text == "1000").unwrap().2;
    assert!(lowest(&with, "lost") < highest, "{with:?}");
    // One that has no place stands left of all others.
    let crosses: Vec<f64> = with.iter().filter(|(text, ..)| text == "lost").map(|(_, x, _)| *x).collect();
    assert_eq!(crosses.len(), 6);
    assert!(crosses[1..].iter().all(|x| *x > crosses[0] + 10.0), "{crosses:?}");
}

#[test]
fn names_of_instants_stand_above_the_curves() {
    let line = Series::line("", [(0.0, 1.0), (1.0, 1.0), (2.0, 0.0)].map(Some));
    let mut chart = Chart::new("", time_axis(), Axis::new("y", "m").every(1.0)).with(line);
    chart.y.range = Some((0.0, 1.0));
    chart.instants = [0.5, 2.0].map(|x| Instant { x, name: "lands".into() }).to_vec();
    let svg = chart.to_svg();
    let written = written(&svg);
    let top = curves(&Document::parse(&svg).unwrap(), BLUE).concat().iter().map(|p| p.1).fold(f64::MAX, f64::min);
    assert_eq!(written.iter().filter(|(text, ..)| text == "lands").count(), 2);
    assert!(lowest(&written, "lands") <= top, "{written:?} {top}");
}

#[test]
fn a_range_that_is_small_beside_its_values_is_counted_from_one_of_them() {
    let line = |low: f64, width: f64| {
        let points = (0..=4).map(|k| Some((f64::from(k), low + 0.25 * width * f64::from(k))));
        written(&Chart::new("", time_axis(), Axis::new("y", "m")).with(Series::line("", points)).to_svg())
    };
    for (low, width, title) in [(-0.981, 1e-7, "y + 0.981 (m)"), (4200.0, 1e-4, "y − 4200"), (1.0, 0.5, "y (m)")] {
        let written = line(low, width);
        assert!(written.iter().any(|(text, ..)| text.starts_with(title)), "{title} {written:?}");
        // Right-aligned beside the frame, none reaches the title.
        let labels = written.iter().filter(|(text, ..)| text.starts_with(|c: char| c == '−' || c.is_ascii_digit()));
        let widest = labels.map(|(text, ..)| lettering::width(text)).fold(0.0, f64::max);
        assert!(widest < 6.5, "{written:?}");
    }
}

#[test]
fn a_path_shorter_than_a_pixel_is_a_dot() {
    let dots = |length: f64| {
        let line = Series::line("", [Some((0.0, 0.0)), Some((length, 0.0))]);
        let frame = Series::line("", [Some((0.0, 1.0)), Some((1.0, 1.0))]);
        let svg = Chart::new("", Axis::new("x", ""), Axis::new("y", "")).with(line).with(frame).to_svg();
        svg.matches("<circle").count()
    };
    assert_eq!([1e-5, 0.5].map(dots), [1, 0]);
}

#[test]
fn any_numbers_make_a_chart() {
    let cases: [&[(f64, f64)]; 7] = [
        &[],
        &[(0.0, 0.0)],
        &[(0.0, 1.0), (1.0, 1.0)],
        &[(0.0, 1.0), (1.0, 1.0 + 1e-15)],
        &[(-f64::MAX, f64::MAX), (f64::MAX, f64::MIN)],
        &[(5e-324, 5e-324), (1e308, 1e308)],
        &[(f64::NAN, f64::INFINITY)],
    ];
    for points in cases {
        for (x, y) in [(Scale::Linear, Scale::Linear), (Scale::Log, Scale::Log)] {
            for equal in [false, true] {
                let axis = |scale| Axis { scale, ..Axis::new("x", "m") };
                let series = Series::marked_line("", points.iter().copied().map(Some)).failed(1.0, "lost");
                let chart = Chart { equal, ..Chart::new("", axis(x), axis(y)).with(series) };
                let svg = chart.to_svg();
                assert!(Document::parse(&svg).is_ok() && !svg.contains("NaN"), "{points:?}");
            }
        }
    }
}

#[test]
fn a_figure_stacks_its_charts() {
    let chart = |y: &str| {
        Chart::new("", time_axis(), Axis::new(y, "")).with(Series::line(y, [Some((0.0, 1.0)), Some((1.0, 2.0))]))
    };
    let svg = Figure::from(vec![chart("upper"), chart("lower")]).to_svg();
    let curves = curves(&Document::parse(&svg).unwrap(), BLUE);
    assert_eq!(curves.len(), 2);
    assert!(curves[0].iter().all(|p| p.1 < 330.0) && curves[1].iter().all(|p| p.1 > 330.0));
    assert_eq!(svg, Figure::from(vec![chart("upper"), chart("lower")]).to_svg());
}

#[test]
fn many_series_get_colours_of_a_family() {
    let line = |i: i32| Series::line(format!("theta[{i}]"), [Some((0.0, f64::from(i))), Some((1.0, f64::from(i + 1)))]);
    let chart = (1..=40).fold(Chart::new("", time_axis(), Axis::new("theta", "rad")), |chart, i| chart.with(line(i)));
    let svg = chart.to_svg();
    let document = Document::parse(&svg).unwrap();
    let lines = document.descendants().filter(|n| n.attribute("stroke-width") == Some("20"));
    let colours: std::collections::BTreeSet<_> = lines.filter_map(|n| n.attribute("stroke")).collect();
    assert_eq!(colours.len(), 40);
    let names = texts(&document).iter().filter(|text| text.starts_with("theta[")).count();
    assert!((10..=25).contains(&names), "{names} names");
}

#[test]
fn charts_stand_side_by_side() {
    let charts = ["a", "b", "c"]
        .map(|title| Chart::new(title, time_axis(), Axis::new("y", "")).with(Series::line("name", [Some((0.0, 1.0))])));
    let side = Figure { charts: charts.to_vec(), columns: 2 }.to_svg();
    let below = Figure::from(charts.to_vec()).to_svg();
    let height = |svg: &str| -> f64 {
        Document::parse(svg).unwrap().root_element().attribute("height").unwrap().parse().unwrap()
    };
    assert!(height(&side) < height(&below));
    // Of the upper row the names of one chart stand for both.
    assert_eq!((side.matches("name").count(), below.matches("name").count()), (2, 3));
}
