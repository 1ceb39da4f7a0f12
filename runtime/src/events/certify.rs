//! A function along a step, looked at until nothing can hide between the points.

use super::root::{Around, Nature, locate, nature_of_zero};

/// A point of a function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Sample {
    /// Where.
    pub x: f64,
    /// g.
    pub value: f64,
    /// dg/dx; not a number where it is not known.
    pub slope: f64,
}

/// What a function does at a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ZeroKind {
    /// It passes through zero.
    Crosses {
        /// True when it goes from below to above.
        rising: bool,
    },
    /// It comes to zero, as far as its rounding tells, and turns back.
    Touches,
    /// It changes its sign by a jump.
    Jumps,
    /// It changes its sign through a pole.
    Pole,
    /// It ceases or begins to be a number.
    Undefined,
}

/// Something that a function does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Zero {
    /// Where.
    pub x: f64,
    /// What.
    pub kind: ZeroKind,
}

/// More samples than the limit within one step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct TooMany;

/// Certifies functions piece by piece.
///
/// A piece [a, b] with midpoint m is consistent if value and slope at m are those of the cubic Hermite interpolant of
/// its ends, to a twentieth of the variation r that was *observed* (to excuse a deviation by the slopes would excuse
/// the very oscillations that are looked for); its halves are then known 16 times better than was tested.  Any other
/// piece is halved.  In consistent pieces a pair of zeros hides only near a critical point of the halves' cubics that
/// comes within 0.3 r of zero: there the extremum, a root of the slope, is looked at.  Where r is larger than what is wanted near
/// zero ([`Certifier::fine`]) pieces that come near zero are halved as well: a twentieth of r may hide all that matters.
///
/// What rounding makes of zero is measured by values that are large all around, as terms that cancel are; those beside a
/// pole are large to one side only.  Of a piece this is the second largest of the values at its ends and in its middle, or
/// the lesser of the largest ones to its left and to its right: of the points to begin with, and of the pieces that it is
/// part of.
///
/// An oscillation that keeps step with the halving is not seen by this: pieces must begin short enough for the
/// phases inside the function, see [`PHASE`].
#[derive(Clone, Debug)]
pub(crate) struct Certifier {
    /// Pieces to look at, the first one last.
    stack: Vec<Piece>,
    /// Points between which the function has no more extrema that matter, in order.
    points: Vec<Sample>,
    /// Zeros and the like, in order.
    pub marks: Vec<Zero>,
    /// Samples so far.
    pub samples: u64,
    /// The largest size of the function, poles left aside: the second largest at the ends and in the middle of some piece.
    pub size: f64,
    /// What the rounding of the state may change of the values: less is zero, and no jump.
    pub rounding: f64,
    /// Points this close to each other are the same, for places are rounded before the function sees them, as θ is in t + θh.
    pub resolution: f64,
    /// Whether every extremum is wanted, not only those that might hide zeros.
    pub extrema: bool,
    /// Near zero the function is wanted to this; infinite where its own variation says how closely.
    pub fine: f64,
    /// Whether more samples may be taken for each piece that there is to begin with.
    pub patient: bool,
    /// So many samples may be taken, and some for each piece.
    most: u64,
}

/// A piece of a function.
#[derive(Clone, Copy, Debug)]
struct Piece {
    a: Sample,
    b: Sample,
    /// How often it was halved.
    depth: u32,
    /// The largest sizes at its left end and before, and at its right end and behind.
    sides: (f64, f64),
}

/// 8 unit round-offs.
const NOISE: f64 = 4.0 * f64::EPSILON;
/// Radians by which the argument of a sine or cosine may change within a first piece.
pub(crate) const PHASE: f64 = 2.0;
/// Samples of one function within one step.
pub(super) const MOST_SAMPLES: u64 = 100_000;

/// Deviation from the cubic that is allowed, in parts of the observed variation.
const CONSISTENT: f64 = 0.05;
/// A critical value this near to zero, in parts of the observed variation, is looked at.
const NEAR: f64 = 0.3;
/// From here on a piece whose values vary more than its slopes explain is a jump or noise.
const UNEXPLAINED: u32 = 6;
/// From here on an inconsistent piece that stays away from zero is left alone.
const AWAY: u32 = 8;
/// From here on a flat piece is left alone whose values agree but whose slopes do not: those of a step of order 1, whose speeds
/// are not the rates of its places, agree with no extremum however short the piece.
const FLAT: u32 = 4;
/// A value larger than those beside it by this is at a pole.
const POLE: f64 = 1e8;
/// Where a value is tested for being more than rounding, in parts of the distance at which the function varies by as much: on both sides, and
/// such that no two are alike to rounding.
const AROUND: [f64; 6] = [-0.9, -0.55, -0.3, 0.35, 0.6, 0.95];
/// A distance of so many of the finest there are is resolved.
const MANY: f64 = 64.0;
/// Room for the points of an ordinary search.
const ROOM: usize = 256;
/// So many samples beyond four a piece are taken before it is asked whether a function is rounding: as many points as there is [`ROOM`] for.  What
/// needs more is looked at twice, which costs no more than these.
const FIRST_LOOK: u64 = 256;
/// Pieces are not halved more often.
const DEEPEST: u32 = 50;

impl Default for Certifier {
    fn default() -> Self {
        Certifier {
            stack: Vec::new(),
            points: Vec::new(),
            marks: Vec::new(),
            samples: 0,
            size: 0.0,
            rounding: 0.0,
            resolution: 0.0,
            extrema: false,
            fine: f64::INFINITY,
            patient: false,
            most: MOST_SAMPLES,
        }
    }
}

impl Certifier {
    /// Whether few samples certify a function as if it had no rounding, and show neither jumps nor poles: else it is certified again with the rounding
    /// that it has. What constraints keep at zero is rounding all along, which no division makes smooth; within a very
    /// short step rounding looks like a jump.
    pub fn settles(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), grid: &[Sample]) -> bool {
        (self.rounding, self.resolution, self.most) = (0.0, 0.0, FIRST_LOOK);
        let settled = self.certify(f, grid).is_ok();
        self.most = MOST_SAMPLES;
        settled && !self.marks.iter().any(|mark| matches!(mark.kind, ZeroKind::Jumps | ZeroKind::Pole))
    }

    /// Finds what a function does between the first and the last of these samples of it.
    ///
    /// # Errors
    /// [`TooMany`] samples: the function oscillates too fast.
    pub fn certify(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), grid: &[Sample]) -> Result<(), TooMany> {
        let [first, .., last] = grid else { return Ok(()) };
        self.size = 0.0;
        self.marks.clear();
        self.points.clear();
        self.points.reserve(ROOM);
        self.points.push(*first);
        let pieces = if self.patient { 20 } else { 4 } * grid.len() as u64;
        let limit = self.samples + self.most + pieces;
        self.stack.clear();
        let value = |k: usize| grid.get(k).map_or(0.0, |sample| larger(0.0, sample.value));
        let size = |k: usize| tamed(value(k), value(k + 1).max(if k > 0 { value(k - 1) } else { 0.0 }));
        let mut right = 0.0_f64;
        for (k, pair) in grid.windows(2).enumerate().rev() {
            right = right.max(size(k + 1));
            self.stack.push(Piece { a: pair[0], b: pair[1], depth: 0, sides: (0.0, right) });
        }
        let mut left = 0.0_f64;
        for (k, piece) in self.stack.iter_mut().rev().enumerate() {
            left = left.max(size(k));
            piece.sides.0 = left;
        }
        while let Some(piece) = self.stack.pop() {
            if self.samples > limit {
                return Err(TooMany);
            }
            self.piece(f, piece);
        }
        debug_assert_eq!(self.points.last().map(|p| p.x), Some(last.x));
        self.walk(f);
        Ok(())
    }

    /// The points that certify the function, in order; after [`Certifier::certify`].
    pub fn points(&self) -> &[Sample] {
        &self.points
    }

    /// Settles a piece, or halves it.
    fn piece(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), piece: Piece) {
        let Piece { a, b, depth, .. } = piece;
        let length = b.x - a.x;
        let x = a.x + 0.5 * length;
        if depth >= DEEPEST || length <= self.finest(a.x, b.x) || !(x > a.x && x < b.x) {
            self.points.push(b);
            return;
        }
        let m = self.sample(f, x);
        let own = second_largest([a, m, b].map(|sample| sample.value));
        if depth == 0 {
            self.size = self.size.max(own);
        }
        let end = |value: f64| tamed(larger(0.0, value), own);
        let sides = (piece.sides.0.max(end(a.value)), piece.sides.1.max(end(b.value)));
        let blur = self.resolution * second_largest([a, m, b].map(|sample| sample.slope));
        let noise = (NOISE * own.max(sides.0.min(sides.1))).max(self.rounding).max(blur);
        let piece = Piece { sides, ..piece };
        match (a.value.is_finite(), m.value.is_finite(), b.value.is_finite()) {
            (true, true, true) => {}
            // Nothing is known of a piece in which the function is nowhere seen to be defined.
            (false, false, false) => {
                self.points.extend([m, b]);
                return;
            }
            _ => return self.halve(m, piece),
        }
        let r = (b.value - a.value).abs().max((m.value - a.value).abs()).max((m.value - b.value).abs());
        let value = 0.5 * (a.value + b.value) + 0.125 * length * (a.slope - b.slope);
        let slope = 1.5 * (b.value - a.value) / length - 0.25 * (a.slope + b.slope);
        let near = |off: f64, noise: f64| off.abs() <= CONSISTENT * r + noise;
        let least = a.value.abs().min(b.value.abs()).min(m.value.abs());
        let coarse = r > self.fine && least <= NEAR * r;
        let agrees = near(m.value - value, noise);
        if !coarse && agrees && near(0.25 * length * (m.slope - slope), 4.0 * noise) {
            self.half(f, a, m, (r, noise));
            self.half(f, m, b, (r, noise));
            return;
        }
        let steepest = a.slope.abs().max(b.slope.abs()).max(m.slope.abs());
        let one_side = (a.value > 0.0) == (m.value > 0.0) && (m.value > 0.0) == (b.value > 0.0);
        let blind = ![a, m, b].iter().any(|sample| sample.slope.is_finite());
        let unexplained = blind || depth >= UNEXPLAINED && r > 4.0 * length * steepest;
        let far = one_side && least > 4.0 * r;
        let flat = depth >= FLAT && agrees && length * steepest < 0.01 * least;
        if unexplained || far && (flat || depth >= AWAY && !self.extrema) {
            self.points.extend([m, b]);
            return;
        }
        self.halve(m, piece);
    }

    /// Pieces from a to b this long are not divided.
    fn finest(&self, a: f64, b: f64) -> f64 {
        2.0 * self.resolution.max(f64::EPSILON * a.abs().max(b.abs()))
    }

    fn halve(&mut self, m: Sample, piece: Piece) {
        let depth = piece.depth + 1;
        self.stack.push(Piece { a: m, depth, ..piece });
        self.stack.push(Piece { b: m, depth, ..piece });
    }

    /// Adds the points of half of a consistent piece whose values vary by r, and of which `noise` is zero.
    fn half(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), a: Sample, b: Sample, (r, noise): (f64, f64)) {
        let length = b.x - a.x;
        // H = g + s L g'(a) + s² c₂ + s³ c₃ with s from 0 to 1.
        let change = b.value - a.value;
        let (start, end) = (length * a.slope, length * b.slope);
        let (c2, c3) = (3.0 * change - 2.0 * start - end, start + end - 2.0 * change);
        let mut before = a;
        let mut points = [None; 2];
        for (s, point) in critical(start, c2, c3).into_iter().zip(&mut points) {
            let Some(s) = s else { continue };
            let value = a.value + s * (start + s * (c2 + s * c3));
            // An extremum that leads away from zero hides nothing.
            let dips = value.abs() < a.value.abs().max(b.value.abs()) || value * a.value < 0.0 || value * b.value < 0.0;
            if self.extrema || dips && (value.abs() <= NEAR * r + noise || value * a.value < 0.0) {
                *point = Some(self.sample(f, a.x + s * length));
            }
        }
        // Each pair of neighbours may have an extremum between them: the cubic's are not quite in their places.
        let looked = points.iter().any(Option::is_some);
        for here in points.into_iter().flatten().filter(|here| here.x > a.x && here.x < b.x).chain([b]) {
            if looked && before.slope * here.slope < 0.0 {
                let turn = self.extremum(f, (before, here), noise);
                if turn.x > before.x && turn.x < here.x {
                    let turn = self.settled(f, turn, (before, here), (r, noise));
                    self.points.push(turn);
                }
            }
            let settled = self.settled(f, here, (a, b), (r, noise));
            self.points.push(settled);
            before = here;
        }
    }

    /// The extremum between two points with slopes of opposite signs, or a point beyond zero that is met on the way.
    fn extremum(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), (a, b): (Sample, Sample), noise: f64) -> Sample {
        let side = a.value.signum();
        let (mut low, mut high) = (a, b);
        let mut best = if a.value.abs() < b.value.abs() { a } else { b };
        for round in 0..100 {
            let width = high.x - low.x;
            if width.is_nan() || width <= self.finest(low.x, high.x) {
                break;
            }
            // Where the chord of the slope meets zero; halves where that does not help.
            let chord = low.x - low.slope * (high.x - low.x) / (high.slope - low.slope);
            let middle = 0.5 * (low.x + high.x);
            let x = if round % 3 == 2 || !(chord > low.x && chord < high.x) { middle } else { chord };
            let here = self.sample(f, x);
            let better =
                if self.extrema { here.slope.abs() < best.slope.abs() } else { here.value.abs() < best.value.abs() };
            if better || !self.extrema && side * here.value < 0.0 {
                best = here;
            }
            if !self.extrema && side * here.value < -noise || here.slope == 0.0 || here.slope.is_nan() {
                break;
            }
            // What is left between the bracket's ends cannot reach zero.
            let reach = (high.x - low.x) * low.slope.abs().max(high.slope.abs());
            if !self.extrema && here.value.abs() > 2.0 * reach + noise {
                break;
            }
            if (here.slope > 0.0) == (low.slope > 0.0) {
                low = here;
            } else {
                high = here;
            }
        }
        best
    }

    /// A point at which the function turns and is zero to its rounding, as a zero; it lies between or on these ends of a piece.
    fn settled(
        &mut self,
        f: &mut impl FnMut(f64) -> (f64, f64),
        point: Sample,
        (a, b): (Sample, Sample),
        (r, noise): (f64, f64),
    ) -> Sample {
        let turns = (b.x - a.x) * point.slope.abs() <= 2.0 * (noise * r).sqrt();
        let zero = turns && point.value.abs() <= noise && !self.stands(f, point, (a, b));
        if zero { Sample { value: 0.0, ..point } } else { point }
    }

    /// Whether a value at which the function turns is more than rounding, although it is next to nothing beside those at the ends of a piece: so
    /// near to it that the function varies by as much as the value, it is a parabola to a good part of that.  Both ends of a pulse may be the
    /// zeros of one such function.
    fn stands(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), point: Sample, (a, b): (Sample, Sample)) -> bool {
        let bend = 0.5 * (b.slope - a.slope) / (b.x - a.x);
        let reach = (point.value / bend).abs().sqrt();
        if point.value.abs() <= self.rounding || !(reach > MANY * self.finest(point.x, point.x) && reach < b.x - a.x) {
            return false;
        }
        AROUND.into_iter().all(|part| {
            let away = part * reach;
            let x = point.x + away;
            let parabola = point.value + bend * away * away;
            // Beyond the piece nothing was asked.
            !(x > a.x && x < b.x) || (self.sample(f, x).value - parabola).abs() <= CONSISTENT * point.value.abs()
        })
    }

    /// Goes from point to point and marks where the sign changes.
    fn walk(&mut self, f: &mut impl FnMut(f64) -> (f64, f64)) {
        let mut last: Option<Sample> = None;
        let mut zero: Option<f64> = None;
        let mut defined = self.points.first().is_some_and(|p| p.value.is_finite());
        for index in 0..self.points.len() {
            let here = self.points[index];
            // A sample that hits a pole of even order says no more than those beside it.
            let next = self.points.get(index + 1).map_or(f64::NAN, |next| next.value);
            if here.value.is_infinite() && next.is_finite() && last.is_some_and(|last| last.value * next > 0.0) {
                continue;
            }
            if here.value.is_finite() != defined {
                defined = !defined;
                self.marks.push(Zero { x: here.x, kind: ZeroKind::Undefined });
            }
            if !here.value.is_finite() {
                (last, zero) = (None, None);
                continue;
            }
            if here.value == 0.0 {
                zero = zero.or(Some(here.x));
                continue;
            }
            if let Some(before) = last {
                let rising = here.value > 0.0;
                match (zero, (before.value > 0.0) != rising) {
                    (Some(x), true) => {
                        let mark = self.at_zero(f, x, (before, here));
                        self.marks.push(mark);
                    }
                    (Some(x), false) => self.marks.push(Zero { x, kind: ZeroKind::Touches }),
                    (None, false) => {}
                    (None, true) => {
                        let mark = self.between(f, before, here);
                        self.marks.push(mark);
                    }
                }
            }
            (last, zero) = (Some(here), None);
        }
    }

    /// What lies at a zero between two points of opposite signs.  Where the function is flat the point may be zero to the rounding of
    /// what is large only: then its own change of sign is the zero.
    fn at_zero(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), x: f64, (before, here): (Sample, Sample)) -> Zero {
        if self.sample(f, x).value != 0.0 {
            return self.between(f, before, here);
        }
        let (around, samples) = (self.around(), &mut self.samples);
        let value = |x: f64| {
            *samples += 1;
            f(x).0
        };
        let nature = nature_of_zero(value, x, (before.x, before.value), (here.x, here.value), around);
        Zero { x, kind: kind(nature, here.value > 0.0) }
    }

    fn around(&self) -> Around {
        let ends = [self.points.first(), self.points.last()].map(|point| point.map_or(0.0, |point| point.x));
        Around { domain: (ends[0], ends[1]), rounding: self.rounding, resolution: self.resolution }
    }

    /// What lies between two points of opposite signs.
    fn between(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), a: Sample, b: Sample) -> Zero {
        let (around, samples) = (self.around(), &mut self.samples);
        let value = |x: f64| {
            *samples += 1;
            f(x).0
        };
        let (x, nature) = locate(value, (a.x, a.value), (b.x, b.value), around);
        Zero { x, kind: kind(nature, b.value > 0.0) }
    }

    fn sample(&mut self, f: &mut impl FnMut(f64) -> (f64, f64), x: f64) -> Sample {
        self.samples += 1;
        let (value, slope) = f(x);
        Sample { x, value, slope }
    }
}

/// The larger of a size and that of a value, where that is a number.
fn larger(size: f64, value: f64) -> f64 {
    if value.is_finite() { size.max(value.abs()) } else { size }
}

/// A size that says how exactly values about it are known: at a pole, that of what is beside it times some number.
fn tamed(size: f64, beside: f64) -> f64 {
    if beside > 0.0 { size.min(POLE * beside) } else { size }
}

/// The second largest size of three values; 0 for what is no number.
fn second_largest(values: [f64; 3]) -> f64 {
    let mut sizes = values.map(|value| larger(0.0, value));
    sizes.sort_unstable_by(f64::total_cmp);
    sizes[1]
}

fn kind(nature: Nature, rising: bool) -> ZeroKind {
    match nature {
        Nature::Root => ZeroKind::Crosses { rising },
        Nature::Pole => ZeroKind::Pole,
        Nature::Jump => ZeroKind::Jumps,
        Nature::Undefined => ZeroKind::Undefined,
    }
}

/// The critical points within (0, 1) of start·s + c₂ s² + c₃ s³, in order.
fn critical(start: f64, c2: f64, c3: f64) -> [Option<f64>; 2] {
    let discriminant = c2 * c2 - 3.0 * c3 * start;
    if discriminant.is_nan() || discriminant < 0.0 {
        return [None, None];
    }
    // The stable form of the roots of 3c₃s² + 2c₂s + start.
    let q = -(c2 + discriminant.sqrt().copysign(c2));
    let inside = |s: f64| (s > 0.0 && s < 1.0).then_some(s);
    let mut roots = [inside(q / (3.0 * c3)), inside(start / q)];
    if let [Some(a), Some(b)] = roots
        && a > b
    {
        roots = [Some(b), Some(a)];
    }
    roots
}
