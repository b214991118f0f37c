//! The one function that does what is asked of the session.

use crate::window::command::{Answer, Command, DROP};
use crate::window::examples::TEMPLATE;
use crate::window::export::{Scene, Wanted};
use crate::window::kept;
use crate::window::document::{Disk, Document, Resolution};
use crate::window::holding::{self, Holding, Number};
use crate::window::looking::Asked;
use crate::window::orbit::Orbit;
use crate::window::recovery::{Found, Recovery};
use crate::window::session::{PathAsked, Purpose, Question, Session, Timeline, factors, problems};
use crate::window::world::World;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_compiler::diagnostic::Severity;
use surefoot_compiler::language_service::Shown;
use surefoot_compiler::outlook::is_blind;
use surefoot_compiler::physics::{Ball, State};
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::source::FileId;
use surefoot_compiler::syntax::{self, revise};
use surefoot_compiler::section::{Across, Section};
use surefoot_compiler::vector::{add, dot, length, scale, sub};
use surefoot_runtime::{Physics, Showing};
use surefoot_runtime::live::{Update, Words};

/// A picture as it is asked for at first.
const PICTURE: Wanted = Wanted { size: (1920, 1080), each: false };

/// Does what is asked.
pub fn apply(session: &mut Session, world: &mut World, command: Command) {
    match command {
        Command::Edit(text) => session.documents.current_mut().edit(text, Instant::now()),
        Command::EditOn(text) => session.documents.current_mut().edit_on(text, Instant::now()),
        Command::HoldNumber(number) => hold_number(session, world, &number),
        Command::DragNumber { text, number } => drag_number(session, world, text, &number),
        Command::LetNumberGo => let_number_go(session, world),
        Command::Save => {
            let shown = session.documents.shown;
            // What must be decided before is asked above the text.
            session.open.source |= !save(session, world, shown) && session.notice.is_none();
        }
        Command::SaveAs(path) => save_as(session, world, &path),
        Command::SavePicture(path) => {
            let wanted = session.asked.take().map_or(PICTURE, |asked| asked.wanted);
            if let (Some(compiled), Some(live)) = (session.scene().cloned(), session.stage.live().cloned()) {
                let live = Live { section: session.look.cut(), ..live };
                let moved = session.look.orbit.as_ref().map(Orbit::camera);
                let (camera, view, length) = (session.look.camera.clone(), session.look.mode, session.timeline.length);
                session.export.begin(Scene { compiled, live, moved, camera, view, length }, wanted, path, world.waker());
            }
        }
        Command::Picture(wanted) => {
            if let Some(asked) = &mut session.asked {
                asked.wanted = wanted;
            }
        }
        Command::CancelPicture => session.export.cancel(),
        Command::ToSliders(wanted) => session.open.to_sliders = wanted,
        Command::AskPath(purpose) => match purpose {
            Some(purpose) => ask_path(session, purpose),
            None => session.asked = None,
        },
        Command::LookInto(folder) => look_into(session, &folder),
        Command::TypePath(typed) => {
            if let Some(asked) = &mut session.asked {
                asked.typed = typed;
            }
        }
        Command::New => new(session, world, "untitled", TEMPLATE),
        Command::OpenExample(example) => new(session, world, example.name, example.text),
        Command::ShowStart(open) => session.open.start = open,
        Command::ShowKeys(open) => session.open.keys = open,
        Command::Theme(choice) => session.open.theme = choice,
        Command::Zoom(zoom) => session.open.zoom = zoom.clamp(0.5, 3.0),
        Command::Widths(widths) => session.open.widths = widths,
        Command::Format => format(session),
        Command::Resolve(resolution) => {
            if session.documents.current_mut().resolve(resolution) {
                take_back(session.documents.current_mut(), world);
            }
        }
        Command::KeepBoth => keep_both(session, world),
        Command::Recover { file, keep } => recover(session, world, &file, keep),
        Command::Show(file) => show(session, world, &file),
        Command::Turnover { forth } => {
            let count = session.documents.all.len();
            session.documents.shown = (session.documents.shown + if forth { 1 } else { count - 1 }) % count;
            session.documents.focus = true;
        }
        Command::CloseText(name) => {
            if session.documents.find(&name).and_then(|i| session.documents.all.get(i)).is_some_and(Document::is_unsaved) {
                session.question = Some(Question::CloseText(name));
            } else {
                close_text(session, world, &name);
            }
        }
        Command::TextSize(size) => session.open.text_size = size.clamp(7.0, 40.0),
        Command::Wrap(wrap) => session.open.wrap = wrap,
        Command::Jump(place) => {
            show(session, world, &place.file);
            session.open.source = true;
            session.documents.jump = Some(place);
        }
        Command::Mend(mend) => {
            show(session, world, &mend.file);
            session.documents.focus = true;
            let document = session.documents.current_mut();
            if let Some(text) = mend.made(&document.text).filter(|_| document.name == mend.file && document.is_editable()) {
                document.edit(text, Instant::now());
            }
        }
        Command::Rewrite(texts) => {
            let shown = session.documents.shown;
            for (file, text) in texts {
                show(session, world, &file);
                let document = session.documents.current_mut();
                if document.name == file && document.is_editable() {
                    document.edit(text, Instant::now());
                }
            }
            session.documents.shown = shown;
        }
        Command::Search(wanted) => {
            session.open.source |= wanted.is_some();
            session.search = wanted;
        }
        Command::Jumped => session.documents.jump = None,
        Command::Focus => session.documents.focus = true,
        Command::Focused => session.documents.focus = false,
        Command::Set(name, value) => {
            session.stage.set(&name, &value);
        }
        Command::Choose(name, choice) => {
            session.options.choose.retain(|(known, _)| *known != name);
            session.options.choose.push((name, choice));
            world.live.set_options(session.options.clone());
        }
        Command::Reset(name) => reset(session, world, &name),
        Command::ResetAll => {
            let names = |p: &surefoot_compiler::compiled::Parameter| p.name.clone();
            let all: Vec<_> =
                session.scene().iter().flat_map(|s| s.parameters.iter().map(names)).collect();
            for name in all {
                reset(session, world, &name);
            }
        }
        Command::KeepValues => {
            let moved = session.moved();
            revise(session, |text| revise::parameters(text, &moved));
        }
        Command::Play(playing) => session.stage.playing = playing,
        Command::Time(seconds) => {
            session.stage.set_time(seconds);
            if seconds == 0.0 {
                session.stage.reset_balls();
            }
        }
        Command::Timeline(timeline) => session.timeline = timeline,
        Command::StepBalls => session.stage.step_balls(),
        Command::ResetBalls => session.stage.reset_balls(),
        Command::DropBalls { at, size } => drop_balls(session, at, size),
        Command::TakeBall { at, size } => take_ball(session, at, size),
        Command::PullBall { at, size } => pull_ball(session, at, size),
        Command::ThrowBall { speed } => throw_ball(session, speed),
        Command::Pick { at, size } => pick(session, at, size),
        Command::Unpick => session.looking.found = None,
        Command::ShowRay(open) => session.open.ray = open,
        Command::ChooseStep(step) => session.looking.chosen = Some(step),
        Command::Closer(step) => session.looking.closer(step),
        Command::Turn(right, down) => move_camera(session, |orbit| orbit.turn(right, down)),
        Command::Pan(right, down) => move_camera(session, |orbit| orbit.pan(right, down)),
        Command::Dolly(factor) => move_camera(session, |orbit| orbit.dolly(factor)),
        Command::LookFrom(side) => move_camera(session, |orbit| orbit.look_from(side)),
        Command::FrameSelection => frame_selection(session),
        Command::Slice(at) => session.stage.set_slice(at),
        Command::ShowSection(cuts) => show_section(session, world, cuts),
        Command::Section(section) => cut(session, world, section),
        Command::Beside(mode) => {
            session.look.beside = mode;
            world.live.show(session.look.showing());
        }
        Command::Divide(share) => {
            session.look.divider = share.clamp(0.0, 1.0);
            session.stage.divide(session.look.divider);
        }
        Command::ShowTruth(true) => session.truth.open = true,
        Command::ShowTruth(false) => session.truth.close(),
        Command::Home => session.look.orbit = None,
        Command::KeepView => keep_view(session),
        Command::Camera(name) => {
            session.look.orbit = None;
            session.look.camera = Some(name);
        }
        Command::Mode(mode) => {
            session.look.mode = mode;
            world.live.show(session.look.showing());
        }
        Command::ShowSource(open) => session.open.source = open,
        Command::ShowParameters(open) => session.open.parameters = open,
        Command::ShowMeasures(open) => session.open.measures = open,
        Command::ShowOutline(open) => {
            session.open.outline = open;
            if session.parts.ask(open) {
                world.live.again();
            }
        }
        Command::ShowShader(open) => session.open.shader = open,
        Command::ShowFrames(open) => session.open.frames = open,
        Command::ShowGrid(open) => session.open.grid = open,
        Command::Hide(id, hidden) => {
            let mut shown = session.parts.shown();
            match hidden {
                true => shown.hidden.insert(id),
                false => shown.hidden.remove(&id),
            };
            show_parts(session, world, shown);
        }
        Command::Solo(solo) => {
            let shown = Shown { solo, ..session.parts.shown() };
            show_parts(session, world, shown);
        }
        Command::ShowAllParts => show_parts(session, world, Shown::default()),
        Command::MeasurePasses => {
            let size = session.meter.size;
            if let (Some(gpu), Some(scene), Some(live)) = (world.gpu(), session.scene().cloned(), session.stage.live().cloned()) {
                session.passes.begin(gpu, &scene, &live, Showing { beside: None, ..session.look.showing() }, size, world.waker());
            }
        }
        Command::Parallel(parallel) => {
            move_camera(session, |orbit| orbit.parallel = parallel);
            let is_drawn = session.scene().is_some_and(|scene| scene.blocks.parallel);
            if session.parts.let_parallel(parallel || is_drawn) {
                world.live.again();
            }
        }
        Command::Measure { walls } => {
            if let Some((scene, live)) = session.stage.scene().zip(session.stage.live()) {
                session.measuring.begin(scene, live, walls);
            }
        }
        Command::Open(path) => {
            if session.is_unsaved() {
                session.asked = None;
                session.question = Some(Question::Open(path));
            } else {
                open(session, world, &path);
            }
        }
        Command::Answer(answer) => self::answer(session, world, answer),
        Command::Dismiss => session.notice = None,
        Command::Arrived(update) => arrived(session, world, *update),
        // Of a text with a slider that nobody has written there is nothing to say.
        Command::Said(words) if holding::is_of_one(&words) => {}
        Command::Said(words) => said(session, words),
        Command::OnDisk(name, disk) => on_disk(session, world, &name, &disk),
        Command::Drawn(error) => session.said.drawing = error,
    }
}

/// Cuts the picture open, at first through the middle of what the camera looks at and on the side of the eye.
fn show_section(session: &mut Session, world: &World, cuts: bool) {
    session.look.cuts = cuts;
    let first = || {
        let camera = session.camera()?;
        let forward = Basis::of(&camera).forward;
        let axes = [Across::X, Across::Y, Across::Z].into_iter().zip(forward);
        let (across, _) = axes.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()))?;
        Some(Section::through(across, &camera))
    };
    match session.look.section.or_else(first) {
        Some(section) => cut(session, world, section),
        // There is nothing yet that it could cut.
        None => session.look.cuts = false,
    }
}

/// Cuts it open by a plane. Where that is moves nothing but a uniform.
fn cut(session: &mut Session, world: &World, section: Section) {
    session.look.section = Some(section);
    session.stage.set_section(Some(section));
    world.live.show(session.look.showing());
}

/// Draws the scene with these of its parts.
fn show_parts(session: &Session, world: &World, shown: Shown) {
    if session.parts.shown() != shown {
        session.parts.show(shown);
        world.live.again();
    }
}

/// A new scene, where no edits are lost by it.
fn new(session: &mut Session, world: &mut World, stem: &str, text: &str) {
    if session.is_unsaved() {
        session.question = Some(Question::New(stem.to_owned(), text.to_owned()));
    } else {
        begin(session, world, stem, text);
    }
}

/// Writes a text; answers whether the disk holds it now.
fn save(session: &mut Session, world: &mut World, index: usize) -> bool {
    let Some(document) = session.documents.all.get_mut(index) else { return true };
    if document.read_only || !document.is_off_disk() {
        return true;
    }
    // The disk may have changed a moment ago, and nobody has said so yet.
    document.on_disk(&world.read(&document.name));
    if document.has_conflict() {
        session.documents.shown = index;
        return false;
    }
    match crate::files::write(Path::new(&document.name), &document.bytes()) {
        Ok(()) => {
            document.was_saved();
            take_back(document, world);
            if index == 0 {
                let path = document.name.clone();
                note_recent(session, &path);
            }
            true
        }
        Err(why) => {
            session.notice = Some(format!("{} can't be written: {why}", document.name));
            false
        }
    }
}

/// Ends what was left behind of the text that is shown. A text that is taken can be undone.
fn recover(session: &mut Session, world: &mut World, file: &Path, keep: bool) {
    let Some(at) = session.found.iter().position(|found| found.file == file) else { return };
    if keep {
        match Recovery::read(&session.found[at]) {
            Ok(text) => session.documents.current_mut().edit(text, Instant::now()),
            Err(why) => {
                session.notice = Some(format!("The unsaved text can't be read: {why}."));
                return;
            }
        }
        // It lies there under this window's name before the other one goes.
        world.keep_unsaved(session);
    }
    if let Some(at) = session.found.iter().position(|found| found.file == file) {
        world.recovery.remove(&session.found.remove(at));
    }
}

/// The compiler reads the disk again.
fn take_back(document: &mut Document, world: &mut World) {
    if document.lent {
        document.lent = false;
        world.live.set_text(&document.name, None);
    }
}

fn format(session: &mut Session) {
    let document = session.documents.current_mut();
    match syntax::format(&document.text) {
        Ok(text) => document.edit(text, Instant::now()),
        // The errors are in the list of problems already.
        Err(_) => {
            session.notice = Some("a text with errors can't be laid out".to_owned());
        }
    }
}

/// Changes the scene's own text, as an edit that can be undone, and shows it.
fn revise(session: &mut Session, change: impl FnOnce(&str) -> String) {
    session.documents.shown = 0;
    let document = session.documents.current_mut();
    let is_whole = syntax::parse(FileId(0), &document.text).1.is_empty();
    if is_whole && document.is_editable() {
        let text = change(&document.text);
        document.edit(text, Instant::now());
    } else {
        session.notice = Some("nothing is written into a text that can't be read as a scene".to_owned());
    }
}

/// Writes where the orbiting camera stands into the scene's text.
fn keep_view(session: &mut Session) {
    let Some(camera) = session.look.orbit.map(|orbit| orbit.camera()) else { return };
    let away = length(sub(camera.eye, camera.target));
    // A thousandth of the way to what it looks at is a pixel or so.
    let decimals = (3.0 - away.max(1e-9).log10()).round().clamp(0.0, 9.0) as usize;
    let point = |place: [f64; 3]| {
        let numbers = place.map(|c| (format!("{c:.decimals$}").parse::<f64>().unwrap_or(c) + 0.0).to_string());
        format!("({})", numbers.join(", "))
    };
    let mut entries = vec![("eye", point(camera.eye)), ("target", point(camera.target))];
    // Its angle nobody moves.
    if session.scene().is_some_and(|scene| scene.blocks.cameras.is_empty()) {
        entries.push(("fov", format!("{:.1}deg", camera.fov.to_degrees())));
    }
    let name = session.look.camera.clone();
    revise(session, |text| revise::camera(text, name.as_deref(), &entries));
}

/// Writes the edits as `name.mine.sdf`, then shows what is on the disk.
fn keep_both(session: &mut Session, world: &mut World) {
    let document = session.documents.current_mut();
    let stem = document.name.strip_suffix(".sdf").unwrap_or(&document.name);
    let free = |n: u32| match n {
        1 => format!("{stem}.mine.sdf"),
        n => format!("{stem}.mine{n}.sdf"),
    };
    let name = (1..).map(free).find(|name| !Path::new(name).exists()).unwrap_or_default();
    match crate::files::write(Path::new(&name), &document.bytes()) {
        Ok(()) => {
            if document.resolve(Resolution::TakeFile) {
                take_back(document, world);
            }
            session.notice = Some(format!("the edits are in {name}"));
        }
        Err(why) => session.notice = Some(format!("{name} can't be written: {why}")),
    }
}

/// Shows a text, and opens it where it is not open yet.
fn show(session: &mut Session, world: &mut World, file: &str) {
    if let Some(index) = session.documents.find(file) {
        session.documents.shown = index;
        return;
    }
    // What belongs to the compiler is not on the disk; its words hold the text.
    let own = file.starts_with('<');
    let sources = &session.said.words.sources;
    let known = sources.iter().find(|(_, f)| f.name == file).map(|(_, f)| f.text.clone());
    let document = match (world.read(file), known) {
        (Disk::Text(text), _) if !own => Document::new(file, &text),
        (_, Some(text)) if own => Document::read_only(file, &text),
        (Disk::Unreadable(why), _) => {
            session.notice = Some(format!("{file} can't be read: {why}"));
            return;
        }
        (Disk::Gone, _) => {
            session.notice = Some(format!("{file} is not there"));
            return;
        }
        (Disk::Text(_), _) => return,
    };
    if !document.read_only {
        world.follow(file);
    }
    session.documents.all.push(document);
    session.documents.shown = session.documents.all.len() - 1;
}

/// Closes a text that is not the scene's own. What was edited and not saved is lost.
fn close_text(session: &mut Session, world: &mut World, name: &str) {
    let Some(index) = session.documents.find(name).filter(|index| *index > 0) else { return };
    let mut document = session.documents.all.remove(index);
    take_back(&mut document, world);
    world.unfollow(name);
    if session.documents.shown >= index {
        session.documents.shown -= 1;
    }
    session.documents.focus = true;
}

fn reset(session: &mut Session, world: &mut World, name: &str) {
    let Some(parameter) = session.parameter(name) else { return };
    if parameter.first.is_some() {
        let default = parameter.default.clone();
        session.stage.set(name, &default);
    } else if session.options.choose.iter().any(|(known, _)| known == name) {
        session.options.choose.retain(|(known, _)| known != name);
        world.live.set_options(session.options.clone());
    }
}

fn move_camera(session: &mut Session, change: impl FnOnce(&mut Orbit)) {
    if let Some(camera) = session.camera() {
        let orbit = session.look.orbit.get_or_insert_with(|| Orbit::from_camera(&camera));
        change(orbit);
    }
}

/// Comes nearer to what was picked; where nothing was, so far away that the whole solid is seen.
fn frame_selection(session: &mut Session) {
    let picked = session.looking.point().filter(|_| session.looking.is_of(session.scene(), session.stage.live()));
    let solid = session.scene().and_then(|scene| scene.functions.ahead.solid).filter(|solid| solid.0.iter().all(|side| side.is_finite()));
    match (picked, solid) {
        (Some(point), _) => move_camera(session, |orbit| orbit.frame(point, None)),
        (None, Some(solid)) => {
            let half = solid.0.map(|side| 0.5 * side.width());
            let middle = solid.0.map(|side| 0.5 * (side.lo + side.hi));
            move_camera(session, |orbit| orbit.frame(middle, Some(length(half))));
        }
        (None, None) => session.look.orbit = None,
    }
}

/// The ray of a place of the picture, and how the camera stands.
fn ray_at(session: &Session, at: [f64; 2], size: [u32; 2]) -> Option<(Ray, Camera, Basis)> {
    let (camera, scene, live) = (session.camera()?, session.scene()?, session.stage.live()?);
    let basis = Basis::of(&camera);
    let direction = basis.direction(at.into(), size.into());
    let (origin, reach) = (basis.start(camera.eye, at.into(), size.into()), [0.0, scene.frame(live).max_distance]);
    // What is taken away is not pointed at.
    let [t_min, t_max] = session.look.cut().map_or(reach, |section| section.plane(&camera).span(origin, direction, reach));
    Some((Ray { origin, direction, t_min, t_max }, camera, basis))
}

/// How far along a ray the field is seen.
fn seen_at(session: &Session, ray: Ray, footprint: f64) -> Option<f64> {
    let (scene, live) = (session.scene()?, session.stage.live()?);
    let hits = Reference::new(scene, live).ok()?.trace(&[ray], footprint, scene.blocks.extent);
    hits.first().filter(|hit| hit.hit).map(|hit| hit.t)
}

/// Looks for what made a pixel.
fn pick(session: &mut Session, at: [f64; 2], size: [u32; 2]) {
    let (Some((ray, _, basis)), Some((scene, live))) = (ray_at(session, at, size), session.scene().zip(session.stage.live())) else { return };
    let footprint = basis.footprint(size[1]);
    let asked = Asked { scene: scene.clone(), live: live.clone(), words: session.said.drawn.clone(), ray, footprint, up: basis.up, from: 0 };
    session.looking.begin(asked);
}

/// Balls above what is seen at a place of the picture; where nothing is, as far as what the camera looks at.
fn drop_balls(session: &mut Session, at: [f64; 2], size: [u32; 2]) {
    let (Some((ray, camera, basis)), Some((scene, live))) = (ray_at(session, at, size), session.scene().zip(session.stage.live())) else { return };
    let target = length(sub(camera.target, camera.eye));
    let most = scene.groups(live).first().map_or(0.0, |group| group.radius[1]);
    let [x, y, z] = ray.at(seen_at(session, ray, basis.footprint(size[1])).unwrap_or(target));
    session.stage.drop_balls([x, y + 14.0 * most, z], DROP);
}

/// Takes the nearest ball at a place of the picture that the field does not hide.
fn take_ball(session: &mut Session, at: [f64; 2], size: [u32; 2]) {
    let Some((ray, camera, basis)) = ray_at(session, at, size) else { return };
    let Some(Ok(balls)) = session.stage.balls().map(Physics::read) else { return };
    let footprint = basis.footprint(size[1]);
    // A hand need not meet a small ball to the pixel.
    let touched = |ball: &Ball| {
        let way = sub(ball.position, camera.eye);
        let along = dot(way, ray.direction);
        let aside = length(sub(way, scale(ray.direction, along)));
        (ball.state != State::Gone && along > 0.0 && aside <= ball.radius + 6.0 * footprint * along).then_some(along - ball.radius)
    };
    let nearest = balls.iter().enumerate().filter_map(|(i, b)| Some((touched(b)?, i, b))).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((t, index, ball)) = nearest else { return };
    if seen_at(session, ray, footprint).is_some_and(|seen| seen < t - 2.0 * ball.radius) {
        return;
    }
    session.held = Some(dot(sub(ball.position, camera.eye), basis.forward));
    session.stage.hold_ball(index as u32, ball.position);
}

/// Pulls the ball that is held, in the plane across the picture in which it was taken.
fn pull_ball(session: &mut Session, at: [f64; 2], size: [u32; 2]) {
    let (Some(depth), Some((ray, _, basis))) = (session.held, ray_at(session, at, size)) else { return };
    match session.stage.balls().and_then(Physics::held) {
        Some(index) => session.stage.hold_ball(index, ray.at(depth / dot(ray.direction, basis.forward))),
        // Other balls are there by now.
        None => session.held = None,
    }
}

/// Lets go of the ball that is held, as fast as the hand goes in its plane.
fn throw_ball(session: &mut Session, [right, down]: [f64; 2]) {
    let (Some(depth), Some(camera)) = (session.held.take(), session.camera()) else { return };
    let basis = Basis::of(&camera);
    let height = 2.0 * basis.tan_half_fov * depth;
    session.stage.throw_ball(add(scale(basis.right, right * height), scale(basis.up, -down * height)));
}

fn open(session: &mut Session, world: &mut World, path: &str) {
    match world.read(path) {
        Disk::Text(text) => {
            enter(session, world, Document::new(path, &text));
            note_recent(session, path);
            begin_where_it_was(session, world);
        }
        Disk::Unreadable(why) => session.notice = Some(format!("{path} can't be read: {why}")),
        // Text of it may have been left behind.
        Disk::Gone if session.found.iter().any(|found| found.is_of(path)) => enter(session, world, Document::of(path, &Disk::Gone)),
        Disk::Gone => session.notice = Some(format!("{path} is not there")),
    }
}

/// Puts a scene in the place of the one that is open.
fn enter(session: &mut Session, world: &mut World, scene: Document) {
    for document in &mut session.documents.all {
        take_back(document, world);
    }
    // What a hand moved belongs to the old scene, even where the new one has parameters of the same names.
    let parameters: Vec<_> = session.scene().iter().flat_map(|scene| scene.parameters.clone()).collect();
    for parameter in parameters.iter().filter(|p| p.first.is_some()) {
        session.stage.set(&parameter.name, &parameter.default);
    }
    session.search = None;
    session.asked = None;
    session.open.start = false;
    session.restoring = None;
    session.parts.show(Shown::default());
    world.open(&scene.name, &mut session.options);
    session.documents.all = vec![scene];
    session.documents.shown = 0;
    session.documents.focus = true;
    session.look.orbit = None;
    session.look.camera = None;
    (session.look.section, session.look.cuts) = (None, false);
    world.live.show(session.look.showing());
    session.stage.set_time(0.0);
    session.timeline = Timeline::default();
    session.stage.reset_balls();
}

/// The scene that is open is the newest of those that were. What lies beside it is known from now on.
pub fn note_recent(session: &mut Session, path: &str) {
    let path = kept::whole(path);
    session.recent.retain(|known| *known != path);
    session.recent.insert(0, path);
    let scene = session.documents.all.first().map(|d| d.name.clone()).unwrap_or_default();
    session.open.beside = crate::files::scenes_beside(&scene);
}

/// Opens the tabs that a scene had, and remembers what comes back when it is there.
pub fn begin_where_it_was(session: &mut Session, world: &mut World) {
    let known = session.documents.all.first().and_then(|document| world.keeper.state.scene(&document.name)).cloned();
    let Some(known) = known else { return };
    if let Some((length, loops)) = known.timeline.filter(|(length, _)| Timeline::LENGTHS.contains(length)) {
        session.timeline = Timeline { length, loops };
    }
    for tab in known.tabs.iter().filter(|tab| matches!(world.read(tab), Disk::Text(_))).cloned().collect::<Vec<_>>() {
        show(session, world, &tab);
    }
    session.documents.shown = if known.shown < session.documents.all.len() { known.shown } else { 0 };
    if !known.choices.is_empty() {
        session.options.choose.clone_from(&known.choices);
        world.live.set_options(session.options.clone());
    }
    session.restoring = Some(known);
}

/// Gives a scene that has come what a hand had done to it before the window was closed.
fn bring_back(session: &mut Session) {
    let Some(known) = session.restoring.take() else { return };
    for (name, value, said) in &known.values {
        // What the text says by now counts more.
        if session.parameter(name).is_some_and(|p| p.default == *said && p.default.len() == value.len()) {
            session.stage.set(name, value);
        }
    }
    if let (Some([eye, target]), Some(camera)) = (known.camera, session.camera()) {
        session.look.orbit = Some(Orbit::from_camera(&Camera { eye, target, ..camera }));
    }
}

/// Begins with a text that no file holds yet.
pub fn begin(session: &mut Session, world: &mut World, stem: &str, text: &str) {
    let before = session.documents.all.first().map(|document| document.name.clone()).unwrap_or_default();
    let folder = Path::new(&before).parent().unwrap_or(Path::new(""));
    let free = |n: u32| folder.join(if n == 1 { format!("{stem}.sdf") } else { format!("{stem}{n}.sdf") });
    let name = (1..).map(free).find(|path| !path.exists()).unwrap_or_default().to_string_lossy().into_owned();
    let mut document = Document::fresh(&name, text);
    document.lent = true;
    // Before the compiler looks for a file that is not there.
    world.live.set_text(&name, Some(text.to_owned()));
    enter(session, world, document);
}

/// Writes the text that is shown under another name, and goes on with that.
fn save_as(session: &mut Session, world: &mut World, path: &str) {
    let shown = session.documents.shown;
    let others = session.documents.all.iter().enumerate().any(|(i, document)| i != shown && document.name == path);
    if others {
        session.notice = Some(format!("{path} is open in another tab"));
        return;
    }
    let document = session.documents.current_mut();
    if let Err(why) = crate::files::write(Path::new(path), &document.bytes()) {
        session.notice = Some(format!("{path} can't be written: {why}"));
        return;
    }
    take_back(document, world);
    world.unfollow(&document.name);
    path.clone_into(&mut document.name);
    document.was_saved();
    world.follow(path);
    session.asked = None;
    session.documents.focus = true;
    if shown == 0 {
        world.live.open(path);
        note_recent(session, path);
    }
}

/// Asks for a path, beginning where the text that is shown lies.
fn ask_path(session: &mut Session, purpose: Purpose) {
    let name = session.documents.current().name.clone();
    let path = std::path::absolute(&name).unwrap_or_default();
    let typed = match purpose {
        Purpose::Open => String::new(),
        Purpose::SaveAs => session.documents.current().short_name().to_owned(),
        Purpose::Picture => path.with_extension("png").file_name().unwrap_or_default().to_string_lossy().into_owned(),
    };
    session.asked = Some(PathAsked { purpose, folder: PathBuf::new(), typed, entries: Vec::new(), wanted: PICTURE });
    look_into(session, path.parent().unwrap_or(Path::new("/")));
}

fn look_into(session: &mut Session, folder: &Path) {
    if let Some(asked) = &mut session.asked {
        asked.folder = folder.to_owned();
        asked.entries = crate::files::listing(folder);
        if asked.purpose == Purpose::Open {
            asked.typed.clear();
        }
    }
}

fn answer(session: &mut Session, world: &mut World, answer: Answer) {
    let Some(question) = session.question.take() else { return };
    let go_on = match answer {
        Answer::Stay => false,
        Answer::Discard => true,
        Answer::Save => {
            let at_stake = |i: &usize| session.documents.all.get(*i).is_some_and(|d| session.documents.is_at_stake(&question, d));
            let texts: Vec<usize> = (0..session.documents.all.len()).filter(at_stake).collect();
            texts.into_iter().all(|i| save(session, world, i))
        }
    };
    session.documents.focus = !go_on;
    if answer == Answer::Save && !go_on && session.notice.is_none() {
        let name = session.documents.current().short_name();
        session.notice = Some(format!("Nothing is closed yet: the disk holds something else of {name}. Decide above its text what is to be kept."));
    }
    if go_on {
        match question {
            Question::Open(path) => open(session, world, &path),
            Question::New(stem, text) => begin(session, world, &stem, &text),
            Question::CloseText(name) => close_text(session, world, &name),
            Question::Close => {
                world.recovery.forget_all();
                world.close = true;
            }
        }
    }
}

/// Compiles the text that is shown with a slider in a number's place.
fn hold_number(session: &mut Session, world: &mut World, number: &Number) {
    session.holds += 1;
    let count = session.holds;
    let document = session.documents.current_mut();
    let holding = Holding::begin(&document.name, &document.text, number, count);
    if holding.is_some() {
        document.was_given();
    }
    session.holding = holding;
    if let Some(holding) = &session.holding {
        world.live.set_text(&holding.file, Some(holding.text.clone()));
    }
}

/// Moves the number that is held, and the slider in its place. Where the slider ends, another one begins.
fn drag_number(session: &mut Session, world: &mut World, text: String, number: &Number) {
    let document = session.documents.current_mut();
    let Some(holding) = &mut session.holding else { return document.edit_on(text, Instant::now()) };
    document.edit_held(text, Instant::now());
    if !holding.set(number.value) {
        return hold_number(session, world, number);
    }
    move_held(session);
}

fn move_held(session: &mut Session) {
    let at = session.holding.as_ref().zip(session.stage.scene()).and_then(|(holding, scene)| holding.at(scene));
    if let Some((name, value)) = at {
        session.stage.set(&name, &[value]);
    }
}

/// Compiles the text itself again.
fn let_number_go(session: &mut Session, world: &mut World) {
    let Some(holding) = session.holding.take() else { return };
    let document = session.documents.find(&holding.file).and_then(|index| session.documents.all.get_mut(index));
    let text = document.and_then(|document| {
        document.lent = document.is_off_disk();
        document.lent.then(|| document.text.clone())
    });
    world.live.set_text(&holding.file, text);
}

fn arrived(session: &mut Session, world: &mut World, update: Update) {
    let is_of_one = holding::is_of_one(&update.words);
    let is_held = session.holding.as_ref().is_some_and(|holding| holding.is_of(&update.words));
    // The number can't be a slider: its text is compiled now and then while it is dragged.
    if is_held && update.ready.as_ref().is_none_or(|ready| session.holding.as_ref().and_then(|holding| holding.at(&ready.compiled)).is_none()) {
        return let_number_go(session, world);
    }
    if is_of_one && update.ready.is_none() {
        return;
    }
    let swapped = update.ready.is_some();
    if let Some(ready) = update.ready {
        session.said.reads_time = ready.compiled.reads_time();
        session.said.factors = factors(&ready.compiled, &update.words);
        session.said.drawn = update.words.clone();
        let before = session.scene().cloned().zip(session.stage.live().cloned());
        session.stage.put(ready);
        session.said.swaps += 1;
        bring_back(session);
        if let Some((old, live)) = before {
            go_home(session, &old, &live);
            follow_choices(session, world, &old);
        }
    }
    if is_held {
        if let Some(holding) = &mut session.holding {
            holding.is_live = true;
        }
        move_held(session);
    }
    if !is_of_one {
        said(session, update.words);
    }
    session.said.failure = update.failure;
    session.said.times = update.times;
    let errors = session.said.problems.iter().filter(|p| p.severity == Severity::Error).count();
    let times = session.said.times;
    let built = world.stats();
    world.log.event(
        "compiled",
        json!({
            "errors": errors,
            "failure": session.said.failure,
            "swapped": swapped,
            "swaps": session.said.swaps,
            "compile_ms": times.compile.as_secs_f64() * 1e3,
            "pipeline_ms": times.pipeline.as_secs_f64() * 1e3,
            "total_ms": times.total.as_secs_f64() * 1e3,
            "pipelines": built.pipelines,
            "modules": built.modules,
        }),
    );
}

/// Problems are those of the newest text, also while its picture is being built.
fn said(session: &mut Session, words: Arc<Words>) {
    session.said.problems = problems(&words);
    session.said.words = words;
}

/// A choice that a hand made ends where the text makes another one than before.
fn follow_choices(session: &mut Session, world: &World, old: &Compiled) {
    let Some(new) = session.scene().cloned() else { return };
    let chosen = |scene: &Compiled, name: &str| scene.parameters.iter().find(|p| p.name == name)?.choice().map(str::to_owned);
    let before = session.options.choose.len();
    session.options.choose.retain(|(name, _)| chosen(old, name) == chosen(&new, name));
    if session.options.choose.len() < before {
        world.live.set_options(session.options.clone());
    }
}

/// A camera that a hand moved and that saw the old scene is none for the new one where it stands in its solid or sees nothing of it, and the
/// scene's own does; nor where the scene's own stands in the same place by now.
fn go_home(session: &mut Session, old: &Compiled, was: &Live) {
    let Some(orbit) = session.look.orbit.take() else { return };
    let moved = orbit.camera();
    let blind = |camera: &Camera| session.scene().zip(session.stage.live()).is_some_and(|(new, live)| is_blind(new, live, camera));
    let better = blind(&moved) && !is_blind(old, was, &moved) && session.camera().is_some_and(|own| !blind(&own));
    let near = |a: [f64; 3], b: [f64; 3]| length(sub(a, b)) <= 2e-3 * length(sub(moved.eye, moved.target));
    let same = !orbit.parallel && session.camera().is_some_and(|own| near(own.eye, moved.eye) && near(own.target, moved.target) && (own.fov - moved.fov).abs() < 1e-3);
    session.look.orbit = (!better && !same).then_some(orbit);
}

fn on_disk(session: &mut Session, world: &mut World, name: &str, disk: &Disk) {
    session.found.iter_mut().filter(|found| found.is_of(name)).for_each(Found::look);
    let Some(index) = session.documents.find(name) else { return };
    let Some(document) = session.documents.all.get_mut(index) else { return };
    if document.on_disk(disk) {
        take_back(document, world);
    }
}
