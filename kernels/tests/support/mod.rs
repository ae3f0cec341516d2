//! A small granular lattice, stepped by the kernels: the system that tests compare between executions.
#![allow(dead_code, reason = "each test file uses its part")]

use rand::RngExt;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::integrator::Inertia;
use stripmine_kernels::integrator::gear::{Acceleration, GearCorrector, GearPredictor, STATE};
use stripmine_kernels::isa::{Array, Memory, ProgramError, Slot};
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::law::{Law, ObservationRequest, ParticleField, ParticleSum};
use stripmine_kernels::mask::Mask;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::fast::lattice::{Codes, Lattice, Occupancy};
use stripmine_kernels::sweep::fast::{self, Finder, RecordEntry, Sweep};
use stripmine_kernels::sweep::lattice::cells::{
    CONFLICTS, CheckIndex, ClearIndex, EnterDiscs, IndexImages, STRAYS,
};
use stripmine_kernels::sweep::lattice::forces::Forces;
use stripmine_kernels::sweep::lattice::vectors::SpreadToLattice;
use stripmine_kernels::sweep::lattice::{Coordinates, LatticeFrame, LatticeShape};
use stripmine_kernels::sweep::pair::{Pair, PairBody};
use stripmine_kernels::{Execution, InstructionSet, Program};

pub const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 100.0,
    normal_damping: 3.0,
    shear_damping: 2.0,
    friction: 0.5,
    cohesionless: true,
    arm: ContactArm::Radius,
};

/// Kind of lattice in a test.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    pub columns: usize,
    pub rows: usize,
    pub half_width: u32,
    pub periodic: [bool; 2],
    pub coordinates: Coordinates,
    pub contact: Contact,
    /// Probability that a cell contains a disc.
    pub fill: f64,
    pub seed: u64,
}

impl Case {
    pub fn new(columns: usize, rows: usize) -> Case {
        Case {
            columns,
            rows,
            half_width: 2,
            periodic: [true, true],
            coordinates: Coordinates::CellRelative,
            contact: CONTACT,
            fill: 0.4,
            seed: 1,
        }
    }
}

/// Discs and lattice, in state precision `S` and force precision `P`.
#[derive(Clone, Debug)]
pub struct System<S, P> {
    pub shape: LatticeShape,
    pub frame: LatticeFrame,
    pub discs: usize,
    pub state: [[Vec<S>; 6]; 3],
    pub inverse_mass: Vec<S>,
    pub inverse_inertia: Vec<S>,
    pub on_lattice: [Vec<P>; 2],
    pub velocity: [Vec<P>; 3],
    pub radius: Vec<P>,
    pub lattice_inverse_mass: Vec<P>,
    pub mass: Vec<P>,
    pub cell: Vec<u32>,
    pub index: Vec<u32>,
    pub lattice: [Vec<P>; 9],
    pub sums: [Vec<P>; 3],
    /// Observations of the lattice's sweep beside the sums: power, energy, virial.
    pub observed: [Vec<P>; 3],
    pub strays: u64,
    pub conflicts: u64,
}

pub const DT: f64 = 1e-3;

/// Lattice vectors of a system, in their order.
pub const LATTICE: [Array; 9] = [
    Array::X,
    Array::Y,
    Array::Vx,
    Array::Vy,
    Array::Omega,
    Array::Radius,
    Array::InverseMass,
    Array::Mass,
    Array::Test,
];

impl<S: Precision, P: Precision> System<S, P> {
    /// Discs of mean radius 1 at random positions, with random velocities and spins.
    pub fn random(case: &Case) -> Self {
        let mask = Mask::square(case.half_width);
        let shape = LatticeShape::new(case.columns, case.rows, &mask, case.periodic).unwrap();
        // Cells as wide as the largest radius for 5×5; smaller for wider masks.
        let edge = 1.1 * 2.0 / f64::from(case.half_width);
        let frame = LatticeFrame { origin: [-3.0, 2.0], edge: [edge, edge * 1.01] };
        let mut random = Stream::new(case.seed, RandomPurpose::Test, 0);
        let mut rows: [[Vec<S>; 6]; 3] = Default::default();
        let mut radius = vec![];
        for row in 0..case.rows {
            for column in 0..case.columns {
                if random.random::<f64>() >= case.fill {
                    continue;
                }
                let mut place = |k: usize, axis: usize| {
                    let inside = 0.02 + 0.96 * random.random::<f64>();
                    frame.origin[axis] + (k as f64 + inside) * frame.edge[axis]
                };
                rows[0][0].push(S::from_f64(place(column, 0)));
                rows[1][0].push(S::from_f64(place(row, 1)));
                rows[2][0].push(S::from_f64(0.0));
                for (freedom, derivatives) in rows.iter_mut().enumerate() {
                    for (k, q) in derivatives.iter_mut().enumerate().skip(1) {
                        let scale = if freedom == 2 { 2.0 } else { 1.0 } * 4f64.powi(1 - k as i32);
                        q.push(S::from_f64(DT.powi(k as i32) * scale * (random.random::<f64>() - 0.5)));
                    }
                }
                radius.push(0.9 + 0.2 * random.random::<f64>());
            }
        }
        let discs = radius.len();
        let mass = |r: &f64| r * r;
        let padded = vec![P::from_f64(0.0); shape.padded()];
        let zeros = vec![P::from_f64(0.0); discs];
        let velocity = |freedom: &[Vec<S>; 6]| {
            freedom[1].iter().map(|q| P::from_f64(q.to_f64() / DT)).collect::<Vec<P>>()
        };
        System {
            velocity: [velocity(&rows[0]), velocity(&rows[1]), velocity(&rows[2])],
            shape,
            frame,
            discs,
            state: rows,
            inverse_mass: radius.iter().map(|r| S::from_f64(1.0 / mass(r))).collect(),
            inverse_inertia: radius.iter().map(|r| S::from_f64(2.0 / (mass(r) * r * r))).collect(),
            on_lattice: [zeros.clone(), zeros],
            radius: radius.iter().map(|&r| P::from_f64(r)).collect(),
            lattice_inverse_mass: radius.iter().map(|r| P::from_f64(1.0 / mass(r))).collect(),
            mass: radius.iter().map(|r| P::from_f64(mass(r))).collect(),
            cell: vec![0; discs],
            index: vec![0; shape.padded()],
            lattice: std::array::from_fn(|_| padded.clone()),
            sums: std::array::from_fn(|_| padded.clone()),
            observed: std::array::from_fn(|_| padded.clone()),
            strays: 0,
            conflicts: 0,
        }
    }

    /// Given discs on a lattice at `frame`; derivatives beyond the velocity are zero.
    pub fn placed(case: &Case, frame: LatticeFrame, discs: &[PairBody]) -> Self {
        let mut system = Self::random(&Case { fill: 0.0, ..*case });
        let column = |of: &dyn Fn(&PairBody) -> f64| discs.iter().map(|disc| P::from_f64(of(disc))).collect();
        let state = |of: &dyn Fn(&PairBody) -> f64| discs.iter().map(|disc| S::from_f64(of(disc))).collect();
        for (axis, row) in system.state.iter_mut().enumerate() {
            for q in row.iter_mut() {
                *q = vec![S::from_f64(0.0); discs.len()];
            }
            let rate = |disc: &PairBody| [disc.velocity[0], disc.velocity[1], disc.omega][axis];
            row[0] = state(&|disc| [disc.position[0], disc.position[1], 0.0][axis]);
            row[1] = state(&|disc| rate(disc) * DT);
            system.velocity[axis] = column(&rate);
        }
        system.frame = frame;
        system.discs = discs.len();
        system.inverse_mass = state(&|disc| disc.inverse_mass);
        system.inverse_inertia = state(&|disc| 2.0 * disc.inverse_mass / (disc.radius * disc.radius));
        system.on_lattice = [column(&|_| 0.0), column(&|_| 0.0)];
        system.radius = column(&|disc| disc.radius);
        system.lattice_inverse_mass = column(&|disc| disc.inverse_mass);
        system.mass = column(&|disc| 1.0 / disc.inverse_mass);
        system.cell = vec![0; discs.len()];
        system
    }

    pub fn memory<R>(
        &mut self,
        halo: &[Vec<u32>; 2],
        constant: &[Vec<P>; 4],
        run: impl FnOnce(&Memory<'_>) -> R,
    ) -> R {
        let mut memory = Memory::new();
        for (arrays, rows) in STATE.into_iter().zip(&mut self.state) {
            for (array, q) in arrays.into_iter().zip(rows) {
                memory = memory.write(Slot::<S>::new(array), q);
            }
        }
        memory = memory.read(Slot::<S>::new(Array::DiscInverseMass), &self.inverse_mass);
        memory = memory.read(Slot::<S>::new(Array::DiscInverseInertia), &self.inverse_inertia);
        let discs = [Array::DiscX, Array::DiscY].into_iter().zip(&mut self.on_lattice);
        let velocities = [Array::DiscVx, Array::DiscVy, Array::DiscOmega].into_iter().zip(&mut self.velocity);
        for (array, column) in discs.chain(velocities) {
            memory = memory.write(Slot::<P>::new(array), column);
        }
        memory = memory.read(Slot::<P>::new(Array::DiscRadius), &self.radius);
        memory = memory.read(Slot::<P>::new(Array::DiscInverseMass), &self.lattice_inverse_mass);
        memory = memory.read(Slot::<P>::new(Array::DiscMass), &self.mass);
        memory = memory.write(Slot::new(Array::DiscCell), &mut self.cell);
        memory = memory.write(Slot::new(Array::Index), &mut self.index);
        memory = memory.read(Slot::new(Array::HaloCell), &halo[0]);
        memory = memory.read(Slot::new(Array::HaloSource), &halo[1]);
        for (array, column) in
            [Array::FarX, Array::Interior, Array::ImageX, Array::ImageY].into_iter().zip(constant)
        {
            memory = memory.read(Slot::<P>::new(array), column);
        }
        for (array, column) in LATTICE.into_iter().zip(&mut self.lattice) {
            memory = memory.write(Slot::<P>::new(array), column);
        }
        for (array, column) in [Array::Fx, Array::Fy, Array::Torque].into_iter().zip(&mut self.sums) {
            memory = memory.write(Slot::<P>::new(array), column);
        }
        let observed = [Array::Power, Array::Energy, Array::Virial].into_iter().zip(&mut self.observed);
        for (array, column) in observed {
            memory = memory.write(Slot::<P>::new(array), column);
        }
        let result = run(&memory);
        let counted = [memory.counted(STRAYS), memory.counted(CONFLICTS)];
        self.strays += counted[0];
        self.conflicts += counted[1];
        result
    }

    /// Halo cells with the cells they repeat, and the constant lattice vectors: far, interior, displacements of images.
    pub fn constants(&self) -> ([Vec<u32>; 2], [Vec<P>; 4]) {
        let shape = self.shape;
        let images = shape.images();
        let halo = [
            images.iter().map(|image| image.cell as u32 + 1).collect(),
            images.iter().map(|image| image.source as u32 + 1).collect(),
        ];
        let mut shift = [vec![P::from_f64(0.0); shape.padded()], vec![P::from_f64(0.0); shape.padded()]];
        for image in &images {
            for axis in 0..2 {
                let period = [shape.columns(), shape.rows()][axis] as f64 * self.frame.edge[axis];
                shift[axis][image.cell] = P::from_f64(f64::from(image.periods[axis]) * period);
            }
        }
        let [x, y] = shift;
        (halo, [shape.far(self.frame), shape.interior(), x, y])
    }

    /// Updates Index and lattice vectors from the current positions.
    pub fn index<L: Law<2>>(&mut self, case: &Case, _: &L, how: (Execution, InstructionSet)) {
        let (halo, constant) = self.constants();
        let (shape, frame, discs, images) = (self.shape, self.frame, self.discs, halo[0].len());
        self.memory(&halo, &constant, |memory| {
            let (execution, set) = how;
            Program::new(ClearIndex).run(memory, 0..shape.padded(), execution, set).unwrap();
            let enter = EnterDiscs::<S, P>::new(shape, frame, case.coordinates);
            Program::new(enter).run(memory, 0..discs, execution, set).unwrap();
            Program::new(CheckIndex).run(memory, 0..discs, execution, set).unwrap();
            Program::new(IndexImages).run(memory, 0..images, execution, set).unwrap();
            let spread = SpreadToLattice::<P>::new(shape, case.coordinates, L::FIELDS);
            Program::new(spread).run(memory, 0..shape.padded(), execution, set).unwrap();
        });
    }

    /// Computes forces from the current lattice vectors.
    pub fn forces<L: Law<2>>(
        &mut self,
        case: &Case,
        law: &L,
        how: (Execution, InstructionSet),
    ) -> Result<(), ProgramError> {
        self.forces_and(case, law, how, ObservationRequest::default())
    }

    /// Computes forces and the requested observations, which are stored in [`observed`](Self::observed).
    pub fn forces_and<L: Law<2>>(
        &mut self,
        case: &Case,
        law: &L,
        (execution, set): (Execution, InstructionSet),
        asked: ObservationRequest,
    ) -> Result<(), ProgramError> {
        let mask = Mask::square(case.half_width);
        let shape = self.shape;
        let forces = Forces::<P, L>::new(law.clone(), &mask, shape, self.frame, case.coordinates);
        let program = Program::new(forces.asked(asked));
        self.memory(&Default::default(), &Default::default(), |memory| {
            program.run(memory, shape.swept(), execution, set)
        })
    }

    /// Forces and torques on the discs from the fast sweep, which numbers disc `order[n]` as n; the system is not changed.
    pub fn fast_forces<L: Law<2> + Sync>(
        &self,
        law: &L,
        order: &[u32],
        set: InstructionSet,
    ) -> Result<(Vec<[P; 3]>, fast::SweepReport), ProgramError> {
        let mut occupancy = Occupancy::new(
            self.shape,
            self.frame,
            self.discs,
            2.2,
            L::FIELDS.contains(&ParticleField::Radius),
        );
        let mut places = [vec![S::default(); self.discs], vec![S::default(); self.discs]];
        for (n, &disc) in order.iter().enumerate() {
            let disc = disc as usize;
            let mut cell = [0; 2];
            for axis in 0..2 {
                let (origin, edge) = (self.frame.origin[axis], self.frame.edge[axis]);
                let along = self.state[axis][0][disc].to_f64() - origin;
                cell[axis] = (along / edge) as usize;
                places[axis][disc] = S::from_f64(along - (cell[axis] as f64 + 0.5) * edge);
            }
            let place = [places[0][disc].to_f64(), places[1][disc].to_f64()];
            occupancy.enter(n, cell, place, self.radius[disc].to_f64()).unwrap();
        }
        occupancy.repeat_images();
        let mut records = fast::StateRecords::zeros(0, self.discs, [true, true], 1.0);
        let mut fill = |entry: RecordEntry, column: &(dyn Fn(usize) -> f64 + Sync), sentinel: f64| {
            let value = |disc: usize| order.get(disc).map_or(sentinel, |&number| column(number as usize));
            records.fill(entry, |disc| S::from_f64(value(disc)));
        };
        for (axis, along) in places.iter().enumerate() {
            fill(RecordEntry::of(axis, 0), &|disc| along[disc].to_f64(), 0.0);
            fill(RecordEntry::of(axis, 1), &|disc| self.velocity[axis][disc].to_f64(), 1.0);
        }
        fill(RecordEntry::Omega, &|disc| self.velocity[2][disc].to_f64(), 1.0);
        fill(RecordEntry::Radius, &|disc| self.radius[disc].to_f64(), 1.0);
        fill(RecordEntry::InverseMass, &|disc| self.lattice_inverse_mass[disc].to_f64(), 1.0);
        // The sentinels are far apart.
        records.set(RecordEntry::X, self.discs, S::from_f64(100.0));
        let mut sums = fast::ForceRecords::<P>::zeros(0, self.discs);
        let codes = Codes::new(&occupancy, self.frame);
        let lattice = Lattice { occupancy: &occupancy, codes: &codes, slack: 0.0 };
        let mut sweep = Sweep::new(Finder::<S, P>::rows(&lattice));
        let asked = ObservationRequest { watched: Some(0.1), dissipation: true, energy: true };
        let met = sweep.run(law, &lattice, &records, &mut sums, asked, set)?;
        let mut forces = vec![[P::default(); 3]; self.discs];
        for (n, &disc) in order.iter().enumerate() {
            forces[disc as usize] = sums.of(n);
        }
        Ok((forces, met))
    }

    /// Runs one whole step of the method of BP93.
    pub fn step<L: Law<2>, const VALUES: usize, const FREEDOMS: usize>(
        &mut self,
        case: &Case,
        law: &L,
        inertia: Inertia,
        how: (Execution, InstructionSet),
    ) {
        let none = [vec![], vec![], vec![], vec![]];
        let discs = self.discs;
        self.memory(&Default::default(), &none, |memory| {
            let predictor = GearPredictor::<S, P, VALUES, FREEDOMS>::new(DT);
            Program::new(predictor).run(memory, 0..discs, how.0, how.1).unwrap();
        });
        self.index(case, law, how);
        self.forces(case, law, how).unwrap();
        self.memory(&Default::default(), &none, |memory| {
            let corrector = GearCorrector::<S, P, VALUES, FREEDOMS>::new(
                DT,
                Acceleration::OfVelocities,
                inertia,
                [0.0, -9.81],
            );
            Program::new(corrector).run(memory, 0..discs, how.0, how.1).unwrap();
        });
    }

    /// Bits of all results of a step.
    pub fn bits(&self) -> Vec<u64> {
        let state = self.state.iter().flatten().flatten().map(|x| x.bits());
        let disc = self.on_lattice.iter().chain(&self.velocity).flatten().map(|x| x.bits());
        let lattice = self.lattice.iter().chain(&self.sums).flatten().map(|x| x.bits());
        let index = self.cell.iter().chain(&self.index).map(|&number| u64::from(number));
        state.chain(disc).chain(lattice).chain(index).chain([self.strays, self.conflicts]).collect()
    }

    /// Force or torque on each disc, gathered from the lattice.
    pub fn on_discs(&self, sum: ParticleSum) -> Vec<f64> {
        self.cell
            .iter()
            .map(
                |&cell| {
                    if cell == 0 { 0.0 } else { self.sums[sum.column::<2>()][cell as usize - 1].to_f64() }
                },
            )
            .collect()
    }
}

pub fn varying<const FRICTION: bool>(contact: Contact) -> Granular<FRICTION, false> {
    Granular { contact, disc: EqualDiscs { radius: f64::NAN, inverse_mass: f64::NAN } }
}

pub fn equal<const FRICTION: bool>(contact: Contact) -> Granular<FRICTION, true> {
    Granular { contact, disc: EqualDiscs { radius: 1.0, inverse_mass: 1.0 } }
}

/// Options of the law that change forces: clamped or not, and the arms.
pub fn contacts() -> impl Iterator<Item = Contact> {
    [true, false].into_iter().flat_map(|cohesionless| {
        [ContactArm::Radius, ContactArm::Overlap, ContactArm::Lammps].map(|arm| Contact {
            cohesionless,
            arm,
            ..CONTACT
        })
    })
}

/// Random pairs in contact.
pub fn random_pairs(seed: u64, count: usize) -> impl Iterator<Item = Pair> {
    let mut random = Stream::new(seed, RandomPurpose::Test, 0);
    (0..count).map(move |_| Pair::random(&mut random))
}

/// Every execution of kernels, on every instruction set of this processor.
pub fn all_configurations() -> Vec<(Execution, InstructionSet)> {
    let executions =
        [Execution::Chained, Execution::Eager].into_iter().chain([1, 7, 16, 64, 1000].map(Execution::Strip));
    let sets: Vec<_> = InstructionSet::available().collect();
    executions.flat_map(|execution| sets.iter().map(move |&set| (execution, set))).collect()
}
