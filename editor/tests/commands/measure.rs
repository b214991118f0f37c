//! `surefoot measure`: what it says to a person and to a machine, beside the mesh that is written, and what it refuses.

use super::{folder, run};
use serde_json::Value;
use std::fs;

fn json(folder: &std::path::Path, args: &[&str]) -> Value {
    let (code, out, err) = run(folder, args);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    serde_json::from_str(&out).unwrap()
}

fn number(of: &Value) -> f64 {
    of.as_f64().unwrap_or_else(|| panic!("{of} is no number"))
}

#[test]
fn a_solid_is_measured() {
    let folder = folder("measure");
    fs::write(folder.join("box.sdf"), "param wide = 2 in 1..9\nscene = box(wide, 1, 1).translate(time, 0, 0) - cylinder(0.25, 2).translate(time, 0, 0)\n").unwrap();
    let common = ["measure", "box.sdf", "--tolerance", "1e-3", "--set", "wide=3", "--time", "2", "--line", "-1,0,0 5,0,0"];
    let (code, out, err) = run(&folder, &common);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    for words in ["box.sdf\n", "size            3 × 1 × 1\n", "proven", "estimated", "pieces          1,", "Euler number 0", "6 long, 2.5 of it solid", "centre of mass  ("] {
        assert!(out.contains(words), "{words}: {out}");
    }
    let found = json(&folder, &[&common[..], &["--json"]].concat());
    let volume = 3.0 - std::f64::consts::PI / 16.0;
    assert!((number(&found["volume"]["value"]) - volume).abs() < number(&found["volume"]["error"]).min(0.02), "{found}");
    assert!(number(&found["volume"]["between"][0]) < volume && volume < number(&found["volume"]["between"][1]), "{found}");
    assert!((number(&found["box"]["min"][0]["value"]) - 0.5).abs() < 1e-6, "{found}");
    assert!((number(&found["centre_of_mass"][0]["value"]) - 2.0).abs() < 1e-4, "{found}");
    let ways: Vec<(bool, f64)> = found["line"]["ways"].as_array().unwrap().iter().map(|way| (way["solid"].as_bool().unwrap(), number(&way["to"]))).collect();
    let wanted = [(false, 1.5), (true, 2.75), (false, 3.25), (true, 4.5), (false, 6.0)];
    assert!(ways.len() == 5 && ways.iter().zip(wanted).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-6), "{ways:?}");
    // The mesh that is written is as large, as its own error allows.
    let (code, out, _) = run(&folder, &["mesh", "box.sdf", "-o", "box.obj", "--set", "wide=3", "--time", "2", "--within", "(0,-1,-1)..(4,1,1)"]);
    assert_eq!(code, 0);
    let said = |name: &str| out.split(name).nth(1).unwrap().split([',', ' ']).next().unwrap().parse::<f64>().unwrap();
    for name in ["volume", "area"] {
        assert!((said(&format!("{name} ")) - number(&found[name]["value"])).abs() < 0.01 * number(&found[name]["value"]), "{name}: {out} {found}");
    }
}

#[test]
fn lengths_have_the_unit_of_the_scene() {
    let folder = folder("measure_unit");
    fs::write(folder.join("box.sdf"), "render { unit: mm }\nscene = box((2cm, 10, 0.5in))\n").unwrap();
    let common = ["measure", "box.sdf", "--tolerance", "1e-2", "--line", "-20,0,0 20,0,0"];
    let (code, out, err) = run(&folder, &common);
    assert_eq!((code, err.as_str()), (0, ""), "{out}");
    for words in ["20 × 10 × 12.7 mm\n", " mm³, ", " mm², ", "40 mm long, 20 mm of it solid"] {
        assert!(out.contains(words), "{words}: {out}");
    }
    assert_eq!(json(&folder, &[&common[..], &["--json"]].concat())["unit"], "mm");
}

#[test]
fn what_can_not_be_measured_is_refused() {
    let folder = folder("measure_refused");
    fs::write(folder.join("empty.sdf"), "scene = sphere(1) & sphere(1).translate(5, 0, 0)\n").unwrap();
    fs::write(folder.join("ground.sdf"), "scene = sphere(1) | plane(y, -3)\n").unwrap();
    for (args, exit, told) in [
        (&["measure", "empty.sdf"][..], 1, "nothing is solid"),
        (&["measure", "ground.sdf"], 1, "--within=\"(-1,-1,-1)..(1,1,1)\""),
        (&["measure", "bad.sdf"], 1, "unknown-name"),
        (&["measure", "good.sdf", "--within", "(8,8,8)..(9,9,9)"], 1, "no surface"),
        (&["measure", "good.sdf", "--tolerance", "0"], 2, "above zero"),
        (&["measure", "good.sdf", "--line", "1,2,3"], 2, "two points"),
        (&["measure", "nowhere.sdf"], 2, "can't read"),
    ] {
        let (code, _, err) = run(&folder, args);
        assert_eq!(code, exit, "{args:?}: {err}");
        assert!(err.contains(told), "{args:?}: {err}");
    }
}
