//! STL, binary and ASCII. Normals in the file are ignored: they are the face's anyway, where they are right at all.

use std::io::Cursor;

use super::guard::fenced;
use super::source::Source;
use crate::mesh::{RawMesh, check_limit};
use crate::{Limits, SceneError};

/// Bytes before the first triangle of a binary file, the last four of them the count, and of each triangle.
const HEADER: usize = 84;
const RECORD: usize = 50;

/// Reads a file into one mesh, three vertices to a triangle.
pub(super) fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<RawMesh, SceneError> {
    let mut raw = RawMesh::default();
    let size = bytes.len() as u64;
    let stated = bytes.get(HEADER - 4..HEADER).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let needed = stated.map(|n| HEADER as u64 + u64::from(n) * RECORD as u64);
    // Binary files may start with "solid" too, so a size that fits decides first.
    if needed != Some(size) && bytes.trim_ascii_start().starts_with(b"solid") {
        // The shortest facet takes more bytes than that.
        check_limit(source.name(), "the number of triangles", size / 40, limits.triangles)?;
        fenced(source.name(), "STL", || {
            let fail = |e: std::io::Error| source.malformed(format!("is no valid ASCII STL: {e}"));
            let mut cursor = Cursor::new(bytes.trim_ascii_start());
            for triangle in stl_io::create_stl_reader(&mut cursor).map_err(fail)? {
                raw.positions.extend(triangle.map_err(fail)?.vertices.map(|v| v.0));
            }
            Ok(())
        })?;
    } else {
        let (Some(stated), Some(needed)) = (stated, needed) else {
            return Err(source.malformed(format!("has {size} bytes, too few for a binary STL")));
        };
        if needed > size {
            return Err(source
                .malformed(format!("states {stated} triangles, which take {needed} bytes, but has {size}")));
        }
        check_limit(source.name(), "the number of triangles", u64::from(stated), limits.triangles)?;
        let number = |b: &[u8], at: usize| f32::from_le_bytes([b[at], b[at + 1], b[at + 2], b[at + 3]]);
        raw.positions = bytes[HEADER..needed as usize]
            .chunks_exact(RECORD)
            .flat_map(|r| [12, 24, 36].map(|at| [number(r, at), number(r, at + 4), number(r, at + 8)]))
            .collect();
    }
    raw.indices = (0..raw.positions.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(raw)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn binary_files_that_start_with_solid_are_binary() {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, b' ');
        bytes.extend(1u32.to_le_bytes());
        let numbers = [0.0f32, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        bytes.extend([0, 0]);
        let source = Source::of_memory("a.stl");
        let raw = import(&source, &bytes, &Limits::default()).unwrap();
        assert_eq!(raw.positions, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        bytes[0] = b'x';
        bytes[80] = 2;
        let text = import(&source, &bytes, &Limits::default()).unwrap_err().to_string();
        assert_eq!(text, "a.stl: states 2 triangles, which take 184 bytes, but has 134");
        assert!(import(&source, b"short", &Limits::default()).is_err());
    }
}
