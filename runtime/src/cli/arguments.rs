//! What may stand on the command line.

use std::ffi::OsString;

use clap::builder::PossibleValuesParser;
use clap::error::{ContextKind, ContextValue};
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Command, ValueHint};
use clap_complete::Shell;
use dalembert_symbolic::diagnose::nearest;

use super::help;

/// The whole grammar.
pub fn command() -> Command {
    grammar().mut_subcommands(help::told)
}

fn grammar() -> Command {
    let about = "Simulates mechanisms described in YAML, and says how far to trust the result";
    Command::new("dalembert")
        .about(about)
        .version(env!("CARGO_PKG_VERSION"))
        .subcommand_required(true)
        .arg_required_else_help(true)
        .after_help(EXIT_CODES)
        .subcommand(Command::new("list").about("Names the models of the library").arg(quiet()).arg(flag("json", "Print one JSON object")))
        .subcommand(
            Command::new("show")
                .about("Prints the derived equations, operation counts and what was recognised")
                .arg(model())
                .args(sizes())
                .arg(quiet())
                .arg(flag("linear", "Print M, C, K and B of small motions about the file's `equilibrium`, as expressions of the parameters; with --latex in LaTeX").conflicts_with_all(["rust", "python", "c", "json"]))
                .arg(many("at", "NAME=EXPR", "Another equilibrium: a coordinate's value, an expression of parameters").requires("linear"))
                .arg(flag("rust", "Print the generated Rust instead"))
                .arg(flag("latex", "Print them in LaTeX"))
                .arg(flag("python", "Print a module for Python (NumPy) that gives M, h and the rate of the state"))
                .arg(flag("c", "Print C99, one text that compiles by itself: everything that the Rust has, and accelerations"))
                .arg(flag("json", "Print one JSON object"))
                .arg(output("FILE"))
                .group(ArgGroup::new("form").args(["rust", "latex", "python", "c", "json"])),
        )
        .subcommand(
            Command::new("export")
                .about("Writes a model as code for other programs")
                .arg(model())
                .args(sizes())
                .arg(quiet())
                .args(scene())
                // Refused with the reason.
                .mut_arg("input", |input| input.hide(true))
                .arg(value("fmu", "FILE.fmu", "Write an FMU that starts as the scene does: Model Exchange and Co-Simulation, sources, and where there is a C compiler a library").value_hint(ValueHint::FilePath))
                .arg(value("fmi", "VERSION", "The FMU's version of FMI [default: 3]").value_parser(["2", "3"]).requires("fmu"))
                .group(ArgGroup::new("what").args(["c", "fmu"]).multiple(true).required(true))
                .arg(value("c", "FOLDER", "Write NAME.h, NAME.c and the core that all models share, C99").value_hint(ValueHint::DirPath)),
        )
        .subcommand(
            Command::new("check")
                .about("Reads and derives a model, or several, and says what was tested")
                .arg(model().value_name("FILES").num_args(1..))
                .args(sizes())
                .arg(quiet())
                .arg(flag("routh", "The equations without the coordinates and directions that can be ignored, by Routh's procedure, and what they cost").conflicts_with("json"))
                .arg(flag("symmetries", "Exchanges and reflections of coordinates that leave the equations as they are, and which of them each scene's start has").conflicts_with("json"))
                .arg(flag("json", "Print one JSON object; of a file with mistakes these, with their places; of several files a list `files` of such objects")),
        )
        .subcommand(generate())
        .subcommand(simulate())
        .subcommand(modes())
        .subcommand(solve())
        .subcommand(orbit())
        .subcommand(sweep())
        .subcommand(chart())
        .subcommand(needs())
        .subcommand(
            Command::new("stability")
                .about("Maps where a method is stable: growth per step of an oscillator over hω and its damping, measured, beside theory")
                .arg(Arg::new("method").value_name("METHOD").required(true).help("dop853, radau5, …"))
                .arg(value("longest", "NUMBER", "How far the map goes: h·ω [default: 7]"))
                .arg(picture("plot", "Where the map goes [default: METHOD-stability.svg]").short('o'))
                .arg(flag("json", "Print one JSON object"))
                .arg(quiet()),
        )
        .subcommand(
            Command::new("new")
                .about("Writes a commented model file to start from, and beside it the schema that editors complete its keys by")
                .arg(Arg::new("name").value_name("NAME").required(true).help("The file's name, without .yaml"))
                .arg(flag("crate", "Write a crate of this name that runs the model, in a folder of its own: `cargo run` in it prints what the motion is and how far it holds"))
                .arg(quiet()),
        )
        .subcommand(import())
        .subcommand(Command::new("schema").about("Writes a JSON schema of model files, by which editors complete keys and underline others").arg(quiet()).arg(output("FILE.json")))
        .subcommand(
            Command::new("completions")
                .about("Writes a script by which a shell completes commands and options; Bash and Zsh also names of models")
                .arg(
                    Arg::new("shell")
                        .value_name("SHELL")
                        .required(true)
                        .value_parser(clap::value_parser!(Shell))
                        .help("bash, elvish, fish, powershell or zsh"),
                )
                .arg(quiet()),
        )
}

/// What the arguments say (the first is the program's name); where no command has a name, with the nearest that one has, after `help` too.
pub fn parsed(arguments: impl IntoIterator<Item = impl Into<OsString> + Clone>) -> Result<ArgMatches, clap::Error> {
    command().try_get_matches_from(arguments).map_err(|mut error| {
        if let Some(ContextValue::String(name)) = error.get(ContextKind::InvalidSubcommand)
            && error.get(ContextKind::SuggestedSubcommand).is_none()
        {
            let grammar = command();
            let near = nearest(name, grammar.get_subcommands().map(Command::get_name)).map(str::to_owned);
            let near = near.map(|near| ContextValue::Strings(vec![near]));
            near.and_then(|near| error.insert(ContextKind::SuggestedSubcommand, near));
        }
        error
    })
}

/// What the program ends with.
const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  a model file is wrong, a run failed or was interrupted (what was computed is written all the same), or a file
     cannot be read or written
  2  wrong usage: an option, a name, a value, or a file to read that is not there
  130, 143  ended by Ctrl-C or SIGTERM before anything was computed that could be written

With --json a command that fails prints one object all the same: its `error` has a `kind` (usage, model, run or file) and a
`message`, beside what was computed until then.";

/// The grammar as shells are told of it: models by their names too.
pub fn completed(names: &[&'static str]) -> Command {
    let has_model = |command: &Command| command.get_arguments().any(|argument| argument.get_id() == "model");
    command().mut_subcommands(|sub| {
        if !has_model(&sub) {
            return sub;
        }
        let names = PossibleValuesParser::new(names.iter().copied());
        sub.mut_arg("model", |model| model.value_parser(names))
    })
}

fn generate() -> Command {
    Command::new("generate")
        .about(
            "Writes the code that `model!` expands to, to check in: its crate needs neither the macro nor the deriver",
        )
        .after_help(GENERATE)
        .arg(model())
        .args(sizes())
        .arg(output("FILE.rs"))
        .arg(value("name", "NAME", "The type's name [default: the file's]"))
        .arg(
            Arg::new("methods")
                .long("methods")
                .value_name("METHODS")
                .value_parser(["taylor"])
                .help("What Taylor's method needs too"),
        )
        .arg(
            flag("no-std", "Equations alone, which allocate nothing, for the crate dalembert-mechanism without std")
                .conflicts_with("methods"),
        )
        .arg(
            flag(
                "check",
                "Write nothing: fail where the file is not the model's code, and tell the first line that differs",
            )
            .requires("output"),
        )
        .arg(quiet())
}

/// How a crate takes generated code.
const GENERATE: &str = "\
In the crate that has the file as src/swing.rs:

  #[rustfmt::skip]
  mod swing;

and in its Cargo.toml `dalembert = { version = \"…\", default-features = false }`. Where the code was generated for another
version of dalembert than that, the compiler says so.

On a microcontroller, with --no-std:

  dalembert = { package = \"dalembert-mechanism\", version = \"…\", default-features = false, features = [\"libm\"] }";

fn import() -> Command {
    Command::new("import")
        .about("Writes a model file from a robot's URDF: a coordinate a joint, frames, bodies, dampers, momentum balances and simple solids")
        .after_help(IMPORT)
        .arg(Arg::new("robot").value_name("FILE.urdf").required(true).help("The robot; macros (xacro) expanded").value_hint(ValueHint::FilePath))
        .arg(value("output", "FILE.yaml", "Where the model goes; - for standard output [default: the robot's file name, here, unless it is there]").short('o').value_hint(ValueHint::FilePath))
        .arg(quiet())
        .arg(flag("floating", "Let a robot that nothing holds move: its root gets a floating joint to the ground"))
}

/// What becomes of what.
const IMPORT: &str = "\
revolute, continuous  an angle; the frame turns about the axis
prismatic             a length along the axis
planar                two lengths across the axis, and an angle about it
floating              three lengths and a `rotation`
fixed                 a frame or none; a link with mass is a body
origin rpy            fixed turns: about the fixed x, y, z, so `[[z, yaw], [y, pitch], [x, roll]]`
inertial              a body, its tensor turned to the link's axes; refused where no body has it
dynamics damping      a damper; friction, limits, safety and transmissions are comments, or left out
mimic                 a definition in the place of a coordinate; its gear has a reaction in `balances`
visual                box, cylinder, sphere are drawn; meshes are named, and drawn as lines
gravity               9.81 N/kg along -z: URDF states none

The balances are those of all that a joint moves, about or along its axis: a second derivation that `check` compares.";

fn simulate() -> Command {
    Command::new("simulate")
        .about("Runs a scene; prints the final state, outputs and how far to trust them")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args(scene())
        .arg(value("method", "METHOD", "auto [default], dop853, rkn8, dopri5, rk4, midpoint, euler; verlet (or rattle), srkn4, suzuki4, kahanli8, gauss2, gauss4, gauss6; radau5, rodas5p; taylor; exact; moreau (steps over contacts)"))
        .arg(value("step", "TIME", "A fixed step"))
        .arg(max_steps())
        .arg(ignored())
        .arg(flag("symmetries", "Tell which exchanges and reflections of coordinates the start has that leave the equations as they are, and watch that the motion keeps them"))
        .arg(value("slopes", "A,B", "Tell how the end changes with these: parameters, and coordinates or rates (theta') at the start"))
        .arg(flag("together", "Integrate decoupled subsystems with one common step size"))
        .arg(value("constraints", "WAY", "multipliers, nullspace or springs [default: multipliers]"))
        .arg(value("stiffness", "K", "Of springs in the place of constraints, SI [default: 1e6]"))
        .arg(value("damping", "D", "Of dampers beside them, SI [default: 0]"))
        .arg(value("drift", "WAY", "What keeps constraints: project, none or baumgarte [default: project]"))
        .arg(value("alpha", "RATE", "Baumgarte's gain, 1/s [default: by the step]"))
        .arg(value("by", "SYSTEM", "Accelerations from a system of `balances` of the file; `all` compares them"))
        .arg(value("state", "FILE", "A state to start from, as --save writes it, or - for standard input; --start goes before"))
        .arg(value("save", "FILE", "Write the final state, to start from it (.yaml, .yml, .txt)"))
        .arg(value("every", "TIME", "Spacing of reported states [default: 500 points]"))
        .arg(value("csv", "FILE", "Write reported states and outputs as a table; - for standard output, where the report goes to standard error").short('o'))
        .arg(picture("plot", "Draw them"))
        .arg(many("show", "A,B", "A chart of the plot, and beside the animation: coordinates, rates or outputs against time, a chart a unit, or X:Y, a portrait (X:Y,Z:W: several paths in one); several make several charts [default: paths and coordinates in the plot]").requires("drawn"))
        .arg(value("section", "PERIOD", "Portraits of states at multiples of this time only: a stroboscopic section").requires("show"))
        .arg(value("with", "SCENE,SCENE", "Draw other scenes beside this one").requires("plot"))
        .arg(animation("Write a page that animates the mechanism"))
        .arg(any("arrows", "A,B", "Draw forces in the animation as arrows, at the points where they act and to one scale: constraints, joints, contacts, reactions of `balances`, loads [default without names: all]"))
        .arg(any("mark-events", "A,B", "Write the names of events into the animation as they happen [default without names: all]"))
        .group(ArgGroup::new("drawn").args(["plot", "animate"]).multiple(true))
        .arg(
            flag("digits", "Tell how many digits hold, by a second run, however long it takes")
                .conflicts_with("no-digits"),
        )
        .arg(flag("no-digits", "Leave the second run out, and print all digits"))
        .arg(flag("json", "Print one JSON object"))
}

/// The option `--motion` of what begins with a motion of the file; `modes` has another of that name.
pub const MOTION: &str = "motion of the file";

fn solve() -> Command {
    Command::new("solve")
        .about("Finds starts, parameters and end times for which outputs have given values, are largest or smallest, or follow a record")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args(scene())
        .arg(value("motion", "NAME", "A motion of the file: its start, unknowns and what it wants, to which the other options add or in whose place they come").id(MOTION).conflicts_with("scene"))
        .arg(many("unknown", "NAME=GUESS", "What is unknown: parameters, coordinates and rates (theta') at the start, or `until`, where the run ends; several, also A=1,B=2"))
        .arg(many("such-that", "NAME=VALUE", "What a coordinate, a rate or an output is to be at the end; several, also A=1,B=2"))
        .arg(value("maximise", "NAME", "What is to be as large as it can be near by at the end").conflicts_with_all(["minimise", "fit"]))
        .arg(value("minimise", "NAME", "What is to be as small").conflicts_with("fit"))
        .arg(value("fit", "FILE.csv", "A record that the motion is to follow, by least squares: a table with a header").conflicts_with("such-that"))
        .arg(value("columns", "t=A,x=B", "Which columns of the record are time and what they are a record of [default: by the same names]").requires("fit"))
        .arg(ignored())
        .arg(value("method", "METHOD", "As of `simulate` [default: auto]"))
        .arg(max_steps())
        .arg(value("state", "FILE", "A state to start from, as --save writes it, or - for standard input; --start goes before"))
        .arg(picture("plot", "Draw what was wanted over time, with the points of a record and what is left of them"))
        .arg(value("save", "FILE", "Write the start that was found (.yaml, .yml, .txt): `simulate --state FILE` starts from it"))
        .arg(flag("json", "Print one JSON object"))
}

fn max_steps() -> Arg {
    value("max-steps", "COUNT", "No more steps than these [default: 10000000]").value_parser(clap::value_parser!(u64))
}

fn orbit() -> Command {
    Command::new("orbit")
        .about("Finds a motion that repeats, up to exchanges, mirrors, shifts and turns; prints its period and its multipliers")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args(scene())
        .arg(value("motion", "NAME", "A motion of the file that closes, to which the other options add").id(MOTION).conflicts_with("scene"))
        .arg(value("period", "TIME", "A guess of the period; of a mechanism that depends on time, the period [default: what time enters with, or where the run comes near to itself]"))
        .arg(value("part", "K", "The motion closes after 1/K of the period, exchanged and mirrored as the other options say").value_parser(clap::value_parser!(u64).range(1..=1000)).conflicts_with("at"))
        .arg(value("at", "EVENT", "The motion closes when this event has happened, in the state after it").conflicts_with("period"))
        .arg(value("count", "K", "When it has happened so many times [default: 1]").value_parser(clap::value_parser!(u64).range(1..=1000)).requires("at"))
        .arg(many("exchange", "A=B", "Coordinates or phases that change places: at the end B is where A was; several, also A=B,C=D"))
        .arg(many("mirror", "A,B", "Coordinates with the opposite sign at the end"))
        .arg(many("shift", "A,B", "Coordinates that may be any amount more at the end; nothing may depend on them"))
        .arg(many("turn", "A=TURNS", "Angles that are so many turns more at the end"))
        .arg(value("from", "mode K", "Begin at rest, displaced from the equilibrium along its mode K"))
        .arg(value("amplitude", "VALUE", "By so much in the coordinate that moves most [default: 1e-3]").requires("from"))
        .arg(value("energy", "VALUE", "The energy of the motion, J; from a mode, counted from the equilibrium"))
        .arg(value("vary", "NAME=A..B", "Follow the family as a parameter or the energy (energy=..B) varies; NAME=A,B,C meets these values on the way").conflicts_with_all(["energy", "save"]))
        .arg(value("branch", "K", "Follow the family that leaves at the K-th threshold of this one").value_parser(clap::value_parser!(u64).range(1..=1000)).requires("vary"))
        .arg(flag("here", "Begin at rest where the scene starts: rest under a drive"))
        .arg(value("map", "A=FROM..TO:COUNT,B=FROM..TO:COUNT", "Stability over two parameters with its boundaries; --plot draws the first across").conflicts_with_all(["vary", "energy", "save"]))
        .arg(flag("double-double", "Go on in double-double: period, start and energy to some 25 digits; no constraints, discontinuities, events or forces of time").conflicts_with_all(["vary", "map"]))
        .arg(value("segments", "COUNT", "Pieces into which the map is cut [default: 8 a period, more where changes grow fast]").value_parser(clap::value_parser!(u64).range(1..=512)))
        .arg(value("method", "METHOD", "As of `simulate` [default: auto]"))
        .arg(max_steps())
        .arg(value("state", "FILE", "A state to start from, as --save writes it, or - for standard input; --start goes before"))
        .arg(value("save", "FILE", "Write the start that was found (.yaml, .yml, .txt): `simulate --state FILE` starts from it"))
        .arg(picture("plot", "Draw the motion with its multipliers, with --vary amplitudes and periods of the family, with --map where it is unstable"))
        .arg(flag("json", "Print one JSON object"))
}

fn sweep() -> Command {
    Command::new("sweep")
        .about("Runs a scene many times, in threads, while parameters or starts vary; writes a table of ends, extremes and events")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args(scene())
        .arg(many("vary", "NAME=A..B:COUNT", "What varies: a parameter, or a coordinate or speed at the start; evenly, evenly in the logarithm (A..B:COUNT:log), or by a list (A,B,C); several make a grid"))
        .arg(value("seeds", "A..B", "Seeds of noise, whole numbers, or a list (A,B,C): all noise of a run has the same; with --vary every combination is run"))
        .arg(value("points", "FILE.csv", "The values of all runs, a column for each of what varies, or - for standard input").conflicts_with_all(["vary", "seeds"]))
        .arg(value("method", "METHOD", "As of `simulate` [default: auto]"))
        .arg(value("step", "TIME", "A fixed step"))
        .arg(max_steps())
        .arg(value("every", "TIME", "Spacing of the states among which extremes are looked for [default: 500 points]"))
        .arg(value("modes", "COUNT", "Frequencies in Hz and damping ratios of so many modes about the equilibrium of each run's parameters, the slowest first; what does not oscillate comes last and has no frequency"))
        .arg(value("show", "A,B", "What is printed and drawn: a coordinate, rate or output at the end, or `min A`, `max A`, `events E`, `t`, `energy drift`, `warnings`, `frequency 1`, `damping 1` [default: coordinates, outputs and frequencies]"))
        .arg(value("csv", "FILE.csv", "Where the table goes, row by row, with FILE.csv.json beside it, which says what it is a table of; - for standard output, where the report goes to standard error [default: NAME-sweep.csv]").short('o'))
        .arg(value("npz", "FILE.npz", "Write the whole table as NumPy's arrays too, one for each column by its name").value_hint(ValueHint::FilePath))
        .arg(flag("no-digits", "Do not run printed rows again to tell how many digits hold; print six"))
        .arg(flag("json", "Print one JSON object, with all rows"))
        .arg(flag("resume", "Continue a sweep that was interrupted or killed: only runs that the table does not have; begins where there is none"))
        .arg(picture("plot", "Draw what is shown over the first of what varies"))
        .arg(value("log", "x,y", "Logarithmic axes of the plot: x, y or x,y [default: x where the first of what varies does so evenly in the logarithm]").requires("plot"))
        .arg(value("threads", "COUNT", "How many runs at a time [default: one a processor]"))
        .arg(value("shard", "I/N", "Only part I of N of all runs, for one of N machines"))
        .arg(
            many("merge", "FILE.csv", "Put the tables of all parts together instead of running")
                .num_args(1..)
                .allow_hyphen_values(false)
                .conflicts_with_all(["vary", "seeds", "points", "shard", "modes", "resume"]),
        )
}

fn modes() -> Command {
    let [scene, set, params, ..] = scene();
    Command::new("modes")
        .about("Finds an equilibrium; prints M, C, K and the modes of small motions about it")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args([scene, set, params])
        .arg(many("input", "NAME=VALUE", "Hold an input at a value [default: all at 0]"))
        .arg(many("at", "NAME=VALUE", "Where the search starts [default: the file's `equilibrium`]"))
        .arg(many("hold", "NAME[=VALUE]", "Trim: coordinates (and states) that rest where they are said to be, or where the search would start; several, also A,B=5deg").requires("solve"))
        .arg(many("solve", "NAME[=GUESS]", "Trim: inputs, parameters or held values that are found so that it rests with what --hold names; the rest of the coordinates follow, and everything else is about that rest; several, also A,B").requires("hold").conflicts_with_all(["here", "sampled"]))
        .arg(value("phase", "NAME", "Which constraints and forces act [default: those of the scene's start]"))
        .arg(flag("sampled", "Close the loops that ticks close: the rest at which all that they set stays as it is, the map over a period, its eigenvalues z with ln z/T, and the period from which on the loop is unstable; inputs that do not change keep their values"))
        .arg(flag("steady", "Find the steady motion in which cyclic coordinates keep the speeds of the scene (`--at` sets others), with constraints too"))
        .arg(picture("plot", "Draw the shapes of the modes"))
        .arg(value("matrices", "NAME.mtx", "Write M, C, K, B and the state matrix A as NAME-M.mtx and so on, in Matrix Market's format, or as tables (NAME.csv)"))
        .arg(value("state-space", "FILE", "Write x' = A x + B u, y = C x + D u with names and units as FILE.json, NumPy's arrays (.npz), variables or a script for MATLAB and Octave (.mat, .m) or a table (.csv), and say which motions inputs do not reach and outputs do not show"))
        .arg(value("in", "A,B", "Its inputs: inputs, entries of `forces` or `torques`, coordinates that a force acts on [default: all inputs]").requires("state-space"))
        .arg(value("out", "A,B", "Its outputs: coordinates, rates, states, outputs [default: all coordinates]").requires("state-space"))
        .arg(animation("Write a page that animates a mode"))
        .arg(value("mode", "NUMBER", "Which mode to animate [default: the first that is not rigid]"))
        .arg(picture("motion", "Draw the free motion from the scene's start, computed in several ways, and compare them"))
        .arg(many("drive", "NAME[=AMPLITUDE][<PHASE]", "Excitation: an input, an entry of `forces` or `torques` (along its direction), or a coordinate that a force acts on; several, also A,B, act together, each as AMPLITUDE cos(w t + PHASE): \"ux=1, uy=1<-90\" turns counterclockwise; a phase is in degrees, or with its unit (<0.5 rad), and a negative one comes later [default: the first input]"))
        .arg(value("omega", "FREQUENCY", "Print the steady state at this frequency, rad/s (or 5 Hz, 300 rpm): by modes, and what drives what"))
        .arg(picture("bode", "Draw the frequency response: amplitude, per unit of what drives, and phase"))
        .arg(value("response", "A,B", "Response quantities: coordinates, rates, outputs [default: all coordinates]"))
        .arg(flag("hertz", "Draw over frequencies in Hz").requires("bode"))
        .arg(value("range", "A..B", "Frequencies of the response, rad/s (or 1 Hz..5 Hz) [default: about those of the modes]"))
        .arg(many("vary", "NAME=A..B", "Follow the equilibrium or steady motion and its eigenvalues while a parameter, or a speed (phi'), changes; find folds, poles and where stability changes; windows of instability of any width are found where what varies is smooth over 1/64 of the range, otherwise take a narrower one"))
        .arg(picture("locus", "Draw the eigenvalues of --vary in the complex plane"))
        .arg(picture("campbell", "Draw the frequencies over what --vary changes (Campbell diagram), with a line for each order of a speed of rotation, and list critical speeds, where these meet").requires("vary"))
        .arg(value("orders", "1,2", "Multiples of the speed of rotation that excite [default: 1 and 2 where --vary changes one in rad/s]").requires("campbell"))
        .arg(flag("here", "Take that point as it is, and refuse it if it is no equilibrium"))
        .arg(value("at-time", "TIME", "Small departures from the scene's motion instead, as they are at this time, s (or 20 ms): A and B of x' = A x + B u, and --state-space"))
        .arg(flag("json", "Print one JSON object"))
}

fn chart() -> Command {
    Command::new("chart")
        .about("Charts speed against accuracy: what every method that suits, and every way of treating constraints, costs for its error; and, of a scene with `needs`, every model that leaves something out; with --steps errors against step sizes; with --returns how far methods miss the start of a motion that repeats")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args(scene().into_iter().filter(|arg| arg.get_id() != "tolerance"))
        .arg(flag("steps", "Chart errors against step sizes instead, halved down to rounding, with the order that each method shows; methods with error control only where --methods names them").conflicts_with_all(["twin", "needs", "within"]))
        .arg(value("returns", "COUNT", "Chart instead how far methods miss the start of a motion that repeats, each time that it should be back, for so many periods; the motion is the one that `orbit` finds from here").value_parser(clap::value_parser!(u64)).conflicts_with_all(["steps", "twin", "needs", "within", "until"]))
        .arg(value("motion", "NAME", "With --returns: a motion of the file that closes").id(MOTION).requires("returns").conflicts_with("scene"))
        .arg(value("state", "FILE", "A state to start from, as --save writes it, or - for standard input; --start goes before"))
        .arg(value("methods", "A,B", "Only these methods [default: all that suit]"))
        .arg(value("compare", "NAME,NAME", "What errors are taken of: coordinates, rates, outputs [default: the coordinates]"))
        .arg(value("twin", "NAME", "Another file of the same mechanism, in minimal coordinates say, at its scene of the same name or its first; compared by outputs of the same names"))
        .args(wanted("the scene's `needs`; without either, what can be left out is not asked", "the scene's `needs`, or 1e-3"))
        .arg(picture("plot", "Where the charts go [default: NAME-chart.svg, NAME-steps.svg]"))
        .arg(value("csv", "FILE.csv", "Where all points go; - for standard output, where the report goes to standard error [default: NAME-chart.csv, NAME-steps.csv]").short('o'))
        .arg(value("max-steps", "COUNT", "With --steps: no run takes more of them [default: 1000000]").value_parser(clap::value_parser!(u64)).requires("steps"))
        .arg(flag("json", "With --steps: print one JSON object").requires("steps"))
}

fn needs() -> Command {
    let [scene, set, params, start, _, until, _] = scene();
    Command::new("needs")
        .about("Tells what a scene can do without: tries every force, body, mass, input and coordinate, prints what each changes and saves, and writes the smaller model")
        .arg(model())
        .args(sizes())
        .arg(quiet())
        .args([scene, set, params, start, until])
        .args(wanted("the scene's `needs`, or all coordinates and outputs", "the scene's `needs`, or 1e-3"))
        .arg(max_steps())
        .arg(flag("all", "Leave out too what saves less than a twentieth of the work"))
        .arg(value("write", "FILE.yaml", "Write the smaller model: the file's text without what goes, and what was found in comments; beside it, as FILE_test.rs, a test that compares both").short('o'))
        .arg(picture("plot", "Draw what each omission changes against the work that is left"))
        .arg(flag("json", "Print one JSON object"))
}

/// What a scene is run for.
fn wanted(outputs: &str, within: &str) -> [Arg; 2] {
    let outputs = format!("What is wanted: coordinates, rates, outputs [default: {outputs}]");
    let within = format!("How exactly, in parts of the range of each [default: {within}]");
    [value("needs", "A,B", "").help(outputs), value("within", "PART", "").help(within)]
}

/// What a run does not look at.
fn ignored() -> Arg {
    many("ignore", "EVENT", "An event that does nothing and is not recorded; several, also A,B")
}

/// Where what a command prints goes.
fn output(placeholder: &'static str) -> Arg {
    value("output", placeholder, "Where it goes; - for standard output [default]")
        .short('o')
        .value_hint(ValueHint::FilePath)
}

fn quiet() -> Arg {
    flag("quiet", "Print no report: only errors, warnings, and data as JSON or on standard output").short('q')
}

/// A model's name or path.
fn model() -> Arg {
    Arg::new("model")
        .value_name("NAME")
        .required(true)
        .help("A model's name, or the path of any model file; - for standard input")
}

fn sizes() -> [Arg; 1] {
    [many("size", "NAME=INTEGER", "Another size than the file's (the model is then interpreted)")]
}

/// What chooses and changes a scene.
fn scene() -> [Arg; 7] {
    [
        value("scene", "NAME", "Another scene than the first"),
        many("set", "PARAMETER=VALUE", "Another value of a parameter"),
        value(
            "params",
            "FILE",
            "Values of parameters, a line each: `m: 2 kg`, or - for standard input; --set goes before",
        ),
        many("start", "NAME=VALUE", "Another start of a coordinate, or of a speed (theta'=1)"),
        many("input", "NAME=EXPR", "Another function of time for an input"),
        value(
            "until",
            "TIME",
            "The time at which to end, after --state too, where else the scene lasts as long as it says",
        ),
        value("tolerance", "NUMBER", "Relative tolerance, and absolute in units of each coordinate's scale"),
    ]
}

fn value(name: &'static str, placeholder: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).value_name(placeholder).help(help).allow_hyphen_values(true)
}

/// A file that is drawn.
fn picture(name: &'static str, help: &str) -> Arg {
    value(name, "FILE.svg", "").help(format!("{help}; as PNG or PDF where FILE ends in .png or .pdf"))
}

/// What moves.
fn animation(help: &str) -> Arg {
    value("animate", "FILE.html", "").help(format!(
        "{help}; a picture that moves where FILE ends in .png or .gif, its first frame where it ends in .svg"
    ))
}

fn many(name: &'static str, placeholder: &'static str, help: &'static str) -> Arg {
    value(name, placeholder, help).action(ArgAction::Append)
}

/// Names of what is drawn in an animation, or all.
fn any(name: &'static str, placeholder: &'static str, help: &'static str) -> Arg {
    let names = many(name, placeholder, help).num_args(0..=1).default_missing_value("");
    // What begins with a hyphen is the next option.
    names.allow_hyphen_values(false).requires("animate")
}

fn flag(name: &'static str, help: &'static str) -> Arg {
    Arg::new(name).long(name).help(help).action(ArgAction::SetTrue)
}
