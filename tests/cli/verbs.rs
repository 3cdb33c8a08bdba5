//! Help, and the verbs that render nothing.

use crate::folder::{Folder, holds, output, said, text};
use crate::tools::rendered;

#[test]
fn help_and_version_name_everything() {
    let folder = Folder::new();
    let verbs = "render merge animate presets devices completions bench conemap 130";
    let options = "--output --size --set --device --layer --depth --quality --stats --until --at --resume --tile FILE.part --explain NAME.depth.png 1e10 nearest";
    for (line, has) in [
        ("--help", verbs),
        ("--version", "conemarch"),
        ("render --help", options),
    ] {
        let help = text(&folder.done(line));
        holds(&help, &has.split(' ').collect::<Vec<_>>());
    }
    folder.fails("", 2, "a command is missing");
    folder.fails("rendr", 2, "rendr|similar|'render'");
    folder.fails("render", 2, "<PRESET>");
    folder.fails("render mandelbox --nope", 2, "--nope");
}

#[test]
fn presets_are_listed_by_line_and_printed_by_name() {
    let folder = Folder::new();
    let list = text(&folder.done("presets"));
    let names: Vec<&str> = list.lines().filter_map(|l| l.split("  ").next()).collect();
    assert!(names.is_sorted(), "{list}");
    let both = names.contains(&"mandelbox") && names.contains(&"bench-far");
    assert!(both, "{list}");
    let neat = |l: &str| l.contains("  ") && l == l.trim_end();
    assert!(list.lines().all(neat), "{list}");
    for name in names {
        folder.write("copy.toml", text(&folder.done(&format!("presets {name}"))));
        let one = text(&folder.done(&format!("render {name} --explain")));
        assert_eq!(one, text(&folder.done("render copy.toml --explain")));
    }
    folder.fails("presets mandlebox", 2, "mandlebox|`mandelbox`");
}

#[test]
fn the_preset_of_a_picture_is_printed() {
    let folder = Folder::new();
    rendered(&folder, "mandelbox", "--set camera.fov=31 -o a.png");
    let preset = text(&folder.done("presets a.png"));
    holds(&preset, &["fov = 31.0", "size = [24, 16]"]);
    folder.write("a.toml", &preset);
    assert_eq!(text(&folder.done("presets a.toml")), preset);
    rendered(&folder, "a.toml", "-o b.png");
    assert_eq!(folder.bytes("a.png"), folder.bytes("b.png"));
}

#[test]
fn devices_always_has_the_cpu() {
    let list = text(&Folder::new().done("devices"));
    assert!(list.starts_with("index  name"), "{list}");
    assert!(list.lines().any(|l| l.starts_with("cpu ")), "{list}");
}

#[test]
fn completions_for_every_shell() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = text(&folder.done(&format!("completions {shell}")));
        assert!(script.contains("conemarch"), "{shell}");
    }
    folder.fails("completions tcsh", 2, "tcsh|bash");
}

/// Bash breaks words at signs.
#[cfg(target_os = "linux")]
#[test]
fn bash_completes_the_words_of_keys() {
    let folder = Folder::new();
    let program = folder.command("").get_program().to_owned();
    let program = std::path::Path::new(&program);
    let path = program.parent().expect("a folder").display().to_string();
    for (words, current, wanted) in [
        ("march.mode = sl", "sl", "slides-even"),
        ("march.mode =", "=", "safe"),
        ("scene.kind = heig", "heig", "heightfield"),
        ("scene.formula = mandel", "mandel", "mandelbox"),
        ("camera.fo", "camera.fo", "camera.fov="),
    ] {
        let line = format!(
            r#"PATH={path}:$PATH; source <(conemarch completions bash)
            COMP_WORDS=(conemarch render mandelbox --set {words} after); COMP_TYPE=9
            COMP_CWORD=$((${{#COMP_WORDS[@]}} - 2))
            _conemarch conemarch '{current}' =; printf '%s\n' "${{COMPREPLY[@]}}""#
        );
        let output = std::process::Command::new("bash")
            .args(["-c", &line])
            .output();
        let output = output.expect("bash runs");
        let found = text(&output);
        assert!(
            found.lines().any(|l| l.trim() == wanted),
            "{words}: {found:?} {}",
            said(&output)
        );
    }
}

/// What a completion script asks the program, and what comes back.
#[test]
fn presets_files_and_keys_are_completed() {
    let folder = Folder::new();
    folder.write("mandelhome.toml", "");
    let asked = |line: &str| {
        let mut command = folder.command(&format!("-- conemarch {line}"));
        let output = output(command.env("CONEMARCH_COMPLETE", "fish"));
        assert!(output.status.success(), "{}", said(&output));
        let lines = text(&output);
        let first = |l: &str| l.split('\t').next().unwrap_or_default().to_string();
        lines.lines().map(first).collect::<Vec<String>>()
    };
    let found = asked("render mandel");
    for name in ["mandelbox", "mandelbox-hall", "mandelhome.toml"] {
        assert!(found.iter().any(|f| f == name), "{name}: {found:?}");
    }
    assert!(!found.iter().any(|f| f == "terrain"));
    let found = asked("render mandelbox --set camera.");
    let keys = [
        "camera.eye=",
        "camera.target=",
        "camera.up=",
        "camera.fov=",
        "camera.projection=",
        "camera.aperture=",
        "camera.focus=",
        "camera.blades=",
        "camera.shift=",
        "camera.rise=",
        "camera.stereo=",
        "camera.eyes=",
    ];
    assert_eq!(found, keys);
    let found = asked("render mandelbox --set scene.");
    for key in ["scene.kind=", "scene.scale=", "scene.tracer="] {
        assert!(found.iter().any(|f| f == key), "{key}: {found:?}");
    }
    let found = asked("render mandelbox --set look.mode=");
    assert_eq!(found, ["look.mode=quick", "look.mode=path"]);
    let found = asked("render mandelbox --set look.shadow=f");
    assert_eq!(found, ["look.shadow=false"]);
    for line in ["bench steps bench-", "presets bench-"] {
        assert!(asked(line).iter().any(|f| f == "bench-far"), "{line}");
    }
}
