use super::*;
use crate::geom::Vector3;
use crate::progress::Silent;
use nalgebra::Vector6;
use std::f64::consts::TAU;

const N: usize = 36;

/// What is known of a step: a tenth of a degree and a millimetre.
fn known() -> Matrix6<f64> {
    let [turn, shift] = [0.1_f64.to_radians(), 1.0].map(|sigma| 1.0 / (sigma * sigma));
    Matrix6::from_diagonal(&Vector6::new(turn, turn, turn, shift, shift, shift))
}

/// A camera that goes around in a circle of half a metre and looks at its middle.
fn circle() -> Vec<Pose> {
    let around = |i: usize| {
        let turn = Vector3::z() * (TAU * i as f64 / N as f64);
        Pose::new(Vector3::zeros(), turn) * Pose::translation(500.0, 0.0, 0.0)
    };
    (0..N).map(around).collect()
}

fn step(a: usize, b: usize, a_from_b: Pose, kind: EdgeKind) -> Edge {
    Edge { a, b, a_from_b, information: known(), kind }
}

fn between(nodes: &[Pose], a: usize, b: usize) -> Pose {
    nodes[a].inverse() * nodes[b]
}

/// The circle as odometry has it, every step `drift` too much, and the loop from its end to its start.
fn drifted(drift: &Pose) -> PoseGraph {
    let nodes = circle();
    let mut world_from_node = vec![nodes[0]];
    let mut edges = Vec::new();
    for i in 1..N {
        let measured = between(&nodes, i - 1, i) * drift;
        world_from_node.push(world_from_node[i - 1] * measured);
        edges.push(step(i - 1, i, measured, EdgeKind::Step));
    }
    edges.push(step(N - 1, 0, between(&nodes, N - 1, 0) * drift, EdgeKind::Loop));
    PoseGraph { world_from_node, edges, fixed: 0 }
}

fn farthest(one: &[Pose], other: &[Pose]) -> f64 {
    let off = |(a, b): (&Pose, &Pose)| (a.translation.vector - b.translation.vector).norm();
    one.iter().zip(other).map(off).fold(0.0, f64::max)
}

/// Every one of the N steps, the one that closes it too, turns a little too much. So the whole turn is
/// too much by N times that, and by symmetry each step gives up as much: what is left is the circle.
#[test]
fn a_circle_whose_every_step_turns_too_much_closes() {
    let drift = Pose::new(Vector3::zeros(), Vector3::z() * 0.1_f64.to_radians());
    let graph = drifted(&drift);
    let nodes = circle();
    assert!(farthest(&graph.world_from_node, &nodes) > 30.0);
    let plain = GraphOptions { loop_kernel: LoopKernel::None, ..GraphOptions::default() };
    let settled = settle(&graph, &plain, &Silent).unwrap();
    assert!(settled.converged);
    // The steps are as long as before, so the circle stays as large.
    let off = farthest(&settled.world_from_node, &nodes);
    // It leans by one drift, because shifts are measured in the frames that turned too much.
    assert!(off < 2.0, "{off} mm");
    let closing = between(&settled.world_from_node, N - 1, 0);
    let each = between(&settled.world_from_node, 3, 4);
    assert!((closing.rotation.angle() - each.rotation.angle()).abs() < 1e-5);
    assert!((closing.rotation.angle() - TAU / N as f64).abs() < 1e-5);
    assert!(settled.cost[1] < settled.cost[0] / 10.0, "{:?}", settled.cost);
    assert_eq!(settled.world_from_node[0], nodes[0], "the first stays");
}

/// On a line a loop shares what it is off evenly among all steps, itself among them.
#[test]
fn on_a_line_all_edges_share_what_the_loop_is_off() {
    let along = |x: f64| Pose::translation(x, 0.0, 0.0);
    let world_from_node: Vec<Pose> = (0..4).map(|i| along(10.0 * f64::from(i))).collect();
    let mut edges: Vec<Edge> =
        (1..4).map(|i| step(i - 1, i, along(10.0), EdgeKind::Step)).collect();
    edges.push(step(0, 3, along(32.0), EdgeKind::Loop));
    let graph = PoseGraph { world_from_node, edges, fixed: 0 };
    let settled = settle(&graph, &GraphOptions::default(), &Silent).unwrap();
    for (i, pose) in settled.world_from_node.iter().enumerate() {
        assert!((pose.translation.x - 10.5 * i as f64).abs() < 1e-9, "{}", pose.translation.x);
    }
    assert!(settled.off.iter().all(|off| (off - 0.5).abs() < 1e-9), "{:?}", settled.off);
}

#[test]
fn loops_that_are_wrong_are_given_no_weight_and_the_right_ones_close_the_circle() {
    let drift = Pose::new(Vector3::new(0.0, 0.3, 0.0), Vector3::z() * 0.02_f64.to_radians());
    let mut graph = drifted(&drift);
    let nodes = circle();
    for (a, b) in [(2, 20), (5, 30)] {
        graph.edges.push(step(a, b, between(&nodes, a, b), EdgeKind::Loop));
    }
    let n_right = graph.edges.len();
    // Two places that look alike but are not the same, and two more that agree with each other.
    for (a, b) in [(1, 18), (9, 27), (10, 26), (0, 12)] {
        graph.edges.push(step(a, b, Pose::identity(), EdgeKind::Loop));
    }
    let settled = settle(&graph, &GraphOptions::default(), &Silent).unwrap();
    assert!(settled.weights[..n_right].iter().all(|w| *w == 1.0), "{:?}", settled.weights);
    assert!(settled.weights[n_right..].iter().all(|w| *w == 0.0), "{:?}", settled.weights);
    let off = farthest(&settled.world_from_node, &nodes);
    assert!(off < 3.0, "{off} mm");
    // With all of them, nothing is right.
    let plain = GraphOptions { loop_kernel: LoopKernel::None, ..GraphOptions::default() };
    let all = settle(&graph, &plain, &Silent).unwrap();
    assert!(farthest(&all.world_from_node, &nodes) > 50.0);
    let cauchy = GraphOptions { loop_kernel: LoopKernel::Cauchy, ..GraphOptions::default() };
    let some = settle(&graph, &cauchy, &Silent).unwrap();
    assert!(some.weights[n_right..].iter().all(|w| *w < 0.05), "{:?}", some.weights);
}

#[test]
fn which_node_stays_changes_nothing_but_where_all_are() {
    let drift = Pose::new(Vector3::new(0.2, 0.0, 0.1), Vector3::new(1e-3, 0.0, 1e-3));
    let graph = drifted(&drift);
    let settled = settle(&graph, &GraphOptions::default(), &Silent).unwrap();
    let other = PoseGraph { fixed: 17, ..graph.clone() };
    let other = settle(&other, &GraphOptions::default(), &Silent).unwrap();
    for i in 0..N {
        let [one, same] = [&settled, &other].map(|s| between(&s.world_from_node, 3, i));
        let off = one.inverse() * same;
        assert!(off.translation.vector.norm() < 1e-4 && off.rotation.angle() < 1e-7, "{i}");
    }
}

#[test]
fn graphs_that_are_none_are_refused_with_their_place() {
    let graph = drifted(&Pose::identity());
    let refused = |graph: &PoseGraph| {
        settle(graph, &GraphOptions::default(), &Silent).unwrap_err().to_string()
    };
    let mut bad = graph.clone();
    bad.edges[3].b = 99;
    assert_eq!(refused(&bad), "edge 3 goes to node 99, but there are 36");
    let mut bad = graph.clone();
    bad.edges.retain(|edge| edge.a != 7 && edge.b != 7);
    assert!(refused(&bad).contains("from node 0 to node 7"), "{}", refused(&bad));
    let mut bad = graph.clone();
    bad.edges[5].information[(2, 2)] = f64::NAN;
    assert!(refused(&bad).starts_with("edge 5 is not finite"));
    let options = GraphOptions { loop_limit: 0.0, ..GraphOptions::default() };
    let error = settle(&graph, &options, &Silent).unwrap_err().to_string();
    assert!(error.starts_with("--loop-limit is 0"), "{error}");
}
