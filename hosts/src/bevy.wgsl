// %%TITLE%% for Bevy 0.19, written by `surefoot compile --for bevy`. It is a material's shader; the plugin is in the Rust file beside it.
#define_import_path surefoot::%%PATH%%
#import bevy_pbr::mesh_view_bindings::%%IMPORTS%%

%%PARAMETERS%%%%MODULE%%
struct sf_Corner {
  @builtin(position) position: vec4f,
  @location(0) at: vec2f,
}

// A triangle over the picture.
@vertex
fn vertex(@location(0) position: vec3f) -> sf_Corner {
  return sf_Corner(vec4f(position.xy, 0.0, 1.0), position.xy);
}

@fragment
fn fragment(corner: sf_Corner) -> sf_SceneFragment {
%%TAKEN%%  let place = view.world_from_view;
  let clip = view.clip_from_view;
  %%PLANES%%
  let size = vec2f(view.viewport.w * clip[1][1] / clip[0][0], view.viewport.w);
  sf_uniforms.view_eye = place[3].xyz;
  let ahead = -place[2].xyz;
  sf_uniforms.view_look_at = place[3].xyz + max(dot(sf_uniforms.view_look_at - place[3].xyz, ahead), 0.001) * ahead;
  sf_uniforms.view_up = place[1].xyz;
  sf_uniforms.view_size = size;
  sf_uniforms.view_corner = vec2f(-0.5, 0.5) * size * aside;
  return %%PICTURE%%(vec2f(0.5 + 0.5 * corner.at.x, 0.5 - 0.5 * corner.at.y) * size);
}
