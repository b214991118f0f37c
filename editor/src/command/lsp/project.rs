//! The files of a workspace, and the prelude as files that an editor can open.

use crate::files;
use std::path::{Path, PathBuf};
use surefoot_compiler::prelude::{PARTS, PRELUDE};

/// More scenes than these are not looked at.
const MOST_FILES: usize = 1000;
/// More folders within each other, and more entries, neither.
const MOST_DEEP: usize = 8;
const MOST_ENTRIES: usize = 50_000;

/// The scenes in some folders and below, in order.
pub(super) fn scenes(folders: &[String]) -> Vec<String> {
    let (mut found, mut seen) = (Vec::new(), 0);
    for folder in folders {
        walk(Path::new(folder), 0, &mut seen, &mut found);
    }
    found.sort();
    found.dedup();
    found
}

fn walk(folder: &Path, depth: usize, seen: &mut usize, found: &mut Vec<String>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    let mut entries: Vec<_> = entries.flatten().collect();
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        *seen += 1;
        if *seen > MOST_ENTRIES || found.len() >= MOST_FILES {
            return;
        }
        let (path, name) = (entry.path(), entry.file_name());
        let name = name.to_string_lossy();
        let Ok(kind) = entry.file_type() else { continue };
        if kind.is_dir() {
            // What is hidden, built or installed is nothing that a person wrote.
            if depth < MOST_DEEP && !name.starts_with('.') && !matches!(&*name, "target" | "node_modules" | "out") {
                walk(&path, depth + 1, seen, found);
            }
        } else if name.ends_with(".sdf") {
            found.push(path.to_string_lossy().replace('\\', "/"));
        }
    }
}

/// The folder in which the prelude's texts stand for editors.
fn prelude_folder() -> PathBuf {
    files::cache().unwrap_or_else(std::env::temp_dir).join("prelude")
}

/// Whether a path is one of the prelude's texts.
pub(super) fn is_of_prelude(path: &str) -> bool {
    Path::new(path).starts_with(prelude_folder())
}

/// The path of a text of the prelude, which is written if it does not stand there as it is. None where it can't be.
pub(super) fn prelude_file(name: &str) -> Option<String> {
    let (_, text) = PRELUDE.iter().chain(PARTS).find(|(known, _)| *known == name)?;
    // `<prelude>/noise.sdf`, and `std/noise.sdf` below the same folder.
    let path = prelude_folder().join(name.trim_start_matches("<prelude>/").replace(['<', '>'], ""));
    if std::fs::read(&path).map_or(true, |known| known != text.as_bytes()) {
        std::fs::create_dir_all(path.parent()?).ok()?;
        // An older one may be there, which nobody may write.
        std::fs::remove_file(&path).ok();
        files::write(&path, text.as_bytes()).ok()?;
        let mut rights = std::fs::metadata(&path).ok()?.permissions();
        rights.set_readonly(true);
        std::fs::set_permissions(&path, rights).ok()?;
    }
    Some(path.to_string_lossy().replace('\\', "/"))
}
