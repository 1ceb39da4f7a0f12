//! What can be asked.

use std::ops::ControlFlow;

use dalembert::Settings;
use dalembert::cli::{LoadError, Session};
use dalembert::mechanism::System;
use serde_json::{Map, Value, json};

/// A run of the page takes no more steps than these, some seconds; of one that needs more the beginning is shown.
const MOST_STEPS: u64 = 100_000;

/// The model that is asked about: the last one that was, derived.
#[derive(Default)]
pub struct Desk {
    kept: Option<(Value, Session)>,
}

impl Desk {
    /// Answers a question: `{"what": "load", "name": …, "text": …}`, or `run` or `modes` with the `options` of the program's commands.  Where there is
    /// no other answer it is `{"error": …}`.
    pub fn answer(&mut self, question: &[u8]) -> Value {
        let found = serde_json::from_slice(question).map_err(|error| error.to_string());
        found.and_then(|question| self.found(&question)).unwrap_or_else(|error| json!({ "error": error }))
    }

    fn found(&mut self, question: &Value) -> Result<Value, String> {
        let session = self.session(&question["model"])?;
        let options = question["options"].as_array().into_iter().flatten();
        let options: Vec<String> = options.filter_map(|option| option.as_str().map(str::to_owned)).collect();
        match question["what"].as_str() {
            Some("load") => Ok(described(session)),
            Some("run") => run(session, options),
            Some("modes") => modes(session, &options),
            other => Err(format!("nothing is called {}", other.unwrap_or("so"))),
        }
    }

    /// The model of this name and text, which is derived where it is another than the last.
    fn session(&mut self, model: &Value) -> Result<&Session, String> {
        let session = match self.kept.take() {
            Some((known, session)) if known == *model => session,
            _ => {
                let text = |key: &str| model[key].as_str().unwrap_or_default();
                Session::of_text(&[], (text("name"), text("text")), Vec::new()).map_err(|error| match error {
                    LoadError::Wrong { text, .. } => text,
                    other => other.to_string(),
                })?
            }
        };
        Ok(&self.kept.insert((model.clone(), session)).1)
    }
}

/// What a page needs to know of a model: its free parameters, and its scenes with their values of these.
fn described(session: &Session) -> Value {
    let system = session.system();
    let description = system.description();
    let parameters = description.parameters.iter();
    let parameters: Vec<Value> = parameters
        .map(|parameter| json!({ "name": parameter.name, "unit": parameter.unit, "value": parameter.default }))
        .collect();
    let scenes: Vec<Value> =
        description.scenes.iter().enumerate().map(|(index, name)| scene(&*system, index, name)).collect();
    json!({
        "warnings": session.warned(),
        "about": description.about,
        "parameters": parameters,
        "scenes": scenes,
    })
}

fn scene(system: &dyn System, index: usize, name: &str) -> Value {
    let settings = Settings::of_scene(system, index);
    let parameters = &system.description().parameters;
    let changed = system.scene_parameters(index).into_iter();
    let changed: Map<String, Value> =
        changed.map(|(place, value)| (parameters[place].name.to_string(), value.into())).collect();
    json!({ "name": name, "tolerance": settings.tolerance, "until": settings.until, "parameters": changed })
}

/// A scene's motion: its animation, its charts, its end, and what the program says of it.
fn run(session: &Session, mut options: Vec<String>) -> Result<Value, String> {
    options.push(format!("--max-steps={MOST_STEPS}"));
    let simulated =
        session.simulate(&options, &mut || ControlFlow::Continue(())).map_err(|problem| problem.to_string())?;
    let coordinates = session.system();
    let coordinates: Vec<&str> =
        coordinates.description().coordinates.iter().map(|c| c.state().unwrap_or(&c.name)).collect();
    let end: Map<String, Value> =
        simulated.run.last().entries().map(|(name, value)| (name.to_string(), value.into())).collect();
    Ok(json!({
        "end": end,
        "failed": simulated.failed.as_ref().map(|(why, _)| format!("error: {why}")),
        "words": simulated.text,
        "chart": simulated.figure(&[coordinates.join(",")], None).map_err(|problem| problem.to_string())?,
        "animation": simulated.run.animation().to_html(),
    }))
}

/// What `modes` says of small motions.
fn modes(session: &Session, options: &[String]) -> Result<Value, String> {
    let answer = session.modes(options);
    match answer.problem {
        Some(problem) => Err(problem.to_string()),
        None => Ok(json!({ "words": answer.text })),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SWING: &str = "
name: Swing
parameters: {m: 1 kg, l: 2 m, g: 9.81 m/s^2}
coordinates: {theta: rad}
bodies: {bob: {mass: m, position: \"l*[sin(theta), -cos(theta)]\"}}
gravity: [0, -g]
draw: [{line: [[0, 0], bob]}]
scene: {start: {theta: 0.1}, until: 3, tolerance: 1e-9}
scenes:
  short: {start: {theta: 0.1}, until: 2, set: {l: 1 m}}
";

    fn asked(desk: &mut Desk, what: &str, text: &str, options: &[&str]) -> Value {
        let model = json!({ "name": "swing", "text": text });
        desk.answer(json!({ "what": what, "model": model, "options": options }).to_string().as_bytes())
    }

    #[test]
    fn a_file_tells_its_parameters_and_its_scenes() {
        let found = asked(&mut Desk::default(), "load", SWING, &[]);
        assert_eq!(found["parameters"][1], json!({ "name": "l", "unit": "m", "value": 2.0 }));
        assert_eq!(found["parameters"].as_array().map(Vec::len), Some(3));
        let first = json!({ "name": "scene", "tolerance": 1e-9, "until": 3.0, "parameters": {} });
        assert_eq!(found["scenes"][0], first);
        assert_eq!(found["scenes"][1]["parameters"], json!({ "l": 1.0 }));
    }

    #[test]
    fn a_motion_comes_with_its_pictures_and_words() {
        let mut desk = Desk::default();
        let found = asked(&mut desk, "run", SWING, &["--scene=short", "--set=m=3"]);
        let [words, chart, animation] = ["words", "chart", "animation"].map(|key| found[key].as_str().unwrap());
        assert!(words.starts_with("swing at t = 2, by") && words.contains("\ndrift "), "{words}");
        assert!(chart.starts_with("<svg") && animation.starts_with("<!doctype html>"));
        assert!(found["failed"].is_null() && found["end"]["theta'"].is_f64(), "{found}");
        let small = asked(&mut desk, "modes", SWING, &["--set=l=1"]);
        assert!(small["words"].as_str().unwrap().contains("0.498488 Hz"), "{small}");
    }

    #[test]
    fn what_cannot_be_answered_is_an_error() {
        let mut desk = Desk::default();
        let error = |found: Value| found["error"].as_str().unwrap().to_owned();
        let wrong = error(asked(&mut desk, "run", &SWING.replace("-g]", "-gg]"), &[]));
        assert!(wrong.contains("swing.yaml:6:15") && wrong.contains("^^"), "{wrong}");
        assert!(error(asked(&mut desk, "run", SWING, &["--set=q=1"])).contains("no parameter is called `q`"));
        assert!(error(asked(&mut desk, "dance", SWING, &[])).contains("dance"));
        assert!(error(desk.answer(b"{")).contains("EOF"));
        // What failed is not kept.
        assert!(asked(&mut desk, "load", SWING, &[])["error"].is_null());
    }
}
