
@STILL
enum { sidc_states = @N@, sidc_switches = @K@ };
@JUMPS
enum { sidc_states = @N@, sidc_switches = @K@, sidc_jump_count = @R@ };

/* Each jump of states: its guard, and the side that the guard leaves. */
static const int sidc_jump_guards[] = {@JUMP_GUARDS@};
static const double sidc_jump_sides[] = {@JUMP_SIDES@};
/* For each guard that is the speed of a contact, the guard of its gap; else -1. */
static const int sidc_gaps[] = {@GAPS@};
/* The side of a guard that waits: the speed of bodies apart, the gap of bodies that lie on each other. */
static const double sidc_waits = 2.0;
@END

/* Solves the first n rows and columns of a times x = b in place of b. Where guards hold the same motion together, some of them do. */
static void sidc_guards_solve(int n, double a[sidc_switches][sidc_switches], double *b)
{
    double solved[sidc_switches] = {0}, largest = 0.0;
    int row = 0, column[sidc_switches] = {0};
    for (int i = 0; i < n * n; i++) {
        largest = fmax(largest, fabs(a[i / n][i % n]));
    }
    for (int k = 0; k < n; k++) {
        int pivot = row;
        for (int i = row + 1; i < n; i++) {
            if (fabs(a[i][k]) > fabs(a[pivot][k])) {
                pivot = i;
            }
        }
        if (row >= n || fabs(a[pivot][k]) <= 1e-10 * largest) {
            continue;
        }
        for (int j = 0; j < n; j++) {
            const double kept = a[row][j];
            a[row][j] = a[pivot][j];
            a[pivot][j] = kept;
        }
        const double kept = b[row];
        b[row] = b[pivot];
        b[pivot] = kept;
        for (int i = 0; i < n; i++) {
            const double factor = i == row ? 0.0 : a[i][k] / a[row][k];
            for (int j = 0; j < n; j++) {
                a[i][j] -= factor * a[row][j];
            }
            b[i] -= factor * b[row];
        }
        column[row++] = k;
    }
    for (int i = 0; i < row; i++) {
        solved[column[i]] = b[i] / a[i][column[i]];
    }
    for (int i = 0; i < n; i++) {
        b[i] = solved[i];
    }
}

/* The rates of guards that are contacts: start + slope times their sides. */
static void sidc_contacts(double t, const double *state@ARGS@, const double *side, int m, const int *contact, double *start,
                          double slope[sidc_switches][sidc_switches])
{
    double rest[sidc_switches], rate[sidc_switches];
    for (int k = 0; k < sidc_switches; k++) {
@STILL
        rest[k] = side[k];
@JUMPS
        rest[k] = side[k] == sidc_waits ? 0.0 : side[k];
@END
    }
    for (int i = 0; i < m; i++) {
        rest[contact[i]] = 0.0;
    }
    sidc_guard_rates(t, state@PASS@, rest, rate);
    for (int i = 0; i < m; i++) {
        start[i] = rate[contact[i]];
    }
    for (int j = 0; j < m; j++) {
        rest[contact[j]] = 1.0;
        sidc_guard_rates(t, state@PASS@, rest, rate);
        rest[contact[j]] = 0.0;
        for (int i = 0; i < m; i++) {
            slope[i][j] = rate[contact[i]] - start[i];
        }
    }
}

/* Sides with which all held guards stay at zero. */
static void sidc_held(double t, const double *state@ARGS@, const double *side, double *full)
{
    int contact[sidc_switches] = {0}, m = 0;
    double start[sidc_switches], slope[sidc_switches][sidc_switches];
    for (int k = 0; k < sidc_switches; k++) {
@STILL
        full[k] = side[k];
@JUMPS
        full[k] = side[k] == sidc_waits ? 0.0 : side[k];
@END
        if (side[k] == 0.0) {
            contact[m++] = k;
        }
    }
    if (m > 0) {
        sidc_contacts(t, state@PASS@, side, m, contact, start, slope);
        for (int i = 0; i < m; i++) {
            start[i] = -start[i];
        }
        sidc_guards_solve(m, slope, start);
        for (int i = 0; i < m; i++) {
            full[contact[i]] = start[i];
        }
    }
}

/* What stays above its floor until the next event. */
static void sidc_margins(double t, const double *state@ARGS@, const double *side, double *margin)
{
    double full[sidc_switches], guard[sidc_switches];
    sidc_held(t, state@PASS@, side, full);
    sidc_guards(t, state@PASS@, guard);
    for (int k = 0; k < sidc_switches; k++) {
@STILL
        margin[k] = side[k] == 0.0 ? 1.0 - fabs(full[k]) : side[k] * guard[k];
@JUMPS
        const double held = sidc_gaps[k] >= 0 ? -full[k] : 1.0 - fabs(full[k]);
        margin[k] = side[k] == sidc_waits ? 1.0 : side[k] == 0.0 ? held : side[k] * guard[k];
@END
    }
}

/* Whether all sides still hold; crossed tells of each guard that it does not. floor is zero, or what rounding left
   below it where a guard has just gone to its side. */
static int sidc_holds(double t, const double *state@ARGS@, const double *side, const double *floor, int *crossed)
{
    double margin[sidc_switches];
    int holds = 1;
    sidc_margins(t, state@PASS@, side, margin);
    for (int k = 0; k < sidc_switches; k++) {
        crossed[k] = margin[k] < floor[k];
        holds = holds && !crossed[k];
    }
    return holds;
}

@JUMPS
/* Lets the bodies of a contact part; k is the guard of their speed. */
static void sidc_open(double *side, int k)
{
    side[k] = sidc_waits;
    for (int r = 0; r < sidc_jump_count; r++) {
        if (sidc_jump_guards[r] == sidc_gaps[k]) {
            side[sidc_gaps[k]] = sidc_jump_sides[r];
        }
    }
}
@END

/* Sides after an event. A guard at zero is held (0) if some side between -1 and 1 keeps it there; else it goes where the rates lead. */
static void sidc_decide(double t, const double *state@ARGS@, double *side, const int *crossed)
{
    int contact[sidc_switches] = {0}, held[sidc_switches] = {0}, m = 0;
@JUMPS
    int touches[sidc_switches] = {0};
@END
    double start[sidc_switches], slope[sidc_switches][sidc_switches], own[sidc_switches] = {0}, rate[sidc_switches];
    for (int k = 0; k < sidc_switches; k++) {
        if (crossed[k] || side[k] == 0.0) {
            contact[m++] = k;
        }
    }
    sidc_contacts(t, state@PASS@, side, m, contact, start, slope);
    for (int i = 0; i < m; i++) {
        held[i] = slope[i][i] < 0.0;
        own[i] = held[i] ? 0.0 : start[i] < 0.0 ? -1.0 : 1.0;
@JUMPS
        touches[i] = sidc_gaps[contact[i]] >= 0; /* Bodies only push each other: the side is 0 or below it. */
        own[i] = touches[i] ? 0.0 : own[i];
@END
    }
    for (int pivot = 0; pivot < 200; pivot++) {
        int at[sidc_switches] = {0}, free = 0, wrong = -1;
        double a[sidc_switches][sidc_switches], b[sidc_switches];
        for (int i = 0; i < m; i++) {
            if (held[i]) {
                at[free++] = i;
                own[i] = 0.0;
            }
        }
        for (int i = 0; i < free; i++) {
            b[i] = -start[at[i]];
            for (int j = 0; j < m; j++) {
                b[i] -= slope[at[i]][j] * own[j];
            }
            for (int j = 0; j < free; j++) {
                a[i][j] = slope[at[i]][at[j]];
            }
        }
        sidc_guards_solve(free, a, b);
        for (int i = 0; i < free; i++) {
            own[at[i]] = b[i];
        }
        for (int i = m - 1; i >= 0; i--) {
            double size = fabs(start[i]);
            rate[i] = start[i];
            for (int j = 0; j < m; j++) {
                rate[i] += slope[i][j] * own[j];
                size += fabs(slope[i][j]);
            }
@STILL
            if (held[i] ? fabs(own[i]) >= 1.0 - 1e-9 : own[i] * rate[i] < -2e-9 * size) {
@JUMPS
            const double reached = touches[i] ? own[i] : fabs(own[i]) - (1.0 - 1e-9), way = touches[i] ? 1.0 : own[i];
            if (held[i] ? reached >= 0.0 : way * rate[i] < -2e-9 * size) {
@END
                wrong = i;
            }
        }
        if (wrong < 0) {
            break;
        }
        if (held[wrong]) {
            held[wrong] = 0;
            own[wrong] = own[wrong] < 0.0 ? -1.0 : 1.0;
@JUMPS
            own[wrong] = touches[wrong] ? 0.0 : own[wrong];
@END
        } else if (slope[wrong][wrong] < 0.0) {
            held[wrong] = 1;
        } else {
            own[wrong] = rate[wrong] < 0.0 ? -1.0 : 1.0;
        }
    }
    for (int i = 0; i < m; i++) {
        side[contact[i]] = held[i] ? 0.0 : own[i];
@JUMPS
        if (touches[i] && !held[i]) {
            sidc_open(side, contact[i]);
        }
@END
    }
}

/* How far guards can move in a step; 0 for those that are not crossed. */
static void sidc_reach(double t, double h, const double *state@ARGS@, const double *side, const int *crossed, double *reach)
{
    int contact[sidc_switches] = {0}, m = 0;
    double start[sidc_switches], slope[sidc_switches][sidc_switches];
    for (int k = 0; k < sidc_switches; k++) {
        reach[k] = 0.0;
        if (crossed[k]) {
            contact[m++] = k;
        }
    }
    sidc_contacts(t, state@PASS@, side, m, contact, start, slope);
    for (int i = 0; i < m; i++) {
        reach[contact[i]] = h * fabs(start[i]);
        for (int j = 0; j < m; j++) {
            reach[contact[i]] += h * fabs(slope[i][j]);
        }
    }
}

@JUMPS
/* Whether states jump where this guard leaves this side. */
static int sidc_jumps_at(int k, double side)
{
    int jumps = 0;
    for (int r = 0; r < sidc_jump_count; r++) {
        jumps = jumps || (sidc_jump_guards[r] == k && sidc_jump_sides[r] == side);
    }
    return jumps;
}

/* Moves state and sides past an event, at which the crossed guards are zero, or an input that jumped has moved them. States jump where
   guards leave the sides at which they do; one jump may set off another. */
static void sidc_pass(double t, double h, double *state@ARGS@, double *side, int *crossed, int are_zero)
{
    double before[sidc_states], rows[sidc_jump_count * sidc_states];
    double guard[sidc_switches], guard_before[sidc_switches], full[sidc_switches], rate[sidc_switches];
    double arrival[sidc_switches] = {0};
    int landed[sidc_switches] = {0}, left[sidc_switches] = {0};
    for (int round = 0; round < 64; round++) {
        int any = 0;
        for (int r = 0; r < sidc_jump_count; r++) {
            const int k = sidc_jump_guards[r];
            any = any || (crossed[k] && side[k] == sidc_jump_sides[r]);
        }
        if (!any) {
            double decided[sidc_switches];
            int near[sidc_switches], again = 0;
            sidc_guards(t, state@PASS@, guard);
            for (int k = 0; k < sidc_switches; k++) {
                const int away = (crossed[k] || landed[k]) && !are_zero && side[k] != 0.0 && guard[k] != 0.0;
                near[k] = crossed[k] && !away;
                landed[k] = landed[k] && !away;
                decided[k] = away ? (guard[k] < 0.0 ? -1.0 : 1.0) : side[k];
            }
            sidc_decide(t, state@PASS@, decided, near);
            sidc_held(t, state@PASS@, decided, full);
            sidc_guard_rates(t, state@PASS@, full, rate);
            for (int k = 0; k < sidc_switches; k++) {
                /* The jump did not turn it. */
                if (landed[k] && side[k] * rate[k] < -1e-9 * arrival[k]) {
                    decided[k] = -side[k];
                }
            }
            for (int r = 0; r < sidc_jump_count; r++) {
                const int k = sidc_jump_guards[r];
                if (side[k] == sidc_jump_sides[r] && decided[k] == -side[k] && !left[k]) {
                    crossed[k] = again = 1;
                }
            }
            if (!again) {
                for (int k = 0; k < sidc_switches; k++) {
                    side[k] = decided[k];
                }
                return;
            }
            for (int k = 0; k < sidc_switches; k++) {
                left[k] = 0;
            }
            continue;
        }
        for (int k = 0; k < sidc_switches; k++) {
            left[k] = 0;
        }
        for (int i = 0; i < sidc_states; i++) {
            before[i] = state[i];
        }
        sidc_guards(t, before@PASS@, guard_before);
        sidc_jumps(t, before@PASS@, rows);
        sidc_held(t, before@PASS@, side, full);
        sidc_guard_rates(t, before@PASS@, full, rate);
        for (int r = 0; r < sidc_jump_count; r++) {
            const int k = sidc_jump_guards[r];
            if (!crossed[k] || side[k] != sidc_jump_sides[r]) {
                continue;
            }
            left[k] = landed[k] = 1;
            arrival[k] = fabs(rate[k]);
            for (int i = 0; i < sidc_states; i++) {
                const double after = rows[sidc_states * r + i];
                state[i] = after != before[i] ? after : state[i];
            }
        }
        sidc_guards(t, state@PASS@, guard);
        for (int k = 0; k < sidc_switches; k++) {
            crossed[k] = crossed[k] && !left[k];
        }
        for (int k = 0; k < sidc_switches; k++) {
            if (guard[k] == guard_before[k] || side[k] == sidc_waits) {
                continue;
            }
            if (side[k] == 0.0 && sidc_gaps[k] >= 0) {
                crossed[sidc_gaps[k]] = guard[k] < 0.0;
                sidc_open(side, k);
            } else if (!left[k] && sidc_jumps_at(k, side[k]) && side[k] * guard[k] < 0.0) {
                crossed[k] = 1;
                landed[k] = 0;
            } else if (guard[k] != 0.0) {
                side[k] = guard[k] < 0.0 ? -1.0 : 1.0;
                landed[k] = 0;
            } else if (!sidc_jumps_at(k, side[k])) {
                crossed[k] = 1;
            }
        }
        for (int k = 0; k < sidc_switches; k++) {
            const int gap = sidc_gaps[k];
            if (gap < 0 || !left[gap] || !landed[gap]) {
                continue;
            }
            sidc_held(t, state@PASS@, side, full);
            sidc_guard_rates(t, state@PASS@, full, rate);
            /* The bodies stay together where the flight would last a small part of the step. */
            if (guard[k] >= 1e-9 * guard_before[k] && rate[k] < 0.0 && 2.0 * guard[k] < -1e-4 * h * rate[k]) {
                /* Where the jump would end at rest. */
                const double moved = guard_before[k] - guard[k];
                const double part = moved == 0.0 ? 1.0 : guard_before[k] / moved;
                for (int i = 0; i < sidc_states; i++) {
                    state[i] = before[i] + part * (state[i] - before[i]);
                }
                side[gap] = sidc_waits;
                side[k] = 0.0;
                landed[gap] = 0;
            }
        }
    }
    for (int i = 0; i < sidc_states; i++) {
        state[i] = NAN;
    }
}

@END
/* Lets go of guards that have moved away from zero or from their side, as by an input that jumped; states may jump there. */
@STILL
static void sidc_follow(double t, double h, const double *state@ARGS@, double *side)
@JUMPS
static void sidc_follow(double t, double h, double *state@ARGS@, double *side)
@END
{
    int apart[sidc_switches], any = 0;
    double guard[sidc_switches], reach[sidc_switches];
    sidc_guards(t, state@PASS@, guard);
    for (int k = 0; k < sidc_switches; k++) {
        apart[k] = side[k] == 0.0 ? guard[k] != 0.0 : side[k] * guard[k] < 0.0;
@JUMPS
        apart[k] = apart[k] && side[k] != sidc_waits;
@END
        any = any || apart[k];
    }
    if (!any) {
        return;
    }
    sidc_reach(t, h, state@PASS@, side, apart, reach);
@JUMPS
    any = 0;
@END
    for (int k = 0; k < sidc_switches; k++) {
        apart[k] = apart[k] && fabs(guard[k]) > 1e-7 * reach[k];
@STILL
        side[k] = apart[k] ? (guard[k] < 0.0 ? -1.0 : 1.0) : side[k];
@JUMPS
        any = any || apart[k];
@END
    }
@JUMPS
    if (any) {
        sidc_pass(t, h, state@PASS@, side, apart, 0);
    }
@END
}

/* The sides of all guards at an instant. */
void sidc_settle(double t, const double *state@ARGS@, double *side)
{
    int zero[sidc_switches];
@JUMPS
    double guard[sidc_switches], full[sidc_switches], pull[sidc_switches];
    sidc_guards(t, state@PASS@, guard);
@END
    sidc_guards(t, state@PASS@, side);
    for (int k = 0; k < sidc_switches; k++) {
        zero[k] = side[k] == 0.0;
        side[k] = side[k] < 0.0 ? -1.0 : 1.0;
@JUMPS
        side[k] = sidc_gaps[k] >= 0 ? sidc_waits : side[k];
        zero[k] = zero[k] && sidc_gaps[k] < 0;
    }
    for (int r = 0; r < sidc_jump_count; r++) {
        const int k = sidc_jump_guards[r];
        side[k] = zero[k] ? sidc_jump_sides[r] : side[k];
    }
    for (int r = 0; r < sidc_jump_count; r++) {
        zero[sidc_jump_guards[r]] = 0;
@END
    }
    sidc_decide(t, state@PASS@, side, zero);
@JUMPS
    sidc_held(t, state@PASS@, side, full);
    sidc_guard_rates(t, state@PASS@, full, pull);
    for (int k = 0; k < sidc_switches; k++) {
        zero[k] = 0;
        if (sidc_gaps[k] >= 0 && guard[sidc_gaps[k]] == 0.0 && guard[k] == 0.0 && pull[k] < 0.0) {
            side[sidc_gaps[k]] = sidc_waits;
            side[k] = 0.0;
        }
    }
    sidc_decide(t, state@PASS@, side, zero);
@END
}

static void sidc_classical(double t, const double *state@ARGS@, double h, const double *side, double *end)
{
    static const double part[] = {0.0, 0.5, 0.5, 1.0}, weight[] = {1.0, 2.0, 2.0, 1.0};
    double point[sidc_states], rate[sidc_states], full[sidc_switches];
    for (int i = 0; i < sidc_states; i++) {
        end[i] = state[i];
        rate[i] = 0.0;
    }
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < sidc_states; i++) {
            point[i] = state[i] + part[stage] * h * rate[i];
        }
        sidc_held(t + part[stage] * h, point@PASS@, side, full);
        sidc_rates_by_side(t + part[stage] * h, point@PASS@, full, rate);
        for (int i = 0; i < sidc_states; i++) {
            end[i] += h / 6.0 * weight[stage] * rate[i];
        }
    }
}

/* One step of length h with inputs held, cut at the events within it. state and side, which sidc_settle begins, move to its end. A side is
   1, -1, or 0 where the guard is held at zero, as by dry friction at rest. The state is NAN where events accumulate. */
void sidc_advance(double t, double h, double *state@ARGS@, double *side)
{
    double end[sidc_states], there[sidc_states], after[sidc_switches], guard[sidc_switches], floor[sidc_switches], done = 0.0;
    int crossed[sidc_switches], is_finite = 1;
@JUMPS
    int passed[sidc_switches];
@END
    sidc_follow(t, h, state@PASS@, side);
    for (int event = 0; event < 1000; event++) {
        double low = 0.0, high = h - done;
        int same = 1;
        for (int k = 0; k < sidc_switches; k++) {
            floor[k] = 0.0;
        }
        sidc_classical(t + done, state@PASS@, high, side, end);
        for (int i = 0; i < sidc_states; i++) {
            is_finite = is_finite && fabs(end[i]) < INFINITY;
        }
        if (!is_finite || sidc_holds(t + h, end@PASS@, side, floor, crossed)) {
            break;
        }
        sidc_margins(t + done, state@PASS@, side, floor);
        for (int k = 0; k < sidc_switches; k++) {
            floor[k] = side[k] == 0.0 ? 0.0 : fmin(floor[k], 0.0);
        }
        if (sidc_holds(t + h, end@PASS@, side, floor, crossed)) {
            break;
        }
        if (event == 999) {
            for (int i = 0; i < sidc_states; i++) {
                end[i] = NAN;
            }
            break;
        }
@JUMPS
        double at;
@END
        for (int halving = 0; halving < 52; halving++) {
            const double middle = 0.5 * (low + high);
            sidc_classical(t + done, state@PASS@, middle, side, there);
            if (sidc_holds(t + done + middle, there@PASS@, side, floor, crossed)) {
                low = middle;
            } else {
                high = middle;
            }
        }
@STILL
        sidc_classical(t + done, state@PASS@, high, side, there);
        done += high;
        sidc_holds(t + done, there@PASS@, side, floor, crossed);
@JUMPS
        at = low;
        /* States jump where their guards are still on the sides that they leave. */
        sidc_classical(t + done, state@PASS@, high, side, there);
        sidc_holds(t + done + high, there@PASS@, side, floor, crossed);
        for (int k = 0; k < sidc_switches; k++) {
            at = crossed[k] && !sidc_jumps_at(k, side[k]) ? high : at;
        }
        sidc_classical(t + done, state@PASS@, at, side, there);
        done += at;
@END
        for (int k = 0; k < sidc_switches; k++) {
            after[k] = side[k];
        }
@STILL
        sidc_decide(t + done, there@PASS@, after, crossed);
@JUMPS
        for (int i = 0; i < sidc_states; i++) {
            state[i] = there[i];
        }
        for (int k = 0; k < sidc_switches; k++) {
            passed[k] = crossed[k];
        }
        sidc_pass(t + done, h, there@PASS@, after, passed, 1);
        for (int i = 0; i < sidc_states; i++) {
            same = same && there[i] == state[i];
        }
@END
        for (int k = 0; k < sidc_switches; k++) {
            same = same && after[k] == side[k];
        }
        sidc_guards(t + h, end@PASS@, guard);
        for (int k = 0; k < sidc_switches; k++) {
@STILL
            side[k] = same && crossed[k] && high < 1e-12 * h ? (guard[k] < 0.0 ? -1.0 : 1.0) : after[k];
@JUMPS
            const int beyond = same && crossed[k] && high < 1e-12 * h && !sidc_jumps_at(k, side[k]);
            side[k] = beyond && sidc_gaps[k] < 0 ? (guard[k] < 0.0 ? -1.0 : 1.0) : after[k];
            if (beyond && sidc_gaps[k] >= 0) {
                sidc_open(after, k);
                sidc_open(side, k);
            }
@END
        }
        for (int i = 0; i < sidc_states; i++) {
            state[i] = there[i];
        }
    }
    for (int i = 0; i < sidc_states; i++) {
        state[i] = end[i];
    }
}
