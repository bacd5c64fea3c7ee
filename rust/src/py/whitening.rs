//! Python binding of the whitening of rows.

use crate::model::whitening;
use numpy::{PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// Weighted rows, each less its share of the row before and of what was new there, over what is new
/// in it.
#[pyfunction]
fn whiten_weighted<'py>(
    py: Python<'py>,
    columns: PyReadonlyArray2<'py, f64>,
    weight: PyReadonlyArray1<'py, f64>,
    share: PyReadonlyArray1<'py, f64>,
    carried: PyReadonlyArray1<'py, f64>,
    fresh: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (rows, width) = (columns.shape()[0], columns.shape()[1]);
    let pairs = rows.saturating_sub(1);
    if weight.len() != rows
        || [&share, &carried, &fresh]
            .iter()
            .any(|of| of.len() != pairs)
    {
        return Err(PyValueError::new_err(format!(
            "expected {rows} weights and {pairs} pairs of neighbours"
        )));
    }
    let found = PyArray2::<f64>::zeros(py, [rows, width], false);
    whitening::whiten_weighted(
        columns.as_slice()?,
        width,
        weight.as_slice()?,
        share.as_slice()?,
        carried.as_slice()?,
        fresh.as_slice()?,
        found.readwrite().as_slice_mut()?,
    );
    Ok(found)
}

/// Registers what Python sees.
pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(whiten_weighted, module)?)
}
