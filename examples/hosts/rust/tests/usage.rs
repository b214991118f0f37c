//! What the host says where it cannot draw. What it draws is compared with our pictures by `tests/run host_rust`.

use std::process::Command;

fn run(arguments: &[&str]) -> (bool, String) {
    let done = Command::new(env!("CARGO_BIN_EXE_surefoot-host")).args(arguments).output().unwrap();
    (done.status.success(), String::from_utf8_lossy(&done.stderr).into_owned())
}

#[test]
fn a_host_says_how_it_is_called_and_what_is_missing() {
    let (fine, said) = run(&["a.sdf"]);
    assert!(!fine && said.contains("usage: surefoot-host SCENE.sdf PICTURE.png"), "{said}");
    let (fine, said) = run(&["no_such.sdf", "a.png"]);
    assert!(!fine && said.contains("no_such.sdf"), "{said}");
}
