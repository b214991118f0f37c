//! Files on disk, for the compiler.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
#[cfg(feature = "gpu")]
use std::sync::Arc;
use surefoot_compiler::Loader;
#[cfg(feature = "gpu")]
use surefoot_compiler::sampled::{Grid, Settings};
#[cfg(feature = "gpu")]
use surefoot_runtime::mesh::field;

/// Larger files are refused: a scene's text is smaller, and reading must not fill the memory. A mesh may be larger.
pub const LARGEST_FILE: u64 = 16 << 20;

/// Reads regular files of at most [`LARGEST_FILE`] bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct FileLoader;

impl Loader for FileLoader {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        read(Path::new(path))
    }

    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        read_up_to(Path::new(path), most)
    }

    #[cfg(feature = "gpu")]
    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        field::grid(self, path, settings, &|_| {})
    }
}

/// Where the system keeps what programs can make again. None where it does not say.
pub fn cache() -> Option<PathBuf> {
    let set = |name| std::env::var_os(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let base = if cfg!(windows) {
        set("LOCALAPPDATA")
    } else if cfg!(target_os = "macos") {
        set("HOME").map(|home| home.join("Library/Caches"))
    } else {
        // <https://specifications.freedesktop.org/basedir-spec/latest/>
        set("XDG_CACHE_HOME").or_else(|| set("HOME").map(|home| home.join(".cache")))
    };
    base.map(|base| base.join("surefoot"))
}

/// The bytes of a regular file, or why they can't be had, in plain words.
pub fn read(path: &Path) -> Result<Vec<u8>, String> {
    read_up_to(path, LARGEST_FILE)
}

/// The same of a file of at most so many bytes.
fn read_up_to(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    // What is not a regular file may block for ever (a pipe) or never end (/dev/zero), so it is not even opened.
    let known = std::fs::metadata(path).map_err(|error| words(&error))?;
    if known.is_dir() {
        return Err("this is a directory, not a file".to_owned());
    }
    if !known.is_file() {
        return Err("this is not a regular file".to_owned());
    }
    let too_large = || format!("the file is larger than {} MiB", most >> 20);
    if known.len() > most {
        return Err(too_large());
    }
    let file = File::open(path).map_err(|error| words(&error))?;
    let mut bytes = Vec::with_capacity(known.len() as usize);
    // The file may grow while it is read, or say that it is empty (as those of /proc do).
    file.take(most + 1).read_to_end(&mut bytes).map_err(|error| words(&error))?;
    if bytes.len() as u64 > most { Err(too_large()) } else { Ok(bytes) }
}

/// Writes a file as a whole: whoever reads it meanwhile sees the old bytes or the new ones, and a failure leaves the old ones.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    // A link stays a link: what it points to is replaced.
    let target = std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    // What is not a regular file (a pipe, /dev/null) can't be replaced, only written to.
    let known = std::fs::metadata(&target);
    if known.as_ref().is_ok_and(|known| !known.is_file()) {
        return std::fs::write(&target, bytes).map_err(|error| words(&error));
    }
    if known.as_ref().is_ok_and(|known| known.permissions().readonly()) {
        return Err("the file is write-protected".to_owned());
    }
    let beside = beside(&target);
    let done = std::fs::write(&beside, bytes)
        .and_then(|()| match &known {
            Ok(known) => std::fs::set_permissions(&beside, known.permissions()),
            Err(_) => Ok(()),
        })
        .and_then(|()| std::fs::rename(&beside, &target));
    let Err(error) = done else { return Ok(()) };
    // Nothing more can be done about a file that can't be removed either.
    std::fs::remove_file(&beside).ok();
    match error.kind() {
        // A folder that takes no new files may hold one that takes new bytes.
        ErrorKind::PermissionDenied if known.is_ok() => std::fs::write(&target, bytes).map_err(|error| words(&error)),
        ErrorKind::NotFound => Err("there is no such folder".to_owned()),
        _ => Err(words(&error)),
    }
}

/// The scenes in the folder of a scene, itself among them, by name.
#[cfg(feature = "gui")]
pub fn scenes_beside(scene: &str) -> Vec<String> {
    /// More are no list for a person.
    const MOST: usize = 1000;
    let folder = Path::new(scene).parent().unwrap_or(Path::new(""));
    // The name of a scene in the working directory has no folder before it.
    let place = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = std::fs::read_dir(place).into_iter().flatten().flatten();
    let is_scene = |path: &PathBuf| path.extension().is_some_and(|e| e == "sdf") && path.is_file();
    let paths = entries.filter_map(|entry| Some(folder.join(entry.file_name())).filter(is_scene));
    let mut names: Vec<String> = paths.take(MOST).map(|path| path.to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// What a folder holds for who looks for a scene: its folders, then its scenes, by name, each with whether it is a folder.
#[cfg(feature = "gui")]
pub fn listing(folder: &Path) -> Vec<(String, bool)> {
    /// More are no list for a person.
    const MOST: usize = 2000;
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(MOST);
    let known = entries.map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.path().is_dir()));
    let mut known: Vec<_> = known.filter(|(name, is_folder)| !name.starts_with('.') && (*is_folder || name.ends_with(".sdf"))).collect();
    known.sort_by_key(|(name, is_folder)| (!is_folder, name.to_lowercase()));
    known
}

/// A name for the new bytes in the same folder, so that renaming stays within one file system.
fn beside(path: &Path) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.new", std::process::id()))
}

/// An error of the operating system in plain words.
fn words(error: &std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "there is no such file".to_owned(),
        ErrorKind::PermissionDenied => "permission denied".to_owned(),
        ErrorKind::IsADirectory => "this is a directory, not a file".to_owned(),
        ErrorKind::StorageFull => "the disk is full".to_owned(),
        _ => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder =
            std::env::temp_dir().join(format!("surefoot-files-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn says_in_plain_words_why_a_file_cannot_be_read() {
        let folder = folder("words");
        assert_eq!(read(&folder.join("nowhere.sdf")), Err("there is no such file".to_owned()));
        assert_eq!(read(&folder), Err("this is a directory, not a file".to_owned()));
        let large = folder.join("large");
        File::create(&large).unwrap().set_len(LARGEST_FILE + 1).unwrap();
        assert_eq!(read(&large), Err("the file is larger than 16 MiB".to_owned()));
        if cfg!(unix) {
            assert_eq!(read(Path::new("/dev/zero")), Err("this is not a regular file".to_owned()));
        }
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    #[cfg(feature = "gui")]
    fn finds_the_scenes_of_a_folder() {
        let folder = folder("scenes");
        for name in ["b.sdf", "a.sdf", "c.wgsl"] {
            write(&folder.join(name), b"").unwrap();
        }
        std::fs::create_dir_all(folder.join("d.sdf")).unwrap();
        let name = |name: &str| folder.join(name).to_string_lossy().into_owned();
        assert_eq!(scenes_beside(&name("b.sdf")), [name("a.sdf"), name("b.sdf")]);
        assert_eq!(listing(&folder).iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["d.sdf", "a.sdf", "b.sdf"]);
        assert!(scenes_beside("no/such/folder/a.sdf").is_empty());
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn writes_as_a_whole_and_leaves_nothing_beside() {
        let folder = folder("write");
        let path = folder.join("a.wgsl");
        write(&path, b"one").unwrap();
        write(&path, b"two").unwrap();
        assert_eq!(read(&path), Ok(b"two".to_vec()));
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
        assert_eq!(write(&folder.join("no/such/folder.txt"), b""), Err("there is no such folder".to_owned()));
        let mut locked = std::fs::metadata(&path).unwrap().permissions();
        locked.set_readonly(true);
        std::fs::set_permissions(&path, locked).unwrap();
        assert_eq!(write(&path, b"three"), Err("the file is write-protected".to_owned()));
        assert_eq!(read(&path), Ok(b"two".to_vec()));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
