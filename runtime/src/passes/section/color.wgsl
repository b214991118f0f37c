// What the field is made of where it is cut.
fn scene_cut_color(p: vec3f) -> vec3f {
    return sf_surface(p, scene_section_normal()).color;
}
