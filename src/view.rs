//! Pictures of an increment for viewers ([`picture`]), and charts.
//!
//! Charts of a recording and of a bench, written as SVG and PNG.
//!
//! [`Chart`] holds what is to be seen, [`Sheet`] lays charts out on a white card and writes them.
//! What cannot be drawn (NaN, infinity, zero on a logarithmic axis) breaks a line; a series
//! without a single point is left out, and the chart says so.

pub mod beside;
pub mod biaxial;
mod chart;
mod draw;
#[cfg(feature = "mcap")]
mod forces;
#[cfg(feature = "foxglove")]
pub mod foxglove;
#[cfg(feature = "mcap")]
mod history;
mod layout;
pub mod mohr;
#[cfg(feature = "mcap")]
mod motions;
#[cfg(feature = "mcap")]
mod panels;
pub mod picture;
mod precision;
#[cfg(feature = "png")]
mod raster;
pub mod rose;
#[cfg(feature = "mcap")]
mod run;
mod scale;
mod sheet;
mod svg;
mod thin;
mod ticks;
mod unit;

pub use chart::{Chart, Pattern, Series, Stroke};
#[cfg(feature = "mcap")]
pub use history::History;
#[cfg(feature = "mcap")]
pub use motions::Motions;
#[cfg(feature = "mcap")]
pub use panels::sheets;
pub use precision::work_precision;
#[cfg(feature = "png")]
pub use raster::RasterError;
#[cfg(feature = "mcap")]
pub use run::{Forces, Load, Run};
pub use scale::{Axis, Kind};
pub use sheet::Sheet;
pub use ticks::Ticks;
pub use unit::Unit;
