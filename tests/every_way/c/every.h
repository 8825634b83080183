/* What the FMUs of these tests have in common: a model is a table of values by value reference,
   with an exact solution between its events. A model file is included by fmi1.c, fmi2.c or fmi3.c
   (-DMODEL="…"), which give it the C interface. */
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define REFERENCES 100
#define MOST 8 /* elements of an array */
#define TEXT 32
#define NEVER HUGE_VAL
enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double d;  /* of floating types */
    int64_t i; /* of all others */
    char text[TEXT];
    size_t length;
} cell;

typedef struct {
    double t, begin, next;                            /* time, start time, next time event (s) */
    double tolerance;                                 /* as the importer gave it, or 0 */
    unsigned structural;                              /* to be set in configuration mode only */
    bool stepping, event_mode, may_return, handling;  /* co-simulation; handling: in event mode */
    bool configuring, asked;                          /* asked: a step event was asked for */
    bool needs_update, values_changed, nominals_changed;
    int iteration, steps;
    double nominals[4];
    size_t size[REFERENCES]; /* elements by value reference; 0: there is no such variable */
    cell v[REFERENCES][MOST];
} model;

#define D(reference) (m->v[reference][0].d)
#define I(reference) (m->v[reference][0].i)

/* A model file defines GUID, NX, NZ, STATES, RATES, INDICATORS (value references) and: */
static void start(model *m);                 /* declare variables, set start values */
static void evaluate(model *m);              /* outputs and derivatives, from all else */
static double ahead(const model *m);         /* time (s) of the next event */
static void flow(model *m, double dt);       /* go on where there is no event, exactly */
static void event(model *m);                 /* one iteration of an event; sets the flags */
static bool wants_event(const model *m);     /* after a step of the integrator */
static void set_clock(model *m, unsigned r); /* a tick */
static bool get_clock(const model *m, unsigned r);
static bool interval(model *m, unsigned r, double *seconds); /* false: unchanged */

static void declare(model *m, unsigned first, unsigned last, size_t size) {
    for (unsigned r = first; r <= last; r++) m->size[r] = size;
}
static void initialise(model *m, double begin, double tolerance) {
    m->tolerance = tolerance;
    m->t = m->begin = begin;
    m->next = NEVER;
    for (int i = 0; i < 4; i++) m->nominals[i] = 1.0;
}
static void iterate(model *m) {
    m->needs_update = m->values_changed = m->nominals_changed = false;
    if (m->stepping && wants_event(m)) m->asked = true;
    event(m);
    m->asked = false;
    m->iteration = m->needs_update ? m->iteration + 1 : 0;
    evaluate(m);
}
static void settle(model *m) {
    do iterate(m);
    while (m->needs_update);
}
/* Go on to `stop`, or to the first event where `until_event`; true where one is to be handled. */
static bool advance(model *m, double stop, bool until_event) {
    m->steps++;
    while (m->t < stop) {
        double first = ahead(m), to = fmin(first, stop);
        flow(m, to - m->t);
        m->t = to;
        evaluate(m);
        if (first > stop) break;
        if (until_event) return true;
        settle(m);
    }
    evaluate(m);
    return false;
}

/* Every getter and setter is this loop over the elements of all references; anything that is not
   there, and a number of values that does not fit, is an error. */
#define EACH(...)                                                                                  \
    size_t k = 0;                                                                                  \
    for (size_t i = 0; i < n; i++) {                                                               \
        if (r[i] >= REFERENCES || !m->size[r[i]]) return ERROR;                                    \
        for (size_t j = 0; j < m->size[r[i]]; j++, k++) {                                          \
            cell *c = &m->v[r[i]][j];                                                              \
            __VA_ARGS__;                                                                           \
        }                                                                                          \
    }
