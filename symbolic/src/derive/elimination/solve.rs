//! One elimination: kept variables are put in, coordinates made to minimise, and the accelerations read backwards.
//!
//! A multiplier is eliminated as a coordinate is, where G + λ·(J q'' + γ) is stationary.  All coordinates of its row have been eliminated before,
//! so that its pivot is −J M⁻¹ Jᵀ of these coordinates, less what earlier rows take: negative wherever M is positive definite and the
//! rows are independent.

use std::collections::BTreeSet;

use rustc_hash::FxHashMap as HashMap;

use super::depth::Depths;
use super::forms::{Form, Forms};
use super::sums::Sum;
use crate::expr::{Graph, Id};

/// How products are written, which changes how long their chains are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Writing {
    /// (Aⱼᵥ Aᵥₖ)/Aᵥᵥ in the place of (Aⱼᵥ/Aᵥᵥ) Aᵥₖ: the division may come later.
    pub late_division: bool,
    /// cⱼ² a + 2 cⱼ b in the place of cⱼ (cⱼ a + 2 b).
    pub early_squares: bool,
}

/// Every way.
pub(crate) const WRITINGS: [Writing; 4] = [
    Writing { late_division: false, early_squares: false },
    Writing { late_division: false, early_squares: true },
    Writing { late_division: true, early_squares: false },
    Writing { late_division: true, early_squares: true },
];

/// Accelerations with what tests them.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    /// q''.
    pub values: Vec<Id>,
    /// Coordinate, pivot, and the part of M's diagonal that it must not be negligible against.
    pub pivots: Vec<(usize, Id, Id)>,
    /// λ of the constraints' rows.
    pub multipliers: Vec<Id>,
    /// For each row, how much its multiplier moves it, which is J M⁻¹ Jᵀ of what the rows before it leave; and J M⁻¹ Jᵀ without what these take.
    pub mobilities: Vec<(Id, Id)>,
}

impl Solution {
    /// All that is computed.
    pub fn roots(&self) -> Vec<Id> {
        let of_rows =
            self.multipliers.iter().copied().chain(self.mobilities.iter().flat_map(|(left, alone)| [*left, *alone]));
        roots(&self.values, &self.pivots).into_iter().chain(of_rows).collect()
    }

    /// With other expressions in the place of these.
    pub fn with(&self, roots: &[Id]) -> Solution {
        let (values, rest) = roots.split_at(self.values.len());
        let (tests, of_rows) = rest.split_at(2 * self.pivots.len());
        let pairs = self.pivots.iter().zip(tests.chunks_exact(2));
        let (multipliers, mobilities) = of_rows.split_at(self.multipliers.len());
        Solution {
            values: values.to_vec(),
            pivots: pairs.map(|((k, ..), pair)| (*k, pair[0], pair[1])).collect(),
            multipliers: multipliers.to_vec(),
            mobilities: mobilities.chunks_exact(2).map(|pair| (pair[0], pair[1])).collect(),
        }
    }
}

/// Accelerations, and what is computed to test the pivots.
pub(crate) fn roots(values: &[Id], pivots: &[(usize, Id, Id)]) -> Vec<Id> {
    values.iter().copied().chain(pivots.iter().flat_map(|(_, pivot, size)| [*pivot, *size])).collect()
}

/// A quadratic form ½ xᵀ A x + gᵀ x over all variables that are left.
struct Quadratic<'a> {
    graph: &'a mut Graph,
    depths: Depths,
    entries: HashMap<(usize, usize), Sum>,
    linear: Vec<Sum>,
    /// What A's diagonal would be without what was subtracted: the squares cⱼ² of masses alone, and J M⁻¹ Jᵀ of multipliers.
    sizes: Vec<Sum>,
    coupled: Vec<BTreeSet<usize>>,
    first_multiplier: usize,
}

/// How a variable that was eliminated follows from those that were not.
enum Followed {
    /// Σ cⱼ xⱼ.
    Made(Form),
    /// constant − Σ lₖ xₖ.
    Minimising(Id, Form),
}

/// In this order.
pub(crate) fn solve(graph: &mut Graph, forms: &Forms, order: &[usize], writing: Writing) -> Option<Solution> {
    let mut quadratic = Quadratic::of(graph, forms);
    let mut followed = Vec::with_capacity(order.len());
    let (first, mut pivots, mut mobilities) =
        (forms.first_multiplier(), Vec::new(), vec![(Id::ZERO, Id::ZERO); forms.rows.len()]);
    for &v in order.iter().filter(|v| !forms.is_length(**v)) {
        let rule = match v.checked_sub(forms.n).and_then(|place| forms.kept.get(place)) {
            Some(form) => {
                quadratic.put_in(v, form, writing);
                Followed::Made(form.clone())
            }
            None => {
                let (rule, pivot, size) = quadratic.minimise(v, writing)?;
                match v.checked_sub(first) {
                    Some(row) => mobilities[row] = (quadratic.graph.neg(pivot), size),
                    None => pivots.push((v, pivot, size)),
                }
                rule
            }
        };
        if quadratic.graph.overflowed() {
            return None;
        }
        followed.push((v, rule));
    }
    let mut depths = quadratic.depths;
    let mut values = vec![Id::ZERO; forms.variables()];
    for (v, rule) in followed.into_iter().rev() {
        let (mut sum, form) = match rule {
            Followed::Made(form) => (Sum::default(), form),
            Followed::Minimising(constant, form) => {
                let mut sum = Sum::default();
                sum.push(constant);
                (sum, form)
            }
        };
        for (j, c) in form {
            sum.push(depths.product(graph, c, values[j]));
        }
        values[v] = sum.read(graph, &mut depths);
    }
    // G + λ·(J q'' + γ) gives the multipliers of Jᵀ λ on the other side of the equations of motion.
    let multipliers = values[first..].iter().map(|value| graph.neg(*value)).collect();
    values.truncate(forms.n);
    for turning in &forms.turning {
        let own = &mut values[turning.first..turning.first + 4];
        let rate = [own[1], own[2], own[3]];
        own.copy_from_slice(&turning.acceleration(graph, rate));
    }
    Some(Solution { values, pivots, multipliers, mobilities })
}

impl<'a> Quadratic<'a> {
    fn of(graph: &'a mut Graph, forms: &Forms) -> Quadratic<'a> {
        let count = forms.variables();
        let mut new = Quadratic {
            graph,
            depths: Depths::default(),
            entries: HashMap::default(),
            linear: vec![Sum::default(); count],
            sizes: vec![Sum::default(); count],
            coupled: vec![BTreeSet::new(); count],
            first_multiplier: forms.first_multiplier(),
        };
        for (w, u, v) in &forms.products {
            for (place, &(i, c)) in u.iter().enumerate() {
                for &(j, d) in if u == v { &v[..=place] } else { v.as_slice() } {
                    let inner = new.times(d, *w);
                    let term = new.times(c, inner);
                    new.add(i, j, term);
                    // A product of two velocities has each square of one variable twice.
                    if i == j && u != v {
                        new.add(i, j, term);
                    }
                    if u == v && i == j {
                        new.sizes[i].push(term);
                    }
                }
            }
        }
        for (form, g) in &forms.linear {
            for &(j, c) in form {
                let term = new.times(c, *g);
                new.linear[j].push(term);
            }
        }
        for (i, h) in forms.forces.iter().enumerate() {
            new.linear[i].push(*h);
        }
        for (multiplier, (form, bias)) in (new.first_multiplier..).zip(&forms.rows) {
            form.iter().for_each(|(j, c)| new.add(*j, multiplier, *c));
            new.linear[multiplier].push(*bias);
        }
        new
    }

    fn times(&mut self, a: Id, b: Id) -> Id {
        self.depths.product(self.graph, a, b)
    }

    fn add(&mut self, i: usize, j: usize, term: Id) {
        if term == Id::ZERO {
            return;
        }
        self.entries.entry((i.max(j), i.min(j))).or_default().push(term);
        if i != j {
            self.coupled[i].insert(j);
            self.coupled[j].insert(i);
        }
    }

    fn take(&mut self, i: usize, j: usize) -> Id {
        let entry = self.entries.remove(&(i.max(j), i.min(j)));
        entry.map_or(Id::ZERO, |mut sum| sum.read(self.graph, &mut self.depths))
    }

    /// The row of a variable, taken out: its diagonal, and the others that are not 0.
    fn row(&mut self, v: usize) -> (Id, Vec<(usize, Id)>) {
        let diagonal = self.take(v, v);
        let others = std::mem::take(&mut self.coupled[v]);
        let mut row = Vec::with_capacity(others.len());
        for k in others {
            self.coupled[k].remove(&v);
            let entry = self.take(v, k);
            if entry != Id::ZERO {
                row.push((k, entry));
            }
        }
        (diagonal, row)
    }

    /// z = Σ cⱼ xⱼ: z² a + 2 z Σ bₖ xₖ + 2 g z becomes a form of the others.
    fn put_in(&mut self, z: usize, form: &Form, writing: Writing) {
        let (a, row) = self.row(z);
        let g = self.linear[z].read(self.graph, &mut self.depths);
        let size = self.sizes[z].read(self.graph, &mut self.depths);
        let coupling = |k: usize| row.iter().find(|entry| entry.0 == k).map_or(Id::ZERO, |entry| entry.1);
        for (place, &(j, c)) in form.iter().enumerate() {
            let b = coupling(j);
            let scaled = self.times(c, a);
            let partial = self.graph.add(scaled, b);
            for &(k, other) in row.iter().filter(|entry| form.iter().all(|term| term.0 != entry.0)) {
                let term = self.times(c, other);
                self.add(j, k, term);
            }
            for &(i, d) in &form[..place] {
                let (first, second) = (self.times(d, partial), self.times(c, coupling(i)));
                self.add(i, j, first);
                self.add(i, j, second);
            }
            if b == Id::ZERO || writing.early_squares {
                let square = self.times(c, scaled);
                let cross = self.times(c, b);
                self.add(j, j, square);
                self.add(j, j, cross);
                self.add(j, j, cross);
            } else {
                let both = self.graph.add(partial, b);
                let term = self.times(c, both);
                self.add(j, j, term);
            }
            let force = self.times(c, g);
            self.linear[j].push(force);
            let part = self.times(c, size);
            let part = self.times(c, part);
            self.sizes[j].push(part);
        }
    }

    /// ½ a v² + v Σ bₖ xₖ + g v is least (of a multiplier, stationary) for v = −(g + Σ bₖ xₖ)/a, and is −(g + Σ bₖ xₖ)²/(2 a) then.  `None` without a pivot.
    fn minimise(&mut self, v: usize, writing: Writing) -> Option<(Followed, Id, Id)> {
        let (a, row) = self.row(v);
        if a == Id::ZERO {
            return None;
        }
        let g = self.linear[v].read(self.graph, &mut self.depths);
        let size = self.sizes[v].read(self.graph, &mut self.depths);
        let of_coordinate = v < self.first_multiplier;
        let reciprocal = self.graph.div(Id::ONE, a);
        let factors: Vec<Id> = row.iter().map(|entry| self.times(entry.1, reciprocal)).collect();
        for (place, &(j, b)) in row.iter().enumerate() {
            for (&(k, other), &factor) in row[..=place].iter().zip(&factors) {
                let update = if writing.late_division && factors[place] != Id::ONE && factor != Id::ONE {
                    let product = self.times(b, other);
                    self.times(product, reciprocal)
                } else if factor == Id::ONE {
                    b
                } else {
                    self.times(factors[place], other)
                };
                if j == k && j >= self.first_multiplier && of_coordinate {
                    self.sizes[j].push(update);
                }
                let update = self.graph.neg(update);
                self.add(j, k, update);
            }
            let update = self.times(factors[place], g);
            let update = self.graph.neg(update);
            self.linear[j].push(update);
        }
        let constant = self.times(g, reciprocal);
        let constant = self.graph.neg(constant);
        let form = row.iter().zip(factors).map(|(entry, factor)| (entry.0, self.graph.neg(factor))).collect();
        Some((Followed::Minimising(constant, form), a, size))
    }
}
