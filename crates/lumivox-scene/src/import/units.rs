//! Notes on units and up axes. Formats disagree on both and files are often silent, so what is known is said and
//! nothing is changed: a wrong guess would be worse than none.

use lumivox_core::Bounds;

use crate::{Mesh, Scene};

/// Longest sides in metres that a scene or model plausibly has; beyond, the unit may be another one.
const PLAUSIBLE: std::ops::RangeInclusive<f32> = 1e-3..=200.0;

/// Bytes at the start of a file in which comments are looked for.
const HEAD: usize = 4096;

/// Longest comment that is quoted.
const QUOTED: usize = 80;

/// Notes what the format and the file's comments say, and whether the size fits.
pub(super) fn note(extension: &str, bytes: &[u8], scene: &mut Scene) {
    let stated = extension == ".gltf";
    scene.report.note(if stated {
        "glTF is in metres with Y up".to_owned()
    } else {
        format!("{extension} states neither unit nor up axis; taken as metres with Y up")
    });
    for comment in comments(extension, bytes) {
        scene.report.note(format!("the file says '{comment}'; nothing is scaled or turned for it"));
    }
    let longest = rough_bounds(scene).size().max_element();
    if longest > 0.0 && !PLAUSIBLE.contains(&longest) {
        let guess = if longest > *PLAUSIBLE.end() {
            format!("in millimetres that would be {} m (scale by 0.001)", 0.001 * longest)
        } else {
            "the unit may be larger than a metre".to_owned()
        };
        scene.report.note(format!("the longest side is {longest} m, which is unlikely; {guess}"));
    }
}

/// The box around the instances' boxes: a file may place a large mesh so often that to visit every vertex takes hours.
fn rough_bounds(scene: &Scene) -> Bounds {
    let of = |m: &Mesh| Bounds::of_points(m.positions.iter().map(|&p| p.into()));
    let boxes: Vec<Bounds> = scene.meshes.iter().map(of).collect();
    scene
        .instances
        .iter()
        .fold(Bounds::EMPTY, |sum, i| sum.union(&boxes[i.mesh].transformed(&i.world_from_local)))
}

/// Comments that speak of units or of up.
fn comments(extension: &str, bytes: &[u8]) -> Vec<String> {
    let head = String::from_utf8_lossy(&bytes[..bytes.len().min(HEAD)]);
    let lines: Vec<&str> = match extension {
        ".obj" | ".off" => head.lines().filter_map(|l| l.trim_start().strip_prefix('#')).collect(),
        ".ply" => head
            .lines()
            .take_while(|l| !l.starts_with("end_header"))
            .filter_map(|l| l.strip_prefix("comment").or_else(|| l.strip_prefix("obj_info")))
            .collect(),
        // The first 80 bytes of a binary file and the first line of a text are free.
        ".stl" => head.get(..80).unwrap_or(&head).lines().take(1).collect(),
        _ => Vec::new(),
    };
    let printable = |line: &str| -> String {
        let text: String =
            line.chars().filter(|c| !c.is_control() && *c != '\u{fffd}').take(QUOTED).collect();
        text.trim().to_owned()
    };
    lines.into_iter().map(printable).filter(|l| speaks_of_units(l)).take(4).collect()
}

fn speaks_of_units(line: &str) -> bool {
    let lower = line.to_ascii_lowercase();
    let mut words = lower.split(|c: char| !c.is_ascii_alphanumeric());
    words.any(|w| matches!(w, "unit" | "units" | "upaxis" | "up"))
}

#[cfg(test)]
mod tests {
    use crate::{Limits, load_bytes};

    fn notes(name: &str, text: &str) -> Vec<String> {
        load_bytes(name, text.as_bytes(), &Limits::default()).unwrap().report.notes
    }

    #[test]
    fn what_a_file_says_of_itself_is_quoted_and_a_strange_size_is_named() {
        let obj = "# exported with Units = mm\n# Z up\n# uploaded\nv 0 0 0\nv 500 0 0\nv 0 20 0\nf 1 2 3\n";
        let found = notes("a.obj", obj);
        assert_eq!(found.len(), 4, "{found:?}");
        assert_eq!(found[0], ".obj states neither unit nor up axis; taken as metres with Y up");
        assert!(found[1].contains("'exported with Units = mm'") && found[2].contains("'Z up'"), "{found:?}");
        assert!(found[3].contains("500 m") && found[3].contains("0.5 m (scale by 0.001)"), "{found:?}");
        let scene = load_bytes("a.obj", obj.as_bytes(), &Limits::default()).unwrap();
        assert_eq!(scene.bounds().max.x, 500.0, "a note changes nothing");

        let ply = "ply\nformat ascii 1.0\ncomment unit: cm\nelement vertex 3\nproperty float x\nproperty float y\n\
            property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
        assert!(notes("a.ply", ply)[1].contains("'unit: cm'"));
        let stl = "solid box units=inch\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1e-5 0 0\nvertex 0 1e-5 0\nendloop\n\
            endfacet\nendsolid\n";
        let found = notes("a.stl", stl);
        assert!(found[1].contains("units=inch") && found[2].contains("larger than a metre"), "{found:?}");
        assert_eq!(notes("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").len(), 1);
        let gltf = r#"{"asset":{"version":"2.0"}}"#;
        assert_eq!(notes("a.gltf", gltf), ["glTF is in metres with Y up"]);
    }
}
