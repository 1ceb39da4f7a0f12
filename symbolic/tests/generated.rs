//! What is printed, parsed again: the items that were meant and no others, whatever the file calls its things.

use dalembert_symbolic::lower::{Program, compile};
use dalembert_symbolic::model::{KEYWORDS, field_name, local_name, method_name};
use dalembert_symbolic::print::{OWN, rust, skeleton};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use syn::visit::{self, Visit};
use syn::{ImplItem, Item, Type};

/// The functions of `Equations`, in the order in which they are printed.
const EQUATIONS: &[&str] = &[
    "description",
    "gimbals",
    "tables_2d",
    "constants",
    "inputs",
    "mass_matrix",
    "bias",
    "residual",
    "jacobians",
    "input_jacobian",
    "time_jacobian",
    "time_dependence",
    "magnitudes",
    "invariants",
    "outputs",
    "events",
    "event_rates",
    "switches",
    "arguments",
    "drawing",
    "constraints",
    "constraint_matrix",
    "constraint_bias",
    "friction",
    "constraint_jacobians",
    "constraint_rate_jacobian",
    "held_rates",
    "start_conditions",
    "energy",
    "accelerations",
    "eliminated",
    "part_accelerations",
    "part_energy",
    "balances",
    "sampling",
    "held_noise",
    "assignments",
    "contacts",
];

/// And of `Mechanism`.
const RUNS: &[&str] = &[
    "parameters",
    "parameter_mut",
    "scene_memory",
    "clock_numbers",
    "scene_parameters",
    "scene_numbers",
    "scene",
    "equilibrium_guess",
    "restitutions",
    "frequencies",
    "start_condition_values",
    "start_condition_speeds",
    "motions",
    "motion_numbers",
];

fn printed(program: &Program, name: &str) -> syn::File {
    let text = rust(program, "source", name);
    syn::parse_str(&text).unwrap_or_else(|error| panic!("{}: {error}\n{text}", program.model.name))
}

fn program(text: &str) -> Program {
    compile(text, &[])
        .unwrap_or_else(|problems| panic!("{}", dalembert_symbolic::file::render("m.yaml", text, &problems)))
}

fn ident(ty: &Type) -> String {
    let Type::Path(path) = ty else { panic!("a path") };
    path.path.get_ident().expect("one name").to_string()
}

/// Walks everything, and finds only what the printer means to write.
#[derive(Default)]
struct Judge {
    /// What is wrong.
    faults: Vec<String>,
    /// Every name that is bound in a function.
    bound: BTreeSet<String>,
    /// Those that are numbers of the block of constants: `let m = c[0]`, `let (m, g) = (c[0], c[2])`.
    constants: BTreeSet<String>,
    /// How many functions are around.
    depth: usize,
    /// Functions inside functions.
    nested: Vec<String>,
}

impl<'ast> Visit<'ast> for Judge {
    fn visit_macro(&mut self, node: &'ast syn::Macro) {
        let path: Vec<String> = node.path.segments.iter().map(|s| s.ident.to_string()).collect();
        let known = path == ["std", "vec"] || path == ["dalembert", "generated_for"] && self.depth == 0;
        if !known || node.path.leading_colon.is_none() {
            self.faults.push(format!("a macro {}", path.join("::")));
        }
    }

    fn visit_attribute(&mut self, node: &'ast syn::Attribute) {
        let name = node.path().get_ident().map(ToString::to_string).unwrap_or_default();
        if !["doc", "derive", "must_use", "allow"].contains(&name.as_str()) {
            self.faults.push(format!("an attribute {name}"));
        }
    }

    fn visit_expr_unsafe(&mut self, _: &'ast syn::ExprUnsafe) {
        self.faults.push("unsafe".to_owned());
    }

    fn visit_path(&mut self, node: &'ast syn::Path) {
        let first = node.segments[0].ident.to_string();
        let absolute = ["dalembert", "core", "std"].contains(&first.as_str());
        // Relative paths of several segments start at a generic, or at the one import of `description`.
        let relative = ["S", "Self", "mechanism"].contains(&first.as_str());
        match (node.leading_colon.is_some(), node.segments.len()) {
            (true, _) if !absolute => self.faults.push(format!("the path ::{first}")),
            (false, 2..) if !relative => self.faults.push(format!("the path {first}::…")),
            _ => {}
        }
        visit::visit_path(self, node);
    }

    fn visit_pat_ident(&mut self, node: &'ast syn::PatIdent) {
        self.bound.insert(node.ident.to_string());
        visit::visit_pat_ident(self, node);
    }

    fn visit_local(&mut self, node: &'ast syn::Local) {
        if matches!(node.pat, syn::Pat::Wild(_)) {
            self.faults.push("`let _ =`".to_owned());
        }
        let of_block = |value: &syn::Expr| matches!(value, syn::Expr::Index(index) if matches!(&*index.expr, syn::Expr::Path(path) if path.path.is_ident("c")));
        let named = |name: &syn::Pat| match name {
            syn::Pat::Ident(name) => Some(name.ident.to_string()),
            _ => None,
        };
        match (&node.pat, node.init.as_ref().map(|init| &*init.expr)) {
            (name, Some(value)) if of_block(value) => self.constants.extend(named(name)),
            (syn::Pat::Tuple(names), Some(syn::Expr::Tuple(values))) if values.elems.iter().all(of_block) => {
                self.constants.extend(names.elems.iter().filter_map(named));
            }
            _ => {}
        }
        visit::visit_local(self, node);
    }

    fn visit_item(&mut self, node: &'ast Item) {
        if self.depth > 0 {
            match node {
                Item::Fn(function) => self.nested.push(function.sig.ident.to_string()),
                Item::Use(_) | Item::Static(_) => self.nested.push("description".to_owned()),
                _ => self.faults.push("an item inside a function".to_owned()),
            }
        }
        visit::visit_item(self, node);
    }

    fn visit_block(&mut self, node: &'ast syn::Block) {
        self.depth += 1;
        visit::visit_block(self, node);
        self.depth -= 1;
    }
}

/// The type, its default, its `Equations`, its `Mechanism` and its derived parameters, in this order, with the members that were meant.
fn judge(program: &Program) -> BTreeSet<String> {
    let model = &program.model;
    let file = printed(program, "Meant");
    let mut judge = Judge::default();
    judge.visit_file(&file);
    assert!(judge.faults.is_empty(), "{}: {:?}", model.name, judge.faults);
    let locks = !model.gimbals().is_empty();
    let held = !(model.memory.is_empty() && model.clocks.is_empty() && model.sets.is_empty());
    // A `use` and a `static` of the description, one `static` of the locks, both of the motions, of what is held and of contacts.
    let mut nested = vec!["description"; 2 + usize::from(locks) + if model.motions.is_empty() { 0 } else { 2 }];
    nested.extend(if held { &["description"; 2][..] } else { &[] });
    nested.extend(if model.contacts.is_empty() { &[] } else { &["description"; 2][..] });
    // Noise has both too, and tables of two arguments a `static`.
    nested.extend(if model.noise.is_empty() { &[] } else { &["description"; 2][..] });
    let tables = rust(program, "source", "Meant").contains("fn tables_2d()");
    nested.extend(tables.then_some("description"));
    nested.extend(model.all_scenes().filter(|scene| !scene.memory.is_empty()).map(|_| "values"));
    nested.extend((!model.clocks.is_empty()).then_some("values"));
    let methods: Vec<String> =
        model.derived.iter().filter(|d| !d.name.contains('[')).map(|d| method_name(&d.name)).collect();
    nested.extend(methods.iter().map(|_| "value"));
    nested.extend(model.motions.iter().map(|_| "values"));
    nested.extend(model.all_scenes().filter(|s| !s.set.is_empty()).map(|_| "values"));
    nested.extend(model.equilibrium.as_ref().map(|_| "values"));
    let frequencies = program.frequencies.clone().unwrap_or_default();
    nested.extend(
        [program.restitutions(), program.start_condition_values(), frequencies]
            .iter()
            .filter(|list| !list.is_empty())
            .map(|_| "values"),
    );
    let others: Vec<&String> = judge.nested.iter().filter(|name| !name.starts_with("balances_")).collect();
    nested.sort_unstable();
    let mut found: Vec<&str> = others.iter().map(|name| name.as_str()).collect();
    found.sort_unstable();
    assert_eq!(found, nested, "{}", model.name);
    assert_eq!(judge.nested.len() - others.len(), model.balances.len(), "{}", model.name);

    let Some((Item::Macro(_), items)) = file.items.split_last() else { panic!("{}: its format", model.name) };
    let mut items = items.iter();
    let Some(Item::Struct(own)) = items.next() else { panic!("{}: a struct", model.name) };
    assert_eq!(own.ident, "Meant");
    let fields: Vec<String> = own.fields.iter().map(|f| f.ident.as_ref().unwrap().to_string()).collect();
    let mut meant: Vec<String> = Vec::new();
    for parameter in &model.parameters {
        let name = field_name(parameter.family.as_ref().map_or(&parameter.name, |family| &family.name));
        if !meant.contains(&name) {
            meant.push(name);
        }
    }
    assert_eq!(fields, meant);
    let mut blocks = items.map(|item| match item {
        Item::Impl(block) => {
            assert_eq!(ident(&block.self_ty), "Meant");
            let of = block.trait_.as_ref().map(|(path, ..)| path.segments.last().unwrap().ident.to_string());
            let functions: Vec<String> = block
                .items
                .iter()
                .filter_map(|item| match item {
                    ImplItem::Fn(function) => Some(function.sig.ident.to_string()),
                    ImplItem::Type(_) | ImplItem::Const(_) => None,
                    _ => panic!("{}: an associated item", model.name),
                })
                .collect();
            (of.unwrap_or_default(), functions)
        }
        _ => panic!("{}: an item that is no impl", model.name),
    });
    assert_eq!(blocks.next(), Some(("Default".to_owned(), vec!["default".to_owned()])));
    let timed = program.frequencies.as_ref().is_none_or(|list| !list.is_empty());
    let stands = |name: &str| match name {
        "part_accelerations" | "part_energy" => !program.parts.is_empty(),
        "gimbals" => locks,
        "frequencies" => timed,
        "motions" | "motion_numbers" => !model.motions.is_empty(),
        "sampling" => held,
        "held_noise" => !model.noise.is_empty(),
        "tables_2d" => tables,
        "contacts" => !model.contacts.is_empty(),
        "assignments" => !program.assignments.is_empty(),
        "eliminated" => program.constraints.eliminated.is_some(),
        "scene_memory" => !model.memory.is_empty(),
        "clock_numbers" => !model.clocks.is_empty(),
        "start_condition_speeds" => !program.start_condition_speeds().is_empty(),
        _ => true,
    };
    for (of, names) in [("Equations", EQUATIONS), ("Mechanism", RUNS)] {
        let meant = names.iter().filter(|name| stands(name)).map(|name| (*name).to_owned()).collect();
        assert_eq!(blocks.next(), Some((of.to_owned(), meant)));
    }
    if !methods.is_empty() {
        assert_eq!(blocks.next(), Some((String::new(), methods)));
    }
    assert_eq!(blocks.next(), None);
    let mut bound = judge.bound;
    // And their sines and cosines.
    let angle =
        |name: &str| name.trim_start_matches("sin_").trim_start_matches("cos_").trim_end_matches('_').to_owned();
    let angles: BTreeSet<String> = judge.constants.iter().map(|name| name.trim_end_matches('_').to_owned()).collect();
    bound.retain(|name| !judge.constants.contains(name) && !angles.contains(&angle(name)));
    bound
}

fn models() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let paths = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|e| e == "yaml")).collect();
    paths.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    paths.iter().map(|path| (name(path), fs::read_to_string(path).unwrap())).collect()
}

/// A name of a variable is the generator's own, or it is that of a coordinate, or made from one.
fn is_accounted_for(name: &str, program: &Program) -> bool {
    let made = |name: &str| {
        let rest = name.trim_start_matches("sin_").trim_start_matches("cos_");
        let rest = rest.trim_end_matches('_');
        let temporary = rest.strip_prefix('w').is_some_and(|number| number.parse::<u32>().is_ok());
        let coordinate = |of: &str| {
            let of = local_name(of);
            let of = of.trim_end_matches('_');
            [of.to_owned(), format!("{of}_dot"), format!("{of}_ddot")].iter().any(|n| n == rest || n == name)
        };
        let multiplier = |of: &str| name.starts_with(&format!("lambda_{}", local_name(of).trim_end_matches('_')));
        let constrained = program.model.constraints.iter().any(|c| multiplier(&c.name));
        let states = program.model.states.iter().any(|state| coordinate(&state.name));
        temporary
            || constrained
            || states
            || rest == "t"
            || program.model.coordinates.iter().any(|c| coordinate(&c.name))
    };
    OWN.contains(&name) || made(name.trim_end_matches('_'))
}

#[test]
fn the_librarys_models_print_what_is_meant() {
    let models = models();
    assert!(models.len() > 40);
    for (file, text) in models {
        let program = program(&text);
        for name in judge(&program) {
            assert!(is_accounted_for(&name, &program), "{file}: `{name}` belongs to no scope");
        }
    }
}

#[test]
fn a_model_in_which_every_section_stands_prints_what_is_meant() {
    let program = program(include_str!("../../fuzz/corpus/derive/whole.yaml"));
    for name in judge(&program) {
        assert!(is_accounted_for(&name, &program), "`{name}` belongs to no scope");
    }
}

/// `about`, units and other texts of the file, which are data wherever they stand.
#[test]
fn hostile_texts_end_no_comment_and_no_literal() {
    for text in [
        "a\\nconst _: () = panic!();",
        "a\\r\\nfn f() {}",
        "a\\rfn f() {}",
        "a\\u2028fn f() {}\\u2029\\x85\\v\\f",
        "*/ fn f() {} /*",
        "\\\"# fn f() {} //",
        "\\\\",
        "\\\\\\\" }",
        "\\u202e}fn f() {{\\u202c",
        "\\ufdd0 \\uffff \\0 \\x07",
        "```\\npanic!()\\n```",
        "    panic!()",
        "#![allow(unsafe_code)] {{}} {0}",
    ] {
        let text = format!(
            "name: Texts\nabout: \"{text}\"\nparameters: {{m: \"1 kg\\n*m/m\", k: \"2\\n N/m\"}}\ncoordinates: {{x: \"m\\n\"}}\n\
             bodies: {{a: {{mass: m, position: \"[x, 0]\"}}}}\nforces: {{f: {{on: a, force: \"[-k*x,\\n0]\"}}}}\n"
        );
        match compile(&text, &[]) {
            Ok(program) => {
                judge(&program);
            }
            // YAML itself refuses some control characters.
            Err(problems) => assert!(problems.iter().all(|p| p.code.starts_with("E0")), "{text}: {problems:?}"),
        }
    }
    let long = "x".repeat(100_000);
    judge(&program(&format!("name: Long\nabout: {long}\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n")));
}

/// `inject.yaml`: the name of a system of balances ended a comment, and what followed was compiled.
#[test]
fn names_of_systems_and_scenes_are_keys_of_the_language() {
    let model = |system: &str, scene: &str| {
        format!(
            "name: Inject\nparameters: {{m: 1 kg}}\ncoordinates: {{x: m}}\nbodies: {{a: {{mass: m, position: \"[x, 0]\"}}}}\n\
             balances:\n  {system}:\n    equations:\n      - force: {{of: [a], along: [1, 0]}}\n\
             scenes:\n  {scene}: {{start: {{x': 1}}}}\n"
        )
    };
    for hostile in
        ["\"a\\nconst _: () = panic!(\\\"pwned\\\"); //\"", "\"a b\"", "a-b", "\"\"", "\"//\"", "1", "\"a'\""]
    {
        for text in [model(hostile, "fast"), model("newton", hostile)] {
            let problems = compile(&text, &[]).unwrap_err();
            assert!(problems.iter().all(|p| p.code.starts_with("E1") && p.place.key), "{text}: {problems:?}");
        }
    }
    assert_eq!(compile(&model("\"a[i in 1..2]\"", "fast"), &[]).unwrap_err()[0].code, "E312");
    assert_eq!(compile(&model("newton", "\"a[i in 1..2]\""), &[]).unwrap_err()[0].code, "E312");
    for good in ["newton", "θ", "\"run[2]\"", "fn", "Self"] {
        judge(&program(&model(good, good)));
    }
}

/// The skeleton of a type whose file is wrong parses too.
#[test]
fn skeletons_are_rust() {
    for name in ["Pendulum", "S", "Vec", "Model11"] {
        syn::parse_str::<syn::File>(&skeleton(name)).unwrap();
    }
}

/// Parameters with one name in Rust, and their neighbours that have two.
#[test]
fn parameters_that_would_be_one_field_are_refused() {
    let codes = |parameters: &str| {
        let text = format!("name: M\nparameters: {parameters}\ncoordinates: {{x: }}\nkinetic_energy: x'^2/2\n");
        match compile(&text, &[]) {
            Ok(program) => {
                judge(&program);
                Vec::new()
            }
            Err(problems) => problems.iter().map(|p| p.code).collect(),
        }
    };
    assert_eq!(codes("{θ: 1, theta: 2}"), ["E313", "E313"]);
    assert_eq!(codes("{µ: 1, μ: 2}"), ["E313", "E313"]);
    assert_eq!(codes("{é: 1, \"e\\u0301\": 2}"), ["E313", "E313"]);
    assert_eq!(codes("{self: 1, self_: 2}"), ["E313", "E313"]);
    assert_eq!(codes("{a: 1, clone: 2*a, clone_: 3}"), ["E313", "E313"]);
    assert_eq!(codes("{\"θ[i in 1..2]\": 1, theta: 2}"), ["E313", "E313"]);
    assert_eq!(codes("{M: 1, m: 2, type: 3, clone: 4, Default: 5, \"_\": 6, __: 7, r: 8, gen: 9}"), [""; 0]);
    assert_eq!(codes("{a: 1, clone: 2*a, simulate: a, parameters: a, I: a, i: a, default: a, linearise: a}"), [""; 0]);
    assert_eq!(codes("{\"p[1]\": 1, \"p[1000000000]\": 2}"), ["E223"]);
    assert_eq!(codes("{\"p[i in 1..2, j in 0..1, k in 3..4]\": 1}"), [""; 0]);
}

/// Names that Rust, or the generator, uses for itself, as coordinates: each is bound once, and none is lost.
#[test]
fn no_two_coordinates_share_a_variable() {
    let mut names: Vec<String> = KEYWORDS.iter().chain(OWN).map(|name| (*name).to_owned()).collect();
    names.extend(
        ["theta", "sin_theta", "cos_theta", "x", "x_dot", "x_ddot", "X", "w1", "w2", "w1_", "m", "_", "__"]
            .map(str::to_owned),
    );
    names.sort();
    names.dedup();
    names.retain(|name| !dalembert_symbolic::language::is_reserved(name));
    let coordinates: Vec<String> = names.iter().map(|name| format!("{name}: ")).collect();
    let energy: Vec<String> = names.iter().map(|name| format!("{name}'^2*(2 + sin({name}))")).collect();
    let text =
        format!("name: Own\ncoordinates: {{{}}}\nkinetic_energy: {}\n", coordinates.join(", "), energy.join(" + "));
    let program = program(&text);
    let text = rust(&program, "", "Own");
    let file: syn::File = syn::parse_str(&text).unwrap();
    struct Twice(Vec<BTreeSet<String>>, Vec<String>);
    impl<'ast> Visit<'ast> for Twice {
        fn visit_impl_item_fn(&mut self, node: &'ast syn::ImplItemFn) {
            self.0.push(BTreeSet::new());
            visit::visit_impl_item_fn(self, node);
            self.0.pop();
        }
        fn visit_pat_ident(&mut self, node: &'ast syn::PatIdent) {
            if let Some(names) = self.0.last_mut()
                && !names.insert(node.ident.to_string())
            {
                self.1.push(node.ident.to_string());
            }
        }
    }
    let mut twice = Twice(Vec::new(), Vec::new());
    twice.visit_file(&file);
    // Closures over lanes bind `i`, and the start of scenes has the names of the function around it.
    twice.1.retain(|name| !["i", "x", "out", "scene"].contains(&name.as_str()));
    assert!(twice.1.is_empty(), "{:?}", twice.1);
    assert!(text.contains("in_"));
}
