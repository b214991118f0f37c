//! Files of moving pictures: GIF and APNG by kept crates, MP4 and WebM by the program ffmpeg. One picture at a time is in memory.

use std::ffi::OsString;
use std::fs::File;
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

/// The formats, by the ending of a file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Gif,
    Apng,
    Mp4,
    WebM,
}

impl Format {
    /// The format that this file's ending asks for, if it is one of moving pictures.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "gif" => Some(Self::Gif),
            "apng" => Some(Self::Apng),
            "mp4" => Some(Self::Mp4),
            "webm" => Some(Self::WebM),
            _ => None,
        }
    }

    /// Says why the format cannot hold pictures of this size (pixels) at this rate (pictures per second), and what to write instead.
    pub fn refuses(self, (width, height): (u32, u32), rate: f64) -> Option<String> {
        match self {
            // Browsers show a picture of less than two hundredths of a second for ten.
            Self::Gif if rate > 50.0 => Some("GIF shows at most 50 pictures per second: write --fps 50 or less".to_owned()),
            Self::Gif | Self::Apng if rate < 0.01 => Some("a picture stays for at most 100 seconds: write --fps 0.01 or more".to_owned()),
            // Colours are stored for blocks of two by two pixels.
            Self::Mp4 if !width.is_multiple_of(2) || !height.is_multiple_of(2) => {
                Some(format!("MP4 needs even sides: write --size {}x{}", width.next_multiple_of(2), height.next_multiple_of(2)))
            }
            _ => None,
        }
    }
}

/// A file that is being written.
pub struct Animation {
    size: (u32, u32),
    rate: f64,
    /// How many pictures are in it.
    pictures: u32,
    writer: Writer,
}

enum Writer {
    Gif(Box<image::codecs::gif::GifEncoder<BufWriter<File>>>),
    Apng(Box<png::Writer<BufWriter<File>>>),
    Ffmpeg(Ffmpeg),
}

/// The program, which ends with this.
struct Ffmpeg(Child);

impl Animation {
    /// Begins a file of `count` pictures, each of `size` pixels, of which `rate` are shown per second. GIF and APNG repeat without end.
    ///
    /// # Errors
    ///
    /// The file cannot be created, or ffmpeg is not installed.
    pub fn begin(path: &Path, format: Format, size: (u32, u32), rate: f64, count: u32) -> Result<Self, String> {
        let create = || File::create(path).map(BufWriter::new).map_err(|why| why.to_string());
        let writer = match format {
            Format::Gif => {
                // Of 1 to 30: 10 looks for the palette in a tenth of the pixels.
                let mut gif = image::codecs::gif::GifEncoder::new_with_speed(create()?, 10);
                gif.set_repeat(image::codecs::gif::Repeat::Infinite).map_err(|why| why.to_string())?;
                Writer::Gif(Box::new(gif))
            }
            Format::Apng => {
                let mut png = png::Encoder::new(create()?, size.0, size.1);
                png.set_color(png::ColorType::Rgba);
                png.set_depth(png::BitDepth::Eight);
                let (over, under) = delay(rate);
                png.set_animated(count, 0).and_then(|()| png.set_frame_delay(over, under)).map_err(|why| why.to_string())?;
                Writer::Apng(Box::new(png.write_header().map_err(|why| why.to_string())?))
            }
            Format::Mp4 => Writer::Ffmpeg(ffmpeg(path, size, rate, &["-c:v", "libx264", "-crf", "16", "-movflags", "+faststart"])?),
            Format::WebM => Writer::Ffmpeg(ffmpeg(path, size, rate, &["-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0", "-row-mt", "1"])?),
        };
        Ok(Self { size, rate, pictures: 0, writer })
    }

    /// Adds a picture: its rows from above, four bytes for each pixel.
    ///
    /// # Errors
    ///
    /// The disk is full, or ffmpeg ended.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), String> {
        match &mut self.writer {
            Writer::Gif(gif) => {
                let picture = image::RgbaImage::from_raw(self.size.0, self.size.1, rgba.to_vec()).ok_or("the picture has another size")?;
                // Its clock counts hundredths of a second: each picture ends at the one that is nearest.
                let end = |n: u32| (100.0 * f64::from(n) / self.rate).round() as u32;
                let time = end(self.pictures + 1) - end(self.pictures);
                let delay = image::Delay::from_numer_denom_ms(10 * time, 1);
                gif.encode_frame(image::Frame::from_parts(picture, 0, 0, delay)).map_err(|why| why.to_string())?;
            }
            Writer::Apng(png) => png.write_image_data(rgba).map_err(|why| why.to_string())?,
            Writer::Ffmpeg(ffmpeg) => {
                let sent = ffmpeg.0.stdin.as_mut().map_or(Ok(()), |pipe| pipe.write_all(rgba));
                if sent.is_err() {
                    return Err(ffmpeg.said());
                }
            }
        }
        self.pictures += 1;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    ///
    /// The disk is full, or ffmpeg could not write the file.
    pub fn finish(self) -> Result<(), String> {
        match self.writer {
            // Its last byte is written when it is dropped.
            Writer::Gif(gif) => drop(gif),
            Writer::Apng(png) => png.finish().map_err(|why| why.to_string())?,
            Writer::Ffmpeg(mut ffmpeg) => {
                drop(ffmpeg.0.stdin.take());
                if !ffmpeg.0.wait().map_err(|why| why.to_string())?.success() {
                    return Err(ffmpeg.said());
                }
            }
        }
        Ok(())
    }
}

/// `out.png` and 7 make `out_0007.png`.
pub fn numbered(path: &Path, number: u32) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = path.extension().map_or_else(|| "png".into(), |e| e.to_string_lossy());
    path.with_file_name(format!("{stem}_{number:04}.{extension}"))
}

/// How long a picture stays, as a fraction of seconds of 16 bits each.
fn delay(rate: f64) -> (u16, u16) {
    let over = [1, 1000, 100, 10].into_iter().find(|over| {
        let under = rate * f64::from(*over);
        (under - under.round()).abs() < 1e-6 && (1.0..=65535.0).contains(&under)
    });
    // A slow one that is no such fraction: thousandths of a second.
    over.map_or(((1000.0 / rate).round().clamp(1.0, 65535.0) as u16, 1000), |over| (over, (rate * f64::from(over)).round() as u16))
}

/// ffmpeg, which waits for pictures on its input.
fn ffmpeg(path: &Path, (width, height): (u32, u32), rate: f64, codec: &[&str]) -> Result<Ffmpeg, String> {
    // So a name that starts with a hyphen is no option, and one with a colon no address.
    let mut file = OsString::from("file:");
    file.push(path);
    let mut command = Command::new("ffmpeg");
    command
        .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba"])
        .args(["-s", &format!("{width}x{height}"), "-r", &rate.to_string(), "-i", "-", "-an"])
        // The colours of high definition video, which players take for granted.
        .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"])
        .args(codec)
        .args(["-pix_fmt", "yuv420p"])
        .arg(file);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    command.spawn().map(Ffmpeg).map_err(|why| match why.kind() {
        std::io::ErrorKind::NotFound => {
            "MP4 and WebM are written by the program ffmpeg, which is not installed (Debian: apt-get install ffmpeg); GIF and APNG need nothing else"
                .to_owned()
        }
        _ => format!("ffmpeg: {why}"),
    })
}

impl Ffmpeg {
    /// What it said before it ended.
    fn said(&mut self) -> String {
        let _ = self.0.kill();
        let mut said = String::new();
        if let Some(errors) = &mut self.0.stderr {
            let _ = errors.read_to_string(&mut said);
        }
        format!("ffmpeg ended: {}", said.trim().lines().last().unwrap_or("it says nothing"))
    }
}

impl Drop for Ffmpeg {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_stays_for_a_fraction_of_seconds() {
        assert_eq!(delay(30.0), (1, 30));
        assert_eq!(delay(29.97), (1000, 29970));
        assert_eq!(delay(0.5), (1000, 500));
        assert_eq!(delay(120.5), (100, 12050));
    }

    #[test]
    fn formats_refuse_what_they_cannot_hold() {
        assert_eq!(Format::Mp4.refuses((101, 50), 30.0).unwrap(), "MP4 needs even sides: write --size 102x50");
        assert!(Format::Gif.refuses((100, 50), 60.0).is_some());
        assert!(Format::Apng.refuses((101, 50), 60.0).is_none());
    }

    #[test]
    fn frames_are_numbered_before_the_extension() {
        assert_eq!(numbered(Path::new("a/out.png"), 7), Path::new("a/out_0007.png"));
        assert_eq!(numbered(Path::new("out"), 12345), Path::new("out_12345.png"));
    }
}
