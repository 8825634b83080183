/* The lag as an FMI 2.0 co-simulation FMU: what a closed loop calls, the rest is missing. */
#include "model.h"

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources;
    (void)callbacks, (void)visible, (void)logging;
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

EXPORT int fmi2GetReal(void *c, const unsigned *references, size_t n, double *values) {
    return lag_get(c, references, n, values);
}

EXPORT int fmi2SetReal(void *c, const unsigned *references, size_t n, const double *values) {
    return lag_set(c, references, n, values);
}

EXPORT int fmi2DoStep(void *c, double time, double step, int no_set_state) {
    (void)time, (void)no_set_state;
    lag_step(c, step);
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
MISSING(fmi2Reset)
MISSING(fmi2SerializeFMUstate)
MISSING(fmi2SerializedFMUstateSize)
MISSING(fmi2SetBoolean)
MISSING(fmi2SetDebugLogging)
MISSING(fmi2SetFMUstate)
MISSING(fmi2SetInteger)
MISSING(fmi2SetRealInputDerivatives)
MISSING(fmi2SetString)
