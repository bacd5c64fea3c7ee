//! The disc's profile: radius of curvature, undercut, area and moment of inertia.

use std::f64::consts::{PI, TAU};
use std::sync::LazyLock;

/// A cycloidal disc's profile, the offset of a trochoid inwards by the ring pins' radius. SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Profile {
    /// Lobes N.
    pub lobes: usize,
    /// Radius R of the ring pins' circle (m).
    pub ring_radius: f64,
    /// Radius of a ring pin (m).
    pub pin_radius: f64,
    /// Eccentricity e (m).
    pub eccentricity: f64,
}

/// Points of one lobe for areas and moments: the integrals of a smooth period converge at once.
const POINTS: usize = 96;

/// Sine and cosine at the points of half a lobe, its ends included.
fn half_turn() -> &'static [[f64; 2]; POINTS / 2 + 1] {
    static HALF: LazyLock<[[f64; 2]; POINTS / 2 + 1]> = LazyLock::new(|| {
        std::array::from_fn(|point| {
            let (sin, cos) = (TAU * point as f64 / POINTS as f64).sin_cos();
            [sin, cos]
        })
    });
    &HALF
}

impl Profile {
    /// Ring pins.
    fn pins(&self) -> f64 {
        self.lobes as f64 + 1.0
    }

    /// Short-width coefficient K1 = e (N + 1) / R.
    fn width_coefficient(&self) -> f64 {
        self.eccentricity * self.pins() / self.ring_radius
    }

    /// Curvature (1/m) of the path of a ring pin's centre on the disc, above zero where the lobe is
    /// convex, for the pin whose direction from the ring's centre has this cosine to u.
    #[inline(always)]
    #[must_use]
    pub fn path_curvature(&self, cosine: f64) -> f64 {
        let (k, z) = (self.width_coefficient(), self.pins());
        let square = 1.0 + k * k - 2.0 * k * cosine;
        let bend = 1.0 + z * k * k - k * (1.0 + z) * cosine;
        bend / (self.ring_radius * square * square.sqrt())
    }

    /// Curvature (1/m) of ring pin and lobe together, `1/r + 1/rho`, where they touch.
    #[inline(always)]
    #[must_use]
    pub fn contact_curvature(&self, cosine: f64) -> f64 {
        // A convex lobe's radius is the path's less the pin's, a hollow one's that plus the pin's.
        let path = self.path_curvature(cosine);
        1.0 / self.pin_radius + path / (1.0 - path * self.pin_radius)
    }

    /// Smallest radius of curvature (m) of the path of a ring pin's centre where lobes are convex.
    #[must_use]
    pub fn path_radius_min(&self) -> f64 {
        let (k, z) = (self.width_coefficient(), self.pins());
        let cosine = ((2.0 - z) + k * k * (2.0 * z - 1.0)) / (k * (1.0 + z));
        1.0 / self.path_curvature(cosine.clamp(-1.0, 1.0))
    }

    /// Smallest convex radius of curvature (m) of the profile; not above zero where the ring pins
    /// undercut it.
    #[must_use]
    pub fn radius_min(&self) -> f64 {
        self.path_radius_min() - self.pin_radius
    }

    /// Area (m^2) and polar moment of area (m^4) about the disc's centre.
    #[must_use]
    pub fn area_and_moment(&self) -> (f64, f64) {
        let (z, r, e) = (self.pins(), self.ring_radius, self.eccentricity);
        let (mut area, mut moment) = (0.0, 0.0);
        // Seen along the circle's radius through the pin, every drive passes through the same angles,
        // and the two halves of a lobe are alike.
        for (point, [s, c]) in half_turn().iter().enumerate() {
            // The path, its derivative, and the derivative of its direction.
            let (px, py) = (r - e * c, -e * s);
            let (dx, dy) = (e * z * s, r - e * z * c);
            let (ax, ay) = (-r + e * z * z * c, e * z * z * s);
            let square = dx * dx + dy * dy;
            let speed = square.sqrt();
            let turning = (dx * ay - dy * ax) / square;
            // The point of the profile lies towards the inside by the pin's radius.
            let (tx, ty) = (dx / speed, dy / speed);
            let (x, y) = (px - self.pin_radius * ty, py + self.pin_radius * tx);
            let along = speed - self.pin_radius * turning;
            let swept = (x * ty - y * tx) * along;
            let weight = if point % (POINTS / 2) == 0 { 0.5 } else { 1.0 };
            area += weight * swept;
            moment += weight * 0.5 * (x * x + y * y) * swept;
        }
        let step = TAU / POINTS as f64;
        (area * step, moment * step)
    }

    /// Area (m^2) of the path of a ring pin's centre: `pi (R^2 + e^2 (N + 1))`.
    #[must_use]
    pub fn path_area(&self) -> f64 {
        PI * (self.ring_radius.powi(2) + self.eccentricity.powi(2) * self.pins())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn unit_case() -> Profile {
        Profile {
            lobes: 17,
            ring_radius: 0.0425,
            pin_radius: 0.0025,
            eccentricity: 0.0013,
        }
    }

    #[test]
    fn smallest_convex_radius_of_the_unit_case() {
        assert_relative_eq!(unit_case().radius_min() * 1e3, 6.678, max_relative = 1e-4);
    }

    #[test]
    fn smallest_radius_is_smallest() {
        for (e, z) in [(0.0013, 17), (0.0005, 40), (0.003, 10), (0.0005, 75)] {
            let profile = Profile {
                lobes: z,
                eccentricity: e,
                ..unit_case()
            };
            let least = (0..=20_000)
                .map(|k| profile.path_curvature(f64::from(k) / 10_000.0 - 1.0))
                .fold(0.0, f64::max);
            assert_relative_eq!(1.0 / least, profile.path_radius_min(), max_relative = 1e-6);
        }
    }

    #[test]
    fn radii_of_krol_design_1() {
        // R = e (zs + 1) / m, 15 lobes; the lobe's top is that of cosine -1, its pit that of 1.
        let profile = Profile {
            lobes: 15,
            ring_radius: 2.8e-3 * 16.0 / 0.7,
            pin_radius: 3.5e-3,
            eccentricity: 2.8e-3,
        };
        let radius = |cosine| 1e3 / profile.path_curvature(cosine) - 3.5;
        assert!((radius(-1.0) - 11.6607).abs() < 5e-5);
        assert!((radius(1.0) + 4.0647).abs() < 5e-5);
    }

    #[test]
    fn without_pins_the_area_is_that_of_the_path() {
        let path = Profile {
            pin_radius: 0.0,
            ..unit_case()
        };
        assert_relative_eq!(
            path.area_and_moment().0,
            path.path_area(),
            max_relative = 1e-12
        );
        // Steiner's formula for an offset: A - r L + pi r^2.
        let area = |radius| {
            let profile = Profile {
                pin_radius: radius,
                ..unit_case()
            };
            profile.area_and_moment().0
        };
        let (small, large) = (area(0.001), area(0.002));
        let length = (area(0.0) - small + PI * 1e-6) / 0.001;
        let expected = area(0.0) - 0.002 * length + PI * 4e-6;
        assert_relative_eq!(large, expected, max_relative = 1e-12);
    }
}
