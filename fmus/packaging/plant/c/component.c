#include "component.h"
#include "state.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* After whatever changes the states only. */
static void invalidate_results(Component *component) {
    component->outputs_valid = false;
    component->derivatives_valid = false;
}

/* After whatever changes inputs or parameters, too. */
static void invalidate(Component *component) {
    invalidate_results(component);
    component->invariants_valid = false;
}

#include "logging.c"
#include "life_cycle.c"
#include "refusals.c"
#include "variables.c"
#include "derivatives.c"
#include "stored_state.c"

static Status component_reset(Component *component) {
    State *state = &component->state;
    const Kind kind = state->kind;
    memset(state, 0, sizeof *state); /* padding too: stored states are compared as bytes */
    state->kind = kind;
    state->mode = MODE_INSTANTIATED;
    state->relative_tolerance = MODEL_TOLERANCE;
    memcpy(state->x, model_x_start, N_X * sizeof(double));
    memcpy(state->u, model_u_start, N_U * sizeof(double));
    memcpy(state->p, model_p_start, N_P * sizeof(double));
    invalidate(component);
    return STATUS_OK;
}

static Status component_exit_initialization(Component *component, const char *call) {
    const bool stepped = component->state.kind == KIND_CO_SIMULATION;
    if (component_check_mode(component, call, MODE_INITIALIZATION) != STATUS_OK) {
        return STATUS_ERROR;
    }
    update_derivatives(component);
    for (int i = 0; i < N_X; i++) {
        if (!isfinite(component->dx[i])) {
            return component_log(component, STATUS_ERROR, LOG_ERROR,
                                 "%s: %s is %g with the initial values.", call,
                                 model_names[DERIVATIVE_REFERENCE + i], component->dx[i]);
        }
    }
    return component_change_mode(component, call, MODE_INITIALIZATION,
                                 stepped ? MODE_STEP : MODE_EVENT);
}

static const char *reason(Rodas5pResult result) {
    switch (result) {
    case RODAS5P_DONE: return "done";
    case RODAS5P_NOT_FINITE: return "the equations yield NaN or infinity";
    case RODAS5P_STEP_TOO_SMALL: return "the error test fails down to the smallest substep";
    case RODAS5P_TOO_MANY_STEPS: return "the limit of substeps is reached";
    }
    return "unknown";
}

static Status component_do_step(Component *component, const char *call, double time, double step) {
    State *state = &component->state;
    double x[N_X + 1];
    double substep = state->substep;
    Rodas5pReport report = {0, 0, 0, 0.0};
    const Rodas5p solver = {state->u, state->p, component->invariants, state->relative_tolerance};
    if (component_check_mode(component, call, MODE_STEP) != STATUS_OK ||
        check_step(component, call, time, step) != STATUS_OK) {
        return STATUS_ERROR;
    }
    memcpy(x, state->x, sizeof x);
    if (N_X > 0) {
        update_invariants(component);
        const Rodas5pResult result = rodas5p_integrate(&solver, step, x, &substep, &report);
        if (result != RODAS5P_DONE) {
            state->mode = MODE_FAILED;
            return component_log(
                component, STATUS_ERROR, LOG_ERROR,
                "%s: the step from %.12g s over %.12g s failed at %.12g s: %s (state '%s'). "
                "The values are those before the step.",
                call, time, step, time + report.reached, reason(result),
                model_names[STATE_REFERENCE + report.worst_state]);
        }
    }
    memcpy(state->x, x, sizeof x);
    state->substep = substep;
    state->time = time + step;
    invalidate_results(component);
    if (component->log_categories & LOG_SOLVER) {
        component_log(component, STATUS_OK, LOG_SOLVER,
                      "%s: at %.12g s after %lu substeps and %lu rejected ones.", call,
                      state->time, (unsigned long)report.accepted,
                      (unsigned long)report.rejected);
    }
    return STATUS_OK;
}
