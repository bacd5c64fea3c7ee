//! Limits, integrals and scaling laws of shaft, pin and assembly.

use approx::assert_relative_eq;
use cyclosweep::model::compliance::{output_compliance, reflected, slope_deg, twist_deg};
use cyclosweep::model::pin::{Pin, cowper, pin_compliance};
use cyclosweep::model::shaft::{
    Segment, SegmentKind, frustum_factor, keyway_factor, shaft_compliance, shaft_factor,
    shoulder_factor, step_factor,
};
use proptest::prelude::*;

fn length() -> impl Strategy<Value = f64> {
    0.001..0.5_f64
}

fn segment() -> impl Strategy<Value = Segment> {
    let kinds = prop_oneof![
        Just(SegmentKind::Keyway),
        Just(SegmentKind::Cylinder),
        Just(SegmentKind::Frustum)
    ];
    (kinds, length(), length(), length(), 0.0..0.49_f64).prop_map(
        |(kind, diameter, end_diameter, length, depth)| Segment {
            kind,
            diameter,
            end_diameter,
            length,
            keyway_depth: depth * diameter,
        },
    )
}

/// Simpson's rule for the integral of dl / D(l)^4 along a cone.
fn cone_integral(length: f64, diameter: f64, end: f64) -> f64 {
    let steps = 2000;
    let h = length / f64::from(steps);
    let at = |k: i32| (diameter + (end - diameter) * f64::from(k) / f64::from(steps)).powi(-4);
    let inner: f64 = (1..steps)
        .map(|k| if k % 2 == 1 { 4.0 * at(k) } else { 2.0 * at(k) })
        .sum();
    h / 3.0 * (at(0) + inner + at(steps))
}

proptest! {
    #[test]
    fn a_frustum_is_its_integral(l in length(), d in 0.02..0.1_f64, ratio in 0.4..2.5_f64) {
        let exact = frustum_factor(l, d, d * ratio);
        assert_relative_eq!(exact, cone_integral(l, d, d * ratio), max_relative = 1e-8);
        assert_relative_eq!(exact, frustum_factor(l, d * ratio, d), max_relative = 1e-12);
    }

    #[test]
    fn a_frustum_cut_in_two_is_itself(l in length(), d in length(), end in length(), t in 0.01..0.99_f64) {
        let middle = d + t * (end - d);
        let parts = frustum_factor(t * l, d, middle) + frustum_factor((1.0 - t) * l, middle, end);
        assert_relative_eq!(parts, frustum_factor(l, d, end), max_relative = 1e-10);
    }

    #[test]
    fn limits_are_the_plain_cylinder(l in length(), d in length(), k in 0.0..20.0_f64) {
        let plain = l / d.powi(4);
        assert_relative_eq!(frustum_factor(l, d, d * (1.0 + 1e-13)), plain, max_relative = 1e-12);
        assert_relative_eq!(keyway_factor(l, d, 0.0, k), plain, max_relative = 1e-14);
        let step = step_factor(l, d, l, d * (1.0 + 1e-14)).expect("ascending");
        assert_relative_eq!(step, 2.0 * plain, max_relative = 1e-11);
        prop_assert_eq!(shoulder_factor(d, d), 0.0);
    }

    #[test]
    fn a_shoulder_grows_with_the_step_up_to_a_bound(d in length(), rise in 1.0..20.0_f64) {
        let term = shoulder_factor(d, d * rise);
        prop_assert!(term >= 0.0 && term < 1.0 / (8.0 * d.powi(3)));
        prop_assert!(term <= shoulder_factor(d, d * rise * 1.01));
    }

    #[test]
    fn a_shaft_scales_as_it_must(segments in prop::collection::vec(segment(), 1..6), s in 0.2..5.0_f64) {
        // Every diameter by s at equal l/d: compliance by s^-3 / 1; every diameter alone by s^-4
        // but for the shoulders, which go with s^-3 too.
        let scaled: Vec<Segment> = segments.iter().map(|x| Segment {
            diameter: x.diameter * s,
            end_diameter: x.end_diameter * s,
            length: x.length * s,
            keyway_depth: x.keyway_depth * s,
            ..*x
        }).collect();
        let of = |list: &[Segment], modulus: f64| shaft_compliance(list.iter().copied(), modulus, 0.3, 10.0);
        match (of(&segments, 2e11), of(&scaled, 2e11), of(&segments, 4e11)) {
            (Ok(whole), Ok(large), Ok(stiff)) => {
                assert_relative_eq!(large * s.powi(3), whole, max_relative = 1e-10);
                assert_relative_eq!(stiff * 2.0, whole, max_relative = 1e-13);
            }
            (a, b, c) => prop_assert!(a.is_err() && b.is_err() && c.is_err()),
        }
    }

    #[test]
    fn a_cylinder_goes_with_the_fourth_power(l in length(), d in length(), s in 0.2..5.0_f64) {
        let cylinder = |diameter| Segment {
            kind: SegmentKind::Cylinder, diameter, end_diameter: f64::NAN, length: l,
            keyway_depth: f64::NAN,
        };
        let of = |d| shaft_factor([cylinder(d)], 10.0).expect("valid");
        assert_relative_eq!(of(d * s) * s.powi(4), of(d), max_relative = 1e-12);
    }

    #[test]
    fn no_shaft_makes_it_panic(
        numbers in prop::collection::vec(prop::num::f64::ANY, 5 * 4),
        modulus in prop::num::f64::ANY,
        poisson in prop::num::f64::ANY,
        coefficient in prop::num::f64::ANY,
    ) {
        let kinds = [SegmentKind::Keyway, SegmentKind::Cylinder, SegmentKind::Frustum];
        let segments = numbers.chunks(4).enumerate().map(|(k, n)| Segment {
            kind: kinds[k % 3], diameter: n[0], end_diameter: n[1], length: n[2], keyway_depth: n[3],
        });
        if let Ok(compliance) = shaft_compliance(segments, modulus, poisson, coefficient) {
            prop_assert!(compliance >= 0.0 || compliance.is_nan());
        }
    }

    #[test]
    fn a_pin_s_compliance_scales_with_modulus_and_circle(
        d in 0.005..0.05_f64, bore in 0.0..0.9_f64, slender in 0.5..5.0_f64,
        modulus in 5e10..4e11_f64, nu in 0.0..0.5_f64, circle in 0.02..0.2_f64,
    ) {
        let pin = Pin { diameter: d, bore: bore * d, length: slender * d };
        prop_assert!(pin.check().is_ok());
        let of = |modulus: f64, circle: f64| pin_compliance(pin.flexibility(modulus, nu), circle);
        let here = of(modulus, circle);
        assert_relative_eq!(of(3.0 * modulus, circle) * 3.0, here, max_relative = 1e-9);
        assert_relative_eq!(of(modulus, 2.0 * circle) * 4.0, here, max_relative = 1e-9);
        assert_relative_eq!(here * circle * circle, pin.flexibility(modulus, nu), max_relative = 1e-9);
        // Without a modulus there is no stiffness: no bound from an arc tangent.
        assert_relative_eq!(of(1e-6 * modulus, circle) * 1e-6, here, max_relative = 1e-9);
    }

    #[test]
    fn pins_of_one_shape_scale_with_their_size(
        d in 0.005..0.05_f64, bore in 0.0..0.9_f64, slender in 0.5..5.0_f64, s in 0.2..5.0_f64,
    ) {
        let pin = |d: f64| Pin { diameter: d, bore: bore * d, length: slender * d };
        let (one, other) = (pin(d), pin(d * s));
        assert_relative_eq!(
            other.flexibility(2e11, 0.3) * s, one.flexibility(2e11, 0.3), max_relative = 1e-11
        );
        assert_relative_eq!(other.root_stress(1.0) * s * s, one.root_stress(1.0), max_relative = 1e-11);
        let solid = Pin { bore: 0.0, ..one };
        prop_assert!(one.flexibility(2e11, 0.3) >= solid.flexibility(2e11, 0.3));
    }

    #[test]
    fn cowper_falls_from_solid_to_tube(nu in 0.0..0.5_f64, m in 0.0..1.0_f64) {
        let (solid, tube) = (cowper(0.0, nu), cowper(1.0, nu));
        prop_assert!(tube - 1e-12 <= cowper(m, nu) && cowper(m, nu) <= solid + 1e-12);
        assert_relative_eq!(solid, 6.0 * (1.0 + nu) / (7.0 + 6.0 * nu), max_relative = 1e-14);
    }

    #[test]
    fn assembly_is_series_parallel_and_square(
        shaft in 1e-9..1e-3_f64, pin in 1e-9..1e-3_f64, pins in 3.0..64.0_f64,
        ratio in 3.0..300.0_f64, eta in 0.1..1.0_f64, torque in 0.01..100.0_f64,
        load in 0.01..10.0_f64, play in 0.0..40.0_f64,
    ) {
        let c = output_compliance(shaft, pin, pins);
        prop_assert!(c > shaft && c < shaft + pin);
        assert_relative_eq!(reflected(c, ratio * ratio), c * ratio.powi(2), max_relative = 1e-14);
        let slope = slope_deg(eta, reflected(c, ratio * ratio), torque);
        let elastic = |load: f64| twist_deg(slope, load, play) - play;
        prop_assert!((elastic(2.0 * load) - 2.0 * elastic(load)).abs() < 1e-9 * (1.0 + slope * load));
        prop_assert_eq!(twist_deg(slope, 0.0, play), play);
    }
}
