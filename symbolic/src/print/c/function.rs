//! One function of a state: its declaration with what it is, and its definition.

use std::fmt::Write;

use super::dialect::comment;
use crate::print::body::{Bodies, Body, Use};

/// `void NAME(c, t, u, q, v, a, l, out)`.
pub(super) struct Function {
    pub name: &'static str,
    /// What it is, in words.
    pub about: String,
    /// The highest derivative of the coordinates that it takes, plus one: 1 q, 2 q and v, 3 all, with multipliers; 0 takes no inputs either.
    pub order: usize,
    /// Whether it takes a direction.
    pub along: bool,
    /// How many numbers it writes.
    pub size: usize,
    /// What it computes.
    pub uses: Vec<Use>,
}

/// Arguments of a function of a state, up to those that `order` takes.
pub(super) fn arguments(order: usize) -> String {
    let arrays = &["u", "q", "v", "a", "l"][..count(order)];
    let arrays: String = arrays.iter().map(|name| format!(", const double *{name}")).collect();
    format!("const double *c, double t{arrays}")
}

/// How many arrays that is.
fn count(order: usize) -> usize {
    match order {
        0 => 0,
        3 => 5,
        order => 1 + order,
    }
}

/// Statements that say that arguments are not read.
pub(super) fn unread(names: &[(&str, bool)]) -> String {
    let unread: Vec<String> =
        names.iter().filter(|(_, read)| !read).map(|(name, _)| format!("(void){name};")).collect();
    if unread.is_empty() { String::new() } else { format!("    {}\n", unread.join(" ")) }
}

/// Which of the arguments of a function of a state a body reads.
pub(super) fn read(body: &Body, order: usize) -> Vec<(&'static str, bool)> {
    let reads = body.reads;
    let state = ["q", "v", "a", "l"].into_iter().zip(reads.state);
    let arrays = [("u", reads.inputs)].into_iter().chain(state).take(count(order));
    [("c", reads.constants), ("t", reads.time)].into_iter().chain(arrays).collect()
}

/// Lines of documentation.
pub(super) fn documented(about: &str) -> String {
    let lines: Vec<String> = about.split('\n').map(comment).collect();
    format!("\n/* {} */\n", lines.join("\n   "))
}

impl Function {
    fn signature(&self, prefix: &str) -> String {
        let along = if self.along { ", const double *along" } else { "" };
        format!("void {prefix}_{}({}{along}, double *out)", self.name, arguments(self.order))
    }

    /// For the header.
    pub fn declaration(&self, prefix: &str) -> String {
        format!("{}{};\n", documented(&self.about), self.signature(prefix))
    }

    /// For the source.
    pub fn definition(&self, prefix: &str, bodies: &Bodies<'_>) -> String {
        let body = bodies.body(&self.uses, "    ");
        let mut names = read(&body, self.order);
        names.extend([("along", !self.along || body.reads.along), ("out", self.size > 0)]);
        let mut out = format!("\n{} {{\n{}", self.signature(prefix), unread(&names));
        if self.uses.len() < self.size {
            let _ = writeln!(out, "    for (int k = 0; k < {}; k++) out[k] = 0.0;", self.size);
        }
        out + &body.lines + "}\n"
    }
}
