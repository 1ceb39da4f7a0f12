//! Values with units, and places that want one (LANGUAGE, section 10).

use super::builder::ExprBuilder;
use super::dimension::{Dimension, Measure, si};
use super::facts::Depends;
use super::lower::Local;
use super::rules::{Counts, Rules};
use super::scope::Scope;
use crate::diagnose::Place;
use crate::diagnose::catalogue::units;
use crate::expr::Id;
use crate::file::{Quantity, Text};
use crate::language::{Ast, AstKind, Operator, Unit};

impl ExprBuilder {
    /// A value in SI.  Its unit converts it where it is a pure number: what is computed from quantities with units
    /// is in SI already, and must be of that unit.
    pub fn quantity(
        &mut self,
        scope: &Scope,
        quantity: &Quantity,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<Id> {
        let value = self.scalar(scope, &quantity.text, rules.like(Measure::Unknown), locals)?;
        let value = match &quantity.unit {
            Some((_, unit)) => self.converted(value, unit, &quantity.text),
            None => value,
        };
        let bare = quantity.unit.is_none() && is_bare(&quantity.text.ast, locals);
        self.expect_unit_of(quantity, scope.units.expected(rules.unit), rules.what, bare);
        Some(value)
    }

    /// As [`ExprBuilder::quantity`], where a pure number is in the unit of what it sets.
    pub fn setting(
        &mut self,
        scope: &Scope,
        quantity: &Quantity,
        rules: Rules,
        locals: &[(String, Local)],
    ) -> Option<Id> {
        let value = self.quantity(scope, quantity, rules.like(Measure::Unknown), locals)?;
        if let Some((words, _)) = &quantity.unit
            && let Some(help) = rules.counts.unlike(Counts::of(Some(words)))
        {
            let place = quantity.text.place.at(quantity.text.ast.span);
            self.problems.push(units::cycles_for_radians(place, words.trim(), rules.what, help));
        }
        if quantity.unit.is_some() || self.measured != Measure::ONE {
            self.expect_unit_of(quantity, scope.units.expected(rules.unit), rules.what, false);
        }
        Some(value)
    }

    /// As [`ExprBuilder::expect_unit`] of a value that may have a unit after it.
    fn expect_unit_of(&mut self, quantity: &Quantity, wanted: Measure, what: &str, bare: bool) {
        let (place, before) = (quantity.text.place.at(quantity.text.ast.span), self.problems.len());
        self.expect_unit(wanted, what, bare, &quantity.text.source, &place);
        if let (Some(problem), Some(_), Measure::Of(wanted)) = (self.problems.get_mut(before), &quantity.unit, wanted) {
            problem.help = match wanted {
                Dimension::ONE => "a number alone fits, or one in `rad` or `deg`".to_owned(),
                wanted => format!("a number alone is in {wanted}"),
            };
        }
    }

    /// A value with a unit after it, in SI.
    pub fn converted(&mut self, value: Id, unit: &Unit, text: &Text) -> Id {
        let dimension = Dimension::of(unit);
        let computed = self.depends(&[value]).meets(Depends::UNIT);
        let pure = match self.measured {
            // A pure number that is an angle is in radians, no matter which unit is written after it.
            Measure::Of(found) => {
                found == Dimension::ONE && !(scales_angles(unit) && (computed || gives_angle(&text.ast)))
            }
            Measure::Zero => true,
            Measure::Unknown => !computed,
        };
        if !pure {
            let place = text.place.at(text.ast.span);
            if !unit.is_si() {
                let value = text.words(text.ast.span).to_owned();
                self.problems.push(units::scaled_twice(place.clone(), value, si(unit)));
            }
            self.expect_unit(Measure::Of(dimension), "its unit", false, text.words(text.ast.span), &place);
        }
        self.measured = Measure::Of(dimension);
        if !pure {
            return value;
        }
        let factor = self.graph.constant(unit.factor());
        self.graph.mul(factor, value)
    }

    /// Reports a value that was evaluated last and is not in the unit that is wanted.  A bare number is in that unit.
    pub fn expect_unit(&mut self, wanted: Measure, what: &str, bare: bool, words: &str, place: &Place) {
        if bare && matches!(wanted, Measure::Of(_)) {
            self.measured = wanted;
        }
        if let (None, Measure::Of(found), Measure::Of(wanted)) = (self.measured.alike(wanted), self.measured, wanted) {
            let help = match found {
                Dimension::ONE => "numbers in sums and products are pure, and so are angles; parameters carry units",
                _ => "",
            };
            let problem = units::wrong_unit(place.clone(), words, found.described(), what, wanted.wanted(), help);
            self.problems.push(problem);
            self.measured = Measure::Unknown;
        }
    }

    /// The unit of a component that was evaluated last and those before it; reports when they differ.
    pub fn like(&mut self, all: Measure, texts: &[Text], text: &Text) -> Measure {
        if let Some(measure) = all.alike(self.measured) {
            return measure;
        }
        let unit = |measure: Measure| measure.dimension().unwrap_or_default().described();
        let first = texts.first().map_or("", |text| &text.source);
        let place = text.place.at(text.ast.span);
        let problem = units::unlike_terms(place, first, unit(all), &text.source, unit(self.measured), "");
        self.problems.push(problem);
        Measure::Unknown
    }
}

/// True of `deg`, `mrad`, `rpm`: units in which an angle has another number than in radians.
pub fn scales_angles(unit: &Unit) -> bool {
    unit.pi != 0 || Dimension::of(unit) == Dimension::ONE && !unit.is_si()
}

/// True of an angle in radians: what `asin` and the like give, its multiples and fractions, and sums with it; not where `pi`
/// converts it.
pub fn gives_angle(ast: &Ast) -> bool {
    match &ast.kind {
        AstKind::Call { function, .. } => matches!(function.as_str(), "asin" | "acos" | "atan" | "atan2"),
        AstKind::Negate(inner) => gives_angle(inner),
        AstKind::Binary(Operator::Add | Operator::Subtract, left, right) => gives_angle(left) || gives_angle(right),
        AstKind::Binary(Operator::Multiply | Operator::Divide, left, right) => {
            gives_angle(left) != gives_angle(right) && !ast.any_name(&mut |name| name == "pi")
        }
        _ => false,
    }
}

/// True of a number that stands alone, without a unit.
pub fn stands_alone(text: &Text, locals: &[(String, Local)]) -> bool {
    text.unit.is_none() && is_bare(&text.ast, locals)
}

/// True of `-9.81`, `[0, 2]` and `pi/4`, which name nothing but indices.
pub fn is_bare(ast: &Ast, locals: &[(String, Local)]) -> bool {
    let index = |name: &str| locals.iter().any(|(local, found)| local == name && matches!(found, Local::Integer(_)));
    !ast.any_name(&mut |name| name != "pi" && !index(name))
}
