/* The functions of FMI 2.0 (fmi-standard.org) for one mechanism. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fmu_calls.h"

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum { fmi2DoStepStatus, fmi2PendingStatus, fmi2LastSuccessfulTime, fmi2Terminated } fmi2StatusKind;
typedef const char *text;

typedef struct {
    void (*log)(void *environment, text name, fmi2Status status, text category, text message, ...);
    void *(*allocate)(size_t count, size_t size);
    void (*release)(void *memory);
    void (*finished)(void *environment, fmi2Status status);
    void *environment;
} callbacks;

typedef struct {
    int again, terminate, nominals, values, has_next;
    double next;
} event_info;

/* How long a name is that is told with messages. */
#define NAME 64

typedef struct {
    instance m;
    fmi2Type type;
    const callbacks *callbacks;
    char name[NAME];
    double start, tolerance; /* of the experiment */
} fmu;

static fmi2Status told(const fmu *f, fmi2Status status, text message) {
    if (f->callbacks && f->callbacks->log)
        f->callbacks->log(f->callbacks->environment, f->name, status, "logStatusError", "%s", message);
    return status;
}

/* Of why there is no answer, NULL where there is one. */
static fmi2Status done(const fmu *f, text failure) {
    return failure ? told(f, fmi2Error, failure) : fmi2OK;
}

EXPORT text fmi2GetTypesPlatform(void) {
    return "default";
}

EXPORT text fmi2GetVersion(void) {
    return "2.0";
}

EXPORT fmi2Status fmi2SetDebugLogging(void *f, int on, size_t count, const text categories[]) {
    (void)f; (void)on; (void)count; (void)categories;
    return fmi2OK;
}

EXPORT void *fmi2Instantiate(text name, fmi2Type type, text token, text resources, const callbacks *functions, int visible, int logging) {
    (void)resources; (void)visible; (void)logging;
    fmu *f = calloc(1, sizeof *f);
    if (!f) return NULL;
    f->type = type;
    f->callbacks = functions;
    if (name) strncpy(f->name, name, NAME - 1);
    if (!token || strcmp(token, TOKEN) != 0) {
        told(f, fmi2Error, "the GUID is not that of this FMU");
        free(f);
        return NULL;
    }
    begin(&f->m, f->type == fmi2CoSimulation);
    return f;
}

EXPORT void fmi2FreeInstance(fmu *f) {
    free(f);
}

EXPORT fmi2Status fmi2SetupExperiment(fmu *f, int with_tolerance, double tolerance, double start, int with_stop, double stop) {
    (void)with_stop; (void)stop;
    f->start = start;
    f->tolerance = with_tolerance ? tolerance : 0.0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmu *f) {
    begin_initialization(&f->m, f->start, f->tolerance);
    return fmi2OK;
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmu *f) {
    return done(f, end_initialization(&f->m, f->type == fmi2CoSimulation));
}

EXPORT fmi2Status fmi2Terminate(fmu *f) {
    (void)f;
    return fmi2OK;
}

EXPORT fmi2Status fmi2Reset(fmu *f) {
    begin(&f->m, f->type == fmi2CoSimulation);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetReal(fmu *f, const reference which[], size_t count, double values[]) {
    return done(f, get_values(&f->m, which, count, values));
}

EXPORT fmi2Status fmi2SetReal(fmu *f, const reference which[], size_t count, const double values[]) {
    return done(f, set_values(&f->m, which, count, values));
}

EXPORT fmi2Status fmi2GetInteger(fmu *f, const reference which[], size_t count, int values[]) {
    return done(f, get_whole(&f->m, which, count, values));
}

EXPORT fmi2Status fmi2SetInteger(fmu *f, const reference which[], size_t count, const int values[]) {
    return done(f, set_whole(&f->m, which, count, values));
}

/* Types of which this FMU has no variables. */
#define NONE(CALL, TYPE)                                                                         \
    EXPORT fmi2Status fmi2##CALL(fmu *f, const reference which[], size_t count, TYPE values[]) { \
        (void)which; (void)values;                                                               \
        return done(f, count ? "there are no variables of this type" : NULL);                    \
    }

NONE(GetBoolean, int)
NONE(SetBoolean, const int)
NONE(GetString, text)
NONE(SetString, const text)

EXPORT fmi2Status fmi2GetFMUstate(fmu *f, void **kept) {
    if (!*kept) *kept = malloc(sizeof *f);
    if (!*kept) return done(f, "no memory is left");
    memcpy(*kept, f, sizeof *f);
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmu *f, void *kept) {
    memcpy(f, kept, sizeof *f);
    return fmi2OK;
}

EXPORT fmi2Status fmi2FreeFMUstate(fmu *f, void **kept) {
    (void)f;
    free(*kept);
    *kept = NULL;
    return fmi2OK;
}

/* Without derivatives a simulation can go on. */
EXPORT fmi2Status fmi2GetDirectionalDerivative(fmu *f, const reference unknowns[], size_t rows, const reference knowns[], size_t columns,
                                               const double seeds[], double out[]) {
    text failure = get_slopes(&f->m, unknowns, rows, knowns, columns, seeds, out);
    return failure ? told(f, fmi2Discard, failure) : fmi2OK;
}

EXPORT fmi2Status fmi2EnterEventMode(fmu *f) {
    f->m.at_event = 1;
    return fmi2OK;
}

EXPORT fmi2Status fmi2NewDiscreteStates(fmu *f, event_info *info) {
    int changed = 0;
    text failure = update(&f->m, &changed);
    info->again = info->nominals = 0;
    info->terminate = f->m.stopped;
    info->values = changed;
    info->next = next_tick(&f->m);
    info->has_next = info->next < HUGE_VAL;
    return done(f, failure);
}

EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmu *f) {
    f->m.at_event = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2CompletedIntegratorStep(fmu *f, int no_return, int *event, int *terminate) {
    (void)no_return;
    *event = has_left(&f->m);
    *terminate = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetTime(fmu *f, double time) {
    f->m.t = time;
    f->m.known = 0;
    return fmi2OK;
}

EXPORT fmi2Status fmi2SetContinuousStates(fmu *f, const double states[], size_t count) {
    set_states(&f->m, states, count);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetContinuousStates(fmu *f, double states[], size_t count) {
    get_states(&f->m, states, count);
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetDerivatives(fmu *f, double derivatives[], size_t count) {
    return done(f, get_derivatives(&f->m, derivatives, count));
}

EXPORT fmi2Status fmi2GetEventIndicators(fmu *f, double z[], size_t count) {
    (void)count;
    return done(f, get_indicators(&f->m, z));
}

EXPORT fmi2Status fmi2GetNominalsOfContinuousStates(fmu *f, double nominals[], size_t count) {
    (void)f;
    for (size_t k = 0; k < count; k++) nominals[k] = nominal[k];
    return fmi2OK;
}

/* A step that ends the simulation is discarded, and the status tells why. */
EXPORT fmi2Status fmi2DoStep(fmu *f, double now, double length, int no_return) {
    (void)no_return;
    text failure = do_step(&f->m, now, length);
    return failure ? done(f, failure) : f->m.stopped ? fmi2Discard : fmi2OK;
}

EXPORT fmi2Status fmi2GetRealStatus(fmu *f, fmi2StatusKind kind, double *value) {
    if (kind != fmi2LastSuccessfulTime) return fmi2Discard;
    *value = f->m.t;
    return fmi2OK;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmu *f, fmi2StatusKind kind, int *value) {
    if (kind != fmi2Terminated) return fmi2Discard;
    *value = f->m.stopped;
    return fmi2OK;
}

/* What this FMU does not do. */
#define NOT(CALL, ...)                                                  \
    EXPORT fmi2Status fmi2##CALL(fmu *f, __VA_ARGS__) {                 \
        return done(f, "fmi2" #CALL " is not provided by this FMU");    \
    }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#endif
NOT(SerializedFMUstateSize, void *kept, size_t *size)
NOT(SerializeFMUstate, void *kept, char bytes[], size_t size)
NOT(DeSerializeFMUstate, const char bytes[], size_t size, void **kept)
NOT(SetRealInputDerivatives, const reference which[], size_t count, const int orders[], const double values[])
NOT(GetRealOutputDerivatives, const reference which[], size_t count, const int orders[], double values[])
NOT(GetStatus, fmi2StatusKind kind, fmi2Status *value)
NOT(GetIntegerStatus, fmi2StatusKind kind, int *value)
NOT(GetStringStatus, fmi2StatusKind kind, text *value)

EXPORT fmi2Status fmi2CancelStep(fmu *f) {
    return done(f, "no step is pending: each is done when its call returns");
}
