//! The scene over time: which clip moves it, and where the camera is.

use anyhow::{Context, Result, bail};
use lumivox_scene::{Camera, Pose, Scene, builtin};

use crate::args::{ClipArg, ShotArgs};
use crate::framing;

/// Seconds of the walk through the atrium.
const WALK_SECONDS: f32 = 8.0;

/// What plays, and whose eyes it is seen through.
pub(crate) struct Motion {
    clip: Option<usize>,
    viewer: Viewer,
}

enum Viewer {
    Fixed(Camera),
    /// The scene's camera of this number, wherever the clip takes it.
    OfScene(usize),
    AtriumWalk,
}

impl Motion {
    /// The clip of the command line, else the first; the camera of the command line, else the scene's first, else one that
    /// shows the most of all that happens. In a series the atrium is walked through.
    pub(crate) fn new(scene: &Scene, shot: &ShotArgs, series: bool) -> Result<Self> {
        let clip = chosen_clip(scene, &shot.scene, shot.clip.as_ref())?;
        let walks = shot.scene.starts_with("builtin:atrium") && (series || shot.time != 0.0);
        let viewer = match shot.camera {
            Some(camera) => Viewer::Fixed(camera.into()),
            None if walks => Viewer::AtriumWalk,
            None if scene.cameras.is_empty() => {
                let bounds = clip.map_or_else(|| scene.bounds(), |clip| scene.bounds_in_motion(clip));
                let best = framing::best_camera(scene, &bounds);
                Viewer::Fixed(best.with_context(|| shot.scene.clone())?)
            }
            None => Viewer::OfScene(0),
        };
        Ok(Self { clip, viewer })
    }

    /// The clip that plays.
    pub(crate) fn clip(&self) -> Option<usize> {
        self.clip
    }

    /// Puts the scene to a moment; where everything is then, and the camera.
    pub(crate) fn pose(&self, scene: &mut Scene, seconds: f32) -> (Pose, Camera) {
        let pose = scene.pose(self.clip.unwrap_or(usize::MAX), seconds);
        scene.apply(&pose);
        let camera = match &self.viewer {
            Viewer::Fixed(camera) => camera.clone(),
            Viewer::OfScene(n) => pose.cameras[*n].clone(),
            Viewer::AtriumWalk => builtin::atrium_camera_path((seconds / WALK_SECONDS).clamp(0.0, 1.0)),
        };
        (pose, camera)
    }
}

/// A clip by name or number; the first if none is asked for.
pub(crate) fn chosen_clip(scene: &Scene, name: &str, clip: Option<&ClipArg>) -> Result<Option<usize>> {
    let clips = scene.clips();
    let Some(ClipArg(wanted)) = clip else { return Ok((!clips.is_empty()).then_some(0)) };
    if wanted == "none" {
        return Ok(None);
    }
    let by_number = || wanted.parse().ok().filter(|n| *n < clips.len());
    let found = clips.iter().position(|c| c.name == *wanted).or_else(by_number);
    if found.is_none() {
        let known: Vec<&str> = clips.iter().map(|c| c.name.as_str()).collect();
        match known.as_slice() {
            [] => bail!("there is no clip {wanted:?}: {name} does not move"),
            known => {
                bail!("there is no clip {wanted:?}; known are {}, 0 to {}", known.join(", "), known.len() - 1)
            }
        }
    }
    Ok(found)
}
