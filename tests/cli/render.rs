//! The verb `render`: names of files, summaries, figures and explanations.

use serde_json::json;

use crate::folder::{Folder, holds, output, said, text};
use crate::images::{grey, pixels};
use crate::tools::{json, names, number, rendered, tiny};

#[test]
fn a_render_is_named_after_its_preset_and_renders_again() {
    let folder = Folder::new();
    let said = rendered(&folder, "mandelbox", "--set camera.fov=30 -o mandelbox.png");
    assert!(said.contains("rendering on the CPU"), "{said}");
    let summary = said.lines().last().unwrap_or_default();
    let start = "mandelbox.png  24 x 16  march and trace ";
    assert!(summary.starts_with(start), "{said}");
    holds(summary, &[" ms, colour ", " %, unconverged "]);

    let (info, pixels) = pixels(folder.bytes("mandelbox.png"));
    assert_eq!((info.width, info.height), (24, 16));
    assert_eq!(info.color_type, png::ColorType::Rgb);
    assert_eq!(info.bit_depth, png::BitDepth::Eight);
    assert!(info.srgb.is_some());
    let even = pixels.chunks(3).all(|p| p == &pixels[..3]);
    assert!(!even, "the picture is of one colour");

    // The picture carries its plan: no option is needed to make it again.
    let again = "render mandelbox.png --device cpu -o";
    folder.done(&format!("{again} again.png"));
    assert_eq!(folder.bytes("mandelbox.png"), folder.bytes("again.png"));
    // So does an EXR.
    folder.done("render mandelbox.png --device cpu -o light.exr");
    folder.done("render light.exr --device cpu -o again.png");
    assert_eq!(folder.bytes("mandelbox.png"), folder.bytes("again.png"));
    folder.fails("render missing.exr", 1, "missing.exr: cannot be read");
    folder.write("torn.exr", &folder.bytes("light.exr")[..40]);
    folder.fails("presets torn.exr", 1, "torn.exr: ");
    // Overrides apply to it, so that equal bytes above mean something.
    folder.done(&format!("{again} other.png --set camera.fov=31"));
    assert_ne!(folder.bytes("mandelbox.png"), folder.bytes("other.png"));
}

/// Without -o no picture takes the place of one that shows something else.
#[test]
fn a_picture_without_a_name_replaces_only_its_own_like() {
    let folder = Folder::new();
    let scene = "[scene]\nkind = \"distance\"\nformula = \"mandelbox\"\n";
    folder.write("my.toml", format!("{scene}[image]\nsize = [24, 16]\n"));
    let render = |more: &str| folder.done(&format!("render my.toml --device cpu {more}"));
    render("");
    let whole = folder.bytes("my.png");
    render("--size 24x16");
    render("--layer depth");
    render("--size 8x4");
    render("--size 8x4 --layer state");
    let all = "my-8x4.png my-8x4.state.png my.depth.png my.png my.toml";
    assert_eq!(folder.files().join(" "), all);
    // A layer under the name of the picture, and another preset of the same name.
    folder.done("render my.toml --device cpu --size 9x4 --layer depth -o my-9x4.png");
    let says = "`my-9x4.png` exists and shows another layer|-o";
    folder.fails("render my.toml --device cpu --size 9x4", 2, says);
    std::fs::create_dir(folder.0.join("b")).unwrap();
    folder.write(
        "b/my.toml",
        "[scene]\nkind = \"slab\"\n[image]\nsize = [24, 16]\n",
    );
    let old = std::fs::File::open(folder.0.join("b/my.toml")).unwrap();
    old.set_modified(std::time::SystemTime::UNIX_EPOCH).unwrap();
    let says = "`my.png` exists and has other settings|-o";
    folder.fails("render b/my.toml --device cpu", 2, says);
    assert_eq!(folder.bytes("my.png"), whole);
    assert_eq!(pixels(folder.bytes("my-8x4.png")).0.width, 8);
    let other = "render my.toml --device cpu --set camera.fov=33";
    // Settings are part of the name. The same picture is made again, and another file stays.
    folder.done(other);
    folder.done(other);
    assert_eq!(folder.bytes("my.png"), whole);
    assert_ne!(folder.bytes("my-camera.fov=33.png"), whole);
    folder.done(&format!("{other} -o my-camera.eye=_1_2_3_-6x4.png"));
    let another = "render my.toml --device cpu --set camera.eye=[1,2,3] --size 6x4";
    folder.fails(
        another,
        2,
        "`my-camera.eye=_1_2_3_-6x4.png` exists and has other settings|-o",
    );
    // -o may replace anything.
    folder.done(&format!("{other} -o my.png"));
    assert_ne!(folder.bytes("my.png"), whole);
}

/// Nor does it take the place of what this program did not make.
#[test]
fn a_picture_without_a_name_replaces_no_other_file() {
    let folder = Folder::new();
    let preset = |fov: u32| {
        format!("[scene]\nkind = \"slab\"\n[camera]\nfov = {fov}\n[image]\nsize = [8, 4]\n")
    };
    folder.write("my.toml", preset(40));
    let mine = "render my.toml --device cpu";
    let theirs = grey([1, 1], &[7]);
    for content in [&b"a picture"[..], &theirs, preset(40).as_bytes(), b""] {
        folder.write("my.png", content);
        let says = "`my.png` exists and is no picture of this program|-o";
        folder.fails(mine, 2, says);
        assert_eq!(folder.bytes("my.png"), content);
    }
    folder.done(&format!("{mine} -o my.png"));
    let old = folder.bytes("my.png");
    folder.done(mine);
    assert_eq!(folder.bytes("my.png"), old);
    // Who edits a preset renders it again and again.
    folder.write("my.toml", preset(41));
    let told = said(&folder.done(mine));
    holds(
        &told,
        &["`my.png` has other settings and is replaced, as `my.toml` is newer"],
    );
    let new = folder.bytes("my.png");
    assert_ne!(new, old);
    folder.fails(
        &format!("{mine} --depth 16"),
        2,
        "`my.png` exists and has another --depth|-o",
    );
    // Nobody edits a picture.
    std::fs::create_dir(folder.0.join("b")).unwrap();
    folder.write("b/my.png", old);
    let says = "`my.png` exists and has other settings|-o";
    folder.fails("render b/my.png --device cpu", 2, says);
    assert_eq!(folder.bytes("my.png"), new);
    // A built-in preset stays as it is, so a picture with other settings is another one.
    let built_in = "render mandelbox --device cpu --size 8x4";
    folder.done(built_in);
    folder.done(built_in);
    let file = "mandelbox-8x4.png";
    folder.done(&format!("{built_in} --set camera.fov=33 -o {file}"));
    let other = folder.bytes(file);
    folder.fails(
        built_in,
        2,
        "`mandelbox-8x4.png` exists and has other settings|-o",
    );
    assert_eq!(folder.bytes(file), other);
}

#[test]
fn an_existing_picture_is_replaced_only_by_a_whole_one() {
    let folder = Folder::new();
    folder.write("a.png", "precious");
    let wrong = "render mandelbox --size 8x8 -o a.png --device";
    folder.fails(&format!("{wrong} 99"), 1, "99");
    folder.fails(wrong, 2, "--device");
    assert_eq!(folder.bytes("a.png"), b"precious");
    rendered(&folder, "mandelbox", "-o a.png");
    assert_eq!(pixels(folder.bytes("a.png")).0.width, 24);
    assert_eq!(folder.files(), ["a.png"]);
}

/// Names of files are bytes, not text.
#[cfg(target_os = "linux")]
#[test]
fn names_need_not_be_utf_8() {
    use std::os::unix::ffi::OsStrExt;
    let folder = Folder::new();
    let named = |bytes: &'static [u8]| std::ffi::OsStr::from_bytes(bytes);
    let preset = text(&folder.done("presets mandelbox"));
    std::fs::write(folder.0.join(named(b"b\xffx.toml")), preset).unwrap();
    let run = |args: &str, last: &'static [u8]| output(folder.command(args).arg(named(last)));
    let steps = "bench steps --device cpu --mode ray --size 8x8";
    let named_picture = "render mandelbox --device cpu --size 24x16 -o";
    for output in [
        run("render --device cpu --size 24x16", b"b\xffx.toml"),
        run(steps, b"b\xffx.toml"),
        run(named_picture, b"c\xff.png"),
        run("presets", b"c\xff.png"),
    ] {
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    }
    assert_eq!(folder.files().len(), 3);
    assert!(folder.0.join(named(b"b\xffx-24x16.png")).exists());
    // Elsewhere text is needed, and the error says where.
    let output = run("render mandelbox --set", b"title=\xff");
    assert_eq!(output.status.code(), Some(2));
    let told = said(&output);
    let start = "error: the argument `title=\u{fffd}` is not UTF-8";
    assert!(told.starts_with(start), "{told}");
}

#[test]
fn a_picture_with_few_rays_has_no_cone_map() {
    let folder = Folder::new();
    // 512 x 512 cones pay from three rays for each of them on.
    for (more, has_map) in [
        ("--size 512x512 --samples 2", false),
        ("--size 512x512 --samples 3", true),
        ("--size 512x512 --samples 3 --layer depth", true),
        ("--size 1024x768 --samples 1 --set camera.stereo=pair", true),
        ("--size 2048x512 --samples 1", true),
        ("--size 128x128 --tile 1,0/2x2 -o a.exr", false),
        ("--size 1024x1024 --samples 1 --tile 1,0/2x2 -o a.exr", true),
        ("--size 64x64 --set scene.field=fbm:32x32", true),
        ("--size 64x64 --set scene.tracer=walk", true),
        ("--size 64x64 --set scene.map=walk", true),
        ("--size 64x64 --set scene.paint=walk", true),
    ] {
        let explained = text(&folder.done(&format!("render terrain {more} --explain")));
        let by = if has_map { "walk" } else { "max-mip" };
        holds(&explained, &[&format!("traced by {by}")]);
        assert_eq!(
            explained.contains("  prepare "),
            has_map,
            "{more}: {explained}"
        );
    }
}

#[test]
fn the_command_that_is_given_is_explained() {
    let folder = Folder::new();
    let explained = text(&folder.done("render mandelbox --explain --size 64x64"));
    assert!(explained.starts_with("64 x 64, mode safe"), "{explained}");
    holds(&explained, &["wgsl/formula/folds.wgsl"]);
    let has = |more: &str, part: &str| {
        let explain = format!("{} --explain", tiny("mandelbox", more));
        text(&folder.done(&explain)).contains(part)
    };
    // Nothing is counted, coloured or kept that nobody asked for.
    let counters = "wgsl/base/counters.wgsl";
    let (color, keeps) = ("wgsl/pass/color.wgsl", "COLOR_KEEPS_NORMALS=1");
    for (more, part, wanted) in [
        ("", counters, false),
        ("--layer normal", counters, false),
        ("--stats s.json", counters, true),
        ("--layer steps", counters, true),
        ("", color, true),
        ("--layer depth", color, false),
        ("", keeps, false),
        ("--layer normal", keeps, true),
        ("-o a.exr", keeps, true),
    ] {
        assert_eq!(has(more, part), wanted, "{more} {part}");
    }
    assert!(folder.files().is_empty());
}

#[test]
fn stats_have_the_promised_fields() {
    let folder = Folder::new();
    rendered(
        &folder,
        "mandelbox",
        "--set march.coarsest=16 --stats s.json",
    );
    let piped = folder.done(&tiny(
        "mandelbox",
        "--set march.coarsest=16 --stats - -o b.png",
    ));
    for bytes in [folder.bytes("s.json"), piped.stdout] {
        let stats = json(&bytes);
        let mut fields = names(&stats);
        fields.sort_unstable();
        let promised = "backend device evaluations_per_pixel hit iterations_per_pixel mode passes preset size sky unconverged undecided wall_ms";
        assert_eq!(fields.join(" "), promised);
        let known = [&stats["preset"], &stats["backend"], &stats["mode"]];
        assert_eq!(known, ["mandelbox", "cpu", "safe"]);
        assert_eq!(stats["size"], json!([24, 16]));
        let share = |name: &str| number(&stats, name);
        let all = share("hit") + share("sky") + share("unconverged");
        assert!((all - 1.0).abs() < 1e-12 && share("hit") > 0.0 && share("hit") < 1.0);
        let passes = stats["passes"].as_array().expect("a list");
        let found: Vec<&str> = passes.iter().filter_map(|p| p["name"].as_str()).collect();
        let promised = "march 1/16, march 1/8, march 1/4, march 1/2, trace, color";
        assert_eq!(found.join(", "), promised);
        for pass in passes {
            assert_eq!(names(pass).len(), 6, "{pass}");
            assert!(pass["wall_ms"].is_number(), "{pass}");
            let uncounted = pass["evaluations"].is_null();
            assert_eq!(uncounted, pass["name"] == "color", "{pass}");
            assert!(pass["gpu_ms"].is_null(), "the CPU has no device time");
        }
        let counts = passes.iter().filter_map(|p| p["evaluations"].as_f64());
        let sum: f64 = counts.sum();
        assert!((sum / (24.0 * 16.0) - share("evaluations_per_pixel")).abs() < 1e-9);
    }
}

#[test]
fn the_cone_maps_of_a_heightfield_are_a_pass_of_their_own() {
    let folder = Folder::new();
    let small = "--set scene.field=fbm:33x25 --set march.coarsest=16 --stats - -o a.png";
    // March and trace add up to the whole, which holds no map.
    let adds_up = |stats: &serde_json::Value| {
        let passes = stats["passes"].as_array().expect("a list").iter();
        let marched = passes.filter(|p| {
            let name = p["name"].as_str().unwrap_or_default();
            name.starts_with("march") || name.starts_with("trace")
        });
        let sum: f64 = marched.filter_map(|p| p["wall_ms"].as_f64()).sum();
        let wall = number(stats, "wall_ms");
        assert!((sum - wall).abs() < 1e-6 * wall.max(1.0), "{sum} {wall}");
    };
    let output = folder.done(&tiny("terrain", small));
    holds(&said(&output), &["cone map ", " ms, march"]);
    let stats = json(&output.stdout);
    let first = &stats["passes"][0];
    assert_eq!(first["name"], "prepare");
    assert_eq!(first["cells"], 32 * 24);
    assert!(first["evaluations"].is_null());
    assert!(number(&stats, "evaluations_per_pixel") > 0.0);
    assert_eq!(stats["passes"].as_array().map(Vec::len), Some(1 + 5 + 1));
    adds_up(&stats);
    // A picture may need a map more than its depths do: each pass keeps its own time.
    let paint = format!("{small} --set scene.paint=exact --set scene.tracer=max-mip");
    let stats = json(&folder.done(&tiny("terrain", &paint)).stdout);
    let passes = stats["passes"].as_array().expect("a list");
    assert_eq!(passes.iter().filter(|p| p["name"] == "prepare").count(), 1);
    adds_up(&stats);
}

#[test]
fn shares_are_of_what_is_in_the_picture() {
    let folder = Folder::new();
    rendered(&folder, "mandelbox", "--set march.steps=2 --stats s.json");
    let stats = json(&folder.bytes("s.json"));
    let share = |name: &str| number(&stats, name);
    assert!(share("unconverged") > 0.0, "{stats}");
    let all = share("hit") + share("sky") + share("unconverged");
    assert!((all - 1.0).abs() < 1e-12, "{stats}");
}

#[test]
fn an_eye_inside_the_solid_is_told() {
    let folder = Folder::new();
    let told = |preset: &str, more: &str| {
        let said = rendered(&folder, preset, &format!("{more} -o a.png"));
        said.contains("camera.eye lies inside the solid")
    };
    for preset in ["mandelbox", "terrain"] {
        assert!(told(preset, "--set camera.eye=[0.1,0.2,0.1]"), "{preset}");
        assert!(!told(preset, ""), "{preset}");
    }
}
