float wave(vec2 p, float a) {
    vec2 d = vec2(cos(a), sin(a));
    return exp(sin(dot(d, p) * 2.0 + iTime) - 1.0);
}

float height(vec2 p) {
    float sum = 0.0, weight = 1.0, all = 0.0, a = 0.0;
    for (float i = 0.0; i < 5.0; i += 1.0) {
        sum += weight * wave(p, a);
        all += weight;
        weight *= 0.75;
        p *= 1.3;
        a += 1.9;
    }
    return sum / all;
}

float map(vec3 p) {
    return 0.5 * (p.y - 0.4 * height(p.xz));
}
