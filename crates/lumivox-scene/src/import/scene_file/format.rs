//! The text of a scene file, as serde reads it. Unknown keys are errors that name the key and its place.
//!
//! `scene.schema.json` says the same for editors and other programs; a test holds the two together.

use serde::Deserialize;

/// The whole file.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    /// For editors: where the schema is.
    #[serde(rename = "$schema")]
    pub(super) _schema: Option<String>,
    pub(super) camera: Option<CameraEntry>,
    #[serde(default)]
    pub(super) lights: Vec<LightEntry>,
    #[serde(default)]
    pub(super) meshes: Vec<MeshEntry>,
    pub(super) sky: Option<SkyEntry>,
}

/// Exactly one of `gradient` and `image`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SkyEntry {
    pub(super) gradient: Option<GradientEntry>,
    pub(super) image: Option<String>,
    /// Factor of the image's values.
    pub(super) scale: Option<f32>,
    /// Turns the image about the vertical axis.
    pub(super) rot_y_deg: Option<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GradientEntry {
    pub(super) zenith: [f32; 3],
    pub(super) horizon: [f32; 3],
    pub(super) ground: [f32; 3],
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
    pub(super) path: Option<PathEntry>,
}

#[derive(Debug, Deserialize)]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LightEntry {
    Point {
        position: [f32; 3],
        intensity: [f32; 3],
        motion: Option<LightMotion>,
    },
    Directional {
        direction: [f32; 3],
        irradiance: [f32; 3],
        motion: Option<LightMotion>,
    },
    Spot {
        position: [f32; 3],
        target: [f32; 3],
        intensity: [f32; 3],
        cutoff_deg: f32,
        /// Three quarters of the cutoff if it is not given.
        beam_deg: Option<f32>,
        motion: Option<LightMotion>,
    },
    Rect {
        origin: [f32; 3],
        u: [f32; 3],
        v: [f32; 3],
        radiance: [f32; 3],
        motion: Option<LightMotion>,
    },
    Constant {
        radiance: [f32; 3],
    },
}

/// Exactly one of `file`, `quad` and `box`. Placed by `matrix`, or by scale, then rotation, then translation.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshEntry {
    pub(super) file: Option<String>,
    pub(super) quad: Option<[[f32; 3]; 4]>,
    #[serde(rename = "box")]
    pub(super) block: Option<BoxEntry>,
    pub(super) albedo: Option<[f32; 3]>,
    pub(super) emission: Option<[f32; 3]>,
    pub(super) glass: Option<GlassEntry>,
    /// The part of light that a surface lets through.
    pub(super) absorber: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) close_holes: bool,
    /// By rows, for column vectors.
    pub(super) matrix: Option<[[f32; 4]; 4]>,
    pub(super) scale: Option<Scale>,
    pub(super) rotate_deg: Option<[f32; 3]>,
    pub(super) translate: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) smooth: bool,
    pub(super) motion: Option<MeshMotion>,
}

/// What is absent is as in clear window glass.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct GlassEntry {
    pub(super) ior: Option<f32>,
    pub(super) color: Option<[f32; 3]>,
    pub(super) distance: Option<f32>,
    pub(super) roughness: Option<f32>,
    pub(super) frost: Option<f32>,
    pub(super) bend: Option<f32>,
    pub(super) body: Option<[f32; 3]>,
    #[serde(default)]
    pub(super) thin: bool,
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

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshMotion {
    /// Of the mesh's file.
    pub(super) clip: Option<ClipName>,
    #[serde(default)]
    pub(super) keyframes: Vec<MeshKey>,
    #[serde(default)]
    pub(super) interpolation: Between,
    #[serde(default)]
    pub(super) repeat: Repeat,
    pub(super) spin: Option<SpinEntry>,
    pub(super) orbit: Option<OrbitEntry>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightMotion {
    #[serde(default)]
    pub(super) keyframes: Vec<LightKey>,
    #[serde(default)]
    pub(super) interpolation: Between,
    #[serde(default)]
    pub(super) repeat: Repeat,
    pub(super) spin: Option<SpinEntry>,
    pub(super) orbit: Option<OrbitEntry>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PathEntry {
    pub(super) keyframes: Vec<PathKey>,
    #[serde(default = "smooth")]
    pub(super) interpolation: Between,
    #[serde(default)]
    pub(super) repeat: Repeat,
}

fn smooth() -> Between {
    Between::Smooth
}

/// A clip's name, or its number from zero for files whose clips have none.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum ClipName {
    Number(usize),
    Name(String),
}

/// What a mesh's `translate`, `rotate_deg` and `scale` are at a time; what is absent is as between the other keys.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MeshKey {
    pub(super) seconds: f32,
    pub(super) translate: Option<[f32; 3]>,
    pub(super) rotate_deg: Option<[f32; 3]>,
    pub(super) scale: Option<Scale>,
}

/// How far a light is from its place, how it is turned about it, and a factor on its strength.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LightKey {
    pub(super) seconds: f32,
    pub(super) translate: Option<[f32; 3]>,
    pub(super) rotate_deg: Option<[f32; 3]>,
    pub(super) brightness: Option<f32>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PathKey {
    pub(super) seconds: f32,
    pub(super) eye: [f32; 3],
    /// The camera's own if it is not given.
    pub(super) target: Option<[f32; 3]>,
}

/// What lies between two keyframes.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(super) enum Between {
    #[default]
    Linear,
    Smooth,
    Step,
}

/// What comes after the last keyframe.
#[derive(Clone, Copy, Debug, Default, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
pub(super) enum Repeat {
    #[default]
    Loop,
    PingPong,
    Once,
}

/// Turning in place.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SpinEntry {
    #[serde(default = "y_up")]
    pub(super) axis: [f32; 3],
    /// In the thing's own space, before it is placed; its middle if it is not given.
    pub(super) center: Option<[f32; 3]>,
    pub(super) seconds_per_turn: f32,
}

/// Going round a point of the world.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrbitEntry {
    #[serde(default = "y_up")]
    pub(super) axis: [f32; 3],
    pub(super) center: [f32; 3],
    pub(super) seconds_per_turn: f32,
}
