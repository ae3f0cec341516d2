//! The contact law with one of its source's misprints: for this study, never for a run.
//!
//! Written out equation by equation and apart from the law that runs
//! ([`granular`](stripmine_kernels::law::granular)), which so has no place for a mistake on purpose. Without a misprint
//! the two are one law: `without_a_misprint_this_law_is_ours` in `tests.rs` beside this file.

use stripmine_kernels::isa::{Predicate, Vector};
use stripmine_kernels::law::granular::{Contact, ContactArm};
use stripmine_kernels::law::{Axis, Env, Field, Law, Sum};

/// An equation of BP93's contact law that does not work as it is printed.
///
/// The tests named are those of `tests.rs` beside this file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misprint {
    /// (10)–(11), the sums of the forces.
    ///
    /// # As printed
    /// The shear force acts along (n_y, −n_x), while the torque (12) and the slip (13) are made for (−n_y, n_x); we
    /// take the tangent of (13) throughout. Decided by `printed_10_and_11_break_the_rule_of_angular_momentum`.
    Tangent,
    /// (14), the normal force.
    ///
    /// # As printed
    /// `k_N ξ^{3/2} + γ_N M_eff (v_i − v_j)`, a vector added to a scalar; even its normal component has the sign that
    /// feeds energy in. We subtract the normal component. Decided by
    /// `printed_14_makes_kinetic_energy_grow_in_a_head_on_collision`.
    NormalDamping,
    /// (15), the shear force.
    ///
    /// # As printed
    /// `min(−γ_S M_eff v_t, μ|F_N|)`, the smaller of a signed number and the Coulomb bound: a negative force has no
    /// bound. We bound the magnitude and keep the sign. Decided by `printed_15_bounds_one_side_only`.
    CoulombBound,
    /// (16), the slip.
    ///
    /// # As printed
    /// `(v_i − v_j) + R_i Ω_i − R_j Ω_j`, scalars added to a vector; even with its tangential component the spins have
    /// signs for which gears slip. We subtract both. Decided by `printed_16_makes_a_gear_pair_slip` and
    /// `printed_16_makes_energy_grow_in_an_oblique_collision`.
    Slip,
}

impl Misprint {
    /// Every misprint, in the order of the equations.
    pub const ALL: [Misprint; 4] =
        [Misprint::Tangent, Misprint::NormalDamping, Misprint::CoulombBound, Misprint::Slip];

    /// The number of the equation in BP93.
    pub const fn equation(self) -> &'static str {
        match self {
            Misprint::Tangent => "(10)–(11)",
            Misprint::NormalDamping => "(14)",
            Misprint::CoulombBound => "(15)",
            Misprint::Slip => "(16)",
        }
    }
}

/// BP93 (4)–(17) with at most one equation as printed, for rough discs that may differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AsPrinted {
    /// The parameters.
    pub contact: Contact,
    /// The equation that is as printed; none for the law that runs.
    pub misprint: Option<Misprint>,
}

impl AsPrinted {
    fn prints(&self, misprint: Misprint) -> bool {
        self.misprint == Some(misprint)
    }
}

impl Law<2> for AsPrinted {
    type Own<V: Copy> = [V; 2];

    const FIELDS: &'static [Field] = &[
        Field::Velocity(Axis::X),
        Field::Velocity(Axis::Y),
        Field::Omega,
        Field::Radius,
        Field::InverseMass,
    ];
    const SUMS: &'static [Sum] = &Sum::PLANAR;

    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    /// BP93 (4)–(17); see [`Misprint`] for what is as printed.
    fn pair<E: Env<2>>(&self, env: E, place: E::Place, own: &[E::V; 2]) {
        let number = |value: f64| env.uniform(value);
        let (zero, one) = (number(0.0), number(1.0));
        let both = |field| [env.own(field), env.partner(field, place)];

        // (4)-(7)
        let [dx, dy] = env.displacement(*own, place);
        let distance = (dx * dx + dy * dy).sqrt();
        let radii = both(Field::Radius);
        let depth = radii[0] + radii[1] - distance;
        let touch = depth.less_equal(zero).not();
        let depth = depth.max(zero);
        let (nx, ny) = (dx / distance, dy / distance);
        // (13)
        let (sx, sy) = (zero - ny, nx);

        let [vx, vy] = [Field::Velocity(Axis::X), Field::Velocity(Axis::Y)].map(|field| {
            let [own, partner] = both(field);
            own - partner
        });
        // (17)
        let [own_inverse_mass, inverse_mass] = both(Field::InverseMass);
        let effective_mass = one / (own_inverse_mass + inverse_mass);

        // (14)
        let damping = number(self.contact.normal_damping) * effective_mass * (vx * nx + vy * ny);
        let elastic = number(self.contact.stiffness) * depth * depth.sqrt();
        let normal = if self.prints(Misprint::NormalDamping) { elastic + damping } else { elastic - damping };
        let normal = if self.contact.cohesionless { normal.max(zero) } else { normal };

        // (16)
        let arms = radii.map(|radius| match self.contact.arm {
            ContactArm::Radius => radius,
            ContactArm::Overlap | ContactArm::Lammps => radius - number(0.5) * depth,
        });
        let [own_omega, omega] = both(Field::Omega);
        let surfaces = if self.contact.arm == ContactArm::Lammps { radii } else { arms };
        let (own_rim, rim) = (surfaces[0] * own_omega, surfaces[1] * omega);
        let along = vx * sx + vy * sy;
        let slip = if self.prints(Misprint::Slip) { along + own_rim - rim } else { along - own_rim - rim };

        // (15)
        let viscous = number(self.contact.shear_damping) * effective_mass * slip;
        let bound = number(self.contact.friction) * normal.abs();
        let shear = if self.prints(Misprint::CoulombBound) {
            (zero - viscous).min(bound)
        } else {
            let size = viscous.abs().min(bound);
            E::V::select(slip.less_than(zero), size, zero - size)
        };

        // (10)-(12)
        let (tx, ty) = if self.prints(Misprint::Tangent) { (ny, zero - nx) } else { (sx, sy) };
        let force = [normal * nx + shear * tx, normal * ny + shear * ty];
        for (sum, component) in [Sum::Force(Axis::X), Sum::Force(Axis::Y)].into_iter().zip(force) {
            let component = E::V::select(touch, component, zero);
            env.own_add(sum, component);
            if E::BOTH_PARTNERS {
                env.partner_sub(sum, place, component);
            }
        }
        let shear = E::V::select(touch, shear, zero);
        env.own_add(Sum::Torque, zero - arms[0] * shear);
        if E::BOTH_PARTNERS {
            env.partner_sub(Sum::Torque, place, arms[1] * shear);
        }
    }
}
