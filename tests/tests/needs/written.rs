//! `needs/cord_rod.yaml` does what `needs/cord.yaml` does: angle, pull within 1.0e-3 of the range of each, still within 1.0e-3 m until
//! t = 5 s. `dalembert needs` wrote it; it was off by
//! 4.0e-1 of what is asked of pull then.

use dalembert::prelude::*;

dalembert::model!("needs/cord.yaml", name = Full);
dalembert::model!("needs/cord_rod.yaml", name = Smaller);

#[test]
fn the_smaller_model_does_what_the_full_one_does() {
    let every = 5.0 / 4000.0;
    let full = Full::default().simulate().every(every);
    let full = full.tolerance(1e-9).run().expect("the full model runs");
    let small = Smaller::default().simulate().every(every);
    let small = small.tolerance(1e-5).run().expect("the smaller model runs");
    for name in ["angle", "pull"] {
        let off = full.deviation(&small, name).expect("a column of both");
        assert!(off <= 1e-3, "{name} is off by {off:e} of its range");
    }
    let [one, other] = [&full, &small].map(|run| run.column("still").expect("a column of both"));
    let off = one.iter().zip(&other).fold(0.0_f64, |most, (one, other)| most.max((one - other).abs()));
    assert!(off <= 1e-3, "still is off by {off:e}");
}
