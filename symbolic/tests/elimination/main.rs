//! Operations of accelerations by elimination are held by `docs/elimination.md`, and grow with the number of links.

mod models;
mod table;

#[test]
fn operations_are_those_of_the_page() {
    let held = include_str!("../../../docs/elimination.md");
    assert_eq!(table::page(), held, "operations have changed; if that is meant, regenerate docs/elimination.md");
}

/// Every link costs what the one before cost, but for an operation where factors of products stand in another order.
#[test]
fn operations_a_link_are_constant() {
    // Beyond the number of coordinates up to which all candidates are compared.
    let chains = [models::ABSOLUTE, models::RELATIVE, models::CART, models::TURNTABLE, models::ENERGIES];
    for (text, most) in chains.into_iter().zip([70, 92, 70, 86, 78]).chain([(models::SPHERICAL, 190)]) {
        let [short, middle, long] = [20, 24, 28].map(|n| table::operations(text, n).0);
        assert!((long - middle).abs_diff(middle - short) <= 4, "{} {short} {middle} {long}", &text[..20]);
        assert!(middle - short <= 4 * most, "{} {}", &text[..20], middle - short);
    }
}

/// With constraints, too.
#[test]
fn operations_a_loop_are_constant() {
    for (text, most) in [(models::HINGES, 100), (models::FOUR_BARS, 280)] {
        let [short, middle, long] = [4, 6, 8].map(|n| table::operations(text, n).0);
        assert!((long - middle).abs_diff(middle - short) <= 4, "{} {short} {middle} {long}", &text[..20]);
        assert!(middle - short <= 2 * most, "{} {}", &text[..20], middle - short);
    }
}
