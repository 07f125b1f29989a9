//! PLY, ASCII and binary: positions, normals, texture coordinates and colours of any number type, polygons cut into
//! fans. Integer colours are taken as sRGB, floating ones as linear. Faces made of strips are not read.

use std::io::BufReader;

use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{
    ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult, PropertyType, ScalarType,
};

use super::fan;
use super::guard::fenced;
use super::source::Source;
use crate::mesh::{RawMesh, check_limit};
use crate::{ImportReport, Limits, SceneError};

/// Reads a file into one mesh.
pub(super) fn import(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    report: &mut ImportReport,
) -> Result<RawMesh, SceneError> {
    fenced(source.name(), "PLY", || read(source, bytes, limits, report))
}

fn read(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    report: &mut ImportReport,
) -> Result<RawMesh, SceneError> {
    let fail = |e: ply_rs_bw::parser::ParseError| {
        let text = e.to_string();
        let first = text.lines().next().unwrap_or_default();
        source.malformed(format!("is no valid PLY: {first}"))
    };
    let mut reader = Reader::new(BufReader::new(bytes));
    let header = Parser::<Skipped>::new().read_header(&mut reader).map_err(fail)?;
    check_counts(source, &header, bytes.len() as u64, limits)?;
    let mut raw = RawMesh::default();
    let mut faces = Vec::new();
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => {
                let rows = Parser::<Vertex>::new().read_payload_for_element(&mut reader, element, &header);
                fill_vertices(&mut raw, &rows.map_err(fail)?, element);
            }
            "face" => {
                let rows = Parser::<Face>::new().read_payload_for_element(&mut reader, element, &header);
                faces = rows.map_err(fail)?;
            }
            other => {
                if other == "tristrips" {
                    report.warn("triangle strips of the PLY file are left out");
                }
                Parser::<Skipped>::new()
                    .read_payload_for_element(&mut reader, element, &header)
                    .map_err(fail)?;
            }
        }
    }
    let count = raw.positions.len();
    for face in &faces {
        if let Some(bad) = face.corners.iter().find(|&&i| i < 0 || i >= count as i64) {
            return Err(source.malformed(format!("has a face with vertex {bad} but {count} vertices")));
        }
        fan(face.corners.iter().map(|&i| i as u32), &mut raw.indices);
        check_limit(source.name(), "the number of triangles", raw.indices.len() as u64, limits.triangles)?;
    }
    Ok(raw)
}

/// Every row takes some bytes, so the file's size bounds the counts that its header may claim.
fn check_counts(source: &Source, header: &Header, size: u64, limits: &Limits) -> Result<(), SceneError> {
    let mut needed = 0u64;
    for element in header.elements.values() {
        let row: u64 = element.properties.values().map(|p| least_bytes(&p.data_type, header.encoding)).sum();
        let least = (element.count as u64).saturating_mul(row.max(1));
        needed = needed.saturating_add(least);
        if needed > size || (row == 0 && element.count > 0) {
            return Err(source.malformed(format!(
                "states {} rows of '{}', more than its {size} bytes can hold",
                element.count, element.name
            )));
        }
        let (what, limit) = match element.name.as_str() {
            "vertex" => ("the number of vertices", limits.vertices),
            _ => ("the number of faces", limits.triangles),
        };
        check_limit(source.name(), what, element.count as u64, limit)?;
    }
    Ok(())
}

fn least_bytes(kind: &PropertyType, encoding: Encoding) -> u64 {
    let scalar = match kind {
        PropertyType::Scalar(scalar) | PropertyType::List(scalar, _) => scalar,
    };
    match (encoding, scalar) {
        // A digit and a blank or line end; the last line may lack its end.
        (Encoding::Ascii, _) => 1,
        (_, ScalarType::Char | ScalarType::UChar) => 1,
        (_, ScalarType::Short | ScalarType::UShort) => 2,
        (_, ScalarType::Int | ScalarType::UInt | ScalarType::Float) => 4,
        (_, ScalarType::Double) => 8,
    }
}

fn fill_vertices(raw: &mut RawMesh, rows: &[Vertex], element: &ElementDef) {
    let has = |names: &[&str]| element.properties.values().any(|p| names.contains(&p.name.as_str()));
    raw.positions = rows.iter().map(|v| v.position).collect();
    if has(&["nx"]) {
        raw.normals = rows.iter().map(|v| v.normal).collect();
    }
    if has(U) {
        raw.uvs = rows.iter().map(|v| [v.uv[0], 1.0 - v.uv[1]]).collect();
    }
    if has(RED) {
        raw.colors = rows.iter().map(|v| [v.color[0], v.color[1], v.color[2], 1.0]).collect();
    }
}

const U: &[&str] = &["u", "s", "texture_u", "texture_s"];
const V: &[&str] = &["v", "t", "texture_v", "texture_t"];
const RED: &[&str] = &["red", "r", "diffuse_red"];
const GREEN: &[&str] = &["green", "g", "diffuse_green"];
const BLUE: &[&str] = &["blue", "b", "diffuse_blue"];

#[derive(Default)]
struct Vertex {
    position: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    color: [f32; 3],
}

impl PropertyAccess for Vertex {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            n if U.contains(&n) => &mut self.uv[0],
            n if V.contains(&n) => &mut self.uv[1],
            n => {
                let channel = [RED, GREEN, BLUE].iter().position(|names| names.contains(&n));
                if let Some(channel) = channel
                    && let Some(value) = linear(&property)
                {
                    self.color[channel] = value;
                }
                return PropertyAccessResult::Ignored;
            }
        };
        match property.to_f32_lossy() {
            Some(value) => {
                *slot = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::UnsupportedType,
        }
    }
}

/// A colour channel in linear light.
fn linear(property: &Property) -> Option<f32> {
    let decode = |v: f32| if v <= 0.040_45 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    Some(match property {
        Property::UChar(v) => decode(f32::from(*v) / 255.0),
        Property::UShort(v) => decode(f32::from(*v) / 65535.0),
        Property::Float(v) => v.clamp(0.0, 1.0),
        Property::Double(v) => v.clamp(0.0, 1.0) as f32,
        other => decode((other.to_f32_lossy()? / 255.0).clamp(0.0, 1.0)),
    })
}

#[derive(Default)]
struct Face {
    corners: Vec<i64>,
}

impl PropertyAccess for Face {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if !matches!(name, "vertex_indices" | "vertex_index") {
            return PropertyAccessResult::Ignored;
        }
        self.corners = match property {
            Property::ListChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUChar(v) => v.into_iter().map(i64::from).collect(),
            Property::ListShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUShort(v) => v.into_iter().map(i64::from).collect(),
            Property::ListInt(v) => v.into_iter().map(i64::from).collect(),
            Property::ListUInt(v) => v.into_iter().map(i64::from).collect(),
            _ => return PropertyAccessResult::UnsupportedType,
        };
        PropertyAccessResult::Set
    }
}

/// A row of an element that is not wanted; its bytes are passed over.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<RawMesh, SceneError> {
        let source = Source::of_memory("a.ply");
        import(&source, text.as_bytes(), &Limits::default(), &mut ImportReport::default())
    }

    #[test]
    fn any_number_types_and_polygons_are_read() {
        let text = "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty short y\nproperty float z\n\
            property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
            property list uchar short vertex_index\nend_header\n\
            0 0 0 255 0 0\n1 0 0 255 0 0\n1 1 0.5 0 255 0\n0 1 0 0 0 55\n4 0 1 2 3\n";
        let raw = parse(text).unwrap();
        assert_eq!(raw.indices, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!((raw.positions[2], raw.colors[0]), ([1.0, 1.0, 0.5], [1.0, 0.0, 0.0, 1.0]));
        assert!((raw.colors[3][2] - 0.0382).abs() < 1e-3);
        assert!(raw.normals.is_empty());
    }

    #[test]
    fn claims_beyond_the_file_are_refused_before_reading() {
        let header =
            "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n";
        assert!(parse(header).unwrap_err().to_string().contains("4000000000 rows of 'vertex'"));
        let header = "ply\nformat binary_little_endian 1.0\nelement foo 9\nend_header\n";
        assert!(parse(header).is_err());
        let text = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nelement face 1\n\
            property list uchar int vertex_indices\nend_header\n0\n3 0 0 -1\n";
        assert_eq!(parse(text).unwrap_err().to_string(), "a.ply: has a face with vertex -1 but 1 vertices");
    }
}
