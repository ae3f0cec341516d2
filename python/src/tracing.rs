//! Kernels traced from Python functions: counts, listings, code, and runs on arrays.

use crate::exceptions;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use stripmine_kernels::emit::GroupSize;
use stripmine_kernels::isa::Op;
use stripmine_kernels::own::{OwnKernelError, OwnProgram, TracedKernel};
use stripmine_kernels::{Execution, InstructionSet};

/// Recorded program of a traced function. `stripmine/_tracing.py` wraps it.
#[pyclass(frozen, module = "stripmine")]
pub(crate) struct _TracedProgram {
    program: OwnProgram<TracedKernel>,
}

/// Makes a program of a kernel as JSON.
#[pyfunction]
pub(crate) fn _traced(py: Python<'_>, text: &str) -> PyResult<_TracedProgram> {
    let kernel: TracedKernel =
        serde_json::from_str(text).map_err(|why| exceptions::refused(py, why.to_string()))?;
    let program = OwnProgram::new(kernel).map_err(|why| exceptions::refused(py, why.to_string()))?;
    Ok(_TracedProgram { program })
}

/// Execution of a name.
fn execution(py: Python<'_>, name: &str) -> PyResult<Execution> {
    let strip = name.strip_prefix("strip:").and_then(|length| length.parse().ok()).filter(|it| *it > 0);
    match name {
        "eager" => Ok(Execution::Eager),
        "chained" => Ok(Execution::Chained),
        _ => strip.map(Execution::Strip).ok_or_else(|| {
            exceptions::refused(
                py,
                format!("unknown execution {name:?}; known are eager, strip:N and chained"),
            )
        }),
    }
}

/// Outputs of a program; elements without a neighbour at every shift are NaN.
fn computed(
    program: &OwnProgram<TracedKernel>,
    inputs: &[Vec<f64>],
    length: usize,
    how: Execution,
) -> Result<Vec<Vec<f64>>, OwnKernelError> {
    let kernel = program.kernel();
    let mut outputs: Vec<Vec<f64>> = kernel.outputs().map(|_| vec![f64::NAN; length]).collect();
    let mut memory = program.memory();
    for (name, values) in kernel.inputs().iter().zip(inputs) {
        memory = memory.read(name, values)?;
    }
    for (name, values) in kernel.outputs().zip(&mut outputs) {
        memory = memory.write(name, values)?;
    }
    program.run(&memory, program.interior(length), how, InstructionSet::best())?;
    drop(memory);
    Ok(outputs)
}

#[pymethods]
impl _TracedProgram {
    /// Section, operation and count, for each operation in use.
    fn counts(&self) -> Vec<(&'static str, &'static str, u64)> {
        let mut rows = vec![];
        for (section, counts) in self.program.runnable().tally() {
            let used = Op::ALL.iter().filter(|op| counts.of(**op) > 0);
            rows.extend(used.map(|op| (section, op.mnemonic(), counts.of(*op))));
        }
        rows
    }

    /// Vector instructions as an assembly listing.
    fn listing(&self) -> String {
        self.program.runnable().listing()
    }

    /// Code for RISC-V's vector extension.
    fn rvv(&self, py: Python<'_>, name: &str, lmul: usize) -> PyResult<String> {
        let size = GroupSize::ALL.into_iter().find(|size| size.registers() == lmul);
        let size =
            size.ok_or_else(|| exceptions::refused(py, format!("lmul is {lmul}, but must be 1, 2, 4 or 8")))?;
        let runnable = self.program.runnable();
        let kernel = runnable.emitted(size).map_err(|why| exceptions::refused(py, why.to_string()))?;
        Ok(kernel.text(name, &runnable.lines()))
    }

    /// Runs the program on arrays in the order of its inputs; elements without a neighbour at every shift are NaN.
    fn run<'py>(
        &self,
        py: Python<'py>,
        arrays: Vec<PyReadonlyArray1<'py, f64>>,
        how: &str,
    ) -> PyResult<Vec<Bound<'py, PyArray1<f64>>>> {
        let how = execution(py, how)?;
        let inputs: Vec<Vec<f64>> = arrays.iter().map(|array| array.as_array().to_vec()).collect();
        let length = inputs.first().map_or(0, Vec::len);
        let program = &self.program;
        let found = py.detach(|| computed(program, &inputs, length, how));
        let outputs = found.map_err(|why| exceptions::refused(py, why.to_string()))?;
        Ok(outputs.iter().map(|values| PyArray1::from_slice(py, values)).collect())
    }
}
