use super::Eliminated;
use crate::derive::derive;
use crate::model::load;

#[path = "../../../tests/elimination/models.rs"]
#[allow(clippy::duplicate_mod, reason = "the tests of the choice use the same mechanisms")]
mod models;

fn of(text: &str, n: i64) -> Option<Eliminated> {
    derive(load(text, &[("n".to_owned(), n)]).unwrap()).unwrap().eliminated
}

/// A chain couples every two coordinates, a tree those that lie on one way to the root.
#[test]
fn couplings_are_the_entries_of_masses() {
    let chain = of(models::RELATIVE, 30).unwrap().least.1;
    assert_eq!(chain.couplings().iter().flatten().map(|word| word.count_ones()).sum::<u32>(), 30 * 29);
    assert_eq!(chain.least_factoring(), 30 + 30 * 29 + (15 * 29) * (15 * 29) / 30);
    assert_eq!(chain.blocks(), [30]);
    let tree = of(models::TREE, 1023).unwrap().least.1;
    let ancestors: u32 = (1..=1023_u32).map(|link| link.ilog2()).sum();
    assert_eq!(tree.couplings().iter().flatten().map(|word| word.count_ones()).sum::<u32>(), 2 * ancestors);
}

#[test]
fn masses_are_formed_where_they_are_small_or_constant_or_nothing_is_shared() {
    assert!(of(models::ABSOLUTE, 16).is_none() && of(models::ABSOLUTE, 20).is_some());
    // Sparse masses are factored in no time.
    assert!(of(models::TREE, 31).is_none());
    for more in ["\"x[i]\"", "\"sum(x[j], j in 1..i)\""] {
        let text = format!(
            "name: Line\nsizes: {{n: 50}}\nparameters: {{m: 1 kg}}\ncoordinates: {{\"x[i in 1..n]\": m}}\n\
             bodies: {{\"b[i in 1..n]\": {{mass: m, position: [{more}, 0]}}}}\n"
        );
        assert!(of(&text, 50).is_none(), "{more}");
    }
}
