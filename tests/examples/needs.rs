//! What the scenes of the library need, as `docs/needs.md` has it: run with `--release`, and write to that file.

use std::ops::ControlFlow;

use dalembert::needs::{Need, Needs, NeedsRequest};
use dalembert_models::MODELS;

/// Files with something to leave out, what they are, and what is written otherwise in them.
const FILES: [(&str, &str, &str, [&str; 2]); 7] = [
    ("crane", "a crane with a steel rope", include_str!("../needs/crane.yaml"), ["", ""]),
    (
        "quarter_car",
        "a quarter of a car, its emblem's pin at 40 Hz",
        include_str!("../needs/quarter_car.yaml"),
        ["200 Hz\n", "40 Hz\n"],
    ),
    ("quarter_car", "at 80 Hz", include_str!("../needs/quarter_car.yaml"), ["200 Hz\n", "80 Hz\n"]),
    ("quarter_car", "at 200 Hz", include_str!("../needs/quarter_car.yaml"), ["", ""]),
    ("spring_pendulum", "a bob on a stiff spring", include_str!("../needs/spring_pendulum.yaml"), ["", ""]),
    ("geared_rotor", "a light coupling between two shafts", include_str!("../needs/geared_rotor.yaml"), ["", ""]),
    ("hanging_chain", "forty links under a cart", include_str!("../needs/hanging_chain.yaml"), ["", ""]),
];

fn main() {
    println!("# What scenes need\n\n## Files with something to leave out\n");
    println!("As `needs FILE` prints it for the files in `tests/needs`, with what they say that they need.\n");
    for (name, what, source, [from, to]) in FILES {
        let source = if from.is_empty() { source.to_owned() } else { source.replacen(from, to, 1) };
        let found = Needs::find(&NeedsRequest::new(source), &mut |_| ControlFlow::Continue(())).expect("an answer");
        println!("`{name}.yaml`: {what}\n\n```text\n{}```\n", found.table());
    }
    println!(
        "## The library\n\n\
         Every model and scene, asked for all its coordinates and outputs to a thousandth of the range of each: what it does\n\
         without (what saves less than a twentieth of the work stays), by how much it is off then, integration included, and what\n\
         that saves. Most models are minimal already, and what is saved is the tolerance.\n\n\
         Regenerate: `cargo run --release --example needs -p dalembert-tests > docs/needs.md`.\n\n\
         | model | scene | goes | tolerance | predicted | found | with integration | operations | less work |\n\
         | --- | --- | --- | --: | --: | --: | --: | --: | --: |"
    );
    for model in MODELS {
        let names = dalembert_symbolic::model::load(model.source, &[]).expect("a model");
        for scene in &names.scenes {
            let request = NeedsRequest {
                scene: Some(scene.name.clone()),
                need: Some(Need::default()),
                ..NeedsRequest::new(model.source)
            };
            println!("| {} | {} | {} |", model.name, scene.name, row(&request));
        }
    }
}

fn row(request: &NeedsRequest) -> String {
    let found = match Needs::find(request, &mut |_| ControlFlow::Continue(())) {
        Ok(found) => found,
        Err(error) => return format!("not asked: {error} | | | | | |"),
    };
    let until = found.promised_until.map_or_else(String::new, |t| format!(" (promised until t = {t:.3} s)"));
    let Some(choice) = &found.choice else {
        return format!("nothing{until} | | | | | {:.0} | 1", found.operations);
    };
    assert!(choice.verified <= request.need.as_ref().map_or(0.0, |need| need.within), "{}", found.table());
    let goes = if choice.members.is_empty() { "nothing".to_owned() } else { choice.members.join(", ") };
    let predicted = match choice.predicted {
        Some(predicted) => format!("{predicted:.1e} | {:.1e}", choice.change),
        None => " | ".to_owned(),
    };
    format!(
        "{goes}{until} | {:e} | {predicted} | {:.1e} | {:.0} → {:.0} | {:.1}",
        choice.tolerance, choice.verified, found.operations, choice.operations, choice.saving
    )
}
