//! What must hold before the `gltf` crate may look at an asset: its validation and its accessors index without asking
//! in places, and its node tree may be none.

use gltf::json::validation::{Error, Validate};
use gltf::json::{Path, Root};

use crate::import::source::Source;
use crate::mesh::check_limit;
use crate::{ImportReport, Limits, SceneError};

/// Extensions whose absence of support changes nothing here: understood, or about properties that are not rendered.
const UNDERSTOOD: &[&str] = &[
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_transmission",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions without which there is no geometry to show.
const COMPRESSION: &[&str] =
    &["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// JSON objects per node that a file may have, so that parsing cannot multiply its size in memory without bound.
const OBJECTS_PER_NODE: u64 = 10;

/// Parses the JSON, after a look at how many objects it would become.
pub(super) fn parse(
    source: &Source,
    json: &[u8],
    limits: &Limits,
    report: &mut ImportReport,
) -> Result<Root, SceneError> {
    let objects = json.iter().filter(|b| **b == b'{').count() as u64;
    let limit = limits.nodes.saturating_mul(OBJECTS_PER_NODE);
    check_limit(source.name(), "the number of JSON objects", objects, limit)?;
    let error = match gltf::json::deserialize::from_slice(json) {
        Ok(root) => return Ok(root),
        Err(error) => error,
    };
    let malformed = |e| source.malformed(format!("is no valid glTF JSON: {e}"));
    // Allowed by the format, for extensions that animate other things; but the crate knows no channel without a node.
    let pruned =
        error.to_string().starts_with("missing field `node`").then(|| without_nodeless_channels(json));
    match pruned.flatten() {
        Some(value) => {
            report.warn("channels of animations that move no node are left out");
            gltf::json::deserialize::from_value(value).map_err(malformed)
        }
        None => Err(malformed(error)),
    }
}

fn without_nodeless_channels(json: &[u8]) -> Option<serde_json::Value> {
    let mut root: serde_json::Value = serde_json::from_slice(json).ok()?;
    for animation in root.get_mut("animations")?.as_array_mut()? {
        let channels = animation.get_mut("channels").and_then(|c| c.as_array_mut());
        channels.into_iter().for_each(|c| c.retain(|c| c["target"]["node"].is_number()));
    }
    Some(root)
}

/// Refuses what cannot be read, and lists what is ignored.
pub(super) fn check(
    source: &Source,
    root: &Root,
    limits: &Limits,
    report: &mut ImportReport,
) -> Result<(), SceneError> {
    if !root.asset.version.starts_with("2.") {
        return Err(source.unsupported(format!("glTF version '{}'", root.asset.version)));
    }
    if let Some(name) = root.extensions_required.iter().find(|e| COMPRESSION.contains(&e.as_str())) {
        return Err(source.unsupported(format!("the required extension {name}")));
    }
    for name in root.extensions_used.iter().chain(&root.extensions_required) {
        if !UNDERSTOOD.contains(&name.as_str()) && !report.ignored_extensions.contains(name) {
            let required = root.extensions_required.contains(name);
            let weight = if required { "required, so what is shown may be wrong" } else { "optional" };
            report.warn(format!("the extension {name} is not supported; the file calls it {weight}"));
            report.ignored_extensions.push(name.clone());
        }
    }
    check_limit(source.name(), "the number of nodes", root.nodes.len() as u64, limits.nodes)?;
    let primitives: u64 = root.meshes.iter().map(|m| m.primitives.len() as u64).sum();
    check_limit(source.name(), "the number of primitives", primitives, limits.meshes)?;
    check_attributes(source, root)?;
    check_kinds(source, root)?;
    validate(source, root)
}

/// The validation of `gltf-json` itself indexes accessors by the attribute's number.
fn check_attributes(source: &Source, root: &Root) -> Result<(), SceneError> {
    for (m, mesh) in root.meshes.iter().enumerate() {
        for (p, primitive) in mesh.primitives.iter().enumerate() {
            let targets =
                primitive.targets.iter().flatten().flat_map(|t| [t.positions, t.normals, t.tangents]);
            let named =
                primitive.attributes.values().copied().chain(primitive.indices).chain(targets.flatten());
            for accessor in named {
                if accessor.value() >= root.accessors.len() {
                    return Err(source.malformed(format!(
                        "names accessor {} in meshes[{m}].primitives[{p}] but has {}",
                        accessor.value(),
                        root.accessors.len()
                    )));
                }
            }
        }
    }
    Ok(())
}

/// The parts that go with a kind of camera or light, which the crate's readers take for granted.
fn check_kinds(source: &Source, root: &Root) -> Result<(), SceneError> {
    use gltf::json::camera::Type;
    use gltf::json::extensions::scene::khr_lights_punctual::Type as LightType;
    use gltf::json::validation::Checked::Valid;
    for (i, camera) in root.cameras.iter().enumerate() {
        let complete = match camera.type_ {
            Valid(Type::Perspective) => camera.perspective.is_some(),
            Valid(Type::Orthographic) => camera.orthographic.is_some(),
            gltf::json::validation::Checked::Invalid => false,
        };
        if !complete {
            return Err(source.malformed(format!("has no projection in cameras[{i}]")));
        }
    }
    let lights =
        root.extensions.iter().filter_map(|e| e.khr_lights_punctual.as_ref()).flat_map(|l| &l.lights);
    for (i, light) in lights.enumerate() {
        if matches!(light.type_, Valid(LightType::Spot)) && light.spot.is_none() {
            return Err(source.malformed(format!("has no cone in spot light {i}")));
        }
    }
    Ok(())
}

/// The crate's own validation, short of what does no harm here: bounds that POSITION must state, accessors
/// without a view (they are zero), and required extensions, about which the caller has decided.
fn validate(source: &Source, root: &Root) -> Result<(), SceneError> {
    let mut first: Option<(String, Error)> = None;
    root.validate(root, Path::new, &mut |path, error| {
        if first.is_some() {
            return;
        }
        let path = path().to_string();
        let harmless = matches!(error, Error::Unsupported)
            || path.ends_with(".min")
            || path.ends_with(".max")
            || (path.ends_with("].bufferView") && matches!(error, Error::Missing))
            || (path.ends_with("POSITION\"]") && matches!(error, Error::Missing));
        if !harmless {
            first = Some((path, error));
        }
    });
    match first {
        Some((path, error)) => {
            let what = match error {
                Error::IndexOutOfBounds => "refers to something that is not there",
                Error::Missing => "lacks something that it must have",
                Error::Oversize => "has a size that is too large",
                Error::Invalid | Error::Unsupported => "has an invalid value",
            };
            Err(source.malformed(format!("{what} in {path}")))
        }
        None => Ok(()),
    }
}
