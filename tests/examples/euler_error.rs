//! Draws the error of Euler's method against the number of steps (problem 1 of the course).
//!
//! `cargo run --release -p dalembert-tests --example euler_error [FILE.svg]`

use std::f64::consts::E;
use std::{env, fs, io};

use dalembert::mechanism::Real;
use dalembert::show::{Axis, Chart, Series, Style};
use dalembert_tests::euler::{Sum, errors};

fn main() -> io::Result<()> {
    let file = env::args().nth(1).unwrap_or_else(|| "euler_error.svg".to_owned());
    let chart =
        Chart::new("Euler's method, x' = x on [0, 1]", Axis::new("steps", "").log(), Axis::new("error", "").log())
            .with(dashed("truncation e/(2n)", 1..=26, |n| E / (2.0 * n)))
            .with(dashed("1.3 eps sqrt(n), f32", 1..=26, |n| 1.3 * f64::from(f32::EPSILON) / 2.0 * n.sqrt()))
            .with(dashed("1.3 eps sqrt(n), f64", 1..=26, |n| 1.3 * f64::EPSILON / 2.0 * n.sqrt()))
            .with(measured::<f64>("f64", 25, Sum::Plain))
            .with(measured::<f32>("f32", 25, Sum::Plain))
            .with(measured::<f32>("f32, compensated sums", 25, Sum::Compensated));
    fs::write(&file, chart.to_svg())?;
    println!("{file}");
    Ok(())
}

/// Total errors at powers of two up to this one; over a few neighbours where that is quick.
fn measured<S: Real + Into<f64>>(name: &str, last: u32, sum: Sum) -> Series {
    let points = (1..=last).map(|exponent| {
        let n = 1_u64 << exponent;
        let count = if exponent <= 20 { 9 } else { 1 };
        Some((n as f64, errors::<S>(n, count, sum).0))
    });
    Series::marked_line(name, points)
}

/// A law to compare with.
fn dashed(name: &str, exponents: std::ops::RangeInclusive<i32>, law: impl Fn(f64) -> f64) -> Series {
    let points = exponents.map(|exponent| f64::from(2.0_f32.powi(exponent))).map(|n| Some((n, law(n))));
    Series { style: Style::Dashed, ..Series::line(name, points) }
}
