//! Natural frequencies and shapes of a train whose springs have one stiffness each.

use nalgebra::DMatrix;

use crate::dynamics::train::Train;

/// Modes of a train, the slowest first; a piece that nothing holds has one of frequency zero.
#[derive(Debug, Clone, PartialEq)]
pub struct Modes {
    /// Squares of the angular frequencies (1/s^2).
    pub omega_squared: Vec<f64>,
    /// Angle of each node in each mode (nodes by modes), of unit generalised mass.
    pub shapes: DMatrix<f64>,
    /// Twist of each spring in each mode (springs by modes).
    pub twists: DMatrix<f64>,
}

impl Modes {
    /// Modes for these stiffnesses (N m/rad) of the train's springs.
    ///
    /// The symmetric matrix $J^{-1/2} K J^{-1/2}$ is taken apart piece by piece: nodes that springs
    /// of a stiffness above zero join. The rigid mode of a piece without ground is known, so that
    /// it is projected out and its frequency is zero exactly.
    #[must_use]
    pub fn of(train: &Train, stiffnesses: &[f64]) -> Self {
        let n = train.inertias().len();
        let roots: Vec<f64> = train.inertias().iter().map(|j| j.sqrt()).collect();
        let mut found: Vec<(f64, Vec<f64>)> = Vec::with_capacity(n);
        for piece in pieces(train, stiffnesses) {
            let matrix = scaled_stiffness(train, stiffnesses, &piece.nodes, &roots);
            for (square, vector) in solve(&piece, &matrix, &roots) {
                let mut shape = vec![0.0; n];
                for (&node, value) in piece.nodes.iter().zip(vector) {
                    shape[node] = value / roots[node];
                }
                found.push((square, shape));
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let shapes = DMatrix::from_fn(n, n, |node, mode| found[mode].1[node]);
        let twists = DMatrix::from_fn(train.springs().len(), n, |k, mode| {
            let spring = &train.springs()[k];
            shapes[(spring.from, mode)] - spring.to.map_or(0.0, |to| shapes[(to, mode)])
        });
        Self {
            omega_squared: found.into_iter().map(|(square, _)| square).collect(),
            shapes,
            twists,
        }
    }

    /// Natural frequencies (Hz).
    #[must_use]
    pub fn frequencies_hz(&self) -> Vec<f64> {
        let hertz = |square: &f64| square.max(0.0).sqrt() / std::f64::consts::TAU;
        self.omega_squared.iter().map(hertz).collect()
    }
}

/// Nodes that springs join.
struct Piece {
    nodes: Vec<usize>,
    is_held: bool,
}

fn pieces(train: &Train, stiffnesses: &[f64]) -> Vec<Piece> {
    let n = train.inertias().len();
    let mut of: Vec<usize> = (0..n).collect();
    let mut held = vec![false; n];
    let active = train.springs().iter().zip(stiffnesses);
    for (spring, _) in active.clone().filter(|(_, k)| **k != 0.0) {
        if let Some(to) = spring.to {
            let (keep, drop) = (of[spring.from].min(of[to]), of[spring.from].max(of[to]));
            for name in &mut of {
                if *name == drop {
                    *name = keep;
                }
            }
        }
    }
    for (spring, _) in active.filter(|(s, k)| **k != 0.0 && s.to.is_none()) {
        held[of[spring.from]] = true;
    }
    let piece = |name: usize| Piece {
        nodes: (0..n).filter(|&node| of[node] == name).collect(),
        is_held: held[name],
    };
    (0..n).filter(|&k| of[k] == k).map(piece).collect()
}

fn scaled_stiffness(
    train: &Train,
    stiffnesses: &[f64],
    nodes: &[usize],
    roots: &[f64],
) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(nodes.len(), nodes.len());
    let place = |node: usize| nodes.iter().position(|&other| other == node);
    for (spring, &k) in train.springs().iter().zip(stiffnesses) {
        let Some(a) = place(spring.from) else {
            continue;
        };
        matrix[(a, a)] += k / (roots[spring.from] * roots[spring.from]);
        if let Some((to, b)) = spring.to.and_then(|to| place(to).map(|b| (to, b))) {
            matrix[(b, b)] += k / (roots[to] * roots[to]);
            let coupling = k / (roots[spring.from] * roots[to]);
            matrix[(a, b)] -= coupling;
            matrix[(b, a)] -= coupling;
        }
    }
    matrix
}

/// Eigenvalues and vectors of a piece, in the coordinates scaled by the roots of the inertias.
fn solve(piece: &Piece, matrix: &DMatrix<f64>, roots: &[f64]) -> Vec<(f64, Vec<f64>)> {
    let n = piece.nodes.len();
    if piece.is_held {
        let eigen = matrix.clone().symmetric_eigen();
        return (0..n)
            .map(|k| {
                let vector = eigen.eigenvectors.column(k).iter().copied().collect();
                (eigen.eigenvalues[k].max(0.0), vector)
            })
            .collect();
    }
    let norm = piece
        .nodes
        .iter()
        .map(|&node| roots[node] * roots[node])
        .sum::<f64>()
        .sqrt();
    let rigid: Vec<f64> = piece.nodes.iter().map(|&node| roots[node] / norm).collect();
    let mut found = vec![(0.0, rigid.clone())];
    if n > 1 {
        // Householder's reflection that takes the first axis to the rigid mode: its other columns
        // span everything else.
        let mut v = rigid;
        v[0] += 1.0;
        let scale = 2.0 / v.iter().map(|x| x * x).sum::<f64>();
        let rest = DMatrix::from_fn(n, n - 1, |row, column| {
            let unit = f64::from(u8::from(row == column + 1));
            unit - scale * v[row] * v[column + 1]
        });
        let eigen = (rest.transpose() * matrix * &rest).symmetric_eigen();
        let vectors = rest * eigen.eigenvectors;
        found.extend((0..n - 1).map(|k| {
            let vector = vectors.column(k).iter().copied().collect();
            (eigen.eigenvalues[k].max(0.0), vector)
        }));
    }
    found
}
