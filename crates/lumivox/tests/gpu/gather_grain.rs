//! What pixels see has less grain than what rays found, as much light, and none from behind a wall.

use libtest_mimic::Failed;
use lumivox::gather::GatherSettings;
use lumivox::glam::{UVec3, Vec3, Vec4};

use crate::cells::Cells;
use crate::gather::Room;
use crate::{Labs, Test};

pub(crate) const TESTS: &[Test] = &[
    ("gather grain: few rays, less grain and as much light", less_grain),
    ("gather grain: none of the light behind a wall", walls),
];

const SIDE: u32 = 14;

/// The light of all sides of all surfels.
fn light_of(sides: &[[Option<Vec3>; 6]]) -> Vec<f32> {
    sides.iter().flatten().flatten().map(|e| e.x).collect()
}

/// A black room with a small lamp on its floor, which few rays meet.
fn room() -> Cells {
    let mut cells = Cells::new(SIDE);
    cells.room(1, SIDE - 2, 0.0, 0.0);
    let lamp = cells.grid.index(UVec3::new(5, 1, 6));
    cells.emission[lamp] = Vec4::splat(40.0);
    cells
}

fn less_grain(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let settings = |rays| GatherSettings { rays, ..GatherSettings::default() };
    let mut sure = Room::new(gpu, &room(), settings(1024))?;
    sure.frame(gpu, 1)?;
    let truth = light_of(&sure.light.read_irradiance(gpu)?);
    let mut few = Room::new(gpu, &room(), settings(32))?;
    few.frame(gpu, 1)?;
    let off = |found: &[f32]| {
        let squares: f32 = found.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        (squares / truth.len() as f32).sqrt() / (truth.iter().sum::<f32>() / truth.len() as f32)
    };
    let [rays, shown] = [few.light.read_irradiance(gpu)?, few.light.read_shown(gpu)?].map(|s| light_of(&s));
    let ratio = shown.iter().sum::<f32>() / rays.iter().sum::<f32>();
    eprintln!("32 rays are off by {:.3}, shown by {:.3}, {ratio:.3} of the light", off(&rays), off(&shown));
    assert!(off(&shown) < 0.7 * off(&rays));
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    Ok(())
}

/// A wall one cell thick parts the room; the lamp is on one side of it, right beside the other half's floor.
fn walls(labs: &Labs) -> Result<(), Failed> {
    let gpu = &labs.core.gpu;
    let mut cells = room();
    for cell in cells.grid.cells().filter(|c| c.x == 7).collect::<Vec<_>>() {
        if (2..SIDE - 2).contains(&cell.y) && (2..SIDE - 2).contains(&cell.z) {
            cells.surface(cell, Vec3::ZERO, 0.0);
        }
    }
    let mut room = Room::new(gpu, &cells, GatherSettings { rays: 32, ..GatherSettings::default() })?;
    room.frame(gpu, 1)?;
    let shown = room.light.read_shown(gpu)?;
    // Cells that lie behind the wall; their sides do, too.
    let (mut dark, mut lit) = (0f32, 0f32);
    for (cell, sides) in cells.grid.cells().zip(&shown) {
        let most = sides.iter().flatten().map(|e| e.x).fold(0.0, f32::max);
        if cell.x > 7 {
            dark = dark.max(most);
        } else {
            lit = lit.max(most);
        }
    }
    assert!(lit > 0.1 && dark == 0.0, "lit {lit}, dark {dark}");
    Ok(())
}
