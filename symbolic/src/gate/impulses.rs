//! Jumps of the speeds by a second derivation.
//!
//! By Lagrange's equations M Δq' = Jᵀ P.  Balances of force and moment, integrated over the instant, lose all forces that
//! are finite: A [Δq'; P] = 0, whatever the impulses P of their reactions may be.

use super::Gate;
use super::motion::Motion;
use super::report::Agreement;
use super::state::{State, describe};
use super::states::Struck;
use super::system::{Assembled, zero};
use crate::derive::momentum::Momentum;
use crate::diagnose::Problem;
use crate::diagnose::catalogue::verdicts;
use crate::expr::{Measured, Symbol};
use crate::model::{BalanceSystem, Model};

/// Holds every jump of the speeds on the way of a scene against the balances of a phase in which all that pushes acts.
pub(super) fn agree(
    model: &Model,
    motion: &Motion,
    momentum: &[Momentum],
    blows: &[Struck],
    gate: Gate,
) -> Result<Vec<Agreement>, Vec<Problem>> {
    let (mut agreements, mut problems) = (Vec::new(), Vec::new());
    for (system, linear) in model.balances.iter().zip(momentum) {
        let own = blows.iter().filter(|(state, _)| system.phases.contains(&state.phase));
        let known: Vec<(&State, Vec<Measured>)> =
            own.filter_map(|(state, rows)| Some((state, motion.velocity_jump(state, rows)?))).collect();
        if known.is_empty() || !system.balances.iter().any(|balance| balance.instantaneous) {
            continue;
        }
        match compare(model, (system, linear), &known, gate) {
            Ok(agreement) => agreements.push(agreement),
            Err(problem) => problems.push(*problem),
        }
    }
    if problems.is_empty() { Ok(agreements) } else { Err(problems) }
}

fn compare(
    model: &Model,
    (system, linear): (&BalanceSystem, &Momentum),
    blows: &[(&State, Vec<Measured>)],
    gate: Gate,
) -> Result<Agreement, Box<Problem>> {
    let states: Vec<State> = blows.iter().map(|(state, _)| (*state).clone()).collect();
    let equations: Vec<usize> = system
        .balances
        .iter()
        .enumerate()
        .flat_map(|(b, balance)| std::iter::repeat_n(b, balance.components))
        .collect();
    let instantaneous = |b: usize| system.balances[b].instantaneous;
    let mut worst = 0.0_f64;
    for (assembled, (state, change)) in Assembled::derived(&model.graph, linear, &states).into_iter().zip(blows) {
        let integrated =
            over_an_instant(assembled, linear, |equation| equations.get(equation).is_some_and(|b| instantaneous(*b)));
        let kept: Vec<usize> = equations.iter().copied().filter(|b| instantaneous(*b)).collect();
        let left = integrated.left_over(change);
        let largest = left.iter().fold(0.0_f64, |most, (_, r)| most.max(r.magnitude));
        for (equation, r) in left {
            let size = r.value.abs().to_f64();
            if size.is_finite() && !gate.agrees(size, r.magnitude, largest) {
                let balance = &system.balances[kept[equation]];
                let by = format!("{:.1e}", r.relative());
                let problem =
                    verdicts::impulse_violated(balance.place.clone(), &balance.label, by, describe(model, state));
                return Err(Box::new(problem));
            }
            worst = worst.max(r.relative());
        }
    }
    let between = ("impulses by Lagrange".to_owned(), system.name.clone());
    Ok(Agreement { between, states: states.len(), worst })
}

/// Some equations of a system, integrated over an instant: what is finite is nothing, friction of impulses there is none.
fn over_an_instant(system: Assembled, linear: &Momentum, keeps: impl Fn(usize) -> bool) -> Assembled {
    let mut matrix = Vec::new();
    for (_, line) in system.matrix.chunks(system.size.max(1)).enumerate().filter(|(equation, _)| keeps(*equation)) {
        let entries = line.iter().zip(&linear.unknowns);
        matrix.extend(entries.map(|(x, unknown)| if matches!(unknown, Symbol::Multiplier(_)) { zero() } else { *x }));
    }
    let equations = matrix.len() / system.size.max(1);
    Assembled { equations, judged: equations, size: system.size, matrix, rest: vec![zero(); equations] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::derive::{Derivation, derive};
    use crate::gate::states::{own_positions, states};
    use crate::model::load;
    use crate::number::DoubleDouble;

    /// A dumbbell that falls flat on a floor, one ball first, a ball that bounces, and two bars of which a peg catches one:
    /// impacts and entered phases, each with its reactions.
    const FALLS: [&str; 3] = [
        include_str!("../../../models/bouncing_ball.yaml"),
        include_str!("falling_dumbbell.yaml"),
        include_str!("caught_flail.yaml"),
    ];

    fn known(text: &str) -> (Derivation, Motion, Vec<Struck>) {
        let mut derivation = derive(load(text, &[]).expect("a good file")).expect("derives");
        let Derivation { model, equations, rows, switches, .. } = &mut derivation;
        let motion = Motion::new(model, (&equations[0], None), rows, switches);
        let own = own_positions(model, &motion);
        let found = states(model, &motion, &[], &own, Gate::default());
        let blows = found.map_err(|problem| problem.message).expect("states").blows;
        (derivation, motion, blows)
    }

    #[test]
    fn impulses_of_two_derivations_agree() {
        for text in FALLS {
            let (derivation, motion, blows) = known(text);
            let found = agree(&derivation.model, &motion, &derivation.momentum, &blows, Gate::default());
            let agreements = found.unwrap_or_else(|problems| panic!("{problems:?}"));
            assert!(!agreements.is_empty(), "nothing was compared in {text}");
            assert!(agreements.iter().all(|agreement| agreement.worst < 1e-20), "{agreements:?}");
        }
    }

    /// Each component of Δq' that is not 0, off by 1e-12 of itself, flipped or dropped alone.  Where one speed only is
    /// changed, by the one reaction that stops it, any impulse of that is as true: nothing is planted there.
    #[test]
    fn a_fault_in_one_component_of_an_impulse_is_refused() {
        let mut planted = 0;
        for text in FALLS {
            let (derivation, motion, blows) = known(text);
            for (system, linear) in derivation.model.balances.iter().zip(&derivation.momentum) {
                let own = blows.iter().filter(|(state, _)| system.phases.contains(&state.phase));
                for (state, rows) in own {
                    let change = motion.velocity_jump(state, rows).expect("determined");
                    let moved: Vec<usize> =
                        (0..change.len()).filter(|i| change[*i].value != DoubleDouble::ZERO).collect();
                    if moved.len() < 2 {
                        continue;
                    }
                    for (i, factor) in moved.iter().flat_map(|i| [1.0 + 1e-12, -1.0, 0.0].map(|x| (*i, x))) {
                        let mut wrong = change.clone();
                        wrong[i].value = wrong[i].value * DoubleDouble::from(factor);
                        let judged = compare(&derivation.model, (system, linear), &[(state, wrong)], Gate::default());
                        planted += 1;
                        assert!(judged.is_err(), "component {i} times {factor} in {}", system.name);
                    }
                }
            }
        }
        assert_eq!(planted, 21);
    }
}
