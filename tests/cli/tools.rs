//! What the modules share: arguments as one text, tiny renders, and decoded pictures.

use std::process::Output;

use serde_json::Value;

use crate::folder::{Folder, said};

/// The arguments of a tiny render by the CPU executor.
pub fn tiny(preset: &str, more: &str) -> String {
    format!("render {preset} --device cpu --size 24x16 {more}")
}

/// The words of a text; none of them may hold a blank.
pub fn words(args: &str) -> Vec<&str> {
    args.split_whitespace().collect()
}

/// Runs what must succeed.
pub fn done(folder: &Folder, args: &str) -> Output {
    folder.done(&words(args))
}

/// Renders a tiny picture, and returns what was said on standard error.
pub fn rendered(folder: &Folder, preset: &str, more: &str) -> String {
    said(&done(folder, &tiny(preset, more)))
}

/// Runs what must fail: arguments, exit code, and words of the sentence, with `|` between
/// them.
pub fn fails(folder: &Folder, cases: &[(&str, i32, &str)]) {
    for (args, code, says) in cases {
        folder.fails(&words(args), *code, &says.split('|').collect::<Vec<_>>());
    }
}

/// A JSON file or text.
pub fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).expect("JSON")
}

/// The names of the fields of a JSON object, in order.
pub fn names(row: &Value) -> Vec<&str> {
    row.as_object()
        .expect("an object")
        .keys()
        .map(String::as_str)
        .collect()
}

/// The number of a field.
pub fn number(row: &Value, field: &str) -> f64 {
    row[field].as_f64().expect(field)
}

/// A decoded PNG.
pub struct Picture {
    pub info: png::Info<'static>,
    pub pixels: Vec<u8>,
}

pub fn decode(bytes: &[u8]) -> Picture {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
        .read_info()
        .expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("all pixels");
    let info = reader.info().clone();
    Picture { info, pixels }
}
