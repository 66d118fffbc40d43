//! Sizes of text, known without a font.

/// Size of labels \[pixels\].
pub(super) const LABEL: f64 = 12.0;

/// Size of notes \[pixels\].
pub(super) const NOTE: f64 = 11.0;

/// Width of a letter over the size of its font, a little more than the average of common
/// sans-serif fonts.
const LETTER: f64 = 0.58;

/// About the width of `text` \[pixels\].
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * LETTER
}

/// Breaks `text` between words into lines of at most `room` pixels.
pub(super) fn wrapped(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + size * LETTER <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// `text` in one line of at most `room` pixels; an ellipsis stands for what does not fit.
pub(super) fn shortened(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let letters = (room / (size * LETTER)) as usize;
    text.chars().take(letters.saturating_sub(1)).chain(['…']).collect()
}

/// Rows of things of the given widths, `gap` apart, none wider than `room` unless it is alone:
/// row and offset of each.
pub(super) fn rows(widths: &[f64], gap: f64, room: f64) -> Vec<(usize, f64)> {
    let (mut row, mut at) = (0, 0.0);
    let place = |width: &f64| {
        if at > 0.0 && at + width > room {
            (row, at) = (row + 1, 0.0);
        }
        let place = (row, at);
        at += width + gap;
        place
    };
    widths.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_too_long_for_its_line_ends_in_an_ellipsis() {
        assert_eq!(shortened("Öl und Sand", 10.0, 100.0), "Öl und Sand");
        assert_eq!(shortened("Öl und Sand", 10.0, 42.0), "Öl und…");
    }

    #[test]
    fn what_does_not_fit_goes_into_the_next_row() {
        assert_eq!(
            rows(&[50.0, 40.0, 200.0, 10.0], 5.0, 100.0),
            [(0, 0.0), (0, 55.0), (1, 0.0), (2, 0.0)]
        );
        assert_eq!(wrapped("aaa bb cccc", 10.0, 40.0), ["aaa bb", "cccc"]);
    }
}
