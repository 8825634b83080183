#include "component.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "logging.c"
#include "variables.c"
#include "derivatives.c"
#include "stored_state.c"

static void invalidate(Component *component) {
    component->outputs_valid = false;
    component->derivatives_valid = false;
}

static char *copy_text(const char *text) {
    const char *source = text ? text : "";
    char *copy = malloc(strlen(source) + 1);
    if (copy) {
        memcpy(copy, source, strlen(source) + 1);
    }
    return copy;
}

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

static Component *component_new(const char *name, const char *token, Kind kind, LogSink sink,
                                void *environment, void (*logger)(void), bool logging_on) {
    Component *component = calloc(1, sizeof *component);
    if (!component) {
        return NULL;
    }
    component->name = copy_text(name);
    component->log_sink = sink;
    component->environment = environment;
    component->logger = logger;
    component->log_categories = logging_on ? LOG_EVENTS | LOG_SOLVER : 0;
    if (!component->name) {
        component_free(component);
        return NULL;
    }
    if (!token || strcmp(token, MODEL_TOKEN) != 0) {
        component_log(component, STATUS_ERROR, LOG_ERROR,
                      "Instantiation refused: the token is %s, this FMU has %s.",
                      token ? token : "NULL", MODEL_TOKEN);
        component_free(component);
        return NULL;
    }
    component->state.kind = kind;
    component_reset(component);
    component_log(component, STATUS_OK, LOG_EVENTS, "Instantiated for %s.",
                  kind == KIND_CO_SIMULATION ? "co-simulation" : "model exchange");
    return component;
}

static void component_free(Component *component) {
    if (component) {
        free(component->name);
        free(component);
    }
}

static const char *mode_name(Mode mode) {
    switch (mode) {
    case MODE_INSTANTIATED: return "instantiated";
    case MODE_INITIALIZATION: return "initialization mode";
    case MODE_EVENT: return "event mode";
    case MODE_CONTINUOUS_TIME: return "continuous-time mode";
    case MODE_STEP: return "step mode";
    case MODE_FAILED: return "failed";
    case MODE_TERMINATED: return "terminated";
    }
    return "unknown";
}

static Status component_check_mode(const Component *component, const char *call, int legal) {
    if (component->state.mode & legal) {
        return STATUS_OK;
    }
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: not allowed while the instance is in the state '%s'.", call,
                         mode_name(component->state.mode));
}

static Status component_check_kind(const Component *component, const char *call, Kind kind) {
    if (component->state.kind == kind) {
        return STATUS_OK;
    }
    return component_log(component, STATUS_ERROR, LOG_ERROR, "%s: only for %s.", call,
                         kind == KIND_CO_SIMULATION ? "co-simulation" : "model exchange");
}

static Status component_change_mode(Component *component, const char *call, int legal, Mode next) {
    const Status status = component_check_mode(component, call, legal);
    if (status == STATUS_OK) {
        component->state.mode = next;
        component_log(component, STATUS_OK, LOG_EVENTS, "%s: entered the state '%s' at %.12g s.",
                      call, mode_name(next), component->state.time);
    }
    return status;
}

static Status component_setup(Component *component, const char *call, bool tolerance_defined,
                              double tolerance, double start_time, bool stop_time_defined,
                              double stop_time) {
    State *state = &component->state;
    if (component_check_mode(component, call, MODE_INSTANTIATED) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (tolerance_defined && !(tolerance > 0.0 && tolerance < 1.0)) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the tolerance is %g, it must lie between 0 and 1.", call,
                             tolerance);
    }
    if (!isfinite(start_time) || (stop_time_defined && !(stop_time >= start_time))) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: stop time %g s does not follow start time %g s.", call,
                             stop_time, start_time);
    }
    state->relative_tolerance = tolerance_defined ? tolerance : MODEL_TOLERANCE;
    state->time = start_time;
    state->stop_time_defined = stop_time_defined;
    state->stop_time = stop_time_defined ? stop_time : 0.0;
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

/* Times are reals that importers often accumulate; equal means equal up to that. */
static double time_slack(double time) { return 1e-9 * (1.0 + fabs(time)); }

static Status check_step(const Component *component, const char *call, double time, double step) {
    const State *state = &component->state;
    if (!(step > 0.0 && isfinite(step))) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step size is %g s, it must be above 0.", call, step);
    }
    if (!(fabs(time - state->time) <= time_slack(time))) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step starts at %.12g s, but the instance stands at %.12g s.",
                             call, time, state->time);
    }
    if (state->stop_time_defined && time + step > state->stop_time + time_slack(time + step)) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step ends at %.12g s, behind the stop time %.12g s.", call,
                             time + step, state->stop_time);
    }
    return STATUS_OK;
}

static void solver_derivatives(const void *context, const double *x, double *dx) {
    const State *state = context;
    model_derivatives(x, state->u, state->p, dx);
}

static void solver_linearise(const void *context, const double *x, double *dx, double *jacobian) {
    const State *state = context;
    model_linearise(x, state->u, state->p, dx, jacobian);
}

static const char *reason(Rodas4Result result) {
    switch (result) {
    case RODAS4_DONE: return "done";
    case RODAS4_NOT_FINITE: return "the equations yield NaN or infinity";
    case RODAS4_STEP_TOO_SMALL: return "the error test fails down to the smallest substep";
    case RODAS4_TOO_MANY_STEPS: return "the limit of substeps is reached";
    }
    return "unknown";
}

static Status component_do_step(Component *component, const char *call, double time, double step) {
    State *state = &component->state;
    double x[N_X + 1];
    double substep = state->substep;
    Rodas4Report report = {0, 0, 0, 0.0};
    Rodas4 solver = {N_X, state, solver_derivatives, solver_linearise, 0.0, model_x_nominal,
                     component->solver_work, component->pivots};
    if (component_check_mode(component, call, MODE_STEP) != STATUS_OK ||
        check_step(component, call, time, step) != STATUS_OK) {
        return STATUS_ERROR;
    }
    solver.relative_tolerance = state->relative_tolerance;
    memcpy(x, state->x, sizeof x);
    if (N_X > 0) {
        const Rodas4Result result = rodas4_integrate(&solver, step, x, &substep, &report);
        if (result != RODAS4_DONE) {
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
    invalidate(component);
    if (component->log_categories & LOG_SOLVER) {
        component_log(component, STATUS_OK, LOG_SOLVER,
                      "%s: at %.12g s after %lu substeps and %lu rejected ones.", call,
                      state->time, (unsigned long)report.accepted,
                      (unsigned long)report.rejected);
    }
    return STATUS_OK;
}
