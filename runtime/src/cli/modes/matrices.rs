//! `--matrices`: M, C, K, B and the state matrix A as files that other programs read.

use std::fmt::Write;
use std::path::Path;

use nalgebra::DMatrix;

use super::super::Problem;
use super::super::outputs;
use super::failed;
use crate::linear::Linearised;

/// Writes `NAME-M.EXT` and so on beside each other: Matrix Market where EXT is `mtx`, else a table without a head.
///
/// # Errors
/// A file that cannot be written; an M that has no inverse, for A.
pub fn write(path: &str, linear: &Linearised) -> Result<(), Problem> {
    let market = Path::new(path).extension().is_some_and(|extension| extension == "mtx");
    let state = linear.state_matrix().map_err(failed)?;
    let mut matrices = vec![("M", linear.m()), ("C", linear.c()), ("K", linear.k()), ("A", state)];
    if !linear.inputs.is_empty() {
        matrices.push(("B", linear.input.to_dense()));
    }
    for (name, matrix) in matrices {
        let words = format!("{name} of {}", meaning(name, linear));
        let text = if market { matrix_market(&matrix, &words) } else { table(&matrix) };
        outputs::write(&place(path, name), text)?;
    }
    Ok(())
}

/// `dir/chain.mtx` as `dir/chain-M.mtx`.
fn place(path: &str, name: &str) -> String {
    let path = Path::new(path);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or("csv".into(), |extension| extension.to_string_lossy());
    path.with_file_name(format!("{stem}-{name}.{extension}")).to_string_lossy().into_owned()
}

fn meaning(name: &str, linear: &Linearised) -> String {
    let coordinates = linear.coordinates.join(", ");
    match name {
        "A" => format!("z' = A z for z = (x, x'), x = ({coordinates}), SI"),
        "B" => format!(
            "M x'' + C x' + K x = B (u, u', u'') for x = ({coordinates}) and a triple for each of {}, SI",
            linear.inputs.join(", ")
        ),
        _ => format!("M x'' + C x' + K x = 0 for x = ({coordinates}), SI"),
    }
}

/// Coordinate format (Boisvert, Pozo and Remington 1996), general, entries column by column.
fn matrix_market(matrix: &DMatrix<f64>, words: &str) -> String {
    let entries: Vec<(usize, usize, f64)> = (0..matrix.ncols())
        .flat_map(|j| (0..matrix.nrows()).map(move |i| (i, j)))
        .map(|(i, j)| (i + 1, j + 1, matrix[(i, j)]))
        .filter(|entry| entry.2 != 0.0)
        .collect();
    let mut text = format!("%%MatrixMarket matrix coordinate real general\n% {words}\n");
    let _ = writeln!(text, "{} {} {}", matrix.nrows(), matrix.ncols(), entries.len());
    for (i, j, value) in entries {
        let _ = writeln!(text, "{i} {j} {value:e}");
    }
    text
}

fn table(matrix: &DMatrix<f64>) -> String {
    let line = |i: usize| (0..matrix.ncols()).map(|j| format!("{:e}", matrix[(i, j)])).collect::<Vec<_>>().join(",");
    (0..matrix.nrows()).map(|i| line(i) + "\n").collect()
}
