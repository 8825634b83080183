/* A damped resonator as an FMI 2.0 model exchange FMU that costs next to nothing, and gives no
 * Jacobian: what a closed loop calls, the rest is missing.
 *
 *     dx/dt = v,   dv/dt = 100 (u - x) - 4 v,   y = x
 */
#include "model.h"

enum { VR_DX = 2, VR_V = 3, VR_DV = 4 };
typedef struct {
    double u, x, v;
} Resonator;
typedef struct {
    int again, end, nominals, values, known;
    double next;
} EventInfo;

EXPORT const char *fmi2GetVersion(void) { return "2.0"; }
EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }

EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const void *callbacks, int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources;
    (void)callbacks, (void)visible, (void)logging;
    return calloc(1, sizeof(Resonator));
}

EXPORT void fmi2FreeInstance(void *c) { free(c); }

EXPORT int fmi2SetupExperiment(void *c, int tolerance_defined, double tolerance, double start,
                               int stop_defined, double stop) {
    (void)c, (void)tolerance_defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return OK;
}

EXPORT int fmi2EnterInitializationMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2ExitInitializationMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2EnterEventMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2EnterContinuousTimeMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi2Terminate(void *c) { return c ? OK : ERROR; }

EXPORT int fmi2NewDiscreteStates(void *c, EventInfo *info) {
    *info = (EventInfo){0};
    return c ? OK : ERROR;
}

EXPORT int fmi2CompletedIntegratorStep(void *c, int no_set_state, int *event, int *end) {
    (void)no_set_state;
    *event = *end = 0;
    return c ? OK : ERROR;
}

EXPORT int fmi2SetTime(void *c, double time) {
    (void)time;
    return c ? OK : ERROR;
}

EXPORT int fmi2SetContinuousStates(void *c, const double *x, size_t n) {
    Resonator *r = c;
    if (n != 2) return ERROR;
    r->x = x[0], r->v = x[1];
    return OK;
}

EXPORT int fmi2GetContinuousStates(void *c, double *x, size_t n) {
    const Resonator *r = c;
    if (n != 2) return ERROR;
    x[0] = r->x, x[1] = r->v;
    return OK;
}

static double acceleration(const Resonator *r) { return 100.0 * (r->u - r->x) - 4.0 * r->v; }

EXPORT int fmi2GetDerivatives(void *c, double *dx, size_t n) {
    const Resonator *r = c;
    if (n != 2) return ERROR;
    dx[0] = r->v, dx[1] = acceleration(r);
    return OK;
}

EXPORT int fmi2GetNominalsOfContinuousStates(void *c, double *nominals, size_t n) {
    for (size_t i = 0; i < n; i++) nominals[i] = 1.0;
    return c ? OK : ERROR;
}

EXPORT int fmi2GetReal(void *c, const unsigned *references, size_t n, double *values) {
    const Resonator *r = c;
    for (size_t i = 0; i < n; i++) switch (references[i]) {
            case VR_U: values[i] = r->u; break;
            case VR_Y: values[i] = r->x; break;
            case VR_DX:
            case VR_V: values[i] = r->v; break;
            case VR_DV: values[i] = acceleration(r); break;
            default: return ERROR;
        }
    return OK;
}

EXPORT int fmi2SetReal(void *c, const unsigned *references, size_t n, const double *values) {
    Resonator *r = c;
    for (size_t i = 0; i < n; i++) switch (references[i]) {
            case VR_U: r->u = values[i]; break;
            case VR_Y: r->x = values[i]; break;
            case VR_V: r->v = values[i]; break;
            default: return ERROR;
        }
    return OK;
}

MISSING(fmi2DeSerializeFMUstate)
MISSING(fmi2FreeFMUstate)
MISSING(fmi2GetBoolean)
MISSING(fmi2GetDirectionalDerivative)
MISSING(fmi2GetEventIndicators)
MISSING(fmi2GetFMUstate)
MISSING(fmi2GetInteger)
MISSING(fmi2GetString)
MISSING(fmi2Reset)
MISSING(fmi2SerializeFMUstate)
MISSING(fmi2SerializedFMUstateSize)
MISSING(fmi2SetBoolean)
MISSING(fmi2SetDebugLogging)
MISSING(fmi2SetFMUstate)
MISSING(fmi2SetInteger)
MISSING(fmi2SetString)
