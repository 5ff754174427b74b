// The two nearest neurons of many signals, a workgroup each. Twin: src/represent/gng/winners/scan.rs.

struct Batch {
    n_neurons: u32,
    begin: u32,
    end: u32,
    pad: u32,
}

// Numbers of the two, and how far off the first is, squared; `is_whole` is 1 if no loop was cut short.
struct Answer {
    first: u32,
    second: u32,
    square: f32,
    is_whole: u32,
}

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> neurons: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> signals: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> answers: array<Answer>;

var<workgroup> n_whole: atomic<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let i_signal = batch.begin + group.x;
    let is_whole = find_two_nearest(signals[i_signal].xyz, batch.n_neurons, lane);
    if (is_whole) {
        atomicAdd(&n_whole, 1u);
    }
    workgroupBarrier();
    if (lane == 0u) {
        let two = found[0];
        let all = select(0u, 1u, atomicLoad(&n_whole) == WORKGROUP);
        answers[i_signal] = Answer(two.numbers.x, two.numbers.y, two.squares.x, all);
    }
}
