//! What a link looks like: simple solids, and meshes by reference.

use dalembert_symbolic::diagnose::Problem;
use roxmltree::Node;

use super::problems;
use super::robot::{Pose, pose};
use super::xml::{child, number_of, numbers, place, place_of};

/// A solid, lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape<'a> {
    /// Its edges along x, y and z.
    Box([f64; 3]),
    /// Along z.
    Cylinder { radius: f64, length: f64 },
    /// By its radius.
    Sphere(f64),
    /// A file.
    Mesh(&'a str),
}

/// A shape and where it is in its link.
#[derive(Clone, Copy, Debug)]
pub struct Visual<'a> {
    pub pose: Pose,
    pub shape: Shape<'a>,
}

impl Visual<'_> {
    /// Whether it is drawn at some distance from its link's origin.
    pub fn is_apart(&self) -> bool {
        match self.shape {
            Shape::Mesh(_) => false,
            Shape::Cylinder { .. } => true,
            Shape::Box(_) | Shape::Sphere(_) => self.pose.xyz != [0.0; 3],
        }
    }
}

/// All of a link.
pub fn visuals<'a>(link: Node<'a, '_>, problems: &mut Vec<Problem>) -> Vec<Visual<'a>> {
    let mut found = Vec::new();
    for node in link.children().filter(|node| node.has_tag_name("visual")) {
        let pose = pose(node, problems);
        let shape = child(node, "geometry").and_then(|geometry| shape(geometry, problems));
        found.extend(shape.map(|shape| Visual { pose, shape }));
    }
    found
}

fn shape<'a>(geometry: Node<'a, '_>, problems: &mut Vec<Problem>) -> Option<Shape<'a>> {
    let node = geometry.children().find(Node::is_element)?;
    match node.tag_name().name() {
        "box" => {
            let size = numbers::<3>(node, "size", problems)?;
            size.iter().all(|edge| *edge > 0.0).then_some(Shape::Box(size)).or_else(|| {
                let help = "three lengths in m, `<box size=\"0.2 0.1 0.05\"/>`";
                problems.push(problems::out_of_range(place_of(node, "size"), "an edge of this box", "above 0", help));
                None
            })
        }
        "cylinder" => {
            let radius = length(node, "radius", problems)?;
            Some(Shape::Cylinder { radius, length: length(node, "length", problems)? })
        }
        "sphere" => Some(Shape::Sphere(length(node, "radius", problems)?)),
        "mesh" => Some(Shape::Mesh(node.attribute("filename").unwrap_or("?"))),
        _ => None,
    }
}

fn length(node: Node<'_, '_>, name: &str, problems: &mut Vec<Problem>) -> Option<f64> {
    if node.attribute(name).is_none() {
        let of = format!("this `{}`", node.tag_name().name());
        problems.push(problems::missing(place(node), &of, name, &format!("write `{name}=\"0.1\"`, in m")));
    }
    let value = number_of(node, name, problems)?;
    if value > 0.0 {
        return Some(value);
    }
    problems.push(problems::out_of_range(place_of(node, name), &format!("`{name}`"), "above 0", "a length in m"));
    None
}
