//! Options that have no effect beside others: whoever gives one expects something, and is told.

use super::{BlockingArg, GiArg, LayerArg, MirrorArg, RenderArgs, VoxelizerArg, VoxelsArg};

/// A sentence for each option of a picture that does nothing beside the others.
pub(crate) fn idle_options(args: &RenderArgs) -> Vec<String> {
    let gi = args.shot.gi;
    let (gathers, propagates) = (matches!(gi, GiArg::Gather), matches!(gi, GiArg::Propagation));
    let shows_voxels = args.layer == LayerArg::Voxels;
    let from_triangles = match args.shot.voxelizer {
        Some(voxelizer) => matches!(voxelizer, VoxelizerArg::Triangles),
        None => args.frames.is_none() || args.light_every > 1,
    };
    let needs_gather = matches!(args.layer, LayerArg::Lobes | LayerArg::Glossy | LayerArg::Leaks);
    let found = [
        (!matches!(args.shot.mirror, MirrorArg::None) && !propagates, "--mirror is for --gi propagation"),
        (
            !matches!(args.shot.lpv_blocking, BlockingArg::None) && !matches!(gi, GiArg::Lpv),
            "--lpv-blocking is for --gi lpv",
        ),
        (args.flow && !propagates, "--flow is for --gi propagation"),
        (args.light_budget.is_some() && !gathers, "--light-budget is for --gi gather"),
        (args.light_every > 1 && !gathers, "--light-every without --gi gather lets light change in jumps"),
        (args.slice.is_some() && !shows_voxels, "--slice is for --layer voxels"),
        (!matches!(args.voxels, VoxelsArg::Lit) && !shows_voxels, "--voxels is for --layer voxels"),
        (
            matches!(args.voxels, VoxelsArg::Unseen) && shows_voxels && from_triangles,
            "--voxels unseen shows nothing in pink where voxels come from triangles: try --voxelizer progressive",
        ),
        (needs_gather && !gathers, "this --layer is of gathered light, and black without --gi gather"),
    ];
    found.into_iter().filter(|(is_idle, _)| *is_idle).map(|(_, told)| told.to_owned()).collect()
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
            "--gi lpv --lpv-blocking fuzzy",
            "--frames 3 --gi propagation --flow",
            "--frames 3 --light-budget 4",
            "--layer voxels --slice y:1 --voxels unseen --voxelizer progressive",
            "--layer lobes",
        ] {
            assert_eq!(told(useful), 0, "{useful}");
        }
        for idle in [
            "--mirror axis",
            "--lpv-blocking fuzzy",
            "--frames 3 --flow",
            "--frames 3 --light-budget 4 --gi lpv",
            "--frames 3 --light-every 2 --gi propagation",
            "--slice y:1",
            "--voxels normal",
            "--layer voxels --voxels unseen",
            "--layer leaks --gi off",
        ] {
            assert_eq!(told(idle), 1, "{idle}");
        }
    }
}
