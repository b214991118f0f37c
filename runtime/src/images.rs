//! The images that a scene names: found, decoded, and made into what the shading reads. What can't be had is said with its place in the
//! text, and the rest of the scene goes on.

use image::{DynamicImage, ImageReader, Limits};
use std::collections::HashMap;
use std::collections::hash_map::DefaultHasher;
use std::hash::{Hash, Hasher};
use std::io::Cursor;
use std::sync::Arc;
use surefoot_compiler::compiled::{Compiled, Loader};
use surefoot_compiler::diagnostic::{Code, Diagnostic};
use surefoot_compiler::images::{Bitmap, Cube, EnvironmentFile, EnvironmentKind, FACES, Images, Texture, TextureKind};
use surefoot_compiler::source::Span;

/// Textures that a pass takes; what is made of more images is drawn without them. Every device has room for sixteen, and shadows and the sky
/// need some.
pub const MOST_TEXTURES: usize = 8;

/// The longest side of an image, in pixels.
pub const LONGEST_SIDE: u32 = 16_384;
/// What an image may take once it is decoded, in bytes.
pub const MOST_BYTES: u64 = 512 << 20;

/// The largest file that is read, in bytes.
pub const LARGEST_FILE: u64 = 128 << 20;

/// The endings of files that are tried where a name has none, in their order.
const ENDINGS: [&str; 4] = ["png", "jpg", "jpeg", "hdr"];

/// What came of reading the images of a scene.
#[derive(Clone, Debug, Default)]
pub struct Loaded {
    /// What could be had.
    pub images: Images,
    /// What could not, each with its place in the text.
    pub diagnostics: Vec<Diagnostic>,
}

/// Reads images, and keeps what was made of the newest: a scene whose images did not change does not make them again.
#[derive(Debug, Default)]
pub struct Gallery {
    environment: Option<(u64, Arc<Cube>)>,
    /// By the file and what is made of it: the hash of its bytes when it was good, and what was made of them.
    textures: HashMap<(String, TextureKind), (u64, Arc<Texture>)>,
    /// Whether it is only asked what is wrong.
    checks: bool,
}

impl Gallery {
    /// Nothing is kept yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// For who only asks what is wrong: skies are read and left dark, as what is made of them takes long.
    pub fn checking() -> Self {
        Self { checks: true, ..Self::default() }
    }

    /// The images of a scene. A large sky takes seconds the first time: not on a window's thread.
    pub fn load(&mut self, compiled: &Compiled, loader: &dyn Loader) -> Loaded {
        let mut loaded = Loaded::default();
        if let Some(environment) = &compiled.blocks.environment {
            match self.environment(environment, loader) {
                Ok(cube) => loaded.images.environment = Some(cube),
                Err(found) => {
                    loaded.diagnostics.extend(found);
                    // A sky that was good before stays.
                    loaded.images.environment = self.environment.as_ref().map(|(_, cube)| cube.clone());
                }
            }
        }
        let mut kept = HashMap::new();
        for (i, (image, kind)) in compiled.functions.textures().into_iter().enumerate() {
            let Some(file) = compiled.graph.images.get(image as usize) else { continue };
            let texture = match self.texture(&file.path, kind, loader) {
                _ if i >= MOST_TEXTURES => Err(format!("`{}` is one image too many: a scene may have {MOST_TEXTURES}", file.path)),
                made => made,
            };
            loaded.images.textures.push(match texture {
                Ok((hash, texture)) => {
                    kept.insert((file.path.clone(), kind), (hash, texture.clone()));
                    texture
                }
                Err(words) => {
                    loaded.diagnostics.push(bad_image(file.span, words));
                    // An image that was good before stays.
                    match self.textures.remove(&(file.path.clone(), kind)) {
                        Some((hash, texture)) => {
                            kept.insert((file.path.clone(), kind), (hash, texture.clone()));
                            texture
                        }
                        None => Arc::new(Texture::missing(kind)),
                    }
                }
            });
        }
        self.textures = kept;
        loaded
    }

    fn texture(&self, path: &str, kind: TextureKind, loader: &dyn Loader) -> Result<(u64, Arc<Texture>), String> {
        let bytes = loader.read_up_to(path, LARGEST_FILE).map_err(|why| unreadable(path, &why))?;
        let mut hasher = DefaultHasher::new();
        bytes.hash(&mut hasher);
        let hash = hasher.finish();
        let known = self.textures.get(&(path.to_owned(), kind)).filter(|(known, _)| *known == hash);
        if let Some((_, known)) = known {
            return Ok((hash, known.clone()));
        }
        let bitmap = decode(&bytes, kind == TextureKind::Color).map_err(|why| format!("`{path}` is no image that can be shown: {why}"))?;
        Ok((hash, Arc::new(Texture::new(&bitmap, kind))))
    }

    fn environment(&mut self, wanted: &EnvironmentFile, loader: &dyn Loader) -> Result<Arc<Cube>, Vec<Diagnostic>> {
        let EnvironmentFile { kind, file } = wanted;
        let bad = |words: String| bad_image(file.span, words);
        let files: Vec<(String, Vec<u8>)> = match kind {
            EnvironmentKind::Equirect => {
                let bytes = loader.read_up_to(&file.path, LARGEST_FILE).map_err(|why| vec![bad(unreadable(&file.path, &why))])?;
                vec![(file.path.clone(), bytes)]
            }
            EnvironmentKind::Cubemap => faces(&file.path, loader).map_err(|words| words.into_iter().map(bad).collect::<Vec<_>>())?,
        };
        let mut hasher = DefaultHasher::new();
        (kind, files.iter().map(|(_, bytes)| bytes).collect::<Vec<_>>()).hash(&mut hasher);
        let hash = hasher.finish();
        if let Some((_, known)) = self.environment.as_ref().filter(|(known, _)| *known == hash) {
            return Ok(known.clone());
        }
        let mut bitmaps = Vec::new();
        let mut wrong = Vec::new();
        for (path, bytes) in &files {
            match decode(bytes, true) {
                Ok(bitmap) => bitmaps.push(bitmap),
                Err(why) => wrong.push(bad(format!("`{path}` is no image that can be shown: {why}"))),
            }
        }
        if !wrong.is_empty() {
            return Err(wrong);
        }
        let cube = match <[Bitmap; 6]>::try_from(bitmaps) {
            Ok(faces) => {
                let side = faces[0].width;
                if let Some(at) = faces.iter().position(|f| f.width != side || f.height != side) {
                    let (path, face) = (&files[at].0, &faces[at]);
                    let (width, height) = (face.width, face.height);
                    return Err(vec![bad(format!("`{path}` is {width} by {height}, and all faces are squares of the first one's {side}"))]);
                }
                if self.checks { dark() } else { Cube::from_faces(&faces) }
            }
            Err(_) if self.checks => dark(),
            Err(one) => Cube::from_equirect(&one[0]),
        };
        let cube = Arc::new(cube);
        self.environment = Some((hash, cube.clone()));
        Ok(cube)
    }
}

/// A sky without light.
fn dark() -> Cube {
    Cube::of_directions(8, |_| [0.0; 3])
}

/// The files of a cubemap's faces with their names, or what is missing.
fn faces(folder: &str, loader: &dyn Loader) -> Result<Vec<(String, Vec<u8>)>, Vec<String>> {
    let folder = folder.trim_end_matches('/');
    let mut found = Vec::new();
    let mut wrong = Vec::new();
    for face in FACES {
        let mut why = String::new();
        let file = ENDINGS.iter().find_map(|ending| {
            let path = format!("{folder}/{face}.{ending}");
            let bytes = loader.read_up_to(&path, LARGEST_FILE).map_err(|error| why = error).ok()?;
            Some((path, bytes))
        });
        match file {
            Some(file) => found.push(file),
            None => wrong.push(format!("`{folder}/{face}` can't be read as .png, .jpg, .jpeg or .hdr: {why}")),
        }
    }
    if wrong.is_empty() { Ok(found) } else { Err(wrong) }
}

fn unreadable(path: &str, why: &str) -> String {
    format!("`{path}` can't be read: {why}")
}

fn bad_image(span: Span, words: String) -> Diagnostic {
    Diagnostic::new(Code::BadImage, span, words, "write the name of a PNG, JPEG or HDR image, relative to the file that names it")
}

/// The image in some bytes: in linear light, or its numbers as they stand there, 0 to 1. What it is, is seen from the bytes and not from a
/// name.
///
/// # Errors
///
/// Says in plain words what is wrong: no image, a broken one, or one larger than [`LONGEST_SIDE`] or [`MOST_BYTES`].
pub fn decode(bytes: &[u8], as_light: bool) -> Result<Bitmap, String> {
    let reader = || ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|e| e.to_string());
    let format = reader()?.format().ok_or("it is neither PNG, JPEG nor HDR")?;
    let (width, height) = reader()?.into_dimensions().map_err(|e| words(&e))?;
    // Three floats a pixel are what is made of it.
    let bytes_needed = u64::from(width) * u64::from(height) * 12;
    if width > LONGEST_SIDE || height > LONGEST_SIDE || bytes_needed > MOST_BYTES {
        return Err(format!("{width} by {height} pixels are too many: at most {LONGEST_SIDE} a side and {} MiB decoded", MOST_BYTES >> 20));
    }
    if width == 0 || height == 0 {
        return Err("it has no pixels".to_owned());
    }
    let mut reader = reader()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_SIDE);
    limits.max_image_height = Some(LONGEST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let image = reader.decode().map_err(|e| words(&e))?;
    // Light is stored as it is, pictures as a screen wants them.
    Ok(linear(&image, as_light && format != image::ImageFormat::Hdr))
}

/// The pixels of an image; `encoded` says that they are as a screen wants them.
fn linear(image: &DynamicImage, encoded: bool) -> Bitmap {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let plain = |c: f32| if c.is_finite() { c.max(0.0) } else { 0.0 };
    let texels = match image {
        DynamicImage::ImageRgb8(_) | DynamicImage::ImageRgba8(_) | DynamicImage::ImageLuma8(_) | DynamicImage::ImageLumaA8(_) => {
            let table: Vec<f32> = (0..=255).map(|i| i as f32 / 255.0).map(|c| if encoded { decoded(c) } else { c }).collect();
            image.to_rgb8().pixels().map(|p| p.0.map(|c| table[usize::from(c)])).collect()
        }
        _ => {
            let curve = |c: f32| if encoded { decoded(plain(c)) } else { plain(c) };
            image.to_rgb32f().pixels().map(|p| p.0.map(curve)).collect()
        }
    };
    Bitmap { width, height, texels }
}

/// sRGB to linear (IEC 61966-2-1).
fn decoded(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// One line, as what is wrong with an image.
fn words(error: &image::ImageError) -> String {
    let text = error.to_string();
    text.lines().next().unwrap_or("it can't be decoded").trim_end_matches('.').to_owned()
}
