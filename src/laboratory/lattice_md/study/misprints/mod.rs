//! Each misprint of BP93's contact law: pairs of discs under the law as printed and under the law that runs.

mod as_printed;
#[cfg(test)]
mod tests;

use crate::console::Failure;
use crate::frame::Rows;
use crate::results::{Lab, Made, Size};
use as_printed::{AsPrinted, Misprint};
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::noise::{Purpose, Stream};
use stripmine_kernels::sweep::pair::Pair;

/// A quantity that tells the printed law from the one that runs.
struct Finding {
    misprint: Misprint,
    quantity: &'static str,
    /// Parameters of the law, and of the pair where it has some.
    setting: String,
    right: Right,
    by_printed: f64,
    by_ours: f64,
}

/// Value where the law is right.
#[derive(Clone, Copy, Debug)]
enum Right {
    Equal(f64),
    AtMost(f64),
}

/// Energy, kinetic and elastic, at a moment of the head-on collision: with (14) as printed, with ours, and with ours undamped, by
/// which the integrator is judged.
struct Energy {
    time: f64,
    printed: f64,
    ours: f64,
    undamped: f64,
}

/// |F_S| / (μ|F_N|) of a sliding contact with (15) as printed and with ours.
struct CoulombRatio {
    slip: f64,
    printed: f64,
    ours: f64,
}

/// BP93's stiffness and friction, damping weak enough for discs of mass 1 to bounce, and its form of the law: separating discs may
/// pull.
const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 100.0,
    normal_damping: 3.0,
    shear_damping: 2.0,
    friction: 0.5,
    cohesionless: false,
    arm: ContactArm::Radius,
};
/// Damping so weak that (14) as printed adds a small part of the energy in a collision.
const HEAD_ON: Contact = Contact { normal_damping: 0.175, shear_damping: 0.0, friction: 0.0, ..CONTACT };
/// Slips reach the Coulomb bound in the middle of their range.
const SLIDING: Contact = Contact { shear_damping: 10.0, ..CONTACT };
/// Spins change a lot, and nothing else takes energy.
const OBLIQUE: Contact = Contact { normal_damping: 0.0, shear_damping: 40.0, friction: 5.0, ..CONTACT };

/// Steps of the Runge–Kutta method in a unit of time.
const STEPS: usize = 10_000;
/// Steps of the head-on collision: it is over by then.
const HEAD_ON_STEPS: usize = 7_000;
/// Steps between the moments that are kept of it.
const MOMENT: usize = 50;
/// Steps of the oblique collision.
const OBLIQUE_STEPS: usize = 12_000;
/// Distance of the two lines of flight.
const OBLIQUE_OFFSET: f64 = 1.4;
/// Largest slip velocity that is tried, to either side.
const LARGEST_SLIP: f64 = 2.0;
/// Slips tried on either side.
const SLIPS: i32 = 40;
/// Random pairs.
const PAIRS: usize = 500;
/// Their seed.
const SEED: u64 = 1993;

/// Tries every misprint.
///
/// # Errors
/// None.
pub(crate) fn made(_: &Lab<'_>, _: Size) -> Result<Made, Failure> {
    let (head_on, sliding) = (head_on(), sliding());
    Ok(Made::of([
        Rows::of(findings(&head_on, &sliding))
            .text("equation", |it| it.misprint.equation())
            .text("as printed", |it| it.misprint.forms()[0])
            .text("as it runs", |it| it.misprint.forms()[1])
            .text("what shows it", |it| it.quantity)
            .text("with", |it| it.setting.clone())
            .text("right is", |it| if matches!(it.right, Right::Equal(_)) { "equal to" } else { "at most" })
            .number("right", 3, |it| match it.right {
                Right::Equal(value) | Right::AtMost(value) => value,
            })
            .number("printed gives", 3, |it| it.by_printed)
            .number("ours gives", 3, |it| it.by_ours)
            .frame("misprints", "Equations that do not work as printed"),
        Rows::of(&head_on)
            .number("time", 3, |it| it.time)
            .number("printed", 4, |it| it.printed)
            .number("ours", 4, |it| it.ours)
            .number("undamped", 6, |it| it.undamped)
            .frame("head_on", "Energy through the head-on collision of (14)"),
        Rows::of(&sliding)
            .number("slip", 2, |it| it.slip)
            .number("printed", 3, |it| it.printed)
            .number("ours", 3, |it| it.ours)
            .frame("sliding", "Shear force over its bound in the sliding contact of (15)"),
    ])
    .with_seeds([SEED]))
}

fn findings(head_on: &[Energy], sliding: &[CoulombRatio]) -> [Finding; 6] {
    [angular_momentum(), head_on_energy(head_on), coulomb_bound(sliding), mirror(), gears(), oblique()]
}

fn finding(
    misprint: Misprint,
    quantity: &'static str,
    setting: String,
    right: Right,
    [by_printed, by_ours]: [f64; 2],
) -> Finding {
    Finding { misprint, quantity, setting, right, by_printed, by_ours }
}

fn setting(contact: Contact) -> String {
    let Contact { stiffness, normal_damping, shear_damping, friction, .. } = contact;
    format!("k_N = {stiffness}, γ_N = {normal_damping}, γ_S = {shear_damping}, μ = {friction}")
}

/// The largest of the values; no number if one of them is none.
fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).max_by(f64::total_cmp).unwrap_or(f64::NAN)
}

fn printed(misprint: Misprint, contact: Contact) -> AsPrinted {
    AsPrinted { contact, misprint: Some(misprint) }
}

/// The law that runs, for discs that may differ.
fn ours(contact: Contact) -> Granular<true, false> {
    Granular { contact, disc: Disc { radius: f64::NAN, inverse_mass: f64::NAN } }
}

/// d(L_orbital + L_spin)/dt = −ξ F_S, where the torque on the own disc is −R F_S.
fn angular_momentum() -> Finding {
    fn off<L: Law<2>>(law: &L) -> f64 {
        let mut random = Stream::new(SEED, Purpose::Placement, 0);
        let pairs = (0..PAIRS).map(|_| Pair::random(&mut random));
        largest(pairs.map(|pair| {
            let [[_, _, torque], _] = pair.sums(law);
            let shear = -torque / pair.bodies[0].radius;
            pair.angular_momentum_rate(law) + pair.depth() * shear
        }))
    }
    finding(
        Misprint::Tangent,
        "largest |dL/dt + ξ F_S| of random pairs in contact",
        format!("{}; {PAIRS} pairs", setting(CONTACT)),
        Right::Equal(0.0),
        [off(&printed(Misprint::Tangent, CONTACT)), off(&ours(CONTACT))],
    )
}

/// Elastic energy of a contact, ⅖ k_N ξ^{5/2}: written here apart, because it judges the laws.
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
    let damped = printed.into_iter().zip(energies(ours(HEAD_ON)));
    let undamped = energies(ours(Contact { normal_damping: 0.0, ..HEAD_ON }));
    let energies = damped.zip(undamped).enumerate().map(|(moment, ((printed, ours), undamped))| {
        let time = (moment * MOMENT) as f64 / STEPS as f64;
        Energy { time, printed, ours, undamped }
    });
    energies.collect()
}

/// Discs that have parted hold no elastic energy: the last of the energies is all kinetic.
fn head_on_energy(energies: &[Energy]) -> Finding {
    finding(
        Misprint::NormalDamping,
        "kinetic energy after a frictionless head-on collision",
        setting(HEAD_ON),
        Right::AtMost(Pair::colliding(0.0).kinetic_energy()),
        energies.last().map_or([f64::NAN; 2], |last| [last.printed, last.ours]),
    )
}

/// Discs that touch, the first of them moving along the tangent.
fn slide(slip: f64) -> Pair {
    let mut pair = Pair::touching();
    pair.bodies[0].velocity = pair.tangent().map(|component| slip * component);
    pair
}

fn slips() -> impl Iterator<Item = f64> {
    (-SLIPS..=SLIPS).map(|step| LARGEST_SLIP * f64::from(step) / f64::from(SLIPS))
}

fn sliding() -> Vec<CoulombRatio> {
    fn ratio<L: Law<2>>(pair: &Pair, law: &L) -> f64 {
        let [normal, shear] = pair.normal_and_shear(law);
        shear.abs() / (SLIDING.friction * normal.abs())
    }
    let (printed, ours) = (printed(Misprint::CoulombBound, SLIDING), ours(SLIDING));
    slips()
        .map(|slip| {
            let pair = slide(slip);
            CoulombRatio { slip, printed: ratio(&pair, &printed), ours: ratio(&pair, &ours) }
        })
        .collect()
}

fn sliding_setting() -> String {
    format!("{}; v_t from −{LARGEST_SLIP} to {LARGEST_SLIP}", setting(SLIDING))
}

fn coulomb_bound(sliding: &[CoulombRatio]) -> Finding {
    finding(
        Misprint::CoulombBound,
        "largest |F_S| / (μ|F_N|) of a sliding contact",
        sliding_setting(),
        Right::AtMost(1.0),
        [largest(sliding.iter().map(|at| at.printed)), largest(sliding.iter().map(|at| at.ours))],
    )
}

fn mirror() -> Finding {
    fn asymmetry<L: Law<2>>(law: L) -> f64 {
        largest(slips().map(|slip| slide(slip).asymmetry(&law)))
    }
    finding(
        Misprint::CoulombBound,
        "largest difference between a sliding contact's forces mirrored and those of its mirror image",
        sliding_setting(),
        Right::Equal(0.0),
        [asymmetry(printed(Misprint::CoulombBound, SLIDING)), asymmetry(ours(SLIDING))],
    )
}

fn gears() -> Finding {
    fn shear<L: Law<2>>(law: L) -> f64 {
        let [_, shear] = Pair::gears(1.0).normal_and_shear(&law);
        shear.abs()
    }
    finding(
        Misprint::Slip,
        "|F_S| between gears that roll on each other",
        setting(CONTACT),
        Right::Equal(0.0),
        [shear(printed(Misprint::Slip, CONTACT)), shear(ours(CONTACT))],
    )
}

fn oblique() -> Finding {
    fn energy<L: Law<2>>(law: L) -> f64 {
        let end = path(Pair::colliding(OBLIQUE_OFFSET), &law).nth(OBLIQUE_STEPS);
        end.map_or(f64::NAN, |pair| pair.kinetic_energy())
    }
    finding(
        Misprint::Slip,
        "kinetic energy after an oblique collision",
        format!("{}; lines of flight {OBLIQUE_OFFSET} apart", setting(OBLIQUE)),
        Right::AtMost(Pair::colliding(OBLIQUE_OFFSET).kinetic_energy()),
        [energy(printed(Misprint::Slip, OBLIQUE)), energy(ours(OBLIQUE))],
    )
}
