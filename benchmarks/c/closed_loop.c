/* The bare C program: the FMU's library by dlopen, PI controllers, the rows in memory.
 *
 *     closed_loop LIBRARY STEPS RECORD
 *
 * prints nanoseconds of processor time a macro step, and y and u at the last instant as hexadecimal
 * floats. At each instant and for each of LOOPS closed loops it gets y, computes u and sets it,
 * stores a row where RECORD is 1, and steps. Compiled with FMI=2 or FMI=3; LOOPS, REFERENCE, KP, KI
 * (per step) and STEP_NS come from the command line of cc. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
    int64_t time;
    double y[LOOPS], u[LOOPS];
} Row;

#if FMI == 2
typedef int (*Access)(void *, const unsigned *, size_t, double *);
typedef int (*Step)(void *, double, double, int);
#define NAME(name) "fmi2" name
#define GET "fmi2GetReal"
#define SET "fmi2SetReal"
#define ACCESS(function, reference, value) function(c[i], &reference, 1, &value)
#else
typedef int (*Access)(void *, const unsigned *, size_t, double *, size_t);
typedef int (*Step)(void *, double, double, bool, bool *, bool *, bool *, double *);
#define NAME(name) "fmi3" name
#define GET "fmi3GetFloat64"
#define SET "fmi3SetFloat64"
#define ACCESS(function, reference, value) function(c[i], &reference, 1, &value, 1)
#endif

static void *library;

static void *function(const char *name) {
    void *address = dlsym(library, name);
    if (!address) fprintf(stderr, "no function %s\n", name), exit(1);
    return address;
}

static void *initialised(void) {
    int (*exit_initialization)(void *) = function(NAME("ExitInitializationMode"));
#if FMI == 2
    void *(*instantiate)(const char *, int, const char *, const char *, const void *, int, int) =
        function("fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) = function("fmi2SetupExperiment");
    int (*enter)(void *) = function("fmi2EnterInitializationMode");
    void *c = instantiate("lag", 1, "", "", NULL, 0, 0);
    if (!c || setup(c, 0, 0.0, 0.0, 0, 0.0) || enter(c) || exit_initialization(c)) exit(1);
#else
    void *(*instantiate)(const char *, const char *, const char *, bool, bool, bool, bool,
                         const unsigned *, size_t, void *, void *, void *) =
        function("fmi3InstantiateCoSimulation");
    int (*enter)(void *, bool, double, double, bool, double) =
        function("fmi3EnterInitializationMode");
    void *c = instantiate("lag", "", NULL, 0, 0, 0, 0, NULL, 0, NULL, NULL, NULL);
    if (!c || enter(c, false, 0.0, 0.0, false, 0.0) || exit_initialization(c)) exit(1);
#endif
    return c;
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return 1e9 * t.tv_sec + t.tv_nsec;
}

int main(int count, char **arguments) {
    if (count != 4) return 2;
    library = dlopen(arguments[1], RTLD_NOW);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 1;
    const long steps = atol(arguments[2]);
    const bool record = atoi(arguments[3]);
    Access get = (Access)function(GET), set = (Access)function(SET);
    Step do_step = (Step)function(NAME("DoStep"));
    void *c[LOOPS];
    for (int i = 0; i < LOOPS; i++) c[i] = initialised();
    Row *rows = malloc(record ? (steps + 1) * sizeof(Row) : 1);
    if (record) memset(rows, 0, (steps + 1) * sizeof(Row)); /* touched, so that C is at its best */
    const unsigned reference_u = 0, reference_y = 1;
    double y[LOOPS] = {0}, u[LOOPS] = {0}, integral[LOOPS] = {0};

    const double began = now();
    for (long k = 0; k <= steps; k++) {
        const int64_t time = k * (int64_t)STEP_NS;
        for (int i = 0; i < LOOPS; i++) {
            if (ACCESS(get, reference_y, y[i]) > 1) return 1;
            const double error = REFERENCE - y[i];
            integral[i] += KI * error;
            u[i] = KP * error + integral[i];
            if (ACCESS(set, reference_u, u[i]) > 1) return 1;
            if (record) rows[k].y[i] = y[i], rows[k].u[i] = u[i];
        }
        if (record) rows[k].time = time;
        if (k == steps) break;
        for (int i = 0; i < LOOPS; i++) {
#if FMI == 2
            if (do_step(c[i], time / 1e9, STEP_NS / 1e9, 1) > 1) return 1;
#else
            bool event, terminate, early;
            double last, h = STEP_NS / 1e9;
            if (do_step(c[i], time / 1e9, h, true, &event, &terminate, &early, &last) > 1)
                return 1;
            if (terminate) return 1;
#endif
        }
    }
    printf("%.6f %a %a\n", (now() - began) / steps, y[LOOPS - 1], u[LOOPS - 1]);
    return 0;
}
