/* Part of component.c: values by value reference, and whole vectors for model exchange. */

typedef enum { TIME, STATE, DERIVATIVE, INPUT, OUTPUT, PARAMETER, UNKNOWN } VariableClass;

/* The class of a variable, and its place among those of its class. */
static VariableClass classify(unsigned reference, size_t *index) {
    static const unsigned ends[] = {STATE_REFERENCE,  DERIVATIVE_REFERENCE, INPUT_REFERENCE,
                                    OUTPUT_REFERENCE, PARAMETER_REFERENCE,  END_REFERENCE};
    unsigned begin = 0;
    for (int k = TIME; k < UNKNOWN; k++) {
        if (reference < ends[k]) {
            *index = reference - begin;
            return (VariableClass)k;
        }
        begin = ends[k];
    }
    *index = 0;
    return UNKNOWN;
}

static void update_outputs(Component *component) {
    if (!component->outputs_valid) {
        const State *state = &component->state;
        model_outputs(state->x, state->u, state->p, component->y);
        component->outputs_valid = true;
    }
}

static void update_invariants(Component *component) {
    if (!component->invariants_valid) {
        model_invariants(component->state.u, component->state.p, component->invariants);
        component->invariants_valid = true;
    }
}

static void update_derivatives(Component *component) {
    if (!component->derivatives_valid) {
        const State *state = &component->state;
        update_invariants(component);
        model_derivatives(state->x, state->u, state->p, component->invariants, component->dx);
        component->derivatives_valid = true;
    }
}

static Status component_get(Component *component, const char *call, const unsigned references[],
                            size_t n, double values[]) {
    const State *state = &component->state;
    if (n > 0 && (!references || !values)) {
        return null_argument(component, call);
    }
    for (size_t k = 0; k < n; k++) {
        size_t i;
        switch (classify(references[k], &i)) {
        case TIME:
            values[k] = state->time;
            break;
        case STATE:
            values[k] = state->x[i];
            break;
        case DERIVATIVE:
            update_derivatives(component);
            values[k] = component->dx[i];
            break;
        case INPUT:
            values[k] = state->u[i];
            break;
        case OUTPUT:
            update_outputs(component);
            values[k] = component->y[i];
            break;
        case PARAMETER:
            values[k] = state->p[i];
            break;
        case UNKNOWN:
            return unknown_reference(component, call, references[k]);
        }
    }
    return STATUS_OK;
}

/* Tunable parameters are taken in continuous-time mode, too, where the standards leave it open what
 * happens: importers that evaluate functions of (x, u, p) set all of them there. */
static Status check_parameter(const Component *component, const char *call, unsigned reference,
                              size_t i, double value) {
    const Mode mode = component->state.mode;
    if (!(mode & MODES_BEFORE_RUN) && !model_p_tunable[i]) {
        return refuse_set(component, call, reference, "after initialization, it is fixed");
    }
    if (!(value >= model_p_minimum[i] && value <= model_p_maximum[i])) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: '%s' = %.17g lies outside of its range from %.17g to %.17g.",
                             call, model_names[reference], value, model_p_minimum[i],
                             model_p_maximum[i]);
    }
    return STATUS_OK;
}

/* Continuous states may be set wherever their value is the importer's business. */
#if FMI_VERSION == 3
enum { MODES_TO_SET_STATES = MODES_BEFORE_RUN | MODE_CONTINUOUS_TIME | MODE_EVENT };
#else
enum { MODES_TO_SET_STATES = MODES_BEFORE_RUN | MODE_CONTINUOUS_TIME };
#endif

static Status check_set(const Component *component, const char *call, unsigned reference,
                        double value) {
    size_t i;
    const VariableClass variable_class = classify(reference, &i);
    if (variable_class == UNKNOWN) {
        return unknown_reference(component, call, reference);
    }
    if (!isfinite(value)) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: '%s' cannot be set to %g, values must be finite.", call,
                             model_names[reference], value);
    }
    switch (variable_class) {
    case STATE:
        return component->state.mode & MODES_TO_SET_STATES
                   ? STATUS_OK
                   : refuse_set(component, call, reference, "by value after initialization");
    case INPUT:
        return STATUS_OK;
    case PARAMETER:
        return check_parameter(component, call, reference, i, value);
    default:
        return refuse_set(component, call, reference, "at all, it is calculated");
    }
}

static Status component_set(Component *component, const char *call, const unsigned references[],
                            size_t n, const double values[]) {
    State *state = &component->state;
    if (n > 0 && (!references || !values)) {
        return null_argument(component, call);
    }
    for (size_t k = 0; k < n; k++) {
        if (check_set(component, call, references[k], values[k]) != STATUS_OK) {
            return STATUS_ERROR;
        }
    }
    for (size_t k = 0; k < n; k++) {
        size_t i;
        switch (classify(references[k], &i)) {
        case STATE:
            state->x[i] = values[k];
            break;
        case INPUT:
            state->u[i] = values[k];
            break;
        case PARAMETER:
            state->p[i] = values[k];
            break;
        default:
            break;
        }
    }
    invalidate(component);
    return STATUS_OK;
}

static Status check_vector(const Component *component, const char *call, const double *values,
                           size_t n, int legal) {
    if (component_check_kind(component, call, KIND_MODEL_EXCHANGE) != STATUS_OK ||
        component_check_mode(component, call, legal) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (n != N_X) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: got %lu values, the model has %d continuous states.", call,
                             (unsigned long)n, N_X);
    }
    return n > 0 && !values ? null_argument(component, call) : STATUS_OK;
}

static Status component_set_states(Component *component, const char *call, const double x[],
                                   size_t n) {
    if (check_vector(component, call, x, n, MODE_CONTINUOUS_TIME) != STATUS_OK) {
        return STATUS_ERROR;
    }
    if (n > 0) {
        memcpy(component->state.x, x, n * sizeof(double));
    }
    invalidate_results(component);
    return STATUS_OK;
}

enum { MODES_TO_READ_STATES = MODES_WITH_EQUATIONS | MODE_FAILED };

static Status component_get_states(const Component *component, const char *call, double x[],
                                   size_t n) {
    const Status status = check_vector(component, call, x, n, MODES_TO_READ_STATES);
    if (status == STATUS_OK && n > 0) {
        memcpy(x, component->state.x, n * sizeof(double));
    }
    return status;
}

static Status component_get_nominals(const Component *component, const char *call,
                                     double nominals[], size_t n) {
    const int legal = MODES_TO_READ_STATES | MODE_INSTANTIATED;
    const Status status = check_vector(component, call, nominals, n, legal);
    if (status == STATUS_OK && n > 0) {
        memcpy(nominals, model_x_nominal, n * sizeof(double));
    }
    return status;
}

static Status component_get_derivatives(Component *component, const char *call, double dx[],
                                        size_t n) {
    const Status status = check_vector(component, call, dx, n, MODES_TO_READ_STATES);
    if (status == STATUS_OK && n > 0) {
        update_derivatives(component);
        memcpy(dx, component->dx, n * sizeof(double));
        for (size_t i = 0; i < n; i++) {
            if (!isfinite(dx[i])) {
                return component_log(component, STATUS_DISCARD, LOG_WARNING, "%s: '%s' is %g.",
                                     call, model_names[DERIVATIVE_REFERENCE + i], dx[i]);
            }
        }
    }
    return status;
}

static Status component_set_time(Component *component, const char *call, double time) {
    if (component_check_kind(component, call, KIND_MODEL_EXCHANGE) != STATUS_OK ||
        component_check_mode(component, call, MODE_EVENT | MODE_CONTINUOUS_TIME) != STATUS_OK) {
        return STATUS_ERROR;
    }
    component->state.time = time;
    return STATUS_OK;
}
