//! Where the answer of what is driven is greatest along a family.
//!
//! A coordinate's amplitude is half the way between its largest and its smallest value.  These are where its rate is 0, so that a member beside moves
//! them by what it makes of the coordinate there, whenever that is: the slope of the amplitude along the family comes from the slopes of the
//! motion, and a peak is where it passes 0.

use super::closing::{By, Closing};
use super::drive::Drive;
use super::family::Peak;
use super::laps::{Time, parameter_scale};
use super::walk::{Node, Walk};
use crate::error::Error;
use crate::events::{Around, locate};
use crate::mechanism::System;
use crate::simulate::Settings;
use crate::vary::leg;

/// A coordinate that goes this part of its scale, or less, rests.
const RESTS: f64 = 1e-6;
/// States that differ by this part of an amplitude are as far out as the farthest one: reported states are not the extreme ones.
const FARTHEST: f64 = 1e-2;
/// To this part of the time between two reported states the time of an extreme value is located: the value changes with its square there.
const SAME: f64 = 1e-12;

/// The extreme value of a coordinate, or of its image, along a motion.
#[derive(Clone, Copy)]
struct Extreme {
    value: f64,
    /// The piece in which it is, and when, s.
    piece: usize,
    t: f64,
    /// The coordinate that has it there, and its sign in it.
    coordinate: usize,
    sign: f64,
}

/// What measures amplitudes of members.
struct Meter {
    system: Box<dyn System>,
    settings: Settings,
    closing: Closing,
    drive: Drive,
    legs: usize,
    parameter: usize,
    parameter_size: f64,
}

impl Meter {
    /// Of a family of driven motions by a parameter.
    fn of(walk: &Walk) -> Option<Meter> {
        let laps = &walk.begun.laps;
        let parameter = laps.parameter.filter(|_| laps.time == Time::Driven)?;
        Some(Meter {
            system: laps.system.boxed_clone(),
            settings: laps.settings.clone(),
            closing: laps.closing.clone(),
            drive: laps.drive,
            legs: laps.legs,
            parameter,
            parameter_size: laps.parameter_size,
        })
    }

    /// The coordinates that come back.
    fn coordinates(&self) -> Vec<usize> {
        let Closing { shifts, turns, images, .. } = &self.closing;
        (0..images.len()).filter(|i| !shifts.contains(i) && turns[*i] == 0.0).collect()
    }

    /// Which coordinate, with which sign, a coordinate is in each lap.
    fn images(&self, i: usize) -> Vec<(usize, f64)> {
        let next = |(k, sign): (usize, f64)| {
            let (image, opposite) = self.closing.images[k];
            (image, if opposite { -sign } else { sign })
        };
        std::iter::successors(Some((i, 1.0)), |image| Some(next(*image))).take(self.closing.order()).collect()
    }

    /// The largest value of a coordinate times a sign.
    fn extreme(&self, node: &Node, i: usize, side: f64) -> Option<Extreme> {
        let (pieces, width) = (&node.solution.trial.pieces, node.scales.len());
        let images = self.images(i);
        let all = || (0..pieces.len()).flat_map(|piece| images.iter().map(move |image| (piece, *image)));
        let values = |piece: usize, (k, sign): (usize, f64)| {
            pieces[piece]
                .run
                .rows
                .chunks_exact(width)
                .map(move |row| [row[k], row[width / 2 + k]].map(|x| side * sign * x))
        };
        let reported = all().flat_map(|(piece, image)| values(piece, image)).map(|[x, _]| x);
        let [low, high] = reported.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)]);
        let near = high - FARTHEST * (high - low);
        let mut best: Option<Extreme> = None;
        for (piece, image) in all() {
            let states: Vec<[f64; 2]> = values(piece, image).collect();
            for (j, pair) in states.windows(2).enumerate() {
                let [[x, v], [later, after]] = [pair[0], pair[1]];
                if x.max(later) < near || !(v >= 0.0 && after <= 0.0 && v > after) {
                    continue;
                }
                let found = self.turn(node, (piece, image), (j, side));
                best = found.into_iter().chain(best).max_by(|a, b| a.value.total_cmp(&b.value));
            }
        }
        best
    }

    /// Where the rate of a coordinate passes 0 between two reported states.
    fn turn(&self, node: &Node, (piece, (k, sign)): (usize, (usize, f64)), (j, side): (usize, f64)) -> Option<Extreme> {
        let run = &node.solution.trial.pieces[piece].run;
        let rate = |t: f64| run.at(t).map_or(f64::NAN, |state| side * sign * state.v[k]);
        let [a, b] = [run.times[j], run.times[j + 1]];
        let resolution = SAME * (b - a);
        let (t, _) = locate(rate, (a, rate(a)), (b, rate(b)), Around { resolution, ..Around::bracket(a, b) });
        let value = side * sign * run.at(t)?.q[k];
        Some(Extreme { value, piece, t, coordinate: k, sign: side * sign })
    }

    /// How an extreme value moves along the family, by the arc.
    fn moved(&self, node: &Node, extreme: &Extreme) -> Option<f64> {
        let (point, width) = (&node.solution.point, node.scales.len());
        let piece = &node.solution.trial.pieces[extreme.piece];
        let mut system = self.system.boxed_clone();
        system.set_parameter(self.parameter, point.parameter);
        let By::Part(part) = self.closing.by else { return None };
        let lap_slope = self.drive.slope(&*system, self.parameter).ok()? / part as f64;
        let (q, v) = point.starts[extreme.piece].split_at(width / 2);
        let (phase, from) = (piece.start.phase, piece.start.t);
        let known = self.settings.clone();
        let settings = Settings { q: q.to_vec(), v: v.to_vec(), phase, from, until: extreme.t, ..known };
        let columns = match extreme.t > from {
            true => leg(&mut *system, &settings, &[self.parameter]).ok()?.columns,
            false => piece.projection.iter().cloned().chain([vec![0.0; width]]).collect(),
        };
        let by = |column: usize| columns[column][extreme.coordinate];
        let varies = node.tangent[node.tangent.len() - 1] * parameter_scale(point, self.parameter_size);
        // A piece that begins later has its start later.
        let later = extreme.piece as f64 / self.legs as f64 * lap_slope * varies;
        let start = |c: usize| node.tangent[extreme.piece * width + c] * node.scales[c] - later * piece.start_rate[c];
        let moved = (0..width).map(|c| by(c) * start(c)).sum::<f64>() + by(width) * varies;
        Some(extreme.sign * moved)
    }

    /// The amplitude of a coordinate, and its slope along the family; none of one that rests, or turns in no smooth way.
    fn amplitude(&self, node: &Node, i: usize) -> Option<[f64; 2]> {
        let [top, bottom] = [1.0, -1.0].map(|side| self.extreme(node, i, side));
        let (top, bottom) = (top?, bottom?);
        let amplitude = 0.5 * (top.value + bottom.value);
        if amplitude <= RESTS * node.scales[i] {
            return None;
        }
        Some([amplitude, 0.5 * (self.moved(node, &top)? + self.moved(node, &bottom)?)])
    }

    fn slope(&self, node: &Node, i: usize) -> f64 {
        self.amplitude(node, i).map_or(f64::NAN, |[_, slope]| slope)
    }
}

impl Walk {
    /// The peaks between two members that are `h` apart.
    ///
    /// # Errors
    /// Those of members.
    pub fn peaks(&mut self, from: &Node, to: &Node, h: f64) -> Result<Vec<Peak>, Error> {
        let Some(meter) = Meter::of(self) else { return Ok(Vec::new()) };
        let mut peaks = Vec::new();
        for i in meter.coordinates() {
            let slope = |node: &Node| meter.slope(node, i);
            if !(slope(from) > 0.0 && slope(to) <= 0.0) {
                continue;
            }
            let found = self.locate(from, (h, to), &slope)?;
            let Some([amplitude, left]) = meter.amplitude(&found, i) else { continue };
            let finer = self.finer(&found);
            let before = self.begun.laps.refine(&found.solution.trial);
            let other = Meter::of(self);
            self.begun.laps.settings = before;
            let there = finer.as_ref().ok().and_then(|finer| Some(other?.slope(finer, i)));
            let changes = there.map_or(f64::NAN, |there| (there - left).abs());
            let along = (left - slope(from)) / (found.value - from.value);
            // What is left of the slope is noise of changes.
            let least = found.spectrum.noise() * found.scales[i];
            let error = Walk::off((from, &found, finer), (changes + left.abs().max(least)) / along.abs());
            let of = self.begun.laps.system.description().coordinates[i].name.to_string();
            peaks.push(Peak { of, value: found.value, error, amplitude, member: self.member(&found, false) });
        }
        Ok(peaks)
    }
}
