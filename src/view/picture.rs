//! Pictures of an increment for 3D viewers: a cloud of the grains, and markers.
//!
//! Packs are millimetres, viewers are made for robots. So pictures stand in a frame of their own,
//! [`VIEW_FRAME`], in which everything that is a length of the
//! picture is [`Painter::scale`] times what it is in the pack.
//!
//! Every marker array has the same markers under the same names, those without anything to draw
//! as deleted: each array takes the place of the one before it, and nothing flickers or stays.

mod caption;
mod cement;
mod chains;
mod cloud;
mod colormap;
mod room;
mod sides;
mod spheres;
mod walls;

use crate::msg::picture::{Marker, MarkerArray, Point, PointCloud2};
use crate::msg::standard::Header;
use crate::msg::topics::VIEW_FRAME;
use crate::plane::Cell;
use crate::report::{GrainMotion, Grains, Measures};
use crate::scene::{Choice, ColorBy, Normal, Scene, View};
use crate::wall::Bounds;

/// Most grains that are drawn as spheres; of larger packs the cloud has to do.
pub const MOST_SPHERES: usize = 20_000;

/// Grains of all increments together that are recorded at first: a hundred increments of 300.
const GRAINS_AT_FIRST: u64 = 30_000;

/// After that, one increment of so many is.
const EACH: u64 = 10;

/// Draws increments of one specimen.
#[derive(Clone, Debug, PartialEq)]
pub struct Painter {
    name: String,
    view: View,
    scale: f64,
    /// Increments from the start that are all recorded when nothing is said of it.
    first: u64,
    /// Whether there is cement to be drawn.
    cemented: bool,
    /// Whether the grains are discs.
    plane: bool,
    /// What surrounds them.
    cell: Cell,
}

impl Painter {
    /// For the specimen of `scene`, so many `grains` in the box `bounds`.
    #[must_use]
    pub fn new(scene: &Scene, bounds: &Bounds, grains: usize) -> Self {
        let scale = match scene.view.scale {
            Choice::Given(scale) => scale,
            Choice::Auto => power_of_ten(bounds),
        };
        let first = (GRAINS_AT_FIRST / grains.max(1) as u64).max(EACH);
        let cemented = matches!(scene.contact.normal, Normal::Cement(_));
        let (name, plane) = (scene.name.clone(), scene.dimension == 2);
        let cell = Cell::new(&scene.walls, bounds);
        Self { name, view: scene.view, scale, first, cemented, plane, cell }
    }

    /// Size of the picture over that of the specimen.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Whether the pictures of this increment are recorded.
    #[must_use]
    pub fn records(&self, increment: u64) -> bool {
        match self.view.every {
            Choice::Auto => increment < self.first || increment.is_multiple_of(EACH),
            Choice::Given(every) => increment.is_multiple_of(every),
        }
    }

    /// The grains as points: `x`, `y`, `z` and `radius` \[m, scaled\], `pressure` \[Pa\],
    /// `displacement` since the start \[m, as it is\], and `id`, the row of the pack file from 0.
    /// `None` when the measures are without [grains](Measures::grains).
    #[must_use]
    pub fn cloud(&self, measures: &Measures) -> Option<PointCloud2> {
        let grains = measures.grains.as_ref()?;
        Some(cloud::cloud(header(measures), grains, self.scale))
    }

    /// Spheres binned by radius and coloured, force chains, walls, a line of text, and the bonds and
    /// cracks of a scene with cement. `None` when
    /// the measures are without [grains](Measures::grains); without a contact network there are no
    /// chains, without a state the text is short.
    #[must_use]
    pub fn markers(&self, measures: &Measures) -> Option<MarkerArray> {
        let grains = measures.grains.as_ref()?;
        let canvas = Canvas { header: header(measures), scale: self.scale, plane: self.plane };
        let mut markers = match self.plane {
            true => sides::sides(&canvas, &self.cell, &measures.walls),
            false => room::room(&canvas, &self.cell, measures),
        };
        markers.push(caption::caption(&canvas, &self.name, measures));
        markers.extend(chains::chains(&canvas, grains, measures.network.as_ref()));
        if self.cemented {
            markers.extend(cement::cement(&canvas, grains, measures.bonds.as_ref()));
        }
        if grains.radius.len() <= MOST_SPHERES {
            let values = values(grains, measures.motion.as_ref(), self.view.color);
            markers.extend(spheres::spheres(&canvas, &self.view, grains, &values));
        }
        Some(MarkerArray { markers })
    }
}

fn header(measures: &Measures) -> Header {
    Header { stamp: measures.stamp.into(), frame_id: VIEW_FRAME.into() }
}

/// The power of ten that brings the largest side of the box nearest to 1 m.
fn power_of_ten(bounds: &Bounds) -> f64 {
    let largest = bounds.sides().into_iter().fold(0.0, f64::max);
    10f64.powi(-largest.log10().round() as i32)
}

/// What spheres are coloured by, one number a grain. Where there is none, as D²min of a grain without
/// neighbours or rotations without friction, it is NaN.
fn values(grains: &Grains, motion: Option<&GrainMotion>, by: ColorBy) -> Vec<f64> {
    let lengths = |vectors: &[[f64; 3]]| vectors.iter().map(length).collect();
    let mut values = match (by, motion) {
        (ColorBy::Force, _) => grains.pressure.clone(),
        (ColorBy::Displacement, _) => lengths(&grains.displacement),
        (ColorBy::NonAffine, Some(motion)) => lengths(&motion.non_affine),
        (ColorBy::Rotation, Some(motion)) => lengths(&motion.rotation),
        (ColorBy::D2min, Some(motion)) => motion.d2min.clone(),
        (_, None) => Vec::new(),
    };
    values.resize(grains.radius.len(), f64::NAN);
    values
}

fn length(vector: &[f64; 3]) -> f64 {
    vector.iter().map(|component| component * component).sum::<f64>().sqrt()
}

/// Where and when markers are drawn, and how large.
struct Canvas {
    header: Header,
    scale: f64,
    plane: bool,
}

impl Canvas {
    fn marker(&self, namespace: &str, id: usize, kind: i32) -> Marker {
        Marker {
            header: self.header.clone(),
            ns: namespace.into(),
            id: id as i32,
            r#type: kind,
            action: Marker::ADD,
            ..Marker::default()
        }
    }

    /// A point of the pack \[m\]. Single precision is more than a screen shows, and leaves half of
    /// the bytes zero for whoever compresses them.
    fn point(&self, at: [f64; 3]) -> Point {
        at.map(|x| f64::from((x * self.scale) as f32)).into()
    }
}
