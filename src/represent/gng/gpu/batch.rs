//! Winners of many signals at once, on a device.

use super::kernels::winners;
use super::layout::{Answer, Batch, vec4};
use crate::compute::Gpu;
use crate::represent::gng::error::GngError;
use crate::represent::gng::links::Links;
use crate::represent::gng::network::{Neuron, Place};
use crate::represent::gng::winners::{Scan, Winners, Won};

/// Winners by trying every neuron on a device, a workgroup for each signal of a batch.
pub(in super::super) struct OnDevice<'a> {
    gpu: &'a Gpu,
    /// For a signal alone, which is not worth the way.
    scan: Scan,
}

impl<'a> OnDevice<'a> {
    pub(in super::super) fn over(gpu: &'a Gpu, neurons: &[Neuron]) -> Self {
        Self { gpu, scan: Scan::over(neurons) }
    }
}

impl Winners for OnDevice<'_> {
    fn look(&self, signal: Place, neurons: &[Neuron], links: &Links) -> Won {
        self.scan.look(signal, neurons, links)
    }

    fn look_all(
        &self,
        signals: &[Place],
        neurons: &[Neuron],
        _links: &Links,
    ) -> Result<Vec<Won>, GngError> {
        let gpu = self.gpu;
        let places: Vec<[f32; 4]> = neurons.iter().map(|neuron| vec4(neuron.at)).collect();
        let wanted: Vec<[f32; 4]> = signals.iter().map(|signal| vec4(*signal)).collect();
        let places = gpu.upload("neurons", &places)?;
        let wanted = gpu.upload("signals", &wanted)?;
        let answers = gpu.upload("answers", &vec![Answer::default(); signals.len()])?;
        let most = gpu.most_workgroups() as usize;
        for begin in (0..signals.len()).step_by(most) {
            let end = signals.len().min(begin + most);
            let batch = Batch {
                n_neurons: neurons.len() as u32,
                begin: begin as u32,
                end: end as u32,
                pad: 0,
            };
            let batch = gpu.upload("batch", &[batch])?;
            let buffers = [&batch, &places, &wanted, &answers];
            gpu.run(&winners(), &buffers, (end - begin) as u32)?;
        }
        let answers: Vec<Answer> = gpu.download("answers", &answers)?;
        if answers.iter().any(|answer| answer.is_whole == 0) {
            let adapter = gpu.name().to_owned();
            return Err(GngError::CutShort { adapter, n_neurons: neurons.len() });
        }
        let won = |a: &Answer| Won { first: a.first, second: a.second, square: a.square };
        Ok(answers.iter().map(won).collect())
    }

    fn moved(&mut self, i: u32, from: Place, to: Place) {
        self.scan.moved(i, from, to);
    }

    fn added(&mut self, i: u32, neurons: &[Neuron]) {
        self.scan.added(i, neurons);
    }

    fn removed(&mut self, i: u32, last: u32, neurons: &[Neuron]) {
        self.scan.removed(i, last, neurons);
    }
}
