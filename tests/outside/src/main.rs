//! Runs a mechanism of its own and prints numbers for the test that started it.

use dalembert::prelude::*;

dalembert::model!("models/swing.yaml");
dalembert::model!("models/swing.yaml", pushes = 1, name = OncePushed);

// Its warning is told by the compiler, unless it is silenced here or in the macro.
dalembert::model!("models/doubtful.yaml");
dalembert::model!("models/doubtful.yaml", name = Meant, warnings = "allow");
#[allow(deprecated)]
mod meant {
    dalembert::model!("models/doubtful.yaml", name = AllowedAround);
}

fn main() -> Result<(), dalembert::Error> {
    let swing = Swing { c: 0.0, push: 0.0, ..Default::default() };
    let free = swing.simulate().tolerance(1e-12).run()?;
    let turns: Vec<f64> = free.events.iter().map(|e| e.state.t).collect();
    println!("half period {:.9}", turns[1] - turns[0]);
    println!("balance {:e}", free.energy_balance.unwrap_or(f64::NAN));
    let pushed = Swing::default().simulate().run()?;
    let once = OncePushed { at: [1.0], ..Default::default() }.simulate().run()?;
    let plate = Doubtful::default().simulate().until(0.1).run()?;
    let same = Meant::default().simulate().until(0.1).run()?;
    let around = meant::AllowedAround::default().simulate().until(0.1).run()?;
    assert!(plate.last()["theta"] == same.last()["theta"] && same.last()["theta"] == around.last()["theta"]);
    println!("work {:.6} {:.6}", pushed.last()["theta"], once.last()["theta"]);
    Ok(())
}
