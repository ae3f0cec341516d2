//! Assembler, linker and emulator of others, which execute emitted code.

use super::{ARRAYS, EmittedProgram, EmittedScene};
use std::collections::HashMap;
use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use stripmine_kernels::isa::COUNTERS;
use stripmine_physics::reported::{ErrorClass, Reported};
use tempfile::TempDir;

/// Prefix of the programs of binutils.
const BINUTILS: &str = "riscv64-linux-gnu-";
const EMULATOR: &str = "qemu-riscv64";

/// Reasons why code could not be executed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub(crate) enum ToolchainError {
    #[error("{0} is missing; install binutils-riscv64-linux-gnu and qemu-user")]
    Missing(&'static str),
    #[error("{program} failed: {message}")]
    Failed { program: String, message: String },
    #[error("{0}: {1}")]
    File(PathBuf, std::io::Error),
}

impl Reported for ToolchainError {
    fn class(&self) -> ErrorClass {
        ErrorClass::InputOutput
    }
}

/// Tools of this machine.
#[derive(Clone, Debug)]
pub(crate) struct Toolchain {
    /// Versions of the assembler and the emulator.
    pub versions: [String; 2],
}

/// Result of a program.
#[derive(Clone, Debug)]
pub(crate) struct ExecutedProgram {
    /// Arrays and counters at the end.
    pub bytes: Vec<u8>,
    /// Executions of each instruction of each function; empty without a trace.
    pub executed: Vec<Vec<u64>>,
}

impl Toolchain {
    /// Finds the tools.
    ///
    /// # Errors
    /// [`ToolchainError::Missing`] names the first one that is missing.
    pub(crate) fn find() -> Result<Toolchain, ToolchainError> {
        let version = |program: &str, missing: &'static str| {
            let output = Command::new(program)
                .arg("--version")
                .output()
                .map_err(|_| ToolchainError::Missing(missing))?;
            let text = String::from_utf8_lossy(&output.stdout);
            Ok(text.lines().next().unwrap_or_default().to_owned())
        };
        let assembler = version(&format!("{BINUTILS}as"), "riscv64-linux-gnu-as")?;
        Ok(Toolchain { versions: [assembler, version(EMULATOR, EMULATOR)?] })
    }

    /// Assembles and links a scene in a scratch folder.
    ///
    /// # Errors
    /// [`ToolchainError::Failed`] with the message of the tool.
    pub(crate) fn build(&self, scene: &EmittedScene) -> Result<BuiltProgram, ToolchainError> {
        let folder = TempDir::new().map_err(|cause| ToolchainError::File(std::env::temp_dir(), cause))?;
        let file = |name: &str| folder.path().join(name);
        let write = |name: &str, bytes: &[u8]| {
            fs::write(file(name), bytes).map_err(|cause| ToolchainError::File(file(name), cause))
        };
        write("kernels.S", scene.kernels().as_bytes())?;
        write("driver.S", scene.driver.as_bytes())?;
        write(ARRAYS, &scene.start.bytes)?;
        for text in ["kernels", "driver"] {
            let (from, to) = (format!("{text}.S"), format!("{text}.o"));
            run(folder.path(), &format!("{BINUTILS}as"), &["-march=rv64gv", "-mno-relax", "-o", &to, &from])?;
        }
        run(
            folder.path(),
            &format!("{BINUTILS}ld"),
            &["--no-relax", "-o", "program", "driver.o", "kernels.o"],
        )?;
        let disassemble = ["-d", "-M", "no-aliases", "program"];
        let listed = run(folder.path(), &format!("{BINUTILS}objdump"), &disassemble)?;
        let functions = disassembled(&String::from_utf8_lossy(&listed));
        let of = |it: &EmittedProgram| functions.get(&it.name).cloned().unwrap_or_default();
        Ok(BuiltProgram { folder, functions: scene.programs.iter().map(of).collect() })
    }
}

/// Addresses and mnemonics of the instructions of every function, from the disassembly of the program.
fn disassembled(text: &str) -> HashMap<String, Vec<(u64, String)>> {
    let mut functions: HashMap<String, Vec<(u64, String)>> = HashMap::new();
    let mut name = String::new();
    for line in text.lines() {
        if let Some((_, label)) = line.strip_suffix(">:").and_then(|line| line.split_once(" <")) {
            name = label.to_owned();
        } else if let Some((address, instruction)) = line.split_once(':')
            && let Ok(address) = u64::from_str_radix(address.trim(), 16)
            && let Some(mnemonic) = instruction.split_whitespace().nth(1)
        {
            functions.entry(name.clone()).or_default().push((address, mnemonic.to_owned()));
        }
    }
    functions
}

/// Linked program of a scene.
#[derive(Debug)]
pub(crate) struct BuiltProgram {
    folder: TempDir,
    /// Address and mnemonic of every instruction of every function.
    functions: Vec<Vec<(u64, String)>>,
}

impl BuiltProgram {
    /// Mnemonics of a function as a disassembler reads them.
    pub(crate) fn mnemonics(&self, function: usize) -> impl Iterator<Item = &str> {
        self.functions[function].iter().map(|(_, mnemonic)| mnemonic.as_str())
    }

    /// Executes the program with vector registers of `vlen` bits. A trace counts the executions of every instruction.
    ///
    /// # Errors
    /// [`ToolchainError::Failed`] with the message of the emulator.
    pub(crate) fn execute(&self, vlen: usize, traced: bool) -> Result<ExecutedProgram, ToolchainError> {
        let cpu = format!("rv64,v=true,vlen={vlen},elen=64,vext_spec=v1.0");
        let mut arguments = vec!["-cpu", &cpu];
        if traced {
            arguments.extend(["-d", "in_asm,exec,nochain", "-D", "trace"]);
        }
        arguments.push("./program");
        let bytes = run(self.folder.path(), EMULATOR, &arguments)?;
        let executed = if traced { self.trace()? } else { vec![] };
        Ok(ExecutedProgram { bytes, executed })
    }

    /// Counts the executions of every instruction in the log of the emulator. The log has the addresses of each translated block, and the first address
    /// of every executed one as the second number in brackets. (Blocks of single instructions fail in QEMU 7.2 at conversions with a rounding mode of their own.)
    fn trace(&self) -> Result<Vec<Vec<u64>>, ToolchainError> {
        let path = self.folder.path().join("trace");
        let failed = |cause| ToolchainError::File(path.clone(), cause);
        let mut executed: Vec<Vec<u64>> = self.functions.iter().map(|it| vec![0; it.len()]).collect();
        let places = self.functions.iter().enumerate().flat_map(|(function, lines)| {
            lines.iter().enumerate().map(move |(line, (address, _))| (*address, (function, line)))
        });
        let places: HashMap<u64, (usize, usize)> = places.collect();
        let mut blocks: HashMap<u64, Vec<(usize, usize)>> = HashMap::new();
        let mut start = None;
        let hexadecimal = |word: &str| u64::from_str_radix(word, 16).ok();
        for line in BufReader::new(fs::File::open(&path).map_err(failed)?).lines() {
            let line = line.map_err(failed)?;
            if line.starts_with("IN:") {
                start = None;
            } else if let Some((word, _)) = line.strip_prefix("0x").and_then(|line| line.split_once(':')) {
                let Some(address) = hexadecimal(word) else { continue };
                let is_first = start.is_none();
                let block = blocks.entry(*start.get_or_insert(address)).or_default();
                // A block that is translated again replaces the old one.
                if is_first {
                    block.clear();
                }
                block.extend(places.get(&address));
            } else if let Some(address) = line.split('/').nth(1).and_then(hexadecimal) {
                let block = blocks.get(&address).into_iter().flatten();
                block.for_each(|&(function, line)| executed[function][line] += 1);
            }
        }
        Ok(executed)
    }
}

/// Runs a tool in a folder, and returns its standard output.
fn run(folder: &Path, program: &str, arguments: &[&str]) -> Result<Vec<u8>, ToolchainError> {
    let failed = |message: String| ToolchainError::Failed { program: program.to_owned(), message };
    let command = Command::new(program).args(arguments).current_dir(folder).stdin(Stdio::null()).output();
    let output = command.map_err(|cause| failed(cause.to_string()))?;
    match output.status.success() {
        true => Ok(output.stdout),
        false => Err(failed(format!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr)))),
    }
}

/// Bytes that differ between two results, without the counters behind the arrays.
pub(crate) fn differing(found: &[u8], expected: &[u8]) -> usize {
    let arrays = expected.len() - 8 * COUNTERS;
    let differ = found.iter().zip(&expected[..arrays]).filter(|(a, b)| a != b).count();
    differ + arrays.saturating_sub(found.len())
}
