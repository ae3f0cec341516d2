//! The break-even atlas: who wins where.

use crate::laboratory::lattice_md::study::break_even::{Atlas, Named, Sheet};
use crate::laboratory::lattice_md::study::density_cost::CEILING;
use crate::report::figure::{Axis, Band, Chart, Figure, Series, Style};
use crate::report::{Rows, Section, Table, Verdict};
use crate::statistics::median;

/// A lead below this is a draw in the words.
const DRAW: f64 = 1.1;

/// What came out.
pub fn section(data: &Atlas, again: &str) -> Section {
    let named = data.named();
    let wins = data.sheets.iter().map(|sheet| format!("Cheapest, {}: {}", sheet.title, wins(sheet)));
    Section::new("atlas", "Who wins where: the break-even atlas")
        .asks("Which method is the cheapest for which number of particles and density, and does the model of a host know it?")
        .expects("BP93, section 3: the lattice wins for many particles and dense packings, scalar lists for few. Our aim: what the model names as \
                  the cheapest costs at most a tenth more than what is.")
        .answers(model(data, &named))
        .verdict(Verdict::aim(named.iter().all(|it| it.dearer <= DRAW)))
        .details(wins.map(|wins| format!("{wins}.")))
        .figures(data.sheets.iter().map(figure))
        .tables([wrong(&named), places(data)])
        .again(again)
        .seeds([1])
        .depends_on_host()
}

/// How often the model names the cheapest method beside one that always names the same, and what it costs where it is wrong.
fn model(data: &Atlas, named: &[Named]) -> String {
    let wrong: Vec<&Named> = named.iter().filter(|it| it.named != it.cheapest).collect();
    let baseline = data.baseline().map_or(String::new(), |(method, right)| {
        format!("; one that always names {method} is right at {right}")
    });
    let begin = format!(
        "By {} the cheapest method is named at {} of {} places measured on this host{baseline}",
        data.model,
        named.len() - wrong.len(),
        named.len()
    );
    let Some(worst) = wrong.iter().max_by(|a, b| a.dearer.total_cmp(&b.dearer)) else { return begin + "." };
    format!(
        "{begin}. Where the model is wrong its choice costs at most {:.0} % more, {:.0} % in the median.",
        100.0 * (worst.dearer - 1.0),
        100.0 * (median(wrong.iter().map(|it| it.dearer)) - 1.0),
    )
}

/// Where the model names another method than the cheapest.
fn wrong(named: &[Named]) -> Table {
    Rows::of(named.iter().filter(|it| it.named != it.cheapest))
        .number("occupancy ρ", 2, |it| it.occupancy)
        .count("NP", |it| it.particles)
        .text("named by the model", |it| &it.named)
        .text("cheapest as measured", |it| &it.cheapest)
        .number("costs more (%)", 0, |it| 100.0 * (it.dearer - 1.0))
        .table("wrong_winners", "Where the model of a host names another method than the cheapest")
}

/// At how many places each method wins.
fn wins(sheet: &Sheet) -> String {
    let winners: Vec<(usize, f64)> = sheet.places.iter().filter_map(|place| place.winner()).collect();
    let of_method = sheet.methods.iter().enumerate().filter_map(|(method, name)| {
        let places = winners.iter().filter(|(winner, _)| *winner == method).count();
        (places > 0).then(|| format!("{name} at {places} of {} places", winners.len()))
    });
    of_method.collect::<Vec<_>>().join(", ")
}

/// How far the next method is behind, in words, and from which of its costs over the cheapest's on.
const LEADS: [(&str, f64); 3] =
    [("by 2 times and more", 2.0), ("by a tenth to 2 times", DRAW), ("by less than a tenth", 1.0)];

fn figure(sheet: &Sheet) -> Figure {
    let series = sheet.methods.iter().enumerate().flat_map(|(hue, name)| {
        LEADS.iter().enumerate().map(move |(class, (words, least))| {
            let below = if class == 0 { f64::INFINITY } else { LEADS[class - 1].1 };
            let won = sheet.places.iter().filter(move |place| {
                place.winner().is_some_and(|(winner, lead)| winner == hue && (*least..below).contains(&lead))
            });
            let points = won.map(|place| (place.occupancy, place.particles as f64));
            Series::new(format!("{name}, {words}"), Style::Points, hue, points)
        })
    });
    let narrow =
        sheet.places.iter().filter(|place| place.winner().is_some_and(|(_, lead)| lead < DRAW)).count();
    let estimated = if sheet.measured {
        "Moving discs, one thread, double precision; the sum over all phases of what the lowest tenth of the samples take."
    } else {
        "Not measured. Candidates and contacts a disc as in a run of about a thousand discs of the same density."
    };
    Chart::of(
        Axis::linear("occupancy ρ = NP/LMAX", None).between([0.0, 0.35]),
        Axis::logarithmic("number of particles NP", None).between([50.0, 100_000.0]),
    )
    .with(series.filter(|series| !series.points.is_empty()))
    .band(Band::of_x("out of reach", [CEILING, 0.35]))
    .figure(sheet.name.clone(), format!("The cheapest method: {}", sheet.title))
    .caption(format!(
        "{}: {estimated} At {narrow} of {} places the next method costs less than a tenth more. Hatched: occupancies that discs on cells as wide \
         as their radius cannot reach.",
        sheet.title,
        sheet.places.len()
    ))
}

fn places(data: &Atlas) -> Table {
    let won = data
        .sheets
        .iter()
        .flat_map(|sheet| sheet.places.iter().filter_map(move |place| Some((sheet, place, place.winner()?))));
    Rows::of(won)
        .text("machine", |(sheet, ..)| &sheet.title)
        .number("occupancy ρ", 2, |(_, place, _)| place.occupancy)
        .count("NP", |(_, place, _)| place.particles)
        .text("cheapest", |(sheet, _, (winner, _))| &sheet.methods[*winner])
        .number("the next costs (times)", 2, |(.., (_, lead))| *lead)
        .number("a disc and step", 1, |(_, place, (winner, _))| place.costs[*winner] / place.particles as f64)
        .text("unit", |(sheet, ..)| sheet.unit)
        .table("atlas", "The cheapest method at each place")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laboratory::lattice_md::study::break_even::Place;
    use crate::laboratory::lattice_md::study::model_validation::Calibrated;

    /// Three places; the model names the second method everywhere, and is wrong at the last.
    #[test]
    fn the_answer_says_whose_model_it_is_and_what_a_constant_is_worth() {
        let sheet = |measured: bool, costs: [[f64; 2]; 3]| Sheet {
            name: String::new(),
            title: String::new(),
            unit: "ns",
            measured,
            methods: ["chained", "lists"].map(str::to_owned).to_vec(),
            places: costs
                .iter()
                .zip([100, 300, 1000])
                .map(|(costs, particles)| Place { particles, occupancy: 0.1, costs: costs.to_vec() })
                .collect(),
        };
        let sheets = vec![sheet(false, [[2.0, 1.0]; 3]), sheet(true, [[2.0, 1.0], [2.0, 1.0], [1.0, 1.5]])];
        let answer = |calibrated: Calibrated| {
            let model = calibrated.model_of("A CPU");
            section(&Atlas { model, lists: vec![], fast_lists: vec![], sheets: sheets.clone() }, "").answer
        };
        let shipped = answer(Calibrated::Shipped);
        let begin = "By the shipped model of A CPU the cheapest method is named at 2 of 3 places measured on this host; one that always names \
                     lists is right at 2. Where the model is wrong";
        assert!(shipped.starts_with(begin), "{shipped}");
        assert!(answer(Calibrated::Before).starts_with("By the model of A CPU from a host file the"));
        assert!(
            answer(Calibrated::Now).starts_with("By the model of this host, A CPU, calibrated just before")
        );
    }
}
