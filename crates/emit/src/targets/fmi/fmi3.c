/* Written by sidc: the functions of FMI 3.0 (Model Exchange) around those of equations.c. The headers of FMI come from who compiles. */
#include <stdlib.h>
#include <string.h>

#include "equations.c"
#include "fmi3Functions.h"

/* How many there are, and the first value reference of each; no array is empty. */
enum { STATES = @N@, INPUTS = @U@, PARAMETERS = @P@, OUTPUTS = @Y@, GUARDS = @K@ };
enum {
    TIME = 0,
    STATE = 1,
    RATE = STATE + STATES,
    INPUT = RATE + STATES,
    PARAMETER = INPUT + INPUTS,
    OUTPUT = PARAMETER + PARAMETERS,
    GUARD = OUTPUT + OUTPUTS,
    REFERENCES = GUARD + GUARDS
};

typedef struct {
    double t, state[STATES + 1], input[INPUTS + 1], parameter[PARAMETERS + 1], side[GUARDS + 1];
    double before[INPUTS + 1]; /* The inputs when event mode was entered. */
    double begin;              /* When the simulation began. */
} Values;

typedef struct {
    Values now;
    fmi3InstanceEnvironment environment;
    fmi3LogMessageCallback log;
} Model;

static const Values start = {0.0, {@STATES@}, {@INPUTS@}, {@PARAMETERS@}, {0.0}, {0.0}, 0.0};

static fmi3Status refused(fmi3Instance instance, const char *why)
{
    const Model *model = instance;
    if (model && model->log) {
        model->log(model->environment, fmi3Error, "logStatusError", why);
    }
    return fmi3Error;
}

@CALLS@
/* Time, states, rates, inputs, parameters, outputs, guards: in the order of their references. */
static void all_values(const Values *v, double *all)
{
    all[TIME] = v->t;
    memcpy(all + STATE, v->state, STATES * sizeof(double));
    rates(v, all + RATE);
    memcpy(all + INPUT, v->input, INPUTS * sizeof(double));
    memcpy(all + PARAMETER, v->parameter, PARAMETERS * sizeof(double));
    outputs(v, all + OUTPUT);
    margins(v, all + GUARD);
}

/* Where a value is kept that may be set; NULL for one that is computed. */
static double *place(Values *v, fmi3ValueReference reference)
{
    if (reference >= STATE && reference < RATE) {
        return v->state + (reference - STATE);
    }
    if (reference >= INPUT && reference < PARAMETER) {
        return v->input + (reference - INPUT);
    }
    if (reference >= PARAMETER && reference < OUTPUT) {
        return v->parameter + (reference - PARAMETER);
    }
    return NULL;
}

const char *fmi3GetVersion(void)
{
    return fmi3Version;
}

fmi3Status fmi3SetDebugLogging(fmi3Instance instance, fmi3Boolean on, size_t n, const fmi3String categories[])
{
    (void)instance, (void)on, (void)n, (void)categories;
    return fmi3OK;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log)
{
    Model *model;
    (void)name, (void)resources, (void)visible, (void)logging;
    if (!token || strcmp(token, "@TOKEN@") != 0) {
        if (log) {
            log(environment, fmi3Error, "logStatusError", "this binary is of another modelDescription.xml: the instantiation token differs");
        }
        return NULL;
    }
    model = malloc(sizeof(Model));
    if (model) {
        model->now = start;
        model->environment = environment;
        model->log = log;
    }
    return model;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean events, fmi3Boolean early, const fmi3ValueReference required[], size_t n,
                                         fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback update)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)events, (void)early, (void)required, (void)n;
    (void)environment, (void)log, (void)update;
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible,
                                               fmi3Boolean logging, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                               fmi3ClockUpdateCallback update, fmi3LockPreemptionCallback lock,
                                               fmi3UnlockPreemptionCallback unlock)
{
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)environment, (void)log, (void)update, (void)lock;
    (void)unlock;
    return NULL;
}

void fmi3FreeInstance(fmi3Instance instance)
{
    free(instance);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance, fmi3Float64 tolerance, fmi3Float64 time,
                                       fmi3Boolean has_stop, fmi3Float64 stop)
{
    (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
    ((Model *)instance)->now.t = time;
    return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance)
{
    Values *v = &((Model *)instance)->now;
    for (int i = 0; i < PARAMETERS; i++) {
        if (isnan(v->parameter[i])) {
            return refused(instance, "a parameter has no value: set every parameter whose start is NaN before the simulation begins");
        }
    }
    settle(v);
    v->begin = v->t;
    memcpy(v->before, v->input, sizeof v->before);
    return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance instance)
{
    Values *v = &((Model *)instance)->now;
    memcpy(v->before, v->input, sizeof v->before);
    return fmi3OK;
}

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance instance)
{
    ((Model *)instance)->now = start;
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3Float64 values[], size_t count)
{
    double all[REFERENCES + 1];
    if (n != count) {
        return refused(instance, "every variable is one number");
    }
    all_values(&((Model *)instance)->now, all);
    for (size_t i = 0; i < n; i++) {
        if (references[i] >= REFERENCES) {
            return refused(instance, "no variable has this value reference");
        }
        values[i] = all[references[i]];
    }
    return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3Float64 values[], size_t count)
{
    if (n != count) {
        return refused(instance, "every variable is one number");
    }
    for (size_t i = 0; i < n; i++) {
        double *kept = place(&((Model *)instance)->now, references[i]);
        if (!kept) {
            return refused(instance, "only states, inputs and parameters can be set");
        }
        *kept = values[i];
    }
    return fmi3OK;
}

fmi3Status fmi3SetTime(fmi3Instance instance, fmi3Float64 time)
{
    ((Model *)instance)->now.t = time;
    return fmi3OK;
}

fmi3Status fmi3SetContinuousStates(fmi3Instance instance, const fmi3Float64 states[], size_t n)
{
    if (n != STATES) {
        return refused(instance, "this is not the number of states");
    }
    memcpy(((Model *)instance)->now.state, states, n * sizeof(double));
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStates(fmi3Instance instance, fmi3Float64 states[], size_t n)
{
    if (n != STATES) {
        return refused(instance, "this is not the number of states");
    }
    memcpy(states, ((Model *)instance)->now.state, n * sizeof(double));
    return fmi3OK;
}

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance instance, fmi3Float64 derivatives[], size_t n)
{
    if (n != STATES) {
        return refused(instance, "this is not the number of states");
    }
    rates(&((Model *)instance)->now, derivatives);
    return fmi3OK;
}

fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance instance, fmi3Float64 nominals[], size_t n)
{
    (void)instance;
    for (size_t i = 0; i < n; i++) {
        nominals[i] = 1.0;
    }
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = STATES;
    return fmi3OK;
}

fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance instance, size_t *n)
{
    (void)instance;
    *n = GUARDS;
    return fmi3OK;
}

fmi3Status fmi3GetEventIndicators(fmi3Instance instance, fmi3Float64 indicators[], size_t n)
{
    if (n != GUARDS) {
        return refused(instance, "this is not the number of event indicators");
    }
    margins(&((Model *)instance)->now, indicators);
    return fmi3OK;
}

fmi3Status fmi3CompletedIntegratorStep(fmi3Instance instance, fmi3Boolean no_return, fmi3Boolean *event, fmi3Boolean *terminate)
{
    double margin[GUARDS + 1];
    (void)no_return;
    margins(&((Model *)instance)->now, margin);
    *event = fmi3False;
    *terminate = fmi3False;
    for (int k = 0; k < GUARDS; k++) {
        *event = *event || margin[k] < 0.0;
    }
    return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance instance)
{
    (void)instance;
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance instance, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals,
                                    fmi3Boolean *states, fmi3Boolean *has_next, fmi3Float64 *next)
{
    Values *v = &((Model *)instance)->now;
    *states = decide(v) ? fmi3True : fmi3False;
    memcpy(v->before, v->input, sizeof v->before);
    *again = *terminate = *nominals = *has_next = fmi3False;
    *next = 0.0;
    return fmi3OK;
}

fmi3Status fmi3GetFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    if (!*state) {
        *state = malloc(sizeof(Values));
    }
    if (!*state) {
        return refused(instance, "no memory is left");
    }
    memcpy(*state, &((Model *)instance)->now, sizeof(Values));
    return fmi3OK;
}

fmi3Status fmi3SetFMUState(fmi3Instance instance, fmi3FMUState state)
{
    memcpy(&((Model *)instance)->now, state, sizeof(Values));
    return fmi3OK;
}

fmi3Status fmi3FreeFMUState(fmi3Instance instance, fmi3FMUState *state)
{
    (void)instance;
    free(*state);
    *state = NULL;
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance instance, fmi3FMUState state, size_t *size)
{
    (void)instance, (void)state;
    *size = sizeof(Values);
    return fmi3OK;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance instance, fmi3FMUState state, fmi3Byte bytes[], size_t size)
{
    if (size < sizeof(Values)) {
        return refused(instance, "the state of this FMU takes more bytes");
    }
    memcpy(bytes, state, sizeof(Values));
    return fmi3OK;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance instance, const fmi3Byte bytes[], size_t size, fmi3FMUState *state)
{
    if (size < sizeof(Values)) {
        return refused(instance, "the state of this FMU takes more bytes");
    }
    if (!*state) {
        *state = malloc(sizeof(Values));
    }
    if (!*state) {
        return refused(instance, "no memory is left");
    }
    memcpy(*state, bytes, sizeof(Values));
    return fmi3OK;
}
