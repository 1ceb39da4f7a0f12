//! A piece of a motion, and how its end changes with all of its start.

use super::flow::{Flow, Way, at_event, follow};
use super::junction::{Column, put, slides};
use super::response::Response;
use super::{NoSlopes, constraints};
use crate::error::Error;
use crate::mechanism::{At, System};
use crate::run::{Run, Side};
use crate::simulate::{Settings, settled, simulate};

/// Newton steps by which a guess is brought to the constraints.
const TO_CONSTRAINTS: usize = 4;

/// A piece of a motion from a state near to the constraints, which was brought to them by the least change in the metric of M.
pub(crate) struct Leg {
    pub run: Run,
    /// Its start.
    pub start: Side,
    /// The rate of [q; q'] there.
    pub start_rate: Vec<f64>,
    /// What each number of the guess makes of the start.
    pub projection: Vec<Vec<f64>>,
    /// Its end, after all that happens there.
    pub end: Side,
    /// The rate of [q; q'] there; 0 where an event ends it.
    pub end_rate: Vec<f64>,
    /// What each number of the guess, then each parameter, makes of the end.
    pub columns: Vec<Vec<f64>>,
}

/// Runs a piece of a motion that ends at a time or, as `ends_after` says, with an event, with the slopes of its end by all of its start
/// and by parameters.
///
/// # Errors
/// Those of [`simulate`]; [`Error::NoSlopes`].
pub(crate) fn leg(system: &mut dyn System, settings: &Settings, parameters: &[usize]) -> Result<Leg, Error> {
    let n = system.len();
    let fault = |system: &dyn System, fault: crate::mechanism::Singular| NoSlopes::Fault {
        t: settings.from,
        cause: fault.cause(system.description()),
    };
    let settings = &*settled(system, settings);
    system.set_phase(settings.phase);
    let (guess, projection) = on_constraints(system, settings).map_err(|f| fault(system, f))?;
    let settings = &Settings {
        q: guess[..n].to_vec(),
        v: guess[n..].to_vec(),
        held_q: Vec::new(),
        held_v: Vec::new(),
        spins: Vec::new(),
        start_conditions: 0..0,
        junctions: true,
        apart: false,
        every: None,
        digits: false,
        ..settings.clone()
    };
    let run = simulate(system, settings)?;
    let start = run.rows[..2 * n].to_vec();
    system.set_phase(settings.phase);
    let first = run.junctions.first().map_or_else(|| system.modes().to_vec(), |junction| junction.before.modes.clone());
    let side = Side { t: settings.from, y: start, modes: first, phase: settings.phase };
    put(system, &side);
    slides(system, side.t)?;
    let mut response = Response::default();
    let mut rate = |system: &dyn System, side: &Side| -> Result<Vec<f64>, NoSlopes> {
        response.stand(system, At::packed(side.t, &side.y, n)).map_err(|f| fault(system, f))?;
        Ok([&side.y[n..], &response.a].concat())
    };
    let start_rate = rate(system, &side)?;
    let of_start =
        projection.iter().zip(&side.y).map(|(y, x)| Column { y: y.clone(), parameter: None, size: size(*x) });
    let of_parameters = parameters.iter().map(|k| Column {
        y: vec![0.0; 2 * n],
        parameter: Some(*k),
        size: size(system.parameters().get(*k).copied().unwrap_or(0.0)),
    });
    let columns: Vec<Column> = of_start.chain(of_parameters).collect();
    let end = run.times.last().copied().unwrap_or(settings.from);
    let tolerance = settings.tolerance.max(Settings::TIGHTEST);
    let way = Way { tolerance, max_steps: settings.max_steps, interruption: &settings.interruption, times: &[end] };
    let list: Vec<Option<usize>> = columns.iter().map(|column| column.parameter).collect();
    let Flow { mut moments, shifts, .. } = follow(system, &run, (side.clone(), columns), &way)?;
    let mut numbers = moments.pop().map(|moment| moment.columns).unwrap_or_default();
    let mut columns: Vec<Vec<f64>> = numbers.split_off(1.min(numbers.len()));
    let last = run.junctions.last().filter(|junction| junction.after.t == end);
    let y = numbers.pop().unwrap_or_default();
    let end = match last {
        Some(junction) => Side { y, ..junction.after.clone() },
        None => Side { t: end, y, modes: system.modes().to_vec(), phase: system.phase() },
    };
    let mut end_rate = rate(system, &end)?;
    let ended = settings.ends_after.filter(|event| last.is_some_and(|junction| junction.events.contains(event)));
    if let Some(event) = run.ended_by {
        let parts =
            columns.iter().zip(&list).map(|(y, parameter)| Column { y: y.clone(), parameter: *parameter, size: 1.0 });
        let mut parts: Vec<Column> = parts.collect();
        at_event(system, (&end, &run), event, &mut parts)?;
        columns = parts.into_iter().map(|column| column.y).collect();
        end_rate.fill(0.0);
    } else if ended.is_some() {
        // The state that the event leaves, when it happens.
        for (column, shift) in columns.iter_mut().zip(&shifts) {
            column.iter_mut().zip(&end_rate).for_each(|(y, rate)| *y += shift * rate);
        }
        end_rate.fill(0.0);
    }
    Ok(Leg { run, start: side, start_rate, projection, end, end_rate, columns })
}

/// How large something is that varies; 1 of what is 0.
fn size(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { x.abs() }
}

/// A start that is a guess, on the constraints in force, and what each of its numbers makes of it.
fn on_constraints(
    system: &dyn System,
    settings: &Settings,
) -> Result<(Vec<f64>, Vec<Vec<f64>>), crate::mechanism::Singular> {
    let n = system.len();
    let unit = |k: usize| (0..2 * n).map(move |i| f64::from(u8::from(i == k)));
    let half = |part: usize| {
        let guess = if part == 0 { &settings.q } else { &settings.v };
        let columns = (0..2 * n).flat_map(move |k| unit(k).skip(part * n).take(n));
        guess.iter().copied().chain(columns)
    };
    let mut y: Vec<f64> = half(0).chain(half(1)).collect();
    if !system.active_rows().is_empty() {
        let columns = vec![None; 2 * n];
        let mut alone = [settings.q.as_slice(), &settings.v].concat();
        for _ in 0..TO_CONSTRAINTS {
            constraints::project(system, &[], &mut Response::default(), settings.from, &mut alone)?;
        }
        let width = n * (2 * n + 1);
        y[..n].copy_from_slice(&alone[..n]);
        y[width..width + n].copy_from_slice(&alone[n..]);
        constraints::project(system, &columns, &mut Response::default(), settings.from, &mut y)?;
    }
    let (places, rates) = y.split_at(n * (2 * n + 1));
    let mut list = places.chunks_exact(n.max(1)).zip(rates.chunks_exact(n.max(1))).map(|(q, v)| [q, v].concat());
    let state = list.next().unwrap_or_default();
    Ok((state, list.collect()))
}
