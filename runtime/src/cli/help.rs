//! What `--help` of a command says beside its options: what kind each is of, and examples.

use clap::{Arg, Command};

/// Options by what they are about; those of none stand first, with what the command asks.
const HEADINGS: [(&str, &[&str]); 3] = [
    ("Model and start", &["size", "scene", "set", "params", "start", "input", "state", "until"]),
    (
        "Computation",
        &[
            "method",
            "step",
            "max-steps",
            "tolerance",
            "together",
            "constraints",
            "stiffness",
            "damping",
            "drift",
            "alpha",
            "by",
            "ignore",
            "digits",
            "no-digits",
            "threads",
            "shard",
            "segments",
        ],
    ),
    (
        "Output",
        &[
            "quiet",
            "json",
            "output",
            "every",
            "csv",
            "npz",
            "save",
            "write",
            "plot",
            "animate",
            "arrows",
            "mark-events",
            "mode",
            "show",
            "section",
            "with",
            "log",
            "matrices",
            "state-space",
            "in",
            "out",
            "bode",
            "hertz",
            "locus",
            "campbell",
            "orders",
        ],
    ),
];

/// Lines that can be typed as they are, in this order; a test does.
const EXAMPLES: [(&str, &[&str]); 17] = [
    ("list", &["list", "list --json", "list | grep pendulum"]),
    ("show", &["show double_pendulum", "show double_pendulum --latex", "show cart_pendulum --linear"]),
    (
        "export",
        &[
            "export double_pendulum --c code",
            "export double_pendulum --fmu double_pendulum.fmu",
            "export motor --fmu motor.fmu --fmi 2",
        ],
    ),
    ("check", &["check double_pendulum", "check double_pendulum motor --json", "check simple_pendulum --symmetries"]),
    (
        "generate",
        &[
            "generate double_pendulum -o double_pendulum.rs",
            "generate double_pendulum -o double_pendulum.rs --check",
            "generate double_pendulum --no-std -o equations.rs",
        ],
    ),
    (
        "simulate",
        &[
            "simulate double_pendulum --until 5 --plot swing.svg",
            "simulate double_pendulum --start theta1=90deg --animate swing.html --arrows hinge_force",
            "simulate double_pendulum --set m=2kg --every 0.01 --csv swing.csv",
        ],
    ),
    (
        "modes",
        &[
            "modes double_pendulum --plot modes.svg",
            "modes base_excitation --bode response.svg",
            "modes cart_pendulum --vary l=0.5..2 --locus locus.svg",
        ],
    ),
    (
        "solve",
        &[
            "solve cannon_ball --motion aimed",
            "solve cannon_ball --unknown \"y'=40\" --such-that x=60",
            "solve cannon_ball --unknown \"y'=20\" --such-that x=60 --plot shot.svg --save shot.yaml",
        ],
    ),
    (
        "orbit",
        &[
            "orbit simple_pendulum --part 2 --mirror theta",
            "orbit double_pendulum --from \"mode 1\" --energy 1",
            "orbit simple_pendulum --from \"mode 1\" --vary energy=..4 --plot family.svg",
        ],
    ),
    (
        "sweep",
        &[
            "sweep simple_pendulum --vary l=0.5..2:4",
            "sweep cannon_ball --vary b=0,0.5,1 --show x,t --plot range.svg",
            "sweep cannon_ball --vary \"y'=20..60:9\" --vary b=0,1 --csv shots.csv",
        ],
    ),
    (
        "chart",
        &[
            "chart simple_pendulum --steps --methods rk4,verlet",
            "chart simple_pendulum --methods dop853,taylor --plot chart.png --csv chart.csv",
            "chart simple_pendulum --returns 100 --methods verlet,dop853",
        ],
    ),
    (
        "needs",
        &[
            "needs simple_pendulum",
            "needs cannon_ball --needs x --within 1e-2",
            "needs cannon_ball --needs x --within 0.3 --write smaller.yaml",
        ],
    ),
    ("stability", &["stability rk4", "stability dop853 --json", "stability radau5 --longest 20 --plot radau5.svg"]),
    ("new", &["new swing", "simulate swing.yaml --animate swing.html", "new swing --crate"]),
    ("import", &["import robot.urdf", "import robot.urdf -o arm.yaml", "import robot.urdf --floating -o free.yaml"]),
    ("schema", &["schema > dalembert.schema.json", "schema -o dalembert.schema.json", "schema | head -n 1"]),
    (
        "completions",
        &["completions bash > dalembert.bash", "completions zsh > _dalembert", "completions fish > dalembert.fish"],
    ),
];

/// The command with both.
pub fn told(command: Command) -> Command {
    let examples = EXAMPLES.iter().find(|(name, _)| *name == command.get_name()).map_or(&[][..], |(_, lines)| lines);
    let lines = examples.iter().map(|line| format!("\n  dalembert {line}")).collect::<String>();
    let own = command.get_after_help().map_or_else(String::new, |own| format!("{own}\n\n"));
    command.mut_args(under_heading).after_help(format!("{own}Examples:{lines}"))
}

fn under_heading(argument: Arg) -> Arg {
    let id = argument.get_id().as_str();
    let heading = HEADINGS.iter().find(|(_, ids)| ids.contains(&id)).map(|(heading, _)| *heading);
    match heading {
        Some(heading) if !argument.is_positional() => argument.help_heading(heading),
        _ => argument,
    }
}
