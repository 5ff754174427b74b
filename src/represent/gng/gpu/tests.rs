use super::*;
use crate::compute::device;
use crate::represent::gng::winners::{Scan, Winners};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn signals(n: usize, seed: u64) -> Vec<Place> {
    let mut draws = Pcg64Mcg::seed_from_u64(seed);
    let mut signal = || {
        let [u, v]: [f32; 2] = [draws.random(), draws.random()];
        [100.0 * u - 50.0, 60.0 * v - 30.0, 5.0 * (9.0 * u).sin() * (7.0 * v).cos()]
    };
    (0..n).map(|_| signal()).collect()
}

fn rates() -> Rates {
    crate::represent::gng::GngOptions::default().rates()
}

/// A network of `n` neurons.
fn network(n: usize) -> (Network, Scan) {
    let all = signals(40 * n, 1);
    let mut network = Network::of_two([all[0], all[1]]);
    let mut winners = Scan::over(&network.neurons);
    for some in all.chunks(40) {
        learn(&mut network, &mut winners, some, rates());
        network.bury(&mut winners);
        if network.neurons.len() < n {
            network.insert(&rates(), &mut winners);
        }
    }
    (network, winners)
}

/// The twin: what the kernel does, on the processor.
fn learn(network: &mut Network, winners: &mut Scan, signals: &[Place], rates: Rates) -> f64 {
    let mut sum = 0.0;
    for &signal in signals {
        let won = winners.look(signal, &network.neurons, &network.links);
        sum += f64::from(won.square.sqrt());
        network.adapt(signal, won, &rates, winners);
    }
    sum
}

fn edges(network: &Network) -> Vec<(u32, Slot)> {
    let row = |i: u32| network.links.of(i).iter().map(move |slot| (i, *slot));
    let mut all: Vec<(u32, Slot)> = (0..network.neurons.len() as u32).flat_map(row).collect();
    all.sort_by_key(|(i, slot)| (*i, slot.to));
    all
}

fn assert_same(found: &Network, expected: &Network) {
    assert_eq!(found.neurons.len(), expected.neurons.len());
    assert_eq!(edges(found), edges(expected));
    for (a, b) in found.neurons.iter().zip(&expected.neurons) {
        assert_eq!(a.wins, b.wins);
        for k in 0..3 {
            // 100 mm in single precision, moved some hundred times.
            assert!((a.at[k] - b.at[k]).abs() < 2e-3, "{a:?} {b:?}");
        }
    }
    for (a, b) in found.errors().zip(expected.errors()) {
        assert!((a - b).abs() <= 1e-3 * b.max(1e-2), "{a} {b}");
    }
}

#[test]
fn ten_thousand_signals_and_ten_neurons_leave_the_network_that_the_processor_leaves() {
    let Some(gpu) = device() else { return };
    let (mut expected, mut winners) = network(1500);
    let mut visit = Visit::begin(&expected, &gpu, rates()).unwrap();
    for some in signals(10_000, 7).chunks(1000) {
        let sum = visit.learn(some).unwrap();
        let twin = learn(&mut expected, &mut winners, some, rates());
        assert!((sum - twin).abs() < 1e-3 * twin, "{sum} {twin}");
        visit.insert().unwrap();
        expected.insert(&rates(), &mut winners);
    }
    assert_same(&visit.end().unwrap(), &expected);
}

#[test]
fn errors_that_decay_with_every_signal_are_the_processors() {
    let Some(gpu) = device() else { return };
    let (mut expected, mut winners) = network(60);
    let rates = Rates { decay: Decay::Signal, ..rates() };
    let mut visit = Visit::begin(&expected, &gpu, rates).unwrap();
    let some = signals(3000, 3);
    visit.learn(&some).unwrap();
    learn(&mut expected, &mut winners, &some, rates);
    let found = visit.end().unwrap();
    let sum = |network: &Network| network.errors().sum::<f64>();
    assert!((sum(&found) - sum(&expected)).abs() < 1e-3 * sum(&expected));
}

#[test]
fn a_neuron_with_more_edges_than_slots_gets_more() {
    let Some(gpu) = device() else { return };
    // A hub that is second to everybody: all signals lie on a sphere about it.
    let mut draws = Pcg64Mcg::seed_from_u64(5);
    let mut ring: Vec<Place> = vec![[0.0; 3]];
    ring.extend((0..40).map(|_| {
        let out: [f32; 3] = [0, 1, 2].map(|_| draws.random_range(-1.0..1.0));
        let norm = (out[0] * out[0] + out[1] * out[1] + out[2] * out[2]).sqrt();
        out.map(|x| 10.0 * x / norm)
    }));
    let mut links = Links::new();
    for _ in &ring {
        links.add();
    }
    (1..10).for_each(|i| links.confirm(0, i, 0));
    let neurons = ring.iter().map(|at| Neuron { at: *at, wins: 0 }).collect();
    let network = Network::of_parts(neurons, links, vec![0.0; 41]);
    let mut visit = Visit::begin(&network, &gpu, rates()).unwrap();
    let near_the_hub: Vec<Place> = ring[1..].iter().map(|at| at.map(|x| 0.2 * x)).collect();
    visit.learn(&near_the_hub).unwrap();
    let mut expected = network;
    let mut winners = Scan::over(&expected.neurons);
    learn(&mut expected, &mut winners, &near_the_hub, rates());
    assert!(16 < expected.links.of(0).len(), "{}", expected.links.of(0).len());
    assert_same(&visit.end().unwrap(), &expected);
}

#[test]
fn the_winners_of_a_batch_are_those_of_the_scan() {
    let Some(gpu) = device() else { return };
    let (network, scan) = network(700);
    let wanted = signals(500, 9);
    let on_device = OnDevice::over(&gpu, &network.neurons);
    let found = on_device.look_all(&wanted, &network.neurons, &network.links).unwrap();
    for (won, signal) in found.iter().zip(wanted) {
        let expected = scan.look(signal, &network.neurons, &network.links);
        assert_eq!((won.first, won.second), (expected.first, expected.second));
        assert!((won.square - expected.square).abs() <= 1e-5 * expected.square);
    }
}
