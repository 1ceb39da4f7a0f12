//! Whether every joint moves something, so that the mass matrix has an inverse.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::model::principal_moments;

use super::inertia::{Composite, IDENTITY, Matrix, along, apply, times, turned};
use super::plan::Plan;
use super::problems;
use super::robot::{Kind, Pose};

/// Below this part of the largest a moment of inertia is rounding.
const ROUNDING: f64 = 1e-12;

/// Tells every joint that moves nothing, with all joints at zero.
pub fn check(plan: &Plan<'_>, problems: &mut Vec<Problem>) {
    let frames = frames(plan);
    let mut free = 0;
    for (at, joint) in plan.robot.joints.iter().enumerate() {
        if joint.kind == Kind::Planar && plan.plane(at).is_none() && joint.axis != [0.0; 3] {
            problems.push(problems::tilted_plane(joint.axis_place.clone(), joint.name));
        }
        if !plan.is_free(at) {
            continue;
        }
        free += 1;
        // What follows a joint is moved by it too; a joint that is followed is left to the joints' common inertia.
        if plan.is_geared(at) {
            continue;
        }
        let composite = composite(plan, &frames, at);
        let length = inertial_axis(&frames[plan.tree.ends[at][1]].0, joint.axis);
        let (moment, all) = (composite.about(length), largest(&composite.tensor));
        let turns = moment > ROUNDING * all;
        let missing = match joint.kind {
            Kind::Turn if !turns => Some("a moment of inertia about its axis"),
            Kind::Slide | Kind::Planar | Kind::Floating if composite.mass == 0.0 => Some("mass"),
            Kind::Planar if !turns => Some("a moment of inertia about its axis"),
            Kind::Floating if !solid(&centred(plan, &frames, at)) => Some("a moment of inertia about every axis"),
            _ => None,
        };
        problems.extend(missing.map(|what| problems::nothing_moved(joint.place.clone(), joint.name, what)));
    }
    if free == 0 {
        problems.push(problems::nothing_moves(plan.robot.place.clone()));
    }
}

fn largest(tensor: &Matrix) -> f64 {
    (0..3).map(|k| tensor[k][k]).fold(0.0, f64::max)
}

fn solid(composite: &Composite) -> bool {
    let [least, _, most] = principal_moments(&composite.tensor.concat());
    least > ROUNDING * most
}

fn inertial_axis(turn: &Matrix, axis: [f64; 3]) -> [f64; 3] {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    apply(turn, axis.map(|part| part / if length > 0.0 { length } else { 1.0 }))
}

/// How each link is turned and where it is, all joints at zero.
fn frames(plan: &Plan<'_>) -> Vec<(Matrix, [f64; 3])> {
    let mut frames = vec![(IDENTITY, [0.0; 3]); plan.robot.links.len()];
    for joint in &plan.tree.order {
        let [parent, child] = plan.tree.ends[*joint];
        frames[child] = placed(&frames[parent], &plan.robot.joints[*joint].pose);
    }
    frames
}

fn placed((turn, at): &(Matrix, [f64; 3]), pose: &Pose) -> (Matrix, [f64; 3]) {
    let step = apply(turn, pose.xyz);
    (times(turn, &turned(pose.rpy)), std::array::from_fn(|k| at[k] + step[k]))
}

/// All that a joint moves, about its origin.
fn composite(plan: &Plan<'_>, frames: &[(Matrix, [f64; 3])], joint: usize) -> Composite {
    about(plan, frames, joint, frames[plan.tree.ends[joint][1]].1)
}

/// The same about its centre of mass.
fn centred(plan: &Plan<'_>, frames: &[(Matrix, [f64; 3])], joint: usize) -> Composite {
    let (mut mass, mut moment) = (0.0, [0.0; 3]);
    for link in plan.tree.moved(joint) {
        let Some(inertial) = &plan.robot.links[link].inertial else { continue };
        let at = placed(&frames[link], &inertial.pose).1;
        mass += inertial.mass;
        moment = std::array::from_fn(|k| moment[k] + inertial.mass * at[k]);
    }
    about(plan, frames, joint, moment.map(|part| if mass > 0.0 { part / mass } else { 0.0 }))
}

fn about(plan: &Plan<'_>, frames: &[(Matrix, [f64; 3])], joint: usize, point: [f64; 3]) -> Composite {
    let mut all = Composite::default();
    for link in plan.tree.moved(joint) {
        let Some(inertial) = &plan.robot.links[link].inertial else { continue };
        let (turn, at) = placed(&frames[link], &inertial.pose);
        all.add(inertial.mass, std::array::from_fn(|k| at[k] - point[k]), &along(&turn, &inertial.tensor));
    }
    all
}
