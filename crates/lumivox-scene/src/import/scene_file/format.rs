//! The text of a scene file, as serde reads it. Unknown keys are errors that name the key and its place.

use serde::Deserialize;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    pub(super) camera: Option<CameraEntry>,
    #[serde(default)]
    pub(super) lights: Vec<LightEntry>,
    #[serde(default)]
    pub(super) meshes: Vec<MeshEntry>,
}

fn y_up() -> [f32; 3] {
    [0.0, 1.0, 0.0]
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraEntry {
    pub(super) eye: [f32; 3],
    pub(super) target: [f32; 3],
    #[serde(default = "y_up")]
    pub(super) up: [f32; 3],
    pub(super) fov_y_deg: f32,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LightEntry {
    Point {
        position: [f32; 3],
        intensity: [f32; 3],
    },
    Directional {
        direction: [f32; 3],
        irradiance: [f32; 3],
    },
    Spot {
        position: [f32; 3],
        target: [f32; 3],
        intensity: [f32; 3],
        cutoff_deg: f32,
        /// Three quarters of the cutoff if it is not given.
        beam_deg: Option<f32>,
    },
    Rect {
        origin: [f32; 3],
        u: [f32; 3],
        v: [f32; 3],
        radiance: [f32; 3],
    },
    Constant {
        radiance: [f32; 3],
    },
}

/// Exactly one of `file`, `quad` and `box`. Placed by scale, then rotation, then translation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshEntry {
    pub(super) file: Option<String>,
    pub(super) quad: Option<[[f32; 3]; 4]>,
    #[serde(rename = "box")]
    pub(super) block: Option<BoxEntry>,
    pub(super) albedo: Option<[f32; 3]>,
    pub(super) emission: Option<[f32; 3]>,
    pub(super) scale: Option<Scale>,
    pub(super) rotate_deg: Option<[f32; 3]>,
    pub(super) translate: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) smooth: bool,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct BoxEntry {
    pub(super) center: [f32; 3],
    pub(super) size: [f32; 3],
    #[serde(default)]
    pub(super) rot_y_deg: f32,
}

/// One factor, or one per axis.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum Scale {
    Uniform(f32),
    PerAxis([f32; 3]),
}
