//! `import`: a model file from a robot's URDF.
//!
//! Data flow one way: `xml` reads text, `robot` and `shape` what it means, `tree` how it hangs together; `plan` gives names, `moved` asks
//! whether the mass matrix has an inverse, `write`, `balances` and `drawn` write. All mistakes are collected before anything is written.

mod balances;
mod drawn;
mod inertia;
mod moved;
mod names;
mod plan;
mod problems;
mod robot;
mod shape;
#[cfg(test)]
mod tests;
mod text;
mod tree;
mod write;
mod xml;

use std::io::Write;
use std::path::Path;

use clap::ArgMatches;
use dalembert_symbolic::diagnose::{Place, Problem as Mistake};
use dalembert_symbolic::file::render;
use dalembert_symbolic::model;

use super::load::{not_utf8, standard_input};
use super::{Problem, outputs};
use plan::Plan;
use robot::{Joint, Kind, Limits, Link, Pose, Robot};

/// Most links of a robot: a model file has at most 1 MB, and each link takes some 500 bytes of it.
const LINKS: usize = 2000;

/// Reads the robot, and writes its model file.
pub fn run(options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    let from = options.get_one::<String>("robot").map_or("", String::as_str);
    let text = match from {
        "-" => standard_input()?,
        _ => {
            let bytes = std::fs::read(from).map_err(|problem| Problem::unread(from, &problem))?;
            String::from_utf8(bytes).map_err(|e| Problem::File(not_utf8(from, e.as_bytes())))?
        }
    };
    let stem = Path::new(from).file_stem().filter(|_| from != "-");
    let name = stem.map_or_else(|| "robot".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let chosen = options.get_one::<String>("output");
    let path = chosen.cloned().unwrap_or_else(|| format!("{name}.yaml"));
    outputs::ends_in(&path, &["yaml", "yml"])?;
    if chosen.is_none() && Path::new(&path).exists() {
        return Err(Problem::usage(format!("{path} exists already; say where with `-o FILE.yaml`")));
    }
    let shown = Path::new(from).file_name().map_or_else(|| from.to_owned(), |file| file.to_string_lossy().into_owned());
    let written = model_file(&text, &shown, options.get_flag("floating"))
        .map_err(|mistakes| Problem::Model(render(from, &text, &mistakes)))?;
    if path == "-" {
        return Ok(out.write_all(written.as_bytes())?);
    }
    std::fs::write(&path, &written)?;
    // What the language itself refuses, a limit that the robot exceeds say, stands in the file that was written.
    model::load(&written, &[]).map_err(|mistakes| Problem::Model(render(&path, &written, &mistakes)))?;
    writeln!(out, "wrote {path}; try: check {path}")?;
    Ok(())
}

/// The model file of a robot's text.
///
/// # Errors
/// All mistakes in it, with their places.
fn model_file(text: &str, from: &str, floating: bool) -> Result<String, Vec<Mistake>> {
    let document = xml::parse(text).map_err(|mistake| vec![mistake])?;
    let mut mistakes = Vec::new();
    let mut robot = robot::read(document.root_element(), &mut mistakes);
    if robot.links.len() > LINKS {
        mistakes.push(problems::too_large(robot.place.clone(), &format!("more than {LINKS} links")));
        return Err(mistakes);
    }
    // What has no name, ends or type is left out of the tree, which would only repeat that.
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    if floating {
        release(&mut robot);
    }
    let Some(tree) = tree::build(&robot, &mut mistakes) else { return Err(mistakes) };
    let mut plan = Plan::new(&robot, &tree, &mut mistakes);
    if mistakes.is_empty() {
        moved::check(&plan, &mut mistakes);
    }
    if mistakes.is_empty() { Ok(write::file(&mut plan, from)) } else { Err(mistakes) }
}

/// Lets a robot that nothing holds move: a floating joint from the ground to its root.
fn release(robot: &mut Robot<'_>) {
    let is_child = |link: &Link<'_>| robot.joints.iter().any(|joint| joint.child.0 == link.name);
    let Some(root) = robot.links.iter().find(|link| !is_child(link)).map(|link| link.name) else { return };
    // No link of a file is called so: names there are not empty.
    const WORLD: &str = " ground";
    let place = robot.place.clone();
    robot.links.push(Link { name: WORLD, place: place.clone(), inertial: None, visuals: Vec::new() });
    robot.joints.push(Joint {
        name: "base",
        place: place.clone(),
        kind_name: "floating",
        kind: Kind::Floating,
        parent: (WORLD, place.clone()),
        child: (root, place.clone()),
        pose: Pose::default(),
        axis: [1.0, 0.0, 0.0],
        axis_place: Place::default(),
        limits: Limits::default(),
        damping: 0.0,
        friction: 0.0,
        mimic: None,
    });
}
