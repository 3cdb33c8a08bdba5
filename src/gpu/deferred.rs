//! As `later`, where there are no threads: the work is done when its answer is asked for.

use std::sync::{Mutex, PoisonError};

use crate::gpu::told::{Panicked, Told};
use crate::pass::progress::Progress;

/// No threads.
#[derive(Default)]
pub struct Threads {}

type Deferred<T> = Box<dyn FnOnce(&Told) -> T + Send>;

/// The answer of work that is done when it is asked for.
pub struct Later<T> {
    told: Told,
    work: Mutex<Option<Deferred<T>>>,
}

impl<T: Send + 'static> Later<T> {
    /// Takes on work. `first` is under way until it tells another.
    pub fn start(
        _: &mut Threads,
        first: &str,
        work: impl FnOnce(&Told) -> T + Send + 'static,
    ) -> Self {
        Self {
            told: Told::new(first),
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
