//! The text of a preset in a file: names of other files are relative to its folder.

use std::path::{Component, Path, PathBuf};

use crate::plan::Plan;
use crate::preset::write;

/// The preset of a plan as a file holds it: the names of its files are relative to the folder of
/// that file. Names from the root stay, and so do those that are not UTF-8.
pub fn write_beside(plan: &Plan, file: &Path) -> String {
    let mut plan = plan.clone();
    move_beside(&mut plan, file);
    write(&plan)
}

/// Makes a plan that of a preset file: the names of its files as in [`write_beside`].
pub fn move_beside(plan: &mut Plan, file: &Path) {
    let absolute = |path: &Path| std::path::absolute(path).ok();
    let folder = file.parent().map(|folder| Path::new(".").join(folder));
    let folder = folder.as_deref().and_then(absolute);
    plan.rename_files(&|path| {
        let path = absolute(&Path::new(".").join(path))?;
        let named = relative(&path, folder.as_deref()?);
        named.to_str().map(String::from)
    });
    plan.set_folder(file.parent().unwrap_or(file));
}

/// The way from a folder to a file.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let [file, folder]: [Vec<Component>; 2] = [file, folder].map(|p| p.components().collect());
    let same = file.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    let up = folder[same..].iter().map(|_| Component::ParentDir);
    up.chain(file[same..].iter().copied()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::heightfield::settings::HeightfieldSettings;

    #[test]
    fn names_lead_from_the_folder_of_the_file() {
        let mut settings = HeightfieldSettings::default();
        settings.source.field = "maps/h.png".into();
        let mut plan = Plan::new(settings);
        plan.look.sky.sky_file = "/skies/s.exr".into();
        plan.set_folder(Path::new("d"));
        for (file, field) in [
            ("d/a.png", "maps/h.png"),
            ("d/maps/a.png", "h.png"),
            ("a.png", "d/maps/h.png"),
            ("e/a.png", "../d/maps/h.png"),
        ] {
            let text = write_beside(&plan, Path::new(file));
            assert!(
                text.contains(&format!("field = \"{field}\"\n")),
                "{file}: {text}"
            );
            assert!(text.contains("sky_file = \"/skies/s.exr\""));
        }
    }
}
