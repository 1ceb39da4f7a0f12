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
    /// Which others wait for each one: what a kept variable is made of, and the multipliers of the rows that a coordinate stands in, however
    /// many kept variables are between.
    holds_up: Vec<Vec<usize>>,
    /// How many others each one waits for.
    waits_for: Vec<usize>,
    /// What each kept variable is made of.
    made_of: Vec<Vec<usize>>,
    /// How deep each is defined: 0 for a kept variable of coordinates alone, one more than what it is made of for others.
    level: Vec<usize>,
    /// How many bodies depend on each.
    bodies: Vec<usize>,
    n: usize,
    /// The place of the first multiplier.
    first_multiplier: usize,
}

impl Interaction {
    /// One clique for each product, one for each kept variable with what it is made of; each multiplier with what its row is made of.
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
        let mut level = vec![0; count];
        for (place, form) in forms.kept.iter().enumerate() {
            let own = forms.n + place;
            made_of[own] = form.iter().map(|term| term.0).collect();
            clique(&[made_of[own].as_slice(), &[own]].concat());
            level[own] = 1 + made_of[own].iter().map(|part| level[*part]).max().unwrap_or(0);
        }
        let first_multiplier = forms.first_multiplier();
        for (row, (form, _)) in forms.rows.iter().enumerate() {
            form.iter().for_each(|(part, _)| clique(&[*part, first_multiplier + row]));
        }
        let holds_up = holds_up(forms, &made_of);
        let mut waits_for = vec![0; count];
        holds_up.iter().flatten().for_each(|waiting| waits_for[*waiting] += 1);
        // A coordinate is as deep as the first that is made of it.
        for leaf in 0..forms.n {
            let users = (forms.n..first_multiplier).filter(|own| made_of[*own].contains(&leaf));
            level[leaf] = users.map(|own| level[own]).min().unwrap_or(usize::MAX);
        }
        let bodies = dependent(forms);
        Interaction { coupled, holds_up, waits_for, made_of, level, bodies, n: forms.n, first_multiplier }
    }

    /// The order by one rule; `None` where a front is longer than [`LONGEST_FRONT`].
    pub fn order(&self, rule: Rule) -> Option<Order> {
        let (coupled, waits_for) = (self.coupled.clone(), self.waits_for.clone());
        let mut left = Left { coupled, waits_for, order: Order::default() };
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
            for own in self.n..self.first_multiplier {
                if !done[own] && self.made_of[own].iter().any(|part| found[*part]) {
                    found[own] = true;
                    of_leaf.push(own);
                }
            }
            for v in of_leaf.into_iter().rev() {
                done[v] = true;
                self.eliminate(left, v)?;
            }
            for &multiplier in &self.holds_up[leaf] {
                if left.waits_for[multiplier] == 0 {
                    self.eliminate(left, multiplier)?;
                }
            }
        }
        Some(())
    }

    fn greedy(&self, rule: Rule, left: &mut Left) -> Option<()> {
        let mut keys: Vec<Option<Key>> = vec![None; self.coupled.len()];
        let mut open: BTreeSet<(Key, usize)> = BTreeSet::new();
        for v in (0..keys.len()).filter(|v| left.waits_for[*v] == 0) {
            let key = self.key(rule, &left.coupled, v);
            keys[v] = Some(key);
            open.insert((key, v));
        }
        while let Some((_, v)) = open.pop_first() {
            keys[v] = None;
            let neighbours = self.eliminate(left, v)?;
            // What has had a coupling of its neighbours changed.
            let mut changed: BTreeSet<usize> = neighbours.clone();
            changed.extend(neighbours.iter().flat_map(|i| left.coupled[*i].iter().copied()));
            changed.extend(&self.holds_up[v]);
            for u in changed.into_iter().filter(|u| left.waits_for[*u] == 0) {
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

    /// Eliminates a variable, for which others wait no longer.
    fn eliminate(&self, left: &mut Left, v: usize) -> Option<BTreeSet<usize>> {
        self.holds_up[v].iter().for_each(|waiting| left.waits_for[*waiting] -= 1);
        left.eliminate(v)
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
    /// How many of these each one waits for.
    waits_for: Vec<usize>,
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

/// Which variables wait for each one until it is eliminated.
fn holds_up(forms: &Forms, made_of: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut holds_up = made_of.to_vec();
    let (first, of_rows) = (forms.first_multiplier(), forms.made_of());
    for (row, coordinates) in of_rows[first..].iter().enumerate() {
        let coordinates = (0..forms.n).filter(|i| coordinates[i / 64] >> (i % 64) & 1 == 1);
        coordinates.for_each(|i| holds_up[i].push(first + row));
    }
    holds_up
}

/// How many bodies (or products of a written energy) depend on each variable, by way of kept ones too.
fn dependent(forms: &Forms) -> Vec<usize> {
    let count = forms.variables();
    let words = forms.bodies.iter().max().map_or(0, |last| last / 64 + 1);
    let mut sets = vec![vec![0_u64; words]; count];
    for ((_, u, v), body) in forms.products.iter().zip(&forms.bodies) {
        u.iter().chain(v).for_each(|term| sets[term.0][body / 64] |= 1 << (body % 64));
    }
    for own in (forms.n..forms.first_multiplier()).rev() {
        let bodies = std::mem::take(&mut sets[own]);
        for (part, _) in &forms.kept[own - forms.n] {
            sets[*part].iter_mut().zip(&bodies).for_each(|(set, more)| *set |= more);
        }
        sets[own] = bodies;
    }
    sets.iter().map(|set| set.iter().map(|word| word.count_ones() as usize).sum()).collect()
}

type Key = ([usize; 3], Reverse<usize>);
