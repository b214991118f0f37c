// As it was written for shadertoy.com, with its own loop and the 0.9 that seemed to do.

mat2 rot(float a) {
    float c = cos(a), s = sin(a);
    return mat2(c, -s, s, c);
}

float crystal(vec3 p) {
    for (int i = 0; i < 4; i++) {
        p = abs(p) - vec3(0.12, 0.3, 0.1);
        p.xz *= rot(0.7);
        p.xy *= rot(0.35);
    }
    vec3 q = abs(p) - 0.14;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0) - 0.02;
}

float urchin(vec3 p) {
    return length(p) - 0.55 + 0.1 * sin(14.0 * p.x) * sin(14.0 * p.y) * sin(14.0 * p.z);
}

vec2 opU(vec2 a, vec2 b) {
    return a.x < b.x ? a : b;
}

vec2 map(vec3 p) {
    vec2 res = vec2(p.y + 0.6 + 0.04 * sin(4.0 * p.x + iTime) * sin(4.0 * p.z), 1.0);
    for (int i = 0; i < 3; i++) {
        vec3 q = p - vec3(-1.5 + 0.9 * float(i), 0.3, -0.6 * float(i));
        res = opU(res, vec2(crystal(q), 2.0 + float(i)));
    }
    return opU(res, vec2(urchin(p - vec3(1.1, 0.1, 0.5)), 5.0));
}

float trace(vec3 ro, vec3 rd) {
    float t = 0.0;
    for (int i = 0; i < 160; i++) {
        float d = map(ro + t * rd).x;
        if (d < 0.001 * t || t > 30.0) break;
        t += 0.9 * d;
    }
    return t;
}

void mainImage(out vec4 color, in vec2 at) {
    vec2 uv = (2.0 * at - iResolution.xy) / iResolution.y;
    float t = trace(vec3(0.0, 1.2, 4.5), normalize(vec3(uv, -2.0)));
    color = texture(iChannel0, vec2(0.05 * t, 0.5));
}
