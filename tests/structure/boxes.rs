//! Every function of one moment compared with naive sums, in boxes of every kind.

use super::open_top::ideal_above_floor;
use super::{ideal, ideal_in_channel, ideal_of};
use rand::RngExt;
use std::f64::consts::PI;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_physics::particles::{Particle, Particles};
use stripmine_physics::structure::{
    FunctionArguments, SamplingKind, StructureObservable, StructureSetting, observable, sampled_values,
};

/// Discs of a box, with the vectors between them by the nearest images.
struct Seeing {
    setting: StructureSetting,
    discs: Vec<Particle>,
    displacements: Vec<Vec<[f64; 2]>>,
}

impl Seeing {
    fn distance(&self, a: usize, b: usize) -> f64 {
        self.displacements[a][b][0].hypot(self.displacements[a][b][1])
    }

    fn others(&self, own: usize) -> impl Iterator<Item = usize> + use<> {
        (0..self.discs.len()).filter(move |&other| other != own)
    }

    fn touches(&self, a: usize, b: usize) -> bool {
        self.distance(a, b) < 1.5 * (self.discs[a].radius + self.discs[b].radius)
    }

    /// ψ6 of a disc over its six nearest neighbours.
    fn order(&self, own: usize) -> [f64; 2] {
        let mut others: Vec<usize> = self.others(own).collect();
        others.sort_by(|&a, &b| self.distance(own, a).total_cmp(&self.distance(own, b)));
        others.truncate(6);
        let share = 1.0 / others.len() as f64;
        others.iter().fold([0.0; 2], |[x, y], &other| {
            let [right, up] = self.displacements[own][other];
            let angle = 6.0 * up.atan2(right);
            [x + share * angle.cos(), y + share * angle.sin()]
        })
    }

    /// The naive value at a point of the function; `None` without data.
    fn naive(&self, observable: &StructureObservable, place: &[f64]) -> Option<f64> {
        let (count, domain) = (self.discs.len() as f64, &self.setting.domain);
        let all = || 0..self.discs.len();
        let (name, axis) = match observable.name.split_once('(') {
            Some((name, "x)")) => (name, 0),
            Some((name, "y)")) => (name, 1),
            _ => (observable.name, 0),
        };
        let width = domain.length(axis) / 100.0;
        let is_in_slice = |disc: &&Particle| {
            ((disc.position[axis] - domain.origin[axis]) / width).floor()
                == ((place[0] - domain.origin[axis]) / width).floor()
        };
        let slice: Vec<&Particle> = self.discs.iter().filter(is_in_slice).collect();
        let sum = |of: &dyn Fn(&Particle) -> f64| slice.iter().map(|disc| of(disc)).sum::<f64>();
        let mass = sum(&|disc| disc.mass);
        let mean = |along: usize| sum(&|disc| disc.mass * disc.velocity[along]) / mass;
        match name {
            "g(r)" => {
                let half = 0.5 * self.setting.diameter / 50.0;
                let near =
                    |a: usize, b: usize| (place[0] - half..place[0] + half).contains(&self.distance(a, b));
                let pairs =
                    all().map(|a| (a + 1..self.discs.len()).filter(|&b| near(a, b)).count()).sum::<usize>();
                let ring = 4.0 * PI * place[0] * half;
                (domain.periodic() == [true; 2])
                    .then(|| pairs as f64 / (0.5 * count * (count - 1.0) * ring / domain.area()))
            }
            "S(k)" => {
                let angle = |disc: &Particle| place[0] * disc.position[0] + place[1] * disc.position[1];
                let of = |part: fn(f64) -> f64| self.discs.iter().map(|disc| part(angle(disc))).sum::<f64>();
                Some((of(f64::cos).powi(2) + of(f64::sin).powi(2)) / count)
            }
            "coordination" => {
                let has = |own: &usize| {
                    self.others(*own).filter(|&other| self.touches(*own, other)).count() as f64 == place[0]
                };
                Some(all().filter(has).count() as f64 / count)
            }
            "psi6" => {
                let is_in = |own: &usize| {
                    let [x, y] = self.order(*own);
                    (x.hypot(y) * 50.0).floor().min(49.0) == (place[0] * 50.0).floor()
                };
                Some(50.0 * all().filter(is_in).count() as f64 / count)
            }
            "velocities" => {
                let components =
                    || self.discs.iter().flat_map(|disc| [0, 1].map(|axis| (disc.mass, disc.velocity[axis])));
                let temperature = components().map(|(mass, v)| mass * v * v).sum::<f64>() / (2.0 * count);
                let is_in = |(mass, v): &(f64, f64)| {
                    (v * (mass / temperature).sqrt() * 10.0).floor() == (place[0] * 10.0).floor()
                };
                Some(components().filter(is_in).count() as f64 / (2.0 * count * 0.1))
            }
            "density" => {
                // Below an open top slices along the floor end at the highest centre.
                let highest = self.discs.iter().map(|disc| disc.position[1]).fold(0.0, f64::max);
                let is_cut = self.setting.has_open_top && axis == 0;
                let height = if is_cut { highest - domain.origin[1] } else { domain.length(1) };
                Some(slice.len() as f64 * 100.0 / (domain.length(0) * height))
            }
            "flow" => (mass > 0.0).then(|| mean(1 - axis)),
            "temperature" => (slice.len() > 1).then(|| {
                let [u, v] = [mean(0), mean(1)];
                let beside = sum(&|disc| {
                    disc.mass * ((disc.velocity[0] - u).powi(2) + (disc.velocity[1] - v).powi(2))
                });
                beside / (2.0 * (slice.len() - 1) as f64)
            }),
            _ => panic!("{name}"),
        }
    }
}

#[test]
fn functions_agree_with_naive_sums() {
    let mut random = Stream::new(8, RandomPurpose::Test, 0);
    let mixture: Vec<f64> = [vec![0.25; 60], vec![3.0; 6]].concat();
    let boxes: [(&str, (StructureSetting, Particles)); 9] = [
        ("square", ideal(&mut random, [20.0, 20.0], [true; 2], 150)),
        ("4 × 60", ideal(&mut random, [4.0, 60.0], [true; 2], 90)),
        ("closed", ideal(&mut random, [20.0, 14.0], [false; 2], 100)),
        ("half closed", ideal(&mut random, [7.0, 30.0], [false, true], 100)),
        ("mixture 1:12", ideal_of(&mut random, [40.0, 30.0], [true; 2], &mixture)),
        ("5 particles", ideal(&mut random, [9.0, 9.0], [true; 2], 5)),
        ("channel", ideal_in_channel(&mut random)),
        ("open top", ideal_above_floor(&mut random, [true, false], &[0.5; 120])),
        ("open top, closed sides", ideal_above_floor(&mut random, [false; 2], &mixture)),
    ];
    let names = ["g(r)", "S(k)", "coordination", "psi6", "velocities"];
    let profiles = ["density(x)", "density(y)", "flow(x)", "flow(y)", "temperature(x)", "temperature(y)"];
    for (which, (setting, mut particles)) in boxes {
        for disc in particles.all_mut() {
            disc.mass = random.random_range(0.5..2.0);
            disc.velocity = [random.random_range(-1.0..1.0), random.random_range(-0.5..1.5), 0.0];
        }
        let discs = particles.grains().to_vec();
        let displacement = |a: &Particle, b: &Particle| {
            setting.domain.displacement(a.planar_position(), b.planar_position())
        };
        let displacements =
            discs.iter().map(|a| discs.iter().map(|b| displacement(a, b)).collect()).collect();
        let seeing = Seeing { setting, discs, displacements };
        for name in names.into_iter().chain(profiles) {
            if name == "S(k)" && setting.domain.periodic() == [false; 2] {
                continue;
            }
            let observable = observable(name).unwrap();
            let SamplingKind::Once { over, further, .. } = observable.seen else { unreachable!() };
            let [found, weights] = sampled_values(observable, setting, &particles);
            let places = over.places(&setting);
            assert_eq!(found.len(), places.len() + further, "{which}: {name}");
            assert!(matches!(over, FunctionArguments::Waves) == (name == "S(k)"));
            let mut largest = [0.0_f64; 2];
            for ((place, found), weight) in places.iter().zip(&found).zip(weights) {
                match seeing.naive(observable, place) {
                    Some(naive) => {
                        largest = [largest[0].max((found - naive).abs()), largest[1].max(naive.abs())];
                        assert!(weight > 0.0, "{which}: {name} at {place:?}");
                    }
                    // Below an open top the ideal gas has its own test.
                    None => assert!(name == "g(r)" || weight == 0.0, "{which}: {name} at {place:?}"),
                }
            }
            assert!(largest[0] <= 1e-9 * largest[1].max(1e-3), "{which}: {name} differs by {}", largest[0]);
            let all = || 0..seeing.discs.len();
            if name == "coordination" {
                let naive =
                    all().map(|own| seeing.others(own).filter(|&other| seeing.touches(own, other)).count());
                let naive = naive.sum::<usize>() as f64 / seeing.discs.len() as f64;
                assert!((found[places.len()] - naive).abs() < 1e-12, "{which}: {naive}");
            }
            if name == "psi6" {
                let orders: Vec<[f64; 2]> = all().map(|own| seeing.order(own)).collect();
                let mean =
                    |of: &dyn Fn(&[f64; 2]) -> f64| orders.iter().map(of).sum::<f64>() / orders.len() as f64;
                let naive = [mean(&|it| it[0]).hypot(mean(&|it| it[1])), mean(&|it| it[0].hypot(it[1]))];
                let off = [0, 1].map(|at| (found[places.len() + at] - naive[at]).abs());
                assert!(off.iter().all(|off| *off < 1e-9), "{which}: {off:?}");
            }
        }
    }
}
