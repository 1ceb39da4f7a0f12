//! Masses that change along the motion.
//!
//! A body whose mass is m at this instant obeys m a = ΣF + m' (w − v) (I. V. Meshchersky, 1897): what it loses or gains, of velocity w where
//! the body's material has v, acts as a force, which is one of the loads, and beside it the mass does not know that it changes.  So energies
//! are differentiated with masses and moments of inertia held: each is a symbol of its own, in the place of which its value is put
//! afterwards.  What is a rate of the whole, such as that of an energy or of a momentum, has the part m' ∂/∂m beside.

use rustc_hash::FxHashMap as HashMap;

use super::{Dynamics, rates};
use crate::expr::{Forward, Graph, Id, Symbol, substitute};

/// Masses and moments of inertia that are held while energies are differentiated.
pub(super) struct HeldMasses {
    values: HashMap<Symbol, Id>,
    rates: HashMap<Symbol, Id>,
}

impl HeldMasses {
    /// Holds those that change, in the bodies of `dynamics`; nothing else of it is touched.
    pub fn hold(graph: &mut Graph, dynamics: &mut Dynamics) -> HeldMasses {
        let mut held = HeldMasses { values: HashMap::default(), rates: HashMap::default() };
        for body in &mut dynamics.bodies {
            let moments = body.rotation.iter_mut().flat_map(|rotation| rotation.inertias_mut());
            for value in std::iter::once(&mut body.mass).chain(moments) {
                if graph.symbols([*value]).into_iter().any(Symbol::may_change) {
                    let symbol = Symbol::Dummy(held.values.len() as u32);
                    held.values.insert(symbol, *value);
                    held.rates.insert(symbol, rates(graph, &[*value])[0]);
                    *value = graph.symbol(symbol);
                }
            }
        }
        held
    }

    /// m' ∂/∂m of an expression with held masses, over all of them.
    pub fn rate_by_masses(&self, graph: &mut Graph, of: Id) -> Id {
        if self.rates.is_empty() {
            return Id::ZERO;
        }
        Forward::new(|_: &mut Graph, s| self.rates.get(&s).copied().unwrap_or(Id::ZERO)).of(graph, of)
    }

    /// Puts their values in.
    pub fn put_in<'a>(&self, graph: &mut Graph, places: impl IntoIterator<Item = &'a mut Id>) {
        if self.values.is_empty() {
            return;
        }
        let places: Vec<&mut Id> = places.into_iter().collect();
        let held: Vec<Id> = places.iter().map(|id| **id).collect();
        let values = substitute(graph, &held, &self.values);
        places.into_iter().zip(values).for_each(|(place, value)| *place = value);
    }
}
