//! `run --seeds`: runs one scene with several seeds side by side, and averages over the runs.

use super::RunVerb;
use super::side_by_side::{PlannedRun, SideBySide};
use crate::cli::display::{UnitSystem, structure_lines};
use crate::cli::processes;
use crate::console::{CommandFailure, Common, clear_progress, print_json, print_text, to_json};
use crate::provenance::built;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;
use stripmine_physics::averages::{RunAverages, joined};
use stripmine_physics::io::owned_folder::{FolderContent, FolderKind, LOCK, OwnedFolder};
use stripmine_physics::method::{Methods, prepare, vocabularies};
use stripmine_physics::number::significant;
use stripmine_physics::quoted;
use stripmine_physics::ranks::RankBackend;
use stripmine_physics::run::{
    FinishedRun, StructureFunction, averages_of, functions_of, starts_from_beginning,
};
use stripmine_physics::scene::{Fallback, Key, KeyValue, MistakeKind, SceneValues, Vocabulary};
use stripmine_physics::structure::{OBSERVABLES, observable};

/// File name of the joint summary.
const SUMMARY: &str = "seeds.json";
/// Kind of the folder that holds the runs and their joint summary.
pub(in crate::cli) const SEEDS: FolderKind = FolderKind {
    lock: LOCK,
    list: "seeds.files",
    holds: FolderContent::Files {
        heading: "stripmine seeds.files 1",
        is_own: |name| name == SUMMARY || OBSERVABLES.iter().any(|it| it.file == name),
        is_shared: true,
    },
};
/// Joint result of runs with different seeds.
#[derive(Serialize)]
struct SeedEnsemble {
    /// Mean of each quantity over all runs.
    averages: RunAverages,
    /// Wall time of all runs together (s).
    seconds: f64,
    runs: Vec<SeedRun>,
    /// Structure functions over all runs, each stored in its own file beside this one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    structure: Vec<StructureFunction>,
}

/// One of several runs with different seeds.
#[derive(Serialize)]
struct SeedRun {
    folder: PathBuf,
    seeds: Vec<String>,
    averages: RunAverages,
}

/// Runs of a scene with seeds in consecutive folders below `folder`, beginning with the scene's own seeds.
pub(in crate::cli) fn seeded_runs(keys: &[SeedKey], count: u64, folder: &Path) -> Vec<PlannedRun> {
    let member = |number: u64| PlannedRun {
        folder: folder.join(format!("seed-{}", keys[0].1.wrapping_add(number))),
        overrides: keys
            .iter()
            .map(|(key, first)| format!("{}={}", key.path(), first.wrapping_add(number)))
            .collect(),
    };
    (0..count).map(member).collect()
}

/// Key of a seed with its first value.
pub(in crate::cli) type SeedKey = (&'static Key, u64);

/// Seed keys of a scene, each with its first value: seeds of the start, and of the noise if it is given or is the only
/// random input.
pub(in crate::cli) fn seed_keys(values: &SceneValues, vocabulary: &Vocabulary) -> Vec<SeedKey> {
    let is_seed = |key: &&'static Key| key.name == "seed" || key.name.ends_with("_seed");
    let seed = |key: &&'static Key| match values.value(key) {
        Some(KeyValue::Whole(seed)) => Some((*key, seed)),
        _ => None,
    };
    let used: Vec<&'static Key> = vocabulary
        .keys
        .keys()
        .filter(is_seed)
        .filter(|key| values.is_used(key) && !values.is_idle(key))
        .collect();
    let found: Vec<SeedKey> = used.iter().filter_map(seed).collect();
    if !found.is_empty() {
        return found;
    }
    used.into_iter()
        .filter(|key| matches!(key.fallback, Fallback::Otherwise(_)))
        .map(|key| (key, 1))
        .collect()
}

impl RunVerb {
    /// Runs the scene with `count` seeds, beginning with the scene's own.
    pub(super) fn run_seeds(
        &self,
        count: u64,
        common: &Common,
        methods: Methods,
    ) -> Result<(), CommandFailure> {
        let folder = self.folder("seeds");
        // The scene and its start file are read once, so that later changes of the files cannot mix scenes.
        let text = SceneValues::text(&self.scene, &vocabularies(methods))?;
        let values = self.values(&text, &[], methods)?.sharing_start();
        let method = methods.iter().find(|method| method.vocabulary.keys.method == values.method());
        let keys = method.map_or(vec![], |method| seed_keys(&values, method.vocabulary));
        if keys.is_empty() {
            let error = values.spot(&stripmine_physics::scene::METHOD);
            let message = "this scene has no random numbers: every seed gives the same run";
            return Err(CommandFailure::Options(error.error(MistakeKind::Unused, message).into()));
        }
        let members = seeded_runs(&keys, count, &folder);
        let with_seeds = |seeds: &[String]| -> Result<_, CommandFailure> {
            Ok(prepare(self.values(&text, seeds, methods)?.with_start_of(&values), methods)?)
        };
        // Mistakes of the scene are reported once, before anything is written.
        let (prepared, _) = with_seeds(&members[0].overrides)?;
        prepared.memory.fits(&self.scene)?;
        let begun = Instant::now();
        let asked = &prepared.output.structure;
        let files = asked.iter().filter_map(|name| observable(name)).map(|it| it.file);
        let files: Vec<&str> = std::iter::once(SUMMARY).chain(files).collect();
        let claimed = || -> Result<OwnedFolder, CommandFailure> {
            let mut own = OwnedFolder::open(&folder, SEEDS, &[])?;
            own.claim(files.iter().copied(), self.overwrite)?;
            // A summary of earlier runs would be wrong if these are interrupted.
            own.remove_own(SUMMARY)?;
            Ok(own)
        };
        // If a run is refused, nothing is changed.
        if processes::rank(common.crew) == 0 {
            members
                .iter()
                .try_for_each(|run| starts_from_beginning(&run.folder, self.existing()).map(drop))?;
        }
        let runs = SideBySide {
            existing: self.existing(),
            memory: &prepared.memory,
            common,
            prepare: &with_seeds,
            folder: &folder,
        };
        let side_by_side = |some: &[PlannedRun]| {
            runs.carry_out(some)?
                .into_iter()
                .map(|it| it.map_err(|failed| failed.failure))
                .collect::<Result<Vec<_>, _>>()
        };
        let (own, averages) = if let RankBackend::Processes(join) = common.crew {
            let same = format!("{count} seeds\n{:?}\n{}", built(), prepared.scene);
            let mut own = None;
            processes::run_independently(join, &same, |rank, ranks| {
                if rank == 0 {
                    own = Some(claimed()?);
                }
                let some: Vec<_> = members.iter().skip(rank).step_by(ranks).cloned().collect();
                side_by_side(&some).map(drop)
            })?;
            // Only the first rank has claimed the folder; it writes the summary.
            let Some(own) = own else { return Ok(()) };
            let read = |run: &PlannedRun| averages_of(&[FinishedRun::read(&run.folder, methods)?]);
            (own, members.iter().map(read).collect::<Result<_, _>>()?)
        } else {
            let own = claimed()?;
            let found = side_by_side(&members);
            clear_progress();
            (own, found?.into_iter().map(|summary| summary.averages).collect::<Vec<RunAverages>>())
        };
        let members = members.into_iter().zip(averages);
        let runs: Vec<SeedRun> = members
            .map(|(run, averages)| SeedRun { folder: run.folder, seeds: run.overrides, averages })
            .collect();
        let all: Vec<RunAverages> = runs.iter().map(|run| run.averages.clone()).collect();
        let structure = functions_of(runs.iter().map(|run| run.folder.as_path()))?;
        let structure: Vec<StructureFunction> =
            structure.into_iter().filter(|it| files.contains(&it.file)).collect();
        let seconds = begun.elapsed().as_secs_f64();
        let ensemble = SeedEnsemble { averages: joined(&all), seconds, runs, structure };
        for function in &ensemble.structure {
            own.write(function.file, |out| out.write_all(function.csv().as_bytes()))?;
        }
        let summary = to_json(&ensemble)?;
        own.write(SUMMARY, |out| out.write_all(summary.as_bytes()))?;
        if common.json {
            return print_json(&ensemble);
        }
        let SeedEnsemble { averages, seconds, structure, .. } = &ensemble;
        let units = UnitSystem::of(prepared.scene.parse().ok().as_ref());
        let averages = units.averages(averages);
        let functions = structure.iter().map(|it| (it.name, it.headlines.as_slice(), it.doubt.as_deref()));
        let structure = structure_lines(functions, &units);
        print_text(&format!(
            "{count} runs with different seeds, in {} s\n{averages}{structure}results: {}\n",
            significant(*seconds, 3),
            quoted::path(&folder)
        ))
    }

    /// Values of the scene with seeds.
    fn values(&self, text: &str, seeds: &[String], methods: Methods) -> Result<SceneValues, CommandFailure> {
        let overrides = [self.overrides.as_slice(), seeds].concat();
        Ok(SceneValues::parse(&self.scene, text, &overrides, &vocabularies(methods))?)
    }
}
