//! Whatever a file calls its things, compiled code computes what the interpreter computes.

use dalembert::mechanism::{Dynamic, Interpreted, System};
use dalembert_symbolic::lower::compile;
use dalembert_symbolic::model::METHODS;
use dalembert_tests::at_once::at_once;
use dalembert_tests::both::{Drawn, assert_same};
use std::path::Path;

/// Name, text, and the compiled system.
type Entry = (&'static str, &'static str, fn() -> Box<dyn System>);

// A megabyte of model files, whose code takes minutes to derive: checks of style leave it out.
#[cfg(not(clippy))]
include!(concat!(env!("OUT_DIR"), "/hostile.rs"));

#[cfg(clippy)]
const HOSTILE: [Entry; 0] = [];

/// Numbers between -1 and 1, always the same.
struct Draws(u64);

impl Draws {
    fn list(&mut self, n: usize) -> Vec<f64> {
        let mut next = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..n).map(|_| next()).collect()
    }
}

#[track_caller]
fn compare(name: &str, text: &str, mut compiled: Box<dyn System>) {
    let program = compile(text, &[]).unwrap_or_else(|problems| panic!("{name}: {problems:?}"));
    let mut interpreted = Interpreted::new(program, text);
    let mut draws = Draws(8);
    for scene in 0..compiled.description().scenes.len() {
        assert_eq!(compiled.scene(scene), interpreted.scene(scene), "{name}");
        assert_eq!(compiled.scene_parameters(scene), interpreted.scene_parameters(scene), "{name}");
    }
    for _ in 0..3 {
        for (index, factor) in draws.list(compiled.parameters().len()).into_iter().enumerate() {
            let value = compiled.parameters()[index] * (1.0 + factor / 4.0);
            compiled.set_parameter(index, value);
            interpreted.set_parameter(index, value);
        }
        let n = compiled.len();
        let state = Drawn { t: 0.7, q: draws.list(n), v: draws.list(n), a: draws.list(n) };
        assert_same(name, &*compiled, &interpreted, &state, 1e-13);
    }
}

#[test]
fn hostile_names_at_every_section() {
    assert_eq!(HOSTILE.len(), 15);
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    at_once(0..HOSTILE.len() as u64, threads, |k| {
        let (name, text, system) = HOSTILE[k as usize];
        compare(name, text, system());
    });
}

/// `shadow.yaml`: a coordinate called `sin_theta` was hidden by `let sin_theta = …`.
mod shadow {
    pub const TEXT: &str = include_str!("names/shadow.yaml");
    dalembert::model!("tests/names/shadow.yaml");
}

#[test]
fn a_coordinate_is_not_hidden_by_a_sine() {
    compare("shadow", shadow::TEXT, Box::new(Dynamic::new(shadow::Shadow::default())));
}

/// A module that has given away every name that generated code might take for Rust's, types of such names, and a
/// derived parameter for every field.
#[expect(dead_code, reason = "names that are only in the way")]
mod crowded {
    pub struct Vec;
    pub struct Option;
    pub struct Result;
    pub struct Box;
    pub struct Fn;
    pub struct Some;
    pub struct None;
    pub struct Ok;
    pub struct Err;
    pub struct Mechanism;
    pub struct Description;
    pub mod core {}
    pub mod std {}
    pub mod mechanism {}
    pub trait Clone {}
    pub trait Sized {}
    pub trait Iterator {}
    pub trait Default {}

    pub const TEXT: &str = "name: Crowded\nparameters: {a: 2, b: 3*a, clone: a^2}\ncoordinates: {x: , m: }\n\
        inputs: {u: sin(t)}\nkinetic_energy: b*x'^2/2 + clone*m'^2*(2 + cos(x))\npotential_energy: a*x^2/2 + abs(x)\n\
        generalized_forces: {x: u - abs(x')}\nscenes: {far: {set: {a: 5}}}\nequilibrium: {x: a}\n";

    pub mod of_types {
        pub mod default {
            dalembert::model!(
                yaml = "name: Crowded\nparameters: {a: 2, b: 3*a, clone: a^2}\ncoordinates: {x: , m: }\ninputs: {u: sin(t)}\nkinetic_energy: b*x'^2/2 + clone*m'^2*(2 + cos(x))\npotential_energy: a*x^2/2 + abs(x)\ngeneralized_forces: {x: u - abs(x')}\nscenes: {far: {set: {a: 5}}}\nequilibrium: {x: a}\n",
                name = Default
            );
        }
        pub mod clone {
            dalembert::model!(
                yaml = "name: Crowded\nparameters: {a: 2}\ncoordinates: {x: }\nkinetic_energy: a*x'^2/2\n",
                name = Clone
            );
        }
        pub mod s {
            dalembert::model!(
                yaml = "name: Crowded\nparameters: {a: 2}\ncoordinates: {x: }\nkinetic_energy: a*x'^2/2\n",
                name = S
            );
        }
        pub mod iterator {
            dalembert::model!(
                yaml = "name: Crowded\nparameters: {a: 2}\ncoordinates: {x: }\nkinetic_energy: a*x'^2/2\n",
                name = IntoIterator
            );
        }
    }

    dalembert::model!(
        yaml = "name: Crowded\nparameters: {a: 2, b: 3*a, clone: a^2}\ncoordinates: {x: , m: }\ninputs: {u: sin(t)}\nkinetic_energy: b*x'^2/2 + clone*m'^2*(2 + cos(x))\npotential_energy: a*x^2/2 + abs(x)\ngeneralized_forces: {x: u - abs(x')}\nscenes: {far: {set: {a: 5}}}\nequilibrium: {x: a}\n"
    );
}

#[test]
fn a_module_may_have_any_names_of_its_own() {
    compare("crowded", crowded::TEXT, Box::new(Dynamic::new(crowded::Crowded::default())));
    compare("Default", crowded::TEXT, Box::new(Dynamic::new(crowded::of_types::default::Default::default())));
    assert_eq!(crowded::of_types::s::S::default().a, 2.0);
    assert_eq!(crowded::of_types::clone::Clone::default(), crowded::of_types::clone::Clone { a: 2.0 });
    assert_eq!(crowded::of_types::iterator::IntoIterator::default().a, 2.0);
    let crowded = crowded::Crowded { a: 3.0 };
    assert_eq!((crowded.b(), crowded.clone_()), (9.0, 9.0));
    assert_eq!(crowded.clone(), crowded);
}

/// A method that the runtime gives every mechanism is none that a derived parameter may have.
#[test]
fn every_method_of_a_mechanism_is_kept_free() {
    assert!(METHODS.is_sorted());
    let mut found = 0;
    let mut folders =
        ["../runtime/src", "../mechanism/src"].map(|f| Path::new(env!("CARGO_MANIFEST_DIR")).join(f)).to_vec();
    while let Some(folder) = folders.pop() {
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            let mut of_mechanism = false;
            for line in text.lines() {
                if line.starts_with("pub trait") {
                    let traits = ["trait Equations<", "trait Mechanism<", ": Mechanism<"];
                    of_mechanism = traits.iter().any(|name| line.contains(name));
                }
                of_mechanism &= !line.starts_with('}');
                if let (true, Some(rest)) = (of_mechanism, line.strip_prefix("    fn ")) {
                    let name = rest.split(['<', '(']).next().unwrap_or_default();
                    assert!(METHODS.contains(&name), "{}: `{name}`", path.display());
                    found += 1;
                }
            }
        }
    }
    assert!(found > 30, "{found}");
}
