uniform float u_time;

float smin(float a, float b, float k) {
    float h = clamp(0.5 + 0.5 * (b - a) / k, 0.0, 1.0);
    return mix(b, a, h) - k * h * (1.0 - h);
}

float map(vec3 p) {
    float d = length(p) - 0.5;
    for (int i = 0; i < 5; i++) {
        float fi = float(i);
        vec3 c = 0.7 * vec3(sin(1.3 * fi + u_time), cos(2.1 * fi), sin(0.7 * fi));
        d = smin(d, length(p - c) - 0.25, 0.3);
    }
    return d;
}
