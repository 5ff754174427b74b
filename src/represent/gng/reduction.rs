//! The search for winners alone, as figure 4.7 of Morell (2014) measures it.

use super::error::GngError;
use super::gpu::OnDevice;
use super::links::Links;
use super::network::{Neuron, Place};
use super::winners::{Scan, Winners, Won};
use crate::compute::Compute;

/// The two of `neurons` nearest to each of `signals`, the nearest first, by trying all: on one thread of the
/// processor, many side by side, or on a device, a workgroup for each signal. Of equals the first.
///
/// There must be two neurons.
pub fn two_minimum(
    neurons: &[Place],
    signals: &[Place],
    compute: &Compute,
) -> Result<Vec<[u32; 2]>, GngError> {
    if neurons.len() < 2 {
        return Err(GngError::TooFew { n_neurons: neurons.len() });
    }
    let neurons: Vec<Neuron> = neurons.iter().map(|at| Neuron { at: *at, wins: 0 }).collect();
    let links = Links::new();
    let all: Vec<Won> = match compute {
        Compute::Cpu => {
            let scan = Scan::over(&neurons);
            signals.iter().map(|signal| scan.look(*signal, &neurons, &links)).collect()
        }
        Compute::Gpu(gpu) => OnDevice::over(gpu, &neurons).look_all(signals, &neurons, &links)?,
    };
    Ok(all.iter().map(|won| [won.first, won.second]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_nearest_come_in_their_order_and_the_first_of_equals() {
        let neurons: Vec<Place> = (0..40).map(|i| [i as f32, 0.0, 0.0]).collect();
        let found = two_minimum(&neurons, &[[7.2, 1.0, 0.0], [9.0, 0.0, 0.0]], &Compute::Cpu);
        assert_eq!(found.unwrap(), [[7, 8], [9, 8]]);
        assert!(two_minimum(&neurons[..1], &[], &Compute::Cpu).is_err());
    }
}
