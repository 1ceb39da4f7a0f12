//! Exchanges and reflections of coordinates under which equations of motion stay as they are.

use dalembert_symbolic::lower::{Program, compile, generators, symmetries};

/// Two oscillators in these words.
fn program(potential: &str, forces: &str) -> Program {
    let file = format!(
        "name: Pair\nparameters: {{m: 1, M: 1, k: 1e3, e: 1e-3, w: 3}}\ncoordinates: {{x: , y: }}\n\
         kinetic_energy: m*x'^2/2 + M*y'^2/2\npotential_energy: {potential}\n\
         generalized_forces: {{{forces}}}\nscene: {{start: {{x: 1, y: 2}}, until: 3}}\n"
    );
    compile(&file, &[]).unwrap_or_else(|problems| panic!("{problems:?}"))
}

/// The generators in short: the image of x and that of y.
fn found(program: &Program, parameters: &[f64]) -> Vec<String> {
    let found = symmetries(program, parameters).expect("something is asked");
    assert!(found.complete);
    let word = |&(i, opposite): &(usize, bool)| format!("{}{}", if opposite { "-" } else { "+" }, ["x", "y"][i]);
    generators(&found.found).iter().map(|s| s.images.iter().map(word).collect()).collect()
}

const PARAMETERS: [f64; 5] = [1.0, 1.0, 1e3, 1e-3, 3.0];

fn of(potential: &str, forces: &str) -> Vec<String> {
    let mut found = found(&program(potential, forces), &PARAMETERS);
    found.sort();
    found
}

#[test]
fn exchanges_and_reflections_are_found() {
    assert_eq!(of("k*(x^2 + y^2)/2 + k*(x - y)^4/4", ""), ["+y+x", "-x-y"]);
    assert_eq!(of("k*x^2/2 + 2*k*y^2/2 + y^4", ""), ["+x-y", "-x+y"]);
    assert_eq!(of("k*(x^2 - y)^2/2 + y^3", ""), ["-x+y"]);
    assert_eq!(of("1e12*(x^2 + y^2)^2 + e*x*y", ""), ["+y+x", "-x-y"]);
    // Odd friction; a force that turns with the speed knows left from right.
    assert_eq!(of("k*(x^2 + y^2)/2", "x: -e*x'^3, y: -e*y'^3"), ["+x-y", "+y+x", "-x+y"]);
    assert_eq!(of("k*(x^2 + y^2)/2", "x: w*y', y: -w*x'"), ["-x-y"]);
    // What is driven is not reflected.
    assert_eq!(of("k*(x^2 + y^2)/2", "x: sin(w*t)"), ["+x-y"]);
}

#[test]
fn what_is_nearly_symmetric_is_not() {
    assert!(of("k*(x^2 + (1 + 1e-15)*y^2)/2 + k*(x - y)^4/4 + x^3*y^3*1e-14*x", "").is_empty());
    assert_eq!(of("k*(x^2 + y^2)/2 + k*(x - y)^4/4", "x: 1e-13*x'^2"), Vec::<String>::new());
    assert_eq!(of("k*(x^2 + y^2)/2 + k*(x - y)^4/4 + 1e-13*x", ""), Vec::<String>::new());
}

#[test]
fn values_of_parameters_decide() {
    let pair = program("k*(x^2 + y^2)/2 + k*(x - y)^4/4", "");
    assert_eq!(found(&pair, &PARAMETERS).len(), 2);
    let heavier = [1.0, 1.0 + 1e-15, 1e3, 1e-3, 3.0];
    assert_eq!(found(&pair, &heavier), ["-x-y"]);
}

#[test]
fn a_symmetry_takes_motions_to_motions() {
    let pair = program("k*(x^2 + y^2)/2 + k*(x - y)^4/4", "");
    let all = symmetries(&pair, &PARAMETERS).unwrap().found;
    // Both generators and their product.
    assert_eq!(all.len(), 3);
    for symmetry in &all {
        assert_eq!(symmetry.of(&symmetry.of(&[1.0, 2.0])), [1.0, 2.0]);
    }
}

#[test]
fn nothing_is_asked_where_constraints_or_discontinuities_act() {
    assert!(symmetries(&program("k*(x^2 + y^2)/2", "x: -sign(x')"), &PARAMETERS).is_none());
    let tied = "name: Tied\ncoordinates: {x: , y: }\nkinetic_energy: (x'^2 + y'^2)/2\nconstraints: {rod: x^2 + y^2 - 1}\n\
                scene: {start: {x: 1}, until: 1}\n";
    assert!(symmetries(&compile(tied, &[]).unwrap(), &[]).is_none());
}
