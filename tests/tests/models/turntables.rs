//! Masses in slots of turntables.

use dalembert_tests::case::Case;
use dalembert_tests::reference::Reference;

use super::near;

#[test]
fn a_free_turntable_follows_the_reference() {
    Case::new("slot_turntable_offset").tolerance(1e-13).compare(&Reference::load("B13"), &[], |_| 1e-10);
}

/// At theta = 0 the slot is below the axis, as the problem draws it.
#[test]
fn the_slot_passes_below_the_axis() {
    let start = Case::new("slot_turntable_offset").start("s", 0.0).run().first();
    near(start["slider.x"], 0.0, 1e-15);
    near(start["slider.y"], -0.5, 1e-15);
}

/// Part (c) of problem 20: the mass goes out, so the table's rate falls as 1/s² and its angle tends to a limit.
#[test]
fn theta_does_not_go_to_infinity() {
    let mut case = Case::new("slot_turntable_offset").scene("part_c");
    let (early, late) = (case.state_at(50.0), case.state_at(100.0));
    assert!(late["s"] > 1.9 * early["s"]);
    assert!(late["theta"] - early["theta"] < 0.05 && late["theta"] < 4.0, "{early:?} {late:?}");
}

#[test]
fn a_turntable_on_springs_follows_the_reference() {
    let mut case = Case::new("slot_turntable_springs").scene("offset").tolerance(1e-13);
    case.compare(&Reference::load("B13b"), &[], |_| 1e-10);
}

/// With the slot through the centre and the table held, the mass oscillates with √(k/m).
#[test]
fn through_the_centre_the_small_motions_are_apart() {
    let mut case = Case::new("slot_turntable_springs").start("theta", 0.0).tolerance(1e-13);
    near(case.state_at(2.0)["s"], 0.3 * (50.0_f64.sqrt() * 2.0).cos(), 1e-11);
    near(case.state_at(2.0)["theta"], 0.0, 1e-15);
    let mut case = Case::new("slot_turntable_springs").start("s", 0.0).tolerance(1e-13);
    near(case.state_at(2.0)["theta"], 0.4 * (10.0_f64.sqrt() * 2.0).cos(), 1e-11);
}
