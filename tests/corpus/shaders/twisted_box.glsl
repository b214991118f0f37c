// A box that is twisted too fast for the factor at its end.
float sdBox(vec3 p, vec3 b) {
    vec3 q = abs(p) - b;
    return length(max(q, 0.0)) + min(max(q.x, max(q.y, q.z)), 0.0);
}

mat2 rot(float a) {
    float c = cos(a), s = sin(a);
    return mat2(c, -s, s, c);
}

float map(vec3 p) {
    p.xz *= rot(3.0 * p.y);
    return 0.7 * sdBox(p, vec3(0.6, 1.2, 0.3));
}
