//! How many contacts share a load: those above a threshold, and the effective number without one.

use crate::components::forces::ACTIVE_SHARE;

/// How a list of forces is shared.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sharing {
    /// Contacts above 1 % of the largest force.
    pub active: f64,
    /// `(sum F)^2 / sum F^2`; zero without any force.
    pub effective: f64,
    /// Largest force (N).
    pub largest: f64,
}

impl Sharing {
    /// That of these forces (N).
    #[must_use]
    pub fn of(forces: &[f64]) -> Self {
        let largest = forces.iter().fold(0.0_f64, |a, b| a.max(*b));
        let threshold = ACTIVE_SHARE * largest;
        let active = forces.iter().filter(|force| **force > threshold).count();
        let sum: f64 = forces.iter().sum();
        let squares: f64 = forces.iter().map(|force| force * force).sum();
        let effective = if squares > 0.0 {
            sum * sum / squares
        } else {
            0.0
        };
        Self {
            active: active as f64,
            effective,
            largest,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn equal_forces_count_alike_and_small_ones_hardly() {
        let found = Sharing::of(&[0.0, 5.0, 5.0, 5.0, 5.0, 0.04]);
        assert_relative_eq!(found.active, 4.0);
        assert_relative_eq!(found.largest, 5.0);
        assert_relative_eq!(found.effective, 20.04 * 20.04 / 100.0016);
        assert_eq!(Sharing::of(&[0.0, 0.0]), Sharing::default());
    }
}
