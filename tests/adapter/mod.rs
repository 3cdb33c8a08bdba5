//! The adapter that tests render on: whatever `auto` takes, software Vulkan included.
//!
//! A test that needs an adapter and finds none fails with one sentence; it is never
//! skipped.
#![allow(
    dead_code,
    reason = "each test file takes what it needs of this, and none takes all"
)]

use conemarch::scene::Assets;
use std::sync::mpsc::{Sender, channel};
use std::sync::{LazyLock, Mutex};

use conemarch::gpu::device::{Adapters, Choice, Device, STORAGE_BUFFERS};
use conemarch::gpu::render::{Cutting, Renderer};
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};

/// What to do where there is no adapter.
const NO_ADAPTER: &str = "this test needs a GPU adapter and finds none that opens; any will do, and `apt-get install mesa-vulkan-drivers` installs a software one";

/// A fresh renderer, or the sentence.
fn try_open() -> Result<Renderer, String> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto).map_err(|e| e.to_string())?;
    let (adapter, _) = chosen.ok_or("there is no adapter")?;
    let device = Device::open(adapter, STORAGE_BUFFERS).map_err(|e| e.to_string())?;
    Ok(Renderer::new(device))
}

/// A fresh renderer on the adapter that `auto` takes.
pub fn open() -> Renderer {
    try_open().unwrap_or_else(|why| panic!("{NO_ADAPTER} ({why})"))
}

type Task = Box<dyn FnOnce(&mut Renderer) + Send>;

/// A thread that keeps one renderer for a whole test file, so that kernels are compiled
/// once: a renderer stays on its thread, and every test runs on one of its own.
static THREAD: LazyLock<Result<Mutex<Sender<Task>>, String>> = LazyLock::new(|| {
    let (send, tasks) = channel::<Task>();
    let (tell, opened) = channel();
    std::thread::spawn(move || match try_open() {
        Ok(mut renderer) => {
            tell.send(Ok(())).expect("the opener waits");
            for task in tasks {
                task(&mut renderer);
            }
        }
        Err(why) => tell.send(Err(why)).expect("the opener waits"),
    });
    let opened = opened.recv().map_err(|e| e.to_string())?;
    opened.map(|()| Mutex::new(send))
});

/// Runs something on the file's renderer.
pub fn with<T: Send + 'static>(f: impl FnOnce(&mut Renderer) -> T + Send + 'static) -> T {
    let thread = THREAD.as_ref();
    let thread = thread.unwrap_or_else(|why| panic!("{NO_ADAPTER} ({why})"));
    let (tell, result) = channel();
    let task: Task = Box::new(move |renderer| {
        tell.send(f(renderer)).ok();
    });
    let sent = thread.lock().map(|to| to.send(task).is_ok());
    assert!(sent.is_ok_and(|s| s), "the renderer's thread has ended");
    result.recv().expect("the renderer's thread has panicked")
}

/// Renders a plan that must render.
pub fn render(plan: &Plan, extras: Extras) -> Frame {
    render_cut(plan, extras, Cutting::default())
}

/// Renders a plan that must render, the work cut in a way of its own.
pub fn render_cut(plan: &Plan, extras: Extras, cutting: Cutting) -> Frame {
    let plan = plan.clone();
    plan.check().expect("a plan that can be rendered");
    let frame = with(move |renderer| {
        renderer.cutting = cutting;
        renderer.render(&plan, &Assets::default(), extras, &mut |_| true)
    });
    frame.unwrap_or_else(|e| panic!("the render fails: {e}"))
}
