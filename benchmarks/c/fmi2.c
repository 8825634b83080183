/* The lag as an FMI 2.0 co-simulation FMU: what a closed loop calls, the rest is missing. */
#include "model.h"

#ifdef TALKATIVE /* says a line a step, whether or not it was asked to */
typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *allocate, *release, *finished, *environment;
} Callbacks;
static const Callbacks *listener;
#define LISTEN(callbacks) (listener = (callbacks))
#define SAY(step) \
    listener->logger(listener->environment, "lag", OK, "logAll", "a step of %g s", step)
#else
#define LISTEN(callbacks) (void)(callbacks)
#define SAY(step) (void)(step)
#endif

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources;
    (void)visible, (void)logging;
    LISTEN(callbacks);
    return lag_new();
}

EXPORT void fmi2FreeInstance(void *c) { free(c); }

EXPORT int fmi2SetupExperiment(void *c, int tolerance_defined, double tolerance, double start,
                               int stop_defined, double stop) {
    (void)c, (void)tolerance_defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2ExitInitializationMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2Terminate(void *c) { return c ? OK : ERROR; }

EXPORT int fmi2Reset(void *c) {
    *(Lag *)c = (Lag){.k = 1.0};
    return OK;
}

EXPORT int fmi2GetReal(void *c, const unsigned *references, size_t n, double *values) {
    return lag_get(c, references, n, values);
}

EXPORT int fmi2SetReal(void *c, const unsigned *references, size_t n, const double *values) {
    return lag_set(c, references, n, values);
}

EXPORT int fmi2DoStep(void *c, double time, double step, int no_set_state) {
    (void)time, (void)no_set_state;
    lag_step(c, step);
    SAY(step);
    return OK;
}

MISSING(fmi2CancelStep)
MISSING(fmi2DeSerializeFMUstate)
MISSING(fmi2FreeFMUstate)
MISSING(fmi2GetBoolean)
MISSING(fmi2GetBooleanStatus)
MISSING(fmi2GetDirectionalDerivative)
MISSING(fmi2GetFMUstate)
MISSING(fmi2GetInteger)
MISSING(fmi2GetIntegerStatus)
MISSING(fmi2GetRealOutputDerivatives)
MISSING(fmi2GetRealStatus)
MISSING(fmi2GetStatus)
MISSING(fmi2GetString)
MISSING(fmi2GetStringStatus)
MISSING(fmi2SerializeFMUstate)
MISSING(fmi2SerializedFMUstateSize)
MISSING(fmi2SetBoolean)
MISSING(fmi2SetDebugLogging)
MISSING(fmi2SetFMUstate)
MISSING(fmi2SetInteger)
MISSING(fmi2SetRealInputDerivatives)
MISSING(fmi2SetString)
