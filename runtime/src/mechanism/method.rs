//! The methods by name.

use std::fmt;
use std::str::FromStr;

use super::Structure;

/// A method of integration.
///
/// | name | order | for | step | evaluations a step | vibrations are stable |
/// | --- | --- | --- | --- | --- | --- |
/// | `euler` | 1 | comparison | fixed | 1 | never |
/// | `midpoint` | 2 | comparison | fixed | 2 | never |
/// | `rk4` | 4 | all that is not stiff | fixed | 4 | up to hω = 2.83 |
/// | `dopri5` | 5 | loose tolerances | by the tolerance | 6 | up to hω = 1.00 |
/// | `dop853` | 8 | all that is not stiff | by the tolerance | 12 | up to hω = 5.96 |
/// | `rkn8` | 8 | separable systems | by the tolerance | 8 | up to hω = 3.29 |
/// | `verlet` | 2 | separable systems, symplectic | fixed | 1 | up to hω = 2 |
/// | `srkn4` | 4 | separable systems, symplectic | fixed | 6 | up to hω = 3.16 |
/// | `suzuki4` | 4 | separable systems, symplectic | fixed | 5 | up to hω = 2.72 |
/// | `kahanli8` | 8 | separable systems, symplectic | fixed | 17 | up to hω = 3.09 |
/// | `gauss2`, `gauss4`, `gauss6` | 2, 4, 6 | all, symplectic | fixed | by iteration | always |
/// | `radau5` | 5 | stiff motions | by the tolerance | by iteration | always, damped |
/// | `rodas5p` | 5 | stiff motions | by the tolerance | 8 | always, damped |
/// | `taylor` | 20 | smooth motions, tight tolerances | by the tolerance | 20, at once | up to hω = 3.3 |
/// | `moreau` | 1 | friction and contacts, over their events | fixed | 1 | up to hω = 2 |
/// | `exact` | - | linear systems with constant coefficients | fixed; driven: by the tolerance | 0; driven: 8 | as the motion is |
///
/// `exact` multiplies by e^{Ah}; its step is as long as a polynomial between its ends is exact to the tolerance, and as one of degree 8
/// follows what drives the system.  A system is separable where M is constant and forces do not depend on speeds, nor switch with them.
/// Where constraints contain no speeds, `verlet` is RATTLE (`rattle` is another name of it), and `suzuki4` and `kahanli8` are its
/// compositions of order 4 and 8: places and speeds keep the constraints to rounding, and nothing is projected.
/// Symplectic methods keep the energy of a conservative motion within a band, however long it is, as long as their step does
/// not change; where none is given it is found once, from the tolerance, by trial steps over the start of the motion.  Implicit methods
/// solve linear systems with the generated Jacobians.
/// `moreau` steps over impacts and changes of contacts, so that their number does not matter, with an error of the first order in the step; it is never
/// chosen by `auto`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Method {
    /// Euler's method, order 1, fixed step.
    Euler,
    /// The explicit midpoint rule, order 2, fixed step.
    Midpoint,
    /// The classical Runge–Kutta method, order 4, fixed step.
    Rk4,
    /// Dormand and Prince, order 5, with error control; a fixed step if one is given.
    Dopri5,
    /// Dormand and Prince, order 8, with error control; a fixed step if one is given.
    Dop853,
    /// Dormand, El-Mikkawy and Prince's Runge–Kutta–Nyström method, order 8, for separable systems, with error control; a fixed
    /// step if one is given.
    Rkn8,
    /// Störmer–Verlet, order 2, symplectic, for separable systems; with constraints RATTLE; a fixed step.
    Verlet,
    /// Blanes and Moan's Runge–Kutta–Nyström splitting of six stages, order 4, symplectic, for separable systems without
    /// constraints; a fixed step.
    Srkn4,
    /// Suzuki's composition of five Verlet steps, order 4, symplectic, for separable systems; with constraints of steps of
    /// RATTLE; a fixed step.
    Suzuki4,
    /// Kahan and Li's composition of seventeen Verlet steps, order 8, symplectic, for separable systems; with constraints of
    /// steps of RATTLE; a fixed step.
    KahanLi8,
    /// Gauss's collocation of one stage, the implicit midpoint rule, order 2, symplectic; a fixed step.
    Gauss2,
    /// Gauss's collocation of two stages, order 4, symplectic; a fixed step.
    Gauss4,
    /// Gauss's collocation of three stages, order 6, symplectic; a fixed step.
    Gauss6,
    /// Radau's collocation of three stages, order 5, for stiff motions, with error control; a fixed step if one is given.
    Radau5,
    /// Steinebach's Rosenbrock method, order 5, for stiff motions, with error control; a fixed step if one is given.
    Rodas5P,
    /// The motion's own power series, order 20, of M, h and what constrains them order by order; with error control, a fixed step if one is given.
    /// For mechanisms whose equations have one: not with tables, nor friction made of reactions.
    Taylor,
    /// The exponential of a linear system with constant coefficients, exact to rounding at a fixed step; with error control where it
    /// is driven, a fixed step if one is given.
    Exact,
    /// Moreau and Jean's time stepping, order 1, for mechanisms with friction or contacts: impulses over whole steps in the place of the events of
    /// contacts, however many these are; a fixed step.
    Moreau,
    /// The one that suits: [`Method::Rk4`] where a step is given; [`Method::Verlet`] where accelerations are constant
    /// between events; [`Method::Exact`] for linear systems with constant coefficients, for long enough; [`Method::Rodas5P`] where what decays at the start is much faster than what vibrates, and for linear systems whose fastest vibration is not seen at the tolerance;
    /// [`Method::Rkn8`] for separable systems without constraints; else [`Method::Dop853`], or [`Method::Dopri5`] for tolerances
    /// above 10⁻⁴.
    #[default]
    Auto,
}

impl Method {
    /// All methods, as users list them.
    pub const ALL: [Method; 19] = [
        Method::Euler,
        Method::Midpoint,
        Method::Rk4,
        Method::Dopri5,
        Method::Dop853,
        Method::Rkn8,
        Method::Verlet,
        Method::Srkn4,
        Method::Suzuki4,
        Method::KahanLi8,
        Method::Gauss2,
        Method::Gauss4,
        Method::Gauss6,
        Method::Radau5,
        Method::Rodas5P,
        Method::Taylor,
        Method::Exact,
        Method::Moreau,
        Method::Auto,
    ];

    /// The name: `dop853`.
    pub fn name(self) -> &'static str {
        match self {
            Method::Euler => "euler",
            Method::Midpoint => "midpoint",
            Method::Rk4 => "rk4",
            Method::Dopri5 => "dopri5",
            Method::Dop853 => "dop853",
            Method::Rkn8 => "rkn8",
            Method::Verlet => "verlet",
            Method::Srkn4 => "srkn4",
            Method::Suzuki4 => "suzuki4",
            Method::KahanLi8 => "kahanli8",
            Method::Gauss2 => "gauss2",
            Method::Gauss4 => "gauss4",
            Method::Gauss6 => "gauss6",
            Method::Radau5 => "radau5",
            Method::Rodas5P => "rodas5p",
            Method::Taylor => "taylor",
            Method::Exact => "exact",
            Method::Moreau => "moreau",
            Method::Auto => "auto",
        }
    }

    /// True when the method moves places and speeds in turn.
    pub fn splits(self) -> bool {
        self == Method::Srkn4 || self.is_of_verlet_steps()
    }

    /// True when the method is made of steps of Störmer and Verlet, which are those of RATTLE where there are constraints.
    pub fn is_of_verlet_steps(self) -> bool {
        matches!(self, Method::Verlet | Method::Suzuki4 | Method::KahanLi8)
    }

    /// True when the method is for separable systems only: M constant, forces free of speeds.
    pub fn wants_separable(self) -> bool {
        self.splits() || self == Method::Rkn8
    }

    /// True when the method is symplectic at a fixed step, and only then.
    pub fn is_symplectic(self) -> bool {
        self.splits() || matches!(self, Method::Gauss2 | Method::Gauss4 | Method::Gauss6)
    }

    /// True when the method keeps one step, and finds it from the tolerance where none is given; `exact` only where nothing drives
    /// the mechanism.
    pub fn finds_step(self) -> bool {
        self.is_symplectic() || self == Method::Exact
    }

    /// True when the method chooses its steps itself.
    pub fn is_adaptive(self) -> bool {
        matches!(
            self,
            Method::Dopri5
                | Method::Dop853
                | Method::Rkn8
                | Method::Radau5
                | Method::Rodas5P
                | Method::Taylor
                | Method::Auto
        )
    }

    /// True when the method chooses its steps itself for a mechanism of this structure.
    pub(crate) fn adapts_to(self, structure: &Structure) -> bool {
        self.is_adaptive() || self == Method::Exact && structure.time_dependent
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// No method has this name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ParseMethodError {
    /// The name.
    pub name: String,
}

impl fmt::Display for ParseMethodError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown method `{}`; known are", self.name)?;
        for method in Method::ALL {
            write!(f, " {method}")?;
        }
        Ok(())
    }
}

impl std::error::Error for ParseMethodError {}

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(name: &str) -> Result<Self, ParseMethodError> {
        if name == "rattle" {
            return Ok(Method::Verlet);
        }
        Method::ALL
            .into_iter()
            .find(|method| method.name() == name)
            .ok_or_else(|| ParseMethodError { name: name.to_owned() })
    }
}
