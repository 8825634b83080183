/* The FMI 2.0 functions: arguments checked and handed to component.c. */

#include "fmi2.h"

enum {
    MODES_TO_GET = MODES_WITH_EQUATIONS | MODE_FAILED,
    MODES_TO_SET = MODES_BEFORE_RUN | MODES_OF_RUN
};

/* Status of the expression when the instance exists and stands in a legal mode. */
#define CALL(legal, expression) \
    (!c ? fmi2Error \
     : component_check_mode(c, __func__, legal) != STATUS_OK \
         ? fmi2Error \
         : (fmi2Status)(expression))

static void log_to_importer(const Component *component, Status status, const char *category,
                            const char *text) {
    const fmi2CallbackLogger logger = (fmi2CallbackLogger)component->logger;
    logger(component->environment, component->name, (fmi2Status)status, category, text);
}

const char *FMI_NAME(fmi2GetTypesPlatform)(void) { return "default"; }

const char *FMI_NAME(fmi2GetVersion)(void) { return "2.0"; }

FMI2_FUNCTION(fmi2SetDebugLogging)
(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]) {
    return CALL(MODES_ALL, component_set_logging(c, on != 0, n, categories));
}

fmi2Component FMI_NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                        fmi2String resources,
                                        const fmi2CallbackFunctions *functions,
                                        fmi2Boolean visible, fmi2Boolean logging_on) {
    const Kind kind = type == fmi2CoSimulation ? KIND_CO_SIMULATION : KIND_MODEL_EXCHANGE;
    (void)resources;
    (void)visible;
    return component_new(name, guid, kind, log_to_importer,
                         functions ? functions->componentEnvironment : NULL,
                         functions ? (void (*)(void))functions->logger : NULL, logging_on != 0);
}

void FMI_NAME(fmi2FreeInstance)(fmi2Component c) { component_free(c); }

FMI2_FUNCTION(fmi2SetupExperiment)
(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
 fmi2Boolean stop_time_defined, fmi2Real stop_time) {
    return CALL(MODE_INSTANTIATED, component_setup(c, __func__, tolerance_defined != 0, tolerance,
                                                   start_time, stop_time_defined != 0, stop_time));
}

FMI2_FUNCTION(fmi2EnterInitializationMode)(fmi2Component c) {
    return CALL(MODES_ALL,
                component_change_mode(c, __func__, MODE_INSTANTIATED, MODE_INITIALIZATION));
}

FMI2_FUNCTION(fmi2ExitInitializationMode)(fmi2Component c) {
    return CALL(MODES_ALL, component_exit_initialization(c, __func__));
}

FMI2_FUNCTION(fmi2Terminate)(fmi2Component c) {
    return CALL(MODES_ALL, component_change_mode(c, __func__, MODES_OF_RUN | MODE_FAILED,
                                                 MODE_TERMINATED));
}

FMI2_FUNCTION(fmi2Reset)(fmi2Component c) { return CALL(MODES_ALL, component_reset(c)); }

FMI2_GET(fmi2GetReal, fmi2Real) {
    return CALL(MODES_TO_GET, component_get(c, __func__, vr, nvr, value));
}

FMI2_SET(fmi2SetReal, fmi2Real) {
    return CALL(MODES_TO_SET, component_set(c, __func__, vr, nvr, value));
}

/* There are only real variables: a call for no variables succeeds, any other names the fault. */
#define WITHOUT_VARIABLES \
    ((void)value, CALL(MODES_ALL, nvr == 0 ? STATUS_OK : component_no_variable(c, __func__, vr)))

FMI2_GET(fmi2GetInteger, fmi2Integer) { return WITHOUT_VARIABLES; }
FMI2_GET(fmi2GetBoolean, fmi2Boolean) { return WITHOUT_VARIABLES; }
FMI2_GET(fmi2GetString, fmi2String) { return WITHOUT_VARIABLES; }
FMI2_SET(fmi2SetInteger, fmi2Integer) { return WITHOUT_VARIABLES; }
FMI2_SET(fmi2SetBoolean, fmi2Boolean) { return WITHOUT_VARIABLES; }
FMI2_SET(fmi2SetString, fmi2String) { return WITHOUT_VARIABLES; }

FMI2_FUNCTION(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    return CALL(MODES_ALL, component_get_stored(c, state));
}

FMI2_FUNCTION(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    return CALL(MODES_ALL, component_set_stored(c, __func__, state));
}

FMI2_FUNCTION(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    return CALL(MODES_ALL, component_free_stored(state));
}

FMI2_FUNCTION(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    if (!c || !state || !size) {
        return fmi2Error;
    }
    *size = component_serialized_size();
    return fmi2OK;
}

FMI2_FUNCTION(fmi2SerializeFMUstate)
(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    return CALL(MODES_ALL, component_serialize(c, __func__, state, bytes, size));
}

FMI2_FUNCTION(fmi2DeSerializeFMUstate)
(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state) {
    return CALL(MODES_ALL, component_deserialize(c, __func__, bytes, size, state));
}

FMI2_FUNCTION(fmi2GetDirectionalDerivative)
(fmi2Component c, const fmi2ValueReference unknowns[], size_t n_unknowns,
 const fmi2ValueReference knowns[], size_t n_knowns, const fmi2Real seed[],
 fmi2Real sensitivity[]) {
    return CALL(MODES_ALL, component_directional(c, __func__, unknowns, n_unknowns, knowns,
                                                 n_knowns, seed, sensitivity));
}

/* Model exchange */

FMI2_FUNCTION(fmi2EnterEventMode)(fmi2Component c) {
    return CALL(MODES_ALL, component_change_mode(c, __func__, MODE_EVENT | MODE_CONTINUOUS_TIME,
                                                 MODE_EVENT));
}

FMI2_FUNCTION(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info) {
    if (info) {
        memset(info, 0, sizeof *info);
    }
    return CALL(MODE_EVENT, info ? STATUS_OK : null_argument(c, __func__));
}

FMI2_FUNCTION(fmi2EnterContinuousTimeMode)(fmi2Component c) {
    return CALL(MODES_ALL,
                component_change_mode(c, __func__, MODE_EVENT, MODE_CONTINUOUS_TIME));
}

FMI2_FUNCTION(fmi2CompletedIntegratorStep)
(fmi2Component c, fmi2Boolean no_set_state_prior, fmi2Boolean *enter_event_mode,
 fmi2Boolean *terminate_simulation) {
    (void)no_set_state_prior;
    if (enter_event_mode) {
        *enter_event_mode = fmi2False;
    }
    if (terminate_simulation) {
        *terminate_simulation = fmi2False;
    }
    return CALL(MODE_CONTINUOUS_TIME, STATUS_OK);
}

FMI2_FUNCTION(fmi2SetTime)(fmi2Component c, fmi2Real time) {
    return CALL(MODES_ALL, component_set_time(c, __func__, time));
}

FMI2_FUNCTION(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t nx) {
    return CALL(MODES_ALL, component_set_states(c, __func__, x, nx));
}

FMI2_FUNCTION(fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t nx) {
    return CALL(MODES_ALL, component_get_derivatives(c, __func__, derivatives, nx));
}

FMI2_FUNCTION(fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t ni) {
    (void)indicators;
    return CALL(MODES_ALL, ni == 0 ? STATUS_OK : component_unsupported(c, __func__));
}

FMI2_FUNCTION(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t nx) {
    return CALL(MODES_ALL, component_get_states(c, __func__, x, nx));
}

FMI2_FUNCTION(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t nx) {
    return CALL(MODES_ALL, component_get_nominals(c, __func__, nominals, nx));
}

/* Co-simulation */

FMI2_FUNCTION(fmi2SetRealInputDerivatives)
(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
 const fmi2Real value[]) {
    (void)vr, (void)nvr, (void)order, (void)value;
    return CALL(MODES_ALL, component_unsupported(c, __func__));
}

FMI2_FUNCTION(fmi2GetRealOutputDerivatives)
(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
 fmi2Real value[]) {
    return CALL(MODES_ALL, component_output_derivatives(c, __func__, vr, nvr, order, value));
}

FMI2_FUNCTION(fmi2DoStep)
(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state_prior) {
    (void)no_set_state_prior;
    return c ? (fmi2Status)component_do_step(c, __func__, time, step) : fmi2Error;
}

FMI2_FUNCTION(fmi2CancelStep)(fmi2Component c) {
    return CALL(MODES_ALL, component_unsupported(c, __func__));
}

/* Steps are never pending: only the last successful time and the end of the run can be asked. */
#define NO_STATUS ((void)kind, (void)value, c ? fmi2Discard : fmi2Error)

FMI2_STATUS(fmi2GetStatus, fmi2Status) { return NO_STATUS; }
FMI2_STATUS(fmi2GetIntegerStatus, fmi2Integer) { return NO_STATUS; }
FMI2_STATUS(fmi2GetStringStatus, fmi2String) { return NO_STATUS; }

FMI2_STATUS(fmi2GetRealStatus, fmi2Real) {
    if (!c || !value || kind != fmi2LastSuccessfulTime) {
        return NO_STATUS;
    }
    *value = ((Component *)c)->state.time;
    return fmi2OK;
}

FMI2_STATUS(fmi2GetBooleanStatus, fmi2Boolean) {
    if (!c || !value || kind != fmi2Terminated) {
        return NO_STATUS;
    }
    *value = fmi2False;
    return fmi2OK;
}
