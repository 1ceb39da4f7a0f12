//! Seeded faults: every model with balances or claims is spoilt in one derivation at a time, and must then be refused.

#[path = "table.rs"]
mod table;

use dalembert_symbolic::derive::derive;
use dalembert_symbolic::gate::Gate;
use dalembert_symbolic::model::load;

#[test]
fn every_fault_that_changes_the_motion_is_refused() {
    let extent = table::Extent::Test;
    let outcomes = table::plant_all(extent, false);
    let held = table::held(extent);
    assert!(held.values().all(|(planted, refused)| planted == refused), "{held:?}");
    assert!(held.len() == 5 && held.values().all(|(planted, _)| *planted > 0), "{held:?}");
    let now = table::page(&outcomes, &table::smallest(extent), &held);
    println!("{now}");
    let wrong = table::wrong(&outcomes);
    assert!(wrong.is_empty(), "faults that were accepted, or sound models that were refused:\n{}", wrong.join("\n"));
    assert!(outcomes.len() > 1000, "only {} faults", outcomes.len());
    for model in ["four_bar", "chaplygin_sleigh", "stick_slip", "bouncing_ball", "eccentric_cylinder"] {
        let refused = outcomes.iter().filter(|o| o.is_caught(model)).count();
        assert!(refused > 10, "{model}: {refused}");
    }
    // The page's numbers go with the models; its parts and kinds of fault are held.
    let held = include_str!("../../../docs/faults.md");
    assert_eq!(frame(&now), frame(held), "regenerate docs/faults.md");
    for page in [now.as_str(), held] {
        assert!(page.contains("error[E502]") && page.contains("| 0 | 100.0 % |\n\nRefused by name"), "{page}");
    }
}

/// Headings, and what stands first in each line of a table.
fn frame(page: &str) -> Vec<&str> {
    let lines = page.lines().filter(|line| line.starts_with(['#', '|']));
    lines.map(|line| line.split(" | ").next().unwrap_or(line)).collect()
}

/// For each part of the gate a fault that it alone catches: accepted without it, refused with it.
#[test]
fn each_part_of_the_gate_earns_its_place() {
    let spindle = include_str!("scales/scales_spindle.yaml");
    let grain = include_str!("scales/scales_grain.yaml");
    let pad = include_str!("scales/scales_pad.yaml");
    let all = Gate::default();
    let faults = [
        (Gate { digits: false, ..all }, spindle, "F - c*x'\"\n", "F - 1.000000000001*c*x'\"\n"),
        (Gate { rows: false, ..all }, grain, "-k*(u - d) - c*u'\"", "-k*(u - d) + c*u'\""),
        // The rotor turns by a million radians; no number of the file says so.
        (Gate { motion: false, ..all }, spindle, "= T - b*phi'\"", "= T - b*phi' - T*step(phi - 300000)\""),
        // The motion does not come near the ditch.
        (Gate { sides: false, ..all }, pad, "- b*ditch*x'", "+ b*ditch*x'"),
    ];
    for (without, sound, right, wrong) in faults {
        assert!(sound.contains(right), "{right}");
        let derivation = |text: &str| derive(load(text, &[]).unwrap()).unwrap();
        assert!(all.judge(derivation(sound)).is_ok(), "{right}: refused, though sound");
        let spoilt = derivation(&sound.replacen(right, wrong, 1));
        assert!(all.judge(spoilt.clone()).is_err(), "{wrong}: accepted");
        assert!(without.judge(spoilt).is_ok(), "{wrong}: refused by {without:?} too");
    }
}
