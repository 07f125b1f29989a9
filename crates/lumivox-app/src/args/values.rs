//! Numbers, and what is made of them.

use std::str::FromStr;

use anyhow::{Context, Result, bail};
use glam::Vec3;
use lumivox_render::voxel_view::Slice;
use lumivox_scene::Camera;

/// A layer of cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SliceArg(pub(crate) Slice);

impl FromStr for SliceArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (axis, at) = text.split_once(':').context("a slice is x:METRES, y:METRES or z:METRES")?;
        let axis = ["x", "y", "z"].iter().position(|name| *name == axis);
        let axis = axis.with_context(|| format!("{text:?}: the axis of a slice is x, y or z"))?;
        Ok(Self(Slice { axis, at: number(at)? }))
    }
}

/// Width and height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Size(pub(crate) u32, pub(crate) u32);

impl FromStr for Size {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (width, height) =
            text.split_once(['x', 'X']).context("a size is WIDTHxHEIGHT, for example 960x540")?;
        let side = |s: &str| s.trim().parse::<u32>().with_context(|| format!("{s:?} is no number of pixels"));
        let size = Self(side(width)?, side(height)?);
        if [size.0, size.1].iter().any(|side| !(1..=8192).contains(side)) {
            bail!("a picture has 1 to 8192 pixels a side");
        }
        Ok(size)
    }
}

/// Eye, target and field of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraArg {
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) fov_y_deg: f32,
}

impl From<CameraArg> for Camera {
    fn from(arg: CameraArg) -> Self {
        Self {
            name: "command line".to_owned(),
            eye: arg.eye,
            target: arg.target,
            up: Vec3::Y,
            fov_y: arg.fov_y_deg.to_radians(),
        }
    }
}

/// Name or number of a clip.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ClipArg(pub(crate) String);

impl FromStr for ClipArg {
    type Err = std::convert::Infallible;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(Self(text.to_owned()))
    }
}

impl FromStr for CameraArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let parts: Vec<&str> = text.split(':').collect();
        let (eye, target, fov) = match parts.as_slice() {
            [eye, target] => (eye, target, "60"),
            [eye, target, fov] => (eye, target, *fov),
            _ => bail!("a camera is x,y,z:x,y,z or x,y,z:x,y,z:degrees"),
        };
        let camera = Self { eye: triple(eye)?, target: triple(target)?, fov_y_deg: number(fov)? };
        if camera.eye == camera.target {
            bail!("a camera must look somewhere: its eye and target are the same point");
        }
        if !(1.0..=170.0).contains(&camera.fov_y_deg) {
            bail!("the field of view must be 1 to 170 degrees");
        }
        Ok(camera)
    }
}

/// Stops, or what suits the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ExposureArg {
    Auto,
    Stops(f32),
}

impl FromStr for ExposureArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        match text {
            "auto" => Ok(Self::Auto),
            stops => Ok(Self::Stops(number(stops)?)),
        }
    }
}

/// Direction and irradiance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SunArg {
    pub(crate) direction: Vec3,
    pub(crate) irradiance: Vec3,
}

impl FromStr for SunArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let (direction, irradiance) =
            text.split_once(':').context("a sun is x,y,z:r,g,b or x,y,z:w (direction and irradiance)")?;
        let irradiance =
            if irradiance.contains(',') { triple(irradiance)? } else { Vec3::splat(number(irradiance)?) };
        if irradiance.min_element() < 0.0 {
            bail!("irradiance cannot be negative");
        }
        let direction =
            triple(direction)?.try_normalize().context("the sun needs a direction that is not zero")?;
        Ok(Self { direction, irradiance })
    }
}

pub(crate) fn triple(text: &str) -> Result<Vec3> {
    let values = text.split(',').map(number).collect::<Result<Vec<_>>>()?;
    match values.as_slice() {
        &[x, y, z] => Ok(Vec3::new(x, y, z)),
        _ => bail!("{text:?} is not three numbers x,y,z"),
    }
}

fn number(text: &str) -> Result<f32> {
    let value: f32 = text.trim().parse().ok().with_context(|| format!("{text:?} is not a number"))?;
    if !value.is_finite() {
        bail!("{text:?} is not a finite number");
    }
    Ok(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_suns_and_sizes_are_read() {
        let camera: CameraArg = "-1,2,3:0,1,0:45".parse().unwrap();
        assert_eq!((camera.eye, camera.fov_y_deg), (Vec3::new(-1.0, 2.0, 3.0), 45.0));
        let sun: SunArg = "0,-2,0:3,2,1".parse().unwrap();
        assert_eq!((sun.direction, sun.irradiance), (Vec3::NEG_Y, Vec3::new(3.0, 2.0, 1.0)));
        assert_eq!("320x180".parse::<Size>().unwrap(), Size(320, 180));
    }

    #[test]
    fn nonsense_is_refused_in_words() {
        for bad in ["", "1,2:3", "1,2,3:1,2,3", "1,2,3:0,0,0:400", "1,2,nan:0,0,0"] {
            assert!(bad.parse::<CameraArg>().is_err(), "{bad}");
        }
        for bad in ["1,2,3", "0,0,0:1", "0,-1,0:-1", "0,-1,0:x"] {
            assert!(bad.parse::<SunArg>().is_err(), "{bad}");
        }
        assert_eq!("z:-1.5".parse::<SliceArg>().unwrap(), SliceArg(Slice { axis: 2, at: -1.5 }));
        for bad in ["", "1", "w:1", "y:", "y:nan"] {
            assert!(bad.parse::<SliceArg>().is_err(), "{bad}");
        }
        for bad in ["", "0x5", "5", "5x", "99999x5", "-1x5"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
    }
}
