const int COUNT = 4;
const vec4 balls[COUNT] = vec4[COUNT](
    vec4(0.0, 0.0, 0.0, 0.5), vec4(0.8, 0.1, 0.0, 0.3),
    vec4(-0.5, 0.5, 0.3, 0.4), vec4(0.1, -0.7, 0.4, 0.35));

float map(vec3 p) {
    float d = 1e5;
    for (int i = 0; i < COUNT; i++) {
        d = min(d, length(p - balls[i].xyz) - balls[i].w);
    }
    return d;
}
