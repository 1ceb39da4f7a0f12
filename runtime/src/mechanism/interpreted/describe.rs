//! The description that generated code would have.

use dalembert_symbolic::derive::SwitchKind as SymbolicSwitchKind;
use dalembert_symbolic::lower::{self, Entry, MomentumSystem, Program, Rate};
use dalembert_symbolic::model::{
    EventAction, Gimbal as SymbolicGimbal, Goal as SymbolicGoal, Image, ImpactLaw as SymbolicImpactLaw,
    Motion as SymbolicMotion, Shape as SymbolicShape, Solid, Target as SymbolicTarget, Trigger as SymbolicTrigger,
};
use dalembert_symbolic::{expr, print};

use crate::mechanism::{
    Action, Argument, Balance, BalanceSystem, Clock, Closes, ClosesBy, Contact, Contacts, Coordinate, Counts,
    Description, Direction, Event, Extreme, Gimbal, Goal, ImpactLaw, InputJump, Integral, List, Motion, Noise,
    Parameter, Part, Phase, Quantity, Rated, Role, Row, Sampling, Shape, Structure, Switch, SwitchKind, Table, Target,
    Text, Tried, Trigger, Watched,
};

/// Where an integral was tried.
fn integral(tried: &dalembert_symbolic::model::Tried) -> Integral {
    let range = |(symbol, range): &(expr::Symbol, [f64; 2])| {
        let of = match *symbol {
            expr::Symbol::Parameter(k) => Tried::Parameter(k),
            expr::Symbol::Coordinate(k) => Tried::Coordinate(k),
            expr::Symbol::Speed(k) => Tried::Speed(k),
            expr::Symbol::Time => Tried::Time,
            _ => return None,
        };
        Some((of, *range))
    };
    Integral { text: Text::Owned(tried.words.clone()), ranges: tried.ranges.iter().filter_map(range).collect() }
}

/// A sequence of three angles.
pub(super) fn gimbal(gimbal: &SymbolicGimbal) -> Gimbal {
    let SymbolicGimbal { frame, coordinates, amplitude, factor, phase } = gimbal;
    Gimbal {
        frame: Text::Owned(frame.clone()),
        coordinates: coordinates.map(|k| k as u32),
        amplitude: *amplitude,
        factor: *factor,
        phase: *phase,
    }
}

/// A motion that is asked for.
pub(super) fn motion(motion: &SymbolicMotion) -> Motion {
    let text = |words: &String| Text::Owned(words.clone());
    let images = |image: &Image| -> List<(u32, bool)> {
        image.coordinates.iter().map(|(of, opposite)| (*of as u32, *opposite)).collect()
    };
    let goal = match &motion.goal {
        SymbolicGoal::Closes(closes) => Goal::Closes(Closes {
            by: match closes.event {
                Some((event, count)) => ClosesBy::Event { event: event as u32, count },
                None => ClosesBy::Part(closes.part),
            },
            period: closes.period.is_some(),
            energy: closes.energy.is_some(),
            images: images(&closes.image),
            phases: closes.image.phases.iter().map(|phase| *phase as u32).collect(),
            shifts: closes.shifts.iter().map(|coordinate| *coordinate as u32).collect(),
            turns: closes.turns.iter().map(|(coordinate, turns)| (*coordinate as u32, *turns as i32)).collect(),
            between: closes.between.as_ref().map(|ends| ends.each_ref().map(images)),
        }),
        SymbolicGoal::Meets { conditions, extreme } => Goal::Meets {
            conditions: conditions.iter().map(|(name, _)| text(name)).collect(),
            extreme: extreme
                .as_ref()
                .map(|(name, largest)| (text(name), if *largest { Extreme::Largest } else { Extreme::Smallest })),
        },
        SymbolicGoal::Fits(columns) => {
            Goal::Fits(columns.iter().map(|(name, values)| (text(name), values.clone().into())).collect())
        }
    };
    let unknowns = motion.unknowns.iter().map(|(name, _)| text(name)).collect();
    Motion { name: text(&motion.name), goal, unknowns }
}

/// Friction that may stick and contacts that may open.
pub(super) fn contacts(program: &Program) -> Contacts {
    let model = &program.model;
    let row = |constraint: Option<usize>| constraint.map(|place| model.constraints[place].first as u32);
    let contacts = model.contacts.iter().zip(program.restitutions_of_contacts());
    let all = contacts.map(|(contact, restitution)| Contact {
        name: Text::Owned(contact.name.clone()),
        normal: row(contact.normal),
        tangent: row(contact.tangent),
        direction: contact.direction.map(|place| place as u32),
        first_event: contact.first_event as u32,
        restitution: restitution.map(|place| place as u32),
    });
    let law = model.impacts.map(|law| match law {
        SymbolicImpactLaw::Sequential => ImpactLaw::Sequential,
        SymbolicImpactLaw::Together => ImpactLaw::Together,
        SymbolicImpactLaw::Poisson => ImpactLaw::Poisson,
    });
    Contacts { all: all.collect(), law }
}

/// What is held, set and sampled.
pub(super) fn sampling(program: &Program) -> Sampling {
    let model = &program.model;
    let held = model.memory.iter().map(|held| Quantity {
        name: Text::Owned(held.name.clone()),
        components: 1,
        unit: Text::Owned(held.unit.as_deref().map(print::si_unit).unwrap_or_default()),
    });
    let trigger = |event: &dalembert_symbolic::model::Event| match &event.trigger {
        SymbolicTrigger::Zero => Trigger::Zero,
        SymbolicTrigger::Tick(clock) => Trigger::Tick(*clock as u32),
        SymbolicTrigger::Set(held) => Trigger::Set(held.iter().map(|place| *place as u32).collect()),
    };
    let clocks = model.clocks.iter().map(|clock| Clock {
        exact: program.exact_clock(clock).map(|exact| exact.map(|r| (r.numerator(), r.denominator()))),
    });
    let first = model.mechanical();
    let target = |target: SymbolicTarget| match target {
        SymbolicTarget::Memory(place) => Target::Memory(place as u32),
        SymbolicTarget::State(place) => Target::State((first + place) as u32),
    };
    let sets = model.sets.iter().map(|set| set.values.iter().map(|(of, _)| target(*of)).collect::<List<Target>>());
    Sampling {
        memory: held.collect(),
        triggers: model.events.iter().map(trigger).collect(),
        clocks: clocks.collect(),
        sets: sets.collect(),
        sets_use_accelerations: program.assignments_use_accelerations(),
    }
}

fn solid(kind: Solid) -> Shape {
    match kind {
        Solid::Ring => Shape::Ring,
        Solid::Disc => Shape::Disc,
        Solid::Cylinder => Shape::Cylinder,
        Solid::Sphere => Shape::Sphere,
        Solid::Box => Shape::Box,
        Solid::Ellipsoid => Shape::Ellipsoid,
        Solid::Plane => Shape::Plane,
        Solid::Axes => Shape::Axes,
        Solid::UnitAxes => Shape::UnitAxes,
    }
}

/// Describes a program lowered from the model file with the text `source`.
pub(super) fn describe(program: &Program, source: &str) -> Description {
    let model = &program.model;
    let text = |s: &str| Text::Owned(s.to_owned());
    let unit = |u: &Option<String>| Text::Owned(u.as_deref().map(print::si_unit).unwrap_or_default());
    let pattern = |entries: &[Entry]| entries.iter().map(|e| (e.0 as u32, e.1 as u32)).collect::<List<(u32, u32)>>();
    let quantity =
        |name: &str, n: usize, of: &Option<String>| Quantity { name: text(name), components: n as u32, unit: unit(of) };
    let s = &program.structure;
    let c = program.counts;
    let n = model.coordinates.len() as u32;
    let mut impacts = 0;
    Description {
        name: text(&model.name),
        about: text(&model.about),
        source_hash: print::fnv1a(source),
        coordinates: model
            .coordinates
            .iter()
            .zip(model.units_of_coordinates())
            .map(|(c, of)| Coordinate { name: text(&c.name), unit: unit(of) })
            .collect(),
        rotations: model.rotations.iter().map(|rotation| rotation.first as u32).collect(),
        parameters: model
            .parameters
            .iter()
            .map(|p| Parameter { name: text(&p.name), unit: unit(&p.unit), default: p.default })
            .collect(),
        tables: program.tables().into_iter().map(table).collect(),
        integrals: model.integrals.iter().map(integral).collect(),
        derived: model.derived.iter().map(|d| text(&d.name)).collect(),
        inputs: model.inputs.iter().map(|u| text(&u.name)).collect(),
        mass_pattern: if program.unformed { full(n, |row| row + 1) } else { pattern(&program.mass) },
        stiffness_pattern: if program.unformed { full(n, |_| n) } else { pattern(&program.stiffness) },
        damping_pattern: if program.unformed { full(n, |_| n) } else { pattern(&program.damping) },
        input_pattern: pattern(&program.input),
        time_pattern: program.time.iter().map(|e| e.0 as u32).collect(),
        timed_switches: program.timed_switches.iter().map(|k| *k as u32).collect(),
        rows: model
            .constraints
            .iter()
            .enumerate()
            .flat_map(|(k, c)| {
                let constraints = &program.constraints;
                let row = move |(name, row): (String, usize)| Row {
                    name: Text::Owned(name),
                    unit: unit(&c.unit),
                    holonomic: c.holonomic,
                    integral: constraints.integral[row],
                    with: constraints.with[row].iter().map(|(row, factor)| (*row as u32, *factor)).collect(),
                    constraint: k as u32,
                };
                c.row_names().into_iter().zip(c.first..).map(row)
            })
            .collect(),
        phases: model
            .phases
            .iter()
            .enumerate()
            .map(|(k, phase)| Phase {
                name: text(&phase.name),
                rows: program.model.rows_of(phase).into_iter().map(|row| row as u32).collect(),
                rank: program.rank_of(k) as u32,
            })
            .collect(),
        constraint_pattern: pattern(&program.constraints.matrix),
        friction_pattern: pattern(&program.constraints.friction),
        constraint_stiffness_pattern: pattern(&program.constraints.stiffness),
        constraint_damping_pattern: pattern(&program.constraints.damping),
        constraint_rate_pattern: pattern(&program.constraints.rate_jacobian),
        outputs: model.outputs.iter().map(|o| quantity(&o.name, o.value.len(), &o.unit)).collect(),
        outputs_use_accelerations: program.outputs_use_accelerations(),
        outputs_of_reactions: program.outputs_of_reactions().map(|place| place as u32).collect(),
        events_use_accelerations: program.events_use_accelerations(),
        invariants: model.conserved.iter().map(|i| quantity(&i.name, i.value.len(), &None)).collect(),
        events: model
            .events
            .iter()
            .zip(&program.event_rates)
            .map(|(e, rate)| Event {
                name: text(&e.name),
                direction: match e.direction {
                    1 => Direction::Rising,
                    -1 => Direction::Falling,
                    _ => Direction::Both,
                },
                conditional: e.condition.is_some(),
                phases: e.phases.as_ref().map(|phases| phases.iter().map(|k| *k as u32).collect()),
                actions: e
                    .actions
                    .iter()
                    .map(|a| match a {
                        EventAction::Stop => Action::Stop,
                        EventAction::Record => Action::Record,
                        EventAction::Phase(phase) => Action::Phase(*phase as u32),
                        EventAction::Set(set) => Action::Set(*set as u32),
                        EventAction::Contact(contact) => Action::Contact(*contact as u32),
                        EventAction::Impact { along, .. } => {
                            impacts += 1;
                            Action::Impact { along: *along as u32, restitution: impacts - 1 }
                        }
                    })
                    .collect(),
                rated: match rate {
                    Rate::Whole(_) => Rated::Whole,
                    Rate::Held(_) => Rated::Held,
                    Rate::Unknown => Rated::Unknown,
                },
            })
            .collect(),
        switches: program
            .switches
            .iter()
            .map(|s| Switch {
                text: Text::Owned(print::switch_text(program, s)),
                kind: if s.kind == SymbolicSwitchKind::Sign { SwitchKind::Sign } else { SwitchKind::Step },
                time_only: s.time_only,
                of_input: s.of_input,
            })
            .collect(),
        arguments: program.arguments.iter().map(argument).collect(),
        input_jumps: program.jumps.iter().map(input_jump).collect(),
        scenes: model.scenes.iter().map(|s| text(&s.name)).collect(),
        draw: model
            .draw
            .iter()
            .map(|shape| match shape {
                SymbolicShape::Line(points) => Shape::Line(points.len() as u32),
                SymbolicShape::Circle { .. } => Shape::Circle,
                SymbolicShape::Spring(..) => Shape::Spring,
                SymbolicShape::Curve(points) => Shape::Curve(points.len() as u32),
                SymbolicShape::Trace(name, _) => Shape::Trace(text(name)),
                SymbolicShape::Solid(kind, _) => solid(*kind),
            })
            .collect(),
        gravity: model.usual_gravity,
        balances: program.momentum.iter().map(balances).collect(),
        structure: Structure {
            dimension: model.dimension as u32,
            constant_mass: s.constant_mass,
            constant_inertias: s.constant_inertias,
            diagonal_mass: s.diagonal_mass,
            mass_blocks: s.mass_blocks.iter().map(|b| *b as u32).collect(),
            separable: s.separable,
            linear: s.linear,
            conservative: s.conservative,
            time_dependent: s.time_dependent,
            uniformly_accelerated: s.uniformly_accelerated,
            cyclic: s.cyclic.iter().map(|c| c.0 as u32).collect(),
        },
        parts: program
            .parts
            .iter()
            .map(|part| Part {
                coordinates: part.coordinates.iter().map(|i| *i as u32).collect(),
                linear: part.linear,
                separable: part.separable,
                time_dependent: part.time_dependent,
                conservative: part.is_conservative(),
                arguments: part.arguments.iter().map(|k| *k as u32).collect(),
                events: part.events.iter().map(|k| *k as u32).collect(),
                accelerations: part.operations as u32,
            })
            .collect(),
        counts: Counts {
            mass: c.mass as u32,
            bias: c.bias as u32,
            mass_and_bias: c.mass_and_bias as u32,
            accelerations: c.accelerations as u32,
            residual: c.residual as u32,
            jacobians: c.jacobians as u32,
        },
    }
}

pub(super) fn noise(noise: &dalembert_symbolic::model::Noise) -> Noise {
    Noise {
        name: Text::Owned(noise.name.clone()),
        seed: noise.seed,
        event: noise.event as u32,
        held: noise.held.iter().map(|j| *j as u32).collect(),
    }
}

/// All places of rows of so many columns.
fn full(n: u32, columns: impl Fn(u32) -> u32) -> List<(u32, u32)> {
    (0..n).flat_map(|row| (0..columns(row)).map(move |column| (row, column))).collect()
}

fn table(table: expr::Table) -> Table {
    Table {
        name: Text::Borrowed(table.name()),
        knots: List::Borrowed(table.knots()),
        pieces: List::Borrowed(table.pieces()),
        period: table.period(),
        rise: table.rise(),
    }
}

fn argument(argument: &lower::Argument) -> Argument {
    Argument {
        of: match argument.of {
            lower::Watched::Event(k) => Watched::Event(k as u32),
            lower::Watched::Switch(k) => Watched::Switch(k as u32),
            lower::Watched::Motion => Watched::Motion,
            lower::Watched::Argument(k) => Watched::Argument(k as u32),
        },
        role: match argument.role {
            lower::Role::Phase => Role::Phase,
            lower::Role::Landmark => Role::Landmark,
            lower::Role::Exponential => Role::Exponential,
            lower::Role::Bounded => Role::Bounded,
            lower::Role::Arctangent => Role::Arctangent,
            lower::Role::Points => Role::Points,
            lower::Role::Distance => Role::Distance,
            lower::Role::Power(p) => Role::Power(p),
        },
        time_only: argument.time_only,
        load: Text::Owned(argument.load.clone()),
        gates: argument.gates.clone().into(),
    }
}

fn input_jump(jump: &lower::InputJump) -> InputJump {
    match jump {
        lower::InputJump::Force => InputJump::Force,
        lower::InputJump::Speed => InputJump::Speed,
        lower::InputJump::Refused => InputJump::Refused,
    }
}

fn balances(system: &MomentumSystem) -> BalanceSystem {
    let text = |s: &String| Text::Owned(s.clone());
    let balance = |(name, void): &(String, bool)| Balance { name: text(name), void_at_rest: *void };
    BalanceSystem {
        name: text(&system.name),
        phases: system.phases.iter().map(|phase| *phase as u32).collect(),
        unknowns: system.unknowns.iter().map(text).collect(),
        equations: system.equations.iter().map(balance).collect(),
        nonzeros: system.matrix.len() as u32,
        operations: system.operations as u32,
        outputs: system.outputs.iter().map(|(output, unknown)| (*output as u32, *unknown as u32)).collect(),
    }
}
