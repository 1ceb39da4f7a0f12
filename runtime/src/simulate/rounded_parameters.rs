//! Parameters moved by their rounding.

use crate::mechanism::{At, System};
use crate::simulate::Settings;

/// The numbers next to those parameters that have a fraction, up or down by their last bit, so that equal ones stay equal; whole numbers have no
/// rounding.
///
/// Those that say when something happens stay, as the end of a pulse: moved by a rounding it would come after the end of a run, or after the
/// instant of a report.
pub(super) fn moved_parameters(system: &mut dyn System, settings: &Settings) -> Vec<f64> {
    let parameters = system.parameters();
    let usual = Instants::of(system, settings);
    let moved = |(index, value): (usize, &f64)| {
        if value.fract() == 0.0 {
            return *value;
        }
        let beside = f64::from_bits(value.to_bits() ^ 1);
        system.set_parameter(index, beside);
        let stays = Instants::of(system, settings) != usual;
        system.set_parameter(index, *value);
        if stays { *value } else { beside }
    };
    parameters.iter().enumerate().map(moved).collect()
}

/// What functions of events and discontinuities that time alone changes are at the start and at the end of a run, and the clocks.
#[derive(PartialEq)]
struct Instants {
    functions: Vec<Option<f64>>,
    clocks: Vec<[f64; 2]>,
}

impl Instants {
    fn of(system: &dyn System, settings: &Settings) -> Instants {
        let description = system.description();
        let (events, switches) = (description.events.len(), description.switches.len());
        let still = vec![0.0; system.len()];
        let rows = vec![0.0; description.rows.len()];
        let values = |t: f64, away: f64| {
            let beside = |y: &Vec<f64>| (1..).zip(y).map(|(k, y)| y + away * f64::from(k)).collect::<Vec<_>>();
            let [q, v] = [&settings.q, &settings.v].map(beside);
            let at = At::new(t, &q, &v).accelerated(&still).constrained(&rows);
            let mut pairs = vec![0.0; 2 * (events + switches)];
            let (of_events, of_switches) = pairs.split_at_mut(2 * events);
            system.events(at, of_events);
            system.switches(at, of_switches);
            pairs.into_iter().step_by(2).collect::<Vec<f64>>()
        };
        let functions = [settings.from, settings.until].into_iter().flat_map(|t| {
            let both = values(t, 0.0).into_iter().zip(values(t, 1.0));
            both.map(|(here, away)| (here == away).then_some(here)).collect::<Vec<_>>()
        });
        Instants { functions: functions.collect(), clocks: system.clocks() }
    }
}
