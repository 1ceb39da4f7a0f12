// The tables of `docs/derivations.md`: what Lagrange's equations and each system of balances cost.

use std::fmt::Write;

use dalembert_symbolic::expr::Id;
use dalembert_symbolic::lower::{Program, compile, operations, read_signals};

/// Sizes of the chain in the second table.
const SIZES: [i64; 5] = [2, 5, 10, 20, 40];

/// The names and texts of the model files, in order.
pub fn models() -> Vec<(String, String)> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");
    let files = std::fs::read_dir(folder).expect("the folder of models").filter_map(Result::ok);
    let mut models: Vec<(String, String)> = files
        .filter_map(|file| {
            let name = file.file_name().into_string().ok()?.strip_suffix(".yaml")?.to_owned();
            Some((name, std::fs::read_to_string(file.path()).ok()?))
        })
        .collect();
    models.sort();
    models
}

/// Derives every model and writes the page.
pub fn page() -> String {
    let mut text = String::from(
        "# What each derivation costs\n\n\
         The accelerations of a motion come from Lagrange's equations, M q'' + h = 0, or from a system of momentum balances,\n\
         A·[q''; reactions] = b (`simulate NAME --by SYSTEM`, `Simulation::derivation`). *Write* counts the additions,\n\
         multiplications, divisions, roots and functions of M and h, or of A and b, as generated. *Solve* counts what follows:\n\
         for M, LDLᵀ and two substitutions, zeros left out where they are written out; for A, which is not symmetric and may\n\
         need its rows exchanged, Gaussian elimination of the full matrix with partial pivoting and two substitutions.\n\
         Where accelerations come by elimination over shared velocities (`docs/elimination.md`), M and h are not written.\n\
         *Non-zeros* are those of A. `check NAME` lists condition numbers, `simulate NAME --by all` compares runs, and\n\
         `cargo bench -p dalembert-models` times them.\n\n\
         Regenerate: `cargo run --release --example derivations -p dalembert-symbolic > docs/derivations.md`.\n",
    );
    text += "\n## The library\n\n| model | derivation | equations | non-zeros | write | solve | total | ratio |\n";
    text += "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    for (name, source) in models() {
        lines(&mut text, &name, &program(&source, &[]));
    }
    text += "\n## The n-link chain\n\nMoments of everything below each joint, about that joint.\n\n";
    text += "| n | derivation | equations | non-zeros | write | solve | total | ratio |\n";
    text += "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
    let chain = include_str!("../../../models/chain.yaml");
    for n in SIZES {
        lines(&mut text, &n.to_string(), &program(chain, &[("n".to_owned(), n)]));
    }
    text
}

fn program(source: &str, sizes: &[(String, i64)]) -> Program {
    compile(source, sizes).unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// A line for Lagrange's equations and one for each system of balances, where there are any.
fn lines(text: &mut String, name: &str, program: &Program) {
    // With constraints the multipliers are eliminated too, which is not counted here.
    if program.momentum.is_empty() || !program.constraints.is_empty() {
        return;
    }
    let counts = program.counts;
    let n = program.model.coordinates.len();
    let total = counts.accelerations;
    let of_motion = program.mass.iter().map(|entry| entry.2).chain(program.bias.iter().copied());
    let write = counts.mass_and_bias + inputs(program, of_motion);
    let parts = match program.elimination.as_ref().and_then(|found| found.order) {
        Some(_) => format!("elimination | {n} | | | "),
        None => format!("Lagrange | {n} | | {write} | {}", total.saturating_sub(write)),
    };
    let _ = writeln!(text, "| {name} | {parts} | {total} | 1 |");
    for system in &program.momentum {
        let size = system.right.len();
        let solve = elimination(size);
        let roots = system.matrix.iter().map(|entry| entry.2).chain(system.right.iter().copied());
        let write = system.operations + inputs(program, roots);
        let sum = write + solve;
        let _ = writeln!(
            text,
            "| | {} | {size} | {} | {} | {solve} | {sum} | {:.1} |",
            system.name,
            system.matrix.len(),
            write,
            sum as f64 / total.max(1) as f64
        );
    }
}

/// Operations of the inputs that these expressions read.
fn inputs(program: &Program, roots: impl Iterator<Item = Id>) -> usize {
    let graph = &program.model.graph;
    operations(graph, &read_signals(graph, &program.signals, roots))
}

/// Scaling of rows, elimination, and both substitutions of one right-hand side.
fn elimination(n: usize) -> usize {
    let scaling = n * (n + 2);
    let forward: usize = (0..n).map(|k| (n - 1 - k) * (1 + 2 * (n - k))).sum();
    let backward: usize = (0..n).map(|k| 2 + 2 * (n - 1 - k)).sum();
    scaling + forward + backward
}
