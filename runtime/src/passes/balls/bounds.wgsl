// The box that holds all balls, along the axes of the light. Stands after cast.wgsl and the ball's struct.

@group(3) @binding(1) var<storage, read_write> ball_bounds: array<atomic<u32>, 6>;
@group(2) @binding(0) var<storage, read> balls: array<Ball>;

@compute @workgroup_size(64)
fn bounds(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= ball_light.balls || (balls[id.x].word & GONE) != 0u {
        return;
    }
    let ball = balls[id.x];
    let at = ball_axes(ball.p);
    for (var i = 0u; i < 3u; i++) {
        atomicMin(&ball_bounds[i], ball_order(at[i] - ball.r));
        atomicMax(&ball_bounds[3u + i], ball_order(at[i] + ball.r));
    }
}
