//! Seeded faults: every model with balances or checks is spoilt in one derivation at a time, and must then be refused.

#[path = "table.rs"]
mod table;

#[test]
fn every_fault_that_changes_the_motion_is_refused() {
    let outcomes = table::plant_all();
    let now = table::page(&outcomes);
    println!("{now}");
    let wrong = table::wrong(&outcomes);
    assert!(wrong.is_empty(), "faults that were accepted, or sound models that were refused:\n{}", wrong.join("\n"));
    assert!(outcomes.len() > 1000, "only {} faults", outcomes.len());
    // The page's numbers go with the models; its parts and kinds of fault are held.
    let held = include_str!("../../../docs/faults.md");
    assert_eq!(frame(&now), frame(held), "regenerate docs/faults.md");
    for page in [now.as_str(), held] {
        assert!(page.contains("error[E502]") && page.contains("| 0 | 100.0 % |\n\nRefused by name"), "{page}");
    }
}

/// Headings, and what stands first in each line of a table.
fn frame(page: &str) -> Vec<&str> {
    let lines = page.lines().filter(|line| line.starts_with(['#', '|']));
    lines.map(|line| line.split(" | ").next().unwrap_or(line)).collect()
}
