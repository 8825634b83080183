/* The lag as an FMI 3.0 co-simulation FMU: what a closed loop calls, the rest is missing. */
#include <stdbool.h>

#include "model.h"

EXPORT const char *fmi3GetVersion(void) { return "3.0"; }

EXPORT void *fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources,
                                         bool visible, bool logging, bool event_mode,
                                         bool early_return, const unsigned *intermediate, size_t n,
                                         void *environment, void *log, void *update) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)event_mode;
    (void)early_return, (void)intermediate, (void)n, (void)environment, (void)log, (void)update;
    return lag_new();
}

EXPORT void fmi3FreeInstance(void *c) { free(c); }

EXPORT int fmi3EnterInitializationMode(void *c, bool tolerance_defined, double tolerance,
                                       double start, bool stop_defined, double stop) {
    (void)c, (void)tolerance_defined, (void)tolerance, (void)start, (void)stop_defined, (void)stop;
    return OK;
}

EXPORT int fmi3ExitInitializationMode(void *c) { return c ? OK : ERROR; }
EXPORT int fmi3Terminate(void *c) { return c ? OK : ERROR; }

EXPORT int fmi3GetFloat64(void *c, const unsigned *references, size_t n, double *values,
                          size_t n_values) {
    return n == n_values ? lag_get(c, references, n, values) : ERROR;
}

EXPORT int fmi3SetFloat64(void *c, const unsigned *references, size_t n, const double *values,
                          size_t n_values) {
    return n == n_values ? lag_set(c, references, n, values) : ERROR;
}

EXPORT int fmi3DoStep(void *c, double time, double step, bool no_set_state, bool *event_needed,
                      bool *terminate, bool *early_return, double *last_time) {
    (void)no_set_state;
    lag_step(c, step);
    *event_needed = *terminate = *early_return = false;
    *last_time = time + step;
    return OK;
}

MISSING(fmi3ActivateModelPartition)
MISSING(fmi3CompletedIntegratorStep)
MISSING(fmi3DeserializeFMUState)
MISSING(fmi3EnterConfigurationMode)
MISSING(fmi3EnterContinuousTimeMode)
MISSING(fmi3EnterEventMode)
MISSING(fmi3EnterStepMode)
MISSING(fmi3EvaluateDiscreteStates)
MISSING(fmi3ExitConfigurationMode)
MISSING(fmi3FreeFMUState)
MISSING(fmi3GetAdjointDerivative)
MISSING(fmi3GetBinary)
MISSING(fmi3GetBoolean)
MISSING(fmi3GetClock)
MISSING(fmi3GetContinuousStateDerivatives)
MISSING(fmi3GetContinuousStates)
MISSING(fmi3GetDirectionalDerivative)
MISSING(fmi3GetEventIndicators)
MISSING(fmi3GetFMUState)
MISSING(fmi3GetFloat32)
MISSING(fmi3GetInt16)
MISSING(fmi3GetInt32)
MISSING(fmi3GetInt64)
MISSING(fmi3GetInt8)
MISSING(fmi3GetIntervalDecimal)
MISSING(fmi3GetIntervalFraction)
MISSING(fmi3GetNominalsOfContinuousStates)
MISSING(fmi3GetNumberOfContinuousStates)
MISSING(fmi3GetNumberOfEventIndicators)
MISSING(fmi3GetNumberOfVariableDependencies)
MISSING(fmi3GetOutputDerivatives)
MISSING(fmi3GetShiftDecimal)
MISSING(fmi3GetShiftFraction)
MISSING(fmi3GetString)
MISSING(fmi3GetUInt16)
MISSING(fmi3GetUInt32)
MISSING(fmi3GetUInt64)
MISSING(fmi3GetUInt8)
MISSING(fmi3GetVariableDependencies)
MISSING(fmi3InstantiateModelExchange)
MISSING(fmi3InstantiateScheduledExecution)
MISSING(fmi3Reset)
MISSING(fmi3SerializeFMUState)
MISSING(fmi3SerializedFMUStateSize)
MISSING(fmi3SetBinary)
MISSING(fmi3SetBoolean)
MISSING(fmi3SetClock)
MISSING(fmi3SetContinuousStates)
MISSING(fmi3SetDebugLogging)
MISSING(fmi3SetFMUState)
MISSING(fmi3SetFloat32)
MISSING(fmi3SetInt16)
MISSING(fmi3SetInt32)
MISSING(fmi3SetInt64)
MISSING(fmi3SetInt8)
MISSING(fmi3SetIntervalDecimal)
MISSING(fmi3SetIntervalFraction)
MISSING(fmi3SetShiftDecimal)
MISSING(fmi3SetShiftFraction)
MISSING(fmi3SetString)
MISSING(fmi3SetTime)
MISSING(fmi3SetUInt16)
MISSING(fmi3SetUInt32)
MISSING(fmi3SetUInt64)
MISSING(fmi3SetUInt8)
MISSING(fmi3UpdateDiscreteStates)
