//! The values of one axis of a study.

use crate::model::rounding::floor;

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
}

impl Values {
    /// How many there are; none for an interval.
    #[must_use]
    pub fn count(&self) -> Option<u64> {
        match self {
            Values::List(values) => Some(values.len() as u64),
            Values::Linspace { steps, .. } => Some(*steps),
            Values::Interval { .. } | Values::Whole { .. } => None,
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
            Values::Interval { low, .. } | Values::Whole { low, .. } => *low,
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
    }
}
