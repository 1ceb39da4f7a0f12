//! States where the argument of a function is zero, next to it, or of order one.
//!
//! `step`, `sign`, `abs`, `min` and `max` change at the zero of an argument; `exp`, `tanh`, `atan` and their like, roots
//! and powers say something only where theirs is of order one, which may be a narrow band that no random state meets.
//! Arguments are followed along lines (time, one coordinate, one speed, the way between two states of a motion) and
//! solved for.

use std::collections::BTreeSet;

use super::descend::descend;
use super::motion::Motion;
use super::passage::{passages, signs};
use super::state::{Origin, State};
use crate::expr::{Binary, Id, Node, Symbol, Tape, Unary};
use crate::model::{Model, Work, text_in};
use crate::number::DoubleDouble;

/// So many arguments are followed.
const ARGUMENTS: usize = 48;
/// So many lines are followed for each.
const LINES: usize = 8;
/// So many states are kept for each.
const KEPT: usize = 8;

/// An argument, and what is looked for.
pub(super) struct Argument {
    /// In words.
    words: String,
    tape: Tape,
    /// True where the function changes at zero; false where it is local through its argument.
    switches: bool,
    /// What it depends on.
    symbols: Vec<Symbol>,
}

impl Argument {
    /// Its value at a state.
    pub fn at(&self, state: &State) -> f64 {
        self.tape.evaluate(|s| state.value(s))[0].to_f64()
    }
}

/// A way through the states.
pub(super) enum Line<'a> {
    /// Time alone changes.
    Time(f64),
    /// One coordinate changes.
    Coordinate(usize, f64),
    /// One speed changes.
    Speed(usize, f64),
    /// Straight to another state.
    Between(&'a State),
    /// To the next state of a motion, on the cubic that has the speeds of both.
    Step(&'a State),
}

/// What was found.
pub(super) struct Sides {
    /// States, without their motion.
    pub states: Vec<State>,
    /// States at which the argument of a switch vanishes.
    pub surfaces: Vec<State>,
    /// Arguments that no line brought to zero or to order one, in words.
    pub unreached: Vec<String>,
}

/// Looks for such states where the motion itself meets a discontinuity, and along lines through `bases` and between
/// them; `paths` are the steps of each scene's motion, `until` is the longest scene's end.
pub(super) fn sides(
    model: &Model,
    motion: &Motion,
    (bases, paths): (&[State], &[Vec<State>]),
    until: f64,
    reach: &dyn Fn(usize, bool) -> f64,
) -> Sides {
    let (arguments, more) = arguments(model);
    let switches: Vec<&Argument> = arguments.iter().filter(|a| a.switches).collect();
    let mut found = Sides { states: Vec::new(), surfaces: Vec::new(), unreached: Vec::new() };
    let mut combinations = BTreeSet::new();
    paths.iter().for_each(|path| passages(motion, &switches, path, &mut combinations, &mut found));
    for argument in &arguments {
        let before = found.states.len();
        let mut followed = 0;
        for (k, base) in bases.iter().enumerate() {
            for line in lines(argument, bases, k, until, reach) {
                if followed >= LINES || found.states.len() >= before + KEPT {
                    break;
                }
                followed += 1;
                follow(motion, (argument, &switches), base, &line, &mut found);
            }
        }
        let met = (0..switches.len()).any(|k| std::ptr::eq(switches[k], argument) && both_sides(&combinations, k));
        if found.states.len() == before && !met {
            descend(motion, (argument, &switches), bases, (until, reach), &mut found);
        }
        if found.states.len() == before && !met {
            found.unreached.push(argument.words.clone());
        }
    }
    if more > 0 {
        found.unreached.push(format!("{more} more"));
    }
    found
}

/// Whether a motion was on both sides of a discontinuity.
fn both_sides(combinations: &BTreeSet<Vec<bool>>, k: usize) -> bool {
    [true, false].iter().all(|side| combinations.iter().any(|c| c.get(k) == Some(side)))
}

/// Ways along which an argument may change.
pub(super) fn lines<'a>(
    argument: &Argument,
    bases: &'a [State],
    k: usize,
    until: f64,
    reach: &dyn Fn(usize, bool) -> f64,
) -> Vec<Line<'a>> {
    let mut lines = Vec::new();
    for symbol in &argument.symbols {
        match *symbol {
            Symbol::Time | Symbol::Input(..) if !lines.iter().any(|line| matches!(line, Line::Time(_))) => {
                lines.push(Line::Time(until));
            }
            Symbol::Coordinate(i) => lines.push(Line::Coordinate(i as usize, reach(i as usize, false))),
            Symbol::Speed(i) => lines.push(Line::Speed(i as usize, reach(i as usize, true))),
            _ => {}
        }
    }
    lines.truncate(3);
    if let Some(next) = bases.get(k + 1)
        && next.parameters == bases[k].parameters
    {
        lines.push(Line::Between(next));
    }
    lines
}

/// Where the line is at z.
pub(super) fn moved(motion: &Motion, base: &State, line: &Line<'_>, z: DoubleDouble) -> State {
    let mut state = base.clone();
    match line {
        Line::Time(_) => state.t = z,
        Line::Coordinate(i, _) => state.q[*i] = z,
        Line::Speed(i, _) => state.v[*i] = z,
        Line::Step(_) => {}
        Line::Between(other) => {
            let between = |a: DoubleDouble, b: DoubleDouble| a + z * (b - a);
            state.t = between(base.t, other.t);
            for i in 0..state.q.len() {
                state.q[i] = between(base.q[i], other.q[i]);
                state.v[i] = between(base.v[i], other.v[i]);
            }
        }
    }
    if let Line::Step(next) = line {
        on_the_cubic(&mut state, base, next, z);
    }
    motion.signals(&mut state);
    state.origin = Origin::Side;
    state
}

/// The cubic in time through two states with their speeds (Hermite's), at the fraction z of the way.
fn on_the_cubic(state: &mut State, from: &State, to: &State, z: DoubleDouble) {
    let (one, two) = (DoubleDouble::ONE, DoubleDouble::from(2.0));
    let h = to.t - from.t;
    let rest = one - z;
    state.t = from.t + z * h;
    for i in 0..state.q.len() {
        let (there, way) = (to.q[i], to.q[i] - from.q[i]);
        let bow = rest * (h * from.v[i] - way) - z * (h * to.v[i] - way);
        state.q[i] = rest * from.q[i] + z * there + z * rest * bow;
        let bend = h * (from.v[i] + to.v[i]) - two * way;
        state.v[i] = (way + (one - two * z) * bow - z * rest * bend) / h;
    }
}

/// Places at which an argument is sampled along a line, in order.
fn grid(base: &State, line: &Line<'_>) -> Vec<f64> {
    let even = |low: f64, high: f64, n: usize| (0..=n).map(move |k| low + (high - low) * k as f64 / n as f64);
    let around = |middle: f64, scale: f64| {
        let mut places: Vec<f64> = even(-8.0 * scale, 8.0 * scale, 48).collect();
        places.push(middle);
        for k in -12..=3 {
            let far = scale * 10_f64.powi(k);
            places.extend([far, -far, middle + far, middle - far]);
        }
        places
    };
    let mut places = match line {
        Line::Time(until) => even(0.0, *until, 96).collect(),
        Line::Coordinate(i, scale) => around(base.q[*i].to_f64(), *scale),
        Line::Speed(i, scale) => around(base.v[*i].to_f64(), *scale),
        Line::Between(_) | Line::Step(_) => even(0.0, 1.0, 8).collect(),
    };
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// Follows one argument along one line.
pub(super) fn follow(
    motion: &Motion,
    (argument, switches): (&Argument, &[&Argument]),
    base: &State,
    line: &Line<'_>,
    found: &mut Sides,
) {
    let at = |z: f64| argument.at(&moved(motion, base, line, z.into()));
    let samples = samples(base, line, &at);
    let mut places: Vec<f64> = Vec::new();
    let targets: Vec<f64> = match argument.switches {
        true => vec![0.0],
        false => local_targets(&samples),
    };
    for target in &targets {
        let crossings = samples.windows(2).filter(|w| (w[0].1 - target) * (w[1].1 - target) < 0.0);
        let exact = samples.iter().filter(|s| s.1 == *target).map(|s| (s.0, s.0));
        let brackets: Vec<(f64, f64)> = crossings.map(|w| (w[0].0, w[1].0)).chain(exact).collect();
        // The first, the last and one between.
        let chosen: BTreeSet<usize> = [0, brackets.len() / 2, brackets.len().wrapping_sub(1)].into();
        for k in chosen.into_iter().filter(|k| *k < brackets.len()) {
            places.push(bisect(&|z| at(z) - target, brackets[k]));
        }
    }
    places.sort_by(f64::total_cmp);
    places.dedup();
    for (k, &z) in places.iter().enumerate() {
        if found.states.len() >= 4 * ARGUMENTS {
            return;
        }
        if !argument.switches {
            found.states.push(moved(motion, base, line, DoubleDouble::from(z)));
            continue;
        }
        let room = |other: Option<&f64>| other.map_or(f64::INFINITY, |other| (other - z).abs());
        let near = room(places.get(k + 1)).min(if k > 0 { room(places.get(k - 1)) } else { f64::INFINITY });
        let scale = match line {
            Line::Time(until) => *until,
            Line::Coordinate(_, scale) | Line::Speed(_, scale) => *scale,
            Line::Between(_) | Line::Step(_) => 1.0,
        };
        for side in [-1.0, 1.0] {
            let beside = |aside: f64| moved(motion, base, line, DoubleDouble::from(z + side * aside));
            // A strip ends where another argument changes: not beyond it.
            let first = signs(switches, &beside(1e-9 * scale));
            let mut aside = (1e-3 * scale).min(0.25 * near);
            while aside > 4e-9 * scale && signs(switches, &beside(aside)) != first {
                aside *= 0.25;
            }
            found.states.push(beside(aside));
        }
        found.surfaces.push(moved(motion, base, line, polished(motion, argument, base, line, z)));
    }
}

/// Places on a line and the values there, extrema between them included.
pub(super) fn samples(base: &State, line: &Line<'_>, at: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut samples: Vec<(f64, f64)> = grid(base, line).into_iter().map(|z| (z, at(z))).collect();
    samples.retain(|s| s.1.is_finite());
    for (z, value) in extrema(&samples, at) {
        let place = samples.partition_point(|s| s.0 < z);
        samples.insert(place, (z, value));
    }
    samples
}

/// Values between which a function that is local through its argument changes: ±1, a half, and, for what keeps away from
/// zero, twice the least.
fn local_targets(samples: &[(f64, f64)]) -> Vec<f64> {
    let least = samples.iter().map(|s| s.1).min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(0.0);
    let same_sign = samples.iter().all(|s| s.1 * least > 0.0);
    let mut targets = vec![1.0, -1.0, 0.5, -0.5];
    if same_sign {
        targets.extend([2.0 * least, 1.1 * least]);
    }
    targets
}

/// Extrema between samples, by golden sections, so that a touch or a narrow band is met.
fn extrema(samples: &[(f64, f64)], at: &dyn Fn(f64) -> f64) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    for w in samples.windows(3) {
        let (low, high) = (w[1].1 < w[0].1 && w[1].1 <= w[2].1, w[1].1 > w[0].1 && w[1].1 >= w[2].1);
        if !low && !high || found.len() >= 6 {
            continue;
        }
        let sign = if low { 1.0 } else { -1.0 };
        let golden = 0.618_033_988_749_894_9;
        let (mut a, mut b) = (w[0].0, w[2].0);
        for _ in 0..60 {
            let (c, d) = (b - golden * (b - a), a + golden * (b - a));
            if sign * at(c) < sign * at(d) { b = d } else { a = c }
        }
        let z = 0.5 * (a + b);
        let value = at(z);
        if value.is_finite() && z != w[0].0 && z != w[1].0 && z != w[2].0 {
            found.push((z, value));
        }
    }
    found
}

/// The place where a function changes its sign, to the last bit.
pub(super) fn bisect(f: &dyn Fn(f64) -> f64, (mut a, mut b): (f64, f64)) -> f64 {
    let side = f(a) > 0.0;
    for _ in 0..200 {
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            break;
        }
        if (f(middle) > 0.0) == side { a = middle } else { b = middle }
    }
    b
}

/// The zero of an argument to all digits, by secants.
pub(super) fn polished(motion: &Motion, argument: &Argument, base: &State, line: &Line<'_>, z: f64) -> DoubleDouble {
    let at = |z: DoubleDouble| {
        let state = moved(motion, base, line, z);
        argument.tape.evaluate(|s| state.value(s))[0]
    };
    let mut z0 = DoubleDouble::from(z);
    let mut z1 = DoubleDouble::from(z * (1.0 + 1e-12) + f64::MIN_POSITIVE);
    let (mut f0, mut f1) = (at(z0), at(z1));
    for _ in 0..6 {
        let slope = f1 - f0;
        if slope == DoubleDouble::ZERO || f1 == DoubleDouble::ZERO {
            break;
        }
        let next = z1 - f1 * (z1 - z0) / slope;
        if !next.is_finite() || (next - DoubleDouble::from(z)).abs().to_f64() > 1e-6 * z.abs().max(f64::MIN_POSITIVE) {
            break;
        }
        (z0, f0) = (z1, f1);
        z1 = next;
        f1 = at(z1);
    }
    if f1.abs().to_f64() <= f0.abs().to_f64() { z1 } else { z0 }
}

/// Arguments that move, of everything that the equations, the claims and the checks read, each once; and how many are
/// beyond those that are followed.
fn arguments(model: &Model) -> (Vec<Argument>, usize) {
    let mut graph = model.graph.clone();
    let roots = roots(model);
    let needed = graph.reachable(roots);
    let moving = graph.contains(|s| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_)));
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for i in (0..needed.len()).filter(|&i| needed[i]) {
        let (value, switches) = match graph.node(graph.id_at(i)) {
            Node::Unary(Unary::Abs | Unary::Sign | Unary::Step, x) => (x, true),
            Node::Binary(Binary::Min | Binary::Max, x, y) => (graph.sub(x, y), true),
            Node::Unary(
                Unary::Exp | Unary::Tanh | Unary::Atan | Unary::Sinh | Unary::Cosh | Unary::Sqrt | Unary::Ln,
                x,
            ) => (x, false),
            Node::Binary(Binary::Pow, x, _) | Node::Binary(Binary::Div, _, x) => (x, false),
            _ => continue,
        };
        let moves = moving.get(value.index()).copied().unwrap_or(true);
        let plain = matches!(graph.node(value), Node::Symbol(_)) && !switches;
        if moves && !plain && seen.insert((value, switches)) {
            found.push((value, switches));
        }
    }
    // Switches first: there are things that act only beyond them.
    found.sort_by_key(|(_, switches)| !switches);
    let argument = |(value, switches): (Id, bool)| {
        let symbols = graph.symbols([value]);
        let moving = |s: &Symbol| !matches!(s, Symbol::Parameter(_) | Symbol::Dummy(_));
        Argument {
            words: text_in(&graph, model, value),
            tape: Tape::new(&graph, &[value]),
            switches,
            symbols: symbols.into_iter().filter(moving).collect(),
        }
    };
    let more = found.len().saturating_sub(ARGUMENTS);
    (found.into_iter().take(ARGUMENTS).map(argument).collect(), more)
}

/// All expressions that are judged.
fn roots(model: &Model) -> Vec<Id> {
    let mut roots = vec![model.raw_potential_energy, model.raw_kinetic_energy, model.dissipation];
    roots.extend(model.inputs.iter().flat_map(|input| input.signal));
    roots.extend(model.bodies.iter().flat_map(|b| b.position.iter().copied().chain(b.rotation.map(|r| r.angle))));
    roots.extend(model.generalized_forces.iter().map(|f| f.force));
    for load in &model.loads {
        match load.work {
            Work::Potential(v) => roots.push(v),
            Work::Resistance { rate, tension } => roots.extend([rate, tension]),
            Work::Pushes => {}
        }
        roots.extend(load.pushes.iter().flat_map(|p| p.at.iter().chain(&p.force).chain(&p.couple)).copied());
    }
    roots.extend(model.gravity.iter().flatten());
    let parts = model.balances.iter().flat_map(|system| &system.balances).flat_map(|balance| &balance.parts);
    roots.extend(parts.flat_map(|part| part.value.iter().copied()));
    roots.extend(model.conserved.iter().flat_map(|c| c.value.iter().copied()));
    roots.extend(model.checks.iter().flat_map(|c| c.left.iter().chain(&c.right)).copied());
    roots
}
