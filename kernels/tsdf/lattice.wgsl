// The lattice: blocks of 8 x 8 x 8 points, x fastest, then y.

const SIDE = 8u;
const N_POINTS = 512u;

// x: mean distance from the surface (1 is the truncation), positive before it; y: sum of weights, 0
// where nothing is known.
alias Point = vec2<f32>;
