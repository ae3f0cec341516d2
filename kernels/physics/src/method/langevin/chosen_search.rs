//! Choice of the pair search of a scene, as requested or as suitable.

use super::keys::{PER_SIDE, SEARCH, SKIN};
use super::laws::LAW;
use super::options::PairSearchKind;
use super::scene::LangevinScene;
use crate::domain::Domain;
use crate::grid::sectors_of;
use crate::number::significant;
use crate::scene::{GENERATE, MistakeKind, Precision, SIDES, SceneError, SceneValues, Spot};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::fast::{CellGrid, GridError};
use stripmine_kernels::sweep::lattice::{LatticeFrame, LatticeShape};

/// Pair energy, in ε, that particles hardly ever exceed. Pairs above it share a lattice cell, which costs time.
const HIGHEST: f64 = 30.0;
/// Half-width of the lattice's mask, in cells.
const HALF_WIDTH: u32 = 2;
/// Smallest number of sectors along a side: the all-pairs case of LAN17.
const FEWEST: f64 = 3.0;

/// Pair search with its parameters.
#[derive(Clone, Debug)]
pub(super) enum ChosenSearch {
    /// Lattice.
    Lattice(LatticeShape, LatticeFrame),
    Sectors(CellGrid),
    /// Neighbour lists built from sectors, with their skin (length).
    Lists(CellGrid, f64),
}

impl ChosenSearch {
    /// Word of the search in scenes.
    pub(super) fn by(&self) -> PairSearchKind {
        match self {
            ChosenSearch::Lattice(..) => PairSearchKind::Lattice,
            ChosenSearch::Sectors(_) => PairSearchKind::Sectors,
            ChosenSearch::Lists(..) => PairSearchKind::NeighborList,
        }
    }
}

/// Chooses the pair search that the scene requests or that suits it.
pub(super) fn choose_pair_search(
    values: &SceneValues,
    scene: &mut LangevinScene,
    domain: &Domain,
    [diameter, reach]: [f64; 2],
    count: usize,
    choices: &mut Vec<String>,
) -> Result<ChosenSearch, SceneError> {
    let single = scene.precision != Precision::F64;
    let box_spot =
        || -> Spot { if values.is_given(&SIDES) { values.spot(&SIDES) } else { values.spot(&GENERATE) } };
    let edge = widest_cell(scene, diameter);
    let lattice = || lattice_of(domain, reach, edge);
    let lists = |scene: &LangevinScene| {
        let skin = scene.skin.unwrap_or_else(|| default_skin(domain, reach, count));
        let grid = sectors_of(domain, reach + skin, single, count);
        (grid.map(|grid| ChosenSearch::Lists(grid, skin)), skin)
    };
    let sectors = |scene: &LangevinScene| match scene.per_side {
        None => sectors_of(domain, reach, single, count)
            .map_err(|cause| box_spot().error(MistakeKind::Geometry, cause.to_string())),
        Some(per_side) => grid(values, domain, per_side, reach),
    };
    let chosen = match scene.by {
        PairSearchKind::Lattice => lattice().ok_or_else(|| {
            let message = format!(
                "no lattice serves: a mask of 5 × 5 cells of one particle each reaches {}, the cut-off is {reach}, and a side needs at \
                 least five cells",
                significant(f64::from(HALF_WIDTH) * edge, 5)
            );
            let spot = if reach > f64::from(HALF_WIDTH) * edge { values.spot(&LAW) } else { values.spot(&SEARCH) };
            spot.error(MistakeKind::Geometry, message).expecting("search.by = \"sectors\" or \"neighbor-list\"")
        }).map(|(shape, frame)| ChosenSearch::Lattice(shape, frame))?,
        PairSearchKind::Sectors => ChosenSearch::Sectors(sectors(scene)?),
        PairSearchKind::Auto | PairSearchKind::NeighborList if scene.by == PairSearchKind::NeighborList || scene.skin.is_some() => {
            let (lists, skin) = lists(scene);
            lists.map_err(|cause| {
                let spot = if values.is_given(&SKIN) { values.spot(&SKIN) } else { box_spot() };
                let error = spot.error(MistakeKind::Geometry, format!("{cause}, with a skin of {skin}", skin = significant(skin, 5)));
                error.advising("make the box larger, lower search.skin, or set search.by = \"sectors\"")
            })?
        }
        PairSearchKind::Auto if scene.per_side.is_some() => {
            choices.push("search.by = \"sectors\": search.sectors is given".to_owned());
            ChosenSearch::Sectors(sectors(scene)?)
        }
        PairSearchKind::Auto | PairSearchKind::NeighborList => match lists(scene).0 {
            Ok(lists) => {
                choices.push("search.by = \"neighbor-list\": fastest in all measured cases".to_owned());
                lists
            }
            Err(_) => {
                choices.push("search.by = \"sectors\": the box is too small for lists".to_owned());
                ChosenSearch::Sectors(sectors(scene)?)
            }
        },
    };
    scene.by = chosen.by();
    if let ChosenSearch::Lists(_, skin) = &chosen {
        scene.skin = Some(*skin);
    }
    Ok(chosen)
}

/// Grid with a given number of sectors along each side.
fn grid(values: &SceneValues, domain: &Domain, per_side: u64, reach: f64) -> Result<CellGrid, SceneError> {
    let counts = [per_side as usize; 2];
    let edge = domain.lengths().map(|side| side / per_side as f64);
    if edge.iter().any(|&edge| edge < reach) {
        let most =
            domain.lengths().map(|side| (side / reach).floor()).into_iter().fold(f64::INFINITY, f64::min);
        let message = format!(
            "search.sectors = {per_side} makes sectors {} wide, narrower than the cut-off {}: pairs would be missed",
            significant(edge[0].min(edge[1]), 7),
            significant(reach, 7)
        );
        let error = values.spot(&PER_SIDE).error(MistakeKind::Geometry, message);
        return Err(match most >= FEWEST {
            true => error.expecting(format!("from 3 to {most} sectors")),
            false => error.advising("make the box larger: a side needs at least three sectors"),
        });
    }
    let along = per_side as f64;
    if along * along >= f64::from(u32::MAX) {
        let cause = GridError::TooMany { columns: along, rows: along };
        return Err(values.spot(&PER_SIDE).error(MistakeKind::Geometry, cause.to_string()));
    }
    Ok(CellGrid {
        frame: LatticeFrame { origin: domain.corner(), edge },
        counts,
        periodic: domain.periodic(),
    })
}

/// Default skin of the lists beyond the cut-off (length): about half the mean spacing, within bounds, and no more than the box
/// allows.
fn default_skin(domain: &Domain, reach: f64, count: usize) -> f64 {
    let spacing = (domain.area() / count.max(1) as f64).sqrt();
    let wanted = (0.5 * spacing).clamp(0.2 * reach, 2.0 * reach);
    let room = (0..2).map(|axis| domain.length(axis) / 3.0 - reach).fold(f64::INFINITY, f64::min);
    if room > 0.0 { wanted.min(room * (1.0 - 1e-12)) } else { wanted }
}

/// Widest cell (length) that hardly any two particles of a diameter share.
pub(super) fn widest_cell(scene: &LangevinScene, diameter: f64) -> f64 {
    scene.law.nearest(&scene.parameters, diameter, HIGHEST) * diameter / std::f64::consts::SQRT_2
}

/// Returns the lattice for pairs up to `reach` (length) apart, with cells no wider than `widest` (length); none if the box is too small.
fn lattice_of(domain: &Domain, reach: f64, widest: f64) -> Option<(LatticeShape, LatticeFrame)> {
    let least = reach / f64::from(HALF_WIDTH);
    if least > widest {
        return None;
    }
    let counts = [0, 1].map(|axis| (domain.length(axis) / least).floor());
    let edge = [0, 1].map(|axis| domain.length(axis) / counts[axis]);
    if counts.iter().any(|&count| count < 1.0 || count > f64::from(u32::MAX)) {
        return None;
    }
    let mask = Mask::square(HALF_WIDTH);
    let [columns, rows] = counts.map(|count| count as usize);
    let shape = LatticeShape::new(columns, rows, &mask, domain.periodic()).ok()?;
    Some((shape, LatticeFrame { origin: domain.corner(), edge }))
}
