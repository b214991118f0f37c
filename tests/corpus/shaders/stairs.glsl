float map(vec3 p) {
    float a = atan(p.z, p.x) / 6.2831853;
    float n = 12.0;
    float k = floor(a * n);
    float level = (k + 0.5) / n;
    float y = p.y - level;
    y -= floor(y + 0.5);
    float r = length(p.xz);
    vec2 d = abs(vec2(r - 0.8, y)) - vec2(0.4, 0.05);
    return 0.6 * (length(max(d, 0.0)) + min(max(d.x, d.y), 0.0));
}
