#include "fmu_instance.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Places in a step at which events are looked for. */
#define SAMPLES 12
/* Steps beyond which an integration is given up. */
#define MOST_STEPS 10000000

/* Dormand and Prince, A family of embedded Runge-Kutta formulae, J. Comput. Appl. Math. 6 (1980) 19. */
static const double nodes[7] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
static const double tableau[7][6] = {
    {0.0},
    {1.0 / 5},
    {3.0 / 40, 9.0 / 40},
    {44.0 / 45, -56.0 / 15, 32.0 / 9},
    {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
    {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
    {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84},
};
static const double error_weights[7] = {71.0 / 57600,        0.0,          -71.0 / 16695, 71.0 / 1920,
                                        -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40};

static void take(instance *m, double t, const double *x) {
    m->t = t;
    memcpy(m->q, x, MECHANICAL * sizeof(double));
    memcpy(m->v, x + MECHANICAL, COORDINATES * sizeof(double));
    m->known = 0;
}

static void give(const instance *m, double *x) {
    memcpy(x, m->q, MECHANICAL * sizeof(double));
    memcpy(x + MECHANICAL, m->v, COORDINATES * sizeof(double));
}

static int rate(instance *m, double *f) {
    if (!evaluate(m)) return 0;
    memcpy(f, m->v, MECHANICAL * sizeof(double));
    memcpy(f + MECHANICAL, m->a, COORDINATES * sizeof(double));
    return 1;
}

/* One step from x, its rates in k[0]; the state becomes its end, k[6] the rates there.  The error in units of the tolerance, infinite where it fails. */
static double step(instance *m, double t, double h, const double *x, double k[7][ROOM(STATES)]) {
    double y[ROOM(STATES)], error = 0.0;
    for (int stage = 1; stage < 7; stage++) {
        for (int i = 0; i < STATES; i++) {
            double sum = 0.0;
            for (int j = 0; j < stage; j++) sum += tableau[stage][j] * k[j][i];
            y[i] = x[i] + h * sum;
        }
        take(m, t + nodes[stage] * h, y);
        if (!rate(m, k[stage])) return HUGE_VAL;
    }
    for (int i = 0; i < STATES; i++) {
        double sum = 0.0;
        for (int j = 0; j < 7; j++) sum += error_weights[j] * k[j][i];
        const double scale = m->tolerance * fmax(fmax(fabs(x[i]), fabs(y[i])), nominal[i]);
        error = fmax(error, fabs(h * sum) / scale);
    }
    return error == error ? error : HUGE_VAL;
}

/* The state at a part s of a step, by Hermite's cubic. */
static void between(double s, double h, const double *x, const double *y, const double *f, const double *g, double *out) {
    for (int i = 0; i < STATES; i++) {
        const double d = y[i] - x[i];
        out[i] = x[i] + s * (h * f[i] + s * (3.0 * d - h * (2.0 * f[i] + g[i]) + s * (h * (f[i] + g[i]) - 2.0 * d)));
    }
}

/* Whether something passed its zero between these indicators. */
static int passed(const double *before, const double *now) {
    for (int k = 0; k < INDICATORS; k++)
        if ((before[k] > 0.0) != (now[k] > 0.0)) return 1;
    return 0;
}

/* The part of a step before which nothing passes a zero; 1 where nothing does in it. */
static double first_sample(instance *m, double t, double h, const double *x, double k[7][ROOM(STATES)], const double *before) {
    double y[ROOM(STATES)], at[ROOM(STATES)], z[ROOM(INDICATORS)];
    give(m, y);
    const double end = m->t;
    for (int sample = 1; sample <= SAMPLES; sample++) {
        const double s = (double)sample / SAMPLES;
        between(s, h, x, y, k[0], k[6], at);
        take(m, t + s * h, at);
        if (indicators(m, z) && passed(before, z)) {
            take(m, end, y);
            return s;
        }
    }
    take(m, end, y);
    return 2.0;
}

/* Ends a step right after the first zero in it: steps of other lengths from the same start, halved between one before and one after it. */
static int to_event(instance *m, double t, double high, const double *x, double k[7][ROOM(STATES)], const double *before) {
    double low = 0.0, z[ROOM(INDICATORS)];
    for (int trial = 0; trial < 200 && high - low > 4.0 * DBL_EPSILON * fmax(fabs(t), high); trial++) {
        const double middle = trial == 0 ? high : 0.5 * (low + high);
        if (step(m, t, middle, x, k) == HUGE_VAL || !indicators(m, z)) return 0;
        if (passed(before, z)) high = middle; else low = middle;
        if (trial == 0 && low == middle) return 1;
    }
    return step(m, t, high, x, k) < HUGE_VAL && indicators(m, z);
}

/* The first step: a hundredth of the time in which the state changes by as much as it is. */
static double first_step(const double *x, const double *f, double most) {
    double shortest = most;
    for (int i = 0; i < STATES; i++)
        if (f[i] != 0.0) shortest = fmin(shortest, 0.01 * fmax(fabs(x[i]), nominal[i]) / fabs(f[i]));
    return fmax(shortest, 1e-9 * most);
}

/* One accepted step to `end` at the most, and what happens at its end. */
static int advance(instance *m, double end) {
    double x[ROOM(STATES)], k[7][ROOM(STATES)], before[ROOM(INDICATORS)];
    const double t = m->t;
    int changed;
    give(m, x);
    if (!rate(m, k[0]) || !indicators(m, before)) return 0;
    double h = m->step > 0.0 ? m->step : first_step(x, k[0], end - t);
    for (;;) {
        const int last = h >= 0.999 * (end - t);
        const double tried = last ? end - t : h, error = step(m, t, tried, x, k);
        if (error <= 1.0) {
            const double grown = h * fmin(5.0, 0.9 * pow(fmax(error, 1e-10), -0.2));
            m->step = last && tried < h ? h : grown;
            if (last) m->t = end;
            h = tried;
            break;
        }
        h = tried * (error < HUGE_VAL ? fmax(0.2, 0.9 * pow(error, -0.2)) : 0.1);
        if (!(h > 16.0 * DBL_EPSILON * fmax(fabs(t), end - t))) return 0;
    }
    const double sample = INDICATORS ? first_sample(m, t, h, x, k, before) : 2.0;
    if (sample <= 1.0) {
        if (!to_event(m, t, sample * h, x, k, before)) return 0;
        if (ROWS && !project(m)) return 0;
        m->step = 0.0;
        return happen(m, &changed);
    }
    m->known = 0;
    return !ROWS || project(m);
}

int integrate(instance *m, double until) {
    for (long count = 0; m->t < until && !m->stopped; count++) {
        const double tick = next_tick(m);
        int changed;
        if (count > MOST_STEPS || !advance(m, fmin(until, fmax(tick, m->t)))) return 0;
        if (m->t >= tick) {
            m->step = 0.0;
            if (!happen(m, &changed)) return 0;
        }
    }
    return 1;
}
