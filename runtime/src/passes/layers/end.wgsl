// The function ends: the normal leans against the rise.
    let aside = rise - dot(rise, n) * n;
    return SceneMet(surface, normalize(n - aside));
}
