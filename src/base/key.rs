//! The keys of a preset, said once.
//!
//! Every part of a Plan lists its settings as [`Key`]s: a name, a sentence, and a
//! slot that knows how to read, check and write one value. Reading presets, writing
//! them, `--set`, the reference of the documentation and interactive controls all
//! go through the same list.

use glam::DVec3;
use toml::Value;

/// Something that a preset's value can be put into.
pub trait Slot {
    /// The present value, as a preset would say it.
    fn get(&self) -> Value;
    /// Takes a value over, or says what would have been right.
    fn set(&mut self, value: &Value) -> Result<(), String>;
    /// What the slot takes, in words.
    fn expects(&self) -> String;
}

/// One setting of a part of a Plan.
pub struct Key<'a> {
    /// Its name in presets and `--set`.
    pub name: &'static str,
    /// What it means, in a sentence.
    pub help: &'static str,
    /// Where its value lives.
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

/// Lists keys as `"name" = slot, "help";`.
#[macro_export]
macro_rules! keys {
    ($($name:literal = $slot:expr, $help:literal;)*) => {
        vec![$($crate::base::key::Key::new($name, $slot, $help)),*]
    };
}

/// A value that is impossible together with others, found after reading.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Section and key to point at, as `section.key`.
    pub key: String,
    /// What is wrong and what would do.
    pub why: String,
}

impl Fault {
    /// A fault at `section.key`.
    pub fn new(key: impl Into<String>, why: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            why: why.into(),
        }
    }
}

/// A finite number of a TOML value, an integer serving as a float.
pub fn number(value: &Value) -> Option<f64> {
    let x = match value {
        Value::Float(x) => *x,
        #[allow(clippy::cast_precision_loss, reason = "settings are small")]
        Value::Integer(i) => *i as f64,
        _ => return None,
    };
    x.is_finite().then_some(x)
}

/// How a number in a sentence reads best.
fn plain(x: f64) -> String {
    if x == 0.0 || (1e-3..1e6).contains(&x.abs()) {
        format!("{x}")
    } else {
        format!("{x:e}")
    }
}

/// A number in a closed range.
pub struct Number<'a>(pub &'a mut f64, pub f64, pub f64);

impl Slot for Number<'_> {
    fn get(&self) -> Value {
        Value::Float(*self.0)
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        match number(value) {
            Some(x) if (self.1..=self.2).contains(&x) => {
                *self.0 = x;
                Ok(())
            }
            _ => Err(self.expects()),
        }
    }
    fn expects(&self) -> String {
        format!("a number from {} to {}", plain(self.1), plain(self.2))
    }
}

/// A whole number in a closed range.
pub struct Count<'a>(pub &'a mut u32, pub u32, pub u32);

impl Slot for Count<'_> {
    fn get(&self) -> Value {
        Value::Integer(i64::from(*self.0))
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        match value {
            Value::Integer(i) => match u32::try_from(*i) {
                Ok(n) if (self.1..=self.2).contains(&n) => {
                    *self.0 = n;
                    Ok(())
                }
                _ => Err(self.expects()),
            },
            _ => Err(self.expects()),
        }
    }
    fn expects(&self) -> String {
        format!("a whole number from {} to {}", self.1, self.2)
    }
}

/// `"auto"`, kept as `None`, or what `Count` takes.
pub struct AutoCount<'a>(pub &'a mut Option<u32>, pub u32, pub u32);

impl Slot for AutoCount<'_> {
    fn get(&self) -> Value {
        match &*self.0 {
            Some(n) => Value::Integer(i64::from(*n)),
            None => Value::String("auto".into()),
        }
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        if value.as_str() == Some("auto") {
            *self.0 = None;
            return Ok(());
        }
        let mut n = 0;
        let read = Count(&mut n, self.1, self.2).set(value);
        read.map_err(|_| self.expects())?;
        *self.0 = Some(n);
        Ok(())
    }
    fn expects(&self) -> String {
        format!("\"auto\" or a whole number from {} to {}", self.1, self.2)
    }
}

/// `"auto"`, kept as `None`, or what `Number` takes.
pub struct AutoNumber<'a>(pub &'a mut Option<f64>, pub f64, pub f64);

impl Slot for AutoNumber<'_> {
    fn get(&self) -> Value {
        match &*self.0 {
            Some(x) => Value::Float(*x),
            None => Value::String("auto".into()),
        }
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        if value.as_str() == Some("auto") {
            *self.0 = None;
            return Ok(());
        }
        let mut x = 0.0;
        let read = Number(&mut x, self.1, self.2).set(value);
        read.map_err(|_| self.expects())?;
        *self.0 = Some(x);
        Ok(())
    }
    fn expects(&self) -> String {
        format!(
            "\"auto\" or a number from {} to {}",
            plain(self.1),
            plain(self.2)
        )
    }
}

/// `true` or `false`.
pub struct Switch<'a>(pub &'a mut bool);

impl Slot for Switch<'_> {
    fn get(&self) -> Value {
        Value::Boolean(*self.0)
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        *self.0 = value.as_bool().ok_or_else(|| self.expects())?;
        Ok(())
    }
    fn expects(&self) -> String {
        "true or false".into()
    }
}

/// Three numbers, each in a closed range.
pub struct Triple<'a>(pub &'a mut DVec3, pub f64, pub f64);

impl Slot for Triple<'_> {
    fn get(&self) -> Value {
        Value::Array(self.0.to_array().map(Value::Float).to_vec())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let list = value.as_array().filter(|a| a.len() == 3);
        let mut out = [0.0; 3];
        for (i, v) in list.ok_or_else(|| self.expects())?.iter().enumerate() {
            out[i] = number(v)
                .filter(|x| (self.1..=self.2).contains(x))
                .ok_or_else(|| self.expects())?;
        }
        *self.0 = DVec3::from_array(out);
        Ok(())
    }
    fn expects(&self) -> String {
        format!(
            "three numbers like [1, 2, 3], each from {} to {}",
            plain(self.1),
            plain(self.2)
        )
    }
}

/// A list of numbers or of triples: how many, and each of them in a closed range.
pub struct List<'a, T>(
    pub &'a mut Vec<T>,
    pub std::ops::RangeInclusive<usize>,
    pub f64,
    pub f64,
);

impl Slot for List<'_, f64> {
    fn get(&self) -> Value {
        Value::Array(self.0.iter().map(|x| Value::Float(*x)).collect())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let list = value.as_array().filter(|a| self.1.contains(&a.len()));
        let mut out = Vec::new();
        for v in list.ok_or_else(|| self.expects())? {
            let x = number(v).filter(|x| (self.2..=self.3).contains(x));
            out.push(x.ok_or_else(|| self.expects())?);
        }
        *self.0 = out;
        Ok(())
    }
    fn expects(&self) -> String {
        format!(
            "a list of {} to {} numbers, each from {} to {}",
            self.1.start(),
            self.1.end(),
            plain(self.2),
            plain(self.3)
        )
    }
}

impl Slot for List<'_, DVec3> {
    fn get(&self) -> Value {
        let triple = |v: &DVec3| Value::Array(v.to_array().map(Value::Float).to_vec());
        Value::Array(self.0.iter().map(triple).collect())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let list = value.as_array().filter(|a| self.1.contains(&a.len()));
        let mut out = Vec::new();
        for v in list.ok_or_else(|| self.expects())? {
            let mut x = DVec3::ZERO;
            let read = Triple(&mut x, self.2, self.3).set(v);
            read.map_err(|_| self.expects())?;
            out.push(x);
        }
        *self.0 = out;
        Ok(())
    }
    fn expects(&self) -> String {
        format!(
            "a list of {} to {} triples like [0.9, 0.5, 0.2], each number from {} to {}",
            self.1.start(),
            self.1.end(),
            plain(self.2),
            plain(self.3)
        )
    }
}

/// Image width and height in pixels.
pub struct Size<'a>(pub &'a mut [u32; 2], pub u32);

impl Slot for Size<'_> {
    fn get(&self) -> Value {
        Value::Array(self.0.map(|n| Value::Integer(i64::from(n))).to_vec())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let set = Counts(self.0, 1, self.1).set(value);
        set.map_err(|_| self.expects())
    }
    fn expects(&self) -> String {
        format!("[width, height] in pixels, each from 1 to {}", self.1)
    }
}

/// Two whole numbers, for x and y, each in a closed range.
pub struct Counts<'a>(pub &'a mut [u32; 2], pub u32, pub u32);

impl Slot for Counts<'_> {
    fn get(&self) -> Value {
        Value::Array(self.0.map(|n| Value::Integer(i64::from(n))).to_vec())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let list = value.as_array().filter(|a| a.len() == 2);
        let mut out = [0; 2];
        for (i, v) in list.ok_or_else(|| self.expects())?.iter().enumerate() {
            let read = Count(&mut out[i], self.1, self.2).set(v);
            read.map_err(|_| self.expects())?;
        }
        *self.0 = out;
        Ok(())
    }
    fn expects(&self) -> String {
        format!(
            "two whole numbers like [2, 2], each from {} to {}",
            self.1, self.2
        )
    }
}

/// A word out of a few.
pub struct Word<'a, T: 'static>(pub &'a mut T, pub &'static [(&'static str, T)]);

impl<T: Copy + PartialEq> Slot for Word<'_, T> {
    fn get(&self) -> Value {
        let word = self.1.iter().find(|(_, v)| v == self.0);
        Value::String(word.map_or("", |(w, _)| w).into())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let word = self.1.iter().find(|(w, _)| value.as_str() == Some(w));
        *self.0 = word.ok_or_else(|| self.expects())?.1;
        Ok(())
    }
    fn expects(&self) -> String {
        let words: Vec<String> = self.1.iter().map(|(w, _)| format!("\"{w}\"")).collect();
        format!("one of {}", words.join(", "))
    }
}

/// Free text on one line.
pub struct Text<'a>(pub &'a mut String);

impl Slot for Text<'_> {
    fn get(&self) -> Value {
        Value::String(self.0.clone())
    }
    fn set(&mut self, value: &Value) -> Result<(), String> {
        let text = value
            .as_str()
            .filter(|t| t.len() <= 200 && !t.contains(char::is_control));
        *self.0 = text.ok_or_else(|| self.expects())?.to_string();
        Ok(())
    }
    fn expects(&self) -> String {
        "a line of text of at most 200 bytes, without control characters".into()
    }
}
