/* Part of component.c: exact partial derivatives from the sparse Jacobian of (f, h) with respect to
 * (x, u, p). Only the columns and rows asked for enter, so that an infinite derivative elsewhere
 * does no harm. */

enum { N_ROWS = N_X + N_Y, N_COLUMNS = N_X + N_U + N_P };

/* The column of a known, or -1. */
static int column_of(unsigned reference) {
    size_t i;
    switch (classify(reference, &i)) {
    case STATE: return (int)i;
    case INPUT: return N_X + (int)i;
    case PARAMETER: return N_X + N_U + (int)i;
    default: return -1;
    }
}

/* The row of an unknown; N_ROWS + i for state i taken as an unknown; or -1. */
static int row_of(unsigned reference) {
    size_t i;
    switch (classify(reference, &i)) {
    case DERIVATIVE: return (int)i;
    case OUTPUT: return N_X + (int)i;
    case STATE: return N_ROWS + (int)i;
    default: return -1;
    }
}

static Status check_derivative(const Component *component, const char *call,
                               const unsigned unknowns[], size_t n_unknowns,
                               const unsigned knowns[], size_t n_knowns) {
    if (component_check_mode(component, call, MODES_WITH_EQUATIONS | MODE_FAILED) != STATUS_OK) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n_unknowns; k++) {
        if (row_of(unknowns[k]) < 0) {
            return component_log(component, STATUS_ERROR, LOG_ERROR,
                                 "%s: value reference %u is no unknown (output, state or "
                                 "derivative).",
                                 call, unknowns[k]);
        }
    }
    for (size_t k = 0; k < n_knowns; k++) {
        if (column_of(knowns[k]) < 0) {
            return component_log(component, STATUS_ERROR, LOG_ERROR,
                                 "%s: value reference %u is no known (state, input or parameter).",
                                 call, knowns[k]);
        }
    }
    return STATUS_OK;
}

/* rows = J * columns; the states, as unknowns, follow the rows. */
static void multiply(const State *state, const double *columns, double *rows) {
    double jacobian[N_JACOBIAN + 1];
    model_jacobian(state->x, state->u, state->p, jacobian);
    memset(rows, 0, (N_ROWS + N_X) * sizeof(double));
    for (int j = 0; j < N_COLUMNS; j++) {
        if (columns[j] != 0.0) {
            for (int k = model_jacobian_starts[j]; k < model_jacobian_starts[j + 1]; k++) {
                rows[model_jacobian_rows[k]] += jacobian[k] * columns[j];
            }
        }
    }
    memcpy(rows + N_ROWS, columns, N_X * sizeof(double));
}

static Status component_directional(const Component *component, const char *call,
                                    const unsigned unknowns[], size_t n_unknowns,
                                    const unsigned knowns[], size_t n_knowns, const double seed[],
                                    double sensitivity[]) {
    double columns[N_COLUMNS + 1] = {0.0};
    double rows[N_ROWS + N_X + 1];
    if ((n_unknowns > 0 && (!unknowns || !sensitivity)) || (n_knowns > 0 && (!knowns || !seed))) {
        return null_argument(component, call);
    }
    if (check_derivative(component, call, unknowns, n_unknowns, knowns, n_knowns) != STATUS_OK) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n_knowns; k++) {
        columns[column_of(knowns[k])] += seed[k];
    }
    multiply(&component->state, columns, rows);
    for (size_t k = 0; k < n_unknowns; k++) {
        sensitivity[k] = rows[row_of(unknowns[k])];
    }
    return STATUS_OK;
}

#if FMI_VERSION == 3
static Status component_adjoint(const Component *component, const char *call,
                                const unsigned unknowns[], size_t n_unknowns,
                                const unsigned knowns[], size_t n_knowns, const double seed[],
                                double sensitivity[]) {
    double jacobian[N_JACOBIAN + 1];
    double rows[N_ROWS + N_X + 1] = {0.0};
    const State *state = &component->state;
    if ((n_unknowns > 0 && (!unknowns || !seed)) || (n_knowns > 0 && (!knowns || !sensitivity))) {
        return null_argument(component, call);
    }
    if (check_derivative(component, call, unknowns, n_unknowns, knowns, n_knowns) != STATUS_OK) {
        return STATUS_ERROR;
    }
    for (size_t k = 0; k < n_unknowns; k++) {
        rows[row_of(unknowns[k])] += seed[k];
    }
    model_jacobian(state->x, state->u, state->p, jacobian);
    for (size_t k = 0; k < n_knowns; k++) {
        const int j = column_of(knowns[k]);
        double sum = j < N_X ? rows[N_ROWS + j] : 0.0;
        for (int i = model_jacobian_starts[j]; i < model_jacobian_starts[j + 1]; i++) {
            const double weight = rows[model_jacobian_rows[i]];
            sum += weight != 0.0 ? weight * jacobian[i] : 0.0;
        }
        sensitivity[k] = sum;
    }
    return STATUS_OK;
}
#endif

static Status component_output_derivatives(Component *component, const char *call,
                                           const unsigned references[], size_t n,
                                           const int orders[], double values[]) {
    double columns[N_COLUMNS + 1] = {0.0};
    double rows[N_ROWS + N_X + 1];
    if (component_check_kind(component, call, KIND_CO_SIMULATION) != STATUS_OK ||
        component_check_mode(component, call, MODE_STEP | MODE_FAILED | MODE_TERMINATED) !=
            STATUS_OK) {
        return STATUS_ERROR;
    }
    if (n > 0 && (!references || !orders || !values)) {
        return null_argument(component, call);
    }
    update_derivatives(component);
    memcpy(columns, component->dx, N_X * sizeof(double));
    multiply(&component->state, columns, rows);
    for (size_t k = 0; k < n; k++) {
        size_t i;
        const VariableClass variable_class = classify(references[k], &i);
        if (orders[k] != 1 || (variable_class != OUTPUT && variable_class != STATE)) {
            return component_log(component, STATUS_ERROR, LOG_ERROR,
                                 "%s: order %d of value reference %u; only order 1 of outputs is "
                                 "provided.",
                                 call, orders[k], references[k]);
        }
        values[k] = rows[row_of(references[k])];
    }
    return STATUS_OK;
}
