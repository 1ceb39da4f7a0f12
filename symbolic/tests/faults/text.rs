// Faults in the text of a file that only one derivation sees: balances, reactions, placements of loads, checks.

use dalembert_symbolic::diagnose::Step;
use dalembert_symbolic::file::Node;
use dalembert_symbolic::model::Model;

use super::expression::{Slip, slips};
use super::judge::Window;
use super::tree::{Path, at, entries, get, items, text, to_key, with, with_entry};
use super::{Fault, Plant, Watch};

/// What a file offers to be put in a wrong place.
struct Names {
    bodies: Vec<String>,
    points: Vec<String>,
}

/// What only says what holds, or is conserved.
const CLAIMS: [&str; 3] = ["checks of an energy", "other checks", "conserved"];

/// Collects faults of one file.
struct Planter<'a> {
    root: &'a Node,
    names: Names,
    faults: Vec<Fault>,
}

/// Every fault of the text.
pub fn faults(root: &Node, model: &Model) -> Vec<Fault> {
    let bodies: Vec<String> = model.bodies.iter().map(|b| b.name.clone()).collect();
    let named = get(root, "points").map_or(&[][..], entries).iter().map(|e| e.0.clone());
    let points = named.filter(|p| !p.contains(" in ")).chain(bodies.iter().cloned()).collect();
    let mut planter = Planter { root, names: Names { bodies, points }, faults: Vec::new() };
    planter.systems();
    if !model.balances.is_empty() {
        planter.loads();
    }
    planter.checks();
    planter.conserved();
    planter.faults
}

impl Planter<'_> {
    fn plant(&mut self, kind: &str, watch: &Watch, what: String, root: Node) {
        let root = Box::new(root);
        self.faults.push(Fault {
            kind: kind.to_owned(),
            what,
            watch: watch.clone(),
            plant: Plant::Text(root),
            window: Window::new(),
        });
    }

    /// Replaces the text at a path.
    fn replace(&mut self, kind: &str, watch: &Watch, path: &[usize], new: &str) {
        let old = at(self.root, path).and_then(text).unwrap_or("").to_owned();
        if old.trim() != new.trim() {
            let root = with(self.root, path, Some(Node::Scalar(new.to_owned())));
            let (new, old) = difference(new, &old);
            self.plant(kind, watch, format!("`{new}` for `{old}`"), root);
        }
    }

    /// Every slip of the expression at a path, as a kind of its own under `subject`, or of this one kind if it has a colon.
    fn slip(&mut self, subject: &str, watch: &Watch, path: &[usize]) {
        let Some(old) = at(self.root, path).and_then(text) else { return };
        let points = self.names.points.clone();
        for (slip, new) in slips(old, &points) {
            // Other points in `about` are a kind of their own.
            if CLAIMS.contains(&subject) && !slip.plain() || subject.contains("about") && slip == Slip::Point {
                continue;
            }
            let kind = if subject.contains(": ") { subject.to_owned() } else { format!("{subject}: {}", slip.words()) };
            self.replace(&kind, watch, path, &new);
        }
    }

    fn systems(&mut self) {
        let Some(path) = to_key(self.root, &[], "balances") else { return };
        let Some(balances) = at(self.root, &path) else { return };
        if get(balances, "equations").is_some() {
            return self.system("balances", &path);
        }
        for (k, (name, _)) in entries(balances).iter().enumerate() {
            self.system(name, &[path.as_slice(), &[k]].concat());
        }
    }

    fn system(&mut self, name: &str, path: &[usize]) {
        let watch = Watch::System(name.to_owned());
        let root = self.root;
        if let Some(equations) = to_key(root, path, "equations")
            && let Some(node) = at(root, &equations)
        {
            let all: Vec<(String, &Node)> = match node {
                Node::List(list) => list.iter().enumerate().map(|(k, n)| (format!("{}", k + 1), n)).collect(),
                _ => entries(node).iter().map(|(key, n)| (key.clone(), n)).collect(),
            };
            for (k, (label, _)) in all.iter().enumerate() {
                let here: Path = [equations.as_slice(), &[k]].concat();
                self.plant(
                    "balances: an equation left out",
                    &watch,
                    format!("without {label}"),
                    with(root, &here, None),
                );
                let (other_label, other) = &all[(k + 1) % all.len()];
                if all.len() > 1 {
                    let twice = with(root, &here, Some((*other).clone()));
                    self.plant(
                        "balances: an equation given twice",
                        &watch,
                        format!("{other_label} in place of {label}"),
                        twice,
                    );
                }
                self.balance(&watch, &here);
            }
        }
        if let Some(reactions) = to_key(root, path, "reactions") {
            for k in 0..at(root, &reactions).map_or(&[][..], entries).len() {
                self.placement("reactions", &watch, &[reactions.as_slice(), &[k]].concat());
            }
        }
    }

    fn balance(&mut self, watch: &Watch, path: &[usize]) {
        let root = self.root;
        if let Some(equation) = to_key(root, path, "equation") {
            self.slip("written-out equations", watch, &equation);
        }
        for kind in ["moment", "force", "power"] {
            let Some(inner) = to_key(root, path, kind) else { continue };
            if let Some(about) = to_key(root, &inner, "about") {
                for point in self.names.points.clone() {
                    self.replace("balances: a moment about another point", watch, &about, &point);
                }
                self.slip("balances, expressions in `about`", watch, &about);
            }
            if let Some(along) = to_key(root, &inner, "along") {
                for direction in ["ground.x", "ground.y"] {
                    self.replace("balances: another direction in `along`", watch, &along, direction);
                }
                self.slip("balances, expressions in `along`", watch, &along);
                let root = with(root, &along, None);
                self.plant("balances: another direction in `along`", watch, "without `along`".to_owned(), root);
            }
            if let Some(of) = to_key(root, &inner, "of") {
                self.set(watch, &of);
            }
        }
    }

    /// Leaves bodies out of `of`, and takes others.
    fn set(&mut self, watch: &Watch, path: &[usize]) {
        let (less, other) = ("balances: a body left out of `of`", "balances: another body in `of`");
        let Some(of) = at(self.root, path) else { return };
        let bodies = self.names.bodies.clone();
        let scalar = |name: &String| Node::Scalar(name.clone());
        let whole = text(of) == Some("all") || items(of).iter().any(|i| text(i) == Some("all"));
        if whole {
            for out in &bodies {
                let list = bodies.iter().filter(|b| *b != out).map(scalar).collect();
                self.plant(less, watch, format!("all but {out}"), with(self.root, path, Some(Node::List(list))));
            }
            return;
        }
        for (k, item) in items(of).iter().enumerate() {
            let here: Path = [path, &[k]].concat();
            let word = text(item).unwrap_or("");
            if items(of).len() > 1 {
                self.plant(less, watch, format!("without {word}"), with(self.root, &here, None));
            }
            if word.contains(" in i..") {
                self.replace(less, watch, &here, &word.replace(" in i..", " in i+1.."));
            }
            for body in bodies.iter().filter(|b| items(of).iter().all(|i| text(i) != Some(b))) {
                self.replace(other, watch, &here, body);
            }
        }
    }

    /// `on`, `from`, `at` and `along` of a reaction, or of what has a stretch or a rate.
    fn placement(&mut self, section: &'static str, watch: &Watch, path: &[usize]) {
        let kinds = match section {
            "reactions" => ["reactions: `on`", "reactions: `from`", "reactions: `at`", "reactions: `along`"],
            _ => [
                "springs, dampers: `on`",
                "springs, dampers: `from`",
                "springs, dampers: `at`",
                "springs, dampers: `along`",
            ],
        };
        let root = self.root;
        let bodies = self.names.bodies.clone();
        for (key, kind) in [("on", kinds[0]), ("from", kinds[1])] {
            match to_key(root, path, key) {
                Some(here) => {
                    bodies.iter().for_each(|body| self.replace(kind, watch, &here, body));
                    if key == "from" {
                        self.plant(kind, watch, "without `from`".to_owned(), with(root, &here, None));
                    }
                }
                None => {
                    for body in &bodies {
                        let what = format!("`{key}: {body}` added");
                        self.plant(kind, watch, what, with_entry(root, path, key, body));
                    }
                }
            }
        }
        if let Some(here) = to_key(root, path, "at") {
            for point in self.names.points.clone() {
                self.replace(kinds[2], watch, &here, &point);
            }
            self.plant(kinds[2], watch, "without `at`".to_owned(), with(root, &here, None));
        }
        if let Some(here) = to_key(root, path, "along") {
            self.slip(kinds[3], watch, &here);
            for direction in ["ground.x", "ground.y"] {
                self.replace(kinds[3], watch, &here, direction);
            }
            let old = at(root, &here).and_then(text).unwrap_or("").to_owned();
            self.replace(kinds[3], watch, &here, &format!("-({old})"));
        }
    }

    fn loads(&mut self) {
        let root = self.root;
        for section in ["springs", "dampers"] {
            let Some(path) = to_key(root, &[], section) else { continue };
            for (k, (_, load)) in at(root, &path).map_or(&[][..], entries).iter().enumerate() {
                let here: Path = [path.as_slice(), &[k]].concat();
                if get(load, "stretch").is_some() || get(load, "rate").is_some() {
                    self.placement(section, &Watch::Systems, &here);
                }
                // Of `between`, Lagrange's equations see where the ends are, not which body each end is on.
                let ends = to_key(root, &here, "between");
                for end in 0..2 {
                    let on = ends.iter().find_map(|ends| to_key(root, &[ends.as_slice(), &[end]].concat(), "on"));
                    if let Some(on) = on {
                        for body in self.names.bodies.clone() {
                            self.replace("springs, dampers: `on`", &Watch::Systems, &on, &body);
                        }
                    }
                }
            }
        }
    }

    fn checks(&mut self) {
        let Some(path) = to_key(self.root, &[], "checks") else { return };
        for (k, (name, check)) in at(self.root, &path).map_or(&[][..], entries).iter().enumerate() {
            let here: Path = [path.as_slice(), &[k]].concat();
            let here = to_key(self.root, &here, "holds").unwrap_or(here);
            let energy = get(check, "holds").or(Some(check)).and_then(text).is_some_and(|t| t.contains("_energy ="));
            let subject = if energy { "checks of an energy" } else { "other checks" };
            self.slip(subject, &Watch::Check(Step::Key(name.clone())), &here);
        }
    }

    fn conserved(&mut self) {
        let Some(path) = to_key(self.root, &[], "conserved") else { return };
        for (k, (name, _)) in at(self.root, &path).map_or(&[][..], entries).iter().enumerate() {
            let here: Path = [path.as_slice(), &[k]].concat();
            let here = to_key(self.root, &here, "value").unwrap_or(here);
            self.slip("conserved", &Watch::Conserved(Step::Key(name.clone())), &here);
        }
    }
}

/// Two long texts without what they have in common but for some letters about the place where they differ.
fn difference(new: &str, old: &str) -> (String, String) {
    const SHORT: usize = 40;
    const ABOUT: usize = 14;
    let (a, b): (Vec<char>, Vec<char>) = (new.chars().collect(), old.chars().collect());
    if a.len().max(b.len()) <= SHORT {
        return (new.to_owned(), old.to_owned());
    }
    let before = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let room = a.len().min(b.len()) - before;
    let after = a.iter().rev().zip(b.iter().rev()).take(room).take_while(|(x, y)| x == y).count();
    let part = |text: &[char]| {
        let (from, to) = (before.saturating_sub(ABOUT), (text.len() - after + ABOUT).min(text.len()));
        let (first, last) = (if from > 0 { "…" } else { "" }, if to < text.len() { "…" } else { "" });
        format!("{first}{}{last}", text[from..to].iter().collect::<String>())
    };
    (part(&a), part(&b))
}
