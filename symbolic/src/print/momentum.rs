//! Systems of momentum balances as Rust: a function for each, which writes A and b.

use std::fmt::Write;

use super::body::{Bodies, Use};
use super::names::balances_function;
use crate::lower::{MomentumSystem, Program};

/// How many numbers hold the largest system: A, b, and the scales of its columns.
pub(super) fn block(program: &Program) -> usize {
    program.momentum.iter().map(|s| s.right.len() * (s.right.len() + 2)).max().unwrap_or(0)
}

/// The method `balances`, with a function for every system inside.
pub(super) fn balances(out: &mut String, program: &Program, bodies: &Bodies<'_>, constants: usize) {
    let n = program.model.coordinates.len();
    let mut names: Vec<String> = Vec::new();
    let (mut functions, mut arms) = (String::new(), String::new());
    for (k, system) in program.momentum.iter().enumerate() {
        let mut name = balances_function(&system.name);
        while names.contains(&name) {
            name.push('_');
        }
        functions += &function(system, bodies, &name, (n, constants));
        let _ = writeln!(arms, "            {k} => {name}(c, t, u, q, v, matrix, right),");
        names.push(name);
    }
    let _ = write!(
        out,
        "
    fn balances<S: ::dalembert::mechanism::Real>(c: &Self::Constants<S>, system: usize, t: S, u: &[S], q: &[S; {n}], v: &[S; {n}], matrix: &mut [S], right: &mut [S]) {{
        let _ = (c, t, u, q, v, &matrix, &right);
{functions}        match system {{
{arms}            _ => (),
        }}
    }}
"
    );
}

fn function(system: &MomentumSystem, bodies: &Bodies<'_>, name: &str, (n, constants): (usize, usize)) -> String {
    let size = system.right.len();
    let matrix = system.matrix.iter().map(|(i, j, a)| Use::Store(format!("matrix[{}]", i * size + j), *a));
    let right = system.right.iter().enumerate().map(|(i, b)| Use::Store(format!("right[{i}]"), *b));
    let body = bodies.body(&matrix.chain(right).collect::<Vec<_>>(), "            ");
    let equations: Vec<String> = system.equations.iter().map(|(words, _)| words.clone()).collect();
    format!(
        "        // Equations: {}.  Unknowns: {}.  {} operations.
        fn {name}<S: ::dalembert::mechanism::Real>(c: &[S; {constants}], t: S, u: &[S], q: &[S; {n}], v: &[S; {n}], matrix: &mut [S], right: &mut [S]) {{
            let _ = (c, t, u, q, v);
            matrix.fill(S::ratio(0.0, 1.0));
{body}        }}
",
        equations.join(", "),
        system.unknowns.join(", "),
        system.operations
    )
}
