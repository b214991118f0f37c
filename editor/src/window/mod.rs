//! The live window. [`session::Session`] holds all that it knows; panels read it and push [`command::Command`]s; one function,
//! [`apply::apply`], does them.

mod apply;
mod back;
mod canvas;
mod command;
mod document;
mod examples;
mod export;
mod holding;
mod kept;
mod keys;
mod log;
mod looking;
mod measuring;
mod meter;
mod orbit;
mod painter;
mod panels;
mod parts;
mod passes;
mod places;
mod recovery;
mod refine;
mod session;
mod theme;
mod trial;
mod truth;
mod world;

#[cfg(test)]
mod tests;

pub use log::Log;
pub use recovery::Recovery;
pub use trial::{Measured, Rested, Typed};

use crate::files::FileLoader;
use apply::apply;
use canvas::{Canvas, Order};
use command::Command;
use document::Document;
use eframe::egui_wgpu::{RenderState, WgpuSetup};
use painter::Painter;
use egui::containers::panel::PanelState;
use egui::{CentralPanel, Event, Frame, IdSalt, Margin, Panel, Rect, ViewportCommand, vec2};
use serde_json::json;
use session::{Question, Session};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use surefoot_compiler::Options;
use surefoot_runtime::Gpu;
use surefoot_runtime::live::SharedLoader;
use trial::Trial;
use truth::Seen;
use world::World;

/// Shows a scene until the window is closed; the error is why there is no window. `asked` is what the compiler is asked for, and `alone` whether only
/// the picture is shown.
pub fn open(scene: &str, asked: Options, alone: bool, recovery: Recovery, log: Log) -> Result<(), String> {
    run(scene, move |cc, scene| {
        let mut app = App::new(cc, scene, asked, Arc::new(FileLoader), recovery, log)?;
        app.session.open.alone = alone;
        Ok(app)
    })
}

/// Shows the page with which one begins, until the window is closed; the error is why there is no window.
pub fn start(recovery: Recovery) -> Result<(), String> {
    run("untitled.sdf", move |cc, scene| {
        let mut app = App::new(cc, scene, Options::default(), Arc::new(FileLoader), recovery, Log::default())?;
        app.start();
        Ok(app)
    })
}

/// Whether there may be a screen to show a window on.
pub fn has_display() -> bool {
    let set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos"))) || ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(set)
}

/// Shows a scene until it is measured what the window costs. What is typed is not saved.
pub fn measure(scene: &str) -> Result<Measured, String> {
    let measured = Arc::<Mutex<Measured>>::default();
    let shared = measured.clone();
    run(scene, move |cc, scene| {
        let mut app = App::new(cc, scene, Options::default(), Arc::new(FileLoader), Recovery::within(None), Log::default())?;
        let Some(canvas) = &app.canvas else { return Err("the window has no graphics adapter".to_owned()) };
        app.trial = Some(Trial::new(canvas.gpu().clone(), shared));
        Ok(app)
    })?;
    let measured = meter::lock(&measured).clone();
    measured.failure.clone().map_or(Ok(measured), Err)
}

fn run(scene: &str, create: impl FnOnce(&eframe::CreationContext<'_>, &str) -> Result<App, String>) -> Result<(), String> {
    let mut options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Surefoot")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([640.0, 400.0]),
        persist_window: false,
        // The picture is shown as it was drawn, and all else is of one colour.
        dithering: false,
        ..Default::default()
    };
    // A frame with a key in it does not wait for one before.
    options.wgpu_options.surface.desired_maximum_frame_latency = Some(1);
    if let WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        setup.device_descriptor = Arc::new(Gpu::device_descriptor);
    }
    let create = |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, _> {
        let app = create(cc, scene)?;
        if app.session.meter.software
            && let Some(painter) = cc.wgpu_render_state.as_ref().and_then(Painter::of)
        {
            cc.egui_ctx.add_plugin(painter);
        }
        Ok(Box::new(app))
    };
    eframe::run_native("surefoot", options, Box::new(create)).map_err(|error| error.to_string())
}

/// How often it is said anew how long work takes.
const TICK: Duration = Duration::from_millis(250);

/// The window's program.
struct App {
    session: Session,
    world: World,
    canvas: Option<Canvas>,
    /// What the device found wrong outside of anything that listens.
    uncaught: Arc<Mutex<Option<String>>>,
    /// When time was last let pass.
    ticked: Instant,
    title: String,
    /// What types and measures, where that is asked for.
    trial: Option<Trial>,
}

impl App {
    fn new(
        cc: &eframe::CreationContext<'_>,
        scene: &str,
        asked: Options,
        loader: SharedLoader,
        recovery: Recovery,
        log: Log,
    ) -> Result<Self, String> {
        theme::apply(&cc.egui_ctx);
        let uncaught = Arc::<Mutex<Option<String>>>::default();
        let ctx = cc.egui_ctx.clone();
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(move || ctx.request_repaint());
        let gpu = cc.wgpu_render_state.as_ref().map(|render| listen(render, &uncaught));
        let document = Document::of(scene, &world::read(&*loader, scene));
        let mut session = Session::new(document);
        session.options = asked;
        session.found = recovery.found();
        if let Some(gpu) = &gpu {
            session.meter.adapter = gpu.name().to_owned();
            session.meter.software = gpu.is_software();
        }
        log.event("opened", json!({ "scene": scene, "adapter": session.meter.adapter }));
        let world = World::new(scene, &session.options, loader, gpu.clone(), recovery, log.clone(), wake.clone())?;
        session.parts = world.parts.clone();
        let canvas = gpu
            .zip(cc.wgpu_render_state.clone())
            .map(|(gpu, render)| Canvas::new(gpu, render, log, wake));
        let now = Instant::now();
        let mut world = world;
        back::give(&world.keeper.state.layout, &mut session);
        session.recent.clone_from(&world.keeper.state.recent);
        if session.parts.ask(session.open.outline) {
            world.live.again();
        }
        if !session.documents.all.iter().any(|document| document.is_missing()) {
            apply::note_recent(&mut session, scene);
        }
        apply::begin_where_it_was(&mut session, &mut world);
        Ok(Self { session, world, canvas, uncaught, ticked: now, title: String::new(), trial: None })
    }

    /// Shows the page with which one begins, before a new scene.
    fn start(&mut self) {
        apply::begin(&mut self.session, &mut self.world, "untitled", examples::TEMPLATE);
        self.session.open.start = true;
        self.session.documents.focus = false;
    }

    /// What came from outside since the last frame. `is_held`: whether the pointer is pressed.
    fn hear(&mut self, is_held: bool) {
        for command in self.world.hear() {
            apply(&mut self.session, &mut self.world, command);
        }
        self.session.measuring.hear();
        self.session.passes.hear();
        self.session.truth.hear();
        if let Some(words) = self.session.export.hear() {
            self.session.notice = Some(words);
        }
        if let Some(place) = self.session.looking.hear() {
            apply(&mut self.session, &mut self.world, Command::Jump(place));
        }
        if self.session.holding.is_some() && !is_held {
            apply(&mut self.session, &mut self.world, Command::LetNumberGo);
        }
        self.session.said.loading = self.world.loading();
        self.session.said.work = self.world.work();
        self.world.lend_edits(&mut self.session);
        let uncaught = self.uncaught.lock().unwrap_or_else(PoisonError::into_inner).take();
        if let Some(error) = uncaught {
            self.session.said.failure = Some(error);
        }
        if let Some(canvas) = &self.canvas {
            let timing = canvas.timing();
            self.session.meter.note(timing.frame);
            self.session.meter.size = timing.size;
            self.session.meter.sharp = canvas.is_sharp();
            self.session.meter.samples = canvas.samples();
        }
    }

    fn let_time_pass(&mut self) {
        let now = Instant::now();
        // After a pause (a hidden window, a breakpoint) the scene goes on where it was.
        let passed = now.duration_since(self.ticked).min(Duration::from_millis(250));
        self.ticked = now;
        if self.session.stage.animates() {
            self.session.advance(passed.as_secs_f64());
        }
    }

    /// Everything but the picture; the commands of the panels.
    fn panels(&self, ui: &mut egui::Ui, commands: &mut Vec<Command>) {
        let session = &self.session;
        if session.open.alone {
            panels::picture::keys(ui, session, commands);
            return panels::questions::show(ui, session, commands);
        }
        let bar = Frame::new().fill(*theme::PANEL).inner_margin(Margin::symmetric(8, 2));
        let top = Panel::top("toolbar").frame(bar).exact_size(34.0).resizable(false);
        top.show(ui, |ui| panels::toolbar::show(ui, session, commands));
        let bottom = Panel::bottom("status").frame(bar).exact_size(22.0).resizable(false);
        bottom.show(ui, |ui| panels::status::show(ui, session, commands));
        panels::paths::show(ui, session, commands);
        panels::help::show(ui, session, commands);
        panels::questions::show(ui, session, commands);
        if session.open.start {
            return;
        }
        let side = Frame::new().fill(*theme::PANEL).inner_margin(Margin::same(8));
        // Of a narrow window something is left for the picture.
        let wide = ui.available_width();
        let mut widths = session.open.widths;
        if session.open.source {
            let most = (0.55 * wide).max(200.0);
            let left = Panel::left("source").frame(side).default_size(session.open.widths[0]).size_range(200.0..=most);
            widths[0] = show_side(ui, "source", left, widths[0], most, |ui| {
                let below = Frame::new().inner_margin(Margin { top: 8, ..Margin::ZERO });
                let list = Panel::bottom("problems").frame(below).resizable(true);
                list.default_size(130.0).size_range(40.0..=600.0).show(ui, |ui| {
                    panels::problems::show(ui, session, commands);
                });
                let text = CentralPanel::default().frame(Frame::NONE);
                text.show(ui, |ui| panels::source::show(ui, session, commands));
            });
        }
        if session.open.shader {
            let most = (0.4 * wide).max(200.0);
            let beside = Panel::left("shader").frame(side).default_size(300.0).size_range(160.0..=most);
            beside.show(ui, |ui| panels::shader::show(ui, session));
        }
        type Show = fn(&mut egui::Ui, &Session, &mut Vec<Command>);
        let stack: [(bool, &str, Show); 4] = [
            (session.open.parameters, "parameters", panels::parameters::show),
            (session.open.outline, "outline", panels::outline::show),
            (session.open.measures, "measures", panels::measures::show),
            (session.open.frames, "frames", panels::frames::show),
        ];
        let stack: Vec<_> = stack.into_iter().filter(|(open, ..)| *open).collect();
        if let Some(((_, _, first), rest)) = stack.split_first() {
            let most = (0.3 * wide).max(150.0);
            let right = Panel::right("parameters").frame(side).default_size(session.open.widths[1]).size_range(150.0..=most);
            widths[1] = show_side(ui, "parameters", right, widths[1], most, |ui| {
                // Each has a share of the height, and the first what is left.
                let high = ui.available_height() / stack.len() as f32;
                for (_, name, show) in rest.iter().rev() {
                    let below = Frame::new().inner_margin(Margin { top: 8, ..Margin::ZERO });
                    let list = Panel::bottom(*name).frame(below).resizable(true);
                    list.default_size(high.min(330.0)).size_range(60.0..=600.0).show(ui, |ui| show(ui, session, commands));
                }
                CentralPanel::default().frame(Frame::NONE).show(ui, |ui| first(ui, session, commands));
            });
        }
        if session.moves() {
            let strip = Panel::bottom("timeline").frame(bar).exact_size(26.0).resizable(false);
            strip.show(ui, |ui| panels::timeline::show(ui, session, commands));
        }
        if widths != session.open.widths {
            commands.push(Command::Widths(widths));
        }
        panels::picture::keys(ui, session, commands);
    }

    /// The picture, drawn where anything changed.
    fn picture(&mut self, ui: &mut egui::Ui) {
        let mut commands = Vec::new();
        let response = panels::picture::sense(ui, &self.session, &mut commands);
        self.apply(commands);
        let rect = response.rect;
        self.session.look.wide = f64::from(rect.width() / rect.height().max(1.0));
        let scale = ui.ctx().pixels_per_point();
        if !moves(ui) {
            self.session.look_around();
        }
        let order = self.session.camera().map(|camera| Order {
            camera,
            size: [rect.width(), rect.height()].map(|side| (side * scale).round().max(1.0) as u32),
            interval: f64::from(ui.input(|i| i.stable_dt)),
            moving: self.session.stage.animates() || moves(ui),
            swaps: self.session.said.swaps,
        });
        let again = order.as_ref().and_then(|order| self.follow_truth(order));
        if let Some(again) = again {
            ui.ctx().request_repaint_after(again);
        }
        let shown = match (&mut self.canvas, &order) {
            (Some(canvas), Some(order)) => canvas.draw(&mut self.session.stage, order),
            _ => None,
        };
        let mut commands = Vec::new();
        if let Some(canvas) = &self.canvas {
            commands.push(Command::Drawn(canvas.error()));
        }
        if let Some(again) = shown.and_then(|shown| shown.again) {
            ui.ctx().request_repaint_after(again);
        }
        panels::picture::paint(ui, rect, &self.session, shown);
        panels::grid::show(ui, rect, &self.session);
        panels::wipe::show(ui, rect, &self.session, &mut commands);
        panels::legend::show(ui, rect, &self.session, &mut commands);
        panels::section::show(ui, rect, &self.session, &mut commands);
        panels::truth::show(ui, rect, &self.session, &mut commands);
        panels::outline::badge(ui, rect, &self.session, &mut commands);
        panels::picked::show(ui, rect, &self.session, &mut commands);
        panels::picture::band(ui, rect, &self.session, &mut commands);
        self.apply(commands);
    }

    /// Tells what looks for the truth which picture is shown, where a person wants to see it. The answer: after what time to tell again.
    fn follow_truth(&mut self, order: &Order) -> Option<Duration> {
        let (gpu, scene, live) = (self.world.gpu()?, self.session.stage.scene()?.clone(), self.session.stage.live()?.clone());
        let wake = self.world.waker();
        let seen = Seen { scene, live, camera: order.camera, size: order.size };
        let truth = &mut self.session.truth;
        if truth.open { truth.follow(gpu, seen, wake) } else { None }
    }

    fn apply(&mut self, commands: Vec<Command>) {
        for command in commands {
            apply(&mut self.session, &mut self.world, command);
        }
    }

    /// What the window system asks: closing, files that are dropped, the title, the next frame.
    fn around(&mut self, ui: &egui::Ui) {
        let ctx = ui.ctx();
        if ctx.input(|i| i.viewport().close_requested()) && !self.world.close {
            if self.session.is_unsaved() {
                ctx.send_viewport_cmd(ViewportCommand::CancelClose);
                self.session.question = Some(Question::Close);
            } else {
                self.world.close = true;
            }
        }
        if self.world.close {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        if self.world.close {
            self.world.keeper.end(|state| back::take(state, &self.session));
        }
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_owned()));
        if let Some(path) = dropped {
            let command = Command::Open(path.to_string_lossy().into_owned());
            apply(&mut self.session, &mut self.world, command);
        }
        let document = self.session.documents.all.first();
        let name = document.map(Document::short_name).unwrap_or_default();
        let mark = if self.session.is_unsaved() { "● " } else { "" };
        let title = format!("{mark}{name} — Surefoot");
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        if self.session.stage.animates() {
            ctx.request_repaint();
        }
        if self.session.said.work.is_some() || self.session.measuring.part().is_some() || self.session.export.part().is_some() || self.session.looking.is_busy() || self.session.passes.is_busy() || self.session.stage.settles() {
            ctx.request_repaint_after(TICK);
        }
        let now = Instant::now();
        let kept = self.world.keep_unsaved(&mut self.session);
        let state = self.world.keeper.follow(now, |state| back::take(state, &self.session));
        let wait = self.session.documents.all.iter().filter_map(|d| d.wait(now)).chain(kept).chain(state).min();
        if let Some(wait) = wait {
            ctx.request_repaint_after(wait);
        }
    }
}

impl eframe::App for App {
    fn raw_input_hook(&mut self, _ctx: &egui::Context, input: &mut egui::RawInput) {
        if let Some(trial) = &mut self.trial {
            trial.before(input);
        }
    }

    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let is_key = |event: &Event| matches!(event, Event::Key { .. } | Event::Text(_) | Event::Paste(_) | Event::Cut | Event::Ime(_));
        if let Some(canvas) = self.canvas.as_mut().filter(|_| ui.input(|i| i.events.iter().any(is_key))) {
            canvas.yields();
        }
        theme::choose(ui.ctx(), self.session.open.theme);
        if ui.ctx().zoom_factor() != self.session.open.zoom {
            ui.ctx().set_zoom_factor(self.session.open.zoom);
        }
        self.hear(ui.input(|i| i.pointer.primary_down()));
        self.let_time_pass();
        let mut commands = Vec::new();
        keys::hear(ui, &self.session, &mut commands);
        keys::hear_picture(ui, &self.session, &mut commands);
        panels::search::keys(ui, &self.session, &mut commands);
        self.apply(commands);
        let mut commands = Vec::new();
        self.panels(ui, &mut commands);
        self.apply(commands);
        // All of it is painted over.
        if self.session.open.start {
            let mut commands = Vec::new();
            let page = Frame::new().fill(*theme::GROUND).inner_margin(Margin::symmetric(28, 8));
            CentralPanel::default().frame(page).show(ui, |ui| panels::start::show(ui, &self.session, &mut commands));
            self.apply(commands);
        } else {
            CentralPanel::default().frame(Frame::NONE).show(ui, |ui| self.picture(ui));
        }
        self.around(ui);
        if let (Some(trial), Some(canvas)) = (&mut self.trial, &mut self.canvas) {
            self.world.close |= trial.after(ui.ctx(), &mut self.session, canvas);
        }
    }
}

/// Shows a panel at a side that is so wide at first and at most so wide now. One that a narrow window made narrower is as wide as before once
/// there is room again. Answers how wide it is meant to be.
fn show_side(ui: &mut egui::Ui, name: &str, panel: Panel, first: f32, most: f32, add: impl FnOnce(&mut egui::Ui)) -> f32 {
    let id = ui.scope_id().with_salt(IdSalt::new(name));
    let wanted = PanelState::load(ui.ctx(), id).map_or(first, |state| state.outer_rect.width());
    panel.show(ui, add);
    let Some(shown) = PanelState::load(ui.ctx(), id) else { return wanted };
    // A hand that makes it narrower still means it.
    if wanted > most && shown.outer_rect.width() > most - 1.0 {
        let outer_rect = Rect::from_min_size(shown.outer_rect.min, vec2(wanted, shown.outer_rect.height()));
        ui.ctx().data_mut(|data| data.insert_persisted(id, PanelState { outer_rect }));
        return wanted;
    }
    shown.outer_rect.width()
}

/// Whether a hand moves something now.
fn moves(ui: &egui::Ui) -> bool {
    ui.ctx().egui_is_using_pointer() || ui.input(|i| i.smooth_scroll_delta != egui::Vec2::ZERO)
}

/// The window's device. What it finds wrong where nobody listens would end the program; here it becomes words.
fn listen(render: &RenderState, uncaught: &Arc<Mutex<Option<String>>>) -> Gpu {
    let words = uncaught.clone();
    render.device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        *words.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.to_string());
    }));
    Gpu::from_parts(render.device.clone(), render.queue.clone())
}
