//! The kernels of digitizing, put together for a part and a tool.

use super::Device;
use crate::cam::digitize::part::Primitives;
use crate::cam::digitize::{Digitizer, Method};
use crate::compute::{Kernel, Precision};
use crate::tool::Cutter;

const JOB: &str = include_str!("../../../../kernels/common/job.wgsl");
const POSE: &str = include_str!("../../../../kernels/common/pose.wgsl");
const TOOL: &str = include_str!("../../../../kernels/common/tool.wgsl");
const WHEEL: &str = include_str!("../../../../kernels/common/wheel.wgsl");
const MILL: &str = include_str!("../../../../kernels/common/mill.wgsl");
const CANDIDATES: &str = include_str!("../../../../kernels/common/candidates.wgsl");
const POINT: &str = include_str!("../../../../kernels/common/point.wgsl");
const TRIANGLE: &str = include_str!("../../../../kernels/common/triangle.wgsl");
const EXHAUSTIVE: &str = include_str!("../../../../kernels/digitize_exhaustive.wgsl");
const TREE: &str = include_str!("../../../../kernels/digitize_tree.wgsl");

/// What is tried, by what, and how.
#[derive(Debug, Clone, Copy)]
struct Task {
    is_triangles: bool,
    is_wheel: bool,
    method: Method,
}

/// The kernel for what the digitizer tries with its cutter.
pub(super) fn kernel(digitizer: &Digitizer, device: &Device) -> Kernel {
    let task = Task {
        is_triangles: matches!(digitizer.part.primitives, Primitives::Triangles(..)),
        is_wheel: matches!(digitizer.cutter, Cutter::Wheel(_)),
        method: digitizer.method,
    };
    task.kernel(device.precision, device.workgroup)
}

/// Steps that a thread of its kernel takes: `STEPS_A_THREAD` of `kernels/digitize_exhaustive.wgsl`.
pub(super) fn steps_a_thread(method: Method) -> u32 {
    match method {
        Method::Exhaustive => 4,
        Method::Indexed => 1,
    }
}

impl Task {
    fn kernel(self, precision: Precision, workgroup: u32) -> Kernel {
        let shape = if self.is_wheel { WHEEL } else { MILL };
        let primitive = if self.is_triangles { TRIANGLE } else { POINT };
        let (name, search) = match self.method {
            Method::Exhaustive => ("digitize_exhaustive", EXHAUSTIVE),
            Method::Indexed => ("digitize_tree", TREE),
        };
        let parts = vec![JOB, TOOL, CANDIDATES, shape, POSE, primitive, search];
        Kernel { name, parts, precision, workgroup }
    }
}

#[cfg(test)]
mod tests {
    use super::super::layout::{Double, Job, Layout, N_CANDIDATES, Single, double, single};
    use super::*;
    use crate::compute::judge::{Shape, assert_valid, in_rust, in_wgsl};

    fn all() -> impl Iterator<Item = Kernel> {
        let precisions = [Single::PRECISION, Double::PRECISION].into_iter();
        precisions.flat_map(|precision| {
            (0..8).map(move |i| {
                let method = if i < 4 { Method::Exhaustive } else { Method::Indexed };
                let task = Task { is_triangles: i & 1 == 1, is_wheel: i & 2 == 2, method };
                task.kernel(precision, 64)
            })
        })
    }

    #[test]
    fn every_kernel_is_valid_and_needs_f64_only_where_it_computes_with_it() {
        for kernel in all() {
            assert_valid(&kernel);
        }
    }

    macro_rules! mirrors {
        ($module:ident) => {
            [
                ("Job", in_rust!(
                    Job: n_steps, begin, end, n_levels, n_roots, numbers_at, pad_a, pad_b, roots
                )),
                ("Triangle", in_rust!($module::Triangle: a, b, c)),
                ("Child", in_rust!($module::Child: center, a, b, c)),
                ("Step", in_rust!($module::Step: x, y, z, across, along, plane, pad)),
                (
                    "Tool",
                    in_rust!(
                        $module::Tool: reach_x, reach_z, top, bend_x, bend_z, major, minor, radius,
                        corner_center, corner_radius, corner_rise, flank_from, flank_at,
                        flank_slope, flank_to, rim_center, rim_radius, rim_rise
                    ),
                ),
                ("State", in_rust!($module::State: floor, lost, uppers, n, n_runs, primitives)),
            ]
        };
    }

    #[test]
    fn every_struct_lies_in_memory_as_its_mirror_does() {
        for kernel in all()
            .filter(|kernel| kernel.name == "digitize_tree" && kernel.parts.contains(&TRIANGLE))
        {
            let mirrors: [(&str, Shape); 6] = match kernel.precision {
                Precision::Single => mirrors!(single),
                Precision::Double => mirrors!(double),
            };
            for (name, mirror) in mirrors {
                assert_eq!(in_wgsl(&kernel, name), mirror, "{name} in {:?}", kernel.precision);
            }
        }
    }

    #[test]
    fn the_kernels_have_as_many_candidates_and_steps_a_thread_as_the_host_believes() {
        assert!(CANDIDATES.contains(&format!("N_CANDIDATES = {N_CANDIDATES}u;")));
        let n_steps = steps_a_thread(Method::Exhaustive);
        assert!(EXHAUSTIVE.contains(&format!("STEPS_A_THREAD = {n_steps}u;")));
        assert!(CANDIDATES.contains(&format!("uppers: array<real, {N_CANDIDATES}>")));
    }
}
