/* The functions of FMI 3.0 (fmi-standard.org) for one mechanism. */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "fmu_instance.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef uint32_t reference;
typedef void (*logger)(void *environment, fmi3Status status, const char *category, const char *message);

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

typedef struct {
    instance m;
    bool co_simulation, initializing;
    bool set; /* whether something was set since the last step */
    void *environment;
    logger log;
} fmu;

static fmi3Status failure(const fmu *f, const char *message) {
    if (f->log) f->log(f->environment, fmi3Error, "logStatusError", message);
    return fmi3Error;
}

static fmi3Status done(const fmu *f, int good) {
    return good ? fmi3OK : failure(f, "no accelerations: the inertia of a coordinate vanishes, friction leaves no reaction, a number is not "
                                     "finite, or both sides of a discontinuity push back to it, as of sign(v) where friction sticks");
}

EXPORT const char *fmi3GetVersion(void) {
    return "3.0";
}

EXPORT fmi3Status fmi3SetDebugLogging(void *f, bool on, size_t count, const char *const categories[]) {
    (void)f; (void)on; (void)count; (void)categories;
    return fmi3OK;
}

static void *instantiate(const char *token, bool co_simulation, void *environment, logger log) {
    if (!token || strcmp(token, TOKEN) != 0) {
        if (log) log(environment, fmi3Error, "logStatusError", "the instantiation token is not that of this FMU");
        return NULL;
    }
    fmu *f = calloc(1, sizeof *f);
    if (!f) return NULL;
    begin(&f->m);
    f->co_simulation = co_simulation;
    f->environment = environment;
    f->log = log;
    return f;
}

EXPORT void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *resources, bool visible,
                                          bool logging, void *environment, logger log) {
    (void)name; (void)resources; (void)visible; (void)logging;
    return instantiate(token, false, environment, log);
}

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                         bool logging, bool event_mode, bool early_return, const reference required[],
                                         size_t count, void *environment, logger log, void (*update)(void)) {
    (void)name; (void)resources; (void)visible; (void)logging; (void)event_mode; (void)early_return; (void)required; (void)count; (void)update;
    return instantiate(token, true, environment, log);
}

EXPORT void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *resources, bool visible,
                                               bool logging, void *environment, logger log, void (*clock)(void),
                                               void (*lock)(void), void (*unlock)(void)) {
    (void)name; (void)token; (void)resources; (void)visible; (void)logging; (void)environment; (void)log; (void)clock; (void)lock; (void)unlock;
    return NULL;
}

EXPORT void fmi3FreeInstance(void *f) {
    free(f);
}

EXPORT fmi3Status fmi3EnterInitializationMode(fmu *f, bool with_tolerance, double tolerance, double start, bool with_stop, double stop) {
    (void)with_stop; (void)stop;
    f->m.t = start;
    f->m.known = 0;
    if (with_tolerance && tolerance > 0.0) f->m.tolerance = tolerance;
    f->initializing = true;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmu *f) {
    int changed;
    settle(&f->m);
    f->initializing = false;
    return done(f, evaluate(&f->m) && (!f->co_simulation || happen(&f->m, &changed)));
}

EXPORT fmi3Status fmi3EnterEventMode(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmu *f) {
    begin(&f->m);
    return fmi3OK;
}

/* The states: q of the file's coordinates, then v. */
static double *state(instance *m, int k) {
    return k < MECHANICAL ? &m->q[k] : &m->v[k - MECHANICAL];
}

static double derivative(const instance *m, int k) {
    return k < MECHANICAL ? m->v[k] : m->a[k - MECHANICAL];
}

EXPORT fmi3Status fmi3GetFloat64(fmu *f, const reference which[], size_t count, double values[], size_t room) {
    instance *m = &f->m;
    double y[ROOM(OUTPUTS)], z[ROOM(INDICATORS)];
    int has_y = 0, has_z = 0;
    (void)room;
    if (f->initializing && !m->known) settle(m);
    for (size_t i = 0; i < count; i++) {
        const int k = (int)which[i];
        if (k == TIME) values[i] = m->t;
        else if (k < FIRST_DERIVATIVE) values[i] = *state(m, k - FIRST_STATE);
        else if (k < FIRST_PARAMETER) {
            if (!evaluate(m)) return done(f, 0);
            values[i] = derivative(m, k - FIRST_DERIVATIVE);
        } else if (k < FIRST_INPUT) values[i] = *MODEL(parameter)(&m->p, k - FIRST_PARAMETER);
        else if (k < FIRST_MEMORY) {
            evaluate(m);
            values[i] = m->u[k - FIRST_INPUT];
        } else if (k < FIRST_OUTPUT) values[i] = MODEL(memory)(m->c)[k - FIRST_MEMORY];
        else if (k < FIRST_INDICATOR) {
            if (!has_y && !outputs(m, y)) return done(f, 0);
            has_y = 1;
            values[i] = y[k - FIRST_OUTPUT];
        } else if (k < PHASE) {
            if (!has_z && !indicators(m, z)) return done(f, 0);
            has_z = 1;
            values[i] = z[k - FIRST_INDICATOR];
        } else return failure(f, "no such variable of type Float64");
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFloat64(fmu *f, const reference which[], size_t count, const double values[], size_t room) {
    instance *m = &f->m;
    (void)room;
    for (size_t i = 0; i < count; i++) {
        const int k = (int)which[i];
        if (k >= FIRST_STATE && k < FIRST_DERIVATIVE) *state(m, k - FIRST_STATE) = values[i];
        else if (k >= FIRST_PARAMETER && k < FIRST_INPUT) {
            *MODEL(parameter)(&m->p, k - FIRST_PARAMETER) = values[i];
            take_parameters(m);
        } else if (k >= FIRST_INPUT && k < FIRST_MEMORY) {
            m->given[k - FIRST_INPUT] = values[i];
            m->is_given[k - FIRST_INPUT] = 1;
        } else if (k >= FIRST_MEMORY && k < FIRST_OUTPUT) MODEL(memory)(m->c)[k - FIRST_MEMORY] = values[i];
        else return failure(f, "this variable cannot be set");
    }
    m->known = 0;
    f->set = true;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetInt32(fmu *f, const reference which[], size_t count, int32_t values[], size_t room) {
    (void)room;
    for (size_t i = 0; i < count; i++) {
        if (which[i] != PHASE) return failure(f, "no such variable of type Int32");
        values[i] = MODEL(phase)(f->m.c);
    }
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetInt32(fmu *f, const reference which[], size_t count, const int32_t values[], size_t room) {
    (void)room;
    for (size_t i = 0; i < count; i++) {
        if (which[i] != PHASE || values[i] < 0 || values[i] >= (PHASES ? PHASES : 1)) return failure(f, "no such phase");
        MODEL(set_phase)(f->m.c, values[i]);
    }
    f->m.known = 0;
    return fmi3OK;
}

/* Types of which this FMU has no variables. */
#define NONE(NAME, TYPE)                                                                                              \
    EXPORT fmi3Status fmi3Get##NAME(fmu *f, const reference which[], size_t count, TYPE values[], size_t room) {     \
        (void)which; (void)values; (void)room;                                                                       \
        return count ? failure(f, "no variable of this type") : fmi3OK;                                              \
    }                                                                                                                \
    EXPORT fmi3Status fmi3Set##NAME(fmu *f, const reference which[], size_t count, const TYPE values[], size_t room) { \
        (void)which; (void)values; (void)room;                                                                       \
        return count ? failure(f, "no variable of this type") : fmi3OK;                                              \
    }

NONE(Float32, float)
NONE(Int8, int8_t)
NONE(UInt8, uint8_t)
NONE(Int16, int16_t)
NONE(UInt16, uint16_t)
NONE(UInt32, uint32_t)
NONE(Int64, int64_t)
NONE(UInt64, uint64_t)
NONE(Boolean, bool)

typedef const char *text;
NONE(String, text)

/* What this FMU does not do. */
#define NOT(NAME, ...)                                                  \
    EXPORT fmi3Status fmi3##NAME(fmu *f, __VA_ARGS__) {                 \
        return failure(f, "fmi3" #NAME " is not provided by this FMU"); \
    }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
NOT(GetBinary, const reference which[], size_t count, size_t sizes[], const uint8_t *values[], size_t room)
NOT(SetBinary, const reference which[], size_t count, const size_t sizes[], const uint8_t *const values[], size_t room)
NOT(GetClock, const reference which[], size_t count, bool values[])
NOT(SetClock, const reference which[], size_t count, const bool values[])
NOT(GetNumberOfVariableDependencies, reference which, size_t *count)
NOT(GetVariableDependencies, reference which, size_t of[], reference on[], size_t parts[], int kinds[], size_t count)
NOT(SerializedFMUStateSize, void *kept, size_t *size)
NOT(SerializeFMUState, void *kept, uint8_t bytes[], size_t size)
NOT(DeserializeFMUState, const uint8_t bytes[], size_t size, void **kept)
NOT(GetDirectionalDerivative, const reference unknowns[], size_t rows, const reference knowns[], size_t columns, const double seed[], size_t seeds, double out[], size_t outs)
NOT(GetAdjointDerivative, const reference unknowns[], size_t rows, const reference knowns[], size_t columns, const double seed[], size_t seeds, double out[], size_t outs)
NOT(GetIntervalDecimal, const reference which[], size_t count, double intervals[], int qualifiers[])
NOT(GetIntervalFraction, const reference which[], size_t count, uint64_t counters[], uint64_t resolutions[], int qualifiers[])
NOT(GetShiftDecimal, const reference which[], size_t count, double shifts[])
NOT(GetShiftFraction, const reference which[], size_t count, uint64_t counters[], uint64_t resolutions[])
NOT(SetIntervalDecimal, const reference which[], size_t count, const double intervals[])
NOT(SetIntervalFraction, const reference which[], size_t count, const uint64_t counters[], const uint64_t resolutions[])
NOT(SetShiftDecimal, const reference which[], size_t count, const double shifts[])
NOT(SetShiftFraction, const reference which[], size_t count, const uint64_t counters[], const uint64_t resolutions[])
NOT(GetOutputDerivatives, const reference which[], size_t count, const int32_t orders[], double values[], size_t room)
NOT(ActivateModelPartition, reference clock, double time)

EXPORT fmi3Status fmi3EnterConfigurationMode(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitConfigurationMode(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3EvaluateDiscreteStates(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFMUState(fmu *f, void **kept) {
    if (!*kept) *kept = malloc(sizeof *f);
    if (!*kept) return failure(f, "no memory is left");
    memcpy(*kept, f, sizeof *f);
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetFMUState(fmu *f, void *kept) {
    memcpy(f, kept, sizeof *f);
    return fmi3OK;
}

EXPORT fmi3Status fmi3FreeFMUState(fmu *f, void **kept) {
    (void)f;
    free(*kept);
    *kept = NULL;
    return fmi3OK;
}

EXPORT fmi3Status fmi3UpdateDiscreteStates(fmu *f, bool *again, bool *terminate, bool *nominals, bool *values, bool *tick, double *next) {
    int changed = 0;
    instance *m = &f->m;
    const int left = ROWS && drift(m) > DRIFT;
    if (left && !project(m)) return done(f, 0);
    if (!happen(m, &changed)) return done(f, 0);
    *again = *nominals = false;
    *terminate = m->stopped;
    *values = changed || left;
    *next = next_tick(m);
    *tick = *next < HUGE_VAL;
    return fmi3OK;
}

EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(fmu *f, bool no_return, bool *event, bool *terminate) {
    (void)no_return;
    *event = ROWS && drift(&f->m) > DRIFT;
    *terminate = false;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetTime(fmu *f, double time) {
    f->m.t = time;
    f->m.known = 0;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetContinuousStates(fmu *f, const double states[], size_t count) {
    for (size_t k = 0; k < count; k++) *state(&f->m, (int)k) = states[k];
    f->m.known = 0;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetContinuousStates(fmu *f, double states[], size_t count) {
    for (size_t k = 0; k < count; k++) states[k] = *state(&f->m, (int)k);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmu *f, double derivatives[], size_t count) {
    if (!evaluate(&f->m)) return done(f, 0);
    for (size_t k = 0; k < count; k++) derivatives[k] = derivative(&f->m, (int)k);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetEventIndicators(fmu *f, double z[], size_t count) {
    (void)count;
    return done(f, indicators(&f->m, z));
}

EXPORT fmi3Status fmi3GetNominalsOfContinuousStates(fmu *f, double nominals[], size_t count) {
    (void)f;
    for (size_t k = 0; k < count; k++) nominals[k] = nominal[k];
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfEventIndicators(fmu *f, size_t *count) {
    (void)f;
    *count = INDICATORS;
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetNumberOfContinuousStates(fmu *f, size_t *count) {
    (void)f;
    *count = STATES;
    return fmi3OK;
}

EXPORT fmi3Status fmi3EnterStepMode(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3DoStep(fmu *f, double now, double length, bool no_return, bool *event, bool *terminate, bool *early, double *last) {
    int changed, good = 1;
    (void)no_return;
    f->m.t = now;
    if (f->set && !f->m.stopped) good = happen(&f->m, &changed);
    f->set = false;
    good = good && (f->m.stopped || integrate(&f->m, now + length));
    *event = false;
    *terminate = f->m.stopped;
    *early = false;
    *last = f->m.t;
    return done(f, good);
}
