//! What is animated, and what runs report.

use std::fmt::Write;

use super::inertia::{Matrix, turned};
use super::plan::Plan;
use super::problems::shown;
use super::shape::{Shape, Visual};
use super::text::{self, number};

/// Most ends of branches whose places are outputs: beyond them a report is no more read.
const TIPS: usize = 8;

/// Simple solids as they are, meshes by name, and lines from joint to joint where a link has no solid.
pub fn write(plan: &Plan<'_>, out: &mut String) {
    let tips = tips(plan);
    let place = |tip: &usize| {
        let origin = &plan.links[*tip].origin;
        format!("{}: {origin}", origin.replacen("_origin", "_place", 1))
    };
    if (1..=TIPS).contains(&tips.len()) {
        let _ = writeln!(out, "outputs: {{{}}}", tips.iter().map(place).collect::<Vec<_>>().join(", "));
    }
    let mut shapes = String::new();
    for (link, robot_link) in plan.robot.links.iter().enumerate() {
        let mut solids = 0;
        for (visual, frame) in robot_link.visuals.iter().zip(&plan.visuals[link]) {
            match solid(plan, link, visual, frame.as_deref()) {
                Ok(entry) => {
                    let _ = writeln!(shapes, "  - {entry}");
                    solids += 1;
                }
                Err(file) => {
                    let _ = writeln!(shapes, "  # {} looks like {}", shown(robot_link.name), shown(file));
                }
            }
        }
        if solids == 0 {
            shapes += &lines(plan, link);
        }
    }
    if let [tip] = tips.as_slice() {
        let _ = writeln!(shapes, "  - {{trace: {}}}", plan.links[*tip].origin);
    }
    if shapes.contains("  - ") {
        let _ = write!(out, "draw:\n{shapes}");
    }
}

/// The links at the ends of branches that move.
fn tips(plan: &Plan<'_>) -> Vec<usize> {
    let moves = |link: usize| {
        let mut at = plan.tree.above[link];
        while let Some(joint) = at {
            if plan.is_free(joint) || plan.mimics[joint].is_some() {
                return true;
            }
            at = plan.tree.above[plan.tree.ends[joint][0]];
        }
        false
    };
    (0..plan.links.len()).filter(|link| plan.tree.below(*link).next().is_none() && moves(*link)).collect()
}

/// A place in a link by numbers of metres.
fn place(origin: &str, frame: &str, metre: &str, xyz: [f64; 3]) -> String {
    let parts = (0..3).filter(|k| xyz[*k] != 0.0);
    let parts = parts.map(|k| {
        let sign = if xyz[k] < 0.0 { '-' } else { '+' };
        let times = if xyz[k].abs() == 1.0 { String::new() } else { format!("{}*", number(xyz[k].abs())) };
        format!(" {sign} {times}{metre}*{frame}.{}", text::NAMES[k])
    });
    origin.to_owned() + &parts.collect::<String>()
}

/// The entry of a solid, or the file of a mesh.
fn solid<'a>(plan: &Plan<'_>, link: usize, visual: &Visual<'a>, own: Option<&str>) -> Result<String, &'a str> {
    let names = &plan.links[link];
    let at = |xyz| place(&names.origin, &names.frame, &plan.metre, xyz);
    let xyz = visual.pose.xyz;
    Ok(match visual.shape {
        Shape::Mesh(file) => return Err(file),
        Shape::Sphere(radius) => format!("{{sphere: {{at: {}, radius: {}}}}}", at(xyz), number(radius)),
        Shape::Box(size) => {
            let [frame, at] = [own.unwrap_or(&names.frame), &at(xyz)];
            format!("{{box: {{frame: {frame}, at: {at}, size: [{}]}}}}", size.map(number).join(", "))
        }
        Shape::Cylinder { radius, length } => {
            let turn: Matrix = turned(visual.pose.rpy);
            let end = |half: f64| at(std::array::from_fn(|k| tidy(xyz[k] + half * turn[k][2])));
            let [from, to] = [-length / 2.0, length / 2.0].map(end);
            format!("{{cylinder: {{from: {from}, to: {to}, radius: {}}}}}", number(radius))
        }
    })
}

/// To a nanometre: what is drawn needs no more.
fn tidy(x: f64) -> f64 {
    const NANOMETRES: f64 = 1e9;
    let rounded = (x * NANOMETRES).round() / NANOMETRES;
    if rounded.is_finite() { rounded } else { x }
}

fn lines(plan: &Plan<'_>, link: usize) -> String {
    let below = plan.tree.below(link).map(|joint| &plan.links[plan.tree.ends[joint][1]].origin);
    let own = &plan.links[link].origin;
    below.map(|other| format!("  - {{line: [{own}, {other}]}}\n")).collect()
}
