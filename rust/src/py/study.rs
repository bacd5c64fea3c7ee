//! `_core.Study`: a study's definition in, columns as NumPy arrays out.

use std::sync::atomic::{AtomicU64, Ordering};

use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadwriteArray1};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;

use crate::model::active_pins::Criterion;
use crate::model::design::{Design, ShaftSegment};
use crate::model::inputs::{Input, input_index, segment_input};
use crate::model::shaft::SegmentKind;
use crate::sampling::{Axis, Layout, Rows, Space, Values};
use crate::{Limit, Limited, Output, Source, Study, StudyError, Target};

impl From<StudyError> for PyErr {
    fn from(error: StudyError) -> Self {
        PyValueError::new_err(error.to_string())
    }
}

/// A study's definition, ready to evaluate.
#[pyclass(name = "Study", frozen, module = "cyclosweep._core")]
pub struct PyStudy {
    study: Study,
    outputs: Vec<(String, Output)>,
}

static VARIANTS: AtomicU64 = AtomicU64::new(0);
static VALUES: AtomicU64 = AtomicU64::new(0);

/// How many variants, and how many values of result columns, the kernel has computed in this
/// process.
#[pyfunction]
pub fn kernel_evaluations() -> (u64, u64) {
    (
        VARIANTS.load(Ordering::Relaxed),
        VALUES.load(Ordering::Relaxed),
    )
}

/// One axis as Python describes it: (name, form, numbers).
type AxisSpec<'py> = (String, String, PyReadonlyArray1<'py, f64>);
/// The status codes, whether any variant is refused, and the columns asked for.
pub type Evaluated<'py> = (Bound<'py, PyArray1<u8>>, bool, Bound<'py, PyArray2<f64>>);

fn values_of(form: &str, numbers: &[f64]) -> PyResult<Values> {
    match (form, numbers) {
        ("list", numbers) => Ok(Values::List(numbers.to_vec())),
        ("linspace", [from, to, steps]) => Ok(Values::Linspace {
            from: *from,
            to: *to,
            steps: *steps as u64,
        }),
        ("interval", [low, high]) => Ok(Values::Interval {
            low: *low,
            high: *high,
        }),
        ("whole", [low, high]) => Ok(Values::Whole {
            low: *low,
            high: *high,
        }),
        ("normal", [mean, sd, low, high, below_low, below_high]) => Ok(Values::Normal {
            mean: *mean,
            sd: *sd,
            low: *low,
            high: *high,
            below_low: *below_low,
            below_high: *below_high,
        }),
        ("triangular", [low, mode, high]) => Ok(Values::Triangular {
            low: *low,
            mode: *mode,
            high: *high,
        }),
        ("log-uniform", [low, high]) => Ok(Values::LogUniform {
            low: *low,
            high: *high,
        }),
        _ => Err(PyValueError::new_err(format!("unknown axis form {form}"))),
    }
}

fn layout_of(name: &str) -> PyResult<Layout> {
    match name {
        "grid" => Ok(Layout::Grid),
        "sobol" => Ok(Layout::Sobol),
        "latin-hypercube" => Ok(Layout::LatinHypercube),
        "random" => Ok(Layout::Random),
        "table" => Ok(Layout::Table),
        "saltelli" => Ok(Layout::Saltelli),
        _ => Err(PyValueError::new_err(format!(
            "unknown sampling method {name}"
        ))),
    }
}

fn kind_of(name: &str) -> PyResult<SegmentKind> {
    match name {
        "keyway" => Ok(SegmentKind::Keyway),
        "cylinder" => Ok(SegmentKind::Cylinder),
        "frustum" => Ok(SegmentKind::Frustum),
        _ => Err(PyValueError::new_err(format!(
            "unknown shaft segment {name}"
        ))),
    }
}

/// Points start..stop of a space over axes of any names, one row an axis.
///
/// `axes`: (name, form, numbers) as for a study.
#[pyfunction]
#[expect(
    clippy::needless_pass_by_value,
    reason = "a list from Python arrives by value"
)]
pub fn sample<'py>(
    py: Python<'py>,
    axes: Vec<AxisSpec<'_>>,
    layout: &str,
    count: u64,
    seed: u64,
    start: u64,
    stop: u64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let mut built = Vec::with_capacity(axes.len());
    for (input, (_, form, numbers)) in axes.iter().enumerate() {
        let values = values_of(form, numbers.as_slice()?)?;
        built.push(Axis { input, values });
    }
    let space = Space::new(built, layout_of(layout)?, count, seed)
        .map_err(|error| PyValueError::new_err(error.to_string()))?;
    if start > stop || stop > space.len() {
        return Err(PyIndexError::new_err(format!(
            "points {start}..{stop} of {}",
            space.len()
        )));
    }
    let len = (stop - start) as usize;
    let columns = PyArray2::<f64>::zeros(py, [axes.len(), len], false);
    {
        let mut columns = columns.readwrite();
        let chunks = columns.as_slice_mut()?.chunks_mut(len.max(1));
        for (axis, column) in chunks.enumerate() {
            space.fill(axis, Rows::From(start), column);
        }
    }
    Ok(columns)
}

impl PyStudy {
    /// The study.
    pub const fn study(&self) -> &Study {
        &self.study
    }

    fn axis_number(&self, name: &str) -> PyResult<usize> {
        let index = input_index(name, self.study.segments());
        let found = self
            .study
            .space()
            .axes()
            .iter()
            .position(|axis| Some(axis.input) == index);
        found.ok_or_else(|| PyValueError::new_err(format!("{name} does not vary in this study")))
    }

    fn axis_numbers(&self, names: &[String]) -> PyResult<Vec<usize>> {
        names.iter().map(|name| self.axis_number(name)).collect()
    }

    fn chosen(&self, names: &[String]) -> PyResult<Vec<Output>> {
        let find = |name: &String| {
            let found = self.outputs.iter().find(|(known, _)| known == name);
            let unknown = || PyValueError::new_err(format!("unknown result column {name}"));
            found.map(|(_, output)| *output).ok_or_else(unknown)
        };
        names.iter().map(find).collect()
    }

    /// Requires variants start..stop of the study; how many they are.
    pub fn check_range(&self, start: u64, stop: u64) -> PyResult<usize> {
        if start <= stop && stop <= self.study.space().len() {
            Ok((stop - start) as usize)
        } else {
            let len = self.study.space().len();
            Err(PyIndexError::new_err(format!(
                "variants {start}..{stop} of {len}"
            )))
        }
    }

    /// Requires variants of the study.
    pub fn check_indices(&self, indices: &[u64]) -> PyResult<()> {
        let len = self.study.space().len();
        match indices.iter().find(|index| **index >= len) {
            None => Ok(()),
            Some(index) => Err(PyIndexError::new_err(format!("variant {index} of {len}"))),
        }
    }

    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        rows: Rows<'_>,
        len: usize,
        outputs: &[String],
    ) -> PyResult<Evaluated<'py>> {
        let outputs = self.chosen(outputs)?;
        VARIANTS.fetch_add(len as u64, Ordering::Relaxed);
        VALUES.fetch_add((len * outputs.len()) as u64, Ordering::Relaxed);
        // NumPy allocates, and all columns at once: it asks for huge pages from 4 MiB on, and in
        // pages of 4 KiB a third of a table's time goes to page faults.
        let status = PyArray1::<u8>::zeros(py, len, false);
        let columns = PyArray2::<f64>::zeros(py, [outputs.len(), len], false);
        let any_refused = {
            let mut status = status.readwrite();
            let mut columns = columns.readwrite();
            let status = status.as_slice_mut()?;
            let columns = columns.as_slice_mut()?.chunks_mut(len.max(1)).collect();
            py.detach(|| self.study.evaluate_into(rows, &outputs, status, columns))?
        };
        Ok((status, any_refused, columns))
    }
}

/// Memory as this many columns of a length.
fn columns_of<T>(memory: &mut [T], count: usize, len: usize) -> PyResult<Vec<&mut [T]>> {
    if memory.len() != count * len {
        let found = memory.len();
        return Err(PyValueError::new_err(format!(
            "memory for {found} numbers, expected {count} times {len}"
        )));
    }
    Ok(memory.chunks_mut(len.max(1)).collect())
}

#[pymethods]
impl PyStudy {
    /// `base`: every input by name in the user's unit, NaN where left out. `axes`: (name, form,
    /// numbers), form "list", "linspace" (from, to, steps), "interval" or "whole" (low, high).
    #[new]
    #[expect(
        clippy::too_many_arguments,
        clippy::needless_pass_by_value,
        reason = "one call a study"
    )]
    fn new(
        base: Vec<(String, f64)>,
        kinds: Vec<String>,
        axes: Vec<AxisSpec<'_>>,
        layout: &str,
        count: u64,
        seed: u64,
        loads: Vec<f64>,
        limits: Vec<(String, f64, f64)>,
    ) -> PyResult<Self> {
        let kinds = kinds
            .iter()
            .map(|kind| kind_of(kind))
            .collect::<PyResult<Vec<_>>>()?;
        // Inputs of the component model are axes, never values of a published design.
        let index = |name: &str| {
            let unknown = || PyValueError::new_err(format!("unknown input {name}"));
            input_index(name, kinds.len()).ok_or_else(unknown)
        };
        let mut inputs = vec![f64::NAN; segment_input(kinds.len(), 0)];
        for (name, value) in &base {
            let place = inputs.get_mut(index(name)?);
            *place.ok_or_else(|| PyValueError::new_err(format!("unknown input {name}")))? = *value;
        }
        let code = inputs[Input::Criterion as usize];
        let criterion = Criterion::ALL
            .into_iter()
            .find(|known| f64::from(*known as u8) == code);
        let unknown = || PyValueError::new_err(format!("unknown criterion number {code}"));
        let segment = |(number, kind): (usize, &SegmentKind)| {
            let fields = std::array::from_fn(|field| inputs[segment_input(number, field)]);
            ShaftSegment::of(*kind, fields)
        };
        let design = Design::of_values(
            |input| inputs[input as usize],
            criterion.ok_or_else(unknown)?,
            kinds.iter().enumerate().map(segment).collect(),
        );
        let outputs: Vec<(String, Output)> = Output::all(&loads)
            .into_iter()
            .map(|output| (output.name(&loads), output))
            .collect();
        let mut ranges = Vec::with_capacity(limits.len());
        for (name, min, max) in limits {
            let column = match outputs.iter().find(|(known, _)| *known == name) {
                Some((_, output)) => Limited::Output(*output),
                None => Limited::Input(index(&name)?),
            };
            ranges.push(Limit { column, min, max });
        }
        let mut built = Vec::with_capacity(axes.len());
        for (name, form, numbers) in &axes {
            let values = values_of(form, numbers.as_slice()?)?;
            built.push(Axis {
                input: index(name)?,
                values,
            });
        }
        let space = Space::new(built, layout_of(layout)?, count, seed)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        let study = Study::new(space, &design, loads, ranges)?;
        Ok(Self { study, outputs })
    }

    /// Number of variants.
    #[getter]
    fn count(&self) -> u64 {
        self.study.space().len()
    }

    /// Variants the kernel has evaluated so far.
    #[getter]
    fn evaluated(&self) -> u64 {
        self.study.evaluated()
    }

    /// Which of these result columns may be NaN for a variant that can be built.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a list from Python arrives by value"
    )]
    fn may_not_apply(&self, outputs: Vec<String>) -> PyResult<Vec<bool>> {
        let chosen = self.chosen(&outputs)?;
        let may_not_apply = |output| self.study.may_not_apply(output);
        Ok(chosen.into_iter().map(may_not_apply).collect())
    }

    /// Values of axes for variants start..stop, in the user's unit, one row an axis.
    fn axes<'py>(
        &self,
        py: Python<'py>,
        names: Vec<String>,
        start: u64,
        stop: u64,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let len = self.check_range(start, stop)?;
        let axes = self.axis_numbers(&names)?;
        // One array, as in `evaluate`.
        let columns = PyArray2::<f64>::zeros(py, [axes.len(), len], false);
        {
            let mut columns = columns.readwrite();
            let columns = columns.as_slice_mut()?.chunks_mut(len.max(1)).collect();
            py.detach(|| self.study.axes_into(&axes, Rows::From(start), columns))?;
        }
        Ok(columns)
    }

    /// Writes values of axes for variants start..stop to memory, one axis after the other.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a list and an array from Python arrive by value"
    )]
    fn fill_axes(
        &self,
        py: Python<'_>,
        names: Vec<String>,
        start: u64,
        stop: u64,
        mut memory: PyReadwriteArray1<'_, f64>,
    ) -> PyResult<()> {
        let len = self.check_range(start, stop)?;
        let axes = self.axis_numbers(&names)?;
        let columns = columns_of(memory.as_slice_mut()?, axes.len(), len)?;
        py.detach(|| self.study.axes_into(&axes, Rows::From(start), columns))?;
        Ok(())
    }

    /// Values of one axis for picked variants.
    fn axis_at<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        indices: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let indices = indices.as_slice()?;
        self.check_indices(indices)?;
        let axis = self.axis_number(name)?;
        let values = py.detach(|| {
            self.study
                .axis_values(axis, Rows::At(indices), indices.len())
        })?;
        Ok(values.into_pyarray(py))
    }

    /// Evaluates variants start..stop.
    fn evaluate_range<'py>(
        &self,
        py: Python<'py>,
        start: u64,
        stop: u64,
        outputs: Vec<String>,
    ) -> PyResult<Evaluated<'py>> {
        let len = self.check_range(start, stop)?;
        self.evaluate(py, Rows::From(start), len, &outputs)
    }

    /// Writes axes, then results, of variants start..stop to memory, one column after the other:
    /// to that of counts where `are_counts`, else to that of real numbers. The status codes, and
    /// whether any variant is refused.
    #[expect(
        clippy::needless_pass_by_value,
        clippy::too_many_arguments,
        reason = "lists and arrays from Python arrive by value, in one call a table"
    )]
    fn fill_range<'py>(
        &self,
        py: Python<'py>,
        start: u64,
        stop: u64,
        axes: Vec<String>,
        outputs: Vec<String>,
        are_counts: Vec<bool>,
        mut real_memory: PyReadwriteArray1<'py, f64>,
        mut count_memory: PyReadwriteArray1<'py, u32>,
    ) -> PyResult<(Bound<'py, PyArray1<u8>>, bool)> {
        let len = self.check_range(start, stop)?;
        let axes = self.axis_numbers(&axes)?.into_iter().map(Source::Axis);
        let outputs = self.chosen(&outputs)?;
        VARIANTS.fetch_add(len as u64, Ordering::Relaxed);
        VALUES.fetch_add((len * outputs.len()) as u64, Ordering::Relaxed);
        let sources: Vec<Source> = axes
            .chain(outputs.into_iter().map(Source::Output))
            .collect();
        let counts = are_counts.iter().filter(|is_count| **is_count).count();
        let reals = are_counts.len() - counts;
        let mut reals = columns_of(real_memory.as_slice_mut()?, reals, len)?.into_iter();
        let mut counts = columns_of(count_memory.as_slice_mut()?, counts, len)?.into_iter();
        let target = |is_count: &bool| match is_count {
            true => counts.next().map(Target::Count),
            false => reals.next().map(Target::Real),
        };
        let targets = are_counts.iter().filter_map(target).collect();
        let status = PyArray1::<u8>::zeros(py, len, false);
        let any_refused = {
            let mut status = status.readwrite();
            let status = status.as_slice_mut()?;
            let rows = Rows::From(start);
            py.detach(|| self.study.table_into(rows, &sources, status, targets))?
        };
        Ok((status, any_refused))
    }

    /// Evaluates picked variants.
    fn evaluate_at<'py>(
        &self,
        py: Python<'py>,
        indices: PyReadonlyArray1<'py, u64>,
        outputs: Vec<String>,
    ) -> PyResult<Evaluated<'py>> {
        let indices = indices.as_slice()?;
        self.check_indices(indices)?;
        self.evaluate(py, Rows::At(indices), indices.len(), &outputs)
    }

    /// Why a variant is refused, with the numbers that show it; none when it can be built.
    fn explain(&self, index: u64) -> PyResult<Option<String>> {
        self.check_indices(&[index])?;
        Ok(self.study.explain(index).map(|error| error.to_string()))
    }
}
