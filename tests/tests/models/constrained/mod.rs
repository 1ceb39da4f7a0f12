//! Mechanisms with constraints, reactions, phases and impacts.

mod contact;
mod linkages;
mod rank;
mod rods;
mod skates;
mod starts;
