/* Four ways to carry the states of one plant over samples with inputs held, on the very functions
 * that its FMU evaluates: the FMU's Rodas5P, RODAS4 (Hairer and Wanner, section IV.7) with the same
 * linear algebra and error control, SUNDIALS' CVODE begun anew at each sample, and the bare
 * right-hand side for others. Compiled in a folder with the generated model.c and the solver. */
#define _POSIX_C_SOURCE 200809L
#include "model.c"
#include "rodas5p.c"

#include <time.h>

#define EXPORT __attribute__((visibility("default")))
#define MANY 1000000 /* substeps of one sample before a method is said to have failed */

static const double *u;
static double invariants[N_INVARIANTS + 1];

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static void hold(const double *inputs) {
    u = inputs;
    model_invariants(u, model_p_start, invariants);
}

static int rodas5p(double duration, double tolerance, double *x, double *substep) {
    const Rodas5p solver = {u, model_p_start, invariants, tolerance};
    Rodas5pReport report;
    return (int)rodas5p_integrate(&solver, duration, x, substep, &report);
}

enum { STAGES_4 = 6 };
static const double A_4[STAGES_4][STAGES_4 - 1] = {
    {0.0},
    {1.544},
    {0.9466785280815826, 0.2557011698983284},
    {3.314825187068521, 2.896124015972201, 0.9986419139977817},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950},
    {1.221224509226641, 6.019134481288629, 12.53708332932087, -0.6878860361058950, 1.0},
};
static const double C_4[STAGES_4][STAGES_4 - 1] = {
    {0.0},
    {-5.6688},
    {-2.430093356833875, -0.2063599157091915},
    {-0.1073529058151375, -9.594562251023355, -20.47028614809616},
    {7.496443313967647, -10.24680431464352, -33.99990352819905, 11.70890893206160},
    {8.083246795921522, -7.981132988064893, -31.52159432874371, 16.31930543123136,
     -6.058818238834054},
};

/* One substep from x over h with the Jacobian in w; the new state in w->argument. */
static void stages_4(Work *w, const double *x, double h) {
    const double diagonal = 1.0 / (0.25 * h);
    model_factorise(w->jacobian, &diagonal, w->factors);
    for (int s = 0; s < STAGES_4; s++) {
        double sum[N_X + 1] = {0.0};
        memcpy(w->argument, x, N_X * sizeof(double));
        for (int j = 0; j < s; j++) {
            add(w->argument, A_4[s][j], w->stages[j]);
            add(sum, C_4[s][j], w->stages[j]);
        }
        model_derivatives(w->argument, u, model_p_start, invariants, w->right);
        add(w->right, 1.0 / h, sum);
        model_solve(w->factors, w->right, w->stages[s]);
    }
    memcpy(w->stages[STAGES - 1], w->stages[STAGES_4 - 1], N_X * sizeof(double));
    add(w->argument, 1.0, w->stages[STAGES_4 - 1]);
}

static int rodas4(double duration, double tolerance, double *x, double *substep) {
    const Rodas5p weights = {u, model_p_start, invariants, tolerance};
    double h = *substep > 0.0 ? *substep : 1e-3 * duration, reached = 0.0;
    Work w;
    for (int tries = 0; reached < duration && tries < MANY; tries++) {
        const double remaining = duration - reached, taken = fit_substep(h, remaining);
        size_t worst;
        model_linearise(x, u, model_p_start, invariants, w.dx, w.jacobian);
        stages_4(&w, x, taken);
        const double error = error_norm(&weights, &w, x, &worst);
        h = taken * fmin(6.0, fmax(0.2, 0.8 * pow(fmax(error, 1e-10), -0.25)));
        if (error <= 1.0) {
            memcpy(x, w.argument, N_X * sizeof(double));
            reached = taken < remaining ? reached + taken : duration;
        }
    }
    *substep = h;
    return reached < duration;
}

typedef int (*Method)(double duration, double tolerance, double *x, double *substep);

/* n samples of `step` seconds from x, inputs[k] over sample k: the states after each, and its
 * nanoseconds. 0, or 1 more than the sample that failed. `order` is 4 or 5. */
EXPORT int rosenbrock(int order, double tolerance, double step, int n, const double *inputs,
                      double *x, double *states, double *nanoseconds) {
    const Method method = order == 5 ? rodas5p : rodas4;
    double substep = 0.0;
    for (int k = 0; k < n; k++) {
        const double began = now();
        hold(inputs + k * N_U);
        if (method(step, tolerance, x, &substep) != 0) return k + 1;
        nanoseconds[k] = now() - began;
        memcpy(states + k * N_X, x, N_X * sizeof(double));
    }
    return 0;
}

/* SUNDIALS, made ready by the caller; serial vectors and dense matrices by columns. */
typedef struct {
    void *memory, *vector;
    double *(*vector_data)(void *), *(*matrix_data)(void *);
    int (*begin)(void *, double, void *), (*set_stop)(void *, double);
    int (*solve)(void *, double, void *, double *, int);
} Sundials;
static Sundials sundials;

EXPORT void use_sundials(const Sundials *with) {
    sundials = *with;
}

EXPORT int cvode_rhs(double t, void *y, void *dy, void *unused) {
    (void)t, (void)unused;
    model_derivatives(sundials.vector_data(y), u, model_p_start, invariants,
                      sundials.vector_data(dy));
    return 0;
}

/* df/dx into a zeroed matrix of N_X columns. */
static void dense(const double *x, double *dx, double *matrix) {
    double nonzeros[N_STATE_JACOBIAN + 1];
    model_linearise(x, u, model_p_start, invariants, dx, nonzeros);
    for (int j = 0, i = 0; j < N_X; j++) {
        for (int k = model_jacobian_starts[j]; k < model_jacobian_starts[j + 1]; k++) {
            if (model_jacobian_rows[k] < N_X) matrix[j * N_X + model_jacobian_rows[k]] = nonzeros[i++];
        }
    }
}

EXPORT int cvode_jacobian(double t, void *y, void *fy, void *matrix, void *unused, void *a, void *b,
                          void *c) {
    double dx[N_X + 1];
    (void)t, (void)fy, (void)unused, (void)a, (void)b, (void)c;
    dense(sundials.vector_data(y), dx, sundials.matrix_data(matrix));
    return 0;
}

EXPORT int cvode(double step, int n, const double *inputs, double *states, double *nanoseconds) {
    double reached;
    for (int k = 0; k < n; k++) {
        const double began = now();
        hold(inputs + k * N_U);
        if (sundials.begin(sundials.memory, 0.0, sundials.vector) != 0 ||
            sundials.set_stop(sundials.memory, step) != 0 ||
            sundials.solve(sundials.memory, step, sundials.vector, &reached, 1) < 0) {
            return k + 1;
        }
        nanoseconds[k] = now() - began;
        memcpy(states + k * N_X, sundials.vector_data(sundials.vector), N_X * sizeof(double));
    }
    return 0;
}

/* f into dx (N_X) and its Jacobian by columns into `matrix`, for inputs held before. */
EXPORT void hold_inputs(const double *inputs) {
    hold(inputs);
}

EXPORT void rhs(const double *x, double *dx) {
    model_derivatives(x, u, model_p_start, invariants, dx);
}

EXPORT void jacobian(const double *x, double *matrix) {
    double dx[N_X + 1];
    memset(matrix, 0, N_X * N_X * sizeof(double));
    dense(x, dx, matrix);
}
