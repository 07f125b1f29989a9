//! What `lumivox demo` and `lumivox info` write.

use libtest_mimic::Failed;

use crate::support::{Folder, read_json};

pub(crate) fn demo() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line("demo --frames 2 --size 64x36 --grid 16 --out out/demo");
    assert!(run.succeeded().stderr.contains("out/demo"));
    let expected = [
        "progressive/frame_0000.png",
        "progressive/frame_0001.png",
        "sheet.png",
        "single-frame/frame_0000.png",
        "single-frame/frame_0001.png",
        "timings.json",
        "walk.gif",
    ];
    assert_eq!(folder.files(), expected.map(|f| format!("out/demo/{f}")));
    let out = folder.join("out/demo");
    for frame in expected.iter().filter(|f| f.contains("frame_")) {
        assert_eq!(image::open(out.join(frame))?.into_rgb8().dimensions(), (64, 36), "{frame}");
    }
    let sheet = image::open(out.join("sheet.png"))?.into_rgb8();
    assert!(sheet.width() > 3 * 64 && sheet.height() > 2 * 36);
    let gif = image::codecs::gif::GifDecoder::new(std::io::BufReader::new(std::fs::File::open(
        out.join("walk.gif"),
    )?))?;
    let frames = image::AnimationDecoder::into_frames(gif).collect_frames()?;
    assert_eq!(frames.len(), 2);
    assert!(frames[0].buffer().width() > 2 * 64);
    let timings = read_json(&out.join("timings.json"))?;
    assert_eq!(timings["frames"], 2);
    let walks = timings["walks"].as_array().cloned().unwrap_or_default();
    assert_eq!(walks.len(), 2);
    for walk in walks {
        let cells = walk["occupied_cells"].as_array().cloned().unwrap_or_default();
        assert!(cells.len() == 2 && cells.iter().all(|c| c.as_u64() > Some(0)), "{walk}");
        assert!(walk["stages_last_frame"].as_array().is_some_and(|s| !s.is_empty()));
    }
    Ok(())
}

pub(crate) fn info() -> Result<(), Failed> {
    let folder = Folder::new();
    let run = folder.line("info --stats i.json");
    let run = run.succeeded();
    for word in ["adapters:", "device:", "limits:", "what fits:", "volume with light"] {
        assert!(run.stdout.contains(word), "{}", run.stdout);
    }
    let info = read_json(&folder.join("i.json"))?;
    assert!(info["adapters"].as_array().is_some_and(|a| !a.is_empty()));
    assert!(info["largest_lit_volume_side"].as_u64() >= Some(100));
    let core = folder.line("info --tier core --stats c.json");
    core.succeeded();
    let core = read_json(&folder.join("c.json"))?;
    assert_eq!(core["adapter"]["tier"], "Core");
    assert_eq!(core["max_storage_buffer_binding_bytes"], 128 << 20);
    // Part of the adapter's name is enough, in any case.
    let name = info["adapter"]["name"].as_str().unwrap_or_default().to_uppercase();
    folder.run(["info", "--adapter", &name[..name.len().min(5)]]).succeeded();
    Ok(())
}
