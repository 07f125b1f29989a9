//! Options that have no effect beside others: whoever gives one expects something, and is told.

use super::see_through::{GlassArg, SeeThroughArgs, ShadowFilterArg};
use super::{
    AoArg, BlockingArg, ByArg, CleanupArg, GiArg, LayerArg, LightRuleArg, MirrorArg, ObjectArgs,
    ReflectionsArg, RenderArgs, VoxelizerArg, VoxelsArg,
};

/// A sentence for each option of a picture that does nothing beside the others.
pub(crate) fn idle_options(args: &RenderArgs) -> Vec<String> {
    let gi = args.shot.gi;
    let (gathers, propagates) = (matches!(gi, GiArg::Gather), matches!(gi, GiArg::Propagation));
    let shows_voxels = args.layer == LayerArg::Voxels;
    let from_triangles = match args.shot.voxelizer {
        Some(voxelizer) => matches!(voxelizer, VoxelizerArg::Triangles),
        None => args.frames.is_none(),
    };
    // Views go over what the frames before have left, in one pass or in two.
    let keeps_cells = !from_triangles && !matches!(args.shot.voxelizer, Some(VoxelizerArg::SingleFrame));
    let tells_ages = keeps_cells && !matches!(args.shot.voxelizer, Some(VoxelizerArg::SinglePass));
    let needs_gather = matches!(args.layer, LayerArg::Glossy | LayerArg::Leaks);
    let found = [
        (!matches!(args.shot.mirror, MirrorArg::None) && !propagates, "--mirror is for --gi propagation"),
        (args.shot.bounce_albedo.is_some() && !propagates, "--bounce-albedo is for --gi propagation"),
        (
            !matches!(args.shot.lpv_blocking, BlockingArg::None) && !matches!(gi, GiArg::Lpv),
            "--lpv-blocking is for --gi lpv",
        ),
        (
            args.shot.light_rule != LightRuleArg::Pulled && !propagates && !shows_voxels,
            "--light-rule is for --gi propagation and --layer voxels",
        ),
        (args.flow && !propagates, "--flow is for --gi propagation"),
        (args.light_budget.is_some() && !gathers, "--light-budget is for --gi gather"),
        (args.light_every > 1 && !gathers, "--light-every without --gi gather lets light change in jumps"),
        (args.slice.is_some() && !shows_voxels, "--slice is for --layer voxels"),
        (!matches!(args.voxels, VoxelsArg::Lit) && !shows_voxels, "--voxels is for --layer voxels"),
        (
            matches!(args.voxels, VoxelsArg::Age) && shows_voxels && !tells_ages,
            "--voxels age is for --voxelizer progressive or hybrid, and grey without",
        ),
        (
            !matches!(args.shot.cleanup, CleanupArg::Footprint) && !keeps_cells,
            "--cleanup is for --voxelizer progressive, single-pass or hybrid: no other keeps voxels that views could prove empty",
        ),
        (
            matches!(args.voxels, VoxelsArg::Unseen) && shows_voxels && from_triangles,
            "--voxels unseen shows nothing in pink where voxels come from triangles: try --voxelizer progressive",
        ),
        (
            args.layer == LayerArg::Lobes && matches!(gi, GiArg::Off),
            "--layer lobes shows indirect light, and is black with --gi off",
        ),
        (needs_gather && !gathers, "this --layer is of gathered light, and black without --gi gather"),
    ];
    found
        .into_iter()
        .chain(of_objects(&args.objects, args.layer))
        .chain(of_glass_and_leaves(&args.see_through, args.objects.shadows, args.layer))
        .filter(|(is_idle, _)| *is_idle)
        .map(|(_, told)| told.to_owned())
        .collect()
}

/// Options of visibility fields.
fn of_objects(args: &ObjectArgs, layer: LayerArg) -> [(bool, &'static str); 7] {
    let by_field = args.shadows == ByArg::Field;
    let (occludes, mirrors) = (args.ao != AoArg::Maps, args.reflections == ReflectionsArg::Field);
    let of_fields = args.field_points.is_some()
        || args.field_directions.is_some()
        || args.field_maps.is_some()
        || args.field_rays.is_some()
        || !args.casters.is_empty();
    [
        (
            of_fields && !by_field && !occludes && !mirrors,
            "--casters and --field-... are for visibility fields: --ao, --shadows or --reflections field",
        ),
        (
            (args.polish.is_some() || args.reflectance.is_some()) && !mirrors,
            "--polish and --reflectance are for --reflections field",
        ),
        (args.light_radius.is_some() && !by_field, "--light-radius is for --shadows field"),
        (layer == LayerArg::Occlusion && !occludes, "--layer occlusion is white without --ao field"),
        (
            layer == LayerArg::Reflections && !mirrors,
            "--layer reflections is black without --reflections field",
        ),
        (args.ao_reach.is_some() && !occludes, "--ao-reach and --ao-exponent are for --ao field or subtract"),
        (
            args.sigma != lumivox_render::LeafShadowSettings::default().sigma
                && args.shadows != ByArg::Transmittance,
            "--sigma is for --shadows transmittance",
        ),
    ]
}

/// Options of what light comes through.
fn of_glass_and_leaves(args: &SeeThroughArgs, shadows: ByArg, layer: LayerArg) -> [(bool, &'static str); 7] {
    let (leaves, is_seen_through) = (shadows == ByArg::Transmittance, args.glass == GlassArg::Refract);
    let shows_glass = matches!(layer, LayerArg::Final | LayerArg::Thickness);
    [
        (args.cull_volumes && shadows != ByArg::Volumes, "--cull-volumes is for --shadows volumes"),
        (args.shadow_colors && !leaves, "--shadow-colors is for --shadows transmittance"),
        (
            args.shadow_filter != ShadowFilterArg::Steps && !leaves,
            "--shadow-filter is for --shadows transmittance",
        ),
        (
            layer == LayerArg::Transmittance && !leaves,
            "--layer transmittance is white without --shadows transmittance",
        ),
        (layer == LayerArg::Thickness && !is_seen_through, "--layer thickness is black with --glass opaque"),
        (
            args.speaks_of_glass() && !is_seen_through,
            "--ior, --bend, --frost, --glass-slices and --environment... are for --glass refract",
        ),
        (
            args.speaks_of_glass() && is_seen_through && !shows_glass,
            "--ior, --bend, --frost, --glass-slices and --environment... are for --layer final and thickness",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        args: RenderArgs,
    }

    fn told(line: &str) -> usize {
        let words = ["render", "builtin:cornell", "-o", "a.png"].into_iter().chain(line.split_whitespace());
        idle_options(&Line::try_parse_from(words).unwrap().args).len()
    }

    #[test]
    fn what_does_nothing_is_told_and_nothing_else() {
        for useful in [
            "",
            "--gi propagation --mirror axis",
            "--gi propagation --bounce-albedo 0.5",
            "--gi lpv --lpv-blocking fuzzy",
            "--frames 3 --gi propagation --flow",
            "--frames 3 --gi propagation --light-rule stored",
            "--frames 3 --layer voxels --light-rule stored",
            "--frames 3 --light-budget 4",
            "--layer voxels --slice y:1 --voxels unseen --voxelizer progressive",
            "--layer voxels --voxels age --voxelizer hybrid --cleanup center",
            "--frames 2 --cleanup rays --layer voxels --voxels age",
            "--voxelizer single-pass --cleanup rays",
            "--layer lobes",
            "--layer lobes --gi propagation",
            "--ao field --ao-reach 2 --casters ball --field-maps nearest",
            "--shadows field --light-radius 0.2 --field-rays 4",
            "--reflections field --polish 0.1 --field-points 290",
            "--ao subtract --layer occlusion",
            "--shadows transmittance --shadow-filter linear --shadow-colors",
            "--shadows transmittance --layer transmittance",
            "--layer thickness --glass-slices 64",
            "--ior 1.3 --environment studio --environment-only",
            "--glass opaque",
        ] {
            assert_eq!(told(useful), 0, "{useful}");
        }
        for idle in [
            "--mirror axis",
            "--bounce-albedo 0.5",
            "--bounce-albedo 0.5 --gi lpv",
            "--lpv-blocking fuzzy",
            "--light-rule stored",
            "--frames 3 --flow",
            "--frames 3 --light-budget 4 --gi lpv",
            "--frames 3 --light-every 2 --gi propagation",
            "--slice y:1",
            "--voxels normal",
            "--layer voxels --voxels unseen",
            "--cleanup rays",
            "--voxelizer single-frame --cleanup center",
            "--frames 2 --voxelizer triangles --cleanup rays",
            "--layer voxels --voxels age",
            "--layer voxels --voxels age --voxelizer single-pass",
            "--layer voxels --voxels age --voxelizer single-frame",
            "--layer leaks --gi off",
            "--layer lobes --gi off",
            "--casters ball",
            "--field-points 290 --field-maps nearest",
            "--polish 0.2 --ao field",
            "--light-radius 0.2",
            "--ao-reach 2",
            "--layer occlusion --shadows field",
            "--layer reflections",
            "--sigma 0.1",
            "--shadow-colors",
            "--shadow-filter linear",
            "--layer transmittance",
            "--layer transmittance --shadows volumes",
            "--layer thickness --glass opaque",
            "--glass opaque --ior 1.3",
            "--glass opaque --layer direct --frost 0.1",
            "--layer direct --glass-slices 64",
            "--layer albedo --environment studio",
        ] {
            assert_eq!(told(idle), 1, "{idle}");
        }
    }
}
