//! Equations: two sides of one kind.

use super::builder::ExprBuilder;
use super::lower::Local;
use super::rules::Rules;
use super::scope::Scope;
use super::value::Value;
use crate::diagnose::catalogue::names;
use crate::expr::Id;
use crate::file::Text;

impl ExprBuilder {
    /// Both sides of `a = b`, two numbers or two vectors; of an expression without `=` the right side is 0, and 0
    /// stands for the zero vector too.  `None` where they do not fit (reported) or are poisoned.
    pub fn sides(
        &mut self,
        scope: &Scope,
        text: &Text,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<(Value, Value)> {
        let before = self.problems.len();
        let (left, right) = self.equation(scope, text, rules, locals);
        let number = |side: Value| if side == Value::Nothing { Value::Scalar(Id::ZERO) } else { side };
        let (left, right) = (number(left), number(right.unwrap_or(Value::Nothing)));
        let zero = |like: &Value| like.map(|_| Id::ZERO);
        match (&left, &right) {
            (Value::Poison, _) | (_, Value::Poison) => None,
            (Value::Vector(_), Value::Scalar(Id::ZERO)) => Some((left.clone(), zero(&left))),
            (Value::Scalar(Id::ZERO), Value::Vector(_)) => Some((zero(&right), right.clone())),
            (Value::Scalar(_), Value::Vector(_)) | (Value::Vector(_), Value::Scalar(_)) => {
                // That a number and a vector have different units is no second mistake.
                self.problems.truncate(before);
                let place = text.place.at(text.ast.span);
                self.problems.push(names::mixed_kinds(place, "=", left.describe(), right.describe()));
                None
            }
            (Value::Vector(a), Value::Vector(b)) if a.len() != b.len() => {
                let place = text.place.at(text.ast.span);
                self.problems.push(names::vector_size(place, a.len(), b.len()));
                None
            }
            _ => Some((left, right)),
        }
    }
}
