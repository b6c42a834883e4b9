use super::{Descent, LeastSquares, difference_equations, levenberg_marquardt};
use nalgebra::{DMatrix, DVector};

/// Rosenbrock's valley (Computer Journal 3, 1960) in x and y, and an unknown that moves nothing. Nothing can be computed for x > 2.
#[derive(Default)]
struct Valley {
    fits: usize,
    equations: usize,
}

const DESCENT: Descent = Descent {
    steps: 100,
    converged: 0.0,
    still: 1e-12,
};

impl LeastSquares for Valley {
    type Point = [f64; 3];
    type Fit = DVector<f64>;

    fn fit(&mut self, &[x, y, _]: &[f64; 3]) -> Option<DVector<f64>> {
        self.fits += 1;
        (x <= 2.0).then(|| DVector::from_vec(vec![10.0 * (y - x * x), 1.0 - x]))
    }

    fn value(&self, left: &DVector<f64>) -> f64 {
        left.norm_squared()
    }

    fn normal_equations(
        &mut self,
        &[x, _, _]: &[f64; 3],
        left: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        self.equations += 1;
        let slopes = DMatrix::from_row_slice(2, 3, &[-20.0 * x, 10.0, 0.0, -1.0, 0.0, 0.0]);
        Some((slopes.tr_mul(&slopes), -slopes.tr_mul(left)))
    }

    fn moved(&self, at: &[f64; 3], step: &DVector<f64>) -> [f64; 3] {
        std::array::from_fn(|i| at[i] + step[i])
    }
}

#[test]
fn a_curved_valley_is_followed_to_its_lowest_point() {
    let mut valley = Valley::default();
    let found = levenberg_marquardt(&mut valley, [-1.2, 1.0, 7.0], DESCENT).unwrap();
    let [x, y, z] = found.point;
    assert!((x - 1.0).abs() < 1e-9 && (y - 1.0).abs() < 1e-9, "{x} {y}");
    assert_eq!(z, 7.0, "what moves nothing stays");
    assert!(found.fit.norm() < 1e-9 && found.normal.is_some());
}

#[test]
fn equations_are_formed_anew_only_where_the_point_has_moved() {
    let mut valley = Valley::default();
    levenberg_marquardt(&mut valley, [-1.2, 1.0, 0.0], DESCENT);
    assert!(
        valley.equations < valley.fits,
        "{} {}",
        valley.equations,
        valley.fits
    );
}

#[test]
fn nothing_is_found_where_nothing_can_be_computed() {
    let mut valley = Valley::default();
    assert!(levenberg_marquardt(&mut valley, [3.0, 0.0, 0.0], DESCENT).is_none());
    // The first step from here leads beyond 2; a shorter one is made.
    let found = levenberg_marquardt(&mut valley, [2.0, -3.0, 0.0], DESCENT).unwrap();
    assert!((found.point[0] - 1.0).abs() < 1e-9);
}

#[test]
fn difference_quotients_give_the_same_equations() {
    let mut valley = Valley::default();
    let at = [-1.2, 1.0, 0.0];
    let left = valley.fit(&at).unwrap();
    let (normal, right) = valley.normal_equations(&at, &left).unwrap();
    let (n, r) = difference_equations(&mut valley, &at, &left, (3, 1e-7), |left| left).unwrap();
    assert!((normal - n).amax() < 1e-3 && (right - r).amax() < 1e-4);
}
