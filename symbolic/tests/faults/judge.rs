// Whether an altered model moves otherwise: decided apart from the gate, at other states, by another solver, by another
// measure.
//
// The gate puts accelerations into equations and measures what is left of an equation by the running magnitudes of its
// terms, sums of everything that rounding could act on.  Here the altered equations are solved, and each acceleration is
// compared with the sound one.  The measure of row i is |a_i| + Σ_j |M_ij a_j|/M_ii + (the largest single term of h_i when
// products are multiplied out)/M_ii: no magnitude of another row enters it, and no error is carried along.

use std::collections::HashMap;

use dalembert_symbolic::derive::{Derivation, Switch, SwitchKind, rates};
use dalembert_symbolic::expr::{Binary, DoubleDouble, Graph, Id, Scalar, Symbol, Tape, Unary, jacobian};
use dalembert_symbolic::model::{BalanceSystem, Check, Conserved, Model};

use super::moments::{Moment, Run, moments, runs, sides};

/// So many of all states are moved into a window.
const IN_WINDOW: usize = 24;

/// A value, and the largest single term of its expression when products are multiplied out.
#[derive(Clone, Copy)]
struct Term {
    value: DoubleDouble,
    largest: f64,
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
    inputs: Vec<Tape>,
    switches: Vec<(SwitchKind, Tape)>,
    places: Vec<(usize, usize)>,
    equations: Tape,
}

/// What a state does not hold itself: inputs with two rates, and the modes of discontinuities.
struct Known<'m, S> {
    moment: &'m Moment,
    inputs: Vec<Vec<S>>,
    modes: Vec<S>,
}

impl<S: Scalar> Known<'_, S> {
    fn value(&self, symbol: Symbol) -> S {
        let zero = S::constant(DoubleDouble::ZERO);
        let found = self.moment.value(symbol).or_else(|| match symbol {
            Symbol::Input(k, order) => self.inputs.get(k as usize)?.get(usize::from(order)).copied(),
            Symbol::Mode(k) => self.modes.get(k as usize).copied(),
            _ => None,
        });
        found.unwrap_or(zero)
    }
}

impl Route {
    pub fn new(derivation: &Derivation) -> Route {
        let Derivation { model, equations, switches, .. } = derivation;
        let graph = &model.graph;
        let (mass, bias) = (&equations[0].mass, &equations[0].bias);
        let roots: Vec<Id> = mass.iter().map(|e| e.2).chain(bias.iter().copied()).collect();
        let switch = |s: &Switch| (s.kind, Tape::new(graph, &[s.argument]));
        Route {
            n: bias.len(),
            inputs: model.inputs.iter().map(|input| Tape::new(graph, &input.signal)).collect(),
            switches: switches.iter().map(switch).collect(),
            places: mass.iter().map(|e| (e.0, e.1)).collect(),
            equations: Tape::new(graph, &roots),
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

    fn known<'m, S: Scalar>(&self, moment: &'m Moment) -> Known<'m, S> {
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

    /// The solution of M a = −h.
    pub fn accelerations(&self, moment: &Moment) -> Option<Vec<DoubleDouble>> {
        let known = self.known::<DoubleDouble>(moment);
        let values = self.equations.evaluate(|s| known.value(s));
        self.solved(&values)
    }

    fn solved(&self, values: &[DoubleDouble]) -> Option<Vec<DoubleDouble>> {
        let mut rows = vec![vec![DoubleDouble::ZERO; self.n + 1]; self.n];
        for ((i, j), m) in self.places.iter().zip(values) {
            rows[*i][*j] = *m;
            rows[*j][*i] = *m;
        }
        for (row, h) in rows.iter_mut().zip(&values[self.places.len()..]) {
            row[self.n] = -*h;
        }
        solve(rows)
    }

    /// Accelerations, and the measure of each row.
    fn measured(&self, moment: &Moment) -> Option<Seen> {
        let known = self.known::<Term>(moment);
        let terms: Vec<Term> = self.equations.evaluate(|s| known.value(s));
        let values: Vec<DoubleDouble> = terms.iter().map(|t| t.value).collect();
        let a = self.solved(&values)?;
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
        let scales = (0..self.n).map(|i| a[i].to_f64().abs() + sizes[i] / diagonal[i]).collect();
        Some(Seen { moment: moment.clone(), a, scales })
    }
}

/// A state, its sound accelerations, and the measure of each row.
struct Seen {
    moment: Moment,
    a: Vec<DoubleDouble>,
    scales: Vec<f64>,
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
    pub runs: Vec<Run>,
    seen: Vec<Seen>,
}

/// A window in which alone a fault acts: these numbers lie between these bounds.
pub type Window = Vec<(Symbol, f64, f64)>;

impl Judge {
    pub fn new(sound: &Derivation) -> Judge {
        let route = Route::new(sound);
        let runs = runs(&sound.model, &route);
        let mut judge = Judge { route, runs, seen: Vec::new() };
        judge.seen = judge.seen_at(&moments(&sound.model, &judge.route, &judge.runs, &[]));
        judge
    }

    fn seen_at(&self, moments: &[Moment]) -> Vec<Seen> {
        let finite = |seen: &Seen| seen.a.iter().all(|a| a.is_finite()) && seen.scales.iter().all(|s| s.is_finite());
        moments.iter().filter_map(|m| self.route.measured(m)).filter(finite).collect()
    }

    /// States within a window.
    fn within(&self, window: &Window) -> Vec<Seen> {
        let place = |part: f64| {
            move |m: &Moment, (symbol, low, high): &(Symbol, f64, f64)| m.with(*symbol, low + part * (high - low))
        };
        let moved = |m: &Moment, part: f64| window.iter().fold(m.clone(), |m, side| place(part)(&m, side));
        if window.is_empty() {
            return Vec::new();
        }
        // From the motion and from all that was drawn, for a parameter may be 0 in every scene; and on both sides of what
        // changes within the window.
        let apart = self.seen.len().div_ceil(IN_WINDOW).max(1);
        let chosen = self.seen.iter().take(12).chain(self.seen.iter().skip(12).step_by(apart));
        let mut moments: Vec<Moment> =
            chosen.map(|seen| &seen.moment).flat_map(|m| [moved(m, 0.5), moved(m, 0.2)]).collect();
        moments.extend(sides(&self.route, &moments));
        self.seen_at(&moments)
    }

    /// By how much of its row some acceleration of an altered model differs: of Lagrange's equations and of every system
    /// of balances.  Infinite where there is none.
    pub fn difference(&self, altered: &Derivation, window: &Window) -> f64 {
        let route = Route::new(altered);
        let inside = self.within(window);
        let seen: Vec<&Seen> = self.seen.iter().chain(&inside).collect();
        let lagrange = seen
            .iter()
            .map(|seen| route.accelerations(&seen.moment).map_or(f64::INFINITY, |found| seen.difference(&found)));
        let mut model = altered.model.clone();
        let systems = std::mem::take(&mut model.balances);
        let balances = systems.iter().map(|system| of_system(&mut model, system, &route, &seen));
        lagrange.chain(balances).fold(0.0, f64::max)
    }

    /// By how much of its largest term a check fails.
    pub fn failure(&self, altered: &Derivation, check: &Check) -> f64 {
        let route = Route::new(altered);
        let sides: Vec<Id> = check.left.iter().chain(&check.right).copied().collect();
        let tape = Tape::new(&altered.model.graph, &sides);
        let moments = moments(&altered.model, &self.route, &self.runs, &check.when);
        let seen = self.seen_at(&moments);
        let failures = seen.iter().map(|seen| {
            let known = route.known::<Term>(&seen.moment);
            let values = tape.evaluate(|s| match s {
                Symbol::Acceleration(i) => Term::constant(seen.a[i as usize]),
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
        let drifts = seen.iter().flat_map(|seen| {
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
    let reactions = system.reactions.iter().flat_map(|&k| {
        let reaction = &model.reactions[k];
        (0..reaction.components as u32).map(|c| Symbol::Reaction(reaction.first + c))
    });
    let unknowns: Vec<Symbol> = (0..n).map(|i| Symbol::Acceleration(i as u32)).chain(reactions).collect();
    let place: HashMap<Symbol, usize> = unknowns.iter().enumerate().map(|(k, s)| (*s, k)).collect();
    let (sums, slopes) = linear(&mut model.graph, system, &place);
    let roots: Vec<Id> = sums.iter().copied().chain(slopes.iter().flatten().map(|e| e.1)).collect();
    let tape = Tape::new(&model.graph, &roots);
    let mut largest: Option<f64> = None;
    for seen in seen {
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
        let Some(found) = solve(rows) else { continue };
        // Of equations that are not linear this is no solution.
        let at = |s: Symbol| place.get(&s).map_or_else(|| known.value(s), |k| found[*k]);
        let left = tape.evaluate(at);
        let scale = found.iter().chain(&values).fold(0.0_f64, |most, x| most.max(x.abs().to_f64()));
        let solved = left[..sums.len()].iter().all(|x| x.abs().to_f64() <= 1e-6 * scale);
        let difference = if solved { seen.difference(&found[..n]) } else { f64::INFINITY };
        largest = Some(largest.unwrap_or(0.0).max(difference));
    }
    largest.unwrap_or(f64::INFINITY)
}

/// The equations of a system as sums, and their slopes by the unknowns.
fn linear(
    graph: &mut Graph,
    system: &BalanceSystem,
    place: &HashMap<Symbol, usize>,
) -> (Vec<Id>, Vec<Vec<(usize, Id)>>) {
    let mut sums = Vec::new();
    for balance in &system.balances {
        for k in 0..balance.components {
            sums.push(balance.parts.iter().fold(Id::ZERO, |sum, part| graph.add(sum, part.value[k])));
        }
    }
    let slopes = jacobian(graph, &sums, |s| place.get(&s).copied());
    (sums, slopes)
}

/// Gauss and Jordan's elimination of an augmented matrix, rows and columns scaled, with pivots from all of them.
fn solve(mut rows: Vec<Vec<DoubleDouble>>) -> Option<Vec<DoubleDouble>> {
    let n = rows.len();
    let size = |x: DoubleDouble| x.to_f64().abs();
    if rows.iter().any(|row| row.len() != n + 1) {
        return None;
    }
    for row in &mut rows {
        let scale = row[..n].iter().fold(0.0_f64, |most, x| most.max(size(*x)));
        row.iter_mut().for_each(|x| *x = *x / DoubleDouble::from(scale));
    }
    let scales: Vec<f64> = (0..n).map(|j| rows.iter().fold(0.0_f64, |most, row| most.max(size(row[j])))).collect();
    for row in &mut rows {
        row.iter_mut().zip(&scales).for_each(|(x, scale)| *x = *x / DoubleDouble::from(*scale));
    }
    let mut order: Vec<usize> = Vec::new();
    for k in 0..n {
        let free = |j: &usize| !order.contains(j);
        let places = (k..n).flat_map(|i| (0..n).filter(free).map(move |j| (i, j)));
        let (i, j) = places.max_by(|a, b| size(rows[a.0][a.1]).total_cmp(&size(rows[b.0][b.1])))?;
        if size(rows[i][j]).is_nan() || size(rows[i][j]) < 1e-16 {
            return None;
        }
        rows.swap(k, i);
        let pivot = rows[k].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            let factor = row[j] / pivot[j];
            if other != k && factor != DoubleDouble::ZERO {
                row.iter_mut().zip(&pivot).for_each(|(x, p)| *x = *x - factor * *p);
            }
        }
        order.push(j);
    }
    let mut solution = vec![DoubleDouble::ZERO; n];
    for (k, j) in order.into_iter().enumerate() {
        solution[j] = rows[k][n] / rows[k][j] / DoubleDouble::from(scales[j]);
    }
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
