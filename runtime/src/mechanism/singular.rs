//! Where there are no accelerations.

use super::{Description, SingularMass};
use crate::cause::Cause;

/// There are no accelerations at a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Singular {
    /// M has no inverse.
    Mass(SingularMass),
    /// An equation of a system of balances has no unknowns, as that of power has at rest.
    VoidBalance {
        /// Index of the system.
        system: usize,
        /// Index of the equation.
        equation: usize,
    },
    /// A system of balances in a phase to which it does not belong.
    OtherPhase {
        /// Index of the system.
        system: usize,
        /// Index of the phase.
        phase: usize,
    },
    /// Friction, made of the reaction of this row, leaves no motion or more than one.
    Friction {
        /// Index of the row of the constraints.
        row: usize,
    },
    /// A system of balances does not determine an unknown.
    Balances {
        /// Index of the system.
        system: usize,
        /// Index of the unknown.
        unknown: usize,
    },
}

impl From<SingularMass> for Singular {
    fn from(fault: SingularMass) -> Self {
        Singular::Mass(fault)
    }
}

impl Singular {
    /// The end of a run that came to such a state, with the names that the mechanism gives.
    pub fn cause(self, mechanism: &Description) -> Cause {
        let systems = &mechanism.balances;
        let name = |system: usize| systems.get(system).map_or_else(String::new, |s| s.name.to_string());
        match self {
            Singular::Mass(SingularMass { coordinate }) => {
                Cause::SingularMass { coordinate: mechanism.coordinate_name(coordinate) }
            }
            Singular::VoidBalance { system, equation } => {
                let balance = systems.get(system).and_then(|s| s.equations.get(equation));
                Cause::VoidBalance {
                    system: name(system),
                    balance: balance.map_or_else(|| format!("equation {}", equation + 1), |b| b.name.to_string()),
                    at_rest: balance.is_some_and(|b| b.void_at_rest),
                }
            }
            Singular::OtherPhase { system, phase } => {
                let phase = mechanism.phases.get(phase).map_or_else(String::new, |phase| phase.name.to_string());
                Cause::NoBalances { system: name(system), phase }
            }
            Singular::Friction { row } => {
                let constraint = mechanism.rows.get(row).map_or_else(String::new, |row| row.name.to_string());
                Cause::PainleveInconsistent { constraint }
            }
            Singular::Balances { system, unknown } => {
                let known = systems.get(system).and_then(|s| s.unknowns.get(unknown));
                let unknown = known.map_or_else(|| format!("unknown {}", unknown + 1), ToString::to_string);
                Cause::SingularBalances { system: name(system), unknown }
            }
        }
    }
}
