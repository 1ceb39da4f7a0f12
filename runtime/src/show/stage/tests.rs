//! Shapes in space in a picture, read back from its SVG.

use super::*;
use roxmltree::Document;

const AXES_OF: [f64; 9] = [0.4, 0.0, 0.0, 0.0, 0.4, 0.0, 0.0, 0.0, 0.4];

fn animation(shapes: Vec<Shape>, numbers: &[f64]) -> Animation {
    Animation::new("Any", 3, shapes).with_frames([(0.0, numbers.to_vec())])
}

fn svg(animation: &Animation) -> String {
    let stage = Stage::of(animation);
    let mut svg = String::new();
    let canvas = SVGBackend::with_string(&mut svg, stage.fine()).into_drawing_area();
    stage.draw_background(&canvas).and_then(|()| stage.draw(&canvas, 0.0)).unwrap();
    drop(canvas);
    svg
}

/// Points of all elements of a kind and colour, px: lines by `stroke`, faces by `fill`.
fn drawn(svg: &str, kind: &str, colour: RGBColor) -> Vec<Vec<(f64, f64)>> {
    let document = Document::parse(svg).unwrap();
    let colour = format!("#{:02X}{:02X}{:02X}", colour.0, colour.1, colour.2);
    let by = if kind == "polyline" { "stroke" } else { "fill" };
    let of_kind = document.descendants().filter(|node| node.has_tag_name(kind) && node.attribute(by) == Some(&colour));
    let number = |text: &str| text.parse::<f64>().unwrap() / f64::from(FINE);
    let points = of_kind.map(|node| {
        let pairs = node.attribute("points").unwrap().split_whitespace().map(|pair| pair.split_once(',').unwrap());
        pairs.map(|(x, y)| (number(x), number(y))).collect()
    });
    points.collect()
}

/// How many lines and faces have the colour of the only shape.
fn count(shape: Shape, numbers: &[f64]) -> (usize, usize) {
    let svg = svg(&animation(vec![shape], numbers));
    (drawn(&svg, "polyline", COLOURS[0]).len(), drawn(&svg, "polygon", COLOURS[0]).len())
}

#[test]
fn each_shape_has_its_lines_and_faces() {
    let at = [1.0, 2.0, 3.0];
    let framed = [&at[..], &AXES_OF].concat();
    assert_eq!(count(Shape::Ring, &[&at[..], &[0.0, 0.0, 1.0]].concat()), (1, 0));
    assert_eq!(count(Shape::Disc, &[&at[..], &[0.0, 0.0, 1.0]].concat()), (1, 1));
    assert_eq!(count(Shape::Cylinder, &[&at[..], &[2.0, 2.0, 2.0], &[0.3]].concat()), (2, 2));
    assert_eq!(count(Shape::Sphere, &[&at[..], &[0.5]].concat()), (1, 1));
    assert_eq!(count(Shape::Box, &framed), (3, 3));
    assert_eq!(count(Shape::Ellipsoid, &framed), (4, 1));
    let plane = svg(&animation(vec![Shape::Plane], &[&at[..], &[0.0, 0.0, 1.0]].concat()));
    assert_eq!(drawn(&plane, "polygon", QUIET).len(), 1);
    let axes = svg(&animation(vec![Shape::Axes], &framed));
    for colour in AXES.map(|k| COLOURS[k]) {
        assert_eq!(drawn(&axes, "polyline", colour).len(), 1);
    }
    // The letters of the body's axes, and those of the ground's in the corner.
    let document = Document::parse(&axes).unwrap();
    let letters = document.descendants().filter(|node| node.has_tag_name("text"));
    assert_eq!(letters.filter(|node| matches!(node.text().unwrap().trim(), "x" | "y" | "z")).count(), 6);
}

#[test]
fn the_rim_of_a_coin_is_round_and_closes_within_half_a_pixel() {
    for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.6, 0.0, 0.8], [0.0, 1e-9, 1.0]] {
        let coin = animation(vec![Shape::Disc], &[&[1.0, 2.0, 3.0][..], &axis].concat());
        let [rim] = &drawn(&svg(&coin), "polyline", COLOURS[0])[..] else { panic!() };
        assert_eq!(rim.first(), rim.last());
        // Points of the true circle: one vector across the axis, and the other.
        let stage = Stage::of(&coin);
        let u = if axis[2] > 0.9 { [1.0, 0.0, 0.0] } else { [-axis[1], axis[0], 0.0] };
        let u = u.map(|x: f64| x / (u[0] * u[0] + u[1] * u[1]).sqrt());
        let v = [axis[1] * u[2] - axis[2] * u[1], axis[2] * u[0] - axis[0] * u[2], axis[0] * u[1] - axis[1] * u[0]];
        for i in 0..1000 {
            let (sine, cosine) = (f64::from(i) * std::f64::consts::TAU / 1000.0).sin_cos();
            let (x, y) = stage.pixel(plus(plus([1.0, 2.0, 3.0], cosine, u), sine, v));
            let away = rim.windows(2).map(|pair| distance((x, y), pair[0], pair[1])).fold(f64::INFINITY, f64::min);
            assert!(away < 0.5, "{axis:?}: {away} px");
        }
    }
}

/// How far a point is from a straight piece.
fn distance((x, y): (f64, f64), a: (f64, f64), b: (f64, f64)) -> f64 {
    let (dx, dy) = (b.0 - a.0, b.1 - a.1);
    let part = ((x - a.0) * dx + (y - a.1) * dy) / (dx * dx + dy * dy).max(1e-12);
    let part = part.clamp(0.0, 1.0);
    (x - a.0 - part * dx).hypot(y - a.1 - part * dy)
}

#[test]
fn the_picture_holds_all_of_a_solid() {
    let framed = |size: f64| [&[0.0, 0.0, 0.0][..], &AXES_OF.map(|x| size * x)].concat();
    for (shape, numbers) in [
        (Shape::Sphere, vec![1.0, 2.0, 3.0, 5.0]),
        (Shape::Disc, vec![1.0, 2.0, 3.0, 0.0, 7.0, 0.0]),
        (Shape::Cylinder, vec![0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 4.0]),
        (Shape::Box, framed(9.0)),
        (Shape::Ellipsoid, framed(1e-3)),
    ] {
        let svg = svg(&animation(vec![shape.clone()], &numbers));
        let points = drawn(&svg, "polyline", COLOURS[0]).concat();
        let inside = |(x, y): &(f64, f64)| (0.0..640.0).contains(x) && (34.0..514.0).contains(y);
        assert!(points.iter().all(inside), "{shape:?}");
        // It takes a good part of the picture.
        let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), (x, _)| (low.min(*x), high.max(*x)));
        assert!(high - low > 150.0, "{shape:?}: {} px", high - low);
    }
}

#[test]
fn what_is_not_there_is_not_drawn_and_hides_nothing() {
    let ball = [0.0, 0.0, 0.0, 1.0];
    let shapes = vec![Shape::Disc, Shape::Sphere, Shape::Box];
    let numbers = [&[f64::NAN; 6][..], &ball, &[f64::NAN; 12]].concat();
    let svg = svg(&animation(shapes, &numbers));
    assert_eq!([0, 1, 2].map(|k| drawn(&svg, "polygon", COLOURS[k]).len()), [0, 1, 0]);
    assert!(!svg.contains("NaN"));
}

#[test]
fn a_shadow_is_what_is_seen_from_above() {
    let tall = [0.0, 0.0, 5.0, 0.0, 0.0, 7.0, 1.0];
    let svg =
        svg(&animation(vec![Shape::Cylinder, Shape::Disc], &[&tall[..], &[0.0, 0.0, 3.0, 0.0, 1.0, 0.0]].concat()));
    let shadows = drawn(&svg, "polygon", SHADOW);
    let width = |points: &[(f64, f64)]| {
        points.iter().map(|p| p.0).fold(f64::MIN, f64::max) - points.iter().map(|p| p.0).fold(f64::MAX, f64::min)
    };
    let widest = shadows.iter().map(|points| width(points)).fold(0.0, f64::max);
    let rim = drawn(&svg, "polyline", COLOURS[0]).iter().map(|points| width(points)).fold(0.0, f64::max);
    assert!((widest - rim).abs() < 1.0, "{widest} {rim}");
}

#[test]
fn a_model_with_z_down_is_shown_the_right_way_up() {
    // A ball 1 m above a plane at 0, where gravity is along z.
    let numbers = [0.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, -1.0, 0.5];
    for up in [[0.0, 0.0, -9.81], [0.0; 3]] {
        let shapes = vec![Shape::Plane, Shape::Sphere];
        let svg = svg(&Animation { up, ..animation(shapes, &numbers) });
        let middle = |points: &[(f64, f64)]| points.iter().map(|p| p.1).sum::<f64>() / points.len() as f64;
        let plane = middle(&drawn(&svg, "polygon", QUIET)[0]);
        let ball = middle(&drawn(&svg, "polygon", COLOURS[1])[0]);
        assert_eq!(ball < plane - 10.0, up[2] < 0.0, "{ball} {plane}");
    }
}

/// Of what comes later only the place matters that it needs.
#[test]
fn a_still_is_the_first_frame() {
    let of = |angles: [f64; 3]| {
        let frame = |(k, angle): (usize, f64)| (k as f64, vec![0.0, 0.0, angle.cos(), angle.sin()]);
        let rod = Animation::new("Rod", 2, vec![Shape::Line(2)]);
        rod.with_frames(angles.into_iter().enumerate().map(frame)).to_svg()
    };
    let (level, upright) = (0.0, std::f64::consts::FRAC_PI_2);
    assert_eq!(of([level, upright, level]), of([level, upright, upright]));
    assert_ne!(of([level, upright, level]), of([upright, level, level]));
}
