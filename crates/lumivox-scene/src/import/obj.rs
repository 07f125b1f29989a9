//! OBJ with its MTL libraries: positions with optional colours, texture coordinates and normals, polygons (cut into
//! fans), one mesh per object and material. Points, lines, curves and groups are passed over.
//!
//! Read here, line by line: attributes that only some corners have, materials without a name and libraries that are
//! missing are common in the wild, and no reason to refuse a file. A face that names a vertex which is not there is.

use std::collections::HashMap;

use super::mtl;
use super::source::Source;
use super::{default_material, fan};
use crate::mesh::{RawMesh, Shading, check_limit};
use crate::{Limits, Scene, SceneError};

/// Reads a file; its meshes are not yet placed.
pub(super) fn import(
    source: &Source,
    bytes: &[u8],
    limits: &Limits,
    shading: Shading,
) -> Result<Scene, SceneError> {
    let text = String::from_utf8_lossy(bytes);
    let mut scene = Scene::default();
    let materials = libraries(source, &text, limits, &mut scene)?;
    let mut reader = Reader {
        source,
        limits,
        lists: Lists::default(),
        meshes: Vec::new(),
        open: HashMap::new(),
        triangles: 0,
    };
    let skipped = reader.read(&text, &materials)?;
    scene.report.skipped_primitives += skipped;

    let fallback = scene.materials.len();
    let Reader { lists, meshes, .. } = reader;
    for part in meshes {
        let raw = part.into_raw(&lists, fallback);
        raw.check(source.name(), limits)?;
        scene.meshes.push(raw.into_mesh(shading, &mut scene.report));
    }
    if scene.meshes.iter().any(|m| m.material == fallback) {
        scene.materials.push(default_material(!lists.colors.is_empty()));
    }
    Ok(scene)
}

/// Everything that faces refer to.
#[derive(Default)]
struct Lists {
    positions: Vec<[f32; 3]>,
    /// Empty until the first vertex with a colour; from then on one per position.
    colors: Vec<[f32; 4]>,
    uvs: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
}

/// Position, texture coordinate and normal of a corner, counted from 0.
type Corner = (u32, Option<u32>, Option<u32>);

/// The triangles of one object and material.
struct Part {
    name: String,
    material: Option<usize>,
    corners: Vec<Corner>,
    numbers: HashMap<Corner, u32>,
    indices: Vec<[u32; 3]>,
}

impl Part {
    fn number(&mut self, corner: Corner) -> u32 {
        *self.numbers.entry(corner).or_insert_with(|| {
            self.corners.push(corner);
            self.corners.len() as u32 - 1
        })
    }

    /// Corners without an attribute that others have get zero; the cleaning makes a normal of it.
    fn into_raw(self, lists: &Lists, fallback: usize) -> RawMesh {
        let corners = &self.corners;
        let uv = |i: u32| [lists.uvs[i as usize][0], 1.0 - lists.uvs[i as usize][1]];
        let normal = |i: u32| lists.normals[i as usize];
        let mut raw = RawMesh {
            name: self.name,
            material: self.material.unwrap_or(fallback),
            indices: self.indices,
            positions: corners.iter().map(|c| lists.positions[c.0 as usize]).collect(),
            ..RawMesh::default()
        };
        if !lists.colors.is_empty() {
            raw.colors = corners.iter().map(|c| lists.colors[c.0 as usize]).collect();
        }
        if corners.iter().any(|c| c.1.is_some()) {
            raw.uvs = corners.iter().map(|c| c.1.map_or([0.0; 2], uv)).collect();
        }
        if corners.iter().any(|c| c.2.is_some()) {
            raw.normals = corners.iter().map(|c| c.2.map_or([0.0; 3], normal)).collect();
        }
        raw
    }
}

struct Reader<'a> {
    source: &'a Source,
    limits: &'a Limits,
    lists: Lists,
    meshes: Vec<Part>,
    /// The part of each object and material, so that switching back and forth does not multiply them.
    open: HashMap<(String, Option<usize>), usize>,
    triangles: u64,
}

impl Reader<'_> {
    /// Reads all lines; returns how many faces, points and lines made no triangle.
    fn read(&mut self, text: &str, materials: &[mtl::MtlMaterial]) -> Result<u64, SceneError> {
        let (mut object, mut material, mut part) = (String::new(), None, None);
        let mut skipped = 0;
        // Of several with one name the first counts.
        let by_name: HashMap<&str, usize> =
            materials.iter().enumerate().rev().map(|(i, m)| (m.name.as_str(), i)).collect();
        let mut joined = String::new();
        for (number, line) in text.lines().enumerate() {
            let line = line.split('#').next().unwrap_or_default().trim();
            // A backslash at its end goes on with the next line.
            if let Some(start) = line.strip_suffix('\\') {
                joined.push_str(start);
                joined.push(' ');
                continue;
            }
            let whole = std::mem::take(&mut joined) + line;
            let line = whole.as_str();
            let (key, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
            let wrong = |what: &str| self.source.malformed(format!("has {what} in line {}", number + 1));
            match key {
                "v" => self.vertex(rest).ok_or_else(|| wrong("no three coordinates"))?,
                "vt" => self.lists.uvs.push(uv(rest).ok_or_else(|| wrong("no texture coordinate"))?),
                "vn" => {
                    let normal =
                        numbers(rest).and_then(|(n, count)| (count >= 3).then_some([n[0], n[1], n[2]]));
                    self.lists.normals.push(normal.ok_or_else(|| wrong("no normal"))?);
                }
                "f" => {
                    let part = match part {
                        Some(part) => part,
                        None => *part.insert(self.part(&object, material)?),
                    };
                    if !self.face(part, rest).map_err(|what| wrong(&what))? {
                        skipped += 1;
                    }
                    let limit = self.limits.triangles;
                    check_limit(self.source.name(), "the number of triangles", self.triangles, limit)?;
                }
                "p" | "l" => skipped += 1,
                "o" => {
                    object = rest.trim().to_owned();
                    part = None;
                }
                "usemtl" => {
                    material = by_name.get(rest.trim()).copied();
                    part = None;
                }
                _ => {}
            }
            let vertices = self.lists.positions.len().max(self.lists.uvs.len()).max(self.lists.normals.len());
            check_limit(self.source.name(), "the number of vertices", vertices as u64, self.limits.vertices)?;
        }
        Ok(skipped)
    }

    fn part(&mut self, object: &str, material: Option<usize>) -> Result<usize, SceneError> {
        if let Some(part) = self.open.get(&(object.to_owned(), material)) {
            return Ok(*part);
        }
        let count = self.meshes.len() as u64 + 1;
        check_limit(self.source.name(), "the number of meshes", count, self.limits.meshes)?;
        self.meshes.push(Part {
            name: object.to_owned(),
            material,
            corners: Vec::new(),
            numbers: HashMap::new(),
            indices: Vec::new(),
        });
        self.open.insert((object.to_owned(), material), self.meshes.len() - 1);
        Ok(self.meshes.len() - 1)
    }

    /// Three coordinates, then nothing, a weight (which is for curves), or a colour with or without opacity.
    fn vertex(&mut self, rest: &str) -> Option<()> {
        let (n, count) = numbers(rest)?;
        if count < 3 {
            return None;
        }
        if count >= 6 {
            let white = [1.0; 4];
            self.lists.colors.resize(self.lists.positions.len(), white);
            self.lists.colors.push([n[3], n[4], n[5], 1.0]);
        } else if !self.lists.colors.is_empty() {
            self.lists.colors.push([1.0; 4]);
        }
        self.lists.positions.push([n[0], n[1], n[2]]);
        Some(())
    }

    /// Adds a polygon; false if it has fewer than three corners.
    fn face(&mut self, part: usize, rest: &str) -> Result<bool, String> {
        let lists = &self.lists;
        let mut corners = Vec::new();
        for word in rest.split_whitespace() {
            let mut fields = word.split('/');
            let position = index(fields.next(), lists.positions.len())?;
            let uv = index(fields.next(), lists.uvs.len())?;
            let normal = index(fields.next(), lists.normals.len())?;
            let position = position.ok_or_else(|| format!("a corner '{word}' without a vertex"))?;
            corners.push((position, uv, normal));
        }
        if corners.len() < 3 {
            return Ok(false);
        }
        let part = &mut self.meshes[part];
        let before = part.indices.len();
        let numbers: Vec<u32> = corners.into_iter().map(|c| part.number(c)).collect();
        fan(numbers.into_iter(), &mut part.indices);
        self.triangles += (part.indices.len() - before) as u64;
        Ok(true)
    }
}

/// Up to six leading numbers and how many there are; `None` if a word is no number.
fn numbers(text: &str) -> Option<([f32; 6], usize)> {
    let mut out = [0.0; 6];
    let mut count = 0;
    for (slot, word) in out.iter_mut().zip(text.split_whitespace()) {
        *slot = word.parse().ok()?;
        count += 1;
    }
    Some((out, count))
}

fn uv(text: &str) -> Option<[f32; 2]> {
    numbers(text).and_then(|(n, count)| (count >= 1).then_some([n[0], n[1]]))
}

/// A reference: from 1 upwards, or from -1 backwards; absent or empty is none.
fn index(field: Option<&str>, count: usize) -> Result<Option<u32>, String> {
    let Some(field) = field.filter(|f| !f.is_empty()) else { return Ok(None) };
    let stated: i64 = field.parse().map_err(|_| format!("a corner number '{field}'"))?;
    let resolved = if stated < 0 { stated.checked_add(count as i64) } else { stated.checked_sub(1) };
    match resolved.filter(|r| (0..count as i64).contains(r)) {
        Some(index) => Ok(Some(index as u32)),
        None => Err(format!("a face that refers to number {stated} of {count}")),
    }
}

/// The materials of all libraries that the file names. A library that is missing is a warning.
fn libraries(
    source: &Source,
    text: &str,
    limits: &Limits,
    scene: &mut Scene,
) -> Result<Vec<mtl::MtlMaterial>, SceneError> {
    let mut all = Vec::new();
    let mut seen = Vec::new();
    for line in text.lines() {
        let Some(("mtllib", rest)) = line.trim().split_once(char::is_whitespace) else { continue };
        let whole = rest.trim();
        if whole.is_empty() || seen.contains(&whole) || seen.len() >= 256 {
            continue;
        }
        seen.push(whole);
        // One name with blanks, or several names.
        let several: Vec<&str> = whole.split_whitespace().collect();
        let found = |name: &str| source.beside(name).and_then(|s| Ok((s.read_self(limits)?, s)));
        let names = if several.len() > 1 && found(whole).is_err() { several } else { vec![whole] };
        for name in names {
            match found(name) {
                Ok((bytes, library)) => {
                    let materials = mtl::parse(&String::from_utf8_lossy(&bytes));
                    let count = (all.len() + materials.len()) as u64;
                    check_limit(source.name(), "the number of materials", count, limits.meshes)?;
                    mtl::add(&library, &materials, limits, scene)?;
                    all.extend(materials);
                }
                Err(error) => scene.report.warn(format!("material library '{name}' is left out: {error}")),
            }
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Scene, SceneError> {
        import(&Source::of_memory("a.obj"), text.as_bytes(), &Limits::default(), Shading::Smooth)
    }

    #[test]
    fn polygons_relative_indices_and_partial_attributes_are_read() {
        let text = "v 0 0 0\nv 1 0 0 1 0 0\nv 1 1 0 # c\nv 0 1 0 1\nvt 0 0.25\nvn 0 0 2\nf -4/1 -3//1 -2 4/1/1\nf 1 2\nl 1 2\n";
        let scene = parse(text).unwrap();
        let mesh = &scene.meshes[0];
        assert_eq!(mesh.indices, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.uvs, [[0.0, 0.75], [0.0; 2], [0.0; 2], [0.0, 0.75]]);
        assert!(mesh.normals.iter().all(|n| *n == [0.0, 0.0, 1.0]));
        assert_eq!((mesh.colors[0], mesh.colors[1]), ([1.0; 4], [1.0, 0.0, 0.0, 1.0]));
        assert_eq!((scene.report.repaired_normals, scene.report.skipped_primitives), (2, 2));
        assert_eq!(scene.materials, [default_material(true)]);
    }

    #[test]
    fn objects_are_apart_and_coming_back_goes_on() {
        let scene =
            parse("v 0 0 0\nv 1 0 0\nv 0 1 0\no a\nf 1 2 3\no b\nf 1 2 3\no a\nusemtl\nf 3 2 1").unwrap();
        let counts: Vec<_> = scene.meshes.iter().map(|m| (m.name.as_str(), m.indices.len())).collect();
        assert_eq!(counts, [("a", 2), ("b", 1)]);
    }

    #[test]
    fn a_missing_library_is_a_warning_and_a_bad_line_an_error_with_its_number() {
        let scene = parse("mtllib no.mtl\nusemtl x\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        assert!(scene.report.warnings[0].contains("no.mtl"));
        for (text, why) in [
            ("v 0 0 0\nf 1 2 3", "a.obj: has a face that refers to number 2 of 1 in line 2"),
            ("v 0 0", "a.obj: has no three coordinates in line 1"),
            ("v 0 0 0\nf 1 x 1", "a.obj: has a corner number 'x' in line 2"),
            ("v 0 0 0\nf 0 1 1", "a.obj: has a face that refers to number 0 of 1 in line 2"),
            (
                "v 0 0 0\nf -9223372036854775808 1 1",
                "a.obj: has a face that refers to number -9223372036854775808 of 1 in line 2",
            ),
        ] {
            assert_eq!(parse(text).unwrap_err().to_string(), why);
        }
    }
}
