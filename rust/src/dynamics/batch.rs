//! Natural frequencies of many chains at once.

use nalgebra::DMatrix;
use rayon::prelude::*;

/// Chains a thread takes at a time.
const TASK: usize = 256;

/// Natural frequencies (Hz) of chains of `nodes` inertias, one row a chain, the slowest first.
///
/// `inertias` and `frequencies` have `nodes` numbers a row; `stiffnesses` one fewer, or as many
/// where the last spring goes to the ground. NaN where a row has an inertia that is not above zero
/// or a stiffness below zero.
pub fn frequencies(nodes: usize, inertias: &[f64], stiffnesses: &[f64], frequencies: &mut [f64]) {
    let rows = frequencies.len() / nodes.max(1);
    let springs = stiffnesses.len().checked_div(rows).unwrap_or(0);
    frequencies
        .par_chunks_mut(nodes * TASK)
        .enumerate()
        .for_each(|(task, found)| {
            let mut matrix = DMatrix::zeros(nodes, nodes);
            for (k, found) in found.chunks_mut(nodes).enumerate() {
                let row = task * TASK + k;
                let inertias = &inertias[row * nodes..(row + 1) * nodes];
                let stiffnesses = &stiffnesses[row * springs..(row + 1) * springs];
                let wrong = inertias.iter().any(|&j| j.is_nan() || j <= 0.0)
                    || stiffnesses.iter().any(|&k| k.is_nan() || k < 0.0);
                if wrong {
                    found.fill(f64::NAN);
                } else {
                    fill(&mut matrix, inertias, stiffnesses);
                    one(&matrix, springs < nodes, found);
                }
            }
        });
}

/// The matrix $J^{-1/2} K J^{-1/2}$ of a chain.
fn fill(matrix: &mut DMatrix<f64>, inertias: &[f64], stiffnesses: &[f64]) {
    matrix.fill(0.0);
    for (k, &stiffness) in stiffnesses.iter().enumerate() {
        matrix[(k, k)] += stiffness / inertias[k];
        if let Some(next) = inertias.get(k + 1) {
            matrix[(k + 1, k + 1)] += stiffness / next;
            let coupling = -stiffness / (inertias[k] * next).sqrt();
            matrix[(k, k + 1)] = coupling;
            matrix[(k + 1, k)] = coupling;
        }
    }
}

fn one(matrix: &DMatrix<f64>, is_free: bool, found: &mut [f64]) {
    let squares = matrix.symmetric_eigenvalues();
    for (value, square) in found.iter_mut().zip(squares.iter()) {
        *value = square.max(0.0).sqrt() / std::f64::consts::TAU;
    }
    found.sort_by(f64::total_cmp);
    if is_free {
        // The rigid mode is known; rounding would leave it a frequency.
        found[0] = 0.0;
    }
}
