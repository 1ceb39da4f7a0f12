//! Integers known at compile time: sizes, indices and their arithmetic.

use super::builder::ExprBuilder;
use super::lower::Local;
use super::scope::{Member, Scope};
use crate::diagnose::catalogue::names;
use crate::diagnose::{Place, Problem, did_you_mean};
use crate::file::{Text, words};
use crate::language::{Ast, AstKind, Operator, Range};

/// Members that one family, sum or file may expand to.
pub const MEMBER_LIMIT: usize = 100_000;

/// Terms that one sum may expand to.
const TERM_LIMIT: usize = 1_000_000;

/// Where integers are read.
pub struct Indices<'a> {
    /// For sizes.
    pub scope: &'a Scope,
    /// The text of the expression or key that they stand in.
    pub source: &'a str,
    /// Where that stands.
    pub place: &'a Place,
}

impl<'a> Indices<'a> {
    /// In an expression.
    pub fn within(scope: &'a Scope, text: &'a Text) -> Indices<'a> {
        Indices { scope, source: &text.source, place: &text.place }
    }
}

/// Why there is no integer.
#[derive(Clone, Debug)]
pub enum Refusal {
    /// It depends on something that was reported already.
    Told,
    /// This.
    Problem(Box<Problem>),
}

impl From<Problem> for Refusal {
    fn from(problem: Problem) -> Refusal {
        Refusal::Problem(Box::new(problem))
    }
}

impl ExprBuilder {
    /// Reports why there is no integer.
    pub fn told(&mut self, refusal: Refusal) {
        if let Refusal::Problem(problem) = refusal {
            self.problems.push(*problem);
        }
    }
}

/// The integer that an index, size or end of a range stands for.
///
/// # Errors
/// When it is no integer known at compile time, or none of 64 bits.
pub fn integer(at: &Indices<'_>, locals: &[(String, Local)], ast: &Ast) -> Result<i64, Refusal> {
    let refuse =
        |why: &str| Err(names::index_not_integer(at.place.at(ast.span), words(at.source, ast.span), why).into());
    let checked = |value: Option<i64>| value.map_or_else(|| refuse("it does not fit into 64 bits"), Ok);
    match &ast.kind {
        AstKind::Number(text) => text.parse().map_or_else(|_| refuse("it is not a whole number"), Ok),
        AstKind::Negate(inner) => checked(integer(at, locals, inner)?.checked_neg()),
        AstKind::Name { name, indices, primes: 0 } if indices.is_empty() => {
            if let Some((_, local)) = locals.iter().rev().find(|(local, _)| local == name) {
                return match local {
                    Local::Integer(value) => Ok(*value),
                    Local::Symbol(..) => refuse("it is not a size or an index"),
                };
            }
            match at.scope.names.get(name) {
                Some(entry) => match entry.members.get([].as_slice()) {
                    Some(Member::Size(value)) => Ok(*value),
                    _ if entry.refused => Err(Refusal::Told),
                    _ => refuse(&format!("`{name}` is {}", entry.section.noun())),
                },
                None => {
                    let known = at.scope.candidates().chain(locals.iter().map(|(local, _)| local.as_str()));
                    Err(names::unknown_name(at.place.at(ast.span), name, did_you_mean(name, known)).into())
                }
            }
        }
        AstKind::Binary(operator, left, right) => {
            let (a, b) = (integer(at, locals, left)?, integer(at, locals, right)?);
            match operator {
                Operator::Add => checked(a.checked_add(b)),
                Operator::Subtract => checked(a.checked_sub(b)),
                Operator::Multiply => checked(a.checked_mul(b)),
                Operator::Power => match u32::try_from(b) {
                    Ok(power) => checked(a.checked_pow(power)),
                    Err(_) => refuse("its exponent is not a natural number"),
                },
                Operator::Divide if b == 0 => refuse("it divides by zero"),
                Operator::Divide if a.checked_rem(b) == Some(0) => checked(a.checked_div(b)),
                Operator::Divide => refuse(&format!("{a} is not divisible by {b}")),
                Operator::Equal => refuse("it is an equation"),
            }
        }
        AstKind::Call { function, arguments, .. } if function == "mod" && arguments.len() == 2 => {
            let (a, b) = (integer(at, locals, &arguments[0])?, integer(at, locals, &arguments[1])?);
            if b <= 0 {
                return refuse("the second argument of `mod` must be positive");
            }
            checked(a.checked_rem_euclid(b))
        }
        _ => refuse("only sizes, indices and whole numbers count"),
    }
}

/// All values of nested ranges, the last running fastest.
///
/// # Errors
/// When an end is no integer, or there are too many values.
pub fn members(
    at: &Indices<'_>,
    builder: &mut ExprBuilder,
    locals: &mut Vec<(String, Local)>,
    ranges: &[Range],
) -> Result<Vec<Vec<i64>>, Refusal> {
    let known = locals.len();
    let mut rows: Vec<Vec<i64>> = vec![Vec::new()];
    for (depth, range) in ranges.iter().enumerate() {
        let mut longer = Vec::new();
        for row in rows {
            let named = ranges[..depth].iter().map(|range| range.name.clone());
            locals.extend(named.zip(row.iter().copied().map(Local::Integer)));
            let ends = integer(at, locals, &range.from).and_then(|from| Ok((from, integer(at, locals, &range.to)?)));
            locals.truncate(known);
            let (from, to) = ends?;
            let count = usize::try_from(i128::from(to) - i128::from(from) + 1).unwrap_or(0);
            if count > TERM_LIMIT || longer.len() + count > TERM_LIMIT {
                return Err(names::too_many_names(at.place.at(range.name_span), MEMBER_LIMIT).into());
            }
            if !builder.spend(1 + count as u64, at.place) {
                return Ok(Vec::new());
            }
            longer.extend((from..=to).map(|value| row.iter().copied().chain([value]).collect::<Vec<i64>>()));
        }
        rows = longer;
    }
    Ok(rows)
}
