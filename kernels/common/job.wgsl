// What one run does: which steps, and which of the primitives that are bound.

struct Job {
    n_steps: u32,
    // Of the primitives that are bound, those from `begin` up to `end` are tried.
    begin: u32,
    end: u32,
    // Of a search tree: levels of nodes, and the nodes to begin at.
    n_levels: u32,
    n_roots: u32,
    // Where the numbers of its primitives begin among its links.
    numbers_at: u32,
    pad_a: u32,
    pad_b: u32,
    roots: vec4<u32>,
}

@group(0) @binding(0) var<storage, read> job: Job;
