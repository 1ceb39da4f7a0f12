//! What each link and joint is called in the file that is written.

use dalembert_symbolic::diagnose::Problem;

use super::names::{Names, identifier};
use super::robot::{Joint, Kind, Link, Robot};
use super::shape::{Shape, Visual};
use super::text;
use super::tree::{Tree, driver, mimics};

/// The names of a joint.
#[derive(Debug, Default)]
pub struct JointNames {
    /// Its coordinate, or the definition that stands in its place where it mimics; of a planar joint its angle, of a floating one its
    /// rotation.
    pub coordinate: String,
    /// Displacements of a planar (two) or floating joint (three).
    pub slides: Vec<String>,
    /// Of its origin in the parent link.
    pub offsets: [Option<String>; 3],
    /// The frame of its origin, where that is turned and neither parent nor child has it.
    pub mount: Option<String>,
    /// Parameters of what it mimics that have a unit: multiplier, offset.
    pub mimic: [Option<String>; 2],
}

/// The names of a link.
#[derive(Debug, Default)]
pub struct LinkNames {
    pub frame: String,
    pub origin: String,
    /// Where it has mass, or something acts on it.
    pub body: Option<String>,
    pub mass: String,
    /// Of its centre of mass, from its origin along its frame.
    pub centre: [Option<String>; 3],
}

/// A robot whose joints are in order, with the names that it gets.
pub struct Plan<'a> {
    pub robot: &'a Robot<'a>,
    pub tree: &'a Tree,
    /// Of each joint which one it follows.
    pub mimics: Vec<Option<usize>>,
    pub gravity: String,
    /// A length of 1 m, by which `draw` makes lengths of numbers; empty where nothing needs one.
    pub metre: String,
    pub joints: Vec<JointNames>,
    pub links: Vec<LinkNames>,
    /// Of each link the frames of its solids that are turned against it.
    pub visuals: Vec<Vec<Option<String>>>,
    pub names: Names,
}

impl<'a> Plan<'a> {
    /// Names everything.
    pub fn new(robot: &'a Robot<'a>, tree: &'a Tree, problems: &mut Vec<Problem>) -> Plan<'a> {
        let mut plan = Plan {
            robot,
            tree,
            mimics: mimics(robot, problems),
            gravity: String::new(),
            metre: String::new(),
            joints: Vec::new(),
            links: Vec::new(),
            visuals: Vec::new(),
            names: Names::default(),
        };
        plan.gravity = plan.names.fresh("g", "gravity");
        if robot.links.iter().flat_map(|link| &link.visuals).any(Visual::is_apart) {
            plan.metre = plan.names.fresh("metre", "drawn");
        }
        plan.joints = robot
            .joints
            .iter()
            .map(|joint| JointNames { coordinate: plan.coordinate(joint), ..JointNames::default() })
            .collect();
        let bodies: Vec<bool> = (0..robot.links.len()).map(|link| plan.is_body(link)).collect();
        plan.links =
            robot.links.iter().zip(bodies).map(|(link, body)| link_names(&mut plan.names, link, body)).collect();
        for joint in 0..robot.joints.len() {
            plan.name_parts(joint);
        }
        plan.frames();
        plan.visuals = robot.links.iter().map(|link| solid_frames(&mut plan.names, link)).collect();
        plan
    }

    fn coordinate(&mut self, joint: &Joint<'_>) -> String {
        let base = identifier(joint.name);
        match joint.kind {
            Kind::Fixed => String::new(),
            Kind::Turn | Kind::Slide => self.names.fresh(&base, "joint"),
            Kind::Floating => self.names.fresh(&format!("{base}_attitude"), "joint"),
            Kind::Planar => self.names.fresh(&format!("{base}_turn"), "joint"),
        }
    }

    /// Whether a link is a body: it has mass or inertia, or a damper or a gear acts on it.
    fn is_body(&self, link: usize) -> bool {
        let inertial = self.robot.links[link].inertial.as_ref();
        let heavy = inertial.is_some_and(|inertial| inertial.mass != 0.0 || inertial.tensor.iter().any(|x| *x != 0.0));
        let acts = |joint: usize| self.robot.joints[joint].damping != 0.0 || self.is_geared(joint);
        let touched = self.tree.above[link].is_some_and(acts) || self.tree.below(link).any(acts);
        link != self.tree.root && (heavy || touched)
    }

    /// Whether a joint follows another one, or another one follows it.
    pub fn is_geared(&self, joint: usize) -> bool {
        self.mimics[joint].is_some() || self.mimics.contains(&Some(joint))
    }

    /// The joint that moves by itself and takes this one along.
    pub fn driver(&self, joint: usize) -> usize {
        driver(&self.mimics, joint).unwrap_or(joint)
    }

    /// Whether a joint has a coordinate of its own.
    pub fn is_free(&self, joint: usize) -> bool {
        self.robot.joints[joint].kind != Kind::Fixed && self.mimics[joint].is_none()
    }

    fn name_parts(&mut self, at: usize) {
        let joint = &self.robot.joints[at];
        let base = identifier(joint.name);
        let offset = |names: &mut Names, k: usize| {
            (joint.pose.xyz[k] != 0.0).then(|| names.fresh(&format!("{base}_d{}", text::NAMES[k]), "joint"))
        };
        let offsets = std::array::from_fn(|k| offset(&mut self.names, k));
        let slides = match joint.kind {
            Kind::Planar => 2,
            Kind::Floating => 3,
            _ => 0,
        };
        let slides = (0..slides).map(|k| self.names.fresh(&format!("{base}_{}", text::NAMES[k]), "joint")).collect();
        let mimic = self.mimic_parameters(at, &base);
        let names = &mut self.joints[at];
        (names.offsets, names.slides, names.mimic) = (offsets, slides, mimic);
    }

    /// A multiplier between an angle and a length, and an offset that is a length, have units.
    fn mimic_parameters(&mut self, at: usize, base: &str) -> [Option<String>; 2] {
        let joint = &self.robot.joints[at];
        let (Some(other), Some(mimic)) = (self.mimics[at], &joint.mimic) else { return [None, None] };
        let ratio =
            (self.robot.joints[other].kind != joint.kind).then(|| self.names.fresh(&format!("{base}_ratio"), "joint"));
        let shift = (joint.kind == Kind::Slide && mimic.offset != 0.0)
            .then(|| self.names.fresh(&format!("{base}_offset"), "joint"));
        [ratio, shift]
    }

    /// Frames of links: that of the parent where nothing turns a link against it.
    fn frames(&mut self) {
        self.links[self.tree.root].frame = "ground".to_owned();
        for at in self.tree.order.clone() {
            let [parent, child] = self.tree.ends[at];
            let joint = &self.robot.joints[at];
            let turned = joint.pose.rpy != [0.0; 3];
            if matches!(joint.kind, Kind::Planar | Kind::Floating) && turned {
                self.joints[at].mount = Some(self.names.fresh(&format!("{}_mount", identifier(joint.name)), "joint"));
            }
            let frame = match joint.kind {
                Kind::Fixed | Kind::Slide if !turned => self.links[parent].frame.clone(),
                _ => self.names.fresh(&format!("{}_axes", identifier(self.robot.links[child].name)), "link"),
            };
            self.links[child].frame = frame;
        }
    }

    /// The frame of a joint's origin: along it a planar or floating joint moves.
    pub fn base(&self, joint: usize) -> &str {
        self.joints[joint].mount.as_ref().unwrap_or(&self.links[self.tree.ends[joint][0]].frame)
    }

    /// The directions in which a planar joint slides, right-handed with its axis.
    pub fn plane(&self, joint: usize) -> Option<[[f64; 3]; 2]> {
        let (axis, negative) = text::single(self.robot.joints[joint].axis)?;
        let unit = |k: usize| std::array::from_fn(|i| if i == k % 3 { 1.0 } else { 0.0 });
        let [first, second] = [unit(axis + 1), unit(axis + 2)];
        Some(if negative { [second, first] } else { [first, second] })
    }

    /// The bodies that a joint moves.
    pub fn moved(&self, joint: usize) -> Vec<&str> {
        self.tree.moved(joint).filter_map(|link| self.links[link].body.as_deref()).collect()
    }
}

/// A box whose edges are not along its link's axes has a frame of its own; other solids need none.
fn solid_frames(names: &mut Names, link: &Link<'_>) -> Vec<Option<String>> {
    let needs = |visual: &Visual<'_>| matches!(visual.shape, Shape::Box(_)) && visual.pose.rpy != [0.0; 3];
    let mut name = || names.fresh(&format!("{}_solid", identifier(link.name)), "box");
    link.visuals.iter().map(|visual| needs(visual).then(&mut name)).collect()
}

fn link_names(names: &mut Names, link: &Link<'_>, is_body: bool) -> LinkNames {
    let base = identifier(link.name);
    let body = is_body.then(|| names.fresh(&base, "link"));
    let origin = names.fresh(&format!("{base}_origin"), "link");
    let mut named = LinkNames { origin, body, ..LinkNames::default() };
    if let (true, Some(inertial)) = (is_body, &link.inertial) {
        if inertial.mass != 0.0 {
            named.mass = names.fresh(&format!("m_{base}"), "link");
        }
        named.centre = std::array::from_fn(|k| {
            (inertial.pose.xyz[k] != 0.0).then(|| names.fresh(&format!("{base}_c{}", text::NAMES[k]), "link"))
        });
    }
    named
}
