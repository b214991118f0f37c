//! `surefoot render -o FILM`: moving pictures are read back, of the right number, size and length.

use super::{command, folder, run};
use image::AnimationDecoder;
use std::fs;
use std::io::BufReader;
use std::path::Path;

/// A ball that goes round once in half a second.
const ROUND: &str = "scene = sphere(0.5).translate(sin(4 * pi * time), cos(4 * pi * time), 0)\ncamera { eye: (0, 0, 6), target: (0, 0, 0) }\n";

/// How long each picture stays (milliseconds), and the pictures.
fn read(path: &Path) -> Vec<(f64, image::RgbaImage)> {
    let file = BufReader::new(fs::File::open(path).unwrap());
    let frames = match path.extension().unwrap().to_str().unwrap() {
        "gif" => image::codecs::gif::GifDecoder::new(file).unwrap().into_frames(),
        _ => image::codecs::png::PngDecoder::new(file).unwrap().apng().unwrap().into_frames(),
    };
    let frames = frames.map(|frame| {
        let frame = frame.unwrap();
        let (over, under) = frame.delay().numer_denom_ms();
        (f64::from(over) / f64::from(under), frame.into_buffer())
    });
    frames.collect()
}

#[test]
fn films_hold_what_was_asked_for() {
    let folder = folder("films");
    fs::write(folder.join("round.sdf"), ROUND).unwrap();
    let render = |args: &str| run(&folder, &["render", "round.sdf", "--device", "cpu", "--samples", "1", "--size", "40x30"].into_iter().chain(args.split(' ')).collect::<Vec<_>>());
    let none = (0, String::new(), String::new());
    assert_eq!(render("--loop 0.5 --fps 15 -o loop.gif"), none);
    assert_eq!(render("--loop 0.5 --fps 15 -o loop.apng"), none);
    assert_eq!(render("--frames 0..8 --fps 16 -o frames.apng"), none);
    assert_eq!(render("--loop 0.5 --fps 16 -o picture.png"), none);
    // Eight pictures of 7.5: the loop is as long as was asked for, not the picture.
    for (name, count) in [("loop.gif", 8), ("loop.apng", 8), ("frames.apng", 8)] {
        let frames = read(&folder.join(name));
        assert_eq!(frames.len(), count, "{name}");
        assert!(frames.iter().all(|(_, picture)| picture.dimensions() == (40, 30)), "{name}");
        let length: f64 = frames.iter().map(|(time, _)| time).sum();
        assert!((length - 500.0).abs() < 1e-6, "{name}: {length} ms");
    }
    // Nothing is lost in an APNG: its pictures are those of single files.
    for (n, (_, picture)) in read(&folder.join("frames.apng")).iter().enumerate() {
        let single = image::open(folder.join(format!("picture_{n:04}.png"))).unwrap().to_rgba8();
        assert_eq!(picture, &single, "picture {n}");
    }
    // The palette of a GIF is chosen for each picture.
    for ((_, gif), (_, png)) in read(&folder.join("loop.gif")).iter().zip(read(&folder.join("loop.apng"))) {
        let off: u32 = gif.iter().zip(png.iter()).map(|(a, b)| u32::from(a.abs_diff(*b))).sum();
        assert!(off < 4 * png.len() as u32, "{off} of {}", png.len());
    }
    // A scene that does not repeat is told of.
    let (code, _, said) = render("--loop 0.3 --fps 10 -o jumps.gif");
    assert!(code == 0 && said.contains("the picture at 0.3 s differs from that at 0 s in") && said.contains("fract(time / 0.3)"), "{said}");
}

#[test]
fn films_that_cannot_be_written_say_why() {
    let folder = folder("no_films");
    let render = |args: &str| run(&folder, &["render", "good.sdf", "--device", "cpu", "--size", "41x30"].into_iter().chain(args.split(' ')).collect::<Vec<_>>());
    for (args, words) in [
        ("-o film.gif", "--frames 0..120` or `--loop 4"),
        ("-o film.gif --loop 1 --fps 60", "--fps 50 or less"),
        ("-o film.mp4 --loop 1", "--size 42x30"),
        ("-o film.gif --loop 0", "above zero"),
        ("-o film.apng --loop 1e9", "a million frames"),
        ("-o film.mov --loop 1", "GIF, APNG, MP4 and WebM"),
        ("-o - --loop 1", "FILM.gif"),
        ("-o film.gif --loop 1 --frames 0..3", "cannot be used with"),
    ] {
        let (code, _, said) = render(args);
        assert!(code == 2 && said.contains(words), "{args}: {said}");
    }
    // Where ffmpeg is not installed.
    let mut without = command(&folder, &["render", "good.sdf", "--device", "cpu", "--size", "40x30", "-o", "film.mp4", "--loop", "0.1"]);
    let (code, _, said) = super::texts(without.env("PATH", folder.join("nothing")).output().unwrap());
    assert!(code == 2 && said.contains("apt-get install ffmpeg"), "{said}");
}
