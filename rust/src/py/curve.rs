//! `_core.torque_twist`: torque over twist of one drive by the component model.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

use crate::components::curve::{CurvePoint, Rig, Turned};
use crate::py::components::PyPartStudy;
use crate::py::study::PyStudy;

/// A table of points, whether each is an equilibrium, the end of the free play, and whether the load
/// was reached.
type CurveTable<'py> = (
    Bound<'py, PyArray2<f64>>,
    Bound<'py, PyArray1<bool>>,
    f64,
    bool,
);

const COLUMNS: usize = 9;

const fn row(point: &CurvePoint) -> [f64; COLUMNS] {
    [
        point.turn,
        point.output_torque,
        point.input_torque,
        point.friction_torque,
        point.active_pins,
        point.effective_pins,
        point.pin_force,
        point.active_ring,
        point.ring_force,
    ]
}

/// Torque over twist of a study's only variant: `side` "input" or "output" is turned towards `sense`
/// up to `torque` (N m) there in `steps`, the crank at `crank` (rad) in the middle. Rows: turn (rad),
/// output torque, input torque, torque that friction takes (N m), active output pins, effective ones,
/// largest force (N), active ring pins, largest force (N).
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "one call a curve")]
fn torque_twist<'py>(
    py: Python<'py>,
    part_study: &PyPartStudy,
    study: &PyStudy,
    side: &str,
    crank: f64,
    sense: f64,
    torque: f64,
    steps: usize,
) -> PyResult<CurveTable<'py>> {
    let turned = match side {
        "input" => Turned::Input,
        "output" => Turned::Output,
        _ => return Err(PyValueError::new_err(format!("unknown side {side}"))),
    };
    let parts = part_study.parts(study, 0)?;
    let fixed = part_study.fixed();
    let curve = py.detach(|| Rig::new(&parts, fixed, turned, crank).curve(sense, torque, steps));
    let points = &curve.points;
    let table = PyArray2::<f64>::zeros(py, [COLUMNS, points.len()], false);
    {
        let mut table = table.readwrite();
        let mut table = table.as_array_mut();
        for (k, point) in points.iter().enumerate() {
            for (column, value) in row(point).into_iter().enumerate() {
                table[[column, k]] = value;
            }
        }
    }
    let converged = points.iter().map(|point| point.converged);
    let converged = PyArray1::from_iter(py, converged);
    Ok((table, converged, curve.free_play, curve.reached))
}

/// Registers what Python sees of the curves.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(torque_twist, module)?)
}
