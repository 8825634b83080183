/* A first-order lag, FMI 2.0 co-simulation, that breaks one promise of its model description:

   -DSHARED        instances share their state
   -DDRIFTS        a run depends on those before it
   -DPROCESS       a run depends on the process
   -DRESET         reset leaves the state as it is
   -DSNAPSHOT      a snapshot lacks half of the state
   -DFEEDTHROUGH   the output depends on the input at once
   -DSLOPE         directional derivatives are wrong by a tenth
   -DSTEPS         only steps of 0.1 s are taken
   -DBLOWS_UP      the output is no number after half a second
   -DLEAK          an instance leaves 64 KiB behind
   -DFORGETS       fmi2SetupExperiment undoes what was set before (which is no lie)
   -DDESCRIPTORS   an instance leaves a file open */
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };

typedef struct {
    double x, filtered, u;
} Lag;

#ifdef SHARED
static Lag shared;
#define LAG(c) ((void)(c), &shared)
#else
#define LAG(c) ((Lag *)(c))
#endif
#ifdef DRIFTS
static double runs;
#endif

static double output(const Lag *lag) {
#ifdef FEEDTHROUGH
    return lag->filtered + 0.5 * lag->u;
#else
    return lag->filtered;
#endif
}

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT int fmi2SetDebugLogging(void *c, int on, size_t n, const char *const *names) {
    (void)c, (void)on, (void)n, (void)names;
    return OK;
}
EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible;
    (void)logging;
    Lag *lag = calloc(1, sizeof *lag);
#ifdef DRIFTS
    lag->x = 1e-9 * runs++;
#endif
#ifdef PROCESS
    lag->x = 1e-9 * getpid();
#endif
#ifdef LEAK
    volatile char *room = malloc(65536);
    for (int i = 0; i < 65536; i += 512) room[i] = 1;
#endif
#ifdef DESCRIPTORS
    if (open("/dev/null", O_RDONLY) < 0) return NULL;
#endif
    return lag;
}
EXPORT int fmi2SetupExperiment(void *c, int a, double b, double t, int d, double e) {
    (void)c, (void)a, (void)b, (void)t, (void)d, (void)e;
#ifdef FORGETS
    *LAG(c) = (Lag){0, 0, 0};
#endif
    return OK;
}
EXPORT int fmi2EnterInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2ExitInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2Terminate(void *c) { return (void)c, OK; }
EXPORT int fmi2Reset(void *c) {
#ifndef RESET
    *LAG(c) = (Lag){0, 0, 0};
#endif
    return (void)c, OK;
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT int fmi2GetReal(void *c, const unsigned *vr, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) values[i] = vr[i] == 0 ? LAG(c)->u : output(LAG(c));
    return OK;
}
EXPORT int fmi2SetReal(void *c, const unsigned *vr, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++)
        if (vr[i] == 0) LAG(c)->u = values[i];
    return OK;
}
EXPORT int fmi2DoStep(void *c, double t, double h, int no_set_state) {
    Lag *lag = LAG(c);
    (void)t, (void)no_set_state;
#ifdef BLOWS_UP
    if (t > 0.5) lag->filtered = NAN;
#endif
#ifdef STEPS
    if (fabs(h - 0.1) > 1e-9) return ERROR;
#endif
    lag->x += (lag->u - lag->x) * (1 - exp(-h / 0.3));
    lag->filtered += (lag->x - lag->filtered) * (1 - exp(-h / 0.2));
    return OK;
}
EXPORT int fmi2GetFMUstate(void *c, void **state) {
    if (!*state) *state = malloc(sizeof(Lag));
    *(Lag *)*state = *LAG(c);
    return OK;
}
EXPORT int fmi2SetFMUstate(void *c, void *state) {
    Lag *lag = LAG(c);
#ifdef SNAPSHOT
    lag->filtered = ((Lag *)state)->filtered;
#else
    *lag = *(Lag *)state;
#endif
    return OK;
}
EXPORT int fmi2FreeFMUstate(void *c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
EXPORT int fmi2GetDirectionalDerivative(void *c, const unsigned *unknown, size_t n,
                                        const unsigned *known, size_t m, const double *seed,
                                        double *result) {
    double slope = 0;
    (void)c, (void)unknown, (void)known, (void)m;
#ifdef FEEDTHROUGH
    slope = 0.5;
#endif
#ifdef SLOPE
    slope += 0.1;
#endif
    for (size_t i = 0; i < n; i++) result[i] = slope * seed[0];
    return OK;
}
