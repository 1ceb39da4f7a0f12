//! Whether M, C or K of small motions change with time through inputs, which `modes` holds: parametric excitation.

use crate::linear::Equilibrium;
use crate::mechanism::{At, System};

/// So many instants of the scene are looked at, at odd parts of it.
const INSTANTS: usize = 64;
/// The golden section: multiples of it, without their whole parts, keep step with no vibration.
const SECTION: f64 = 0.618_033_988_749_894_9;
/// A matrix that changes by no more than this part of its largest entry is constant.
const CONSTANT: f64 = 1e-9;

/// What is wrong with small motions about a state whose matrices inputs change in the course of a scene.
pub fn notes(system: &dyn System, at: &Equilibrium, until: f64) -> Vec<String> {
    let n = system.len();
    if at.q.len() != n || at.v.len() != n {
        return Vec::new();
    }
    let inputs: Vec<String> = system.description().inputs.iter().map(ToString::to_string).collect();
    let changes = |k: usize| {
        let mut alone = system.boxed_clone();
        for other in (0..inputs.len()).filter(|other| *other != k) {
            alone.hold_input(other, at.inputs.get(other).copied().unwrap_or(0.0));
        }
        let instants = (1..=INSTANTS).map(|i| until * (SECTION * i as f64).fract());
        let found: Vec<[Vec<f64>; 3]> = instants.map(|t| matrices(&*alone, at, t)).collect();
        let names = ["M", "C", "K"].into_iter().enumerate().filter(|(which, _)| varies(&found, *which));
        names.map(|(_, name)| name).collect::<Vec<&str>>()
    };
    let note = |(k, input): (usize, &String)| {
        let names = changes(k);
        let held = crate::linear::short(at.inputs.get(k).copied().unwrap_or(0.0));
        (!names.is_empty()).then(|| {
            format!(
                "{} {} with time through the input `{input}` (parametric excitation): these modes are those with `{input}` held \
                 at {held}, and motions may grow though all of them decay; `simulate` shows what grows",
                names.join(" and "),
                if names.len() > 1 { "vary" } else { "varies" },
            )
        })
    };
    inputs.iter().enumerate().filter_map(note).collect()
}

/// M, C and K at a state, their entries in a row.
fn matrices(system: &dyn System, at: &Equilibrium, t: f64) -> [Vec<f64>; 3] {
    let zero = vec![0.0; system.len()];
    let here = At::new(t, &at.q, &at.v).accelerated(&zero);
    let structure = system.description();
    let (mut damping, mut stiffness) =
        (vec![0.0; structure.damping_pattern.len()], vec![0.0; structure.stiffness_pattern.len()]);
    system.jacobians(here, &mut stiffness, &mut damping);
    [crate::mechanism::dense::mass_matrix(system, here).as_slice().to_vec(), damping, stiffness]
}

/// Whether some entry of a matrix is not the same at all instants at which it is finite.
fn varies(found: &[[Vec<f64>; 3]], which: usize) -> bool {
    let finite =
        || found.iter().map(|matrices| &matrices[which]).filter(|entries| entries.iter().all(|x| x.is_finite()));
    let largest = finite().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let Some(first) = finite().next() else { return false };
    finite().any(|entries| entries.iter().zip(first).any(|(a, b)| (a - b).abs() > CONSTANT * largest))
}
