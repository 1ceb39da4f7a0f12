//! What watching costs: steps, evaluations and samples of ordinary scenes.
//!
//! `cargo run --release --example watching -p dalembert-tests > docs/watching.md`

use dalembert_tests::case::Case;
use dalembert_tests::watching::{SCENES, row};

fn main() {
    println!("# What watching costs\n");
    println!("Of each scene: accepted steps; evaluations of the accelerations by the methods themselves and with what is asked");
    println!("between the ends of a step (one evaluation each, and what retries cost); retries; samples of events, discontinuities");
    println!("and arguments per step, none of which evaluates accelerations.\n");
    println!("| scene | steps | method | with watching | more | retries | samples a step |");
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for (name, scene) in SCENES {
        let case = Case::new(name);
        let mut case = if scene.is_empty() { case } else { case.scene(scene) };
        println!("{}", row(name, scene, &case.run()));
    }
}
