//! `_core.Train`: modes and transients of a torsional train.

use numpy::{
    IntoPyArray, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dynamics::batch;
use crate::dynamics::branch::{EventKind, static_twist};
use crate::dynamics::modes::Modes;
use crate::dynamics::train::{SlipElement, Spring, Train, TrainError};
use crate::dynamics::transient::{Loads, Start, transient};

impl From<TrainError> for PyErr {
    fn from(error: TrainError) -> Self {
        PyValueError::new_err(error.to_string())
    }
}

/// A spring as Python gives it: ends, knees, slopes, unloaded twist, and slip elements of
/// stiffness, limit and load factor.
type SpringRow = (
    usize,
    Option<usize>,
    Vec<f64>,
    Vec<f64>,
    f64,
    Vec<(f64, f64, f64)>,
);

/// Rows of a matrix.
type Rows = Vec<Vec<f64>>;

/// Inertias joined by springs.
#[pyclass(name = "Train", frozen, module = "cyclosweep._core")]
pub struct PyTrain {
    train: Train,
}

#[pymethods]
impl PyTrain {
    #[new]
    fn new(inertias: Vec<f64>, springs: Vec<SpringRow>, damping_s: f64) -> PyResult<Self> {
        let spring = |(from, to, knees, slopes, unloaded, elements): SpringRow| Spring {
            from,
            to,
            knees,
            slopes,
            unloaded,
            elements: elements
                .into_iter()
                .map(|(stiffness, limit, load_factor)| SlipElement {
                    stiffness,
                    limit,
                    load_factor,
                })
                .collect(),
        };
        let springs = springs.into_iter().map(spring).collect();
        let train = Train::new(inertias, springs, damping_s)?;
        Ok(Self { train })
    }

    /// Squared angular frequencies, shapes (nodes by modes) and twists (springs by modes).
    fn modes(&self, stiffnesses: Vec<f64>) -> PyResult<(Vec<f64>, Rows, Rows)> {
        if stiffnesses.len() != self.train.springs().len() {
            return Err(PyValueError::new_err("one stiffness a spring"));
        }
        let modes = Modes::of(&self.train, &stiffnesses);
        let rows = |matrix: &nalgebra::DMatrix<f64>| {
            let row = |k: usize| matrix.row(k).iter().copied().collect();
            (0..matrix.nrows()).map(row).collect()
        };
        let (shapes, twists) = (rows(&modes.shapes), rows(&modes.twists));
        Ok((modes.omega_squared, shapes, twists))
    }

    /// Twist of each spring under a torque that has grown from zero, with its elements' anchors.
    fn static_twists(&self, torques: Vec<f64>) -> Vec<(f64, Vec<f64>)> {
        let springs = self.train.springs().iter().zip(torques);
        springs
            .map(|(spring, torque)| static_twist(spring, torque))
            .collect()
    }

    /// Follows the train: columns of the samples, events and peaks.
    #[expect(
        clippy::too_many_arguments,
        reason = "keyword arguments on the Python side"
    )]
    fn transient<'py>(
        &self,
        py: Python<'py>,
        angles: Vec<f64>,
        speeds: Vec<f64>,
        anchors: Vec<Vec<f64>>,
        knot_times: PyReadonlyArray1<'py, f64>,
        knot_torques: PyReadonlyArray2<'py, f64>,
        samples: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let start = Start {
            angles: &angles,
            speeds: &speeds,
            anchors,
        };
        let loads = Loads {
            times: knot_times.as_slice()?,
            torques: knot_torques.as_slice()?,
        };
        let samples = samples.as_slice()?;
        let record = py.detach(|| transient(&self.train, &start, loads, samples))?;
        let found = PyDict::new(py);
        let column = |name: &str, values: Vec<f64>| found.set_item(name, values.into_pyarray(py));
        column("angles", record.angles)?;
        column("speeds", record.speeds)?;
        column("torques", record.torques)?;
        column("frictions", record.frictions)?;
        column("kinetic", record.kinetic)?;
        column("potential", record.potential)?;
        column("lost", record.lost)?;
        column("lost_in", record.lost_in)?;
        column("end_angles", record.end.0)?;
        column("end_speeds", record.end.1)?;
        let events = &record.events;
        let of = |part: fn(&crate::dynamics::transient::Event) -> f64| events.iter().map(part);
        column("event_times", of(|e| e.time).collect())?;
        column("event_twists", of(|e| e.twist).collect())?;
        column("event_speeds", of(|e| e.speed).collect())?;
        let springs: Vec<usize> = events.iter().map(|e| e.spring).collect();
        found.set_item("event_springs", springs)?;
        let kinds: Vec<&str> = events
            .iter()
            .map(|e| EventKind::LABELS[e.kind as usize])
            .collect();
        found.set_item("event_kinds", kinds)?;
        column("peaks", record.peaks.iter().map(|p| p.torque).collect())?;
        column("peak_times", record.peaks.iter().map(|p| p.time).collect())?;
        Ok(found)
    }
}

/// Natural frequencies (Hz) of chains, one row each.
#[pyfunction]
fn chain_frequencies<'py>(
    py: Python<'py>,
    inertias: PyReadonlyArray2<'py, f64>,
    stiffnesses: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let shape = inertias.shape();
    let (rows, nodes) = (shape[0], shape[1]);
    let springs = stiffnesses.shape();
    if springs[0] != rows || nodes == 0 || !(nodes - 1..=nodes).contains(&springs[1]) {
        return Err(PyValueError::new_err(
            "expected as many rows, and as many springs as inertias or one fewer",
        ));
    }
    let found = PyArray2::<f64>::zeros(py, [rows, nodes], false);
    {
        let mut found = found.readwrite();
        let (inertias, stiffnesses) = (inertias.as_slice()?, stiffnesses.as_slice()?);
        let found = found.as_slice_mut()?;
        py.detach(|| batch::frequencies(nodes, inertias, stiffnesses, found));
    }
    Ok(found)
}

/// Registers what Python sees.
pub(super) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyTrain>()?;
    module.add_function(wrap_pyfunction!(chain_frequencies, module)?)
}
