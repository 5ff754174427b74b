// The same by a search tree: what cannot reach the floor is not looked into.
//
// One thread for each step. A first way down the tree, always to the child of the highest bound, only
// raises the floor; then all that may reach it is visited, depth first, the most promising child of a
// node before the others. Twins: src/cam/digitize/indexed.rs, and bound.rs beside it for the boxes.

const WIDTH = 16u;
// Six levels of nodes: sixteen children each, one of which is taken off before the next come on.
const MOST_WAITING = 96u;
// What waits is a place and, above these bits, how many levels of nodes lie under it.
const LEVEL_SHIFT = 28u;
const PLACE = 0x0fffffffu;
const NO_NUMBER = 0xffffffffu;

// An oriented box: its centre with the radius of the ball that holds it, less than 0 where there is no
// child, and three half-sides, the last the thin one.
struct Child {
    center: vec4<real>,
    a: vec4<real>,
    b: vec4<real>,
    c: vec4<real>,
}

// Sixteen for each node.
@group(0) @binding(5) var<storage, read> children: array<Child>;
// Where each of them leads; then, from `job.numbers_at` on, the numbers of the primitives.
@group(0) @binding(6) var<storage, read> links: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if (job.n_steps <= id.x) {
        return;
    }
    let step = steps[id.x];
    resume(id.x);
    raise_floor(step);
    visit(step, id.x);
    leave(id.x);
    finish(id.x);
}

// Down to the most promising leaf.
fn raise_floor(step: Step) {
    var highest = NONE;
    var place = job.roots[0];
    for (var i = 0u; i < job.n_roots; i += 1u) {
        let child = highest_child(step, job.roots[i]);
        if (highest < child.bound) {
            highest = child.bound;
            place = child.place;
        }
    }
    if (highest == NONE) {
        return;
    }
    for (var level = 1u; level < job.n_levels; level += 1u) {
        let child = highest_child(step, place);
        if (child.bound == NONE) {
            return;
        }
        place = child.place;
    }
    for (var lane = 0u; lane < WIDTH; lane += 1u) {
        best = max(best, bounds_of(step, primitives[place * WIDTH + lane]).lower);
    }
}

struct Promise {
    bound: real,
    place: u32,
}

fn highest_child(step: Step, node: u32) -> Promise {
    var highest = Promise(NONE, 0u);
    for (var lane = 0u; lane < WIDTH; lane += 1u) {
        let bound = bound_of_child(step, children[node * WIDTH + lane]);
        if (highest.bound < bound) {
            highest = Promise(bound, links[node * WIDTH + lane]);
        }
    }
    return highest;
}

fn visit(step: Step, i_step: u32) {
    var waiting: array<u32, MOST_WAITING>;
    var bounds: array<real, MOST_WAITING>;
    var n_waiting = 0u;
    for (; n_waiting < job.n_roots; n_waiting += 1u) {
        waiting[n_waiting] = job.roots[n_waiting] | (job.n_levels << LEVEL_SHIFT);
        bounds[n_waiting] = -NONE;
    }
    expect_end(n_waiting == job.n_roots);
    while (0u < n_waiting) {
        n_waiting -= 1u;
        if (bounds[n_waiting] < best) {
            continue;
        }
        let place = waiting[n_waiting] & PLACE;
        let level = waiting[n_waiting] >> LEVEL_SHIFT;
        if (level == 0u) {
            visit_leaf(step, i_step, place);
            continue;
        }
        let first = n_waiting;
        var top = first;
        var lane = 0u;
        for (; lane < WIDTH; lane += 1u) {
            let bound = bound_of_child(step, children[place * WIDTH + lane]);
            if (best <= bound) {
                waiting[n_waiting] = links[place * WIDTH + lane] | ((level - 1u) << LEVEL_SHIFT);
                bounds[n_waiting] = bound;
                if (bounds[top] < bound) {
                    top = n_waiting;
                }
                n_waiting += 1u;
            }
        }
        expect_end(lane == WIDTH);
        if (first < n_waiting) {
            let last = n_waiting - 1u;
            let promising = waiting[top];
            let bound = bounds[top];
            waiting[top] = waiting[last];
            bounds[top] = bounds[last];
            waiting[last] = promising;
            bounds[last] = bound;
        }
    }
    expect_end(n_waiting == 0u);
}

// Lanes without a primitive repeat others, under a number that is none. All are bounded first: few are
// worth a second look.
fn visit_leaf(step: Step, i_step: u32, leaf: u32) {
    var worth = 0u;
    var lane = 0u;
    for (; lane < WIDTH; lane += 1u) {
        let upper = upper_of(step, primitives[leaf * WIDTH + lane]);
        worth |= select(0u, 1u << lane, best <= upper);
    }
    expect_end(lane == WIDTH);
    while (worth != 0u) {
        let slot = leaf * WIDTH + firstTrailingBit(worth);
        worth &= worth - 1u;
        let number = links[job.numbers_at + slot];
        let bounds = bounds_of(step, primitives[slot]);
        if (number != NO_NUMBER && best <= bounds.upper) {
            offer(i_step, number, bounds);
        }
    }
    expect_end(worth == 0u);
}

// No primitive in the box holds the tool higher; NONE if it passes all of them by. By the tangent plane
// over the box's centre, bent down by what the tool bends at least.
fn bound_of_child(step: Step, child: Child) -> real {
    let at = seen(step, child.center.xyz);
    let radius = child.center.w + step.across;
    let is_beside = tool.reach_x + radius < abs(at.x) || tool.reach_z + radius < abs(at.z);
    if (child.center.w < real(0) || is_beside) {
        return NONE;
    }
    let plane = tangent(at.x, at.z);
    let bent = bent_plane(plane, at.x, at.z);
    let a = turned(step, child.a.xyz);
    let b = turned(step, child.b.xyz);
    let c = turned(step, child.c.xyz);
    // The long sides share what mixes them, which may leave one bending upwards. The thin side only
    // climbs; what mixes it with the others is charged in full.
    let mixed = abs(bend_of(a, b));
    let thin = abs(climb_along(bent, c)) + abs(bend_of(c, a)) + abs(bend_of(c, b));
    let rise_a = highest_rise(abs(climb_along(bent, a)), bend_of(a, a) - mixed);
    let rise_b = highest_rise(abs(climb_along(bent, b)), bend_of(b, b) - mixed);
    let steepness = abs(bent.slope_x) + abs(bent.slope_z) + abs(plane.slope_x) + abs(plane.slope_z);
    let highest = at.y + plane.value + bent.risen + thin + rise_a + rise_b;
    return highest + (steepness + real(1)) * step.plane;
}

// The greatest value of `climb s - bend s^2 / 2` on 0 <= s <= 1, for a climb not below 0.
fn highest_rise(climb: real, bend: real) -> real {
    let within = real(0.5) * climb * climb / max(bend, TINY);
    return select(climb - real(0.5) * bend, within, climb < bend);
}
