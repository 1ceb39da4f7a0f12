//! Multipliers of a motion that closes, without those that are known.

use nalgebra::{DMatrix, DVector};

use super::closing::By;
use super::found::Multiplier;
use super::laps::{Laps, Time, Trial};
use super::multipliers::{Polar, multipliers};
use super::structure::{self, Known};
use crate::matrix::svd;
use crate::vary::{Leg, TOLD, put};

/// A double multiplier of a map without two directions of its own comes apart by so many times the root of what the map is off by: μ ± √δ.
const COMES_APART: f64 = 2.0;
/// A direction has an image at all where the map leaves this part of it.
const LEAVES: f64 = 1e-6;

/// What the map does to small changes.
pub(super) struct Spectrum {
    pub multipliers: Vec<Polar>,
    /// Names of directions whose multipliers are known.
    pub known: Vec<String>,
    /// How many multipliers are 0 since the motion loses dimensions.
    pub lost: usize,
    /// Directions that are known at the start of each piece, in units of the scales.
    pub generators: Vec<Vec<Known>>,
    /// An orthonormal basis of all others at the start of the first piece.
    pub basis: DMatrix<f64>,
    /// The largest ratio of changes that one piece makes of changes that are equally large.
    pub spread: f64,
    /// By how much a piece stretches a change at most.
    stretch: f64,
    /// Of the flow.
    tolerance: f64,
    /// How many pieces there are.
    pieces: usize,
}

impl Spectrum {
    /// How well changes over a piece are known: to the tolerance, beside the largest stretch.
    pub fn noise(&self) -> f64 {
        self.tolerance * self.stretch
    }

    /// What is left unknown of a multiplier, as a part of it: that of changes which are far smaller than the largest of a piece, and, of two that may
    /// be one, how far apart they are.
    fn unsure(&self, polar: &Polar) -> f64 {
        if polar.log == f64::NEG_INFINITY {
            return 0.0;
        }
        let piece = self.noise() / (polar.log / self.pieces as f64).exp().min(self.stretch);
        let may_be_one = COMES_APART * (self.pieces as f64 * piece).sqrt();
        let gaps = self.multipliers.iter().map(|other| apart(polar, other)).filter(|gap| *gap <= may_be_one);
        gaps.fold(piece, f64::max)
    }

    /// What is left unknown of a product of the differences of all multipliers from a value on the unit circle, each in parts of the larger.
    pub fn least_product(&self) -> f64 {
        self.multipliers.iter().map(|polar| self.unsure(polar) * polar.log.min(0.0).exp()).fold(0.0, f64::max)
    }

    /// Multipliers with what is left unknown of them; beside finer ones also with how far they are from these.
    pub fn with_errors(&self, finer: Option<&Spectrum>) -> Vec<Multiplier> {
        let nearest = |polar: &Polar| {
            let found = |finer: &Spectrum| {
                finer.multipliers.iter().map(|other| apart(polar, other)).fold(f64::INFINITY, f64::min)
            };
            TOLD * finer.map_or(0.0, found)
        };
        let of = |polar: &Polar| Multiplier::of(polar.log, polar.angle, nearest(polar).max(self.unsure(polar)));
        self.multipliers.iter().map(of).collect()
    }
}

/// What is known at the start of a piece, in units of the scales.
struct Place {
    tangent: DMatrix<f64>,
    gradients: Vec<Known>,
    generators: Vec<Known>,
}

impl Place {
    /// At the start of a piece, of a mechanism that conserves momenta along some of its shifts.
    fn of(
        laps: &mut Laps,
        piece: &Leg,
        shifts: &[(String, DVector<f64>)],
        conserved: &[(String, DVector<f64>)],
    ) -> Place {
        let width = 2 * laps.n();
        put(&mut *laps.system, &piece.start);
        let gradients = structure::gradients(&*laps.system, &piece.start, &laps.varies, conserved);
        let known = (piece.start_rate.as_slice(), gradients.as_slice());
        let mut generators = structure::generators(&*laps.system, &piece.start, known, shifts);
        if matches!(laps.time, Time::Driven) {
            generators.remove(0);
        }
        let scaled = |known: Known, inverse: bool| {
            let each = known.direction.iter().zip(&laps.scales);
            let direction = each.map(|(x, scale)| if inverse { x * scale } else { x / scale });
            Known { direction: DVector::from_iterator(width, direction), ..known }
        };
        let columns: Vec<DVector<f64>> = piece
            .projection
            .iter()
            .zip(&laps.scales)
            .map(|(column, size)| {
                let parts = column.iter().zip(&laps.scales).map(|(x, scale)| x * size / scale);
                DVector::from_iterator(width, parts)
            })
            .collect();
        Place {
            tangent: structure::basis_within(&alike(columns), width, structure::CONTAINED),
            gradients: gradients.into_iter().map(|known| scaled(known, true)).collect(),
            generators: generators.into_iter().map(|known| scaled(known, false)).collect(),
        }
    }

    /// A gradient or a generator of this number.
    fn known(&self, gradient: bool, name: usize) -> &Known {
        if gradient { &self.gradients[name] } else { &self.generators[name] }
    }

    /// An orthonormal basis of all directions but those of these gradients and generators.
    fn others(&self, gradients: &[usize], generators: &[usize]) -> DMatrix<f64> {
        let width = self.tangent.nrows();
        let of = |list: &[Known], names: &[usize]| -> Vec<DVector<f64>> {
            names.iter().map(|name| list[*name].direction.clone()).collect()
        };
        let left: Vec<DVector<f64>> = of(&self.gradients, gradients)
            .into_iter()
            .map(|direction| &self.tangent * (self.tangent.transpose() * direction))
            .collect();
        let left = structure::basis(&left, width);
        let right = structure::basis(&of(&self.generators, generators), width);
        let within = structure::complement(&self.tangent, &left);
        let inside = structure::complement(&right, &left);
        structure::complement(&within, &inside)
    }
}

/// The multipliers of all laps together.
pub(super) fn spectrum(laps: &mut Laps, trial: &Trial) -> Spectrum {
    let count = trial.pieces.len();
    let shifts = {
        let sides: Vec<_> = trial.pieces.iter().map(|piece| piece.start.clone()).collect();
        structure::shifts(&*laps.system, &sides)
    };
    // A momentum along an edge that turns is conserved where the motion starts, and nowhere else.
    let mut conserved = shifts.clone();
    for piece in &trial.pieces {
        put(&mut *laps.system, &piece.start);
        conserved = structure::conserving(&*laps.system, &piece.start, &laps.varies, conserved);
    }
    let places: Vec<Place> = trial.pieces.iter().map(|piece| Place::of(laps, piece, &shifts, &conserved)).collect();
    let maps: Vec<DMatrix<f64>> = (0..count).map(|k| map(laps, trial, k)).collect();
    let ended = matches!(laps.closing.by, By::After { .. });
    let tolerance = laps.settings.tolerance;
    // Directions are those of the next start, which the end of a piece misses by what is left of r.
    let off = tolerance + trial.r.norm();
    let unknown: Vec<f64> = trial.pieces.iter().zip(&maps).map(|(piece, map)| off * magnified(piece, map)).collect();
    let held = |gradient: bool, name: &usize| is_held(&places, &maps, (gradient, *name), (ended, &unknown));
    let gradients: Vec<usize> = (0..places[0].gradients.len()).filter(|name| held(true, name)).collect();
    let generators: Vec<usize> = (0..places[0].generators.len()).filter(|name| held(false, name)).collect();
    let mut bases: Vec<DMatrix<f64>> = places.iter().map(|place| place.others(&gradients, &generators)).collect();
    let known = names(&places[0], &gradients, &generators);
    let factors = factors(&maps, &bases);
    let stretches: Vec<f64> = maps.iter().map(|map| stretches(map).map_or(map.norm(), |found| found.max())).collect();
    let spread = stretches.iter().zip(&factors).map(|(most, factor)| most / least(factor)).fold(1.0, f64::max);
    let stretch = stretches.into_iter().fold(0.0, f64::max);
    let Dimensions { start, most, least } = dimensions(laps, trial);
    let zero = Polar { log: f64::NEG_INFINITY, angle: 0.0 };
    let mut multipliers = multipliers(&factors);
    multipliers.iter_mut().rev().take(start - least).for_each(|multiplier| *multiplier = zero);
    multipliers.extend(std::iter::repeat_n(zero, most - start));
    let lost = most - least;
    let generators = places.into_iter().map(|place| place.generators).collect();
    let basis = bases.swap_remove(0);
    Spectrum { multipliers, known, lost, generators, basis, spread, stretch, tolerance, pieces: count }
}

/// Whether the map of every piece takes a gradient or a generator to that of the next one, or, where an event ends the motion, takes a
/// generator to next to nothing.  By how much each map is off is told.
fn is_held(
    places: &[Place],
    maps: &[DMatrix<f64>],
    (gradient, name): (bool, usize),
    (ended, unknown): (bool, &[f64]),
) -> bool {
    let inside = |known: &Known, basis: &DMatrix<f64>| Known {
        name: known.name.clone(),
        direction: basis.transpose() * &known.direction,
    };
    (0..places.len()).all(|k| {
        let (place, next) = (&places[k], &places[(k + 1) % places.len()]);
        let before = inside(place.known(gradient, name), &place.tangent);
        let behind = inside(next.known(gradient, name), &next.tangent);
        let map = next.tangent.transpose() * &maps[k] * &place.tangent;
        structure::holds(&map, (&before, &behind), gradient, unknown[k])
            || !gradient && ended && (&map * &before.direction).norm() <= LEAVES * map.norm() * before.direction.norm()
    })
}

/// By how much the map of a piece magnifies errors of the motion: as changes, and where an event is crossed once more, since its slopes grow as fast
/// as the speed v of the crossing goes to 0, like 1/v.
fn magnified(piece: &Leg, map: &DMatrix<f64>) -> f64 {
    let size = map.norm();
    if piece.run.junctions.is_empty() { size } else { size * size.max(1.0) }
}

/// The same with 1 as the largest length: what is none but for rounding stays so.
fn alike(columns: Vec<DVector<f64>>) -> Vec<DVector<f64>> {
    let most = columns.iter().map(|column| column.norm()).fold(0.0, f64::max);
    columns.into_iter().map(|column| if most > 0.0 { column / most } else { column }).collect()
}

/// The least stretch of those directions whose multipliers are wanted.
fn least(factor: &DMatrix<f64>) -> f64 {
    if factor.is_empty() { f64::INFINITY } else { stretches(factor).map_or(0.0, |found| found.min()) }
}

/// Singular values.
fn stretches(map: &DMatrix<f64>) -> Option<DVector<f64>> {
    Some(svd(map.clone(), false, false)?.singular_values)
}

/// The maps in bases; as one where the dimensions differ on the way.
fn factors(maps: &[DMatrix<f64>], bases: &[DMatrix<f64>]) -> Vec<DMatrix<f64>> {
    let count = maps.len();
    if bases.iter().all(|basis| basis.ncols() == bases[0].ncols()) {
        return (0..count).map(|k| bases[(k + 1) % count].transpose() * &maps[k] * &bases[k]).collect();
    }
    let product = maps.iter().fold(DMatrix::identity(bases[0].nrows(), bases[0].nrows()), |all, map| map * all);
    vec![bases[0].transpose() * product * &bases[0]]
}

/// What a piece makes of changes of its start, in units of the scales.
pub(super) fn map(laps: &Laps, trial: &Trial, k: usize) -> DMatrix<f64> {
    let width = 2 * laps.n();
    let piece = &trial.pieces[k];
    let closes = laps.closes(k);
    let column = |c: usize| {
        let column = &piece.columns[c];
        let column = if closes { laps.closing.turned(column) } else { column.clone() };
        DVector::from_iterator(width, column.iter().zip(&laps.scales).map(|(x, scale)| x * laps.scales[c] / scale))
    };
    DMatrix::from_columns(&(0..width).map(column).collect::<Vec<_>>())
}

/// Names of directions that are known, each once.
fn names(place: &Place, gradients: &[usize], generators: &[usize]) -> Vec<String> {
    let width = place.tangent.nrows();
    let mut list = Vec::new();
    for (all, chosen, generated) in [(&place.gradients, gradients, false), (&place.generators, generators, true)] {
        let mut directions: Vec<DVector<f64>> = Vec::new();
        for known in chosen.iter().map(|k| &all[*k]) {
            let before = structure::basis(&directions, width).ncols();
            directions.push(known.direction.clone());
            if structure::basis(&directions, width).ncols() > before {
                list.push(if generated { structure::motion_name(&known.name) } else { known.name.clone() });
            }
        }
    }
    list
}

/// How many numbers of a state are free where a motion starts, and where it has most and least of them.
struct Dimensions {
    start: usize,
    most: usize,
    least: usize,
}

fn dimensions(laps: &Laps, trial: &Trial) -> Dimensions {
    let description = laps.system.description();
    let all = 2 * laps.n();
    let free = |phase: usize| {
        let Some(phase) = description.phases.get(phase) else { return all };
        let rows = phase.rows.iter().map(|row| 1 + usize::from(description.rows[*row as usize].holonomic));
        all.saturating_sub(rows.sum())
    };
    let visited = trial.pieces.iter().flat_map(|piece| {
        let behind = piece.run.junctions.iter().map(|junction| junction.after.phase);
        std::iter::once(piece.start.phase).chain(behind)
    });
    let visited: Vec<usize> = visited.map(free).collect();
    let start = visited.first().copied().unwrap_or(all);
    let extreme = |best: fn(usize, usize) -> usize| visited.iter().copied().fold(start, best);
    Dimensions { start, most: extreme(usize::max), least: extreme(usize::min) }
}

/// How far two multipliers are apart, in parts of them.
fn apart(a: &Polar, b: &Polar) -> f64 {
    if a.log == f64::NEG_INFINITY && b.log == f64::NEG_INFINITY {
        return 0.0;
    }
    (a.log - b.log).hypot(turn(a.angle - b.angle))
}

/// An angle from −π to π.
fn turn(angle: f64) -> f64 {
    let turned = angle.rem_euclid(std::f64::consts::TAU);
    if turned > std::f64::consts::PI { turned - std::f64::consts::TAU } else { turned }
}
