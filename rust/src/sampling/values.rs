//! The values of one axis of a study.

use crate::model::rounding::floor;
use crate::sampling::quantile::normal_quantile;

/// Half the distance of the numbers in [0, 1) that are drawn: in the middle of its step a draw is
/// never 0, where a normal distribution has no quantile.
const HALF_STEP: f64 = f64::EPSILON / 4.0;

/// The values one axis can take, in the user's unit.
#[derive(Debug, Clone, PartialEq)]
pub enum Values {
    /// These, in this order. The only kind a table has: value k belongs to variant k.
    List(Vec<f64>),
    /// `steps` equidistant numbers, both ends included.
    Linspace {
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
        /// How many, at least one.
        steps: u64,
    },
    /// Any number from `low` to `high`; not for a grid.
    Interval {
        /// Lower end.
        low: f64,
        /// Upper end.
        high: f64,
    },
    /// Any whole number from `low` to `high`, both included; not for a grid.
    Whole {
        /// Smallest.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// Normally distributed, of which only what lies from `low` to `high` is drawn.
    Normal {
        /// Mean of the whole distribution.
        mean: f64,
        /// Its standard deviation.
        sd: f64,
        /// Lower end, may be infinite.
        low: f64,
        /// Upper end, may be infinite.
        high: f64,
        /// Share of the whole distribution below `low`.
        below_low: f64,
        /// Share of the whole distribution below `high`.
        below_high: f64,
    },
    /// Triangularly distributed.
    Triangular {
        /// Lower end.
        low: f64,
        /// Most frequent value.
        mode: f64,
        /// Upper end.
        high: f64,
    },
    /// Its logarithm is uniformly distributed.
    LogUniform {
        /// Lower end, above zero.
        low: f64,
        /// Upper end.
        high: f64,
    },
}

impl Values {
    /// How many there are; none for an interval.
    #[must_use]
    pub fn count(&self) -> Option<u64> {
        match self {
            Values::List(values) => Some(values.len() as u64),
            Values::Linspace { steps, .. } => Some(*steps),
            _ => None,
        }
    }

    /// Value number `digit`; of a countable axis only.
    #[inline]
    pub(crate) fn nth(&self, digit: u64) -> f64 {
        match self {
            Values::List(values) => values.get(digit as usize).copied().unwrap_or(f64::NAN),
            Values::Linspace { from, to, steps } => {
                if digit + 1 == *steps && digit > 0 {
                    *to
                } else {
                    from + digit as f64 * ((to - from) / (steps - 1).max(1) as f64)
                }
            }
            // Not countable, and never asked for.
            _ => f64::NAN,
        }
    }

    /// Turns numbers in [0, 1) into the values there.
    #[inline(always)]
    pub(crate) fn place(&self, units: &mut [f64]) {
        match self {
            Values::Interval { low, high } => {
                for u in units {
                    *u = in_interval(*low, *high, *u);
                }
            }
            Values::Whole { low, high } => {
                for u in units {
                    *u = whole_within(*low, *high, *u);
                }
            }
            _ => {
                for u in units {
                    *u = self.at(*u);
                }
            }
        }
    }

    /// The value at `u` in [0, 1).
    #[inline]
    #[must_use]
    pub fn at(&self, u: f64) -> f64 {
        match self {
            Values::Interval { low, high } => in_interval(*low, *high, u),
            Values::Whole { low, high } => whole_within(*low, *high, u),
            Values::List(values) => {
                let place = (u * values.len() as f64) as usize;
                values.get(place).copied().unwrap_or(f64::NAN)
            }
            Values::Linspace { steps, .. } => self.nth((u * *steps as f64) as u64),
            Values::Normal {
                mean,
                sd,
                low,
                high,
                below_low,
                below_high,
            } => {
                let share = below_low + (u + HALF_STEP) * (below_high - below_low);
                let share = share.clamp(HALF_STEP, 1.0 - f64::EPSILON / 2.0);
                (mean + sd * normal_quantile(share)).clamp(*low, *high)
            }
            Values::Triangular { low, mode, high } => in_triangle(*low, *mode, *high, u),
            Values::LogUniform { low, high } => (low * (u * (high / low).ln()).exp()).min(*high),
        }
    }
}

#[inline(always)]
fn in_interval(low: f64, high: f64, u: f64) -> f64 {
    low + u * (high - low)
}

#[inline(always)]
fn whole_within(low: f64, high: f64, u: f64) -> f64 {
    low + floor(u * (high - low + 1.0))
}

/// Quantile of a triangular distribution.
fn in_triangle(low: f64, mode: f64, high: f64, u: f64) -> f64 {
    let width = high - low;
    let rising = mode - low;
    if u * width <= rising {
        low + (u * width * rising).sqrt()
    } else {
        high - ((1.0 - u) * width * (high - mode)).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_place_beyond_the_list_is_no_number() {
        let values = Values::List(vec![1.0, 2.0]);
        assert!(values.nth(2).is_nan() && values.at(1.0).is_nan());
    }

    proptest! {
        #[test]
        fn whole_numbers_stay_in_their_range(low in 0..50_u32, width in 0..500_u32, u in 0.0..1.0_f64) {
            let (low, high) = (f64::from(low), f64::from(low + width));
            let value = Values::Whole { low, high }.at(u);
            prop_assert!(value >= low && value <= high && value.fract() == 0.0);
            prop_assert_eq!(Values::Whole { low, high }.at(0.0), low);
            prop_assert_eq!(Values::Whole { low, high }.at(1.0 - f64::EPSILON / 2.0), high);
        }

        #[test]
        fn distributed_numbers_stay_in_their_range_and_grow_with_the_share(
            low in -5.0..5.0_f64, width in 0.001..9.0_f64, peak in 0.0..=1.0_f64,
            u in 0.0..1.0_f64, v in 0.0..1.0_f64,
        ) {
            let (high, mode) = (low + width, low + peak * width);
            let normal = Values::Normal {
                mean: mode, sd: width, low, high, below_low: 0.3, below_high: 0.6,
            };
            let triangular = Values::Triangular { low, mode, high };
            let logarithmic = Values::LogUniform { low: low.abs() + 0.1, high: low.abs() + 0.1 + width };
            for (values, least, most) in [
                (normal, low, high),
                (triangular, low, high),
                (logarithmic, low.abs() + 0.1, low.abs() + 0.1 + width),
            ] {
                for share in [0.0, u, v, 1.0 - f64::EPSILON / 2.0] {
                    let value = values.at(share);
                    prop_assert!(value >= least - 1e-12 && value <= most + 1e-12, "{value}");
                }
                prop_assert!((u <= v) == (values.at(u) <= values.at(v)) || values.at(u) == values.at(v));
            }
        }

        #[test]
        fn a_normal_number_is_finite_at_both_ends(mean in -5.0..5.0_f64, sd in 0.001..9.0_f64) {
            let values = Values::Normal {
                mean, sd, low: f64::NEG_INFINITY, high: f64::INFINITY, below_low: 0.0, below_high: 1.0,
            };
            prop_assert!((values.at(0.0) - mean) / sd < -8.0 && values.at(0.0).is_finite());
            let last = values.at(1.0 - f64::EPSILON / 2.0);
            prop_assert!((last - mean) / sd > 8.0 && last.is_finite());
        }
    }
}
