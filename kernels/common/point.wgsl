// How high a point may hold the tool, and how high it does at least.

alias Primitive = vec4<real>;

@group(0) @binding(2) var<storage, read> primitives: array<Primitive>;

// A first bound, soon told.
fn upper_of(step: Step, point: Primitive) -> real {
    return at_most(step, seen(step, point.xyz));
}

fn lower_of(step: Step, point: Primitive) -> real {
    return at_least(step, seen(step, point.xyz));
}

fn bounds_of(step: Step, point: Primitive) -> Bounds {
    let at = seen(step, point.xyz);
    let upper = at_most(step, at);
    if (upper < best) {
        return PASSED_BY;
    }
    return Bounds(at_least(step, at), upper);
}
