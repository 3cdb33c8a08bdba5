//! The name that was probably meant.

use strsim::osa_distance;

/// The name nearest to `wanted`, if at most a third of its letters differ.
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A long text is no misspelt name, and its distance takes long to compute.
    let wanted: String = wanted.chars().take(64).collect::<String>().to_lowercase();
    let limit = (wanted.chars().count() / 3).max(1);
    names
        .into_iter()
        .map(|name| (osa_distance(&wanted, &name.to_lowercase()), name))
        .filter(|(distance, _)| *distance <= limit)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, name)| name)
}

/// `, perhaps ...` in the middle of a sentence, or nothing.
pub(super) fn perhaps<'a>(names: impl IntoIterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.into_iter().collect();
    match names[..] {
        [] => String::new(),
        _ => format!(", perhaps `{}`", names.join("`, `")),
    }
}
