//! M, C and K a second way (TAM 4735, lecture 25): the Lagrangian truncated to quadratic order, against what
//! `linearise` takes from the derivatives of the equations of motion.
//!
//! Along a direction (x, y), q = q₀ + εx and q' = v₀ + εy, every node of T and V is computed as a polynomial in ε up
//! to ε².  The coefficient of ε² in T − V is ½ yᵀM y + yᵀB x − ½ xᵀK x; its values for pairs of unit vectors give
//! M, K and B, and C = B − Bᵀ.
#![cfg(feature = "cli")]

use std::ops::{Add, Mul, Neg, Sub};

use dalembert::linear::{Guess, Linearised, equilibrium_near, linearise};
use dalembert::mechanism::Interpreted;
use dalembert::mechanism::System;
use dalembert_symbolic::expr::{Binary, Graph, Id, Node, Symbol, Unary};
use dalembert_symbolic::model::{Model, load};
use nalgebra::DMatrix;

/// a + b ε + c ε².
#[derive(Clone, Copy)]
struct Jet([f64; 3]);

impl Add for Jet {
    type Output = Jet;
    fn add(self, o: Jet) -> Jet {
        Jet([self.0[0] + o.0[0], self.0[1] + o.0[1], self.0[2] + o.0[2]])
    }
}

impl Neg for Jet {
    type Output = Jet;
    fn neg(self) -> Jet {
        Jet(self.0.map(|x| -x))
    }
}

impl Sub for Jet {
    type Output = Jet;
    fn sub(self, o: Jet) -> Jet {
        self + -o
    }
}

impl Mul for Jet {
    type Output = Jet;
    fn mul(self, o: Jet) -> Jet {
        let (a, b) = (self.0, o.0);
        Jet([a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[1] * b[1] + a[2] * b[0]])
    }
}

impl Jet {
    /// f of it, by f, f' and f'' at its constant.
    fn through(self, [f, slope, bend]: [f64; 3]) -> Jet {
        let [_, b, c] = self.0;
        Jet([f, slope * b, slope * c + 0.5 * bend * b * b])
    }

    fn unary(self, function: Unary) -> Jet {
        let a = self.0[0];
        match function {
            Unary::Neg => -self,
            Unary::Sqrt => self.through([a.sqrt(), 0.5 / a.sqrt(), -0.25 / (a * a.sqrt())]),
            Unary::Sin => self.through([a.sin(), a.cos(), -a.sin()]),
            Unary::Cos => self.through([a.cos(), -a.sin(), -a.cos()]),
            other => panic!("{} is in no energy here", other.name()),
        }
    }

    fn binary(self, function: Binary, o: Jet) -> Jet {
        let (a, p) = (o.0[0], self.0[0]);
        match function {
            Binary::Add => self + o,
            Binary::Sub => self - o,
            Binary::Mul => self * o,
            Binary::Div => self * o.through([1.0 / a, -1.0 / (a * a), 2.0 / (a * a * a)]),
            Binary::Pow if o.0[1] == 0.0 && o.0[2] == 0.0 => {
                self.through([p.powf(a), a * p.powf(a - 1.0), a * (a - 1.0) * p.powf(a - 2.0)])
            }
            _ => panic!("an operation that is in no energy here"),
        }
    }
}

/// T − V of a model as polynomials in ε.
struct Energies<'a> {
    model: &'a Model,
    parameters: Vec<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
}

impl Energies<'_> {
    /// The coefficient of ε² in T − V along a direction.
    fn second_order(&self, x: &[f64], y: &[f64]) -> f64 {
        let graph: &Graph = &self.model.graph;
        let roots = || self.model.kinetic_terms.iter().chain(&self.model.potential_terms).copied();
        let needed = graph.reachable(roots());
        let mut jets = vec![Jet([f64::NAN; 3]); needed.len()];
        let leaf = |symbol: Symbol| match symbol {
            Symbol::Coordinate(i) => Jet([self.q[i as usize], x[i as usize], 0.0]),
            Symbol::Speed(i) => Jet([self.v[i as usize], y[i as usize], 0.0]),
            Symbol::Parameter(i) => Jet([self.parameters[i as usize], 0.0, 0.0]),
            Symbol::Time | Symbol::Input(..) => Jet([0.0; 3]),
            other => panic!("{other:?} is in no energy"),
        };
        for i in (0..needed.len()).filter(|i| needed[*i]) {
            jets[i] = match graph.node(graph.id_at(i)) {
                Node::Number(n) => Jet([graph.number_at(n).to_f64(), 0.0, 0.0]),
                Node::Symbol(symbol) => leaf(symbol),
                Node::Unary(f, a) => jets[a.index()].unary(f),
                Node::Binary(f, a, b) => jets[a.index()].binary(f, jets[b.index()]),
            };
        }
        let sum = |terms: &[Id]| terms.iter().map(|id| jets[id.index()].0[2]).sum::<f64>();
        sum(&self.model.kinetic_terms) - sum(&self.model.potential_terms)
    }

    /// The matrix of a quadratic form from its values: (f(a + b) − f(a) − f(b)) for unit vectors a, b.
    fn matrix(&self, first: Part, second: Part) -> DMatrix<f64> {
        let n = self.q.len();
        DMatrix::from_fn(n, n, |i, j| {
            let value = |one: f64, other: f64| {
                let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
                for (part, index, amount) in [(first, i, one), (second, j, other)] {
                    match part {
                        Part::Place => x[index] += amount,
                        Part::Speed => y[index] += amount,
                    }
                }
                self.second_order(&x, &y)
            };
            value(1.0, 1.0) - value(1.0, 0.0) - value(0.0, 1.0)
        })
    }
}

#[derive(Clone, Copy)]
enum Part {
    Place,
    Speed,
}

fn close(name: &str, what: &str, found: &DMatrix<f64>, expected: &DMatrix<f64>, scale: f64) {
    let error = (found - expected).amax();
    assert!(error <= 1e-13 * scale.max(1.0), "{name}: {what} is off by {error:e}\n{found}{expected}");
}

/// Both routes about the equilibrium or steady motion near a guess.
fn compare(name: &str, source: &str, guess: &[(&str, f64)]) -> Linearised {
    let program = dalembert_symbolic::lower::compile(source, &[]).unwrap();
    let system = Interpreted::new(program, source);
    let mut start = Guess::at(&system.equilibrium_guess().unwrap_or_else(|| vec![0.0; system.len()]));
    for (coordinate, value) in guess {
        let (list, coordinate) = match coordinate.strip_suffix('\'') {
            Some(coordinate) => (&mut start.v, coordinate),
            None => (&mut start.q, *coordinate),
        };
        let index = system.description().coordinates.iter().position(|c| c.name == coordinate).unwrap();
        list[index] = *value;
    }
    let linear = linearise(&system, &equilibrium_near(&system, &start).unwrap()).unwrap();
    let model = load(source, &[]).unwrap();
    let at = &linear.equilibrium;
    let energies = Energies { model: &model, parameters: system.parameters(), q: at.q.clone(), v: at.v.clone() };
    let mixed = energies.matrix(Part::Speed, Part::Place);
    let scale = linear.k().amax().max(linear.m().amax());
    close(name, "M", &linear.m(), &energies.matrix(Part::Speed, Part::Speed), scale);
    close(name, "K", &linear.k(), &-energies.matrix(Part::Place, Part::Place), scale);
    close(name, "C", &linear.c(), &(&mixed - mixed.transpose()), scale);
    linear
}

fn library(name: &str) -> String {
    std::fs::read_to_string(format!("{}/../models/{name}.yaml", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn nonlinear_mechanisms_of_the_library() {
    let cases: [(&str, &[(&str, f64)]); 14] = [
        ("double_pendulum", &[]),
        ("double_pendulum", &[("theta1", 3.1), ("theta2", 0.1)]),
        ("double_pendulum_points", &[("theta1", 0.1), ("theta2", 3.0)]),
        ("triple_pendulum", &[("theta1", 3.2), ("theta3", 3.0)]),
        ("cart_pendulum", &[("x", 0.7)]),
        ("cart_pendulum", &[("theta", 3.0)]),
        ("bead_parabola", &[("x", 0.4)]),
        ("cylinder_in_pipe", &[("theta", 0.3)]),
        ("rolling_cylinder", &[]),
        ("slot_turntable_springs", &[("s", 0.2)]),
        ("pendulum_awkward", &[("y", 0.3)]),
        ("hexagon_springs", &[("x[2]", 0.1), ("y[5]", -0.1)]),
        ("two_masses_3d", &[("x[1]", 0.3), ("y[1]", 0.5), ("z[2]", 0.4)]),
        ("angular_momentum", &[("y", -1.0)]),
    ];
    for (name, guess) in cases {
        compare(name, &library(name), guess);
    }
}

/// A mass on a spring in a slot that turns: steady turning has gyroscopic terms, a softened K, and ω² = k/m + 3Ω².
const TURNING_SLOT: &str = "
name: TurningSlot
parameters: {m: 2 kg, k: 8 N/m, l: 1 m, I: 0.5 kg*m^2}
coordinates: {r: m, phi: rad}
points: {axis: [0, 0]}
bodies:
  table: {mass: 0, inertia: I, angle: phi, position: axis}
  slider: {mass: m, position: 'r*table.x'}
springs: {spring: {between: [{on: table, at: axis}, slider], stiffness: k, rest: l}}
";

/// A bead on a hoop that turns at a constant rate W: T has a part without velocities, and above √(g/R) the bottom is
/// unstable.
const HOOP: &str = "
name: Hoop
parameters: {m: 1 kg, g: 10 m/s^2, R: 0.5 m, W: 6 rad/s}
coordinates: {theta: rad}
kinetic_energy: m*R^2*(theta'^2 + W^2*sin(theta)^2)/2
potential_energy: -m*g*R*cos(theta)
";

/// A particle on springs in a frame that turns: T has a part linear in the velocities.
const FRAME: &str = "
name: TurningFrame
parameters: {m: 2 kg, k: 9 N/m, W: 0.7 rad/s, g: 3 m/s^2, e: 1 N/m^3}
coordinates: {x: m, y: m}
kinetic_energy: m*((x' - W*y)^2 + (y' + W*x)^2)/2
potential_energy: k*(x^2 + 2*y^2)/2 + m*g*x + e*x^4/3
";

#[test]
fn rotating_mechanisms_with_gyroscopic_terms() {
    let spin = 1.2;
    let turning = compare("TurningSlot", TURNING_SLOT, &[("r", 1.3), ("phi", 0.4), ("phi'", spin)]);
    let r = turning.equilibrium.q[0];
    assert!((r - 4.0 / (4.0 - spin * spin)).abs() < 1e-13);
    assert!((turning.gyroscopic().to_dense()[(1, 0)] - 2.0 * 2.0 * r * spin).abs() < 1e-12);
    assert!((turning.k()[(0, 0)] - (8.0 - 2.0 * spin * spin)).abs() < 1e-12);
    let bottom = compare("Hoop", HOOP, &[]);
    assert!(bottom.k()[(0, 0)] < 0.0);
    let aside = compare("Hoop", HOOP, &[("theta", 0.8)]);
    assert!((aside.equilibrium.q[0] - (20.0_f64 / 36.0).acos()).abs() < 1e-13 && aside.k()[(0, 0)] > 0.0);
    let frame = compare("TurningFrame", FRAME, &[]);
    assert!((frame.c()[(0, 1)] + 2.0 * 2.0 * 0.7).abs() < 1e-14 && frame.c()[(0, 1)] == -frame.c()[(1, 0)]);
}
