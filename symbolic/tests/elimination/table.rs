// The table of `docs/elimination.md`: operations of accelerations against the number of links.

use std::fmt::Write;

use dalembert_symbolic::lower::compile;

use super::models;

/// Mechanisms, with the numbers of links in the table.
const ROWS: [(&str, &str, [i64; 4]); 11] = [
    ("chain, absolute angles", models::ABSOLUTE, [5, 10, 20, 40]),
    ("the same by its energies, balls", models::ENERGIES, [5, 10, 20, 40]),
    ("chain, relative angles", models::RELATIVE, [5, 10, 20, 40]),
    ("cart with chain", models::CART, [5, 10, 20, 40]),
    ("turntable with chain", models::TURNTABLE, [5, 10, 20, 40]),
    ("tree, absolute angles", models::TREE, [7, 15, 31, 63]),
    ("pendulums in space, spherical angles", models::SPHERICAL, [5, 10, 20, 30]),
    ("bars on universal joints", models::SPACE, [2, 3, 6, 12]),
    ("bars on ball joints, by rotations", models::BALL_JOINTS, [1, 3, 6, 12]),
    ("bars by the constraints of their hinges", models::HINGES, [2, 5, 10, 20]),
    ("four-bars, each on the crank of the one before", models::FOUR_BARS, [1, 2, 5, 10]),
];

/// The page, with the table in its place.
pub fn page() -> String {
    include_str!("page.md").replace("{table}", &table())
}

/// Operations by elimination for every row and number of links, with the links.
pub fn operations(text: &str, n: i64) -> (usize, String, String) {
    let program = match compile(text, &[("n".to_owned(), n)]) {
        Ok(program) => program,
        Err(problems) => panic!("{problems:?}"),
    };
    let count = program.counts.accelerations;
    match program.elimination {
        None => (count, format!("{n}: *{count}*"), String::new()),
        Some(found) => {
            let own = found.cost.operations;
            let by_masses = found.by_masses.map_or(0, |cost| cost.operations);
            let cell = if found.order.is_some() { own.to_string() } else { format!("*{own}*") };
            (own, format!("{n}: {cell} ({by_masses})"), found.front.to_string())
        }
    }
}

fn table() -> String {
    let mut text =
        String::from("| mechanism | | | | | a link | front |\n| --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    for (name, model, links) in ROWS {
        let found = links.map(|n| operations(model, n));
        let a_link = (found[3].0 - found[2].0) as f64 / (links[3] - links[2]) as f64;
        let cells: Vec<&str> = found.iter().map(|(_, cell, _)| cell.as_str()).collect();
        let _ = writeln!(text, "| {name} | {} | {a_link:.0} | {} |", cells.join(" | "), found[3].2);
    }
    text
}
