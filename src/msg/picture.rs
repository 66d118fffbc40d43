//! What viewers draw: point clouds and markers, field by field as ROS 2 Jazzy defines them.

mod marker;

use serde::{Deserialize, Serialize};

pub use marker::{CompressedImage, Marker, MarkerArray, MeshFile, UVCoordinate};

use super::schema::describe;
use super::standard::Header;
use super::transforms::Quaternion;

/// `geometry_msgs/Point`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// x.
    pub x: f64,
    /// y.
    pub y: f64,
    /// z.
    pub z: f64,
}

impl From<[f64; 3]> for Point {
    fn from([x, y, z]: [f64; 3]) -> Self {
        Self { x, y, z }
    }
}

/// `geometry_msgs/Pose`; the default is the origin of its frame, not turned.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Where it is.
    pub position: Point,
    /// How it is turned.
    pub orientation: Quaternion,
}

/// `std_msgs/ColorRGBA`; each component from 0 to 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ColorRGBA {
    /// Red.
    pub r: f32,
    /// Green.
    pub g: f32,
    /// Blue.
    pub b: f32,
    /// Opacity.
    pub a: f32,
}

/// `sensor_msgs/PointField`: one number of each point of a [`PointCloud2`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointField {
    /// What it is called.
    pub name: String,
    /// Bytes before it in a point.
    pub offset: u32,
    /// Its type: [`PointField::UINT32`] or [`PointField::FLOAT32`] here.
    pub datatype: u8,
    /// How many of it stand there.
    pub count: u32,
}

impl PointField {
    /// Type of an unsigned 32-bit number.
    pub const UINT32: u8 = 6;
    /// Type of a 32-bit floating point number.
    pub const FLOAT32: u8 = 7;
}

/// `sensor_msgs/PointCloud2`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PointCloud2 {
    /// Time and frame.
    pub header: Header,
    /// Rows: 1 where points are in no order.
    pub height: u32,
    /// Points in a row.
    pub width: u32,
    /// The numbers of a point.
    pub fields: Vec<PointField>,
    /// Whether `data` is big endian.
    pub is_bigendian: bool,
    /// Bytes of a point.
    pub point_step: u32,
    /// Bytes of a row.
    pub row_step: u32,
    /// The points.
    pub data: Vec<u8>,
    /// Whether no point is invalid.
    pub is_dense: bool,
}

describe!(
    Point,
    "geometry_msgs",
    "float64 x\nfloat64 y\nfloat64 z\n",
    &[],
    "6963084842a9b04494d6b2941d11444708d892da2f4b09843b9c43f42a7f6881"
);
describe!(
    Pose,
    "geometry_msgs",
    "Point position\nQuaternion orientation\n",
    &[Point::TYPE, Quaternion::TYPE],
    "d501954e9476cea2996984e812054b68026ae0bfae789d9a10b23daf35cc90fa"
);
describe!(
    ColorRGBA,
    "std_msgs",
    "float32 r\nfloat32 g\nfloat32 b\nfloat32 a\n",
    &[],
    "77a7a5b9ae477306097665106e0413ba74440245b1f3d0c6d6405fe5c7813fe8"
);
describe!(
    PointField,
    "sensor_msgs",
    "uint8 INT8=1\nuint8 UINT8=2\nuint8 INT16=3\nuint8 UINT16=4\nuint8 INT32=5\n\
     uint8 UINT32=6\nuint8 FLOAT32=7\nuint8 FLOAT64=8\n\
     string name\nuint32 offset\nuint8 datatype\nuint32 count\n",
    &[],
    "5c6a4750728c2bcfbbf7037225b20b02d4429634732146b742dee1726637ef01"
);
describe!(
    PointCloud2,
    "sensor_msgs",
    "std_msgs/Header header\nuint32 height\nuint32 width\nPointField[] fields\n\
     bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense\n",
    &[PointField::TYPE, Header::TYPE],
    "9198cabf7da3796ae6fe19c4cb3bdd3525492988c70522628af5daa124bae2b5"
);
