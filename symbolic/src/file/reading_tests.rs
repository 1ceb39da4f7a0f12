//! Reading YAML and finding places in it again.

use super::{Node, locate, read, render};
use crate::diagnose::Place;
use crate::language::Span;

fn scalar(text: &str) -> Node {
    Node::Scalar(text.to_owned())
}

#[test]
fn scalars_are_text_and_keys_keep_their_order() {
    let text = "y: 0.10\non: true\nn: 1e-9\n1: -3\nx:\nz: ~\nq: \"1\"\nl: [a, 2.50]\nbig: 123456789012345678901234\n";
    let Ok(Node::Map(entries)) = read(text) else { panic!() };
    let wanted = [
        ("y", scalar("0.1")),
        ("on", scalar("true")),
        ("n", scalar("1e-9")),
        ("1", scalar("-3")),
        ("x", Node::Null),
        ("z", Node::Null),
        ("q", scalar("1")),
        ("l", Node::List(vec![scalar("a"), scalar("2.5")])),
        ("big", scalar("123456789012345678901234")),
    ];
    for ((key, value), (wanted_key, wanted)) in entries.iter().zip(&wanted) {
        assert_eq!((key.as_str(), value), (*wanted_key, wanted));
    }
    assert_eq!(entries.len(), wanted.len());
}

/// Codes with line and column.
fn codes(text: &str) -> Vec<String> {
    let shown = render("f", text, &read(text).unwrap_err());
    let code = |line: &str| line.strip_prefix("error[").map(|rest| rest[..4].to_owned());
    let place = |line: &str| line.trim_start().strip_prefix("--> f:").map(str::to_owned);
    let codes = shown.lines().filter_map(code);
    codes.zip(shown.lines().filter_map(place)).map(|(code, place)| format!("{code} {place}")).collect()
}

/// YAML complains of the place where it can go on no more, which is not where the slip is.
#[test]
fn slips_are_told_where_they_are() {
    for (text, wanted) in [
        ("a:\n  b: 1\nc: 2\n  d: 3\n", "E001 3:1"),
        ("a:\n  b: 1\n    c: 2\n", "E001 3:6"),
        ("a:\n  b:{c: 1, d: 2}\n", "E018 2:3"),
        ("a\nb: 1\n", "E001 1:1"),
        ("a = 1\nb: 2\n", "E018 1:1"),
        ("a: {b: \"1, c: 2}\nd: \"x\"\n", "E015 1:8"),
        ("a: {b:1, c: 2}\n", "E018 1:5"),
        ("a: {b: 1, c=2}\n", "E018 1:11"),
        ("a: {b: 8,5 m}\n", "E108 1:8"),
        ("a:\n  - b: 1\n  c: 2\n", "E001 3:3"),
    ] {
        assert_eq!(codes(text), [wanted], "{text}");
    }
    // A key without a value stays one.
    for text in ["a: {b: , c: 2}\n", "a: {x, y}\n", "a: {\"x[i in 1..2]\": }\n"] {
        assert!(read(text).is_ok(), "{text}");
    }
}

#[test]
fn refusals() {
    for (text, wanted) in [
        ("a: &b 1\n", "E004 1:4"),
        ("a: &b {c: 1}\n", "E004 1:4"),
        ("c: &b 1\na: *b\n", "E004 1:4"),
        ("a: *b\n", "E005 1:4"),
        ("a: !x 1\n", "E007 1:4"),
        ("a: !!str 1\n", "E007 1:4"),
        ("b: {<<: {c: 1}}\n", "E006 1:5"),
        ("a: .inf\n", "E008 1:4"),
        ("a: [1, .NaN]\n", "E008 1:8"),
        ("a: 0x10\n", "E009 1:4"),
        ("a: 0o17\n", "E009 1:4"),
        ("a: 1\nb: {c: 1, c: 2}\na: 3\n", "E003 2:11"),
        ("a: 1\n---\nb: 2\n", "E012 2:1"),
        ("? [a]\n: 1\n", "E013 1:3"),
        ("", "E014 1:1"),
        ("- a\n", "E014 1:1"),
        ("hello\n", "E014 1:1"),
        ("a: b: c\n", "E001 1:5"),
        ("\ta: b\n", "E001 1:1"),
        ("define:\n  a: [0, 1]*2\n", "E002 2:12"),
        ("define:\n  a: *x + 2\n", "E005 2:6"),
        ("define: {a: x[1], b: 2}\n", "E002 1:14"),
        ("define: {a: \"x, b: 2}\n", "E015 1:13"),
        ("p: {f: dot(a, b), at: P}\n", "E002 1:8"),
        ("p: [dot(a, b), c]\n", "E002 1:5"),
        ("x: 'theta'' + 1\n", "E015 1:4"),
        ("x: 'theta'*2\n", "E002 1:11"),
        ("x: [a, b\ny: 2\n", "E016 1:4"),
        ("x: {a: f(x, [1, 2])}\n", "E002 1:13"),
        ("x: {force: [0, -m*g}\n", "E001 1:20"),
        ("x: \"\\q\"\n", "E001 1:5"),
        ("{a: 1\n", "E016 1:1"),
    ] {
        let found = codes(text);
        assert_eq!(
            found.first().map(String::as_str),
            Some(wanted),
            "{text}\n{}",
            render("f", text, &read(text).unwrap_err())
        );
    }
}

#[test]
fn what_yaml_took_apart_is_put_together_again() {
    let help = |text: &str| read(text).unwrap_err().remove(0).help;
    for (text, wanted) in [
        ("f: {force: dot(a, b), at: P}\n", "`\"dot(a, b)\"`"),
        ("f: {force: max(a, b, c), at: P}\n", "`\"max(a, b, c)\"`"),
        ("f: [min(a, b, c), 1]\n", "`\"min(a, b, c)\"`"),
        ("f: {a: x[1], b: 2}\n", "`\"x[1]\"`"),
        ("f: {a: l*[sin(t), 1]}\n", "`\"l*[sin(t), 1]\"`"),
        ("f:\n  a: [0, 1]*2\n", "`\"[0, 1]*2\"`"),
    ] {
        assert_eq!(help(text), format!("put the expression in double quotes: {wanted}"), "{text}");
    }
}

#[test]
fn other_line_ends_and_a_byte_order_mark() {
    let text = "\u{feff}a: x\r\nb:\r\n  c: \"y +\r\n    thta\"\r\n";
    assert_eq!(read(text).unwrap(), read("a: x\nb:\n  c: y + thta\n").unwrap());
    let place = Place::default().key("b").key("c").at(Span::new(4, 8));
    assert_eq!(at(text, &place), "thta");
    assert_eq!(at(text, &Place::default().key("a")), "x");
}

#[test]
fn all_refusals_at_once() {
    assert_eq!(codes("a: &b 1\nc: *b\nd: 0x1\ne: .inf\n"), ["E004 1:4", "E005 2:4", "E009 3:4", "E008 4:4"]);
    assert_eq!(codes("a: 1\nb: {c: 1, c: 2}\na: 3\n"), ["E003 2:11", "E003 3:1"]);
}

#[test]
fn signs_inside_text_are_no_refusals() {
    assert!(read("about: Q&A! 0x10 << 2\na: \"&b\"\nb: m*&x\n").is_ok());
}

#[test]
fn hostile_files_end_with_an_error() {
    let deep = "[".repeat(100_000);
    let deeper = "{a: ".repeat(100_000);
    let blocks: String = (0..400).map(|depth| format!("{}a:\n", " ".repeat(depth))).collect();
    let mut laughs = "a: &a [x, x, x, x, x, x, x, x, x]\n".to_owned();
    for (name, of) in ["b", "c", "d", "e", "f", "g", "h", "i"].iter().zip(["a", "b", "c", "d", "e", "f", "g", "h"]) {
        laughs += &format!("{name}: &{name} [*{of}, *{of}, *{of}, *{of}, *{of}, *{of}, *{of}, *{of}, *{of}]\n");
    }
    let large = "#".repeat(2 << 20);
    for text in [deep, deeper, blocks, laughs, large, "a: \u{0}".to_owned(), "\u{feff}- : [".to_owned()] {
        let problems = read(&text).unwrap_err();
        assert!(!render("f", &text, &problems).is_empty());
    }
}

fn at(text: &str, place: &Place) -> String {
    text[locate(text, &[place]).remove(0)].to_owned()
}

#[test]
fn places() {
    let text = "name: A\ndefine:\n  α: [sin(thta), 1]\n  b: {c: [x, y]}\nempty:\n";
    let root = Place::default();
    let define = root.key("define");
    assert_eq!(at(text, &define.key("α").index(0)), "sin(thta)");
    assert_eq!(at(text, &define.key("α").index(0).at(Span::new(4, 8))), "thta");
    assert_eq!(at(text, &define.key("α").of_key()), "α");
    assert_eq!(at(text, &define), "define");
    assert_eq!(at(text, &define.key("b").key("c")), "[x, y]");
    assert_eq!(at(text, &define.key("b").key("c").index(1)), "y");
    assert_eq!(at(text, &define.key("none").key("deeper")), "define");
    assert_eq!(at(text, &root.key("empty")), "empty");
    assert_eq!(at(text, &Place::in_file(0, 4)), "name");
}

#[test]
fn spans_inside_scalars_of_every_style() {
    for (text, value, wanted) in [
        ("a: x + thta\n", "x + thta", "thta"),
        ("a: \"x + thta\"\n", "x + thta", "thta"),
        ("a: \"\\u03b8\\t + thta\"\n", "θ\t + thta", "thta"),
        ("a: 'x + thta'\n", "x + thta", "thta"),
        ("a: x +\n  thta\n", "x + thta", "thta"),
        ("a: \"x +\n  thta\"\n", "x + thta", "thta"),
        ("a: \"x + \\\n  thta\"\n", "x + thta", "thta"),
        ("a: |\n  x +\n  thta\n", "x +\nthta\n", "thta"),
        ("a: >-\n  x +\n  thta\n", "x + thta", "thta"),
        ("a: {b: \"f(x, thta)\"}\n", "f(x, thta)", "thta"),
    ] {
        let Ok(Node::Map(entries)) = read(text) else { panic!("{text}") };
        let mut place = Place::default().key("a");
        let mut node = &entries[0].1;
        if let Node::Map(inner) = node {
            (place, node) = (place.key("b"), &inner[0].1);
        }
        assert_eq!(node, &scalar(value), "{text}");
        let start = value.find("thta").unwrap();
        assert_eq!(at(text, &place.at(Span::new(start, start + 4))), wanted, "{text}");
    }
}

#[test]
fn a_span_at_the_end_of_a_scalar_is_empty_and_in_place() {
    let text = "a: \"x +\"\nb: 1\n";
    let range = locate(text, &[&Place::default().key("a").at(Span::new(3, 3))]).remove(0);
    assert_eq!(range, 7..7);
    let range = locate(text, &[&Place::default().key("a").at(Span::new(90, 99))]).remove(0);
    assert!(range.end <= text.len());
}

#[test]
fn control_characters_are_shown_where_they_stand() {
    assert_eq!(codes("name: T\nabout: x\n# a\u{c}b\n"), ["E001 3:4"]);
    assert_eq!(codes("name: T\nabout: \u{1}x\n"), ["E001 2:8"]);
    assert!(read("name: T\nabout: \"a\tb\"\n").is_ok());
}
