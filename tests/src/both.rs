//! Generated code against the interpreter of the same program.

use dalembert::mechanism::{At, System};

/// A time, a state near a scene's start, and accelerations that are not those of the motion.
pub struct Drawn {
    /// Time.
    pub t: f64,
    /// Coordinates.
    pub q: Vec<f64>,
    /// Their rates.
    pub v: Vec<f64>,
    /// Accelerations.
    pub a: Vec<f64>,
}

/// Everything that a system computes at a state.
fn everything(system: &dyn System, state: &Drawn) -> Vec<(&'static str, Vec<f64>)> {
    let Drawn { t, q, v, a } = state;
    let description = system.description();
    let mut all = Vec::new();
    let mut collect = |name, size: usize, compute: &dyn Fn(&mut [f64])| {
        let mut values = vec![0.0; size];
        compute(&mut values);
        all.push((name, values));
    };
    let n = q.len();
    collect("accelerations", n, &|x| system.accelerations(At::new(*t, q, v), x).expect("a regular mass matrix"));
    collect("mass matrix", description.mass_pattern.len(), &|x| system.mass_matrix(At::new(*t, q, v), x));
    collect("bias", n, &|x| system.bias(At::new(*t, q, v), x));
    collect("residual", n, &|x| system.residual(At::new(*t, q, v).accelerated(a), x));
    let (stiffness, damping) = (description.stiffness_pattern.len(), description.damping_pattern.len());
    collect("stiffness", stiffness, &|x| {
        system.jacobians(At::new(*t, q, v).accelerated(a), x, &mut vec![0.0; damping])
    });
    collect("damping", damping, &|x| system.jacobians(At::new(*t, q, v).accelerated(a), &mut vec![0.0; stiffness], x));
    collect("inputs' Jacobian", description.input_pattern.len(), &|x| {
        system.input_jacobian(At::new(*t, q, v).accelerated(a), x)
    });
    let timed = description.time_pattern.len();
    let at = At::new(*t, q, v).accelerated(a);
    collect("time Jacobian", timed, &|x| system.time_jacobian(at, x));
    collect("time dependence", timed, &|x| system.time_dependence(at, x));
    collect("magnitudes", n, &|x| system.magnitudes(at, x));
    collect("inputs", 3 * description.inputs.len(), &|x| system.inputs(*t, x));
    collect("invariants", 2 * description.invariant_len(), &|x| system.invariants(At::new(*t, q, v), x));
    collect("outputs", description.output_len(), &|x| system.outputs(At::new(*t, q, v).accelerated(a), x));
    collect("events", 2 * description.events.len(), &|x| system.events(At::new(*t, q, v).accelerated(a), x));
    collect("event rates", description.events.len(), &|x| system.event_rates(At::new(*t, q, v).accelerated(a), x));
    let assigned: usize = system.sampling().sets.iter().map(|targets| targets.len()).sum();
    collect("assignments", assigned, &|x| system.assignments(At::new(*t, q, v).accelerated(a), x));
    collect("memory", system.sampling().memory.len(), &|x| x.copy_from_slice(&system.scene_memory(0)));
    collect("clocks", 2 * system.sampling().clocks.len(), &|x| x.copy_from_slice(system.clocks().as_flattened()));
    collect("arguments", 2 * description.arguments.len(), &|x| system.arguments(At::new(*t, q, v).accelerated(a), x));
    collect("switches", 2 * description.switches.len(), &|x| system.switches(At::new(*t, q, v).accelerated(a), x));
    collect("drawing", description.drawing_len(), &|x| system.drawing(At::new(*t, q, v), x));
    let energy = system.energy(At::new(*t, q, v));
    collect("energy", 5, &|x| {
        x.copy_from_slice(&[energy.kinetic, energy.potential, energy.jacobi, energy.power, energy.scale]);
    });
    for k in 0..description.balances.len() {
        let size = description.balances[k].unknowns.len();
        collect("balances", size * (size + 1), &|x| {
            let (matrix, right) = x.split_at_mut(size * size);
            system.balances(k, At::new(*t, q, v), matrix, right);
        });
    }
    all.push(("parameters", system.parameters()));
    all.push(("equilibrium", system.equilibrium_guess().unwrap_or_default()));
    all
}

/// Panics where two systems differ at a state by more than this share of what they compute.
pub fn assert_same(name: &str, compiled: &dyn System, interpreted: &dyn System, state: &Drawn, tolerance: f64) {
    let pairs = everything(compiled, state).into_iter().zip(everything(interpreted, state));
    for ((what, found), (_, expected)) in pairs {
        assert_eq!(found.len(), expected.len(), "{name}: {what}");
        let scale = expected.iter().filter(|x| x.is_finite()).fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
        for (x, y) in found.iter().zip(&expected) {
            let same = (x - y).abs() <= tolerance * scale || x == y || x.is_nan() && y.is_nan();
            assert!(same, "{name}: {what}: {x} and {y}");
        }
    }
}
