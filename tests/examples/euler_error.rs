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
    let (double, double_rounding) = measured::<f64>(25, Sum::Plain);
    let (single, single_rounding) = measured::<f32>(25, Sum::Plain);
    let (compensated, _) = measured::<f32>(25, Sum::Compensated);
    let chart =
        Chart::new("Euler's method, x' = x on [0, 1]", Axis::new("steps", "").log(), Axis::new("error", "").log())
            .with(dashed("truncation e/(2n)", |n| E / (2.0 * n)))
            .with(dashed("1.3 eps sqrt(n), f32", |n| 1.3 * f64::from(f32::EPSILON) / 2.0 * n.sqrt()))
            .with(dashed("1.3 eps sqrt(n), f64", |n| 1.3 * f64::EPSILON / 2.0 * n.sqrt()))
            .with(Series::marked_line("f64", double))
            .with(Series::marks("f64, round-off alone", double_rounding))
            .with(Series::marked_line("f32", single))
            .with(Series::marks("f32, round-off alone", single_rounding))
            .with(Series::marked_line("f32, compensated sums", compensated));
    fs::write(&file, chart.to_svg())?;
    println!("{file}");
    Ok(())
}

type Points = Vec<Option<(f64, f64)>>;

/// Total errors and round-off alone near powers of two up to this one; over a few neighbours where that is quick.
fn measured<S: Real + Into<f64>>(last: u32, sum: Sum) -> (Points, Points) {
    let measure = |exponent| {
        let n = 1_u64 << exponent;
        let (total, rounding) = errors::<S>(n, if exponent <= 20 { 9 } else { 1 }, sum);
        (Some((n as f64, total)), Some((n as f64, rounding)))
    };
    (1..=last).map(measure).unzip()
}

/// A law to compare with.
fn dashed(name: &str, law: impl Fn(f64) -> f64) -> Series {
    let points = (1..=26).map(|exponent| f64::from(1_u32 << exponent)).map(|n| Some((n, law(n))));
    Series { style: Style::Dashed, ..Series::line(name, points) }
}
