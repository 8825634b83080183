/* FMI 2, co-simulation and model exchange; optional functions are missing on purpose. */
#include "model.h"

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct { logger_t log; void *allocate, *release, *finished, *environment; } callbacks;
typedef struct { int update, terminate, nominals, values, defined; double next; } event_info;
typedef struct { plant p; const callbacks *f; int i, b, o; char s[64]; } model;

enum { X = 1, DX, H, V, DV, K, U, E_, COUNTER, COMPLETED, END, I_IN, I_OUT, B_IN, B_OUT, S_IN, S_OUT,
       O_IN, O_OUT };

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }
void *fmi2Instantiate(const char *name, int type, const char *guid, const char *where,
                      const callbacks *f, int visible, int logging) {
    if (strcmp(guid, "{2}")) {
        f->log(f->environment, name, 3, "error", "the guid %s is not mine", guid);
        return 0;
    }
    model *m = calloc(1, sizeof *m);
    plant_reset(&m->p);
    m->f = f, m->o = 1;
    return m;
}
void fmi2FreeInstance(void *m) { free(m); }
int fmi2SetupExperiment(void *m, int d, double tol, double start, int e, double stop) {
    plant_begin(&((model *)m)->p, start);
    return 0;
}
int fmi2EnterInitializationMode(void *m) { return 0; }
int fmi2ExitInitializationMode(void *m) { return 0; }
int fmi2Terminate(void *m) { return 0; }
int fmi2Reset(void *m) { plant_reset(&((model *)m)->p); return 0; }

static double *real(model *m, unsigned r) {
    plant *p = &m->p;
    static double d[2];
    switch (r) {
    case X: return &p->x;
    case DX: d[0] = rate_x(p); return d;
    case H: return &p->h;
    case V: return &p->v;
    case DV: d[1] = -G; return d + 1;
    case K: return &p->k;
    case U: return &p->u;
    case E_: return &p->e;
    case END: return &p->end_at;
    default: return 0;
    }
}
int fmi2GetReal(void *m, const unsigned *r, size_t n, double *y) {
    for (size_t i = 0; i < n; i++) if (real(m, r[i])) y[i] = *real(m, r[i]); else return 3;
    return 0;
}
int fmi2SetReal(void *m, const unsigned *r, size_t n, const double *y) {
    for (size_t i = 0; i < n; i++) if (real(m, r[i])) *real(m, r[i]) = y[i]; else return 3;
    return 0;
}
int fmi2GetInteger(void *c, const unsigned *r, size_t n, int *y) {
    model *m = c;
    for (size_t i = 0; i < n; i++)
        y[i] = r[i] == COUNTER ? m->p.counter : r[i] == COMPLETED ? m->p.completed
             : r[i] >= O_IN ? m->o : m->i;
    return 0;
}
int fmi2SetInteger(void *m, const unsigned *r, size_t n, const int *y) {
    for (size_t i = 0; i < n; i++) *(r[i] == O_IN ? &((model *)m)->o : &((model *)m)->i) = y[i];
    return 0;
}
int fmi2GetBoolean(void *m, const unsigned *r, size_t n, int *y) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->b;
    return 0;
}
int fmi2SetBoolean(void *m, const unsigned *r, size_t n, const int *y) {
    for (size_t i = 0; i < n; i++) ((model *)m)->b = y[i];
    return 0;
}
int fmi2GetString(void *m, const unsigned *r, size_t n, const char **y) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->s;
    return 0;
}
int fmi2SetString(void *m, const unsigned *r, size_t n, const char *const *y) {
    for (size_t i = 0; i < n; i++) strncpy(((model *)m)->s, y[i], 63);
    return 0;
}
int fmi2DoStep(void *c, double t, double h, int keep) {
    model *m = c;
    if (fabs(t - m->p.t) > 1e-9) {
        m->f->log(m->f->environment, "me", 3, "error", "asked for t = %g at t = %g", t, m->p.t);
        return 3;
    }
#ifdef CRASH
    if (t + h > 0.55) CRASH;
#endif
    advance(&m->p, fmin(t + h, m->p.end_at), false);
#ifdef SPOIL
    SPOIL;
#endif
    return m->p.t >= m->p.end_at - 1e-12 ? 2 : 0;
}
int fmi2GetBooleanStatus(void *m, int kind, int *y) {
    *y = ((model *)m)->p.t >= ((model *)m)->p.end_at - 1e-12;
    return 0;
}
int fmi2GetRealStatus(void *m, int kind, double *y) { *y = ((model *)m)->p.t; return 0; }

int fmi2EnterEventMode(void *m) { ((model *)m)->p.in_event_mode = true; return 0; }
int fmi2EnterContinuousTimeMode(void *m) { ((model *)m)->p.in_event_mode = false; return 0; }
int fmi2NewDiscreteStates(void *c, event_info *i) {
    plant *p = &((model *)c)->p;
    memset(i, 0, sizeof *i);
    i->values = handle(p, p->h <= 1e-9);
    i->terminate = p->t >= p->end_at - 1e-12;
    i->defined = 1, i->next = fmin(p->next, p->end_at);
#ifdef TELL
    TELL;
#endif
    return 0;
}
int fmi2CompletedIntegratorStep(void *c, int keep, int *event, int *terminate) {
    plant *p = &((model *)c)->p;
    p->completed++;
    *event = p->step_event, *terminate = 0;
#ifdef STEPPED
    STEPPED;
#endif
    return 0;
}
int fmi2SetTime(void *m, double t) { ((model *)m)->p.t = t; return 0; }
int fmi2SetContinuousStates(void *m, const double *x, size_t n) {
    plant *p = &((model *)m)->p;
    if (n != 3 || p->in_event_mode) return 3;
    p->x = x[0], p->h = x[1], p->v = x[2];
    return 0;
}
int fmi2GetContinuousStates(void *m, double *x, size_t n) {
    plant *p = &((model *)m)->p;
    x[0] = p->x, x[1] = p->h, x[2] = p->v;
    return 0;
}
int fmi2GetDerivatives(void *m, double *d, size_t n) {
    plant *p = &((model *)m)->p;
#ifdef CRASH_RATES
    static int calls;
    if (++calls > 50) CRASH_RATES;
#endif
    d[0] = rate_x(p), d[1] = p->v, d[2] = -G;
    return 0;
}
int fmi2GetEventIndicators(void *m, double *z, size_t n) { z[0] = ((model *)m)->p.h; return 0; }
int fmi2GetNominalsOfContinuousStates(void *m, double *x, size_t n) {
    x[0] = 1.0, x[1] = 0.1, x[2] = 10.0;
    return 0;
}
