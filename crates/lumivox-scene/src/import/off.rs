//! OFF, the text form: positions and polygons. Colours and normals of its variants are passed over.

use super::fan;
use super::source::Source;
use crate::mesh::{RawMesh, check_limit};
use crate::{Limits, SceneError};

/// Reads a file into one mesh.
pub(super) fn import(source: &Source, bytes: &[u8], limits: &Limits) -> Result<RawMesh, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut lines = text
        .lines()
        .enumerate()
        .map(|(i, line)| (i + 1, line.split('#').next().unwrap_or_default().trim()))
        .filter(|(_, line)| !line.is_empty());
    let (_, first) = lines.next().unwrap_or_default();
    let (magic, rest) = first.split_once(char::is_whitespace).unwrap_or((first, ""));
    if !matches!(magic, "OFF" | "COFF" | "NOFF" | "CNOFF") || rest.contains("BINARY") {
        return Err(source.malformed("is no text OFF file (it does not start with 'OFF')"));
    }
    let counts_line = if rest.is_empty() { lines.next().unwrap_or_default().1 } else { rest };
    let mut counts = counts_line.split_whitespace().map(str::parse::<u64>);
    let (Some(Ok(vertices)), Some(Ok(faces))) = (counts.next(), counts.next()) else {
        return Err(source.malformed("has no counts of vertices and faces after 'OFF'"));
    };
    // A vertex takes at least "0 0 0" and its line end, a face "0" and its line end.
    let size = bytes.len() as u64 + 1;
    if vertices.saturating_mul(6).saturating_add(faces.saturating_mul(2)) > size {
        return Err(source.malformed(format!(
            "states {vertices} vertices and {faces} faces, more than its {} bytes can hold",
            bytes.len()
        )));
    }
    check_limit(source.name(), "the number of vertices", vertices, limits.vertices)?;
    check_limit(source.name(), "the number of faces", faces, limits.triangles)?;

    let mut raw = RawMesh { positions: Vec::with_capacity(vertices as usize), ..RawMesh::default() };
    let ends_early = |what: &str, found: usize, stated: u64| {
        source.malformed(format!("ends after {found} of {stated} {what}"))
    };
    for i in 0..vertices as usize {
        let (line, content) = lines.next().ok_or_else(|| ends_early("vertices", i, vertices))?;
        let mut numbers = content.split_whitespace().map(str::parse::<f32>);
        let (Some(Ok(x)), Some(Ok(y)), Some(Ok(z))) = (numbers.next(), numbers.next(), numbers.next()) else {
            return Err(source.malformed(format!("has no three coordinates in line {line}")));
        };
        raw.positions.push([x, y, z]);
    }
    for i in 0..faces as usize {
        let (line, content) = lines.next().ok_or_else(|| ends_early("faces", i, faces))?;
        let bad = || source.malformed(format!("has no valid face in line {line}"));
        let mut words = content.split_whitespace();
        let corners: usize = words.next().and_then(|w| w.parse().ok()).ok_or_else(bad)?;
        let list: Vec<u32> = words.take(corners).map_while(|w| w.parse().ok()).collect();
        if list.len() != corners || list.iter().any(|&v| u64::from(v) >= vertices) {
            return Err(bad());
        }
        fan(list.into_iter(), &mut raw.indices);
        check_limit(source.name(), "the number of triangles", raw.indices.len() as u64, limits.triangles)?;
    }
    Ok(raw)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<RawMesh, SceneError> {
        import(&Source::of_memory("a.off"), text.as_bytes(), &Limits::default())
    }

    #[test]
    fn polygons_comments_and_colours_are_understood() {
        let raw =
            parse("COFF # c\n4 1 0\n0 0 0 1 1 1 1\n\n1 0 0\n1 1 0\n# x\n0 1 0\n4 0 1 2 3 255 0 0\n").unwrap();
        assert_eq!(raw.indices, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(parse("OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2").unwrap().indices.len(), 1);
    }

    #[test]
    fn faults_are_named_with_their_line() {
        let text = parse("OFF\n99999999999 1 0\n").unwrap_err().to_string();
        assert_eq!(text, "a.off: states 99999999999 vertices and 1 faces, more than its 20 bytes can hold");
        let text = parse("OFF\n1 1 0\n0 0 0\n3 0 0 7\n").unwrap_err().to_string();
        assert_eq!(text, "a.off: has no valid face in line 4");
        assert!(parse("OFF\n1 2 0\n0 0 0\n0\n").unwrap_err().to_string().contains("ends after 1 of 2 faces"));
        assert!(parse("").is_err());
    }
}
