/* Part of component.c: messages to the importer. */

enum { MESSAGE_SIZE = 512 };

static const struct {
    Category category;
    const char *name;
} category_names[] = {
    {LOG_EVENTS, "logEvents"},
    {LOG_SOLVER, "logSolver"},
    {LOG_WARNING, "logStatusWarning"},
    {LOG_ERROR, "logStatusError"},
};

enum { N_CATEGORIES = sizeof category_names / sizeof category_names[0] };

static const char *category_name(Category category) {
    for (size_t i = 0; i < N_CATEGORIES; i++) {
        if (category_names[i].category == category) {
            return category_names[i].name;
        }
    }
    return "logAll";
}

static Status component_log(const Component *component, Status status, Category category,
                            const char *format, ...) {
    char text[MESSAGE_SIZE];
    va_list arguments;
    const bool debug = category == LOG_EVENTS || category == LOG_SOLVER;
    if (!component->logger || (debug && !(component->log_categories & (unsigned)category))) {
        return status;
    }
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    for (char *c = text; *c; c++) {
        if (*c == '%') {
            *c = '_'; /* FMI 2 hands the text to a callback of printf's kind */
        }
    }
    component->log_sink(component, status, category_name(category), text);
    return status;
}

static Status component_set_logging(Component *component, bool on, size_t n,
                                    const char *const categories[]) {
    unsigned chosen = n == 0 ? LOG_EVENTS | LOG_SOLVER : 0;
    for (size_t i = 0; i < n; i++) {
        size_t k = 0;
        while (k < N_CATEGORIES && (!categories || !categories[i] ||
                                    strcmp(categories[i], category_names[k].name) != 0)) {
            k++;
        }
        if (k == N_CATEGORIES) {
            return component_log(component, STATUS_ERROR, LOG_ERROR,
                                 "There is no log category '%s'; there are logEvents, logSolver, "
                                 "logStatusWarning, logStatusError.",
                                 categories && categories[i] ? categories[i] : "NULL");
        }
        chosen |= (unsigned)category_names[k].category;
    }
    component->log_categories = on ? chosen : 0;
    return STATUS_OK;
}

static Status component_unsupported(const Component *component, const char *call) {
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: not supported by this FMU, see its modelDescription.xml.", call);
}
