//! Active pins and hole paths for looking at one drive. SI, but turns for map angles.

use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::model::active_pins::{Criterion, PinMap};
use crate::model::error::DesignError;
use crate::model::hypotrochoid::hole_centre;

fn criterion_of(code: u8) -> Result<Criterion, DesignError> {
    let found = Criterion::ALL.get(usize::from(code)).copied();
    found.ok_or(DesignError::NonFinite {
        parameter: "criterion",
    })
}

/// Figures of the active-pin map: mean, minimum, maximum of active contacts by a criterion
/// (code), participation by statics (mean, minimum, maximum), window of hole H1 (turns).
#[pyfunction]
#[expect(
    clippy::type_complexity,
    reason = "three triples of one drive, unpacked in Python"
)]
pub fn active_pins(
    criterion: u8,
    ratio: f64,
    discs: u32,
    pins: u32,
    delta: f64,
    clocking: f64,
) -> PyResult<((f64, u32, u32), (f64, f64, f64), (f64, f64))> {
    let map = PinMap::new(ratio, discs, pins, delta, clocking)?;
    let count = match criterion_of(criterion)? {
        Criterion::PublishedMap => map.published_map(),
        Criterion::Inside => map.inside(),
        Criterion::Statics => map.statics(),
    };
    let p = map.participation();
    Ok((
        (count.mean, count.min, count.max),
        (p.mean, p.min, p.max),
        map.first_hole_window(),
    ))
}

/// Sectors of one turn by a criterion (code): starts, ends (turns), active contacts.
#[pyfunction]
pub fn sectors(
    criterion: u8,
    ratio: f64,
    discs: u32,
    pins: u32,
    delta: f64,
    clocking: f64,
) -> PyResult<Vec<(f64, f64, u32)>> {
    let map = PinMap::new(ratio, discs, pins, delta, clocking)?;
    let sectors = map.sectors(criterion_of(criterion)?);
    Ok(sectors
        .into_iter()
        .map(|s| (s.start, s.end, s.active))
        .collect())
}

/// Centres (m) of one hole at the mesh-zone positions `theta` (rad), shape (len(theta), 2).
#[pyfunction]
#[expect(
    clippy::needless_pass_by_value,
    reason = "an array from Python arrives by value"
)]
pub fn hole_locus<'py>(
    py: Python<'py>,
    eccentricity: f64,
    pin_circle_radius: f64,
    ratio: f64,
    hole_angle: f64,
    theta: PyReadonlyArray1<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let centres: Vec<f64> = theta
        .as_array()
        .iter()
        .flat_map(|t| {
            let c = hole_centre(eccentricity, pin_circle_radius, ratio, hole_angle, *t);
            [c.x, c.y]
        })
        .collect();
    let rows = centres.len() / 2;
    let flat: Bound<'py, PyArray1<f64>> = centres.into_pyarray(py);
    numpy::PyArrayMethods::reshape(&flat, [rows, 2])
}
