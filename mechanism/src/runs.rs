//! What a run needs beside equations: values of parameters, scenes and motions.

use alloc::vec::Vec;

use super::{Equations, Motion, Real};

/// A mechanism as generated from a model file: its [`Equations`], its parameters, and the scenes and motions of its file.
pub trait Mechanism<const N: usize, const C: usize>: Equations<N, C> {
    /// Held values where a scene starts, of any numbers as parameters.
    fn scene_memory<S: Real>(parameters: &[S], scene: usize) -> Vec<S> {
        let _ = (parameters, scene);
        Vec::new()
    }
    /// Pairs (first tick, period) of the clocks, s, of any numbers as parameters.
    fn clock_numbers<S: Real>(parameters: &[S]) -> Vec<S> {
        let _ = parameters;
        Vec::new()
    }
    /// Motions that the file asks for.
    fn motions() -> &'static [Motion] {
        &[]
    }
    /// A motion's period, energy, guesses of unknowns and values of conditions, of any numbers as free parameters; 0 for what is not given.
    fn motion_numbers<S: Real>(parameters: &[S], motion: usize) -> Vec<S> {
        let _ = (parameters, motion);
        Vec::new()
    }
    /// The free parameters' values.
    fn parameters(&self) -> Vec<f64>;
    /// A free parameter's field.
    fn parameter_mut(&mut self, index: usize) -> Option<&mut f64>;
    /// What a scene sets, evaluated with the present parameters.
    fn scene_parameters(&self, scene: usize) -> Vec<(usize, f64)>;
    /// A scene's end, tolerance and spacing of reports, then the start [q; q'], of any numbers as free parameters: 3 + 2 N numbers, which
    /// are 0 before.
    fn scene_numbers<S: Real>(parameters: &[S], scene: usize, numbers: &mut [S]);
    /// A scene, evaluated with the present parameters.
    fn scene(&self, scene: usize) -> Scene;
    /// The guess for an equilibrium where the file gives one.
    fn equilibrium_guess(&self) -> Option<[f64; N]>;
    /// The coefficients of restitution of the events' impacts, of any numbers as free parameters.
    fn restitutions<S: Real>(parameters: &[S]) -> Vec<S>;
    /// Angular frequencies ω, rad/s and of either sign, of the dependence on time, of any numbers as free parameters: all of it is in sines,
    /// cosines and periodic tables of ω t + ….  `None` where it is not; none without a dependence on time.
    fn frequencies<S: Real>(parameters: &[S]) -> Option<Vec<S>> {
        let _ = parameters;
        Some(Vec::new())
    }
    /// What [`Equations::start_conditions`] gives where the starts meet it.
    fn start_condition_values(&self) -> Vec<f64>;
    /// Pairs (place of one of them, rate that it contains).
    fn start_condition_speeds() -> &'static [(u32, u32)] {
        &[]
    }
}

/// A rotation whose angular velocity a start names: it stays what it is wherever the attitude is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spin {
    /// The first of its coordinates.
    pub first: usize,
    /// Along its own axes, or else along those from which it is turned.
    pub own: bool,
}

/// Where and how long to run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Generalized coordinates at the start, SI; of those that are not held, the guess.
    pub q: Vec<f64>,
    /// Their rates at the start, SI.
    pub v: Vec<f64>,
    /// Which coordinates keep their values where constraints are met; none named: all.
    pub held_q: Vec<bool>,
    /// Which rates do.
    pub held_v: Vec<bool>,
    /// Rotations whose rates are those of an angular velocity that the scene names, at the attitude in `q`.
    pub spins: Vec<Spin>,
    /// Whether somebody gave a guess.
    pub guessed: bool,
    /// The phase in which it starts.
    pub phase: usize,
    /// Which of the equations of `System::start_conditions` the start meets beside constraints.
    pub start_conditions: core::ops::Range<usize>,
    /// Where the run ends, s.
    pub until: f64,
    /// Tolerance, relative to the range that each coordinate goes through.
    pub tolerance: f64,
    /// Spacing of reported states, s; `None`: 500 points.
    pub every: Option<f64>,
}
