// For each step the height the tool is held at for certain, and what may hold it higher.
//
// The host evaluates those in f64. There is room for few; what is let go for want of it is remembered
// by the highest that it may reach, and where that is not too low in the end the host does the step.

// The tool's height where it has none.
const NONE = real(-3.0e38);
// Less than `floor` ever is, and more than `NONE` with anything added.
const BOTTOM = real(-1.0e38);
const N_CANDIDATES = 14u;

// A primitive holds the tool no higher than `upper`, and at `lower` at least.
struct Bounds {
    lower: real,
    upper: real,
}

// Of one that the tool passes by, or that holds it lower than others do.
const PASSED_BY = Bounds(NONE, NONE);

struct State {
    // So high the tool is held at least.
    floor: real,
    // What was let go reaches no higher.
    lost: real,
    // How high each candidate may reach.
    uppers: array<real, 14>,
    n: u32,
    // Runs over the part that came to their end.
    n_runs: u32,
    // The candidates' numbers.
    primitives: array<u32, 14>,
}

@group(0) @binding(4) var<storage, read_write> states: array<State>;

// Of this thread's step.
var<private> best: real;
var<private> lost: real;
var<private> n: u32;
var<private> is_cut_short = false;

fn resume(i_step: u32) {
    best = states[i_step].floor;
    lost = states[i_step].lost;
    n = states[i_step].n;
}

fn leave(i_step: u32) {
    states[i_step].floor = best;
    states[i_step].lost = lost;
    states[i_step].n = n;
}

// Takes a primitive that may hold the tool as high as `best` or higher.
fn offer(i_step: u32, primitive: u32, bounds: Bounds) {
    best = max(best, bounds.lower);
    if (n == N_CANDIDATES) {
        drop_the_low(i_step);
    }
    if (n == N_CANDIDATES || best <= lost) {
        lost = max(lost, bounds.upper);
        return;
    }
    states[i_step].uppers[n] = bounds.upper;
    states[i_step].primitives[n] = primitive;
    n += 1u;
}

fn drop_the_low(i_step: u32) {
    var kept = 0u;
    var i = 0u;
    for (; i < n; i += 1u) {
        let upper = states[i_step].uppers[i];
        if (best <= upper) {
            states[i_step].uppers[kept] = upper;
            states[i_step].primitives[kept] = states[i_step].primitives[i];
            kept += 1u;
        }
    }
    expect_end(i == n);
    n = kept;
}

// Says of a loop whether it went on to its end. Drivers may end those they take for endless: lavapipe of
// Mesa 22 lets the loops of a thread turn 65,535 times in all, then ends them, and forgets what other
// threads of the group had still to do. What they missed may be the highest.
fn expect_end(came_to_its_end: bool) {
    is_cut_short = is_cut_short || !came_to_its_end;
}

// Counts the run, if all loops went to their end; the host does a step of which it misses one.
fn finish(i_step: u32) {
    if (i_step < job.n_steps && !is_cut_short) {
        states[i_step].n_runs += 1u;
    }
}
