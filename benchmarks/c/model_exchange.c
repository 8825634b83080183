/* The bare C program of model exchange: the FMU's library and SUNDIALS' CVODE by dlopen, a PI
 * controller on a square wave, the rows in memory.
 *
 *     model_exchange FMU_LIBRARY TOKEN SAMPLES SUNDIALS...
 *
 * prints nanoseconds of processor time a sample, and y and u at the last one as hexadecimal floats.
 * At each sample it gets y, computes u, stores a row, sets u in event mode, begins CVODE anew and
 * solves to the next one, step by step, each told to the FMU where COMPLETED is 1. The Jacobian is
 * the FMU's where JACOBIAN is 1. FMI, the tolerance, references, gains (per sample) and STEP_NS come
 * from the command line of cc. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { BDF = 2, ONE_STEP = 2, N = STATES };
typedef struct {
    double time, y, u;
} Row;

#if FMI == 2
typedef int Boolean;
#define NAME(name) "fmi2" name
#define DERIVATIVES "fmi2GetDerivatives"
#define UPDATE "fmi2NewDiscreteStates"
#define GET "fmi2GetReal"
#define SET "fmi2SetReal"
#define SIZE
#define FMI3_SIZE
#else
typedef bool Boolean;
#define NAME(name) "fmi3" name
#define DERIVATIVES "fmi3GetContinuousStateDerivatives"
#define UPDATE "fmi3UpdateDiscreteStates"
#define GET "fmi3GetFloat64"
#define SET "fmi3SetFloat64"
#define SIZE , 1
#define FMI3_SIZE , size_t
#endif

/* The prototypes of SUNDIALS 7 that are needed; sunrealtype is double, sunindextype int64_t. */
static int (*create_context)(int, void **), (*init)(void *, void *, double, void *);
static void *(*new_vector)(int64_t, void *), *(*dense)(int64_t, int64_t, void *);
static void *(*solver)(void *, void *, void *), *(*create)(int, void *);
static double *(*data)(void *), *(*matrix_data)(void *);
static int (*tolerances)(void *, double, void *), (*set_solver)(void *, void *, void *);
static int (*set_jacobian)(void *, void *), (*set_max_step)(void *, double);
static int (*set_max_steps)(void *, long), (*set_stop)(void *, double);
static int (*reinit)(void *, double, void *), (*cvode)(void *, double, void *, double *, int);

static void *c, *library;
static int (*set_time)(void *, double), (*set_states)(void *, const double *, size_t);
static int (*get_derivatives)(void *, double *, size_t), (*enter_events)(void *);
static int (*leave_events)(void *);
#if FMI == 2
static int (*update)(void *, void *);
static int (*completed)(void *, int, int *, int *);
static int (*directional)(void *, const unsigned *, size_t, const unsigned *, size_t, const double *,
                          double *);
#else
static int (*update)(void *, bool *, bool *, bool *, bool *, bool *, double *);
static int (*completed)(void *, bool, bool *, bool *);
static int (*directional)(void *, const unsigned *, size_t, const unsigned *, size_t, const double *,
                          size_t, double *, size_t);
#endif

static void *find(void *from, const char *name) {
    void *address = dlsym(from, name);
    if (!address) fprintf(stderr, "no function %s\n", name), exit(1);
    return address;
}

static void check(int failed, const char *what) {
    if (failed) fprintf(stderr, "%s failed\n", what), exit(1);
}

static int rhs(double t, void *y, void *dy, void *unused) {
    (void)unused;
    if (set_time(c, t) > 1 || set_states(c, data(y), N) > 1) return -1;
    return get_derivatives(c, data(dy), N) > 1 ? -1 : 0;
}

static int jacobian(double t, void *y, void *fy, void *matrix, void *u, void *a, void *b, void *d) {
    static const unsigned states[] = {STATE_REFERENCES}, rates[] = {RATE_REFERENCES};
    const double seed = 1.0;
    (void)fy, (void)u, (void)a, (void)b, (void)d;
    if (set_time(c, t) > 1 || set_states(c, data(y), N) > 1) return -1;
    for (int j = 0; j < N; j++) {
        double *column = matrix_data(matrix) + N * j;
#if FMI == 2
        if (directional(c, rates, N, states + j, 1, &seed, column) > 1) return -1;
#else
        if (directional(c, rates, N, states + j, 1, &seed, 1, column, N) > 1) return -1;
#endif
    }
    return 0;
}

/* Iterate the discrete states and leave event mode. */
static void settle(void) {
#if FMI == 2
    struct {
        int again, end, nominals, values, known;
        double next;
    } info;
    do check(update(c, &info) > 1, UPDATE);
    while (info.again);
#else
    bool again, end, nominals, values, known;
    double next;
    do check(update(c, &again, &end, &nominals, &values, &known, &next) > 1, UPDATE);
    while (again);
#endif
    check(leave_events(c) > 1, "EnterContinuousTimeMode");
}

static void ignore(void) {}

static void initialise(const char *token) {
    int (*leave)(void *) = find(library, NAME("ExitInitializationMode"));
#if FMI == 2
    static const struct {
        void (*logger)(void), *(*allocate)(size_t, size_t), (*free)(void *);
        void *finished, *environment;
    } callbacks = {ignore, calloc, free, NULL, NULL};
    void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int) =
        find(library, "fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) = find(library, "fmi2SetupExperiment");
    int (*enter)(void *) = find(library, "fmi2EnterInitializationMode");
    c = instantiate("plant", 0, token, "", &callbacks, 0, 0);
    check(!c || setup(c, 1, TOLERANCE, 0.0, 0, 0.0) > 1 || enter(c) > 1, "initialisation");
#else
    void *(*instantiate)(const char *, const char *, const char *, bool, bool, void *, void *) =
        find(library, "fmi3InstantiateModelExchange");
    int (*enter)(void *, bool, double, double, bool, double) =
        find(library, "fmi3EnterInitializationMode");
    c = instantiate("plant", token, NULL, 0, 0, NULL, (void *)ignore);
    check(!c || enter(c, true, TOLERANCE, 0.0, false, 0.0) > 1, "initialisation");
#endif
    check(leave(c) > 1, "ExitInitializationMode");
}

static void bind(char **paths) {
    void *s = NULL;
    for (; *paths; paths++) {
        s = dlopen(*paths, RTLD_NOW | RTLD_GLOBAL);
        if (!s) fprintf(stderr, "%s\n", dlerror()), exit(1);
    }
    s = RTLD_DEFAULT;
    create_context = find(s, "SUNContext_Create"), new_vector = find(s, "N_VNew_Serial");
    data = find(s, "N_VGetArrayPointer"), matrix_data = find(s, "SUNDenseMatrix_Data");
    dense = find(s, "SUNDenseMatrix"), solver = find(s, "SUNLinSol_Dense");
    create = find(s, "CVodeCreate"), init = find(s, "CVodeInit");
    tolerances = find(s, "CVodeSVtolerances"), set_solver = find(s, "CVodeSetLinearSolver");
    set_jacobian = find(s, "CVodeSetJacFn"), set_max_step = find(s, "CVodeSetMaxStep");
    set_max_steps = find(s, "CVodeSetMaxNumSteps"), set_stop = find(s, "CVodeSetStopTime");
    reinit = find(s, "CVodeReInit"), cvode = find(s, "CVode");
    set_time = find(library, NAME("SetTime"));
    set_states = find(library, NAME("SetContinuousStates"));
    get_derivatives = find(library, DERIVATIVES), update = find(library, UPDATE);
    enter_events = find(library, NAME("EnterEventMode"));
    leave_events = find(library, NAME("EnterContinuousTimeMode"));
    completed = find(library, NAME("CompletedIntegratorStep"));
    directional = find(library, NAME("GetDirectionalDerivative"));
}

static void *solver_at_start(void *context, void **vector) {
    int (*get_states)(void *, double *, size_t) = find(library, NAME("GetContinuousStates"));
    int (*nominals)(void *, double *, size_t) =
        find(library, NAME("GetNominalsOfContinuousStates"));
    void *states = *vector = new_vector(N, context), *absolute = new_vector(N, context);
    void *memory, *matrix;
    check(get_states(c, data(states), N) > 1 || nominals(c, data(absolute), N) > 1, "states");
    for (int i = 0; i < N; i++) data(absolute)[i] = TOLERANCE * fabs(data(absolute)[i]);
    memory = create(BDF, context), matrix = dense(N, N, context);
    check(init(memory, rhs, 0.0, states) || tolerances(memory, TOLERANCE, absolute), "CVodeInit");
    check(set_solver(memory, solver(states, matrix, context), matrix), "CVodeSetLinearSolver");
    check(JACOBIAN && set_jacobian(memory, jacobian), "CVodeSetJacFn");
    check(set_max_step(memory, STEP_NS / 1e9) || set_max_steps(memory, 10000), "CVodeSet");
    return memory;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * t.tv_sec + t.tv_nsec;
}

/* From `time` to `end`, each accepted step told to the FMU. */
static void solve(void *memory, void *states, double time, double end) {
    check(reinit(memory, time, states), "CVodeReInit");
    while (time < end) {
        check(set_stop(memory, end), "CVodeSetStopTime");
        check(cvode(memory, end, states, &time, ONE_STEP) < 0, "CVode");
        if (fabs(time - end) <= 0x1p-49 * end) time = end;
        check(set_time(c, time) > 1 || set_states(c, data(states), N) > 1, "SetTime");
        Boolean event, terminate;
        if (COMPLETED) check(completed(c, 1, &event, &terminate) > 1, "CompletedIntegratorStep");
    }
}

int main(int count, char **arguments) {
    if (count < 5) return 2;
    library = dlopen(arguments[1], RTLD_NOW);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 1;
    bind(arguments + 4);
    const long samples = atol(arguments[3]);
    initialise(arguments[2]);
    settle();
    void *context = NULL, *states;
    check(create_context(0, &context), "SUNContext_Create");
    void *memory = solver_at_start(context, &states);
    int (*get)(void *, const unsigned *, size_t, double * FMI3_SIZE) = find(library, GET);
    int (*set)(void *, const unsigned *, size_t, const double * FMI3_SIZE) = find(library, SET);
    Row *rows = malloc((samples + 1) * sizeof(Row));
    memset(rows, 0, (samples + 1) * sizeof(Row)); /* touched, so that C is at its best */
    const unsigned reference_u = INPUT, reference_y = OUTPUT;
    double y = 0.0, u = 0.0, integral = 0.0, reference = REFERENCE, left = HALF_PERIOD;

    const double began = now();
    for (long k = 0; k <= samples; k++) {
        const double time = k * (int64_t)STEP_NS / 1e9, end = (k + 1) * (int64_t)STEP_NS / 1e9;
        check(get(c, &reference_y, 1, &y SIZE) > 1, GET);
        if (left == 0.0) reference = -reference, left = HALF_PERIOD;
        left -= 1.0;
        const double error = reference - y;
        integral += KI * error;
        const double applied = KP * error + integral;
        const bool changed = k == 0 || applied != u;
        u = applied;
        rows[k] = (Row){time, y, u};
        if (changed) {
            check(enter_events(c) > 1, "EnterEventMode");
            check(set(c, &reference_u, 1, &u SIZE) > 1, SET);
            settle();
        }
        if (k < samples) solve(memory, states, time, end);
    }
    printf("%.6f %a %a\n", (now() - began) / samples, y, u);
    return 0;
}
