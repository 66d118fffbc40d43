//! SVG elements as text.

use std::fmt::Write;

/// Which side of a text its place is on.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Elements, one a line.
#[derive(Default)]
pub(super) struct Svg(String);

impl Svg {
    pub(super) fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        self.push(format_args!(
            r#"<line class="{class}" x1="{:.2}" y1="{:.2}" x2="{:.2}" y2="{:.2}"/>"#,
            from[0], from[1], to[0], to[1]
        ));
    }

    pub(super) fn text(&mut self, class: &str, at: [f64; 2], anchor: Anchor, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.push(format_args!(
            r#"<text class="{class}" x="{:.2}" y="{:.2}" text-anchor="{anchor}">{}</text>"#,
            at[0],
            at[1],
            escaped(text)
        ));
    }

    /// Text that runs upwards, centred at `at`.
    pub(super) fn upward_text(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        self.push(format_args!(
            r#"<text class="{class}" transform="translate({x:.2} {y:.2}) rotate(-90)" text-anchor="middle">{}</text>"#,
            escaped(text)
        ));
    }

    pub(super) fn rect(&mut self, class: &str, at: [f64; 2], size: [f64; 2], corner: f64) {
        self.push(format_args!(
            r#"<rect class="{class}" x="{:.2}" y="{:.2}" width="{:.2}" height="{:.2}" rx="{corner}"/>"#,
            at[0], at[1], size[0], size[1]
        ));
    }

    /// Begins a group of lines of one colour; a pointer that rests on it shows `name`.
    pub(super) fn begin_series(&mut self, name: &str, color: &str, width: f64) {
        self.push(format_args!(
            r#"<g class="series" stroke="{color}" fill="{color}" stroke-width="{width}"><title>{}</title>"#,
            escaped(name)
        ));
    }

    /// Begins the line in the legend.
    pub(super) fn begin_sample(&mut self, color: &str, width: f64) {
        self.push(format_args!(
            r#"<g class="sample" stroke="{color}" fill="{color}" stroke-width="{width}">"#
        ));
    }

    pub(super) fn begin(&mut self, class: &str) {
        self.push(format_args!(r#"<g class="{class}">"#));
    }

    pub(super) fn end(&mut self) {
        self.push(format_args!("</g>"));
    }

    pub(super) fn polyline(&mut self, points: &[[f64; 2]]) {
        let places = list(points);
        self.push(format_args!(r#"<polyline fill="none" points="{places}"/>"#));
    }

    pub(super) fn dashed(&mut self, points: &[[f64; 2]]) {
        let places = list(points);
        self.push(format_args!(
            r#"<polyline fill="none" stroke-dasharray="6 4" points="{places}"/>"#
        ));
    }

    /// A pale area within a closed line.
    pub(super) fn area(&mut self, points: &[[f64; 2]]) {
        let places = list(points);
        self.push(format_args!(
            r#"<polygon stroke="none" fill-opacity="0.18" points="{places}"/>"#
        ));
    }

    pub(super) fn dot(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.push(format_args!(r#"<circle stroke="none" cx="{x:.2}" cy="{y:.2}" r="{radius}"/>"#));
    }

    /// The whole image.
    pub(super) fn document(&self, [width, height]: [f64; 2], title: &str, style: &str) -> String {
        let title = escaped(title);
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" role=\"img\">\n<title>{title}</title>\n\
             <style>{style}</style>\n{}</svg>\n",
            self.0
        )
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        append(&mut self.0, element);
        self.0.push('\n');
    }
}

/// Places as the attribute `points` has them.
fn list(points: &[[f64; 2]]) -> String {
    let mut places = String::with_capacity(14 * points.len());
    for [x, y] in points {
        if !places.is_empty() {
            places.push(' ');
        }
        append(&mut places, format_args!("{x:.2},{y:.2}"));
    }
    places
}

fn append(text: &mut String, what: std::fmt::Arguments<'_>) {
    text.write_fmt(what).expect("a string takes all text");
}

/// Text as XML has it: marked characters replaced, those that it cannot hold left out.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '\u{fffe}' | '\u{ffff}' => {}
            character if character.is_control() => {}
            character => escaped.push(character),
        }
    }
    escaped
}
