// How high a triangle may hold the tool, and how high it does at least.
//
// It is bounded, not solved: by planes above the tool, which hold it no higher than over the
// triangle's highest corner, once over its middle and once over the likely contact; from below by
// points of the triangle. Twin of the planes: src/cam/digitize/bound.rs.

struct Triangle {
    a: vec4<real>,
    b: vec4<real>,
    c: vec4<real>,
}

alias Primitive = Triangle;

@group(0) @binding(2) var<storage, read> primitives: array<Primitive>;

// A first bound, soon told.
fn upper_of(step: Step, triangle: Primitive) -> real {
    let a = seen(step, triangle.a.xyz);
    let b = seen(step, triangle.b.xyz);
    let c = seen(step, triangle.c.xyz);
    let middle = (a + b + c) * (real(1) / real(3));
    let upper = highest_corner(step, tangent(middle.x, middle.z), a, b, c);
    return select(upper, NONE, is_beside(step, a, b, c));
}

// A first one from below: of a corner.
fn lower_of(step: Step, triangle: Primitive) -> real {
    return at_least(step, seen(step, triangle.a.xyz));
}

// Does the tool pass it by?
fn is_beside(step: Step, a: vec3<real>, b: vec3<real>, c: vec3<real>) -> bool {
    let lowest = min(a, min(b, c));
    let highest = max(a, max(b, c));
    let x = tool.reach_x + step.across;
    let z = tool.reach_z + step.across;
    return x < lowest.x || highest.x < -x || z < lowest.z || highest.z < -z;
}

fn bounds_of(step: Step, triangle: Primitive) -> Bounds {
    let a = seen(step, triangle.a.xyz);
    let b = seen(step, triangle.b.xyz);
    let c = seen(step, triangle.c.xyz);
    if (is_beside(step, a, b, c)) {
        return PASSED_BY;
    }
    let middle = (a + b + c) * (real(1) / real(3));
    let plane = tangent(middle.x, middle.z);
    var upper = highest_corner(step, plane, a, b, c);
    if (upper < best) {
        return PASSED_BY;
    }
    let contact = likely_contact(plane, a, b, c);
    upper = min(upper, highest_corner(step, tangent(contact.x, contact.z), a, b, c));
    if (upper < best) {
        return PASSED_BY;
    }
    let corners = max(at_least(step, a), max(at_least(step, b), at_least(step, c)));
    let lower = max(corners, max(at_least(step, middle), at_least(step, contact)));
    return Bounds(lower, upper);
}

// The highest that the corners lie under the plane, rounded up.
fn highest_corner(
    step: Step,
    plane: Tangent,
    a: vec3<real>,
    b: vec3<real>,
    c: vec3<real>,
) -> real {
    let slope = vec3<real>(plane.slope_x, real(1), plane.slope_z);
    let risen = max(dot(slope, a), max(dot(slope, b), dot(slope, c)));
    let at_origin = plane.value - plane.slope_x * plane.x0 - plane.slope_z * plane.z0;
    let steepness = abs(plane.slope_x) + abs(plane.slope_z);
    return risen + at_origin + (steepness + real(1)) * step.plane;
}

// Where on the sides the plane, bent down by what the tool bends at least, is highest. A guess:
// wherever it is, the plane that touches there is a bound.
fn likely_contact(plane: Tangent, a: vec3<real>, b: vec3<real>, c: vec3<real>) -> vec3<real> {
    var likely = highest_of_side(plane, a, b);
    let second = highest_of_side(plane, b, c);
    likely = select(likely, second, likely.w < second.w);
    let third = highest_of_side(plane, c, a);
    likely = select(likely, third, likely.w < third.w);
    return likely.xyz;
}

// A point of the side from p to q, and how high the bent plane holds the tool there.
fn highest_of_side(plane: Tangent, p: vec3<real>, q: vec3<real>) -> vec4<real> {
    let side = q - p;
    let bent = bent_plane(plane, p.x, p.z);
    let climb = climb_along(bent, side);
    let bend = bend_of(side, side);
    let far = clamp(climb / max(bend, TINY), real(0), real(1));
    return vec4<real>(p + side * far, p.y + bent.risen + (climb - real(0.5) * bend * far) * far);
}
