//! Whether there is anything to animate.

use clap::ArgMatches;

use super::Problem;
use super::load::Loaded;

/// No more bodies are proposed to be drawn.
const MOST_BODIES: usize = 4;

/// Refuses `--animate` where the file draws nothing and no chart stands beside it, and says what to write into the file.
///
/// # Errors
/// [`Problem::Usage`].
pub fn check(loaded: &Loaded, options: &ArgMatches) -> Result<(), Problem> {
    let charts = options.try_get_many::<String>("show").ok().flatten().is_some();
    if !options.contains_id("animate") || charts || !loaded.system.description().draw.is_empty() {
        return Ok(());
    }
    let bodies: Vec<String> = loaded.model()?.bodies.into_iter().map(|body| body.name).collect();
    let advice = match bodies.as_slice() {
        [] => "say where something is, and draw that: `points: {tip: [l*sin(theta), -l*cos(theta)]}`, `draw: [{trace: tip}, \
               {circle: {at: tip, radius: 0.1}}]`"
            .to_owned(),
        all => {
            let circles = all.iter().take(MOST_BODIES).map(|name| format!("{{circle: {{at: \"{name}\", radius: 0.1}}}}"));
            let circles: Vec<String> = circles.collect();
            format!("write into the file, for its bodies, `draw: [{}, {{trace: \"{}\"}}]`", circles.join(", "), all[0])
        }
    };
    Err(Problem::usage(format!(
        "--animate has nothing to draw, since {} has no `draw`; {advice} (`line` and `spring` join points: see `draw` in \
         docs/LANGUAGE.md)",
        loaded.path
    )))
}
