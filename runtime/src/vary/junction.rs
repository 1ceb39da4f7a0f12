//! Columns across an instant at which the equations change.

use super::NoSlopes;
use super::momenta::{momentum_slopes, rate_slopes};
use super::response::Response;
use crate::constrain::velocity_jump;
use crate::mechanism::dense::constraint_triples;
use crate::mechanism::{Along, At, Function, KktSolver, SwitchKind, System};
use crate::run::{Junction, Side, SpeedJump};

/// A guard whose rate is below this part of the sum of its terms, or of what the largest speeds of the motion would make of it, is touched and
/// not crossed: when it happens changes like a root of what varies.  Half of a motion's digits: those of the instant itself are lost there.
const TOUCHES: f64 = 1e-6;
/// Guards that are crossed together, and move apart by more than this part of what they move, decide by their order what follows.
const TOGETHER: f64 = 1e-6;
/// A speed is rounding below this part of the largest of the motion.
const ROUNDED: f64 = 1e-12;

/// Columns of a state: slopes of [q; q'], and the parameter that changes in each.
#[derive(Clone, Debug)]
pub(super) struct Column {
    pub y: Vec<f64>,
    pub parameter: Option<usize>,
    /// The size of what changes.
    pub size: f64,
}

impl Column {
    fn along(&self, n: usize) -> Along<'_> {
        Along { q: &self.y[..n], v: &self.y[n..], parameter: self.parameter, ..Along::default() }
    }
}

/// Something whose zero says when an instant is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Guard {
    Event(usize),
    Switch(usize),
}

impl Guard {
    fn function(self) -> (Function, usize) {
        match self {
            Guard::Event(k) => (Function::Events, 2 * k),
            Guard::Switch(k) => (Function::Switches, 2 * k),
        }
    }

    fn name(self, system: &dyn System) -> String {
        let description = system.description();
        match self {
            Guard::Event(k) => description.events[k].name.to_string(),
            Guard::Switch(k) => description.switches[k].text.to_string(),
        }
    }

    /// The slope of the guard along a direction.
    fn slope(self, system: &dyn System, at: At<'_>, along: &Along<'_>) -> f64 {
        let (function, place) = self.function();
        let description = system.description();
        let size = 2 * if function == Function::Events { description.events.len() } else { description.switches.len() };
        let mut slopes = vec![0.0; size];
        system.slopes(function, at, along, &mut slopes);
        slopes[place]
    }
}

/// Puts the modes and the phase of a side in force.
pub(crate) fn put(system: &mut dyn System, side: &Side) {
    system.set_phase(side.phase);
    system.set_modes(&side.modes);
}

/// Refuses a side on which the motion slides in a surface.
pub(crate) fn slides(system: &dyn System, t: f64) -> Result<(), NoSlopes> {
    match system.sliding().first() {
        Some(switch) => Err(NoSlopes::Rests { t, switch: system.description().switches[*switch].text.to_string() }),
        None => Ok(()),
    }
}

/// Takes columns across a junction, whose instant moves by δt = −δg/(dg/dt) with the guard g, the motion before and after it having the
/// rates f⁻ and f⁺, and R being what happens to the state: δy⁺ = ∂R (δy⁻ + f⁻ δt) − f⁺ δt.  Returns δt of each column.
///
/// Source: Aizerman and Gantmakher, Quarterly Journal of Mechanics and Applied Mathematics 11 (1958) 225 (the saltation matrix).
///
/// # Errors
/// Instants at which there is no such slope.
pub(super) fn cross(
    system: &mut dyn System,
    (junction, speeds): (&Junction, &[f64]),
    columns: &mut [Column],
    begins: bool,
) -> Result<Vec<f64>, NoSlopes> {
    let Junction { before, after, jumps, .. } = junction;
    let (t, n) = (before.t, system.len());
    put(system, before);
    let guards = guards(junction);
    let shifts = match begins {
        true => vec![0.0; columns.len()],
        false => shifts(system, (before, speeds), &guards, columns)?,
    };
    let mut response = Response::default();
    let fault = |fault: crate::mechanism::Singular, system: &dyn System| NoSlopes::Fault {
        t,
        cause: fault.cause(system.description()),
    };
    let at = At::packed(t, &before.y, n);
    response.stand(system, at).map_err(|f| fault(f, system))?;
    let rate = [&before.y[n..], &response.a].concat();
    for (column, shift) in columns.iter_mut().zip(&shifts) {
        column.y.iter_mut().zip(&rate).for_each(|(y, rate)| *y += shift * rate);
    }
    let mut y = before.y.clone();
    for jump in jumps {
        strike(system, (t, &mut y), jump, columns, &shifts)?;
    }
    let size = y[n..].iter().chain(&after.y[n..]).fold(0.0_f64, |most, v| most.max(v.abs()));
    // What has come to rest has speeds that are rounding of those that it had.
    let least = (TOGETHER * size).max(ROUNDED * speeds.iter().fold(0.0, |most, v| f64::max(most, *v)));
    let kicked = y[n..].iter().zip(&after.y[n..]).any(|(v, after)| (v - after).abs() > least);
    if kicked {
        return Err(NoSlopes::Kick { t });
    }
    put(system, after);
    slides(system, t)?;
    let rests = system
        .description()
        .switches
        .iter()
        .zip(&after.modes)
        .find(|(s, mode)| s.kind == SwitchKind::Sign && **mode == 0.0);
    if let Some((switch, _)) = rests {
        return Err(NoSlopes::Rests { t, switch: switch.text.to_string() });
    }
    response.stand(system, At::packed(after.t, &after.y, n)).map_err(|f| fault(f, system))?;
    let rate = [&after.y[n..], &response.a].concat();
    for (column, shift) in columns.iter_mut().zip(&shifts) {
        column.y.iter_mut().zip(&rate).for_each(|(y, rate)| *y -= shift * rate);
    }
    Ok(shifts)
}

/// What says when a junction is: events that act, else switches that change sides.
fn guards(junction: &Junction) -> Vec<Guard> {
    if !junction.events.is_empty() {
        return junction.events.iter().map(|event| Guard::Event(*event)).collect();
    }
    let modes = junction.before.modes.iter().zip(&junction.after.modes).enumerate();
    modes.filter(|(_, (before, after))| before != after).map(|(k, _)| Guard::Switch(k)).collect()
}

/// By how much each column moves the instant at which guards vanish, s, in a motion with these largest speeds; 0 without any.
///
/// # Errors
/// A guard that is touched; several that move apart.
pub(super) fn shifts(
    system: &dyn System,
    (side, speeds): (&Side, &[f64]),
    guards: &[Guard],
    columns: &[Column],
) -> Result<Vec<f64>, NoSlopes> {
    let mut found: Option<Vec<f64>> = None;
    for guard in guards {
        let shifts = shifts_of(system, (side, speeds), *guard, columns)?;
        if let Some(known) = &found {
            let size = known.iter().chain(&shifts).fold(0.0_f64, |most, x| most.max(x.abs()));
            if known.iter().zip(&shifts).any(|(known, shift)| (known - shift).abs() > TOGETHER * size) {
                let names = [guards[0], *guard].map(|guard| guard.name(system));
                return Err(NoSlopes::Together { t: side.t, events: names });
            }
        }
        found.get_or_insert(shifts);
    }
    Ok(found.unwrap_or_else(|| vec![0.0; columns.len()]))
}

fn shifts_of(
    system: &dyn System,
    (side, speeds): (&Side, &[f64]),
    guard: Guard,
    columns: &[Column],
) -> Result<Vec<f64>, NoSlopes> {
    let (t, n) = (side.t, system.len());
    let (q, v) = side.y.split_at(n);
    let plain = At::new(t, q, v);
    let mut response = Response::default();
    let fault = |fault: crate::mechanism::Singular| NoSlopes::Fault { t, cause: fault.cause(system.description()) };
    response.stand(system, plain).map_err(fault)?;
    let (a, lambda) = (response.a.clone(), response.lambda.clone());
    let at = plain.accelerated(&a).constrained(&lambda);
    let reads_reactions = matches!(guard, Guard::Event(_)) && system.description().events_use_accelerations;
    // Along a direction of (t, q, q', p), with what it does to accelerations and multipliers.
    let mut slope = |along: Along<'_>| -> Result<f64, NoSlopes> {
        if !reads_reactions {
            return Ok(guard.slope(system, at, &along));
        }
        response.along(system, plain, &along).map_err(fault)?;
        Ok(guard.slope(system, at, &Along { a: &response.da, lambda: &response.dlambda, ..along }))
    };
    let zero = vec![0.0; n];
    let clock = slope(Along { t: 1.0, ..Along::default() })?;
    let (mut rate, mut size, mut usual) = (clock, clock.abs(), clock.abs());
    for i in 0..n {
        let mut unit = zero.clone();
        unit[i] = 1.0;
        let by_place = slope(Along { q: &unit, ..Along::default() })?;
        let by_speed = slope(Along { v: &unit, ..Along::default() })?;
        let terms = [by_place * v[i], by_speed * a[i]];
        rate += terms[0] + terms[1];
        size += terms[0].abs() + terms[1].abs();
        usual += (by_place * speeds[i]).abs();
    }
    let size = size.max(usual);
    if rate.is_nan() || rate.abs() <= TOUCHES * size {
        return Err(NoSlopes::Touches { t, event: guard.name(system) });
    }
    columns.iter().map(|column| Ok(-slope(column.along(n))? / rate)).collect()
}

/// A jump of the speeds, M Δ = Jᵀ P with c'(q, q' + Δ) = −e c'(q, q'), and what it does to columns; e is 0 in rows without restitution.
fn strike(
    system: &dyn System,
    (t, y): (f64, &mut Vec<f64>),
    jump: &SpeedJump,
    columns: &mut [Column],
    shifts: &[f64],
) -> Result<(), NoSlopes> {
    let n = system.len();
    let restitutions = system.restitutions();
    let e = |row: usize| match &jump.hit {
        Some((rows, place)) if rows.contains(&row) => restitutions.get(*place).copied().unwrap_or(0.0),
        _ => 0.0,
    };
    let fault = |fault: crate::mechanism::Singular| NoSlopes::Fault { t, cause: fault.cause(system.description()) };
    let taken = velocity_jump(system, (t, y), &jump.rows, e).map_err(fault)?;
    let impulses: Vec<f64> = taken.rows.iter().map(|(_, impulse)| *impulse).collect();
    let rates: Vec<f64> = constraint_triples(system, At::packed(t, y, n)).iter().map(|triple| triple[1]).collect();
    let mut form = KktSolver::default();
    form.factor_rows(system, At::packed(t, y, n), &jump.rows).map_err(fault)?;
    let after: Vec<f64> = y[n..].iter().zip(&taken.jump).map(|(v, jump)| v + jump).collect();
    for (column, shift) in columns.iter_mut().zip(shifts) {
        let along = Along { t: *shift, ..column.along(n) };
        let mut moved = momentum_slopes(system, At::packed(t, y, n), &taken.jump, (&jump.rows, &impulses), &along);
        moved.iter_mut().for_each(|force| *force = -*force);
        let [before, behind] = [&y[n..], &after[..]].map(|v| rate_slopes(system, At::new(t, &y[..n], v), &along));
        let mut de = vec![0.0; restitutions.len()];
        system.slopes(Function::Restitutions, At::new(t, &y[..n], &after), &along, &mut de);
        let change = |row: usize| match &jump.hit {
            Some((rows, place)) if rows.contains(&row) => de[*place],
            _ => 0.0,
        };
        let mut right: Vec<f64> =
            jump.rows.iter().map(|&row| -(behind[row] + e(row) * before[row] + change(row) * rates[row])).collect();
        form.solve(&mut moved, &mut right);
        column.y[n..].iter_mut().zip(&moved).for_each(|(v, moved)| *v += moved);
    }
    y[n..].copy_from_slice(&after);
    Ok(())
}
