//! A test that compares the smaller model with the full one.

use super::Needs;

impl Needs {
    /// A Rust test that runs both model files, whose paths are relative to the crate's folder, and holds the smaller one to the
    /// need: for the crate's `tests` folder.  `None` where there is no smaller model.
    ///
    /// Events have the same names in the same order; around each, where what jumps does so a little earlier or later, nothing is
    /// compared.
    pub fn comparison(&self, full: &str, small: &str) -> Option<String> {
        let choice = self.choice.as_ref()?;
        let absolute = |name: &String| self.need.absolute.iter().any(|(own, _)| own == name);
        let relative = self.need.outputs.iter().filter(|name| !absolute(name));
        let columns = relative.map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
        let relative = match columns.is_empty() {
            true => String::new(),
            false => format!(
                "    for name in [{columns}] {{
        let off = full.deviation(&small, name).expect(\"a column of both\");
        assert!(off <= {:e}, \"{{name}} is off by {{off:e}} of its range\");
    }}
",
                self.need.within
            ),
        };
        let amounts = self.need.absolute.iter().map(|(name, amount)| {
            format!(
                "    let off = full.difference(&small, {name:?}).expect(\"a column of both\");
    assert!(off <= {amount:e}, \"{name} is off by {{off:e}}\");
"
            )
        });
        let compared = amounts.fold(relative, |text, amount| text + &amount);
        let scene = self.scene.as_ref().map_or_else(String::new, |name| format!(".scene({name:?})"));
        let until = self.until;
        let sizes: String = self.sizes.iter().map(|(name, size)| format!(", {name} = {size}")).collect();
        let exact = 1e-3 * self.need.within.min(1e-6);
        Some(format!(
            r#"//! `{small}` does what `{full}` does: {wanted} until
//! t = {until} s. `dalembert needs` wrote it; it was off by
//! {found} then.

use dalembert::prelude::*;

dalembert::model!({full:?}{sizes}, name = Full);
dalembert::model!({small:?}{sizes}, name = Smaller);

#[test]
fn the_smaller_model_does_what_the_full_one_does() {{
    let every = {until:?} / {times}.0;
    let full = Full::default().simulate(){scene}.every(every);
    let full = full.tolerance({exact:e}).run().expect("the full model runs");
    let small = Smaller::default().simulate(){scene}.every(every);
    let small = small.tolerance({tolerance:e}).run().expect("the smaller model runs");
{compared}}}
"#,
            times = self.times,
            wanted = self.wanted(),
            found = self.off(choice.verified, &choice.of),
            tolerance = choice.tolerance,
        ))
    }
}
