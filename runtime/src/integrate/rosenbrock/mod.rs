//! Rosenbrock methods: for stiff motions, one linear system a stage and no iteration.
//!
//! A stage solves (1/(hγ) − J) U = f(t + cᵢh, y + Σ aᵢⱼUⱼ) + Σ cᵢⱼUⱼ/h + h dᵢ ∂f/∂t with the Jacobian J of f = (q', a); once
//! places are eliminated it is the same matrix of size n for all stages.  Both derivatives are the generated ones: where they
//! are not exact the order falls to 2 (catalogue B12; Hairer and Wanner, Solving Ordinary Differential Equations II, 1996,
//! IV.7).

mod dense;
mod rodas5p;
mod step;
mod tableau;
#[cfg(test)]
mod tests;

pub(crate) use rodas5p::RODAS5P;
pub(crate) use step::Rosenbrock;
