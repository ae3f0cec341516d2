//! Cost of the force sweep over 24 offsets, cell by cell, in every execution, compared with a hand-written loop.
//!
//! The sweep is branch-free, so its cost does not depend on the positions of the discs: a frozen dense configuration suffices.
//! Throughput is in cells; `cargo bench --bench lattice forces`.

use crate::intrinsics::{self, MaskNeighbour, Numbers, Vectors};
use crate::scenery::{CONTACT, dense, programs_of, warm_up};
use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use std::hint::black_box;
use std::time::Duration;
use stripmine_kernels::backend::Precision;
use stripmine_kernels::isa::Array;
use stripmine_kernels::{Execution, InstructionSet};
use stripmine_physics::method::lattice_md::{ContactWatch, GranularModel, Part, ProgramArrays, execute};

fn neighbours<T: Precision>(model: &GranularModel) -> Vec<MaskNeighbour<T>> {
    let neighbour = |offset: &stripmine_kernels::mask::Offset| {
        let displacement =
            [f64::from(offset.columns) * model.frame.edge[0], f64::from(offset.rows) * model.frame.edge[1]];
        (model.shape.shift(*offset), displacement.map(T::from_f64))
    };
    model.mask.offsets().iter().map(neighbour).collect()
}

/// Runs the hand-written loop on the widest instruction set that it and this processor support.
trait ByHand: Precision {
    fn sweep<const FRICTION: bool>(
        from: &Vectors<'_, Self>,
        to: [&mut [Self]; 3],
        range: std::ops::Range<usize>,
        neighbours: &[MaskNeighbour<Self>],
        numbers: Numbers<Self>,
    ) -> bool;
}

macro_rules! by_hand {
    ($ty:ident, $avx2:ident, $avx512:ident) => {
        impl ByHand for $ty {
            #[allow(unused_variables, reason = "other processors have no hand-written loop")]
            fn sweep<const FRICTION: bool>(
                from: &Vectors<'_, Self>,
                to: [&mut [Self]; 3],
                range: std::ops::Range<usize>,
                neighbours: &[MaskNeighbour<Self>],
                numbers: Numbers<Self>,
            ) -> bool {
                match InstructionSet::best() {
                    // SAFETY: the processor has the set; the lattice is padded for every shift of its mask.
                    #[cfg(target_arch = "x86_64")]
                    InstructionSet::Avx512 => unsafe {
                        intrinsics::$avx512::<FRICTION>(from, to, range, neighbours, numbers);
                    },
                    // SAFETY: as above.
                    #[cfg(target_arch = "x86_64")]
                    InstructionSet::Avx2 => unsafe {
                        intrinsics::$avx2::<FRICTION>(from, to, range, neighbours, numbers);
                    },
                    _ => return false,
                }
                true
            }
        }
    };
}
by_hand!(f64, avx2_f64, avx512_f64);
by_hand!(f32, avx2_f32, avx512_f32);

fn hand_written<P: ByHand, const FRICTION: bool>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    model: &GranularModel,
    arrays: &mut ProgramArrays<f64, P>,
) {
    let programs = programs_of::<P>(model);
    {
        let (memory, lengths) = arrays.memory();
        let set = InstructionSet::best();
        execute(&programs, &[Part::Forces], &memory, lengths, Execution::Chained, set).expect("bound");
    }
    let column = |array| arrays.lattice(array).map_or(&[][..], |column| column);
    let from = Vectors {
        x: column(Array::X),
        y: column(Array::Y),
        vx: column(Array::Vx),
        vy: column(Array::Vy),
        omega: column(Array::Omega),
        radius: column(Array::Radius),
        inverse_mass: column(Array::InverseMass),
    };
    let numbers = Numbers {
        stiffness: P::from_f64(CONTACT.stiffness),
        normal_damping: P::from_f64(CONTACT.normal_damping),
        shear_damping: P::from_f64(CONTACT.shear_damping),
        friction: P::from_f64(CONTACT.friction),
    };
    let neighbours = neighbours::<P>(model);
    let mut to = [(); 3].map(|()| vec![P::from_f64(0.0); model.shape.padded()]);
    let range = model.shape.swept();
    let mut sweep = || {
        let [fx, fy, torque] = &mut to;
        P::sweep::<FRICTION>(&from, [fx, fy, torque], range.clone(), &neighbours, numbers)
    };
    if !sweep() {
        return;
    }
    group.bench_function(name, |bencher| bencher.iter(|| black_box(sweep())));
    for (ours, by_hand) in [Array::Fx, Array::Fy].into_iter().zip(&to) {
        let ours = &column(ours)[range.clone()];
        let differing =
            ours.iter().zip(&by_hand[range.clone()]).filter(|(a, b)| a.bits() != b.bits()).count();
        assert_eq!(differing, 0, "the hand-written loop gives other bits");
    }
}

fn executions<P: ByHand>(criterion: &mut Criterion, precision: &str) {
    for (cells, friction) in [(10_000, false), (10_000, true), (100_000, false), (100_000, true)] {
        let (model, particles, mut arrays) = dense::<P>(cells, friction);
        let law = if friction { "friction" } else { "normal" };
        let mut group = criterion.benchmark_group(format!("forces/{precision}/{law}/{cells}"));
        group.throughput(Throughput::Elements(model.shape.cells() as u64));
        group
            .sample_size(20)
            .measurement_time(Duration::from_secs(2))
            .warm_up_time(Duration::from_millis(500));
        if friction {
            hand_written::<P, true>(&mut group, "by hand", &model, &mut arrays);
        } else {
            hand_written::<P, false>(&mut group, "by hand", &model, &mut arrays);
        }
        let programs = programs_of::<P>(&model);
        let best = InstructionSet::best();
        let mut configurations: Vec<(String, Execution, InstructionSet)> = Vec::new();
        configurations.extend(
            InstructionSet::available()
                .map(|set| (format!("chained {}", set.name()), Execution::Chained, set)),
        );
        configurations
            .extend([64, 256, 1024].map(|n| (format!("tape, strips of {n}"), Execution::Strip(n), best)));
        configurations.push(("tape, eager".to_owned(), Execution::Eager, best));
        for (name, execution, set) in configurations {
            let (memory, lengths) = arrays.memory();
            group.bench_function(name, |bencher| {
                bencher.iter(|| execute(&programs, &[Part::Forces], &memory, lengths, execution, set));
            });
        }
        // Cost of a run's checks: the deepest contact is watched in every cell.
        let watch = Some(ContactWatch::new(0.1, 0.3, 0.5));
        let watching = programs_of::<P>(&GranularModel { watch, ..model.clone() });
        let mut arrays = ProgramArrays::<f64, P>::new(&GranularModel { watch, ..model.clone() }, &particles);
        warm_up::<P>(&watching, &mut arrays);
        let (memory, lengths) = arrays.memory();
        group.bench_function(format!("chained {}, with the checks", best.name()), |bencher| {
            bencher.iter(|| execute(&watching, &[Part::Forces], &memory, lengths, Execution::Chained, best));
        });
        group.finish();
    }
}

pub fn forces(criterion: &mut Criterion) {
    executions::<f64>(criterion, "f64");
    executions::<f32>(criterion, "f32");
}
