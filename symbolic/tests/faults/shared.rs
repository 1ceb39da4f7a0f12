// Faults in data that all derivations share: no comparison of them can see these, but a `checks` line may.

use dalembert_symbolic::file::Node;
use dalembert_symbolic::gate::judged;
use dalembert_symbolic::model::resolve;

use super::judge::Window;
use super::tree::{at, entries, get, items, text, to_key, with};
use super::{NOTHING, Sound};

/// Who noticed a fault in shared data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Notice {
    /// The systems of balances: they write the datum out themselves.
    Balances,
    /// `checks` or `conserved`.
    Claims,
    /// Nobody, though the motion is another.
    Nobody,
    /// Nobody, and the motion is the same.
    Same,
}

/// Every fault in the shared data of a model: kind and who noticed.
pub fn notices(sound: &Sound) -> Vec<(&'static str, Notice)> {
    planted(&sound.root).into_iter().map(|(kind, root)| (kind, notice(sound, &root))).collect()
}

fn planted(root: &Node) -> Vec<(&'static str, Node)> {
    let mut found = Vec::new();
    let mut put = |kind, path: &[usize], wrap: &dyn Fn(&str) -> String| {
        if let Some(old) = at(root, path).and_then(text) {
            found.push((kind, with(root, path, Some(Node::Scalar(wrap(old))))));
        }
    };
    if let Some(bodies) = to_key(root, &[], "bodies") {
        for k in 0..get(root, "bodies").map_or(&[][..], entries).len() {
            let body = [bodies.as_slice(), &[k]].concat();
            for (key, kind) in [("mass", "twice a mass"), ("inertia", "twice an inertia")] {
                if let Some(path) = to_key(root, &body, key) {
                    put(kind, &path, &|old| format!("2*({old})"));
                }
            }
        }
    }
    if let Some(gravity) = to_key(root, &[], "gravity") {
        for k in 0..at(root, &gravity).map_or(&[][..], items).len() {
            put("gravity upwards", &[gravity.as_slice(), &[k]].concat(), &|old| format!("-({old})"));
        }
    }
    for (section, key, kind) in
        [("springs", "stiffness", "a spring twice as stiff"), ("dampers", "damping", "a damper twice as strong")]
    {
        let Some(loads) = to_key(root, &[], section) else { continue };
        for k in 0..get(root, section).map_or(&[][..], entries).len() {
            if let Some(path) = to_key(root, &[loads.as_slice(), &[k]].concat(), key) {
                put(kind, &path, &|old| format!("2*({old})"));
            }
        }
    }
    found.retain(|f| f.1 != *root);
    found
}

fn notice(sound: &Sound, root: &Node) -> Notice {
    let Ok(model) = resolve(root, &sound.sizes) else { return Notice::Claims };
    match judged(model.clone()) {
        Err(problems) if problems.iter().any(|p| p.code == "E506") => Notice::Balances,
        Err(_) => Notice::Claims,
        Ok(judged) if sound.judge.difference(&judged.derivation, &Window::new()).0 <= NOTHING => Notice::Same,
        Ok(_) => Notice::Nobody,
    }
}
