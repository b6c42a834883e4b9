
enum { sidc_states = @N@, sidc_switches = @K@ };

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
        rest[k] = side[k];
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
        full[k] = side[k];
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

/* Whether all sides still hold; crossed tells of each guard that it does not. */
static int sidc_holds(double t, const double *state@ARGS@, const double *side, int *crossed)
{
    double full[sidc_switches], guard[sidc_switches];
    int holds = 1;
    sidc_held(t, state@PASS@, side, full);
    sidc_guards(t, state@PASS@, guard);
    for (int k = 0; k < sidc_switches; k++) {
        crossed[k] = (side[k] == 0.0 ? 1.0 - fabs(full[k]) : side[k] * guard[k]) < 0.0;
        holds = holds && !crossed[k];
    }
    return holds;
}

/* Lets go of guards that have moved away from zero or from their side, as by an input that jumped. */
static void sidc_follow(double t, double h, const double *state@ARGS@, double *side)
{
    int apart[sidc_switches] = {0}, m = 0;
    double guard[sidc_switches], start[sidc_switches], slope[sidc_switches][sidc_switches];
    sidc_guards(t, state@PASS@, guard);
    for (int k = 0; k < sidc_switches; k++) {
        if (side[k] == 0.0 ? guard[k] != 0.0 : side[k] * guard[k] < 0.0) {
            apart[m++] = k;
        }
    }
    if (m == 0) {
        return;
    }
    sidc_contacts(t, state@PASS@, side, m, apart, start, slope);
    for (int i = 0; i < m; i++) {
        double reach = h * fabs(start[i]);
        for (int j = 0; j < m; j++) {
            reach += h * fabs(slope[i][j]);
        }
        if (fabs(guard[apart[i]]) > 1e-7 * reach) {
            side[apart[i]] = guard[apart[i]] < 0.0 ? -1.0 : 1.0;
        }
    }
}

/* Sides after an event. A guard at zero is held (0) if some side between -1 and 1 keeps it there; else it goes where the rates lead. */
static void sidc_decide(double t, const double *state@ARGS@, double *side, const int *crossed)
{
    int contact[sidc_switches] = {0}, held[sidc_switches] = {0}, m = 0;
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
    }
    for (int pivot = 0; pivot < 200; pivot++) {
        int at[sidc_switches], free = 0, wrong = -1;
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
            if (held[i] ? fabs(own[i]) >= 1.0 - 1e-9 : own[i] * rate[i] < -2e-9 * size) {
                wrong = i;
            }
        }
        if (wrong < 0) {
            break;
        }
        if (held[wrong]) {
            held[wrong] = 0;
            own[wrong] = own[wrong] < 0.0 ? -1.0 : 1.0;
        } else if (slope[wrong][wrong] < 0.0) {
            held[wrong] = 1;
        } else {
            own[wrong] = rate[wrong] < 0.0 ? -1.0 : 1.0;
        }
    }
    for (int i = 0; i < m; i++) {
        side[contact[i]] = held[i] ? 0.0 : own[i];
    }
}

/* The sides of all guards at an instant. */
void sidc_settle(double t, const double *state@ARGS@, double *side)
{
    int zero[sidc_switches];
    sidc_guards(t, state@PASS@, side);
    for (int k = 0; k < sidc_switches; k++) {
        zero[k] = side[k] == 0.0;
        side[k] = side[k] < 0.0 ? -1.0 : 1.0;
    }
    sidc_decide(t, state@PASS@, side, zero);
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
   1, -1, or 0 where the guard is held at zero, as by dry friction at rest. */
void sidc_advance(double t, double h, double *state@ARGS@, double *side)
{
    double end[sidc_states], there[sidc_states], after[sidc_switches], guard[sidc_switches], done = 0.0;
    int crossed[sidc_switches];
    sidc_follow(t, h, state@PASS@, side);
    for (int event = 0; event < 100; event++) {
        double low = 0.0, high = h - done;
        int same = 1;
        sidc_classical(t + done, state@PASS@, high, side, end);
        if (sidc_holds(t + h, end@PASS@, side, crossed)) {
            break;
        }
        for (int halving = 0; halving < 52; halving++) {
            const double middle = 0.5 * (low + high);
            sidc_classical(t + done, state@PASS@, middle, side, there);
            if (sidc_holds(t + done + middle, there@PASS@, side, crossed)) {
                low = middle;
            } else {
                high = middle;
            }
        }
        sidc_classical(t + done, state@PASS@, high, side, there);
        done += high;
        sidc_holds(t + done, there@PASS@, side, crossed);
        for (int k = 0; k < sidc_switches; k++) {
            after[k] = side[k];
        }
        sidc_decide(t + done, there@PASS@, after, crossed);
        for (int k = 0; k < sidc_switches; k++) {
            same = same && after[k] == side[k];
        }
        sidc_guards(t + h, end@PASS@, guard);
        for (int k = 0; k < sidc_switches; k++) {
            side[k] = same && crossed[k] && high < 1e-12 * h ? (guard[k] < 0.0 ? -1.0 : 1.0) : after[k];
        }
        for (int i = 0; i < sidc_states; i++) {
            state[i] = there[i];
        }
    }
    for (int i = 0; i < sidc_states; i++) {
        state[i] = end[i];
    }
}
