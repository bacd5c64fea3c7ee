//! `_core.PartStudy`: the component model of a study's variants, and of one variant in detail.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::components::contact::PowerLaws;
use crate::components::equilibrium::{Equilibrium, Loaded};
use crate::components::inputs::{PART_INPUTS, PARTS_AT, PartInput, Substitute, part_index};
use crate::components::laws::{self, Material};
use crate::components::mechanism::{Circles, Mechanism, Position};
use crate::components::outputs::PartOutput;
use crate::components::parts::{ContactLaw, Fixed, PartError, Parts};
use crate::components::pin_root::RootCompliance;
use crate::components::profile::Profile;
use crate::components::quadratic;
use crate::components::study::{PartLimit, PartStudy};
use crate::components::turn::{Engine, contact_totals};
use crate::py::study::{Evaluated, PyStudy};
use crate::sampling::Rows;

const MILLI: f64 = 1e-3;

/// The component model of a study's variants.
#[pyclass(name = "PartStudy", frozen, module = "cyclosweep._core")]
pub struct PyPartStudy {
    study: PartStudy,
}

/// The component model's inputs: (name, kind of default, its number or input's name).
#[pyfunction]
pub fn part_input_table() -> Vec<(&'static str, &'static str, f64, &'static str)> {
    let row = |input: PartInput| match input.row() {
        (name, _, Substitute::Required) => (name, "required", f64::NAN, ""),
        (name, _, Substitute::Number(number)) => (name, "number", number, ""),
        (name, _, Substitute::Same(other)) => (name, "same", f64::NAN, other.name()),
        (name, _, Substitute::Absent) => (name, "absent", f64::NAN, ""),
        (name, _, Substitute::Widths(share)) => (name, "widths", share, "disc_width_mm"),
    };
    PartInput::ALL.into_iter().map(row).collect()
}

/// The component model's result columns: (name, "real" | "count" | "solver").
#[pyfunction]
pub fn part_output_table() -> Vec<(&'static str, &'static str)> {
    let kind = |output| match output {
        PartOutput::ActiveOutputPinsMin
        | PartOutput::ActiveOutputPinsMax
        | PartOutput::RingPressurePin
        | PartOutput::OutputPressurePin => "count",
        PartOutput::Solver => "solver",
        _ => "real",
    };
    let row = |output: PartOutput| (output.name(), kind(output));
    PartOutput::ALL.into_iter().map(row).collect()
}

/// The words that the component model adds to the `status` column.
#[pyfunction]
pub fn part_status_labels() -> Vec<&'static str> {
    PartError::LABELS.to_vec()
}

fn engine_of(name: &str) -> PyResult<Engine> {
    match name {
        "full" => Ok(Engine::Full),
        "quadratic" => Ok(Engine::Quadratic),
        _ => Err(PyValueError::new_err(format!("unknown engine {name}"))),
    }
}

fn refused(error: &PartError) -> PyErr {
    crate::py::DesignError::new_err(error.to_string())
}

fn chosen(names: &[String]) -> PyResult<Vec<PartOutput>> {
    let find = |name: &String| {
        let unknown = || PyValueError::new_err(format!("unknown result column {name}"));
        PartOutput::named(name).ok_or_else(unknown)
    };
    names.iter().map(find).collect()
}

impl PyPartStudy {
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        study: &PyStudy,
        rows: Rows<'_>,
        len: usize,
        outputs: &[String],
    ) -> PyResult<Evaluated<'py>> {
        let outputs = chosen(outputs)?;
        let status = PyArray1::<u8>::zeros(py, len, false);
        let columns = PyArray2::<f64>::zeros(py, [outputs.len(), len], false);
        let any_refused = {
            let mut status = status.readwrite();
            let mut columns = columns.readwrite();
            let status = status.as_slice_mut()?;
            let mut columns: Vec<&mut [f64]> =
                columns.as_slice_mut()?.chunks_mut(len.max(1)).collect();
            let study = study.study();
            py.detach(|| {
                self.study
                    .evaluate_into(study, rows, &outputs, status, &mut columns)
            })?
        };
        Ok((status, any_refused, columns))
    }

    /// Everything that the component model reads of a variant.
    pub(crate) fn parts(&self, study: &PyStudy, variant: u64) -> PyResult<Parts> {
        study.check_indices(&[variant])?;
        self.study
            .parts_of(study.study(), variant)?
            .map_err(|error| refused(&error))
    }

    /// What of the parts no study varies.
    pub(crate) const fn fixed(&self) -> &Fixed {
        self.study.fixed()
    }
}

#[pymethods]
impl PyPartStudy {
    /// `values`: the component model's inputs by name in the user's unit. `root`: c_uu, c_ut, c_tt.
    /// Lists of gaps in mm. `limits`: (column, least, greatest, number among all limits).
    #[new]
    #[expect(
        clippy::too_many_arguments,
        clippy::needless_pass_by_value,
        reason = "one call a study"
    )]
    fn new(
        values: Vec<(String, f64)>,
        law: &str,
        root: [f64; 3],
        ring_gap_errors: Vec<f64>,
        hole_gap_errors: Vec<f64>,
        engine: &str,
        limits: Vec<(String, f64, f64, usize)>,
        published_limits: Vec<usize>,
    ) -> PyResult<Self> {
        let mut inputs = [f64::NAN; PART_INPUTS];
        for (name, value) in &values {
            let unknown = || PyValueError::new_err(format!("unknown input {name}"));
            inputs[part_index(name).ok_or_else(unknown)? - PARTS_AT] = *value;
        }
        let law = match law {
            "palmgren" => ContactLaw::Palmgren,
            "johnson" => ContactLaw::Johnson,
            _ => return Err(PyValueError::new_err(format!("unknown contact law {law}"))),
        };
        let in_metres = |gaps: Vec<f64>| gaps.into_iter().map(|gap| gap * MILLI).collect();
        let [c_uu, c_ut, c_tt] = root;
        let fixed = Fixed {
            law,
            root: RootCompliance { c_uu, c_ut, c_tt },
            ring_gap_errors: in_metres(ring_gap_errors),
            hole_gap_errors: in_metres(hole_gap_errors),
        };
        let mut ranges = Vec::with_capacity(limits.len());
        for (name, min, max, number) in limits {
            let output = chosen(&[name])?[0];
            ranges.push(PartLimit {
                output,
                min,
                max,
                number,
            });
        }
        let engine = engine_of(engine)?;
        Ok(Self {
            study: PartStudy::new(inputs, fixed, engine, ranges, published_limits),
        })
    }

    /// Solves variants start..stop.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a list from Python arrives by value"
    )]
    fn evaluate_range<'py>(
        &self,
        py: Python<'py>,
        study: &PyStudy,
        start: u64,
        stop: u64,
        outputs: Vec<String>,
    ) -> PyResult<Evaluated<'py>> {
        let len = study.check_range(start, stop)?;
        self.evaluate(py, study, Rows::From(start), len, &outputs)
    }

    /// Solves picked variants.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "arguments from Python arrive by value"
    )]
    fn evaluate_at<'py>(
        &self,
        py: Python<'py>,
        study: &PyStudy,
        indices: PyReadonlyArray1<'py, u64>,
        outputs: Vec<String>,
    ) -> PyResult<Evaluated<'py>> {
        let indices = indices.as_slice()?;
        study.check_indices(indices)?;
        self.evaluate(py, study, Rows::At(indices), indices.len(), &outputs)
    }

    /// Why a variant that the published model accepts has no component model; none when it has.
    fn explain(&self, study: &PyStudy, index: u64) -> PyResult<Option<String>> {
        study.check_indices(&[index])?;
        let found = self.study.explain(study.study(), index)?;
        Ok(found.map(|error| error.to_string()))
    }

    /// What an equilibrium of a variant needs, in SI.
    fn mechanism<'py>(
        &self,
        py: Python<'py>,
        study: &PyStudy,
        variant: u64,
    ) -> PyResult<Bound<'py, PyDict>> {
        let parts = self.parts(study, variant)?;
        let of = parts.mechanism(self.study.fixed());
        let table = PyDict::new(py);
        table.set_item("lobes", of.lobes)?;
        table.set_item("discs", of.discs)?;
        table.set_item("output_pins", of.output_pins)?;
        for (name, value) in [
            ("eccentricity", of.eccentricity),
            ("ring_radius", of.ring_radius),
            ("pin_circle_radius", of.pin_circle_radius),
            ("hole_clocking", of.hole_clocking),
            ("ring_gap", of.ring_gap),
            ("ring_enlargement", of.ring_enlargement),
            ("profile_rotation", of.profile_rotation),
            ("hole_gap", of.hole_gap),
            ("ring_stiffness", of.ring_stiffness),
            ("hole_stiffness", of.hole_stiffness),
            ("bearing_stiffness", of.bearing_stiffness),
            ("bearing_clearance", of.bearing_clearance),
            ("shaft_compliance", parts.shaft_compliance),
        ] {
            table.set_item(name, value)?;
        }
        table.set_item("ring_gap_errors", of.ring_gap_errors)?;
        table.set_item("hole_gap_errors", of.hole_gap_errors)?;
        table.set_item("pin_stiffness", of.pin_stiffness.to_vec())?;
        Ok(table)
    }

    /// The equilibrium of a variant under an output torque (N m) with the crank at `crank` (rad).
    /// Lengths in m, forces in N, pressures in Pa.
    fn state<'py>(
        &self,
        py: Python<'py>,
        study: &PyStudy,
        variant: u64,
        torque: f64,
        crank: f64,
        engine: &str,
    ) -> PyResult<Bound<'py, PyDict>> {
        let parts = self.parts(study, variant)?;
        let mechanism = parts.mechanism(self.study.fixed());
        let (mut circles, mut position) = (Circles::default(), Position::default());
        circles.set(&mechanism);
        position.set(&mechanism, &circles, crank);
        let full = Loaded::full(&mechanism, &position);
        let found = solved(&mechanism, &position, &full, torque, engine_of(engine)?);
        let (mut ring, mut pins) = (Vec::new(), Vec::new());
        for disc in 0..mechanism.discs {
            let (mut of_ring, mut of_pins) = (Vec::new(), Vec::new());
            full.ring_forces(disc, &found.motion, &mut of_ring);
            full.pin_forces(disc, &found.motion, &mut of_pins);
            ring.push(of_ring);
            pins.push(of_pins);
        }
        let (pressures, budget) = contact_totals(&parts, &mechanism, crank, &found.motion);
        let radius = mechanism.pin_circle_radius;
        let table = PyDict::new(py);
        table.set_item("converged", found.converged)?;
        let input = full.input_torque(torque, &found.motion, &mut Vec::new());
        table.set_item("input_torque", input)?;
        table.set_item("steps", found.steps)?;
        table.set_item("residual", found.residual)?;
        table.set_item("twist", found.motion.flange / radius)?;
        table.set_item("stiffness", found.stiffness * radius * radius)?;
        table.set_item("discs", found.motion.discs[..mechanism.discs].to_vec())?;
        table.set_item("ring_forces", ring)?;
        table.set_item("pin_forces", pins)?;
        table.set_item("pressures", pressures.to_vec())?;
        table.set_item("budget", budget.to_vec())?;
        table.set_item("shaft_compliance", parts.shaft_compliance)?;
        table.set_item("pin_circle_radius", radius)?;
        Ok(table)
    }
}

fn solved(
    mechanism: &Mechanism,
    position: &Position,
    full: &Loaded<'_, PowerLaws>,
    torque: f64,
    engine: Engine,
) -> Equilibrium {
    if engine == Engine::Quadratic {
        let (mut found, _) = quadratic::solve(mechanism, position, torque, None);
        if found.converged {
            found.stiffness = full.stiffness_at(&found.motion);
            return found;
        }
    }
    full.solve(torque, &full.first_motion(torque))
}

/// Half width (mm) and pressure (MPa) of a line contact after Hertz, and its approaches (mm) after
/// Palmgren and Johnson: force (N), length (mm), radii (mm, a hollow one below zero), and Young's
/// modulus (GPa) and Poisson's ratio of both bodies.
#[pyfunction]
fn line_contact(
    force: f64,
    length: f64,
    radii: [f64; 2],
    first: [f64; 2],
    second: [f64; 2],
) -> [f64; 4] {
    let [first, second] = [first, second].map(|[modulus, poisson]| Material {
        youngs_modulus: modulus * 1e9,
        poisson,
    });
    let (length, radii) = (length * MILLI, radii.map(|radius| radius * MILLI));
    let curvature = 1.0 / radii[0] + 1.0 / radii[1];
    let found = laws::hertz(force / length, curvature, first, second);
    let bodies = [(first, radii[0].abs()), (second, radii[1].abs())];
    [
        found.half_width * 1e3,
        found.pressure * 1e-6,
        laws::palmgren(first, second, length) * force.powf(laws::APPROACH_EXPONENT) * 1e3,
        laws::johnson(force / length, curvature, bodies) * 1e3,
    ]
}

/// Radii of curvature (mm) of a disc's profile at a lobe's top and in its pit, below zero where it
/// is hollow, and the smallest convex one: lobes, ring circle, ring pin and eccentricity (mm).
#[pyfunction]
fn profile_radii(lobes: usize, ring_radius: f64, pin_radius: f64, eccentricity: f64) -> [f64; 3] {
    let profile = Profile {
        lobes,
        ring_radius,
        pin_radius,
        eccentricity,
    };
    let at = |cosine| 1.0 / profile.path_curvature(cosine) - pin_radius;
    [at(-1.0), at(1.0), profile.radius_min()]
}

/// Registers what Python sees of the component model.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<PyPartStudy>()?;
    module.add_function(wrap_pyfunction!(part_input_table, module)?)?;
    module.add_function(wrap_pyfunction!(part_output_table, module)?)?;
    module.add_function(wrap_pyfunction!(part_status_labels, module)?)?;
    module.add_function(wrap_pyfunction!(line_contact, module)?)?;
    module.add_function(wrap_pyfunction!(profile_radii, module)?)?;
    Ok(())
}
