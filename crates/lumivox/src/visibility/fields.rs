//! Fields on the GPU: all maps of all of them in one 3D texture, and the tables that find a map and a texel.

use glam::{UVec3, Vec4};
use lumivox_core::{PackedField, PackedMapping, PackedMaps, PackedStorage, hit_bias};

use super::Objects;
use crate::gpu::{Bindings, Buffer, Gpu, GpuError, Texture};

crate::gpu_struct! {
    /// A field as shaders see it.
    pub struct FieldUniform {
        /// First texel of its maps.
        pub maps_origin: UVec3,
        /// Maps along x of a slice.
        pub columns: u32,
        /// First texel of its normals.
        pub normals_origin: UVec3,
        /// Maps along y of a slice.
        pub rows: u32,
        /// Maps of normals along x of a slice.
        pub normals_columns: u32,
        /// And along y.
        pub normals_rows: u32,
        /// How distances are kept.
        pub storage: u32,
        /// How directions are spread.
        pub mapping: u32,
        /// Directions along a side of a map.
        pub side: u32,
        /// Divisions of an octant's side.
        pub divisions: u32,
        /// Its first sample point.
        pub first_point: u32,
        /// Its first cell of the table.
        pub first_cell: u32,
        /// Cells along the table's side.
        pub table_side: u32,
        /// Its first mean depth.
        pub first_depth: u32,
        /// Whether there are normals.
        pub has_normals: u32,
        /// Unused.
        pub reserved_0: u32,
    }
}

/// The bounding sphere of a field, in its object's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct FieldSphere {
    pub(super) center: glam::Vec3,
    pub(super) radius: f32,
    /// How far ahead hits must lie, in radii.
    pub(super) bias: f32,
}

/// Visibility fields of some rigid objects, uploaded once. Any number of instances share one.
///
/// Memory is that of the maps, and 16 bytes per sample point and 4 per cell of the point table (256 KiB for 4226 points) for
/// each number of points in use. Fields of bytes share one texture of bytes; with floats or bits, texels have 4 bytes, and
/// fields of bytes cannot be among them.
#[derive(Debug)]
pub struct Fields {
    pub(super) uniforms: Buffer,
    pub(super) points: Buffer,
    pub(super) table: Buffer,
    pub(super) depths: Buffer,
    pub(super) maps: Texture,
    pub(super) normals: Texture,
    pub(super) spheres: Vec<FieldSphere>,
}

impl Fields {
    /// Uploads fields; their number in this order is what [`Placement::field`](super::Placement::field) means.
    ///
    /// # Errors
    /// No fields, sizes that do not fit the device or contradict each other, and bytes mixed with other storage.
    pub fn new(gpu: &Gpu, fields: &[&PackedField]) -> Result<Self, GpuError> {
        let refuse = |reason: String| Err(GpuError::Validation(reason));
        if fields.is_empty() {
            return refuse("visibility/fields: there are none".to_owned());
        }
        let bytes = fields.iter().filter(|f| f.storage == PackedStorage::Byte).count();
        if bytes != 0 && bytes != fields.len() {
            return refuse("visibility/fields: fields of bytes and others do not share a texture".to_owned());
        }
        fields.iter().try_for_each(|field| check(field))?;
        let format = match bytes {
            0 => wgpu::TextureFormat::R32Uint,
            _ => wgpu::TextureFormat::R8Uint,
        };
        let maps: Vec<_> = fields.iter().map(|f| Some(&f.maps)).collect();
        let normals: Vec<_> = fields.iter().map(|f| f.normals.as_ref()).collect();
        let maps = Volume::new(gpu, "visibility/maps", format, &maps)?;
        let normals = Volume::new(gpu, "visibility/normals", wgpu::TextureFormat::Rg8Sint, &normals)?;

        let (mut points, mut table, mut depths) = (Vec::new(), Vec::new(), Vec::new());
        let mut shared: Vec<(u32, [u32; 2])> = Vec::new();
        let mut uniforms = Vec::new();
        for (n, field) in fields.iter().enumerate() {
            let known = shared.iter().find(|(divisions, _)| *divisions == field.divisions);
            let [first_point, first_cell] = match known {
                Some((_, first)) => *first,
                None => {
                    let first = [points.len() as u32, table.len() as u32];
                    points.extend(field.points.iter().map(|p| p.extend(0.0)));
                    table.extend_from_slice(&field.table);
                    shared.push((field.divisions, first));
                    first
                }
            };
            let layout = field.normals.as_ref().map_or([1, 1], |n| [n.columns, n.rows]);
            uniforms.push(FieldUniform {
                maps_origin: maps.origins[n],
                columns: field.maps.columns,
                normals_origin: normals.origins[n],
                rows: field.maps.rows,
                normals_columns: layout[0],
                normals_rows: layout[1],
                storage: field.storage as u32,
                mapping: match field.mapping {
                    PackedMapping::Uniform => 0,
                    PackedMapping::Rejection => 1,
                    PackedMapping::Concentric => 2,
                },
                side: field.side,
                divisions: field.divisions,
                first_point,
                first_cell,
                table_side: field.table_side,
                first_depth: depths.len() as u32,
                has_normals: u32::from(field.normals.is_some()),
                reserved_0: 0,
            });
            depths.extend_from_slice(&field.depths);
        }
        depths.resize(depths.len().max(1), 0.0);
        let spheres = fields.iter().map(|f| FieldSphere {
            center: f.center,
            radius: f.radius,
            bias: hit_bias(f.divisions),
        });
        let points: Vec<Vec4> = points;
        Ok(Self {
            uniforms: Buffer::storage_with(gpu, "visibility/fields", &uniforms)?,
            points: Buffer::storage_with(gpu, "visibility/points", &points)?,
            table: Buffer::storage_with(gpu, "visibility/table", &table)?,
            depths: Buffer::storage_with(gpu, "visibility/depths", &depths)?,
            maps: maps.texture,
            normals: normals.texture,
            spheres: spheres.collect(),
        })
    }

    /// Number of fields.
    pub fn len(&self) -> usize {
        self.spheres.len()
    }

    /// Never: there is at least one.
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty()
    }

    /// Binds what a look-up in the fields of these objects reads.
    pub(super) fn bind<'a>(&'a self, objects: &'a Objects) -> Bindings<'a> {
        Bindings::new()
            .read("objects", &objects.buffer)
            .read("fields", &self.uniforms)
            .read("field_points", &self.points)
            .read("field_table", &self.table)
            .read("field_depths", &self.depths)
            .read("field_maps", &self.maps)
    }
}

/// Whether a field's numbers fit each other, so that no shader reads beside them.
fn check(field: &PackedField) -> Result<(), GpuError> {
    let PackedField { side, divisions, table_side, .. } = *field;
    let count = u64::from(divisions).pow(2) * 4 + 4 * u64::from(divisions) + 2;
    let fits = |maps: &PackedMaps, width: u32, texel: u64| {
        let [x, y, z] = maps.size.map(u64::from);
        let in_slice = u64::from(maps.columns) * u64::from(maps.rows);
        let wide = u64::from(maps.columns) * u64::from(width) <= x;
        let high = u64::from(maps.rows) * u64::from(side) <= y;
        let room = in_slice.checked_mul(z).is_some_and(|maps| maps >= count);
        let texels = x.checked_mul(y).and_then(|n| n.checked_mul(z)).and_then(|n| n.checked_mul(texel));
        in_slice > 0 && wide && high && room && texels == Some(maps.bytes.len() as u64)
    };
    let (width, texel) = match field.storage {
        PackedStorage::Byte => (side, 1),
        PackedStorage::Float => (side, 4),
        PackedStorage::Bit => (side / 32, 4),
    };
    let depths = if field.storage == PackedStorage::Bit { count } else { 0 };
    let sound = (32..=2048).contains(&side)
        && (1..=64).contains(&divisions)
        && field.points.len() as u64 == count
        && field.table.len() as u64 == u64::from(table_side).pow(2)
        && table_side > 0
        && field.depths.len() as u64 == depths
        && field.radius > 0.0
        && field.radius.is_finite()
        && field.center.is_finite()
        && fits(&field.maps, width, texel)
        && field.normals.as_ref().is_none_or(|normals| fits(normals, side, 2));
    if sound {
        return Ok(());
    }
    Err(GpuError::Validation("visibility/fields: the numbers of a field do not fit each other".to_owned()))
}

/// Boxes of maps in one 3D texture.
struct Volume {
    texture: Texture,
    /// Where each box begins.
    origins: Vec<UVec3>,
}

impl Volume {
    /// Places boxes in equal rooms, z first, and uploads them. Without any box there is one texel.
    fn new(
        gpu: &Gpu,
        label: &str,
        format: wgpu::TextureFormat,
        boxes: &[Option<&PackedMaps>],
    ) -> Result<Self, GpuError> {
        let limit = gpu.device.limits().max_texture_dimension_3d;
        let room = boxes.iter().flatten().fold(UVec3::ONE, |room, maps| room.max(maps.size.into()));
        let most = UVec3::splat(limit) / room;
        let count = boxes.iter().flatten().count().max(1) as u32;
        let deep = count.clamp(1, most.z.max(1));
        let high = count.div_ceil(deep).clamp(1, most.y.max(1));
        let wide = count.div_ceil(deep * high);
        if most.min_element() == 0 || wide > most.x {
            return Err(GpuError::Validation(format!(
                "{label}: {count} boxes of up to {room} texels do not fit a 3D texture of {limit} texels a side"
            )));
        }
        let size = UVec3::new(wide, high, deep) * room;
        let raw = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let texture = Texture::from_raw(gpu, raw);
        let mut origins = Vec::new();
        let mut placed = 0;
        for maps in boxes {
            let Some(maps) = maps else {
                origins.push(UVec3::ZERO);
                continue;
            };
            let place = UVec3::new(placed / (deep * high), placed / deep % high, placed % deep) * room;
            placed += 1;
            origins.push(place);
            let mut target = texture.raw.as_image_copy();
            target.origin = wgpu::Origin3d { x: place.x, y: place.y, z: place.z };
            let row = maps.bytes.len() as u64 / (u64::from(maps.size[1]) * u64::from(maps.size[2]));
            let layout = wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(row as u32),
                rows_per_image: Some(maps.size[1]),
            };
            gpu.queue.write_texture(target, &maps.bytes, layout, extent(maps.size.into()));
        }
        Ok(Self { texture, origins })
    }
}

fn extent(size: UVec3) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: size.z }
}
