//! Tables of numbers as comma-separated values.

/// A table as CSV (RFC 4180): one line of names, then one line per row.
///
/// Numbers have 17 significant digits, which carry an `f64` exactly.  A value that is absent or not
/// finite leaves its cell empty, and so does a column that is shorter than the longest.
///
/// ```
/// let text = dalembert::show::csv(&["t", "x"], &[vec![Some(0.0), Some(0.1)], vec![Some(1.0), None]]);
/// assert_eq!(text, "t,x\n0.0000000000000000e0,1.0000000000000000e0\n1.0000000000000001e-1,\n");
/// ```
pub fn csv<N: AsRef<str>>(names: &[N], columns: &[Vec<Option<f64>>]) -> String {
    let mut table = ::csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    let into_memory = "a vector in memory takes all that is written";
    table.write_record(names.iter().map(|name| name.as_ref())).expect(into_memory);
    for row in 0..columns.iter().map(Vec::len).max().unwrap_or(0) {
        table.write_record(columns.iter().map(|column| cell(column.get(row).copied().flatten()))).expect(into_memory);
    }
    String::from_utf8(table.into_inner().expect(into_memory)).expect("names and numbers are text")
}

fn cell(value: Option<f64>) -> String {
    value.filter(|x| x.is_finite()).map(|x| format!("{x:.16e}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reads_back_exactly() {
        let values = [std::f64::consts::PI, -1.0 / 3.0, 5e-324, f64::MAX, 0.1 + 0.2];
        let text = csv(&["x"], &[values.iter().map(|x| Some(*x)).collect()]);
        let back: Vec<f64> = text.lines().skip(1).map(|line| line.parse().unwrap()).collect();
        assert_eq!(back, values);
    }

    #[test]
    fn absent_values_leave_empty_cells() {
        let text =
            csv(&["t", "lambda"], &[vec![Some(0.0), Some(1.0), Some(2.0)], vec![None, Some(f64::NAN), Some(1.0)]]);
        let cells: Vec<&str> = text.lines().skip(1).map(|line| line.split(',').nth(1).unwrap()).collect();
        assert_eq!(cells, ["", "", "1.0000000000000000e0"]);
    }

    #[test]
    fn names_with_commas_are_quoted() {
        let text = csv(&["t", "s[1,2]"], &[vec![Some(0.0)], vec![Some(1.0)]]);
        assert_eq!(text.lines().next(), Some("t,\"s[1,2]\""));
    }
}
