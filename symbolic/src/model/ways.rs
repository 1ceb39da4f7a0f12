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

/// A way from the origin: the sum of these, in the order in which they are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ways(pub Vec<Way>);

/// Pieces, each along the axes after some of the turns of one frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Way {
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

    /// A place as a way: pieces along frames of which one is turned from the other stand together.
    pub fn ways(&self, place: &[Id]) -> Ways {
        let mut ways: Vec<Way> = Vec::new();
        for Part { stages, components } in self.parts(place).unwrap_or_default() {
            let together = |way: &&mut Way| way.stages.starts_with(&stages) || stages.starts_with(&way.stages);
            let piece = (stages.len(), components);
            match ways.iter_mut().find(together) {
                Some(way) => {
                    way.pieces.push(piece);
                    if stages.len() > way.stages.len() {
                        way.stages = stages.to_vec();
                    }
                }
                None => ways.push(Way { stages: stages.to_vec(), pieces: vec![piece] }),
            }
        }
        ways.iter_mut().for_each(|way| way.pieces.sort_by_key(|piece| piece.0));
        Ways(ways)
    }
}

impl Ways {
    /// All expressions, in an order that [`Ways::map`] keeps.
    pub fn ids(&self) -> impl Iterator<Item = Id> + '_ {
        self.0.iter().flat_map(|way| {
            let pieces = way.pieces.iter().flat_map(|(_, piece)| piece.iter().copied());
            way.stages.iter().flat_map(Stage::ids).chain(pieces)
        })
    }

    /// With every expression replaced.
    #[must_use]
    pub fn map(&self, mut f: impl FnMut(Id) -> Id) -> Ways {
        let way = |way: &Way| {
            let stages = way.stages.iter().map(|stage| stage.map(&mut f)).collect();
            let pieces = way.pieces.iter().map(|(stage, piece)| (*stage, piece.map(&mut f))).collect();
            Way { stages, pieces }
        };
        Ways(self.0.iter().map(way).collect())
    }
}
