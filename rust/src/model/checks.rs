//! The conditions of a formula, checked in two ways: for one variant with the reason where it is
//! refused, and for a block of variants without a branch, with no more than whether all hold.

use crate::model::error::{DesignError, negative, not_positive};

/// Receives the conditions of a formula in the order in which a design is checked. Formulas go on
/// after a condition that does not hold: what they then give is never used.
pub(crate) trait Checks {
    /// Receives one condition; `refusal` makes the reason where it does not hold.
    fn require(&mut self, holds: bool, refusal: impl FnOnce() -> DesignError);

    /// `value` where it `holds`; elsewhere what the slower `otherwise` gives, or, for a block of
    /// variants, a failed check.
    fn value_or_else<T>(&mut self, holds: bool, value: T, otherwise: impl FnOnce() -> T) -> T;

    /// Requires a finite number.
    #[inline(always)]
    fn finite(&mut self, parameter: &'static str, value: f64) -> f64 {
        self.require(value.abs() <= f64::MAX, || DesignError::NonFinite {
            parameter,
        });
        value
    }

    /// Requires a finite number above zero.
    #[inline(always)]
    fn positive(&mut self, parameter: &'static str, value: f64) -> f64 {
        self.require((value > 0.0) & (value <= f64::MAX), || {
            not_positive(parameter, value)
        });
        value
    }

    /// Requires a finite number not below zero.
    #[inline(always)]
    fn non_negative(&mut self, parameter: &'static str, value: f64) -> f64 {
        self.require((0.0..=f64::MAX).contains(&value), || {
            negative(parameter, value)
        });
        value
    }
}

/// Keeps the first reason to refuse.
#[derive(Debug, Default)]
pub(crate) struct FirstRefusal(Option<DesignError>);

impl Checks for FirstRefusal {
    #[inline(always)]
    fn require(&mut self, holds: bool, refusal: impl FnOnce() -> DesignError) {
        if !holds && self.0.is_none() {
            self.0 = Some(refusal());
        }
    }

    #[inline(always)]
    fn value_or_else<T>(&mut self, holds: bool, value: T, otherwise: impl FnOnce() -> T) -> T {
        // The slow way may rely on every condition checked so far.
        if holds || self.0.is_some() {
            value
        } else {
            otherwise()
        }
    }
}

/// What `formula` gives, or the first reason to refuse.
///
/// # Errors
/// That reason.
#[inline(always)]
pub(crate) fn checked<T>(formula: impl FnOnce(&mut FirstRefusal) -> T) -> Result<T, DesignError> {
    let mut checks = FirstRefusal::default();
    let value = formula(&mut checks);
    checks.0.map_or(Ok(value), Err)
}

/// Keeps only whether all conditions hold, without a branch. Where they do not, the variant is
/// computed again with a [`FirstRefusal`].
#[derive(Debug)]
pub(crate) struct AllPass(pub(crate) bool);

impl Checks for AllPass {
    #[inline(always)]
    fn require(&mut self, holds: bool, _: impl FnOnce() -> DesignError) {
        self.0 &= holds;
    }

    #[inline(always)]
    fn value_or_else<T>(&mut self, holds: bool, value: T, _: impl FnOnce() -> T) -> T {
        self.0 &= holds;
        value
    }
}
