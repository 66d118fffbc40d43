//! Grains as a point cloud.

use super::length;
use crate::msg::picture::{PointCloud2, PointField};
use crate::msg::standard::Header;
use crate::report::Grains;

const FIELDS: [(&str, u8); 8] = [
    ("x", PointField::FLOAT32),
    ("y", PointField::FLOAT32),
    ("z", PointField::FLOAT32),
    ("radius", PointField::FLOAT32),
    ("pressure", PointField::FLOAT32),
    ("displacement", PointField::FLOAT32),
    ("id", PointField::UINT32),
    ("turn", PointField::FLOAT32),
];

/// Bytes of a field.
const WIDTH: u32 = 4;

pub(super) fn cloud(header: Header, grains: &Grains, scale: f64) -> PointCloud2 {
    // Spheres do not have the last one.
    let fields = &FIELDS[..FIELDS.len() - usize::from(grains.turn.is_empty())];
    let step = WIDTH * fields.len() as u32;
    let count = grains.radius.len() as u32;
    let mut data = Vec::with_capacity((step * count) as usize);
    for grain in 0..grains.radius.len() {
        let [x, y, z] = grains.position[grain].map(|x| x * scale);
        for number in [
            x,
            y,
            z,
            grains.radius[grain] * scale,
            grains.pressure[grain],
            length(&grains.displacement[grain]),
        ] {
            data.extend((number as f32).to_le_bytes());
        }
        data.extend((grain as u32).to_le_bytes());
        data.extend(
            grains.turn.get(grain).into_iter().flat_map(|&turn| (turn as f32).to_le_bytes()),
        );
    }
    let field = |(place, &(name, datatype)): (usize, &(&str, u8))| PointField {
        name: name.into(),
        offset: WIDTH * place as u32,
        datatype,
        count: 1,
    };
    PointCloud2 {
        header,
        height: 1,
        width: count,
        fields: fields.iter().enumerate().map(field).collect(),
        is_bigendian: false,
        point_step: step,
        row_step: step * count,
        data,
        is_dense: true,
    }
}
