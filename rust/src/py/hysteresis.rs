//! Python bindings of the history operators.

use crate::model::hysteresis::{self, Dashpot, HistoryError, SlipElements, Spring};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

type Column<'py> = PyReadonlyArray1<'py, f64>;
type Reals<'py> = Bound<'py, PyArray1<f64>>;
type Flags<'py> = PyReadonlyArray1<'py, bool>;

impl From<HistoryError> for PyErr {
    fn from(error: HistoryError) -> Self {
        PyValueError::new_err(error.to_string())
    }
}

/// Angle and friction torque of a spring behind a dead zone with slip elements in parallel.
#[pyfunction]
#[pyo3(signature = (torque, offset, restart, start_angle, slip_angle, share, *, free_play, compliance,
                    limit, load_factor=0.0, load_power=0.0, growth=0.0, reference_torque=1.0,
                    forgetting=0.0, law_torque=None, law_twist=None))]
#[expect(
    clippy::too_many_arguments,
    reason = "keyword arguments on the Python side"
)]
fn solve_slip<'py>(
    py: Python<'py>,
    torque: Column<'py>,
    offset: Column<'py>,
    restart: Flags<'py>,
    start_angle: Column<'py>,
    slip_angle: Column<'py>,
    share: Column<'py>,
    free_play: f64,
    compliance: f64,
    limit: f64,
    load_factor: f64,
    load_power: f64,
    growth: f64,
    reference_torque: f64,
    forgetting: f64,
    law_torque: Option<Column<'py>>,
    law_twist: Option<Column<'py>>,
) -> PyResult<(Reals<'py>, Reals<'py>)> {
    let n = torque.len()?;
    let (torque, offset) = (torque.as_slice()?, offset.as_slice()?);
    let (restart, start_angle) = (restart.as_slice()?, start_angle.as_slice()?);
    let elements = SlipElements {
        slip_angle: slip_angle.as_slice()?,
        share: share.as_slice()?,
        limit,
        load_factor,
        load_power,
        growth,
        reference_torque,
        forgetting,
    };
    let (law_torque, law_twist) = match (&law_torque, &law_twist) {
        (Some(torque), Some(twist)) => (torque.as_slice()?, twist.as_slice()?),
        _ => (&[] as &[f64], &[] as &[f64]),
    };
    let spring = Spring {
        free_play,
        compliance,
        law_torque,
        law_twist,
    };
    let (mut angle, mut friction) = (vec![0.0; n], vec![0.0; n]);
    py.detach(|| {
        hysteresis::solve_slip(
            torque,
            offset,
            restart,
            start_angle,
            spring,
            &elements,
            &mut angle,
            &mut friction,
        )
    })?;
    Ok((angle.into_pyarray(py), friction.into_pyarray(py)))
}

/// State of slip elements along a given angle history.
#[pyfunction]
#[pyo3(signature = (angle, restart, start_angle, stretch, slip_angle, share, *, forgetting=0.0))]
#[expect(
    clippy::too_many_arguments,
    reason = "one array per column of the history"
)]
fn slip_state<'py>(
    py: Python<'py>,
    angle: Column<'py>,
    restart: Flags<'py>,
    start_angle: Column<'py>,
    stretch: Column<'py>,
    slip_angle: Column<'py>,
    share: Column<'py>,
    forgetting: f64,
) -> PyResult<Reals<'py>> {
    let n = angle.len()?;
    let elements = SlipElements {
        slip_angle: slip_angle.as_slice()?,
        share: share.as_slice()?,
        limit: 1.0,
        load_factor: 0.0,
        load_power: 0.0,
        growth: 0.0,
        reference_torque: 1.0,
        forgetting,
    };
    let mut out = vec![0.0; n];
    let (angle, restart) = (angle.as_slice()?, restart.as_slice()?);
    let (start, stretch) = (start_angle.as_slice()?, stretch.as_slice()?);
    py.detach(|| hysteresis::slip_state(angle, restart, start, stretch, &elements, &mut out))?;
    Ok(out.into_pyarray(py))
}

/// Play operator.
#[pyfunction]
fn play<'py>(
    py: Python<'py>,
    signal: Column<'py>,
    half_width: f64,
    restart: Flags<'py>,
    start: Column<'py>,
) -> PyResult<Reals<'py>> {
    let n = signal.len()?;
    let mut out = vec![0.0; n];
    hysteresis::play(
        signal.as_slice()?,
        half_width,
        restart.as_slice()?,
        start.as_slice()?,
        &mut out,
    )?;
    Ok(out.into_pyarray(py))
}

/// Input that a dashpot in parallel lets through.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords in Python")]
#[pyo3(signature = (signal, lapse, restart, lag, power=1.0, reference_rate=1.0, by_sample=false, thinning_rate=None))]
fn dragged<'py>(
    py: Python<'py>,
    signal: Column<'py>,
    lapse: Column<'py>,
    restart: Flags<'py>,
    lag: f64,
    power: f64,
    reference_rate: f64,
    by_sample: bool,
    thinning_rate: Option<f64>,
) -> PyResult<Reals<'py>> {
    let n = signal.len()?;
    let mut out = vec![0.0; n];
    hysteresis::dragged(
        signal.as_slice()?,
        lapse.as_slice()?,
        restart.as_slice()?,
        Dashpot {
            lag,
            power,
            thinning_rate,
            reference_rate,
            by_sample,
        },
        &mut out,
    )?;
    Ok(out.into_pyarray(py))
}

/// Kelvin-Voigt state of an input history.
#[pyfunction]
fn creep_state<'py>(
    py: Python<'py>,
    signal: Column<'py>,
    time: Column<'py>,
    restart: Flags<'py>,
    time_constant: f64,
) -> PyResult<Reals<'py>> {
    let n = signal.len()?;
    let mut out = vec![0.0; n];
    hysteresis::creep_state(
        signal.as_slice()?,
        time.as_slice()?,
        restart.as_slice()?,
        time_constant,
        &mut out,
    )?;
    Ok(out.into_pyarray(py))
}

/// Datum that remembers what earlier runs did, one value a run.
#[pyfunction]
fn remembered_datum<'py>(py: Python<'py>, push: Column<'py>, memory: f64) -> PyResult<Reals<'py>> {
    let mut out = vec![0.0; push.len()?];
    hysteresis::remembered_datum(push.as_slice()?, memory, &mut out);
    Ok(out.into_pyarray(py))
}

/// Adds the operators to the extension module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(solve_slip, module)?)?;
    module.add_function(wrap_pyfunction!(slip_state, module)?)?;
    module.add_function(wrap_pyfunction!(play, module)?)?;
    module.add_function(wrap_pyfunction!(creep_state, module)?)?;
    module.add_function(wrap_pyfunction!(dragged, module)?)?;
    module.add_function(wrap_pyfunction!(remembered_datum, module)?)
}
