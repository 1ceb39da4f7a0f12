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
    int n, m, rank, usual, sharing, kept; /* of those that share, in their order, how many there are, and are kept */
    const double *mass, *rows, *gamma;
    double *factor;    /* L and the reciprocals of D, packed */
    double *half;      /* L^-1 J^T, a line for each row */
    double *pushed;    /* L^-1 (J^T + B) likewise */
    double *schur;     /* the Cholesky factor of J M^-1 J^T, scaled, in the order of the pivots */
    double *rubbed;    /* J M^-1 (J^T + B) of the rows that are kept */
    double *shares;    /* how rows share what rows that depend on each other hold */
    double *norms;     /* of the rows */
    double *strength;  /* what J^T J was added to M with, row by row, where M alone is singular */
    double *right, *found, *lengths, *least;
    const char *across; /* 1: a force across a contact, 2: along one that sticks; or NULL */
    double *square, *determined;
    int *order, *places, *known;
    double weakest;
} system_;

static system_ system_of(int n, int m, int usual, const double *mass, const double *rows, const double *gamma,
                         const char *across, double *doubles, int *ints) {
    system_ s;
    memset(&s, 0, sizeof s);
    s.n = n, s.m = m, s.usual = usual;
    s.mass = mass, s.rows = rows, s.gamma = gamma, s.across = across;
    double **const parts[] = {&s.factor, &s.half, &s.pushed, &s.schur, &s.rubbed, &s.shares, &s.norms, &s.strength,
                              &s.right, &s.found, &s.lengths, &s.least, &s.square, &s.determined};
    const int sizes[] = {n * (n + 1) / 2, m * n, m * n, m * m, m * m, m * m, m, m, m, m, m, m, n * n, n};
    for (int k = 0; k < 14; k++) {
        *parts[k] = doubles;
        doubles += sizes[k];
    }
    s.order = ints;
    s.places = ints + m;
    s.known = ints + 2 * m;
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
        int best = k, first = 0;
        double size = -1.0;
        for (int i = k; i < m; i++) {
            const double other = sqrt(fmax(s->schur[i * m + i], 0.0));
            /* What presses is chosen before what sticks, which may be shared otherwise. */
            const int turn = !(other > weak) ? 0 : s->across && s->across[s->order[i]] == 2 ? 1 : 2;
            if (turn < first || (turn == first && other < size)) continue;
            best = i;
            first = turn;
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

/* Of all multipliers that do the same to the rows those with the least sum of w l^2, where rows depend on each other everywhere, but for those of what
   sticks: w = S_kk, of contacts the mean of theirs.  With S = L L^T they are W^-1 L (L^T W^-1 L)^-1 L^T l, of which this is the matrix before L^T; 0 where
   nothing is shared. */
static int share(system_ *s) {
    const int m = s->m, rank = s->rank;
    double *weights = s->least, *normal = s->rubbed, sum = 0.0;
    int count = 0;
    if (rank < s->usual) return 0;
    s->sharing = s->kept = 0;
    while (s->kept < rank && !(s->across && s->across[s->order[s->kept]] == 2)) {
        s->places[s->sharing] = s->kept++;
        s->sharing++;
    }
    for (int i = rank; i < m; i++)
        if (!(s->across && s->across[s->order[i]] == 2)) s->places[s->sharing++] = i;
    if (s->sharing == s->kept) return 0;
    for (int i = 0; i < s->sharing; i++) {
        const int place = s->places[i], k = s->order[place];
        weights[i] = 0.0;
        for (int j = 0; j < s->kept && j <= place; j++) weights[i] += s->schur[place * m + j] * s->schur[place * m + j];
        if (!s->across || s->across[k] != 1) continue;
        sum += weights[i] * s->norms[k] * s->norms[k];
        count++;
    }
    for (int i = 0; i < s->sharing; i++) {
        const int k = s->order[s->places[i]];
        if (s->across && s->across[k] == 1) weights[i] = sum / count / (s->norms[k] * s->norms[k]);
    }
    for (int i = 0; i < s->sharing; i++) {
        const int place = s->places[i];
        for (int j = 0; j < s->kept; j++) {
            const double entry = j <= place && weights[i] > 0.0 ? s->schur[place * m + j] / weights[i] : 0.0;
            s->shares[i * s->kept + j] = entry;
            for (int l = 0; l < s->kept; l++) {
                double *const x = normal + j * s->kept + l;
                *x = 0.0;
                for (int k = 0; k < s->sharing; k++) {
                    const int row = s->places[k];
                    if (j <= row && l <= row && weights[k] > 0.0) *x += s->schur[row * m + j] * s->schur[row * m + l] / weights[k];
                }
            }
        }
        if (!solve_square(s->kept, normal, s->shares + i * s->kept)) return 0;
    }
    return 1;
}

/* Shares scaled multipliers, which are in the order of the pivots. */
static void shared(system_ *s, double *x) {
    double *sums = s->least;
    for (int j = 0; j < s->kept; j++) {
        sums[j] = 0.0;
        for (int i = 0; i < s->sharing; i++)
            if (j <= s->places[i]) sums[j] += s->schur[s->places[i] * s->m + j] * x[s->places[i]];
    }
    for (int i = 0; i < s->sharing; i++) {
        x[s->places[i]] = 0.0;
        for (int j = 0; j < s->kept; j++) x[s->places[i]] += s->shares[i * s->kept + j] * sums[j];
    }
}

/* Makes multipliers those of rows that share forces. */
static void spread(system_ *s, double *lambda) {
    double *scaled = s->right;
    if (!share(s)) return;
    for (int i = 0; i < s->m; i++) scaled[i] = lambda[s->order[i]] * s->norms[s->order[i]];
    shared(s, scaled);
    for (int i = 0; i < s->m; i++) {
        const double norm = s->norms[s->order[i]];
        lambda[s->order[i]] = norm > 0.0 ? scaled[i] / norm : 0.0;
    }
}

/* J M^-1 (J^T + B) x = b with the rows that were kept, or all that share a force, in place. */
static int rub(system_ *s, double *b) {
    const int n = s->n, m = s->m, rank = s->rank, shares = share(s);
    double *r = s->rubbed, *x = s->right, *line = s->found, *sums = s->least;
    for (int i = 0; i < rank; i++) {
        const int k = s->order[i];
        x[i] = b[k] / s->norms[k];
    }
    for (int i = 0; i < rank; i++) {
        const int k = s->order[i];
        for (int j = 0; j < (shares ? m : rank); j++) {
            const int l = s->order[j];
            const double pushed = weighted(s, s->half + k * n, s->pushed + l * n);
            line[j] = s->norms[l] > 0.0 ? pushed / (s->norms[k] * s->norms[l]) : 0.0;
        }
        for (int j = 0; j < s->kept && shares; j++) {
            sums[j] = 0.0;
            for (int l = 0; l < s->sharing; l++) sums[j] += s->shares[l * s->kept + j] * line[s->places[l]];
        }
        for (int j = 0; j < rank; j++) {
            double entry = shares && j < s->kept ? 0.0 : line[j];
            for (int l = 0; l <= j && shares && j < s->kept; l++) entry += s->schur[j * m + l] * sums[l];
            r[i * rank + j] = entry;
        }
    }
    for (int i = 0; i < rank; i++) {
        const double own = s->schur[i * m + i];
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
    for (int i = rank; i < m; i++) x[i] = 0.0;
    if (shares) shared(s, x);
    for (int i = 0; i < m; i++) {
        const double norm = s->norms[s->order[i]];
        b[s->order[i]] = norm > 0.0 ? x[i] / norm : 0.0;
    }
    return 0;
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
                          const double *gamma, const double *friction, const char *across, double *a, double *lambda,
                          double *doubles, int *ints) {
    system_ s = system_of(n, m, rank, mass, rows, gamma, across, doubles, ints);
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
