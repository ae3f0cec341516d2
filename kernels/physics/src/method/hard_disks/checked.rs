//! Checks a scene of hard discs against the preconditions of the method.

use super::compress::compress;
use super::configuration::EngineConfiguration;
use super::event::Arena;
use super::fast;
use super::identities::DiscIdentities;
use super::idle::is_idle_forever;
use super::keys::{ENGINE, EVENTS, FLOOR_AMPLITUDE, MASK, MASKS};
use super::options::EngineChoice;
use super::overlap_repair::{ROUNDING, StartOverlaps};
use super::reference::choice::{candidates, mask};
use super::reference::grid::ExclusiveGridSize;
use super::reference::linked_cells::CellCounts;
use super::restored::available_energy;
use super::scene::HardDiskScene;
use crate::domain::{BoxSide, Domain};
use crate::method::{Prepared, Until};
use crate::number::significant;
use crate::particles::{Particle, Particles};
use crate::scene::{
    GENERATE, MistakeKind, RADIUS, ReadBinding, SceneError, SceneErrors, SceneValues, WallMotion, Warning,
};
use crate::start::{StatedStart, create_initial_state, noise_seed, outside, overlaps};
use std::sync::Arc;
use stripmine_kernels::flight::FlyingDisc;
use stripmine_kernels::mask::Mask;

/// Checked scene of hard discs.
#[derive(Clone)]
pub(super) struct CheckedHardDisks {
    pub(super) scene: HardDiskScene,
    pub(super) domain: Domain,
    /// Shared with copies of the scene to save memory; none once the only simulation has started.
    pub(super) particles: Arc<Particles>,
    /// Engine of the simulation.
    pub(super) engine: EngineConfiguration,
    pub(super) warnings: Vec<Warning>,
    pub(super) choices: Vec<String>,
}

/// Places the discs of a scene and checks every precondition.
///
/// # Errors
/// [`SceneErrors`] with every violated precondition.
pub(super) fn prepare(values: SceneValues) -> Result<Prepared, SceneErrors> {
    let (mut scene, mut read) = (HardDiskScene::default(), ReadBinding::new(&values));
    scene.bind(&mut read);
    read.finish_reading()?;
    let stated = StatedStart {
        values: &values,
        domain: &scene.domain,
        barriers: &[],
        conserved: scene.domain.periodic.map(|is_periodic| is_periodic && scene.law.thermal.is_none()),
        start: &scene.start,
        walls: WallMotion::Fixed,
        compress,
    };
    let made = create_initial_state(&stated)?;
    let (domain, mut particles, mut warnings) = (made.domain, made.particles, made.warnings);
    let squeeze = StartOverlaps::of(&domain, &particles);
    warnings.extend(squeeze.shrink_radii(&values, &scene, &mut particles));
    let mut errors = outside(&stated, &domain, &particles);
    if squeeze.is_deep() {
        let found = overlaps(&stated, &domain, &particles, ROUNDING, "hard discs do not overlap");
        errors.extend(found.into_iter().map(|error| match error.suggestion {
            Some(_) => error,
            None => {
                error.advising(
                    "move the discs apart, lower their radii, or write positions in higher precision",
                )
            }
        }));
    }
    errors.extend(beyond_sides(&values, &domain, &particles));
    errors.extend(high_floor_error(&values, &scene, &domain, &particles));
    errors.extend(fixed(&values, &particles));
    let mut choices = vec![];
    let engine = match particles.radii() {
        Some(radii) => chosen_engine(&values, &mut scene, &domain, radii, &particles, &mut choices),
        None => Err(values.spot(&RADIUS).error(MistakeKind::Geometry, "there is nothing to simulate")),
    };
    errors.extend(engine.as_ref().err().cloned());
    SceneErrors::ok_if_empty(errors)?;
    let engine = engine.map_err(|error| SceneErrors(vec![error]))?;
    SceneErrors::ok_if_empty(idle_run_error(&values, &scene, domain, &particles).into_iter().collect())?;
    if let Some(thermal) = &mut scene.law.thermal {
        // Written into the scene if the start has no seed.
        if scene.start.seed().is_none() {
            scene.noise_seed.get_or_insert(thermal.seed);
        }
        thermal.seed = noise_seed(&scene.start, thermal.seed, &particles);
    }
    let particles = Arc::new(particles);
    let checked = CheckedHardDisks { scene, domain, particles, engine, warnings, choices };
    SceneErrors::ok_if_empty(checked.endless(&values).into_iter().collect())?;
    Ok(checked.prepared())
}

/// Error for a disc that reaches beyond a closed side.
fn beyond_sides(values: &SceneValues, domain: &Domain, particles: &Particles) -> Option<SceneError> {
    let beyond = |disc: &&Particle| {
        (0..2).any(|axis| match domain.sides[axis] {
            BoxSide::Closed(side) => {
                let along = disc.position[axis] - domain.origin[axis];
                along < disc.radius * (1.0 - ROUNDING) || along > side - disc.radius * (1.0 - ROUNDING)
            }
            _ => false,
        })
    };
    let first = particles.all().iter().find(beyond)?;
    let [x, y] = first.planar_position();
    let message = format!(
        "disc {} at ({x}, {y}) with radius {} reaches beyond a side that is not periodic",
        first.id, first.radius
    );
    let error = values.spot(&GENERATE).error(MistakeKind::Placement, message);
    Some(error.advising("make the sides periodic, or list discs at least a radius away from the sides"))
}

/// Error for a floor that rises so high that a disc does not fit below the ceiling.
fn high_floor_error(
    values: &SceneValues,
    scene: &HardDiskScene,
    domain: &Domain,
    particles: &Particles,
) -> Option<SceneError> {
    let swing = 2.0 * scene.law.floor?.amplitude;
    let [_, largest] = particles.radii()?;
    let room = domain.length(1) - swing;
    (!scene.open_top && room < 2.0 * largest).then(|| {
        let message = format!(
            "the floor rises by {swing} and leaves a height of {} below the ceiling for a disc of radius {largest}",
            significant(room, 7)
        );
        let error = values.spot(&FLOOR_AMPLITUDE).error(MistakeKind::Geometry, message);
        error.advising(
            "lower law.floor_amplitude, raise the second of domain.sides, or set domain.open_top = true",
        )
    })
}

/// Error for wall discs, which hard discs do not support.
fn fixed(values: &SceneValues, particles: &Particles) -> Option<SceneError> {
    let count = particles.len() - particles.grain_count();
    (count > 0).then(|| {
        let message = format!("{count} wall discs, but every hard disc moves");
        let error = values.spot(&GENERATE).error(MistakeKind::Contradiction, message);
        error.expecting("generate = \"hexagonal\", \"random\" or \"list\", or a file without wall discs")
    })
}

/// Error for a run of events in a scene that can have none.
fn idle_run_error(
    values: &SceneValues,
    scene: &HardDiskScene,
    domain: Domain,
    particles: &Particles,
) -> Option<SceneError> {
    let arena = scene.arena(domain);
    let is_idle = || is_idle_forever(&arena, &StartingDiscs::of(&arena, particles).discs);
    (matches!(scene.run.until, Until::Events(_)) && is_idle()).then(|| {
        let message = "nothing will ever happen: no disc meets another disc or a side";
        let error = values.spot(&EVENTS).error(MistakeKind::Contradiction, message);
        error.advising("give the discs a temperature or other velocities, or set run.time")
    })
}

/// All that a simulation needs of the particles at the start, which may be released then.
pub(super) struct StartingDiscs {
    /// Discs in the order of their ids.
    pub(super) discs: Vec<FlyingDisc>,
    pub(super) identities: DiscIdentities,
    /// Energy available to the discs, for the check of a checkpoint.
    pub(super) energy: f64,
}

impl StartingDiscs {
    /// Discs at the start.
    fn of(arena: &Arena, particles: &Particles) -> StartingDiscs {
        let identities = DiscIdentities::of(particles);
        let disc = |number: u32| starting_disc(arena, &particles.all()[identities.place(number)]);
        let discs = (0..identities.count() as u32).map(disc).collect();
        StartingDiscs { discs, identities, energy: available_energy(arena, particles) }
    }

    /// Discs at the start, whose particles are released piece by piece, unless a copy of the scene shares them.
    fn released(arena: &Arena, particles: Arc<Particles>) -> StartingDiscs {
        let identities = DiscIdentities::of(&particles);
        let energy = available_energy(arena, &particles);
        match Arc::try_unwrap(particles) {
            Ok(particles) if identities.are_in_order() => {
                let mut discs = Vec::with_capacity(particles.len());
                particles.release_each(|own| discs.push(starting_disc(arena, &own)));
                discs.reverse();
                StartingDiscs { discs, identities, energy }
            }
            Ok(particles) => StartingDiscs::of(arena, &particles),
            Err(shared) => StartingDiscs::of(arena, &shared),
        }
    }
}

/// Disc at its position inside the box, without events.
fn starting_disc(arena: &Arena, own: &Particle) -> FlyingDisc {
    FlyingDisc {
        position: arena.domain.wrapped(own.planar_position()),
        velocity: own.planar_velocity(),
        time: 0.0,
        radius: own.radius,
        mass: own.mass,
        events: 0,
    }
}

/// Selects the engine.
fn chosen_engine(
    values: &SceneValues,
    scene: &mut HardDiskScene,
    domain: &Domain,
    radii: [f64; 2],
    particles: &Particles,
    choices: &mut Vec<String>,
) -> Result<EngineConfiguration, SceneError> {
    let all = particles.all().iter().map(|disc| disc.radius);
    let displacement_limit = fast::displacement_limit(&scene.arena(*domain), all);
    let small = "the box is too small for lists: a disc would list others across two of its sides";
    let engine = match (scene.engine, displacement_limit) {
        (EngineChoice::Fast, None) => {
            let error = values.spot(&ENGINE).error(MistakeKind::Geometry, small);
            return Err(error.expecting("engine = \"reference\" or \"auto\", or a larger box"));
        }
        (EngineChoice::Auto, None) => {
            choices.push(format!("machine.engine = \"reference\": {small}"));
            EngineChoice::Reference
        }
        (EngineChoice::Auto, _) if values.is_given(&MASK) && scene.mask != MASKS[0] => {
            choices.push("machine.engine = \"reference\": a mask is given".to_owned());
            EngineChoice::Reference
        }
        (EngineChoice::Auto, _) => EngineChoice::Fast,
        (given, _) => given,
    };
    scene.engine = engine;
    match engine {
        EngineChoice::Auto | EngineChoice::Fast => Ok(EngineConfiguration::Fast(scene.instructions())),
        EngineChoice::Reference => {
            let mask = chosen_mask(values, scene, domain, radii, particles.len(), choices)?;
            Ok(EngineConfiguration::Reference(mask))
        }
        EngineChoice::CellCrossing => {
            linked_cells(values, scene, domain, radii, particles.len()).map(EngineConfiguration::CellCrossing)
        }
    }
}

/// Linked cells of a box.
fn linked_cells(
    values: &SceneValues,
    scene: &HardDiskScene,
    domain: &Domain,
    [_, largest]: [f64; 2],
    count: usize,
) -> Result<CellCounts, SceneError> {
    if scene.open_top {
        let message =
            "the engine cell-crossing needs cells for the whole box, but `domain.open_top` has no upper end";
        let error = values.spot(&ENGINE).error(MistakeKind::Contradiction, message);
        return Err(error.expecting("engine = \"fast\", \"reference\" or \"auto\", or open_top = false"));
    }
    CellCounts::new(domain, count, largest, scene.discs_in_cell).ok_or_else(|| {
        let [x, y] = domain.lengths().map(|side| significant(side, 5));
        let message = format!(
            "the box of {x} × {y} is too small for linked cells: a periodic side needs four, each as wide as the largest disc, {}",
            significant(2.0 * largest, 5)
        );
        let error = values.spot(&ENGINE).error(MistakeKind::Geometry, message);
        error.expecting("engine = \"reference\" or \"auto\", or a larger box")
    })
}

/// Returns the requested mask, or the cheapest one.
fn chosen_mask(
    values: &SceneValues,
    scene: &mut HardDiskScene,
    domain: &Domain,
    radii: [f64; 2],
    count: usize,
    choices: &mut Vec<String>,
) -> Result<Mask, SceneError> {
    let all = candidates(domain, radii, count);
    let serve: Vec<&str> = all.iter().filter(|it| it.predictions.is_finite()).map(|it| it.name).collect();
    let refused = |message: String| {
        let error = values.spot(&MASK).error(MistakeKind::Geometry, message);
        match serve.as_slice() {
            [] => error.advising("use a larger box, or radii that differ less"),
            names => error.expecting(format!("one of {}", names.join(", "))),
        }
    };
    let ExclusiveGridSize { cells: [columns, rows], .. } = ExclusiveGridSize::new(domain, radii[0]);
    let [low, high] = radii.map(|radius| significant(radius, 5));
    let in_words = format!("{columns} × {rows} cells, discs of radii {low} to {high}");
    match all.iter().find(|it| it.name == scene.mask) {
        Some(own) if own.predictions.is_finite() => {}
        Some(own) => {
            return Err(refused(format!(
                "mask {} does not serve {in_words}: it overlaps itself across a periodic side, or discs reach beyond it",
                own.name
            )));
        }
        None => {
            let best = all.iter().min_by(|a, b| a.predictions.total_cmp(&b.predictions));
            let Some(best) = best.filter(|best| best.predictions.is_finite()) else {
                return Err(refused(format!("no mask serves {in_words}")));
            };
            best.name.clone_into(&mut scene.mask);
            choices.push(format!(
                "search.mask = \"{}\": about {:.0} predictions per collision, the fewest of all masks",
                best.name, best.predictions
            ));
        }
    }
    mask(&scene.mask).ok_or_else(|| refused(format!("no mask is called {}", scene.mask)))
}

impl CheckedHardDisks {
    /// Discs at the start.
    pub(super) fn discs(&self) -> StartingDiscs {
        StartingDiscs::of(&self.scene.arena(self.domain), &self.particles)
    }

    /// Discs at the start, which the scene gives up.
    pub(super) fn released_discs(&mut self) -> StartingDiscs {
        let particles = std::mem::take(&mut self.particles);
        StartingDiscs::released(&self.scene.arena(self.domain), particles)
    }

    pub(super) fn packing_fraction(&self) -> f64 {
        let discs = self.particles.all().iter();
        discs.map(|disc| std::f64::consts::PI * disc.radius.powi(2)).sum::<f64>() / self.domain.area()
    }
}
