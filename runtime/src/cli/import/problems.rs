//! What can be wrong with a robot's file: one constructor a problem, no message is written anywhere else in this folder.

use dalembert_symbolic::diagnose::{Place, Problem, did_you_mean_or};

use super::robot::KINDS;

fn problem(code: &'static str, place: Place, message: String, label: &str, help: impl Into<String>) -> Problem {
    // A file may be hostile: what it names is cut, so that a message stays one line.
    Problem { code, message, label: label.into(), help: help.into(), place }
}

/// The longest name that a message repeats, in characters.
const LONGEST: usize = 60;

/// A name as messages and comments repeat it: one line, and not a long one.
pub fn shown(name: &str) -> String {
    let plain = |c: char| if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}' | '\u{feff}') { ' ' } else { c };
    let mut text: String = name.trim().chars().take(LONGEST).map(plain).collect();
    if name.trim().chars().nth(LONGEST).is_some() {
        text.push('…');
    }
    text
}

pub fn no_xml(place: Place, why: &str) -> Problem {
    let help = "elements close in the reverse order in which they open, `<link name=\"a\"> … </link>`; a file that ends too early was not written to its end";
    problem("U101", place, format!("this is no XML: {why}"), "", help)
}

pub fn document_type(place: Place) -> Problem {
    let help = "robots need no entities: take the line out, and write what its entities stand for in their place";
    problem("U102", place, "a document type (`<!DOCTYPE …>`) is not read".to_owned(), "", help)
}

pub fn too_large(place: Place, what: &str) -> Problem {
    let help = "meshes belong in files of their own, to which the robot's file refers";
    problem("U103", place, format!("this is larger than a robot: {what}"), "", help)
}

pub fn no_robot(place: Place, root: &str) -> Problem {
    let help = match root {
        "sdf" => "this is SDFormat; many robots have both files: look for the same one as URDF".to_owned(),
        "mujoco" => "this is MuJoCo's MJCF; look for the same robot as URDF".to_owned(),
        _ => "the outermost element of a URDF file is `<robot name=\"…\">`".to_owned(),
    };
    problem("U104", place, format!("the outermost element is `{}`, not `robot`", shown(root)), "", help)
}

pub fn macros(place: Place) -> Problem {
    let help = "expand them first, `xacro robot.urdf.xacro > robot.urdf`, and import what that writes";
    problem("U105", place, "this file has macros that are not expanded (xacro)".to_owned(), "", help)
}

pub fn missing(place: Place, of: &str, what: &str, help: &str) -> Problem {
    problem("U106", place, format!("{of} has no `{what}`"), "", help)
}

pub fn bad_number(place: Place, name: &str, text: &str, wanted: &str) -> Problem {
    let help = match text.contains("${") || text.contains("$(") {
        true => "this is a macro's parameter: expand the file first, `xacro robot.urdf.xacro > robot.urdf`".to_owned(),
        false => format!("write {wanted} with points, as `{}`", example(wanted)),
    };
    problem("U107", place, format!("`{}` of `{name}` is not {wanted}", shown(text)), "", help)
}

fn example(wanted: &str) -> &'static str {
    if wanted.starts_with("three") { "0 0 0.15" } else { "0.15" }
}

pub fn out_of_range(place: Place, what: &str, wanted: &str, help: &str) -> Problem {
    problem("U108", place, format!("{what} is not {wanted}"), "", help)
}

pub fn unknown_kind(place: Place, joint: &str, kind: &str) -> Problem {
    let help = did_you_mean_or(kind, &KINDS);
    problem("U109", place, format!("joint `{}` is of an unknown type `{}`", shown(joint), shown(kind)), "", help)
}

pub fn twice(place: Place, what: &str, name: &str) -> Problem {
    let help = "give one of them another name, and change what refers to it";
    problem("U110", place, format!("there are two {what}s called `{}`", shown(name)), "the second", help)
}

pub fn unknown_link(place: Place, joint: &str, name: &str, help: String) -> Problem {
    let message = format!("joint `{}` names a link that is not there: `{}`", shown(joint), shown(name));
    problem("U111", place, message, "", help)
}

pub fn two_parents(place: Place, link: &str, first: &str) -> Problem {
    let message = format!("link `{}` hangs on two joints, `{}` is the other", shown(link), shown(first));
    let help = "URDF describes trees: cut a loop at one joint, and close it in the imported file by a row of `constraints`, as `rssr` of the library does";
    problem("U112", place, message, "", help)
}

pub fn ring(place: Place, joints: &str) -> Problem {
    let help =
        "follow `parent` upwards: it comes back. One joint of the ring has the wrong `parent` or is one too many";
    problem("U113", place, format!("these joints form a ring: {joints}"), "", help)
}

pub fn two_roots(place: Place, link: &str, root: &str) -> Problem {
    let message = format!(
        "link `{}` is no joint's child, and `{}` is none either: there are two roots",
        shown(link),
        shown(root)
    );
    let help = format!(
        "connect it, `<joint name=\"…\" type=\"fixed\"><parent link=\"{}\"/><child link=\"{}\"/></joint>`, or take it out",
        shown(root),
        shown(link)
    );
    problem("U114", place, message, "", help)
}

pub fn no_links(place: Place) -> Problem {
    problem("U115", place, "this robot has no links".to_owned(), "", "a robot is links and the joints between them")
}

pub fn impossible_inertia(place: Place, link: &str, moments: &str, why: &str, help: String) -> Problem {
    let message = format!("no body has the moments of inertia of link `{}`: {moments} kg m^2", shown(link));
    problem("U116", place, message, why, help)
}

pub fn no_axis(place: Place, joint: &str) -> Problem {
    let help = "an axis is a direction of any length but 0, `<axis xyz=\"0 0 1\"/>`";
    problem("U117", place, format!("the axis of joint `{}` has no direction", shown(joint)), "", help)
}

pub fn bad_mimic(place: Place, joint: &str, why: &str, help: String) -> Problem {
    problem("U118", place, format!("joint `{}` cannot mimic that: {why}", shown(joint)), "", help)
}

pub fn nothing_moved(place: Place, joint: &str, what: &str) -> Problem {
    let message = format!("joint `{}` moves nothing that has {what}", shown(joint));
    let help = "give a link beyond it an `<inertial>` with mass and inertia, or make the joint `fixed`: what has no mass has no motion of its own";
    problem("U119", place, message, "", help)
}

pub fn nothing_moves(place: Place) -> Problem {
    let help =
        "a model needs a coordinate: a joint that is not `fixed`, or `--floating` for a robot that nothing holds";
    problem("U120", place, "no joint of this robot moves".to_owned(), "", help)
}

pub fn tilted_plane(place: Place, joint: &str) -> Problem {
    let message = format!("the axis of planar joint `{}` is none of the axes of its frame", shown(joint));
    let help = "turn the frame instead, by `rpy` of the joint's `<origin>`, and give `<axis xyz=\"0 0 1\"/>`";
    problem("U121", place, message, "", help)
}
