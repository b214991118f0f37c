// What the passes' shading reads, as a uniform block and constants of the pipeline.

@group(1) @binding(0) var<uniform> scene: SceneUniforms;

// What no value of a parameter changes is a constant, and no loop ends by a uniform alone: a driver may build the pipeline anew for each draw,
// with what the uniform is then (lavapipe does).

// How many of the lights there are.
override scene_lights: u32 = 1u;
// How often a mirrored ray is followed at most.
override scene_bounces: u32 = 0u;
// Whether the target wants linear light, which it may encode itself.
override scene_linear: bool = false;
// What the target's levels are apart, of a screen's white; 0 where they are much finer than a screen's.
override scene_step: f32 = 0.0;

// Where a flat triangle of a mesh is seen, and that place on the round shape that it stands for.
var<private> scene_flat: vec3f;
var<private> scene_round: vec3f;
