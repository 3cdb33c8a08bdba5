//! Runs a task on its own thread. The caller can ask for the result without waiting.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, TryRecvError, channel};
use std::thread::JoinHandle;
use std::time::Duration;

use crate::gpu::task_status::{Panicked, TaskStatus};
use crate::pass::progress::Progress;

/// Does work on all items at once and returns the answers in their order.
pub fn all_at_once<T: Sync, A: Send>(items: &[T], work: impl Fn(&T) -> A + Sync) -> Vec<A> {
    let mut answers: Vec<Option<A>> = items.iter().map(|_| None).collect();
    std::thread::scope(|scope| {
        for (item, answer) in items.iter().zip(&mut answers) {
            scope.spawn(|| *answer = Some(work(item)));
        }
    });
    // A panic of a thread has gone on to this one.
    answers.into_iter().flatten().collect()
}

/// The threads of a renderer. Dropping it waits for them, as a driver may fail if a program ends
/// while it compiles.
#[derive(Default)]
pub struct Threads(Vec<(Arc<TaskStatus>, JoinHandle<()>)>);

impl Drop for Threads {
    fn drop(&mut self) {
        // Works that are dropped later would tell them too late.
        for (told, _) in &self.0 {
            told.cancel();
        }
        for (_, thread) in self.0.drain(..) {
            // A panic was noticed by who waited for the answer.
            let _ = thread.join();
        }
    }
}

/// The answer of a thread. Dropping it tells the thread to stop.
pub struct Background<T> {
    told: Arc<TaskStatus>,
    answer: Receiver<T>,
}

impl<T: Send + 'static> Background<T> {
    /// Starts a thread. `first` is under way until it tells another.
    pub fn start(
        threads: &mut Threads,
        first: &str,
        work: impl FnOnce(&TaskStatus) -> T + Send + 'static,
    ) -> Self {
        let told = Arc::new(TaskStatus::new(first));
        let (send, answer) = channel();
        let own = told.clone();
        threads.0.retain(|(_, thread)| !thread.is_finished());
        let thread = std::thread::spawn(move || {
            // Nobody may wait any more.
            let _ = send.send(work(&own));
        });
        threads.0.push((told.clone(), thread));
        Self { told, answer }
    }

    /// What is under way.
    pub fn progress(&self) -> Progress {
        self.told.progress()
    }

    /// The answer, once it is there.
    pub fn poll(&self) -> Result<Option<T>, Panicked> {
        match self.answer.try_recv() {
            Ok(answer) => Ok(Some(answer)),
            Err(TryRecvError::Empty) => Ok(None),
            Err(TryRecvError::Disconnected) => Err(Panicked),
        }
    }

    /// Waits for the answer for a moment.
    pub fn wait(&self) -> Result<Option<T>, Panicked> {
        match self.answer.recv_timeout(Duration::from_millis(20)) {
            Ok(answer) => Ok(Some(answer)),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(Panicked),
        }
    }
}

impl<T> Drop for Background<T> {
    fn drop(&mut self) {
        self.told.cancel();
    }
}
