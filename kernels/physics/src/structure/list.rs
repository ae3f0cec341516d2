//! List of the observables of the structure.

use super::waves;
use super::{
    AveragedFunction, FunctionArguments, FunctionReliability, Headline, SampleData, SamplingKind,
    StructureObservable,
};
use super::{diffusion, motion, neighbours, pairs, single};
use crate::number::significant;

/// Judgement that always accepts the function.
const SOUND: fn(&AveragedFunction<'_>) -> FunctionReliability = |_| FunctionReliability::Sound;
/// Bias of headlines with statistical error only.
const NO_BIAS: fn(&AveragedFunction<'_>) -> f64 = |_| 0.0;

/// Coordinates of a grid over the box.
const PLACES: &[[&str; 2]] = &[["x", "length"], ["y", "length"]];
/// Source of the definition of the stress.
const STRESS: &str = "Irving and Kirkwood 1950, each disc takes half of a pair (Thompson, Plimpton and Mattson 2009); velocities relative to the box";
/// Headline of a component of the stress.
const OVER_BOX: [Headline; 1] = [Headline {
    name: "mean over the box",
    unit: "force/length",
    of: |_, block| block.iter().sum::<f64>() / block.len() as f64,
    bias: NO_BIAS,
}];

/// All observables.
pub static OBSERVABLES: [StructureObservable; 20] = [
    StructureObservable {
        name: "g(r)",
        file: "g.csv",
        over: &[["r", "length"]],
        value: ["g", ""],
        doc: "Pairs at a distance over those of an ideal gas in the area that centres of discs can reach between closed sides and wall discs. With an open top the ideal gas has discs at the same heights, anywhere along the floor.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5; closed sides by the set covariance of a rectangle (Stoyan \
                 and Stoyan 1994)",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(pairs::distances),
            of: |it, values, weights| match &it.heights {
                Some(heights) => pairs::correlation_over(&it.distances, &heights.pairs, values, weights),
                None => pairs::correlation(&it.discs, &it.distances, &it.chances, values),
            },
            further: 0,
            asks: SampleData::Distances,
        },
        headlines: &[
            Headline {
                name: "height of the first peak",
                unit: "",
                of: |whole, block| block[first_peak(whole)],
                bias: NO_BIAS,
            },
            Headline {
                name: "place of the first peak",
                unit: "length",
                of: |whole, block| whole.over[peak_near(block, first_peak(whole))],
                bias: NO_BIAS,
            },
        ],
        judged: judge_peak,
    },
    StructureObservable {
        name: "S(k)",
        file: "s.csv",
        over: &[["kx", "1/length"], ["ky", "1/length"]],
        value: ["S", ""],
        doc: "The structure factor |Σ exp(ikr)|²/N, a line for each wave vector along a periodic axis of the box.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 4.1",
        seen: SamplingKind::Once {
            over: FunctionArguments::Waves,
            of: |it, values, _| waves::factor(&it.waves, values),
            further: 0,
            asks: SampleData::Waves,
        },
        headlines: &[
            Headline {
                name: "height of the main peak",
                unit: "",
                of: |whole, block| block[highest(whole)],
                bias: NO_BIAS,
            },
            Headline {
                name: "place of the main peak",
                unit: "1/length",
                of: |whole, block| whole.over[peak(&block[..whole.over.len()])],
                bias: NO_BIAS,
            },
        ],
        judged: SOUND,
    },
    StructureObservable {
        name: "coordination",
        file: "coordination.csv",
        over: &[["neighbours", ""]],
        value: ["share of discs", ""],
        doc: "Fractions of discs by their number of neighbours: others nearer than 1.5 times the sum of the radii.",
        source: "first minimum of g(r) of dense discs",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(neighbours::neighbour_numbers),
            of: |it, values, _| neighbours::coordination(&it.discs, &it.neighbours, values),
            further: 2,
            asks: SampleData::Neighbours,
        },
        headlines: &[Headline {
            name: "mean number of neighbours",
            unit: "",
            of: |whole, block| block[whole.over.len()],
            bias: NO_BIAS,
        }],
        judged: judge_lines,
    },
    StructureObservable {
        name: "psi6",
        file: "psi6.csv",
        over: &[["|psi6| of a disc", ""]],
        value: ["density", ""],
        doc: "Distribution of the hexatic order of single discs, ψ6 = ⟨exp(6iθ)⟩ over the six nearest discs, or over all others if there are fewer.",
        source: "Nelson and Halperin 1979; six nearest neighbours instead of Voronoi's",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(neighbours::orders),
            of: |it, values, _| neighbours::hexatic(&it.neighbours, values),
            further: 2,
            asks: SampleData::Neighbours,
        },
        headlines: &[
            Headline {
                name: "global order |Ψ6|",
                unit: "",
                of: |whole, block| block[whole.over.len()],
                bias: NO_BIAS,
            },
            Headline {
                name: "mean order of a disc",
                unit: "",
                of: |whole, block| block[whole.over.len() + 1],
                bias: NO_BIAS,
            },
        ],
        judged: SOUND,
    },
    StructureObservable {
        name: "velocities",
        file: "velocities.csv",
        over: &[["v/sqrt(kT/m)", ""]],
        value: ["density", ""],
        doc: "Distribution of both components of the velocity over √(kT/m), kT by the kinetic energy of the same moment.",
        source: "Maxwell 1860: the normal distribution in equilibrium",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::speeds),
            of: |it, values, weights| single::velocities(&it.discs, values, weights),
            further: 1,
            asks: SampleData::Discs,
        },
        headlines: &[Headline {
            name: "kurtosis",
            unit: "",
            of: |whole, block| block[whole.over.len()],
            bias: NO_BIAS,
        }],
        judged: SOUND,
    },
    StructureObservable {
        name: "density(x)",
        file: "density-x.csv",
        over: &[["x", "length"]],
        value: ["density", "1/length²"],
        doc: "Centres of discs by area in a hundred slices along the first axis; with an open top, by the area up to the highest centre of the moment.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5: the single-particle density, averaged across the axis",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<0>),
            of: |it, values, weights| single::density::<0>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "density(y)",
        file: "density-y.csv",
        over: &[["y", "length"]],
        value: ["density", "1/length²"],
        doc: "Centres of discs by area in a hundred slices along the second axis, up to the height of the scene's box.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 2.5: the single-particle density, averaged across the axis",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<1>),
            of: |it, values, weights| single::density::<1>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: judge_heights,
    },
    StructureObservable {
        name: "flow(x)",
        file: "flow-x.csv",
        over: &[["x", "length"]],
        value: ["velocity along y", "length/time"],
        doc: "Velocity of the discs along y in a hundred slices along x: total momentum over total mass in the slice.",
        source: "Irving and Kirkwood 1950: momentum density over mass density",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<0>),
            of: |it, values, weights| single::flow::<0>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "flow(y)",
        file: "flow-y.csv",
        over: &[["y", "length"]],
        value: ["velocity along x", "length/time"],
        doc: "Velocity of the discs along x in a hundred slices along y: total momentum over total mass in the slice.",
        source: "Irving and Kirkwood 1950: momentum density over mass density",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<1>),
            of: |it, values, weights| single::flow::<1>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "temperature(x)",
        file: "temperature-x.csv",
        over: &[["x", "length"]],
        value: ["kT", "energy"],
        doc: "Kinetic energy relative to the flow of the slice, ΣΣm|v − u|²/(2Σ(n − 1)) over discs and snapshots, in a hundred slices along the first axis.",
        source: "Irving and Kirkwood 1950: the kinetic part, with one disc fewer in each snapshot for the mean velocity",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<0>),
            of: |it, values, weights| single::temperature::<0>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "temperature(y)",
        file: "temperature-y.csv",
        over: &[["y", "length"]],
        value: ["kT", "energy"],
        doc: "Kinetic energy relative to the flow of the slice, ΣΣm|v − u|²/(2Σ(n − 1)) over discs and snapshots, in a hundred slices along the second axis.",
        source: "Irving and Kirkwood 1950: the kinetic part, with one disc fewer in each snapshot for the mean velocity",
        seen: SamplingKind::Once {
            over: FunctionArguments::Axis(single::slices::<1>),
            of: |it, values, weights| single::temperature::<1>(&it.setting, &it.discs, values, weights),
            further: 0,
            asks: SampleData::Discs,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "stress_xx(x,y)",
        file: "stress-xx.csv",
        over: PLACES,
        value: ["stress xx", "force/length"],
        doc: "Flux of x momentum through a line normal to x, positive under pressure: Σm v_x v_x of the discs of a cell and half of r_x F_x of each of their pairs, walls included, over its area.",
        source: STRESS,
        seen: SamplingKind::Once {
            over: FunctionArguments::Grid,
            of: |it, values, _| it.stress.component(0, values),
            further: 0,
            asks: SampleData::Forces,
        },
        headlines: &OVER_BOX,
        judged: SOUND,
    },
    StructureObservable {
        name: "stress_xy(x,y)",
        file: "stress-xy.csv",
        over: PLACES,
        value: ["stress xy", "force/length"],
        doc: "Flux of y momentum through a line normal to x, as the stress xx: the symmetric part, (r_x F_y + r_y F_x)/2 of each pair.",
        source: STRESS,
        seen: SamplingKind::Once {
            over: FunctionArguments::Grid,
            of: |it, values, _| it.stress.component(1, values),
            further: 0,
            asks: SampleData::Forces,
        },
        headlines: &OVER_BOX,
        judged: SOUND,
    },
    StructureObservable {
        name: "stress_yy(x,y)",
        file: "stress-yy.csv",
        over: PLACES,
        value: ["stress yy", "force/length"],
        doc: "Flux of y momentum through a line normal to y, as the stress xx.",
        source: STRESS,
        seen: SamplingKind::Once {
            over: FunctionArguments::Grid,
            of: |it, values, _| it.stress.component(2, values),
            further: 0,
            asks: SampleData::Forces,
        },
        headlines: &OVER_BOX,
        judged: SOUND,
    },
    StructureObservable {
        name: "msd",
        file: "msd.csv",
        over: &[["lag", "time"]],
        value: ["mean square displacement", "length²"],
        doc: "Mean square displacement of a disc during a time, followed across periodic sides.",
        source: "Einstein 1905: 4 D t in the plane after long times",
        seen: SamplingKind::Twice { of: motion::square_displacement, follows: true, by_species: false },
        headlines: &[Headline {
            name: "diffusion constant",
            unit: "length²/time",
            of: diffusion::by_displacements,
            bias: diffusion::bias_of_displacements,
        }],
        judged: diffusion::judge_displacements,
    },
    StructureObservable {
        name: "vacf",
        file: "vacf.csv",
        over: &[["lag", "time"]],
        value: ["velocity autocorrelation", "length²/time²"],
        doc: "⟨v(0)·v(t)⟩, the autocorrelation of the velocity: 2kT/m at first, in equilibrium.",
        source: "Green and Kubo: half of its integral is D in the plane",
        seen: SamplingKind::Twice { of: motion::velocity_product, follows: false, by_species: false },
        headlines: &[Headline {
            name: "diffusion constant",
            unit: "length²/time",
            of: diffusion::by_velocities,
            bias: diffusion::bias_of_velocities,
        }],
        judged: diffusion::judge_velocities,
    },
    StructureObservable {
        name: "g_ab(r)",
        file: "g-ab.csv",
        over: &[["a", ""], ["b", ""], ["r", "length"]],
        value: ["g", ""],
        doc: "g(r) of each pair of species: pairs of a disc of a and one of b over those of an ideal gas, which tends to 1. Weighted by their numbers of pairs, all of them give g(r): Σ c_a c_b g_ab = g in a large periodic box.",
        source: "Hansen and McDonald, Theory of Simple Liquids, section 3.6",
        seen: SamplingKind::Once {
            over: FunctionArguments::Species(pairs::distances_of_species),
            of: |it, values, _| {
                pairs::partial_correlations(
                    &it.setting,
                    &it.discs,
                    &it.partial_distances,
                    &it.partial_chances,
                    values,
                );
            },
            further: 0,
            asks: SampleData::DistancesOfSpecies,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "S_ab(k)",
        file: "s-ab.csv",
        over: &[["a", ""], ["b", ""], ["kx", "1/length"], ["ky", "1/length"]],
        value: ["S", ""],
        doc: "Partial structure factors Re ρ_a ρ_b*/√(N_a N_b) with ρ_a = Σ exp(ikr) over the discs of a (Ashcroft and Langreth). S_aa tends to 1, S_ab to 0, and Σ √(c_a c_b) S_ab = S over all ordered pairs of species.",
        source: "Ashcroft and Langreth 1967",
        seen: SamplingKind::Once {
            over: FunctionArguments::Species(waves::vectors_of_species),
            of: |it, values, _| waves::partial_factors(&it.waves, values),
            further: 0,
            asks: SampleData::WavesOfSpecies,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "coordination_ab",
        file: "coordination-ab.csv",
        over: &[["a", ""], ["b", ""]],
        value: ["neighbours", ""],
        doc: "Mean number of neighbours of species b around a disc of species a, neighbours as for the coordination. Σ_b is the mean number of a disc of a.",
        source: "first minimum of g(r) of dense discs",
        seen: SamplingKind::Once {
            over: FunctionArguments::Species(neighbours::ordered_species),
            of: |it, values, _| {
                neighbours::partial_coordination(&it.setting, &it.discs, &it.neighbours, values);
            },
            further: 0,
            asks: SampleData::Neighbours,
        },
        headlines: &[],
        judged: SOUND,
    },
    StructureObservable {
        name: "msd_a",
        file: "msd-a.csv",
        over: &[["a", ""], ["lag", "time"]],
        value: ["mean square displacement", "length²"],
        doc: "Mean square displacement of a disc of each species during a time, followed across periodic sides. Weighted by the fractions of the species, all of them give the msd.",
        source: "Einstein 1905: 4 D t in the plane after long times",
        seen: SamplingKind::Twice { of: motion::square_displacement, follows: true, by_species: true },
        headlines: &[],
        judged: SOUND,
    },
];

/// Index of the largest value; the first one of equals.
fn peak(values: &[f64]) -> usize {
    let larger = |best: usize, at: usize| if values[at] > values[best] { at } else { best };
    (0..values.len()).fold(0, larger)
}

/// Index of the largest mean.
fn highest(whole: &AveragedFunction<'_>) -> usize {
    let means: Vec<f64> = whole.means.iter().map(|[mean, _]| *mean).collect();
    peak(&means)
}

/// Relative fall of the function that ends a peak.
const FALL: f64 = 0.1;
/// Smallest significant difference, in units of the error bars.
const CERTAIN: f64 = 2.0;
/// Distance within which a block's peak is searched around the peak of the mean (bins).
const AROUND: usize = 5;

/// Index of the first peak of the mean above 1: the function then falls by a fraction of it and by more than its error.
fn first_peak(whole: &AveragedFunction<'_>) -> usize {
    let mut best = 0;
    for (at, &[mean, bar]) in whole.means.iter().enumerate() {
        let [highest, its_bar] = whole.means[best];
        if mean > highest {
            best = at;
        } else if highest > 1.0 && mean < highest - (FALL * highest).max(CERTAIN * (bar + its_bar)) {
            break;
        }
    }
    best
}

/// Index of the largest value of a block near the peak of the mean.
fn peak_near(block: &[f64], place: usize) -> usize {
    let first = place.saturating_sub(AROUND);
    first + peak(&block[first..(place + AROUND + 1).min(block.len())])
}

/// Rounding error of sums of fractions.
const ROUNDING: f64 = 1e-9;

/// Accepts the function if it has a significant peak.
fn judge_peak(whole: &AveragedFunction<'_>) -> FunctionReliability {
    let [height, bar] = whole.means[first_peak(whole)];
    match height - CERTAIN * bar > 1.0 {
        true => FunctionReliability::Sound,
        false => FunctionReliability::None(
            "no peak is above the noise: g(r) is 1 within twice its error bar everywhere".to_owned(),
        ),
    }
}

/// Reports discs above the highest slice.
fn judge_heights(whole: &AveragedFunction<'_>) -> FunctionReliability {
    let slice = whole.setting.domain.area() / whole.over.len() as f64;
    let seen = whole.means.iter().map(|[mean, _]| mean * slice).sum::<f64>() / whole.setting.discs as f64;
    match whole.setting.has_open_top && seen < 1.0 - ROUNDING {
        true => FunctionReliability::Doubt(format!(
            "{} % of the discs are above the highest slice of the open box; enlarge the second of domain.sides to include them",
            significant(100.0 * (1.0 - seen), 2)
        )),
        false => FunctionReliability::Sound,
    }
}

/// Reports discs whose number of neighbours has no line.
fn judge_lines(whole: &AveragedFunction<'_>) -> FunctionReliability {
    let lines = whole.over.len();
    match (whole.mean)(&|block| block[lines + 1], 0) {
        Some([share, _]) if share > 0.0 => FunctionReliability::Doubt(format!(
            "{} % of the discs have more than {} neighbours, which have no line; the mean number includes them",
            significant(100.0 * share, 2),
            lines - 1
        )),
        _ => FunctionReliability::Sound,
    }
}
