/* Part of component.c: calls about variables that are refused, the same for plants and blocks. */

static Status null_argument(const Component *component, const char *call) {
    return component_log(component, STATUS_ERROR, LOG_ERROR, "%s: an array is NULL.", call);
}

static Status unknown_reference(const Component *component, const char *call, unsigned reference) {
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: there is no real variable with value reference %u; the last is %d.",
                         call, reference, (int)END_REFERENCE - 1);
}

/* For the getters and setters of types that no variable has. */
static Status component_no_variable(const Component *component, const char *call,
                                    const unsigned references[]) {
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: value reference %u is no variable of this type, all are real.", call,
                         references ? references[0] : 0u);
}

static Status refuse_set(const Component *component, const char *call, unsigned reference,
                         const char *why) {
    return component_log(component, STATUS_ERROR, LOG_ERROR, "%s: '%s' cannot be set %s.", call,
                         model_names[reference], why);
}
