//! The memory that a run needs, before it is taken.
//!
//! Formulas follow the allocations, term by term: `method/lattice_md/{arrays,neighbor_list}`,
//! `method/pairwise/{state,search}` and the sweeps below them for what a method keeps, `method/pairwise/{observing,saved}`, `observe`
//! and `io/checkpoint` for what comes and goes. What does not grow with the discs or the cells is one number.

use super::assemble::{contacts, model_following_energy};
use super::check::Checked;
use super::options::ProgramText;
use super::{Contacts, Discs, FastSearch, Lengths, Model, Scheme, programs};
use crate::memory::{Foreseen, OfRanks, PROGRAM, available};
use crate::near::Near;
use crate::particles::Particle;
use crate::scene::Precision;
use std::collections::BTreeMap;
use stripmine_kernels::isa::aligned_column::taken as row;
use stripmine_kernels::sweep::fast::lattice::SPARSE;
use stripmine_kernels::sweep::lattice::Coordinates;

/// Bytes of the programs themselves, and of the large page that their short arrays share.
const SHARED: f64 = 3.5e6;
/// Bytes of a scene's disc.
const DISC: f64 = size_of::<Particle>() as f64;

/// The memory that a run of a checked scene takes at most.
pub fn foreseen(checked: &Checked) -> Foreseen {
    let of = Sizes::of(checked);
    let from = if of.model.gravity == [0.0; 2] { 0.0 } else { 16.0 * of.grains };
    let kept = PROGRAM + 2.0 * DISC * of.discs + from + of.followed();
    let near = Near::bytes(checked.particles.len()) as f64;
    let (mut cells, mut rows) = (0.0, 0.0);
    let ([engine, columns], observed) = match contacts(checked) {
        Contacts::Fast(search) => {
            (cells, rows) = (of.cells(search), of.rows(search));
            let [engine, columns] = of.fast(search);
            ([engine + cells, columns], of.observed())
        }
        Contacts::Lattice => {
            let [arrays, columns] = of.programs(false);
            ([arrays + registers(checked, &of.model), columns], (DISC + 16.0) * of.discs + near)
        }
        Contacts::Lists(options) => {
            let [arrays, columns] = of.programs(true);
            ([arrays + of.rival(options.skin), columns], (DISC + 16.0) * of.discs + near)
        }
    };
    let columns = columns + of.followed();
    // One of them is gone before the next comes. While discs are observed or their columns written, a frame of them is written.
    // A run that is gone on with has read one column more than it has taken up, and its cells are looked up; of what it gives back
    // the system does not have a frame's size at once.
    let frame = DISC * of.discs;
    let resumed = columns + frame + (8.0 + 40.0) * of.discs + of.lists_resumed(contacts(checked));
    // Particles as they stand are made one degree of freedom after the other.
    let standing = 2.0 * frame + (2.0 * 8.0 + 4.0) * of.discs;
    let moments = [standing, frame + observed, frame + columns, resumed];
    Foreseen {
        needed: (kept + engine + moments.into_iter().fold(0.0, f64::max)) as u64,
        available: available(),
        what: format!("{} discs in {} cells", checked.particles.len(), checked.geometry.shape.cells()),
        remedy: "take fewer discs, a smaller box or machine.precision = \"f32\"; where most cells are empty, search.by = \
                 \"sectors\" has no lattice",
        ranks: OfRanks::in_bands(of.discs, cells, [rows, of.state * of.discs]),
    }
}

/// What the formulas are of.
struct Sizes {
    model: Model,
    sides: [f64; 2],
    /// Sides of a sector, where there are some (length).
    widest_cell: [f64; 2],
    /// Largest distance of two discs in contact (length).
    reach: f64,
    /// Whether radii differ.
    vary: bool,
    discs: f64,
    grains: f64,
    /// Bytes of a number of the state, and of one of the forces.
    state: f64,
    force: f64,
}

impl Sizes {
    fn of(checked: &Checked) -> Sizes {
        let Checked { scene, domain, particles, .. } = checked;
        let [smallest, largest] = particles.radii().unwrap_or([1.0; 2]);
        let (state, force) = match scene.machine.precision {
            Precision::F64 => (8.0, 8.0),
            Precision::F32 => (4.0, 4.0),
            Precision::Mixed => (8.0, 4.0),
        };
        Sizes {
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

    fn freedoms(&self) -> f64 {
        self.model.freedoms() as f64
    }

    fn varying(&self) -> f64 {
        f64::from(u8::from(self.model.discs == Discs::Varying))
    }

    /// Bytes of the periods that discs cross, where these are followed.
    fn followed(&self) -> f64 {
        if self.model.counts_crossings().contains(&true) { 16.0 * self.discs } else { 0.0 }
    }

    fn friction(&self) -> f64 {
        f64::from(u8::from(self.model.friction))
    }

    /// Others within a distance of a disc, were the discs spread evenly.
    fn neighbours(&self, distance: f64) -> f64 {
        let density = self.discs / (self.sides[0] * self.sides[1]);
        (density * std::f64::consts::PI * distance * distance).min(self.discs)
    }

    /// Bytes that the fast engine takes while discs are observed.
    fn observed(&self) -> f64 {
        let corrected = 2.0 * self.freedoms();
        (8.0 * (corrected + 3.0 + 2.0 * self.varying()) + 4.0) * self.discs
    }

    /// Bytes beside the lists that the fast engine makes once more where a run goes on: their parts before these are joined.
    fn lists_resumed(&self, contacts: Contacts) -> f64 {
        let Contacts::Fast(FastSearch::Lists { skin }) = contacts else { return 0.0 };
        let pairs = 0.5 * self.neighbours(self.reach + skin);
        8.0 * pairs * self.discs
    }

    /// Bytes that a fast method keeps beside its cells, and of the columns of its checkpoints.
    fn fast(&self, search: FastSearch) -> [f64; 2] {
        let derivatives = self.freedoms() * self.carried();
        let [of_state, of_forces] = [self.state, self.force].map(|bytes| row(bytes * self.discs));
        // One of each kind is room for putting discs in order.
        let columns =
            (derivatives + 3.0 * self.varying() + 1.0) * of_state + 8.0 * self.discs + 4.0 * of_forces;
        let mut written = self.state * derivatives + 3.0 * self.force + 2.0 * 8.0;
        let found = match search {
            FastSearch::Lattice(_) => 4.0 * self.discs,
            FastSearch::Sectors => 8.0 * self.discs,
            FastSearch::Lists { skin } => {
                written += 2.0 * self.state;
                let pairs = 0.5 * self.neighbours(self.reach + skin);
                2.0 * of_state + (8.0 + 8.0 * pairs) * self.discs
            }
        };
        [columns + found, written * self.discs]
    }

    /// Rows of the discs that a fast method keeps: the state, the sums, one more of each, and places at which lists were made.
    fn rows(&self, search: FastSearch) -> f64 {
        let lists = if let FastSearch::Lists { .. } = search { 2.0 } else { 0.0 };
        self.freedoms() * self.carried() + 3.0 * self.varying() + 1.0 + 4.0 + lists
    }

    /// Derivatives that are carried from step to step.
    fn carried(&self) -> f64 {
        match self.model.scheme {
            Scheme::Gear(values) => values.count() as f64,
            Scheme::VelocityVerlet => 2.0,
        }
    }

    /// Bytes of what a search of the fast engine keeps of its cells.
    fn cells(&self, search: FastSearch) -> f64 {
        if let FastSearch::Lattice(_) = search {
            let shape = &self.model.shape;
            let padded = shape.padded() as f64;
            let sparse = self.discs < SPARSE * shape.cells() as f64;
            let copies = if sparse { 0.0 } else { 2.0 + f64::from(u8::from(self.vary)) };
            return (1.0 + copies) * row(4.0 * padded) + 0.125 * padded;
        }
        let [columns, rows] = [0, 1].map(|axis| (self.sides[axis] / self.widest_cell[axis]).ceil());
        4.0 * columns * rows
    }

    /// Bytes of the arrays of the programs, and of the columns of their checkpoints.
    fn programs(&self, lists: bool) -> [f64; 2] {
        let Sizes { model, discs, state, force, .. } = self;
        let (varying, friction) = (self.varying(), self.friction());
        let padded = model.shape.padded() as f64;
        let derivatives = self.freedoms() * model.scheme.values() as f64;
        let watched = f64::from(u8::from(model.watch.is_some()));
        let absolute = f64::from(u8::from(model.coordinates == Coordinates::Absolute));
        let power = f64::from(u8::from(model.counts_dissipation()));
        // The printed text has R and M beside the state, and the lattice vector Test.
        let printed = model.text == ProgramText::Printed;
        let test = f64::from(u8::from(printed));
        // Lists keep forces disc by disc, with the numbers of the discs in place of the cells'.
        let (forces, numbers) = if lists { (*discs, 2.0) } else { (padded, 1.0) };
        let of_state = derivatives + varying * (1.0 + friction);
        let kinds = [
            // How many columns of how many elements of how many bytes.
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
        // The cells as they were, where they are asked for.
        let before = if self.state == 4.0 || self.followed() > 0.0 { 4.0 * discs } else { 0.0 };
        let cells = if self.state == 4.0 || self.followed() > 0.0 { 8.0 } else { 0.0 };
        [SHARED + arrays + before + 4.0 * discs, (of_state * state + cells) * discs]
    }

    /// Bytes of the chained neighbour lists beside those arrays.
    fn rival(&self, skin: f64) -> f64 {
        let listed = self.neighbours(self.reach + skin);
        (4.0 + 4.0 * listed + 16.0 + self.varying() * self.force) * self.discs
    }
}

/// Bytes of the vector registers of an execution that writes every result down.
fn registers(checked: &Checked, model: &Model) -> f64 {
    let (machine, particles) = (&checked.scene.machine, &checked.particles);
    let lengths = Lengths::new(model, particles.grain_count(), particles.len());
    let programs = programs(model, machine.precision);
    // Programs of one precision share their registers, which are as many and as long as the largest asks for.
    let mut largest: BTreeMap<&str, [usize; 3]> = BTreeMap::new();
    for step in programs {
        let range = lengths.range(step.length);
        // A set that the processor lacks is refused when the run starts.
        let bytes = step.program.register_bytes(&range, machine.execution, machine.instructions());
        if let Ok((precision, bytes)) = bytes {
            let files = largest.entry(precision).or_default();
            files.iter_mut().zip(bytes).for_each(|(file, bytes)| *file = bytes.max(*file));
        }
    }
    largest.values().flatten().map(|&bytes| row(bytes as f64)).sum()
}
