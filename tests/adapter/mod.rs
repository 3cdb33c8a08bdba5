//! Renders plans, on the adapter that `auto` takes, software Vulkan included, and on the CPU.
//!
//! A test that needs an adapter and finds none fails with one sentence; it is never
//! skipped.
#![allow(
    dead_code,
    reason = "each test file takes what it needs of this, and none takes all"
)]

use std::sync::mpsc::{Sender, channel};
use std::sync::{LazyLock, Mutex};
use std::time::{Duration, Instant};

use conemarch::base::outcome::State;
use conemarch::gpu::adapters::{Adapters, Choice};
use conemarch::gpu::device::Device;
use conemarch::gpu::render::{Cutting, Renderer};
use conemarch::gpu::work::Work;
use conemarch::pass::progress::Progress;
use conemarch::picture::frame::Frame;
use conemarch::plan::{Extras, Plan};
use conemarch::scene::Assets;

/// The states of pixels and cells, as frames hold them.
pub const SKY: u8 = State::Sky as u8;
/// See [`SKY`].
pub const HIT: u8 = State::Hit as u8;
/// See [`SKY`].
pub const UNCONVERGED: u8 = State::Unconverged as u8;

/// Every layer that there is.
pub const EVERYTHING: Extras = Extras {
    count: true,
    normals: true,
    variance: true,
    levels: true,
    depth_only: false,
    time: false,
    shown: false,
    sketched: false,
    unread: false,
    reuse: false,
    rays: None,
    held: false,
};
/// Fronts and states of every level, and no colour.
pub const LEVELS: Extras = Extras {
    count: false,
    normals: false,
    depth_only: true,
    ..EVERYTHING
};
/// The same, with counts.
pub const COUNTED: Extras = Extras {
    count: true,
    ..LEVELS
};
/// Depths alone.
pub const DEPTHS: Extras = Extras {
    levels: false,
    ..LEVELS
};
/// The picture and its normals.
pub const NORMALS: Extras = Extras {
    count: false,
    levels: false,
    ..EVERYTHING
};

/// A render that takes longer than this hangs. The longest here takes some seconds on two
/// slow cores.
const PATIENCE: Duration = Duration::from_secs(120);

/// What to do where there is no adapter.
pub const NO_ADAPTER: &str = "this test needs a GPU adapter and finds none that opens; any will do, and `apt-get install mesa-vulkan-drivers` installs a software one";

/// A fresh renderer, or the sentence.
fn try_open() -> Result<Renderer, String> {
    let adapters = Adapters::find();
    let chosen = adapters.choose(&Choice::Auto).map_err(|e| e.to_string())?;
    let (adapter, _) = chosen.ok_or("there is no adapter")?;
    let device = Device::open(adapter).map_err(|e| e.to_string())?;
    Ok(Renderer::new(device))
}

/// A fresh renderer on the adapter that `auto` takes.
pub fn open() -> Renderer {
    try_open().unwrap_or_else(|why| panic!("{NO_ADAPTER} ({why})"))
}

type Task = Box<dyn FnOnce(&mut Renderer) + Send>;

/// A thread that keeps one renderer for a whole test crate, so that kernels are compiled
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

/// Runs something on the crate's renderer.
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

/// A watch that cancels what hangs.
fn patient() -> impl FnMut(&Progress) -> bool {
    let start = Instant::now();
    move |_| start.elapsed() < PATIENCE
}

/// Renders a plan that must render.
pub fn render(plan: &Plan, extras: Extras) -> Frame {
    render_cut(plan, extras, Cutting::default())
}

/// Renders a plan that must render, the work cut in a way of its own.
pub fn render_cut(plan: &Plan, extras: Extras, cutting: Cutting) -> Frame {
    let asked = plan.clone();
    plan.check().expect("a plan that can be rendered");
    let frame = with(move |renderer| {
        renderer.cutting = cutting;
        renderer.render(&asked, &Assets::default(), extras, &mut patient())
    });
    frame.unwrap_or_else(|e| panic!("the render fails: {e}, {plan:?}"))
}

/// Goes on with a work until it has ended.
pub fn finish(work: &mut Work) -> Frame {
    loop {
        work.advance(20.0).expect("the work goes on");
        if let Some(frame) = work.poll().expect("the work ends") {
            break frame;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Renders a plan that must render, on the CPU.
pub fn on_cpu(plan: &Plan, extras: Extras) -> Frame {
    let frame = conemarch::cpu::render(plan, &Assets::default(), extras, &mut patient());
    frame.unwrap_or_else(|e| panic!("the render fails on the CPU: {e}, {plan:?}"))
}

/// A plan on the GPU and on the CPU, with every layer.
pub fn both(plan: &Plan) -> [Frame; 2] {
    [render(plan, EVERYTHING), on_cpu(plan, EVERYTHING)]
}
