// Ways through the tree of a model file.

use dalembert_symbolic::file::Node;

/// The value of a key.
pub fn get<'n>(node: &'n Node, key: &str) -> Option<&'n Node> {
    entries(node).iter().find(|e| e.0 == key).map(|e| &e.1)
}

/// The entries of a mapping.
pub fn entries(node: &Node) -> &[(String, Node)] {
    if let Node::Map(entries) = node { entries } else { &[] }
}

/// The items of a list.
pub fn items(node: &Node) -> &[Node] {
    if let Node::List(items) = node { items } else { &[] }
}

/// The text of a scalar.
pub fn text(node: &Node) -> Option<&str> {
    if let Node::Scalar(text) = node { Some(text) } else { None }
}

/// A way down: at each step the number of the entry or item.
pub type Path = Vec<usize>;

/// A path with one more step, to a key.
pub fn to_key(root: &Node, path: &[usize], key: &str) -> Option<Path> {
    let place = entries(at(root, path)?).iter().position(|e| e.0 == key)?;
    Some([path, &[place]].concat())
}

/// The node at a path.
pub fn at<'n>(root: &'n Node, path: &[usize]) -> Option<&'n Node> {
    path.iter().try_fold(root, |node, &k| match node {
        Node::List(items) => items.get(k),
        Node::Map(entries) => entries.get(k).map(|e| &e.1),
        _ => None,
    })
}

fn at_mut<'n>(root: &'n mut Node, path: &[usize]) -> Option<&'n mut Node> {
    path.iter().try_fold(root, |node, &k| match node {
        Node::List(items) => items.get_mut(k),
        Node::Map(entries) => entries.get_mut(k).map(|e| &mut e.1),
        _ => None,
    })
}

/// The tree with another node at a path; without one, with what stands there removed.
pub fn with(root: &Node, path: &[usize], new: Option<Node>) -> Node {
    let mut root = root.clone();
    if let (Some(new), Some(node)) = (&new, at_mut(&mut root, path)) {
        *node = new.clone();
    } else if let Some((last, above)) = path.split_last() {
        match at_mut(&mut root, above) {
            Some(Node::List(items)) => drop(items.remove(*last)),
            Some(Node::Map(entries)) => drop(entries.remove(*last)),
            _ => {}
        }
    }
    root
}

/// The tree with an entry added to the mapping at a path.
pub fn with_entry(root: &Node, path: &[usize], key: &str, value: &str) -> Node {
    let mut root = root.clone();
    if let Some(Node::Map(entries)) = at_mut(&mut root, path) {
        entries.push((key.to_owned(), Node::Scalar(value.to_owned())));
    }
    root
}
