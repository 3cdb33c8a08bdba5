//! The `conemarch` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    keep_drivers_quiet();
    conemarch::command::line::run()
}

/// Switches a Vulkan layer of Mesa off if there is no desktop.
///
/// Without a desktop it would print `error: XDG_RUNTIME_DIR is invalid or not set in the
/// environment.` twice on every render, though nothing failed. Its purpose is to put the
/// desktop's adapter first.
#[allow(unsafe_code, reason = "no safe way to set a variable; see below")]
fn keep_drivers_quiet() {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    if set("XDG_RUNTIME_DIR") || set("DISPLAY") {
        return;
    }
    // SAFETY: this is the first statement of `main`. No other thread exists that could
    // read the environment meanwhile.
    unsafe { std::env::set_var("NODEVICE_SELECT", "1") };
}
