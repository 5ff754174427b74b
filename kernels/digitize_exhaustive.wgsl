// Every primitive is tried at every step. Morell (2014), section 4.4, algorithm 4.
//
// A thread has four neighbouring steps; primitives go through the workgroup's memory a tile at a time,
// so that they are read once for all steps of a group, and from there once for four. A tile is looked
// through for its highest bound first, without a branch, and hardly ever once more. Twin:
// src/cam/digitize/exhaustive.rs.

const STEPS_A_THREAD = 4u;
const TILE = 128u;

// What the primitives are called: they come in the order of the search tree's leaves, neighbours together.
@group(0) @binding(5) var<storage, read> numbers: array<u32>;

var<workgroup> tile: array<Primitive, TILE>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let first = id.x * STEPS_A_THREAD;
    let last = job.n_steps - 1u;
    let a = steps[min(first, last)];
    let b = steps[min(first + 1u, last)];
    let c = steps[min(first + 2u, last)];
    let d = steps[min(first + 3u, last)];
    raise_floors(first, lane, a, b, c, d);
    var start = job.begin;
    for (; start < job.end; start += TILE) {
        let n_primitives = min(TILE, job.end - start);
        workgroupBarrier();
        take(lane, start, 1u, n_primitives);
        workgroupBarrier();
        var tops = vec4<real>(NONE);
        var i = 0u;
        for (; i < n_primitives; i += 1u) {
            let primitive = tile[i];
            tops = max(tops, vec4<real>(
                upper_of(a, primitive),
                upper_of(b, primitive),
                upper_of(c, primitive),
                upper_of(d, primitive),
            ));
        }
        expect_end(i == n_primitives);
        look_again(first, start, n_primitives, tops.x);
        look_again(first + 1u, start, n_primitives, tops.y);
        look_again(first + 2u, start, n_primitives, tops.z);
        look_again(first + 3u, start, n_primitives, tops.w);
    }
    expect_end(job.end <= start);
    finish(first);
    finish(first + 1u);
    finish(first + 2u);
    finish(first + 3u);
}

// Into the workgroup's memory: `n_primitives` from `start` on, each `stride`-th.
fn take(lane: u32, start: u32, stride: u32, n_primitives: u32) {
    var i = lane;
    for (; i < n_primitives; i += WORKGROUP) {
        tile[i] = primitives[start + i * stride];
    }
    expect_end(n_primitives <= i);
}

// By primitives from all over the run: without them each tile on the way up to the contact would be
// looked at again.
fn raise_floors(first: u32, lane: u32, a: Step, b: Step, c: Step, d: Step) {
    let n_primitives = min(TILE, job.end - job.begin);
    take(lane, job.begin, (job.end - job.begin) / n_primitives, n_primitives);
    workgroupBarrier();
    var floors = vec4<real>(NONE);
    for (var i = 0u; i < n_primitives; i += 1u) {
        let primitive = tile[i];
        floors = max(floors, vec4<real>(
            lower_of(a, primitive),
            lower_of(b, primitive),
            lower_of(c, primitive),
            lower_of(d, primitive),
        ));
    }
    raise_floor(first, floors.x);
    raise_floor(first + 1u, floors.y);
    raise_floor(first + 2u, floors.z);
    raise_floor(first + 3u, floors.w);
}

fn raise_floor(i_step: u32, floor: real) {
    if (i_step < job.n_steps) {
        states[i_step].floor = max(states[i_step].floor, floor);
    }
}

// Offers what of the tile may hold the tool as high as the floor, if its highest bound does.
fn look_again(i_step: u32, start: u32, n_primitives: u32, top: real) {
    if (job.n_steps <= i_step) {
        return;
    }
    resume(i_step);
    let step = steps[i_step];
    let n_again = select(0u, n_primitives, best <= top);
    var i = 0u;
    for (; i < n_again; i += 1u) {
        let bounds = bounds_of(step, tile[i]);
        if (best <= bounds.upper) {
            offer(i_step, numbers[start + i], bounds);
        }
    }
    expect_end(i == n_again);
    leave(i_step);
}
