//! Misprints of BP93's contact law: pairs of discs under the printed law and under the corrected law.

mod as_printed;
#[cfg(test)]
mod tests;

use crate::console::CommandFailure;
use crate::frame::{FrameBuilder, TableCell};
use crate::results::{FinishedItem, StudyEnvironment, StudySize};
use as_printed::{AsPrinted, Misprint};
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::{Contact, ContactArm, EqualDiscs, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::noise::{RandomPurpose, Stream};
use stripmine_kernels::sweep::pair::Pair;

/// Quantity that distinguishes the printed law from the corrected law.
struct MisprintFinding {
    misprint: Misprint,
    quantity: &'static str,
    /// Parameters of the law and, if any, of the pair.
    setting: String,
    /// Correct value: "equal to" or "at most" a number.
    right: (&'static str, f64),
    /// Values with the printed law and with the corrected law.
    by: [f64; 2],
}

/// Time and kinetic plus elastic energy of the head-on collision: with (14) as printed, with the corrected law, and with the corrected law
/// without damping, which tests the integrator.
type Energy = [f64; 4];

/// Slip velocity and |F_S| / (μ|F_N|) of a contact, with (15) as printed and with the corrected law.
type CoulombRatio = [f64; 3];

/// BP93's stiffness and friction, with damping weak enough for discs of mass 1 to bounce. As in BP93, separating discs may attract.
const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 100.0,
    normal_damping: 3.0,
    shear_damping: 2.0,
    friction: 0.5,
    cohesionless: false,
    arm: ContactArm::Radius,
};
/// Damping so weak that (14) as printed adds only a small part of the energy in a collision.
const HEAD_ON: Contact = Contact { normal_damping: 0.175, shear_damping: 0.0, friction: 0.0, ..CONTACT };
/// Slip velocities reach the Coulomb bound in the middle of their range.
const SLIDING: Contact = Contact { shear_damping: 10.0, ..CONTACT };
/// Spins change strongly, and only shear damping dissipates energy.
const OBLIQUE: Contact = Contact { normal_damping: 0.0, shear_damping: 40.0, friction: 5.0, ..CONTACT };

/// Steps of the Runge–Kutta method per unit of time.
const STEPS: usize = 10_000;
/// Steps of the head-on collision, enough for the discs to separate.
const HEAD_ON_STEPS: usize = 7_000;
/// Steps between the recorded moments.
const MOMENT: usize = 50;
/// Steps of the oblique collision, enough for the discs to separate.
const OBLIQUE_STEPS: usize = 12_000;
/// Distance of the two lines of flight.
const OBLIQUE_OFFSET: f64 = 1.4;
/// Largest slip velocity in either direction.
const LARGEST_SLIP: f64 = 2.0;
/// Number of slip velocities in either direction.
const SLIPS: i32 = 40;
/// Number of random pairs.
const PAIRS: usize = 500;
/// Seed of the random pairs.
const SEED: u64 = 1993;

/// Tests every misprint.
pub(crate) fn reproduce(_: &StudyEnvironment<'_>, _: StudySize) -> Result<FinishedItem, CommandFailure> {
    let (head_on, sliding) = (head_on(), sliding());
    let findings = FrameBuilder::of(findings(&head_on, &sliding))
        .cells(["equation", "as printed", "as it runs"], |it| it.misprint.words())
        .text("what shows it", |it| it.quantity)
        .text("with", |it| it.setting.clone())
        .text("right is", |it| it.right.0)
        .number("right", 3, |it| it.right.1)
        .number("printed gives", 3, |it| it.by[0])
        .number("ours gives", 3, |it| it.by[1])
        .frame("misprints", "Equations that do not work as printed");
    let numbers = |row: &[f64]| row.iter().map(|it| TableCell::Number(*it, 6)).collect::<Vec<_>>();
    Ok(FinishedItem::of([
        findings,
        FrameBuilder::of(&head_on)
            .cells(["time", "printed", "ours", "undamped"], |it| numbers(*it))
            .frame("head_on", "Energy through the head-on collision of (14)"),
        FrameBuilder::of(&sliding)
            .cells(["slip", "printed", "ours"], |it| numbers(*it))
            .frame("sliding", "Shear force over its bound in the sliding contact of (15)"),
    ])
    .with_seeds([SEED]))
}

fn findings(head_on: &[Energy], sliding: &[CoulombRatio]) -> [MisprintFinding; 6] {
    use Misprint::{CoulombBound, NormalDamping, Slip, Tangent};
    let start = |offset: f64| ("at most", Pair::colliding(offset).kinetic_energy());
    let exact = ("equal to", 0.0);
    let last = head_on[head_on.len() - 1];
    let slips = format!("{}; v_t from −{LARGEST_SLIP} to {LARGEST_SLIP}", setting(SLIDING));
    let finding =
        |misprint, quantity, setting, right, by| MisprintFinding { misprint, quantity, setting, right, by };
    [
        finding(
            Tangent,
            "largest |dL/dt + ξ F_S| of random pairs in contact",
            format!("{}; {PAIRS} pairs", setting(CONTACT)),
            exact,
            [angular_momentum_error(&printed(Tangent, CONTACT)), angular_momentum_error(&ours(CONTACT))],
        ),
        // Separated discs have no elastic energy.
        finding(
            NormalDamping,
            "kinetic energy after a frictionless head-on collision",
            setting(HEAD_ON),
            start(0.0),
            [last[1], last[2]],
        ),
        finding(
            CoulombBound,
            "largest |F_S| / (μ|F_N|) of a sliding contact",
            slips.clone(),
            ("at most", 1.0),
            [1, 2].map(|law| largest(sliding.iter().map(|at| at[law]))),
        ),
        finding(
            CoulombBound,
            "largest difference between a sliding contact's forces mirrored and those of its mirror image",
            slips,
            exact,
            [asymmetry(&printed(CoulombBound, SLIDING)), asymmetry(&ours(SLIDING))],
        ),
        finding(
            Slip,
            "|F_S| between gears that roll on each other",
            setting(CONTACT),
            exact,
            [rolling_shear(&printed(Slip, CONTACT)), rolling_shear(&ours(CONTACT))],
        ),
        finding(
            Slip,
            "kinetic energy after an oblique collision",
            format!("{}; lines of flight {OBLIQUE_OFFSET} apart", setting(OBLIQUE)),
            start(OBLIQUE_OFFSET),
            [energy_after(&printed(Slip, OBLIQUE)), energy_after(&ours(OBLIQUE))],
        ),
    ]
}

fn setting(contact: Contact) -> String {
    let Contact { stiffness, normal_damping, shear_damping, friction, .. } = contact;
    format!("k_N = {stiffness}, γ_N = {normal_damping}, γ_S = {shear_damping}, μ = {friction}")
}

/// Largest magnitude; NaN if a value is NaN or there is none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

fn printed(misprint: Misprint, contact: Contact) -> AsPrinted {
    AsPrinted { contact, misprint: Some(misprint) }
}

/// Corrected law for different discs.
fn ours(contact: Contact) -> Granular<true, false> {
    Granular { contact, disc: EqualDiscs { radius: f64::NAN, inverse_mass: f64::NAN } }
}

/// Largest error of d(L_orbital + L_spin)/dt = −ξ F_S, with −R F_S the torque on the first disc.
fn angular_momentum_error<L: Law<2>>(law: &L) -> f64 {
    let mut random = Stream::new(SEED, RandomPurpose::Placement, 0);
    let pairs = (0..PAIRS).map(|_| Pair::random(&mut random));
    largest(pairs.map(|pair| {
        let [[_, _, torque], _] = pair.sums(law);
        let shear = -torque / pair.bodies[0].radius;
        pair.angular_momentum_rate(law) + pair.depth() * shear
    }))
}

/// Elastic energy of a contact, ⅖ k_N ξ^{5/2}. Independent of the laws, because it judges them.
fn elastic_energy(pair: &Pair, stiffness: f64) -> f64 {
    let depth = pair.depth().max(0.0);
    0.4 * stiffness * (depth * depth * depth.sqrt())
}

fn path<L: Law<2>>(start: Pair, law: &L) -> impl Iterator<Item = Pair> {
    start.trajectory(law, 1.0 / STEPS as f64)
}

fn head_on() -> Vec<Energy> {
    fn energies<L: Law<2>>(law: L) -> Vec<f64> {
        let moments = path(Pair::colliding(0.0), &law).step_by(MOMENT).take(HEAD_ON_STEPS / MOMENT + 1);
        moments.map(|pair| pair.kinetic_energy() + elastic_energy(&pair, HEAD_ON.stiffness)).collect()
    }
    let printed = energies(printed(Misprint::NormalDamping, HEAD_ON));
    let damped = energies(ours(HEAD_ON));
    let undamped = energies(ours(Contact { normal_damping: 0.0, ..HEAD_ON }));
    let time = |moment: usize| (moment * MOMENT) as f64 / STEPS as f64;
    (0..printed.len()).map(|at| [time(at), printed[at], damped[at], undamped[at]]).collect()
}

/// Touching discs, the first of which moves along the tangent.
fn slide(slip: f64) -> Pair {
    let mut pair = Pair::touching();
    pair.bodies[0].velocity = pair.tangent().map(|component| slip * component);
    pair
}

fn slips() -> impl Iterator<Item = f64> {
    (-SLIPS..=SLIPS).map(|step| LARGEST_SLIP * f64::from(step) / f64::from(SLIPS))
}

fn sliding() -> Vec<CoulombRatio> {
    fn ratio<L: Law<2>>(slip: f64, law: &L) -> f64 {
        let [normal, shear] = slide(slip).normal_and_shear(law);
        shear.abs() / (SLIDING.friction * normal.abs())
    }
    let (printed, ours) = (printed(Misprint::CoulombBound, SLIDING), ours(SLIDING));
    slips().map(|slip| [slip, ratio(slip, &printed), ratio(slip, &ours)]).collect()
}

fn asymmetry<L: Law<2>>(law: &L) -> f64 {
    largest(slips().map(|slip| slide(slip).asymmetry(law)))
}

fn rolling_shear<L: Law<2>>(law: &L) -> f64 {
    let [_, shear] = Pair::gears(1.0).normal_and_shear(law);
    shear.abs()
}

/// Kinetic energy after the oblique collision.
fn energy_after<L: Law<2>>(law: &L) -> f64 {
    let end = path(Pair::colliding(OBLIQUE_OFFSET), law).nth(OBLIQUE_STEPS);
    end.map_or(f64::NAN, |pair| pair.kinetic_energy())
}
