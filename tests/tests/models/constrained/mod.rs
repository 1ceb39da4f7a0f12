//! Mechanisms with constraints, reactions, phases and impacts.

mod contact;
mod linkages;
mod rods;
mod skates;
mod small;
mod starts;
