//! Unit symbols of a scene's numbers.

/// Dimensions and their SI symbols.
const SI: [(&str, &str); 5] =
    [("length", "m"), ("time", "s"), ("mass", "kg"), ("energy", "J"), ("force", "N")];

/// Returns the symbol of a dimension in a system of units: `m/s` for `length/time` in `SI`; none in other systems.
pub fn symbol(units: &str, dimension: &str) -> Option<String> {
    (units == "SI")
        .then(|| SI.iter().fold(dimension.to_owned(), |unit, (word, symbol)| unit.replace(word, symbol)))
}

/// Adds the symbol to a formatted number; in other systems than `SI` the number stands alone.
pub fn with_symbol(number: &str, units: &str, dimension: &str) -> String {
    let symbol = symbol(units, dimension).filter(|symbol| !symbol.is_empty());
    symbol.map_or_else(|| number.to_owned(), |symbol| format!("{number} {symbol}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn si_scenes_have_si_symbols() {
        let dimensions = ["length/time", "mass·length/time", "force/length", "energy/time", "1/length²", ""];
        let si = dimensions.map(|dimension| symbol("SI", dimension).unwrap());
        assert_eq!(si, ["m/s", "kg·m/s", "N/m", "J/s", "1/m²", ""]);
        assert_eq!(dimensions.map(|dimension| symbol("reduced", dimension)), [const { None }; 6]);
        assert_eq!(["SI", "reduced"].map(|units| with_symbol("0.5", units, "time")), ["0.5 s", "0.5"]);
    }
}
