//! Makes the machine code of a pipeline before the device that draws needs it.
//!
//! Software adapters (Mesa's lavapipe) make machine code at the first draw, on the one thread that does all drawing of a device: the
//! window would stand still for as long, which is seconds for a large scene. So the first draw happens on a second device, which
//! fills the driver's cache on the disk, and the device that draws then finds its code there. Graphics cards make their code where the
//! pipeline is built, on our own thread, and need none of this.

use crate::frame::Picture;
use crate::gpu::Gpu;
use std::time::{Duration, Instant};

/// A rehearsal that took less says nothing: the code was there, or is small.
const TELLING: Duration = Duration::from_millis(250);
/// So many rehearsals without a gain, and there are no more.
const PATIENCE: u32 = 3;

/// The second device, where one helps.
pub(super) struct Rehearsal {
    stand_in: Option<Gpu>,
    in_vain: u32,
}

impl Rehearsal {
    /// For a device that draws.
    pub fn new(gpu: Option<&Gpu>) -> Self {
        let software = gpu.filter(|gpu| gpu.is_software());
        let stand_in = software.and_then(|gpu| {
            let other = Gpu::headless().ok()?;
            (other.driver() == gpu.driver()).then_some(other)
        });
        Self { stand_in, in_vain: 0 }
    }

    /// Prepares a picture on the stand-in and then on the device.
    pub fn prepare(
        &mut self,
        gpu: &Gpu,
        prepare: impl Fn(&Gpu) -> Result<Picture, String>,
    ) -> Result<Picture, String> {
        let Some(stand_in) = &self.stand_in else { return prepare(gpu) };
        let start = Instant::now();
        let rehearsed = prepare(stand_in).map(drop);
        let first = start.elapsed();
        let start = Instant::now();
        let picture = prepare(gpu)?;
        let second = start.elapsed();
        if first > TELLING {
            self.in_vain = if 3 * second > 2 * first { self.in_vain + 1 } else { 0 };
        }
        // The driver keeps nothing on the disk, or the stand-in is out of order: twice the work for no gain.
        if rehearsed.is_err() || self.in_vain >= PATIENCE {
            self.stand_in = None;
        }
        log::debug!("rehearsed in {first:?}, then built in {second:?}");
        Ok(picture)
    }
}
