//! Names of columns in files, derived from headings: lower-case ASCII without the unit, and one name for each quantity.

/// Synonymous headings, with their common name.
const SAME: [(&str, &[&str]); 11] = [
    ("packing_fraction", &["ν", "packing fraction", "packing fraction ν"]),
    ("occupancy", &["ρ", "occupancy ρ", "occupancy ρ = NP/LMAX"]),
    (
        "particles",
        &[
            "NP",
            "N",
            "number of particles NP",
            "number of particles",
            "discs",
            "grains",
            "bodies",
            "particles",
        ],
    ),
    ("step", &["dt", "step", "time step", "the source's step"]),
    ("restitution", &["e", "restitution", "restitution e"]),
    ("scheme", &["integrator", "scheme"]),
    ("compressibility", &["Z", "compressibility Z"]),
    ("collision_rate", &["ω"]),
    ("strength", &["ε"]),
    ("temperature", &["kT", "temperature"]),
    ("scene", &["scene", "scenes"]),
];

/// Spelling of letters outside ASCII.
const LETTERS: [(char, &str); 18] = [
    ('α', "alpha"),
    ('γ', "gamma"),
    ('Δ', "delta"),
    ('ε', "epsilon"),
    ('μ', "mu"),
    ('µ', "u"),
    ('ν', "nu"),
    ('ξ', "xi"),
    ('ρ', "rho"),
    ('σ', "sigma"),
    ('Σ', "sum"),
    ('τ', "tau"),
    ('ψ', "psi"),
    ('Ψ', "psi"),
    ('ω', "omega"),
    ('Ω', "omega"),
    ('±', "error"),
    ('½', "half"),
];

/// Unit at the end of a heading, in brackets; text in brackets that is not a unit, such as `95 %`, is ignored.
pub(crate) fn unit(heading: &str) -> Option<&str> {
    let (_, unit) = heading.strip_suffix(')')?.rsplit_once(" (")?;
    let is_unit = unit.chars().count() <= 12
        && !unit.contains(' ')
        && !unit.starts_with(|c: char| c.is_ascii_digit() && c != '1');
    is_unit.then_some(unit)
}

/// Name of a column with a heading.
pub(super) fn of(heading: &str) -> String {
    let bare = unit(heading).map_or(heading, |unit| heading[..heading.len() - unit.len() - 2].trim_end());
    let same = SAME.iter().find(|(_, headings)| headings.contains(&bare));
    same.map_or_else(|| slug(bare), |(name, _)| (*name).to_owned())
}

fn slug(heading: &str) -> String {
    let mut name = String::new();
    for letter in heading.chars() {
        match LETTERS.iter().find(|(known, _)| *known == letter) {
            Some((_, word)) => {
                if !name.is_empty() && !name.ends_with('_') {
                    name.push('_');
                }
                name.push_str(word);
            }
            None if letter.is_ascii_alphanumeric() => name.push(letter.to_ascii_lowercase()),
            None => {
                if !name.is_empty() && !name.ends_with('_') {
                    name.push('_');
                }
            }
        }
    }
    let name = name.trim_end_matches('_');
    if name.is_empty() { "column".to_owned() } else { name.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_become_names() {
        let all = [
            ("mean velocity late (m/s)", "mean_velocity_late", Some("m/s")),
            ("ν", "packing_fraction", None),
            ("packing fraction", "packing_fraction", None),
            ("γ_N", "gamma_n", None),
            ("± (95 %)", "error_95", None),
            ("share of the forces (%)", "share_of_the_forces", Some("%")),
            ("normal damping (1/s)", "normal_damping", Some("1/s")),
            ("=1", "1", None),
            ("–", "column", None),
        ];
        for (heading, name, of_unit) in all {
            assert_eq!((of(heading).as_str(), unit(heading)), (name, of_unit), "{heading}");
        }
    }
}
