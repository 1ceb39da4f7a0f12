//! `fmu_description.h`: a model's sizes, start and events as tables for the C that all FMUs share.

use std::fmt::Write;

use dalembert_symbolic::derive::SwitchKind;
use dalembert_symbolic::expr::Symbol;
use dalembert_symbolic::lower::{InputJump, Program, Rate};
use dalembert_symbolic::model::{EventAction, Target, Trigger};
use dalembert_symbolic::print::{CText, c_float};

use super::description::Start;

/// What the shared C expects.
const TYPES: &str = "
/* What makes an event happen, and what it does. */
enum { ZERO, TICK, SET };
enum { STOP, RECORD, ENTER, PUT, IMPACT };

/* ENTER: first is the phase; PUT: values from first on, so many; IMPACT: rows likewise, and a coefficient of restitution. */
typedef struct {
    int kind, first, count, restitution;
} action;

typedef struct {
    int direction, trigger, clock, first, count;
    int acts;  /* whether it changes the phase or speeds */
    int named; /* whether it names phases */
    int rated; /* whether its rate is known */
    char phases[PHASES ? PHASES : 1], watched[MEMORY ? MEMORY : 1];
} event;

";

/// The text of `fmu_description.h`.
pub fn tables(program: &Program, code: &CText, start: &Start) -> String {
    let (model, name) = (&program.model, &code.prefix);
    let guard = name.to_uppercase();
    let mut out =
        format!("#include \"{name}.h\"\n\n#define MODEL(name) {name}_##name\n#define TOKEN \"{}\"\n", start.token);
    // Preprocessor conditions ask for some of these.
    for (size, value) in [
        ("ROWS", program.constraints.len()),
        ("START_PHASE", start.phase),
        ("COORDINATES", model.coordinates.len()),
        ("INPUTS", model.inputs.len()),
        ("SLOPES", usize::from(code.has_slopes)),
    ] {
        let _ = writeln!(out, "#define {size} {value}");
    }
    let _ = writeln!(
        out,
        "#define TOLERANCE {}\n#define SPAN {}\n#define DRIFT 1e-9\n\nenum {{\n    MECHANICAL = {},",
        c_float(start.tolerance),
        c_float(start.span),
        model.mechanical()
    );
    for size in [
        "PARAMETERS",
        "MEMORY",
        "PHASES",
        "OUTPUTS",
        "EVENTS",
        "MODES",
        "ASSIGNMENTS",
        "RESTITUTIONS",
        "CLOCKS",
        "CONSTANTS",
        "DIRECTION",
    ] {
        let _ = writeln!(out, "    {size} = {guard}_{size},");
    }
    out += "};\n";
    out += TYPES;
    let numbers = |list: &[f64]| list.iter().map(|x| c_float(*x)).collect::<Vec<_>>();
    let nominal = vec![1.0; model.mechanical() + model.coordinates.len()];
    for (array, list) in [
        ("start_parameters", &start.parameters),
        ("start_q", &start.q),
        ("start_v", &start.v),
        ("start_memory", &start.memory),
        ("nominal", &nominal),
    ] {
        out += &array_of("double", array, &numbers(list));
    }
    let holonomic = model.constraints.iter().flat_map(|c| vec![u8::from(c.holonomic).to_string(); c.value.len()]);
    out += &array_of("char", "is_holonomic", &holonomic.collect::<Vec<_>>());
    let is_step = program.switches.iter().map(|switch| u8::from(switch.kind == SwitchKind::Step).to_string());
    out += &array_of("char", "is_step", &is_step.collect::<Vec<_>>());
    let targets = model.sets.iter().flat_map(|set| &set.values).map(|(target, _)| match target {
        Target::Memory(k) => k.to_string(),
        Target::State(k) => format!("-{}", 1 + model.mechanical() + k),
    });
    out += &array_of("int", "targets", &targets.collect::<Vec<_>>());
    let fixed = (0..model.parameters.len()).map(|k| u8::from(is_of_ticks(program, k)).to_string());
    out += &array_of("char", "is_fixed", &fixed.collect::<Vec<_>>());
    let moves = (0..model.inputs.len()).map(|k| u8::from(moves_bodies(program, k)).to_string());
    out += &array_of("char", "moves_bodies", &moves.collect::<Vec<_>>());
    let quoted = |name: &String| format!("\"{name}\"");
    let names: Vec<String> = model.inputs.iter().map(|input| quoted(&input.name)).collect();
    out += &array_of("char *const", "input_names", &names);
    let names: Vec<String> = model.coordinates.iter().map(|coordinate| quoted(&coordinate.name)).collect();
    out += &array_of("char *const", "coordinate_names", &names);
    out + &events(program)
}

/// Whether ticks happen at times of this parameter.
pub fn is_of_ticks(program: &Program, parameter: usize) -> bool {
    let symbols = program.model.graph.symbols(program.clock_numbers());
    symbols.contains(&Symbol::Parameter(parameter as u32))
}

/// Whether a jump of an input would need an infinite force: it moves bodies or constraints, or what it does depends on how it jumps.
fn moves_bodies(program: &Program, input: usize) -> bool {
    let constraints = program.model.constraints.iter().filter(|constraint| constraint.holonomic);
    let places = program.model.graph.symbols(constraints.flat_map(|constraint| constraint.value.iter().copied()));
    program.jumps[input] == InputJump::Refused || places.contains(&Symbol::Input(input as u32, 0))
}

/// An array; of one 0 where there is nothing.
fn array_of(kind: &str, name: &str, values: &[String]) -> String {
    let values = if values.is_empty() { "0".to_owned() } else { values.join(", ") };
    // Not every file of the shared C reads all of them.
    format!("static const {kind} {name}[] = {{{values}}};\n")
}

fn events(program: &Program) -> String {
    let model = &program.model;
    let (mut actions, mut events, mut impacts) = (Vec::new(), Vec::new(), 0);
    for (event, rate) in model.events.iter().zip(&program.event_rates) {
        let first = actions.len();
        for action in &event.actions {
            actions.push(match action {
                EventAction::Stop | EventAction::Contact(_) => "{STOP, 0, 0, 0}".to_owned(),
                EventAction::Record => "{RECORD, 0, 0, 0}".to_owned(),
                EventAction::Phase(k) => format!("{{ENTER, {k}, 0, 0}}"),
                EventAction::Set(k) => {
                    let before: usize = model.sets[..*k].iter().map(|set| set.values.len()).sum();
                    format!("{{PUT, {before}, {}, 0}}", model.sets[*k].values.len())
                }
                EventAction::Impact { along, .. } => {
                    impacts += 1;
                    let along = &model.constraints[*along];
                    format!("{{IMPACT, {}, {}, {}}}", along.first, along.value.len(), impacts - 1)
                }
            });
        }
        let (trigger, clock) = match &event.trigger {
            Trigger::Zero => ("ZERO", 0),
            Trigger::Tick(clock) => ("TICK", *clock),
            Trigger::Set(_) => ("SET", 0),
        };
        let watched = |k: usize| matches!(&event.trigger, Trigger::Set(held) if held.contains(&k));
        let flags = |count: usize, of: &dyn Fn(usize) -> bool| {
            (0..count.max(1)).map(|k| u8::from(of(k)).to_string()).collect::<Vec<_>>().join(", ")
        };
        let acts = event.actions.iter().any(|a| matches!(a, EventAction::Phase(_) | EventAction::Impact { .. }));
        events.push(format!(
            "{{{}, {trigger}, {clock}, {first}, {}, {}, {}, {}, {{{}}}, {{{}}}}}",
            event.direction,
            event.actions.len(),
            u8::from(acts),
            u8::from(event.phases.is_some()),
            u8::from(matches!(rate, Rate::Whole(_))),
            flags(program.phases(), &|k| event.phases.as_ref().is_none_or(|phases| phases.contains(&k))),
            flags(model.memory.len(), &watched),
        ));
    }
    let none = |list: Vec<String>| if list.is_empty() { vec!["{0}".to_owned()] } else { list };
    array_of("action", "actions", &none(actions)) + &array_of("event", "events", &none(events))
}
