//! Fast algorithms compared with naive sums.

use super::{ideal, values};
use rand::RngExt;
use std::f64::consts::TAU;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::particles::Particle;
use stripmine_physics::structure::{
    MotionHistory, OBSERVABLES, SampleData, SamplingKind, StructureSample, observable, pair_counts,
    pair_counts_of_all, sampled_values, strides,
};

/// Hexatic order and neighbours of random discs, by a search over all of them: the six nearest sorted by distance, the angle of each.
#[test]
fn order_and_neighbours_agree_with_naive_search() {
    let mut random = Stream::new(2, RandomPurpose::Test, 0);
    for periodic in [[true, true], [true, false], [false, false]] {
        let (setting, discs) = ideal(&mut random, [14.0, 11.0], periodic, 90);
        let discs_of = discs.grains();
        let displacements = |own: &Particle| -> Vec<[f64; 2]> {
            let others = discs_of.iter().filter(|other| other.id != own.id);
            let mut displacements: Vec<[f64; 2]> = others
                .map(|other| setting.domain.displacement(own.planar_position(), other.planar_position()))
                .collect();
            displacements.sort_by(|a, b| a[0].hypot(a[1]).total_cmp(&b[0].hypot(b[1])));
            displacements
        };
        let order = |own: &Particle| {
            let displacements = displacements(own);
            let angles = displacements.iter().take(6).map(|[x, y]| 6.0 * y.atan2(*x));
            let sum = angles.fold([0.0; 2], |[a, b], angle| [a + angle.cos() / 6.0, b + angle.sin() / 6.0]);
            (sum, displacements.iter().filter(|[x, y]| x.hypot(*y) < 1.5).count())
        };
        let naive: Vec<([f64; 2], usize)> = discs_of.iter().map(order).collect();
        let share = 1.0 / naive.len() as f64;
        let whole = naive.iter().fold([0.0; 2], |[a, b], ([x, y], _)| [a + share * x, b + share * y]);
        let single = naive.iter().map(|([x, y], _)| share * x.hypot(*y)).sum::<f64>();
        let found = values("psi6", &setting, &discs);
        let [.., global, mean] = found[..] else { panic!("{found:?}") };
        assert!((global - whole[0].hypot(whole[1])).abs() < 1e-12, "{periodic:?}: {global} {whole:?}");
        assert!((mean - single).abs() < 1e-12, "{periodic:?}: {mean} {single}");
        let shares = values("coordination", &setting, &discs);
        let [shares @ .., mean, beyond] = &shares[..] else { panic!("{shares:?}") };
        let counted = naive.iter().map(|(_, count)| *count as f64).sum::<f64>() * share;
        assert!((mean - counted).abs() < 1e-12 && *beyond == 0.0, "{periodic:?}: {mean} {counted} {beyond}");
        for (number, found) in shares.iter().enumerate() {
            let naive = naive.iter().filter(|(_, count)| *count == number).count() as f64 * share;
            assert!((found - naive).abs() < 1e-12, "{periodic:?}, {number}: {found} {naive}");
        }
    }
}

/// A sample of all functions, repeated with the same memory, equals separate samples of each, on any number of threads.
#[test]
fn joint_samples_equal_separate_samples() {
    let mut random = Stream::new(3, RandomPurpose::Test, 0);
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let pools = [1, 3].map(pool);
    for (sides, periodic) in
        [([40.0, 30.0], [true, true]), ([9.0, 60.0], [true, false]), ([31.0, 35.0], [false, false])]
    {
        let (setting, first) = ideal(&mut random, sides, periodic, 2000);
        let all = || OBSERVABLES.iter().filter(|it| periodic[0] || it.name != "S(k)");
        let mut look = StructureSample::new(setting, &first, all());
        for _ in 0..3 {
            let (_, discs) = ideal(&mut random, sides, periodic, 2000);
            let mut of = |pool: &rayon::ThreadPool| {
                pool.install(|| assert!(look.take_sample(|states| states.store_grains(&discs))));
                all().map(|it| look.values(it)).collect::<Vec<_>>()
            };
            let [one, three] = [of(&pools[0]), of(&pools[1])];
            let alone: Vec<[Vec<f64>; 2]> = all().map(|it| sampled_values(it, setting, &discs)).collect();
            // Slices without a disc have no temperature.
            let bits = |all: &[[Vec<f64>; 2]]| -> Vec<u64> {
                all.concat().concat().iter().map(|it| it.to_bits()).collect()
            };
            assert!(bits(&one) == bits(&three) && bits(&one) == bits(&alone), "{periodic:?}");
            assert_eq!(
                pair_counts(&setting, discs.grains()),
                pair_counts_of_all(&setting, discs.grains()),
                "{periodic:?}"
            );
        }
    }
}

/// Waves of random discs, with the sine and cosine of each angle.
#[test]
fn waves_agree_with_sines_and_cosines() {
    let mut random = Stream::new(4, RandomPurpose::Test, 0);
    for periodic in [[true, true], [false, true]] {
        let (setting, discs) = ideal(&mut random, [57.0, 43.0], periodic, 1037);
        let observable = observable("S(k)").unwrap();
        let SamplingKind::Once { over, asks: SampleData::Waves, .. } = observable.seen else {
            unreachable!()
        };
        let vectors = over.places(&setting);
        let [found, _] = sampled_values(observable, setting, &discs);
        // Up to 25 of a diameter there are 226 and 171 waves.
        assert_eq!(vectors.len(), if periodic[0] { 226 + 171 } else { 171 });
        for (vector, found) in vectors.iter().zip(found) {
            let angle = |disc: &Particle| vector[0] * disc.position[0] + vector[1] * disc.position[1];
            let sum = |part: fn(f64) -> f64| discs.grains().iter().map(|disc| part(angle(disc))).sum::<f64>();
            let naive = (sum(f64::cos).powi(2) + sum(f64::sin).powi(2)) / 1037.0;
            assert!((found - naive).abs() < 1e-9 * (1.0 + naive), "{periodic:?} {vector:?}: {found} {naive}");
        }
    }
    // For a long side, the longest 128 waves, and as many others down to the shortest.
    let (setting, discs) = ideal(&mut random, [1000.0, 9.0], [true, false], 10);
    let SamplingKind::Once { over, .. } = observable("S(k)").unwrap().seen else { unreachable!() };
    let periods = over.places(&setting).into_iter().map(|vector| vector[0] * 1000.0 / TAU);
    let periods: Vec<f64> = periods.collect();
    assert_eq!(periods.len(), 256);
    assert!((0..128).all(|at| (periods[at] - (at + 1) as f64).abs() < 1e-9), "{periods:?}");
    assert!(periods.windows(2).all(|pair| pair[1] > pair[0] + 0.5), "{periods:?}");
    let last = periods[255];
    assert!((last - 3978.0).abs() < 1.0 && (last - last.round()).abs() < 1e-9, "{last}");
    assert!(values("S(k)", &setting, &discs).iter().all(|it| it.is_finite()));
}

/// Density, flow and temperature of each slice, computed separately.
#[test]
fn profiles_agree_with_naive_slices() {
    let mut random = Stream::new(5, RandomPurpose::Test, 0);
    let (setting, mut discs) = ideal(&mut random, [30.0, 20.0], [true, false], 400);
    for disc in discs.all_mut() {
        disc.mass = random.random_range(0.5..2.0);
        disc.velocity = [random.random_range(-1.0..1.0), random.random_range(0.0..3.0), 0.0];
    }
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        let [density, flow, temperature] = ["density", "flow", "temperature"]
            .map(|of| sampled_values(observable(&format!("{of}({name})")).unwrap(), setting, &discs));
        let [[density, _], [flow, masses], [temperature, freedoms]] = [density, flow, temperature];
        let domain = setting.domain;
        let width = domain.length(axis) / 100.0;
        for slice in 0..100 {
            let low = domain.origin[axis] + slice as f64 * width;
            let there: Vec<&Particle> =
                discs.grains().iter().filter(|it| (low..low + width).contains(&it.position[axis])).collect();
            let sum = |of: &dyn Fn(&Particle) -> f64| there.iter().map(|it| of(it)).sum::<f64>();
            let (count, mass) = (there.len() as f64, sum(&|it| it.mass));
            assert!((density[slice] - count * 100.0 / domain.area()).abs() < 1e-12);
            let mean = [0, 1].map(|along| sum(&|it| it.mass * it.velocity[along]) / mass);
            // Weights: the mass for momentum, the degrees of freedom for energy; zero without discs.
            assert!((masses[slice] - mass).abs() < 1e-12);
            assert!(count == 0.0 || (flow[slice] - mean[1 - axis]).abs() < 1e-12);
            let beside = sum(&|it| {
                it.mass * ((it.velocity[0] - mean[0]).powi(2) + (it.velocity[1] - mean[1]).powi(2))
            });
            let naive = beside / (2.0 * (count - 1.0));
            assert_eq!(freedoms[slice], (count - 1.0).max(0.0));
            assert!(
                count < 1.5 || (temperature[slice] - naive).abs() < 1e-12,
                "{naive} {}",
                temperature[slice]
            );
        }
    }
}

/// Every pair of samples at every lag, with all samples stored; one disc is lost on the way.
#[test]
fn motion_agrees_with_all_stored_samples() {
    let mut random = Stream::new(6, RandomPurpose::Test, 0);
    const DISCS: usize = 23;
    let mut whole: Vec<Vec<[f64; 4]>> = vec![];
    let mut now = [[0.0, 3.0, 0.0, 0.0]; DISCS];
    let mut motion = MotionHistory::new(DISCS);
    let lags: Vec<u64> = MotionHistory::lags().collect();
    assert_eq!(lags[..14], [0, 1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14, 16, 20]);
    for look in 0..150_u64 {
        for (disc, state) in now.iter_mut().enumerate() {
            let step = [0, 1].map(|_| random.random_range(-0.9..0.9));
            *state = [state[0] + step[0], state[1] + 0.1 * step[1], step[0], step[1]];
            if disc == 7 && look > 60 {
                *state = [f64::NAN; 4];
            }
        }
        whole.push(now.to_vec());
        let mut met = 0;
        motion.add_sample(&now, 0.5 * look as f64, &[], |earlier, place, _, means| {
            met += 1;
            assert_eq!(earlier + lags[place], look);
            let pairs = whole[earlier as usize].iter().zip(&now).filter(|(_, later)| !later[0].is_nan());
            let count = pairs.clone().count() as f64;
            let mean = |of: &dyn Fn(&[f64; 4], &[f64; 4]) -> f64| {
                pairs.clone().map(|(a, b)| of(a, b)).sum::<f64>() / count
            };
            let naive = [
                mean(&|a, b| (b[0] - a[0]).powi(2)),
                mean(&|a, b| (b[1] - a[1]).powi(2)),
                mean(&|a, b| a[2] * b[2]),
                mean(&|a, b| a[3] * b[3]),
            ];
            for (mean, naive) in means.into_iter().zip(naive) {
                assert!((mean - naive).abs() < 1e-11, "{look} {place}: {mean} {naive}");
            }
        });
        let whole_lags =
            lags.iter().filter(|&&lag| lag <= look && (look - lag).is_multiple_of(power_of(lag)));
        assert_eq!(met, whole_lags.count(), "{look}");
    }
    assert_eq!(
        (MotionHistory::most_kept(1), MotionHistory::most_kept(40), MotionHistory::most_kept(80)),
        (1, 18, 22)
    );
    assert!((motion.times()[2] - 1.0).abs() < 1e-12);
}

/// Distance between the samples of a lag.
fn power_of(lag: u64) -> u64 {
    if lag < 8 { 1 } else { 1 << (lag.ilog2() - 2) }
}

/// Samples are spaced so that they take at most their share of the work, which is counted.
#[test]
fn samples_take_at_most_their_share() {
    let mut random = Stream::new(7, RandomPurpose::Test, 0);
    let (setting, _) = ideal(&mut random, [30.0, 30.0], [true, true], 500);
    let all: Vec<_> = OBSERVABLES.iter().collect();
    let some = [observable("msd").unwrap()];
    let of = |observables, share, work| strides(observables, &setting, 500, share, work);
    assert_eq!(of(&all, 0.05, [0.0; 2]), [1; 2], "unknown work");
    assert_eq!(of(&all, 1000.0, [1200.0, 12_000.0]), [1; 2]);
    let [rows, snapshots] = of(&all, 0.05, [1200.0, 12_000.0]);
    assert!(rows > 1 && snapshots > 1, "{rows} {snapshots}");
    let half = of(&all, 0.025, [1200.0, 12_000.0]);
    assert!(half[0].abs_diff(2 * rows) <= 1 && half[1].abs_diff(2 * snapshots) <= 1, "{half:?}");
    // Alone, rows have the whole share.
    assert!(of(&some, 0.05, [1200.0, 12_000.0])[0] < rows);
}
