//! Contact law with one of BP93's misprints, for this study only.
//!
//! The law is written equation by equation, separately from the law of runs ([`granular`](stripmine_kernels::law::granular)), which contains no
//! deliberate errors. Without a misprint the two laws agree: `without_misprint_the_laws_agree` in `tests.rs`.

use stripmine_kernels::isa::{Predicate, Vector};
use stripmine_kernels::law::granular::Contact;
use stripmine_kernels::law::{Axis, Env, Law, ParticleField, ParticleSum};

/// Misprinted equations of BP93's contact law. `tests.rs` has a test for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misprint {
    /// (10)–(11): the shear force acts along (n_y, −n_x), but torque (12) and slip (13) assume (−n_y, n_x), which we use.
    Tangent,
    /// (14): a vector is added to a scalar, and its normal component has the sign that adds energy. We subtract it.
    NormalDamping,
    /// (15): the minimum of a signed number and the Coulomb bound, so a negative force is unbounded. We bound the magnitude.
    CoulombBound,
    /// (16): scalars are added to a vector, and the signs of the spins let rolling discs slip. We subtract both.
    Slip,
}

impl Misprint {
    /// Number of the equation in BP93, printed form and corrected form.
    pub(super) const fn words(self) -> [&'static str; 3] {
        match self {
            Misprint::Tangent => {
                ["(10)–(11)", "F += F_N n + F_S (n_y, −n_x)", "F += F_N n + F_S (−n_y, n_x)"]
            }
            Misprint::NormalDamping => [
                "(14)",
                "F_N = k_N ξ^(3/2) + γ_N M_eff (v_i − v_j)",
                "F_N = k_N ξ^(3/2) − γ_N M_eff (v_i − v_j)·n",
            ],
            Misprint::CoulombBound => {
                ["(15)", "F_S = min(−γ_S M_eff v_t, μ|F_N|)", "F_S = −sign(v_t) min(γ_S M_eff |v_t|, μ|F_N|)"]
            }
            Misprint::Slip => {
                ["(16)", "v_t = (v_i − v_j) + R_i Ω_i − R_j Ω_j", "v_t = (v_i − v_j)·s − R_i Ω_i − R_j Ω_j"]
            }
        }
    }
}

/// BP93 (4)–(17) with at most one misprinted equation, for different rough discs. Separating discs may attract, and lever arms are radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct AsPrinted {
    pub(super) contact: Contact,
    /// Misprinted equation; `None` for the corrected law.
    pub(super) misprint: Option<Misprint>,
}

impl AsPrinted {
    fn is_misprinted(&self, misprint: Misprint) -> bool {
        self.misprint == Some(misprint)
    }
}

impl Law<2> for AsPrinted {
    type Own<V: Copy> = [V; 2];

    const FIELDS: &'static [ParticleField] = &[
        ParticleField::Velocity(Axis::X),
        ParticleField::Velocity(Axis::Y),
        ParticleField::Omega,
        ParticleField::Radius,
        ParticleField::InverseMass,
    ];
    const SUMS: &'static [ParticleSum] = &ParticleSum::PLANAR;

    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    /// BP93 (4)–(17); see [`Misprint`] for the deviations.
    fn pair<E: Env<2>>(&self, env: E, partner: E::Partner, own: &[E::V; 2]) {
        let number = |value: f64| env.uniform(value);
        let (zero, one) = (number(0.0), number(1.0));
        let both = |field| [env.own(field), env.partner(field, partner)];

        // (4)-(7)
        let [dx, dy] = env.displacement(*own, partner);
        let distance = (dx * dx + dy * dy).sqrt();
        let radii = both(ParticleField::Radius);
        let depth = radii[0] + radii[1] - distance;
        let touch = depth.less_equal(zero).not();
        let depth = depth.max(zero);
        let (nx, ny) = (dx / distance, dy / distance);
        // (13)
        let (sx, sy) = (zero - ny, nx);

        let [vx, vy] = [ParticleField::Velocity(Axis::X), ParticleField::Velocity(Axis::Y)].map(|field| {
            let [own, partner] = both(field);
            own - partner
        });
        // (17)
        let [own_inverse_mass, inverse_mass] = both(ParticleField::InverseMass);
        let effective_mass = one / (own_inverse_mass + inverse_mass);

        // (14)
        let damping = number(self.contact.normal_damping) * effective_mass * (vx * nx + vy * ny);
        let elastic = number(self.contact.stiffness) * depth * depth.sqrt();
        let normal =
            if self.is_misprinted(Misprint::NormalDamping) { elastic + damping } else { elastic - damping };

        // (16)
        let [own_omega, omega] = both(ParticleField::Omega);
        let (own_rim, rim) = (radii[0] * own_omega, radii[1] * omega);
        let along = vx * sx + vy * sy;
        let slip =
            if self.is_misprinted(Misprint::Slip) { along + own_rim - rim } else { along - own_rim - rim };

        // (15)
        let viscous = number(self.contact.shear_damping) * effective_mass * slip;
        let bound = number(self.contact.friction) * normal.abs();
        let shear = if self.is_misprinted(Misprint::CoulombBound) {
            (zero - viscous).min(bound)
        } else {
            let size = viscous.abs().min(bound);
            E::V::select(slip.less_than(zero), size, zero - size)
        };

        // (10)-(12)
        let (tx, ty) = if self.is_misprinted(Misprint::Tangent) { (ny, zero - nx) } else { (sx, sy) };
        let force = [normal * nx + shear * tx, normal * ny + shear * ty];
        for (sum, component) in
            [ParticleSum::Force(Axis::X), ParticleSum::Force(Axis::Y)].into_iter().zip(force)
        {
            let component = E::V::select(touch, component, zero);
            env.own_add(sum, component);
            if E::BOTH_PARTNERS {
                env.partner_sub(sum, partner, component);
            }
        }
        let shear = E::V::select(touch, shear, zero);
        env.own_add(ParticleSum::Torque, zero - radii[0] * shear);
        if E::BOTH_PARTNERS {
            env.partner_sub(ParticleSum::Torque, partner, radii[1] * shear);
        }
    }
}
