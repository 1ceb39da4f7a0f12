//! The second derivation: the momentum of all that a joint moves, in the directions in which the joint lets it move.

use std::fmt::Write;

use super::plan::Plan;
use super::robot::Kind;
use super::text::{self, number};
use super::write::between;

/// Most bodies that balances list, all together: of a chain of a hundred links they have five thousand.
const LISTED: usize = 10_000;

/// One balance for each degree of freedom; joints that are geared have a reaction each and an equation between them.
pub fn write(plan: &mut Plan<'_>, out: &mut String) {
    let moving = (0..plan.joints.len()).filter(|at| plan.robot.joints[*at].kind != Kind::Fixed);
    if moving.map(|at| plan.tree.moved(at).count()).sum::<usize>() > LISTED {
        out.push_str("# Balances of all that each joint moves would be longer than the rest of this file.\n");
        return;
    }
    out.push_str("balances:   # of all that a joint moves, about or along what the joint lets move: no reaction takes part\n  equations:\n");
    let all = plan.links.iter().filter(|link| link.body.is_some()).count();
    for at in plan.tree.order.clone() {
        let joint = &plan.robot.joints[at];
        if joint.kind == Kind::Fixed {
            continue;
        }
        let bodies = plan.moved(at);
        let of = if bodies.len() == all { "all".to_owned() } else { format!("[{}]", bodies.join(", ")) };
        let child = &plan.links[plan.tree.ends[at][1]];
        let axis = text::direction(&child.frame, joint.axis);
        let moment = format!("    - moment: {{about: {}, of: {of}", child.origin);
        match joint.kind {
            Kind::Turn => *out += &format!("{moment}, along: {axis}}}\n"),
            Kind::Slide => *out += &format!("    - force: {{of: {of}, along: {axis}}}\n"),
            Kind::Floating => *out += &format!("    - force: {{of: {of}}}\n{moment}}}\n"),
            Kind::Planar => {
                for direction in plan.plane(at).into_iter().flatten() {
                    let along = text::direction(plan.base(at), direction);
                    *out += &format!("    - force: {{of: {of}, along: {along}}}\n");
                }
                *out += &format!("{moment}, along: {axis}}}\n");
            }
            Kind::Fixed => {}
        }
    }
    gears(plan, out);
}

/// What joints that follow each other pass: a moment or force in each, whose powers cancel.
fn gears(plan: &mut Plan<'_>, out: &mut String) {
    let geared: Vec<usize> = plan.tree.order.iter().copied().filter(|at| plan.is_geared(*at)).collect();
    let named: Vec<(usize, String)> = geared
        .iter()
        .map(|at| (*at, plan.names.fresh(&format!("{}_gear", plan.joints[*at].coordinate), "joint")))
        .collect();
    for (driver, own) in named.iter().filter(|(at, _)| plan.is_free(*at)) {
        let mut sum = own.clone();
        for (_, name, factor) in named
            .iter()
            .filter(|(at, _)| at != driver && plan.driver(*at) == *driver)
            .map(|(at, name)| (at, name, factor(plan, *at)))
        {
            let _ = write!(sum, " + {factor}*{name}");
        }
        let _ = writeln!(out, "    - equation: \"{sum} = 0\"   # a gear takes and gives no power");
    }
    if !named.is_empty() {
        out.push_str("  reactions:\n");
    }
    for (at, name) in &named {
        let (joint, child) = (&plan.robot.joints[*at], &plan.links[plan.tree.ends[*at][1]]);
        let couple = if joint.kind == Kind::Turn { "couple: true".to_owned() } else { format!("at: {}", child.origin) };
        let along = text::direction(&child.frame, joint.axis);
        let _ = writeln!(out, "    {name}: {{{}, {couple}, along: {along}}}", between(plan, *at));
    }
}

/// How fast a joint moves for its driver's rate 1: the product of the multipliers on the way.
fn factor(plan: &Plan<'_>, joint: usize) -> String {
    let mut parts = Vec::new();
    let mut at = joint;
    while let (Some(next), Some(mimic)) = (plan.mimics[at], &plan.robot.joints[at].mimic) {
        parts.push(plan.joints[at].mimic[0].clone().unwrap_or_else(|| factor_text(mimic.multiplier)));
        at = next;
    }
    parts.join("*")
}

fn factor_text(multiplier: f64) -> String {
    if multiplier < 0.0 { format!("({})", number(multiplier)) } else { number(multiplier) }
}
