//! The bytes of a glTF asset: the JSON and binary chunk of a GLB, buffers beside the file, and `data:` URIs.

use crate::import::source::Source;
use crate::mesh::check_limit;
use crate::{Limits, SceneError};

const MAGIC: &[u8] = b"glTF";
const JSON: u32 = u32::from_le_bytes(*b"JSON");
const BIN: u32 = u32::from_le_bytes(*b"BIN\0");

/// A GLB's two parts; a `.gltf` has the JSON alone.
pub(super) struct Chunks<'a> {
    pub(super) json: &'a [u8],
    pub(super) bin: Option<&'a [u8]>,
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes)
}

/// Splits a file, GLB or plain JSON. The content decides, not the extension: both are often misnamed.
pub(super) fn split<'a>(source: &Source, bytes: &'a [u8]) -> Result<Chunks<'a>, SceneError> {
    let first_text = bytes.iter().find(|b| !b.is_ascii_whitespace() && !matches!(b, 0xEF | 0xBB | 0xBF));
    if first_text == Some(&b'{') {
        let start = bytes.iter().position(|b| *b == b'{').unwrap_or(0);
        return Ok(Chunks { json: &bytes[start..], bin: None });
    }
    let fail = |reason: String| Err(source.malformed(reason));
    let (Some(version), Some(length)) = (u32_at(bytes, 4), u32_at(bytes, 8)) else {
        return fail(format!("has {} bytes, too few for a GLB header", bytes.len()));
    };
    if !bytes.starts_with(MAGIC) {
        return fail("is neither a GLB (it does not start with 'glTF') nor JSON".to_owned());
    }
    if version != 2 {
        return fail(format!("is a GLB of version {version}; only version 2 is read"));
    }
    let Some(body) = bytes.get(12..length as usize) else {
        return fail(format!("states a length of {length} bytes in its header but has {}", bytes.len()));
    };
    let (mut json, mut bin, mut at) = (None, None, 0);
    while at < body.len() {
        let (Some(size), Some(kind)) = (u32_at(body, at), u32_at(body, at + 4)) else {
            return fail(format!("ends inside a GLB chunk header at byte {}", at + 12));
        };
        let Some(chunk) = body.get(at + 8..).and_then(|rest| rest.get(..size as usize)) else {
            return fail(format!(
                "has a GLB chunk of {size} bytes at byte {} that reaches beyond its end",
                at + 12
            ));
        };
        match kind {
            JSON if json.is_none() => json = Some(chunk),
            BIN if json.is_some() && bin.is_none() => bin = Some(chunk),
            BIN if json.is_none() => return fail("has its binary GLB chunk before the JSON one".to_owned()),
            _ => {}
        }
        at += 8 + size as usize;
    }
    match json {
        Some(json) => Ok(Chunks { json, bin }),
        None => fail("is a GLB without a JSON chunk".to_owned()),
    }
}

/// The bytes that a buffer or image names: embedded as base64, or a file beside the scene.
pub(super) fn resolve(source: &Source, uri: &str, limits: &Limits) -> Result<Vec<u8>, SceneError> {
    if let Some(rest) = uri.strip_prefix("data:") {
        let Some((head, payload)) = rest.split_once(',') else {
            return Err(source.malformed("has a data: URI without a comma"));
        };
        if !head.ends_with(";base64") {
            return Ok(percent_decoded(payload));
        }
        return base64_decoded(payload).ok_or_else(|| source.malformed("has a data: URI that is no base64"));
    }
    let path = String::from_utf8_lossy(&percent_decoded(uri)).into_owned();
    source.beside(&path)?.read_self(limits)
}

/// All buffers of the asset, at least as long as they state.
pub(super) fn buffers(
    source: &Source,
    root: &gltf::json::Root,
    bin: Option<&[u8]>,
    limits: &Limits,
) -> Result<Vec<Vec<u8>>, SceneError> {
    let stated = root.buffers.iter().fold(0u64, |sum, b| sum.saturating_add(b.byte_length.0));
    check_limit(source.name(), "the size of its buffers in bytes", stated, limits.buffer_bytes)?;
    let mut total = 0;
    let mut all = Vec::with_capacity(root.buffers.len());
    for (i, buffer) in root.buffers.iter().enumerate() {
        let length = buffer.byte_length.0 as usize;
        let bytes = match (&buffer.uri, bin) {
            (Some(uri), _) => resolve(source, uri, limits)
                .map_err(|e| source.malformed(format!("needs a buffer that is not there: {e}")))?,
            (None, Some(bin)) if i == 0 => bin.to_vec(),
            // Allowed by the format, for extensions that fill it; here nothing may read from it.
            (None, _) => return Err(source.malformed(format!("has no data for buffer {i}"))),
        };
        if bytes.len() < length {
            let found = bytes.len();
            return Err(source.malformed(format!("states {length} bytes for buffer {i} but it has {found}")));
        }
        total += bytes.len() as u64;
        check_limit(source.name(), "the size of its buffers in bytes", total, limits.buffer_bytes)?;
        all.push(bytes);
    }
    Ok(all)
}

fn percent_decoded(text: &str) -> Vec<u8> {
    let bytes = text.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let hex = bytes.get(at + 1..at + 3).and_then(|h| std::str::from_utf8(h).ok());
        match hex.and_then(|h| u8::from_str_radix(h, 16).ok()) {
            Some(byte) if bytes[at] == b'%' => {
                out.push(byte);
                at += 3;
            }
            _ => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    out
}

/// Standard and URL-safe alphabets, padding optional; `None` for any other character.
fn base64_decoded(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 3);
    let (mut bits, mut count) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'\r' | b'\n' | b' ' => continue,
            _ => return None,
        };
        bits = (bits << 6) | u32::from(value);
        count += 6;
        if count >= 8 {
            count -= 8;
            out.push((bits >> count) as u8);
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_are_decoded() {
        assert_eq!(base64_decoded("TWFu").unwrap(), b"Man");
        assert_eq!(base64_decoded("TWE=").unwrap(), b"Ma");
        assert_eq!(base64_decoded("TQ").unwrap(), b"M");
        assert!(base64_decoded("T*").is_none());
        assert_eq!(percent_decoded("a%20b%2"), b"a b%2");
        assert_eq!(percent_decoded("100%é"), "100%é".as_bytes());
    }

    #[test]
    fn glb_faults_are_named() {
        let source = Source::of_memory("a.glb");
        let error = |bytes: &[u8]| split(&source, bytes).err().unwrap().to_string();
        assert_eq!(error(b""), "a.glb: has 0 bytes, too few for a GLB header");
        assert!(error(b"glTFxxxxxxxx").contains("version"));
        let header = |length: u32| [b"glTF".as_slice(), &2u32.to_le_bytes(), &length.to_le_bytes()].concat();
        assert!(error(&header(40)).contains("states a length of 40 bytes"));
        assert!(error(&header(3)).contains("states a length"));
        assert!(error(&header(12)).contains("without a JSON chunk"));
        assert!(error(&[header(15), vec![0; 3]].concat()).contains("inside a GLB chunk header"));
        let chunk = [header(22), 9u32.to_le_bytes().to_vec(), b"JSON{}".to_vec()].concat();
        assert!(error(&chunk).contains("beyond its end"));
    }
}
