//! Rate and force error of the crate `particular`: `in-particular BODIES f32|f64 SECONDS`, one line of JSON.
//!
//! Uses a Plummer sphere of equal masses, softening 0.01. The error is the largest of 512 accelerations' errors over the largest
//! acceleration, compared with sums in double precision over the positions that the kernel reads.

use particular::ComputeMethod;
use particular::math::{DVec3, Vec3};
use particular::sequential::BruteForceSoftenedSIMD;
use particular::storage::PointMass;
use std::time::Instant;

const SOFTENING: f64 = 0.01;
const SAMPLED: usize = 512;

/// Uniform numbers in [0, 1): SplitMix64.
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn plummer(bodies: usize) -> Vec<[f64; 3]> {
    let mut uniform = Uniform(1);
    let place = |_| {
        let share = 0.999 * uniform.next();
        let radius = 1.0 / (share.powf(-2.0 / 3.0) - 1.0).sqrt();
        let (z, angle) = (2.0 * uniform.next() - 1.0, std::f64::consts::TAU * uniform.next());
        let flat = (1.0 - z * z).sqrt();
        [radius * flat * angle.cos(), radius * flat * angle.sin(), radius * z]
    };
    (0..bodies).map(place).collect()
}

/// The largest error over the largest acceleration.
fn error(positions: &[[f64; 3]], mass: f64, found: impl Fn(usize) -> [f64; 3]) -> f64 {
    let (mut largest, mut error) = (0.0_f64, 0.0_f64);
    let step = positions.len().div_ceil(SAMPLED);
    for (body, own) in positions.iter().enumerate().step_by(step) {
        // Compensated summation.
        let (mut sum, mut lost) = ([0.0; 3], [0.0; 3]);
        for other in positions {
            let d: [f64; 3] = std::array::from_fn(|k| other[k] - own[k]);
            let square = d.iter().map(|d| d * d).sum::<f64>() + SOFTENING * SOFTENING;
            for k in 0..3 {
                let term = mass * d[k] / (square * square.sqrt()) - lost[k];
                let next = sum[k] + term;
                lost[k] = (next - sum[k]) - term;
                sum[k] = next;
            }
        }
        let found = found(body);
        let length = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        largest = largest.max(length(sum));
        error = error.max(length(std::array::from_fn(|k| found[k] - sum[k])));
    }
    error / largest
}

/// Sweeps for a time: interactions a second, and the result of the last sweep.
fn sweeps<R>(bodies: usize, seconds: f64, mut sweep: impl FnMut() -> R) -> (f64, R) {
    let mut last = sweep();
    let (begun, mut count) = (Instant::now(), 0);
    while begun.elapsed().as_secs_f64() < seconds {
        last = std::hint::black_box(sweep());
        count += 1;
    }
    let all = (bodies * bodies) as f64 * f64::from(count);
    (all / begun.elapsed().as_secs_f64(), last)
}

fn main() {
    let words: Vec<String> = std::env::args().collect();
    let [_, bodies, precision, seconds] = &words[..] else { panic!("in-particular BODIES f32|f64 SECONDS") };
    let (bodies, seconds): (usize, f64) = (bodies.parse().unwrap(), seconds.parse().unwrap());
    let (positions, mass) = (plummer(bodies), 1.0 / bodies as f64);
    let (rate, error) = if precision == "f32" {
        let all: Vec<_> =
            positions.iter().map(|p| PointMass::new(Vec3::from(p.map(|x| x as f32)), mass as f32)).collect();
        let seen: Vec<_> = positions.iter().map(|p| p.map(|x| f64::from(x as f32))).collect();
        let mut solver = BruteForceSoftenedSIMD::<8, f32> { softening: SOFTENING as f32 };
        let (rate, found) = sweeps(bodies, seconds, || solver.compute(&all[..]));
        (rate, error(&seen, f64::from(mass as f32), |body| found[body].widened()))
    } else {
        let all: Vec<_> = positions.iter().map(|p| PointMass::new(DVec3::from(*p), mass)).collect();
        let mut solver = BruteForceSoftenedSIMD::<4, f64> { softening: SOFTENING };
        let (rate, found) = sweeps(bodies, seconds, || solver.compute(&all[..]));
        (rate, error(&positions, mass, |body| found[body].widened()))
    };
    println!("{{\"bodies\": {bodies}, \"rate\": {rate:e}, \"error\": {error:e}}}");
}

/// Conversion of a vector to double precision.
trait Widened {
    fn widened(&self) -> [f64; 3];
}

impl Widened for Vec3 {
    fn widened(&self) -> [f64; 3] {
        [self.x, self.y, self.z].map(f64::from)
    }
}

impl Widened for DVec3 {
    fn widened(&self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }
}
