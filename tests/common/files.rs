//! The files of the repository, for tests that read the sources.

use std::path::Path;

/// Every file below a folder of the repository: its path from the root, and its text.
pub fn files_below(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut folders, mut found) = (vec![root.join(folder)], Vec::new());
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(root).expect("a file of the repository");
            let text = std::fs::read_to_string(&path).expect("a text");
            found.push((name.display().to_string().replace('\\', "/"), text));
        }
    }
    assert!(found.len() > 20, "only {} files", found.len());
    found.sort();
    found
}
