//! Records that motions follow: columns of a file beside the model's.

use super::tables::columns_of;
use crate::diagnose::catalogue::{later, sections};
use crate::file::Spot;
use crate::model::resolver::Resolver;

/// What a way out says of such files.
const HELP: &str = "columns of numbers with commas, semicolons, tabs or blanks between, under a line of names; times rise, and `t` is their name or `columns` says which it is";

impl Resolver<'_> {
    /// `fit`: the column `t`, then those of what is measured.
    pub fn record(&mut self, spot: &Spot<'_>) -> Option<Vec<(String, Vec<f64>)>> {
        let problems = &mut self.builder.problems;
        if !spot.only(&["file", "columns"], "`fit`", problems) {
            return None;
        }
        let (file, columns) = (spot.need("file", "`fit`", problems), spot.need("columns", "`fit`", problems));
        let (file, columns) = (file?, columns?);
        let named = self.named_columns(&columns);
        let words = file.words(&mut self.builder.problems)?;
        let Some(folder) = &self.files.folder else {
            let what = "a record's file in a model that is none";
            self.builder.problems.push(later::form_not_supported(file.place.clone(), what));
            return None;
        };
        let path = folder.join(words);
        let (time, named) = named?;
        let record = self.files.text(&path).and_then(|text| {
            let pairs =
                named.iter().map(|(name, column)| Ok((name, columns_of(&text, Some([time.as_str(), column]))?)));
            record(pairs.collect::<Result<Vec<_>, String>>()?)
        });
        match record {
            Ok(record) => {
                self.model.files.push(path);
                let numbers = record.iter().map(|(_, column)| column.len()).sum();
                self.count(numbers, &file.place).then_some(record)
            }
            Err(why) => {
                self.builder.problems.push(sections::bad_record(file.place.clone(), words, why, HELP));
                None
            }
        }
    }

    /// Which column of the file is time, and which ones are what.
    fn named_columns(&mut self, spot: &Spot<'_>) -> Option<(String, Vec<(String, String)>)> {
        let (mut time, mut named) = (None, Vec::new());
        let mut sound = true;
        for (key, column) in spot.entries(&mut self.builder.problems) {
            let words = column.words(&mut self.builder.problems).map(str::to_owned);
            let name = if key == "t" { Some(key.to_owned()) } else { self.observed_name(key, &column.place.of_key()) };
            match (name, words) {
                (Some(name), Some(words)) if name == "t" => time = Some(words),
                (Some(name), Some(words)) => named.push((name, words)),
                _ => sound = false,
            }
        }
        if sound && time.is_none() {
            self.builder.problems.push(sections::missing_key(spot.place.of_key(), "t", "the columns of a record"));
        }
        if sound && named.is_empty() {
            self.builder.problems.push(sections::empty_list(spot.place.of_key(), "columns", "measured quantity"));
        }
        (sound && !named.is_empty()).then_some(())?;
        Some((time?, named))
    }
}

/// The columns by name, of pairs (t, value).
fn record(pairs: Vec<(&String, Vec<[f64; 2]>)>) -> Result<Vec<(String, Vec<f64>)>, String> {
    let times: Vec<f64> = pairs.first().map_or_else(Vec::new, |(_, points)| points.iter().map(|p| p[0]).collect());
    if times.len() < 2 {
        return Err(format!("it has {} rows of numbers", times.len()));
    }
    if let Some(pair) = times.windows(2).find(|pair| pair[1] <= pair[0]) {
        return Err(format!("the time {} does not come after {}", pair[1], pair[0]));
    }
    let columns = pairs.into_iter().map(|(name, points)| (name.clone(), points.iter().map(|p| p[1]).collect()));
    Ok(std::iter::once(("t".to_owned(), times)).chain(columns).collect())
}
