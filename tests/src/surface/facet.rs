//! One facet: a slope, an eye and a light.

/// A unit vector of the tangent frame.
pub type Direction = [f64; 3];

/// The direction of an angle from the normal and an azimuth, in degrees.
pub fn direction(theta: f64, azimuth: f64) -> Direction {
    let ((sin, cos), (y, x)) = (theta.to_radians().sin_cos(), azimuth.to_radians().sin_cos());
    [sin * x, sin * y, cos]
}

/// The scalar product.
pub fn dot(a: Direction, b: Direction) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The unit normal of a slope.
fn normal([u, v]: [f64; 2]) -> Direction {
    let length = (1.0 + u * u + v * v).sqrt();
    [-u / length, -v / length, 1.0 / length]
}

/// (n·i)⁺: a white matt facet, of which π f is 1.
pub fn lambert(slope: [f64; 2], light: Direction) -> f64 {
    dot(normal(slope), light).max(0.0)
}

/// π D G₂/(4 n·o): a facet of GGX without Fresnel's law, with the height-correlated G₂.
pub fn ggx(slope: [f64; 2], alpha: f64, view: Direction, light: Direction) -> f64 {
    let n = normal(slope);
    let (no, ni) = (dot(n, view), dot(n, light));
    if no <= 0.0 || ni <= 0.0 {
        return 0.0;
    }
    let sum = [0, 1, 2].map(|k| view[k] + light[k]);
    let nh = dot(n, sum) / dot(sum, sum).sqrt();
    let square = alpha * alpha;
    let d = square / (nh * nh * (square - 1.0) + 1.0).powi(2);
    let lambda = |c: f64| {
        let c = c.max(1e-4);
        0.5 * ((1.0 + square * (1.0 / (c * c) - 1.0)).sqrt() - 1.0)
    };
    d / (1.0 + lambda(no) + lambda(ni)) / (4.0 * no.max(1e-4))
}
