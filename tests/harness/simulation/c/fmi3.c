/* FMI 3, co-simulation with event mode and early return, model exchange, all types, arrays with a
   structural parameter, clocks of every kind. */
#include "model.h"

typedef void (*logger_t)(void *, int, const char *, const char *);
enum { X = 1, DX, H, V, DV, K, U, E_, COUNTER, COMPLETED, END };
enum { SIZE = 20, W, DOUBLED, TABLE };
enum { TICK = 30, DOWN, USER, EVEN, TICKS, DOWNS, USERS, CHANGING, CHANGES };
enum { F32 = 40, I8 = 42, U8 = 44, I16 = 46, U16 = 48, I32 = 50, U32 = 52, I64 = 54, U64 = 56,
       BOOL = 58, TEXT = 60, BLOB = 62, ENUM = 64 };
#define MOST 8

typedef struct {
    plant p;
    void *environment;
    logger_t log;
    bool event_mode, early, co_simulation, configuring;
    uint64_t size;
    double w[MOST];
    bool tick, down, user, changing;
    int ticks, downs, users, changes;
    double countdown, interval;
    float f32; int8_t i8; uint8_t u8; int16_t i16; uint16_t u16; int32_t i32; uint32_t u32;
    int64_t i64, option; uint64_t u64; bool b; char text[64]; uint8_t blob[64]; size_t blob_size;
} model;

static void *make(const char *name, const char *token, void *environment, logger_t log) {
    if (strcmp(token, "{3}")) {
        log(environment, 3, "error", "the token is not mine");
        return 0;
    }
    model *m = calloc(1, sizeof *m);
    plant_reset(&m->p);
    m->environment = environment, m->log = log, m->size = 3, m->option = 1, m->interval = 0.2;
    for (int i = 0; i < MOST; i++) m->w[i] = i + 1;
    return m;
}
void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *path, bool visible,
    bool logging, bool event_mode, bool early, const unsigned *r, size_t n, void *environment,
    logger_t log, void *update) {
    model *m = make(name, token, environment, log);
    if (m) m->event_mode = event_mode, m->early = early, m->co_simulation = true;
    return m;
}
void *fmi3InstantiateModelExchange(const char *name, const char *token, const char *path,
    bool visible, bool logging, void *environment, logger_t log) {
    return make(name, token, environment, log);
}
void fmi3FreeInstance(void *m) { free(m); }
int fmi3EnterConfigurationMode(void *m) { ((model *)m)->configuring = true; return 0; }
int fmi3ExitConfigurationMode(void *m) { ((model *)m)->configuring = false; return 0; }
int fmi3EnterInitializationMode(void *m, bool d, double tol, double start, bool e, double stop) {
    plant_begin(&((model *)m)->p, start);
    return 0;
}
int fmi3ExitInitializationMode(void *c) {
    model *m = c;
    m->p.in_event_mode = !m->co_simulation || m->event_mode;
    return 0;
}
int fmi3Terminate(void *m) { return 0; }
int fmi3Reset(void *m) { return 0; }

static double *number(model *m, unsigned r) {
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
int fmi3GetFloat64(void *c, const unsigned *r, size_t n, double *y, size_t total) {
    model *m = c;
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == W || r[i] == DOUBLED)
            for (size_t j = 0; j < m->size; j++) y[k++] = m->w[j] * (r[i] == W ? 1.0 : 2.0);
        else if (r[i] == TABLE)
            for (size_t a = 0; a < m->size; a++)
                for (size_t b = 0; b < 2; b++) y[k++] = 10.0 * (a + 1) + (b + 1);
        else if (number(m, r[i])) y[k++] = *number(m, r[i]);
        else return 3;
    }
    return k == total ? 0 : 3;
}
int fmi3SetFloat64(void *c, const unsigned *r, size_t n, const double *y, size_t total) {
    model *m = c;
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == W) for (size_t j = 0; j < m->size; j++) m->w[j] = y[k++];
        else if (number(m, r[i])) *number(m, r[i]) = y[k++];
        else return 3;
    }
    return k == total ? 0 : 3;
}
#define ECHO(name, ctype, field, first)                                                            \
    int fmi3Get##name(void *m, const unsigned *r, size_t n, ctype *y, size_t total) {              \
        for (size_t i = 0; i < n; i++) {                                                           \
            if (r[i] != first && r[i] != first + 1) return 3;                                      \
            y[i] = ((model *)m)->field;                                                            \
        }                                                                                          \
        return 0;                                                                                  \
    }                                                                                              \
    int fmi3Set##name(void *m, const unsigned *r, size_t n, const ctype *y, size_t total) {        \
        for (size_t i = 0; i < n; i++) {                                                           \
            if (r[i] != first) return 3;                                                           \
            ((model *)m)->field = y[i];                                                            \
        }                                                                                          \
        return 0;                                                                                  \
    }
ECHO(Float32, float, f32, F32)
ECHO(Int8, int8_t, i8, I8)
ECHO(UInt8, uint8_t, u8, U8)
ECHO(Int16, int16_t, i16, I16)
ECHO(UInt16, uint16_t, u16, U16)
ECHO(UInt32, uint32_t, u32, U32)
ECHO(Boolean, bool, b, BOOL)
int fmi3GetInt32(void *c, const unsigned *r, size_t n, int32_t *y, size_t total) {
    model *m = c;
    for (size_t i = 0; i < n; i++) switch (r[i]) {
        case COUNTER: y[i] = m->p.counter; break;
        case COMPLETED: y[i] = m->p.completed; break;
        case TICKS: if (!m->tick) return 3; y[i] = m->ticks; break;
        case DOWNS: y[i] = m->downs; break;
        case USERS: y[i] = m->users; break;
        case CHANGES: y[i] = m->changes; break;
        default: y[i] = m->i32;
    }
    return 0;
}
int fmi3SetInt32(void *m, const unsigned *r, size_t n, const int32_t *y, size_t total) {
    ((model *)m)->i32 = y[0];
    return 0;
}
int fmi3GetInt64(void *m, const unsigned *r, size_t n, int64_t *y, size_t total) {
    for (size_t i = 0; i < n; i++) y[i] = r[i] >= ENUM ? ((model *)m)->option : ((model *)m)->i64;
    return 0;
}
int fmi3SetInt64(void *m, const unsigned *r, size_t n, const int64_t *y, size_t total) {
    for (size_t i = 0; i < n; i++)
        *(r[i] == ENUM ? &((model *)m)->option : &((model *)m)->i64) = y[i];
    return 0;
}
int fmi3GetUInt64(void *m, const unsigned *r, size_t n, uint64_t *y, size_t total) {
    for (size_t i = 0; i < n; i++) y[i] = r[i] == SIZE ? ((model *)m)->size : ((model *)m)->u64;
    return 0;
}
int fmi3SetUInt64(void *c, const unsigned *r, size_t n, const uint64_t *y, size_t total) {
    model *m = c;
    for (size_t i = 0; i < n; i++) {
        if (r[i] == SIZE && (!m->configuring || y[i] > MOST)) return 3;
        *(r[i] == SIZE ? &m->size : &m->u64) = y[i];
    }
    return 0;
}
int fmi3GetString(void *m, const unsigned *r, size_t n, const char **y, size_t total) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->text;
    return 0;
}
int fmi3SetString(void *m, const unsigned *r, size_t n, const char *const *y, size_t total) {
    strncpy(((model *)m)->text, y[0], 63);
    return 0;
}
int fmi3GetBinary(void *m, const unsigned *r, size_t n, size_t *sizes, const uint8_t **y, size_t t) {
    for (size_t i = 0; i < n; i++) y[i] = ((model *)m)->blob, sizes[i] = ((model *)m)->blob_size;
    return 0;
}
int fmi3SetBinary(void *m, const unsigned *r, size_t n, const size_t *sizes, const uint8_t *const *y,
                  size_t total) {
    ((model *)m)->blob_size = sizes[0];
    memcpy(((model *)m)->blob, y[0], sizes[0]);
    return 0;
}
int fmi3DoStep(void *c, double t, double h, bool keep, bool *event, bool *terminate, bool *early,
               double *last) {
    model *m = c;
    *event = *terminate = *early = false;
    if (m->p.in_event_mode || fabs(t - m->p.t) > 1e-9) return 3;
    m->p.t = t;
    *event = advance(&m->p, t + h, m->event_mode);
    *early = *event && m->p.t < t + h;
    *last = m->p.t;
    *terminate = m->p.t >= m->p.end_at - 1e-12;
    return *early && !m->early ? 3 : 0;
}
int fmi3EnterEventMode(void *m) { ((model *)m)->p.in_event_mode = true; return 0; }
int fmi3EnterStepMode(void *m) { ((model *)m)->p.in_event_mode = false; return 0; }
int fmi3EnterContinuousTimeMode(void *m) { ((model *)m)->p.in_event_mode = false; return 0; }
int fmi3UpdateDiscreteStates(void *c, bool *needs, bool *terminate, bool *nominals, bool *values,
                             bool *defined, double *next) {
    model *m = c;
    if (!m->p.in_event_mode) return 3;
    *needs = *nominals = false;
    *values = handle(&m->p, m->p.h <= 1e-9);
    *terminate = m->p.t >= m->p.end_at - 1e-12;
    *defined = true, *next = fmin(m->p.next, m->p.end_at);
    m->tick = m->down = m->user = m->changing = false;
    return 0;
}
int fmi3SetClock(void *c, const unsigned *r, size_t n, const bool *y) {
    model *m = c;
    if (!m->p.in_event_mode) return 3;
    for (size_t i = 0; i < n; i++) if (y[i]) switch (r[i]) {
        case TICK: m->tick = true; if (++m->ticks % 3 == 0) m->countdown = 0.05; break;
        case DOWN: m->down = true; m->downs++; break;
        case USER: m->user = true; m->users++; break;
        case CHANGING: m->changing = true; m->changes++; m->interval *= 2.0; break;
        default: return 3;
    }
    return 0;
}
int fmi3GetClock(void *c, const unsigned *r, size_t n, bool *y) {
    model *m = c;
    if (!m->p.in_event_mode) return 3;
    for (size_t i = 0; i < n; i++) y[i] = r[i] == EVEN && m->tick && m->ticks % 2 == 0;
    return 0;
}
int fmi3GetIntervalDecimal(void *c, const unsigned *r, size_t n, double *y, int *qualifier) {
    model *m = c;
    if (r[0] == DOWN) {
        *qualifier = m->countdown > 0.0 ? 2 : 0;
        *y = m->countdown;
        m->countdown = 0.0;
    } else {
        *qualifier = 2, *y = m->interval;
    }
    return 0;
}
int fmi3CompletedIntegratorStep(void *c, bool keep, bool *event, bool *terminate) {
    ((model *)c)->p.completed++;
    *event = *terminate = false;
    return 0;
}
int fmi3SetTime(void *m, double t) { ((model *)m)->p.t = t; return 0; }
int fmi3SetContinuousStates(void *c, const double *x, size_t n) {
    plant *p = &((model *)c)->p;
    if (p->in_event_mode) return 3;
    p->x = x[0], p->h = x[1], p->v = x[2];
    return 0;
}
int fmi3GetContinuousStates(void *c, double *x, size_t n) {
    plant *p = &((model *)c)->p;
    x[0] = p->x, x[1] = p->h, x[2] = p->v;
    return 0;
}
int fmi3GetContinuousStateDerivatives(void *c, double *d, size_t n) {
    plant *p = &((model *)c)->p;
    d[0] = rate_x(p), d[1] = p->v, d[2] = -G;
    return 0;
}
int fmi3GetEventIndicators(void *m, double *z, size_t n) { z[0] = ((model *)m)->p.h; return 0; }
int fmi3GetNominalsOfContinuousStates(void *m, double *x, size_t n) {
    x[0] = 1.0, x[1] = 0.1, x[2] = 10.0;
    return 0;
}
