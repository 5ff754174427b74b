// One signal after the other, all on the device: the winners by the whole workgroup, then the winner and
// its neighbours move, edges are confirmed and cut. Fritzke (1995), steps 1 to 7; Morell (2014),
// section 4.3.2. A neuron that lost its last edge stays until the host takes it out. Twin: `adapt` of
// src/represent/gng/network.rs.

struct Lesson {
    n_neurons: u32,
    // Signals to learn: from `begin` up to `end`.
    begin: u32,
    end: u32,
    // Slots for the edges of a neuron.
    width: u32,
    max_age: u32,
    winner_rate: f32,
    neighbour_rate: f32,
    // What is left of all errors after a signal.
    signal_decay: f32,
}

// One end of an edge, as in src/represent/gng/links.rs.
struct Slot {
    to: u32,
    confirmed: u32,
}

struct Outcome {
    // Signals learned: the last one, plus one.
    n_learned: u32,
    // 1 if a neuron needs more slots than there are: the signal it happened at was not learned.
    is_full: u32,
    // Sum of the distances of the signals learned.
    distances: f32,
    pad: u32,
}

@group(0) @binding(0) var<storage, read> lesson: Lesson;
@group(0) @binding(1) var<storage, read_write> neurons: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> signals: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> wins: array<u32>;
@group(0) @binding(4) var<storage, read_write> errors: array<f32>;
@group(0) @binding(5) var<storage, read_write> n_slots: array<u32>;
@group(0) @binding(6) var<storage, read_write> slots: array<Slot>;
@group(0) @binding(7) var<storage, read_write> outcome: Outcome;

// Cleared when a loop was cut short or a row is full: nothing more is learned.
var<workgroup> goes_on: u32;
// What a new error is multiplied by: one over the decay since the run began.
var<private> scale: f32 = 1.0;

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(local_invocation_index) lane: u32) {
    goes_on = 1u;
    workgroupBarrier();
    for (var i_signal = lesson.begin; i_signal < lesson.end; i_signal += 1u) {
        let signal = signals[i_signal].xyz;
        let is_whole = find_two_nearest(signal, lesson.n_neurons, lane);
        let two = found[0];
        if (lane == 0u && is_too_full(two.numbers.x, two.numbers.y)) {
            outcome.is_full = 1u;
            goes_on = 0u;
        }
        if (!is_whole) {
            goes_on = 0u;
        }
        if (workgroupUniformLoad(&goes_on) == 0u) {
            break;
        }
        pull_neighbours(signal, two.numbers.x, lane);
        storageBarrier();
        workgroupBarrier();
        if (lane == 0u) {
            win(signal, two);
            cut_old(two.numbers.x, two.numbers.y);
            confirm(two.numbers.x, two.numbers.y);
            outcome.distances += sqrt(two.squares.x);
            outcome.n_learned = i_signal + 1u;
        }
        scale /= lesson.signal_decay;
        if (1.0e18 < scale) {
            rescale(lane);
        }
        storageBarrier();
        workgroupBarrier();
    }
    rescale(lane);
}

fn win(signal: vec3<f32>, two: Two) {
    let first = two.numbers.x;
    wins[first] += 1u;
    errors[first] += two.squares.x * scale;
    pull(first, signal, lesson.winner_rate);
}

fn pull(i: u32, to: vec3<f32>, rate: f32) {
    let at = neurons[i].xyz;
    neurons[i] = vec4(at + rate * (to - at), 0.0);
}

fn pull_neighbours(signal: vec3<f32>, first: u32, lane: u32) {
    let n = n_slots[first];
    for (var k = lane; k < n; k += WORKGROUP) {
        pull(slots[first * lesson.width + k].to, signal, lesson.neighbour_rate);
    }
}

// True if the edge between both is new and one of them has no slot left for it.
fn is_too_full(first: u32, second: u32) -> bool {
    let is_new = slot_of(first, second) == NONE;
    return is_new && lesson.width <= max(n_slots[first], n_slots[second]);
}

// Where the edge to `to` is among those of `near`.
fn slot_of(near: u32, to: u32) -> u32 {
    let begin = near * lesson.width;
    for (var k = 0u; k < n_slots[near]; k += 1u) {
        if (slots[begin + k].to == to) {
            return begin + k;
        }
    }
    return NONE;
}

// Cuts the edges of the winner not confirmed for long, but for that to the second.
fn cut_old(first: u32, second: u32) {
    let begin = first * lesson.width;
    var k = 0u;
    while (k < n_slots[first]) {
        let slot = slots[begin + k];
        let age = wins[first] + wins[slot.to] - slot.confirmed;
        if (lesson.max_age < age && slot.to != second) {
            cut_end(slot.to, first);
            cut_end(first, slot.to);
        } else {
            k += 1u;
        }
    }
}

fn cut_end(near: u32, to: u32) {
    let slot = slot_of(near, to);
    if (slot != NONE) {
        n_slots[near] -= 1u;
        slots[slot] = slots[near * lesson.width + n_slots[near]];
    }
}

fn confirm(first: u32, second: u32) {
    let both = wins[first] + wins[second];
    confirm_end(first, second, both);
    confirm_end(second, first, both);
}

fn confirm_end(near: u32, to: u32, confirmed: u32) {
    var slot = slot_of(near, to);
    if (slot == NONE) {
        slot = near * lesson.width + n_slots[near];
        n_slots[near] += 1u;
    }
    slots[slot] = Slot(to, confirmed);
}

// Errors as they are, before they overflow.
fn rescale(lane: u32) {
    storageBarrier();
    workgroupBarrier();
    for (var i = lane; i < lesson.n_neurons; i += WORKGROUP) {
        errors[i] /= scale;
    }
    scale = 1.0;
}
