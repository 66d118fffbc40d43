//! `visualization_msgs`, of which only markers without textures and meshes are used here.

use serde::{Deserialize, Serialize};

use super::{ColorRGBA, Point, Pose};
use crate::msg::schema::describe;
use crate::msg::standard::{Duration, Header, Vector3};

/// `sensor_msgs/CompressedImage`; empty here.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CompressedImage {
    /// Time and frame.
    pub header: Header,
    /// Format of `data`.
    pub format: String,
    /// The image.
    pub data: Vec<u8>,
}

/// `visualization_msgs/UVCoordinate`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct UVCoordinate {
    /// Along the width of a texture, from 0 to 1.
    pub u: f32,
    /// Along its height, from 0 to 1.
    pub v: f32,
}

/// `visualization_msgs/MeshFile`; empty here.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MeshFile {
    /// Name with an extension that tells the format.
    pub filename: String,
    /// The mesh.
    pub data: Vec<u8>,
}

/// `visualization_msgs/Marker`. Namespace and id name it: one of the same name takes its place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Marker {
    /// Time and frame.
    pub header: Header,
    /// Namespace, as `spheres`.
    pub ns: String,
    /// Number in the namespace.
    pub id: i32,
    /// What it is: [`Marker::CUBE`] and its kin.
    pub r#type: i32,
    /// What becomes of it: [`Marker::ADD`] or [`Marker::DELETE`].
    pub action: i32,
    /// Where it is; points of lists are relative to it.
    pub pose: Pose,
    /// Its size: the sides of a cube, three times the diameter of spheres, the width of lines in x,
    /// the height of letters in z.
    pub scale: Vector3,
    /// Its colour, where `colors` has none.
    pub color: ColorRGBA,
    /// How long it lasts; zero means until it is deleted.
    pub lifetime: Duration,
    /// Whether it moves with its frame.
    pub frame_locked: bool,
    /// Centres of spheres, or ends of lines in pairs.
    pub points: Vec<Point>,
    /// A colour a point, or none.
    pub colors: Vec<ColorRGBA>,
    /// Texture by name; empty here.
    pub texture_resource: String,
    /// Texture; empty here.
    pub texture: CompressedImage,
    /// Where each point is on the texture; empty here.
    pub uv_coordinates: Vec<UVCoordinate>,
    /// What a text says.
    pub text: String,
    /// Mesh by name; empty here.
    pub mesh_resource: String,
    /// Mesh; empty here.
    pub mesh_file: MeshFile,
    /// Whether a mesh brings its materials.
    pub mesh_use_embedded_materials: bool,
}

impl Marker {
    /// Type of a cube.
    pub const CUBE: i32 = 1;
    /// Type of lines, each between two points.
    pub const LINE_LIST: i32 = 5;
    /// Type of a cylinder along z.
    pub const CYLINDER: i32 = 3;
    /// Type of a line through its points.
    pub const LINE_STRIP: i32 = 4;
    /// Type of spheres of one size.
    pub const SPHERE_LIST: i32 = 7;
    /// Type of a text that faces whoever looks.
    pub const TRIANGLE_LIST: i32 = 11;
    /// See [`Marker::type`](Marker).
    pub const TEXT_VIEW_FACING: i32 = 9;
    /// Draw it, in place of the one of the same name.
    pub const ADD: i32 = 0;
    /// Draw it no more.
    pub const DELETE: i32 = 2;
}

/// `visualization_msgs/MarkerArray`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MarkerArray {
    /// The markers.
    pub markers: Vec<Marker>,
}

describe!(
    CompressedImage,
    "sensor_msgs",
    "std_msgs/Header header\nstring format\nuint8[] data\n",
    &[Header::TYPE],
    "15640771531571185e2efc8a100baf923961a4d15d5569652e6cb6691e8e371a"
);
describe!(
    UVCoordinate,
    "visualization_msgs",
    "float32 u\nfloat32 v\n",
    &[],
    "f27f7ed21fe360c6066944f856b801a0c0d1e94e815b6886444b42d90b196a26"
);
describe!(
    MeshFile,
    "visualization_msgs",
    "string filename\nuint8[] data\n",
    &[],
    "7710ece15a148fb7c9b546364cfb215bb06098087bd6394fe5b73a493508f8c4"
);
describe!(
    Marker,
    "visualization_msgs",
    "int32 ARROW=0\nint32 CUBE=1\nint32 SPHERE=2\nint32 CYLINDER=3\nint32 LINE_STRIP=4\n\
     int32 LINE_LIST=5\nint32 CUBE_LIST=6\nint32 SPHERE_LIST=7\nint32 POINTS=8\n\
     int32 TEXT_VIEW_FACING=9\nint32 MESH_RESOURCE=10\nint32 TRIANGLE_LIST=11\n\
     int32 ARROW_STRIP=12\nint32 ADD=0\nint32 MODIFY=0\nint32 DELETE=2\nint32 DELETEALL=3\n\
     std_msgs/Header header\nstring ns\nint32 id\nint32 type\nint32 action\n\
     geometry_msgs/Pose pose\ngeometry_msgs/Vector3 scale\nstd_msgs/ColorRGBA color\n\
     builtin_interfaces/Duration lifetime\nbool frame_locked\ngeometry_msgs/Point[] points\n\
     std_msgs/ColorRGBA[] colors\nstring texture_resource\n\
     sensor_msgs/CompressedImage texture\nUVCoordinate[] uv_coordinates\nstring text\n\
     string mesh_resource\nMeshFile mesh_file\nbool mesh_use_embedded_materials\n",
    &[
        Duration::TYPE,
        Point::TYPE,
        Pose::TYPE,
        Vector3::TYPE,
        CompressedImage::TYPE,
        ColorRGBA::TYPE,
        Header::TYPE,
        MeshFile::TYPE,
        UVCoordinate::TYPE,
    ],
    "45b13ccf791f225962bf74e746f9644518855d783a6f42ba0cc14fde2b4f3ce0"
);
describe!(
    MarkerArray,
    "visualization_msgs",
    "Marker[] markers\n",
    &[Marker::TYPE],
    "86cb8800b6fb05b5eff1abd7a56f62a5641d3ae9a1c29e78e67e704f1d067dcf"
);
