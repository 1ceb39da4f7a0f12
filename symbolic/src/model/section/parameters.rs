//! `parameters`: free ones with their defaults, derived ones, families of both.

use std::collections::BTreeMap;

use super::resolve_values::Want;
use crate::diagnose::catalogue::{names, sections, units};
use crate::diagnose::{Place, Problem};
use crate::expr::Number;
use crate::file::{Quantity, Spot, Text, Written};
use crate::language::{Ast, AstKind, Unit};
use crate::model::expression::dimension::{Dimension, Measure, si};
use crate::model::expression::families::{Expanded, Family as KeyFamily};
use crate::model::expression::index::MEMBER_LIMIT;
use crate::model::expression::lower::Local;
use crate::model::expression::quantities::{gives_angle, scales_angles};
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::identifier::{field_name, method_name};
use crate::model::resolved::{Derived, Family, Parameter};
use crate::model::resolver::Resolver;

/// A derived parameter as declared: its name, its unit as written, its item, and where it stands.
pub type DeclaredDerived = (String, Option<String>, usize, Place);

impl Resolver<'_> {
    /// Declares parameters; derived ones get their values when all names are known.
    pub fn parameters(&mut self) -> Vec<DeclaredDerived> {
        let mut derived = Vec::new();
        for (key, spot) in self.section("parameters") {
            let Some(family) = self.expand_declared(key, &spot, Section::Parameter) else { continue };
            self.declare_empty(Section::Parameter, &family);
            match values(&spot, &family, &mut self.builder.problems) {
                Some(values) => {
                    for (member, value) in family.members.iter().zip(values) {
                        self.parameter(member, &value, &spot, &mut derived);
                    }
                }
                None => {
                    for member in &family.members {
                        self.declare(Section::Parameter, member, Member::Refused, &spot.place);
                    }
                }
            }
        }
        self.array_fields();
        let has_unit = |unit: Option<&str>| !matches!(unit, None | Some("1"));
        self.builder.facts.dimensional = self.model.parameters.iter().map(|p| has_unit(p.unit.as_deref())).collect();
        self.builder.defaults = self.model.parameters.iter().map(|p| p.default).collect();
        derived
    }

    fn parameter(&mut self, member: &Expanded, value: &Quantity, spot: &Spot<'_>, derived: &mut Vec<DeclaredDerived>) {
        let unit = value.unit.as_ref().map(|(words, _)| words.clone());
        if names_others(&value.text.ast, &member.locals) {
            let written = Some(Written::One(value.text.clone()));
            let rules = Rules::constant("a parameter");
            let item = self.item(member.name(), written, rules, Want::Scalar, &member.locals);
            self.items[item].unit = value.unit.as_ref().map(|(_, unit)| *unit);
            self.note_unit(value.unit.as_ref().map(|(_, unit)| unit));
            if self.declare(Section::Parameter, member, Member::Item(item), &spot.place) {
                derived.push((member.name(), unit, item, spot.place.of_key()));
            }
            return;
        }
        // `asin(0.6)` is an angle in radians without saying so.
        let is_angle = value.unit.is_none() && gives_angle(&value.text.ast);
        let unit = if is_angle { Some("rad".to_owned()) } else { unit };
        if let Some((_, unit)) = &value.unit
            && scales_angles(unit)
            && gives_angle(&value.text.ast)
        {
            let place = value.text.place.at(value.text.ast.span);
            self.builder.problems.push(units::scaled_twice(place, value.text.words(value.text.ast.span), si(unit)));
        }
        let id = self.scalar(&value.text, Rules::constant("a parameter"), &member.locals);
        let number = id.and_then(|id| self.builder.graph.number(id));
        let factor = value.unit.as_ref().map_or(Number::ONE, |(_, unit)| unit.factor());
        let default = number.map(|x| x.times(factor).to_f64());
        match default.filter(|x| x.is_finite()) {
            Some(default) => {
                let place = self.model.parameters.len() as u32;
                if self.declare(Section::Parameter, member, Member::Parameter(place), &spot.place) {
                    let family = Some(&member.indices).filter(|indices| !indices.is_empty()).map(|indices| Family {
                        name: member.base.clone(),
                        ranges: Vec::new(),
                        indices: indices.clone(),
                    });
                    let place = spot.place.of_key();
                    let measure = self.note_unit(value.unit.as_ref().map(|(_, unit)| unit));
                    self.scope.units.note_radians(&member.base, unit.as_deref());
                    self.scope.units.parameters.push(if is_angle { Measure::ONE } else { measure });
                    self.model.parameters.push(Parameter { name: member.name(), family, unit, default, place });
                }
            }
            None => {
                if id.is_some() {
                    let place = value.text.place.at(value.text.ast.span);
                    self.builder.problems.push(names::undefined_value(place, value.text.words(value.text.ast.span)));
                }
                self.declare(Section::Parameter, member, Member::Refused, &spot.place);
            }
        }
    }

    /// What a unit written after a value or coordinate says; a model with one has time in seconds.
    pub fn note_unit(&mut self, unit: Option<&Unit>) -> Measure {
        let dimension = unit.map(Dimension::of);
        self.scope.units.pure &= dimension.is_none_or(|dimension| dimension == Dimension::ONE);
        Measure::from(dimension)
    }

    /// Each family of free parameters is an array over the smallest box that holds its members.
    fn array_fields(&mut self) {
        let mut boxes: BTreeMap<String, Vec<(i64, i64)>> = BTreeMap::new();
        for family in self.model.parameters.iter().filter_map(|p| p.family.as_ref()) {
            let ranges =
                boxes.entry(family.name.clone()).or_insert_with(|| family.indices.iter().map(|i| (*i, *i)).collect());
            for (range, index) in ranges.iter_mut().zip(&family.indices) {
                *range = (range.0.min(*index), range.1.max(*index));
            }
        }
        let size = |ranges: &[(i64, i64)]| {
            ranges.iter().try_fold(1_i64, |size, (low, high)| size.checked_mul(high.checked_sub(*low)?.checked_add(1)?))
        };
        for parameter in &mut self.model.parameters {
            let Some(family) = &mut parameter.family else { continue };
            if let Some(ranges) = boxes.get(&family.name) {
                if size(ranges).is_none_or(|size| size > MEMBER_LIMIT as i64) {
                    let problem = names::too_many_names(parameter.place.clone(), MEMBER_LIMIT);
                    self.builder.problems.push(problem);
                    break;
                }
                family.ranges.clone_from(ranges);
            }
        }
    }

    /// Fields and methods of the generated type must differ in Rust too, where `θ` and `theta` are one name.
    fn distinct_in_rust(&mut self, derived: &[DeclaredDerived]) {
        let free = self.model.parameters.iter().map(|parameter| {
            let name = parameter.family.as_ref().map_or(&parameter.name, |family| &family.name);
            (name.clone(), field_name(name), parameter.place.clone())
        });
        let methods = derived.iter().filter(|(name, ..)| !name.contains('['));
        let methods = methods.map(|(name, _, _, place)| (name.clone(), method_name(name), place.clone()));
        let mut owners: BTreeMap<String, (String, Place)> = BTreeMap::new();
        let mut clashes = Vec::new();
        for (name, rust, place) in free.chain(methods) {
            let (owner, first) = owners.entry(rust.clone()).or_insert_with(|| (name.clone(), place.clone()));
            if *owner != name {
                clashes.push(sections::same_rust_name(first.clone(), owner.as_str(), &name, &rust));
                clashes.push(sections::same_rust_name(place, &name, owner.as_str(), &rust));
            }
        }
        self.builder.problems.extend(clashes);
    }

    /// Derived parameters with their values.
    pub fn finish_derived(&mut self, declared: Vec<DeclaredDerived>) {
        self.distinct_in_rust(&declared);
        for (name, unit, item, _) in declared {
            if let Some(crate::model::expression::value::Value::Scalar(value)) = self.scope.value(item) {
                self.model.derived.push(Derived { name, unit, value: *value });
            }
        }
    }
}

/// One value per member; `None` when wrong (reported).
pub fn values(
    spot: &Spot<'_>,
    family: &KeyFamily,
    problems: &mut Vec<crate::diagnose::Problem>,
) -> Option<Vec<Quantity>> {
    if let Some(items) = spot.items() {
        if !family.ranged {
            problems.push(no_number(spot, &family.key.name, items.len()));
            return None;
        }
        let spots = flat(spot);
        let values: Vec<Option<Quantity>> = spots.iter().map(|spot| spot.quantity(problems)).collect();
        return list_of(values.into_iter().collect::<Option<Vec<_>>>()?, family, &spot.place, problems);
    }
    let value = spot.quantity(problems)?;
    if let (AstKind::Vector(parts), true) = (&value.text.ast.kind, family.ranged) {
        let part = |ast: &Ast| {
            let text = Text { ast: ast.clone().into(), ..value.text.clone() };
            Quantity { text, unit: value.unit.clone() }
        };
        return list_of(parts.iter().map(part).collect(), family, &spot.place, problems);
    }
    if let AstKind::Vector(parts) = &value.text.ast.kind {
        problems.push(no_number(spot, &family.key.name, parts.len()));
        return None;
    }
    Some(vec![value; family.members.len()])
}

/// So many numbers where a parameter wants one.
fn no_number(spot: &Spot<'_>, name: &str, count: usize) -> Problem {
    let wanted = format!("one number, or with these {count} a family `{name}[i in 1..{count}]`");
    let mut problem = sections::wrong_shape(spot.place.clone(), format!("`{name}`"), &wanted, "a list");
    if matches!(count, 2 | 3) {
        problem.help = format!("a vector stands in `define`, of parameters or numbers: `define: {{{name}: …}}`");
    }
    problem
}

fn list_of(
    values: Vec<Quantity>,
    family: &KeyFamily,
    place: &Place,
    problems: &mut Vec<crate::diagnose::Problem>,
) -> Option<Vec<Quantity>> {
    if values.len() == family.members.len() {
        return Some(values);
    }
    problems.push(sections::list_length(place.clone(), &family.key.name, family.members.len(), values.len()));
    None
}

/// The values of a list, or of a list of lists, row by row.
pub fn flat<'a>(spot: &Spot<'a>) -> Vec<Spot<'a>> {
    let rows = spot.items().unwrap_or_default();
    rows.into_iter().flat_map(|row| row.items().unwrap_or_else(|| vec![row])).collect()
}

/// True when a value names anything but `pi` and its own indices.
pub fn names_others(ast: &Ast, locals: &[(String, Local)]) -> bool {
    ast.any_name(&mut |name| name != "pi" && !locals.iter().any(|(local, _)| local == name))
}
