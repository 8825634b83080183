/* A first-order lag that misbehaves on demand, as an FMI 2.0 or 3.0 co-simulation FMU (-DFMI=2|3).

   What it does wrong stands in resources/behaviour.txt, one line each: phase, action, and the
   number of calls of that phase that go well before (0 where absent), and an argument:

       DoStep segfault 5
       GetFloat64 nan 3
       Terminate hang
       DoStep sleep 0 20          every step from the first on takes 20 ms
       DoStep too_long 0 3000     steps longer than 3000 us are discarded
       DoStep halfway             FMI 2: steps are discarded, half of them being done

   A phase is the name of an FMI function without its prefix, or `load` or `unload`. The library
   finds its archive by its own place, so that it misbehaves also while it is being loaded.
   -DMISSING_SYMBOL leaves out Terminate. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <limits.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
#define MOST 16

enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };

typedef struct {
    char phase[48], action[32];
    long after, argument, calls;
} Fault;

static Fault faults[MOST];
static int n_faults;

typedef struct {
    double x, u, T, time, d;
    void *environment;
    void *log;
    char name[128], word[32];
    bool logging;
} Lag;

typedef struct {
    double x, u, T, time, d;
} State;

#if FMI == 2
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void *finished;
    void *environment;
} Callbacks;
#define F(name) fmi2##name
#define SAY(lag, status, ...) \
    ((Logger)(lag)->log)((lag)->environment, (lag)->name, status, "hostile", __VA_ARGS__)
#else
typedef void (*Logger)(void *, int, const char *, const char *);
#define F(name) fmi3##name
static void say3(Lag *lag, int status, const char *format, ...) {
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    ((Logger)lag->log)(lag->environment, status, "hostile", text);
}
#define SAY(lag, status, ...) say3(lag, status, __VA_ARGS__)
#endif

static void read_behaviour(void) {
    Dl_info info;
    char path[PATH_MAX], line[256];
    if (!dladdr((void *)read_behaviour, &info)) return;
    snprintf(path, sizeof path, "%s", info.dli_fname);
    for (int up = 0; up < 3; up++) {
        char *slash = strrchr(path, '/');
        if (slash) *slash = 0;
    }
    strncat(path, "/resources/behaviour.txt", sizeof path - strlen(path) - 1);
    FILE *file = fopen(path, "r");
    if (!file) return;
    while (n_faults < MOST && fgets(line, sizeof line, file)) {
        Fault *f = &faults[n_faults];
        if (sscanf(line, "%47s %31s %ld %ld", f->phase, f->action, &f->after, &f->argument) >= 2)
            n_faults++;
    }
    fclose(file);
}

static volatile long depth_reached;

/* Not a tail call, and of no bounded depth that a compiler could see. */
static long overflow(long depth) {
    volatile char room[4096];
    room[depth % 4096] = (char)depth;
    depth_reached = depth;
    return overflow(depth + 1) + room[(depth + 1) % 4096];
}

static void sleep_ms(long ms) {
    struct timespec t = {ms / 1000, (ms % 1000) * 1000000L};
    nanosleep(&t, NULL);
}

static void eat_memory(void) {
    for (;;) {
        char *block = malloc(16 << 20);
        if (!block) abort();
        memset(block, 1, 16 << 20);
        sleep_ms(2);
    }
}

static void log_much(Lag *lag, const char *action, long n) {
    if (!lag || !lag->log) return;
    if (!strcmp(action, "log")) SAY(lag, WARNING, "the valve sticks");
    if (!strcmp(action, "log_error")) SAY(lag, ERROR, "the valve broke");
    if (!strcmp(action, "log_garbage")) SAY(lag, WARNING, "\xff\xfe\x80 not text \x01");
    if (!strcmp(action, "log_format")) SAY(lag, WARNING, "%d %f %x %d %d %p");
    if (!strcmp(action, "log_long")) {
        char *text = malloc(100001);
        memset(text, 'x', 100000);
        text[100000] = 0;
        SAY(lag, WARNING, "%s", text);
        free(text);
    }
    if (!strcmp(action, "log_many"))
        for (long i = 0; i < n; i++) SAY(lag, WARNING, "message %ld", i);
    if (!strcmp(action, "log_null")) {
#if FMI == 2
        ((Logger)lag->log)(lag->environment, NULL, WARNING, NULL, NULL);
#else
        ((Logger)lag->log)(lag->environment, WARNING, NULL, NULL);
#endif
    }
    if (!strcmp(action, "log_stranger")) { /* an environment that is none of the importer's */
#if FMI == 2
        ((Logger)lag->log)((void *)0x10, lag->name, WARNING, "hostile", "from nowhere");
#else
        ((Logger)lag->log)((void *)0x10, WARNING, "hostile", "from nowhere");
#endif
    }
}

static void *log_from_here(void *lag) {
    SAY((Lag *)lag, WARNING, "from another thread");
    return NULL;
}

/* printf formats for which there are no arguments, and a message from another thread. */
static void log_wrong(Lag *lag, const char *action) {
    pthread_t other;
    if (!lag || !lag->log) return;
#if FMI == 2
    if (!strcmp(action, "log_missing")) SAY(lag, WARNING, "%s %s %s %s %s %s %s %s %s %s");
    if (!strcmp(action, "log_write")) SAY(lag, WARNING, "%n%n%n%n%n%n%n%n");
    if (!strcmp(action, "log_pointer")) SAY(lag, WARNING, "%d: %s", 1, (char *)0x12345);
    if (!strcmp(action, "log_null_text")) SAY(lag, WARNING, "valve %s at %f", (char *)0, 1.5);
#else
    if (!strcmp(action, "log_missing")) ((Logger)lag->log)(lag->environment, 1, "c", "%s %s %s");
    if (!strcmp(action, "log_write")) ((Logger)lag->log)(lag->environment, 1, "c", "%n%n%n");
#endif
    if (!strcmp(action, "log_thread") && !pthread_create(&other, NULL, log_from_here, lag))
        pthread_join(other, NULL);
}

/* Do what is wrong without returning, or log; else the action is left to the caller. */
static const Fault *due(const char *phase, Lag *lag) {
    const Fault *found = NULL;
    for (int i = 0; i < n_faults; i++) {
        Fault *f = &faults[i];
        if (strcmp(f->phase, phase) || f->calls++ < f->after) continue;
        const char *a = f->action;
        if (!strcmp(a, "segfault")) *(volatile int *)8 = 1;
        else if (!strcmp(a, "bus")) raise(SIGBUS);
        else if (!strcmp(a, "illegal")) raise(SIGILL);
        else if (!strcmp(a, "divide")) raise(SIGFPE);
        else if (!strcmp(a, "abort")) abort();
        else if (!strcmp(a, "terminated")) raise(SIGTERM);
        else if (!strcmp(a, "killed")) raise(SIGKILL);
        else if (!strcmp(a, "exit")) exit((int)f->argument);
        else if (!strcmp(a, "_exit")) _exit((int)f->argument);
        else if (!strcmp(a, "hang")) for (;;) pause();
        else if (!strcmp(a, "spin")) for (volatile long n = 0;; n++) {}
        else if (!strcmp(a, "stop")) raise(SIGSTOP);
        else if (!strcmp(a, "overflow")) depth_reached = overflow(0);
        else if (!strcmp(a, "memory")) eat_memory();
        else if (!strcmp(a, "sleep")) sleep_ms(f->argument);
        else if (!strcmp(a, "close")) for (int fd = 3; fd < 256; fd++) close(fd);
        else if (!strcmp(a, "print")) printf("the FMU prints\n"), fflush(stdout);
        else if (!strcmp(a, "child")) { if (!fork()) for (;;) pause(); }
        else if (!strcmp(a, "litter")) { FILE *t = fopen("litter.txt", "w"); if (t) fclose(t); }
        else if (!strncmp(a, "log", 3)) log_much(lag, a, f->argument), log_wrong(lag, a);
        else found = f;
    }
    return found;
}

static int status_of(const Fault *f) {
    static const char *names[] = {"ok", "warning", "discard", "error", "fatal", "pending"};
    for (int i = 0; f && i < 6; i++)
        if (!strcmp(f->action, names[i])) return i;
    if (f && !strcmp(f->action, "status")) return (int)f->argument; /* any number at all */
    return OK;
}

#define GUARD(phase) \
    const Fault *fault = due(phase, (Lag *)c); \
    if (status_of(fault) > WARNING || status_of(fault) < 0) return status_of(fault); \
    (void)fault

__attribute__((constructor)) static void loaded(void) {
    read_behaviour();
    due("load", NULL);
}

__attribute__((destructor)) static void unloaded(void) { due("unload", NULL); }

static Lag *fresh(const char *name, void *log, void *environment, bool logging) {
    Lag *lag = calloc(1, sizeof *lag);
    lag->T = 0.1;
    lag->log = log, lag->environment = environment, lag->logging = logging;
    snprintf(lag->name, sizeof lag->name, "%s", name ? name : "");
    return lag;
}

static int get(Lag *lag, const unsigned *vr, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) switch (vr[i]) {
        case 0: values[i] = lag->u; break;
        case 1: values[i] = lag->x; break;
        case 2: values[i] = lag->T; break;
        case 3: values[i] = lag->time; break;
        case 4: values[i] = lag->d; break;
        default: return ERROR;
    }
    return OK;
}

static int put(Lag *lag, const unsigned *vr, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        if (vr[i] == 0) lag->u = values[i];
        else if (vr[i] == 2) lag->T = values[i];
        else if (vr[i] == 4) lag->d = values[i];
        else return ERROR;
    }
    return OK;
}

static int too_long(const Fault *f, double h) {
    return f && !strcmp(f->action, "too_long") && h > 1e-6 * f->argument;
}

static void step(Lag *lag, double t, double h) {
    lag->x += (lag->u + lag->d - lag->x) * (1.0 - exp(-h / lag->T));
    lag->time = t + h;
}

static void spoil(const Fault *fault, double *values, size_t n) {
    if (fault && n && !strcmp(fault->action, "nan")) values[0] = NAN;
    if (fault && n && !strcmp(fault->action, "infinite")) values[0] = INFINITY;
}

EXPORT const char *F(GetVersion)(void) {
    if (due("GetVersion", NULL)) return "1.0"; /* whatever the action is called */
    return FMI == 2 ? "2.0" : "3.0";
}
EXPORT const char *F(GetTypesPlatform)(void) { return "default"; }
EXPORT int F(SetDebugLogging)(void *c, int on, size_t n, const char *const names[]) {
    GUARD("SetDebugLogging");
    (void)on, (void)n, (void)names;
    return OK;
}
#ifndef MISSING_SYMBOL
EXPORT int F(Terminate)(void *c) { GUARD("Terminate"); return status_of(fault); }
#endif
EXPORT int F(Reset)(void *c) { GUARD("Reset"); ((Lag *)c)->x = 0; return status_of(fault); }
EXPORT int F(ExitInitializationMode)(void *c) {
    GUARD("ExitInitializationMode");
    return status_of(fault);
}
EXPORT void F(FreeInstance)(void *c) { due("FreeInstance", c); free(c); }

#if FMI == 2
EXPORT void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources,
                             const Callbacks *callbacks, int visible, int logging) {
    (void)type, (void)guid, (void)resources, (void)visible;
    Lag *lag = fresh(name, (void *)callbacks->logger, callbacks->environment, logging);
    const Fault *fault = due("Instantiate", lag);
    return fault && !strcmp(fault->action, "null") ? NULL : lag;
}
EXPORT int fmi2SetupExperiment(void *c, int defined, double tolerance, double start, int stops,
                               double stop) {
    GUARD("SetupExperiment");
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Lag *)c)->time = start;
    return status_of(fault);
}
EXPORT int fmi2EnterInitializationMode(void *c) {
    GUARD("EnterInitializationMode");
    return status_of(fault);
}
EXPORT int fmi2GetReal(void *c, const unsigned *vr, size_t n, double *values) {
    GUARD("GetReal");
    int status = get(c, vr, n, values);
    spoil(fault, values, n);
    return status ? status : status_of(fault);
}
EXPORT int fmi2SetReal(void *c, const unsigned *vr, size_t n, const double *values) {
    GUARD("SetReal");
    int status = put(c, vr, n, values);
    return status ? status : status_of(fault);
}
EXPORT int fmi2DoStep(void *c, double t, double h, int no_set_state) {
    (void)no_set_state;
    GUARD("DoStep");
    if (too_long(fault, h)) return ((Lag *)c)->x = NAN, DISCARD; /* only a snapshot helps */
    int half = fault && !strcmp(fault->action, "halfway") && h > 1e-4;
    step(c, t, half ? h / 2 : h);
    return half ? DISCARD : status_of(fault);
}
/* "GetStatus pending": the step that is pending never ends. */
EXPORT int fmi2GetStatus(void *c, int kind, int *value) {
    const Fault *fault = due("GetStatus", c);
    (void)kind;
    *value = status_of(fault);
    return OK;
}
EXPORT int fmi2GetRealStatus(void *c, int kind, double *value) {
    (void)kind;
    *value = ((Lag *)c)->time;
    return OK;
}
EXPORT int fmi2GetBooleanStatus(void *c, int kind, int *value) {
    (void)c, (void)kind;
    *value = 0;
    for (int i = 0; i < n_faults; i++) *value |= !strcmp(faults[i].action, "terminate");
    return OK;
}
#define STATE(verb) fmi2##verb##FMUstate
#define SIZE fmi2SerializedFMUstateSize
#else
EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token,
                                         const char *resources, bool visible, bool logging,
                                         bool event_mode, bool early_return, const unsigned *vr,
                                         size_t n, void *environment, void *log, void *update) {
    (void)token, (void)resources, (void)visible, (void)event_mode, (void)early_return, (void)vr;
    (void)n, (void)update;
    Lag *lag = fresh(name, log, environment, logging);
    const Fault *fault = due("InstantiateCoSimulation", lag);
    return fault && !strcmp(fault->action, "null") ? NULL : lag;
}
EXPORT int fmi3EnterInitializationMode(void *c, bool defined, double tolerance, double start,
                                       bool stops, double stop) {
    GUARD("EnterInitializationMode");
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Lag *)c)->time = start;
    return status_of(fault);
}
EXPORT int fmi3GetFloat64(void *c, const unsigned *vr, size_t n, double *values, size_t m) {
    GUARD("GetFloat64");
    int status = m == n ? get(c, vr, n, values) : ERROR;
    spoil(fault, values, n);
    return status ? status : status_of(fault);
}
/* Variable 5: the output in words, another one after every step. */
EXPORT int fmi3GetString(void *c, const unsigned *vr, size_t n, const char **values, size_t m) {
    GUARD("GetString");
    Lag *lag = c;
    if (n != 1 || m != 1 || vr[0] != 5) return ERROR;
    snprintf(lag->word, sizeof lag->word, "%.9g", lag->x);
    values[0] = lag->word;
    if (fault && !strcmp(fault->action, "no_text")) values[0] = NULL;
    if (fault && !strcmp(fault->action, "latin_1")) values[0] = "caf\xe9";
    return status_of(fault);
}
EXPORT int fmi3SetFloat64(void *c, const unsigned *vr, size_t n, const double *values, size_t m) {
    GUARD("SetFloat64");
    int status = m == n ? put(c, vr, n, values) : ERROR;
    return status ? status : status_of(fault);
}
/* "middle", "still", "backwards", "last_nan": the time that a step says to have reached; with "early_" or
   "discard_" before it, in a step that ends so. */
static double reached(const char *action, double t, double h) {
    if (strstr(action, "middle")) return t + h / 2;
    if (strstr(action, "backwards")) return t - h;
    if (strstr(action, "still")) return t;
    return strstr(action, "last_nan") ? (double)NAN : t + h;
}

EXPORT int fmi3DoStep(void *c, double t, double h, bool no_set_state, bool *event, bool *terminate,
                      bool *early, double *last) {
    (void)no_set_state;
    GUARD("DoStep");
    if (fault && !strncmp(fault->action, "discard_", 8)) {
        *last = reached(fault->action, t, h);
        return DISCARD;
    }
    *event = *terminate = *early = false;
    if (too_long(fault, h)) return ((Lag *)c)->x = NAN, DISCARD;
    step(c, t, h);
    *last = fault ? reached(fault->action, t, h) : t + h;
    if (fault && !strcmp(fault->action, "event")) *event = true;
    if (fault && !strcmp(fault->action, "terminate")) *terminate = true;
    if (fault && !strncmp(fault->action, "early", 5)) *early = true;
    return status_of(fault);
}
EXPORT int fmi3EnterEventMode(void *c) { return OK; }
EXPORT int fmi3EnterStepMode(void *c) { return OK; }
EXPORT int fmi3UpdateDiscreteStates(void *c, bool *needs, bool *ends, bool *nominals, bool *values,
                                    bool *timed, double *next) {
    (void)c, (void)next;
    *needs = *ends = *nominals = *values = *timed = false;
    return OK;
}
#define STATE(verb) fmi3##verb##FMUState
#define SIZE fmi3SerializedFMUStateSize
#endif

EXPORT int STATE(Get)(void *c, void **state) {
    GUARD("GetFMUState");
    Lag *lag = c;
    State *s = *state ? *state : malloc(sizeof *s);
    *s = (State){lag->x, lag->u, lag->T, lag->time, lag->d};
    *state = s;
    return status_of(fault);
}
EXPORT int STATE(Set)(void *c, void *state) {
    GUARD("SetFMUState");
    Lag *lag = c;
    State *s = state;
    lag->x = s->x, lag->u = s->u, lag->T = s->T, lag->time = s->time, lag->d = s->d;
    return status_of(fault);
}
EXPORT int STATE(Free)(void *c, void **state) {
    GUARD("FreeFMUState");
    free(*state);
    *state = NULL;
    return status_of(fault);
}
EXPORT int SIZE(void *c, void *state, size_t *size) {
    GUARD("SerializedFMUStateSize");
    (void)state;
    *size = sizeof(State);
    return status_of(fault);
}
EXPORT int STATE(Serialize)(void *c, void *state, unsigned char *bytes, size_t size) {
    GUARD("SerializeFMUState");
    if (size < sizeof(State)) return ERROR;
    memcpy(bytes, state, sizeof(State));
    return status_of(fault);
}
#if FMI == 2
EXPORT int fmi2DeSerializeFMUstate(void *c, const unsigned char *bytes, size_t size, void **state) {
#else
EXPORT int fmi3DeserializeFMUState(void *c, const unsigned char *bytes, size_t size, void **state) {
#endif
    GUARD("DeserializeFMUState");
    if (size != sizeof(State)) return ERROR;
    *state = malloc(sizeof(State));
    memcpy(*state, bytes, sizeof(State));
    return status_of(fault);
}
