//! The second run, which tells how many digits of the first one hold.

use std::ops::ControlFlow;

use nalgebra::DMatrix;

use super::cancelling_forces;
use super::close_calls::close_calls;
use super::flat::widen_flat_events;
use super::rounded_parameters::moved_parameters;
use super::settings::WhereStiff;
use super::steps_over::over_contacts;
use super::{Settings, simulate_with};
use crate::cause::Cause;
use crate::constrain::Projection;
use crate::driver::Followed;
use crate::error::Error;
use crate::events::{Ticks, begin_at};
use crate::integrate::order;
use crate::matrix::solve_least;
use crate::mechanism::dense::{constraint_matrix, constraint_triples, sizes_alike};
use crate::mechanism::{Action, Argument, At, Event, Method, Role, System, Watched, rows_in_force};
use crate::run::{Digits, Run, evaluate_outputs};
use crate::trust::{Loss, Warning, all_rates, inertia_condition};

/// The tolerance of the comparison run in units of the run's.
const LOOSER: f64 = 10.0;
/// Where the comparison run follows the steps of the run, its errors are so many times those of the run, for small steps: its steps are longer
/// by the root of the method's order.  It costs no more than a run at ten times the tolerance.
const COARSER: f64 = 5.0;
/// Bounds are so many times what they differ by elsewhere: over the library and its tolerances no promise is then broken by more than
/// 0.1 digits (`docs/digits.md`).
const FOLLOWING: f64 = 1.5;
/// No comparison run has a looser tolerance.
const LOOSEST: f64 = 0.3;
/// A run with less than so many times the tolerance tells nothing of the first one.
const TOLD_APART: f64 = 2.5;
/// The start of the comparison run is moved by so many unit round-offs of the largest value that a coordinate or rate has.
const MOVED: f64 = 20.0;
/// What the constraints leave of a move is rounding below this part of it.
const RESIDUE: f64 = 1e-6;
/// More growth than this of a difference at the start is an instability.
const GROWS: f64 = 1e4;
/// Growth by 1/ε lets errors of the tolerance ε take all digits.  What is so many times more is no growth of the moved start: other steps were taken from
/// it.
const BY_STEPS: f64 = 100.0;
/// What becomes larger than this beside its first tenth grows: other motions are as large as they get, but for a few powers of ten, from early on.
const GROWN: f64 = 1e3;
/// Where errors may be larger than this part of a range, two runs may agree by chance: a third one is asked.
const DOUBTFUL: f64 = 1e-6;
/// Where so many of the steps were rejected two runs may agree by chance too.
const BUMPY: f64 = 0.1;
/// Where runs may agree by chance, bounds are so many times what they differ by elsewhere.
const BY_CHANCE: f64 = 3.5;
/// So many times where functions of the motion happen locally, whose errors come in single steps.
const LOCALLY: f64 = 1.15;
/// An energy that should stay and is off by a part of its scale has speeds that are off by half of it, as energies go with their squares: where
/// steps follow a tolerance no error is known to be less.  What is dissipated takes its errors along.
const BY_ENERGY: f64 = 0.5;
/// A second run with more than this part of the steps of the first has the same ones, but for some.
const SHARED: f64 = 0.75;
/// Where its steps are shorter, bounds are so many times what they differ by elsewhere: the error of a method of order 1 is twice that.
const FINER: f64 = 1.5;
/// Accelerations are known to so many roundings times the condition of M.
const ROUNDED_INERTIA: f64 = 4.0;
/// Forces at the end may be off by so many half units in the last place of their terms.
const ROUNDED_FORCES: f64 = 8.0;
/// A second run is given up after so many times the steps of the first, and so many more: a start that is moved by rounding may have
/// vibrations that the first had not.
const MORE_STEPS: u64 = 10;
const STEPS_ANYHOW: u64 = 10_000;
/// Not more numbers than these are compared.
const MOST_NUMBERS: usize = 20_000_000;

/// Runs again less accurately, start and parameters moved by rounding, and compares: with steps that are longer than those of the run by a factor
/// wherever the tolerance alone chose them, else at ten times the tolerance, or twice the fixed step (or half of it).
///
/// Errors of runs at two tolerances are in no fixed proportion; those of runs with steps h(t) and c h(t) are in that of 1 to cᵖ, p being the
/// method's order, up to terms of higher order in h, also where they grow exponentially ([`Followed`]).
///
/// Source: the pair of tolerances is Shampine and Watts, *Global error estimation for ordinary differential equations*,
/// ACM TOMS 2 (1976) 172, section 2; the moved start sees what both runs would otherwise share.
pub(crate) fn estimate_global_error(
    system: &mut dyn System,
    settings: &Settings,
    run: &mut Run,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) {
    // Both runs would share the error of an integral.
    if run.rows.len() + run.outputs.len() > MOST_NUMBERS || run.has_untried_integrals() {
        return;
    }
    // The other one turns where this one did, and nowhere else.
    let stiff = matches!(run.method, Method::Radau5 | Method::Rodas5P);
    let turned = settings.method == Method::Auto && stiff;
    let where_stiff = if turned { WhereStiff::Turned } else { WhereStiff::Stays };
    let settings = &Settings { where_stiff, ..over_contacts(system, settings).into_owned() };
    let mut goes_on = |_: f64| progress(settings.until);
    let Some(comparison) = comparison(system, settings, run, Distance::Near, &mut goes_on) else { return };
    let ComparisonRun { policy, finer, follows, run: other } = comparison;
    let tolerance = settings.step.is_none() && !finer;
    run.fastest = fastest(system, settings, run);
    let missed = tolerance.then(|| policy.max(conserved_drift(system, run)));
    let mut digits = Digits::compare(run, &other, policy, missed);
    let cut = is_cut(system, run);
    let bumpy = is_bumpy(run);
    if digits.worst(run) > DOUBTFUL || cut || bumpy {
        let another = self::comparison(system, settings, run, Distance::Far, &mut goes_on);
        let Some(ComparisonRun { run: another, .. }) = another else { return };
        digits.third_run(run, &another, 1.0 / if follows { COARSER } else { LOOSER });
    }
    let by_chance = cut || bumpy && !follows;
    if follows {
        digits.inflate(FOLLOWING);
    }
    if finer {
        digits.inflate(FINER);
    }
    if by_chance {
        digits.inflate(BY_CHANCE);
    } else if is_local(system) {
        digits.inflate(LOCALLY);
    }
    digits.part_floor(run, known_to(system, run, cut));
    if run.warnings.iter().any(|warning| matches!(warning, Warning::SingularPassed { .. })) {
        digits.way_floor(run, conserved_drift(system, run));
    }
    let detuning = detuning(system, run, &digits);
    digits.frequency_error(run, detuning);
    widen_flat_events(system, run, &mut digits);
    let passes_over = run.warnings.iter().any(|warning| matches!(warning, Warning::PassedOver { .. }));
    if passes_over || leaves_to_either_side(run) {
        digits.lose(run);
    }
    if tolerance && policy < TOLD_APART * settings.tolerance {
        digits.lose_all(run);
    }
    if other.phases.last() == run.phases.last() {
        look_around_end(system, run, &mut digits);
        run.warnings.extend(close_calls(system, run, &digits, &settings.ignored_events));
    }
    // How many of infinitely many impacts are followed one by one says nothing.
    let accumulates = run.warnings.iter().any(|warning| matches!(warning, Warning::ImpactsAccumulate { .. }));
    let [here, there] =
        [&*run, &other].map(|run| run.events.iter().filter(|event| event.state.t > settings.from).count());
    if here != there && !accumulates {
        run.warnings.push(Warning::EventsDiffer { here, there });
    }
    if let Some((t, column)) = digits.lost.filter(|_| !passes_over) {
        let why = reason(system, settings, run, (t, column), &mut goes_on);
        let column = run.column_names().swap_remove(column);
        run.warnings.push(Warning::DigitsLost { t, column, why });
    } else if let Some(time) = stays_unstably(system, settings, run) {
        run.warnings.push(Warning::StaysUnstably { time });
    }
    run.digits = Some(digits);
}

/// To which part of what each number goes through a run is known at best.
fn known_to(system: &dyn System, run: &Run, cut: bool) -> f64 {
    let Some(tolerance) = run.tolerance else { return 0.0 };
    // Where a run is cut its errors follow the tolerance by chance only.
    let by_chance = if cut { tolerance } else { 0.0 };
    by_chance.max(BY_ENERGY * conserved_drift(system, run))
}

/// By which part of its scale an energy that should stay has changed.
fn conserved_drift(system: &dyn System, run: &Run) -> f64 {
    run.energy_balance.filter(|_| system.description().structure.conservative).unwrap_or(0.0)
}

/// The largest eigenvalue of the system linearised at the start, 1/s; 0 where it cannot be had.
fn fastest(system: &dyn System, settings: &Settings, run: &Run) -> f64 {
    let n = system.len();
    let Some(start) = run.rows.get(..2 * n) else { return 0.0 };
    let rates = all_rates(system, settings.from, &start[..n], &start[n..]).unwrap_or_default();
    rates.iter().map(|rate| rate.norm()).filter(|rate| rate.is_finite()).fold(0.0, f64::max)
}

/// Judges outputs at the end by states that the last one may as well be.
fn look_around_end(system: &mut dyn System, run: &Run, digits: &mut Digits) {
    // Means over steps are no functions of the state.
    let Some(row) = run.len().checked_sub(1).filter(|_| run.tally.is_none()) else { return };
    let (n, t) = (system.len(), run.times[row]);
    let mut room = vec![0.0; n];
    let mut outputs = |system: &dyn System, y: &[f64]| {
        let mut outputs = vec![f64::NAN; system.description().output_len()];
        evaluate_outputs(system, t, y, &mut room, &mut outputs);
        outputs
    };
    let end = &run.rows[2 * n * row..][..2 * n];
    digits.known_at_end(run, &constraint_round_off(system, t, end).unwrap_or_default());
    let states = digits.around(run, row, end);
    let mut beside: Vec<Vec<f64>> = states.iter().map(|y| outputs(system, y)).collect();
    // What friction holds would slip if forces changed.
    if system.contacts().all.is_empty() {
        system.disturb_forces(ROUNDED_FORCES);
        beside.push(outputs(system, end));
        system.disturb_forces(0.0);
    }
    digits.output_conditioning(&beside);
    digits.cancellation(run, &roundings(system, At::packed(t, end, n)));
}

/// What rounding of constraints makes of a state that they determine; `None` where there are none.
fn constraint_round_off(system: &dyn System, t: f64, y: &[f64]) -> Option<Vec<f64>> {
    let mut projection = Projection::new(system)?;
    projection.observe(system, t, y);
    projection.project(system, t, &mut y.to_vec()).ok()?;
    Some(projection.constraint_round_off(system, t, y).to_vec())
}

/// By which part of themselves accelerations may be off all along: by the condition of M at the start and at the end of a run; with constraints by what
/// rounding of M, J and γ makes of accelerations at the end, beside those of vibrations that move as far and as fast as the run does.
fn detuning(system: &mut dyn System, run: &Run, digits: &Digits) -> f64 {
    let n = system.len();
    let Some(last) = run.len().checked_sub(1) else { return 0.0 };
    let state = |row: usize| At::packed(run.times[row], &run.rows[2 * n * row..], n);
    if system.description().rows.is_empty() {
        let condition = [0, last].map(|row| inertia_condition(system, state(row)));
        return ROUNDED_INERTIA * f64::EPSILON * condition[0].max(condition[1]);
    }
    // What friction holds would slip if forces changed.
    if !system.contacts().all.is_empty() {
        return 0.0;
    }
    let [mut usual, mut wrong] = [vec![0.0; n], vec![0.0; n]];
    let known = system.accelerations(state(last), &mut usual).is_ok();
    system.disturb_forces(ROUNDED_INERTIA);
    let known = known && system.accelerations(state(last), &mut wrong).is_ok();
    system.disturb_forces(0.0);
    let sizes = digits.usual_accelerations(run);
    let part = |i: usize| {
        let size = sizes[i].max(usual[i].abs());
        if size > 0.0 { (wrong[i] - usual[i]).abs() / size } else { 0.0 }
    };
    (0..n).filter(|_| known).map(part).fold(0.0, f64::max)
}

/// What rounding may have made of the outputs at a state, however exact that is.
fn roundings(system: &dyn System, at: At<'_>) -> Vec<f64> {
    let description = system.description();
    let (mut a, mut lambda) = (vec![0.0; at.q.len()], vec![0.0; description.rows.len()]);
    let mut errors = vec![0.0; description.output_len()];
    // Outputs of accelerations that there are not are absent.
    if !description.outputs_use_accelerations || system.accelerations_and_multipliers(at, &mut a, &mut lambda).is_ok() {
        system.output_errors(at.accelerated(&a).constrained(&lambda), &mut errors);
    }
    errors
}

/// True where more than the tolerance decides how a run is divided into steps: discontinuities, events that change
/// something, features that arguments reveal.  Errors then follow the tolerance by chance only.
fn is_cut(system: &dyn System, run: &Run) -> bool {
    let description = system.description();
    let acts = description.events.iter().any(|event| event.actions.iter().any(|action| *action != Action::Record));
    let timed = description.arguments.iter().any(|argument| argument.of == Watched::Motion && argument.time_only);
    !description.switches.is_empty() || acts || timed || run.work.retries > 0
}

/// True where functions of the motion may happen within a small part of it.
fn is_local(system: &dyn System) -> bool {
    let local = |argument: &Argument| argument.of == Watched::Motion && argument.role != Role::Distance;
    system.description().arguments.iter().any(local)
}

/// True where steps were often too long: what limits them comes and goes faster than they can follow, and errors do not
/// follow the tolerance.
fn is_bumpy(run: &Run) -> bool {
    run.work.rejected as f64 > BUMPY * run.work.steps as f64
}

/// How much less accurate another run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Distance {
    /// By about one factor.
    Near,
    /// By its square.
    Far,
}

/// A second run.
struct ComparisonRun {
    /// Its tolerance, or its fixed step in s.
    policy: f64,
    /// Whether its steps are shorter than those of the first one.
    finer: bool,
    /// Whether its steps follow those of the first one.
    follows: bool,
    run: Run,
}

/// A run whose steps are longer by this distance, or whose tolerance or fixed step is larger; where stops divide the way into the same steps all
/// the same, at a step that is shorter.  `None` if it was interrupted.
fn comparison(
    system: &mut dyn System,
    settings: &Settings,
    run: &Run,
    distance: Distance,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Option<ComparisonRun> {
    let mut other = alike(system, settings, run);
    if run.method == Method::Exact || settings.where_stiff == WhereStiff::Turned {
        // At another tolerance `auto` might take another method, whose errors say nothing of these.
        other.method = run.method;
    }
    let disturbed = cancelling_forces::cancel(system, run);
    if disturbed && run.method == Method::Taylor {
        // The series are those of forces as they are.
        other.method = Method::Dop853;
    }
    let power = if distance == Distance::Far { 2 } else { 1 };
    let times = if distance == Distance::Far { 3.0 } else { 2.0 };
    other.followed = followed(system, settings, run, COARSER.powi(power));
    let policy = match settings.step {
        Some(step) => *other.step.insert(step * times),
        None => {
            other.tolerance = (LOOSER.powi(power) * settings.tolerance.max(Settings::TIGHTEST)).min(LOOSEST);
            other.tolerance
        }
    };
    let coarser = ran(system, &other, run, disturbed, progress)?;
    let follows = other.followed.is_some();
    let fixed = settings.step.is_some() || !run.method.adapts_to(&system.description().structure);
    let shared = coarser.work.steps as f64 > SHARED * run.work.steps as f64;
    if !(fixed && shared) || run.method == Method::Exact {
        return Some(ComparisonRun { policy, finer: false, follows, run: coarser });
    }
    let even = (settings.until - settings.from) / run.work.steps as f64;
    let policy = *other.step.insert(settings.step.map_or(even, |step| step.min(even)) / times);
    Some(ComparisonRun { policy, finer: true, follows, run: ran(system, &other, run, disturbed, progress)? })
}

/// The steps of a run, to be followed by one whose errors are so many times as large; `None` where more than the tolerance chose them.
fn followed(system: &dyn System, settings: &Settings, run: &Run, coarser: f64) -> Option<Followed> {
    let explicit = matches!(run.method, Method::Dopri5 | Method::Dop853 | Method::Rkn8 | Method::Taylor);
    let chosen = explicit && settings.step.is_none() && !is_cut(system, run);
    let stretch = coarser.powf(1.0 / f64::from(order(run.method)));
    Followed::new(&run.step_ends, stretch).filter(|_| chosen)
}

/// The run with parameters moved by rounding and maybe forces wrong by theirs, or what there is of it; `None` if it was interrupted.
///
/// Both runs would share what rounding makes of forces that cancel each other.
fn ran(
    system: &mut dyn System,
    settings: &Settings,
    run: &Run,
    disturbed: bool,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Option<Run> {
    let parameters = system.parameters();
    let set = |system: &mut dyn System, values: &mut dyn Iterator<Item = f64>| {
        values.enumerate().for_each(|(index, value)| system.set_parameter(index, value));
    };
    let moved = moved_parameters(system, settings);
    set(system, &mut moved.into_iter());
    system.disturb_forces(f64::from(u8::from(disturbed)));
    let outcome = simulate_with(system, settings, progress);
    system.disturb_forces(0.0);
    set(system, &mut parameters.iter().copied());
    let mut other = match outcome {
        Ok(run) => run,
        Err(Error::Run(failure))
            if matches!(
                failure.cause,
                Cause::Interrupted | Cause::TooManySteps { .. } | Cause::NeedsMoreSteps { .. }
            ) =>
        {
            return None;
        }
        Err(Error::Run(failure)) => failure.run,
        Err(_) => return None,
    };
    if run.is_filled {
        other.resample(&run.times);
    }
    Some(other)
}

/// The same settings for a run that is only compared, from its start moved by rounding.
fn alike(system: &mut dyn System, settings: &Settings, run: &Run) -> Settings {
    // The same times are reported, however long it is.
    let every = Some(settings.spacing());
    let max_steps = settings.max_steps.min(MORE_STEPS * run.work.steps + STEPS_ANYHOW);
    let mut other = Settings {
        digits: false,
        dense: run.is_filled,
        watch: false,
        decorrelate_steps: true,
        every,
        max_steps,
        ..settings.clone()
    };
    let n = other.q.len();
    // It starts behind what happened at the start.
    if let Some(start) = run.rows.get(..2 * n) {
        (other.q, other.v) = (start[..n].to_vec(), start[n..].to_vec());
        other.beside = Some(start.to_vec());
    }
    if let Some((_, phase)) = run.phases.iter().take_while(|(t, _)| *t == settings.from).last() {
        other.phase = *phase;
    }
    other.memory = Some(run.memory_at_start.clone());
    other.ticks = Some(Ticks::new(system, settings.from, settings.ticks.as_deref()).next_after(settings.from));
    // A kick at the very end says nothing of the way there.
    let kicked = run.len() > 1 && run.impulses.last().is_some_and(|impulse| run.times.last() == Some(&impulse.t));
    let count = run.len() - usize::from(kicked);
    let largest_of = |count: usize, column: usize| {
        run.rows[..2 * n * count].iter().skip(column).step_by(2 * n).fold(0.0_f64, |most, y| most.max(y.abs()))
    };
    // What a growing motion becomes has grown from roundings of what it was.
    let largest = |column: usize| match (largest_of(count, column), largest_of(count.div_ceil(10), column)) {
        (largest, early) if early > 0.0 => largest.min(GROWN * early),
        (largest, _) => largest,
    };
    let own = |column: usize| settings.start_errors.as_ref().map_or(0.0, |errors| errors[column]);
    let moves: Vec<f64> =
        (0..2 * n).map(|column| own(column).max(0.5 * f64::EPSILON * MOVED * largest(column))).collect();
    for i in 0..n {
        // Moved in one sense they might only be shifted.
        let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
        other.q[i] += sign * moves[i];
        // What friction holds at rest would begin to slide.
        if system.contacts().all.is_empty() || other.v[i] != 0.0 {
            other.v[i] += sign * moves[n + i];
        }
    }
    let start = run.rows.get(..n).unwrap_or(&settings.q);
    project(system, &mut other, start, &moves);
    other
}

/// Brings a start that was moved by so much from `start` to the constraints: values that are held would miss what they met.
fn project(system: &mut dyn System, settings: &mut Settings, start: &[f64], moves: &[f64]) {
    system.set_phase(settings.phase);
    system.enforce(settings.enforcement, settings.alpha());
    let Some(mut projection) = Projection::new(system) else { return };
    let mut y = [settings.q.as_slice(), settings.v.as_slice()].concat();
    begin_at(system, settings.from, &y);
    // Where that cannot be, the start is left as it is.
    let n = settings.q.len();
    let rests = y[n..].iter().all(|v| *v == 0.0);
    if projection.project(system, settings.from, &mut y).is_ok() {
        // What was at rest is at rest beside it, if nothing drives the constraints.
        if rests {
            let still = [&y[..n], &vec![0.0; n]].concat();
            let rates = constraint_triples(system, At::packed(settings.from, &still, n));
            if system.active_rows().iter().all(|row| rates[*row as usize][1] == 0.0) {
                y = still;
            }
        }
        leave_walls(system, settings.from, start, &mut y[..n]);
        // Where the constraints let nothing move as it was moved, what is left is rounding of that, and meets no constraint.
        let description = system.description();
        let moved = [sizes_alike(description, &moves[..n]), sizes_alike(description, &moves[n..])].concat();
        y.iter_mut().zip(moved).filter(|(y, moved)| y.abs() <= RESIDUE * moved).for_each(|(y, _)| *y = 0.0);
        settings.begin_in(&y);
    }
}

/// Brings places that were moved by rounding from `start` out of walls: no gap is negative that was not, nor more so than it was.  Constraints in
/// force are kept.
fn leave_walls(system: &dyn System, t: f64, start: &[f64], q: &mut [f64]) {
    let gaps: Vec<usize> =
        system.contacts().all.iter().filter_map(|contact| contact.normal).map(|row| row as usize).collect();
    let (rows, n) = (&system.description().rows, q.len());
    let at_rest = |q: &[f64]| [q, &vec![0.0; n]].concat();
    let mut kept: Vec<usize> = rows_in_force(system).filter(|row| rows[*row].holonomic).collect();
    let least: Vec<f64> =
        constraint_triples(system, At::packed(t, &at_rest(start), n)).iter().map(|[c, ..]| c.min(0.0)).collect();
    // What leads out of one wall may lead into another one.
    for _ in 0..gaps.len() {
        let y = at_rest(q);
        let at = At::packed(t, &y, n);
        let here = constraint_triples(system, at);
        let entered: Vec<usize> =
            gaps.iter().copied().filter(|row| here[*row][0] < least[*row] && !kept.contains(row)).collect();
        if entered.is_empty() {
            return;
        }
        kept.extend(entered);
        let right = DMatrix::from_fn(
            kept.len(),
            1,
            |k, _| if gaps.contains(&kept[k]) { least[kept[k]] } else { 0.0 } - here[kept[k]][0],
        );
        let Some(back) = solve_least(&constraint_matrix(system, at, &kept), &right) else { return };
        q.iter_mut().zip(back.iter()).for_each(|(q, back)| *q += back);
    }
}

/// Why a run has no digits left from t on: a third run, as accurate as the first, tells how a moved start grows.
fn reason(
    system: &mut dyn System,
    settings: &Settings,
    run: &Run,
    (t, column): (f64, usize),
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Loss {
    let accuracy = match settings.step {
        Some(step) => Loss::CoarseStep { step },
        None => Loss::LooseTolerance { tolerance: settings.tolerance },
    };
    // With the same steps: only the start differs.
    let moved = Settings { decorrelate_steps: false, ..alike(system, settings, run) };
    if leaves_to_either_side(run) || rests_unstably(system, settings, &moved) {
        return Loss::UnstableStart;
    }
    let other = match simulate_with(system, &moved, progress) {
        Ok(other) => other,
        Err(Error::Run(failure)) if failure.state.t <= t && !matches!(failure.cause, Cause::Interrupted) => {
            return Loss::Fails { t: failure.state.t, cause: failure.cause.code() };
        }
        Err(Error::Run(failure)) => failure.run.clone(),
        Err(_) => return accuracy,
    };
    let n = settings.q.len();
    let apart = |one: &[f64], other: &[f64], i: usize| (one[i] - other[i]).abs();
    let shared = run.times.iter().zip(&other.times).take_while(|(a, b)| a == b).count();
    let Some(row) = run.times[..shared].iter().rposition(|time| *time <= t) else { return accuracy };
    let (here, there) = (&run.rows[2 * n * row..][..2 * n], &other.rows[2 * n * row..][..2 * n]);
    let start = (run.rows[column] - [moved.q, moved.v].concat()[column]).abs();
    let growth = apart(here, there, column) / start;
    let most = if settings.step.is_some() { f64::INFINITY } else { BY_STEPS / settings.tolerance };
    if growth > GROWS && growth < most { Loss::Instability { growth } } else { accuracy }
}

/// True where the motion begins on a kink or jump that leads away to both sides.
fn leaves_to_either_side(run: &Run) -> bool {
    run.warnings.iter().any(|warning| matches!(warning, Warning::BothSidesLeave { .. }))
}

/// A double eigenvalue 0 comes out as large as the square root of rounding makes it, beside the largest one.
const ZERO_RATE: f64 = 1e-6;

/// In which time differences grow e times where a motion stays at rest from its start to its end in an unstable equilibrium; `None` where forces of
/// contacts, discontinuities or ticks may hold it there.
fn stays_unstably(system: &dyn System, settings: &Settings, run: &Run) -> Option<f64> {
    let (n, description) = (system.len(), system.description());
    let holds = !description.switches.is_empty() || !system.contacts().all.is_empty();
    let start = run.rows.get(..2 * n)?;
    let stays = start[n..].iter().all(|v| *v == 0.0) && run.rows.chunks_exact(2 * n).all(|row| row == start);
    if holds || !stays || description.events.iter().any(Event::changes_motion) {
        return None;
    }
    let rates = all_rates(system, settings.from, &start[..n], &start[n..])?;
    let largest = rates.iter().map(|rate| rate.norm()).fold(0.0, f64::max);
    let grows = rates.iter().map(|rate| rate.re).fold(0.0, f64::max);
    (grows > ZERO_RATE * largest && grows * (settings.until - settings.from) > 1.0).then(|| 1.0 / grows)
}

/// True where the motion begins at rest in an unstable equilibrium, and stays one as time goes by: all that moves it is rounding, as a start that is
/// moved by rounding tells.
fn rests_unstably(system: &dyn System, settings: &Settings, moved: &Settings) -> bool {
    const TIMES: u32 = 64;
    if settings.v.iter().any(|v| *v != 0.0) {
        return false;
    }
    let span = settings.until - settings.from;
    // Of large mechanisms eigenvalues are not known.
    let rates = all_rates(system, settings.from, &settings.q, &settings.v);
    if rates.is_some_and(|rates| rates.iter().all(|rate| rate.re * span <= 1.0)) {
        return false;
    }
    let (mut here, mut there) = (vec![0.0; settings.q.len()], vec![0.0; settings.q.len()]);
    (0..=TIMES).all(|k| {
        let t = settings.from + f64::from(k) / f64::from(TIMES) * span;
        let known = system.accelerations(At::new(t, &settings.q, &settings.v), &mut here).is_ok()
            && system.accelerations(At::new(t, &moved.q, &settings.v), &mut there).is_ok();
        let largest = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0_f64, |most, a| most.max(a.abs()));
        let by_rounding = largest(&mut here.iter().zip(&there).map(|(here, there)| here - there));
        known && largest(&mut here.iter().copied()) <= by_rounding
    })
}
