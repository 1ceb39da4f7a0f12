//! Motions that repeat, as a parameter or their energy varies.

use super::acting;
use super::found::{Multiplier, Orbit, map_in_words};
use super::search::{OrbitSearch, with_returns};
use super::structure;
use super::walk::{Node, Varied, Walk};
use crate::error::{Error, NoOrbit};
use crate::mechanism::System;

/// The golden section, the least simple fraction.
pub(super) const BETWEEN: f64 = 0.618_033_988_749_894_8;

/// Motions that repeat, in the order of a walk along them, and where their stability changes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Family {
    /// What varies.
    pub name: String,
    /// Names of [q; q'].
    pub names: Vec<String>,
    /// The motions, those at thresholds among them.
    pub members: Vec<Member>,
    /// Where a multiplier crosses the unit circle, or the family turns back.
    pub thresholds: Vec<Threshold>,
    /// Where amplitudes of driven motions are greatest.
    pub peaks: Vec<Peak>,
    /// The smallest map that closes them is that of this part of the period.
    pub part: usize,
    /// What that map exchanges, mirrors and shifts.
    pub map: String,
    /// Why the walk ended before it was where it was to go.
    pub ended: Option<String>,
    /// Whether it was broken off from outside.
    pub interrupted: bool,
}

/// A motion of a family.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Member {
    /// What varies.
    pub value: f64,
    /// s.
    pub period: f64,
    /// [q; q'] at the start.
    pub start: Vec<f64>,
    /// How far each of [q; q'] goes from its middle.
    pub amplitudes: Vec<f64>,
    /// Multipliers of the map, with what the largest stretch of a piece leaves unknown of them as their errors: no more accurate flow is made.
    pub multipliers: Vec<Multiplier>,
    /// Whether it was asked for, or only passed.
    pub asked: bool,
}

/// Where a family changes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Threshold {
    /// What happens.
    pub kind: OrbitChange,
    /// The value at which it does, and its error.
    pub value: f64,
    /// Twice the difference that more accurate flows make.
    pub error: f64,
    /// The motion there.
    pub member: Member,
}

/// Where a coordinate goes farther than in all motions near by.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Peak {
    /// The coordinate.
    pub of: String,
    /// The value at which it does, and its error.
    pub value: f64,
    /// Twice the difference that more accurate flows make.
    pub error: f64,
    /// How far it goes from its middle.
    pub amplitude: f64,
    /// The motion there.
    pub member: Member,
}

/// What happens to motions of a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum OrbitChange {
    /// The family turns back: a multiplier is 1.
    Fold,
    /// A multiplier passes 1: another family crosses.
    Branch,
    /// A multiplier passes −1: a family of motions of two laps branches off.
    Doubling,
    /// A multiplier of a map that mirrors or exchanges, twice which is nothing but a part of the period, passes −1: a family of motions without that
    /// symmetry branches off, and the period stays.
    SymmetryBreaking,
    /// A pair of multipliers leaves the unit circle elsewhere: from here on motions go round a torus.
    Pair,
}
impl OrbitChange {
    /// A word for it.
    pub fn word(self) -> &'static str {
        match self {
            OrbitChange::Fold => "fold",
            OrbitChange::Branch => "branch",
            OrbitChange::Doubling => "doubling",
            OrbitChange::SymmetryBreaking => "symmetry",
            OrbitChange::Pair => "pair",
        }
    }
}
impl Family {
    /// The smallest map that closes its motions, in words.
    pub fn map_in_words(&self) -> String {
        map_in_words(self.part, &self.map)
    }
}

impl OrbitSearch {
    /// Follows the family of motions that repeat, beginning with the one that is found where what varies has its first value: a parameter, or
    /// `energy` (counted from the equilibrium where the search begins from a mode), whose first value is that of the motion found.  Each of
    /// `values` is met on the way; thresholds are refined.  Where a parameter varies and the energy is conserved, all motions have that of the first.
    ///
    /// With `branch` the family is followed that leaves the first one at its threshold of this number, the first being 1.
    ///
    /// # Errors
    /// As [`OrbitSearch::find`]; a motion that belongs to no family.
    pub fn vary(self, name: &str, values: &[f64], branch: Option<usize>) -> Result<Family, Error> {
        let (mut walk, start) = self.walk(name, values)?;
        let (family, thresholds) = walk.both_ways(start, name, values)?;
        let Some(number) = branch.filter(|_| !family.interrupted) else { return Ok(family) };
        match number.checked_sub(1).and_then(|k| thresholds.get(k)) {
            Some((node, kind)) => {
                let start = walk.switch(node, *kind)?;
                Ok(walk.along(start, name, values).0)
            }
            None => Err(NoOrbit::NoThreshold { number, known: thresholds.len() }.into()),
        }
    }

    /// The motion of an energy, counted from the equilibrium, on the family that begins with small motions of a mode.
    pub(super) fn along_energies(self, energy: f64) -> Result<Orbit, Error> {
        let (mut walk, start) = self.walk(structure::ENERGY, &[energy])?;
        let node = walk.to(start, energy)?;
        let Walk { mut begun, .. } = walk;
        begun.laps.scales = node.scales;
        begun.laps.energy = Some(energy + begun.rest_energy);
        #[cfg(feature = "interpret")]
        begun.extended.iter_mut().for_each(|wanted| wanted.energy = Some(energy));
        begun.finish(node.solution)
    }

    /// A walk along a family that begins with the motion that is found where what varies has the first of some values.
    fn walk(mut self, name: &str, values: &[f64]) -> Result<(Walk, Node), Error> {
        let Some(first) = values.first().copied() else {
            return Err(NoOrbit::NoFamily { name: name.to_owned() }.into());
        };
        let varied = match &mut self.described {
            Ok((system, ..)) => varied(&mut **system, name, first)?,
            Err(_) => Varied::Energy,
        };
        if let Varied::Parameter(k) = varied {
            self.varies = vec![k];
        }
        let scene = self.scene();
        let mut begun = self.begin()?;
        if let Varied::Parameter(k) = varied {
            if !acting::parameter_acts(&*begun.laps.system, k, &begun.point.starts[0]) {
                return Err(NoOrbit::NoEffect { name: name.to_owned() }.into());
            }
            begun.elsewhere = sampled(values).map(|value| vec![(k, value)]).collect();
            begun.closes_elsewhere()?;
        }
        // The motion itself, by the smallest map that closes it and others.
        let found = begun.first().and_then(|solution| begun.smallest(solution));
        let (solution, spectrum) = found.map_err(|error| with_returns(error, scene))?;
        let mut point = solution.point.clone();
        match varied {
            Varied::Parameter(k) => {
                (begun.laps.parameter, point.parameter) = (Some(k), first);
                let size = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
                let passes_zero = values.iter().any(|value| value * first <= 0.0);
                begun.laps.parameter_size = if passes_zero { size } else { 0.0 };
                begun.hold_energy(&solution, &spectrum);
            }
            Varied::Energy if begun.laps.keeps_energy() => begun.laps.energy = None,
            Varied::Energy => return Err(NoOrbit::NoEnergy.into()),
        }
        let mut walk = Walk { begun, varied, nullity: None, aside: 0, largest: Vec::new() };
        let start = walk.node(point, None)?;
        walk.nullity = Some(start.solution.linear.free().len());
        Ok((walk, start))
    }
}

/// Values of a range with which symmetries are asked for: those that are given, and one between the ends that is no simple fraction, since
/// symmetries hold everywhere or in places.
pub(super) fn sampled(values: &[f64]) -> impl Iterator<Item = f64> + '_ {
    let between = values.first().zip(values.last()).map(|(first, last)| first + BETWEEN * (last - first));
    values.iter().copied().chain(between)
}

/// What varies, with its first value.
///
/// # Errors
/// [`Error::UnknownName`].
fn varied(system: &mut dyn System, name: &str, first: f64) -> Result<Varied, Error> {
    let parameters = &system.description().parameters;
    if let Some(k) = parameters.iter().position(|parameter| parameter.name == name) {
        system.set_parameter(k, first);
        return Ok(Varied::Parameter(k));
    }
    if name == structure::ENERGY {
        return Ok(Varied::Energy);
    }
    let known = parameters.iter().map(|parameter| &*parameter.name).chain([structure::ENERGY]);
    Err(Error::unknown("parameter", name, known))
}
