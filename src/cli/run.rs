//! `stripmine run`: one simulation into a folder.

use super::{Common, Failure, output, print, print_json, warn};
use crate::run::{Ending, Existing, Summary, run};
use crate::scene::Document;
use crate::signals;
use clap::Args;
use std::path::{Path, PathBuf};

/// One simulation: observables, trajectory, summary and checkpoints in a folder
#[derive(Args)]
pub(super) struct RunVerb {
    /// A preset's name, or a scene file
    scene: String,
    /// Overrides a value; may be given several times
    #[arg(long = "set", value_name = "SECTION.KEY=VALUE")]
    overrides: Vec<String>,
    /// Folder for the results; the scene's name with `.run` by default
    #[arg(long)]
    out: Option<PathBuf>,
    /// Go on with the run in the folder; begin where there is none
    #[arg(long, conflicts_with = "overwrite")]
    resume: bool,
    /// Go on also with a run of another version, which does not promise the same bits
    #[arg(long, requires = "resume")]
    other_version: bool,
    /// Begin from the start where the folder holds a run; only what that run wrote is removed
    #[arg(long)]
    overwrite: bool,
}

impl RunVerb {
    pub(super) fn run(&self, common: &Common) -> Result<(), Failure> {
        let document = Document::load(&self.scene, &self.overrides)?;
        let folder = self.out.clone().unwrap_or_else(|| {
            let stem = Path::new(&self.scene).file_stem().unwrap_or_default();
            PathBuf::from(format!("{}.run", stem.to_string_lossy()))
        });
        let existing = match (self.resume, self.overwrite) {
            (true, _) => Existing::Resume { other_version: self.other_version },
            (_, true) => Existing::Overwrite,
            _ => Existing::Refuse,
        };
        let bar = output::bar(common, 0, "{wide_bar} step {pos}/{len} [{elapsed}, ETA {eta}]");
        let progress = |step, steps| {
            bar.set_length(steps);
            bar.set_position(step);
        };
        let notice = |note: &str| {
            if !common.quiet {
                warn(note);
            }
        };
        let ending = run(document, &folder, existing, signals::asked(), progress, notice);
        output::clear_progress();
        match ending? {
            Ending::Done(summary) if common.json => print_json(&summary),
            Ending::Done(summary) => {
                if !common.quiet {
                    summary.warnings.iter().for_each(warn);
                }
                print(&text(&summary, &folder))
            }
            Ending::Interrupted { step } => Err(Failure::Interrupted { step, folder }),
        }
    }
}

fn text(summary: &Summary, folder: &Path) -> String {
    let Summary { discs: [grains, walls], lattice, occupancy, steps, seconds, last, .. } = summary;
    let mut text = format!("{grains} grains and {walls} wall discs");
    if let (Some([columns, rows]), Some(occupancy)) = (lattice, occupancy) {
        text.push_str(&format!(" on {columns}×{rows} cells, occupancy {occupancy:.3}"));
    }
    text.push_str(&format!(
        "\n{steps} steps in {seconds:.2} s; time {:.6}, temperature {:.4e}, flow {:.4e}, contacts {}, deepest penetration \
         {:.4}\n",
        last.time, last.temperature, last.flow, last.contacts, last.deepest_penetration
    ));
    for reason in &summary.left_out {
        text.push_str(&format!("left out: {reason}\n"));
    }
    if let Some(share) = summary.work_relative_to_everything.filter(|&share| share < 1.0) {
        let saved = 100.0 * (1.0 - share);
        text.push_str(&format!(
            "saved: {saved:.1} % of a step's operations with friction and different discs\n"
        ));
    }
    text.push_str(&format!("results in {}\n", folder.display()));
    text
}
