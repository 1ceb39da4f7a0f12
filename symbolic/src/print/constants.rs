//! Names of the numbers in the block of constants, after what they are.

use super::scope::{Names, joined};
use crate::expr::Id;
use crate::lower::Program;
use crate::model::{local_name, text};

/// Longer names say less than a place does.
const LONGEST: usize = 32;

/// Names the whole block: parameters, hoisted expressions (`m_g_l`, `k_over_m`, or after their place, `c7`), modes, phases, held values.
pub(super) fn name_constants(names: &mut Names, program: &Program, hoisted: &[Id]) {
    let model = &program.model;
    let free = model.parameters.len();
    let parameters = model.parameters.iter().map(|parameter| local_name(&parameter.name));
    let hoisted = hoisted.iter().zip(free..);
    let hoisted = hoisted.map(|(id, place)| in_words(&text(model, *id)).unwrap_or_else(|| format!("c{place}")));
    let modes = (1..=program.switches.len()).map(|k| format!("mode_{k}"));
    let phases = model.phases.iter().filter(|phase| !phase.name.is_empty());
    let phases = phases.map(|phase| joined("in", &local_name(&phase.name)));
    let memory = model.memory.iter().map(|held| local_name(&held.name));
    let wanted: Vec<String> = parameters.chain(hoisted).chain(modes).chain(phases).chain(memory).collect();
    names.constants = wanted.iter().map(|name| names.scope.fresh(name)).collect();
}

/// An expression as an identifier, if it is short: `m*l^2/3` is `m_l_squared_over_3`.
fn in_words(text: &str) -> Option<String> {
    let (mut words, mut rest) = match text.strip_prefix("1/2*") {
        Some(rest) => ("half_".to_owned(), rest),
        None => (String::new(), text),
    };
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '0'..='9' => rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len()),
            _ => first.len_utf8(),
        };
        let (part, after) = rest.split_at(length);
        rest = after;
        match first {
            '0'..='9' if words.is_empty() => words += NUMBERS.get(part.parse::<usize>().ok()?)?,
            '*' | ' ' | ',' | '(' | ')' | '[' | ']' => words.push('_'),
            '/' => words += "_over_",
            '+' => words += "_plus_",
            '-' => words += if words.is_empty() { "minus_" } else { "_minus_" },
            '^' => {
                let (power, after) = rest.split_at_checked(1)?;
                words += match power {
                    "2" => "_squared",
                    "3" => "_cubed",
                    _ => return None,
                };
                rest = after;
            }
            '.' | '…' => return None,
            _ => words += part,
        }
    }
    let name = local_name(&words);
    (name.len() <= LONGEST).then_some(name)
}

/// Numbers that a name may begin with.
const NUMBERS: [&str; 13] =
    ["zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"];

#[cfg(test)]
mod tests {
    use super::in_words;

    #[test]
    fn expressions_are_read_out() {
        let name = |text| in_words(text).unwrap_or_default();
        assert_eq!(name("m*g*l"), "m_g_l");
        assert_eq!(name("-k/m"), "minus_k_over_m");
        assert_eq!(name("m*l^2/3"), "m_l_squared_over_3");
        assert_eq!(name("3*(m[1] + m[2])/2"), "three_m_1_plus_m_2_over_2");
        assert_eq!(name("sqrt(k/m)"), "sqrt_k_over_m");
        assert_eq!(name("1/12*θ"), "one_over_12_theta");
        assert_eq!(name("1/2*m*l^2"), "half_m_l_squared");
        // No words for a decimal, for other powers, for what is cut short or too long.
        for text in ["0.5*m", "m^4", "m^", "13*m", "m*…", "a*b*c*d*e*f*g*h*i*j*k*l*m*n*o*p*q"] {
            assert_eq!(name(text), "", "{text}");
        }
    }
}
