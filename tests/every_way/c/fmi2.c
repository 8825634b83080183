/* FMI 2, co-simulation and model exchange in one library. */
#include "every.h"
#include MODEL

typedef struct {
    int needs_update, terminate, nominals_changed, values_changed, defined;
    double next;
} event_info;

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where,
                      const void *callbacks, int visible, int logging) {
    if (strcmp(guid, GUID)) return 0;
    model *m = calloc(1, sizeof *m);
    m->stepping = type == 1;
    start(m);
    evaluate(m);
    return m;
}
void fmi2FreeInstance(void *m) { free(m); }
int fmi2SetupExperiment(model *m, int d, double tolerance, double begin, int e, double stop) {
    initialise(m, begin, d ? tolerance : 0.0);
    return OK;
}
int fmi2EnterInitializationMode(model *m) { return OK; }
int fmi2ExitInitializationMode(model *m) {
    if (m->stepping) settle(m);
    else m->handling = true;
    return OK;
}
int fmi2Terminate(model *m) { return OK; }
int fmi2Reset(model *m) {
    bool stepping = m->stepping;
    memset(m, 0, sizeof *m);
    m->stepping = stepping;
    start(m);
    return OK;
}
#define ACCESS(name, ctype, field, value)                                                          \
    int fmi2Get##name(model *m, const unsigned *r, size_t n, ctype *y) {                           \
        evaluate(m);                                                                               \
        EACH(y[k] = (ctype)(value))                                                                \
        return OK;                                                                                 \
    }                                                                                              \
    int fmi2Set##name(model *m, const unsigned *r, size_t n, const ctype *y) {                     \
        EACH(c->field = y[k])                                                                      \
        return OK;                                                                                 \
    }
ACCESS(Real, double, d, c->d)
ACCESS(Integer, int, i, c->i)
ACCESS(Boolean, int, i, c->i & 1)
int fmi2GetString(model *m, const unsigned *r, size_t n, const char **y) {
    evaluate(m);
    EACH(y[k] = c->text)
    return OK;
}
int fmi2SetString(model *m, const unsigned *r, size_t n, const char *const *y) {
    EACH(strncpy(c->text, y[k], TEXT - 1))
    return OK;
}
int fmi2DoStep(model *m, double t, double h, int keep) {
    m->t = t;
    advance(m, t + h, false);
    return OK;
}
int fmi2GetFMUstate(model *m, void **state) {
    if (!*state) *state = malloc(sizeof *m);
    memcpy(*state, m, sizeof *m);
    return OK;
}
int fmi2SetFMUstate(model *m, void *state) { memcpy(m, state, sizeof *m); return OK; }
int fmi2FreeFMUstate(model *m, void **state) { free(*state); *state = 0; return OK; }
int fmi2EnterEventMode(model *m) { m->handling = true; return OK; }
int fmi2EnterContinuousTimeMode(model *m) { m->handling = false; return OK; }
int fmi2NewDiscreteStates(model *m, event_info *info) {
    if (!m->handling) return ERROR;
    iterate(m);
    *info = (event_info){m->needs_update, 0, m->nominals_changed, m->values_changed,
                         m->next < NEVER, m->next};
    return OK;
}
int fmi2CompletedIntegratorStep(model *m, int keep, int *wanted, int *terminate) {
    *wanted = m->asked = wants_event(m);
    *terminate = 0;
    return OK;
}
int fmi2SetTime(model *m, double t) { m->t = t; return OK; }
int fmi2SetContinuousStates(model *m, const double *x, size_t n) {
    if (m->handling) return ERROR;
    for (size_t i = 0; i < n; i++) D(STATES[i]) = x[i];
    return OK;
}
int fmi2GetContinuousStates(model *m, double *x, size_t n) {
    for (size_t i = 0; i < n; i++) x[i] = D(STATES[i]);
    return OK;
}
int fmi2GetDerivatives(model *m, double *x, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) x[i] = D(RATES[i]);
    return OK;
}
int fmi2GetEventIndicators(model *m, double *z, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) z[i] = D(INDICATORS[i]);
    return OK;
}
int fmi2GetNominalsOfContinuousStates(model *m, double *x, size_t n) {
    memcpy(x, m->nominals, n * sizeof *x);
    return OK;
}
