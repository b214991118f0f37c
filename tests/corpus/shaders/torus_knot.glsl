float map(vec3 p) {
    float r = length(p.xz);
    float a = atan(p.z, p.x);
    vec2 q = vec2(r - 0.9, p.y);
    float t = 1.5 * a;
    q = mat2(cos(t), sin(t), -sin(t), cos(t)) * q;
    q.x = abs(q.x) - 0.25;
    return 0.5 * (length(q) - 0.12);
}
