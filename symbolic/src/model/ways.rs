//! Vectors as they are written along the axes of frames.
//!
//! All vectors of a model are components in ground axes.  Of one that is written along the axes of frames, `elbow + l*B.z`, this remembers its
//! components there, so that equations can be formed in these axes, in which they are shorter.

use std::rc::Rc;

use rustc_hash::FxHashMap as HashMap;

use super::rotation::{Orientation, Stage, UNTURNED};
use crate::expr::{Graph, Id};

/// A part of a vector: its components along the axes of a frame, after its turns from the ground on.
#[derive(Clone, Debug, PartialEq)]
struct Part {
    stages: Rc<Vec<Stage>>,
    components: [Id; 3],
}

/// What vectors were written along, by their components in ground axes: those of one value are one vector.
#[derive(Debug, Default)]
pub struct WrittenAlong {
    known: HashMap<[Id; 3], Vec<Part>>,
}

/// A way from the origin in pieces, each along the axes after some of the turns of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ways {
    /// The turns, from the ground on.
    pub stages: Vec<Stage>,
    /// After how many of them, and the piece there; in order.
    pub pieces: Vec<(usize, [Id; 3])>,
}

impl WrittenAlong {
    /// A unit vector of a frame.
    pub fn axis(&mut self, frame: &Orientation, k: usize) {
        if !frame.stages.is_empty() {
            let part = Part { stages: Rc::new(frame.stages.clone()), components: UNTURNED[k] };
            self.known.insert(frame.axes[k], vec![part]);
        }
    }

    /// A sum, or a difference, of two vectors.
    pub fn sum(&mut self, graph: &mut Graph, [a, b, sum]: [&[Id]; 3], subtract: bool) {
        let (Some(mut parts), Some(more), &[x, y, z]) = (self.parts(a), self.parts(b), sum) else { return };
        for part in more {
            let join = |graph: &mut Graph, x, y| if subtract { graph.sub(x, y) } else { graph.add(x, y) };
            match parts.iter_mut().find(|other| other.stages == part.stages) {
                Some(same) => {
                    let pairs = same.components.iter_mut().zip(part.components);
                    pairs.for_each(|(x, y)| *x = join(graph, *x, y));
                }
                None => {
                    let components = part.components.map(|y| join(graph, Id::ZERO, y));
                    parts.push(Part { components, ..part });
                }
            }
        }
        self.note([x, y, z], parts);
    }

    /// A vector, each component of which became another by the same linear function.
    pub fn mapped(&mut self, graph: &mut Graph, [from, to]: [&[Id]; 2], f: impl Fn(&mut Graph, Id) -> Id) {
        let (Some(parts), &[x, y, z]) = (self.parts(from), to) else { return };
        let mapped = |part: Part| Part { components: part.components.map(|x| f(graph, x)), ..part };
        let parts = parts.into_iter().map(mapped).collect();
        self.note([x, y, z], parts);
    }

    fn note(&mut self, vector: [Id; 3], mut parts: Vec<Part>) {
        parts.retain(|part| part.components != [Id::ZERO; 3]);
        if parts.iter().any(|part| !part.stages.is_empty()) {
            self.known.insert(vector, parts);
        }
    }

    /// The parts of a vector in space; in ground axes if nothing else is known.
    fn parts(&self, vector: &[Id]) -> Option<Vec<Part>> {
        let vector: [Id; 3] = vector.try_into().ok()?;
        let ground = || vec![Part { stages: Rc::default(), components: vector }];
        Some(self.known.get(&vector).cloned().unwrap_or_else(ground))
    }

    /// A place as a way; in ground axes where it is written along frames of which none is turned from all others.
    pub fn ways(&self, place: &[Id]) -> Ways {
        let mut parts = self.parts(place).unwrap_or_default();
        parts.sort_by_key(|part| part.stages.len());
        let stages = parts.last().map_or_else(Rc::default, |part| Rc::clone(&part.stages));
        if parts.iter().all(|part| stages.starts_with(&part.stages)) {
            let pieces = parts.into_iter().map(|part| (part.stages.len(), part.components)).collect();
            return Ways { stages: stages.to_vec(), pieces };
        }
        let ground = place.try_into().map(|place| (0, place));
        Ways { stages: Vec::new(), pieces: ground.into_iter().collect() }
    }
}

impl Ways {
    /// All expressions, in an order that [`Ways::map`] keeps.
    pub fn ids(&self) -> impl Iterator<Item = Id> + '_ {
        self.stages.iter().flat_map(Stage::ids).chain(self.pieces.iter().flat_map(|(_, piece)| piece.iter().copied()))
    }

    /// With every expression replaced.
    #[must_use]
    pub fn map(&self, mut f: impl FnMut(Id) -> Id) -> Ways {
        let stages = self.stages.iter().map(|stage| stage.map(&mut f)).collect();
        let pieces = self.pieces.iter().map(|(stage, piece)| (*stage, piece.map(&mut f))).collect();
        Ways { stages, pieces }
    }
}
