/* The trivial plant of the benchmark, a first-order lag that costs next to nothing:
 *
 *     x += h k (u - x),   y = x
 *
 * so that what remains of a run is what the master spends. */
#ifndef MODEL_H
#define MODEL_H

#include <stddef.h>
#include <stdlib.h>

enum { VR_U = 0, VR_Y = 1 };
enum { OK = 0, ERROR = 3 };

typedef struct {
    double u, x, k;
} Lag;

#define EXPORT __attribute__((visibility("default")))

/* What the standard demands and no side of the benchmark calls. */
#define MISSING(name) \
    EXPORT int name(void) { return ERROR; }

static inline void *lag_new(void) {
    Lag *lag = calloc(1, sizeof(Lag));
    if (lag) lag->k = 1.0;
    return lag;
}

static inline int lag_get(const Lag *lag, const unsigned *references, size_t n, double *values) {
    for (size_t i = 0; i < n; i++) {
        if (references[i] > VR_Y) return ERROR;
        values[i] = references[i] == VR_Y ? lag->x : lag->u;
    }
    return OK;
}

static inline int lag_set(Lag *lag, const unsigned *references, size_t n, const double *values) {
    for (size_t i = 0; i < n; i++) {
        if (references[i] != VR_U) return ERROR;
        lag->u = values[i];
    }
    return OK;
}

static inline void lag_step(Lag *lag, double h) { lag->x += h * lag->k * (lag->u - lag->x); }

#endif
