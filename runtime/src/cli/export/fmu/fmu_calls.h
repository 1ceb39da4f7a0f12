/* What an importer asks of an instance, whatever the version of FMI.  Functions return NULL, or why there is no answer. */
#ifndef DALEMBERT_CALLS_H
#define DALEMBERT_CALLS_H

#include <stddef.h>

#include "fmu_instance.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define EXPORT __attribute__((visibility("default")))
#else
#define EXPORT
#endif

typedef unsigned int reference;

/* Begins at a time; a tolerance of 0 is that of the file. */
void begin_initialization(instance *m, double start, double tolerance);

/* Puts the start on its constraints; with `at_once` what happens at it is done. */
const char *end_initialization(instance *m, int at_once);

/* Numbers by their value references. */
const char *get_values(instance *m, const reference *which, size_t count, double *values);
const char *set_values(instance *m, const reference *which, size_t count, const double *values);

/* The phase, the only whole number. */
const char *get_whole(instance *m, const reference *which, size_t count, int *values);
const char *set_whole(instance *m, const reference *which, size_t count, const int *values);

/* How unknowns change where knowns change by seeds. */
const char *get_slopes(instance *m, const reference *unknowns, size_t rows, const reference *knowns, size_t columns, const double *seeds, double *slopes);

/* The states: q of the file's coordinates, then v. */
void set_states(instance *m, const double *states, size_t count);
void get_states(instance *m, double *states, size_t count);
const char *get_derivatives(instance *m, double *derivatives, size_t count);
const char *get_indicators(instance *m, double *z);

/* Whether the state has left the constraints so far that it is to be put back at an event. */
int has_left(instance *m);

/* Does what has happened at an event. */
const char *update(instance *m, int *changed);

/* Integrates over a step of the importer. */
const char *do_step(instance *m, double now, double length);

#endif
