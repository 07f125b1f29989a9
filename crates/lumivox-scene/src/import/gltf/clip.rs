//! Animations to clips. What is wrong with a channel is a warning, and the channel is left out.

use gltf::json::animation::{Animation, Interpolation as JsonInterpolation, Property as Path};
use gltf::json::validation::Checked::Valid;

use super::accessor::Reader;
use super::node::Tree;
use crate::animation::{Channel, Property, Target};
use crate::mesh::check_limit;
use crate::{Clip, ImportReport, Interpolation, Limits, SceneError, Track};

/// The clips of an asset, short of those that move nothing.
pub(super) fn read(
    reader: &Reader,
    tree: &Tree,
    limits: &Limits,
    report: &mut ImportReport,
) -> Result<Vec<Clip>, SceneError> {
    let mut clips = Vec::new();
    let mut keys = 0;
    for (i, animation) in reader.root.animations.iter().enumerate() {
        let name = animation.name.clone().unwrap_or_default();
        let shown = if name.is_empty() { i.to_string() } else { format!("'{name}'") };
        let mut clip = Clip::new(name);
        for c in 0..animation.channels.len() {
            match read_channel(reader, tree, animation, c, limits, &mut keys)? {
                Ok(channel) => clip.add(channel),
                Err(why) => report.warn(format!("animation {shown}: channel {c} is left out: {why}")),
            }
        }
        if clip.channels.is_empty() {
            report.warn(format!("animation {shown} is left out: it moves nothing"));
        } else {
            clips.push(clip);
        }
    }
    Ok(clips)
}

/// The outer result is for what ends the import, the inner one for what ends the channel.
fn read_channel(
    reader: &Reader,
    tree: &Tree,
    animation: &Animation,
    channel: usize,
    limits: &Limits,
    keys: &mut u64,
) -> Result<Result<Channel, String>, SceneError> {
    let channel = &animation.channels[channel];
    let node = channel.target.node.value();
    let Some(&Some(target)) = tree.ids.get(node) else {
        return Ok(Err(format!("it moves node {node}, which is not in the scene")));
    };
    let Some(sampler) = animation.samplers.get(channel.sampler.value()) else {
        return Ok(Err("it has no sampler".to_owned()));
    };
    let interpolation = match sampler.interpolation {
        Valid(JsonInterpolation::Linear) => Interpolation::Linear,
        Valid(JsonInterpolation::Step) => Interpolation::Step,
        Valid(JsonInterpolation::CubicSpline) => Interpolation::CubicSpline,
        _ => return Ok(Err("its interpolation is unknown".to_owned())),
    };
    let Valid(path) = channel.target.path else {
        return Ok(Err("what it moves is unknown".to_owned()));
    };
    let (input, output) = (sampler.input.value(), sampler.output.value());
    *keys = keys.saturating_add(reader.count(input)?).saturating_add(reader.count(output)?);
    check_limit(reader.source.name(), "the number of keyframes", *keys, limits.keyframes)?;
    let times = reader.scalars(input)?;
    let (property, values) = match path {
        Path::Translation => (Property::Translation, flat(reader.vectors::<3>(output, 3..=3, 0.0)?)),
        Path::Scale => (Property::Scale, flat(reader.vectors::<3>(output, 3..=3, 0.0)?)),
        Path::Rotation => (Property::Rotation, flat(reader.vectors::<4>(output, 4..=4, 0.0)?)),
        Path::MorphTargetWeights => (Property::Weights, reader.scalars(output)?),
    };
    if property != Property::Weights && reader.root.nodes.get(node).is_some_and(|n| n.matrix.is_some()) {
        return Ok(Err(format!("it moves node {node}, which is placed by a matrix")));
    }
    let track = match Track::checked(property, interpolation, times, values) {
        Ok(track) => track,
        Err(why) => return Ok(Err(format!("it has {why}"))),
    };
    if property == Property::Weights && tree.targets.get(node).is_none_or(|n| *n != track.width) {
        return Ok(Err(format!("it has {} factors, but node {node} has other morph targets", track.width)));
    }
    Ok(Ok(Channel { target: Target::Node(target.0), track, period: None }))
}

fn flat<const N: usize>(vectors: Vec<[f32; N]>) -> Vec<f32> {
    vectors.into_iter().flatten().collect()
}
