//! Names of a robot's file as names of the language.

use std::collections::HashSet;

use dalembert_symbolic::language::is_reserved;

/// The longest name, in bytes; the language's limit is 200, and endings come to it.
const LONGEST: usize = 120;

/// What YAML reads as something else than text.
const YAML: [&str; 3] = ["null", "true", "false"];

/// Names that are given so far.
#[derive(Default)]
pub struct Names {
    taken: HashSet<String>,
}

impl Names {
    /// A name that nothing has yet: `base`, or with this ending, or with this and a number.
    pub fn fresh(&mut self, base: &str, ending: &str) -> String {
        let free = |name: &String| !is_reserved(name) && !YAML.contains(&name.as_str()) && !self.taken.contains(name);
        let candidates = std::iter::once(base.to_owned())
            .chain(std::iter::once(format!("{base}_{ending}")))
            .chain((2_u64..).map(|k| format!("{base}_{ending}_{k}")));
        let name = candidates.into_iter().find(free).unwrap_or_default();
        self.taken.insert(name.clone());
        name
    }
}

/// The letters, digits and underlines of a name, all else as underlines; it begins with a letter.
pub fn identifier(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || (c.is_alphabetic() && !c.is_ascii()) { c } else { '_' };
    let mut name: String = text.trim().chars().map(plain).collect();
    while name.len() > LONGEST {
        name.pop();
    }
    if !name.starts_with(char::is_alphabetic) {
        name.insert(0, 'n');
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_and_unlike() {
        assert_eq!(identifier("left-finger.v2"), "left_finger_v2");
        assert_eq!(identifier("2nd"), "n2nd");
        assert_eq!(identifier("élan"), "élan");
        let mut names = Names::default();
        assert_eq!(names.fresh("arm", "link"), "arm");
        assert_eq!(names.fresh("arm", "link"), "arm_link");
        assert_eq!(names.fresh("arm", "link"), "arm_link_2");
        assert_eq!(names.fresh("length", "joint"), "length_joint");
        assert_eq!(names.fresh("true", "link"), "true_link");
        let long = identifier(&"é".repeat(500));
        assert!(long.len() <= LONGEST && dalembert_symbolic::language::parse_key(&long).is_ok());
    }
}
