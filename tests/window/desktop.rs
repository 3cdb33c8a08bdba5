//! A desktop of its own: an X server without a screen, a window manager, and the preview in it.

use std::io::{BufRead, BufReader};
use std::os::unix::fs::MetadataExt as _;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use conemarch::plan::Plan;
use conemarch::preset;

/// What a test says where the desktop's programs are missing.
const MISSING: &str = "this test needs Xvfb, openbox, xdotool, xclip and xwd; on Debian: apt-get install xvfb openbox xdotool xclip x11-apps";

fn start(command: &mut Command) -> Child {
    let quiet = command.stdin(Stdio::null()).stderr(Stdio::null());
    quiet.spawn().unwrap_or_else(|e| panic!("{MISSING} ({e})"))
}

/// An X server with a window manager.
pub struct Desktop {
    display: String,
    server: Child,
    manager: Child,
}

impl Desktop {
    /// Starts both on a free display.
    pub fn new() -> Self {
        Self::of("1280x800")
    }

    /// The same with a screen of a size.
    pub fn of(size: &str) -> Self {
        let mut server = start(
            Command::new("Xvfb")
                .args([
                    "-displayfd",
                    "1",
                    "-noreset",
                    "-screen",
                    "0",
                    &format!("{size}x24"),
                    "-nolisten",
                    "tcp",
                ])
                .stdout(Stdio::piped()),
        );
        let mut line = String::new();
        let out = server.stdout.take().expect("its output");
        BufReader::new(out).read_line(&mut line).expect("a display");
        let display = format!(":{}", line.trim());
        let manager = start(
            Command::new("openbox")
                .args(["--sm-disable", "--config-file"])
                .arg(concat!(
                    env!("CARGO_MANIFEST_DIR"),
                    "/tests/window/openbox.xml"
                ))
                .env("DISPLAY", &display)
                .stdout(Stdio::null()),
        );
        let desktop = Self {
            display,
            server,
            manager,
        };
        let began = Instant::now();
        while desktop.tool("xdotool", "get_num_desktops").is_empty() {
            assert!(
                began.elapsed() < Duration::from_secs(20),
                "no window manager"
            );
            sleep(Duration::from_millis(50));
        }
        desktop
    }

    fn tool(&self, name: &str, line: &str) -> Vec<u8> {
        let mut command = Command::new(name);
        command.args(line.split(' ')).env("DISPLAY", &self.display);
        let output = command
            .output()
            .unwrap_or_else(|e| panic!("{MISSING} ({e})"));
        output.stdout
    }
}

impl Desktop {
    /// Waits for the window of the program.
    fn window(&self) -> String {
        let began = Instant::now();
        let found = |which: &str| {
            let found = self.tool("xdotool", &format!("search {which}--name conemarch$"));
            let found = String::from_utf8(found).expect("text");
            found.lines().last().map(str::to_string)
        };
        loop {
            if let Some(window) = found("--onlyvisible ") {
                return window;
            }
            assert!(began.elapsed() < Duration::from_secs(60), "no window opens");
            sleep(Duration::from_millis(300));
            // A manager that is still starting forgets windows.
            if began.elapsed() > Duration::from_secs(3)
                && let Some(window) = found("")
            {
                self.tool("xdotool", &format!("windowmap {window}"));
            }
        }
    }
}

impl Drop for Desktop {
    fn drop(&mut self) {
        for child in [&mut self.manager, &mut self.server] {
            // It may be gone already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Pixels of a window: width, height, and red, green and blue of each.
#[derive(Clone, PartialEq)]
pub struct Shot {
    pub size: [u32; 2],
    pub rgb: Vec<u8>,
}

/// The image in a dump of `xwd`: a header of big-endian words, and rows of blue, green, red and a
/// fourth byte.
fn decoded(dump: &[u8]) -> Option<Shot> {
    let word = |i: usize| {
        let bytes = dump.get(4 * i..4 * i + 4)?;
        Some(u32::from_be_bytes(bytes.try_into().ok()?) as usize)
    };
    let (head, width, height, row, colors) = (word(0)?, word(4)?, word(5)?, word(12)?, word(19)?);
    assert_eq!(word(11)?, 32, "bits of a pixel");
    // An entry of the map of colours has 12 bytes.
    let pixels = dump.get(head + 12 * colors..)?;
    let row = |y: usize| pixels.get(y * row..y * row + 4 * width);
    let mut rgb = Vec::new();
    for y in 0..height {
        rgb.extend(row(y)?.chunks_exact(4).flat_map(|p| [p[2], p[1], p[0]]));
    }
    Some(Shot {
        size: [width as u32, height as u32],
        rgb,
    })
}

/// The preview in a window of the desktop.
pub struct Preview<'a> {
    desktop: &'a Desktop,
    pub process: Child,
    window: String,
}

impl<'a> Preview<'a> {
    /// Opens it in a folder, with the words of a line.
    pub fn open(desktop: &'a Desktop, folder: &Path, line: &str) -> Self {
        Self::start(desktop, Self::command(desktop, folder, line))
    }

    /// The command that does.
    pub fn command(desktop: &Desktop, folder: &Path, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_conemarch"));
        command
            .arg("preview")
            .args(line.split_whitespace())
            .current_dir(folder)
            .env("DISPLAY", &desktop.display)
            .env_remove("WAYLAND_DISPLAY")
            .env("XDG_RUNTIME_DIR", folder)
            .env("XDG_CACHE_HOME", folder.join("cache"))
            .stdin(Stdio::null());
        command
    }

    /// Runs the command.
    pub fn start(desktop: &'a Desktop, mut command: Command) -> Self {
        let process = command.spawn().expect("the program");
        let window = desktop.window();
        let preview = Self {
            desktop,
            process,
            window,
        };
        preview.focus();
        preview.at_rest();
        preview
    }

    /// A verb of xdotool on the window.
    fn tool(&self, verb: &str) {
        let line = format!("{verb} {}", self.window);
        self.desktop.tool("xdotool", &line);
    }

    /// Gives the window the keyboard. The manager may not know it yet.
    fn focus(&self) {
        let began = Instant::now();
        let has_it = || {
            let found = self.desktop.tool("xdotool", "getwindowfocus");
            String::from_utf8_lossy(&found).trim() == self.window
        };
        while !has_it() {
            let patience = Duration::from_secs(60);
            assert!(began.elapsed() < patience, "the window gets no keys");
            self.tool("windowactivate");
            sleep(Duration::from_millis(100));
        }
    }

    /// Words of xdotool.
    pub fn xdotool(&self, line: &str) {
        self.desktop.tool("xdotool", line);
    }

    /// Presses a key.
    pub fn key(&self, key: &str) {
        self.xdotool(&format!("key {key}"));
    }

    /// Saves to a file, and reads it when it is written.
    pub fn save(&self, file: &Path) -> Plan {
        let written = || Some(std::fs::metadata(file).ok()?.ino());
        let before = written();
        self.key("ctrl+s");
        let began = Instant::now();
        while written().is_none_or(|now| Some(now) == before) {
            assert!(
                began.elapsed() < Duration::from_secs(20),
                "nothing is saved"
            );
            sleep(Duration::from_millis(50));
        }
        preset::load(file, &[]).expect("a preset").plan
    }

    /// The text in the clipboard.
    pub fn copied(&self) -> String {
        let text = self.desktop.tool("xclip", "-selection clipboard -out");
        String::from_utf8(text).expect("text")
    }

    /// Holds a key for some milliseconds.
    pub fn hold(&self, key: &str, ms: u64) {
        self.xdotool(&format!("keydown {key}"));
        sleep(Duration::from_millis(ms));
        self.xdotool(&format!("keyup {key}"));
    }

    /// Clicks on a pixel of the window.
    pub fn click(&self, x: u32, y: u32) {
        self.point(x, y);
        sleep(Duration::from_millis(300));
        self.xdotool("click 1");
    }

    /// Types a number into the field of the panel at a pixel.
    pub fn type_into(&self, [x, y]: [u32; 2], number: &str) {
        self.click(x, y);
        sleep(Duration::from_millis(500));
        self.key("ctrl+a");
        self.xdotool(&format!("type --delay 200 {number}"));
        self.key("Return");
        sleep(Duration::from_millis(300));
    }

    /// Moves the pointer to a pixel of the window.
    pub fn point(&self, x: u32, y: u32) {
        self.xdotool(&format!("mousemove --window {} {x} {y}", self.window));
    }

    /// Drags with a button from one pixel to another, slowly enough for a busy machine to follow.
    pub fn drag(&self, button: u32, from: [u32; 2], to: [u32; 2]) {
        self.point(from[0], from[1]);
        self.xdotool(&format!("mousedown {button}"));
        sleep(Duration::from_millis(200));
        for i in 1..=4 {
            let at = [0, 1].map(|k| (from[k] * (4 - i) + to[k] * i) / 4);
            self.point(at[0], at[1]);
            sleep(Duration::from_millis(200));
        }
        self.xdotool(&format!("mouseup {button}"));
    }

    /// The same without a pause.
    pub fn drag_at_once(&self, button: u32, from: [u32; 2], to: [u32; 2]) {
        let at = |[x, y]: [u32; 2]| format!("mousemove --window {} {x} {y}", self.window);
        let (from, to) = (at(from), at(to));
        self.xdotool(&format!("{from} mousedown {button} {to} mouseup {button}"));
    }

    /// Changes the size of the window.
    pub fn resize(&self, width: u32, height: u32) {
        let line = format!("windowsize {} {width} {height}", self.window);
        self.xdotool(&line);
    }

    /// Hides the window, or shows it again.
    pub fn hide(&self, hidden: bool) {
        match hidden {
            true => self.tool("windowminimize"),
            false => self.focus(),
        }
    }

    /// What the window shows now.
    pub fn shot(&self) -> Option<Shot> {
        decoded(
            &self
                .desktop
                .tool("xwd", &format!("-silent -id {}", self.window)),
        )
    }

    /// Waits until the window shows something that fits.
    pub fn wait_for(&self, what: &str, fits: impl Fn(&Shot) -> bool) -> Shot {
        let began = Instant::now();
        loop {
            if let Some(shot) = self.shot().filter(&fits) {
                return shot;
            }
            let patience = Duration::from_secs(60);
            assert!(began.elapsed() < patience, "the window never shows {what}");
            sleep(Duration::from_millis(100));
        }
    }

    /// Waits until the picture stays the same for a while.
    pub fn at_rest(&self) -> Shot {
        let mut last = self.shot();
        let mut since = Instant::now();
        let began = Instant::now();
        while since.elapsed() < Duration::from_millis(1500) {
            sleep(Duration::from_millis(150));
            let now = self.shot();
            if now != last {
                (last, since) = (now, Instant::now());
            }
            assert!(began.elapsed() < Duration::from_secs(60), "it never rests");
        }
        last.expect("a picture")
    }

    /// Seconds of processor time so far.
    pub fn processor_time(&self) -> f64 {
        let path = format!("/proc/{}/stat", self.process.id());
        let text = std::fs::read_to_string(path).expect("a running process");
        let (_, rest) = text.rsplit_once(')').expect("its name");
        let fields: Vec<f64> = rest
            .split_whitespace()
            .filter_map(|f| f.parse().ok())
            .collect();
        // The state is no number. User and system time count hundredths.
        (fields[10] + fields[11]) / 100.0
    }

    /// Its memory in MiB.
    pub fn memory(&self) -> f64 {
        let path = format!("/proc/{}/status", self.process.id());
        let text = std::fs::read_to_string(path).expect("a running process");
        let line = text.lines().find_map(|line| line.strip_prefix("VmRSS:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        kib.expect("a figure") / 1024.0
    }

    /// Whether the program runs.
    pub fn is_open(&mut self) -> bool {
        self.process.try_wait().expect("a process").is_none()
    }

    /// Closes the window. The program must end well.
    pub fn close(mut self) {
        self.key("ctrl+q");
        let began = Instant::now();
        loop {
            if let Some(status) = self.process.try_wait().expect("a process") {
                assert!(status.success(), "{status}");
                return;
            }
            assert!(began.elapsed() < Duration::from_secs(20), "it does not end");
            sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Preview<'_> {
    fn drop(&mut self) {
        // After a failed test.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
