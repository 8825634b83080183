/* Rodas5P: a stiffly accurate, L-stable Rosenbrock method of order 5 with an embedded solution of
 * order 4 (G. Steinebach, Construction of Rosenbrock-Wanner method Rodas5P and numerical
 * benchmarks within the Julia Differential Equations package, BIT Numer. Math. 63:27, 2023).
 *
 *     dx/dt = f(x, u, p),   inputs u and parameters p held during the call
 *
 * Whoever includes this defines first, for one model,
 *     N_X, N_STATE_JACOBIAN, N_FACTORS,
 *     model_x_nominal[], model_state_jacobian_rows[],
 *     model_derivatives(x, u, p, invariants, dx), invariants being those of model_invariants(u, p),
 *     model_linearise(x, u, p, invariants, dx, jacobian) df/dx, exact, its nonzeros by columns,
 *     model_factorise(jacobian, diagonal, factors) diagonal I - df/dx, pivots' inverses first,
 *     model_solve(factors, right, solution).
 *
 * The local error of a substep stays below a quarter of relative_tolerance * (nominal_i + |x_i|) in
 * every state i. */
#ifndef RODAS5P_H
#define RODAS5P_H

#include <stddef.h>

typedef struct {
    const double *u, *p, *invariants;
    double relative_tolerance;
} Rodas5p;

typedef enum {
    RODAS5P_DONE,
    RODAS5P_NOT_FINITE,     /* f or its Jacobian is NaN or infinite where the substep starts */
    RODAS5P_STEP_TOO_SMALL, /* the error test fails down to rounding: stiff beyond hope, or a pole */
    RODAS5P_TOO_MANY_STEPS
} Rodas5pResult;

typedef struct {
    size_t accepted;
    size_t rejected;
    size_t worst_state; /* index of the state that spoiled the last substep */
    double reached;     /* time since the start of the call, s */
} Rodas5pReport;

enum { RODAS5P_MAX_SUBSTEPS = 100000 };

/* Carry x over `duration` > 0 exactly. `substep` holds the substep to try first (0: choose one)
 * and receives the one to try next; x is undefined unless RODAS5P_DONE is returned. */
static Rodas5pResult rodas5p_integrate(const Rodas5p *solver, double duration, double *x,
                                       double *substep, Rodas5pReport *report);

#endif
