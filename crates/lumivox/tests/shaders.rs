//! Every shader, without a GPU: it parses and validates with what the core tier has, its bindings are read right, and
//! every Rust struct has the layout of its twin in WGSL.

use std::collections::HashMap;

use lumivox::gpu::GeneratedText;
use naga::valid::{Capabilities, ValidationFlags, Validator};

/// All shaders, and the texts that are put together at run time.
fn all() -> Vec<GeneratedText> {
    let fixed = lumivox::shaders().into_iter();
    let fixed = fixed.map(|s| GeneratedText { name: s.name, source: s.source() });
    fixed.chain(lumivox::generated_texts()).collect()
}

fn parse(shader: &GeneratedText) -> naga::Module {
    let source = &shader.source;
    naga::front::wgsl::parse_str(source)
        .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(source)))
}

#[test]
fn all_validate_on_the_core_tier() {
    let shaders = all();
    assert!(shaders.len() >= 8, "only {} shaders found", shaders.len());
    let mut failures = Vec::new();
    for shader in &shaders {
        let module = parse(shader);
        // Nothing beyond WebGPU's own: what needs a native feature fails here. Packing to half floats is a part of
        // every WebGPU implementation, for which naga asks by name.
        let core = Capabilities::SHADER_FLOAT16_IN_FLOAT32;
        if let Err(e) = Validator::new(ValidationFlags::all(), core).validate(&module) {
            failures.push(format!("{}: {}", shader.name, e.emit_to_string(&shader.source)));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn bindings_are_read_as_naga_reads_them() {
    for shader in all() {
        let module = parse(&shader);
        let mut expected: Vec<_> = module
            .global_variables
            .iter()
            .filter_map(|(_, v)| {
                let at = v.binding.as_ref()?;
                let stores = match v.space {
                    naga::AddressSpace::Storage { access } => access.contains(naga::StorageAccess::STORE),
                    _ => matches!(
                        module.types[v.ty].inner,
                        naga::TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. }
                    ),
                };
                Some((at.group, at.binding, v.name.clone().unwrap_or_default(), stores))
            })
            .collect();
        let mut read: Vec<_> =
            shader.bindings().iter().map(|b| (b.group, b.binding, b.name.to_owned(), b.writes)).collect();
        expected.sort();
        read.sort();
        assert_eq!(read, expected, "{}", shader.name);
    }
}

#[test]
fn core_limits_of_a_stage_hold() {
    for shader in all() {
        let module = parse(&shader);
        let storage = module
            .global_variables
            .iter()
            .filter(|(_, v)| matches!(v.space, naga::AddressSpace::Storage { .. }))
            .count();
        assert!(storage <= 8, "{}: {storage} storage buffers, core WebGPU has 8 a stage", shader.name);
        let is_stored = |kind: &naga::TypeInner| {
            matches!(kind, naga::TypeInner::Image { class: naga::ImageClass::Storage { .. }, .. })
        };
        let textures =
            module.global_variables.iter().filter(|(_, v)| is_stored(&module.types[v.ty].inner)).count();
        assert!(textures <= 4, "{}: {textures} storage textures, core WebGPU has 4 a stage", shader.name);
    }
}

/// Struct name to fields with offsets, and size.
fn wgsl_structs() -> HashMap<String, (Vec<(String, usize)>, usize)> {
    let mut structs = HashMap::new();
    for shader in all() {
        let module = parse(&shader);
        for (_, kind) in module.types.iter() {
            if let (Some(name), naga::TypeInner::Struct { members, span }) = (&kind.name, &kind.inner) {
                let fields = members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset as usize));
                structs.insert(name.clone(), (fields.collect(), *span as usize));
            }
        }
    }
    structs
}

#[test]
fn rust_structs_have_the_layout_of_their_twins() {
    let twins = wgsl_structs();
    for (name, size, fields) in lumivox::gpu_structs() {
        let (wgsl_fields, span) = twins.get(name).unwrap_or_else(|| panic!("no shader declares {name}"));
        let rust_fields: Vec<_> =
            fields.iter().map(|(field, offset, _)| ((*field).to_owned(), *offset)).collect();
        assert_eq!(&rust_fields, wgsl_fields, "{name}");
        assert_eq!(size, *span, "size of {name}");
    }
}

#[test]
fn numbers_that_both_sides_spell_out_agree() {
    let modules: Vec<_> = all().iter().map(parse).collect();
    for (name, expected) in lumivox::shader_constants() {
        let values: Vec<f32> = modules
            .iter()
            .filter_map(|m| {
                let (_, constant) = m.constants.iter().find(|(_, c)| c.name.as_deref() == Some(name))?;
                match m.global_expressions[constant.init] {
                    naga::Expression::Literal(naga::Literal::F32(value)) => Some(value),
                    naga::Expression::Literal(naga::Literal::U32(value)) => Some(value as f32),
                    _ => None,
                }
            })
            .collect();
        assert!(!values.is_empty(), "no shader has the constant {name}");
        for value in values {
            assert!((value / expected - 1.0).abs() < 1e-6, "{name}: {value} in WGSL, {expected} in Rust");
        }
    }
}
