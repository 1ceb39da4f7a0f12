//! `tables`: functions that are given by points, in the file or in one beside it.

use std::io::Read;
use std::path::Path;

use super::tables_2d::has_two_arguments;
use crate::diagnose::Place;
use crate::diagnose::catalogue::{later, sections};
use crate::expr::{Smooth, Table};
use crate::file::{Spot, unit_at};
use crate::model::expression::dimension::Measure;
use crate::model::expression::index::MEMBER_LIMIT;
use crate::model::expression::rules::Rules;
use crate::model::expression::scope::{Member, Section, TableKind, TableNames};
use crate::model::resolver::Resolver;

/// What an entry may say.
const KEYS: [&str; 6] = ["points", "file", "columns", "units", "smooth", "periodic"];

/// What a column's numbers are in.
pub(super) struct Scale {
    pub factor: f64,
    pub measure: Measure,
}

impl Resolver<'_> {
    /// Declares the tables.
    pub fn tables(&mut self) {
        for (key, spot) in self.section("tables") {
            let Some(family) = self.expand_declared(key, &spot, Section::Table) else { continue };
            if !family.key.indices.is_empty() {
                self.builder.problems.push(sections::family_not_allowed(spot.place.of_key(), "`tables`"));
                self.refuse_name(&family.key.name, Section::Table);
                continue;
            }
            match (self.read_table(&family.key.name, &spot), family.members.as_slice()) {
                (Some(table), [member]) => {
                    let place = self.scope.tables.len();
                    if self.declare(Section::Table, member, Member::Table(place), &spot.place) {
                        self.scope.tables.push(table);
                    }
                }
                _ => self.refuse_name(&family.key.name, Section::Table),
            }
        }
    }

    fn read_table(&mut self, name: &str, spot: &Spot<'_>) -> Option<TableNames> {
        if !spot.only(&KEYS, "a table", &mut self.builder.problems) {
            return None;
        }
        if has_two_arguments(spot) {
            return self.read_table_2d(name, spot);
        }
        let before = self.builder.problems.len();
        let smooth = self.smooth(spot);
        let periodic = self.periodic(spot);
        let [of, gives] = self.scales(spot)?;
        let points = match (spot.get("points"), spot.get("file")) {
            (Some(points), None) => self.listed_points(name, &points)?,
            (None, Some(file)) => self.lines_of_file(spot, &file)?,
            _ => return self.without_points(spot),
        };
        let scaled: Vec<[f64; 2]> = points.iter().map(|[x, y]| [x * of.factor, y * gives.factor]).collect();
        let at = spot.get("points").or_else(|| spot.get("file")).map_or(Place::default(), |spot| spot.place);
        if let Some((why, help)) = unfit(&points, periodic).or_else(|| unfit(&scaled, periodic)) {
            self.builder.problems.push(sections::bad_table(at, name, why, help));
            return None;
        }
        let table = Table::new(name, &scaled, smooth, periodic);
        if !table.pieces().iter().flatten().all(|coefficient| coefficient.is_finite()) {
            let help = "its points are too near to each other for what they differ by";
            self.builder.problems.push(sections::bad_table(at, name, "it is too steep for numbers of 64 bits", help));
        }
        let sound = self.builder.problems.len() == before;
        sound.then_some(TableNames { table: TableKind::One(table), of: vec![of.measure], gives: gives.measure })
    }

    /// Tells that neither `points` nor `file` is given, or both.
    pub(super) fn without_points(&mut self, spot: &Spot<'_>) -> Option<TableNames> {
        if let Some(file) = spot.get("file") {
            let place = file.place.of_key();
            self.builder.problems.push(sections::conflicting_keys(place, "points", "file", "a table"));
        } else if !spot.misspelt(&self.builder.problems) {
            let place = spot.place.of_key();
            self.builder.problems.push(sections::needs_one_of(place, "`points`, `file`", "a table"));
        }
        None
    }

    pub(super) fn smooth(&mut self, spot: &Spot<'_>) -> Smooth {
        let Some(smooth) = spot.get("smooth") else { return Smooth::Twice };
        let problems = &mut self.builder.problems;
        match smooth.words(problems) {
            Some("0") => Smooth::Zero,
            Some("1") => Smooth::Once,
            Some("2") | None => Smooth::Twice,
            Some(other) => {
                let help = "0: straight between the points; 1: no steeper than they are; 2: a cubic spline";
                problems.push(sections::unknown_choice(smooth.place, other, "0, 1 or 2", help));
                Smooth::Twice
            }
        }
    }

    fn periodic(&mut self, spot: &Spot<'_>) -> bool {
        let Some(periodic) = spot.get("periodic") else { return false };
        let problems = &mut self.builder.problems;
        match periodic.words(problems) {
            Some("true") => true,
            Some("false") | None => false,
            Some(other) => {
                problems.push(sections::unknown_choice(periodic.place, other, "true or false", ""));
                false
            }
        }
    }

    /// What the columns are in.
    pub(super) fn scales<const N: usize>(&mut self, spot: &Spot<'_>) -> Option<[Scale; N]> {
        let Some(units) = spot.get("units") else {
            return Some([(); N].map(|()| Scale { factor: 1.0, measure: Measure::Unknown }));
        };
        let list = units.list(&mut self.builder.problems);
        if list.len() != N {
            self.builder.problems.push(sections::list_length(units.place, "units", N, list.len()));
            return None;
        }
        let mut scale = |spot: &Spot<'_>| {
            let words = spot.words(&mut self.builder.problems)?;
            match unit_at(words, &spot.place) {
                Ok(unit) => {
                    let measure = self.note_unit(Some(&unit));
                    Some(Scale { factor: unit.factor().to_f64(), measure })
                }
                Err(found) => {
                    self.builder.problems.extend(found);
                    None
                }
            }
        };
        let scales: Vec<Option<Scale>> = list.iter().map(&mut scale).collect();
        scales.into_iter().collect::<Option<Vec<Scale>>>()?.try_into().ok()
    }

    /// `[[x, y], …]`.
    fn listed_points(&mut self, name: &str, spot: &Spot<'_>) -> Option<Vec<[f64; 2]>> {
        let before = self.builder.problems.len();
        let list = spot.list(&mut self.builder.problems);
        if !self.count(list.len(), &spot.place) {
            return None;
        }
        let mut points = Vec::with_capacity(list.len());
        for point in list {
            let pair = point.list(&mut self.builder.problems);
            if pair.len() == 3 && self.builder.problems.len() == before {
                let help = "a function of two arguments has a grid: `points: {x: [0, 1], y: [0, 1, 2], values: [[1, 2, 3], [4, 5, 6]]}`";
                let why = "its points have three numbers";
                self.builder.problems.push(sections::bad_table(point.place, name, why, help));
                return None;
            }
            let [x, y] = pair.as_slice() else {
                if self.builder.problems.len() == before {
                    let (item, found) = (point.name.clone(), pair.len());
                    self.builder.problems.push(sections::list_length(point.place, item, 2, found));
                }
                continue;
            };
            if let (Some(x), Some(y)) = (self.number_of_point(x), self.number_of_point(y)) {
                points.push([x, y]);
            }
        }
        (self.builder.problems.len() == before).then_some(points)
    }

    /// A number, or an expression of numbers.
    pub(super) fn number_of_point(&mut self, spot: &Spot<'_>) -> Option<f64> {
        if let Some(number) =
            spot.words(&mut self.builder.problems)?.trim().parse().ok().filter(|x: &f64| x.is_finite())
        {
            return Some(number);
        }
        let text = spot.text(&mut self.builder.problems)?;
        let id = self.scalar(&text, Rules::constant("a point of a table"), &Default::default())?;
        let number = self.builder.graph.number(id).map(|number| number.to_f64());
        if number.is_none() {
            let what = "a point of a table";
            self.builder.problems.push(sections::wrong_shape(spot.place.clone(), what, "a number", "an expression"));
        }
        number
    }

    /// Columns of a file beside the model's, line by line.
    pub(super) fn lines_of_file<const N: usize>(&mut self, spot: &Spot<'_>, file: &Spot<'_>) -> Option<Vec<[f64; N]>> {
        let words = file.words(&mut self.builder.problems)?;
        let Some(folder) = &self.files.folder else {
            self.builder
                .problems
                .push(later::form_not_supported(file.place.clone(), "a table's file in a model that is none"));
            return None;
        };
        let path = folder.join(words);
        let columns = match spot.get("columns") {
            None => None,
            Some(columns) => {
                let list = columns.list(&mut self.builder.problems);
                if list.len() != N {
                    self.builder.problems.push(sections::list_length(columns.place, "columns", N, list.len()));
                    return None;
                }
                let names = list.iter().map(|name| name.words(&mut self.builder.problems));
                Some(names.collect::<Option<Vec<&str>>>()?.try_into().ok()?)
            }
        };
        match self.files.text(&path).and_then(|text| columns_of(&text, columns)) {
            Ok(points) => {
                self.model.files.push(path);
                self.count(points.len(), &file.place).then_some(points)
            }
            Err(why) => {
                let help = "two columns of numbers with commas, semicolons, tabs or blanks between, under a line of names or not; `columns` picks them by name";
                self.builder.problems.push(sections::bad_table(file.place.clone(), words, why, help));
                None
            }
        }
    }
}

/// Why points make no function, and a way out.
fn unfit(points: &[[f64; 2]], periodic: bool) -> Option<(String, &'static str)> {
    if points.len() < 2 {
        return Some((format!("it has {} of the two points that it needs", points.len()), ""));
    }
    if let Some([x, y]) = points.iter().find(|point| !point.iter().all(|x| x.is_finite())) {
        return Some((format!("its point ({x}, {y}) is not finite"), ""));
    }
    if let Some(pair) = points.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        let why = format!("{} does not come after {}", pair[1][0], pair[0][0]);
        return Some((why, "the first numbers of the points must rise"));
    }
    let (first, last) = (points[0][1], points[points.len() - 1][1]);
    if periodic && first != last {
        return Some((format!("it begins with {first} and ends with {last}"), "a period ends as it begins"));
    }
    None
}

/// More than this, bytes, is not read: a line of the most points that a table may have, with 17 digits in each of two
/// columns and as much again beside them, is 100 bytes long.
const LONGEST: u64 = 100 * MEMBER_LIMIT as u64;

/// The text of a file of no more than [`LONGEST`]; devices and pipes, which may never end, are refused.
pub(in crate::model) fn text_of(path: &Path) -> Result<String, String> {
    let told = |error: std::io::Error| error.to_string();
    let kind = std::fs::metadata(path).map_err(told)?;
    if !kind.is_file() {
        return Err("it is no ordinary file".to_owned());
    }
    let mut bytes = Vec::new();
    let file = std::fs::File::open(path).map_err(told)?;
    file.take(LONGEST + 1).read_to_end(&mut bytes).map_err(told)?;
    if bytes.len() as u64 > LONGEST {
        return Err(format!("it is longer than {} MB", LONGEST / 1_000_000));
    }
    let text = String::from_utf8(bytes).map_err(|_| "it is no text in UTF-8".to_owned())?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// What separates the columns of a file, one for all its lines: semicolons, tabs in every line, or commas; `None` for blanks,
/// of which tabs are one.
fn separator<'a>(mut lines: impl Iterator<Item = &'a str> + Clone) -> Option<char> {
    let in_any = |separator: char| lines.clone().any(|line| line.contains(separator));
    match (in_any(';'), in_any(',')) {
        (true, _) => Some(';'),
        (false, commas) => match lines.all(|line| line.contains('\t')) {
            true => Some('\t'),
            false => commas.then_some(','),
        },
    }
}

/// The cells of the lines of a table of text, with the place of each line; lines that are empty or begin with `#` are none.
pub fn cells_of(text: &str) -> impl Iterator<Item = (usize, Vec<String>)> {
    let told = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    let separator = separator(told.clone().map(|(_, line)| line));
    let cells = move |line: &str| -> Vec<String> {
        let cells: Vec<&str> = match separator {
            Some(separator) => line.split(separator).collect(),
            None => line.split_whitespace().collect(),
        };
        cells.into_iter().map(|cell| cell.trim().trim_matches('"').to_owned()).collect()
    };
    told.map(move |(place, line)| (place, cells(line)))
}

/// A number with a comma in the place of the point: `0,5`.
fn has_decimal_comma(cell: &str) -> bool {
    cell.matches(',').count() == 1 && cell.replace(',', ".").parse::<f64>().is_ok()
}

/// Columns of a table of text: the first ones, or those of these names.
pub(super) fn columns_of<const N: usize>(text: &str, names: Option<[&str; N]>) -> Result<Vec<[f64; N]>, String> {
    let mut lines = cells_of(text).peekable();
    let number = |cell: &str| cell.parse::<f64>().ok().filter(|x| x.is_finite());
    let mut places: [usize; N] = std::array::from_fn(|place| place);
    let named = |cells: &Vec<String>| cells.iter().all(|cell| number(cell).is_none() && !has_decimal_comma(cell));
    let header = lines.peek().map(|(_, cells)| cells.clone()).filter(named);
    if header.is_some() {
        lines.next();
    }
    if let Some(names) = names {
        let header = header.as_ref().ok_or_else(|| "it has no line of names".to_owned())?;
        for (place, name) in places.iter_mut().zip(names) {
            let found = header.iter().position(|known| known == name);
            *place = found.ok_or_else(|| format!("no column is called `{name}`; there are {}", header.join(", ")))?;
        }
    }
    let count = |cells: &[String]| cells.iter().rposition(|cell| !cell.is_empty()).map_or(0, |last| last + 1);
    let width = header.as_ref().or(lines.peek().map(|(_, cells)| cells)).map_or(0, |cells| count(cells));
    let point = |(line, cells): (usize, Vec<String>)| {
        let at = |place: usize| {
            let cell = cells.get(place).ok_or_else(|| format!("line {} has {} columns", line + 1, cells.len()))?;
            number(cell).ok_or_else(|| match has_decimal_comma(cell) {
                true => format!("`{cell}` in line {} has a comma where a number has a point", line + 1),
                false => format!("`{cell}` in line {} is no number", line + 1),
            })
        };
        let mut values = [0.0; N];
        for (value, place) in values.iter_mut().zip(places) {
            *value = at(place)?;
        }
        // Last cells may be empty.
        match (count(&cells)..=cells.len()).contains(&width) {
            true => Ok(values),
            false => Err(format!("line {} has {} columns, and the first has {width}", line + 1, cells.len())),
        }
    };
    // A file can be longer than any model may be.
    lines.take(MEMBER_LIMIT + 1).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::columns_of;

    #[test]
    fn columns_are_found_whatever_separates_them() {
        let points = vec![[0.0, 1.0], [1.0, -2.5]];
        for text in ["0,1\n1,-2.5\n", "s;z\n0;1\n1;-2.5", "# road\n\n0 1\n1\t-2.5\n", "\"s\" \"z\"\n0.0 1e0\n1 -2.5"] {
            assert_eq!(columns_of::<2>(text, None).as_ref(), Ok(&points), "{text}");
        }
        let wide = "t, s, z\n9, 0, 1\n9, 1, -2.5\n";
        assert_eq!(columns_of::<2>(wide, Some(["s", "z"])).as_ref(), Ok(&points));
        assert_eq!(
            columns_of::<2>(wide, Some(["s", "y"])),
            Err("no column is called `y`; there are t, s, z".to_owned())
        );
        assert_eq!(columns_of::<2>("0,1\n1,x", None), Err("`x` in line 2 is no number".to_owned()));
        let ragged = |line: usize, columns: usize, first: usize| {
            Err(format!("line {line} has {columns} columns, and the first has {first}"))
        };
        assert_eq!(columns_of::<2>("0,1\n1", None), Err("line 2 has 1 columns".to_owned()));
        // A decimal comma.
        assert_eq!(columns_of::<2>("s,z\n0,1\n1,2,5\n2,3", None), ragged(3, 3, 2));
        assert_eq!(columns_of::<2>("s,z\n1,0,2,5", None), ragged(2, 4, 2));
        assert_eq!(columns_of::<2>("s,z,u\n0,1,3\n1,-2.5,", None).as_ref(), Ok(&points));
        assert_eq!(columns_of::<2>("s,z,\n0,1,\n1,-2.5", None).as_ref(), Ok(&points));
        assert_eq!(columns_of::<2>("0\n1", None), Err("line 1 has 1 columns".to_owned()));
        assert_eq!(columns_of::<2>("0,1", Some(["a", "b"])), Err("it has no line of names".to_owned()));
    }
}
