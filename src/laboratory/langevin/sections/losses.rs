//! Particles lost over the step.

use crate::laboratory::langevin::study::losses::{Boundary, INTERACTIONS, LossTable, Row, SCHEMES, SOURCE};
use crate::report::figure::{Axis, Chart, Figure, Series, Style};
use crate::report::{Cell, Rows, Section, Table, Verdict};
use stripmine_physics::number::range;
use stripmine_physics::words::Words;

/// Counts within this factor of the source's are its.
const ALIKE: f64 = 1.5;

/// How many times as many or as few a count is as the source's.
fn off(lost: u64, source: u64) -> f64 {
    let ratio = lost.max(1) as f64 / source.max(1) as f64;
    ratio.max(1.0 / ratio)
}

/// The row whose losses are farthest from the source's, and how many times as many or as few they are; none where the source has none.
fn farthest(data: &LossTable) -> Option<(&Row, f64)> {
    let ratios = data
        .rows
        .iter()
        .filter_map(|row| Some((row, off(row.lost[0], row.source.filter(|lost| *lost > 0)?))));
    ratios.max_by(|a, b| a.1.total_cmp(&b.1))
}

fn none_where_the_source_has_none(data: &LossTable) -> bool {
    data.rows.iter().filter(|row| row.source == Some(0)).all(|row| row.lost == [0, 0])
}

/// How the losses differ from the source's.
fn beside_the_source(data: &LossTable) -> String {
    let none = match none_where_the_source_has_none(data) {
        true => "none where it loses none",
        false => "some where it loses none",
    };
    match farthest(data) {
        Some((row, ratio)) if ratio > ALIKE => format!(
            "At a step of {} {} particles are lost where the source loses {}, {ratio:.0} times as {}; {none}.",
            row.dt,
            Cell::Count(row.lost[0]).for_reading(),
            Cell::Count(row.source.unwrap_or_default()).for_reading(),
            if Some(row.lost[0]) > row.source { "many" } else { "few" },
        ),
        _ => format!("At every step of the source the losses are within {ALIKE} times its own; {none}."),
    }
}

/// How near the source's counts the choices of ε and kT come.
fn of_choices(data: &LossTable) -> String {
    let worst = |lost: [u64; 4]| {
        lost.into_iter().zip(SOURCE).map(|(lost, (_, source))| off(lost, source)).fold(1.0, f64::max)
    };
    let Some(nearest) = data.choices.iter().min_by(|a, b| worst(a.lost).total_cmp(&worst(b.lost))) else {
        return String::new();
    };
    let (number, times) = (data.choices.len(), worst(nearest.lost));
    match times > ALIKE {
        true => format!(
            " No choice of ε and kT tried ({number}) gives the source's counts: the nearest is {times:.0} times off."
        ),
        false => {
            format!(" ε = {} and kT = {} give the source's counts.", nearest.strength, nearest.temperature)
        }
    }
}

/// What came out.
pub fn section(data: &LossTable) -> Section {
    let falls = data.rows.windows(2).all(|pair| pair[0].lost[0] >= pair[1].lost[0]);
    let ratios = || data.boundaries.iter().map(|boundary| boundary.dt / boundary.bounds[0]);
    let (least, most) = (ratios().fold(f64::INFINITY, f64::min), ratios().fold(0.0, f64::max));
    Section::new("langevin-losses", "Langevin: particles lost to a long step")
        .asks("When are particles lost?")
        .expects("LAN17: of 40 000, 19 200 in 100 steps of 1, 6393 of 0.1, 754 of 0.01, none of 0.001; none below √(2 m r_c/F).")
        .answers(format!(
            "{}{}{} The bound {}: the longest safe step is {} of it.",
            beside_the_source(data),
            of_choices(data),
            if falls { "" } else { " The losses do not grow with the step." },
            if least >= 1.0 { "suffices" } else { "does not suffice" },
            range([least, most], 2),
        ))
        .verdict(Verdict::of_claims(&[
            falls,
            none_where_the_source_has_none(data),
            farthest(data).is_none_or(|(_, ratio)| ratio <= ALIKE),
            least >= 1.0,
        ]))
        .details([format!(
            "The columns of LAN17 contradict its N, L and σ: the particles that are left after steps of 1 are nearer than σ \
             to {} others in 100 steps at random places, where it counts {} interactions.",
            Cell::Count(data.least_interactions as u64).for_reading(),
            Cell::Count(INTERACTIONS).for_reading()
        )])
        .figures([losses(data), boundaries(data)])
        .tables([loss_table(data), boundary_table(data)])
        .seeds([1])
}

fn losses(data: &LossTable) -> Figure {
    let seen = |of: &dyn Fn(&Row) -> Option<u64>| -> Vec<(f64, f64)> {
        let lost =
            data.rows.iter().rev().filter_map(|row| Some((row.dt, of(row).filter(|lost| *lost > 0)? as f64)));
        lost.collect()
    };
    let ours = SCHEMES.iter().enumerate().map(|(which, scheme)| {
        Series::new(scheme.word(), Style::Joined, which, seen(&|row| Some(row.lost[which])))
    });
    Chart::of(Axis::logarithmic("time step", Some("reduced")), Axis::logarithmic("particles lost", None))
        .with(ours)
        .series("source", Style::Points, 6, seen(&|row| row.source))
        .figure("losses", "Particles lost in 100 steps")
        .caption(format!(
            "Of {}. Steps without a loss are not drawn. The source loses fewer at long steps.",
            data.particles
        ))
}

fn boundaries(data: &LossTable) -> Figure {
    let mut sorted: Vec<&Boundary> = data.boundaries.iter().collect();
    sorted.sort_by(|a, b| a.bounds[0].total_cmp(&b.bounds[0]));
    let over_bound = |of: fn(&Boundary) -> f64| sorted.iter().map(move |it| (it.bounds[0], of(it)));
    Chart::of(
        Axis::logarithmic("the source's bound on the step", Some("reduced")),
        Axis::logarithmic("time step", Some("reduced")),
    )
    .series("the source's bound", Style::Line, 6, over_bound(|it| it.bounds[0]))
    .series("by the hardest collisions", Style::Points, 1, over_bound(|it| it.bounds[1]))
    .series("measured", Style::Points, 0, over_bound(|it| it.dt))
    .figure("boundaries", "Longest step without a loss beside two bounds")
    .caption("For ε of 0.1 to 100 and kT of 0.1 to 10. The source's bound knows no temperature: where particles meet hard, the spring between \
              them is far stiffer than at the distance σ.")
}

fn loss_table(data: &LossTable) -> Table {
    Rows::of(&data.rows)
        .number("dt", 3, |row| row.dt)
        .count("stochastic", |row| row.lost[0])
        .count("baoab", |row| row.lost[1])
        .cell("source", |row| row.source.map_or(Cell::Text(String::new()), Cell::Count))
        .table("losses", format!("Particles lost in 100 steps, of {}", data.particles))
        .note("ε = kT = γ = m = 1, σ = 0.1, four particles in a unit of area.")
}

fn boundary_table(data: &LossTable) -> Table {
    Rows::of(&data.boundaries)
        .number("ε", 1, |it| it.strength)
        .number("kT", 1, |it| it.temperature)
        .number("longest step", 5, |it| it.dt)
        .number("source's bound", 5, |it| it.bounds[0])
        .number("of it", 3, |it| it.dt / it.bounds[0])
        .number("by hardest collisions", 5, |it| it.bounds[1])
        .number("of it", 3, |it| it.dt / it.bounds[1])
        .table("boundaries", "Longest step without a loss in 100 steps, BAOAB, to 5 %")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::langevin::study::losses::Choice;

    /// The losses of the source's steps, the longest first, and a longest step beside a bound of 1.
    fn section_of(lost: [u64; 4], dt: f64) -> Section {
        let rows = [(1.0, 19_200), (0.1, 6393), (0.01, 754), (0.001, 0)].into_iter().zip(lost);
        let rows = rows.map(|((dt, source), lost)| Row { dt, lost: [lost; 2], source: Some(source) });
        let boundary = Boundary { strength: 1.0, temperature: 1.0, dt, bounds: [1.0, 1.0] };
        let boundaries = vec![boundary];
        let choice = Choice { strength: 0.1, temperature: 1.0, lost: lost.map(|lost| lost / 2) };
        section(&LossTable {
            particles: 40_000,
            rows: rows.collect(),
            boundaries,
            least_interactions: 135_917.0,
            choices: vec![choice],
        })
    }

    #[test]
    fn losses_that_are_not_the_sources_are_said_first_and_graded() {
        let ours = section_of([37_111, 34_738, 26_331, 0], 0.1);
        assert_eq!(ours.verdict, Verdict::Partly);
        let begin =
            "At a step of 0.01 26\u{202f}331 particles are lost where the source loses 754, 35 times as many";
        assert!(
            ours.answer.starts_with(begin) && ours.answer.contains("does not suffice"),
            "{}",
            ours.answer
        );
        assert!(
            ours.answer.contains("(1) gives the source's counts: the nearest is 17 times off"),
            "{}",
            ours.answer
        );
        let theirs = section_of([19_000, 6400, 800, 0], 1.0);
        assert_eq!(theirs.verdict, Verdict::Reproduced, "{}", theirs.answer);
        assert_eq!(section_of([19_000, 6400, 800, 3], 1.0).verdict, Verdict::Partly);
        let few = section_of([19_000, 6400, 20, 0], 1.0).answer;
        assert!(few.contains("38 times as few"), "{few}");
    }
}
