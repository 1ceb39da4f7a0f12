//! What `auto` stands for.

use super::Settings;
use super::settings::WhereStiff;
use crate::events::EventLocator;
use crate::integrate::{LENGTHS_OF_EXACT, fastest_rate, longest_step, operations_of_exact};
use crate::mechanism::sliding::{self, SLIDES, fractions};
use crate::mechanism::{AccelerationSlopes, At, Description, Enforcement, Event, Method, System, choose_sides};
use crate::trust::{all_rates, rates, rates_however_many};

/// A method, and why it was chosen; nothing where the user chose it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Choice {
    pub method: Method,
    pub why: Option<&'static str>,
}

/// More coordinates than these make the exponential dearer than steps.
const LARGEST: usize = 40;
/// Looser tolerances than this are met with less work at order 5, by the curves of the library (`docs/charts.md`): where steps end as
/// the tolerance lets them, and where events and discontinuities end them.
const LOOSE: f64 = 4e-4;
const LOOSE_WHERE_CUT: f64 = 1.5e-5;
/// A rate of decay is looked at where it would hold an explicit method to so many steps.
const MANY_STEPS: f64 = 1e4;
/// A stiff step of more coordinates than this costs as many times more beside an explicit one: its Jacobian has a column each.
const USUAL: f64 = 40.0;
/// The dense matrices of more coordinates than this are dearer than their evaluations.
const LARGEST_STIFF: usize = 200;
/// It is stiff where it is so much faster than all that vibrates.
const FASTER: f64 = 1e3;

/// Vibrations are looked at where the run has so many radians of the fastest one: some seconds of an explicit method.
const MANY_RADIANS: f64 = 1e6;
/// Steps that need not follow them are tried over this part of the run, and are to be so long, in radians, at the least: explicit methods
/// take some two radians a step, and a step of `rodas5p` costs as much as several of theirs.
const TRIED: f64 = 0.02;
const RADIANS_A_STEP: f64 = 20.0;

/// Steps of the exponential are so long, in radians.
const RESOLVED: f64 = 1.0;
/// An oscillator takes `dop853` so many evaluations a radian, times this power of 1/tolerance; `rkn8` half as many.
const A_RADIAN: f64 = 2.7;
const GAIN: f64 = 0.115;
/// Stability lets explicit methods take no fewer a radian of what has died away.
const A_RADIAN_AT_REST: f64 = 2.0;
/// Forces that change are looked at at so many times.
const LOOKS: usize = 40;

/// `exact` evaluates a force so often a step; it makes matrices of so many lengths before the first break, and so many for each
/// length of time between two breaks, which are alike to that part of themselves; an explicit method takes so many evaluations more
/// for each.
const EVALUATIONS_A_STEP: f64 = 9.0;
const FIRST_LENGTHS: f64 = 1.5;
const LENGTHS_A_BREAK: f64 = 1.5;
const ALIKE: f64 = 1e-9;
const AT_A_BREAK: f64 = 12.0;

/// The method of the settings, or the one that suits the system, the tolerance and how long it runs from y.
pub(super) fn choose(settings: &Settings, system: &dyn System, y: &[f64]) -> Choice {
    let because = |method, why| Choice { method, why: Some(why) };
    let description = system.description();
    let structure = &description.structure;
    match settings.method {
        Method::Auto if settings.step.is_some() => because(Method::Rk4, "a step is given"),
        Method::Auto if settings.where_stiff == WhereStiff::Turned => {
            let slides = (Method::Radau5, "what slides in space begins so slowly that its direction is stiff");
            let decays = (Method::Rodas5P, "stability would hold an explicit method to far more steps");
            let (method, why) = if slides_in_space(system) { slides } else { decays };
            because(method, why)
        }
        Method::Auto if is_on_parabolas(settings, description) && !may_be_held(system, settings.from, y) => {
            because(Method::Verlet, "accelerations are constant, so that its parabolas are exact")
        }
        // The exponential's steps are no longer than what decays fastest, long after it is gone.
        Method::Auto if is_stiff(settings, system, y) => {
            because(Method::Rodas5P, "what decays at the start is much faster than what vibrates")
        }
        Method::Auto if is_linear(system) && vibrates_unseen(settings, system, y) => {
            Choice { method: Method::Rodas5P, why: Some("what vibrates fastest is not seen at this tolerance") }
        }
        Method::Auto if is_linear(system) && system.len() <= LARGEST && exact_pays(settings, system, y) => {
            let driven = "linear with constant coefficients, driven by time alone, for long enough";
            let free = "linear with constant coefficients, for long enough";
            because(Method::Exact, if structure.time_dependent { driven } else { free })
        }
        Method::Auto
            if structure.separable && description.rows.is_empty() && !may_be_held(system, settings.from, y) =>
        {
            because(Method::Rkn8, "M is constant and no force depends on speeds")
        }
        Method::Auto if settings.tolerance > LOOSE => because(Method::Dopri5, "the tolerance is loose"),
        Method::Auto if settings.tolerance > LOOSE_WHERE_CUT && is_cut(description) => {
            because(Method::Dopri5, "the tolerance is not tight, and events or discontinuities end steps")
        }
        Method::Auto => because(Method::Dop853, "nothing is stiff, and the tolerance is not loose"),
        method => Choice { method, why: None },
    }
}

/// How many more steps are too many where stability limits them, for `auto` to begin again with a stiff method; `None` where it does not.  What slides in
/// space slowly, as where it begins to at its limit, turns as fast as it is slow: of such steps any are too many.
pub(super) fn steps_where_stiff(system: &dyn System, settings: &Settings) -> Option<f64> {
    let turns = settings.method == Method::Auto && settings.where_stiff == WhereStiff::Turns;
    match slides_in_space(system) {
        true => turns.then_some(0.0),
        false => (turns && system.len() <= LARGEST_STIFF).then(|| MANY_STEPS * (system.len() as f64 / USUAL).max(1.0)),
    }
}

/// Whether a run that stability limits at a state begins again with a stiff method: where the fastest there decays rather than vibrates, which
/// a stiff method would damp.
pub(super) fn turns(system: &dyn System, t: f64, y: &[f64]) -> bool {
    let (q, v) = y.split_at(y.len() / 2);
    let rates = rates_however_many(system, t, q, v).unwrap_or_default();
    let fastest = rates.into_iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
    fastest.is_some_and(|rate| -rate.re > rate.im.abs()) || slides_in_space(system)
}

/// Whether there are contacts that slide in any direction.
fn slides_in_space(system: &dyn System) -> bool {
    system.contacts().all.iter().any(|contact| contact.direction.is_some())
}

/// Whether this is a linear system with constant coefficients, of which Lagrange's equations are solved.
fn is_linear(system: &dyn System) -> bool {
    let description = system.description();
    description.structure.linear && description.rows.is_empty() && system.derivation().is_none()
}

/// Whether something vibrates so fast that every method but a stiff one takes very many steps for it, and too little to be seen:
/// a method that need not follow it gets through the start in far fewer steps than it has vibrations.
fn vibrates_unseen(settings: &Settings, system: &dyn System, y: &[f64]) -> bool {
    let (n, span) = (system.len(), settings.until - settings.from);
    let Ok(rate) = fastest_rate(system, settings.from, y) else { return false };
    let radians = span * rate;
    if n > LARGEST || radians.is_nan() || radians < MANY_RADIANS {
        return false;
    }
    let trial = Settings {
        q: y[..n].to_vec(),
        v: y[n..].to_vec(),
        method: Method::Rodas5P,
        until: settings.from + TRIED * span,
        every: Some(span),
        max_steps: (TRIED * radians / RADIANS_A_STEP) as u64,
        dense: false,
        watch: false,
        digits: false,
        apart: false,
        ..settings.clone()
    };
    super::simulate(&mut *system.boxed_clone(), &trial).is_ok()
}

/// Whether a motion by forces of places alone begins at rest on a discontinuity to which both sides push back: it stays, which methods for such forces
/// do not know.
fn may_be_held(system: &dyn System, t: f64, y: &[f64]) -> bool {
    let (n, switches) = (system.len(), &system.description().switches);
    let mut side = system.boxed_clone();
    if switches.is_empty() || choose_sides(&mut *side, t, y).is_err() {
        return false;
    }
    let (still, sides, mut pairs) = (vec![0.0; n], side.modes().to_vec(), vec![0.0; 2 * switches.len()]);
    side.switches(At::packed(t, y, n).accelerated(&still), &mut pairs);
    let mut with = |switch: usize, mode: f64| {
        let mut modes = sides.clone();
        modes[switch] = mode;
        side.set_modes(&modes);
        let mut a = vec![0.0; n];
        let moves = side.accelerations(At::packed(t, y, n), &mut a).is_ok();
        (moves.then_some(a), fractions(&*side, t, y))
    };
    (0..switches.len()).filter(|switch| pairs[2 * switch..2 * switch + 2] == [0.0, 0.0]).any(|switch| {
        let [below, above] = [0.0, 1.0].map(|w| with(switch, sliding::mode(switches[switch].kind, w)).0);
        let between = with(switch, SLIDES).1.is_some_and(|w| w.iter().all(|w| (0.0..=1.0).contains(w)));
        !switches[switch].time_only && below != above && between
    })
}

/// Whether every motion between two events is a parabola: constraints act as they are written, and not by springs.
fn is_on_parabolas(settings: &Settings, description: &Description) -> bool {
    let keeps = description.rows.is_empty() || settings.enforcement == Enforcement::Multipliers;
    let verlet = Settings { method: Method::Verlet, ..settings.clone() };
    description.structure.uniformly_accelerated && keeps && verlet.inseparable(description).is_none()
}

/// Whether events and discontinuities that the state meets divide the motion.
fn is_cut(description: &Description) -> bool {
    description.events.iter().any(Event::changes_motion) || description.switches.iter().any(|switch| !switch.time_only)
}

/// Whether the exponential of a matrix and its products cost less than the evaluations of an explicit method.
fn exact_pays(settings: &Settings, system: &dyn System, y: &[f64]) -> bool {
    let (n, span) = (system.len(), settings.until - settings.from);
    let Ok(rate) = fastest_rate(system, settings.from, y) else { return false };
    let description = system.description();
    let counted = f64::from(description.counts.accelerations);
    let evaluation = if counted > 0.0 { counted } else { 10.0 * n as f64 };
    let driven = description.structure.time_dependent;
    let (exponential, step) = operations_of_exact(n, driven);
    if !driven {
        let explicit = explicit_evaluations(settings, system, y, (rate, 0.0));
        return (exponential + step * span * rate / RESOLVED) / evaluation < explicit;
    }
    let (Some(Breaks { times, lengths }), Ok(longest)) =
        (breaks(settings, system, y), longest_step(system, settings.from, y, settings.tolerance))
    else {
        return false;
    };
    let steps = span / longest + times;
    let matrices = FIRST_LENGTHS + LENGTHS_A_BREAK * lengths;
    let explicit = explicit_evaluations(settings, system, y, (rate, times)) + AT_A_BREAK * times;
    steps * EVALUATIONS_A_STEP + (exponential * matrices + step * steps) / evaluation < explicit
}

/// Evaluations that an explicit method takes of a linear system whose rates are `fastest` at the most: those of the mode that turns
/// most often while it is there.  A mode is there as long as forces bend, and after the start and each of so many breaks until
/// it has decayed to the tolerance.
fn explicit_evaluations(settings: &Settings, system: &dyn System, y: &[f64], (fastest, breaks): (f64, f64)) -> f64 {
    let (n, span) = (system.len(), settings.until - settings.from);
    let structure = &system.description().structure;
    let a_radian = if structure.separable { 0.5 * A_RADIAN } else { A_RADIAN };
    let driven = if structure.time_dependent { span * driven_part(settings, system, y) } else { 0.0 };
    let decays = (1.0 + breaks) * (1.0 / settings.tolerance).ln().max(0.0);
    let lasts = |decay: f64| if decay > 0.0 { span.min(driven + decays / decay) } else { span };
    let modes = rates(system, settings.from, &y[..n], &y[n..]);
    let ring = modes.map_or(span * fastest, |modes| {
        modes.iter().fold(0.0_f64, |most, rate| most.max(rate.norm() * lasts(-rate.re)))
    });
    (ring * a_radian * settings.tolerance.powf(-GAIN)).max(A_RADIAN_AT_REST * span * fastest)
}

/// During which part of the time what drives a system bends: the mean over the largest second derivative of an acceleration at a fixed
/// state, which of a sine is 2/π, at times that keep step with nothing.
fn driven_part(settings: &Settings, system: &dyn System, y: &[f64]) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let (n, span) = (system.len(), settings.until - settings.from);
    let tick = 1e-3 * span / LOOKS as f64;
    let mut a = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
    let (mut sum, mut most, mut size) = (vec![0.0; n], vec![0.0_f64; n], vec![0.0_f64; n]);
    for k in 0..LOOKS {
        let t = settings.from + (span - 2.0 * tick) * (k as f64 * GOLDEN).fract();
        let times = [t, t + tick, t + 2.0 * tick];
        let known = a.iter_mut().zip(times).all(|(a, t)| system.accelerations(At::packed(t, y, n), a).is_ok());
        for i in (0..n).filter(|_| known) {
            let bend = (a[0][i] - 2.0 * a[1][i] + a[2][i]).abs();
            sum[i] += bend;
            (most[i], size[i]) = (most[i].max(bend), size[i].max(a[1][i].abs()));
        }
    }
    let bends = |i: usize| most[i] > 1e-12 * size[i];
    let of = |i: usize| if bends(i) { 0.5 * std::f64::consts::PI * sum[i] / (LOOKS as f64 * most[i]) } else { 0.0 };
    (0..n).map(of).fold(0.0, f64::max).min(1.0)
}

/// At how many times steps must end, and how many different lengths of time lie between them.
struct Breaks {
    times: f64,
    lengths: f64,
}

/// `None` where they are too many to be listed.
fn breaks(settings: &Settings, system: &dyn System, y: &[f64]) -> Option<Breaks> {
    let mut copy = system.boxed_clone();
    let locator = EventLocator::new(&mut *copy, (settings.from, settings.until), y, false).ok()?;
    let stops = locator.map_or_else(Vec::new, |locator| locator.stop_times());
    let mut between: Vec<f64> = stops.windows(2).map(|pair| pair[1] - pair[0]).collect();
    between.sort_by(f64::total_cmp);
    between.dedup_by(|a, b| *a - *b <= ALIKE * *b);
    // More than are kept are made again each time.
    let kept = between.len() <= LENGTHS_OF_EXACT / 2;
    let lengths = if kept { between.len().min(stops.len()) } else { stops.len() };
    Some(Breaks { times: stops.len() as f64, lengths: lengths as f64 })
}

/// Whether something decays so fast that steps would have to follow it long after it is gone.
fn is_stiff(settings: &Settings, system: &dyn System, y: &[f64]) -> bool {
    let (n, span) = (system.len(), settings.until - settings.from);
    if system.description().damping_pattern.is_empty() || n > LARGEST {
        return false;
    }
    let at = At::packed(settings.from, y, n);
    let mut slopes = AccelerationSlopes::new(n);
    if slopes.evaluate(system, at).is_err() {
        return false;
    }
    let fastest = slopes.by_speed().iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
    if fastest * span < MANY_STEPS {
        return false;
    }
    let Some(rates) = all_rates(system, settings.from, at.q, at.v) else { return false };
    let decay = rates.iter().fold(0.0_f64, |most, rate| most.max(-rate.re));
    let vibration = rates.iter().fold(1.0 / span, |most: f64, rate| most.max(rate.im.abs()).max(rate.re));
    decay * span > MANY_STEPS && decay > FASTER * vibration
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::{Action, Direction, Rated};
    use crate::testing::Toy;

    fn chosen(toy: &Toy, change: impl Fn(&mut Settings)) -> Method {
        let mut settings = Settings::new(&toy.scene);
        change(&mut settings);
        let y = [settings.q.as_slice(), settings.v.as_slice()].concat();
        let Choice { method, why } = choose(&settings, toy, &y);
        assert_eq!(why.is_some(), settings.method == Method::Auto);
        method
    }

    /// x'' = −d x' − x.
    fn damped(d: f64, until: f64) -> Toy {
        let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), until, move |_, q, v, _, a| a[0] = -d * v[0] - q[0]);
        toy.jacobian = std::sync::Arc::new(move |_, _, _, dq, dv| (dq[0], dv[0]) = (1.0, d));
        toy
    }

    #[test]
    fn the_method_follows_from_the_system_and_the_tolerance() {
        let pendulum = Toy::pendulum(9.81, 1.0, 10.0);
        assert_eq!(chosen(&pendulum, |_| ()), Method::Rkn8);
        assert_eq!(chosen(&pendulum, |settings| settings.step = Some(0.1)), Method::Rk4);
        assert_eq!(chosen(&pendulum, |settings| settings.method = Method::Radau5), Method::Radau5);
    }

    #[test]
    fn constant_accelerations_are_parabolas_unless_springs_stand_for_constraints() {
        let mut ball = Toy::new(&["y"], (&[1.0], &[0.0]), 1.0, |_, _, _, _, a| a[0] = -9.81).separable();
        assert_eq!(chosen(&ball, |_| ()), Method::Rkn8);
        ball.description.structure.uniformly_accelerated = true;
        assert_eq!(chosen(&ball, |_| ()), Method::Verlet);
        assert_eq!(chosen(&ball, |settings| settings.step = Some(0.1)), Method::Rk4);
        ball.description.rows = vec![crate::mechanism::Row { holonomic: true, ..Default::default() }].into();
        assert_eq!(chosen(&ball, |_| ()), Method::Verlet);
        let springs = Enforcement::Springs { stiffness: 1e6, damping: 0.0 };
        assert_eq!(chosen(&ball, |settings| settings.enforcement = springs), Method::Dop853);
    }

    #[test]
    fn order_five_serves_loose_tolerances_and_less_loose_ones_where_phases_follow_each_other() {
        let mut toy = damped(0.1, 10.0);
        let at = |toy: &Toy, tolerance| chosen(toy, |settings| settings.tolerance = tolerance);
        assert_eq!(
            [1e-3, 2e-4, 1e-6].map(|tolerance| at(&toy, tolerance)),
            [Method::Dopri5, Method::Dop853, Method::Dop853]
        );
        let event = |action| Event {
            name: "event".into(),
            direction: Direction::Both,
            conditional: false,
            phases: None,
            actions: vec![action].into(),
            rated: Rated::Unknown,
        };
        toy.description.events = vec![event(Action::Stop)].into();
        assert_eq!(at(&toy, 1e-4), Method::Dop853);
        toy.description.events = vec![event(Action::Phase(0))].into();
        assert_eq!([1e-4, 1e-6].map(|tolerance| at(&toy, tolerance)), [Method::Dopri5, Method::Dop853]);
    }

    /// Its eigenvalues have the real part 0, of either sign.
    #[test]
    fn what_does_not_decay_is_there_until_the_end() {
        let (steady, settled) = (damped(0.0, 1000.0), damped(1.0, 1000.0));
        let evaluations = |toy: &Toy| explicit_evaluations(&Settings::new(&toy.scene(0)), toy, &[1.0, 0.0], (1.0, 0.0));
        assert!(evaluations(&steady) > 3.0 * evaluations(&settled), "{}", evaluations(&steady));
    }

    #[test]
    fn linear_systems_are_propagated_exactly_for_long_enough() {
        let mut toy = damped(0.1, 10.0);
        toy.description.structure.linear = true;
        assert_eq!(chosen(&toy, |_| ()), Method::Exact);
        assert_eq!(chosen(&toy, |settings| settings.until = 0.1), Method::Dop853);
        toy.description.structure.time_dependent = true;
        assert_eq!(chosen(&toy, |_| ()), Method::Exact);
        assert_eq!(chosen(&toy, |settings| settings.until = 0.5), Method::Dop853);
    }

    /// Of two decoupled masses one vibrates 10⁵ times as fast.
    #[test]
    fn a_vibration_is_followed_where_it_is_seen() {
        let mirror = |z: f64, until: f64| {
            let names = (&[1.0, z][..], &[0.0; 2][..]);
            let mut toy = Toy::new(&["x", "z"], names, until, |_, q, _, _, a| (a[0], a[1]) = (-q[0], -1e10 * q[1]));
            toy.jacobian = std::sync::Arc::new(|_, _, _, dq, _| (dq[0], dq[3]) = (1.0, 1e10));
            toy.description.structure.linear = true;
            toy
        };
        assert_eq!(chosen(&mirror(0.0, 100.0), |_| ()), Method::Rodas5P);
        assert_eq!(chosen(&mirror(0.1, 100.0), |_| ()), Method::Exact);
        // A second of it is no great matter.
        assert_eq!(chosen(&mirror(0.0, 1.0), |_| ()), Method::Exact);
    }

    /// What decays is followed to the tolerance no longer than it is there.
    #[test]
    fn what_dies_away_early_does_not_make_the_exponential_pay() {
        // Ten coordinates, of which the exponential costs eight evaluations a radian.
        let chain = |decay: f64| {
            let n = 10;
            let names = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"];
            let mut toy = Toy::new(&names, (&vec![1.0; n], &vec![0.0; n]), 1000.0, move |_, q, v, _, a| {
                a.iter_mut().zip(q.iter().zip(v)).for_each(|(a, (q, v))| *a = -decay * v - q);
            });
            toy.jacobian = std::sync::Arc::new(move |_, _, _, dq, dv| {
                for i in 0..n {
                    (dq[i * n + i], dv[i * n + i]) = (1.0, decay);
                }
            });
            toy.description.structure.linear = true;
            toy
        };
        assert_eq!(chosen(&chain(1e-3), |_| ()), Method::Exact);
        assert_eq!(chosen(&chain(0.5), |_| ()), Method::Dop853);
    }

    #[test]
    fn what_decays_fast_is_stiff_only_where_the_run_is_long_beside_it() {
        assert_eq!(chosen(&damped(1e5, 10.0), |_| ()), Method::Rodas5P);
        assert_eq!(chosen(&damped(1e5, 1e-3), |_| ()), Method::Dop853);
        let mut linear = damped(1e5, 10.0);
        linear.description.structure.linear = true;
        assert_eq!(chosen(&linear, |_| ()), Method::Rodas5P);
        assert_eq!(chosen(&linear, |settings| settings.until = 0.01), Method::Exact);
        assert_eq!(chosen(&damped(10.0, 10.0), |_| ()), Method::Dop853);
    }
}
