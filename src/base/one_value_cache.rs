//! A cache of one value that takes long to make, kept until its key changes.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};

/// The last value that was made, with its key. Clones share it.
pub type OneValueCache<K, V> = Arc<Mutex<Kept<K, V>>>;
type Kept<K, V> = Option<(K, Arc<V>)>;

/// The value of a key: the kept one, or a new one by `make`. A failure keeps the old one.
///
/// # Errors
/// Those of `make`.
pub fn last_or_new<K: PartialEq, V, E>(
    last: &OneValueCache<K, V>,
    key: K,
    make: impl FnOnce(&K) -> Result<V, E>,
) -> Result<Arc<V>, E> {
    // After a panic in `make` the old value is still there.
    let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, value)) = &*last
        && *of == key
    {
        return Ok(value.clone());
    }
    let value = Arc::new(make(&key)?);
    *last = Some((key, value.clone()));
    Ok(value)
}

/// Whether the value of a key is kept. It does not wait for one that is being made.
pub fn is_last<K: PartialEq, V>(last: &OneValueCache<K, V>, key: &K) -> bool {
    let kept = kept(last);
    kept.is_some_and(|kept| kept.as_ref().is_some_and(|(of, _)| of == key))
}

/// A cache of its own with what is kept now. While another value is made, it is empty, or this waits.
pub fn snapshot<K: Clone, V>(last: &OneValueCache<K, V>, may_wait: bool) -> OneValueCache<K, V> {
    let kept = match may_wait {
        true => Some(last.lock().unwrap_or_else(PoisonError::into_inner)),
        false => kept(last),
    };
    Arc::new(Mutex::new(kept.and_then(|kept| kept.clone())))
}

fn kept<K, V>(last: &OneValueCache<K, V>) -> Option<MutexGuard<'_, Kept<K, V>>> {
    match last.try_lock() {
        Ok(kept) => Some(kept),
        Err(TryLockError::Poisoned(kept)) => Some(kept.into_inner()),
        Err(TryLockError::WouldBlock) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_once_and_again_when_its_key_changes() {
        let last = OneValueCache::<u32, u32>::default();
        let mut made = 0;
        for (key, times) in [(1, 1), (1, 1), (2, 2), (1, 3)] {
            let value = last_or_new(&last.clone(), key, |k| {
                made += 1;
                Ok::<u32, ()>(10 * k)
            });
            assert_eq!(value, Ok(Arc::new(10 * key)));
            assert_eq!(made, times);
        }
        assert_eq!(last_or_new(&last, 3, |_| Err("no")), Err("no"));
        assert_eq!(last_or_new(&last, 1, |_| Err("no")), Ok(Arc::new(10)));
    }

    #[test]
    fn a_snapshot_keeps_its_value() {
        let last = OneValueCache::<u32, u32>::default();
        let make = |key| last_or_new(&last, key, |k| Ok::<_, ()>(10 * k));
        make(1).expect("made");
        let before = snapshot(&last, false);
        make(2).expect("made");
        assert!(is_last(&before, &1) && is_last(&last, &2));
        let made = last.lock().expect("not poisoned");
        assert!(!is_last(&last, &2) && !is_last(&snapshot(&last, false), &2));
        std::thread::scope(|scope| {
            let ((ready, starts), last) = (std::sync::mpsc::channel(), &last);
            let waits = scope.spawn(move || {
                ready.send(()).expect("the test waits");
                snapshot(last, true)
            });
            starts.recv().expect("a thread");
            std::thread::sleep(std::time::Duration::from_millis(50));
            drop(made);
            assert!(is_last(&waits.join().expect("a snapshot"), &2));
        });
    }
}
