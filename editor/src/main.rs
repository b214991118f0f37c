//! The program `surefoot`: command line and live editor for signed distance fields.

use std::process::ExitCode;

mod animation;
mod command;
mod files;
mod marched;
mod measures;
mod meshes;
mod picture;
mod texts;
#[cfg(feature = "gui")]
mod window;

fn main() -> ExitCode {
    quiet_drivers();
    #[cfg(feature = "gpu")]
    if let Some(folder) = files::cache() {
        surefoot_runtime::mesh::field::keep_in(folder.join("grids"));
    }
    command::run()
}

/// Drivers write to the standard error what is no concern of who has no desktop: Mesa's layer that chooses a device asks Wayland where none can be, and
/// libEGL tells of each driver that it tries in vain. What a person has set stays.
fn quiet_drivers() {
    let is_set = |name: &str| std::env::var_os(name).is_some();
    let wayland = is_set("XDG_RUNTIME_DIR") || is_set("WAYLAND_SOCKET");
    for (name, value, wanted) in [("NODEVICE_SELECT", "1", !wayland), ("EGL_LOG_LEVEL", "fatal", true)] {
        if wanted && !is_set(name) {
            // SAFETY: nothing else runs yet.
            #[allow(unsafe_code)]
            unsafe {
                std::env::set_var(name, value);
            }
        }
    }
}
