// Every primitive is tried at every step. Morell (2014), section 4.4, algorithm 4.
//
// One thread for each step; primitives go through the workgroup's memory a tile at a time, so that
// they are read once for all steps of a group. A tile is looked through for its highest bound first,
// without a branch, and hardly ever once more. Twin: src/cam/digitize/exhaustive.rs.

var<workgroup> tile: array<Primitive, WORKGROUP>;

@compute @workgroup_size(WORKGROUP)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let is_there = id.x < job.n_steps;
    let i_step = min(id.x, job.n_steps - 1u);
    let step = steps[i_step];
    resume(i_step);
    for (var start = job.begin; start < job.end; start += WORKGROUP) {
        let n_primitives = min(WORKGROUP, job.end - start);
        workgroupBarrier();
        if (lane < n_primitives) {
            tile[lane] = primitives[start + lane];
        }
        workgroupBarrier();
        var top = NONE;
        for (var i = 0u; i < n_primitives; i += 1u) {
            top = max(top, upper_of(step, tile[i]));
        }
        let n_again = select(0u, n_primitives, is_there && best <= top);
        for (var i = 0u; i < n_again; i += 1u) {
            let bounds = bounds_of(step, tile[i]);
            if (best <= bounds.upper) {
                offer(i_step, job.first + start + i, bounds);
            }
        }
    }
    if (is_there) {
        leave(i_step);
    }
}
