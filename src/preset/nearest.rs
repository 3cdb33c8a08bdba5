//! The name that was probably meant.

/// The name nearest to `wanted`, if it is near enough to be a slip: at most a third of
/// its letters differ.
pub fn nearest<'a>(wanted: &str, names: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // A long text is no slip of a short name, and its distance is slow to find.
    let wanted: Vec<char> = wanted.chars().take(64).collect();
    let limit = (wanted.len() / 3).max(1);
    names
        .into_iter()
        .map(|name| (distance(&wanted, name), name))
        .filter(|(d, _)| *d <= limit)
        .min_by_key(|(d, _)| *d)
        .map(|(_, name)| name)
}

/// Edits from one word to the other: insert, delete, replace, or swap two neighbours
/// (optimal string alignment).
fn distance(a: &[char], b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut before = vec![0; b.len() + 1];
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut next = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let same = a[i - 1].eq_ignore_ascii_case(&b[j - 1]);
            let replaced = row[j - 1] + usize::from(!same);
            next[j] = replaced.min(row[j] + 1).min(next[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                next[j] = next[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut row, next);
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        let names = ["fov", "eye", "target", "mandelbox"];
        assert_eq!(nearest("mandlebox", names), Some("mandelbox"));
        assert_eq!(nearest("traget", names), Some("target"));
        assert_eq!(nearest("Fov", names), Some("fov"));
        assert_eq!(nearest("palette", names), None);
        assert_eq!(nearest("", names), None);
    }
}
