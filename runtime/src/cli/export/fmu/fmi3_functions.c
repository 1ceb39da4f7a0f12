/* The functions of FMI 3.0 (fmi-standard.org) for one mechanism. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "fmu_calls.h"

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef void (*logger)(void *environment, fmi3Status status, const char *category, const char *message);

typedef struct {
    instance m;
    bool co_simulation;
    void *environment;
    logger log;
} fmu;

static fmi3Status told(const fmu *f, fmi3Status status, const char *message) {
    if (f->log) f->log(f->environment, status, "logStatusError", message);
    return status;
}

/* Of why there is no answer, NULL where there is one. */
static fmi3Status done(const fmu *f, const char *failure) {
    return failure ? told(f, fmi3Error, failure) : fmi3OK;
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
    begin(&f->m, co_simulation);
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
    begin_initialization(&f->m, start, with_tolerance ? tolerance : 0.0);
    return fmi3OK;
}

EXPORT fmi3Status fmi3ExitInitializationMode(fmu *f) {
    return done(f, end_initialization(&f->m, f->co_simulation));
}

EXPORT fmi3Status fmi3EnterEventMode(fmu *f) {
    f->m.at_event = 1;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Terminate(fmu *f) {
    (void)f;
    return fmi3OK;
}

EXPORT fmi3Status fmi3Reset(fmu *f) {
    begin(&f->m, f->co_simulation);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetFloat64(fmu *f, const reference which[], size_t count, double values[], size_t room) {
    (void)room;
    return done(f, get_values(&f->m, which, count, values));
}

EXPORT fmi3Status fmi3SetFloat64(fmu *f, const reference which[], size_t count, const double values[], size_t room) {
    (void)room;
    return done(f, set_values(&f->m, which, count, values));
}

EXPORT fmi3Status fmi3GetInt32(fmu *f, const reference which[], size_t count, int32_t values[], size_t room) {
    (void)room;
    return done(f, get_whole(&f->m, which, count, values));
}

EXPORT fmi3Status fmi3SetInt32(fmu *f, const reference which[], size_t count, const int32_t values[], size_t room) {
    (void)room;
    return done(f, set_whole(&f->m, which, count, values));
}

/* Without derivatives a simulation can go on. */
EXPORT fmi3Status fmi3GetDirectionalDerivative(fmu *f, const reference unknowns[], size_t rows, const reference knowns[], size_t columns,
                                               const double seed[], size_t seeds, double out[], size_t outs) {
    (void)seeds; (void)outs;
    const char *failure = get_slopes(&f->m, unknowns, rows, knowns, columns, seed, out);
    return failure ? told(f, fmi3Discard, failure) : fmi3OK;
}

/* Types of which this FMU has no variables. */
#define NONE(NAME, TYPE)                                                                                              \
    EXPORT fmi3Status fmi3Get##NAME(fmu *f, const reference which[], size_t count, TYPE values[], size_t room) {     \
        (void)which; (void)values; (void)room;                                                                       \
        return count ? done(f, "there are no variables of this type") : fmi3OK;                                              \
    }                                                                                                                \
    EXPORT fmi3Status fmi3Set##NAME(fmu *f, const reference which[], size_t count, const TYPE values[], size_t room) { \
        (void)which; (void)values; (void)room;                                                                       \
        return count ? done(f, "there are no variables of this type") : fmi3OK;                                              \
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
        return done(f, "fmi3" #NAME " is not provided by this FMU"); \
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
    if (!*kept) return done(f, "no memory is left");
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
    const char *failure = update(&f->m, &changed);
    *again = *nominals = false;
    *terminate = f->m.stopped;
    *values = changed;
    *next = next_tick(&f->m);
    *tick = *next < HUGE_VAL;
    return done(f, failure);
}

EXPORT fmi3Status fmi3EnterContinuousTimeMode(fmu *f) {
    f->m.at_event = 0;
    return fmi3OK;
}

EXPORT fmi3Status fmi3CompletedIntegratorStep(fmu *f, bool no_return, bool *event, bool *terminate) {
    (void)no_return;
    *event = has_left(&f->m);
    *terminate = false;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetTime(fmu *f, double time) {
    f->m.t = time;
    f->m.known = 0;
    return fmi3OK;
}

EXPORT fmi3Status fmi3SetContinuousStates(fmu *f, const double states[], size_t count) {
    set_states(&f->m, states, count);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetContinuousStates(fmu *f, double states[], size_t count) {
    get_states(&f->m, states, count);
    return fmi3OK;
}

EXPORT fmi3Status fmi3GetContinuousStateDerivatives(fmu *f, double derivatives[], size_t count) {
    return done(f, get_derivatives(&f->m, derivatives, count));
}

EXPORT fmi3Status fmi3GetEventIndicators(fmu *f, double z[], size_t count) {
    (void)count;
    return done(f, get_indicators(&f->m, z));
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
    (void)no_return;
    const char *failure = do_step(&f->m, now, length);
    *event = false;
    *terminate = f->m.stopped;
    *early = false;
    *last = f->m.t;
    return done(f, failure);
}
