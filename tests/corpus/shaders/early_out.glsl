float map(vec3 p) {
    float bound = length(p) - 2.0;
    if (bound > 0.5) return bound;
    if (p.y < -1.0) {
        float d = p.y + 1.2;
        if (d < 0.0) return d;
        return min(d, bound + 3.0);
    }
    float best = 10.0;
    for (int i = 0; i < 8; i++) {
        float a = 0.785398 * float(i);
        float d = length(p - vec3(1.2 * cos(a), 0.0, 1.2 * sin(a))) - 0.3;
        if (d < 0.0) return d;
        if (i == 6) continue;
        best = min(best, d);
    }
    return best;
}
