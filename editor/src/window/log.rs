//! What happens, one JSON object a line, for whoever measures the window from outside.

use serde_json::{Value, json};
use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

/// Where the lines go; nowhere, unless it was made by [`Log::to`]. Copies write to the same file.
#[derive(Clone, Debug, Default)]
pub struct Log {
    file: Option<Arc<Mutex<File>>>,
}

impl Log {
    /// Appends to a file.
    pub fn to(path: &Path) -> Result<Self, String> {
        let file = File::options()
            .create(true)
            .append(true)
            .open(path)
            .map_err(|error| error.to_string())?;
        Ok(Self { file: Some(Arc::new(Mutex::new(file))) })
    }

    /// Writes a line: the event's name, the moment in seconds since 1970, and what there is to say.
    pub fn event(&self, name: &str, entries: Value) {
        let Some(file) = &self.file else { return };
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let mut line = json!({ "event": name, "at": now.as_secs_f64() });
        if let (Some(line), Value::Object(entries)) = (line.as_object_mut(), entries) {
            line.extend(entries);
        }
        let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
        // Losing a line of the log is no reason to disturb who works in the window.
        writeln!(file, "{line}").ok();
    }
}
