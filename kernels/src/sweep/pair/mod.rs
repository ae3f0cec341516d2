//! Two discs in plain `f64`, without lattice or list: the simplest test bed of a law's conservation, bounds and symmetry.
//!
//! Only + − × ÷ √ is used, and the portable `libm` where pairs are placed, so every number is the same on every platform.

mod motion;
mod samples;

use crate::law::{Env, Law, LawTable, ParticleField, ParticleSum, StatedEnv};
use std::cell::Cell;

/// A disc with every quantity that a law may read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairBody {
    /// Centre.
    pub position: [f64; 2],
    /// Velocity.
    pub velocity: [f64; 2],
    /// Angular velocity, counter-clockwise.
    pub omega: f64,
    /// Radius.
    pub radius: f64,
    /// Inverse mass; 0 for a fixed disc.
    pub inverse_mass: f64,
}

impl PairBody {
    /// A disc of radius and mass 1 at rest.
    #[inline]
    pub fn at(x: f64, y: f64) -> PairBody {
        PairBody { position: [x, y], velocity: [0.0; 2], omega: 0.0, radius: 1.0, inverse_mass: 1.0 }
    }

    /// Mirror image in the x axis.
    #[inline]
    pub(crate) fn mirrored(self) -> PairBody {
        let flip = |[x, y]: [f64; 2]| [x, -y];
        PairBody { position: flip(self.position), velocity: flip(self.velocity), omega: -self.omega, ..self }
    }

    /// Velocity of the surface at `arm` from the centre: v + Ω × arm.
    #[inline]
    fn surface_velocity(&self, arm: [f64; 2]) -> [f64; 2] {
        [self.velocity[0] - self.omega * arm[1], self.velocity[1] + self.omega * arm[0]]
    }
}

/// Two discs, in contact or not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The law's own disc i, and its partner j.
    pub bodies: [PairBody; 2],
}

impl Pair {
    /// Force along x, force along y and torque on each of the two discs.
    #[inline]
    pub fn sums<L: Law<2>>(&self, law: &L) -> [[f64; 3]; 2] {
        self.evaluate_law(law).sums.get()
    }

    /// Stored energy of the pair and its virial (r_i − r_j)·F_i.
    #[inline]
    pub fn energy_and_virial<L: Law<2>>(&self, law: &L) -> [f64; 2] {
        self.evaluate_law(law).energy.get()
    }

    #[inline]
    fn evaluate_law<L: Law<2>>(&self, law: &L) -> PairEnv<'_> {
        let meeting = PairEnv { bodies: &self.bodies, sums: Cell::default(), energy: Cell::default() };
        let env = StatedEnv::new(&meeting, law);
        let own = law.own(env);
        law.pair(env, (), &own);
        meeting
    }

    /// Depth of the contact, ξ = R_i + R_j − |r_i − r_j|; negative for discs apart.
    #[inline]
    pub fn depth(&self) -> f64 {
        let [own, partner] = &self.bodies;
        own.radius + partner.radius - length(self.displacement())
    }

    /// The unit vector n from the partner's centre to the own.
    #[inline]
    pub fn normal(&self) -> [f64; 2] {
        let displacement = self.displacement();
        let distance = length(displacement);
        displacement.map(|component| component / distance)
    }

    /// The unit vector s = (−n_y, n_x), BP93 (13).
    #[inline]
    pub fn tangent(&self) -> [f64; 2] {
        let [nx, ny] = self.normal();
        [-ny, nx]
    }

    #[inline]
    fn displacement(&self) -> [f64; 2] {
        let [own, partner] = self.bodies.map(|body| body.position);
        [own[0] - partner[0], own[1] - partner[1]]
    }

    /// Slip of the surfaces along the tangent, from the velocity vectors: the quantity of BP93 (16), computed independently of
    /// the law.
    #[inline]
    pub fn slip(&self) -> f64 {
        let n = self.normal();
        let surface = |body: &PairBody, towards: f64| {
            body.surface_velocity(n.map(|component| towards * body.radius * component))
        };
        let [own, partner] = &self.bodies;
        let (own, partner) = (surface(own, -1.0), surface(partner, 1.0));
        dot([own[0] - partner[0], own[1] - partner[1]], self.tangent())
    }

    /// F_N and F_S: the force on the own disc along the normal and along the tangent.
    #[inline]
    pub fn normal_and_shear<L: Law<2>>(&self, law: &L) -> [f64; 2] {
        let [[fx, fy, _], _] = self.sums(law);
        [self.normal(), self.tangent()].map(|direction| dot([fx, fy], direction))
    }

    /// d(L_orbital + L_spin)/dt. Torques that act at the undeformed radii make it −ξ F_S.
    #[inline]
    pub fn angular_momentum_rate<L: Law<2>>(&self, law: &L) -> f64 {
        let [first, second] = self.sums(law);
        let [p, q] = self.bodies.map(|body| body.position);
        p[0] * first[1] - p[1] * first[0] + q[0] * second[1] - q[1] * second[0] + first[2] + second[2]
    }

    /// Largest difference, over the components, between the forces of the mirrored pair and the mirrored forces.
    #[inline]
    pub fn asymmetry<L: Law<2>>(&self, law: &L) -> f64 {
        let (here, there) = (self.sums(law), self.mirrored().sums(law));
        here.iter()
            .zip(&there)
            .flat_map(|(here, there)| [here[0] - there[0], here[1] + there[1], here[2] + there[2]])
            .map(f64::abs)
            .max_by(f64::total_cmp)
            .unwrap_or(f64::NAN)
    }

    /// Mirror image in the x axis.
    #[inline]
    pub(crate) fn mirrored(self) -> Pair {
        Pair { bodies: self.bodies.map(PairBody::mirrored) }
    }
}

#[inline]
fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline]
fn length(vector: [f64; 2]) -> f64 {
    dot(vector, vector).sqrt()
}

/// Environment of a law that evaluates one pair.
struct PairEnv<'a> {
    bodies: &'a [PairBody; 2],
    sums: Cell<[[f64; 3]; 2]>,
    /// Energy and virial.
    energy: Cell<[f64; 2]>,
}

impl PairEnv<'_> {
    #[inline]
    fn field(&self, body: usize, field: ParticleField) -> f64 {
        let body = &self.bodies[body];
        match field {
            ParticleField::Velocity(axis) => body.velocity[axis as usize],
            ParticleField::Omega => body.omega,
            ParticleField::Radius => body.radius,
            ParticleField::InverseMass => body.inverse_mass,
            ParticleField::Mass => 1.0 / body.inverse_mass,
            ParticleField::Occupied => 1.0,
        }
    }

    #[inline]
    fn add(&self, body: usize, sum: ParticleSum, value: f64) {
        let mut sums = self.sums.get();
        sums[body][sum.column::<2>()] += value;
        self.sums.set(sums);
    }
}

impl Env<2> for &PairEnv<'_> {
    type V = f64;
    type Partner = ();
    const BOTH_PARTNERS: bool = true;

    #[inline]
    fn own_position(self) -> [f64; 2] {
        self.bodies[0].position
    }
    #[inline]
    fn own(self, field: ParticleField) -> f64 {
        self.field(0, field)
    }
    #[inline]
    fn displacement(self, own: [f64; 2], (): ()) -> [f64; 2] {
        [own[0] - self.bodies[1].position[0], own[1] - self.bodies[1].position[1]]
    }
    #[inline]
    fn partner(self, field: ParticleField, (): ()) -> f64 {
        self.field(1, field)
    }
    #[inline]
    fn uniform(self, value: f64) -> f64 {
        value
    }
    #[inline]
    fn lookup<const N: usize>(self, table: &LawTable, columns: [usize; N], number: f64) -> [f64; N] {
        table.numbers(columns, number)
    }
    #[inline]
    fn none(self, predicate: bool) -> bool {
        !predicate
    }
    #[inline]
    fn own_add(self, sum: ParticleSum, value: f64) {
        self.add(0, sum, value);
    }
    #[inline]
    fn partner_sub(self, sum: ParticleSum, (): (), value: f64) {
        self.add(1, sum, -value);
    }
    #[inline]
    fn watches(self) -> bool {
        false
    }
    #[inline]
    fn watch(self, _: f64) {}
    #[inline]
    fn counts_dissipation(self) -> bool {
        false
    }
    #[inline]
    fn dissipate(self, _: f64) {}
    #[inline]
    fn observes_energy(self) -> bool {
        true
    }
    #[inline]
    fn energy(self, energy: f64) {
        self.energy.set([energy, self.energy.get()[1]]);
    }
    #[inline]
    fn virial(self, virial: f64) {
        self.energy.set([self.energy.get()[0], virial]);
    }
    #[inline]
    fn section(self, _: &'static str) {}
}
