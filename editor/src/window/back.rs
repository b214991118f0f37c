//! What of a session comes back when the program is started again, and how it does.

use super::kept::{Layout, MOST, SceneState, State, whole};
use super::session::{Session, Timeline};
use super::theme::Choice;

/// Takes what a session is like now.
pub fn take(state: &mut State, session: &Session) {
    let open = &session.open;
    // What is only looked at leaves no trace.
    if open.alone {
        return;
    }
    state.recent.clone_from(&session.recent);
    state.recent.truncate(MOST);
    state.layout = Layout {
        source: open.source,
        parameters: open.parameters,
        measures: open.measures,
        outline: open.outline,
        shader: open.shader,
        frames: open.frames,
        text_size: open.text_size,
        wrap: open.wrap,
        light: match open.theme {
            Choice::Dark => Some(false),
            Choice::Light => Some(true),
            Choice::System => None,
        },
        zoom: open.zoom,
        widths: open.widths,
    };
    // What waits to be brought back is not yet there.
    let waits = session.restoring.is_some() || session.documents.all.first().is_some_and(|document| document.is_fresh());
    if !waits {
        state.put(scene(session));
    }
}

fn scene(session: &Session) -> SceneState {
    let all = &session.documents.all;
    let moved = session.scene().into_iter().flat_map(|scene| &scene.parameters).filter(|p| session.is_moved(p));
    SceneState {
        path: all.first().map(|document| whole(&document.name)).unwrap_or_default(),
        tabs: all.iter().skip(1).filter(|document| !document.read_only).map(|document| document.name.clone()).take(MOST).collect(),
        shown: session.documents.shown,
        camera: session.look.orbit.as_ref().map(|orbit| orbit.camera()).map(|camera| [camera.eye, camera.target]),
        values: moved.filter_map(|p| Some((p.name.clone(), session.stage.value(p)?.to_vec(), p.default.clone()))).take(4 * MOST).collect(),
        choices: session.options.choose.iter().take(MOST).cloned().collect(),
        timeline: Some(session.timeline).filter(|timeline| *timeline != Timeline::default()).map(|Timeline { length, loops }| (length, loops)),
    }
}

/// Gives the window a look.
pub fn give(layout: &Layout, session: &mut Session) {
    let open = &mut session.open;
    (open.source, open.parameters, open.measures, open.wrap) = (layout.source, layout.parameters, layout.measures, layout.wrap);
    (open.outline, open.shader, open.frames) = (layout.outline, layout.shader, layout.frames);
    open.text_size = layout.text_size.clamp(7.0, 40.0);
    open.zoom = layout.zoom.clamp(0.5, 3.0);
    open.widths = layout.widths.map(|width| width.clamp(100.0, 2000.0));
    open.theme = match layout.light {
        Some(false) => Choice::Dark,
        Some(true) => Choice::Light,
        None => Choice::System,
    };
}
