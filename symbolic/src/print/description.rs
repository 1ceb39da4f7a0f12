//! The static description of a mechanism, as a Rust literal.

use std::fmt::Write;

use super::literal::float;
use super::{si_unit, words};
use crate::derive::{Switch, SwitchKind, without_modes};
use crate::expr::{Id, Symbol};
use crate::lower::{Argument, Entry, Program, Rate, Role, Watched};
use crate::model::{EventAction, Phase, Shape, text_in};

/// `static DESCRIPTION: … = …;`
pub(super) fn description(program: &Program, source: &str) -> String {
    let model = &program.model;
    let mut out = String::new();
    let mut field = |name: &str, value: String| {
        let _ = writeln!(out, "            {name}: {value},");
    };
    let unit = |unit: &Option<String>| string(&unit.as_deref().map(si_unit).unwrap_or_default());
    field("name", string(&model.name));
    field("about", string(&model.about));
    field("source_hash", format!("{:#018x}", fnv1a(source)));
    field(
        "coordinates",
        list(
            model
                .coordinates
                .iter()
                .zip(model.units_of_coordinates())
                .map(|(c, of)| format!("mechanism::Coordinate {{ name: {}, unit: {} }}", string(&c.name), unit(of))),
        ),
    );
    field("rotations", list(model.rotations.iter().map(|rotation| rotation.first.to_string())));
    field(
        "parameters",
        list(model.parameters.iter().map(|p| {
            format!(
                "mechanism::Parameter {{ name: {}, unit: {}, default: {} }}",
                string(&p.name),
                unit(&p.unit),
                float(p.default)
            )
        })),
    );
    let tables = program.tables().into_iter().map(|table| {
        let pieces = table.pieces().iter().map(|piece| format!("[{}]", piece.map(float).join(", ")));
        format!(
            "mechanism::Table {{ name: {}, knots: {}, pieces: {}, period: {}, rise: {} }}",
            string(table.name()),
            list(table.knots().iter().map(|knot| float(*knot))),
            list(pieces),
            match table.period() {
                None => "::core::option::Option::None".to_owned(),
                Some(period) => format!("::core::option::Option::Some({})", float(period)),
            },
            float(table.rise())
        )
    });
    field("tables", list(tables));
    let integrals = model.integrals.iter().map(|tried| {
        let ranges = tried.ranges.iter().filter_map(|(symbol, [low, high])| {
            let of = match symbol {
                Symbol::Parameter(k) => format!("Parameter({k})"),
                Symbol::Coordinate(k) => format!("Coordinate({k})"),
                Symbol::Speed(k) => format!("Speed({k})"),
                Symbol::Time => "Time".to_owned(),
                _ => return None,
            };
            Some(format!("(mechanism::Tried::{of}, [{}, {}])", float(*low), float(*high)))
        });
        format!("mechanism::Integral {{ text: {}, ranges: {} }}", string(&tried.words), list(ranges))
    });
    field("integrals", list(integrals));
    field("derived", list(model.derived.iter().map(|d| string(&d.name))));
    field("inputs", list(model.inputs.iter().map(|u| string(&u.name))));
    field("mass_pattern", pattern(&program.mass));
    field("stiffness_pattern", pattern(&program.stiffness));
    field("damping_pattern", pattern(&program.damping));
    field("input_pattern", pattern(&program.input));
    field("time_pattern", list(program.time.iter().map(|e| e.0.to_string())));
    field("timed_switches", list(program.timed_switches.iter().map(ToString::to_string)));
    field(
        "rows",
        list(model.constraints.iter().enumerate().flat_map(|(k, c)| {
            c.row_names().into_iter().zip(c.first..).map(move |(name, row)| {
                let with = program.constraints.with[row].iter();
                format!(
                    "mechanism::Row {{ name: {}, unit: {}, holonomic: {}, integral: {}, with: {}, constraint: {k} }}",
                    string(&name),
                    string(&c.unit.as_deref().map(si_unit).unwrap_or_default()),
                    c.holonomic,
                    program.constraints.integral[row],
                    list(with.map(|(row, factor)| format!("({row}, {})", float(*factor)))),
                )
            })
        })),
    );
    let phase = |(k, phase): (usize, &Phase)| {
        let rows = list(program.model.rows_of(phase).into_iter().map(|row| row.to_string()));
        format!("mechanism::Phase {{ name: {}, rows: {rows}, rank: {} }}", string(&phase.name), program.rank_of(k))
    };
    field("phases", list(model.phases.iter().enumerate().map(phase)));
    field("constraint_pattern", pattern(&program.constraints.matrix));
    field("friction_pattern", pattern(&program.constraints.friction));
    field("constraint_stiffness_pattern", pattern(&program.constraints.stiffness));
    field("constraint_damping_pattern", pattern(&program.constraints.damping));
    field("constraint_rate_pattern", pattern(&program.constraints.rate_jacobian));
    let quantity = |name: &str, components: usize, of: &Option<String>| {
        format!("mechanism::Quantity {{ name: {}, components: {components}, unit: {} }}", string(name), unit(of))
    };
    field("outputs", list(model.outputs.iter().map(|o| quantity(&o.name, o.value.len(), &o.unit))));
    field("outputs_use_accelerations", program.outputs_use_accelerations().to_string());
    field("outputs_of_reactions", list(program.outputs_of_reactions().map(|place| place.to_string())));
    field("events_use_accelerations", program.events_use_accelerations().to_string());
    field("invariants", list(model.conserved.iter().map(|c| quantity(&c.name, c.value.len(), &None))));
    let mut impacts = 0;
    field(
        "events",
        list(model.events.iter().zip(&program.event_rates).map(|(e, rate)| {
            let direction = match e.direction {
                1 => "Rising",
                -1 => "Falling",
                _ => "Both",
            };
            let phases = match &e.phases {
                None => "::core::option::Option::None".to_owned(),
                Some(phases) => {
                    format!("::core::option::Option::Some({})", list(phases.iter().map(ToString::to_string)))
                }
            };
            let actions = list(e.actions.iter().map(|a| match a {
                EventAction::Stop => "mechanism::Action::Stop".to_owned(),
                EventAction::Record => "mechanism::Action::Record".to_owned(),
                EventAction::Phase(k) => format!("mechanism::Action::Phase({k})"),
                EventAction::Set(k) => format!("mechanism::Action::Set({k})"),
                EventAction::Contact(k) => format!("mechanism::Action::Contact({k})"),
                EventAction::Impact { along, .. } => {
                    impacts += 1;
                    format!("mechanism::Action::Impact {{ along: {along}, restitution: {} }}", impacts - 1)
                }
            }));
            format!(
                "mechanism::Event {{ name: {}, direction: mechanism::Direction::{direction}, conditional: {}, phases: {phases}, actions: {actions}, rated: {} }}",
                string(&e.name),
                e.condition.is_some(),
                match rate {
                    Rate::Whole(_) => "mechanism::Rated::Whole",
                    Rate::Held(_) => "mechanism::Rated::Held",
                    Rate::Unknown => "mechanism::Rated::Unknown",
                }
            )
        })),
    );
    field(
        "switches",
        list(program.switches.iter().zip(switch_texts(program, &program.switches)).map(|(s, text)| {
            let kind = if s.kind == SwitchKind::Sign { "Sign" } else { "Step" };
            format!(
                "mechanism::Switch {{ text: {}, kind: mechanism::SwitchKind::{kind}, time_only: {}, of_input: {} }}",
                string(&text),
                s.time_only,
                s.of_input
            )
        })),
    );
    field("arguments", list(program.arguments.iter().map(argument)));
    field("input_jumps", list(program.jumps.iter().map(|jump| format!("mechanism::InputJump::{jump:?}"))));
    field("scenes", list(model.scenes.iter().map(|s| string(&s.name))));
    field(
        "draw",
        list(model.draw.iter().map(|shape| match shape {
            Shape::Line(points) => format!("mechanism::Shape::Line({})", points.len()),
            Shape::Circle { .. } => "mechanism::Shape::Circle".to_owned(),
            Shape::Spring(..) => "mechanism::Shape::Spring".to_owned(),
            Shape::Curve(points) => format!("mechanism::Shape::Curve({})", points.len()),
            Shape::Trace(name, _) => format!("mechanism::Shape::Trace({})", string(name)),
            Shape::Solid(kind, _) => format!("mechanism::Shape::{kind:?}"),
        })),
    );
    field("gravity", format!("[{}]", model.usual_gravity.map(float).join(", ")));
    field(
        "balances",
        list(program.momentum.iter().map(|s| {
            let equations = list(s.equations.iter().map(|(words, void)| {
                format!("mechanism::Balance {{ name: {}, void_at_rest: {void} }}", string(words))
            }));
            let pairs = list(s.outputs.iter().map(|(output, unknown)| format!("({output}, {unknown})")));
            let unknowns = list(s.unknowns.iter().map(|u| string(u)));
            let phases = list(s.phases.iter().map(ToString::to_string));
            format!(
                "mechanism::BalanceSystem {{ name: {}, phases: {phases}, unknowns: {unknowns}, equations: {equations}, nonzeros: {}, operations: {}, outputs: {pairs} }}",
                string(&s.name),
                s.matrix.len(),
                s.operations,
            )
        })),
    );
    let s = &program.structure;
    field(
        "structure",
        format!(
            "mechanism::Structure {{ dimension: {}, constant_mass: {}, constant_inertias: {}, diagonal_mass: {}, mass_blocks: {}, separable: {}, linear: {}, conservative: {}, time_dependent: {}, uniformly_accelerated: {}, cyclic: {} }}",
            model.dimension,
            s.constant_mass,
            s.constant_inertias,
            s.diagonal_mass,
            list(s.mass_blocks.iter().map(ToString::to_string)),
            s.separable,
            s.linear,
            s.conservative,
            s.time_dependent,
            s.uniformly_accelerated,
            list(s.cyclic.iter().map(|c| c.0.to_string())),
        ),
    );
    field(
        "parts",
        list(program.parts.iter().map(|part| {
            let places = |list: &[usize]| self::list(list.iter().map(ToString::to_string));
            format!(
                "mechanism::Part {{ coordinates: {}, linear: {}, separable: {}, time_dependent: {}, conservative: {}, arguments: {}, events: {}, accelerations: {} }}",
                places(&part.coordinates),
                part.linear,
                part.separable,
                part.time_dependent,
                part.is_conservative(),
                places(&part.arguments),
                places(&part.events),
                part.operations,
            )
        })),
    );
    let c = program.counts;
    field(
        "counts",
        format!(
            "mechanism::Counts {{ mass: {}, bias: {}, mass_and_bias: {}, accelerations: {}, residual: {}, jacobians: {} }}",
            c.mass, c.bias, c.mass_and_bias, c.accelerations, c.residual, c.jacobians
        ),
    );
    out
}

/// A switch's argument in the file's words: with functions in the place of modes.
pub fn switch_text(program: &Program, switch: &Switch) -> String {
    switch_texts(program, std::slice::from_ref(switch)).concat()
}

/// The arguments of several, whose modes are replaced in one go.
fn switch_texts(program: &Program, switches: &[Switch]) -> Vec<String> {
    let arguments: Vec<Id> = switches.iter().map(|switch| switch.argument).collect();
    let nested = program.model.graph.symbols(arguments.iter().copied()).iter().any(|s| matches!(s, Symbol::Mode(_)));
    if !nested {
        return arguments.iter().map(|id| text_in(&program.model.graph, &program.model, *id)).collect();
    }
    let mut graph = program.model.graph.clone();
    let plain = without_modes(&mut graph, &arguments, &program.switches);
    plain.into_iter().map(|id| text_in(&graph, &program.model, id)).collect()
}

fn argument(argument: &Argument) -> String {
    let of = match argument.of {
        Watched::Event(k) => format!("mechanism::Watched::Event({k})"),
        Watched::Switch(k) => format!("mechanism::Watched::Switch({k})"),
        Watched::Motion => "mechanism::Watched::Motion".to_owned(),
        Watched::Argument(k) => format!("mechanism::Watched::Argument({k})"),
    };
    let role = match argument.role {
        Role::Power(p) => format!("mechanism::Role::Power({})", float(p)),
        role => format!("mechanism::Role::{role:?}"),
    };
    format!(
        "mechanism::Argument {{ of: {of}, role: {role}, time_only: {}, load: {}, gates: {} }}",
        argument.time_only,
        string(&argument.load),
        list(argument.gates.iter().map(ToString::to_string))
    )
}

/// FNV-1a of 64 bits (Fowler, Noll, Vo).
pub fn fnv1a(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

pub(super) fn string(text: &str) -> String {
    format!("mechanism::Text::Borrowed({})", words::string(text))
}

pub(super) fn list(items: impl Iterator<Item = String>) -> String {
    format!("mechanism::List::Borrowed(&[{}])", items.collect::<Vec<_>>().join(", "))
}

fn pattern(entries: &[Entry]) -> String {
    list(entries.iter().map(|e| format!("({}, {})", e.0, e.1)))
}
