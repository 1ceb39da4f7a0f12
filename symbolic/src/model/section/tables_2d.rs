//! Tables of two arguments: values on a grid, listed in the model file or in three columns of a file beside it.

use super::tables::Scale;
use crate::diagnose::catalogue::sections;
use crate::expr::{Grid, Table2d};
use crate::file::Spot;
use crate::model::expression::scope::{TableKind, TableNames};
use crate::model::resolver::Resolver;

/// What the points of a table of two arguments say.
const KEYS: [&str; 3] = ["x", "y", "values"];

/// Whether an entry describes a table of two arguments: its points are a grid, or it names three columns.
pub(super) fn has_two_arguments(spot: &Spot<'_>) -> bool {
    let grid = spot.get("points").is_some_and(|points| points.is_mapping());
    grid || spot.get("columns").and_then(|columns| columns.items()).is_some_and(|columns| columns.len() == 3)
}

impl Resolver<'_> {
    /// A table of two arguments.
    pub(super) fn read_table_2d(&mut self, name: &str, spot: &Spot<'_>) -> Option<TableNames> {
        let before = self.builder.problems.len();
        let smooth = self.smooth(spot);
        let periodic = self.periodic_arguments(spot);
        let [of_x, of_y, gives] = self.scales(spot)?;
        let grid = match (spot.get("points"), spot.get("file")) {
            (Some(points), None) => self.listed_grid(name, &points)?,
            (None, Some(file)) => {
                let lines = self.lines_of_file(spot, &file)?;
                match grid_of(&lines) {
                    Ok(grid) => grid,
                    Err((why, help)) => {
                        self.builder.problems.push(sections::bad_table(file.place, name, why, help));
                        return None;
                    }
                }
            }
            _ => return self.without_points(spot),
        };
        let at = spot.get("points").or_else(|| spot.get("file")).map(|spot| spot.place).unwrap_or_default();
        let scaled = in_si(&grid, [&of_x, &of_y, &gives]);
        if let Some((why, help)) = unfit(&grid, periodic).or_else(|| unfit(&scaled, periodic)) {
            self.builder.problems.push(sections::bad_table(at, name, why, help));
            return None;
        }
        let table = Table2d::new(name, &scaled, smooth, periodic);
        if !table.pieces().iter().flatten().flatten().all(|coefficient| coefficient.is_finite()) {
            let help = "its points are too near to each other for what they differ by";
            self.builder.problems.push(sections::bad_table(at, name, "it is too steep for numbers of 64 bits", help));
        }
        let names =
            TableNames { table: TableKind::Two(table), of: vec![of_x.measure, of_y.measure], gives: gives.measure };
        (self.builder.problems.len() == before).then_some(names)
    }

    /// In which arguments it repeats itself: `x`, `y`, or `true` for both.
    fn periodic_arguments(&mut self, spot: &Spot<'_>) -> [bool; 2] {
        let Some(periodic) = spot.get("periodic") else { return [false; 2] };
        let problems = &mut self.builder.problems;
        match periodic.words(problems) {
            Some("true") => [true; 2],
            Some("x") => [true, false],
            Some("y") => [false, true],
            Some("false") | None => [false; 2],
            Some(other) => {
                let help = "x or y where it repeats itself in one argument, true in both";
                problems.push(sections::unknown_choice(periodic.place, other, "x, y, true or false", help));
                [false; 2]
            }
        }
    }

    /// `{x: […], y: […], values: [[…], …]}`.
    fn listed_grid(&mut self, name: &str, spot: &Spot<'_>) -> Option<Grid> {
        let before = self.builder.problems.len();
        spot.only(&KEYS, "the points of a table of two arguments", &mut self.builder.problems);
        let [x, y, values] =
            KEYS.map(|key| spot.need(key, "the points of a table of two arguments", &mut self.builder.problems));
        let (x, y, values) = (x?, y?, values?);
        let knots = [self.numbers_of_grid(&x), self.numbers_of_grid(&y)];
        let rows = values.list(&mut self.builder.problems);
        let lists: Vec<Vec<f64>> = rows.iter().map(|row| self.numbers_of_grid(row)).collect();
        if self.builder.problems.len() > before {
            return None;
        }
        let [count_x, count_y] = knots.each_ref().map(Vec::len);
        let help = "`values` has a row for each number in `x`, and in each row a number for each in `y`";
        if rows.len() != count_x {
            let why = format!("`values` has {} rows for {count_x} numbers in `x`", rows.len());
            self.builder.problems.push(sections::bad_table(values.place, name, why, help));
            return None;
        }
        if let Some((row, list)) = rows.iter().zip(&lists).find(|(_, list)| list.len() != count_y) {
            let why = format!("a row of `values` has {} numbers for {count_y} in `y`", list.len());
            self.builder.problems.push(sections::bad_table(row.place.clone(), name, why, help));
            return None;
        }
        Some(Grid { knots, values: lists })
    }

    /// A list of numbers; what is none is reported.
    fn numbers_of_grid(&mut self, spot: &Spot<'_>) -> Vec<f64> {
        let list = spot.list(&mut self.builder.problems);
        if !self.count(list.len(), &spot.place) {
            return Vec::new();
        }
        list.iter().filter_map(|number| self.number_of_point(number)).collect()
    }
}

/// The grid of lines x, y, value in any order, and otherwise why they make none, and a way out.
fn grid_of(lines: &[[f64; 3]]) -> Result<Grid, (String, &'static str)> {
    let help = "a line for every x with every y, in any order; values at scattered places are first brought to a grid by what made them";
    let rising = |place: usize| {
        let mut numbers: Vec<f64> = lines.iter().map(|line| line[place] + 0.0).collect();
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        numbers
    };
    let (x, y) = (rising(0), rising(1));
    if x.len().saturating_mul(y.len()) > lines.len() {
        let why = format!("its {} lines are no grid of {} x by {} y", lines.len(), x.len(), y.len());
        return Err((why, help));
    }
    let mut values = vec![vec![None; y.len()]; x.len()];
    for [at_x, at_y, value] in lines {
        let place = |knots: &[f64], at: f64| knots.partition_point(|knot| *knot < at);
        let slot = &mut values[place(&x, *at_x)][place(&y, *at_y)];
        if slot.replace(*value).is_some() {
            return Err((format!("it has two values at ({at_x}, {at_y})"), help));
        }
    }
    let complete = values.into_iter().map(|row| row.into_iter().collect()).collect::<Option<Vec<Vec<f64>>>>();
    complete.map(|values| Grid { knots: [x, y], values }).ok_or_else(|| ("it has gaps".to_owned(), help))
}

fn in_si(grid: &Grid, [x, y, gives]: [&Scale; 3]) -> Grid {
    let scaled = |numbers: &Vec<f64>, scale: &Scale| numbers.iter().map(|number| number * scale.factor).collect();
    Grid {
        knots: [scaled(&grid.knots[0], x), scaled(&grid.knots[1], y)],
        values: grid.values.iter().map(|row| scaled(row, gives)).collect(),
    }
}

/// Why a grid makes no function, and a way out.
fn unfit(grid: &Grid, periodic: [bool; 2]) -> Option<(String, &'static str)> {
    for (name, knots) in ["x", "y"].into_iter().zip(&grid.knots) {
        if knots.len() < 2 {
            let why = format!("it has {} of the two numbers in `{name}` that it needs", knots.len());
            return Some((why, "a function of one argument is a table with points `[[x, value], …]`"));
        }
        if let Some(pair) = knots.windows(2).find(|pair| pair[1] <= pair[0]) {
            let why = format!("in `{name}` {} does not come after {}", pair[1], pair[0]);
            return Some((why, "the numbers in `x` and in `y` must rise"));
        }
    }
    if let Some(number) = grid.knots.iter().chain(&grid.values).flatten().find(|number| !number.is_finite()) {
        return Some((format!("its number {number} is not finite"), ""));
    }
    let help = "a period ends as it begins";
    if periodic[0] && grid.values.first() != grid.values.last() {
        return Some(("its first and its last row differ".to_owned(), help));
    }
    let ends = |row: &Vec<f64>| row.first() != row.last();
    match grid.values.iter().find(|row| periodic[1] && ends(row)) {
        Some(row) => Some((format!("a row begins with {} and ends with {}", row[0], row[row.len() - 1]), help)),
        None => None,
    }
}

#[cfg(test)]
mod tests {
    use super::grid_of;

    #[test]
    fn lines_in_any_order_are_a_grid_and_scattered_ones_are_none() {
        let lines = [[1.0, 0.0, 3.0], [0.0, 0.0, 1.0], [0.0, 5.0, 2.0], [1.0, 5.0, 4.0]];
        let grid = grid_of(&lines).expect("a grid");
        assert_eq!((grid.knots, grid.values), ([vec![0.0, 1.0], vec![0.0, 5.0]], vec![vec![1.0, 2.0], vec![3.0, 4.0]]));
        let told = |lines: &[[f64; 3]]| grid_of(lines).expect_err("no grid").0;
        assert_eq!(told(&lines[..3]), "its 3 lines are no grid of 2 x by 2 y");
        let twice = [lines[0], lines[1], lines[2], lines[2]];
        assert_eq!(told(&twice), "it has two values at (0, 5)");
        assert!(grid_of(&[]).is_ok_and(|grid| grid.values.is_empty()));
    }
}
