/* Loads a block's FMI 2 library and steps it: driver LIBRARY TOKEN STEP FIRST_INPUT N_U N_Y.
 * Reads rows of N_U inputs as raw doubles from standard input and writes rows of N_Y outputs. */
#include <stdio.h>
#include <stdlib.h>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <windows.h>
static void *symbol(void *library, const char *name) {
    return (void *)GetProcAddress((HMODULE)library, name);
}
static void *load(const char *path) {
    _setmode(_fileno(stdin), _O_BINARY);
    _setmode(_fileno(stdout), _O_BINARY);
    return (void *)LoadLibraryA(path);
}
#else
#include <dlfcn.h>
static void *symbol(void *library, const char *name) { return dlsym(library, name); }
static void *load(const char *path) { return dlopen(path, RTLD_NOW | RTLD_LOCAL); }
#endif

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void logger(void *e, const char *name, int status, const char *category, const char *text,
                   ...) {
    (void)e, (void)name, (void)category;
    fprintf(stderr, "status %d: %s\n", status, text);
}

int main(int argc, char **argv) {
    enum { MOST = 512 };
    static Callbacks callbacks = {logger, calloc, free, NULL, NULL};
    unsigned u_references[MOST], y_references[MOST];
    double u[MOST], y[MOST];
    void *library = argc == 7 ? load(argv[1]) : NULL;
    if (!library) {
        fprintf(stderr, "the library cannot be loaded\n");
        return 2;
    }
    const double step = atof(argv[3]);
    const unsigned first = (unsigned)atoi(argv[4]);
    const size_t n_u = (size_t)atoi(argv[5]), n_y = (size_t)atoi(argv[6]);
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int,
                         int) = symbol(library, "fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) =
        symbol(library, "fmi2SetupExperiment");
    int (*enter)(void *) = symbol(library, "fmi2EnterInitializationMode");
    int (*leave)(void *) = symbol(library, "fmi2ExitInitializationMode");
    int (*set)(void *, const unsigned *, size_t, const double *) =
        symbol(library, "fmi2SetReal");
    int (*get)(void *, const unsigned *, size_t, double *) = symbol(library, "fmi2GetReal");
    int (*do_step)(void *, double, double, int) = symbol(library, "fmi2DoStep");
    void (*release)(void *) = symbol(library, "fmi2FreeInstance");
    void *c = instantiate("instance", 1, argv[2], "", &callbacks, 0, 0);
    if (!c || setup(c, 0, 0.0, 0.0, 0, 0.0) || enter(c) || leave(c)) {
        return 3;
    }
    for (unsigned i = 0; i < MOST; i++) {
        u_references[i] = first + i;
        y_references[i] = first + (unsigned)n_u + i;
    }
    for (long k = 0; fread(u, sizeof(double), n_u, stdin) == n_u; k++) {
        if (set(c, u_references, n_u, u) || do_step(c, (double)k * step, step, 1) ||
            get(c, y_references, n_y, y)) {
            return 4;
        }
        fwrite(y, sizeof(double), n_y, stdout);
    }
    release(c);
    return 0;
}
