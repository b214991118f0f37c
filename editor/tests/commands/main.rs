//! The command line as a shell sees it: what it prints and writes, and with which code it ends.

mod cases;
mod films;
mod hosts;
mod measure;
#[cfg(feature = "gpu")]
mod meshes;
mod shaders;

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const GOOD: &str = "\
param size = 1 in 0.2..2 \"how large\"
param style = block in [block, ball]
shape block = box(1)
shape ball = sphere(0.6)
scene = sphere(size) | style.translate(2, 0, 0)
camera front { eye: (0, 0, 6), target: (0, 0, 0) }
camera top { eye: (0, 6, 0.1), target: (0, 0, 0) }
";
const BAD: &str = "scene = spere(1) | box(-1)\n";

/// A folder of its own.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("commands").join(test);
    fs::remove_dir_all(&folder).ok();
    fs::create_dir_all(&folder).unwrap();
    fs::write(folder.join("good.sdf"), GOOD).unwrap();
    fs::write(folder.join("bad.sdf"), BAD).unwrap();
    folder
}

fn command(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_surefoot"));
    command.current_dir(folder).args(args).stdin(Stdio::null());
    // What it keeps is nothing of who runs the tests.
    command.env("XDG_CACHE_HOME", folder.join("cache"));
    command
}

fn run(folder: &Path, args: &[&str]) -> (i32, String, String) {
    texts(command(folder, args).output().unwrap())
}

fn texts(output: Output) -> (i32, String, String) {
    let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
    (output.status.code().unwrap_or(-1), text(output.stdout), text(output.stderr))
}

fn size(path: &Path) -> (u32, u32) {
    image::image_dimensions(path).unwrap()
}

#[test]
fn check_says_what_is_wrong_and_ends_with_a_code() {
    let folder = folder("check");
    let (code, out, _) = run(&folder, &["check", "good.sdf"]);
    assert_eq!(code, 0);
    assert!(out.starts_with("good.sdf: fine\n  left out:\n    ") && out.contains("style: a choice among names"), "{out}");
    let (code, out, _) = run(&folder, &["check", "bad.sdf"]);
    assert_eq!(code, 1);
    assert!(out.contains("error[unknown-name]") && out.contains("bad.sdf:1:9"), "{out}");
    assert!(!out.contains('\u{1b}'), "no colours where nobody sees them");
    let (code, _, _) = run(&folder, &["check", "nowhere.sdf"]);
    assert_eq!(code, 2);
    let (code, _, _) = run(&folder, &["check"]);
    assert_eq!(code, 2);
}

/// What a program that builds must look at again.
#[test]
fn check_names_all_files_of_a_scene() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let files = |scene: &str| {
        let (_, out, _) = run(&examples, &["check", "--json", scene]);
        let report: Value = serde_json::from_str(&out).unwrap();
        report["files"].as_array().unwrap().iter().map(|file| file.as_str().unwrap().to_owned()).collect::<Vec<_>>()
    };
    for scene in ["statue.sdf", "stone_column.sdf", "chrome.sdf", "colonnade.sdf"] {
        let files = files(scene);
        assert!(files.len() > 1 && files.iter().all(|file| examples.join(file).exists()), "{files:?}");
    }
}

#[test]
fn check_tells_a_machine_everything() {
    let folder = folder("json");
    let (code, out, _) = run(&folder, &["check", "--json", "good.sdf", "bad.sdf", "nowhere.sdf"]);
    assert_eq!(code, 2);
    let lines: Vec<Value> = out.lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let [good, bad, nowhere] = lines.as_slice() else { panic!("{out}") };
    assert_eq!(good["ok"], true);
    assert_eq!(good["scene"]["primitives"], 2);
    assert!(good["scene"]["nodes"].as_u64().unwrap() > 0);
    assert_eq!(good["scene"]["factor"], 1.0);
    assert!(good["scene"]["kind"].is_string());
    assert!(good["scene"]["bounds"]["max"][0].as_f64().unwrap() >= 2.5);
    assert_eq!(good["parameters"][0]["name"], "size");
    assert_eq!(good["parameters"][0]["max"], 2.0);
    assert_eq!(good["parameters"][1]["choices"][1], "ball");
    assert_eq!(good["functions"].as_array().unwrap().len(), 9);
    assert!(good["skipped"][0].as_str().unwrap().contains("style"), "no module can hold a choice");
    assert_eq!(bad["ok"], false);
    assert_eq!(bad["scene"], Value::Null);
    let first = &bad["diagnostics"][0];
    assert_eq!(first["severity"], "error");
    assert_eq!(first["code"], "unknown-name");
    assert_eq!(first["file"], "bad.sdf");
    assert_eq!((&first["line"], &first["column"]), (&1.into(), &9.into()));
    assert_eq!((&first["end_line"], &first["end_column"]), (&1.into(), &14.into()));
    assert!(first["help"].as_str().unwrap().contains("sphere"));
    assert_eq!(nowhere["ok"], false);
}

#[test]
fn check_explains_factors_and_strict_refuses_what_is_measured() {
    let folder = folder("factors");
    fs::write(folder.join("column.sdf"), "param rate = 0.5 in 0..2\nscene = box((1, 2, 1)).twist(y, rate)\n").unwrap();
    fs::write(folder.join("steep.sdf"), "field f = 1 / p.x - 2\nscene = f\n").unwrap();
    let (code, out, _) = run(&folder, &["check", "--factors", "column.sdf", "good.sdf"]);
    assert_eq!(code, 0);
    for words in [
        "from twist at column.sdf:2:24, rate 2",
        "derived within x -",
        "for all rate in 0..2; ×",
        "at the defaults",
        "times the steps near it",
        "found by the rule twist (without it ×",
        "lower it with a narrower range of `rate`",
        "good.sdf: fine\n  no factor: every step is a whole distance\n",
    ] {
        assert!(out.contains(words), "{words} is not in\n{out}");
    }
    let (_, out, _) = run(&folder, &["check", "--json", "column.sdf"]);
    let report: Value = serde_json::from_str(&out).unwrap();
    let factor = &report["scene"]["factors"][0];
    assert_eq!((&factor["file"], &factor["line"], &factor["column"]), (&"column.sdf".into(), &2.into(), &24.into()));
    assert_eq!((&factor["operation"], &factor["proof"]), (&"twist".into(), &"derived".into()));
    assert!(factor["live"].as_f64() < factor["factor"].as_f64());
    assert!(factor["region"]["max"][1].as_f64().unwrap() >= 1.0);
    assert_eq!(factor["parameters"][0]["name"], "rate");
    assert_eq!(factor["rules"], Value::Null);
    let (_, out, _) = run(&folder, &["check", "--json", "--factors", "column.sdf"]);
    let asked: Value = serde_json::from_str(&out).unwrap();
    let rule = &asked["scene"]["factors"][0]["rules"][0];
    assert_eq!(rule["id"], "twist");
    // What it is said to gain is what switching it off costs.
    let (_, out, _) = run(&folder, &["check", "--json", "--without-rule", "twist", "column.sdf"]);
    let less: Value = serde_json::from_str(&out).unwrap();
    let [without, said] = [&less["scene"]["factors"][0]["factor"], &rule["without"]].map(|number| number.as_f64().unwrap());
    assert!(without > 1.05 * factor["factor"].as_f64().unwrap() && (without - said).abs() < 0.01 * said, "{without} {said}");
    let (code, _, words) = run(&folder, &["check", "--without-rule", "twister", "column.sdf"]);
    assert!(code != 0 && words.contains("the rules are claims, "), "{words}");
    let (_, wgsl, _) = run(&folder, &["compile", "column.sdf"]);
    let line = "factor: derived, twist at column.sdf:2:24";
    assert!(wgsl.lines().any(|l| l.contains(factor["uniform"].as_str().unwrap()) && l.contains(line)), "{wgsl}");

    let (code, out, _) = run(&folder, &["check", "--factors", "steep.sdf"]);
    assert!(code == 0 && out.contains("unproven: measured at samples") && !out.contains('\u{1b}'), "{out}");
    let (_, wgsl, _) = run(&folder, &["compile", "steep.sdf"]);
    assert!(wgsl.contains("factor: UNPROVEN, measured at samples, formula at steep.sdf:1:11"), "{wgsl}");
    for command in ["check", "compile"] {
        let (code, out, err) = run(&folder, &[command, "--strict", "steep.sdf"]);
        assert!(code == 1 && (out + &err).contains("error[no-bound]"), "{command}");
    }
    let (code, _, err) = run(&folder, &["render", "--strict", "steep.sdf", "-o", "a.png", "--device", "cpu"]);
    assert!(code == 1 && err.contains("error[no-bound]"), "{err}");
}

#[test]
fn verify_passes_a_sound_scene_and_counts() {
    let folder = folder("verify");
    let args = ["verify", "good.sdf", "--samples", "800", "--certified", "40", "--seed", "7", "--device", "cpu"];
    let (code, out, err) = run(&folder, &args);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    for words in ["good.sdf: no violation", "800 points along 8 directions each, at 8 values", "certified to be empty", "at the median"] {
        assert!(out.contains(words), "{words} is not in\n{out}");
    }
    let (code, out, _) = run(&folder, &[&args[..], &["--json"]].concat());
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((code, &report["ok"], &report["points"]), (0, &true.into(), &800.into()));
    assert!((30..=40).contains(&report["balls"]["empty"].as_u64().unwrap()) && report["device"].is_null());
    assert!(report["tightness"]["p50"].as_f64().unwrap() <= 1.0 + 1e-9);

    fs::write(folder.join("steep.sdf"), "field f = (1 / max(p.x, 0.1) - 2) * sqrt(abs(p.y))\nscene = f.within(box(2))\n").unwrap();
    let (_, out, _) = run(&folder, &["verify", "steep.sdf", "--samples", "400", "--device", "cpu"]);
    assert!(out.contains("unproven"), "{out}");
    let (code, _, err) = run(&folder, &["verify", "bad.sdf"]);
    assert!(code == 1 && err.contains("unknown-name"), "{err}");
    let (code, _, _) = run(&folder, &["verify", "nowhere.sdf"]);
    assert_eq!(code, 2);
}

#[cfg(feature = "gpu")]
#[test]
fn verify_holds_the_emitted_module_to_the_same() {
    let folder = folder("verify-gpu");
    let (code, out, err) = run(&folder, &["verify", "good.sdf", "--samples", "800", "--device", "gpu", "--json"]);
    assert_eq!(code, 0, "{out}{err}");
    let report: Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&report["device"]["points"], &report["device"]["within"]), (&800.into(), &800.into()));
    assert!(report["device"]["worst"].as_f64().unwrap() < 1.0);
}

#[test]
fn compile_writes_every_language_and_nothing_on_an_error() {
    let folder = folder("compile");
    for target in ["wgsl", "glsl", "hlsl", "msl", "spirv"] {
        let args = ["compile", "good.sdf", "-o", target, "--target", target];
        let (code, out, err) = run(&folder, &args);
        assert_eq!((code, out.as_str()), (0, ""), "{target}: {err}");
        assert!(fs::metadata(folder.join(target)).unwrap().len() > 100, "{target}");
    }
    let spirv = fs::read(folder.join("spirv")).unwrap();
    assert_eq!(spirv[..4], [3, 2, 35, 7]);

    let args = ["compile", "good.sdf", "--functions", "bound", "--prefix", "my_", "--group", "2"];
    let (code, text, _) = run(&folder, &args);
    assert_eq!(code, 0);
    assert!(text.contains("fn my_bound(") && !text.contains("fn my_trace("), "{text}");
    assert!(text.contains("@group(2) @binding(0)") && !text.contains("sf_"));
    let (_, dash, _) = run(&folder, &[&args[..], &["-o", "-"]].concat());
    assert_eq!(dash, text, "the same source gives the same bytes");

    let (code, out, err) = run(&folder, &["compile", "bad.sdf", "-o", "out.wgsl"]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert!(err.contains("unknown-name"), "{err}");
    assert!(!folder.join("out.wgsl").exists());
    for wrong in [["--functions", "tracer"], ["--prefix", "a__b"], ["--target", "metal"]] {
        let (code, _, _) = run(&folder, &[&["compile", "good.sdf"], &wrong[..]].concat());
        assert_eq!(code, 2, "{wrong:?}");
    }
}

/// Small tables are private variables, which drivers pick from without a copy; larger ones are more than WGSL promises to take. Other languages have constants.
#[test]
fn compile_writes_tables_into_the_text_or_beside_it() {
    let folder = folder("tables");
    for (name, count, held) in [("few", 100, "var<private> "), ("many", 700, "const ")] {
        let text = format!("scene = for i in 0..{count} {{ sphere(0.1).translate(4 * hash3(i)) }}");
        fs::write(folder.join(format!("{name}.sdf")), text).unwrap();
        let (code, wgsl, err) = run(&folder, &["compile", &format!("{name}.sdf")]);
        assert!(code == 0 && err.contains("--tables buffers"), "{err}");
        assert!(["table", "lists"].iter().all(|table| wgsl.contains(&format!("\n{held}sf_{table} = array"))), "{name}");
    }
    let (_, metal, _) = run(&folder, &["compile", "few.sdf", "--target", "msl"]);
    let constant = |table: &str| metal.lines().any(|line| line.starts_with("constant ") && line.contains(&format!(" sf_{table} = ")));
    assert!(constant("table") && constant("lists") && !metal.contains("thread type_"), "{metal}");

    let buffers = ["--tables", "buffers"];
    let (code, _, err) = run(&folder, &[&["compile", "few.sdf", "-o", "out.wgsl"], &buffers[..]].concat());
    assert_eq!((code, err.as_str()), (0, ""));
    let wgsl = fs::read_to_string(folder.join("out.wgsl")).unwrap();
    for (binding, file) in [(1, "out.table.bin"), (2, "out.lists.bin")] {
        let bytes = fs::metadata(folder.join(file)).unwrap().len();
        assert!(bytes > 400 && wgsl.contains(&format!(", {bytes} bytes\n")), "{file}: {bytes}");
        assert!(wgsl.contains(&format!("@group(0) @binding({binding}) var<storage, read> ")), "{wgsl}");
    }
    let (_, _, err) = run(&folder, &[&["compile", "good.sdf", "-o", "out.wgsl"], &buffers[..]].concat());
    assert!(err.contains("no large unions"), "{err}");
    for wrong in [&[][..], &["-o", "-"], &["-o", "out.glsl", "--target", "glsl"]] {
        let (code, _, err) = run(&folder, &[&["compile", "few.sdf"], &buffers[..], wrong].concat());
        assert_eq!(code, 2, "{wrong:?}: {err}");
    }
}

#[test]
fn compile_tells_a_host_the_layout() {
    let folder = folder("layout");
    let text = "param size = 1.5 in 0.1..2\nparam spot: vec3 = (0, 1, 0) in (-1, -1, -1)..(1, 1, 1)\nparam style = a in [a, b]\n\
        shape a = sphere(size)\nshape b = box(size)\nscene = style.translate(spot).rotate(y, time) | box(1).twist(y, 0.5)";
    fs::write(folder.join("a.sdf"), text).unwrap();
    let args = ["compile", "a.sdf", "-o", "a.wgsl", "--layout", "a.json", "--prefix", "my_", "--group", "2", "--set", "style=b"];
    let (exit, _, words) = run(&folder, &args);
    assert_eq!(exit, 0, "{words}");
    let layout: Value = serde_json::from_str(&fs::read_to_string(folder.join("a.json")).unwrap()).unwrap();
    let module = fs::read_to_string(folder.join("a.wgsl")).unwrap();
    assert_eq!((&layout["group"], &layout["functions"][0]), (&json!(2), &json!("my_field(p: vec3f) -> f32")));
    assert!(module.contains(&format!("has {} bytes", layout["size"])));
    // What the head of the module says to people.
    let rows: Vec<Vec<&str>> = module.lines().take_while(|l| l.starts_with("//")).map(|l| l.split_whitespace().skip(1).collect()).collect();
    let uniforms = layout["uniforms"].as_array().unwrap();
    for field in uniforms {
        let known = [field["offset"].to_string(), field["type"].as_str().unwrap().to_owned(), field["name"].as_str().unwrap().to_owned()];
        assert!(rows.iter().any(|row| row.get(..3).is_some_and(|row| row.iter().zip(&known).all(|(a, b)| a == b))), "{field}");
    }
    let sources: Vec<_> = uniforms.iter().map(|f| f["source"].as_str().unwrap()).collect();
    assert!(["origin", "parameter", "factor", "computed"].iter().all(|s| sources.contains(s)), "{sources:?}");
    let spot = uniforms.iter().find(|f| f["parameter"] == "spot").unwrap();
    assert_eq!(spot["start"], json!([0.0, 1.0, 0.0]));
    assert!(layout["computed"].as_array().unwrap().iter().all(|line| module.contains(&format!("//   {}\n", line.as_str().unwrap()))));
    // A choice is the text's, though another one is compiled.
    assert_eq!((&layout["parameters"][2]["default"], &layout["parameters"][0]["max"]), (&json!("a"), &json!(2.0)));
    assert_eq!(layout["chosen"], json!({ "style": "b" }));
    let (exit, _, words) = run(&folder, &["compile", "a.sdf", "-o", "a.wgsl", "--layout", "./a.wgsl"]);
    assert!(exit == 2 && words.contains("written twice"), "{words}");
}

#[test]
fn fmt_lays_out_in_place_and_only_asks_with_check() {
    let folder = folder("fmt");
    let path = folder.join("loose.sdf");
    let loose = "scene=sphere( 1 )|box(2)   // both\n";
    fs::write(&path, loose).unwrap();
    let (code, out, _) = run(&folder, &["fmt", "--check", "loose.sdf"]);
    assert_eq!((code, out.as_str()), (1, "loose.sdf\n"));
    assert_eq!(fs::read_to_string(&path).unwrap(), loose);
    let (code, _, _) = run(&folder, &["fmt", "loose.sdf"]);
    assert_eq!(code, 0);
    let laid_out = fs::read_to_string(&path).unwrap();
    assert!(laid_out.starts_with("scene = sphere(1) | box(2)"), "{laid_out}");
    let (code, _, _) = run(&folder, &["fmt", "--check", "loose.sdf"]);
    assert_eq!(code, 0);

    let stdin = fs::File::open(folder.join("loose.sdf")).unwrap();
    let (code, out, _) = texts(command(&folder, &["fmt", "-"]).stdin(stdin).output().unwrap());
    assert_eq!((code, out), (0, laid_out));

    fs::write(&path, "scene = (\n").unwrap();
    let (code, _, err) = run(&folder, &["fmt", "loose.sdf"]);
    assert!(code == 1 && err.contains("error["), "{err}");
    assert_eq!(fs::read_to_string(&path).unwrap(), "scene = (\n");
    let (code, _, _) = run(&folder, &["fmt", "nowhere.sdf"]);
    assert_eq!(code, 2);
}

#[test]
fn render_writes_pictures_without_graphics() {
    let folder = folder("render");
    let small = ["--size=48x32", "--device=cpu"];
    let render = |more: &[&str]| {
        let (code, _, err) =
            run(&folder, &[&["render", "good.sdf", "-o", "a.png"], &small[..], more].concat());
        (code, err)
    };
    assert_eq!(render(&[]), (0, String::new()));
    assert_eq!(size(&folder.join("a.png")), (48, 32));
    let picture = || image::open(folder.join("a.png")).unwrap().to_rgb8();
    let first = picture();
    assert_eq!(render(&["--set", "size=0.3"]).0, 0);
    assert_ne!(picture(), first);
    assert_eq!(render(&["--set", "style=ball"]).0, 0);
    assert_ne!(picture(), first);
    assert_eq!(render(&["--camera", "top"]).0, 0);
    assert_ne!(picture(), first);
    assert_eq!(render(&["--view", "normals"]).0, 0);
    assert_ne!(picture(), first);

    assert_eq!(render(&["--frames", "3..5"]), (0, String::new()));
    assert!(folder.join("a_0003.png").exists() && folder.join("a_0004.png").exists());
    assert!(!folder.join("a_0005.png").exists());

    for (wrong, words) in [
        (["--set", "sise=1"], "no such parameter"),
        (["--set", "size=5"], "outside of 0.2 to 2"),
        (["--set", "size=1,2"], "1 number"),
        (["--set", "style=round"], "block, ball"),
        (["--camera", "side"], "front, top"),
        (["--frames", "5..3"], "not above"),
    ] {
        let (code, err) = render(&wrong);
        assert!(code == 1 || code == 2, "{wrong:?}: {code}");
        assert!(err.contains(words), "{wrong:?}: {err}");
    }
    let (code, _, err) = run(&folder, &["render", "good.sdf", "-o", "b.png", "--size", "0x0"]);
    assert!(code == 2 && err.contains("from 1 to 16384"), "{err}");
    let (code, _, _) = run(&folder, &["render", "bad.sdf", "-o", "b.png"]);
    assert_eq!(code, 1);
    assert!(!folder.join("b.png").exists());
}

#[test]
fn without_an_adapter_the_processor_draws_unless_graphics_were_asked_for() {
    let folder = folder("adapter");
    let render = |device: &str| {
        let args = ["render", "good.sdf", "-o", "a.png", "--size", "32x32", "--device", device];
        // No machine that runs these tests has this one.
        let backend = if cfg!(windows) { "metal" } else { "dx12" };
        texts(command(&folder, &args).env("WGPU_BACKEND", backend).output().unwrap())
    };
    let (code, _, err) = render("gpu");
    assert_eq!(code, 3, "{err}");
    assert!(!folder.join("a.png").exists());
    let (code, _, err) = render("auto");
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("processor") && err.contains("meshes and balls"), "{err}");
    assert!(folder.join("a.png").exists());
}

#[test]
fn bands_of_rows_are_those_of_the_whole_picture() {
    let folder = folder("bands");
    // Lit, so that levels are spread over the pixels, and larger than what is drawn at once.
    fs::write(folder.join("lit.sdf"), "scene = sphere(1) | plane(y, -1)\nlight sun { direction: (-1, -2, -1), shadow: soft(3deg) }\n").unwrap();
    fs::write(folder.join("glows.sdf"), "scene = sphere(1)\nrender { bloom: 0.2 }\n").unwrap();
    let devices: &[&str] = if cfg!(feature = "gpu") { &["cpu", "gpu"] } else { &["cpu"] };
    for device in devices {
        let draw = |more: &[&str], out: &str| {
            let args = [&["render", "lit.sdf", "-o", out, "--size=60x530", "--samples=2", "--device", device], more].concat();
            let (code, _, err) = run(&folder, &args);
            assert_eq!(code, 0, "{err}");
            image::open(folder.join(out)).unwrap().to_rgba8().into_raw()
        };
        let whole = draw(&[], "whole.png");
        let bands: Vec<Vec<u8>> = ["1/3", "2/3", "3/3"].into_iter().map(|tile| draw(&["--tile", tile], "band.png")).collect();
        assert_eq!(size(&folder.join("band.png")), (60, 177), "{device}");
        assert!(bands.concat() == whole, "{device}: bands are other than the whole");
        let (code, _, err) = run(&folder, &["render", "glows.sdf", "-o", "a.png", "--tile=1/2", "--size=32x32", "--samples=2", "--device", device]);
        assert!(code == 2 && err.contains("drawn as a whole"), "{err}");
    }
    for (tile, out, words) in [("0/4", "a.png", "1/8 for the first"), ("1/99", "a.png", "has no 99 bands"), ("1/2", "a.gif", "is a film")] {
        let (code, _, err) = run(&folder, &["render", "good.sdf", "-o", out, "--frames=0..2", "--tile", tile, "--size=32x32"]);
        assert!(code == 2 && err.contains(words), "{tile}: {err}");
    }
}

#[cfg(feature = "gpu")]
#[test]
fn both_devices_draw_the_same_picture() {
    let folder = folder("devices");
    for device in ["gpu", "cpu"] {
        let out = format!("{device}.png");
        let args = ["render", "good.sdf", "-o", &out, "--size", "96x64", "--device", device];
        let (code, _, err) = run(&folder, &args);
        assert_eq!(code, 0, "{device}: {err}");
    }
    let open = |name: &str| image::open(folder.join(name)).unwrap().to_rgb8().into_raw();
    let (gpu, cpu) = (open("gpu.png"), open("cpu.png"));
    let apart = gpu.iter().zip(&cpu).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    assert!(apart * 100 < gpu.len(), "{apart} of {} values differ", gpu.len());
}

#[test]
fn without_a_display_a_view_becomes_a_picture() {
    let folder = folder("view");
    let mut command = command(&folder, &["good.sdf"]);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let (code, _, err) = texts(command.output().unwrap());
    assert_eq!(code, 0, "{err}");
    assert!(err.contains("no window") && err.contains("good.png"), "{err}");
    assert_eq!(size(&folder.join("good.png")), (1280, 720));
    // What is there already stays.
    fs::write(folder.join("good.png"), "mine").unwrap();
    let (code, _, err) = texts(command.output().unwrap());
    assert!(code == 0 && err.contains("good.2.png"), "{err}");
    assert_eq!(fs::read(folder.join("good.png")).unwrap(), b"mine");
    assert_eq!(size(&folder.join("good.2.png")), (1280, 720));
}

#[test]
fn explain_knows_every_code() {
    let folder = folder("explain");
    let (code, all, _) = run(&folder, &["explain"]);
    assert_eq!(code, 0);
    for line in all.lines() {
        let name = line.split_whitespace().next().unwrap();
        let (code, text, _) = run(&folder, &["explain", name]);
        assert!(code == 0 && text.contains(&format!("[{name}]")), "{name}");
    }
    let (code, _, _) = run(&folder, &["explain", "nonsense"]);
    assert_eq!(code, 2);
}

#[test]
fn bench_measures_each_stage() {
    let folder = folder("bench");
    let args = ["bench", "--compile", "good.sdf", "--runs", "3", "--json"];
    let (code, out, err) = run(&folder, &args);
    assert_eq!(code, 0, "{err}");
    let report: Value = serde_json::from_str(&out).unwrap();
    let names: Vec<_> = report["stages"].as_array().unwrap().iter().map(|s| &s["name"]).collect();
    assert!(names.len() >= 5 && names.contains(&&Value::from("naga's check")), "{names:?}");
}

#[test]
fn balls_fall_the_same_way_each_time() {
    let folder = folder("simulate");
    let text = "scene = plane(y) | sphere(0.5)\nballs b { count: 300, radius: 0.03..0.06, spawn: (-0.5, 1, -0.5)..(0.5, 2, 0.5), seed: 4 }\n";
    fs::write(folder.join("balls.sdf"), text).unwrap();
    let devices: &[&str] = if cfg!(feature = "gpu") { &["gpu", "cpu"] } else { &["cpu"] };
    for device in devices {
        for out in ["one.csv", "two.csv"] {
            let (code, said, err) = run(&folder, &["simulate", "balls.sdf", "--seconds", "1", "--device", device, "-o", out]);
            assert_eq!(code, 0, "{err}");
            assert!(said.starts_with("300 balls for 1 s"), "{said}");
        }
        let read = |name: &str| fs::read_to_string(folder.join(name)).unwrap();
        assert_eq!(read("one.csv"), read("two.csv"), "{device}");
        assert_eq!(read("one.csv").lines().count(), 301);
    }
    let (code, ..) = run(&folder, &["simulate", "balls.sdf", "--seconds", "0.1", "--device", "cpu", "-o", "end.ply", "--frames", "."]);
    assert_eq!(code, 0);
    assert!(fs::read_to_string(folder.join("end.ply")).unwrap().contains("element vertex 300"));
    assert!(folder.join("balls_0006.csv").exists() && !folder.join("balls_0007.csv").exists());
    let (code, _, err) = run(&folder, &["simulate", "good.sdf"]);
    assert_eq!(code, 2);
    assert!(err.contains("has no balls"), "{err}");
}

#[cfg(feature = "gpu")]
#[test]
fn bake_says_what_it_found_and_writes_a_grid() {
    let folder = folder("bake");
    let wedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n";
    fs::write(folder.join("open.obj"), wedge).unwrap();
    fs::write(folder.join("whole.obj"), format!("{wedge}f 2 3 4\n")).unwrap();
    fs::write(folder.join("cut.obj"), "v 0 0 0\nv 1 0 0\n").unwrap();
    let bake = |mesh: &str, more: &[&str]| run(&folder, &[&["bake", mesh, "-o", "out.sfgrid", "--resolution", "16"], more].concat());
    let (code, out, said) = bake("whole.obj", &["--report"]);
    assert_eq!((code, said.as_str()), (0, ""));
    assert!(out.contains("4 vertices, 4 triangles, 1 shell, volume 0.166667") && out.contains("found: nothing wrong\n  sides by pseudonormal\n"), "{out}");
    let bytes = fs::read(folder.join("out.sfgrid")).unwrap();
    assert!(out.contains("16 × 16 × 16 cells") && out.contains(&format!(" {} bytes", bytes.len())), "{out}");
    assert!(bytes.starts_with(b"SFGRID"));
    let (code, _, said) = bake("open.obj", &[]);
    assert!(code == 0 && said.contains("open.obj has 3 open edges; sides are found by winding"), "{said}");
    assert!(bake("open.obj", &["--sign", "parity", "--report"]).1.contains("sides by parity"));
    let (code, _, said) = bake("cut.obj", &[]);
    assert!(code == 2 && said.contains("can't bake cut.obj: it has no triangles"), "{said}");
    assert_eq!(bake("whole.obj", &["--padding", "7"]).0, 2);
    let (code, _, said) = run(&folder, &["bake", "whole.obj", "-o", "out.png"]);
    assert!(code == 2 && said.contains("the name ends with .sfgrid"), "{said}");
}

#[test]
fn bench_finds_what_steps_too_far_and_nothing_in_ours() {
    let folder = folder("bench-rays");
    let blade = "camera { eye: (3.5, 3.5, 4.5), target: (0, 0, 0), fov: 45deg }\nscene = box((4, 1, 0.16)).twist(z, 3)\n";
    fs::write(folder.join("blade.sdf"), blade).unwrap();
    let args = ["bench", "blade.sdf", "--size", "48x48", "--rounds", "1", "--sweep", "--json", "out.json", "--page", "page.md"];
    let (code, out, err) = run(&folder, &args);
    if code == 3 {
        // There is nothing that could follow a ray.
        assert!(err.contains("adapter"), "{err}");
        return;
    }
    assert_eq!(code, 0, "{out}{err}");
    let report: Value = serde_json::from_slice(&fs::read(folder.join("out.json")).unwrap()).unwrap();
    let of = |method: &str, what: &str| {
        let rows = report["scenes"][0]["methods"].as_array().unwrap();
        let row = rows.iter().find(|r| r["method"] == method).unwrap();
        row[what].as_f64().unwrap_or_else(|| row[what]["p99"].as_f64().unwrap())
    };
    assert!(of("ours", "judged") > 1000.0);
    assert_eq!((of("ours", "missed"), of("ours", "inside")), (0.0, 0.0));
    // One more look where the line says is worth a turned normal.
    assert!(of("ours", "normal_degrees") < 0.02 && of("no-leap", "normal_degrees") > 0.1);
    // The last half pixel costs little, and is worth it.
    assert!(of("ours", "depth_pixels") < 0.5 * of("half-pixel", "depth_pixels"));
    assert!(of("ours", "operations_per_ray") < 1.3 * of("half-pixel", "operations_per_ray"));
    // Within the box about the scene little is left for longer steps to save; most is saved by the box.
    assert!(of("ours", "operations_per_ray") < of("whole-steps", "operations_per_ray"));
    assert!(of("ours", "operations_per_ray") < 0.5 * of("no-region", "operations_per_ray"));
    // The instrument sees a factor that is left out, and one that is too small.
    for method in ["plain", "hand", "bound x4.0"] {
        assert!(of(method, "missed") > 0.0, "{method}");
    }
    assert!(of("half-factors", "depth_pixels") > 10.0 * of("ours", "depth_pixels"));
    // It says where: that pixel shows nothing, and the truth something.
    let plain = report["scenes"][0]["methods"].as_array().unwrap().iter().find(|r| r["method"] == "plain").unwrap();
    let missed = plain["wrong"].as_array().unwrap().iter().filter(|pixel| pixel["what"] == "missed").count();
    assert!(missed > 0 && missed as f64 <= plain["missed"].as_f64().unwrap());
    assert!(plain["wrong"][0]["t"].is_f64() && plain["wrong"][0]["answered"].is_f64(), "{}", plain["wrong"][0]);
    for file in ["page.md", "page.svg"] {
        assert!(fs::metadata(folder.join(file)).is_ok_and(|m| m.len() > 1000), "{file}");
    }
    let (code, _, err) = run(&folder, &["bench", "blade.sdf", "--methods", "best"]);
    assert!(code == 2 && err.contains("ours, no-planes"), "{err}");
}

#[cfg(feature = "gpu")]
#[test]
fn bench_lists_what_nobody_knows_and_stands_in_no_wall() {
    let folder = folder("bench-unknown");
    // The second camera would stand behind the wall; nothing is certain of the skin that `a - a` leaves.
    let scene = "camera { eye: (0.4, 1.2, 4), target: (0, 0, 0) }\nscene = (box(1) - box(1)) | sphere(0.4).translate(1, 0, 0) | plane(z, -2.5)\n";
    fs::write(folder.join("skin.sdf"), scene).unwrap();
    let args = ["bench", "skin.sdf", "--size", "32x32", "--views", "2", "--methods", "ours,no-leap", "--rounds", "1", "--json", "out.json"];
    let (code, out, err) = run(&folder, &args);
    if code == 3 {
        return;
    }
    assert_eq!(code, 0, "{out}{err}");
    let report: Value = serde_json::from_slice(&fs::read(folder.join("out.json")).unwrap()).unwrap();
    let scene = &report["scenes"][0];
    let unknown = scene["unknown"].as_array().unwrap();
    let ours = &scene["methods"][0];
    assert_eq!(unknown.len() as u64, ours["unknown"].as_u64().unwrap());
    assert!(out.contains(&format!("{} unknown", unknown.len())), "{out}");
    for view in [0, 1] {
        let own = unknown.iter().filter(|u| u["view"] == view && u["why"] == "ambiguous");
        assert!(own.clone().count() > 20, "view {view}: {unknown:?}");
        assert!(own.into_iter().all(|u| u["x"].as_u64().unwrap() < 32 && u["t"].as_f64().unwrap() > 0.1));
    }
    assert_eq!((ours["missed"].as_u64(), ours["false"].as_u64()), (Some(0), Some(0)), "{out}");
    assert!(ours["depth_pixels"]["max"].as_f64().unwrap() < 0.5, "{out}");
}

/// What a scene reads stays as it is, whatever is asked to be written.
#[test]
fn nothing_that_a_scene_reads_is_written_over() {
    let folder = folder("read");
    let stone = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/images/stone.png");
    for name in ["stone.png", "stone_0001.png", "sky.png"] {
        fs::copy(stone, folder.join(name)).unwrap();
    }
    let text = "material m { texture: \"stone.png\" }\nmaterial n { texture: \"stone_0001.png\" }
scene = sphere(1).material(m) | box(1).translate(2, 0, 0).material(n)\nenvironment { sky: equirect(\"sky.png\") }\n";
    fs::write(folder.join("stone.sdf"), text).unwrap();
    let before = fs::read(stone).unwrap();
    for args in [
        &["render", "stone.sdf", "-o", "stone.png", "--size", "8x8"][..],
        &["render", "stone.sdf", "-o", "sky.png", "--size", "8x8"],
        &["render", "stone.sdf", "-o", "stone.png", "--size", "8x8", "--frames", "0..3"],
        &["compile", "stone.sdf", "-o", "stone.png"],
        &["compile", "stone.sdf", "-o", "./stone.sdf"],
    ] {
        let (code, _, said) = run(&folder, args);
        assert_eq!(code, 2, "{args:?}: {said}");
        assert!(said.contains("would be written over"), "{args:?}: {said}");
    }
    for name in ["stone.png", "stone_0001.png", "sky.png"] {
        assert!(fs::read(folder.join(name)).unwrap() == before, "{name}");
    }
    assert_eq!(fs::read_to_string(folder.join("stone.sdf")).unwrap(), text);
}
