//! Files that are refused, and why; what robots become is tested in the workspace's `tests/tests/urdf.rs`.

use dalembert_symbolic::file::extents;

use super::model_file;

const BODY: &str =
    "<inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial>";

/// Codes of mistakes with their lines and columns, in the file's order.
fn refused(text: &str) -> Vec<(&'static str, usize, usize)> {
    let mistakes = model_file(text, "robot.urdf", false).expect_err("a refusal");
    for mistake in &mistakes {
        assert!(!mistake.help.is_empty() && !mistake.message.contains('\n'), "{mistake:?}");
    }
    extents(text, &mistakes).into_iter().map(|(extent, problem)| (problem.code, extent.line, extent.column)).collect()
}

fn link(name: &str) -> String {
    format!("<link name=\"{name}\">{BODY}</link>\n")
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, more: &str) -> String {
    format!(
        "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{more}</joint>\n"
    )
}

fn robot(parts: &[String]) -> String {
    format!("<robot name=\"r\">\n{}</robot>\n", parts.concat())
}

#[test]
fn a_small_robot_is_accepted() {
    let text = robot(&[link("a"), link("b"), joint("j", "revolute", "a", "b", "")]);
    let file = model_file(&text, "robot.urdf", false).expect("a model");
    assert!(dalembert_symbolic::lower::compile(&file, &[]).is_ok(), "{file}");
}

#[test]
fn what_is_no_robot_is_refused_where_it_stands() {
    assert_eq!(refused(""), [("U101", 1, 1)]);
    assert_eq!(refused("<robot name=\"x\">\n<link name=\"a\"></robot>"), [("U101", 2, 16)]);
    assert_eq!(refused("<robot name=\"x\">\n<link name=\"a\">"), [("U101", 2, 15)]);
    assert_eq!(refused("<robot name=\"é\" b=c/>"), [("U101", 1, 19)]);
    assert_eq!(refused("<sdf/>"), [("U104", 1, 1)]);
    assert_eq!(refused("<robot name=\"x\"/>"), [("U115", 1, 1)]);
    let xacro = "<robot name=\"x\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n<xacro:macro/></robot>";
    assert_eq!(refused(xacro), [("U105", 2, 1)]);
    let unbound = "<robot name=\"x\">\n<xacro:macro/></robot>";
    assert_eq!(refused(unbound), [("U101", 2, 2)]);
}

/// Entities are refused before any is expanded; nesting costs no stack.
#[test]
fn hostile_files_end_at_once() {
    let mut bomb = "<?xml version=\"1.0\"?>\n<!DOCTYPE r [<!ENTITY a0 \"x\">".to_owned();
    for k in 1..40 {
        bomb += &format!("<!ENTITY a{k} \"&a{};&a{};\">", k - 1, k - 1);
    }
    bomb += "]>\n<robot name=\"&a39;\"/>";
    assert_eq!(refused(&bomb), [("U102", 2, 1)]);
    let deep = format!("<robot name=\"x\">{}{}</robot>", "<a>".repeat(200_000), "</a>".repeat(200_000));
    assert_eq!(refused(&deep), [("U115", 1, 1)]);
    let open = format!("<robot name=\"x\">{}", "<a>".repeat(200_000));
    assert_eq!(refused(&open)[0].0, "U101");
    let links: Vec<String> = (0..2001).map(|k| format!("<link name=\"l{k}\"/>")).collect();
    assert_eq!(refused(&robot(&links))[0].0, "U103");
    let wide = format!("<robot name=\"x\">{}</robot>", "<a/>".repeat(1_000_000));
    assert_eq!(refused(&wide), [("U103", 1, 1)]);
    // A chain that is deep, but a robot: its tree is walked without recursion.
    let mut chain: Vec<String> = (0..1500).map(|k| link(&format!("l{k}"))).collect();
    chain.extend((1..1500).map(|k| joint(&format!("j{k}"), "fixed", &format!("l{}", k - 1), &format!("l{k}"), "")));
    assert_eq!(refused(&robot(&chain)), [("U120", 1, 1)]);
}

#[test]
fn mistakes_in_elements_are_told_together() {
    let text = "<robot name=\"bad\">\n\
        <link name=\"a\"/><link/>\n\
        <link name=\"b\"><inertial><mass value=\"-1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\n\
        <link name=\"c\"><inertial><mass value=\"1,5\"/></inertial></link>\n\
        <link name=\"d\"><inertial><inertia ixx=\"1\"/></inertial></link>\n\
        <link name=\"e\"><visual><geometry><box size=\"1 0 1\"/></geometry></visual><visual><geometry><sphere/></geometry></visual></link>\n\
        <joint name=\"j\" type=\"revolut\"><parent link=\"a\"/><child link=\"b\"/><axis xyz=\"0 0 0\"/></joint>\n\
        <joint name=\"k\" type=\"prismatic\"><parent link=\"a\"/><origin xyz=\"0 0\" rpy=\"0 0 nan\"/></joint>\n\
        <joint name=\"l\"><limit lower=\"1\" upper=\"-1\"/><dynamics damping=\"-1\" friction=\"${f}\"/><mimic/></joint>\n\
        </robot>";
    let found: Vec<(&str, usize)> = refused(text).into_iter().map(|(code, line, _)| (code, line)).collect();
    let expected = [
        ("U106", 2),
        ("U108", 3),
        ("U107", 4),
        ("U106", 4),
        ("U106", 5),
        ("U106", 5),
        ("U106", 5),
        ("U106", 5),
        ("U106", 5),
        ("U106", 5),
        ("U108", 6),
        ("U106", 6),
        ("U109", 7),
        ("U117", 7),
        ("U106", 8),
        ("U107", 8),
        ("U107", 8),
        ("U106", 9),
        ("U106", 9),
        ("U106", 9),
        ("U108", 9),
        ("U108", 9),
        ("U107", 9),
        ("U106", 9),
    ];
    let sorted = |list: &[(&str, usize)]| {
        let mut list: Vec<(usize, String)> = list.iter().map(|(code, line)| (*line, (*code).to_owned())).collect();
        list.sort();
        list
    };
    assert_eq!(sorted(&found), sorted(&expected));
}

#[test]
fn numbers_are_finite_and_whole() {
    for wrong in ["inf", "1e999", "0x10", "1 2", "", "1e31", "NaN", "1.5.2"] {
        let damped = format!("<dynamics damping=\"{wrong}\"/>");
        let text = robot(&[link("a"), link("b"), joint("j", "revolute", "a", "b", &damped)]);
        assert_eq!(refused(&text)[0].0, "U107", "{wrong}");
    }
}

#[test]
fn what_is_no_tree_is_refused() {
    let [a, b, c] = ["a", "b", "c"].map(link);
    let revolute = |name: &str, parent: &str, child: &str| joint(name, "revolute", parent, child, "");
    let text = robot(&[a.clone(), b.clone(), a.clone(), revolute("j", "a", "b"), revolute("j", "a", "c")]);
    assert_eq!(refused(&text), [("U110", 4, 13), ("U110", 6, 14), ("U111", 6, 64)]);
    let text = robot(&[a.clone(), b.clone(), c.clone(), revolute("j", "a", "c"), revolute("k", "b", "c")]);
    assert_eq!(refused(&text), [("U112", 6, 64)]);
    let text = robot(&[a.clone(), b.clone(), revolute("j", "a", "b"), revolute("k", "b", "a")]);
    assert_eq!(refused(&text).iter().map(|mistake| mistake.0).collect::<Vec<_>>(), ["U113"]);
    let text = robot(&[a.clone(), revolute("j", "a", "a")]);
    assert_eq!(refused(&text).iter().map(|mistake| mistake.0).collect::<Vec<_>>(), ["U113"]);
    let text = robot(&[a, b, c, revolute("j", "a", "b")]);
    assert_eq!(refused(&text), [("U114", 4, 13)]);
}

#[test]
fn inertias_that_no_body_has_are_refused_and_signs_explained() {
    let inertia = |moments: &str| {
        let body = format!("<link name=\"b\"><inertial><mass value=\"1\"/><inertia {moments}/></inertial></link>\n");
        robot(&[link("a"), body, joint("j", "revolute", "a", "b", "")])
    };
    let text = inertia("ixx=\"0.2\" ixy=\"0\" ixz=\"0\" iyy=\"0.3\" iyz=\"0\" izz=\"0.6\"");
    let mistakes = model_file(&text, "r", false).expect_err("a refusal");
    assert!(mistakes[0].message.contains("0.2, 0.3, 0.6") && &*mistakes[0].label == "0.2 + 0.3 is less than 0.6");
    // Less by a rounding: data of few digits.
    let text = inertia("ixx=\"0.2\" ixy=\"0\" ixz=\"0\" iyy=\"0.3\" iyz=\"0\" izz=\"0.501\"");
    assert!(model_file(&text, "r", false).is_ok());
    let text = inertia("ixx=\"1\" ixy=\"0.4\" ixz=\"0.4\" iyy=\"1\" iyz=\"0.4\" izz=\"1\"");
    let refused = model_file(&text, "r", false).expect_err("a refusal");
    assert!(refused[0].help.contains("signs of its products"), "{refused:?}");
}

#[test]
fn joints_that_move_nothing_are_refused() {
    let empty = "<link name=\"b\"/>\n".to_owned();
    for (kind, code) in [("revolute", "U119"), ("prismatic", "U119"), ("floating", "U119"), ("fixed", "U120")] {
        let text = robot(&[link("a"), empty.clone(), joint("j", kind, "a", "b", "")]);
        assert_eq!(refused(&text)[0].0, code, "{kind}");
    }
    let planar = joint("j", "planar", "a", "b", "<axis xyz=\"1 0 1\"/>");
    assert_eq!(refused(&robot(&[link("a"), link("b"), planar]))[0].0, "U121");
    // A point on the axis has no moment of inertia about it; beside it there is one.
    let point = |at: &str| {
        let inertia = "<inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>";
        let body = format!(
            "<link name=\"b\"><inertial><origin xyz=\"{at}\"/><mass value=\"1\"/>{inertia}</inertial></link>\n"
        );
        robot(&[link("a"), body, joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 1\"/>")])
    };
    assert_eq!(refused(&point("0 0 0.3"))[0].0, "U119");
    let file = model_file(&point("0.1 0 0"), "r", false).expect("a model");
    assert!(dalembert_symbolic::lower::compile(&file, &[]).is_ok(), "{file}");
}

#[test]
fn mimics_that_cannot_be_followed_are_refused() {
    let links = ["a", "b", "c"].map(link).concat();
    let mimic = |of: &str| format!("<mimic joint=\"{of}\"/>");
    let pair = |first: (&str, &str), second: (&str, &str)| {
        robot(&[links.clone(), joint("j", first.0, "a", "b", first.1), joint("k", second.0, "b", "c", second.1)])
    };
    let refusals: [String; 5] = [
        pair(("revolute", &mimic("k")), ("revolute", &mimic("j"))),
        pair(("revolute", &mimic("j")), ("revolute", "")),
        pair(("revolute", &mimic("i")), ("revolute", "")),
        pair(("revolute", &mimic("k")), ("fixed", "")),
        pair(("fixed", &mimic("k")), ("revolute", "")),
    ];
    for text in &refusals {
        assert!(refused(text).iter().all(|mistake| mistake.0 == "U118"), "{text}");
    }
}

/// Every name of a file becomes one of the language, and none stands twice.
#[test]
fn hostile_names_are_turned_into_names() {
    let names = ["t", "pi", "length", "true", "a b", "a-b", "a.b", "1st", "ü\u{2028}#", "energy"];
    let mut parts = vec![link("ground")];
    for (k, name) in names.iter().enumerate() {
        parts.push(link(name));
        let parent = if k == 0 { "ground" } else { names[k - 1] };
        let kind = ["revolute", "prismatic"][k % 2];
        parts.push(joint(
            name,
            kind,
            parent,
            name,
            "<origin xyz=\"0.1 0 0\" rpy=\"0 0.2 0\"/><dynamics damping=\"1\"/>",
        ));
    }
    let text = robot(&parts).replace("name=\"r\"", "name=\"a: b # &#10;c\"");
    let file = model_file(&text, "x: y #.urdf", false).expect("a model");
    let model = dalembert_symbolic::model::load(&file, &[]).unwrap_or_else(|problems| panic!("{file}\n{problems:?}"));
    assert_eq!(model.coordinates.len(), names.len());
}
