//! Shapes in space from a file to its pictures, compiled and interpreted.

use dalembert::mechanism::{Interpreted, Shape};
use dalembert::prelude::*;
use dalembert_symbolic::lower::compile;

dalembert::model!("solids/shapes.yaml", name = Shapes);

const SOURCE: &str = include_str!("../solids/shapes.yaml");

#[test]
fn compiled_and_interpreted_files_draw_the_same() {
    let interpreted = Interpreted::new(compile(SOURCE, &[]).expect("the file compiles"), SOURCE);
    let model = Shapes::default().system();
    let (one, other) = (model.description(), interpreted.description());
    assert_eq!((&one.draw, one.gravity), (&other.draw, other.gravity));
    assert_eq!(one.gravity, [0.0, 0.0, 9.81]);
    assert_eq!(one.draw.iter().filter(|shape| **shape == Shape::Sphere).count(), 3);
    let at = At::new(0.0, &[0.3, 0.4], &[0.0, 0.0]);
    let mut numbers = [vec![0.0; one.drawing_len()], vec![0.0; other.drawing_len()]];
    model.drawing(at, &mut numbers[0]);
    interpreted.drawing(at, &mut numbers[1]);
    let [one, other] = numbers;
    assert!(one.len() == other.len() && one.iter().zip(&other).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn a_run_is_drawn_with_its_solids() {
    let run = Shapes::default().simulate().run().expect("a run");
    let page = run.animation().to_html();
    for kind in ["ring", "disc", "cylinder", "sphere", "box", "ellipsoid", "plane", "axes"] {
        assert!(page.contains(&format!("[\"{kind}\",")), "{kind}");
    }
    // The path of the trace has its own numbers among those of the solids.
    let chart = &run.figure().charts[0];
    assert_eq!((chart.series.len(), chart.series[0].points[0]), (1, Some((0.0, 0.0))));
}
