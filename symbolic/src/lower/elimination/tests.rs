use crate::expr::{Id, Symbol, Tape};
use crate::lower::{Accelerations, Program, compile};
use crate::number::DoubleDouble;
use crate::random::Random;

#[path = "../../../tests/elimination/models.rs"]
mod models;

/// A mechanism with values for its parameters.
struct Case {
    program: Program,
    parameters: Vec<f64>,
}

impl Case {
    /// Of so many links, if any, with the file's parameters.
    fn of(text: &str, n: i64) -> Case {
        let sizes = if n > 0 { vec![("n".to_owned(), n)] } else { Vec::new() };
        let program = compile(text, &sizes).unwrap_or_else(|problems| panic!("{problems:?}"));
        let parameters = program.model.parameters.iter().map(|parameter| parameter.default).collect();
        Case { program, parameters }
    }

    /// With other values for some parameters.
    fn with(mut self, value: impl Fn(&str) -> Option<f64>) -> Case {
        for (parameter, known) in self.program.model.parameters.iter().zip(&mut self.parameters) {
            *known = value(&parameter.name).unwrap_or(*known);
        }
        self
    }

    fn eliminated(&self) -> bool {
        self.program.elimination.as_ref().is_some_and(|found| found.order.is_some())
    }

    /// Coordinates up to `reach` and speeds up to 1.
    fn drawn(&self, random: &mut Random, reach: f64) -> Vec<f64> {
        let n = self.program.bias.len();
        (0..2 * n).map(|k| if k < n { random.between(-reach, reach) } else { random.between(-1.0, 1.0) }).collect()
    }

    fn value(&self, state: &[f64], symbol: Symbol) -> f64 {
        match symbol {
            Symbol::Coordinate(i) => state[i as usize],
            Symbol::Speed(i) => state[self.program.bias.len() + i as usize],
            Symbol::Parameter(k) => self.parameters[k as usize],
            _ => 1.0,
        }
    }

    /// The accelerations as the program has them.
    fn written_out(&self) -> Tape {
        let Accelerations::Unrolled { values, .. } = &self.program.accelerations else { panic!("a loop") };
        Tape::new(&self.program.model.graph, values)
    }

    /// −M⁻¹h in double-double, by Gaussian elimination.
    fn by_masses(&self, state: &[f64]) -> Vec<DoubleDouble> {
        let n = self.program.bias.len();
        let roots = [self.program.mass.iter().map(|e| e.2).collect(), self.program.bias.clone()].concat();
        let found: Vec<DoubleDouble> =
            Tape::new(&self.program.model.graph, &roots).evaluate(|s| self.value(state, s).into());
        let (entries, bias) = found.split_at(self.program.mass.len());
        let mut m = vec![vec![DoubleDouble::ZERO; n]; n];
        for ((i, j, _), x) in self.program.mass.iter().zip(entries) {
            (m[*i][*j], m[*j][*i]) = (*x, *x);
        }
        let mut f: Vec<DoubleDouble> = bias.iter().map(|h| -*h).collect();
        for k in 0..n {
            for i in k + 1..n {
                let factor = m[i][k] / m[k][k];
                let row = m[k].clone();
                m[i].iter_mut().zip(row).for_each(|(x, y)| *x = *x - factor * y);
                f[i] = f[i] - factor * f[k];
            }
        }
        for k in (0..n).rev() {
            let known = (k + 1..n).fold(f[k], |sum, j| sum - m[k][j] * f[j]);
            f[k] = known / m[k][k];
        }
        f
    }
}

/// |a − b|/|b| of largest components.
fn apart(a: &[DoubleDouble], b: &[DoubleDouble]) -> f64 {
    let size = |list: &mut dyn Iterator<Item = f64>| list.fold(0.0, f64::max);
    let difference = size(&mut a.iter().zip(b).map(|(a, b)| (*a - *b).abs().to_f64()));
    difference / size(&mut b.iter().map(|b| b.abs().to_f64()))
}

impl Case {
    /// Median and largest relative error of accelerations in `f64` at so many states.
    fn errors(&self, states: usize, reach: f64) -> (f64, f64) {
        let tape = self.written_out();
        let mut random = Random::new();
        let mut errors: Vec<f64> = (0..states)
            .map(|_| {
                let state = self.drawn(&mut random, reach);
                let exact = tape.evaluate(|s| DoubleDouble::from(self.value(&state, s)));
                let short = tape.evaluate(|s| self.value(&state, s));
                apart(&short.into_iter().map(DoubleDouble::from).collect::<Vec<_>>(), &exact)
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        (errors[states / 2], errors[states - 1])
    }

    /// Elimination, which must be chosen, gives what M and h give.
    fn agrees(&self) {
        let Program { model, elimination, .. } = &self.program;
        assert!(self.eliminated(), "{}: {elimination:?}", model.name);
        let tape = self.written_out();
        let mut random = Random::new();
        for _ in 0..3 {
            let state = self.drawn(&mut random, 3.0);
            let found = tape.evaluate(|s| DoubleDouble::from(self.value(&state, s)));
            let error = apart(&found, &self.by_masses(&state));
            assert!(error < 1e-20, "{}: {error:e}", model.name);
        }
    }

    /// The coordinates whose pivots vanish, as generated code tests them.
    fn without_pivots(&self, state: &[f64]) -> Vec<usize> {
        let Accelerations::Unrolled { pivots, .. } = &self.program.accelerations else { panic!("a loop") };
        let roots: Vec<Id> = pivots.iter().flat_map(|(_, pivot, size)| [*pivot, *size]).collect();
        let values = Tape::new(&self.program.model.graph, &roots).evaluate(|s| self.value(state, s));
        let vanishes = |pair: &[f64]| pair[0].is_nan() || pair[0].abs() <= 4.0 * f64::EPSILON * pair[1].abs();
        pivots.iter().zip(values.chunks_exact(2)).filter(|(_, pair)| vanishes(pair)).map(|(p, _)| p.0).collect()
    }
}

#[test]
fn accelerations_are_those_of_masses_and_forces() {
    for text in [models::ABSOLUTE, models::RELATIVE, models::CART, models::TURNTABLE, models::ENERGIES] {
        Case::of(text, 20).agrees();
    }
    Case::of(models::TREE, 31).agrees();
    Case::of(models::SPHERICAL, 8).agrees();
    Case::of(models::SPACE, 5).agrees();
}

/// Angular velocities as unknowns give what M and h of the quaternions' rates give.
#[test]
fn accelerations_of_rotations_are_those_of_masses_and_forces() {
    for (text, n) in [(models::BALL_JOINTS, 1), (models::BALL_JOINTS, 3), (models::BALL_JOINTS_ON_A_CARRIAGE, 2)] {
        let case = Case::of(text, n);
        assert_eq!(case.program.elimination.as_ref().map(|found| found.rotations), Some(n as usize));
        case.agrees();
    }
}

#[test]
fn accelerations_of_long_chains_have_their_digits() {
    for text in [models::ABSOLUTE, models::RELATIVE] {
        let (median, largest) = Case::of(text, 40).errors(100, 3.0);
        assert!(median < 1e-14 && largest < 5e-14, "{median:e} {largest:e}");
    }
}

/// Masses 1, 10⁻⁶, 1, …; a heavy end; a chain that hangs nearly straight.
#[test]
fn hard_chains_have_their_digits() {
    let index = |name: &str| name.trim_end_matches(']').split_once('[').and_then(|(_, k)| k.parse::<i32>().ok());
    let light = |name: &str| (name.starts_with('m') && index(name)? % 2 == 0).then_some(1e-6);
    let (median, largest) = Case::of(models::UNLIKE, 20).with(light).errors(100, 3.0);
    assert!(median < 1e-14 && largest < 1e-12, "{median:e} {largest:e}");
    let heavy_end = |name: &str| (name == "m[20]").then_some(1e6);
    let (median, _) = Case::of(models::UNLIKE, 20).with(heavy_end).errors(100, 3.0);
    assert!(median < 1e-8, "{median:e}");
    let (median, _) = Case::of(models::ABSOLUTE, 20).errors(100, 1e-3);
    assert!(median < 1e-12, "{median:e}");
}

/// Nothing that moves vanishes: a massless link between others has an inertia by what hangs on it, the last one has none.
#[test]
fn a_massless_link_is_an_error_only_at_the_end() {
    let without = |which: &'static str| move |name: &str| (name == which).then_some(0.0);
    let state = vec![0.3; 40];
    let middle = Case::of(models::UNLIKE, 20).with(without("m[9]"));
    assert!(middle.without_pivots(&state).is_empty());
    let (median, _) = middle.errors(20, 3.0);
    assert!(median < 1e-13, "{median:e}");
    let last = Case::of(models::UNLIKE, 20).with(without("m[20]"));
    assert_eq!(last.without_pivots(&state).first(), Some(&19));
}

/// With one ball at the end of two rods that lie in one line the inertia across it is made of roundings alone.
#[test]
fn a_pivot_of_roundings_is_none() {
    let case = Case::of(models::BALLS, 20).with(|name| (name == "m[19]").then_some(0.0));
    let mut random = Random::new();
    for _ in 0..20 {
        let mut state = case.drawn(&mut random, 3.0);
        assert!(case.without_pivots(&state).is_empty());
        state[19] = state[18];
        let found = case.without_pivots(&state);
        assert!(found.contains(&18) || found.contains(&19), "{found:?}");
    }
}

/// Three links: what is kept is the velocity of the joint between the second and the third.
#[test]
fn small_mechanisms_keep_what_they_had() {
    for (text, n) in [(models::ABSOLUTE, 2), (models::ABSOLUTE, 3), (models::ABSOLUTE, 5), (models::CART, 2)] {
        assert!(!Case::of(text, n).eliminated(), "{n}");
    }
}

impl Case {
    /// Accelerations and multipliers by elimination solve M q'' + h = Jᵀ λ and J q'' + γ = 0.
    fn solves(&self) {
        let Program { model, mass, bias, constraints, .. } = &self.program;
        let found = constraints.eliminated.as_ref().unwrap_or_else(|| panic!("{}: not eliminated", model.name));
        let mut random = Random::new();
        for _ in 0..3 {
            let state = self.drawn(&mut random, 3.0);
            let value = |s| DoubleDouble::from(self.value(&state, s));
            let evaluate = |roots: Vec<Id>| Tape::new(&model.graph, &roots).evaluate(value);
            let (a, l) = (evaluate(found.accelerations.clone()), evaluate(found.multipliers.clone()));
            let mut left = evaluate(bias.clone());
            for ((i, j, _), m) in mass.iter().zip(evaluate(mass.iter().map(|e| e.2).collect())) {
                left[*i] += m * a[*j];
                if i != j {
                    left[*j] += m * a[*i];
                }
            }
            let mut rows = evaluate(constraints.bias.clone());
            for ((row, i, _), x) in
                constraints.matrix.iter().zip(evaluate(constraints.matrix.iter().map(|e| e.2).collect()))
            {
                left[*i] += -(x * l[*row]);
                rows[*row] += x * a[*i];
            }
            let most = a.iter().chain(&l).fold(1.0_f64, |most, x| most.max(x.abs().to_f64()));
            let wrong = left.iter().chain(&rows).fold(0.0_f64, |most, x| most.max(x.abs().to_f64()));
            assert!(wrong < 1e-20 * most, "{}: {wrong:e} beside {most:e}", model.name);
            let mobilities = evaluate(found.mobilities.clone());
            assert!(mobilities.iter().all(|mobility| mobility.to_f64() > 0.0), "{}", model.name);
            // What rows before take is taken from what each has alone.
            let alone = evaluate(found.alone.clone());
            assert!(alone.iter().zip(&mobilities).all(|(all, left)| all.to_f64() >= left.to_f64()), "{}", model.name);
        }
    }
}

/// Hinges, loops, a rod in space, wheels that roll, and rows that move with time.
#[test]
fn accelerations_and_multipliers_solve_the_equations_with_constraints() {
    Case::of(models::HINGES, 6).solves();
    Case::of(models::FOUR_BARS, 4).solves();
    let moving = models::HINGES
        .replace("u[i] - ax[i-1]", "u[i] - ax[i-1] - 0.1*sin(3*t/T)")
        .replace("m: 1 kg", "m: 1 kg, T: 1 s");
    Case::of(&moving.replace("0.1*sin", "0.1*l*sin"), 3).solves();
    let sleigh = "name: Sleigh\nparameters: {m: 1 kg, I: 0.3 kg*m^2, d: 0.2 m}\ncoordinates: {x: m, y: m, phi: rad}\n\
                  bodies: {b: {mass: m, inertia: I, angle: phi, position: '[x + d*cos(phi), y + d*sin(phi)]'}}\n\
                  constraints: {skate: \"-x'*sin(phi) + y'*cos(phi)\"}\n";
    Case::of(sleigh, 0).solves();
    let rod = "name: Rod\nparameters: {m: 1 kg, l: 1 m, g: 10 m/s^2}\ncoordinates: {\"x[i in 1..6]\": m}\n\
               bodies: {a: {mass: m, position: '[x[1], x[2], x[3]]'}, b: {mass: 2*m, position: '[x[4], x[5], x[6]]'}}\n\
               gravity: [0, 0, -g]\n\
               constraints: {rod: \"(x[1] - x[4])^2 + (x[2] - x[5])^2 + (x[3] - x[6])^2 - l^2\"}\n\
               scene: {start: {\"x[1]\": 0, \"x[2]\": 0, \"x[3]\": 0, \"x[4]\": 1, \"x[5]\": 0, \"x[6]\": 0}}\n";
    Case::of(rod, 0).solves();
}

/// Where rows depend on each other, rows determine accelerations alone, or forces are made of multipliers, M and J are solved with pivots.
#[test]
fn rows_that_are_to_be_chosen_are_not_eliminated() {
    let block = |rows: &str, forces: &str| {
        let text = format!(
            "name: Block\nparameters: {{m: 1 kg, mu: 0.1, l: 1 m, g: 10 m/s^2}}\ncoordinates: {{x: m, y: m, z: m}}\n\
             bodies: {{b: {{mass: m, position: '[x, y, z]'}}}}\ngravity: [0, 0, -g]\n\
             constraints: {{{rows}}}\n{forces}scene: {{start: {{x: 1, y: 0, z: 0}}}}\n"
        );
        Case::of(&text, 0).program.constraints.eliminated.is_some()
    };
    assert!(block("sphere: x^2 + y^2 + z^2 - l^2", ""));
    assert!(!block("floor: z", ""));
    assert!(!block("sphere: x^2 + y^2 + z^2 - l^2, again: 2*(x^2 + y^2 + z^2 - l^2)", ""));
    assert!(!block("slope: z - x", "forces: {rub: {on: b, force: '[-mu*reaction(slope), 0, 0]'}}\n"));
}
