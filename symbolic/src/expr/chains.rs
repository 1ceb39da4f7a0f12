//! Sums and products taken apart: which nodes are needed as such, and which only inside of longer chains.

use std::hash::Hash;

use rustc_hash::FxHashMap as HashMap;

use super::places::Places;
use super::{Graph, Id};

/// Parts of all chains together beyond which a chain is not taken apart further than to chains that are needed as such:
/// running sums of n terms have n²/2.
const FLATTENED: usize = 300_000;

/// One kind of chain: sums or products.
pub(super) trait Chain {
    /// A part with what it is multiplied by, or raised to.
    type Part;

    /// Whether a node is such a chain.
    fn is(graph: &Graph, id: Id) -> bool;

    /// Its parts in the order of the arena; nodes of which `whole` is true are parts as they are.
    fn parts(graph: &Graph, root: Id, whole: &dyn Fn(Id) -> bool) -> Vec<Self::Part>;

    /// What a part is made of.
    fn id(part: &Self::Part) -> Id;
}

/// What is needed as such, and how far chains are taken apart.
pub(super) struct Chains {
    needed: Places,
    /// Roots, and children of anything but a chain, and parts of chains.
    wanted: Vec<bool>,
    /// Chains that are taken apart as far as to others that are wanted.
    shallow: Vec<bool>,
}

impl Chains {
    pub fn of<C: Chain>(graph: &Graph, roots: &[Id]) -> Chains {
        let needed = Places::new(graph.needed(roots.iter().copied()));
        let count = needed.list().len();
        let mut chains = Chains { needed, wanted: vec![false; count], shallow: vec![false; count] };
        for root in roots {
            let place = chains.needed.of(*root);
            chains.wanted[place] = true;
        }
        let mut total = 0;
        for i in (0..count).rev() {
            if !chains.wanted[i] {
                continue;
            }
            let id = chains.needed.list()[i];
            let parts: Vec<Id> = if C::is(graph, id) {
                chains.shallow[i] = total > FLATTENED;
                chains.parts::<C>(graph, i).iter().map(C::id).collect()
            } else {
                graph.children(id).collect()
            };
            total += parts.len();
            for part in parts {
                // A constant counts as a multiple of 1, which may stand nowhere else.
                if let Some(place) = chains.needed.find(part) {
                    chains.wanted[place] = true;
                }
            }
        }
        chains
    }

    /// The nodes that are needed as such, with their places, children before parents.
    pub fn wanted(&self) -> impl Iterator<Item = (usize, Id)> {
        self.needed.list().iter().copied().enumerate().filter(|(i, _)| self.wanted[*i])
    }

    /// The parts of the chain at a place.
    pub fn parts<C: Chain>(&self, graph: &Graph, i: usize) -> Vec<C::Part> {
        let whole = |id: Id| self.shallow[i] && self.needed.find(id).is_some_and(|place| self.wanted[place]);
        C::parts(graph, self.needed.list()[i], &whole)
    }

    /// In how many chains each part stands, told apart by a key.
    pub fn popularity<C: Chain, K: Hash + Eq>(&self, graph: &Graph, key: impl Fn(&C::Part) -> K) -> HashMap<K, u32> {
        let mut count = HashMap::default();
        for (i, _) in self.wanted().filter(|(_, id)| C::is(graph, *id)) {
            for part in self.parts::<C>(graph, i) {
                *count.entry(key(&part)).or_default() += 1;
            }
        }
        count
    }

    /// Rebuilds the roots: chains by `build`, which gets the parts and what has become of a node; the rest by its
    /// constructors.
    pub fn rebuild<C: Chain>(
        &self,
        graph: &mut Graph,
        roots: &[Id],
        mut build: impl FnMut(&mut Graph, Vec<C::Part>, &dyn Fn(Id) -> Id) -> Id,
    ) -> Vec<Id> {
        let mut image: Vec<Option<Id>> = vec![None; self.needed.list().len()];
        let of = |image: &[Option<Id>], x: Id| self.needed.find(x).and_then(|place| image[place]).unwrap_or(x);
        for (i, id) in self.wanted() {
            let parts = C::is(graph, id).then(|| self.parts::<C>(graph, i));
            let new = match parts {
                Some(parts) => build(graph, parts, &|x| of(&image, x)),
                None => graph.rebuilt(id, |x| of(&image, x)),
            };
            image[i] = Some(new);
        }
        roots.iter().map(|r| of(&image, *r)).collect()
    }
}
