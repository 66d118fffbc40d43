//! Units with the prefix that keeps the numbers of an axis short.

/// Unit of an axis; values are given in it without a prefix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A unit that takes prefixes, such as `Pa`.
    Si(&'static str),
    /// A strain: shown in percent, or in µm/m when it is tiny.
    Strain,
    /// A pure number.
    None,
}

const PREFIXES: [(f64, &str); 9] = [
    (1e12, "T"),
    (1e9, "G"),
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
];

/// Below it percent would have too many zeros.
const TINY_STRAIN: f64 = 1e-4;

impl Unit {
    /// What values are divided by, and the name of the unit they then have, for an axis whose
    /// largest magnitude is `largest`.
    #[must_use]
    pub fn for_magnitude(self, largest: f64) -> (f64, String) {
        match self {
            Self::None => (1.0, String::new()),
            Self::Strain if largest < TINY_STRAIN => (1e-6, "µm/m".into()),
            Self::Strain => (1e-2, "%".into()),
            Self::Si(unit) if largest == 0.0 => (1.0, unit.into()),
            Self::Si(unit) => {
                let fits = PREFIXES.iter().find(|(factor, _)| largest >= *factor);
                let (factor, prefix) = fits.unwrap_or(&PREFIXES[PREFIXES.len() - 1]);
                (*factor, format!("{prefix}{unit}"))
            }
        }
    }

    /// `value` with its unit, in a sentence: four digits and a prefix.
    #[must_use]
    pub fn written(self, value: f64) -> String {
        if value == 0.0 {
            return format!("0 {}", self.name()).trim_end().into();
        }
        let (factor, unit) = self.for_magnitude(value.abs());
        let value = value / factor;
        let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 6.0) as usize;
        let text = format!("{value:.decimals$} {unit}").replace('-', "\u{2212}");
        text.trim_end().into()
    }

    /// The bare name; empty for pure numbers.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Si(unit) => unit,
            Self::Strain | Self::None => "",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prefix_leaves_one_to_three_digits_before_the_point() {
        assert_eq!(Unit::Si("Pa").for_magnitude(12.5e6), (1e6, "MPa".into()));
        assert_eq!(Unit::Si("Pa").for_magnitude(999.0), (1.0, "Pa".into()));
        assert_eq!(Unit::Si("J").for_magnitude(3e-6), (1e-6, "µJ".into()));
        assert_eq!(Unit::Si("J").for_magnitude(1e-20).1, "pJ");
        assert_eq!(Unit::Si("N").for_magnitude(0.0), (1.0, "N".into()));
    }

    #[test]
    fn a_value_in_a_sentence_has_four_digits() {
        assert_eq!(Unit::Si("Pa").written(-354.9312e6), "−354.9 MPa");
        assert_eq!(Unit::Si("N").written(0.202_34), "202.3 mN");
        assert_eq!(Unit::Si("J").written(0.0), "0 J");
        assert_eq!(Unit::None.written(0.25), "0.2500");
        assert_eq!(Unit::Si("J").written(1e-30), "0.000000 pJ");
    }

    #[test]
    fn strains_are_in_percent_unless_tiny() {
        assert_eq!(Unit::Strain.for_magnitude(8e-3).1, "%");
        assert_eq!(Unit::Strain.for_magnitude(2e-5).1, "µm/m");
    }
}
