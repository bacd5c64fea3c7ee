//! What the histories of the operators must be: numbers, of equal length.

use thiserror::Error;

/// Why a history cannot be evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum HistoryError {
    /// Two columns differ in length.
    #[error("arrays differ in length: {expected} and {found}")]
    Length {
        /// Length of the first column.
        expected: usize,
        /// Length of the other.
        found: usize,
    },
    /// A value is not a number.
    #[error("{what} is not a number at place {place}")]
    NotANumber {
        /// The column or parameter.
        what: &'static str,
        /// Its place in the column, from 0.
        place: usize,
    },
    /// A value is infinite.
    #[error("{what} is infinite at place {place}")]
    Infinite {
        /// The column or parameter.
        what: &'static str,
        /// Its place in the column, from 0.
        place: usize,
    },
    /// A distance is zero.
    #[error("{what} must be above zero at place {place}")]
    Zero {
        /// The column or parameter.
        what: &'static str,
        /// Its place in the column, from 0.
        place: usize,
    },
    /// A width or distance is negative.
    #[error("{what} must not be negative, found {value}")]
    Negative {
        /// The column or parameter.
        what: &'static str,
        /// The value found.
        value: f64,
    },
}

/// Requires equal lengths.
pub(super) fn same_length(expected: usize, found: &[usize]) -> Result<(), HistoryError> {
    match found.iter().find(|n| **n != expected) {
        Some(found) => Err(HistoryError::Length {
            expected,
            found: *found,
        }),
        None => Ok(()),
    }
}

/// Requires numbers.
pub(super) fn numbers(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    if values.iter().all(|value| !value.is_nan()) {
        return Ok(());
    }
    let place = values.iter().position(|v| v.is_nan()).unwrap_or_default();
    Err(HistoryError::NotANumber { what, place })
}

/// Requires finite numbers.
pub(super) fn finite(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    numbers(what, values)?;
    match values.iter().position(|value| value.is_infinite()) {
        Some(place) => Err(HistoryError::Infinite { what, place }),
        None => Ok(()),
    }
}

/// Requires numbers where a history starts afresh; elsewhere a start is not read.
pub(super) fn numbers_at_starts(
    what: &'static str,
    values: &[f64],
    restart: &[bool],
) -> Result<(), HistoryError> {
    let is_read = |place: usize| place == 0 || restart[place];
    match (0..values.len()).find(|place| is_read(*place) && values[*place].is_nan()) {
        Some(place) => Err(HistoryError::NotANumber { what, place }),
        None => Ok(()),
    }
}

/// Requires numbers not below zero.
pub(super) fn not_negative(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    numbers(what, values)?;
    match values.iter().find(|value| **value < 0.0) {
        Some(value) => Err(HistoryError::Negative {
            what,
            value: *value,
        }),
        None => Ok(()),
    }
}

/// Requires numbers above zero.
pub(super) fn positive(what: &'static str, values: &[f64]) -> Result<(), HistoryError> {
    not_negative(what, values)?;
    match values.iter().position(|value| *value == 0.0) {
        Some(place) => Err(HistoryError::Zero { what, place }),
        None => Ok(()),
    }
}

/// `value`, or the end of the range beyond which it lies. Unlike `f64::clamp` it never panics.
#[inline]
pub(super) fn within(value: f64, low: f64, high: f64) -> f64 {
    if value < low {
        low
    } else if value > high {
        high
    } else {
        value
    }
}
