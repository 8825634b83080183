/* One instance of the model, without any FMI type: its state, its life cycle, its calculations.
 * fmi2.c and fmi3.c are thin layers over these functions. state.h says what an instance holds.
 *
 * model.c, generated, provides
 *     FMI_VERSION, MODEL_IDENTIFIER, MODEL_TOKEN, MODEL_TOLERANCE, N_X, N_U, N_Y, N_P,
 *     N_JACOBIAN, N_STATE_JACOBIAN, N_FACTORS, N_INVARIANTS,
 *     model_names[], by value reference,
 *     model_x_start[], model_x_nominal[], model_u_start[],
 *     model_p_start[], model_p_minimum[], model_p_maximum[], model_p_tunable[],
 *     model_jacobian_starts[], model_jacobian_rows[] (compressed columns of d(f,h)/d(x,u,p)),
 *     model_state_jacobian_rows[] (rows of the nonzeros of df/dx, by columns),
 *     model_invariants(), model_derivatives(), model_outputs(), model_linearise(), model_jacobian(),
 *     model_factorise(), model_solve().
 *
 * Refused calls (wrong mode, value reference, value) change nothing. A failed do_step keeps the
 * state as it was before the step and leaves the instance in MODE_FAILED, where values can be read
 * and the state can be set, and reset. */
#ifndef COMPONENT_H
#define COMPONENT_H

#include <stdbool.h>
#include <stddef.h>

/* Numbered as fmi2Status and fmi3Status are. */
typedef enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL } Status;

typedef enum {
    MODE_INSTANTIATED = 1,
    MODE_INITIALIZATION = 2,
    MODE_EVENT = 4,
    MODE_CONTINUOUS_TIME = 8,
    MODE_STEP = 16,
    MODE_FAILED = 32,
    MODE_TERMINATED = 64
} Mode;

enum {
    MODES_BEFORE_RUN = MODE_INSTANTIATED | MODE_INITIALIZATION,
    MODES_OF_RUN = MODE_EVENT | MODE_CONTINUOUS_TIME | MODE_STEP,
    MODES_WITH_EQUATIONS = MODE_INITIALIZATION | MODES_OF_RUN | MODE_TERMINATED,
    MODES_ALL = 127
};

typedef enum { KIND_MODEL_EXCHANGE, KIND_CO_SIMULATION } Kind;

/* Debug messages come by category and only when asked for; errors and warnings always come. */
typedef enum { LOG_EVENTS = 1, LOG_SOLVER = 2, LOG_WARNING = 4, LOG_ERROR = 8 } Category;

typedef struct Component Component;

/* How a message leaves: the FMI layer knows the callback's type. */
typedef void (*LogSink)(const Component *component, Status status, const char *category,
                        const char *text);

/* Life cycle. component_new returns NULL, with a message in the log, for a wrong token. */
static Component *component_new(const char *name, const char *token, Kind kind, LogSink sink,
                                void *environment, void (*logger)(void), bool logging_on);
static void component_free(Component *component);
static Status component_reset(Component *component);
static Status component_setup(Component *component, const char *call, bool tolerance_defined,
                              double tolerance, double start_time, bool stop_time_defined,
                              double stop_time);
static Status component_exit_initialization(Component *component, const char *call);
static Status component_change_mode(Component *component, const char *call, int legal, Mode next);

/* STATUS_OK when the instance is in one of the `legal` modes, else STATUS_ERROR and a message. */
static Status component_check_mode(const Component *component, const char *call, int legal);
/* The same for the interface type. */
static Status component_check_kind(const Component *component, const char *call, Kind kind);

static Status component_log(const Component *component, Status status, Category category,
                            const char *format, ...);
static Status component_set_logging(Component *component, bool on, size_t n,
                                    const char *const categories[]);
static Status component_unsupported(const Component *component, const char *call);

/* Variables by value reference. A set is done whole or not at all. */
static Status component_get(Component *component, const char *call, const unsigned references[],
                            size_t n, double values[]);
static Status component_set(Component *component, const char *call, const unsigned references[],
                            size_t n, const double values[]);

static Status component_no_variable(const Component *component, const char *call,
                                    const unsigned references[]);

/* Whole vectors, for model exchange. */
static Status component_set_states(Component *component, const char *call, const double x[],
                                   size_t n);
static Status component_get_states(const Component *component, const char *call, double x[],
                                   size_t n);
static Status component_get_nominals(const Component *component, const char *call,
                                     double nominals[], size_t n);
static Status component_get_derivatives(Component *component, const char *call, double dx[],
                                        size_t n);
static Status component_set_time(Component *component, const char *call, double time);

/* Step from `time` over `step`; the new time is time + step. */
static Status component_do_step(Component *component, const char *call, double time, double step);

/* d unknowns / d knowns * seed (states, inputs, parameters to derivatives, outputs, states). */
static Status component_directional(const Component *component, const char *call,
                                    const unsigned unknowns[], size_t n_unknowns,
                                    const unsigned knowns[], size_t n_knowns, const double seed[],
                                    double sensitivity[]);
#if FMI_VERSION == 3
/* (d unknowns / d knowns)^T * seed */
static Status component_adjoint(const Component *component, const char *call,
                                const unsigned unknowns[], size_t n_unknowns,
                                const unsigned knowns[], size_t n_knowns, const double seed[],
                                double sensitivity[]);
#endif
/* dy/dt with inputs held. */
static Status component_output_derivatives(Component *component, const char *call,
                                           const unsigned references[], size_t n,
                                           const int orders[], double values[]);

/* Stored states: State structures on the heap, and the same with a header as bytes. */
static Status component_get_stored(Component *component, void **stored);
static Status component_set_stored(Component *component, const char *call, const void *stored);
static Status component_free_stored(void **stored);
static size_t component_serialized_size(void);
static Status component_serialize(Component *component, const char *call, const void *stored,
                                  void *bytes, size_t size);
static Status component_deserialize(Component *component, const char *call, const void *bytes,
                                    size_t size, void **stored);

#endif
