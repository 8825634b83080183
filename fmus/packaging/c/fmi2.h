/* The types and functions of FMI 2.0 that an FMU exports, as the standard defines them
 * (https://fmi-standard.org). Written for this project. */
#ifndef FMI2_H
#define FMI2_H

#include <stddef.h>

#include "export.h"

typedef void *fmi2Component;
typedef void *fmi2ComponentEnvironment;
typedef void *fmi2FMUstate;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef char fmi2Char;
typedef const fmi2Char *fmi2String;
typedef char fmi2Byte;

enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
    fmi2DoStepStatus,
    fmi2PendingStatus,
    fmi2LastSuccessfulTime,
    fmi2Terminated
} fmi2StatusKind;

typedef void (*fmi2CallbackLogger)(fmi2ComponentEnvironment, fmi2String instance_name, fmi2Status,
                                   fmi2String category, fmi2String message, ...);

typedef struct {
    fmi2CallbackLogger logger;
    void *(*allocateMemory)(size_t count, size_t size);
    void (*freeMemory)(void *memory);
    void (*stepFinished)(fmi2ComponentEnvironment, fmi2Status);
    fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef struct {
    fmi2Boolean newDiscreteStatesNeeded;
    fmi2Boolean terminateSimulation;
    fmi2Boolean nominalsOfContinuousStatesChanged;
    fmi2Boolean valuesOfContinuousStatesChanged;
    fmi2Boolean nextEventTimeDefined;
    fmi2Real nextEventTime;
} fmi2EventInfo;

#define FMI2_FUNCTION(name) FMI_EXPORT fmi2Status FMI_NAME(name)
#define FMI2_GET(name, type) \
    FMI2_FUNCTION(name)(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, type value[])
#define FMI2_SET(name, type) \
    FMI2_FUNCTION(name) \
    (fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const type value[])
#define FMI2_STATUS(name, type) \
    FMI2_FUNCTION(name)(fmi2Component c, const fmi2StatusKind kind, type * value)

FMI_EXPORT const char *FMI_NAME(fmi2GetTypesPlatform)(void);
FMI_EXPORT const char *FMI_NAME(fmi2GetVersion)(void);
FMI2_FUNCTION(fmi2SetDebugLogging)
(fmi2Component c, fmi2Boolean on, size_t n, const fmi2String categories[]);

FMI_EXPORT fmi2Component FMI_NAME(fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                                   fmi2String resources,
                                                   const fmi2CallbackFunctions *functions,
                                                   fmi2Boolean visible, fmi2Boolean logging_on);
FMI_EXPORT void FMI_NAME(fmi2FreeInstance)(fmi2Component c);
FMI2_FUNCTION(fmi2SetupExperiment)
(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start_time,
 fmi2Boolean stop_time_defined, fmi2Real stop_time);
FMI2_FUNCTION(fmi2EnterInitializationMode)(fmi2Component c);
FMI2_FUNCTION(fmi2ExitInitializationMode)(fmi2Component c);
FMI2_FUNCTION(fmi2Terminate)(fmi2Component c);
FMI2_FUNCTION(fmi2Reset)(fmi2Component c);

FMI2_GET(fmi2GetReal, fmi2Real);
FMI2_GET(fmi2GetInteger, fmi2Integer);
FMI2_GET(fmi2GetBoolean, fmi2Boolean);
FMI2_GET(fmi2GetString, fmi2String);
FMI2_SET(fmi2SetReal, fmi2Real);
FMI2_SET(fmi2SetInteger, fmi2Integer);
FMI2_SET(fmi2SetBoolean, fmi2Boolean);
FMI2_SET(fmi2SetString, fmi2String);

FMI2_FUNCTION(fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state);
FMI2_FUNCTION(fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state);
FMI2_FUNCTION(fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state);
FMI2_FUNCTION(fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size);
FMI2_FUNCTION(fmi2SerializeFMUstate)
(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size);
FMI2_FUNCTION(fmi2DeSerializeFMUstate)
(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *state);
FMI2_FUNCTION(fmi2GetDirectionalDerivative)
(fmi2Component c, const fmi2ValueReference unknowns[], size_t n_unknowns,
 const fmi2ValueReference knowns[], size_t n_knowns, const fmi2Real seed[],
 fmi2Real sensitivity[]);

FMI2_FUNCTION(fmi2EnterEventMode)(fmi2Component c);
FMI2_FUNCTION(fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info);
FMI2_FUNCTION(fmi2EnterContinuousTimeMode)(fmi2Component c);
FMI2_FUNCTION(fmi2CompletedIntegratorStep)
(fmi2Component c, fmi2Boolean no_set_state_prior, fmi2Boolean *enter_event_mode,
 fmi2Boolean *terminate_simulation);
FMI2_FUNCTION(fmi2SetTime)(fmi2Component c, fmi2Real time);
FMI2_FUNCTION(fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t nx);
FMI2_FUNCTION(fmi2GetDerivatives)(fmi2Component c, fmi2Real derivatives[], size_t nx);
FMI2_FUNCTION(fmi2GetEventIndicators)(fmi2Component c, fmi2Real indicators[], size_t ni);
FMI2_FUNCTION(fmi2GetContinuousStates)(fmi2Component c, fmi2Real x[], size_t nx);
FMI2_FUNCTION(fmi2GetNominalsOfContinuousStates)(fmi2Component c, fmi2Real nominals[], size_t nx);

FMI2_FUNCTION(fmi2SetRealInputDerivatives)
(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
 const fmi2Real value[]);
FMI2_FUNCTION(fmi2GetRealOutputDerivatives)
(fmi2Component c, const fmi2ValueReference vr[], size_t nvr, const fmi2Integer order[],
 fmi2Real value[]);
FMI2_FUNCTION(fmi2DoStep)
(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean no_set_state_prior);
FMI2_FUNCTION(fmi2CancelStep)(fmi2Component c);
FMI2_STATUS(fmi2GetStatus, fmi2Status);
FMI2_STATUS(fmi2GetRealStatus, fmi2Real);
FMI2_STATUS(fmi2GetIntegerStatus, fmi2Integer);
FMI2_STATUS(fmi2GetBooleanStatus, fmi2Boolean);
FMI2_STATUS(fmi2GetStringStatus, fmi2String);

#endif
