/* The types and functions of FMI 3.0 that an FMU exports, as the standard defines them
 * (https://fmi-standard.org). Written for this project. */
#ifndef FMI3_H
#define FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "export.h"

typedef void *fmi3Instance;
typedef void *fmi3InstanceEnvironment;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef char fmi3Char;
typedef const fmi3Char *fmi3String;
typedef uint8_t fmi3Byte;
typedef const fmi3Byte *fmi3Binary;
typedef bool fmi3Clock;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;
typedef enum {
    fmi3Independent,
    fmi3Constant,
    fmi3Fixed,
    fmi3Tunable,
    fmi3Discrete,
    fmi3Dependent
} fmi3DependencyKind;
typedef enum {
    fmi3IntervalNotYetKnown,
    fmi3IntervalUnchanged,
    fmi3IntervalChanged
} fmi3IntervalQualifier;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment, fmi3Status, fmi3String category,
                                       fmi3String message);
typedef void (*fmi3ClockUpdateCallback)(fmi3InstanceEnvironment);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment, fmi3Float64 time,
                                               fmi3Boolean set_requested, fmi3Boolean get_allowed,
                                               fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early,
                                               fmi3Boolean *early_return_requested,
                                               fmi3Float64 *early_return_time);
typedef void (*fmi3LockPreemptionCallback)(void);
typedef void (*fmi3UnlockPreemptionCallback)(void);

#define FMI3_FUNCTION(name) FMI_EXPORT fmi3Status FMI_NAME(name)
#define FMI3_REFERENCES const fmi3ValueReference vr[], size_t nvr
#define FMI3_GET(name, type) \
    FMI3_FUNCTION(name)(fmi3Instance c, FMI3_REFERENCES, type values[], size_t n_values)
#define FMI3_SET(name, type) \
    FMI3_FUNCTION(name)(fmi3Instance c, FMI3_REFERENCES, const type values[], size_t n_values)

FMI_EXPORT const char *FMI_NAME(fmi3GetVersion)(void);
FMI3_FUNCTION(fmi3SetDebugLogging)
(fmi3Instance c, fmi3Boolean on, size_t n, const fmi3String categories[]);

FMI_EXPORT fmi3Instance FMI_NAME(fmi3InstantiateModelExchange)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger);
FMI_EXPORT fmi3Instance FMI_NAME(fmi3InstantiateCoSimulation)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3Boolean event_mode_used, fmi3Boolean early_return_allowed,
    const fmi3ValueReference intermediate_variables[], size_t n_intermediate_variables,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3IntermediateUpdateCallback intermediate_update);
FMI_EXPORT fmi3Instance FMI_NAME(fmi3InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging_on, fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
    fmi3ClockUpdateCallback clock_update, fmi3LockPreemptionCallback lock,
    fmi3UnlockPreemptionCallback unlock);
FMI_EXPORT void FMI_NAME(fmi3FreeInstance)(fmi3Instance c);

FMI3_FUNCTION(fmi3EnterInitializationMode)
(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start_time,
 fmi3Boolean stop_time_defined, fmi3Float64 stop_time);
FMI3_FUNCTION(fmi3ExitInitializationMode)(fmi3Instance c);
FMI3_FUNCTION(fmi3EnterEventMode)(fmi3Instance c);
FMI3_FUNCTION(fmi3Terminate)(fmi3Instance c);
FMI3_FUNCTION(fmi3Reset)(fmi3Instance c);

FMI3_GET(fmi3GetFloat32, fmi3Float32);
FMI3_GET(fmi3GetFloat64, fmi3Float64);
FMI3_GET(fmi3GetInt8, fmi3Int8);
FMI3_GET(fmi3GetUInt8, fmi3UInt8);
FMI3_GET(fmi3GetInt16, fmi3Int16);
FMI3_GET(fmi3GetUInt16, fmi3UInt16);
FMI3_GET(fmi3GetInt32, fmi3Int32);
FMI3_GET(fmi3GetUInt32, fmi3UInt32);
FMI3_GET(fmi3GetInt64, fmi3Int64);
FMI3_GET(fmi3GetUInt64, fmi3UInt64);
FMI3_GET(fmi3GetBoolean, fmi3Boolean);
FMI3_GET(fmi3GetString, fmi3String);
FMI3_FUNCTION(fmi3GetBinary)
(fmi3Instance c, FMI3_REFERENCES, size_t sizes[], fmi3Binary values[], size_t n_values);
FMI3_FUNCTION(fmi3GetClock)(fmi3Instance c, FMI3_REFERENCES, fmi3Clock values[]);

FMI3_SET(fmi3SetFloat32, fmi3Float32);
FMI3_SET(fmi3SetFloat64, fmi3Float64);
FMI3_SET(fmi3SetInt8, fmi3Int8);
FMI3_SET(fmi3SetUInt8, fmi3UInt8);
FMI3_SET(fmi3SetInt16, fmi3Int16);
FMI3_SET(fmi3SetUInt16, fmi3UInt16);
FMI3_SET(fmi3SetInt32, fmi3Int32);
FMI3_SET(fmi3SetUInt32, fmi3UInt32);
FMI3_SET(fmi3SetInt64, fmi3Int64);
FMI3_SET(fmi3SetUInt64, fmi3UInt64);
FMI3_SET(fmi3SetBoolean, fmi3Boolean);
FMI3_SET(fmi3SetString, fmi3String);
FMI3_FUNCTION(fmi3SetBinary)
(fmi3Instance c, FMI3_REFERENCES, const size_t sizes[], const fmi3Binary values[],
 size_t n_values);
FMI3_FUNCTION(fmi3SetClock)(fmi3Instance c, FMI3_REFERENCES, const fmi3Clock values[]);

FMI3_FUNCTION(fmi3GetNumberOfVariableDependencies)
(fmi3Instance c, fmi3ValueReference vr, size_t *n);
FMI3_FUNCTION(fmi3GetVariableDependencies)
(fmi3Instance c, fmi3ValueReference dependent, size_t dependent_elements[],
 fmi3ValueReference independents[], size_t independent_elements[], fmi3DependencyKind kinds[],
 size_t n);

FMI3_FUNCTION(fmi3GetFMUState)(fmi3Instance c, fmi3FMUState *state);
FMI3_FUNCTION(fmi3SetFMUState)(fmi3Instance c, fmi3FMUState state);
FMI3_FUNCTION(fmi3FreeFMUState)(fmi3Instance c, fmi3FMUState *state);
FMI3_FUNCTION(fmi3SerializedFMUStateSize)(fmi3Instance c, fmi3FMUState state, size_t *size);
FMI3_FUNCTION(fmi3SerializeFMUState)
(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size);
FMI3_FUNCTION(fmi3DeserializeFMUState)
(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *state);

#define FMI3_DERIVATIVE(name) \
    FMI3_FUNCTION(name) \
    (fmi3Instance c, const fmi3ValueReference unknowns[], size_t n_unknowns, \
     const fmi3ValueReference knowns[], size_t n_knowns, const fmi3Float64 seed[], \
     size_t n_seed, fmi3Float64 sensitivity[], size_t n_sensitivity)

FMI3_DERIVATIVE(fmi3GetDirectionalDerivative);
FMI3_DERIVATIVE(fmi3GetAdjointDerivative);

FMI3_FUNCTION(fmi3EnterConfigurationMode)(fmi3Instance c);
FMI3_FUNCTION(fmi3ExitConfigurationMode)(fmi3Instance c);

FMI3_FUNCTION(fmi3GetIntervalDecimal)
(fmi3Instance c, FMI3_REFERENCES, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[]);
FMI3_FUNCTION(fmi3GetIntervalFraction)
(fmi3Instance c, FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
 fmi3IntervalQualifier qualifiers[]);
FMI3_FUNCTION(fmi3GetShiftDecimal)(fmi3Instance c, FMI3_REFERENCES, fmi3Float64 shifts[]);
FMI3_FUNCTION(fmi3GetShiftFraction)
(fmi3Instance c, FMI3_REFERENCES, fmi3UInt64 counters[], fmi3UInt64 resolutions[]);
FMI3_FUNCTION(fmi3SetIntervalDecimal)
(fmi3Instance c, FMI3_REFERENCES, const fmi3Float64 intervals[]);
FMI3_FUNCTION(fmi3SetIntervalFraction)
(fmi3Instance c, FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);
FMI3_FUNCTION(fmi3SetShiftDecimal)(fmi3Instance c, FMI3_REFERENCES, const fmi3Float64 shifts[]);
FMI3_FUNCTION(fmi3SetShiftFraction)
(fmi3Instance c, FMI3_REFERENCES, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[]);

FMI3_FUNCTION(fmi3EvaluateDiscreteStates)(fmi3Instance c);
FMI3_FUNCTION(fmi3UpdateDiscreteStates)
(fmi3Instance c, fmi3Boolean *update_needed, fmi3Boolean *terminate_simulation,
 fmi3Boolean *nominals_changed, fmi3Boolean *values_changed, fmi3Boolean *event_time_defined,
 fmi3Float64 *event_time);

FMI3_FUNCTION(fmi3EnterContinuousTimeMode)(fmi3Instance c);
FMI3_FUNCTION(fmi3CompletedIntegratorStep)
(fmi3Instance c, fmi3Boolean no_set_state_prior, fmi3Boolean *enter_event_mode,
 fmi3Boolean *terminate_simulation);
FMI3_FUNCTION(fmi3SetTime)(fmi3Instance c, fmi3Float64 time);
FMI3_FUNCTION(fmi3SetContinuousStates)(fmi3Instance c, const fmi3Float64 x[], size_t nx);
FMI3_FUNCTION(fmi3GetContinuousStateDerivatives)(fmi3Instance c, fmi3Float64 dx[], size_t nx);
FMI3_FUNCTION(fmi3GetEventIndicators)(fmi3Instance c, fmi3Float64 indicators[], size_t n);
FMI3_FUNCTION(fmi3GetContinuousStates)(fmi3Instance c, fmi3Float64 x[], size_t nx);
FMI3_FUNCTION(fmi3GetNominalsOfContinuousStates)
(fmi3Instance c, fmi3Float64 nominals[], size_t nx);
FMI3_FUNCTION(fmi3GetNumberOfEventIndicators)(fmi3Instance c, size_t *n);
FMI3_FUNCTION(fmi3GetNumberOfContinuousStates)(fmi3Instance c, size_t *n);

FMI3_FUNCTION(fmi3EnterStepMode)(fmi3Instance c);
FMI3_FUNCTION(fmi3GetOutputDerivatives)
(fmi3Instance c, FMI3_REFERENCES, const fmi3Int32 orders[], fmi3Float64 values[],
 size_t n_values);
FMI3_FUNCTION(fmi3DoStep)
(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_set_state_prior,
 fmi3Boolean *event_handling_needed, fmi3Boolean *terminate_simulation, fmi3Boolean *early_return,
 fmi3Float64 *last_successful_time);

FMI3_FUNCTION(fmi3ActivateModelPartition)
(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 activation_time);

#endif
