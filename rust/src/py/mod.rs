//! Bindings for Python, and nothing else; everything Python can see is registered here.

mod components;
mod curve;
mod dynamics;
mod formulas;
mod hysteresis;
mod parquet;
mod study;
mod whitening;

use pyo3::create_exception;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::model::error::{DesignError as Refusal, Status};
use crate::model::inputs::{Input, SEGMENT_FIELDS};
use crate::{Kind, Output};

create_exception!(
    cyclosweep._core,
    DesignError,
    PyValueError,
    "A design that cannot be built, with the physical reason."
);

impl From<Refusal> for PyErr {
    fn from(error: Refusal) -> Self {
        DesignError::new_err(error.to_string())
    }
}

/// The drive's scalar inputs in the core's order: (name, takes whole numbers, may be left out).
#[pyfunction]
fn input_table() -> Vec<(&'static str, bool, bool)> {
    Input::ALL
        .iter()
        .map(|i| (i.name(), i.is_whole(), i.is_optional()))
        .collect()
}

/// The result columns for a list of loads: (name, "real" | "count" | "flag").
#[pyfunction]
#[expect(
    clippy::needless_pass_by_value,
    reason = "a list from Python arrives by value"
)]
fn output_table(loads: Vec<f64>) -> Vec<(String, &'static str)> {
    let kind = |output: Output| match output.kind() {
        Kind::Real => "real",
        Kind::Count => "count",
        Kind::Flag => "flag",
    };
    Output::all(&loads)
        .into_iter()
        .map(|output| (output.name(&loads), kind(output)))
        .collect()
}

/// The words of the `status` column, in the order of their codes.
#[pyfunction]
fn status_labels() -> Vec<&'static str> {
    Status::ALL.iter().map(|status| status.label()).collect()
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    hysteresis::register(module)?;
    components::register(module)?;
    curve::register(module)?;
    dynamics::register(module)?;
    whitening::register(module)?;
    module.add("DEBUG_BUILD", cfg!(debug_assertions))?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add("SEGMENT_FIELDS", SEGMENT_FIELDS)?;
    module.add("DesignError", module.py().get_type::<DesignError>())?;
    module.add_class::<study::PyStudy>()?;
    module.add_function(wrap_pyfunction!(study::kernel_evaluations, module)?)?;
    module.add_function(wrap_pyfunction!(study::sample, module)?)?;
    module.add_function(wrap_pyfunction!(parquet::write_parquet, module)?)?;
    module.add_function(wrap_pyfunction!(input_table, module)?)?;
    module.add_function(wrap_pyfunction!(output_table, module)?)?;
    module.add_function(wrap_pyfunction!(status_labels, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::active_pins, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::sectors, module)?)?;
    module.add_function(wrap_pyfunction!(formulas::hole_locus, module)?)?;
    Ok(())
}
