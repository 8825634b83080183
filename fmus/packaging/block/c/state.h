/* What an instance of a discrete-time block holds.
 *
 * model.c, generated, provides
 *     FMI_VERSION, MODEL_IDENTIFIER, MODEL_TOKEN, MODEL_TOLERANCE, N_U, N_Y, N_P, N_STATES,
 *     SAMPLE_TIME, SAMPLE_PHASE (integer nanoseconds), N_X (0: no continuous states),
 *     model_names[], by value reference,
 *     model_start[], the start values of all variables but time,
 *     model_p_tunable[]. */
#ifndef STATE_H
#define STATE_H

#include <stdint.h>

#include "component.h"

/* What component_new can make. */
enum { OFFERS_MODEL_EXCHANGE = 0 };

/* Value references: time, inputs, outputs, parameters, states. */
enum {
    INPUT_REFERENCE = 1,
    OUTPUT_REFERENCE = INPUT_REFERENCE + N_U,
    PARAMETER_REFERENCE = OUTPUT_REFERENCE + N_Y,
    STATE_REFERENCE = PARAMETER_REFERENCE + N_P,
    END_REFERENCE = STATE_REFERENCE + N_STATES,
    N_VALUES = END_REFERENCE - INPUT_REFERENCE
};

/* Everything that a stored FMU state must hold for a bit-equal continuation. */
typedef struct {
    Kind kind;
    Mode mode;
    bool stop_time_defined;
    double time;
    double start_time;
    double stop_time;
    double relative_tolerance; /* taken from the importer; a block has no use for it */
    int64_t samples; /* computed so far; the next one is due at phase + samples * sample time */
    double values[N_VALUES + 1]; /* the + 1 only keeps an empty array legal */
} State;

struct Component {
    State state;
    char *name;
    LogSink log_sink;
    void *environment;
    void (*logger)(void); /* the importer's callback, cast by the layer that stored it */
    unsigned log_categories;
    double trial[N_VALUES + 1]; /* the values while a step is computed that may fail */
};

/* The step function, from its object file: x is advanced and y written in place. 0, or what says
 * that it could not go on. */
extern int32_t block_step(double *p, double *x, double *u, double *y);

/* What the step function may call, besides the C library. */
int32_t block_reshape(int64_t n, const int64_t *dimensions, const int64_t *strides, int64_t n_new,
                      const int64_t *new_dimensions, int64_t *new_strides, int64_t item_size,
                      int32_t columns_first);

#endif
