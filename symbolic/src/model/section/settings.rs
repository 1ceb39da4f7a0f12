//! Plain numbers that scenes set and start from, read before expressions have values: integrals are tried there.

use crate::expr::Symbol;
use crate::file::Spot;
use crate::language::AstKind;
use crate::model::resolver::Resolver;

/// Where a run ends that says nothing of it, s.
const UNTIL: f64 = 10.0;
/// So many scenes are looked at.
const SCENES: usize = 8;

impl Resolver<'_> {
    /// For each scene what it gives free parameters, coordinates, speeds and time, in SI.
    pub fn settings(&self) -> Vec<Vec<(Symbol, f64)>> {
        let default = self.root.get("scene");
        let further = self.root.get("scenes").map_or_else(Vec::new, |scenes| scenes.entries(&mut Vec::new()));
        let scenes = default.iter().cloned().chain(further.into_iter().map(|(_, scene)| scene));
        let numbers = |scene: Spot<'_>| {
            let own = |key: &str| scene.get(key).or_else(|| default.as_ref().and_then(|scene| scene.get(key)));
            let entries = ["set", "start"].into_iter().filter_map(own).flat_map(|spot| spot.entries(&mut Vec::new()));
            let until = own("until").and_then(|spot| number(&spot)).unwrap_or(UNTIL);
            let given = entries.filter_map(|(key, spot)| Some((self.moving(key)?, number(&spot)?)));
            given.chain([(Symbol::Time, until)]).collect()
        };
        scenes.take(SCENES).map(numbers).collect()
    }

    /// The parameter, coordinate or speed of this name.
    fn moving(&self, name: &str) -> Option<Symbol> {
        let parameter = self.model.parameters.iter().position(|p| p.name == name);
        let coordinate = |name: &str| Some(self.model.coordinates.iter().position(|c| c.name == name)? as u32);
        let of_state = || match name.strip_suffix('\'') {
            Some(name) => coordinate(name).map(Symbol::Speed),
            None => coordinate(name).map(Symbol::Coordinate).or_else(|| {
                let place = self.model.states.iter().position(|state| state.name == name)?;
                Some(Symbol::State(place as u32))
            }),
        };
        parameter.map(|k| Symbol::Parameter(k as u32)).or_else(of_state)
    }
}

/// A number as it stands, with its unit or without.
fn number(spot: &Spot<'_>) -> Option<f64> {
    let quantity = spot.quantity(&mut Vec::new())?;
    let (sign, kind) = match &quantity.text.ast.kind {
        AstKind::Negate(inner) => (-1.0, &inner.kind),
        kind => (1.0, kind),
    };
    let AstKind::Number(digits) = kind else { return None };
    let factor = quantity.unit.map_or(1.0, |(_, unit)| unit.factor().to_f64());
    Some(sign * factor * digits.parse::<f64>().ok()?)
}
