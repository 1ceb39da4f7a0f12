//! Where runs start, as Rust: what scenes set, their starts, and the guess for an equilibrium.

use std::fmt::Write;

use super::body::{Bodies, Use};
use super::function::{argument, of_constants};
use crate::expr::Id;
use crate::lower::Program;
use crate::model::{Scene, Spin};

/// `scene_parameters`, `scene` and `equilibrium_guess`.
pub(super) fn scenes(program: &Program, bodies: &Bodies<'_>) -> String {
    let model = &program.model;
    let parameters = format!(
        "<Self as ::dalembert::mechanism::Mechanism<{}, {}>>::parameters(self)",
        model.coordinates.len(),
        program.constraints.len()
    );
    let scenes: Vec<&Scene> = model.all_scenes().collect();
    let mut out = sets(&scenes, bodies, &parameters);
    let constrained = !model.constraints.is_empty() || scenes.iter().any(|scene| !scene.start_conditions.is_empty());
    out += &starts(&scenes, bodies, &parameters, model.coordinates.len(), constrained);
    out += &guess(model.equilibrium.as_deref(), model.coordinates.len(), bodies, &parameters);
    out += &restitutions(&program.restitutions(), bodies);
    out += &frequencies(program.frequencies.as_deref(), bodies);
    out += &list_of("start_condition_values", &program.start_condition_values(), bodies, &parameters);
    out + &speeds_of_conditions(&program.start_condition_speeds())
}

fn sets(scenes: &[&Scene], bodies: &Bodies<'_>, parameters: &str) -> String {
    let mut arms = String::new();
    for (k, scene) in scenes.iter().enumerate().filter(|(_, scene)| !scene.set.is_empty()) {
        let values: Vec<Id> = scene.set.iter().map(|(_, id)| *id).collect();
        let pairs: Vec<String> = scene.set.iter().enumerate().map(|(s, (i, _))| format!("({i}, x[{s}])")).collect();
        let _ = write!(
            arms,
            "            {k} => {{\n{}                let x = values(&{parameters});\n                ::std::vec![{}]\n            }}\n",
            of_constants(bodies, "values", &values, "                "),
            pairs.join(", ")
        );
    }
    let scene = argument("scene", "usize", !arms.is_empty());
    let body = match arms.as_str() {
        "" => "        ::std::vec::Vec::new()\n".to_owned(),
        _ => format!("        match scene {{\n{arms}            _ => ::std::vec::Vec::new(),\n        }}\n"),
    };
    format!("\n    fn scene_parameters(&self, {scene}) -> ::std::vec::Vec<(usize, f64)> {{\n{body}    }}\n")
}

/// Every scene's numbers in one block: its end, tolerance and spacing, then those of q and v that are not 0.
fn starts(scenes: &[&Scene], bodies: &Bodies<'_>, parameters: &str, n: usize, constrained: bool) -> String {
    let size = 3 + 2 * n;
    let (mut arms, mut spacings) = (String::new(), String::new());
    let mut constants = false;
    // The default scene's arm matches everything else, so it comes last.
    for (k, scene) in scenes.iter().enumerate().skip(1).chain(scenes.iter().enumerate().take(1)) {
        let store = |(place, id): (usize, Id)| Use::Store(format!("out[{place}]"), id);
        let settings = [Some(scene.until), Some(scene.tolerance), scene.every];
        let settings = settings.into_iter().enumerate().filter_map(|(place, id)| Some((place, id?)));
        let state = scene.q.iter().chain(&scene.v).enumerate().filter(|(_, id)| **id != Id::ZERO);
        let uses: Vec<Use> = settings.chain(state.map(|(i, id)| (3 + i, *id))).map(store).collect();
        let body = bodies.body(&uses, "                ");
        constants |= body.reads.constants;
        let arm = if k == 0 { "_".to_owned() } else { k.to_string() };
        let _ = write!(arms, "            {arm} => {{\n{}            }}\n", body.lines);
        let spacing = if scene.every.is_some() { "Some(x[2])" } else { "None" };
        let _ = writeln!(spacings, "                {arm} => ::core::option::Option::{spacing},");
    }
    let c = argument("c", "&[S]", constants);
    format!(
        "
    fn scene_numbers<S: ::dalembert::mechanism::Real>({c}, scene: usize, out: &mut [S]) {{
        match scene {{
{arms}        }}
    }}

    fn scene(&self, scene: usize) -> ::dalembert::mechanism::Scene {{
        let mut x = [0.0; {size}];
        Self::scene_numbers(&{parameters}, scene, &mut x);
        ::dalembert::mechanism::Scene {{
            until: x[0],
            tolerance: x[1],
            every: match scene {{
{spacings}            }},
            q: x[3..{middle}].to_vec(),
            v: x[{middle}..].to_vec(),
{starting}        }}
    }}
",
        middle = 3 + n,
        starting = starting(scenes, constrained),
    )
}

/// What is held at a scene's start, and its phase, where there is something to say.
fn starting(scenes: &[&Scene], constrained: bool) -> String {
    let flags = |list: &[bool]| list.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
    let of = |field: &str, otherwise: &str, value: &dyn Fn(&Scene) -> String| {
        let arms = scenes.iter().enumerate().skip(1).map(|(k, scene)| (k.to_string(), scene));
        let arms = arms.chain(scenes.first().map(|scene| ("_".to_owned(), scene)));
        let arms: Vec<String> = arms.map(|(k, scene)| format!("                {k} => {},\n", value(scene))).collect();
        match scenes.iter().all(|scene| value(scene) == otherwise) {
            true => format!("            {field}: {otherwise},\n"),
            false => format!("            {field}: match scene {{\n{}            }},\n", arms.concat()),
        }
    };
    // Without constraints nothing is searched for, so that nothing has to be held.
    let held = |list: &[bool]| match constrained {
        false => "::std::vec::Vec::new()".to_owned(),
        true => format!("::std::vec![{}]", flags(list)),
    };
    of("held_q", "::std::vec::Vec::new()", &|scene| held(&scene.held_q))
        + &of("held_v", "::std::vec::Vec::new()", &|scene| held(&scene.held_v))
        + &of("spins", "::std::vec::Vec::new()", &|scene| spins(&scene.spins))
        + &of("guessed", "false", &|scene| scene.guessed.to_string())
        + &of("phase", "0", &|scene| scene.phase.to_string())
        + &of("start_conditions", "0..0", &|scene| {
            let before =
                scenes.iter().take_while(|other| other.name != scene.name).map(|other| other.start_conditions.len());
            let first: usize = before.sum();
            if scene.start_conditions.is_empty() {
                "0..0".to_owned()
            } else {
                format!("{first}..{}", first + scene.start_conditions.len())
            }
        })
}

/// Angular velocities that a start names.
fn spins(spins: &[Spin]) -> String {
    let one = |Spin { first, own }: &Spin| format!("::dalembert::mechanism::Spin {{ first: {first}, own: {own} }}");
    match spins {
        [] => "::std::vec::Vec::new()".to_owned(),
        _ => format!("::std::vec![{}]", spins.iter().map(one).collect::<Vec<_>>().join(", ")),
    }
}

/// The coefficients of restitution of any numbers as parameters.
fn restitutions(values: &[Id], bodies: &Bodies<'_>) -> String {
    let (name, body) = match values {
        [] => ("_", "        ::std::vec::Vec::new()\n".to_owned()),
        _ => {
            let function = of_constants(bodies, "values", values, "        ");
            ("c", format!("{function}        values(c).to_vec()\n"))
        }
    };
    format!(
        "\n    fn restitutions<S: ::dalembert::mechanism::Real>({name}: &[S]) -> ::std::vec::Vec<S> {{\n{body}    }}\n"
    )
}

/// The frequencies of a dependence on time; the trait's function serves where there is none.
fn frequencies(values: Option<&[Id]>, bodies: &Bodies<'_>) -> String {
    let (name, body) = match values {
        Some([]) => return String::new(),
        None => ("_", "        ::core::option::Option::None\n".to_owned()),
        Some(values) => {
            let function = of_constants(bodies, "values", values, "        ");
            ("c", format!("{function}        ::core::option::Option::Some(values(c).to_vec())\n"))
        }
    };
    format!(
        "\n    fn frequencies<S: ::dalembert::mechanism::Real>({name}: &[S]) -> ::core::option::Option<::std::vec::Vec<S>> {{\n{body}    }}\n"
    )
}

/// Which rates equations of starts contain; the trait's function serves where there are none.
fn speeds_of_conditions(pairs: &[(u32, u32)]) -> String {
    if pairs.is_empty() {
        return String::new();
    }
    let pairs: Vec<String> = pairs.iter().map(|(equation, rate)| format!("({equation}, {rate})")).collect();
    format!("\n    fn start_condition_speeds() -> &'static [(u32, u32)] {{\n        &[{}]\n    }}\n", pairs.join(", "))
}

/// A method that gives numbers of parameters.
fn list_of(name: &str, values: &[Id], bodies: &Bodies<'_>, parameters: &str) -> String {
    let body = if values.is_empty() {
        "        ::std::vec::Vec::new()\n".to_owned()
    } else {
        let function = of_constants(bodies, "values", values, "        ");
        format!("{function}        values(&{parameters}).to_vec()\n")
    };
    format!("\n    fn {name}(&self) -> ::std::vec::Vec<f64> {{\n{body}    }}\n")
}

fn guess(equilibrium: Option<&[Id]>, n: usize, bodies: &Bodies<'_>, parameters: &str) -> String {
    let body = match equilibrium {
        None => "        ::core::option::Option::None\n".to_owned(),
        Some(values) => {
            let function = of_constants(bodies, "values", values, "        ");
            format!("{function}        ::core::option::Option::Some(values(&{parameters}))\n")
        }
    };
    format!("\n    fn equilibrium_guess(&self) -> ::core::option::Option<[f64; {n}]> {{\n{body}    }}\n")
}
