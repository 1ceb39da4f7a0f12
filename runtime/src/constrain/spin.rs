//! Angular velocities that a start names, as rates of the quaternions at the attitude that it finds.

use std::ops::Range;

use nalgebra::Quaternion;

use crate::mechanism::{Scene, Spin};

/// The angular velocity of a rotation that a start keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KeptSpin {
    spin: Spin,
    /// Half of it, rad/s, as a quaternion: q' = q w along the own axes, w q along those from which the rotation is turned.
    half: Quaternion<f64>,
}

impl KeptSpin {
    /// Those of a scene, whose rates are those at its own attitude.
    pub fn of_scene(scene: &Scene) -> Vec<KeptSpin> {
        let kept = |spin: &Spin| {
            let inverse = of(&scene.q, spin.first).try_inverse()?;
            let rates = of(&scene.v, spin.first);
            Some(KeptSpin { spin: *spin, half: if spin.own { inverse * rates } else { rates * inverse } })
        };
        scene.spins.iter().filter_map(kept).collect()
    }

    /// The places of its rotation among the coordinates.
    pub fn places(&self) -> Range<usize> {
        self.spin.first..self.spin.first + 4
    }

    /// Gives the rates of its rotation the values that they have at an attitude.
    pub fn put(&self, q: &[f64], v: &mut [f64]) {
        let rates = self.times(of(q, self.spin.first));
        v[self.places()].copy_from_slice(&[rates.w, rates.i, rates.j, rates.k]);
    }

    /// The slopes of these rates where the attitude changes by `dq` and the scene's own [q; q'] by `asked`.
    pub fn slopes(&self, (q, dq): (&[f64], &[f64]), scene: Option<(&Scene, &[f64])>, dv: &mut [f64]) {
        let first = self.spin.first;
        let turned = self.times(of(dq, first));
        let own = scene.and_then(|(scene, asked)| {
            let (by_place, by_rate) = asked.split_at(scene.q.len());
            let left = of(by_rate, first) - self.times(of(by_place, first));
            let inverse = of(&scene.q, first).try_inverse()?;
            let half = if self.spin.own { inverse * left } else { left * inverse };
            Some(KeptSpin { half, ..*self }.times(of(q, first)))
        });
        let rates = own.map_or(turned, |own| turned + own);
        dv[self.places()].copy_from_slice(&[rates.w, rates.i, rates.j, rates.k]);
    }

    fn times(&self, q: Quaternion<f64>) -> Quaternion<f64> {
        if self.spin.own { q * self.half } else { self.half * q }
    }
}

fn of(list: &[f64], first: usize) -> Quaternion<f64> {
    Quaternion::new(list[first], list[first + 1], list[first + 2], list[first + 3])
}
