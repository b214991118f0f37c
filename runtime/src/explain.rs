//! What a frame is made of: its passes with their time, size and reason, and what it does without.

use crate::frame::{PassKind, Picture};
use crate::gpu::Gpu;
use crate::headless::{Shot, render_with};
use crate::passes::scene::Features;
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::skipped::PARTS;

/// A pass of a frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExplainedPass {
    /// Its name, for people.
    pub name: &'static str,
    /// How long it takes: the median of several times.
    pub time: Duration,
    /// On how many pixels it draws, for people.
    pub size: String,
    /// Why the frame needs it.
    pub reason: String,
}

/// A frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Explained {
    /// Its passes, in the order in which they run.
    pub passes: Vec<ExplainedPass>,
    /// What is not in it, and why.
    pub left_out: Vec<(&'static str, &'static str)>,
}

/// So often each is measured.
const TIMES: usize = 5;

/// Draws one picture several times, pass after pass, and says what took how long. A pass's time is by how much the picture takes longer with
/// it, on the clock of the processor that waits.
pub fn explain(gpu: &Gpu, picture: &mut Picture, compiled: &Compiled, live: &Live, shot: &Shot) -> Result<Explained, String> {
    let mut passes = Vec::new();
    let planned = picture.passes().to_vec();
    // With nothing drawn: what the pixels' way back takes.
    let mut before = median(|| drawn(gpu, picture, compiled, live, shot, Some(0)))?;
    let mut count = 0;
    for pass in planned {
        let (time, size) = match pass.kind {
            PassKind::Shadows => {
                let (maps, side) = picture.maps();
                let all = median(|| {
                    picture.forget_maps();
                    drawn(gpu, picture, compiled, live, shot, Some(0))
                })?;
                (all.saturating_sub(before), format!("{maps} of {side}x{side}"))
            }
            PassKind::Capture => {
                let side = picture.capture_side();
                let all = median(|| {
                    picture.forget_capture();
                    drawn(gpu, picture, compiled, live, shot, Some(0))
                })?;
                (all.saturating_sub(before), format!("6 of {side}x{side}"))
            }
            PassKind::Cones => {
                let all = median(|| {
                    picture.forget_cones();
                    drawn(gpu, picture, compiled, live, shot, Some(0))
                })?;
                let [across, down] = picture.tiles().unwrap_or_default();
                (all.saturating_sub(before), format!("{across}x{down}"))
            }
            PassKind::Scene | PassKind::Meshes | PassKind::Balls | PassKind::Bloom => {
                count += 1;
                let all = median(|| drawn(gpu, picture, compiled, live, shot, Some(count)))?;
                let time = all.saturating_sub(before);
                before = all;
                (time, format!("{}x{}", shot.width, shot.height))
            }
        };
        passes.push(ExplainedPass { name: pass.name, time, size, reason: pass.reason });
    }
    picture.draw_first(None);
    Ok(Explained { passes, left_out: left_out(compiled, &Features::of(compiled, picture.mode())) })
}

fn drawn(gpu: &Gpu, picture: &mut Picture, compiled: &Compiled, live: &Live, shot: &Shot, passes: Option<u32>) -> Result<Duration, String> {
    picture.draw_first(passes);
    let start = Instant::now();
    render_with(gpu, picture, compiled, live, shot)?;
    Ok(start.elapsed())
}

fn median(mut measure: impl FnMut() -> Result<Duration, String>) -> Result<Duration, String> {
    // Once for what is made only once.
    measure()?;
    let mut times = (0..TIMES).map(|_| measure()).collect::<Result<Vec<_>, _>>()?;
    times.sort();
    Ok(times.get(TIMES / 2).copied().unwrap_or_default())
}

/// What a view of a scene does without, and why.
fn left_out(compiled: &Compiled, features: &Features) -> Vec<(&'static str, &'static str)> {
    let shaded = features.view == crate::ViewMode::Shaded;
    // Why the view does without what the scene may have.
    let rays = |has: bool| has.then_some("this view shows the field alone");
    let dark = (!shaded).then_some("this view shows no light");
    let there = [
        (features.meshes, rays(compiled.has_meshes())),
        (features.balls, rays(compiled.has_balls())),
        (features.shadows, dark),
        (features.maps(), dark),
        (features.occlusion, dark),
        (features.reflections > 0, dark),
        (features.capture.is_some(), dark),
        (features.environment, dark),
        (features.fog, dark),
        (features.glass, dark),
        (features.bloom, dark),
        (features.optics, None),
    ];
    PARTS.into_iter().zip(there).filter(|(_, (there, _))| !there).map(|((what, why), (_, view))| (what, view.unwrap_or(why))).collect()
}
