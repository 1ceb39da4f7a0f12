//! References in double-double against closed forms and longer numbers.

use dalembert_symbolic::lower::compile_in;

use super::{Arithmetic, Candidate, Reference};
use crate::Settings;
use crate::mechanism::{Interpreted, System};

#[test]
fn survey() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../models");
    let only = std::env::var("ONLY").ok();
    let mut paths: Vec<_> = std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "yaml")).collect();
    paths.sort();
    for path in paths {
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        if only.as_ref().is_some_and(|o| !name.contains(o.as_str())) { continue }
        let text = std::fs::read_to_string(&path).unwrap();
        let Ok(program) = compile_in(Some(&folder), &text, &[]) else { println!("{name}: no"); continue };
        let model = Interpreted::new(program, &text);
        for (k, scene) in model.description().scenes.clone().iter().enumerate() {
            let mut system = model.clone();
            for (index, value) in system.scene_parameters(k) { system.set_parameter(index, value); }
            let candidate = Candidate::new("x", &system, Settings::new(&system.scene(k)));
            let clock = std::time::Instant::now();
            let found = match Reference::find(&candidate, &[]) { Ok(f) => f, Err(e) => { println!("{name} {scene}: {e}"); continue } };
            let before = (found.agreement, found.floor(), clock.elapsed().as_secs_f64());
            let clock = std::time::Instant::now();
            let found = found.extended(&candidate, &model);
            match &found.arithmetic {
                Arithmetic::Double { why } => println!("{name} {scene}: {why} ({:.1e})", before.0),
                Arithmetic::DoubleDouble { agreement, from_double } => println!("{name} {scene}: dd {agreement:.1e}, {} digits, double {:.1e} from {from_double:.1e} ratio to floor {:.2}; ops {}, n {} {:.1}s vs {:.1}s", found.digits(), before.0, from_double / before.1, model.description().counts.mass_and_bias, system.len(), clock.elapsed().as_secs_f64(), before.2),
            }
        }
    }
}
