//! Memory estimate of a run, made before allocation.
//!
//! Formulas follow the allocations term by term. Permanent data: `method/lattice_md/{arrays,neighbor_list}`, `method/pairwise/{state,search}` and the
//! sweeps below them. Temporary data: `method/pairwise/{observing,saved}`, `observe` and `io/checkpoint`. Everything independent of the numbers of
//! discs and cells is one constant.

use super::assemble::{contacts, model_following_energy};
use super::check::CheckedGranularScene;
use super::options::ProgramVersion;
use super::{ContactSearch, DiscUniformity, FastSearch, GranularModel, GranularScheme, Lengths, programs};
use crate::memory::{MemoryForecast, PROGRAM, RankMemory, available};
use crate::method::pairwise::StateSize;
use crate::near::NeighbourSearch;
use crate::particles::Particle;
use crate::scene::Precision;
use std::collections::BTreeMap;
use stripmine_kernels::isa::aligned_column::column_memory as row;
use stripmine_kernels::ledger::VectorLength;
use stripmine_kernels::sweep::fast::lattice::SPARSE;
use stripmine_kernels::sweep::lattice::Coordinates;
use stripmine_kernels::sweep::walls::ELEMENT_NUMBERS;

/// Bytes of the programs themselves, and of the large page that their short arrays share.
const SHARED: f64 = 3.5e6;
/// Bytes of a disc in a scene.
const DISC: f64 = size_of::<Particle>() as f64;

/// Returns the peak memory of a run of a checked scene.
pub fn foreseen(checked: &CheckedGranularScene) -> MemoryForecast {
    let of = GranularSizes::of(checked);
    let from = if of.model.gravity == [0.0; 2] { 0.0 } else { 16.0 * of.grains };
    let kept = PROGRAM + 2.0 * DISC * of.discs + from + of.followed() + of.walls(checked);
    let near = NeighbourSearch::bytes(checked.particles.len()) as f64;
    let (mut cells, mut rows) = (0.0, [0.0; 2]);
    let ([engine, columns], observed) = match contacts(checked) {
        ContactSearch::Fast(search) => {
            (cells, rows) = (of.cells(search), of.rows(search));
            let [engine, columns] = of.fast(search);
            ([engine + cells, columns], of.observed())
        }
        ContactSearch::Lattice => {
            let [arrays, columns] = of.programs(false);
            ([arrays + registers(checked, &of.model), columns], (DISC + 16.0) * of.discs + near)
        }
        ContactSearch::Lists(options) => {
            let [arrays, columns] = of.programs(true);
            ([arrays + of.neighbour_list_bytes(options.skin), columns], (DISC + 16.0) * of.discs + near)
        }
    };
    let columns = columns + of.followed();
    // Only one of the temporary allocations exists at a time. While discs are observed or their columns written, a frame of them is written. A
    // resumed run has read one column more than it has restored, and its cells are searched; the system does not reclaim a frame's size at once.
    let frame = DISC * of.discs;
    let resumed = columns + frame + (8.0 + 40.0) * of.discs + of.lists_resumed(contacts(checked));
    // Particles are copied while the frame before is written; beside them are the indices in memory.
    let standing = 2.0 * frame + 4.0 * of.discs;
    let moments = [standing, frame + observed, frame + columns, resumed];
    MemoryForecast {
        needed: (kept + engine + moments.into_iter().fold(0.0, f64::max)) as u64,
        available: available(),
        what: format!("{} discs in {} cells", checked.particles.len(), checked.geometry.shape.cells()),
        remedy: "use fewer discs, a smaller box or machine.precision = \"f32\"; where most cells are empty, search.by = \
                 \"sectors\" needs no lattice",
        ranks: RankMemory::in_bands(of.discs, cells, rows),
    }
}

/// Sizes that the formulas use.
struct GranularSizes {
    model: GranularModel,
    sides: [f64; 2],
    /// Sides of a sector, if any (length).
    widest_cell: [f64; 2],
    /// Largest distance of two discs in contact (length).
    reach: f64,
    /// True if radii differ.
    vary: bool,
    discs: f64,
    grains: f64,
    /// Bytes of a number of the state, and of a number of the forces.
    state: f64,
    force: f64,
}

impl GranularSizes {
    fn of(checked: &CheckedGranularScene) -> GranularSizes {
        let CheckedGranularScene { scene, domain, particles, .. } = checked;
        let [smallest, largest] = particles.radii().unwrap_or([1.0; 2]);
        let (state, force) = match scene.machine.precision {
            Precision::F64 => (8.0, 8.0),
            Precision::F32 => (4.0, 4.0),
            Precision::Mixed => (8.0, 4.0),
        };
        GranularSizes {
            model: model_following_energy(checked),
            sides: domain.lengths(),
            widest_cell: checked.geometry.widest_cell,
            reach: 2.0 * largest,
            vary: smallest != largest,
            discs: particles.len() as f64,
            grains: particles.grain_count() as f64,
            state,
            force,
        }
    }

    /// Bytes of the elements of plane walls with their index of cells, and of the positions that lines compare.
    fn walls(&self, checked: &CheckedGranularScene) -> f64 {
        let lines = if self.model.lines.is_empty() { 0.0 } else { 32.0 * self.grains };
        if self.model.walls.is_empty() {
            return lines;
        }
        let count = checked.particles.len();
        let elements = Lengths::new(&self.model, count, count).range(VectorLength::WallElements).len();
        let element = ELEMENT_NUMBERS as f64 * self.force + 16.0;
        lines + 4.0 * self.model.shape.cells() as f64 + element * elements as f64
    }

    fn freedoms(&self) -> f64 {
        self.model.freedoms() as f64
    }

    fn varying(&self) -> f64 {
        f64::from(u8::from(self.model.discs == DiscUniformity::Varying))
    }

    /// Bytes of the crossed periods, if they are counted.
    fn followed(&self) -> f64 {
        if self.model.counts_crossings().contains(&true) { 16.0 * self.discs } else { 0.0 }
    }

    fn friction(&self) -> f64 {
        f64::from(u8::from(self.model.friction))
    }

    /// Mean number of discs within a distance of a disc at uniform density.
    fn neighbours(&self, distance: f64) -> f64 {
        let density = self.discs / (self.sides[0] * self.sides[1]);
        (density * std::f64::consts::PI * distance * distance).min(self.discs)
    }

    /// Bytes that the fast engine allocates while discs are observed.
    fn observed(&self) -> f64 {
        // Records of the corrected discs, their sums, and numbers.
        let record = if self.varying() == 1.0 { 8.0 } else { 2.0 * self.freedoms() };
        (8.0 * (record + 4.0) + 4.0) * self.discs
    }

    /// Bytes of the temporary parts of the lists that the fast engine rebuilds when a run resumes.
    fn lists_resumed(&self, contacts: ContactSearch) -> f64 {
        let ContactSearch::Fast(FastSearch::Lists { skin }) = contacts else { return 0.0 };
        let pairs = 0.5 * self.neighbours(self.reach + skin);
        8.0 * pairs * self.discs
    }

    /// Bytes of a fast method beside its cells, and of the columns of its checkpoints.
    fn fast(&self, search: FastSearch) -> [f64; 2] {
        let derivatives = self.freedoms() * self.carried();
        let columns = self.state_size().bytes() + 8.0 * self.discs;
        let mut written = self.state * derivatives + 3.0 * self.force + 2.0 * 8.0;
        let found = match search {
            FastSearch::Lattice(_) => 4.0 * self.discs,
            FastSearch::Sectors => 8.0 * self.discs,
            FastSearch::Lists { skin } => {
                written += 2.0 * self.state;
                let pairs = 0.5 * self.neighbours(self.reach + skin);
                2.0 * row(self.state * self.discs) + (8.0 + 8.0 * pairs) * self.discs
            }
        };
        [columns + found, written * self.discs]
    }

    fn state_size(&self) -> StateSize {
        StateSize {
            discs: self.discs,
            freedoms: self.freedoms(),
            vary: self.model.discs == DiscUniformity::Varying,
            carried: self.carried(),
            number: [self.state, self.force],
        }
    }

    /// Rows of the discs in a fast method, and the bytes of each: the state, the sums, scratch space, and the positions at which lists were built.
    fn rows(&self, search: FastSearch) -> [f64; 2] {
        let [rows, bytes] = self.state_size().rows();
        let lists = if let FastSearch::Lists { .. } = search { 2.0 * self.state * self.discs } else { 0.0 };
        [rows + lists / bytes, bytes]
    }

    /// Number of derivatives carried from step to step.
    fn carried(&self) -> f64 {
        match self.model.scheme {
            GranularScheme::Gear(values) => values.count() as f64,
            GranularScheme::VelocityVerlet => 2.0,
        }
    }

    /// Bytes of the cells of a fast search.
    fn cells(&self, search: FastSearch) -> f64 {
        if let FastSearch::Lattice(_) = search {
            let shape = &self.model.shape;
            let padded = shape.padded() as f64;
            let sparse = self.discs < SPARSE * shape.cells() as f64;
            let copies = if sparse { 0.0 } else { 1.0 + f64::from(u8::from(self.vary)) };
            return (1.0 + copies) * row(4.0 * padded) + 0.125 * padded;
        }
        let [columns, rows] = [0, 1].map(|axis| (self.sides[axis] / self.widest_cell[axis]).ceil());
        4.0 * columns * rows
    }

    /// Bytes of the arrays of the programs, and of the columns of their checkpoints.
    fn programs(&self, lists: bool) -> [f64; 2] {
        let GranularSizes { model, discs, state, force, .. } = self;
        let (varying, friction) = (self.varying(), self.friction());
        let padded = model.shape.padded() as f64;
        let derivatives = self.freedoms() * model.scheme.values() as f64;
        let watched = f64::from(u8::from(model.watch.is_some()));
        let absolute = f64::from(u8::from(model.coordinates == Coordinates::Absolute));
        let power = f64::from(u8::from(model.counts_dissipation()));
        // The printed programs have R and M beside the state, and the lattice vector Test.
        let printed = model.text == ProgramVersion::Printed;
        let test = f64::from(u8::from(printed));
        // Lists store forces by disc, with the numbers of the discs instead of those of the cells.
        let (forces, numbers) = if lists { (*discs, 2.0) } else { (padded, 1.0) };
        let of_state = derivatives + varying * (1.0 + friction);
        let kinds = [
            // Columns, elements of each, bytes of each element.
            (of_state, *discs, *state),
            (if printed { 2.0 } else { 4.0 + friction + 2.0 * varying }, *discs, *force),
            (
                1.0 + 2.0 * absolute + 4.0 + friction + 2.0 * varying + 2.0 * watched + power + test,
                padded,
                *force,
            ),
            (2.0 + friction, forces, *force),
            (numbers, *discs, 4.0),
            (1.0, padded, 4.0),
        ];
        let arrays: f64 =
            kinds.iter().map(|(columns, elements, bytes)| columns * row(elements * bytes)).sum();
        // Previous cells, if they are needed.
        let before = if self.state == 4.0 || self.followed() > 0.0 { 4.0 * discs } else { 0.0 };
        let cells = if self.state == 4.0 || self.followed() > 0.0 { 8.0 } else { 0.0 };
        [SHARED + arrays + before + 4.0 * discs, (of_state * state + cells) * discs]
    }

    /// Bytes of the chained neighbour lists beside those arrays.
    fn neighbour_list_bytes(&self, skin: f64) -> f64 {
        let listed = self.neighbours(self.reach + skin);
        (4.0 + 4.0 * listed + 16.0 + self.varying() * self.force) * self.discs
    }
}

/// Bytes of the vector registers of an execution that stores every result.
fn registers(checked: &CheckedGranularScene, model: &GranularModel) -> f64 {
    let (machine, particles) = (&checked.scene.machine, &checked.particles);
    let lengths = Lengths::new(model, particles.grain_count(), particles.len());
    let programs = programs(model, machine.precision);
    // Programs of one precision share their registers, whose number and length are the largest required.
    let mut largest: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for step in programs {
        let range = lengths.range(step.length);
        // Instruction sets missing on this processor are rejected when the run starts.
        let bytes = step.program.register_bytes(&range, machine.execution, machine.instructions());
        if let Ok((precision, bytes)) = bytes {
            let files = largest.entry(precision).or_default();
            files.iter_mut().zip(bytes).for_each(|(file, bytes)| *file = bytes.max(*file));
        }
    }
    largest.values().flatten().map(|&bytes| row(bytes as f64)).sum()
}
