//! Where frames are, as tf2 says it.

use serde::{Deserialize, Serialize};

use super::schema::describe;
use super::standard::{Header, Vector3};

/// `geometry_msgs/Quaternion`; the default turns nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quaternion {
    /// x.
    pub x: f64,
    /// y.
    pub y: f64,
    /// z.
    pub z: f64,
    /// w.
    pub w: f64,
}

impl Default for Quaternion {
    fn default() -> Self {
        Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 }
    }
}

/// `geometry_msgs/Transform`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Transform {
    /// Origin of the child in its parent \[m\].
    pub translation: Vector3,
    /// How the child is turned.
    pub rotation: Quaternion,
}

/// `geometry_msgs/TransformStamped`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TransformStamped {
    /// Time and parent frame.
    pub header: Header,
    /// The child frame.
    pub child_frame_id: String,
    /// Where it is.
    pub transform: Transform,
}

/// `tf2_msgs/TFMessage`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TFMessage {
    /// One a frame.
    pub transforms: Vec<TransformStamped>,
}

describe!(
    Quaternion,
    "geometry_msgs",
    "float64 x\nfloat64 y\nfloat64 z\nfloat64 w\n",
    &[],
    "8a765f66778c8ff7c8ab94afcc590a2ed5325a1d9a076ffff38fbce36f458684"
);
describe!(
    Transform,
    "geometry_msgs",
    "Vector3 translation\nQuaternion rotation\n",
    &[Quaternion::TYPE, Vector3::TYPE],
    "beb83fbe698636351461f6f35d1abb20010c43d55374d81bd041f1ba2581fddc"
);
describe!(
    TransformStamped,
    "geometry_msgs",
    "std_msgs/Header header\nstring child_frame_id\nTransform transform\n",
    &[Transform::TYPE, Header::TYPE],
    "0a241f87d04668d94099cbb5ba11691d5ad32c2f29682e4eb5653424bd275206"
);
describe!(
    TFMessage,
    "tf2_msgs",
    "geometry_msgs/TransformStamped[] transforms\n",
    &[TransformStamped::TYPE],
    "e369d0f05a23ae52508854b66f6aa0437f3449d652e8cbf22d5abe85d020f087"
);
