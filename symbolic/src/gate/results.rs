//! Named reactions as results, where equations are written out.
//!
//! An equation that alone says what a reaction is takes any value, and accelerations do not tell.  Force and moment on the
//! bodies do, if nothing acts there but loads and named reactions.  Which other reactions there may be follows from the
//! motions that the file admits: reactions do no work on them, and so they lie in a space S of forces and moments on all
//! bodies, Vᵀ f = Jᵀ μ with the velocities V q' of all bodies and constraints J q' = 0.  Where the named reactions span S there
//! is no room for another one, and a reaction that is independent of the others has one value.  Where they do not (a guide
//! that nobody named), nothing is said: the guide might take anything.  Directions that share no coordinate, constraint or
//! reaction are judged one by one.  What nothing moves in a direction is supported there, by bearings that need no name, beside directions that
//! move; where a named reaction acts in such directions alone it is judged unless a pin or rod that nobody named may push there too.

use super::Gate;
use super::links::Links;
use super::motion::{Motion, blocks};
use super::null::{Columns, contains, null_space, rank};
use super::state::{State, describe};
use super::suspects::Known;
use super::system::Assembled;
use crate::derive::momentum::Momentum;
use crate::diagnose::catalogue::verdicts;
use crate::diagnose::{Problem, listed};
use crate::expr::{Graph, Id, Measured, Symbol, Tape, jacobian};
use crate::model::{BalanceSystem, Load, Model, Reaction, Rotation};
use crate::number::DoubleDouble;

/// Of directions (forces and moments on all bodies) that hang together more than this are not judged: each state takes
/// their cube.
const DIRECTIONS: usize = 60;

/// What differs by no more than this of its terms is equal: null spaces of plain matrices have some twenty digits, and a
/// printed number shows nine.
pub(super) const SAME: f64 = 1e-13;

/// A reaction component at every state, where it is determined.
pub(super) type Values = Vec<Option<Measured>>;

/// Errors for reactions that their bodies contradict; words for those of which nothing else tells.
pub(super) fn confirmed(
    model: &mut Model,
    motion: &Motion,
    (system, linear): (&BalanceSystem, &Momentum),
    (assembled, states): (&[Assembled], &[State]),
    gate: Gate,
) -> Result<Vec<String>, Vec<Problem>> {
    let own: Vec<Values> = assembled.iter().zip(states).map(|(a, state)| a.eliminated(&state.a).reactions).collect();
    let by_bodies = match &linear.bodies {
        Some(bodies) if bodies_see_everything(model) => {
            by_bodies(model, motion, (system, bodies), (&own, states), Judged::ThatHold)
        }
        _ => Vec::new(),
    };
    let elsewhere = |k: &usize| model.balances.iter().filter(|system| system.reactions.contains(k)).count() > 1;
    let (mut problems, mut words) = (Vec::new(), Vec::new());
    for (k, reaction, components) in reactions(model, system) {
        for component in components.clone() {
            let name = named(reaction, component - components.start);
            let resting = resting(system, assembled, states, component);
            let told = by_bodies.get(component).filter(|told| told.iter().any(Option::is_some));
            let Some(told) = told else {
                let on = match resting.filter(|_| !elsewhere(&k)) {
                    Some(Resting::On(balance)) => system.balances[balance].label.clone(),
                    Some(Resting::All) => format!("the written-out equations of `{}`", system.name),
                    None => continue,
                };
                words.push(format!("`{name}` rests on {on} alone"));
                continue;
            };
            let differ = |state: &usize| match (own[*state][component], told[*state]) {
                (Some(x), Some(y)) => {
                    let (gap, size) = ((x.value - y.value).abs().to_f64(), x.magnitude + y.magnitude);
                    (gap.is_finite() && gap > SAME * size).then_some((x, y, *state))
                }
                _ => None,
            };
            if let Some((here, there, state)) = (0..states.len()).find_map(|state| differ(&state)) {
                // Those that are off with what the bodies say.
                let off = Known::new((&by_bodies, &[]), states, gate).suspects(system, assembled);
                let mut off: Vec<usize> = off.into_iter().flat_map(|suspect| suspect.balances).collect();
                off.retain(|b| system.balances[*b].is_written());
                off.sort_unstable();
                let labels: Vec<String> = off.iter().map(|b| system.balances[*b].label.clone()).collect();
                let (place, label) = match (resting, off.first()) {
                    (Some(Resting::On(balance)), _) => {
                        (&system.balances[balance].place, system.balances[balance].label.clone())
                    }
                    (_, Some(first)) => (&system.balances[*first].place, listed(&labels)),
                    _ => (&system.place, format!("`{}`", system.name)),
                };
                let [here, there] = [here, there].map(|x| format!("{:.9e}", x.value.to_f64()));
                let at = describe(model, &states[state]);
                problems.push(verdicts::reaction_against_bodies(place.clone(), name, here, label, there, at));
                break;
            }
        }
    }
    if problems.is_empty() { Ok(words) } else { Err(problems) }
}

/// The reactions of a system that is wrong by force and moment on the bodies, component by component, to find out which equation is.
pub(super) fn presumed(
    model: &mut Model,
    motion: &Motion,
    (system, linear): (&BalanceSystem, &Momentum),
    (assembled, states): (&[Assembled], &[State]),
) -> Vec<Values> {
    let own: Vec<Values> = assembled.iter().zip(states).map(|(a, state)| a.eliminated(&state.a).reactions).collect();
    match &linear.bodies {
        Some(bodies) if bodies_see_everything(model) => {
            by_bodies(model, motion, (system, bodies), (&own, states), Judged::All)
        }
        _ => Vec::new(),
    }
}

/// Which reactions are asked for.
#[derive(Clone, Copy, PartialEq)]
enum Judged {
    /// Those that can be what holds the bodies; others may be names of loads.
    ThatHold,
    All,
}

/// The reactions of a system with the places of their components.
fn reactions<'m>(
    model: &'m Model,
    system: &BalanceSystem,
) -> impl Iterator<Item = (usize, &'m Reaction, std::ops::Range<usize>)> {
    let mut next = 0;
    system.reactions.clone().into_iter().map(move |k| {
        let first = next;
        next += model.reactions[k].components;
        (k, &model.reactions[k], first..next)
    })
}

/// Systems in whose unknowns Lagrange's multipliers stand no more.
pub(super) fn with_multipliers(systems: Vec<Assembled>, linear: &Momentum, states: &[State]) -> Vec<Assembled> {
    let multipliers: Vec<Symbol> =
        linear.unknowns.iter().copied().filter(|s| matches!(s, Symbol::Multiplier(_))).collect();
    let known = |state: &State| multipliers.iter().map(|s| state.measured(*s)).collect::<Vec<_>>();
    systems.iter().zip(states).map(|(system, state)| system.with_last(&known(state))).collect()
}

/// Whether all inertia and all forces are those of bodies, and it is clear on which body each force acts.
fn bodies_see_everything(model: &Model) -> bool {
    let raw = [model.raw_kinetic_energy, model.raw_potential_energy, model.dissipation];
    raw.iter().all(|x| *x == Id::ZERO) && model.generalized_forces.is_empty() && model.shared_ends.is_empty()
}

/// Directions of bodies that hang together, with the coordinates that move them, the constraints that hold these, and the
/// reactions that push there.
struct Part {
    directions: Vec<usize>,
    coordinates: Vec<usize>,
    rows: Vec<usize>,
    reactions: Vec<usize>,
}

/// The reactions of a system by force and moment on the bodies, component by component.
fn by_bodies(
    model: &mut Model,
    motion: &Motion,
    (system, bodies): (&BalanceSystem, &Momentum),
    (own, states): (&[Values], &[State]),
    judged: Judged,
) -> Vec<Values> {
    let n = model.coordinates.len();
    let balances = with_multipliers(Assembled::derived(&model.graph, bodies, states), bodies, states);
    let count = balances.first().map_or(0, |b| b.size - n);
    let mut told = vec![vec![None; states.len()]; count];
    let velocities = Velocities::new(model);
    let pushed: Vec<usize> = model.loads.iter().flat_map(|load| &load.pushes).filter_map(|push| push.body).collect();
    let doubled = model.loads.iter().flat_map(Load::expressions).collect::<Vec<_>>();
    let rubs = model.graph.symbols(doubled).iter().any(|s| matches!(s, Symbol::Multiplier(_)));
    let parts = parts(motion, &velocities, (bodies, count));
    let seen_of = |part: &Part| -> Vec<Option<Seen>> {
        let at = |k: usize| Seen::new(part, &velocities, motion, (&balances[k], &states[k]), judged);
        (0..states.len()).map(at).collect()
    };
    // A guide that shows at some states only is there at all of them.
    let has_room = |part: &Part, seen: &[Option<Seen>]| {
        seen.iter().flatten().any(|seen| seen.has_room(part.directions.len()) == Some(true))
    };
    let is_pushed = |part: &Part| {
        let links = Links::new(model, &velocities, states);
        let open = |other: &Part| other.directions.len() > DIRECTIONS || has_room(other, &seen_of(other));
        let others = parts.iter().filter(|other| other.directions != part.directions);
        others.filter(|other| links.between(&part.directions, &other.directions)).any(open)
    };
    for part in parts.iter().filter(|part| !part.reactions.is_empty() && part.directions.len() <= DIRECTIONS) {
        let seen = seen_of(part);
        let judges = judged == Judged::ThatHold;
        if has_room(part, &seen) || judges && part.coordinates.is_empty() && is_pushed(part) {
            continue;
        }
        for (place, component) in part.reactions.iter().enumerate() {
            let of = reactions(model, system).find(|(_, _, components)| components.contains(component));
            let whole = |other: &usize| of.as_ref().is_some_and(|(_, _, all)| all.contains(&part.reactions[*other]));
            let one = if rubs { vec![place] } else { (0..part.reactions.len()).filter(whole).collect() };
            let works = |seen: &Seen| {
                let together = !seen.acts_on(&one, &pushed, (part, &velocities));
                seen.does_no_work(&one, together) == Some(false)
            };
            // What works at some states only works at all of them.
            if judged == Judged::ThatHold && seen.iter().flatten().any(works) {
                continue;
            }
            for (k, seen) in seen.iter().enumerate() {
                let value = |seen: &Seen| seen.value(place, part, &balances[k], (&states[k].a, &own[k]));
                told[*component][k] = seen.as_ref().and_then(value);
            }
        }
    }
    told
}

/// Velocities of all bodies by the speeds: of each its centre of mass, and how fast it turns.
pub(super) struct Velocities {
    pub places: Vec<(usize, usize)>,
    pub tape: Tape,
    /// The body of each.
    pub owners: Vec<usize>,
}

impl Velocities {
    fn new(model: &mut Model) -> Velocities {
        // One velocity for each equation of the bodies: three of the centre of mass and three of the turn in space.
        let (mut moved, mut spun) = (Vec::new(), Vec::new());
        let mut directions = 0;
        let mut owners = Vec::new();
        for (b, body) in model.bodies.iter().enumerate() {
            moved.extend(body.position.iter().map(|position| (next(&mut directions), *position)));
            match &body.rotation {
                Some(Rotation::Plane { angle, .. }) => moved.push((next(&mut directions), *angle)),
                Some(Rotation::Space { frame, .. }) => {
                    spun.extend(frame.velocity.iter().map(|rate| (next(&mut directions), *rate)));
                }
                None => {}
            }
            owners.resize(directions, b);
        }
        let coordinate = |s: Symbol| if let Symbol::Coordinate(i) = s { Some(i as usize) } else { None };
        let speed = |s: Symbol| if let Symbol::Speed(i) = s { Some(i as usize) } else { None };
        let mut entries = slopes(&mut model.graph, &moved, coordinate);
        entries.extend(slopes(&mut model.graph, &spun, speed));
        let tape = Tape::new(&model.graph, &entries.iter().map(|e| e.2).collect::<Vec<_>>());
        Velocities { places: entries.iter().map(|e| (e.0, e.1)).collect(), tape, owners }
    }

    /// Whether some coordinate moves a body in a direction.
    pub fn moves(&self, direction: usize) -> bool {
        self.places.iter().any(|(d, _)| *d == direction)
    }
}

/// The number of the next direction.
fn next(count: &mut usize) -> usize {
    *count += 1;
    *count - 1
}

/// Derivatives of numbered expressions by what `by` numbers: of each its number, by what, and the derivative.
fn slopes(graph: &mut Graph, of: &[(usize, Id)], by: impl Fn(Symbol) -> Option<usize>) -> Vec<(usize, usize, Id)> {
    let expressions: Vec<Id> = of.iter().map(|(_, expression)| *expression).collect();
    let lines = jacobian(graph, &expressions, by).into_iter().zip(of);
    lines.flat_map(|(line, (d, _))| line.into_iter().map(move |(i, slope)| (*d, i, slope))).collect()
}

/// Directions that share no coordinate, constraint or reaction with others.
fn parts(motion: &Motion, velocities: &Velocities, (bodies, count): (&Momentum, usize)) -> Vec<Part> {
    let n = motion.n;
    // Numbered one after the other: coordinates, rows of constraints, directions, reactions.
    let directions = n + motion.constraints.len();
    let reactions = directions + bodies.right.len();
    let moves = velocities.places.iter().map(|(d, i)| (*i, directions + d));
    let pushed = bodies.matrix.iter().filter(|e| (n..n + count).contains(&e.1));
    let pushes = pushed.map(|(d, column, _)| (directions + d, reactions + column - n));
    let pairs: Vec<(usize, usize)> = motion.constraints.couplings().into_iter().chain(moves).chain(pushes).collect();
    let part = |block: Vec<usize>| {
        let within = |from: usize, to: usize| {
            block.iter().filter(|k| (from..to).contains(k)).map(|k| k - from).collect::<Vec<usize>>()
        };
        Part {
            coordinates: within(0, n),
            rows: within(n, directions),
            directions: within(directions, reactions),
            reactions: within(reactions, reactions + count),
        }
    };
    blocks(reactions + count, &pairs).into_iter().map(part).collect()
}

/// A part at a state.
struct Seen {
    /// A basis of all forces and moments that do no work on the motions that are admitted.
    ideal: Columns,
    /// The forces and moments of the named reactions of size 1, and the magnitudes of their entries.
    named: Columns,
    sizes: Vec<Vec<f64>>,
    /// Those of supports that nobody named.
    supports: Columns,
}

impl Seen {
    /// `None` where a matter of rounding would decide.
    fn new(
        part: &Part,
        velocities: &Velocities,
        motion: &Motion,
        (balances, state): (&Assembled, &State),
        judged: Judged,
    ) -> Option<Seen> {
        let n = motion.n;
        let entries = velocities.tape.evaluate(|s| state.measured(s));
        let mut columns = vec![vec![DoubleDouble::ZERO; part.coordinates.len()]; part.directions.len()];
        for ((d, i), x) in velocities.places.iter().zip(&entries).filter(|(_, x)| !x.vanishes(super::ROUNDINGS)) {
            if let (Ok(d), Ok(i)) = (part.directions.binary_search(d), part.coordinates.binary_search(i)) {
                columns[d][i] = x.value;
            }
        }
        let moves = columns.clone();
        let (rank, mut rows) = motion.constraints.rank(state);
        rows.truncate(rank);
        rows.retain(|row| part.rows.contains(row));
        let held = motion.constraints.held(state, rows);
        for line in held.matrix.chunks(n.max(1)) {
            columns.push(part.coordinates.iter().map(|i| line[*i].value).collect());
        }
        let mut ideal = null_space(&columns, part.coordinates.len())?;
        ideal.iter_mut().for_each(|combination| combination.truncate(part.directions.len()));
        let entry = |d: &usize, k: &usize| balances.matrix[d * balances.size + n + k];
        let of = |k: &usize| part.directions.iter().map(|d| entry(d, k)).collect::<Vec<Measured>>();
        let measured: Vec<Vec<Measured>> = part.reactions.iter().map(of).collect();
        let plain = |x: &Measured| if x.vanishes(super::ROUNDINGS) { DoubleDouble::ZERO } else { x.value };
        let named: Columns = measured.iter().map(|column| column.iter().map(plain).collect()).collect();
        let sizes = measured.iter().map(|column| column.iter().map(|x| x.magnitude).collect()).collect();
        let supports = match judged {
            Judged::All => supports(part, velocities, &moves, &named)?,
            Judged::ThatHold if part.coordinates.is_empty() => Vec::new(),
            Judged::ThatHold => bearings(part, velocities),
        };
        Some(Seen { ideal, named, sizes, supports })
    }

    /// All reactions, named or not.
    fn all(&self) -> Columns {
        [self.named.as_slice(), &self.supports].concat()
    }

    /// Whether another reaction might act.
    fn has_room(&self, length: usize) -> Option<bool> {
        Some(!contains(&self.all(), &self.ideal, length)?)
    }

    /// Whether the components of a reaction, by their places, can be a reaction of what holds the bodies, by themselves or with other named
    /// ones, as the forces at both ends of a rope.
    fn does_no_work(&self, one: &[usize], together: bool) -> Option<bool> {
        let length = self.ideal.first().map_or(0, Vec::len);
        let own: Columns = one.iter().map(|place| self.named[*place].clone()).collect();
        let mut beside = self.ideal.clone();
        if together {
            beside.extend((0..self.named.len()).filter(|k| !one.contains(k)).map(|k| self.named[k].clone()));
        }
        let apart = rank(&own, length)? + rank(&beside, length)?;
        Some(rank(&[own, beside].concat(), length)? < apart)
    }

    /// Whether some components of a reaction act on one of these bodies.
    fn acts_on(&self, one: &[usize], bodies: &[usize], (part, velocities): (&Part, &Velocities)) -> bool {
        let pushed = |d: &usize| bodies.contains(&velocities.owners[part.directions[*d]]);
        let pushes = |place: &usize, d: &usize| self.named[*place][*d] != DoubleDouble::ZERO;
        (0..part.directions.len()).filter(pushed).any(|d| one.iter().any(|place| pushes(place, &d)))
    }

    /// A reaction by the combination of balances in which no other one stands.
    fn value(
        &self,
        place: usize,
        part: &Part,
        balances: &Assembled,
        (accelerations, own): (&[Measured], &Values),
    ) -> Option<Measured> {
        let all = self.all();
        let others = |d: usize| (0..all.len()).filter(|k| *k != place).map(|k| all[k][d]).collect();
        let lines: Columns = (0..part.directions.len()).map(others).collect();
        let combinations = null_space(&lines, all.len().saturating_sub(1))?;
        let known: Vec<Measured> = part.directions.iter().map(|d| balances.known(*d, accelerations)).collect();
        let size = |d: usize| {
            let pushed = part.reactions.iter().zip(&self.sizes);
            let pushed = pushed.map(|(k, sizes)| own[*k].map_or(0.0, |x| sizes[d] * x.value.to_f64().abs()));
            known[d].magnitude + pushed.sum::<f64>()
        };
        let sum = |of: &[DoubleDouble], y: &[DoubleDouble]| {
            of.iter().zip(y).fold(DoubleDouble::ZERO, |sum, (x, y)| sum + *x * *y)
        };
        let values: Vec<DoubleDouble> = known.iter().map(|x| x.value).collect();
        let found = combinations.iter().filter_map(|y| {
            let by = sum(&self.named[place], y);
            let among: f64 = (0..y.len()).map(|d| self.sizes[place][d] * y[d].abs().to_f64()).sum();
            let terms: f64 = (0..y.len()).map(|d| size(d) * y[d].abs().to_f64()).sum();
            let plain = by.abs().to_f64() > SAME * among;
            plain.then(|| Measured { value: -sum(&values, y) / by, magnitude: terms / by.abs().to_f64() })
        });
        found.min_by(|x, y| x.magnitude.total_cmp(&y.magnitude))
    }
}

/// Forces and moments in the directions of a part in which nothing moves.
fn bearings(part: &Part, velocities: &Velocities) -> Columns {
    let still = part.directions.iter().enumerate().filter(|(_, d)| !velocities.moves(**d));
    let unit = |at: usize| {
        let mut column = vec![DoubleDouble::ZERO; part.directions.len()];
        column[at] = DoubleDouble::ONE;
        column
    };
    still.map(|(at, _)| unit(at)).collect()
}

/// Forces and moments on one body each along which it does not move, where those of a body are not among the named ones.
fn supports(part: &Part, velocities: &Velocities, moves: &Columns, named: &Columns) -> Option<Columns> {
    let count = part.directions.len();
    let owners: Vec<usize> = part.directions.iter().map(|d| velocities.owners[*d]).collect();
    let mut bodies = owners.clone();
    bodies.dedup();
    let mut supports = Columns::new();
    for body in bodies {
        let own: Vec<usize> = (0..count).filter(|d| owners[*d] == body).collect();
        let columns: Columns = own.iter().map(|d| moves[*d].clone()).collect();
        let whole = |combination: Vec<DoubleDouble>| {
            let mut column = vec![DoubleDouble::ZERO; count];
            own.iter().zip(combination).for_each(|(d, x)| column[*d] = x);
            column
        };
        let held: Columns = null_space(&columns, part.coordinates.len())?.into_iter().map(whole).collect();
        if !contains(named, &held, count)? {
            supports.extend(held);
        }
    }
    Some(supports)
}

/// The written equation without which a reaction is not determined, or all of them; nothing where balances of bodies determine
/// it.
fn resting(system: &BalanceSystem, assembled: &[Assembled], states: &[State], component: usize) -> Option<Resting> {
    let determined = |a: &Assembled, state: &State| a.eliminated(&state.a).reactions[component].is_some();
    let (whole, state) = assembled.iter().zip(states).find(|(a, state)| determined(a, state))?;
    let of = |balance: usize| std::iter::repeat_n(balance, system.balances[balance].components);
    let owners: Vec<usize> = (0..system.balances.len()).flat_map(of).collect();
    let without = |left_out: &dyn Fn(usize) -> bool| {
        // Rows of contacts belong to no balance.
        let stays = |row: &usize| owners.get(*row).is_none_or(|balance| !left_out(*balance));
        let kept: Vec<usize> = (0..whole.judged).filter(stays).collect();
        determined(&whole.only(&kept), state)
    };
    let written = |balance: usize| system.balances[balance].is_written();
    if without(&written) {
        return None;
    }
    let one = (0..system.balances.len()).find(|one| written(*one) && !without(&|balance| balance == *one));
    Some(one.map_or(Resting::All, Resting::On))
}

/// On what a reaction rests.
#[derive(Clone, Copy)]
enum Resting {
    /// This balance.
    On(usize),
    /// All equations of its system that are written out.
    All,
}

/// `pin.x`.
fn named(reaction: &Reaction, component: usize) -> String {
    let axis = if reaction.scalar { "" } else { [".x", ".y", ".z"][component.min(2)] };
    format!("{}{axis}", reaction.name)
}
