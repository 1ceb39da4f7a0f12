//! `show`: equations that a person reads, in three forms, of every model.

use dalembert_models::MODELS;
use serde_json::Value;

fn shown(arguments: &[&str]) -> String {
    let mut out = Vec::new();
    let arguments = ["dalembert", "show"].iter().chain(arguments);
    dalembert::cli::run(MODELS, arguments, &mut out).unwrap_or_else(|problem| panic!("{problem}"));
    String::from_utf8(out).expect("text")
}

#[test]
fn a_double_pendulum_reads_as_in_a_textbook() {
    let text = shown(&["double_pendulum"]);
    let equations = "M q'' + h = 0, with
  M[theta1, theta1] = 4/3*m*l^2
  M[theta2, theta1] = 1/2*m*l^2*cos(theta1 - theta2)
  M[theta2, theta2] = 1/3*m*l^2
  h[theta1] = 1/2*m*l^2*theta2'^2*sin(theta1 - theta2) + 3/2*m*l*g*sin(theta1)
  h[theta2] = 1/2*m*l*g*sin(theta2) - 1/2*m*l^2*theta1'^2*sin(theta1 - theta2)
";
    assert!(text.contains(equations), "{text}");
    let latex = shown(&["double_pendulum", "--latex"]);
    let line = "M_{\\theta_{2},\\theta_{1}} &= \\frac{1}{2} \\, m \\, {l}^{2} \\, \\cos\\left(\\theta_{1} - \\theta_{2}\\right)";
    assert!(latex.contains(line), "{latex}");
}

#[test]
fn nothing_is_left_out_and_nothing_is_a_wall() {
    for model in MODELS {
        let text = shown(&[model.name]);
        assert!(!text.contains('…') && !text.contains("mode0"), "{text}");
        let longest = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
        assert!(longest < 2500, "{}: a line of {longest} characters", model.name);
        for number in ["--", "+ -", "*1/(", " 1*", "(1*", "^1 "] {
            assert!(!text.contains(number), "{}: {number} in\n{text}", model.name);
        }
    }
}

#[test]
fn latex_is_balanced() {
    for model in MODELS {
        let text = shown(&[model.name, "--latex"]);
        let mut depth = 0;
        for c in text.replace("\\{", "").replace("\\}", "").chars() {
            depth += i32::from(c == '{') - i32::from(c == '}');
            assert!(depth >= 0, "{text}");
        }
        assert_eq!(depth, 0, "{text}");
        assert_eq!(text.matches("\\left").count(), text.matches("\\right").count(), "{text}");
        assert!(text.lines().all(|line| line.matches('&').count() <= 1), "{text}");
    }
}

#[test]
fn json_says_what_the_text_says() {
    for model in MODELS {
        let object: Value = serde_json::from_str(&shown(&[model.name, "--json"])).expect("JSON");
        let text = shown(&[model.name]);
        for (left, right) in object["equations"].as_object().expect("an object") {
            let line = format!("  {left} = {}\n", right.as_str().expect("text"));
            assert!(text.contains(&line), "{}: {line}", model.name);
        }
    }
}

/// What LaTeX sets in any document: letters of ASCII and commands, in lines that fit a page.
#[test]
fn latex_has_no_letters_of_other_scripts_and_breaks_its_lines() {
    let file = std::env::temp_dir().join(format!("dalembert-greek-{}.yaml", std::process::id()));
    let text = "name: Greek
parameters: {m: 1 kg, λ: 1 m, g: 9.81 m/s^2, θ_0: 0.1 rad, длина: 1 m}
coordinates: {φ: rad}
bodies: {b: {mass: m, position: \"(λ + длина)*[sin(φ - θ_0), -cos(φ - θ_0)]\"}}
gravity: [0, -g]
scene: {start: {φ: 0.3}, until: 1}
";
    std::fs::write(&file, text).expect("a file");
    let latex = shown(&[file.to_str().expect("a path"), "--latex"]);
    std::fs::remove_file(&file).expect("the file");
    assert!(latex.is_ascii() && latex.contains("\\ddot{\\phi}") && latex.contains("\\theta_{0}"), "{latex}");
    assert!(latex.contains("\\mathrm{dlina}"), "{latex}");
    for model in ["four_bar_minimal", "whipple_bicycle"] {
        let latex = shown(&[model, "--latex"]);
        let longest = latex.lines().map(str::len).max().unwrap_or(0);
        assert!(longest < 1000 && latex.contains("& \\quad {} "), "{model}: a line of {longest} characters");
    }
}

/// A coordinate x and a mass M are no vector and no matrix.
#[test]
fn linear_equations_have_names_of_their_own() {
    let text = shown(&["cart_pendulum", "--linear"]);
    assert!(
        text.starts_with("M_ x_'' + K x_ = 0, for small departures x_ from x = 0, theta = 0\nM_ = [[m + M, "),
        "{text}"
    );
    let latex = shown(&["cart_pendulum", "--linear", "--latex"]);
    assert!(latex.contains("\\mathbf{M} \\, \\ddot{\\mathbf{x}} + \\mathbf{K} \\, \\mathbf{x} = 0"), "{latex}");
    assert!(latex.contains("\\mathbf{M} &= \\begin{pmatrix} m + M"), "{latex}");
}
