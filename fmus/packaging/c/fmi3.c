/* The FMI 3.0 functions: arguments checked and handed to component.c. */

#include "fmi3.h"

enum {
    MODES_TO_GET = MODES_WITH_EQUATIONS | MODE_INSTANTIATED | MODE_FAILED,
    MODES_TO_SET = MODES_BEFORE_RUN | MODES_OF_RUN
};

/* Status of the expression when the instance exists and stands in a legal mode. */
#define CALL(legal, expression) \
    (!c ? fmi3Error \
     : component_check_mode(c, __func__, legal) != STATUS_OK \
         ? fmi3Error \
         : (fmi3Status)(expression))

#define UNSUPPORTED CALL(MODES_ALL, component_unsupported(c, __func__))

static void log_to_importer(const Component *component, Status status, const char *category,
                            const char *text) {
    const fmi3LogMessageCallback logger = (fmi3LogMessageCallback)component->logger;
    logger(component->environment, (fmi3Status)status, category, text);
}

static void set_false(fmi3Boolean *flag) {
    if (flag) {
        *flag = false;
    }
}

const char *FMI_NAME(fmi3GetVersion)(void) { return "3.0"; }

FMI3_FUNCTION(fmi3SetDebugLogging)
(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]) {
    return CALL(MODES_ALL, component_set_logging(c, on, n, categories));
}

fmi3Instance FMI_NAME(fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    (void)resources, (void)visible;
    return component_new(name, token, KIND_MODEL_EXCHANGE, log_to_importer, environment,
                         (void (*)(void))logger, logging_on);
}

fmi3Instance FMI_NAME(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate_variables[], size_t n_intermediate_variables,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback intermediate_update) {
    (void)resources, (void)visible, (void)early_return_allowed, (void)intermediate_update;
    /* No intermediate update is ever asked for, so variables registered for it do no harm. */
    (void)intermediate_variables, (void)n_intermediate_variables;
    if (event_mode_used) {
        if (logger) {
            logger(environment, fmi3Error, "logStatusError",
                   "Instantiation refused: this FMU has no event mode.");
        }
        return NULL;
    }
    return component_new(name, token, KIND_CO_SIMULATION, log_to_importer, environment,
                         (void (*)(void))logger, logging_on);
}

fmi3Instance FMI_NAME(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging_on;
    (void)clock_update, (void)lock, (void)unlock;
    if (logger) {
        logger(environment, fmi3Error, "logStatusError",
               "Instantiation refused: this FMU has no scheduled execution.");
    }
    return NULL;
}

void FMI_NAME(fmi3FreeInstance)(fmi3Instance c) { component_free(c); }

FMI3_FUNCTION(fmi3EnterInitializationMode)
(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start_time,
 fmi3Boolean stop_time_defined, fmi3Float64 stop_time) {
    if (CALL(MODES_ALL, component_setup(c, __func__, tolerance_defined, tolerance, start_time,
                                        stop_time_defined, stop_time)) != fmi3OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_change_mode(c, __func__, MODE_INSTANTIATED, MODE_INITIALIZATION);
}

FMI3_FUNCTION(fmi3ExitInitializationMode)(fmi3Instance c) {
    return CALL(MODES_ALL, component_exit_initialization(c, __func__));
}

FMI3_FUNCTION(fmi3EnterEventMode)(fmi3Instance c) {
    return CALL(MODES_ALL,
                component_change_mode(c, __func__, MODE_CONTINUOUS_TIME, MODE_EVENT));
}

FMI3_FUNCTION(fmi3Terminate)(fmi3Instance c) {
    return CALL(MODES_ALL, component_change_mode(c, __func__, MODES_OF_RUN | MODE_FAILED,
                                                 MODE_TERMINATED));
}

FMI3_FUNCTION(fmi3Reset)(fmi3Instance c) { return CALL(MODES_ALL, component_reset(c)); }

/* Variables are scalars: as many values as value references. */
static Status check_count(const Component *component, const char *call, size_t n_references,
                          size_t n_values) {
    if (n_references == n_values) {
        return STATUS_OK;
    }
    return component_log(component, STATUS_ERROR, LOG_ERROR,
                         "%s: %lu values for %lu scalar variables.", call, (unsigned long)n_values,
                         (unsigned long)n_references);
}

FMI3_GET(fmi3GetFloat64, fmi3Float64) {
    if (CALL(MODES_TO_GET, check_count(c, __func__, nvr, n_values)) != fmi3OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_get(c, __func__, vr, nvr, values);
}

FMI3_SET(fmi3SetFloat64, fmi3Float64) {
    if (CALL(MODES_TO_SET, check_count(c, __func__, nvr, n_values)) != fmi3OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_set(c, __func__, vr, nvr, values);
}

/* All variables are Float64: a call for no variables succeeds, any other names the fault. */
#define WITHOUT_VARIABLES \
    ((void)values, \
     CALL(MODES_ALL, nvr == 0 ? STATUS_OK : component_no_variable(c, __func__, vr)))
#define GET_AND_SET_WITHOUT_VARIABLES(type) \
    FMI3_GET(fmi3Get##type, fmi3##type) { return (void)n_values, WITHOUT_VARIABLES; } \
    FMI3_SET(fmi3Set##type, fmi3##type) { return (void)n_values, WITHOUT_VARIABLES; }

GET_AND_SET_WITHOUT_VARIABLES(Float32)
GET_AND_SET_WITHOUT_VARIABLES(Int8)
GET_AND_SET_WITHOUT_VARIABLES(UInt8)
GET_AND_SET_WITHOUT_VARIABLES(Int16)
GET_AND_SET_WITHOUT_VARIABLES(UInt16)
GET_AND_SET_WITHOUT_VARIABLES(Int32)
GET_AND_SET_WITHOUT_VARIABLES(UInt32)
GET_AND_SET_WITHOUT_VARIABLES(Int64)
GET_AND_SET_WITHOUT_VARIABLES(UInt64)
GET_AND_SET_WITHOUT_VARIABLES(Boolean)
GET_AND_SET_WITHOUT_VARIABLES(String)

FMI3_FUNCTION(fmi3GetBinary)
(fmi3Instance c, FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t n_values) {
    (void)sizes, (void)n_values;
    return WITHOUT_VARIABLES;
}

FMI3_FUNCTION(fmi3SetBinary)
(fmi3Instance c, FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[],
 size_t n_values) {
    (void)sizes, (void)n_values;
    return WITHOUT_VARIABLES;
}

FMI3_FUNCTION(fmi3GetClock)(fmi3Instance c, FMI3_REFERENCES, fmi3Clock values[]) {
    return WITHOUT_VARIABLES;
}

FMI3_FUNCTION(fmi3SetClock)(fmi3Instance c, FMI3_REFERENCES, const fmi3Clock values[]) {
    return WITHOUT_VARIABLES;
}

FMI3_FUNCTION(fmi3GetNumberOfVariableDependencies)
(fmi3Instance c, fmi3ValueReference vr, size_t *n) {
    (void)vr, (void)n;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3GetVariableDependencies)
(fmi3Instance c, fmi3ValueReference dependent, size_t dependent_elements[],
 fmi3ValueReference independents[], size_t independent_elements[], fmi3DependencyKind kinds[],
 size_t n) {
    (void)dependent, (void)dependent_elements, (void)independents, (void)independent_elements;
    (void)kinds, (void)n;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state) {
    return CALL(MODES_ALL, component_get_stored(c, state));
}

FMI3_FUNCTION(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state) {
    return CALL(MODES_ALL, component_set_stored(c, __func__, state));
}

FMI3_FUNCTION(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state) {
    return CALL(MODES_ALL, component_free_stored(state));
}

FMI3_FUNCTION(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size) {
    if (!c || !state || !size) {
        return fmi3Error;
    }
    *size = component_serialized_size();
    return fmi3OK;
}

FMI3_FUNCTION(fmi3SerializeFMUState)
(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    return CALL(MODES_ALL, component_serialize(c, __func__, state, bytes, size));
}

FMI3_FUNCTION(fmi3DeserializeFMUState)
(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state) {
    return CALL(MODES_ALL, component_deserialize(c, __func__, bytes, size, state));
}

FMI3_DERIVATIVE(fmi3GetDirectionalDerivative) {
    if (CALL(MODES_ALL, check_count(c, __func__, n_knowns, n_seed)) != fmi3OK ||
        check_count(c, __func__, n_unknowns, n_sensitivity) != STATUS_OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_directional(c, __func__, unknowns, n_unknowns, knowns, n_knowns,
                                             seed, sensitivity);
}

FMI3_DERIVATIVE(fmi3GetAdjointDerivative) {
    if (CALL(MODES_ALL, check_count(c, __func__, n_unknowns, n_seed)) != fmi3OK ||
        check_count(c, __func__, n_knowns, n_sensitivity) != STATUS_OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_adjoint(c, __func__, unknowns, n_unknowns, knowns, n_knowns, seed,
                                         sensitivity);
}

/* There are no structural parameters, and no clocks. */

FMI3_FUNCTION(fmi3EnterConfigurationMode)(fmi3Instance c) { return UNSUPPORTED; }

FMI3_FUNCTION(fmi3ExitConfigurationMode)(fmi3Instance c) { return UNSUPPORTED; }

FMI3_FUNCTION(fmi3GetIntervalDecimal)
(fmi3Instance c, FMI3_REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]) {
    (void)vr, (void)nvr, (void)intervals, (void)qualifiers;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3GetIntervalFraction)
(fmi3Instance c, FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
 fmi3IntervalQualifier qualifiers[]) {
    (void)vr, (void)nvr, (void)counters, (void)resolutions, (void)qualifiers;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3GetShiftDecimal)(fmi3Instance c, FMI3_REFERENCES, fmi3Float64 shifts[]) {
    (void)vr, (void)nvr, (void)shifts;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3GetShiftFraction)
(fmi3Instance c, FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]) {
    (void)vr, (void)nvr, (void)counters, (void)resolutions;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3SetIntervalDecimal)
(fmi3Instance c, FMI3_REFERENCES, const fmi3Float64 intervals[]) {
    (void)vr, (void)nvr, (void)intervals;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3SetIntervalFraction)
(fmi3Instance c, FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
    (void)vr, (void)nvr, (void)counters, (void)resolutions;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3SetShiftDecimal)(fmi3Instance c, FMI3_REFERENCES, const fmi3Float64 shifts[]) {
    (void)vr, (void)nvr, (void)shifts;
    return UNSUPPORTED;
}

FMI3_FUNCTION(fmi3SetShiftFraction)
(fmi3Instance c, FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]) {
    (void)vr, (void)nvr, (void)counters, (void)resolutions;
    return UNSUPPORTED;
}

/* Model exchange */

FMI3_FUNCTION(fmi3EvaluateDiscreteStates)(fmi3Instance c) { return UNSUPPORTED; }

FMI3_FUNCTION(fmi3UpdateDiscreteStates)
(fmi3Instance c, fmi3Boolean *update_needed, fmi3Boolean *terminate_simulation,
 fmi3Boolean *nominals_changed, fmi3Boolean *values_changed, fmi3Boolean *event_time_defined,
 fmi3Float64 *event_time) {
    set_false(update_needed);
    set_false(terminate_simulation);
    set_false(nominals_changed);
    set_false(values_changed);
    set_false(event_time_defined);
    if (event_time) {
        *event_time = 0.0;
    }
    return CALL(MODE_EVENT, STATUS_OK);
}

FMI3_FUNCTION(fmi3EnterContinuousTimeMode)(fmi3Instance c) {
    return CALL(MODES_ALL,
                component_change_mode(c, __func__, MODE_EVENT, MODE_CONTINUOUS_TIME));
}

FMI3_FUNCTION(fmi3CompletedIntegratorStep)
(fmi3Instance c, fmi3Boolean no_set_state_prior, fmi3Boolean *enter_event_mode,
 fmi3Boolean *terminate_simulation) {
    (void)no_set_state_prior;
    set_false(enter_event_mode);
    set_false(terminate_simulation);
    return CALL(MODE_CONTINUOUS_TIME, STATUS_OK);
}

FMI3_FUNCTION(fmi3SetTime)(fmi3Instance c, fmi3Float64 time) {
    return CALL(MODES_ALL, component_set_time(c, __func__, time));
}

FMI3_FUNCTION(fmi3SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t nx) {
    return CALL(MODES_ALL, component_set_states(c, __func__, x, nx));
}

FMI3_FUNCTION(fmi3GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 dx[], size_t nx) {
    return CALL(MODES_ALL, component_get_derivatives(c, __func__, dx, nx));
}

FMI3_FUNCTION(fmi3GetEventIndicators)(fmi3Instance c, fmi3Float64 indicators[], size_t n) {
    (void)indicators;
    return CALL(MODES_ALL, n == 0 ? STATUS_OK : component_unsupported(c, __func__));
}

FMI3_FUNCTION(fmi3GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t nx) {
    return CALL(MODES_ALL, component_get_states(c, __func__, x, nx));
}

FMI3_FUNCTION(fmi3GetNominalsOfContinuousStates)
(fmi3Instance c, fmi3Float64 nominals[], size_t nx) {
    return CALL(MODES_ALL, component_get_nominals(c, __func__, nominals, nx));
}

FMI3_FUNCTION(fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *n) {
    if (!c || !n) {
        return fmi3Error;
    }
    *n = 0;
    return fmi3OK;
}

FMI3_FUNCTION(fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *n) {
    if (!c || !n) {
        return fmi3Error;
    }
    *n = N_X;
    return fmi3OK;
}

/* Co-simulation */

FMI3_FUNCTION(fmi3EnterStepMode)(fmi3Instance c) { return UNSUPPORTED; }

FMI3_FUNCTION(fmi3GetOutputDerivatives)
(fmi3Instance c, FMI3_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
 size_t n_values) {
    if (CALL(MODES_ALL, check_count(c, __func__, nvr, n_values)) != fmi3OK) {
        return fmi3Error;
    }
    return (fmi3Status)component_output_derivatives(c, __func__, vr, nvr, orders, values);
}

FMI3_FUNCTION(fmi3DoStep)
(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_set_state_prior,
 fmi3Boolean *event_handling_needed, fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
 fmi3Float64 *last_successful_time) {
    fmi3Status status;
    (void)no_set_state_prior;
    set_false(event_handling_needed);
    set_false(terminate_simulation);
    set_false(early_return);
    if (!c) {
        return fmi3Error;
    }
    status = (fmi3Status)component_do_step(c, __func__, time, step);
    if (last_successful_time) {
        *last_successful_time = ((Component *)c)->state.time;
    }
    return status;
}

FMI3_FUNCTION(fmi3ActivateModelPartition)
(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 activation_time) {
    (void)clock, (void)activation_time;
    return UNSUPPORTED;
}
