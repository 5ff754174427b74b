//! What digitizes: as asked for, or whichever a small batch shows to be faster.
//!
//! Contacts are the same bit for bit wherever they are found, so that the choice changes no program.

use super::options::CamOptions;
use crate::cam::{Contact, DigitizeError, Digitizer};
use crate::compute::{Compute, ComputeChoice, GpuError};
use crate::geom::Pose;
use crate::progress::{Cancelled, Progress};
use serde::Serialize;
use std::time::{Duration, Instant};

/// Positions tried on both, from the middle of the way.
const TRIED: usize = 8192;
/// What a device may take longer than that, before it is called slower: starting it costs.
const PATIENCE: Duration = Duration::from_millis(200);

/// What digitizes, as the options have it.
#[derive(Debug)]
pub(super) enum Computing {
    /// Where it is told to.
    On(Compute),
    /// Where it is faster: on the processor or on this device, if there is one.
    Faster(Result<Compute, GpuError>),
}

/// Where the contacts were found, and why there.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub struct ComputeReport {
    /// `cpu`, or the name of a device.
    pub on: String,
    /// Why there, where the choice was left open.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why: Option<String>,
}

type Contacts = Vec<Option<Contact>>;

impl Computing {
    /// As `options` ask for it. A device that is asked for by name or kind must be there.
    pub(super) fn asked(options: &CamOptions) -> Result<Self, GpuError> {
        let device = || Compute::gpu(options.adapter.as_deref());
        Ok(match options.compute.unwrap_or_default() {
            ComputeChoice::Cpu => Self::On(Compute::Cpu),
            ComputeChoice::Gpu => Self::On(device()?),
            ComputeChoice::Auto => Self::Faster(device()),
        })
    }

    /// The contacts at `n_positions`, and where they were found.
    pub(super) fn contacts(
        &self,
        digitizer: &Digitizer,
        n_positions: usize,
        pose: impl Fn(usize) -> Pose + Sync,
        progress: &dyn Progress,
    ) -> Result<(Contacts, ComputeReport), DigitizeError> {
        let on_cpu = |why: String| {
            let contacts = digitizer.run(n_positions, &pose, progress)?;
            Ok((contacts, ComputeReport { on: "cpu".into(), why: Some(why) }))
        };
        let device = match self {
            Self::On(compute) => {
                let found = digitizer.run_on(compute, n_positions, &pose, progress)?;
                let on = compute.name().to_owned();
                return Ok((found.contacts, ComputeReport { on, why: None }));
            }
            Self::Faster(Err(error)) => return on_cpu(error.to_string()),
            Self::Faster(Ok(device)) => device,
        };
        let why = match tried(digitizer, device, n_positions, &pose, progress) {
            Ok((true, why)) => why,
            Ok((false, why)) => return on_cpu(why),
            Err(DigitizeError::Cancelled(Cancelled)) => return Err(Cancelled.into()),
            Err(error) => return on_cpu(error.to_string()),
        };
        match digitizer.run_on(device, n_positions, &pose, progress) {
            Ok(found) => {
                let report = ComputeReport { on: device.name().to_owned(), why: Some(why) };
                Ok((found.contacts, report))
            }
            Err(DigitizeError::Cancelled(Cancelled)) => Err(Cancelled.into()),
            // The device went away or ran out of room half-way.
            Err(error) => on_cpu(error.to_string()),
        }
    }
}

/// Is the device faster on a batch from the middle? And how fast both were. It is given no longer than
/// it takes to tell.
fn tried(
    digitizer: &Digitizer,
    device: &Compute,
    n_positions: usize,
    pose: &(impl Fn(usize) -> Pose + Sync),
    progress: &dyn Progress,
) -> Result<(bool, String), DigitizeError> {
    let n = n_positions.min(TRIED);
    let from = (n_positions - n) / 2;
    let timed = |compute: &Compute, n: usize, end: Option<Instant>| {
        let started = Instant::now();
        digitizer.run_on(compute, n, |i| pose(from + i), &Until { progress, end })?;
        Ok::<_, DigitizeError>(started.elapsed())
    };
    // The first run of a kernel is the one it is compiled for.
    timed(device, n.min(1), None)?;
    let on_cpu = timed(&Compute::Cpu, n, None)?;
    let end = Instant::now() + 2 * on_cpu + PATIENCE;
    let micros = |time: Duration| time.as_secs_f64() * 1e6 / n.max(1) as f64;
    let cpu = format!("{:.1} us a position on the cpu", micros(on_cpu));
    match timed(device, n, Some(end)) {
        Ok(time) => {
            let told = format!("{cpu}, {:.1} on {}", micros(time), device.name());
            Ok((time < on_cpu, told))
        }
        Err(DigitizeError::Cancelled(Cancelled)) => {
            // By us, or by who asks for all this?
            progress.advance(0)?;
            Ok((false, format!("{cpu}, over twice as much on {}", device.name())))
        }
        Err(error) => Err(error),
    }
}

/// Stops on request, and at some time; what it is told it keeps.
struct Until<'a> {
    progress: &'a dyn Progress,
    end: Option<Instant>,
}

impl Progress for Until<'_> {
    fn start(&self, _stage: &str, _n_units: u64) {}

    fn advance(&self, _n_units: u64) -> Result<(), Cancelled> {
        self.progress.advance(0)?;
        if self.end.is_some_and(|end| end < Instant::now()) { Err(Cancelled) } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::{Method, Part};
    use crate::geom::shapes;
    use crate::progress::Silent;
    use crate::tool::Profile;

    #[test]
    fn auto_without_a_device_computes_on_the_cpu_and_says_why() {
        let part = Part::triangles(&shapes::bumpy_cylinder(100));
        let cutter = Profile::Ball { radius: 5.0 }.cutter(0.0);
        let digitizer = Digitizer { part: &part, cutter, method: Method::Indexed };
        let computing = Computing::Faster(Err(GpuError::NoAdapter));
        let (contacts, report) =
            computing.contacts(&digitizer, 3, |_| Pose::identity(), &Silent).unwrap();
        assert_eq!(contacts.len(), 3);
        assert_eq!(report.on, "cpu");
        assert!(report.why.unwrap().contains("no Vulkan adapter"));
    }
}
