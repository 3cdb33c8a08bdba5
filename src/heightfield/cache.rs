//! A value made from others, kept until they change.
//!
//! A plan is a plain value that is cloned, compared and asked for its scene again and
//! again; heights and cone maps take long to make. Clones share what is kept. It is no
//! part of the plan: it never makes two plans differ.

use std::sync::{Arc, Mutex, PoisonError};

/// A key and the value made from it.
type Made<K, V> = Option<(K, Arc<V>)>;

/// The last value made, and what it was made from.
pub struct Cache<K, V> {
    last: Arc<Mutex<Made<K, V>>>,
}

impl<K: PartialEq, V> Cache<K, V> {
    /// The value that belongs to a key: the kept one, or what `make` makes.
    ///
    /// # Errors
    /// Those of `make`; nothing is kept then.
    pub fn get<E>(&self, key: K, make: impl FnOnce(&K) -> Result<V, E>) -> Result<Arc<V>, E> {
        // A panic while making leaves what was kept before.
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((of, value)) = &*last
            && *of == key
        {
            return Ok(value.clone());
        }
        let value = Arc::new(make(&key)?);
        *last = Some((key, value.clone()));
        Ok(value)
    }
}

impl<K, V> Default for Cache<K, V> {
    fn default() -> Self {
        Self {
            last: Arc::default(),
        }
    }
}

impl<K, V> Clone for Cache<K, V> {
    fn clone(&self) -> Self {
        Self {
            last: self.last.clone(),
        }
    }
}

impl<K, V> PartialEq for Cache<K, V> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<K, V> std::fmt::Debug for Cache<K, V> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Cache")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_made_once_and_again_when_its_key_changes() {
        let kept = Cache::<u32, u32>::default();
        let mut made = 0;
        for (key, times) in [(1, 1), (1, 1), (2, 2), (1, 3)] {
            let value = kept.clone().get(key, |k| {
                made += 1;
                Ok::<u32, ()>(10 * k)
            });
            assert_eq!(value, Ok(Arc::new(10 * key)));
            assert_eq!(made, times);
        }
        assert_eq!(kept.get(3, |_| Err("no")), Err("no"));
        assert_eq!(kept.get(1, |_| Err("no")), Ok(Arc::new(10)));
    }
}
