// The table of `docs/counts.md`: operations of the n-link chain beside the floors of hand-written code.

use std::fmt::Write;

use dalembert_symbolic::lower::{Counts, compile};

/// Sizes in the table.
const SIZES: [i64; 6] = [2, 3, 5, 10, 20, 40];

/// Hand-structured code for M and h: product form in absolute angles, recursive Newton–Euler with composite
/// rigid bodies in relative angles.
const FLOORS: [[usize; 6]; 2] = [[47, 90, 181, 461, 1246, 3716], [49, 105, 243, 713, 2253, 7733]];

const ABSOLUTE: &str = include_str!("../../../models/chain.yaml");

/// The same chain in relative angles.
const RELATIVE: &str = r#"
name: RelativeChain
sizes: {n: 2}
parameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}
coordinates: {"phi[i in 1..n]": rad}
define: {I: m*l^2/12, "theta[i in 1..n]": "sum(phi[j], j in 1..i)"}
points:
  "tip[0]": [0, 0]
  "tip[i in 1..n]": "tip[i-1] + l*[sin(theta[i]), -cos(theta[i])]"
bodies:
  "bar[i in 1..n]": {mass: m, inertia: I, angle: "theta[i]", position: "(tip[i-1] + tip[i])/2"}
gravity: [0, -g]
"#;

/// Derives every size both ways and writes the table.
pub fn table() -> String {
    let mut text = String::from(
        "# Operations of the n-link chain and of the library\n\n\
         Additions, multiplications, divisions, roots, sines and cosines of the generated functions; what depends on\n\
         parameters only is computed once per run and not counted. *Floor* is hand-structured code for M and h, with its\n\
         parameter products counted. Regenerate: `cargo run --release --example counts -p dalembert-symbolic > docs/counts.md`.\n",
    );
    for (model, floors, title) in [(ABSOLUTE, FLOORS[0], "Absolute angles"), (RELATIVE, FLOORS[1], "Relative angles")] {
        let counts: Vec<Counts> = SIZES.iter().map(|&n| counts(model, &[("n".to_owned(), n)])).collect();
        let _ = write!(
            text,
            "\n## {title}\n\n| n | M | h | M and h | floor | F | F and Jacobians | accelerations |\n| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n"
        );
        for ((n, c), floor) in SIZES.iter().zip(&counts).zip(floors) {
            let _ = writeln!(
                text,
                "| {n} | {} | {} | {} | {floor} | {} | {} | {} |",
                c.mass, c.bias, c.mass_and_bias, c.residual, c.jacobians, c.accelerations
            );
        }
        let growth = |of: fn(&Counts) -> usize| (of(&counts[5]) as f64 / of(&counts[4]) as f64).log2();
        let _ = writeln!(
            text,
            "\nGrowth exponents from n = 20 to 40: M and h {:.2}, h {:.2}.",
            growth(|c| c.mass_and_bias),
            growth(|c| c.bias)
        );
    }
    text += "\n## The library\n\n| model | M | h | M and h | F | F and Jacobians | accelerations |\n\
             | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for (name, source) in library() {
        let Counts { mass, bias, mass_and_bias, residual, jacobians, accelerations } = counts(&source, &[]);
        let _ = writeln!(
            text,
            "| `{name}` | {mass} | {bias} | {mass_and_bias} | {residual} | {jacobians} | {accelerations} |"
        );
    }
    text
}

fn library() -> Vec<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");
    let files = std::fs::read_dir(folder).expect("the folder of models").filter_map(Result::ok);
    let paths = files.map(|file| file.path()).filter(|path| path.extension().is_some_and(|e| e == "yaml"));
    let mut models: Vec<(String, String)> = paths
        .map(|path| {
            let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            (name, std::fs::read_to_string(path).expect("a model of the library"))
        })
        .collect();
    models.sort();
    models
}

/// Of a model with these sizes.
pub fn counts(model: &str, sizes: &[(String, i64)]) -> Counts {
    match compile(model, sizes) {
        Ok(program) => program.counts,
        Err(problems) => panic!("{problems:?}"),
    }
}
