//! What comes back when the program is started again: the window's layout, recent files, and of each scene its tabs, camera, sliders and timeline.
//!
//! All of it is one small file of JSON in the user's folder. Where it can't be read or written nothing is wrong: the window is as at first.

use super::theme::TEXT_SIZE;
use crate::files;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// It is written no more often than this.
const EVERY: Duration = Duration::from_secs(1);
/// So many recent files, scenes, and things of each.
pub const MOST: usize = 40;
/// A longer file is not read.
const LARGEST: usize = 1 << 20;

/// All that comes back.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct State {
    /// Scenes that were opened, the newest first.
    pub recent: Vec<String>,
    /// How the window looks.
    pub layout: Layout,
    /// What belongs to each scene, the newest first.
    pub scenes: Vec<SceneState>,
}

/// How the window looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Layout {
    /// Whether the panel of the text is open.
    pub source: bool,
    /// Whether that of the parameters is.
    pub parameters: bool,
    /// And that of the measures.
    pub measures: bool,
    /// And that of the scene's parts.
    pub outline: bool,
    /// And that of the module.
    pub shader: bool,
    /// And that of what frames take.
    pub frames: bool,
    /// How large the text is written, in points.
    pub text_size: f32,
    /// Whether its long lines are wrapped.
    pub wrap: bool,
    /// Whether the window is light; none where it is as the desktop.
    pub light: Option<bool>,
    /// How large all of it is.
    pub zoom: f32,
    /// How wide the panels at the left and right are, in points.
    pub widths: [f32; 2],
}

impl Default for Layout {
    fn default() -> Self {
        Self { source: true, parameters: true, measures: false, outline: false, shader: false, frames: false, text_size: TEXT_SIZE, wrap: false, light: Some(false), zoom: 1.0, widths: [470.0, 250.0] }
    }
}

/// What belongs to a scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SceneState {
    /// The scene's file, from the root.
    pub path: String,
    /// The other texts that are open.
    pub tabs: Vec<String>,
    /// Which text is shown.
    pub shown: usize,
    /// Where a hand left the camera: eye and target.
    pub camera: Option<[[f64; 3]; 2]>,
    /// The sliders that a hand moved: name, value, and what the text said.
    pub values: Vec<(String, Vec<f64>, Vec<f64>)>,
    /// Choices that a hand made.
    pub choices: Vec<(String, String)>,
    /// The timeline's length in seconds, and whether it loops, where a hand set them.
    pub timeline: Option<(f64, bool)>,
}

impl State {
    /// What a file holds; as at first where it holds nothing that can be read.
    pub fn read(file: &Path) -> Self {
        let text = files::read(file).ok().filter(|bytes| bytes.len() <= LARGEST).unwrap_or_default();
        let mut state: Self = serde_json::from_slice(&text).unwrap_or_default();
        state.recent.truncate(MOST);
        state.scenes.truncate(MOST);
        state
    }

    /// What is known of a scene.
    pub fn scene(&self, path: &str) -> Option<&SceneState> {
        let path = whole(path);
        self.scenes.iter().find(|scene| scene.path == path)
    }

    /// What is known of a scene is this, and it is the newest.
    pub fn put(&mut self, scene: SceneState) {
        self.scenes.retain(|known| known.path != scene.path);
        self.scenes.insert(0, scene);
        self.scenes.truncate(MOST);
    }

    /// Adds what another window has written meanwhile.
    fn join(&mut self, other: Self) {
        let recent = other.recent.into_iter().filter(|path| !self.recent.contains(path)).collect::<Vec<_>>();
        self.recent.extend(recent);
        self.recent.truncate(MOST);
        let scenes = other.scenes.into_iter().filter(|scene| !self.scenes.iter().any(|known| known.path == scene.path)).collect::<Vec<_>>();
        self.scenes.extend(scenes);
        self.scenes.truncate(MOST);
    }
}

/// What writes the file, for one window.
pub struct Keeper {
    file: Option<PathBuf>,
    /// What the file holds, as far as this window knows.
    pub state: State,
    at: Option<Instant>,
    writer: Option<JoinHandle<()>>,
}

impl Keeper {
    /// Reads a file, where there is one.
    pub fn of(file: Option<PathBuf>) -> Self {
        let state = file.as_deref().map(State::read).unwrap_or_default();
        Self { file, state, at: None, writer: None }
    }

    /// Writes what has changed since, as `take` says; answers after what time there is more to write.
    pub fn follow(&mut self, now: Instant, take: impl FnOnce(&mut State)) -> Option<Duration> {
        let file = self.file.as_ref()?;
        let mut state = self.state.clone();
        take(&mut state);
        if state == self.state {
            return None;
        }
        let wait = self.at.map_or(Duration::ZERO, |at| (at + EVERY).saturating_duration_since(now));
        if !wait.is_zero() || self.writer.as_ref().is_some_and(|writer| !writer.is_finished()) {
            return Some(wait.max(Duration::from_millis(50)));
        }
        self.at = Some(now);
        self.state.clone_from(&state);
        let file = file.clone();
        // Where there can be no thread nothing is kept.
        self.writer = std::thread::Builder::new().name("surefoot state".to_owned()).spawn(move || write(&file, state)).ok();
        None
    }

    /// Writes all of it now: the window closes.
    pub fn end(&mut self, take: impl FnOnce(&mut State)) {
        if let Some(writer) = self.writer.take() {
            let _ = writer.join();
        }
        if let Some(file) = self.file.take() {
            take(&mut self.state);
            write(&file, self.state.clone());
        }
    }
}

fn write(file: &Path, mut state: State) {
    state.join(State::read(file));
    let text = serde_json::to_vec_pretty(&state).unwrap_or_default();
    if let Some(folder) = file.parent().filter(|_| text.len() <= LARGEST) {
        // What can't be written is not there next time.
        let _ = std::fs::create_dir_all(folder).map_err(|error| error.to_string()).and_then(|()| files::write(file, &text));
    }
}

/// A path that does not depend on where the program was started.
pub fn whole(path: &str) -> String {
    std::path::absolute(path).map_or_else(|_| path.to_owned(), |path| path.to_string_lossy().into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_can_not_be_read_is_as_at_first() {
        let file = std::env::temp_dir().join(format!("surefoot-kept-{}.json", std::process::id()));
        for bytes in ["", "{", "[]", "{\"layout\":{\"text_size\":\"large\"}}", "{\"recent\":[\"a\"],\"layout\":null}"] {
            std::fs::write(&file, bytes).unwrap();
            assert_eq!(State::read(&file), State::default(), "{bytes}");
        }
        std::fs::write(&file, "{\"recent\":[\"a\"],\"more\":1}").unwrap();
        assert_eq!(State::read(&file).recent, ["a"]);
        std::fs::remove_file(&file).unwrap();
        assert_eq!(State::read(&file), State::default());
    }

    #[test]
    fn two_windows_keep_what_the_other_knows() {
        let named = |names: &[&str]| State { recent: names.iter().map(|name| (*name).to_owned()).collect(), ..State::default() };
        let mut mine = named(&["a", "b"]);
        mine.join(named(&["c", "b"]));
        assert_eq!(mine.recent, ["a", "b", "c"]);
    }
}
