//! Accelerations and multipliers in C.

use super::Printing;
use super::function::{arguments, read, unread};
use crate::lower::Accelerations;
use crate::print::body::Use;
use crate::print::function::stores;

/// What the header says.
const DECLARATION: &str = "
/* a = q'', n numbers, and l, the multipliers of all rows (0 in those that do not act in the phase), from M a + h = (J^T + B) l,
   J a + gamma = 0.  Without constraints l is not touched and may be NULL.
   Returns 0; 1 + the coordinate whose inertia vanishes; or -1 - the row in which friction leaves no reaction, or more than one. */
int NAME_accelerations(const double *c, double t, const double *u, const double *q, const double *v, double *a, double *l);
";

/// And of slopes.
const DECLARATION_OF_SLOPES: &str = "
/* Changes of a and l, which are those of the state, along a direction, in which theirs are 0.  Where rows depend on each other the change of l is the
   least of all that have the same effect.  Returns what NAME_accelerations does. */
int NAME_acceleration_slopes(const double *c, double t, const double *u, const double *q, const double *v, const double *a, const double *l, const double *along, double *da, double *dl);
";

/// M a = -h where M is not factored in the code.
const LOOP: &str = "    double h[SIZE];
    NAME_bias(c, t, u, q, v, h);
    return NAME_solve(c, t, u, q, v, h, a);
";

/// a of forces h, without rows.
const SOLVE: &str = "
static int NAME_solve(const double *c, double t, const double *u, const double *q, const double *v, const double *h, double *a) {
    double mass[SIZE * SIZE];
    NAME_mass_matrix(c, t, u, q, v, mass);
    return dalembert_solve(SIZE, mass, h, a);
}
";

/// a and l of forces h and what the rows ask for, with the rows of the phase in force.
const CONSTRAINED: &str = "
static int NAME_constrained(const double *c, double t, const double *u, const double *q, const double *v, const double *h, const double *gamma, double *a, double *l) {
    enum { N = SIZE, ROWS = COUNT };
    double mass[N * N], matrix[ROWS * N];
    double rows[ROWS * N] = {0.0}, bias[ROWS] = {0.0}, lambda[ROWS], doubles[DALEMBERT_DOUBLES(N, ROWS)];
    int active[ROWS], ints[DALEMBERT_INTS(N, ROWS)], rank;
    const int m = NAME_rows(NAME_phase(c), active, &rank);
    NAME_mass_matrix(c, t, u, q, v, mass);
    NAME_constraint_matrix(c, t, u, q, matrix);
    for (int k = 0; k < m; k++) {
        bias[k] = gamma[active[k]];
        for (int i = 0; i < N; i++) rows[k * N + i] = matrix[active[k] * N + i];
    }
RUBSHARE    const int failed = dalembert_constrained(N, m, rank, mass, h, rows, bias, PUSHED, CONTACTS, a, lambda, doubles, ints);
    if (failed >= 0) for (int k = 0; k < m; k++) l[active[k]] = lambda[k];
    return failed < 0 ? -1 - active[-1 - failed] : failed;
}

int NAME_accelerations(const double *c, double t, const double *u, const double *q, const double *v, double *a, double *l) {
    double h[SIZE], gamma[COUNT];
    int active[COUNT], rank;
    for (int k = 0; k < COUNT; k++) l[k] = 0.0;
    if (NAME_rows(NAME_phase(c), active, &rank) == 0) return NAME_free(c, t, u, q, v, a);
    NAME_bias(c, t, u, q, v, h);
    NAME_constraint_bias(c, t, u, q, v, gamma);
    return NAME_constrained(c, t, u, q, v, h, gamma, a, l);
}
";

/// B of the rows in force, where there is any.
const RUB: &str = "    double rub[N * ROWS], friction[ROWS * N] = {0.0};
    NAME_friction(c, t, u, q, v, rub);
    for (int k = 0; k < m; k++)
        for (int i = 0; i < N; i++) friction[k * N + i] = rub[i * ROWS + active[k]];
";

/// Which rows in force are forces across contacts, and along them, where there are any.
const SHARE: &str = "    static const char contacts[] = {FLAGS};
    char across[ROWS] = {0};
    for (int k = 0; k < m; k++) across[k] = contacts[active[k]];
";

/// Slopes of accelerations, and of multipliers.
const SLOPES: &str = "
int NAME_acceleration_slopes(const double *c, double t, const double *u, const double *q, const double *v, const double *a, const double *l, const double *along, double *da, double *dl) {
    double slopes[SIZE + COUNT];
    NAME_equation_slopes(c, t, u, q, v, a, l, along, slopes);
";
const SLOPES_FREE: &str = "    (void)dl;
    return NAME_solve(c, t, u, q, v, slopes, da);
}
";
const SLOPES_CONSTRAINED: &str = "    int active[COUNT], rank;
    for (int k = 0; k < COUNT; k++) dl[k] = 0.0;
    if (NAME_rows(NAME_phase(c), active, &rank) == 0) return NAME_solve(c, t, u, q, v, slopes, da);
    return NAME_constrained(c, t, u, q, v, slopes, slopes + SIZE, da, dl);
}
";

impl Printing<'_> {
    /// For the header.
    pub fn declarations_of_accelerations(&self) -> String {
        let slopes = if self.slopes.is_some() { DECLARATION_OF_SLOPES } else { "" };
        [DECLARATION, slopes].concat().replace("NAME", self.prefix)
    }

    /// The functions that find accelerations.
    pub fn accelerations(&self) -> String {
        let (n, rows) = (self.program.model.coordinates.len(), self.program.constraints.len());
        let has_slopes = self.slopes.is_some();
        let solved = has_slopes || matches!(self.program.accelerations, Accelerations::Loop);
        let filled = |text: &str| {
            let sized = text.replace("SIZE", &n.to_string()).replace("COUNT", &rows.to_string());
            sized.replace("NAME", self.prefix)
        };
        let name = filled(if rows > 0 { "static int NAME_free" } else { "int NAME_accelerations" });
        let mut out = filled(if solved { SOLVE } else { "" });
        out += &self.free(&name, rows == 0, &filled(LOOP));
        if rows > 0 {
            let (rub, pushed) =
                if self.program.constraints.friction.is_empty() { ("", "NULL") } else { (RUB, "friction") };
            let model = &self.program.model;
            let normals = model.rows_of_contacts(model.contacts.iter().filter_map(|contact| contact.normal));
            let tangents = model.rows_of_contacts(model.contacts.iter().filter_map(|contact| contact.tangent));
            let flag = |row| match () {
                () if normals.contains(&row) => "1",
                () if tangents.contains(&row) => "2",
                () => "0",
            };
            let flags: Vec<&str> = (0..rows).map(flag).collect();
            let (share, contacts) = match model.contacts.is_empty() {
                true => (String::new(), "NULL"),
                false => (SHARE.replace("FLAGS", &flags.join(", ")), "across"),
            };
            let constrained = CONSTRAINED.replace("RUB", rub).replace("SHARE", &share);
            out += &filled(&constrained.replace("PUSHED", pushed).replace("CONTACTS", contacts));
        }
        if has_slopes {
            out += &filled(SLOPES);
            out += &filled(if rows > 0 { SLOPES_CONSTRAINED } else { SLOPES_FREE });
        }
        out
    }

    /// Those where no row acts, by a loop where they are not unrolled.
    fn free(&self, name: &str, multipliers: bool, by_loop: &str) -> String {
        let more = if multipliers { ", double *l" } else { "" };
        let mut out = format!("\n{name}({}, double *a{more}) {{\n", arguments(2));
        match &self.program.accelerations {
            Accelerations::Unrolled { values, pivots } => {
                let pivots = pivots.iter().map(|(k, pivot, diagonal)| Use::Pivot(*k, *pivot, *diagonal));
                let uses: Vec<Use> = pivots.chain(stores("a", values)).collect();
                let body = self.bodies.body(&uses, "    ");
                let mut names = read(&body, 2);
                names.extend([("a", !values.is_empty()), ("l", !multipliers)]);
                out += &(unread(&names) + &body.lines + "    return 0;\n");
            }
            Accelerations::Loop => {
                out += &unread(&[("l", !multipliers)]);
                out += by_loop;
            }
        }
        out + "}\n"
    }
}
