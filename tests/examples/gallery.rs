//! The library in pictures: `cargo run --release -p dalembert-tests --example gallery > docs/gallery.md` writes the page, one
//! picture a model, into `docs/gallery`; with a file's name, `-- sheet.svg`, all pictures of all models on one sheet, to be
//! looked at: motions of every scene, and modes.

use std::fmt::Write;

use dalembert::Run;
use dalembert::linear::{Guess, draw_modes, equilibrium_near, linearise};
use dalembert::show::{Chart, Figure};
use dalembert_tests::case::Case;

/// A curve of the page has no more points.
const POINTS: usize = 400;
/// Pictures side by side on the sheet, and their width and greatest height, px.
const COLUMNS: usize = 8;
const WIDTH: usize = 430;
const TALLEST: usize = 560;

fn main() {
    match std::env::args().nth(1) {
        Some(path) => std::fs::write(path, sheet(&pictures())).expect("a file"),
        None => page(),
    }
}

fn page() {
    std::fs::create_dir_all("docs/gallery").expect("a folder");
    println!("# The library in pictures\n");
    println!(
        "Each model's first scene, drawn as `simulate NAME --plot FILE.svg` does it (there with more below). Regenerate:"
    );
    println!("`cargo run --release -p dalembert-tests --example gallery > docs/gallery.md`.");
    for entry in dalembert_models::MODELS {
        let mut case = Case::new(entry.name);
        let about = case.system.description().about.to_string();
        let chart = first_chart(&case.run());
        std::fs::write(format!("docs/gallery/{}.svg", entry.name), chart.to_svg()).expect("a file");
        println!("\n## {0}\n\n{about}\n\n![{0}](gallery/{0}.svg)", entry.name);
        // Of some the book has a picture that moves.
        let moving = format!("book/src/pictures/{}.gif", entry.name);
        if std::path::Path::new("docs").join(&moving).exists() {
            println!("\n![{} in motion]({moving})", entry.name);
        }
    }
}

/// The first chart of a run's figure in which something changes, thinned.
fn first_chart(run: &Run) -> Chart {
    let mut charts = run.figure().charts;
    let changes = |chart: &Chart| {
        chart.series.iter().any(|series| {
            let mut heights = series.points.iter().flatten().map(|point| point.1);
            let first = heights.next();
            heights.any(|height| Some(height) != first)
        })
    };
    let first = charts.iter().position(changes).unwrap_or(0);
    let mut chart = charts.swap_remove(first);
    for series in &mut chart.series {
        let stride = series.points.len().div_ceil(POINTS).max(1);
        let last = series.points.last().copied();
        series.points = series.points.iter().step_by(stride).copied().chain(last).collect();
    }
    chart
}

/// (title, SVG) of every motion and of all modes.
fn pictures() -> Vec<(String, String)> {
    let mut pictures = Vec::new();
    for entry in dalembert_models::MODELS {
        for scene in Case::new(entry.name).system.description().scenes.iter() {
            match Case::new(entry.name).scene(scene).try_run() {
                Ok(run) => pictures.push((format!("{}, {scene}", entry.name), run.to_svg())),
                Err(error) => eprintln!("{}, {scene}: {error}", entry.name),
            }
        }
        // Not every mechanism has an equilibrium, or an unconstrained one.
        if let Some(figure) = modes(entry.name) {
            pictures.push((format!("{}, modes", entry.name), figure.to_svg()));
        }
    }
    pictures
}

fn modes(model: &str) -> Option<Figure> {
    let system = Case::new(model).system;
    if !system.active_rows().is_empty() {
        return None;
    }
    let guess = system.equilibrium_guess().unwrap_or_else(|| vec![0.0; system.len()]);
    let found = equilibrium_near(&*system, &Guess::at(&guess)).ok()?;
    let linear = linearise(&*system, &found).ok()?;
    Some(draw_modes(&*system, &linear, &linear.modes().ok()?))
}

/// All of them on one page.
fn sheet(pictures: &[(String, String)]) -> String {
    let (mut body, mut top) = (String::new(), 0);
    for row in pictures.chunks(COLUMNS) {
        let mut tallest = 0;
        for (column, (title, svg)) in row.iter().enumerate() {
            let Some((view, inner)) = parts(svg) else { continue };
            let size: Vec<f64> = view.split(' ').filter_map(|number| number.parse().ok()).collect();
            let height = ((WIDTH as f64 * size[3] / size[2]) as usize).min(TALLEST);
            tallest = tallest.max(height);
            let left = column * WIDTH;
            let _ = write!(
                body,
                "<text x=\"{}\" y=\"{}\" font-size=\"13\">{title}</text><svg x=\"{left}\" y=\"{}\" width=\"{}\" height=\"{height}\" \
                 viewBox=\"{view}\" preserveAspectRatio=\"xMinYMin meet\">{inner}</svg>",
                left + 8,
                top + 14,
                top + 18,
                WIDTH - 8
            );
        }
        top += tallest + 24;
    }
    format!(
        "<svg width=\"{0}\" height=\"{top}\" viewBox=\"0 0 {0} {top}\" xmlns=\"http://www.w3.org/2000/svg\">\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>{body}</svg>\n",
        COLUMNS * WIDTH
    )
}

/// The `viewBox` of a picture, and what stands inside.
fn parts(svg: &str) -> Option<(&str, &str)> {
    let view = svg.split("viewBox=\"").nth(1)?.split('"').next()?;
    let inner = svg.split_once('>')?.1;
    Some((view, inner.rsplit_once("</svg>")?.0))
}
