//! No text makes reading, parsing or deriving panic: the seeds of the fuzz targets, and random texts.

use dalembert_symbolic::diagnose::Problem;
use dalembert_symbolic::expr::{Symbol, Tape};
use dalembert_symbolic::file::read;
use dalembert_symbolic::file::render;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::language::{parse, parse_equation, parse_key, parse_unit, parse_value_with_unit};
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::load;
use dalembert_symbolic::print;
use proptest::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// What the fuzz target `read` does.
fn read_file(text: &str) {
    if let Err(problems) = read(text) {
        assert!(!problems.is_empty());
        render("hostile.yaml", text, &problems);
    }
}

/// What the fuzz target `derive` does.
fn derive_file(text: &str) {
    match compile(text, &[]) {
        Ok(program) => {
            print::rust(&program, text, "Hostile");
            print::python(&program, "hostile");
            let reading = print::Reading::of(&program);
            reading.text(&program.model);
            reading.latex(&program.model);
        }
        Err(problems) => {
            assert!(!problems.is_empty());
            render("hostile.yaml", text, &problems);
        }
    }
}

/// What the fuzz target `parse` does.
fn parse_all(text: &str) {
    told(text, parse(text));
    told(text, parse_equation(text));
    told(text, parse_key(text));
    told(text, parse_unit(text));
    told(text, parse_value_with_unit(text));
}

fn told<T>(text: &str, result: Result<T, Vec<Problem>>) {
    for problem in result.err().unwrap_or_default() {
        let span = problem.place.span.expect("a span");
        assert!(text.get(span.range()).is_some(), "{text:?} {problem:?}");
    }
}

fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(folder);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// Exponents of powers of powers are beyond all integers; they are neither wrong nor a panic.
#[test]
fn powers_of_powers_are_what_they_are() {
    let tower = |x: &str| (0..6).fold(x.to_owned(), |base, _| format!("({base}^64)"));
    let of_place =
        format!("name: P\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\npotential_energy: {}\n", tower("x"));
    let of_parameter = format!(
        "name: P\nparameters: {{a: 1}}\ncoordinates: {{x: 1}}\nkinetic_energy: x'^2/2\npotential_energy: {}*x^2/2\n",
        tower("a")
    );
    for (text, force) in [(of_place, 64.0_f64.powi(6)), (of_parameter, 1.0)] {
        let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{problems:?}"));
        for near in [1.0, 1.0 + 1e-12] {
            let at = |s: Symbol| if matches!(s, Symbol::Coordinate(_) | Symbol::Parameter(_)) { near } else { 0.0 };
            let h = Tape::new(&program.model.graph, &program.bias).evaluate(at)[0];
            let expected = force * (64.0_f64.powi(6) * near.ln()).exp();
            assert!((h / expected - 1.0).abs() < 1e-6, "{h} is not {expected} in\n{text}");
        }
    }
}

/// Other forms of long products must not be sought for long, nor take the room that the equations themselves need.
#[test]
fn long_products_and_long_chains_derive() {
    for n in [40, 300, 900] {
        let factors: Vec<String> = (1..=n).map(|k| format!("cos(x/{k})")).collect();
        let text = format!(
            "name: Long\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\npotential_energy: {}\n",
            factors.join("*")
        );
        let program = compile(&text, &[]).unwrap_or_else(|problems| panic!("{n}: {problems:?}"));
        assert!(program.counts.bias < 40 * n, "{}", program.counts.bias);
    }
    let chain = include_str!("../../models/chain.yaml");
    assert!(compile(chain, &[("n".to_owned(), 100)]).is_ok());
}

#[test]
fn seeds_of_the_fuzz_targets() {
    let seeds = files("fuzz/corpus/read");
    assert!(seeds.len() > 10);
    for path in seeds.iter().chain(&files("symbolic/errors")) {
        let text = fs::read_to_string(path).unwrap();
        read_file(&text);
        derive_file(&text);
    }
    for path in files("fuzz/corpus/parse") {
        parse_all(&fs::read_to_string(path).unwrap());
    }
}

#[test]
fn a_reaction_that_two_systems_describe_differently_is_told() {
    let text = include_str!("refused/reactions.yaml");
    let problems =
        load(text, &[]).expect_err("`guide` is along the vertical in one system, and has any direction in the other");
    assert!(problems.iter().any(|problem| problem.message.contains("`guide`")), "{problems:?}");
}

/// A joint of a body whose place is not known has no rows, and the place is all that is told.
#[test]
fn a_joint_of_a_body_without_a_place_is_left_out() {
    let head = "name: K\ncoordinates: {x: m, y: m, th: rad}\npoints: {O: \"[0, 0]\"}\n";
    let tail = "joints: {j: {hinge: [ground, b], at: [O, \"[x, y]\"]}}\n";
    for (position, code) in [("", "E302"), (", position: \"[x, yy]\"", "E201")] {
        let body = format!("bodies: {{b: {{mass: 1 kg, inertia: 1 kg*m^2, angle: th{position}}}}}\n");
        let problems = load(&format!("{head}{body}{tail}"), &[]).err().unwrap_or_default();
        let codes: Vec<&str> = problems.iter().map(|problem| problem.code).collect();
        assert_eq!(codes, [code], "{position}");
    }
}

#[test]
fn files_cut_short_or_with_a_character_changed() {
    for path in files("fuzz/corpus/read") {
        let text = fs::read_to_string(path).unwrap();
        for (at, c) in text.char_indices().step_by(7) {
            read_file(&text[..at]);
            for other in ["[", "'", "*", "\t", "\u{0}", "θ"] {
                read_file(&format!("{}{other}{}", &text[..at], &text[at + c.len_utf8()..]));
            }
        }
    }
}

/// A model in which every section stands once.
const WHOLE: &str = include_str!("../../fuzz/corpus/derive/whole.yaml");

/// Constraints, phases, events, impacts, reactions and balances, in every form.
const CONTACT: &str = include_str!("../../fuzz/corpus/derive/contact.yaml");

/// Tables in every form, and a family of shapes.
const TABLES: &str = include_str!("../../fuzz/corpus/derive/tables.yaml");

#[test]
fn whole_models_are_valid() {
    for path in files("fuzz/corpus/derive") {
        let text = fs::read_to_string(&path).unwrap();
        if let Err(problems) = load(&text, &[]).and_then(judged) {
            panic!("{}", render(&path.to_string_lossy(), &text, &problems));
        }
    }
}

#[test]
fn a_model_with_a_word_taken_away_or_doubled_or_swapped() {
    for (text, step) in [(WHOLE, 3), (CONTACT, 5), (TABLES, 1)] {
        mutated(text, step);
    }
}

/// Takes away, doubles and swaps every so many words.
fn mutated(text: &str, step: usize) {
    let words: Vec<&str> = text.split_inclusive(|c: char| !c.is_alphanumeric()).collect();
    for at in (0..words.len()).step_by(step) {
        let (before, after) = (words[..at].concat(), words[at + 1..].concat());
        let other = words[(at * 7 + 3) % words.len()];
        for replacement in ["", &words[at].repeat(2), other] {
            derive_file(&format!("{before}{replacement}{after}"));
        }
    }
}

/// Pieces that expressions consist of, in any order.
fn pieces() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "x", "θ", "sin", "sum", "integral", "in", "i", "1", "2.5e-3", ".", "..", "'", "''", "(", ")", "[", "]", ",",
        "+", "-", "*", "/", "^", "=", " ", "kg", "m", "**", "$", "velocity", "\"", "²",
    ]);
    prop::collection::vec(piece, 0..40).prop_map(|pieces| pieces.concat())
}

/// Pieces that YAML consists of, in any order.
fn yaml_pieces() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "a", "b: ", "\n", "\n  ", "- ", "? ", ": ", "[", "]", "{", "}", ",", "\"", "'", "&a ", "*a", "!t ", "|\n",
        ">-\n", "#", "x*y", "0x1", ".inf", "<<", "---\n", "\t", "θ", "\\u03b8", "%", "@",
    ]);
    prop::collection::vec(piece, 0..60).prop_map(|pieces| pieces.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn expressions_of_random_pieces(text in pieces()) {
        parse_all(&text);
    }

    #[test]
    fn files_of_random_pieces(text in yaml_pieces()) {
        read_file(&text);
    }

    #[test]
    fn random_texts(text in "\\PC{0,80}") {
        parse_all(&text);
        read_file(&text);
    }
}
