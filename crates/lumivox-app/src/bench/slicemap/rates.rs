//! Frames per second of voxelization alone (2.5).

use anyhow::Result;
use glam::{UVec2, Vec3};
use lumivox::core::View;
use lumivox::slicemap::{Slicemap, SlicemapSettings, Slicing};

use super::row;
use crate::bench::models::{Subject, ball};
use crate::bench::report::{Report, ms};
use crate::bench::timing::{Time, Timer};

/// Triangles of the paper's scene.
const TRIANGLES: u32 = 1_124_571;

/// A camera that sees the ball whole, and the distances that it lies between.
pub(super) fn view() -> (View, [f32; 2]) {
    let eye = Vec3::new(1.5, 2.0, 3.0);
    let (middle, radius) = (eye.length(), 1.1);
    let fov = 2.0 * (radius / middle).asin();
    let view = View::perspective(eye, Vec3::ZERO, Vec3::Y, fov, 1.0, middle - radius, middle + radius);
    (view, [middle - radius, middle + radius])
}

/// The time of one slicemap of a subject.
pub(super) fn measure(timer: &Timer<'_>, subject: &Subject, settings: SlicemapSettings) -> Result<Time> {
    let gpu = timer.gpu;
    let mut map = Slicemap::new(gpu, settings)?;
    let (view, range) = view();
    map.set_view(gpu, &view, range);
    let meshes: Vec<_> = subject.meshes.iter().map(|mesh| (mesh, 0)).collect();
    timer.median(|| timer.submit(|e| map.record(gpu, e, &meshes)))
}

pub(super) fn rates(timer: &Timer<'_>, quick: bool, report: &mut Report) -> Result<()> {
    report.head("Voxelization rate");
    let (triangles, side) = if quick { (100_000, 256) } else { (TRIANGLES, 512) };
    let subject = Subject::new(timer.gpu, "Bumpy ball", ball(triangles))?;
    report.say(&format!(
        "{} seen in perspective, {side} x {side} columns of 96 cells. The paper: 1,124,571 triangles in 512 x 512 x 96 cells. *Local* takes one pass \
         more for the ends of the columns, of both ends at once; the paper takes two.",
        subject.title()
    ));
    let cases = [
        ("uniform", Slicing::Uniform, false, Some(70.0)),
        ("local", Slicing::Local, false, Some(60.0)),
        ("uniform, conservative", Slicing::Uniform, true, None),
    ];
    let mut lines = Vec::new();
    for (name, slicing, conservative, paper) in cases {
        let settings =
            SlicemapSettings { size: UVec2::splat(side), slicing, conservative, ..Default::default() };
        let time = measure(timer, &subject, settings)?;
        let hz = 1e3 / time.ms;
        let beside = paper.map_or(String::new(), |paper| format!(" ({paper})"));
        lines.push(vec![name.to_owned(), ms(time.ms), format!("{hz:.1}{beside}")]);
        report.push(row("rate", name, "rate", hz, "Hz", paper));
    }
    report.table(&["slicing", "ms", "Hz"].map(str::to_owned), &lines);
    Ok(())
}
