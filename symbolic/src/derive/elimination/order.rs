//! In which order variables are eliminated.

use std::cmp::Reverse;
use std::collections::BTreeSet;

use super::forms::Forms;

/// A rule for the next variable, among those that no kept variable is made of any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// The one that couples the fewest others anew.
    Fill,
    /// The outermost coordinate, and before it no more than the kept variables that are made of it.
    Outermost,
    /// The one on which the fewest bodies depend.
    Bodies,
}

/// Every rule; none is best for all mechanisms.
pub(crate) const RULES: [Rule; 3] = [Rule::Fill, Rule::Outermost, Rule::Bodies];

/// A variable that is coupled with so many others takes some 300 operations, and a loop over M is shorter code than that for all of
/// them.  Bars on universal joints in ground axes have 11.
const LONGEST_FRONT: usize = 16;

/// An order with the couplings that it makes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Order {
    /// All variables.
    pub variables: Vec<usize>,
    /// The largest front: how many others a variable is coupled with when it is eliminated.
    pub front: usize,
}

/// Which variables stand in one product.
pub(crate) struct Interaction {
    coupled: Vec<BTreeSet<usize>>,
    /// Kept variables that each is made of.
    made_of: Vec<Vec<usize>>,
    /// How many kept variables each one stands in.
    stands_in: Vec<usize>,
    /// How deep each is defined: 0 for a kept variable of coordinates alone, one more than what it is made of for others.
    level: Vec<usize>,
    /// How many bodies depend on each.
    bodies: Vec<usize>,
    n: usize,
}

impl Interaction {
    /// One clique for each product, one for each kept variable with what it is made of.
    pub fn of(forms: &Forms) -> Interaction {
        let count = forms.variables();
        let mut coupled = vec![BTreeSet::new(); count];
        let mut clique = |members: &[usize]| {
            for &i in members {
                coupled[i].extend(members.iter().copied().filter(|j| *j != i));
            }
        };
        for (_, u, v) in &forms.products {
            let members: Vec<usize> = u.iter().chain(v).map(|term| term.0).collect();
            clique(&members);
        }
        let mut made_of: Vec<Vec<usize>> = vec![Vec::new(); count];
        let mut stands_in = vec![0; count];
        let mut level = vec![0; count];
        for (place, form) in forms.kept.iter().enumerate() {
            let own = forms.n + place;
            made_of[own] = form.iter().map(|term| term.0).collect();
            clique(&[made_of[own].as_slice(), &[own]].concat());
            made_of[own].iter().for_each(|part| stands_in[*part] += 1);
            level[own] = 1 + made_of[own].iter().map(|part| level[*part]).max().unwrap_or(0);
        }
        // A coordinate is as deep as the first that is made of it.
        for leaf in 0..forms.n {
            let users = (forms.n..count).filter(|own| made_of[*own].contains(&leaf));
            level[leaf] = users.map(|own| level[own]).min().unwrap_or(usize::MAX);
        }
        Interaction { coupled, made_of, stands_in, level, bodies: dependent(forms), n: forms.n }
    }

    /// The order by one rule; `None` where a front is longer than [`LONGEST_FRONT`].
    pub fn order(&self, rule: Rule) -> Option<Order> {
        let mut left = Left { coupled: self.coupled.clone(), order: Order::default() };
        match rule {
            Rule::Outermost => self.outermost(&mut left)?,
            Rule::Fill | Rule::Bodies => self.greedy(rule, &mut left)?,
        }
        Some(left.order)
    }

    fn outermost(&self, left: &mut Left) -> Option<()> {
        let mut leaves: Vec<usize> = (0..self.n).collect();
        leaves.sort_by_key(|leaf| (Reverse(self.level[*leaf]), Reverse(*leaf)));
        let mut done = vec![false; self.coupled.len()];
        for leaf in leaves {
            // What is made of it: kept variables come after what they are made of.
            let mut of_leaf = vec![leaf];
            let mut found = vec![false; self.coupled.len()];
            found[leaf] = true;
            for own in self.n..self.coupled.len() {
                if !done[own] && self.made_of[own].iter().any(|part| found[*part]) {
                    found[own] = true;
                    of_leaf.push(own);
                }
            }
            for v in of_leaf.into_iter().rev() {
                done[v] = true;
                left.eliminate(v)?;
            }
        }
        Some(())
    }

    fn greedy(&self, rule: Rule, left: &mut Left) -> Option<()> {
        let mut stands_in = self.stands_in.clone();
        let mut keys: Vec<Option<Key>> = vec![None; self.coupled.len()];
        let mut open: BTreeSet<(Key, usize)> = BTreeSet::new();
        for v in (0..keys.len()).filter(|v| stands_in[*v] == 0) {
            let key = self.key(rule, &left.coupled, v);
            keys[v] = Some(key);
            open.insert((key, v));
        }
        while let Some((_, v)) = open.pop_first() {
            keys[v] = None;
            let neighbours = left.eliminate(v)?;
            for &part in &self.made_of[v] {
                stands_in[part] -= 1;
            }
            // What has had a coupling of its neighbours changed.
            let mut changed: BTreeSet<usize> = neighbours.clone();
            changed.extend(neighbours.iter().flat_map(|i| left.coupled[*i].iter().copied()));
            changed.extend(&self.made_of[v]);
            for u in changed.into_iter().filter(|u| stands_in[*u] == 0) {
                if let Some(old) = keys[u] {
                    open.remove(&(old, u));
                }
                let key = self.key(rule, &left.coupled, u);
                keys[u] = Some(key);
                open.insert((key, u));
            }
        }
        Some(())
    }

    fn key(&self, rule: Rule, coupled: &[BTreeSet<usize>], v: usize) -> Key {
        let neighbours = &coupled[v];
        let degree = neighbours.len();
        let known: usize = neighbours.iter().map(|i| coupled[*i].intersection(neighbours).count()).sum();
        let fill = degree * degree.saturating_sub(1) / 2 - known / 2;
        let (kept, deep) = (usize::from(v >= self.n), Reverse(self.level[v]));
        match rule {
            Rule::Bodies => ([self.bodies[v], kept, fill], deep),
            Rule::Fill | Rule::Outermost => ([fill, degree, kept], deep),
        }
    }
}

/// What is left to eliminate, and what was.
struct Left {
    coupled: Vec<BTreeSet<usize>>,
    order: Order,
}

impl Left {
    /// Couples the neighbours of a variable with each other; `None` where these are too many.
    fn eliminate(&mut self, v: usize) -> Option<BTreeSet<usize>> {
        let neighbours = std::mem::take(&mut self.coupled[v]);
        let degree = neighbours.len();
        self.order.variables.push(v);
        self.order.front = self.order.front.max(degree);
        if degree > LONGEST_FRONT {
            return None;
        }
        for &i in &neighbours {
            self.coupled[i].remove(&v);
            self.coupled[i].extend(neighbours.iter().copied().filter(|j| *j != i));
        }
        Some(neighbours)
    }
}

/// How many bodies (or products of a written energy) depend on each variable, by way of kept ones too.
fn dependent(forms: &Forms) -> Vec<usize> {
    let count = forms.variables();
    let words = forms.bodies.iter().max().map_or(0, |last| last / 64 + 1);
    let mut sets = vec![vec![0_u64; words]; count];
    for ((_, u, v), body) in forms.products.iter().zip(&forms.bodies) {
        u.iter().chain(v).for_each(|term| sets[term.0][body / 64] |= 1 << (body % 64));
    }
    for own in (forms.n..count).rev() {
        let bodies = std::mem::take(&mut sets[own]);
        for (part, _) in &forms.kept[own - forms.n] {
            sets[*part].iter_mut().zip(&bodies).for_each(|(set, more)| *set |= more);
        }
        sets[own] = bodies;
    }
    sets.iter().map(|set| set.iter().map(|word| word.count_ones() as usize).sum()).collect()
}

type Key = ([usize; 3], Reverse<usize>);
