//! Channels on the command line, and as each voxelizer has them.

use std::str::FromStr;

use anyhow::{Context, Result, bail};
use lumivox::volume::Format as StoredFormat;
use lumivox::voxelize as gpu;
use lumivox_voxels::{Channel, Format, Rule};

use super::args::ColorArg;

pub(crate) const OCCUPANCY: &str = "occupancy";

/// A channel with its format and its rule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ChannelArg {
    name: &'static str,
    format: Option<Format>,
    rule: Option<Rule>,
}

const NAMES: [&str; 5] = [OCCUPANCY, "albedo", "normal", "emission", "area"];
pub(crate) const FORMATS: [(&str, Format); 3] =
    [("u8", Format::U8), ("f16", Format::F16), ("f32", Format::F32)];
pub(crate) const RULES: [(&str, Rule); 4] =
    [("average", Rule::Average), ("nearest", Rule::Nearest), ("max", Rule::Maximum), ("sum", Rule::Sum)];

impl ChannelArg {
    /// The channel as it is unless said otherwise.
    pub(crate) fn plain(name: &'static str) -> Self {
        Self { name, format: None, rule: None }
    }

    pub(crate) fn name(&self) -> &'static str {
        self.name
    }

    /// As the CPU's voxelizer has it.
    pub(crate) fn channel(&self, color: ColorArg) -> Channel {
        let rule_of_colors = match color {
            ColorArg::Average => Rule::Average,
            ColorArg::Nearest => Rule::Nearest,
        };
        let mut channel = match self.name {
            "normal" => Channel::normal(),
            "emission" => Channel::emission().rule(rule_of_colors),
            "area" => Channel::area(),
            _ => Channel::albedo().rule(rule_of_colors),
        };
        if let Some(format) = self.format {
            channel = channel.format(format);
        }
        if let Some(rule) = self.rule {
            channel = channel.rule(rule);
        }
        channel
    }

    /// As the GPU's voxelizer has it, for surfaces that emit at most `brightest`.
    pub(crate) fn gpu_channel(&self, color: ColorArg, brightest: f32) -> gpu::Channel {
        let rule_of_colors = match color {
            ColorArg::Average => gpu::Rule::Average,
            ColorArg::Nearest => gpu::Rule::Nearest,
        };
        // What bytes stand for differs for emission and area, and normals are of any length here: these become bytes on the way to
        // the file.
        let (mut channel, default, smallest) = match self.name {
            "normal" => (gpu::Channel::normal(), Format::F16, Format::F16),
            "emission" => {
                let channel = gpu::Channel::emission().range(0.0, brightest).rule(rule_of_colors);
                (channel, Format::F16, Format::F16)
            }
            "area" => (gpu::Channel::area(), Format::F32, Format::F32),
            _ => (gpu::Channel::albedo().rule(rule_of_colors), Format::U8, Format::U8),
        };
        channel = channel.format(match (self.format.unwrap_or(default), smallest) {
            (Format::U8, Format::U8) => StoredFormat::U8,
            (Format::U8 | Format::F16, Format::U8 | Format::F16) => StoredFormat::F16,
            _ => StoredFormat::F32,
        });
        match self.rule {
            Some(Rule::Average) => channel.rule(gpu::Rule::Average),
            Some(Rule::Nearest) => channel.rule(gpu::Rule::Nearest),
            Some(Rule::Maximum) => channel.rule(gpu::Rule::Maximum),
            Some(Rule::Sum) => channel.rule(gpu::Rule::Sum),
            None => channel,
        }
    }
}

impl FromStr for ChannelArg {
    type Err = anyhow::Error;

    fn from_str(text: &str) -> Result<Self> {
        let mut words = text.split(':');
        let name = words.next().unwrap_or_default();
        let name = NAMES
            .into_iter()
            .find(|known| *known == name)
            .with_context(|| format!("there is no channel {name:?}; known are {}", NAMES.join(", ")))?;
        let mut channel = Self { name, format: None, rule: None };
        for word in words {
            let format = FORMATS.iter().find(|(name, _)| *name == word).map(|f| f.1);
            let rule = RULES.iter().find(|(name, _)| *name == word).map(|r| r.1);
            match (format, rule) {
                _ if name == OCCUPANCY => bail!("occupancy has no format and no rule"),
                (Some(_), _) if channel.format.is_some() => bail!("{text:?} has two formats"),
                (_, Some(_)) if channel.rule.is_some() => bail!("{text:?} has two rules"),
                (None, None) => {
                    let known = FORMATS.iter().map(|f| f.0).chain(RULES.iter().map(|r| r.0));
                    let known: Vec<&str> = known.collect();
                    bail!("there is no format or rule {word:?}; known are {}", known.join(", "))
                }
                (Some(format), _) => channel.format = Some(format),
                (None, Some(rule)) => channel.rule = Some(rule),
            }
        }
        Ok(channel)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_have_formats_and_rules_in_any_order() {
        let read = |text: &str| text.parse::<ChannelArg>().unwrap();
        let expected = ChannelArg { name: "albedo", format: Some(Format::F32), rule: Some(Rule::Maximum) };
        assert_eq!((read("albedo:f32:max"), read("albedo:max:f32")), (expected, expected));
        assert_eq!(read("occupancy"), ChannelArg { name: OCCUPANCY, format: None, rule: None });
        for bad in ["", "colour", "albedo:u9", "albedo:u8:f16", "albedo:max:sum", "occupancy:u8", "albedo:"] {
            assert!(bad.parse::<ChannelArg>().is_err(), "{bad}");
        }
    }
}
