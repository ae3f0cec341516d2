//! Class `Table`: columns as numpy arrays, whole tables in Arrow's format.

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator, StringArray, UInt64Array};
use arrow_schema::{ArrowError, DataType, Field, Schema};
use numpy::PyArray1;
use pyo3::exceptions::{PyKeyError, PyMemoryError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict};
use std::collections::HashMap;
use std::sync::Arc;
use stripmine_physics::method::observed::UnknownName;

/// Column of a table.
pub(crate) struct TableColumn {
    name: String,
    /// Empty for pure numbers and strings.
    unit: String,
    values: ColumnValues,
}

/// Values of a column.
enum ColumnValues {
    Counts(Vec<u64>),
    /// Missing values are NaN.
    Numbers(Vec<f64>),
    Words(Vec<String>),
}

impl TableColumn {
    /// Column of whole numbers.
    pub(crate) fn counts(name: &str, values: Vec<u64>) -> TableColumn {
        TableColumn { name: name.to_owned(), unit: String::new(), values: ColumnValues::Counts(values) }
    }

    /// Column of numbers with a unit.
    pub(crate) fn numbers(name: &str, unit: &str, values: Vec<f64>) -> TableColumn {
        TableColumn { name: name.to_owned(), unit: unit.to_owned(), values: ColumnValues::Numbers(values) }
    }

    /// Column of strings.
    pub(crate) fn words(name: &str, values: Vec<String>) -> TableColumn {
        TableColumn { name: name.to_owned(), unit: String::new(), values: ColumnValues::Words(values) }
    }

    fn field(&self) -> Field {
        let kind = match self.values {
            ColumnValues::Counts(_) => DataType::UInt64,
            ColumnValues::Numbers(_) => DataType::Float64,
            ColumnValues::Words(_) => DataType::Utf8,
        };
        let unit = HashMap::from([("unit".to_owned(), self.unit.clone())]);
        Field::new(&self.name, kind, matches!(self.values, ColumnValues::Numbers(_))).with_metadata(unit)
    }

    fn array(&self) -> ArrayRef {
        match &self.values {
            ColumnValues::Counts(values) => Arc::new(UInt64Array::from(values.clone())),
            ColumnValues::Numbers(values) => {
                let is_there = |value: &f64| (!value.is_nan()).then_some(*value);
                Arc::new(values.iter().map(is_there).collect::<Float64Array>())
            }
            ColumnValues::Words(values) => Arc::new(StringArray::from_iter_values(values)),
        }
    }

    fn to_numpy<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(match &self.values {
            ColumnValues::Counts(values) => PyArray1::from_slice(py, values).into_any(),
            ColumnValues::Numbers(values) => PyArray1::from_slice(py, values).into_any(),
            ColumnValues::Words(values) => py.import("numpy")?.call_method1("array", (values, "str"))?,
        })
    }

    fn len(&self) -> usize {
        match &self.values {
            ColumnValues::Counts(values) => values.len(),
            ColumnValues::Numbers(values) => values.len(),
            ColumnValues::Words(values) => values.len(),
        }
    }
}

/// Makes a table of columns, each with name, unit, type ("counts", "numbers" or "words") and values. None becomes NaN or an empty string.
#[pyfunction]
pub(crate) fn _table(columns: Vec<(String, String, String, Bound<'_, PyAny>)>) -> PyResult<Table> {
    let columns = columns.into_iter().map(|(name, unit, kind, values)| {
        let numbers =
            |values: Vec<Option<f64>>| values.into_iter().map(|it| it.unwrap_or(f64::NAN)).collect();
        let words = |values: Vec<Option<String>>| values.into_iter().map(Option::unwrap_or_default).collect();
        let values = match kind.as_str() {
            "counts" => ColumnValues::Counts(values.extract()?),
            "numbers" => ColumnValues::Numbers(numbers(values.extract()?)),
            _ => ColumnValues::Words(words(values.extract()?)),
        };
        Ok(TableColumn { name, unit, values })
    });
    Ok(Table::new(columns.collect::<PyResult<_>>()?))
}

/// Table: `table["name"]` is a column; pandas, polars and pyarrow read the whole table.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct Table {
    columns: Vec<TableColumn>,
}

impl Table {
    /// Table of columns of equal length.
    pub(crate) fn new(columns: Vec<TableColumn>) -> Table {
        Table { columns }
    }

    fn batch(&self) -> Result<RecordBatch, ArrowError> {
        let fields: Vec<Field> = self.columns.iter().map(TableColumn::field).collect();
        let arrays = self.columns.iter().map(TableColumn::array).collect();
        RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
    }
}

#[pymethods]
impl Table {
    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        self.columns.iter().map(|column| column.name.as_str()).collect()
    }

    /// Units of the columns, by name; empty for pure numbers and strings.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in &self.columns {
            units.set_item(&column.name, &column.unit)?;
        }
        Ok(units)
    }

    /// All columns as arrays, by name.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = PyDict::new(py);
        for column in &self.columns {
            all.set_item(&column.name, column.to_numpy(py)?)?;
        }
        Ok(all)
    }

    /// Converts to a `pandas.DataFrame`.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pandas")?.call_method1("DataFrame", (self.to_dict(py)?,))
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match self.columns.iter().find(|column| column.name == name) {
            Some(column) => column.to_numpy(py),
            None => {
                let error = UnknownName::new("column of this table", name, self.columns());
                Err(PyKeyError::new_err(error.to_string()))
            }
        }
    }

    fn __contains__(&self, name: &str) -> bool {
        self.columns.iter().any(|column| column.name == name)
    }

    fn __len__(&self) -> usize {
        self.columns.first().map_or(0, TableColumn::len)
    }

    fn __repr__(&self) -> String {
        format!("<Table: {} rows of {}>", self.__len__(), self.columns().join(", "))
    }

    /// Stream of the Arrow PyCapsule interface. A requested schema is ignored, as the interface allows.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _not_heeded = requested_schema;
        let batch = self.batch().map_err(|error| PyMemoryError::new_err(error.to_string()))?;
        let schema = batch.schema();
        let stream = FFI_ArrowArrayStream::new(Box::new(RecordBatchIterator::new([Ok(batch)], schema)));
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}
