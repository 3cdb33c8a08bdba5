//! Replaces `background` where there are no threads. The task runs when its result is asked for.

use std::sync::{Mutex, PoisonError};

use crate::gpu::task_status::{Panicked, TaskStatus};
use crate::pass::progress::Progress;

/// Does work on all items, one after the other.
pub fn all_at_once<T, A>(items: &[T], work: impl Fn(&T) -> A) -> Vec<A> {
    items.iter().map(work).collect()
}

/// No threads.
#[derive(Default)]
pub struct Threads {}

/// A task that another thread may run, where there are any.
#[cfg(not(target_arch = "wasm32"))]
mod task {
    pub trait MaybeSend: Send {}
    impl<T: Send> MaybeSend for T {}
    pub type Deferred<T> = Box<dyn FnOnce(&super::TaskStatus) -> T + Send>;
}
#[cfg(target_arch = "wasm32")]
mod task {
    pub trait MaybeSend {}
    impl<T> MaybeSend for T {}
    pub type Deferred<T> = Box<dyn FnOnce(&super::TaskStatus) -> T>;
}
use task::{Deferred, MaybeSend};

/// The answer of work that is done when it is asked for.
pub struct Background<T> {
    told: TaskStatus,
    work: Mutex<Option<Deferred<T>>>,
}

impl<T: 'static> Background<T> {
    /// Takes on work. `first` is under way until it tells another.
    pub fn start(
        _: &mut Threads,
        first: &str,
        work: impl FnOnce(&TaskStatus) -> T + MaybeSend + 'static,
    ) -> Self {
        Self {
            told: TaskStatus::new(first),
            work: Mutex::new(Some(Box::new(work))),
        }
    }

    /// What is under way.
    pub fn progress(&self) -> Progress {
        self.told.progress()
    }

    /// Does the work. It has one answer.
    pub fn poll(&self) -> Result<Option<T>, Panicked> {
        let work = self.work.lock();
        let work = work.unwrap_or_else(PoisonError::into_inner).take();
        work.map(|work| Some(work(&self.told))).ok_or(Panicked)
    }
}
