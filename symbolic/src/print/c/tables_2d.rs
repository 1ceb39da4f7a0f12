//! Tables of two arguments in C, with the functions that evaluate them: files without such tables have neither.

use std::fmt::Write;

use super::Printing;
use super::dialect::{comment, float};

/// Evaluates a table of two arguments; PREFIX stands for what the names of all functions begin with.
const EVALUATION: &str = "
/* The piece between knots in which x lies; x becomes the distance from the knot before. */
static int PREFIX_table_2d_piece(double *x, int count, const double *knots, double period) {
    const double turned = period > 0.0 ? floor((*x - knots[0]) / period) * period : 0.0;
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (knots[middle] <= *x - turned) low = middle + 1; else high = middle;
    }
    *x -= knots[low > 0 ? low - 1 : 0] + turned;
    return low;
}

/* power (power - 1) ..., so many factors. */
static double PREFIX_table_2d_falling(int power, int count) {
    double product = 1.0;
    for (int k = power - count + 1; k <= power; k++) product *= k;
    return product;
}

/* The sum of c[a][b] x^a y^b, differentiated so often by x and by y. */
static double PREFIX_table_2d_bicubic(double x, double y, int of_x, int of_y, const double (*c)[4]) {
    double sum = 0.0;
    for (int a = 3; a >= of_x; a--) {
        double line = 0.0;
        for (int b = 3; b >= of_y; b--)
            line = line * y + PREFIX_table_2d_falling(a, of_x) * PREFIX_table_2d_falling(b, of_y) * c[a][b];
        sum = sum * x + line;
    }
    return sum;
}
";

/// Names of these functions and of those of so many tables.
pub(super) fn names(prefix: &str, count: usize) -> impl Iterator<Item = String> {
    let tables = (0..count).map(|place| place.to_string());
    let evaluation = ["piece", "falling", "bicubic"].into_iter().map(str::to_owned);
    let prefix = prefix.to_owned();
    evaluation.chain(tables).map(move |end| format!("{prefix}_table_2d_{end}"))
}

impl Printing<'_> {
    /// The functions of all tables of two arguments.
    pub fn tables_2d(&self) -> String {
        let tables = self.program.tables_2d();
        let mut out = if tables.is_empty() { String::new() } else { EVALUATION.replace("PREFIX", self.prefix) };
        for (place, table) in tables.into_iter().enumerate() {
            let list = |numbers: &[f64]| numbers.iter().map(|x| float(*x)).collect::<Vec<_>>().join(", ");
            let rows = |piece: &[[f64; 4]; 4]| piece.map(|row| format!("{{{}}}", list(&row))).join(", ");
            let pieces: Vec<String> = table.pieces().iter().map(|piece| format!("{{{}}}", rows(piece))).collect();
            let ([x, y], [x_period, y_period]) = (table.knots(), table.periods().map(|period| period.unwrap_or(0.0)));
            let (start, prefix, name) = (format!("{}_table_2d", self.prefix), self.prefix, comment(table.name()));
            let _ = write!(
                out,
                "\n/* {name}, or one of its derivatives by x and by y. */\nstatic double {prefix}_table_2d_{place}(double x, double y, int of_x, int of_y) {{\n    \
                 static const double xs[] = {{{}}};\n    static const double ys[] = {{{}}};\n    static const double pieces[][4][4] = {{{}}};\n    \
                 const int row = {start}_piece(&x, {}, xs, {}), column = {start}_piece(&y, {}, ys, {});\n    \
                 return {start}_bicubic(x, y, of_x, of_y, pieces[row * {} + column]);\n}}\n",
                list(x),
                list(y),
                pieces.join(", "),
                x.len(),
                float(x_period),
                y.len(),
                float(y_period),
                y.len() + 1,
            );
        }
        out
    }
}
