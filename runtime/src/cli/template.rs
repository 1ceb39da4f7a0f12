//! Runs the first scene of a model, and prints how far the motion can be trusted and where it ends.

use dalembert::prelude::*;

// Parameters are fields, in SI: `TypeName { l: 0.8, ..Default::default() }`.
dalembert::model!("models/model.yaml");

fn main() -> Result<(), dalembert::Error> {
    let run = TypeName::default().simulate().run()?;
    println!("{}", run.trust());
    println!("theta = {} rad at t = {} s", run.last()["theta"], run.last().t);
    Ok(())
}
