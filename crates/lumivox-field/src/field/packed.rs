//! A field as a GPU takes it.

use lumivox_core::{PackedField, PackedMapping, PackedMaps, PackedStorage};

use super::{Field, FieldTexture, Texels, TextureLayout};
use crate::directions::Mapping;

impl Field {
    /// The field for `lumivox::visibility`: all maps in one 3D texture (Figure 28), the sample points, and the table that finds
    /// them. `None` if it does not fit the sides that the core tier's textures have.
    pub fn packed(&self) -> Option<PackedField> {
        let FieldTexture { layout, texels, normals, depths } = self.texture()?;
        let (storage, bytes) = match texels {
            Texels::Byte(codes) => (PackedStorage::Byte, codes),
            Texels::Float(values) => (PackedStorage::Float, bytemuck::cast_slice(&values).to_vec()),
            Texels::Bit(words) => (PackedStorage::Bit, bytemuck::cast_slice(&words).to_vec()),
        };
        let normals = if normals.is_empty() {
            None
        } else {
            Some(packed_maps(self.normal_layout()?, bytemuck::cast_slice(&normals).to_vec()))
        };
        let (table_side, table) = self.points.table();
        Some(PackedField {
            center: self.sphere.center,
            radius: self.sphere.radius,
            storage,
            mapping: match self.settings.mapping {
                Mapping::Uniform => PackedMapping::Uniform,
                Mapping::Rejection => PackedMapping::Rejection,
                Mapping::Concentric => PackedMapping::Concentric,
            },
            side: self.settings.directions,
            divisions: self.points.divisions(),
            points: self.points.positions().to_vec(),
            table_side,
            table,
            maps: packed_maps(layout, bytes),
            normals,
            depths,
        })
    }
}

fn packed_maps(layout: TextureLayout, bytes: Vec<u8>) -> PackedMaps {
    PackedMaps { size: layout.size(), columns: layout.columns, rows: layout.rows, bytes }
}
