
/* How a rate or a state moves with a state or an input; NaN for other variables. */
static double slope_of(const double *by_state, const double *by_input, fmi3ValueReference unknown, fmi3ValueReference known)
{
    const int from_state = known >= STATE && known < RATE, from_input = known >= INPUT && known < PARAMETER;
    if (unknown >= RATE && unknown < INPUT && from_state) {
        return by_state[(unknown - RATE) * STATES + (known - STATE)];
    }
    if (unknown >= RATE && unknown < INPUT && from_input) {
        return by_input[(unknown - RATE) * INPUTS + (known - INPUT)];
    }
    if (unknown >= STATE && unknown < RATE && (from_state || from_input)) {
        return unknown == known ? 1.0 : 0.0;
    }
    return NAN;
}

fmi3Status fmi3GetDirectionalDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t n,
                                        const fmi3ValueReference knowns[], size_t m, const fmi3Float64 seed[], size_t seeds,
                                        fmi3Float64 sensitivity[], size_t sensitivities)
{
    const Values *v = &((Model *)instance)->now;
    double by_state[STATES * STATES + 1], by_input[STATES * INPUTS + 1];
    if (n != sensitivities || m != seeds) {
        return refused(instance, "every variable is one number");
    }
@JACOBIANS@
    for (size_t i = 0; i < n; i++) {
        sensitivity[i] = 0.0;
        for (size_t j = 0; j < m; j++) {
            sensitivity[i] += slope_of(by_state, by_input, unknowns[i], knowns[j]) * seed[j];
        }
    }
    return fmi3OK;
}
