/* RODAS4: a stiffly accurate Rosenbrock method of order 4 with an embedded solution of order 3
 * (E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, section IV.7).
 *
 *     dx/dt = f(x),   x in R^n,   inputs and parameters held during the call
 *
 * The Jacobian df/dx is exact. The error of each substep is weighed with
 * relative_tolerance * (scale_i + max(|x_i|)), scale_i being the nominal of state i. */
#ifndef RODAS4_H
#define RODAS4_H

#include <stddef.h>

typedef struct {
    size_t n;
    const void *context; /* handed to the two functions below */
    void (*derivatives)(const void *context, const double *x, double *dx);
    void (*linearise)(const void *context, const double *x, double *dx, double *jacobian);
    double relative_tolerance;
    const double *scale; /* n nominal values, all above 0 */
    double *work;        /* RODAS4_WORK(n) */
    size_t *pivots;      /* n */
} Rodas4;

/* n^2 Jacobian (row by row), n^2 its factors, six stages, derivatives, argument, right side */
#define RODAS4_WORK(n) (2 * (n) * (n) + 9 * (n))

typedef enum {
    RODAS4_DONE,
    RODAS4_NOT_FINITE,     /* f or its Jacobian is NaN or infinite where the substep starts */
    RODAS4_STEP_TOO_SMALL, /* the error test fails down to rounding: stiff beyond hope, or a pole */
    RODAS4_TOO_MANY_STEPS
} Rodas4Result;

typedef struct {
    size_t accepted;
    size_t rejected;
    size_t worst_state; /* index of the state that spoiled the last substep */
    double reached;     /* time since the start of the call, s */
} Rodas4Report;

enum { RODAS4_MAX_SUBSTEPS = 100000 };

/* Carry x over `duration` > 0 exactly. `substep` holds the substep to try first (0: choose one)
 * and receives the one to try next; x is undefined unless RODAS4_DONE is returned. */
static Rodas4Result rodas4_integrate(const Rodas4 *solver, double duration, double *x,
                                     double *substep, Rodas4Report *report);

#endif
