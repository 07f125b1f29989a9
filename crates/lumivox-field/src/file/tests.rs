use std::fs;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU32, Ordering};

use xxhash_rust::xxh3::xxh3_64;

use super::*;
use crate::{Baker, Cache, Field, FieldError, Mapping, Progress, Settings, Storage, shapes};

/// A folder of a test's own, empty at first and removed after it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("lumivox-field-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self) -> PathBuf {
        self.0.join("a.lvf")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn go_on(_: Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn baker(points: u32, storage: Storage, normals: bool) -> Baker {
    let settings = Settings { points, directions: 32, storage, normals, ..Settings::default() };
    Baker::new(shapes::torus(1.0, 0.4, 8).mesh(), settings).unwrap()
}

fn bytes_of(baker: &Baker) -> Vec<u8> {
    static NUMBER: AtomicU32 = AtomicU32::new(0);
    let folder = Folder::new(&format!("bytes-{}", NUMBER.fetch_add(1, Ordering::Relaxed)));
    baker.bake_to_file(folder.file(), go_on).unwrap();
    fs::read(folder.file()).unwrap()
}

#[test]
fn fields_come_back_as_they_were_baked() {
    let folder = Folder::new("round");
    for storage in Storage::ALL {
        for normals in [false, true] {
            let baker = baker(82, storage, normals);
            let field = baker.bake(go_on).unwrap();
            baker.bake_to_file(folder.file(), go_on).unwrap();
            assert_eq!(Field::load(folder.file()).unwrap(), field);
            let baked = fs::read(folder.file()).unwrap();
            field.save(folder.file()).unwrap();
            assert_eq!(fs::read(folder.file()).unwrap(), baked);
            assert!(!part_path(&folder.file()).exists());
            assert_eq!(baked.len() as u64, 64 + field.bytes() + 2 * 8);
            assert_eq!(Field::from_bytes("a", &baked).unwrap(), field);
        }
    }
}

#[test]
fn every_changed_byte_is_refused() {
    let mut bytes = bytes_of(&baker(82, Storage::Bit, false));
    assert!(Field::from_bytes("a", &bytes).is_ok());
    for at in 0..bytes.len() {
        for change in [0x01, 0x80, 0xff] {
            bytes[at] ^= change;
            let refused = Field::from_bytes("a", &bytes).unwrap_err();
            let expected = match at {
                0..8 => matches!(refused, FieldError::NotAField { .. }),
                8..12 => matches!(refused, FieldError::Version { known: VERSION, .. }),
                _ => matches!(refused, FieldError::Damaged { .. }),
            };
            assert!(expected, "{at}: {refused}");
            bytes[at] ^= change;
        }
    }
}

#[test]
fn every_other_length_is_refused() {
    let bytes = bytes_of(&baker(82, Storage::Bit, false));
    for len in 0..bytes.len() {
        let refused = Field::from_bytes("a", &bytes[..len]).unwrap_err();
        let found = len as u64;
        match len {
            0..8 => assert!(matches!(refused, FieldError::NotAField { .. })),
            8..64 => {
                assert!(matches!(refused, FieldError::Size { expected: 64, found: f, .. } if f == found))
            }
            _ => assert!(matches!(refused, FieldError::Size { found: f, .. } if f == found)),
        }
    }
    let longer = [bytes.as_slice(), &[0]].concat();
    let text = Field::from_bytes("a", &longer).unwrap_err().to_string();
    assert_eq!(text, format!("a: the file has {} bytes instead of {}", longer.len(), bytes.len()));
}

#[test]
fn runs_that_change_places_or_files_are_refused() {
    let bytes = bytes_of(&baker(290, Storage::Bit, false));
    let run = 64 * (128 + 4) + 8;
    let mut swapped = bytes.clone();
    let (first, second) = swapped[HEADER_BYTES..].split_at_mut(run);
    first.swap_with_slice(&mut second[..run]);
    assert!(matches!(Field::from_bytes("a", &swapped), Err(FieldError::Damaged { .. })));
    let settings = Settings { mapping: Mapping::Uniform, ..*baker(290, Storage::Bit, false).settings() };
    let other = Baker::new(shapes::torus(1.0, 0.4, 8).mesh(), settings).unwrap();
    let mixed = [&bytes_of(&other)[..HEADER_BYTES], &bytes[HEADER_BYTES..]].concat();
    assert!(matches!(Field::from_bytes("a", &mixed), Err(FieldError::Damaged { .. })));
}

/// The file with some bytes of its header replaced and its header's checksum made right again.
fn forged(bytes: &[u8], at: usize, replacement: &[u8]) -> Vec<u8> {
    let mut bytes = bytes.to_vec();
    bytes[at..at + replacement.len()].copy_from_slice(replacement);
    let checksum = xxh3_64(&bytes[..56]);
    bytes[56..64].copy_from_slice(&checksum.to_le_bytes());
    bytes
}

#[test]
fn forged_headers_are_refused_before_anything_is_allocated() {
    let bytes = bytes_of(&baker(82, Storage::Bit, false));
    for (at, replacement) in [
        (12, 81u32.to_le_bytes()),
        (12, u32::MAX.to_le_bytes()),
        (16, 0u32.to_le_bytes()),
        (16, u32::MAX.to_le_bytes()),
        (20, [3, 8, 0, 0]),
        (20, [0, 0, 0, 0]),
        (20, [0, 8, 2, 0]),
        (20, [0, 8, 0, 1]),
        (24, f32::NAN.to_le_bytes()),
        (36, f32::INFINITY.to_le_bytes()),
        (36, (-1f32).to_le_bytes()),
        (36, 0f32.to_le_bytes()),
    ] {
        let refused = Field::from_bytes("a", &forged(&bytes, at, &replacement)).unwrap_err();
        assert!(matches!(refused, FieldError::Damaged { .. }), "{at} {replacement:?}: {refused}");
    }
    // The largest field there is, from a file of ten thousand bytes.
    let largest = [16642u32.to_le_bytes(), 256u32.to_le_bytes(), [2, 32, 1, 0]].concat();
    match Field::from_bytes("a", &forged(&bytes, 12, &largest)).unwrap_err() {
        FieldError::Size { expected, .. } => assert!(expected > 6_000_000_000),
        other => panic!("{other}"),
    }
    let newer = Field::from_bytes("a", &forged(&bytes, 8, &2u32.to_le_bytes())).unwrap_err().to_string();
    assert_eq!(newer, "a: this field has version 2 of the format; version 1 is read here");
}

#[test]
fn numbers_that_no_bake_writes_are_refused_even_with_their_checksum() {
    let baker = baker(82, Storage::Float, false);
    let header = Header { settings: *baker.settings(), sphere: baker.sphere(), mesh_key: baker.mesh_key() };
    for bad in [f32::NAN, -0.1, 1.5, f32::INFINITY] {
        let mut bytes = bytes_of(&baker);
        bytes[HEADER_BYTES + 400..HEADER_BYTES + 404].copy_from_slice(&bad.to_le_bytes());
        let run = HEADER_BYTES..HEADER_BYTES + 64 * 4096;
        let checksum = header.chunk_checksum(0, &bytes[run.clone()]);
        bytes[run.end..run.end + 8].copy_from_slice(&checksum.to_le_bytes());
        let text = Field::from_bytes("a", &bytes).unwrap_err().to_string();
        assert_eq!(text, "a: the file is damaged: the maps from number 0 on hold impossible numbers");
    }
}

#[test]
fn files_that_cannot_be_read_or_written_say_so() {
    let folder = Folder::new("io");
    let missing = folder.0.join("missing");
    assert!(matches!(Field::load(&missing), Err(FieldError::Io { action: "opening", .. })));
    assert!(Field::load(&folder.0).unwrap_err().to_string().ends_with("it is not a regular file"));
    let baker = baker(82, Storage::Bit, false);
    let refused = baker.bake_to_file(missing.join("a.lvf"), go_on);
    assert!(matches!(refused, Err(FieldError::Io { action: "opening", .. })));
    fs::create_dir(folder.file()).unwrap();
    let refused = baker.bake(go_on).unwrap().save(folder.file());
    assert!(matches!(refused, Err(FieldError::Io { action: "renaming", .. })), "{refused:?}");
    fs::write(&missing, b"ply\nformat ascii 1.0\n").unwrap();
    assert!(matches!(Field::load(&missing), Err(FieldError::NotAField { .. })));
}

/// Stops a bake into the folder's file after two runs.
fn stopped(folder: &Folder, baker: &Baker) {
    let stop = |p: Progress| if p.maps_done == 128 { ControlFlow::Break(()) } else { go_on(p) };
    let refused = baker.bake_to_file(folder.file(), stop);
    assert_eq!(refused, Err(FieldError::Cancelled { done: 128, total: 290 }));
    assert!(!folder.file().exists() && part_path(&folder.file()).exists());
}

#[test]
fn a_bake_goes_on_where_it_was_stopped() {
    let baker = baker(290, Storage::Byte, true);
    let whole = bytes_of(&baker);
    let run = 64 * 3 * 1024 + 8;
    // What happened to the part meanwhile, and how many maps are then to be baked again.
    type Change = fn(&mut Vec<u8>, usize);
    let changes: [(Change, u32); 6] = [
        (|_, _| (), 290 - 128),
        (|part, _| part.truncate(part.len() - 1), 290 - 64),
        (|part, run| part[HEADER_BYTES + run + 77] ^= 1, 290 - 64),
        (|part, _| part[30] ^= 1, 290),
        (|part, _| part.extend([9; 1000]), 290 - 128),
        (|part, _| part.clear(), 290),
    ];
    for (n, (change, maps)) in changes.into_iter().enumerate() {
        let folder = Folder::new(&format!("resume-{n}"));
        stopped(&folder, &baker);
        let path = part_path(&folder.file());
        let mut part = fs::read(&path).unwrap();
        change(&mut part, run);
        fs::write(&path, part).unwrap();
        let mut rays = 0;
        baker
            .bake_to_file(folder.file(), |p| {
                rays = p.rays;
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(rays, u64::from(maps) * 1024, "case {n}");
        assert_eq!(fs::read(folder.file()).unwrap(), whole, "case {n}");
        assert!(!path.exists());
    }
}

#[test]
fn the_part_of_another_field_is_not_gone_on_with() {
    let folder = Folder::new("other");
    stopped(&folder, &baker(290, Storage::Byte, false));
    let other = baker(290, Storage::Bit, false);
    other.bake_to_file(folder.file(), go_on).unwrap();
    assert_eq!(Field::load(folder.file()).unwrap(), other.bake(go_on).unwrap());
}

#[test]
fn two_bakes_do_not_write_one_file() {
    let folder = Folder::new("busy");
    let part = fs::File::create(part_path(&folder.file())).unwrap();
    part.lock().unwrap();
    let baker = baker(82, Storage::Bit, false);
    assert!(matches!(baker.bake_to_file(folder.file(), go_on), Err(FieldError::Busy { .. })));
    drop(part);
    baker.bake_to_file(folder.file(), go_on).unwrap();
}

#[test]
fn a_cache_bakes_once_and_replaces_what_is_damaged() {
    let folder = Folder::new("cache");
    let cache = Cache::new(folder.0.join("fields"));
    let shape = shapes::torus(1.0, 0.4, 8);
    let settings = *baker(82, Storage::Byte, false).settings();
    let get = |shape: &shapes::Shape, settings| cache.field(shape.mesh(), settings, go_on).unwrap();
    let first = get(&shape, settings);
    let second = get(&shape, settings);
    assert!(!first.was_kept && second.was_kept && first.field == second.field);
    let finer = shapes::torus(1.0, 0.4, 9);
    assert!(!get(&finer, settings).was_kept && get(&shape, settings).was_kept);
    for other in [
        Settings { storage: Storage::Bit, ..settings },
        Settings { normals: true, ..settings },
        Settings { mapping: Mapping::Uniform, ..settings },
        Settings { points: 290, ..settings },
        Settings { directions: 64, ..settings },
    ] {
        assert!(!get(&shape, other).was_kept && get(&shape, other).was_kept);
    }
    let path = cache.path(&shape.mesh(), &settings);
    let mut bytes = fs::read(&path).unwrap();
    bytes[5000] ^= 4;
    fs::write(&path, &bytes).unwrap();
    let mended = get(&shape, settings);
    assert!(!mended.was_kept && mended.field == first.field);
    // A whole field of another mesh under this name.
    fs::copy(cache.path(&finer.mesh(), &settings), &path).unwrap();
    assert_eq!(get(&shape, settings).field, first.field);
}
