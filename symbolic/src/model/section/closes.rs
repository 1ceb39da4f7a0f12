//! `closes`: how a motion repeats itself (LANGUAGE, section 9).

use crate::diagnose::catalogue::{mechanics, names, sections, units};
use crate::diagnose::{Place, did_you_mean_or};
use crate::expr::Id;
use crate::file::{Node, Spot, describe};
use crate::model::expression::dimension::Dimension;
use crate::model::expression::families::Expanded;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section};
use crate::model::motion::{Closes, Image};
use crate::model::resolved::Scene;
use crate::model::resolver::Resolver;

const KEYS: [&str; 10] = ["period", "part", "at", "count", "exchange", "mirror", "shift", "turn", "from", "to"];

/// What says how the end is the start, and not how it comes from one reversing state to another.
pub(super) const BETWEEN_SAYS: [&str; 6] = ["exchange", "mirror", "shift", "turn", "at", "count"];

/// No motion is cut into more parts.
const MOST_PARTS: u32 = 1000;

const PERIOD: Rules = Rules::constant("a period").si(Dimension::TIME);
const PART: Rules = Rules::constant("a part of the period").si(Dimension::ONE);

/// A coordinate or a phase, by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Exchanged {
    Coordinate(usize),
    Phase(usize),
}

impl Resolver<'_> {
    /// `closes`, and the energy beside it.
    pub fn closes(&mut self, spot: &Spot<'_>, energy: Option<Spot<'_>>, scene: &Scene) -> Option<Closes> {
        let before = self.builder.problems.len();
        if !spot.only(&KEYS, "`closes`", &mut self.builder.problems) {
            return None;
        }
        let event = self.closing_event(spot);
        let period = spot.get("period").and_then(|period| self.positive(&period, PERIOD, scene));
        let energy = energy.and_then(|energy| self.energy_of(&energy));
        let before_images = self.builder.problems.len();
        let image = self.image(spot, true);
        let between = self.reversing_ends(spot);
        let mapped = self.builder.problems.len() == before_images;
        let shifts = spot.get("shift").map_or_else(Vec::new, |list| self.listed_coordinates(&list));
        let turns = spot.get("turn").map_or_else(Vec::new, |turn| self.turns(&turn));
        if let Some(event) = spot.get("at") {
            for key in ["period", "part"] {
                if spot.get(key).is_some() {
                    let place = event.place.of_key();
                    self.builder.problems.push(sections::conflicting_keys(place, "at", key, "`closes`"));
                }
            }
        }
        let part = if mapped { self.part_of_period(spot, &image, between.as_ref()) } else { None };
        if self.builder.problems.len() > before {
            return None;
        }
        let (part, place) = (part?, spot.place.clone());
        Some(Closes { event, part, period, energy, image, shifts, turns, between, place })
    }

    /// `at`, with `count`.
    fn closing_event(&mut self, spot: &Spot<'_>) -> Option<(usize, u32)> {
        let count = spot.get("count").and_then(|count| self.whole(&count, 1));
        let Some(at) = spot.get("at") else {
            if let Some(count) = spot.get("count") {
                let problem = sections::needs_another_key(count.place.of_key(), "count", "at", "`closes`");
                self.builder.problems.push(problem);
            }
            return None;
        };
        let words = at.words(&mut self.builder.problems)?;
        let known: Vec<&str> = self.model.events.iter().map(|event| event.name.as_str()).collect();
        let Some(event) = known.iter().position(|name| *name == words) else {
            // One that was refused is not told of twice.
            if self.root.get("events").is_none_or(|events| events.get(words).is_none()) {
                let help =
                    if known.is_empty() { "the model has none".to_owned() } else { did_you_mean_or(words, &known) };
                self.builder.problems.push(sections::unknown_choice(at.place, words, "an event", help));
            }
            return None;
        };
        let count = if spot.get("count").is_some() { count? } else { 1 };
        Some((event, u32::try_from(count).unwrap_or(1)))
    }

    /// A whole number, not less than one.
    fn whole(&mut self, spot: &Spot<'_>, least: i64) -> Option<i64> {
        let found = match spot.node {
            Node::Scalar(words) => words.trim().parse::<i64>().map_err(|_| "an expression"),
            node => Err(describe(node)),
        };
        match found {
            Ok(number) if number >= least && number.abs() <= i64::from(MOST_PARTS) => Some(number),
            Ok(number) => {
                let wanted = format!("in {least}..{MOST_PARTS}");
                let problem =
                    mechanics::value_out_of_range(spot.place.clone(), format!("`{}`", spot.name), wanted, number);
                self.builder.problems.push(problem);
                None
            }
            Err(found) => {
                let (context, wanted) = (format!("`{}`", spot.name), "a whole number");
                self.builder.problems.push(sections::wrong_shape(spot.place.clone(), context, wanted, found));
                None
            }
        }
    }

    fn energy_of(&mut self, spot: &Spot<'_>) -> Option<Id> {
        let quantity = spot.quantity(&mut self.builder.problems)?;
        let rules = Rules::constant("the energy of a motion").like(self.scope.units.energy);
        self.setting(&quantity, rules, &Self::no_locals())
    }

    /// `exchange` and `mirror`.
    fn image(&mut self, spot: &Spot<'_>, phases: bool) -> Image {
        let mut image = Image::identity(self.model.coordinates.len(), self.model.phases.len(), spot.place.clone());
        if let Some(exchange) = spot.get("exchange") {
            image.place = exchange.place.of_key();
            self.exchange(&exchange, phases, &mut image);
        }
        if let Some(mirror) = spot.get("mirror") {
            if spot.get("exchange").is_none() {
                image.place = mirror.place.of_key();
            }
            for coordinate in self.listed_coordinates(&mirror) {
                image.coordinates[coordinate].1 = true;
            }
        }
        image
    }

    /// `exchange`: where each coordinate and phase goes.
    fn exchange(&mut self, spot: &Spot<'_>, phases: bool, image: &mut Image) {
        let mut pairs: Vec<(Exchanged, Exchanged, String, Place)> = Vec::new();
        for (key, entry) in spot.entries(&mut self.builder.problems) {
            let place = entry.place.of_key();
            let Some(words) = entry.words(&mut self.builder.problems) else { continue };
            let (from, to) = (self.exchanged(key, &place), self.exchanged(words, &entry.place));
            let (Some(from), Some(to)) = (from, to) else { continue };
            if from.len() != to.len() {
                let problem = sections::list_length(entry.place.clone(), key, from.len(), to.len());
                self.builder.problems.push(problem);
                continue;
            }
            for (from, to) in from.into_iter().zip(to) {
                if self.fits(from, to, &entry.place, phases) {
                    pairs.push((from, to, words.to_owned(), entry.place.clone()));
                }
            }
        }
        let mut complete = pairs.clone();
        for (from, to, words, place) in &pairs {
            let is_source = pairs.iter().any(|(other, ..)| other == to);
            let is_reached = pairs.iter().any(|(_, other, ..)| other == from);
            match (is_source, is_reached) {
                (true, true) => {}
                // Two that are exchanged.
                (false, false) => complete.push((*to, *from, words.clone(), place.clone())),
                (false, true) => {
                    let why = format!("sends `{words}` nowhere");
                    let help = "write a cycle whole, `{a: b, b: c, c: a}`; a single pair is exchanged";
                    self.builder.problems.push(sections::no_exchange(place.clone(), why, help));
                }
                // Told where the chain ends.
                (true, false) => {}
            }
        }
        for (k, (_, to, words, place)) in pairs.iter().enumerate() {
            if pairs[..k].iter().any(|(_, other, ..)| other == to) {
                let why = format!("sends two to `{words}`");
                let help = "each place takes one";
                self.builder.problems.push(sections::no_exchange(place.clone(), why, help));
            }
        }
        for (from, to, ..) in complete {
            match (from, to) {
                (Exchanged::Coordinate(from), Exchanged::Coordinate(to)) => image.coordinates[to].0 = from,
                (Exchanged::Phase(from), Exchanged::Phase(to)) => image.phases[from] = to,
                _ => {}
            }
        }
    }

    /// Whether one may come in the place of the other.
    fn fits(&mut self, from: Exchanged, to: Exchanged, place: &Place, phases: bool) -> bool {
        let problem = match (from, to) {
            (Exchanged::Coordinate(i), Exchanged::Coordinate(j)) => {
                let units = &self.scope.units.coordinates;
                let (a, b) = (units.get(i).and_then(|m| m.dimension()), units.get(j).and_then(|m| m.dimension()));
                let (Some(a), Some(b)) = (a, b) else { return true };
                if a == b {
                    return true;
                }
                let [i, j] = [i, j].map(|k| self.model.coordinates[k].name.clone());
                units::unlike_exchange(place.clone(), i, a.wanted(), j, b.wanted())
            }
            (Exchanged::Phase(_), Exchanged::Phase(_)) if phases => return true,
            (Exchanged::Phase(_), Exchanged::Phase(_)) => {
                sections::no_exchange(place.clone(), "is of phases, and a state is in one", "exchange coordinates here")
            }
            _ => {
                let help = "coordinates are exchanged with coordinates, phases with phases";
                sections::no_exchange(place.clone(), "sends a coordinate to a phase", help)
            }
        };
        self.builder.problems.push(problem);
        false
    }

    /// The coordinates or phases that a name stands for, the members of a family in order.
    fn exchanged(&mut self, words: &str, place: &Place) -> Option<Vec<Exchanged>> {
        let at = Spot { node: &Node::Null, place: place.clone(), name: String::new() };
        let family = self.start_key(words, &at)?;
        let mut found = Vec::with_capacity(family.members.len());
        for member in &family.members {
            let phase =
                self.scope.phase_names.get(&member.base).filter(|_| !self.scope.names.contains_key(&member.base));
            match phase.map(|entry| (entry.refused, entry.members.get(&member.indices))) {
                Some((true, _)) => return None,
                Some((_, Some(Member::Phase(phase)))) => found.push(Exchanged::Phase(*phase)),
                _ => found.extend(self.coordinates_of(member, place)?.into_iter().map(Exchanged::Coordinate)),
            }
        }
        Some(found)
    }

    /// The coordinates that a name stands for: one, or all of a family that is named without indices.
    fn coordinates_of(&mut self, member: &Expanded, place: &Place) -> Option<Vec<usize>> {
        let entry = self.scope.names.get(&member.base);
        let whole = |entry: &&crate::model::expression::scope::Entry| {
            entry.section == Section::Coordinate && entry.indices > 0 && member.indices.is_empty() && !entry.refused
        };
        if let Some(entry) = entry.filter(whole) {
            let coordinate =
                |member: &Member| if let Member::Coordinate(k) = member { Some(*k as usize) } else { None };
            return entry.members.values().map(coordinate).collect();
        }
        if entry.is_none() {
            let own = &self.model.coordinates[..self.model.mechanical()];
            let coordinates = own.iter().map(|c| c.name.as_str());
            let known: Vec<&str> = coordinates.chain(self.scope.phase_names.keys().map(String::as_str)).collect();
            let help = did_you_mean_or(&member.name(), &known);
            self.builder.problems.push(names::unknown_name(place.clone(), member.name(), help));
            return None;
        }
        self.coordinate(member, place).map(|coordinate| vec![coordinate])
    }

    /// A list of coordinates, one, or `all`.
    fn listed_coordinates(&mut self, spot: &Spot<'_>) -> Vec<usize> {
        let items = spot.items().unwrap_or_else(|| vec![spot.clone()]);
        let mut found = Vec::new();
        for item in items {
            let Some(words) = item.words(&mut self.builder.problems) else { continue };
            if words == "all" && !self.scope.names.contains_key(words) {
                found.extend(0..self.model.coordinates.len());
                continue;
            }
            let Some(family) = self.start_key(words, &item) else { continue };
            for member in &family.members {
                found.extend(self.coordinates_of(member, &item.place).unwrap_or_default());
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// `turn`: angles that are whole turns more.
    fn turns(&mut self, spot: &Spot<'_>) -> Vec<(usize, i64)> {
        let mut found = Vec::new();
        for (key, entry) in spot.entries(&mut self.builder.problems) {
            let Some(family) = self.start_key(key, &entry) else { continue };
            let Some(turns) = self.whole(&entry, -i64::from(MOST_PARTS)) else { continue };
            for member in &family.members {
                let Some(coordinates) = self.coordinates_of(member, &entry.place.of_key()) else { break };
                for coordinate in coordinates {
                    let unit = self.scope.units.coordinates.get(coordinate).and_then(|unit| unit.dimension());
                    if let Some(unit) = unit.filter(|unit| *unit != Dimension::ONE) {
                        let (name, found) = (self.model.coordinates[coordinate].name.clone(), unit.wanted());
                        let place = entry.place.of_key();
                        self.builder.problems.push(names::wrong_thing(place, name, "an angle", found));
                        continue;
                    }
                    found.push((coordinate, turns));
                }
            }
        }
        found
    }

    /// `from` and `to`.
    fn reversing_ends(&mut self, spot: &Spot<'_>) -> Option<[Image; 2]> {
        let (from, to) = (spot.get("from"), spot.get("to"));
        let (from, to) = match (from, to) {
            (None, None) => return None,
            (Some(from), Some(to)) => (from, to),
            (Some(one), None) => return self.lonely(&one, "from", "to"),
            (None, Some(one)) => return self.lonely(&one, "to", "from"),
        };
        if !self.not_beside_between(spot) {
            return None;
        }
        let mut ends = Vec::new();
        for end in [from, to] {
            let before = self.builder.problems.len();
            if !end.only(&["exchange", "mirror"], "a reversing state", &mut self.builder.problems) {
                continue;
            }
            let image = self.image(&end, false);
            if self.builder.problems.len() == before && !image.after(&image).is_identity() {
                let why = "done twice does not give back what was there";
                let help = "time that is reversed twice goes on: exchange in pairs, and mirror both of a pair or none";
                self.builder.problems.push(sections::no_exchange(image.place.clone(), why, help));
            }
            ends.push(image);
        }
        <[Image; 2]>::try_from(ends).ok()
    }

    fn lonely(&mut self, spot: &Spot<'_>, key: &str, other: &str) -> Option<[Image; 2]> {
        self.builder.problems.push(sections::needs_another_key(spot.place.of_key(), key, other, "`closes`"));
        None
    }

    /// What part of the period lies between: 1 over how often the exchanges and mirrors must be done to give back the start.
    fn part_of_period(&mut self, spot: &Spot<'_>, image: &Image, between: Option<&[Image; 2]>) -> Option<u32> {
        let (order, place) = match between {
            None => (image.order(MOST_PARTS), &image.place),
            Some([from, to]) => (to.after(from).order(MOST_PARTS).map(|order| 2 * order), &to.place),
        };
        let Some(order) = order else {
            let why = format!("does not give back the start in {MOST_PARTS} times");
            self.builder.problems.push(sections::no_exchange(place.clone(), why, "leave some of its cycles out"));
            return None;
        };
        let Some(part) = spot.get("part") else { return Some(order) };
        let quantity = part.quantity(&mut self.builder.problems)?;
        let value = self.setting(&quantity, PART, &Self::no_locals())?;
        let number = self.builder.graph.number(value).map(|number| number.to_f64());
        if number.is_some_and(|number| (number * f64::from(order) - 1.0).abs() < 1e-9) {
            return Some(order);
        }
        self.builder.problems.push(sections::part_unlike_exchange(part.place, &quantity.text.source, order));
        None
    }
}
