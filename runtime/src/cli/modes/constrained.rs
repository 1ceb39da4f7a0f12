//! `modes` of a mechanism with constraints: at rest and in steady motion in independent coordinates, shapes in all of the
//! file's; where constraints contain speeds without known integrals, by eigenvalues (`tangent.rs`).

use std::io::Write;

use clap::ArgMatches;
#[cfg(feature = "modal")]
use clap::parser::ValueSource;
use serde_json::json;

use super::super::load::Loaded;
use super::super::set_up::Reader;
use super::super::{Problem, json};
#[cfg(feature = "modal")]
use super::drive::Driven;
#[cfg(feature = "modal")]
use super::locus::Locus;
use super::model::Model;
use super::steady::Speeds;
#[cfg(feature = "modal")]
use super::tangent;
use super::trim::Trim;
use super::{FurtherAnswers, Place, bodies, failed, pictures, report, state_space};
#[cfg(feature = "modal")]
use super::{contacts::ContactsAtRest, integrals};
use crate::linear::{LinearError, linearise_constrained, short};
#[cfg(feature = "modal")]
use crate::linear::{linearise_driven, linearise_tangent, turns_as_a_whole};
use crate::mechanism::dense::mass_matrix;
use crate::mechanism::{At, Row};

/// Options that ask what a drive does.
#[cfg(feature = "modal")]
const DRIVES: [&str; 6] = ["drive", "omega", "bode", "response", "range", "state-space"];

/// The reaction of a row that is in force.
pub struct Reaction {
    /// `pin.x`.
    pub row: String,
    /// In SI; empty for a pure number and where it is not known.
    unit: String,
}

impl Reaction {
    /// `reaction(pin).x at rest = 3 N`.
    pub fn told(&self, when: &str, value: f64) -> String {
        let name = match self.row.rsplit_once('.') {
            Some((constraint, axis)) => format!("reaction({constraint}).{axis}"),
            None => format!("reaction({})", self.row),
        };
        let space = if self.unit.is_empty() { "" } else { " " };
        format!("{name} {when} = {}{space}{}", short(value), self.unit)
    }
}

/// The reactions of the rows in force.
pub fn reactions(loaded: &Loaded, reader: &mut Reader) -> Result<Vec<Reaction>, Problem> {
    let description = loaded.system.description();
    let rows = loaded.system.active_rows().iter().map(|row| &description.rows[*row as usize]);
    let reaction = |row: &Row| {
        let (constraint, part) = row.name.rsplit_once('.').unwrap_or((&*row.name, ""));
        // A joint's row that keeps its sides from turning carries a couple.
        let function = if part.starts_with("about") { "moment" } else { "reaction" };
        let unit = reader.model(loaded)?.unit_of(&format!("{function}({constraint})"));
        let unit = unit.map(|unit| dalembert_symbolic::print::si_unit(&unit)).unwrap_or_default();
        Ok(Reaction { row: row.name.to_string(), unit })
    };
    rows.map(reaction).collect()
}

/// Linearises at rest, or in steady motion with these speeds, and prints the modes.
pub fn run(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    (scene, speeds): (usize, &Speeds),
    place: &Place,
    out: &mut dyn Write,
) -> Result<(), Problem> {
    let system = &*loaded.system;
    let names = reactions(loaded, reader)?;
    let Place { guess, here, trim } = place;
    let found = match linearise_constrained(system, guess, *here) {
        // Friction made of reactions belongs to no K: it follows what the constraints carry.
        Err(
            why @ (LinearError::VelocityConstraint { .. }
            | LinearError::MovingConstraint { .. }
            | LinearError::FrictionOfReactions),
        ) => {
            if options.contains_id("motion") {
                let words = format!("--motion: {why}; `simulate` computes the motion itself");
                return Err(Problem::usage(words));
            }
            return by_departures(loaded, options, reader, speeds, place, &names, out);
        }
        #[cfg(feature = "modal")]
        Err(LinearError::NotSteady { .. }) if !options.contains_id("motion") && turns_as_a_whole(system, guess) => {
            return by_departures(loaded, options, reader, speeds, place, &names, out);
        }
        found => found.map_err(failed)?,
    };
    let mut modes = found.linear.modes().map_err(failed)?;
    bodies::name_free(loaded, &found.linear, Some(&found.motions), &mut modes)?;
    let model = Model::Held(&found);
    let further = FurtherAnswers::of(loaded, options, reader, (scene, speeds), model, &modes)?;
    let modes = found.in_all_coordinates(&modes);
    let mut written = Vec::new();
    pictures(loaded, options, &found.linear, &modes, &mut written)?;
    state_space::write(&loaded.name, options, || state_space::of_model(loaded, options, reader, model), &mut written)?;
    if state_space::goes_to_output(options)? {
        return Ok(out.write_all(&written)?);
    }
    if options.get_flag("json") {
        let reactions =
            names.iter().zip(&found.multipliers).map(|(row, value)| (row.row.clone(), json::number(*value)));
        let mut more = vec![("shape_coordinates", json!(found.coordinates)), ("reactions", json::object(reactions))];
        more.extend(further.as_json());
        more.extend(trim.iter().map(Trim::as_json));
        more.extend((!further.warnings.is_empty()).then(|| ("warnings", json!(further.warnings))));
        json::write(&report::as_json(&loaded.name, &found.linear, &modes, more), out)?;
        return Ok(());
    }
    let bodies = bodies::shares(loaded, &found.linear, &modes)?;
    let rest = &found.linear.equilibrium;
    let masses = mass_matrix(system, At::new(0.0, &rest.q, &rest.v)).diagonal();
    trim.iter().try_for_each(|trim| trim.table(&loaded.name, out))?;
    report::table(&loaded.name, (&found.linear, masses.as_slice()), &modes, &bodies, out)?;
    let rests = found.linear.equilibrium.v.iter().all(|v| *v == 0.0);
    for (row, value) in names.iter().zip(&found.multipliers) {
        writeln!(out, "{}", row.told(if rests { "at rest" } else { "there" }, *value))?;
    }
    further.table(model, out)?;
    Ok(out.write_all(&written)?)
}

#[cfg(feature = "modal")]
fn by_departures(
    loaded: &Loaded,
    options: &ArgMatches,
    reader: &mut Reader,
    speeds: &Speeds,
    Place { guess, here, trim }: &Place,
    names: &[Reaction],
    out: &mut dyn Write,
) -> Result<(), Problem> {
    if let Some(option) = ["plot", "animate", "mode"].iter().find(|option| options.contains_id(option)) {
        let words = format!("--{option} draws modes of oscillation; here there are eigenvalues only");
        return Err(Problem::usage(words));
    }
    let system = &*loaded.system;
    let found = linearise_tangent(system, guess, *here).map_err(failed)?;
    let locus = Locus::new(loaded, options, reader, &found.equilibrium, speeds)?;
    let asked = DRIVES.iter().find(|option| options.value_source(option) == Some(ValueSource::CommandLine));
    let at = match asked {
        None => None,
        Some(option) if found.equilibrium.v.iter().any(|v| *v != 0.0) => {
            let words = format!(
                "--{option}: where constraints contain speeds without known integrals, what drives is there for motions about rest, and \
                 this one goes on steadily"
            );
            return Err(Problem::usage(words));
        }
        Some(option) => match linearise_driven(system, &found.equilibrium.guess()) {
            Err(LinearError::FrictionOfReactions) => {
                let words = format!(
                    "--{option} is not there where forces are made of reactions, as friction is: they follow what the constraints carry"
                );
                return Err(Problem::usage(words));
            }
            found => Some(found.map_err(failed)?),
        },
    };
    let model = at.as_ref().map(Model::Held);
    let driven = model.map_or(Ok(None), |model| Driven::new(loaded, options, reader, model))?;
    let mut written = Vec::new();
    if let Some(model) = model {
        let space = || state_space::of_model(loaded, options, reader, model);
        state_space::write(&loaded.name, options, space, &mut written)?;
        if state_space::goes_to_output(options)? {
            return Ok(out.write_all(&written)?);
        }
    }
    let untried = integrals::notes(system, &found.equilibrium, locus.as_ref());
    let more = driven.iter().flat_map(Driven::notes).chain(locus.iter().flat_map(Locus::notes));
    let contacts = ContactsAtRest::of(system, &found.equilibrium.as_guess());
    for note in contacts.warnings.iter().cloned().chain(untried).chain(more) {
        eprintln!("warning: {note}");
    }
    if options.get_flag("json") {
        let more = driven.iter().flat_map(Driven::as_json).chain(locus.iter().map(Locus::as_json));
        let more = more.chain(trim.iter().map(Trim::as_json)).chain(contacts.as_json());
        return Ok(json::write(&tangent::as_json(&loaded.name, &found, names, more), out)?);
    }
    trim.iter().try_for_each(|trim| trim.table(&loaded.name, out))?;
    tangent::table(&loaded.name, &found, names, out)?;
    contacts.table(out)?;
    driven.zip(model).map_or(Ok(()), |(driven, model)| driven.table(model, out))?;
    locus.map_or(Ok(()), |locus| locus.table(out))?;
    Ok(out.write_all(&written)?)
}

#[cfg(not(feature = "modal"))]
fn by_departures(
    _: &Loaded,
    _: &ArgMatches,
    _: &mut Reader,
    _: &Speeds,
    _: &Place,
    _: &[Reaction],
    _: &mut dyn Write,
) -> Result<(), Problem> {
    Err(failed(LinearError::NeedsFeature { feature: "modal" }))
}
