// No part of the field moves as a whole.
fn carried(p: vec3f) -> vec3f {
    return vec3f(0.0);
}
