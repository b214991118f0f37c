//! Grids on the disk, each by a number of what it was made of: in one folder, which is bounded in size.

use siphasher::sip128::{Hasher128, SipHasher13};
use std::fs::{self, File};
use std::hash::Hasher;
use std::io::Read;
use std::path::PathBuf;
use std::time::SystemTime;
use surefoot_compiler::sampled::Grid;

/// Bytes of the hash before a grid's own.
const SUM: usize = 16;

/// A folder of grids. What goes wrong with it goes unsaid: what is not there is made.
#[derive(Debug)]
pub(super) struct Shelf {
    /// It holds nothing else.
    pub folder: PathBuf,
    /// The most bytes that all of it takes.
    pub most: u64,
}

impl Shelf {
    fn path(&self, key: u128) -> PathBuf {
        self.folder.join(format!("{key:032x}.grid"))
    }

    /// The grid of a number, where it is there and whole.
    pub fn find(&self, key: u128) -> Option<Grid> {
        let file = File::options().read(true).write(true).open(self.path(key)).ok()?;
        let mut bytes = Vec::new();
        (&file).take(self.most).read_to_end(&mut bytes).ok()?;
        let (known, bytes) = bytes.split_at_checked(SUM)?;
        if known != sum(bytes) {
            return None;
        }
        // The time says when it was last of use.
        file.set_modified(SystemTime::now()).ok();
        Grid::from_bytes(bytes).ok()
    }

    /// Keeps a grid. Those that were of no use for longest make room.
    pub fn put(&self, key: u128, grid: &Grid) {
        let bytes = grid.to_bytes();
        let beside = self.path(key).with_extension(format!("{}.new", std::process::id()));
        let write = || {
            fs::create_dir_all(&self.folder)?;
            fs::write(&beside, [&sum(&bytes)[..], &bytes].concat())?;
            fs::rename(&beside, self.path(key))
        };
        if write().is_err() {
            fs::remove_file(&beside).ok();
        }
        self.make_room();
    }

    fn make_room(&self) {
        let files = fs::read_dir(&self.folder).into_iter().flatten().flatten().filter_map(|entry| {
            let known = entry.metadata().ok().filter(|known| known.is_file())?;
            Some((known.modified().ok()?, known.len(), entry.path()))
        });
        let mut files: Vec<_> = files.collect();
        files.sort();
        let mut size: u64 = files.iter().map(|(_, size, _)| size).sum();
        for (_, own, path) in files {
            if size <= self.most {
                break;
            }
            fs::remove_file(path).ok();
            size -= own;
        }
    }
}

fn sum(bytes: &[u8]) -> [u8; SUM] {
    let mut hasher = SipHasher13::new();
    hasher.write(bytes);
    hasher.finish128().as_u128().to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;
    use surefoot_compiler::sampled::{Settings, Sign, Surface, bake};

    /// A shelf that has room for so many grids, and a grid.
    fn shelf(name: &str, grids: u64) -> (Shelf, Grid) {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let surface = Surface::new(&corners, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], Sign::Auto).unwrap();
        let grid = bake(&surface, Settings { resolution: 16, padding: 0.1 }, &|_| {}).unwrap();
        let folder = std::env::temp_dir().join(format!("surefoot-shelf-{}-{name}", std::process::id()));
        let most = grids * (SUM + grid.to_bytes().len()) as u64;
        (Shelf { folder, most }, grid)
    }

    #[test]
    fn what_was_put_is_found_and_what_is_broken_is_not() {
        let (shelf, grid) = shelf("found", 4);
        assert_eq!(shelf.find(7), None);
        shelf.put(7, &grid);
        assert_eq!(shelf.find(7), Some(grid));
        assert_eq!(shelf.find(8), None);
        let bytes = fs::read(shelf.path(7)).unwrap();
        for (at, length) in [(3, bytes.len()), (SUM + 70, bytes.len()), (0, bytes.len() - 1), (0, SUM), (0, 3), (0, 0)] {
            let mut broken = bytes[..length].to_vec();
            broken.iter_mut().skip(at).take(1).for_each(|byte| *byte ^= 1);
            fs::write(shelf.path(7), broken).unwrap();
            assert_eq!(shelf.find(7), None, "{at} {length}");
        }
        fs::remove_dir_all(shelf.folder).unwrap();
    }

    #[test]
    fn what_was_of_no_use_for_longest_makes_room() {
        let (shelf, grid) = shelf("room", 3);
        for key in 1..=3 {
            shelf.put(key, &grid);
            let file = File::options().write(true).open(shelf.path(key)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(1000 - key as u64)).unwrap();
        }
        assert!(shelf.find(1).is_some());
        shelf.put(4, &grid);
        let found = [1, 2, 3, 4].map(|key| shelf.find(key).is_some());
        assert_eq!(found, [true, false, true, true]);
        // One that is larger than all of the room is not kept.
        let small = Shelf { most: 100, ..shelf };
        small.put(5, &grid);
        assert_eq!(fs::read_dir(&small.folder).unwrap().count(), 0);
        fs::remove_dir_all(small.folder).unwrap();
    }

    #[test]
    fn a_folder_that_cannot_be_is_no_failure() {
        let (shelf, grid) = shelf("nowhere", 1);
        fs::write(&shelf.folder, "a file").unwrap();
        shelf.put(1, &grid);
        assert_eq!(shelf.find(1), None);
        fs::remove_file(shelf.folder).unwrap();
    }
}
