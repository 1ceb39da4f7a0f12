//! Systems of momentum balances as Rust: a function for each, which writes A and b.

use std::fmt::Write;

use super::body::{Bodies, Use};
use super::function::{Function, Target, argument, stores};
use super::words::comment;
use crate::lower::{MomentumSystem, Program};

/// How many numbers hold the largest system: A, b, and the scales of its columns.
pub(super) fn block(program: &Program) -> usize {
    program.momentum.iter().map(|s| s.right.len() * (s.right.len() + 2)).max().unwrap_or(0)
}

/// The method `balances`, with a function for every system inside.
pub(super) fn balances(program: &Program, bodies: &Bodies<'_>, block: usize) -> String {
    let n = program.model.coordinates.len();
    let (mut functions, mut arms) = (String::new(), String::new());
    for (k, (system, name)) in program.momentum.iter().zip(&bodies.names.balances).enumerate() {
        functions += &function(system, bodies, name, &format!("[S; {block}]"));
        let _ = writeln!(arms, "            {k} => {name}(c, t, u, q, v, matrix, right),");
    }
    let used = !program.momentum.is_empty();
    let state = format!("&[S; {n}]");
    let arguments = [
        ("c", "&Self::Constants<S>"),
        ("system", "usize"),
        ("t", "S"),
        ("u", "&[S]"),
        ("q", &state),
        ("v", &state),
        ("matrix", "&mut [S]"),
        ("right", "&mut [S]"),
    ];
    let arguments: Vec<String> = arguments.iter().map(|(name, kind)| argument(name, kind, used)).collect();
    let body = if used {
        format!("{functions}        match system {{\n{arms}            _ => (),\n        }}\n")
    } else {
        String::new()
    };
    format!("\n    fn balances<S: ::dalembert::mechanism::Real>({}) {{\n{body}    }}\n", arguments.join(", "))
}

fn function(system: &MomentumSystem, bodies: &Bodies<'_>, name: &str, constants: &str) -> String {
    let size = system.right.len();
    let matrix = system.matrix.iter().map(|(i, j, a)| Use::Store(format!("matrix[{}]", i * size + j), *a));
    let equations: Vec<&str> = system.equations.iter().map(|(words, _)| words.as_str()).collect();
    let words = format!(
        "Equations: {}.  Unknowns: {}.  {} operations.",
        equations.join(", "),
        system.unknowns.join(", "),
        system.operations
    );
    let slice = |name| Target { name, kind: "&mut [S]".to_owned(), used: true };
    let function = Function {
        name,
        constants,
        state: 2,
        targets: vec![slice("matrix"), slice("right")],
        before: "matrix.fill(S::ratio(0.0, 1.0));".to_owned(),
        uses: matrix.chain(stores("right", &system.right)).collect(),
        ..Function::default()
    };
    format!("\n{}{}", comment(&words, "        "), function.text(bodies, "        ").trim_start_matches('\n'))
}
