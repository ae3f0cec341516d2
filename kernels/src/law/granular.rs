//! Granular discs: contacts with a spring, viscous damping, Coulomb friction and rotation.

use super::spring::Spring;
use super::{Axis::X, Axis::Y, Env, Law, ParticleField, ParticleSum, WallCoefficient};
use crate::isa::{Predicate, Vector};

/// Lever arm of the tangential force, measured from a disc's centre.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum ContactArm {
    /// At the undeformed radius R, as in BP93.
    #[default]
    Radius,
    /// At R − ξ/2, in the middle of the overlap, for both the torque and the surface velocity.
    Overlap,
    /// Torque at R − ξ/2, surface velocity at R, as in LAMMPS.
    Lammps,
}

/// Parameters of the contact law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Dependence of the elastic force on the overlap.
    pub spring: Spring,
    /// Stiffness k_N of the spring (force/length^p; Hertz: force/length^1.5).
    pub stiffness: f64,
    /// Normal damping γ_N (1/time); multiplied by the effective mass.
    pub normal_damping: f64,
    /// Tangential damping γ_S (1/time); multiplied by the effective mass.
    pub shear_damping: f64,
    /// Coulomb friction coefficient μ.
    pub friction: f64,
    /// True to clamp the normal force at zero, so that separating discs never pull.
    pub cohesionless: bool,
    /// Lever arm of the tangential force.
    pub arm: ContactArm,
}

/// Radius and inverse mass of equal discs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EqualDiscs {
    /// Radius.
    pub radius: f64,
    /// Inverse mass.
    pub inverse_mass: f64,
}

/// Contact law of granular discs. It is compiled four times per precision: with and without `FRICTION` (which includes rotation),
/// for `EQUAL` and for varying discs. Every other choice is a number or a branch that is the same for all pairs.
///
/// Two touching fixed discs (inverse mass 0) have no effective mass. Their own sums may be NaN, and have no meaning anyway. The
/// sums of other discs are not affected.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Granular<const FRICTION: bool, const EQUAL: bool> {
    /// Parameters of the contacts.
    pub contact: Contact,
    /// The discs if all are equal; not read otherwise.
    pub disc: EqualDiscs,
}

/// Quantities of the own disc.
#[derive(Clone, Copy)]
pub struct OwnDisc<V> {
    position: [V; 2],
    velocity: [V; 2],
    omega: V,
    radius: V,
    inverse_mass: V,
}

impl<const FRICTION: bool, const EQUAL: bool> Granular<FRICTION, EQUAL> {
    #[inline(always)]
    fn radius<V>(&self, uniform: impl Fn(f64) -> V, varying: impl Fn(ParticleField) -> V) -> V {
        if EQUAL { uniform(self.disc.radius) } else { varying(ParticleField::Radius) }
    }

    #[inline(always)]
    fn inverse_mass<V>(&self, uniform: impl Fn(f64) -> V, varying: impl Fn(ParticleField) -> V) -> V {
        if EQUAL { uniform(self.disc.inverse_mass) } else { varying(ParticleField::InverseMass) }
    }
}

impl<const FRICTION: bool, const EQUAL: bool> Law<2> for Granular<FRICTION, EQUAL> {
    type Own<V: Copy> = OwnDisc<V>;

    const FIELDS: &'static [ParticleField] = match (FRICTION, EQUAL) {
        (true, true) => &[ParticleField::Velocity(X), ParticleField::Velocity(Y), ParticleField::Omega],
        (true, false) => &[
            ParticleField::Velocity(X),
            ParticleField::Velocity(Y),
            ParticleField::Omega,
            ParticleField::Radius,
            ParticleField::InverseMass,
        ],
        (false, true) => &[ParticleField::Velocity(X), ParticleField::Velocity(Y)],
        (false, false) => &[
            ParticleField::Velocity(X),
            ParticleField::Velocity(Y),
            ParticleField::Radius,
            ParticleField::InverseMass,
        ],
    };
    const SUMS: &'static [ParticleSum] =
        if FRICTION { &ParticleSum::PLANAR } else { &[ParticleSum::Force(X), ParticleSum::Force(Y)] };

    #[inline(always)]
    fn own<E: Env<2>>(&self, env: E) -> OwnDisc<E::V> {
        OwnDisc {
            position: env.own_position(),
            velocity: [env.own(ParticleField::Velocity(X)), env.own(ParticleField::Velocity(Y))],
            omega: if FRICTION { env.own(ParticleField::Omega) } else { env.uniform(0.0) },
            radius: self.radius(|r| env.uniform(r), |field| env.own(field)),
            inverse_mass: self.inverse_mass(|w| env.uniform(w), |field| env.own(field)),
        }
    }

    /// BP93 (4)–(17).
    ///
    /// # As printed
    /// (14) adds `γ_N M_eff (v_i − v_j)`, a vector, with a sign that feeds energy in: here the normal component is subtracted.
    /// (15) takes the smaller of a signed number and μ|F_N|: here the magnitude is bounded and the sign kept. (16) gives the
    /// spins opposite signs: here both surfaces count, `R_i Ω_i + R_j Ω_j`. (10)–(12) use another tangent than (13): here (13) is
    /// used throughout.
    #[inline(always)]
    fn pair<E: Env<2>>(&self, env: E, partner: E::Partner, own: &OwnDisc<E::V>) {
        let Contact { normal_damping, shear_damping, friction, cohesionless, arm, .. } = self.contact;
        let uniform = |value: f64| env.uniform(value);
        let zero = uniform(0.0);

        env.section("distance"); // (4)-(6)
        let [dx, dy] = env.displacement(own.position, partner);
        let distance = (dx * dx + dy * dy).sqrt();

        env.section("contact"); // (7)
        let radius = self.radius(uniform, |field| env.partner(field, partner));
        let reach = own.radius + radius;
        let penetration = reach - distance;
        if env.watches() {
            env.watch(penetration);
        }
        let contact = zero.less_than(penetration);
        if env.none(contact) {
            return;
        }

        env.section("normal force"); // (14), (17)
        let inverse_distance = uniform(1.0) / distance;
        let [nx, ny] = [dx * inverse_distance, dy * inverse_distance];
        let vx = own.velocity[0] - env.partner(ParticleField::Velocity(X), partner);
        let vy = own.velocity[1] - env.partner(ParticleField::Velocity(Y), partner);
        let inverse_mass = self.inverse_mass(uniform, |field| env.partner(field, partner));
        let effective_mass = uniform(1.0) / (own.inverse_mass + inverse_mass);
        let overlap = penetration.max(zero);
        let elastic = self.contact.elastic(uniform, overlap);
        let rate = env.coefficient(WallCoefficient::NormalDamping, normal_damping) * effective_mass;
        let separation = vx * nx + vy * ny;
        let damping = rate * separation;
        let floor = uniform(if cohesionless { 0.0 } else { f64::NEG_INFINITY });
        let normal = (elastic - damping).max(floor);
        let fn_ = E::V::select(contact, normal, zero); // (8)
        // Each disc's share of a pair is proportional to its recoil: a fixed disc has none.
        let shared = |whole: E::V| {
            if E::BOTH_PARTNERS {
                E::V::select(effective_mass.less_than(uniform(f64::INFINITY)), whole, zero)
            } else {
                whole * (own.inverse_mass * effective_mass)
            }
        };
        // Power of the springs minus that of the pair: the loss in damping and clamping.
        let dissipate = |power: E::V| env.dissipate(E::V::select(contact, shared(power), zero));
        if env.observes_energy() {
            env.section("energy");
            env.energy(E::V::select(contact, shared(self.contact.energy(uniform, overlap)), zero));
            // Friction acts perpendicular to the line of centres and has no virial; forces on walls do not count for the discs.
            let both_move = zero.less_than(own.inverse_mass.min(inverse_mass));
            env.virial(E::V::select(contact.and(both_move), shared(normal * distance), zero));
            let one_moves = zero.less_than(own.inverse_mass.max(inverse_mass));
            env.contact(E::V::select(contact.and(one_moves), penetration / reach, zero));
        }

        if !FRICTION {
            env.section("sums"); // (10), (11)
            add_pair_force(env, partner, ParticleSum::Force(X), fn_ * nx);
            add_pair_force(env, partner, ParticleSum::Force(Y), fn_ * ny);
            if env.counts_dissipation() {
                env.section("dissipation");
                dissipate((elastic - normal) * separation);
            }
            return;
        }

        env.section("shear force"); // (15), (16), with the tangent s = (−ny, nx) of (13)
        let mut arms = [own.radius, radius];
        if arm != ContactArm::Radius {
            let half = uniform(0.5) * overlap;
            arms = [own.radius - half, radius - half];
        }
        let surfaces = if arm == ContactArm::Lammps { [own.radius, radius] } else { arms };
        let own_spin = surfaces[0] * own.omega;
        let omega = env.partner(ParticleField::Omega, partner);
        let spin = own_spin + surfaces[1] * omega;
        let sliding = vy * nx - vx * ny;
        let slip = sliding - spin;
        let rate = env.coefficient(WallCoefficient::ShearDamping, shear_damping) * effective_mass;
        let drag = rate * slip;
        let limit = env.coefficient(WallCoefficient::Friction, friction) * normal.abs();
        let shear = (zero - drag).min(limit).max(zero - limit);
        let fs = E::V::select(contact, shear, zero); // (9)

        env.section("sums"); // (10)-(12)
        add_pair_force(env, partner, ParticleSum::Force(X), fn_ * nx - fs * ny);
        add_pair_force(env, partner, ParticleSum::Force(Y), fn_ * ny + fs * nx);
        env.own_add(ParticleSum::Torque, zero - arms[0] * fs);
        if E::BOTH_PARTNERS {
            env.partner_sub(ParticleSum::Torque, partner, arms[1] * fs);
        }
        if env.counts_dissipation() {
            env.section("dissipation");
            // Power of the friction: its force on the centres and its torques.
            let rubbed = shear * (sliding - (arms[0] * own.omega + arms[1] * omega));
            dissipate((elastic - normal) * separation - rubbed);
        }
    }
}

/// Adds a force to the own disc and its reaction to the partner.
#[inline(always)]
fn add_pair_force<E: Env<2>>(env: E, partner: E::Partner, sum: ParticleSum, force: E::V) {
    env.own_add(sum, force);
    if E::BOTH_PARTNERS {
        env.partner_sub(sum, partner, force);
    }
}
