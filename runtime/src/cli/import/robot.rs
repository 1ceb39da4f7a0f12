//! A robot as its file describes it: links and joints, each with its place.

use dalembert_symbolic::diagnose::{Place, Problem};
use roxmltree::Node;

use super::problems;
use super::shape::{Visual, visuals};
use super::xml::{child, number_of, numbers, place, place_of};

/// The types of joints that there are.
pub const KINDS: [&str; 6] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];

/// How a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Revolute or continuous: one angle about the axis.
    Turn,
    /// One displacement along the axis.
    Slide,
    /// Not at all.
    Fixed,
    /// Anywhere.
    Floating,
    /// In the plane across the axis, and about the axis.
    Planar,
}

/// A frame in another one: `xyz` in m, then `rpy`, the angles about the fixed x, y and z axes in this order, rad.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
}

/// Mass, and its moments about its centre along the axes of `pose`.
#[derive(Clone, Debug)]
pub struct Inertial {
    pub pose: Pose,
    pub mass: f64,
    /// xx, yy, zz, xy, xz, yz.
    pub tensor: [f64; 6],
}

/// A rigid part.
#[derive(Debug)]
pub struct Link<'a> {
    pub name: &'a str,
    pub place: Place,
    pub inertial: Option<Inertial>,
    pub visuals: Vec<Visual<'a>>,
}

/// What a joint is told to follow: `multiplier` times that joint, plus `offset`.
#[derive(Clone, Debug)]
pub struct Mimic<'a> {
    pub joint: &'a str,
    pub place: Place,
    pub multiplier: f64,
    pub offset: f64,
}

/// What a joint is told to keep: its range, the largest force or moment, the largest rate.
#[derive(Clone, Copy, Debug, Default)]
pub struct Limits {
    pub range: Option<[f64; 2]>,
    pub effort: Option<f64>,
    pub velocity: Option<f64>,
}

/// Between two links.
#[derive(Debug)]
pub struct Joint<'a> {
    pub name: &'a str,
    pub place: Place,
    /// Its type as written.
    pub kind_name: &'a str,
    pub kind: Kind,
    pub parent: (&'a str, Place),
    pub child: (&'a str, Place),
    pub pose: Pose,
    pub axis: [f64; 3],
    pub axis_place: Place,
    pub limits: Limits,
    pub damping: f64,
    pub friction: f64,
    pub mimic: Option<Mimic<'a>>,
}

/// A whole file.
#[derive(Debug)]
pub struct Robot<'a> {
    pub name: &'a str,
    pub place: Place,
    pub links: Vec<Link<'a>>,
    pub joints: Vec<Joint<'a>>,
    /// Elements that say nothing of the motion, and how many there are of each.
    pub ignored: Vec<(&'a str, usize)>,
}

/// Reads the outermost element.
pub fn read<'a>(root: Node<'a, '_>, problems: &mut Vec<Problem>) -> Robot<'a> {
    let mut robot = Robot {
        name: root.attribute("name").unwrap_or("robot"),
        place: place(root),
        links: Vec::new(),
        joints: Vec::new(),
        ignored: Vec::new(),
    };
    if !root.has_tag_name("robot") {
        problems.push(problems::no_robot(place(root), root.tag_name().name()));
        return robot;
    }
    if let Some(found) =
        root.descendants().find(|node| node.tag_name().namespace().is_some_and(|n| n.contains("xacro")))
    {
        problems.push(problems::macros(place(found)));
        return robot;
    }
    for node in root.children().filter(Node::is_element) {
        match node.tag_name().name() {
            "link" => robot.links.extend(link(node, problems)),
            "joint" => robot.joints.extend(joint(node, problems)),
            other => match robot.ignored.iter_mut().find(|(name, _)| *name == other) {
                Some((_, count)) => *count += 1,
                None => robot.ignored.push((other, 1)),
            },
        }
    }
    robot
}

fn named<'a>(node: Node<'a, '_>, problems: &mut Vec<Problem>) -> Option<&'a str> {
    let name = node.attribute("name").filter(|name| !name.trim().is_empty());
    if name.is_none() {
        let of = format!("this {}", node.tag_name().name());
        problems.push(problems::missing(place(node), &of, "name", "give it one, `name=\"forearm\"`"));
    }
    name
}

fn link<'a>(node: Node<'a, '_>, problems: &mut Vec<Problem>) -> Option<Link<'a>> {
    let name = named(node, problems)?;
    let inertial = child(node, "inertial").and_then(|inner| inertial(inner, name, problems));
    Some(Link { name, place: place_of(node, "name"), inertial, visuals: visuals(node, problems) })
}

/// `<origin>` inside an element; absent: none of it moved or turned.
pub fn pose(node: Node<'_, '_>, problems: &mut Vec<Problem>) -> Pose {
    let Some(origin) = child(node, "origin") else { return Pose::default() };
    Pose {
        xyz: numbers(origin, "xyz", problems).unwrap_or_default(),
        rpy: numbers(origin, "rpy", problems).unwrap_or_default(),
    }
}

fn inertial(node: Node<'_, '_>, link: &str, problems: &mut Vec<Problem>) -> Option<Inertial> {
    let before = problems.len();
    let pose = pose(node, problems);
    let of = || format!("`inertial` of link `{}`", problems::shown(link));
    let mut mass = 0.0;
    match child(node, "mass") {
        None => problems.push(problems::missing(place(node), &of(), "mass", "write `<mass value=\"1.5\"/>`, in kg")),
        Some(inner) => {
            let value = required(inner, "value", "mass", problems);
            if value.is_some_and(|value| value < 0.0) {
                let what = format!("the mass of link `{}`", problems::shown(link));
                let help = "a mass is in kg; 0, or no `<inertial>` at all, where a link has none";
                problems.push(problems::out_of_range(place_of(inner, "value"), &what, "0 or more", help));
            }
            mass = value.unwrap_or(0.0);
        }
    }
    let mut tensor = [0.0; 6];
    match child(node, "inertia") {
        None => {
            let help = "write `<inertia ixx=\"…\" ixy=\"0\" ixz=\"0\" iyy=\"…\" iyz=\"0\" izz=\"…\"/>`, in kg m^2; all 0 for a point";
            problems.push(problems::missing(place(node), &of(), "inertia", help));
        }
        Some(inner) => {
            for (value, name) in tensor.iter_mut().zip(["ixx", "iyy", "izz", "ixy", "ixz", "iyz"]) {
                *value = required(inner, name, "inertia", problems).unwrap_or(0.0);
            }
            if problems.len() == before {
                possible(link, &tensor, place(inner), problems);
            }
        }
    }
    (problems.len() == before).then_some(Inertial { pose, mass, tensor })
}

fn possible(link: &str, tensor: &[f64; 6], place: Place, problems: &mut Vec<Problem>) {
    let found = dalembert_symbolic::model::impossible_moments(&super::inertia::rows(tensor).concat());
    // What data of few digits explain the imported file warns of.
    if let Some(wrong) = found.filter(|wrong| !wrong.few_digits) {
        problems.push(problems::impossible_inertia(place, link, &wrong.moments, &wrong.why, wrong.help));
    }
}

/// A number that must be there.
fn required(node: Node<'_, '_>, name: &str, of: &str, problems: &mut Vec<Problem>) -> Option<f64> {
    if node.attribute(name).is_none() {
        problems.push(problems::missing(
            place(node),
            &format!("this `{of}`"),
            name,
            &format!("write `{name}=\"0.1\"`"),
        ));
    }
    number_of(node, name, problems)
}

fn joint<'a>(node: Node<'a, '_>, problems: &mut Vec<Problem>) -> Option<Joint<'a>> {
    let name = named(node, problems)?;
    let of = format!("joint `{}`", problems::shown(name));
    let (kind, kind_name) = match node.attribute("type") {
        Some(text) => (kind(node, name, text, problems), text),
        None => {
            let help = format!("write `type=\"…\"`: {}", KINDS.join(", "));
            problems.push(problems::missing(place(node), &of, "type", &help));
            (None, "")
        }
    };
    let mut end = |which: &str| {
        let named = child(node, which).and_then(|inner| Some((inner.attribute("link")?, place_of(inner, "link"))));
        if named.is_none() {
            problems.push(problems::missing(place(node), &of, which, &format!("write `<{which} link=\"…\"/>`")));
        }
        named
    };
    let (parent, child_link) = (end("parent"), end("child"));
    let limits = limits(node, &of, problems);
    let axis_node = child(node, "axis");
    let axis = axis_node.and_then(|inner| numbers(inner, "xyz", problems)).unwrap_or([1.0, 0.0, 0.0]);
    let axis_place = axis_node.map_or_else(|| place(node), |inner| place_of(inner, "xyz"));
    if axis.iter().all(|part| *part == 0.0) && kind != Some(Kind::Fixed) && kind != Some(Kind::Floating) {
        problems.push(problems::no_axis(axis_place.clone(), name));
    }
    let (damping, friction) = dynamics(node, &of, problems);
    let pose = pose(node, problems);
    let mimic = child(node, "mimic").and_then(|inner| mimic(inner, &of, problems));
    let (kind, parent, child_link) = (kind?, parent?, child_link?);
    let place = place_of(node, "name");
    Some(Joint {
        name,
        place,
        kind_name,
        kind,
        parent,
        child: child_link,
        pose,
        axis,
        axis_place,
        limits,
        damping,
        friction,
        mimic,
    })
}

fn kind(node: Node<'_, '_>, joint: &str, text: &str, problems: &mut Vec<Problem>) -> Option<Kind> {
    match text {
        "revolute" | "continuous" => Some(Kind::Turn),
        "prismatic" => Some(Kind::Slide),
        "fixed" => Some(Kind::Fixed),
        "floating" => Some(Kind::Floating),
        "planar" => Some(Kind::Planar),
        _ => {
            problems.push(problems::unknown_kind(place_of(node, "type"), joint, text));
            None
        }
    }
}

fn limits(node: Node<'_, '_>, of: &str, problems: &mut Vec<Problem>) -> Limits {
    let Some(inner) = child(node, "limit") else { return Limits::default() };
    let mut limit = |which: &str| number_of(inner, which, problems);
    let (lower, upper) = (limit("lower"), limit("upper"));
    let (effort, velocity) = (limit("effort"), limit("velocity"));
    let range = (lower.is_some() || upper.is_some()).then(|| [lower.unwrap_or(0.0), upper.unwrap_or(0.0)]);
    if let Some([lower, upper]) = range.filter(|[lower, upper]| lower > upper) {
        let help = "the lower limit comes first, `lower=\"-1.5\" upper=\"1.5\"`";
        let what = format!("what lies between `lower` {lower} and `upper` {upper} of {of}");
        problems.push(problems::out_of_range(place(inner), &what, "a range", help));
    }
    Limits { range, effort, velocity }
}

fn dynamics(node: Node<'_, '_>, of: &str, problems: &mut Vec<Problem>) -> (f64, f64) {
    let Some(inner) = child(node, "dynamics") else { return (0.0, 0.0) };
    let mut read = |which: &str| {
        let value = number_of(inner, which, problems).unwrap_or(0.0);
        if value < 0.0 {
            let help = "it takes energy away: 0 or more";
            problems.push(problems::out_of_range(
                place_of(inner, which),
                &format!("`{which}` of {of}"),
                "0 or more",
                help,
            ));
        }
        value
    };
    (read("damping"), read("friction"))
}

fn mimic<'a>(node: Node<'a, '_>, of: &str, problems: &mut Vec<Problem>) -> Option<Mimic<'a>> {
    let Some(joint) = node.attribute("joint") else {
        let help = "write `<mimic joint=\"left_finger\" multiplier=\"1\" offset=\"0\"/>`";
        problems.push(problems::missing(place(node), &format!("`mimic` of {of}"), "joint", help));
        return None;
    };
    let multiplier = number_of(node, "multiplier", problems).unwrap_or(1.0);
    let offset = number_of(node, "offset", problems).unwrap_or(0.0);
    Some(Mimic { joint, place: place_of(node, "joint"), multiplier, offset })
}
