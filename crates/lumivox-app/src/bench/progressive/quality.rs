//! Table 6.2 (dissertation: Table 9) and Figure 6.10 (76): how far cells are from the surface, which of them are missing, and which
//! are lost again.

use std::collections::HashSet;

use anyhow::Result;
use glam::{DVec3, UVec2, UVec3, Vec3};
use lumivox::core::{Grid, TriangleView};
use lumivox::gpu::{Gpu, read_texture};
use lumivox_oracle::distance;
use lumivox_scene::Scene;

use super::curves::{Curve, losses};
use super::frames::Frames;
use super::rig::{Rig, orbit};
use super::runs::{Run, Truth, forms};
use crate::bench::models::Subject;
use crate::bench::report::{Report, Row};
use crate::bench::timing::Timer;

/// How far a cell may lie beyond the surface, in cells a side: points are moved against their normal by that, and single precision
/// places them to 1/1000.
pub(super) const BEYOND: f64 = 1.0 / 64.0 + 1e-3;

/// A line of the papers' Table 6.2: cells a side, distance of progressive and of full voxelization.
type PaperLine = (u32, f64, Option<f64>);

const PAPER: [(&str, [PaperLine; 3]); 2] = [
    ("Bunny", [(64, 0.3289, Some(0.2168)), (128, 0.1694, Some(0.1091)), (256, 0.1064, None)]),
    ("Dragon", [(64, 0.3621, Some(0.2565)), (128, 0.1878, Some(0.1289)), (256, 0.1256, Some(0.0645))]),
];

/// The cells of a grid that depth samples of all views so far lie in.
struct Hit {
    grid: Grid,
    cells: HashSet<UVec3>,
}

/// The surface points that a picture shows.
fn samples(gpu: &Gpu, rig: &Rig, size: UVec2) -> Result<Vec<DVec3>> {
    let depth: Vec<f32> = read_texture(gpu, &rig.camera.input.textures.depth)?;
    let world_from_clip = rig.camera.view.clip_from_world.as_dmat4().inverse();
    let drawn = depth.into_iter().enumerate().filter(|(_, depth)| *depth > 0.0);
    Ok(drawn
        .map(|(n, depth)| {
            let texel = DVec3::new(f64::from(n as u32 % size.x), f64::from(n as u32 / size.x), 0.0) + 0.5;
            let (x, y) = (2.0 * texel.x / f64::from(size.x) - 1.0, 1.0 - 2.0 * texel.y / f64::from(size.y));
            world_from_clip.project_point3(DVec3::new(x, y, f64::from(depth)))
        })
        .collect())
}

/// All triangles of a scene in one list.
pub(super) fn soup(scene: &Scene) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for instance in &scene.instances {
        let mesh = &scene.meshes[instance.mesh];
        let first = positions.len() as u32;
        let placed =
            mesh.positions.iter().map(|p| instance.world_from_local.transform_point3(Vec3::from(*p)));
        positions.extend(placed.map(|p| p.to_array()));
        indices.extend(mesh.indices.iter().map(|t| t.map(|n| n + first)));
    }
    (positions, indices)
}

/// Mean distance of cells' centres from the mesh in percent of its diagonal.
fn distance_percent(grid: &Grid, cells: &[UVec3], mesh: TriangleView<'_>) -> Result<f64> {
    let centers: Vec<Vec3> = cells.iter().map(|c| grid.center(*c)).collect();
    let diagonal = f64::from(mesh.bounds().size().length());
    Ok(distance::points_to_mesh(&centers, mesh)?.percent_of(diagonal).mean)
}

/// Bunny and dragon, as far as they are there.
pub(super) fn table(timer: &Timer<'_>, subjects: &[Subject], quick: bool, report: &mut Report) -> Result<()> {
    report.head("Table 6.2: distance, missing cells and strays");
    let steps = if quick { 6 } else { 16 };
    let sides: &[u32] = if quick { &[32, 64] } else { &[64, 128, 256] };
    let size = UVec2::splat(if quick { 256 } else { 640 });
    report.say(&format!(
        "The camera goes once round each axis, {steps} frames each, with {} x {} texels, all injected. *Distance* is the mean of \
         that from occupied cells' centres to the mesh, in percent of the diagonal of its box, as in the papers' Table 6.2, whose \
         numbers stand in parentheses. It does not see what is missing. So *recall* is the share of the `thin` cells that at least one \
         texel of one frame lies in, and *strays* are cells that do not touch the mesh even when they are 1/64 + 1/1000 cell larger on each side, the most that any frame leaves: \
         1/64 is what points are moved by against their normal, and 1/1000 what single precision moves them by on their way from a picture's depth. *Lost* is the share of the occupied cells that a frame clears, on average over the frames: \
         the model stands still, so that all of them are good. Footprint is the default rule, center the papers'; rays asks where each texel's ray leaves the cell. The curves of coverage and of stale cells are those of {} cells; a \
         form that leaves no stale cell in any frame has no curve of them.",
        size.x, size.y, sides[1],
    ));
    let mut lines = Vec::new();
    for subject in subjects {
        let (positions, indices) = soup(&subject.scene);
        let mesh = TriangleView { positions: &positions, indices: &indices };
        let views = orbit(&subject.bounds, steps);
        let mut rig = Rig::new(timer.gpu, &subject.scene, size)?;
        let grids: Vec<Grid> = sides.iter().map(|side| subject.grid(*side)).collect::<Result<_>>()?;
        let truths: Vec<Truth> = grids.iter().map(|grid| Truth::new(*grid, mesh)).collect();
        let mut runs: Vec<Vec<Run>> = Vec::new();
        for grid in &grids {
            runs.push(forms(timer.gpu, &rig, *grid, size)?);
        }
        let mut hits: Vec<Hit> = grids.iter().map(|g| Hit { grid: *g, cells: HashSet::new() }).collect();
        let mut curve = Curve::default();
        for (number, view) in views.iter().enumerate() {
            rig.look(timer.gpu, *view);
            rig.draw(timer)?;
            let points = samples(timer.gpu, &rig, size)?;
            for hit in &mut hits {
                let to_cell = |p: &DVec3| hit.grid.cell_from_world(p.as_vec3());
                hit.cells.extend(points.iter().filter_map(to_cell));
            }
            for (runs, truth) in runs.iter_mut().zip(&truths) {
                runs.iter_mut().try_for_each(|run| run.frame(timer, &rig, truth))?;
            }
            // The middle grid's curve, which is the papers'.
            let is_shown = number < 4 || number % 4 == 3;
            if let (true, Some(run)) = (is_shown, runs[1].first()) {
                curve.add(number, &run.cells, &grids[1], mesh)?;
            }
        }
        for (((side, truth), hit), runs) in sides.iter().zip(&truths).zip(&hits).zip(&runs) {
            let hit: Vec<UVec3> = truth.thin.cells().filter(|c| hit.cells.contains(c)).collect();
            let case = Case { subject, side: *side, grid: &truth.grid, mesh, hit: &hit };
            for run in runs {
                lines.push(case.line(run, report)?);
            }
            for (name, set) in [("thin", &truth.thin), ("exact", &truth.exact)] {
                lines.push(case.triangles(name, &set.cells().collect::<Vec<_>>(), report)?);
            }
        }
        coverage(subject, sides[1], &runs[1], report)?;
        curve.plot(subject, sides[1], report)?;
        let lost = sides.iter().zip(&runs).flat_map(|(side, runs)| {
            runs.iter().map(move |run| (format!("{}, {side}", run.name), run.lost.as_slice()))
        });
        losses(subject, lost, report)?;
    }
    let header = ["model", "cells", "form", "distance", "recall", "strays", "occupied", "lost"];
    report.table(&header.map(str::to_owned), &lines);
    Ok(())
}

/// Thin cells that are found and cells that touch nothing, frame by frame, of a still model.
fn coverage(subject: &Subject, side: u32, runs: &[Run], report: &mut Report) -> Result<()> {
    let name = subject.name.to_lowercase().replace(' ', "-");
    let mut found = Frames::new("thin cells found", "% of the thin cells", &format!("found-{name}"));
    let mut stale = Frames::new("stale cells", "% of the occupied cells", &format!("stale-{name}"));
    for run in runs {
        for (metric, frames) in [("found", &run.found), ("stale", &run.stale)] {
            let row = Row {
                figure: "coverage by frame",
                case: format!("{}, {side}", subject.name),
                metric: format!("{metric}, {}", run.name),
                value: frames.last().copied().unwrap_or_default(),
                unit: "1",
                paper: None,
                note: "in the last frame; a still scene".to_owned(),
            };
            report.push_frames(row, frames);
        }
        found.add(run.name, &run.found);
        stale.add(run.name, &run.stale);
    }
    let title = format!("{}, {side} cells", subject.name);
    found.plot(&title, report)?;
    stale.plot(&title, report)
}

/// A model on a grid, with the truth about it.
struct Case<'a> {
    subject: &'a Subject,
    side: u32,
    grid: &'a Grid,
    mesh: TriangleView<'a>,
    hit: &'a [UVec3],
}

impl Case<'_> {
    fn row(&self, metric: String, value: f64, unit: &'static str, paper: Option<f64>, note: &str) -> Row {
        let case = format!("{}, {}", self.subject.name, self.side);
        Row { figure: "Table 6.2", case, metric, value, unit, paper, note: note.to_owned() }
    }

    fn paper(&self) -> Option<(f64, Option<f64>)> {
        let (_, rows) = PAPER.iter().find(|(name, _)| *name == self.subject.name)?;
        rows.iter().find(|(side, ..)| *side == self.side).map(|(_, own, full)| (*own, *full))
    }

    fn line(&self, run: &Run, report: &mut Report) -> Result<Vec<String>> {
        let cells = &run.cells;
        let found: HashSet<UVec3> = cells.iter().copied().collect();
        let recall =
            self.hit.iter().filter(|c| found.contains(c)).count() as f64 / self.hit.len().max(1) as f64;
        let strays = run.strays.iter().copied().fold(0.0, f64::max);
        let percent = distance_percent(self.grid, cells, self.mesh)?;
        let lost = 100.0 * run.lost.iter().sum::<f64>() / run.lost.len().max(1) as f64;
        let is_default = run.name == "footprint";
        let [of_recall, of_strays] = if is_default {
            ["recall of thin".to_owned(), "cells outside exact".to_owned()]
        } else {
            [format!("recall, {}", run.name), format!("strays, {}", run.name)]
        };
        let paper = self.paper().filter(|_| is_default).map(|(own, _)| own);
        let note = "of the thin cells that a texel of a view lies in";
        report.push(self.row(of_recall, recall, "1", None, note));
        let note =
            "cells that do not touch the mesh when 1/64 + 1/1000 cell larger on each side, most of any frame";
        report.push(self.row(of_strays, strays, "1", None, note));
        report.push(self.row(
            format!("distance, {}", run.name),
            percent,
            "%",
            paper,
            "mean, of the diagonal",
        ));
        if !run.lost.is_empty() {
            let note = "of the occupied cells per frame, in a still scene";
            report.push(self.row(format!("lost, {}", run.name), lost, "%", None, note));
        }
        Ok(vec![
            self.subject.name.clone(),
            self.side.to_string(),
            run.name.to_owned(),
            format!("{percent:.4}{}", paper.map_or(String::new(), |p| format!(" ({p})"))),
            format!("{recall:.4}"),
            strays.to_string(),
            cells.len().to_string(),
            if run.lost.is_empty() { String::new() } else { format!("{lost:.3} %") },
        ])
    }

    fn triangles(&self, name: &str, cells: &[UVec3], report: &mut Report) -> Result<Vec<String>> {
        let percent = distance_percent(self.grid, cells, self.mesh)?;
        let paper = self.paper().and_then(|(_, full)| full).filter(|_| name == "thin");
        report.push(self.row(
            format!("distance, triangles, {name}"),
            percent,
            "%",
            paper,
            "mean, of the diagonal",
        ));
        let shown = format!("{percent:.4}{}", paper.map_or(String::new(), |p| format!(" ({p})")));
        let none = String::new;
        let count = cells.len().to_string();
        Ok(vec![
            self.subject.name.clone(),
            self.side.to_string(),
            format!("triangles, {name}"),
            shown,
            none(),
            none(),
            count,
            none(),
        ])
    }
}
