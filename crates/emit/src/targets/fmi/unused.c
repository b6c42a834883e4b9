
/* What FMI has for variables of other types, clocks, structural parameters and other kinds of FMU. */
static fmi3Status none(fmi3Instance instance, size_t n)
{
    return n == 0 ? fmi3OK : refused(instance, "every variable is a Float64");
}

static fmi3Status absent(fmi3Instance instance)
{
    return refused(instance, "this FMU has no such feature");
}

#define SIDC_NO_TYPE(type)                                                                                                              \
    fmi3Status fmi3Get##type(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3##type values[], size_t count) \
    {                                                                                                                                   \
        (void)references, (void)values, (void)count;                                                                                    \
        return none(instance, n);                                                                                                       \
    }                                                                                                                                   \
    fmi3Status fmi3Set##type(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3##type values[],         \
                             size_t count)                                                                                              \
    {                                                                                                                                   \
        (void)references, (void)values, (void)count;                                                                                    \
        return none(instance, n);                                                                                                       \
    }

SIDC_NO_TYPE(Float32)
SIDC_NO_TYPE(Int8)
SIDC_NO_TYPE(UInt8)
SIDC_NO_TYPE(Int16)
SIDC_NO_TYPE(UInt16)
SIDC_NO_TYPE(Int32)
SIDC_NO_TYPE(UInt32)
SIDC_NO_TYPE(Int64)
SIDC_NO_TYPE(UInt64)
SIDC_NO_TYPE(Boolean)
SIDC_NO_TYPE(String)

fmi3Status fmi3GetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t n, size_t sizes[], fmi3Binary values[],
                         size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return none(instance, n);
}

fmi3Status fmi3SetBinary(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const size_t sizes[],
                         const fmi3Binary values[], size_t count)
{
    (void)references, (void)sizes, (void)values, (void)count;
    return none(instance, n);
}

fmi3Status fmi3GetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3Clock values[])
{
    (void)references, (void)values;
    return none(instance, n);
}

fmi3Status fmi3SetClock(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3Clock values[])
{
    (void)references, (void)values;
    return none(instance, n);
}

fmi3Status fmi3GetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3Float64 intervals[],
                                  fmi3IntervalQualifier qualifiers[])
{
    (void)references, (void)intervals, (void)qualifiers;
    return none(instance, n);
}

fmi3Status fmi3GetIntervalFraction(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3UInt64 counters[],
                                   fmi3UInt64 resolutions[], fmi3IntervalQualifier qualifiers[])
{
    (void)references, (void)counters, (void)resolutions, (void)qualifiers;
    return none(instance, n);
}

fmi3Status fmi3GetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3Float64 shifts[])
{
    (void)references, (void)shifts;
    return none(instance, n);
}

fmi3Status fmi3GetShiftFraction(fmi3Instance instance, const fmi3ValueReference references[], size_t n, fmi3UInt64 counters[],
                                fmi3UInt64 resolutions[])
{
    (void)references, (void)counters, (void)resolutions;
    return none(instance, n);
}

fmi3Status fmi3SetIntervalDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3Float64 intervals[])
{
    (void)references, (void)intervals;
    return none(instance, n);
}

fmi3Status fmi3SetIntervalFraction(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3UInt64 counters[],
                                   const fmi3UInt64 resolutions[])
{
    (void)references, (void)counters, (void)resolutions;
    return none(instance, n);
}

fmi3Status fmi3SetShiftDecimal(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3Float64 shifts[])
{
    (void)references, (void)shifts;
    return none(instance, n);
}

fmi3Status fmi3SetShiftFraction(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3UInt64 counters[],
                                const fmi3UInt64 resolutions[])
{
    (void)references, (void)counters, (void)resolutions;
    return none(instance, n);
}

fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance instance, fmi3ValueReference reference, size_t *n)
{
    (void)reference, (void)n;
    return absent(instance);
}

fmi3Status fmi3GetVariableDependencies(fmi3Instance instance, fmi3ValueReference dependent, size_t elements[],
                                       fmi3ValueReference independents[], size_t others[], fmi3DependencyKind kinds[], size_t n)
{
    (void)dependent, (void)elements, (void)independents, (void)others, (void)kinds, (void)n;
    return absent(instance);
}

fmi3Status fmi3GetAdjointDerivative(fmi3Instance instance, const fmi3ValueReference unknowns[], size_t n, const fmi3ValueReference knowns[],
                                    size_t m, const fmi3Float64 seed[], size_t seeds, fmi3Float64 sensitivity[], size_t sensitivities)
{
    (void)unknowns, (void)n, (void)knowns, (void)m, (void)seed, (void)seeds, (void)sensitivity, (void)sensitivities;
    return absent(instance);
}

fmi3Status fmi3EnterConfigurationMode(fmi3Instance instance)
{
    return absent(instance);
}

fmi3Status fmi3ExitConfigurationMode(fmi3Instance instance)
{
    return absent(instance);
}

fmi3Status fmi3EnterStepMode(fmi3Instance instance)
{
    return absent(instance);
}

fmi3Status fmi3GetOutputDerivatives(fmi3Instance instance, const fmi3ValueReference references[], size_t n, const fmi3Int32 orders[],
                                    fmi3Float64 values[], size_t count)
{
    (void)references, (void)n, (void)orders, (void)values, (void)count;
    return absent(instance);
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step, fmi3Boolean no_return, fmi3Boolean *event,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last)
{
    (void)time, (void)step, (void)no_return, (void)event, (void)terminate, (void)early, (void)last;
    return absent(instance);
}

fmi3Status fmi3ActivateModelPartition(fmi3Instance instance, fmi3ValueReference clock, fmi3Float64 time)
{
    (void)clock, (void)time;
    return absent(instance);
}
