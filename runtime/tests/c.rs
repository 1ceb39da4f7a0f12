//! `show --c`: the C of every model of the library, and of files with hostile names, compiles without a warning and gives what the
//! program computes.  Runs where there is a C compiler.
#![cfg(feature = "interpret")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use dalembert::mechanism::{Along, At, Function, Interpreted, SwitchKind, System};
use dalembert_symbolic::{lower::compile_in, print};

/// States at which the functions are compared, in each phase.
const STATES: usize = 4;
/// By how much numbers may differ, in parts of the largest beside them.
const TOLERANCE: f64 = 1e-13;
/// Slopes of accelerations are compared with differences over this part of a direction.
const STEP: f64 = 1e-5;
/// By how much they may differ from those, in parts of the largest slope or acceleration.
const TOLERANCE_OF_DIFFERENCES: f64 = 1e-6;
/// States at which accelerations jump, and how many they may be.
static JUMPS: AtomicUsize = AtomicUsize::new(0);
const MOST_JUMPS: usize = 40;

/// Prints all functions at each state that it reads, a line a function; with an empty line after each state.
const DRIVER: &str = r"
#include <stdio.h>
#define ROOM 40000
#define CHANGE(k) (0.3 + 0.1 * ((k) % 7))
static double c[ROOM], q[ROOM], v[ROOM], u[ROOM], a[ROOM], l[ROOM], out[ROOM], zero[ROOM], along[ROOM], dl[ROOM];
static void line(int size) {
    for (int k = 0; k < size; k++) printf(k ? ' %.17g' : '%.17g', out[k]);
    printf('\n');
}
static void list(const double *from, int size) {
    for (int k = 0; k < size; k++) out[k] = from[k];
    line(size);
}
int main(void) {
    NAME_parameters p;
    double t;
    int phase, state = 0;
    enum { INPUTS = 1 + 3 * N_COORDINATES + N_ROWS, PARAMETERS = INPUTS + 3 * N_INPUTS, MEMORY = PARAMETERS + N_PARAMETERS };
    NAME_defaults(&p);
    NAME_constants(&p, c);
    for (int scene = 0; scene < N_SCENES; scene++) {
        double settings[3];
        NAME_scene(scene, c, settings, q, v);
        list(settings, 3);
        list(q, N_COORDINATES);
        list(v, N_COORDINATES);
        list(NAME_memory(c), N_MEMORY);
    }
    while (scanf('%lf %d', &t, &phase) == 2) {
        int good = 1;
        for (int k = 0; k < N_COORDINATES; k++) good = good && scanf('%lf', q + k) == 1;
        for (int k = 0; k < N_COORDINATES; k++) good = good && scanf('%lf', v + k) == 1;
        for (int k = 0; k < N_MEMORY; k++) good = good && scanf('%lf', NAME_memory(c) + k) == 1;
        if (!good) return 1;
        NAME_set_phase(c, phase);
        if (N_PHASES && NAME_phase(c) != phase) return 2;
        NAME_inputs(c, t, u);
        NAME_settle(c, t, u, q, v, zero, zero);
        NAME_inputs(c, t, u);
        const int failed = NAME_accelerations(c, t, u, q, v, a, l);
        if (failed) for (int k = 0; k < N_COORDINATES + N_ROWS; k++) *(k < N_COORDINATES ? a + k : l + k - N_COORDINATES) = 0.0;
        out[0] = failed != 0;
        line(1);
        list(a, N_COORDINATES);
        list(l, N_ROWS);
        for (int k = 0; k < N_DIRECTION; k++) along[k] = k <= 2 * N_COORDINATES ? CHANGE(k) : 0.0;
        if (N_PARAMETERS) along[PARAMETERS + state % (N_PARAMETERS + !N_PARAMETERS)] = 1.0;
        if (N_MEMORY) along[MEMORY + state % (N_MEMORY + !N_MEMORY)] = 1.0;
        state++;
        NAME_input_slopes(c, t, along, along + INPUTS);
        if (failed || NAME_acceleration_slopes(c, t, u, q, v, a, l, along, out, dl)) for (int k = 0; k < N_COORDINATES; k++) out[k] = 0.0;
        line(N_COORDINATES);
        for (int k = 0; k < ROOM; k++) a[k] += 1.0, l[k] += 1.0;
        for (int k = 2 * N_COORDINATES + 1; k < INPUTS; k++) along[k] = CHANGE(k);
        NAME_equation_slopes(c, t, u, q, v, a, l, along, out);
        line(N_COORDINATES + N_ROWS);
        NAME_output_slopes(c, t, u, q, v, a, l, along, out);
        line(N_OUTPUTS);
        CALLS
    }
    return 0;
}
";

/// Whether there is a C compiler.
fn compiler() -> Option<&'static str> {
    ["cc", "gcc", "clang"].into_iter().find(|compiler| {
        let tried = Command::new(compiler).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
        tried.is_ok_and(|status| status.success())
    })
}

fn files() -> BTreeMap<String, PathBuf> {
    let folders = ["models", "runtime/tests/c", "tests/tests/names", "tests/roads", "tests/states", "tests/strangers"];
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let files =
        folders.iter().flat_map(|folder| fs::read_dir(root.join(folder)).unwrap().map(|file| file.unwrap().path()));
    files
        .filter(|path| path.extension().is_some_and(|e| e == "yaml"))
        .map(|path| (path.file_stem().unwrap().to_str().unwrap().to_owned(), path))
        .collect()
}

/// What stands for discontinuities, where the state is.
fn settle(system: &mut Interpreted, t: f64, q: &[f64], v: &[f64]) {
    let kinds: Vec<SwitchKind> = system.description().switches.iter().map(|switch| switch.kind).collect();
    for k in 0..kinds.len() {
        let mut pairs = vec![0.0; 2 * kinds.len()];
        system.switches(At::new(t, q, v), &mut pairs);
        let mut modes = system.modes().to_vec();
        modes[k] = match kinds[k] {
            SwitchKind::Sign if pairs[2 * k] == 0.0 => 0.0,
            SwitchKind::Sign => pairs[2 * k].signum(),
            SwitchKind::Step => f64::from(pairs[2 * k] >= 0.0),
        };
        system.set_modes(&modes);
    }
}

/// Numbers that are always the same.
struct Draws(u64);

impl Draws {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }
}

/// A sparse matrix as a dense one, row by row.
fn dense(pattern: &[(u32, u32)], values: &[f64], rows: usize, columns: usize, symmetric: bool) -> Vec<f64> {
    let mut out = vec![0.0; rows * columns];
    for ((i, j), value) in pattern.iter().zip(values) {
        out[*i as usize * columns + *j as usize] = *value;
        if symmetric {
            out[*j as usize * columns + *i as usize] = *value;
        }
    }
    out
}

/// A function of C: its name, how many of q, v, and a with l it takes, and what the program has for it.
type Compared = (&'static str, usize, Vec<f64>);

/// All functions of a state as the program has them.
fn functions(system: &Interpreted, at: At<'_>) -> Vec<Compared> {
    let (n, description) = (system.len(), system.description());
    let (rows, inputs) = (description.rows.len(), description.inputs.len());
    let filled = |size: usize, write: &dyn Fn(&mut [f64])| {
        let mut values = vec![0.0; size];
        write(&mut values);
        values
    };
    let (mut dq, mut dv) =
        (vec![0.0; description.stiffness_pattern.len()], vec![0.0; description.damping_pattern.len()]);
    system.jacobians(at, &mut dq, &mut dv);
    let mass = filled(description.mass_pattern.len(), &|out| system.mass_matrix(at, out));
    let input = filled(description.input_pattern.len(), &|out| system.input_jacobian(at, out));
    let time = filled(description.time_pattern.len(), &|out| system.time_jacobian(at, out));
    let times: Vec<(u32, u32)> = description.time_pattern.iter().map(|row| (*row, 0)).collect();
    let energy = system.energy(at);
    let mut all = vec![
        ("mass_matrix", 2, dense(&description.mass_pattern, &mass, n, n, true)),
        ("bias", 2, filled(n, &|out| system.bias(at, out))),
        ("residual", 3, filled(n, &|out| system.residual(at, out))),
        ("energy", 3, vec![energy.kinetic, energy.potential, energy.jacobi, energy.power, energy.scale]),
        ("outputs", 3, filled(description.output_len(), &|out| system.outputs(at, out))),
        ("invariants", 2, filled(2 * description.invariant_len(), &|out| system.invariants(at, out))),
        ("events", 3, filled(2 * description.events.len(), &|out| system.events(at, out))),
        ("event_rates", 3, filled(description.events.len(), &|out| system.event_rates(at, out))),
        (
            "assignments",
            3,
            filled(system.sampling().sets.iter().map(|set| set.len()).sum(), &|out| system.assignments(at, out)),
        ),
        ("switches", 3, filled(2 * description.switches.len(), &|out| system.switches(at, out))),
        ("stiffness", 3, dense(&description.stiffness_pattern, &dq, n, n, false)),
        ("damping", 3, dense(&description.damping_pattern, &dv, n, n, false)),
        ("input_jacobian", 3, dense(&description.input_pattern, &input, n, 3 * inputs, false)),
        ("time_jacobian", 3, dense(&times, &time, n, 1, false)),
    ];
    if rows > 0 {
        all.extend(rows_of(system, at));
    }
    all
}

/// Those of constraints.
fn rows_of(system: &Interpreted, at: At<'_>) -> Vec<Compared> {
    let (n, description) = (system.len(), system.description());
    let rows = description.rows.len();
    let values = |pattern: &[(u32, u32)], write: &dyn Fn(&mut [f64]), lines: usize, columns: usize| {
        let mut values = vec![0.0; pattern.len()];
        write(&mut values);
        dense(pattern, &values, lines, columns, false)
    };
    let of = |size: usize, write: &dyn Fn(&mut [f64])| {
        let mut values = vec![0.0; size];
        write(&mut values);
        values
    };
    let (mut cq, mut cv) = (
        vec![0.0; description.constraint_stiffness_pattern.len()],
        vec![0.0; description.constraint_damping_pattern.len()],
    );
    system.constraint_jacobians(at, &mut cq, &mut cv);
    vec![
        ("constraints", 2, of(3 * rows, &|out| system.constraints(at, out))),
        (
            "constraint_matrix",
            1,
            values(&description.constraint_pattern, &|out| system.constraint_matrix(at, out), rows, n),
        ),
        ("constraint_bias", 2, of(rows, &|out| system.constraint_bias(at, out))),
        ("friction", 2, values(&description.friction_pattern, &|out| system.friction(at, out), n, rows)),
        ("constraint_stiffness", 3, dense(&description.constraint_stiffness_pattern, &cq, rows, n, false)),
        ("constraint_damping", 3, dense(&description.constraint_damping_pattern, &cv, rows, n, false)),
        (
            "constraint_rate_jacobian",
            2,
            values(&description.constraint_rate_pattern, &|out| system.constraint_rate_jacobian(at, out), rows, n),
        ),
    ]
}

/// A direction of t, q, v, a and l, as the program in C has it, and a parameter and a held value that change in turn.
struct Direction {
    t: f64,
    state: [Vec<f64>; 4],
    parameter: Option<usize>,
    memory: Option<usize>,
}

impl Direction {
    fn of(system: &Interpreted, turn: usize) -> Direction {
        let n = system.len();
        let change = |k: usize| 0.3 + 0.1 * (k % 7) as f64;
        let list = |first: usize, count: usize| (first..first + count).map(change).collect();
        let of = |count: usize| (count > 0).then(|| turn % count);
        let rows = system.description().rows.len();
        Direction {
            t: change(0),
            state: [list(1, n), list(1 + n, n), list(1 + 2 * n, n), list(1 + 3 * n, rows)],
            parameter: of(system.parameters().len()),
            memory: of(system.memory().len()),
        }
    }

    fn along(&self) -> Along<'_> {
        let [q, v, a, lambda] = &self.state;
        Along { t: self.t, q, v, a, lambda, parameter: self.parameter, memory: self.memory }
    }

    /// Accelerations a part of the direction further on; none where they fail.
    fn accelerations(&self, system: &Interpreted, at: At<'_>, part: f64) -> Option<Vec<f64>> {
        let mut system = system.clone();
        if let Some(k) = self.parameter {
            system.set_parameter(k, system.parameters()[k] + part);
        }
        if let Some(k) = self.memory {
            let mut memory = system.memory().to_vec();
            memory[k] += part;
            system.set_memory(&memory);
        }
        let moved =
            |from: &[f64], along: &[f64]| from.iter().zip(along).map(|(x, d)| x + part * d).collect::<Vec<f64>>();
        let (q, v) = (moved(at.q, &self.state[0]), moved(at.v, &self.state[1]));
        let (mut a, mut l) = (vec![0.0; system.len()], vec![0.0; system.description().rows.len()]);
        let at = At::new(at.t + part * self.t, &q, &v);
        system.accelerations_and_multipliers(at, &mut a, &mut l).is_ok().then_some(a)
    }

    /// The sum of accelerations further on, with weights.
    fn sum(&self, system: &Interpreted, at: At<'_>, terms: &[(f64, f64)]) -> Option<Vec<f64>> {
        let mut sum = vec![0.0; system.len()];
        for (place, weight) in terms {
            let moved = self.accelerations(system, at, place * STEP)?;
            sum.iter_mut().zip(moved).for_each(|(sum, a)| *sum += weight / STEP * a);
        }
        Some(sum)
    }

    /// Slopes of accelerations, as of the polynomial through five; none where accelerations jump, as where rows that depend on each other
    /// are chosen otherwise.
    fn acceleration_slopes(&self, system: &Interpreted, at: At<'_>) -> Option<Vec<f64>> {
        let slopes =
            self.sum(system, at, &[(-2.0, 1.0 / 12.0), (-1.0, -2.0 / 3.0), (1.0, 2.0 / 3.0), (2.0, -1.0 / 12.0)])?;
        let forward = self.sum(system, at, &[(0.0, -1.0), (1.0, 1.0)])?;
        (deviation(&slopes, &forward, 1.0) < 0.1).then_some(slopes)
    }
}

/// The program in C that prints all these functions.
fn driver(code: &print::CText, all: &[Compared]) -> String {
    let calls: String = all
        .iter()
        .map(|(name, order, values)| {
            let state = ["", "q", "q, v", "q, v, a, l"][*order];
            format!("NAME_{name}(c, t, u, {state}, out);\n        line({});\n        ", values.len())
        })
        .collect();
    let text = DRIVER.replace("CALLS", &calls).replace('\'', "\"");
    let text = text.replace("N_", &format!("{}_", code.prefix.to_uppercase()));
    code.whole() + &text.replace("NAME", &code.prefix)
}

/// What one file's code prints for a text of states.
fn printed(compiler: &str, folder: &Path, name: &str, text: &str, states: &str) -> Vec<Vec<f64>> {
    use std::io::Write;
    let (source, program) = (folder.join(format!("{name}.c")), folder.join(name));
    fs::write(&source, text).unwrap();
    let compiled = Command::new(compiler)
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O0"])
        .args([source.to_str().unwrap(), "-o", program.to_str().unwrap(), "-lm"])
        .output()
        .unwrap();
    assert!(compiled.status.success(), "{name}: {}", String::from_utf8_lossy(&compiled.stderr));
    let mut child = Command::new(&program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap();
    let mut input = child.stdin.take().unwrap();
    let states = states.to_owned();
    let writer = std::thread::spawn(move || input.write_all(states.as_bytes()).unwrap());
    let output = child.wait_with_output().unwrap();
    writer.join().unwrap();
    assert!(output.status.success(), "{name}: {}", output.status);
    let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap_or(f64::NAN)).collect();
    String::from_utf8(output.stdout).unwrap().lines().map(numbers).collect()
}

/// The largest deviation in parts of the largest number among them, or of that of their terms; what is not finite in one must not be in the other.
fn deviation(ours: &[f64], theirs: &[f64], terms: f64) -> f64 {
    if ours.len() != theirs.len() {
        return f64::INFINITY;
    }
    let finite = |list: &[f64]| list.iter().filter(|x| x.is_finite()).fold(0.0_f64, |most, x| most.max(x.abs()));
    let scale = finite(ours).max(terms).max(f64::MIN_POSITIVE);
    let off = |(x, y): (&f64, &f64)| match (x.is_finite(), y.is_finite()) {
        (true, true) => (x - y).abs() / scale,
        (false, false) => 0.0,
        _ => f64::INFINITY,
    };
    ours.iter().zip(theirs).map(off).fold(0.0, f64::max)
}

/// Compares one file's C with what is interpreted; the function that deviates most, where one deviates too much.
fn compare(compiler: &str, folder: &Path, name: &str, path: &Path) -> Result<(), String> {
    let text = fs::read_to_string(path).unwrap();
    let program = compile_in(path.parent(), &text, &[]).unwrap_or_else(|problems| panic!("{name}: {problems:?}"));
    let code = print::c(&program, name);
    let (phases, n) = (program.model.phases.len().max(1), program.model.coordinates.len());
    let fresh = Interpreted::new(program, &text);
    let mut draws = Draws(name.len() as u64);
    let mut states = Vec::new();
    let mut asked = String::new();
    for i in 0..STATES * phases {
        let mut list = |count: usize| (0..count).map(|_| draws.between(0.2, 1.3)).collect::<Vec<f64>>();
        let (q, v, memory) = (list(n), list(n), list(fresh.memory().len()));
        let t = draws.between(0.0, 2.0);
        let numbers: String = [&q, &v, &memory].into_iter().flatten().map(|x| format!(" {x:?}")).collect();
        let _ = writeln!(asked, "{t:?} {}{numbers}", i % phases);
        states.push((t, q, v, memory, i % phases));
    }
    let zeros = vec![0.0; n];
    let all = functions(&fresh, At::new(0.0, &zeros, &zeros));
    let answers = printed(compiler, folder, name, &driver(&code, &all), &asked);
    let mut lines = answers.iter();
    let mut worst = (0.0, String::new());
    let mut check = |what: &str, ours: &[f64], terms: f64| {
        let theirs = lines.next().unwrap();
        let by_differences = what == "acceleration_slopes";
        let off =
            deviation(ours, theirs, terms) * if by_differences { TOLERANCE / TOLERANCE_OF_DIFFERENCES } else { 1.0 };
        // The first that is wrong says most.
        if off > worst.0 && worst.0 <= TOLERANCE {
            worst = (off, format!("{name}: {what}: {off:.1e}: {ours:?} {theirs:?}"));
        }
    };
    for k in 0..fresh.description().scenes.len() {
        let scene = fresh.scene(k);
        check("settings", &[scene.until, scene.tolerance, scene.every.unwrap_or(0.0)], 0.0);
        check("q", &scene.q, 0.0);
        check("v", &scene.v, 0.0);
        check("memory", &fresh.scene_memory(k), 0.0);
    }
    for (turn, (t, q, v, memory, phase)) in states.into_iter().enumerate() {
        let mut system = fresh.clone();
        system.set_memory(&memory);
        system.set_phase(phase);
        settle(&mut system, t, &q, &v);
        let (mut a, mut l) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
        let failed = system.accelerations_and_multipliers(At::new(t, &q, &v), &mut a, &mut l).is_err();
        if failed {
            a.fill(0.0);
            l.fill(0.0);
        }
        check("failure", &[f64::from(u8::from(failed))], 0.0);
        check("accelerations", &a, 0.0);
        check("multipliers", &l, 0.0);
        let direction = Direction::of(&system, turn);
        let slopes = direction.acceleration_slopes(&system, At::new(t, &q, &v));
        JUMPS.fetch_add(usize::from(slopes.is_none()), Ordering::Relaxed);
        let largest = a.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
        // Beside an infinite scale nothing deviates.
        let scale = if slopes.is_some() || failed { largest } else { f64::INFINITY };
        check("acceleration_slopes", &slopes.filter(|_| !failed).unwrap_or_else(|| zeros.clone()), scale);
        // At the motion's own accelerations F is nothing but rounding.
        a.iter_mut().chain(&mut l).for_each(|x| *x += 1.0);
        let at = At::new(t, &q, &v).accelerated(&a).constrained(&l);
        let slopes = |function: Function, size: usize| {
            let mut values = vec![0.0; size];
            assert!(system.slopes(function, at, &direction.along(), &mut values));
            values
        };
        let rows = slopes(Function::RowAccelerations, l.len());
        check("equation_slopes", &[slopes(Function::Residual, n), rows].concat(), 0.0);
        check("output_slopes", &slopes(Function::Outputs, system.description().output_len()), 0.0);
        for (what, _, values) in functions(&system, at) {
            // Terms of F cancel.
            let mut terms = vec![0.0; if what == "residual" { n } else { 0 }];
            if what == "residual" {
                system.magnitudes(at, &mut terms);
            }
            check(what, &values, terms.into_iter().fold(0.0, f64::max));
        }
    }
    assert!(lines.next().is_none(), "{name}");
    println!("{name}: {:.1e}", worst.0);
    if worst.0 <= TOLERANCE { Ok(()) } else { Err(worst.1) }
}

#[test]
fn c_agrees_with_the_program() {
    let Some(compiler) = compiler() else {
        eprintln!("no C compiler here: C is neither compiled nor compared");
        return;
    };
    let folder = std::env::temp_dir().join(format!("dalembert-c-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let files = files();
    assert!(files.len() > 75, "{}", files.len());
    let next = AtomicUsize::new(0);
    let files: Vec<(&String, &PathBuf)> = files.iter().collect();
    let work = || {
        let mine = std::iter::from_fn(|| files.get(next.fetch_add(1, Ordering::Relaxed)));
        mine.filter_map(|(name, path)| compare(compiler, &folder, name, path).err()).collect::<Vec<String>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let wrong: Vec<String> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().expect("a comparison that panics")).collect()
    });
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(JUMPS.load(Ordering::Relaxed) <= MOST_JUMPS, "{JUMPS:?}");
    fs::remove_dir_all(folder).unwrap();
}

/// Constraints of which one says nothing new, and contacts with friction: loops over rows of which a compiler does not know that there are some.
const ROWS: [&str; 2] = [
    "name: Redundant\nparameters: {m: 1 kg, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\n\
     bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {c1: x - y, c2: 2*x - 2*y}\n\
     outputs: {R: reaction(c1)}\nscene: {start: {x: 0, \"x'\": 1}, until: 1}\n",
    "name: Corner\nparameters: {m: 1 kg, W: 1 m, g: 9.81 m/s^2, e: 0.6 1, mu: 0.3 1}\ncoordinates: {x: m, y: m}\n\
     bodies: {ball: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\ncontacts:\n\
     \x20 floor: {gap: y, on: ball, normal: \"[0, 1]\", restitution: e, friction: mu}\n\
     \x20 wall: {gap: W - x, on: ball, normal: \"[-1, 0]\", restitution: e}\nimpacts: sequential\n\
     scene: {start: {x: 0, y: 1, \"x'\": 2}, until: 3}\n",
];

#[test]
fn optimised_c_has_no_warning() {
    let Some(compiler) = compiler() else {
        eprintln!("no C compiler here: C is not compiled");
        return;
    };
    let folder = std::env::temp_dir().join(format!("dalembert-c-rows-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    for (place, text) in ROWS.into_iter().enumerate() {
        let program = compile_in(None, text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        let (source, object) = (folder.join(format!("rows_{place}.c")), folder.join("rows.o"));
        fs::write(&source, print::c(&program, "rows").whole()).unwrap();
        for level in ["-O1", "-O2", "-O3"] {
            let compiled = Command::new(compiler)
                .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", level, "-c"])
                .args([source.to_str().unwrap(), "-o", object.to_str().unwrap()])
                .output()
                .unwrap();
            assert!(compiled.status.success(), "{level}: {}", String::from_utf8_lossy(&compiled.stderr));
        }
    }
    fs::remove_dir_all(folder).unwrap();
}

/// Every macro that the headers and the compiler define, whatever the dialect of C, may be the name of a parameter and of an output.
#[test]
fn no_macro_stands_for_a_name() {
    let Some(compiler) = compiler() else {
        eprintln!("no C compiler here: C is not compiled");
        return;
    };
    let folder = std::env::temp_dir().join(format!("dalembert-c-macros-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let (headers, source, object) = (folder.join("headers.c"), folder.join("macros.c"), folder.join("macros.o"));
    let path = |path: &Path| path.to_str().unwrap().to_owned();
    fs::write(&headers, "#include <float.h>\n#include <math.h>\n#include <stddef.h>\n#include <string.h>\n").unwrap();
    let listed = Command::new(compiler).args(["-D_GNU_SOURCE", "-dM", "-E", &path(&headers)]).output().unwrap();
    let listed = String::from_utf8(listed.stdout).unwrap();
    let names = listed.lines().filter_map(|line| line.split_whitespace().nth(1));
    let names: Vec<&str> = names.filter(|name| !name.starts_with('_') && !name.contains('(')).collect();
    assert!(names.contains(&"M_PI") && names.len() > 50, "{names:?}");
    let parameters: String = names.iter().map(|name| format!(", {name}: 1 N")).collect();
    let text = format!(
        "name: Macros\nparameters: {{m_: 1 kg{parameters}}}\ncoordinates: {{x: m}}\nbodies: {{b: {{mass: m_, position: \"[x, 0]\"}}}}\n\
         forces: {{f: {{on: b, force: \"[{}, 0]\"}}}}\nscene: {{until: 1}}\n",
        names.join(" + ")
    );
    let program = compile_in(None, &text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
    fs::write(&source, print::c(&program, "macros").whole()).unwrap();
    for dialect in ["-std=c99", "-std=gnu99", "-D_GNU_SOURCE", "-O0"] {
        let compiled = Command::new(compiler)
            .args([dialect, "-Wall", "-Wextra", "-Werror", "-c", &path(&source), "-o", &path(&object)])
            .output()
            .unwrap();
        assert!(compiled.status.success(), "{dialect}: {}", String::from_utf8_lossy(&compiled.stderr));
    }
    fs::remove_dir_all(folder).unwrap();
}
