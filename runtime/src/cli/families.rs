//! `orbit --vary`: a family of motions that repeat, as text and JSON.

use std::io::Write;

use clap::ArgMatches;
use serde_json::{Value as Json, json};

use super::Problem;
use super::json::{number, object, write_outcome};
use super::load::Loaded;
use super::orbit::{json_multipliers, multipliers, unless_broken_off};
use crate::numbers::{counted, short};
use crate::orbit::{Family, Member, OrbitChange, Peak, Threshold};
use crate::run::written;

/// Prints a family.
pub fn report(loaded: &Loaded, family: &Family, options: &ArgMatches, out: &mut dyn Write) -> Result<(), Problem> {
    if options.get_flag("json") {
        return write_outcome(as_json(loaded, family), unless_broken_off(family.interrupted), out);
    }
    let (count, map) = (counted(family.members.len(), "motion"), family.map_in_words());
    writeln!(out, "{}: {count} by `{}`; multipliers of {map}", loaded.name, family.name)?;
    writeln!(out, "  {:>14}  {:>14}  {:<8}  multipliers", family.name, "period, s", "")?;
    for member in &family.members {
        let grows = member.multipliers.iter().any(|multiplier| multiplier.grows());
        let rounded: Vec<_> = member.multipliers.iter().map(|multiplier| multiplier.to_digits(1e-6)).collect();
        writeln!(
            out,
            "  {:>14}  {:>14}  {:<8}  {}",
            short(member.value),
            short(member.period),
            if grows { "unstable" } else { "stable" },
            multipliers(&rounded)
        )?;
    }
    for threshold in &family.thresholds {
        let what = match threshold.kind {
            OrbitChange::Fold => "the family turns back",
            OrbitChange::Branch => "a multiplier passes 1: another family crosses",
            OrbitChange::Doubling => "a multiplier passes -1: motions of two laps branch off",
            OrbitChange::SymmetryBreaking => {
                "a multiplier passes -1: motions without the symmetry of the map branch off, and the period stays"
            }
            OrbitChange::Pair => {
                "a pair of multipliers leaves the unit circle: motions round a torus, which are not followed"
            }
        };
        let error = if threshold.error.is_nan() { f64::INFINITY } else { threshold.error };
        writeln!(out, "{:<14} {} = {}: {what}", threshold.kind.word(), family.name, written(threshold.value, error))?;
    }
    for peak in &family.peaks {
        let error = if peak.error.is_nan() { f64::INFINITY } else { peak.error };
        let value = written(peak.value, error);
        writeln!(
            out,
            "{:<14} {} = {value}: `{}` goes farthest, {}",
            "peak",
            family.name,
            peak.of,
            short(peak.amplitude)
        )?;
    }
    if let Some(why) = &family.ended {
        writeln!(out, "ended          {why}")?;
    }
    Ok(())
}

fn as_json(loaded: &Loaded, family: &Family) -> Json {
    let member = |member: &Member| {
        let list = |values: &[f64]| {
            object(family.names.iter().zip(values).map(|(name, value)| (name.clone(), number(*value))))
        };
        json!({
            "value": number(member.value),
            "period": number(member.period),
            "start": list(&member.start),
            "amplitudes": list(&member.amplitudes),
            "multipliers": json_multipliers(&member.multipliers),
            "asked": member.asked,
        })
    };
    let threshold = |threshold: &Threshold| {
        json!({
            "kind": threshold.kind.word(),
            "value": number(threshold.value),
            "error": number(threshold.error),
            "member": member(&threshold.member),
        })
    };
    let peak = |peak: &Peak| {
        json!({
            "of": peak.of,
            "value": number(peak.value),
            "error": number(peak.error),
            "amplitude": number(peak.amplitude),
            "member": member(&peak.member),
        })
    };
    object([
        ("model", json!(loaded.name)),
        ("varies", json!(family.name)),
        ("map", json!({"part": family.part, "does": family.map})),
        ("members", Json::Array(family.members.iter().map(member).collect())),
        ("thresholds", Json::Array(family.thresholds.iter().map(threshold).collect())),
        ("peaks", Json::Array(family.peaks.iter().map(peak).collect())),
        ("ended", json!(family.ended)),
    ])
}
