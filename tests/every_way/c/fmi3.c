/* FMI 3, co-simulation, model exchange and scheduled execution in one library. */
#include "every.h"
#include MODEL

typedef void (*clock_update)(void *);
typedef struct { model m; void *environment; clock_update update; } instance;

static void *make(const char *token, void *environment) {
    if (strcmp(token, GUID)) return 0;
    instance *made = calloc(1, sizeof *made);
    made->environment = environment;
    start(&made->m);
    evaluate(&made->m);
    return made;
}
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path,
                                  bool visible, bool logging, bool event_mode, bool early,
                                  const unsigned *r, size_t n, void *environment, void *log,
                                  void *intermediate) {
    model *m = make(token, environment);
    if (m) m->stepping = true, m->event_mode = event_mode, m->may_return = early;
    return m;
}
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *path,
                                   bool visible, bool logging, void *environment, void *log) {
    return make(token, environment);
}
void *fmi3InstantiateScheduledExecution(const char *name, const char *token, const char *path,
                                        bool visible, bool logging, void *environment, void *log,
                                        clock_update update, void *lock, void *unlock) {
    instance *made = make(token, environment);
    if (made) made->update = update;
    return made;
}
void fmi3FreeInstance(void *m) { free(m); }
int fmi3EnterConfigurationMode(model *m) { m->configuring = true; return OK; }
int fmi3ExitConfigurationMode(model *m) { m->configuring = false; return OK; }
int fmi3EnterInitializationMode(model *m, bool d, double tolerance, double begin, bool e,
                                double stop) {
    initialise(m, begin, d ? tolerance : 0.0);
    return OK;
}
int fmi3ExitInitializationMode(model *m) {
    m->handling = !m->stepping || m->event_mode;
    if (!m->handling) settle(m);
    return OK;
}
int fmi3Terminate(model *m) { return OK; }
int fmi3Reset(model *m) {
    model old = *m;
    memset(m, 0, sizeof *m);
    m->stepping = old.stepping, m->event_mode = old.event_mode, m->may_return = old.may_return;
    start(m);
    return OK;
}
#define ACCESS(name, ctype, field, value)                                                          \
    int fmi3Get##name(model *m, const unsigned *r, size_t n, ctype *y, size_t total) {             \
        evaluate(m);                                                                               \
        EACH(if (k < total) y[k] = (ctype)(value))                                                 \
        return k == total ? OK : ERROR;                                                            \
    }                                                                                              \
    int fmi3Set##name(model *m, const unsigned *r, size_t n, const ctype *y, size_t total) {       \
        for (size_t i = 0; i < n; i++)                                                             \
            if (r[i] && r[i] == m->structural && !m->configuring) return ERROR;                    \
        EACH(if (k < total) c->field = y[k])                                                       \
        evaluate(m);                                                                               \
        return k == total ? OK : ERROR;                                                            \
    }
ACCESS(Float64, double, d, c->d)
ACCESS(Float32, float, d, c->d)
ACCESS(Int8, int8_t, i, c->i)
ACCESS(UInt8, uint8_t, i, c->i)
ACCESS(Int16, int16_t, i, c->i)
ACCESS(UInt16, uint16_t, i, c->i)
ACCESS(Int32, int32_t, i, c->i)
ACCESS(UInt32, uint32_t, i, c->i)
ACCESS(Int64, int64_t, i, c->i)
ACCESS(UInt64, uint64_t, i, c->i)
ACCESS(Boolean, bool, i, c->i & 1)
int fmi3GetString(model *m, const unsigned *r, size_t n, const char **y, size_t total) {
    evaluate(m);
    EACH(if (k < total) y[k] = c->text)
    return k == total ? OK : ERROR;
}
int fmi3SetString(model *m, const unsigned *r, size_t n, const char *const *y, size_t total) {
    EACH(if (k < total) strncpy(c->text, y[k], TEXT - 1))
    return k == total ? OK : ERROR;
}
int fmi3GetBinary(model *m, const unsigned *r, size_t n, size_t *sizes, const uint8_t **y,
                  size_t total) {
    evaluate(m);
    EACH(if (k < total) y[k] = (uint8_t *)c->text, sizes[k] = c->length)
    return k == total ? OK : ERROR;
}
int fmi3SetBinary(model *m, const unsigned *r, size_t n, const size_t *sizes,
                  const uint8_t *const *y, size_t total) {
    EACH(if (k < total && sizes[k] <= TEXT) memcpy(c->text, y[k], c->length = sizes[k]))
    return k == total ? OK : ERROR;
}
int fmi3DoStep(model *m, double t, double h, bool keep, bool *wanted, bool *terminate, bool *early,
               double *last) {
    if (m->handling) return ERROR;
    m->t = t;
    *wanted = advance(m, t + h, m->event_mode);
    *terminate = false, *early = m->t < t + h, *last = m->t;
    return *early && !m->may_return ? ERROR : OK;
}
int fmi3GetFMUState(model *m, void **state) {
    if (!*state) *state = malloc(sizeof *m);
    memcpy(*state, m, sizeof *m);
    return OK;
}
int fmi3SetFMUState(model *m, void *state) { memcpy(m, state, sizeof *m); return OK; }
int fmi3FreeFMUState(model *m, void **state) { free(*state); *state = 0; return OK; }
int fmi3EnterEventMode(model *m) { m->handling = true; return OK; }
int fmi3EnterStepMode(model *m) { m->handling = false; return OK; }
int fmi3EnterContinuousTimeMode(model *m) { m->handling = false; return OK; }
int fmi3UpdateDiscreteStates(model *m, bool *needs, bool *terminate, bool *nominals, bool *values,
                             bool *defined, double *next) {
    if (!m->handling) return ERROR;
    iterate(m);
    *needs = m->needs_update, *terminate = false, *nominals = m->nominals_changed;
    *values = m->values_changed, *defined = m->next < NEVER, *next = m->next;
    return OK;
}
int fmi3SetClock(model *m, const unsigned *r, size_t n, const bool *y) {
    if (!m->handling) return ERROR;
    for (size_t i = 0; i < n; i++) if (y[i]) set_clock(m, r[i]);
    return OK;
}
int fmi3GetClock(model *m, const unsigned *r, size_t n, bool *y) {
    if (!m->handling) return ERROR;
    for (size_t i = 0; i < n; i++) y[i] = get_clock(m, r[i]);
    return OK;
}
int fmi3GetIntervalDecimal(model *m, const unsigned *r, size_t n, double *y, int *qualifier) {
    for (size_t i = 0; i < n; i++) qualifier[i] = interval(m, r[i], y + i) ? 2 : 1;
    return OK;
}
int fmi3ActivateModelPartition(instance *made, unsigned r, double t) {
    made->m.t = t;
    set_clock(&made->m, r);
    evaluate(&made->m);
    if (made->m.asked) made->m.asked = false, made->update(made->environment);
    return OK;
}
int fmi3CompletedIntegratorStep(model *m, bool keep, bool *wanted, bool *terminate) {
    *wanted = m->asked = wants_event(m);
    *terminate = false;
    return OK;
}
int fmi3SetTime(model *m, double t) { m->t = t; return OK; }
int fmi3SetContinuousStates(model *m, const double *x, size_t n) {
    if (m->handling) return ERROR;
    for (size_t i = 0; i < n; i++) D(STATES[i]) = x[i];
    return OK;
}
int fmi3GetContinuousStates(model *m, double *x, size_t n) {
    for (size_t i = 0; i < n; i++) x[i] = D(STATES[i]);
    return OK;
}
int fmi3GetContinuousStateDerivatives(model *m, double *x, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) x[i] = D(RATES[i]);
    return OK;
}
int fmi3GetEventIndicators(model *m, double *z, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) z[i] = D(INDICATORS[i]);
    return OK;
}
int fmi3GetNominalsOfContinuousStates(model *m, double *x, size_t n) {
    memcpy(x, m->nominals, n * sizeof *x);
    return OK;
}
