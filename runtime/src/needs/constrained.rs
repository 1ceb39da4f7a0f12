//! The file with a constraint in the place of what is stiff, and its scenes, which start as before.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::edit::{keys, replaced, source, value, with, with_at, without};

use super::edit::{key, scalar};
use super::rigid::Rigid;

/// The file with a constraint; `None` where it is not written so that it can be put in.
pub(super) fn constrained(text: &str, rigid: &Rigid) -> Option<String> {
    let mut text = match &rigid.gone {
        Some(path) => without(text, path)?,
        None => text.to_owned(),
    };
    for (path, read) in &rigid.outputs {
        if source(&text, path).is_some() {
            text = replaced(&text, path, &scalar(read))?;
        }
    }
    for scene in scenes(&text) {
        text = started(text, &scene, rigid)?;
    }
    let behind = if source(&text, &[key("bodies")]).is_some() { "bodies" } else { "coordinates" };
    text = with(&text, "constraints", behind, &rigid.label, &scalar(&rigid.equation))?;
    for (name, value) in rigid.parameters.iter().rev() {
        text = with(&text, "parameters", "name", name, value)?;
    }
    Some(text)
}

fn scenes(text: &str) -> Vec<Vec<Step>> {
    let others = keys(text, &[key("scenes")]);
    std::iter::once(vec![key("scene")]).chain(others.iter().map(|name| vec![key("scenes"), key(name)])).collect()
}

/// A scene that starts as before, but for places that are guessed now, and rates of what is held, 0; what was not named was 0.
fn started(text: String, scene: &[Step], rigid: &Rigid) -> Option<String> {
    let own = |section: &str| [scene, &[key(section)]].concat();
    let start = own("start");
    let is_default = scene.len() == 1;
    if source(&text, &start).is_none() && !is_default {
        // It inherits the start.
        return Some(text);
    }
    let mut text = text;
    let mut named = keys(&text, &start);
    for name in rigid.guessed.iter().filter(|name| named.contains(name)) {
        let path = [start.as_slice(), &[key(name)]].concat();
        let written = value(&text, &path)?;
        text = without(&text, &path)?;
        // What is held needs no guess.
        if rigid.spring.is_some() {
            text = put(&text, scene, "guess", name, &scalar(&written))?;
        }
    }
    let guessed = keys(&text, &own("guess"));
    named.extend(guessed);
    for name in rigid.coordinates.iter().rev() {
        let held = rigid.spring.is_none() && rigid.guessed.contains(name);
        let rate = format!("{name}'");
        if held {
            let path = [start.as_slice(), &[key(&rate)]].concat();
            text = without(&text, &path).unwrap_or(text);
        } else if !named.contains(&rate) {
            text = put(&text, scene, "start", &rate, "0")?;
        }
        if !named.contains(name) && !rigid.guessed.contains(name) {
            text = put(&text, scene, "start", name, "0")?;
        }
    }
    Some(text)
}

/// A scene with an entry more in one of its mappings.
fn put(text: &str, scene: &[Step], section: &str, name: &str, value: &str) -> Option<String> {
    let path = [scene, &[key(section)]].concat();
    match source(text, &path) {
        Some(_) => with_at(text, &path, name, value),
        None => with_at(text, scene, section, &format!("{{{name}: {value}}}")),
    }
}
