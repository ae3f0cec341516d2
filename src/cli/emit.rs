//! `stripmine emit`: programs of a scene as assembly text for a vector processor.

use crate::console::{CommandFailure, Common, print_json, print_text};
use crate::emission::{GroupChoice, TargetIsa, emit_scene, write_folder};
use clap::Args;
use std::path::PathBuf;
use stripmine_kernels::emit::Purpose;
use stripmine_physics::method::{Methods, load};

/// Writes the vector programs of a scene as assembly text with their data
///
/// The folder holds the functions, a program that calls them, the arrays at the start and after the steps as computed here, and a
/// script that assembles, runs and compares.
#[derive(Args)]
pub(super) struct EmitVerb {
    /// Preset name or scene file
    scene: String,
    /// Overrides a value; can be repeated
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Instruction set
    #[arg(long, value_enum)]
    isa: TargetIsa,
    /// Vector registers that form one register of the program (LMUL)
    #[arg(long, value_enum, default_value = "4")]
    lmul: GroupChoice,
    /// Steps that the program makes
    #[arg(long, default_value_t = 1)]
    steps: u64,
    /// Folder; other files there are never replaced
    #[arg(long)]
    out: PathBuf,
}

impl EmitVerb {
    pub(super) fn run(&self, common: &Common, methods: Methods) -> Result<(), CommandFailure> {
        let TargetIsa::Rvv = self.isa;
        let (prepared, _) = load(&self.scene, &self.overrides, methods)?;
        prepared.memory.fits(&self.scene)?;
        let scene = emit_scene(&self.scene, &prepared, self.lmul.size(), self.steps)?;
        let folder = write_folder(&scene, &self.out)?;
        let count = |purpose| scene.programs.iter().map(|it| it.kernel.count(purpose)).sum::<usize>();
        if common.json {
            let counts = Purpose::ALL.map(|it| (it.name().to_owned(), count(it).into()));
            let counts = serde_json::Map::from_iter(counts);
            return print_json(&serde_json::json!({
                "folder": folder, "programs": scene.programs.len(), "bytes": scene.start.bytes.len(), "instructions": counts,
            }));
        }
        let counts = Purpose::ALL.map(|it| format!("{} {}", count(it), it.name())).join(", ");
        print_text(&format!(
            "{} programs, {} bytes of arrays; instructions: {counts}\nrun it: sh {}\n",
            scene.programs.len(),
            scene.start.bytes.len(),
            folder.join("run.sh").display(),
        ))
    }
}
