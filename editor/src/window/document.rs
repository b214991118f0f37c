//! A text that is edited, and what the disk holds meanwhile.

use std::time::{Duration, Instant};
use surefoot_compiler::syntax::has_carriage_returns;

/// How long a person must pause before what was typed is compiled.
pub const PAUSE: Duration = Duration::from_millis(120);

/// A text that is shown and, unless it belongs to the compiler, edited.
#[derive(Clone, Debug)]
pub struct Document {
    /// The path, as the compiler calls it.
    pub name: String,
    /// What a person sees. Lines end with `\n` alone.
    pub text: String,
    /// Whether it can't be edited: it comes with the compiler, or is no text.
    pub read_only: bool,
    /// What the disk holds, or held before the file went away, as far as this document has followed it.
    saved: String,
    /// Whether the file is gone.
    missing: bool,
    /// Whether there never was one: the text is new.
    fresh: bool,
    /// Why what the disk holds can't be read, where it can't.
    unreadable: Option<String>,
    /// What another program has put there while there were unsaved edits. A person decides.
    conflict: Option<String>,
    /// Whether most of the file's lines end with `\r\n`.
    carriage_returns: bool,
    /// When the text was last edited, until the compiler is given the edit.
    edited: Option<Instant>,
    /// Whether the compiler has a text from here that is not on the disk.
    pub lent: bool,
}

/// What the disk holds of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Disk {
    /// This text.
    Text(String),
    /// There is no such file.
    Gone,
    /// Something that is no text, or that can't be read, and why.
    Unreadable(String),
}

/// Ways out of a conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// Go on with the edits; saving will replace what is on the disk.
    KeepEdits,
    /// Show what is on the disk; undo brings the edits back.
    TakeFile,
}

impl Document {
    /// A text as it is on the disk.
    pub fn new(name: &str, text: &str) -> Self {
        let text_here = unix_lines(text);
        Self {
            name: name.to_owned(),
            carriage_returns: has_carriage_returns(text),
            saved: text_here.clone(),
            missing: false,
            fresh: false,
            unreadable: None,
            text: text_here,
            read_only: false,
            conflict: None,
            edited: None,
            lent: false,
        }
    }

    /// A file as the disk holds it. One that is no text is not edited, and never written.
    pub fn of(name: &str, disk: &Disk) -> Self {
        let mut document = Self::new(name, if let Disk::Text(text) = disk { text } else { "" });
        document.on_disk(disk);
        document
    }

    /// A new text, of which the disk holds nothing yet.
    pub fn fresh(name: &str, text: &str) -> Self {
        Self { fresh: true, missing: true, ..Self::new(name, text) }
    }

    /// A text that can't be edited.
    pub fn read_only(name: &str, text: &str) -> Self {
        Self { read_only: true, ..Self::new(name, text) }
    }

    /// The name without its folders.
    pub fn short_name(&self) -> &str {
        self.name.rsplit(['/', '\\']).next().unwrap_or(&self.name)
    }

    /// What the disk holds, as far as this document has followed it.
    pub fn saved(&self) -> &str {
        &self.saved
    }

    /// Whether the text differs from what is on the disk.
    pub fn is_unsaved(&self) -> bool {
        self.is_missing() || self.has_edits()
    }

    /// Whether the file is gone.
    pub fn is_missing(&self) -> bool {
        self.missing && !self.fresh
    }

    /// Whether there never was a file.
    pub fn is_fresh(&self) -> bool {
        self.fresh
    }

    /// Whether the disk does not hold the text.
    pub fn is_off_disk(&self) -> bool {
        self.missing || self.has_edits()
    }

    /// Why what the disk holds can't be read, where it can't. It is not written over unless a person says so.
    pub fn unreadable(&self) -> Option<&str> {
        self.unreadable.as_deref()
    }

    /// Whether the text can be edited.
    pub fn is_editable(&self) -> bool {
        !self.read_only && (self.unreadable.is_none() || !self.text.is_empty())
    }

    /// Whether there is something to save, and nothing to decide before.
    pub fn can_save(&self) -> bool {
        self.is_off_disk() && !self.read_only && !self.has_conflict()
    }

    fn has_edits(&self) -> bool {
        self.saved != self.text
    }

    /// Whether another program has changed the file under unsaved edits, and nobody has decided yet.
    pub fn has_conflict(&self) -> bool {
        self.conflict.is_some() || self.unreadable.is_some()
    }

    /// Takes an edit.
    pub fn edit(&mut self, text: String, now: Instant) {
        if self.is_editable() && self.text != text {
            self.text = text;
            self.edited = Some(now);
        }
    }

    /// Takes an edit of a hand that goes on: the compiler is given what there is now and then, and not only after a pause.
    pub fn edit_on(&mut self, text: String, now: Instant) {
        let before = self.edited;
        self.edit(text, now);
        self.edited = before.or(self.edited);
    }

    /// Takes an edit of a hand that holds a number: the compiler has the text with a slider in its place, and is given no other one.
    pub fn edit_held(&mut self, text: String, now: Instant) {
        self.edit(text, now);
        self.edited = None;
    }

    /// Hears that the compiler has what was edited.
    pub fn was_given(&mut self) {
        self.edited = None;
    }

    /// How long until the compiler should be given the edits; none where it has them.
    pub fn wait(&self, now: Instant) -> Option<Duration> {
        self.edited.map(|edited| PAUSE.saturating_sub(now.duration_since(edited)))
    }

    /// Whether there are edits that the compiler should be given now. They count as given.
    pub fn take_edits(&mut self, now: Instant) -> bool {
        let due = self.wait(now) == Some(Duration::ZERO);
        if due {
            self.edited = None;
        }
        due
    }

    /// Hears what the disk holds now. Answers whether the text shown became another one.
    pub fn on_disk(&mut self, disk: &Disk) -> bool {
        self.missing = *disk == Disk::Gone;
        self.fresh &= self.missing;
        self.unreadable = if let Disk::Unreadable(why) = disk { Some(why.clone()) } else { None };
        let Disk::Text(text) = disk else { return false };
        let new = unix_lines(text);
        if self.text == new || !self.has_edits() {
            let other = self.text != new;
            self.carriage_returns = has_carriage_returns(text);
            self.text.clone_from(&new);
            self.saved = new;
            self.conflict = None;
            return other;
        }
        self.conflict = (self.saved != new).then_some(new);
        false
    }

    /// Ends a conflict as a person has decided. Answers whether the text shown became another one.
    pub fn resolve(&mut self, resolution: Resolution) -> bool {
        if self.unreadable.is_some() && resolution == Resolution::KeepEdits {
            // Saving writes it anew.
            (self.unreadable, self.missing, self.fresh) = (None, true, false);
        }
        let Some(theirs) = self.conflict.take() else { return false };
        self.saved.clone_from(&theirs);
        if resolution == Resolution::TakeFile {
            self.text = theirs;
            self.edited = None;
            return true;
        }
        false
    }

    /// The bytes to write, with the file's own ends of lines.
    pub fn bytes(&self) -> Vec<u8> {
        if self.carriage_returns {
            self.text.replace('\n', "\r\n").into_bytes()
        } else {
            self.text.clone().into_bytes()
        }
    }

    /// Hears that the text was written.
    pub fn was_saved(&mut self) {
        self.saved.clone_from(&self.text);
        self.missing = false;
        self.fresh = false;
        self.unreadable = None;
        self.conflict = None;
    }
}

fn unix_lines(text: &str) -> String {
    text.replace("\r\n", "\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(text: &str) -> Disk {
        Disk::Text(text.to_owned())
    }

    #[test]
    fn without_edits_the_text_follows_the_disk() {
        let mut document = Document::new("a/b.sdf", "one");
        assert_eq!(document.short_name(), "b.sdf");
        assert!(document.on_disk(&text("two")));
        assert_eq!(document.text, "two");
        assert!(!document.is_unsaved());
        assert!(!document.on_disk(&text("two")));
    }

    #[test]
    fn edits_are_never_lost_to_the_disk() {
        let mut document = Document::new("a", "one");
        document.edit("mine".to_owned(), Instant::now());
        assert!(!document.on_disk(&text("theirs")));
        assert_eq!(document.text, "mine");
        assert!(document.has_conflict());
        let mut other = document.clone();

        assert!(!document.resolve(Resolution::KeepEdits));
        assert!(document.is_unsaved() && document.text == "mine");
        assert!(!document.on_disk(&text("theirs")), "what was decided is not asked again");
        assert!(!document.has_conflict());

        assert!(other.resolve(Resolution::TakeFile));
        assert!(!other.is_unsaved() && other.text == "theirs");
    }

    #[test]
    fn a_conflict_ends_where_both_become_the_same() {
        let mut document = Document::new("a", "one");
        document.edit("two".to_owned(), Instant::now());
        document.on_disk(&text("three"));
        document.on_disk(&text("two"));
        assert!(!document.has_conflict() && !document.is_unsaved());
        document.edit("four".to_owned(), Instant::now());
        document.on_disk(&text("five"));
        document.on_disk(&text("two"));
        assert!(
            !document.has_conflict() && document.is_unsaved(),
            "the disk holds again what was there before"
        );
    }

    #[test]
    fn a_file_that_is_gone_can_be_saved_again() {
        let mut document = Document::new("a", "one");
        document.on_disk(&Disk::Gone);
        assert!(document.is_unsaved() && document.is_missing());
        document.was_saved();
        assert!(!document.is_unsaved());
    }

    #[test]
    fn a_new_text_is_saved_and_asks_nothing_before_it_is_edited() {
        let mut document = Document::fresh("a", "scene");
        assert!(!document.is_unsaved() && document.can_save() && !document.is_missing());
        assert!(!document.on_disk(&Disk::Gone));
        document.edit("mine".to_owned(), Instant::now());
        assert!(document.is_unsaved());
        // Another program writes such a file meanwhile.
        document.on_disk(&text("theirs"));
        assert!(document.has_conflict() && !document.can_save());
        let mut document = Document::fresh("a", "scene");
        document.was_saved();
        assert!(!document.can_save() && !document.is_fresh());
    }

    #[test]
    fn a_save_that_removes_the_file_first_is_a_save() {
        let mut document = Document::new("a", "one");
        document.on_disk(&Disk::Gone);
        assert!(document.on_disk(&text("two")));
        assert!(document.text == "two" && !document.is_unsaved());
    }

    #[test]
    fn what_is_no_text_is_not_written_over() {
        let broken = || Disk::Unreadable("the text is not UTF-8".to_owned());
        let mut opened = Document::of("a", &broken());
        opened.edit("mine".to_owned(), Instant::now());
        assert!(opened.text.is_empty() && !opened.is_unsaved() && !opened.can_save() && !opened.is_missing());
        assert!(opened.on_disk(&text("one")) && opened.is_editable() && opened.text == "one");

        // Another program puts it there, under edits or not.
        let mut document = Document::new("a", "one");
        document.on_disk(&broken());
        document.edit("mine".to_owned(), Instant::now());
        assert!(document.text == "mine" && !document.can_save() && document.has_conflict());
        let mut other = document.clone();
        document.resolve(Resolution::KeepEdits);
        assert!(document.can_save());
        assert!(!other.on_disk(&text("one")) && other.can_save(), "what was broken is mended");
    }

    #[test]
    fn ends_of_lines_stay_as_they_are() {
        let mut document = Document::new("a", "one\r\ntwo\r\n");
        assert_eq!(document.text, "one\ntwo\n");
        document.edit("one\n".to_owned(), Instant::now());
        assert_eq!(document.bytes(), b"one\r\n");
    }

    #[test]
    fn the_compiler_waits_for_a_pause() {
        let start = Instant::now();
        let mut document = Document::new("a", "one");
        document.edit("two".to_owned(), start);
        assert!(!document.take_edits(start));
        assert!(document.take_edits(start + PAUSE));
        assert!(!document.take_edits(start + PAUSE));
    }

    #[test]
    fn the_compiler_sees_what_a_hand_goes_on_with() {
        let start = Instant::now();
        let mut document = Document::new("a", "0");
        for i in 1..=9u32 {
            document.edit_on(i.to_string(), start + PAUSE / 8 * i);
        }
        assert!(document.take_edits(start + PAUSE / 8 * 9));
    }
}
