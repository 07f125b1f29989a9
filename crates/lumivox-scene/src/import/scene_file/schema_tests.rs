//! The code and `scene.schema.json` know the same keys and judge the same documents alike.

use std::collections::BTreeSet;

use serde::de::DeserializeOwned;
use serde_json::{Value, json};

use super::format::*;
use super::*;

#[path = "../../../tests/common/schema.rs"]
mod schema;

/// The words between backticks behind "expected" in the message about an unknown key or variant.
fn expected<T: DeserializeOwned + std::fmt::Debug>(document: Value) -> BTreeSet<String> {
    let message = serde_json::from_value::<T>(document).unwrap_err().to_string();
    assert!(message.starts_with("unknown "), "{message}");
    let (_, rest) = message.split_once("expected").unwrap();
    rest.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn keys_of<T: DeserializeOwned + std::fmt::Debug>() -> BTreeSet<String> {
    expected::<T>(json!({"?": 0}))
}

fn keys_of_light(kind: &str) -> BTreeSet<String> {
    let mut keys = expected::<LightEntry>(json!({"type": kind, "?": 0}));
    keys.insert("type".to_owned());
    keys
}

#[test]
fn code_and_schema_know_the_same_keys() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let properties =
        |s: &Value| -> BTreeSet<String> { s["properties"].as_object().unwrap().keys().cloned().collect() };
    assert_eq!(properties(&schema), keys_of::<File>());
    let mut parts = vec![
        ("camera", keys_of::<CameraEntry>()),
        ("path", keys_of::<PathEntry>()),
        ("path_key", keys_of::<PathKey>()),
        ("light_motion", keys_of::<LightMotion>()),
        ("light_key", keys_of::<LightKey>()),
        ("mesh", keys_of::<MeshEntry>()),
        ("box", keys_of::<BoxEntry>()),
        ("glass", keys_of::<GlassEntry>()),
        ("mesh_motion", keys_of::<MeshMotion>()),
        ("mesh_key", keys_of::<MeshKey>()),
        ("spin", keys_of::<SpinEntry>()),
        ("orbit", keys_of::<OrbitEntry>()),
        ("sky", keys_of::<SkyEntry>()),
        ("gradient", keys_of::<GradientEntry>()),
    ];
    let kinds = expected::<LightEntry>(json!({"type": "?"}));
    parts.extend(kinds.iter().map(|kind| (kind.as_str(), keys_of_light(kind))));
    let defs = schema["$defs"].as_object().unwrap();
    for (name, keys) in &parts {
        assert_eq!(properties(&defs[*name]), *keys, "{name}");
        assert_eq!(defs[*name]["additionalProperties"], json!(false), "{name}");
    }
    let with_keys: BTreeSet<&str> =
        defs.iter().filter(|(_, s)| s.get("properties").is_some()).map(|(k, _)| k.as_str()).collect();
    assert_eq!(with_keys, parts.iter().map(|p| p.0).collect());
    let listed: BTreeSet<String> = defs["light"]["oneOf"]
        .as_array()
        .unwrap()
        .iter()
        .map(|r| r["$ref"].as_str().unwrap().replace("#/$defs/", ""))
        .collect();
    assert_eq!(listed, kinds);
    for (name, words) in
        [("interpolation", expected::<Between>(json!("?"))), ("repeat", expected::<Repeat>(json!("?")))]
    {
        let stated = defs[name]["enum"].as_array().unwrap().iter();
        assert_eq!(stated.map(|w| w.as_str().unwrap().to_owned()).collect::<BTreeSet<_>>(), words);
    }
}

/// Every key, once.
fn everything() -> Value {
    json!({
        "$schema": "scene.schema.json",
        "camera": {"eye": [0, 1, 3], "target": [0, 1, 0], "up": [0, 1, 0], "fov_y_deg": 40, "path": {
            "keyframes": [{"seconds": 0, "eye": [0, 1, 3], "target": [0, 1, 0]}, {"seconds": 2, "eye": [1, 1, 3]}],
            "interpolation": "linear", "repeat": "ping_pong"}},
        "lights": [
            {"type": "point", "position": [0, 2, 0], "intensity": [5, 5, 5], "motion": {
                "orbit": {"center": [0, 0, 0], "axis": [0, 1, 0], "seconds_per_turn": -3}}},
            {"type": "directional", "direction": [0, -1, 0], "irradiance": [3, 3, 3], "motion": {
                "keyframes": [{"seconds": 0, "rotate_deg": [0, 0, 0]}, {"seconds": 6, "rotate_deg": [0, 0, 90]}],
                "repeat": "once"}},
            {"type": "spot", "position": [0, 2, 0], "target": [0, 0, 0], "intensity": [9, 9, 9], "cutoff_deg": 30,
                "beam_deg": 25, "motion": {"keyframes": [{"seconds": 1, "brightness": 2, "translate": [1, 0, 0]}]}},
            {"type": "rect", "origin": [0, 0, 0], "u": [1, 0, 0], "v": [0, 0, 1], "radiance": [5, 5, 5],
                "motion": {"spin": {"seconds_per_turn": 2}, "interpolation": "step"}},
            {"type": "constant", "radiance": [1, 1, 1]}],
        "sky": {"gradient": {"zenith": [0.2, 0.4, 1], "horizon": [1, 1, 1], "ground": [0, 0, 0]}},
        "meshes": [
            {"quad": [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], "albedo": [0.7, 0.1, 0.1], "smooth": true,
                "glass": {"ior": 1.3, "color": [0.5, 0.9, 1], "distance": 0.2, "roughness": 0.1, "frost": 0.2, "bend": 3,
                    "body": [0, 1, 0], "thin": true}, "absorber": [0.5, 1, 0.5], "close_holes": false,
                "matrix": [[1, 0, 0, 2], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]},
            {"box": {"center": [0, 0, 0], "size": [1, 1, 1], "rot_y_deg": 15}, "emission": [1, 2, 3],
                "scale": [1, 2, 1], "rotate_deg": [0, 90, 0], "translate": [0, 5, 0], "motion": {
                    "keyframes": [{"seconds": 0, "translate": [0, 5, 0], "rotate_deg": [0, 0, 0], "scale": 1},
                        {"seconds": 2, "scale": [1, 2, 3]}],
                    "interpolation": "smooth", "repeat": "loop",
                    "spin": {"axis": [1, 0, 0], "center": [0, 0, 0], "seconds_per_turn": 4},
                    "orbit": {"center": [0, 0, 0], "seconds_per_turn": 12}}}]
    })
}

fn parse(document: &Value) -> Result<Scene, SceneError> {
    import(&Source::of_memory("a.scene.json"), document.to_string().as_bytes(), &Limits::default())
}

#[test]
fn a_document_with_every_key_passes_both() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let document = everything();
    assert_eq!(schema::fault(&schema, &document), None);
    let scene = parse(&document).unwrap();
    assert_eq!((scene.clips().len(), scene.clips()[0].duration), (1, 12.0));
    for i in 0..40u8 {
        let pose = scene.pose(0, f32::from(i) * 0.31);
        assert!(pose.world_from_local.iter().all(|m| m.is_finite()));
    }
}

/// Places in a document that are objects.
fn objects(value: &Value, at: String, found: &mut Vec<String>) {
    match value {
        Value::Object(map) => {
            map.iter().for_each(|(k, v)| objects(v, format!("{at}/{k}"), found));
            found.push(at);
        }
        Value::Array(list) => {
            list.iter().enumerate().for_each(|(i, v)| objects(v, format!("{at}/{i}"), found))
        }
        _ => {}
    }
}

#[test]
fn unknown_and_missing_keys_and_wrong_types_are_judged_alike() {
    let schema: Value = serde_json::from_str(SCHEMA).unwrap();
    let whole = everything();
    let mut places = Vec::new();
    objects(&whole, String::new(), &mut places);
    assert!(places.len() > 25, "{places:?}");
    let mut refused = 0;
    for place in &places {
        let mut document = whole.clone();
        document.pointer_mut(place).unwrap()["colour"] = json!(1);
        let fault = schema::fault(&schema, &document);
        assert!(fault.is_some(), "{place}");
        let error = parse(&document).unwrap_err().to_string();
        assert!(error.contains("unknown field `colour`"), "{error}");
        let keys: Vec<String> = whole.pointer(place).unwrap().as_object().unwrap().keys().cloned().collect();
        for key in keys {
            for other in [None, Some(json!("?")), Some(json!(null)), Some(json!([1, 2])), Some(json!(-7))] {
                let mut document = whole.clone();
                let object = document.pointer_mut(place).unwrap().as_object_mut().unwrap();
                match other {
                    None => object.remove(&key),
                    Some(other) => object.insert(key.clone(), other),
                };
                let (by_schema, by_code) = (schema::fault(&schema, &document), parse(&document).err());
                // The code also knows what a document means: null is absence, and values may contradict each other.
                let text = by_code.as_ref().map(ToString::to_string).unwrap_or_default();
                let meaning = text.contains(" has ")
                    || document.pointer(&format!("{place}/{key}")) == Some(&json!(null));
                assert!(
                    by_schema.is_some() == by_code.is_some() || meaning,
                    "{place} {key}: schema {by_schema:?}, code {text}"
                );
                refused += usize::from(by_schema.is_some());
            }
        }
    }
    assert!(refused > 200, "{refused}");
}
