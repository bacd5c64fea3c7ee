//! `_core.write_parquet`: a Parquet file of real numbers, with other columns from another file.

use std::collections::HashSet;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bytes::Bytes;
use numpy::PyReadonlyArray1;
use parquet::basic::{Compression, Type};
use parquet::column::writer::ColumnCloseResult;
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::types::SchemaDescriptor;
use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;

/// Bytes of a page at most: so few that the memory of a page is kept for the next one.
const PAGE: usize = 1 << 18;
/// Values of a column that are looked at to know whether compression is worth its time.
const LOOKED_AT: usize = 1024;

/// Real numbers as Python gives them, and in which rows there is one: in all where nothing is said.
type Given<'py> = (
    PyReadonlyArray1<'py, f64>,
    Option<PyReadonlyArray1<'py, bool>>,
);

/// A column of real numbers.
#[derive(Clone, Copy)]
struct Reals<'a> {
    values: &'a [f64],
    valid: Option<&'a [bool]>,
}

impl Reals<'_> {
    /// Whether a quarter of the first values, or more, come again among them, as on a grid.
    fn repeat(&self) -> bool {
        let looked_at = &self.values[..self.values.len().min(LOOKED_AT)];
        let different: HashSet<u64> = looked_at.iter().map(|value| value.to_bits()).collect();
        4 * different.len() <= 3 * looked_at.len()
    }

    /// Writes rows `from..to` as the next column of a row group.
    fn write(
        &self,
        group: &mut SerializedRowGroupWriter<'_, File>,
        from: usize,
        to: usize,
        levels: &mut Vec<i16>,
    ) -> Result<(), ParquetError> {
        let missing = || ParquetError::General("too many columns".to_owned());
        let mut column = group.next_column()?.ok_or_else(missing)?;
        let values = &self.values[from..to];
        levels.clear();
        match self.valid {
            None => {
                levels.resize(to - from, 1);
                let writer = column.typed::<DoubleType>();
                writer.write_batch(values, Some(levels), None)?;
            }
            Some(valid) => {
                let valid = &valid[from..to];
                levels.extend(valid.iter().map(|&valid| i16::from(valid)));
                let writer = column.typed::<DoubleType>();
                writer.write_batch(&held(values, valid), Some(levels), None)?;
            }
        }
        column.close()
    }
}

/// The values in rows that have one.
fn held(values: &[f64], valid: &[bool]) -> Vec<f64> {
    let mut held = Vec::with_capacity(values.len());
    let mut from = 0;
    for stretch in valid.split(|valid| !valid) {
        held.extend_from_slice(&values[from..from + stretch.len()]);
        from += stretch.len() + 1;
    }
    held
}

/// Appends a column of a row group of another file.
fn append(
    group: &mut SerializedRowGroupWriter<'_, File>,
    bytes: &Bytes,
    others: &SerializedFileReader<Bytes>,
    number: usize,
    column: usize,
) -> Result<(), ParquetError> {
    let from = others.metadata().row_group(number);
    let metadata = from.column(column).clone();
    group.append_column(
        bytes,
        ColumnCloseResult {
            bytes_written: metadata.compressed_size().cast_unsigned(),
            rows_written: from.num_rows().cast_unsigned(),
            metadata,
            bloom_filter: None,
            column_index: None,
            offset_index: None,
        },
    )
}

/// Where the columns of a file come from.
struct Sources<'a> {
    /// File without rows that has all columns.
    template: Bytes,
    /// File that has those that are no real numbers, in its row groups the same rows.
    others: Bytes,
    /// Columns in order; those that are no real numbers are none.
    columns: Vec<Option<Reals<'a>>>,
    rows: usize,
    rows_per_group: usize,
}

impl Sources<'_> {
    /// Requires columns and row groups that fit each other.
    fn check(
        &self,
        expected: &SchemaDescriptor,
        others: &SerializedFileReader<Bytes>,
    ) -> Result<(), ParquetError> {
        let of_others = self
            .columns
            .iter()
            .filter(|column| column.is_none())
            .count();
        let types = expected.columns().iter().zip(&self.columns);
        let fit = expected.num_columns() == self.columns.len()
            && types.into_iter().all(|(expected, column)| {
                column.is_none() || expected.physical_type() == Type::DOUBLE
            })
            && others
                .metadata()
                .file_metadata()
                .schema_descr()
                .num_columns()
                == of_others
            && (of_others == 0
                || others.metadata().num_row_groups() == self.rows.div_ceil(self.rows_per_group));
        let wrong = || ParquetError::General("columns or row groups do not fit".to_owned());
        fit.then_some(()).ok_or_else(wrong)
    }

    fn write(&self, path: &Path, metadata: Vec<(String, String)>) -> Result<(), ParquetError> {
        let template = SerializedFileReader::new(self.template.clone())?;
        let others = SerializedFileReader::new(self.others.clone())?;
        let schema = template.metadata().file_metadata();
        let descriptor = schema.schema_descr();
        self.check(descriptor, &others)?;
        let mut keys = schema.key_value_metadata().cloned().unwrap_or_default();
        let given = metadata.into_iter();
        keys.extend(given.map(|(key, value)| KeyValue::new(key, value)));
        let mut properties = WriterProperties::builder()
            .set_created_by(format!("cyclosweep {}", env!("CARGO_PKG_VERSION")))
            .set_key_value_metadata(Some(keys))
            .set_statistics_enabled(EnabledStatistics::Chunk)
            .set_offset_index_disabled(true)
            .set_compression(Compression::UNCOMPRESSED)
            .set_dictionary_enabled(false)
            .set_data_page_size_limit(PAGE)
            .set_data_page_row_count_limit(usize::MAX)
            .set_write_batch_size(PAGE / size_of::<f64>());
        for (column, description) in self.columns.iter().zip(descriptor.columns()) {
            // Elsewhere compression would take longer than all else and save nothing.
            if column.is_some_and(|reals| reals.repeat()) {
                let path = description.path().clone();
                properties = properties.set_column_compression(path, Compression::LZ4_RAW);
            }
        }
        let properties = Arc::new(properties.build());
        let root = descriptor.root_schema_ptr();
        let mut file = SerializedFileWriter::new(File::create(path)?, root, properties)?;
        let mut levels = Vec::new();
        for (number, from) in (0..self.rows).step_by(self.rows_per_group).enumerate() {
            let to = self.rows.min(from + self.rows_per_group);
            let mut group = file.next_row_group()?;
            let mut other = 0;
            for column in &self.columns {
                if let Some(reals) = column {
                    reals.write(&mut group, from, to, &mut levels)?;
                } else {
                    append(&mut group, &self.others, &others, number, other)?;
                    other += 1;
                }
            }
            group.close()?;
        }
        file.close()?;
        Ok(())
    }
}

/// What Python raises: an error of the system with its number, so that a full disk is known.
fn raised(error: &ParquetError, path: &Path) -> PyErr {
    let system = match error {
        ParquetError::External(source) => source.downcast_ref::<io::Error>(),
        _ => None,
    };
    match system.and_then(|error| Some((error.raw_os_error()?, error.to_string()))) {
        Some((number, text)) => PyOSError::new_err((number, text, path.to_path_buf())),
        None => PyValueError::new_err(format!("{}: {error}", path.display())),
    }
}

/// Writes a Parquet file with the schema and metadata of `template`, a file without rows.
///
/// Columns that are none come, in order, from `others`, a file with the same row groups.
#[pyfunction]
#[expect(
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    reason = "what Python gives arrives by value"
)]
pub fn write_parquet(
    py: Python<'_>,
    path: PathBuf,
    template: &[u8],
    others: &[u8],
    metadata: Vec<(String, String)>,
    columns: Vec<Option<Given<'_>>>,
    rows: usize,
    rows_per_group: usize,
) -> PyResult<()> {
    let mut found = Vec::with_capacity(columns.len());
    for column in &columns {
        let Some((values, valid)) = column else {
            found.push(None);
            continue;
        };
        let values = values.as_slice()?;
        let valid = valid.as_ref().map(|valid| valid.as_slice()).transpose()?;
        if values.len() != rows || valid.is_some_and(|valid| valid.len() != rows) {
            return Err(PyValueError::new_err(format!(
                "columns of {rows} rows expected"
            )));
        }
        found.push(Some(Reals { values, valid }));
    }
    let sources = Sources {
        template: Bytes::copy_from_slice(template),
        others: Bytes::copy_from_slice(others),
        columns: found,
        rows,
        rows_per_group: rows_per_group.max(1),
    };
    py.detach(|| sources.write(&path, metadata))
        .map_err(|error| raised(&error, &path))
}
