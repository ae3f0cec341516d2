//! Functions by species: naive sums in boxes of every kind, sum rules, values by hand, runs, refusals.

use super::{disc, ideal, ideal_in_channel, ideal_of, rows, stripmine, values};
use rand::RngExt;
use std::fs;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::domain::Domain;
use stripmine_physics::particles::{Particle, ParticleKind, Particles};
use stripmine_physics::structure::{MotionHistory, StructureSetting, pair_counts_of_all};

/// Gives every third disc the second species, and returns the box of all.
fn in_two_species((setting, mut discs): (StructureSetting, Particles)) -> (StructureSetting, Particles) {
    let count = discs.grain_count();
    for (number, disc) in discs.all_mut()[..count].iter_mut().enumerate() {
        disc.species = u8::from(number % 3 == 0);
    }
    (StructureSetting::new(setting.domain, &discs), discs)
}

/// Grains of a species.
fn members(discs: &Particles, species: u8) -> Vec<Particle> {
    discs.grains().iter().filter(|disc| disc.species == species).copied().collect()
}

/// In every box partial functions are those of naive sums over the discs of each species, and add up to the function of all discs: g by numbers of
/// pairs, S by √(N_a N_b), neighbours by numbers of discs.
#[test]
fn partial_functions_match_naive_sums() {
    let mut random = Stream::new(9, RandomPurpose::Test, 0);
    let mixture: Vec<f64> = [vec![0.25; 60], vec![3.0; 6]].concat();
    for (which, (setting, discs)) in [
        ("square", ideal(&mut random, [20.0, 20.0], [true; 2], 150)),
        ("4 × 60", ideal(&mut random, [4.0, 60.0], [true; 2], 90)),
        ("far rows", ideal(&mut random, [60.0, 30.0], [true; 2], 40)),
        ("half closed", ideal(&mut random, [7.0, 30.0], [false, true], 100)),
        ("closed", ideal(&mut random, [20.0, 14.0], [false; 2], 100)),
        ("mixture 1:12", ideal_of(&mut random, [40.0, 30.0], [true; 2], &mixture)),
        ("5 particles", ideal(&mut random, [9.0, 9.0], [true; 2], 5)),
        ("channel", ideal_in_channel(&mut random)),
    ]
    .map(|(which, made)| (which, in_two_species(made)))
    {
        let [a, b] = [0, 1].map(|species| members(&discs, species));
        let counts = |discs: &[Particle]| pair_counts_of_all(&setting, discs);
        let [of_a, of_b, of_all] = [counts(&a), counts(&b), counts(discs.grains())];
        let bins = of_all.len();
        let g = values("g_ab(r)", &setting, &discs);
        assert_eq!(g.len(), 3 * bins, "{which}");
        let (first, second) = (a.len() as f64, b.len() as f64);
        if setting.domain.periodic() == [true; 2] {
            let width = setting.diameter / 50.0;
            for bin in 0..bins {
                let ring = std::f64::consts::PI * width * width * (2 * bin + 1) as f64;
                let chance = ring / setting.domain.area();
                let of_both = of_all[bin] - of_a[bin] - of_b[bin];
                let pairs = [0.5 * first * (first - 1.0), first * second, 0.5 * second * (second - 1.0)];
                for (pair, count) in [of_a[bin], of_both, of_b[bin]].into_iter().enumerate() {
                    let naive = count as f64 / (pairs[pair] * chance);
                    let found = g[pair * bins + bin];
                    assert!((found - naive).abs() < 1e-9 * naive.max(1.0), "{which} {bin}: {found} {naive}");
                }
            }
        }
        let positive = |pair: usize| g[pair * bins..(pair + 1) * bins].iter().filter(|g| **g > 0.0).count();
        let there = |counts: &[u64]| counts.iter().filter(|count| **count > 0).count();
        assert_eq!([positive(0), positive(2)], [there(&of_a), there(&of_b)], "{which}");
        let coordination = values("coordination_ab", &setting, &discs);
        for (own, species) in [&a, &b].into_iter().enumerate() {
            for (other, partners) in [&a, &b].into_iter().enumerate() {
                let touch = |one: &Particle, two: &Particle| {
                    let apart = setting.domain.distance(one.planar_position(), two.planar_position());
                    one.id != two.id && apart < 1.5 * (one.radius + two.radius)
                };
                let naive = species.iter().map(|one| partners.iter().filter(|two| touch(one, two)).count());
                let naive = naive.sum::<usize>() as f64 / species.len() as f64;
                let found = coordination[2 * own + other];
                assert!((found - naive).abs() < 1e-12, "{which}: {found} {naive}");
            }
        }
        if setting.domain.periodic() == [false; 2] {
            continue;
        }
        let (partial, whole) = (values("S_ab(k)", &setting, &discs), values("S(k)", &setting, &discs));
        assert_eq!(partial.len(), 3 * whole.len(), "{which}");
        for (wave, whole) in whole.iter().enumerate() {
            let [aa, ab, bb] = [0, 1, 2].map(|pair| partial[pair * (partial.len() / 3) + wave]);
            let sum = first * aa + 2.0 * (first * second).sqrt() * ab + second * bb;
            assert!(
                (sum / (first + second) - whole).abs() < 1e-11 * whole.max(1.0),
                "{which}: {sum} {whole}"
            );
        }
        let [of_a, of_b] = [&a, &b].map(|own| values("S(k)", &setting, &Particles::new(own.clone())));
        let near = |found: &[f64], alone: &[f64]| {
            found.iter().zip(alone).all(|(found, alone)| (found - alone).abs() < 1e-9)
        };
        assert!(near(&partial[..whole.len()], &of_a) && near(&partial[2 * whole.len()..], &of_b), "{which}");
    }
}

/// Ideal gases of two species, between closed sides and between wall discs, of one size and of two, have g_ab = 1 in the mean of many.
#[test]
fn partial_correlations_of_ideal_gases_are_one() {
    let mixture: Vec<f64> = (0..120).map(|disc| if disc % 3 == 0 { 1.2 } else { 0.4 }).collect();
    for which in ["periodic", "closed", "closed mixture", "channel"] {
        let mut random = Stream::new(10, RandomPurpose::Test, 0);
        let mut means: Vec<f64> = vec![];
        // Tables between wall discs take long.
        let (many, most) = if which == "channel" { (20, 0.08) } else { (200, 0.02) };
        for _ in 0..many {
            let (setting, discs) = in_two_species(match which {
                "periodic" => ideal(&mut random, [12.0, 20.0], [true; 2], 120),
                "closed" => ideal(&mut random, [12.0, 9.0], [false; 2], 120),
                "closed mixture" => ideal_of(&mut random, [14.0, 11.0], [false; 2], &mixture),
                _ => ideal_in_channel(&mut random),
            });
            let g = values("g_ab(r)", &setting, &discs);
            means.resize(g.len(), 0.0);
            means.iter_mut().zip(g).for_each(|(mean, g)| *mean += g / f64::from(many));
        }
        let bins = means.len() / 3;
        for pair in means.chunks(bins) {
            for half in [0..bins / 2, bins / 2..bins] {
                // By the areas of the rings.
                let areas = || half.clone().map(|bin| (2 * bin + 1) as f64);
                let sum: f64 = half.clone().zip(areas()).map(|(bin, area)| pair[bin] * area).sum();
                let mean = sum / areas().sum::<f64>();
                assert!((mean - 1.0).abs() < most, "{which}: {mean}");
            }
        }
    }
}

/// By hand: in a box of 10 × 8 a disc of the first species has one of the second at a distance of 1.5 and one of its own at 3; the bin of width 0.02
/// at 1.51 has the area π (1.52² − 1.5²), of 80, for two pairs.
#[test]
fn partial_correlations_of_three_discs_are_known() {
    let mut discs = Particles::new(
        [(1, [1.0, 1.0]), (2, [4.0, 1.0]), (3, [1.0, 2.501])]
            .map(|(id, at)| disc(id, ParticleKind::Grain, at, 0.5))
            .to_vec(),
    );
    discs.all_mut()[2].species = 7;
    let setting = StructureSetting::new(Domain::planar([0.0; 2], [10.0, 8.0], [true; 2]), &discs);
    let g = values("g_ab(r)", &setting, &discs);
    let (bins, pi) = (g.len() / 3, std::f64::consts::PI);
    let [own, both] = [g[150], g[bins + 75]];
    assert!((own - 80.0 / (pi * (3.02 * 3.02 - 9.0))).abs() < 1e-9, "{own}");
    assert!((both - 40.0 / (pi * (1.52 * 1.52 - 2.25))).abs() < 1e-9, "{both}");
    assert!(g[2 * bins..].iter().all(|g| g.is_nan()), "a single disc has no pair of its species");
    // Neighbours are nearer than 1.5: none, until the third disc is 1.4 from the first.
    assert_eq!(values("coordination_ab", &setting, &discs), [0.0; 4]);
    discs.all_mut()[2].position[1] = 2.4;
    assert_eq!(values("coordination_ab", &setting, &discs), [0.0, 0.5, 1.0, 0.0]);
}

/// Displacements by species are means over its discs, and weighted by their numbers those over all.
#[test]
fn displacements_by_species_are_means_of_their_discs() {
    let mut random = Stream::new(11, RandomPurpose::Test, 0);
    let species: Vec<u8> = (0..30).map(|disc| u8::from(disc % 3 == 0)).collect();
    let (mut motion, mut now) = (MotionHistory::new(30), [[0.0; 4]; 30]);
    for look in 0..20 {
        for (state, species) in now.iter_mut().zip(&species) {
            state[0] += random.random_range(-1.0..1.0) * (1.0 + f64::from(*species));
        }
        let (mut all, mut own) = ([f64::NAN; 70], [[f64::NAN; 70]; 2]);
        motion.add_sample(&now, f64::from(look), &species, |_, lag, species, [x, ..]| match species {
            None => all[lag] = x,
            Some(species) => own[species][lag] = x,
        });
        let met = (0..70).filter(|&lag| !all[lag].is_nan());
        let off = met.map(|lag| (20.0 * own[0][lag] + 10.0 * own[1][lag] - 30.0 * all[lag]).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9);
        if look == 1 {
            assert!(own[1][1] > 2.0 * own[0][1], "{own:?}");
        }
    }
}

/// A run of two radii writes all functions by species, with the sums of those of all discs; bins and range follow the keys; scenes of one species
/// are refused.
#[test]
fn runs_write_functions_by_species() {
    let folder = tempfile::tempdir().unwrap();
    let base = [
        "particles.generate=random",
        "particles.count=120",
        "domain.sides=[20.0, 20.0]",
        "run.time=16.0",
        "run.snapshot_every=0.5",
        "run.thermo_every=0.5",
        "output.structure_share=1000.0",
    ];
    let run = |out: &str, sets: &[&str]| {
        let sets: Vec<&str> = base.iter().chain(sets).flat_map(|set| ["--set", *set]).collect();
        stripmine(folder.path(), &[&["run", "hard-disks", "--out", out][..], &sets].concat())
    };
    let names = "output.structure=[\"g(r)\", \"S(k)\", \"msd\", \"g_ab(r)\", \"S_ab(k)\", \"coordination_ab\", \"msd_a\"]";
    let mixed = ["particles.second_radius=0.8", "particles.second_share=0.25"];
    let output = run(
        "mixed",
        &[&mixed[..], &[names, "output.structure_range=6.0", "output.structure_bins=30"]].concat(),
    );
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let [g, partial]: [Vec<[f64; 5]>; 2] = [
        rows::<3>(folder.path(), "mixed", "g(r)").iter().map(|&[r, g, bar]| [0.0, 0.0, r, g, bar]).collect(),
        rows(folder.path(), "mixed", "g_ab(r)"),
    ];
    assert!(
        g.len() == 30 && partial.len() == 90 && (g[29][2] - 5.9).abs() < 1e-9,
        "{} {}",
        g.len(),
        partial.len()
    );
    for (bin, [.., whole, _]) in g.iter().enumerate() {
        let [aa, ab, bb] = [0, 1, 2].map(|pair| partial[30 * pair + bin][3]);
        // 90 and 30 discs.
        let sum = (90.0 * 89.0 * aa + 2.0 * 90.0 * 30.0 * ab + 30.0 * 29.0 * bb) / (120.0 * 119.0);
        assert!((sum - whole).abs() < 1e-9, "{bin}: {sum} {whole}");
    }
    assert!(partial[30][..2] == [1.0, 2.0] && (partial[30][2] - 0.1).abs() < 1e-12, "{:?}", partial[30]);
    let (msd, by_species) =
        (rows::<3>(folder.path(), "mixed", "msd"), rows::<4>(folder.path(), "mixed", "msd_a"));
    assert_eq!(by_species.len(), 2 * msd.len());
    for (lag, [time, whole, _]) in msd.iter().enumerate() {
        let [small, large] = [by_species[lag], by_species[msd.len() + lag]];
        assert!(small[1] == *time && (0.75 * small[2] + 0.25 * large[2] - whole).abs() < 1e-9, "{time}");
        assert!(*time == 0.0 || small[2] > large[2], "small discs are faster: {small:?} {large:?}");
    }
    assert_eq!(rows::<4>(folder.path(), "mixed", "coordination_ab").len(), 4);
    let plotted = stripmine(folder.path(), &["plot", "mixed", "--out", "pictures"]);
    assert!(plotted.status.success(), "{}", String::from_utf8_lossy(&plotted.stderr));
    for name in ["g-ab", "s-ab", "msd-a"] {
        let picture = fs::read_to_string(folder.path().join(format!("pictures/{name}.svg"))).unwrap();
        assert!(picture.contains(if name == "msd-a" { ">2<" } else { "1 and 2" }), "{name}");
    }
    for (sets, word) in [
        (&["output.structure=[\"g_ab(r)\"]"][..], "needs two species"),
        (&["output.structure=[\"msd_a\"]"], "needs two species"),
        (&["output.structure=[\"g(r)\"]", "output.structure_range=11.0"], "beyond 10"),
    ] {
        let output = run("refused", sets);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(3) && said.contains(word), "{said}");
    }
}

/// Species are those of a start file's types: names in XYZ, types of LAMMPS; grains of a few radii are numbered by their radii.
#[test]
fn start_files_have_species() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<[f64; 2]> =
        (0..36).map(|disc| [1.5 * f64::from(disc % 6), 1.5 * f64::from(disc / 6)]).collect();
    let name = |disc: usize| if disc % 4 == 1 { "Ar" } else { "He" };
    let xyz: String =
        rows.iter().enumerate().map(|(disc, [x, y])| format!("{} {x} {y} 0\n", name(disc))).collect();
    let text =
        "36\nLattice=\"9 0 0 0 9 0 0 0 1\" Properties=species:S:1:pos:R:3 pbc=\"T T F\"\n".to_owned() + &xyz;
    fs::write(folder.path().join("start.xyz"), text).unwrap();
    let dump: String = rows
        .iter()
        .enumerate()
        .map(|(disc, [x, y])| format!("{} {} {x} {y}\n", disc + 1, 1 + usize::from(disc % 4 == 1)))
        .collect();
    let head = "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n36\nITEM: BOX BOUNDS pp pp pp\n0 9\n0 9\n-0.5 0.5\nITEM: ATOMS id type x y\n";
    fs::write(folder.path().join("start.dump"), head.to_owned() + &dump).unwrap();
    let radii: Vec<f64> = (0..36).map(|disc| if disc % 4 == 1 { 0.6 } else { 0.5 }).collect();
    let listed = [
        "particles.generate=list".to_owned(),
        format!("particles.positions={rows:?}"),
        format!("particles.radii={radii:?}"),
        "domain.sides=[9.0, 9.0]".to_owned(),
    ];
    let file = |name: &str| vec![format!("particles.file={name}"), "particles.temperature=0".to_owned()];
    let mut found = vec![];
    for sets in [file("start.xyz"), file("start.dump"), listed.to_vec()] {
        let common = [
            "particles.radius=0.5",
            "particles.mass=1.0",
            "run.time=8",
            "run.snapshot_every=1",
            "output.structure=[\"S_ab(k)\"]",
            "output.structure_share=1000.0",
        ];
        let sets: Vec<&str> =
            sets.iter().map(String::as_str).chain(common).flat_map(|set| ["--set", set]).collect();
        let out = format!("run-{}", found.len());
        let output = stripmine(folder.path(), &[&["run", "hard-disks", "--out", &out][..], &sets].concat());
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let rows: Vec<[f64; 6]> = super::rows(folder.path(), &out, "S_ab(k)");
        found.push(rows.iter().take(20).map(|row| row[4]).collect::<Vec<f64>>());
    }
    assert_eq!(found[0], found[1]);
    assert!(found[2][..5].iter().zip(&found[0]).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
}
