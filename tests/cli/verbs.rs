//! Help, and the verbs that render nothing.

use crate::folder::{Folder, said, text};
use crate::tools::{done, fails, rendered};

#[test]
fn help_and_version_name_everything() {
    let folder = Folder::new();
    for (args, has) in [
        (
            "--help",
            "render presets devices completions bench conemap 130",
        ),
        ("--version", "conemarch"),
        (
            "render --help",
            "--output --size --set --device --layer --depth --quality --stats --explain NAME.depth.png 1e10 nearest",
        ),
    ] {
        let help = text(&done(&folder, args));
        for word in has.split(' ') {
            assert!(help.contains(word), "{word}: {help}");
        }
    }
    fails(
        &folder,
        &[
            ("", 2, "a command is missing"),
            ("rendr", 2, "rendr|similar|'render'"),
            ("render", 2, "<PRESET>"),
            ("render mandelbox --nope", 2, "--nope"),
        ],
    );
}

#[test]
fn presets_are_listed_by_line_and_printed_by_name() {
    let folder = Folder::new();
    let list = text(&done(&folder, "presets"));
    let names: Vec<&str> = list.lines().filter_map(|l| l.split("  ").next()).collect();
    assert!(names.is_sorted(), "{list}");
    assert!(
        names.contains(&"mandelbox") && names.contains(&"bench-far"),
        "{list}"
    );
    let neat = |l: &str| l.contains("  ") && l == l.trim_end();
    assert!(list.lines().all(neat), "{list}");
    for name in names {
        folder.write("copy.toml", text(&folder.done(&["presets", name])));
        let one = text(&folder.done(&["render", name, "--explain"]));
        assert_eq!(one, text(&done(&folder, "render copy.toml --explain")));
    }
    fails(
        &folder,
        &[("presets mandlebox", 2, "mandlebox|`mandelbox`")],
    );
}

#[test]
fn the_preset_of_a_picture_is_printed() {
    let folder = Folder::new();
    rendered(&folder, "mandelbox", "--set camera.fov=31 -o a.png");
    let preset = text(&done(&folder, "presets a.png"));
    assert!(
        preset.contains("fov = 31.0") && preset.contains("size = [24, 16]"),
        "{preset}"
    );
    folder.write("a.toml", &preset);
    assert_eq!(text(&done(&folder, "presets a.toml")), preset);
    rendered(&folder, "a.toml", "-o b.png");
    assert_eq!(folder.bytes("a.png"), folder.bytes("b.png"));
}

#[test]
fn devices_always_has_the_cpu() {
    let list = text(&done(&Folder::new(), "devices"));
    assert!(list.starts_with("index  name"), "{list}");
    assert!(list.lines().any(|l| l.starts_with("cpu ")), "{list}");
}

#[test]
fn completions_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&folder.done(&["completions", shell]));
        assert!(script.contains("conemarch"), "{shell}");
    }
    fails(&folder, &[("completions tcsh", 2, "tcsh|bash")]);
}

/// What a completion script asks the program, and what comes back.
#[test]
fn presets_files_and_keys_are_completed() {
    let folder = Folder::new();
    folder.write("mandelhome.toml", "");
    let asked = |line: &[&str]| {
        let mut command = folder.command(&["--", "conemarch"]);
        let output = command
            .args(line)
            .env("CONEMARCH_COMPLETE", "fish")
            .output();
        let output = output.expect("the program starts");
        assert!(output.status.success(), "{}", said(&output));
        let lines = text(&output);
        let first = |l: &str| l.split('\t').next().unwrap_or_default().to_string();
        lines.lines().map(first).collect::<Vec<String>>()
    };
    let found = asked(&["render", "mandel"]);
    for name in ["mandelbox", "mandelbox-hall", "mandelhome.toml"] {
        assert!(found.iter().any(|f| f == name), "{name}: {found:?}");
    }
    assert!(!found.iter().any(|f| f == "terrain"));
    let found = asked(&["render", "mandelbox", "--set", "camera."]);
    assert_eq!(
        found,
        ["camera.eye=", "camera.target=", "camera.up=", "camera.fov="]
    );
    let found = asked(&["render", "mandelbox", "--set", "scene."]);
    for key in ["scene.kind=", "scene.scale=", "scene.tracer="] {
        assert!(found.iter().any(|f| f == key), "{key}: {found:?}");
    }
    assert!(
        asked(&["bench", "steps", "bench-"])
            .iter()
            .any(|f| f == "bench-far")
    );
    assert!(
        asked(&["presets", "bench-"])
            .iter()
            .any(|f| f == "bench-far")
    );
}
