//! The numbers of `tests/reference`: systems computed twice, at high precision, outside this project.

use std::fs;
use std::path::Path;

use serde_json::Value;

/// Times, and (name, value) of what is known of them.
pub type States = Vec<(f64, Vec<(String, f64)>)>;

/// One file of reference numbers.
pub struct Reference(Value);

impl Reference {
    /// Reads the file of this number, `B13b`.
    ///
    /// # Panics
    /// If there is none, or if it is not JSON.
    pub fn load(id: &str) -> Self {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference");
        let entry = fs::read_dir(folder)
            .expect("a folder of reference numbers")
            .filter_map(Result::ok)
            .find(|entry| entry.file_name().to_string_lossy().starts_with(&format!("{id}-")))
            .unwrap_or_else(|| panic!("no reference {id}"));
        Reference(serde_json::from_str(&fs::read_to_string(entry.path()).expect("a text file")).expect("JSON"))
    }

    /// Reads a file of this name in the folder `space`.
    ///
    /// # Panics
    /// As [`Reference::load`].
    pub fn in_space(name: &str) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/space").join(format!("{name}.json"));
        Reference(serde_json::from_str(&fs::read_to_string(path).expect("a text file")).expect("JSON"))
    }

    /// One entry of the file.
    pub fn entry(&self, name: &str) -> &Value {
        &self.0[name]
    }

    /// The states of the motion: a time, and (name, value) of everything else.
    pub fn states(&self) -> States {
        states(&self.0["reference"])
    }

    /// The states of one of the variants between which `reference` distinguishes.
    pub fn variant(&self, name: &str) -> States {
        let rows = self.0["reference"].as_array().expect("a list of states");
        let own: Vec<Value> = rows.iter().filter(|row| row["variant"] == name).cloned().collect();
        states(&Value::from(own))
    }

    /// The states of another motion, which stands among the scalars.
    pub fn states_of(&self, name: &str) -> States {
        states(&self.0["scalars"][name])
    }

    /// One of the scalars.
    pub fn scalar(&self, name: &str) -> f64 {
        number(&self.0["scalars"][name])
    }

    /// One of the scalars that is a list.
    pub fn list(&self, name: &str) -> Vec<f64> {
        numbers(&self.0["scalars"][name])
    }

    /// One of the scalars that is a matrix.
    pub fn matrix(&self, name: &str) -> Vec<Vec<f64>> {
        self.0["scalars"][name].as_array().expect("a matrix").iter().map(numbers).collect()
    }

    /// The scalars as they stand.
    pub fn scalars(&self) -> &Value {
        &self.0["scalars"]
    }
}

fn states(rows: &Value) -> States {
    let rows = rows.as_array().expect("a list of states");
    rows.iter()
        .map(|row| {
            let row = row.as_object().expect("a state");
            let told = ["t", "variant", "agreement"];
            let values = row.iter().filter(|(name, value)| !told.contains(&name.as_str()) && value.is_string());
            (number(&row["t"]), values.map(|(name, value)| (name.clone(), number(value))).collect())
        })
        .collect()
}

/// A list of numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("a list").iter().map(number).collect()
}

/// A number as the files write it: decimal text, or a fraction.
pub fn number(value: &Value) -> f64 {
    let text = value.as_str().unwrap_or_else(|| panic!("a number as text, not {value}"));
    let decimal = |text: &str| text.trim().parse::<f64>().unwrap_or_else(|_| panic!("no number: {text}"));
    match text.split_once('/') {
        Some((n, d)) => decimal(n) / decimal(d),
        None => decimal(text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fractions_and_decimals_are_numbers() {
        assert_eq!(number(&Value::from("4/3")), 4.0 / 3.0);
        assert_eq!(number(&Value::from("-0.25")), -0.25);
        let pendulum = Reference::load("B01");
        assert_eq!(pendulum.scalar("period"), 3.2644707313017687);
        assert_eq!(pendulum.states().len(), 4);
        assert_eq!(Reference::load("B02").matrix("small_oscillation_M")[0][0], 4.0 / 3.0);
    }
}
