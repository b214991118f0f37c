//! Pictures and numbers without a window.

use crate::film::{self, Film};
use crate::frame::Picture;
use crate::gpu::{Gpu, depth_attachment};
use crate::passes::scene::{Features, ViewMode};
use crate::readback::{read, wait};
use crate::sheets::LINEAR;
use crate::view::View;
use std::ops::Range;
use surefoot_compiler::compiled::{Camera, Compiled, Live};

/// A picture that is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// What it shows.
    pub mode: ViewMode,
    /// From where; the scene's first camera where there is none.
    pub camera: Option<Camera>,
    /// How many pictures become this one, each through other places of its pixels. More than one need a picture that was prepared for
    /// [`LINEAR`].
    pub samples: u32,
    /// The first row that is drawn, and the one after the last. They are those of the whole picture, to the byte.
    pub rows: [u32; 2],
}

impl Shot {
    /// The scene in its light, through its first camera.
    pub fn new(width: u32, height: u32) -> Self {
        Self { width, height, mode: ViewMode::default(), camera: None, samples: 1, rows: [0, height] }
    }
}

/// Rows of pixels from the top, four bytes each: red, green, blue (sRGB), opacity.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `4 * width * height` bytes.
    pub rgba: Vec<u8>,
}

impl Pixels {
    /// The pixel of a column and a row; transparent black outside.
    pub fn get(&self, x: u32, y: u32) -> [u8; 4] {
        let at = 4 * (y as usize * self.width as usize + x as usize);
        let inside = x < self.width;
        let found = self.rgba.get(at..at + 4).filter(|_| inside);
        found.and_then(|bytes| bytes.try_into().ok()).unwrap_or_default()
    }
}

/// What a picture without a window is drawn on.
pub const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Pictures are drawn in squares of at most so many pixels a side: any size fits, and no single piece of work holds a graphics card
/// so long that its driver gives up.
const TILE: u32 = 512;

/// The greatest number of pixels of one picture.
const MOST_PIXELS: u64 = 1 << 28;

/// What a picture of so many samples is prepared for.
pub fn format(compiled: &Compiled, mode: ViewMode, samples: u32) -> wgpu::TextureFormat {
    if samples > 1 || Features::of(compiled, mode).bloom { LINEAR } else { FORMAT }
}

/// Builds a scene's pipeline and draws one picture.
pub fn render(gpu: &Gpu, compiled: &Compiled, live: &Live, shot: &Shot) -> Result<Pixels, String> {
    let format = format(compiled, shot.mode, shot.samples);
    let mut picture = Picture::prepare(gpu, compiled, format, shot.mode)?;
    render_with(gpu, &mut picture, compiled, live, shot)
}

/// Draws one picture with a pipeline that is there already; it was prepared for [`FORMAT`] or [`LINEAR`] and shows what it was prepared for.
pub fn render_with(
    gpu: &Gpu,
    picture: &mut Picture,
    compiled: &Compiled,
    live: &Live,
    shot: &Shot,
) -> Result<Pixels, String> {
    let Shot { width, height, camera, samples, rows: [first, end], .. } = *shot;
    if samples > 1 && picture.format() != LINEAR {
        return Err("a picture of several samples is prepared for 16-bit floats".to_owned());
    }
    if width == 0 || height == 0 || u64::from(width) * u64::from(height) > MOST_PIXELS {
        return Err(format!("a picture of {width} by {height} pixels can't be drawn"));
    }
    if first >= end || end > height {
        return Err(format!("a picture of {height} rows has no rows {first} to {end}"));
    }
    let frame = compiled.frame(live);
    let camera = match (camera, frame.cameras.first()) {
        (Some(camera), _) => camera,
        (None, Some((_, camera))) => *camera,
        (None, None) => return Err("the scene has no camera".to_owned()),
    };
    let most = gpu.device().limits().max_texture_dimension_2d;
    // What is scattered comes from anywhere in the picture.
    let side = if picture.blooms() { most } else { TILE };
    if picture.blooms() && width.max(height) > side {
        return Err(format!("a picture with bloom is at most {side} pixels wide and high here"));
    }
    if picture.blooms() && end - first < height {
        return Err("a picture with bloom is drawn as a whole, as light is scattered over all of it".to_owned());
    }
    let (tile_width, tile_height) = (width.min(side), height.min(side));
    let target = Target::new(gpu, tile_width, tile_height, FORMAT)?;
    let mut film = match picture.format() == LINEAR {
        true => Some(Film::new(gpu, [tile_width, tile_height], FORMAT)?),
        false => None,
    };
    let mut pixels = Pixels { width, height: end - first, rgba: vec![0; 4 * width as usize * (end - first) as usize] };
    // Those squares of the whole picture's that have some of its rows.
    for top in (0..end).step_by(side as usize).filter(|top| top + side > first) {
        let rows = first.saturating_sub(top)..(end - top).min(tile_height);
        for left in (0..width).step_by(side as usize) {
            let aim = |picture: &mut Picture, sample: u32| {
                let [across, down] = film::offset(sample);
                let corner = [-(left as f32) - across, -(top as f32) - down];
                let view = View { camera: camera.sampled(sample), size: [width as f32, height as f32], corner, sample };
                picture.update(gpu.queue(), compiled, live, &view);
            };
            let tile = match &mut film {
                Some(film) => {
                    film.clear();
                    for sample in 0..samples.max(1) {
                        aim(picture, sample);
                        expose(gpu, film, picture, rows.clone())?;
                    }
                    target.develop(gpu, film, picture)?
                }
                None => {
                    aim(picture, 0);
                    target.draw(gpu, picture, rows.clone())?
                }
            };
            let drawn = tile.chunks_exact(target.stride()).skip(rows.start as usize).take(rows.len());
            copy_tile(drawn, &mut pixels, left, (top + rows.start - first) as usize);
        }
    }
    Ok(pixels)
}

/// One picture as light, before it is encoded for a screen: red, green, blue and opacity of each pixel, row by row, as 16-bit floats hold
/// them. Of at most 512 pixels a side; of one sample.
pub fn light(gpu: &Gpu, compiled: &Compiled, live: &Live, shot: &Shot) -> Result<Vec<[f32; 4]>, String> {
    let Shot { width, height, .. } = *shot;
    if width == 0 || height == 0 || width.max(height) > TILE {
        return Err(format!("a picture of {width} by {height} pixels is no single tile"));
    }
    let mut picture = Picture::prepare(gpu, compiled, LINEAR, shot.mode)?;
    let frame = compiled.frame(live);
    let camera = shot.camera.or(frame.cameras.first().map(|(_, camera)| *camera)).ok_or("the scene has no camera")?;
    let target = Target::new(gpu, width, height, LINEAR)?;
    let view = View { camera, size: [width as f32, height as f32], corner: [0.0; 2], sample: 0 };
    picture.update(gpu.queue(), compiled, live, &view);
    let bytes = target.draw(gpu, &picture, 0..height)?;
    let rows = bytes.chunks_exact(target.stride()).map(|row| &row[..8 * width as usize]);
    let number = |pair: &[u8]| half::f16::from_le_bytes([pair[0], pair[1]]).to_f32();
    Ok(rows.flat_map(|row| row.chunks_exact(8)).map(|pixel| [0, 2, 4, 6].map(|at| number(&pixel[at..at + 2]))).collect())
}

/// Draws one pixel and waits for it. Some drivers make the machine code only at the first draw; after this it is made.
pub(crate) fn warm_up(
    gpu: &Gpu,
    picture: &mut Picture,
    compiled: &Compiled,
    format: wgpu::TextureFormat,
) -> Result<(), String> {
    let live = compiled.live();
    let frame = compiled.frame(&live);
    let Some(&(_, camera)) = frame.cameras.first() else { return Ok(()) };
    let view = View { camera, size: [1.0, 1.0], corner: [0.0, 0.0], sample: 0 };
    gpu.catch(|| {
        picture.update(gpu.queue(), compiled, &live, &view);
        let texture = texture(gpu, 1, 1, format);
        let submitted = gpu.queue().submit([encode(gpu, picture, &texture, 0..1).finish()]);
        wait(gpu, submitted)
    })?
}

/// A texture and the buffer through which its pixels come back.
struct Target {
    texture: wgpu::Texture,
    buffer: wgpu::Buffer,
}

impl Target {
    fn new(gpu: &Gpu, width: u32, height: u32, format: wgpu::TextureFormat) -> Result<Self, String> {
        gpu.catch(|| {
            let texture = texture(gpu, width, height, format);
            let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("surefoot pixels"),
                size: u64::from(stride(&texture)) * u64::from(height),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            Self { texture, buffer }
        })
    }

    /// Bytes from one row to the next.
    fn stride(&self) -> usize {
        stride(&self.texture) as usize
    }

    fn draw(&self, gpu: &Gpu, picture: &Picture, rows: Range<u32>) -> Result<Vec<u8>, String> {
        self.read(gpu, || encode(gpu, picture, &self.texture, rows))
    }

    /// Shows what fell on a film.
    fn develop(&self, gpu: &Gpu, film: &Film, picture: &Picture) -> Result<Vec<u8>, String> {
        self.read(gpu, || {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            film.show(&mut encoder, picture, &self.texture);
            encoder
        })
    }

    /// The pixels after some work.
    fn read(&self, gpu: &Gpu, work: impl FnOnce() -> wgpu::CommandEncoder) -> Result<Vec<u8>, String> {
        let submitted = gpu.catch(|| {
            let mut encoder = work();
            encoder.copy_texture_to_buffer(
                self.texture.as_image_copy(),
                wgpu::TexelCopyBufferInfo {
                    buffer: &self.buffer,
                    layout: wgpu::TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(stride(&self.texture)),
                        rows_per_image: None,
                    },
                },
                self.texture.size(),
            );
            gpu.queue().submit([encoder.finish()])
        })?;
        read(gpu, &self.buffer, submitted)
    }
}

/// Lets some rows of a picture fall on a film, and waits for it: a driver gives up on a queue that is too long.
fn expose(gpu: &Gpu, film: &mut Film, picture: &Picture, rows: Range<u32>) -> Result<(), String> {
    let size = film.size();
    // No more pixels at once than a tile has.
    let band = (TILE * TILE / size[0].max(1)).max(1);
    for top in rows.clone().step_by(band as usize) {
        let end = (top + band).min(rows.end);
        let submitted = gpu.catch(|| {
            let mut encoder = gpu.device().create_command_encoder(&Default::default());
            film.draw(&mut encoder, picture, size, top..end);
            if end == rows.end {
                film.keep(&mut encoder, picture);
            }
            gpu.queue().submit([encoder.finish()])
        })?;
        wait(gpu, submitted)?;
    }
    Ok(())
}

fn texture(gpu: &Gpu, width: u32, height: u32, format: wgpu::TextureFormat) -> wgpu::Texture {
    gpu.device().create_texture(&wgpu::TextureDescriptor {
        label: Some("surefoot picture"),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    })
}

fn encode(gpu: &Gpu, picture: &Picture, texture: &wgpu::Texture, rows: Range<u32>) -> wgpu::CommandEncoder {
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    let view = texture.create_view(&Default::default());
    let depth = picture.depth(texture.size());
    let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("surefoot"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: depth.as_ref().map(depth_attachment),
        ..Default::default()
    });
    picture.draw_rows(&mut pass, texture.width(), rows);
    drop(pass);
    encoder
}

/// Rows of a copy are multiples of 256 bytes.
fn stride(texture: &wgpu::Texture) -> u32 {
    let bytes = texture.format().block_copy_size(None).unwrap_or(4);
    (bytes * texture.width()).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT)
}

fn copy_tile<'a>(tile: impl Iterator<Item = &'a [u8]>, pixels: &mut Pixels, left: u32, top: usize) {
    let width = 4 * pixels.width as usize;
    let left = 4 * left as usize;
    let rows = pixels.rgba.chunks_exact_mut(width).skip(top);
    for (row, from) in rows.zip(tile) {
        for (to, from) in row.iter_mut().skip(left).zip(from) {
            *to = *from;
        }
    }
}
