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

/* Moves sides and states past an event: whether the states jumped. */
static int decide(Values *v)
{
@DECIDE@
}
