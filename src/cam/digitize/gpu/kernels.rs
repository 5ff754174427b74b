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
    use naga::valid::{Capabilities, ValidationFlags, Validator};
    use std::mem::offset_of;

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

    fn module(kernel: &Kernel) -> naga::Module {
        let source = kernel.source();
        naga::front::wgsl::parse_str(&source)
            .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&source)))
    }

    #[test]
    fn every_kernel_is_valid_and_needs_f64_only_where_it_computes_with_it() {
        for kernel in all() {
            let capabilities = match kernel.precision {
                Precision::Single => Capabilities::empty(),
                Precision::Double => Capabilities::FLOAT64,
            };
            let module = module(&kernel);
            let mut validator = Validator::new(ValidationFlags::all(), capabilities);
            if let Err(error) = validator.validate(&module) {
                panic!("{}: {}", kernel.name, error.emit_to_string(&kernel.source()));
            }
            assert_eq!(module.entry_points.len(), 1, "{}", kernel.name);
        }
    }

    /// Name and offset of each member, and the size of the struct.
    type Shape = (Vec<(String, usize)>, usize);

    fn in_wgsl(module: &naga::Module, name: &str) -> Shape {
        let mut types = module.types.iter().map(|(_, found)| found);
        let found = types.find(|found| found.name.as_deref() == Some(name));
        let naga::TypeInner::Struct { members, span } = &found.expect(name).inner else {
            panic!("{name} is no struct")
        };
        let member = |member: &naga::StructMember| {
            (member.name.clone().unwrap_or_default(), member.offset as usize)
        };
        (members.iter().map(member).collect(), *span as usize)
    }

    macro_rules! in_rust {
        ($of:ty: $($member:ident),+) => {
            (
                vec![$((stringify!($member).to_owned(), offset_of!($of, $member))),+],
                size_of::<$of>(),
            )
        };
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
            let module = module(&kernel);
            let mirrors: [(&str, Shape); 6] = match kernel.precision {
                Precision::Single => mirrors!(single),
                Precision::Double => mirrors!(double),
            };
            for (name, mirror) in mirrors {
                assert_eq!(in_wgsl(&module, name), mirror, "{name} in {:?}", kernel.precision);
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
