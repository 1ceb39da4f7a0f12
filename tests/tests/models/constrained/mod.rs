//! Mechanisms with constraints, reactions, phases and impacts.

mod contact;
mod four_ways;
mod integrals;
mod linkages;
mod rank;
mod rods;
mod skates;
mod small_motions;
mod starts;
