//! Mirrors of the kernels' structs, once for each precision.
//!
//! A test beside [`kernels`](super::kernels) compares their offsets with those of the WGSL.

use super::slack::StepSlack;
use crate::compute::Precision;
use crate::tool::{Cutter, HeightFunction};
use bytemuck::{Pod, Zeroable};

/// Candidates a step has room for: `N_CANDIDATES` of `kernels/common/candidates.wgsl`.
pub(super) const N_CANDIDATES: usize = 14;
/// Where a mill's flank begins that has none: beyond any point.
const NOWHERE: f64 = 1e30;

/// Mirrors `Job` of `kernels/common/job.wgsl`.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct Job {
    pub(super) n_steps: u32,
    pub(super) begin: u32,
    pub(super) end: u32,
    pub(super) n_levels: u32,
    pub(super) n_roots: u32,
    pub(super) numbers_at: u32,
    pub(super) pad_a: u32,
    pub(super) pad_b: u32,
    pub(super) roots: [u32; 4],
}

/// What a device leaves of one step.
pub(super) struct Listed {
    primitives: [u32; N_CANDIDATES],
    n: usize,
    /// Nothing else may be touched.
    pub(super) is_whole: bool,
}

impl Listed {
    /// What may be touched.
    pub(super) fn primitives(&self) -> &[u32] {
        &self.primitives[..self.n]
    }
}

/// How a job is laid out for kernels of one precision.
pub(super) trait Layout: Send + Sync {
    type Point: Pod + Send + Sync;
    type Triangle: Pod + Send + Sync;
    type Child: Pod + Send + Sync;
    type Step: Pod + Send + Sync;
    type Tool: Pod + Send + Sync;
    type State: Pod + Send + Sync;
    /// Its numbers.
    #[cfg_attr(not(test), expect(dead_code, reason = "tests put kernels of it together"))]
    const PRECISION: Precision;
    /// The rounding unit of its numbers.
    const ROUNDING: f64;

    fn point(at: [f64; 3]) -> Self::Point;
    fn triangle(corners: [[f64; 3]; 3]) -> Self::Triangle;
    /// A box by its centre, the radius of the ball around it (less than 0 if there is none), and its
    /// half-sides.
    fn child(center: [f64; 3], radius: f64, sides: [[f64; 3]; 3]) -> Self::Child;
    fn step(rows: [[f64; 4]; 3], slack: &StepSlack) -> Self::Step;
    fn tool(cutter: &Cutter) -> Self::Tool;
    /// Before any primitive has been tried.
    fn nothing_yet() -> Self::State;
    /// What `n_runs` of a kernel left, or those of them that came to their end.
    fn listed(state: &Self::State, n_runs: u32) -> Listed;
}

macro_rules! layout {
    ($layout:ident, $module:ident, $real:ident, $precision:expr) => {
        #[doc = concat!("Kernels that compute in `", stringify!($real), "`.")]
        pub(super) struct $layout;

        pub(super) mod $module {
            use super::*;

            /// Mirrors `Triangle` of `kernels/common/triangle.wgsl`.
            #[repr(C)]
            #[derive(Debug, Clone, Copy, Pod, Zeroable)]
            pub(in super::super) struct Triangle {
                pub(in super::super) a: [$real; 4],
                pub(in super::super) b: [$real; 4],
                pub(in super::super) c: [$real; 4],
            }

            /// Mirrors `Child` of `kernels/digitize_tree.wgsl`.
            #[repr(C)]
            #[derive(Debug, Clone, Copy, Pod, Zeroable)]
            pub(in super::super) struct Child {
                pub(in super::super) center: [$real; 4],
                pub(in super::super) a: [$real; 4],
                pub(in super::super) b: [$real; 4],
                pub(in super::super) c: [$real; 4],
            }

            /// Mirrors `Step` of `kernels/common/pose.wgsl`.
            #[repr(C)]
            #[derive(Debug, Clone, Copy, Pod, Zeroable)]
            pub(in super::super) struct Step {
                pub(in super::super) x: [$real; 4],
                pub(in super::super) y: [$real; 4],
                pub(in super::super) z: [$real; 4],
                pub(in super::super) across: $real,
                pub(in super::super) along: $real,
                pub(in super::super) plane: $real,
                pub(in super::super) pad: $real,
            }

            /// Mirrors `Tool` of `kernels/common/tool.wgsl`.
            #[repr(C)]
            #[derive(Debug, Clone, Copy, Pod, Zeroable)]
            pub(in super::super) struct Tool {
                pub(in super::super) reach_x: $real,
                pub(in super::super) reach_z: $real,
                pub(in super::super) top: $real,
                pub(in super::super) bend_x: $real,
                pub(in super::super) bend_z: $real,
                pub(in super::super) major: $real,
                pub(in super::super) minor: $real,
                pub(in super::super) radius: $real,
                pub(in super::super) corner_center: $real,
                pub(in super::super) corner_radius: $real,
                pub(in super::super) corner_rise: $real,
                pub(in super::super) flank_from: $real,
                pub(in super::super) flank_at: $real,
                pub(in super::super) flank_slope: $real,
                pub(in super::super) flank_to: $real,
                pub(in super::super) rim_center: $real,
                pub(in super::super) rim_radius: $real,
                pub(in super::super) rim_rise: $real,
            }

            /// Mirrors `State` of `kernels/common/candidates.wgsl`.
            #[repr(C)]
            #[derive(Debug, Clone, Copy, Pod, Zeroable)]
            pub(in super::super) struct State {
                pub(in super::super) floor: $real,
                pub(in super::super) lost: $real,
                pub(in super::super) uppers: [$real; N_CANDIDATES],
                pub(in super::super) n: u32,
                pub(in super::super) n_runs: u32,
                pub(in super::super) primitives: [u32; N_CANDIDATES],
            }
        }

        impl Layout for $layout {
            type Point = [$real; 4];
            type Triangle = $module::Triangle;
            type Child = $module::Child;
            type Step = $module::Step;
            type Tool = $module::Tool;
            type State = $module::State;
            const PRECISION: Precision = $precision;
            const ROUNDING: f64 = $real::EPSILON as f64 / 2.0;

            fn point([x, y, z]: [f64; 3]) -> Self::Point {
                [x as $real, y as $real, z as $real, 0.0]
            }

            fn triangle(corners: [[f64; 3]; 3]) -> Self::Triangle {
                let [a, b, c] = corners.map(Self::point);
                $module::Triangle { a, b, c }
            }

            fn child(center: [f64; 3], radius: f64, sides: [[f64; 3]; 3]) -> Self::Child {
                // No infinity on its way: a device need not know any.
                let radius = radius.max(-1.0) as $real;
                let [x, y, z, _] = Self::point(center);
                let [a, b, c] = sides.map(Self::point);
                $module::Child { center: [x, y, z, radius], a, b, c }
            }

            fn step(rows: [[f64; 4]; 3], slack: &StepSlack) -> Self::Step {
                let [x, y, z] = rows.map(|row| row.map(|number| number as $real));
                let StepSlack { across, along, plane, .. } = *slack;
                let [across, along, plane] = [across, along, plane].map(|mm| mm as $real);
                $module::Step { x, y, z, across, along, plane, pad: 0.0 }
            }

            fn tool(cutter: &Cutter) -> Self::Tool {
                let reach = cutter.reach();
                let mut tool = $module::Tool {
                    reach_x: reach.x as $real,
                    reach_z: reach.z as $real,
                    top: reach.top as $real,
                    flank_from: NOWHERE as $real,
                    flank_to: NOWHERE as $real,
                    ..$module::Tool::zeroed()
                };
                let bend = match cutter {
                    Cutter::Wheel(wheel) => {
                        tool.major = wheel.major as $real;
                        tool.minor = wheel.minor as $real;
                        wheel.least_bend()
                    }
                    Cutter::Mill(mill) => {
                        tool.radius = mill.radius as $real;
                        tool.corner_center = mill.corner.center as $real;
                        tool.corner_radius = mill.corner.radius as $real;
                        tool.corner_rise = mill.corner.rise as $real;
                        if let Some(flank) = &mill.flank {
                            tool.flank_from = flank.from as $real;
                            tool.flank_at = flank.at as $real;
                            tool.flank_slope = flank.slope as $real;
                            tool.flank_to = flank.to as $real;
                            tool.rim_center = flank.rim.center as $real;
                            tool.rim_radius = flank.rim.radius as $real;
                            tool.rim_rise = flank.rim.rise as $real;
                        }
                        mill.least_bend()
                    }
                };
                [tool.bend_x, tool.bend_z] = bend.map(|bend| bend as $real);
                tool
            }

            // `BOTTOM` and `NONE` of the kernels.
            fn nothing_yet() -> Self::State {
                $module::State { floor: -1e38, lost: -3e38, ..$module::State::zeroed() }
            }

            fn listed(state: &Self::State, n_runs: u32) -> Listed {
                let mut listed = Listed {
                    primitives: [0; N_CANDIDATES],
                    n: 0,
                    is_whole: state.lost < state.floor && state.n_runs == n_runs,
                };
                let candidates = state.uppers.iter().zip(&state.primitives);
                for (upper, primitive) in candidates.take(state.n as usize) {
                    if state.floor <= *upper {
                        listed.primitives[listed.n] = *primitive;
                        listed.n += 1;
                    }
                }
                listed
            }
        }
    };
}

layout!(Single, single, f32, Precision::Single);
layout!(Double, double, f64, Precision::Double);
