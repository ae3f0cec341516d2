//! The folder of emitted code.

use super::{ARRAYS, EmittedScene};
use crate::console::CommandFailure;
use std::io::Write;
use std::path::{Path, PathBuf};
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};

/// Files of the folder: the functions, the program that calls them, the arrays before and after the steps, and the commands.
pub(super) const FILES: [&str; 5] = ["kernels.S", "driver.S", ARRAYS, "expected.bin", "run.sh"];
/// File of [`FILES`] that a run writes.
const FOUND: &str = "found.bin";

const CODE: FolderKind = FolderKind {
    lock: LOCK,
    list: "code.files",
    holds: FolderContent::Files {
        heading: "Files of stripmine emit:",
        is_own: |name| FILES.contains(&name) || ["code.files", FOUND].contains(&name),
        is_shared: false,
    },
};

/// Commands that assemble, link and run the program.
const COMMANDS: &str = "\
#!/bin/sh
# Assembles, links and runs the program, and compares its arrays with those that stripmine computed.
# Needs binutils for riscv64-linux-gnu and qemu-user; VLEN is the length of a vector register in bits.
set -e
cd \"$(dirname \"$0\")\"
for text in kernels driver; do
    riscv64-linux-gnu-as -march=rv64gv -mno-relax -o \"$text.o\" \"$text.S\"
done
riscv64-linux-gnu-ld --no-relax -o program driver.o kernels.o
qemu-riscv64 -cpu \"rv64,v=true,vlen=${VLEN:-1024},elen=64,vext_spec=v1.0\" ./program >found.bin
cmp found.bin expected.bin && echo 'the same bits'
";

/// Writes the emitted code to its folder, which must be empty or hold only such files.
///
/// # Errors
/// If the folder holds other files, or the system refuses to write.
pub(crate) fn write_folder(scene: &EmittedScene, out: &Path) -> Result<PathBuf, CommandFailure> {
    let mut folder = OwnedFolder::open(out, CODE, &[])?;
    folder.claim(FILES, false)?;
    let kernels = scene.kernels();
    let contents: [&[u8]; 5] = [
        kernels.as_bytes(),
        scene.driver.as_bytes(),
        &scene.start.bytes,
        &scene.end.bytes,
        COMMANDS.as_bytes(),
    ];
    for (name, bytes) in FILES.into_iter().zip(contents) {
        folder.write(name, |out| out.write_all(bytes))?;
    }
    Ok(folder.path().to_owned())
}
