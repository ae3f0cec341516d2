//! Velocities scaled to exactly the temperature that a scene asks for.

use crate::particles::Particle;
use crate::scene::Speed;

/// Removes the mean motion along the axes that conserve momentum, and scales velocities so that their temperature is exact: a disc of mass m has
/// the deviation σ(m) along every degree of freedom, N − 1 along conserved axes and N along others. Particles at rest stay so.
pub(super) fn scale_velocities(grains: &mut [Particle], speed: Speed, conserved: [bool; 2]) {
    let mass: f64 = grains.iter().map(|grain| grain.mass).sum();
    let mut freedoms = 0.0;
    for (axis, is_conserved) in conserved.into_iter().enumerate() {
        freedoms += grains.len() as f64 - f64::from(is_conserved);
        if is_conserved {
            let mean = grains.iter().map(|grain| grain.mass * grain.velocity[axis]).sum::<f64>() / mass;
            grains.iter_mut().for_each(|grain| grain.velocity[axis] -= mean);
        }
    }
    let square = |grain: &Particle| {
        let [u, v] = grain.planar_velocity().map(|v| v / speed.deviation(grain.mass));
        u * u + v * v
    };
    let scale = (freedoms / grains.iter().map(square).sum::<f64>()).sqrt();
    if scale.is_finite() && scale > 0.0 {
        grains.iter_mut().for_each(|grain| grain.velocity = grain.velocity.map(|v| scale * v));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particles::ParticleKind;

    /// Three discs of masses 1, 2 and 3 in a box periodic along x: kT from the sums m v² over 5 degrees of freedom.
    #[test]
    fn scaled_velocities_have_the_temperature() {
        let mut grains: Vec<Particle> = [[1.0, 2.0], [-0.5, 0.25], [3.0, -1.0]]
            .into_iter()
            .zip(1..)
            .map(|([u, v], id)| Particle {
                mass: f64::from(id),
                velocity: [u, v, 0.0],
                ..Particle::at_rest(id, ParticleKind::Grain, [0.0; 3])
            })
            .collect();
        scale_velocities(&mut grains, Speed::Temperature(0.7), [true, false]);
        let momentum: f64 = grains.iter().map(|it| it.mass * it.velocity[0]).sum();
        let heat: f64 =
            grains.iter().map(|it| it.mass * (it.velocity[0].powi(2) + it.velocity[1].powi(2))).sum();
        assert!(momentum.abs() < 1e-14 && (heat / 5.0 - 0.7).abs() < 1e-14, "{momentum} {heat}");
        // The directions are kept: the second disc moved with velocity (−0.5 − 9/6, 0.25).
        assert!((grains[1].velocity[0] / grains[1].velocity[1] + 8.0).abs() < 1e-13);
        grains.iter_mut().for_each(|grain| grain.velocity = [0.0; 3]);
        let before = grains.clone();
        scale_velocities(&mut grains, Speed::Temperature(0.0), [true, false]);
        assert_eq!(grains, before);
    }
}
