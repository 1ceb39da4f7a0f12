//! Runs a mechanism whose code is checked in, and prints the bits of its end for the test that started it.

use dalembert::prelude::*;

#[rustfmt::skip]
mod double_pendulum;

fn main() -> Result<(), dalembert::Error> {
    let run = double_pendulum::DoublePendulum::default().simulate().tolerance(1e-10).run()?;
    let end = run.last();
    let bits: Vec<String> = end.q.iter().chain(&end.v).map(|x| format!("{:016x}", x.to_bits())).collect();
    println!("{}", bits.join(" "));
    Ok(())
}
