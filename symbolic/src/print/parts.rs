//! Parts of a mechanism as Rust: two functions with an arm for each part.

use super::body::{Bodies, Body, Use};
use super::function::{argument, stores};
use crate::lower::{Accelerations, Part, Program};

/// The methods `part_accelerations` and `part_energy`; those of the trait serve where there are no parts.
pub(super) fn parts(program: &Program, bodies: &Bodies<'_>) -> String {
    let Accelerations::Unrolled { values, pivots } = &program.accelerations else { return String::new() };
    if program.parts.is_empty() {
        return String::new();
    }
    let accelerations = |part: &Part| {
        let own = pivots.iter().filter(|pivot| part.coordinates.contains(&pivot.0));
        let tested = own.map(|(k, pivot, diagonal)| Use::Pivot(*k, *pivot, *diagonal));
        tested.chain(part.coordinates.iter().map(|i| Use::Store(format!("out[{i}]"), values[*i]))).collect()
    };
    let energy = |part: &Part| stores("out", &part.energy);
    let n = program.model.coordinates.len();
    let target = format!(", out: &mut [S; {n}]");
    let singular = "::core::result::Result<(), ::dalembert::mechanism::SingularMass>";
    let before = "        let mut out = [S::ratio(0.0, 1.0); 5];\n";
    method(
        program,
        bodies,
        ("part_accelerations", &target, singular),
        ("", "::core::result::Result::Ok(())"),
        accelerations,
    ) + &method(program, bodies, ("part_energy", "", "[S; 5]"), (before, "out"), energy)
}

fn method(
    program: &Program,
    bodies: &Bodies<'_>,
    (name, target, result): (&str, &str, &str),
    (before, after): (&str, &str),
    uses: impl Fn(&Part) -> Vec<Use>,
) -> String {
    let arms: Vec<Body> = program.parts.iter().map(|part| bodies.body(&uses(part), "                ")).collect();
    let reads = |read: fn(&Body) -> bool| arms.iter().any(read);
    let state = format!("&[S; {}]", program.model.coordinates.len());
    let arguments = [
        argument("c", "&Self::Constants<S>", reads(|body| body.reads.constants)),
        argument("index", "usize", true),
        argument("t", "S", reads(|body| body.reads.time)),
        argument("u", "&[S]", reads(|body| body.reads.inputs)),
        argument("q", &state, reads(|body| body.reads.state[0])),
        argument("v", &state, reads(|body| body.reads.state[1])),
    ];
    let arm = |(k, body): (usize, &Body)| format!("            {k} => {{\n{}            }}\n", body.lines);
    let text: String = arms.iter().enumerate().map(arm).collect();
    format!(
        "\n    fn {name}<S: ::dalembert::mechanism::Real>({}{target}) -> {result} {{\n{before}        match index {{\n{text}            _ => (),\n        }}\n        {after}\n    }}\n",
        arguments.join(", ")
    )
}
