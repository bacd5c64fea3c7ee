//! Who hears the conditions of a formula: the same lines tell the reason for one variant's refusal
//! and, without a branch, whether every variant of a block is sound.

use crate::error::{DesignError, negative, not_positive};

/// Hears the conditions in the order in which a design is checked. Formulas go on after a breach:
/// what they then give is never looked at.
pub trait Judge {
    /// Hears one condition; `refusal` says what its breach is.
    fn require(&mut self, holds: bool, refusal: impl FnOnce() -> DesignError);

    /// `value` where it `holds`, else what `otherwise` finds the long way.
    fn settle<T>(&mut self, holds: bool, value: T, otherwise: impl FnOnce() -> T) -> T;

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
pub struct FirstReason(Option<DesignError>);

impl Judge for FirstReason {
    #[inline(always)]
    fn require(&mut self, holds: bool, refusal: impl FnOnce() -> DesignError) {
        if !holds && self.0.is_none() {
            self.0 = Some(refusal());
        }
    }

    #[inline(always)]
    fn settle<T>(&mut self, holds: bool, value: T, otherwise: impl FnOnce() -> T) -> T {
        // The long way may rely on every condition heard so far.
        if holds || self.0.is_some() {
            value
        } else {
            otherwise()
        }
    }
}

/// What `formula` gives, or the first reason it finds to refuse.
///
/// # Errors
/// That reason.
#[inline(always)]
pub fn judged<T>(formula: impl FnOnce(&mut FirstReason) -> T) -> Result<T, DesignError> {
    let mut judge = FirstReason::default();
    let value = formula(&mut judge);
    judge.0.map_or(Ok(value), Err)
}

/// Notes only whether everything holds, without a branch. Where it does not, a [`FirstReason`]
/// has to look again.
#[derive(Debug)]
pub struct AllHold(pub bool);

impl Judge for AllHold {
    #[inline(always)]
    fn require(&mut self, holds: bool, _: impl FnOnce() -> DesignError) {
        self.0 &= holds;
    }

    #[inline(always)]
    fn settle<T>(&mut self, holds: bool, value: T, _: impl FnOnce() -> T) -> T {
        self.0 &= holds;
        value
    }
}
