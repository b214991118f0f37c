//! The text of the pass over the screen is valid WGSL after a module that has the functions it calls.

const STUB: &str = include_str!("scene_pass/stub.wgsl");
const BASE: &str = concat!(include_str!("../src/shading/base.wgsl"), include_str!("../../runtime/src/passes/scene/bindings.wgsl"), include_str!("../src/shading/triangle.wgsl"), include_str!("../src/shading/pinhole.wgsl"));
const LENS: &str = concat!(include_str!("../src/shading/base.wgsl"), include_str!("../../runtime/src/passes/scene/bindings.wgsl"), include_str!("../src/shading/triangle.wgsl"), include_str!("../src/shading/camera.wgsl"));
const SKY: [&str; 2] = [
    include_str!("../src/shading/sky_gradient.wgsl"),
    include_str!("../../runtime/src/passes/scene/sky_images.wgsl"),
];
const REFLECTIONS: [&str; 2] = [
    include_str!("../src/shading/reflections.wgsl"),
    include_str!("../src/shading/no_reflections.wgsl"),
];
const FILM: [&str; 2] = [
    concat!(
        include_str!("../src/shading/tone_aces.wgsl"),
        include_str!("../src/shading/film.wgsl"),
        include_str!("../src/shading/dither.wgsl"),
        include_str!("../src/shading/target.wgsl")
    ),
    include_str!("../../runtime/src/passes/capture/film.wgsl"),
];
const TARGET: &str =
    concat!(include_str!("../src/shading/dither.wgsl"), include_str!("../src/shading/target.wgsl"));
const MIRROR: [&str; 2] =
    [include_str!("../src/shading/mirror.wgsl"), include_str!("../../runtime/src/passes/capture/read.wgsl")];
const LIGHT: &str = include_str!("../src/shading/light.wgsl");
const TONES: [&str; 3] = [
    include_str!("../src/shading/tone_agx.wgsl"),
    include_str!("../src/shading/tone_neutral.wgsl"),
    include_str!("../src/shading/tone_none.wgsl"),
];
const DEVELOP: &str = include_str!("../src/shading/film.wgsl");
const FOG: [&str; 2] =
    [include_str!("../src/shading/fog.wgsl"), include_str!("../src/shading/no_fog.wgsl")];
const SHADOW: [&str; 2] = [
    concat!(
        include_str!("../src/shading/emitter.wgsl"),
        include_str!("../src/shading/seen.wgsl"),
        include_str!("../src/shading/shadow.wgsl")
    ),
    include_str!("../src/shading/no_shadow.wgsl"),
];
const OCCLUSION: [&str; 2] = [
    include_str!("../src/shading/occlusion.wgsl"),
    include_str!("../src/shading/no_occlusion.wgsl"),
];
const MET: &str =
    concat!(include_str!("../src/shading/met.wgsl"), include_str!("../src/shading/met_plain.wgsl"));
const SHADED: &str = include_str!("../src/shading/view_shaded.wgsl");
const OTHERS: [&str; 3] = [
    include_str!("../../runtime/src/passes/scene/view_normals.wgsl"),
    concat!(include_str!("../../runtime/src/passes/scene/ramp.wgsl"), include_str!("../../runtime/src/passes/scene/view_steps.wgsl")),
    include_str!("../../runtime/src/passes/scene/view_depth.wgsl"),
];
const OUTPUT: [&str; 2] = [
    concat!(include_str!("../../runtime/src/passes/scene/begin.wgsl"), include_str!("../../runtime/src/passes/scene/color.wgsl")),
    concat!(include_str!("../../runtime/src/passes/scene/begin.wgsl"), include_str!("../../runtime/src/passes/scene/color_and_depth.wgsl")),
];

fn validate(sections: &[&str]) {
    let text = sections.join("\n");
    let module = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::empty(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(&text)));
}

#[test]
fn every_combination_of_sections_is_valid() {
    for output in OUTPUT {
        for view in OTHERS {
            validate(&[STUB, BASE, TARGET, view, output]);
        }
        validate(&[STUB, LENS, TARGET, OTHERS[0], output]);
        for tone in TONES {
            validate(&[STUB, BASE, tone, DEVELOP, TARGET, OTHERS[0], output]);
        }
        for shadow in SHADOW {
            for occlusion in OCCLUSION {
                for (sky, reflections) in SKY.iter().flat_map(|sky| REFLECTIONS.map(|r| (sky, r))) {
                    for (film, mirror) in FILM.iter().flat_map(|film| MIRROR.map(|m| (film, m))) {
                        for fog in FOG {
                            validate(&[STUB, BASE, film, sky, mirror, LIGHT, fog, reflections, shadow, occlusion, MET, SHADED, output]);
                        }
                    }
                }
            }
        }
    }
}
