/* One instance of a mechanism in an FMU: its state, what is computed of it, and what happens to it. */
#ifndef DALEMBERT_INSTANCE_H
#define DALEMBERT_INSTANCE_H

#include "fmu_description.h"

/* No array of C is empty. */
#define ROOM(count) ((count) > 0 ? (count) : 1)

enum {
    STATES = MECHANICAL + COORDINATES, /* q of the file's coordinates, then v */
    SIGNALS = 3 * INPUTS,
    INDICATORS = EVENTS + MODES
};

typedef struct {
    MODEL(parameters) p;
    double c[ROOM(CONSTANTS)], t, q[ROOM(COORDINATES)], v[ROOM(COORDINATES)], a[ROOM(COORDINATES)], l[ROOM(ROWS)];
    double u[ROOM(SIGNALS)], given[ROOM(SIGNALS)];
    char is_given[ROOM(SIGNALS)];  /* inputs that the importer has set; the file's functions of time stand for the others */
    double since[ROOM(INPUTS)];    /* when each was set last */
    double before[ROOM(SIGNALS)];  /* what those had come to that were set since the last step or event, */
    double waited[ROOM(INPUTS)];   /* how long before that they had been set, */
    char is_new[ROOM(INPUTS)];     /* and which they are */
    int known;                     /* whether u, a and l belong to this state */
    int failed;                    /* whether there are no accelerations */
    double side[ROOM(EVENTS)];     /* signs of events' functions since the last event; 0 where one was zero and stayed */
    double size[ROOM(EVENTS)];     /* the largest value of each that was seen */
    double approach;               /* the fastest impact */
    double first[ROOM(CLOCKS)], period[ROOM(CLOCKS)], ticks[ROOM(CLOCKS)];
    double tolerance, step;
    int stopped;
    int goes_on;      /* whether inputs go on with their rates: in Co-Simulation, where they are set between steps only */
    int at_event;     /* whether what is set may jump */
    int initializing; /* whether everything may still be set */
    int running;      /* whether the initialization is over */
    int starting;     /* whether events of the start are still to happen */
    int was_set;      /* whether something was set since the last step, */
    int tuned;        /* and parameters were */
    char why[256];    /* why there is no answer, where that is known */
} instance;

/* Begins at the start that was exported. */
void begin(instance *m, int co_simulation);

/* Fills what depends on parameters, and keeps modes, phase and held values. */
void take_parameters(instance *m);

/* Puts the state on the constraints, and modes where it is: at the start, and whenever an importer was free to change everything; 0 where
   there are no such modes. */
int settle(instance *m);

/* Sets u, u' or u'' of an input. */
void set_input(instance *m, int signal, double value);

/* What inputs that were set do to the speeds at once; 0 where that has no finite answer.  `changed` tells whether they did anything. */
int take_inputs(instance *m, int *changed);

/* The coordinate along which M is negative, or -1. */
int negative_inertia(instance *m);

/* Computes inputs, accelerations and multipliers of the present state, once; 0 where there are none. */
int evaluate(instance *m);

/* One number for each event and each discontinuity, which changes its sign where it happens. */
int indicators(instance *m, double *z);

/* Outputs of the present state. */
int outputs(instance *m, double *y);

/* Does what has happened since the last time; 0 where it cannot be done.  `changed` tells whether the state did. */
int happen(instance *m, int *changed);

/* The time of the next tick. */
double next_tick(const instance *m);

/* Whether rows act in the phase. */
int is_constrained(const instance *m);

/* How far the state has left the constraints, in parts of what they are made of. */
double drift(instance *m);

/* Brings the state back to the constraints. */
int project(instance *m);

/* Integrates to a time, events included: Dormand and Prince's method of order 5(4). */
int integrate(instance *m, double until);

#endif
