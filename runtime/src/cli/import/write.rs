//! The model file of a robot, section by section.

use std::fmt::Write;

use dalembert_symbolic::print::type_name;

use super::inertia::{along, turned};
use super::plan::Plan;
use super::problems::shown;
use super::robot::{Inertial, Joint, Kind, Limits};
use super::text::{self, number};
use super::{balances, drawn};
use crate::numbers::counted;

/// The whole file; `from` is the name of the robot's file.
pub fn file(plan: &mut Plan<'_>, from: &str) -> String {
    let mut out = head(plan, from);
    parameters(plan, &mut out);
    coordinates(plan, &mut out);
    definitions(plan, &mut out);
    frames(plan, &mut out);
    points(plan, &mut out);
    bodies(plan, &mut out);
    let _ = writeln!(out, "gravity: [0, 0, -{}]", plan.gravity);
    dampers(plan, &mut out);
    balances::write(plan, &mut out);
    if plan.robot.joints.iter().all(|joint| joint.damping == 0.0) {
        out += "conserved: {energy: energy}\n";
    }
    drawn::write(plan, &mut out);
    scene(plan, &mut out);
    out
}

fn head(plan: &Plan<'_>, from: &str) -> String {
    let robot = plan.robot;
    let moving = robot.joints.iter().filter(|joint| joint.kind != Kind::Fixed).count();
    let mut out = format!(
        "# From {} (URDF, robot `{}`). All numbers are the robot's but gravity, which URDF does not state.\n",
        shown(from),
        shown(robot.name)
    );
    let left_out: Vec<String> =
        robot.ignored.iter().take(12).map(|(name, count)| format!("{count} {}", shown(name))).collect();
    let left_out = [vec!["collision geometry".to_owned()], left_out].concat().join(", ");
    let _ = writeln!(out, "# Not taken over: {left_out}; limits and friction of joints are comments.");
    for joint in &robot.joints {
        if let Some(part) =
            joint.pose.rpy.iter().find_map(|angle| text::nearly_part_of_pi(*angle).map(|part| (*angle, part)))
        {
            let _ = writeln!(
                out,
                "# The origin of joint `{}` is turned by {}, not quite {}: with the latter the equations are shorter.",
                shown(joint.name),
                number(part.0),
                part.1
            );
        }
    }
    let (links, joints) = (counted(robot.links.len(), "link"), counted(moving, "joint"));
    let name = super::names::identifier(robot.name);
    let _ = writeln!(out, "name: {}\nabout: The robot {name}; {links}, {joints} that move.", type_name(&name));
    out
}

fn parameters(plan: &Plan<'_>, out: &mut String) {
    let _ = writeln!(out, "parameters:\n  {}: 9.81 N/kg", plan.gravity);
    if !plan.metre.is_empty() {
        let _ = writeln!(out, "  {}: 1 m   # for what is drawn", plan.metre);
    }
    for at in &plan.tree.order {
        let (joint, names) = (&plan.robot.joints[*at], &plan.joints[*at]);
        for (name, value) in names.offsets.iter().zip(joint.pose.xyz) {
            if let Some(name) = name {
                let _ = writeln!(out, "  {name}: {} m", number(value));
            }
        }
        if let (Some(mimic), [ratio, shift]) = (&joint.mimic, &names.mimic) {
            let unit = if joint.kind == Kind::Turn { "1/m" } else { "m" };
            for (name, value, unit) in [(ratio, mimic.multiplier, unit), (shift, mimic.offset, "m")] {
                if let Some(name) = name {
                    let _ = writeln!(out, "  {name}: {} {unit}", number(value));
                }
            }
        }
        let link = plan.tree.ends[*at][1];
        let (Some(inertial), names) = (&plan.robot.links[link].inertial, &plan.links[link]) else { continue };
        if !names.mass.is_empty() {
            let _ = writeln!(out, "  {}: {} kg", names.mass, number(inertial.mass));
        }
        for (name, value) in names.centre.iter().zip(inertial.pose.xyz) {
            if let Some(name) = name {
                let _ = writeln!(out, "  {name}: {} m", number(value));
            }
        }
    }
}

/// What URDF says of a joint that equations do not: its type, limits, friction.
fn remark(plan: &Plan<'_>, at: usize) -> String {
    let joint = &plan.robot.joints[at];
    let links = plan.tree.ends[at].map(|link| shown(plan.robot.links[link].name));
    let (unit, force) = if joint.kind == Kind::Slide { ("m", "N") } else { ("rad", "N*m") };
    let mut text = format!("{}, {} to {}", joint.kind_name, links[0], links[1]);
    let Limits { range, effort, velocity } = &joint.limits;
    if let Some([lower, upper]) = range {
        let _ = write!(text, "; {} to {} {unit}", number(*lower), number(*upper));
    }
    let most = [
        effort.map(|most| format!("{} {force}", number(most))),
        velocity.map(|most| format!("{} {unit}/s", number(most))),
    ];
    let most: Vec<String> = most.into_iter().flatten().collect();
    if !most.is_empty() {
        let _ = write!(text, "; at most {}", most.join(", "));
    }
    if joint.friction != 0.0 {
        let _ = write!(text, "; friction {} {force}, left out", number(joint.friction));
    }
    if matches!(joint.kind, Kind::Planar | Kind::Floating) && joint.damping != 0.0 {
        let _ = write!(text, "; damping {}, left out", number(joint.damping));
    }
    let written = &plan.joints[at].coordinate;
    let base = super::names::identifier(joint.name);
    if *joint.name != base || (matches!(joint.kind, Kind::Turn | Kind::Slide) && *written != base) {
        let _ = write!(text, "; `{}` in the URDF", shown(joint.name));
    }
    text
}

fn coordinates(plan: &Plan<'_>, out: &mut String) {
    out.push_str("coordinates:\n");
    for at in plan.tree.order.iter().copied().filter(|at| plan.is_free(*at)) {
        let names = &plan.joints[at];
        let unit = match plan.robot.joints[at].kind {
            Kind::Slide => "m",
            Kind::Floating => "rotation",
            _ => "rad",
        };
        for slide in &names.slides {
            let _ = writeln!(out, "  {slide}: m");
        }
        let _ = writeln!(out, "  {}: {unit}   # {}", names.coordinate, remark(plan, at));
    }
}

fn definitions(plan: &Plan<'_>, out: &mut String) {
    let mut started = false;
    for at in plan.tree.order.iter().copied() {
        let (joint, names) = (&plan.robot.joints[at], &plan.joints[at]);
        let (Some(other), Some(mimic)) = (plan.mimics[at], &joint.mimic) else { continue };
        if !started {
            out.push_str("define:\n");
            started = true;
        }
        let driver = &plan.joints[other].coordinate;
        let product = match (&names.mimic[0], mimic.multiplier) {
            (Some(ratio), _) => format!("{ratio}*{driver}"),
            (None, 1.0) => driver.clone(),
            (None, -1.0) => format!("-{driver}"),
            (None, factor) => format!("{}*{driver}", number(factor)),
        };
        let shift = match (&names.mimic[1], mimic.offset) {
            (_, 0.0) => String::new(),
            (Some(name), _) => format!(" + {name}"),
            (None, offset) if offset < 0.0 => format!(" - {}", number(-offset)),
            (None, offset) => format!(" + {}", number(offset)),
        };
        let _ = writeln!(out, "  {}: {product}{shift}   # mimics {driver}; {}", names.coordinate, remark(plan, at));
    }
}

fn frames(plan: &Plan<'_>, out: &mut String) {
    let mut written = String::new();
    for at in &plan.tree.order {
        let [parent, child] = plan.tree.ends[*at];
        let (joint, names) = (&plan.robot.joints[*at], &plan.joints[*at]);
        let (above, own) = (&plan.links[parent].frame, &plan.links[child].frame);
        let mut turns = text::turns(joint.pose.rpy);
        let mut from = above;
        if let Some(mount) = &names.mount {
            let _ = writeln!(written, "  {mount}: {}", text::frame(above, &turns));
            turns.clear();
            from = mount;
        }
        let entry = match joint.kind {
            Kind::Fixed | Kind::Slide if turns.is_empty() => continue,
            Kind::Fixed | Kind::Slide => text::frame(from, &turns),
            Kind::Floating => text::frame(from, std::slice::from_ref(&names.coordinate)),
            Kind::Turn | Kind::Planar => {
                turns.push(text::turn(joint.axis, &names.coordinate));
                text::frame(from, &turns)
            }
        };
        let _ = writeln!(written, "  {own}: {entry}");
    }
    for (link, names) in plan.visuals.iter().enumerate() {
        for (visual, name) in plan.robot.links[link].visuals.iter().zip(names) {
            if let Some(name) = name {
                let _ = writeln!(
                    written,
                    "  {name}: {}",
                    text::frame(&plan.links[link].frame, &text::turns(visual.pose.rpy))
                );
            }
        }
    }
    if !written.is_empty() {
        let _ = write!(out, "frames:   # rpy turns about fixed axes x, y, z: z, y, x about axes as turned\n{written}");
    }
}

fn points(plan: &Plan<'_>, out: &mut String) {
    let root = &plan.links[plan.tree.root];
    let _ = writeln!(out, "points:\n  {}: [0, 0, 0]{}", root.origin, resting(plan));
    for at in &plan.tree.order {
        let [parent, child] = plan.tree.ends[*at].map(|link| &plan.links[link]);
        let (joint, names) = (&plan.robot.joints[*at], &plan.joints[*at]);
        let mut place = parent.origin.clone() + &offset(&parent.frame, &names.offsets);
        match joint.kind {
            Kind::Slide => place += &text::along(&names.coordinate, &child.frame, joint.axis),
            Kind::Floating => place += &offset(plan.base(*at), &std::array::from_fn(|k| names.slides.get(k).cloned())),
            Kind::Planar => {
                for (slide, direction) in names.slides.iter().zip(plan.plane(*at).into_iter().flatten()) {
                    place += &text::along(slide, plan.base(*at), direction);
                }
            }
            Kind::Turn | Kind::Fixed => {}
        }
        let link = &plan.robot.links[plan.tree.ends[*at][1]];
        let remark = if child.origin == format!("{}_origin", link.name) {
            String::new()
        } else {
            format!("   # link `{}`", shown(link.name))
        };
        let _ = writeln!(out, "  {}: {place}{remark}", child.origin);
    }
}

/// What is said of the mass of a root, which nothing moves.
fn resting(plan: &Plan<'_>) -> String {
    let root = &plan.robot.links[plan.tree.root];
    let mass = root.inertial.as_ref().map_or(0.0, |inertial| inertial.mass);
    let heavy = if mass == 0.0 { String::new() } else { format!(", its {} kg move nowhere", number(mass)) };
    format!("   # `{}` rests{heavy}", shown(root.name))
}

/// A displacement by parameters along a frame.
fn offset(frame: &str, names: &[Option<String>; 3]) -> String {
    let parts = names
        .iter()
        .enumerate()
        .filter_map(|(k, name)| Some(format!(" + {}*{frame}.{}", name.as_ref()?, text::NAMES[k])));
    parts.collect()
}

fn bodies(plan: &Plan<'_>, out: &mut String) {
    out.push_str("bodies:\n");
    for at in &plan.tree.order {
        let link = plan.tree.ends[*at][1];
        let names = &plan.links[link];
        let Some(body) = &names.body else { continue };
        let robot_link = &plan.robot.links[link];
        let mass = if names.mass.is_empty() { "0" } else { &names.mass };
        let moments = robot_link.inertial.as_ref().map_or_else(|| "[0, 0, 0]".to_owned(), moments);
        let position = names.origin.clone() + &offset(&names.frame, &names.centre);
        let frame = &names.frame;
        let mut remark = String::new();
        if body != robot_link.name {
            remark = format!("   # link `{}`", shown(robot_link.name));
        } else if mass == "0" {
            remark = "   # no mass; what acts on it needs a body".to_owned();
        }
        if let Some(rpy) = robot_link.inertial.as_ref().map(|inertial| inertial.pose.rpy).filter(|rpy| *rpy != [0.0; 3])
        {
            remark += &format!("   # moments turned by rpy {}", rpy.map(text::angle).join(" "));
        }
        let _ = writeln!(
            out,
            "  {body}: {{mass: {mass}, inertia: {moments}, frame: {frame}, position: {position}}}{remark}"
        );
    }
}

/// Moments about the centre of mass along the link's axes.
fn moments(inertial: &Inertial) -> String {
    let [xx, yy, zz, xy, xz, yz] = along(&turned(inertial.pose.rpy), &inertial.tensor).map(|moment| match moment {
        0.0 => "0".to_owned(),
        moment => format!("{} kg*m^2", number(moment)),
    });
    match [&xy, &xz, &yz].iter().all(|product| *product == "0") {
        true => format!("[{xx}, {yy}, {zz}]"),
        false => format!("[[{xx}, {xy}, {xz}], [{xy}, {yy}, {yz}], [{xz}, {yz}, {zz}]]"),
    }
}

fn dampers(plan: &Plan<'_>, out: &mut String) {
    let damped = |joint: &Joint<'_>| joint.damping != 0.0 && matches!(joint.kind, Kind::Turn | Kind::Slide);
    let mut started = false;
    for at in plan.tree.order.iter().copied().filter(|at| damped(&plan.robot.joints[*at])) {
        if !started {
            out.push_str("dampers:\n");
            started = true;
        }
        let (joint, coordinate) = (&plan.robot.joints[at], &plan.joints[at].coordinate);
        let child = &plan.links[plan.tree.ends[at][1]];
        let rate = if plan.is_free(at) { format!("{coordinate}'") } else { format!("rate({coordinate})") };
        let direction = text::direction(&child.frame, joint.axis);
        let (unit, acts) = match joint.kind {
            Kind::Slide => ("N/m*s", format!("along: {direction}, at: {}", child.origin)),
            _ => ("N*m*s", format!("axis: {direction}")),
        };
        let (damping, between) = (number(joint.damping), between(plan, at));
        let _ = writeln!(out, "  {coordinate}_damping: {{rate: {rate}, damping: {damping} {unit}, {between}, {acts}}}");
    }
}

/// `on` and `from` of what acts between the links of a joint.
pub fn between(plan: &Plan<'_>, joint: usize) -> String {
    let [parent, child] = plan.tree.ends[joint].map(|link| plan.links[link].body.as_deref());
    let from = parent.map(|parent| format!(", from: {parent}")).unwrap_or_default();
    format!("on: {}{from}", child.unwrap_or("ground"))
}

fn scene(plan: &Plan<'_>, out: &mut String) {
    let start = |at: usize| {
        let [lower, upper] = plan.robot.joints[at].limits.range?;
        // Where its limits leave zero out it starts half way between them.
        let outside =
            plan.is_free(at) && plan.robot.joints[at].kind_name != "continuous" && !(lower..=upper).contains(&0.0);
        outside.then(|| format!("{}: {}", plan.joints[at].coordinate, number((lower + upper) / 2.0)))
    };
    // What falls without a spin would have nothing but rounding in its attitude.
    let spin = |at: usize| {
        let floats = plan.robot.joints[at].kind == Kind::Floating;
        floats.then(|| format!("{}': [0.1, 0.2, 0.3]", plan.joints[at].coordinate))
    };
    let starts: Vec<String> = plan.tree.order.iter().filter_map(|at| start(*at).or_else(|| spin(*at))).collect();
    let _ = writeln!(out, "scene: {{start: {{{}}}, until: 2, tolerance: 1e-9}}", starts.join(", "));
}
