//! A sheet as PNG.

use std::sync::{Arc, LazyLock};

use resvg::tiny_skia::{Color, Pixmap, Transform};
use resvg::usvg::fontdb::{Database, Source};
use resvg::usvg::{Options, Tree};
use thiserror::Error;

use super::Sheet;

/// Pixels of a PNG for one of the SVG, along each side: lines stay sharp on paper.
const SCALE: f32 = 2.0;

const REGULAR: &[u8] = include_bytes!("font/DejaVuSans.ttf");
const BOLD: &[u8] = include_bytes!("font/DejaVuSans-Bold.ttf");

/// The only letters: those of the machine would make another picture on another machine.
static LETTERS: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut letters = Database::new();
    letters.load_font_source(Source::Binary(Arc::new(REGULAR)));
    letters.load_font_source(Source::Binary(Arc::new(BOLD)));
    // What the style asks for last, and what is taken for a family that is not there.
    letters.set_sans_serif_family("DejaVu Sans");
    letters.set_serif_family("DejaVu Sans");
    Arc::new(letters)
});

/// Why a sheet has no PNG.
#[derive(Debug, Error)]
pub enum RasterError {
    /// The renderer does not understand the SVG.
    #[error("the chart cannot be rendered: {0}")]
    Svg(#[from] resvg::usvg::Error),
    /// There is no memory for that many pixels.
    #[error("an image of {0} by {1} pixels is too large")]
    Size(u32, u32),
    /// The pixels cannot be compressed.
    #[error("the image cannot be written as PNG: {0}")]
    Encoding(String),
}

impl Sheet {
    /// The image as PNG, twice as fine as the SVG and with letters that do not depend on the machine.
    ///
    /// # Errors
    /// When it has more pixels than an image may have.
    pub fn to_png(&self) -> Result<Vec<u8>, RasterError> {
        let options = Options { fontdb: Arc::clone(&LETTERS), ..Options::default() };
        let tree = Tree::from_str(&self.to_svg(), &options)?;
        let pixels = |length: f32| (SCALE * length).ceil() as u32;
        let (width, height) = (pixels(tree.size().width()), pixels(tree.size().height()));
        let too_large = RasterError::Size(width, height);
        let mut pixmap = Pixmap::new(width, height).ok_or(too_large)?;
        // The corners of the card are round, and paper is white.
        pixmap.fill(Color::WHITE);
        resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut pixmap.as_mut());
        pixmap.encode_png().map_err(|error| RasterError::Encoding(error.to_string()))
    }
}
