// A new neuron halfway between the one with the greatest error and its neighbour with the greatest; then
// all errors decay. Fritzke (1995), steps 8 and 9. One workgroup. Twin: `insert` of
// src/represent/gng/network.rs.

struct Insertion {
    // Neurons before; there is room for one more.
    n_neurons: u32,
    width: u32,
    split_error: f32,
    decay: f32,
}

struct Slot {
    to: u32,
    confirmed: u32,
}

@group(0) @binding(0) var<storage, read> insertion: Insertion;
@group(0) @binding(1) var<storage, read_write> neurons: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> wins: array<u32>;
@group(0) @binding(3) var<storage, read_write> errors: array<f32>;
@group(0) @binding(4) var<storage, read_write> n_slots: array<u32>;
@group(0) @binding(5) var<storage, read_write> slots: array<Slot>;

const NONE = 0xffffffffu;

struct Worst {
    error: f32,
    number: u32,
}

var<workgroup> worst: array<Worst, WORKGROUP>;

fn worse(a: Worst, b: Worst) -> Worst {
    let is_b = a.error < b.error || (a.error == b.error && b.number < a.number);
    if (is_b) {
        return b;
    }
    return a;
}

@compute @workgroup_size(WORKGROUP)
fn main(@builtin(local_invocation_index) lane: u32) {
    var mine = Worst(-1.0, NONE);
    for (var i = lane; i < insertion.n_neurons; i += WORKGROUP) {
        // Who has no edge has no neighbour to be halfway to.
        if (0u < n_slots[i]) {
            mine = worse(mine, Worst(errors[i], i));
        }
    }
    worst[lane] = mine;
    workgroupBarrier();
    for (var half = WORKGROUP / 2u; 0u < half; half /= 2u) {
        if (lane < half) {
            worst[lane] = worse(worst[lane], worst[lane + half]);
        }
        workgroupBarrier();
    }
    if (lane == 0u && worst[0].number != NONE) {
        insert(worst[0].number);
    }
    storageBarrier();
    workgroupBarrier();
    for (var i = lane; i <= insertion.n_neurons; i += WORKGROUP) {
        errors[i] *= insertion.decay;
    }
}

fn insert(q: u32) {
    let begin = q * insertion.width;
    var next = Worst(-1.0, NONE);
    var at_q = 0u;
    for (var k = 0u; k < n_slots[q]; k += 1u) {
        let other = slots[begin + k].to;
        let before = next.number;
        next = worse(next, Worst(errors[other], other));
        at_q = select(at_q, k, next.number != before);
    }
    let f = next.number;
    let r = insertion.n_neurons;
    errors[q] *= insertion.split_error;
    errors[f] *= insertion.split_error;
    errors[r] = errors[q];
    neurons[r] = vec4(0.5 * (neurons[q].xyz + neurons[f].xyz), 0.0);
    wins[r] = 0u;
    // The new edges take the place of the old one, as the last of their rows.
    replace(q, f, Slot(r, wins[q]));
    replace(f, q, Slot(r, wins[f]));
    n_slots[r] = 2u;
    slots[r * insertion.width] = Slot(q, wins[q]);
    slots[r * insertion.width + 1u] = Slot(f, wins[f]);
}

fn replace(near: u32, to: u32, by: Slot) {
    let begin = near * insertion.width;
    let last = begin + n_slots[near] - 1u;
    for (var k = begin; k <= last; k += 1u) {
        if (slots[k].to == to) {
            slots[k] = slots[last];
        }
    }
    slots[last] = by;
}
