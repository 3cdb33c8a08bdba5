//! Letters for captions: three columns, five rows, capitals only.
//!
//! A glyph is five octal digits, one for each row from the top; of a digit, 4 is the
//! left dot, 2 the middle one, 1 the right one.

/// Dots across and down of a glyph.
pub const GLYPH: [usize; 2] = [3, 5];

const LETTERS: [u16; 26] = [
    0o25755, 0o65656, 0o34443, 0o65556, 0o74647, 0o74644, 0o34553, 0o55755, 0o72227, 0o11152,
    0o55655, 0o44447, 0o57755, 0o65555, 0o25552, 0o65644, 0o25563, 0o65655, 0o34216, 0o72222,
    0o55557, 0o55552, 0o55775, 0o55255, 0o55222, 0o71247,
];

const DIGITS: [u16; 10] = [
    0o75557, 0o26227, 0o71747, 0o71317, 0o55711, 0o74717, 0o74757, 0o71122, 0o75757, 0o75717,
];

/// The dots of a character; a middle line for one that has none.
fn glyph(c: char) -> u16 {
    match c.to_ascii_uppercase() {
        c @ 'A'..='Z' => LETTERS[c as usize - 'A' as usize],
        c @ '0'..='9' => DIGITS[c as usize - '0' as usize],
        ' ' => 0,
        '.' => 0o00002,
        ',' => 0o00024,
        ':' => 0o02020,
        '+' => 0o02720,
        '/' => 0o11244,
        '(' => 0o24442,
        ')' => 0o21112,
        '%' => 0o51245,
        _ => 0o00700,
    }
}

/// The dots that a text sets, in units of dots from its top left.
pub fn dots(text: &str) -> impl Iterator<Item = [usize; 2]> {
    text.chars().enumerate().flat_map(|(i, c)| {
        let rows = glyph(c);
        let all = (0..GLYPH[1]).flat_map(|y| (0..GLYPH[0]).map(move |x| (x, y)));
        let set = all.filter(move |(x, y)| {
            let bit = (GLYPH[1] - 1 - y) * GLYPH[0] + (GLYPH[0] - 1 - x);
            rows >> bit & 1 == 1
        });
        set.map(move |(x, y)| [i * (GLYPH[0] + 1) + x, y])
    })
}
