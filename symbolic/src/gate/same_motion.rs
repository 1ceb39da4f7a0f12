//! Whether images of motions that `motions` names are motions: exchanges, mirrors, shifts, turns, reversals and periods.

use super::directions::mixed;
use super::motion::Motion as Dynamics;
use super::state::{State, describe};
use crate::derive::{Equations, Rows};
use crate::diagnose::Problem;
use crate::diagnose::catalogue::{mechanics, verdicts};
use crate::expr::{Graph, Id, Measured, Symbol, Tape};
use crate::model::command::evaluate_all;
use crate::model::{Closes, EventAction, Goal, Image, Model, Motion};
use crate::number::DoubleDouble;
use crate::random::Random;

/// States in every phase at which an image must be one.
const STATES: usize = 8;
/// Draws for each of them, where something is not defined at a state or at its image.
const DRAWS: usize = 8;

/// A map of states: q → ±q of another coordinate, plus a shift; with time reversed speeds change their signs; and a map of time.
struct Map<'a> {
    image: &'a Image,
    shift: Vec<(usize, DoubleDouble)>,
    reversed: bool,
    /// What is added to t, or to −t where time is reversed.
    time: DoubleDouble,
}

/// What changes, by how much, at which state.
struct Change {
    what: String,
    by: f64,
    at: String,
}

/// Everything that images are compared by.
struct Compared<'a> {
    model: &'a Model,
    dynamics: &'a Dynamics,
    residual: Tape,
    /// c, c' and J a + γ of every row of the constraints.
    rows: Tape,
    holonomic: &'a [bool],
    /// Function and condition of every event.
    events: Tape,
}

/// Errors for motions whose images are none, with the parameters of each motion.
pub(super) fn images(
    model: &Model,
    dynamics: &Dynamics,
    (equations, rows): (&Equations, &Rows),
    states: &[State],
) -> Vec<Problem> {
    if !model.motions.iter().any(|motion| matches!(motion.goal, Goal::Closes(_))) {
        return Vec::new();
    }
    let mut graph = model.graph.clone();
    let of_rows = rate_rows(&mut graph, rows);
    let compared = Compared {
        model,
        dynamics,
        residual: Tape::new(&graph, &equations.residual),
        rows: Tape::new(&graph, &of_rows),
        holonomic: &rows.holonomic,
        events: Tape::new(
            &graph,
            &model.events.iter().flat_map(|e| [e.when, e.condition.unwrap_or(Id::ONE)]).collect::<Vec<_>>(),
        ),
    };
    let closing = model.motions.iter().filter_map(|motion| match &motion.goal {
        Goal::Closes(closes) => Some((motion, &**closes)),
        _ => None,
    });
    closing.flat_map(|(motion, closes)| compared.problems(motion, closes, states)).collect()
}

/// c, c' and J a + γ of every row.
fn rate_rows(graph: &mut Graph, rows: &Rows) -> Vec<Id> {
    let mut second = rows.bias.clone();
    for (row, coordinate, value) in &rows.matrix {
        let acceleration = graph.symbol(Symbol::Acceleration(*coordinate as u32));
        let term = graph.mul(*value, acceleration);
        second[*row] = graph.add(second[*row], term);
    }
    (0..second.len()).flat_map(|row| [rows.value[row], rows.rate[row], second[row]]).collect()
}

impl Compared<'_> {
    fn problems(&self, motion: &Motion, closes: &Closes, states: &[State]) -> Vec<Problem> {
        let parameters = self.parameters(motion);
        let states = self.states(&parameters, states);
        let identity = Image::identity(self.model.coordinates.len(), self.model.phases.len(), closes.place.clone());
        let still = |shift: Vec<(usize, DoubleDouble)>| Map {
            image: &identity,
            shift,
            reversed: false,
            time: DoubleDouble::ZERO,
        };
        let mut problems = Vec::new();
        for coordinate in &closes.shifts {
            let size = states.iter().fold(1.0, |most: f64, state| most.max(state.q[*coordinate].abs().to_f64()));
            if let Some(change) = self.change(&still(vec![(*coordinate, DoubleDouble::from(0.7 * size))]), &states) {
                problems.push(self.shifted(closes, *coordinate, change));
            }
        }
        for (coordinate, turns) in &closes.turns {
            let angle = DoubleDouble::PI * DoubleDouble::from(2.0 * *turns as f64);
            if let Some(change) = self.change(&still(vec![(*coordinate, angle)]), &states) {
                problems.push(self.shifted(closes, *coordinate, change));
            }
        }
        let moved = Map { time: DoubleDouble::from(0.7), ..still(Vec::new()) };
        let timed = self.change(&moved, &states);
        let period = closes.period.map(|period| {
            let state = State::at_rest(parameters.clone(), 0);
            Tape::new(&self.model.graph, &[period]).evaluate(|s| state.value(s))[0]
        });
        let period = match (timed, period) {
            (None, _) => DoubleDouble::ZERO,
            (Some(change), None) => {
                problems.push(mechanics::period_needed(closes.place.clone(), change.what));
                return problems;
            }
            (Some(_), Some(period)) => period,
        };
        let whole = Map { time: period, ..still(Vec::new()) };
        if let Some(Change { what, by, at }) = self.change(&whole, &states) {
            let seconds = format!("{:.6}", period.to_f64());
            problems.push(verdicts::not_a_period(closes.place.clone(), seconds, what, format!("{by:.3e}"), at));
            return problems;
        }
        let part = period / DoubleDouble::from(f64::from(closes.part));
        let two = DoubleDouble::from(2.0);
        let maps = match &closes.between {
            None => vec![Map { image: &closes.image, shift: Vec::new(), reversed: false, time: part }],
            // The start is at t = 0.
            Some([from, to]) => vec![
                Map { image: from, shift: Vec::new(), reversed: true, time: DoubleDouble::ZERO },
                Map { image: to, shift: Vec::new(), reversed: true, time: part * two },
            ],
        };
        problems.extend(maps.iter().filter_map(|map| {
            let Change { what, by, at } = self.change(map, &states)?;
            Some(verdicts::no_symmetry(map.image.place.clone(), what, format!("{by:.3e}"), at))
        }));
        problems
    }

    fn shifted(&self, closes: &Closes, coordinate: usize, change: Change) -> Problem {
        let name = &self.model.coordinates[coordinate].name;
        verdicts::shift_matters(closes.place.clone(), name, change.what, format!("{:.3e}", change.by), change.at)
    }

    /// Those of a motion's scene.
    fn parameters(&self, motion: &Motion) -> Vec<f64> {
        let mut parameters: Vec<f64> = self.model.parameters.iter().map(|p| p.default).collect();
        let set: Vec<Id> = motion.scene.set.iter().map(|(_, id)| *id).collect();
        let values = evaluate_all(&self.model.graph, &set, &parameters);
        motion.scene.set.iter().zip(values).for_each(|((k, _), value)| parameters[*k] = value);
        parameters
    }

    /// States of every phase that need not meet constraints, with accelerations and multipliers of no motion.
    fn states(&self, parameters: &[f64], states: &[State]) -> Vec<State> {
        let mut random = Random::new();
        let (n, rows) = (self.model.coordinates.len(), self.holonomic.len());
        let mut found = Vec::new();
        for phase in 0..self.model.phases.len() {
            let known: Vec<State> =
                states.iter().filter(|state| state.phase == phase && !state.is_special()).cloned().collect();
            for _ in 0..if known.is_empty() { 0 } else { STATES * DRAWS } {
                let mut state = mixed(&known, &mut random);
                state.parameters = parameters.to_vec();
                let size = state
                    .a
                    .iter()
                    .fold(1.0_f64, |most, a| if a.magnitude.is_finite() { most.max(a.magnitude) } else { most });
                let mut draw = |count: usize| -> Vec<Measured> {
                    (0..count).map(|_| Measured::exact(random.between(-size, size).into())).collect()
                };
                (state.a, state.lambda) = (draw(n), draw(rows));
                let active = self.model.rows_of(&self.model.phases[phase]);
                let idle = (0..rows).filter(|row| !active.contains(row));
                idle.for_each(|row| state.lambda[row] = Measured::exact(DoubleDouble::ZERO));
                self.dynamics.prepare(&mut state);
                found.push(state);
            }
        }
        found
    }

    /// The first thing that a map changes.
    fn change(&self, map: &Map<'_>, states: &[State]) -> Option<Change> {
        for phase in 0..self.model.phases.len() {
            let here: Vec<&State> = states.iter().filter(|state| state.phase == phase).collect();
            let image = map.image.phases[phase];
            let pairs: Vec<(&State, State)> = here.iter().map(|state| (*state, self.image_of(map, state))).collect();
            let rows = match self.matched_rows(map, (phase, image), &pairs) {
                Ok(rows) => rows,
                Err(change) => return Some(change),
            };
            let events = if map.reversed { None } else { self.event_change(map, (phase, image), &rows, &pairs) };
            if let Some(change) = self.force_change(map, &rows, &pairs).or(events) {
                return Some(change);
            }
        }
        None
    }

    /// The image of a state; its multipliers are 0.
    fn image_of(&self, map: &Map<'_>, state: &State) -> State {
        let sign = |x: DoubleDouble, opposite: bool| if opposite { -x } else { x };
        let of = |list: &[DoubleDouble], opposite: bool| -> Vec<DoubleDouble> {
            map.image.coordinates.iter().map(|(i, sign_changes)| sign(list[*i], *sign_changes != opposite)).collect()
        };
        let mut image = state.clone();
        (image.q, image.v) = (of(&state.q, false), of(&state.v, map.reversed));
        for (coordinate, shift) in &map.shift {
            image.q[*coordinate] += *shift;
        }
        let a: Vec<DoubleDouble> = state.a.iter().map(|a| a.value).collect();
        image.a = of(&a, false).into_iter().map(Measured::exact).collect();
        image.t = sign(state.t, map.reversed) + map.time;
        image.phase = map.image.phases[state.phase];
        image.lambda.fill(Measured::exact(DoubleDouble::ZERO));
        self.dynamics.prepare(&mut image);
        image
    }

    /// For each row of the phase the one that it is at the image, and whether with the opposite sign.
    fn matched_rows(
        &self,
        map: &Map<'_>,
        (phase, image): (usize, usize),
        pairs: &[(&State, State)],
    ) -> Result<Vec<(usize, usize, bool)>, Change> {
        let rows = |phase: usize| self.model.rows_of(&self.model.phases[phase]);
        let (own, others) = (rows(phase), rows(image));
        let values: Vec<(Vec<Measured>, Vec<Measured>)> = pairs
            .iter()
            .map(|(state, image)| {
                (self.rows.evaluate(|s| state.measured(s)), self.rows.evaluate(|s| image.measured(s)))
            })
            .collect();
        let mut found: Vec<(usize, usize, bool)> = Vec::with_capacity(own.len());
        for row in own {
            let same = |other: usize, opposite: bool| {
                values.iter().zip(pairs).find_map(|((here, there), (state, _))| {
                    (0..3).find_map(|kind| {
                        // Of a row with speeds its integral may have another value.
                        let skipped = kind == 0 && !self.holonomic[row];
                        let turned = opposite != (map.reversed && kind == 1);
                        let by = difference(here[3 * row + kind], there[3 * other + kind], turned);
                        by.filter(|_| !skipped).map(|by| (by, *state))
                    })
                })
            };
            let free = others.iter().filter(|other| found.iter().all(|(_, taken, _)| taken != *other));
            let mut nearest: Option<(f64, &State)> = None;
            let matched = free.flat_map(|other| [(*other, false), (*other, true)]).find(|(other, opposite)| {
                let differs = same(*other, *opposite);
                if nearest.is_none() {
                    nearest = differs;
                }
                differs.is_none()
            });
            let Some((other, opposite)) = matched else {
                let (by, at) = nearest.map_or((f64::NAN, String::new()), |(by, at)| (by, describe(self.model, at)));
                return Err(Change { what: format!("the constraint `{}`", self.model.row_name(row)), by, at });
            };
            found.push((row, other, opposite));
        }
        let left = others.iter().find(|other| found.iter().all(|(_, taken, _)| taken != *other));
        match left {
            None => Ok(found),
            Some(row) => {
                let what = format!("the constraint `{}`, which has no counterpart,", self.model.row_name(*row));
                let at = pairs.first().map_or(String::new(), |(state, _)| describe(self.model, state));
                Err(Change { what, by: f64::INFINITY, at })
            }
        }
    }

    /// With the multipliers of the rows that match.
    fn with_multipliers(image: &State, state: &State, rows: &[(usize, usize, bool)]) -> State {
        let mut image = image.clone();
        for (row, other, opposite) in rows {
            let value = state.lambda[*row].value;
            image.lambda[*other] = Measured::exact(if *opposite { -value } else { value });
        }
        image
    }

    /// F(S q, ±S q', S q'') = S F(q, q', q'').
    fn force_change(&self, map: &Map<'_>, rows: &[(usize, usize, bool)], pairs: &[(&State, State)]) -> Option<Change> {
        pairs.iter().find_map(|(state, image)| {
            let image = Self::with_multipliers(image, state, rows);
            let here = self.residual.evaluate(|s| state.measured(s));
            let there = self.residual.evaluate(|s| image.measured(s));
            map.image.coordinates.iter().enumerate().find_map(|(k, (i, opposite))| {
                let by = difference(here[*i], there[k], *opposite)?;
                let what = format!("the equation of `{}`", self.model.coordinates[k].name);
                Some(Change { what, by, at: describe(self.model, state) })
            })
        })
    }

    /// Each event that changes the motion has one that does the same at the image.
    fn event_change(
        &self,
        map: &Map<'_>,
        (phase, image): (usize, usize),
        rows: &[(usize, usize, bool)],
        pairs: &[(&State, State)],
    ) -> Option<Change> {
        let acting = |phase: usize| {
            let counts = move |k: &usize| {
                let event = &self.model.events[*k];
                let changes =
                    |action: &EventAction| matches!(action, EventAction::Phase(_) | EventAction::Impact { .. });
                event.actions.iter().any(changes) && event.phases.as_ref().is_none_or(|phases| phases.contains(&phase))
            };
            (0..self.model.events.len()).filter(counts)
        };
        let values: Vec<(Vec<Measured>, Vec<Measured>)> = pairs
            .iter()
            .map(|(state, image)| {
                let image = Self::with_multipliers(image, state, rows);
                (self.events.evaluate(|s| state.measured(s)), self.events.evaluate(|s| image.measured(s)))
            })
            .collect();
        acting(phase).find_map(|event| {
            let same = |other: usize, opposite: bool| {
                let [one, two] = [event, other].map(|k| &self.model.events[k]);
                let direction = if opposite { -one.direction } else { one.direction };
                let alike = two.direction == direction && self.same_actions(map, &one.actions, &two.actions);
                alike
                    && values.iter().all(|(here, there)| {
                        difference(here[2 * event], there[2 * other], opposite).is_none()
                            && difference(here[2 * event + 1], there[2 * other + 1], false).is_none()
                    })
            };
            let found = acting(image).any(|other| same(other, false) || same(other, true));
            (!found).then(|| {
                let values = values
                    .first()
                    .map_or(f64::NAN, |(here, there)| (here[2 * event].value - there[2 * event].value).abs().to_f64());
                let what = format!("the event `{}`", self.model.events[event].name);
                let at = pairs.first().map_or(String::new(), |(state, _)| describe(self.model, state));
                Change { what, by: values, at }
            })
        })
    }

    fn same_actions(&self, map: &Map<'_>, one: &[EventAction], two: &[EventAction]) -> bool {
        let matched = |(a, b): (&EventAction, &EventAction)| match (a, b) {
            (EventAction::Phase(a), EventAction::Phase(b)) => map.image.phases[*a] == *b,
            (EventAction::Impact { restitution: a, .. }, EventAction::Impact { restitution: b, .. }) => a == b,
            (a, b) => a == b,
        };
        one.len() == two.len() && one.iter().zip(two).all(matched)
    }
}

/// By how much a number is not the other, or its opposite; `None` where it is to twenty digits, or where either is not defined.
fn difference(here: Measured, there: Measured, opposite: bool) -> Option<f64> {
    let value = if opposite { there.value + here.value } else { there.value - here.value };
    let difference = Measured { value, magnitude: here.magnitude + there.magnitude };
    let undefined = !difference.magnitude.is_finite() || !value.is_finite();
    (!undefined && !difference.vanishes(super::ROUNDINGS)).then(|| value.abs().to_f64())
}
