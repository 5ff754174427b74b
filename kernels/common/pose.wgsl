// The part as it lies under the tool at one step.

// Rows of the attack frame from the part frame; the last number of each is the shift. Sines and
// cosines were taken on the host, in f64.
struct Step {
    x: vec4<real>,
    y: vec4<real>,
    z: vec4<real>,
    // More than rounding can be off across the attack axis, for a point and for the tool's shape.
    across: real,
    // The same along it.
    along: real,
    // What a plane over the tool is off by, for each unit of its steepness and one more.
    plane: real,
    pad: real,
}

@group(0) @binding(3) var<storage, read> steps: array<Step>;

fn seen(step: Step, point: vec3<real>) -> vec3<real> {
    return vec3<real>(
        dot(step.x.xyz, point) + step.x.w,
        dot(step.y.xyz, point) + step.y.w,
        dot(step.z.xyz, point) + step.z.w,
    );
}

// At least as high as a point there holds the tool: the point is drawn towards the axis by more than
// all rounding. The height function falls outwards, so that this holds where it is infinitely steep.
fn at_most(step: Step, at: vec3<real>) -> real {
    let x = max(abs(at.x) - step.across, real(0));
    let z = max(abs(at.z) - step.across, real(0));
    return at.y + height(x, z) + step.along;
}

// At most as high, or nowhere if it may pass by: the point is pushed outwards.
fn at_least(step: Step, at: vec3<real>) -> real {
    return at.y + height(abs(at.x) + step.across, abs(at.z) + step.across) - step.along;
}

// A direction of the part.
fn turned(step: Step, direction: vec3<real>) -> vec3<real> {
    return vec3<real>(
        dot(step.x.xyz, direction),
        dot(step.y.xyz, direction),
        dot(step.z.xyz, direction),
    );
}
