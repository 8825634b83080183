#include "rodas5p.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { STAGES = 8 };

static const double GAMMA = 0.21193756319429014;

/* The stages U_i solve (I/(h GAMMA) - J) U_i = f(x + sum_j A_ij U_j) + sum_j C_ij U_j / h.
 * Stages 7 and 8 are reached by adding the stage before; U_8 is the error estimate. */
static const double A[STAGES - 2][STAGES - 3] = {
    {0.0},
    {3.0},
    {2.849394379747939, 0.45842242204463923},
    {-6.954028509809101, 2.489845061869568, -10.358996098473584},
    {2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641},
    {-7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
     0.030198172008377946},
};

static const double C[STAGES][STAGES - 1] = {
    {0.0},
    {-14.155112264123755},
    {-17.97296035885952, -2.859693295451294},
    {147.12150275711716, -1.41221402718213, 71.68940251302358},
    {165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306},
    {24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125,
     -0.6610691825249471},
    {30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783,
     -19.097331116725623, -28.087943162872662},
    {37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
     -40.06618937091002, -54.66780262877968, -9.48861652309627},
};

/* A pivot this far below I/(h GAMMA) has lost its digits to cancellation. */
static const double SMALLEST_PIVOT = 1e-6;

/* The errors of substeps add up, and pressures grow out of errors of mass: a quarter of the
 * tolerance each leaves every state of our plants within ten times the tolerance. */
static const double SHARE = 0.25;

/* The + 1 only keeps empty arrays legal. */
typedef struct {
    double dx[N_X + 1];
    double jacobian[N_STATE_JACOBIAN + 1];
    double factors[N_FACTORS + 1];
    double stages[STAGES][N_X + 1];
    double argument[N_X + 1];
    double right[N_X + 1];
} Work;

static double larger(double a, double b) {
    return a > b ? a : b;
}

/* f and its Jacobian at x; false when one is not finite. */
static bool linearise_here(const Rodas5p *solver, Work *w, const double *x, size_t *worst) {
    model_linearise(x, solver->u, solver->p, solver->invariants, w->dx, w->jacobian);
    for (int i = 0; i < N_X; i++) {
        if (!isfinite(w->dx[i])) {
            *worst = (size_t)i;
            return false;
        }
    }
    for (int k = 0; k < N_STATE_JACOBIAN; k++) {
        if (!isfinite(w->jacobian[k])) {
            *worst = (size_t)model_state_jacobian_rows[k];
            return false;
        }
    }
    return true;
}

/* Factors of I/(h GAMMA) - J; false when a pivot is all but lost, or not finite. */
static bool factorise(Work *w, double h) {
    const double diagonal = 1.0 / (h * GAMMA);
    model_factorise(w->jacobian, &diagonal, w->factors);
    for (int i = 0; i < N_X; i++) {
        if (!(fabs(w->factors[i]) * diagonal * SMALLEST_PIVOT <= 1.0)) {
            return false;
        }
    }
    return true;
}

/* a += factor * b */
static void add(double *restrict a, double factor, const double *restrict b) {
    for (int i = 0; i < N_X; i++) {
        a[i] += factor * b[i];
    }
}

/* All stages of one substep from x, with w->dx = f(x) and the factors at hand. Afterwards
 * w->argument is the new state and the last stage its error estimate. */
static void compute_stages(const Rodas5p *solver, Work *w, const double *x, double h) {
    const double rate = 1.0 / h;
    memcpy(w->right, w->dx, N_X * sizeof(double));
    model_solve(w->factors, w->right, w->stages[0]);
    for (int s = 1; s < STAGES; s++) {
        double sum[N_X + 1] = {0.0};
        if (s < STAGES - 2) {
            memcpy(w->argument, x, N_X * sizeof(double));
            for (int j = 0; j < s; j++) {
                add(w->argument, A[s][j], w->stages[j]);
            }
        } else {
            add(w->argument, 1.0, w->stages[s - 1]);
        }
        for (int j = 0; j < s; j++) {
            add(sum, C[s][j], w->stages[j]);
        }
        model_derivatives(w->argument, solver->u, solver->p, solver->invariants, w->right);
        add(w->right, rate, sum);
        model_solve(w->factors, w->right, w->stages[s]);
    }
    add(w->argument, 1.0, w->stages[STAGES - 1]);
}

/* Largest error over its tolerance; at most 1 is a success. Infinity for NaN. */
static double error_norm(const Rodas5p *solver, const Work *w, const double *x, size_t *worst) {
    double largest = -1.0;
    for (int i = 0; i < N_X; i++) {
        const double size = larger(fabs(x[i]), fabs(w->argument[i]));
        const double weight = SHARE * solver->relative_tolerance * (model_x_nominal[i] + size);
        const double part = fabs(w->stages[STAGES - 1][i]) / weight;
        if (!isfinite(part) || !isfinite(w->argument[i])) {
            *worst = (size_t)i;
            return INFINITY;
        }
        if (part > largest) {
            largest = part;
            *worst = (size_t)i;
        }
    }
    return largest;
}

/* One attempt over h: the new state in w->argument, its error norm returned. */
static double attempt(const Rodas5p *solver, Work *w, const double *x, double h, size_t *worst) {
    if (!factorise(w, h)) {
        return INFINITY;
    }
    compute_stages(solver, w, x, h);
    return error_norm(solver, w, x, worst);
}

/* A first substep from the speed of the states: one that moves them by a hundredth of nominal. */
static double first_substep(const Work *w, const double *x, double duration) {
    double speed = 0.0;
    for (int i = 0; i < N_X; i++) {
        speed = larger(speed, fabs(w->dx[i]) / (model_x_nominal[i] + fabs(x[i])));
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

/* How the next substep compares with this one: the embedded solution has order 4, error ~ h^5.
 * 0.8 lets few substeps fail and, for the same work, holds the error better than 0.9. */
static double growth_after(double error) {
    return fmin(6.0, fmax(0.2, 0.8 * pow(fmax(error, 1e-10), -0.2)));
}

static Rodas5pResult rodas5p_integrate(const Rodas5p *solver, double duration, double *x,
                                       double *substep, Rodas5pReport *report) {
    Work w;
    const double smallest = 4.0 * DBL_EPSILON * duration;
    double h = *substep;
    bool rejected = false;
    memset(report, 0, sizeof *report);
    while (report->reached < duration) {
        const double remaining = duration - report->reached;
        if (!rejected && !linearise_here(solver, &w, x, &report->worst_state)) {
            return RODAS5P_NOT_FINITE;
        }
        if (report->accepted + report->rejected >= RODAS5P_MAX_SUBSTEPS) {
            return RODAS5P_TOO_MANY_STEPS;
        }
        if (!(h > 0.0)) {
            h = first_substep(&w, x, duration);
        }
        const double taken = fit_substep(h, remaining);
        const double error = attempt(solver, &w, x, taken, &report->worst_state);
        const double growth = growth_after(error);
        if (error <= 1.0) {
            const double next = taken * (rejected ? fmin(growth, 1.0) : growth);
            memcpy(x, w.argument, N_X * sizeof(double));
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
                return RODAS5P_STEP_TOO_SMALL;
            }
        }
    }
    *substep = h;
    return RODAS5P_DONE;
}
