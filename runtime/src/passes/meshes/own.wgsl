// Where on a mesh the fragment is.

var<private> mesh_place: MeshPlace;
// In the mesh's own space.
var<private> mesh_point: vec3f;
// On its images: to the right and down; how that changes from one pixel to the next, to the right and down; and how each of the two grows along
// the axes of the scene.
var<private> mesh_coordinates: vec2f;
var<private> mesh_steps: vec4f;
var<private> mesh_across: vec3f;
var<private> mesh_down: vec3f;
// How often the image that is looked at is repeated for each unit of them.
var<private> mesh_widths: f32;
