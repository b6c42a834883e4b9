//! The laws of a mechanism from its kinetic and potential energy.
//!
//! In: point masses on carts and rods, springs, dampers, inputs. Out: for each coordinate the polynomial that is zero,
//! Σ M_ij q̈_j + Σ Γ_ijk q̇_j q̇_k + ∂V/∂q_i + friction − input, with the Christoffel symbols Γ_ijk = ½(∂_k M_ij + ∂_j M_ik − ∂_i M_jk) of
//! the mass matrix (Goldstein, "Classical Mechanics", 1.4 and 8.1). Nothing is derived by hand.

use super::polynomial::{COORDINATES, Factor, Point, Polynomial};

const GRAVITY: f64 = 9.81;

/// A mass, kg, at the sum of some coordinates along the track and of rods (coordinate of the angle, length in m) that hang.
#[derive(Clone, Debug)]
pub struct Mass {
    pub mass: f64,
    pub carts: Vec<usize>,
    pub rods: Vec<(usize, f64)>,
}

/// Σ weight · coordinate.
pub type Combination = Vec<(usize, f64)>;

/// What a system is built of.
#[derive(Clone, Debug, Default)]
pub struct Mechanism {
    pub masses: Vec<Mass>,
    /// Moments of inertia about a coordinate's own axis, kg m².
    pub inertias: Vec<(usize, f64)>,
    /// Stiffness, and the combination of coordinates that is stretched.
    pub springs: Vec<(f64, Combination)>,
    /// Friction, and the combination of speeds that it brakes.
    pub dampers: Vec<(f64, Combination)>,
    /// The coordinate that each input pushes.
    pub inputs: Vec<usize>,
}

impl Mass {
    /// The position along the track, and the height.
    fn place(&self) -> [Polynomial; 2] {
        let sum = |f: fn(usize) -> Factor, sign: f64| {
            let add = |sum: Polynomial, (i, length): &(usize, f64)| {
                sum.plus(sign, &Polynomial::term(*length, &[f(*i)]))
            };
            self.rods.iter().fold(Polynomial::default(), add)
        };
        let carts = self.carts.iter();
        let along = carts.fold(sum(Factor::Sin, 1.0), |s, i| {
            s.plus(1.0, &Polynomial::term(1.0, &[Factor::Position(*i)]))
        });
        [along, sum(Factor::Cos, -1.0)]
    }
}

impl Mechanism {
    /// The entry M_ij of the mass matrix.
    fn mass(&self, i: usize, j: usize) -> Polynomial {
        let own = self.inertias.iter().filter(|(k, _)| i == j && *k == i);
        let own = own.fold(Polynomial::default(), |sum, (_, inertia)| {
            sum.plus(1.0, &Polynomial::term(*inertia, &[]))
        });
        self.masses.iter().fold(own, |sum, mass| {
            let places = mass.place();
            places.iter().fold(sum, |sum, p| {
                sum.plus(mass.mass, &p.derivative(i).times(&p.derivative(j)))
            })
        })
    }

    /// The potential energy V.
    fn potential(&self) -> Polynomial {
        let weight = self.masses.iter().fold(Polynomial::default(), |sum, mass| {
            let [_, height] = mass.place();
            sum.plus(GRAVITY * mass.mass, &height)
        });
        self.springs.iter().fold(weight, |sum, (stiffness, of)| {
            let position = |sum: Polynomial, (i, w): &(usize, f64)| {
                sum.plus(1.0, &Polynomial::term(*w, &[Factor::Position(*i)]))
            };
            let stretch = of.iter().fold(Polynomial::default(), position);
            sum.plus(0.5 * stiffness, &stretch.times(&stretch))
        })
    }

    /// The friction on coordinate `i`, less the inputs that act on it.
    fn friction(&self, i: usize) -> Polynomial {
        let mut sum = Polynomial::default();
        for (friction, of) in &self.dampers {
            let own = of.iter().filter(|(k, _)| *k == i).map(|(_, w)| w);
            let own: f64 = own.sum();
            for (j, w) in of {
                sum = sum.plus(
                    friction * own * w,
                    &Polynomial::term(1.0, &[Factor::Speed(*j)]),
                );
            }
        }
        for (k, _) in self.inputs.iter().enumerate().filter(|(_, at)| **at == i) {
            sum = sum.plus(-1.0, &Polynomial::term(1.0, &[Factor::Input(k)]));
        }
        sum
    }

    /// The laws of the first `count` coordinates.
    pub fn laws(&self, count: usize) -> Laws {
        let mass: Vec<Vec<Polynomial>> = (0..count)
            .map(|i| (0..count).map(|j| self.mass(i, j)).collect())
            .collect();
        let potential = self.potential();
        let rest = |i: usize| {
            let mut sum = self.friction(i).plus(1.0, &potential.derivative(i));
            for j in 0..count {
                for k in 0..count {
                    let speeds = Polynomial::term(0.5, &[Factor::Speed(j), Factor::Speed(k)]);
                    let symbol = mass[i][j]
                        .derivative(k)
                        .plus(1.0, &mass[i][k].derivative(j))
                        .plus(-1.0, &mass[j][k].derivative(i));
                    sum = sum.plus(1.0, &symbol.times(&speeds));
                }
            }
            sum
        };
        Laws {
            rest: (0..count).map(rest).collect(),
            mass,
        }
    }
}

/// Σ M_ij q̈_j + rest_i = 0.
#[derive(Clone, Debug)]
pub struct Laws {
    pub mass: Vec<Vec<Polynomial>>,
    pub rest: Vec<Polynomial>,
}

impl Laws {
    /// q̈ at a point; the accelerations of the point are not read.
    pub fn accelerations(&self, at: &Point) -> [f64; COORDINATES] {
        let row = |(masses, rest): (&Vec<Polynomial>, &Polynomial)| {
            let mut row: Vec<f64> = masses.iter().map(|m| m.value(at)).collect();
            row.push(-rest.value(at));
            row
        };
        solved(self.mass.iter().zip(&self.rest).map(row).collect())
    }

    /// Law `i` solved for its own acceleration: q̈_i = Σ coefficient · monomial. The M_ii of these mechanisms are constant.
    pub fn explicit(&self, i: usize) -> Vec<(Vec<Factor>, f64)> {
        let mut whole = self.rest[i].clone();
        for (j, mass) in self.mass[i].iter().enumerate() {
            whole = whole.plus(
                1.0,
                &mass.times(&Polynomial::term(1.0, &[Factor::Acceleration(j)])),
            );
        }
        let own = vec![Factor::Acceleration(i)];
        let inertia = whole
            .terms()
            .find(|(m, _)| **m == own)
            .map_or(1.0, |(_, c)| c);
        let others = whole.terms().filter(|(m, _)| **m != own);
        others.map(|(m, c)| (m.clone(), -c / inertia)).collect()
    }
}

/// The solution of a linear system, given as rows of matrix and right side, by elimination with partial pivoting.
fn solved(mut rows: Vec<Vec<f64>>) -> [f64; COORDINATES] {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()));
        rows.swap(k, pivot.unwrap_or(k));
        let (above, below) = rows.split_at_mut(k + 1);
        let pivot = &above[k];
        for row in below {
            let factor = row[k] / pivot[k];
            row.iter_mut()
                .zip(pivot)
                .skip(k)
                .for_each(|(x, p)| *x -= factor * p);
        }
    }
    let mut x = [0.0; COORDINATES];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][n] - known) / rows[k][k];
    }
    x
}
