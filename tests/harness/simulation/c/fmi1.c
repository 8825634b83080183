/* FMI 1, slave or model (-DSLAVE); its status codes are returned as they should be. */
#include "model.h"
#define F(name) test_fmi##name

typedef void (*logger_t)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    logger_t log;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
#ifdef SLAVE
    void *finished;
#endif
} callbacks;
typedef struct { char converged, references, values, terminate, upcoming; double next; } event_info;
typedef struct { plant p; callbacks f; char name[64]; int i; char b; char s[64]; } model;

enum { X = 1, DX, H, V, DV, K, U, E_, COUNTER, COMPLETED, END, I_IN, B_IN, S_IN };

static void *make(const char *name, const char *guid, callbacks f) {
    if (strcmp(guid, "{1}")) {
        f.log(0, name, 3, "error", "the guid %s is not mine", guid);
        return 0;
    }
    model *m = f.allocate(1, sizeof *m);
    plant_reset(&m->p);
    m->f = f;
    strncpy(m->name, name, 63);
    return m;
}
static void drop(void *m) { ((model *)m)->f.release(m); }

static double *real(model *m, unsigned r) {
    static double d[2];
    switch (r) {
    case X: return &m->p.x;
    case DX: d[0] = rate_x(&m->p); return d;
    case H: return &m->p.h;
    case V: return &m->p.v;
    case DV: d[1] = -G; return d + 1;
    case K: return &m->p.k;
    case U: return &m->p.u;
    case E_: return &m->p.e;
    case END: return &m->p.end_at;
    default: return 0;
    }
}
int F(GetReal)(void *m, const unsigned *r, size_t n, double *y) {
    for (size_t i = 0; i < n; i++) if (real(m, r[i])) y[i] = *real(m, r[i]); else return 3;
    return 0;
}
int F(SetReal)(void *m, const unsigned *r, size_t n, const double *y) {
    for (size_t i = 0; i < n; i++) if (real(m, r[i])) *real(m, r[i]) = y[i]; else return 3;
    return 0;
}
int F(GetInteger)(void *c, const unsigned *r, size_t n, int *y) {
    model *m = c;
    for (size_t i = 0; i < n; i++)
        y[i] = r[i] == COUNTER ? m->p.counter : r[i] == COMPLETED ? m->p.completed : m->i;
    return 0;
}
int F(SetInteger)(void *m, const unsigned *r, size_t n, const int *y) {
    for (size_t i = 0; i < n; i++) ((model *)m)->i = y[i];
    return 0;
}
int F(GetBoolean)(void *m, const unsigned *r, size_t n, char *y) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->b;
    return 0;
}
int F(SetBoolean)(void *m, const unsigned *r, size_t n, const char *y) {
    for (size_t i = 0; i < n; i++) ((model *)m)->b = y[i];
    return 0;
}
int F(GetString)(void *m, const unsigned *r, size_t n, const char **y) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->s;
    return 0;
}
int F(SetString)(void *m, const unsigned *r, size_t n, const char *const *y) {
    for (size_t i = 0; i < n; i++) strncpy(((model *)m)->s, y[i], 63);
    return 0;
}
#ifdef SLAVE
void *F(InstantiateSlave)(const char *name, const char *guid, const char *where, const char *mime,
                          double timeout, char visible, char interactive, callbacks f, char log) {
    return make(name, guid, f);
}
void F(FreeSlaveInstance)(void *m) { drop(m); }
int F(InitializeSlave)(void *m, double start, char defined, double stop) {
    plant_begin(&((model *)m)->p, start);
    return 1; /* Warning, on which an importer goes on */
}
int F(TerminateSlave)(void *m) { return 0; }
int F(ResetSlave)(void *m) { plant_reset(&((model *)m)->p); return 0; }
int F(DoStep)(void *c, double t, double h, char fresh) {
    model *m = c;
    if (t + h > m->p.end_at) {
        m->f.log(m, m->name, 3, "error", "no step beyond %g s", m->p.end_at);
        return 3;
    }
    advance(&m->p, t + h, false);
    return 1;
}
#else
void *F(InstantiateModel)(const char *name, const char *guid, callbacks f, char log) {
    return make(name, guid, f);
}
void F(FreeModelInstance)(void *m) { drop(m); }
static void tell(plant *p, event_info *i) {
    i->converged = 1, i->references = 0, i->values = handle(p, p->h <= 1e-9);
    i->terminate = p->t >= p->end_at - 1e-12, i->upcoming = 1;
    i->next = fmin(p->next, p->end_at);
}
int F(Initialize)(void *m, char controlled, double tolerance, event_info *i) {
    plant_begin(&((model *)m)->p, ((model *)m)->p.t);
    tell(&((model *)m)->p, i);
    return 0;
}
int F(EventUpdate)(void *m, char intermediate, event_info *i) {
    tell(&((model *)m)->p, i);
    return 0;
}
int F(Terminate)(void *m) { return 0; }
int F(CompletedIntegratorStep)(void *m, char *event) {
    ((model *)m)->p.completed++;
    *event = 0;
    return 0;
}
int F(SetTime)(void *m, double t) { ((model *)m)->p.t = t; return 0; }
int F(SetContinuousStates)(void *m, const double *x, size_t n) {
    plant *p = &((model *)m)->p;
    p->x = x[0], p->h = x[1], p->v = x[2];
    return 0;
}
int F(GetContinuousStates)(void *m, double *x, size_t n) {
    plant *p = &((model *)m)->p;
    x[0] = p->x, x[1] = p->h, x[2] = p->v;
    return 0;
}
int F(GetDerivatives)(void *m, double *d, size_t n) {
    plant *p = &((model *)m)->p;
    d[0] = rate_x(p), d[1] = p->v, d[2] = -G;
    return 0;
}
int F(GetEventIndicators)(void *m, double *z, size_t n) { z[0] = ((model *)m)->p.h; return 0; }
int F(GetNominalContinuousStates)(void *m, double *x, size_t n) {
    x[0] = 1.0, x[1] = 0.1, x[2] = 10.0;
    return 0;
}
#endif
