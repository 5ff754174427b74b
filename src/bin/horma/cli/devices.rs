//! `horma devices`: what else could compute.

use super::Shell;
use super::table::table;
use clap::Args;
use horma::compute::{Adapter, adapters};

/// List the devices that --compute gpu can use, with their limits and features.
#[derive(Debug, Args)]
#[command(after_help = "For example:
  horma devices
  horma cam last.stl -m last-lathe --compute gpu --adapter llvmpipe -o last.ngc")]
pub(crate) struct DevicesArgs {}

/// Lists them.
pub(crate) fn run(_args: &DevicesArgs, shell: &Shell) -> anyhow::Result<()> {
    let adapters = adapters();
    shell.report(&adapters, &in_words(&adapters))
}

fn in_words(adapters: &[Adapter]) -> String {
    if adapters.is_empty() {
        return "no Vulkan adapter is there: all is computed on the processor".into();
    }
    let mut rows =
        vec![["NAME", "KIND", "BINDING", "WORKGROUP", "FEATURES", "DRIVER"].map(str::to_owned)];
    rows.extend(adapters.iter().map(|adapter| {
        let limits = &adapter.limits;
        [
            adapter.name.clone(),
            adapter.kind.in_words().to_owned(),
            format!("{} MiB", limits.binding_bytes >> 20),
            format!("{} x {} B", limits.workgroup_threads, limits.workgroup_bytes),
            adapter.features.join(" "),
            adapter.driver.clone(),
        ]
    }));
    table(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use horma::compute::{AdapterKind, AdapterLimits};

    #[test]
    fn a_device_is_told_with_its_limits_and_none_in_a_sentence() {
        let limits = AdapterLimits {
            binding_bytes: 128 << 20,
            buffer_bytes: 2 << 30,
            workgroup_threads: 1024,
            workgroup_bytes: 32768,
            workgroups: 65535,
        };
        let adapter = Adapter {
            name: "Card 9".into(),
            kind: AdapterKind::Discrete,
            driver: "maker 1.2".into(),
            limits,
            features: vec!["f64", "subgroups"],
        };
        let told = in_words(&[adapter]);
        let row = told.lines().nth(1).unwrap();
        let cells =
            ["Card 9", "discrete", "128 MiB", "1024 x 32768 B", "f64 subgroups", "maker 1.2"];
        for cell in cells {
            assert!(row.contains(cell), "{row}");
        }
        assert!(in_words(&[]).contains("on the processor"));
    }
}
