//! `export --fmu`: FMUs are valid, move as the program's runs do, both ways, and what they cannot do is refused.  They are run where
//! there is a Python with FMPy and a C compiler.
#![cfg(feature = "cli")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const MODELS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../models");

/// By how much a motion may differ, in parts of the largest value of each variable.
const TOLERANCE: f64 = 1e-6;

/// What each shows: the model, its options, and where its run is compared.
const COMPARED: [(&str, &[&str]); 20] = [
    // Nothing but coordinates.
    ("double_pendulum", &["--until", "2"]),
    ("triple_pendulum", &["--until", "3"]),
    // Inputs of time, which enter with both rates.
    ("base_excitation", &[]),
    ("shaken_pendulum", &[]),
    // Constraints: closed loops, speeds, a quaternion beside them.
    ("slider_crank", &["--until", "2"]),
    ("chaplygin_sleigh", &[]),
    ("rolling_disc", &["--until", "2"]),
    // Phases with friction, an end by an event.
    ("stick_slip", &[]),
    ("eccentric_cylinder", &["--scene", "real"]),
    // Impacts without end.
    ("bouncing_ball", &[]),
    // Held values set by events and by a clock; a state of first order.
    ("counter", &["--until", "8"]),
    ("sampled_robot", &[]),
    ("thermostat", &[]),
    // A table of two arguments, of which one is an input.
    ("engine_map", &["--until", "10"]),
    // Events that end, record and switch; a constraint on a curve; many coordinates with dampers; a law that grows.
    ("braking_car", &[]),
    ("cannon_ball", &[]),
    ("cannon_ball_quadratic", &[]),
    ("bead_parabola", &[]),
    ("damped_chain", &[]),
    ("exponential_growth", &[]),
];

/// Files whose motions pass zeros at which rounding, or nothing but what happens a moment later, says what is on either side.
const AT_ZEROS: [(&str, &str); 4] = [
    // Discontinuities at zero at the start, by an event, and where a law saturates; one that stays at zero.
    (
        "kinks",
        "parameters: {m: 1 kg, k: 10 N/m, F: 3 N, g: 9.81 m/s^2, w: 4 rad/s, r: 1 1/s, t1: 0.3 s, kp: 20 N/m, kd: 2 N*s/m, ref: 0.5 m}\n\
         coordinates: {x: m, y: m, z: m, s: m, l: m, o: m}\n\
         states: {a: {unit: 1, rate: -r*(1 + 3*step(a))}, b: {unit: 1, rate: r*sign(a)}}\n\
         inputs: {u: F*sign(sin(w*t))}\n\
         bodies: {b1: {mass: m, position: \"[x, y]\"}, b2: {mass: m, position: \"[z, s]\"}, b3: {mass: m, position: \"[l, o]\"}}\n\
         potential_energy: F*abs(x) + m*g*y + (k*z^2 + k*s^2 + k*o^2)/2\n\
         generalized_forces: {y: \"-F*sign(y')\", z: u, s: \"-0.1*F*sign(s')\", l: \"max(-F, min(F, kp*(ref - l) - kd*l'))\", \
         o: \"-F*sign(o')\"}\n\
         events: {put: {when: t - t1, direction: rising, then: {set: {a: 0}}}}\n\
         scene: {start: {x: 0, \"x'\": -1, s: 1.3, a: 2}, until: 1.7}\n",
    ),
    // Events of one direction, with a constraint on which steps end.
    (
        "passes",
        "parameters: {m: 1 kg, l: 1.2 m, x0: 0.3 m, g: 9.81 m/s^2}\ncoordinates: {x: m, y: m}\nmemory: {f: 0, r: 0}\n\
         bodies: {bob: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {rod: x^2 + y^2 - l^2}\n\
         events:\n  falls: {when: x - x0, direction: falling, then: {set: {f: f + 1}}}\n\
         \x20 rises: {when: x - x0, direction: rising, then: {set: {r: r + 1}}}\noutputs: {falling: f, rising: r}\n\
         scene: {start: {x: l*sin(1), y: -l*cos(1)}, until: 12}\n",
    ),
    // An event that is past at the start and ends its phase, and one that is past and does not.
    (
        "past",
        "parameters: {m: 1 kg, k: 5 N/m, d: 1 m}\ncoordinates: {x: m}\nmemory: {n: 0}\n\
         bodies: {b: {mass: m, position: \"[x, 0]\"}}\nphases: {low: [], high: []}\n\
         forces: {f: {on: b, force: \"[2*k*d, 0]\", phase: low}, g: {on: b, force: \"[-k*d, 0]\", phase: high}}\n\
         events:\n  up: {when: x - d, direction: rising, phase: low, then: high}\n\
         \x20 down: {when: x - d, direction: falling, phase: high, then: low}\n\
         \x20 count: {when: x - d, direction: rising, then: {set: {n: n + 1}}}\noutputs: {counted: n}\n\
         scene: {start: {x: 1.5}, until: 2}\n",
    ),
    // Ticks from the start on that add.
    (
        "ticks",
        "parameters: {w: 0 1/s}\nstates: {b: {unit: 1, rate: -b*w}}\nmemory: {n: 0}\n\
         events: {tick: {every: 0.7 s, then: {set: {b: b + 1, n: n + 1}}}}\noutputs: {counted: n}\n\
         scene: {start: {b: 0}, until: 2}\n",
    ),
];

/// A block that a spring pulls less than dry friction holds it, by a sign: no acceleration on either side of rest.
const STICKS: &str = "name: Sticks\nparameters: {m: 1 kg, k: 10 N/m, F: 3 N}\ncoordinates: {x: m}\n\
                      bodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                      generalized_forces: {x: \"-k*x - F*sign(x')\"}\nscene: {start: {x: 1}, until: 4}\n";

/// A fall onto a floor at y = 0 that a phase with the constraint y = 0 begins at y = AT.
const ENTERS: &str = "parameters: {m: 1 kg, g: 9.81 m/s^2, h: AT m}\ncoordinates: {x: m, y: m}\n\
                      bodies: {b: {mass: m, position: \"[x, y]\"}}\ngravity: [0, -g]\nconstraints: {floor: y}\n\
                      phases: {falls: [], slides: [floor]}\n\
                      events: {lands: {phase: falls, when: y - h, direction: falling, then: slides}}\n\
                      scene: {start: {y: 1, \"x'\": 1}, until: 1}\n";

/// Tells of every FMU of a folder when its run fails.
const FAILURES: &str = r#"
import glob, os, sys
from fmpy import simulate_fmu
for path in sorted(glob.glob(os.path.join(sys.argv[1], "*.fmu"))):
    for kind in ("CoSimulation", "ModelExchange"):
        last = [0.0]
        def finished(time, recorder):
            last[0] = time
            return True
        try:
            simulate_fmu(path, fmi_type=kind, step_finished=finished)
            print(kind, "ran")
        except Exception as problem:
            print(kind, round(last[0], 1), str(problem).split()[0])
"#;

/// Compares every FMU of a folder with the table beside it; prints a line for each.
const DRIVER: &str = r#"
import csv, glob, os, sys
import numpy as np
from fmpy import read_model_description, simulate_fmu
from fmpy.validation import validate_fmu
for path in sorted(glob.glob(os.path.join(sys.argv[1], "*.fmu"))):
    problems = validate_fmu(path)
    with open(path[:-4] + ".csv") as file:
        rows = list(csv.reader(file))
    names, ours = rows[0], np.array([[float(x) if x else np.nan for x in row] for row in rows[1:]])
    stop = float(read_model_description(path).defaultExperiment.stopTime)
    for kind in ("CoSimulation", "ModelExchange"):
        more = {"relative_tolerance": 1e-10} if kind == "ModelExchange" else {}
        theirs = simulate_fmu(path, fmi_type=kind, validate=False, stop_time=stop, output_interval=stop/100, **more)
        worst, compared = 0.0, 0
        for name in set(theirs.dtype.names) & set(names):
            column = ours[:, names.index(name)]
            scale = max(1e-3, np.nanmax(np.abs(column)))
            for t, x in zip(ours[:, 0], column):
                here = np.abs(theirs["time"] - t) < 1e-9*stop
                if here.any() and np.isfinite(x):
                    worst = max(worst, np.min(np.abs(theirs[name][here] - x))/scale)
                    compared += 1
        print(os.path.basename(path), kind, worst, compared, "valid" if not problems else problems)
"#;

/// Compares directional derivatives of every FMU of a folder with differences of what they are derivatives of, by each state, time,
/// parameter and input; prints a line for each FMU.
const SLOPES: &str = r#"
import glob, os, sys
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model
from fmpy.fmi3 import FMU3Model

def started(folder, told):
    identifier = told.modelExchange.modelIdentifier
    if told.fmiVersion == "2.0":
        fmu = FMU2Model(guid=told.guid, modelIdentifier=identifier, unzipDirectory=folder)
    else:
        fmu = FMU3Model(guid=told.instantiationToken, modelIdentifier=identifier, unzipDirectory=folder)
    fmu.instantiate()
    if told.fmiVersion == "2.0":
        fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.newDiscreteStates() if told.fmiVersion == "2.0" else fmu.updateDiscreteStates()
    fmu.enterContinuousTimeMode()
    fmu.setTime(0.1)
    return (fmu, fmu.getReal, fmu.setReal) if told.fmiVersion == "2.0" else (fmu, fmu.getFloat64, fmu.setFloat64)

for path in sorted(glob.glob(os.path.join(sys.argv[1], "*.fmu"))):
    folder, told = extract(path), read_model_description(path)
    numbers = [v for v in told.modelVariables if v.type in ("Real", "Float64")]
    of = lambda *kinds: [v.valueReference for v in numbers if v.causality in kinds]
    rates = [u.variable.valueReference for u in told.derivatives]
    states = [u.variable.derivative.valueReference for u in told.derivatives]
    unknowns = rates + [k for k in of("output") if k not in states]
    worst = 0.0
    for known in states + of("independent", "parameter", "input"):
        fmu, get, put = started(folder, told)
        here = get([known])[0]
        if known in of("input"):
            put([known], [here])
        size = 1e-5*(abs(here) if known in of("parameter") and here else 1.0)
        move = fmu.setTime if known in of("independent") else lambda value: put([known], [value])
        def at(k):
            move(here + k*size)
            return np.array(get(unknowns))
        differences = (at(-2) - 8*at(-1) + 8*at(1) - at(2))/(12*size)
        values = at(0)
        slopes = np.array(fmu.getDirectionalDerivative(unknowns, [known], [2.0]))/2
        scale = np.max(np.abs(slopes)) + 1e-6/size*np.max(np.abs(values)) + 1e-12
        worst = max(worst, np.max(np.abs(slopes - differences))/scale)
        for wrong in (lambda: get([2**32 - 1]), lambda: fmu.getDirectionalDerivative([2**32 - 1], [known], [1.0])):
            try:
                wrong()
                worst = np.inf
            except Exception:
                pass
        fmu.terminate()
        fmu.freeInstance()
    print(os.path.basename(path), len(unknowns), worst)
"#;

/// What a command prints, or its error.
fn run(arguments: &[&str]) -> Result<String, String> {
    let mut out = Vec::new();
    let all = [&["dalembert"], arguments].concat();
    dalembert::cli::run(&[], all, &mut out).map_err(|problem| problem.to_string())?;
    Ok(String::from_utf8(out).unwrap())
}

/// A Python that knows FMPy, where there is a C compiler too.
fn python() -> Option<&'static str> {
    let works = |program: &str, arguments: &[&str]| {
        let tried = Command::new(program).args(arguments).stdout(Stdio::null()).stderr(Stdio::null()).status();
        tried.is_ok_and(|status| status.success())
    };
    let compiles = ["cc", "gcc", "clang"].into_iter().any(|compiler| works(compiler, &["--version"]));
    ["python3", "/usr/bin/python3"].into_iter().find(|python| compiles && works(python, &["-c", "import fmpy"]))
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("dalembert-{name}-{}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Exports the model of a folder with its options, and writes the table of the same run.
fn export(folder: &Path, version: &str, (models, name): (&str, &str), options: &[&str]) {
    let model = format!("{models}/{name}.yaml");
    let path = |end: &str| folder.join(format!("{name}.{end}")).to_str().unwrap().to_owned();
    let told = run(&[&["export", &model, "--fmi", version, "--fmu", &path("fmu")], options].concat()).unwrap();
    assert!(told.starts_with("wrote "), "{told}");
    let description = String::from_utf8_lossy(&fs::read(path("fmu")).unwrap()).into_owned();
    let stop = description.split_once("stopTime=\"").and_then(|(_, rest)| rest.split_once('"')).unwrap().0;
    let every = (stop.parse::<f64>().unwrap() / 100.0).to_string();
    run(&[&["simulate", &model, "--csv", &path("csv"), "--every", &every, "--no-digits"], options].concat()).unwrap();
}

/// What a script prints of a folder.
fn told(python: &str, script: &str, folder: &Path) -> String {
    let output = Command::new(python).args(["-W", "ignore", "-c", script, folder.to_str().unwrap()]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{text}\n{}", String::from_utf8_lossy(&output.stderr));
    text
}

/// Where there is a C compiler it takes the sources, or `export` fails.
#[test]
fn a_compiler_takes_the_sources() {
    let folder = folder("fmu-sources");
    let files =
        COMPARED.map(|(name, options)| (name, "3", options)).into_iter().chain([("slider_crank", "2", &[][..])]);
    for (name, version, options) in files {
        let (model, path) = (format!("{MODELS}/{name}.yaml"), folder.join(format!("{name}.fmu")));
        let scene = options.chunks(2).filter(|option| option[0] == "--scene").flatten().copied();
        let export = ["export", &model, "--fmi", version, "--fmu", path.to_str().unwrap()];
        let told = run(&export.into_iter().chain(scene).collect::<Vec<_>>());
        assert!(told.as_ref().is_ok_and(|told| told.starts_with("wrote ")), "{name}, FMI {version}: {told:?}");
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn fmus_move_as_the_program_does() {
    let Some(python) = python() else {
        eprintln!("no Python with FMPy, or no C compiler: FMUs are not run");
        return;
    };
    for version in ["2", "3"] {
        compare(python, version);
    }
}

/// Runs FMUs of a version of FMI.
fn compare(python: &str, version: &str) {
    let folder = folder(&format!("fmu-{version}"));
    for (name, options) in COMPARED {
        export(&folder, version, (MODELS, name), options);
    }
    agree(python, &folder, COMPARED.len());
    let slopes = told(python, SLOPES, &folder);
    // FMPy prints why calls are refused.
    let lines: Vec<&str> = slopes.lines().filter(|line| line.contains(".fmu ")).collect();
    assert_eq!(lines.len(), COMPARED.len(), "{slopes}");
    let right = |line: &&str| line.rsplit(' ').next().unwrap().parse::<f64>().unwrap() <= TOLERANCE;
    assert!(lines.iter().all(right), "{slopes}");
    fs::remove_dir_all(folder).unwrap();
}

/// Runs the FMUs of a folder, so many, beside their tables.
fn agree(python: &str, folder: &Path, count: usize) {
    let text = told(python, DRIVER, folder);
    let lines: Vec<Vec<&str>> = text.lines().map(|line| line.splitn(5, ' ').collect()).collect();
    assert_eq!(lines.len(), 2 * count, "{text}");
    let right = |line: &Vec<&str>| {
        let (worst, compared): (f64, usize) = (line[2].parse().unwrap(), line[3].parse().unwrap());
        worst <= TOLERANCE && compared >= 100 && line[4] == "valid"
    };
    assert!(lines.iter().all(right), "{text}");
}

#[test]
fn what_is_at_a_zero_is_where_it_goes() {
    let Some(python) = python() else {
        eprintln!("no Python with FMPy, or no C compiler: FMUs are not run");
        return;
    };
    let (zeros, sticks) = (folder("fmu-zeros"), folder("fmu-sticks"));
    for (name, text) in AT_ZEROS {
        fs::write(zeros.join(format!("{name}.yaml")), format!("name: Zeros\n{text}")).unwrap();
        export(&zeros, "3", (zeros.to_str().unwrap(), name), &[]);
    }
    agree(python, &zeros, AT_ZEROS.len());
    // A constraint that does not hold where it is entered, and one that does but for the integration's error.
    for (name, entered, failed) in [("misses", "0.5", true), ("meets", "0", false)] {
        let text = format!("name: Enters\n{ENTERS}").replace("AT", entered);
        let (folder, model) = (folder(name), zeros.join(format!("{name}.yaml")));
        fs::write(&model, text).unwrap();
        let fmu = folder.join("enters.fmu");
        run(&["export", model.to_str().unwrap(), "--fmu", fmu.to_str().unwrap()]).unwrap();
        let text = told(python, FAILURES, &folder);
        assert_eq!(text.lines().any(|line| line.contains("fmi3DoStep")), failed, "{text}");
        assert_eq!(text.lines().filter(|line| line.ends_with(" ran")).count(), if failed { 0 } else { 2 }, "{text}");
        fs::remove_dir_all(folder).unwrap();
    }
    // From x = 1 m to -0.4 m and 0.2 m, where it stays after half a period each, of 2 pi/sqrt(10) s.
    let (model, fmu) = (sticks.join("sticks.yaml"), sticks.join("sticks.fmu"));
    fs::write(&model, STICKS).unwrap();
    run(&["export", model.to_str().unwrap(), "--fmu", fmu.to_str().unwrap()]).unwrap();
    let text = told(python, FAILURES, &sticks);
    let last: Vec<&str> = text.lines().filter(|line| line.contains("fmi3")).collect();
    assert_eq!(last, ["CoSimulation 2.0 fmi3DoStep", "ModelExchange 2.0 fmi3UpdateDiscreteStates"], "{text}");
    for folder in [zeros, sticks] {
        fs::remove_dir_all(folder).unwrap();
    }
}

#[test]
fn an_fmu_has_its_variables_and_its_sources() {
    let folder = folder("fmu-text");
    let path = folder.join("motor.fmu").to_str().unwrap().to_owned();
    run(&["export", &format!("{MODELS}/motor.yaml"), "--fmu", &path, "--set", "R=2 ohm", "--start", "i=0.5"]).unwrap();
    let bytes = fs::read(&path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for part in [
        "<Float64 name=\"i\" valueReference=\"3\" causality=\"output\" variability=\"continuous\" initial=\"exact\" unit=\"A\" start=\"0.5\"/>",
        "name=\"der(i)\"",
        "derivative=\"3\"",
        "name=\"R\" valueReference=\"9\" causality=\"parameter\" variability=\"tunable\" initial=\"exact\" unit=\"ohm\" start=\"2.0\"",
        "<Float64 name=\"u\"",
        "causality=\"input\" variability=\"continuous\" start=\"12.0\"",
        "<BaseUnit kg=\"1\" m=\"2\" s=\"-3\" A=\"-2\"/>",
        "<SourceFile name=\"fmi3_functions.c\"/>",
        "providesDirectionalDerivatives=\"true\"",
        "sources/dalembert_core.h",
        "fmi3Status fmi3DoStep(",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(bytes.starts_with(b"PK\x03\x04") && bytes[bytes.len() - 22..].starts_with(b"PK\x05\x06"));
    fs::remove_dir_all(folder).unwrap();
}

/// The older version has the same variables in its own words.
#[test]
fn an_fmu_of_fmi_2_names_variables_by_their_places() {
    let folder = folder("fmu-2-text");
    let path = folder.join("bouncing_ball.fmu").to_str().unwrap().to_owned();
    run(&["export", &format!("{MODELS}/bouncing_ball.yaml"), "--fmu", &path, "--fmi", "2"]).unwrap();
    let bytes = fs::read(&path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for part in [
        "fmiVersion=\"2.0\"",
        "numberOfEventIndicators=\"",
        "<File name=\"fmi2_functions.c\"/>",
        "providesDirectionalDerivative=\"true\"",
        "<ScalarVariable name=\"x\" valueReference=\"1\" causality=\"output\" variability=\"continuous\" initial=\"exact\">\n      <Real unit=\"m\" start=\"0.0\"/>",
        // Of the second variable, the first state.
        "derivative=\"2\"/>",
        "<ScalarVariable name=\"phase\"",
        "<Integer start=\"0\"/>",
        "fmi2Status fmi2DoStep(",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(!text.contains("fmi3") && !text.contains("buildDescription"));
    let refused = run(&["export", &format!("{MODELS}/bouncing_ball.yaml"), "--fmu", &path, "--fmi", "1"]).unwrap_err();
    assert!(refused.contains("--fmi") && refused.contains("2, 3"), "{refused}");
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn what_an_fmu_cannot_do_is_refused_with_a_way_out() {
    let (name, path) = (format!("{MODELS}/ladder.yaml"), std::env::temp_dir().join("refused.fmu"));
    let path = path.to_str().unwrap();
    let refused = run(&["export", &name, "--fmu", path]).unwrap_err();
    assert!(refused.contains("`wall`") && refused.contains("export --c"), "{refused}");
    let sharp = "name: Sharp\nparameters: {m: 1 kg, c: 2 N*s/m, h: 1 m, T: 1 s}\ncoordinates: {x: m}\n\
                 inputs: {u: \"h*step(t - T)\"}\nbodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                 forces: {f: {on: b, force: \"[c*(u' - x'), 0]\"}}\nscene: {until: 2}\n";
    let folder = folder("fmu-refused");
    let file = folder.join("sharp.yaml");
    fs::write(&file, sharp).unwrap();
    let refused = run(&["export", file.to_str().unwrap(), "--fmu", path]).unwrap_err();
    assert!(refused.contains("`u` may jump") && refused.contains("smooth input"), "{refused}");
    let motor = format!("{MODELS}/motor.yaml");
    let refused = run(&["export", &motor, "--fmu", path, "--input", "u=1 V"]).unwrap_err();
    assert!(refused.contains("--input"), "{refused}");
    let refused = run(&["export", &motor, "--c", folder.to_str().unwrap(), "--set", "R=2"]).unwrap_err();
    assert!(refused.contains("--set: C has parameters"), "{refused}");
    let refused = run(&["export", &motor]).unwrap_err();
    assert!(refused.contains("--fmu"), "{refused}");
    assert!(!Path::new(path).exists());
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn export_writes_c_that_goes_with_its_header() {
    let folder = folder("c-files");
    let told = run(&["export", &format!("{MODELS}/counter.yaml"), "--c", folder.to_str().unwrap()]).unwrap();
    assert!(told.starts_with("wrote counter.h, counter.c, dalembert_core.h, dalembert_core.c to "), "{told}");
    let text = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    assert!(text("counter.c").starts_with("#include \"dalembert_core.h\"\n#include \"counter.h\"\n"));
    assert!(text("counter.h").contains(
        "void counter_mass_matrix(const double *c, double t, const double *u, const double *q, const double *v, double *out);"
    ));
    assert!(text("dalembert_core.c").starts_with("#include \"dalembert_core.h\"\n"));
    fs::remove_dir_all(folder).unwrap();
}

/// A mass at x + base with a spring on x, `extra` in the place of more forces.
const SHAKEN: &str = "name: Shaken\nparameters: {m: 2 kg, k: 50 N/m, A: 0.2 m, w: 3 rad/s}\ncoordinates: {x: m}\n\
                      inputs: {base: \"A*sin(w*t)\"}\nbodies: {b: {mass: m, position: \"[x + base, 0]\"}}\n\
                      springs: {s: {stretch: x, stiffness: k, along: ground.x, on: b}}\n\
                      outputs: {v: velocity(b), pos: position(b)}\nscene: {start: {x: 0.1}, until: 1, tolerance: 1e-10}\n";

/// A mass that a damper ties to a point that moves, and a slider that a constraint moves.
const TIED: &str = "name: Tied\nparameters: {m: 2 kg, c: 4 N*s/m}\ncoordinates: {x: m, y: m}\ninputs: {end: 0 m, drive: 0 m}\n\
                    bodies: {b: {mass: m, position: \"[x, 0]\"}, s: {mass: m, position: \"[y, 0]\"}}\n\
                    generalized_forces: {x: \"-c*(x' - end')\"}\nconstraints: {slides: y - drive}\nscene: {until: 1}\n";

/// Ticks of a period that is a parameter.
const TICKS: &str = "name: Ticks\nparameters: {T: 0.1 s, m: 1 kg}\ncoordinates: {x: m}\nmemory: {n: 0}\n\
                     bodies: {b: {mass: m, position: \"[x, 0]\"}}\n\
                     events: {tick: {every: T, then: {set: {n: n + 1}}}}\nscene: {start: {x': 1}, until: 2}\n";

/// What an instance in Co-Simulation does that is set between its steps; prints what is wrong with it.
const SET: &str = r#"
import os, sys
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Model, FMU2Slave
from fmpy.fmi3 import FMU3Model, FMU3Slave

class Instance:
    def __init__(self, name, exchange=False, **starts):
        path = os.path.join(sys.argv[1], name + ".fmu")
        told, self.said = read_model_description(path), []
        self.told = {v.name: v for v in told.modelVariables}
        two = told.fmiVersion == "2.0"
        kind = ((FMU3Slave, FMU3Model), (FMU2Slave, FMU2Model))[two][exchange]
        token = told.guid if two else told.instantiationToken
        self.fmu = kind(unzipDirectory=extract(path), modelIdentifier=told.coSimulation.modelIdentifier, guid=token)
        self.fmu.instantiate()
        if two: self.fmu.setupExperiment()
        self.read, self.write = (self.fmu.getReal, self.fmu.setReal) if two else (self.fmu.getFloat64, self.fmu.setFloat64)
        self.t = 0.0
        self.fmu.enterInitializationMode()
        self.set(**starts)
        self.fmu.exitInitializationMode()
    def set(self, **values):
        for name, value in values.items():
            self.write([self.told[name.replace("_", "'")].valueReference], [value])
        return self
    def happen(self, time=None):
        if time is not None:
            self.fmu.setTime(time)
        self.fmu.newDiscreteStates() if hasattr(self.fmu, "newDiscreteStates") else self.fmu.updateDiscreteStates()
        return self
    def __getitem__(self, name):
        return self.read([self.told[name].valueReference])[0]
    def step(self, length, now=None):
        self.fmu.doStep(self.t if now is None else now, length)
        self.t += length
        return self

def close(what, is_, right, within=1e-7):
    if not abs(is_ - right) <= within:
        print("WRONG", what, is_, right)

def refused(what, do):
    try:
        do()
    except Exception:
        return
    print("NOT REFUSED", what)

m, k, A, w = 2.0, 50.0, 0.2, 3.0
# Stopped at once at t = 0.5, base stays: place and velocity of the mass are continuous.
def stopped(**rates):
    shaken = Instance("shaken").step(0.5)
    before = [shaken[name] for name in ("pos.x", "v.x")]
    x0, v0, base = shaken["x"], before[1], A*np.sin(w*0.5)
    shaken.set(base=base, **rates).step(1e-9)
    for name, value in zip(("pos.x", "v.x"), before): close(f"{name} where base stops", shaken[name], value)
    shaken.step(0.5 - 1e-9)
    own = np.sqrt(k/m)
    close("the end after base stops", shaken["x"], x0*np.cos(own*0.5) + v0/own*np.sin(own*0.5))
stopped()
stopped(base_=0.0)
# Its own law, given step by step, with one rate and with both: the same motion as the file's, the finer the better.
def followed(steps, second):
    shaken, h = Instance("shaken"), 1/steps
    for i in range(steps):
        s = w*i*h
        shaken.set(base=A*np.sin(s), base_=A*w*np.cos(s), **({"base__": -A*w*w*np.sin(s)} if second else {})).step(h)
    return shaken["x"]
exact = Instance("shaken").step(1)["x"]
for second, within in ((False, 1e-2), (True, 2e-4)):
    coarse, fine = (abs(followed(steps, second) - exact) for steps in (50, 100))
    close(f"rates given, with the second {second}", fine, 0, within)
    if not fine < 0.7*coarse: print("WRONG order", coarse, fine)
# What only a rate is given of goes on from where it is.
shaken = Instance("shaken").step(0.5).set(base_=0.7)
close("base where its rate alone was set", shaken["base"], A*np.sin(w*0.5), 1e-12)
close("base a step later", shaken.step(0.1)["base"], A*np.sin(w*0.5) + 0.07, 1e-12)
# It may not jump, but begin anywhere.
refused("a jump of base", lambda: Instance("shaken").step(0.5).set(base=0.0).step(0.1))
refused("base without its rate", lambda: Instance("shaken", base=0.0).step(0.1).set(base=0.01).step(0.1))
Instance("shaken", base=0.3).step(0.1).set(base=0.3).step(0.1)
# A damper pulls at once by c times what its end moves, and a constraint takes the slider along.
tied = Instance("tied", end=0.0, drive=0.0).step(0.5)
tied.set(end=0.3).step(1e-9)
close("speed after a pull at the damper", tied["x'"], 4.0*0.3/2.0)
tied.set(drive_=0.4).step(0.1)
close("place of what a constraint moves", tied["y"], 0.04)
close("its speed", tied["y'"], 0.4)
refused("a jump of a constraint", lambda: tied.set(drive=0.5).step(0.1))
# In Model Exchange the same at events; between them the file's function stands where a rate alone is set.
exchange = Instance("shaken", exchange=True).happen()
speed = exchange["x'"]
exchange.fmu.enterContinuousTimeMode()
exchange.fmu.setTime(0.5)
exchange.set(base_=0.1)
close("base of the file", exchange["base"], A*np.sin(w*0.5), 1e-12)
exchange.set(base=0.2, base_=0.1)
exchange.fmu.enterEventMode()
exchange.set(base=0.2, base_=0.4).happen()
close("a turn at an event", exchange["x'"] - speed, -0.3, 1e-12)
refused("a jump at an event", lambda: exchange.set(base=0.3).happen())
# Periods are fixed, steps follow each other, and reasons are told.
if Instance("ticks").told["T"].variability != "fixed" or Instance("ticks").told["m"].variability != "tunable": print("WRONG variability")
refused("another period", lambda: Instance("ticks").step(0.25).set(T=0.25))
ticks = Instance("ticks", T=0.25).set(m=3.0).step(1.1)
close("ticks of the period that was set at the start", ticks["n"], 5, 0)
refused("a step from elsewhere", lambda: Instance("ticks").step(0.1, now=5.0))
many = Instance("ticks")
for i in range(1, 300): many.step(0.001, now=0.001*(i - 1))
refused("no period", lambda: Instance("ticks", T=0.0))
refused("a negative mass", lambda: Instance("ticks", m=-1.0))
refused("a negative mass later", lambda: Instance("ticks").step(0.1).set(m=-1.0).step(0.1))
print("done")
"#;

#[test]
fn what_is_set_between_steps_is_no_silent_force() {
    let Some(python) = python() else {
        eprintln!("no Python with FMPy, or no C compiler: FMUs are not run");
        return;
    };
    for version in ["2", "3"] {
        let folder = folder(&format!("fmu-set-{version}"));
        for (name, text) in [("shaken", SHAKEN), ("tied", TIED), ("ticks", TICKS)] {
            let model = folder.join(format!("{name}.yaml"));
            fs::write(&model, text).unwrap();
            let fmu = folder.join(format!("{name}.fmu"));
            run(&["export", model.to_str().unwrap(), "--fmi", version, "--fmu", fmu.to_str().unwrap()]).unwrap();
        }
        let text = told(python, SET, &folder);
        assert!(text.lines().all(|line| !line.starts_with("WRONG") && !line.starts_with("NOT")), "{text}");
        assert!(text.ends_with("done\n"), "{text}");
        for part in [
            "`base` jumps, which would take an infinite force: set its rate `base'` with it",
            "`drive` jumps",
            "the step begins at t = 5 s, but it is t = 0 s here",
            "the period of ticks depends on this parameter",
            "the period of ticks is 0 s, not positive",
            "negative inertia: `x`",
        ] {
            assert!(text.contains(part), "{part}: {text}");
        }
        fs::remove_dir_all(folder).unwrap();
    }
}
