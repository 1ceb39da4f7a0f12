#include "fmu_calls.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* An importer that adds its steps up comes to another time by this part of it, and of a step. */
#define APART 1e-9

#define NO_ACCELERATIONS                                                                                               \
    "no accelerations: the inertia of a coordinate vanishes, friction leaves no reaction, a number is not finite, or " \
    "both sides of a discontinuity push back to it, as of sign(v) where friction sticks, or a phase is entered where a " \
    "constraint of it does not hold"

/* Where each kind of variable begins among the value references. */
enum {
    TIME = 0,
    FIRST_STATE = 1,
    FIRST_DERIVATIVE = FIRST_STATE + STATES,
    FIRST_PARAMETER = FIRST_DERIVATIVE + STATES,
    FIRST_INPUT = FIRST_PARAMETER + PARAMETERS,
    FIRST_MEMORY = FIRST_INPUT + SIGNALS,
    FIRST_OUTPUT = FIRST_MEMORY + MEMORY,
    FIRST_INDICATOR = FIRST_OUTPUT + OUTPUTS,
    PHASE = FIRST_INDICATOR + INDICATORS
};

/* A value reference as one of those, or beyond them. */
static int known(reference k) {
    return k <= PHASE ? (int)k : PHASE + 1;
}

static const char *told(const instance *m, int good) {
    return good ? NULL : m->why[0] ? m->why : NO_ACCELERATIONS;
}

/* Whether all inertias are positive; why not. */
static int has_inertia(instance *m) {
    const int negative = negative_inertia(m);
    if (negative >= 0) snprintf(m->why, sizeof m->why, "negative inertia: `%.40s` would move against the force; a mass or a moment of inertia is negative", coordinate_names[negative]);
    return negative < 0;
}

void begin_initialization(instance *m, double start, double tolerance) {
    m->t = start;
    for (int k = 0; k < INPUTS; k++) m->since[k] = start;
    m->known = 0;
    if (tolerance > 0.0) m->tolerance = tolerance;
    m->initializing = 1;
}

const char *end_initialization(instance *m, int at_once) {
    int changed;
    m->initializing = 0;
    m->running = 1;
    m->why[0] = 0;
    return told(m, has_inertia(m) && settle(m) && (!at_once || happen(m, &changed)));
}

static double *state(instance *m, int k) {
    return k < MECHANICAL ? &m->q[k] : &m->v[k - MECHANICAL];
}

static double derivative(const instance *m, int k) {
    return k < MECHANICAL ? m->v[k] : m->a[k - MECHANICAL];
}

const char *get_values(instance *m, const reference *which, size_t count, double *values) {
    double y[ROOM(OUTPUTS)], z[ROOM(INDICATORS)];
    int has_y = 0, has_z = 0;
    m->why[0] = 0;
    if (m->initializing && !m->known) settle(m);
    for (size_t i = 0; i < count; i++) {
        const int k = known(which[i]);
        if (k == TIME) values[i] = m->t;
        else if (k < FIRST_DERIVATIVE) values[i] = *state(m, k - FIRST_STATE);
        else if (k < FIRST_PARAMETER) {
            if (!evaluate(m)) return told(m, 0);
            values[i] = derivative(m, k - FIRST_DERIVATIVE);
        } else if (k < FIRST_INPUT) values[i] = *MODEL(parameter)(&m->p, k - FIRST_PARAMETER);
        else if (k < FIRST_MEMORY) {
            evaluate(m);
            values[i] = m->u[k - FIRST_INPUT];
        } else if (k < FIRST_OUTPUT) values[i] = MODEL(memory)(m->c)[k - FIRST_MEMORY];
        else if (k < FIRST_INDICATOR) {
            if (!has_y && !outputs(m, y)) return told(m, 0);
            has_y = 1;
            values[i] = y[k - FIRST_OUTPUT];
        } else if (k < PHASE) {
            if (!has_z && !indicators(m, z)) return told(m, 0);
            has_z = 1;
            values[i] = z[k - FIRST_INDICATOR];
        } else return "there is no such variable";
    }
    return NULL;
}

const char *set_values(instance *m, const reference *which, size_t count, const double *values) {
    for (size_t i = 0; i < count; i++) {
        const int k = known(which[i]);
        if (k >= FIRST_STATE && k < FIRST_DERIVATIVE) *state(m, k - FIRST_STATE) = values[i];
        else if (k >= FIRST_PARAMETER && k < FIRST_INPUT) {
            if (m->running && is_fixed[k - FIRST_PARAMETER]) return "the period of ticks depends on this parameter, which is fixed when the initialization ends";
            *MODEL(parameter)(&m->p, k - FIRST_PARAMETER) = values[i];
            take_parameters(m);
            m->tuned = 1;
        } else if (k >= FIRST_INPUT && k < FIRST_MEMORY) set_input(m, k - FIRST_INPUT, values[i]);
        else if (k >= FIRST_MEMORY && k < FIRST_OUTPUT) MODEL(memory)(m->c)[k - FIRST_MEMORY] = values[i];
        else return "this variable cannot be set";
    }
    m->known = 0;
    m->was_set = 1;
    return NULL;
}

const char *get_whole(instance *m, const reference *which, size_t count, int *values) {
    for (size_t i = 0; i < count; i++) {
        if (which[i] != PHASE || PHASES == 0) return "there is no such whole number";
        values[i] = MODEL(phase)(m->c);
    }
    return NULL;
}

const char *set_whole(instance *m, const reference *which, size_t count, const int *values) {
    for (size_t i = 0; i < count; i++) {
        if (which[i] != PHASE || values[i] < 0 || values[i] >= PHASES) return "there is no such phase";
        MODEL(set_phase)(m->c, values[i]);
    }
    m->known = 0;
    return NULL;
}

#if SLOPES
/* Where each kind of variable begins in a direction. */
enum {
    OF_SPEEDS = 1 + COORDINATES,
    OF_ACCELERATIONS = OF_SPEEDS + COORDINATES,
    OF_MULTIPLIERS = OF_ACCELERATIONS + COORDINATES,
    OF_INPUTS = OF_MULTIPLIERS + ROWS,
    OF_PARAMETERS = OF_INPUTS + SIGNALS,
    OF_MEMORY = OF_PARAMETERS + PARAMETERS
};

/* The place of a state in a direction. */
static int of_state(int k) {
    return k < MECHANICAL ? 1 + k : OF_SPEEDS + k - MECHANICAL;
}

/* Fills a direction; the file's functions of time change with it where they stand for inputs. */
static const char *direction(const instance *m, const reference *knowns, size_t columns, const double *seeds, double *along) {
    double du[ROOM(SIGNALS)];
    char is_given[ROOM(SIGNALS)];
    memcpy(is_given, m->is_given, sizeof is_given);
    for (int k = 0; k < DIRECTION; k++) along[k] = 0.0;
    for (size_t i = 0; i < columns; i++) {
        const int k = known(knowns[i]);
        int place = 0;
        if (k >= FIRST_STATE && k < FIRST_DERIVATIVE) place = of_state(k - FIRST_STATE);
        else if (k >= FIRST_PARAMETER && k < FIRST_INPUT) place = OF_PARAMETERS + k - FIRST_PARAMETER;
        else if (k >= FIRST_INPUT && k < FIRST_MEMORY) {
            place = OF_INPUTS + k - FIRST_INPUT;
            is_given[k - FIRST_INPUT] = 1;
        } else if (k >= FIRST_MEMORY && k < FIRST_OUTPUT) place = OF_MEMORY + k - FIRST_MEMORY;
        else if (k != TIME) return "there are no derivatives by this variable";
        along[place] += seeds[i];
    }
    MODEL(input_slopes)(m->c, m->t, along, du);
    for (int k = 0; k < INPUTS; k++) {
        double *of_input = along + OF_INPUTS + 3 * k;
        if (!is_given[3 * k] && !is_given[3 * k + 1] && !is_given[3 * k + 2]) memcpy(of_input, du + 3 * k, 3 * sizeof(double));
        else if (m->goes_on) {
            of_input[0] += along[TIME] * m->u[3 * k + 1];
            of_input[1] += along[TIME] * m->u[3 * k + 2];
        } else if (!is_given[3 * k]) of_input[0] = du[3 * k];
    }
    return NULL;
}

const char *get_slopes(instance *m, const reference *unknowns, size_t rows, const reference *knowns, size_t columns, const double *seeds, double *slopes) {
    double along[DIRECTION], da[ROOM(COORDINATES)], dl[ROOM(ROWS)], dy[ROOM(OUTPUTS)];
    if (m->initializing && !m->known) settle(m);
    if (m->initializing && is_constrained(m)) return "there are no derivatives before the start is on its constraints: end the initialization first";
    if (!evaluate(m)) return NO_ACCELERATIONS;
    const char *wrong = direction(m, knowns, columns, seeds, along);
    if (wrong) return wrong;
    if (MODEL(acceleration_slopes)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, along, da, dl) != 0) return NO_ACCELERATIONS;
    memcpy(along + OF_ACCELERATIONS, da, COORDINATES * sizeof(double));
    memcpy(along + OF_MULTIPLIERS, dl, ROWS * sizeof(double));
    MODEL(output_slopes)(m->c, m->t, m->u, m->q, m->v, m->a, m->l, along, dy);
    for (size_t i = 0; i < rows; i++) {
        const int k = known(unknowns[i]), of_rate = k - FIRST_DERIVATIVE;
        if (k >= FIRST_STATE && k < FIRST_DERIVATIVE) slopes[i] = along[of_state(k - FIRST_STATE)];
        else if (k >= FIRST_DERIVATIVE && k < FIRST_PARAMETER)
            slopes[i] = of_rate < MECHANICAL ? along[OF_SPEEDS + of_rate] : da[of_rate - MECHANICAL];
        else if (k >= FIRST_OUTPUT && k < FIRST_INDICATOR) slopes[i] = dy[k - FIRST_OUTPUT];
        else return "there are no derivatives of this variable";
    }
    return NULL;
}
#else
const char *get_slopes(instance *m, const reference *unknowns, size_t rows, const reference *knowns, size_t columns, const double *seeds, double *slopes) {
    (void)m; (void)unknowns; (void)rows; (void)knowns; (void)columns; (void)seeds; (void)slopes;
    return "the model is too large for derivatives";
}
#endif

void set_states(instance *m, const double *states, size_t count) {
    for (size_t k = 0; k < count; k++) *state(m, (int)k) = states[k];
    m->known = 0;
}

void get_states(instance *m, double *states, size_t count) {
    for (size_t k = 0; k < count; k++) states[k] = *state(m, (int)k);
}

const char *get_derivatives(instance *m, double *derivatives, size_t count) {
    if (!evaluate(m)) return NO_ACCELERATIONS;
    for (size_t k = 0; k < count; k++) derivatives[k] = derivative(m, (int)k);
    return NULL;
}

const char *get_indicators(instance *m, double *z) {
    m->why[0] = 0;
    return told(m, indicators(m, z));
}

int has_left(instance *m) {
    return ROWS && drift(m) > DRIFT;
}

/* What was set does at once what it does. */
static int take(instance *m, int *changed) {
    const int tuned = m->tuned;
    m->tuned = 0;
    *changed = 0;
    return (!tuned || has_inertia(m)) && take_inputs(m, changed);
}

const char *update(instance *m, int *changed) {
    int moved;
    m->why[0] = 0;
    if (!take(m, &moved)) return told(m, 0);
    const int left = has_left(m);
    if (left && !project(m)) return NO_ACCELERATIONS;
    if (!happen(m, changed)) return NO_ACCELERATIONS;
    *changed = *changed || left || moved;
    return NULL;
}

const char *do_step(instance *m, double now, double length) {
    int changed, good = 1;
    m->why[0] = 0;
    if (!(length > 0.0)) return "the length of a step is not positive";
    if (m->stopped) return NULL;
    if (!(fabs(now - m->t) <= APART * fmax(fabs(m->t), length))) {
        snprintf(m->why, sizeof m->why, "the step begins at t = %.10g s, but it is t = %.10g s here", now, m->t);
        return m->why;
    }
    m->t = now;
    if (m->was_set) good = take(m, &changed) && happen(m, &changed);
    m->was_set = 0;
    return told(m, good && (m->stopped || integrate(m, now + length)));
}
