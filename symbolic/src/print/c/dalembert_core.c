#include <float.h>
#include <math.h>
#include <string.h>

/* A row whose pivot is below this part of its norm is left out; with more rows than MANY ordinary pivots are smaller. */
#define WEAK 1e-3
#define MANY 8.0
/* Friction that leaves this part of a pivot, or less, lets the reaction grow without bound. */
#define PAINLEVE 1e-9
/* A pivot of M is rounding below this part of its diagonal, after so many roundings. */
#define NOTHING 1e-11
#define ROUNDINGS 64.0
/* Rows that inertias bring this much nearer to each other lose digits by it. */
#define LOPSIDED 30.0

double dalembert_sign(double x) {
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;
}

double dalembert_step(double x) {
    return x >= 0.0 ? 1.0 : x < 0.0 ? 0.0 : x;
}

double dalembert_min(double x, double y) {
    return y < x || y != y ? y : x;
}

double dalembert_max(double x, double y) {
    return y > x || y != y ? y : x;
}

double dalembert_table(double x, int order, int count, const double *knots, const double (*pieces)[4], double period,
                       double rise) {
    const double turns = period > 0.0 ? floor((x - knots[0]) / period) : 0.0;
    const double turned = turns * period;
    int low = 0, high = count;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (knots[middle] <= x - turned) low = middle + 1; else high = middle;
    }
    const double d = x - (knots[low > 0 ? low - 1 : 0] + turned);
    double sum = 0.0;
    for (int power = 3; power >= order; power--) {
        double falling = 1.0;
        for (int k = power - order + 1; k <= power; k++) falling *= k;
        sum = sum * d + falling * pieces[low][power];
    }
    return order == 0 ? sum + turns * rise : sum;
}

/* The place of (i, j), j <= i, in a packed lower triangle. */
static int packed(int i, int j) {
    return i * (i + 1) / 2 + j;
}

/* L D L^T of a packed lower triangle in place: L below the diagonal, the reciprocals of D on it. */
static int factor_packed(int n, double *m) {
    for (int i = 0; i < n; i++) {
        const double diagonal = m[packed(i, i)];
        double pivot = diagonal;
        for (int j = 0; j < i; j++)
            for (int k = 0; k < j; k++) m[packed(i, j)] -= m[packed(i, k)] * m[packed(j, k)];
        for (int j = 0; j < i; j++) {
            const double scaled = m[packed(i, j)], factor = scaled * m[packed(j, j)];
            pivot -= factor * scaled;
            m[packed(i, j)] = factor;
        }
        if (!(fabs(pivot) > 4.0 * DBL_EPSILON * fabs(diagonal))) return i + 1;
        m[packed(i, i)] = 1.0 / pivot;
    }
    return 0;
}

/* f becomes L^-1 f. */
static void forward(int n, const double *m, double *f) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j < i; j++) f[i] -= m[packed(i, j)] * f[j];
}

/* f becomes L^-T D^-1 f. */
static void back(int n, const double *m, double *f) {
    for (int i = n - 1; i >= 0; i--) {
        f[i] *= m[packed(i, i)];
        for (int j = i + 1; j < n; j++) f[i] -= m[packed(j, i)] * f[j];
    }
}

int dalembert_solve(int n, double *mass, const double *h, double *a) {
    for (int i = 0; i < n; i++)
        for (int j = 0; j <= i; j++) mass[packed(i, j)] = mass[i * n + j];
    const int singular = factor_packed(n, mass);
    if (singular) return singular;
    for (int i = 0; i < n; i++) a[i] = -h[i];
    forward(n, mass, a);
    back(n, mass, a);
    return 0;
}

/* M and J of one state, factored. */
typedef struct system_ {
    int n, m, rank, usual;
    const double *mass, *rows, *gamma;
    double *factor;    /* L and the reciprocals of D, packed */
    double *half;      /* L^-1 J^T, a line for each row */
    double *pushed;    /* L^-1 (J^T + B) likewise */
    double *schur;     /* the Cholesky factor of J M^-1 J^T, scaled, in the order of the pivots */
    double *rubbed;    /* J M^-1 (J^T + B) of the rows that are kept */
    double *idle;      /* combinations of multipliers without effect */
    double *norms;     /* of the rows */
    double *strength;  /* what J^T J was added to M with, row by row, where M alone is singular */
    double *right, *found, *lengths, *least;
    double *square, *determined;
    int *order, *known;
    double weakest;
} system_;

static system_ system_of(int n, int m, int usual, const double *mass, const double *rows, const double *gamma,
                         double *doubles, int *ints) {
    system_ s = {n, m, 0, usual, mass, rows, gamma, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.0};
    double **const parts[] = {&s.factor, &s.half, &s.pushed, &s.schur, &s.rubbed, &s.idle, &s.norms, &s.strength,
                              &s.right, &s.found, &s.lengths, &s.least, &s.square, &s.determined};
    const int sizes[] = {n * (n + 1) / 2, m * n, m * n, m * m, m * m, m * m, m, m, m, m, m, m, n * n, n};
    for (int k = 0; k < 14; k++) {
        *parts[k] = doubles;
        doubles += sizes[k];
    }
    s.order = ints;
    s.known = ints + m;
    return s;
}

static void load_mass(system_ *s) {
    for (int i = 0; i < s->n; i++)
        for (int j = 0; j <= i; j++) s->factor[packed(i, j)] = s->mass[i * s->n + j];
}

/* x^T D^-1 y. */
static double weighted(const system_ *s, const double *x, const double *y) {
    double sum = 0.0;
    for (int i = 0; i < s->n; i++) sum += s->factor[packed(i, i)] * x[i] * y[i];
    return sum;
}

/* 1 + a coordinate to which M leaves no more inertia than rounding does. */
static int nearly_singular(const system_ *s) {
    double least = 1.0;
    for (int i = 0; i < s->n; i++) {
        const double pivot = 1.0 / s->factor[packed(i, i)];
        double whole = 0.0;
        for (int j = 0; j < i; j++) whole += s->factor[packed(i, j)] * s->factor[packed(i, j)] * (1.0 / s->factor[packed(j, j)]);
        const double part = pivot / (pivot + whole);
        if (part <= fmax(NOTHING, ROUNDINGS * DBL_EPSILON / least)) return i + 1;
        least = fmin(least, part);
    }
    return 0;
}

/* Factors M + J^T R J, which is regular where M is so on the motions that the rows leave. */
static int strengthen(system_ *s) {
    const int n = s->n;
    double largest = 0.0;
    for (int i = 0; i < n; i++) largest = fmax(largest, fabs(s->factor[packed(i, i)]));
    for (int k = 0; k < s->m; k++) {
        const double *row = s->rows + k * n;
        double by_mass = 0.0, size = 0.0;
        for (int i = 0; i < n; i++) {
            const double own = s->factor[packed(i, i)];
            if (own > 0.0) by_mass += row[i] * row[i] / own;
            size += row[i] * row[i];
        }
        s->strength[k] = size > 0.0 ? fmax(by_mass > 0.0 ? 1.0 / by_mass : 0.0, largest / size) : 0.0;
    }
    for (int k = 0; k < s->m; k++) {
        const double *row = s->rows + k * n;
        for (int i = 0; i < n; i++)
            for (int j = 0; j <= i && row[i] != 0.0; j++) s->factor[packed(i, j)] += s->strength[k] * row[i] * row[j];
    }
    return factor_packed(n, s->factor);
}

static void exchange(double *matrix, int m, int k, int l) {
    for (int c = 0; c < m; c++) {
        const double x = matrix[k * m + c];
        matrix[k * m + c] = matrix[l * m + c];
        matrix[l * m + c] = x;
    }
    for (int r = 0; r < m; r++) {
        const double x = matrix[r * m + k];
        matrix[r * m + k] = matrix[r * m + l];
        matrix[r * m + l] = x;
    }
}

/* One step of the pivoted Cholesky factorization. */
static void eliminate(double *schur, int m, int k, double size) {
    schur[k * m + k] = size;
    for (int i = k + 1; i < m; i++) schur[i * m + k] *= 1.0 / size;
    for (int i = k + 1; i < m; i++) {
        const double factor = schur[i * m + k];
        for (int j = k + 1; j <= i; j++) {
            schur[i * m + j] -= factor * schur[j * m + k];
            if (i != j) schur[j * m + i] = schur[i * m + j];
        }
    }
}

/* J M^-1 J^T, its rows scaled by their norms, or such that they have these lengths. */
static void scaled_schur(system_ *s, const double *lengths) {
    const int n = s->n, m = s->m;
    memcpy(s->half, s->rows, (size_t)(m * n) * sizeof(double));
    for (int k = 0; k < m; k++) forward(n, s->factor, s->half + k * n);
    for (int k = 0; k < m; k++) {
        for (int l = 0; l <= k; l++) s->schur[k * m + l] = s->schur[l * m + k] = weighted(s, s->half + k * n, s->half + l * n);
        const double norm = sqrt(fmax(s->schur[k * m + k], 0.0));
        s->norms[k] = !lengths ? norm : lengths[k] > 0.0 ? norm / lengths[k] : 0.0;
    }
    for (int k = 0; k < m; k++)
        for (int l = 0; l < m; l++) {
            const double scale_k = s->norms[k] > 0.0 ? 1.0 / s->norms[k] : 0.0;
            const double scale_l = s->norms[l] > 0.0 ? 1.0 / s->norms[l] : 0.0;
            s->schur[k * m + l] *= scale_k * scale_l;
        }
}

/* Chooses the rows by pivoted Cholesky. */
static void find_rows(system_ *s, const double *lengths) {
    const int m = s->m;
    const double weak = WEAK * fmin(MANY / (m > 1 ? m : 1), 1.0);
    scaled_schur(s, lengths);
    for (int k = 0; k < m; k++) s->order[k] = k;
    s->rank = m;
    s->weakest = 1.0;
    for (int k = 0; k < m; k++) {
        int best = k;
        double size = sqrt(fmax(s->schur[k * m + k], 0.0));
        for (int i = k + 1; i < m; i++) {
            const double other = sqrt(fmax(s->schur[i * m + i], 0.0));
            if (other < size) continue;
            best = i;
            size = other;
        }
        s->weakest = fmin(s->weakest, size);
        if (!(size > weak)) {
            s->rank = k;
            break;
        }
        exchange(s->schur, m, k, best);
        const int row = s->order[k];
        s->order[k] = s->order[best];
        s->order[best] = row;
        eliminate(s->schur, m, k, size);
    }
}

/* The least pivot of as many rows as are independent in general, or that of the first that was left out. */
static double distance(const system_ *s) {
    double least = 1.0;
    if (s->rank < s->usual) return s->weakest;
    for (int k = 0; k < s->usual; k++) least = fmin(least, s->schur[k * s->m + k]);
    return least;
}

/* Factors M alone. */
static int factor_plain(system_ *s) {
    for (int k = 0; k < s->m; k++) s->strength[k] = 0.0;
    load_mass(s);
    return factor_packed(s->n, s->factor);
}

/* Rows may seem to depend on each other because masses are very different: M + J^T R J, which moves alike, tells them apart. */
static void part_rows(system_ *s) {
    const double plain = distance(s);
    if (plain * LOPSIDED > 1.0) return;
    for (int k = 0; k < s->m; k++) {
        const double *half = s->half + k * s->n;
        s->lengths[k] = s->norms[k] > 0.0 ? sqrt(weighted(s, half, half)) / s->norms[k] : 0.0;
    }
    load_mass(s);
    const int failed = strengthen(s);
    find_rows(s, s->lengths);
    if (failed || distance(s) < LOPSIDED * plain) {
        factor_plain(s);
        find_rows(s, NULL);
    }
}

static int factor_system(system_ *s) {
    const int singular = factor_plain(s);
    const int fault = singular ? singular : s->m ? nearly_singular(s) : 0;
    if (fault) {
        load_mass(s);
        if (strengthen(s)) {
            if (singular) return fault;
            factor_plain(s);
        }
    }
    find_rows(s, NULL);
    if (!fault) part_rows(s);
    return 0;
}

/* S x = b with the rows that were kept, in place. */
static void cholesky_solve(system_ *s, double *b) {
    const int m = s->m;
    double *y = s->right;
    for (int i = 0; i < s->rank; i++) {
        double known = 0.0;
        for (int j = 0; j < i; j++) known += s->schur[i * m + j] * y[j];
        y[i] = (b[s->order[i]] / s->norms[s->order[i]] - known) / s->schur[i * m + i];
    }
    for (int i = s->rank - 1; i >= 0; i--) {
        double known = 0.0;
        for (int j = i + 1; j < s->rank; j++) known += s->schur[j * m + i] * y[j];
        y[i] = (y[i] - known) / s->schur[i * m + i];
    }
    for (int k = 0; k < m; k++) b[k] = 0.0;
    for (int i = 0; i < s->rank; i++) b[s->order[i]] = y[i] / s->norms[s->order[i]];
}

/* J M^-1 (J^T + B) x = b with the rows that were kept, in place. */
static int rub(system_ *s, double *b) {
    const int n = s->n, rank = s->rank;
    double *r = s->rubbed, *x = s->right;
    for (int i = 0; i < rank; i++) {
        const int k = s->order[i];
        x[i] = b[k] / s->norms[k];
        for (int j = 0; j < rank; j++) {
            const int l = s->order[j];
            r[i * rank + j] = weighted(s, s->half + k * n, s->pushed + l * n) / (s->norms[k] * s->norms[l]);
        }
    }
    for (int i = 0; i < rank; i++) {
        const double own = s->schur[i * s->m + i];
        if (!(r[i * rank + i] > PAINLEVE * (own * own))) return -1 - s->order[i];
        for (int k = i + 1; k < rank; k++) {
            const double factor = r[k * rank + i] / r[i * rank + i];
            for (int l = i + 1; l < rank; l++) r[k * rank + l] -= factor * r[i * rank + l];
            x[k] -= factor * x[i];
        }
    }
    for (int i = rank - 1; i >= 0; i--) {
        double known = 0.0;
        for (int k = i + 1; k < rank; k++) known += r[i * rank + k] * x[k];
        x[i] = (x[i] - known) / r[i * rank + i];
    }
    for (int k = 0; k < s->m; k++) b[k] = 0.0;
    for (int i = 0; i < rank; i++) b[s->order[i]] = x[i] / s->norms[s->order[i]];
    return 0;
}

/* x becomes A^-1 x by elimination with column pivots; 0 where A is singular. */
static int solve_square(int n, double *a, double *x) {
    for (int k = 0; k < n; k++) {
        int best = k;
        for (int i = k + 1; i < n; i++)
            if (fabs(a[i * n + k]) > fabs(a[best * n + k])) best = i;
        const double moved = x[k];
        x[k] = x[best];
        x[best] = moved;
        for (int j = 0; j < n && best != k; j++) {
            const double y = a[k * n + j];
            a[k * n + j] = a[best * n + j];
            a[best * n + j] = y;
        }
        if (!(fabs(a[k * n + k]) > 0.0 && fabs(a[k * n + k]) <= DBL_MAX)) return 0;
        for (int i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k + 1; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (int i = n - 1; i >= 0; i--) {
        for (int j = i + 1; j < n; j++) x[i] -= a[i * n + j] * x[j];
        x[i] /= a[i * n + i];
    }
    return 1;
}

/* Takes accelerations that rows determine by themselves from the rows, without the rounding of forces. */
static void determine(system_ *s, double *a) {
    const int n = s->n;
    int left = s->rank, goes_on = 1;
    for (int i = 0; i < n; i++) s->known[i] = 0;
    while (goes_on) {
        goes_on = 0;
        for (int k = 0; k < s->rank; k++) {
            const double *row = s->rows + s->order[k] * n;
            int unknown = 0, i = 0;
            double others = 0.0;
            for (int j = 0; j < n; j++)
                if (row[j] != 0.0 && !s->known[j]) {
                    unknown++;
                    i = j;
                }
            if (unknown != 1) continue;
            for (int j = 0; j < n; j++)
                if (j != i && row[j] != 0.0) others += row[j] * a[j];
            a[i] = -(s->gamma[s->order[k]] + others) / row[i];
            s->known[i] = 1;
            left--;
            goes_on = 1;
        }
    }
    if (s->rank < n || left == 0) return;
    for (int k = 0; k < n; k++) {
        memcpy(s->square + k * n, s->rows + s->order[k] * n, (size_t)n * sizeof(double));
        s->determined[k] = -s->gamma[s->order[k]];
    }
    if (solve_square(n, s->square, s->determined)) memcpy(a, s->determined, (size_t)n * sizeof(double));
}

/* Makes multipliers the least of all that have the same effect, where rows depend on each other everywhere. */
static void spread(system_ *s, double *lambda) {
    const int m = s->m, rank = s->rank, count = m - rank;
    double *scaled = s->found, *right = s->least, *normal = s->rubbed;
    if (count == 0 || rank < s->usual) return;
    /* Column k of the idle combinations: [-L1^-T L_k^T; e_k]. */
    for (int k = 0; k < count; k++) {
        for (int i = 0; i < count; i++) s->idle[(rank + i) * count + k] = i == k;
        for (int i = rank - 1; i >= 0; i--) {
            double x = s->schur[(rank + k) * m + i];
            for (int j = i + 1; j < rank; j++) x += s->schur[j * m + i] * s->idle[j * count + k];
            s->idle[i * count + k] = -x / s->schur[i * m + i];
        }
    }
    for (int i = 0; i < m; i++) scaled[i] = lambda[s->order[i]] * s->norms[s->order[i]];
    for (int k = 0; k < count; k++) {
        right[k] = 0.0;
        for (int i = 0; i < m; i++) right[k] += s->idle[i * count + k] * scaled[i];
        for (int l = 0; l < count; l++) {
            normal[k * count + l] = 0.0;
            for (int i = 0; i < m; i++) normal[k * count + l] += s->idle[i * count + k] * s->idle[i * count + l];
        }
    }
    if (!solve_square(count, normal, right)) return;
    for (int i = 0; i < m; i++) {
        for (int k = 0; k < count; k++) scaled[i] -= s->idle[i * count + k] * right[k];
        const double norm = s->norms[s->order[i]];
        lambda[s->order[i]] = norm > 0.0 ? scaled[i] / norm : 0.0;
    }
}

/* L^-1 (J^T + B), and what B makes of the part of lambda that the strengthened M does not see. */
static void load_friction(system_ *s, const double *friction, double *force) {
    const int n = s->n;
    for (int k = 0; k < s->m; k++) {
        for (int i = 0; i < n; i++) {
            s->pushed[k * n + i] = s->rows[k * n + i] + friction[k * n + i];
            force[i] += friction[k * n + i] * s->strength[k] * s->gamma[k];
        }
        forward(n, s->factor, s->pushed + k * n);
    }
}

int dalembert_constrained(int n, int m, int rank, const double *mass, const double *h, const double *rows,
                          const double *gamma, const double *friction, double *a, double *lambda, double *doubles,
                          int *ints) {
    system_ s = system_of(n, m, rank, mass, rows, gamma, doubles, ints);
    int failed = factor_system(&s);
    if (failed) return failed;
    for (int i = 0; i < n; i++) a[i] = -h[i];
    if (friction) load_friction(&s, friction, a);
    forward(n, s.factor, a);
    for (int k = 0; k < m; k++) s.found[k] = -gamma[k] - weighted(&s, s.half + k * n, a);
    if (friction) failed = rub(&s, s.found); else cholesky_solve(&s, s.found);
    if (failed) return failed;
    const double *lines = friction ? s.pushed : s.half;
    for (int k = 0; k < m; k++)
        for (int i = 0; i < n; i++) a[i] += s.found[k] * lines[k * n + i];
    back(n, s.factor, a);
    determine(&s, a);
    for (int k = 0; k < m; k++) lambda[k] = s.found[k] + s.strength[k] * gamma[k];
    if (!friction) spread(&s, lambda);
    return 0;
}
