//! Channels of surfaces, and the WGSL that they turn into.

use std::fmt::Write;

use crate::gpu::GpuError;

/// What a channel takes from a view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AttributeKind {
    /// The view's normals, and 1 in the fourth number.
    Normal,
    /// Four numbers of a picture from 0 to this bound; what is larger is cut.
    Color(f32),
    /// Four numbers of a picture, of either sign, up to this bound.
    Signed(f32),
}

/// A channel of a volume: means of four numbers over the points that fell into a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct AttributeChannel {
    /// Its name.
    pub name: String,
    /// Where its numbers come from.
    pub kind: AttributeKind,
}

impl AttributeChannel {
    /// A channel.
    pub fn new(name: &str, kind: AttributeKind) -> Self {
        Self { name: name.to_owned(), kind }
    }

    /// The largest number it holds: fixed-point sums are as fine as this allows.
    fn largest(&self) -> f32 {
        match self.kind {
            AttributeKind::Normal => 1.0,
            AttributeKind::Color(bound) | AttributeKind::Signed(bound) => bound.clamp(1e-6, 65504.0),
        }
    }

    /// Whether a view brings a picture of it.
    pub(super) fn has_picture(&self) -> bool {
        self.kind != AttributeKind::Normal
    }
}

/// The first binding of pictures.
const FIRST_BINDING: usize = 8;
/// With more than these the text would bind more than 16 resources.
pub(super) const MOST_CHANNELS: usize = 8;
/// How pictures are called in the text; the pictures that views bring, in order.
pub(super) const PICTURES: [&str; MOST_CHANNELS] =
    ["picture_0", "picture_1", "picture_2", "picture_3", "picture_4", "picture_5", "picture_6", "picture_7"];

/// Words of a cell's sums: four for each channel, and a count.
pub(super) fn sum_words(channels: u64) -> u64 {
    4 * channels + 1
}

/// What adds to a cell's sums, and what makes means of them.
pub(super) const ADD: &str = include_str!("add_value.wgsl");
pub(super) const MEAN: &str = include_str!("mean_value.wgsl");

/// Refuses too few or too many.
pub(super) fn check(channels: &[AttributeChannel]) -> Result<(), GpuError> {
    if channels.is_empty() || channels.len() > MOST_CHANNELS {
        let reason = format!("a volume has 1 to {MOST_CHANNELS} channels, not {}", channels.len());
        return Err(GpuError::Validation(reason));
    }
    Ok(())
}

/// Some sets of channels, for checks of the texts that they turn into.
pub(super) fn examples() -> Vec<Vec<AttributeChannel>> {
    let one = AttributeChannel::new("normal", AttributeKind::Normal);
    let kinds = [AttributeKind::Signed(4.0), AttributeKind::Normal, AttributeKind::Color(1.0)];
    let others = (0..7).map(|n| AttributeChannel::new("any", kinds[n % 3]));
    vec![vec![one.clone()], [one].into_iter().chain(others).collect()]
}

/// How many channels there are, and how large they are.
pub(super) fn sizes_text(channels: &[AttributeChannel]) -> String {
    let mut text = format!(
        "const CHANNELS: u32 = {}u;\nconst SUM_WORDS: u32 = {}u;\n\nfn channel_largest(channel: u32) -> f32 {{\n    switch channel {{\n",
        channels.len(),
        sum_words(channels.len() as u64)
    );
    for (n, channel) in channels.iter().enumerate() {
        let _ = writeln!(text, "        case {n}u: {{ return {:e}; }}", channel.largest());
    }
    text + "        default: { return 1.0; }\n    }\n}\n"
}

/// What a point adds to the sums of its cell.
pub(super) fn pictures_text(channels: &[AttributeChannel]) -> String {
    let (mut bindings, mut body, mut picture) = (String::new(), String::new(), 0);
    for (n, channel) in channels.iter().enumerate() {
        let load = format!("textureLoad(picture_{picture}, texel, 0)");
        let value = match channel.kind {
            AttributeKind::Normal => "vec4f(normal, 1.0)".to_owned(),
            AttributeKind::Color(_) => format!("max({load}, vec4f(0.0))"),
            AttributeKind::Signed(_) => load,
        };
        let _ = writeln!(body, "    add(at + {}u, {value}, channel_largest({n}u));", 4 * n);
        if channel.has_picture() {
            let at = FIRST_BINDING + picture;
            let _ = writeln!(bindings, "@group(0) @binding({at}) var picture_{picture}: texture_2d<f32>;");
            picture += 1;
        }
    }
    format!("{bindings}\nfn add_attributes(at: u32, texel: vec2u, normal: vec3f) {{\n{body}}}\n")
}
