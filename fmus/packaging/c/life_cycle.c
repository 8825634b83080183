/* Part of component.c: birth, modes and end of an instance, the same for plants and blocks. */

static char *copy_text(const char *text) {
    const char *source = text ? text : "";
    char *copy = malloc(strlen(source) + 1);
    if (copy) {
        memcpy(copy, source, strlen(source) + 1);
    }
    return copy;
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
    if (kind == KIND_MODEL_EXCHANGE && !OFFERS_MODEL_EXCHANGE) {
        component_log(component, STATUS_ERROR, LOG_ERROR,
                      "Instantiation refused: this FMU is for co-simulation only.");
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
    state->time = state->start_time = start_time;
    state->stop_time_defined = stop_time_defined;
    state->stop_time = stop_time_defined ? stop_time : 0.0;
    return STATUS_OK;
}

/* Importers add steps up or multiply them: the same time up to a few units in the last place of
 * the numbers that it was made of. */
static double time_slack(const State *state, double time, double step) {
    return 16.0 * DBL_EPSILON * (fabs(time) + fabs(state->start_time) + step);
}

static Status check_step(const Component *component, const char *call, double time, double step) {
    const State *state = &component->state;
    if (!(step > 0.0 && isfinite(step))) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step size is %g s, it must be above 0.", call, step);
    }
    if (!(fabs(time - state->time) <= time_slack(state, time, step))) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step starts at %.17g s, but the instance stands at %.17g s.",
                             call, time, state->time);
    }
    if (state->stop_time_defined && time + step > state->stop_time + time_slack(state, time, step)) {
        return component_log(component, STATUS_ERROR, LOG_ERROR,
                             "%s: the step ends at %.17g s, behind the stop time %.17g s.", call,
                             time + step, state->stop_time);
    }
    return STATUS_OK;
}
