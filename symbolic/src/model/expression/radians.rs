//! Radians, which SI's units do not show: an energy is J and a torque, an energy per radian, is N*m, which is J too.
//!
//! A quantity is rad^r of what its unit says otherwise: angles and their rates have r = 1, what is declared in `N*m` r = -1, in
//! `N*m/rad` -2, what has none of these 0.  Products add r, so that `k*theta` of a torsional spring is a torque and
//! `k*theta^2/2` an energy.  Lengths do not tell: `m*g*l*sin(theta)` may be either, and counts as an energy.

use std::collections::BTreeMap;

use super::dimension::Dimension;
use crate::language::{Ast, AstKind, Operator};

/// r of a torque.
pub const TORQUE: i32 = -1;

/// Of names without indices.
pub type Radians = BTreeMap<String, i32>;

/// The name under which the reaction of a constraint stands among these: work per unit of what is constrained.
pub fn of_reaction(constraint: &str) -> String {
    format!("reaction({constraint})")
}

/// The unit of an expression of this dimension in SI.
pub fn unit(dimension: Dimension, ast: Option<&Ast>, known: &Radians) -> String {
    match ast {
        Some(ast) if dimension == Dimension::ENERGY && of(ast, known) == TORQUE => "N*m".to_owned(),
        _ => dimension.to_string(),
    }
}

/// r of a unit as it is written.
pub fn of_words(words: &str) -> i32 {
    let (mut power, mut newton, mut metre) = (0, false, false);
    let mut sign = 1;
    for factor in words.split_inclusive(['*', '/']) {
        let name = factor.trim_end_matches(['*', '/']).trim();
        match name {
            "rad" | "deg" | "mrad" | "rpm" => power += sign,
            "N" | "kN" | "mN" | "MN" => newton |= sign > 0,
            "m" | "mm" | "cm" | "km" => metre |= sign > 0,
            _ => {}
        }
        sign = if factor.ends_with('/') { -1 } else { 1 };
    }
    if newton && metre { power - 1 } else { power }
}

/// r of an expression; of a sum that of its first term that has any.
pub fn of(ast: &Ast, known: &Radians) -> i32 {
    let first = |parts: &[Ast]| parts.iter().map(|part| of(part, known)).find(|r| *r != 0).unwrap_or(0);
    match &ast.kind {
        AstKind::Name { name, .. } => known.get(name).copied().unwrap_or(0),
        AstKind::Negate(inner) | AstKind::Component(inner, _) => of(inner, known),
        AstKind::Binary(operator, a, b) => {
            let (left, right) = (of(a, known), of(b, known));
            match operator {
                Operator::Multiply => left + right,
                Operator::Divide => left - right,
                Operator::Power => match &b.kind {
                    AstKind::Number(text) => left * text.parse().unwrap_or(1),
                    _ => left,
                },
                Operator::Add | Operator::Subtract | Operator::Equal if left != 0 => left,
                Operator::Add | Operator::Subtract | Operator::Equal => right,
            }
        }
        AstKind::Vector(parts) => first(parts),
        AstKind::Sum(body, _) | AstKind::Integral(body, _) => of(body, known),
        AstKind::Call { function, arguments, .. } => match (function.as_str(), arguments.as_slice()) {
            // Of an arm and a force.
            ("cross", _) | ("moment", _) => TORQUE,
            ("angular_velocity" | "angles" | "atan2" | "asin" | "acos" | "atan", _) => 1,
            ("dot", [a, b]) => of(a, known) + of(b, known),
            ("abs" | "min" | "max" | "norm" | "rate", parts) => first(parts),
            ("reaction", [Ast { kind: AstKind::Name { name, .. }, .. }]) => {
                known.get(&of_reaction(name)).copied().unwrap_or(0)
            }
            ("diff", [a, b]) => of(a, known) - of(b, known),
            ("components", [vector, _]) => of(vector, known),
            _ => 0,
        },
        AstKind::Number(_) => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::language::parse;

    #[test]
    fn torques_are_energies_per_radian() {
        for (words, r) in [("N*m", -1), ("kN*mm", -1), ("N*m/rad", -2), ("N*m*s/rad", -2), ("N*m/A", -1), ("rad/s", 1)]
        {
            assert_eq!(of_words(words), r, "{words}");
        }
        for words in ["N/m", "J", "kg*m^2", "N*s/m", "1", "m/s"] {
            assert_eq!(of_words(words), 0, "{words}");
        }
        let known =
            Radians::from([("k", -2), ("theta", 1), ("T", -1), ("K", -1)].map(|(name, r)| (name.to_owned(), r)));
        let is_torque = |text: &str| unit(Dimension::ENERGY, Some(&parse(text).unwrap()), &known) == "N*m";
        for text in ["T", "-k*theta", "K*i", "T - k*(theta - rest)", "cross(r, F)", "moment(pin).z", "abs(T)/2"] {
            assert!(is_torque(text), "{text}");
        }
        for text in ["k*theta^2/2", "T*theta", "m*v^2/2", "energy", "m*g*l*cos(theta)"] {
            assert!(!is_torque(text), "{text}");
        }
        assert_eq!(unit(Dimension::FORCE, Some(&parse("T/r").unwrap()), &known), "N");
    }
}
