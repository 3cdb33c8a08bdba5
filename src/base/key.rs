//! The keys of presets.
//!
//! Every part of a Plan lists its settings as [`Key`]s. A key has a name, a help text and
//! a [`Slot`] that reads, checks and writes one value. Presets, `--set` and the reference
//! page `docs/presets.md` all use these lists. [`settings!`](crate::settings) declares a
//! part with its fields, defaults and keys at once.

use glam::DVec3;
use toml::Value;

/// What values a slot takes, for who offers them. Ranges are closed.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A number in a range.
    Number([f64; 2]),
    /// A whole number in a range.
    Count([u32; 2]),
    /// `true` or `false`.
    Switch,
    /// One of some words.
    Word(Vec<&'static str>),
    /// Three numbers, each in a range.
    Triple([f64; 2]),
    /// Up to so many triples of numbers in a range.
    Triples(usize, [f64; 2]),
    /// `"auto"`, or another kind.
    Auto(Box<Kind>),
    /// Anything else.
    Other,
}

/// A place for one value of a preset.
pub trait Slot {
    /// The current value as TOML.
    fn get(&self) -> Value;
    /// What values it takes.
    fn kind(&self) -> Kind;
    /// Describes the values that fit.
    fn expects(&self) -> String;
    /// Sets the value.
    ///
    /// # Errors
    /// The value does not fit, and nothing changes. The error is [`Slot::expects`].
    fn set(&mut self, value: &Value) -> Result<(), String>;
}

/// A slot over a variable, given by how its value is written and read.
pub struct ValueSlot<'a, T, W, R> {
    at: &'a mut T,
    expects: String,
    write: W,
    read: R,
    kind: Kind,
}

impl<'a, T, W, R> ValueSlot<'a, T, W, R>
where
    W: Fn(&T) -> Value,
    R: Fn(&Value) -> Option<T>,
{
    /// A slot over `at`. `expects` describes the values that fit, and `read` returns `None` for
    /// all others.
    pub fn new(at: &'a mut T, expects: impl Into<String>, write: W, read: R) -> Self {
        Self {
            at,
            expects: expects.into(),
            write,
            read,
            kind: Kind::Other,
        }
    }

    /// The slot with the kind of its values.
    pub fn of(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }
}

impl<T, W: Fn(&T) -> Value, R: Fn(&Value) -> Option<T>> Slot for ValueSlot<'_, T, W, R> {
    fn get(&self) -> Value {
        (self.write)(self.at)
    }
    fn kind(&self) -> Kind {
        self.kind.clone()
    }
    fn expects(&self) -> String {
        self.expects.clone()
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        *self.at = (self.read)(value).ok_or_else(|| self.expects())?;
        Ok(())
    }
}

/// The most that a new value of a key makes again. Each includes those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Redo {
    /// Nothing in the picture.
    Nothing,
    /// The bytes of the colours.
    Tone,
    /// The colours of the hits.
    Color,
    /// Cones and rays.
    March,
    /// Programs are compiled, if they are new.
    Program,
    /// Heights, cone maps or textures are loaded or made.
    Assets,
}

/// One setting of a part of a Plan.
pub struct Key<'a> {
    /// Its name in presets and `--set`.
    pub name: &'static str,
    /// What it means.
    pub help: &'static str,
    /// Where its value is stored.
    pub slot: Box<dyn Slot + 'a>,
    /// What a new value makes again, if it is not what most keys of the section do.
    pub redo: Option<Redo>,
}

impl<'a> Key<'a> {
    /// A key over any slot.
    pub fn new(name: &'static str, slot: impl Slot + 'a, help: &'static str) -> Self {
        Self {
            name,
            help,
            slot: Box::new(slot),
            redo: None,
        }
    }

    /// The key with what a new value makes again.
    pub fn redoing(self, redo: Redo) -> Self {
        Self {
            redo: Some(redo),
            ..self
        }
    }
}

/// Makes a list of [`Key`]s from lines of the form `"name" = slot, "help";` or
/// `"name" = slot, "help" => Redo;`.
#[macro_export]
macro_rules! keys {
    ($($name:literal = $slot:expr, $help:expr $(=> $redo:ident)?;)*) => {
        vec![$(
            $crate::base::key::Key::new($name, $slot, $help)
                $(.redoing($crate::base::key::Redo::$redo))?
        ),*]
    };
}

/// Declares one part of a Plan: the struct, its defaults and its keys.
///
/// A line has the form `field: Type = default, slot(limits), "help";` or ends with
/// `"help" => Redo;` ([`Redo`](crate::base::key::Redo)). The key is called like the field, or by
/// another name after it: `field as "name": Type`. The help text also documents the field.
/// Lines `..field: Type;` before and after them are settings of their own, with their keys.
#[macro_export]
macro_rules! settings {
    (
        $(#[$doc:meta])*
        pub struct $part:ident {
            $($(#[$first_doc:meta])* ..$first:ident: $first_type:ty;)*
            $($name:ident $(as $key:literal)?: $type:ty = $default:expr, $slot:ident($($limit:expr),*), $help:literal $(=> $redo:ident)?;)+
            $($(#[$last_doc:meta])* ..$last:ident: $last_type:ty;)*
        }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Debug, PartialEq)]
        pub struct $part {
            $($(#[$first_doc])* pub $first: $first_type,)*
            $(#[doc = $help] pub $name: $type,)*
            $($(#[$last_doc])* pub $last: $last_type,)*
        }

        impl Default for $part {
            fn default() -> Self {
                Self {
                    $($first: Default::default(),)*
                    $($name: $default,)*
                    $($last: Default::default(),)*
                }
            }
        }

        impl $part {
            /// Its keys, in the order of its fields.
            pub fn keys(&mut self) -> Vec<$crate::base::key::Key<'_>> {
                let own = [$($crate::base::key::Key::new(
                    // The other name, if there is one.
                    [$($key,)? stringify!($name)][0],
                    $slot(&mut self.$name $(, $limit)*),
                    $help,
                )$(.redoing($crate::base::key::Redo::$redo))?),*];
                let first = std::iter::empty()$(.chain(self.$first.keys()))*;
                first.chain(own)$(.chain(self.$last.keys()))*.collect()
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

    /// A fault of the key `section.key`, unless its value fits.
    ///
    /// # Errors
    /// That fault.
    pub fn unless(fits: bool, key: &str, why: impl Into<String>) -> Result<(), Self> {
        fits.then_some(()).ok_or_else(|| Self::new(key, why))
    }
}

/// The number in a TOML value, if it is in a closed range. An integer is also a number.
pub fn number_in(value: &Value, low: f64, high: f64) -> Option<f64> {
    let number = value.as_float().or(value.as_integer().map(|i| i as f64));
    number.filter(|x| (low..=high).contains(x))
}

/// The whole number in a TOML value, if it is in a closed range.
pub fn count_in(value: &Value, low: u32, high: u32) -> Option<u32> {
    let n = u32::try_from(value.as_integer()?).ok()?;
    (low..=high).contains(&n).then_some(n)
}

/// Reads an array of `N` values.
fn array<T, const N: usize>(value: &Value, read: impl Fn(&Value) -> Option<T>) -> Option<[T; N]> {
    let all: Option<Vec<T>> = value.as_array()?.iter().map(read).collect();
    all?.try_into().ok()
}

fn triple_in(value: &Value, low: f64, high: f64) -> Option<DVec3> {
    array(value, |v| number_in(v, low, high)).map(DVec3::from_array)
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
pub fn number(at: &mut f64, low: f64, high: f64) -> impl Slot {
    let expects = format!("a number {}", from_to(low, high));
    let read = move |v: &Value| number_in(v, low, high);
    ValueSlot::new(at, expects, |x| (*x).into(), read).of(Kind::Number([low, high]))
}

/// `"auto"`, which is stored as `None`, or a value that `read` reads.
pub fn auto<T: Copy + Into<Value>>(
    at: &mut Option<T>,
    other: String,
    kind: Kind,
    read: impl Fn(&Value) -> Option<T>,
) -> impl Slot {
    let write = |x: &Option<T>| x.map_or("auto".into(), Into::into);
    let read = move |v: &Value| match v.as_str() {
        Some("auto") => Some(None),
        _ => read(v).map(Some),
    };
    let kind = Kind::Auto(Box::new(kind));
    ValueSlot::new(at, format!("\"auto\" or {other}"), write, read).of(kind)
}

/// A whole number in a closed range.
pub fn count(at: &mut u32, low: u32, high: u32) -> impl Slot {
    let expects = format!("a whole number from {low} to {high}");
    let read = move |v: &Value| count_in(v, low, high);
    ValueSlot::new(at, expects, |n| (*n).into(), read).of(Kind::Count([low, high]))
}

/// A whole number in a closed range, or `"auto"`, which is stored as `None`.
pub fn auto_count(at: &mut Option<u32>, low: u32, high: u32) -> impl Slot {
    let other = format!("a whole number from {low} to {high}");
    let kind = Kind::Count([low, high]);
    auto(at, other, kind, move |v| count_in(v, low, high))
}

/// A number in a closed range, or `"auto"`, which is stored as `None`.
pub fn auto_number(at: &mut Option<f64>, low: f64, high: f64) -> impl Slot {
    let other = format!("a number {}", from_to(low, high));
    let kind = Kind::Number([low, high]);
    auto(at, other, kind, move |v| number_in(v, low, high))
}

/// `true` or `false`.
pub fn switch(at: &mut bool) -> impl Slot {
    let place = ValueSlot::new(at, "true or false", |on| (*on).into(), Value::as_bool);
    place.of(Kind::Switch)
}

/// Three numbers, each in a closed range.
pub fn triple(at: &mut DVec3, low: f64, high: f64) -> impl Slot {
    let range = from_to(low, high);
    let expects = format!("three numbers like [1, 2, 3], each {range}");
    let read = move |v: &Value| triple_in(v, low, high);
    let write = |p: &DVec3| p.to_array().to_vec().into();
    ValueSlot::new(at, expects, write, read).of(Kind::Triple([low, high]))
}

/// Three numbers, each in a closed range, or `"auto"`, which is stored as `None`.
pub fn auto_triple(at: &mut Option<DVec3>, low: f64, high: f64) -> impl Slot {
    let range = from_to(low, high);
    let expects = format!("\"auto\" or three numbers like [1, 2, 3], each {range}");
    let write = |p: &Option<DVec3>| match p {
        Some(p) => p.to_array().to_vec().into(),
        None => "auto".into(),
    };
    let read = move |v: &Value| match v.as_str() {
        Some("auto") => Some(None),
        _ => triple_in(v, low, high).map(Some),
    };
    let kind = Kind::Auto(Box::new(Kind::Triple([low, high])));
    ValueSlot::new(at, expects, write, read).of(kind)
}

/// The values of a list of 1 to `most`.
fn list<T>(value: &Value, most: usize, read: impl Fn(&Value) -> Option<T>) -> Option<Vec<T>> {
    let list = value.as_array().filter(|a| (1..=most).contains(&a.len()));
    list?.iter().map(read).collect()
}

/// A list of 1 to `most` numbers, each in a closed range.
pub fn numbers(at: &mut Vec<f64>, most: usize, low: f64, high: f64) -> impl Slot {
    let range = from_to(low, high);
    let expects = format!("a list of 1 to {most} numbers, each {range}");
    let read = move |v: &Value| list(v, most, |x| number_in(x, low, high));
    ValueSlot::new(at, expects, |all| all.clone().into(), read)
}

/// A list of 1 to `most` triples of numbers, each number in a closed range.
pub fn triples(at: &mut Vec<DVec3>, most: usize, low: f64, high: f64) -> impl Slot {
    let range = from_to(low, high);
    let expects =
        format!("a list of 1 to {most} triples like [0.9, 0.5, 0.2], each number {range}");
    let write = |all: &Vec<DVec3>| {
        let triples = all.iter().map(|v| v.to_array().to_vec());
        triples.collect::<Vec<_>>().into()
    };
    let read = move |v: &Value| list(v, most, |x| triple_in(x, low, high));
    ValueSlot::new(at, expects, write, read).of(Kind::Triples(most, [low, high]))
}

/// Two whole numbers, for x and y, each in a closed range.
pub fn counts(at: &mut [u32; 2], low: u32, high: u32) -> impl Slot {
    let expects = format!("two whole numbers like [2, 2], each from {low} to {high}");
    let read = move |v: &Value| array(v, |n| count_in(n, low, high));
    ValueSlot::new(at, expects, |pair| pair.to_vec().into(), read)
}

/// Width and height of an image in pixels, each from 1 to a limit.
pub fn size(at: &mut [u32; 2], most: u32) -> impl Slot {
    let expects = format!("[width, height] in pixels, each from 1 to {most}");
    let read = move |v: &Value| array(v, |n| count_in(n, 1, most));
    ValueSlot::new(at, expects, |pair| pair.to_vec().into(), read)
}

/// One word of a list. Each word stands for a value.
pub fn word<T: Copy + PartialEq>(at: &mut T, words: &'static [(&str, T)]) -> impl Slot {
    let quoted: Vec<String> = words.iter().map(|(w, _)| format!("\"{w}\"")).collect();
    let write = move |value: &T| {
        let word = words.iter().find(|(_, v)| v == value);
        word.map_or("", |(w, _)| w).into()
    };
    let read = move |v: &Value| {
        let word = words.iter().find(|(w, _)| v.as_str() == Some(w));
        word.map(|(_, value)| *value)
    };
    let expects = format!("one of {}", quoted.join(", "));
    let kind = Kind::Word(words.iter().map(|(word, _)| *word).collect());
    ValueSlot::new(at, expects, write, read).of(kind)
}

/// One line of text.
pub fn text(at: &mut String) -> impl Slot {
    let expects = "a line of text of at most 200 bytes, without control characters";
    let read = |v: &Value| {
        let fits = |t: &&str| t.len() <= 200 && !t.contains(char::is_control);
        v.as_str().filter(fits).map(str::to_string)
    };
    ValueSlot::new(at, expects, |line| line.clone().into(), read)
}
