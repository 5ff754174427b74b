use super::*;
use crate::compute::{ComputeChoice, device};
use crate::geom::{Point3, PointCloud};
use crate::progress::{Cancelled, Progress, Silent};

/// A ring of the radius 50 about (200, 0, 0), and a straight line far from it.
fn ring_and_line(n: u32) -> PointCloud {
    let at = |i: u32| {
        let t = (f64::from(i) * 0.618_034).fract();
        if i.is_multiple_of(3) {
            Point3::new(0.0, 0.0, 100.0 * t)
        } else {
            let angle = t * std::f64::consts::TAU;
            Point3::new(200.0 + 50.0 * angle.cos(), 50.0 * angle.sin(), 0.0)
        }
    };
    PointCloud { points: (0..n).map(at).collect(), ..PointCloud::default() }
}

/// A bumpy sheet.
fn sheet(n: u32) -> PointCloud {
    let at = |i: u32| {
        let (u, v) = ((f64::from(i) * 0.618_034).fract(), (f64::from(i) * 0.754_878).fract());
        Point3::new(100.0 * u, 60.0 * v, 5.0 * (9.0 * u).sin() * (7.0 * v).cos())
    };
    PointCloud { points: (0..n).map(at).collect(), ..PointCloud::default() }
}

fn grown(cloud: &PointCloud, n: usize, options: &GngOptions) -> Grown {
    grow(&mut &*cloud, None, Some(n), options, &Silent).unwrap()
}

fn refusal(cloud: &PointCloud, n: Option<usize>, options: &GngOptions) -> String {
    grow(&mut &*cloud, None, n, options, &Silent).unwrap_err().to_string()
}

/// Which of the pieces that hang together each neuron belongs to.
fn n_pieces(graph: &NeuronGraph) -> usize {
    let neighbours = graph.neighbours();
    let mut seen = vec![false; neighbours.len()];
    let mut n = 0;
    for begin in 0..neighbours.len() {
        let mut waiting = if seen[begin] { vec![] } else { vec![begin] };
        n += waiting.len();
        while let Some(i) = waiting.pop() {
            if !std::mem::replace(&mut seen[i], true) {
                waiting.extend(neighbours[i].iter().map(|j| *j as usize));
            }
        }
    }
    n
}

#[test]
fn trying_every_neuron_and_looking_in_cells_give_the_same_network() {
    for (cloud, n) in [(ring_and_line(3000), 1000), (sheet(6000), 3000), (sheet(900), 900)] {
        for seed in 1..4 {
            let grid = GngOptions { seed, lambda: 40, ..GngOptions::default() };
            let scan = GngOptions { search: Search::Scan, ..grid.clone() };
            assert!(grown(&cloud, n, &grid) == grown(&cloud, n, &scan), "{n} neurons, seed {seed}");
        }
    }
}

#[test]
fn a_ring_and_a_line_become_two_pieces_of_one_dimension() {
    let graph = grown(&ring_and_line(3000), 60, &GngOptions::default()).graph;
    assert_eq!(n_pieces(&graph), 2);
    let ends = graph.neighbours().iter().filter(|near| near.len() == 1).count();
    assert_eq!(ends, 2, "only the line has ends");
    for point in &graph.neurons.points {
        let from_ring = ((point.x - 200.0).hypot(point.y) - 50.0).hypot(point.z);
        assert!(from_ring.min(point.x.hypot(point.y)) < 1.0, "{point}");
    }
}

#[test]
fn as_many_neurons_as_asked_for_and_errors_that_tell_where_it_is_worst() {
    let cloud = sheet(2000);
    let grown = grown(&cloud, 300, &GngOptions { lambda: 100, ..GngOptions::default() });
    assert_eq!(grown.graph.neurons.points.len(), 300);
    assert_eq!((grown.graph.errors.len(), grown.stopped), (300, Stopped::Count));
    assert!(grown.graph.errors.iter().all(|error| error.is_finite() && 0.0 <= *error));
    let max_age = GngOptions::default().rates().max_age;
    assert!(
        grown.graph.edges.iter().all(|edge| edge.age <= 2 * max_age && edge.ends[0] < edge.ends[1])
    );
}

#[test]
fn a_device_grows_as_many_neurons_signal_by_signal_or_in_batches() {
    let Some(_) = device() else { return };
    let cloud = sheet(2000);
    for batch in [None, Some(60)] {
        let compute = ComputeChoice::Gpu;
        let options = GngOptions { batch, compute, lambda: 60, ..GngOptions::default() };
        let found = grown(&cloud, 90, &options);
        assert_eq!((found.graph.neurons.points.len(), found.stopped), (90, Stopped::Count));
        assert!(matches!(found.learned_on, LearnedOn::Device { n_neurons: 2, .. }));
        assert!(found.graph.neighbours().iter().all(|near| !near.is_empty()));
    }
}

#[test]
fn a_network_that_stays_on_the_processor_is_the_one_that_was_never_asked() {
    let cloud = sheet(6000);
    let never = GngOptions { lambda: 40, ..GngOptions::default() };
    let asked = GngOptions { compute: ComputeChoice::Auto, ..never.clone() };
    let found = grown(&cloud, 2500, &asked);
    match found.learned_on {
        LearnedOn::Cpu { why } => {
            assert!(why.is_some());
            assert!(found.graph == grown(&cloud, 2500, &never).graph);
        }
        // A device may be faster.
        LearnedOn::Device { .. } => assert_eq!(found.graph.neurons.points.len(), 2500),
    }
}

#[test]
fn both_decays_learn_and_differ() {
    let cloud = sheet(2000);
    let thesis = GngOptions { preset: Preset::Thesis, lambda: 100, ..GngOptions::default() };
    let standard = GngOptions { preset: Preset::Standard, ..thesis.clone() };
    assert!(grown(&cloud, 100, &thesis).graph != grown(&cloud, 100, &standard).graph);
}

#[test]
fn the_scale_of_the_errors_is_divided_out_before_it_overflows() {
    // 0.95 to the 20,000th is far below the least number there is.
    let options = GngOptions { preset: Preset::Thesis, lambda: 200, ..GngOptions::default() };
    let grown = grown(&sheet(500), 102, &options);
    assert_eq!(grown.n_signals, 101 * 200);
    assert!(grown.graph.errors.iter().all(|error| error.is_finite()));
    assert!(grown.graph.errors.iter().any(|error| 0.0 < *error));
}

#[test]
fn a_batch_gives_the_same_network_for_any_number_of_threads() {
    let cloud = sheet(2000);
    let options = GngOptions { batch: Some(300), lambda: 300, ..GngOptions::default() };
    let with = |n| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        pool.install(|| grown(&cloud, 400, &options))
    };
    let one = with(1);
    assert_eq!(one.graph.neurons.points.len(), 400);
    assert!(one == with(3));
}

#[test]
fn a_batch_of_one_is_the_algorithm_as_it_stands() {
    let exact = GngOptions { lambda: 120, ..GngOptions::default() };
    let batch = GngOptions { batch: Some(1), ..exact.clone() };
    let cloud = ring_and_line(600);
    assert!(grown(&cloud, 80, &exact) == grown(&cloud, 80, &batch));
}

#[test]
fn it_stops_for_signals_time_and_error() {
    let cloud = sheet(2000);
    let signals = GngOptions { max_signals: Some(2500), ..GngOptions::default() };
    let found = grown(&cloud, 2000, &signals);
    assert_eq!((found.n_signals, found.stopped), (2500, Stopped::Signals));
    let time = GngOptions { max_seconds: Some(1e-9), ..GngOptions::default() };
    assert_eq!(grown(&cloud, 2000, &time).stopped, Stopped::Time);
    let near = GngOptions { target_error: Some(6.0), lambda: 500, ..GngOptions::default() };
    let found = grow(&mut &cloud, None, None, &near, &Silent).unwrap();
    assert_eq!(found.stopped, Stopped::MeanError);
    let n = found.graph.neurons.points.len();
    assert!((20..200).contains(&n), "{n}");
}

#[test]
fn a_network_grows_on_from_where_it_was() {
    let cloud = sheet(3000);
    let options = GngOptions { lambda: 200, ..GngOptions::default() };
    let small = grown(&cloud, 100, &options).graph;
    let large = grow(&mut &cloud, Some(&small), Some(150), &options, &Silent).unwrap();
    assert_eq!(large.graph.neurons.points.len(), 150);
    assert_eq!(large.n_signals, 51 * 200);
    let same = grow(&mut &cloud, Some(&small), Some(100), &options, &Silent).unwrap();
    let ages = |graph: &NeuronGraph| graph.edges.iter().map(|e| u64::from(e.age)).sum::<u64>();
    assert!(same.n_signals == 200 && 0 < ages(&same.graph));
}

#[test]
fn a_network_that_does_not_hang_together_is_refused() {
    let cloud = sheet(100);
    let graph = NeuronGraph { neurons: sheet(3), ..NeuronGraph::default() };
    for (edges, problem) in [
        (vec![[0, 1]], "neuron 3 has no edge"),
        (vec![[0, 7]], "joins neurons 0 and 7 of 3"),
        (vec![[1, 1]], "joins neurons 1 and 1"),
    ] {
        let edges = edges.iter().map(|ends| GraphEdge { ends: *ends, age: 0 }).collect();
        let graph = NeuronGraph { edges, ..graph.clone() };
        let error = grow(&mut &cloud, Some(&graph), Some(9), &GngOptions::default(), &Silent);
        assert!(error.unwrap_err().to_string().contains(problem), "{problem}");
    }
}

#[test]
fn points_in_one_place_are_one_neuron() {
    let cloud = PointCloud { points: vec![Point3::new(3.0, 4.0, 5.0); 9], ..PointCloud::default() };
    let found = grown(&cloud, 5, &GngOptions::default());
    assert_eq!(found.graph.neurons.points, [Point3::new(3.0, 4.0, 5.0)]);
    assert_eq!(found.stopped, Stopped::OnePlace);
}

#[test]
fn what_cannot_be_learned_is_refused() {
    let options = GngOptions::default();
    assert!(refusal(&PointCloud::default(), Some(9), &options).contains("no points"));
    assert!(refusal(&sheet(9), Some(0), &options).contains("at least 2"));
    assert!(refusal(&sheet(9), Some(10), &options).contains("has only 9 points"));
    assert!(refusal(&sheet(9), None, &options).contains("when to stop"));
    let mut bad = sheet(9);
    bad.points[8].x = f64::INFINITY;
    assert!(refusal(&bad, Some(3), &options).starts_with("point 9"));
    let bad = GngOptions { lambda: 0, ..options };
    assert!(refusal(&sheet(9), Some(3), &bad).starts_with("--lambda"));
}

#[test]
fn growing_stops_when_asked_to() {
    struct Hasty;
    impl Progress for Hasty {
        fn start(&self, _: &str, _: u64) {}
        fn advance(&self, _: u64) -> Result<(), Cancelled> {
            Err(Cancelled)
        }
    }
    let found = grow(&mut &sheet(99), None, Some(50), &GngOptions::default(), &Hasty);
    assert!(matches!(found, Err(GngError::Cancelled(_))));
}
