//! Readers of volume files, each by the rules of its format alone: which cells are occupied, as points in the world.

use std::collections::BTreeMap;
use std::io::Read;
use std::path::Path;

use dot_vox::SceneNode;
use libtest_mimic::Failed;

/// The middles of occupied cells, in thousandths of a cell from the world's origin so that they can be compared, with sRGB
/// colours where the format has them.
pub(crate) type Points = BTreeMap<[i64; 3], Option<[u8; 3]>>;

pub(crate) fn key(point: [f64; 3], cell_size: f64) -> [i64; 3] {
    point.map(|v| (1000.0 * v / cell_size).round() as i64)
}

pub(crate) fn read(path: &Path, cell_size: f64) -> Result<Points, Failed> {
    let bytes = std::fs::read(path)?;
    match path.extension().and_then(|e| e.to_str()) {
        Some("npz") => npz(&bytes, cell_size),
        Some("vox") => vox(&bytes, cell_size),
        Some("binvox") => binvox(&bytes, cell_size),
        Some("ply") => ply(&bytes, cell_size),
        Some("nhdr") => nhdr(path, cell_size),
        Some("ktx2") => ktx2(&bytes, cell_size),
        _ => Err("no such format".into()),
    }
}

/// Points of a dense array, x fastest.
fn dense(cells: &[u8], dims: [usize; 3], cell_size: f64, center: impl Fn([usize; 3]) -> [f64; 3]) -> Points {
    assert_eq!(cells.len(), dims.iter().product::<usize>());
    let occupied = cells.iter().enumerate().filter(|(_, cell)| **cell != 0);
    occupied
        .map(|(n, _)| {
            let cell = [n % dims[0], n / dims[0] % dims[1], n / (dims[0] * dims[1])];
            (key(center(cell), cell_size), None)
        })
        .collect()
}

fn words(text: &str) -> Vec<f64> {
    text.split(|c: char| !(c.is_ascii_digit() || "+-.e".contains(c))).filter_map(|w| w.parse().ok()).collect()
}

/// The arrays of a zip file with their headers.
pub(crate) fn arrays(bytes: &[u8]) -> Result<BTreeMap<String, (String, Vec<u8>)>, Failed> {
    let number = |at: usize, width: usize| {
        bytes[at..at + width].iter().rev().fold(0usize, |sum, byte| sum << 8 | usize::from(*byte))
    };
    let mut arrays = BTreeMap::new();
    let mut at = 0;
    while number(at, 4) == 0x0403_4b50 {
        let (name_length, extra) = (number(at + 26, 2), number(at + 28, 2));
        let name = String::from_utf8(bytes[at + 30..at + 30 + name_length].to_vec())?;
        // Sizes are in the 64-bit field: the original, then the compressed.
        let compressed = number(at + 30 + name_length + 12, 8);
        let start = at + 30 + name_length + extra;
        let mut data = Vec::new();
        flate2::read::DeflateDecoder::new(&bytes[start..start + compressed]).read_to_end(&mut data)?;
        let header = 10 + usize::from(data[8]) + 256 * usize::from(data[9]);
        let text = String::from_utf8(data[10..header].to_vec())?;
        arrays.insert(name.trim_end_matches(".npy").to_owned(), (text, data.split_off(header)));
        at = start + compressed;
    }
    Ok(arrays)
}

fn npz(bytes: &[u8], cell_size: f64) -> Result<Points, Failed> {
    let arrays = arrays(bytes)?;
    let doubles = |name: &str| -> Vec<f64> {
        arrays[name].1.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
    };
    let (header, cells) = &arrays["occupancy"];
    let shape = words(header.split("shape").nth(1).unwrap_or_default());
    let [z, y, x] = [0, 1, 2].map(|n| shape[n] as usize);
    let (origin, side) = (doubles("origin"), doubles("cell_size")[0]);
    Ok(dense(cells, [x, y, z], cell_size, |cell| {
        [0, 1, 2].map(|n| origin[n] + side * (cell[n] as f64 + 0.5))
    }))
}

fn nhdr(path: &Path, cell_size: f64) -> Result<Points, Failed> {
    let text = std::fs::read_to_string(path)?;
    let field = |name: &str| {
        text.lines().find_map(|line| line.strip_prefix(name)).map(str::to_owned).unwrap_or_default()
    };
    let dims = words(&field("sizes:"));
    let (origin, directions) = (words(&field("space origin:")), words(&field("space directions:")));
    let raw = std::fs::read(path.with_file_name(field("data file: ")))?;
    Ok(dense(&raw, [0, 1, 2].map(|n| dims[n] as usize), cell_size, |cell| {
        [0, 1, 2]
            .map(|n| origin[n] + (0..3).map(|axis| cell[axis] as f64 * directions[3 * axis + n]).sum::<f64>())
    }))
}

fn ktx2(bytes: &[u8], cell_size: f64) -> Result<Points, Failed> {
    let texture = ktx2::Reader::new(bytes).map_err(|e| format!("{e:?}"))?;
    let header = texture.header();
    let value = |wanted: &str| -> Vec<f64> {
        let found = texture.key_value_data().find(|(key, _)| *key == wanted);
        words(&found.map(|(_, value)| String::from_utf8_lossy(value).into_owned()).unwrap_or_default())
    };
    let (origin, side) = (value("lumivox.origin"), value("lumivox.cell_size")[0]);
    let dims = [header.pixel_width, header.pixel_height, header.pixel_depth].map(|n| n as usize);
    let level = texture.levels().next().ok_or("no level")?;
    Ok(dense(level.data, dims, cell_size, |cell| {
        [0, 1, 2].map(|n| origin[n] + side * (cell[n] as f64 + 0.5))
    }))
}

fn binvox(bytes: &[u8], cell_size: f64) -> Result<Points, Failed> {
    let end = bytes.windows(6).position(|w| w == b"\ndata\n").ok_or("no data")?;
    let text = std::str::from_utf8(&bytes[..end])?;
    let field = |name: &str| words(text.lines().find_map(|l| l.strip_prefix(name)).unwrap_or_default());
    let (dim, translate, scale) = (field("dim")[0] as usize, field("translate"), field("scale")[0]);
    let runs = bytes[end + 6..].chunks_exact(2);
    let cells = runs.flat_map(|run| std::iter::repeat_n(run[0], usize::from(run[1])));
    Ok(cells
        .enumerate()
        .filter(|(_, cell)| *cell != 0)
        .map(|(n, _)| {
            // y runs fastest, then z, then x.
            let cell = [n / (dim * dim), n % dim, n / dim % dim];
            let point = [0, 1, 2].map(|n| translate[n] + scale * (cell[n] as f64 + 0.5) / dim as f64);
            (key(point, cell_size), None)
        })
        .collect())
}

fn ply(bytes: &[u8], cell_size: f64) -> Result<Points, Failed> {
    let end = bytes.windows(11).position(|w| w == b"end_header\n").ok_or("no header")? + 11;
    let header = std::str::from_utf8(&bytes[..end])?;
    let properties: Vec<&str> = header.lines().filter(|line| line.starts_with("property")).collect();
    let size = |line: &&str| if line.contains("uchar") { 1 } else { 4 };
    let stride: usize = properties.iter().map(size).sum();
    let red = properties.iter().position(|line| line.ends_with(" red"));
    let red = red.map(|n| properties[..n].iter().map(size).sum::<usize>());
    Ok(bytes[end..]
        .chunks_exact(stride)
        .map(|vertex| {
            let point = [0, 1, 2]
                .map(|n| f64::from(f32::from_le_bytes(vertex[4 * n..4 * n + 4].try_into().unwrap())));
            (key(point, cell_size), red.map(|at| [0, 1, 2].map(|n| vertex[at + n])))
        })
        .collect())
}

fn vox(bytes: &[u8], cell_size: f64) -> Result<Points, Failed> {
    let data = dot_vox::load_bytes(bytes)?;
    let SceneNode::Transform { attributes, .. } = &data.scenes[0] else { return Err("no root".into()) };
    let (origin, side) = (words(&attributes["_origin"]), words(&attributes["_cell_size"])[0]);
    let mut cells = Vec::new();
    let mut waiting = vec![(0u32, [0i32; 3])];
    while let Some((node, place)) = waiting.pop() {
        match &data.scenes[node as usize] {
            SceneNode::Transform { frames, child, .. } => {
                let here = frames[0].position().map_or([0; 3], |p| [p.x, p.y, p.z]);
                waiting.push((*child, [0, 1, 2].map(|n| place[n] + here[n])));
            }
            SceneNode::Group { children, .. } => waiting.extend(children.iter().map(|&c| (c, place))),
            SceneNode::Shape { models, .. } => {
                let model = &data.models[models[0].model_id as usize];
                let size = [model.size.x, model.size.y, model.size.z].map(|n| n as i32);
                for v in &model.voxels {
                    let at = [v.x, v.y, v.z].map(i32::from);
                    let color = &data.palette[usize::from(v.i)];
                    let place = [0, 1, 2].map(|n| place[n] - size[n] / 2 + at[n]);
                    cells.push((place, [color.r, color.g, color.b]));
                }
            }
        }
    }
    // The file knows no corner of its grid: x is right, z is up, and -y is towards the viewer; the lowest cells stand at the
    // origin, as they do where the grid is tight.
    let low = |n: usize| cells.iter().map(|(place, _)| place[n]).min().unwrap_or(0);
    let high_y = cells.iter().map(|(place, _)| place[1]).max().unwrap_or(0);
    let (low_x, low_z) = (low(0), low(2));
    Ok(cells
        .into_iter()
        .map(|([x, y, z], color)| {
            let cell = [x - low_x, z - low_z, high_y - y];
            let point = [0, 1, 2].map(|n| origin[n] + side * (f64::from(cell[n]) + 0.5));
            (key(point, cell_size), Some(color))
        })
        .collect())
}
