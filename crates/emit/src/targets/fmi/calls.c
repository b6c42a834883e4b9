static void rates(const Values *v, double *rate)
{
@RATES@
}

static void outputs(const Values *v, double *output)
{
@OUTPUTS@
}

/* What stays above zero until the next event. */
static void margins(const Values *v, double *margin)
{
@MARGINS@
}

/* The sides of the guards to begin with. */
static void settle(Values *v)
{
@SETTLE@
}

/* The sides of the guards after an event; no event changes the state. */
static void decide(Values *v)
{
@DECIDE@
}
