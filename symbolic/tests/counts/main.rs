//! Operation counts of the n-link chain are held by `docs/counts.md`.

mod table;

#[test]
fn counts_are_those_of_the_table() {
    let now = table::table();
    let held = include_str!("../../../docs/counts.md");
    assert_eq!(now, held, "counts have changed; if that is meant, regenerate docs/counts.md");
}

#[test]
fn growth_stays_below_the_bounds() {
    let text = table::table();
    let exponents: Vec<f64> = text
        .lines()
        .filter_map(|line| line.strip_prefix("Growth exponents from n = 20 to 40: M and h "))
        .flat_map(|line| line.trim_end_matches('.').split(", h ").map(|x| x.parse().unwrap()).collect::<Vec<f64>>())
        .collect();
    for pair in exponents.chunks_exact(2) {
        assert!(pair[0] < 2.0 && (0.9..1.1).contains(&pair[1]), "{exponents:?}");
    }
    assert_eq!(exponents.len(), 4);
}
