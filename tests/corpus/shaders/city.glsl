uniform float iTime2;

float hash21(vec2 p) {
    p = fract(p * vec2(123.34, 456.21));
    p += dot(p, p + 45.32);
    return fract(p.x * p.y);
}

float block(vec3 p, vec2 id) {
    float h = floor(1.0 + 4.0 * hash21(mod(id, 16.0))) * 0.2;
    vec3 d = abs(p) - vec3(0.35, h, 0.35);
    return length(max(d, 0.0)) + min(max(d.x, max(d.y, d.z)), 0.0);
}

float map(vec3 p) {
    float d = p.y;
    vec2 id = floor(p.xz);
    for (int x = -1; x <= 1; x++) {
        for (int z = -1; z <= 1; z++) {
            vec2 o = vec2(x, z);
            vec3 q = p;
            q.xz = fract(p.xz) - 0.5 - o;
            d = min(d, block(q, id + o));
        }
    }
    return d;
}
