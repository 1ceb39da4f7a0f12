//! Rooted trees, each of which stands for an order condition.
//!
//! Source: Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I (1993), section II.2.

/// A rooted tree: its subtrees.
#[derive(Clone, Debug, PartialEq, PartialOrd)]
pub(crate) struct Tree(pub Vec<Tree>);

impl Tree {
    /// How many nodes it has.
    pub fn order(&self) -> usize {
        1 + self.0.iter().map(Tree::order).sum::<usize>()
    }

    /// γ(t): the order times the γ of all subtrees.
    pub fn density(&self) -> i128 {
        self.order() as i128 * self.0.iter().map(Tree::density).product::<i128>()
    }
}

/// All rooted trees with exactly this many nodes.
pub(crate) fn trees(order: usize) -> Vec<Tree> {
    fn forests(nodes: usize, largest: usize, below: &[Vec<Tree>]) -> Vec<Vec<Tree>> {
        if nodes == 0 {
            return vec![Vec::new()];
        }
        let mut found = Vec::new();
        for size in 1..=nodes.min(largest) {
            for tree in &below[size] {
                for mut rest in forests(nodes - size, size, below) {
                    // Subtrees in order, so that each tree appears once.
                    if rest.first().is_none_or(|first: &Tree| first.order() < size || first <= tree) {
                        rest.insert(0, tree.clone());
                        found.push(rest);
                    }
                }
            }
        }
        found
    }
    let mut below: Vec<Vec<Tree>> = vec![Vec::new()];
    for nodes in 1..=order {
        let level = forests(nodes - 1, nodes - 1, &below).into_iter().map(Tree).collect();
        below.push(level);
    }
    below.swap_remove(order)
}

#[test]
fn there_are_as_many_trees_as_cayley_counted() {
    let counts: Vec<usize> = (1..=9).map(|order| trees(order).len()).collect();
    assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115, 286]);
}
