// A shell about a gyroid, with a step that is longer than it should be.
float gyroid(vec3 p, float scale) {
    p *= scale;
    return dot(sin(p), cos(p.zxy)) / scale;
}

float map(vec3 p) {
    float d = abs(gyroid(p, 6.0)) - 0.03;
    return max(d, length(p) - 1.0);
}

float trace(vec3 ro, vec3 rd) {
    float t = 0.0;
    for (int i = 0; i < 128; i++) {
        float d = map(ro + t * rd);
        if (d < 0.001 * t || t > 20.0) break;
        t += 0.8 * d;
    }
    return t;
}

void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 uv = (2.0 * fragCoord - iResolution.xy) / iResolution.y;
    float t = trace(vec3(0.0, 0.0, 3.0), normalize(vec3(uv, -1.5)));
    fragColor = texture(iChannel0, vec2(0.1 * t, 0.5));
}
