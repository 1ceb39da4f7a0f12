//! Where scenes start, coefficients of restitution and clocks in C.

use std::fmt::Write;

use super::Printing;
use super::function::unread;
use crate::expr::Id;
use crate::model::Scene;
use crate::print::body::Use;
use crate::print::function::stores;

const DECLARATIONS: &str = "
/* Sets the parameters that a scene sets, computed of those in c. */
void NAME_scene_parameters(int scene, const double *c, NAME_parameters *p);

/* A scene's start, computed of the parameters in c: q and v, its phase and held values in c, and in settings its end, its tolerance and the spacing of
   its reports (0: none is given).  Where constraints are to be met, what the scene does not name is a guess.  The phase of friction and contacts is
   that in which the scene starts with the file's parameters; where others let it start in another, NAME_set_phase puts that in force. */
void NAME_scene(int scene, double *c, double *settings, double *q, double *v);

/* Coefficients of restitution: of all impacts in the order of the events, then of contacts. */
void NAME_restitutions(const double *c, double *out);

/* The first tick and the period of each clock, s. */
void NAME_clocks(const double *c, double *out);
";

impl Printing<'_> {
    /// For the header.
    pub fn declarations_of_starts(&self) -> String {
        DECLARATIONS.replace("NAME", self.prefix)
    }

    /// The definitions.
    pub fn starts(&self) -> String {
        let prefix = self.prefix;
        let (scenes, n) = (&self.program.model.scenes, self.program.model.coordinates.len());
        let mut sets = String::new();
        for (k, scene) in scenes.iter().enumerate().filter(|(_, scene)| !scene.set.is_empty()) {
            let stores =
                scene.set.iter().map(|(place, id)| Use::Store(format!("*{prefix}_parameter(p, {place})"), *id));
            let body = self.unhoisted.body(&stores.collect::<Vec<_>>(), "        ");
            let read = unread(&[("c", body.reads.constants)]).replace("    ", "        ");
            let _ = write!(sets, "    if (scene == {k}) {{\n{read}{}    }}\n", body.lines);
        }
        let set = unread(&[("scene", !sets.is_empty()), ("c", !sets.is_empty()), ("p", !sets.is_empty())]);
        let begin: String = scenes.iter().enumerate().map(|(k, scene)| self.start(k, scene)).collect();
        let vectors = [("restitutions", self.program.restitutions()), ("clocks", self.program.clock_numbers())];
        let vectors: String = vectors.iter().map(|(name, values)| self.of_constants(name, values)).collect();
        format!(
            "\nvoid {prefix}_scene_parameters(int scene, const double *c, {prefix}_parameters *p) {{\n{set}{sets}}}\n\nvoid {prefix}_scene(int scene, double *c, double *settings, double *q, double *v) {{\n{}    for (int k = 0; k < {n}; k++) q[k] = v[k] = 0.0;\n{begin}}}\n{vectors}",
            unread(&[("q", n > 0), ("v", n > 0)]),
        )
    }

    fn start(&self, place: usize, scene: &Scene) -> String {
        let store = |array: &'static str| move |(k, id): (usize, &Id)| Use::Store(format!("{array}[{k}]"), *id);
        let given = |(_, id): &(usize, &Id)| **id != Id::ZERO;
        let settings = [scene.until, scene.tolerance, scene.every.unwrap_or(Id::ZERO)];
        let mut uses = stores("settings", &settings);
        uses.extend(scene.q.iter().enumerate().filter(given).map(store("q")));
        uses.extend(scene.v.iter().enumerate().filter(given).map(store("v")));
        uses.extend(scene.memory.iter().enumerate().map(store("memory")));
        let lines = self.unhoisted.body(&uses, "        ").lines;
        let memory = if scene.memory.is_empty() {
            String::new()
        } else {
            format!("        double *memory = {}_memory(c);\n", self.prefix)
        };
        format!(
            "    if (scene == {place}) {{\n{memory}{lines}        {}_set_phase(c, {});\n    }}\n",
            self.prefix, scene.phase
        )
    }

    fn of_constants(&self, name: &str, values: &[Id]) -> String {
        let body = self.unhoisted.body(&stores("out", values), "    ");
        let unread = unread(&[("c", body.reads.constants), ("out", !values.is_empty())]);
        format!("\nvoid {}_{name}(const double *c, double *out) {{\n{unread}{}}}\n", self.prefix, body.lines)
    }
}
