// Widens the box of each light that is infinitely far until it holds all balls. Stands after base.wgsl and the ball's struct.

@group(3) @binding(1) var<storage, read_write> shadow_boxes: array<atomic<u32>, 96>;
@group(2) @binding(0) var<storage, read> balls: array<Ball>;

@compute @workgroup_size(64)
fn bounds(@builtin(global_invocation_id) id: vec3u) {
    let light = shadow_lights[id.y];
    if id.x >= light.balls || light.first < 0 || light.position == 1u || (balls[id.x].word & GONE) != 0u {
        return;
    }
    let ball = balls[id.x];
    let at = shadow_axes(ball.p - light.scene_center, light.across, light.above, light.along);
    for (var i = 0u; i < 3u; i++) {
        atomicMin(&shadow_boxes[6u * id.y + i], shadow_order(at[i] - ball.r));
        atomicMax(&shadow_boxes[6u * id.y + 3u + i], shadow_order(at[i] + ball.r));
    }
}
