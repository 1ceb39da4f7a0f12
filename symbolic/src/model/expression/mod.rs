//! Expressions of the file: names to symbols, syntax to the graph, units; families, indices and the table of names.

pub mod antiderivative;
pub mod builder;
pub mod dimension;
pub mod equation;
pub mod facts;
pub mod families;
pub mod functions;
pub mod index;
pub mod integral;
pub mod joints;
pub mod labels;
pub mod lines;
pub mod lists;
pub mod lower;
pub mod measure;
pub mod momenta;
pub mod names;
pub mod quadrature;
pub mod quantities;
pub mod rules;
pub mod scope;
pub mod substitute;
pub mod terms;
pub mod trial;
pub mod value;
pub mod waves;
