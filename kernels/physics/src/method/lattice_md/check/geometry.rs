//! Lattice that suits the discs: at most one centre a cell, and no contact beyond the mask.

use crate::domain::Domain;
use crate::grid::sectors_of;
use crate::method::lattice_md::document::GranularDocument;
use crate::method::lattice_md::keys::{CELL_EDGE, MASK, SEARCH, SKIN};
use crate::method::lattice_md::model::sides_of;
use crate::method::lattice_md::scene::SearchKind;
use crate::method::pairwise::search::OnConflict;
use crate::number::significant;
use crate::scene::{
    COUNT, DiscStart, FILE, Key, MistakeKind, Precision, RADII, RADIUS, RADIUS_CUT, RADIUS_SPREAD, SIDES,
    SceneError, Spot, WALL_RADIUS,
};
use crate::start::rounded_to_nine_digits;
use stripmine_kernels::mask::Mask;
use stripmine_kernels::sweep::lattice::{LatticeFrame, LatticeShape};

/// The lattice of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Columns, rows, halo.
    pub shape: LatticeShape,
    /// Lower left corner and sides of a cell (length).
    pub frame: LatticeFrame,
    /// The neighbourhood.
    pub mask: Mask,
    /// Smallest and largest radius, walls included (length).
    pub radii: [f64; 2],
    /// Allowed sides of a square cell at this mask (length): 2 R_max/h and d_min/√2.
    pub(crate) edge_bounds: [f64; 2],
    /// Discs for each cell.
    pub occupancy: f64,
    /// Largest gap of listed pairs (length), where there are lists.
    pub skin: f64,
    /// Sides of the cells or sectors that positions are measured in (length), if they are not measured from the origin.
    pub(crate) widest_cell: [f64; 2],
}

/// Relative slack: rounding must not forbid what the bounds just allow.
const SLACK: f64 = 1.0 + 1e-12;

/// Number of counts tried for each axis on either side of the wanted one.
const WINDOW: f64 = 64.0;

/// Widest cells in which contacts are found, in largest diameters. The search compares squared distances in single precision with a margin of 2e-5,
/// measured from the centres of cells up to three and a half cells away.
const WIDEST: f64 = 8.0;

/// Bounds of a cell's size.
#[derive(Clone, Copy)]
struct CellBounds {
    half_width: u32,
    /// 2 R_max/h: shorter sides let contacts escape the mask.
    least: f64,
    /// d_min: a longer diagonal lets two centres share a cell.
    diagonal: f64,
}

impl CellBounds {
    fn new(half_width: u32, radii: [f64; 2], max_penetration: f64) -> Self {
        let [smallest, largest] = radii;
        CellBounds {
            half_width,
            least: 2.0 * largest / f64::from(half_width),
            diagonal: (1.0 - max_penetration) * 2.0 * smallest,
        }
    }

    fn most(&self) -> f64 {
        self.diagonal / std::f64::consts::SQRT_2
    }

    /// Longest side of a cell whose other side is the shortest allowed.
    fn longest(&self) -> f64 {
        (self.diagonal * self.diagonal - self.least * self.least).max(0.0).sqrt()
    }
}

/// Number and length of the cells along an axis.
#[derive(Clone, Copy)]
struct AxisCells {
    count: f64,
    edge: f64,
}

/// Cuts of an axis near the wanted edge that satisfy the bounds.
fn cuts(side: f64, periodic: bool, bounds: &CellBounds, wanted: f64) -> Vec<AxisCells> {
    let fewest = (side / (bounds.longest() * SLACK)).ceil().max(1.0);
    let (fewest, most) = if periodic {
        let needed = f64::from(2 * bounds.half_width + 1);
        (fewest.max(needed), (side / bounds.least * SLACK).floor())
    } else {
        (fewest, (side / bounds.least).ceil().max(1.0))
    };
    let target = (side / wanted).round();
    let (from, to) = (fewest.max(target - WINDOW), most.min(target + WINDOW));
    let counts = std::iter::successors(Some(from), |count| Some(count + 1.0)).take_while(move |n| *n <= to);
    counts
        .map(|count| {
            // Along an open side cells may extend beyond the box.
            let edge = if periodic { side / count } else { (side / count).max(bounds.least) };
            AxisCells { count, edge }
        })
        .collect()
}

/// Finds the lattice of a scene.
///
/// # Errors
/// Lists every reason why there is no such lattice.
pub(super) fn fit(
    document: &GranularDocument,
    domain: &Domain,
    radii: [f64; 2],
    discs: usize,
) -> Result<Geometry, Vec<SceneError>> {
    let scene = &document.scene;
    let bounds = |half_width| {
        let exclusive = CellBounds::new(half_width, radii, scene.law.max_penetration);
        // If discs may share a cell, any cell will do.
        let shared = scene.search.on_conflict == OnConflict::Resolve && scene.search.cell_edge.is_some();
        let exclusively = scene.needs_lattice() && !shared;
        let diagonal = if exclusively { exclusive.diagonal } else { f64::INFINITY };
        CellBounds { diagonal, ..exclusive }
    };
    let tries: Vec<CellBounds> = match scene.search.mask {
        Some(7) => vec![bounds(3)],
        Some(_) => vec![bounds(2)],
        None => vec![bounds(2), bounds(3)],
    };
    let roomy: Vec<CellBounds> =
        tries.iter().copied().filter(|bounds| bounds.least <= bounds.most() * SLACK).collect();
    if roomy.is_empty() {
        return Err(vec![ratio_error(document, radii)]);
    }
    let mut errors = Vec::new();
    for bounds in &roomy {
        match lattice(document, domain, bounds) {
            Ok((shape, frame, mask)) => {
                let occupancy = discs as f64 / shape.cells() as f64;
                let edge_bounds = [bounds.least, bounds.most()];
                let seen =
                    Domain::planar(domain.corner(), sides_of(domain, &shape, &frame), domain.periodic());
                let (skin, widest_cell) = search(document, [domain, &seen], radii[1], discs, frame.edge)
                    .map_err(|error| vec![error])?;
                return Ok(Geometry { shape, frame, mask, radii, edge_bounds, occupancy, skin, widest_cell });
            }
            // The smaller mask gives the simpler reason, but a wrong edge is wrong for the larger one too.
            Err(more) if errors.is_empty() || scene.search.cell_edge.is_some() => errors = more,
            Err(_) => {}
        }
    }
    Err(errors)
}

/// Skin of neighbour lists where the scene gives none, in largest radii.
const LEAST_SKIN: f64 = 0.3;

/// Returns the skin of lists and the sides of the cells that positions are measured in (length), for the scene's box and the box that steps use.
fn search(
    document: &GranularDocument,
    [domain, seen]: [&Domain; 2],
    largest: f64,
    discs: usize,
    lattice_cell: [f64; 2],
) -> Result<(f64, [f64; 2]), SceneError> {
    let (asked, machine) = (&document.scene.search, &document.scene.machine);
    let by_fast_lists = asked.by == SearchKind::NeighborList && machine.is_fast();
    let skin = match asked.skin {
        Some(skin) if asked.by == SearchKind::NeighborList => skin,
        _ if by_fast_lists => roomy_skin(domain, largest, discs),
        _ => LEAST_SKIN * largest,
    };
    let (reach, key) = match asked.by {
        SearchKind::NeighborList if by_fast_lists => (2.0 * largest + skin, &SKIN),
        SearchKind::Sectors => (2.0 * largest, &SEARCH),
        _ => return Ok((skin, lattice_cell)),
    };
    let single = machine.precision != Precision::F64;
    match sectors_of(seen, reach, single, discs) {
        Ok(grid) => Ok((skin, grid.frame.edge)),
        Err(cause) => {
            let spot =
                if document.values.is_given(key) { document.values.spot(key) } else { box_spot(document) };
            let error = spot.error(MistakeKind::Geometry, cause.to_string());
            Err(error.advising("make the box larger, lower search.skin, or set search.by = \"lattice\""))
        }
    }
}

/// Default skin of the fast lists (length): half of the gap between evenly spread discs, within bounds, and no more than the box allows. Wider skins
/// make longer lists that last longer.
fn roomy_skin(domain: &Domain, largest: f64, discs: usize) -> f64 {
    let area = domain.area() / discs.max(1) as f64;
    // Spacing of neighbours on a hexagonal lattice.
    let spacing = (area * 2.0 / 3f64.sqrt()).sqrt();
    let wanted = (0.5 * (spacing - 2.0 * largest)).clamp(LEAST_SKIN * largest, largest);
    // A periodic side needs three sectors.
    let periodic = (0..2).filter(|&axis| domain.is_periodic(axis));
    let room = periodic.map(|axis| domain.length(axis) / 3.0 - 2.0 * largest).fold(f64::INFINITY, f64::min);
    if room > 0.0 { wanted.min(room * (1.0 - 1e-12)) } else { wanted }
}

fn lattice(
    document: &GranularDocument,
    domain: &Domain,
    bounds: &CellBounds,
) -> Result<(LatticeShape, LatticeFrame, Mask), Vec<SceneError>> {
    let asked = document.scene.search.cell_edge;
    let wanted = asked.unwrap_or(bounds.most());
    let widest = WIDEST * f64::from(bounds.half_width) * bounds.least;
    if let Some(edge) = asked.filter(|&edge| edge > widest) {
        let message = format!(
            "`search.cell_edge` = {edge} is too large: contacts are searched in single precision from the centres of the \
             cells and would be missed in cells wider than {WIDEST} of the largest diameter"
        );
        let error = document.values.spot(&CELL_EDGE).error(MistakeKind::Geometry, message);
        return Err(vec![
            error.expecting(format!("an edge of at most {} (length)", rounded_to_nine_digits(widest))),
        ]);
    }
    if wanted * SLACK < bounds.least || wanted > bounds.most() * SLACK {
        let width = 2 * bounds.half_width + 1;
        let (message, why) = if wanted < bounds.least {
            let reach = rounded_to_nine_digits(f64::from(bounds.half_width) * wanted);
            (
                format!("`search.cell_edge` = {wanted} is too small: a {width}×{width} mask reaches {reach}"),
                format!(
                    "but contacts reach {}",
                    rounded_to_nine_digits(f64::from(bounds.half_width) * bounds.least)
                ),
            )
        } else {
            (
                format!(
                    "`search.cell_edge` = {wanted} is too large: the diagonal of a cell is {}",
                    rounded_to_nine_digits(wanted * std::f64::consts::SQRT_2)
                ),
                format!("but centres may come as close as {}", rounded_to_nine_digits(bounds.diagonal)),
            )
        };
        let error =
            document.values.spot(&CELL_EDGE).error(MistakeKind::Geometry, format!("{message}, {why}"));
        let range = format!(
            "an edge from {} to {} (length)",
            rounded_to_nine_digits(bounds.least),
            rounded_to_nine_digits(bounds.most())
        );
        return Err(vec![error.expecting(range)]);
    }
    // Indices are 32-bit, and beyond 2^53 counting stops.
    if let Some(axis) = (0..2)
        .find(|&axis| domain.length(axis) / bounds.least >= 2f64.powi(32) || !domain.length(axis).is_finite())
    {
        let message = format!(
            "the side along {}, {} long, needs more cells of {} than the 2^32 − 1 that an index can number",
            ["x", "y"][axis],
            significant(domain.length(axis), 6),
            significant(bounds.most(), 6)
        );
        let error = box_spot(document).error(MistakeKind::Geometry, message);
        return Err(vec![error.advising("make the box smaller, or the discs larger")]);
    }
    let axes = [0, 1].map(|axis| cuts(domain.length(axis), domain.is_periodic(axis), bounds, wanted));
    let short: Vec<SceneError> = (0..2)
        .filter(|&axis| axes[axis].is_empty())
        .map(|axis| short_side(document, domain, axis, bounds))
        .collect();
    if !short.is_empty() {
        return Err(short);
    }
    // Prefer the fewest cells, or those nearest to the wanted edge; then the squarest.
    let cost = |x: &AxisCells, y: &AxisCells| match asked {
        None => (x.count * y.count, (x.edge - y.edge).abs()),
        Some(_) => ((x.edge - wanted).abs() + (y.edge - wanted).abs(), x.count * y.count),
    };
    let square = bounds.diagonal * bounds.diagonal * SLACK;
    let pairs = axes[0].iter().flat_map(|x| axes[1].iter().map(move |y| (x, y)));
    let best = pairs
        .filter(|(x, y)| x.edge * x.edge + y.edge * y.edge <= square)
        .min_by(|a, b| cost(a.0, a.1).partial_cmp(&cost(b.0, b.1)).unwrap_or(std::cmp::Ordering::Equal));
    let Some((x, y)) = best else {
        let message = format!(
            "no whole numbers of cells fill the sides {} and {}: a cell must have sides of at least {} and a diagonal \
             of at most {}",
            domain.length(0),
            domain.length(1),
            rounded_to_nine_digits(bounds.least),
            rounded_to_nine_digits(bounds.diagonal)
        );
        let error = box_spot(document).error(MistakeKind::Geometry, message);
        return Err(vec![error.advising("make the box a little larger, or lower law.max_penetration")]);
    };
    let mask = Mask::square(bounds.half_width);
    let shape = LatticeShape::new(x.count as usize, y.count as usize, &mask, domain.periodic())
        .map_err(|cause| vec![box_spot(document).error(MistakeKind::Geometry, cause.to_string())])?;
    Ok((shape, LatticeFrame { origin: domain.corner(), edge: [x.edge, y.edge] }, mask))
}

/// Location of the key that decides the size of the box.
fn box_spot(document: &GranularDocument) -> Spot {
    match document.scene.start {
        DiscStart::Hexagonal { .. } => document.values.spot(&COUNT),
        _ => document.values.spot(&SIDES),
    }
}

fn short_side(document: &GranularDocument, domain: &Domain, axis: usize, bounds: &CellBounds) -> SceneError {
    let (side, name) = (domain.length(axis), ["x", "y"][axis]);
    let needed = 2 * bounds.half_width + 1;
    let fit = (side / bounds.least * SLACK).floor();
    let error = if domain.is_periodic(axis) && fit < f64::from(needed) {
        let message = format!(
            "the periodic side along {name} is {side} long and fits {fit} cells of at least {}; a {needed}×{needed} \
             mask needs {needed} of them, or pairs would be visited twice",
            rounded_to_nine_digits(bounds.least)
        );
        let least = rounded_to_nine_digits(f64::from(needed) * bounds.least);
        box_spot(document)
            .error(MistakeKind::Geometry, message)
            .expecting(format!("a side of at least {least}"))
    } else {
        let message = format!(
            "no whole number of cells fills the side along {name}, {side} long: a cell must be {} to {} long",
            rounded_to_nine_digits(bounds.least),
            rounded_to_nine_digits(bounds.longest())
        );
        box_spot(document).error(MistakeKind::Geometry, message)
    };
    error.advising("make the box larger, or the discs smaller")
}

/// Error of radii that differ too much for every mask, or for the requested one.
fn ratio_error(document: &GranularDocument, radii: [f64; 2]) -> SceneError {
    let scene = &document.scene;
    let [smallest, largest] = radii.map(rounded_to_nine_digits);
    let penetration = scene.law.max_penetration;
    // 2 R_max/h ≤ (1 − p)·2 R_min/√2.
    let limit = |half_width: f64| half_width * (1.0 - penetration) / std::f64::consts::SQRT_2;
    let ratio = radii[1] / radii[0];
    let [five, seven] = [limit(2.0), limit(3.0)];
    let said = format!("the largest radius, {largest}, is {ratio:.4} times the smallest, {smallest}");
    let error = match scene.search.mask {
        Some(7) | None => ratio_spot(document).error(
            MistakeKind::Geometry,
            format!(
                "{said}; at law.max_penetration = {penetration} a 7×7 mask allows {seven:.4}, 5×5 {five:.4}"
            ),
        ),
        Some(_) => document.values.spot(&MASK).error(
            MistakeKind::Geometry,
            format!("{said}; at law.max_penetration = {penetration} a 5×5 mask allows {five:.4}"),
        ),
    };
    let instead = "set search.by = \"sectors\" or \"neighbor-list\"";
    let help = if scene.search.mask == Some(5) && ratio <= seven {
        format!("use mask = 7, which allows {seven:.4}")
    } else if ratio <= limit(3.0) / (1.0 - penetration) {
        let allowed = 1.0 - ratio * std::f64::consts::SQRT_2 / 3.0;
        format!("bring the radii closer together, lower law.max_penetration below {allowed:.4}, or {instead}")
    } else {
        format!("bring the radii closer together, or {instead}")
    };
    error.expecting(format!("a ratio of at most {seven:.4}")).advising(help)
}

fn ratio_spot(document: &GranularDocument) -> Spot {
    let keys: &[&Key] = match &document.scene.start {
        DiscStart::File(_) => &[&FILE],
        DiscStart::List(list) if list.wall_positions.is_empty() => &[&RADII, &RADIUS],
        DiscStart::Random { .. } | DiscStart::Compressed { .. } | DiscStart::Hexagonal { .. } => {
            &[&RADIUS_CUT, &RADIUS_SPREAD, &RADIUS]
        }
        DiscStart::Pipe { grains, .. } | DiscStart::Box { grains, .. } if grains.cut > 0.2 => {
            &[&RADIUS_CUT, &WALL_RADIUS, &RADIUS]
        }
        _ => &[&WALL_RADIUS, &RADII, &RADIUS_CUT, &RADIUS],
    };
    let given = keys.iter().find(|key| document.values.is_given(key)).unwrap_or(&keys[0]);
    document.values.spot(given)
}
