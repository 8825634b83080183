/* What an instance of a plant holds. */
#ifndef STATE_H
#define STATE_H

#include "component.h"

/* What component_new can make. */
enum { OFFERS_MODEL_EXCHANGE = 1 };

/* Value references: time, states, derivatives, inputs, outputs, parameters. */
enum {
    STATE_REFERENCE = 1,
    DERIVATIVE_REFERENCE = STATE_REFERENCE + N_X,
    INPUT_REFERENCE = DERIVATIVE_REFERENCE + N_X,
    OUTPUT_REFERENCE = INPUT_REFERENCE + N_U,
    PARAMETER_REFERENCE = OUTPUT_REFERENCE + N_Y,
    END_REFERENCE = PARAMETER_REFERENCE + N_P
};

/* Everything that a stored FMU state must hold for a bit-equal continuation. */
typedef struct {
    Kind kind;
    Mode mode;
    bool stop_time_defined;
    double time;
    double start_time;
    double stop_time;
    double relative_tolerance;
    double substep; /* the solver's next substep; 0 before the first */
    double x[N_X + 1]; /* the + 1 only keeps empty arrays legal */
    double u[N_U + 1];
    double p[N_P + 1];
} State;

struct Component {
    State state;
    char *name;
    LogSink log_sink;
    void *environment;
    void (*logger)(void); /* the importer's callback, cast by the layer that stored it */
    unsigned log_categories;
    bool invariants_valid; /* invariants are those of u and p */
    bool outputs_valid; /* y is h(x, u, p) of the present state */
    bool derivatives_valid;
    double dx[N_X + 1];
    double y[N_Y + 1];
    double invariants[N_INVARIANTS + 1];
};

#endif
