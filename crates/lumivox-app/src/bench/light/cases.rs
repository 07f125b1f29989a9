//! The scenes that light is measured in: the papers', and those that everybody knows.

use std::path::Path;

use anyhow::{Context, Result};
use clap::Parser;

use crate::args::ShotArgs;
use crate::bench::models;

/// A scene and how it is looked at.
#[derive(Debug)]
pub(super) struct Case {
    pub(super) name: &'static str,
    pub(super) shot: ShotArgs,
    /// Propagation steps and milliseconds of voxelization and propagation in the dissertation's Table 2.
    pub(super) paper: Option<Table2>,
}

/// A line of the dissertation's Table 2.
#[derive(Clone, Copy, Debug)]
pub(super) struct Table2 {
    pub(super) iterations: u32,
    pub(super) voxelization_ms: f64,
    pub(super) propagation_ms: f64,
}

const fn table_2(iterations: u32, voxelization_ms: f64, propagation_ms: f64) -> Option<Table2> {
    Some(Table2 { iterations, voxelization_ms, propagation_ms })
}

/// A shot as the command line would make it.
#[derive(Debug, Parser)]
struct Line {
    #[command(flatten)]
    shot: ShotArgs,
}

fn case(name: &'static str, line: &str, paper: Option<Table2>) -> Result<Case> {
    let words = std::iter::once("case").chain(line.split(' '));
    let shot = Line::try_parse_from(words).with_context(|| line.to_owned())?.shot;
    Ok(Case { name, shot, paper })
}

/// All scenes, or the two smallest. Those from files are there if `LUMIVOX_ASSETS` names a folder with them.
pub(super) fn cases(quick: bool) -> Result<Vec<Case>> {
    let mut all = vec![
        case("test", "builtin:test", table_2(11, 10.0, 12.0))?,
        case("cornell", "builtin:cornell", None)?,
    ];
    if quick {
        return Ok(all);
    }
    all.extend([
        case("room", "builtin:room", table_2(64, 3.0, 61.0))?,
        case("atrium", "builtin:atrium", None)?,
        case("arena", "builtin:arena", table_2(12, 3.0, 13.0))?,
        case("terrain", "builtin:terrain", None)?,
        case("two rooms", "builtin:two_rooms", None)?,
    ]);
    let Some(folder) = models::assets() else { return Ok(all) };
    let mut add = |name, file: &str, options: &str, paper| -> Result<()> {
        let path = folder.join(Path::new(file));
        if path.is_file() && !path.to_string_lossy().contains(' ') {
            all.push(case(name, &format!("{}{options}", path.display()), paper)?);
        }
        Ok(())
    };
    // The reference's camera, and a sun that reaches the floor.
    add(
        "Sponza",
        "scenes/sponza_dabrovic/sponza.glb",
        " --camera=-11,1.8,0.6:6,4.2,-1.2:60 --sun=0.18,-1,0.28:9,8.4,7.4",
        table_2(11, 10.0, 11.0),
    )?;
    add("staircase", "scenes/staircase2/staircase2.glb", "", None)?;
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_cases_are_command_lines_and_their_names_differ() {
        let mut names: Vec<_> = cases(false).unwrap().iter().map(|c| c.name).collect();
        assert!(names.len() >= 7);
        names.sort_unstable();
        names.dedup();
        assert!(names.len() >= 7);
    }
}
