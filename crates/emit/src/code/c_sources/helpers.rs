//! C helpers of the emitted functions: solvers, Newton's method, steps. Written in double precision; [`in_single`] converts them.

/// Steps from event to event.
pub(super) const STEPS: &str = include_str!("../../targets/event_steps/steps.c");

pub(super) const SOLVE_1: &str = "
/* Solves a times x = b (1 x columns) in place of b; NaN where a is zero. */
static inline void sidc_solve_1(int columns, const double *a, double *b)
{
    for (int j = 0; j < columns; j++) {
        b[j] = a[0] == 0.0 ? NAN : b[j] / a[0];
    }
}
";

pub(super) const SOLVE_2: &str = "
/* Solves a (2 x 2) times x = b (2 x columns) in place of b; NaN where a is singular. */
static inline void sidc_solve_2(int columns, const double *a, double *b)
{
    const int first = fabs(a[2]) > fabs(a[0]), second = 1 - first;
    const double pivot = a[2 * first], above = a[2 * first + 1];
    const double factor = a[2 * second] / pivot;
    const double last = a[2 * second + 1] - factor * above;
    for (int j = 0; j < columns; j++) {
        const double upper = b[columns * first + j];
        const double y = (b[columns * second + j] - factor * upper) / last;
        const double x = (upper - above * y) / pivot;
        b[j] = pivot == 0.0 || last == 0.0 ? NAN : x;
        b[columns + j] = pivot == 0.0 || last == 0.0 ? NAN : y;
    }
}
";

/// Gaussian elimination with partial pivoting; NaN where the matrix is singular.
pub(super) const SOLVE: &str = "
/* Solves a (n x n) times x = b (n x columns) in place of b; NaN where a is singular. */
static inline void sidc_solve(int n, int columns, double *a, double *b)
{
    for (int k = 0; k < n; k++) {
        int pivot = k;
        for (int i = k + 1; i < n; i++) {
            if (fabs(a[i * n + k]) > fabs(a[pivot * n + k])) {
                pivot = i;
            }
        }
        if (pivot != k) {
            for (int j = k; j < n; j++) {
                const double kept = a[k * n + j];
                a[k * n + j] = a[pivot * n + j];
                a[pivot * n + j] = kept;
            }
            for (int j = 0; j < columns; j++) {
                const double kept = b[k * columns + j];
                b[k * columns + j] = b[pivot * columns + j];
                b[pivot * columns + j] = kept;
            }
        }
        if (a[k * n + k] == 0.0) {
            for (int i = 0; i < n * columns; i++) {
                b[i] = NAN;
            }
            return;
        }
        for (int i = k + 1; i < n; i++) {
            const double factor = a[i * n + k] / a[k * n + k];
            for (int j = k + 1; j < n; j++) {
                a[i * n + j] -= factor * a[k * n + j];
            }
            for (int j = 0; j < columns; j++) {
                b[i * columns + j] -= factor * b[k * columns + j];
            }
        }
    }
    for (int k = n - 1; k >= 0; k--) {
        for (int j = 0; j < columns; j++) {
            for (int i = k + 1; i < n; i++) {
                b[k * columns + j] -= a[k * n + i] * b[i * columns + j];
            }
            b[k * columns + j] /= a[k * n + k];
        }
    }
}
";

pub(super) const NEWTON: &str = "
/* Takes the next unknowns and tells if they stay; after the last step, NaN if they do not. */
static int sidc_settled(int n, double *unknown, const double *next, int last)
{
    double moved = 0.0, size = 0.0;
    for (int i = 0; i < n; i++) {
        moved = fmax(moved, fabs(next[i] - unknown[i]));
        size = fmax(size, fabs(next[i]));
        unknown[i] = next[i];
    }
    const int settled = moved <= 1e-12 * size;
    for (int i = 0; i < n && last && !settled; i++) {
        unknown[i] = NAN;
    }
    return settled;
}
";

pub(super) const ROOT: &str = "
/* The square root; that of -0.0 is 0.0. */
static inline double sidc_root(double x)
{
    return x == -INFINITY ? INFINITY : sqrt(x + 0.0);
}
";

pub(super) const SIGN: &str = "
/* -1, 0 or 1. */
static inline double sidc_sign(double x)
{
    return x > 0.0 ? 1.0 : x < 0.0 ? -1.0 : x;
}
";

/// One Runge–Kutta step; `fill_placeholders` fills in the number of states and the arguments.
pub(super) const STEP: &str = "
/* One step of length h by the classical method of Runge and Kutta; what is not the state is held during it. */
void sidc_step(double t, double h, double *state@ARGS@)
{
    static const double part[] = {0.0, 0.5, 0.5, 1.0}, weight[] = {1.0, 2.0, 2.0, 1.0};
    double point[@N@], rate[@N@] = {0.0}, sum[@N@] = {0.0};
    for (int stage = 0; stage < 4; stage++) {
        for (int i = 0; i < @N@; i++) {
            point[i] = state[i] + part[stage] * h * rate[i];
        }
        sidc_derivatives(t + part[stage] * h, point@PASS@, rate);
        for (int i = 0; i < @N@; i++) {
            sum[i] += weight[stage] * rate[i];
        }
    }
    for (int i = 0; i < @N@; i++) {
        state[i] += h / 6.0 * sum[i];
    }
}
";

/// Converts a helper to single precision.
pub(super) fn in_single(text: &str) -> String {
    const PAIRS: [(&str, &str); 10] = [
        ("double", "float"),
        ("fabs(", "fabsf("),
        ("fmax(", "fmaxf("),
        ("sqrt(", "sqrtf("),
        ("0.0", "0.0f"),
        ("1.0", "1.0f"),
        ("0.5", "0.5f"),
        ("2.0", "2.0f"),
        ("6.0", "6.0f"),
        // Twelve digits are more than single precision has.
        ("1e-12", "1e-6f"),
    ];
    let all = PAIRS.iter();
    all.fold(text.to_string(), |text, (double, float)| {
        text.replace(double, float)
    })
}
