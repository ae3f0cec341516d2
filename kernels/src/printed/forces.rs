//! Section 2, step 4: interaction of a cell and the one at place i of the mask.
//!
//! The sweep over the mask offsets is shared by all laws ([`Forces`](crate::sweep::lattice::forces::Forces)).

use crate::isa::Vector;
use crate::law::granular::Contact;
use crate::law::{Axis, Env, Law, ParticleField, ParticleSum};

/// BP93 (4)–(17) as products of whole vectors: no branch, and no merge except the 1 and 0 of (7).
///
/// Every cell computes its own share of a pair: a law for sweeps that visit pairs from both sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// k_N, γ_N, γ_S and μ. BP93 has no clamp and one arm, so the other parameters are not read.
    pub contact: Contact,
}

/// Quantities of the own cell.
#[derive(Clone, Copy)]
pub struct OwnCell<V> {
    position: [V; 2],
    velocity: [V; 2],
    omega: V,
    radius: V,
    /// −R, with the sign in front of the sum of (12).
    minus_radius: V,
    mass: V,
    test: V,
}

impl Law<2> for Printed {
    type Own<V: Copy> = OwnCell<V>;

    const FIELDS: &'static [ParticleField] = &[
        ParticleField::Velocity(Axis::X),
        ParticleField::Velocity(Axis::Y),
        ParticleField::Omega,
        ParticleField::Radius,
        ParticleField::Mass,
        ParticleField::Occupied,
    ];
    const SUMS: &'static [ParticleSum] = &ParticleSum::PLANAR;

    #[inline(always)]
    fn own<E: Env<2>>(&self, env: E) -> OwnCell<E::V> {
        env.section("step 3");
        let position = env.own_position();
        let velocity = [env.own(ParticleField::Velocity(Axis::X)), env.own(ParticleField::Velocity(Axis::Y))];
        let [omega, radius, mass, test] =
            [ParticleField::Omega, ParticleField::Radius, ParticleField::Mass, ParticleField::Occupied]
                .map(|field| env.own(field));
        env.section("(12)");
        let minus_radius = env.uniform(0.0) - radius;
        OwnCell { position, velocity, omega, radius, minus_radius, mass, test }
    }

    /// # As printed
    /// (10), (11): the tangent is printed as (n_y, −n_x), but as (−n_y, n_x) in (13), which agrees with (12) and is used here.
    /// (14): γ_N M_eff times the normal component, with the sign that removes energy; the power 3/2 is taken of contact_i times
    /// the overlap, because without contact it has no value. (15): bounded on both sides. (16): the component along the tangent,
    /// both spins with one sign.
    #[inline(always)]
    fn pair<E: Env<2>>(&self, env: E, partner: E::Partner, own: &OwnCell<E::V>) {
        let Contact { normal_damping, shear_damping, friction, .. } = self.contact;
        let uniform = |value: f64| env.uniform(value);
        let (zero, one) = (uniform(0.0), uniform(1.0));

        env.section("(5), (6)");
        let [dx, dy] = env.displacement(own.position, partner);
        env.section("(4)");
        let dist = (dx * dx + dy * dy).sqrt();
        env.section("(7)");
        let radius = env.partner(ParticleField::Radius, partner);
        let overlap = (own.radius + radius) - dist;
        let contact = E::V::select(zero.less_than(overlap), one, zero);
        if env.watches() {
            env.watch(overlap);
        }

        env.section("(17)");
        let mass = env.partner(ParticleField::Mass, partner);
        let m_eff = (own.mass * mass) / (own.mass + mass);
        env.section("(14)");
        let vx = own.velocity[0] - env.partner(ParticleField::Velocity(Axis::X), partner);
        let vy = own.velocity[1] - env.partner(ParticleField::Velocity(Axis::Y), partner);
        let inverse = one / dist;
        let separation = (vx * dx + vy * dy) * inverse;
        let xi = contact * overlap;
        let elastic = self.contact.elastic(uniform, xi);
        let normal = elastic - (uniform(normal_damping) * m_eff) * separation;
        env.section("(16)");
        let sliding = (vy * dx - vx * dy) * inverse;
        let v_rel = sliding - own.radius * own.omega - radius * env.partner(ParticleField::Omega, partner);
        env.section("(15)");
        let limit = uniform(friction) * normal.abs();
        let shear = ((uniform(-shear_damping) * m_eff) * v_rel).min(limit).max(zero - limit);

        env.section("(8)");
        let touching = (own.test * env.partner(ParticleField::Occupied, partner)) * contact;
        let fn_ = touching * normal;
        env.section("(9)");
        let fs = touching * shear;
        env.section("(10)");
        env.own_add(ParticleSum::Force(Axis::X), inverse * (dx * fn_ - dy * fs));
        env.section("(11)");
        env.own_add(ParticleSum::Force(Axis::Y), inverse * (dy * fn_ + dx * fs));
        env.section("(12)");
        env.own_add(ParticleSum::Torque, own.minus_radius * fs);

        // Observations beyond the paper: the own disc's share of a pair is proportional to its recoil.
        if env.counts_dissipation() || env.observes_energy() {
            env.section("share");
            let share = touching * (m_eff / own.mass);
            if env.counts_dissipation() {
                env.section("dissipation");
                env.dissipate(share * ((elastic - normal) * separation - shear * v_rel));
            }
            if env.observes_energy() {
                env.section("energy");
                env.energy(share * self.contact.energy(uniform, xi));
                env.virial(share * (normal * dist));
            }
        }
    }
}
