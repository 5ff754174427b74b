// The tool by the pieces of its height function; those it lacks are never asked for.
//
// Twins: src/tool/wheel.rs and src/tool/mill.rs. Roots of differences of squares are taken of their
// factors, so that little is lost at the rim.

struct Tool {
    // Half the shadow's width along x and z, and the greatest height.
    reach_x: real,
    reach_z: real,
    top: real,
    // The height function stays concave with this paraboloid taken away.
    bend_x: real,
    bend_z: real,
    // Of a wheel.
    major: real,
    minor: real,
    // Of a mill: where its shadow ends.
    radius: real,
    corner_center: real,
    corner_radius: real,
    corner_rise: real,
    // A mill without a flank has it farther out than any point.
    flank_from: real,
    flank_at: real,
    flank_slope: real,
    flank_to: real,
    rim_center: real,
    rim_radius: real,
    rim_rise: real,
}

@group(0) @binding(1) var<storage, read> tool: Tool;

// Tangent planes touch arcs no farther out than this share of their radius: the slope stays finite.
const SHARE = real(0.9);

// A plane above the height function everywhere, touching it at (x0, z0).
struct Tangent {
    x0: real,
    z0: real,
    value: real,
    slope_x: real,
    slope_z: real,
}

// sqrt(radius^2 - out^2), or 0 beyond.
fn leg(radius: real, out: real) -> real {
    return sqrt(max((radius - out) * (radius + out), real(0)));
}

// Keeps a quotient from being nothing by nothing.
const TINY = real(1.0e-30);

// A tangent plane bent down by what the tool bends at least, at some place: its slopes there, and how
// much it has risen from where it touches.
struct Bent {
    slope_x: real,
    slope_z: real,
    risen: real,
}

fn bent_plane(plane: Tangent, x: real, z: real) -> Bent {
    let out_x = x - plane.x0;
    let out_z = z - plane.z0;
    let slope_x = plane.slope_x - tool.bend_x * out_x;
    let slope_z = plane.slope_z - tool.bend_z * out_z;
    let risen = (plane.slope_x + slope_x) * out_x + (plane.slope_z + slope_z) * out_z;
    return Bent(slope_x, slope_z, real(0.5) * risen);
}

// How much the part and the bent plane rise together along `side`.
fn climb_along(bent: Bent, side: vec3<real>) -> real {
    return side.y + bent.slope_x * side.x + bent.slope_z * side.z;
}

// The paraboloid's quadratic form.
fn bend_of(p: vec3<real>, q: vec3<real>) -> real {
    return tool.bend_x * p.x * q.x + tool.bend_z * p.z * q.z;
}
