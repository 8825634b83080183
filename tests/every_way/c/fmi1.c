/* FMI 1, a slave for co-simulation (-DSLAVE) or a model. */
#include "every.h"
#include MODEL
#define JOIN(a, b) a##_##b
#define NAMED(id, name) JOIN(id, name)
#define F(name) NAMED(IDENTIFIER, name)

typedef struct {
    void *log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
#ifdef SLAVE
    void *finished;
#endif
} callbacks;
typedef struct {
    char converged, references_changed, values_changed, terminate, upcoming;
    double next;
} event_info;

static void *make(const char *guid, bool stepping) {
    if (strcmp(guid, GUID)) return 0;
    model *m = calloc(1, sizeof *m);
    m->stepping = stepping;
    start(m);
    evaluate(m);
    return m;
}
#define ACCESS(name, ctype, field, value)                                                          \
    int F(fmiGet##name)(model *m, const unsigned *r, size_t n, ctype *y) {                         \
        evaluate(m);                                                                               \
        EACH(y[k] = (ctype)(value))                                                                \
        return OK;                                                                                 \
    }                                                                                              \
    int F(fmiSet##name)(model *m, const unsigned *r, size_t n, const ctype *y) {                   \
        EACH(c->field = y[k])                                                                      \
        return OK;                                                                                 \
    }
ACCESS(Real, double, d, c->d)
ACCESS(Integer, int, i, c->i)
ACCESS(Boolean, char, i, c->i & 1)
int F(fmiGetString)(model *m, const unsigned *r, size_t n, const char **y) {
    evaluate(m);
    EACH(y[k] = c->text)
    return OK;
}
int F(fmiSetString)(model *m, const unsigned *r, size_t n, const char *const *y) {
    EACH(strncpy(c->text, y[k], TEXT - 1))
    return OK;
}
#ifdef SLAVE
void *F(fmiInstantiateSlave)(const char *name, const char *guid, const char *where,
                             const char *mime, double timeout, char visible, char interactive,
                             callbacks f, char log) {
    return make(guid, true);
}
void F(fmiFreeSlaveInstance)(void *m) { free(m); }
int F(fmiInitializeSlave)(model *m, double begin, char defined, double stop) {
    initialise(m, begin, 0.0);
    settle(m);
    return OK;
}
int F(fmiTerminateSlave)(model *m) { return OK; }
int F(fmiResetSlave)(model *m) {
    memset(m, 0, sizeof *m);
    m->stepping = true;
    start(m);
    return OK;
}
int F(fmiDoStep)(model *m, double t, double h, char fresh) {
    m->t = t;
    advance(m, t + h, false);
    return OK;
}
#else
void *F(fmiInstantiateModel)(const char *name, const char *guid, callbacks f, char log) {
    return make(guid, false);
}
void F(fmiFreeModelInstance)(void *m) { free(m); }
static void tell(model *m, event_info *info) {
    info->converged = !m->needs_update;
    info->references_changed = info->terminate = 0;
    info->values_changed = m->values_changed || m->nominals_changed;
    info->upcoming = m->next < NEVER;
    info->next = m->next;
}
int F(fmiEventUpdate)(model *m, char intermediate, event_info *info) {
    bool values = false, nominals = false;
    do {
        iterate(m);
        values |= m->values_changed, nominals |= m->nominals_changed;
    } while (m->needs_update && !intermediate);
    m->values_changed = values, m->nominals_changed = nominals;
    tell(m, info);
    return OK;
}
int F(fmiInitialize)(model *m, char controlled, double tolerance, event_info *info) {
    initialise(m, m->t, controlled ? tolerance : 0.0);
    return F(fmiEventUpdate)(m, 0, info);
}
int F(fmiTerminate)(model *m) { return OK; }
int F(fmiCompletedIntegratorStep)(model *m, char *wanted) {
    *wanted = m->asked = wants_event(m);
    return OK;
}
int F(fmiSetTime)(model *m, double t) { m->t = t; return OK; }
int F(fmiSetContinuousStates)(model *m, const double *x, size_t n) {
    for (size_t i = 0; i < n; i++) D(STATES[i]) = x[i];
    return OK;
}
int F(fmiGetContinuousStates)(model *m, double *x, size_t n) {
    for (size_t i = 0; i < n; i++) x[i] = D(STATES[i]);
    return OK;
}
int F(fmiGetDerivatives)(model *m, double *x, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) x[i] = D(RATES[i]);
    return OK;
}
int F(fmiGetEventIndicators)(model *m, double *z, size_t n) {
    evaluate(m);
    for (size_t i = 0; i < n; i++) z[i] = D(INDICATORS[i]);
    return OK;
}
int F(fmiGetNominalContinuousStates)(model *m, double *x, size_t n) {
    memcpy(x, m->nominals, n * sizeof *x);
    return OK;
}
int F(fmiGetStateValueReferences)(model *m, unsigned *r, size_t n) {
    memcpy(r, STATES, n * sizeof *r);
    return OK;
}
#endif
