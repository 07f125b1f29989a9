//! The WGSL that channels turn into: how surface points are added to sums, how sums become values, and how sums of two layers
//! are added. Names that begin with `lv_` are those of the shared parts beside this file.

use std::fmt::Write;
use std::sync::Arc;

use super::channel::{Channel, Rule, Source, SurfaceFunction};
use super::mesh;
use super::method::Options;
use crate::gpu::{GeneratedText, Gpu, GpuError, bind_group_layouts};
use crate::volume::Format;
use crate::wgsl::{GRID, PACK, SH};

const ACCUMULATORS: &str = include_str!("accumulators.wgsl");
const MESH: &str = include_str!("mesh.wgsl");
const TRIANGLE: &str = include_str!("triangle.wgsl");
const COVERAGE: &str = include_str!("coverage.wgsl");
const SURFACE: &str = include_str!("surface.wgsl");
const RESOLVE: &str = include_str!("resolve.wgsl");
const MERGE: &str = include_str!("merge.wgsl");

/// Outputs of one resolve pass: eight storage buffers less occupancy and sums.
pub(super) const RESOLVE_OUTPUTS: usize = 6;
/// Names of the outputs in its bindings.
pub(super) const OUTPUT_NAMES: [&str; RESOLVE_OUTPUTS] =
    ["out_0", "out_1", "out_2", "out_3", "out_4", "out_5"];

/// Words behind a channel's own where it has opacity: its sum, and whether anything is solid.
const OPACITY_WORDS: u32 = 3;

/// The two passes over the triangles; the second only where a channel's rule is [`Rule::Nearest`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    /// Everything but the values of nearest points.
    Sums,
    /// The values of the points that the first found to be nearest.
    Nearest,
}

/// Channels, and where their sums lie in a cell's words.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub(super) channels: Vec<Channel>,
    /// First word of each channel.
    offsets: Vec<u32>,
    /// The word of the nearest distance.
    nearness: u32,
    /// Words of a cell.
    pub(super) words: u32,
}

impl Layout {
    pub(super) fn new(channels: &[Channel]) -> Self {
        let any = |rule| channels.iter().any(|c| c.rule == rule);
        // The weight of averages comes first.
        let mut words = if any(Rule::Average) { 2 } else { 0 };
        let nearness = words;
        words += u32::from(any(Rule::Nearest));
        let mut offsets = Vec::new();
        for channel in channels {
            offsets.push(words);
            let each = if matches!(channel.rule, Rule::Average | Rule::Sum) { 2 } else { 1 };
            words += each * channel.format.components + if channel.opacity { OPACITY_WORDS } else { 0 };
        }
        Self { channels: channels.to_vec(), offsets, nearness, words }
    }

    pub(super) fn has(&self, rule: Rule) -> bool {
        self.channels.iter().any(|c| c.rule == rule)
    }

    fn each(&self) -> impl Iterator<Item = (&Channel, u32)> {
        self.channels.iter().zip(self.offsets.iter().copied())
    }

    /// The functions that channels ask, each once.
    fn functions(&self) -> Vec<&Arc<SurfaceFunction>> {
        let mut functions: Vec<&Arc<SurfaceFunction>> = Vec::new();
        for channel in &self.channels {
            if let Source::Function { function, .. } = &channel.source
                && !functions.iter().any(|f| Arc::ptr_eq(f, function))
            {
                functions.push(function);
            }
        }
        functions
    }

    /// The texts of all functions.
    pub(super) fn function_text(&self) -> String {
        let texts: Vec<&str> = self.functions().into_iter().map(|f| f.text.as_str()).collect();
        texts.join("\n") + "\n"
    }

    /// `lv_accumulate(s, area in cell faces, squared distance from the cell's centre in cells)`, and the functions that it calls.
    fn accumulate(&self, phase: Phase) -> String {
        let mut out = self.function_text();
        let functions = self.functions();
        out.push_str("fn lv_accumulate(s: SurfacePoint, area: f32, square_distance: f32) {\n");
        let is_used = |c: &Channel| phase == Phase::Sums || c.rule == Rule::Nearest;
        if self.words > 0 {
            let _ = writeln!(out, "    let at = (s.cell - window.base - window.first) * {}u;", self.words);
        }
        if self.has(Rule::Nearest) {
            let _ = writeln!(out, "    let nearness = lv_nearness(square_distance);");
            let word = self.nearness;
            match phase {
                Phase::Sums => {
                    let _ = writeln!(out, "    atomicMax(&sums[at + {word}u], nearness);");
                }
                Phase::Nearest => {
                    let _ = writeln!(out, "    if nearness != atomicLoad(&sums[at + {word}u]) {{ return; }}");
                }
            }
        }
        if phase == Phase::Sums && self.has(Rule::Average) {
            out.push_str(
                "    let weight = max(area, 2.384185791015625e-7);\n    lv_add_share(at, weight);\n",
            );
        }
        for (n, function) in functions.iter().enumerate() {
            let asks = |c: &Channel| matches!(&c.source, Source::Function { function: f, .. } if Arc::ptr_eq(f, function));
            if self.channels.iter().any(|c| asks(c) && self.is_added(c, phase)) {
                let _ = writeln!(out, "    let function_{n} = {}(s);", function.name);
            }
        }
        for (channel, offset) in self.each().filter(|(c, _)| is_used(c) && self.is_added(c, phase)) {
            let _ = writeln!(out, "    {{ let v = {};", self.value(channel, &functions));
            let [low, high] = channel.format.range;
            for (n, component) in
                ["x", "y", "z", "w"].iter().take(channel.format.components as usize).enumerate()
            {
                let value = format!("v.{component}");
                let line = match channel.rule {
                    Rule::Average => format!(
                        "lv_add_share(at + {}u, weight * lv_in_range({value}, {low:?}, {:?}));",
                        offset + 2 * n as u32,
                        high - low
                    ),
                    Rule::Sum => format!(
                        "lv_add_value(at + {}u, {value} / {:?});",
                        offset + 2 * n as u32,
                        low.abs().max(high.abs())
                    ),
                    Rule::Maximum | Rule::Nearest => {
                        format!("atomicMax(&sums[at + {}u], lv_ordered({value}));", offset + n as u32)
                    }
                };
                let _ = writeln!(out, "        {line}");
            }
            if channel.opacity {
                let sum = offset + 2 * channel.format.components;
                let _ = writeln!(
                    out,
                    "        let opacity = lv_opacity(s);\n        lv_add_share(at + {sum}u, weight * opacity);\n        \
                     if opacity == 1.0 && mesh.alpha_cutoff < 0.0 {{ atomicMax(&sums[at + {}u], 1u); }}",
                    sum + 2
                );
            }
            out.push_str("    }\n");
        }
        out.push_str("}\n");
        out
    }

    fn is_added(&self, channel: &Channel, phase: Phase) -> bool {
        (channel.rule == Rule::Nearest) == (phase == Phase::Nearest)
    }

    fn value(&self, channel: &Channel, functions: &[&Arc<SurfaceFunction>]) -> String {
        match &channel.source {
            Source::Albedo => "s.color".to_owned(),
            Source::Normal => "vec4f(s.normal, 0.0)".to_owned(),
            Source::Emission => "vec4f(s.emission, 0.0)".to_owned(),
            Source::Area => "vec4f(s.area, 0.0, 0.0, 0.0)".to_owned(),
            Source::Function { function, output } => {
                let n = functions.iter().position(|f| Arc::ptr_eq(f, function)).unwrap_or(0);
                match function.outputs {
                    0 | 1 => format!("function_{n}"),
                    _ => format!("function_{n}[{output}]"),
                }
            }
        }
    }

    /// A resolve pass for the channels of one part (see [`RESOLVE_OUTPUTS`]); the last one forgets the sums.
    fn resolve(&self, part: usize) -> String {
        let first = part * RESOLVE_OUTPUTS;
        let is_last = first + RESOLVE_OUTPUTS >= self.channels.len();
        let mut out = format!("const LV_SUM_WORDS: u32 = {}u;\n", self.words);
        let mine = || self.each().skip(first).take(RESOLVE_OUTPUTS).zip(OUTPUT_NAMES);
        for (n, (_, name)) in mine().enumerate() {
            let binding = n + 3;
            let _ =
                writeln!(out, "@group(0) @binding({binding}) var<storage, read_write> {name}: array<u32>;");
        }
        out.push_str("fn lv_resolve(cell: u32, at: u32) {\n");
        if self.has(Rule::Average) {
            out.push_str("    let weight = lv_wide(at);\n");
        }
        for ((channel, offset), name) in mine() {
            out.push_str(&resolve_channel(channel, offset, name));
        }
        if is_last {
            let words = self.words;
            let _ = writeln!(out, "    for (var i = 0u; i < {words}u; i++) {{ sums[at + i] = 0u; }}");
        }
        out.push_str("}\n");
        out
    }

    /// Adding a cell's sums to another layer's.
    fn merge(&self) -> String {
        let mut out = format!("const LV_SUM_WORDS: u32 = {}u;\nfn lv_merge(at: u32) {{\n", self.words);
        if self.has(Rule::Average) {
            out.push_str("    lv_merge_wide(at);\n");
        }
        let near = self.nearness;
        if self.has(Rule::Nearest) {
            let _ = writeln!(out, "    let nearer = sums_in[at + {near}u] > sums[at + {near}u];");
            let _ = writeln!(out, "    let as_near = sums_in[at + {near}u] == sums[at + {near}u];");
            let _ = writeln!(out, "    sums[at + {near}u] = max(sums[at + {near}u], sums_in[at + {near}u]);");
        }
        for (channel, offset) in self.each() {
            for n in 0..channel.format.components {
                let _ = match channel.rule {
                    Rule::Average | Rule::Sum => {
                        writeln!(out, "    lv_merge_wide(at + {}u);", offset + 2 * n)
                    }
                    Rule::Maximum => {
                        let i = offset + n;
                        writeln!(out, "    sums[at + {i}u] = max(sums[at + {i}u], sums_in[at + {i}u]);")
                    }
                    Rule::Nearest => {
                        let i = offset + n;
                        writeln!(
                            out,
                            "    if nearer {{ sums[at + {i}u] = sums_in[at + {i}u]; }} \
                             else if as_near {{ sums[at + {i}u] = max(sums[at + {i}u], sums_in[at + {i}u]); }}"
                        )
                    }
                };
            }
            if channel.opacity {
                let sum = offset + 2 * channel.format.components;
                let i = sum + 2;
                let _ = writeln!(out, "    lv_merge_wide(at + {sum}u);");
                let _ = writeln!(out, "    sums[at + {i}u] = max(sums[at + {i}u], sums_in[at + {i}u]);");
            }
        }
        out.push_str("}\n");
        out
    }
}

fn resolve_channel(channel: &Channel, offset: u32, name: &str) -> String {
    let format = &channel.format;
    let [low, high] = format.range;
    let mut out = String::from("    { var v = vec4f(0.0);\n");
    for n in 0..format.components {
        let value = match channel.rule {
            Rule::Average => {
                format!("{low:?} + {:?} * (lv_wide(at + {}u) / weight)", high - low, offset + 2 * n)
            }
            Rule::Sum => {
                let step = f64::from(low.abs().max(high.abs())) / 2f64.powi(28);
                format!("lv_signed_wide(at + {}u) * {:?}", offset + 2 * n, step as f32)
            }
            Rule::Maximum | Rule::Nearest => format!("lv_from_ordered(sums[at + {}u])", offset + n),
        };
        let _ = writeln!(out, "        v[{n}] = {value};");
    }
    out.push_str("        v = lv_finite(v);\n");
    if channel.unit {
        out.push_str("        v = lv_to_unit(v);\n");
    }
    if channel.occupancy && format.components == 3 && format.format == Format::F16 {
        out.push_str("        v.w = 1.0;\n");
    }
    if channel.opacity {
        let sum = offset + 2 * format.components;
        let _ = writeln!(
            out,
            "        if sums[at + {}u] == 0u {{ v.w = lv_wide(at + {sum}u) / weight; }}",
            sum + 2
        );
    }
    let words = format.words();
    match format.format {
        Format::U8 => {
            // Bytes that no component has are zero.
            let mask = (1u64 << (8 * format.components)) - 1;
            let _ = writeln!(out, "        {name}[cell] = lv_bytes(v, {low:?}, {:?}) & {mask}u;", high - low);
        }
        Format::F16 => {
            out.push_str("        let packed = pack_half4(v);\n");
            for word in 0..words {
                let _ = writeln!(out, "        {name}[{words}u * cell + {word}u] = packed[{word}];");
            }
        }
        Format::F32 => {
            for word in 0..words {
                let _ = writeln!(out, "        {name}[{words}u * cell + {word}u] = bitcast<u32>(v[{word}]);");
            }
        }
    }
    out.push_str("    }\n");
    out
}

/// The text of group 1, for passes that read meshes by themselves.
pub(crate) fn mesh_text() -> String {
    let mut text = String::new();
    for (name, value) in mesh::FLAGS {
        let _ = writeln!(text, "const {name}: u32 = {value}u;");
    }
    text + MESH
}

/// What methods have in common: groups 0 to 2, `lv_load_triangle`, `lv_tests`, `lv_marks`, `lv_piece`, `lv_surface_point`,
/// `lv_fragment`, `lv_accumulate`. A method's own text follows, with its own bindings in group 3.
///
/// A `is_plain` text is for meshes without textures and masks alone: drivers that take both sides of every branch are spared
/// looking textures up.
pub(crate) fn method_text(layout: &Layout, options: &Options, phase: Phase, is_plain: bool) -> String {
    let mut head = String::new();
    for (name, value) in mesh::FLAGS {
        let _ = writeln!(head, "const {name}: u32 = {value}u;");
    }
    let _ = writeln!(head, "const LV_COVERAGE: u32 = {}u;", options.coverage as u32);
    let _ = writeln!(head, "const LV_SHIFT: f32 = {:?};", options.shift);
    let _ = writeln!(head, "const LV_SEE_THROUGH: u32 = {}u;", options.see_through as u32);
    let _ = writeln!(head, "const LV_IS_PLAIN: bool = {is_plain};");
    let _ = writeln!(head, "const LV_IS_BARE: bool = {};", layout.channels.is_empty());
    let accumulate = layout.accumulate(phase);
    [GRID, SH, &head, ACCUMULATORS, MESH, TRIANGLE, COVERAGE, SURFACE, &accumulate].join("\n")
}

/// Text of a resolve pass.
pub(super) fn resolve_text(layout: &Layout, part: usize) -> GeneratedText {
    GeneratedText { name: "voxelize/resolve", source: [PACK, RESOLVE, &layout.resolve(part)].join("\n") }
}

/// Text of the pass that adds one layer to another.
pub(super) fn merge_text(layout: &Layout) -> GeneratedText {
    GeneratedText { name: "voxelize/merge", source: [MERGE, &layout.merge()].join("\n") }
}

/// The layout of group 1.
pub(crate) fn mesh_layout(gpu: &Gpu) -> Result<wgpu::BindGroupLayout, GpuError> {
    group_layout(gpu, "voxelize/mesh", MESH, 1)
}

/// The layout of group 0 of methods.
pub(super) fn accumulators_layout(gpu: &Gpu) -> Result<wgpu::BindGroupLayout, GpuError> {
    group_layout(gpu, "voxelize/accumulators", ACCUMULATORS, 0)
}

fn group_layout(
    gpu: &Gpu,
    name: &'static str,
    source: &str,
    group: usize,
) -> Result<wgpu::BindGroupLayout, GpuError> {
    let text = GeneratedText { name, source: source.to_owned() };
    let found = bind_group_layouts(gpu, &text)?.into_iter().nth(group).flatten();
    found.ok_or_else(|| GpuError::Binding { pass: name, reason: format!("has no group {group}") })
}
