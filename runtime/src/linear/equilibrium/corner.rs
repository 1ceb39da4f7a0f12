//! Corners at a rest: slopes of the forces that differ on its sides, where a switch is on its surface or a table at one of its points.
//!
//! One variable after another departs from the rest, and all together: a little, and a hundredth of that.  Slopes that differ on both sides by as
//! much again are two; those of a smooth function, or of a power, come together.  Where all sides agree switches are put on one of them: at
//! sign 0 both factors of `abs(x)*sign(x)`, which is x, would have no slope.

use super::discontinuity::differ;
use super::point::LinearisationPoint;
use crate::linear::{LinearError, SparseMatrix};
use crate::mechanism::{Role, Watched, rate_name};

/// Departures move arguments of switches by this part of the largest coordinate, or of 1, and counts of points of tables by so much: far more
/// than what is on a surface, and far less than the next point.
const DEPARTURE: f64 = 1e-6;
/// Near departures are this part of the others.
const NEARER: f64 = 1e-2;
/// Slopes whose difference falls to less than this part of itself on the way come together: a root falls to a tenth.
const FALLS: f64 = 0.5;
/// A table whose slopes on two sides differ by less than this part of themselves goes straight on: slopes between decimals, 10⁻⁴ of their size apart.
const STRAIGHT: f64 = 1e-11;
/// What differs by so many roundings of its terms does not.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
/// Counts of points nearer to a whole number are at a point.
const AT_A_POINT: f64 = 1e-10;
/// What does not move a surface at two departures, one this part of the other, does not.
const ELSEWHERE: f64 = 0.37;
/// A departure is sought between 10 to minus and plus this times a variable's size.
const DECADES: usize = 30;

/// What may have a corner.
#[derive(Clone, Copy)]
enum Surface {
    /// A switch, by its place.
    Switch(usize),
    /// A table, by the place of the count of points among the arguments.
    Table(usize),
}

/// A departure of coordinates and their rates.
struct Departure {
    by: [Vec<f64>; 2],
    /// What departs, and across which surface.
    along: usize,
    surface: Surface,
}

impl LinearisationPoint {
    /// Refuses a rest at a corner, or at which friction slips, and puts switches on their surface there on a side, where all are alike.
    ///
    /// # Errors
    /// [`LinearError::NotSmooth`], [`LinearError::AtTablePoint`], [`LinearError::SlipsAtRest`].
    pub fn without_corner(&self, q: &[f64]) -> Result<(), LinearError> {
        if let Some(contact) = self.slips_at_rest(q) {
            return Err(LinearError::SlipsAtRest { contact });
        }
        let surfaces = self.surfaces(q);
        if let Some(switch) = self.kink(q, &surfaces) {
            return Err(LinearError::NotSmooth { switch });
        }
        let departures = self.departures(q, &surfaces);
        for departure in &departures {
            if self.turns(q, departure) {
                return Err(match departure.surface {
                    Surface::Switch(switch) => LinearError::NotSmooth { switch: self.switch(switch).0 },
                    Surface::Table(_) => LinearError::AtTablePoint { along: self.variable(departure.along) },
                });
            }
        }
        if let Some(departure) = departures.last() {
            let [q, v] = self.departed(q, departure, 1.0);
            let sides = self.sides_moving(&q, &v);
            self.stay_on(sides);
        }
        Ok(())
    }

    /// A switch that no coordinate and no rate moves off its surface, as that of a reaction, with other slopes on its sides.
    fn kink(&self, q: &[f64], surfaces: &[Surface]) -> Option<String> {
        let fixed = |surface: &Surface| match surface {
            Surface::Switch(switch) => {
                (0..2 * self.n).all(|along| self.step(q, along, *surface).is_none()).then_some(*switch)
            }
            Surface::Table(_) => None,
        };
        let differs = |switch: &usize| differ(&self.sides(q, *switch).map(|side| side.derivatives));
        surfaces.iter().filter_map(fixed).find(differs).map(|switch| self.switch(switch).0)
    }

    /// The name of a coordinate, or of a rate behind all of them.
    fn variable(&self, index: usize) -> String {
        let description = self.system.borrow();
        let coordinates = &description.description().coordinates;
        match index.checked_sub(self.n) {
            None => coordinates[index].name.to_string(),
            Some(i) => coordinates[i].state().map_or_else(|| rate_name(&coordinates[i].name), str::to_owned),
        }
    }

    fn surfaces(&self, q: &[f64]) -> Vec<Surface> {
        let switches = self.on_surface(q).into_iter().map(Surface::Switch);
        let counts: Vec<usize> = {
            let system = self.system.borrow();
            let arguments = system.description().arguments.iter().enumerate();
            let tables = arguments.filter(|(_, a)| a.role == Role::Points && a.of == Watched::Motion && !a.time_only);
            tables.map(|(k, _)| k).collect()
        };
        let at_a_point = |k: &usize| {
            let count = self.value(Surface::Table(*k), q, &self.v);
            (count - count.round()).abs() <= AT_A_POINT * count.abs().max(1.0)
        };
        switches.chain(counts.into_iter().filter(at_a_point).map(Surface::Table)).collect()
    }

    /// A switch's argument, or how many points of a table are passed.
    fn value(&self, surface: Surface, q: &[f64], v: &[f64]) -> f64 {
        match surface {
            Surface::Switch(index) => self.arguments(0.0, q, v)[index],
            Surface::Table(index) => {
                let system = self.system.borrow();
                let mut pairs = vec![0.0; 2 * system.description().arguments.len()];
                system.arguments(self.at(0.0, q, v), &mut pairs);
                pairs[2 * index]
            }
        }
    }

    /// Along each variable that moves a surface, then along all of them, alike and in turns.
    fn departures(&self, q: &[f64], surfaces: &[Surface]) -> Vec<Departure> {
        let n = self.n;
        let moved = |along: usize| {
            let steps = surfaces.iter().filter_map(|surface| Some((*surface, self.step(q, along, *surface)?)));
            let steps: Vec<(Surface, f64)> = steps.collect();
            let least = steps.iter().map(|(_, step)| *step).min_by(f64::total_cmp)?;
            // A table's points have a switch, too, so that runs find them.
            let of_table = steps.iter().find(|(surface, _)| matches!(surface, Surface::Table(_)));
            Some((along, of_table.or(steps.first())?.0, least))
        };
        let steps: Vec<(usize, Surface, f64)> = (0..2 * n).filter_map(moved).collect();
        let departure = |chosen: &[(usize, Surface, f64)]| {
            let mut by = [vec![0.0; n], vec![0.0; n]];
            chosen.iter().for_each(|(along, _, step)| by[along / n][along % n] = *step);
            chosen.first().map(|(along, surface, _)| Departure { by, along: *along, surface: *surface })
        };
        let mut departures: Vec<Departure> = steps.iter().filter_map(|step| departure(&[*step])).collect();
        if steps.len() > 1 {
            // By lengths that differ, so that no two arguments are alike.
            let together = |sign: f64| -> Vec<(usize, Surface, f64)> {
                let part = |k: usize| sign.powi(k as i32) / (1.0 + (k as f64).sqrt());
                steps.iter().enumerate().map(|(k, (along, surface, step))| (*along, *surface, part(k) * step)).collect()
            };
            departures.extend([-1.0, 1.0].into_iter().filter_map(|sign| departure(&together(sign))));
        }
        departures
    }

    /// How far a variable departs to move a surface's value as it should; `None` where it does not.
    fn step(&self, q: &[f64], along: usize, surface: Surface) -> Option<f64> {
        let (n, here) = (self.n, self.value(surface, q, &self.v));
        let wanted = match surface {
            Surface::Switch(_) => DEPARTURE * q.iter().fold(1.0_f64, |most, q| most.max(q.abs())),
            Surface::Table(_) => DEPARTURE,
        };
        let change = |step: f64| {
            let (mut q, mut v) = (q.to_vec(), self.v.clone());
            if along < n {
                q[along] += step
            } else {
                v[along - n] += step
            }
            (self.value(surface, &q, &v) - here).abs()
        };
        let own = if along < n { q[along] } else { self.v[along - n] };
        let mut step = own.abs().max(1.0);
        // Most variables move nothing here.
        if change(step) == 0.0 && change(ELSEWHERE * step) == 0.0 {
            return None;
        }
        for _ in 0..DECADES {
            if change(step) > wanted { step *= 0.1 } else { break }
        }
        for _ in 0..DECADES {
            if change(10.0 * step) <= wanted { step *= 10.0 } else { break }
        }
        let moved = change(step);
        (moved > 0.0 && moved <= wanted).then_some(step)
    }

    fn departed(&self, q: &[f64], departure: &Departure, part: f64) -> [Vec<f64>; 2] {
        let moved = |from: &[f64], by: &[f64]| from.iter().zip(by).map(|(x, by)| x + part * by).collect();
        [moved(q, &departure.by[0]), moved(&self.v, &departure.by[1])]
    }

    /// Whether slopes on both sides differ, however near.
    fn turns(&self, q: &[f64], departure: &Departure) -> bool {
        let [far, near] = [1.0, NEARER].map(|part| {
            [part, -part].map(|part| {
                let [q, v] = self.departed(q, departure, part);
                self.slopes_moving(&q, &v)
            })
        });
        let here = self.magnitudes(q);
        (0..2).any(|kind| {
            let value = |side: &[SparseMatrix; 2], k: usize| side[kind].entries[k].2;
            (0..near[0][kind].entries.len()).any(|k| {
                let difference = |pair: &[[SparseMatrix; 2]; 2]| (value(&pair[0], k) - value(&pair[1], k)).abs();
                let (row, column, above) = near[0][kind].entries[k];
                let size = above.abs().max(value(&near[1], k).abs());
                if !(difference(&near) > STRAIGHT * size && difference(&near) > FALLS * difference(&far)) {
                    return false;
                }
                let terms = self.slopes(q, column as usize, kind == 0, &here)[row as usize];
                difference(&near) > ROUNDINGS * terms
            })
        })
    }

    /// ∂F/∂q' and ∂F/∂q at a state, with switches on their sides there.
    fn slopes_moving(&self, q: &[f64], v: &[f64]) -> [SparseMatrix; 2] {
        self.sides_moving(q, v);
        let [_, damping, stiffness] = self.present_matrices_moving(q, v);
        [damping, stiffness]
    }
}
