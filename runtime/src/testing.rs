//! Mechanisms written by hand, for tests.

use std::sync::Arc;

use crate::mechanism::{
    At, Coordinate, Description, Energy, Event, Quantity, Scene, Singular, SingularMass, Structure, Switch, System,
};

type Accelerations = Arc<dyn Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync>;
type Numbers = Arc<dyn Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync>;
type Energies = Arc<dyn Fn(f64, &[f64], &[f64]) -> Energy + Send + Sync>;
type Masses = Arc<dyn Fn(f64, &[f64]) -> Vec<f64> + Send + Sync>;
type Jacobians = Arc<dyn Fn(&[f64], &[f64], &[f64], &mut [f64], &mut [f64]) + Send + Sync>;

/// A mechanism made of closures, with a diagonal mass matrix.
#[derive(Clone)]
pub struct Toy {
    pub description: Description,
    pub scene: Scene,
    pub modes: Vec<f64>,
    /// (t, q, v, modes, a)
    pub acceleration: Accelerations,
    pub energy: Energies,
    /// The diagonal of M.
    pub mass: Masses,
    /// (q, v, a, ∂F/∂q, ∂F/∂v), dense, row by row.
    pub jacobian: Jacobians,
    /// (t, q, v, a, values)
    pub events: Numbers,
    /// (t, q, v, a, values)
    pub switches: Numbers,
    /// (t, q, v, a, values)
    pub outputs: Numbers,
    /// (t, q, v, a, values)
    pub invariants: Numbers,
    /// (t, q, v, (), values)
    pub drawing: Numbers,
}

impl Toy {
    /// A mechanism of unit masses with these coordinates and accelerations.
    pub fn new(
        coordinates: &[&'static str],
        start: (&[f64], &[f64]),
        until: f64,
        acceleration: impl Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        let n = coordinates.len();
        let dense: Vec<(u32, u32)> = (0..n as u32).flat_map(|i| (0..n as u32).map(move |j| (i, j))).collect();
        let coordinates = coordinates.iter().map(|&name| Coordinate { name: name.into(), unit: "".into() }).collect();
        let description = Description {
            coordinates,
            mass_pattern: (0..n as u32).map(|i| (i, i)).collect(),
            stiffness_pattern: dense.clone().into(),
            damping_pattern: dense.into(),
            scenes: vec!["scene".into()].into(),
            structure: Structure {
                dimension: 2,
                constant_mass: true,
                diagonal_mass: true,
                conservative: true,
                ..Structure::default()
            },
            ..Description::default()
        };
        let scene =
            Scene { q: start.0.to_vec(), v: start.1.to_vec(), until, tolerance: 1e-9, every: None, ..Scene::default() };
        Toy {
            description,
            scene,
            modes: Vec::new(),
            acceleration: Arc::new(acceleration),
            energy: Arc::new(|_, _, _| Energy::default()),
            mass: Arc::new(move |_, _| vec![1.0; n]),
            jacobian: Arc::new(|_, _, _, _, _| ()),
            events: Arc::new(|_, _, _, _, _| ()),
            switches: Arc::new(|_, _, _, _, _| ()),
            outputs: Arc::new(|_, _, _, _, _| ()),
            invariants: Arc::new(|_, _, _, _, _| ()),
            drawing: Arc::new(|_, _, _, _, _| ()),
        }
    }

    /// With an energy T + V (and the power of what has no potential).
    pub fn energy(mut self, energy: impl Fn(f64, &[f64], &[f64]) -> [f64; 3] + Send + Sync + 'static) -> Self {
        self.energy = Arc::new(move |t, q, v| {
            let [kinetic, potential, power] = energy(t, q, v);
            let scale = kinetic.abs() + potential.abs();
            Energy { kinetic, potential, jacobi: kinetic + potential, power, scale }
        });
        self
    }

    /// With a diagonal mass matrix.
    pub fn mass(mut self, mass: impl Fn(f64, &[f64]) -> Vec<f64> + Send + Sync + 'static) -> Self {
        self.mass = Arc::new(mass);
        self.description.structure.constant_mass = false;
        self
    }

    /// With an event; all events' pairs (value, condition) come from the last function given.
    pub fn event(
        mut self,
        event: Event,
        values: impl Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        self.description.events.to_mut().push(event);
        self.events = Arc::new(values);
        self
    }

    /// With a switch; all switches' pairs (argument, rate) come from the last function given.
    pub fn switch(
        mut self,
        switch: Switch,
        values: impl Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        self.description.switches.to_mut().push(switch);
        self.modes.push(1.0);
        self.switches = Arc::new(values);
        self
    }

    /// With scalar outputs.
    pub fn outputs(
        mut self,
        names: &[&'static str],
        values: impl Fn(f64, &[f64], &[f64], &[f64], &mut [f64]) + Send + Sync + 'static,
    ) -> Self {
        self.description.outputs =
            names.iter().map(|&name| Quantity { name: name.into(), components: 1, ..Quantity::default() }).collect();
        self.outputs = Arc::new(values);
        self
    }

    /// x'' = −ω² x, x(0) = 1.
    pub fn oscillator(omega: f64, until: f64) -> Self {
        let k = omega * omega;
        let mut toy = Toy::new(&["x"], (&[1.0], &[0.0]), until, move |_, q, _, _, a| a[0] = -k * q[0])
            .energy(move |_, q, v| [0.5 * v[0] * v[0], 0.5 * k * q[0] * q[0], 0.0]);
        toy.jacobian = Arc::new(move |_, _, _, dq, dv| {
            dq[0] = k;
            dv[0] = 0.0;
        });
        toy.separable()
    }

    /// Known to be separable.
    pub fn separable(mut self) -> Self {
        self.description.structure.separable = true;
        self
    }

    /// θ'' = −g sin θ, from rest at `angle`.
    pub fn pendulum(g: f64, angle: f64, until: f64) -> Self {
        let mut toy = Toy::new(&["theta"], (&[angle], &[0.0]), until, move |_, q, _, _, a| a[0] = -g * q[0].sin())
            .energy(move |_, q, v| [0.5 * v[0] * v[0], -g * q[0].cos(), 0.0]);
        toy.jacobian = Arc::new(move |q, _, _, dq, dv| {
            dq[0] = g * q[0].cos();
            dv[0] = 0.0;
        });
        toy.separable()
    }
}

impl System for Toy {
    fn description(&self) -> &Description {
        &self.description
    }
    fn accelerations(&self, at: At<'_>, a: &mut [f64]) -> Result<(), Singular> {
        (self.acceleration)(at.t, at.q, at.v, &self.modes, a);
        let masses = if self.description.structure.constant_mass { Vec::new() } else { (self.mass)(at.t, at.q) };
        match masses.iter().position(|mass| *mass == 0.0) {
            Some(coordinate) => Err(SingularMass { coordinate }.into()),
            None => Ok(()),
        }
    }
    fn mass_matrix(&self, at: At<'_>, values: &mut [f64]) {
        values.copy_from_slice(&(self.mass)(at.t, at.q));
    }
    fn bias(&self, at: At<'_>, h: &mut [f64]) {
        (self.acceleration)(at.t, at.q, at.v, &self.modes, h);
        for (h, m) in h.iter_mut().zip((self.mass)(at.t, at.q)) {
            *h *= -m;
        }
    }
    fn residual(&self, at: At<'_>, f: &mut [f64]) {
        self.bias(at, f);
        for ((f, m), a) in f.iter_mut().zip((self.mass)(at.t, at.q)).zip(at.a) {
            *f += m * a;
        }
    }
    fn jacobians(&self, at: At<'_>, dq: &mut [f64], dv: &mut [f64]) {
        (self.jacobian)(at.q, at.v, at.a, dq, dv);
    }
    fn energy(&self, at: At<'_>) -> Energy {
        (self.energy)(at.t, at.q, at.v)
    }
    fn invariants(&self, at: At<'_>, pairs: &mut [f64]) {
        (self.invariants)(at.t, at.q, at.v, &[], pairs);
    }
    fn outputs(&self, at: At<'_>, values: &mut [f64]) {
        (self.outputs)(at.t, at.q, at.v, at.a, values);
    }
    fn events(&self, at: At<'_>, pairs: &mut [f64]) {
        (self.events)(at.t, at.q, at.v, at.a, pairs);
    }
    fn switches(&self, at: At<'_>, pairs: &mut [f64]) {
        (self.switches)(at.t, at.q, at.v, at.a, pairs);
    }
    fn modes(&self) -> &[f64] {
        &self.modes
    }
    fn set_modes(&mut self, modes: &[f64]) {
        self.modes.copy_from_slice(modes);
    }
    fn drawing(&self, at: At<'_>, values: &mut [f64]) {
        (self.drawing)(at.t, at.q, at.v, &[], values);
    }
    fn scene(&self, _: usize) -> Scene {
        self.scene.clone()
    }
    fn boxed_clone(&self) -> Box<dyn System> {
        Box::new(self.clone())
    }
}
