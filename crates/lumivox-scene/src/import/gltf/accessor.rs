//! Reads accessors into plain vectors. Ranges are checked in 64 bits against the bytes that are really there, before
//! anything is allocated, so no number in a file is believed.

use gltf::json::Root;
use gltf::json::accessor::{Accessor, ComponentType as C, Type};
use gltf::json::validation::Checked::{self, Valid};

use crate::SceneError;
use crate::import::source::Source;

/// The buffers of an asset and the JSON that says what is in them.
pub(super) struct Reader<'a> {
    pub(super) source: &'a Source,
    pub(super) root: &'a Root,
    pub(super) buffers: &'a [Vec<u8>],
}

/// A run of equally spaced elements within a buffer.
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl<'a> Elements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let (bytes, stride) = (self.bytes, self.stride);
        (0..self.count).map(move |i| &bytes[i * stride..])
    }
}

impl<'a> Reader<'a> {
    fn fail<T>(&self, accessor: usize, what: &str) -> Result<T, SceneError> {
        Err(self.source.malformed(format!("has accessor {accessor} {what}")))
    }

    fn accessor(&self, index: usize) -> Result<&'a Accessor, SceneError> {
        match self.root.accessors.get(index) {
            Some(accessor) => Ok(accessor),
            None => self.fail(index, "named but not listed"),
        }
    }

    /// How many elements the accessor states; not yet checked against its bytes.
    pub(super) fn count(&self, index: usize) -> Result<u64, SceneError> {
        Ok(self.accessor(index)?.count.0)
    }

    /// Bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&'a [u8], SceneError> {
        let view = self.root.buffer_views.get(index);
        let bytes = view.and_then(|v| {
            let buffer = self.buffers.get(v.buffer.value())?;
            let start = usize::try_from(v.byte_offset.unwrap_or_default().0).ok()?;
            let length = usize::try_from(v.byte_length.0).ok()?;
            buffer.get(start..start.checked_add(length)?)
        });
        bytes.ok_or_else(|| self.source.malformed(format!("has buffer view {index} outside of its buffer")))
    }

    /// The elements at `offset` of a view, of `size` bytes each.
    fn elements(
        &self,
        accessor: usize,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        strided: bool,
    ) -> Result<Elements<'a>, SceneError> {
        let bytes = self.view(view)?;
        let stated = self.root.buffer_views[view].byte_stride.map_or(0, |s| s.0);
        let stride = if strided && stated != 0 { stated } else { size };
        if stride < size {
            return self.fail(accessor, &format!("with a stride of {stride} bytes for elements of {size}"));
        }
        let end = count
            .checked_sub(1)
            .map_or(Some(0), |n| n.checked_mul(stride as u64)?.checked_add(size as u64)?.checked_add(offset));
        match end {
            Some(end) if end <= bytes.len() as u64 && offset <= bytes.len() as u64 => {
                Ok(Elements { bytes: &bytes[offset as usize..], stride, count: count as usize })
            }
            _ => {
                let length = bytes.len();
                self.fail(
                    accessor,
                    &format!("of {count} elements reaching beyond its buffer view of {length} bytes"),
                )
            }
        }
    }

    /// Vectors of `N` floats; integers are mapped to 0..1 or -1..1 if the accessor says so. Vectors that are shorter
    /// in the file end in `fill`.
    ///
    /// The caller has checked `count` against its limit.
    pub(super) fn vectors<const N: usize>(
        &self,
        index: usize,
        lengths: std::ops::RangeInclusive<usize>,
        fill: f32,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let accessor = self.accessor(index)?;
        let (component, length) = self.shape(index, accessor)?;
        if !lengths.contains(&length) {
            return self
                .fail(index, &format!("with {length} numbers per element, which does not fit its use"));
        }
        let read = |bytes: &[u8]| -> [f32; N] {
            std::array::from_fn(|i| {
                if i < length {
                    number(&bytes[i * component.size()..], component, accessor.normalized)
                } else {
                    fill
                }
            })
        };
        let size = component.size() * length;
        let count = accessor.count.0;
        let mut out: Vec<[f32; N]> = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.elements(index, view.value(), offset, count, size, true)?.iter().map(read).collect()
            }
            None => vec![std::array::from_fn(|i| if i < length { 0.0 } else { fill }); count as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            let n = sparse.count.0;
            let places = self.sparse_places(index, sparse)?;
            let values = &sparse.values;
            let values =
                self.elements(index, values.buffer_view.value(), values.byte_offset.0, n, size, false)?;
            for (place, bytes) in places.into_iter().zip(values.iter()) {
                match out.get_mut(place as usize) {
                    Some(slot) => *slot = read(bytes),
                    None => return self.fail(index, &format!("with a sparse element {place} of {count}")),
                }
            }
        }
        Ok(out)
    }

    /// Single numbers, scaled as in [`Self::vectors`]. The caller has checked `count` against its limit.
    pub(super) fn scalars(&self, index: usize) -> Result<Vec<f32>, SceneError> {
        Ok(self.vectors::<1>(index, 1..=1, 0.0)?.into_iter().flatten().collect())
    }

    /// Matrices of 4 x 4 floats, by columns. The caller has checked `count` against its limit.
    pub(super) fn matrices(&self, index: usize) -> Result<Vec<[f32; 16]>, SceneError> {
        let accessor = self.accessor(index)?;
        let plain = matches!((&accessor.component_type, &accessor.type_), (Valid(c), Valid(Type::Mat4)) if c.0 == C::F32);
        let Some(view) = accessor.buffer_view.filter(|_| plain && accessor.sparse.is_none()) else {
            return self.fail(index, "where a plain list of 4 x 4 matrices is needed");
        };
        let offset = accessor.byte_offset.unwrap_or_default().0;
        let elements = self.elements(index, view.value(), offset, accessor.count.0, 64, true)?;
        let read = |bytes: &[u8]| std::array::from_fn(|i| number(&bytes[4 * i..], C::F32, false));
        Ok(elements.iter().map(read).collect())
    }

    /// Unsigned integers. The caller has checked `count` against its limit.
    pub(super) fn integers(&self, index: usize) -> Result<Vec<u32>, SceneError> {
        let accessor = self.accessor(index)?;
        let (component, length) = self.shape(index, accessor)?;
        if length != 1 || accessor.sparse.is_some() {
            return self.fail(index, "of indices that is no plain list of numbers");
        }
        match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.unsigned(index, view.value(), offset, accessor.count.0, component, true)
            }
            None => Ok(vec![0; accessor.count.0 as usize]),
        }
    }

    fn unsigned(
        &self,
        index: usize,
        view: usize,
        offset: u64,
        count: u64,
        component: C,
        strided: bool,
    ) -> Result<Vec<u32>, SceneError> {
        let elements = self.elements(index, view, offset, count, component.size(), strided)?;
        Ok(match component {
            C::U8 => elements.iter().map(|b| u32::from(b[0])).collect(),
            C::U16 => elements.iter().map(|b| u32::from(u16::from_le_bytes([b[0], b[1]]))).collect(),
            C::U32 => elements.iter().map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect(),
            C::I8 | C::I16 | C::F32 => return self.fail(index, "of indices that are not unsigned integers"),
        })
    }

    fn sparse_places(
        &self,
        index: usize,
        sparse: &gltf::json::accessor::sparse::Sparse,
    ) -> Result<Vec<u32>, SceneError> {
        let indices = &sparse.indices;
        let Valid(component) = indices.component_type else {
            return self.fail(index, "with sparse indices of an unknown type");
        };
        self.unsigned(
            index,
            indices.buffer_view.value(),
            indices.byte_offset.0,
            sparse.count.0,
            component.0,
            false,
        )
    }

    fn shape(&self, index: usize, accessor: &Accessor) -> Result<(C, usize), SceneError> {
        match (&accessor.component_type, &accessor.type_) {
            (Valid(component), Valid(Type::Scalar)) => Ok((component.0, 1)),
            (Valid(component), Valid(Type::Vec2)) => Ok((component.0, 2)),
            (Valid(component), Valid(Type::Vec3)) => Ok((component.0, 3)),
            (Valid(component), Valid(Type::Vec4)) => Ok((component.0, 4)),
            (Valid(_), Valid(_)) => self.fail(index, "of matrices where vectors are needed"),
            (Checked::Invalid, _) | (_, Checked::Invalid) => self.fail(index, "of an unknown type"),
        }
    }
}

/// One number at the start of `bytes`, which hold at least its size.
fn number(bytes: &[u8], component: C, normalized: bool) -> f32 {
    let scaled = |value: f32, max: f32| if normalized { (value / max).max(-1.0) } else { value };
    match component {
        C::I8 => scaled(f32::from(bytes[0] as i8), 127.0),
        C::U8 => scaled(f32::from(bytes[0]), 255.0),
        C::I16 => scaled(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0),
        C::U16 => scaled(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0),
        C::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32,
        C::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
    }
}
