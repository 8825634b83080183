/* A discrete-time block behind the functions of component.h.
 *
 * Sample k is due at start + phase + k * sample time, counted in integer nanoseconds. A step over
 * [t, t + h) computes the samples that are due in it, in order, with the inputs as they stand, and
 * the outputs hold what the last of them wrote. Samples that fall on the end of the step belong to
 * the next one. */
#include "component.h"
#include "state.h"

#include <float.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Nothing is derived from the values, so nothing can be out of date. */
static void invalidate(Component *component) { (void)component; }

#include "logging.c"
#include "life_cycle.c"
#include "refusals.c"
#include "stored_state.c"
#include "reshape.c"

static Status component_reset(Component *component) {
    State *state = &component->state;
    const Kind kind = state->kind;
    memset(state, 0, sizeof *state); /* padding too: stored states are compared as bytes */
    state->kind = kind;
    state->mode = MODE_INSTANTIATED;
    state->relative_tolerance = MODEL_TOLERANCE;
    memcpy(state->values, model_start, N_VALUES * sizeof(double));
    return STATUS_OK;
}

static Status component_exit_initialization(Component *component, const char *call) {
    return component_change_mode(component, call, MODE_INITIALIZATION, MODE_STEP);
}

static Status component_get(Component *component, const char *call, const unsigned references[],
                            size_t n, double values[]) {
    const State *state = &component->state;
    if (n > 0 && (!references || !values)) {
        return null_argument(component, call);
    }
    for (size_t k = 0; k < n; k++) {
        if (references[k] >= END_REFERENCE) {
            return unknown_reference(component, call, references[k]);
        }
        values[k] = references[k] < INPUT_REFERENCE
                        ? state->time
                        : state->values[references[k] - INPUT_REFERENCE];
    }
    return STATUS_OK;
}

static Status check_set(const Component *component, const char *call, unsigned reference,
                        double value) {
    const bool before_run = (component->state.mode & MODES_BEFORE_RUN) != 0;
    if (reference >= END_REFERENCE) {
        return unknown_reference(component, call, reference);
    }
    if (!isfinite(value)) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: '%s' cannot be set to %g, values must be finite.", call,
                             model_names[reference], value);
    }
    if (reference < INPUT_REFERENCE) {
        return refuse_set(component, call, reference, "at all, it is calculated");
    }
    if (reference < OUTPUT_REFERENCE) {
        return STATUS_OK;
    }
    if (reference >= PARAMETER_REFERENCE && reference < STATE_REFERENCE) {
        return model_p_tunable[reference - PARAMETER_REFERENCE]
                   ? STATUS_OK
                   : refuse_set(component, call, reference, "at all, it is part of the design");
    }
    return before_run ? STATUS_OK
                      : refuse_set(component, call, reference, "by value after initialization");
}

static Status component_set(Component *component, const char *call, const unsigned references[],
                            size_t n, const double values[]) {
    if (n > 0 && (!references || !values)) {
        return null_argument(component, call);
    }
    for (size_t k = 0; k < n; k++) {
        if (check_set(component, call, references[k], values[k]) != STATUS_OK) {
            return STATUS_ERROR;
        }
    }
    for (size_t k = 0; k < n; k++) {
        component->state.values[references[k] - INPUT_REFERENCE] = values[k];
    }
    return STATUS_OK;
}

static int64_t nanoseconds(double seconds) { return (int64_t)llround(seconds * 1e9); }

/* Fail the step and keep the values before it. */
static Status fail(Component *component, const char *call, int64_t sample, const char *why) {
    component->state.mode = MODE_FAILED;
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: the sample at %.12g s failed: %s. The values are those before the "
                         "step.",
                         call, component->state.start_time + (double)sample * 1e-9, why);
}

/* One sample on the trial values. */
static Status compute_sample(Component *component, const char *call, int64_t sample) {
    char why[MESSAGE_SIZE / 2];
    double *const u = component->trial;
    double *const y = u + N_U;
    double *const p = y + N_Y;
    double *const x = p + N_P;
    if (block_step(p, x, u, y) != 0) {
        return fail(component, call, sample, "an operation on arrays of the step is not possible");
    }
    for (int i = 0; i < N_Y; i++) {
        if (!isfinite(y[i])) {
            snprintf(why, sizeof why, "output '%s' is %g", model_names[OUTPUT_REFERENCE + i],
                     y[i]);
            return fail(component, call, sample, why);
        }
    }
    return STATUS_OK;
}

static Status component_do_step(Component *component, const char *call, double time, double step) {
    State *state = &component->state;
    int64_t begin, end, samples = state->samples;
    if (component_check_mode(component, call, MODE_STEP) != STATUS_OK ||
        check_step(component, call, time, step) != STATUS_OK) {
        return STATUS_ERROR;
    }
    begin = nanoseconds(time - state->start_time);
    end = nanoseconds(time + step - state->start_time);
    /* The importer's time may have gathered rounding: a sample that is due within a thousandth
     * before the end of the step is meant to be at its end, and left to the next step. */
    end -= (end - begin < SAMPLE_TIME ? end - begin : SAMPLE_TIME) / 1000;
    if (SAMPLE_PHASE + samples * SAMPLE_TIME < end) {
        memcpy(component->trial, state->values, N_VALUES * sizeof(double));
        for (; SAMPLE_PHASE + samples * SAMPLE_TIME < end; samples++) {
            if (compute_sample(component, call, SAMPLE_PHASE + samples * SAMPLE_TIME) !=
                STATUS_OK) {
                return STATUS_ERROR;
            }
        }
        memcpy(state->values, component->trial, N_VALUES * sizeof(double));
    }
    component_log(component, STATUS_OK, LOG_SOLVER, "%s: %ld samples up to %.12g s.", call,
                  (long)(samples - state->samples), time + step);
    state->samples = samples;
    state->time = time + step;
    return STATUS_OK;
}

/* What the FMI layers offer for plants and a block has not: see the model description. */

static Status component_set_states(Component *component, const char *call, const double x[],
                                   size_t n) {
    (void)x, (void)n;
    return component_unsupported(component, call);
}

static Status component_get_states(const Component *component, const char *call, double x[],
                                   size_t n) {
    (void)x, (void)n;
    return component_unsupported(component, call);
}

static Status component_get_nominals(const Component *component, const char *call,
                                     double nominals[], size_t n) {
    (void)nominals, (void)n;
    return component_unsupported(component, call);
}

static Status component_get_derivatives(Component *component, const char *call, double dx[],
                                        size_t n) {
    (void)dx, (void)n;
    return component_unsupported(component, call);
}

static Status component_set_time(Component *component, const char *call, double time) {
    (void)time;
    return component_unsupported(component, call);
}

static Status component_directional(const Component *component, const char *call,
                                    const unsigned unknowns[], size_t n_unknowns,
                                    const unsigned knowns[], size_t n_knowns, const double seed[],
                                    double sensitivity[]) {
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)sensitivity;
    return component_unsupported(component, call);
}

#if FMI_VERSION == 3
static Status component_adjoint(const Component *component, const char *call,
                                const unsigned unknowns[], size_t n_unknowns,
                                const unsigned knowns[], size_t n_knowns, const double seed[],
                                double sensitivity[]) {
    (void)unknowns, (void)n_unknowns, (void)knowns, (void)n_knowns, (void)seed, (void)sensitivity;
    return component_unsupported(component, call);
}
#endif

static Status component_output_derivatives(Component *component, const char *call,
                                           const unsigned references[], size_t n,
                                           const int orders[], double values[]) {
    (void)references, (void)n, (void)orders, (void)values;
    return component_unsupported(component, call);
}
