//! Round numbers along an axis.

/// Numbers at which an axis is marked: rising, from at or below the data to at or above it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ticks {
    /// Where the marks are.
    pub values: Vec<f64>,
    /// What is written there; empty where nothing is.
    pub labels: Vec<String>,
}

/// A span below this share of the values is drawn as none: its labels would not fit.
const NARROWEST: f64 = 1e-6;

/// Magnitudes below it are taken for zero.
const SMALLEST: f64 = 1e-30;

/// Labels on a logarithmic axis, at most.
const MOST_DECADES: i32 = 8;

/// Above a round number by this factor is still that number.
const CLOSE: f64 = 1.1;

impl Ticks {
    /// About `about` equal steps of 1, 2 or 5 times a power of ten over `low..=high`, both finite
    /// and at most 1e30 in magnitude.
    #[must_use]
    pub fn linear(low: f64, high: f64, about: u32) -> Self {
        let (low, high) = widened(low, high);
        let (digit, power) = round_up((high - low) / f64::from(about.max(1)));
        Self::steps(low, high, digit, power)
    }

    /// As [`linear`](Self::linear), over whole numbers.
    #[must_use]
    pub fn whole(low: f64, high: f64, about: u32) -> Self {
        let (low, high) = if high > low { (low, high) } else { (low, low + 1.0) };
        let (digit, power) = round_up(((high - low) / f64::from(about.max(1))).max(1.0));
        Self::steps(low, high, digit, power)
    }

    /// The powers of ten around `low..=high`, both positive and finite.
    #[must_use]
    pub fn decades(low: f64, high: f64) -> Self {
        let mut first = low.log10().floor() as i32;
        let mut last = high.log10().ceil() as i32;
        // The logarithm of a power of ten may miss it by a rounding.
        first -= i32::from(10f64.powi(first) > low);
        last += i32::from(10f64.powi(last) < high);
        last = last.max(first + 1);
        let every = (last - first + MOST_DECADES - 1) / MOST_DECADES;
        let label = |power: i32| match (power - first) % every {
            0 => power_of_ten(power),
            _ => String::new(),
        };
        Self {
            values: (first..=last).map(|power| 10f64.powi(power)).collect(),
            labels: (first..=last).map(label).collect(),
        }
    }

    /// The first and the last.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        let ends = self.values.first().zip(self.values.last());
        ends.map_or((0.0, 1.0), |(first, last)| (*first, *last))
    }

    fn steps(low: f64, high: f64, digit: f64, power: i32) -> Self {
        // A product with or a quotient by a whole power of ten is rounded once.
        let at = |step: i64| match power {
            0.. => step as f64 * digit * 10f64.powi(power),
            _ => step as f64 * digit / 10f64.powi(-power),
        };
        let size = at(1);
        let (mut first, mut last) = ((low / size).floor() as i64, (high / size).ceil() as i64);
        first -= i64::from(at(first) > low);
        last += i64::from(at(last) < high);
        let decimals = usize::try_from(-power).unwrap_or(0);
        let values: Vec<f64> = (first..=last).map(at).collect();
        let labels = values.iter().map(|value| linear_label(*value, decimals)).collect();
        Self { values, labels }
    }
}

/// The next number of the form 1, 2 or 5 times a power of ten, in these two parts, or the one that
/// `raw` is close to.
fn round_up(raw: f64) -> (f64, i32) {
    let power = raw.log10().floor() as i32;
    let mantissa = raw / 10f64.powi(power);
    // A little above a round number does not ask for the next: one more step does less harm than
    // steps so long that half the axis is empty.
    let fits = [1.0, 2.0, 5.0].into_iter().find(|digit| mantissa <= digit * CLOSE);
    fits.map_or((1.0, power + 1), |digit| (digit, power))
}

/// Gives a span to what has none.
fn widened(low: f64, high: f64) -> (f64, f64) {
    let largest = low.abs().max(high.abs());
    if largest < SMALLEST {
        (-1.0, 1.0)
    } else if high - low < NARROWEST * largest {
        let middle = 0.5 * (low + high);
        (middle - 0.1 * largest, middle + 0.1 * largest)
    } else {
        (low, high)
    }
}

fn linear_label(value: f64, decimals: usize) -> String {
    let exponent = if value == 0.0 { 0.0 } else { value.abs().log10() };
    let text = if decimals > 9 || exponent > 7.0 {
        format!("{value:.3e}")
    } else {
        format!("{value:.decimals$}")
    };
    text.replace('-', "\u{2212}")
}

fn power_of_ten(power: i32) -> String {
    match power {
        0 => "1".into(),
        1 => "10".into(),
        _ => format!("10{}", power.to_string().chars().map(raised).collect::<String>()),
    }
}

fn raised(character: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    character.to_digit(10).map_or('⁻', |digit| DIGITS[digit as usize])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_the_decimals_of_the_step() {
        assert_eq!(Ticks::linear(0.0, 0.9, 5).labels, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(Ticks::linear(-3.0, 7.0, 3).labels, ["−5", "0", "5", "10"]);
        assert_eq!(Ticks::linear(-0.1, 10.0, 5).values, [-2.0, 0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(Ticks::linear(0.361, 0.3625, 4).labels[1], "0.3615");
    }

    #[test]
    fn whole_numbers_are_never_split() {
        assert_eq!(Ticks::whole(0.0, 2.0, 6).values, [0.0, 1.0, 2.0]);
        assert_eq!(Ticks::whole(4.0, 4.0, 6).values, [4.0, 5.0]);
    }

    #[test]
    fn decades_are_labelled_as_powers_and_thinned_when_many() {
        assert_eq!(Ticks::decades(3e-9, 2e-8).labels, ["10⁻⁹", "10⁻⁸", "10⁻⁷"]);
        assert_eq!(Ticks::decades(1.0, 1.0).labels, ["1", "10"]);
        let many = Ticks::decades(1e-20, 1.0);
        assert_eq!(many.values.len(), 21);
        assert_eq!(many.labels.iter().filter(|label| !label.is_empty()).count(), 7);
    }
}
