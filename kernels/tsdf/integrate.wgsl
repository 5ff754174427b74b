// A frame fused with the model. Curless and Levoy (1996), Newcombe et al. (2011).
//
// A workgroup has a block, a thread a row of its points. Twin: src/register/tsdf/integrate.rs.

// A frame and the lattice as its camera sees it.
struct View {
    // One step along each axis of the lattice, in the camera [mm].
    along_x: vec4<f32>,
    along_y: vec4<f32>,
    along_z: vec4<f32>,
    focal: vec2<f32>,
    // Half a pixel more than the centre: whole numbers then begin where a pixel does.
    center: vec2<f32>,
    // Of the picture [px].
    size: vec2<u32>,
    truncation: f32,
    // Up to here behind the surface a reading counts in full; 1 is the truncation.
    sure: f32,
    most_weight: f32,
    most_colors: u32,
    // Of the touched blocks, those of this run.
    begin: u32,
    end: u32,
}

// A block that the frame has something to say about.
struct Touched {
    // Its first point, in the camera [mm].
    first: vec3<f32>,
    // Where it is kept.
    slot: u32,
}

struct Reading {
    depth: f32,
    facing: f32,
    weight: f32,
    // Red, green, blue, and 1 if there is a colour.
    color: u32,
}

@group(0) @binding(0) var<storage, read> view: View;
@group(0) @binding(1) var<storage, read> touched: array<Touched>;
@group(0) @binding(2) var<storage, read> readings: array<Reading>;
@group(0) @binding(3) var<storage, read_write> points: array<Point>;
// Red and green, blue and count: 16 bits each, colours in steps of 1/256.
@group(0) @binding(4) var<storage, read_write> colors: array<vec2<u32>>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i_touched = view.begin + group.x;
    if (view.end <= i_touched) {
        return;
    }
    let block = touched[i_touched];
    let row = block.first + f32(lane % SIDE) * view.along_y.xyz + f32(lane / SIDE) * view.along_z.xyz;
    for (var x = 0u; x < SIDE; x += 1u) {
        let at = row + f32(x) * view.along_x.xyz;
        let pixel = view.focal * at.xy / at.z + view.center;
        let is_seen = 0.0 < at.z && all(vec2<f32>(0.0) <= pixel) && all(pixel < vec2<f32>(view.size));
        if (is_seen) {
            let place = vec2<u32>(pixel);
            tell(readings[place.x + view.size.x * place.y], at.z, block.slot * N_POINTS + lane * SIDE + x);
        }
    }
}

// Adds one reading to the means of point `i` at `depth`.
fn tell(reading: Reading, depth: f32, i: u32) {
    let before = reading.depth - depth;
    if (reading.weight == 0.0 || before < -view.truncation) {
        return;
    }
    let distance = min(before * reading.facing / view.truncation, 1.0);
    let weight = reading.weight * clamp((1.0 + distance) / (1.0 - view.sure), 0.0, 1.0);
    if (weight <= 0.0) {
        return;
    }
    let point = points[i];
    let sum = point.y + weight;
    points[i] = Point(point.x + (distance - point.x) * (weight / sum), min(sum, view.most_weight));
    if (reading.color >> 24u == 1u && distance < 1.0) {
        mix(reading.color, i);
    }
}

fn mix(told: u32, i: u32) {
    let mean = colors[i];
    let n = min((mean.y >> 16u) + 1u, view.most_colors);
    let red = mixed(mean.x & 0xffffu, told & 0xffu, n);
    let green = mixed(mean.x >> 16u, (told >> 8u) & 0xffu, n);
    let blue = mixed(mean.y & 0xffffu, (told >> 16u) & 0xffu, n);
    colors[i] = vec2<u32>(red | (green << 16u), blue | (n << 16u));
}

// The mean of `n`, of which `told` is the last.
fn mixed(mean: u32, told: u32, n: u32) -> u32 {
    return u32(i32(mean) + (i32(told << 8u) - i32(mean)) / i32(n));
}
