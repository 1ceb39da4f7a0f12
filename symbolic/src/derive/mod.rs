//! Equations of motion from a resolved model.
//!
//! 1. Discontinuities become modes: look in `switches`.
//! 2. Sums get one order: look in `expr/sums`; what enters the equations stands in `dynamics`.
//! 3. Lagrange's equations from the energies: look in `lagrange`; masses that change are held meanwhile: look in `changing_mass`.
//! 4. Virtual power from the bodies: look in `virtual_power`; along the axes of frames in space: look in `body_axes`.
//! 5. Momentum balances as linear equations for accelerations and reactions: look in `momentum`.
//!
//! 6. Constraints, differentiated as often as accelerations need: look in `constraints`; integrals of those that contain
//!    speeds, where they can be written down: look in `integrals`, of combinations of them in `combined`.  Forces on bodies
//!    of mass 0 balance, which is a constraint too: look in `massless`.  What of a row is 0 but for rounding at any state is left
//!    out: look in `vanishing`.
//! 7. States of first order become the speeds of hidden coordinates: look in `hidden`.
//! 8. Where M is large, and accelerations come without it, M and h are not formed at all: look in `elimination`.
//!
//! Every derivation gives the same [`Equations`]; `gate` compares them, `lower` picks the cheapest.

mod angular;
mod body_axes;
pub(crate) mod branches;
mod changing_mass;
mod combined;
mod constraints;
mod dynamics;
pub(crate) mod elimination;
mod hidden;
mod integrals;
pub(crate) mod lagrange;
mod least_constraint;
pub(crate) mod massless;
pub(crate) mod momentum;
mod reactions;
mod switches;
mod vanishing;
mod virtual_power;
mod weights;

use std::collections::BTreeMap;

use crate::diagnose::catalogue::{mechanics, memory, sections};
use crate::diagnose::{Place, Problem};
use crate::expr::{Binary, Forward, Graph, Id, Node, Smooth, Symbol, Unary};
use crate::model::{Input, Load, Model, Rotation};
use elimination::Eliminated;

pub(crate) use constraints::held_rates;
pub use constraints::{Rows, RowsAgain};
pub(crate) use dynamics::{Acting, Dynamics, Inertial};
pub(crate) use least_constraint::LeastConstraint;
pub use momentum::Momentum;
pub(crate) use switches::introduce;
pub use switches::{Switch, SwitchKind, remove as without_modes};

/// M q'' + h = 0 as one derivation gives it.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Which derivation.
    pub name: &'static str,
    /// The non-zeros of M's lower triangle, row by row: (row, column, value); none where M is not formed.
    pub mass: Vec<(usize, usize, Id)>,
    /// h; nothing where M is not formed.
    pub bias: Vec<Id>,
    /// F(t, q, q', q'') = M q'' + h.
    pub residual: Vec<Id>,
}

/// Total derivatives by time, with the accelerations or at zero ones.
type Derivative = fn(&mut Graph, &[Id]) -> Vec<Id>;

impl Equations {
    /// From what gives F with accelerations, and h without: M is ∂F/∂q''.  M and h where they are to be `formed`.
    fn of_residual(
        graph: &mut Graph,
        name: &'static str,
        formed: bool,
        residual: impl Fn(&mut Graph, Derivative) -> Vec<Id>,
    ) -> Equations {
        let with_accelerations = residual(graph, rates);
        let (mut bias, mut mass) = (Vec::new(), Vec::new());
        if formed {
            bias = residual(graph, bias_rates);
            mass = mass_entries(graph, &with_accelerations, |s| match s {
                Symbol::Acceleration(j) => Some(j as usize),
                _ => None,
            });
        }
        Equations { name, mass, bias, residual: with_accelerations }
    }
}

/// What the energy balance needs.
#[derive(Clone, Copy, Debug)]
pub struct Energies {
    /// T.
    pub kinetic: Id,
    /// V.
    pub potential: Id,
    /// q'·∂T/∂q' − T + V.
    pub jacobi: Id,
    /// q'·Q − ∂T/∂t + ∂V/∂t, and what masses that change add.
    pub power: Id,
    /// Σ |terms of T and V|.
    pub scale: Id,
}

/// The outcome of deriving.
#[derive(Clone, Debug)]
pub struct Derivation {
    /// The model; its graph holds all results.
    pub model: Model,
    /// Equations by every derivation that applies; never empty.
    pub equations: Vec<Equations>,
    /// The constraints' rows, in file order.
    pub rows: Rows,
    /// Systems of momentum balances, in the order of the model's.
    pub momentum: Vec<Momentum>,
    /// Output components, by place, that are a component of a reaction as it stands.
    pub named_reactions: Vec<(usize, Symbol)>,
    /// Energies for the balance.
    pub energies: Energies,
    /// Each coordinate's momentum, and the rate of that, −∂L/∂q − Q.
    pub momenta: Vec<(Id, Id)>,
    /// Inputs as functions of time, (u, u', u''), with modes.
    pub signals: Vec<[Id; 3]>,
    /// Discontinuities of the equations of motion and of inputs.
    pub switches: Vec<Switch>,
    /// What the equations were derived from.
    pub(crate) dynamics: Dynamics,
    /// The accelerations, where M and h are not formed.
    pub(crate) eliminated: Option<Eliminated>,
}

/// More coordinates than this would need a dense mass matrix beyond the limit of the graph.
const COORDINATE_LIMIT: usize = 2000;

/// Derives.
///
/// # Errors
/// The model is too large.
pub fn derive(model: Model) -> Result<Derivation, Vec<Problem>> {
    derived(model, true)
}

/// As [`derive()`], with M and h formed however large they are.
///
/// # Errors
/// The model is too large.
pub fn derive_with_masses(model: Model) -> Result<Derivation, Vec<Problem>> {
    derived(model, false)
}

fn derived(mut model: Model, eliminating: bool) -> Result<Derivation, Vec<Problem>> {
    if let Some(extra) = model.coordinates.get(COORDINATE_LIMIT) {
        return Err(vec![mechanics::too_many_coordinates(extra.place.clone(), COORDINATE_LIMIT)]);
    }
    let dynamics = Dynamics::of(&mut model);
    if dynamics.switches.len() > switches::SWITCH_LIMIT {
        return Err(vec![mechanics::too_many_switches(first_beyond(&model), switches::SWITCH_LIMIT)]);
    }
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    // With constraints M, J and what multipliers do are solved for together; states of first order are no velocities.
    let free = model.constraints.is_empty() && model.states.is_empty();
    let eliminated = if eliminating && free { Eliminated::of(&model.graph, &dynamics) } else { None };
    let formed = eliminated.is_none();
    let (lagrange, mut momenta) = lagrange::equations(&mut model.graph, &dynamics, formed);
    let mut equations = vec![lagrange];
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    if !dynamics.bodies.is_empty() {
        equations.push(virtual_power::equations(&mut model.graph, &dynamics, formed));
        equations.extend(body_axes::equations(&mut model.graph, &dynamics, formed));
    }
    let mut energies = lagrange::energies(&mut model, &dynamics);
    let (mut switches, signals) = (dynamics.switches.clone(), dynamics.signals.clone());
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    hidden::append(&mut model, &dynamics.state_rates, &mut equations, &mut momenta);
    if formed {
        massless::balance(&mut model, &equations[0]);
    }
    let rows = Rows::of(&mut model);
    hidden::put_in(&mut model, &dynamics.state_rates, &mut equations, &mut momenta, &mut energies, &mut switches);
    let momentum = momentum::systems(&mut model, &rows, &switches, formed);
    if model.graph.overflowed() {
        return Err(vec![too_large()]);
    }
    let rough = rough_tables(&model, &equations, &rows, (&energies, &signals));
    if !rough.is_empty() {
        return Err(rough);
    }
    let moved = moved_by_memory(&model, &equations, &rows, &signals);
    if !moved.is_empty() {
        return Err(moved);
    }
    let named_reactions = reactions::put_in(&mut model);
    Ok(Derivation {
        model,
        equations,
        rows,
        momentum,
        named_reactions,
        energies,
        momenta,
        signals,
        switches,
        dynamics,
        eliminated,
    })
}

/// Inputs that contain held values, and whose place or rate bodies follow.
fn moved_by_memory(model: &Model, equations: &[Equations], rows: &Rows, signals: &[[Id; 3]]) -> Vec<Problem> {
    if model.memory.is_empty() {
        return Vec::new();
    }
    let graph = &model.graph;
    let forces = graph.symbols(equations.iter().flat_map(|derivation| derivation.residual.iter().copied()));
    let held_places = graph.symbols(rows.matrix.iter().map(|entry| entry.2).chain(rows.bias.iter().copied()));
    let moves = |k: usize| {
        let of = |s: &Symbol, least: u8| matches!(s, Symbol::Input(of, order) if *of as usize == k && *order >= least);
        forces.iter().any(|s| of(s, 1)) || held_places.iter().any(|s| of(s, 0))
    };
    let held = |k: usize| {
        let symbols = graph.symbols([signals[k][0]]);
        symbols.into_iter().find_map(|s| if let Symbol::Memory(j) = s { model.memory.get(j as usize) } else { None })
    };
    let place = |name: &str| Place::default().key("inputs").key(name.split('[').next().unwrap_or_default());
    let problem = |(k, input): (usize, &Input)| {
        held(k).filter(|_| moves(k)).map(|held| memory::input_jumps(place(&input.name), &input.name, &held.name))
    };
    model.inputs.iter().enumerate().filter_map(problem).collect()
}

/// Tables of which derivatives that jump enter the equations of motion.
fn rough_tables(
    model: &Model,
    equations: &[Equations],
    rows: &Rows,
    (energies, signals): (&Energies, &[[Id; 3]]),
) -> Vec<Problem> {
    let graph = &model.graph;
    let of_rows = rows.matrix.iter().map(|entry| entry.2).chain(rows.bias.iter().copied());
    let of_motion: Vec<Id> = equations
        .iter()
        .flat_map(|e| {
            let unformed = if e.bias.is_empty() { e.residual.as_slice() } else { &[] };
            e.mass.iter().map(|entry| entry.2).chain(e.bias.iter().chain(unformed).copied())
        })
        .chain(of_rows)
        .collect();
    // Of each table the derivative of the highest order, its name, and how smooth the table is.
    let mut worst: BTreeMap<&str, (u8, &str, Smooth)> = BTreeMap::new();
    let of_inputs = graph.needed(of_motion.iter().copied()).into_iter().filter_map(|id| match graph.node(id) {
        Node::Symbol(Symbol::Input(k, order)) => signals.get(k as usize)?.get(usize::from(order)).copied(),
        _ => None,
    });
    let needed = graph.needed(of_motion.iter().copied().chain(of_inputs.collect::<Vec<_>>()));
    for (whole, order, name, smooth) in needed.into_iter().filter_map(|id| table(graph, id)) {
        if order > smooth.order() {
            let known = worst.entry(whole).or_insert((order, name, smooth));
            *known = if known.0 < order { (order, name, smooth) } else { *known };
        }
    }
    if worst.is_empty() {
        return Vec::new();
    }
    // Of what is straight the second derivative is no term, so that the equations do not tell what a smoother table would bring in: they are
    // energies differentiated once more, and constraints.
    let values = |holonomic: bool| {
        let rows = rows.value.iter().zip(&rows.holonomic).filter(move |row| *row.1 == holonomic);
        rows.map(|row| *row.0).collect::<Vec<Id>>()
    };
    let once = [vec![energies.kinetic, energies.potential], values(false)].concat();
    let mut orders: BTreeMap<&str, u8> = BTreeMap::new();
    for (roots, more) in [(of_motion, 0), (once, 1), (values(true), 2)] {
        let mut note = |roots: &[Id], more: u8| {
            for (whole, order, ..) in graph.needed(roots.iter().copied()).into_iter().filter_map(|id| table(graph, id))
            {
                let most = orders.entry(whole).or_default();
                *most = (*most).max(order + more);
            }
        };
        note(&roots, more);
        for symbol in graph.symbols(roots) {
            if let Symbol::Input(k, rate) = symbol
                && let Some([signal, ..]) = signals.get(k as usize)
            {
                note(&[*signal], rate + more);
            }
        }
    }
    let problem = |(whole, (order, slope, smooth)): (&str, (u8, &str, Smooth))| {
        let help = match orders.get(whole).map_or(order, |most| order.max(*most)) {
            enough @ 1..=2 => format!("it is smooth enough with `smooth: {enough}`"),
            _ => "no table is as smooth as that".to_owned(),
        };
        let place = Place::default().key("tables").key(whole);
        sections::rough_table(place.of_key(), whole, slope, smooth.order(), help)
    };
    worst.into_iter().map(problem).collect()
}

/// The table that a node is a derivative of, the order of that, its name, and how smooth the table is.
fn table(graph: &Graph, id: Id) -> Option<(&'static str, u8, &'static str, Smooth)> {
    match graph.node(id) {
        Node::Unary(Unary::Table(table), _) => {
            Some((table.whole().name(), table.order(), table.name(), table.smooth()))
        }
        Node::Binary(Binary::Table(table), ..) => {
            let [x, y] = table.order();
            Some((table.whole().name(), x.max(y), table.name(), table.smooth()))
        }
        _ => None,
    }
}

/// The entry of the file with which the discontinuities are more than the limit.
fn first_beyond(model: &Model) -> Place {
    let place = |key: &str| Place::default().key(key);
    let raw = |key: &str, value: Id| (place(key), vec![value]);
    let mut entries = vec![
        raw("potential_energy", model.raw_potential_energy),
        raw("kinetic_energy", model.raw_kinetic_energy),
        raw("dissipation", model.dissipation),
    ];
    for body in &model.bodies {
        let turning = body.rotation.iter().flat_map(Rotation::attitude);
        entries.push((body.place.clone(), body.position.iter().copied().chain(turning).collect()));
    }
    entries.extend(model.gravity.iter().map(|gravity| (place("gravity"), gravity.clone())));
    let points = |load: &Load| load.pushes.iter().flat_map(|push| push.at.clone()).chain(load.expressions()).collect();
    entries.extend(model.loads.iter().map(|load| (load.place.clone(), points(load))));
    entries.extend(model.generalized_forces.iter().map(|f| (f.place.clone(), vec![f.force])));
    entries.extend(model.states.iter().map(|state| (state.place.clone(), vec![state.rate])));
    entries.extend(model.inputs.iter().map(|input| raw("inputs", input.signal[0])));
    let (places, groups): (Vec<Place>, Vec<Vec<Id>>) = entries.into_iter().unzip();
    let first = switches::beyond_limit(&model.graph, groups);
    first.map_or_else(|| place("coordinates"), |first| places[first].clone())
}

/// The problem of a graph that has reached its limit.
pub(crate) fn too_large() -> Problem {
    let place = Place::default().key("coordinates");
    crate::diagnose::catalogue::names::too_many_nodes(place, "1 000 000")
}

/// The total time derivative along the motion; accelerations appear where speeds are differentiated.
pub fn rate(graph: &mut Graph, root: Id) -> Id {
    rates(graph, &[root])[0]
}

/// Total time derivatives of several expressions.
pub fn rates(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    roots.iter().map(|r| forward.of(graph, *r)).collect()
}

/// Total time derivatives at zero generalized accelerations.
pub(crate) fn bias_rates(graph: &mut Graph, roots: &[Id]) -> Vec<Id> {
    let mut forward = Forward::new(|g: &mut Graph, s| match s {
        Symbol::Time => Id::ONE,
        Symbol::Speed(_) => Id::ZERO,
        _ => s.rate().map_or(Id::ZERO, |r| g.symbol(r)),
    });
    roots.iter().map(|r| forward.of(graph, *r)).collect()
}

/// M's lower triangle as the Jacobian of momenta (or of a residual) by the symbols that `column` numbers.
pub(crate) fn mass_entries(
    graph: &mut Graph,
    roots: &[Id],
    column: impl Fn(Symbol) -> Option<usize>,
) -> Vec<(usize, usize, Id)> {
    let rows = crate::expr::jacobian(graph, roots, column);
    let entries = rows.into_iter().enumerate();
    entries.flat_map(|(i, row)| row.into_iter().filter(move |e| e.0 <= i).map(move |(j, m)| (i, j, m))).collect()
}
