//! `.sph`, spheres as programs for hard particles write them: their number, the sides of the box, and `label x y z radius` for each.

use super::text::{TextFile, TextMistake};
use super::{
    QuantitySource, StartBox, StartFileError, StartFormat, StartFrame, StartRequest, is_count, lines,
};
use crate::particles::{Particle, ParticleKind, Particles};
use std::path::Path;

pub(super) static FORMAT: StartFormat = StartFormat {
    name: ".sph",
    recognises: |head| {
        let mut lines = lines(head);
        let (count, sides) = (lines.next().unwrap_or_default(), lines.next().unwrap_or_default());
        let words = sides.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let numbers: Option<Vec<f64>> =
            words.map(|word| std::str::from_utf8(word).ok()?.parse().ok()).collect();
        is_count(count) && numbers.is_some_and(|numbers| numbers.len() == 3)
    },
    read,
    columns: ["velocities", "radii", "masses"],
};

fn read(path: &Path, request: StartRequest) -> Result<StartFrame, StartFileError> {
    if request.frame.is_some_and(|number| number > 0) {
        return Err(StartFileError::beyond(path, request, 1));
    }
    let mut file = TextFile::open(path)?;
    let first = file.required_line("the number of spheres")?;
    let count = file.count(&first, first.text.trim())?;
    let line = file.required_line("three sides of the box")?;
    let mut sides = [0.0; 2];
    for (side, word) in sides.iter_mut().zip(line.words()) {
        *side = file.positive(&line, "the side of the box", word)?;
    }
    let (mut particles, mut line_of) = (vec![], vec![]);
    for row in 0..count {
        let Some(line) = file.next_line()? else {
            return Err(file
                .wrong(row + 2, TextMistake::Rows { found: row, promised: count, line: 1 })
                .into());
        };
        let words = line.words();
        let [_, x, y, z, radius] = words[..] else {
            let expected = "five: label, x, y, z and radius".to_owned();
            return Err(file.wrong(line.number, TextMistake::Fields { found: words.len(), expected }).into());
        };
        let mut position = [0.0; 3];
        for (coordinate, word) in position.iter_mut().zip([x, y, z]) {
            *coordinate = file.number(&line, "the position", word)?;
        }
        let radius = file.positive(&line, "the radius", radius)?;
        particles
            .push(Particle { radius, ..Particle::at_rest(row as u32 + 1, ParticleKind::Grain, position) });
        line_of.push(line.number);
    }
    file.check(&mut particles, &line_of, request)?;
    Ok(StartFrame {
        particles: Particles::new(particles),
        cell: Some(StartBox { corner: [0.0; 2], sides, is_movable: false, precision: StartBox::DOUBLE }),
        periodic: None,
        sources: [QuantitySource::Missing, QuantitySource::Stated, QuantitySource::Missing],
        has_momenta: false,
        line: None,
        columns: FORMAT.columns,
        has_raised_ids: false,
    })
}
