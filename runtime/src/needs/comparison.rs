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
        let columns = self.need.outputs.iter().map(|name| format!("{name:?}")).collect::<Vec<_>>().join(", ");
        let scene = self.scene.as_ref().map_or_else(String::new, |name| format!(".scene({name:?})"));
        let (within, until) = (self.need.within, self.until);
        let sizes: String = self.sizes.iter().map(|(name, size)| format!(", {name} = {size}")).collect();
        let exact = 1e-3 * within.min(1e-6);
        Some(format!(
            r#"//! `{small}` does what `{full}` does: {wanted} within {within:e} of the range of each until t = {until} s.
//! `dalembert needs` wrote it; {found:.1e} was found then.

use dalembert::prelude::*;

dalembert::model!({full:?}{sizes}, name = Full);
dalembert::model!({small:?}{sizes}, name = Smaller);

/// The largest deviation of a column, in parts of its range.
fn deviation(full: &Run, small: &Run, name: &str) -> f64 {{
    let [whole, part] = [full, small].map(|run| run.column(name).unwrap_or_else(|| panic!("no `{{name}}`")));
    let events = full.events.iter().zip(&small.events).map(|(a, b)| (a.state.t, (a.state.t - b.state.t).abs()));
    let events: Vec<(f64, f64)> = events.collect();
    let beside = |t: f64| events.iter().any(|(at, apart)| (t - at).abs() <= apart + 1e-9 * {until:?});
    let finite = || whole.iter().filter(|value| value.is_finite());
    let (low, high) = (finite().copied().fold(f64::INFINITY, f64::min), finite().copied().fold(f64::NEG_INFINITY, f64::max));
    let range = if high - low > 1e-9 * high.abs().max(low.abs()) {{ high - low }} else {{ high.abs().max(low.abs()) }};
    let rows = full.times().iter().zip(small.times()).take_while(|(a, b)| a == b).map(|(t, _)| *t).enumerate();
    let apart = rows.filter(|(_, t)| !beside(*t)).map(|(row, _)| match (whole[row], part[row]) {{
        (a, b) if a.is_nan() && b.is_nan() => 0.0,
        (a, b) if a.is_nan() || b.is_nan() => f64::INFINITY,
        (a, b) => (a - b).abs() / range,
    }});
    apart.fold(0.0, f64::max)
}}

#[test]
fn the_smaller_model_does_what_the_full_one_does() {{
    let every = {until:?} / 1000.0;
    let full = Full::default().simulate(){scene}.every(every).tolerance({exact:e}).run().expect("the full model runs");
    let small = Smaller::default().simulate(){scene}.every(every).tolerance({tolerance:e}).run().expect("the smaller model runs");
    let events = |run: &Run| run.events.iter().map(|event| event.name.to_string()).collect::<Vec<_>>();
    assert_eq!(events(&full), events(&small));
    for name in [{columns}] {{
        let found = deviation(&full, &small, name);
        assert!(found <= {within:e}, "{{name}} is off by {{found:e}} of its range");
    }}
}}
"#,
            wanted = self.need.outputs.join(", "),
            found = choice.verified,
            tolerance = choice.tolerance,
        ))
    }
}
