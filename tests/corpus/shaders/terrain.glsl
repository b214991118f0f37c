// Value noise in octaves over a plane.
float hash(vec2 p) {
    p = 50.0 * fract(p * 0.3183099 + vec2(0.71, 0.113));
    return -1.0 + 2.0 * fract(p.x * p.y * (p.x + p.y));
}

float noise(in vec2 p) {
    vec2 i = floor(p);
    vec2 f = fract(p);
    vec2 u = f * f * (3.0 - 2.0 * f);
    return mix(mix(hash(i + vec2(0.0, 0.0)), hash(i + vec2(1.0, 0.0)), u.x),
               mix(hash(i + vec2(0.0, 1.0)), hash(i + vec2(1.0, 1.0)), u.x), u.y);
}

const mat2 turned = mat2(1.6, 1.2, -1.2, 1.6);

float fbm(vec2 p, int octaves) {
    float f = 0.0, a = 0.5;
    for (int i = 0; i < octaves; ++i) {
        f += a * noise(p);
        p = turned * p;
        a *= 0.5;
    }
    return f;
}

float map(in vec3 p) {
    float h = 0.4 * fbm(1.3 * p.xz, 4);
    return 0.6 * (p.y - h);
}

vec3 march(vec3 ro, vec3 rd) {
    vec3 p = ro;
    for (int i = 0; i < 200; ++i) {
        float h = map(p);
        if (abs(h) < 0.001) return p;
        p += rd * h * 0.2;
    }
    return vec3(1e3);
}
