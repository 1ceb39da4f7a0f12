//! Writes models whose names are hostile, for `tests/names.rs` to compile: names that Rust has given away, and every
//! identifier of the generator's own, taken from what it prints, at every section of the language.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

use dalembert_symbolic::language::is_reserved;
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::{KEYWORDS, METHODS, field_name, method_name};
use dalembert_symbolic::print::rust;

/// Names that are hard for Rust, for the generator's variables, or for the eye.
const HOSTILE: &[&str] = &[
    "Self",
    "S",
    "r",
    "Default",
    "Clone",
    "Option",
    "Some",
    "None",
    "Ok",
    "Err",
    "Vec",
    "Box",
    "Fn",
    "String",
    "f64",
    "usize",
    "str",
    "bool",
    "std",
    "core",
    "dalembert",
    "_",
    "__",
    "_x",
    "x_",
    "a__b",
    "In",
    "M",
    "m",
    "mu",
    "θ",
    "theta",
    "sin_theta",
    "cos_theta",
    "theta_dot",
    "theta_ddot",
    "theta_dot_dot",
    "sin_theta_dot",
    "w",
    "w1",
    "w2",
    "w3",
    "w10",
    "sin_w1",
    "sin_sin_theta",
    "π2",
    "µ0",
    "μ1",
    "длина",
    "弹簧",
    "é",
    "ß",
    "ſ",
    "Å",
    "İ",
    "а",
    "o\u{308}",
    "x1",
    "x_1",
    "nan",
    "inf",
    "drop",
    "main",
    "test",
    "macro_rules",
    "union",
    "auto",
    "raw",
    "safe",
    "to_string",
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let names = names();
    let mut out = String::new();
    let mut entries = String::new();
    for (name, text) in models(&names) {
        writeln!(
            out,
            "mod {name} {{\n    dalembert::model!(yaml = {text:?}, name = Hostile, warnings = \"allow\");\n}}"
        )?;
        writeln!(entries, "    ({name:?}, {text:?}, || Box::new(Dynamic::new({name}::Hostile::default()))),")?;
    }
    writeln!(
        out,
        "\n/// Name, text, and the compiled system of every model.\nstatic HOSTILE: &[Entry] = &[\n{entries}];"
    )?;
    std::fs::write(Path::new(&std::env::var("OUT_DIR")?).join("hostile.rs"), out)?;
    Ok(())
}

/// All names to try, without those that the language reserves.
fn names() -> Vec<String> {
    let listed = HOSTILE.iter().chain(KEYWORDS).chain(METHODS).map(|name| (*name).to_owned());
    let names: BTreeSet<String> = listed.chain(own()).collect();
    names.into_iter().filter(|name| !is_reserved(name)).collect()
}

/// Every identifier in what is printed for models that need all of the generator, but not in documentation or literals; of numbered ones those
/// of one digit.
fn own() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for text in [include_str!("../fuzz/corpus/derive/whole.yaml"), SPARE] {
        let Ok(program) = compile(text, &[]) else { panic!("a model that is right is refused") };
        let code = rust(&program.with_series(true), "", "Whole");
        let code = code.lines().filter(|line| !line.trim_start().starts_with("//"));
        let code: String = code.flat_map(|line| line.split('"').step_by(2).chain(["\n"])).collect();
        let words = code.split(|c: char| !(c.is_ascii_alphanumeric() || c == '_'));
        let numbered = |w: &str| w.len() > 2 && w[1..].bytes().all(|byte| byte.is_ascii_digit());
        let named = |w: &&str| w.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && !numbered(w);
        found.extend(words.filter(named).map(str::to_owned));
    }
    assert!(found.contains("pivot_floor") && found.contains("matrix") && found.contains("lane"), "{found:?}");
    found
}

/// Balances, scenes that set something, and a guess for an equilibrium, which the other model lacks.
const SPARE: &str = "
name: Spare
parameters: {m: 1 kg, k: 2 N/m, l: 1 m}
coordinates: {x: m}
bodies: {a: {mass: m, position: '[x, 0]'}}
springs: {s: {between: [ground, a], stiffness: k, rest: l}}
balances: {newton: {equations: [force: {of: [a], along: [1, 0]}]}}
conserved: {energy: energy}
scenes: {far: {set: {k: 3}, start: {x: 2*l}}}
equilibrium: {x: l}
memory: {u: 1 N}
events: {tick: {every: 1 s, then: {set: {u: u/2}}}}
";

/// One model for each section, with all names in it.
fn models(names: &[String]) -> Vec<(&'static str, String)> {
    let distinct = |rust: fn(&str) -> String, own: &str| -> Vec<&String> {
        let mut seen = BTreeSet::from([own.to_owned()]);
        names.iter().filter(|name| seen.insert(rust(name))).collect()
    };
    let free = distinct(field_name, "zz");
    let derived = distinct(method_name, "zz");
    let list = |names: &[&String], entry: &dyn Fn(usize, &str) -> String| -> String {
        let entries = names.iter().enumerate().map(|(k, name)| format!("  \"{name}\": {}\n", entry(k + 1, name)));
        entries.collect()
    };
    let all: Vec<&String> = names.iter().collect();
    let sum = |names: &[&String], term: &dyn Fn(usize, &str) -> String| -> String {
        names.iter().enumerate().map(|(k, name)| term(k + 1, name)).collect::<Vec<_>>().join(" + ")
    };
    // A particle on a line, to hang names on; `zz…` are names of no other list.
    let line = |extra: &str| {
        format!(
            "name: Hostile\nparameters: {{zz: 1.5}}\ncoordinates: {{xzz: , yzz: }}\n\
             bodies: {{bzz: {{mass: zz, position: \"[xzz, yzz]\"}}, czz: {{mass: 2*zz, inertia: zz, angle: xzz, position: \"[yzz, xzz]\"}}}}\n{extra}"
        )
    };
    let coordinates = format!(
        "name: Hostile\nparameters: {{zz: 1.5}}\ncoordinates:\n{}kinetic_energy: {}\npotential_energy: {}\nscene:\n  start:\n{}outputs:\n  ozz: {}\n",
        list(&all, &|_, _| "~".to_owned()),
        sum(&all, &|k, x| format!("{x}'^2*({k} + sin({x})/2)")),
        sum(&all, &|k, x| format!("zz*cos({x} - {k})*sin({})", all[k % all.len()])),
        list(&all, &|k, _| format!("{k}/100")).replace("  \"", "    \""),
        sum(&all, &|k, x| format!("{k}*{x}'' + {x}'*sin({x}')")),
    );
    let parameters = format!(
        "name: Hostile\nparameters:\n{}coordinates: {{xzz: }}\nkinetic_energy: xzz'^2*(1 + {})\npotential_energy: {}\nscenes: {{szz: {{set: {{{}: 3}}}}}}\n",
        list(&free, &|k, _| format!("1 + {k}/100")),
        sum(&free, &|_, p| format!("{p}^2")),
        sum(&free, &|k, p| format!("{p}*cos(xzz - {k})")),
        free[0],
    );
    let derived_parameters = format!(
        "name: Hostile\nparameters:\n  zz: 1.5\n{}coordinates: {{xzz: }}\nkinetic_energy: xzz'^2*(1 + {})\npotential_energy: {}\n",
        list(&derived, &|k, _| format!("zz*{k}")),
        sum(&derived, &|_, p| format!("{p}^2")),
        sum(&derived, &|k, p| format!("{p}*cos(xzz - {k})")),
    );
    let inputs = line(&format!(
        "inputs:\n{}generalized_forces: {{xzz: {}}}\n",
        list(&all, &|k, _| format!("sin({k}*t/10)")),
        sum(&all, &|_, u| format!("{u} + {u}'*xzz")),
    ));
    // All of them are set by one event, at the ticks of a period of parameters.
    let memory = line(&format!(
        "memory:\n{}generalized_forces: {{xzz: {}}}\nevents:\n  ezz:\n    every: zz/4\n    then:\n      set:\n{}",
        list(&all, &|k, _| format!("zz + {k}/10")),
        sum(&all, &|k, m| format!("{m}*cos(xzz - {k})")),
        list(&all, &|k, m| format!("{m}*xzz' + {}", all[k % all.len()])).replace("  \"", "        \""),
    ));
    let definitions = line(&format!(
        "define:\n{}potential_energy: {}\n",
        list(&all, &|k, _| format!("cos(xzz - {k})")),
        sum(&all, &|_, d| format!("{d}*yzz")),
    ));
    let points = line(&format!(
        "points:\n{}outputs:\n  ozz: {}\ndraw: [{{line: [{}]}}]\n",
        list(&all, &|k, _| format!("\"[xzz, {k}*yzz]\"")),
        sum(&all, &|_, p| format!("dot({p}, velocity({p}))")),
        all.iter().map(|p| format!("\"{p}\"")).collect::<Vec<_>>().join(", "),
    ));
    let frames = line(&format!(
        "frames:\n{}outputs:\n  ozz: {}\n",
        list(&all, &|k, _| format!("{{angle: xzz*{k}}}")),
        sum(&all, &|_, f| format!("dot({f}.x, velocity(bzz))*angular_velocity({f})")),
    ));
    let bodies = format!(
        "name: Hostile\nparameters: {{zz: 1.5}}\ncoordinates: {{xzz: , yzz: }}\nbodies:\n{}gravity: [0, -10]\noutputs:\n  ozz: {}\n",
        list(&all, &|k, _| format!(
            "{{mass: zz*{k}, inertia: zz, angle: xzz + {k}, position: \"[yzz, sin(xzz*{k})]\"}}"
        )),
        sum(&all, &|_, b| format!("{b}.x.y*velocity({b}).x")),
    );
    let few: Vec<&String> = all.iter().copied().step_by(4).collect();
    let reactions = |few: &[&String]| {
        line(&format!(
            "outputs: {{ozz: {}}}\nbalances:\n  equations:\n    - equation: zz*xzz'' + 2*zz*xzz'' + zz*xzz'' = 0\n    - equation: 3*zz*yzz'' = 0\n{}  reactions:\n{}",
            few[0],
            few.iter().map(|r| format!("    - equation: {r} = zz*xzz''\n")).collect::<String>(),
            list(few, &|_, _| "{on: bzz, along: [1, 0]}".to_owned()).replace("  \"", "    \""),
        ))
    };
    let entry = |k: usize| format!("{{on: bzz, force: \"[{k}*xzz', sin(yzz)]\"}}");
    let labels = line(&format!(
        "springs:\n{}dampers:\n{}forces:\n{}torques:\n{}events:\n{}outputs:\n{}conserved:\n{}checks:\n{}",
        list(&all, &|k, _| format!("{{stretch: xzz, stiffness: {k}}}")),
        list(&all, &|k, _| format!("{{rate: yzz', damping: {k}, on: czz}}")),
        list(&few, &|k, _| entry(k)),
        list(&few, &|k, _| format!("{{on: czz, torque: -{k}*xzz'}}")),
        list(&all, &|k, _| format!("{{when: xzz - {k}, then: record}}")),
        list(&all, &|k, _| format!("xzz*{k}")),
        list(&all, &|k, _| format!("zz*{k}")),
        list(&all, &|_, _| "xzz = xzz".to_owned()),
    ));
    // Systems of these names would be taken for the only one, and `scene` is the name of the default scene.
    let systems: Vec<&String> =
        all.iter().copied().filter(|name| !["equations", "reactions", "scene"].contains(&name.as_str())).collect();
    let balances = line(&format!(
        "springs: {{szz: {{between: [ground, bzz], stiffness: 3}}}}\nbalances:\n{}scenes:\n{}",
        list(&systems, &|_, _| {
            "{equations: [{equation: 4*zz*xzz'' = -3*xzz}, {equation: 3*zz*yzz'' = -3*yzz}]}".to_owned()
        }),
        list(&systems, &|k, _| format!("{{set: {{zz: {k}}}, start: {{xzz: {k}}}}}")),
    ));
    vec![
        ("coordinates", coordinates),
        ("parameters", parameters),
        ("derived", derived_parameters),
        ("inputs", inputs),
        ("memory", memory),
        ("definitions", definitions),
        ("points", points),
        ("frames", frames),
        ("bodies", bodies),
        ("reactions_0", reactions(&few)),
        ("reactions_1", reactions(&all.iter().copied().skip(1).step_by(4).collect::<Vec<_>>())),
        ("reactions_2", reactions(&all.iter().copied().skip(2).step_by(4).collect::<Vec<_>>())),
        ("reactions_3", reactions(&all.iter().copied().skip(3).step_by(4).collect::<Vec<_>>())),
        ("labels", labels),
        ("balances", balances),
    ]
}
