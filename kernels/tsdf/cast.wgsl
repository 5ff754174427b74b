// The model as a camera would see it: a thread follows the ray of a pixel.
//
// Twin: src/register/tsdf/cast.rs. Places are counted in voxels from a point of the lattice near the eye.

struct Cast {
    // The eye.
    eye: vec4<f32>,
    // Columns of the turn from the camera to the lattice, over the side of a voxel.
    right: vec4<f32>,
    down: vec4<f32>,
    ahead: vec4<f32>,
    // The point of the lattice that places are counted from.
    origin: vec4<i32>,
    focal: vec2<f32>,
    center: vec2<f32>,
    // Of the picture [px].
    size: vec2<u32>,
    // Tiles along a row.
    n_columns: u32,
    // Entries of the table, a power of two, less one.
    mask: u32,
    // Lengths [mm].
    voxel: f32,
    truncation: f32,
    pad_a: u32,
    pad_b: u32,
}

@group(0) @binding(0) var<storage, read> job: Cast;
// From where to where there are blocks on the rays of each tile; in z.
@group(0) @binding(1) var<storage, read> tiles: array<vec2<f32>>;
// Block, and where it is kept; that is -1 where the table has nothing.
@group(0) @binding(2) var<storage, read> table: array<vec4<i32>>;
@group(0) @binding(3) var<storage, read> points: array<Point>;
// Point and normal of each pixel, six numbers; z is 0 where it sees nothing, -1 where it did not come
// to an end.
@group(0) @binding(4) var<storage, read_write> seen: array<f32>;

const TILE = 16u;
// Through what is not known a ray goes in steps of this share of the truncation.
const BLIND = 0.5;
// Before the surface a ray goes this share of the distance to it.
const CAREFUL = 0.8;
// Some drivers end all loops of a thread after 65,535 turns in all, and say nothing: ours end before,
// and say so.
const MOST_TURNS = 60000u;
const NOWHERE = 0xffffffffu;

var<private> n_turns = 0u;
// The block looked at last, and where it is kept.
var<private> last_block = vec3<i32>(2147483647);
var<private> last_slot = NOWHERE;

// A distance, where it is known.
struct Distance {
    is_known: bool,
    value: f32,
}

const UNKNOWN = Distance(false, 0.0);

fn is_exhausted() -> bool {
    n_turns += 1u;
    return MOST_TURNS < n_turns;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (job.size.x * job.size.y <= id.x) {
        return;
    }
    let pixel = vec2<u32>(id.x % job.size.x, id.x / job.size.x);
    let ray = vec3<f32>((vec2<f32>(pixel) - job.center) / job.focal, 1.0);
    let way = job.right.xyz * ray.x + job.down.xyz * ray.y + job.ahead.xyz;
    let range = tiles[pixel.x / TILE + job.n_columns * (pixel.y / TILE)];
    var found = follow(ray, way, range);
    if (MOST_TURNS < n_turns) {
        found = Seen(vec3<f32>(0.0, 0.0, -1.0), vec3<f32>(0.0));
    }
    let at = 6u * id.x;
    for (var k = 0u; k < 3u; k += 1u) {
        seen[at + k] = found.point[k];
        seen[at + 3u + k] = found.normal[k];
    }
}

struct Seen {
    point: vec3<f32>,
    normal: vec3<f32>,
}

// Where the ray first comes from before the surface to behind it.
fn follow(ray: vec3<f32>, way: vec3<f32>, range: vec2<f32>) -> Seen {
    // One millimetre along the ray, in z.
    let unit = 1.0 / length(ray);
    var before = -1.0;
    var z = range.x;
    while (z < range.y) {
        if (is_exhausted()) {
            break;
        }
        let there = nearest(place(way, z));
        if (!there.is_known) {
            before = -1.0;
            z += BLIND * job.truncation * unit;
        } else if (0.0 < there.value) {
            before = z;
            z += max(CAREFUL * there.value * job.truncation, job.voxel) * unit;
        } else {
            if (0.0 <= before) {
                let crossing = crossing(way, before, z, 0.5 * job.voxel * unit);
                if (crossing.is_known) {
                    let normal = normal(place(way, crossing.value));
                    if (any(normal != vec3<f32>(0.0))) {
                        return Seen(ray * crossing.value, normal);
                    }
                }
            }
            before = -1.0;
            z += job.voxel * unit;
        }
    }
    return Seen(vec3<f32>(0.0), vec3<f32>(0.0));
}

fn place(way: vec3<f32>, z: f32) -> vec3<f32> {
    return job.eye.xyz + way * z;
}

// The direction in which the distance grows, in the camera's frame; 0 where it is not known.
fn normal(at: vec3<f32>) -> vec3<f32> {
    var gradient = vec3<f32>(0.0);
    for (var k = 0u; k < 3u; k += 1u) {
        var step = vec3<f32>(0.0);
        step[k] = 1.0;
        let above = between(at + step);
        let below = between(at - step);
        if (!(above.is_known && below.is_known)) {
            return vec3<f32>(0.0);
        }
        gradient[k] = above.value - below.value;
    }
    let size = length(gradient);
    if (size < 1e-9) {
        return vec3<f32>(0.0);
    }
    // The columns are as long as a voxel is short.
    let turned = vec3<f32>(
        dot(job.right.xyz, gradient),
        dot(job.down.xyz, gradient),
        dot(job.ahead.xyz, gradient),
    );
    return normalize(turned);
}

// Where the distance is 0 between two places, of which the nearest points of the lattice have
// different signs; a little around them if need be.
fn crossing(way: vec3<f32>, before: f32, behind: f32, little: f32) -> Distance {
    var near = before;
    var far = behind;
    var d_near = between(place(way, near));
    var d_far = between(place(way, far));
    if (!(d_near.is_known && d_far.is_known)) {
        return UNKNOWN;
    }
    if (d_near.value < 0.0) {
        near -= little;
        d_near = between(place(way, near));
    }
    if (0.0 < d_far.value) {
        far += little;
        d_far = between(place(way, far));
    }
    if (!(d_near.is_known && d_far.is_known)) {
        return UNKNOWN;
    }
    if (d_near.value < 0.0 || 0.0 < d_far.value || d_near.value == d_far.value) {
        return UNKNOWN;
    }
    for (var i = 0u; i < 2u; i += 1u) {
        let z = near + (far - near) * d_near.value / (d_near.value - d_far.value);
        let there = between(place(way, z));
        if (!there.is_known) {
            return UNKNOWN;
        }
        if (0.0 < there.value) {
            near = z;
            d_near = there;
        } else {
            far = z;
            d_far = there;
        }
        if (d_near.value == d_far.value) {
            return Distance(true, z);
        }
    }
    return Distance(true, near + (far - near) * d_near.value / (d_near.value - d_far.value));
}

// The distance at the point of the lattice nearest to `at`.
fn nearest(at: vec3<f32>) -> Distance {
    return known(vec3<i32>(floor(at + 0.5)) + job.origin.xyz);
}

// The distance between the points of the lattice around `at`, linear along each axis; not known where
// one of them is not.
fn between(at: vec3<f32>) -> Distance {
    let low = floor(at);
    let share = at - low;
    let first = vec3<i32>(low) + job.origin.xyz;
    var sum = 0.0;
    for (var c = 0u; c < 8u; c += 1u) {
        let corner = vec3<u32>(c & 1u, (c >> 1u) & 1u, c >> 2u);
        let there = known(first + vec3<i32>(corner));
        if (!there.is_known) {
            return UNKNOWN;
        }
        let parts = select(1.0 - share, share, corner == vec3<u32>(1u));
        sum += there.value * parts.x * parts.y * parts.z;
    }
    return Distance(true, sum);
}

// The distance at a point of the lattice.
fn known(point: vec3<i32>) -> Distance {
    let block = point >> vec3<u32>(3u);
    if (any(block != last_block)) {
        last_block = block;
        last_slot = slot_of(block);
    }
    if (last_slot == NOWHERE) {
        return UNKNOWN;
    }
    let within = vec3<u32>(point & vec3<i32>(7));
    let found = points[last_slot * N_POINTS + within.x + SIDE * (within.y + SIDE * within.z)];
    return Distance(0.0 < found.y, found.x);
}

// Where a block is kept.
fn slot_of(block: vec3<i32>) -> u32 {
    var i = hash(block) & job.mask;
    while (!is_exhausted()) {
        let entry = table[i];
        if (entry.w < 0) {
            break;
        }
        if (all(entry.xyz == block)) {
            return u32(entry.w);
        }
        i = (i + 1u) & job.mask;
    }
    return NOWHERE;
}

fn hash(block: vec3<i32>) -> u32 {
    let b = bitcast<vec3<u32>>(block);
    let h = stirred(stirred(stirred(0u, b.x), b.y), b.z) * 0x85ebca6bu;
    return h ^ (h >> 13u);
}

fn stirred(h: u32, number: u32) -> u32 {
    let more = (h ^ number) * 0x9e3779b1u;
    return more ^ (more >> 15u);
}
