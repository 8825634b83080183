/* An undamped oscillator, FMI 2.0 model exchange, that breaks one promise of its model description:

   -DSLOPE        directional derivatives of the rates are wrong by a tenth
   -DRATES        the rates depend on how often they were asked for
   -DROUND_TRIP   states are rounded to single precision when they are set
   -DSNAPSHOT     a snapshot lacks the velocity
   -DBYTES        a serialised state lacks the velocity
   -DPROCESS      a serialised state is an address, which no other process knows
   -DINDICATOR    the event indicator is no number while the position is below 0.9
   -DNOMINAL      the nominal value of the velocity is 0
   -DFEEDTHROUGH  the output depends on the input at once
   -DLEAK         an instance leaves 64 KiB behind */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR };
enum { U, Y, X, V, DX, DV };

typedef struct {
    double time, u, x, v;
} Spring;

typedef struct {
    int needs, terminate, nominals, values, defined;
    double next;
} EventInfo;

static const Spring fresh = {0, 0, 1, 0};

static double value(const Spring *s, unsigned which) {
    switch (which) {
    case U: return s->u;
#ifdef FEEDTHROUGH
    case Y: return s->x + 0.5 * s->u;
#else
    case Y: return s->x;
#endif
    case X: return s->x;
    case V: return s->v;
    case DX: return s->v;
#ifdef RATES
    case DV: {
        static double evaluations;
        return s->u - s->x * s->x * s->x + 1e-9 * evaluations++;
    }
#else
    case DV: return s->u - s->x * s->x * s->x;
#endif
    }
    return NAN;
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
    Spring *s = malloc(sizeof *s);
    *s = fresh;
#ifdef LEAK
    volatile char *room = malloc(65536);
    for (int i = 0; i < 65536; i += 512) room[i] = 1;
#endif
    return s;
}
EXPORT int fmi2SetupExperiment(void *c, int a, double b, double t, int d, double e) {
    (void)c, (void)a, (void)b, (void)t, (void)d, (void)e;
    return OK;
}
EXPORT int fmi2EnterInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2ExitInitializationMode(void *c) { return (void)c, OK; }
EXPORT int fmi2EnterEventMode(void *c) { return (void)c, OK; }
EXPORT int fmi2EnterContinuousTimeMode(void *c) { return (void)c, OK; }
EXPORT int fmi2NewDiscreteStates(void *c, EventInfo *info) {
    (void)c;
    memset(info, 0, sizeof *info);
    return OK;
}
EXPORT int fmi2CompletedIntegratorStep(void *c, int no_set_state, int *event, int *terminate) {
    (void)c, (void)no_set_state;
    *event = *terminate = 0;
    return OK;
}
EXPORT int fmi2Terminate(void *c) { return (void)c, OK; }
EXPORT int fmi2Reset(void *c) {
    *(Spring *)c = fresh;
    return OK;
}
EXPORT void fmi2FreeInstance(void *c) { free(c); }
EXPORT int fmi2GetReal(void *c, const unsigned *vr, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) values[i] = value(c, vr[i]);
    return OK;
}
EXPORT int fmi2SetReal(void *c, const unsigned *vr, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++)
        if (vr[i] == U) ((Spring *)c)->u = values[i];
    return OK;
}
EXPORT int fmi2SetTime(void *c, double time) {
    ((Spring *)c)->time = time;
    return OK;
}
EXPORT int fmi2SetContinuousStates(void *c, const double *x, size_t n) {
    Spring *s = c;
    (void)n;
#ifdef ROUND_TRIP
    s->x = (float)x[0], s->v = (float)x[1];
#else
    s->x = x[0], s->v = x[1];
#endif
    return OK;
}
EXPORT int fmi2GetContinuousStates(void *c, double *x, size_t n) {
    (void)n;
    x[0] = ((Spring *)c)->x, x[1] = ((Spring *)c)->v;
    return OK;
}
EXPORT int fmi2GetDerivatives(void *c, double *rates, size_t n) {
    (void)n;
    rates[0] = value(c, DX), rates[1] = value(c, DV);
    return OK;
}
EXPORT int fmi2GetEventIndicators(void *c, double *z, size_t n) {
    (void)n;
    z[0] = 2 + ((Spring *)c)->x;
#ifdef INDICATOR
    if (((Spring *)c)->x < 0.9) z[0] = NAN;
#endif
    return OK;
}
EXPORT int fmi2GetNominalsOfContinuousStates(void *c, double *nominal, size_t n) {
    (void)c, (void)n;
    nominal[0] = nominal[1] = 1;
#ifdef NOMINAL
    nominal[1] = 0;
#endif
    return OK;
}
EXPORT int fmi2GetFMUstate(void *c, void **state) {
    if (!*state) *state = malloc(sizeof(Spring));
    *(Spring *)*state = *(Spring *)c;
    return OK;
}
EXPORT int fmi2SetFMUstate(void *c, void *state) {
    Spring *s = c, saved = *(Spring *)state;
#ifdef SNAPSHOT
    saved.v = s->v;
#endif
    *s = saved;
    return OK;
}
EXPORT int fmi2FreeFMUstate(void *c, void **state) {
    (void)c;
    free(*state);
    *state = NULL;
    return OK;
}
EXPORT int fmi2SerializedFMUstateSize(void *c, void *state, size_t *size) {
    (void)c, (void)state;
    *size = sizeof(Spring);
    return OK;
}
#ifdef PROCESS
static Spring kept; /* lives in this process only */
#endif
EXPORT int fmi2SerializeFMUstate(void *c, void *state, unsigned char *bytes, size_t size) {
    (void)c, (void)size;
    memcpy(bytes, state, sizeof(Spring));
#ifdef BYTES
    memset(bytes + offsetof(Spring, v), 0, sizeof(double));
#endif
#ifdef PROCESS
    kept = *(Spring *)state;
    memset(bytes, 0, sizeof(Spring));
#endif
    return OK;
}
EXPORT int fmi2DeSerializeFMUstate(void *c, const unsigned char *bytes, size_t size,
                                   void **state) {
    (void)c, (void)size;
    if (!*state) *state = malloc(sizeof(Spring));
#ifdef PROCESS
    memcpy(*state, &kept, sizeof(Spring));
    (void)bytes;
#else
    memcpy(*state, bytes, sizeof(Spring));
#endif
    return OK;
}
EXPORT int fmi2GetDirectionalDerivative(void *c, const unsigned *unknown, size_t n,
                                        const unsigned *known, size_t m, const double *seed,
                                        double *result) {
    const Spring *s = c;
    (void)m;
    for (size_t i = 0; i < n; i++) {
        double slope = 0;
        if (unknown[i] == Y && known[0] == X) slope = 1;
        if (unknown[i] == DX && known[0] == V) slope = 1;
        if (unknown[i] == DV && known[0] == U) slope = 1;
        if (unknown[i] == DV && known[0] == X) slope = -3 * s->x * s->x;
#ifdef FEEDTHROUGH
        if (unknown[i] == Y && known[0] == U) slope = 0.5;
#endif
#ifdef SLOPE
        if (unknown[i] == DV) slope *= 1.1;
#endif
        result[i] = slope * seed[0];
    }
    return OK;
}
