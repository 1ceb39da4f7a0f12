//! One generated function: its signature, with `_` for what its body does not read, and its body.

use super::body::{Bodies, Body, Use};

/// A function of a state, `fn NAME<S: Real>(c, t, u, q, v, a, l, TARGETS) -> RESULT`.
pub(super) struct Function<'a> {
    pub name: &'a str,
    /// The type of the block of constants.
    pub constants: &'a str,
    /// Which of q, v, and a with the multipliers l it takes: so many of them.
    pub state: usize,
    /// Where it writes.
    pub targets: Vec<Target<'a>>,
    /// The type of its result, if any.
    pub result: Option<String>,
    /// Statements before those that compute.
    pub before: String,
    /// What it computes.
    pub uses: Vec<Use>,
    /// Statements after, or the result.
    pub after: &'a str,
}

/// An argument that a function writes to.
pub(super) struct Target<'a> {
    pub name: &'a str,
    pub kind: String,
    pub used: bool,
}

impl Default for Function<'_> {
    fn default() -> Self {
        Function {
            name: "",
            constants: "Self::Constants<S>",
            state: 0,
            targets: Vec::new(),
            result: None,
            before: String::new(),
            uses: Vec::new(),
            after: "",
        }
    }
}

impl Function<'_> {
    /// Its text, after an empty line.
    pub fn text(&self, bodies: &Bodies<'_>, indent: &str) -> String {
        let (n, rows) = (bodies.names.coordinates.len(), bodies.names.multipliers.len());
        let inner = format!("{indent}    ");
        let Body { lines, reads } = bodies.body(&self.uses, &inner);
        let mut arguments = vec![
            argument("c", &format!("&{}", self.constants), reads.constants),
            argument("t", "S", reads.time),
            argument("u", "&[S]", reads.inputs),
        ];
        let state = [("q", n), ("v", n), ("a", n), ("l", rows)];
        // Multipliers come with accelerations.
        let count = if self.state == 3 { 4 } else { self.state };
        let state = state.into_iter().zip(reads.state).take(count);
        arguments.extend(state.map(|((name, size), read)| argument(name, &format!("&[S; {size}]"), read)));
        arguments.extend(self.targets.iter().map(|target| argument(target.name, &target.kind, target.used)));
        let statement = |text: &str| if text.is_empty() { String::new() } else { format!("{inner}{text}\n") };
        format!(
            "\n{indent}fn {}<S: ::dalembert::mechanism::Real>({}){} {{\n{}{lines}{}{indent}}}\n",
            self.name,
            arguments.join(", "),
            self.result.as_ref().map_or(String::new(), |result| format!(" -> {result}")),
            statement(&self.before),
            statement(self.after),
        )
    }
}

/// A function of the constants alone that gives an array: `fn NAME<S: Real>(c: &[S]) -> [S; K]`.
pub(super) fn of_constants(bodies: &Bodies<'_>, name: &str, values: &[crate::expr::Id], indent: &str) -> String {
    let inner = format!("{indent}    ");
    let Body { lines, reads } = bodies.body(&stores("out", values), &inner);
    let size = values.len();
    format!(
        "{indent}fn {name}<S: ::dalembert::mechanism::Real>({}) -> [S; {size}] {{\n{inner}let mut out = [S::ratio(0.0, 1.0); {size}];\n{lines}{inner}out\n{indent}}}\n",
        argument("c", "&[S]", reads.constants),
    )
}

/// `name: kind`, or `_: kind` for one that is not used.
pub(super) fn argument(name: &str, kind: &str, used: bool) -> String {
    format!("{}: {kind}", if used { name } else { "_" })
}

/// `array[0] = …;` and so on.
pub(super) fn stores(array: &str, values: &[crate::expr::Id]) -> Vec<Use> {
    values.iter().enumerate().map(|(k, id)| Use::Store(format!("{array}[{k}]"), *id)).collect()
}
