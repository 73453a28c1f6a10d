/* The functions of FMI 3.0 for co-simulation (Modelica Association 2022) around step functions of C99.
 *
 * Before this text stand: Model, a structure with t, in[INPUTS], out[OUTPUTS] and the states; step_all, which
 * takes one sample; INPUTS, OUTPUTS, SAMPLE [s] and TOKEN. A copy of the model takes the step whose outputs are
 * asked for, so that these see the inputs of now.
 */
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef void *fmi3Instance;
typedef void *fmi3FMUState;
typedef uint32_t fmi3ValueReference;
typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

#if defined _WIN32
#define EXPORTED __declspec(dllexport)
#else
#define EXPORTED __attribute__((visibility("default")))
#endif
#define TOLERANCE 1e-6 /* of a sample, by which communication steps may differ from whole samples */

EXPORTED const char *fmi3GetVersion(void) { return "3.0"; }

EXPORTED fmi3Instance fmi3InstantiateCoSimulation(
    const char *name, const char *token, const char *resources, bool visible, bool logging, bool events,
    bool early, const fmi3ValueReference required[], size_t n, void *environment, void *log, void *update)
{
    (void)name, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required;
    (void)n, (void)environment, (void)log, (void)update;
    return token != NULL && strcmp(token, TOKEN) == 0 ? calloc(1, sizeof(Model)) : NULL;
}

EXPORTED void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

EXPORTED fmi3Status fmi3EnterInitializationMode(
    fmi3Instance instance, bool defined, double tolerance, double start, bool stops, double stop)
{
    (void)defined, (void)tolerance, (void)stops, (void)stop;
    ((Model *)instance)->t = start;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3Reset(fmi3Instance instance)
{
    memset(instance, 0, sizeof(Model));
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetFloat64(
    fmi3Instance instance, const fmi3ValueReference references[], size_t n, double values[], size_t count)
{
    Model next = *(Model *)instance;
    size_t i;
    (void)count;
    step_all(&next);
    for (i = 0; i < n; i++) {
        fmi3ValueReference r = references[i];
        if (r > INPUTS + OUTPUTS)
            return fmi3Error;
        values[i] = r == 0 ? next.t : r <= INPUTS ? next.in[r - 1] : next.out[r - 1 - INPUTS];
    }
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetFloat64(
    fmi3Instance instance, const fmi3ValueReference references[], size_t n, const double values[], size_t count)
{
    size_t i;
    (void)count;
    for (i = 0; i < n; i++) {
        if (references[i] < 1 || references[i] > INPUTS)
            return fmi3Error;
        ((Model *)instance)->in[references[i] - 1] = values[i];
    }
    return fmi3OK;
}

EXPORTED fmi3Status fmi3DoStep(
    fmi3Instance instance, double now, double duration, bool keeps, bool *event, bool *terminate, bool *early,
    double *last)
{
    Model *model = instance;
    double samples = duration / SAMPLE, i, whole = floor(samples + 0.5);
    (void)keeps;
    *event = *terminate = *early = false;
    *last = now;
    if (whole < 1 || fabs(samples - whole) > TOLERANCE)
        return fmi3Error;
    for (i = 0; i < whole; i++)
        step_all(model);
    *last = model->t = now + duration;
    return fmi3OK;
}

EXPORTED fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    if (*state == NULL && (*state = malloc(sizeof(Model))) == NULL)
        return fmi3Error;
    memcpy(*state, instance, sizeof(Model));
    return fmi3OK;
}

EXPORTED fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    memcpy(instance, state, sizeof(Model));
    return fmi3OK;
}

EXPORTED fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

#define ACCEPTED(name) EXPORTED fmi3Status name() { return fmi3OK; }
#define REFUSED(name) EXPORTED fmi3Status name() { return fmi3Error; }
#define NOT_MADE(name) EXPORTED fmi3Instance name() { return NULL; }

ACCEPTED(fmi3SetDebugLogging) ACCEPTED(fmi3ExitInitializationMode) ACCEPTED(fmi3Terminate)
ACCEPTED(fmi3EnterConfigurationMode) ACCEPTED(fmi3ExitConfigurationMode) ACCEPTED(fmi3EnterStepMode)
NOT_MADE(fmi3InstantiateModelExchange) NOT_MADE(fmi3InstantiateScheduledExecution)
REFUSED(fmi3EnterEventMode) REFUSED(fmi3GetFloat32) REFUSED(fmi3GetInt8) REFUSED(fmi3GetUInt8)
REFUSED(fmi3GetInt16) REFUSED(fmi3GetUInt16) REFUSED(fmi3GetInt32) REFUSED(fmi3GetUInt32)
REFUSED(fmi3GetInt64) REFUSED(fmi3GetUInt64) REFUSED(fmi3GetBoolean) REFUSED(fmi3GetString)
REFUSED(fmi3GetBinary) REFUSED(fmi3GetClock) REFUSED(fmi3SetFloat32) REFUSED(fmi3SetInt8)
REFUSED(fmi3SetUInt8) REFUSED(fmi3SetInt16) REFUSED(fmi3SetUInt16) REFUSED(fmi3SetInt32)
REFUSED(fmi3SetUInt32) REFUSED(fmi3SetInt64) REFUSED(fmi3SetUInt64) REFUSED(fmi3SetBoolean)
REFUSED(fmi3SetString) REFUSED(fmi3SetBinary) REFUSED(fmi3SetClock)
REFUSED(fmi3GetNumberOfVariableDependencies) REFUSED(fmi3GetVariableDependencies)
REFUSED(fmi3SerializedFMUStateSize) REFUSED(fmi3SerializeFMUState) REFUSED(fmi3DeserializeFMUState)
REFUSED(fmi3GetDirectionalDerivative) REFUSED(fmi3GetAdjointDerivative) REFUSED(fmi3GetIntervalDecimal)
REFUSED(fmi3GetIntervalFraction) REFUSED(fmi3GetShiftDecimal) REFUSED(fmi3GetShiftFraction)
REFUSED(fmi3SetIntervalDecimal) REFUSED(fmi3SetIntervalFraction) REFUSED(fmi3SetShiftDecimal)
REFUSED(fmi3SetShiftFraction) REFUSED(fmi3EvaluateDiscreteStates) REFUSED(fmi3UpdateDiscreteStates)
REFUSED(fmi3EnterContinuousTimeMode) REFUSED(fmi3CompletedIntegratorStep) REFUSED(fmi3SetTime)
REFUSED(fmi3SetContinuousStates) REFUSED(fmi3GetContinuousStateDerivatives) REFUSED(fmi3GetEventIndicators)
REFUSED(fmi3GetContinuousStates) REFUSED(fmi3GetNominalsOfContinuousStates)
REFUSED(fmi3GetNumberOfEventIndicators) REFUSED(fmi3GetNumberOfContinuousStates)
REFUSED(fmi3GetOutputDerivatives) REFUSED(fmi3ActivateModelPartition)
