//! How fast an animated picture plays.

use std::fmt;

use super::Animation;
use super::ticks::round_step;
use crate::numbers::short;

/// How many frames an animated picture has, and how fast it plays.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Playback {
    /// Pictures, 25 a second.
    pub frames: usize,
    /// Seconds of the motion in a second of the picture.
    pub speed: f64,
}

impl Playback {
    /// Frames a second.
    pub const RATE: u32 = 25;
}

impl fmt::Display for Playback {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} frames, {} a second, ", self.frames, Playback::RATE)?;
        match self.speed {
            1.0 => write!(f, "as fast as the motion"),
            speed if speed > 1.0 => write!(f, "{} times as fast as the motion", short(speed)),
            speed => write!(f, "{} times slower than the motion", short(1.0 / speed)),
        }
    }
}

/// Runs from one to the other length are shown as they are, others in about so long, s.
const AS_THEY_ARE: std::ops::RangeInclusive<f64> = 1.0..=20.0;
const USUAL: f64 = 10.0;
/// A period of what repeats takes about as long, s.
const PERIOD: f64 = 2.0;

impl Animation {
    /// How `to_png` and `to_gif` play: a run of one to twenty seconds as it is, others
    /// in five to ten seconds, a period that repeats in one to two.
    pub fn playback(&self) -> Playback {
        let (start, end) = self.span();
        let length = end - start;
        if !(length > 0.0 && length.is_finite()) {
            return Playback { frames: 1, speed: 1.0 };
        }
        let speed = match self.repeat {
            true => round_step(length / PERIOD),
            false if AS_THEY_ARE.contains(&length) => 1.0,
            false => round_step(length / USUAL),
        };
        let frames = (length / speed * f64::from(Playback::RATE)).round() as usize;
        Playback { frames: if self.repeat { frames.max(1) } else { frames + 1 }, speed }
    }

    /// The first and the last time.
    pub(super) fn span(&self) -> (f64, f64) {
        let time = |frame: Option<&(f64, Vec<f64>)>| frame.map_or(0.0, |frame| frame.0);
        (time(self.frames.first()), time(self.frames.last()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn playback(length: f64, repeat: bool) -> (usize, f64) {
        let frames = [(0.0, Vec::new()), (length, Vec::new())];
        let Playback { frames, speed } = Animation { repeat, ..Animation::default() }.with_frames(frames).playback();
        (frames, speed)
    }

    #[test]
    fn runs_take_some_seconds() {
        assert_eq!(playback(10.0, false), (251, 1.0));
        assert_eq!(playback(1.0, false), (26, 1.0));
        assert_eq!(playback(60.0, false), (151, 10.0));
        assert_eq!(playback(1e-3, false), (251, 1e-4));
        assert_eq!(playback(3.0, true), (38, 2.0));
        assert_eq!(playback(0.0, false), (1, 1.0));
    }

    #[test]
    fn the_speed_is_told() {
        let told = |frames, speed| Playback { frames, speed }.to_string();
        assert_eq!(told(251, 1.0), "251 frames, 25 a second, as fast as the motion");
        assert_eq!(told(151, 10.0), "151 frames, 25 a second, 10 times as fast as the motion");
        assert_eq!(told(251, 1e-4), "251 frames, 25 a second, 10000 times slower than the motion");
    }
}
