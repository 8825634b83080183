#include "rodas4.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { STAGES = 6 };

static const double GAMMA = 0.25;

/* The stages U_i solve (I/(h GAMMA) - J) U_i = f(x + sum_j A_ij U_j) + sum_j C_ij U_j / h.
 * Stages 5 and 6 are reached by adding the stage before; U_6 is the error estimate. */
static const double A[STAGES][STAGES - 1] = {
    {0.0},
    {0.1544000000000000e+01},
    {0.9466785280815826e+00, 0.2557011698983284e+00},
    {0.3314825187068521e+01, 0.2896124015972201e+01, 0.9986419139977817e+00},
    {0.1221224509226641e+01, 0.6019134481288629e+01, 0.1253708332932087e+02,
     -0.6878860361058950e+00},
    {0.1221224509226641e+01, 0.6019134481288629e+01, 0.1253708332932087e+02,
     -0.6878860361058950e+00, 1.0},
};

static const double C[STAGES][STAGES - 1] = {
    {0.0},
    {-0.5668800000000000e+01},
    {-0.2430093356833875e+01, -0.2063599157091915e+00},
    {-0.1073529058151375e+00, -0.9594562251023355e+01, -0.2047028614809616e+02},
    {0.7496443313967647e+01, -0.1024680431464352e+02, -0.3399990352819905e+02,
     0.1170890893206160e+02},
    {0.8083246795921522e+01, -0.7981132988064893e+01, -0.3152159432874371e+02,
     0.1631930543123136e+02, -0.6058818238834054e+01},
};

/* The pieces of the caller's work array. */
typedef struct {
    double *jacobian, *factors, *stages, *dx, *argument, *right;
} Work;

static Work divide_work(const Rodas4 *solver) {
    const size_t n = solver->n;
    Work w;
    w.jacobian = solver->work;
    w.factors = w.jacobian + n * n;
    w.stages = w.factors + n * n;
    w.dx = w.stages + STAGES * n;
    w.argument = w.dx + n;
    w.right = w.argument + n;
    return w;
}

static bool all_finite(size_t n, const double *values, size_t *worst) {
    for (size_t i = 0; i < n; i++) {
        if (!isfinite(values[i])) {
            *worst = i;
            return false;
        }
    }
    return true;
}

/* Row of the entry of column k that is largest for its row's weight; false when there is none. */
static bool find_pivot(size_t n, const double *column, const double *weights, size_t k,
                       size_t *pivot) {
    double largest = 0.0;
    *pivot = k;
    for (size_t i = k; i < n; i++) {
        const double size = fabs(column[i]) * weights[i];
        if (size > largest) {
            largest = size;
            *pivot = i;
        }
    }
    return largest > 0.0 && isfinite(largest);
}

static void swap(double *a, double *b) {
    const double c = *a;
    *a = *b;
    *b = c;
}

/* a -= factor * b from entry `first` on; entries do not wait for one another. */
static void subtract(size_t first, size_t n, double *restrict a, double factor,
                     const double *restrict b) {
    for (size_t i = first; i < n; i++) {
        a[i] -= factor * b[i];
    }
}

/* LU factors of I/(h GAMMA) - J, column by column, with the inverses of the pivots in their places;
 * rows weighed by 1/scale when a pivot is chosen (they carry the units of their states). False when
 * the matrix is singular or not finite. */
static bool factorise(const Rodas4 *solver, const Work *w, double h) {
    const size_t n = solver->n;
    double *lu = w->factors;
    double *weights = w->right; /* free until the first stage */
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            lu[j * n + i] = -w->jacobian[i * n + j];
        }
        lu[i * n + i] += 1.0 / (h * GAMMA);
        weights[i] = 1.0 / solver->scale[i];
    }
    for (size_t k = 0; k < n; k++) {
        double *column = lu + k * n;
        if (!find_pivot(n, column, weights, k, &solver->pivots[k])) {
            return false;
        }
        if (solver->pivots[k] != k) {
            swap(&weights[k], &weights[solver->pivots[k]]);
            for (size_t j = 0; j < n; j++) {
                swap(&lu[j * n + k], &lu[j * n + solver->pivots[k]]);
            }
        }
        column[k] = 1.0 / column[k];
        for (size_t i = k + 1; i < n; i++) {
            column[i] *= column[k];
        }
        for (size_t j = k + 1; j < n; j++) {
            if (lu[j * n + k] != 0.0) {
                subtract(k + 1, n, lu + j * n, lu[j * n + k], column);
            }
        }
    }
    return true;
}

/* Solve with the factors; b becomes the solution. Rows were swapped whole, so the permutation
 * applies to b before the substitutions, which go by columns. */
static void solve(const Rodas4 *solver, const double *lu, double *b) {
    const size_t n = solver->n;
    for (size_t k = 0; k < n; k++) {
        swap(&b[k], &b[solver->pivots[k]]);
    }
    for (size_t k = 0; k < n; k++) {
        subtract(k + 1, n, b, b[k], lu + k * n);
    }
    for (size_t k = n; k-- > 0;) {
        b[k] *= lu[k * n + k];
        subtract(0, k, b, b[k], lu + k * n);
    }
}

/* All stages of one substep from x, with w->dx = f(x) and the factors at hand. Afterwards
 * w->argument is the new state and the last stage its error estimate. */
static void compute_stages(const Rodas4 *solver, const Work *w, const double *x, double h) {
    const size_t n = solver->n;
    for (size_t s = 0; s < STAGES; s++) {
        double *stage = w->stages + s * n;
        for (size_t i = 0; i < n; i++) {
            double sum = x[i];
            for (size_t j = 0; j < s; j++) {
                sum += A[s][j] * w->stages[j * n + i];
            }
            w->argument[i] = sum;
        }
        if (s == 0) {
            memcpy(w->right, w->dx, n * sizeof(double));
        } else {
            solver->derivatives(solver->context, w->argument, w->right);
        }
        for (size_t i = 0; i < n; i++) {
            double sum = 0.0;
            for (size_t j = 0; j < s; j++) {
                sum += C[s][j] * w->stages[j * n + i];
            }
            stage[i] = w->right[i] + sum / h;
        }
        solve(solver, w->factors, stage);
    }
    for (size_t i = 0; i < n; i++) {
        w->argument[i] += w->stages[(STAGES - 1) * n + i];
    }
}

/* Root mean square of error over tolerance; at most 1 is a success. Infinity for NaN. */
static double error_norm(const Rodas4 *solver, const Work *w, const double *x, size_t *worst) {
    const size_t n = solver->n;
    double sum = 0.0;
    double largest = -1.0;
    for (size_t i = 0; i < n; i++) {
        const double size = fmax(fabs(x[i]), fabs(w->argument[i]));
        const double weight = solver->relative_tolerance * (solver->scale[i] + size);
        const double part = w->stages[(STAGES - 1) * n + i] / weight;
        if (!isfinite(part) || !isfinite(w->argument[i])) {
            *worst = i;
            return INFINITY;
        }
        if (part * part > largest) {
            largest = part * part;
            *worst = i;
        }
        sum += part * part;
    }
    return sqrt(sum / (double)n);
}

/* A first substep from the speed of the states: one that moves them by a hundredth of scale. */
static double first_substep(const Rodas4 *solver, const Work *w, const double *x, double duration) {
    double speed = 0.0;
    for (size_t i = 0; i < solver->n; i++) {
        speed = fmax(speed, fabs(w->dx[i]) / (solver->scale[i] + fabs(x[i])));
    }
    return speed * duration > 0.01 ? 0.01 / speed : duration;
}

/* The substep that is really taken: the end is hit exactly, and no sliver is left before it. */
static double fit_substep(double h, double remaining) {
    if (h >= remaining) {
        return remaining;
    }
    return 2.0 * h > remaining ? 0.5 * remaining : h;
}

/* f and its Jacobian at x; false when one is not finite. */
static bool linearise_here(const Rodas4 *solver, const Work *w, const double *x, size_t *worst) {
    const size_t n = solver->n;
    solver->linearise(solver->context, x, w->dx, w->jacobian);
    if (!all_finite(n, w->dx, worst)) {
        return false;
    }
    if (!all_finite(n * n, w->jacobian, worst)) {
        *worst /= n; /* the row */
        return false;
    }
    return true;
}

/* One attempt over h: the new state in w->argument, its error norm returned. */
static double attempt(const Rodas4 *solver, const Work *w, const double *x, double h,
                      size_t *worst) {
    if (!factorise(solver, w, h)) {
        return INFINITY;
    }
    compute_stages(solver, w, x, h);
    return error_norm(solver, w, x, worst);
}

static Rodas4Result rodas4_integrate(const Rodas4 *solver, double duration, double *x,
                                     double *substep, Rodas4Report *report) {
    const Work w = divide_work(solver);
    const double smallest = 4.0 * DBL_EPSILON * duration;
    double h = *substep;
    bool rejected = false;
    memset(report, 0, sizeof *report);
    while (report->reached < duration) {
        const double remaining = duration - report->reached;
        if (!rejected && !linearise_here(solver, &w, x, &report->worst_state)) {
            return RODAS4_NOT_FINITE;
        }
        if (report->accepted + report->rejected >= RODAS4_MAX_SUBSTEPS) {
            return RODAS4_TOO_MANY_STEPS;
        }
        if (!(h > 0.0)) {
            h = first_substep(solver, &w, x, duration);
        }
        const double taken = fit_substep(h, remaining);
        const double error = attempt(solver, &w, x, taken, &report->worst_state);
        /* the embedded solution has order 3: error ~ h^4 */
        const double growth = fmin(6.0, fmax(0.2, 0.9 / sqrt(sqrt(fmax(error, 1e-10)))));
        if (error <= 1.0) {
            const double next = taken * (rejected ? fmin(growth, 1.0) : growth);
            memcpy(x, w.argument, solver->n * sizeof(double));
            report->accepted++;
            report->reached = taken < remaining ? report->reached + taken : duration;
            /* a substep cut short by the end says nothing against the longer one */
            h = taken < h ? fmax(h, next) : next;
            rejected = false;
        } else {
            report->rejected++;
            h = taken * fmin(growth, 0.9);
            rejected = true;
            if (h < smallest) {
                return RODAS4_STEP_TOO_SMALL;
            }
        }
    }
    *substep = h;
    return RODAS4_DONE;
}
