vec4 orb;

float map(vec3 p) {
    float scale = 1.0;
    orb = vec4(1000.0);
    for (int i = 0; i < 5; i++) {
        p = -1.0 + 2.0 * fract(0.5 * p + 0.5);
        float r2 = dot(p, p);
        orb = min(orb, vec4(abs(p), r2));
        float k = 1.2 / max(r2, 0.05);
        p *= k;
        scale *= k;
    }
    return 0.25 * abs(p.y) / scale - 0.002;
}
