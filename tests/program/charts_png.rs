//! Charts as PNG: decoded by the PNG library, they show what the SVG says.
#![cfg(feature = "png")]

use graintwin::view::{Axis, Chart, Series, Sheet, Stroke, Unit};
use roxmltree::Document;

const BLUE: [u8; 3] = [0x00, 0x72, 0xb2];

/// Pixels for one of the SVG.
const SCALE: usize = 2;

fn sheet(title: &str) -> Sheet {
    let axis = |label| Axis::linear(label, Unit::Si("Pa"));
    let points = [[1.0, 1.0], [2.0, 4.0], [3.0, 2.0]];
    let stroke = Stroke::solid("#0072b2", 4.0);
    let chart = Chart {
        title: "Stress".into(),
        x: axis("mean stress"),
        y: axis("stress"),
        series: vec![Series { stroke, ..Series::new(0, "", points) }],
        notes: Vec::new(),
    };
    Sheet { title: title.into(), subtitle: "Increments 0 to 2.".into(), charts: vec![chart] }
}

/// An image as rows of colours.
struct Image(Vec<Vec<[u8; 3]>>);

impl Image {
    fn of(sheet: &Sheet) -> Self {
        let bytes = sheet.to_png().unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgba, png::BitDepth::Eight));
        let color = |pixel: &[u8]| {
            assert_eq!(pixel[3], 255, "paper does not shine through");
            [pixel[0], pixel[1], pixel[2]]
        };
        let row = |row: &[u8]| row.chunks_exact(4).map(color).collect();
        Self(pixels.chunks_exact(4 * info.width as usize).map(row).collect())
    }

    /// The pixels of a rectangle of the SVG, from one corner to the other.
    fn within(&self, from: [usize; 2], to: [usize; 2]) -> Vec<[u8; 3]> {
        let rows = &self.0[SCALE * from[1]..SCALE * to[1]];
        rows.iter().flat_map(|row| &row[SCALE * from[0]..SCALE * to[0]]).copied().collect()
    }

    /// What a heading looks like.
    fn heading(&self) -> Vec<[u8; 3]> {
        self.within([25, 20], [300, 46])
    }
}

fn dark(pixels: &[[u8; 3]]) -> usize {
    pixels.iter().filter(|pixel| pixel.iter().all(|part| *part < 128)).count()
}

#[test]
fn an_image_has_four_pixels_for_one_of_the_svg_and_a_heading_only_where_there_is_one() {
    let (named, nameless) = (Image::of(&sheet("triaxial")), Image::of(&sheet("")));
    let svg = sheet("triaxial").to_svg();
    let document = Document::parse(&svg).unwrap();
    let side = |name| document.root_element().attribute(name).unwrap().parse::<usize>().unwrap();
    assert_eq!(named.0.len(), SCALE * side("height"));
    assert_eq!(named.0[0].len(), SCALE * side("width"));
    assert_eq!(dark(&nameless.heading()), 0);
    assert!(dark(&named.heading()) > 300, "{}", dark(&named.heading()));
    // Below the headings nothing differs.
    assert_eq!(named.0[SCALE * 50..], nameless.0[SCALE * 50..]);
}

#[test]
fn a_line_is_where_the_svg_puts_it() {
    let image = Image::of(&sheet("triaxial"));
    let svg = sheet("triaxial").to_svg();
    let document = Document::parse(&svg).unwrap();
    let line = document.descendants().find(|node| node.has_tag_name("polyline")).unwrap();
    let places = line.attribute("points").unwrap().split([' ', ',']);
    let places: Vec<f64> = places.map(|number| number.parse().unwrap()).collect();
    let color = |x: f64, y: f64| image.0[(SCALE as f64 * y) as usize][(SCALE as f64 * x) as usize];
    for ends in places.windows(4).step_by(2) {
        let middle = [0.5 * (ends[0] + ends[2]), 0.5 * (ends[1] + ends[3])];
        assert_eq!(color(middle[0], middle[1]), BLUE);
        assert_ne!(color(middle[0], middle[1] + 30.0), BLUE);
    }
}

#[test]
fn every_letter_that_a_chart_uses_has_a_shape_of_its_own() {
    // What no chart can draw: the same box for any letter that the font lacks.
    let empty_box = Image::of(&sheet("\u{4e2d}")).heading();
    assert_eq!(empty_box, Image::of(&sheet("\u{4e8c}")).heading());
    assert!(dark(&empty_box) > 0);
    let letters = "aZ09µ%é·−⁰¹²³⁴⁵⁶⁷⁸⁹⁻×±≤≥≈√∞ΔεσφλνκρτЖя…–’°";
    let mut seen = vec![(' ', empty_box)];
    for letter in letters.chars() {
        let shape = Image::of(&sheet(&letter.to_string())).heading();
        assert!(dark(&shape) > 0, "{letter:?} leaves nothing");
        let twin = seen.iter().find(|(_, other)| *other == shape);
        assert!(twin.is_none(), "{letter:?} looks like {:?}", twin.map(|(letter, _)| letter));
        seen.push((letter, shape));
    }
}

#[test]
fn headings_are_bold() {
    let image = Image::of(&sheet("Stress"));
    // The title of the chart is smaller than the heading and as bold; a label of its size is not.
    let plain = Sheet { title: String::new(), subtitle: "Stress".into(), ..sheet("") };
    let plain = Image::of(&plain).within([25, 46], [300, 64]);
    let title = image.within([25, 70], [300, 95]);
    assert!(dark(&title) > 2 * dark(&plain), "{} {}", dark(&title), dark(&plain));
}

#[test]
fn the_same_sheet_makes_the_same_bytes() {
    assert_eq!(sheet("triaxial").to_png().unwrap(), sheet("triaxial").to_png().unwrap());
}
