#define FOLDS 4

void fold(inout vec3 p, float r) {
    p.xy = abs(p.xy) - r;
    if (p.x < p.y) p.xy = p.yx;
}

float map(vec3 p) {
    float scale = 1.0;
    for (int i = 0; i < FOLDS; i++) {
        fold(p, 0.5);
        p.z = abs(p.z) - 0.25;
        p *= 1.5;
        scale *= 1.5;
    }
    return (length(p) - 0.8) / scale;
}
