//! Cost of finding the contacts, without evaluating the law: on the lattice, and in sectors.
//!
//! Nothing moves here, but the configurations are of a large gas that has moved: their branches cannot be predicted. Throughput
//! is in discs; `cargo bench --bench lattice search`.

use crate::phases::{EQUILIBRATION, advance, scene};
use criterion::{Criterion, Throughput};
use std::hint::black_box;
use std::time::Duration;
use stripmine_kernels::InstructionSet;
use stripmine_kernels::sweep::fast::lattice::{Codes, Lattice, Occupancy};
use stripmine_kernels::sweep::fast::{CellGrid, Finder, RecordEntry, SearchCursor, Sectors, StateRecords};
use stripmine_physics::method::lattice_md::{assemble, model};
use stripmine_physics::particles::Particles;

/// Cells and records of the discs, in the order of the cells.
fn settled(particles: &Particles, grid: &CellGrid) -> (Vec<[usize; 2]>, StateRecords<f64>) {
    let mut discs: Vec<([usize; 2], [f64; 2])> = particles
        .all()
        .iter()
        .map(|disc| {
            let along = [0, 1].map(|axis| disc.position[axis] - grid.frame.origin[axis]);
            let cell = [0, 1]
                .map(|axis| ((along[axis] / grid.frame.edge[axis]) as usize).min(grid.counts[axis] - 1));
            (cell, [0, 1].map(|axis| along[axis] - (cell[axis] as f64 + 0.5) * grid.frame.edge[axis]))
        })
        .collect();
    discs.sort_by_key(|(cell, _)| (cell[1], cell[0]));
    let mut records = StateRecords::zeros(0, discs.len(), [false; 2], 1.0);
    for axis in 0..2 {
        records.fill(RecordEntry::of(axis, 0), |disc| discs.get(disc).map_or(0.0, |disc| disc.1[axis]));
    }
    (discs.iter().map(|disc| disc.0).collect(), records)
}

fn all<F: Finder<f64, f64>>(finder: &F, discs: &StateRecords<f64>, found: &mut F::Found) {
    let (rows, mut cursor) = (finder.rows().count, SearchCursor::at(0));
    while cursor.row() < rows {
        finder.find(discs, 0..rows, &mut cursor, found, InstructionSet::best()).expect("available");
        black_box(&*found);
    }
}

pub fn search(criterion: &mut Criterion) {
    for packing_fraction in [0.84, 0.3, 0.03] {
        let scene = scene(packing_fraction, 100_000, "f64");
        let mut gas = assemble(&scene).expect("a start without conflicts");
        advance(&mut gas, EQUILIBRATION);
        let (model, particles) = (model(&scene), gas.particles());
        let count = particles.len();

        let mut occupancy = Occupancy::new(model.shape, model.frame, count, 1.0, false);
        let (cells, records) = settled(&particles, &occupancy.grid());
        for (disc, &cell) in cells.iter().enumerate() {
            occupancy.enter(disc, cell, records.position(disc), 0.5).expect("one disc a cell");
        }
        occupancy.repeat_images();
        let codes = Codes::<f64>::new(&occupancy, model.frame);
        let lattice = Lattice { occupancy: &occupancy, codes: &codes, slack: 0.0 };

        let domain = model.domain();
        let grid =
            CellGrid::new(domain.corner(), domain.lengths(), domain.periodic(), 1.0, f64::INFINITY, count)
                .expect("a large box");
        let mut sectors = Sectors::new(grid, count, 1.0);
        let (in_sectors, of_sectors) = settled(&particles, &grid);
        in_sectors.iter().enumerate().for_each(|(disc, &cell)| sectors.enter(disc, cell));
        sectors.arrange(|disc| disc);

        let mut group = criterion.benchmark_group(format!("search/{packing_fraction}/100000"));
        group.throughput(Throughput::Elements(count as u64)).sample_size(10);
        group.measurement_time(Duration::from_millis(500)).warm_up_time(Duration::from_millis(100));
        group.bench_function("lattice", |bencher| {
            let mut found = Default::default();
            bencher.iter(|| all(&lattice, &records, &mut found));
        });
        group.bench_function("sectors", |bencher| {
            let mut found = Default::default();
            bencher.iter(|| all(&sectors, &of_sectors, &mut found));
        });
        group.finish();
    }
}
