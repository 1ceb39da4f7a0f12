//! Equations of motion without what can be ignored.
#![cfg(feature = "cli")]

/// What `check --routh` says of a file.
fn checked(name: &str, lines: &str) -> String {
    let path = std::env::temp_dir().join(format!("dalembert-routh-{name}-{}.yaml", std::process::id()));
    std::fs::write(&path, format!("name: {name}\n{lines}")).expect("a file");
    let mut out = Vec::new();
    let result = dalembert::cli::run(&[], ["dalembert", "check", path.to_str().expect("a path"), "--routh"], &mut out);
    std::fs::remove_file(&path).expect("the file");
    result.unwrap_or_else(|problem| panic!("{problem}"));
    String::from_utf8(out).expect("text")
}

/// Operations of the reduced equations and of all.
fn counted(text: &str) -> (usize, usize) {
    let line = text.lines().find(|line| line.contains("operations an evaluation")).unwrap_or_else(|| panic!("{text}"));
    let numbers: Vec<usize> = line.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse().ok()).collect();
    (numbers[0], numbers[1])
}

#[test]
fn reduced_equations_are_counted_before_they_are_recommended() {
    // The study's: 19 operations become 10.
    let pendulum = checked(
        "Spherical",
        "parameters: {m: 2 kg, L: 3 m, g: 9.81 m/s^2}
coordinates: {theta: rad, phi: rad}
bodies: {bob: {mass: m, position: \"L*[sin(theta)*cos(phi), sin(theta)*sin(phi), -cos(theta)]\"}}
gravity: [0, 0, -g]
",
    );
    assert!(pendulum.contains("Routh: 1 of 2 coordinates is left: theta\n"), "{pendulum}");
    let (few, all) = counted(&pendulum);
    assert!(few < all && few <= 12 && pendulum.contains(": cheaper\n"), "{pendulum}");
    // Two shafts in angles from the ground: only their twist matters, and one is counted from the other.
    let shafts = checked(
        "Shafts",
        "parameters: {I: 1 kg*m^2, J: 3 kg*m^2, k: 5 N*m}
coordinates: {a: rad, b: rad}
kinetic_energy: I*a'^2/2 + J*b'^2/2
potential_energy: k*(b - a)^2/2
",
    );
    assert!(
        shafts.contains("a goes with its momentum mu_a = ") && shafts.contains("; b is counted from a\n"),
        "{shafts}"
    );
    // A momentum that couples: three links of a free chain.
    let links = checked(
        "Links",
        "parameters: {m: 1 kg, L: 1 m}
coordinates: {a: rad, b: rad, c: rad}
points: {P: \"L*[cos(a), sin(a)]\", Q: \"P + L*[cos(b), sin(b)]\", R: \"Q + L*[cos(c), sin(c)]\"}
bodies: {p: {mass: m, position: P}, q: {mass: m, position: Q}, r: {mass: 2*m, position: R}}
scene: {start: {a: 0.3, b: 1, a': 1}, until: 1}
",
    );
    let (many, all) = counted(&links);
    assert!(many > all && links.contains(": not cheaper\n"), "{links}");
}

#[test]
fn what_is_not_reduced_says_why() {
    let all = "parameters: {m: 1 kg, k: 2 N/m, l: 1 m}
coordinates: {x: m, y: m}
kinetic_energy: m*(x'^2 + y'^2)/2
";
    let held = checked("Held", &format!("{all}potential_energy: k*(x^2 + y^2)/2\n"));
    assert!(held.contains("every coordinate and every direction matters"), "{held}");
    assert!(checked("Free", all).contains("nothing is left to integrate"));
    let rubbed = checked("Rubbed", &format!("{all}generalized_forces: {{x: -0.1*k*l*sign(x')}}\n"));
    assert!(rubbed.contains("nothing is reduced where"), "{rubbed}");
}
