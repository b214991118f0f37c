#define PI 3.14159265
#define TAU (2.0 * PI)

float sdSegment(vec3 p, vec3 a, vec3 b, float r) {
    vec3 pa = p - a, ba = b - a;
    float h = clamp(dot(pa, ba) / dot(ba, ba), 0.0, 1.0);
    return length(pa - ba * h) - r;
}

float pModPolar(inout vec2 p, float repetitions) {
    float angle = TAU / repetitions;
    float a = atan(p.y, p.x) + angle / 2.0;
    float r = length(p);
    float c = floor(a / angle);
    a = mod(a, angle) - angle / 2.0;
    p = vec2(cos(a), sin(a)) * r;
    if (abs(c) >= (repetitions / 2.0)) c = abs(c);
    return c;
}

float map(vec3 p) {
    vec2 q = p.xz;
    pModPolar(q, 7.0);
    vec3 r = vec3(q.x, p.y, q.y);
    return min(sdSegment(r, vec3(0.2, 0.0, 0.0), vec3(1.0, 0.4, 0.0), 0.08), length(p) - 0.35);
}
