//! The states at which everything is judged.
//!
//! 1. Near each scene's start and at large, in the file's own measure: look in `draw`.
//! 2. One group of coordinates moving, the others at rest.
//! 3. From the motion itself, by a coarse run of each scene: look in `trajectory`.
//! 4. On both sides of every discontinuity, at it, and where functions that are local through their arguments say
//!    something: look in `near_switch`.

use super::coarse_events::{Turns, VelocityJump};
use super::draw::{Draws, with_conditions, with_set};
use super::lines::Reach;
use super::locks::lock;
use super::motion::{Incomplete, Motion};
use super::near_switch::sides;
use super::state::{Origin, State, describe};
use super::trajectory::{Passed, Trajectory};
use super::{Gate, listed};
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Place, Problem};
use crate::expr::{Id, Symbol, Tape};
use crate::model::{Model, Scene, Spin};
use crate::number::DoubleDouble;

/// How many drawn states each test wants.
const DRAWN: usize = 16;
/// How many draws are made for them at the most.
const DRAWS: usize = 400;
/// So many phases get as many states each as one would; of more phases each gets fewer.
const MOST_PHASES: usize = 8;
/// So many positions with the scene's own parameters decide ranks; fewer, where rows are so many that the cubes of their
/// number add up to more than this.
const OWN: usize = 10;
const CUBES: usize = 100_000_000;
/// So many phases are searched for discontinuities; of contacts that have phases by themselves the first, whose functions those of all others are.
const SEARCHED: usize = 32;
/// Each of these has so many states, and so many positions with the scene's own parameters: all contacts together have very many.
const ALONE: usize = 1;
/// With so many states that meet the constraints something can be said.
const FEWEST: usize = 4;
/// So many states come from the motion of each scene.
const FROM_MOTION: usize = 5;
/// So many jumps of the speeds of each scene are judged.
const BLOWS: usize = 4;
/// So many impacts of each scene are looked at.
const HITS: usize = 16;
/// So many steps of each are searched for discontinuities.
const STEPS: usize = 1000;
/// So many scenes are run.
const SCENES: usize = 8;
/// Operations that all states together may cost.
const WORK: usize = 20_000_000;

/// A state on the constraints that a jump of the speeds meets, and how much the rate of each changes.
pub(super) type Struck = (State, Vec<(usize, f64)>);

/// States and how they were found.
#[derive(Clone, Debug, Default)]
pub(super) struct States {
    /// With their motion.
    pub all: Vec<State>,
    /// Where a discontinuity is met; with their motion.
    pub surfaces: Vec<State>,
    /// What could not be reached, in words.
    pub unreached: Vec<String>,
    /// Scenes that were run, until when, and until when they should go.
    pub followed: Vec<(String, f64, f64)>,
    /// Jumps of the speeds on the way.
    pub blows: Vec<Struck>,
    /// Events with impacts on the way, by their places in the file, and where they happen.
    pub hits: Vec<(usize, State)>,
}

/// Finds states where some parameters are fixed; `own` are positions with the first scene's.
pub(super) fn states(
    model: &Model,
    motion: &Motion,
    when: &[(usize, Id)],
    own: &[State],
    gate: Gate,
) -> Result<States, Box<Problem>> {
    let trajectories = if gate.motion { trajectories(model, motion, when) } else { Vec::new() };
    let mut draws = Draws::new(model, motion, &trajectories);
    let mut found = States::default();
    let room = (WORK / motion.work().max(1)).clamp(6, 128);
    let phases = motion.constraints.phases();
    drawn(model, motion, &mut draws, (when, own), room.min(DRAWN), &mut found)?;
    let search = StateSearch { model, motion, room, usual: usual_ranks(motion, own, &found.all) };
    let mut bases: Vec<Vec<State>> = Vec::new();
    for phase in 0..phases {
        bases.push(found.all.iter().filter(|s| s.phase == phase).take(2).cloned().collect());
    }
    if gate.rows {
        search.groups_alone(&mut draws, when, &mut found.all);
    }
    let paths = search.along_runs(&draws, &trajectories, &mut bases, &mut found);
    if gate.sides {
        let until = trajectories.iter().map(|run| run.until).fold(0.0, f64::max);
        let until = if until > 0.0 { until } else { 10.0 };
        // What acts in one phase may be claimed of another: each is searched for itself.
        let searched = if model.contacts_are_single() { ALONE } else { SEARCHED };
        for (phase, bases) in bases.iter().enumerate().take(searched) {
            let paths: Vec<&[State]> = paths.iter().filter(|p| p[0].phase == phase).map(Vec::as_slice).collect();
            search.beside_discontinuities(&draws, phase, (bases, &paths), until, &mut found);
        }
        if phases > searched {
            found.unreached.push(format!("discontinuities were looked for in {searched} of {phases} phases"));
        }
    }
    Ok(found)
}

/// How many rows of each phase are independent where nothing is special: as many as at most states.
fn usual_ranks(motion: &Motion, own: &[State], drawn: &[State]) -> Vec<usize> {
    (0..motion.constraints.phases())
        .map(|phase| {
            let most = |states: &[State]| motion.constraints.ranks(states)[phase];
            [most(own), most(drawn)].into_iter().flatten().min().unwrap_or(0)
        })
        .collect()
}

/// What states beside the drawn ones are searched with.
struct StateSearch<'a> {
    model: &'a Model,
    motion: &'a Motion,
    /// How many states each search may find, about.
    room: usize,
    /// How many rows of each phase are independent where nothing is special.
    usual: Vec<usize>,
}

impl StateSearch<'_> {
    /// States in which one group of coordinates moves, the others at rest.
    fn groups_alone(&self, draws: &mut Draws<'_>, when: &[(usize, Id)], kept: &mut Vec<State>) {
        let most = if self.model.contacts_are_single() { ALONE } else { MOST_PHASES };
        for phase in 0..self.usual.len().min(most) {
            for group in groups(self.model).into_iter().take(self.room / 4) {
                let mut state = draws.group(&group, when);
                state.phase = phase;
                if draws.inside(&state) {
                    draws.hold(&mut state);
                    self.keep(draws, state, kept);
                }
            }
        }
    }

    /// States from the motion itself, which are `bases` of searches too, with its jumps and impacts; the paths of all runs.
    fn along_runs(
        &self,
        draws: &Draws<'_>,
        trajectories: &[Trajectory],
        bases: &mut [Vec<State>],
        found: &mut States,
    ) -> Vec<Vec<State>> {
        let (model, motion) = (self.model, self.motion);
        let mut paths: Vec<Vec<State>> = Vec::new();
        for (run, scene) in trajectories.iter().zip(&model.scenes) {
            paths.extend(stretches(motion, run));
            found.followed.push((scene.name.clone(), run.reached(), run.until));
            found.unreached.extend(lock(model, motion, (run, &scene.name)));
            found
                .blows
                .extend(run.blows.iter().take(BLOWS).filter_map(|velocity_jump| struck(motion, run, velocity_jump)));
            found.hits.extend(run.hits.iter().take(HITS).map(|(event, step)| {
                let mut state = on_the_way(run, step);
                motion.prepare(&mut state);
                (*event, state)
            }));
            let share = (self.room / 4 / trajectories.len()).clamp(1, FROM_MOTION);
            for (phase, bases) in bases.iter_mut().enumerate() {
                for step in run.spread(phase, share) {
                    let mut state = on_the_way(run, step);
                    state.outside = !draws.inside(&state);
                    bases.push(state.clone());
                    self.keep(draws, state, &mut found.all);
                }
            }
        }
        paths
    }

    /// States on both sides of every discontinuity of a phase, and at it.
    fn beside_discontinuities(
        &self,
        draws: &Draws<'_>,
        phase: usize,
        (bases, paths): (&[State], &[&[State]]),
        until: f64,
        found: &mut States,
    ) {
        let of = |i: usize, speed: bool| draws.reach(i, speed);
        let inside = |state: &State| draws.inside(state);
        let reach = Reach { until, of: &of, inside: &inside };
        let beside = sides(self.model, self.motion, (bases, paths), &reach);
        let words = |words: String| match self.model.phases.get(phase).filter(|phase| !phase.name.is_empty()) {
            Some(phase) => format!("{words} in the phase `{}`", phase.name),
            None => words,
        };
        found.unreached.extend(beside.unreached.into_iter().map(words));
        // Outside of the file's `sample`, only the motion itself is asked.
        for (states, kept) in [(beside.states, &mut found.all), (beside.surfaces, &mut found.surfaces)] {
            let outside = |mut state: State| {
                state.outside = !draws.inside(&state);
                state
            };
            let asked = |state: &State| !state.outside || state.origin == Origin::Motion;
            let states: Vec<State> = states.into_iter().map(outside).filter(asked).collect();
            if states.len() > 2 * self.room {
                let more = states.len() - 2 * self.room;
                let left = format!("{more} states beside discontinuities were left out, which would take too long");
                found.unreached.push(words(left));
            }
            for mut state in states.into_iter().take(2 * self.room) {
                // Next to a discontinuity wherever it comes from.
                state.origin = Origin::Side;
                self.keep(draws, state, kept);
            }
        }
    }

    /// Keeps a state that has a motion, and can show it: constraints do not depend on each other there only.  On the constraints it lies where the file
    /// says that the model is defined, unless a scene's motion went there.
    fn keep(&self, draws: &Draws<'_>, mut state: State, kept: &mut Vec<State>) {
        let constraints = &self.motion.constraints;
        let went = state.outside || state.origin == Origin::Motion;
        if self.motion.complete(&mut state).is_ok()
            && constraints.rank(&state).0 >= self.usual[state.phase]
            && !constraints.nearly_dependent(&state)
            && !constraints.rests(&state)
        {
            state.outside = !draws.inside(&state);
            if went || !state.outside {
                kept.push(state);
            }
        }
    }
}

/// A step of a run as a state.
pub(super) fn on_the_way(run: &Trajectory, step: &Passed) -> State {
    let double = |list: &[f64]| list.iter().map(|x| DoubleDouble::from(*x)).collect();
    let mut state = State { rests: run.rests.clone(), ..State::at_rest(run.parameters.clone(), step.q.len()) };
    (state.t, state.q, state.v) = (DoubleDouble::from(step.t), double(&step.q), double(&step.v));
    (state.phase, state.origin) = (step.phase, Origin::Motion);
    state
}

/// Where a jump of the speeds happens, on the constraints that push.
fn struck(motion: &Motion, run: &Trajectory, velocity_jump: &VelocityJump) -> Option<Struck> {
    let step =
        Passed { t: velocity_jump.t, q: velocity_jump.q.clone(), v: vec![0.0; motion.n], phase: velocity_jump.phase };
    let mut state = on_the_way(run, &step);
    motion.place(&mut state).then(|| (state, velocity_jump.rows.clone()))
}

/// The steps of a run in order, thinned where there are many: a list for each stretch between two events.
fn stretches(motion: &Motion, run: &Trajectory) -> Vec<Vec<State>> {
    let apart = run.states.len().div_ceil(STEPS).max(1);
    let mut stretches = Vec::new();
    for steps in run.states.chunk_by(|before, after| before.t < after.t) {
        let prepared = |step| {
            let mut state = on_the_way(run, step);
            motion.prepare(&mut state);
            state
        };
        stretches.push(steps.iter().step_by(apart).map(prepared).collect());
    }
    stretches
}

/// Coarse runs of the scenes.
fn trajectories(model: &Model, motion: &Motion, when: &[(usize, Id)]) -> Vec<Trajectory> {
    let n = motion.n;
    let turns = Turns::new(model);
    let run = |scene: &crate::model::Scene| {
        let defaults = model.parameters.iter().map(|p| p.default).collect();
        let (parameters, rests) = with_conditions(&model.graph, when, with_set(&model.graph, &scene.set, defaults));
        let roots: Vec<_> = scene.q.iter().chain(&scene.v).copied().chain([scene.until]).collect();
        let value = |s: Symbol| match s {
            Symbol::Parameter(i) => parameters.get(i as usize).copied().unwrap_or(0.0),
            _ => 0.0,
        };
        let start: Vec<f64> = Tape::new(&model.graph, &roots).evaluate(value);
        let until = if start[2 * n].is_finite() && start[2 * n] > 0.0 { start[2 * n] } else { 10.0 };
        let start = start_of(motion, scene, &parameters, &start[..2 * n]);
        Trajectory { rests, ..Trajectory::new(motion, &turns, parameters, start, until) }
    };
    model.scenes.iter().take(SCENES).map(run).collect()
}

/// Where a scene starts: what it names is held, the rest is near what it guesses and meets the constraints.
fn start_of(motion: &Motion, scene: &Scene, parameters: &[f64], start: &[f64]) -> Passed {
    let (q, v) = start.split_at(motion.n);
    let doubles = |list: &[f64]| list.iter().map(|x| DoubleDouble::from(*x)).collect();
    let floats = |list: &[DoubleDouble]| list.iter().map(|x| x.to_f64()).collect();
    let mut state = State::at_rest(parameters.to_vec(), motion.n);
    (state.q, state.v, state.phase) = (doubles(q), doubles(v), scene.phase);
    motion.signals(&mut state);
    let mut closed = state.clone();
    let close = |state: &mut State| motion.constraints.close_holding(state, (&scene.held_q, &scene.held_v));
    // Equations that the start meets besides are not looked at: the run is coarse.
    if close(&mut closed) {
        spin(&scene.spins, &state, &mut closed);
        if scene.spins.is_empty() || close(&mut closed) {
            state = closed;
        }
    }
    Passed { t: 0.0, q: floats(&state.q), v: floats(&state.v), phase: state.phase }
}

/// Gives rotations at another attitude the rates of the angular velocity that they have at the first one.
fn spin(spins: &[Spin], from: &State, to: &mut State) {
    for Spin { first, own } in spins {
        let of = |list: &[DoubleDouble]| [0, 1, 2, 3].map(|k| list[first + k]);
        let (q, rates, turned) = (of(&from.q), of(&from.v), of(&to.q));
        let square = q.iter().fold(DoubleDouble::ZERO, |sum, x| sum + *x * *x);
        let inverse = [q[0] / square, -q[1] / square, -q[2] / square, -q[3] / square];
        let rates = match own {
            true => times(turned, times(inverse, rates)),
            false => times(times(rates, inverse), turned),
        };
        to.v[*first..first + 4].copy_from_slice(&rates);
    }
}

/// The product of two quaternions.
fn times(a: [DoubleDouble; 4], b: [DoubleDouble; 4]) -> [DoubleDouble; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// Random states that have a motion.
fn drawn(
    model: &Model,
    motion: &Motion,
    draws: &mut Draws<'_>,
    (when, positions): (&[(usize, Id)], &[State]),
    wanted: usize,
    found: &mut States,
) -> Result<(), Box<Problem>> {
    let (mut singular, mut nearly): (Option<Singular>, _) = (None, Vec::new());
    let mut tried = 0;
    let phases = motion.constraints.phases();
    let mut outside = vec![0; phases];
    let fewest = if model.contacts_are_single() { ALONE } else { FEWEST };
    let wanted = (wanted * phases.min(MOST_PHASES)).max(if phases > 1 { fewest * phases } else { 0 });
    let most = DRAWS.max(3 * wanted);
    // Lengths that are drawn may not close: then those of the file serve.
    let own = own_parameters(model);
    while found.all.len() < wanted && tried < most {
        tried += 1;
        let closes = motion.constraints.is_empty() || found.all.len() * 4 >= tried || tried < 2 * wanted.min(40);
        let mut state = draws.next(if closes { None } else { Some(&own) }, when);
        state.phase = tried % phases;
        if !closes {
            state.own = true;
            let of_phase = || positions.iter().filter(|own| own.phase == state.phase && draws.inside(own));
            if let Some(own) = of_phase().nth(tried / phases % of_phase().count().max(1)) {
                (state.t, state.q) = (own.t, own.q.clone());
            }
        }
        draws.hold(&mut state);
        match motion.complete(&mut state) {
            // Others are drawn in its place.
            Ok(()) if !draws.inside(&state) => outside[state.phase] += 1,
            Ok(()) if motion.constraints.nearly_dependent(&state) || motion.constraints.rests(&state) => {
                nearly.push(state);
            }
            Ok(()) => found.all.push(state),
            Err(Incomplete::NotFinite) => {}
            // Where M has full rank somewhere, other states are singular positions; where it has it nowhere, the
            // largest rank counts.
            Err(Incomplete::Singular { rank, coordinates }) => {
                if singular.as_ref().is_none_or(|singular| rank >= singular.rank) {
                    singular = Some(Singular { rank, coordinates, state });
                }
                if found.all.is_empty() && tried >= 2 * wanted.max(8) {
                    break;
                }
            }
        }
    }
    // Where there are no others they serve.
    let few = |all: &[State], phase: usize| all.iter().filter(|state| state.phase == phase).count() < fewest;
    let phases_without: Vec<usize> = (0..phases).filter(|phase| few(&found.all, *phase)).collect();
    found.all.extend(nearly.into_iter().filter(|state| phases_without.contains(&state.phase)).take(wanted));
    motion.constraints.regular(&mut found.all);
    enough(model, motion, &found.all, singular, DrawCount { wanted, tried, most, outside })
}

/// A state at which M is singular.
struct Singular {
    /// The rank of M.
    rank: usize,
    /// Coordinates of which a combination moves nothing.
    coordinates: Vec<usize>,
    state: State,
}

/// How many states were to be drawn.
struct DrawCount {
    /// So many are wanted.
    wanted: usize,
    /// So many were tried.
    tried: usize,
    /// So many are tried at the most.
    most: usize,
    /// So many of each phase met the constraints outside of the file's `sample`.
    outside: Vec<usize>,
}

/// Asks that the states are as many as something can be said with.
///
/// # Errors
/// Constraints that no state meets, a mass matrix that is singular in all states, or too few states for another reason.
fn enough(
    model: &Model,
    motion: &Motion,
    states: &[State],
    singular: Option<Singular>,
    draw: DrawCount,
) -> Result<(), Box<Problem>> {
    let phases = motion.constraints.phases();
    // Contacts that would have to move in two ways at once never stick, or slip, together: no motion passes such a phase.
    let may_be_empty = !model.contacts.is_empty() && !states.is_empty();
    let empty = |phase: &usize| !may_be_empty && !states.iter().any(|state| state.phase == *phase);
    if let Some(outside) = (0..phases).find(empty).map(|phase| draw.outside[phase]).filter(|outside| *outside > 0) {
        return Err(Box::new(outside_of_sample(states.len(), outside, draw.most)));
    }
    if let Some(phase) = (0..phases).find(empty).filter(|phase| !motion.constraints.active(*phase).is_empty())
        && singular.is_none()
    {
        let of_phase = model.phases.get(phase).map_or(&[][..], |phase| &phase.constraints);
        let names: Vec<String> = of_phase.iter().map(|c| format!("`{}`", model.constraints[*c].name)).collect();
        let place = of_phase.first().map_or_else(Place::default, |c| model.constraints[*c].place.clone());
        return Err(Box::new(match holds_without_slopes(model, motion, phase) {
            true => verdicts::constraint_without_slope(place, listed(&names)),
            false => verdicts::constraints_not_met(place, listed(&names), draw.tried),
        }));
    }
    if states.len() >= draw.wanted || (!motion.constraints.is_empty() && states.len() >= FEWEST) {
        return Ok(());
    }
    Err(Box::new(match singular {
        Some(Singular { rank, coordinates, state }) if states.is_empty() => {
            let names: Vec<String> = coordinates.iter().map(|i| format!("`{}`", model.coordinates[*i].name)).collect();
            let place = model.coordinates[coordinates[0]].place.clone();
            let rank = format!("{rank} of {}", motion.n);
            verdicts::singular_mass(place, rank, listed(&names), describe(model, &state))
        }
        _ => match draw.outside.iter().sum() {
            0 => {
                let help = "say where the model is defined, `sample: {y: [-0.9*l, 0.9*l]}`";
                verdicts::too_few_states(Place::default().key("coordinates"), states.len(), draw.most, help)
            }
            outside => outside_of_sample(states.len(), outside, draw.most),
        },
    }))
}

/// That ranges leave too few of the states that meet the constraints.
fn outside_of_sample(found: usize, outside: usize, most: usize) -> Problem {
    let help = format!(
        "{outside} states that meet the constraints lie outside of these ranges: name ranges into which the constraints let the model come"
    );
    verdicts::too_few_states(Place::default().key("sample"), found, most, help)
}

/// Whether the constraints of a phase hold where the first scene starts, and all of their slopes vanish there.
fn holds_without_slopes(model: &Model, motion: &Motion, phase: usize) -> bool {
    /// Rounding of what is 0.
    const ROUNDING: f64 = 1e-12;
    let mut start = Draws::new(model, motion, &[]).first(&own_parameters(model));
    start.phase = phase;
    motion.signals(&mut start);
    let constraints = model.phases.get(phase).map_or(&[][..], |phase| &phase.constraints);
    let values: Vec<Id> = constraints.iter().flat_map(|c| model.constraints[*c].value.iter().copied()).collect();
    let values = Tape::new(&model.graph, &values).evaluate(|s| start.measured(s));
    let holds = values.iter().all(|x| x.value.abs().to_f64() <= ROUNDING * x.magnitude);
    holds && motion.constraints.rank(&start).0 == 0
}

/// The parameters of the first scene.
fn own_parameters(model: &Model) -> Vec<f64> {
    let defaults = model.parameters.iter().map(|p| p.default).collect();
    let set = model.scenes.first().map_or(&[][..], |scene| &scene.set);
    with_set(&model.graph, set, defaults)
}

/// Positions that meet the constraints of each phase with the parameters of the first scene, one not far from the other,
/// from its start on: ranks and integrals are decided there.  Where lengths are special other positions may hold what
/// moves here (a parallelogram with three cranks can be put together so that it is stiff).
pub(super) fn own_positions(model: &Model, motion: &Motion) -> Vec<State> {
    let own = own_parameters(model);
    let mut draws = Draws::new(model, motion, &[]);
    let mut found: Vec<State> = Vec::new();
    for phase in (0..motion.constraints.phases()).filter(|phase| !motion.constraints.active(*phase).is_empty()) {
        let mut last = draws.first(&own);
        (last.phase, last.own) = (phase, true);
        let before = found.len();
        let wanted = match model.contacts_are_single() {
            true => ALONE,
            false => (CUBES / motion.constraints.active(phase).len().pow(3)).clamp(3, OWN),
        };
        for _ in 0..4 * wanted {
            let mut state = draws.nearby(&last);
            if motion.place(&mut state) {
                found.push(state.clone());
                last = state;
            }
            if found.len() - before == wanted {
                break;
            }
        }
    }
    found
}

/// Coordinates that are made to move alone: each, or each family where there are many.
fn groups(model: &Model) -> Vec<Vec<usize>> {
    let n = model.coordinates.len();
    if n < 2 {
        return Vec::new();
    }
    if n <= 8 {
        return (0..n).map(|i| vec![i]).collect();
    }
    let family = |i: usize| model.coordinates[i].family();
    let mut groups: Vec<(&str, Vec<usize>)> = Vec::new();
    for i in 0..n {
        match groups.iter().position(|g| g.0 == family(i)) {
            Some(k) => groups[k].1.push(i),
            None if groups.len() < 12 => groups.push((family(i), vec![i])),
            None => {}
        }
    }
    let mut groups: Vec<Vec<usize>> = groups.into_iter().map(|g| g.1).collect();
    groups.extend([vec![0], vec![n - 1]]);
    groups
}
