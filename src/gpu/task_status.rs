//! The progress of a background task, and whether it was cancelled.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::pass::progress::Progress;

/// What is under way, and whether the answer is still wanted.
#[derive(Debug)]
pub struct TaskStatus {
    unwanted: AtomicBool,
    progress: Mutex<Progress>,
}

impl TaskStatus {
    /// `first` is under way.
    pub fn new(first: &str) -> Self {
        Self {
            unwanted: AtomicBool::new(false),
            progress: Mutex::new(Progress {
                pass: first.into(),
                ..Progress::default()
            }),
        }
    }

    /// Tells what is under way. Returns whether the answer is still wanted.
    pub fn tell(&self, progress: &Progress) -> bool {
        *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = progress.clone();
        !self.unwanted.load(Ordering::Relaxed)
    }

    /// Nobody wants the answer any more.
    #[cfg(feature = "cli")]
    pub fn cancel(&self) {
        self.unwanted.store(true, Ordering::Relaxed);
    }

    /// What is under way.
    pub fn progress(&self) -> Progress {
        let progress = self.progress.lock();
        progress.unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// The thread has panicked.
#[derive(Debug)]
pub struct Panicked;
