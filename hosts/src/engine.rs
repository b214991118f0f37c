//! Modules for engines that take WGSL as it is: an object that their page adds to a scene.

use super::fields::{scene_script, wgsl};
use super::fill::{fill, on_one_line, quoted};
use serde_json::Value;
use surefoot_compiler::compiled::Compiled;

const BABYLON: &str = include_str!("babylon.js");
const PLAYCANVAS: &str = include_str!("playcanvas.js");
const LOOK: &str = include_str!("look.js");

/// An engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Engine {
    /// Babylon.js.
    Babylon,
    /// PlayCanvas.
    PlayCanvas,
}

/// The module.
pub fn write(compiled: &Compiled, parameters: &[Value], title: &str, engine: Engine) -> Result<String, String> {
    let scene = scene_script(compiled, parameters, title, &[])?;
    let title = on_one_line(title);
    let (template, of, uses, hand) = match engine {
        Engine::Babylon => (
            BABYLON,
            "Babylon.js with WebGPUEngine, written by `surefoot compile --for babylon`",
            "new Field(scene);",
            "// Where the host's coordinates are left-handed, z of the scene points the other way, as with glTF.\n",
        ),
        Engine::PlayCanvas => {
            (PLAYCANVAS, "PlayCanvas with WebGPU, written by `surefoot compile --for playcanvas`", "app.root.addChild(new Field(app));", "")
        }
    };
    let head = format!(
        "// {title} for {of}:\n//\n//     import {{ Field }} from './{title}.js';\n//     {uses}\n//\n\
         // It is drawn with the host's camera, hides what stands behind it, and is hidden. `field.see(camera)` puts a camera where the\n\
         // scene's own camera is. `field.parameters` has the scene's parameters by their names.\n{hand}"
    );
    Ok(fill(template, &[("HEAD", &head), ("SCENE", &scene), ("MODULE", &quoted(&wgsl(compiled))), ("LOOK", LOOK)]))
}
