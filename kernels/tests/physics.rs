//! What the contact law conserves, bounds and mirrors; and each of the source's four misprints failing a test
//! of its own.

mod support;

use std::cell::Cell;
use stripmine_kernels::isa::{Predicate, Vector};
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc, Granular};
use stripmine_kernels::law::{Env, Field, Law, Sum};
use stripmine_kernels::noise::{Purpose, Stream};
use stripmine_kernels::sweep::lattice::Frame;
use stripmine_kernels::{Execution, InstructionSet};
use support::{CONTACT, Case, Placed, System, varying};

/// The ways a text is compiled that matter here; `identity.rs` compares the others.
fn ways() -> [(Execution, InstructionSet); 2] {
    [InstructionSet::Scalar, InstructionSet::best()].map(|set| (Execution::Chained, set))
}

// ---- two discs and a law, without any lattice -----------------------------------------------------------

/// Two discs that meet once, as plain numbers.
struct Meeting {
    discs: [Placed; 2],
    /// Force along x, along y, and torque, on each.
    sums: Cell<[[f64; 3]; 2]>,
}

impl Meeting {
    fn field(&self, disc: usize, field: Field) -> f64 {
        let disc = &self.discs[disc];
        match field {
            Field::Vx => disc.velocity[0],
            Field::Vy => disc.velocity[1],
            Field::Omega => disc.omega,
            Field::Radius => disc.radius,
            Field::InverseMass => disc.inverse_mass,
        }
    }

    fn add(&self, disc: usize, sum: Sum, value: f64) {
        let mut sums = self.sums.get();
        sums[disc][sum as usize] += value;
        self.sums.set(sums);
    }
}

impl Env<2> for &Meeting {
    type V = f64;
    type Place = ();
    const BOTH_PARTNERS: bool = true;

    fn own_position(self) -> [f64; 2] {
        self.discs[0].position
    }
    fn own(self, field: Field) -> f64 {
        self.field(0, field)
    }
    fn displacement(self, own: [f64; 2], (): ()) -> [f64; 2] {
        [own[0] - self.discs[1].position[0], own[1] - self.discs[1].position[1]]
    }
    fn partner(self, field: Field, (): ()) -> f64 {
        self.field(1, field)
    }
    fn uniform(self, value: f64) -> f64 {
        value
    }
    fn none(self, predicate: bool) -> bool {
        !predicate
    }
    fn own_add(self, sum: Sum, value: f64) {
        self.add(0, sum, value);
    }
    fn partner_sub(self, sum: Sum, (): (), value: f64) {
        self.add(1, sum, -value);
    }
    fn watched_penetration(self) -> Option<f64> {
        None
    }
    fn watch(self, _: f64) {}
    fn section(self, _: &'static str) {}
}

/// Force and torque on both discs.
fn meet<L: Law<2>>(law: &L, discs: [Placed; 2]) -> [[f64; 3]; 2] {
    let meeting = Meeting { discs, sums: Cell::default() };
    let own = law.own(&meeting);
    law.pair(&meeting, (), &own);
    meeting.sums.get()
}

/// Geometry of a pair: depth ξ, normal n (from the second to the first), tangent s = (−n_y, n_x).
fn geometry([a, b]: &[Placed; 2]) -> (f64, [f64; 2], [f64; 2]) {
    let way = [a.position[0] - b.position[0], a.position[1] - b.position[1]];
    let distance = way[0].hypot(way[1]);
    let n = way.map(|w| w / distance);
    (a.radius + b.radius - distance, n, [-n[1], n[0]])
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Normal and shear force on the first disc.
fn normal_and_shear<L: Law<2>>(law: &L, discs: [Placed; 2]) -> (f64, f64) {
    let (_, n, s) = geometry(&discs);
    let [on_first, _] = meet(law, discs);
    let force = [on_first[0], on_first[1]];
    (dot(force, n), dot(force, s))
}

/// Slip of the surfaces, by the vectors: velocity plus Ω × arm of each at the contact, along the tangent.
fn slip(discs: &[Placed; 2]) -> f64 {
    let (_, n, s) = geometry(discs);
    let surface = |disc: &Placed, towards: f64| {
        let arm = n.map(|n| towards * disc.radius * n);
        [disc.velocity[0] - disc.omega * arm[1], disc.velocity[1] + disc.omega * arm[0]]
    };
    let (first, second) = (surface(&discs[0], -1.0), surface(&discs[1], 1.0));
    dot([first[0] - second[0], first[1] - second[1]], s)
}

/// d(L_orbital + L_spin)/dt of the pair.
fn torque<L: Law<2>>(law: &L, discs: [Placed; 2]) -> f64 {
    let [first, second] = meet(law, discs);
    let [p, q] = discs.map(|disc| disc.position);
    p[0] * first[1] - p[1] * first[0] + q[0] * second[1] - q[1] * second[0] + first[2] + second[2]
}

/// A pair in contact at any angle, 0 to 10 % deep, with random velocities, spins, radii and masses.
fn random_pair(random: &mut Stream) -> [Placed; 2] {
    let mut spread = |width: f64| width * (random.uniform() - 0.5);
    let radii = [1.0 + spread(0.2), 1.0 + spread(0.2)];
    let distance = (radii[0] + radii[1]) * (0.95 + spread(0.1));
    let angle = spread(std::f64::consts::TAU);
    let first = [spread(4.0), spread(4.0)];
    let second = [first[0] + distance * angle.cos(), first[1] + distance * angle.sin()];
    [(first, radii[0]), (second, radii[1])].map(|(position, radius)| Placed {
        position,
        velocity: [spread(2.0), spread(2.0)],
        omega: spread(4.0),
        radius,
        inverse_mass: 1.0 / (1.0 + spread(1.0)),
    })
}

fn random_pairs(seed: u64, count: usize) -> impl Iterator<Item = [Placed; 2]> {
    let mut random = Stream::new(seed, Purpose::Test, 0);
    (0..count).map(move |_| random_pair(&mut random))
}

/// The laws' options that change forces: clamped or not, and the two arms.
fn contacts() -> impl Iterator<Item = Contact> {
    [true, false].into_iter().flat_map(|cohesionless| {
        [ContactArm::Radius, ContactArm::Overlap].map(|arm| Contact { cohesionless, arm, ..CONTACT })
    })
}

// ---- on the lattice -------------------------------------------------------------------------------------

/// A pair on an 8×8 lattice, periodic both ways, somewhere within the side lengths; and whether a seam is
/// between them.
fn pair_on_the_lattice(
    contact: Contact,
    discs: [Placed; 2],
    how: (Execution, InstructionSet),
) -> ([[f64; 3]; 2], bool) {
    let case = Case { contact, ..Case::new(8, 8) };
    let frame = Frame { origin: [-3.0, 2.0], edge: [1.1, 1.1] };
    let law = varying::<true>(contact);
    let mut system = System::<f64, f64>::placed(&case, frame, &discs);
    system.index(&case, &law, how);
    assert_eq!((system.strays, system.conflicts), (0, 0));
    system.forces::<_, false>(&case, &law, how).unwrap();
    let sums = Sum::ALL.map(|sum| system.on_discs(sum));
    let on = |disc: usize| [sums[0][disc], sums[1][disc], sums[2][disc]];
    let wrapped = |axis: usize| {
        let stored = &system.state[axis][0];
        (stored[0] - stored[1]).abs() > 4.4
    };
    ([on(0), on(1)], wrapped(0) || wrapped(1))
}

/// In cell-relative coordinates the two forces of a pair are each other's negatives to the bit, also across a
/// seam.
#[test]
fn action_is_reaction_to_the_bit() {
    let (mut seams, mut inside, mut random) = (0, 0, Stream::new(1, Purpose::Test, 1));
    for contact in contacts() {
        for mut discs in random_pairs(2, 300) {
            let to = [-3.0 + 8.8 * random.uniform(), 2.0 + 8.8 * random.uniform()];
            let by = [to[0] - discs[0].position[0], to[1] - discs[0].position[1]];
            for disc in &mut discs {
                disc.position = [disc.position[0] + by[0], disc.position[1] + by[1]];
            }
            let [([first, second], seam), other] = ways().map(|how| pair_on_the_lattice(contact, discs, how));
            assert_eq!(([first, second], seam), other);
            assert!(first[0] != 0.0 || first[1] != 0.0 || contact.cohesionless, "{discs:?}");
            for axis in 0..2 {
                assert_eq!(first[axis], -second[axis], "component {axis} for {discs:?}");
            }
            *(if seam { &mut seams } else { &mut inside }) += 1;
        }
    }
    println!("{seams} pairs across a seam, {inside} not");
    assert!(seams > 100 && inside > 100);
}

/// The lattice's pair gives what the law gives without a lattice, torques included.
#[test]
fn a_pair_on_the_lattice_is_a_pair_without_one() {
    for contact in contacts() {
        for mut discs in random_pairs(3, 50) {
            discs.iter_mut().for_each(|disc| disc.position[1] += 6.0);
            let expected = meet(&varying::<true>(contact), discs);
            let (found, _) = pair_on_the_lattice(contact, discs, ways()[1]);
            for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
                assert!((found - expected).abs() < 1e-11, "{found} for {expected}");
            }
        }
    }
}

/// The forces of a whole random system sum to zero.
#[test]
fn the_total_force_of_a_system_is_zero() {
    for periodic in [[true, true], [false, false], [true, false]] {
        let case = Case { periodic, ..Case::new(30, 20) };
        let law = varying::<true>(case.contact);
        let mut system = System::<f64, f64>::random(&case);
        system.index(&case, &law, ways()[1]);
        system.forces::<_, false>(&case, &law, ways()[1]).unwrap();
        for sum in [Sum::Fx, Sum::Fy] {
            let forces = system.on_discs(sum);
            let (total, scale) = (forces.iter().sum::<f64>(), forces.iter().map(|f| f.abs()).sum::<f64>());
            assert!(scale > 100.0, "the case must have contacts");
            assert!(total.abs() < 1e-14 * scale, "{total} of {scale} on {periodic:?}");
        }
    }
}

// ---- the law --------------------------------------------------------------------------------------------

/// d(L_orbital + L_spin)/dt = −ξ F_S with arms R, and 0 with arms R − ξ/2.
#[test]
fn angular_momentum_changes_by_the_depth_times_the_shear_force_alone() {
    let mut largest = 0.0f64;
    for contact in contacts() {
        for discs in random_pairs(4, 1000) {
            let law = varying::<true>(contact);
            let (depth, ..) = geometry(&discs);
            let (normal, shear) = normal_and_shear(&law, discs);
            let expected = if contact.arm == ContactArm::Radius { -depth * shear } else { 0.0 };
            let off = (torque(&law, discs) - expected).abs();
            assert!(off < 1e-13 * (1.0 + normal.abs()), "off by {off} for {discs:?}");
            largest = largest.max(depth * shear.abs());
        }
    }
    assert!(largest > 0.1, "the rule must have something to say: {largest}");
}

/// |F_S| ≤ μ|F_N|; F_S opposes the slip; below the bound it is γ_S M_eff times the slip; both signs are met.
#[test]
fn friction_opposes_slip_within_the_coulomb_bound_on_both_sides_of_zero() {
    let contact = Contact { shear_damping: 20.0, ..CONTACT };
    let law = varying::<true>(contact);
    let (mut bound, mut free) = ([0; 2], [0; 2]);
    for discs in random_pairs(5, 3000) {
        let (normal, shear) = normal_and_shear(&law, discs);
        let (slip, limit) = (slip(&discs), contact.friction * normal.abs());
        let side = usize::from(slip > 0.0);
        let viscous = contact.shear_damping * slip.abs() / (discs[0].inverse_mass + discs[1].inverse_mass);
        assert!(shear.abs() <= limit + 1e-13, "{shear} beyond {limit}");
        assert!(shear * slip <= 0.0, "{shear} along the slip {slip}");
        if viscous > limit {
            bound[side] += 1
        } else {
            free[side] += 1
        }
        assert!((shear.abs() - viscous.min(limit)).abs() < 1e-12, "{shear} for {viscous} and {limit}");
    }
    assert!(bound.into_iter().chain(free).all(|met| met > 100), "{bound:?} {free:?}");
}

/// The mirror image of a disc in the x axis.
fn mirrored(disc: Placed) -> Placed {
    let flip = |[x, y]: [f64; 2]| [x, -y];
    Placed { position: flip(disc.position), velocity: flip(disc.velocity), omega: -disc.omega, ..disc }
}

/// How far a mirrored pair's forces are from the mirrored forces.
fn asymmetry<L: Law<2>>(law: &L, discs: [Placed; 2]) -> f64 {
    let (here, there) = (meet(law, discs), meet(law, discs.map(mirrored)));
    let off = |disc: usize| {
        [here[disc][0] - there[disc][0], here[disc][1] + there[disc][1], here[disc][2] + there[disc][2]]
    };
    [off(0), off(1)].as_flattened().iter().fold(0.0, |worst, off| f64::max(worst, off.abs()))
}

/// A mirrored pair feels the mirrored forces, to the bit.
#[test]
fn the_law_is_mirror_symmetric() {
    for contact in contacts() {
        for discs in random_pairs(6, 500) {
            assert_eq!(asymmetry(&varying::<true>(contact), discs), 0.0, "{discs:?}");
        }
    }
}

/// Two discs that touch along x, 5 % deep, at rest.
fn touching() -> [Placed; 2] {
    [Placed::at(0.0, 0.0), Placed::at(1.9, 0.0)]
}

/// Opposite spins that roll on each other, whatever the radii.
fn gear_pair(radius: f64) -> [Placed; 2] {
    let mut discs = touching();
    discs[1].radius = radius;
    discs[1].position[0] += radius - 1.0;
    discs[0].omega = 3.0;
    discs[1].omega = -3.0 / radius;
    discs
}

/// Gears that roll on each other feel no shear force and no torque; equal spins rub.
#[test]
fn a_gear_pair_does_not_rub_and_equal_spins_do() {
    for arm in [ContactArm::Radius, ContactArm::Overlap] {
        let law = varying::<true>(Contact { arm, ..CONTACT });
        let (normal, shear) = normal_and_shear(&law, gear_pair(1.0));
        assert!(normal > 1.0);
        assert_eq!(shear, 0.0);
        assert_eq!(meet(&law, gear_pair(1.0)).map(|sums| sums[2]), [0.0, 0.0]);
        let mut rubbing = gear_pair(1.0);
        rubbing[1].omega = 3.0;
        // The first disc's surface faces its partner at +x and moves up: it is pushed down.
        assert!(normal_and_shear(&law, rubbing).1.abs() > 0.5);
        assert!(meet(&law, rubbing)[0][1] < -0.5 && meet(&law, rubbing)[1][1] > 0.5);
        assert!(meet(&law, rubbing).iter().all(|sums| sums[2] < -0.5), "rubbing slows both spins");
    }
    let law = varying::<true>(CONTACT);
    for radius in [0.9, 1.05, 1.1] {
        assert!(normal_and_shear(&law, gear_pair(radius)).1.abs() < 1e-14);
    }
}

/// Discs that separate fast: clamped, the normal force is zero; unclamped, it pulls. Slow ones repel either
/// way.
#[test]
fn only_the_unclamped_law_pulls() {
    let mut pulled = 0;
    for mut discs in random_pairs(7, 1000) {
        let (_, n, _) = geometry(&discs);
        let [clamped, free] = [true, false]
            .map(|cohesionless| varying::<true>(Contact { cohesionless, normal_damping: 40.0, ..CONTACT }));
        let (held, drawn) = (normal_and_shear(&clamped, discs).0, normal_and_shear(&free, discs).0);
        assert!(held >= -1e-13, "{held}");
        assert!((held - drawn.max(0.0)).abs() < 1e-12, "{held} for {drawn}");
        pulled += usize::from(drawn < 0.0);
        discs[0].velocity = n.map(|n| 10.0 * n);
        discs[1].velocity = [0.0; 2];
        assert_eq!(meet(&clamped, discs), [[0.0; 3]; 2], "no normal force, hence no friction");
        assert!(normal_and_shear(&free, discs).0 < -1.0);
    }
    assert!(pulled > 100, "{pulled}");
}

/// A fixed disc has infinite mass: the effective mass is the other's, half of it being that of a like pair.
#[test]
fn a_fixed_disc_gives_the_effective_mass_of_the_other() {
    let contact = Contact { cohesionless: false, friction: 1e6, ..CONTACT };
    let law = varying::<true>(contact);
    for mut discs in random_pairs(8, 200) {
        let mass = 1.0 / discs[0].inverse_mass;
        let (depth, n, _) = geometry(&discs);
        let apart = [0, 1].map(|axis| discs[0].velocity[axis] - discs[1].velocity[axis]);
        let elastic = contact.stiffness * depth.powf(1.5);
        for (inverse_mass, effective) in [(0.0, mass), (1.0 / mass, 0.5 * mass)] {
            discs[1].inverse_mass = inverse_mass;
            for discs in [discs, [discs[1], discs[0]]] {
                let (normal, shear) = normal_and_shear(&law, discs);
                let expected = elastic - contact.normal_damping * effective * dot(apart, n);
                assert!((normal - expected).abs() < 1e-12, "{normal} for {expected}");
                let expected = -contact.shear_damping * effective * slip(&discs);
                assert!((shear - expected).abs() < 1e-12, "{shear} for {expected}");
            }
        }
    }
}

/// Two fixed discs in contact, as in a wall: what they do to each other moves nothing, so it must be a
/// number.
fn fixed_pair(cohesionless: bool) -> [[f64; 3]; 2] {
    let discs = touching().map(|disc| Placed { inverse_mass: 0.0, ..disc });
    meet(&varying::<true>(Contact { cohesionless, ..CONTACT }), discs)
}

/// With the clamp, two fixed discs in contact feel finite forces.
#[test]
fn two_fixed_discs_in_contact_feel_numbers() {
    assert!(fixed_pair(true).as_flattened().iter().all(|f| f.is_finite()), "{:?}", fixed_pair(true));
}

/// Without the clamp the sums of two touching fixed discs may be no numbers; those of a grain beside them are.
#[test]
fn fixed_discs_in_contact_leave_the_forces_on_others_alone() {
    let case = Case {
        periodic: [false; 2],
        contact: Contact { cohesionless: false, ..CONTACT },
        ..Case::new(13, 9)
    };
    let frame = Frame { origin: [0.0; 2], edge: [1.1, 1.1] };
    let fixed = |x, y| Placed { inverse_mass: 0.0, ..Placed::at(x, y) };
    let discs = [Placed::at(6.0, 6.6), fixed(5.05, 5.0), fixed(6.95, 5.0)];
    let law = varying::<true>(case.contact);
    let mut system = System::<f64, f64>::placed(&case, frame, &discs);
    system.index(&case, &law, (Execution::Chained, InstructionSet::best()));
    system.forces::<_, false>(&case, &law, (Execution::Chained, InstructionSet::best())).unwrap();
    let on_grain = Sum::ALL.map(|sum| system.on_discs(sum)[0]);
    assert!(on_grain.iter().all(|f| f.is_finite()), "{on_grain:?}");
    assert!(on_grain[1] > 1.0, "the grain rests on both: {on_grain:?}");
}

// ---- the law as printed ---------------------------------------------------------------------------------

/// The contact law with one of the source's equations as printed: 14, 15, 16 or 10 (for (10)–(11)); 0 is
/// none.
#[derive(Clone)]
struct Printed<const EQUATION: u32>(Contact);

/// The normal force with the damping added, not subtracted.
type Printed14 = Printed<14>;
/// The shear force as the smaller of a signed number and the bound.
type Printed15 = Printed<15>;
/// The slip with opposite signs of the two spins.
type Printed16 = Printed<16>;
/// The shear force along (n_y, −n_x) with everything else along (−n_y, n_x).
type Printed10 = Printed<10>;

impl<const EQUATION: u32> Law<2> for Printed<EQUATION> {
    type Own<V: Copy> = [V; 2];

    fn sums(&self) -> &'static [Sum] {
        &Sum::ALL
    }
    fn fields(&self) -> &'static [Field] {
        &[Field::Vx, Field::Vy, Field::Omega, Field::Radius, Field::InverseMass]
    }
    fn own<E: Env<2>>(&self, env: E) -> [E::V; 2] {
        env.own_position()
    }

    fn pair<E: Env<2>>(&self, env: E, place: E::Place, own: &[E::V; 2]) {
        let number = |value: f64| env.uniform(value);
        let zero = number(0.0);
        let (one, radii) = (number(1.0), [env.own(Field::Radius), env.partner(Field::Radius, place)]);
        let [dx, dy] = env.displacement(*own, place);
        let distance = (dx * dx + dy * dy).sqrt();
        let depth = radii[0] + radii[1] - distance;
        let touch = depth.less_equal(zero).not();
        let depth = depth.max(zero);
        let (nx, ny) = (dx / distance, dy / distance);
        let (sx, sy) = (zero - ny, nx);
        let vx = env.own(Field::Vx) - env.partner(Field::Vx, place);
        let vy = env.own(Field::Vy) - env.partner(Field::Vy, place);
        let mass = one / (env.own(Field::InverseMass) + env.partner(Field::InverseMass, place));

        let damping = number(self.0.normal_damping) * mass * (vx * nx + vy * ny);
        let elastic = number(self.0.stiffness) * depth * depth.sqrt();
        let normal = if EQUATION == 14 { elastic + damping } else { elastic - damping };

        let turning = [0, 1].map(|disc| {
            let omega = if disc == 0 { env.own(Field::Omega) } else { env.partner(Field::Omega, place) };
            radii[disc] * omega
        });
        let along = vx * sx + vy * sy;
        let slip =
            if EQUATION == 16 { along + turning[0] - turning[1] } else { along - turning[0] - turning[1] };
        let viscous = number(self.0.shear_damping) * mass * slip;
        let limit = number(self.0.friction) * normal.abs();
        let shear = if EQUATION == 15 {
            (zero - viscous).min(limit)
        } else {
            let size = viscous.abs().min(limit);
            E::V::select(slip.less_than(zero), size, zero - size)
        };
        let (tx, ty) = if EQUATION == 10 { (ny, zero - nx) } else { (sx, sy) };

        let force = [normal * nx + shear * tx, normal * ny + shear * ty];
        for (sum, value) in [Sum::Fx, Sum::Fy].into_iter().zip(force) {
            let value = E::V::select(touch, value, zero);
            env.own_add(sum, value);
            env.partner_sub(sum, place, value);
        }
        let shear = E::V::select(touch, shear, zero);
        env.own_add(Sum::Torque, zero - radii[0] * shear);
        env.partner_sub(Sum::Torque, place, radii[1] * shear);
    }
}

/// The control of the tests below: with no equation as printed, their law is ours.
#[test]
fn without_a_misprint_the_tests_law_is_ours() {
    let contact = Contact { cohesionless: false, ..CONTACT };
    for discs in random_pairs(9, 500) {
        let (ours, theirs) = (meet(&varying::<true>(contact), discs), meet(&Printed::<0>(contact), discs));
        for (ours, theirs) in ours.as_flattened().iter().zip(theirs.as_flattened()) {
            assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
        }
    }
}

/// Kinetic energy, of motion and spin (I = ½ M R²).
fn kinetic(discs: &[Placed; 2]) -> f64 {
    let energy = |disc: &Placed| {
        let spin = 0.5 * (disc.radius * disc.omega).powi(2);
        0.5 / disc.inverse_mass * (dot(disc.velocity, disc.velocity) + spin)
    };
    energy(&discs[0]) + energy(&discs[1])
}

/// Two discs through a collision, by Runge and Kutta's method; calls `watch` after every step.
fn collide<L: Law<2>>(
    law: &L,
    mut discs: [Placed; 2],
    time: f64,
    mut watch: impl FnMut(&[Placed; 2]),
) -> [Placed; 2] {
    type Rates = [[f64; 5]; 2];
    let dt = 1e-4;
    let rates = |discs: &[Placed; 2]| -> Rates {
        let sums = meet(law, *discs);
        std::array::from_fn(|i| {
            let Placed { velocity: [vx, vy], inverse_mass: w, radius, .. } = discs[i];
            [vx, vy, sums[i][0] * w, sums[i][1] * w, sums[i][2] * 2.0 * w / (radius * radius)]
        })
    };
    let moved = |discs: &[Placed; 2], rates: &Rates, dt: f64| -> [Placed; 2] {
        std::array::from_fn(|i| {
            let (disc, rate) = (discs[i], rates[i]);
            Placed {
                position: [disc.position[0] + dt * rate[0], disc.position[1] + dt * rate[1]],
                velocity: [disc.velocity[0] + dt * rate[2], disc.velocity[1] + dt * rate[3]],
                omega: disc.omega + dt * rate[4],
                ..disc
            }
        })
    };
    for _ in 0..(time / dt) as usize {
        let first = rates(&discs);
        let second = rates(&moved(&discs, &first, 0.5 * dt));
        let third = rates(&moved(&discs, &second, 0.5 * dt));
        let fourth = rates(&moved(&discs, &third, dt));
        let mean = std::array::from_fn(|i| {
            std::array::from_fn(|k| {
                (first[i][k] + 2.0 * second[i][k] + 2.0 * third[i][k] + fourth[i][k]) / 6.0
            })
        });
        discs = moved(&discs, &mean, dt);
        watch(&discs);
    }
    discs
}

/// Kinetic energy before and after a collision at unit relative speeds, `offset` off the head-on line.
fn energies<L: Law<2>>(law: &L, offset: f64, stiffness: Option<f64>) -> (f64, f64) {
    let speed = 0.5f64.sqrt();
    let mut discs = [Placed::at(-1.1, 0.5 * offset), Placed::at(1.1, -0.5 * offset)];
    discs[0].velocity[0] = speed;
    discs[1].velocity[0] = -speed;
    let before = kinetic(&discs);
    let mut total = before;
    let after = collide(law, discs, 3.0, |discs| {
        // Where the caller says the stiffness, energy including the elastic part must never grow.
        if let Some(stiffness) = stiffness {
            let elastic = 0.4 * stiffness * geometry(discs).0.max(0.0).powf(2.5);
            let now = kinetic(discs) + elastic;
            assert!(now <= total + 1e-10, "energy grew from {total} to {now}");
            total = now;
        }
    });
    assert!(geometry(&after).0 < 0.0, "the collision must be over");
    (before, kinetic(&after))
}

/// (14) as printed feeds energy in: a frictionless head-on collision ends faster than it began. Ours ends
/// slower, and without damping as fast.
#[test]
fn printed_14_makes_kinetic_energy_grow_in_a_head_on_collision() {
    let contact =
        Contact { normal_damping: 0.18, friction: 0.0, shear_damping: 0.0, cohesionless: false, ..CONTACT };
    let (before, printed) = energies(&Printed14::from(contact), 0.0, None);
    let (_, ours) = energies(&varying::<true>(contact), 0.0, Some(contact.stiffness));
    let elastic = Contact { normal_damping: 0.0, ..contact };
    let (_, undamped) = energies(&varying::<true>(elastic), 0.0, Some(contact.stiffness));
    println!("kinetic energy {before:.3}: printed (14) {printed:.3}, ours {ours:.3}, undamped {undamped:.6}");
    assert!(printed > 1.01 * before, "{printed}");
    assert!(ours < 0.99 * before, "{ours}");
    assert!((undamped - before).abs() < 1e-6, "{undamped}");
}

impl<const EQUATION: u32> From<Contact> for Printed<EQUATION> {
    fn from(contact: Contact) -> Self {
        Printed(contact)
    }
}

/// (15) as printed bounds a force that is positive and lets a negative one grow: a sliding contact breaks the
/// Coulomb bound for v_t > 0, keeps it for v_t < 0, and is not its own mirror image.
#[test]
fn printed_15_bounds_one_side_only() {
    let contact = Contact { shear_damping: 1000.0, cohesionless: false, ..CONTACT };
    let (printed, ours) = (Printed15::from(contact), varying::<true>(contact));
    for speed in [1.0, -1.0] {
        let mut discs = touching();
        discs[0].velocity[1] = speed;
        let slip = slip(&discs);
        let excess = |(normal, shear): (f64, f64)| shear.abs() / (contact.friction * normal.abs());
        let (theirs, here) =
            (excess(normal_and_shear(&printed, discs)), excess(normal_and_shear(&ours, discs)));
        println!("slip {slip:+}: |F_S| / (mu |F_N|) printed (15) {theirs:.2}, ours {here:.2}");
        assert!((here - 1.0).abs() < 1e-12, "{here}");
        if slip > 0.0 {
            assert!(theirs > 10.0, "{theirs}");
        } else {
            assert!((theirs - 1.0).abs() < 1e-12, "{theirs}");
        }
        assert!(asymmetry(&printed, discs) > 10.0);
        assert_eq!(asymmetry(&ours, discs), 0.0);
    }
}

/// (16) as printed lets a gear pair slip and equal spins not.
#[test]
fn printed_16_makes_a_gear_pair_slip() {
    let contact = Contact { cohesionless: false, ..CONTACT };
    let (printed, ours) = (Printed16::from(contact), varying::<true>(contact));
    let mut rubbing = gear_pair(1.0);
    rubbing[1].omega = rubbing[0].omega;
    let shear = |discs| (normal_and_shear(&printed, discs).1, normal_and_shear(&ours, discs).1);
    println!(
        "shear force (printed, ours): gear pair {:?}, equal spins {:?}",
        shear(gear_pair(1.0)),
        shear(rubbing)
    );
    assert!(shear(gear_pair(1.0)).0.abs() > 0.5);
    assert_eq!(shear(gear_pair(1.0)).1, 0.0);
    assert_eq!(shear(rubbing).0, 0.0);
    assert!(shear(rubbing).1.abs() > 0.5);
}

/// (16) as printed makes energy grow in an oblique collision without normal damping; ours loses some.
#[test]
fn printed_16_makes_energy_grow_in_an_oblique_collision() {
    let contact =
        Contact { normal_damping: 0.0, shear_damping: 40.0, friction: 5.0, cohesionless: false, ..CONTACT };
    let (before, printed) = energies(&Printed16::from(contact), 1.4, None);
    let (_, ours) = energies(&varying::<true>(contact), 1.4, Some(contact.stiffness));
    println!("kinetic energy {before:.3}: printed (16) {printed:.3}, ours {ours:.3}");
    assert!(printed > 1.01 * before, "{printed}");
    assert!(ours < 0.99 * before, "{ours}");
}

/// (10)–(11) as printed, with the tangent (n_y, −n_x), give the pair −(2(R_i + R_j) − ξ) F_S of angular
/// momentum where the rule is −ξ F_S; a collision ends with another angular momentum than it began with.
#[test]
fn printed_10_and_11_break_the_rule_of_angular_momentum() {
    let contact = Contact { cohesionless: false, ..CONTACT };
    let mut largest = 0.0f64;
    for discs in random_pairs(10, 500) {
        let (depth, ..) = geometry(&discs);
        // The shear force proper: the torque on the first disc is −R F_S in either law.
        let law = Printed10::from(contact);
        let shear = -meet(&law, discs)[0][2] / discs[0].radius;
        let arms = 2.0 * (discs[0].radius + discs[1].radius) - depth;
        assert!((torque(&law, discs) + arms * shear).abs() < 1e-12);
        let off = |found: f64| (found + depth * shear).abs();
        assert!(off(torque(&varying::<true>(contact), discs)) < 1e-12);
        largest = largest.max(off(torque(&law, discs)));
        assert!(off(torque(&law, discs)) > 3.0 * shear.abs());
    }
    println!("printed (10)-(11): off the rule by up to {largest:.2}");
    assert!(largest > 1.0);
}

/// Discs that are all alike need no arrays of radii and masses: the same forces from the law's own numbers.
#[test]
fn equal_discs_feel_what_varying_ones_of_one_kind_do() {
    for contact in contacts() {
        let disc = Disc { radius: 1.05, inverse_mass: 0.4 };
        let alike = Granular::<true, true> { contact, disc };
        for discs in random_pairs(12, 200) {
            let discs = discs.map(|d| Placed { radius: disc.radius, inverse_mass: disc.inverse_mass, ..d });
            assert_eq!(meet(&alike, discs), meet(&varying::<true>(contact), discs));
        }
    }
}
