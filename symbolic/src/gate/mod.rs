//! The gate: what must hold before a model compiles.
//!
//! 1. States to judge at: look in `states`; where phases of contacts may be: `contact_states`.
//! 2. The routes from energies and from bodies agree, entry by entry: look in `agreement`.
//! 3. It does not matter which body takes a load at a hinge: look in `hinge_ambiguity`.
//! 4. Systems of momentum balances hold, and determine the motion: look in `balances`; which balances of
//!    one that does not are wrong is found in `suspects`, what would mend them in `causes`.
//!    Equations that follow from others are left out: `surplus`.
//!    Their reactions are compared with force and moment on bodies: `results`.
//!    So do they integrated over the instant of an impact: `impulses`.  What impacts change is found in `impacts`.
//! 5. Forces are tested for potentials (`potential`) and for being counted twice (`double_counting`); what each entry does is in
//!    `effects`.
//!    Forces made of reactions must not drive: `friction`.  Inputs are arbitrary for this: `inputs`.
//! 6. Constraints are classified, and freedoms counted (`freedoms`, `closure`); rows that follow from others are named
//!    (`dependent`).
//! 7. What the file says is conserved or holds, does (`claims`); who changes what should be conserved is found in
//!    `explain`.
//! 8. Images of motions that `motions` names are motions: `same_motion`.
//!
//! Everything is evaluated in double-double with running magnitudes, so that every row is judged by the size of its own
//! terms and agreement means twenty digits.

mod agreement;
mod along_motion;
mod arguments;
mod balances;
mod between_knots;
mod causes;
mod claims;
mod closing;
mod closure;
mod coarse_events;
mod combinations;
mod common_inputs;
mod contact_states;
mod cyclic;
mod dense;
mod dependent;
mod directions;
mod double_counting;
mod draw;
mod effects;
mod elimination;
mod explain;
mod freedoms;
mod friction;
mod hinge_ambiguity;
mod homogeneity;
mod impacts;
mod impulses;
mod inputs;
mod lines;
mod links;
mod locks;
mod motion;
mod narrow_pairs;
mod narrow_products;
mod near_switch;
mod null;
mod potential;
mod reaction_values;
mod report;
mod results;
mod rows;
mod same_motion;
mod search;
mod speeds;
mod state;
mod states;
mod surplus;
mod suspects;
mod system;
mod trajectory;
mod unformed;

use crate::derive::{Derivation, Equations, Momentum, Rows, derive, derive_with_masses};
use crate::diagnose::catalogue::{mechanics, verdicts};
use crate::diagnose::{Place, Problem, listed};
use crate::expr::{Id, Symbol};
use crate::model::command::evaluate;
use crate::model::{Contact, Coordinate, Load, Model, Sample, Work, rate_name};
use crate::number::DoubleDouble;

use claims::Claims;
pub use common_inputs::shared_data;
pub use directions::Direction;
pub(crate) use directions::mixed;
pub use effects::{UnitPush, unit_push};
pub use freedoms::{Freedoms, Integrability};
pub use potential::{Conservative, Nature};
pub use report::{Agreement, Report};
pub use state::{Origin, State};
use states::States;

/// What is off by no more roundings of a double-double than this agrees: twenty digits.
const ROUNDINGS: f64 = 1e-20 / DoubleDouble::UNIT;

/// More coordinates and rows of constraints that are coupled with each other than this take too long to solve for in 32
/// digits, more rows that act at once to bring states to them.
const COUPLED_LIMIT: usize = 400;

/// A derivation that has passed.
#[derive(Clone, Debug)]
pub struct Judged {
    /// What was judged.
    pub derivation: Derivation,
    /// Cyclic coordinates and their momenta.
    pub cyclic: Vec<(usize, Id)>,
    /// Directions of other coordinates that are ignorable, too.
    pub directions: Vec<Direction>,
    /// What was tested, and how well it held.
    pub report: Report,
}

/// How closely the gate looks.  All of it is on; a study turns parts off to see what each of them catches.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Gate {
    /// Twenty digits, not nine.
    pub digits: bool,
    /// Every row by its own measure, not by the largest of all; accelerations that rows hide; groups of coordinates moving alone.
    pub rows: bool,
    /// States from the motion.
    pub motion: bool,
    /// States on both sides of discontinuities, and where narrow functions say something.
    pub sides: bool,
}

impl Default for Gate {
    fn default() -> Gate {
        Gate { digits: true, rows: true, motion: true, sides: true }
    }
}

impl Gate {
    /// Whether a difference is none, in a row whose terms have the magnitude `own`, among rows of at most `largest`.
    fn agrees(self, difference: f64, own: f64, largest: f64) -> bool {
        let tolerance = if self.digits { 1e-20 } else { 1e-9 };
        // What underflows has no magnitude, and is equal all the same.
        difference <= f64::MIN_POSITIVE || difference <= tolerance * if self.rows { own } else { largest }
    }

    /// Compares derivations and tests claims.
    ///
    /// # Errors
    /// A coordinate that carries no mass, or is redundant; derivations that disagree; something said to be conserved,
    /// or an identity, that is not.
    pub fn judge(self, mut derivation: Derivation) -> Result<Judged, Vec<Problem>> {
        let report = self.report(&mut derivation);
        // What was doubtful may be the reason for what is wrong.
        let beside = |problems: Vec<Problem>| [problems, derivation.model.warnings.clone()].concat();
        let report = report.map_err(beside)?;
        // Constraints act on coordinates that energies and forces do not contain.
        let constrained = !derivation.rows.is_empty();
        let Derivation { model, momenta, rows, .. } = &mut derivation;
        let states = inputs::arbitrary(model, rows, &report.states);
        let mechanical = model.mechanical();
        let momenta = &momenta[..mechanical];
        let cyclic = if constrained { Vec::new() } else { cyclic::cyclic(model, &states, momenta) };
        let directions = if constrained || mechanical < model.coordinates.len() {
            Vec::new()
        } else {
            directions::directions(model, &states, momenta, &cyclic)
        };
        Ok(Judged { derivation, cyclic, directions, report })
    }

    /// Runs every test and collects every failure.
    fn report(self, derivation: &mut Derivation) -> Result<Report, Vec<Problem>> {
        let Derivation { model, equations, rows, momentum, switches, eliminated, .. } = derivation;
        // A coordinate without inertia may follow from constraints; where coordinates are eliminated each has some.
        let problems = match rows.is_empty() {
            _ if eliminated.is_some() => Vec::new(),
            true => massless(model, equations),
            false => [weightless(model, equations), touched(model, equations)].concat(),
        };
        if !problems.is_empty() {
            return Err(problems);
        }
        let motion = motion::Motion::new(model, (&equations[0], eliminated.as_ref()), rows, switches);
        if let Some(extra) = too_many_coupled(model, &motion) {
            return Err(vec![mechanics::too_many_coupled(extra, COUPLED_LIMIT)]);
        }
        let own = if rows.is_empty() { Vec::new() } else { states::own_positions(model, &motion) };
        let states = states::states(model, &motion, &[], &own, self).map_err(|problem| vec![*problem])?;
        let mut report =
            Report { followed: states.followed.clone(), unreached: states.unreached.clone(), ..Report::default() };
        report.unreached.extend(left_out_by_sample(model));
        let mut problems = Vec::new();
        if !rows.is_empty() {
            problems = dependent_rows(model, &motion, (&own, &states.all), &mut report.ranks);
            report.freedoms = freedoms::freedoms(model, &motion, rows, &own, &states.all);
        }
        match agreement::agreement(model, equations, &states.all, self) {
            Ok(agreements) => report.agreements = agreements,
            Err(problem) => problems.push(*problem),
        }
        if let Err(problem) = agreement::rows(model, rows, &states.all, self) {
            problems.push(*problem);
        }
        match homogeneity::lengths(model, &motion, &states.all) {
            Ok(lengths) => report.lengths = lengths,
            Err(problem) => problems.push(*problem),
        }
        self.balances((model, momentum), &motion, &states, &mut report, &mut problems);
        problems.extend(self.forces((model, rows), &motion, &states, &mut report));
        problems.extend(impacts::elsewhere(model, rows, &motion, &states));
        let rates = claims::invariant_rates(model);
        let (gate, model, equations) = (self, &*model, &equations[0]);
        let claims = Claims { gate, model, equations, rows, motion: &motion, own: &own, states: &states };
        claims.test(&rates, &mut report, &mut problems)?;
        problems.extend(same_motion::images(model, &motion, (equations, rows), &states.all));
        report.states = states.all;
        if problems.is_empty() { Ok(report) } else { Err(problems) }
    }

    /// Holds systems of momentum balances against the motion and its jumps, and leaves out equations of them that follow from others; where
    /// it matters which body takes a load, there is no one second derivation to compare.
    fn balances(
        self,
        (model, momentum): (&mut Model, &mut [Momentum]),
        motion: &motion::Motion,
        states: &States,
        report: &mut Report,
        problems: &mut Vec<Problem>,
    ) {
        let unclear = hinge_ambiguity::ambiguous(model, momentum, &states.all);
        if !unclear.is_empty() {
            problems.extend(unclear);
            return;
        }
        let mut fewer = Vec::new();
        match balances::agree(model, (motion, momentum), (&states.all, &report.ranks), self) {
            Ok(agreed) => {
                report.agreements.extend(agreed.agreements);
                report.alone = agreed.alone;
                fewer = agreed.fewer;
            }
            Err(found) => problems.extend(found),
        }
        // What holds along the motion is held against jumps of the speeds too.
        if problems.is_empty() {
            match impulses::agree(model, motion, momentum, &states.blows, self) {
                Ok(agreements) => report.agreements.extend(agreements),
                Err(found) => problems.extend(found),
            }
        }
        for (k, equations) in fewer {
            momentum[k] = equations;
        }
    }

    /// Which forces have potentials, and what is counted twice.
    fn forces(
        self,
        (model, rows): (&mut Model, &Rows),
        motion: &motion::Motion,
        states: &States,
        report: &mut Report,
    ) -> Vec<Problem> {
        let force = |load: &Load| load.work == Work::Pushes;
        if model.raw_kinetic_energy != Id::ZERO || model.raw_potential_energy != Id::ZERO {
            let (mut graph, effects) = effects::effects(model);
            let warnings = double_counting::energies_twice(&mut graph, model, &effects, &states.all);
            model.warnings.extend(warnings);
        }
        if !model.loads.iter().any(force) && model.generalized_forces.is_empty() {
            return Vec::new();
        }
        let (mut graph, effects) = effects::effects(model);
        let free = States { all: inputs::arbitrary(model, rows, &states.all), ..states.clone() };
        report.forces = potential::natures(&mut graph, model, motion, &effects, &free);
        model.warnings.extend(friction::drives(model, &states.all));
        let (errors, warnings) = double_counting::counted_twice(&mut graph, model, &effects, &states.all);
        model.warnings.extend(warnings);
        errors
    }
}

/// Compares derivations and tests claims.
///
/// # Errors
/// See [`Gate::judge`].
pub fn judge(derivation: Derivation) -> Result<Judged, Vec<Problem>> {
    Gate::default().judge(derivation)
}

/// Derives and judges.
///
/// # Errors
/// Everything that either finds.
pub fn judged(model: Model) -> Result<Judged, Vec<Problem>> {
    judge(derive(model)?)
}

/// With more coordinates than this M is not formed to name what would mend a file.
const EXPLAINED: usize = 100;

/// As [`judged`] where M is not formed; what does not hold is judged once more with M, where that has always been quick, and with the
/// model that `in_parts` gives, in which every body is a part of its own in balances: this names what would mend it.
///
/// # Errors
/// Everything that either finds.
pub(crate) fn judged_and_explained(
    model: Model,
    in_parts: impl FnOnce() -> Result<Model, Vec<Problem>>,
) -> Result<Judged, Vec<Problem>> {
    let few = model.coordinates.len() <= EXPLAINED;
    let derivation = derive(model)?;
    let unformed = derivation.eliminated.is_some();
    match judge(derivation) {
        Err(_) if unformed && few => judge(derive_with_masses(in_parts()?)?),
        outcome => outcome,
    }
}

/// What the file's ranges leave out, in words.
fn left_out_by_sample(model: &Model) -> Option<String> {
    let parameters: Vec<f64> = model.parameters.iter().map(|p| p.default).collect();
    let range = |sample: &Sample| {
        let [low, high] = [sample.low, sample.high].map(|end| evaluate(&model.graph, end, &parameters));
        let name = rate_name(&model.coordinates[sample.coordinate].name, usize::from(sample.speed));
        Some(format!("{name} from {} to {}", low?, high?))
    };
    let ranges: Vec<String> = model.sample.iter().filter_map(range).collect();
    (!ranges.is_empty()).then(|| format!("`sample` leaves out all states but those with {}", listed(&ranges)))
}

/// The first coordinate or constraint with which too many are coupled.
fn too_many_coupled(model: &Model, motion: &motion::Motion) -> Option<Place> {
    let phases =
        (0..motion.constraints.phases()).filter_map(|phase| motion.constraints.active(phase).get(COUPLED_LIMIT));
    // Of contacts that have phases by themselves only one at a time has rows.
    let contacts = if model.contacts_are_single() { model.contact_rows() } else { Vec::new() };
    let solved = |i: &&usize| !(**i >= motion.n && contacts.contains(&(**i - motion.n)));
    let coupled = motion.coupled.iter().filter_map(|block| block.iter().filter(solved).nth(COUPLED_LIMIT)).copied();
    let extra = coupled.chain(phases.map(|row| motion.n + row)).next()?;
    match model.coordinates.get(extra) {
        Some(coordinate) => Some(coordinate.place.clone()),
        None => model.constraint_of_row(extra - motion.n).map(|constraint| constraint.place.clone()),
    }
}

/// Rows of the constraints that follow from others with the scene's own parameters are warned of, those that contradict
/// them are errors.  Notes how many rows are independent in every phase.
fn dependent_rows(
    model: &mut Model,
    motion: &motion::Motion,
    (own, states): (&[State], &[State]),
    found: &mut Vec<usize>,
) -> Vec<Problem> {
    let constraints = &motion.constraints;
    let (of_own, drawn) = (constraints.ranks(own), constraints.ranks(states.iter().filter(|state| !state.own)));
    let known = of_own.iter().zip(&drawn).map(|(own, drawn)| own.or(*drawn));
    let ranks: Vec<Option<usize>> = known.collect();
    let count = |phase: usize| constraints.active(phase).len();
    *found = ranks.iter().enumerate().map(|(phase, rank)| rank.unwrap_or(count(phase))).collect();
    let place = |model: &Model, row: usize| {
        model.constraint_of_row(row).map_or_else(Place::default, |constraint| constraint.place.clone())
    };
    let mut problems = Vec::new();
    let contradicting = dependent::contradictions(constraints, states, &ranks);
    for (_, row) in &contradicting {
        // Positions and speeds meet it, accelerations cannot: there is no motion.
        let name = format!("`{}` and those before it", model.row_name(*row));
        problems.push(verdicts::constraints_not_met(place(model, *row), name, states.len()));
    }
    let without = states.iter().filter(|state| of_own[state.phase].is_none());
    let decide: Vec<State> = own.iter().chain(without).cloned().collect();
    for dependent::Redundant { phase, row, sharing } in dependent::redundant(constraints, &decide, &ranks) {
        // Rows of contacts depend on each other where more of them stick than freedoms are left, which nobody can write otherwise.
        if contradicting.iter().any(|other| other.0 == phase) || model.contact_rows().contains(&row) {
            continue;
        }
        let names: Vec<String> = sharing.iter().map(|row| format!("`{}`", model.row_name(*row))).collect();
        let particular = if of_own[phase].is_some() && drawn[phase] != of_own[phase] { PARTICULAR } else { "" };
        let name = &model.phases[phase].name;
        let phase = if name.is_empty() { String::new() } else { format!(" of the phase `{name}`") };
        let name = format!("`{}`", model.row_name(row));
        // One row of a joint is not to be left out alone.
        let of_joint = model.constraint_of_row(row).is_some_and(|constraint| constraint.name.contains('.'));
        let help = if of_joint { "its coordinates or other joints hold this already" } else { "leave it out" };
        let warning = verdicts::redundant(place(model, row), name, phase + particular, help, listed(&names));
        model.warnings.push(warning);
    }
    problems
}

/// Where other values of the parameters would decide otherwise.
const PARTICULAR: &str = " for these values of the parameters";

/// A file with constraints in which nothing has mass: their forces would hold nothing.
fn weightless(model: &Model, equations: &[Equations]) -> Vec<Problem> {
    let first = model.coordinates.first().filter(|_| equations[0].mass.is_empty());
    first.map(|coordinate| mechanics::nothing_has_mass(coordinate.place.clone())).into_iter().collect()
}

/// Coordinates without an entry on M's diagonal that contacts hold in some phases, and nothing in others.
fn touched(model: &Model, equations: &[Equations]) -> Vec<Problem> {
    let contains = |constraint: usize, i: usize| {
        let symbols = model.graph.symbols(model.constraints[constraint].value.iter().copied());
        symbols.contains(&Symbol::Coordinate(i as u32)) || symbols.contains(&Symbol::Speed(i as u32))
    };
    let problem = |i: usize| {
        let holds =
            |contact: &&Contact| [contact.normal, contact.tangent].into_iter().flatten().any(|c| contains(c, i));
        let contact = model.contacts.iter().find(holds)?;
        let phase = model.phases.iter().find(|phase| !phase.constraints.iter().any(|c| contains(*c, i)))?;
        let Coordinate { name, place, .. } = &model.coordinates[i];
        Some(mechanics::touched_without_mass(place.clone(), name, &contact.name, &phase.name))
    };
    let moved = |i: &usize| equations[0].mass.iter().any(|e| (e.0, e.1) == (*i, *i));
    (0..model.coordinates.len()).filter(|i| !moved(i)).filter_map(problem).collect()
}

/// Coordinates without an entry on M's diagonal.
fn massless(model: &Model, equations: &[Equations]) -> Vec<Problem> {
    let moved = |i: usize| equations[0].mass.iter().any(|e| (e.0, e.1) == (i, i));
    let coordinates = model.coordinates.iter().enumerate();
    coordinates.filter(|(i, _)| !moved(*i)).map(|(_, c)| mechanics::no_mass(c.place.clone(), &c.name)).collect()
}
