//! Three numbers as a vector. The crate has no other need for linear algebra.

/// Three components.
pub type Vec3 = [f64; 3];

/// The sum, component by component.
pub fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The difference, component by component.
pub fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The product, component by component.
pub fn mul(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

/// A multiple.
pub fn scale(a: Vec3, by: f64) -> Vec3 {
    a.map(|c| c * by)
}

/// Its part along these axes.
pub fn only(a: Vec3, axes: [bool; 3]) -> Vec3 {
    mul(a, axes.map(|kept| f64::from(u8::from(kept))))
}

/// `origin + direction * t`
pub fn along(origin: Vec3, direction: Vec3, t: f64) -> Vec3 {
    add(origin, scale(direction, t))
}

/// The scalar product.
pub fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
pub fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The Euclidean norm.
pub fn length(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length one in the same direction, or none where it has no direction.
pub fn unit(a: Vec3) -> Option<Vec3> {
    // Divided first by the largest component, so that nothing overflows.
    let largest = a.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let a = a.map(|c| c / largest);
    Some(scale(a, 1.0 / length(a)))
}

/// From `a` at 0 to `b` at 1.
pub fn mix(a: Vec3, b: Vec3, t: f64) -> Vec3 {
    add(scale(a, 1.0 - t), scale(b, t))
}

/// From 0 below `low` to 1 above `high`, with no slope at either end.
pub fn smooth(low: f64, high: f64, x: f64) -> f64 {
    let s = ((x - low) / (high - low)).clamp(0.0, 1.0);
    s * s * (3.0 - 2.0 * s)
}
