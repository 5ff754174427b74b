// The two neurons nearest to a signal, by all threads of a workgroup together: each looks through its
// share, then halves of the group merge what they found (the two-minimum parallel reduction of Morell
// (2014), section 4.3.2). Of equals the lower number wins, as on the processor.

// Farther off than anything.
const FAR = 3.0e38;
const NONE = 0xffffffffu;

struct Two {
    squares: vec2<f32>,
    numbers: vec2<u32>,
}

var<workgroup> found: array<Two, WORKGROUP>;

fn is_before(square: f32, number: u32, than_square: f32, than_number: u32) -> bool {
    return square < than_square || (square == than_square && number < than_number);
}

fn take(two: Two, square: f32, number: u32) -> Two {
    if (is_before(square, number, two.squares.x, two.numbers.x)) {
        return Two(vec2(square, two.squares.x), vec2(number, two.numbers.x));
    }
    if (is_before(square, number, two.squares.y, two.numbers.y)) {
        return Two(vec2(two.squares.x, square), vec2(two.numbers.x, number));
    }
    return two;
}

// Afterwards `found[0]` holds the answer, for all threads. True if every loop came to its end.
fn find_two_nearest(signal: vec3<f32>, n_neurons: u32, lane: u32) -> bool {
    var two = Two(vec2(FAR), vec2(NONE));
    var i = lane;
    for (; i < n_neurons; i += WORKGROUP) {
        let out = neurons[i].xyz - signal;
        two = take(two, out.x * out.x + out.y * out.y + out.z * out.z, i);
    }
    found[lane] = two;
    workgroupBarrier();
    var half = WORKGROUP / 2u;
    for (; 0u < half; half /= 2u) {
        if (lane < half) {
            let other = found[lane + half];
            found[lane] = take(
                take(found[lane], other.squares.x, other.numbers.x),
                other.squares.y,
                other.numbers.y,
            );
        }
        workgroupBarrier();
    }
    return n_neurons <= i && half == 0u;
}
