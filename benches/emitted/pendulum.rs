// Written by sidc: the identified system pendulum_on_cart as code.
// verdict: passes
//
// state is the state: y, dy, theta, dtheta
// input is the inputs: F

/// The verdict on these equations.
#[allow(dead_code)]
pub const SIDC_VERDICT: &str = "passes";

/// Name, value, standard error (0 where the model states the value) and unit of each number that was found.
#[allow(dead_code, clippy::all)]
pub const SIDC_PARAMETERS: [(&str, f64, f64, &str); 7] = [
    // ddy: F
    ("ddy_F", 1.2903225806451613, f64::NAN, ""),
    // ddy: dy
    ("ddy_dy", -0.06451612903225806, f64::NAN, ""),
    // ddy: ddtheta*cos(theta)
    ("ddy_ddtheta_cos_theta", -0.1774193548387097, f64::NAN, ""),
    // ddy: dtheta^2*sin(theta)
    ("ddy_dtheta2_sin_theta", 0.1774193548387097, f64::NAN, ""),
    // ddtheta: dtheta
    ("ddtheta_dtheta", -0.14545454545454545, f64::NAN, ""),
    // ddtheta: sin(theta)
    ("ddtheta_sin_theta", -19.6, f64::NAN, ""),
    // ddtheta: ddy*cos(theta)
    ("ddtheta_ddy_cos_theta", -2.0, f64::NAN, ""),
];

/// The time derivative of the state.
#[allow(unused_variables, non_snake_case, clippy::all)]
pub fn derivatives(t: f64, state: &[f64; 4], input: &[f64; 1]) -> [f64; 4] {
    let dy = state[1];
    let theta = state[2];
    let dtheta = state[3];
    let F = input[0];
    let cos_theta = f64::cos(theta);
    let sin_theta = f64::sin(theta);
    let [[ddy], [ddtheta]] = solve_2(
        [[1.0, 0.1774193548387097 * cos_theta], [2.0 * cos_theta, 1.0]],
        [
            [-0.06451612903225806 * dy + 0.1774193548387097 * (dtheta * dtheta * sin_theta) + 1.2903225806451613 * F],
            [-0.14545454545454545 * dtheta - 19.6 * sin_theta],
        ],
    );
    [dy, ddy, dtheta, ddtheta]
}

/// The partial derivatives of `derivatives` (rows) by the state (columns).
#[allow(unused_variables, non_snake_case, clippy::all)]
pub fn jacobian(t: f64, state: &[f64; 4], input: &[f64; 1]) -> [[f64; 4]; 4] {
    let dy = state[1];
    let theta = state[2];
    let dtheta = state[3];
    let F = input[0];
    let cos_theta = f64::cos(theta);
    let w1 = 0.1774193548387097 * cos_theta;
    let w2 = 2.0 * cos_theta;
    let w3 = dtheta * dtheta;
    let sin_theta = f64::sin(theta);
    let [[ddy], [ddtheta]] = solve_2(
        [[1.0, w1], [w2, 1.0]],
        [
            [-0.06451612903225806 * dy + 0.1774193548387097 * (w3 * sin_theta) + 1.2903225806451613 * F],
            [-0.14545454545454545 * dtheta - 19.6 * sin_theta],
        ],
    );
    let [[ddy_by_dy, ddy_by_theta, ddy_by_dtheta], [ddtheta_by_dy, ddtheta_by_theta, ddtheta_by_dtheta]] = solve_2(
        [[1.0, w1], [w2, 1.0]],
        [
            [-0.06451612903225806, 0.1774193548387097 * (cos_theta * w3) + 0.1774193548387097 * (sin_theta * ddtheta), 0.3548387096774194 * (dtheta * sin_theta)],
            [0.0, 2.0 * (sin_theta * ddy) - 19.6 * cos_theta, -0.14545454545454545],
        ],
    );
    let mut slope = [[0.0; 4]; 4];
    slope[0][1] = 1.0;
    slope[1][1] = ddy_by_dy;
    slope[1][2] = ddy_by_theta;
    slope[1][3] = ddy_by_dtheta;
    slope[2][3] = 1.0;
    slope[3][1] = ddtheta_by_dy;
    slope[3][2] = ddtheta_by_theta;
    slope[3][3] = ddtheta_by_dtheta;
    slope
}

/// The partial derivatives of `derivatives` (rows) by the input (columns).
#[allow(unused_variables, non_snake_case, clippy::all)]
pub fn jacobian_input(t: f64, state: &[f64; 4], input: &[f64; 1]) -> [[f64; 1]; 4] {
    let theta = state[2];
    let cos_theta = f64::cos(theta);
    let [[ddy_by_F], [ddtheta_by_F]] = solve_2(
        [[1.0, 0.1774193548387097 * cos_theta], [2.0 * cos_theta, 1.0]],
        [[1.2903225806451613], [0.0]],
    );
    let mut slope = [[0.0; 1]; 4];
    slope[1][0] = ddy_by_F;
    slope[3][0] = ddtheta_by_F;
    slope
}

/// One step of length h by the classical method of Runge and Kutta; what is not the state is held during it.
#[allow(dead_code, clippy::all)]
pub fn step(t: f64, h: f64, state: &[f64; 4], input: &[f64; 1]) -> [f64; 4] {
    let (mut rate, mut sum) = ([0.0; 4], [0.0; 4]);
    for (part, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
        let point = core::array::from_fn(|i| state[i] + part * h * rate[i]);
        rate = derivatives(t + part * h, &point, input);
        sum = core::array::from_fn(|i| sum[i] + weight * rate[i]);
    }
    core::array::from_fn(|i| state[i] + h / 6.0 * sum[i])
}

/// Solves a linear system of two unknowns, column by column of the right side; NaN where it is singular.
#[inline]
#[allow(clippy::all)]
fn solve_2<const K: usize>(a: [[f64; 2]; 2], b: [[f64; K]; 2]) -> [[f64; K]; 2] {
    let swap = a[1][0].abs() > a[0][0].abs();
    let ([first, second], [upper, lower]) = if swap {
        ([a[1], a[0]], [b[1], b[0]])
    } else {
        (a, b)
    };
    let factor = second[0] / first[0];
    let last = second[1] - factor * first[1];
    if first[0] == 0.0 || last == 0.0 {
        return [[f64::NAN; K]; 2];
    }
    let mut solved = [upper, lower];
    for c in 0..K {
        let y = (lower[c] - factor * upper[c]) / last;
        solved[0][c] = (upper[c] - first[1] * y) / first[0];
        solved[1][c] = y;
    }
    solved
}
