//! Accelerations and multipliers in C.

use super::Printing;
use super::function::{arguments, read, unread};
use crate::lower::Accelerations;
use crate::print::body::Use;
use crate::print::function::stores;

/// What the header says.
pub(super) const DECLARATION: &str = "
/* a = q'', n numbers, and l, the multipliers of all rows (0 in those that do not act in the phase), from M a + h = (J^T + B) l,
   J a + gamma = 0.  Without constraints l is not touched and may be NULL.
   Returns 0; 1 + the coordinate whose inertia vanishes; or -1 - the row in which friction leaves no reaction, or more than one. */
int NAME_accelerations(const double *c, double t, const double *u, const double *q, const double *v, double *a, double *l);
";

/// M a = -h where M is not factored in the code.
const LOOP: &str = "    double mass[SIZE * SIZE], h[SIZE];
    NAME_mass_matrix(c, t, u, q, v, mass);
    NAME_bias(c, t, u, q, v, h);
    return dalembert_solve(SIZE, mass, h, a);
";

/// Accelerations with the rows of the phase in force.
const CONSTRAINED: &str = "
int NAME_accelerations(const double *c, double t, const double *u, const double *q, const double *v, double *a, double *l) {
    enum { N = SIZE, ROWS = COUNT };
    double mass[N * N], h[N], matrix[ROWS * N], gamma[ROWS];
    double rows[ROWS * N], bias[ROWS], lambda[ROWS], doubles[DALEMBERT_DOUBLES(N, ROWS)];
    int active[ROWS], ints[DALEMBERT_INTS(N, ROWS)], rank;
    const int m = NAME_rows(NAME_phase(c), active, &rank);
    for (int k = 0; k < ROWS; k++) l[k] = 0.0;
    if (m == 0) return NAME_free(c, t, u, q, v, a);
    NAME_mass_matrix(c, t, u, q, v, mass);
    NAME_bias(c, t, u, q, v, h);
    NAME_constraint_matrix(c, t, u, q, matrix);
    NAME_constraint_bias(c, t, u, q, v, gamma);
    for (int k = 0; k < m; k++) {
        bias[k] = gamma[active[k]];
        for (int i = 0; i < N; i++) rows[k * N + i] = matrix[active[k] * N + i];
    }
RUB    const int failed = dalembert_constrained(N, m, rank, mass, h, rows, bias, PUSHED, a, lambda, doubles, ints);
    if (failed >= 0) for (int k = 0; k < m; k++) l[active[k]] = lambda[k];
    return failed < 0 ? -1 - active[-1 - failed] : failed;
}
";

/// B of the rows in force, where there is any.
const RUB: &str = "    double rub[N * ROWS], friction[ROWS * N];
    NAME_friction(c, t, u, q, v, rub);
    for (int k = 0; k < m; k++)
        for (int i = 0; i < N; i++) friction[k * N + i] = rub[i * ROWS + active[k]];
";

impl Printing<'_> {
    /// The functions that find accelerations.
    pub fn accelerations(&self) -> String {
        let (n, rows) = (self.program.model.coordinates.len(), self.program.constraints.len());
        let free = self.free(if rows > 0 { "static int NAME_free" } else { "int NAME_accelerations" }, rows == 0);
        let (rub, pushed) = if self.program.constraints.friction.is_empty() { ("", "NULL") } else { (RUB, "friction") };
        let constrained = match rows {
            0 => String::new(),
            _ => CONSTRAINED
                .replace("SIZE", &n.to_string())
                .replace("COUNT", &rows.to_string())
                .replace("RUB", rub)
                .replace("PUSHED", pushed),
        };
        (free + &constrained).replace("NAME", self.prefix)
    }

    /// Those where no row acts.
    fn free(&self, name: &str, multipliers: bool) -> String {
        let n = self.program.model.coordinates.len();
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
                out += &LOOP.replace("SIZE", &n.to_string());
            }
        }
        out + "}\n"
    }
}
