//! Motions without stiffness: those of the whole as a rigid body, told apart from mechanisms.

use nalgebra::{Complex, DMatrix, DVector};

use super::matrices::{Scaled, Singular};
use super::{Kind, LinearError, Linearised, Mode};

/// A part of the mechanism, as its linear motion sees it.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Its mass, kg.
    pub mass: f64,
    /// Where its centre of mass is, two or three components, m.
    pub position: Vec<f64>,
    /// The velocity of its centre of mass as a function of the speeds, as many rows as components.
    pub velocity: DMatrix<f64>,
    /// Its angular velocity likewise: a row in the plane, three in space, none of a particle.
    pub turning: DMatrix<f64>,
    /// Its part of M, kg per squares of the coordinates' units.
    pub inertia: DMatrix<f64>,
}

/// Motions of a part count as those of a rigid body up to this.
const RIGID: f64 = 1e-9;

/// Gives the modes without stiffness bases of their own, orthonormal in M: translations along the axes and rotations
/// about the centre of mass first, then mechanisms, each with its name.
///
/// A rigid motion is a combination of them in which every part moves as one body does; where only some combinations of
/// translations and rotations are free (a cart, a hinge) those are named by their axis or their pole.
///
/// What has kinetic energy and is no part rests in them; only a translation may take along coordinates that are lengths, and a rotation ones
/// that are angles, since nothing tells where these are.  Other motions in which it moves have no name.
///
/// # Errors
/// [`LinearError::WrongSize`] for a part with other sizes; [`LinearError::NoConvergence`].
pub fn name_free_modes(linear: &Linearised, parts: &[Part], modes: &mut [Mode]) -> Result<(), LinearError> {
    let n = linear.len();
    let free: Vec<usize> = (0..modes.len()).filter(|k| modes[*k].kind == Kind::Rigid).collect();
    let Some(first) = parts.first() else { return Ok(()) };
    if free.is_empty() {
        return Ok(());
    }
    let dimension = first.position.len();
    for part in parts {
        let sizes = [(part.velocity.ncols(), n), (part.velocity.nrows(), dimension), (part.position.len(), dimension)];
        if let Some((given, expected)) = sizes.into_iter().find(|(given, expected)| given != expected) {
            return Err(LinearError::WrongSize { what: "a part of the mechanism", given, expected });
        }
    }
    let null = DMatrix::from_fn(n, free.len(), |i, k| modes[free[k]].shape[i].re);
    let body = Body::new(parts, dimension);
    let beside = Beside::new(linear, parts);
    // What only parts move in.
    let bodies_alone = beside.at_rest(&null)?;
    let mut basis = Basis { mass: linear.m(), shapes: Vec::new() };
    for (name, motion) in body.standard() {
        let kind = if name.starts_with("translation") { "m" } else { "rad" };
        let shape = match body.shape_of(&bodies_alone, &motion)? {
            None => body.shape_of(&null, &motion)?.filter(|shape| beside.moves_only(linear, shape, kind)),
            found => found,
        };
        shape.into_iter().for_each(|shape| basis.add(Some(name.clone()), &shape));
    }
    for (name, shape) in body.others(&bodies_alone)? {
        basis.add(Some(name), &shape);
    }
    basis.complete(&bodies_alone, |place| Some(format!("mechanism {place}")));
    basis.complete(&null, |_| None);
    let basis = basis.shapes;
    if basis.len() < free.len() {
        return Ok(());
    }
    for (k, (name, shape)) in free.into_iter().zip(basis) {
        let shape = shape.iter().map(|x| Complex::new(*x, 0.0)).collect();
        let what = (0.0, None, Complex::new(0.0, 0.0), Kind::Rigid);
        modes[k] =
            Mode { name, repeated: modes[k].repeated, ..Mode::new(shape, &linear.mass, &linear.coordinates, what) };
    }
    Ok(())
}

/// Shapes that are orthonormal in M, with their names.
struct Basis {
    mass: DMatrix<f64>,
    shapes: Vec<(Option<String>, DVector<f64>)>,
}

/// What is left of a shape beside others is one of its own from this part on.
const OF_ITS_OWN: f64 = 1e-6;

impl Basis {
    /// Adds what the others leave of a shape, if there is something.
    fn add(&mut self, name: Option<String>, shape: &DVector<f64>) {
        let mut left = shape.clone();
        for _ in 0..2 {
            self.take_out(&mut left);
        }
        let [whole, rest] = [shape, &left].map(|x| x.dot(&(&self.mass * x)).max(0.0).sqrt());
        if rest > OF_ITS_OWN * whole && rest > 0.0 {
            self.shapes.push((name, left / rest));
        }
    }

    fn take_out(&self, shape: &mut DVector<f64>) {
        for (_, known) in &self.shapes {
            let along = known.dot(&(&self.mass * &*shape));
            *shape -= known * along;
        }
    }

    /// Adds what is left over of a space; each shape begins with the coordinate that moves most in it.
    fn complete(&mut self, space: &DMatrix<f64>, name: impl Fn(usize) -> Option<String>) {
        let (n, before) = (space.nrows(), self.shapes.len());
        for place in 1..=space.ncols() {
            let columns: Vec<DVector<f64>> = space.column_iter().map(|column| column.into_owned()).collect();
            let left = columns.into_iter().map(|mut column| {
                self.take_out(&mut column);
                column
            });
            let left = DMatrix::from_columns(&left.collect::<Vec<_>>());
            // In the metric of M, the projection of each coordinate's axis on what is left.
            let size = |i: usize| left.row(i).norm() * self.mass[(i, i)].max(0.0).sqrt();
            let most = (0..n).map(size).fold(0.0, f64::max);
            let Some(leader) = (0..n).find(|i| size(*i) > (1.0 - OF_ITS_OWN) * most) else { return };
            self.add(name(place), &(&left * left.row(leader).transpose()));
            if self.shapes.len() < before + place {
                return;
            }
        }
    }
}

/// What has kinetic energy beside the parts: their M taken from all of M.
struct Beside {
    mass: DMatrix<f64>,
}

impl Beside {
    fn new(linear: &Linearised, parts: &[Part]) -> Beside {
        Beside { mass: parts.iter().fold(linear.m(), |mass, part| mass - &part.inertia) }
    }

    /// The combinations of shapes, which are orthonormal in M, in which it rests.
    fn at_rest(&self, shapes: &DMatrix<f64>) -> Result<DMatrix<f64>, LinearError> {
        let Some(singular) = Singular::of(&(shapes.transpose() * &self.mass * shapes)) else {
            return Err(LinearError::NoConvergence { what: "the singular value decomposition of rigid motions" });
        };
        Ok(shapes * singular.directions(|share| share <= RIGID))
    }

    /// True where only coordinates of this unit have energy of it.
    fn moves_only(&self, linear: &Linearised, shape: &DVector<f64>, unit: &str) -> bool {
        let other = DVector::from_fn(shape.len(), |i, _| if linear.units[i] == unit { 0.0 } else { shape[i] });
        other.dot(&(&self.mass * &other)).abs() <= RIGID * shape.dot(&(linear.m() * shape))
    }
}

/// All parts as if they were one body.
struct Body<'a> {
    parts: &'a [Part],
    dimension: usize,
    centre: Vec<f64>,
    /// A length that makes rotations comparable with translations, m.
    extent: f64,
}

impl<'a> Body<'a> {
    fn new(parts: &'a [Part], dimension: usize) -> Self {
        // Where nothing has mass, only inertia, any centre does.
        let has_mass = parts.iter().any(|part| part.mass > 0.0);
        let weight = |part: &Part| if has_mass { part.mass } else { 1.0 };
        let total: f64 = parts.iter().map(weight).sum();
        let mean = |c: usize| -> f64 { parts.iter().map(|part| weight(part) * part.position[c]).sum::<f64>() / total };
        let centre: Vec<f64> = (0..dimension).map(mean).collect();
        let apart = |part: &Part| -> f64 {
            part.position.iter().zip(&centre).map(|(x, c)| (x - c).powi(2)).sum::<f64>().sqrt()
        };
        let extent = parts.iter().map(apart).fold(0.0, f64::max);
        Body { parts, dimension, centre, extent: if extent > 0.0 { extent } else { 1.0 } }
    }

    fn rotations(&self) -> usize {
        if self.dimension == 2 { 1 } else { 3 }
    }

    /// Translations along the axes, then rotations about the centre of mass: (velocity, angular velocity).
    fn standard(&self) -> Vec<(String, DVector<f64>)> {
        let count = self.dimension + self.rotations();
        let unit = |k: usize| DVector::from_fn(count, |i, _| f64::from(u8::from(i == k)));
        let axes = ["x", "y", "z"];
        let translations = (0..self.dimension).map(|k| (format!("translation along {}", axes[k]), unit(k)));
        let turn = |k: usize| match self.dimension {
            2 => "rotation about the centre of mass".to_owned(),
            _ => format!("rotation about the centre of mass, along {}", axes[k]),
        };
        let rotations = (0..self.rotations()).map(|k| (turn(k), unit(self.dimension + k) / self.extent));
        translations.chain(rotations).collect()
    }

    /// The velocities and angular velocities of all parts in motions of one body: columns as in `standard`.
    fn fields(&self) -> DMatrix<f64> {
        let standard: Vec<DVector<f64>> = self.standard().into_iter().map(|(_, motion)| motion).collect();
        let columns: Vec<DVector<f64>> = standard.iter().map(|motion| self.field(motion)).collect();
        DMatrix::from_columns(&columns)
    }

    fn field(&self, motion: &DVector<f64>) -> DVector<f64> {
        let d = self.dimension;
        let mut list = Vec::new();
        for part in self.parts {
            let arm: Vec<f64> = part.position.iter().zip(&self.centre).map(|(x, c)| x - c).collect();
            if d == 2 {
                list.extend([motion[0] - motion[2] * arm[1], motion[1] + motion[2] * arm[0]]);
            } else {
                let w = [motion[3], motion[4], motion[5]];
                list.extend([
                    motion[0] + w[1] * arm[2] - w[2] * arm[1],
                    motion[1] + w[2] * arm[0] - w[0] * arm[2],
                    motion[2] + w[0] * arm[1] - w[1] * arm[0],
                ]);
            }
            list.extend((0..part.turning.nrows()).map(|k| motion[d + k] * self.extent));
        }
        DVector::from_vec(list)
    }

    /// The same of motions of the mechanism.
    fn velocities(&self, shapes: &DMatrix<f64>) -> DMatrix<f64> {
        let blocks: Vec<DMatrix<f64>> = self
            .parts
            .iter()
            .flat_map(|part| [&part.velocity * shapes, &part.turning * shapes * self.extent])
            .collect();
        let rows = blocks.iter().map(DMatrix::nrows).sum();
        let mut all = DMatrix::zeros(rows, shapes.ncols());
        let mut row = 0;
        for block in blocks {
            all.view_mut((row, 0), block.shape()).copy_from(&block);
            row += block.nrows();
        }
        all
    }

    /// The combination of free motions in which the parts have exactly these velocities.
    fn shape_of(&self, null: &DMatrix<f64>, motion: &DVector<f64>) -> Result<Option<DVector<f64>>, LinearError> {
        if null.ncols() == 0 {
            return Ok(None);
        }
        let (velocities, wanted) = (self.velocities(null), self.field(motion));
        let square = velocities.transpose() * &velocities;
        let Some(singular) = Singular::of(&square) else {
            return Err(LinearError::NoConvergence { what: "the singular value decomposition of rigid motions" });
        };
        let threshold = Scaled::threshold(null.ncols(), singular.values.max());
        let parts = singular.least_squares(&(velocities.transpose() * &wanted), threshold);
        let missed = (&velocities * &parts - &wanted).norm();
        Ok((missed <= RIGID * wanted.norm()).then(|| null * parts))
    }

    /// Rigid motions that are combinations of translations and rotations only, named by axis or pole.
    fn others(&self, null: &DMatrix<f64>) -> Result<Vec<(String, DVector<f64>)>, LinearError> {
        let (velocities, fields) = (self.velocities(null), self.fields());
        let (f, r) = (velocities.ncols(), fields.ncols());
        let scales = DVector::from_fn(f + r, |k, _| {
            let column = if k < f { velocities.column(k).norm() } else { fields.column(k - f).norm() };
            if column > 0.0 { 1.0 / column } else { 1.0 }
        });
        let both = DMatrix::from_fn(velocities.nrows(), f + r, |i, k| {
            scales[k] * if k < f { velocities[(i, k)] } else { -fields[(i, k - f)] }
        });
        let square = both.transpose() * &both;
        let Some(singular) = Singular::of(&square) else {
            return Err(LinearError::NoConvergence { what: "the singular value decomposition of rigid motions" });
        };
        let common = singular.directions(|value| value <= RIGID * RIGID.sqrt());
        let mut list = Vec::new();
        for column in common.column_iter() {
            let column = column.component_mul(&scales);
            let motion = column.rows(f, r).into_owned();
            let shape = null * column.rows(0, f);
            if shape.norm() > 0.0 && motion.norm() > 0.0 {
                list.push((self.name(&motion), shape));
            }
        }
        Ok(list)
    }

    fn name(&self, motion: &DVector<f64>) -> String {
        use super::{short, short_beside};
        let d = self.dimension;
        let translation: Vec<f64> = (0..d).map(|k| motion[k]).collect();
        // Column k of `fields` turns by 1/extent.
        let turn: Vec<f64> = (0..self.rotations()).map(|k| motion[d + k] / self.extent).collect();
        let size = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
        let list = |x: &[f64], scale: f64| {
            let texts: Vec<String> = x.iter().map(|x| short_beside(*x, 1e3 * scale)).collect();
            format!("[{}]", texts.join(", "))
        };
        if size(&turn) * self.extent <= 1e-9 * size(&translation) {
            let length = size(&translation);
            let unit: Vec<f64> = translation.iter().map(|x| x / length).collect();
            return format!("translation along {}", list(&unit, 1.0));
        }
        if d == 2 {
            let (x, y) = (self.centre[0] - translation[1] / turn[0], self.centre[1] + translation[0] / turn[0]);
            return format!("rotation about {}", list(&[x, y], self.extent));
        }
        let length = size(&turn);
        let unit: Vec<f64> = turn.iter().map(|x| x / length).collect();
        let along: f64 = translation.iter().zip(&turn).map(|(t, w)| t * w).sum::<f64>() / (length * length);
        match along.abs() <= 1e-9 * self.extent {
            true => format!("rotation along {}", list(&unit, 1.0)),
            false => format!("screw along {}, {} m a radian", list(&unit, 1.0), short(along)),
        }
    }
}
