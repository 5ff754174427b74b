//! What fuses: as asked for, or whichever the first frame shows to be faster.

use super::FuseOptions;
use crate::compute::{Compute, ComputeChoice, GpuError};
use crate::geom::Pose;
use crate::register::tsdf::{Model, Readings, TsdfError, TsdfOptions};
use crate::workflow::cam::ComputeReport;
use std::time::{Duration, Instant};

/// What is to fuse, as the options have it.
#[derive(Debug)]
pub(super) enum Computing {
    /// Where it is told to.
    On(Compute),
    /// Where it is faster: on the processor or on this device, if there is one.
    Faster(Result<Compute, GpuError>),
}

impl Computing {
    /// As `options` ask for it. A device that is asked for by name or kind must be there.
    pub(super) fn asked(options: &FuseOptions) -> Result<Self, GpuError> {
        let device = || Compute::gpu(options.adapter.as_deref());
        Ok(match options.compute {
            ComputeChoice::Cpu => Self::On(Compute::Cpu),
            ComputeChoice::Gpu => Self::On(device()?),
            ComputeChoice::Auto => Self::Faster(device()),
        })
    }

    /// A model of nothing yet, and where it lives; `readings` are those of the first frame.
    pub(super) fn model(
        &self,
        options: &TsdfOptions,
        readings: &Readings,
    ) -> Result<(Model, ComputeReport), TsdfError> {
        let (compute, why) = match self {
            Self::On(compute) => (compute, None),
            Self::Faster(Err(error)) => (&Compute::Cpu, Some(error.to_string())),
            Self::Faster(Ok(device)) => {
                let (compute, why) = faster(device, options, readings)?;
                (compute, Some(why))
            }
        };
        let report = ComputeReport { on: compute.name().to_owned(), why };
        Ok((Model::new(options, compute)?, report))
    }
}

/// The device, if it takes the first frame in and shows it again faster than the processor; and how fast
/// both were.
fn faster<'a>(
    device: &'a Compute,
    options: &TsdfOptions,
    readings: &Readings,
) -> Result<(&'a Compute, String), TsdfError> {
    let on_cpu = timed(&Compute::Cpu, options, readings)?;
    let ms = |time: Duration| time.as_secs_f64() * 1e3;
    let cpu = format!("{:.1} ms a frame on the cpu", ms(on_cpu));
    match timed(device, options, readings) {
        Ok(on_device) => {
            let why = format!("{cpu}, {:.1} on {}", ms(on_device), device.name());
            Ok((if on_device < on_cpu { device } else { &Compute::Cpu }, why))
        }
        Err(TsdfError::Gpu(error)) => Ok((&Compute::Cpu, error.to_string())),
        Err(error) => Err(error),
    }
}

/// The time of the second of two times: kernels are compiled for the first.
fn timed(
    compute: &Compute,
    options: &TsdfOptions,
    readings: &Readings,
) -> Result<Duration, TsdfError> {
    let here = Pose::identity();
    let mut model = Model::new(options, compute)?;
    let mut started = Instant::now();
    for _ in 0..2 {
        started = Instant::now();
        model.integrate(readings, &here)?;
        model.cast(&readings.camera.halved(), &here)?;
    }
    Ok(started.elapsed())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rgbd::{Camera, Image, RgbdFrame};

    #[test]
    fn auto_without_a_device_computes_on_the_cpu_and_says_why() {
        let camera = Camera::pinhole([40, 30], [35.0, 35.0], [20.0, 15.0]);
        let depth = Image::filled(40, 30, 600.0);
        let frame = RgbdFrame { stamp: 0.0, color: None, depth, confidence: None };
        let options = TsdfOptions::default();
        let readings = Readings::new(&frame, &camera, &options).unwrap();
        let computing = Computing::Faster(Err(GpuError::NoAdapter));
        let (model, report) = computing.model(&options, &readings).unwrap();
        assert!(matches!(model, Model::Cpu(_)) && model.n_blocks() == 0);
        assert_eq!(report.on, "cpu");
        assert!(report.why.unwrap().contains("no Vulkan adapter"));
    }
}
