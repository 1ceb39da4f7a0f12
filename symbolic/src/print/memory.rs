//! Held values, what sets them and when, as Rust.

use std::fmt::Write;

use super::body::Bodies;
use super::description::{list, string};
use super::function::{Function, Target, of_constants, stores};
use super::si_unit;
use crate::lower::Program;
use crate::model::{Noise, Target as Assigned, Trigger};

/// `const MEMORY`, where there is any: it is 0 in the trait.
pub(super) fn size(program: &Program) -> String {
    match program.model.memory.len() {
        0 => String::new(),
        size => format!("    const MEMORY: usize = {size};\n"),
    }
}

/// `sampling`, `held_noise` and `assignments`; those of the trait serve where nothing is held, set or sampled.
pub(super) fn memory(program: &Program, bodies: &Bodies<'_>) -> String {
    let model = &program.model;
    if model.memory.is_empty() && model.clocks.is_empty() && model.sets.is_empty() {
        return String::new();
    }
    let mut out = sampling(program) + &noise(program);
    if !program.assignments.is_empty() {
        let assignments = Function {
            name: "assignments",
            state: 3,
            targets: vec![Target { name: "out", kind: "&mut [S]".to_owned(), used: true }],
            uses: stores("out", &program.assignments),
            ..Function::default()
        };
        out += &assignments.text(bodies, "    ");
    }
    out
}

/// `scene_memory` and `clock_numbers`; those of the trait serve where nothing is held or sampled.
pub(super) fn starts(program: &Program, unhoisted: &Bodies<'_>) -> String {
    let model = &program.model;
    let mut out = String::new();
    if !model.memory.is_empty() {
        out += &scene_memory(program, unhoisted);
    }
    if !model.clocks.is_empty() {
        let clocks = of_constants(unhoisted, "values", &program.clock_numbers(), "        ");
        let _ = write!(
            out,
            "\n    fn clock_numbers<S: ::dalembert::mechanism::Real>(c: &[S]) -> ::std::vec::Vec<S> {{\n{clocks}        values(c).to_vec()\n    }}\n"
        );
    }
    out
}

/// Held values where each scene starts.
fn scene_memory(program: &Program, unhoisted: &Bodies<'_>) -> String {
    let mut arms = String::new();
    // The default scene's arm matches everything else, so it comes last.
    for place in (1..program.model.all_scenes().count()).chain([0]) {
        let arm = if place == 0 { "_".to_owned() } else { place.to_string() };
        let values = of_constants(unhoisted, "values", &program.memory_of_scene(place), "                ");
        let _ = write!(arms, "            {arm} => {{\n{values}                values(c).to_vec()\n            }}\n");
    }
    format!(
        "
    fn scene_memory<S: ::dalembert::mechanism::Real>(c: &[S], scene: usize) -> ::std::vec::Vec<S> {{
        match scene {{
{arms}        }}
    }}
"
    )
}

/// `held_noise`; that of the trait serves where there is none.
fn noise(program: &Program) -> String {
    let entry = |noise: &Noise| {
        let seed = match noise.seed {
            None => "::core::option::Option::None".to_owned(),
            Some(place) => format!("::core::option::Option::Some({place})"),
        };
        format!(
            "            mechanism::Noise {{ name: {}, seed: {seed}, event: {}, held: {} }},\n",
            string(&noise.name),
            noise.event,
            list(noise.held.iter().map(ToString::to_string))
        )
    };
    let entries: String = program.model.noise.iter().map(entry).collect();
    match entries.as_str() {
        "" => String::new(),
        entries => format!(
            "\n    fn held_noise() -> &'static [::dalembert::mechanism::Noise] {{\n        use ::dalembert::mechanism;\n        static NOISE: &[mechanism::Noise] = &[\n{entries}        ];\n        NOISE\n    }}\n"
        ),
    }
}

fn sampling(program: &Program) -> String {
    let model = &program.model;
    let memory = list(model.memory.iter().map(|held| {
        let unit = held.unit.as_deref().map(si_unit).unwrap_or_default();
        format!("mechanism::Quantity {{ name: {}, components: 1, unit: {} }}", string(&held.name), string(&unit))
    }));
    let triggers = list(model.events.iter().map(|event| match &event.trigger {
        Trigger::Zero => "mechanism::Trigger::Zero".to_owned(),
        Trigger::Tick(clock) => format!("mechanism::Trigger::Tick({clock})"),
        Trigger::Set(held) => format!("mechanism::Trigger::Set({})", list(held.iter().map(ToString::to_string))),
    }));
    let clocks = list(model.clocks.iter().map(|clock| match program.exact_clock(clock) {
        None => "mechanism::Clock { exact: ::core::option::Option::None }".to_owned(),
        Some(exact) => {
            let [from, every] = exact.map(|r| format!("({}, {})", r.numerator(), r.denominator()));
            format!("mechanism::Clock {{ exact: ::core::option::Option::Some([{from}, {every}]) }}")
        }
    }));
    let first = model.mechanical();
    let sets = list(model.sets.iter().map(|set| {
        list(set.values.iter().map(|(target, _)| match target {
            Assigned::Memory(j) => format!("mechanism::Target::Memory({j})"),
            Assigned::State(j) => format!("mechanism::Target::State({})", first + j),
        }))
    }));
    format!(
        "
    fn sampling() -> &'static ::dalembert::mechanism::Sampling {{
        use ::dalembert::mechanism;
        static SAMPLING: mechanism::Sampling = mechanism::Sampling {{
            memory: {memory},
            triggers: {triggers},
            clocks: {clocks},
            sets: {sets},
            sets_use_accelerations: {},
        }};
        &SAMPLING
    }}
",
        program.assignments_use_accelerations()
    )
}
