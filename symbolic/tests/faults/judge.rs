// Whether an altered model moves otherwise: decided apart from the gate, at other states, by another solver, by another
// measure.
//
// The gate puts accelerations into equations and measures what is left of an equation by the running magnitudes of its
// terms, sums of everything that rounding could act on.  Here the altered equations are solved, and each acceleration is
// compared with the sound one.  The measure of row i is |a_i| + Σ_j |M_ij a_j|/M_ii + (the largest single term of h_i when
// products are multiplied out)/M_ii + Σ_k |J_ki λ_k|/M_ii: no magnitude of another row enters it, and no error is carried
// along.  Constraints J a + γ = 0 are solved together with either side's equations; look in `bound.rs`.

use std::collections::{BTreeMap, HashMap};

use dalembert_symbolic::derive::{Derivation, Switch, SwitchKind, rates};
use dalembert_symbolic::expr::{Binary, DoubleDouble, Graph, Id, Scalar, Symbol, Tape, Unary, jacobian, substitute};
use dalembert_symbolic::model::{BalanceSystem, Check, Conserved, Model, Rotation};

use super::bound::Bound;
use super::moments::{Moment, Run, moments, runs, sides};
use super::solve::solve;

/// So many of all states are moved into a window.
const IN_WINDOW: usize = 24;

/// Where a reaction nearly vanishes it is measured by so much of its largest value.
const SMALL: f64 = 1e-6;

/// A value, and the largest single term of its expression when products are multiplied out.
#[derive(Clone, Copy)]
pub struct Term {
    pub value: DoubleDouble,
    pub largest: f64,
}

impl Scalar for Term {
    fn constant(value: DoubleDouble) -> Term {
        Term { value, largest: value.to_f64().abs() }
    }

    fn unary(function: Unary, x: Term) -> Term {
        let value = DoubleDouble::unary(function, x.value);
        let kept = matches!(function, Unary::Neg | Unary::Abs);
        Term { value, largest: if kept { x.largest } else { value.to_f64().abs() } }
    }

    fn binary(operation: Binary, x: Term, y: Term) -> Term {
        let value = DoubleDouble::binary(operation, x.value, y.value);
        let largest = match operation {
            Binary::Add | Binary::Sub => x.largest.max(y.largest),
            Binary::Mul => x.largest * y.largest,
            Binary::Div => x.largest / y.value.to_f64().abs(),
            _ => value.to_f64().abs(),
        };
        Term { value, largest }
    }
}

/// Lagrange's equations of one derivation, ready to be evaluated and solved.
pub struct Route {
    n: usize,
    pub bound: Bound,
    inputs: Vec<Tape>,
    switches: Vec<(SwitchKind, Tape)>,
    places: Vec<(usize, usize)>,
    equations: Tape,
    /// Slopes of h by the multipliers, where friction of reactions stands in it: (coordinate, row), and their values.
    rubbed: Vec<(usize, usize)>,
    friction: Tape,
}

/// Held values are any numbers, the same at all moments.
const HELD: f64 = 0.71;

/// What a state does not hold itself: inputs with two rates, and the modes of discontinuities.
pub struct Known<'m, S> {
    pub moment: &'m Moment,
    pub inputs: Vec<Vec<S>>,
    pub modes: Vec<S>,
}

impl<S: Scalar> Known<'_, S> {
    /// The value of a symbol, of unknowns 0.
    pub fn value(&self, symbol: Symbol) -> S {
        let zero = S::constant(DoubleDouble::ZERO);
        let found = self.moment.value(symbol).or_else(|| match symbol {
            Symbol::Input(k, order) => self.inputs.get(k as usize)?.get(usize::from(order)).copied(),
            Symbol::Mode(k) => self.modes.get(k as usize).copied(),
            Symbol::Memory(j) => Some(S::constant(DoubleDouble::from(HELD * f64::from(j + 1)))),
            _ => None,
        });
        found.unwrap_or(zero)
    }
}

/// Accelerations, and the multipliers of all rows.
pub struct Solution {
    pub a: Vec<DoubleDouble>,
    lambda: Vec<DoubleDouble>,
}

impl Route {
    pub fn new(derivation: &Derivation) -> Route {
        let Derivation { model, equations, switches, .. } = derivation;
        let mut graph = model.graph.clone();
        let (mass, bias) = (&equations[0].mass, &equations[0].bias);
        let of_row = |s: Symbol| if let Symbol::Multiplier(k) = s { Some(k as usize) } else { None };
        let slopes = jacobian(&mut graph, bias, of_row).into_iter().enumerate();
        let friction: Vec<(usize, usize, Id)> =
            slopes.flat_map(|(i, line)| line.into_iter().map(move |(k, x)| (i, k, x))).collect();
        let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
        let switch = |s: &Switch| (s.kind, Tape::new(&graph, &[s.argument]));
        Route {
            n: bias.len(),
            bound: Bound::new(model),
            inputs: model.inputs.iter().map(|input| Tape::new(&graph, &input.signal)).collect(),
            switches: switches.iter().map(switch).collect(),
            places: mass.iter().map(|e| (e.0, e.1)).collect(),
            equations: Tape::new(&graph, &roots),
            rubbed: friction.iter().map(|e| (e.0, e.1)).collect(),
            friction: Tape::new(&graph, &friction.iter().map(|e| e.2).collect::<Vec<Id>>()),
        }
    }

    /// How many discontinuities there are.
    pub fn discontinuities(&self) -> usize {
        self.switches.len()
    }

    /// The argument of one of them.
    pub fn argument(&self, k: usize, moment: &Moment) -> f64 {
        let known = self.known::<f64>(moment);
        self.switches[k].1.evaluate(|s| known.value(s))[0]
    }

    /// Inputs and modes at a state.
    pub fn known<'m, S: Scalar>(&self, moment: &'m Moment) -> Known<'m, S> {
        let mut known = Known { moment, inputs: Vec::new(), modes: Vec::new() };
        for tape in &self.inputs {
            let signal = tape.evaluate(|s| known.value(s));
            known.inputs.push(signal);
        }
        for (kind, tape) in &self.switches {
            let argument = tape.evaluate(|s| known.value(s))[0];
            let function = if *kind == SwitchKind::Sign { Unary::Sign } else { Unary::Step };
            known.modes.push(S::unary(function, argument));
        }
        known
    }

    /// M's diagonal.
    pub fn diagonal(&self, known: &Known<'_, DoubleDouble>) -> Vec<DoubleDouble> {
        let values = self.equations.evaluate(|s| known.value(s));
        let mut diagonal = vec![DoubleDouble::ZERO; self.n];
        self.places.iter().zip(values).filter(|((i, j), _)| i == j).for_each(|((i, _), m)| diagonal[*i] = m);
        diagonal
    }

    /// The solution of M a + h(λ) − Jᵀλ = 0, J a + γ = 0.
    pub fn solution(&self, moment: &Moment) -> Option<Solution> {
        let known = self.known::<DoubleDouble>(moment);
        let values = self.equations.evaluate(|s| known.value(s));
        let held = self.bound.at(&known, self.n);
        let size = self.n + held.active.len();
        let mut rows = vec![vec![DoubleDouble::ZERO; size + 1]; size];
        for ((i, j), m) in self.places.iter().zip(&values) {
            rows[*i][*j] = *m;
            rows[*j][*i] = *m;
        }
        for (row, h) in rows.iter_mut().zip(&values[self.places.len()..]) {
            row[size] = -*h;
        }
        for (k, (line, bias)) in held.matrix.iter().zip(&held.bias).enumerate() {
            for (i, x) in line.iter().enumerate() {
                rows[self.n + k][i] = *x;
                rows[i][self.n + k] = -*x;
            }
            rows[self.n + k][size] = -*bias;
        }
        for ((i, row), slope) in self.rubbed.iter().zip(self.friction.evaluate(|s| known.value(s))) {
            if let Some(k) = held.active.iter().position(|active| active == row) {
                rows[*i][self.n + k] += slope;
            }
        }
        let mut a = solve(rows, self.n)?;
        let mut lambda = vec![DoubleDouble::ZERO; self.bound.rows()];
        held.active.iter().zip(a.split_off(self.n)).for_each(|(row, x)| lambda[*row] = x);
        Some(Solution { a, lambda })
    }

    /// Accelerations, and the measure of each row.
    fn measured(&self, moment: &Moment) -> Option<Seen> {
        let Solution { a, lambda } = self.solution(moment)?;
        let exact = self.known::<DoubleDouble>(moment);
        let held = self.bound.at(&exact, self.n);
        let known = self.known::<Term>(moment);
        let plain = |x: DoubleDouble| Term { value: x, largest: x.to_f64().abs() };
        let terms: Vec<Term> = self.equations.evaluate(|s| match s {
            Symbol::Multiplier(k) => plain(lambda[k as usize]),
            _ => known.value(s),
        });
        let values: Vec<DoubleDouble> = terms.iter().map(|t| t.value).collect();
        let mut diagonal = vec![0.0; self.n];
        let mut sizes: Vec<f64> = terms[self.places.len()..].iter().map(|h| h.largest).collect();
        for ((i, j), m) in self.places.iter().zip(&values) {
            let m = m.to_f64().abs();
            sizes[*i] += m * a[*j].to_f64().abs();
            if i == j {
                diagonal[*i] = m;
            } else {
                sizes[*j] += m * a[*i].to_f64().abs();
            }
        }
        for (row, line) in held.active.iter().zip(&held.matrix) {
            (0..self.n).for_each(|i| sizes[i] += (line[i] * lambda[*row]).to_f64().abs());
        }
        let scales: Vec<f64> = (0..self.n).map(|i| a[i].to_f64().abs() + sizes[i] / diagonal[i]).collect();
        let mut forces: Vec<Term> = lambda.iter().map(|x| plain(*x)).collect();
        for (row, line) in held.active.iter().zip(&held.matrix) {
            let (felt, yields) = line
                .iter()
                .map(|x| x.to_f64().abs())
                .enumerate()
                .fold((0.0, 0.0), |(f, y), (i, x)| (f + x * scales[i], y + x * x / diagonal[i]));
            forces[*row].largest += felt / yields;
        }
        Some(Seen { moment: moment.clone(), a, scales, forces })
    }
}

/// A state, its sound accelerations with the measure of each row, and its sound multipliers.
struct Seen {
    moment: Moment,
    a: Vec<DoubleDouble>,
    scales: Vec<f64>,
    forces: Vec<Term>,
}

impl Seen {
    /// The largest difference of an acceleration, by the measure of its row.
    fn difference(&self, found: &[DoubleDouble]) -> f64 {
        let rows = found.iter().zip(&self.a).zip(&self.scales);
        let relative = rows.map(|((x, a), scale)| {
            let gap = (*x - *a).abs().to_f64();
            if gap == 0.0 { 0.0 } else { gap / scale }
        });
        relative.fold(0.0, f64::max)
    }
}

/// The sound motion of a model.
pub struct Judge {
    route: Route,
    /// Its systems of balances, for what they say of reactions.
    sound: Model,
    pub runs: Vec<Run>,
    seen: Vec<Seen>,
}

/// A window in which alone a fault acts: these numbers lie between these bounds.
pub type Window = Vec<(Symbol, f64, f64)>;

/// Work of no more than this of its terms is none.
const NONE: f64 = 1e-20;

impl Judge {
    pub fn new(sound: &Derivation) -> Judge {
        let route = Route::new(sound);
        let runs = runs(&sound.model, &route);
        let mut judge = Judge { route, sound: sound.model.clone(), runs, seen: Vec::new() };
        judge.seen = judge.seen_at(&moments(&sound.model, &judge.route, &judge.runs, &[]));
        judge
    }

    /// How many states of a phase are seen.
    pub fn states(&self, phase: usize) -> usize {
        self.seen.iter().filter(|seen| seen.moment.phase == phase).count()
    }

    fn seen_at(&self, moments: &[Moment]) -> Vec<Seen> {
        let finite = |seen: &Seen| seen.a.iter().all(|a| a.is_finite()) && seen.scales.iter().all(|s| s.is_finite());
        moments.iter().filter_map(|m| self.route.measured(m)).filter(finite).collect()
    }

    /// States within a window.
    fn within(&self, window: &Window) -> Vec<Seen> {
        if window.is_empty() {
            return Vec::new();
        }
        let moved = |m: &Moment, part: f64| {
            window.iter().fold(m.clone(), |m, (symbol, low, high)| m.with(*symbol, low + part * (high - low)))
        };
        let inside = |m: &Moment| window.iter().all(|(s, low, high)| m.number(*s) > *low && m.number(*s) < *high);
        // Constraints bring the others back, or, where there are too few others, those of the window too.
        let bounded = |i: usize| window.iter().any(|side| side.0 == Symbol::Coordinate(i as u32));
        let held: Vec<bool> = (0..self.route.n).map(bounded).collect();
        let closed = |m: Moment| {
            let found = self.route.closed(&m, (&held, &[])).or_else(|| self.route.closed(&m, (&[], &[])));
            found.filter(|m| inside(m))
        };
        // From the motion and from all that was drawn, for a parameter may be 0 in every scene; and on both sides of what
        // changes within the window.
        let apart = self.seen.len().div_ceil(IN_WINDOW).max(1);
        let chosen = self.seen.iter().take(12).chain(self.seen.iter().skip(12).step_by(apart));
        let placed = chosen.map(|seen| &seen.moment).flat_map(|m| [moved(m, 0.5), moved(m, 0.2)]);
        let mut moments: Vec<Moment> = placed.filter_map(closed).collect();
        let passed = self.runs.iter().flat_map(|run| &run.moments);
        moments.extend(passed.filter(|m| inside(m)).take(IN_WINDOW).cloned());
        moments.extend(sides(&self.route, &moments));
        self.seen_at(&moments)
    }

    /// By how much of its row some acceleration of an altered model differs: of Lagrange's equations and of every system
    /// of balances, infinite where there is none.  In the phases of its systems; and in those that have none.
    pub fn difference(&self, altered: &Derivation, window: &Window) -> (f64, f64) {
        let route = Route::new(altered);
        let inside = self.within(window);
        let seen: Vec<&Seen> = self.seen.iter().chain(&inside).collect();
        let (mut compared, mut elsewhere) = (0.0_f64, 0.0_f64);
        for seen in &seen {
            let found = route.solution(&seen.moment);
            let gap = found.map_or(f64::INFINITY, |found| seen.difference(&found.a));
            let covered = altered.model.balances.iter().any(|system| system.phases.contains(&seen.moment.phase));
            let most = if covered { &mut compared } else { &mut elsewhere };
            *most = most.max(gap);
        }
        let mut model = altered.model.clone();
        let systems = std::mem::take(&mut model.balances);
        for system in &systems {
            let own: Vec<&Seen> = seen.iter().copied().filter(|s| system.phases.contains(&s.moment.phase)).collect();
            compared = compared.max(of_system(&mut model, system, &route, &own));
        }
        (compared, elsewhere)
    }

    /// By how much of itself the force or moment of some reaction on some body differs, by the reaction's name, in systems with
    /// equations that are written out: there a reaction is what these make of it.
    pub fn reactions(&self, altered: &Derivation, window: &Window) -> BTreeMap<String, f64> {
        let route = Route::new(altered);
        let inside = self.within(window);
        let mut differences = BTreeMap::new();
        for system in altered.model.balances.iter().filter(|system| !system.bodies.is_empty()) {
            let Some(sound) = self.sound.balances.iter().find(|sound| sound.name == system.name) else { continue };
            let seen: Vec<&Seen> =
                self.seen.iter().chain(&inside).filter(|s| system.phases.contains(&s.moment.phase)).collect();
            let right = forces(&mut self.sound.clone(), sound, &self.route, &seen);
            let found = forces(&mut altered.model.clone(), system, &route, &seen);
            let size = |forces: &Vec<DoubleDouble>| forces.iter().fold(0.0_f64, |most, x| most.max(x.abs().to_f64()));
            for (k, reaction) in system.reactions.iter().enumerate() {
                let name = altered.model.reactions[*reaction].name.clone();
                let largest = right.iter().flatten().filter_map(|all| all.get(k)).map(size).fold(0.0, f64::max);
                for (right, found) in right.iter().zip(&found) {
                    let (Some(right), Some(found)) = (right, found) else { continue };
                    let (Some(right), Some(found)) = (right.get(k), found.get(k)) else { continue };
                    let gap = size(&right.iter().zip(found).map(|(x, y)| *x - *y).collect());
                    let relative = if gap == 0.0 { 0.0 } else { gap / size(right).max(SMALL * largest) };
                    let most = differences.entry(name.clone()).or_insert(0.0_f64);
                    *most = most.max(relative);
                }
            }
        }
        differences
    }

    /// By how much what equations that are written out leave over on some body alone, of inertia less all forces and named reactions, does
    /// work on it where it does none in the sound model: supports that nobody names do none.
    pub fn work_left_over(&self, altered: &Derivation, window: &Window) -> f64 {
        let route = Route::new(altered);
        let inside = self.within(window);
        let mut most = 0.0_f64;
        for system in altered.model.balances.iter().filter(|system| !system.bodies.is_empty()) {
            let Some(sound) = self.sound.balances.iter().find(|sound| sound.name == system.name) else { continue };
            let seen: Vec<&Seen> =
                self.seen.iter().chain(&inside).filter(|s| system.phases.contains(&s.moment.phase)).collect();
            let right = work_left_over(&mut self.sound.clone(), sound, &self.route, &seen);
            let found = work_left_over(&mut altered.model.clone(), system, &route, &seen);
            let relative = |(work, terms): (f64, f64)| if work == 0.0 { 0.0 } else { work / terms };
            for direction in 0..right.iter().flatten().map(Vec::len).min().unwrap_or(0) {
                let of = |works: &[Works]| {
                    let own = works.iter().flatten().filter_map(|works| works.get(direction).copied());
                    own.map(relative).fold(0.0, f64::max)
                };
                if of(&right) < NONE {
                    most = most.max(of(&found));
                }
            }
        }
        most
    }

    /// By how much of its largest term a check fails.
    pub fn failure(&self, altered: &Derivation, check: &Check) -> f64 {
        let route = Route::new(altered);
        let sides: Vec<Id> = check.left.iter().chain(&check.right).copied().collect();
        let tape = Tape::new(&altered.model.graph, &sides);
        let moments = moments(&altered.model, &self.route, &self.runs, &check.when);
        let seen = self.seen_at(&moments);
        let claimed = |seen: &&Seen| check.phases.as_ref().is_none_or(|phases| phases.contains(&seen.moment.phase));
        let failures = seen.iter().filter(claimed).map(|seen| {
            let known = route.known::<Term>(&seen.moment);
            let values = tape.evaluate(|s| match s {
                Symbol::Acceleration(i) => Term::constant(seen.a[i as usize]),
                Symbol::Multiplier(k) => seen.forces[k as usize],
                _ => known.value(s),
            });
            let (left, right) = values.split_at(check.left.len());
            let sides = left.iter().zip(right).map(|(l, r)| {
                let gap = (l.value - r.value).abs().to_f64();
                if gap == 0.0 { 0.0 } else { gap / l.largest.max(r.largest) }
            });
            sides.map(|gap| gap.is_finite().then_some(gap)).try_fold(0.0, |most, gap| Some(f64::max(most, gap?)))
        });
        // What is undefined at most states does not hold there.
        let failures: Vec<Option<f64>> = failures.collect();
        let defined = failures.iter().flatten().count();
        if 2 * defined < failures.len() {
            return f64::INFINITY;
        }
        failures.into_iter().flatten().fold(0.0, f64::max)
    }

    /// How fast what a claim calls conserved changes, by the largest term of its rate.
    pub fn drift(&self, altered: &Derivation, claim: &Conserved) -> f64 {
        let route = Route::new(altered);
        let mut graph = altered.model.graph.clone();
        let rates = rates(&mut graph, &claim.value);
        let tape = Tape::new(&graph, &rates);
        let seen = self.seen_at(&moments(&altered.model, &self.route, &self.runs, &claim.when));
        let claimed = |seen: &&Seen| claim.phases.as_ref().is_none_or(|phases| phases.contains(&seen.moment.phase));
        let drifts = seen.iter().filter(claimed).flat_map(|seen| {
            let known = route.known::<Term>(&seen.moment);
            let values = tape.evaluate(|s| match s {
                Symbol::Acceleration(i) => Term { value: seen.a[i as usize], largest: seen.scales[i as usize] },
                _ => known.value(s),
            });
            let relative = |rate: Term| {
                let size = rate.value.abs().to_f64();
                if size == 0.0 { 0.0 } else { size / rate.largest }
            };
            values.into_iter().map(relative).filter(|x| x.is_finite())
        });
        drifts.fold(0.0, f64::max)
    }
}

/// By how much of its row some acceleration that a system of balances gives differs, wherever it has a solution.
fn of_system(model: &mut Model, system: &BalanceSystem, route: &Route, seen: &[&Seen]) -> f64 {
    let n = model.coordinates.len();
    let found = solved(model, system, route, seen);
    let differences = found.iter().zip(seen).filter_map(|(found, seen)| match found {
        Solved::Nothing => None,
        Solved::Nonlinear => Some(f64::INFINITY),
        Solved::Unknowns(found) => Some(seen.difference(&found[..n])),
    });
    differences.fold(None, |most: Option<f64>, x| Some(most.unwrap_or(0.0).max(x))).unwrap_or(f64::INFINITY)
}

/// The forces and moments of each reaction of a system on all bodies, where the system has a solution.
fn forces(
    model: &mut Model,
    system: &BalanceSystem,
    route: &Route,
    seen: &[&Seen],
) -> Vec<Option<Vec<Vec<DoubleDouble>>>> {
    let n = model.coordinates.len();
    let acts = |k: usize| if system.phases.first() == Some(&k) { Id::ONE } else { Id::ZERO };
    let indicators = (0..route.bound.phases()).map(|k| (Symbol::Phase(k as u32), acts(k))).collect();
    let rows = substitute(&mut model.graph, &system.bodies, &indicators);
    let reactions: Vec<(u32, usize)> =
        system.reactions.iter().map(|&k| (model.reactions[k].first, model.reactions[k].components)).collect();
    let components: Vec<Symbol> =
        reactions.iter().flat_map(|(first, count)| (*first..first + *count as u32).map(Symbol::Reaction)).collect();
    let slopes = jacobian(&mut model.graph, &rows, |s| components.iter().position(|c| *c == s));
    let entries: Vec<(usize, usize, Id)> =
        slopes.iter().enumerate().flat_map(|(d, line)| line.iter().map(move |(k, x)| (d, *k, *x))).collect();
    let tape = Tape::new(&model.graph, &entries.iter().map(|e| e.2).collect::<Vec<_>>());
    let found = solved(model, system, route, seen);
    let at = |(found, seen): (&Solved, &&Seen)| {
        let Solved::Unknowns(found) = found else { return None };
        let known = route.known::<DoubleDouble>(&seen.moment);
        let values = tape.evaluate(|s| known.value(s));
        let mut first = 0;
        let of = |(_, count): &(u32, usize)| {
            let own = first..first + count;
            first = own.end;
            let mut forces = vec![DoubleDouble::ZERO; rows.len()];
            let entries = entries.iter().zip(&values).filter(|((_, k, _), _)| own.contains(k));
            entries.for_each(|((d, k, _), x)| forces[*d] += *x * found[n + k]);
            forces
        };
        Some(reactions.iter().map(of).collect())
    };
    found.iter().zip(seen).map(at).collect()
}

/// Of each body and coordinate the work at a state and the sum of its terms; `None` where the system has no solution.
type Works = Option<Vec<(f64, f64)>>;

/// What a body's left-over force and moment do by each coordinate's motion.
fn work_left_over(model: &mut Model, system: &BalanceSystem, route: &Route, seen: &[&Seen]) -> Vec<Works> {
    let n = model.coordinates.len();
    let acts = |k: usize| if system.phases.first() == Some(&k) { Id::ONE } else { Id::ZERO };
    let indicators = (0..route.bound.phases()).map(|k| (Symbol::Phase(k as u32), acts(k))).collect();
    let rows = substitute(&mut model.graph, &system.bodies, &indicators);
    let coordinate = |s: Symbol| if let Symbol::Coordinate(i) = s { Some(i as usize) } else { None };
    let speed = |s: Symbol| if let Symbol::Speed(i) = s { Some(i as usize) } else { None };
    let (mut owners, mut slopes) = (Vec::new(), Vec::new());
    for (b, body) in model.bodies.clone().into_iter().enumerate() {
        let graph = &mut model.graph;
        slopes.extend(jacobian(graph, &body.position, coordinate));
        match &body.rotation {
            Some(Rotation::Plane { angle, .. }) => slopes.extend(jacobian(graph, &[*angle], coordinate)),
            Some(Rotation::Space { frame, .. }) => slopes.extend(jacobian(graph, &frame.velocity, speed)),
            None => {}
        }
        owners.resize(slopes.len(), b);
    }
    let reactions: Vec<Symbol> = system
        .reactions
        .iter()
        .flat_map(|&k| {
            let reaction = &model.reactions[k];
            (0..reaction.components as u32).map(|c| Symbol::Reaction(reaction.first + c))
        })
        .collect();
    let roots: Vec<Id> = rows.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(&model.graph, &roots);
    let found = solved(model, system, route, seen);
    let at = |(found, seen): (&Solved, &&Seen)| {
        let Solved::Unknowns(found) = found else { return None };
        let known = route.known::<Term>(&seen.moment);
        let values = tape.evaluate(|s| match s {
            Symbol::Acceleration(i) => Term::constant(found[i as usize]),
            Symbol::Multiplier(k) => seen.forces[k as usize],
            s => match reactions.iter().position(|reaction| *reaction == s) {
                Some(k) => Term::constant(found[n + k]),
                None => known.value(s),
            },
        });
        let mut works = vec![(DoubleDouble::ZERO, 0.0); n * model.bodies.len()];
        let mut slope = values[rows.len()..].iter();
        for ((entries, owner), left) in slopes.iter().zip(&owners).zip(&values) {
            for ((i, _), slope) in entries.iter().zip(slope.by_ref()) {
                let (work, terms) = &mut works[owner * n + i];
                *work += left.value * slope.value;
                *terms += left.largest * slope.value.abs().to_f64();
            }
        }
        Some(works.into_iter().map(|(work, terms)| (work.abs().to_f64(), terms)).collect())
    };
    found.iter().zip(seen).map(at).collect()
}

/// What a system of balances is at a state.
enum Solved {
    /// It has no solution.
    Nothing,
    /// It is not linear in its unknowns.
    Nonlinear,
    /// Accelerations, then reactions, then multipliers.
    Unknowns(Vec<DoubleDouble>),
}

/// The solutions of a system of balances, state by state.
fn solved(model: &mut Model, system: &BalanceSystem, route: &Route, seen: &[&Seen]) -> Vec<Solved> {
    let n = model.coordinates.len();
    let sums = sums(&mut model.graph, system, route.bound.phases());
    let reactions = system.reactions.iter().flat_map(|&k| {
        let reaction = &model.reactions[k];
        (0..reaction.components as u32).map(|c| Symbol::Reaction(reaction.first + c))
    });
    let mut multipliers: Vec<Symbol> = model.graph.symbols(sums.iter().copied()).into_iter().collect();
    multipliers.retain(|s| matches!(s, Symbol::Multiplier(_)));
    multipliers.sort_unstable();
    let accelerations = (0..n).map(|i| Symbol::Acceleration(i as u32));
    let unknowns: Vec<Symbol> = accelerations.chain(reactions).chain(multipliers).collect();
    let place: HashMap<Symbol, usize> = unknowns.iter().enumerate().map(|(k, s)| (*s, k)).collect();
    let slopes = jacobian(&mut model.graph, &sums, |s| place.get(&s).copied());
    let roots: Vec<Id> = sums.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(&model.graph, &roots);
    let at = |seen: &&Seen| {
        let known = route.known::<DoubleDouble>(&seen.moment);
        let value = |s: Symbol| if place.contains_key(&s) { DoubleDouble::ZERO } else { known.value(s) };
        let values = tape.evaluate(value);
        let mut slope = values[sums.len()..].iter();
        let mut rows = vec![vec![DoubleDouble::ZERO; unknowns.len() + 1]; sums.len()];
        for ((row, entries), rest) in rows.iter_mut().zip(&slopes).zip(&values) {
            row[unknowns.len()] = -*rest;
            for (column, _) in entries {
                row[*column] = slope.next().copied().unwrap_or(DoubleDouble::ZERO);
            }
        }
        let held = route.bound.at(&known, n);
        for (line, bias) in held.matrix.iter().zip(&held.bias) {
            let mut row = vec![DoubleDouble::ZERO; unknowns.len() + 1];
            row[..n].copy_from_slice(line);
            row[unknowns.len()] = -*bias;
            rows.push(row);
        }
        let Some(found) = solve(rows, unknowns.len()) else { return Solved::Nothing };
        // Of equations that are not linear this is no solution.
        let at = |s: Symbol| place.get(&s).map_or_else(|| known.value(s), |k| found[*k]);
        let left = tape.evaluate(at);
        let scale = found.iter().chain(&values).fold(0.0_f64, |most, x| most.max(x.abs().to_f64()));
        let solved = left[..sums.len()].iter().all(|x| x.abs().to_f64() <= 1e-6 * scale);
        if solved { Solved::Unknowns(found) } else { Solved::Nonlinear }
    };
    seen.iter().map(at).collect()
}

/// The equations of a system as sums, as they are in its first phase.
fn sums(graph: &mut Graph, system: &BalanceSystem, phases: usize) -> Vec<Id> {
    let mut sums = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            sums.push(balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k])));
        }
    }
    let acts = |k: usize| if system.phases.first() == Some(&k) { Id::ONE } else { Id::ZERO };
    let indicators = (0..phases).map(|k| (Symbol::Phase(k as u32), acts(k))).collect();
    substitute(graph, &sums, &indicators)
}
