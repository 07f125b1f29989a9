//! The kinds of glass of a scene: four at most, and what is told of those that are not shown as they are described.

use glam::Vec3;
use lumivox::refraction::Glass;
use lumivox::slicemap::MAX_KINDS;

/// A material as glass, and whether its meshes are closed.
#[derive(Clone, Debug, PartialEq)]
pub struct GlassKind {
    /// Index of the scene's material.
    pub material: usize,
    /// Edges of its meshes that are open; with any, it is thin.
    pub open_edges: usize,
    /// What it is like.
    pub glass: Glass,
}

/// What of a scene's glass is not shown as it is described.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GlassNote {
    /// Index of the scene's material.
    pub material: usize,
    /// What is wrong with it.
    pub issue: GlassIssue,
}

/// What may be wrong with glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlassIssue {
    /// Meshes of it are not closed, with so many open edges, and are shown as thin panes.
    Open {
        /// Open edges of all these meshes.
        edges: usize,
    },
    /// The faces of closed meshes look inward; they are shown turned round.
    InsideOut {
        /// How many meshes.
        meshes: usize,
    },
    /// A picture has no room for its kind: it looks like another.
    LooksLike {
        /// Index of the other's material.
        material: usize,
    },
}

/// The glass of an instance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Found {
    /// Number of its mesh.
    pub(super) mesh: usize,
    /// Whether its faces looked inward.
    pub(super) is_turned: bool,
    /// Whether its material says that it is thin.
    pub(super) is_pane: bool,
    pub(super) kind: GlassKind,
}

/// The kinds that are shown, the number of each instance's, and what is to be told.
#[derive(Debug, Default)]
pub(super) struct Kinds {
    pub(super) kinds: Vec<GlassKind>,
    pub(super) numbers: Vec<u32>,
    pub(super) notes: Vec<GlassNote>,
}

/// Instances of one material that differ in size bend as one up to this ratio.
const SAME_BEND: f32 = 1.25;

fn bend_ratio(a: &Glass, b: &Glass) -> f32 {
    let (low, high) = (a.bend.min(b.bend), a.bend.max(b.bend));
    // What is thin does not bend; two that do not bend are alike.
    if a.is_thin || high == low { 1.0 } else { high / low.max(1e-30) }
}

fn has_material_of(a: &GlassKind, b: &GlassKind) -> bool {
    a.material == b.material && a.glass.is_thin == b.glass.is_thin
}

impl Kinds {
    /// Puts alike instances together. Where there are more kinds than a picture has, materials come before sizes of one, then the first
    /// before the last; but if there is any thick glass and any thin, there is a kind of each, since one shown as the other is garbage.
    pub(super) fn new(found: &[Found]) -> Self {
        let mut all: Vec<GlassKind> = Vec::new();
        let mut known = Vec::new();
        let mut of_found = Vec::with_capacity(found.len());
        for Found { mesh, kind, .. } in found {
            let alike =
                |k: &GlassKind| has_material_of(k, kind) && bend_ratio(&k.glass, &kind.glass) <= SAME_BEND;
            let number = all.iter().position(alike).unwrap_or_else(|| {
                all.push(GlassKind { open_edges: 0, ..kind.clone() });
                all.len() - 1
            });
            if !known.contains(mesh) {
                known.push(*mesh);
                all[number].open_edges += kind.open_edges;
            }
            of_found.push(number);
        }
        let kept = kept(&all);
        let shown_as = |n: usize| -> usize {
            if let Some(place) = kept.iter().position(|k| *k == n) {
                return place;
            }
            let ratio = |place: &usize| bend_ratio(&all[kept[*place]].glass, &all[n].glass);
            let places = || (0..kept.len()).filter(|p| all[kept[*p]].glass.is_thin == all[n].glass.is_thin);
            let same = places().filter(|p| all[kept[*p]].material == all[n].material);
            same.min_by(|a, b| ratio(a).total_cmp(&ratio(b))).or_else(|| places().next_back()).unwrap_or(0)
        };
        let shown: Vec<usize> = (0..all.len()).map(shown_as).collect();
        let mut notes = shape_notes(found);
        for (n, place) in shown.iter().enumerate() {
            let issue = GlassIssue::LooksLike { material: all[kept[*place]].material };
            let note = GlassNote { material: all[n].material, issue };
            if !has_material_of(&all[kept[*place]], &all[n]) && !notes.contains(&note) {
                notes.push(note);
            }
        }
        Self {
            kinds: kept.iter().map(|n| all[*n].clone()).collect(),
            numbers: of_found.into_iter().map(|n| shown[n] as u32).collect(),
            notes,
        }
    }
}

/// Those of all kinds that a picture has, in their order.
fn kept(all: &[GlassKind]) -> Vec<usize> {
    let is_first = |n: &usize| !all[..*n].iter().any(|k| has_material_of(k, &all[*n]));
    let (materials, sizes): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(is_first);
    let mut kept: Vec<usize> = materials.iter().chain(&sizes).copied().take(MAX_KINDS as usize).collect();
    for thin in [false, true] {
        let missing = !kept.iter().any(|n| all[*n].glass.is_thin == thin);
        if let (true, Some(first)) = (missing, all.iter().position(|k| k.glass.is_thin == thin)) {
            kept.pop();
            kept.push(first);
        }
    }
    kept.sort_unstable();
    kept
}

/// What there is to be told of meshes, for each material once.
fn shape_notes(found: &[Found]) -> Vec<GlassNote> {
    let mut sums: Vec<(usize, usize, usize)> = Vec::new();
    let mut known = Vec::new();
    for Found { mesh, is_turned, is_pane, kind } in found {
        if *is_pane || known.contains(mesh) {
            continue;
        }
        known.push(*mesh);
        let place = sums.iter().position(|(material, ..)| *material == kind.material).unwrap_or_else(|| {
            sums.push((kind.material, 0, 0));
            sums.len() - 1
        });
        sums[place].1 += kind.open_edges;
        sums[place].2 += usize::from(*is_turned);
    }
    let note = |(material, edges, meshes): (usize, usize, usize)| {
        let open = (edges > 0).then_some(GlassIssue::Open { edges });
        let turned = (meshes > 0).then_some(GlassIssue::InsideOut { meshes });
        open.into_iter().chain(turned).map(move |issue| GlassNote { material, issue })
    };
    sums.into_iter().flat_map(note).collect()
}

/// A scene's glass as the pass takes it, for things of some extent in metres.
pub(super) fn described(glass: &lumivox_scene::Glass, tint: Vec3, extent: f32, is_open: bool) -> Glass {
    Glass {
        ior: glass.ior,
        // A ball bends in its middle as much as its two surfaces do.
        bend: glass.bend.unwrap_or(2.0 / extent.max(1e-6)),
        through: glass.through_metre(),
        tint,
        body: glass.body,
        frost: glass.frost,
        // Rough surfaces that hardly refract hardly blur.
        roughness: glass.roughness * glass.roughness * (2.0 * glass.ior - 2.0).clamp(0.0, 1.0),
        gloss: 1.0,
        is_thin: glass.is_thin || is_open,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(mesh: usize, material: usize, open_edges: usize, bend: f32) -> Found {
        let glass = Glass { bend, is_thin: open_edges > 0, ..Glass::default() };
        Found { mesh, is_turned: false, is_pane: false, kind: GlassKind { material, open_edges, glass } }
    }

    fn like(material: usize, other: usize) -> GlassNote {
        GlassNote { material, issue: GlassIssue::LooksLike { material: other } }
    }

    #[test]
    fn an_open_fifth_mesh_takes_the_place_of_a_thick_kind_and_is_told() {
        let mut five: Vec<Found> = (0..5).map(|n| found(n, n, 0, 3.0)).collect();
        five[4] = found(4, 4, 6, 3.0);
        let Kinds { kinds, numbers, notes } = Kinds::new(&five);
        assert_eq!(kinds.iter().map(|k| k.material).collect::<Vec<_>>(), [0, 1, 2, 4]);
        assert_eq!((kinds[3].glass.is_thin, kinds[3].open_edges), (true, 6));
        assert_eq!(numbers, [0, 1, 2, 2, 3]);
        let open = GlassNote { material: 4, issue: GlassIssue::Open { edges: 6 } };
        assert_eq!(notes, [open, like(3, 2)]);
        // The other way round: the only thick one comes last.
        let mut five: Vec<Found> = (0..5).map(|n| found(n, n, 3, 3.0)).collect();
        five[4] = found(4, 4, 0, 3.0);
        let Kinds { kinds, numbers, .. } = Kinds::new(&five);
        assert_eq!((kinds[3].material, kinds[3].glass.is_thin), (4, false));
        assert_eq!(numbers, [0, 1, 2, 2, 3]);
    }

    #[test]
    fn what_finds_no_room_looks_like_the_last_of_its_thickness() {
        let mut six: Vec<Found> = (0..6).map(|n| found(n, n, 0, 3.0)).collect();
        six[1] = found(1, 1, 2, 3.0);
        six[5] = found(5, 5, 4, 3.0);
        let Kinds { kinds, numbers, notes } = Kinds::new(&six);
        assert_eq!(kinds.len(), 4);
        assert_eq!(numbers, [0, 1, 2, 3, 3, 1]);
        assert!(notes.contains(&like(4, 3)) && notes.contains(&like(5, 1)), "{notes:?}");
        assert!(notes.contains(&GlassNote { material: 5, issue: GlassIssue::Open { edges: 4 } }));
    }

    #[test]
    fn sizes_of_one_material_bend_by_themselves_while_there_is_room() {
        let bends = [2.0, 2.2, 8.0, 2.0, 30.0, 100.0, 400.0];
        let of_size: Vec<Found> = bends.iter().map(|bend| found(0, 0, 0, *bend)).collect();
        let Kinds { kinds, numbers, notes } = Kinds::new(&of_size);
        assert_eq!(kinds.iter().map(|k| k.glass.bend).collect::<Vec<_>>(), [2.0, 8.0, 30.0, 100.0]);
        assert_eq!(numbers, [0, 0, 1, 0, 2, 3, 3]);
        assert!(notes.is_empty());
        // Another material comes before a size.
        let mut more = of_size;
        more.push(found(1, 1, 0, 3.0));
        let Kinds { kinds, numbers, .. } = Kinds::new(&more);
        assert_eq!(kinds.iter().map(|k| k.material).collect::<Vec<_>>(), [0, 0, 0, 1]);
        assert_eq!(numbers, [0, 0, 1, 0, 2, 2, 2, 3]);
    }

    #[test]
    fn shapes_are_told_for_each_mesh_once() {
        let turned = Found { is_turned: true, ..found(0, 0, 0, 3.0) };
        let pane = Found { is_pane: true, ..found(2, 1, 4, 3.0) };
        let all = [turned.clone(), turned, found(1, 0, 5, 3.0), found(1, 0, 5, 3.0), pane];
        let issues = [GlassIssue::Open { edges: 5 }, GlassIssue::InsideOut { meshes: 1 }];
        assert_eq!(Kinds::new(&all).notes, issues.map(|issue| GlassNote { material: 0, issue }));
    }
}
