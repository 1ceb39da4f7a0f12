//! Seeing a run: charts as SVG, or PNG and PDF (feature `png`), an animation as one HTML page, as PNG, as GIF or its first frame as SVG (feature `png`),
//! tables as CSV.
//!
//! Everything here turns plain data into text or pixels, so it serves runs, error charts and mode shapes alike; only
//! [`Figure::write`], [`Animation::write`], [`Run::plot`](crate::Run::plot) and its neighbours write files.

mod animation;
mod arrows;
mod axis;
#[cfg(feature = "png")]
mod brush;
mod chart;
mod compact;
mod csv;
mod curve;
mod curves;
mod extent;
mod figure;
#[cfg(feature = "png")]
mod film;
mod legend;
mod lettering;
mod marks;
#[cfg(feature = "png")]
mod outlines;
#[cfg(feature = "png")]
mod painter;
#[cfg(feature = "png")]
mod pdf;
mod playback;
#[cfg(feature = "png")]
mod raster;
mod run;
mod solids;
#[cfg(feature = "png")]
mod stage;
mod ticks;
mod upright;
mod vector;

pub use animation::Animation;
#[cfg(feature = "cli")]
pub(crate) use animation::{is_film, is_picture};
pub use arrows::Arrows;
pub use axis::{Axis, Scale};
pub use chart::{Chart, Failure, Instant, Series, Slope, Style};
pub use csv::csv;
pub use figure::Figure;
#[cfg(feature = "cli")]
pub(crate) use figure::wants_letters;
pub use playback::Playback;
pub(crate) use run::has_units;
pub(crate) use run::unit;

#[cfg(test)]
mod tests;
