vec3 hash3(vec3 p) {
    p = vec3(dot(p, vec3(127.1, 311.7, 74.7)), dot(p, vec3(269.5, 183.3, 246.1)), dot(p, vec3(113.5, 271.9, 124.6)));
    return fract(sin(p) * 43.5453);
}

float cells(vec3 x) {
    vec3 n = floor(x);
    vec3 f = x - n;
    float best = 8.0;
    for (int k = -1; k <= 1; k++)
    for (int j = -1; j <= 1; j++)
    for (int i = -1; i <= 1; i++) {
        vec3 g = vec3(float(i), float(j), float(k));
        vec3 r = g + hash3(mod(n + g, 4.0)) - f;
        best = min(best, dot(r, r));
    }
    return sqrt(best);
}

float map(vec3 p) {
    return max(length(p) - 1.0, 0.4 - cells(2.0 * p)) * 0.45;
}
