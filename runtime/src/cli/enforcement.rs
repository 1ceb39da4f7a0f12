//! How constraints are enforced: `--constraints`, `--drift` and what goes with them.

use clap::ArgMatches;

use super::Problem;
use crate::Settings;
use crate::mechanism::{Enforcement, Stabilisation};

/// Of springs in the place of constraints, where nobody says it, SI.
const STIFFNESS: f64 = 1e6;

/// Applies `--constraints`, `--stiffness`, `--damping`, `--drift` and `--alpha`.
pub(super) fn choose(options: &ArgMatches, settings: &mut Settings) -> Result<(), Problem> {
    let text = |name: &str| options.get_one::<String>(name).map(String::as_str);
    let number = |name: &str| -> Result<Option<f64>, Problem> {
        let read = |text: &str| {
            text.trim().parse().map_err(|_| Problem::usage(format!("--{name} is `{text}`; give a number")))
        };
        text(name).map(read).transpose()
    };
    let (stiffness, damping, alpha) = (number("stiffness")?, number("damping")?, number("alpha")?);
    let unknown =
        |name: &str, given: &str, known: &str| Err(Problem::usage(format!("--{name} is `{given}`; there are {known}")));
    settings.enforcement = match text("constraints") {
        None | Some("multipliers") => Enforcement::Multipliers,
        Some("nullspace") => Enforcement::NullSpace,
        Some("springs") => {
            Enforcement::Springs { stiffness: stiffness.unwrap_or(STIFFNESS), damping: damping.unwrap_or(0.0) }
        }
        Some(other) => return unknown("constraints", other, "multipliers, nullspace, springs"),
    };
    settings.stabilisation = match text("drift") {
        None | Some("project") => Stabilisation::Project,
        Some("none") => Stabilisation::None,
        Some("baumgarte") => Stabilisation::Baumgarte { alpha },
        Some(other) => return unknown("drift", other, "project, none, baumgarte"),
    };
    let springs = matches!(settings.enforcement, Enforcement::Springs { .. });
    if !springs && (stiffness.is_some() || damping.is_some()) {
        return Err(Problem::usage("--stiffness and --damping go with --constraints springs"));
    }
    if springs && text("drift").is_some() {
        return Err(Problem::usage("with springs nothing drifts: leave --drift out"));
    }
    if alpha.is_some() && !matches!(settings.stabilisation, Stabilisation::Baumgarte { .. }) {
        return Err(Problem::usage("--alpha goes with --drift baumgarte"));
    }
    Ok(())
}
