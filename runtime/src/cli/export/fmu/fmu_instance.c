#include "fmu_instance.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "dalembert_core.h"

/* A function of an event has a sign beyond this part of its largest value. */
#define SURE 1e-12
/* A moment, in parts of the time in which the state changes by as much as it is. */
#define MOMENT 1e-7
/* What is at zero is less than this part of what it changes by in a moment. */
#define NEAR 1e-2
/* Trials of modes, beside one for each; after half of them one mode changes at a time. */
#define TRIALS 20
/* Impacts that leave this part of the fastest are the last: what remains of them is over at once. */
#define LAST 1e-5
/* Events in turn at one instant beyond which they are a cycle. */
#define CASCADE 50
/* A phase whose constraints move a coordinate by more than this part of it is entered where they do not hold. */
#define MISSED 1e-3
/* Newton's steps onto constraints. */
#define STEPS 20
/* A change this small against the values is rounding. */
#define ROUNDING 1e-11

void take_parameters(instance *m) {
    double modes[ROOM(MODES)], memory[ROOM(MEMORY)];
    const int phase = MODEL(phase)(m->c);
    memcpy(modes, MODEL(modes)(m->c), MODES * sizeof(double));
    memcpy(memory, MODEL(memory)(m->c), MEMORY * sizeof(double));
    MODEL(constants)(&m->p, m->c);
    memcpy(MODEL(modes)(m->c), modes, MODES * sizeof(double));
    memcpy(MODEL(memory)(m->c), memory, MEMORY * sizeof(double));
    MODEL(set_phase)(m->c, phase);
    m->known = 0;
}

void begin(instance *m, int co_simulation) {
    memset(m, 0, sizeof *m);
    m->goes_on = co_simulation;
    m->at_event = 1;
    for (int k = 0; k < PARAMETERS; k++) *MODEL(parameter)(&m->p, k) = start_parameters[k];
    MODEL(constants)(&m->p, m->c);
    memcpy(m->q, start_q, COORDINATES * sizeof(double));
    memcpy(m->v, start_v, COORDINATES * sizeof(double));
    memcpy(MODEL(memory)(m->c), start_memory, MEMORY * sizeof(double));
    MODEL(set_phase)(m->c, START_PHASE);
    m->tolerance = TOLERANCE;
}

/* What an input that was set has come to a time later. */
static void gone_on(const double *given, double time, double *u) {
    u[0] = given[0] + time * (given[1] + 0.5 * time * given[2]);
    u[1] = given[1] + time * given[2];
    u[2] = given[2];
}

static int is_set(const instance *m, int input) {
    return m->is_given[3 * input] || m->is_given[3 * input + 1] || m->is_given[3 * input + 2];
}

/* The inputs of the present time. */
static void signals(const instance *m, double *u) {
    MODEL(inputs)(m->c, m->t, u);
    for (int k = 0; k < INPUTS; k++) {
        const double function = u[3 * k];
        if (!is_set(m, k)) continue;
        gone_on(m->given + 3 * k, m->goes_on ? m->t - m->since[k] : 0.0, u + 3 * k);
        if (!m->is_given[3 * k]) u[3 * k] = function;
    }
}

void set_input(instance *m, int signal, double value) {
    const int k = signal / 3, first = !is_set(m, k);
    double u[ROOM(SIGNALS)], *given = m->given + 3 * k;
    signals(m, u);
    if (m->running && (m->goes_on || m->at_event) && !m->is_new[k]) {
        m->is_new[k] = 1;
        m->waited[k] = first ? 0.0 : m->t - m->since[k];
        if (first) memcpy(m->before + 3 * k, u + 3 * k, 3 * sizeof(double));
        else gone_on(given, m->waited[k], m->before + 3 * k);
        if (!m->is_given[3 * k]) m->before[3 * k] = u[3 * k];
    }
    if (m->goes_on) {
        /* It goes on from where it is, whatever of it is set. */
        if (first) given[0] = u[3 * k];
        else memcpy(given, u + 3 * k, 3 * sizeof(double));
        m->is_given[3 * k] = 1;
    }
    m->since[k] = m->t;
    given[signal % 3] = value;
    m->is_given[signal] = 1;
    m->known = 0;
}

int evaluate(instance *m) {
    if (m->known) return !m->failed;
    signals(m, m->u);
    m->failed = MODEL(accelerations)(m->c, m->t, m->u, m->q, m->v, m->a, m->l) != 0;
    for (int i = 0; i < COORDINATES; i++) m->failed = m->failed || !(fabs(m->a[i]) <= DBL_MAX);
    m->known = 1;
    return !m->failed;
}

static int is_active(const instance *m, int event) {
    return events[event].trigger == ZERO && events[event].phases[MODEL(phase)(m->c)];
}

/* Functions of events, then arguments of discontinuities, and their rates; conditions of events. */
static int functions(instance *m, double *z, double *rate, double *conditions) {
    double pairs[ROOM(2 * EVENTS)], modes[ROOM(2 * MODES)];
    const int good = evaluate(m);
    MODEL(events)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, pairs);
    MODEL(event_rates)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, rate);
    MODEL(switches)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, modes);
    for (int k = 0; k < EVENTS; k++) {
        z[k] = pairs[2 * k];
        conditions[k] = pairs[2 * k + 1];
    }
    for (int k = 0; k < MODES; k++) {
        z[EVENTS + k] = modes[2 * k];
        rate[EVENTS + k] = modes[2 * k + 1];
    }
    return good;
}

/* How long a moment is: of the time in which the state changes by as much as it is, and more than the time's rounding. */
static double moment(const instance *m) {
    double shortest = SPAN;
    for (int i = 0; i < COORDINATES; i++) {
        if (i < MECHANICAL && m->v[i] != 0.0) shortest = fmin(shortest, fmax(fabs(m->q[i]), nominal[i]) / fabs(m->v[i]));
        if (m->a[i] != 0.0) shortest = fmin(shortest, fmax(fabs(m->v[i]), nominal[MECHANICAL + i]) / fabs(m->a[i]));
    }
    return MOMENT * shortest + DBL_EPSILON / (MOMENT * NEAR) * fabs(m->t);
}

/* The sides of their zeros on which all functions are: where one is zero, the side on which it is a moment later; 0 where it stays. */
static int sides(instance *m, double *side, char *at_zero, double *conditions) {
    double z[ROOM(INDICATORS)], rate[ROOM(INDICATORS)], after[ROOM(INDICATORS)], rate_after[ROOM(INDICATORS)], unused[ROOM(EVENTS)];
    int good = functions(m, z, rate, conditions);
    const double h = good ? moment(m) : 0.0;
    instance later = *m;
    for (int i = 0; i < COORDINATES; i++) {
        later.q[i] += i < MECHANICAL ? h * (m->v[i] + 0.5 * h * m->a[i]) : 0.0;
        later.v[i] += h * m->a[i];
    }
    later.t += h;
    later.known = 0;
    functions(&later, after, rate_after, unused);
    for (int k = 0; k < INDICATORS; k++) {
        const int rated = k >= EVENTS || events[k].rated;
        const double move = rated ? 0.5 * h * (rate[k] + rate_after[k]) : after[k] - z[k];
        const int near = fabs(z[k]) <= NEAR * fabs(move);
        const double sure = k < EVENTS && !near ? SURE * m->size[k] : 0.0, value = near ? move : z[k];
        side[k] = value > sure ? 1.0 : value < -sure ? -1.0 : 0.0;
        at_zero[k] = near || fabs(z[k]) <= sure;
        good = good && (k < EVENTS || value == value);
        if (k < EVENTS && !is_active(m, k)) side[k] = 0.0;
    }
    return good;
}

/* Sets the modes as the state asks for; one may move others.  0 where both sides of a discontinuity lead back to it. */
static int set_modes(instance *m) {
    double side[ROOM(INDICATORS)], conditions[ROOM(EVENTS)], *modes = MODEL(modes)(m->c);
    char at_zero[ROOM(INDICATORS)];
    int changed = MODES > 0, good = 1;
    for (int trial = 0; changed && trial < TRIALS + MODES; trial++) {
        changed = 0;
        m->known = 0;
        good = sides(m, side, at_zero, conditions);
        for (int k = 0; k < MODES; k++) {
            /* At zero where it is, before it is asked where that leads. */
            const double wanted = trial < 2 && at_zero[EVENTS + k] ? 0.0 : side[EVENTS + k];
            const double mode = is_step[k] ? dalembert_step(wanted) : wanted;
            if (modes[k] == mode || (changed && trial > TRIALS / 2)) continue;
            modes[k] = mode;
            changed = 1;
        }
        changed = changed || trial < 2;
    }
    m->known = 0;
    return good && !changed;
}

int indicators(instance *m, double *z) {
    double rate[ROOM(INDICATORS)], conditions[ROOM(EVENTS)];
    const double *modes = MODEL(modes)(m->c);
    if (!evaluate(m)) return 0;
    functions(m, z, rate, conditions);
    for (int k = 0; k < INDICATORS; k++) {
        const int mode = k - EVENTS;
        double side = 0.0, sure = 0.0;
        if (mode >= 0) side = is_step[mode] && modes[mode] == 0.0 ? -1.0 : modes[mode];
        else {
            if (!is_active(m, k)) z[k] = 1.0;
            m->size[k] = fmax(m->size[k], fabs(z[k]));
            side = is_active(m, k) ? m->side[k] : 1.0;
            sure = SURE * m->size[k];
        }
        /* What is zero belongs to its side; what has none shows that it leaves zero. */
        z[k] = side != 0.0 ? z[k] + side * DBL_MIN : sure + DBL_MIN - fabs(z[k]);
    }
    return 1;
}

int outputs(instance *m, double *y) {
    if (!evaluate(m)) return 0;
    MODEL(outputs)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, y);
    return 1;
}

/* The multiplier-free change d of least kinetic energy with J d = -miss in these rows: M d = J^T mu. */
static int change(instance *m, int count, const int *which, const double *miss, double *d) {
#if ROWS > 0
    double mass[COORDINATES * COORDINATES], matrix[ROWS * COORDINATES], rows[ROWS * COORDINATES], nothing[COORDINATES];
    double mu[ROWS], doubles[DALEMBERT_DOUBLES(COORDINATES, ROWS)];
    int ints[DALEMBERT_INTS(COORDINATES, ROWS)];
    MODEL(mass_matrix)(m->c, m->t, m->u, m->q, m->v, mass);
    MODEL(constraint_matrix)(m->c, m->t, m->u, m->q, matrix);
    for (int i = 0; i < COORDINATES; i++) nothing[i] = 0.0;
    for (int k = 0; k < count; k++) memcpy(rows + k * COORDINATES, matrix + which[k] * COORDINATES, COORDINATES * sizeof(double));
    return dalembert_constrained(COORDINATES, count, 0, mass, nothing, rows, miss, NULL, NULL, d, mu, doubles, ints) == 0;
#else
    (void)m; (void)count; (void)which; (void)miss; (void)d;
    return 1;
#endif
}

int negative_inertia(instance *m) {
    double mass[ROOM(COORDINATES * COORDINATES)];
    signals(m, m->u);
    MODEL(mass_matrix)(m->c, m->t, m->u, m->q, m->v, mass);
    for (int i = 0; i < MECHANICAL; i++) {
        const double size = fabs(mass[i * COORDINATES + i]);
        double pivot = mass[i * COORDINATES + i];
        for (int j = 0; j < i; j++) {
            const double other = mass[j * COORDINATES + j];
            for (int k = 0; k < j; k++) mass[i * COORDINATES + j] -= mass[i * COORDINATES + k] * mass[j * COORDINATES + k] * mass[k * COORDINATES + k];
            mass[i * COORDINATES + j] = other > 0.0 ? mass[i * COORDINATES + j] / other : 0.0;
            pivot -= mass[i * COORDINATES + j] * mass[i * COORDINATES + j] * other;
        }
        mass[i * COORDINATES + i] = pivot;
        if (pivot < -ROUNDING * size) return i;
        if (pivot <= ROUNDING * size) mass[i * COORDINATES + i] = 0.0;
    }
    return -1;
}

/* The rows of the phase; with `holonomic` those without speeds. */
static int active_rows(const instance *m, int holonomic, int *which) {
    int all[ROOM(ROWS)], rank, count = 0;
    const int m_all = MODEL(rows)(MODEL(phase)(m->c), all, &rank);
    for (int k = 0; k < m_all; k++)
        if (!holonomic || is_holonomic[all[k]]) which[count++] = all[k];
    return count;
}

int is_constrained(const instance *m) {
    int which[ROOM(ROWS)];
    return active_rows(m, 0, which) > 0;
}

static void triples(const instance *m, double *c) {
#if ROWS > 0
    MODEL(constraints)(m->c, m->t, m->u, m->q, m->v, c);
#else
    (void)m; (void)c;
#endif
}

double drift(instance *m) {
    double c[ROOM(3 * ROWS)], most = 0.0;
    int which[ROOM(ROWS)];
    evaluate(m);
    triples(m, c);
    const int count = active_rows(m, 1, which);
    for (int k = 0; k < count; k++) most = fmax(most, fabs(c[3 * which[k]]) / fmax(c[3 * which[k] + 2], DBL_MIN));
    return most;
}

/* Changes speeds at once such that rows have these rates. */
static int jump(instance *m, int count, const int *which, const double *miss) {
    double d[ROOM(COORDINATES)];
    if (count == 0) return 1;
    if (!change(m, count, which, miss, d)) return 0;
    for (int i = 0; i < COORDINATES; i++) m->v[i] += d[i];
    m->known = 0;
    return 1;
}

int project(instance *m) {
    double c[ROOM(3 * ROWS)], miss[ROOM(ROWS)], d[ROOM(COORDINATES)];
    int which[ROOM(ROWS)];
    int count = active_rows(m, 1, which);
    for (int step = 0; count > 0 && step < STEPS && drift(m) > 4.0 * DBL_EPSILON; step++) {
        triples(m, c);
        for (int k = 0; k < count; k++) miss[k] = c[3 * which[k]];
        if (!change(m, count, which, miss, d)) return 0;
        for (int i = 0; i < COORDINATES; i++) m->q[i] += d[i];
        m->known = 0;
    }
    evaluate(m);
    triples(m, c);
    count = active_rows(m, 0, which);
    for (int k = 0; k < count; k++) miss[k] = c[3 * which[k] + 1];
    return jump(m, count, which, miss);
}

#if INPUTS > 0
/* Changes speeds at once by forces for no time, and such that the rows of the phase go on: M d + push = J^T mu. */
static int push(instance *m, const double *pushed) {
    double mass[COORDINATES * COORDINATES], d[COORDINATES];
    MODEL(mass_matrix)(m->c, m->t, m->u, m->q, m->v, mass);
#if ROWS > 0
    double c[3 * ROWS], matrix[ROWS * COORDINATES], rows[ROWS * COORDINATES], miss[ROWS], mu[ROWS];
    double doubles[DALEMBERT_DOUBLES(COORDINATES, ROWS)];
    int which[ROWS], ints[DALEMBERT_INTS(COORDINATES, ROWS)];
    const int count = active_rows(m, 0, which);
    triples(m, c);
    MODEL(constraint_matrix)(m->c, m->t, m->u, m->q, matrix);
    for (int k = 0; k < count; k++) {
        miss[k] = c[3 * which[k] + 1];
        memcpy(rows + k * COORDINATES, matrix + which[k] * COORDINATES, COORDINATES * sizeof(double));
    }
    if (count > 0 ? dalembert_constrained(COORDINATES, count, 0, mass, pushed, rows, miss, NULL, NULL, d, mu, doubles, ints) : dalembert_solve(COORDINATES, mass, pushed, d)) return 0;
#else
    if (dalembert_solve(COORDINATES, mass, pushed, d)) return 0;
#endif
    for (int i = 0; i < COORDINATES; i++) m->v[i] += d[i];
    m->known = 0;
    return 1;
}

/* By how much u and u' of an input jump; 0 where u moves a body or a constraint and does so by no rates of it. */
static int jumps(const instance *m, int k, const double *now, double *jump) {
    const double *old = m->before + 3 * k, h = m->waited[k];
    const double size = fmax(fabs(old[0]), fabs(now[0])), rate = fmax(fabs(old[1]), fabs(now[1]));
    const double lag = 64.0 * DBL_EPSILON * fabs(m->t), sure = ROUNDING * size + lag * rate;
    jump[0] = now[0] - old[0];
    jump[1] = now[1] - old[1];
    if (fabs(jump[1]) <= ROUNDING * rate + lag * fmax(fabs(old[2]), fabs(now[2]))) jump[1] = 0.0;
    if (fabs(jump[0]) <= sure) jump[0] = 0.0;
    if (jump[0] == 0.0 || !moves_bodies[k]) return 1;
    /* Between two times of setting it moves by the mean of its rates, but for what these are uncertain by. */
    const double first = old[1] - h * old[2], moved = now[0] - (old[0] - h * (first + 0.5 * h * old[2]));
    const double fastest = fmax(fmax(fabs(first), fabs(now[1])), h * fmax(fabs(old[2]), fabs(now[2])));
    return fabs(moved - 0.5 * h * (first + now[1])) <= h * fastest + sure;
}

int take_inputs(instance *m, int *changed) {
    double slopes[COORDINATES * SIGNALS], pushed[COORDINATES], nothing[COORDINATES + ROOM(ROWS)], jump[2];
    int any = 0, pushes = 0;
    *changed = 0;
    for (int k = 0; k < INPUTS; k++) any = any || m->is_new[k];
    if (!any) return 1;
    signals(m, m->u);
    for (int i = 0; i < COORDINATES + ROOM(ROWS); i++) nothing[i] = 0.0;
    for (int i = 0; i < COORDINATES; i++) pushed[i] = 0.0;
    MODEL(input_jacobian)(m->c, m->t, m->u, m->q, m->v, nothing, nothing + COORDINATES, slopes);
    for (int k = 0; k < INPUTS; k++) {
        if (!m->is_new[k]) continue;
        m->is_new[k] = 0;
        if (!jumps(m, k, m->u + 3 * k, jump)) {
            snprintf(m->why, sizeof m->why, "`%.40s` jumps, which would take an infinite force: set its rate `%.40s'` with it, by which it goes on, or set it before the initialization ends", input_names[k], input_names[k]);
            return 0;
        }
        pushes = pushes || jump[0] != 0.0 || jump[1] != 0.0;
        for (int i = 0; i < COORDINATES; i++)
            pushed[i] += slopes[i * SIGNALS + 3 * k + 1] * jump[0] + slopes[i * SIGNALS + 3 * k + 2] * jump[1];
    }
    if (!pushes) return 1;
    for (int i = 0; i < COORDINATES; i++) *changed = *changed || pushed[i] != 0.0;
    *changed = *changed || is_constrained(m);
    return !*changed || (push(m, pushed) && project(m));
}
#else
int take_inputs(instance *m, int *changed) {
    (void)m;
    *changed = 0;
    return 1;
}
#endif

/* Sides of events begin anew. */
static int look_anew(instance *m) {
    double side[ROOM(INDICATORS)], z[ROOM(INDICATORS)], conditions[ROOM(EVENTS)];
    char at_zero[ROOM(INDICATORS)];
    if (!indicators(m, z) || !sides(m, side, at_zero, conditions)) return 0;
    memcpy(m->side, side, EVENTS * sizeof(double));
    return 1;
}

int settle(instance *m) {
    double clocks[ROOM(2 * CLOCKS)];
    MODEL(clocks)(m->c, clocks);
    for (int k = 0; k < CLOCKS; k++) {
        m->first[k] = clocks[2 * k];
        m->period[k] = clocks[2 * k + 1];
        if (!(m->period[k] > 0.0)) {
            snprintf(m->why, sizeof m->why, "the period of ticks is %g s, not positive", m->period[k]);
            return 0;
        }
        m->ticks[k] = fmax(0.0, ceil((m->t - m->first[k]) / m->period[k] - 1e-9));
    }
    m->starting = 1;
    set_modes(m);
    project(m);
    return set_modes(m) && look_anew(m);
}

double next_tick(const instance *m) {
    double next = HUGE_VAL;
    for (int k = 0; k < CLOCKS; k++) next = fmin(next, m->first[k] + m->ticks[k] * m->period[k]);
    return next;
}

/* The phase with these rows and no others, or -1. */
static int phase_with(const char *wanted) {
    for (int phase = 0; phase < (PHASES ? PHASES : 1); phase++) {
        int which[ROOM(ROWS)], rank, fits = 1;
        char has[ROOM(ROWS)] = {0};
        const int count = MODEL(rows)(phase, which, &rank);
        for (int k = 0; k < count; k++) has[which[k]] = 1;
        for (int k = 0; k < ROWS; k++) fits = fits && has[k] == wanted[k];
        if (fits) return phase;
    }
    return -1;
}

/* How long a hop lasts that begins with the rates of these rows; 0 where nothing brings it back. */
static double hop(instance *m, const action *done) {
    double longest = 0.0;
#if ROWS > 0
    double c[3 * ROWS], back[ROWS], matrix[ROWS * COORDINATES];
    if (!evaluate(m)) return 0.0;
    triples(m, c);
    MODEL(constraint_bias)(m->c, m->t, m->u, m->q, m->v, back);
    MODEL(constraint_matrix)(m->c, m->t, m->u, m->q, matrix);
    for (int k = done->first; k < done->first + done->count; k++) {
        for (int i = 0; i < COORDINATES; i++) back[k] += matrix[k * COORDINATES + i] * m->a[i];
        if (c[3 * k + 1] * back[k] < 0.0) longest = fmax(longest, -2.0 * c[3 * k + 1] / back[k]);
    }
#else
    (void)m; (void)done;
#endif
    return longest;
}

/* An impulse along rows that are not in force; the last of many puts them in force. */
static int strike(instance *m, const action *done) {
    double c[ROOM(3 * ROWS)], miss[ROOM(ROWS)], restitutions[ROOM(RESTITUTIONS)], fastest = 0.0;
    int which[ROOM(ROWS)];
    char rows[ROOM(ROWS)] = {0};
    int count = active_rows(m, 0, which);
    MODEL(restitutions)(m->c, restitutions);
    triples(m, c);
    const double e = restitutions[done->restitution];
    for (int k = 0; k < count; k++) {
        rows[which[k]] = 1;
        miss[k] = 0.0;
    }
    for (int k = 0; k < done->count; k++) {
        const double rate = c[3 * (done->first + k) + 1];
        fastest = fmax(fastest, fabs(rate));
        rows[done->first + k] = 1;
        which[count] = done->first + k;
        miss[count++] = (1.0 + e) * rate;
    }
    if (!jump(m, count, which, miss)) return 0;
    m->approach = fmax(m->approach, fastest);
    if (e * fastest > LAST * m->approach) {
        /* So that no step is longer than a hop. */
        m->step = 0.25 * hop(m, done);
        return 1;
    }
    const int phase = phase_with(rows);
    if (phase < 0) return e > 0.0;
    MODEL(set_phase)(m->c, phase);
    return project(m);
}

/* Sets held values and states. */
static void assign(instance *m, const action *done, char *set) {
    double values[ROOM(ASSIGNMENTS)];
    evaluate(m);
    MODEL(assignments)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, values);
    for (int k = done->first; k < done->first + done->count; k++) {
        if (targets[k] >= 0) {
            MODEL(memory)(m->c)[targets[k]] = values[k];
            set[targets[k]] = 1;
        } else {
            m->v[-1 - targets[k]] = values[k];
        }
    }
    m->known = 0;
}

/* Whether what is past a zero where a motion starts happens at once: what ends the phase that it names, and impacts at their zero. */
static int starts(const instance *m, int event, int at_zero) {
    int elsewhere = 0;
    for (int k = events[event].first; k < events[event].first + events[event].count; k++) {
        if (actions[k].kind == IMPACT) return at_zero;
        elsewhere = elsewhere || (actions[k].kind == ENTER && actions[k].first != MODEL(phase)(m->c));
    }
    return elsewhere && events[event].named;
}

/* Whether an event at a zero happens now that its function is on a side; anew where it is looked at for the first time. */
static int crosses(const instance *m, int event, double side, int anew) {
    const double forward = events[event].direction * side, before = m->side[event];
    if (side == 0.0) return 0;
    if (anew || before == 0.0) return events[event].acts && forward > 0.0;
    return side != before && forward >= 0.0;
}

/* Whether an event happens now that is no zero. */
static int is_due(const instance *m, int event, const char *set) {
    const int clock = events[event].clock;
    if (!events[event].phases[MODEL(phase)(m->c)]) return 0;
    if (events[event].trigger == TICK) return m->first[clock] + m->ticks[clock] * m->period[clock] <= m->t + 1e-12 * fabs(m->t);
    for (int k = 0; k < MEMORY; k++)
        if (set[k] && events[event].watched[k]) return 1;
    return 0;
}

/* Begins a phase, on its constraints. */
static int enter(instance *m, int phase) {
    double before[ROOM(COORDINATES)];
    memcpy(before, m->q, sizeof before);
    MODEL(set_phase)(m->c, phase);
    if (!project(m)) return 0;
    for (int i = 0; i < MECHANICAL; i++)
        if (fabs(m->q[i] - before[i]) > MISSED * fmax(fabs(before[i]), nominal[i])) return 0;
    return 1;
}

static int act(instance *m, int event, char *set, int *changed) {
    for (int k = 0; k < events[event].count && !m->stopped; k++) {
        const action *done = &actions[events[event].first + k];
        if (done->kind == STOP) m->stopped = 1;
        if (done->kind == PUT) assign(m, done, set);
        if (done->kind == IMPACT && !strike(m, done)) return 0;
        if (done->kind == ENTER && !enter(m, done->first)) return 0;
        *changed = *changed || done->kind != RECORD;
    }
    m->known = 0;
    return 1;
}

int happen(instance *m, int *changed) {
    char set[ROOM(MEMORY)] = {0};
    int phase = MODEL(phase)(m->c), anew = m->starting;
    const int starting = m->starting;
    *changed = m->starting = 0;
    for (int turn = 0; turn < CASCADE; turn++) {
        double side[ROOM(INDICATORS)], conditions[ROOM(EVENTS)];
        char now[ROOM(EVENTS)], at_zero[ROOM(INDICATORS)], done = 0;
        if (!set_modes(m) || !sides(m, side, at_zero, conditions)) return 0;
        for (int k = 0; k < EVENTS; k++) {
            const int zero = events[k].trigger == ZERO;
            now[k] = zero ? (turn == 0 || anew) && crosses(m, k, side[k], anew) : (turn == 0 || events[k].trigger == SET) && is_due(m, k, set);
            now[k] = now[k] && conditions[k] > 0.0 && (turn > 0 || !starting || !zero || starts(m, k, at_zero[k]));
            if (zero && (turn > 0 || side[k] != 0.0)) m->side[k] = side[k];
        }
        memset(set, 0, sizeof set);
        for (int k = 0; k < EVENTS && !m->stopped; k++) {
            if (!now[k]) continue;
            if (!act(m, k, set, changed)) return 0;
            done = 1;
        }
        if (turn == 0)
            for (int k = 0; k < CLOCKS; k++)
                if (m->first[k] + m->ticks[k] * m->period[k] <= m->t + 1e-12 * fabs(m->t)) m->ticks[k] += 1.0;
        if (!done) return 1;
        if (m->stopped) return look_anew(m);
        anew = MODEL(phase)(m->c) != phase;
        phase = MODEL(phase)(m->c);
    }
    return 0;
}
