// Pillars in cells, of another height in each: the neighbour's may be nearer.
float hash(vec2 p) {
    return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453);
}

float map(vec3 p) {
    vec2 cell = floor(p.xz);
    vec2 q = fract(p.xz) - 0.5;
    float height = 0.2 + 0.9 * hash(mod(cell, 8.0));
    vec2 d = vec2(length(q) - 0.3, abs(p.y) - height);
    return min(max(d.x, d.y), 0.0) + length(max(d, 0.0));
}
