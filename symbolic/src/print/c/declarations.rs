//! What the header says of names, sizes and parameters, and the functions that go with these.

use std::fmt::Write;

use super::Printing;
use super::dialect::{comment, float, identifier, string, taken};
use super::function::{documented, unread};
use crate::derive::SwitchKind;
use crate::expr::vectors::axes;
use crate::lower::direction_size;
use crate::model::{EventAction, Target, Trigger, field_name, text};
use crate::print::body::Use;
use crate::print::documentation::{about, tested};
use crate::print::function::stores;
use crate::print::scope::Scope;
use crate::print::si_unit;

/// A kind of quantity: what it is called, its size's name, and the name and unit of each.
struct Kind {
    name: &'static str,
    size: &'static str,
    all: Vec<(String, String)>,
}

impl Kind {
    /// What functions tell of each: its name, and its unit where this kind has units.
    fn told(&self) -> &'static [&'static str] {
        if matches!(self.name, "phase" | "event" | "mode" | "input") { &["name"] } else { &["name", "unit"] }
    }
}

fn in_si(unit: &Option<String>) -> String {
    unit.as_deref().map(si_unit).unwrap_or_default()
}

/// The components of a quantity: `x`, or `x.x`, `x.y`.
fn components(name: &str, count: usize) -> impl Iterator<Item = String> + '_ {
    (0..count).map(move |k| match count {
        1 => name.to_owned(),
        _ => format!("{name}.{}", axes(count)[k]),
    })
}

impl Printing<'_> {
    /// The header up to the functions of a state.
    pub fn head(&self) -> String {
        let model = &self.program.model;
        let guard = self.prefix.to_uppercase();
        let words = format!("{}\n\n{}", about(&model.about, &model.name), tested(self.program));
        let mut out = documented(&format!("{words}\n{HEAD}").replace("GUARD", &guard).replace("NAME", self.prefix))
            .trim_start()
            .to_owned();
        let _ = write!(out, "#ifndef {guard}_H\n#define {guard}_H\n\n/* How many there are of each. */\nenum {{\n");
        let mut size = |name: &str, size: usize, what: &str| {
            let what = if what.is_empty() { String::new() } else { format!(" /* {} */", comment(what)) };
            let _ = writeln!(out, "    {guard}_{name} = {size},{what}");
        };
        for Kind { size: name, all, .. } in self.kinds() {
            let listed = all.iter().map(|(name, unit)| format!("{name} {unit}").trim().to_owned());
            size(name, all.len(), &listed.collect::<Vec<_>>().join(", "));
        }
        size(
            "STATES",
            model.states.len(),
            "of first order: the last coordinates are their integrals, their speeds they themselves",
        );
        size("INVARIANTS", self.program.invariants.len() / 2, "");
        size("ASSIGNMENTS", self.program.assignments.len(), "");
        size("RESTITUTIONS", self.program.restitutions().len(), "");
        size("CLOCKS", model.clocks.len(), "");
        size(
            "SCENES",
            model.scenes.len(),
            &model.scenes.iter().map(|s| s.name.as_str()).collect::<Vec<_>>().join(", "),
        );
        size("CONSTANTS", self.block, "the size of the block c");
        size("DIRECTION", direction_size(self.program), "the size of a direction");
        out += "};\n";
        out += &self.parameters();
        let told = |kind: &Kind| kind.told().iter().map(|what| self.told(kind.name, what) + ";\n").collect::<String>();
        let names: String = self.kinds().iter().map(told).collect();
        out += &documented("Names, and units in SI (empty: a pure number); NULL beyond the last.");
        out += &names;
        out + &DECLARATIONS.replace("NAME", self.prefix) + &self.derived(true)
    }

    /// The signature of a function that tells a name or a unit.
    fn told(&self, kind: &str, what: &str) -> String {
        format!("const char *{}_{kind}_{what}(int place)", self.prefix)
    }

    fn kinds(&self) -> Vec<Kind> {
        let model = &self.program.model;
        let none = |name: &String| (name.clone(), String::new());
        let coordinates =
            model.coordinates.iter().zip(model.units_of_coordinates()).map(|(c, unit)| (c.name.clone(), in_si(unit)));
        let parameters = model.parameters.iter().map(|p| (p.name.clone(), in_si(&p.unit)));
        let rows = model.constraints.iter().flat_map(|c| c.row_names().into_iter().map(|name| (name, in_si(&c.unit))));
        let outputs =
            model.outputs.iter().flat_map(|o| components(&o.name, o.value.len()).map(|name| (name, in_si(&o.unit))));
        let phases = model.phases.iter().filter(|phase| !phase.name.is_empty());
        let switches = self.program.switches.iter().map(|switch| {
            let kind = if switch.kind == SwitchKind::Sign { "sign" } else { "step" };
            (format!("{kind}({})", text(model, switch.argument)), String::new())
        });
        let kind = |name, size, all: Vec<(String, String)>| Kind { name, size, all };
        vec![
            kind("coordinate", "COORDINATES", coordinates.collect()),
            kind("parameter", "PARAMETERS", parameters.collect()),
            kind("input", "INPUTS", model.inputs.iter().map(|u| none(&u.name)).collect()),
            kind("memory", "MEMORY", model.memory.iter().map(|m| (m.name.clone(), in_si(&m.unit))).collect()),
            kind("row", "ROWS", rows.collect()),
            kind("phase", "PHASES", phases.map(|phase| none(&phase.name)).collect()),
            kind("output", "OUTPUTS", outputs.collect()),
            kind("event", "EVENTS", model.events.iter().map(|e| none(&e.name)).collect()),
            kind("mode", "MODES", switches.collect()),
        ]
    }

    /// Identifiers of the parameters in their struct.
    fn fields(&self) -> Vec<String> {
        let mut scope = Scope::with(taken());
        let field = |name: &str| {
            let plain = field_name(name).trim_start_matches("r#").to_owned();
            // What begins with an underscore is the compiler's.
            if plain.starts_with('_') { format!("value{plain}") } else { plain }
        };
        self.program.model.parameters.iter().map(|p| scope.fresh(&field(&p.name))).collect()
    }

    /// The struct of the parameters.
    fn parameters(&self) -> String {
        let mut out = documented("Free parameters, in SI units.");
        let _ = writeln!(out, "typedef struct {}_parameters {{", self.prefix);
        for (parameter, field) in self.program.model.parameters.iter().zip(self.fields()) {
            let unit = in_si(&parameter.unit);
            let words = comment(&format!("{} {}", parameter.name, if unit.is_empty() { "no unit" } else { &unit }));
            let _ = writeln!(out, "    double {field}; /* {words} */");
        }
        if self.program.model.parameters.is_empty() {
            out += "    char none;\n";
        }
        let _ = writeln!(out, "}} {}_parameters;", self.prefix);
        out
    }

    /// A function for each derived parameter.
    fn derived(&self, declared: bool) -> String {
        let mut scope = Scope::with(std::iter::empty());
        let mut out = String::new();
        for derived in &self.program.model.derived {
            let name = scope.fresh(&identifier(&derived.name));
            let signature = format!("double {}_derived_{name}(const double *c)", self.prefix);
            if declared {
                let unit = in_si(&derived.unit);
                let words = format!("{} = {} {unit}", derived.name, text(&self.program.model, derived.value));
                out += &format!("{}{signature};\n", documented(words.trim_end()));
                continue;
            }
            let body = self.unhoisted.body(&[Use::Store("const double value".to_owned(), derived.value)], "    ");
            let _ = write!(
                out,
                "\n{signature} {{\n{}{}    return value;\n}}\n",
                unread(&[("c", body.reads.constants)]),
                body.lines
            );
        }
        out
    }

    /// Definitions of all that [`Printing::head`] declares.
    pub fn sources_of_declarations(&self) -> String {
        let mut out = "#include <float.h>\n#include <math.h>\n#include <stddef.h>\n".to_owned();
        for kind in self.kinds() {
            for what in kind.told() {
                let words = kind.all.iter().map(|(name, unit)| string(if *what == "name" { name } else { unit }));
                let words: Vec<String> = words.collect();
                out += &match words.len() {
                    0 => format!("\n{} {{\n    (void)place;\n    return NULL;\n}}\n", self.told(kind.name, what)),
                    count => format!(
                        "\n{} {{\n    static const char *const words[] = {{{}}};\n    return place >= 0 && place < {count} ? words[place] : NULL;\n}}\n",
                        self.told(kind.name, what),
                        words.join(", ")
                    ),
                };
            }
        }
        out += &self.tables();
        out += &self.tables_2d();
        out += &self.normal();
        out += &self.defaults();
        out += &self.block();
        out += &self.rows();
        out + &self.settle() + &self.derived(false)
    }

    fn tables(&self) -> String {
        let mut out = String::new();
        for (place, table) in self.program.tables().into_iter().enumerate() {
            let list = |numbers: &[f64]| numbers.iter().map(|x| float(*x)).collect::<Vec<_>>().join(", ");
            let pieces: Vec<String> = table.pieces().iter().map(|piece| format!("{{{}}}", list(piece))).collect();
            let _ = write!(
                out,
                "\n/* {}, or one of its derivatives. */\nstatic double {}_table_{place}(double x, int order) {{\n    static const double knots[] = {{{}}};\n    static const double pieces[][4] = {{{}}};\n    return dalembert_table(x, order, {}, knots, pieces, {}, {});\n}}\n",
                comment(table.name()),
                self.prefix,
                list(table.knots()),
                pieces.join(", "),
                table.knots().len(),
                float(table.period().unwrap_or(0.0)),
                float(table.rise()),
            );
        }
        out
    }

    fn defaults(&self) -> String {
        let (fields, prefix) = (self.fields(), self.prefix);
        let parameters = self.program.model.parameters.iter().zip(&fields);
        let values: String = parameters.map(|(p, field)| format!("    p->{field} = {};\n", float(p.default))).collect();
        let values = if values.is_empty() { "    p->none = 0;\n".to_owned() } else { values };
        let cases: String =
            fields.iter().enumerate().map(|(k, field)| format!("    case {k}: return &p->{field};\n")).collect();
        let cases = match fields.len() {
            0 => "    (void)p; (void)place;\n    return NULL;\n".to_owned(),
            _ => format!("    switch (place) {{\n{cases}    default: return NULL;\n    }}\n"),
        };
        format!(
            "\nvoid {prefix}_defaults({prefix}_parameters *p) {{\n{values}}}\n\ndouble *{prefix}_parameter({prefix}_parameters *p, int place) {{\n{cases}}}\n"
        )
    }

    /// The block of constants: parameters, what is made of them, modes, phases, held values.
    fn block(&self) -> String {
        let (model, prefix) = (&self.program.model, self.prefix);
        let free = model.parameters.len();
        let first_memory = self.block - model.memory.len();
        let first_phase = first_memory - self.program.phases();
        let first_mode = first_phase - self.program.switches.len();
        let mut lines: String =
            self.fields().iter().enumerate().map(|(k, field)| format!("    c[{k}] = p->{field};\n")).collect();
        let hoisted = self.constants.iter().zip(free..);
        let memory = model.memory.iter().map(|held| &held.start).zip(first_memory..);
        for (id, k) in hoisted.clone() {
            let _ = writeln!(lines, "    /* c[{k}] = {} */", comment(&text(model, *id)));
        }
        let uses: Vec<Use> = hoisted.chain(memory).map(|(id, k)| Use::Store(format!("c[{k}]"), *id)).collect();
        lines += &self.unhoisted.body(&uses, "    ").lines;
        let modes = (first_mode..first_phase).map(|k| format!("    c[{k}] = 1.0;\n"));
        let phases = (first_phase..first_memory).map(|k| format!("    c[{k}] = {:.1};\n", f64::from(k == first_phase)));
        lines.extend(modes.chain(phases));
        let unread = unread(&[("p", free > 0), ("c", self.block > 0)]);
        let inputs =
            self.bodies.body(&stores("u", &self.program.signals.iter().flatten().copied().collect::<Vec<_>>()), "    ");
        let reads = inputs.reads;
        let of_inputs = super::function::unread(&[
            ("c", reads.constants),
            ("t", reads.time),
            ("u", !self.program.signals.is_empty()),
        ]);
        let mut out =
            format!("\nvoid {prefix}_constants(const {prefix}_parameters *p, double *c) {{\n{unread}{lines}}}\n");
        let _ = write!(
            out,
            "\nvoid {prefix}_inputs(const double *c, double t, double *u) {{\n{of_inputs}{}}}\n\ndouble *{prefix}_modes(double *c) {{\n    return c + {first_mode};\n}}\n\ndouble *{prefix}_memory(double *c) {{\n    return c + {first_memory};\n}}\n",
            inputs.lines
        );
        out + &phase(self.program.phases(), first_phase).replace("NAME", prefix)
    }

    /// The rows of each phase.
    fn rows(&self) -> String {
        let model = &self.program.model;
        let rows: Vec<Vec<usize>> = model.phases.iter().map(|phase| model.rows_of(phase)).collect();
        let all: Vec<String> = rows.iter().flatten().map(ToString::to_string).collect();
        if all.is_empty() {
            return format!(
                "\nint {}_rows(int phase, int *rows, int *rank) {{\n    (void)phase; (void)rows;\n    *rank = 0;\n    return 0;\n}}\n",
                self.prefix
            );
        }
        let firsts = rows.iter().scan(0, |next, rows| {
            *next += rows.len();
            Some(*next)
        });
        let firsts: Vec<String> = std::iter::once(0).chain(firsts).map(|first| first.to_string()).collect();
        let ranks: Vec<String> = (0..rows.len()).map(|phase| self.program.rank_of(phase).to_string()).collect();
        format!(
            "\nint {}_rows(int phase, int *rows, int *rank) {{\n    static const int all[] = {{{}}}, first[] = {{{}}}, ranks[] = {{{}}};\n    const int count = first[phase + 1] - first[phase];\n    for (int k = 0; k < count; k++) rows[k] = all[first[phase] + k];\n    *rank = ranks[phase];\n    return count;\n}}\n",
            self.prefix,
            all.join(", "),
            firsts.join(", "),
            ranks.join(", "),
        )
    }

    /// Sets the modes one after the other, since the argument of one may contain those before it.
    fn settle(&self) -> String {
        let signature = format!(
            "\nvoid {}_settle(double *c, double t, const double *u, const double *q, const double *v, const double *a, const double *l) {{\n",
            self.prefix
        );
        let count = self.program.switches.len();
        if count == 0 {
            return signature + "    (void)c; (void)t; (void)u; (void)q; (void)v; (void)a; (void)l;\n}\n";
        }
        let steps = self.program.switches.iter().map(|switch| if switch.kind == SwitchKind::Step { "1" } else { "0" });
        let steps: Vec<&str> = steps.collect();
        format!(
            "{signature}    static const char steps[] = {{{}}};\n    double pairs[{}], *modes = {prefix}_modes(c);\n    for (int k = 0; k < {count}; k++) {{\n        {prefix}_switches(c, t, u, q, v, a, l, pairs);\n        modes[k] = steps[k] ? dalembert_step(pairs[2 * k]) : dalembert_sign(pairs[2 * k]);\n    }}\n}}\n",
            steps.join(", "),
            2 * count,
            prefix = self.prefix,
        )
    }

    /// What is written of outputs.
    pub fn about_outputs(&self) -> String {
        let count = self.program.outputs.len();
        format!("Outputs, component by component: {count} numbers, as NAME_output_name and NAME_output_unit say.")
            .replace("NAME", self.prefix)
    }

    /// What is written of invariants.
    pub fn about_invariants(&self) -> String {
        let claims = self
            .program
            .model
            .conserved
            .iter()
            .map(|c| format!("\n  {}{}", c.name, self.program.model.condition(&c.when)));
        format!("Pairs (value, sum of the absolute terms) of what is conserved:{}", claims.collect::<String>())
    }

    /// What is written of events.
    pub fn about_events(&self) -> String {
        let model = &self.program.model;
        let one = |event: &crate::model::Event| {
            let when = match &event.trigger {
                Trigger::Zero => match event.direction {
                    1 => "rising".to_owned(),
                    -1 => "falling".to_owned(),
                    _ => "either way".to_owned(),
                },
                Trigger::Tick(clock) => format!("a tick of clock {clock}"),
                Trigger::Set(held) => {
                    let names: Vec<&str> = held.iter().map(|k| model.memory[*k].name.as_str()).collect();
                    format!("when {} was set", names.join(" or "))
                }
            };
            let phases = event.phases.as_ref().map_or_else(String::new, |phases| {
                let names: Vec<&str> = phases.iter().map(|k| model.phases[*k].name.as_str()).collect();
                format!(", in {}", names.join(", "))
            });
            let actions: Vec<String> = event.actions.iter().map(|action| self.action(action)).collect();
            format!("\n  {}: {when}{phases}: {}", event.name, actions.join(", then "))
        };
        let all: String = model.events.iter().map(one).collect();
        format!(
            "Pairs (function, condition) of each event, which happens where its function passes through 0 and its condition is > 0.  Nothing here locates it or does what it says:{all}"
        )
    }

    fn action(&self, action: &EventAction) -> String {
        let model = &self.program.model;
        match action {
            EventAction::Stop => "stop".to_owned(),
            EventAction::Record => "record".to_owned(),
            EventAction::Phase(k) => format!("go on in {}", model.phases[*k].name),
            EventAction::Set(k) => {
                let targets: Vec<&str> = model.sets[*k].values.iter().map(|(target, _)| self.target(*target)).collect();
                format!("set {}", targets.join(", "))
            }
            EventAction::Contact(k) => format!("decide contacts anew, {} first", model.contacts[*k].name),
            EventAction::Impact { along, .. } => format!("an impact along {}", model.constraints[*along].name),
        }
    }

    fn target(&self, target: Target) -> &str {
        match target {
            Target::Memory(k) => &self.program.model.memory[k].name,
            Target::State(k) => &self.program.model.states[k].name,
        }
    }

    /// What is written of all that events set.
    pub fn about_assignments(&self) -> String {
        let names =
            self.program.model.sets.iter().flat_map(|set| set.values.iter().map(|(target, _)| self.target(*target)));
        let names: Vec<&str> = names.collect();
        format!(
            "Values of all that events set, set by set: {}.",
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        )
    }
}

/// The phase in force, and how another is put in force.
fn phase(count: usize, first: usize) -> String {
    if count == 0 {
        return "\nint NAME_phase(const double *c) {\n    (void)c;\n    return 0;\n}\n\nvoid NAME_set_phase(double *c, int phase) {\n    (void)c; (void)phase;\n}\n".to_owned();
    }
    format!(
        "\nint NAME_phase(const double *c) {{\n    int phase = 0;\n    while (phase < {} && c[{first} + phase] == 0.0) phase++;\n    return phase;\n}}\n\nvoid NAME_set_phase(double *c, int phase) {{\n    for (int k = 0; k < {count}; k++) c[{first} + k] = k == phase;\n}}\n",
        count - 1
    )
}

/// How all is used, after the file's own words.
const HEAD: &str = "
Generated by dalembert: C99, which allocates nothing and has no globals.  All numbers are in SI units; q are the coordinates,
v = q', a = q'', l the multipliers, u the inputs with their rates (u, u', u'' of each, one after the other), t the time.

    NAME_parameters p;
    double c[GUARD_CONSTANTS];
    NAME_defaults(&p);
    NAME_constants(&p, c);
    NAME_inputs(c, t, u);
    NAME_accelerations(c, t, u, q, v, a, l);

c holds the parameters, what is made of them alone, the modes of discontinuities, the phase and the held values.";

/// Functions that every header declares.
const DECLARATIONS: &str = "
/* The file's values. */
void NAME_defaults(NAME_parameters *p);

/* A parameter by its place; NULL beyond the last. */
double *NAME_parameter(NAME_parameters *p, int place);

/* Fills the block c, which all other functions read: with modes 1, the first phase, and held values as at the start. */
void NAME_constants(const NAME_parameters *p, double *c);

/* The file's functions of time for the inputs: u, u', u'' of each.  Any other numbers may be given instead. */
void NAME_inputs(const double *c, double t, double *u);

/* The modes, one for each discontinuity, which stand for sign and step in the equations. */
double *NAME_modes(double *c);

/* The held values; nothing here sets them. */
double *NAME_memory(double *c);

/* The phase in force. */
int NAME_phase(const double *c);
void NAME_set_phase(double *c, int phase);

/* The rows that act in a phase, and how many of them are independent in general. */
int NAME_rows(int phase, int *rows, int *rank);

/* Sets the modes as the state asks for. */
void NAME_settle(double *c, double t, const double *u, const double *q, const double *v, const double *a, const double *l);
";
