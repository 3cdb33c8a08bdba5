//! The keys of presets.
//!
//! Every part of a Plan lists its settings as [`Key`]s. A key has a name, a help text and
//! a [`Slot`] that reads, checks and writes one value. Presets, `--set` and the reference
//! page `docs/presets.md` all use these lists. [`settings!`](crate::settings) declares a
//! part with its fields, defaults and keys at once.

use glam::DVec3;
use toml::Value;

/// A place for one value of a preset.
pub trait Slot {
    /// The current value as TOML.
    fn get(&self) -> Value;
    /// Sets the value. Returns `None` and changes nothing if it does not fit.
    fn put(&mut self, value: &Value) -> Option<()>;
    /// Describes the values that fit.
    fn expects(&self) -> String;

    /// Sets the value.
    ///
    /// # Errors
    /// The value does not fit. The error is [`Slot::expects`].
    fn set(&mut self, value: &Value) -> Result<(), String> {
        self.put(value).ok_or_else(|| self.expects())
    }
}

/// One setting of a part of a Plan.
pub struct Key<'a> {
    /// Its name in presets and `--set`.
    pub name: &'static str,
    /// What it means.
    pub help: &'static str,
    /// Where its value is stored.
    pub slot: Box<dyn Slot + 'a>,
}

impl<'a> Key<'a> {
    /// A key over any slot.
    pub fn new(name: &'static str, slot: impl Slot + 'a, help: &'static str) -> Self {
        Self {
            name,
            help,
            slot: Box::new(slot),
        }
    }
}

/// Makes a list of [`Key`]s from lines of the form `"name" = slot, "help";`.
#[macro_export]
macro_rules! keys {
    ($($name:literal = $slot:expr, $help:literal;)*) => {
        vec![$($crate::base::key::Key::new($name, $slot, $help)),*]
    };
}

/// Declares one part of a Plan: the struct, its defaults and its keys.
///
/// A line has the form `field: Type = default, Slot(limits), "help";`. The key is called like
/// the field, and the help text also documents the field.
#[macro_export]
macro_rules! settings {
    (
        $(#[$doc:meta])*
        pub struct $part:ident {
            $($name:ident: $type:ty = $default:expr, $slot:ident($($limit:expr),*), $help:literal;)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part {
            $(#[doc = $help] pub $name: $type,)*
        }

        impl Default for $part {
            fn default() -> Self {
                Self { $($name: $default),* }
            }
        }

        impl $part {
            /// Its keys, in the order of its fields.
            pub fn keys(&mut self) -> Vec<$crate::base::key::Key<'_>> {
                vec![$($crate::base::key::Key::new(
                    stringify!($name),
                    $slot(&mut self.$name $(, $limit)*),
                    $help,
                )),*]
            }
        }
    };
}

/// A value that contradicts another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The key at fault, as `section.key`.
    pub key: String,
    /// What is wrong, and a valid alternative.
    pub why: String,
}

impl Fault {
    /// A fault of the key `section.key`.
    pub fn new(key: impl Into<String>, why: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            why: why.into(),
        }
    }
}

/// The finite number in a TOML value. An integer is also a number.
pub fn number(value: &Value) -> Option<f64> {
    let x = match value {
        Value::Float(x) => *x,
        #[allow(clippy::cast_precision_loss, reason = "settings are small")]
        Value::Integer(i) => *i as f64,
        _ => return None,
    };
    x.is_finite().then_some(x)
}

fn number_in(value: &Value, low: f64, high: f64) -> Option<f64> {
    number(value).filter(|x| (low..=high).contains(x))
}

fn count_in(value: &Value, low: u32, high: u32) -> Option<u32> {
    let n = u32::try_from(value.as_integer()?).ok()?;
    (low..=high).contains(&n).then_some(n)
}

/// Reads an array of `N` values.
fn array<T: Copy + Default, const N: usize>(
    value: &Value,
    read: impl Fn(&Value) -> Option<T>,
) -> Option<[T; N]> {
    let list = value.as_array().filter(|a| a.len() == N)?;
    let mut out = [T::default(); N];
    for (to, from) in out.iter_mut().zip(list) {
        *to = read(from)?;
    }
    Some(out)
}

/// Reads `"auto"` as `None`, and any other value by `read`.
fn auto<T>(value: &Value, read: impl Fn(&Value) -> Option<T>) -> Option<Option<T>> {
    match value.as_str() {
        Some("auto") => Some(None),
        _ => read(value).map(Some),
    }
}

fn auto_value<T: Into<Value>>(value: Option<T>) -> Value {
    value.map_or_else(|| "auto".into(), Into::into)
}

/// A number in a sentence. Very small and very large ones get an exponent.
fn plain(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

fn from_to(low: f64, high: f64) -> String {
    format!("from {} to {}", plain(low), plain(high))
}

/// A number in a closed range.
pub struct Number<'a>(pub &'a mut f64, pub f64, pub f64);

impl Slot for Number<'_> {
    fn get(&self) -> Value {
        (*self.0).into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = number_in(value, self.1, self.2)?;
        Some(())
    }
    fn expects(&self) -> String {
        format!("a number {}", from_to(self.1, self.2))
    }
}

/// A whole number in a closed range.
pub struct Count<'a>(pub &'a mut u32, pub u32, pub u32);

impl Slot for Count<'_> {
    fn get(&self) -> Value {
        (*self.0).into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = count_in(value, self.1, self.2)?;
        Some(())
    }
    fn expects(&self) -> String {
        format!("a whole number from {} to {}", self.1, self.2)
    }
}

/// A whole number in a closed range, or `"auto"`, which is stored as `None`.
pub struct AutoCount<'a>(pub &'a mut Option<u32>, pub u32, pub u32);

impl Slot for AutoCount<'_> {
    fn get(&self) -> Value {
        auto_value(*self.0)
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = auto(value, |v| count_in(v, self.1, self.2))?;
        Some(())
    }
    fn expects(&self) -> String {
        format!("\"auto\" or a whole number from {} to {}", self.1, self.2)
    }
}

/// A number in a closed range, or `"auto"`, which is stored as `None`.
pub struct AutoNumber<'a>(pub &'a mut Option<f64>, pub f64, pub f64);

impl Slot for AutoNumber<'_> {
    fn get(&self) -> Value {
        auto_value(*self.0)
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = auto(value, |v| number_in(v, self.1, self.2))?;
        Some(())
    }
    fn expects(&self) -> String {
        format!("\"auto\" or a number {}", from_to(self.1, self.2))
    }
}

/// `true` or `false`.
pub struct Switch<'a>(pub &'a mut bool);

impl Slot for Switch<'_> {
    fn get(&self) -> Value {
        (*self.0).into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = value.as_bool()?;
        Some(())
    }
    fn expects(&self) -> String {
        "true or false".into()
    }
}

/// Three numbers, each in a closed range.
pub struct Triple<'a>(pub &'a mut DVec3, pub f64, pub f64);

impl Slot for Triple<'_> {
    fn get(&self) -> Value {
        self.0.to_array().to_vec().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = array(value, |v| number_in(v, self.1, self.2))?.into();
        Some(())
    }
    fn expects(&self) -> String {
        let range = from_to(self.1, self.2);
        format!("three numbers like [1, 2, 3], each {range}")
    }
}

/// A list of numbers or of triples. The range limits the length of the list, the two numbers
/// limit each number in it.
pub struct List<'a, T>(
    pub &'a mut Vec<T>,
    pub std::ops::RangeInclusive<usize>,
    pub f64,
    pub f64,
);

impl<T> List<'_, T> {
    /// Reads all values of a list whose length fits.
    fn all(&self, value: &Value, read: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
        let list = value.as_array().filter(|a| self.1.contains(&a.len()))?;
        list.iter().map(read).collect()
    }

    fn count(&self) -> String {
        format!("a list of {} to {}", self.1.start(), self.1.end())
    }
}

impl Slot for List<'_, f64> {
    fn get(&self) -> Value {
        self.0.clone().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = self.all(value, |v| number_in(v, self.2, self.3))?;
        Some(())
    }
    fn expects(&self) -> String {
        format!("{} numbers, each {}", self.count(), from_to(self.2, self.3))
    }
}

impl Slot for List<'_, DVec3> {
    fn get(&self) -> Value {
        let triples = self.0.iter().map(|v| v.to_array().to_vec());
        triples.collect::<Vec<_>>().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        let one = |v: &Value| Some(array(v, |x| number_in(x, self.2, self.3))?.into());
        *self.0 = self.all(value, one)?;
        Some(())
    }
    fn expects(&self) -> String {
        let range = from_to(self.2, self.3);
        let count = self.count();
        format!("{count} triples like [0.9, 0.5, 0.2], each number {range}")
    }
}

/// Width and height of an image in pixels, each from 1 to a limit.
pub struct Size<'a>(pub &'a mut [u32; 2], pub u32);

impl Slot for Size<'_> {
    fn get(&self) -> Value {
        self.0.to_vec().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        Counts(self.0, 1, self.1).put(value)
    }
    fn expects(&self) -> String {
        format!("[width, height] in pixels, each from 1 to {}", self.1)
    }
}

/// Two whole numbers, for x and y, each in a closed range.
pub struct Counts<'a>(pub &'a mut [u32; 2], pub u32, pub u32);

impl Slot for Counts<'_> {
    fn get(&self) -> Value {
        self.0.to_vec().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        *self.0 = array(value, |v| count_in(v, self.1, self.2))?;
        Some(())
    }
    fn expects(&self) -> String {
        let (low, high) = (self.1, self.2);
        format!("two whole numbers like [2, 2], each from {low} to {high}")
    }
}

/// One word of a list. Each word stands for a value.
pub struct Word<'a, T: 'static>(pub &'a mut T, pub &'static [(&'static str, T)]);

impl<T: Copy + PartialEq> Slot for Word<'_, T> {
    fn get(&self) -> Value {
        let word = self.1.iter().find(|(_, v)| v == self.0);
        word.map_or("", |(w, _)| w).into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        let mut words = self.1.iter();
        *self.0 = words.find(|(w, _)| value.as_str() == Some(w))?.1;
        Some(())
    }
    fn expects(&self) -> String {
        let words: Vec<String> = self.1.iter().map(|(w, _)| format!("\"{w}\"")).collect();
        format!("one of {}", words.join(", "))
    }
}

/// One line of text.
pub struct Text<'a>(pub &'a mut String);

impl Slot for Text<'_> {
    fn get(&self) -> Value {
        self.0.clone().into()
    }
    fn put(&mut self, value: &Value) -> Option<()> {
        let fits = |t: &&str| t.len() <= 200 && !t.contains(char::is_control);
        *self.0 = value.as_str().filter(fits)?.into();
        Some(())
    }
    fn expects(&self) -> String {
        "a line of text of at most 200 bytes, without control characters".into()
    }
}
