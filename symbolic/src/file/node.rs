//! A model file as a tree of mappings, lists and text.

/// One node of a model file; scalars are kept as text.
#[derive(Clone, Debug, PartialEq)]
pub enum Node {
    /// Nothing: `x:` or `~`.
    Null,
    /// A scalar, as text; numbers in shortest decimal form.
    Scalar(String),
    /// A list.
    List(Vec<Node>),
    /// A mapping in the file's order; keys are text.
    Map(Vec<(String, Node)>),
}
