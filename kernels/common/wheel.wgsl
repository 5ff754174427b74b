// The wheel of a last lathe, a torus about x filled inside. Morell (2014), eq. 4.7.
//
// Twin: src/tool/wheel.rs.

// For x and z not below 0.
fn height(x: real, z: real) -> real {
    let radius = tool.major + leg(tool.minor, x);
    let is_under = x <= tool.minor && z <= radius;
    return select(NONE, leg(radius, z), is_under);
}

fn tangent(x: real, z: real) -> Tangent {
    let x_limit = tool.minor * SHARE;
    let x0 = clamp(x, -x_limit, x_limit);
    let nose = leg(tool.minor, x0);
    let radius = tool.major + nose;
    let z_limit = radius * SHARE;
    let z0 = clamp(z, -z_limit, z_limit);
    let value = leg(radius, z0);
    return Tangent(x0, z0, value, -radius * x0 / (nose * value), -z0 / value);
}
