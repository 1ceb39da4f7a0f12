//! What whoever integrates by other means needs beside [`System::rate`]: sides of discontinuities, and slopes of the rate.

use nalgebra::DMatrix;

use super::SwitchKind;
use super::slopes::AccelerationSlopes;
use super::{At, Singular, System};

/// Puts every discontinuity on the side where a state [q; q'] is, one after the other, since an argument contains modes of earlier ones only;
/// on its surface `sign` is 0 and `step` is 1.
///
/// A run does more: it stops where an argument crosses zero, and finds what slides there.
///
/// # Errors
/// [`Singular`] where the accelerations do not exist.
pub fn choose_sides(system: &mut dyn System, t: f64, y: &[f64]) -> Result<(), Singular> {
    let n = system.len();
    let count = system.description().switches.len();
    let (mut a, mut lambda) = (vec![0.0; n], vec![0.0; system.description().rows.len()]);
    let (mut pairs, mut modes) = (vec![0.0; 2 * count], system.modes().to_vec());
    for switch in 0..count {
        let at = At::packed(t, y, n);
        system.accelerations_and_multipliers(at, &mut a, &mut lambda)?;
        system.switches(at.accelerated(&a).constrained(&lambda), &mut pairs);
        let argument = pairs[2 * switch];
        modes[switch] = match system.description().switches[switch].kind {
            SwitchKind::Sign if argument == 0.0 => 0.0,
            SwitchKind::Sign => argument.signum(),
            SwitchKind::Step => f64::from(argument >= 0.0),
        };
        system.set_modes(&modes);
    }
    Ok(())
}

/// ∂f/∂y of the rate f = [q'; q''] of a state y = [q; q'], 2n × 2n, on the sides that the discontinuities have; the slopes of accelerations are
/// exact, those with constraints included.
///
/// # Errors
/// [`Singular`] where the accelerations do not exist.
pub fn rate_jacobian(system: &dyn System, t: f64, y: &[f64]) -> Result<DMatrix<f64>, Singular> {
    let n = system.len();
    let mut slopes = AccelerationSlopes::new(n);
    slopes.evaluate(system, At::packed(t, y, n))?;
    let mut jacobian = DMatrix::zeros(2 * n, 2 * n);
    jacobian.view_mut((0, n), (n, n)).fill_with_identity();
    for i in 0..n {
        for j in 0..n {
            jacobian[(n + i, j)] = slopes.by_place()[i * n + j];
            jacobian[(n + i, n + j)] = slopes.by_speed()[i * n + j];
        }
    }
    Ok(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::Switch;
    use crate::testing::Toy;

    #[test]
    fn the_slopes_of_a_pendulum_are_those_of_its_formula() {
        let jacobian = rate_jacobian(&Toy::pendulum(9.0, 0.0, 1.0), 0.0, &[0.4, 0.7]).unwrap();
        assert_eq!(jacobian, DMatrix::from_row_slice(2, 2, &[0.0, 1.0, -9.0 * 0.4_f64.cos(), 0.0]));
    }

    #[test]
    fn discontinuities_are_put_on_the_side_of_the_state() {
        let switch = |kind| Switch { text: "x'".into(), kind, time_only: false, of_input: false };
        let arguments = |_: f64, _: &[f64], v: &[f64], _: &[f64], pairs: &mut [f64]| pairs.fill(v[0]);
        let toy = Toy::pendulum(9.0, 0.0, 1.0).switch(switch(SwitchKind::Sign), arguments);
        let mut toy = toy.switch(switch(SwitchKind::Step), arguments);
        for (speed, modes) in [(2.0, [1.0, 1.0]), (-2.0, [-1.0, 0.0]), (0.0, [0.0, 1.0])] {
            choose_sides(&mut toy, 0.0, &[0.4, speed]).unwrap();
            assert_eq!(toy.modes, modes);
        }
    }
}
