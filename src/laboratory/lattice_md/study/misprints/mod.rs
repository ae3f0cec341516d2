//! What does each misprint of BP93's contact law do? Pairs of discs under the law as printed and under the law that runs.

mod as_printed;
#[cfg(test)]
mod tests;

use as_printed::{AsPrinted, Misprint};
use serde::Serialize;
use stripmine_kernels::law::Law;
use stripmine_kernels::law::granular::{Contact, ContactArm, Disc, Granular};
use stripmine_kernels::law::spring::Spring;
use stripmine_kernels::noise::{Purpose, Stream};
use stripmine_kernels::sweep::pair::Pair;

/// What a value must be where the law is right.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Right {
    /// This number.
    Equal(f64),
    /// This number or less.
    AtMost(f64),
}

impl Right {
    /// By how much a value is wrong; no number is never right.
    pub fn missed_by(self, value: f64) -> f64 {
        match self {
            Right::Equal(right) => (value - right).abs(),
            Right::AtMost(right) if value <= right => 0.0,
            Right::AtMost(right) => value - right,
        }
    }
}

/// What rounding may do to a value that is right.
const ROUNDING: f64 = 1e-9;
/// By how much a value must be wrong at least, to be seen in a table.
const VISIBLE: f64 = 0.01;

/// One quantity that tells the printed law from the one that runs.
#[derive(Clone, Debug, Serialize)]
pub struct Finding {
    /// The equation's number in the source.
    pub equation: &'static str,
    /// As the source prints it.
    pub printed: &'static str,
    /// As the law that runs has it.
    pub ours: &'static str,
    /// What is looked at.
    pub quantity: &'static str,
    /// Under which parameters of the law, and of the pair where it has some.
    pub setting: String,
    /// What it must be.
    pub right: Right,
    /// What it is with the equation as printed.
    pub by_printed: f64,
    /// What it is with ours.
    pub by_ours: f64,
}

impl Finding {
    /// Whether the printed form visibly fails.
    pub fn printed_fails(&self) -> bool {
        self.right.missed_by(self.by_printed) > VISIBLE
    }

    /// Whether ours holds, but for rounding.
    pub fn ours_holds(&self) -> bool {
        self.right.missed_by(self.by_ours) <= ROUNDING
    }
}

/// Energy, kinetic and elastic, at a moment of the head-on collision.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Energy {
    /// The moment.
    pub time: f64,
    /// With (14) as printed.
    pub printed: f64,
    /// With ours.
    pub ours: f64,
    /// With ours and no damping: what the integrator keeps.
    pub undamped: f64,
}

/// |F_S| / (μ|F_N|) of a sliding contact.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct CoulombRatio {
    /// Slip velocity v_t.
    pub slip: f64,
    /// With (15) as printed.
    pub printed: f64,
    /// With ours.
    pub ours: f64,
}

/// The dataset. Discs have radius and mass of about 1.
#[derive(Clone, Debug, Serialize)]
pub struct Misprints {
    /// What each misprint does, in the order of the equations.
    pub findings: Vec<Finding>,
    /// The head-on collision of (14), by time.
    pub head_on: Vec<Energy>,
    /// The sliding contact of (15), by slip.
    pub sliding: Vec<CoulombRatio>,
    /// Seed of the random pairs.
    pub seed: u64,
}

/// The source's stiffness and friction, damping weak enough for discs of mass 1 to bounce, and its form of the law:
/// separating discs may pull.
const CONTACT: Contact = Contact {
    spring: Spring::Hertz,
    stiffness: 100.0,
    normal_damping: 3.0,
    shear_damping: 2.0,
    friction: 0.5,
    cohesionless: false,
    arm: ContactArm::Radius,
};
/// Damping so weak that what (14) as printed adds in a collision is a small part of the energy.
const HEAD_ON: Contact = Contact { normal_damping: 0.175, shear_damping: 0.0, friction: 0.0, ..CONTACT };
/// The Coulomb bound is reached in the middle of the slips that are tried.
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
pub fn misprints() -> Misprints {
    let (head_on, sliding) = (head_on(), sliding());
    let findings = Misprint::ALL.iter().flat_map(|&misprint| match misprint {
        Misprint::Tangent => vec![angular_momentum()],
        Misprint::NormalDamping => vec![head_on_energy(&head_on)],
        Misprint::CoulombBound => vec![coulomb_bound(&sliding), mirror()],
        Misprint::Slip => vec![gears(), oblique()],
    });
    Misprints { findings: findings.collect(), head_on, sliding, seed: SEED }
}

/// An equation as printed and as it runs.
const fn forms(misprint: Misprint) -> [&'static str; 2] {
    match misprint {
        Misprint::Tangent => ["F += F_N n + F_S (n_y, −n_x)", "F += F_N n + F_S (−n_y, n_x)"],
        Misprint::NormalDamping => {
            ["F_N = k_N ξ^(3/2) + γ_N M_eff (v_i − v_j)", "F_N = k_N ξ^(3/2) − γ_N M_eff (v_i − v_j)·n"]
        }
        Misprint::CoulombBound => {
            ["F_S = min(−γ_S M_eff v_t, μ|F_N|)", "F_S = −sign(v_t) min(γ_S M_eff |v_t|, μ|F_N|)"]
        }
        Misprint::Slip => {
            ["v_t = (v_i − v_j) + R_i Ω_i − R_j Ω_j", "v_t = (v_i − v_j)·s − R_i Ω_i − R_j Ω_j"]
        }
    }
}

fn finding(
    misprint: Misprint,
    quantity: &'static str,
    setting: String,
    right: Right,
    [by_printed, by_ours]: [f64; 2],
) -> Finding {
    let [printed, ours] = forms(misprint);
    Finding { equation: misprint.equation(), printed, ours, quantity, setting, right, by_printed, by_ours }
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

/// Elastic energy of a contact, ⅖ k_N ξ^{5/2}: written here once more, for it judges the laws.
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
