//! Who takes part.

use crate::mechanism::{Enforcement, Method, Stabilisation, System};
use crate::simulate::Settings;

/// A method and a formulation on a scene; its tolerance or step is varied.
pub struct Candidate {
    /// `dop853`, `null space` …
    pub name: String,
    /// The mechanism.
    pub system: Box<dyn System>,
    /// Everything else about its runs.
    pub settings: Settings,
}

/// Stiffnesses of springs in the place of constraints, SI.
const SPRINGS: [f64; 4] = [1e4, 1e5, 1e6, 1e7];

impl Candidate {
    /// A candidate.
    pub fn new(name: impl Into<String>, system: &dyn System, settings: Settings) -> Candidate {
        Candidate { name: name.into(), system: system.boxed_clone(), settings }
    }

    /// Every method on the same formulation, `auto` first; not `moreau`, whose steps go over what others resolve.
    pub fn methods(system: &dyn System, settings: &Settings) -> Vec<Candidate> {
        let rest = Method::ALL.into_iter().filter(|method| !matches!(method, Method::Auto | Method::Moreau));
        let of = |method: Method| Candidate::new(method.name(), system, Settings { method, ..settings.clone() });
        std::iter::once(Method::Auto).chain(rest).map(of).collect()
    }

    /// Every way of treating constraints, by the method of the settings: multipliers with projection, with Baumgarte's
    /// stabilisation and with neither, the null space, and springs of several stiffnesses.  None without constraints.
    pub fn formulations(system: &dyn System, settings: &Settings) -> Vec<Candidate> {
        let description = system.description();
        if description.rows.is_empty() {
            return Vec::new();
        }
        let of = |name: &str, enforcement: Enforcement, stabilisation: Stabilisation| {
            Candidate::new(name, system, Settings { enforcement, stabilisation, ..settings.clone() })
        };
        let mut ways = vec![
            of("multipliers", Enforcement::Multipliers, Stabilisation::Project),
            of("not projected", Enforcement::Multipliers, Stabilisation::None),
            of("Baumgarte", Enforcement::Multipliers, Stabilisation::Baumgarte { alpha: None }),
            of("null space", Enforcement::NullSpace, Stabilisation::Project),
        ];
        for stiffness in SPRINGS {
            let name = format!("springs {stiffness:.0e}");
            ways.push(of(&name, Enforcement::Springs { stiffness, damping: 0.0 }, Stabilisation::None));
        }
        ways
    }
}
