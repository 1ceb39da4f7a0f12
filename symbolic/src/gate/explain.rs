//! Which forces change what should be conserved.
//!
//! Along the motion dI/dt = ∂I/∂t + ∂I/∂q·q' + ∂I/∂q'·q'', and q'' = M⁻¹(ΣQ + …), so that the share of one force is
//! ∂I/∂q'·M⁻¹Q; for I = T + V it is the force's power q'·Q.  Where the shares of some forces make up the whole rate
//! at all states, they are the cause.

use super::dense::factor;
use super::effects::{Effect, Kind};
use super::potential::{Conservative, Nature, bound};
use super::state::{State, describe};
use crate::derive::Equations;
use crate::derive::lagrange::speed_gradient;
use crate::diagnose::Step;
use crate::expr::{Graph, Id, Measured, Symbol, Tape};
use crate::model::{Conserved, Model};
use crate::number::DoubleDouble;

/// Shares make up a rate where they leave no more than this of their sizes.
const TOLERANCE: f64 = 1e-16;
/// So many causes are named.
const NAMED: usize = 4;

/// What is needed to tell which entry is the cause.
pub(super) struct Evidence<'a> {
    pub model: &'a Model,
    pub equations: &'a Equations,
    pub effects: &'a [Effect],
    pub natures: &'a [Conservative],
}

impl Evidence<'_> {
    /// What was found about an entry of `forces`, `torques` or `generalized_forces`.
    fn nature(&self, effect: &Effect) -> Option<&Nature> {
        let section = match effect.place.path.first() {
            Some(Step::Key(key)) => key.as_str(),
            _ => "",
        };
        let known = |n: &&Conservative| n.name == effect.name && n.section == section;
        self.natures.iter().find(known).map(|n| &n.nature)
    }
}

/// Who changes an invariant.
pub(super) struct Explanation {
    /// "`push` does work at the rate 3.2".
    pub causes: String,
    /// What to do about it.
    pub help: String,
}

/// The forces whose shares are all of the rate of one component of an invariant, as seen at `worst`.
pub(super) fn explain(
    graph: &mut Graph,
    evidence: &Evidence<'_>,
    invariant: &Conserved,
    (component, rate): (Id, Id),
    states: &[State],
    worst: &State,
) -> Option<Explanation> {
    let shares = Shares::new(graph, evidence, component, rate);
    let seen: Vec<Seen> = states.iter().filter_map(|state| shares.at(state)).collect();
    let here = shares.at(worst)?;
    let left = |seen: &Seen, counted: bool| {
        let taken = evidence.effects.iter().zip(&seen.shares).filter(|(e, _)| counted || !e.kind.counted());
        taken.fold(seen.rate.value, |left, (_, share)| left - *share).to_f64()
    };
    let explains = |counted: bool| {
        let vanishes = |at: &Seen| {
            let size = at.rate.magnitude + at.shares.iter().map(|x| x.to_f64().abs()).sum::<f64>();
            left(at, counted).abs() <= TOLERANCE * size
        };
        !seen.is_empty() && seen.iter().all(vanishes)
    };
    let energy = evidence.model.scope.energies.map(|e| graph.add(e.kinetic, e.potential));
    let moving =
        energy.filter(|energy| *energy == component).and_then(|energy| prescribed(graph, evidence.model, energy));
    let (counted, moving) = match (explains(false), moving) {
        (true, _) => (false, None),
        (false, Some(name)) => (false, Some(name)),
        (false, None) if explains(true) => (true, None),
        (false, None) => return None,
    };
    let mut causes: Vec<(usize, f64)> = here.shares.iter().map(|x| x.to_f64()).enumerate().collect();
    let named = |k: usize| counted || !evidence.effects[k].kind.counted();
    let size: f64 = causes.iter().filter(|(k, _)| named(*k)).map(|(_, x)| x.abs()).sum();
    causes.retain(|&(k, x)| named(k) && x.abs() > 1e-9 * size);
    causes.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let verb = if invariant.counts_energy { "does work at the rate" } else { "changes it at the rate" };
    let mut words: Vec<String> = Vec::new();
    for (place, &(k, x)) in causes.iter().take(NAMED).enumerate() {
        let effect = &evidence.effects[k];
        let verb = if place == 0 { format!(" {verb}") } else { " at".to_owned() };
        words.push(format!("{}{verb} {x:.6e}", effect.words));
    }
    if causes.len() > NAMED {
        words.push("…".to_owned());
    }
    if let Some(name) = &moving {
        let by_time = left(&here, false);
        words.push(format!("what moves with `{name}` does work at the rate {by_time:.6e}"));
    }
    if words.is_empty() {
        // A constraint that moves, say.
        return None;
    }
    let mut help: Vec<String> = Vec::new();
    if invariant.counts_energy && !counted {
        help.extend(causes.iter().take(NAMED).map(|&(k, _)| advice(graph, evidence, &evidence.effects[k])));
    }
    if let Some(name) = moving {
        help.push(format!("the energies contain `{name}`, so the energy is not conserved"));
    }
    // Beside balances a potential has no place in `potential_energy`, and a motor is no spring.
    let homeless = |k: usize| {
        let has_place = evidence.model.balances.is_empty() && invariant.counts_energy;
        !has_place || evidence.nature(&evidence.effects[k]) != Some(&Nature::Potential)
    };
    let forces: Vec<usize> = causes.iter().map(|c| c.0).filter(|k| homeless(*k)).collect();
    if let Some(when) = switched_off(graph, evidence, &forces, states) {
        let or = if help.is_empty() { "" } else { "or " };
        help.push(format!("{or}claim it only where that is absent, `when: {{{when}}}`"));
    }
    Some(Explanation {
        causes: words.join(", "),
        help: format!("at {}: {}", describe(evidence.model, worst), help.join("; ")),
    })
}

/// The rate of an invariant and the share of every effect at a state.
struct Seen {
    rate: Measured,
    shares: Vec<DoubleDouble>,
}

/// The rate of an invariant and the share of every effect, ready to evaluate.
struct Shares {
    tape: Tape,
    mass: Vec<(usize, usize)>,
    n: usize,
    effects: usize,
}

impl Shares {
    fn new(graph: &mut Graph, evidence: &Evidence<'_>, component: Id, rate: Id) -> Shares {
        let n = evidence.model.coordinates.len();
        let slopes = speed_gradient(graph, n, &[(component, Id::ONE)]);
        let mass = evidence.equations.mass.iter();
        let roots: Vec<Id> = std::iter::once(rate)
            .chain(slopes)
            .chain(mass.clone().map(|e| e.2))
            .chain(evidence.effects.iter().flat_map(|e| e.force.iter().copied()))
            .collect();
        let tape = Tape::new(graph, &roots);
        Shares { tape, mass: mass.map(|e| (e.0, e.1)).collect(), n, effects: evidence.effects.len() }
    }

    fn at(&self, state: &State) -> Option<Seen> {
        let measured = self.tape.evaluate(|s| state.measured(s));
        let values: Vec<DoubleDouble> = measured.iter().map(|x| x.value).collect();
        let (rate, rest) = values.split_first()?;
        let (slopes, rest) = rest.split_at(self.n);
        let (entries, forces) = rest.split_at(self.mass.len());
        let mut mass = vec![DoubleDouble::ZERO; self.n * self.n];
        for (&(i, j), m) in self.mass.iter().zip(entries) {
            mass[i * self.n + j] = *m;
            mass[j * self.n + i] = *m;
        }
        let weights = factor(&mass, &vec![0.0; mass.len()], self.n).ok()?.solve(slopes);
        let share = |k: usize| {
            let force = &forces[k * self.n..][..self.n];
            weights.iter().zip(force).fold(DoubleDouble::ZERO, |sum, (w, q)| sum + *w * *q)
        };
        let shares: Vec<DoubleDouble> = (0..self.effects).map(share).collect();
        let finite = rate.is_finite() && shares.iter().all(|x| x.is_finite());
        finite.then_some(Seen { rate: measured[0], shares })
    }
}

/// The input, or `t`, that an expression contains.
fn prescribed(graph: &Graph, model: &Model, root: Id) -> Option<String> {
    graph.symbols([root]).into_iter().find_map(|s| match s {
        Symbol::Time => Some("t".to_owned()),
        Symbol::Input(k, _) => model.inputs.get(k as usize).map(|input| input.name.clone()),
        _ => None,
    })
}

/// What to do about a force that changes the energy.
fn advice(graph: &Graph, evidence: &Evidence<'_>, effect: &Effect) -> String {
    let name = &effect.words;
    if let Some(why) = bound(graph, effect).filter(|_| effect.kind == Kind::Force) {
        return format!("{name} {why}");
    }
    let together = evidence.natures.iter().any(|n| n.name.is_empty());
    let takes_time = "depends on time, so its work is not that of a potential";
    match (effect.kind, evidence.nature(effect)) {
        (Kind::Resistance | Kind::Dissipation, _) => format!("{name} has no potential, it takes energy out"),
        (_, Some(Nature::Potential)) if evidence.model.balances.is_empty() => {
            format!("{name} has a potential: put it in `potential_energy` instead, where `energy` counts it")
        }
        (_, Some(Nature::Potential)) => {
            format!("{name} has a potential: give it as a spring or as gravity, whose potential `energy` counts")
        }
        (_, Some(Nature::TimeDependent)) => format!("{name} {takes_time}"),
        (_, Some(Nature::Velocity { .. })) => format!("{name} depends on velocity and has no potential"),
        (_, Some(Nature::Curl { .. })) if together => {
            format!("{name} has a potential together with the other forces: put that in `potential_energy`")
        }
        (_, Some(Nature::Curl { between: Some((i, j)), value, .. })) => {
            format!("{name} has no potential: ∂Q({i})/∂{j} − ∂Q({j})/∂{i} = {value:.3e}")
        }
        _ => format!("{name} has no potential"),
    }
}

/// `b: 0, c: 0`: for each of these forces one parameter without which it vanishes.
fn switched_off(graph: &Graph, evidence: &Evidence<'_>, forces: &[usize], states: &[State]) -> Option<String> {
    let mut found: Vec<&str> = Vec::new();
    for &k in forces {
        let force = &evidence.effects[k].force;
        let tape = Tape::new(graph, force);
        let parameters = graph.symbols(force.iter().copied()).into_iter().filter_map(|s| match s {
            Symbol::Parameter(p) => Some(p),
            _ => None,
        });
        let vanishes = |p: u32| {
            states.iter().all(|state| {
                let zero = DoubleDouble::ZERO;
                let without = |s: Symbol| if s == Symbol::Parameter(p) { zero } else { state.value(s) };
                tape.evaluate(without).iter().all(|q| *q == zero)
            })
        };
        // A parameter that bodies and springs need too cannot be set to 0.
        let shared = |p: u32| {
            let others = evidence.effects.iter().enumerate().filter(|(other, e)| *other != k && e.kind.counted());
            let roots = evidence.equations.mass.iter().map(|e| e.2).chain(others.flat_map(|(_, e)| e.force.clone()));
            graph.symbols(roots).contains(&Symbol::Parameter(p))
        };
        let p = parameters.into_iter().find(|&p| vanishes(p) && !shared(p))?;
        let name = evidence.model.parameters.get(p as usize)?.name.as_str();
        if !found.contains(&name) {
            found.push(name);
        }
    }
    let words: Vec<String> = found.iter().map(|name| format!("{name}: 0")).collect();
    (!words.is_empty()).then(|| words.join(", "))
}
